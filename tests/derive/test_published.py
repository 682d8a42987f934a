"""Published results against this package: amplitudes, stability, borders, stops, decay, continua.

And their page.
"""

from __future__ import annotations

import random
import runpy
from fractions import Fraction
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from chapters import table
from scipy.integrate import solve_ivp

from symosc import Parameters, simulate
from symosc.base.errors import ParameterError
from symosc.derive import citation, published
from symosc.derive.published import MP, RESTING, TABLES, Formulas, wall
from symosc.orbits.find import find_orbit
from symosc.orbits.floquet import rest_positions


def random_walls(count: int, seed: int, share: tuple[float, float]) -> list[tuple]:
    """Return random (c, Omega, F), F a random part of the border's between the shares.

    Four decimals each.
    """
    dice = random.Random(seed)
    found = []
    while len(found) < count:
        Omega = f"{dice.uniform(0.25, 2.5):.4f}"
        c = f"{dice.choice((0, dice.uniform(0, 0.5), dice.uniform(0, 3))):.3f}"
        border = float(Formulas(wall(1, Omega, c)).largest_force_ratio())
        F = f"{border * dice.uniform(*share):.4f}"
        if float(F) > 0.001:
            found.append((c, Omega, F))
    return found


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("c", "F", "Omega", "x_0"),
    [
        ("0", "0.4", "1.5", 0.6531972647421811),
        ("0.2", "0.4", "1.5", 0.5488324917917096),
        ("0.1", "0.25", "0.6", 1.487067086810845),
    ],
)
def test_amplitudes_known_from_elsewhere(c: str, F: str, Omega: str, x_0: float) -> None:
    p = wall(F, Omega, c)
    assert float(Formulas(p).amplitude) == pytest.approx(x_0, rel=3e-16)
    assert max(x for _, x in find_orbit(p, "P32").points) == pytest.approx(x_0, rel=1e-12)


@pytest.mark.slow
def test_the_amplitude_is_that_of_P32_and_so_are_its_multipliers() -> None:
    """Random systems of all regimes of damping.

    In doubles to 1e-12, and some with 30 digits to 1e-27.
    """
    for i, (c, Omega, F) in enumerate(random_walls(5, 20, (0.05, 0.9))):
        p = wall(F, Omega, c)
        formulas = Formulas(p)
        if i < 2:
            digits, tolerance = (30, 1e-27)
        else:
            digits, tolerance = (None, 1e-12)
        orbit = find_orbit(p, "P32", digits=digits)
        assert orbit.admissible, (c, Omega, F)
        highest = max(x for _, x in orbit.points)
        lowest = min(x for _, x in orbit.points)
        assert abs(MP.mpf(highest) / formulas.amplitude - 1) < tolerance
        assert abs(MP.mpf(lowest) / formulas.amplitude + 1) < tolerance
        one, other = orbit.multipliers
        trace, determinant = formulas.trace_and_determinant()
        assert abs(MP.mpf((one + other).real) - trace) < tolerance
        assert abs(MP.mpf((one * other).real) - determinant) < tolerance


@pytest.mark.slow
def test_on_either_side_of_the_border_P32_is_an_orbit_or_not() -> None:
    for c, Omega, F in random_walls(3, 21, (1, 1)):
        border = Formulas(wall(1, Omega, c)).largest_force_ratio()
        for part, is_orbit in (("0.999999", True), ("1.000001", False)):
            p = wall(Fraction(str(MP.nstr(border, 18))) * Fraction(part), Omega, c)
            assert find_orbit(p, "P32").admissible == is_orbit, (c, Omega, F, part)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("Omega", "border"), [("1.5", 0.64657909), ("0.8", 0.81740639)])
def test_borders_known_from_elsewhere(Omega: str, border: float) -> None:
    assert float(Formulas(wall(1, Omega)).largest_force_ratio()) == pytest.approx(border, abs=6e-9)


