"""The result of `symosc.bench.hard` as text."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tabulate import tabulate

from symosc.aliases import Record
from symosc.bench.event_logic import PeerError
from symosc.bench.machine import sentence
from symosc.bench.time_limit import HANG
from symosc.reference.cases import GROUPS
from symosc.reference.compare import ERRORS

#: What a reference is.
BY_PROOF, BY_DIGITS = "proven", "40 digits"
#: Forms of tabulate that are Markdown.
MARKDOWN = ("github", "pipe")
# Names of solvers are broken into lines of this many letters, except in Markdown.
HEAD_WIDTH = 14


def cell_text(cell: Record, limit: float, note: Callable[[str], str] = str) -> str:
    """Return what a solver made of a case, in a few letters.

    Parameters
    ----------
    cell : dict
        An entry of a row's `cells` in the result of `symosc.bench.hard.run`.
    limit : float
        The time limit in seconds.
    note : callable
        Gets the message of an exception or a crash and returns what is to stand for it.
    """
    failure = cell["failure"]
    if failure == HANG:
        return f"> {limit:g} s"
    if "chatters" in failure:
        return "chatters"
    if failure:
        return note(failure)
    if cell["undecidable"] is not None:
        return f"undecidable after {cell['undecidable']}"
    wrong = [f"{name} {cell[name]}" for name in ("missed", "invented") if cell[name]]
    if wrong:
        return ", ".join(wrong)
    return "right" if cell["error"] is None else f"{cell['error']:.0e}"


def all_found(cell: Record) -> bool:
    """Tell whether a solver came to the end with no event missed or invented."""
    return not cell["failure"] and not cell["missed"] and not cell["invented"]


def table(result: Record, form: str = "simple", raw: bool = False) -> str:
    """Return one row per case, one column per solver.

    Parameters
    ----------
    result : dict
        From `symosc.bench.hard.run`.
    form : str
        A table format of tabulate; "github" is Markdown.
    raw : bool
        The peers as they come instead of at their best.
    """
    solvers = columns(result, raw)
    notes = Notes()
    rows: list[list[str]] = []
    group = ""
    members = rows_with(result, solvers)
    for row in members:
        if row["group"] != group:
            group = row["group"]
            heading = f"**{group}**" if form in MARKDOWN else f"{group}:"
            rows.append([heading, *[""] * (3 + len(solvers))])
        condition = "" if row["condition"] is None else f"{row['condition']:.0e}"
        cells = [cell_text(row["cells"][name], result["limit_s"], notes) for name in solvers]
        reference = BY_DIGITS if row["open"] else BY_PROOF
        rows.append([_plain(row["case"], form), str(row["events"]), reference, condition, *cells])
    counts = [sum(all_found(row["cells"][name]) for row in members) for name in solvers]
    rows.append(["all events found", "", "", "", *(f"{count} of {len(members)}" for count in counts)])
    return "\n".join(
        [_tabulate(rows, ["case", "events", "reference", "condition", *solvers], form), *notes.lines(form)]
    )


def summary(result: Record, form: str = "simple", raw: bool = False) -> str:
    """Return one row per group: a solver's largest error, and in how many cases it found all events, if not in all."""
    solvers = columns(result, raw)
    rows = []
    for group, hard in GROUPS.items():
        members = [row for row in rows_with(result, solvers) if row["group"] == group]
        if not members:
            continue
        known = [row["condition"] for row in members if row["condition"] is not None]
        cells = [_of_group([row["cells"][name] for row in members]) for name in solvers]
        rows.append([f"{group} ({len(members)})", f"{max(known):.0e}" if known else "", *cells, hard])
    return _tabulate(rows, ["group (cases)", "condition", *solvers, "what is hard"], form)


def _of_group(cells: Sequence[Record]) -> str:
    good = [cell for cell in cells if all_found(cell)]
    errors = [cell["error"] for cell in good if cell["error"] is not None]
    largest = [f"{max(errors):.0e}"] if errors else []
    if len(good) == len(cells):
        return "".join(largest) or "right"
    return ": ".join([f"{len(good)} of {len(cells)}", *largest])


