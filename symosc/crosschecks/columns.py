"""Which column of a table is the time, the position, the velocity, and whose sample it is."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, islice

from symosc.crosschecks.samples import SAMPLE_COLUMNS, short, shown
from symosc.errors import ParameterError

#: Column that says which of several trajectories a row belongs to.
ID_COLUMN = "id"
#: What the columns are called where nothing else is said; in any case, units in brackets left out.
USUAL_NAMES = {
    "t": {"t", "time", "times", "ts"},
    "x": {"x", "position", "positions", "pos", "displacement", "disp", "q", "xs"},
    "v": {"v", "velocity", "velocities", "vel", "speed", "xdot", "dx", "dxdt", "xprime", "qdot", "vx", "vs"},
    ID_COLUMN: {"id", "ids", "trajectory", "trajectories", "traj", "run", "case", "motion", "trajectoryid", "runid"},
}
#: Entries of a file or a mapping that are no columns of samples.
NO_COLUMNS = {"events"}
# Column names that a message lists.
COLUMNS_LISTED, LONGEST_LIST = 12, 150
NONE = "none"
# Of a longer name only the beginning is looked at.
LONGEST_NAME = 200
IN_BRACKETS = re.compile(r"\([^)]*\)|\[[^\]]*\]|\{[^}]*\}")


def asked_columns(columns: Mapping[str, str | None] | None) -> dict[str, str | None]:
    """Return what was asked for by name: of t, x, v and id; "none" or None: there is no such column.

    Raises
    ------
    ParameterError
        If `columns` is no mapping of them to names, or two of them have one name.
    """
    if columns is not None and not isinstance(columns, Mapping):
        raise ParameterError("columns", shown(columns), 'must be a mapping, such as {"x": "position"}')
    asked: dict[str, str | None] = {}
    for name, column in dict(columns or {}).items():
        if name not in USUAL_NAMES:
            raise ParameterError("columns", shown(name), "only t, x and v are read, and id")
        if column is not None and not isinstance(column, str):
            raise ParameterError("columns", shown(column), f"must be text: the name of the column that holds {name}")
        asked[name] = None if column is not None and column.lower() == NONE else column
        if asked[name] is None and name in ("t", "x"):
            raise ParameterError("columns", f"{name}={NONE}", "a time and a position are needed")
    named = [column for column in asked.values() if column is not None]
    named += [name for name in SAMPLE_COLUMNS if name not in asked]
    if len(set(named)) < len(named):
        raise ParameterError("columns", asked, "t, x and v must be three columns")
    return asked


def plain(name: str) -> str:
    """Return a name in small letters without units, brackets and signs: "Time (s)" is "time", "dx/dt" is "dxdt"."""
    text = unicodedata.normalize("NFKD", name[:LONGEST_NAME]).lower().replace("\u0307", "dot").replace("'", "prime")
    text = IN_BRACKETS.sub("", text) or text
    return "".join(letter for letter in text if letter.isalnum())


def find_columns(there: Sequence[str], asked: Mapping[str, str | None], where: str) -> dict[str, str]:
    """Return the names of the columns t and x, and of v and id if they are there.

    Parameters
    ----------
    there : sequence of str
        The table's own names.
    asked : mapping
        See `asked_columns`.
    where : str
        What a message calls the table.

    Raises
    ------
    ParameterError
        If a column is missing, or several may be meant.
    """
    found: dict[str, str] = {}
    taken = {column for column in asked.values() if column is not None}
    for name in USUAL_NAMES:
        if name in asked:
            column = asked[name] if asked[name] is None else _asked(there, str(asked[name]), where)
        else:
            column = _usual(there, name, taken, where)
        if column is not None:
            found[name] = column
    for name in ("t", "x"):
        if name not in found:
            raise ParameterError("column", name, _missing(there, where))
    others = [name for name in there if name not in {*found.values(), *NO_COLUMNS}]
    if "v" not in found and "v" not in asked and others:
        more = "without velocities, which are then computed: v=none"
        raise ParameterError("column", "v", f"{_missing(there, where)}; {more}")
    return found


def _asked(there: Sequence[str], column: str, where: str) -> str:
    same = [name for name in there if name == column] or [name for name in there if name.lower() == column.lower()]
    if len(set(same)) != 1:
        raise ParameterError("column", column, _missing(there, where))
    return same[0]


def _usual(there: Sequence[str], name: str, taken: set[str], where: str) -> str | None:
    if name in there and name not in taken:
        return name
    fitting = [column for column in there if plain(column) in USUAL_NAMES[name] and column not in taken]
    if len(fitting) > 1 and name in SAMPLE_COLUMNS:
        what = f"may be any of {listed(fitting)} in {where}; say which, such as {name}={fitting[0]}"
        raise ParameterError("column", name, what)
    return fitting[0] if fitting else None


def _missing(there: Iterable[str], where: str) -> str:
    return f"is missing in {where}; there are: {listed(there)}"


def listed(names: Iterable[str]) -> str:
    """Return names for a message."""
    keys = [short(str(key)) for key in names]
    ends = accumulate(len(key) + 2 for key in keys)
    fit = sum(end <= LONGEST_LIST for end in islice(ends, COLUMNS_LISTED)) or 1
    more = [f"and {len(keys) - fit} more"] if len(keys) > fit else []
    return ", ".join(keys[:fit] + more) or "none"
