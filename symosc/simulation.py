"""Simulation: double precision that knows when it is not enough, and any number of digits.

In double precision each step brings an estimate of its error along. When a contact cannot be decided, or an event is
known to less than `accuracy`, the same algorithm is run with BACKUP_DIGITS digits from the exact start up to there,
and takes over; the double path goes on from its rounded result. A contact that stays open with BACKUP_DIGITS digits is
looked at with twice as many: open still, it is a graze; decided only there, the trajectory ends as "undecidable",
because from here on double precision, backed up as it is, would guess.

With `digits` the working precision is raised until every event is known to that many digits.
"""

from __future__ import annotations

from math import inf
from typing import Any

from symosc.advance import FAILED, REST
from symosc.errors import ParameterError
from symosc.exact import read_exact, show, whole_number
from symosc.model import MODE_NAMES, Parameters
from symosc.numerics import mp_context
from symosc.path import Path, Start, cut_event, rounded_event
from symosc.scenes import Scene, load_scene
from symosc.trajectory import MAP_LABELS, Event, Segment, Trajectory

ACCURACY = 1e-13
BACKUP_DIGITS = 36
# How many events a backup may have to compute at a stretch. Beyond, accuracy is given up (the error estimates say so).
LONGEST_BACKUP = 300
MOST_EVENTS = 1_000_000
MOST_DIGITS = 10_000
# With `digits`, a contact still open with this many times the digits is an exact touch ...
TOUCH_DIGITS = 3
# ... and more than that many times the digits are not tried.
MOST_WORKING = 12


def simulate(
    scene: Scene | Parameters | str,
    *,
    t0: Any = None,
    x0: Any = None,
    v0: Any = None,
    t_end: Any = None,
    max_events: int | None = None,
    digits: int | None = None,
    accuracy: float | None = None,
) -> Trajectory:
    """Follow the motion from a start to t_end, event by event, exactly.

    Parameters
    ----------
    scene : Scene, str or Parameters
        A scene or the name of one (t0, x0, v0 and t_end then replace the scene's own), or parameters.
    t0, x0, v0, t_end : number
        Start and end, read exactly like parameters; in the parameters' units.
    max_events : int, optional
        Stop after that many events (default 1,000,000).
    digits : int, optional
        None: double precision. An int: event times and positions are known to that many digits (mpmath), relative to
        max(1, |value|), as far as the error estimates tell.
    accuracy : float, optional
        In double precision, an event whose time or position is known to less than that (relative to max(1, |value|))
        is computed once more with 36 digits (default 1e-13). Where errors grow, a coarser one is faster; with
        ``math.inf`` only contacts that doubles cannot decide get more digits.

    Returns
    -------
    Trajectory

    Raises
    ------
    ParameterError
        If a number is missing, not finite or out of range, or both `digits` and `accuracy` are given.
    """
    start = _read_start(scene, {"t0": t0, "x0": x0, "v0": v0, "t_end": t_end})
    most = MOST_EVENTS if max_events is None else whole_number("max_events", max_events, 1)
    if digits is None:
        return _double(start, most, read_accuracy(accuracy))
    if accuracy is not None:
        raise ParameterError("accuracy", accuracy, f"is for double precision: leave it out with digits = {digits}")
    return _with_digits(start, most, whole_number("digits", digits, 5, MOST_DIGITS))


def _read_start(scene: Scene | Parameters | str, given: dict[str, Any]) -> Start:
    if isinstance(scene, str):
        scene = load_scene(scene)
    if isinstance(scene, Scene):
        parameters = scene.parameters
        given = {name: getattr(scene, name) if value is None else value for name, value in given.items()}
    elif isinstance(scene, Parameters):
        parameters = scene
    else:
        raise ParameterError("scene", scene, "give a Scene, the name of a scene, or Parameters")
    for name, value in given.items():
        if value is None:
            raise ParameterError(name, value, "is needed with parameters")
    start = Start(parameters, **{name: read_exact(name, value) for name, value in given.items()})
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


