"""The figure that fits a result: by its axes and its columns."""

from __future__ import annotations

import numpy as np
import pytest
from bad_values import refused
from matplotlib.figure import Figure
from small_sweeps import made_up

from symosc import plot

pytest.importorskip("xarray")


def labels(over: dict[str, str], name: str | None = None) -> tuple[str, str]:
    dataset = made_up(
        over,
        sticks=lambda cells: np.arange(len(next(iter(cells.values())))) % 3,
        section=lambda cells: np.ones((len(next(iter(cells.values()))), 2, 2)),
    )
    axes = plot.swept_figure(dataset, name).axes[0]
    return axes.get_xlabel(), axes.get_ylabel()


def test_the_form_that_fits() -> None:
    assert labels({"mu1": "0:1:5"}) == (r"$\mu_1$", "displacement $x$ at whole periods")
    assert labels({"mu1": "0:1:5"}, "sticks") == (r"$\mu_1$", "sticks")
    assert labels({"mu1": "0:1:5", "k": "1:2:3"}, "sticks") == (r"$\mu_1$", "$k$")
    assert labels({"v0": "0:1:5", "x0": "1:2:3"}, "sticks") == ("$x_0$", "$v_0$")


def test_what_has_no_form() -> None:
    refused(lambda: labels({"mu1": "0:1:5", "k": "1:2:3", "c": "1:2:3"}, "sticks"), "dataset")
    refused(lambda: labels({"mu1": "0:1:5"}, "word"), "name")
    refused(lambda: plot.swept_figure(5), "dataset")  # type: ignore[arg-type]


def test_a_result_draws_itself() -> None:
    dataset = made_up({"mu1": "0:1:5"}, sticks=lambda cells: np.arange(len(cells["mu1"])))
    axes = Figure().add_subplot()
    assert dataset.symosc.plot(name="sticks", ax=axes) is axes.figure
    assert axes.get_ylabel() == "sticks"
    assert dataset.isel(mu1=slice(3)).symosc.plot(name="sticks").axes[0].has_data()
    refused(lambda: dataset.symosc.plot(name="word"), "name")
