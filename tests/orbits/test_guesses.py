"""Guesses of an orbit's points, in every form."""

from __future__ import annotations

import numpy as np
import pytest
from paper_orbits import FIG9, FIG10
from paper_orbits import P32 as KNOWN

from symosc.engine.state import END
from symosc.errors import ParameterError
from symosc.orbits import guesses
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.find import find_orbit
from symosc.orbits.guesses import Passage, WordRun
from symosc.words import read_word


def test_guesses():
    rough = [(0.2, 4.0), (1.0, -4.0)]
    for guess in (rough, np.array(rough), (0.18, 4.15), (0.9, 4.15), find_orbit(FIG9, "P32")):
        assert find_orbit(FIG9, "P32", guess).points[0].t == pytest.approx(float(KNOWN[0][0]), abs=1e-13)
    moved = [(t + 5 * np.pi, x) for t, x in rough]  # the first point is brought into the first period
    assert find_orbit(FIG9, "P32", moved).points[1].t == pytest.approx(float(KNOWN[1][0]), abs=1e-12)


@pytest.mark.parametrize(
    ("guess", "says"),
    [
        ([(0.2, 4.0)] * 3, r"must be 2 pairs \(t, x\)"),
        ([1, 2, 3], "must be 2 pairs"),
        ("nonsense", "must be 2 pairs"),
        ([(0.2, 4.0), (float("nan"), 1)], "must be 2 pairs"),
        ([(1.0, 4.0), (0.2, -4.0)], "times must increase"),
    ],
)
def test_guesses_of_the_wrong_form(guess, says):
    with pytest.raises(ParameterError, match=says):
        find_orbit(FIG9, "P32", guess)


# --- what simulations show, on passages that are made up ---

P32 = ClosingEquations(FIG9, read_word("P32"), 1)
#: Belt and mode of each passage and the mapping that begins there, of a motion that repeats P132 (P2 first).
TURNS = [(1, 1, "P2"), (1, 2, "P3"), (1, 4, "P1")]


