"""Friction that depends on speed: its points, names, bands and edges, and laws from functions."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import symosc
from symosc import Belt, Oscillator
from symosc.model import OtherNumbers, model_from

FREE: Any = {"m": 1, "c": 0, "k": 1}
FALLING = Belt(1, curve=[(0, 0.4), (0.5, 0.25)], slope=0.1)


def drawn(seed: int) -> Oscillator:
    """Return an oscillator of one to three belts, most of them with a curve."""
    dice = random.Random(seed)
    belts = []
    for v in dice.sample(range(-20, 20), dice.choice([1, 2, 2, 3])):
        w = Fraction(0)
        curve = [(w, Fraction(dice.randint(20, 90), 100))]
        for _ in range(dice.choice([0, 1, 2, 5])):
            w += Fraction(dice.randint(1, 40), dice.choice([3, 10]))
            curve.append((w, Fraction(dice.randint(0, 90), 100)))
        slope = Fraction(dice.choice([0, 0, 1, 5]), 7)
        excess = Fraction(dice.choice([0, 0, 3]), 10)
        belts.append(Belt(v, curve=curve, slope=slope, mu_s=curve[0][1] + excess))
    return Oscillator(
        m=2, c=Fraction(dice.randint(0, 9), 10), k=3, A0=-1, B0=1, Omega=2, FN="5/2", belts=belts
    )


def friction(oscillator: Oscillator, v: Fraction) -> Fraction:
    """Return the friction force on a mass of velocity v, from the definition of a curve."""
    total = Fraction(0)
    for belt in oscillator.belts:
        points = [*(belt.curve or [(Fraction(0), belt.mu)])]
        far = points[-1][0] + 1000
        points.append((far, points[-1][1] + 1000 * belt.slope))
        w = abs(v - belt.v)
        i = next(i for i, (begin, _) in enumerate(points[1:]) if w <= begin)
        (w0, mu0), (w1, mu1) = points[i], points[i + 1]
        mu = mu0 + (mu1 - mu0) * (w - w0) / (w1 - w0)
        total += (1 if v < belt.v else -1) * mu * oscillator.FN
    return total


@pytest.mark.parametrize(
    "curve",
    [
        np.array([[0, 0.4], [0.5, 0.25]]),
        np.array([[0, 0.4], [0.5, 0.25]], dtype=np.float32),
        [np.array([0, 0.4]), np.array([0.5, 0.25])],
        (("0", "40 %"), ("1/2", "1/4")),
        zip([0, 0.5], [0.4, 0.25], strict=True),
        [[0, 0.4], (Fraction(1, 2), "0.25")],
    ],
    ids=["array", "single", "rows", "texts", "zip", "mixed"],
)
def test_points_may_be_given_in_many_forms(curve: Any) -> None:
    belt = Belt(1, curve=curve, slope="1/10")
    assert belt == FALLING
    assert hash(belt) == hash(FALLING)
    assert belt.curve == ((0, Fraction(2, 5)), (Fraction(1, 2), Fraction(1, 4)))


def test_points_may_have_units() -> None:
    pytest.importorskip("pint")
    assert Belt("1 m/s", curve=[(0, 0.4), ("50 cm/s", 0.25)], slope="0.1 s/m") == FALLING


def test_a_curve_of_one_point_is_a_coefficient() -> None:
    assert Belt(1, curve=[(0, 2)]) == Belt(1, 2)
    assert Belt(1, curve=[(0, 2)], slope=3) == Belt(1, 2, slope=3)
    assert Belt(1, 2, slope=3).curve == ((0, 2),)
    assert Oscillator(**FREE, belts=[Belt(1, curve=[(0, 2)])]).parameters.mu1 == 2


@pytest.mark.parametrize(
    ("belt", "text", "latex"),
    [
        (
            FALLING,
            "Belt(1, curve=[(0, 0.4), (0.5, 0.25)], slope=0.1)",
            r"$v = 1,\; (w, \mu) = (0, 0.4), (0.5, 0.25),\; \mu' = 0.1$",
        ),
        (
            Belt("1/3", curve=[(0, "1/7"), (2, 0)], mu_s=1),
            "Belt('1/3', curve=[(0, '1/7'), (2, 0)], mu_s=1)",
            r"$v = 1/3,\; (w, \mu) = (0, 1/7), (2, 0),\; \mu_s = 1$",
        ),
        (
            Belt(0, 1, slope=2),
            "Belt(0, mu=1, slope=2)",
            r"$v = 0,\; \mu = 1,\; \mu' = 2$",
        ),
    ],
)
def test_a_belt_is_written_as_it_is_given(belt: Belt, text: str, latex: str) -> None:
    assert repr(belt) == text
    assert eval(text) == belt
    assert belt._repr_latex_() == latex
    assert Belt(**belt.as_given()) == belt


def test_notebooks_show_the_first_points_of_many() -> None:
    belt = Belt.from_function(1, lambda w: 1 + w, 64**2)
    assert r"(w, \mu) = (0, 1), (1, 2), (4, 5), \ldots, (4096, 4097)" in belt._repr_latex_()
    latex = Oscillator(**FREE, belts=[belt])._repr_latex_()
    assert r"w_{1,1} = 1,\; \mu_{1,1} = 2" in latex
    assert latex.endswith(r"\ldots$")


def test_replaced_numbers_of_a_curve() -> None:
    assert FALLING.replace(mu=1) == Belt(1, curve=[(0, 1), (0.5, 0.25)], slope=0.1)
    assert FALLING.replace(mu=1).mu_s == 1
    assert FALLING.replace(mu_s=1).replace(mu="1/2").mu_s == 1
    assert FALLING.replace(v=3, slope=0) == Belt(3, curve=[(0, 0.4), (0.5, 0.25)])
    assert FALLING.replace(curve=[(0, 1), (1, 2)]) == Belt(1, curve=[(0, 1), (1, 2)], slope=0.1)
    assert FALLING.replace(curve=None, slope=0, mu=1) == Belt(1, 1)
    assert Belt(1, 1).replace(curve=[(0, 0.4), (0.5, 0.25)], slope=0.1) == FALLING
    assert Belt(1, 1).replace(slope=2) == Belt(1, 1, slope=2)


def test_the_numbers_of_curves_have_names() -> None:
    oscillator = Oscillator(**FREE, belts=[Belt(9, 1, mu_s=2), FALLING])
    assert list(oscillator.numbers())[6:] == [
        *("v1", "mu1", "mu_s1", "w1_1", "mu1_1", "slope1"),
        *("v2", "mu2", "mu_s2"),
    ]
    numbers = {name: float(value) for name, value in oscillator.numbers().items()}
    assert [numbers[name] for name in ("mu1", "w1_1", "mu1_1", "slope1")] == [0.4, 0.5, 0.25, 0.1]
    changed = oscillator.replace(mu1_1=0.3, w1_1=1, slope1=0, mu1="1/2", mu2=2, slope2=3)
    assert changed.belts == (
        Belt(1, curve=[(0, 0.5), (1, 0.3)]),
        Belt(9, 2, slope=3, mu_s=2),
    )
    assert changed != oscillator


@pytest.mark.parametrize("seed", range(40))
def test_an_oscillator_can_be_made_from_all_that_it_shows(seed: int) -> None:
    oscillator = drawn(seed)
    for again in (
        model_from(oscillator.numbers()),
        model_from(oscillator.given_numbers()),
        model_from(oscillator.as_dict()),
        oscillator.replace(),
        oscillator.replace(**oscillator.numbers()),
        eval(repr(oscillator)),
    ):
        assert again == oscillator
        assert hash(again) == hash(oscillator)
    as_columns = OtherNumbers(oscillator.numbers()).law
    assert as_columns.edges == oscillator.law.edges
    assert as_columns.rows == oscillator.law.rows


@pytest.mark.parametrize("seed", range(40))
def test_a_changed_number_is_the_only_one_that_changes(seed: int) -> None:
    oscillator = drawn(seed)
    numbers = oscillator.given_numbers()
    for name in [*numbers][len(FREE) :]:
        if name in ("Omega", "FN"):
            continue
        changed = numbers[name] + Fraction(1, 1000)
        replaced = oscillator.replace(**{name: changed})
        assert replaced.given_numbers() == numbers | {name: changed}


@pytest.mark.parametrize(
    ("numbers", "name"),
    [
        ({"v1": 1, "mu1": 1, "w1_1": 1}, "mu1_1"),
        ({"v1": 1, "mu1": 1, "mu1_1": 1}, "w1_1"),
        ({"v1": 1, "mu1": 1, "w1_2": 1, "mu1_2": 1}, "w1_2"),
        ({"v1": 1, "mu1": 1, "mu2": 1}, "mu2"),
        ({"v1": 1, "w1_1": 1, "mu1_1": 1}, "mu1"),
        ({"v1": 1, "mu1": 1, "w1_1": 1, "mu1_1": 1, "w1_2": 1, "mu1_2": 0}, "w1_2"),
    ],
)
def test_names_that_do_not_fit_together_are_refused(numbers: Any, name: str) -> None:
    with pytest.raises(symosc.ParameterError) as caught:
        model_from(FREE | {"A0": 0, "B0": 0, "Omega": 1, "FN": 1} | numbers)
    assert caught.value.name == name


def inside(oscillator: Oscillator) -> list[Fraction]:
    """Return two speeds in each band, from below."""
    speeds = [edge.v for edge in oscillator.edges]
    bands = itertools.pairwise([speeds[0] - 7, *speeds, speeds[-1] + 7])
    return [
        low + share * (high - low)
        for low, high in bands
        for share in (Fraction(1, 5), Fraction(2, 3))
    ]


@pytest.mark.parametrize("seed", range(60))
def test_bands_have_the_friction_of_the_curves(seed: int) -> None:
    oscillator = drawn(seed)
    assert [edge.v for edge in oscillator.edges] == sorted(
        {belt.v for belt in oscillator.belts}
        | {belt.v + w for belt in oscillator.belts for w, _ in belt.curve}
        | {belt.v - w for belt in oscillator.belts for w, _ in belt.curve}
    )
    speeds = inside(oscillator)
    assert len(speeds) == 2 * len(oscillator.bands)
    for i, v in enumerate(speeds):
        band = oscillator.bands[i // 2]
        assert band.below is None or band.below < v
        assert band.above is None or v < band.above
        force = oscillator.A0 + friction(oscillator, v) - oscillator.c * v
        assert band.A - band.c * v == force
    at_belts = [(edge.belts, edge.J, edge.E) for edge in oscillator.edges if edge.belts]
    assert at_belts == [
        ((n,), 2 * belt.mu * oscillator.FN, (belt.mu_s - belt.mu) * oscillator.FN)
        for n, belt in enumerate(oscillator.belts, 1)
    ]
    assert all(edge.J == edge.E == 0 for edge in oscillator.edges if not edge.belts)


@pytest.mark.parametrize("seed", range(60))
def test_a_law_contracts_where_all_resistance_grows_with_speed(seed: int) -> None:
    oscillator = drawn(seed)
    forces = [friction(oscillator, v) - oscillator.c * v for v in inside(oscillator)]
    falls = all(after <= before for before, after in itertools.pairwise(forces))
    no_static = all(belt.mu_s == belt.mu for belt in oscillator.belts)
    assert oscillator.contracts == (falls and no_static)


def test_a_damper_makes_up_for_friction_that_falls() -> None:
    belt = Belt(1, curve=[(0, 0.4), (0.5, 0.25)])  # falls by 0.3 for each unit of speed
    for c, contracts in (("0.3", True), ("0.2999", False)):
        oscillator = Oscillator(m=1, c=c, k=1, FN=1, belts=[belt])
        assert oscillator.contracts is contracts
    assert not Oscillator(m=1, c=1, k=1, FN=4, belts=[belt]).contracts


# -- laws from functions

#: A function, its range, and its second derivative, which is monotone.
SMOOTH: dict[str, tuple[Callable[[float], float], float, Callable[[Any], Any]]] = {
    "1/(1 + 3w)": (lambda w: 1 / (1 + 3 * w), 1.5, lambda w: 18 / (1 + 3 * w) ** 3),
    "exponential": (lambda w: 0.25 + 0.25 * math.exp(-2 * w), 4, lambda w: np.exp(-2 * w)),
    "cubic": (lambda w: 0.4 - 0.45 * w + 0.6 * w**3, 0.5, lambda w: 3.6 * w),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_a_law_from_a_function_is_as_near_to_it_as_promised(name: str) -> None:
    function, until, bend = SMOOTH[name]
    errors = []
    for pieces in (32, 64, 128):
        belt = Belt.from_function(0, function, until, pieces)
        w, mu = np.array(belt.curve, dtype=float).T
        assert np.allclose(w, until * np.linspace(0, 1, pieces + 1) ** 2, rtol=1e-15, atol=0)
        fine = np.linspace(0, np.sqrt(until), 40 * pieces + 1) ** 2
        error = np.max(np.abs(np.interp(fine, w, mu) - [function(speed) for speed in fine]))
        bound = np.max(np.diff(w) ** 2 / 8 * np.maximum(bend(w[1:]), bend(w[:-1])))
        assert 0.8 * bound < error < bound * (1 + 1e-9)
        errors.append(error)
    assert 3.5 < errors[0] / errors[1] < 4.1
    assert 3.5 < errors[1] / errors[2] < 4.1


def test_values_of_a_function_are_the_decimals_that_they_print_as() -> None:
    belt = Belt.from_function("1/3", lambda w: 0.1 + w / 3, "0.9", pieces=3, mu_s=2)
    assert [w for w, _ in belt.curve] == [0, Fraction(1, 10), Fraction(2, 5), Fraction(9, 10)]
    assert [mu for _, mu in belt.curve] == [
        Fraction(repr(0.1 + w / 3)) for w in (0.0, 0.1, 0.4, 0.9)
    ]
    assert (belt.v, belt.slope, belt.mu_s) == (Fraction(1, 3), 0, 2)


@pytest.mark.parametrize(
    "function",
    [lambda w: Fraction(1, 3), lambda w: "1/3", lambda w: np.array(0.5), lambda w: np.float64(0.5)],
)
def test_a_function_may_return_any_number(function: Any) -> None:
    belt = Belt.from_function(1, function, 1, pieces=2)
    assert belt.mu in (Fraction(1, 3), Fraction(1, 2))


def test_an_error_of_a_function_is_kept() -> None:
    with pytest.raises(symosc.ParameterError) as caught:
        Belt.from_function(1, lambda w: [1, 2][int(w)], 4, pieces=2)
    assert "fails at w = 4 with IndexError: list index out of range" in str(caught.value)
    assert isinstance(caught.value.__cause__, IndexError)
