"""A periodic orbit as a motion: its states, many periods, its dictionary."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from paper_orbits import BOTH_BELTS, FIG9, FIG10, P32_MULTIPLIER

from symosc import simulate
from symosc.orbits import periodic_orbit
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import Scene, load_scene

# Sticks on both belts; found by simulating random parameters.


@pytest.mark.parametrize(("p", "word"), [(FIG9, "P32"), (FIG10, "P4645"), (BOTH_BELTS, "P1748")])
def test_states_of_the_orbit(p, word):
    """The orbit as a function of time: continuous at switchings, periodic, on the belts where it must be."""
    orbit = find_orbit(p, word)
    T = orbit.period
    times = np.linspace(-T, 2 * T, 100)
    assert np.abs(orbit(times) - orbit(times + 3 * T)).max() < 1e-11
    assert orbit(0.3).shape == (2,)
    for piece, (t, x) in zip(orbit.equations().pieces, orbit.points, strict=True):
        for state in (orbit(t - 1e-12), orbit(t + 1e-12)):
            assert state == pytest.approx([x, float(p.belt(piece.start))], abs=1e-8)


@pytest.mark.slow
def test_more_than_one_period():
    """Two periods of P32 are an orbit of P3232; with damping there is no other (symosc.orbits.floquet)."""
    orbit = find_orbit(FIG9, "P3232", periods=2)
    assert orbit.admissible
    assert orbit.periods == 2
    assert "runs 2 times" in orbit.message
    assert orbit.period == pytest.approx(2 * find_orbit(FIG9, "P32").period, rel=1e-15)
    for value in orbit.multipliers:
        assert min(abs(value - P32_MULTIPLIER**2), abs(value - P32_MULTIPLIER.conjugate() ** 2)) < 1e-14
    root = find_orbit(FIG9, "P32", periods=3)  # closes after three periods, but passes its belt on the way
    assert root.residual < 1e-11
    assert root.periods == 3
    assert not root.admissible
    assert any("stays in Omega1" in condition.text for condition in root.failures)


@pytest.mark.slow
def test_as_dict_is_plain():
    import json

    data = json.loads(json.dumps(find_orbit(FIG10, "P4645", digits=20).as_dict()))
    assert data["points"][0]["t"].startswith("0.44364498555745564947")
    assert data["stable"] is True
    data = json.loads(json.dumps(find_orbit(FIG9.replace(Omega=3), "P32").as_dict()))
    assert data["admissible"] is False
    assert data["failures"][0]["event"] == "birth of a stick"


class MadeUp:
    """A motion beside an orbit, off by `off[n]` in velocity after n periods; it notes how far it is followed."""

    def __init__(self, orbit: PeriodicOrbit, t0: float, off: np.ndarray) -> None:
        self.orbit, self.t0, self.off, self.asked = orbit, t0, off, []

    def until(self, scene: Scene, t_end: float) -> MadeUp:
        self.t_end = t_end
        self.asked.append((t_end - self.t0) / self.orbit.period)
        return self

    def __call__(self, times: np.ndarray) -> np.ndarray:
        n = np.rint((times - self.t0) / self.orbit.period).astype(int)
        return self.orbit(times) + np.outer([0.0, 1.0], self.off[n])


def test_how_soon_a_motion_comes_near_and_for_good(monkeypatch: pytest.MonkeyPatch) -> None:
    """The last period at which it is too far off decides. There are two looks, the second if the first sees no end."""
    orbit, rng, answers = find_orbit(FIG9, "P32"), np.random.default_rng(3), set()
    scene = load_scene("fig9-orbit")
    for last in [0, 1, 20, 21, 400, 401, *rng.integers(0, 460, 14).tolist()]:  # from here on it is near
        off = np.where(np.arange(500) < last, rng.choice([1e-7, 1.0], 500), 1e-7)  # near for a while is not for good
        off[last - 1 : last] = 1.0
        off[20] = 1.0 if last > 300 else off[20]
        motion = MadeUp(orbit, float(scene.t0), off)
        monkeypatch.setattr(periodic_orbit, "simulate", motion.until)
        right, asked = None, []
        for periods in (20, 400):  # as long as the last state is not too far off, it is taken to have come near
            asked.append(periods + 0.5)
            far = [n for n in range(periods + 1) if off[n] > 1e-6]
            if not far or far[-1] < periods:
                right = far[-1] + 1 if far else 0
                break
        assert orbit.approach(scene).periods == right
        assert motion.asked == pytest.approx(asked)
        answers |= {str(right) if right in (None, 0) else "later", len(asked)}
    assert answers == {"None", "0", "later", 1, 2}


def test_the_nearest_switching_is_on_the_starts_belt_and_mod_the_forcing_period() -> None:
    """Start minus the nearest point of the same belt, the time reduced to half a forcing period."""
    rng = np.random.default_rng(2)
    for p, word in ((FIG10, "P4645"), (BOTH_BELTS, "P1748")):
        orbit = find_orbit(p, word)
        belts = [piece.start for piece in orbit.equations().pieces]
        T = 2 * np.pi / float(p.Omega)
        for _ in range(12):
            belt = int(rng.integers(1, 3))
            t0, x0 = float(rng.uniform(-30, 30)), float(rng.uniform(-6, 6))
            scene = Scene("near", p, Fraction(t0), Fraction(x0), p.belt(belt), Fraction(100))
            away = []
            for start, (t, x) in zip(belts, orbit.points, strict=True):
                if start == belt:
                    turns = np.rint((t0 - t) / T)
                    away.append((t0 - t - turns * T, x0 - x))
            found = orbit._nearest_switching(scene)
            if not away:
                assert np.isnan(found).all()
                continue
            assert found == pytest.approx(min(away, key=lambda pair: max(abs(pair[0]), abs(pair[1]))), abs=1e-12)
        off = Scene("off", p, Fraction(0), Fraction(0), p.v1 + (p.v2 - p.v1) / 3, Fraction(100))
        assert np.isnan(orbit._nearest_switching(off)).all()


@pytest.mark.slow
def test_the_offset_is_that_from_the_nearest_shift_of_the_orbit() -> None:
    """An orbit of several forcing periods may be met in any of them."""
    orbit = find_orbit(FIG9, "P32", periods=3)
    T = orbit.period / 3
    for shift in range(3):
        t0 = 0.3 + shift * T
        x, v = orbit(t0)
        scene = Scene("s", FIG9, Fraction(0.3), Fraction(float(x)), Fraction(float(v)), Fraction(9))
        for elapsed in (0.0, 0.4):
            states = orbit._at(scene, np.array([0.0, elapsed]))
            assert states == pytest.approx(np.column_stack([orbit(t0), orbit(t0 + elapsed)]), abs=1e-9)


def test_the_formula_of_an_orbit_has_all_its_numbers() -> None:
    """Points, real and complex multipliers, with the signs of their parts, and powers of ten."""
    rng = np.random.default_rng(7)
    orbit = find_orbit(FIG9, "P32")
    for _ in range(30):
        re, im = (float(rng.choice([-1, 1]) * 10 ** rng.uniform(-7, 2)) for _ in range(2))
        im = im if rng.random() < 0.7 else 0.0
        text = replace(orbit, multipliers=(complex(re, im), complex(re, -im)))._repr_latex_()
        assert text.startswith(rf"${orbit.equations().word.latex()},\quad \begin{{array}}{{lll}}")
        for label, (t, x) in zip(orbit.labels, orbit.points, strict=True):
            assert rf"P_{label[1:]}: & {t:.12g} & {x:.12g}" in text
        shown = text.split(r"\lambda = ")[1].rstrip("$").split(r",\; ")
        numbers = [re_read(each) for each in shown]
        assert numbers == pytest.approx([complex(re, im), complex(re, -im)], rel=1e-5)
        assert all((r"\mathrm{i}" in each) == (im != 0) for each in shown)


def re_read(text: str) -> complex:
    """Return the number that a formula shows."""
    plain = re.sub(r" \\cdot 10\^\{(-?\d+)\}", r"e\1", text).replace(r"\,\mathrm{i}", "j").replace(" ", "")
    assert re.fullmatch(r"-?[\d.]+(e-?\d+)?([+-][\d.]+(e-?\d+)?j)?", plain), text
    return complex(plain)


def test_a_distance_that_is_allowed_is_near_enough() -> None:
    """With one of the distances themselves as the limit, the periods are counted up to this one."""
    orbit, scene = find_orbit(FIG9, "P32"), replace(load_scene("fig9-orbit"), x0=Fraction(4))
    length, t0 = float(orbit.period), float(scene.t0)
    path = simulate(scene, t_end=t0 + 20.5 * length)
    elapsed = length * np.arange(21)
    away = np.abs(path(t0 + elapsed) - orbit._at(scene, elapsed)).max(axis=0)
    assert list(away[:4]) == sorted(away[:4], reverse=True)
    for n in range(3):
        assert orbit.approach(scene, within=float(away[n])).periods == n
        assert orbit.approach(scene, within=float(np.nextafter(away[n], 0.0))).periods == n + 1
