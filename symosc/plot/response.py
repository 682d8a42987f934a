"""The figure of a frequency response."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import inf, pi
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.aliases import Record
from symosc.arguments import public
from symosc.plot.drawing import PARAMETER_LABELS, add_legend, axes_for, legend_entries, read_panels, typeset
from symosc.response import FrequencyResponse

EXACT, BALANCE, DAMPER, FRICTION = "black", "#d55e00", "#0072b2", "#cc79a7"
#: How much higher than all but the highest twentieth of a resonance a panel is.
HIGHEST = 4.0


@public
def response_figure(found: FrequencyResponse, panels: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a frequency response; the words stand above the first panel, and lines mark where they change.

    Parameters
    ----------
    found : FrequencyResponse
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a amplitude, with that of harmonic balance, b transmissibility, c
        phase, d energies per cycle, e share of the time stuck, f error of harmonic balance. Default: all, with `ax` a.

    Examples
    --------
    >>> from symosc import frequency_response, plot
    >>> found = frequency_response("fig9", {"Omega": "3:5:9"})
    >>> [axes.get_ylabel() for axes in plot.response_figure(found, "ac").axes]
    ['amplitude', 'phase behind the excitation']
    """
    panels = read_panels(panels, PANELS, ax)
    columns = 1 if ax is not None else min(len(panels), 2)
    size = (3.5 * columns, 0.5 + 2.1 * -(-len(panels) // columns))
    with axes_for(ax, size, panels, columns=columns, letter_at=-0.12) as (drawing, row):
        for axes, letter in zip(row, panels, strict=True):
            PANELS[letter](axes, found)
            _mark_changes(axes, found, named=axes is row[0])
            axes.set_xlim(found.values.min(), found.values.max())
        for axes in row[-columns:]:
            axes.set_xlabel(PARAMETER_LABELS[found.name])
        style: Record = {"handlelength": 1.8, "columnspacing": 1.4, "borderpad": 0.1}
        add_legend(drawing, ax, legend_entries(row), 5, **style)
    return drawing


def _curve(axes: Axes, found: FrequencyResponse, column: np.ndarray, color: str = EXACT, **style: Any) -> None:
    """Draw a column over the parameter, in its order, with gaps where the column is infinite."""
    order = np.argsort(found.values)
    shown = np.where(np.isfinite(column), column, np.nan)
    axes.plot(found.values[order], shown[order], color=color, lw=1.2, **style)


def _start_at_zero(axes: Axes, column: np.ndarray) -> None:
    """Let the vertical axis begin at 0, and cut off a resonance that would make all else look flat."""
    known = column[np.isfinite(column)]
    if len(known):
        top = min(float(known.max()), HIGHEST * float(np.quantile(known, 0.8))) or float(known.max()) or 1.0
        axes.set_ylim(0, 1.08 * top)


def _amplitude(axes: Axes, found: FrequencyResponse) -> None:
    _curve(axes, found, found.amplitude, label="exact")
    _curve(axes, found, found.balance, BALANCE, ls=(0, (4, 2)), label="harmonic balance")
    axes.set_ylabel("amplitude")
    _start_at_zero(axes, found.amplitude)


def _transmissibility(axes: Axes, found: FrequencyResponse) -> None:
    _curve(axes, found, found.transmissibility)
    axes.axhline(1, color="0.6", lw=0.6, zorder=0)
    axes.set_ylabel("transmissibility")
    _start_at_zero(axes, found.transmissibility)


def _phase(axes: Axes, found: FrequencyResponse) -> None:
    _curve(axes, found, np.where(found.phase < -pi / 2, found.phase + 2 * pi, found.phase))
    axes.set_yticks([0, pi / 2, pi], ["0", r"$\pi/2$", r"$\pi$"])
    axes.set_ylabel("phase behind the excitation")


def _energy(axes: Axes, found: FrequencyResponse) -> None:
    _curve(axes, found, found.dissipated)
    _curve(axes, found, found.damper, DAMPER, ls="-.", label="in the damper")
    _curve(axes, found, found.friction, FRICTION, ls=(0, (1, 1)), label="in friction")
    axes.set_ylabel("energy per cycle")
    _start_at_zero(axes, found.dissipated)


def _stuck(axes: Axes, found: FrequencyResponse) -> None:
    _curve(axes, found, found.stuck)
    axes.set(ylim=(-0.02, 1.02), ylabel="share of time stuck")


def _error(axes: Axes, found: FrequencyResponse) -> None:
    _curve(axes, found, 100 * found.balance_error, BALANCE)
    axes.axhline(0, color="0.6", lw=0.6, zorder=0)
    axes.set_ylabel("error of harmonic balance in %")


PANELS: dict[str, Callable[[Axes, FrequencyResponse], None]] = dict(
    zip("abcdef", (_amplitude, _transmissibility, _phase, _energy, _stuck, _error), strict=True)
)


def _mark_changes(axes: Axes, found: FrequencyResponse, named: bool) -> None:
    """Mark where the word changes, halfway between two values, and if `named` write the words above the panel."""
    order = np.argsort(found.values)
    words = [_cyclic_word(found.word[i]) or ("rest" if found.status[i] == "rest" else "") for i in order]
    values, last = found.values[order], -inf
    cuts = [0, *(i for i in range(1, len(values)) if words[i] != words[i - 1]), len(values)]
    for i in cuts[1:-1]:
        axes.axvline((values[i - 1] + values[i]) / 2, color="0.75", lw=0.6, zorder=0)
    style: Record = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points", "fontsize": 8}
    for begin, end in pairwise(cuts) if named else ():
        name, middle = words[begin], (values[begin] + values[end - 1]) / 2
        if name and middle - last > 0.12 * (values[-1] - values[0]) and (end - begin) * 12 > len(values):
            axes.annotate(typeset(name), (middle, 1), (0, 4), ha="center", **style)
            last = middle


def _cyclic_word(word: str) -> str:
    """Return the same word for all words of one cycle of mappings, whichever mapping they begin with."""
    letters = word.removeprefix("P")
    return "P" + max(letters[i:] + letters[:i] for i in range(len(letters))) if letters else ""
