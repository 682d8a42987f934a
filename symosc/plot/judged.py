"""Figures and a page of cross-checks; figures of certificates and of the scores of solvers.

The page is one HTML file with verdict, diagnosis, events and pictures, that needs nothing else.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Sequence
from decimal import Decimal
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from symosc.analysis.fitting.fit import Fit
from symosc.base.aliases import Record
from symosc.base.arguments import public, require, sequence_of
from symosc.base.display.pages import render
from symosc.base.errors import ParameterError
from symosc.base.exact import whole_number
from symosc.base.files import check_folder_of, write_text
from symosc.certificates.certificate import Certificate
from symosc.crosschecks.causes import CAUSES
from symosc.crosschecks.faults import REASONS, Fault
from symosc.crosschecks.report import CrossCheck
from symosc.plot.drawing import (
    STYLE,
    FigureSize,
    add_legend,
    axes_for,
    draw_belts,
    panels_for,
    shown_name,
)
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

if TYPE_CHECKING:
    from symosc.reference.score import CaseScore, Score

POSITION = "#1f3fd6"
VELOCITY = "#0f8a2a"
RIGHT = "0.72"
WRONG = "#d7191c"
INVENTED = "#e08214"
# Zeros are drawn here, and no axis goes further down.
FLOOR = 1e-17
#: Samples that a figure of one step shows before it, and after it.
SAMPLES_BESIDE = 3
#: Exact events that it marks, at most.
MOST_STEP_EVENTS = 4
#: For `panels_for`: the panels stand in one column.
ABOVE_EACH_OTHER: Record = {"more": 0.8, "columns": 1, "letter_at": -0.07}


@public
def crosscheck_figure(
    check: CrossCheck,
    panels: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw a cross-check against time: global errors, defects of the steps, and the velocity.

    Events are vertical lines: matched ones grey, missed ones red and dashed, invented ones orange
    and dotted. The tolerances are dotted horizontal lines.

    Parameters
    ----------
    check : CrossCheck
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a global errors, b defects, c velocity. Default:
        all, with `ax` a.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, plot, simulate
    >>> t = np.linspace(0, 3, 40)
    >>> x, v = simulate("fig5", t_end=3)(t)
    >>> [axes.get_ylabel() for axes in plot.crosscheck_figure(crosscheck("fig5", t, x, v), "ab").axes]
    ['global error', 'defect of the step']
    """
    require(CrossCheck, check=check)
    marks: list[tuple[str, Any, Record]] = [
        (
            "matched",
            [match.event for match in check.matched],
            {"color": RIGHT, "ls": "-", "lw": 0.7},
        ),
        ("missed", check.missed, {"color": WRONG, "ls": "--", "lw": 1.1}),
        ("invented", check.invented, {"color": INVENTED, "ls": ":", "lw": 1.1}),
    ]
    draw: Record = {
        "a": partial(_errors, of_steps=False),
        "b": partial(_errors, of_steps=True),
        "c": _velocity,
    }
    with panels_for(check, draw, panels, ax, (7.0, 1.6), figsize=figsize, **ABOVE_EACH_OTHER) as (
        drawing,
        row,
    ):
        for axes in row:
            for name, events, style in marks:
                for event in events:
                    axes.axvline(float(event.t), zorder=0, label=f"event, {name}", **style)
            axes.set_xlim(check.t[0], check.t[-1])
        row[-1].set_xlabel("$t$")
        add_legend(drawing, ax, row, 5)
    return drawing


