"""The judge: compares what the engine says of a scene with what the oracle knows."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
from oracle import OracleRun, simulate_oracle
from scene_families import FuzzScene, with_digits

from symosc import simulate, simulate_many

# An event farther than that (relative to max(1, |t|)), or than its estimate allows, from an
# oracle's is another one.
SAME_EVENT = 1e-6
# An error may be that many times the standard error that was estimated.
MOST_ESTIMATES = 5.0
# A push (relative) that is larger than what rounding does to the parameters and the start.
PUSH = Fraction(1, 10**13)
# A force that is smaller than that part of its terms is lost in the rounding of doubles.
LOST = 1e-12
# Errors below are those of the fast oracle.
EXACT = 1e-27
MOST_DIGITS = 700
SLOW = 1.0  # seconds in all, and
SLOW_EVENT = 0.02  # seconds per event
COLUMNS = ("t", "x", "v", "theta", "t_error", "x_error", "kind", "boundary", "source", "target")

# Faults that depend on what the oracle says happens.
DOUBTFUL = {"missed", "invented", "wrong kind", "undecidable", "status", "end", "digits"}

Oracle = Callable[..., OracleRun]


@dataclass
class Verdict:
    """What was found wrong with a scene: (fault, detail) pairs, and figures."""

    scene: FuzzScene
    faults: list[tuple[str, str]] = field(default_factory=list)
    events: int = 0
    ratios: list[float] = field(default_factory=list)
    status: str = ""
    seconds: float = 0.0

    def add(self, fault: str, detail: str) -> None:
        self.faults.append((fault, detail))


def truth_of(scene: FuzzScene, oracle: Oracle = simulate_oracle) -> OracleRun:
    """Return the run in closed form if it is known, else the oracle's."""
    if scene.truth is not None:
        return scene.truth()
    return oracle(scene.p, scene.t0, scene.x0, scene.v0, scene.t_end, scene.dps)


def settled(scene: FuzzScene) -> FuzzScene:
    """Return the scene with so many digits that more do not change what the oracle says happens."""
    if scene.truth is not None:
        return scene
    digits = scene.dps + 20
    before = None
    while digits < MOST_DIGITS:
        scene = with_digits(scene, dps=digits)
        events = [(*label(event), mpmath.nstr(event.t, 8)) for event in truth_of(scene).events]
        if events == before:
            return scene
        digits = digits + digits // 2
        before = events
    raise ArithmeticError(f"the oracle is not sure with {digits} digits")


def judge(
    scene: FuzzScene,
    oracle: Oracle = simulate_oracle,
    digits: Sequence[int] = (),
    numba: Sequence[bool] = (False,),
) -> Verdict:
    """Compare `simulate`, `simulate_many` (with and without numba) and `simulate(digits=)` with the truth."""
    verdict = Verdict(scene)
    truth = truth_of(scene, oracle)
    verdict.events = len(truth.events)
    begin = time.perf_counter()
    trajectory = _run(verdict)
    verdict.seconds = time.perf_counter() - begin
    if verdict.seconds > SLOW and verdict.seconds > SLOW_EVENT * max(1, verdict.events):
        verdict.add("slow", f"{verdict.seconds:.1f} s for {verdict.events} events")
    if trajectory is not None:
        verdict.status = trajectory.status
        compare(verdict, trajectory, truth, oracle)
        _check_end(verdict, trajectory, truth)
        for use_numba in numba:
            _compare_many(verdict, trajectory, use_numba)
    for count in digits:
        if (exact := _run(verdict, digits=count)) is not None:
            compare(verdict, exact, truth, oracle, count)
    return verdict


def _run(verdict: Verdict, **options: Any) -> Any:
    scene = verdict.scene
    try:
        return simulate(
            scene.p, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end, **options
        )
    except Exception as error:
        verdict.add("exception", f"simulate {options}: {type(error).__name__}: {error}")
        return None


def label(event: Any) -> tuple[str, int, str, str]:
    return event.kind, int(event.boundary), event.source, event.target


