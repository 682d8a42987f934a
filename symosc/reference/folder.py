"""Reference cases as files that any language reads, written and read back.

`formats.txt` says what is in them.
"""

from __future__ import annotations

import csv
import hashlib
import io
import json
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from decimal import Context, Decimal, Inexact
from fractions import Fraction
from importlib.resources import files
from math import pi
from pathlib import Path
from typing import Any

from tabulate import tabulate

import symosc
from symosc.base.aliases import Record
from symosc.base.errors import ResultError
from symosc.base.exact import show
from symosc.base.files import check_folder, read_path, write_folder
from symosc.base.workers import process_pool
from symosc.belts import Belt
from symosc.crosschecks.events import WINDOW
from symosc.model import OSCILLATOR_NAMES, PARAMETER_NAMES, Oscillator, Parameters
from symosc.reference.case import GIVEN_DIGITS, KnownChange, KnownEvent, ReferenceCase, with_known
from symosc.reference.cases import CASE_GROUPS, SET_VERSION, reference_cases
from symosc.reference.score import KIND_WINDOW, ROUNDING_UNIT, SCORE_TOLERANCE, UNITS_ALLOWED
from symosc.scenes import Scene, as_toml
from symosc.simulation.simulate import simulate

SET_FORMAT = "symosc reference cases 1"
MANIFEST = "manifest.json"
CASES_TABLE = "cases.csv"
#: Cases under other friction laws, and their belts.
LAWS_TABLE = "laws.csv"
BELTS_TABLE = "belts.csv"
EVENTS_FILE = "events.csv"
CASE_FILE = "case.toml"
CHANGES_FILE = "derivatives.csv"
#: Equal steps of a trajectory, and the forcing periods after which one of a very long run ends.
SAMPLE_STEPS = 400
SHOWN_PERIODS = 20
#: Decimals that end before so many digits are written with all of them.
MOST_DIGITS = 400
#: Up to so many cases are written without worker processes.
CASES_IN_LINE = 8
YES_OR_NO = {True: "yes", False: "no"}
START_AND_END = ("t0", "x0", "v0", "t_end")
TABLE_COLUMNS = (
    "name",
    "group",
    *PARAMETER_NAMES,
    *START_AND_END,
    "events",
    "periods",
    "condition",
    "proven",
)
LAW_COLUMNS = (
    "name",
    "group",
    *OSCILLATOR_NAMES,
    *START_AND_END,
    "belts",
    "events",
    "condition",
    "proven",
)
BELT_COLUMNS = ("name", "belt", "v", "w", "mu", "mu_s", "slope")
EVENT_COLUMNS = ("t_low", "t_high", "x_low", "x_high", *KnownEvent._fields[2:], "condition")
CHANGE_COLUMNS = ("event", "wrt", "dt_low", "dt_high", "dx_low", "dx_high", "proven")


# -- writing ---------------------------------------------------------------------------------------


def write_cases(
    path: str | Path,
    cases: Sequence[ReferenceCase] | None = None,
    workers: int = 2,
    progress: Callable[[int], None] | None = None,
) -> Path:
    """Write cases into a folder, all or nothing; the same cases give the same bytes."""
    # `path` is a new folder, or one of an earlier run without other files in it, or an OutputError
    # is raised. `progress` is called with how many cases more are done.
    written_cases = reference_cases() if cases is None else cases
    check_folder(path, _files_of_earlier_run)  # before the work
    texts = {}
    rows = []
    with ExitStack() as stack:
        if len(written_cases) > CASES_IN_LINE and workers > 1:
            pool = stack.enter_context(process_pool(workers, "spawn"))
            answers = pool.map(_case_files, written_cases)
        else:
            answers = map(_case_files, written_cases)
        for case_texts, row in answers:
            texts.update(case_texts)
            rows.append(row)
            if progress:
                progress(1)
    of_paper = [row for row in rows if not row["belts"]]
    texts[CASES_TABLE] = _csv_text(
        TABLE_COLUMNS, ([row[name] for name in TABLE_COLUMNS] for row in of_paper)
    )
    of_laws = [row for row in rows if row["belts"]]
    if of_laws:
        texts[LAWS_TABLE] = _csv_text(
            LAW_COLUMNS, ([row[name] for name in LAW_COLUMNS] for row in of_laws)
        )
        texts[BELTS_TABLE] = _csv_text(BELT_COLUMNS, _belt_rows(written_cases))
    texts["README.md"] = _readme_text(rows, max(map(len, texts[CASES_TABLE].splitlines())))
    texts[MANIFEST] = _manifest_text(rows, texts)
    return write_folder(path, texts, _files_of_earlier_run)


