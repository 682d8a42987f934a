"""The figures of docs/literature.md: formulas as lines, runs of symosc as points.

`python docs/literature/figures.py` draws all anew; names of files after it, only these.
"""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Iterable
from fractions import Fraction
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import andronov_vitt_khaikin as belt_cycle
import bossolini_brons_kristiansen as bossolini
import csernak_licsko as chaos
import iklodi_dombovari as branch
import numpy as np
from marino_cicirello import inversion, transmissibility, transmissibility_by_running
from wall import Symmetric, find_border, wall

from symosc import Belt, Oscillator, find_orbit, simulate, simulate_many, sweep
from symosc.base.files import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FOLDER = Path(__file__).parent
#: Cells of maps, points of a curve, and the r at which symosc finds the border by running.
CELLS = (180, 120)
FINE = 120
RATIOS = (0.42, 0.6, 0.7, 0.8, 0.9, 1.1, 1.25, 1.5, 1.75)
#: The ground of names that stand on a map.
LABEL_GROUND: dict[str, Any] = {"facecolor": "1", "edgecolor": "none", "pad": 0.8, "alpha": 0.85}
#: The border of the symmetric motion is computed from this friction, on which it does not depend.
WEAK = 0


def curves() -> Figure:
    """Return the figure of the border and of the amplitude."""
    from matplotlib.figure import Figure

    fig = Figure(figsize=(7, 2.9), layout="constrained")
    left, right = fig.subplots(1, 2)
    for c, line, marker in (("0", "-", "o"), ("0.2", "--", "s")):
        grid = np.linspace(0.35, 2, FINE)
        border = [float(_largest(r, c)) for r in grid]
        left.plot(grid, border, line, color="0", lw=1.2, label=f"formula, $c = {c}$")
        points = [(r, _border_near(r, c)) for r in RATIOS]
        left.plot(*np.transpose(points), marker, color="0", mfc="1", ms=6, label=f"run, $c = {c}$")
    left.set(
        xlabel=r"$r = \Omega/\omega_0$",
        ylabel="$F/P$",
        title="No stops below the curve",
        xlim=(0.3, 2),
        ylim=(0, 1),
    )
    for F, line, marker in (("0.2", "-", "o"), ("0.5", "--", "s")):
        ratios = [r for r in np.linspace(0.45, 2, FINE) if _slides(r, F)]
        heights = [float(Symmetric(F, _short(r), "0.1").highest) for r in ratios]
        right.plot(ratios, heights, line, color="0", lw=1.2, label=f"formula, $F/P = {F}$")
        chosen = [r for r in (*RATIOS, 1.0) if _slides(r, F)]
        orbits = [find_orbit(wall(F, _short(r), "0.1"), "P32") for r in chosen]
        highest = [max(x for _, x in orbit.points) for orbit in orbits]
        right.plot(
            chosen, highest, marker, color="0", mfc="1", ms=6, label=f"$P_{{32}}$, $F/P = {F}$"
        )
    right.set(
        xlabel=r"$r = \Omega/\omega_0$",
        ylabel=r"$x_0\, k/P$",
        title="Amplitude, $c = 0.1$",
        xlim=(0.4, 2),
        ylim=(0, None),
    )
    for axes in (left, right):
        axes.legend(fontsize=8, frameon=False)
        axes.spines[["top", "right"]].set_visible(False)
    return fig


