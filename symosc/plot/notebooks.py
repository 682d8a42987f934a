"""Notebook pages of the results: a line, a short table, and a small picture if it can be drawn in
milliseconds.

All content is escaped. Colours are those of the notebook, light or dark; no style affects the rest
of the notebook. Figures are what ``.plot()`` is for. One more answer: a function that returns a
page, registered at the end for a class.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields, is_dataclass
from decimal import Decimal
from typing import Any, cast

import numpy as np
from markupsafe import Markup

from symosc.analysis.response import FrequencyResponse
from symosc.base.aliases import Record
from symosc.base.display.drawable import Listing
from symosc.base.display.pages import macros
from symosc.base.exact import show
from symosc.base.quantities import quantity_of, unit_of
from symosc.basins.attractors import Attractors
from symosc.certificates.atlas import Atlas
from symosc.certificates.certificate import Certificate, common_complex, common_digits
from symosc.crosschecks.report import CrossCheck
from symosc.grazing.window import GrazingWindow
from symosc.model import Oscillator
from symosc.orbits.border import Border
from symosc.orbits.branch import Branch
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import START_NAMES, Scene
from symosc.simulation.tables import EventTable, Summary, counted, select_rows, statuses
from symosc.simulation.trajectory import Trajectory
from symosc.words import Word, collapsed

END_NAMES = ("first end", "last end")
HEADS = ("t", "x", "v", "kind", "belt", "from", "to", "t error")
#: Characters of a word that a page shows.
LONGEST_SHOWN = 60
#: Events that have a dot in the picture, at most.
MOST_DOTS = 60
#: Rows of a table that has more: as many at its beginning and at its end.
HEAD_ROWS = 7
TAIL_ROWS = 3
#: Words of a summary, wrong steps of a cross-check that have a dot, and rows of a scene in the left
#: one of its two tables.
MOST_WORDS = 5
MOST_WRONG_STEPS = 20
LEFT_ROWS = 8
#: Size of a small picture, and the margin around what it shows.
PICTURE_WIDTH = 260
PICTURE_HEIGHT = 130
PICTURE_MARGIN = 6
#: Points of a curve, at most.
MOST_POINTS = 600
#: The macros of pages, tables and pictures.
PARTS = "plot/templates/notebook.html.j2"


# -- parts of pages --------------------------------------------------------------------------------


def page(kind: str, line: str, *parts: str) -> Markup:
    """Return the HTML of a notebook page: a bold `kind`, the text `line`, then tables and pictures
    side by side.
    """
    return cast(Markup, macros(PARTS).page(kind, line, parts))


def table(heads: Sequence[str], count: int, row: Callable[[int], Sequence[Any]]) -> Markup:
    """Return an HTML table with headings `heads` and `count` rows row(i), the middle ones left out
    if many, or "".
    """
    if not count:
        return Markup("")
    shown_rows = rows_to_show(count)
    rows = [[shown(value) for value in row(i)] for i in shown_rows]
    left_out = count - len(shown_rows)
    gap = f"{left_out:,}" if left_out else ""
    return cast(Markup, macros(PARTS).table(heads, rows[:HEAD_ROWS], gap, rows[HEAD_ROWS:]))


def rows_to_show(count: int) -> list[int]:
    """Return the numbers of the rows to show of a table of `count` rows: all, or the first and the
    last ones.
    """
    every = range(count)
    if count <= HEAD_ROWS + TAIL_ROWS:
        return list(every)
    return [*every[:HEAD_ROWS], *every[-TAIL_ROWS:]]


def shown(value: Any) -> Any:
    """Return what to show of a value in a cell: a float with ten digits, None as "", anything else
    unchanged.
    """
    if isinstance(value, (float, np.floating)):
        return f"{float(value):.10g}"
    if value is None:
        return ""
    return value


def facts(values: dict[str, Any]) -> Markup:
    """Return an HTML table of names and values, without those that are None."""
    known = {name: shown(value) for name, value in values.items() if value is not None}
    return cast(Markup, macros(PARTS).facts(known))


def curve(says: str, x: Any, y: Any, marks: Iterable[tuple[float, float]] = ()) -> Markup:
    """Return a small SVG picture of a curve, interrupted at NaN, with dots at `marks`.

    "" for fewer than two points.

    `says` describes the picture in words, for screen readers and as a text that appears under the
    mouse.
    """
    x, y = (np.asarray(values, dtype=float) for values in (x, y))
    if len(x) > MOST_POINTS:
        chosen = np.linspace(0, len(x) - 1, MOST_POINTS).astype(int)
        x = x[chosen]
        y = y[chosen]
    known = np.isfinite(x) & np.isfinite(y)
    if known.sum() < 2:
        return Markup("")
    across = _scale(x[known], PICTURE_WIDTH)
    up = _scale(y[known], PICTURE_HEIGHT)
    text = ""
    pen = "M"
    for abscissa, height, is_known in zip(x.tolist(), y.tolist(), known.tolist(), strict=True):
        if is_known:
            # SVG counts y downwards.
            text += f"{pen}{across(abscissa):.1f} {PICTURE_HEIGHT - up(height):.1f}"
            pen = "L"
        else:
            pen = "M"
    dots = [(across(abscissa), PICTURE_HEIGHT - up(height)) for abscissa, height in marks]
    return cast(Markup, macros(PARTS).picture(PICTURE_WIDTH, PICTURE_HEIGHT, says, text, dots))


def _scale(values: np.ndarray, size: int) -> Callable[[float], float]:
    """Return the function that maps values to coordinates in a picture of this size, with room at
    its edges.
    """
    low = float(values.min())
    high = float(values.max())
    middle = low / 2 + high / 2
    extent = high - low
    if extent > 0:
        gain = (size - 2 * PICTURE_MARGIN) / extent
    else:
        gain = 0.0
    return lambda value: size / 2 + (value - middle) * gain


# -- pages -----------------------------------------------------------------------------------------


def trajectory_page(path: Trajectory) -> str:
    """Return the page of a motion: its events, its status, and x against t."""
    begin = float(path.t_start)
    end = float(path.t_end)
    events = path.events

    def row(i: int) -> list[Any]:
        event = events[i]
        numbers: tuple[Any, ...] = (event.t, event.x, event.v)
        texts = [shown(float(n)) if path.digits is None else n.context.nstr(n, 24) for n in numbers]
        return [
            *texts,
            event.kind,
            event.boundary,
            event.source,
            event.target,
            f"{event.t_error:.0e}",
        ]

    times = np.clip(np.linspace(begin, end, MOST_POINTS), begin, end)
    positions, _ = path(times)
    if len(events) <= MOST_DOTS:
        dots = [(float(event.t), float(event.x)) for event in events]
    else:
        dots = []
    drawn = curve(f"x against t, from {begin:g} to {end:g}", times, positions, dots)
    about = facts(
        {"word": collapsed(path.word) or "none", "ended": path.message, "digits": path.digits}
    )
    line = f"t = {begin:g} … {end:g}, {counted(len(events), 'event')}: {path.status}"
    return page("Trajectory", line, table(HEADS, len(events), row), drawn, about)


def events_page(events: EventTable) -> str:
    """Return the page of the events of many motions."""
    names = ("trajectory", "t", "x", "v", "kind", "boundary", "source", "target", "t_error")
    # Only the rows to show are taken out of the table.
    to_show = rows_to_show(len(events))
    chosen = select_rows(events, np.array(to_show, dtype=int), [])

    def row(i: int) -> list[Any]:
        *values, error = (getattr(chosen, name)[to_show.index(i)] for name in names)
        return [*values, f"{error:.0e}"]

    line = f"{counted(len(events), 'event')} of {counted(len(events.status), 'motion')}"
    rows = table(("motion", *HEADS), len(events), row)
    return page("EventTable", line, rows, facts({"ended": statuses(events.status)}))


def summary_page(summary: Summary) -> str:
    """Return the page of a summary: a row for each motion, and the words, most frequent first."""
    columns = {name: column for name, column in summary.columns().items() if name != "section"}
    words = None
    if len(summary.word):
        names, counts = np.unique(summary.word, return_counts=True)
        order = np.argsort(-counts, kind="stable")[:MOST_WORDS]
        words = ", ".join(f"{cut(str(names[i])) or 'no event'} ({counts[i]:,})" for i in order)
        if len(names) > MOST_WORDS:
            words += f", and {len(names) - MOST_WORDS} more"
    if len(summary.status):
        ended = statuses(summary.status)
    else:
        ended = None
    if isinstance(summary.section, np.ndarray):
        points = counted(summary.section.shape[1], "point")
    else:
        points = None
    about = facts({"ended": ended, "words": words, "section": points})
    heads = ["motion", *columns]
    values = list(columns.values())
    rows = table(
        heads, len(summary), lambda i: [i, *(cut(str(shown(column[i]))) for column in values)]
    )
    return page("Summary", counted(len(summary), "motion"), rows, about)


def cut(text: str) -> str:
    """Return text, truncated to `LONGEST_SHOWN` characters."""
    if len(text) <= LONGEST_SHOWN:
        return text
    return f"{text[: LONGEST_SHOWN - 1]}…"


def oscillator_page(oscillator: Oscillator) -> str:
    """Return the page of an oscillator: its belts, its numbers, and the friction force over the
    velocity.
    """
    belts = oscillator.belts

    def row(i: int) -> list[Any]:
        belt = belts[i]
        kinetic = show(belt.mu)
        if belt.curve:
            kinetic = f"curve of {len(belt.curve)} points from {kinetic}"
        return [i + 1, show(belt.v), kinetic, show(belt.mu_s)]

    names = ["m", "c", "k", "A0", "FN"]
    if oscillator.B0 != 0:
        names += ["B0", "Omega"]
    values = {name: show(getattr(oscillator, name)) for name in names}
    heads = ("belt", "v", "kinetic μ", "static μ")
    drawn = curve("friction force against velocity", *friction_curve(oscillator))
    if oscillator.contracts:
        line = f"{counted(len(belts), 'belt')}, no two motions move apart"
    else:
        line = f"{counted(len(belts), 'belt')}, motions may move apart: several may attract"
    return page("Oscillator", line, table(heads, len(belts), row), drawn, facts(values))


def friction_curve(oscillator: Oscillator) -> tuple[list[float], list[float]]:
    """Return velocities and friction forces, with the jump at each belt up to its static friction."""
    edges = oscillator.edges
    first = float(edges[0].v)
    last = float(edges[-1].v)
    beyond = max(last - first, abs(last), abs(first)) / 2 or 1.0
    ends = [first - beyond, *(float(edge.v) for edge in edges), last + beyond]
    excesses = [0.0, *(float(edge.E) for edge in edges), 0.0]
    points = list[tuple[float, float]]()
    for i, band in enumerate(oscillator.bands):
        slope = float(band.c - oscillator.c)
        constant = float(oscillator.A0 - band.A)
        low = ends[i]
        high = ends[i + 1]
        points.append((low, constant + slope * low + excesses[i]))
        points.append((low, constant + slope * low))
        points.append((high, constant + slope * high))
        points.append((high, constant + slope * high - excesses[i + 1]))
    return [speed for speed, _ in points], [force for _, force in points]


def attractors_page(found: Attractors) -> str:
    """Return the page of attractors: their names, periods and shares."""
    periods = [getattr(orbit, "period", None) for orbit in found.orbits]
    rows = [
        [name, f"{share:.4g}", f"{error:.1g}", float(period) if period else None]
        for name, share, error, period in zip(
            found.names, found.share, found.share_error, periods, strict=True
        )
    ]
    heads = ("attractor", "share", "standard error", "period")
    undecided = f"{found.undecided:.4g}" if found.undecided else None
    line = f"{counted(len(found), 'attractor')} of {counted(len(found.starts), 'start')}"
    return page(
        "Attractors",
        line,
        table(heads, len(rows), rows.__getitem__),
        facts({"undecided": undecided}),
    )


def orbit_page(orbit: PeriodicOrbit) -> str:
    """Return the page of a periodic orbit: its switching points, its multipliers, and its loop in
    the phase plane.
    """
    stable = {True: "yes", False: "no", None: "marginal"}[orbit.stable]
    if orbit.is_rest:
        return page("PeriodicOrbit", orbit.message, facts({"stable": stable}))
    rows = [
        [label, shown(float(t)), shown(float(x))]
        for label, (t, x) in zip(orbit.labels, orbit.points, strict=True)
    ]
    begin = float(orbit.start[0])
    x, v = orbit(np.linspace(begin, begin + orbit.span_of_loop, MOST_POINTS))
    belts = [row.start.boundary for row in Word(orbit.labels).maps]
    speeds = [float(orbit.parameters.belt(belt)) for belt in belts]
    dots = [(float(point.x), speed) for point, speed in zip(orbit.points, speeds, strict=True)]
    values = {
        "period": shown(float(orbit.period)),
        "multipliers": ", ".join(complex_text(complex(value)) for value in orbit.multipliers),
        "stable": stable,
        "residual": f"{float(orbit.residual):.1e}",
        "grazing distance": f"{orbit.grazing_distance:.4g}",
        "digits": orbit.digits,
    }
    loop = curve("phase plane: v against x over one period", x, v, dots)
    points = table(("mapping from", "t", "x"), len(rows), rows.__getitem__)
    return page(
        "PeriodicOrbit", f"{orbit.word or 'no belt'}: {orbit.message}", points, loop, facts(values)
    )


def complex_text(value: complex) -> str:
    """Return a complex number as text with six digits, a real one without imaginary part."""
    if value.imag:
        imaginary = f" {'-' if value.imag < 0 else '+'} {abs(value.imag):.6g} i"
    else:
        imaginary = ""
    return f"{value.real:.6g}{imaginary}"


def branch_page(branch: Branch) -> str:
    """Return the page of a branch: some of its points, why it ends, and the position of its first
    switching.
    """
    sizes = np.abs(branch.multipliers).max(axis=1)
    if branch.labels:
        first_points = branch.points[:, 0]  # of each orbit, t and x of its first switching
        about = "x of the first switching"
    else:
        first_points = np.column_stack([0 * branch.values, branch.extents[:, 1]])
        about = "the largest x"
    _, x = first_points.T
    name = branch.parameter
    stable = np.where(branch.stable, "yes", "no")
    marks = [(float(branch.values[i]), float(x[i])) for i in (0, -1)]
    drawn = curve(f"{about} against {name}", branch.values, x, marks)
    ends = [f"{end.kind} at {name} = {end.value:.10g}: {end.message}" for end in branch.ends]
    heads = (name, "t", "x", "largest |multiplier|", "stable")
    rows = table(
        heads,
        len(x),
        lambda i: [branch.values[i], *first_points[i], f"{sizes[i]:.6g}", stable[i]],
    )
    line = f"{branch.word or 'no belt'} in {name}, {len(branch.values)} points"
    return page("Branch", line, rows, drawn, facts(dict(zip(END_NAMES, ends, strict=True))))


def border_page(border: Border) -> str:
    """Return the page of a border: some of its points, its special points, why it ends, and its
    curve.
    """
    first, second = border.parameters

    def point_text(point: Any) -> str:
        first_value, second_value = point.values
        values = f"{first} = {first_value:.10g}, {second} = {second_value:.10g}"
        return f"{point.kind} at {values}: {point.message}"

    heads = (first, second, "error")
    errors = border.errors.max(axis=1)
    points = table(heads, len(border), lambda i: [*border.points[i], f"{errors[i]:.0e}"])
    marks = [(float(x), float(y)) for x, y in (point.values for point in border.special)]
    x, y = border.points.T
    drawn = curve(f"{second} against {first}", x, y, marks)
    about = dict(zip(END_NAMES, map(point_text, border.ends), strict=True))
    about |= {f"special point {i}": point_text(point) for i, point in enumerate(border.special, 1)}
    word, word_beyond = border.words
    kind = border.sliding or border.kind
    line = f"{word} | {word_beyond or 'no word'}: {kind}, {len(border)} points"
    return page("Border", line, points, drawn, facts(about))


def response_page(response: FrequencyResponse) -> str:
    """Return the page of a frequency response: some of its rows, and the amplitude."""
    names = (
        "status",
        "word",
        "amplitude",
        "transmissibility",
        "phase",
        "dissipated",
        "stuck",
        "balance_error",
    )
    heads = [response.name, *(name.replace("_", " ") for name in names)]
    rows = table(
        heads,
        len(response),
        lambda i: [response.values[i], *(shown(getattr(response, name)[i]) for name in names)],
    )
    drawn = curve(f"amplitude against {response.name}", response.values, response.amplitude)
    return page(
        "FrequencyResponse", f"over {response.name}, {counted(len(response), 'value')}", rows, drawn
    )


def atlas_page(atlas: Atlas) -> str:
    """Return the page of an atlas: its words and their shares, and its borders."""
    shares = [
        [region.word or "none found", f"{region.share:.4%}", f"{region.proven:.4%}"]
        for region in atlas.regions
    ]
    lines = [
        [" | ".join(w or "?" for w in border.words), border.sliding or border.kind, len(border)]
        for border in atlas.borders
    ]
    sides = (
        f"{name} = {show(low)} … {show(high)}"
        for name, (low, high) in zip(atlas.over, atlas.range, strict=True)
    )
    regions = table(("word", "share", "proven"), len(shares), shares.__getitem__)
    borders = table(("border", "kind", "points"), len(lines), lines.__getitem__)
    return page(
        "Atlas", f"{', '.join(sides)}: {atlas.proven:.4%} of the area proven", regions, borders
    )


def window_page(window: GrazingWindow) -> str:
    """Return the page of a grazing window: its intervals of phases and its case of the paper's (55)
    to (58).
    """
    rows = [
        ["[" if low_in else "(", low, high, "]" if high_in else ")"]
        for low, high, low_in, high_in in window.intervals
    ]
    values = {
        "case": window.case,
        "γ": str(window.gamma),
        "B₀Ω/m": str(window.amplitude),
        "order": window.order,
    }
    line = (
        f"{window.mapping}: domain {window.place.domain} at belt {window.place.boundary}, Ω t mod "
        "2π"
    )
    if not window.intervals:
        line += ": empty, no phase grazes"
    return page(
        "GrazingWindow",
        line,
        table(("", "from", "to", ""), len(rows), rows.__getitem__),
        facts(values),
    )


def crosscheck_page(check: CrossCheck) -> str:
    """Return the page of a cross-check: its findings, and the samples with the faults marked."""
    wrong_events: list[tuple[str, Any]] = [("missed", event) for event in check.missed]
    wrong_events += [("invented", event) for event in check.invented]
    rows = [
        [verdict, event.kind, event.boundary or "", float(event.t)]
        for verdict, event in wrong_events
    ]
    lines = Markup('<pre style="margin:0;white-space:pre-wrap">{}</pre>').format(check.summary())
    marks = [
        (float(check.t[step]), float(check.x[step]))
        for step in check.wrong_steps[:MOST_WRONG_STEPS].tolist()
    ]
    drawn = curve("the samples' x against t; dots are wrong steps", check.t, check.x, marks)
    line = f"{'ok' if check.ok else 'FAILED'}, {len(check.t):,} samples"
    return page(
        "CrossCheck",
        line,
        table(("", "kind", "belt", "t"), len(rows), rows.__getitem__),
        drawn,
        lines,
    )


def certificate_page(certificate: Certificate) -> str:
    """Return the page of a certificate: the proven statement, and the enclosures."""

    def row(i: int) -> list[Any]:
        kind, source, target, *enclosures = certificate.events[i]  # of a branch without enclosures
        widths = (f"{float(Decimal(high) - Decimal(low)):.0e}" for low, high in enclosures)
        return [kind, source, target, *(common_digits(*ends) for ends in enclosures), *widths]

    count = len(certificate.events)
    heads = ["kind", "from", "to", "t", "x", "width of t", "width of x"]
    heads = heads[: len(row(0)) if count else 0]  # a branch has no enclosures
    about: Record = {
        f"multiplier {i}": common_complex(*multiplier)
        for i, multiplier in enumerate(certificate.multipliers, 1)
    }
    about["stable"] = {True: "yes", False: "no", None: None}[certificate.stable]
    about |= {
        name: certificate.statement.get(key)
        for name, key in (("made by", "made_by"), ("map", "map"))
    }
    line = (
        f"{certificate.kind}, {'proven' if certificate.proven else 'not proven'}: "
        f"{certificate.message}"
    )
    return page("Certificate", line, table(heads, count, row), facts(about))


def scene_page(scene: Scene) -> str:
    """Return the page of a scene: its numbers with their meaning and unit."""
    numbers = scene.parameters.as_dict() | {
        name: show(getattr(scene, name)) for name in START_NAMES
    }
    rows = [
        [name, value, quantity_of(name).meaning, unit_of(name)] for name, value in numbers.items()
    ]
    error = scene.start_error and ", ".join(f"{float(number):.1g}" for number in scene.start_error)
    if scene.original:
        model = repr(scene.original.model)
    else:
        model = None
    about = {
        "source": scene.source,
        "structure": scene.structure,
        "t0, x0, v0 known to": error,
        "of the model": model,
    }
    about = {name: cut(text) if text else None for name, text in about.items()}
    heads = ("", "value", "meaning", "unit in SI")
    tables = (
        table(heads, len(half), half.__getitem__) for half in (rows[:LEFT_ROWS], rows[LEFT_ROWS:])
    )
    return page("Scene", scene.name, *tables, facts(about))


def listing_page(listing: Listing[Any]) -> str | None:
    """Return the page of a long tuple of records, such as events, a row for each; None if it holds
    other things.
    """
    if not (listing and is_dataclass(listing[0])):
        return None
    heads = [field.name for field in fields(listing[0])]

    def row(i: int) -> list[str]:
        values = ((name, getattr(listing[i], name)) for name in heads)
        return [
            f"{value:.0e}" if name.endswith("_error") else str(shown(value))
            for name, value in values
        ]

    return page(
        f"{type(listing[0]).__name__}s", f"{len(listing):,}", table(heads, len(listing), row)
    )


#: What makes the page of the results of a class.
PAGES: dict[type, Callable[..., str | None]] = {
    Scene: scene_page,
    Oscillator: oscillator_page,
    Attractors: attractors_page,
    Listing: listing_page,
    Trajectory: trajectory_page,
    EventTable: events_page,
    Summary: summary_page,
    PeriodicOrbit: orbit_page,
    Branch: branch_page,
    Border: border_page,
    FrequencyResponse: response_page,
    Atlas: atlas_page,
    GrazingWindow: window_page,
    CrossCheck: crosscheck_page,
    Certificate: certificate_page,
}


def page_of(result: object) -> str | None:
    """Return the page of a result; None if its class has none."""
    for kind in type(result).__mro__:
        if kind in PAGES:
            return PAGES[kind](result)
    return None
