"""Which column of a table is the time, the position, the velocity, and whose sample it is."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from itertools import accumulate, islice

from symosc.crosschecks.samples import SAMPLE_COLUMNS, short, shown
from symosc.errors import ParameterError

#: Columns that are asked for by name: of t, x, v and id; None: there is no such column.
Asked = Mapping[str, str | None]

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
#: Names of arrays that hold x and v together.
BOTH_IN_ONE = ("y", "ys", "u", "z", "state", "states", "sol", "solution", "data")
# Column names that a message lists.
COLUMNS_LISTED, LONGEST_LIST = 12, 150
NONE = "none"
# Of a longer name only the beginning is read.
LONGEST_NAME = 200
IN_BRACKETS = re.compile(r"\([^)]*\)|\[[^\]]*\]|\{[^}]*\}")


def asked_columns(columns: Mapping[str, str | None] | None) -> dict[str, str | None]:
    """Return what was asked for by name: of t, x, v and id; "none" or None: there is no such column."""
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


def is_wanted(name: str, asked: Asked | None) -> bool:
    """Tell whether a column may be one that is read; others need not be numbers. All are where `asked` is None."""
    if asked is None or plain(name) in set().union(*USUAL_NAMES.values()):
        return True
    return name.lower() in {column.lower() for column in asked.values() if column} | NO_COLUMNS | set(BOTH_IN_ONE)


def refuse_twice(where: str, names: Iterable[str], asked: Asked | None) -> None:
    """Raise ParameterError if a column that is read is there twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen and is_wanted(name, asked):
            raise ParameterError("file", where, f"has {short(name)!r} twice")
        seen.add(name)


def find_columns(there: Sequence[str], asked: Asked, where: str) -> dict[str, str]:
    """Return the names of the columns t and x, and of v and id if they are there, of all that there are.

    ParameterError if one is missing, or several may be meant; `where` is what the message calls the table.
    """
    missing = f"is missing in {where}; there are: {listed(there)}"
    found: dict[str, str] = {}
    taken = {column for column in asked.values() if column is not None}
    for name, usual in USUAL_NAMES.items():
        column = asked.get(name)
        if column is not None:
            same = [each for each in there if each == column] or [e for e in there if e.lower() == column.lower()]
            if len(set(same)) != 1:
                raise ParameterError("column", column, missing)
            found[name] = same[0]
        elif name not in asked:
            free = [each for each in there if each not in taken]
            fitting = [each for each in free if each == name][:1] or [each for each in free if plain(each) in usual]
            if len(fitting) > 1 and name in SAMPLE_COLUMNS:
                what = f"may be any of {listed(fitting)} in {where}; say which, such as {name}={fitting[0]}"
                raise ParameterError("column", name, what)
            if fitting:
                found[name] = fitting[0]
    for name in ("t", "x"):
        if name not in found:
            raise ParameterError("column", name, missing)
    if "v" not in found and "v" not in asked and set(there) - {*found.values(), *NO_COLUMNS}:
        raise ParameterError("column", "v", f"{missing}; without velocities, which are then computed: v=none")
    return found


def listed(names: Iterable[str]) -> str:
    """Return names for a message."""
    keys = [short(str(key)) for key in names]
    ends = accumulate(len(key) + 2 for key in keys)
    fit = sum(end <= LONGEST_LIST for end in islice(ends, COLUMNS_LISTED)) or 1
    more = [f"and {len(keys) - fit} more"] if len(keys) > fit else []
    return ", ".join(keys[:fit] + more) or "none"
