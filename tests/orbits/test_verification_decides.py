"""Who decides whether a root is an orbit, and what is said where the engine contradicts: step by step."""

from __future__ import annotations

import random
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from paper_orbits import FIG9, FIG10

from symosc import Parameters, find_orbit
from symosc.kernels.entire import EPS
from symosc.model import MODE_NAMES
from symosc.orbits import verification
from symosc.orbits.admissibility import Condition
from symosc.orbits.newton import Solution
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.orbits.verification import agrees, failures


def told(orbit: PeriodicOrbit, changes: dict[int, dict[str, Any]], most: int = 99) -> list[SimpleNamespace]:
    """Return the events of an orbit's period from its clearest point on, some of them changed, `most` of them."""
    equations, points = orbit.equations(), orbit.phases()
    due = verification._expected(equations, points, verification._start(equations, points))
    events = [
        SimpleNamespace(boundary=boundary, target=MODE_NAMES[mode], x=x, t=t, kind="cross")
        for boundary, mode, x, t in due
    ]
    for i, change in changes.items():
        vars(events[i]).update({name: value(events[i]) if callable(value) else value for name, value in change.items()})
    return events[:most]


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645")])
def test_the_first_piece_that_the_engine_does_not_follow_is_named(
    p: Parameters, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By another belt, another mode, a wrong time or no event at all: how late, or a whole period, and of what kind."""
    orbit = find_orbit(p, word)
    equations, points = orbit.equations(), orbit.phases()
    n, start = len(points), verification._start(equations, points)
    clearest = []
    for i, piece in enumerate(equations.pieces):
        forces = [abs(equations.force(d, points[i][0], equations.belt(piece.start).v, points[i][1])) for d in (1, 2, 3)]
        on = forces[piece.start - 1 : piece.start + 1]
        clearest.append(-np.inf if equations.pieces[i - 1].sticks else min(on))
    assert start == int(np.argmax(clearest))
    for j in range(n):
        piece = equations.pieces[(start + j) % n]
        due = told(orbit, {})[j].t
        for change, most, value, t in (
            ({"boundary": 3}, 99, 0.0, due),
            ({"target": "Omega9"}, 99, 0.0, due),
            ({"t": due + 1e-3}, 99, -1e-3, due + 1e-3),
            ({"t": due - 0.1}, 99, -0.1, due - 0.1),
            ({"t": due + 99.0}, 99, -orbit.period, due + 99.0),
            ({}, j, -orbit.period, due),
        ):
            events = told(orbit, {j: change}, most)
            monkeypatch.setattr(verification, "_simulated", lambda *_, events=events: events)
            found = verification._contradiction(equations, points)
            assert not agrees(equations, points, None)
            assert (found.piece, found.rank) == ((start + j) % n, 7)
            assert found.text == f"{piece.label} ends where it first can"
            assert found.event == ("birth of a slip" if piece.sticks else "grazing")
            assert (found.value, found.t) == pytest.approx((value, t), rel=1e-9, abs=1e-12)
    for change, same in (({"x": lambda e: e.x + 1e-3}, False), ({"kind": "graze"}, False), ({}, True)):
        events = told(orbit, {n - 1: change})
        monkeypatch.setattr(verification, "_simulated", lambda *_, events=events: events)
        assert agrees(equations, points, None) is same


def test_what_may_fail_where_more_digits_do_not_help() -> None:
    """What fails; else what is within a millionth of its size of failing, the lowest rank first, said to be open."""
    rng = random.Random(8)
    for _ in range(30):
        rows = [
            Condition(i, f"c{i}", rng.choice([2e-6, 0.5e-6, -0.5e-6, 1.0]) * 3, 0.0, "", rng.randrange(3), 3.0)
            for i in range(5)
        ]
        found = verification._undecided(rows)
        failed = sorted((c for c in rows if c.value < 0), key=lambda c: c.rank)
        near = sorted((c for c in rows if c.value < 2e-6), key=lambda c: c.rank)
        if failed:
            assert found == failed
        else:
            assert [(c.piece, c.value, c.text[:2]) for c in found] == [(c.piece, 0.0, c.text) for c in near]
            assert all("cannot be decided" in c.text for c in found)


def test_a_piece_that_vanishes_under_newtons_method_is_named() -> None:
    orbit = find_orbit(FIG10, "P4645")
    equations, points = orbit.equations(), orbit.phases()
    rows = orbit.conditions()
    for i in range(4):
        for part, gone in ((0.5e-2, True), (-0.5e-2, True), (2e-2, False)):
            moved = points.copy()
            behind = moved[(i + 1) % 4, 1] + (float(equations.turn) if i == 3 else 0.0)
            shift = (behind - moved[i, 1]) * (1 - part)
            if i == 3:
                moved[3, 1] += shift
            else:
                moved[i + 1, 1] -= shift
            found = verification._vanishing(equations, points, rows, equations, Solution(moved, 0.0, 1, False, ""))
            assert [(c.piece, c.value) for c in found] == ([(i, 0.0)] if gone else [])
            assert all(c.text.endswith(" lasts") for c in found)


YES_OR_NO = [False, True]


@pytest.mark.parametrize("small", YES_OR_NO)
@pytest.mark.parametrize("ill", YES_OR_NO)
@pytest.mark.parametrize("converged", YES_OR_NO)
def test_who_decides_about_a_root(small: bool, ill: bool, converged: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Doubles where margins and matrix are clear, else more digits; inequalities first, and then always the engine."""
    doubles = SimpleNamespace(name="doubles")
    fine = SimpleNamespace(name="fine")
    monkeypatch.setattr(verification, "ill_conditioned", lambda *_: ill)
    root = Solution("root", 0.0, 1, converged, "")
    monkeypatch.setattr(verification, "refined", lambda *_: (fine, root))
    monkeypatch.setattr(verification, "_contradiction", lambda *_: "the engine contradicts")
    monkeypatch.setattr(verification, "_undecided", lambda found: [c.text for c in found if c.value < 0.4] and ["open"])
    for fails, near, fails_fine, gone, engine in product(
        YES_OR_NO, YES_OR_NO, YES_OR_NO, YES_OR_NO, [None, 30, 60, "never"]
    ):
        value = -1.0 if fails else 0.3 if near else 0.5
        rows = {"doubles": [value, 1e-10 if small else 0.5], "fine": [-1.0 if fails_fine else 1e-26, 0.5]}

        def told(equations: Any, *_: Any, rows: Any = rows) -> list[Condition]:
            return [Condition(i, f"c{i}", each, 0.0, "", i, 1.0) for i, each in enumerate(rows[equations.name])]

        def agree(equations: Any, points: Any, digits: Any, engine: Any = engine) -> bool:
            assert (equations.name, points) == (("doubles", "points") if digits is None else ("fine", "root"))
            return digits == engine

        monkeypatch.setattr(verification, "conditions", told)
        monkeypatch.setattr(verification, "agrees", agree)
        monkeypatch.setattr(verification, "_vanishing", lambda *_, gone=gone: ["gone"] if gone else [])
        found = [getattr(each, "text", each) for each in failures(doubles, "points")]  # type: ignore[arg-type]
        clear = not small and not ill
        unclear = fails or near or small
        if clear and fails:
            right = ["c0"]
        elif clear and engine is None:
            right = []
        elif converged:  # a margin of 1e-26 is 0, and fails
            right = ["c0"]
        elif gone:
            right = ["gone"]
        elif small or fails:
            right = ["open"]
        else:
            right = [] if engine is None else ["open"] if unclear else ["the engine contradicts"]
        assert found == right, (fails, near, fails_fine, gone, engine)


@pytest.mark.parametrize(("engine", "right"), [(30, []), (60, []), (None, ["no"]), (15, ["no"])])
def test_with_more_digits_the_engine_is_asked_twice(
    engine: Any, right: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The margins are clear there; the engine has the last word, with 30 digits or with 60."""
    asked: list[Any] = []
    fine = SimpleNamespace()
    monkeypatch.setattr(verification, "ill_conditioned", lambda *_: True)
    monkeypatch.setattr(verification, "refined", lambda *_: (fine, Solution("root", 0.0, 1, True, "")))
    monkeypatch.setattr(verification, "_contradiction", lambda *_: "no")
    rows = [Condition(0, "", 1e-20, 0.0, "", 0, 1.0), Condition(1, "", 2e-25, 0.0, "", 0, 1.0)]
    monkeypatch.setattr(verification, "conditions", lambda *_: rows)
    monkeypatch.setattr(
        verification, "agrees", lambda _, points, digits: asked.append((points, digits)) or digits == engine
    )
    assert failures(fine, "points") == right  # type: ignore[arg-type]
    assert asked == [("root", 30), ("root", 60)][: 1 if engine == 30 else 2]


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645")])
def test_how_well_a_root_is_determined_does_not_depend_on_the_first_letter(
    p: Parameters, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limit at which the verdict changes is that of the worst of all phases, wherever the word begins."""
    limits = []
    for first in range(1, len(word)):
        orbit = find_orbit(p, f"P{word[first:]}{word[1:first]}")
        low, high = -20.0, 0.0  # exponents
        for _ in range(30):
            middle = (low + high) / 2
            monkeypatch.setattr(verification, "MARGINAL", 10.0**middle)
            ill = verification.ill_conditioned(orbit.equations(), orbit.phases())
            low, high = (middle, high) if ill else (low, middle)
        limits.append(low)
    assert limits == pytest.approx([limits[0]] * len(limits), abs=1e-6)
    assert -16 < limits[0] < -12


def test_the_engine_starts_behind_a_flight_where_the_forces_are_clearest() -> None:
    """Made up: pieces with belts, sticks among them, and the forces of all domains at their starts."""
    rng = random.Random(9)
    for _ in range(60):
        pieces = [SimpleNamespace(start=rng.choice([1, 2]), sticks=rng.random() < 0.4) for _ in range(5)]
        forces = [{domain: rng.uniform(-9, 9) for domain in (1, 2, 3)} for _ in pieces]
        equations: Any = SimpleNamespace(
            pieces=pieces,
            belt=lambda number: SimpleNamespace(v=-float(number)),
            force=lambda domain, x, v, theta, forces=forces: forces[int(x)][domain] if theta == 7.0 else v,
        )
        clear = {
            i: min(abs(forces[i][piece.start]), abs(forces[i][piece.start + 1]))
            for i, piece in enumerate(pieces)
            if not pieces[i - 1].sticks
        }
        right = max(clear, key=lambda i: clear[i]) if clear else 0
        assert verification._start(equations, [(float(i), 7.0) for i in range(5)]) == right


def test_a_root_is_ill_conditioned_by_what_rounding_does_to_its_phases(monkeypatch: pytest.MonkeyPatch) -> None:
    """Made up: f2 counts in forces for a stick, else in velocities, and more where roots tau = 0 are divided out."""
    rng = np.random.default_rng(8)
    sizes = SimpleNamespace(a=7.0, v=0.5)
    monkeypatch.setattr(verification, "scales", lambda *_: sizes)
    for _ in range(40):
        n, Om = int(rng.integers(1, 4)), 2.0
        pieces = [SimpleNamespace(sticks=bool(rng.integers(2)), zeros=int(rng.integers(3))) for _ in range(n)]
        durations, matrix = rng.uniform(0.05, 3, n), rng.uniform(-1, 1, (2 * n, 2 * n))
        points = rng.uniform(-4, 4, (n, 2))
        equations: Any = SimpleNamespace(
            pieces=pieces, K=SimpleNamespace(Om=Om), durations=lambda _, d=durations: d, matrix=lambda _, J=matrix: J
        )
        errors = []
        for piece, duration in zip(pieces, durations, strict=True):
            f2 = sizes.a if piece.sticks else sizes.v
            if piece.zeros:
                f2 *= min(1.0, duration) / (duration / Om) ** piece.zeros
            errors += [np.abs(points[:, 0]).max(), f2]
        moved = max((np.abs(np.linalg.inv(matrix)) @ errors)[1::2]) * EPS
        for part, ill in ((0.999, True), (1.001, False)):
            monkeypatch.setattr(verification, "MARGINAL", part * moved)
            assert verification.ill_conditioned(equations, points) == ill
    equations.matrix = lambda _: np.zeros((2 * n, 2 * n))
    assert verification.ill_conditioned(equations, points)
