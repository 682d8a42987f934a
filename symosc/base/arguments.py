"""Check the arguments of public functions against their annotations.

`public` decorates a function or a method. Its annotations, read as text at the first call, say what
each argument may be: no package is loaded for that, and a name such as ``Axes`` is that of a class,
wherever it was defined. Whether a number is in range, or a name is one that exists, is left to the
function.
"""

from __future__ import annotations

import ast
import inspect
import numbers
from collections.abc import Callable, Mapping, Sequence, Set
from decimal import Decimal
from functools import partial, wraps
from typing import Any, NamedTuple, ParamSpec, TypeVar

from symosc.base.errors import ParameterError, meant
from symosc.base.exact import is_scalar

Given = ParamSpec("Given")
Result = TypeVar("Result")

#: The most entries of a list or a range that is read at all, and the greatest depth of lists in
#: lists.
MOST_ENTRIES = 10**8
MOST_DEPTH = 8


class Kind(NamedTuple):
    """A kind of value that an argument may be, such as a number or a scene, with its text for
    messages.
    """

    text: str  # what it is, for messages
    of_type: Callable[[type], bool]  # whether values of a type may be of this kind
    of_value: Callable[[Any], bool] | None = None  # whether such a value is; None: all are
    source: str = ""  # where to get one, for messages
    converted: str = (
        ""  # the name of the function of CONVERTERS that makes of it what the function works with
    )

    def takes(self, value: object) -> bool:
        """Return whether a value is of this kind."""
        return self.of_type(type(value)) and (self.of_value is None or self.of_value(value))


def _inherits(*names: str) -> Callable[[type], bool]:
    """Return a function that tells whether a type is, or inherits from, a class with one of the
    `names`.
    """
    return lambda kind: any(base.__name__ in names for base in kind.__mro__)


def _is_bool(kind: type) -> bool:
    """Return whether a type is the boolean type of Python or of numpy."""
    return kind is bool or (kind.__name__ in ("bool", "bool_") and kind.__module__ == "numpy")


def _is_real(kind: type) -> bool:
    """Return whether values of a type are real numbers: of Python, numpy, gmpy2, mpmath or sympy."""
    if issubclass(kind, numbers.Real | Decimal):
        return not (_is_bool(kind) or kind.__name__ == "timedelta64")
    return hasattr(kind, "_mpf_") or _inherits("Expr")(kind)


def _is_row(kind: type) -> bool:
    """Return whether a type is a sequence or array of entries, and neither text nor bytes."""
    if issubclass(kind, Sequence):
        return not issubclass(kind, str | bytes | bytearray | memoryview)
    return hasattr(kind, "dtype") and hasattr(kind, "__len__")


def _has_dtype(kind: type) -> bool:
    """Return whether a type is one of arrays or of their entries, and of no text."""
    return hasattr(kind, "dtype") and not issubclass(kind, str | bytes)


def _is_entry(value: Any) -> bool:
    """Return whether an array has no dimensions, and a number as its entry, or text."""
    return is_scalar(value) and getattr(value.dtype, "kind", "") in "iufOU"


def _is_text(kind: type) -> bool:
    return issubclass(kind, str)


def _is_file_name(kind: type) -> bool:
    return issubclass(kind, str) or hasattr(kind, "__fspath__")


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
    return not inner or all(_is_shallow(each, depth - 1) for each in value)


def _takes_arguments(count: int | None, value: Any) -> bool:
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


def _kind_of_class(name: str, source: str = "") -> Kind:
    """Return the kind of the instances of the class `name`.

    `source` tells a user how to get such an object.
    """
    return Kind(f"{'an' if name[0] in 'AEIO' else 'a'} {name}", _inherits(name), source=source)


