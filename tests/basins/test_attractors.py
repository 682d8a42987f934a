"""Attractors against the literature, against long motions of scipy, and against closed forms."""

from __future__ import annotations

from math import atan, exp, pi, sqrt
from typing import Any

import numpy as np
import pytest
from stiction_solver import UnclearError, solved

from symosc import Belt, Chaotic, Oscillator, ParameterError, Rest, attractors, simulate
from symosc.basins.plane import PhasePlane
from symosc.basins.recurrence import DrivenMotions

rng_of = np.random.default_rng


def falling(V: Any, pieces: int = 24) -> Oscillator:
    """Return the friction case of Stender and Hoffmann (2021), piecewise linear."""
    belt = Belt.from_function(V, lambda w: 0.5 + 0.5 * exp(-w / 0.5), 4, pieces)
    return Oscillator(m=1, c="0.1", k=1, belts=[belt])


def random_starts(seed: int, count: int, low: Any, high: Any) -> np.ndarray:
    x, v = rng_of(seed).uniform(low, high, (count, 2)).T
    return np.column_stack([np.zeros(count), x, v])


#: Shares of the rest among starts in [-2, 2] x [0, 2]: the areas inside the unstable cycle.
SHARES = {"1.25": 0.0802, "1.5": 0.3071, "1.775": 0.5584}


@pytest.mark.compiled("doubles")
@pytest.mark.parametrize("V", SHARES)
def test_shares_of_the_literature_are_found(V: str) -> None:
    found = attractors(falling(V, 64), random_starts(7, 500, (-2, 0), (2, 2)))
    assert sorted(found.names) == ["cycle", "rest"]
    n = found.names.index("rest")
    assert abs(found.share[n] - SHARES[V]) < 2 * found.share_error[n]
    assert found.undecided == 0


@pytest.mark.compiled("doubles")
@pytest.mark.parametrize(("V", "name"), [("1.1", "cycle"), ("1.85", "rest")])
def test_one_attractor_outside_the_range_of_two(V: str, name: str) -> None:
    assert attractors(falling(V), random_starts(1, 60, (-2, 0), (2, 2))).names == (name,)


# -- without a drive: the squeeze against long motions ----------------------------------------------

LAWS: dict[str, Oscillator] = {
    "falling": falling("1.5", 6),
    "static": Oscillator(m=1, c="0.1", k=1, belts=[Belt("0.5", mu="0.5", mu_s=1)]),
    "two belts": Oscillator(
        m=1, c="0.05", k=1, belts=[Belt(-1, mu="0.5", mu_s=1), Belt(1, mu="0.5", mu_s=1)]
    ),
    "wall between belts": Oscillator(
        m=1, c="0.02", k=1, A0="0.3",
        belts=[Belt("-1.2", mu="0.4", mu_s=1), Belt(0, mu="0.05", mu_s="0.1"), Belt(1, mu="0.2")],
    ),
    # The damping is -0.007 above the speed 0 and 0.083 below it.
    "rest on a corner": Oscillator(
        m=1, c="0.1", k=1, belts=[Belt(
            "3/2", curve=[(0, 1), (".3", ".77"), (".8", ".6"), ("1.5", ".525"), (3, ".5")]
        )],
    ),
    "backward": Oscillator(m=1, c=0, k=2, belts=[Belt("-0.1", mu="0.5", mu_s="0.8")]),
}  # fmt: skip


def cycles_by_scipy(law: Oscillator, start: np.ndarray, span: float) -> bool:
    """Return whether a long motion of scipy goes on slipping from belts."""
    _, x, v = start.tolist()
    events = solved(law, (0.0, x, v), span).events
    return any(kind == "slip" and t > span / 2 for t, kind in events)


@pytest.mark.compiled("doubles")
@pytest.mark.parametrize("name", LAWS)
def test_basins_are_those_of_long_motions(name: str) -> None:
    law = LAWS[name]
    found = attractors(law, random_starts(3, 200, (-3, -3), (3, 3)))
    checked = 0
    for i in rng_of(1).permutation(200)[:4].tolist():
        try:
            cycles = cycles_by_scipy(law, found.starts[i], 50.0)
        except UnclearError:
            continue
        assert cycles != found.orbits[found.basin[i]].is_rest
        checked += 1
    assert checked >= 3


