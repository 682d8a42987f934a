"""A page on a cross-check: one HTML file with verdict, diagnosis, events and pictures, that needs nothing else."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib import rc_context
from matplotlib.figure import Figure

from symosc.aliases import Record
from symosc.crosschecks.causes import CAUSES, REASONS, Diagnosis, Fault
from symosc.crosschecks.events import FoundEvent
from symosc.crosschecks.report import CrossCheck
from symosc.files import check_folder_of, write_text
from symosc.plot.crosscheck import crosscheck_figure
from symosc.plot.crosscheck_step import step_figure
from symosc.plot.drawing import STYLE
from symosc.simulation.trajectory import Event

# Rows of a table, and those that are shown before the reader unfolds the rest.
MOST_ROWS, ROWS_SHOWN = 200, 8
# Curves of more samples are drawn in pixels: as lines they would be megabytes.
MOST_LINES, PIXELS_PER_INCH = 4_000, 160.0


def write_page(check: CrossCheck, path: str | Path) -> Path:
    """Write the page; raises OutputError if it cannot be written."""
    check_folder_of(path)
    environment = Environment(
        loader=PackageLoader("symosc.plot", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return write_text(path, environment.get_template("crosscheck.html.j2").render(page(check)))


def page(check: CrossCheck) -> Record:
    """Return what the page shows."""
    p, events = check.trajectory.parameters, list(_events(check))
    return {
        "ok": check.ok,
        "verdict": _verdict(check),
        "facts": _facts(check),
        "diagnosis": [_diagnosis(one) for one in check.diagnosis],
        "first": _fault(check.first_wrong),
        "pictures": list(_pictures(check)),
        "events": events[:MOST_ROWS],
        "more_events": max(0, len(events) - MOST_ROWS),
        "wrong": [_fault(fault) for fault in check.faults[:MOST_ROWS]],
        "wrong_count": len(check.wrong_steps),
        "shown": ROWS_SHOWN,
        "parameters": p.as_dict(),
        "notes": check.notes,
    }


def _verdict(check: CrossCheck) -> str:
    if check.ok:
        return f"Right: every step agrees with the exact motion, to a tolerance of {check.tolerance:g}."
    wrong = f"wrong steps: {len(check.wrong_steps)} of {len(check.defects)}"
    events = f"events missed: {len(check.missed)}, invented: {len(check.invented)}"
    beside = "".join(f" {said[0].upper()}{said[1:]}." for said in (check.wrong_start, check.early_end) if said)
    return f"Not right: {wrong}; {events} (tolerance {check.tolerance:g} per step).{beside}"


def _facts(check: CrossCheck) -> list[tuple[str, str]]:
    limits = check.limits_there
    return [
        ("Samples", f"{len(check.t)}, from t = {check.t[0]:.10g} to {check.t[-1]:.10g}"),
        ("Largest error of x", f"{check.max_error_x:.2e} (allowed {limits[0]:.1e})"),
        ("Largest error of v", f"{check.max_error_v:.2e} (allowed {limits[1]:.1e})"),
        ("Events", f"{len(check.matched)} right, {len(check.missed)} missed, {len(check.invented)} invented, "
                   f"{len(check.unresolved)} not decided"),
        ("Digits", ", ".join(f"{name} to {text}" for name, text in check.rounded.items()) or "those of doubles"),
    ]  # fmt: skip


def _diagnosis(one: Diagnosis) -> Record:
    estimate = ""
    if one.value is not None:
        error = f" ± {one.error:.2g}" if one.error else ""
        estimate = f"{one.value:.10g}{error}"
    return {
        "title": CAUSES[one.cause],
        "words": one.words,
        "evidence": one.evidence,
        "estimate": estimate,
        "share": f"{max(0.0, min(one.share, 1.0)):.0%}" if one.share else "",
        "others": [f"{other.words} ({other.evidence})" for other in one.alternatives],
    }


def _fault(fault: Fault | None) -> Record | None:
    if fault is None:
        return None
    return {
        "step": fault.step,
        "t": f"{fault.t:.10g}",
        "t_next": f"{fault.t_next:.10g}",
        "x": f"{fault.defect_x:.1e}",
        "v": f"{fault.defect_v:.1e}",
        "expected": fault.expected,
        "found": fault.found or "passing",
        "reason": REASONS[fault.reason].capitalize(),
        "words": fault.words,
    }


def _events(check: CrossCheck) -> Iterator[Record]:
    """Yield the events in order of time, each with what the solution has."""
    rows: list[tuple[float, str, str, Event | FoundEvent]] = [
        (float(match.event.t), "right", f"{match.error:+.1e}", match.event) for match in check.matched
    ]
    rows += [(float(event.t), "missed", "", event) for event in check.missed]
    rows += [(float(event.t), "invented", "", event) for event in check.invented]
    rows += [(float(event.t), "not decided", "", event) for event in check.unresolved]
    for time, verdict, error, event in sorted(rows, key=lambda row: row[0]):
        way = f"{event.source} → {event.target}" if event.source else ""
        yield {"t": f"{time:.10g}", "kind": event.kind, "belt": event.boundary or "", "way": way,
               "verdict": verdict, "error": error}  # fmt: skip


def _pictures(check: CrossCheck) -> Iterator[Record]:
    first = check.first_wrong
    if first:
        yield _picture(
            step_figure(check), False, "First wrong step",
            f"The step from sample {first.step} (t = {first.t:.8g}) to the next one. The line is the exact motion from "
            "that sample on; it should end at the cross. Grey lines are its events.",
        )  # fmt: skip
    many = len(check.t) > MOST_LINES
    yield _picture(crosscheck_figure(check, "b"), many, "Errors of the steps",
                   "The exact motion from each sample over one step, minus the next sample, in units of the largest "
                   "|x| and |v|. Crosses are wrong steps. Vertical lines are events: grey matched, red missed, orange "
                   "invented.")  # fmt: skip
    yield _picture(crosscheck_figure(check, "a"), many, "Global error",
                   "The samples minus the exact motion from the start, in the same units.")  # fmt: skip
    yield _picture(
        crosscheck_figure(check, "c"), many, "Velocity", "The samples' velocity; black lines are the belts' speeds."
    )


def _picture(drawing: Figure, pixels: bool, title: str, caption: str) -> Record:
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
    options: dict[str, Any] = {"dpi": PIXELS_PER_INCH} if pixels else {"metadata": {"Date": None}}
    data = BytesIO()
    with rc_context(STYLE):
        drawing.savefig(data, format=kind, **options)
    source = f"data:image/{media};base64,{b64encode(data.getvalue()).decode('ascii')}"
    return {"title": title, "caption": caption, "source": source}
