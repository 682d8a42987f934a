"""Check the arguments of public functions: kinds of values, and the lines that require them.

A public function begins with a line for each kind of argument, ``require(TEXT, mapping=mapping)``,
and with one for each argument that it converts, ``p = parameters_of(p)``. Whether a number is in
range, or a name exists, is checked where the number or the name is used. No package is loaded for
any of these checks.
"""

from __future__ import annotations

import inspect
import numbers
import re
from collections.abc import Callable, Mapping, Sequence, Set
from decimal import Decimal
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from symosc.base.errors import ParameterError, meant
from symosc.base.exact import is_scalar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

#: The most entries of a list or a range that is read at all, and the greatest depth of lists in
#: lists.
MOST_ENTRIES = 10**8
MOST_DEPTH = 8


def _never(_: Any) -> bool:
    return False


class Kind:
    """A kind of value that an argument may be, such as a number or a scene.

    Parameters
    ----------
    text : str
        What it is, for messages.
    by_type : function
        Whether all values of a type are of this kind.
    by_value : function
        Whether a value is of this kind although its type alone does not tell.
    made_by : str
        The call that makes one, for messages; classes of answers have an attribute
        `_made_by`.
    """

    __slots__ = ("_by_type", "_by_value", "_known", "_made_by", "text")

    def __init__(
        self,
        text: str,
        by_type: Callable[[type], bool] = _never,
        by_value: Callable[[Any], bool] = _never,
        made_by: str = "",
    ) -> None:
        self.text = text
        self._made_by = made_by
        self._by_type = by_type
        self._by_value = by_value
        # Types of which all values are of this kind: they are not looked at again.
        self._known = set[type]()

    def takes(self, value: object) -> bool:
        """Return whether a value is of this kind."""
        if type(value) in self._known:
            return True
        if self._by_type(type(value)):
            self._known.add(type(value))
            return True
        return self._by_value(value)


def require(*kinds: Kind | type, **arguments: object) -> None:
    """Raise ParameterError unless each of the `arguments` is of one of the `kinds`.

    A class stands for its instances.
    """
    for name, value in arguments.items():
        if not _fits(kinds, value):
            raise _refusal(name, value, kinds)


def require_or_none(*kinds: Kind | type, **arguments: object) -> None:
    """Raise ParameterError unless each of the `arguments` is None or of one of the `kinds`."""
    for name, value in arguments.items():
        if value is not None and not _fits(kinds, value):
            raise _refusal(name, value, (*kinds, NONE))


def _fits(kinds: Sequence[Kind | type], value: object) -> bool:
    """Return whether a value is of one of the kinds."""
    for kind in kinds:
        if isinstance(kind, Kind):
            fits = kind.takes(value)
        else:
            fits = isinstance(value, kind)
        if fits:
            return True
    return False


def _refusal(name: str, value: object, kinds: Sequence[Kind | type]) -> ParameterError:
    """Return the error that a value is of none of the kinds."""
    hint = ""
    if len(kinds) == 1:
        source = getattr(kinds[0], "_made_by", "")
        if source:
            hint = f"; {source} makes one"
    if type(value).__module__.startswith("symosc."):  # an answer, in place of what it is about
        for attribute in ("parameters", "word"):
            if _fits(kinds, getattr(value, attribute, None)):
                hint = f"; give its .{attribute}"
                break
    return ParameterError(name, value, f"must be {_text(kinds)}{hint}")


def _text(kinds: Sequence[Kind | type]) -> str:
    """Return the texts of kinds, joined by commas and "or", for a message."""
    *first, last = dict.fromkeys(map(_text_of, kinds))
    if first:
        return f"{', '.join(first)} or {last}"
    return last


def _text_of(kind: Kind | type) -> str:
    """Return the name of a kind of argument in messages, such as "an Atlas"."""
    if isinstance(kind, Kind):
        return kind.text
    if kind.__name__ == "Parameters":  # a plural
        return kind.__name__
    article = "an" if kind.__name__[0] in "AEIO" else "a"
    return f"{article} {kind.__name__}"


# --- what a type or a value is ---


def _is_bool(kind: type) -> bool:
    """Return whether a type is the boolean type of Python or of numpy."""
    return kind is bool or (kind.__name__ in ("bool", "bool_") and kind.__module__ == "numpy")


def _has_ancestor(kind: type, names: Sequence[str]) -> bool:
    """Return whether a type is, or inherits from, a class of another package with one of the
    `names`.
    """
    return any(ancestor.__name__ in names for ancestor in kind.__mro__)


def _is_real(kind: type) -> bool:
    """Return whether values of a type are real numbers: of Python, numpy, gmpy2, mpmath or sympy."""
    if issubclass(kind, numbers.Real | Decimal):
        return not (_is_bool(kind) or kind.__name__ == "timedelta64")
    return hasattr(kind, "_mpf_") or _has_ancestor(kind, ["Expr"])


