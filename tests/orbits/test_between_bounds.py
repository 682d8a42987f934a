"""What the proof between two points of a branch rests on: the bound of a cell, and the functions of a piece."""

from __future__ import annotations

import random

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10

from symosc import Parameters, find_orbit
from symosc.engine.flow import state_at
from symosc.orbits import between


def least(f0: float, f1: float, bend: float) -> float:
    """Return the least value of the parabola with these ends and that bend, over a cell."""
    r = np.linspace(0, 1, 2001)
    return float(np.min((1 - r) * f0 + r * f1 - bend * r * (1 - r)))


def test_a_cell_is_clear_if_the_parabola_below_it_is() -> None:
    """With half the bend of the neighbours times the safety; negative and zero values are never clear."""
    rng, answers = random.Random(1), {True: 0, False: 0}
    for _ in range(150):
        n = rng.randint(1, 6)
        values = np.array([[10 ** rng.uniform(-3, 0) for _ in range(n)] for _ in range(5)])
        values += np.array([rng.choice([0.0, 0.3]) for _ in range(n)])
        if rng.random() < 0.2:
            values[rng.randrange(5), rng.randrange(n)] = rng.choice([0.0, -0.1])
        deficit = rng.choice([0.0, 0.05])
        bends = np.abs(np.diff(values, 2, axis=0)).max(axis=0)
        found = between._cells(values, deficit)
        for j in range(n):
            beside = [bends[i] for i in (j - 1, j, j + 1) if 0 <= i < n]
            bend = max(beside) if n > 2 and 0 < j < n - 1 else bends[j]
            cells = [least(values[i, j] - deficit, values[i + 1, j] - deficit, 0.5 * 4.0 * bend) for i in range(4)]
            if min(map(abs, cells)) < 1e-4:
                continue  # the grid does not tell
            assert bool(found[j]) == (min(cells) > 0)
            answers[bool(found[j])] += 1
    assert min(answers.values()) > 30


def test_stretches_of_flags() -> None:
    rng = random.Random(2)
    for _ in range(60):
        flags = np.array([rng.random() < 0.5 for _ in range(rng.randint(1, 12))])
        found = between._runs(flags)
        again = np.zeros(len(flags), bool)
        for first, last in found:
            assert 0 <= first <= last
            assert not again[max(first - 1, 0) : last + 1].any()  # they do not touch
            again[first : last + 1] = True
        assert again.tolist() == flags.tolist()


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748")])
def test_functions_of_a_flight_are_its_gaps_without_their_known_roots(p: Parameters, word: str) -> None:
    """Inside a flight the gap to each boundary over the time and the rest of it; at both ends the limit of that."""
    orbit = find_orbit(p, word)
    equations, points = orbit.equations(), orbit.phases()
    u = np.array([0.0, 1e-5, 0.3, 0.77, 1 - 1e-5, 1.0])
    flights = 0
    for i, piece in enumerate(equations.pieces):
        if piece.sticks:
            continue
        flights += 1
        start = equations.start_of_flight(piece, tuple(points[i]))
        tau = (equations.ends(points)[i][1] - points[i][1]) / equations.K.Om
        found = between.functions(equations, points, i, u)
        belts = [belt for belt in (piece.mode - 1, piece.mode) if belt in (1, 2)]
        assert len(found) == len(belts)
        for belt, values in zip(belts, found, strict=True):
            roots = 0 if belt != piece.start else 2 if piece.after_stick else 1
            end = belt == piece.end
            for k in (1, 2, 3, 4):
                v = float(start.v + state_at(u[k] * tau, start, equations.K).dv)
                gap = (v - float(p.belt(belt))) * (1 if belt < piece.mode else -1)
                divisor = (u[k] * tau) ** roots * ((1 - u[k]) if end else 1.0)
                assert values[k] == pytest.approx(gap / divisor, rel=1e-5, abs=1e-5)
            assert values[0] == pytest.approx(values[1], rel=1e-3, abs=1e-3)
            assert values[5] == pytest.approx(values[4], rel=1e-3, abs=1e-3)
    assert flights > 1
