"""Figures of grazing: what is shaded is the window or region, borders are drawn as what they are."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet

from symosc import (
    ParameterError,
    Parameters,
    grazing_curve,
    grazing_window,
    load_scene,
    plot,
    values_containing,
    values_empty,
    values_everything,
)
from symosc.kernels.theorem7_cases import EVERYTHING
from symosc.plot.windows import INSIDE_COLOR, TURN

# -- windows and curves -----------------------------------------------------------------------------------------------


FIG9 = load_scene("fig9").parameters
MAPS = ("P2", "P3", "P5", "P6")


def parameters(rng: random.Random) -> Parameters:
    v1 = Fraction(rng.randint(-20, 20), 3)
    changes = {
        "B0": rng.randint(-9, 9),
        "k": rng.randint(0, 8),
        "Omega": Fraction(rng.randint(1, 30), 4),
    }
    return FIG9.replace(v1=v1, v2=v1 + Fraction(rng.randint(1, 30), 7), **changes)


@pytest.mark.quick(2)
@pytest.mark.parametrize("mapping", MAPS)
def test_what_is_drawn_thick_is_in_the_window(mapping: str) -> None:
    """Sampled against `contains`, in exact numbers; the places x_m from F = 0 itself."""
    rng = random.Random(mapping)
    dots = 0
    for _ in range(4):
        p = parameters(rng)
        window = grazing_window(p, mapping)
        circle, contacts = plot.window_figure(window).axes
        thick = {
            ax: [line for line in ax.lines if line.get_color() == INSIDE_COLOR]
            for ax in (circle, contacts)
        }
        arcs = [
            np.asarray(line.get_xydata()) for line in thick[circle] if line.get_marker() == "None"
        ]
        shown = [np.arctan2(arc[:, 1], arc[:, 0]) % TURN for arc in arcs]
        assert all(window.contains(float(theta)) for part in shown for theta in part[2:-2:60])
        length = sum(np.unwrap(np.arctan2(arc[:, 1], arc[:, 0]))[[0, -1]] @ [-1, 1] for arc in arcs)
        assert length == pytest.approx(sum(high - low for low, high, *_ in window.intervals))
        for ax, (across, up) in ((circle, ("cos", "sin")), (contacts, ("theta", "x"))):
            for dot in [line for line in thick[ax] if line.get_marker() == "o"]:
                (place,) = np.asarray(dot.get_xydata())
                theta = (np.arctan2(place[1], place[0]) if up == "sin" else place[0]) % TURN
                speed = float(p.v1 if mapping in ("P2", "P3") else p.v2)
                assert np.sin(theta) == pytest.approx(
                    -float(p.k) * speed / float(p.B0 * p.Omega), abs=1e-9
                )
                if up == "sin":  # the dashed line through it
                    levels = [
                        line.get_ydata() for line in circle.lines if np.ptp(line.get_xdata()) == 2.3
                    ]
                    assert levels == [pytest.approx([np.sin(theta)] * 2, abs=1e-9)]
                full = dot.get_markerfacecolor() == INSIDE_COLOR
                assert full == (window.kind == EVERYTHING), across
                dots += 1
        if p.k:
            if mapping in ("P2", "P3"):
                speed = p.v1
            else:
                speed = p.v2
            friction = {"P2": 1, "P3": 2, "P5": 2, "P6": 3}[mapping]
            constant = (
                p.A0
                - p.c * speed
                + {1: p.mu1 + p.mu2, 2: p.mu2 - p.mu1, 3: -p.mu1 - p.mu2}[friction] * p.FN
            )
            for line in [line for line in contacts.lines if len(line.get_xydata()) > 2]:  # type: ignore[arg-type]
                theta, x = np.asarray(line.get_xydata()).T
                assert x == pytest.approx(
                    (float(constant) + float(p.B0) * np.cos(theta)) / float(p.k), abs=1e-9
                )
    assert dots


def test_the_ends_of_flights_are_on_their_curves() -> None:
    curve = grazing_curve(FIG9, "P2", 40)
    flights = plot.figure_grazing_curve(curve).axes[1]
    lines = [
        np.asarray(line.get_xydata()) for line in flights.lines if line.get_linestyle() != "None"
    ]
    dots = [
        np.asarray(line.get_xydata()) for line in flights.lines if line.get_linestyle() == "None"
    ]
    ends = np.concatenate([line[[0, -1]] for line in lines])
    assert dots
    assert all(np.abs(ends - dot).sum(axis=1).min() < 1e-6 for dot in dots)


# -- regions of two parameters ----------------------------------------------------------------------------------------


BELTS = {"P2": "v1", "P3": "v1", "P5": "v2", "P6": "v2"}
PHASES = ("pi/2", "3*pi/2", "7*pi/6", "pi", ("pi", "3*pi/2"), ("0", "pi"))


def random_region(rng: random.Random) -> Any:
    mapping = rng.choice(list(BELTS))
    names = tuple(rng.sample(["k", "B0", "Omega", BELTS[mapping]], 2))
    changes = {
        "B0": rng.choice([-9, -2, 3]),
        "Omega": Fraction(rng.randint(1, 9), 4),
        "k": rng.randint(1, 5),
    }
    p = FIG9.replace(v1=rng.randint(-6, 2), v2=rng.randint(3, 9), **changes)
    order = rng.choice(["full", "paper"])
    asked = rng.choice(["contains", "contains", "empty", "everything"])
    if asked == "empty":
        return values_empty(p, mapping, names)
    if asked == "everything":
        return values_everything(p, mapping, names, order)
    return values_containing(p, mapping, names, rng.choice(PHASES), order)


def areas(ax: Axes) -> dict[bool, QuadContourSet]:
    """Return the shaded and the hatched area: by whether it is hatched."""
    sets = [item for item in ax.collections if isinstance(item, QuadContourSet) and item.filled]
    return {item.hatches != [None]: item for item in sets}


def covers(area: QuadContourSet | None, point: tuple[float, float]) -> bool:
    return area is not None and any(path.contains_point(point) for path in area.get_paths())


def span(ax: Axes, name: str) -> tuple[float, float]:
    low, high = getattr(ax, f"get_{name}lim")()
    return low, high


@pytest.mark.parametrize(
    "seed", [0, 3, *(pytest.param(i, marks=pytest.mark.campaign) for i in (1, 2, 4, 5))]
)
def test_what_is_shaded_is_the_region(seed: int) -> None:
    """At random points that are not next to a border: inside, outside, or not allowed."""
    rng = random.Random(seed)
    seen = set()
    for _ in range(3):
        region = random_region(rng)
        (ax,) = plot.region_figure(region).axes
        drawn = areas(ax)
        x = span(ax, "x")
        y = span(ax, "y")
        step = (x[1] - x[0]) / 400, (y[1] - y[0]) / 400
        for _ in range(40):
            point = rng.uniform(*x), rng.uniform(*y)
            near = [
                (point[0] + i * step[0], point[1] + j * step[1]) for i in (-2, 2) for j in (-2, 2)
            ]
            told = {inside(region, item) for item in (point, *near)}
            if len(told) > 1:
                continue
            (expected,) = told
            seen.add(expected)
            assert covers(drawn.get(False), point) == (expected is True), (region.text(), point)
            assert covers(drawn.get(True), point) == (expected is None), (region.text(), point)
    assert False in seen


def inside(region: Any, point: tuple[float, float]) -> bool | None:
    """Return whether a point is in a region; None: the parameters are not allowed."""
    values = dict(zip(region.question.names, map(Fraction, point), strict=True))
    try:
        return bool(region.contains(**values))
    except ParameterError:
        return None


@pytest.mark.parametrize(
    ("phase", "order", "labels"),
    [
        ("3*pi/2", "full", {"border, inside"}),
        ("3*pi/2", "paper", {"border, not inside"}),
        ("pi/2", "full", {"border, not inside"}),
    ],
)
def test_the_border_is_full_where_it_belongs_to_the_region(
    phase: str, order: str, labels: set[str]
) -> None:
    """P2 in v1 and Omega: k v1 > -B0 Omega sin theta.

    At 3 pi/2 equality is a graze of fourth order.
    """
    region = values_containing(FIG9, "P2", ("Omega", "v1"), phase, order)
    drawing = plot.region_figure(region, (0, 3), (-10, 10))
    shown = {text.get_text() for text in drawing.legends[0].get_texts()}
    assert {label for label in shown if label.startswith("border")} == labels
    speed = {"3*pi/2": 3, "pi/2": -3}[phase]
    assert region.contains(Omega=1, v1=speed) == ("border, inside" in labels)
    points = np.concatenate(
        [piece for pieces in borders(drawing.axes[0]).values() for piece in pieces]
    )
    assert np.allclose(points[:, 1], speed * points[:, 0], atol=1e-9)
    assert np.ptp(points[:, 0]) > 2.9


def borders(ax: Axes) -> dict[bool, list[Any]]:
    """Return the pieces of the border that are drawn full (True) and broken (False)."""
    lines = [
        item for item in ax.collections if isinstance(item, QuadContourSet) and not item.filled
    ]
    result: dict[bool, list[Any]] = {True: [], False: []}
    for item in lines:
        ((_, dashes),) = item.get_linestyle()
        result[dashes is None] += [piece for piece in item.allsegs[0] if len(piece)]
    return result


def test_bad_ranges() -> None:
    region = values_containing(FIG9, "P2", ("Omega", "k"), "pi")
    for arguments, message in (
        (((2, 1),), "from a lower to a higher value"),
        ((("x", 1),), "Omega = 'x'"),
    ):
        with pytest.raises(ParameterError, match=message):
            plot.region_figure(region, *arguments)  # type: ignore[arg-type]
