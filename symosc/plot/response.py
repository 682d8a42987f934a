"""The figure of a frequency response."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, pi

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.aliases import Record
from symosc.arguments import public
from symosc.plot.drawing import (
    PARAMETER_LABELS,
    Drawing,
    add_legend,
    figure_of,
    legend_entries,
    read_panels,
    style_for,
    typeset,
)
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
    order = np.argsort(found.values)
    with style_for(ax):
        if ax is None:
            columns = min(len(panels), 2)
            rows = -(-len(panels) // columns)
            drawing: Figure = Drawing(figsize=(3.5 * columns, 0.5 + 2.1 * rows), layout="constrained")
            all_axes = drawing.subplots(rows, columns, sharex=True, squeeze=False).ravel()
            for each in all_axes[len(panels) :]:
                each.remove()
            for each in all_axes[max(len(panels) - columns, 0) : len(panels)]:
                each.tick_params(labelbottom=True)
        else:
            drawing, all_axes = figure_of(ax), np.array([ax])
        row = all_axes[: len(panels)]
        for n, (axes, letter) in enumerate(zip(row, panels, strict=True)):
            PANELS[letter](axes, found, order)
            _changes(axes, found, order, named=n == 0)
            if len(panels) > 1:
                axes.set_title(f"({'abcdef'[n]})", loc="left", x=-0.12, pad=4)
            axes.set_xlim(found.values.min(), found.values.max())
            if n >= len(panels) - (1 if ax is not None else columns):
                axes.set_xlabel(PARAMETER_LABELS[found.name])
        style: Record = {"handlelength": 1.8, "columnspacing": 1.4, "borderpad": 0.1}
        add_legend(drawing, ax, legend_entries(row), 5, **style)
    return drawing


def _curve(axes: Axes, found: FrequencyResponse, order: np.ndarray, name: str, color: str, **style: object) -> None:
    """Draw a column; what is infinite is left out."""
    column = getattr(found, name)[order]
    axes.plot(found.values[order], np.where(np.isfinite(column), column, np.nan), color=color, lw=1.2, **style)  # type: ignore[arg-type]


def _amplitude(axes: Axes, found: FrequencyResponse, order: np.ndarray) -> None:
    _curve(axes, found, order, "amplitude", EXACT, label="exact")
    _curve(axes, found, order, "balance", BALANCE, ls=(0, (4, 2)), label="harmonic balance")
    axes.set_ylabel("amplitude")
    _from_zero(axes, found.amplitude)


def _transmissibility(axes: Axes, found: FrequencyResponse, order: np.ndarray) -> None:
    _curve(axes, found, order, "transmissibility", EXACT)
    axes.axhline(1, color="0.6", lw=0.6, zorder=0)
    axes.set_ylabel("transmissibility")
    _from_zero(axes, found.transmissibility)


def _phase(axes: Axes, found: FrequencyResponse, order: np.ndarray) -> None:
    phase = np.where(found.phase < -pi / 2, found.phase + 2 * pi, found.phase)[order]
    axes.plot(found.values[order], phase, color=EXACT, lw=1.2)
    axes.set_yticks([0, pi / 2, pi], ["0", r"$\pi/2$", r"$\pi$"])
    axes.set_ylabel("phase behind the excitation")


def _energy(axes: Axes, found: FrequencyResponse, order: np.ndarray) -> None:
    _curve(axes, found, order, "dissipated", EXACT)
    _curve(axes, found, order, "damper", DAMPER, ls="-.", label="in the damper")
    _curve(axes, found, order, "friction", FRICTION, ls=(0, (1, 1)), label="in friction")
    axes.set_ylabel("energy per cycle")
    _from_zero(axes, found.dissipated)


def _stuck(axes: Axes, found: FrequencyResponse, order: np.ndarray) -> None:
    _curve(axes, found, order, "stuck", EXACT)
    axes.set_ylim(-0.02, 1.02)
    axes.set_ylabel("share of time stuck")


def _error(axes: Axes, found: FrequencyResponse, order: np.ndarray) -> None:
    error = 100 * found.balance_error[order]
    axes.plot(found.values[order], np.where(np.isfinite(error), error, np.nan), color=BALANCE, lw=1.2)
    axes.axhline(0, color="0.6", lw=0.6, zorder=0)
    axes.set_ylabel("error of harmonic balance in %")


PANELS: dict[str, Callable[[Axes, FrequencyResponse, np.ndarray], None]] = {
    "a": _amplitude,
    "b": _transmissibility,
    "c": _phase,
    "d": _energy,
    "e": _stuck,
    "f": _error,
}


def _from_zero(axes: Axes, column: np.ndarray) -> None:
    """Let a panel begin at 0, and cut a resonance that would leave nothing of the rest to be seen."""
    known = column[np.isfinite(column)]
    if len(known):
        top = min(float(known.max()), HIGHEST * float(np.quantile(known, 0.8))) or float(known.max()) or 1.0
        axes.set_ylim(0, 1.08 * top)


def _changes(axes: Axes, found: FrequencyResponse, order: np.ndarray, named: bool) -> None:
    """Mark where the word changes, halfway between the two values, and name the words above the panel."""
    words = [_rotated(found.word[i]) or ("rest" if found.status[i] == "rest" else "") for i in order]
    values = found.values[order]
    cuts = [i for i in range(1, len(values)) if words[i] != words[i - 1]]
    for i in cuts:
        axes.axvline((values[i - 1] + values[i]) / 2, color="0.75", lw=0.6, zorder=0)
    if not named:
        return
    span, last = values[-1] - values[0], -inf
    for begin, end in zip([0, *cuts], [*cuts, len(values)], strict=True):
        middle = (values[begin] + values[end - 1]) / 2
        if words[begin] and middle - last > 0.12 * span and (end - begin) * 12 > len(values):
            name = words[begin]
            style: Record = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points", "fontsize": 8}
            axes.annotate(name if name == "rest" else typeset(name), (middle, 1), (0, 4), ha="center", **style)
            last = middle


def _rotated(word: str) -> str:
    """Return a word begun with the same mapping wherever it is begun."""
    letters = word.removeprefix("P")
    return "P" + max(letters[i:] + letters[:i] for i in range(len(letters))) if letters else ""
