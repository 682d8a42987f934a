"""The ways in which a solution is given to `crosscheck`, and what is told of one that is blamed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import SimpleNamespace
from typing import Any

import numpy as np
from stiction_solver import Solved

from symosc import CrossCheck, Oscillator, Scene, crosscheck, simulate

Rng = np.random.Generator
Start = tuple[float, float, float]
Given = tuple[tuple[Any, ...], dict[str, Any]]
TOLERANCE = 1e-8


def scene_of(p: Oscillator, start: Start, t_end: float) -> Scene:
    return Scene("random", p, *start, t_end)  # type: ignore[arg-type]


def told(check: CrossCheck) -> str:
    counts = {
        name: len(getattr(check, name))
        for name in ("missed", "invented", "wrong_steps", "wrong_spans")
    }
    return (
        f"{counts}, off by {check.max_error_x:.2g}, {check.max_error_v:.2g}; "
        f"{check.notes} {check.first_wrong}"
    )


def off_by(right: Solved, t: np.ndarray, states: np.ndarray) -> float:
    """Return by how many times a thousand tolerances states differ from a right solution."""
    exact = right(t)
    limits = 1000.0 * TOLERANCE * np.max(np.abs(exact), axis=1)
    return float(np.max(np.abs(states - exact) / limits[:, None]))


def even(t_end: float, rng: Rng, least: int = 60, most: int = 800) -> np.ndarray:
    return np.linspace(0.0, t_end, int(rng.integers(least, most)))


def columns(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    t = even(t_end, rng)
    return (t, *solution(t)), {}


def coarse(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    t = np.unique([0.0, t_end, *rng.uniform(0.0, t_end, int(rng.integers(8, 40)))])
    return (t, *solution(t)), {}


def decimals(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    t = even(t_end, rng)
    return (t, *np.round(solution(t), int(rng.integers(6, 13)))), {}


def positions(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    t = even(t_end, rng, 400, 1200)
    return (t, solution(t)[0]), {}


def with_list(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    t = even(t_end, rng)
    return (t, *solution(t)), {"events": events}


def function(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    return (lambda t: solution(t),), {}


def own_steps(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    if isinstance(solution, Solved):
        return tuple(solution.own_steps), {}
    times = np.unique([0.0, t_end, *(t for t, _ in events), *even(t_end, rng)])
    return (times, *solution(times)), {}


def result(solution: Any, t_end: float, events: Any, rng: Rng) -> Given:
    if isinstance(solution, Solved):
        t, *states = solution.own_steps
    else:
        t = even(t_end, rng)
        states = list(solution(t))
    return (SimpleNamespace(t=t, y=np.array(states), success=True),), {}


WAYS: list[Callable[..., Given]] = [
    columns,
    coarse,
    decimals,
    own_steps,
    with_list,
    positions,
    function,
    result,
]


def blamed_solutions(problems: Iterable[tuple[Any, ...]]) -> list[str]:
    """Return what is told of right solutions that are blamed, given in one way after the other.

    Of two solutions in turn one is the exact motion, the other that of an independent solver.
    """
    blamed = []
    for number, (p, start, t_end, right, rng) in enumerate(problems):
        scene = scene_of(p, start, t_end)
        motion = simulate(scene)
        exact_events = [(float(e.t), e.kind) for e in motion.events if e.kind != "graze"]
        way = WAYS[number // 2 % len(WAYS)]
        if number % 2:
            arguments, options = way(right, t_end, right.events, rng)
        else:
            arguments, options = way(motion, t_end, exact_events, rng)
        check = crosscheck(scene, *arguments, **options)
        if not check.ok:
            blamed.append(f"{number} {way.__name__}: {scene} {start} {t_end}\n{told(check)}")
    return blamed
