"""The picture of scores: the largest error of each case in units, a mark per solver, and the cases that are wrong."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from symosc.aliases import Record
from symosc.arguments import public
from symosc.errors import ParameterError
from symosc.plot.drawing import STYLE, Drawing
from symosc.reference.score import CaseScore, Score, by_group

SOLVER_COLOURS = ("#2166ac", "#b2182b", "#1b7837", "#e08214", "#762a83", "#8c510a", "#4d4d4d", "#01665e")
SOLVER_MARKS = "os^DvPX*"
#: Errors below are drawn at the first, above at the second; where faults and missing results are; where it ends.
LEAST_UNITS, MOST_UNITS, FAULTY, ABSENT, TOP_OF_ALL = 1e-3, 1e10, 1e12, 1e14, 1e15
SCORE_WIDTH, SCORE_HEIGHT = 10.0, 4.2


@public
def score_figure(scores: Sequence[Score]) -> Figure:
    """Draw the scores of solvers on reference cases.

    Parameters
    ----------
    scores : sequence of Score
        Of the same cases; from `symosc.reference.score.score`.

    Returns
    -------
    matplotlib.figure.Figure
        A column per case, in groups. In the lower part the largest error in units of the problem's rounding; above,
        the cases with events missed, invented or of a wrong kind, or too large an error, and those without results.

    Examples
    --------
    >>> from symosc import plot, reference_cases
    >>> from symosc.reference.score import score
    >>> from symosc.reference.folder import stored
    >>> drawing = plot.score_figure([score("nobody", [stored(reference_cases()[1])], {})])
    >>> [label.get_text() for label in drawing.axes[0].get_xticklabels()]
    ['paper']
    """
    if not len(scores):
        raise ParameterError("scores", scores, "must be one or more")
    with rc_context(STYLE):
        drawing = Drawing(figsize=(SCORE_WIDTH, SCORE_HEIGHT), layout="constrained")
        ax = drawing.subplots()
        for i, score in enumerate(scores):
            _draw_solver(ax, score, i, len(scores))
        _label_groups(ax, scores[0].cases)
        _label_heights(ax)
        names = [Line2D([], [], linestyle="none", label=score.name, **_look(i)) for i, score in enumerate(scores)]
        drawing.legend(handles=names, loc="outside upper right", ncols=min(4, len(names)), frameon=False)
    return drawing


def _look(i: int) -> Record:
    colour, mark = (
        SOLVER_COLOURS[i % len(SOLVER_COLOURS)],
        SOLVER_MARKS[(i + i // len(SOLVER_COLOURS)) % len(SOLVER_MARKS)],
    )
    return {"color": colour, "marker": mark, "markersize": 3.2, "markeredgewidth": 0}


def _draw_solver(ax: Axes, score: Score, i: int, count: int) -> None:
    shift = (i + 0.5) / count - 0.5
    points = [(k + 0.8 * shift, _height(case)) for k, case in enumerate(score.cases)]
    drawn = [(at, height) for at, height in points if height is not None]
    ax.plot(*zip(*drawn, strict=True), linestyle="none", **_look(i)) if drawn else None


def _height(case: CaseScore) -> float | None:
    """Return where a case is drawn; None if nothing happens in it and nothing is reported."""
    if not case.given:
        return ABSENT
    if not case.right:
        return FAULTY
    return None if case.units is None else min(max(case.units, LEAST_UNITS), MOST_UNITS)


def _label_groups(ax: Axes, cases: Sequence[CaseScore]) -> None:
    begin, ticks, names = 0, [], []
    for number, (group, members) in enumerate(by_group(cases)):
        if number % 2:
            ax.axvspan(begin - 0.5, begin + len(members) - 0.5, color="0.94", linewidth=0, zorder=-1)
        ticks.append(begin + (len(members) - 1) / 2)
        names.append(group)
        begin += len(members)
    ax.set_xticks(ticks, names, rotation=40, ha="right", rotation_mode="anchor")
    ax.tick_params(axis="x", length=0)
    ax.set_xlim(-0.5, begin - 0.5)


def _label_heights(ax: Axes) -> None:
    ax.set_yscale("log")
    ax.set_ylim(LEAST_UNITS / 2, TOP_OF_ALL)
    marks = [10.0**n for n in (-3, 0, 3, 6, 9)]
    ax.set_yticks([*marks, FAULTY, ABSENT], [*(f"$10^{{{n}}}$" for n in (-3, 0, 3, 6, 9)), "wrong", "no result"])
    ax.minorticks_off()
    ax.axhline(1, color="0.5", linewidth=0.6, linestyle="--", zorder=0)
    ax.axhline(MOST_UNITS * 10, color="0.3", linewidth=0.6)
    ax.set_ylabel("largest error, in units of condition · 10$^{-16}$")
