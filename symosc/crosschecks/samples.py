"""Samples t, x, v as arrays: what is a number, what is not, and what to say about it in one line."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

import numpy as np

from symosc.engine.events import KIND_NAMES
from symosc.errors import ParameterError
from symosc.exact import unmasked

SAMPLE_COLUMNS = ("t", "x", "v")
LEAST_SAMPLES = 2
# Largest number of a sample: squares of it and its products with rates must not overflow.
LARGEST_SAMPLE = 1e50
# Text of a wrong value in a message is cut here.
LONGEST_ITEM = 60


@dataclass(frozen=True)
class Samples:
    """A solution at times.

    Attributes
    ----------
    t, x, v : (n,) float arrays
        Without velocities `v` is NaN, until `symosc.crosschecks.velocities` computes it.
    events : tuple of pairs (t, kind), or None
        A kind is "" if the solver does not tell it.
    name : str
        Which one it is of several.
    notes : tuple of str
        What was done to read it.
    dense : callable, or None
        The solver's own function t -> (x, v) between the samples.
    v_off : (n,) float array, or None
        If v was computed from x: how far it may be off for the errors of x.
    """

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    events: tuple[tuple[float, str], ...] | None = None
    name: str = ""
    notes: tuple[str, ...] = ()
    v_off: np.ndarray | None = None
    dense: Callable[[np.ndarray], Any] | None = None

    @property
    def lacks_v(self) -> bool:
        """Whether only positions were given."""
        return bool(np.isnan(self.v[0]))


def checked_positions(t: object, x: object, events: object = None) -> Samples:
    """Return samples without velocities; see `checked`."""
    times = _array("t", t)
    samples = checked(times, x, np.zeros(len(times)), events)
    return replace(samples, v=np.full(len(samples.t), np.nan))


def checked(t: object, x: object, v: object, events: object = None) -> Samples:
    """Return samples as float arrays.

    Raises
    ------
    ParameterError
        Unless t, x and v are finite real numbers, one-dimensional, of one length >= 2, and t never decreases; or if
        `events` are no pairs (t, kind).
    """
    arrays = {name: _array(name, values) for name, values in zip(SAMPLE_COLUMNS, (t, x, v), strict=True)}
    lengths = {name: len(array) for name, array in arrays.items()}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "t, x and v must have one length")
    if lengths["t"] < LEAST_SAMPLES:
        raise ParameterError("samples", lengths["t"], f"at least {LEAST_SAMPLES} are needed")
    times = arrays["t"]
    late = np.flatnonzero(np.diff(times) < 0.0)
    if len(late):
        i = int(late[0]) + 1
        what = f"comes after {float(times[i - 1])!r}; the times must increase"
        raise ParameterError(f"t[{i}]", float(times[i]), what)
    if times[0] == times[-1]:
        raise ParameterError("t", float(times[0]), "is repeated in all samples; the times must increase")
    return Samples(arrays["t"], arrays["x"], arrays["v"], events=None if events is None else _checked_events(events))


def check_joints(samples: Samples, part: float, slack_x: float | np.ndarray, slack_v: float | np.ndarray) -> None:
    """Raise ParameterError where a time is repeated with a clearly different state.

    A time may come twice where two pieces of a solution are joined: the states there differ by at most `part` of the
    largest |x| and |v|, and by as much as the samples themselves may be off.
    """
    twice = np.flatnonzero(np.diff(samples.t) == 0.0)
    for name, values, slack in (("x", samples.x, slack_x), ("v", samples.v, slack_v)):
        limit = part * np.max(np.abs(values)) + np.broadcast_to(slack, values.shape)[twice] * 2.0
        jump = np.abs(np.diff(values)[twice])
        wrong = np.flatnonzero(jump > limit)
        if len(wrong):
            i = int(twice[wrong[0]]) + 1
            what = f"is repeated with another state ({name} jumps by {jump[wrong[0]]:.3g}); the times must increase"
            raise ParameterError(f"t[{i}]", float(samples.t[i]), f"{what}, but where two pieces are joined")


def _array(name: str, values: Any) -> np.ndarray:
    """Return one column as floats."""
    if values is None:
        raise ParameterError(name, None, "is missing: give t, x and v")
    unmasked(name, values)
    try:
        array = np.asarray(values)
        mixed = isinstance(values, (list, tuple)) and any(isinstance(value, bool) for value in values)
        if array.dtype.kind in "USO" or mixed:  # text and objects may be numbers
            _refuse_wrong(name, values if mixed else array.ravel().tolist())
        elif array.dtype.kind not in "iuf":
            raise TypeError
        array = array.astype(float)
    except (TypeError, ValueError, OverflowError, RecursionError) as error:
        if isinstance(error, ParameterError):
            raise
        _refuse_wrong(name, _items(values))
        raise ParameterError(name, shown(values), "is not a column of real numbers") from None
    if array.ndim != 1:
        raise ParameterError(name, array.shape, "must be one-dimensional; this is its shape")
    bad = np.flatnonzero(~(np.abs(array) <= LARGEST_SAMPLE))
    if len(bad):
        value = float(array[bad[0]])
        what = f"must be at most {LARGEST_SAMPLE:g} in size" if isfinite(value) else "must be finite"
        raise ParameterError(f"{name}[{bad[0]}]", value, f"{what} ({len(bad)} are not)")
    return array


def _refuse_wrong(name: str, values: Iterable[object]) -> None:
    """Raise ParameterError for the first entry that is no real number."""
    for i, value in enumerate(values):
        try:
            number_of(value)
        except (TypeError, ValueError, OverflowError):
            raise ParameterError(f"{name}[{i}]", shown(value), "is not a number") from None


def _items(values: Any) -> Iterable[object]:
    if isinstance(values, np.ndarray):
        return np.ravel(values).tolist()  # Python numbers read better in a message
    return values if isinstance(values, Iterable) and not isinstance(values, (str, bytes)) else [values]


def number_of(value: Any) -> float:
    """Return `value` as a float; ValueError for text such as 1_000, which float() would read."""
    if isinstance(value, (bool, np.bool_, complex)) or value is np.ma.masked:
        raise TypeError("no real number")
    if isinstance(value, bytes):
        value = value.decode("ascii", "replace")
    if isinstance(value, str) and ("_" in value or not value.isascii()):
        raise ValueError("no plain number")
    return float(value)


def short(text: str) -> str:
    """Return text for a message, cut if it is too long for a line."""
    text = text.encode("utf-8", "backslashreplace").decode()  # half a surrogate pair cannot be printed
    return text if len(text) <= LONGEST_ITEM else text[:LONGEST_ITEM] + "…"


def shown(value: object) -> object:
    """Return a wrong value for a message: itself where it is short, else the beginning of its text or its type."""
    if isinstance(value, str):
        return short(value)
    try:
        fits = len(repr(value)) <= LONGEST_ITEM
    except (RecursionError, ValueError):  # deep brackets, an int of thousands of digits
        fits = False
    return value if fits else type(value).__name__


def _checked_events(events: object) -> tuple[tuple[float, str], ...]:
    if isinstance(events, (str, bytes)) or not isinstance(events, Iterable) or getattr(events, "shape", None) == ():
        raise ParameterError("events", shown(events), "must be pairs (t, kind)")
    pairs: list[tuple[float, str]] = []
    for i, pair in enumerate(events):
        try:
            time, kind = pair
            time, kind = number_of(time), str(kind)
        except (TypeError, ValueError, OverflowError):
            raise ParameterError(f"events[{i}]", shown(pair), "must be a pair (t, kind)") from None
        if kind not in KIND_NAMES.values() or not abs(time) <= LARGEST_SAMPLE:
            what = f"t must be finite, kind one of {', '.join(KIND_NAMES.values())}"
            raise ParameterError(f"events[{i}]", (time, short(kind)), what)
        pairs.append((time, kind))
    return tuple(pairs)
