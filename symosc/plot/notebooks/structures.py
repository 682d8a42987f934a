"""Pages of what has a structure of its own: periodic orbits, their branches, grazing windows."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

import numpy as np
from markupsafe import Markup

from symosc.display.html import MOST_POINTS, PICTURE_HEIGHT, curve, ends, facts, page, picture, shown, table
from symosc.grazing.window import GrazingWindow
from symosc.orbits.branch import Branch
from symosc.orbits.periodic_orbit import PeriodicOrbit

RADIUS, RING = 42.0, 10.0


def orbit_page(orbit: PeriodicOrbit) -> str:
    """Return the page of a periodic orbit: its switching points, its multipliers, and its loop in the phase plane."""
    rows = [[label, shown(float(t)), shown(float(x))] for label, (t, x) in zip(orbit.labels, orbit.points, strict=True)]
    begin = float(orbit.points[0].t)
    x, v = orbit(np.linspace(begin, begin + float(orbit.period), MOST_POINTS))
    dots = [(float(point.x), float(speed)) for point, speed in zip(orbit.points, _speeds(orbit), strict=True)]
    loop = curve("phase plane: v against x over one period", x, v, dots)
    values = {
        "period": shown(float(orbit.period)),
        "multipliers": ", ".join(complex_text(complex(value)) for value in orbit.multipliers),
        "stable": {True: "yes", False: "no", None: "marginal"}[orbit.stable],
        "residual": f"{float(orbit.residual):.1e}",
        "grazing distance": f"{orbit.grazing_distance:.4g}",
        "digits": orbit.digits,
    }
    heads = ("mapping from", "t", "x")
    return page("PeriodicOrbit", f"{orbit.word}: {orbit.message}", table(heads, rows), loop, facts(values))


def _speeds(orbit: PeriodicOrbit) -> list[float]:
    return [float(orbit.parameters.belt(piece.start)) for piece in orbit.equations().pieces]


def complex_text(value: complex) -> str:
    """Return a complex number with six digits, a real one as such."""
    if value.imag == 0:
        return f"{value.real:.6g}"
    return f"{value.real:.6g} {'-' if value.imag < 0 else '+'} {abs(value.imag):.6g} i"


def branch_page(branch: Branch) -> str:
    """Return the page of a branch: some of its points, why it ends, and where its first switching is."""
    rows = [_point(branch, i) for i in ends(len(branch.values))]
    x = branch.points[:, 0, 1]
    marks = [(float(branch.values[i]), float(x[i])) for i in (0, -1)]
    drawn = curve(f"x of the first switching against {branch.parameter}", branch.values, x, marks)
    reasons = {
        f"{side} end": f"{end.kind} at {branch.parameter} = {end.value:.10g}: {end.message}"
        for side, end in zip(("first", "last"), branch.ends, strict=True)
    }
    line = f"{branch.word} in {branch.parameter}, {len(branch.values)} points"
    heads = (branch.parameter, "t", "x", "largest |multiplier|", "stable")
    return page("Branch", line, table(heads, rows, len(branch.values)), drawn, facts(reasons))


def _point(branch: Branch, i: int) -> list[Any]:
    largest = float(np.abs(branch.multipliers[i]).max())
    return [branch.values[i], *branch.points[i, 0], f"{largest:.6g}", "yes" if branch.stable[i] else "no"]


def window_page(window: GrazingWindow) -> str:
    """Return the page of a grazing window: its intervals, its case, and the phases as a dial."""
    place = window.place
    rows = [
        ["[" if low_closed else "(", low, high, "]" if high_closed else ")"]
        for low, high, low_closed, high_closed in window.intervals
    ]
    about = facts(
        {
            "case": window.case,
            "γ": str(window.gamma),
            "B₀Ω/m": str(window.amplitude),
            "order": window.order,
        }
    )
    line = f"{window.mapping}: domain {place.domain} at belt {place.boundary}, Ω t mod 2π" + (
        "" if rows else ": empty, no phase grazes"
    )
    intervals = table(("", "from", "to", ""), rows) if rows else ""
    return page("GrazingWindow", line, intervals, _dial(window), about)


def _dial(window: GrazingWindow) -> Markup:
    """Return the phases as a ring, 0 at the right and going round against the clock; the window's part is thick."""
    ring = Markup('<circle cx="0" cy="0" r="{}" fill="none" stroke="currentColor" stroke-opacity="0.4"/>')
    arcs = [_arc(low, high) for low, high, *_ in window.intervals]
    names = [
        Markup(
            '<text x="{:.1f}" y="{:.1f}" font-size="10" fill="currentColor" text-anchor="middle" '
            'dominant-baseline="central">{}</text>'
        ).format(56 * cos(angle), -56 * sin(angle), name)
        for angle, name in ((0, "0"), (pi / 2, "π/2"), (pi, "π"), (3 * pi / 2, "3π/2"))
    ]
    inside = Markup("").join([ring.format(RADIUS), *arcs, *names])
    said = " and ".join(f"{low:.4g} to {high:.4g}" for low, high, *_ in window.intervals) or "none"
    moved = Markup('<g transform="translate({} {})">{}</g>').format(PICTURE_HEIGHT / 2, PICTURE_HEIGHT / 2, inside)
    return picture(f"phases that graze: {said}", moved, PICTURE_HEIGHT, PICTURE_HEIGHT)


def _arc(low: float, high: float) -> Markup:
    angles = np.linspace(low, high, max(2, int(40 * (high - low))))
    points = " ".join(f"{RADIUS * cos(angle):.1f},{-RADIUS * sin(angle):.1f}" for angle in angles)
    line = '<polyline points="{}" fill="none" stroke="#1f3fd6" stroke-width="{}"/>'
    return Markup(line).format(points, RING)