@pytest.mark.slow
def test_the_largest_bound_is_the_largest() -> None:
    """Against a dense grid, also where the maximum is next to the turning point (c = 0.2, r = 0.4429)."""
    dice = random.Random(22)
    systems = [(f"{dice.uniform(0.2, 2):.4f}", f"{dice.uniform(0, 1):.3f}") for _ in range(5)]
    for Omega, c in [*systems, ("0.4429", "0.2"), ("0.8", "0"), ("0.3", "0")]:
        formulas = Formulas(wall(1, Omega, c))
        largest, angle = formulas.largest_slide_bound()
        seen = max(formulas.slide_bound(at) for at in np.linspace(1e-4, pi - 1e-4, 150))
        assert seen <= largest * (1 + 1e-9)
        near = formulas.slide_bound(max(angle, MP.mpf("1e-12")))
        assert abs(near - largest) < 1e-8 * abs(largest)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("n", "F"), [(1, "0.1"), (2, "0.02")])
def test_the_continuum(n: int, F: str) -> None:
    """Members inside are marginal orbits; those outside are none."""
    half = 1 / (1 - Fraction(1, 4 * n * n))
    x_f = Fraction(F)
    end = half / (4 * n * n) - x_f
    for part in ("-0.99", "0", "0.5"):
        orbit = published.one_sided_orbit(F, n, Fraction(part) * end)
        middle = float(Fraction(part) * end)
        assert [x for _, x in orbit.points] == pytest.approx(
            [middle + float(half), middle - float(half)], rel=1e-12
        )
        assert orbit.admissible
        assert orbit.stable is None
        assert orbit.multipliers[0] == pytest.approx(1, abs=1e-12)
    for part in ("-1.01", "1.01"):
        assert not published.one_sided_orbit(F, n, Fraction(part) * end).admissible
    assert published.one_sided_end(F, n) == pytest.approx(float(end), abs=1e-7)


def test_one_stop_per_cycle_beside_the_continuum() -> None:
    """It gets shorter for ever, and the motion tends to the end of the continuum."""
    events = published.one_sided_path("0.1", 1, Fraction(3, 10), Fraction(150)).events
    lengths = [end.t - onset.t for onset, end in pairwise(events) if onset.kind == "stick"]
    assert len(lengths) in (150, 151)
    assert all(after < before for before, after in pairwise(lengths[3:]))
    assert 0 < lengths[-1] < 0.2 < lengths[3]


def test_a_mass_rests_anywhere_on_a_belt_at_rest() -> None:
    """So the map over a period is the identity there: multiplier 1.

    From outside the mass comes to the interval.
    """
    low, high = rest_positions(RESTING, 1)
    assert (low, high) == (Fraction(-4, 5), 1)
    for x in (0, Fraction(1, 2), Fraction(-3, 5), low, high):
        path = simulate(RESTING, t0=0, x0=x, v0=0, t_end=100)
        assert not path.events
        assert path(np.linspace(0, 100, 7))[0].tolist() == [float(x)] * 7
    for x in (-3, Fraction(-9, 10), Fraction(11, 10), 4):
        path = simulate(RESTING, t0=0, x0=x, v0=0, t_end=100)
        assert path.events
        assert (
            float(low) - 0.01 <= path(99.0)[0] <= float(high) + 0.01
        )  # it may creep there for ever


@pytest.mark.parametrize(("change", "name"), [({"Omega": 1}, "Omega"), ({"k": 0}, "k")])
def test_formulas_say_where_there_is_no_such_motion(change: dict, name: str) -> None:
    with pytest.raises(ParameterError, match=f"^{name} "):
        Formulas(wall("0.1", "0.5").replace(**change))


# --- stops per cycle ---


@pytest.mark.slow
def test_counts_are_those_of_orbits() -> None:
    """A settled motion with 2 n stops has the word of n slides down, n slides up, and a stop after each."""
    for ratio, word in (("0.11", "P1312"), ("0.2", "P13131212"), ("0.9", "P1312")):
        assert published.stops(wall(ratio, "0.1")) == word.count("1")
        assert find_orbit(wall(ratio, "0.1"), word).admissible