def maps() -> Figure:
    """Return the figures of other papers, drawn anew."""
    from matplotlib.figure import Figure

    fig = Figure(figsize=(7, 6), layout="constrained")
    (counts, borders), (gains, cycles) = fig.subplots(2, 2)
    Omegas = np.geomspace(0.03, 2, CELLS[0])
    forces = np.linspace(0.005, 0.995, CELLS[1])
    shown = counts.pcolormesh(Omegas, forces, _stops(Omegas, forces).T, **_greys(), rasterized=True)
    counts.set(
        xscale="log",
        xlabel=r"$r = \Omega/\omega_0$",
        ylabel="$F/P$",
        title="Stops per cycle, $c = 0$\n(white: not settled in 100 periods)",
    )
    fig.colorbar(shown, ax=counts, ticks=range(0, 17, 2))
    inverse = np.linspace(0.5, 7, CELLS[0])
    weak = np.linspace(0.002, 0.6, CELLS[1])
    borders.pcolormesh(
        inverse, weak, _stops(1 / inverse, weak).T, **_greys(), alpha=0.5, rasterized=True
    )
    grid = [
        value for value in np.linspace(0.52, 6.98, 2 * FINE) if abs(value - round(value)) > 0.01
    ]
    motions = [Symmetric(WEAK, _short(1 / value)) for value in grid]
    ends = np.array([float(motion.largest_force_ratio()) for motion in motions])
    turning = np.array([motion.largest_slide_bound()[1] == 0 for motion in motions])
    for name, line, where in (
        ("crossing-sliding", "-", turning),
        ("grazing-sliding", "--", ~turning),
    ):
        borders.plot(grid, np.where(where, ends, np.nan), line, color="0", lw=1.4, label=name)
    for n in (1, 2, 3):
        for name, x, y in ((f"$A_{n}$", 2 * n, 1 / (4 * n * n - 1)), (f"$B_{n}$", 2 * n + 1, 0)):
            borders.plot(x, y, "o", color="0", mfc="1", ms=5, clip_on=False)
            # Above the curves: at B_n they form a V, and there is room in its middle.
            style = {"ha": "center", "va": "bottom", "zorder": 5, "bbox": LABEL_GROUND}
            borders.annotate(name, (x, y), (0, 9), textcoords="offset points", **style)
    borders.set(
        xlabel=r"$1/\Omega$",
        ylabel="$F$",
        title="Borders of motions without stops\n(greys: stops per cycle, as on the left)",
        xlim=(0.5, 7.2),
        ylim=(0, 0.6),
    )
    for F, line, marker in (("0.1", "-", "o"), ("0.5", "--", "s"), ("1", ":", "^")):
        ratios = [r for r in np.linspace(1.15, 2, 40) if float(_border_of_base(r)) > float(F)]
        heights = [float(transmissibility(F, _exact(r))) for r in ratios]
        gains.plot(ratios, heights, line, color="0", lw=1.2, label=f"$F/(kY) = {F}$")
        gains.plot(
            ratios[::6],
            [transmissibility_by_running(F, _exact(r)) for r in ratios[::6]],
            marker,
            color="0",
            mfc="1",
        )
        r = inversion(F, transmissibility)
        name = "inversion" if F == "1" else None
        gains.plot(r, 1 / (r * r - 1), "x", color="0", ms=9, mew=2, label=name)
    free = np.linspace(1.15, 2, 100)
    gains.plot(free, 1 / (free**2 - 1), color="0.6", lw=2, zorder=0, label="no friction")
    gains.set(
        xlabel=r"$r = \Omega/\omega_0$",
        ylabel="$X/Y$",
        title="Base and wall together",
        ylim=(0, 3.2),
    )
    for Omega, line in (("0.3", "-"), ("0.15", "--")):
        p = wall("0.5", Omega, "0.1")
        t = np.linspace(20, 21, 2000) * 2 * np.pi / float(p.Omega)
        cycles.plot(
            *simulate(p, t0=0, x0=0, v0=0, t_end="22T")(t),
            line,
            color="0",
            lw=1.2,
            label=rf"$\Omega = {Omega}$",
        )
    cycles.set(xlabel="$x$", ylabel=r"$\dot{x}$", title="$c = 0.1$, $F = 0.5$", ylim=(None, 0.72))
    cycles.legend(fontsize=8, frameon=False, loc="upper center", ncols=2)
    for axes in (borders, gains):
        axes.legend(fontsize=8, frameon=False)
    for axes in fig.axes:
        axes.spines[["top", "right"]].set_visible(False)
    return fig


