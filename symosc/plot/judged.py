"""Figures and a page of cross-checks; figures of certificates and of the scores of solvers.

The page is one HTML file with verdict, diagnosis, events and pictures, that needs nothing else.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator, Sequence
from decimal import Decimal
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from symosc.aliases import Record
from symosc.arguments import public
from symosc.certificates.certificate import Certificate
from symosc.crosschecks.report import CrossCheck
from symosc.errors import ParameterError
from symosc.exact import whole_number
from symosc.files import check_folder_of, write_text
from symosc.fit import Fit
from symosc.plot.drawing import STYLE, add_legend, legend_entries, one_axes, panel_axes, read_panels, style_for
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

if TYPE_CHECKING:
    from symosc.reference.score import CaseScore, Score

POSITION, VELOCITY, RIGHT, WRONG, INVENTED = "#1f3fd6", "#0f8a2a", "0.72", "#d7191c", "#e08214"
# Zeros are drawn here, and no axis goes further down.
FLOOR = 1e-17


@public
def crosscheck_figure(check: CrossCheck, panels: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a cross-check against time: global errors, defects of the steps, and the velocity.

    Events are vertical lines: matched ones grey, missed ones red and dashed, invented ones orange and dotted. The
    tolerances are dotted horizontal lines.

    Parameters
    ----------
    check : CrossCheck
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a global errors, b defects, c velocity. Default: all, with `ax` a.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, plot, simulate
    >>> t = np.linspace(0, 3, 40)
    >>> x, v = simulate("fig5", t_end=3)(t)
    >>> [axes.get_ylabel() for axes in plot.crosscheck_figure(crosscheck("fig5", t, x, v), "ab").axes]
    ['global error', 'defect of the step']
    """
    panels = read_panels(panels, "abc", ax)
    lines: list[tuple[str, Any, str, str, float]] = [
        ("event, matched", [match.event for match in check.matched], RIGHT, "-", 0.7),
        ("event, missed", check.missed, WRONG, "--", 1.1),
        ("event, invented", check.invented, INVENTED, ":", 1.1),
    ]
    with style_for(ax):
        drawing, row = panel_axes(ax, panels, (7.0, 0.8 + 1.6 * len(panels)), stacked=True, letter_at=-0.07)
        for axes, letter in zip(row, panels, strict=True):
            _check_panel(axes, check, letter)
            for label, events, color, style, width in lines:
                for event in events:
                    axes.axvline(float(event.t), color=color, ls=style, lw=width, zorder=0, label=label)
            axes.set_xlim(check.t[0], check.t[-1])
        row[-1].set_xlabel("$t$")
        add_legend(drawing, ax, legend_entries(row), 5, handlelength=1.8, columnspacing=1.4)
    return drawing


def _errors(ax: Axes, t: np.ndarray, errors: np.ndarray, scales: tuple[float, float], limits: np.ndarray) -> None:
    """Draw errors and their limits against time."""
    shown: list[np.ndarray] = []
    names, colors = ("$x$, relative", r"$\dot{x}$, relative"), (POSITION, VELOCITY)
    for column, (name, color, style) in enumerate(zip(names, colors, ("-", (0, (4, 1.6))), strict=True)):
        values = np.maximum(np.abs(errors[:, column]) / scales[column], FLOOR)
        # Where exact and computed values agree to the last digit there is nothing to draw.
        values = np.where(values > FLOOR, values, np.nan)
        marker = "." if len(t) < 1000 else None
        shown.append(values)
        ax.plot(t, values, marker=marker, ms=2.5, lw=0.8, color=color, ls=style, label=name)
    limit = np.max(limits / scales, axis=1)
    ax.plot(t, limit, color="black", lw=0.7, ls=(0, (1, 2)), label="tolerance")
    if np.isnan(shown).all():  # nothing to scale by but the tolerance
        ax.set_ylim(FLOOR, 10 * max(float(np.max(limit)), FLOOR))
    ax.set_yscale("log")