def _is_whole(kind: type) -> bool:
    return issubclass(kind, numbers.Integral) and _is_real(kind)


def _is_row(kind: type) -> bool:
    """Return whether a type is a sequence or array of entries, and neither text nor bytes."""
    if issubclass(kind, Sequence):
        return not issubclass(kind, str | bytes | bytearray | memoryview)
    return hasattr(kind, "dtype") and hasattr(kind, "__len__")


# It remembers which types are rows.
_ROW = Kind("a sequence", _is_row)


def _is_text(kind: type) -> bool:
    return issubclass(kind, str)


def _is_file_name(kind: type) -> bool:
    return issubclass(kind, str) or hasattr(kind, "__fspath__")


def _has_dtype(kind: type) -> bool:
    """Return whether a type is one of arrays or of their entries, and of no text."""
    return hasattr(kind, "dtype") and not issubclass(kind, str | bytes)


def _is_entry(value: Any) -> bool:
    """Return whether an array has no dimensions, and a number as its entry, or text."""
    is_array = _has_dtype(type(value)) and is_scalar(value)
    return is_array and getattr(value.dtype, "kind", "") in "iufOU"


def _is_short(value: Any) -> bool:
    """Return whether a sequence has at most MOST_ENTRIES entries.

    An array is short unless it has no dimensions.
    """
    if _has_dtype(type(value)):
        return value.shape != ()
    return len(value) <= MOST_ENTRIES


def _is_shallow(value: Any, depth: int = MOST_DEPTH) -> bool:
    """Return whether lists are nested at most `depth` deep, each with at most MOST_ENTRIES entries."""
    if not isinstance(value, list | tuple | range):
        return True
    if not depth or not _is_short(value):
        return False
    if isinstance(value, range):
        inner: set[type] = set()
    else:
        inner = set(map(type, value)) & {list, tuple, range}
    return not inner or all(_is_shallow(entry, depth - 1) for entry in value)


def _is_array(value: Any) -> bool:
    return (_ROW.takes(value) or hasattr(type(value), "dtype")) and _is_shallow(value)


def _is_word(value: Any) -> bool:
    """Return whether a value is an iterator, or a sequence that can be read as a word."""
    if hasattr(type(value), "__next__"):
        return True
    return _ROW.takes(value) and _is_short(value) and _is_shallow(value)


def _is_solution(value: Any) -> bool:
    if value is None or isinstance(value, bytes | bytearray | memoryview | Set | numbers.Number):
        return False
    return _is_shallow(value)


def _is_executor(kind: type) -> bool:
    # Neither concurrent.futures nor dask is loaded to know them.
    return _has_ancestor(kind, ["Executor", "Client"])


def _can_be_called(value: Any, count: int | None) -> bool:
    """Return whether a value can be called with `count` arguments (None: with any)."""
    if not callable(value) or count is None:
        return callable(value)
    try:
        inspect.signature(value).bind(*range(count))
    except TypeError:
        return False
    except ValueError:  # a function in C that does not say what it takes
        pass
    return True


# --- kinds ---

NONE = Kind("None", lambda kind: kind is type(None))
FLAG = Kind("True or False", _is_bool)
# Arrays without dimensions are numbers too: loops over coordinates of xarray give such.
WHOLE = Kind("a whole number", _is_whole, _is_entry)
#: A number, but no text.
REAL = Kind("a number", _is_real, _is_entry)
NUMBER = Kind(
    "a number (or its text, such as '4/5')",
    lambda kind: _is_text(kind) or _is_real(kind),
    _is_entry,
)
TEXT = Kind("text", _is_text)
SLICE = Kind("a slice", lambda kind: kind is slice)
#: The name of a file.
FILE = (TEXT, Kind("a path", _is_file_name))
SCENE_NAME = Kind("the name or file of a scene", _is_file_name)
#: What `symosc.scenes.parameters_of` reads besides Parameters and objects that have some.
SCENE_OR_NAME = Kind("a Scene, or the name or file of one", _is_file_name)
ROWS = Kind("an array or lists of numbers", by_value=_is_array)
ARRAY = Kind("an array", lambda kind: _has_ancestor(kind, ["ndarray"]))
DATA_FRAME = Kind("a DataFrame", lambda kind: _has_ancestor(kind, ["DataFrame"]))
DATASET = Kind("a Dataset", lambda kind: _has_ancestor(kind, ["Dataset"]), made_by="sweep(...)")
WORD = Kind("a word such as 'P32' or ['P3', 'P2']", _is_text, _is_word)
SOLUTION = Kind(
    "a file, arrays, a table, a function, or what a solver returns", by_value=_is_solution
)
EXECUTOR = Kind("an executor of concurrent.futures, or a Client of dask.distributed", _is_executor)