def _errors(ax: Axes, check: CrossCheck, of_steps: bool) -> None:
    """Draw the errors against time, or the defects if `of_steps` is true, and the limits that they
    must not exceed.
    """
    if of_steps:
        t = check.t[1:]
        errors = check.defects
        limits = check.allowed
    else:
        t = check.t
        errors = check.errors
        limits = check.limits
    values = np.abs(errors) / check.scales
    # Where exact and computed values agree to the last digit there is nothing to draw.
    values = np.where(values > FLOOR, values, np.nan)
    x_errors, v_errors = values.T
    style: Record = {"marker": "." if len(t) < 1000 else None, "ms": 2.5, "lw": 0.8}
    ax.plot(t, x_errors, color=POSITION, ls="-", label="$x$, relative", **style)
    ax.plot(t, v_errors, color=VELOCITY, ls=(0, (4, 1.6)), label=r"$\dot{x}$, relative", **style)
    limit = np.max(limits / check.scales, axis=1)
    ax.plot(t, limit, color="black", lw=0.7, ls=(0, (1, 2)), label="tolerance")
    if np.isnan(values).all():  # nothing to scale by but the tolerance
        ax.set_ylim(FLOOR, 10 * max(float(np.max(limit)), FLOOR))
    ax.set(yscale="log", ylabel="defect of the step" if of_steps else "global error")
    if of_steps and len(check.wrong_steps):
        worst = np.max(np.abs(check.defects[check.wrong_steps]) / check.scales, axis=1)
        ax.plot(check.t[check.wrong_steps + 1], worst, "x", color=WRONG, ms=5, label="wrong step")


def _velocity(ax: Axes, check: CrossCheck) -> None:
    """Draw the velocity of the samples, and the belts that are near."""
    ax.set_ylabel(r"$\dot{x}$")
    ax.plot(check.t, check.v, color=VELOCITY, lw=0.8)
    low = float(np.min(check.v))
    high = float(np.max(check.v))
    p = check.trajectory.parameters
    draw_belts(ax, (belt.v for belt in p.law.belts), 2 * low - high, 2 * high - low)


@public
def fit_figure(
    found: Fit, panels: str | None = None, *, ax: Axes | None = None, figsize: FigureSize = None
) -> Figure:
    """Draw a fit against time: the fitted motion with what was measured, and the residuals.

    Parameters
    ----------
    found : Fit
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a motion and data, b residuals. Default: both,
        with `ax` a.

    Examples
    --------
    >>> from symosc import fit, plot
    >>> found = fit("fig5", [(0.1223, "stick"), (1.2210, "slip"), (4.7586, "stick")], "mu1", sigma=1e-4)
    >>> [axes.get_xlabel() for axes in plot.fit_figure(found).axes]
    ['', 'time $t$']
    """
    require(Fit, found=found)
    # `panels_for` has drawn the panels when it yields their axes.
    with panels_for(
        found, FIT_PANELS, panels, ax, (7.0, 1.7), figsize=figsize, **ABOVE_EACH_OTHER
    ) as (
        drawing,
        row,
    ):
        for axes in row:
            axes.set_xlim(float(found.trajectory.t_start), float(found.trajectory.t_end))
        row[-1].set_xlabel("time $t$")
        add_legend(drawing, ax, row, 5)
    return drawing


def _motion_and_data(ax: Axes, found: Fit) -> None:
    """Draw x(t) of the fitted motion and the measured samples.

    Times of measured events are marked on x(t).
    """
    measured = found._measured
    motion = found.trajectory
    times = np.linspace(float(motion.t_start), float(motion.t_end), 2000)
    positions, _ = motion(times)
    ax.plot(times, positions, color=POSITION, lw=0.9, label="fitted motion")
    style: Record = {"color": "black", "ms": 3.5, "mfc": "none", "mew": 0.8}
    if measured.states is not None:
        ax.plot(measured.t, measured.states[0], ".", label="measured", **style)
    for kind, marker in (("stick", "s"), ("slip", "o"), ("cross", "x"), ("graze", "^")):
        if measured.kinds is not None:
            t = measured.t[measured.kinds == kind]
        else:
            t = ()
        if len(t):
            x, _ = motion(np.clip(t, times[0], times[-1]))
            ax.plot(t, x, marker, label=f"measured {kind}", **style)
    ax.set_ylabel("displacement $x$")


def _residuals(ax: Axes, found: Fit) -> None:
    """Draw the residuals, of x and of v, in units of the standard deviation if it was given."""
    measured = found._measured
    count = len(measured.t)
    # A single column, of times or of x, needs no legend.
    named = measured.states is not None and len(measured.states) > 1
    columns = ("$x$", POSITION, "."), (r"$\dot{x}$", VELOCITY, "x")
    for n, (name, color, marker) in enumerate(columns):
        # The residuals of x come first, then those of v; of a missing column there are none.
        residuals = found.residuals[n * count : (n + 1) * count]
        ax.plot(
            measured.t[: len(residuals)],
            residuals,
            marker,
            ms=4,
            mew=0.8,
            color=color,
            label=name if named else None,
        )
    ax.axhline(0, color="0.4", lw=0.8, zorder=0)
    for level in (-2, 2) if measured.weighted else ():
        ax.axhline(level, color="0.4", lw=0.6, ls=(0, (1, 2)), zorder=0)
    ax.set_ylabel(r"residual / $\sigma$" if measured.weighted else "residual")


