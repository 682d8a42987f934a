"""The error map: exact all over, and each border is needed."""

from __future__ import annotations

from fractions import Fraction
from math import isnan, nan
from typing import Any

import numpy as np
import pytest

from symosc.bench import error_map
from symosc.bench.plot_error_map import figure
from symosc.engine.flow import constants
from symosc.kernels import entire


@pytest.fixture(scope="module")
def errors() -> dict[str, Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(error_map, "BORDER_POINTS", 31)
        return error_map.run(quick=True)


def test_places_and_values() -> None:
    for text in ("1e-9", "0.3", "0.5", "0.75", "1", "1.5", "2", "70"):
        assert float(error_map.value_at(error_map.place_of(float(text)))) == pytest.approx(float(text), rel=1e-12)
    for beyond in (1e-9, -1e-9):
        value = error_map.value_at(error_map.place_of(1, beyond))
        assert float(value - 1) == pytest.approx(beyond, rel=1e-6)
    places = error_map.axis(-2, 2, 25)
    assert len(places) == 25
    assert np.all(np.diff(places) > 0)
    assert [float(error_map.value_at(place)) for place in places[[0, -1]]] == pytest.approx([0.01, 100])
    assert Fraction(1) in [error_map.value_at(place) for place in places]


@pytest.mark.slow
def test_symosc_is_exact_all_over_the_map(errors: dict[str, Any]) -> None:
    assert errors["largest"] < 50 * 2.0**-52
    assert np.nanmax(errors["symosc"]) == errors["largest"]
    assert errors["largest"] > 2.0**-53  # it is measured


@pytest.mark.slow
def test_the_border_is_needed(errors: dict[str, Any]) -> None:
    """On its side of the border the cheap formula is good to 50 ulp, on the other side it loses up to all digits."""
    inside, outside = [], []
    for n, tau in enumerate(errors["taus"]):
        for i, zeta in enumerate(errors["zeta"]):
            for j, ratio in enumerate(errors["ratio"]):
                K = constants(error_map.parameters(error_map.value_at(zeta), error_map.value_at(ratio)))
                value = errors["cheap"][n][i][j]
                if not isnan(value):
                    (inside if error_map.formula_of(tau, K) == "apart" else outside).append((tau, value))
    assert max(value for _, value in inside) < 50 * 2.0**-52
    assert max(value for tau, value in outside if tau >= 1) > 1e-9
    assert max(value for _, value in outside) > 1
    assert len(inside) > 200


def test_the_named_formula_is_the_one_that_is_taken() -> None:
    p = error_map.parameters(Fraction(1, 10), Fraction(1, 2))
    for parameters, tau, name in (
        (p, 3.0, "apart"),
        (p, 0.1, "series"),
        (p.replace(Omega=1, c=0), 3.0, "careful"),
        (p.replace(c=4), 3.0, "careful"),
    ):
        K = constants(parameters)
        assert error_map.formula_of(tau, K) == name
        cheap = error_map.closed_form(tau, K)[:5] if K.under and K.p else (nan,) * 5
        assert (entire.basis(tau, K)[:5] == cheap) == (name == "apart")


@pytest.mark.slow
def test_the_picture_of_the_map(errors: dict[str, Any]) -> None:
    drawing = figure(errors)
    panels = [ax for ax in drawing.axes if ax.get_title()]
    assert len(panels) == 2 * len(errors["taus"])
    words = {text.get_text() for ax in panels for text in ax.texts}
    assert {"cheap", "careful", "series"} <= words
    drawing.draw_without_rendering()
