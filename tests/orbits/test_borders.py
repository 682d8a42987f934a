"""Borders in a plane of two parameters.

Against formulas, published numbers, and the ODE in 40 digits on both sides.
"""

from __future__ import annotations

import random
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from fast_oracle import simulate_fast
from oracle import simulate_oracle
from parameter_sets import COULOMB, PLANE
from samples import sample_of

from symosc import (
    Border,
    ParameterError,
    Parameters,
    continue_border,
    continue_orbit,
    find_orbit,
    load_scene,
)
from symosc.orbits.border import borders_between
from symosc.orbits.branch import Branch
from symosc.words import cycle

MAPS = {(1, "Omega1", 1): "2", (1, "Omega2", 1): "3", (1, "belt1", 1): "1", (2, "belt2", 2): "4"}
MAPS |= {(2, "Omega2", 2): "5", (2, "Omega3", 2): "6", (2, "Omega2", 1): "7", (1, "Omega2", 2): "8"}


def named(borders: list[Border], *words: str) -> Border:
    """Return the only border between these words."""
    (result,) = [border for border in borders if set(border.words) == set(words)]
    return result


@cache
def main_border(c: str, step: str = "0.08") -> Border:
    """Return the border on which P32 loses to sticks, from the end of a branch."""
    branch = continue_orbit(COULOMB.replace(c=c), "P32", "FN", (0.3, 0.99))
    return continue_border(branch, 1, "Omega", PLANE, step=step)


def den_hartog(r: Any) -> Any:
    """Return the largest F/P without stops at c = 0, with 30 digits.

    The formula of Den Hartog, and Hong and Liu.
    """
    r = mpmath.mpf(r)
    U = mpmath.tan(mpmath.pi / (2 * r)) / r
    V = 1 / (1 - r * r)

    def shape(u: Any) -> Any:
        return (
            r
            * r
            * (mpmath.sin(u / r) / r + U * (mpmath.cos(u) - mpmath.cos(u / r)))
            / mpmath.sin(u)
        )

    grid = [mpmath.pi * n / 300 for n in range(1, 300)]
    best = max(grid, key=shape)
    S = mpmath.mpf(1)
    if shape(best) > 1:
        S = max(S, shape(mpmath.findroot(lambda u: mpmath.diff(shape, u), best)))
    return abs(V) / mpmath.sqrt(U * U + (S / r**2) ** 2)


RATIOS = "0.34 0.36 0.38 0.4 0.42 0.44 0.46 0.48 0.52 0.55 0.6 0.7 0.8 0.9 0.97 1.1 1.3 1.5 2 2.8"


@pytest.mark.slow
def test_twenty_points_of_den_hartogs_border() -> None:
    undamped = COULOMB.replace(c=0)
    graze = continue_orbit(undamped.replace(Omega="0.4", FN="0.1"), "P32", "FN", (0.05, 0.3))
    graze = continue_border(graze, 1, "Omega", {"FN": (0.01, 1), "Omega": (0.2, 0.7)}, step="0.1")
    stick = continue_orbit(undamped, "P32", "FN", (0.3, 0.99))
    stick = continue_border(stick, 1, "Omega", {"FN": (0.01, 1), "Omega": (0.3, 3)}, step="0.1")
    assert (graze.sliding, stick.sliding) == ("grazing-sliding", "crossing-sliding")
    with mpmath.workdps(30):
        for r in RATIOS.split():
            (value,) = (graze if float(r) < 0.5 else stick).at(Omega=r)
            assert abs(value - den_hartog(r)) < 1e-15
    # Both end where the formula's two forms meet: the first codimension-two point of Guardia, Hogan
    # and Seara.
    for border in (graze, stick):
        (point,) = [
            point for point in border.special if point.kind == "degenerate crossing-sliding"
        ]
        assert sorted(point.values) == pytest.approx([1 / 3, 1 / 2], abs=1e-14)


@pytest.mark.slow
def test_the_numbers_of_the_plane() -> None:
    border = main_border("0.1")
    assert border.words == ("P32", "P3121")
    assert (border.kind, border.sliding) == ("birth of a stick", "crossing-sliding")
    point, fold = border.special
    assert fold.kind == "fold"
    assert fold.values == pytest.approx((0.74589922, 0.87820196), abs=1e-8)
    assert point.values == pytest.approx((0.2482868963, 0.4759318789), abs=1e-10)
    assert [end.kind for end in border.ends] == ["codimension two", "end of the range"]
    # Just below the fold there are two values, above it there is none.
    low, high = border.at(FN=fold.values[0] - 1e-10)
    assert low < fold.values[1] < high
    assert high - low < 1e-4
    assert border.at(FN=fold.values[0] + 1e-10) == ()
    assert border.at(FN=fold.values[0]) == pytest.approx(
        [fold.values[1]] * len(border.at(FN=fold.values[0])), abs=1e-7
    )