FIT_PANELS = {"a": _motion_and_data, "b": _residuals}


@public
def step_figure(
    check: CrossCheck,
    step: int | None = None,
    panels: str | None = None,
    *,
    ax: Axes | None = None,
    figsize: FigureSize = None,
) -> Figure:
    """Draw one step of a cross-check: the exact motion from its first sample on, and the samples
    about it.

    Parameters
    ----------
    check : CrossCheck
    step : int, optional
        From sample `step` to the next one. Default: the first wrong step, or the first step if none
        is wrong.
    panels, ax, figsize : optional
        As for `symosc.plot.figure`. The panels are a velocity, b position. Default: both, with `ax`
        a.

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
    require(CrossCheck, check=check)
    if step is None:
        if check.first_wrong:
            step = check.first_wrong.step
        else:
            step = 0
    step = whole_number("step", step, 0, len(check.t) - 2)
    draw = {"a": partial(_step_panel, step=step, of_velocity=True)}
    draw["b"] = partial(_step_panel, step=step, of_velocity=False)
    with panels_for(check, draw, panels, ax, (4.6, 1.9), figsize=figsize, more=1.0, columns=1) as (
        drawing,
        row,
    ):
        row[-1].set_xlabel("$t$")
        add_legend(drawing, ax, row[:1], 2)
    return drawing


def _step_panel(ax: Axes, check: CrossCheck, step: int, of_velocity: bool) -> None:
    """Draw the velocity or the position in a step, with the exact motion from its first sample
    on.
    """
    if of_velocity:
        values = check.v
        name = "$v$"
        color = VELOCITY
    else:
        values = check.x
        name = "$x$"
        color = POSITION
    # The two samples of the step, and up to SAMPLES_BESIDE on either side.
    around = slice(max(0, step - SAMPLES_BESIDE), step + 2 + SAMPLES_BESIDE)
    p = check.trajectory.parameters
    shown_values = values[around]
    events = tuple[Event, ...]()
    begin = float(check.t[step])
    end = float(check.t[step + 1])
    if end > begin:
        motion = simulate(p, t0=begin, x0=float(check.x[step]), v0=float(check.v[step]), t_end=end)
        t = np.linspace(begin, end, 400)
        events = motion.events[:MOST_STEP_EVENTS]
        x, v = motion(t)
        exact = v if of_velocity else x
        shown_values = np.append(shown_values, exact)
        ax.plot(t, exact, color=color, lw=1.4, label="exact, from the sample before")
        ax.plot(
            t[-1:],
            exact[-1:],
            "o",
            ms=5,
            mfc="white",
            mec=color,
            label="exact, where the next sample should be",
        )
    ax.plot(check.t[around], values[around], ":", color="0.45", lw=0.9)
    ax.plot(check.t[around], values[around], ".", color="black", ms=6, label="given")
    ax.plot(
        check.t[step + 1],
        values[step + 1],
        "x",
        color=WRONG,
        ms=7,
        mew=1.6,
        label="given, end of this step",
    )
    # If all values are the same, the axis still has a height.
    margin = 0.08 * (float(np.ptp(shown_values)) or 1.0)
    low = float(np.min(shown_values)) - margin
    high = float(np.max(shown_values)) + margin
    if of_velocity:
        draw_belts(ax, (belt.v for belt in p.law.belts), low, high)
    for number, event in enumerate(events):
        ax.axvline(
            float(event.t), color="0.6", lw=0.9, zorder=0, label="" if number else "exact event"
        )
        if of_velocity:
            ax.text(
                float(event.t),
                1.0,
                event.kind,
                transform=ax.get_xaxis_transform(),
                ha="center",
                va="bottom",
            )
    ax.set(ylim=(low, high), ylabel=name)


# -- the page of a cross-check ---------------------------------------------------------------------

#: Rows of a table, and those that are shown before the reader unfolds the rest.
MOST_ROWS = 200
FIRST_ROWS = 8
#: Curves of more samples are pixels in the page: as lines they would be megabytes.
MOST_DRAWN_SAMPLES = 4_000


def write_page(check: CrossCheck, path: str | Path) -> Path:
    """Write the page of a cross-check: verdict, facts, pictures, events and faults.

    OutputError if this fails.
    """
    check_folder_of(path)
    events = _events(check)
    content: Record = {
        "check": check,
        "verdict": _verdict(check),
        "events": events[:MOST_ROWS],
        "event_count": len(events),
        "faults": [_fault_row(fault) for fault in check.faults[:MOST_ROWS]],
        "causes": CAUSES,
        "reasons": REASONS,
        "pictures": list(_pictures(check)),
        "shown": FIRST_ROWS,
    }
    return write_text(path, render("plot/templates/crosscheck.html.j2", content))


def _fault_row(fault: Fault) -> tuple[Any, ...]:
    """Return the row of the page's table about a wrong step."""
    guess = f"{REASONS[fault.reason].capitalize()}: {fault.words}"
    defects = f"{fault.defect_x:.1e}", f"{fault.defect_v:.1e}"
    return (fault.step, f"{fault.t:.10g}", *defects, guess)


