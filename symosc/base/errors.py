"""Exceptions of symosc. Each one carries the data that a program needs to react to it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from importlib import import_module
from numbers import Number
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Any

LONGEST_VALUE = 80
#: Where an object is in memory: no reader can use it, and it is another one in each run.
ADDRESS = re.compile(r" at 0x[0-9A-Fa-f]+")
# How alike a word must be to be suggested: of five letters one may differ, not two, since who
# writes "panel" does not mean "label".
LEAST_LIKENESS = 0.65
#: What users of other programs write for a name, though the two may not be alike.
OTHER_NAMES = {
    "t_end": ("T", "t1", "tf", "t_final", "t_max", "tmax", "t_stop", "tstop", "t_span", "duration"),
    "x0": ("y0", "start", "initial"),
    "v0": ("y0", "start", "initial"),
    "digits": ("dps", "prec", "precision"),
    "accuracy": ("tol", "rtol", "atol", "tolerance"),
    "tolerance": ("tol", "rtol", "atol", "accuracy"),
    "word": ("structure", "mapping"),
    "skip": ("transient", "burn_in"),
    "points": ("n", "n_points", "count", "num"),
    "direction": ("up", "down", "upward", "downward"),
    "workers": ("jobs", "n_jobs", "threads", "ncores", "processes"),
    "progress": ("verbose",),
    "figsize": ("size", "width", "height"),
    "m": ("mass",),
    "c": ("damping", "damper"),
    "k": ("stiffness", "spring"),
    "Omega": ("frequency", "w"),
    "v": ("speed", "velocity"),
    "mu": ("mu_k", "mu_d", "kinetic"),
    "mu_s": ("mu_static", "static"),
}


#: Names of numbers that functions with an argument `over` take as its keys.
NUMBER_OF_MODEL = re.compile(r"m|c|k|A0|B0|Omega|FN|(v|mu|mu_s)[1-9]\d*|x0|v0")


def shown(value: object) -> str:
    """Return a value as text for a message: on one line, shortened if it is long, numbers without
    their type, functions without their address.
    """
    try:
        text = _without_types(value)
    except Exception:
        # An integer of thousands of digits cannot be printed; nor can what has a broken repr.
        text = f"<{type(value).__name__}>"
    return brief(text)


def _without_types(value: object) -> str:
    """Return the representation of a value; numbers, in lists and tuples too, without their type,
    and functions by their names.
    """
    if isinstance(value, Number) and not isinstance(value, str):
        return str(value)
    if isinstance(value, FunctionType | BuiltinFunctionType | MethodType):
        return value.__name__
    if type(value) is list:
        return f"[{', '.join(map(_without_types, value))}]"
    if type(value) is tuple and len(value) > 1:
        return f"({', '.join(map(_without_types, value))})"
    return ADDRESS.sub("", repr(value))


def brief(text: str) -> str:
    """Return text as a message shows it: on one line, shortened if long, with escapes for
    unprintable characters.
    """
    on_one_line = " ".join(text.split())
    # The representation without its quotes is an escape such as \x1b.
    text = "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in on_one_line)
    if len(text) <= LONGEST_VALUE:
        return text
    return f"{text[: LONGEST_VALUE - 20]}… ({len(text)} characters)"


class SymoscError(Exception):
    """Base class of every error that symosc raises on purpose.

    Examples
    --------
    >>> from symosc import SymoscError, load_scene
    >>> try:
    ...     load_scene("fig4")
    ... except SymoscError as error:
    ...     print(type(error).__name__)
    SceneError
    """

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), tuple(
            vars(self).values()
        )  # each class keeps what it is made from, in order


class ParameterError(SymoscError, ValueError):
    """A value that the model does not allow.

    Attributes
    ----------
    name : str
        The parameter.
    value : object
        What was given.
    allowed : str
        What would have been accepted.

    Examples
    --------
    >>> from symosc import ParameterError, load_scene
    >>> try:
    ...     load_scene("fig5").parameters.replace(m=0)
    ... except ParameterError as error:
    ...     print(error.name, error.allowed)
    m must be > 0
    """

    def __init__(self, name: str, value: object, allowed: str) -> None:
        self.name = name
        self.value = value
        self.allowed = allowed
        super().__init__(f"{name} = {shown(value)}: {allowed}")


class SceneError(SymoscError, ValueError):
    """A scene that does not exist, or a scene file that cannot be read.

    Attributes
    ----------
    scene : str
        The scene's name or the file's path.

    Examples
    --------
    >>> from symosc import SceneError, load_scene
    >>> try:
    ...     load_scene("no-such-file.toml")
    ... except SceneError as error:
    ...     print(error)
    scene no-such-file.toml: cannot be read: No such file or directory
    """

    def __init__(self, scene: str, reason: str) -> None:
        self.scene = scene
        self.reason = reason
        super().__init__(f"scene {brief(scene) or repr(scene)}: {reason}")


class OutputError(SymoscError, OSError):
    """A file that cannot be written; nothing is left behind.

    Attributes
    ----------
    path : str
        The file that was asked for.

    Examples
    --------
    >>> from symosc import simulate
    >>> simulate("fig5").to_csv("no/such/folder/events.csv")
    Traceback (most recent call last):
        ...
    symosc.base.errors.OutputError: cannot write no/such/folder/events.csv: No such file or directory
    """

    def __init__(self, path: str, reason: str) -> None:
        self.path = path
        self.reason = reason
        super().__init__(f"cannot write {brief(path) or repr(path)}: {reason}")


class MissingExtraError(SymoscError, ImportError):
    """An optional dependency is needed and not installed.

    Attributes
    ----------
    extra : str
        The extra of symosc that brings it.

    Examples
    --------
    >>> from symosc import MissingExtraError
    >>> error = MissingExtraError("compiled_residual", "fast")
    >>> print(error)
    compiled_residual needs an optional package: pip install 'symosc[fast]'
    """

    def __init__(self, what: str, extra: str) -> None:
        self.what = what
        self.extra = extra
        super().__init__(f"{what} needs an optional package: pip install 'symosc[{extra}]'")


class SweepError(SymoscError, RuntimeError):
    """A sweep that cannot go on: its file belongs to another sweep, or a worker failed.

    Finished chunks are kept.

    Attributes
    ----------
    reason : str

    Examples
    --------
    >>> from symosc import SweepError
    >>> print(SweepError("map.nc is the output of another sweep"))
    map.nc is the output of another sweep
    """

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(reason)


class ResultError(SymoscError, ValueError):
    """Results of a solver, or a folder of reference cases, that cannot be read.

    Attributes
    ----------
    path : str
        The file or folder.

    Examples
    --------
    >>> from symosc import ResultError
    >>> print(ResultError("mine.csv", "has no column t; its columns are time, kind"))
    mine.csv: has no column t; its columns are time, kind
    """

    def __init__(self, path: str, reason: str) -> None:
        self.path = path
        self.reason = reason
        super().__init__(f"{brief(path) or repr(path)}: {reason}")


def optional(package: str, what: str, extra: str) -> Any:
    """Import and return a package; if it is missing, MissingExtraError says that `what` needs
    symosc's `extra`.
    """
    try:
        return import_module(package)
    except ModuleNotFoundError:
        raise MissingExtraError(what, extra) from None
    except ImportError as error:  # it is there, and broken, or finds no memory
        raise SymoscError(f"{package}, which {what} needs, cannot be loaded: {error}") from None


def meant(word: object, known: Iterable[str]) -> str:
    """Return "; did you mean ...?" for a message about an unknown word, or "" if no known word is
    similar.

    A number of belts that parameters of constant friction lack is answered by where it is given.
    """
    from difflib import SequenceMatcher

    known = list(known)
    written = str(word).lower()
    other_law = of_other_laws(written, known)
    if other_law:
        return f"; {other_law}"
    if "over" in known and NUMBER_OF_MODEL.fullmatch(str(word)):
        return f"; did you mean over={{{str(word)!r}: ...}}?"
    alike = [name for name in known if written in map(str.lower, OTHER_NAMES.get(name, ()))]
    if alike:
        return f"; did you mean {' or '.join(alike)}?"
    likeness = {name: SequenceMatcher(None, name.lower(), written).ratio() for name in known}
    best = max([LEAST_LIKENESS, *likeness.values()])
    alike = [name for name, ratio in likeness.items() if ratio >= best]
    if 1 <= len(alike) <= 3:  # more would be no help
        return f"; did you mean {' or '.join(alike)}?"
    return ""


#: What only an Oscillator's belts have, as users may write it: a pattern, its title, the beginning
#: of the names that it has where it is known, and the belt that has it.
OF_OTHER_LAWS = (
    (r"mu_?s(tatic)?_?\d*|mu\d+_?s|static(_friction)?", "static friction", "mu_s", "mu, mu_s=..."),
    (
        r"curve_?\d*|slope_?\d*|(w|mu)\d+_\d+|stribeck",
        "friction that depends on speed",
        "slope",
        "curve=[(w, mu), ...], slope=...",
    ),
    (r"belts?|(v|mu)[3-9]|(v|mu)[1-9]\d+", "another number of belts", "belts", "mu"),
)


def of_other_laws(word: str, known: Collection[str]) -> str:
    """Return where a number of belts is given that is none of the `known` numbers of an oscillator;
    "" if the word means no such number.
    """
    if "belts" in known and "mu1" not in known and re.fullmatch(r"(v|mu)\d+", word):
        return "the belts are given by belts=[Belt(v, mu), ...]"
    if "mu1" not in known and "belts" not in known:
        return ""
    for pattern, title, beginning, friction in OF_OTHER_LAWS:
        is_known = any(name.startswith(beginning) for name in known)
        if not is_known and re.fullmatch(pattern, word):
            belts = f"belts=[Belt(v, {friction})]"
            if "belts" in known:
                return f"{title} requires {belts}"
            return f"{title} requires an Oscillator with {belts}, or a scene file with [[belts]]"
    return ""


class CodeCacheWarning(UserWarning):
    """Compiled code cannot be kept on disk, or what was kept is damaged.

    It is compiled anew; results are the same.
    """
