"""Borders of orbits under any friction law: against closed forms, the borders of the paper's law, and
orbits found alone.
"""

from __future__ import annotations

from functools import cache
from math import exp
from typing import Any

import mpmath
import numpy as np
import pytest
from law_orbits import DRIVEN, TWO_BANDS, driven

from symosc import (
    Belt,
    BorderError,
    ConvergenceError,
    Oscillator,
    ParameterError,
    continue_border,
    continue_orbit,
    find_orbit,
    plot,
)
from symosc.orbits.border import Border
from symosc.orbits.branch import Branch

DAMPED = Oscillator(m=1, c="1/10", k=1, belts=[Belt("0.4", mu="1/2", mu_s=1)])


@cache
def touching() -> Branch:
    """Return the branch of the stick-slip cycle up to where its slip touches the belt."""
    return continue_orbit(DAMPED, "S1 B1", "v1", ("0.39", "0.7"))


def speed_that_is_touched(c: Any, mu_s: Any) -> float:
    """Return the belt speed at which a slip from rest on the belt touches it: v(T) = V, v'(T) = 0."""
    c, mu_s = mpmath.mpf(c), mpmath.mpf(mu_s)
    h = c / 2
    w = mpmath.sqrt(1 - h * h)

    def velocity(t: Any, V: Any) -> Any:
        y = mu_s - c * V - 0.5  # from where the spring balances the friction
        return mpmath.exp(-h * t) * (V * mpmath.cos(w * t) - (h * V + y) / w * mpmath.sin(w * t))

    def equations(t: Any, V: Any) -> list[Any]:
        return [velocity(t, V) - V, mpmath.diff(lambda time: velocity(time, V), t)]

    late, speed = mpmath.findroot(equations, (5.5, 0.5 * float((mu_s - 0.5) / 0.5)))
    assert 5 < late < 6.2
    return float(speed)


@pytest.mark.parametrize(
    ("name", "limits", "values"),
    [("c", ("0.05", "0.2"), ("0.07", "0.15")), ("mu_s1", ("0.8", "1.2"), ("0.85", "1.1"))],
)
def test_a_graze_with_static_friction_follows_its_closed_form(
    name: str, limits: Any, values: Any
) -> None:
    plane = {"v1": ("0.1", 2), name: limits}
    border = continue_border(touching(), 1, name, plane, step="0.05")
    assert (border.kind, border.sliding, border.words) == ("grazing", "", ("S1∘B1", "rest"))
    assert [end.kind for end in border.ends] == ["end of the range"] * 2
    for value in values:
        (speed,) = border.at(**{name: value})
        numbers = {"c": "0.1", "mu_s1": "1"} | {name: value}
        assert speed == pytest.approx(
            speed_that_is_touched(numbers["c"], numbers["mu_s1"]), abs=1e-12
        )
    assert border.orbit(3).word == "S1∘B1"
    assert plot.border_figure(border).axes


def test_a_border_is_that_of_the_law_of_the_paper() -> None:
    """A curve with a slope next to none is, but for 1e-9, the law of the paper."""
    plain = Oscillator(**DRIVEN, belts=[Belt("0.5", mu="0.2")])
    curved = Oscillator(**DRIVEN, belts=[Belt("0.5", mu="0.2", slope="1e-12")])
    plane = {"v1": ("0.1", 3), "Omega": ("1.1", 2)}
    borders = []
    for law in (plain, curved):
        branch = continue_orbit(law, find_orbit(law).word, "v1", ("0.45", "1.5"))
        borders.append(continue_border(branch, 1, "Omega", plane, step="0.05"))
    theirs, own = borders
    assert (own.kind, own.sliding) == (theirs.kind, theirs.sliding)
    assert own.sliding == "crossing-sliding"
    assert own.words == ("B1∘A1", "B1∘S1∘A1")
    for Omega in ("1.25", "1.6"):
        assert own.at(Omega=Omega) == pytest.approx(theirs.at(Omega=Omega), abs=1e-11)
    ends = [sorted(end.values for end in border.ends) for border in borders]
    assert np.array(ends[0]) == pytest.approx(np.array(ends[1]), abs=1e-9)


def test_a_period_doubling_is_followed() -> None:
    branch = continue_orbit(driven("1.06"), "S1 B1", "mu_s1", ("1.05", "1.1"))
    plane = {"mu_s1": ("0.9", "1.2"), "Omega": ("1.35", "1.5")}
    border = continue_border(branch, branch.special[0], "Omega", plane, step="0.05")
    assert (border.kind, border.words) == ("period doubling", ("S1∘B1", "S1∘B1"))
    assert border.at(Omega="1.4") == pytest.approx([branch.special[0].value], abs=1e-11)
    (mu_s,) = border.at(Omega="1.45")
    start = border.orbit(-1).start
    orbit = find_orbit(driven("1").replace(mu_s1=mu_s, Omega="1.45"), guess=start, periods=1)
    assert min(abs(z + 1) for z in orbit.multipliers) < 1e-8