def _check_panel(ax: Axes, check: CrossCheck, letter: str) -> None:
    """Draw the global errors (a), the defects of the steps (b) or the velocity of the samples (c)."""
    ax.set_ylabel({"a": "global error", "b": "defect of the step", "c": r"$\dot{x}$"}[letter])
    if letter == "a":
        _errors(ax, check.t, check.errors, check.scales, check.limits)
    elif letter == "b":
        _errors(ax, check.t[1:], check.defects, check.scales, check.allowed)
        wrong = check.wrong_steps
        if len(wrong):
            worst = np.max(np.abs(check.defects[wrong]) / check.scales, axis=1)
            ax.plot(check.t[wrong + 1], worst, "x", color=WRONG, ms=5, label="wrong step")
    else:
        ax.plot(check.t, check.v, color=VELOCITY, lw=0.8)
        low, high = float(np.min(check.v)), float(np.max(check.v))
        for speed in (float(check.trajectory.parameters.belt(belt)) for belt in (1, 2)):
            if low - (high - low) <= speed <= high + (high - low):
                ax.axhline(speed, color="black", lw=0.8, label="belt")


@public
def fit_figure(found: Fit, panels: str | None = None, *, ax: Axes | None = None) -> Figure:
    """Draw a fit against time: the fitted motion with what was measured, and the residuals.

    Parameters
    ----------
    found : Fit
    panels, ax : optional
        As for `symosc.plot.figure`. The panels are a motion and data, b residuals. Default: both, with `ax` a.

    Examples
    --------
    >>> from symosc import fit, plot
    >>> found = fit("fig5", [(0.1223, "stick"), (1.2210, "slip"), (4.7586, "stick")], "mu1", sigma=1e-4)
    >>> [axes.get_xlabel() for axes in plot.fit_figure(found).axes]
    ['', 'time $t$']
    """
    panels = read_panels(panels, "ab", ax)
    measured, motion = found._measured, found.trajectory
    times = np.linspace(float(motion.t_start), float(motion.t_end), 2000)
    with style_for(ax):
        drawing, row = panel_axes(ax, panels, (7.0, 0.8 + 1.7 * len(panels)), stacked=True, letter_at=-0.07)
        for axes, letter in zip(row, panels, strict=True):
            if letter == "a":
                axes.plot(times, motion(times)[0], color=POSITION, lw=0.9, label="fitted motion")
                for name, t, x, marker in _measured_points(found):
                    axes.plot(t, x, marker, color="black", ms=3.5, mfc="none", mew=0.8, label=name)
                axes.set_ylabel("displacement $x$")
            else:
                count = len(measured.t)
                columns = ("$x$", POSITION, "."), (r"$\dot{x}$", VELOCITY, "x")
                for n, (name, color, marker) in enumerate(columns):
                    part = found.residuals[n * count : (n + 1) * count]
                    label = None if measured.states is None or len(measured.states) < 2 else name
                    axes.plot(measured.t[: len(part)], part, marker, ms=4, mew=0.8, color=color, label=label)
                for level, width in ((0, 0.8), (-2, 0.6), (2, 0.6))[: 3 if measured.weighted else 1]:
                    axes.axhline(level, color="0.4", lw=width, ls="-" if not level else (0, (1, 2)), zorder=0)
                axes.set_ylabel(r"residual / $\sigma$" if measured.weighted else "residual")
            axes.set_xlim(times[0], times[-1])
        row[-1].set_xlabel("time $t$")
        add_legend(drawing, ax, legend_entries(row), 5, handlelength=1.8, columnspacing=1.4)
    return drawing


