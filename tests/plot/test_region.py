"""Figures of regions of two parameters: what is shaded is the region, and the border is drawn as what it is."""

from __future__ import annotations

import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure

from symosc import ParameterError, load_scene, plot, values_containing, values_empty, values_everything
from symosc.cli.app import main

FIG9 = load_scene("fig9").parameters
MAPS = {"P2": "v1", "P3": "v1", "P5": "v2", "P6": "v2"}
PHASES = ("pi/2", "3*pi/2", "7*pi/6", "pi", ("pi", "3*pi/2"), ("0", "pi"))


def random_region(rng: random.Random) -> Any:
    mapping = rng.choice(list(MAPS))
    names = tuple(rng.sample(["k", "B0", "Omega", MAPS[mapping]], 2))
    changes = {"B0": rng.choice([-9, -2, 3]), "Omega": Fraction(rng.randint(1, 9), 4), "k": rng.randint(1, 5)}
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
    sets = [each for each in ax.collections if isinstance(each, QuadContourSet) and each.filled]
    return {each.hatches != [None]: each for each in sets}


def covers(area: QuadContourSet | None, point: tuple[float, float]) -> bool:
    return area is not None and any(path.contains_point(point) for path in area.get_paths())


def span(ax: Axes, name: str) -> tuple[float, float]:
    low, high = getattr(ax, f"get_{name}lim")()
    return low, high


@pytest.mark.full(4)
@pytest.mark.parametrize("seed", [0, 3, *(pytest.param(i, marks=pytest.mark.slow) for i in (1, 2, 4, 5))])
def test_what_is_shaded_is_the_region(seed: int) -> None:
    """At random points that are not next to a border: inside, outside, or not allowed."""
    rng = random.Random(seed)
    seen = set()
    for _ in range(3):
        region = random_region(rng)
        (ax,) = plot.region_figure(region).axes
        drawn = areas(ax)
        x, y = span(ax, "x"), span(ax, "y")
        step = (x[1] - x[0]) / 400, (y[1] - y[0]) / 400
        for _ in range(40):
            point = rng.uniform(*x), rng.uniform(*y)
            near = [(point[0] + i * step[0], point[1] + j * step[1]) for i in (-2, 2) for j in (-2, 2)]
            told = {inside(region, each) for each in (point, *near)}
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
def test_the_border_is_full_where_it_belongs_to_the_region(phase: str, order: str, labels: set[str]) -> None:
    """P2 in v1 and Omega: k v1 > -B0 Omega sin theta; at 3 pi/2 equality is a graze of fourth order."""
    region = values_containing(FIG9, "P2", ("Omega", "v1"), phase, order)
    drawing = plot.region_figure(region, (0, 3), (-10, 10))
    shown = {text.get_text() for text in drawing.legends[0].get_texts()}
    assert {label for label in shown if label.startswith("border")} == labels
    speed = {"3*pi/2": 3, "pi/2": -3}[phase]
    assert region.contains(Omega=1, v1=speed) == ("border, inside" in labels)
    points = np.concatenate([piece for pieces in borders(drawing.axes[0]).values() for piece in pieces])
    assert np.allclose(points[:, 1], speed * points[:, 0], atol=1e-9)
    assert np.ptp(points[:, 0]) > 2.9


def borders(ax: Axes) -> dict[bool, list[Any]]:
    """Return the pieces of the border that are drawn full (True) and broken (False)."""
    lines = [each for each in ax.collections if isinstance(each, QuadContourSet) and not each.filled]
    found: dict[bool, list[Any]] = {True: [], False: []}
    for each in lines:
        ((_, dashes),) = each.get_linestyle()
        found[dashes is None] += [piece for piece in each.allsegs[0] if len(piece)]
    return found


