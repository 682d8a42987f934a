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

HEADS = ("t", "x", "v", "kind", "belt", "from", "to", "t error")
#: Characters of a word that a page shows.
LONGEST_SHOWN = 60
#: Events that have a dot in the picture, at most.
MOST_DOTS = 60


def trajectory_page(path: Trajectory) -> str:
    """Return the page of a motion: its events, its status, and x against t."""
    begin, end = float(path.t_start), float(path.t_end)
    line = f"t = {begin:g} … {end:g}, {counted(len(path.events), 'event')}: {path.status}"
    rows = []
    for event in (path.events[i] for i in ends(len(path.events))):
        numbers: tuple[Any, ...] = (event.t, event.x, event.v)
        texts = [shown(float(n)) if path.digits is None else n.context.nstr(n, 24) for n in numbers]
        rows.append([*texts, event.kind, event.boundary, event.source, event.target, f"{event.t_error:.0e}"])
    times = np.clip(np.linspace(begin, end, MOST_POINTS), begin, end)
    dots = [(float(event.t), float(event.x)) for event in path.events] if len(path.events) <= MOST_DOTS else []
    drawn = curve(f"x against t, from {begin:g} to {end:g}", times, path(times)[0], dots)
    about = facts({"word": collapsed(path.word) or "none", "ended": path.message, "digits": path.digits})
    return page("Trajectory", line, _table(HEADS, rows, len(path.events)), drawn, about)


def _table(heads: Sequence[str], rows: list[list[Any]], count: int | None = None) -> str:
    """Return a table, or "" without rows."""
    return table(heads, rows, count) if rows else ""


def events_page(events: EventTable) -> str:
    """Return the page of the events of many motions."""
    heads = ("motion", *HEADS)
    names = ("trajectory", "t", "x", "v", "kind", "boundary", "source", "target", "t_error")
    some = np.array(ends(len(events)), dtype=int)
    few = select_rows(events, some, [])
    columns = [getattr(few, name) for name in names]
    rows = [[*row[:-1], f"{row[-1]:.0e}"] for row in zip(*columns, strict=True)]
    line = f"{counted(len(events), 'event')} of {counted(len(events.status), 'motion')}"
    return page("EventTable", line, _table(heads, rows, len(events)), facts({"ended": statuses(events.status)}))


def summary_page(summary: Summary) -> str:
    """Return the page of a summary: a row for each motion, and the words, most frequent first."""
    columns = {name: column for name, column in summary.columns().items() if name != "section"}
    some = ends(len(summary))
    rows = [[i, *(cut(str(shown(column[i]))) for column in columns.values())] for i in some]
    ended = statuses(summary.status) if len(summary.status) else None
    kept = counted(summary.section.shape[1], "point") if isinstance(summary.section, np.ndarray) else None
    about = facts({"ended": ended, "words": _frequent(summary.word), "section": kept})
    return page("Summary", counted(len(summary), "motion"), table(["motion", *columns], rows, len(summary)), about)


def _frequent(words: Any) -> str | None:
    """Return the most frequent words with their counts."""
    if not len(words):
        return None
    names, counts = np.unique(words, return_counts=True)
    order = np.argsort(-counts, kind="stable")[:5]
    more = f", and {len(names) - 5} more" if len(names) > 5 else ""
    said = (f"{cut(str(names[i])) or 'no event'} ({counts[i]:,})" for i in order)
    return ", ".join(said) + more


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
    loop = curve("phase plane: v against x over one period", x, v, dots)
    values = {
        "period": shown(float(orbit.period)),
        "multipliers": ", ".join(complex_text(complex(value)) for value in orbit.multipliers),
        "stable": {True: "yes", False: "no", None: "marginal"}[orbit.stable],
        "residual": f"{float(orbit.residual):.1e}",
        "grazing distance": f"{orbit.grazing_distance:.4g}",
        "digits": orbit.digits,
    }
    heads = ("mapping from", "t", "x")
    return page("PeriodicOrbit", f"{orbit.word}: {orbit.message}", table(heads, rows), loop, facts(values))


