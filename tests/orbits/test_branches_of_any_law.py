"""Branches of orbits under any friction law: their ends and events, against closed forms, roots of the
oracle's, and orbits computed alone.
"""

from __future__ import annotations

from math import cos, exp, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
from law_orbits import DRIVEN, STICK_SLIP, TWO_BANDS, confirmed, driven
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import symosc
from symosc import (
    Belt,
    BranchError,
    ConvergenceError,
    Oscillator,
    ParameterError,
    continue_orbit,
    find_orbit,
    plot,
)
from symosc.scenes import load_scene

DAMPED = Oscillator(m=1, c="1/10", k=1, belts=[Belt("0.4", mu="1/2", mu_s=1)])
#: Friction 1 at rest, falling to 1/2 at w = 1/2, and then by 1/20 up to w = 2.
BROKEN = Oscillator(
    m=1, c="0.1", k=1, belts=[Belt(1, curve=[(0, 1), ("1/2", "1/2"), (2, "0.45")], slope=0)]
)


@pytest.mark.slow
def test_the_stick_slip_cycle_ends_where_the_slip_touches_the_belt() -> None:
    """The belt speed at which it does has a closed form, here 0.549046312057936345..."""
    branch = continue_orbit(DAMPED, "S1 B1", "v1", ("0.2", 1))
    low, high = branch.ends
    assert (low.kind, low.value) == ("end of the range", 0.2)
    assert (high.kind, high.beyond) == ("grazing", None)
    assert high.value == pytest.approx(0.54904631205793634574, abs=1e-10)
    assert "arrives at belt 1" in high.message
    assert "a rest at x = 0.5" in high.message
    assert branch.stable.all()
    assert branch.spans[0] == pytest.approx(find_orbit(DAMPED.replace(v1="0.2")).period, abs=1e-9)


@pytest.mark.slow
def test_without_damping_the_branch_follows_the_closed_form() -> None:
    branch = continue_orbit(STICK_SLIP, "S1 B1", "mu_s1", ("0.55", 2))
    a = branch.values - 0.5
    periods = 2 * a / 0.2 + 2 * pi - 2 * np.arctan(a / 0.2)
    assert np.abs(branch.spans - periods).max() < 1e-11
    t, x = branch.points[-1, branch.labels.index("B1")]
    assert (t, x) == pytest.approx((0, 2), abs=1e-11)


def test_a_branch_reaches_the_least_static_friction_that_there_is() -> None:
    """Without damping the stick has vanished there, and a turn of the free motion is left."""
    branch = continue_orbit(STICK_SLIP, "S1 B1", "mu_s1", ("0.5", "1.1"))
    end = branch.ends[0]
    assert (end.kind, end.value) == ("end of the range", 0.5)
    assert "there is no such friction law" in end.message
    assert branch.spans[0] == pytest.approx(2 * pi, abs=1e-6)
    assert "law" not in branch.ends[1].message


def slip_that_touches(c: float) -> float:
    """Return the belt speed at which a slip under c touches the belt, from the closed form."""
    h = c / 2
    w = sqrt(1 - h * h)

    def state(V: float, t: float) -> tuple[float, float]:
        y = 0.5 - c * V  # x - f at the slip
        b = (V + h * y) / w
        e = exp(-h * t)
        v = e * (V * cos(w * t) - (h * V + y) / w * sin(w * t))
        return e * (y * cos(w * t) + b * sin(w * t)), v

    def late(V: float) -> float:
        """Return the largest velocity after the slip, less that of the belt."""
        y = 0.5 - c * V
        # v' = -(c v + y(t)) is 0 next to the end of a turn, where v is largest
        times = np.linspace(3, 2 * pi / w, 40_001)
        return max(state(V, t)[1] for t in times[20_000:]) - V if y else 0.0

    return float(brentq(late, 0.2, 0.9, xtol=1e-9))