NUMBER_OR_TEXT = "a number (or its text, such as '4/5')"
#: Functions that convert an argument, by name; the modules that have them put them here.
CONVERTERS: dict[str, Callable[[Any], Any]] = {}
#: What the names in annotations mean; a text is another annotation.
KINDS: dict[str, Kind | str] = {
    "None": Kind("None", lambda kind: kind is type(None)),
    "bool": Kind("True or False", _is_bool),
    # Arrays without dimensions are numbers too: loops over coordinates of xarray give such.
    "int": "Whole | WholeEntry",
    "Whole": Kind(
        "a whole number", lambda kind: issubclass(kind, numbers.Integral) and _is_real(kind)
    ),
    "WholeEntry": Kind("a whole number", _has_dtype, _is_entry),
    "float": "Real | RealEntry",
    "Real": Kind("a number", _is_real),
    "RealEntry": Kind("a number", _has_dtype, _is_entry),
    "str": Kind("text", _is_text),
    "slice": Kind("a slice", lambda kind: kind is slice),
    "Path": Kind("a path", lambda kind: hasattr(kind, "__fspath__")),
    "NumberLike": "NumberOrText | EntryOrText",
    "NumberOrText": Kind(NUMBER_OR_TEXT, lambda kind: _is_text(kind) or _is_real(kind)),
    "EntryOrText": Kind(NUMBER_OR_TEXT, _has_dtype, _is_entry),
    "ArrayLike": "NumberLike | Rows",
    "Rows": Kind(
        "an array or lists of numbers",
        lambda kind: _is_row(kind) or hasattr(kind, "dtype"),
        _is_shallow,
    ),
    "SceneName": Kind("the name or file of a scene", _is_file_name),
    "Progress": "bool | Callable[[float, float], object]",
    "StartError": "NumberLike | tuple[NumberLike, NumberLike, NumberLike]",
    "WordLike": Kind(
        "a word such as 'P32' or ['P3', 'P2']",
        lambda kind: _is_text(kind) or _is_row(kind) or hasattr(kind, "__next__"),
        lambda value: hasattr(value, "__next__") or (_is_short(value) and _is_shallow(value)),
    ),
    "Number": "float",
    "ndarray": Kind("an array", _inherits("ndarray")),
    "Order": "Literal['full', 'paper']",
    "Pair": Kind("a pair (x, theta)", _is_row, lambda value: _is_short(value) and len(value) == 2),
    "SolutionLike": Kind(
        "a file, arrays, a table, a function, or what a solver returns",
        lambda kind: (
            not issubclass(kind, bytes | bytearray | memoryview | Set | numbers.Number | None)
        ),
        _is_shallow,
    ),
    "Parameters": Kind(
        "Parameters", _inherits("Parameters"), source="a scene has them as scene.parameters"
    ),
    "ParametersLike": "Parameters | ParametersSource",
    "ParametersSource": Kind(
        "a Scene, or the name or file of one",
        lambda kind: _is_file_name(kind) or _inherits("Scene", "OtherModel")(kind),
        converted="parameters",
    ),
    "Axes": Kind("axes of matplotlib, such as plt.subplots() makes", _inherits("Axes")),
    "Figure": Kind("a figure, such as plot.figure(...) returns", _inherits("Figure")),
    "Executor": Kind(
        "an executor of concurrent.futures, or a Client of dask.distributed",
        _inherits("Executor", "Client"),
    ),
}
KINDS |= {
    name: _kind_of_class(name, f"{source} makes one")
    for name, source in {
        "Branch": "continue_orbit(...)",
        "Certificate": "certify(...)",
        "CrossCheck": "crosscheck(...)",
        "Dataset": "sweep(...)",
        "EventTable": "simulate_many(...)",
        "GrazingCurve": "grazing_curve(...)",
        "GrazingWindow": "grazing_window(...)",
        "OtherModel": "OtherModel(m=..., k=..., Omega=..., FN=...)",
        "ParameterRegion": "values_containing(...) for two parameters",
        "PeriodicOrbit": "find_orbit(...)",
        "Scene": "load_scene(...)",
        "Score": "symosc.reference.score.score(...)",
        "Summary": 'simulate_many(..., record="summary")',
        "Trajectory": "simulate(...)",
    }.items()
}