def complex_text(value: complex) -> str:
    """Return a complex number with six digits, a real one without imaginary part."""
    if value.imag == 0:
        return f"{value.real:.6g}"
    return f"{value.real:.6g} {'-' if value.imag < 0 else '+'} {abs(value.imag):.6g} i"


def branch_page(branch: Branch) -> str:
    """Return the page of a branch: some of its points, why it ends, and the position of its first switching."""
    sizes = np.abs(branch.multipliers).max(axis=1)
    rows = [
        [branch.values[i], *branch.points[i, 0], f"{sizes[i]:.6g}", "yes" if branch.stable[i] else "no"]
        for i in ends(len(branch.values))
    ]
    x = branch.points[:, 0, 1]
    marks = [(float(branch.values[i]), float(x[i])) for i in (0, -1)]
    drawn = curve(f"x of the first switching against {branch.parameter}", branch.values, x, marks)
    reasons = {
        f"{side} end": f"{end.kind} at {branch.parameter} = {end.value:.10g}: {end.message}"
        for side, end in zip(("first", "last"), branch.ends, strict=True)
    }
    line = f"{branch.word} in {branch.parameter}, {len(branch.values)} points"
    heads = (branch.parameter, "t", "x", "largest |multiplier|", "stable")
    return page("Branch", line, table(heads, rows, len(branch.values)), drawn, facts(reasons))


def border_page(border: Border) -> str:
    """Return the page of a border: some of its points, its special points, why it ends, and its curve."""
    first, second = border.parameters
    rows = [[*border.points[i], f"{border.errors[i].max():.0e}"] for i in ends(len(border))]
    marks = [(float(point.values[0]), float(point.values[1])) for point in border.special]
    drawn = curve(f"{second} against {first}", border.points[:, 0], border.points[:, 1], marks)
    about = {
        f"{side} end": f"{end.kind} at {first} = {end.values[0]:.10g}, {second} = {end.values[1]:.10g}: {end.message}"
        for side, end in zip(("first", "last"), border.ends, strict=True)
    }
    for i, point in enumerate(border.special):
        where = f"{first} = {point.values[0]:.10g}, {second} = {point.values[1]:.10g}"
        about[f"special point {i + 1}"] = f"{point.kind} at {where}: {point.message}"
    line = f"{border.words[0]} | {border.words[1] or 'no word'}: {border.sliding or border.kind}, {len(border)} points"
    return page("Border", line, table((first, second, "error"), rows, len(border)), drawn, facts(about))


def response_page(found: FrequencyResponse) -> str:
    """Return the page of a frequency response: some of its rows, and the amplitude."""
    names = ("status", "word", "amplitude", "transmissibility", "phase", "dissipated", "stuck", "balance_error")
    rows = [[found.values[i], *(shown(getattr(found, name)[i]) for name in names)] for i in ends(len(found))]
    drawn = curve(f"amplitude against {found.name}", found.values, found.amplitude)
    line, heads = f"over {found.name}, {counted(len(found), 'value')}", [name.replace("_", " ") for name in names]
    return page("FrequencyResponse", line, table([found.name, *heads], rows, len(found)), drawn)


def atlas_page(atlas: Atlas) -> str:
    """Return the page of an atlas: its words and their shares, and its borders."""
    rows = [[region.word or "none found", f"{region.share:.4%}", f"{region.proven:.4%}"] for region in atlas.regions]
    borders = [
        [" | ".join(word or "?" for word in each.words), each.sliding or each.kind, len(each)] for each in atlas.borders
    ]
    sides = (f"{name} = {show(low)} … {show(high)}" for name, (low, high) in zip(atlas.over, atlas.range, strict=True))
    line = f"{', '.join(sides)}: {atlas.proven:.4%} of the area proven"
    first = _table(("word", "share", "proven"), rows, len(rows))
    return page("Atlas", line, first, _table(("border", "kind", "points"), borders, len(borders)))


