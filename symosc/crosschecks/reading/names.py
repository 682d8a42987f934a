"""Which of the columns of a file or a table are t, x, v, and the id or the kind of a row.

Names are matched by a table of synonyms. `--columns`, or `columns=`, names a column by its name, its
number or NAME[i].
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from difflib import get_close_matches
from functools import cache
from itertools import pairwise

from symosc.base.errors import ParameterError, brief
from symosc.crosschecks.samples import SAMPLE_COLUMNS

#: Columns asked for: names or numbers by t, x, v, id and kind; None: there is no such column.
Asked = Mapping[str, str | None]
#: The column that says to which of several trajectories a row belongs.
ID_COLUMN = "id"
#: The column of the kinds of events.
KIND_COLUMN = "kind"
ROLES = (*SAMPLE_COLUMNS, ID_COLUMN)
#: The usual names of columns, in any case and without units.
SYNONYMS = {
    "t": """t time times ts tt timestamp timestamps tout simtime elapsed seconds sec secs clock
        zeit temps tempo tiempo tid tijd czas čas aika время 时间 時間 時刻 시간""",
    "x": """x xs position positions pos displacement displacements disp distance deflection elongation
        coordinate q weg auslenkung lage ort position schwingweg verschiebung déplacement
        deplacement posición posicion desplazamiento posizione spostamento verplaatsing posição posicao
        deslocamento перемещение координата положение 位移 位置 変位 위치 변위""",
    "v": """v vs velocity velocities velo vel speed xdot dx dxdt xprime qdot dq vx derx dotx xd xp
        geschwindigkeit geschw schnelle vitesse velocidad velocità velocita snelheid velocidade
        скорость 速度 속도""",
    ID_COLUMN: "id ids trajectory trajectories traj run case motion trajectoryid runid",
    KIND_COLUMN: "kind kinds event type",
}  # fmt: skip
#: Names that are positions where no other column is.
WEAK_POSITIONS = "y u z s w r xx theta phi output response signal value"
#: Forms of the name of a derivative, given that of a position.
DERIVATIVES = ("{}dot", "d{}", "d{}dt", "{}prime", "{}p", "{}d", "der{}", "dot{}", "v{}", "{}v",
               "{}t", "{}vel", "{}punkt", "{}velocity", "{}speed")  # fmt: skip
#: Units at the end of a name, behind a line, a slash, a colon or "in".
UNITS = (
    r"(s|sec|secs|seconds?|ms|m|mm|cm|m_?s|m_?per_?s|mps|m/s|mm/s|cm/s|meters?|metres?|rad|rad/s)"
)
#: A list of events beside the columns of samples.
EVENTS = "events"
#: Events of scipy's solve_ivp and of MATLAB's ode45; they are no columns of samples either.
SOLVER_EVENTS = ("t_events", "y_events", "te", "xe", "ye", "ie")
#: In place of the name of a column that is missing.
NONE = "none"
MOST_NAMES = 12  # in a message
LONGEST_NAME = 30  # in an option that a message shows


def read_column_names(
    columns: Mapping[str, str | None] | None, roles: Sequence[str] = ROLES
) -> dict[str, str | None]:
    """Check and return `columns`, column names by t, x, v and the other `roles`.

    "none", for a missing column, becomes None.
    """
    if columns is not None and not isinstance(columns, Mapping):
        raise ParameterError("columns", columns, 'must be a mapping, such as {"x": "position"}')
    asked: dict[str, str | None] = {}
    for name, column in (columns or {}).items():
        if name not in roles:
            *first, last = roles
            raise ParameterError("columns", name, f"must be one of {', '.join(first)} and {last}")
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


# -- names without what is about them --------------------------------------------------------------


@cache
def plain(name: str) -> str:
    """Return a column name in lower case without units, brackets and signs.

    "Time (s)" is "time", "dx/dt" is "dxdt", "y[2]" and "y(:, 2)" are "y2", "der(x)" is "derx".
    """
    text = unicodedata.normalize("NFKD", name[:200]).lower()
    text = text.replace("\u0307", "dot").replace("'", "prime").replace("′", "prime")
    text = re.sub(r"^\s*(der|diff|d)\(([^()]+)\)(\s*/\s*dt)?", r"der\2", text)
    text = re.sub(r"[(\[{]([\d:,\s]*\d[\d:,\s]*)[)\]}]", _index, text)
    text = re.sub(r"\([^)]*\)|\[[^\]]*\]|\{[^}]*\}", "", text) or text
    text = re.sub(rf"(?<=\w)(\s*/\s*|\s*:\s*|_|\s+in\s+){UNITS}\s*$", "", text)
    return "".join(letter for letter in text if letter.isalnum())


def _index(match: re.Match[str]) -> str:
    """Return the index in brackets as digits: of two, the one that is not 1."""
    numbers = re.findall(r"\d+", match[1])
    telling = [number for number in numbers if number != "1"] or numbers[:1]
    return "n".join(telling)


USUAL_NAMES = {role: {plain(word) for word in words.split()} for role, words in SYNONYMS.items()}
WEAK_NAMES = {plain(word) for word in WEAK_POSITIONS.split()}


def is_usual(name: str) -> bool:
    """Return whether a name is a usual one of some column."""
    return any(plain(name) in names for names in USUAL_NAMES.values())


SIGNS = re.compile(r"[\s,;:.()\[\]{}/_]+")


def _role_by_words(name: str) -> str | None:
    """Return the role that the words of a name such as "velocity of the mass" have.

    None if they have none, or several; v counts more than x, as in "x velocity".
    """
    if plain(name)[-1:].isdecimal():  # one of several
        return None
    words = [plain(word) for word in SIGNS.split(name.lower()) if word]
    roles = {role for word in words for role in SAMPLE_COLUMNS if word in USUAL_NAMES[role]}
    if roles == {"x", "v"}:
        return "v"
    return roles.pop() if len(roles) == 1 else None


# -- columns that are asked for --------------------------------------------------------------------


def asked_places(names: Sequence[str], asked: Asked, where: str) -> dict[str, int]:
    """Return the places of the columns that are asked for by name, number or NAME[i].

    Numbers begin with 1; where one is 0 they begin with 0. A name counts more than a number.
    """
    wanted = {role: column for role, column in asked.items() if column is not None}
    digits = {column for column in wanted.values() if column.isdecimal()}
    # Where a number is no name, none of them is.
    are_numbers = not digits <= set(names)
    first = 0 if "0" in digits else 1
    places: dict[str, int] = {}
    for role, column in wanted.items():
        if column in digits and are_numbers:
            place: int | None = int(column) - first if len(column) < 6 else len(names)
            if place not in range(len(names)):
                place = None
        else:
            place = _place_of(names, _from_one(column, names, wanted.values()))
        if place is None and role == "x" and f"{column}[1]" in names and "v" not in wanted:
            place = names.index(f"{column}[1]")  # a matrix of states
            if f"{column}[2]" in names and "v" not in asked:
                places["v"] = names.index(f"{column}[2]")
        if place is None:
            usual = [name for name in names if plain(name) in USUAL_NAMES[role]]
            alike = usual or get_close_matches(column, names, 1, 0.0)
            example = option_text({role: names.index(alike[0])} if alike else {}, names)
            raise ParameterError(
                "column", column, f"not found in {where}; {found_text(names, example)}"
            )
        places[role] = place
    return places


def _from_one(column: str, names: Sequence[str], wanted: Iterable[str]) -> str:
    """Return NAME[i] with an index from 1, if NAME[0] is asked for as well but is no column."""
    name, bracket, index = column.rpartition("[")
    first = f"{name}[0]"
    if not bracket or first in names or first not in wanted:
        return column
    number = index.removesuffix("]")
    return f"{name}[{int(number) + 1}]" if number.isdecimal() else column


def _place_of(names: Sequence[str], column: str) -> int | None:
    """Return the place of a column by its name: as it is written, in other letters, by its path in
    a file, or without its unit; None if there is none, or more than one.
    """
    forms: tuple[Callable[[str], str], ...] = (
        str,
        str.lower,
        lambda name: name.lower().replace("/", ".").strip(". "),
        plain,
    )
    for form in forms:
        places = [i for i, name in enumerate(names) if form(name) == form(column)]
        if len(places) == 1 or len({names[i] for i in places}) == 1:
            return places[0]
    # A group that holds all is left out of the names.
    path = column.lower().replace("/", ".").strip(".")
    places = [i for i, name in enumerate(names) if path.endswith("." + name.lower())]
    return places[0] if len(places) == 1 else None


# -- columns that are found ------------------------------------------------------------------------


def find_columns(
    names: Sequence[str],
    asked: Asked,
    where: str,
    *,
    advice: Callable[[], Mapping[str, int]] = dict,
    needs_v: bool = True,
    with_kinds: bool = False,
) -> dict[str, int]:
    """Return the places of t and x, and of v and id if present, among the columns `names` of `where`.

    They are those `asked` for, else those with usual names. `advice` returns the places of columns
    that may be meant, for messages. ParameterError if it is not clear which column is which: of v
    only if it `needs_v`. `with_kinds`: t and kind will do.
    """
    given = asked_places(names, asked, where)
    for place in given.values():
        is_by_name = names[place] in asked.values()
        if is_by_name and names.count(names[place]) > 1:
            raise _twice(names, place, where)
    missing = {role for role, column in asked.items() if column is None}
    found: list[dict[str, int]] = []
    refusals: list[ParameterError] = []
    for view in _views(names):
        try:
            found.append(_in_view(view, names, given, missing, where))
        except ParameterError as refusal:
            found.append(dict(given))
            refusals.append(refusal)
    if with_kinds:
        for places in found:
            if KIND_COLUMN in places and "t" in places:
                return {role: places[role] for role in ("t", KIND_COLUMN)}
    # Of groups of columns, the outermost that has all; else the one that has most.
    best = max(found, key=lambda places: _rank(places, missing))
    groups = [places for places in found if _rank(places, missing) == _rank(best, missing)]
    if refusals and _rank(best, missing) < len(SAMPLE_COLUMNS):
        raise refusals[0]
    root, *_ = found
    if best is not root and len(groups) > 1 and not set(SAMPLE_COLUMNS) <= given.keys():
        what = f"has {len(groups)} groups of columns that may be meant"
        example = option_text(groups[0], names)
        raise ParameterError("file", where, f"{what}; {found_text(names, example)}")
    best.pop(KIND_COLUMN, None)
    for role in ("t", "x"):
        if role not in best:
            example = _example(names, best, missing, advice())
            raise ParameterError(
                "column", role, f"not found in {where}; {found_text(names, example)}"
            )
    for role, place in best.items():
        if role not in given and names.count(names[place]) > 1:
            raise _twice(names, place, where)
    # A table of t and x alone is a solution without velocities; with further columns one may be v.
    if needs_v and "v" not in best and "v" not in missing:
        own = names[best["x"]]
        others = {
            name
            for i, name in enumerate(names)
            if name and i not in best.values() and not name.startswith(f"{own}[")
        }
        if others - {own}:
            example = _example(names, best, missing, advice())
            what = f"not found in {where}; {found_text(names, example)}"
            raise ParameterError("column", "v", f"{what}; v=none: symosc computes the velocities")
    return best


def _rank(places: Mapping[str, int], missing: Iterable[str]) -> int:
    """Return how much of t, x and v is found."""
    return len({*places, *missing} & set(SAMPLE_COLUMNS))


def _twice(names: Sequence[str], place: int, where: str) -> ParameterError:
    """Return the error that says that a column's name occurs twice."""
    what = f"has {brief(names[place])!r} twice"
    return ParameterError("file", where, f"{what}; {found_text(names, f'x={place + 1}')}")