def test_one_stop_at_one_half_only() -> None:
    """From rest at 0: below F/P = 1/3 one stop per cycle at Omega = 1/2; above two.

    Elsewhere none or two.
    """
    cycle = 60 * 4 * pi
    for F, count in (("0.1", 1), ("0.3", 1), ("0.4", 2)):
        events = published.from_rest(wall(F, "0.5"), 61).events
        assert sum(event.kind == "stick" and event.t >= cycle for event in events) == count
    assert published.stops(wall("0.36", "0.5")) == 2
    assert [published.stops(wall(F, "0.49")) for F in ("0.1", "0.4")] == [0, 2]


# --- slides with damping, points, base and wall ---


@pytest.mark.slow
@pytest.mark.parametrize(
    ("Omega", "places"),
    [("0.3", [0.77658213]), ("0.15", [0.60303691, 0.26546352])],
    ids=["two stops", "four stops"],
)
def test_stops_known_from_elsewhere_also_by_another_solver(Omega: str, places: list[float]) -> None:
    """The cycle is closed by slides that scipy integrates from the equation of motion."""
    p = wall("0.5", Omega, "0.1")
    assert published.stops(p) == 2 * len(places)
    found = sorted((abs(float(x)) for x in published.solve_stop_positions(p)), reverse=True)
    assert found == pytest.approx(places, abs=6e-9)
    path = published.from_rest(p, 40)
    slips = [
        event
        for event in path.events
        if event.kind == "slip" and event.t > 60 * pi / float(p.Omega)
    ]
    for slip in slips[: 2 * len(places)]:
        if slip.target == "Omega2":
            side = 1
        else:
            side = -1

        def right(t: float, y: np.ndarray, side: int = side) -> list[float]:
            return [y[1], np.cos(float(Omega) * t) - y[0] - 0.1 * y[1] - 0.5 * side]

        def stopped(t: float, y: np.ndarray, begin: float = slip.t, side: int = side) -> float:
            if t > begin + 0.3:
                return side * y[1]
            return 1.0

        stopped.terminal, stopped.direction = True, -1
        slide = solve_ivp(
            right,
            (slip.t, slip.t + 30),
            [slip.x, 0],
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
            events=stopped,
            max_step=0.1,
        )
        assert min(abs(abs(slide.y[0, -1]) - place) for place in places) < 1e-7


@pytest.mark.slow
def test_points_where_borders_meet() -> None:
    Omega, F = (float(row.formula) for row in table("points") if row.case == "$c = 0.1$")
    assert (Omega, F) == pytest.approx((0.4759318789, 0.2482868963), abs=1e-10)
    for n in (1, 2):
        ratio = Formulas(wall(1, Fraction(1, 2 * n))).largest_force_ratio()
        assert float(ratio) == pytest.approx(1 / (4 * n * n - 1), abs=1e-15)


@pytest.mark.slow
def test_ends_of_a_branch_known_from_elsewhere() -> None:
    found = [float(row.formula) for row in table("ends")]
    assert found == pytest.approx(
        [0.72267919443828, 2.0120729528, 1.23574715232190, 0.6709113787], abs=1e-10
    )