def columns(result: Record, raw: bool = False) -> list[str]:
    """Return the names of the solvers of a table: ours and the peers at their best, or the peers as they come."""
    return [solver["name"] for solver in result["solvers"] if solver["raw"] == raw]


def rows_with(result: Record, solvers: Sequence[str]) -> list[Record]:
    """Return the rows that have a cell for each of these solvers; none if there are no solvers."""
    return [row for row in result["rows"] if solvers and all(name in row["cells"] for name in solvers)]


def legend(result: Record) -> list[str]:
    """Return what the cells mean, what the solvers were set to, and the verdict on ours."""
    limit = result["limit_s"]
    lines = [
        f"Cells: largest error, {ERRORS}, against the reference; or "
        f"what went wrong: events missed or invented, over the limit of {limit:g} s, chattering between a flight and a "
        "stick, or an exception. 'right': nothing happens in the case and nothing was reported.",
        "Condition: by how much relative errors of parameters and start values are amplified in the event that is "
        "worst; so much times 1e-16 is what the rounding of these numbers alone may do.",
    ]
    lines.append(
        f"Reference: {BY_PROOF}: enclosures of 24 digits and more, proven (symosc.certify), in "
        f"{sum(not row['open'] for row in result['rows'])} of {len(result['rows'])} cases; else {BY_DIGITS} (mpmath)."
    )
    lines += [f"Not proven: {row['group']}, {row['case']}: {row['open']}." for row in result["rows"] if row["open"]]
    settings = [f"{each['name']} {each['tolerance']:g}" for each in result["solvers"] if each["tolerance"]]
    if settings:
        lines.append(f"Tolerances: {', '.join(settings)}.")
    lines += [f"Not run: {name}: {reason}." for name, reason in result["skipped"].items()]
    return [*lines, verdict(result), sentence(result["machine"])]


def verdict(result: Record) -> str:
    """Return in how many cases ours kept its bound, and by how much; else where it did not."""
    bound = "1e-12, or 100 * condition * 1e-16 where that is more"
    if result["violations"]:
        return "\n".join([f"Not within {bound}:", *(f"  {each}" for each in result["violations"])])
    parts = []
    for solver in result["solvers"]:
        if solver["ours"]:
            cells = [row["cells"][solver["name"]] for row in result["rows"]]
            judged = [cell for cell in cells if not cell["failure"]]
            errors = [cell["error"] for cell in judged if cell["error"] is not None]
            largest = f", largest error {max(errors):.0e}" if errors else ""
            absent = f", {len(cells) - len(judged)} not finished" if len(judged) < len(cells) else ""
            parts.append(f"{solver['name']} {len(judged)} of {len(cells)}{largest}{absent}")
    return f"Hard cases solved within {bound}: {'; '.join(parts)}."


class Notes:
    """Footnotes of a table: equal messages share a number."""

    def __init__(self) -> None:
        self.messages: list[str] = []

    def __call__(self, failure: str) -> str:
        """Return what stands for a message in the table: the class of the exception, and a number."""
        kind, _, message = failure.partition(": ")
        name = message.partition(":")[0] if kind == "exception" else kind
        name = "gives up" if name == PeerError.__name__ else name  # it has noticed
        if failure not in self.messages:
            self.messages.append(failure)
        return f"{name} [{self.messages.index(failure) + 1}]"

    def lines(self, form: str) -> list[str]:
        """Return the messages, one a line."""
        if not self.messages:
            return []
        bullet = "- " if form in MARKDOWN else ""
        return ["", *(f"{bullet}[{i}] {message}" for i, message in enumerate(self.messages, 1))]


def _plain(text: str, form: str) -> str:
    return f"`{text}`" if form in MARKDOWN else f"  {text}"


def _tabulate(rows: Sequence[Sequence[str]], heads: Sequence[str], form: str) -> str:
    if form in MARKDOWN:
        return tabulate(rows, heads, tablefmt=form, disable_numparse=True)
    widths = [len(heads[0]), *[HEAD_WIDTH] * (len(heads) - 1)]
    return tabulate(
        rows, heads, tablefmt=form, disable_numparse=True, preserve_whitespace=True, maxheadercolwidths=widths
    )