def _example(
    names: Sequence[str],
    places: Mapping[str, int],
    missing: Iterable[str],
    advice: Mapping[str, int],
) -> str:
    """Return the option that names the columns which are not found: those of `advice`, else others."""
    taken = set(places.values())
    example: dict[str, int] = {}
    for role in SAMPLE_COLUMNS:
        if role in places or role in missing:
            continue
        free = [
            i for i, name in enumerate(names) if i not in taken and name and name != KIND_COLUMN
        ]
        place = advice.get(role, -1)
        if place not in free:
            place = free[0] if free else -1
        if place >= 0:
            example[role] = place
            taken.add(place)
    return option_text(example, names)


def _views(names: Sequence[str]) -> Iterable[dict[int, str]]:
    """Yield the groups of columns: short names by their places, the outermost group first.

    "t", "run.x" and "run.v" have a group of all, by their whole names, and the group "run", which
    sees "t" as well. The last one has Simulink's signals by the names of their variables.
    """
    yield dict(enumerate(names))
    paths = [name.split(".") for name in names]
    groups = {tuple(path[:end]) for path in paths for end in range(1, len(path))}
    for group in sorted(groups, key=lambda group: (len(group), names_place(paths, group))):
        view: dict[int, str] = {}
        inner = {path[-1] for path in paths if tuple(path[:-1]) == group}
        for i, path in enumerate(paths):
            parents = tuple(path[:-1])
            if parents == group or (parents == group[: len(parents)] and path[-1] not in inner):
                view[i] = path[-1]
        yield view
    signals = {i: path[-3] for i, path in enumerate(paths) if path[-2:] == ["signals", "values"]}
    if signals:
        first = next(iter(signals))
        own_time = ".".join([*paths[first][:-2], "time"])
        times = {i: "time" for i, name in enumerate(names) if name == own_time}
        yield times | signals


