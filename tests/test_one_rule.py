"""One rule for arguments and one for answers: Parameters, a Scene, its name or its file.

Starts at 0; short texts.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symosc
from symosc import ParameterError, Parameters, Scene, load_scene, simulate, sweep

SCENES = Path(symosc.__file__).parent / "scenes"
SCENE = load_scene("fig9")
P = SCENE.parameters
ENDS = ((4.0, 0.2), (-4.0, 3.0))
CALLS: dict[str, Callable[[Any], Any]] = {
    "find_orbit": lambda what: symosc.find_orbit(what, "P32").points,
    "find_orbit, settled": lambda what: symosc.find_orbit(what).word,
    "continue_orbit": lambda what: symosc.continue_orbit(
        what, "P32", "Omega", (3.9, 4.1), max_points=3
    ).values.tolist(),
    "residual": lambda what: symosc.residual(what, "P3", *ENDS),
    "jacobian": lambda what: symosc.jacobian(what, "P3", *ENDS).tolist(),
    "solve_map": lambda what: symosc.solve_map(what, "P2", 4.5, 0.5),
    "grazing_window": lambda what: symosc.grazing_window(what, "P2").intervals,
    "grazing_windows": lambda what: symosc.grazing_windows(what, "P2", v1=[1, 2]).low.tolist(),
    "grazing_start": lambda what: symosc.grazing_start(what, "P2", "1.2").start,
    "check_grazing": lambda what: symosc.check_grazing(what, "P2", n=5).mismatches,
    "values_containing": lambda what: symosc.values_containing(what, "P2", "Omega", "7*pi/6"),
    "simulate_many": lambda what: symosc.simulate_many(
        what, (0, 0, 0), 5, use_numba=False
    ).t.tolist(),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_scene_is_taken_for_its_parameters(name: str) -> None:
    expected = CALLS[name](P)
    for what in (SCENE, "fig9", SCENES / "fig9.toml", str(SCENES / "fig9.toml")):
        assert CALLS[name](what) == expected
    with pytest.raises(
        ParameterError, match=r"must be Parameters.* a Scene, or the name or file of one"
    ):
        CALLS[name](5)


def test_a_motion_of_parameters_begins_at_rest() -> None:
    whole = simulate(P, t0=0, x0=0, v0=0, t_end=6)
    assert simulate(P, t_end=6) == whole
    assert simulate(P, x0=0, t_end=6) == whole
    with pytest.raises(
        ParameterError, match="t_end = None: t_end is required when you pass Parameters"
    ):
        simulate(P)
    assert simulate(P, t_end="2.5T") == simulate(P, t_end=2.5 * 2 * np.pi / float(P.Omega))
    assert simulate("fig9", t0=1, t_end="2T").t_end == simulate("fig9", t0=1, t_end=1 + np.pi).t_end
    with pytest.raises(ParameterError, match=r"^t_end = 'manyT'"):
        simulate(P, t_end="manyT")
    pytest.importorskip("flint")
    same = symosc.certify(Scene("parameters", P, 0, 0, 0, 6))  # type: ignore[arg-type]
    assert symosc.certify(P, t_end=6).events == same.events


def test_a_sweep_of_parameters() -> None:
    pytest.importorskip("xarray")
    rest = Scene("rest", P, 0, 0, 0, 100)  # type: ignore[arg-type]
    for more in ({}, {"starts": (2, 0, 1)}):
        options: Any = {"t_end": "40T", "record": ("word", "x"), **more}
        mine, scenes = (sweep(what, {"Omega": [3.9, 4.1]}, **options) for what in (P, rest))
        assert mine.equals(scenes)
    with pytest.raises(
        ParameterError, match="t_end = None: t_end is required when you pass Parameters"
    ):
        sweep(P, {"Omega": [3.9, 4.1]})


def test_the_orbit_that_the_motion_settles_to() -> None:
    for name, word in (("fig9", "P32"), ("fig10", "P4645")):
        assert symosc.find_orbit(name).points == symosc.find_orbit(name, word).points
    quiet = Parameters(m=1, c=1, k=1, A0=0, B0="0.1", Omega=1, v1=-5, v2=5, mu1=1, mu2=1, FN=1)
    orbit = symosc.find_orbit(quiet)
    assert (orbit.word, orbit.periods, orbit.stable) == ("", 1, True)
    amplitude = abs(0.1 / complex(1 - 1, 1))  # of x'' + x' + x = 0.1 cos t
    assert np.ptp(orbit(np.linspace(0, orbit.period, 401)), axis=1) == pytest.approx(2 * amplitude)
    with pytest.raises(ParameterError, match="word = None: word is required without a damper"):
        symosc.find_orbit(P.replace(c=0))


@pytest.mark.slow
def test_texts_of_answers_are_short() -> None:
    t = np.linspace(float(SCENE.t0), 60, 1_000)
    x, v = simulate("fig9", t_end=60)(t)
    motion = simulate("fig9", t_end=700)
    answers = [
        motion,
        motion.events,
        motion.segments,
        symosc.reference_cases(),
        symosc.grazing_curve(P, "P2"),
    ]
    answers += [symosc.crosscheck("fig9", t, x + 0.1 * (t > 30), v), symosc.find_orbit(P, "P32")]
    for item in answers:
        assert len(repr(item)) <= 4_000
        assert len(str(item)) <= 4_000
    assert f"{len(motion.events):,} in all" in repr(motion.events)