def _kinds(annotation: ast.expr | str) -> list[Kind] | None:
    """Return the kinds of argument that an annotation allows, or None if it allows any value."""
    match ast.parse(annotation, mode="eval").body if isinstance(annotation, str) else annotation:
        case ast.BinOp(left, ast.BitOr(), right):
            first = _kinds(left)
            second = _kinds(right)
            if first is None or second is None:
                return None
            return first + second
        case ast.Constant(None):
            return _kinds_of_name("None")
        case ast.Constant(str(text)):
            return _kinds(text)
        case ast.Name(name) | ast.Attribute(_, name):
            return _kinds_of_name(name)
        case ast.Subscript(ast.Name("Callable"), ast.Tuple([taken, _])):
            if isinstance(taken, ast.List):
                count = len(taken.elts)
            else:
                count = None
            if count is None:
                text = "a function"
            else:
                text = f"a function of {('one number', 'two numbers')[count - 1]}"
            return [
                Kind(
                    text, lambda kind: not issubclass(kind, type), partial(_takes_arguments, count)
                )
            ]
        case ast.Subscript(ast.Name("Literal"), choices):
            values = ast.literal_eval(choices)
            if not isinstance(values, tuple):
                values = (values,)
            return [Kind(" or ".join(map(repr, values)), _is_text, lambda value: value in values)]
        case ast.Subscript(ast.Name("tuple"), ast.Tuple(entries)):
            return [_kind_of_row([_kinds(entry) for entry in entries])]
        case ast.Subscript(ast.Name("Sequence" | "Iterable" as name), entry):
            return [_kind_of_sequence(_kinds(entry), name == "Iterable")]
        case ast.Subscript(ast.Name("Mapping"), ast.Tuple([key, value])):
            return [_kind_of_mapping(_kinds(key), _kinds(value))]
        case other:
            raise TypeError(
                f"no kind of argument: {ast.unparse(other)}"
            )  # a fault of the annotation


def _kinds_of_name(name: str) -> list[Kind] | None:
    """Return the kinds of argument that an annotation such as "float" allows, or None if it allows
    any value.
    """
    if name in ("Any", "object"):
        return None
    kind = KINDS.get(name) or _kind_of_class(name)
    if isinstance(kind, str):
        return _kinds(kind)
    return [kind]


def _fits(kinds: list[Kind] | None, value: object) -> bool:
    """Return whether a value is of one of the kinds."""
    return kinds is None or any(kind.takes(value) for kind in kinds)


def _text(kinds: list[Kind]) -> str:
    """Return the texts of kinds, joined by commas and "or", for a message."""
    *first, last = dict.fromkeys(kind.text for kind in kinds)
    if first:
        return f"{', '.join(first)} or {last}"
    return last


def _each(kinds: list[Kind] | None) -> str:
    """Return text that says of which kinds the entries of a sequence must be, such as ", each a
    number"; "" for any.
    """
    if kinds:
        return f", each {_text(kinds)}"
    return ""


def _kind_of_row(entries: list[list[Kind] | None]) -> Kind:
    """Return the kind of a sequence with a fixed number of entries, given the kinds of each entry."""

    def fits(value: Any) -> bool:
        return _is_short(value) and len(value) == len(entries) and all(map(_fits, entries, value))

    if len(entries) == 2:
        count = "a pair"
    else:
        count = f"{len(entries)} entries"
    return Kind(f"{count}{_each(entries[0])}", _is_row, fits)


def _kind_of_sequence(entry: list[Kind] | None, once: bool) -> Kind:
    """Return the kind of a sequence with entries of the kinds `entry`.

    `once` says whether an iterator will do.
    """

    def fits(value: Any) -> bool:
        return not _is_row(type(value)) or (
            _is_short(value) and all(_fits(entry, each) for each in value)
        )

    return Kind(
        f"a sequence{_each(entry)}",
        lambda kind: _is_row(kind) or (once and hasattr(kind, "__next__")),
        fits,
    )


def _kind_of_mapping(key: list[Kind] | None, value: list[Kind] | None) -> Kind:
    """Return the kind of a mapping, given the kinds of its keys and of its values."""

    def fits(given: Mapping[Any, Any]) -> bool:
        return all(_fits(key, name) and _fits(value, each) for name, each in given.items())

    return Kind(f"a mapping of names{_each(value)}", lambda kind: issubclass(kind, Mapping), fits)