def one_of(*choices: str) -> Kind:
    """Return the kind of texts that are one of the `choices`."""
    return Kind(
        " or ".join(map(repr, choices)),
        by_value=lambda value: isinstance(value, str) and value in choices,
    )


def function_of(count: int | None) -> Kind:
    """Return the kind of functions of `count` numbers (None: of any arguments)."""
    arguments = {None: "", 1: " of one number", 2: " of two numbers"}[count]
    return Kind(
        f"a function{arguments}",
        by_value=lambda value: not isinstance(value, type) and _can_be_called(value, count),
    )


def row_of(count: int, *kinds: Kind | type) -> Kind:
    """Return the kind of sequences of `count` entries of some kinds (none: of any)."""

    def fits(value: Any) -> bool:
        if not (_ROW.takes(value) and _is_short(value) and len(value) == count):
            return False
        return not kinds or all(_fits(kinds, entry) for entry in value)

    if count == 2:
        text = "a pair"
    else:
        text = f"{count} entries"
    return Kind(f"{text}{_of_entries(kinds)}", by_value=fits)


def sequence_of(*kinds: Kind | type, once: bool = False) -> Kind:
    """Return the kind of sequences of entries of some kinds.

    `once` says that an iterator, which can be read only once, will do.
    """

    def fits(value: Any) -> bool:
        if not _ROW.takes(value):
            return once and hasattr(type(value), "__next__")
        return _is_short(value) and all(_fits(kinds, entry) for entry in value)

    return Kind(f"a sequence{_of_entries(kinds)}", by_value=fits)


def mapping_of(*kinds: Kind | type) -> Kind:
    """Return the kind of mappings from names to values of some kinds."""

    def fits(value: Any) -> bool:
        if not isinstance(value, Mapping):
            return False
        return all(TEXT.takes(name) and _fits(kinds, entry) for name, entry in value.items())

    return Kind(f"a mapping of names{_of_entries(kinds)}", by_value=fits)


def _of_entries(kinds: Sequence[Kind | type]) -> str:
    """Return text that says of which kinds the entries must be, such as ", each a number"."""
    if kinds:
        return f", each {_text(kinds)}"
    return ""


#: One name, or several.
NAMES = (TEXT, sequence_of(TEXT))
ARRAY_LIKE = (NUMBER, ROWS)
#: Numbers, rows of them, or columns of them by name.
TABLE_LIKE = (*ARRAY_LIKE, mapping_of(*ARRAY_LIKE), DATA_FRAME)
START_ERROR = (NUMBER, row_of(3, NUMBER))
PROGRESS = (FLAG, function_of(2))
ORDER = one_of("full", "paper")
#: A point of a switching plane.
POINT = Kind(
    "a pair (x, theta)",
    by_value=lambda value: _ROW.takes(value) and _is_short(value) and len(value) == 2,
)


# --- calls that do not fit a function ---


