"""`simulate`: one motion, in doubles with automatic precision escalation or with any number of digits.

Where a contact is undecided in doubles, or an event is known to less than `accuracy`, the same problem is followed with
more digits from the exact start up to there, and on as long as doubles are in doubt (`FinerMotion`). With `digits` the
working precision is raised until every event is known to that many digits.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from math import inf, isinf
from typing import Any

from symosc.aliases import Number, NumberLike, Progress, SceneName, StartError
from symosc.arguments import public
from symosc.display.progress import Advance, late_bar
from symosc.engine.arithmetic import PairLoops, mp_context
from symosc.engine.start import Start, settles
from symosc.engine.state import FAILED, FULL, NEEDS_DIGITS, ON_BELT, REST, RUNNING, UNDECIDED, State
from symosc.errors import ParameterError
from symosc.exact import LEAST_ASKED_DIGITS, MOST_ASKED_DIGITS, read_exact, read_start_error, show, whole_number
from symosc.model import Parameters
from symosc.reductions import OtherModel
from symosc.scenes import Original, Scene, end_time, load_scene, moved_scene, not_reduced_error, start_numbers
from symosc.simulation.motion import (
    PAIR_NOISE,
    FinerMotion,
    Limits,
    Motion,
    MotionInDoubles,
    check_reached,
    digits_to_confirm_graze,
)
from symosc.simulation.trajectory import MovedTrajectory, Trajectory

ACCURACY = 1e-13
MOST_EVENTS = 1_000_000
# With many digits an event takes milliseconds.
MOST_EXACT_EVENTS = 20_000
# With `digits`, more than this many times the digits are tried only to tell a graze from a near miss.
MOST_WORKING = 12


@public
def simulate(
    scene: Scene | Parameters | OtherModel | SceneName,
    *,
    t0: NumberLike | None = None,
    x0: NumberLike | None = None,
    v0: NumberLike | None = None,
    t_end: NumberLike | None = None,
    max_events: int | None = None,
    digits: int | None = None,
    accuracy: NumberLike | None = None,
    start_error: StartError | None = None,
    progress: Progress = False,
) -> Trajectory:
    """Follow the motion from a start to t_end, event by event, exactly.

    Parameters
    ----------
    scene : Scene, str, Parameters or OtherModel
        A scene or the name of one (t0, x0, v0 and t_end then replace the scene's own), or parameters. Of another model
        start, end and answer are in its coordinates.
    t0, x0, v0, t_end : number
        Start and end, read exactly like parameters; in the parameters' units. With parameters t0, x0 and v0 are 0
        unless they are given. "10T" as an end is ten periods of the drive after t0.
    max_events : int, optional
        Stop after that many events (default 1,000,000; with `digits` 20,000, some minutes).
    digits : int, optional
        None: double precision. An int: event times and positions are known to that many digits (mpmath), relative to
        max(1, |value|), as far as the error estimates tell.
    accuracy : float, optional
        For double precision (default 1e-13). An event whose time or position has a larger error than this, relative to
        max(1, |value|), for times also to |t0|, is computed once more with 44 digits. With ``math.inf`` the path that
        doubles compute is followed as it is: only contacts that their rounding leaves open get more digits.
    start_error : number or three numbers, optional
        Half-widths to which t0, x0 and v0 are known; one number serves for all. None: that of the scene, or exact. A
        contact that the error of the start can make a touch is a graze, and the errors of events cover it.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a function of two
        numbers: the part that is done, and 1.

    Returns
    -------
    Trajectory

    Raises
    ------
    ParameterError
        If a number is missing, not finite or out of range, if both `digits` and `accuracy` are given, or if t_end is
        more than 1e8 forcing periods away and the motion goes on until then.

    Examples
    --------
    >>> from symosc import simulate
    >>> [(event.kind, f"{event.t:.6f}") for event in simulate("fig5", t_end=7).events[:2]]
    [('stick', '0.122303'), ('slip', '1.220981')]
    >>> print(simulate("fig8-exact", digits=30).events[0].t)
    3.14159265358979323846264338328
    """
    start, original = read_problem(scene, {"t0": t0, "x0": x0, "v0": v0, "t_end": t_end}, start_error)
    default = MOST_EVENTS if digits is None else MOST_EXACT_EVENTS
    most = default if max_events is None else whole_number("max_events", max_events, 1)
    if digits is None:
        asked = read_accuracy(accuracy)
        with late_bar(progress, "simulate", "events") as advance:
            motion = in_doubles(start, most, asked, advance)
    else:
        digits = whole_number("digits", digits, LEAST_ASKED_DIGITS, MOST_ASKED_DIGITS)
        if accuracy is not None:
            raise ParameterError("accuracy", accuracy, f"is for double precision: leave it out with digits = {digits}")
        with late_bar(progress, f"simulate, {digits} digits", "events") as advance:
            motion = _with_digits(start, most, digits, advance)
    return motion if original is None else MovedTrajectory(motion, original)


def read_start(scene: Scene | Parameters | SceneName, given: dict[str, Any], start_error: Any) -> Start:
    """Return the initial value problem of a scene or of keyword arguments; refuse one of another model."""
    start, original = read_problem(scene, given, start_error)
    if original is not None:
        raise not_reduced_error(scene)
    return start


def read_problem(scene: Any, given: dict[str, Any], start_error: Any) -> tuple[Start, Original | None]:
    """Return the initial value problem of a scene or of keyword arguments, and the model from which it was reduced."""
    if not isinstance(scene, Scene | Parameters | OtherModel):
        scene = load_scene(scene)
    if isinstance(scene, OtherModel):
        if given["t_end"] is None:
            raise ParameterError("t_end", None, "is needed with a model")
        given = {name: 0 if value is None else value for name, value in given.items()}
        end = end_time(given["t_end"], scene.parameters, given["t0"])
        scene, given = Scene("model", scene, **given | {"t_end": end}), {}  # type: ignore[arg-type]
    if isinstance(scene, Scene):
        scene = scene.started({name: value for name, value in given.items() if value is not None})
        if start_error is not None and scene.original is not None:
            scene, start_error = moved_scene(scene, scene.original, start_error=start_error), None
        error = scene.start_error if start_error is None else read_start_error(start_error)
        start = Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end, error)
        return start, scene.original
    if given["t_end"] is None:
        raise ParameterError("t_end", None, "is needed with parameters")
    given = given | {"t_end": end_time(given["t_end"], scene, given["t0"] or 0)}
    numbers, rounding = start_numbers({name: 0 if value is None else value for name, value in given.items()}, scene)
    start = Start(scene, **numbers, start_error=rounding if start_error is None else read_start_error(start_error))
    if start.t_end <= start.t0:
        raise ParameterError("t_end", show(start.t_end), f"must be later than t0 = {show(start.t0)}")
    return start, None


def read_accuracy(value: Any) -> float:
    """Return the requested accuracy of events in double precision; ACCURACY for None."""
    if value is None:
        return ACCURACY
    if isinstance(value, float) and value == inf:
        return inf
    try:
        accuracy = float(read_exact("accuracy", value))
    except ParameterError:
        accuracy = 0.0
    if accuracy <= 0.0:
        raise ParameterError("accuracy", value, f"must be a number > 0; the default is {ACCURACY:g}")
    return accuracy


def attainable(accuracy: float, start_error: tuple[Fraction, Fraction, Fraction] | None) -> float:
    """Return the accuracy that events can be held to: `accuracy`, or inf if the errors of the start exceed it."""
    return inf if start_error and max(start_error) > accuracy else accuracy


def in_doubles(
    start: Start, most: int, accuracy: float, advance: Advance = None, loops: PairLoops | None = None
) -> Trajectory:
    """Follow a motion in doubles, and with more digits where doubles cannot decide an event; return a Trajectory."""
    # Given `loops` in pairs, these come first whatever is loaded, with the noise that `simulate_many` allows.
    needed = attainable(accuracy, start.start_error)
    limits = Limits(most, needed, PAIR_NOISE) if loops else Limits(most, needed)
    motion, finer = MotionInDoubles(start, isinf(accuracy)), None
    if settles(start):
        motion.code = REST
    while motion.code == RUNNING:
        motion.follow(most, needed)
        if motion.code in NEEDS_DIGITS:
            finer = finer or FinerMotion(motion, limits, loops)
            decided = finer.reach(motion.count + (motion.code == UNDECIDED))
            motion.take_over(finer)
            if not decided:
                return _in_columns(motion, "undecidable", _open_contact(finer.open_at, finer.open_in), finer.open_at)
        if advance:
            advance(_part_done(start, motion.elapsed, motion.count, most), motion.count)
    if motion.code == FULL:
        last = float(motion.events().floats[0, -1])  # the time of the last event, by the clock
        return _in_columns(motion, "max_events", f"stopped after max_events = {most} events, at t = {last!r}", last)
    return _in_columns(motion, *_ended(start, motion.code, motion.state), float(start.t_end))


def _part_done(start: Start, elapsed: Number, count: int, most: int) -> float:
    """Return the completed part of a motion, from 0 to 1, by its time or by its events, whichever is larger."""
    return min(1.0, max(float(elapsed) / float(start.t_end - start.t0), count / most))


def _with_digits(start: Start, most: int, digits: int, advance: Advance = None) -> Trajectory:
    """Follow a motion in ever more digits until all contacts are decided and every event has `digits` digits."""
    working = digits + 10 + start.spare_digits
    if settles(start):
        motion = Motion(start, working)
        last = motion.arithmetic.number(start.t_end)
        return _in_digits(motion, *_ended(start, REST, motion.state), last, digits)
    asked_at = inf  # the number of the event before a contact that took more digits
    while True:
        motion, limit, undecided = Motion(start, working), MOST_WORKING * (digits + start.spare_digits), False
        while not motion.ended and motion.count < most and not undecided:
            before = motion.count
            motion.step()
            if advance:
                advance(_part_done(start, motion.elapsed, motion.count, most), motion.count)
            if not motion.decided and motion.code != FAILED and not start.start_error:
                least = 2 * working if before > asked_at else 0
                needed = digits_to_confirm_graze(motion, motion.elapsed, digits, least)
                undecided = needed is None or working < needed
                asked_at = before if undecided else inf if before >= asked_at else asked_at
                limit = max(limit, needed or 0)
        undecided = undecided or motion.code == FAILED
        # The error of an inexact start stays, whatever the digits.
        missing = 0 if undecided or start.start_error else motion.missing_digits(digits)
        if not undecided and missing <= 0:
            break
        if working >= limit:
            last, message = motion.time, _open_contact(float(motion.time), working, digits)
            motion.undo()
            return _in_digits(motion, "undecidable", message, last, digits)
        working = min(limit, 3 * working if undecided else working + missing + 2)
    if not motion.ended:
        return _in_digits(motion, "max_events", f"stopped after max_events = {most} events", motion.time, digits)
    return _in_digits(motion, *_ended(start, motion.code, motion.state), motion.arithmetic.number(start.t_end), digits)


def end_status(code: int, mode: int, v: Number, p: Parameters) -> str:
    """Return the status of a motion whose last step ended with END or REST in this mode, at this speed."""
    if code != REST:
        return "t_end"
    settles = p.B0 == 0 and p.c > 0 and (p.k > 0 or p.A(mode) == 0) if mode <= ON_BELT else v == 0
    return "equilibrium" if settles else "t_end"


def _ended(start: Start, code: int, state: State) -> tuple[str, str]:
    """Return status and message of a motion whose last step ended with `code` (END or REST) in `state`."""
    if code != REST:
        check_reached(start, state.n)
    status, message = end_status(code, state.mode, state.v, start.parameters), f"reached t_end = {show(start.t_end)}"
    if status == "equilibrium":
        held = state.mode > ON_BELT
        where = f"at rest on belt {state.mode - ON_BELT}" if held else f"settling to rest in Omega{state.mode}"
        message = f"from t = {float(state.t)!r} {where}, no event will come any more"
    return status, message


def _open_contact(t: float, used: int, asked: int | None = None) -> str:
    """Return the message about a contact near `t` that `used` digits do not decide."""
    hint = f"ask for more digits, such as digits={2 * (asked or used)}"
    return f"the contact near t = {t!r} cannot be decided with {used} digits; {hint}"


def _in_columns(motion: MotionInDoubles, status: str, message: str, last: float) -> Trajectory:
    """Return the Trajectory of a motion in doubles that ends at the time `last`."""
    found = motion.events(), motion.pieces(), status, message
    return Trajectory(motion.start.parameters, *found, (float(motion.start.t0), last), motion.first_at)


def _in_digits(motion: Motion, status: str, message: str, last: Number, digits: int) -> Trajectory:
    """Return the Trajectory, with `digits` digits, of a motion in more digits that ends at the time `last`."""
    context = mp_context(digits)
    found = partial(motion.events_in, context), motion.columns(), status, message
    span = context.convert(motion.t0), context.convert(last)
    return Trajectory(motion.start.parameters, *found, span, motion.first_at, digits)
