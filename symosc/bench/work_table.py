"""Tables of work and precision, as plain text or Markdown."""

from __future__ import annotations

from math import inf

from tabulate import tabulate

from symosc.aliases import Record
from symosc.bench.time_limit import HANG
from symosc.reference.compare import ERRORS, REFERENCE_DIGITS


def table(result: Record, markdown: bool = False) -> str:
    """Return the result of `work_precision.run` as text, one table per scene, ratios first."""
    heads = ["solver", "tolerance", "time / ours", "us per event", "error"]
    heads += ["events", "missed", "invented", "what went wrong"]
    parts = []
    for scene in dict.fromkeys(row["scene"] for row in result["rows"]):
        rows = [_cells(row, result["limit_s"]) for row in result["rows"] if row["scene"] == scene]
        form, align = "github" if markdown else "simple", ("left", *["right"] * 7, "left")
        text = tabulate(rows, heads, tablefmt=form, disable_numparse=True, colalign=align)
        parts += [f"**{scene}**\n" if markdown else f"{scene}:", text, ""]
    parts.append(
        "Times are measured in evaluations of the closed form, timed right after each call, and given at the "
        f"{result['floor_ns']:.1f} ns that the fastest one took: a machine may change its pace. A call follows 10,000 "
        "events if the solver does so within 0.3 s, else 24, of fig8 20, and what it costs itself is included. Errors "
        f"are {ERRORS}, against {REFERENCE_DIGITS} digits."
    )
    notes = result["notes"] | {name: f"skipped, {reason}" for name, reason in result["skipped"].items()}
    parts += ["", *(f"{'- ' if markdown else ''}{name}: {note}" for name, note in notes.items())]
    return "\n".join(parts)


def _cells(row: Record, limit: float) -> list[str]:
    times = [row[name] for name in ("over_ours", "us_per_event")]
    numbers = ["" if time is None else rounded(time, 3) for time in times]
    numbers.append(_form(row["error"], ".1e"))
    counts = [str(row[name]) if row[name] is not None else "" for name in ("compared", "missed", "invented")]
    failure = row["failure"]
    if failure.startswith(HANG):
        failure = failure.replace(HANG, f"hang: more than {limit:g} s", 1)
    return [row["solver"], _form(row["tolerance"] or None, ".0e"), *numbers, *counts, failure]


def _form(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def best_rows(result: Record) -> dict[tuple[str, str], Record]:
    """Return for each solver and scene the row at the tolerance that served it best.

    That is the one with the fewest missed and invented events, and of those the one with the smallest error. A solver
    that failed at every tolerance is there with its last row.
    """

    def badness(row: Record) -> tuple[float, ...]:
        if row["missed"] is None:
            return (1, 0, 0)
        return (0, row["missed"] + row["invented"], inf if row["error"] is None else row["error"])

    best: dict[tuple[str, str], Record] = {}
    for row in result["rows"]:
        key = row["solver"], row["scene"]
        if key not in best or badness(row) <= badness(best[key]):
            best[key] = row
    return best


def summary(result: Record) -> str:
    """Return a Markdown table of the solvers at their best: time as a multiple of ours, error, and what went wrong."""
    best = best_rows(result)
    solvers, scenes = (list(dict.fromkeys(key[i] for key in best)) for i in (0, 1))
    rows = [[solver, *(_summed(best[solver, scene]) for scene in scenes)] for solver in solvers]
    return tabulate(rows, ["", *scenes], tablefmt="github", disable_numparse=True)


def _summed(row: Record) -> str:
    if row["us_per_event"] is None:
        return _brief(row["failure"])
    parts = [f"{rounded(row['over_ours'], 2)} ×"] if row["over_ours"] is not None else []
    parts += [_form(row["error"], ".0e")] if row["error"] is not None else []
    parts += [f"{name} {row[name]}" for name in ("missed", "invented") if row[name]]
    parts += [_brief(row["failure"])] if row["failure"] else []
    return ", ".join(parts)


def _brief(failure: str) -> str:
    return "chatters" if "chatters" in failure else failure.partition(":")[0]


def rounded(value: float, digits: int) -> str:
    """Return a number with so many significant digits, and no exponent from 1e-4 to 1e6."""
    return f"{float(f'{value:.{digits}g}'):g}"
