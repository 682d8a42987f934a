"""Work-precision diagrams: time per event and error of every solver, at every tolerance, on the
shipped scenes.

Errors, against a run in 40 digits, are of a short span that all solvers get; times are of a long
one, if the solver finishes it soon, so that the fixed cost of a call does not count.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf, isfinite, nan, pi
from statistics import median
from typing import Any, NamedTuple

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from tabulate import tabulate

from symosc.base.aliases import Record
from symosc.base.exact import read_exact
from symosc.bench import Progress, machine
from symosc.bench.solvers import (
    HANG,
    OURS,
    REFERENCE_DIGITS,
    Outcome,
    Solver,
    SolverEvent,
    Worker,
    all_solvers,
)
from symosc.bench.speed import floor_s
from symosc.crosschecks.events import WINDOW
from symosc.crosschecks.match import match_events
from symosc.plot.drawing import STYLE
from symosc.reference.case import relative_error
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

#: Scenes, and how many events the short span has; how many of the long span are compared, and how
#: many it has. What comes after fig8's first 20 events is beyond doubles: its sticks shrink by 3/8
#: each half period.
SCENE_SPANS = {"fig5": (24, 1000, 10_000), "fig6": (24, 1000, 10_000), "fig8": (20, 20, 20)}
SCENE_SPANS |= {"fig9": (24, 1000, 10_000), "fig10": (24, 1000, 10_000)}
QUICK_SCENE_SPANS = {"fig5": (24, 100, 4_000), "fig8": (20, 20, 20)}
#: Seconds that a solver may take for one span; the long span is for solvers that need no more than
#: LONG_RUN for it.
SPAN_LIMIT = 20.0
QUICK_SPAN_LIMIT = 6.0
LONG_RUN = 1.0
# Calls are repeated until they have taken this many seconds ...
BUDGET = 0.2
QUICK_BUDGET = 0.05
# ... but not more often than that, not less than that if a call takes no longer than so many
# seconds, and not at all if it takes longer than a part of the limit.
MOST_REPEATS = 25
LEAST_REPEATS = 3
SHORT_CALL = 0.3
LONG_CALL_PART = 0.1

#: What `relative_error` is, for readers of tables.
ERRORS = "of event times relative to max(1, t - t0), of positions to max(1, |x|)"
TIME_KEYS = (
    "prepare_s",
    "first_call_s",
    "times_s",
    "timed_events",
    "us_per_event",
    "floor_ns",
    "over_floor",
)
ERROR_KEYS = ("error", "error_t", "error_x", "missed", "invented", "missed_grazes", "first_wrong")


@dataclass(frozen=True)
class TimeSpan:
    """A scene to time, its number of events, and the exact events to compare with: those before the
    time `until`.
    """

    scene: Scene
    count: int
    reference: Sequence[Event]
    until: float


def prepare(solver: Solver, scene: Scene, tolerance: float) -> None:
    """Call a solver's `prepare` only, so that imports and compilation are done before timing."""
    floor_s()
    follow = solver.prepare(scene, tolerance)
    if solver == OURS[0]:
        follow()  # numba compiles our event loop when it is first called


class SolverRun(NamedTuple):
    """What `measure` measures: seconds of the preparation, of the first call and of its repeats,
    those of one closed-form evaluation right after each repeat (some machines change their pace by
    the second), and the events.
    """

    prepared: float
    first_call: float
    repeats: list[float]
    floors: list[float]
    events: list[SolverEvent]


def measure(
    solver: Solver, scene: Scene, tolerance: float, until: float, limit: float, budget: float
) -> SolverRun:
    """Measure a solver on a scene, with its events up to `until`.

    The solver is called again until `budget` seconds are spent, unless one call takes a large part
    of `limit`.
    """
    # Only what the call itself does is timed: the events are read afterwards, and an iterator makes
    # objects of them only then.
    begin = time.perf_counter()
    follow = solver.prepare(scene, tolerance)
    prepared = time.perf_counter()
    events = follow()
    first_call = time.perf_counter() - prepared
    if first_call > LONG_CALL_PART * limit:
        least_repeats = 0
    elif first_call > SHORT_CALL:
        least_repeats = 1
    else:
        least_repeats = LEAST_REPEATS
    if least_repeats:
        floors = []
    else:
        floors = [floor_s()]  # that of the first call
    repeats = list[float]()

    def goes_on() -> bool:
        if len(repeats) < least_repeats:
            return True
        has_budget = sum(repeats) < budget and len(repeats) < MOST_REPEATS
        return least_repeats > 0 and has_budget

    while goes_on():
        repeat_begin = time.perf_counter()
        events = follow()
        repeats.append(time.perf_counter() - repeat_begin)
        floors.append(floor_s())
    # An event at nan is kept: it is a fault of the solver.
    events_shown = [event for event in events if not event.t > until]
    return SolverRun(prepared - begin, first_call, repeats, floors, events_shown)


