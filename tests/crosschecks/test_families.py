"""Random families: right solutions are never blamed, however they are sampled; wrong ones are never
right.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import count as numbers
from itertools import islice
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from samples import sample_of
from solution_families import (
    METHODS,
    Flaws,
    Problem,
    Rng,
    Solution,
    UnclearError,
    even_times,
    problems,
    scales_of,
    solved,
)

from symosc import CrossCheck, Scene, crosscheck, simulate
from symosc.base.exact import read_exact

TOLERANCE = 1e-8
#: What the documented default allows to the whole solution: 1000 times the tolerance.
ALLOWED = 1000.0 * TOLERANCE


@dataclass
class Given:
    """What a user gives to `crosscheck`."""

    arguments: tuple[Any, ...]
    options: dict[str, Any] = field(default_factory=dict)
    ends_early: bool = False


def scene_of(problem: Problem) -> Scene:
    t0, x0, v0 = problem.start
    exact = {name: read_exact(name, value) for name, value in (("t0", t0), ("x0", x0), ("v0", v0))}
    return Scene("random", problem.p, **exact, t_end=read_exact("t_end", problem.t_end))  # type: ignore[arg-type]


def judged(problem: Problem, given: Given) -> CrossCheck:
    scene = problem.p if given.options.pop("free", False) else scene_of(problem)
    return crosscheck(scene, *given.arguments, partial=given.ends_early, **given.options)


# -- ways to give a right solution -----------------------------------------------------------------


def contact_times(solution: Solution, belt: int, until: float) -> np.ndarray:
    """Return what an event function v - v_belt of a solver finds: contacts, without slips."""
    return np.array(
        [t for t, kind, at in solution.events if at == belt and kind != "slip" and t <= until]
    )


def result(
    problem: Problem, solution: Solution, states: np.ndarray, until: float = np.inf, **more: Any
) -> Any:
    """Return an OdeResult with the events of v = v1 and v = v2 and those in `more`, which are no
    contacts.
    """
    speeds = float(problem.p.v1), float(problem.p.v2)
    lists = [contact_times(solution, belt, until) for belt in (1, 2)]
    at_belts = [
        np.array([[solution(t)[0, 0], speed] for t in times])
        for times, speed in zip(lists, speeds, strict=True)
    ]
    others = [np.asarray(times) for times in more.values()]
    return SimpleNamespace(
        t=states[0], y=states[1:], success=True, t_events=lists + others,
        y_events=at_belts + [solution(times).T if len(times) else np.empty(0) for times in others],
    )  # fmt: skip


def zeros_of_x(solution: Solution) -> np.ndarray:
    """Return when x passes 0, by lines between steps: an event function of a user that is no
    contact.
    """
    t, x, _ = solution.own_steps
    passes = np.flatnonzero(x[:-1] * x[1:] < 0.0)
    return np.array(
        t[passes] - x[passes] * (t[passes + 1] - t[passes]) / (x[passes + 1] - x[passes])
    )


def dense(problem: Problem, solution: Solution, rng: Rng) -> Given:
    t = even_times(problem, rng)
    return Given((t, *solution(t)))


def uneven(problem: Problem, solution: Solution, rng: Rng) -> Given:
    t = even_times(problem, rng)
    kept = np.unique([0, len(t) - 1, *rng.integers(0, len(t), len(t) // 2)])
    return Given((t[kept], *solution(t[kept])))


def own_steps(problem: Problem, solution: Solution, rng: Rng) -> Given:
    return Given(tuple(solution.own_steps))


def pieces(problem: Problem, solution: Solution, rng: Rng) -> Given:
    return Given(
        ([SimpleNamespace(t=piece[0], y=piece[1:], success=True) for piece in solution.steps],)
    )


def with_t_events(problem: Problem, solution: Solution, rng: Rng) -> Given:
    return Given((result(problem, solution, solution.own_steps, x=zeros_of_x(solution)),))


def terminal(problem: Problem, solution: Solution, rng: Rng) -> Given:
    """Return a solution that ends at one of its events, as an OdeResult or as columns."""
    if not solution.events:
        return dense(problem, solution, rng)
    end = solution.events[int(rng.integers(len(solution.events)))][0]
    steps = solution.own_steps[:, solution.own_steps[0] <= end]
    if steps[0, 0] == steps[0, -1]:
        return dense(problem, solution, rng)
    shape = int(rng.integers(4))
    if shape == 0:
        return Given((result(problem, solution, steps, end),), ends_early=True)
    if shape == 1:
        listed = [(t, kind) for t, kind, _ in solution.events if t <= end]
        return Given(tuple(steps), {"events": listed}, ends_early=True)
    if shape == 2:
        listed = [t for t, kind, _ in solution.events if t <= end]
        table = {
            "t": steps[0][:, None],
            "x": steps[1:].T,
            "te": listed,
            "xe": [solution(t)[:, 0] for t in listed],
        }
        return Given(
            (table | {"ie": [belt for _, _, belt in solution.events][: len(listed)]},),
            ends_early=True,
        )
    return Given(tuple(steps), ends_early=True)


def positions(problem: Problem, solution: Solution, rng: Rng) -> Given:
    t = even_times(problem, rng, 200)
    return Given((t, solution(t)[0]))


def positions_at_switches(problem: Problem, solution: Solution, rng: Rng) -> Given:
    """Return positions with samples 1e-9 to 1e-7 apart at the events, as a solver's step control
    makes them.
    """
    t = [even_times(problem, rng, 200)]
    for time, _, _ in solution.events:
        t.append(time + np.cumsum(10.0 ** rng.uniform(-9, -7, 8)) * rng.choice([-1, 1]))
        t.append(time + 10.0 ** rng.uniform(-9, -5, 6))
    times = np.unique(np.concatenate(t))
    times = times[(times >= problem.start[0]) & (times <= problem.t_end)]
    return Given((times, solution(times)[0]))


def rounded(problem: Problem, solution: Solution, rng: Rng) -> Given:
    t = even_times(problem, rng)
    decimals = int(rng.integers(2, 12))
    return Given((t, *np.round(solution(t), decimals)))


def function(problem: Problem, solution: Solution, rng: Rng) -> Given:
    return Given((lambda t: solution(t),), {"free": False})


def listed(problem: Problem, solution: Solution, rng: Rng) -> Given:
    t = even_times(problem, rng)
    return Given((t, *solution(t)), {"events": [(t, kind) for t, kind, _ in solution.events]})


WAYS: list[Callable[[Problem, Solution, Rng], Given]] = [
    dense, uneven, own_steps, pieces, with_t_events, terminal, positions, positions_at_switches, rounded, function,
    listed, terminal,
]  # fmt: skip


def exact_solution(problem: Problem, tight: Solution) -> Solution:
    """Return symosc's own motion as a solution with the steps of a tight one, after a comparison
    with it.
    """
    t, x, v = problem.start
    motion = simulate(problem.p, t0=t, x0=x, v0=v, t_end=problem.t_end)
    events = [
        (float(event.t), event.kind, event.boundary)
        for event in motion.events
        if event.kind != "graze"
    ]
    assert [event[1:] for event in events] == [event[1:] for event in tight.events]
    steps = [np.vstack([piece[0], motion(piece[0])]) for piece in tight.steps]
    dense_parts = [lambda t: np.array(motion(t))] * len(steps)
    return Solution(steps, dense_parts, tight.sticks, events)


def right_solutions(seed: int) -> Iterator[tuple[str, Problem, Given]]:
    """Yield right solutions of random problems by five integrators, each sampled in all ways."""
    rng = np.random.default_rng(seed)
    integrators = ["exact", *METHODS]
    for number, (problem, tight) in enumerate(problems(seed)):
        method = integrators[number % len(integrators)]
        try:
            solution = (
                exact_solution(problem, tight) if method == "exact" else solved(problem, method)
            )
        except UnclearError:
            continue
        t = np.linspace(problem.start[0], problem.t_end, 400)
        # What a solution may be off so that its own error is well below the tolerance.
        off = np.max(np.abs(solution(t) - tight(t)), axis=1)
        if np.any(off > 0.02 * TOLERANCE * scales_of(tight)):
            continue
        for way in WAYS:
            yield f"{number} by {method}, {way.__name__}", problem, way(problem, solution, rng)


@pytest.mark.slow
@sample_of(24, 2_000)
def test_right_solutions_are_never_blamed(count: int) -> None:
    blamed = []
    for name, problem, given in islice(right_solutions(7), count):
        check = judged(problem, given)
        if not check.ok:
            blamed.append(f"{name}: {problem}\n{verdict_text(check)}")
    assert blamed == [], f"{len(blamed)} of {count}"


def verdict_text(check: CrossCheck) -> str:
    counts = {
        name: len(getattr(check, name))
        for name in ("missed", "invented", "wrong_steps", "wrong_spans")
    }
    return f"{counts}, off by {check.max_error_x:.2g}, {check.max_error_v:.2g}; {check.notes} {check.wrong_start}"


# -- wrong solutions -------------------------------------------------------------------------------


def frozen(states: np.ndarray, rng: Rng) -> np.ndarray:
    """Return samples that stay as they are from some sample on."""
    since = int(rng.integers(1, states.shape[1] // 2))
    states = states.copy()
    states[1:, since:] = states[1:, since : since + 1]
    return states


def jumped(states: np.ndarray, rng: Rng) -> np.ndarray:
    """Return samples whose x jumps once."""
    states = states.copy()
    states[1, int(rng.integers(1, states.shape[1])) :] += 10.0 ** rng.uniform(-4, -1) * np.ptp(
        states[1]
    )
    return states


def factor(name: str, low: float, high: float) -> Callable[[Problem, Rng], Problem]:
    def changed(problem: Problem, rng: Rng) -> Problem:
        part = 1.0 + float(rng.choice([-1, 1])) * 10.0 ** rng.uniform(np.log10(low), np.log10(high))
        return replace(
            problem, p=problem.p.replace(**{name: float(getattr(problem.p, name)) * part})
        )

    return changed


def replaced(**values: Callable[[Any], Any]) -> Callable[[Problem, Rng], Problem]:
    return lambda problem, rng: replace(
        problem, p=problem.p.replace(**{name: change(problem.p) for name, change in values.items()})
    )


def shifted(problem: Problem, rng: Rng) -> Problem:
    ahead = 10.0 ** rng.uniform(-4, -0.5) / problem.rate
    t, x, v = problem.start
    return Problem(problem.p, (t + ahead, x, v), problem.t_end + ahead)


#: Wrong solutions: another problem is solved, or the solver has flaws, or right samples are spoilt.
OTHER_PROBLEMS: dict[str, Callable[[Problem, Rng], Problem]] = {
    "no friction": replaced(FN=lambda p: 0),
    "no friction of belt 1": replaced(mu1=lambda p: 0),
    "half the friction": replaced(FN=lambda p: p.FN / 2),
    "k": factor("k", 1e-4, 0.1),
    "m": factor("m", 1e-4, 0.1),
    "B0": factor("B0", 1e-4, 0.1),
    "Omega": factor("Omega", 1e-4, 0.1),
    "FN": factor("FN", 1e-4, 0.1),
    "sign of B0": replaced(B0=lambda p: -p.B0),
    "shifted clock": shifted,
}
FLAWS: dict[str, Callable[[Rng], Flaws]] = {
    "ignored belt": lambda rng: Flaws(unseen=1),
    "missed switching": lambda rng: Flaws(
        late=int(rng.integers(0, 3)), delay=10.0 ** rng.uniform(-4, 0)
    ),
    "late events": lambda rng: Flaws(late=0, delay=10.0 ** rng.uniform(-4, -1)),
    "stick left late": lambda rng: Flaws(static=1.0 + 10.0 ** rng.uniform(-3, 0)),
}
SPOILT: dict[str, Callable[[np.ndarray, Rng], np.ndarray]] = {"frozen": frozen, "jumped": jumped}
#: A wrong solution need not be integrated well.
LOOSE = {"rtol": 1e-8, "atol": 1e-9, "max_step": 0.5}
KINDS = [*OTHER_PROBLEMS, *FLAWS, *SPOILT]


@dataclass
class Wrong:
    """A wrong solution, and how far it is from the right one, in units of what is allowed to it."""

    name: str
    problem: Problem
    given: Given
    deviation: float


def wrong_solutions(seed: int) -> Iterator[Wrong]:
    """Yield wrong solutions of random problems, a kind after the other, in some ways to give
    them.
    """
    rng = np.random.default_rng(seed)
    number = numbers()
    for problem, right in problems(seed):
        for _ in range(12):
            kind = KINDS[next(number) % len(KINDS)]
            t = even_times(problem, rng, 60, 400)
            exact = right(t)
            if kind in SPOILT:
                states = SPOILT[kind](np.vstack([t, exact]), rng)
            else:
                try:
                    states = _solved_wrongly(kind, problem, t, rng)
                except UnclearError:
                    continue
            way = str(
                rng.choice(["columns", "parameters", "pieces", "positions", "rounded", "function"])
            )
            if way == "positions" and (len(t) < 200 or kind in SPOILT):
                way = "columns"
            limits = ALLOWED * scales_of(right)
            off = np.abs(states[1:] - exact)
            if way == "rounded":
                decimals = int(rng.integers(2, 9))
                states[1:] = np.round(states[1:], decimals)
                # The documented limit: 5 last places, or 1000 times the tolerance where that is more, beside the
                # rounding of the sample and what the exact motion makes of that of the first one.
                speed = max(1.0, float(problem.p.k / problem.p.m) ** 0.5)
                limits = (
                    limits + (5.0 + 0.5 + 0.5 * 2.0 * max(speed, 1.0 / speed)) * 10.0**-decimals
                )
            if way == "positions":
                off[1] = 0.0
            deviation = float(np.max(off / limits[:, None]))
            yield Wrong(f"{kind}, {way}", problem, _given(way, states), deviation)


def _solved_wrongly(kind: str, problem: Problem, t: np.ndarray, rng: Rng) -> np.ndarray:
    """Return samples t, x, v of a wrong solution at times `t`."""
    if kind in FLAWS:
        flaws = FLAWS[kind](rng)
        flaws = replace(flaws, delay=flaws.delay / problem.rate)
        return np.vstack([t, solved(problem, flaws=flaws, **LOOSE)(t)])
    changed = OTHER_PROBLEMS[kind](problem, rng)
    ahead = changed.start[0] - problem.start[0]
    return np.vstack([t, solved(changed, **LOOSE)(t + ahead)])


def _given(way: str, states: np.ndarray) -> Given:
    """Return samples in a way in which users give them."""
    if way == "parameters":
        return Given(tuple(states), {"free": True})
    if way == "pieces":
        parts = np.array_split(np.arange(states.shape[1]), 3)
        ends = [np.append(part, min(part[-1] + 1, states.shape[1] - 1)) for part in parts[:-1]] + [
            parts[-1]
        ]
        return Given(
            (
                [
                    SimpleNamespace(t=states[0, part], y=states[1:, part], success=True)
                    for part in ends
                ],
            )
        )
    if way == "positions":
        return Given(tuple(states[:2]))
    if way == "function":
        t, x, v = states
        return Given((t, lambda s: np.array([np.interp(s, t, x), np.interp(s, t, v)])))
    return Given(tuple(states))


@pytest.mark.slow
@sample_of(24, 2_000)
def test_wrong_solutions_are_never_right(count: int) -> None:
    """A solution is wrong if it is further from the right one than the documented limit for the
    whole solution.
    """
    passed = []
    counted = Counter[str]()
    for wrong in islice((wrong for wrong in wrong_solutions(11) if wrong.deviation > 1.0), count):
        counted[wrong.name.partition(",")[0]] += 1
        check = judged(wrong.problem, wrong.given)
        if check.ok:
            passed.append(
                f"{wrong.name}, {wrong.deviation:.3g} times what is allowed: {wrong.problem}"
            )
    assert passed == [], f"{len(passed)} of {count}"
    assert count < 1_000 or min(counted[kind] for kind in KINDS) >= count // (4 * len(KINDS))
