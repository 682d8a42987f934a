"""Which of the columns of a file or a table are t, x, v and the id of a solution."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, brief
from symosc.crosschecks.samples import SAMPLE_COLUMNS

#: Columns asked for by name: of t, x, v and id; None: there is no such column.
Asked = Mapping[str, str | None]
#: The column that says to which of several trajectories a row belongs.
ID_COLUMN = "id"
#: The usual names of columns, in any case and without units.
USUAL_NAMES = {
    "t": {"t", "time", "times", "ts"},
    "x": {"x", "position", "positions", "pos", "displacement", "disp", "q", "xs"},
    "v": {
        "v", "velocity", "velocities", "vel", "speed", "xdot", "dx", "dxdt", "xprime", "qdot",
        "vx", "vs",
    },
    ID_COLUMN: {
        "id", "ids", "trajectory", "trajectories", "traj", "run", "case", "motion", "trajectoryid",
        "runid",
    },
}  # fmt: skip
#: A list of events beside the columns of samples.
EVENTS = "events"
#: Events of scipy's solve_ivp and of MATLAB's ode45; they are no columns of samples either.
SOLVER_EVENTS = ("t_events", "y_events", "te", "xe", "ye", "ie")
#: Names of arrays that hold x and v together.
STATE_NAMES = ("y", "ys", "u", "z", "state", "states", "sol", "solution", "data")
#: In place of the name of a column that is missing.
NONE = "none"
MOST_NAMES = 12  # in a message


@dataclass(frozen=True)
class NamedColumns:
    """Solutions as they were given: columns by name, and what is known beside them.

    `are_matched`: the columns are called t, x, v and id already. `are_padded`: times end with inf.
    `dense` is the solver's own function t -> (x, v), `notes` say how the columns were read.
    """

    columns: Record
    are_matched: bool = False
    are_padded: bool = False
    notes: tuple[str, ...] = ()
    dense: Callable[..., Any] | None = None


def read_column_names(columns: Mapping[str, str | None] | None) -> dict[str, str | None]:
    """Check and return `columns`, column names by t, x, v and id.

    "none", for a missing column, becomes None.
    """
    if columns is not None and not isinstance(columns, Mapping):
        raise ParameterError("columns", columns, 'must be a mapping, such as {"x": "position"}')
    asked: dict[str, str | None] = {}
    for name, column in (columns or {}).items():
        if name not in USUAL_NAMES:
            raise ParameterError("columns", name, "only t, x and v are read, and id")
        if column is not None and not isinstance(column, str):
            raise ParameterError(
                "columns", column, f"must be text: the name of the column that holds {name}"
            )
        is_missing = column is None or column.lower() == NONE
        if is_missing and name in ("t", "x"):
            raise ParameterError("columns", f"{name}={NONE}", "a time and a position are needed")
        asked[name] = None if is_missing else column
    named = [column for column in asked.values() if column is not None]
    named += [name for name in SAMPLE_COLUMNS if name not in asked]
    if len(set(named)) < len(named):
        raise ParameterError("columns", asked, "t, x and v must be three columns")
    return asked


def plain(name: str) -> str:
    """Return a column name in lower case without units, brackets and signs.

    "Time (s)" is "time", "dx/dt" is "dxdt".
    """
    text = unicodedata.normalize("NFKD", name[:200]).lower()
    text = text.replace("\u0307", "dot").replace("'", "prime")
    text = re.sub(r"\([^)]*\)|\[[^\]]*\]|\{[^}]*\}", "", text) or text
    return "".join(letter for letter in text if letter.isalnum())


def is_wanted(name: str, asked: Asked | None) -> bool:
    """Return whether to read the column `name`: any if `asked` is None, else one that is asked for
    or has a usual name.
    """
    if asked is None or plain(name) in set().union(*USUAL_NAMES.values()):
        return True
    by_name = {column.lower() for column in asked.values() if column}
    return name.lower() in by_name | {EVENTS, *STATE_NAMES, *SOLVER_EVENTS}


def refuse_twice(where: str, names: Iterable[str], asked: Asked | None) -> None:
    """Raise ParameterError if the name of a column to be read occurs twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen and is_wanted(name, asked):
            raise ParameterError("file", where, f"has {brief(name)!r} twice")
        seen.add(name)


def find_columns(names: Sequence[str], asked: Asked, where: str) -> dict[str, str]:
    """Return the names of t and x, and of v and id if present, among the columns `names` of
    `where`: those that are `asked` for, else usual names. ParameterError if that is not clear.
    """
    missing = f"is missing in {where}; there are: {names_text(names)}"
    columns: dict[str, str] = {}
    free = [name for name in names if name not in asked.values()]
    for name, usual in USUAL_NAMES.items():
        wanted = asked.get(name)
        if wanted is not None:
            # As it is written, else in capitals or small letters.
            alike = [column for column in names if column == wanted]
            alike = alike or [column for column in names if column.lower() == wanted.lower()]
            if len(set(alike)) != 1:
                raise ParameterError("column", wanted, missing)
            columns[name] = alike[0]
        elif name not in asked:  # what is asked as None is not to be looked for
            fitting = [column for column in free if column == name][:1]
            fitting = fitting or [column for column in free if plain(column) in usual]
            if len(fitting) > 1 and name in SAMPLE_COLUMNS:
                example = f"say which one, for example {name}={fitting[0]}"
                what = f"could be any of {names_text(fitting)} in {where}; {example}"
                raise ParameterError("column", name, what)
            if fitting:
                columns[name] = fitting[0]
    for name in ("t", "x"):
        if name not in columns:
            unused = [column for column in free if column not in columns.values()]
            advice = f"; say which, such as {name}={brief(unused[0])}" if unused else ""
            raise ParameterError("column", name, missing + advice)
    # A table of t and x alone is a solution without velocities; with further columns one may be v.
    has_other_columns = bool(set(names) - {*columns.values(), EVENTS})
    if "v" not in columns and "v" not in asked and has_other_columns:
        what = f"{missing}; without velocities, which are then computed: v=none"
        raise ParameterError("column", "v", what)
    return columns


def find_text_columns(names: list[str], asked: Asked, where: str) -> dict[str, str]:
    """Return the names of t, x and perhaps v, id among the columns of a text table.

    A table without a header has the numbers of its columns for names.
    """
    is_numbered = names == [str(i + 1) for i in range(len(names))]
    if not is_numbered or set(asked.values()) & set(names):
        return find_columns(names, asked, where)
    if len(names) not in (2, 3):
        what = f"has no header and {len(names)} columns; say which are meant, such as t=1,x=2,v=3"
        raise ParameterError("file", where, what)
    numbers = dict(zip(SAMPLE_COLUMNS, names, strict=False))
    columns = find_columns([*numbers], asked, where)
    return {name: numbers[column] for name, column in columns.items()}


def names_text(names: Sequence[str]) -> str:
    """Return the first few names, joined for a message."""
    shown = [brief(name) for name in names[:MOST_NAMES]]
    if len(names) > MOST_NAMES:
        shown.append(f"and {len(names) - MOST_NAMES} more")
    return ", ".join(shown) or "none"