def run(
    quick: bool = False,
    progress: Progress = iter,
    solvers: Sequence[Solver] | None = None,
    scenes: dict[str, tuple[int, int, int]] | None = None,
) -> Record:
    """Return times and errors of solvers on scenes (see SCENE_SPANS) as plain data.

    `quick`: fewer scenes and runs.
    """
    # `solvers` and `scenes` replace all; the numbers of a scene are the events of the short span,
    # those to compare in the long span, and the events of the long span, as in SCENE_SPANS. Keys:
    # machine; floor_ns, one closed-form evaluation; limit_s; skipped, solver: why it cannot run;
    # notes, solver: its precautions; rows, one per scene, solver and tolerance, with
    #     scene, solver, tolerance;
    #     failure: "" or what went wrong; the numbers that are then not known are None;
    #     prepare_s, first_call_s, times_s (all repeats), timed_events: of the longest span that the
    #         solver finished;
    #     floor_ns, over_floor: the floor as it was then (the best), and the median time per event
    #         as its multiple;
    #     us_per_event: so many floors, as long as the best one of the run; over_ours: that by ours;
    #     error, error_t, error_x: over the short span, the same for all solvers, as in `compare`;
    #     missed, invented, missed_grazes, first_wrong: as in `compare`, over the first `compared`
    #         events of the longest span;
    #     warnings: what the solver warned of.
    if solvers is None:
        solvers = all_solvers()
    if quick:
        limit = QUICK_SPAN_LIMIT
        budget = QUICK_BUDGET
    else:
        limit = SPAN_LIMIT
        budget = BUDGET
    if scenes:
        chosen = scenes
    elif quick:
        chosen = QUICK_SCENE_SPANS
    else:
        chosen = SCENE_SPANS
    able = [solver for solver in solvers if not solver.missing]
    tolerances = {solver: solver.tolerances for solver in able}
    if quick:
        # Of all solvers but ours only the tightest tolerance.
        for solver in able:
            if solver != OURS[0]:
                tolerances[solver] = solver.tolerances[-1:]
    plan = [
        (name, solver, tolerance)
        for name in chosen
        for solver in able
        for tolerance in tolerances[solver]
    ]
    spans: dict[str, tuple[TimeSpan, TimeSpan]] = {}  # of the scenes that had their turn
    rows: list[Record] = []
    with Worker() as worker:

        def call(solver: Solver, tolerance: float, span: TimeSpan) -> Outcome:
            worker.warm(solver.name, prepare, solver, span.scene, tolerance)
            return worker.call(
                limit, measure, solver, span.scene, tolerance, span.until, limit, budget
            )

        for name, solver, tolerance in progress(plan):
            if name not in spans:
                spans[name] = _spans(load_scene(name), *chosen[name])
            row = {"scene": name, "solver": solver.name, "tolerance": tolerance}
            rows.append(row | _measured(partial(call, solver, tolerance), *spans[name]))
    unit = min((row["floor_ns"] for row in rows if row["floor_ns"]), default=nan)
    _add_times_per_event(rows, unit)
    return {
        "machine": machine(),
        "floor_ns": unit,
        "limit_s": limit,
        "skipped": {solver.name: solver.missing for solver in solvers if solver.missing},
        "notes": {solver.name: solver.note for solver in able if solver.note},
        "rows": rows,
    }


def _add_times_per_event(rows: list[Record], unit: float) -> None:
    """Add to each row its time per event: as a multiple of ours, and in microseconds, for a machine
    on which the floor takes `unit` nanoseconds.
    """
    # A machine may be half as fast in one minute as in the next, so seconds of different minutes do
    # not compare: times are in units of the floor of their moment.
    ours = {row["scene"]: row["over_floor"] for row in rows if row["solver"] == OURS[0].name}
    for row in rows:
        over_floor = row["over_floor"]
        of_ours = ours.get(row["scene"])
        row["over_ours"] = None
        row["us_per_event"] = None
        if over_floor and of_ours:
            row["over_ours"] = over_floor / of_ours
        if over_floor:
            row["us_per_event"] = 1e-3 * unit * over_floor