def _measured_points(found: Fit) -> Iterator[tuple[str, np.ndarray, np.ndarray, str]]:
    """Yield the name of measured points, their times, positions (of events: those of the motion) and marker."""
    measured, motion = found._measured, found.trajectory
    if measured.states is not None:
        yield "measured", measured.t, measured.states[0], "."
        return
    assert measured.kinds is not None
    for kind, marker in (("stick", "s"), ("slip", "o"), ("cross", "x"), ("graze", "^")):
        t = measured.t[measured.kinds == kind]
        if len(t):
            inside = np.clip(t, float(motion.t_start), float(motion.t_end))
            yield f"measured {kind}", t, motion(inside)[0], marker


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
    panels = read_panels(panels, "ab", ax)
    if step is None:
        step = check.first_wrong.step if check.first_wrong else 0
    step = whole_number("step", step, 0, len(check.t) - 2)
    begin, end = float(check.t[step]), float(check.t[step + 1])
    start: Record = {"t0": begin, "x0": float(check.x[step]), "v0": float(check.v[step])}
    motion = simulate(check.trajectory.parameters, **start, t_end=end) if end > begin else None
    with style_for(ax):
        drawing, row = panel_axes(ax, panels, (4.6, 1.0 + 1.9 * len(panels)), stacked=True)
        for axes, letter in zip(row, panels, strict=True):
            _step_panel(axes, check, step, motion, letter)
        row[-1].set_xlabel("$t$")
        add_legend(drawing, ax, legend_entries(row[:1]), 2)
    return drawing


def _step_panel(ax: Axes, check: CrossCheck, step: int, motion: Trajectory | None, letter: str) -> None:
    """Draw one panel of a step."""
    row, values, name, color = (1, check.v, "$v$", VELOCITY) if letter == "a" else (0, check.x, "$x$", POSITION)
    around = slice(max(0, step - 3), step + 2 + 3)
    shown = values[around]
    if motion is not None:
        t = np.linspace(float(motion.t_start), float(motion.t_end), 400)
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


# -- the page of a cross-check -----------------------------------------------------------------------------------------

MOST_ROWS = 200  # of a table


