"""Reference cases as files that any language reads, written and read back; `formats.txt` says what is in them."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Context, Decimal, Inexact
from fractions import Fraction
from functools import cached_property
from importlib.resources import files
from math import pi
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from pebble import ProcessPool
from tabulate import tabulate

import symosc
from symosc.aliases import Record
from symosc.crosschecks.events import WINDOW
from symosc.errors import ResultError
from symosc.exact import read_exact, show
from symosc.files import check_folder, read_path, write_folder
from symosc.model import PARAMETER_NAMES
from symosc.reference.case import GIVEN_DIGITS, KnownEvent, ReferenceCase
from symosc.reference.cases import CASE_GROUPS, SET_VERSION, reference_cases
from symosc.reference.compare import KIND_WINDOW, ROUNDING_UNIT, SCORE_TOLERANCE, UNITS_ALLOWED
from symosc.simulation.simulate import simulate

SET_FORMAT = "symosc reference cases 1"
MANIFEST, CASES_TABLE, EVENTS_FILE, CASE_FILE = "manifest.json", "cases.csv", "events.csv", "case.toml"
CHANGES_FILE = "derivatives.csv"
#: Equal steps of a trajectory, and the forcing periods after which one of a very long run ends.
SAMPLE_STEPS, SHOWN_PERIODS = 400, 20
#: Decimals that end before so many digits are written with all of them.
MOST_DIGITS = 400
#: So few cases are written without processes.
CASES_IN_LINE = 8
START_AND_END = ("t0", "x0", "v0", "t_end")
TABLE_COLUMNS = ("name", "group", *PARAMETER_NAMES, *START_AND_END, "events", "periods", "condition", "proven")
EVENT_WORD_COLUMNS = KnownEvent._fields[2:]


# -- writing -----------------------------------------------------------------------------------------------------------


def write_cases(
    path: str | Path,
    cases: Sequence[ReferenceCase] | None = None,
    workers: int = 2,
    progress: Callable[[int], None] | None = None,
) -> Path:
    """Write cases into a folder, all or nothing; the same cases give the same bytes."""
    # `path` is a new folder, or one of an earlier run without other files in it, or an OutputError is raised.
    # `progress` is called with how many cases more are done.
    wanted = reference_cases() if cases is None else cases
    check_folder(path, _of_an_earlier_run)  # before the work
    texts, rows = {}, []
    for each in _compute_files(wanted, workers):
        texts.update(each["texts"])
        rows.append(each["row"])
        if progress:
            progress(1)
    texts[CASES_TABLE] = _csv_text(TABLE_COLUMNS, rows)
    texts["README.md"] = _readme_text(rows, max(map(len, texts[CASES_TABLE].splitlines())))
    texts[MANIFEST] = _manifest_text(rows, texts)
    return write_folder(path, texts, _of_an_earlier_run)


def _compute_files(cases: Sequence[ReferenceCase], workers: int) -> Iterator[Record]:
    """Yield the files of each case, computed in `workers` processes."""
    if len(cases) <= CASES_IN_LINE or workers < 2:
        yield from map(_case_files, cases)
        return
    with ProcessPool(max_workers=workers, context=get_context("spawn")) as pool:
        yield from pool.map(_case_files, cases).result()


def _case_files(case: ReferenceCase) -> Record:
    """Return the files of a case: "texts" by name, and its "row" in the table of cases."""
    events = [
        {"t_low": event.t[0], "t_high": event.t[1], "x_low": event.x[0], "x_high": event.x[1]}
        | {name: getattr(event, name) for name in EVENT_WORD_COLUMNS}
        | {"condition": f"{condition:.3g}"}
        for event, condition in zip(case.events, case.conditions, strict=True)
    ]
    columns = ("t_low", "t_high", "x_low", "x_high", *EVENT_WORD_COLUMNS, "condition")
    changes = [
        {
            "event": i,
            "wrt": name,
            "dt_low": each.dt[0],
            "dt_high": each.dt[1],
            "dx_low": each.dx[0],
            "dx_high": each.dx[1],
        }
        | {"proven": "yes" if each.proven else "no"}
        for i, row in enumerate(case.derivatives)
        for name, each in row.items()
    ]
    found = {
        CASE_FILE: _toml(case),
        EVENTS_FILE: _csv_text(columns, events),
        CHANGES_FILE: _csv_text(("event", "wrt", "dt_low", "dt_high", "dx_low", "dx_high", "proven"), changes),
        "trajectory.csv": _csv_text(("t", "x", "v", "mode"), _samples(case)),
        "certificate.json": json.dumps(case.certificate.as_dict(), indent=1) + "\n",
    }
    about = {"name": case.name, "group": case.group, "events": case.count, "periods": case.periods}
    about |= {"condition": f"{case.condition:.3g}", "proven": "yes" if case.proven else "no"}
    about |= case.parameters.as_dict() | {name: exact_text(getattr(case, name)) for name in START_AND_END}
    return {"texts": {f"{case.name}/{name}": text for name, text in found.items()}, "row": about}


def exact_text(value: Fraction) -> str:
    """Return a number as exact text: all digits of a decimal that ends ("0.125"), else a quotient ("1/3")."""
    exact = Context(prec=MOST_DIGITS, traps=[Inexact])
    try:
        found = exact.divide(Decimal(value.numerator), Decimal(value.denominator))
    except Inexact:
        return show(value)
    return show(value) if "/" not in show(value) else f"{found:f}"


def _csv_text(columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _toml(case: ReferenceCase) -> str:
    """Return the file of a case; JSON writes text, whole numbers and lists as TOML does."""
    scene = case.scene
    start: Record = {name: exact_text(getattr(scene, name)) for name in START_AND_END[:3]}
    if scene.start_error is not None:
        start["start_error"] = [show(error) for error in scene.start_error]
    about: Record = {"set_version": SET_VERSION, "group": case.group, "hard": case.hard, "source": case.source}
    about |= {"status": case.status, "reason": case.open, "events": case.count, "periods": case.periods}
    about |= {"condition": float(f"{case.condition:.3g}"), "closed_form": list(case.closed_form)}
    top: Record = {"name": case.name, "t_end": exact_text(scene.t_end)}
    tables = {"": top, "[parameters]\n": case.parameters.as_dict(), "[start]\n": start, "[reference]\n": about}
    rows = {head: (f"{key} = {json.dumps(value)}\n" for key, value in table.items()) for head, table in tables.items()}
    return "\n".join(head + "".join(lines) for head, lines in rows.items())


def _samples(case: ReferenceCase) -> list[Record]:
    """Return the rows of a trajectory: equal steps, and two rows at each event."""
    scene = case.scene
    if case.periods:
        shown = Fraction(SHOWN_PERIODS * 2 * pi) / case.parameters.Omega
        scene = replace(scene, t_end=min(scene.t_end, scene.t0 + shown))
    motion = simulate(scene, digits=GIVEN_DIGITS)
    span = scene.t_end - scene.t0
    times = [float(scene.t0 + span * i / SAMPLE_STEPS) for i in range(SAMPLE_STEPS + 1)]
    times = [min(max(t, float(motion.t_start)), float(motion.t_end)) for t in times]
    x, v = motion(times)
    rows = [
        (t, 0, *state) for t, *state in zip(times, x.tolist(), v.tolist(), motion.mode(times).tolist(), strict=True)
    ]
    for i, event in enumerate(motion.events, 1):
        state = float(event.t), 2 * i, float(event.x), float(event.v)
        rows += [(*state, event.source), (state[0], 2 * i + 1, *state[2:], event.target)]
    rows.sort(key=lambda row: row[:2])
    return [{"t": repr(t), "x": f"{x:.15g}", "v": f"{v:.15g}", "mode": mode} for t, _, x, v, mode in rows]


def _readme_text(rows: Sequence[Record], longest: int) -> str:
    counts = [
        (group, sum(row["group"] == group for row in rows), hard)
        for group, hard in CASE_GROUPS.items()
        if any(row["group"] == group for row in rows)
    ]
    numbers = {
        "VERSION": SET_VERSION,
        "COUNT": len(rows),
        "PROVEN": sum(row["proven"] == "yes" for row in rows),
        "SHOWN_PERIODS": SHOWN_PERIODS,
        "LONGEST": longest,
        "WINDOW": WINDOW,
        "KIND_WINDOW": KIND_WINDOW,
        "TOLERANCE": f"{SCORE_TOLERANCE:g}",
        "UNIT": f"{ROUNDING_UNIT:g}",
        "UNITS": f"{UNITS_ALLOWED:g}",
        "GROUPS": tabulate(counts, ["group", "cases", "what is hard"], tablefmt="github", disable_numparse=True),
    }
    text = (files("symosc.reference") / "formats.txt").read_text(encoding="utf-8")
    for name, value in numbers.items():
        text = text.replace(f"@{name}@", str(value))
    return text


def _manifest_text(rows: Sequence[Record], texts: Mapping[str, str]) -> str:
    names = ("name", "group", "events", "condition", "proven")
    content: Record = {"format": SET_FORMAT, "set_version": SET_VERSION, "made_by": f"symosc {symosc.__version__}"}
    numbers = [row | {"condition": float(row["condition"]), "proven": row["proven"] == "yes"} for row in rows]
    content["cases"] = [{name: row[name] for name in names} for row in numbers]
    content["files"] = {name: checksum(text.encode()) for name, text in sorted(texts.items())}
    return json.dumps(content, indent=1) + "\n"


def checksum(content: bytes) -> str:
    """Return the SHA-256 sum of a file's content."""
    return hashlib.sha256(content).hexdigest()


