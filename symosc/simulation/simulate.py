"""`simulate`: one motion, in doubles with automatic precision escalation or with any number of
digits.

Where a contact is undecided in doubles, or an event is known to less than `accuracy`, the same
problem is followed with more digits from the exact start up to there, and on as long as doubles are
in doubt (`FinerMotion`). With `digits` the working precision is raised until every event is known
to that many digits.
"""

from __future__ import annotations

from contextlib import nullcontext
from fractions import Fraction
from functools import partial
from math import inf, isinf
from typing import Any

import numpy as np

from symosc.base.aliases import Number, NumberLike, Progress, SceneName, StartError
from symosc.base.arguments import NUMBER, PROGRESS, START_ERROR, public, require, require_or_none
from symosc.base.display.progress import Advance, late_bar
from symosc.base.errors import ParameterError, brief
from symosc.base.exact import (
    LEAST_ASKED_DIGITS,
    MOST_ASKED_DIGITS,
    read_exact,
    read_start_error,
    show,
    whole_number,
)
from symosc.engine import batch as engine_batch
from symosc.engine.arithmetic import PairLoops, mp_context, rows_in_doubles
from symosc.engine.batch import EventRows, joined, keep_state, piece_buffer, state_of
from symosc.engine.events import belt_of_law, mode_of_law
from symosc.engine.flow import Constants, clock_time
from symosc.engine.start import (
    MOST_PERIODS,
    Start,
    first_row_in_doubles,
    is_far,
    longest_span,
    settles,
)
from symosc.engine.state import (
    END,
    FAILED,
    FULL,
    NEEDS_DIGITS,
    ON_BELT,
    REST,
    RUNNING,
    STATE_ROW,
    UNDECIDED,
    State,
)
from symosc.engine.summary import no_tally
from symosc.friction import ALL_MODE_NAMES
from symosc.model import Model
from symosc.reductions import OtherModel
from symosc.scenes import (
    Original,
    Scene,
    end_time,
    model_of,
    moved_scene,
    not_reduced_error,
    passed,
    problem_of,
)
from symosc.simulation.loops import CHOICE
from symosc.simulation.motion import (
    PAIR_NOISE,
    FinerMotion,
    Limits,
    Motion,
    digits_to_confirm_graze,
)
from symosc.simulation.trajectory import MovedTrajectory, Trajectory

ACCURACY = 1e-13
MOST_EVENTS = 1_000_000
# With many digits an event takes milliseconds.
MOST_EXACT_EVENTS = 20_000
# With `digits`, more than this many times the digits are tried only to tell a graze from a near
# miss.
MOST_WORKING = 12
FIRST_BLOCK = 64  # events for which the first block of a motion in doubles has room


