"""The scripts of docs/literature: each runs, and what they share agrees with other computations."""

from __future__ import annotations

import random
import re
import subprocess
import sys
from fractions import Fraction
from importlib import import_module
from itertools import pairwise
from math import pi
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from printed import assert_as_printed
from scipy.integrate import solve_ivp

from symosc import Parameters, find_orbit, simulate
from symosc.reference.cases import wall

FOLDER = Path(__file__).parents[1] / "docs" / "literature"
#: The scripts take a second to a minute; those of a second are run here. The build of the site runs
#: them all, and `test_site.py` reads what they print.
SCRIPTS = sorted(path.stem for path in FOLDER.glob("*.py") if path.stem not in ("wall", "figures"))
QUICK = ("feeny_liang", "andronov_vitt_khaikin", "bossolini_brons_kristiansen", "pulled_spring")


def pace_of(name: str) -> Any:
    """Return a script as a parameter, marked unless it is quick."""
    if name in QUICK:
        return name
    return pytest.param(name, marks=pytest.mark.campaign)


def script(fixture: str, name: str) -> Any:
    """Return a fixture that imports a script, which finds its neighbours by their bare names."""

    @pytest.fixture(name=fixture)
    def module(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
        monkeypatch.syspath_prepend(FOLDER)
        return import_module(name)

    return module


wall_script = script("shared", "wall")
csernak_script = script("csernak", "csernak_stepan_shaw")
marino_script = script("marino", "marino_cicirello")
chaos_script = script("chaos", "no_chaos")
branch_script = script("branch", "iklodi_dombovari")
belt_script = script("belt_cycle", "andronov_vitt_khaikin")


@pytest.mark.parametrize("name", [pace_of(name) for name in SCRIPTS])
def test_formula_and_run_agree_and_are_what_the_source_printed(name: str) -> None:
    done = subprocess.run(
        [sys.executable, f"{name}.py"], cwd=FOLDER, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert_as_printed(name, done.stdout)


def test_the_page_runs_each_script_and_shows_it() -> None:
    page = (FOLDER.parent / "literature.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"^\$ python (\w+)\.py$", page, re.MULTILINE)) == SCRIPTS
    shown = re.findall(r"^```\{literalinclude\} literature/(\w+)\.py$", page, re.MULTILINE)
    assert sorted(shown) == sorted([*SCRIPTS, "wall"])


def random_walls(
    shared: ModuleType, count: int, seed: int, share: tuple[float, float]
) -> list[tuple]:
    """Return random (c, Omega, F) with F a random share of the border's, four decimals each."""
    dice = random.Random(seed)
    systems: list[tuple] = []
    while len(systems) < count:
        Omega = f"{dice.uniform(0.25, 2.5):.4f}"
        c = f"{dice.choice((0, dice.uniform(0, 0.5), dice.uniform(0, 3))):.3f}"
        border = float(shared.Symmetric(0, Omega, c).largest_force_ratio())
        F = f"{border * dice.uniform(*share):.4f}"
        if float(F) > 0.001:
            systems.append((c, Omega, F))
    return systems


@pytest.mark.slow
def test_the_amplitude_is_that_of_P32_and_so_are_its_multipliers(shared: ModuleType) -> None:
    """Random systems of all regimes of damping.

    In doubles to 1e-12, and some with 30 digits to 1e-25.
    """
    for i, (c, Omega, F) in enumerate(random_walls(shared, 5, 20, (0.05, 0.9))):
        p = wall(F, Omega, c)
        motion = shared.Symmetric(F, Omega, c)
        digits = 30 if i < 2 else None
        tolerance = 1e-25 if i < 2 else 1e-12
        orbit = find_orbit(p, "P32", digits=digits)
        assert orbit.admissible, (c, Omega, F)
        highest = max(x for _, x in orbit.points)
        lowest = min(x for _, x in orbit.points)
        assert abs(shared.MP.mpf(highest) / motion.highest - 1) < tolerance
        assert abs(shared.MP.mpf(lowest) / motion.highest + 1) < tolerance
        first, second = orbit.multipliers
        total, product = motion.multipliers()
        assert abs(shared.MP.mpf((first + second).real) - total) < tolerance
        assert abs(shared.MP.mpf((first * second).real) - product) < tolerance


@pytest.mark.slow
def test_on_either_side_of_the_border_P32_is_an_orbit_or_not(shared: ModuleType) -> None:
    for c, Omega, F in random_walls(shared, 3, 21, (1, 1)):
        border = shared.Symmetric(0, Omega, c).largest_force_ratio()
        for part, is_orbit in (("0.999999", True), ("1.000001", False)):
            p = wall(Fraction(str(shared.MP.nstr(border, 18))) * Fraction(part), Omega, c)
            assert find_orbit(p, "P32").admissible == is_orbit, (c, Omega, F, part)


@pytest.mark.slow
def test_the_largest_bound_is_the_largest(shared: ModuleType) -> None:
    """Against a dense grid, also where the maximum is next to the turning point (c = 0.2, r = 0.4429)."""
    dice = random.Random(22)
    systems = [(f"{dice.uniform(0.2, 2):.4f}", f"{dice.uniform(0, 1):.3f}") for _ in range(5)]
    for Omega, c in [*systems, ("0.4429", "0.2"), ("0.8", "0"), ("0.3", "0")]:
        motion = shared.Symmetric(0, Omega, c)
        largest, angle = motion.largest_slide_bound()
        seen = max(motion.slide_bound(at) for at in np.linspace(1e-4, pi - 1e-4, 150))
        assert seen <= largest * (1 + 1e-9)
        near = motion.slide_bound(max(angle, shared.MP.mpf("1e-12")))
        assert abs(near - largest) < 1e-8 * abs(largest)


@pytest.mark.quick(1)
@pytest.mark.parametrize(("n", "F"), [(1, "0.1"), (2, "0.02")])
def test_the_continuum(csernak: ModuleType, n: int, F: str) -> None:
    """Members inside are marginal orbits; those outside are none."""
    half = 1 / (1 - Fraction(1, 4 * n * n))
    x_f = Fraction(F)
    end = half / (4 * n * n) - x_f
    for part in ("-0.99", "0", "0.5"):
        orbit = csernak.orbit(F, n, Fraction(part) * end)
        middle = float(Fraction(part) * end)
        assert [x for _, x in orbit.points] == pytest.approx(
            [middle + float(half), middle - float(half)], rel=1e-12
        )
        assert orbit.admissible
        assert orbit.stable is None
        assert orbit.multipliers[0] == pytest.approx(1, abs=1e-12)
    for part in ("-1.01", "1.01"):
        assert not csernak.orbit(F, n, Fraction(part) * end).admissible
    assert csernak.largest_without_stops(n, lambda z: (F, z)) == pytest.approx(end, abs=1e-7)


def test_one_stop_per_cycle_beside_the_continuum(csernak: ModuleType) -> None:
    """It gets shorter for ever, and the motion tends to the end of the continuum."""
    events = csernak.path("0.1", 1, Fraction(3, 10), Fraction(150)).events
    lengths = [end.t - onset.t for onset, end in pairwise(events) if onset.kind == "stick"]
    assert len(lengths) in (150, 151)
    assert all(after < before for before, after in pairwise(lengths[3:]))
    assert 0 < lengths[-1] < 0.2 < lengths[3]


# --- stops per cycle ---


@pytest.mark.slow
def test_counts_are_those_of_orbits(shared: ModuleType) -> None:
    """A settled motion with 2 n stops has the word of n slides down, n slides up, and a stop after each."""
    for ratio, word in (("0.11", "P1312"), ("0.2", "P13131212"), ("0.9", "P1312")):
        assert shared.stops(wall(ratio, "0.1")) == word.count("1")
        assert find_orbit(wall(ratio, "0.1"), word).admissible


def test_one_stop_at_one_half_only(shared: ModuleType) -> None:
    """From rest at 0: below F/P = 1/3 one stop per cycle at Omega = 1/2; above two.

    Elsewhere none or two.
    """
    cycle = 60 * 4 * pi
    for F, count in (("0.1", 1), ("0.3", 1), ("0.4", 2)):
        events = shared.from_rest(wall(F, "0.5"), 61).events
        assert sum(event.kind == "stick" and event.t >= cycle for event in events) == count
    assert shared.stops(wall("0.36", "0.5")) == 2
    assert [shared.stops(wall(F, "0.49")) for F in ("0.1", "0.4")] == [0, 2]


# --- slides with damping, points, base and wall ---


@pytest.mark.slow
@pytest.mark.parametrize(
    ("Omega", "places"),
    [("0.3", [0.77658213]), ("0.15", [0.60303691, 0.26546352])],
    ids=["two stops", "four stops"],
)
def test_stops_known_from_elsewhere_also_by_another_solver(
    shared: ModuleType, Omega: str, places: list[float]
) -> None:
    """The cycle is closed by slides that scipy integrates from the equation of motion."""
    p = wall("0.5", Omega, "0.1")
    assert shared.stops(p) == 2 * len(places)
    positions = list(map(float, shared.stop_positions(p)))
    assert positions == pytest.approx(places, abs=6e-9)
    path = shared.from_rest(p, 40)
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

        stopped.terminal = True
        stopped.direction = -1
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
def test_friction_amplifies_beyond_the_root_of_two(marino: ModuleType) -> None:
    """Weak friction: the inversion tends to r = sqrt(2), linearly."""
    distances = [marino.inversion(F, marino.transmissibility) - 2**0.5 for F in ("0.1", "0.05")]
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
        first, second = (simulate(p, t0=0, x0=x, v0=v, t_end=60)(t) for x, v in starts)
        energy = float(p.k) * (first[0] - second[0]) ** 2 + float(p.m) * (first[1] - second[1]) ** 2
        assert (np.diff(energy) <= 1e-11 * energy[0]).all(), (seed, p)


@pytest.mark.parametrize("count", [2, pytest.param(200, marks=pytest.mark.campaign)])
def test_no_exponent_is_positive(chaos: ModuleType, count: int) -> None:
    """The script says it of 20 oscillators."""
    assert chaos.largest_exponent(count) <= 1e-12


def test_free_decay() -> None:
    """Random starts: 2 F/k less each half cycle, and at rest inside |x| <= F/k."""
    dice = random.Random(23)
    for _ in range(6):
        F = Fraction(dice.randint(50, 200), 1000)
        start = Fraction(dice.randint(1000, 2000), 1000)
        path = simulate(wall(F, 1, P=0), t0=0, x0=start, v0=0, t_end=200)
        turns = [float(start), *(event.x for event in path.events)]
        assert path.status == "equilibrium"
        assert abs(turns[-1]) <= float(F) * (1 + 1e-12)
        assert all(abs(x) > float(F) for x in turns[:-1])
        # On the sides that half cycles lead to; the last turn may be on the other one.
        distances = [x * (-1) ** i for i, x in enumerate(turns)]
        assert -np.diff(distances) == pytest.approx(2 * float(F), rel=1e-12)


# --- static friction ---


def test_formulas_of_static_friction(branch: ModuleType, belt_cycle: ModuleType) -> None:
    """Against another program, which has 60 digits."""
    for (without, _), Omega, highest in zip(
        branch.ENCLOSED,
        ("0.748685731630634374410198479", "1.206269084207898159278279365"),
        ("2.04804112050344071094338166", "0.7733150237056075137092507343"),
        strict=True,
    ):
        motion = branch.end_of_branch(without)
        assert abs(motion.Omega - branch.number(Omega)) < 1e-26
        assert abs(motion.highest - branch.number(highest)) < 1e-26
    speed, time = belt_cycle.graze()
    assert abs(speed - branch.number("0.54904631205793634574394182271822")) < 1e-28
    assert abs(time - branch.number("5.528804899215224364")) < 1e-17


def test_a_slip_meets_the_belt_or_not(belt_cycle: ModuleType) -> None:
    """A hair beside the belt speed where the cycle ends."""
    end = Fraction("0.549046312057936345743941822718")
    for hair, meets in ((-1, True), (1, False)):
        assert belt_cycle.meets_belt(end + Fraction(hair, 10**15)) == meets