@pytest.mark.parametrize(("mapping", "belt"), [("P6", "v2"), ("P5", "v2")])
def test_a_border_of_two_kinds(mapping: str, belt: str) -> None:
    """In B0 and v2 equality is a graze of fourth order where the belt has the right sign, else not inside."""
    p = FIG9.replace(v1=-50, v2=2)
    phase = {"P6": "pi/2", "P5": "3*pi/2"}[mapping]
    region = values_containing(p, mapping, ("B0", belt), phase)
    drawing = plot.region_figure(region, (-9, 9), (-20, 20))
    labels = {text.get_text() for text in drawing.legends[0].get_texts()}
    assert labels >= {"border, inside", "border, not inside"}
    ratio = p.Omega / p.k
    for full, pieces in borders(drawing.axes[0]).items():
        points = np.concatenate(pieces)
        assert np.ptp(points[:, 1]) > 9
        for x in points[5:-5:25, 0]:
            amplitude = Fraction(float(x))
            speed = -ratio * amplitude if mapping == "P6" else ratio * amplitude
            assert region.contains(B0=amplitude, v2=speed) == full, (mapping, full, float(x))


def test_default_ranges_reach_twice_the_given_values() -> None:
    (ax,) = plot.region_figure(values_containing(FIG9, "P2", ("Omega", "B0"), "pi")).axes
    assert (ax.get_xlim(), ax.get_ylim()) == ((0, 2 * float(FIG9.Omega)), (-2 * float(FIG9.B0), 2 * float(FIG9.B0)))


def test_the_given_values_are_marked_and_named() -> None:
    region = values_containing(FIG9, "P2", ("Omega", "k"), "7*pi/6")
    for values, word, face in (({"Omega": "1/2"}, "inside", "black"), ({}, "outside", "white")):
        asked = values_containing(FIG9.replace(**values), "P2", ("Omega", "k"), "7*pi/6")
        drawing = plot.region_figure(asked)
        (dot,) = [line for line in drawing.axes[0].lines if line.get_marker() == "o"]
        assert (dot.get_label(), dot.get_markerfacecolor()) == (f"given values, {word}", face)
    assert not [line for line in plot.region_figure(region, (9, 10)).axes[0].lines if line.get_marker() == "o"]


def test_an_answer_draws_itself_into_axes_of_a_users_own() -> None:
    region = values_empty(FIG9, "P5", ("k", "v2"))
    own = Figure().subplots()
    assert region.plot(ax=own) is own.figure
    assert "nowhere here" in [text.get_text() for text in own.texts]
    assert [own.get_xlabel(), own.get_ylabel()] == ["$k$", "$v_2$"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("region",), "must be a ParameterRegion"),
        ((None, (2, 1)), "from a lower to a higher value"),
        ((None, 3), "a pair"),
        ((None, ("x", 1)), "Omega = 'x'"),
        ((None, None, (1, 2, 3)), "a pair"),
    ],
)
def test_bad_input(arguments: tuple[Any, ...], message: str) -> None:
    region = values_containing(FIG9, "P2", ("Omega", "k"), "pi")
    with pytest.raises(ParameterError, match=message):
        plot.region_figure(*(region if i == 0 and each is None else each for i, each in enumerate(arguments)))


ASKED = ["grazing", "fig9", "--map", "P2", "--solve", "Omega,k", "--phase", "7*pi/6"]


@pytest.mark.slow
def test_on_the_command_line(tmp_path: Path) -> None:
    run = CliRunner().invoke(main, [*ASKED, "--plot", str(tmp_path / "region.svg")])
    assert run.exit_code == 0, run.output
    assert run.stdout == "P2 grazes at theta = 7*pi/6 where k > 9*Omega/2\n"
    assert (tmp_path / "region.svg").read_text(encoding="utf-8").startswith("<?xml")
    run = CliRunner().invoke(main, [*ASKED, "--plot", "-"])
    assert run.stdout.startswith("<?xml")
    assert run.stdout.endswith("</svg>\n")


@pytest.mark.parametrize(
    "arguments",
    [
        ["fig9", "--map", "P2", "--solve", "Omega", "--phase", "pi"],
        ["fig9", "--map", "P2", "--solve", "Omega,k"],
        ["fig9", "--map", "P2", "--map", "P3", "--solve", "Omega,k", "--phase", "pi"],
        ["--map", "P2", "--solve", "Omega", "--phase", "pi"],
        ["fig9", "--map", "P2", "--solve", "Omega,k", "--phase", "pi", "--check", "10"],
    ],
)
def test_what_is_no_one_region_is_refused(arguments: list[str], tmp_path: Path) -> None:
    run = CliRunner().invoke(main, ["grazing", *arguments, "--plot", str(tmp_path / "region.pdf")])
    assert (run.exit_code, run.stdout) == (2, "")
    assert run.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