@pytest.mark.compiled("doubles")
def test_a_rest_on_a_corner_is_one_attractor() -> None:
    """Around it motions shrink by the same factor in each turn, however near they are."""
    found = attractors(LAWS["rest on a corner"], random_starts(5, 300, (-2, 0), (2, 2)))
    assert sorted(found.names) == ["cycle", "rest"]
    assert found.undecided == 0


@pytest.mark.compiled("doubles")
def test_the_section_map_never_decreases() -> None:
    for law in LAWS.values():
        plane = PhasePlane(law)
        x = plane.rest.high + np.linspace(0.01, 3.0, 60)
        after = plane.next_points(x)
        absorbed = np.isnan(after)
        assert not absorbed[np.argmin(absorbed) :].any()
        assert (np.diff(after[~absorbed]) >= -1e-9).all()


@pytest.mark.compiled("doubles")
def test_the_cycle_of_static_friction_has_its_closed_form() -> None:
    """T = 2a/V + (2/w)(pi - atan(a w/V)) with a = (s - f)/k, w = sqrt(k/m), without damping."""
    (cycle,) = attractors(LAWS["backward"], [(0, 2, 0)]).orbits
    a, w, V = 0.15, sqrt(2), 0.1
    assert float(cycle.period) == pytest.approx(
        2 * a / V + 2 / w * (pi - atan(a * w / V)), abs=1e-12
    )


@pytest.mark.compiled("doubles")
def test_closed_orbits_of_a_centre_are_no_attractors() -> None:
    law = Oscillator(m=1, c=0, k=1, belts=[Belt("0.6", mu="0.5")])
    found = attractors(law, [(0, 0.5, 0.3), (0, 0.8, 0), (0, 3, 0)])
    assert found.basin.tolist() == [-1, -1, 0]
    assert float(found.orbits[0].period) == pytest.approx(2 * pi)


@pytest.mark.compiled("doubles")
def test_a_rest_that_repels_is_no_attractor() -> None:
    found = attractors(falling("1.1"), [(0, 0.55, 0.01), (0, 2, 0)])
    assert found.names == ("cycle",)
    assert found.share.tolist() == [1.0]


@pytest.mark.compiled("doubles")
def test_all_rests_on_one_belt_are_one_attractor() -> None:
    wall = Oscillator(m=1, c=0, k=2, A0=1, belts=[Belt(0, mu="0.3", mu_s="0.5")])
    found = attractors(wall, random_starts(1, 50, (-3, -3), (3, 3)))
    assert found.orbits == (Rest(0.25, 0.75, 1),)
    x, _ = simulate(wall, x0=3, t_end=200)(200)
    assert 0.25 <= x <= 0.75


# -- with a drive ----------------------------------------------------------------------------------

BISTABLE = Oscillator(
    m=1, c="0.05", k=1, B0="0.6", Omega="1.4", belts=[Belt("0.1", mu="0.7", mu_s="0.98")]
)


@pytest.mark.compiled("doubles")
def test_two_orbits_of_one_drive_are_found_with_their_basins() -> None:
    grid = {"v0": "-1.5:1:5", "x0": "-2:2:11"}
    found = attractors(BISTABLE, grid, t_end="600T")
    assert found.basin.shape == (5, 11)
    assert [orbit.periods for orbit in found.orbits] == [1, 2]
    assert all(orbit.stable for orbit in found.orbits)
    turn = 2 * pi / 1.4
    away = [1.0, 1.0]
    for n, orbit in enumerate(found.orbits):
        # A long motion of scipy from a start of the basin ends on the orbit.
        i = int(np.flatnonzero(found.basin.ravel() == n)[0])
        _, x, v = found.starts[i].tolist()
        end = solved(BISTABLE, (0.0, x, v), 60 * turn)([60 * turn - 1e-9])[:, 0]
        states = orbit(turn * np.arange(orbit.periods))
        away[n] = np.abs(states.T - end).max(axis=1).min()
    assert max(away) < 0.02