def names_place(paths: Sequence[Sequence[str]], group: tuple[str, ...]) -> int:
    """Return the place of the first column in a group."""
    return next(i for i, path in enumerate(paths) if tuple(path[: len(group)]) == group)


def _in_view(
    view: Mapping[int, str],
    names: Sequence[str],
    given: Mapping[str, int],
    missing: Iterable[str],
    where: str,
) -> dict[str, int]:
    """Return the places of the columns that a group has, by role."""
    free = {i: name for i, name in view.items() if i not in given.values()}
    places = dict(given)

    def look(role: str, *tests: Callable[[str], bool]) -> None:
        """Enter the column of a role, by the first of the tests that one column passes."""
        if role in places or role in missing:
            return
        for test in tests:
            fitting = [i for i, name in free.items() if i not in places.values() and test(name)]
            if len({view[i] for i in fitting}) > 1 and role in SAMPLE_COLUMNS:
                listed = " or ".join(brief(names[i]) for i in fitting[:MOST_NAMES])
                example = option_text({role: fitting[0]}, names)
                what = f"could be {listed} in {where}; {found_text(names, example)}"
                raise ParameterError("column", role, what)
            if fitting:
                places[role] = fitting[0]
                return

    def is_usual(role: str) -> Callable[[str], bool]:
        return lambda name: plain(name) in USUAL_NAMES[role]

    def has_words(role: str) -> Callable[[str], bool]:
        return lambda name: _role_by_words(name) == role

    look("t", lambda name: name == "t", is_usual("t"))
    look("x", lambda name: name == "x", is_usual("x"))
    if "x" in places:
        base = plain(view.get(places["x"], names[places["x"]]))
        derivatives = {form.format(base) for form in DERIVATIVES}
        look("v", lambda name: name == "v", lambda name: plain(name) in derivatives)
    look("v", lambda name: name == "v", is_usual("v"))
    look("t", has_words("t"))
    look("x", has_words("x"))
    look("v", has_words("v"))
    if "x" not in places:
        places |= _pair(free, places, missing)
    look("x", lambda name: plain(name) in WEAK_NAMES)
    if "x" in places and "v" not in places:
        base = plain(view.get(places["x"], names[places["x"]]))
        look("v", lambda name: plain(name) in {form.format(base) for form in DERIVATIVES})
    # The index of a table has no name, and may be the time.
    if {"x", "t"} & places.keys() == {"x"} and free.get(0) == "":
        places["t"] = 0
    look(ID_COLUMN, lambda name: name == ID_COLUMN, is_usual(ID_COLUMN))
    look(KIND_COLUMN, lambda name: name == KIND_COLUMN, is_usual(KIND_COLUMN))
    return places