@pytest.mark.slow
def test_a_point_of_codimension_two_tends_to_the_undamped_one() -> None:
    point = main_border("0.001", "0.1").special[0]
    assert (point.values[0], 1 / point.values[1]) == pytest.approx((0.33243, 2.00085), abs=1e-5)


@pytest.mark.slow
def test_the_points_of_pwsdde_cont() -> None:
    p = COULOMB.replace(B0="1.5", FN=1)
    branch = continue_orbit(p, "P32", "Omega", (0.6, 1.4))
    border = continue_border(branch, 0, "FN", (0.9, 1.2), step="0.1")
    assert border.at(FN=1) == pytest.approx((0.72267919443828, 1.23574715232190), abs=1e-12)
    for end, x in zip(branch.ends, (2.0120729528, 0.6709113787), strict=True):
        assert end.points[0].x == pytest.approx(x, abs=1e-9)


@pytest.mark.campaign
def test_the_borders_that_leave_points_of_codimension_two() -> None:
    borders = main_border("0.1").network(step="0.04")
    graze = named(borders, "P32", "P231321")
    switch = named(borders, "P3121", "P231321")
    assert (graze.sliding, switch.sliding) == ("grazing-sliding", "switching-sliding")
    # A cusp: both borders join the same two points, along one direction at each of them.
    ends = np.array([sorted(end.values for end in border.ends) for border in (graze, switch)])
    assert ends[0] == pytest.approx(ends[1], abs=1e-10)
    assert ends[0][1] == pytest.approx([0.2482868963, 0.4759318789], abs=1e-10)
    (one,), (other,) = (border.at(FN="0.248") for border in (graze, switch))
    assert 0 < one - other < 1e-7
    assert len(borders) == 4


@pytest.mark.slow
def test_a_slip_in_a_stick_and_a_graze_meet_in_a_cubic_tangency() -> None:
    high, low = (COULOMB.replace(Omega="0.3", FN=FN) for FN in ("0.2", "0.02"))
    borders = borders_between(high, low, ("Omega", "FN"), PLANE, step="0.08")
    add, graze = (border for border in borders if set(border.words) == {"P3121", "P31312121"})
    assert {add.sliding, graze.sliding} == {"adding-sliding", "grazing-sliding"}
    for border in (add, graze):
        point = border.special[-1]
        assert point.kind == "adding-sliding and grazing-sliding"
        assert point.values == pytest.approx((0.3218001292, 0.0436332545), abs=1e-10)
        # v = v' = v'' = 0 at v1 = 0: Omega t = pi there, and the force that vanishes is the lower
        # one.
        Omega, FN = point.values
        at = simulate_oracle(
            COULOMB.replace(Omega=Omega, FN=FN), *_arrival(border, Omega), dps=40
        ).events[0]
        assert abs(float(at.x) - (FN - 1)) < 1e-6
        assert (
            abs(float(at.t) * Omega % (2 * np.pi) - np.pi) < 1e-3
        )  # the cube root of the error of doubles


def _arrival(border: Border, Omega: float) -> Any:
    """Return start and end of the flight that arrives in a cubic tangency, for the oracle."""
    orbit = border.orbit(-1)
    i = orbit.word.labels.index("P2")
    x, theta = orbit.points[i].tolist()
    return theta / Omega + 1e-9, x, -1e-12, theta / Omega + 20


FAMILIES = [
    ("Omega", "FN"),
    ("FN", "A0"),
    ("B0", "v1"),
    ("Omega", "c"),
    ("mu1", "Omega"),
    ("A0", "B0"),
]


def random_border(seed: int) -> tuple[Branch, Border] | None:
    """Return a border at an end of a random branch over random parameters of two belts, None if there is none."""
    rng = random.Random(seed)
    v1 = round(rng.uniform(-1, 1), 2)
    arguments = {
        name: round(rng.uniform(*limits), 2)
        for name, limits in {"A0": (-1, 1), "B0": (0.5, 4)}.items()
    }
    arguments |= {name: round(rng.uniform(0.1, 1), 2) for name in ("c", "mu1", "mu2")}
    for name, low in (("k", 0.5), ("Omega", 0.4), ("FN", 0.2)):
        arguments[name] = round(rng.uniform(low, 2), 2)
    p = Parameters(m=1, v1=v1, v2=v1 + rng.choice([0.5, 1, 2, 5]), **arguments)
    names = rng.choice(FAMILIES)
    ranges = {}
    for name in names:
        value = float(getattr(p, name))
        if name in ("Omega", "FN", "c", "mu1"):
            least = 0.02
        else:
            least = -9.0
        reach = 0.3 * max(abs(value), 0.3)
        ranges[name] = (max(least, value - reach), value + reach)
    try:
        orbit = find_orbit(p)
        branch = continue_orbit(p, orbit.word, names[0], ranges[names[0]], orbit)
    except ArithmeticError:
        return None
    for which in (0, 1):
        if branch.ends[which].beyond is not None and len(branch.labels) < 9:
            return branch, continue_border(branch, which, names[1], ranges, step="0.1")
    return None


