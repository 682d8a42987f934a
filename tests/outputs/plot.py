"""Figures, notebook pages and the explorer.

Of motions, orbits, branches, grazing windows, sweeps, judged solutions.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, partial
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from answers import MAKERS, PROVEN, answer
from excerpts import crosscheck
from explorer_states import FIG5, random_state
from looks import full
from matplotlib.figure import Figure
from paper_orbits import FIG9 as P
from problems import ordinary
from said import written
from small_sweeps import made_up
from stored_outputs import lines_of, some_lines

import symosc
from symosc import OtherModel, Scene, grazing_curve, grazing_window, load_scene, plot, simulate
from symosc.analysis.response import COLUMNS, FrequencyResponse
from symosc.base.display.drawable import Comparable, Listing
from symosc.certificates.atlas import Atlas, ProvenBox, Region
from symosc.certificates.certificate import Certificate
from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.report import CrossCheck
from symosc.orbits.border import Border, SpecialPoint
from symosc.orbits.periodic_orbit import SwitchingPoint
from symosc.plot.explorer import answers as explorer
from symosc.plot.windows import draw_plane
from symosc.reference.score import CaseScore, Score

Case = Callable[[], object]

# -- motions ----------------------------------------------------------------------------------------------------------


def motion(seed: int, **changes: Any) -> symosc.Trajectory:
    """Return the motion of a random oscillator."""
    p, start = ordinary(random.Random(seed), **changes)
    return simulate(p, **start, max_events=30)


@cache
def on_moving_belts() -> symosc.Trajectory:
    """Return a motion on belts whose speeds oscillate."""
    model = OtherModel(
        m=1,
        k=2,
        Omega="1.3",
        FN=1,
        W="0.6",
        W_phase="0.4",
        v1="-0.4",
        v2="0.9",
        mu1=1,
        mu2="0.7",
        B0=2,
    )
    return simulate(model, t0=0, x0=1, v0=0, t_end=14)


def own_figure(draw: Callable[..., Figure]) -> Figure:
    """Draw into the right one of two axes of a figure of one's own."""
    drawing = Figure()
    _, right = drawing.subplots(1, 2)
    assert draw(ax=right) is drawing
    return drawing


def own(draw: Callable[..., Figure]) -> str:
    return full(own_figure(draw))


MOTIONS: dict[str, Case] = {
    "fig5": lambda: plot.figure("fig5", t_end=9),
    "fig8 with magnified sticks": lambda: plot.figure("fig8", t_end=9, panels="abg"),
    "fig8 with more sticks, one column": lambda: full(
        plot.figure("fig8", t_end=40, panels="bc", columns=1)
    ),
    "fig8, the panel with insets alone": lambda: axes_in(plot.figure("fig8", panels="b")),
    "fig9, a periodic scene": lambda: plot.figure("fig9"),
    "fig9 in one column": lambda: axes_in(plot.figure("fig9", columns=1, panels="cf")),
    "a square plane": lambda: full(plot.figure("fig5", panels="c")),
    "a short scene": lambda: plot.figure("fig10-orbit", panels="b"),
    "from a stick": lambda: plot.figure("fig6", panels="dg", boundary=2),
    "a graze": lambda: full(plot.figure("fig8-exact", panels="ab")),
    "no events": lambda: plot.figure("fig7", panels="bd", t_end=3),
    "both belts": lambda: plot.figure(motion(5), panels="aef", boundary=2),
    "both belts, first": lambda: plot.figure(motion(8), panels="bg"),
    "moving belts": lambda: plot.figure(on_moving_belts(), panels="abf"),
    "many marks": lambda: plot.figure(simulate("fig9", t_end="60T"), panels="cd"),
    "without a transient": lambda: plot.figure(
        simulate("fig9", t_end="12T"), panels="bg", skip="8T"
    ),
    "with a style": lambda: full(
        plot.figure("fig5", panels="bd", t_end=5, skip=1, lw=3, color="teal", alpha=0.5)
    ),
    "into axes": lambda: own(partial(plot.figure, "fig5", t_end=3)),
    "an orbit": lambda: axes_in(answer("orbit").plot()),
    "an orbit, forces": lambda: answer("orbit").plot("f", columns=1),
    "an orbit into axes": lambda: axes_in(own_figure(answer("orbit").plot)),
    "an orbit between both belts": lambda: plot.orbit_figure(both_belts(), "bd", columns=1),
}


def drawn_in(drawing: Figure) -> str:
    return "\n".join(lines_of(drawing))