def _verdict(check: CrossCheck) -> str:
    """Return a sentence that says whether the solution is right, and what is wrong with it."""
    if check.ok:
        return (
            "Right: every step agrees with the exact motion, to a tolerance of "
            f"{check.tolerance:g}."
        )
    wrong = f"wrong steps: {len(check.wrong_steps)} of {len(check.defects)}"
    events = f"events missed: {len(check.missed)}, invented: {len(check.invented)}"
    ends = (check.wrong_start, check.early_end)
    other_faults = "".join(f" {reason[0].upper()}{reason[1:]}." for reason in ends if reason)
    return f"Not right: {wrong}; {events} (tolerance {check.tolerance:g} per step).{other_faults}"


def _events(check: CrossCheck) -> list[tuple[Any, ...]]:
    """Return the rows of the page's table of events in order of time: verdicts, and the errors of
    right events.
    """
    rows: list[tuple[str, str, Any]] = [
        ("right", f"{match.error:+.1e}", match.event) for match in check.matched
    ]
    others: Record = {
        "missed": check.missed,
        "invented": check.invented,
        "not decided": check.unresolved,
    }
    rows += [(verdict, "", event) for verdict, events in others.items() for event in events]

    def time_of(row: tuple[str, str, Any]) -> float:
        _, _, event = row
        return float(event.t)

    texts: list[tuple[Any, ...]] = []
    for verdict, error, event in sorted(rows, key=time_of):
        t = f"{float(event.t):.10g}"
        modes = f"{event.source} → {event.target}" if event.source else ""
        texts.append((t, event.kind, str(event.boundary or ""), verdict, error, modes))
    return texts


#: Panels, titles and captions of the pictures.
CAPTIONS = (
    (
        "b",
        "Errors of the steps",
        "The exact motion from each sample over one step, minus the next sample, in units of the "
        "largest |x| and |v|. "
        "Crosses are wrong steps. Vertical lines are events: grey matched, red missed, orange "
        "invented.",
    ),
    ("a", "Global error", "The samples minus the exact motion from the start, in the same units."),
    ("c", "Velocity", "The samples' velocity; dashed lines are the belts' speeds."),
)


def _pictures(check: CrossCheck) -> Iterator[Record]:
    """Yield the pictures of a cross-check's page, as from `_picture`: the first wrong step, if any,
    then all panels.
    """
    first = check.first_wrong
    as_pixels = len(check.t) > MOST_DRAWN_SAMPLES
    if first:
        caption = (
            f"The step from sample {first.step} (t = {first.t:.8g}) to the next one. The line is "
            "the exact motion "
            "from that sample on; it should end at the cross. Grey lines are its events."
        )
        yield _picture(step_figure(check), pixels=False, title="First wrong step", caption=caption)
    for letter, title, caption in CAPTIONS:
        yield _picture(crosscheck_figure(check, letter), as_pixels, title, caption)


