"""Simulation: double precision that knows when it is not enough, and any number of digits.

In double precision each step brings an estimate of its error along. When a contact cannot be decided, or an event is
known to less than `accuracy`, the same algorithm is run with more digits from the exact start up to there
(`symosc.simulation.closer_look`), and takes over; the double path goes on from its rounded result.

With `digits` the working precision is raised until every event is known to that many digits.
"""

from __future__ import annotations

from fractions import Fraction
from math import inf, isinf
from typing import Any

from symosc.aliases import Number, NumberLike, Progress, SceneName, StartError
from symosc.arguments import public
from symosc.display.progress import Advance, late_bar
from symosc.engine.arithmetic import mp_context
from symosc.engine.start import Start, settles
from symosc.engine.state import FAILED, ON_BELT, REST
from symosc.errors import ParameterError
from symosc.exact import LEAST_ASKED_DIGITS, MOST_ASKED_DIGITS, read_exact, read_start_error, show, whole_number
from symosc.model import MODE_NAMES, Parameters
from symosc.scenes import Scene, load_scene
from symosc.simulation.closer_look import Backup, touch_digits
from symosc.simulation.run import Path, check_reached, cut_event, rounded_event
from symosc.simulation.trajectory import MAP_LABELS, Event, Segment, Trajectory

ACCURACY = 1e-13
MOST_EVENTS = 1_000_000
# With many digits an event takes milliseconds.
MOST_EXACT_EVENTS = 20_000
# With `digits`, more than this many times the digits are tried only to tell a touch from a near miss.
MOST_WORKING = 12