def _spans(scene: Scene, short: int, compared: int, long: int) -> tuple[TimeSpan, TimeSpan]:
    """Return a scene cut off after `short` events, and cut off after `long` events.

    The first is compared as a whole, of the second only the first `compared` events.
    """
    far = scene.t0 + 10**6  # never reached: the number of events ends the motion

    def until(events: Sequence[Event], number: int) -> float:
        """Return the time halfway between the event `number`, from 1, and the next one."""
        return (float(events[number - 1].t) + float(events[number].t)) / 2

    def span(count: int, compared: int) -> TimeSpan:
        end = until(simulate(scene, t_end=far, max_events=count + 1).events, count)
        exact = simulate(scene, t_end=far, max_events=compared + 1, digits=REFERENCE_DIGITS).events
        cut = replace(scene, t_end=read_exact("t_end", end))
        return TimeSpan(cut, count, exact[:compared], until(exact, compared))

    first = span(short, short)
    if short == long:
        return first, first
    return first, span(long, compared)


def _measured(call: Callable[[TimeSpan], Outcome], short: TimeSpan, long: TimeSpan) -> Record:
    """Measure a solver on the short span and, if it is fast, on the long one.

    Return its times, errors and failure.
    """
    outcome = call(short)
    row = _row_numbers(outcome, short)
    failure = outcome.failure
    warnings = outcome.warnings
    if long is not short and not failure and row["us_per_event"] * long.count < 1e6 * LONG_RUN:
        longer = call(long)
        if longer.failure:
            failure = f"{longer.failure} (in {long.count} events, not in {short.count})"
        else:
            row |= {
                name: value
                for name, value in _row_numbers(longer, long).items()
                if not name.startswith("error")
            }
        warnings = tuple(dict.fromkeys((*warnings, *longer.warnings)))
    return row | {"failure": failure, "warnings": list(warnings)}


def _row_numbers(outcome: Outcome, span: TimeSpan) -> Record:
    """Return a solver's times on a span and its errors against the reference; None in each after a
    failure.
    """
    about = {"compared": len(span.reference)}
    if outcome.failure:
        return about | dict.fromkeys((*TIME_KEYS, *ERROR_KEYS))
    run: SolverRun = outcome.value
    times = run.repeats or [run.first_call]
    count = span.count
    ratios = [seconds / floor for seconds, floor in zip(times, run.floors, strict=True)]
    values = (
        run.prepared,
        run.first_call,
        run.repeats,
        count,
        1e6 / count * median(times),
        1e9 * min(run.floors),
        median(ratios) / count,
    )
    return (
        about
        | dict(zip(TIME_KEYS, values, strict=True))
        | compare(run.events, span.scene, span.reference)
    )


def compare(events: Sequence[SolverEvent], scene: Scene, exact: Sequence[Event]) -> Record:
    """Compare a solver's events with the exact ones of a scene: largest errors, and how many are
    missed or invented.
    """
    # Keys: error_t, error_x, error (the larger one; None if nothing can be compared), missed and
    # invented (numbers), missed_grazes (which do not count as missed), and first_wrong (the time of
    # the first missed or invented event).
    finite = [event for event in events if isfinite(event.t) and isfinite(event.x)]
    theirs = sorted(finite, key=lambda event: event.t)
    matching = match_events(theirs, exact, WINDOW * 2 * pi / float(scene.parameters.Omega))
    errors_t = []
    errors_x = []
    for j, i in matching.matched:
        errors_t.append(relative_error(theirs[j].t, exact[i].t, float(scene.t0)))
        errors_x.append(relative_error(theirs[j].x, exact[i].x))
    missed = [float(exact[i].t) for i in matching.missed if exact[i].kind != "graze"]
    invented = [theirs[j].t for j in matching.invented]
    return {
        "error": max(errors_t + errors_x, default=None),
        "error_t": max(errors_t, default=None),
        "error_x": max(errors_x, default=None),
        "missed": len(missed),
        "invented": len(events) - len(matching.matched),
        "missed_grazes": len(matching.missed) - len(missed),
        "first_wrong": min(missed + invented, default=None),
    }


# -- tables ----------------------------------------------------------------------------------------