@rc_context(STYLE)
def _picture(drawing: Figure, pixels: bool, title: str, caption: str) -> Record:
    """Return a dict of title, caption and image of a figure for the page's template: PNG if
    `pixels`, else SVG.
    """
    width, height = drawing.get_size_inches()
    for legend in drawing.legends:  # made anew: two columns fit the width of a phone
        handles = [handle for handle in legend.legend_handles if handle is not None]
        labels = [text.get_text() for text in legend.get_texts()]
        legend.remove()
        drawing.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
    drawing.set_size_inches(min(width, 4.0), max(height, 3.3))  # letters that a phone can show
    if pixels:
        options: Record = {"format": "png", "dpi": 160.0}
    else:
        options = {"format": "svg", "metadata": {"Date": None}}
    data = BytesIO()
    drawing.savefig(data, **options)
    if pixels:
        kind = "png"
    else:
        kind = "svg+xml"
    source = f"data:image/{kind};base64,{b64encode(data.getvalue()).decode('ascii')}"
    return {"title": title, "caption": caption, "source": source}


# -- certificates ----------------------------------------------------------------------------------


@public
def certificate_figure(
    certificate: Certificate, *, ax: Axes | None = None, figsize: FigureSize = None
) -> Figure:
    """Draw the widths of the proven enclosures of an orbit's or a motion's events against time.

    Parameters
    ----------
    certificate : Certificate
        Of a trajectory or an orbit; certificates of branches and windows have no events.

    Examples
    --------
    >>> from symosc import certify, plot
    >>> plot.certificate_figure(certify("fig6")).axes[0].get_ylabel()
    'width of the enclosure'
    """
    require(Certificate, certificate=certificate)
    # An event is kind, source and target, and then the enclosures of t and of x, if it has them.
    enclosures = [event[3:] for event in certificate.events if len(event) > 3]
    if not enclosures:
        allowed = (
            "must have enclosed events, as that of a trajectory or of an orbit with events has"
        )
        raise ParameterError("certificate", certificate, allowed)
    t_bounds, x_bounds = zip(*enclosures, strict=True)
    times = [float(low) for low, _ in t_bounds]
    curves = (
        ("time $t$", "#1f3fd6", "o", t_bounds),
        ("position $x$", "#d7191c", "s", x_bounds),
    )
    with axes_for(ax, (4.6, 3.0), figsize=figsize) as (drawing, (axes,)):
        for name, color, shape, bounds in curves:
            # A logarithmic axis cannot show a width of 0.
            widths = [max(float(Decimal(high) - Decimal(low)), 1e-30) for low, high in bounds]
            axes.semilogy(times, widths, marker=shape, ms=3.5, lw=0.8, color=color, label=name)
        axes.set(xlabel="time $t$", ylabel="width of the enclosure")
        axes.set_title(f"{certificate.kind}, {'proven' if certificate.proven else 'not proven'}")
        axes.legend(frameon=False)
    return drawing


# -- scores ----------------------------------------------------------------------------------------

#: Errors below the second are drawn there, above the third at the third; where right cases without
#: an event are, faults, and missing results.
NOTHING = 1e-6
LEAST_UNITS = 1e-3
MOST_UNITS = 1e10
FAULTY = 1e13
ABSENT = 1e17
#: How wide a group is at least, in columns of cases: there is room for its name.
LEAST_GROUP = 5
#: Inches: the width of the figure, the height of a solver's panel, and that of the names below.
SCORES_WIDTH = 7.0
SOLVER_HEIGHT = 0.85
NAMES_HEIGHT = 1.2