@pytest.mark.slow
@sample_of(1, 60)
def test_the_ode_changes_its_word_at_random_borders(count: int) -> None:
    seed = 4  # none of the first four has a border
    done = 0
    while done < count:
        seed += 1
        drawn = random_border(seed)
        if drawn is None:
            continue
        done += 1
        branch, border = drawn
        assert border.words[0] == cycle(branch.word), seed
        i = len(border) // 3
        assert border.words_beside(i, "1e-5") == border.words, seed
        # The motion from the border's orbit, in 30 digits from the ODE alone, after many periods.
        for word, p in zip(border.words, border.beside(i, "1e-7"), strict=True):
            assert word_of_the_ode(p, border.orbit(i)) == word, (seed, border)
        assert (border.errors < 1e-11).all(), seed


def word_of_the_ode(p: Parameters, orbit: Any, periods: int = 25) -> str:
    """Return the word of the last period of the motion from an orbit's first point, integrated by the oracle."""
    piece = orbit.word.maps[0]
    (x, theta) = orbit.points[0].tolist()
    v = p.belt(piece.start.boundary)
    T = 2 * np.pi / float(p.Omega)
    Omega = float(p.Omega)
    run = simulate_fast(p, theta / Omega, x, v, theta / Omega + periods * T, dps=30)
    events = [event for event in run.events if event.kind != "graze"]
    last = [i for i, event in enumerate(events) if float(events[-1].t - event.t) < T * (1 - 1e-9)]
    labels = [MAPS[events[i - 1].boundary, events[i - 1].target, events[i].boundary] for i in last]
    return cycle("P" + "".join(reversed(labels)))


@pytest.mark.slow
def test_errors_are_estimates_of_the_errors() -> None:
    border = main_border("0.1")
    for i in range(3, len(border), 6):
        FN, Omega = border.points[i]
        exact = min(border.at(Omega=Omega), key=lambda value: abs(value - FN))
        assert abs(FN - exact) <= border.errors[i].sum() + 2 * np.spacing(FN)
        assert border.errors[i].max() < 1e-13
    assert max(point.error for point in border.special) < 1e-14


@pytest.mark.slow
def test_an_end_of_the_word_with_more_pieces_is_the_same_border() -> None:
    p = COULOMB.replace(FN="0.9")
    branch = continue_orbit(p, "P3121", "FN", (0.5, "0.95"))
    border = continue_border(branch, 0, "Omega", PLANE, step="0.1")
    assert border.words == ("P3121", "P32")
    assert border.kind == branch.ends[0].kind == "vanishing of a stick"
    assert border.sliding == "crossing-sliding"
    assert border.at(Omega="1.5") == main_border("0.1").at(Omega="1.5")


def largest_speed(p: Parameters) -> Any:
    """Return the largest speed of the steady motion without belts, by 30 digits of the linear equations' solution."""
    with mpmath.workdps(30):
        m, c, k, B0, w = (
            mpmath.mpf(q.numerator) / q.denominator for q in (p.m, p.c, p.k, p.B0, p.Omega)
        )
        x = mpmath.lu_solve(
            mpmath.matrix([[k - m * w * w, c * w], [-c * w, k - m * w * w]]), mpmath.matrix([B0, 0])
        )
        return w * mpmath.norm(x)