def table(result: Record, markdown: bool = False) -> str:
    """Return the result of `run` as text: a table per scene, with each solver's times, largest
    error and failures.
    """
    heads = ["solver", "tolerance", "time / ours", "us per event", "error"]
    heads += ["events", "missed", "invented", "what went wrong"]
    align = ("left", *["right"] * 7, "left")
    form = "github" if markdown else "simple"
    parts = []
    for scene in dict.fromkeys(row["scene"] for row in result["rows"]):
        rows = [_cells(row, result["limit_s"]) for row in result["rows"] if row["scene"] == scene]
        title = f"**{scene}**\n" if markdown else f"{scene}:"
        text = tabulate(rows, heads, tablefmt=form, disable_numparse=True, colalign=align)
        parts += [title, text, ""]
    parts += [_measurement_note(result), ""]
    notes = dict(result["notes"])
    for name, reason in result["skipped"].items():
        notes[name] = f"skipped, {reason}"
    bullet = "- " if markdown else ""
    parts += [f"{bullet}{name}: {note}" for name, note in notes.items()]
    return "\n".join(parts)


def _measurement_note(result: Record) -> str:
    """Return how times and errors are measured, in one line of text."""
    return (
        "Times are measured in evaluations of the closed form, timed right after each call, and "
        f"given at the {result['floor_ns']:.1f} ns that the fastest one took: a machine may change "
        "its pace. A call follows 10,000 events if it goes on so for less than a second, else 24, "
        "of fig8 20, and what it costs itself is included. "
        f"Errors are {ERRORS}, against {REFERENCE_DIGITS} digits."
    )


def _cells(row: Record, limit: float) -> list[str]:
    """Format a row of the results as cells of a table.

    `limit` is the number of seconds to name where a solver hung.
    """

    def text(name: str, form: Callable[[Any], str]) -> str:
        if row[name] is None:
            return ""
        return form(row[name])

    tolerance = f"{row['tolerance']:.0e}" if row["tolerance"] else ""
    failure = row["failure"]
    if failure.startswith(HANG):
        failure = failure.replace(HANG, f"hang: more than {limit:g} s", 1)
    return [
        row["solver"],
        tolerance,
        text("over_ours", partial(rounded, digits=3)),
        text("us_per_event", partial(rounded, digits=3)),
        text("error", "{:.1e}".format),
        text("compared", str),
        text("missed", str),
        text("invented", str),
        failure,
    ]


def best_rows(result: Record) -> dict[tuple[str, str], Record]:
    """Return for each solver and scene the row with the fewest missed and invented events, then the
    smallest error.
    """
    # A solver that failed at every tolerance is there with its last row.

    def badness(row: Record) -> tuple[float, ...]:
        if row["missed"] is None:
            return inf, inf
        wrong = row["missed"] + row["invented"]
        if row["error"] is None:
            return wrong, inf
        return wrong, row["error"]

    best: dict[tuple[str, str], Record] = {}
    for row in result["rows"]:
        key = row["solver"], row["scene"]
        best[key] = min(row, best.get(key, row), key=badness)
    return best


def summary(result: Record) -> str:
    """Return a Markdown table of the solvers at their best: time as a multiple of ours, error, and
    what went wrong.
    """
    best = best_rows(result)
    solvers = list(dict.fromkeys(solver for solver, _ in best))
    scenes = list(dict.fromkeys(scene for _, scene in best))
    rows = [[solver, *(_best_text(best[solver, scene]) for scene in scenes)] for solver in solvers]
    return tabulate(rows, ["", *scenes], tablefmt="github", disable_numparse=True)


def _best_text(row: Record) -> str:
    """Return the best row of a solver on a scene as short text, such as "13 ×, 8e-16"."""
    if "chatters" in row["failure"]:
        failure = "chatters"
    else:
        failure, _, _ = row["failure"].partition(":")
    if row["us_per_event"] is None:
        return failure
    parts = []
    if row["over_ours"] is not None:
        parts.append(f"{rounded(row['over_ours'], 2)} ×")
    if row["error"] is not None:
        parts.append(f"{row['error']:.0e}")
    parts += [f"{name} {row[name]}" for name in ("missed", "invented") if row[name]]
    if failure:
        parts.append(failure)
    return ", ".join(parts)


def rounded(value: float, digits: int) -> str:
    """Return a number as text with `digits` significant digits, without exponent between 1e-4 and
    1e6.
    """
    return f"{float(f'{value:.{digits}g}'):g}"


# -- the picture -----------------------------------------------------------------------------------

COLUMNS = 3
#: A colour per library, a mark per method of it.
COLOURS = ("#b2182b", "#2166ac", "#e08214", "#1b7837", "#762a83", "#8c510a")
POINT_MARKS = "os^Dv"
#: What is more exact than this (a double has no more digits) is drawn here, what is worse than the
#: other there.
BEST = 1e-17
WORST = 1.0


