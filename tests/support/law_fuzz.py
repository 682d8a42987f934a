"""Attack the package with random friction laws and an independent oracle.

Python tests/support/law_fuzz.py --scenes 5000 --seed 1

Prints a table per family and every failing scene as a Python snippet. Exits 1 if a scene failed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import cycle, islice
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
from law_families import CURVES, FAMILIES, NUMBERS, STATIC, LawScene, scene_of, with_changes
from law_oracle import LawRun, Motion
from tabulate import tabulate

BULK = 40  # digits of the first answer
MORE = (60, 100, 160)  # of the next ones, where it is undecided or differs
#: An event farther than that (relative to max(1, |t|)), or than its estimate allows, is another one.
SAME_EVENT = 1e-6
MOST_ESTIMATES = 5.0  # times the estimated error that an error may be
PUSH = Fraction(1, 10**13)  # a relative push that is larger than what rounding does
EXACT = 1e-27  # errors below are those of the oracle with `BULK` digits
FAULTS = (
    "missed", "invented", "wrong kind", "undecidable", "status", "end", "estimate", "digits",
    "exception", "unjudged",
)  # fmt: skip
DIGITS_EVERY = 10  # every so many scenes of a family are run with digits = 20 too


@dataclass
class LawVerdict:
    """What was found wrong: (fault, detail) pairs, and figures.

    Attributes
    ----------
    events : int
        As many as the oracle has.
    ratios : list of float
        Errors over their estimates.
    doubt : bool
        It ended as "undecidable", rightly.
    """

    scene: LawScene
    faults: list[tuple[str, str]] = field(default_factory=list)
    events: int = 0
    ratios: list[float] = field(default_factory=list)
    doubt: bool = False

    def add(self, fault: str, detail: str) -> None:
        self.faults.append((fault, detail))


# -- the oracle's answer ---------------------------------------------------------------------------


def truth_of(scene: LawScene, digits: int = BULK) -> LawRun:
    """Return the oracle's run with so many digits that it decides everything."""
    run = scene.truth(digits)
    for more in MORE:
        if run.status != "undecided":
            break
        if more > digits:
            run = scene.truth(more)
    return run


# -- the judge -------------------------------------------------------------------------------------


def compare(
    scene: LawScene,
    events: Sequence[Any],
    status: str,
    accuracy: float | None = None,
    end: tuple[Any, Any] | None = None,
) -> LawVerdict:
    """Judge somebody's events (t, x, kind, boundary, source, target) of a scene.

    Parameters
    ----------
    accuracy : float, optional
        Error of t and x that is allowed, relative to max(1, |value|). None: each event's own
        estimates `t_error` and `x_error` are judged.
    end : tuple, optional
        x and v at `t_end`.
    """
    verdict = _compare(scene, truth_of(scene), events, status, accuracy, end)
    if verdict.faults:  # before somebody is blamed, the oracle is asked for more digits
        verdict = _compare(scene, truth_of(scene, MORE[1]), events, status, accuracy, end)
    return verdict


def _compare(
    scene: LawScene,
    truth: LawRun,
    events: Sequence[Any],
    status: str,
    accuracy: float | None,
    end: tuple[Any, Any] | None,
) -> LawVerdict:
    verdict = LawVerdict(scene, events=len(truth.events))
    same = 0
    with mpmath.workdps(60):
        for event, expected in zip(events, truth.events, strict=False):
            if label(event) != label(expected) or not _near(event, expected):
                break
            _check_errors(verdict, event, expected, accuracy)
            same += 1
        ours = list(events[same : same + 1])
        theirs = truth.events[same : same + 1]
        if truth.status == "undecided" and same == len(truth.events):
            verdict.doubt = True  # nobody knows what comes next
            return verdict
        if not ours and status == "undecidable":
            if scene.near or _is_open(scene, truth, same):
                verdict.doubt = True
            else:
                verdict.add("undecidable", f"after {same} of {len(truth.events)} events")
        elif ours or theirs:
            said = ", expected ".join(
                " ".join(map(show, some)) or "nothing" for some in (ours, theirs)
            )
            counts = f"event {same} ({len(events)}, {len(truth.events)} expected, {status})"
            verdict.add(_fault(ours, theirs), f"{counts}: {said}")
        elif not _ended_as(truth.status, status):
            verdict.add("status", f"{status}, expected {truth.status}")
        elif end is not None and truth.status == "t_end":
            _check_end(verdict, truth, events, end, accuracy)
    return verdict


def label(event: Any) -> tuple[str, int, str, str]:
    return event.kind, int(event.boundary), event.source, event.target


def show(event: Any) -> str:
    t = mpmath.nstr(mpmath.mpf(event.t), 17)
    return f"{event.kind} {event.source}->{event.target} at t = {t}"