def slip_beyond_the_belt(V: float, points: Any) -> float:
    """Return by how much a slip under falling friction turns beyond the belt, if it goes on there as
    just below it; by closed forms, and roots of scipy between short steps.
    """
    ws, mus = np.array(points, dtype=float).T
    x, v, band, late = mus[0] - 0.1 * V, V, 0, 0.0
    while True:
        slope = (mus[band + 1] - mus[band]) / (ws[band + 1] - ws[band])
        middle = mus[band] + slope * (V - ws[band])
        h = (0.1 + slope) / 2
        w = sqrt(1 - h * h)

        def state(t: float, x: float, v: float, middle: float, h: float, w: float) -> Any:
            e, y = exp(-h * t), x - middle
            there = middle + e * (y * cos(w * t) + (v + h * y) / w * sin(w * t))
            return there, e * (v * cos(w * t) - (h * v + y) / w * sin(w * t))

        def force(t: float, *band: float) -> Any:
            x, v = state(t, *band)
            return band[2] - x - 2 * band[3] * v

        here = x, v, middle, h, w
        if band == 0 and late > 3:
            return float(state(brentq(force, 0, 1, args=here, xtol=1e-15), *here)[1]) - V
        lower, upper = V - ws[band + 1], V - ws[band]
        t = 1e-3
        while lower < state(t, *here)[1] < upper:
            t += 1e-2
        edge = lower if state(t, *here)[1] <= lower else upper
        off = lambda t, *band: state(t, *band)[1] - edge  # noqa: B023, E731
        t = brentq(off, max(t - 1e-2, 1e-7), t, args=here, xtol=1e-15)
        x, v = state(t, *here)[0], edge
        late += t
        band += 1 if edge == lower else -1


@pytest.mark.parametrize("pieces", [16, pytest.param(64, marks=pytest.mark.slow)])
def test_the_cycle_under_falling_friction_ends_in_a_graze(pieces: int) -> None:
    """Its slip touches the belt just as its stick vanishes: mu_s is mu at w = 0."""
    belt = Belt.from_function("1.83", lambda w: 0.5 + 0.5 * exp(-2 * w), until=4, pieces=pieces)
    law = Oscillator(m=1, c="1/10", k=1, belts=[belt])
    cycle = find_orbit(law, v0="1.83")
    branch = continue_orbit(law, None, "v1", ("1.825", "1.85"), cycle)
    end = branch.ends[1]
    assert (end.kind, end.beyond) == ("grazing", None)
    assert "a rest at" in end.message

    def late(V: float) -> float:
        return slip_beyond_the_belt(V, belt.curve)

    touches = brentq(late, end.value - 1e-5, end.value + 1e-5, xtol=1e-13)
    assert end.value == pytest.approx(touches, abs=1e-12)


@pytest.mark.campaign
def test_the_end_over_damping_is_that_of_the_closed_form() -> None:
    branch = continue_orbit(DAMPED, "S1 B1", "c", ("0.05", "0.3"))
    assert slip_that_touches(branch.ends[1].value) == pytest.approx(0.4, abs=1e-6)


@pytest.mark.campaign
def test_an_unstable_cycle_between_its_birth_at_a_corner_and_the_belt() -> None:
    """Everything is proportional to the distance of the corner from 0, until the belt is met."""
    branch = continue_orbit(TWO_BANDS, None, "v1", (9, 16), (0, 1, 2))
    low, high = branch.ends
    assert (low.kind, high.kind) == ("onset at a corner", "grazing")
    assert low.value == pytest.approx(9, abs=1e-9)
    # v = 2.4836... (V - 9) reaches V
    ratio = 2.483621185871505924630344
    assert high.value == pytest.approx(9 * ratio / (ratio - 1), abs=1e-9)
    assert not branch.stable.any()
    assert np.abs(branch.spans - 6.303840144088753).max() < 1e-7
    assert plot.branch_figure(branch).axes