def passages(rng: np.random.Generator, turns: int, noise: float = 0.0, first: int = 0) -> list[Passage]:
    """Return a motion that repeats itself every period, its first passages off by as much as `noise`."""
    x, theta = rng.uniform(-3, 3, 3), np.sort(rng.uniform(0, 2 * np.pi, 3))
    found = []
    for n in range(3 * turns):
        k = (n + first) % 3
        phase = theta[k] + 2 * np.pi * ((n + first) // 3)
        off = noise if n < 3 else 0.0
        found.append(Passage(float(x[k] + off), float(phase + off), *TURNS[k][:2]))
    return found


@pytest.mark.parametrize("first", [0, 1, 2])
def test_the_word_that_a_motion_has_settled_to(first: int) -> None:
    """The same mappings twice over, a period apart; it begins with the first mapping of the equations' word."""
    rng = np.random.default_rng(1)
    for turns in (3, 5):
        run = WordRun(passages(rng, turns, first=first), END)
        assert guesses.settled_word(P32, run) == read_word("P132")
        other = ClosingEquations(FIG9, read_word("P645"), 1)
        labels = [TURNS[(first + i) % 3][2] for i in range(3)]
        found = guesses.settled_word(other, run)
        assert found is not None
        assert sorted(found.labels) == sorted(labels)
    assert guesses.settled_word(P32, WordRun(passages(rng, 2), END)) is None  # it has not repeated twice
    late = passages(rng, 5)
    for shift in (1e-5, -1e-5):
        moved = [*late[:-1], late[-1]._replace(theta=late[-1].theta + shift)]
        assert guesses.settled_word(P32, WordRun(moved, END)) is None


def test_stretches_that_follow_the_word_and_how_far_they_are_from_closing() -> None:
    """Each with its points in the first period, the number of periods, and the larger of the two defects."""
    rng = np.random.default_rng(2)
    for noise in (0.0, 1e-3):
        run = passages(rng, 4, noise)
        found = guesses.windows(run, ("P2", "P3", "P1"), None, 2.0)
        assert [guess.periods for guess in found] == [1, 1, 1]
        for n, guess in enumerate(found):
            part = run[3 * n : 3 * n + 4]
            turns = 2 * np.pi * (part[0].theta // (2 * np.pi))
            assert guess.points == pytest.approx(np.array([(p.x, p.theta - turns) for p in part[:3]]))
            away = max(abs(part[3].x - part[0].x) / 2.0, abs(part[3].theta - part[0].theta - 2 * np.pi))
            assert guess.defect == pytest.approx(away, abs=1e-12)
        twice = guesses.windows(run, ("P2", "P3", "P1") * 2, 2, 2.0)
        assert [guess.periods for guess in twice] == [2, 2]
        assert guesses.windows(run, ("P2", "P1", "P3"), None, 2.0) == []
        whole = guesses.windows(run, ("P2", "P3", "P1") * 2, 1, 2.0)  # two periods are no guess for one
        assert whole == []


def test_simulations_are_tried_in_batches_the_best_guess_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """From every belt of the word, at even phases and at positions of the size that is to be expected."""
    equations = ClosingEquations(FIG10, read_word("P4645"), 1)
    centre, size = guesses.largest_displacement(equations)
    starts: list[tuple[float, float, int]] = []
    defects = iter(np.random.default_rng(3).uniform(0, 1, 500))

    def follow(_: object, x: float, theta: float, boundary: int, most: int) -> WordRun:
        starts.append((x, theta, boundary))
        assert most == 60
        return WordRun([], END)

    monkeypatch.setattr(guesses, "follow", follow)
    monkeypatch.setattr(guesses, "windows", lambda *_: [guesses.Guess(np.zeros(0), 1, next(defects)) for _ in range(2)])
    for number, batch in enumerate(guesses.from_simulations(equations, None), start=1):
        assert len(starts) == 8 * number
        assert len(batch) == 16
        assert [guess.defect for guess in batch] == sorted(guess.defect for guess in batch)
    parts = (0, -0.4, 0.4, -0.8, 0.8, -0.15, 0.15)
    right = [(centre + part * size, np.pi / 4 * j, 2) for part in parts for j in range(8)]
    assert np.array(starts) == pytest.approx(np.array(right))


def test_the_displacement_to_be_expected_is_that_of_all_forces_or_of_resonance() -> None:
    for p in (FIG9, FIG10, FIG9.replace(Omega="5.4772", c="1e-3"), FIG9.replace(v2=2000), FIG9.replace(FN=10_000)):
        K = ClosingEquations(p, read_word("P32"), 1).K
        friction, drag = 2 * float((p.mu1 + p.mu2) * p.FN), float(p.c) * max(abs(float(p.v1)), abs(float(p.v2)))
        still = (abs(float(p.B0)) + max(friction, drag)) / float(p.k)
        found = guesses.largest_displacement(ClosingEquations(p, read_word("P32"), 1))
        assert found == pytest.approx((float(p.A0 / p.k), max(still, K.V0 / K.Om)))


def test_even_guesses_cover_all_phases() -> None:
    for periods in (1, 3):
        found = guesses.evenly_spaced(P32, periods)
        centre, size = guesses.largest_displacement(P32)
        assert len(found) == 32
        for number, guess in enumerate(found):
            begin, amplitude = 2 * np.pi * (number // 2) / 16, (0.2, 0.6)[number % 2]
            assert guess.points[:, 1] == pytest.approx(begin + np.pi * periods * np.arange(2))
            assert guess.points[:, 0] == pytest.approx(centre + amplitude * size * np.sin(guess.points[:, 1]))
            assert (guess.periods, guess.defect) == (periods, np.inf)


def test_where_a_motion_without_another_event_ends_up_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    """By its last passage: in a domain, on a belt for ever, or on a belt at rest among positions of rest."""
    run = [Passage(0.0, 1.0, 1, 2), Passage(0.0, 2.0, 1, 1), Passage(0.0, 3.0, 2, 4)]
    for mode in (1, 2, 3, 4, 5):
        passed = WordRun([*run, Passage(0.0, 4.0, 1, mode)], END)
        for positions in (None, (-0.5, 2.25)):
            asked: list[int] = []
            monkeypatch.setattr(
                guesses, "rest_positions", lambda p, belt, asked=asked, at=positions: asked.append(belt) or at
            )
            said = guesses.without_word(P32, passed)
            if mode <= 3:
                assert said == f"the motion ends up in Omega{mode} and meets no belt any more"
                assert asked == []
                continue
            assert asked == [mode - 3]
            assert f"on belt {mode - 3}" in said
            assert ("for ever" in said) == (positions is None)
            assert ("from -0.5 to 2.25" in said) == (positions is not None)