@pytest.mark.compiled("doubles")
def test_orbits_that_stick_where_the_section_is_attract_along_the_belt() -> None:
    """Beside the belt a neighbour flies off: static friction holds what kinetic friction would not."""
    belt = Belt("0.122", mu="0.472", mu_s="1.034")
    law = Oscillator(m=1, c="0.3877", k="0.895", B0="0.928", Omega="1.105", belts=[belt])
    found = attractors(law, [(0, -0.1, 0.122), (0, 1, 1)], t_end="300T")
    assert found.names == ("period 1 (1)", "period 1 (2)")
    turn = 2 * pi / 1.105
    end = solved(law, (0.0, -0.1, 0.122), 40 * turn)([40 * turn - 1e-9])[:, 0]
    assert np.abs(found.orbits[found.basin[0]]([0.0])[:, 0] - end).max() < 1e-4


@pytest.mark.compiled("doubles")
def test_motions_that_creep_to_the_edge_of_the_rests_are_at_rest() -> None:
    belts = [Belt(0, mu="0.591"), Belt("1.324", mu="0.239", mu_s="0.355")]
    law = Oscillator(m=1, c="0.1408", k="0.712", A0="-0.23", B0="0.464", Omega="1.821", belts=belts)
    found = attractors(law, [(0, 1, 0), (0, 2, 1), (0, 0, 0)], t_end="500T")
    assert found.names == ("rest on belt 1",)
    assert found.undecided == 0


def test_creeping_ends_at_the_edge_of_the_rests_by_its_slips() -> None:
    """Slips that grow as the square of the distance from another limit, or as another power, do not
    lead there: 1/n from a limit beyond the edge, a geometric approach, and an orbit beside it.
    """
    law = Oscillator(m=1, c="0.1", k=1, B0="0.5", Omega=2, belts=[Belt(0, mu="0.6")])
    motions = DrivenMotions(law, 100, 1)
    n = np.arange(50, 178)
    approaches = np.array([0.2 / n, 3e-3 + 0.2 / n, 0.01 * 0.99**n, 3e-3 + 0.01 * 0.99**n])
    edge = 0.1  # (friction - B0)/k
    for side in (1, -1):
        x = side * (edge + approaches)
        points = np.stack([x, 0 * x], axis=-1)
        assert motions._creep(points).tolist() == [True, False, False, False]


@pytest.mark.compiled("doubles")
def test_a_mass_that_a_belt_holds_is_at_rest_under_falling_friction_too() -> None:
    """There the event loop does not say that nothing will happen any more."""
    law = Oscillator(
        m=1, c="0.168", k="1.39", B0="0.663", Omega="0.946",
        belts=[Belt(0, curve=[(0, "0.687"), ("0.379", "0.409"), ("1.56", "0.251")])],
    )  # fmt: skip
    found = attractors(law, [(0, 0.01, 0), (0, -0.002, 0), (0, 2, 1)])
    assert found.names == ("rest on belt 1", "period 1")
    assert found.basin.tolist() == [0, 0, 1]
    assert found.orbits[0].high == pytest.approx((0.687 - 0.663) / 1.39)
    edge = (0.687 - 0.663) / 1.39
    assert solved(law, (0.0, 0.01, 0.0), 60.0).events == []
    assert solved(law, (0.0, 1.1 * edge, 0.0), 60.0).events != []