def show(event: Any) -> str:
    return (
        f"{event.kind} {event.source}->{event.target} at t = {mpmath.nstr(mpmath.mpf(event.t), 17)}"
    )


def compare(
    verdict: Verdict, trajectory: Any, truth: OracleRun, oracle: Oracle, digits: int | None = None
) -> None:
    """Find the first event that differs, and the errors of those before it."""
    if digits is None:
        prefix = ""
    else:
        prefix = f"digits={digits}: "
    ours = list(trajectory.events)
    theirs = truth.events
    same = 0
    with mpmath.workdps(60):
        for event, expected in zip(ours, theirs, strict=False):
            if label(event) != label(expected) or not _near(event, expected):
                break
            _check_errors(verdict, event, expected, digits, prefix)
            same += 1
        mine = ours[same : same + 1]
        other = theirs[same : same + 1]
        if not mine and trajectory.status == "undecidable":
            # Allowed where a push of the start as small as rounding changes what comes next.
            if digits is None and (
                verdict.scene.touch or _is_open(verdict.scene, truth, oracle, same)
            ):
                verdict.status = "doubt"
            else:
                verdict.add(
                    "undecidable",
                    f"{prefix}after {same} of {len(theirs)} events: {trajectory.message}",
                )
        elif mine or other:
            invented = not other or (mine and mine[0].t < other[0].t)
            kind = mine and other and _near(mine[0], other[0])
            said = ", expected ".join(
                " ".join(map(show, each)) or "nothing" for each in (mine, other)
            )
            where = f"{prefix}event {same} ({len(ours)} events, {len(theirs)} expected, status {verdict.status})"
            if kind:
                fault = "wrong kind"
            elif invented:
                fault = "invented"
            else:
                fault = "missed"
            verdict.add(fault, f"{where}: {said}")


def _near(event: Any, expected: Any) -> bool:
    allowed = SAME_EVENT * max(1, abs(expected.t)) + 10 * min(event.t_error, 1e-2)
    return bool(abs(mpmath.mpf(event.t) - expected.t) <= allowed)


def _check_errors(
    verdict: Verdict, event: Any, expected: Any, digits: int | None, prefix: str
) -> None:
    for name in ("t", "x"):
        value = mpmath.mpf(getattr(event, name))
        true = getattr(expected, name)
        error = float(abs(value - true))
        estimate = float(getattr(event, f"{name}_error"))
        if not (error > EXACT * max(1, abs(true))):
            error = 0.0
        if digits is not None:
            if error > 10.0**-digits * max(1, abs(true)):
                verdict.add("digits", f"{prefix}{name} off by {error:.1e} in {show(event)}")
            continue
        if estimate:
            ratio = error / estimate
        elif error == 0.0:
            ratio = 0.0
        else:
            ratio = np.inf
        verdict.ratios.append(ratio)
        if ratio > MOST_ESTIMATES:
            verdict.add(
                "estimate", f"{name} off by {error:.1e}, estimated {estimate:.1e}, in {show(event)}"
            )


def _is_open(scene: FuzzScene, truth: OracleRun, oracle: Oracle, same: int) -> bool:
    if scene.truth is not None:  # known in closed form, whatever a push does
        return False
    expected = [label(event) for event in truth.events[: same + 2]]
    p = scene.p
    if same < len(truth.events) and _is_faint(p, truth.events[same]):
        return True
    scale = 1 + abs(scene.x0)
    changes: list[dict[str, Any]] = [
        {"x0": scene.x0 + PUSH * scale},
        {"x0": scene.x0 - PUSH * scale},
        {"p": p.replace(A0=p.A0 + PUSH * (abs(p.A0) + p.FN))},
        {"p": p.replace(B0=p.B0 * (1 + PUSH))},
    ]
    if scene.v0 not in (p.v1, p.v2):
        changes += [{"v0": scene.v0 + sign * PUSH * (1 + abs(scene.v0))} for sign in (1, -1)]
    for change in changes:
        pushed = with_digits(scene, truth=None, dps=max(33, min(scene.dps, 60)), **change)
        if [label(event) for event in truth_of(pushed, oracle).events[: same + 2]] != expected:
            return True
    return False