@pytest.mark.slow
def test_friction_amplifies_beyond_the_root_of_two() -> None:
    """Weak friction: the inversion tends to r = sqrt(2), linearly."""
    distances = [
        published.inversion(F, published.transmissibility) - 2**0.5 for F in ("0.1", "0.05")
    ]
    assert all(0 < after < 0.55 * before for before, after in pairwise(distances))


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(3))
def test_no_distance_grows(seed: int) -> None:
    """Two motions of random double-belt oscillators, with and without a damper.

    Their energy distance never grows.
    """
    dice = random.Random(seed)
    for _ in range(4):
        numbers = {
            name: f"{dice.uniform(0.2, 2):.3f}" for name in ("m", "k", "mu1", "mu2", "FN", "Omega")
        }
        p = Parameters(
            **numbers,
            c=dice.choice(("0", "0.1", "0.7")),
            A0=0,
            B0=f"{dice.uniform(0.5, 5):.3f}",
            v1=-1,
            v2=2,
        )
        t = np.linspace(0, 60, 601)
        starts = ((dice.uniform(-3, 3), dice.uniform(-3, 3)) for _ in range(2))
        one, other = (simulate(p, t0=0, x0=x, v0=v, t_end=60)(t) for x, v in starts)
        energy = float(p.k) * (one[0] - other[0]) ** 2 + float(p.m) * (one[1] - other[1]) ** 2
        assert (np.diff(energy) <= 1e-11 * energy[0]).all(), (seed, p)


@pytest.mark.parametrize("count", [2, pytest.param(200, marks=pytest.mark.campaign)])
def test_no_exponent_is_positive(count: int) -> None:
    """The page says it of 200 oscillators."""
    assert published.largest_exponent(count) <= 1e-12


# --- the tables and their page ---


@pytest.mark.slow
def test_the_committed_page_is_current() -> None:
    """The chapter checks that the two numbers of each row agree."""
    folder = Path(__file__).parents[2] / "docs"
    page = runpy.run_path(str(folder / "literature.py"))["page"]
    page.__globals__.update(
        table=table, largest_exponent=lambda count: published.largest_exponent(2)
    )
    assert (folder / "literature.md").read_text(encoding="utf-8") == page(), (
        "accept it with: python docs/literature.py"
    )
    notes = " ".join(value.note for key in ("border", "stops") for value in table(key))
    assert {int(word) for word in notes.replace(",", "").split() if word.isdigit()} == {
        0,
        *range(2, 15, 2),
    }
    sources = {source for _, keys, _ in TABLES.values() for source in keys}
    assert sources <= set(citation.entries())
    assert sources == set(runpy.run_path(str(folder / "literature.py"))["SOURCES"])


@pytest.mark.parametrize(("F", "P"), [("0.5", "1"), ("0.3", "0.5"), ("0.1", "0.2")])
def test_growth_at_resonance(F: str, P: str) -> None:
    expected = pi * float(P) - 4 * float(F)
    for digits, tolerance in ((30, 1e-26), (None, 1e-13)):
        if digits:
            exact = MP.pi * MP.mpf(P) - 4 * MP.mpf(F)
        else:
            exact = expected
        rises = published.resonance_growth(F, P, digits)
        assert len(rises) >= 5
        assert all(abs(MP.mpf(rise) - exact) < tolerance * 40 for rise in rises)


def test_free_decay() -> None:
    """Random starts: 2 F/k less each half cycle, and at rest inside |x| <= F/k."""
    dice = random.Random(23)
    for _ in range(6):
        F = Fraction(dice.randint(50, 200), 1000)
        start = Fraction(dice.randint(1000, 2000), 1000)
        path = simulate(wall(F, 1, P=0), t0=0, x0=start, v0=0, t_end=200)
        distances = [float(start), *(abs(event.x) for event in path.events)]
        signs = [x > 0 for x in (float(start), *(event.x for event in path.events))]
        assert path.status == "equilibrium"
        assert distances[-1] <= float(F) * (1 + 1e-12)
        assert all(distance > float(F) for distance in distances[:-1])
        falls = -np.diff(
            [
                distance if same else -distance
                for distance, same in zip(distances, _turns(signs), strict=True)
            ]
        )
        assert falls == pytest.approx(2 * float(F), rel=1e-12)


def _turns(signs: list[bool]) -> list[bool]:
    """Return whether each turning point is on the side that half cycles lead to.

    Only the last one may not be.
    """
    return [sign == (i % 2 == 0) for i, sign in enumerate(signs)]