def write_page(check: CrossCheck, path: str | Path) -> Path:
    """Write the page of a cross-check; raise OutputError if it cannot be written."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    check_folder_of(path)
    loader = PackageLoader("symosc.plot", "templates")
    trim: Record = {"trim_blocks": True, "lstrip_blocks": True}
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, **trim)
    return write_text(path, environment.get_template("crosscheck.html.j2").render(page(check)))


def page(check: CrossCheck) -> Record:
    """Return the values that fill the page of a cross-check: verdict, facts, pictures, events and faults."""
    from symosc.crosschecks.causes import CAUSES, REASONS

    events = list(_events(check))
    return {
        "check": check,
        "verdict": _verdict(check),
        "facts": _facts(check),
        "causes": CAUSES,
        "reasons": REASONS,
        "pictures": list(_pictures(check)),
        "events": events[:MOST_ROWS],
        "more_events": max(0, len(events) - MOST_ROWS),
        "wrong": list(check.faults[:MOST_ROWS]),
        "shown": 8,  # before the reader unfolds the rest
    }


def _verdict(check: CrossCheck) -> str:
    """Return the verdict as text."""
    if check.ok:
        return f"Right: every step agrees with the exact motion, to a tolerance of {check.tolerance:g}."
    wrong = f"wrong steps: {len(check.wrong_steps)} of {len(check.defects)}"
    events = f"events missed: {len(check.missed)}, invented: {len(check.invented)}"
    beside = "".join(f" {said[0].upper()}{said[1:]}." for said in (check.wrong_start, check.early_end) if said)
    return f"Not right: {wrong}; {events} (tolerance {check.tolerance:g} per step).{beside}"


def _facts(check: CrossCheck) -> list[tuple[str, str]]:
    """Return the findings as names and texts."""
    limits = check.limits_there
    return [
        ("Samples", f"{len(check.t)}, from t = {check.t[0]:.10g} to {check.t[-1]:.10g}"),
        ("Largest error of x", f"{check.max_error_x:.2e} (allowed {limits[0]:.1e})"),
        ("Largest error of v", f"{check.max_error_v:.2e} (allowed {limits[1]:.1e})"),
        ("Events", f"{len(check.matched)} right, {len(check.missed)} missed, {len(check.invented)} invented, "
                   f"{len(check.unresolved)} not decided"),
        ("Digits", ", ".join(f"{name} to {text}" for name, text in check.rounded.items()) or "those of doubles"),
    ]  # fmt: skip


def _events(check: CrossCheck) -> Iterator[Record]:
    """Yield the events in order of time, each with its partner in the solution."""
    rows: list[tuple[float, str, str, Any]] = [
        (float(match.event.t), "right", f"{match.error:+.1e}", match.event) for match in check.matched
    ]
    others: Record = {"missed": check.missed, "invented": check.invented, "not decided": check.unresolved}
    rows += [(float(event.t), verdict, "", event) for verdict, events in others.items() for event in events]
    for time, verdict, error, event in sorted(rows, key=lambda row: row[0]):
        way = f"{event.source} → {event.target}" if event.source else ""
        yield {"t": f"{time:.10g}", "kind": event.kind, "belt": event.boundary or "", "way": way,
               "verdict": verdict, "error": error}  # fmt: skip


def _pictures(check: CrossCheck) -> Iterator[Record]:
    """Yield the pictures of the page as values for it."""
    first, many = check.first_wrong, len(check.t) > 4_000  # as lines they would be megabytes
    if first:
        said = f"The step from sample {first.step} (t = {first.t:.8g}) to the next one. The line is the exact motion "
        said += "from that sample on; it should end at the cross. Grey lines are its events."
        yield _picture(step_figure(check), False, "First wrong step", said)
    for letter, title, said in CAPTIONS:
        yield _picture(crosscheck_figure(check, letter), many, title, said)


#: Panels, titles and captions of the pictures.
CAPTIONS = (
    (
        "b",
        "Errors of the steps",
        "The exact motion from each sample over one step, minus the next sample, in units of the largest |x| and |v|. "
        "Crosses are wrong steps. Vertical lines are events: grey matched, red missed, orange invented.",
    ),
    ("a", "Global error", "The samples minus the exact motion from the start, in the same units."),
    ("c", "Velocity", "The samples' velocity; black lines are the belts' speeds."),
)


def _picture(drawing: Figure, pixels: bool, title: str, caption: str) -> Record:
    """Return a figure as values for the page."""
    width, height = drawing.get_size_inches()
    if len(drawing.axes) == 1:
        drawing.axes[0].set_title("", loc="left")  # no letter for a single panel
    for legend in drawing.legends:  # two columns fit the width
        handles = [handle for handle in legend.legend_handles if handle is not None]
        labels = [text.get_text() for text in legend.get_texts()]
        legend.remove()
        with rc_context(STYLE):
            drawing.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
    drawing.set_size_inches(min(width, 4.0), max(height, 3.3))  # letters that a phone can show
    kind, media = ("png", "png") if pixels else ("svg", "svg+xml")
    options: Record = {"dpi": 160.0} if pixels else {"metadata": {"Date": None}}
    data = BytesIO()
    with rc_context(STYLE):
        drawing.savefig(data, format=kind, **options)
    source = f"data:image/{media};base64,{b64encode(data.getvalue()).decode('ascii')}"
    return {"title": title, "caption": caption, "source": source}


# -- certificates ------------------------------------------------------------------------------------------------------


@public
def certificate_figure(certificate: Certificate, *, ax: Axes | None = None) -> Figure:
    """Draw the widths of the proven enclosures of an orbit's or a motion's events against time.

    Parameters
    ----------
    certificate : Certificate
        Of a trajectory or an orbit; what is proven of a branch or a window are no events.

    Examples
    --------
    >>> from symosc import certify, plot
    >>> plot.certificate_figure(certify("fig6")).axes[0].get_ylabel()
    'width of the enclosure'
    """
    events = [event for event in certificate.events if len(event) > 3]
    if not events:
        allowed = "has no enclosed events to draw; those of a trajectory or an orbit with events do"
        raise ParameterError("certificate", certificate, allowed)
    times = [float(event[3][0]) for event in events]
    enclosed = (("time $t$", "#1f3fd6", "o"), ("position $x$", "#d7191c", "s"))
    with style_for(ax):
        drawing, axes = one_axes(ax, (4.6, 3.0))
        for i, (name, color, shape) in enumerate(enclosed):
            widths = [max(float(Decimal(high) - Decimal(low)), 1e-30) for low, high in (e[3 + i] for e in events)]
            axes.semilogy(times, widths, marker=shape, ms=3.5, lw=0.8, color=color, label=name)
        axes.set(xlabel="time $t$", ylabel="width of the enclosure")
        axes.set_title(f"{certificate.kind}, {'proven' if certificate.proven else 'not proven'}")
        axes.legend(frameon=False)
    return drawing


# -- scores ------------------------------------------------------------------------------------------------------------

SOLVER_COLOURS = ("#2166ac", "#b2182b", "#1b7837", "#e08214", "#762a83", "#8c510a", "#4d4d4d", "#01665e")
SOLVER_MARKS = "os^DvPX*"
#: Errors below are drawn at the first, above at the second; where faults and missing results are; where it ends.
LEAST_UNITS, MOST_UNITS, FAULTY, ABSENT, TOP_OF_ALL = 1e-3, 1e10, 1e12, 1e14, 1e15


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
        A column per case, in groups: below, the largest error in units of the problem's rounding; above, the cases with
        wrong events or too large an error, and those without results.

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
        drawing, ax = one_axes(None, (10.0, 4.2))
        for i, each in enumerate(scores):
            shift = 0.8 * ((i + 0.5) / len(scores) - 0.5)
            heights = [(k + shift, _height(case)) for k, case in enumerate(each.cases)]
            drawn = [(at, height) for at, height in heights if height is not None]
            if drawn:
                ax.plot(*zip(*drawn, strict=True), linestyle="none", **_mark_of(i))
        _label_groups(ax, scores[0].cases)
        powers = (-3, 0, 3, 6, 9)
        labels = [*(f"$10^{{{n}}}$" for n in powers), "wrong", "no result"]
        ax.set(
            yscale="log", ylim=(LEAST_UNITS / 2, TOP_OF_ALL), ylabel="largest error, in units of condition · 10$^{-16}$"
        )
        ax.set_yticks([*(10.0**n for n in powers), FAULTY, ABSENT], labels)
        ax.minorticks_off()
        ax.axhline(1, color="0.5", linewidth=0.6, linestyle="--", zorder=0)
        ax.axhline(MOST_UNITS * 10, color="0.3", linewidth=0.6)
        names = [Line2D([], [], linestyle="none", label=each.name, **_mark_of(i)) for i, each in enumerate(scores)]
        drawing.legend(handles=names, loc="outside upper right", ncols=min(4, len(names)), frameon=False)
    return drawing


def _mark_of(i: int) -> Record:
    """Return the style of the i-th solver's marks."""
    mark = SOLVER_MARKS[(i + i // len(SOLVER_COLOURS)) % len(SOLVER_MARKS)]
    return {"color": SOLVER_COLOURS[i % len(SOLVER_COLOURS)], "marker": mark, "markersize": 3.2, "markeredgewidth": 0}


def _height(case: CaseScore) -> float | None:
    """Return the height at which a case is drawn; None if it has no event and none is reported."""
    if not case.given:
        return ABSENT
    if not case.right:
        return FAULTY
    return None if case.units is None else min(max(case.units, LEAST_UNITS), MOST_UNITS)


def _label_groups(ax: Axes, cases: Sequence[CaseScore]) -> None:
    """Write the names of the groups of cases."""
    from symosc.reference.score import by_group

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