@pytest.mark.campaign
def test_a_cycle_shrinks_to_a_rest_at_a_corner() -> None:
    near = TWO_BANDS.replace(v1="9.2")
    branch = continue_orbit(near, None, "v1", (9, "9.3"), (0, 0.2, 0.4))
    assert [end.kind for end in branch.ends] == ["onset at a corner", "end of the range"]
    assert branch.ends[0].value == pytest.approx(9, abs=1e-10)
    assert not branch.stable.any()
    assert plot.branch_figure(branch).axes
    assert branch._repr_html_()


def test_a_cycle_ends_in_circles_where_the_damping_of_its_band_vanishes() -> None:
    """The band ends at the speed 0.11; every smaller circle in it is a cycle for the same c."""
    belt = Belt("-0.74", curve=[(0, "0.73"), ("0.85", "0.59")], slope="0.04", mu_s="0.93")
    law = Oscillator(m="1.16", c="0.16", k="1.33", A0=-1, belts=[belt])
    cycle = find_orbit(law, x0="-1.77", v0="-1.97")
    branch = continue_orbit(law, None, "c", ("0.15", "0.2"), cycle)
    assert [end.kind for end in branch.ends] == ["end of the range", "onset at a corner"]
    assert branch.ends[1].value == pytest.approx(0.14 / 0.85, abs=1e-13)
    assert "so does every smaller one" in branch.ends[1].message
    assert not branch.special
    assert branch.stable[:-2].all()
    radius = 0.11 / (1.33 / 1.16) ** 0.5
    low, high = branch.extents[-1]
    assert 0.8 * radius < (high - low) / 2 <= radius


def test_steps_do_not_shrink_before_a_place_that_one_step_did_not_reach() -> None:
    """Behind the fold a step fails because it is long; shorter ones go past that place."""
    belts = [
        Belt("-0.41", curve=[(0, "0.232"), ("0.5", "0.252"), ("1.25", "0.219")]),
        Belt("0.19", mu="0.376", slope="0.072", mu_s="0.484"),
    ]
    law = Oscillator(m=1, c="0.032", k=1, B0="0.501", Omega="1.23", belts=belts)
    branch = continue_orbit(law, None, "mu_s2", ("0.4", "0.9"), find_orbit(law), max_points=12)
    assert [event.kind for event in branch.special] == ["fold"]
    assert branch.special[0].value == pytest.approx(0.4931162466596, abs=1e-9)
    assert branch.values[-1] < 0.4925


@pytest.mark.slow
def test_a_period_doubling_is_located_and_both_sides_are_orbits() -> None:
    branch = continue_orbit(driven("1"), "S1 B1", "mu_s1", ("0.9", "1.15"))
    (place,) = branch.special
    assert place.kind == "period doubling"
    orbit = find_orbit(driven("1").replace(mu_s1=place.value), guess=place.start, periods=1)
    assert min(abs(z + 1) for z in orbit.multipliers) < 1e-8
    assert branch.stable[0]
    assert not branch.stable[-1]
    n = len(branch.values) - 1
    assert confirmed(branch.orbit(n), 1e-10) > 1
    assert branch.orbit(n, digits=20).digits == 20
    doubled = find_orbit(driven("1").replace(mu_s1=place.value + 0.01))
    assert (doubled.periods, doubled.stable) == (2, True)


