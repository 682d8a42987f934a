"""Scores as text, Markdown and HTML: a row per group and a row per case, a column per solver."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from itertools import chain

from tabulate import tabulate

from symosc.reference.compare import UNITS_ALLOWED
from symosc.reference.score import CaseScore, Score, by_group

#: Faults of a solver that are listed one by one.
MOST_LISTED_FAULTS = 40
NO_RESULT = "no result"


def case_cell(case: CaseScore) -> str:
    """Return what a solver made of a case, in a few letters.

    Examples
    --------
    >>> case_cell(CaseScore("a", "g", 3, 1.0, units=2.5)), case_cell(CaseScore("a", "g", 3, 1.0, missed=1, invented=2))
    ('2.5', 'missed 1, invented 2')
    >>> case_cell(CaseScore("a", "g", 3, 1.0, units=2.5, without_x=3))
    'no x, 2.5'
    """
    if not case.given:
        return case.note or NO_RESULT
    counts = {"missed": case.missed, "invented": case.invented, "wrong kind": case.kinds}
    faults = [f"{name} {count}" for name, count in counts.items() if count]
    if case.late:
        faults.append(f"error {max(case.error_t or 0.0, case.error_x or 0.0):.0e}")
    if case.stopped is not None:
        faults.append(f"ends at t = {case.stopped:g}")
    if not faults:
        faults = [short_number(case.units) if case.units is not None else "right"]
    return ", ".join(["no x"] * bool(case.without_x) + faults)


def group_cell(cases: Sequence[CaseScore]) -> str:
    """Return what a solver made of a group: how many cases are right, and the largest error in units of these."""
    given, right = [case for case in cases if case.given], [case for case in cases if case.right]
    if not given:
        return next((case.note for case in cases if case.note), NO_RESULT)
    units = [case.units for case in right if case.units is not None]
    largest = f": {short_number(max(units))}" if units else ""
    return f"{len(right)} of {len(cases)}{largest}" + _absent(len(cases) - len(given))


def _absent(count: int) -> str:
    return f" ({count} without result)" if count else ""


def short_number(value: float) -> str:
    """Return a number of units in a few letters."""
    return f"{value:.2g}" if value < 1000 else f"{value:.0e}"


def group_table(scores: Sequence[Score], form: str = "simple") -> str:
    """Return one row per group, and one for all."""
    rows = []
    for group, cases in by_group(scores[0].cases):
        columns = [group_cell([case for case in score.cases if case.group == group]) for score in scores]
        rows.append([group, str(len(cases)), *columns])
    totals = [f"{sum(case.right for case in score.cases)} of {len(score.cases)}" for score in scores]
    rows.append(["all", str(len(scores[0].cases)), *totals])
    rows += _sums(scores)
    return _tabulate(rows, ["group", "cases", *(score.name for score in scores)], form)


def _sums(scores: Sequence[Score]) -> list[list[str]]:
    """Return rows with what all cases have together."""
    counts = {"events missed": "missed", "events invented": "invented", "wrong kinds": "kinds", "large errors": "late"}
    rows = [
        [title, "", *(str(sum(getattr(case, name) for case in score.given)) for score in scores)]
        for title, name in counts.items()
    ]
    grazes = [
        f"{sum(case.grazes_found for case in score.given)} of {sum(case.grazes for case in score.given)}"
        for score in scores
    ]
    rows.append(["grazes reported", "", *grazes])
    times = [[case.seconds for case in score.given if case.seconds is not None] for score in scores]
    if any(times):
        rows.append(["seconds", "", *(f"{sum(each):.3g}" if each else "" for each in times)])
    return rows


def case_table(scores: Sequence[Score], form: str = "simple", with_absent: bool = True) -> str:
    """Return one row per case, perhaps without those of which nobody has results; for one solver more columns."""
    heads, rows = ["case", "events", "condition", *(score.name for score in scores)], []
    alone = len(scores) == 1
    for i, case in enumerate(scores[0].cases):
        if not (with_absent or any(score.cases[i].given or score.cases[i].note for score in scores)):
            continue
        row = [case.name, str(case.events), f"{case.condition:.0e}" if case.condition else ""]
        row += [case_cell(score.cases[i]) for score in scores]
        rows.append(row + [_small(value) for value in (case.error_t, case.error_x, case.seconds)] if alone else row)
    return _tabulate(rows, [*heads, *(["error of t", "error of x", "seconds"] if alone else [])], form)


def _small(value: float | None) -> str:
    return "" if value is None else f"{value:.0e}"


def faults(score: Score) -> list[str]:
    """Return the faults of a solver, one a line; of very many the first."""
    found = [f"{case.name}: {wrong}" for case in score.given for wrong in case.wrong]
    more = [f"and {len(found) - MOST_LISTED_FAULTS} more; --json has all"] if len(found) > MOST_LISTED_FAULTS else []
    return [*found[:MOST_LISTED_FAULTS], *more]


def verdict(score: Score) -> str:
    """Return what came of all cases, in a line.

    Examples
    --------
    >>> right, wrong = CaseScore("a", "g", 3, 1.0), CaseScore("b", "g", 3, 1.0, missed=1, wrong=["missed"])
    >>> verdict(Score("mine", 1e-9, [right, wrong, CaseScore("c", "g", 3, 1.0, given=False)]))
    'mine: right in 1 of 2 cases, wrong in 1; 1 case without results'
    >>> verdict(Score("mine", 1e-9, [right, right]))
    'mine: right in all 2 cases'
    >>> verdict(Score("mine", 1e-9, [right, *[CaseScore("c", "g", 3, 1.0, given=False)] * 2]))
    'mine: right in 1 of 1 cases; 2 cases without results'
    """
    given = score.given
    right, wrong = sum(case.right for case in given), sum(bool(case.wrong) for case in given)
    half, absent = len(given) - right - wrong, len(score.cases) - len(given)
    parts = [f"right in {'all' if right == len(given) > 1 else f'{right} of'} {len(given)} cases"]
    parts += [f"wrong in {wrong}"] * bool(wrong)
    parts += [f"half judged in {half}, where x is not given"] * bool(half)
    rest = f"; {absent} case{'s' if absent > 1 else ''} without results" if absent else ""
    return f"{score.name}: {', '.join(parts)}{rest}"


def legend(score: Score) -> list[str]:
    """Return what the numbers mean."""
    return [
        "Numbers: the largest error of time, relative to max(1, t - t0), and of position, relative to max(1, |x|), in "
        "units of max(1, condition) * 1e-16, which is what rounding the problem's numbers to doubles does. 'right': "
        "nothing happens in the case, and nothing is reported. 'no x': positions are not given, and not judged.",
        f"A case is right if no event is missed, invented or of a wrong kind, and no error is above {score.tolerance:g}"
        f" or {UNITS_ALLOWED:g} units, if that is more; every event has its x, and the case is followed to its end. "
        "Grazes that are not reported are no faults.",
    ]


def as_text(scores: Sequence[Score]) -> str:
    """Return everything for the terminal."""
    found = list(chain.from_iterable(_listed(score) for score in scores))
    parts = [case_table(scores, with_absent=False), group_table(scores), *found, "\n".join(legend(scores[0]))]
    return "\n\n".join([*parts, "\n".join(verdict(score) for score in scores)])


def _listed(score: Score) -> list[str]:
    lines = faults(score)
    return ["\n".join([f"{score.name}, faults:", *(f"  {line}" for line in lines)])] if lines else []


def as_markdown(
    scores: Sequence[Score], title: str, version: int, more: Sequence[str] = (), with_faults: bool = True
) -> str:
    """Return a page in Markdown."""
    parts = [f"# {title}", f"Set of reference cases: version {version}.", *more]
    parts += ["\n".join(f"- {verdict(score)}" for score in scores), *legend(scores[0])]
    parts += [group_table(scores, "github"), "## All cases", case_table(scores, "github")]
    for score in scores if with_faults else ():
        lines = faults(score)
        if lines:
            parts += [f"## Faults of {score.name}", "\n".join(f"- {line}" for line in lines)]
    return "\n\n".join(parts) + "\n"


STYLE_SHEET = """body { font: 15px/1.4 sans-serif; margin: 2em auto; max-width: 75em; padding: 0 1em }
table { border-collapse: collapse; margin: 1em 0 } td, th { padding: .15em .7em; text-align: left }
tr:nth-child(even) { background: #f2f2f2 } th { border-bottom: 1px solid }"""


def as_html(scores: Sequence[Score], title: str, version: int) -> str:
    """Return a page in HTML that needs no other file."""
    parts = [f"<h1>{escape(title)}</h1>", f"<p>Set of reference cases: version {version}.</p>", "<ul>"]
    parts += [*(f"<li>{escape(verdict(score))}</li>" for score in scores), "</ul>"]
    parts += [f"<p>{escape(line)}</p>" for line in legend(scores[0])]
    parts += [group_table(scores, "html"), "<h2>All cases</h2>", case_table(scores, "html")]
    for score in scores:
        lines = faults(score)
        if lines:
            items = "\n".join(f"<li>{escape(line)}</li>" for line in lines)
            parts.append(f"<h2>Faults of {escape(score.name)}</h2>\n<ul>\n{items}\n</ul>")
    head = f'<meta charset="utf-8">\n<title>{escape(title)}</title>\n<style>\n{STYLE_SHEET}\n</style>'
    body = "\n".join(parts)
    return f'<!DOCTYPE html>\n<html lang="en">\n<head>\n{head}\n</head>\n<body>\n{body}\n</body>\n</html>\n'


def _tabulate(rows: Sequence[Sequence[str]], heads: Sequence[str], form: str) -> str:
    if form == "github":  # a bar would end the cell
        rows, heads = (
            [[each.replace("|", "\\|") for each in row] for row in rows],
            [h.replace("|", "\\|") for h in heads],
        )
    return tabulate(rows, heads, tablefmt=form, disable_numparse=True)