def _of_an_earlier_run(folder: Path) -> set[str]:
    """Return the files named by a folder's manifest, itself included; none without a manifest."""
    try:
        content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
        return {MANIFEST, *content["files"]} if content["format"] == SET_FORMAT else set()
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return set()


# -- reading -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class StoredCase:
    """A case as stored in files."""

    name: str
    group: str
    Omega: Fraction
    t0: Fraction
    t_end: Fraction
    on_belt: bool
    events: tuple[KnownEvent, ...]
    conditions: tuple[float, ...]
    count: int  # of all events, if only the last period's are given
    # the derivatives of each event that exist: (dt, dx) by name
    changes: tuple[dict[str, tuple[float, float]], ...] = ()

    @cached_property
    def times(self) -> list[float]:
        """Times of the events."""
        return [float(event.middle[0]) for event in self.events]


def read_set(path: str | Path) -> tuple[int, Sequence[StoredCase]]:
    """Return version and cases of a folder; raise ResultError for a wrong folder or checksum."""
    folder = Path(read_path(path))
    manifest = _read_manifest(folder)
    try:
        names = [(entry["name"], manifest["files"]) for entry in manifest["cases"]]
        return int(manifest["set_version"]), [_read_case(folder, name, sums) for name, sums in names]
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise ResultError(str(folder), f"is not a set of reference cases: {type(error).__name__}, {error}") from None