def _case_files(case: ReferenceCase) -> tuple[dict[str, str], Record]:
    """Return the texts of a case's files by their names, and its row in the table of cases."""
    events = (
        (
            *event.t,
            *event.x,
            event.kind,
            event.boundary,
            event.source,
            event.target,
            event.word,
            f"{condition:.3g}",
        )
        for event, condition in zip(case.events, case.conditions, strict=True)
    )
    changes = (
        (i, name, *change.dt, *change.dx, YES_OR_NO[change.proven])
        for i, row in enumerate(case.derivatives)
        for name, change in row.items()
    )
    files_of_case = {
        CASE_FILE: _case_toml(case),
        EVENTS_FILE: _csv_text(EVENT_COLUMNS, events),
        CHANGES_FILE: _csv_text(CHANGE_COLUMNS, changes),
        "trajectory.csv": _csv_text(("t", "x", "v", "mode"), _samples(case)),
        "certificate.json": json.dumps(case.certificate.as_dict(), indent=1) + "\n",
    }
    about = {"name": case.name, "group": case.group, "events": case.count, "periods": case.periods}
    about |= {"condition": f"{case.condition:.3g}", "proven": YES_OR_NO[case.proven]}
    about |= case.parameters.as_dict() | {
        name: exact_text(getattr(case, name)) for name in START_AND_END
    }
    # Those of the paper's law are in the table of cases.
    about["belts"] = len(case.parameters.law.belts) if _has_other_law(case) else 0
    return {f"{case.name}/{name}": text for name, text in files_of_case.items()}, about


def _has_other_law(case: ReferenceCase) -> bool:
    """Return whether a case is not of the paper's eleven numbers."""
    return isinstance(case.parameters, Oscillator)


def _belt_rows(cases: Sequence[ReferenceCase]) -> Iterable[Sequence[Any]]:
    """Yield a row for each point of the friction of each belt, of cases under other laws."""
    for case in filter(_has_other_law, cases):
        for n, belt in enumerate(case.parameters.law.belts, 1):
            for w, mu in belt.curve or [(Fraction(0), belt.mu)]:
                numbers = (belt.v, w, mu, belt.mu_s, belt.slope)
                yield case.name, n, *map(exact_text, numbers)


def exact_text(value: Fraction) -> str:
    """Return a number as exact text: all digits of a decimal that ends ("0.125"), else a quotient
    ("1/3").
    """
    if "/" in show(value):
        exact = Context(prec=MOST_DIGITS, traps=[Inexact])
        try:
            return f"{exact.divide(Decimal(value.numerator), Decimal(value.denominator)):f}"
        except Inexact:
            pass
    return show(value)