@public
def score_figure(scores: Sequence[Score], *, figsize: FigureSize = None) -> Figure:
    """Draw the scores of solvers on reference cases.

    There is a panel per solver and a column per case, in groups. Below is the largest error; its
    unit is the change of the events when the numbers of the case are rounded to doubles. Above are
    the cases with wrong events or too large an error, and those without results.

    Parameters
    ----------
    scores : sequence of Score
        Of the same cases; from `symosc.reference.score.score`.
    figsize : (number, number), optional
        Width and height in inches. By default the height grows with the number of solvers.

    Examples
    --------
    >>> from symosc import plot, reference_cases
    >>> from symosc.reference.score import score
    >>> drawing = plot.score_figure([score("nobody", [reference_cases()[1]], {})])
    >>> [label.get_text() for label in drawing.axes[0].get_xticklabels()]
    ['paper']
    """
    from symosc.reference.score import Score

    require(sequence_of(Score), scores=scores)
    if not len(scores):
        raise ParameterError("scores", scores, "must be one or more")
    columns, groups, width = _columns_of(scores[0].cases)
    size = (SCORES_WIDTH, SOLVER_HEIGHT * len(scores) + NAMES_HEIGHT)
    with axes_for(None, size, len(scores), figsize=figsize, columns=1) as (drawing, panels):
        for ax, score in zip(panels, scores, strict=True):
            _score_panel(ax, score, columns)
            for number, (begin, end) in enumerate(groups.values()):
                if number % 2:
                    ax.axvspan(begin, end, color="0.94", linewidth=0, zorder=-1)
            ax.set_xlim(0, width)
            ax.tick_params(axis="x", length=0)
        middles = [(begin + end) / 2 for begin, end in groups.values()]
        # The panels share their axis, and only the lowest shows the names.
        panels[-1].set_xticks(middles, list(groups), rotation=90)
        drawing.supylabel("largest error, in units of condition · 10$^{-16}$", fontsize=9)
        drawing.get_layout_engine().set(hspace=0.02, h_pad=0.02)  # type: ignore[union-attr, call-arg]
    return drawing


def _columns_of(
    cases: Sequence[CaseScore],
) -> tuple[dict[str, float], dict[str, tuple[float, float]], float]:
    """Return the abscissas of cases by name, begin and end of their groups by name, and the end of
    the last.
    """
    from symosc.reference.score import by_group

    columns: dict[str, float] = {}
    groups: dict[str, tuple[float, float]] = {}
    begin = 0.0
    for group, members in by_group(cases):
        end = begin + max(len(members), LEAST_GROUP)
        step = (end - begin) / len(members)
        for number, case in enumerate(members):
            columns[case.name] = begin + (number + 0.5) * step
        groups[group] = (begin, end)
        begin = end
    return columns, groups, begin


def _score_panel(ax: Axes, score: Score, columns: dict[str, float]) -> None:
    """Draw the errors of one solver, a dot for each case, and above them crosses for wrong cases
    and open circles for cases without results.
    """
    looks: tuple[tuple[bool, bool, Record], ...] = (
        (True, True, {"marker": "o", "color": POSITION, "ms": 2.6, "mew": 0}),
        (True, False, {"marker": "x", "color": WRONG, "ms": 3.4, "mew": 0.9}),
        (False, True, {"marker": "o", "color": "black", "ms": 3.0, "mew": 0.7, "mfc": "none"}),
    )
    for given, right, look in looks:
        points = [
            (columns[case.name], _height(case))
            for case in score.cases
            if case.given == given and (case.right or not given) == right
        ]
        if points:
            ax.plot(*zip(*points, strict=True), linestyle="none", clip_on=False, **look)
    powers = (0, 6)
    labels = ["no event", *(f"$10^{{{n}}}$" for n in powers), "wrong", "no result"]
    ax.set(yscale="log", ylim=(NOTHING / 50, 20 * ABSENT))
    ax.set_yticks([NOTHING, *(10.0**n for n in powers), FAULTY, ABSENT], labels, fontsize=7)
    ax.minorticks_off()
    ax.axhline(1, color="0.5", linewidth=0.6, linestyle="--", zorder=0)
    ax.axhline(MOST_UNITS * 10, color="0.3", linewidth=0.6)
    ax.set_title(shown_name(score.name), loc="left", fontsize=8, pad=2)


def _height(case: CaseScore) -> float:
    """Return the ordinate of a case in a figure of scores."""
    if not case.given:
        return ABSENT
    if not case.right:
        return FAULTY
    if case.units is None:
        return NOTHING
    return min(max(case.units, LEAST_UNITS), MOST_UNITS)
