"""Each public function with another friction law: it follows it, or refuses it in one line."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cli_runs import run

import symosc
from symosc import Belt, Oscillator, ParameterError, Scene, load_scene, plot
from symosc.scenes import as_toml

FIG9 = load_scene("fig9").parameters
TWO = FIG9.oscillator
SHARED: Any = {"m": 1, "c": "1/10", "k": 1, "B0": 1, "Omega": "3/2"}
ONE = Oscillator(**SHARED, belts=[Belt("1/5", mu="2/5")])
STATIC = Oscillator(**SHARED, belts=[Belt("1/5", mu="2/5", mu_s="3/5")])
STATIC_2 = TWO.replace(mu_s2=2)
CURVED = Oscillator(**SHARED, belts=[Belt("1/5", curve=[(0, "2/5"), (1, "1/5")], mu_s="3/5")])
THREE = Oscillator(**SHARED, belts=[Belt(v, mu="1/5") for v in (-1, "1/5", 2)])
TIMES = np.linspace(0, 3, 31)
ENDS: Any = {"start": (0.1, 1.0), "end": (0.2, 1.1)}


def scene(p: Any) -> Scene:
    start: Any = {"t0": 0, "x0": 0, "v0": 0, "t_end": 5}
    return Scene("mine", p, **start)


def summary_table(p: Any) -> Any:
    return symosc.simulate_many(p, [[0, 0, 0]], 5, use_numba=False, record="summary").columns()


#: A call of each public function that takes an oscillator, and of the plots that simulate one.
CALLS: dict[str, Callable[[Any], Any]] = {
    "atlas": lambda p: symosc.atlas(p, {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, workers=1),
    "attractors": lambda p: repr(symosc.attractors(p, [(0, 0, 0), (0, 1, 0)])),
    "bifurcation": lambda p: repr(symosc.bifurcation(p, {"k": [1, 2]}, sections=2, skip=2)),
    "certify": lambda p: symosc.certify(p, t_end=1),
    "certify a scene": lambda p: symosc.certify(scene(p), t_end=1),
    "check_grazing": lambda p: symosc.check_grazing(p, "P2", n=5),
    "compiled_residual": lambda p: repr(symosc.compiled_residual(p, "P2"))[:20],
    "continue_orbit": lambda p: symosc.continue_orbit(p, "P32", "Omega", ("3.99", "4.01")),
    "crosscheck": lambda p: (
        symosc.crosscheck(scene(p), TIMES, *symosc.simulate(scene(p))(TIMES), partial=True).ok
    ),
    "find_orbit": symosc.find_orbit,
    "fit": lambda p: symosc.fit(scene(p), [(0.1223, "stick"), (1.221, "slip")], "mu1"),
    "frequency_response": lambda p: symosc.frequency_response(p, {"Omega": [4]}),
    "grazing_curve": lambda p: symosc.grazing_curve(p, "P2", n=9),
    "grazing_start": lambda p: symosc.grazing_start(p, "P2", "3.1"),
    "grazing_window": lambda p: symosc.grazing_window(p, "P2"),
    "grazing_windows": lambda p: symosc.grazing_windows(p, "P2", k=[1, 2]),
    "is_grazing": lambda p: symosc.is_grazing(p, "P2", 1, 2),
    "jacobian": lambda p: symosc.jacobian(p, "P2", **ENDS).tolist(),
    "parameter_jacobian": lambda p: symosc.parameter_jacobian(p, "P2", **ENDS).tolist(),
    "plot.figure": lambda p: plot.figure(scene(p)),
    "residual": lambda p: list(symosc.residual(p, "P2", **ENDS)),
    "return_map": lambda p: str(symosc.return_map(p, points=8).after),
    "sensitivities": lambda p: symosc.sensitivities(p, "k", t_end=5).dt.tolist(),
    "simulate": lambda p: symosc.simulate(p, t_end=5).table(),
    "simulate with digits": lambda p: symosc.simulate(p, t_end=5, digits=20).table(),
    "simulate_many": lambda p: symosc.simulate_many(p, [[0, 0, 0]], 5, use_numba=False),
    "simulate_many, a summary": lambda p: {k: v.tolist() for k, v in summary_table(p).items()},
    "solve_grazing": lambda p: symosc.solve_grazing(p, "P2", theta_j=3, n=9),
    "solve_map": lambda p: symosc.solve_map(p, "P2", 30, 3),
    "sweep": lambda p: symosc.sweep(p, {"k": [1, 2]}, t_end="3T").word.values.tolist(),
    "sweep_status": lambda p: symosc.sweep_status(p, {"k": [1, 2]}, t_end="3T", path="map.nc"),
    "values_containing": lambda p: symosc.values_containing(p, "P2", "k", theta=2),
    "values_empty": lambda p: symosc.values_empty(p, "P2", "k"),
    "values_everything": lambda p: symosc.values_everything(p, "P2", "k"),
}
#: Public functions of which no argument is an oscillator.
OTHERS = {"continue_border", "law_error", "load_scene", "read_word", "scene_names", "theorem7"}
FOLLOW_STATIC = {
    "attractors", "bifurcation", "certify", "certify a scene", "crosscheck", "find_orbit", "fit",
    "frequency_response", "plot.figure", "return_map", "sensitivities", "simulate", "simulate_many",
    "sweep", "sweep_status",
}  # fmt: skip
#: Calls that take long, and differ only in the numbers of the parameters that they are given.
LONG = {"atlas", "continue_orbit", "check_grazing", "fit", "grazing_windows"}


def follows(name: str) -> bool:
    return name.partition(",")[0].partition(" with")[0] in FOLLOW_STATIC


def test_every_public_function_is_called() -> None:
    functions = {
        name for name in vars(symosc)["__all__"] if inspect.isfunction(getattr(symosc, name))
    }
    assert functions - OTHERS == functions & set(CALLS)


@pytest.mark.parametrize("p", [STATIC, STATIC_2], ids=["one belt", "two belts"])
@pytest.mark.parametrize("name", [name for name in CALLS if name != "continue_orbit"])
def test_static_friction_is_followed_or_refused_in_one_line(name: str, p: Oscillator) -> None:
    if follows(name):
        assert CALLS[name](p) is not None
        return
    with pytest.raises(ParameterError) as refused:
        CALLS[name](p)
    message = str(refused.value)
    n, belt = next((n, belt) for n, belt in enumerate(p.belts, 1) if belt.has_static)
    assert "\n" not in message
    assert f"static friction of belt {n}" in message
    assert f"mu_s = {belt.mu_s}" in message or f"mu_s={float(belt.mu_s):g}" in message


@pytest.mark.parametrize("p", [CURVED, THREE], ids=["curve", "three belts"])
def test_samples_of_other_laws_are_judged(p: Oscillator) -> None:
    assert CALLS["crosscheck"](p)


@pytest.mark.parametrize("name", [name for name in CALLS if name not in LONG])
def test_one_belt_is_followed(name: str) -> None:
    assert CALLS[name](ONE) is not None


@pytest.mark.parametrize("name", [name for name in CALLS if name not in LONG | {"plot.figure"}])
def test_two_coulomb_belts_are_parameters(name: str) -> None:
    assert CALLS[name](TWO) == CALLS[name](FIG9)


def test_one_belt_has_events_at_that_belt_alone() -> None:
    motion = symosc.simulate(STATIC, t_end=40)
    assert {event.boundary for event in motion.events} == {1}
    assert set(motion.word) == {"S1", "B1", "A1"}
    assert {segment.mode for segment in motion.segments} == {"Omega1", "Omega2", "belt1"}
    assert len(motion.to_scipy().t_events) == 1


#: Commands that cannot follow static friction.
REFUSING = (
    "certify {} --window P2", "certify {} --wrt k", "grazing {}",
    "atlas {} --over Omega=3:5 --over FN=1:2",
)  # fmt: skip
FOLLOWING = (
    "simulate {}", "simulate {} --digits 20", "simulate {} --set mu_s1=1 --t-end 2T", "scenes {}",
    "certify {} -o proof.json", "figure {} -o motion.svg", "orbit {}", "orbit {} -o orbit.svg",
    "orbit {} --response Omega=1:2:2 -o response.svg", "sweep {} --over mu_s1=0.6:1:2 --t-end 2T",
)  # fmt: skip


@pytest.fixture
def static_file(tmp_path: Any, monkeypatch: Any) -> str:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text(as_toml(scene(STATIC)) + "\n", encoding="utf-8")
    return "mine.toml"


@pytest.mark.parametrize("command", REFUSING)
def test_commands_refuse_static_friction_in_one_line(command: str, static_file: str) -> None:
    ended = run(*command.format(static_file).split())
    assert ended.exit_code == 2
    assert ended.stderr.count("\n") == 1
    assert "static friction of belt 1" in ended.stderr


@pytest.mark.parametrize("command", FOLLOWING)
def test_commands_follow_static_friction(command: str, static_file: str) -> None:
    ended = run(*command.format(static_file).split())
    assert ended.exit_code == 0, ended.stderr