@public
def simulate(
    scene: Scene | Model | OtherModel | SceneName,
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
    scene : Scene, its name or its file; or Parameters, Oscillator or OtherModel
        A scene or the name of one (t0, x0, v0 and t_end then replace the scene's own), or
        parameters, or an oscillator with another friction law. For another model, start, end and
        answer are in the coordinates of that model.
    t0, x0, v0, t_end : number
        Start and end, read exactly like parameters; in the parameters' units. With parameters t0,
        x0 and v0 are 0 unless they are given. "10T" as an end is ten periods of the drive after t0.
    max_events : int, optional
        Stop after that many events (default 1,000,000; with `digits` 20,000, some minutes).
    digits : int, optional
        None: double precision. An int: event times and positions are known to that many digits
        (mpmath), relative to max(1, |value|), as far as the error estimates tell.
    accuracy : float, optional
        For double precision (default 1e-13). An event whose time or position has a larger error
        than this, relative to max(1, |value|), for times also to |t0|, is computed once more with
        44 digits. With ``math.inf`` the path that doubles compute is followed as it is: only
        contacts that their rounding leaves open get more digits.
    start_error : number or three numbers, optional
        Half-widths to which t0, x0 and v0 are known; one number serves for all. None: that of the
        scene, or exact. A contact that the error of the start can make a touch is a graze, and the
        errors of events cover it.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a
        function of two numbers: the part that is done, and 1.

    Returns
    -------
    Trajectory

    Raises
    ------
    ParameterError
        If a number is missing, not finite or out of range, if both `digits` and `accuracy` are
        given, or if the motion is still going after 1e8 forcing periods (without a drive: after
        5e9 times the time 1/w0 of the free motion).

    Examples
    --------
    >>> from symosc import simulate
    >>> [(event.kind, f"{event.t:.6f}") for event in simulate("fig5", t_end=7).events[:2]]
    [('stick', '0.122303'), ('slip', '1.220981')]
    >>> print(simulate("fig8-exact", digits=30).events[0].t)
    3.14159265358979323846264338328
    """
    scene = problem_of(scene, "scene", any_law=True)
    require_or_none(NUMBER, t0=t0, x0=x0, v0=v0, t_end=t_end)
    require_or_none(*START_ERROR, start_error=start_error)
    require(*PROGRESS, progress=progress)
    start, original = read_problem(
        scene, {"t0": t0, "x0": x0, "v0": v0, "t_end": t_end}, start_error
    )
    if digits is None:
        default = MOST_EVENTS
    else:
        default = MOST_EXACT_EVENTS
    most = read_most(max_events, default)
    if digits is None:
        label = "simulate"
        follow = partial(in_doubles, start, most, read_accuracy(accuracy))
    else:
        digits = whole_number("digits", digits, LEAST_ASKED_DIGITS, MOST_ASKED_DIGITS)
        label = f"simulate, {digits} digits"
        if accuracy is not None:
            raise ParameterError(
                "accuracy",
                accuracy,
                f"accuracy applies to double precision only; omit it with digits = {digits}",
            )
        follow = partial(in_digits, start, most, digits)
    with late_bar(progress, label, "events") if progress else nullcontext() as advance:
        motion = follow(advance)
    if original is not None:
        motion = MovedTrajectory(motion, original)
    motion.in_si = isinstance(scene, Scene) and scene.in_si
    return motion


def read_most(max_events: Any, default: int) -> int:
    """Return `max_events` as a whole number, at most 2**62; `default` if it is None."""
    if max_events is None:
        return default
    return min(whole_number("max_events", max_events, 1), 2**62)


def read_start(scene: Scene | Model, arguments: dict[str, Any], start_error: Any) -> Start:
    """Return the initial value problem of a scene or of keyword arguments.

    Refuse a scene of another model.
    """
    if isinstance(scene, Scene) and scene.original is not None:
        raise not_reduced_error(scene)
    return read_problem(scene, arguments, start_error)[0]


def read_problem(
    scene: Scene | Model | OtherModel, arguments: dict[str, Any], start_error: Any
) -> tuple[Start, Original | None]:
    """Return the initial value problem of a scene or of arguments, and the other model it stands
    for, if any.
    """
    if not isinstance(scene, Scene):
        if arguments["t_end"] is None:
            subject = passed(scene)
            raise ParameterError("t_end", None, f"t_end is required when you pass {subject}")
        arguments = {name: 0 if value is None else value for name, value in arguments.items()}
        arguments["t_end"] = end_time(arguments["t_end"], model_of(scene), arguments["t0"])
        scene = Scene("motion", scene, **arguments)  # type: ignore[arg-type]
        arguments = {}
    if changes := {name: value for name, value in arguments.items() if value is not None}:
        scene = scene.started(changes)
    if start_error is not None and scene.original is not None:
        scene = moved_scene(scene, scene.original, start_error=start_error)
        start_error = None
    if start_error is None:
        error = scene.start_error
    else:
        error = read_start_error(start_error)
    return Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end, error), scene.original


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
        raise ParameterError(
            "accuracy", value, f"must be a number > 0; the default is {ACCURACY:g}"
        )
    return accuracy


def attainable(accuracy: float, start_error: tuple[Fraction, Fraction, Fraction] | None) -> float:
    """Return the accuracy to demand of events: `accuracy`, or inf (none) if the error of the start
    is larger.
    """
    if start_error and max(start_error) > accuracy:
        return inf
    return accuracy


def in_doubles(
    start: Start,
    most: int,
    accuracy: float,
    advance: Advance = None,
    loops: PairLoops | None = None,
) -> Trajectory:
    """Follow a motion in doubles, and in pairs or many digits where doubles are in doubt.

    Return its Trajectory.

    It stops after `most` events; an event less accurate than `accuracy` is in doubt. `advance` is
    told of the progress.
    """
    # It is a batch of one. Given `loops` in pairs, these come before digits whatever is loaded,
    # with the noise that `simulate_many` allows. With accuracy inf decisions exceed their own
    # rounding only, not the errors of the state.
    constants = rows_in_doubles(start.parameters)
    needed = attainable(accuracy, start.start_error)
    t0 = float(start.t0)
    if isinf(accuracy):
        constants = tuple(K._replace(sigmas=0.0) for K in constants)
    if loops:
        limits = Limits(most, needed, PAIR_NOISE)
    else:
        limits = Limits(most, needed)
    finer = None
    decided = True
    row, first = first_row_in_doubles(start)
    first_piece = piece_buffer(1)
    batch = engine_batch.batch_of(np.array([first], STATE_ROW), np.array([row]))
    state = state_of(batch.states[0])
    first_at = belt_of_law(state.at, constants[row])
    engine_batch.write_piece(
        first_piece, 0, state, float(start.t0 - Fraction(state.t)), constants[row]
    )
    events = list[EventRows]()
    pieces = [first_piece]
    count = 0
    if settles(start):
        code = REST
    else:
        code = RUNNING
    while code == RUNNING:
        loop = CHOICE.of_single(count, constants)
        size = min(loop.most_events, max(FIRST_BLOCK, 8 * count))
        out = engine_batch.event_buffer(size)
        parts = piece_buffer(size)
        _, filled, begins = loop.follow(
            0, batch, most, needed, out, parts, no_tally(), loop.constants
        )
        events.append(engine_batch.rows_between(out, 0, filled))
        pieces.append(parts[:, :begins])
        count = int(batch.counts[0])
        code = int(batch.codes[0])
        if code in NEEDS_DIGITS:
            finer = finer or FinerMotion(start, constants, limits, loops)
            # An event that doubles do not decide is not counted yet; one that is INEXACT is.
            decided = finer.reach(count + (code == UNDECIDED))
            events = list(finer.events)
            # It began at the start, so its events and pieces replace those of doubles.
            pieces = [first_piece, *finer.pieces]
            now = finer.now
            count = now.count
            if now.code in (END, REST):
                code = now.code
            else:
                code = RUNNING
            keep_state(batch.states[0], now.rounded_state())
            batch.sets[0] = now.row
            batch.counts[0] = count
            batch.codes[0] = code
            if not decided:
                break
        if advance:
            state = state_of(batch.states[0])
            elapsed = clock_time(state.t - t0, state.t_low, 0.0, constants[0])
            advance(_part_done(start, elapsed, count, most), count)
    rows = joined(events)
    last = float(start.t_end)
    if finer and not decided:
        status = "undecidable"
        message = _open_contact(start, finer.open_at, finer.open_in)
        last = finer.open_at
    elif code == FULL:
        last = float(rows.floats[0, -1])  # the time of the last event, by the clock
        status = "max_events"
        message = f"stopped after max_events = {most} events, at t = {last!r}"
    else:
        last_row = int(batch.sets[0])
        status, message = _ended(start, code, state_of(batch.states[0]), constants[last_row])
    all_pieces = np.concatenate(pieces, axis=1)
    return Trajectory(start.parameters, rows, all_pieces, status, message, (t0, last), first_at)


def _part_done(start: Start, elapsed: Number, count: int, most: int) -> float:
    """Return the completed part of a motion, from 0 to 1, by its time or by its events, whichever
    is larger.
    """
    return min(1.0, max(float(elapsed) / float(start.t_end - start.t0), count / most))


def in_digits(start: Start, most: int, digits: int, advance: Advance = None) -> Trajectory:
    """Follow a motion, with ever more digits, until all contacts are decided and each event has
    `digits` digits.
    """
    working = digits + 10 + start.spare_digits
    # the number of the event before a contact that took more digits
    asked_at = inf
    settled = settles(start)
    while True:
        motion = Motion(start, working)
        limit = MOST_WORKING * (digits + start.spare_digits)
        undecided = False
        while not (settled or motion.ended or undecided) and motion.count < most:
            before = motion.count
            motion.step()
            if advance:
                advance(_part_done(start, motion.elapsed, motion.count, most), motion.count)
            if motion.is_open and start.start_error:
                undecided = True
                limit = working  # no digits decide this
            elif motion.is_open and motion.code != FAILED:
                # A later contact than the one that took more digits takes twice as many.
                if before > asked_at:
                    least = 2 * working
                else:
                    least = 0
                needed = digits_to_confirm_graze(motion, motion.elapsed, digits, least)
                undecided = needed is None or working < needed
                if undecided:
                    asked_at = before
                elif before >= asked_at:
                    asked_at = inf
                limit = max(limit, needed or 0)
        undecided = undecided or motion.code == FAILED
        # The error of an inexact start stays, whatever the digits.
        if undecided or start.start_error:
            missing = 0
        else:
            missing = motion.missing_digits(digits)
        if working >= limit or (missing <= 0 and not undecided):
            break
        # Three times as many digits for an undecided contact, else as many more as are missing.
        working = min(limit, 3 * working if undecided else working + missing + 2)
    last = motion.state.t
    if undecided or missing > 0:
        motion.undo()
        status = "undecidable"
        message = _open_contact(start, float(last), working, digits)
    elif settled or motion.ended:
        K = rows_in_doubles(start.parameters)[motion.row]
        status, message = _ended(start, REST if settled else motion.code, motion.state, K)
        last = motion.arithmetic.number(start.t_end)
    else:
        status = "max_events"
        message = f"stopped after max_events = {most} events"
    context = mp_context(digits)
    columns = motion.columns()
    span = context.convert(motion.t0), context.convert(last)
    events = partial(motion.events, context)
    return Trajectory(
        start.parameters, events, columns, status, message, span, motion.first_at, digits
    )


def check_reached(start: Start) -> None:
    """Raise ParameterError for a motion that goes on, and whose t_end is later than any is
    followed.

    That is after 1e8 forcing periods or, without a drive, after as many searches.
    """
    if not is_far(start):
        return
    begin = f"after t0 = {brief(show(start.t0))}, more than"
    if start.parameters.B0 == 0:
        span = longest_span(start.parameters)
        reason = f"is more than {float(span):.0e} {begin} is followed without a drive"
    else:
        reason = f"is more than {MOST_PERIODS:.0e} forcing periods {begin} are followed"
    raise ParameterError("t_end", show(start.t_end), reason)


def end_status(code: int, mode: int, v: Number, force: Number, p: Model, row: int) -> str:
    """Return the status "t_end" or "equilibrium" of a motion that ended with `code` END or REST.

    `mode`, velocity `v` and acceleration `force` are those at its last event, or at its start;
    `row` is the number of its constants.
    """
    if code != REST:
        return "t_end"
    if mode <= ON_BELT:
        rests = v == 0 and force == 0
        force_here = p.A0 + p.law.rows[row].forces[mode - 1]
        fades = p.law.damping(p.c, row) > 0 and (p.k > 0 or force_here == 0)
        settles = p.B0 == 0 and (rests or fades)
    else:
        settles = v == 0
    if settles:
        return "equilibrium"
    return "t_end"


def _ended(start: Start, code: int, state: State, K: Constants) -> tuple[str, str]:
    """Return status and message of a motion that ended in `state`, with the constants K: at its end
    (END) or with no event left (REST).
    """
    if code != REST:
        check_reached(start)
    status = end_status(code, state.mode, state.v, state.Fb, start.parameters, K.row)
    message = f"reached t_end = {show(start.t_end)}"
    if status == "equilibrium":
        if state.mode > ON_BELT:
            where = f"at rest on belt {belt_of_law(state.mode - ON_BELT, K)}"
        else:
            where = f"settling to rest in {ALL_MODE_NAMES[mode_of_law(state.mode, K)]}"
        message = f"from t = {float(state.t)!r} {where}, no event will come any more"
    return status, message


def _open_contact(start: Start, t: float, used: int, asked: int | None = None) -> str:
    """Return the message that `used` digits do not decide the contact near `t`.

    `asked` were asked for.
    """
    open_at = f"the contact near t = {t!r} cannot be decided"
    if start.start_error:
        return (
            f"{open_at} with this error of the start; give a smaller one, or else ask for more "
            f"than {used} digits"
        )
    return (
        f"{open_at} with {used} digits; ask for more digits, such as digits={2 * (asked or used)}"
    )
