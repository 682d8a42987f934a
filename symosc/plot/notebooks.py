"""Notebook pages of the results: a line, a short table, and a small picture where it takes milliseconds.

It draws with nothing but `symosc.display.html`; figures are what ``.plot()`` is for. One more answer: a function that
returns a page, registered at the end for its class.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from decimal import Decimal
from typing import Any

import numpy as np
from markupsafe import Markup

from symosc.aliases import Record
from symosc.certificates.atlas import Atlas
from symosc.certificates.certificate import Certificate, common_complex, common_digits
from symosc.crosschecks.report import CrossCheck
from symosc.display.drawable import Listing, register
from symosc.display.html import MOST_POINTS, curve, ends, facts, page, shown, table
from symosc.exact import show
from symosc.grazing.window import GrazingWindow
from symosc.orbits.border import Border
from symosc.orbits.branch import Branch
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.quantities import QUANTITIES, unit_of
from symosc.response import FrequencyResponse
from symosc.scenes import START_NAMES, Scene
from symosc.simulation.tables import EventTable, Summary, counted, select_rows, statuses
from symosc.simulation.trajectory import Trajectory
from symosc.words import collapsed

END_NAMES = ("first end", "last end")
HEADS = ("t", "x", "v", "kind", "belt", "from", "to", "t error")
#: Characters of a word that a page shows.
LONGEST_SHOWN = 60
#: Events that have a dot in the picture, at most.
MOST_DOTS = 60


def listed(heads: Sequence[str], count: int, row: Callable[[int], Sequence[Any]]) -> str:
    """Return a table of `count` rows by number, the middle of a long one left out; "" if there is none."""
    return table(heads, [row(i) for i in ends(count)], count) if count else ""


def trajectory_page(path: Trajectory) -> str:
    """Return the page of a motion: its events, its status, and x against t."""
    begin, end, events = float(path.t_start), float(path.t_end), path.events

    def row(i: int) -> list[Any]:
        event = events[i]
        numbers: tuple[Any, ...] = (event.t, event.x, event.v)
        texts = [shown(float(n)) if path.digits is None else n.context.nstr(n, 24) for n in numbers]
        return [*texts, event.kind, event.boundary, event.source, event.target, f"{event.t_error:.0e}"]

    times = np.clip(np.linspace(begin, end, MOST_POINTS), begin, end)
    dots = [(float(event.t), float(event.x)) for event in events] if len(events) <= MOST_DOTS else []
    drawn = curve(f"x against t, from {begin:g} to {end:g}", times, path(times)[0], dots)
    about = facts({"word": collapsed(path.word) or "none", "ended": path.message, "digits": path.digits})
    line = f"t = {begin:g} … {end:g}, {counted(len(events), 'event')}: {path.status}"
    return page("Trajectory", line, listed(HEADS, len(events), row), drawn, about)


def events_page(events: EventTable) -> str:
    """Return the page of the events of many motions."""
    names = ("trajectory", "t", "x", "v", "kind", "boundary", "source", "target", "t_error")
    few = select_rows(events, np.array(ends(len(events)), dtype=int), [])
    rows = [[*row[:-1], f"{row[-1]:.0e}"] for row in zip(*(getattr(few, name) for name in names), strict=True)]
    line = f"{counted(len(events), 'event')} of {counted(len(events.status), 'motion')}"
    found = table(("motion", *HEADS), rows, len(events)) if rows else ""
    return page("EventTable", line, found, facts({"ended": statuses(events.status)}))


def summary_page(summary: Summary) -> str:
    """Return the page of a summary: a row for each motion, and the words, most frequent first."""
    columns = {name: column for name, column in summary.columns().items() if name != "section"}
    rows = [[i, *(cut(str(shown(column[i]))) for column in columns.values())] for i in ends(len(summary))]
    words = None
    if len(summary.word):
        names, counts = np.unique(summary.word, return_counts=True)
        order = np.argsort(-counts, kind="stable")[:5]
        words = ", ".join(f"{cut(str(names[i])) or 'no event'} ({counts[i]:,})" for i in order)
        words += f", and {len(names) - 5} more" if len(names) > 5 else ""
    ended = statuses(summary.status) if len(summary.status) else None
    kept = counted(summary.section.shape[1], "point") if isinstance(summary.section, np.ndarray) else None
    about = facts({"ended": ended, "words": words, "section": kept})
    return page("Summary", counted(len(summary), "motion"), table(["motion", *columns], rows, len(summary)), about)


def cut(text: str) -> str:
    """Return text, truncated to the width of a page."""
    return text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 1]}…"


def orbit_page(orbit: PeriodicOrbit) -> str:
    """Return the page of a periodic orbit: its switching points, its multipliers, and its loop in the phase plane."""
    rows = [[label, shown(float(t)), shown(float(x))] for label, (t, x) in zip(orbit.labels, orbit.points, strict=True)]
    begin = float(orbit.points[0].t)
    x, v = orbit(np.linspace(begin, begin + float(orbit.period), MOST_POINTS))
    speeds = [float(orbit.parameters.belt(piece.start)) for piece in orbit.equations().pieces]
    dots = [(float(point.x), speed) for point, speed in zip(orbit.points, speeds, strict=True)]
    values = {
        "period": shown(float(orbit.period)),
        "multipliers": ", ".join(complex_text(complex(value)) for value in orbit.multipliers),
        "stable": {True: "yes", False: "no", None: "marginal"}[orbit.stable],
        "residual": f"{float(orbit.residual):.1e}",
        "grazing distance": f"{orbit.grazing_distance:.4g}",
        "digits": orbit.digits,
    }
    loop = curve("phase plane: v against x over one period", x, v, dots)
    points = table(("mapping from", "t", "x"), rows)
    return page("PeriodicOrbit", f"{orbit.word}: {orbit.message}", points, loop, facts(values))


def complex_text(value: complex) -> str:
    """Return a complex number with six digits, a real one without imaginary part."""
    imaginary = f" {'-' if value.imag < 0 else '+'} {abs(value.imag):.6g} i" if value.imag else ""
    return f"{value.real:.6g}{imaginary}"


def branch_page(branch: Branch) -> str:
    """Return the page of a branch: some of its points, why it ends, and the position of its first switching."""
    sizes, x, name = np.abs(branch.multipliers).max(axis=1), branch.points[:, 0, 1], branch.parameter

    def row(i: int) -> list[Any]:
        return [branch.values[i], *branch.points[i, 0], f"{sizes[i]:.6g}", "yes" if branch.stable[i] else "no"]

    marks = [(float(branch.values[i]), float(x[i])) for i in (0, -1)]
    drawn = curve(f"x of the first switching against {name}", branch.values, x, marks)
    ends = [f"{end.kind} at {name} = {end.value:.10g}: {end.message}" for end in branch.ends]
    points = listed((name, "t", "x", "largest |multiplier|", "stable"), len(branch.values), row)
    line = f"{branch.word} in {name}, {len(branch.values)} points"
    return page("Branch", line, points, drawn, facts(dict(zip(END_NAMES, ends, strict=True))))


def border_page(border: Border) -> str:
    """Return the page of a border: some of its points, its special points, why it ends, and its curve."""
    first, second = border.parameters

    def where(point: Any) -> str:
        at = f"{first} = {point.values[0]:.10g}, {second} = {point.values[1]:.10g}"
        return f"{point.kind} at {at}: {point.message}"

    points = listed(
        (first, second, "error"), len(border), lambda i: [*border.points[i], f"{border.errors[i].max():.0e}"]
    )
    marks = [(float(point.values[0]), float(point.values[1])) for point in border.special]
    drawn = curve(f"{second} against {first}", border.points[:, 0], border.points[:, 1], marks)
    about = dict(zip(END_NAMES, map(where, border.ends), strict=True))
    about |= {f"special point {i}": where(point) for i, point in enumerate(border.special, 1)}
    line = f"{border.words[0]} | {border.words[1] or 'no word'}: {border.sliding or border.kind}, {len(border)} points"
    return page("Border", line, points, drawn, facts(about))


def response_page(found: FrequencyResponse) -> str:
    """Return the page of a frequency response: some of its rows, and the amplitude."""
    names = ("status", "word", "amplitude", "transmissibility", "phase", "dissipated", "stuck", "balance_error")
    heads = [found.name, *(name.replace("_", " ") for name in names)]
    rows = listed(heads, len(found), lambda i: [found.values[i], *(shown(getattr(found, name)[i]) for name in names)])
    drawn = curve(f"amplitude against {found.name}", found.values, found.amplitude)
    return page("FrequencyResponse", f"over {found.name}, {counted(len(found), 'value')}", rows, drawn)


def atlas_page(atlas: Atlas) -> str:
    """Return the page of an atlas: its words and their shares, and its borders."""

    def region(i: int) -> list[Any]:
        each = atlas.regions[i]
        return [each.word or "none found", f"{each.share:.4%}", f"{each.proven:.4%}"]

    def border(i: int) -> list[Any]:
        each = atlas.borders[i]
        return [" | ".join(word or "?" for word in each.words), each.sliding or each.kind, len(each)]

    sides = (f"{name} = {show(low)} … {show(high)}" for name, (low, high) in zip(atlas.over, atlas.range, strict=True))
    regions = listed(("word", "share", "proven"), len(atlas.regions), region)
    borders = listed(("border", "kind", "points"), len(atlas.borders), border)
    return page("Atlas", f"{', '.join(sides)}: {atlas.proven:.4%} of the area proven", regions, borders)


def window_page(window: GrazingWindow) -> str:
    """Return the page of a grazing window: its intervals and its case."""

    def row(i: int) -> list[Any]:
        low, high, low_closed, high_closed = window.intervals[i]
        return ["[" if low_closed else "(", low, high, "]" if high_closed else ")"]

    values = {"case": window.case, "γ": str(window.gamma), "B₀Ω/m": str(window.amplitude), "order": window.order}
    line = f"{window.mapping}: domain {window.place.domain} at belt {window.place.boundary}, Ω t mod 2π"
    line += "" if window.intervals else ": empty, no phase grazes"
    return page("GrazingWindow", line, listed(("", "from", "to", ""), len(window.intervals), row), facts(values))


def crosscheck_page(check: CrossCheck) -> str:
    """Return the page of a cross-check: its findings, and the samples with the faults marked."""
    strange = [("missed", event) for event in check.missed] + [("invented", event) for event in check.invented]
    rows = [[what, event.kind, event.boundary or "", float(event.t)] for what, event in strange]
    lines = Markup('<pre style="margin:0;white-space:pre-wrap">{}</pre>').format(check.summary())
    marks = [(float(check.t[step]), float(check.x[step])) for step in check.wrong_steps[:20].tolist()]
    drawn = curve("the samples' x against t; dots are wrong steps", check.t, check.x, marks)
    line = f"{'ok' if check.ok else 'FAILED'}, {len(check.t):,} samples"
    return page("CrossCheck", line, table(("", "kind", "belt", "t"), rows) if rows else "", drawn, lines)


def certificate_page(certificate: Certificate) -> str:
    """Return the page of a certificate: the proven statement, and the enclosures."""

    def row(i: int) -> list[Any]:
        kind, source, target, *enclosures = certificate.events[i]  # of a branch without enclosures
        widths = (f"{float(Decimal(high) - Decimal(low)):.0e}" for low, high in enclosures)
        return [kind, source, target, *(common_digits(*each) for each in enclosures), *widths]

    count = len(certificate.events)
    heads = ("kind", "from", "to", "t", "x", "width of t", "width of x")[: len(row(0)) if count else 0]
    about: Record = {f"multiplier {i}": common_complex(*each) for i, each in enumerate(certificate.multipliers, 1)}
    about["stable"] = {True: "yes", False: "no", None: None}[certificate.stable]
    about |= {name: certificate.statement.get(key) for name, key in (("made by", "made_by"), ("map", "map"))}
    line = f"{certificate.kind}, {'proven' if certificate.proven else 'not proven'}: {certificate.message}"
    return page("Certificate", line, listed(heads, count, row), facts(about))


def scene_page(scene: Scene) -> str:
    """Return the page of a scene: its numbers with their meaning and unit."""
    numbers = scene.parameters.as_dict() | {name: show(getattr(scene, name)) for name in START_NAMES}
    rows = [[name, value, QUANTITIES[name].meaning, unit_of(name)] for name, value in numbers.items()]
    error = scene.start_error and ", ".join(f"{float(each):.1g}" for each in scene.start_error)
    model = repr(scene.original.model) if scene.original else None
    about = {"source": scene.source, "structure": scene.structure, "t0, x0, v0 known to": error, "of the model": model}
    about = {name: cut(each) if each else None for name, each in about.items()}
    heads = ("", "value", "meaning", "unit in SI")
    return page("Scene", scene.name, table(heads, rows[:8]), table(heads, rows[8:]), facts(about))


def listing_page(listing: Listing[Any]) -> str | None:
    """Return the page of a long tuple of records, such as events: a row each; None for other entries."""
    if not (listing and is_dataclass(listing[0])):
        return None
    heads = [each.name for each in fields(listing[0])]

    def row(i: int) -> list[str]:
        values = ((name, getattr(listing[i], name)) for name in heads)
        return [f"{value:.0e}" if name.endswith("_error") else str(shown(value)) for name, value in values]

    return page(f"{type(listing[0]).__name__}s", f"{len(listing):,}", listed(heads, len(listing), row))


PAGES: dict[type, Callable[..., str | None]] = {
    Scene: scene_page,
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
for _kind, _page in PAGES.items():
    register(_kind, _page, "page")
