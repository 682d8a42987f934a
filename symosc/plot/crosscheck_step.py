"""One step of a cross-check as a picture: the exact motion from a sample on, the next samples, and the events."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.arguments import public
from symosc.crosschecks.report import CrossCheck
from symosc.exact import whole_number
from symosc.plot.crosscheck import POSITION, VELOCITY, WRONG
from symosc.plot.drawing import Drawing, figure_of, read_panels, style_for
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

# Samples on both sides of a step, and points of the exact motion.
SAMPLES_BESIDE, POINTS_OF_EXACT = 3, 400


@public
def step_figure(
    check: CrossCheck, step: int | None = None, panels: str | None = None, *, ax: Axes | None = None
) -> Figure:
    """Draw one step of a cross-check: the exact motion from its first sample on, and the samples about it.

    Parameters
    ----------
    check : CrossCheck
    step : int, optional
        From sample `step` to the next one. Default: the first wrong step, or the first step if none is wrong.
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a velocity, b position. Default: both, with `ax` a.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If that is no CrossCheck, or there is no such step or panel.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, plot, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> v[100] += 0.1
    >>> drawing = plot.step_figure(crosscheck("fig5", t, x, v))
    >>> [axes.get_ylabel() for axes in drawing.axes]
    ['$v$', '$x$']
    """
    panels = read_panels(panels, ("a", "b"), ax)
    if step is None:
        step = check.first_wrong.step if check.first_wrong else 0
    step = whole_number("step", step, 0, len(check.t) - 2)
    motion = _exact(check, step)
    if ax is not None:
        drawing = figure_of(ax)
        _panel(ax, check, step, motion, panels)
        ax.legend()
        return drawing
    with style_for(ax):
        drawing = Drawing(figsize=(4.6, 1.0 + 1.9 * len(panels)), layout="constrained")
        axes = drawing.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        for each, letter in zip(axes, panels, strict=True):
            _panel(each, check, step, motion, letter)
        axes[-1].set_xlabel("$t$")
        drawing.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False)
    return drawing


def _exact(check: CrossCheck, step: int) -> Trajectory | None:
    """Return the exact motion from the step's first sample over the step; None where the step has no length."""
    begin, end = float(check.t[step]), float(check.t[step + 1])
    if not end > begin:
        return None
    x0, v0 = float(check.x[step]), float(check.v[step])
    return simulate(check.trajectory.parameters, t0=begin, x0=x0, v0=v0, t_end=end)


def _panel(ax: Axes, check: CrossCheck, step: int, motion: Trajectory | None, letter: str) -> None:
    row, values, name, color = (1, check.v, "$v$", VELOCITY) if letter == "a" else (0, check.x, "$x$", POSITION)
    around = slice(max(0, step - SAMPLES_BESIDE), step + 2 + SAMPLES_BESIDE)
    shown = values[around]
    if motion is not None:
        t = np.linspace(float(motion.t_start), float(motion.t_end), POINTS_OF_EXACT)
        exact = motion(t)[row]
        shown = np.append(shown, exact)
        ax.plot(t, exact, color=color, lw=1.4, label="exact, from the sample before")
        ax.plot(t[-1:], exact[-1:], "o", ms=5, mfc="white", mec=color, label="exact, where the next sample should be")
    ax.plot(check.t[around], values[around], ":", color="0.45", lw=0.9)
    ax.plot(check.t[around], values[around], ".", color="black", ms=6, label="given")
    ax.plot(check.t[step + 1], values[step + 1], "x", color=WRONG, ms=7, mew=1.6, label="given, end of this step")
    margin = 0.08 * (float(np.ptp(shown)) or 1.0)
    low, high = float(np.min(shown)) - margin, float(np.max(shown)) + margin
    if letter == "a":
        for boundary in (1, 2):
            speed = float(check.trajectory.parameters.belt(boundary))
            if low < speed < high:
                ax.axhline(speed, color="0.25", lw=0.7, ls=(0, (5, 2)), zorder=0)
                ax.text(1.0, speed, f" $v_{boundary}$", transform=ax.get_yaxis_transform(), va="center")
    for number, event in enumerate(motion.events[:4] if motion is not None else ()):
        ax.axvline(float(event.t), color="0.6", lw=0.9, zorder=0, label="" if number else "exact event")
        if letter == "a":
            ax.text(float(event.t), 1.0, event.kind, transform=ax.get_xaxis_transform(), ha="center", va="bottom")
    ax.set_ylim(low, high)
    ax.set_ylabel(name)