def static() -> Figure:
    """Return the figures of static friction."""
    from matplotlib.figure import Figure

    fig = Figure(figsize=(7, 5.6), layout="constrained")
    (ends, diagram), (cycle, start) = fig.subplots(2, 2)
    Omegas = np.linspace(0.55, 1.4, 35)
    settled = [branch.settled(_short(Omega)) for Omega in Omegas]
    highest = np.array([summary.x_max[0] for summary in settled])
    stopping = np.array([summary.sticks[0] > 0 for summary in settled])
    for chosen, marker, label in ((~stopping, "o", "no stops"), (stopping, "s", "2 stops")):
        ends.plot(Omegas[chosen], highest[chosen], marker, color="0", mfc="1", ms=4, label=label)
    borders = [branch.end_of_branch(without) for without, _ in branch.ENCLOSED]
    lowest, largest = (float(border.Omega) for border in borders)
    grid = np.linspace(lowest, largest, FINE)
    heights = [float(Symmetric(1, _short(Omega), "0.1", "1.5").highest) for Omega in grid]
    ends.plot(grid, heights, color="0", lw=1.2, label="formula")
    for border in (lowest, largest):
        ends.axvline(border, color="0.6", lw=0.8, ls=":")
    ends.set(xlabel=r"$\Omega$", ylabel="largest $x$", title="$P = 1.5$, $F = 1$, static 1.1")
    S, _, Omega, _ = chaos.CHAOTIC[0]
    limits = np.linspace(0.5, 1, 161)
    period = 2 * np.pi / float(Omega)
    numbers = {
        name: float(value) for name, value in chaos.oscillator(S, "1", Omega).numbers().items()
    }
    sections = simulate_many(
        numbers | {"mu_s1": limits},
        (0, 0, 0),
        120 * period,
        # A picture of an attractor needs no exact motion on it.
        accuracy=inf,
        skip=70 * period,
        record=("section",),
        sections=50,
    ).section[:, :, 0]
    diagram.plot(np.repeat(limits, 50), sections.ravel(), ",", color="0", rasterized=True)
    diagram.axvline(float(chaos.CHAOTIC[0][1]), color="0.6", lw=0.8, ls=":")
    diagram.set(
        xlabel="$S_0$", ylabel="$x$ at whole periods", title=rf"$S = {S}$, $\Omega = {Omega}$"
    )
    for V, line in (("0.2", ":"), ("0.4", "--"), ("0.549", "-")):
        belt = Belt(V, mu=belt_cycle.KINETIC, mu_s=belt_cycle.STATIC)
        model = Oscillator(m=1, c=belt_cycle.DAMPING, k=1, belts=[belt])
        motion = simulate(model, v0=V, t_end=40)
        slips = [event.t for event in motion.events if event.kind == "slip"]
        t = np.linspace(slips[0], slips[1], 800)
        cycle.plot(*motion(t), line, color="0", lw=1.2, label=f"$V = {V}$")
    cycle.set(xlabel="$x$", ylabel=r"$\dot{x}$", title="On a belt, $c = 0.1$", ylim=(None, 1))
    begin = bossolini.X_0
    t = np.linspace(0, 9, 400)
    for moved, line, label in (
        (0, "-", "$x_0 = -1/2$"),
        (bossolini.HAIR, "--", r"$10^{-20}$ below"),
    ):
        start.plot(
            t, bossolini.from_rest(begin - moved)(t)[0], line, color="0", lw=1.2, label=label
        )
    start.set(xlabel="$t$", ylabel="$x$", title="Two motions of one law")
    for axes in (ends, cycle, start):
        axes.legend(fontsize=8, frameon=False, ncols=3 if axes is cycle else 1)
    for axes in fig.axes:
        axes.spines[["top", "right"]].set_visible(False)
    return fig


def _greys() -> dict[str, Any]:
    """Return a colour for each count, alternating so that neighbours differ."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    colors = ["0.97", "0.62", "0.85", "0.5", "0.78", "0.4", "0.7", "0.3", "0.15"]
    return {
        "cmap": ListedColormap(colors).with_extremes(bad="1"),
        "norm": BoundaryNorm(np.arange(-1, 18, 2), 9),
    }


def _stops(Omegas: Any, forces: Any) -> Any:
    """Return the stops per cycle of motions from rest after 100 periods, nan if not settled."""
    summary = sweep(
        wall("0.5", 1),
        {"Omega": Omegas, "mu1": forces},
        record=("sticks", "multiplicity"),
        t_end="120T",
        skip="100T",
    )
    return np.where(summary.multiplicity == 1, summary.sticks / 20, np.nan)


def _border_of_base(r: float) -> Any:
    """Return the largest F/(kY) without stops, c = 0."""
    return _largest(r, "0") * r * r


def _largest(r: float, c: str) -> Any:
    """Return the largest F/P without stops."""
    return Symmetric(WEAK, _short(r), c).largest_force_ratio()


def _short(r: float) -> str:
    return f"{r:.6g}"


def _exact(r: float) -> Fraction:
    return Fraction(_short(r))


def _border_near(r: float, c: str) -> float:
    """Return the border that is found by running between 0.98 and 1.02 times the formula's."""
    formula = Fraction(float(_largest(r, c)))
    return find_border(
        formula * Fraction(98, 100), formula * Fraction(102, 100), _short(r), c
    ).middle


def _slides(r: float, F: str) -> bool:
    """Return whether there is a motion without stops, c = 0.1."""
    return float(_largest(r, "0.1")) > float(F)


DRAWN = {"curves.svg": curves, "maps.svg": maps, "static.svg": static}


def write(names: Iterable[str]) -> None:
    """Draw figures by the names of their files."""
    from matplotlib import rc_context

    from symosc.plot.drawing import own_style

    for name in names:
        buffer = io.StringIO()
        with own_style(), rc_context({"svg.hashsalt": "symosc"}):
            DRAWN[name]().savefig(buffer, format="svg", dpi=120, metadata={"Date": None})
        print(write_text(FOLDER / name, re.sub(r"[ \t]+\n", "\n", buffer.getvalue())))


if __name__ == "__main__":
    write(sys.argv[1:] or DRAWN)
