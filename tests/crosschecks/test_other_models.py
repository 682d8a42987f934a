"""Solutions of other models, in the coordinates of these: moving bases and walls, pulled springs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cli_runs import run
from scipy.integrate import solve_ivp

from symosc import Belt, Oscillator, OtherModel, Scene, crosscheck, simulate
from symosc.scenes import as_toml

MODELS = {
    "a wall on the base": OtherModel(m=1, k=1, c="0.1", Omega="1.3", FN="1/4", Y=1, joined=True),
    "a pulled spring": OtherModel(
        m=1, k=2, Omega=1, FN=1, pull="1/10", belts=[Belt(0, "1/2", mu_s="4/5")]
    ),
    "a sine": OtherModel(m=1, k=1, Omega=2, FN=1, B0=3, phase="-pi/2", c="0.2", mu1="0.3"),
    "a base beside a belt": OtherModel(
        m=1, k=1, c="0.3", Omega="0.9", FN="1/2", W=1, Y="0.5", Y_phase=1, v1="0.3"
    ),
    "an incline": OtherModel(
        m=1, k=1, c="0.3", Omega="0.9", g="9.81", angle="0.2", mu1="0.4", B0=4
    ),
}
T = np.linspace(0, 30, 1201)


def scene_of(model: OtherModel) -> Scene:
    return Scene("other", model, 0, "0.1", "0.2", 30)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", MODELS)
def test_right_solutions_are_right_in_every_form(name: str) -> None:
    scene = scene_of(MODELS[name])
    motion = simulate(scene)
    x, v = motion(T)
    events = [(event.t, event.kind) for event in motion.events]
    exact = crosscheck(scene, T, x, v, events=events)
    assert exact.ok, exact.summary()
    assert max(exact.max_error_x, exact.max_error_v) < 1e-13
    assert len(exact.matched) == len(events) >= 10
    assert crosscheck(MODELS[name], T, x, v).ok
    assert crosscheck(scene, lambda t: motion(t)).ok
    assert crosscheck(scene, T, x).ok
    rounded = crosscheck(scene, T, np.round(x, 5), np.round(v, 5))
    assert rounded.ok
    assert rounded.rounded == {"x": "5 decimals", "v": "5 decimals"}
    positions = crosscheck(scene, T, np.round(x, 6))
    assert positions.ok
    assert positions.rounded == {"x": "6 decimals"}
    assert not crosscheck(scene, T, np.round(x * 1.01, 6)).ok


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("a wall on the base", {"Y": "1.001"}),
        ("a pulled spring", {"pull": "0.1001"}),
        ("a sine", {"phase": "-1.57"}),
        ("a base beside a belt", {"W": "1.001"}),
        ("an incline", {"angle": "0.2001"}),
    ],
)
def test_a_solution_of_a_model_that_is_slightly_different_is_wrong(
    name: str, change: dict[str, Any]
) -> None:
    scene = scene_of(MODELS[name])
    x, v = simulate(scene)(T)
    other_x, other_v = simulate(scene_of(MODELS[name].replace(**change)))(T)
    found = crosscheck(scene, T, other_x, other_v)
    assert not found.ok
    # Errors are those in the model's own coordinates.
    assert found.max_error_x == pytest.approx(np.abs(other_x - x).max(), rel=1e-9)
    assert found.max_error_v == pytest.approx(np.abs(other_v - v).max(), rel=1e-9)


def test_a_solver_of_the_models_own_equation_is_right() -> None:
    """The wall oscillates; the mass is faster than it all the time."""
    model = OtherModel(m=2, k="1/2", c="0.3", Omega="1.5", FN="1/2", W=1, W_phase="1/2", B0=1)

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, (np.cos(1.5 * t) - 0.3 * v - 0.5 * x - 0.5) / 2]

    solution = solve_ivp(
        rates, (0, 1), (0, 9), method="DOP853", rtol=1e-12, atol=1e-12, dense_output=True,
        events=[lambda t, y: y[1] - np.cos(1.5 * t + 0.5)],
    )  # fmt: skip
    found = crosscheck(Scene("wall", model, 0, 0, 9, 1), solution)  # type: ignore[arg-type]
    assert found.ok, found.summary()
    assert any("t_events are left out" in note for note in found.notes)


def test_events_of_a_solver_count_under_any_friction_law() -> None:
    law = Oscillator(
        m=1, c="0.1", k=1, B0="0.6", Omega="1.4", belts=[Belt(1, mu="0.7", mu_s="1.26")]
    )

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, 0.6 * np.cos(1.4 * t) - 0.1 * v - x + 0.7]

    def contact(t: float, state: np.ndarray) -> float:
        return float(state[1] - 1)

    contact.terminal = True  # type: ignore[attr-defined]
    solution = solve_ivp(
        rates, (0, 9), (-1, 0), method="DOP853", rtol=1e-12, atol=1e-12, dense_output=True,
        events=[contact],
    )  # fmt: skip
    found = crosscheck(law, solution)
    assert found.ok, found.summary()
    assert len(found.matched) == len(solution.t_events[0]) == 1


def test_the_command_takes_the_file_of_a_model(tmp_path: Path) -> None:
    scene = scene_of(MODELS["a base beside a belt"])
    x, v = simulate(scene)(T)
    (tmp_path / "base.toml").write_text(as_toml(scene))
    for factor, code in ((1, 0), (1.001, 1)):
        np.savetxt(
            tmp_path / "mine.csv", np.column_stack([T, factor * x, factor * v]), delimiter=",",
            header="t,x,v", comments="",
        )  # fmt: skip
        result = run("check", str(tmp_path / "base.toml"), str(tmp_path / "mine.csv"))
        assert result.exit_code == code, result.output
        assert "t less -1.968429546, x less the motion of the belts" in result.output