@pytest.mark.slow
@pytest.mark.full(1)
@pytest.mark.parametrize(
    ("changes", "word", "over", "end", "second", "beyond"),
    [
        ({"FN": "0.95"}, "P3121", ("FN", "0.9", "1.1"), 1, ("Omega", "0.3", 2), "rest"),
        ({"FN": "0.95"}, "P3121", ("FN", "0.9", "1.1"), 1, ("mu1", "0.5", 2), "rest"),
        (
            {"FN": "0.95", "B0": -1, "A0": 1},
            "P3121",
            ("B0", "-1.1", "-0.9"),
            1,
            ("k", "0.5", 2),
            "rest",
        ),
        (
            {"v1": -3, "v2": 0, "mu2": 1, "FN": "0.97"},
            "P6454",
            ("FN", "0.95", "1.1"),
            1,
            ("B0", "0.5", 2),
            "rest",
        ),
        (
            {"v1": -9, "v2": "1.9", "mu2": 1},
            "P54",
            ("B0", "0.9", "1.4"),
            0,
            ("Omega", "0.5", 2),
            None,
        ),
        ({"v1": "-1.9", "v2": 3, "A0": 2}, "P31", ("B0", "0.9", "1.4"), 0, ("k", "0.5", 2), None),
        (
            {"v1": "-1.9", "v2": "1.9", "mu2": 1},
            "P7481",
            ("B0", "0.9", "1.3"),
            0,
            ("Omega", "0.5", 2),
            None,
        ),
        ({"v1": "-1.9", "v2": 9, "mu1": 0}, "P32", ("B0", "0.9", "1.4"), 0, ("m", "0.5", 2), None),
    ],
)
def test_borders_beyond_which_the_motion_has_no_word(
    changes: dict[str, Any], word: str, over: Any, end: int, second: Any, beyond: str | None
) -> None:
    p = COULOMB.replace(
        **({"FN": 1, "c": "0.5", "Omega": 1, "B0": "1.2"} if beyond is None else {}) | changes
    )
    branch = continue_orbit(p, word, over[0], over[1:])
    ranges = {second[0]: second[1:], over[0]: sorted((p.B0 / 5, p.B0 * 5))}
    border = continue_border(branch, end, second[0], ranges, step="0.1")
    assert border.words == (cycle(word), beyond)
    assert border.kind == branch.ends[end].kind
    assert border.sliding == (
        "grazing-sliding" if beyond is None and p.mu1 + p.mu2 > 0 and word != "P32" else ""
    )
    if abs(p.v1) < abs(p.v2):
        belt = 1
    else:
        belt = 2
    for i in range(2, len(border) - 2, 3):
        at = p.replace(**dict(zip(border.parameters, border.points[i].tolist(), strict=True)))
        if beyond is None:
            assert abs(largest_speed(at) - abs(mpmath.mpf(float(at.belt(belt))))) < 1e-13 * abs(
                at.belt(belt)
            )
        else:
            assert float((at.mu1 if belt == 1 else at.mu2) * at.FN) == pytest.approx(
                float(abs(at.B0)), abs=1e-14
            )
        inside, outside = border.beside(i, "1e-5")
        assert word_of_the_ode(inside, border.orbit(i)) == border.words[0]
        exact = border.at(**{border.parameters[1]: border.points[i, 1]})
        assert min(abs(np.array(exact) - border.points[i, 0])) < 1e-12
        assert not find_orbit(outside).word


@pytest.mark.slow
def test_where_a_belt_stands_still_two_words_meet_above_rest() -> None:
    p = COULOMB.replace(v1="0.1", FN="1.2")
    branch = continue_orbit(p, "P21", "v1", ("-0.2", "0.2"))
    border = continue_border(branch, 0, "FN", {"v1": (-1, 1), "FN": ("0.5", 2)}, step="0.08")
    assert border.words == ("P21", "P31")
    assert (border.points[:, 0] == 0).all()
    assert border.special[0].values == pytest.approx((0, 1), abs=1e-11)  # where rest begins


def test_a_figure_and_a_page_show_the_border() -> None:
    p = load_scene("fig9").parameters.replace(Omega="3.29")
    branch = continue_orbit(p, "P32", "Omega", ("3.28", "3.3"))
    border = continue_border(
        branch, 0, "FN", {"Omega": (3.2, 3.4), "FN": ("9.8", "10.2")}, step="0.1"
    )
    (axes,) = border.plot().axes
    assert {text.get_text() for text in axes.texts} == {
        f"$P_{{{word[1:]}}}$" for word in border.words
    }
    assert (axes.get_xlabel(), axes.get_ylabel()) == (r"$\Omega$", "$F_N$")
    assert border.words[1] in border._repr_html_()
    assert border.as_dict()["words"] == list(border.words)


def test_the_message_about_a_second_parameter_proposes_no_name_that_is_not_allowed() -> None:
    branch = continue_orbit(COULOMB.replace(c="0.1"), "P32", "FN", (0.3, 0.99))
    with pytest.raises(ParameterError, match=r"must differ from the branch's own parameter FN$"):
        continue_border(branch, 1, "FN", PLANE)
    with pytest.raises(ParameterError, match=r"must be one of m, c, k, .*, mu1, mu2$"):
        continue_border(branch, 1, "Fn", PLANE)
    with pytest.raises(ParameterError, match=r"mu2; did you mean Omega\?$"):
        continue_border(branch, 1, "omega", PLANE)


def test_the_message_about_two_equal_names_speaks_of_no_branch() -> None:
    high, low = COULOMB, COULOMB.replace(FN="0.5")
    for names in (("FN", "FN"), ("FN", "Fn"), ("omega", "FN")):
        with pytest.raises(
            ParameterError,
            match=rf"parameters = '{names[0]}, {names[1]}': must be two different names out of m, c",
        ):
            borders_between(high, low, names, PLANE)