def _read_manifest(folder: Path) -> Record:
    try:
        content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except OSError:
        raise ResultError(str(folder), f"has no {MANIFEST}; `symosc cases -o {folder}` writes the cases") from None
    except (ValueError, RecursionError):
        raise ResultError(str(folder / MANIFEST), "is not JSON") from None
    if not isinstance(content, dict) or content.get("format") != SET_FORMAT:
        raise ResultError(str(folder / MANIFEST), f"is not of the format {SET_FORMAT!r}")
    return content


def _read_checked(folder: Path, name: str, sums: Record) -> str:
    try:
        content = (folder / name).read_bytes()
    except OSError as error:
        raise ResultError(str(folder / name), f"cannot be read: {error.strerror or error}") from None
    if checksum(content) != sums[name]:
        raise ResultError(str(folder / name), "is not the file that was written: its checksum differs")
    return content.decode()


def _read_case(folder: Path, name: str, sums: Record) -> StoredCase:
    about = tomllib.loads(_read_checked(folder, f"{name}/{CASE_FILE}", sums))
    rows = list(csv.DictReader(io.StringIO(_read_checked(folder, f"{name}/{EVENTS_FILE}", sums))))
    events = tuple(
        KnownEvent(
            (row["t_low"], row["t_high"]),
            (row["x_low"], row["x_high"]),
            row["kind"],
            int(row["boundary"]),
            *(row[word] for word in ("source", "target", "word")),
        )
        for row in rows
    )
    start, given = about["start"], about["parameters"]
    v1, v2, Omega = (read_exact(each, given[each]) for each in ("v1", "v2", "Omega"))
    t0, v0 = (read_exact(each, start[each]) for each in ("t0", "v0"))
    t_end = read_exact("t_end", about["t_end"])
    conditions = tuple(float(row["condition"]) for row in rows)
    reference = about["reference"]
    changes: tuple[dict[str, tuple[float, float]], ...] = tuple({} for _ in rows)
    if f"{name}/{CHANGES_FILE}" in sums:  # older sets have none
        for row in csv.DictReader(io.StringIO(_read_checked(folder, f"{name}/{CHANGES_FILE}", sums))):
            changes[int(row["event"])][row["wrt"]] = float(row["dt_low"]), float(row["dx_low"])
    return StoredCase(
        name, reference["group"], Omega, t0, t_end, v0 in (v1, v2), events, conditions, reference["events"], changes
    )


def stored(case: ReferenceCase, with_derivatives: bool = True) -> StoredCase:
    """Return a case in the form that its files would have."""
    p, on_belt = case.parameters, case.v0 in (case.parameters.v1, case.parameters.v2)
    changes = tuple(
        {name: (float(each.dt[0]), float(each.dx[0])) for name, each in row.items()}
        for row in (case.derivatives if with_derivatives else ())
    )
    return StoredCase(
        case.name, case.group, p.Omega, case.t0, case.t_end, on_belt, case.events, case.conditions, case.count, changes
    )