def _csv_text(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([columns, *rows])
    return text.getvalue()


def _case_toml(case: ReferenceCase) -> str:
    """Return the text of a case's TOML file, which is a scene file as well."""
    # JSON writes text, numbers and lists as TOML does.
    start: Record = {name: exact_text(getattr(case, name)) for name in ("t0", "x0", "v0")}
    if case.scene.start_error is not None:
        start["start_error"] = [show(error) for error in case.scene.start_error]
    about: Record = {
        "set_version": SET_VERSION,
        "group": case.group,
        "hard": case.hard,
        "source": case.source,
    }
    about |= {
        "status": case.status,
        "reason": case.open,
        "events": case.count,
        "periods": case.periods,
    }
    about |= {"condition": float(f"{case.condition:.3g}"), "closed_form": list(case.closed_form)}
    if _has_other_law(case):
        scene = replace(case.scene, name=case.name, source="")
        reference = "".join(f"{key} = {json.dumps(value)}\n" for key, value in about.items())
        return f"{as_toml(scene)}\n\n[reference]\n{reference}"
    top: Record = {"name": case.name, "t_end": exact_text(case.t_end)}
    tables = {
        "": top,
        "[parameters]\n": case.parameters.as_dict(),
        "[start]\n": start,
        "[reference]\n": about,
    }
    rows = {
        head: (f"{key} = {json.dumps(value)}\n" for key, value in table.items())
        for head, table in tables.items()
    }
    return "\n".join(head + "".join(lines) for head, lines in rows.items())


def _samples(case: ReferenceCase) -> list[tuple[str, str, str, str]]:
    """Return rows (t, x, v, mode) of a case's motion: at equal steps, and before and after each
    event.
    """
    scene = case.scene
    if case.periods:
        shown = Fraction(SHOWN_PERIODS * 2 * pi) / case.parameters.Omega
        scene = replace(scene, t_end=min(scene.t_end, scene.t0 + shown))
    motion = simulate(scene, digits=GIVEN_DIGITS)
    span = scene.t_end - scene.t0
    times = [float(scene.t0 + span * i / SAMPLE_STEPS) for i in range(SAMPLE_STEPS + 1)]
    times = [min(max(t, float(motion.t_start)), float(motion.t_end)) for t in times]
    # The second number of a row keeps rows at one time in order: a sample, then each event's state
    # before and after it.
    states = zip(times, *motion(times).tolist(), motion.mode(times).tolist(), strict=True)
    rows = [(t, 0, *state) for t, *state in states]
    for i, event in enumerate(motion.events, 1):
        t = float(event.t)
        state = float(event.x), float(event.v)
        rows += [(t, 2 * i, *state, event.source), (t, 2 * i + 1, *state, event.target)]
    rows.sort(key=lambda row: row[:2])
    return [(repr(t), f"{x:.15g}", f"{v:.15g}", mode) for t, _, x, v, mode in rows]


def _readme_text(rows: Sequence[Record], longest: int) -> str:
    """Return the README of a folder of cases; `longest` is the length of a row of their table."""
    groups = [row["group"] for row in rows]
    counts = [
        (group, groups.count(group), hard) for group, hard in CASE_GROUPS.items() if group in groups
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
        "GROUPS": tabulate(
            counts, ["group", "cases", "what is hard"], tablefmt="github", disable_numparse=True
        ),
    }
    text = (files("symosc.reference") / "formats.txt").read_text(encoding="utf-8")
    for name, value in numbers.items():
        text = text.replace(f"@{name}@", str(value))
    return text


def _manifest_text(rows: Sequence[Record], texts: Mapping[str, str]) -> str:
    """Return the manifest as JSON: version, cases, and the checksum of each file."""
    content: Record = {
        "format": SET_FORMAT,
        "set_version": SET_VERSION,
        "made_by": f"symosc {symosc.__version__}",
    }
    content["cases"] = [
        {name: row[name] for name in ("name", "group", "events")}
        | {"condition": float(row["condition"]), "proven": row["proven"] == "yes"}
        for row in rows
    ]
    content["files"] = {name: checksum(text.encode()) for name, text in sorted(texts.items())}
    return json.dumps(content, indent=1) + "\n"


def checksum(content: bytes) -> str:
    """Return the SHA-256 sum of a file's content."""
    return hashlib.sha256(content).hexdigest()


def _files_of_earlier_run(folder: Path) -> set[str]:
    """Return the names of a folder's manifest and of all files that it lists.

    Nothing without a valid manifest.
    """
    try:
        return {MANIFEST, *_read_manifest(folder)["files"]}
    except (ResultError, KeyError, TypeError):
        return set()


# -- reading ---------------------------------------------------------------------------------------


def read_set(path: str | Path) -> tuple[int, Sequence[ReferenceCase]]:
    """Return version and cases of a folder; raise ResultError for a wrong folder or checksum."""
    # What the files say of a case is not computed again; its certificate is not read.
    folder = Path(read_path(path))
    manifest = _read_manifest(folder)
    try:
        cases = [
            _read_case(folder, entry["name"], manifest["files"]) for entry in manifest["cases"]
        ]
        return int(manifest["set_version"]), cases
    except ResultError:  # a ValueError too; it says already which file is wrong
        raise
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise ResultError(
            str(folder), f"is not a set of reference cases: {type(error).__name__}, {error}"
        ) from None


def _read_manifest(folder: Path) -> Record:
    """Return the manifest of a folder of cases; raise ResultError if it has none."""
    try:
        content = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except OSError:
        raise ResultError(
            str(folder), f"has no {MANIFEST}; `symosc cases -o {folder}` writes the cases"
        ) from None
    except (ValueError, RecursionError):
        raise ResultError(str(folder / MANIFEST), "is not JSON") from None
    if not isinstance(content, dict) or content.get("format") != SET_FORMAT:
        raise ResultError(str(folder / MANIFEST), f"is not of the format {SET_FORMAT!r}")
    return content


def _read_case(folder: Path, name: str, sums: Record) -> ReferenceCase:
    """Return the case `name` as its files in `folder` have it, whose checksums are in `sums`."""

    def read(file: str) -> str:
        path = folder / name / file
        try:
            content = path.read_bytes()
        except OSError as error:
            raise ResultError(str(path), f"cannot be read: {error.strerror or error}") from None
        if checksum(content) != sums[f"{name}/{file}"]:
            raise ResultError(str(path), "is not the file that was written: its checksum differs")
        return content.decode()

    about = tomllib.loads(read(CASE_FILE))
    rows = list(csv.DictReader(io.StringIO(read(EVENTS_FILE))))
    events = []
    for row in rows:
        event = KnownEvent(
            t=(row["t_low"], row["t_high"]),
            x=(row["x_low"], row["x_high"]),
            kind=row["kind"],
            boundary=int(row["boundary"]),
            source=row["source"],
            target=row["target"],
            word=row["word"],
        )
        events.append(event)
    changes: list[dict[str, KnownChange]] = [{} for _ in rows]
    if f"{name}/{CHANGES_FILE}" in sums:  # older sets have none
        _, *lines = csv.reader(io.StringIO(read(CHANGES_FILE)))
        for number, wrt, dt_low, dt_high, dx_low, dx_high, proven in lines:
            dt = (dt_low, dt_high)
            dx = (dx_low, dx_high)
            changes[int(number)][wrt] = KnownChange(dt, dx, proven == "yes")
    model: Any
    if "belts" in about:
        belts = [Belt(**belt) for belt in about["belts"]]
        model = Oscillator(**about["parameters"], belts=belts)
    else:
        model = Parameters(**about["parameters"])
    scene = Scene(name, model, **about["start"], t_end=about["t_end"])
    case = ReferenceCase(
        name, scene=scene, **{key: about["reference"][key] for key in ("group", "hard", "periods")}
    )
    conditions = tuple(float(row["condition"]) for row in rows)
    return with_known(case, events=tuple(events), conditions=conditions, derivatives=tuple(changes))