@public
def simulate(
    scene: Scene | Parameters | SceneName,
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
    scene : Scene, str or Parameters
        A scene or the name of one (t0, x0, v0 and t_end then replace the scene's own), or parameters.
    t0, x0, v0, t_end : number
        Start and end, read exactly like parameters; in the parameters' units.
    max_events : int, optional
        Stop after that many events (default 1,000,000; with `digits` 20,000, some minutes).
    digits : int, optional
        None: double precision. An int: event times and positions are known to that many digits (mpmath), relative to
        max(1, |value|), as far as the error estimates tell.
    accuracy : float, optional
        For double precision (default 1e-13). An event whose time or position has a larger error than this, relative to
        max(1, |value|), for times also to |t0|, is computed once more with 36 digits. With ``math.inf`` the path that
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
    start = _read_start(scene, {"t0": t0, "x0": x0, "v0": v0, "t_end": t_end}, start_error)
    return _followed(start, max_events, digits, accuracy, progress)


def _followed(start: Start, max_events: int | None, digits: int | None, accuracy: Any, progress: Any) -> Trajectory:
    """Follow a motion as `simulate` is asked to."""
    default = MOST_EVENTS if digits is None else MOST_EXACT_EVENTS
    most = default if max_events is None else whole_number("max_events", max_events, 1)
    if digits is None:
        asked = read_accuracy(accuracy)
        with late_bar(progress, "simulate", "events") as advance:
            return in_doubles(start, most, asked, advance)
    digits = whole_number("digits", digits, LEAST_ASKED_DIGITS, MOST_ASKED_DIGITS)
    if accuracy is not None:
        raise ParameterError("accuracy", accuracy, f"is for double precision: leave it out with digits = {digits}")
    with late_bar(progress, f"simulate, {digits} digits", "events") as advance:
        return _with_digits(start, most, digits, advance)


def _read_start(scene: Scene | Parameters | SceneName, given: dict[str, Any], start_error: Any) -> Start:
    if not isinstance(scene, Scene | Parameters):
        scene = load_scene(scene)
    if isinstance(scene, Scene):
        scene = scene.started({name: value for name, value in given.items() if value is not None})
        parameters, given = scene.parameters, {name: getattr(scene, name) for name in given}
        start_error = scene.start_error if start_error is None else start_error
    else:
        parameters = scene
    for name, value in given.items():
        if value is None:
            raise ParameterError(name, value, "is needed with parameters")
    numbers = {name: read_exact(name, value) for name, value in given.items()}
    start = Start(parameters, **numbers, start_error=read_start_error(start_error))
    if start.t_end <= start.t0:
        raise ParameterError("t_end", show(start.t_end), f"must be later than t0 = {show(start.t0)}")
    return start


def read_accuracy(value: Any) -> float:
    """Return the accuracy that is asked of events in double precision, ACCURACY for None."""
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


def in_doubles(start: Start, most: int, accuracy: float, advance: Advance = None) -> Trajectory:
    """Follow a motion in double precision; see `simulate`."""
    path, backup, unsure = Path(start), None, isinf(accuracy) or start.start_error is not None
    if isinf(accuracy):
        path.believe()
    accuracy = attainable(accuracy, start.start_error)
    if settles(start):
        path.code = REST
    while not path.ended:
        before = len(path.events)
        if before >= most:
            return _trajectory(path, "max_events", f"stopped after max_events = {most} events, at t = {path.time!r}")
        path.step()
        in_doubt = not path.decided or path.code == FAILED
        inexact = len(path.events) > before and _inexact(path.events[-1], float(start.t0), accuracy)
        if in_doubt or inexact:
            backup = backup or Backup(start)
            if not backup.follow(before + 1, () if unsure else path.searches):
                return _undecidable(backup.path, before, backup.digits)
            path.adopt(backup.path)
        if advance:
            advance(_part_done(path, most), len(path.events))
    return _ended(path)


def _part_done(path: Path, most: int) -> float:
    """Return which part of a motion has been followed, in time or in events, whichever ends it earlier."""
    span = float(path.start.t_end - path.start.t0)
    return min(1.0, max(float(path.elapsed) / span, len(path.events) / most))


def attainable(accuracy: float, start_error: tuple[Fraction, Fraction, Fraction] | None) -> float:
    """Return the accuracy for which more digits help: what the start does not say no digits can."""
    return inf if start_error and max(start_error) > accuracy else accuracy


def _inexact(event: Event, t0: float, accuracy: float) -> bool:
    return event.t_error > accuracy * max(1.0, abs(event.t), abs(t0)) or event.x_error > accuracy * max(
        1.0, abs(event.x)
    )


def _with_digits(start: Start, most: int, digits: int, advance: Advance = None) -> Trajectory:
    """Raise the working precision until every contact is decided and every event known to `digits` digits."""
    spare = start.spare_digits
    working = digits + 10 + spare
    if settles(start):
        path = Path(start, working)
        path.code = REST
        return _ended(path, digits)
    while True:
        path, limit = Path(start, working), MOST_WORKING * (digits + spare)
        open_contact = False
        while not path.ended and len(path.events) < most and not open_contact:
            before = len(path.events)
            path.step()
            if advance:
                advance(_part_done(path, most), len(path.events))
            if not path.decided and path.code != FAILED and not start.start_error:
                needed = touch_digits(path, path.elapsed, digits)
                open_contact = needed is None or working < needed
                limit = max(limit, needed or 0)
        in_doubt = open_contact or path.code == FAILED
        # The error of a start that is known to so much only stays whatever the digits.
        missing = 0 if in_doubt or start.start_error else path.missing_digits(digits)
        if not in_doubt and missing <= 0:
            break
        if working >= limit:
            return _undecidable(path, before, working, digits)
        working = min(limit, working + missing + 2) if not in_doubt else min(limit, 3 * working)
    if not path.ended:
        return _trajectory(path, "max_events", f"stopped after max_events = {most} events", digits)
    return _ended(path, digits)


def end_status(code: int, mode: int, v: Number, p: Parameters) -> str:
    """Return the status of a motion whose last step ended with END or REST in that mode, at that speed."""
    if code != REST:
        return "t_end"
    settles = p.B0 == 0 and p.c > 0 and (p.k > 0 or p.A(mode) == 0) if mode <= ON_BELT else v == 0
    return "equilibrium" if settles else "t_end"


def _ended(path: Path, digits: int | None = None) -> Trajectory:
    """Return the trajectory of a path that came to its end."""
    state, start = path.state, path.start
    status = end_status(path.code, state.mode, state.v, start.parameters)
    message = f"reached t_end = {show(start.t_end)}"
    if path.code != REST:
        check_reached(start, state.n)
    if status == "equilibrium":
        where = (
            f"at rest on belt {state.mode - ON_BELT}"
            if state.mode > ON_BELT
            else f"settling to rest in Omega{state.mode}"
        )
        message = f"from t = {float(path.time)!r} {where}, no event will come any more"
    return _trajectory(path, status, message, digits)


def _undecidable(path: Path, before: int, digits: int, asked: int | None = None) -> Trajectory:
    """End a trajectory at the contact that could not be decided after `before` events."""
    del path.events[before:]
    hint = f"ask for more digits, such as digits={2 * (asked or digits)}"
    message = f"the contact near t = {float(path.time)!r} cannot be decided with {digits} digits; {hint}"
    return _trajectory(path, "undecidable", message, asked)


def _trajectory(path: Path, status: str, message: str, digits: int | None = None) -> Trajectory:
    last = path.time if status in ("undecidable", "max_events") else path.arithmetic.number(path.start.t_end)
    events, t0 = path.events, path.t0
    if digits is None:
        events, t0, last = [rounded_event(event) for event in events], float(path.start.t0), float(last)
    else:
        context = mp_context(digits)
        events = [cut_event(event, context) for event in events]
        t0, last = context.convert(t0), context.convert(last)
    segments = []
    plane, since, mode = path.first_at, t0, MODE_NAMES[path.pieces[0].mode]
    for event in events:
        segments.append(Segment(since, event.t, mode, MAP_LABELS.get((plane, mode, event.boundary))))
        plane, since, mode = event.boundary, event.t, event.target
    segments.append(Segment(since, last, mode, None))
    t0_low = 0.0 if digits else float(path.start.t0 - Fraction(t0))
    return Trajectory(path.start.parameters, events, segments, path.pieces, status, message, digits, t0_low)