@pytest.mark.compiled("doubles")
def test_orbits_of_hundreds_of_periods_are_found() -> None:
    """And starts off the belts, where nothing damps the motion, lead to no attractor."""
    belts = [Belt("1.17", mu="0.332", mu_s="0.773"), Belt("1.45", mu="0.252", mu_s="0.526")]
    law = Oscillator(m=1, c=0, k="0.478", A0="-0.868", B0="0.45", Omega="2.27", belts=belts)
    found = attractors(law, [(0, -0.9, -2.9), (0, -1.8, 0), (0, -0.5, -1.25)], t_end="300T")
    assert found.names == ("period 365",)
    assert found.basin.tolist() == [0, -1, 0]
    (orbit,) = found.orbits
    turn = 2 * pi / 2.27
    x, v = orbit(0.0)
    end = solved(law, (0.0, float(x), float(v)), 40 * turn)([40 * turn - 1e-9])[:, 0]
    assert np.abs(orbit(40 * turn) - end).max() < 1e-6
    ends = simulate(law, x0=x, v0=v, t_end="730T")(turn * np.array([365.0, 730.0]))
    assert np.abs(ends - [[x], [v]]).max() < 1e-8


@pytest.mark.compiled("doubles")
def test_chaos_is_named_and_mirrored_chaos_is_another_one() -> None:
    law = Oscillator(m=1, c=0, k=1, B0=1, Omega="0.43", belts=[Belt(0, mu="0.21", mu_s="0.7393")])
    found = attractors(law, random_starts(1, 12, (-3, -3), (3, 3)), t_end="300T")
    assert [type(orbit) for orbit in found.orbits] == [Chaotic, Chaotic]
    assert found.undecided == 0
    for orbit in found.orbits:
        assert orbit.exponent > 3 * orbit.error
        assert orbit.per_slip == pytest.approx(0.159, rel=0.2)


@pytest.mark.compiled("doubles")
def test_contracting_laws_have_one_attractor() -> None:
    found = attractors("fig9", random_starts(5, 300, (-5, -5), (5, 5)))
    assert found.share.tolist() == [1.0]
    assert found.orbits[0].word == "P32"


@pytest.mark.compiled("doubles")
def test_the_answer_is_the_same_with_any_number_of_workers() -> None:
    starts = random_starts(9, 40, (-2, -2), (2, 2))
    one, two = (attractors(BISTABLE, starts, workers=n) for n in (1, 3))
    assert np.array_equal(one.basin, two.basin)
    assert one.orbits == two.orbits


# -- what is handed in and out ----------------------------------------------------------------------


@pytest.mark.compiled("doubles")
def test_tables_have_the_grid_and_the_shares() -> None:
    found = attractors(LAWS["static"], {"x0": [-1, 0.5, 2], "v0": [0, 0.2]})
    data = found.to_xarray()
    assert data.basin.dims == ("x0", "v0")
    assert data.basin.shape == (3, 2)
    assert data.share.values.sum() == pytest.approx(1)
    p = found.share
    assert np.allclose(found.share_error, np.sqrt(p * (1 - p) / 6))
    rows = attractors(LAWS["static"], {"t0": 0, "x0": [-1, 2], "v0": 0})
    assert rows.to_xarray().basin.dims == ("start",)
    assert rows == attractors(LAWS["static"], [(0, -1, 0), (0, 2, 0)])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"starts": {"x0": "0:1:2", "y0": [1]}}, "y0"),
        ({"starts": {}}, r"starts = \[\]: must name t0, x0 and v0, or two of them"),
        ({"starts": {"x0": [1]}}, "must name t0, x0 and v0, or two of them"),
        ({"starts": [[1, 2]]}, "rows t0, x0, v0"),
        ({"starts": np.zeros((0, 3))}, "one or more"),
        ({"starts": [[0, np.nan, 1]]}, "x0"),
        ({"t_end": -1}, "t_end"),
        ({"t_end": "10T"}, "Omega"),
    ],
)
def test_wrong_arguments_are_named(changes: dict[str, Any], said: str) -> None:
    given: dict[str, Any] = {"starts": [(0, 0, 0)]} | changes
    with pytest.raises(ParameterError, match=said):
        attractors(LAWS["static"], **given)


def test_without_a_spring_there_is_nothing_to_settle_to() -> None:
    with pytest.raises(ParameterError, match="spring"):
        attractors(LAWS["static"].replace(k=0), [(0, 0, 0)])