def _is_faint(p: Any, event: Any) -> bool:
    """Tell whether the acceleration with which a flight meets a belt is lost in the rounding of its terms."""
    if event.source.startswith("belt"):
        return False
    with mpmath.workdps(60):
        A, B0, k, c, Omega = (
            mpmath.mpf(value.numerator) / value.denominator
            for value in (p.A(int(event.source[-1])), p.B0, p.k, p.c, p.Omega)
        )
        terms = [A, B0 * mpmath.cos(Omega * event.t), -k * event.x, -c * event.v]
        return bool(abs(sum(terms)) <= LOST * sum(map(abs, terms)))


def _check_end(verdict: Verdict, trajectory: Any, truth: OracleRun) -> None:
    """Check the status, and the state at the end."""
    if verdict.faults or trajectory.status == "undecidable":
        return
    p = verdict.scene.p
    scene = verdict.scene
    if trajectory.status not in ("t_end", "equilibrium"):
        verdict.add("status", f"{trajectory.status}: {trajectory.message}")
    if trajectory.status == "equilibrium" and p.B0 != 0 and not truth.mode.startswith("belt"):
        verdict.add("status", f"equilibrium, but B0 = {p.B0} in {truth.mode}")
    if truth.x is None:
        return
    for event in trajectory.events[:5]:
        clear = (
            np.spacing(event.t) < 1e-10
        )  # later than that a double does not tell where the mass is
        if clear and abs(trajectory(event.t)[0] - event.x) > 1e-9 * max(
            1.0, abs(event.x), abs(event.v)
        ):
            verdict.add("end", f"the trajectory at {event.t!r} is not where its event is")
    x = trajectory(trajectory.t_end)[0]
    with mpmath.workdps(60):
        worst = max(
            (event.x_error / max(1, abs(event.x)) for event in trajectory.events), default=0.0
        )
        late = float(np.spacing(float(scene.t_end))) * max(1.0, abs(float(truth.v)))
        if abs(x - truth.x) > (1e-9 + 1e4 * worst) * max(1, abs(truth.x)) + 4 * late:
            verdict.add("end", f"x = {x!r} at t_end, expected {mpmath.nstr(truth.x, 17)}")


def _compare_many(verdict: Verdict, trajectory: Any, use_numba: bool) -> None:
    """Compare `simulate_many` with `simulate`: the same codes, and numbers within their errors."""
    scene = verdict.scene
    name = f"simulate_many(use_numba={use_numba})"
    try:
        table = simulate_many(
            scene.p, [(scene.t0, scene.x0, scene.v0)], scene.t_end, use_numba=use_numba
        )
    except Exception as error:
        verdict.add("disagree", f"{name}: {type(error).__name__}: {error}")
        return
    if table.status[0] != trajectory.status:
        verdict.add("disagree", f"{name}: status {table.status[0]}, simulate {trajectory.status}")
    if len(table) != len(trajectory.events):
        verdict.add("disagree", f"{name}: {len(table)} events, simulate {len(trajectory.events)}")
        return
    errors = {"t": table.t_error, "x": table.x_error, "theta": float(scene.p.Omega) * table.t_error}
    for column in COLUMNS:
        here = np.array([getattr(event, column) for event in trajectory.events])
        there = getattr(table, column)
        if column in ("t_error", "x_error"):
            same = (here <= 2 * there) & (there <= 2 * here)
        elif column in errors:
            apart = abs(here - there)
            same = (
                np.minimum(apart, 2 * np.pi - apart if column == "theta" else apart)
                <= 2 * errors[column]
            )
        else:
            same = here == there
        if not same.all():
            i = int(np.flatnonzero(~same)[0])
            verdict.add("disagree", f"{name}: {column}[{i}] = {there[i]!r}, simulate {here[i]!r}")
            return