def _fault(ours: list[Any], theirs: list[Any]) -> str:
    if ours and theirs and _near(ours[0], theirs[0]):
        return "wrong kind"
    if not theirs or (ours and ours[0].t < theirs[0].t):
        return "invented"
    return "missed"


def _ended_as(expected: str, status: str) -> bool:
    if expected == "t_end":
        return status in ("t_end", "equilibrium")
    return status == expected


def _near(event: Any, expected: Any) -> bool:
    estimate = float(getattr(event, "t_error", 0.0))
    allowed = SAME_EVENT * max(1, abs(expected.t)) + 10 * min(estimate, 1e-2)
    return bool(abs(mpmath.mpf(event.t) - expected.t) <= allowed)


def _check_errors(verdict: LawVerdict, event: Any, expected: Any, accuracy: float | None) -> None:
    for name in ("t", "x"):
        true = getattr(expected, name)
        error = float(abs(mpmath.mpf(getattr(event, name)) - true))
        size = max(1.0, float(abs(true)))
        if accuracy is not None:
            if error > accuracy * size:
                verdict.add("digits", f"{name} off by {error:.1e} in {show(event)}")
            continue
        if error <= EXACT * size:
            error = 0.0
        estimate = float(getattr(event, f"{name}_error"))
        ratio = 0.0
        if error:
            ratio = error / estimate if estimate else np.inf
        verdict.ratios.append(ratio)
        if ratio > MOST_ESTIMATES:
            verdict.add(
                "estimate", f"{name} off by {error:.1e}, estimated {estimate:.1e}, in {show(event)}"
            )


def _check_end(
    verdict: LawVerdict,
    truth: LawRun,
    events: Sequence[Any],
    end: tuple[Any, Any],
    accuracy: float | None,
) -> None:
    """Check the state at the end: within what the errors of the events allow."""
    allowed = accuracy
    if allowed is None:
        worst = max((float(event.x_error) / max(1, abs(event.x)) for event in events), default=0.0)
        allowed = 1e-9 + 1e4 * worst
    late = float(np.spacing(float(verdict.scene.t_end)))
    for name, value in zip("xv", end, strict=True):
        true = getattr(truth, name)
        size = max(1, abs(truth.x), abs(truth.v))
        if abs(mpmath.mpf(value) - true) > allowed * size + 8 * late * size:
            verdict.add("end", f"{name} = {value!r} at t_end, expected {mpmath.nstr(true, 17)}")


def _is_open(scene: LawScene, truth: LawRun, same: int) -> bool:
    """Whether a push as small as rounding changes what comes next."""
    if any(event.tie for event in truth.events[same : same + 1]):
        return True
    expected = [label(event) for event in truth.events[: same + 2]]
    size = 1 + abs(scene.x0)
    force = abs(scene.A0) + scene.FN
    changes: list[dict[str, Any]] = []
    for side in (1, -1):
        changes.append({"x0": scene.x0 + side * PUSH * size})
        changes.append({"A0": scene.A0 + side * PUSH * force})
        changes.append({"B0": scene.B0 * (1 + side * PUSH)})
        if all(scene.v0 != belt.v for belt in scene.belts):
            changes.append({"v0": scene.v0 + side * PUSH * (1 + abs(scene.v0))})
    for change in changes:
        pushed = truth_of(with_changes(scene, max_events=same + 2, **change))
        if [label(event) for event in pushed.events[: same + 2]] != expected:
            return True
    return False


# -- whom to judge ---------------------------------------------------------------------------------

Solver = Callable[[LawScene], LawVerdict]


def stand_in(scene: LawScene, digits: int = 50, motion: type[Motion] = Motion) -> LawVerdict:
    """Judge the oracle itself, with fewer digits: what tests this harness."""
    run = scene.truth(digits, motion)
    status = "undecidable" if run.status == "undecided" else run.status
    events = [
        SimpleNamespace(
            **event._asdict(),
            t_error=10.0 ** (8 - digits) * max(1, abs(event.t)),
            x_error=10.0 ** (8 - digits) * max(1, abs(event.x)),
        )
        for event in run.events
    ]
    return compare(scene, events, status, end=(run.x, run.v))


def oscillator_of(scene: LawScene) -> Any:
    """Return the scene's law as the package's."""
    import symosc

    belts = []
    for belt in scene.belts:
        options = {"mu_s": belt.mu_s}
        if belt.curve is not None:
            options |= {"curve": list(belt.curve), "slope": belt.slope}
        belts.append(symosc.Belt(belt.v, belt.mu, **options))
    return symosc.Oscillator(**{name: getattr(scene, name) for name in NUMBERS}, belts=belts)