def _pair(
    free: Mapping[int, str], places: Mapping[str, int], missing: Iterable[str]
) -> dict[str, int]:
    """Return the places of x and v, or of t, x and v, that are numbered or a name and its
    derivative.

    x1 and x2 are x and v, beside a time; 1, 2 and 3 are t, x and v. {} if that is not clear.
    """
    left = {i: plain(name) for i, name in free.items() if i not in places.values()}
    families: dict[str, dict[int, int]] = {}
    for i, name in left.items():
        numbered = re.fullmatch(r"(.*?\D|)(\d{1,6})", name)
        if numbered:
            families.setdefault(numbered[1], {})[int(numbered[2])] = i
    roles = [role for role in SAMPLE_COLUMNS if role not in places]
    fitting = []
    for base, members in families.items():
        order = sorted(members)
        follow = all(after - before == 1 for before, after in pairwise(order))
        # Velocities of two masses, or of belts, are no state.
        if follow and order[0] <= 1 and not (base == "v" and "t" in places):
            fitting.append([members[number] for number in order])
    whole = [family for family in fitting if len(family) == len(roles)]
    if len(whole) == 1:
        pairs = zip(roles, whole[0], strict=True)
        return {role: place for role, place in pairs if role not in missing}
    # Two columns alone are times and positions.
    if len(left) == 2 and fitting and len(fitting[0]) == 2 and "t" not in places:
        return dict(zip(("t", "x"), fitting[0], strict=True))
    # x1 and v1 of the only mass
    single = [families.get(base, {}) for base in ("x", "v")]
    if all(len(members) == 1 for members in single):
        (x,), (v,) = (members.values() for members in single)
        return {"x": x, "v": v}
    by_name = {name: i for i, name in left.items()}
    derived = [
        {"x": i, "v": by_name[form.format(name)]}
        for name, i in by_name.items()
        for form in DERIVATIVES
        if name and form.format(name) in by_name
    ]
    if len(derived) == 1 and not set(derived[0]) & {*places, *missing}:
        return derived[0]
    return {}