def entrained(Omega: Any, B0: Any) -> Oscillator:
    """Return a self-excited oscillator under a small drive."""
    belt = Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])
    return Oscillator(m=1, c="1/10", k=1, B0=B0, Omega=Omega, belts=[belt])


@pytest.mark.slow
def test_a_fold_and_a_neimark_sacker_point_are_followed() -> None:
    law = entrained("0.966", "0.1")
    branch = continue_orbit(law, None, "Omega", ("0.962", "0.967"), find_orbit(law, x0=2))
    plane = {"Omega": ("0.9", "0.99"), "B0": ("0.06", "0.12")}
    fold = continue_border(branch, branch.special[0], "B0", plane, step="0.05")
    (Omega,) = fold.at(B0="0.08")
    nearest = int(np.abs(fold.points[:, 1] - 0.08).argmin())
    start = fold.orbit(nearest).start
    orbit = find_orbit(entrained(Omega + 1e-7, "0.08"), guess=start, periods=1)
    assert min(abs(z - 1) for z in orbit.multipliers) == pytest.approx(0, abs=5e-3)
    with pytest.raises(ConvergenceError):
        find_orbit(entrained(Omega - 1e-5, "0.08"), guess=start, periods=1)
    turning = continue_orbit(entrained("0.9", "0.1"), None, "Omega", ("0.9", "0.94"))
    border = continue_border(turning, turning.special[0], "B0", plane, step="0.05")
    product = complex(np.prod(border.orbit(0).multipliers))
    assert product == pytest.approx(1, abs=1e-9)


@pytest.mark.slow
def test_a_border_passes_the_corners_of_a_curve() -> None:
    belt = Belt.from_function("1.83", lambda w: 0.5 + 0.5 * exp(-2 * w), until=4, pieces=16)
    law = Oscillator(m=1, c="1/10", k=1, belts=[belt])
    cycle = find_orbit(law, v0="1.83")
    branch = continue_orbit(law, None, "v1", ("1.825", "1.85"), cycle)
    plane = {"v1": (1, 3), "c": ("0.085", "0.11")}
    border = continue_border(branch, 1, "c", plane, step="0.05")
    assert (border.words, border.sliding) == (("S1∘B1", "rest"), "grazing-sliding")
    there = law.replace(c="0.0885", v1="1.95")
    other = continue_orbit(there, None, "v1", ("1.94", "2.1"), find_orbit(there, v0="1.95"))
    assert border.at(c="0.0885") == pytest.approx([other.ends[1].value], abs=1e-11)


@pytest.mark.slow
def test_the_birth_of_a_slip_is_followed() -> None:
    branch = continue_orbit(driven("0.98"), "S1 B1", "B0", ("0.6", "1.1"))
    plane = {"B0": ("0.5", "1.5"), "mu_s1": ("0.9", "1.1")}
    border = continue_border(branch, 1, "mu_s1", plane, step="0.05")
    assert (border.kind, border.words[0]) == ("birth of a slip", "S1∘B1")
    other = continue_orbit(driven("1.05"), "S1 B1", "B0", ("0.6", "1.3"))
    assert border.at(mu_s1="1.05") == pytest.approx([other.ends[1].value], abs=1e-10)


@pytest.mark.slow
def test_an_onset_at_a_corner_is_where_the_corner_has_no_speed() -> None:
    near = TWO_BANDS.replace(v1="9.2")
    branch = continue_orbit(near, None, "v1", (9, "9.3"), (0, 0.2, 0.4))
    border = continue_border(branch, 0, "w1_1", {"v1": (6, 12), "w1_1": (7, 11)}, step="0.1")
    assert (border.kind, border.words) == ("onset at a corner", ("", "rest"))
    assert border.at(w1_1="8.5") == pytest.approx([8.5], abs=1e-12)
    upright = continue_border(branch, 0, "A0", {"v1": (6, 12), "A0": (-1, 1)}, step="0.1")
    assert upright.at(A0="0.5") == pytest.approx([9], abs=1e-12)


@pytest.mark.parametrize(
    ("call", "error", "part"),
    [
        (lambda: continue_border(touching(), 0, "c", (0, 1)), ParameterError, "one equation"),
        (lambda: continue_border(touching(), 1, "mu2", (0, 1)), ParameterError, "must be one of"),
        (lambda: continue_border(touching(), 1, "v1", (0, 1)), ParameterError, "must differ"),
        (lambda: one_border().network(), BorderError, "one by one"),
    ],
)
def test_what_is_not_followed_is_refused_in_one_line(call: Any, error: Any, part: str) -> None:
    with pytest.raises(error) as refused:
        call()
    assert part in str(refused.value)
    assert "\n" not in str(refused.value)


def one_border() -> Border:
    """Return a short border."""
    return continue_border(touching(), 1, "c", ("0.09", "0.11"), step="0.1")