def figure(result: Record) -> Figure:
    """Draw the result of `run`: error against time per event, a panel per scene, a curve per
    solver.
    """
    # A cross over a mark: events were missed or invented; no line leads there. Runs that failed
    # have no time; each panel says how many there were.
    scenes = list(dict.fromkeys(row["scene"] for row in result["rows"]))
    styles = _styles(dict.fromkeys(row["solver"] for row in result["rows"]))
    columns = min(COLUMNS, len(scenes) + 1)
    lines = -(-(len(scenes) + 1) // columns)  # one cell is for the legend
    with rc_context(STYLE):
        layout = ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.05)
        drawing = Figure(figsize=(7.2 / COLUMNS * columns, 2.6 * lines), layout=layout)
        grid = drawing.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
        for ax, scene in zip(grid.flat, scenes, strict=False):
            _draw_panel(ax, scene, [row for row in result["rows"] if row["scene"] == scene], styles)
        for ax in grid.flat[len(scenes) :]:
            ax.set_axis_off()
        for ax in grid[:, 0]:
            ax.set_ylabel("largest error")
        for ax in grid.flat:
            ax.tick_params(labelbottom=True)
        drawing.supxlabel("time per event [µs]", fontsize=STYLE["axes.labelsize"])
        handles = [
            Line2D([], [], linewidth=0.7, label=name, **style) for name, style in styles.items()
        ]
        wrong: Record = {"marker": "x", "color": "black", "linestyle": "none", "markersize": 4}
        handles.append(Line2D([], [], label="events missed or invented", **wrong))
        options: Record = {
            "fontsize": 7.0,
            "frameon": False,
            "borderaxespad": 0.0,
            "labelspacing": 0.3,
        }
        grid[-1, -1].legend(handles=handles, loc="upper left", **options)
    return drawing


def _styles(solvers: Iterable[str]) -> dict[str, Record]:
    """Return colour and mark of each solver: a black star for ours, a colour per library for the
    others.
    """
    methods: dict[str, int] = {}
    colours: dict[str, str] = {}
    styles: dict[str, Record] = {}
    for name in solvers:
        library = name.split()[0].rstrip(",")
        number = methods.get(library, 0)
        methods[library] = number + 1
        if library == "symosc":
            marker = "*P"[number % 2]
            styles[name] = {"color": "black", "marker": marker, "markersize": 9 - 3 * number}
        else:
            colour = colours.setdefault(library, COLOURS[len(colours) % len(COLOURS)])
            marker = POINT_MARKS[number % len(POINT_MARKS)]
            styles[name] = {"color": colour, "marker": marker, "markersize": 4}
    return styles


def _draw_panel(ax: Axes, scene: str, rows: Sequence[Record], styles: dict[str, Record]) -> None:
    """Draw the curves of a scene."""

    def points(rows: Sequence[Record]) -> tuple[list[float], list[float]]:
        errors = []
        for row in rows:
            if row["error"] is None:
                errors.append(WORST)
            else:
                errors.append(min(max(row["error"], BEST), WORST))
        return [row["us_per_event"] for row in rows], errors

    for solver in dict.fromkeys(row["solver"] for row in rows):
        style = styles[solver] | {"markeredgewidth": 0.6}
        if solver.startswith("symosc"):
            style["zorder"] = 4
        drawn = [row for row in rows if row["solver"] == solver and row["us_per_event"] is not None]
        right = [row for row in drawn if not row["missed"] and not row["invented"]]
        wrong = [row for row in drawn if row not in right]
        ax.plot(*points(right), linewidth=0.7, **style)
        ax.plot(*points(wrong), **style | {"linestyle": "none"})
        ax.plot(*points(wrong), "x", color="black", markersize=6, markeredgewidth=0.7, zorder=5)
    ax.set(
        xscale="log",
        yscale="log",
        ylim=(BEST / 3, WORST * 3),
        yticks=[10.0**n for n in range(-16, 1, 4)],
    )
    ax.minorticks_off()
    ax.grid(linewidth=0.3, color="0.85")
    ax.set_title(scene, loc="left", pad=4)
    failed = sum(bool(row["failure"]) for row in rows)
    if failed:
        text = f"{failed} run{'s' * (failed > 1)} failed"
        ax.text(0.02, 0.03, text, transform=ax.transAxes, ha="left", va="bottom", fontsize=7)