def package(scene: LawScene, digits: int | None = None) -> LawVerdict:
    """Judge `simulate`."""
    from symosc import simulate

    trajectory = simulate(
        oscillator_of(scene), t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end,
        max_events=scene.max_events, digits=digits,
    )  # fmt: skip
    end = None
    if trajectory.status in ("t_end", "equilibrium") and digits is None:
        end = tuple(trajectory(float(scene.t_end)))
    accuracy = None if digits is None else 10.0**-digits
    return compare(scene, list(trajectory.events), trajectory.status, accuracy, end)


def many(scene: LawScene, use_numba: bool, accuracy: float | None = None) -> LawVerdict:
    """Judge `simulate_many`, up to the events of the scene."""
    from symosc import simulate_many

    table = simulate_many(
        oscillator_of(scene), [(scene.t0, scene.x0, scene.v0)], scene.t_end,
        max_events=scene.max_events, use_numba=use_numba, accuracy=accuracy,
    )  # fmt: skip
    columns = ("t", "x", "t_error", "x_error", "kind", "boundary", "source", "target")
    events = [
        SimpleNamespace(**{name: getattr(table, name)[i] for name in columns})
        for i in range(len(table))
    ]
    return compare(scene, events, str(table.status[0]))


SOLVERS: dict[str, Solver] = {
    "simulate": package,
    "digits": lambda scene: package(scene, 20),
    "many": lambda scene: many(scene, False),
    "compiled": lambda scene: many(scene, True),
    # Doubles are never so accurate: each event is found in pairs.
    "pairs": lambda scene: many(scene, True, 1e-17),
    "oracle": stand_in,
}


def verdict_of(scene: LawScene, solvers: Iterable[str]) -> LawVerdict:
    """Judge each solver; every so many scenes only for "digits"."""
    total = LawVerdict(scene)
    for name in solvers:
        if name == "digits" and scene.number % DIGITS_EVERY:
            continue
        try:
            verdict = SOLVERS[name](scene)
        except ArithmeticError as error:
            total.add("unjudged", f"{name}: {error}")
        except Exception as error:
            total.add("exception", f"{name}: {type(error).__name__}: {error}")
        else:
            total.faults += [(fault, f"{name}: {detail}") for fault, detail in verdict.faults]
            total.events = max(total.events, verdict.events)
            total.ratios += verdict.ratios
            total.doubt |= verdict.doubt
    return total


# -- the command -----------------------------------------------------------------------------------


def table(verdicts: list[LawVerdict]) -> str:
    """Return one row per family: scenes with each fault, and quantiles of error over estimate."""
    rows = []
    for family in FAMILIES:
        mine = [verdict for verdict in verdicts if verdict.scene.family == family]
        if not mine:
            continue
        faults = Counter(
            name for verdict in mine for name in {fault for fault, _ in verdict.faults}
        )
        ratios = [ratio for verdict in mine for ratio in verdict.ratios] or [0.0]
        quantiles = [f"{value:.2g}" for value in np.quantile(ratios, [0.5, 0.99, 1])]
        events = sum(verdict.events for verdict in mine)
        doubts = sum(verdict.doubt for verdict in mine)
        counts = [faults[name] or "" for name in FAULTS]
        rows.append([family, len(mine), events, doubts or "", *counts, *quantiles])
    heads = ["family", "scenes", "events", "in doubt", *FAULTS, "50 %", "99 %", "worst"]
    return tabulate(rows, heads)


def report(verdict: LawVerdict, seed: int) -> str:
    """Return a failing scene as a snippet, with what is wrong as comments."""
    scene = verdict.scene
    lines = [f"# {scene.family} seed {seed} number {scene.number}"]
    lines += [f"# {fault}: {detail}" for fault, detail in verdict.faults[:4]]
    return "\n".join([*lines, scene.snippet()])


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of each family's first scene")
    parser.add_argument("--family", choices=FAMILIES, action="append")
    parser.add_argument("--belts", type=int, default=2, help="at most, of a law")
    parser.add_argument("--curves", action="store_true", help="curves too")
    parser.add_argument("--solver", choices=SOLVERS, action="append", help="default: simulate")
    parser.add_argument("--show", type=int, default=10, help="snippets to print per family")
    options = parser.parse_args(arguments)
    families = options.family or list(STATIC | CURVES if options.curves else STATIC)
    solvers = options.solver or ["simulate", "digits"]
    begin = time.perf_counter()
    verdicts = []
    shown = Counter[str]()
    for i, family in enumerate(islice(cycle(families), options.scenes)):
        number = options.first + i // len(families)
        scene = scene_of(family, options.seed, number, options.belts)
        verdict = verdict_of(scene, solvers)
        verdicts.append(verdict)
        shown[family] += bool(verdict.faults)
        if verdict.faults and shown[family] <= options.show:
            print(report(verdict, options.seed), flush=True)
    failed = sum(bool(verdict.faults) for verdict in verdicts)
    spent = time.perf_counter() - begin
    print(f"\n{table(verdicts)}\n{failed} of {len(verdicts)} scenes failed, {spent:.0f} s")
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main())