class Rule:
    """The kinds of values that one parameter of a function takes, and the check of an argument
    against them.
    """

    # `known` are types of values that were allowed, by their type alone: these are not checked
    # again.
    __slots__ = ("kinds", "known", "name")

    def __init__(self, name: str, kinds: list[Kind]) -> None:
        self.name = name
        self.kinds = kinds
        self.known = set[type]()

    def check(self, value: object) -> Any:
        """Return an argument, converted if its kind says so.

        Raise ParameterError unless it is of an allowed kind.
        """
        for kind in self.kinds:
            if kind.takes(value):
                if kind.converted:
                    return CONVERTERS[kind.converted](value)
                if kind.of_value is None:
                    self.known.add(type(value))
                return value
        if len(self.kinds) == 1 and self.kinds[0].source:
            source = f"; {self.kinds[0].source}"
        else:
            source = ""
        raise ParameterError(self.name, value, f"must be {_text(self.kinds)}{source}")


class Rules:
    """The rules for all arguments of one function: by name, for ``*args`` (`more`) and for
    ``**kwargs`` (`others`).
    """

    __slots__ = ("by_name", "in_order", "more", "others", "parameters", "title")

    def __init__(self, function: Callable[..., object]) -> None:
        self.parameters = [*inspect.signature(function).parameters.values()]
        self.title = f"{function.__qualname__.removesuffix('.__init__')}()"
        rules = dict[str, Rule | None]()
        for each in self.parameters:
            if each.annotation is each.empty:
                kinds = None
            else:
                kinds = _kinds(each.annotation)
            if kinds is None:
                rules[each.name] = None
            else:
                rules[each.name] = Rule(each.name, kinds)
        many = inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD
        variable = {
            each.kind: rules.pop(each.name) for each in self.parameters if each.kind in many
        }
        self.more, self.others = (variable.get(kind) for kind in many)
        self.by_name = {name: rule for name, rule in rules.items() if rule}
        self.in_order = [
            rules[each.name] for each in self.parameters if each.kind < each.VAR_POSITIONAL
        ]

    def too_many(self) -> TypeError:
        """Return the error of a call with too many positional arguments."""
        named = [each for each in self.parameters if each.name != "self"]
        in_order = ", ".join(each.name for each in named if each.kind < each.VAR_POSITIONAL)
        by_name = [f"{each.name}=" for each in named if each.kind is each.KEYWORD_ONLY]
        by_name = by_name or ["NAME=VALUE" for each in named if each.kind is each.VAR_KEYWORD]
        if by_name:
            more = f"; give more by name: {', '.join(by_name)}"
        else:
            more = ""
        return TypeError(
            f"{self.title} takes {f'only {in_order}' if in_order else 'nothing'} without a "
            f"name{more}"
        )

    def check_unknown(self, name: str, value: object) -> None:
        """Raise an error if a keyword argument is no parameter, or if ``**kwargs`` do not allow its
        value.
        """
        if self.others is not None:
            Rule(name, self.others.kinds).check(value)
            return
        names = [each.name for each in self.parameters if each.name != "self"]
        if name not in names and not any(each.kind is each.VAR_KEYWORD for each in self.parameters):
            if names:
                known = f"; known are {', '.join(names)}{meant(name, names)}"
            else:
                known = ""
            raise TypeError(f"{self.title} got an unexpected keyword argument {name!r}{known}")


def public(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Return a function that checks its arguments against the annotations of `function`, and then
    calls it.

    Raises
    ------
    ParameterError
        From the call, if an argument is not what its annotation says; with its name and value, and
        what is allowed.
    """
    rules: Rules | None = None

    @wraps(function)
    def checked(*given: Given.args, **named: Given.kwargs) -> Result:
        nonlocal rules
        if rules is None:
            rules = Rules(function)
        values: Any = given
        for i, (rule, value) in enumerate(zip(rules.in_order, given)):  # noqa: B905  too few: Python says so below
            if rule is not None and type(value) not in rule.known:
                taken = rule.check(value)
                if taken is not value:
                    values = (*values[:i], taken, *values[i + 1 :])
        if len(given) > len(rules.in_order):
            if rules.more is None:
                raise rules.too_many()
            for value in given[len(rules.in_order) :]:
                rules.more.check(value)
        for name, value in named.items():
            rule = rules.by_name.get(name)
            if rule is None:
                rules.check_unknown(name, value)
            elif type(value) not in rule.known:
                named[name] = rule.check(value)
        return function(*values, **named)

    return checked