def axes_in(drawing: Figure) -> str:
    return "\n".join(line for line in lines_of(drawing) if re.match(" *(axes|limits|figure)", line))


@cache
def both_belts() -> symosc.PeriodicOrbit:
    return symosc.find_orbit(P.replace(Omega=5, FN=5), "P6827")


# -- branches and borders ---------------------------------------------------------------------------------------------


def branch(**changes: Any) -> symosc.Branch:
    """Return a branch with another stability and other ends than it has."""
    found = copy(answer("branch"))
    for name, value in changes.items():
        setattr(found, name, value)
    return found


def ended(first: str, last: str, beyond: str | None = None) -> Any:
    ends = answer("branch").ends
    return ends[0]._replace(kind=first, beyond=beyond), ends[1]._replace(kind=last, beyond="P3121")


def unstable() -> symosc.Branch:
    """Return one that becomes marginal and then unstable, and whose multipliers meet and part."""
    found = answer("branch")
    n = len(found.values)
    sizes = np.linspace(0.9, 1.2, n)
    turn = np.exp(1j * np.linspace(-0.5, 0.5, n) * (np.arange(n) > n // 2))
    sizes[n // 3 : n // 2] = 1 + 1e-12
    multipliers = np.stack([sizes * turn, sizes * turn.conj()], axis=1)
    return branch(
        multipliers=multipliers,
        stable=sizes < 1,
        labels=("P2", "P2"),
        ends=ended("grazing", "vanishing of a slip"),
    )


def border(kind: str, *points: tuple[float, float], **changes: Any) -> Border:
    """Return a border through given points."""
    found = copy(answer("border"))
    found.points, found.sliding = np.array(points, float), kind
    found.errors = np.full_like(found.points, 1e-12)
    found._words, found.special = ("P32", None), ()
    for name, value in changes.items():
        setattr(found, name, value)
    return found


SPECIAL = (
    SpecialPoint("fold", (3.2, 9.5), "it turns", 1e-9),
    SpecialPoint("crossing-sliding and grazing-sliding", (3.4, 10.0), "two margins are 0", 1e-10),
)


@cache
def borders() -> list[Border]:
    across = border(
        "adding-sliding", (8, 3.1), (11, 3.5), parameters=("FN", "Omega"), _words=("P132", "P32")
    )
    return [
        border("grazing-sliding", (3.1, 9), (3.3, 10), (3.6, 10.5), special=SPECIAL),
        border("", (3.2, 9), (3.0, 11), special=SPECIAL[:1]),
        across,
    ]


def long_branch() -> symosc.Branch:
    """Return one of four mappings, which come twice and more often, and of many points."""
    found = answer("branch")
    many = 21
    points = np.array([[(0.1 * k, 1 + 0.01 * k * i) for i in range(4)] for k in range(many)])
    switchings = tuple(SwitchingPoint(0.1, x) for x in (1.0, 1.1, 1.2, 1.3))
    return branch(
        values=np.linspace(5, 3, many),
        points=points,
        labels=("P2",) * 4,
        multipliers=np.tile(found.multipliers[:1], (many, 1)),
        stable=np.full(many, True),
        ends=(found.ends[0]._replace(points=switchings), found.ends[1]._replace(points=switchings)),
    )


BRANCHES: dict[str, Case] = {
    "a branch": lambda: full(answer("branch").plot()),
    "a branch into axes": lambda: own(answer("branch").plot),
    "a branch that becomes unstable": lambda: full(unstable().plot()),
    "a branch without an orbit beyond": lambda: branch(
        ends=ended("no convergence", "birth of a stick")
    ).plot("b"),
    "a long branch": lambda: long_branch().plot("a"),
    "a border": lambda: full(answer("border").plot()),
    "a border with a fold": lambda: full(borders()[0].plot(lw=2)),
    "a flat border": lambda: border(
        "crossing-sliding", *((3 + k / 9, 9 + k / 99) for k in range(9))
    ).plot(),
    "borders": lambda: full(plot.border_figure(borders())),
    "borders into axes": lambda: own(partial(plot.border_figure, borders()[:2], color="red")),
}


# -- judged solutions -------------------------------------------------------------------------------------------------


@cache
def wrong() -> CrossCheck:
    """Return the check of a solution that misses and invents events.

    Its errors are no rounding noise.
    """
    t = np.linspace(0, 7, 150)
    x, v = simulate("fig5", t_end=7)(t)
    noise = 1e-4 * np.sin(3 * t)
    v = (
        v
        + noise
        + 0.6 * (abs(t - 2.1) < 0.1)
        + 0.5 * (abs(t - 4.9) < 0.25)
        - 0.8 * (abs(t - 6.6) < 0.1)
    )
    found = crosscheck("fig5", t, x + noise, v, tolerance=2e-3)
    other = Diagnosis("smoothed friction", "", "friction is smoothed", "all sticks are flights")
    why = Diagnosis(
        "coefficient",
        "mu1",
        "mu1 is 0.7",
        "with it all steps are right",
        0.7123,
        0.01,
        0.97,
        (other,),
    )
    found.__dict__["diagnosis"] = (why, other)  # finding it takes a second
    return found


@cache
def inexact() -> CrossCheck:
    """Return the check of a solution that is right to its tolerance."""
    t = np.linspace(0, 7, 1200)
    x, v = simulate("fig5", t_end=7)(t)
    return crosscheck("fig5", t, x + 1e-4 * np.sin(3 * t), v, tolerance=1e-2)


def page_of(check: CrossCheck) -> str:
    """Return the page of a check without its pictures."""
    with patch.object(Figure, "savefig", lambda *_, **__: None):
        text = written(check.to_html, "check.html")
    text = re.sub(r"base64,[^\"]*", "", text)
    return re.sub(r"(?s)<style>.*?</style>", "", text).replace('</td><td class="">', " | ")


@cache
def fitted(weighted: bool) -> symosc.Fit:
    events = simulate("fig5", t_end=9).events
    data = [(float(event.t) + 1e-3 * (-1) ** i, event.kind) for i, event in enumerate(events)]
    return symosc.fit("fig5", data, "mu1", sigma=1e-3 if weighted else None)


@cache
def fitted_samples(with_v: bool) -> symosc.Fit:
    t = np.linspace(0, 3, 20)
    x, v = simulate("fig5", t_end=3)(t)
    data = {"t": t, "x": x + 1e-2 * np.cos(9 * t)} | (
        {"v": v - 1e-2 * np.sin(7 * t)} if with_v else {}
    )
    return symosc.fit("fig5", data, "x0", sigma=(1e-2, 2e-2) if with_v else None)


def scores() -> list[Score]:
    """Return scores of solvers in cases of three groups."""
    cases = [
        CaseScore("one", "paper", 4, 1.0, units=3e4),
        CaseScore("two", "paper", 4, 10.0, units=1e-9),
        CaseScore("three", "easy", 2, 1.0, given=False),
        CaseScore("four", "hard", 2, 1.0, units=1e13),
        CaseScore("five", "hard", 0, 1.0),
        CaseScore("six", "hard", 3, 1.0, without_x=1, units=5.0),
    ]
    return [Score(f"solver {i}", 1e-9, cases[i % 3 :] + cases[: i % 3]) for i in range(10)]


def steps_of(check: CrossCheck, panels: str | None = None, *steps: int) -> str:
    return "\n".join(full(plot.step_figure(check, step, panels)) for step in steps)


ENCLOSED = Certificate(
    "orbit",
    False,
    "open",
    (
        ("stick", "Omega1", "belt1", ("1.25", "1.2500001"), ("-3.5", "-3.4999")),
        ("slip", "belt1", "Omega2", ("2.5", "2.500003"), ("-1", "-1")),
    ),
)

JUDGED: dict[str, Case] = {
    "a wrong solution": lambda: full(wrong().plot()),
    "a wrong solution into axes": lambda: axes_in(own_figure(wrong().plot)),
    "a right solution": lambda: full(inexact().plot("ac")),
    "an exact solution": lambda: answer("check").plot("a"),
    "the first wrong step": lambda: plot.step_figure(wrong()),
    "other steps": lambda: steps_of(wrong(), "a", 1, 148),
    "a step of a right solution": lambda: plot.step_figure(inexact(), panels="b"),
    "the step with an event": lambda: plot.step_figure(inexact(), 20),
    "page of a wrong solution": lambda: some_lines(page_of(wrong()), 13, 103),
    "page of a right solution": lambda: some_lines(page_of(inexact()), 0, 38),
    "a fit": lambda: full(fitted(True).plot()),
    "a fit without errors": lambda: fitted(False).plot("b"),
    "a fit of samples": lambda: full(fitted_samples(True).plot()),
    "a fit of positions": lambda: own(fitted_samples(False).plot),
    "a certificate": lambda: full(PROVEN.plot()),
    "an open certificate": lambda: full(ENCLOSED.plot()),
    "scores": lambda: full(plot.score_figure(scores())),
    "one score": lambda: plot.score_figure(scores()[1:2]),
}

# -- sweeps -----------------------------------------------------------------------------------------------------------

ONE = {"Omega": "1:6:12"}
TWO = {"Omega": "1:6:12", "FN": "1:20:8"}
WORDS = np.array(["P32", "P3212", "P2", ""])


def bands(cells: Any) -> Any:
    return np.clip(cells["Omega"] - 1, 0, 3.5).astype(int)


def made(over: Any, starts: Any = None, **columns: Any) -> Any:
    pytest.importorskip("xarray")
    return made_up(over, starts=starts, **columns)


def swept(over: Any, name: str | None = None, starts: Any = None, **columns: Any) -> Figure:
    return plot.swept_figure(made(over, starts, **columns), name)


def undecided(cells: Any) -> Any:
    return np.where(cells["FN"] + cells["Omega"] < 5, "undecidable", "t_end")


def sections(cells: Any) -> Any:
    return cells["Omega"][:, None, None] * np.array([[1, 2], [3, 4], [5, 6]])


def many_words(cells: Any) -> Any:
    return np.array(
        [f"P{int(a)}{int(b)}" for a, b in zip(cells["Omega"], cells["FN"], strict=True)]
    )


def response(n: int = 24, status: str = "orbit") -> FrequencyResponse:
    """Return a response with a resonance, jumps of phase and gaps."""
    values = np.linspace(1, 6, n)[::-1]
    columns: dict[str, Any] = {name: np.cos(values + i) for i, name in enumerate(COLUMNS)}
    columns["amplitude"] = 1 / (abs(values - 3) + 0.02)
    columns["balance"] = np.where(values > 5, np.inf, columns["amplitude"] * 1.1)
    columns["phase"] = np.arctan2(np.sin(values * 1.5), np.cos(values * 1.5))
    columns["word"] = np.where(
        values < 3, "P32", np.where(values < 4, "P23", np.where(values < 5, "P132", ""))
    )
    columns["status"] = np.where(values < 1.5, "rest", status)
    columns |= {"dissipated": np.zeros(n), "stuck": abs(columns["stuck"])}
    found = FrequencyResponse.__new__(FrequencyResponse)
    found.__dict__.update(name="Omega", values=values, **columns)
    return found


@cache
def plane(proven: bool) -> Atlas:
    """Return an atlas of seven words, some of whose boxes are proven."""
    sides = [((Fraction(i), Fraction(i + 1)), (Fraction(5), Fraction(5 + i))) for i in range(8)]
    words = ["P32", "P132", "rest", "P2", "P3", "P3212", "P56", "P8", ""]
    if proven:
        boxes = [ProvenBox(word, side, ()) for word, side in zip(words, sides, strict=False)]
    else:
        boxes = []
    regions = [Region(word, 0.2 - i / 50, 0.1 * proven) for i, word in enumerate(words)]
    found = Atlas.__new__(Atlas)
    for name, value in {
        "parameters": P,
        "over": ("Omega", "FN"),
        "regions": tuple(regions),
        "boxes": tuple(boxes),
        "open": tuple(sides[6:]) if proven else (),
        "borders": tuple(borders()),
        "grid": tuple((i + 0.5, 6.0 + j, words[i]) for i in range(8) for j in range(2)),
        "range": ((Fraction(0), Fraction(8)), (Fraction(5), Fraction(13))),
    }.items():
        object.__setattr__(found, name, value)
    return found


SWEEPS: dict[str, Case] = {
    "a bifurcation diagram": lambda: full(
        swept(ONE, section=sections, word=lambda c: WORDS[bands(c)])
    ),
    "its velocities": lambda: plot.bifurcation_figure(made(ONE, section=sections), "v"),
    "a section of starts": lambda: swept(ONE, starts=[(0, 0, 0), (0, 1, 0)], section=sections),
    "a curve": lambda: full(swept(ONE, stuck=lambda c: c["Omega"] ** 2 / 40)),
    "a curve of counts": lambda: full(
        swept({"mu1": "0:1:9"}, sticks=lambda c: (9 * c["mu1"]).astype(int))
    ),
    "words over one axis": lambda: full(swept(ONE, word=lambda c: WORDS[bands(c)])),
    "a map of words": lambda: full(swept(TWO, word=lambda c: WORDS[bands(c)], status=undecided)),
    "a map of many words": lambda: full(swept(TWO, word=many_words)),
    "a map of counts": lambda: full(swept(TWO, sticks=bands)),
    "a map of 24 counts": lambda: full(
        swept({"k": "1:5:5", "Omega": "1:5:5"}, sticks=lambda c: np.arange(25) % 24)
    ),
    "a map of 25 counts": lambda: full(
        swept({"k": "1:5:5", "Omega": "1:5:5"}, sticks=lambda c: np.arange(25))
    ),
    "a map of numbers": lambda: full(
        swept(TWO, "x", x=lambda c: c["Omega"] * c["FN"], status=undecided)
    ),
    "a map of one number": lambda: swept({"k": "1:2:2", "Omega": "1:2:2"}, x=lambda c: np.ones(4)),
    "a basin": lambda: full(
        swept({"v0": "-3:30:9", "x0": "-1:1:5"}, word=lambda c: WORDS[(c["v0"] > 0).astype(int)])
    ),
    "a map over v0": lambda: own(
        partial(plot.map_figure, made({"k": "1:3:3", "v0": "-3:3:4"}, x=lambda c: c["v0"]))
    ),
    "a response": lambda: full(response().plot()),
    "a response in three panels": lambda: response(status="none").plot("cae"),
    "a response without orbits": lambda: own(response(2).plot),
    "events": lambda: full(answer("events").plot()),
    "no events of many": lambda: full(answer("no events").plot()),
    "events into axes": lambda: own(answer("events").plot),
    "a summary": lambda: full(answer("summary").plot()),
    "a summary of sections": lambda: full(answer("summary").plot("section")),
    "a summary of numbers": lambda: full(answer("summary").plot("x_max")),
    "a summary of counts": lambda: answer("summary").plot("sticks"),
    "a summary of many words": lambda: full(
        symosc.Summary(word=np.array([f"P{n * n % 61}" for n in range(80)] + [""] * 3)).plot()
    ),
    "an atlas": lambda: full(plane(True).plot()),
    "an atlas without proofs": lambda: drawn_in(own_figure(plane(False).plot)),
}

# -- grazing ----------------------------------------------------------------------------------------------------------

MAPS = ("P2", "P3", "P5", "P6")
#: Parameters at which windows are arcs, everything, all but one phase, empty; k v = B0 Omega; no
#: spring; no drive.
WINDOWS: dict[str, dict[str, Any]] = {
    "of fig9": {},
    "at equality": {"v1": "-3", "v2": "3", "Omega": "1", "k": "4", "B0": "-12"},
    "beyond the belts": {"v1": "-25", "v2": "-20", "B0": "7"},
    "with belts at rest": {"v1": "0", "v2": "1"},
    "without a drive": {"B0": "0", "v1": "-1"},
    "without a spring": {
        "k": "0",
        "A0": "0",
        "mu1": "0",
        "mu2": "0",
        "v1": "3",
        "v2": "4",
        "B0": "6",
        "c": "1",
    },
    "without a spring, damped": {"k": "0", "c": "90"},
}


EQUAL = WINDOWS["at equality"]


def windows(changes: Any, *maps: str, order: Any = "full", **how: Any) -> Figure:
    p = P.replace(**changes)
    return plot.window_figure(
        [grazing_window(p, mapping, order) for mapping in maps or MAPS], **how
    )


def plane_of(axes: Any, window: symosc.GrazingWindow) -> None:
    draw_plane(axes, grazing_curve(window.parameters, window.mapping, 30))


def curves(changes: Any, mapping: str) -> Figure:
    return plot.figure_grazing_curve(grazing_curve(P.replace(**changes), mapping, 30))


def against(mapping: str, name: str, *limits: Any, **changes: Any) -> str:
    drawn = plot.sweep_figure(P.replace(**changes), mapping, name, *limits)
    if name == "Omega":
        return full(drawn)
    return drawn_in(drawn)


def region(
    mapping: str, names: Any, phase: Any, *ranges: Any, order: Any = "full", **changes: Any
) -> str:
    """Return the picture of a region, of its filled areas how much they cover and where."""
    p = P.replace(**changes)
    if phase == "empty":
        found = symosc.values_empty(p, mapping, names)
    elif phase == "everything":
        found = symosc.values_everything(p, mapping, names, order)
    else:
        found = symosc.values_containing(p, mapping, names, phase, order)
    assert isinstance(found, symosc.ParameterRegion)
    return (full if phase == "pi" else drawn_in)(plot.region_figure(found, *ranges))


GRAZING: dict[str, Case] = {
    **{
        f"windows {name}": partial(windows, changes, *MAPS[i % 2 :: 2][:1])
        for i, (name, changes) in enumerate(WINDOWS.items())
        if changes != EQUAL
    },
    "a window and its look": lambda: full(windows({}, "P2", plane=plane_of)),
    "a window at equality": lambda: full(windows(EQUAL, "P2", "P3", order="paper")),
    "a window into axes": lambda: own(grazing_window(P, "P3").plot),
    "its contacts": lambda: windows({}, "P2", panels="b"),
    "against Omega": lambda: against("P2", "Omega"),
    "against B0": lambda: against("P2", "B0"),
    "against k": lambda: against("P3", "k"),
    "against v1": lambda: against("P3", "v1"),
    "against v2": lambda: against("P6", "v2", B0=-30),
    "against v2 near its start": lambda: against("P5", "v2", "24.9", "80"),
    "against v1 near its end": lambda: against("P2", "v1", -2, "1.01"),
    "against Omega, far away": lambda: against("P2", "Omega", "0.1", "0.2"),
    "against k, without a drive": lambda: against("P5", "k", B0=0),
    "against v1, at rest": lambda: against("P2", "v1", v1=0, v2=1, B0=0),
    "against Omega into axes": lambda: own(
        partial(plot.sweep_figure, P, "P5", "Omega", 1, 4, "paper")
    ),
    "a grazing curve": lambda: curves({}, "P2"),
    "a grazing curve through 0": lambda: curves({}, "P3"),
    "a grazing curve of all phases": lambda: curves({}, "P5"),
    "no grazing curve": lambda: full(curves({}, "P6")),
    "a grazing curve with gaps": lambda: curves({"c": "0", "Omega": "1/2", "v1": "-1"}, "P2"),
    "a grazing curve into axes": lambda: own(grazing_curve(P, "P2", 30).plot),
    "a region": lambda: region("P2", ("Omega", "k"), "7*pi/6"),
    "a region of belts": lambda: region("P3", ("v1", "Omega"), ("pi", "3*pi/2")),
    "a region where its border counts": lambda: region(
        "P2", ("Omega", "v1"), "3*pi/2", (0, 3), (-10, 10)
    ),
    "a region with what is not allowed": lambda: region("P5", ("v2", "B0"), "pi", v1=-2, v2=3),
    "an empty region": lambda: region("P2", ("Omega", "k"), "3*pi/2", (1, 2), (0, 1), v1=-1),
    "where it is empty": lambda: region("P3", ("B0", "k"), "empty"),
    "where it is everything": lambda: region("P2", ("B0", "v1"), "everything", order="paper"),
}


# -- notebook pages ---------------------------------------------------------------------------------------------------


def page(shown: Any) -> str:
    """Return a page with each row of its tables in a line, without styles.

    Of its curves the sums of coordinates.
    """
    text = str(shown._repr_html_())
    text = re.sub(r' style="[^"]*"', "", text)
    text = re.sub(r'd="(M[^"]*)"', lambda found: f"d={coordinates(found[1])}", text)
    return text.replace("<tr>", "\n<tr>").replace("<svg", "\n<svg").replace("</td><td>", " | ")


def coordinates(path: str) -> str:
    places = np.array([float(each) for each in re.findall(r"[-\d.]+", path)])
    places = places * np.cos(np.arange(len(places)))
    return f"{path.count('M')} {path.count('L')} {places.sum():.1f}"


def equalities() -> list[bool]:
    """Return whether pairs of values, and of answers that have them, are equal."""

    @dataclass(eq=False)
    class Answer(Comparable):
        value: Any
        other: int = 0
        _hidden: int = 0

    nan, array = float("nan"), np.array([1.0, np.nan])
    pairs = [
        (1, 1),
        (1, 2),
        ((nan,), (nan,)),
        ((nan,), (1.0,)),
        (array, array.copy()),
        (array, array + 1),
    ]
    pairs += [
        (np.array(["a"]), np.array(["a"])),
        (np.array(["a"]), np.array(["b"])),
        (array, array[:1]),
    ]
    found = [Answer(one, 0, i) == Answer(other) for i, (one, other) in enumerate(pairs)]
    return [*found, Answer(1) == 1, Answer(1) != Answer(2), Answer(1, 2) == Answer(1, 3)]


def scene_of_a_model() -> Scene:
    model = OtherModel(m=1, k=1, Omega=1, FN=1, Y="5/3", joined=True)
    return Scene(
        "mine",
        model,
        t0=0,
        x0=1,
        v0=0,
        t_end=9,
        source="a note " * 12,
        start_error=(0, "1e-9", "2e-9"),
    )


LONG = Certificate(
    "trajectory",
    True,
    "12 events",
    tuple((*ENCLOSED.events[i % 2],) for i in range(12)),
    stable=False,
)
PAGES: dict[str, Case] = {
    **{
        f"page of {kind}": lambda kind=kind: page(answer(kind))
        for kind in MAKERS
        if kind != "failed check"
    },  # type: ignore[misc]
    "page of a wrong check": lambda: some_lines(page(wrong()), 0, 8),
    "page of a long motion": lambda: some_lines(page(simulate("fig9", t_end="40T")), 11),
    "page of a scene of another model": lambda: page(scene_of_a_model()),
    "page of events": lambda: page(simulate("fig9", t_end="12T").events),
    "equal answers": equalities,
    "listings": lambda: [repr(Listing(range(count))) for count in (0, 1, 10, 11, 1234)],
    "page of many words": lambda: page(
        symosc.Summary(word=np.array([f"P{n * n % 15}" * 22 for n in range(30)]))
    ),
    "page of a response": lambda: page(response()),
    "page of an atlas": lambda: page(plane(True)),
    "page of another window": lambda: page(grazing_window(P, "P3")),
    "page of a border with a fold": lambda: page(borders()[0]),
    "page of a border with no word": lambda: page(borders()[1]),
    "page of an unstable branch": lambda: page(unstable()),
    "page of an orbit between both belts": lambda: page(both_belts()),
    "page of an enclosed orbit": lambda: page(ENCLOSED),
    "page of a long certificate": lambda: page(LONG),
}


# -- the explorer -----------------------------------------------------------------------------------------------------


def explored(state: dict[str, str] | str, **changes: str) -> Any:
    """Return the answer of the page for a link, with arrays in place of long lists."""
    if isinstance(state, str):
        link = state
    else:
        link = explorer.link_of(state | changes)
    return arrays(explorer.answer(link, FIG5))


def arrays(part: Any) -> Any:
    if isinstance(part, dict):
        return {name: arrays(each) for name, each in part.items()}
    if isinstance(part, list) and len(part) > 40 and isinstance(part[0], float):
        return np.array(part, float)
    return part


def of_scene(name: str, **changes: str) -> Any:
    return explored(explorer.state_of(load_scene(name)), **changes)


def settled(link: str) -> Any:
    """Return the text, and what the curve reaches.

    It ends at an event, so that its last points are rounding.
    """
    found = explorer.settled(link, FIG5)
    return [
        found["text"],
        *([name, min(each), max(each), each[0]] for name, each in found["curve"].items()),
    ]


def belts_of(**changes: str) -> Any:
    found = of_scene("fig5", **changes)
    return {name: found[name] for name in ("belts", "ranges", "windows", "name")}


EXPLORED: dict[str, Case] = {
    "explored fig5": lambda: of_scene("fig5", periods="1.5"),
    "explored fig6, from a stick": lambda: of_scene("fig6", periods="0.3"),
    "explored fig9, both belts far": lambda: of_scene("fig9", periods="1.5"),
    "explored fig8-exact": lambda: of_scene("fig8-exact", periods="1"),
    "explored belts near each other": lambda: belts_of(v1="1", v2="1.1", periods="0.5"),
    "explored belts far above": lambda: belts_of(v1="40", v2="41", periods="0.3"),
    "explored belts far below": lambda: belts_of(v1="-41", v2="-40", periods="0.3"),
    "explored belts on both sides": lambda: belts_of(v1="-41", v2="40", periods="0.3"),
    "explored at rest": lambda: of_scene(
        "fig5", B0="0", A0="0", x0="0", v0="0", v1="-1", v2="1", mu1="0", mu2="0"
    ),
    "explored, too many events": lambda: {
        name: part
        for name, part in of_scene("fig9", periods="100").items()
        if name in ("notes", "count", "message", "status", "ranges")
    },
    **{
        f"explored at random {i}": lambda i=i: explored(random_state(random.Random(i)), periods="2")
        for i in (4,)
    },  # type: ignore[misc]
    "explored, wrong texts": lambda: explored("k=abc&v1=9&v2=8&m=0&FN=1/0&periods=101&bogus=1"),
    "explored, another unit": lambda: pytest.importorskip("pint") and explored("k=3s"),
    "explored, no periods": lambda: of_scene("fig5", periods="0"),
    "explored, a part": lambda: list(
        explorer.read_link("k=4%2F5&velocity=3&t0=1", load_scene("fig9-orbit"))
    ),
    "scenes of texts": lambda: [
        [scene and (scene.name, scene.source, str(scene.t_end)), errors]
        for scene, errors in (
            explorer.scene_of(explorer.state_of(FIG5) | changes)
            for changes in (
                {},
                {"k": "5"},
                {"scene": " mine "},
                {"scene": ""},
                {"periods": "1/3"},
                {"periods": "1e-9"},
            )
        )
    ],
    "fields": lambda: {
        name: [tuple(field) for field in group] for name, group in explorer.GROUPS.items()
    },
    "settled": lambda: settled("scene=fig9"),
    "settled, no orbit": lambda: explorer.settled("scene=fig7&FN=0&B0=0", FIG5),
    "plots of the page": lambda: plots_of_the_page(),
    "requests of the page": lambda: requests(),
}


def requests() -> str:
    """Return how the server answers: the status, some headers, and how the text begins."""
    pytest.importorskip("bokeh")
    from http import HTTPStatus
    from http.server import BaseHTTPRequestHandler

    from exploring import ask, served

    lines = []
    with (
        patch.object(BaseHTTPRequestHandler, "error_message_format", "%(explain)s"),
        served("fig9") as address,
    ):
        for line in REQUESTS.splitlines():
            method, target, *given = line.split()
            if method == "POST":
                body = given[0]
            else:
                body = None
            headers = dict(each.split("=") for each in given[1:])
            answered, text = ask(address, target, body, **headers)
            # Python's words
            if text == HTTPStatus(answered.status).description:
                text = ""
            kept = {
                name: each for name, each in answered.headers.items() if name.startswith(("C", "X"))
            }
            if "bokeh" in target:
                text = ""
            elif target == "/":
                text = text[-8:]
            else:
                text = text[:300].partition("body")[2] or text[:90]
            for name in ("Content-Length", "Content-Security-Policy")[: 1 + bool(lines)]:
                kept.pop(name, None)
            lines.append(f"{line}: {answered.status} {kept} {' '.join(text.split())}")
    return "\n".join(lines)


REQUESTS = """GET /
GET /page.css
GET /page.js
GET /bokeh.js
GET /none
GET /scene.toml?k=2
GET /scene.toml?k=x
GET /settled?k=x
GET /answer - Host=example.org
GET /answer?k=x - Sec-Fetch-Site=cross-site
GET /answer?k=x - Sec-Fetch-Site=cross-site Sec-Fetch-Mode=navigate
GET /answer?k=x - Sec-Fetch-Site=same-origin
POST /scene nothing
POST /none nothing
POST /scene nothing Host=example.org
POST /scene nothing Content-Length=x
POST /scene nothing Content-Length=100001
POST /scene nothing Content-Length=9999999"""


def plots_of_the_page() -> str:
    """Return the models of the plots with the properties that are set, and how many are alike."""
    pytest.importorskip("bokeh")
    from symosc.plot.explorer.server import pictures

    found = Counter[str]()
    seen = set[str]()

    def follow(value: Any) -> str:
        if isinstance(value, (list, tuple)):
            return f"[{' '.join(map(follow, value))}]"
        if not hasattr(value, "properties_with_values"):
            return str(value)
        kind = type(value).__name__
        name = value.name or ""
        if value.id not in seen:
            seen.add(value.id)
            parts = value.properties_with_values(include_defaults=False)
            parts = {
                part: parts[part]
                for part in sorted(parts)
                if not re.search(
                    "^id$|sort_by|select|hover_|muted|view|formatter|policy|_source$", part
                )
            }
            texts = " ".join(
                f"{part}={follow(each)}" for part, each in parts.items() if part != "renderers"
            )
            follow(parts.get("renderers", ()))
            found[f"{kind} {texts}"] += bool(texts)
        return name or kind

    for drawn in pictures().values():
        follow(drawn)
    lines = "\n".join(f"{count} {text}" for text, count in found.items() if count)
    return re.sub(
        r"(?:Field|Value)\(\w+=(.*?), transform=Unspecified, units=Unspecified\)", r"\1", lines
    )


def shortened(make: Case) -> str:
    """Return the lines of a case, long numbers with seven digits, zeros without their noise."""
    lines = re.sub(r"np\.float64\((.*?)\)", r"\1", "\n".join(lines_of(make())))
    lines = re.sub(
        r"(?m)^( *line .*) \S+( \S+) \S+$", r"\1\2", lines
    )  # without the second place and the last one
    return re.sub(
        r"-?\d+\.\d{5,}(e[+-]\d+)?|-?\d(\.\d+)?e-1\d",
        lambda found: f"{round(float(found[0]), 12):.7g}",
        lines,
    )


ALL = MOTIONS | BRANCHES | JUDGED | SWEEPS | GRAZING | PAGES | EXPLORED
CASES: dict[str, Case] = {name: partial(shortened, make) for name, make in ALL.items()}
