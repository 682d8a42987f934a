"""Insets that magnify contacts too short to be seen. They stand above their axes, whose scale they leave alone."""

from __future__ import annotations

from math import floor, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from symosc.plot.panels import (
    BELT_COLOR,
    END_COLOR,
    MASS_COLOR,
    ONSET_COLOR,
    SHORT_STICK,
    SWITCH_COLOR,
    Contact,
    View,
    look,
)

# Height of the room above the axes, over the height of these with their labels.
ROOM = 0.66
# Bottom and height of an inset in it, and the top of what stands above it (fractions of the axes).
INSET_BOTTOM, HEIGHT, INSET_TOP = 1.16, 0.5, 1.97
# Left end and width, for one inset and for two.
BOXES = {1: ((0.2, 0.6),), 2: ((0.1, 0.36), (0.63, 0.36))}
TEXT: dict[str, Any] = {"fontsize": 7.5, "ha": "center", "va": "center"}
POINTS = 400


def draw_insets(ax: Axes, view: View) -> None:
    """Magnify what a view says into insets above axes, where there must be room for them."""
    for contact, (left, width) in zip(view.magnified, BOXES.get(len(view.magnified), ()), strict=True):
        _inset(ax, view, contact, (left, INSET_BOTTOM, width, HEIGHT))


def _inset(ax: Axes, view: View, contact: Contact, box: tuple[float, float, float, float]) -> None:
    since, until, belt = contact.since, contact.until, contact.belt
    speed = float(view.trajectory.parameters.belt(belt))
    length = until - since or SHORT_STICK * (view.t[-1] - view.t[0])
    times = np.linspace(max(since - length, view.t[0]), min(until + length, view.t[-1]), POINTS)
    times = np.union1d(times, [since, until])
    away = view.trajectory(times)[1] - speed
    shift, scale = floor(log10(length)), floor(log10(np.abs(away).max() or 1))
    inset = ax.inset_axes(box)
    inset.plot((times - since) / 10.0**shift, away / 10.0**scale, color=MASS_COLOR, lw=1.3)
    inset.axhline(0, color=BELT_COLOR, lw=0.6, zorder=3)
    stick = ((since, "onset of stick", ONSET_COLOR), (until, "end of stick", END_COLOR))
    for time, label, color in stick if until > since else ((since, "grazing point", SWITCH_COLOR),):
        inset.plot((time - since) / 10.0**shift, 0, linestyle="none", **look(label, color))
    if until > since:
        # Clear of the belt, between the branches of the curve.
        height = 0.7 if away.mean() > 0 else 0.3
        inset.text(0.53, height, f"length {_scientific(length)}", transform=inset.transAxes, **TEXT)
    inset.margins(x=0, y=0.2)
    # Ticks and label on top leave the way free for the leaders to the spot that is magnified.
    inset.xaxis.tick_top()
    inset.xaxis.set_label_position("top")
    inset.set_xlabel(f"{_power(-shift)}(t - {since:.6f})$", fontsize=TEXT["fontsize"], labelpad=2)
    inset.set_ylabel(f"{_power(-scale)}(\\dot{{x}} - v_{belt})$", fontsize=TEXT["fontsize"], labelpad=2)
    inset.tick_params(labelsize=7, labelfontfamily="STIXGeneral", pad=2)
    inset.set_in_layout(False)  # the grid keeps its room free
    for corner in (box[0], box[0] + box[2]):
        style = {"arrowstyle": "-", "color": "0.6", "lw": 0.5, "shrinkA": 0, "shrinkB": 3}
        ax.annotate("", (since, speed), (corner, box[1]), "data", "axes fraction", style, zorder=0)


def _power(exponent: int) -> str:
    return "$" if exponent == 0 else f"$10^{{{exponent}}}\\,"


def _scientific(value: float) -> str:
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"${mantissa}\\cdot 10^{{{int(exponent)}}}$"