def public(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Return a function that says what it takes if a call does not fit its parameters.

    Python's own message names only the wrong keyword, or the missing argument. This one lists the
    parameters and suggests one, or says what is missing, as users call these functions by hand. It
    is still a TypeError.
    """

    @wraps(function)
    def called(*in_order: Arguments.args, **named: Arguments.kwargs) -> Result:
        try:
            return function(*in_order, **named)
        except TypeError as error:
            # An error with a deeper traceback comes from the function itself, which did begin.
            begun = error.__traceback__ is None or error.__traceback__.tb_next is not None
            if begun:
                raise
            message = _misfit(function, in_order, named)
            if not message:
                raise
            raise TypeError(message) from None

    return called


def _misfit(
    function: Callable[..., object], in_order: Sequence[object], named: Mapping[str, object]
) -> str:
    """Return a message about a call with too many arguments, an unknown keyword or a missing
    argument; "" if it has none of these faults.
    """
    title = f"{function.__qualname__.removesuffix('.__init__')}()"
    parameters = [*inspect.signature(function).parameters.values()]
    # Kinds are in order: what may stand without a name comes before *args.
    positional = [item for item in parameters if item.kind < item.VAR_POSITIONAL]
    own = [item for item in parameters if item.name not in ("self", "cls")]
    variable = {item.kind for item in parameters}
    if len(in_order) > len(positional) and inspect.Parameter.VAR_POSITIONAL not in variable:
        return _too_many(title, own)
    names = [item.name for item in own]
    unknown = next((name for name in named if name not in names), None)
    if unknown is not None and inspect.Parameter.VAR_KEYWORD not in variable:
        if names:
            known = f"; known are {', '.join(names)}{meant(unknown, names)}"
        else:
            known = ""
        return f"{title} got an unexpected keyword argument {unknown!r}{known}"
    given = {item.name for item in positional[: len(in_order)]}
    twice = given.intersection(named)
    if twice:
        return f"{title} got {twice.pop()} twice: without a name, and by name"
    required = [
        item.name for item in own if item.default is item.empty and item.kind not in _VARIABLE
    ]
    missing = [name for name in required if name not in given and name not in named]
    if missing:
        return f"{title} is missing {_described(missing, _docstring(function, in_order))}"
    return ""


#: The kinds of *args and **kwargs, which may be empty.
_VARIABLE = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


def _docstring(function: Callable[..., object], in_order: Sequence[object]) -> str:
    """Return the docstring that describes the parameters of a function: of `__init__` its class's."""
    if function.__name__ == "__init__" and in_order:
        return inspect.getdoc(type(in_order[0])) or ""
    return inspect.getdoc(function) or ""


#: The section of a docstring that describes parameters, and the entries in it.
_SECTION = re.compile(r"^Parameters\n-+\n(.*?)(?=\n\n\S|\Z)", re.MULTILINE | re.DOTALL)
_ENTRY = re.compile(r"^(\w+(?:, \w+)*)(?: :(.*))?\n?((?:    .*\n?)*)", re.MULTILINE)
#: Types of parameters that say more than what stands below them.
_TELLING = re.compile(r"[A-Z]|array|table")
#: What arguments of these names are where a docstring does not describe them.
_USUAL = {
    "alpha": "number of a domain, from 1",
    "at": "a point of the map, as a number",
    "atlas": "an Atlas, such as symosc.atlas returns",
    "border": "a Border, such as continue_border returns",
    "dataset": "a Dataset, such as sweep returns",
    "drawing": "a figure, or axes of one",
    "end": "a pair (x_j, theta_j)",
    "events": "an EventTable, such as simulate_many returns",
    "given": "a mapping of t0, x0, v0 or t_end to numbers",
    "i": "number of a point, from 0",
    "label": "a mapping such as 'P2'",
    "mapping": "a mapping such as 'P2'",
    "name": "name of a parameter, or a pair of names",
    "name_or_path": "name of a shipped scene, or path of a TOML file",
    "orbit": "a PeriodicOrbit, such as find_orbit returns",
    "over": "a mapping of names to values, as for sweep",
    "p": "Parameters, or a Scene, its name or its file",
    "path": "name of a file, or '-' for standard output",
    "scene": "a Scene, or its name or its file",
    "start": "a pair (x_i, theta_i)",
    "t": "a time, or an array of times",
    "theta_m": "phase of the tangency",
    "v": "velocities, as many as times",
    "wrt": "names of parameters by which to differentiate",
    "x": "positions, as many as times",
}


def _described(names: Sequence[str], docstring: str) -> str:
    """Return names of parameters, each with what its docstring says of it in parentheses.

    Parameters that the docstring describes together stand together.
    """
    section = _SECTION.search(docstring)
    entries = []
    if section:
        entries = _ENTRY.findall(section[1])
    parts = list[str]()
    left = list(names)
    while left:
        together, meaning = _entry_of(left[0], entries)
        asked = [name for name in left if name in together]
        left = [name for name in left if name not in together]
        part = ", ".join(asked)
        if meaning and len(asked) < len(together):
            part += f" ({', '.join(together)}: {meaning})"
        elif meaning:
            part += f" ({meaning})"
        parts.append(part)
    if parts[1:]:
        return f"{', '.join(parts[:-1])} and {parts[-1]}"
    return parts[0]


def _entry_of(name: str, entries: Sequence[tuple[str, str, str]]) -> tuple[list[str], str]:
    """Return the names that an entry of a docstring describes together, and what it says in short."""
    for written, kind, text in entries:
        together = written.split(", ")
        if name in together:
            sentence = " ".join(text.split()).partition(". ")[0].rstrip(".")
            if not sentence or _TELLING.search(kind):
                meaning = kind.strip()
            else:
                meaning = sentence[0].lower() + sentence[1:]
            return together, meaning.replace("`", "")
    return [name], _USUAL.get(name, "")


def _too_many(title: str, parameters: Sequence[inspect.Parameter]) -> str:
    """Return the message about a call with too many positional arguments."""
    in_order = ", ".join(item.name for item in parameters if item.kind < item.VAR_POSITIONAL)
    by_name = [f"{item.name}=" for item in parameters if item.kind is item.KEYWORD_ONLY]
    if not by_name:
        by_name = ["NAME=VALUE" for item in parameters if item.kind is item.VAR_KEYWORD]
    message = f"{title} takes nothing without a name"
    if in_order:
        message = f"{title} takes only {in_order} without a name"
    if by_name:
        message += f"; give more by name: {', '.join(by_name)}"
    return message