# -- messages --------------------------------------------------------------------------------------


def unsure_names(names: Sequence[str], places: Mapping[str, int], asked: Asked) -> list[str]:
    """Return notes on columns that were taken for want of better ones: x by a weak name, such as y,
    and t without a name.
    """
    notes = []
    x = places.get("x", -1)
    if "x" not in asked and x >= 0 and plain(names[x]) in WEAK_NAMES:
        notes.append(
            f"x is the column {brief(names[x])}; say so by --columns x=... if it is another"
        )
    t = places.get("t", -1)
    if "t" not in asked and t >= 0 and not names[t]:
        notes.append("t is the first column, which has no name")
    return notes


def names_text(names: Sequence[str]) -> str:
    """Return the first few names, joined for a message."""
    shown = [brief(name) or "(no name)" for name in names[:MOST_NAMES]]
    if len(names) > MOST_NAMES:
        shown.append(f"and {len(names) - MOST_NAMES} more")
    return ", ".join(shown) or "none"


def found_text(names: Sequence[str], example: str = "") -> str:
    """Return the sentence that lists the columns, and asks which is which; `example` is an option."""
    if not names:
        return "it has no columns"
    such = f", such as --columns {example}" if example else ""
    return f"its columns are {names_text(names)}; say which is which by name or number{such}"


def option_text(places: Mapping[str, int], names: Sequence[str]) -> str:
    """Return the value of --columns that names these columns; a name that needs quotes by number."""
    parts = []
    for role in (*SAMPLE_COLUMNS, KIND_COLUMN):
        place = places.get(role, -1)
        if place in range(len(names)):
            name = names[place]
            is_short = re.fullmatch(r"[\w.\[\]/-]+", name, re.ASCII) and len(name) <= LONGEST_NAME
            is_clear = is_short and names.count(name) == 1 and not name.isdecimal()
            parts.append(f"{role}={name if is_clear else place + 1}")
    return ",".join(parts)
