"""Names of columns."""

from __future__ import annotations

import pytest

from symosc import ParameterError
from symosc.crosschecks.columns import asked_columns, find_columns, plain


@pytest.mark.parametrize(
    ("name", "simple"),
    [
        ("Time (s)", "time"),
        ("x(t)", "x"),
        ("dx/dt", "dxdt"),
        ("x'", "xprime"),
        ("ẋ", "xdot"),
        ("V [m/s]", "v"),
        ("(x)", "x"),
    ],
)
def test_names_without_units(name: str, simple: str) -> None:
    assert plain(name) == simple


def test_the_exact_name_comes_first_then_usual_ones_in_any_case() -> None:
    assert find_columns(["X", "x", "T", "V"], {}, "here") == {"t": "T", "x": "x", "v": "V"}
    assert find_columns(["Time", "Pos", "Run", "velocity"], {}, "here") == {
        "t": "Time", "x": "Pos", "id": "Run", "v": "velocity",
    }  # fmt: skip
    assert find_columns(["t", "x", "events"], {}, "here") == {"t": "t", "x": "x"}
    assert find_columns(["t", "x", "w"], {"v": None}, "here") == {"t": "t", "x": "x"}
    assert find_columns(["t", "A", "w"], {"x": "a", "v": "w"}, "here") == {"t": "t", "x": "A", "v": "w"}


def test_a_velocity_under_another_name_is_not_passed_over() -> None:
    with pytest.raises(ParameterError, match="'v': is missing in here; there are: t, x, w; without velocities"):
        find_columns(["t", "x", "w"], {}, "here")


@pytest.mark.parametrize("columns", [{"x": None}, {"t": "none"}, {"q": "x"}, {"x": "v"}, {"x": "a", "v": "a"}])
def test_what_cannot_be_asked(columns: dict[str, str | None]) -> None:
    with pytest.raises(ParameterError, match="columns"):
        asked_columns(columns)


def test_no_velocity_can_be_asked_for() -> None:
    assert asked_columns({"v": "none"}) == asked_columns({"v": None}) == {"v": None}