def _double(start: Start, most: int, accuracy: float) -> Trajectory:
    path, backup, trusted = Path(start), None, True
    while not path.ended:
        before = len(path.events)
        if before >= most:
            return _trajectory(path, "max_events", f"stopped after max_events = {most} events, at t = {path.time!r}")
        path.step()
        in_doubt = not path.decided or path.code == FAILED
        inexact = trusted and len(path.events) > before and _inexact(path.events[-1], accuracy)
        if before and len(path.events) > before and path.events[-1].t <= path.events[-2].t:
            return _unresolved(path)
        if not in_doubt and not inexact:
            continue
        backup = backup or Backup(start)
        outcome = backup.follow(before + 1)
        if outcome == FOLLOWED:
            path.adopt(backup.path)
        elif outcome == TOO_FAR and not in_doubt:
            # From here on accuracy is given up, and decisions are about this path, not about the true one nearby.
            trusted, path.K = False, path.K._replace(sigmas=0.0)
        else:
            return _undecidable(path if outcome == TOO_FAR else backup.path, before, backup.digits)
    return _trajectory(path, *_ending(path))


def _inexact(event: Event, accuracy: float) -> bool:
    scales = max(1.0, abs(event.t)), max(1.0, abs(event.x))
    return event.t_error > accuracy * scales[0] or event.x_error > accuracy * scales[1]


FOLLOWED, TOO_FAR, OPEN = "followed", "too far", "open"


class Backup:
    """The same problem with more digits, followed only as far as it is asked for."""

    def __init__(self, start: Start, digits: int = BACKUP_DIGITS) -> None:
        self.start, self.digits = start, digits
        self.path = Path(start, digits)
        self.finer: Path | None = None

    def follow(self, count: int) -> str:
        """Follow the path to `count` events or to its end: FOLLOWED, TOO_FAR (too many at a stretch) or OPEN."""
        path = self.path
        if count - len(path.events) > LONGEST_BACKUP:
            return TOO_FAR
        while len(path.events) < count and not path.ended:
            before = len(path.events)
            path.step()
            if path.code == FAILED or (not path.decided and not self._is_exact_touch(before)):
                return OPEN
        return FOLLOWED

    def _is_exact_touch(self, before: int) -> bool:
        """Tell whether the contact after `before` events is open with twice the digits too; if so, take that one."""
        self.finer = self.finer or Path(self.start, 2 * self.digits)
        finer = self.finer
        while len(finer.events) <= before and not finer.ended:
            finer.step()
            if not finer.decided and len(finer.events) >= before:
                if len(self.path.events) > before and len(finer.events) > before:
                    self.path.events[-1] = finer.events[-1]
                return True
        return False


def _with_digits(start: Start, most: int, digits: int) -> Trajectory:
    """Raise the working precision until every contact is decided and every event known to `digits` digits."""
    working = digits + 10
    while True:
        path = Path(start, working)
        touch = working >= TOUCH_DIGITS * digits  # a contact that is still open now is an exact touch
        while not path.ended and len(path.events) < most:
            before = len(path.events)
            path.step()
            if path.code == FAILED or not (path.decided or touch):
                break
        in_doubt = path.code == FAILED or not (path.decided or touch)
        missing = 0 if in_doubt else path.missing_digits(digits)
        if not in_doubt and missing <= 0:
            break
        if working > MOST_WORKING * digits:
            return _undecidable(path, before, working, digits)
        working += max(missing + 2, working // 2 if in_doubt else 0)
    if not path.ended:
        return _trajectory(path, "max_events", f"stopped after max_events = {most} events", digits)
    return _trajectory(path, *_ending(path), digits)


def _ending(path: Path) -> tuple[str, str]:
    """Return status and message of a path that came to its end."""
    state, p = path.state, path.start.parameters
    on_belt = state.mode > 3
    if path.code == REST and ((on_belt and state.v == 0) or (not on_belt and p.B0 == 0 and p.c > 0)):
        where = f"on belt {state.mode - 3}" if on_belt else f"in Omega{state.mode}"
        how = "at rest" if on_belt else "settling to rest"
        return "equilibrium", f"from t = {float(path.time)!r} {how} {where}, no event will come any more"
    return "t_end", f"reached t_end = {show(path.start.t_end)}"


def _unresolved(path: Path) -> Trajectory:
    """End a trajectory at two events whose times double precision cannot tell apart."""
    del path.events[-1:]
    when = f"the events after t = {path.events[-1].t!r} follow each other within one ulp"
    message = f"{when}; ask for more digits, such as digits={BACKUP_DIGITS}"
    return _trajectory(path, "undecidable", message)


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
        events, t0, last = [rounded_event(event) for event in events], float(t0), float(last)
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
    return Trajectory(path.start.parameters, events, segments, path.pieces, status, message, digits)