@pytest.mark.slow
def test_each_point_of_a_branch_is_an_orbit() -> None:
    branch = continue_orbit(driven("1"), "S1 B1", "Omega", ("1.1", 2))
    for n in (0, len(branch.values) // 2, -1):
        orbit = branch.orbit(n)
        assert orbit.labels == branch.labels
        assert float(orbit.period) == pytest.approx(branch.spans[n], abs=1e-12)
        turn = float(orbit.period)
        off = np.array(orbit.points) - branch.points[n]
        off[:, 0] = (off[:, 0] + turn / 2) % turn - turn / 2
        assert np.abs(off).max() < 1e-9
    assert np.abs(np.diff(branch.values)).max() < 0.1


@pytest.mark.campaign
def test_a_slip_is_born_and_static_friction_leaves_no_orbit_near() -> None:
    branch = continue_orbit(driven("0.98"), "S1 B1", "B0", ("0.5", "1.1"))
    end = branch.ends[1]
    assert end.kind == "birth of a slip"
    assert "no orbit is near beyond" in end.message
    last = branch.orbit(-1)
    before = find_orbit(driven("0.98").replace(B0=end.value - 1e-7), guess=last)
    assert before.word == "S1∘B1"
    with pytest.raises(ConvergenceError):
        find_orbit(driven("0.98").replace(B0=end.value + 1e-7), "S1 B1", last)


def test_where_a_belt_no_longer_holds_what_arrives_a_slip_is_born() -> None:
    """The stick does not become short; beyond the end the mass first flies on for a while."""
    curve = [(0, "0.403"), ("0.28", "0.469"), ("0.4", "0.17"), ("1.08", "0.109"), ("1.42", "0.047")]
    second = [
        (0, "0.679"),
        ("0.69", "0.108"),
        ("0.87", "0.586"),
        ("1.54", "0.146"),
        ("2.31", "0.692"),
    ]
    belts = [
        Belt("0.39", mu="0.159", slope="0.157", mu_s="0.287"),
        Belt("1.03", curve=curve, slope="0.003"),
        Belt("1.39", curve=second, slope="0.13", mu_s="0.947"),
    ]
    p = Oscillator(m=1, c="0.093", k=1, A0="0.472", belts=belts)
    branch = continue_orbit(p, "S1 B1", "mu_s1", ("0.24", "0.29"))
    end = branch.ends[0]
    assert (end.kind, end.beyond) == ("birth of a slip", "B1∘S1∘A1")
    arrival = end.points[1].t
    assert arrival < branch.spans[0] - 1  # the rest of the period the mass sticks


def test_a_branch_that_cannot_be_begun_says_so() -> None:
    """A corner of the upper belt is at the speed of the lower one, and only one of them moves."""
    upper = Belt("1.1", curve=[(0, "0.659"), ("0.63", "0.328")], slope="0.22")
    belts = [Belt("0.47", mu="0.282", slope="0.002", mu_s="0.668"), upper]
    p = Oscillator(m=1, c="0.271", k=1, B0="2.696", Omega="1.94", belts=belts)
    with pytest.raises(BranchError, match="cannot be followed over v1 from here"):
        continue_orbit(p, None, "v1", ("0.4", "0.5"))


@pytest.mark.campaign
def test_a_contracting_law_ends_as_its_plain_branch_does() -> None:
    """A curve with a slope next to none is, but for 1e-9, the law of the paper."""
    plain = Oscillator(**DRIVEN, belts=[Belt("0.5", mu="0.2")])
    curved = Oscillator(**DRIVEN, belts=[Belt("0.5", mu="0.2", slope="1e-12")])
    word = find_orbit(plain).word
    theirs = continue_orbit(plain, word, "v1", ("0.45", "1.5"))
    own = continue_orbit(curved, word, "v1", ("0.45", "1.5"))
    end, other = own.ends[1], theirs.ends[1]
    assert (end.kind, end.beyond) == (other.kind, other.beyond)
    assert end.value == pytest.approx(other.value, abs=1e-9)


def test_branches_are_tables_and_pictures() -> None:
    branch = continue_orbit(driven("1"), "S1 B1", "mu_s1", ("1", "1.1"), max_points=30)
    assert plot.branch_figure(branch).axes
    assert len(branch.to_pandas()) == len(branch.values)
    assert branch.as_dict()["special"][0]["kind"] == "period doubling"
    assert branch._repr_html_()
    assert branch.parameters(0).numbers()["mu_s1"] == 1


@pytest.mark.parametrize(
    ("call", "error", "part"),
    [
        (lambda: continue_orbit(DAMPED, None, "v2", (0, 1)), ParameterError, "must be one of"),
        (lambda: continue_orbit(DAMPED, None, "v1", (1, 2)), ParameterError, "in between"),
        (lambda: continue_orbit(load_scene("fig9").parameters, None, "c", (0, 2)), ParameterError,
         "a word is required"),
        (lambda: continue_orbit(BROKEN, None, "v1", (0.9, 1.1), find_orbit(BROKEN, x0="0.48")),
         BranchError, "a rest at x"),
        (lambda: symosc.continue_border(short_branch(), 1, "mu1", (0, 1)), ParameterError, "border"),
        (lambda: symosc.certify(short_branch()), ParameterError, "static friction of belt 1"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused_in_one_line(call: Any, error: Any, part: str) -> None:
    with pytest.raises(error) as refused:
        call()
    assert part in str(refused.value)
    assert "\n" not in str(refused.value)


def short_branch() -> Any:
    """Return a short branch under static friction."""
    return continue_orbit(DAMPED, "S1 B1", "v1", ("0.39", "0.41"))


def entrained(Omega: Any) -> Oscillator:
    """Return a self-excited oscillator under a small drive, with damping -0.7, -0.22 and 0.07."""
    belt = Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])
    return Oscillator(m=1, c="1/10", k=1, B0="1/10", Omega=Omega, belts=[belt])


def test_a_neimark_sacker_point_is_where_the_mean_damping_vanishes() -> None:
    """Both multipliers have the product exp(-integral of c_j/m): there it is 1, by scipy."""
    branch = continue_orbit(entrained("0.9"), None, "Omega", ("0.9", "0.94"))
    (place,) = branch.special
    assert place.kind == "Neimark-Sacker"

    def slope_of_friction(v: float) -> float:
        return [0.8, 0.32, 0.03][np.searchsorted([0.25, 1], abs(1.5 - v))]

    def motion(t: float, y: np.ndarray) -> list[float]:
        x, v, _ = y
        friction = np.interp(1.5 - v, [0, 0.25, 1, 3], [1, 0.8, 0.56, 0.5])
        force = 0.1 * cos(place.value * t) - 0.1 * v - x + friction
        return [v, force, 0.1 - slope_of_friction(v)]

    t, x, v = place.start
    span = 2 * pi / place.value
    ends = solve_ivp(motion, (t, t + span), [x, v, 0], rtol=1e-10, atol=1e-12, max_step=0.01)
    assert ends.y[:2, -1] == pytest.approx([x, v], abs=1e-9)
    assert abs(ends.y[2, -1]) < 1e-7
    kinds = [abs(pair[0]) > 1 for pair in branch.multipliers]
    assert kinds == [value > place.value for value in branch.values]


@pytest.mark.slow
def test_an_entrained_orbit_ends_in_a_fold() -> None:
    """A stable and an unstable orbit meet there, as the square root of the parameter."""
    first = find_orbit(entrained("0.966"), x0=2)
    branch = continue_orbit(entrained("0.966"), None, "Omega", ("0.962", "0.967"), first)
    (fold,) = branch.special
    assert fold.kind == "fold"
    assert [end.value for end in branch.ends] == [0.967, 0.967]
    orbits = [branch.orbit(0), branch.orbit(-1)]
    assert sorted(str(orbit.stable) for orbit in orbits) == ["False", "True"]
    for orbit in orbits:
        confirmed(orbit, 1e-9)
    apart = []
    for part in (1e-6, 4e-6):
        both = [
            find_orbit(
                entrained(fold.value + part),
                guess=(fold.start[0], fold.start[1] + side, fold.start[2]),
            )
            for side in (-1e-3, 1e-3)
        ]
        apart.append(abs(both[0].points[0].x - both[1].points[0].x))
    assert apart[1] / apart[0] == pytest.approx(2, rel=0.05)
    with pytest.raises(ConvergenceError):
        find_orbit(entrained(fold.value - 1e-5), guess=fold.start, periods=1)