def window_page(window: GrazingWindow) -> str:
    """Return the page of a grazing window: its intervals and its case."""
    place = window.place
    rows = [
        ["[" if low_closed else "(", low, high, "]" if high_closed else ")"]
        for low, high, low_closed, high_closed in window.intervals
    ]
    values = {"case": window.case, "γ": str(window.gamma), "B₀Ω/m": str(window.amplitude), "order": window.order}
    line = f"{window.mapping}: domain {place.domain} at belt {place.boundary}, Ω t mod 2π"
    line += "" if rows else ": empty, no phase grazes"
    intervals = _table(("", "from", "to", ""), rows)
    return page("GrazingWindow", line, intervals, facts(values))


def crosscheck_page(check: CrossCheck) -> str:
    """Return the page of a cross-check: its findings, and the samples with the faults marked."""
    strange = [("missed", event) for event in check.missed] + [("invented", event) for event in check.invented]
    rows = [[what, event.kind, event.boundary or "", float(event.t)] for what, event in strange]
    lines = Markup('<pre style="margin:0;white-space:pre-wrap">{}</pre>').format(check.summary())
    wrong = check.wrong_steps[:20].tolist()
    marks = [(float(check.t[step]), float(check.x[step])) for step in wrong]
    drawn = curve("the samples' x against t; dots are wrong steps", check.t, check.x, marks)
    found = _table(("", "kind", "belt", "t"), rows)
    line = f"{'ok' if check.ok else 'FAILED'}, {len(check.t):,} samples"
    return page("CrossCheck", line, found, drawn, lines)


def certificate_page(certificate: Certificate) -> str:
    """Return the page of a certificate: the proven statement, and the enclosures."""
    said = "proven" if certificate.proven else "not proven"
    line = f"{certificate.kind}, {said}: {certificate.message}"
    rows = []
    for kind, source, target, *enclosures in (certificate.events[i] for i in ends(len(certificate.events))):
        widths = (f"{float(Decimal(high) - Decimal(low)):.0e}" for low, high in enclosures)  # none for a branch
        rows.append([kind, source, target, *(common_digits(*each) for each in enclosures), *widths])
    heads = ("kind", "from", "to", "t", "x", "width of t", "width of x")[: len(rows[0]) if rows else 0]
    about: Record = {f"multiplier {i}": common_complex(*each) for i, each in enumerate(certificate.multipliers, 1)}
    about |= {"stable": None if certificate.stable is None else "yes" if certificate.stable else "no"}
    about |= {name: certificate.statement.get(key) for name, key in (("made by", "made_by"), ("map", "map"))}
    return page("Certificate", line, _table(heads, rows, len(certificate.events)), facts(about))


def scene_page(scene: Scene) -> str:
    """Return the page of a scene: its numbers with their meaning and unit."""
    start = {name: show(getattr(scene, name)) for name in START_NAMES}
    rows = [
        [name, value, QUANTITIES[name].meaning, unit_of(name)]
        for name, value in (scene.parameters.as_dict() | start).items()
    ]
    error = scene.start_error and ", ".join(f"{float(each):.1g}" for each in scene.start_error)
    model = repr(scene.original.model) if scene.original else None
    about = {"source": scene.source, "structure": scene.structure, "t0, x0, v0 known to": error, "of the model": model}
    heads = ("", "value", "meaning", "unit in SI")
    about = {name: cut(each) if each else None for name, each in about.items()}
    return page("Scene", scene.name, table(heads, rows[:8]), table(heads, rows[8:]), facts(about))


def listing_page(listing: Listing[Any]) -> str | None:
    """Return the page of a long tuple of records, such as events: a row each; None for other entries."""
    if not (listing and is_dataclass(listing[0])):
        return None
    heads = [each.name for each in fields(listing[0])]

    def cell(entry: Any, name: str) -> str:
        value = getattr(entry, name)
        if name.endswith("_error"):
            return f"{value:.0e}"
        return "" if value is None else str(shown(value))

    rows = [[cell(listing[i], name) for name in heads] for i in ends(len(listing))]
    return page(f"{type(listing[0]).__name__}s", f"{len(listing):,}", table(heads, rows, len(listing)))


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
