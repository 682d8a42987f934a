"""Samples t, x, v as arrays of finite numbers, and lists of events."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError, brief, meant
from symosc.base.exact import NO_EXPRESSION, NUMBER_FORMS, read_double, unmasked
from symosc.engine.events import KIND_NAMES
from symosc.model import Model, Oscillator

SAMPLE_COLUMNS = ("t", "x", "v")
# Squares of a sample and its products with rates must not overflow.
LARGEST_SAMPLE = 1e50


@dataclass(frozen=True)
class Samples:
    """A solution as columns; if only positions are given, `v` is NaN until it is computed."""

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    events: tuple[tuple[float, str], ...] | None = None  # (t, kind), with the kind "" if unknown
    # the same times, by the solver's event functions
    lists: tuple[tuple[float, ...], ...] | None = None
    name: str = ""  # distinguishes several solutions
    notes: tuple[str, ...] = ()  # how it was read
    v_off: np.ndarray | None = None  # bounds of the errors of a computed v
    dense: Callable[[np.ndarray], Any] | None = None  # the solver's own function t -> (x, v)
    rounding: Mapping[str, Any] | None = None  # of the columns, if their numbers do not show it

    @property
    def lacks_v(self) -> bool:
        """Whether only positions were given."""
        return bool(np.isnan(self.v[0]))


def fastest_rate(p: Model) -> float:
    """Return the larger of the frequencies of the drive and of the free motion."""
    free = float(p.k / p.m) ** 0.5
    if isinstance(p, Oscillator) and p.has_free_clock and free:
        return free
    return max(float(p.Omega), free)


def checked(t: object, x: object, v: object = None, events: object = None) -> Samples:
    """Check columns and return them as samples of floats; without `v` these have positions only."""
    # ParameterError unless all are finite real numbers, one-dimensional, of one length >= 2, and t
    # never decreases.
    arrays = {
        name: _column(name, values)
        for name, values in (("t", t), ("x", x), ("v", t if v is None else v))
    }
    lengths = {name: len(array) for name, array in arrays.items()}
    if len(set(lengths.values())) > 1:
        raise ParameterError("lengths", lengths, "t, x and v must have the same length")
    if lengths["t"] < 2:
        raise ParameterError("samples", lengths["t"], "at least 2 are needed")
    times = arrays["t"]
    late = np.flatnonzero(np.diff(times) < 0.0)
    if len(late):
        i = int(late[0]) + 1
        what = f"comes after {float(times[i - 1])!r}; the times must increase"
        raise ParameterError(f"t[{i}]", float(times[i]), what)
    if times[0] == times[-1]:
        raise ParameterError(
            "t", float(times[0]), "is repeated in all samples; the times must increase"
        )
    if v is None:
        arrays["v"] = np.full(len(times), np.nan)
    if events is None:
        listed = None
    else:
        listed = checked_events(events)
    return Samples(times, arrays["x"], arrays["v"], listed)


def check_joints(samples: Samples, share: float, slack: np.ndarray) -> None:
    """Raise ParameterError if two samples at one time, where pieces are joined, differ too much in
    x or v.

    They may differ by the `share` of the largest |x| or |v|, plus twice the error that
    `slack`, of shape (n, 2), allows to each sample.
    """
    twice = np.flatnonzero(np.diff(samples.t) == 0.0)
    slack_x, slack_v = slack.T
    for name, values, error in (("x", samples.x, slack_x), ("v", samples.v, slack_v)):
        limit = share * np.max(np.abs(values)) + error[twice] * 2.0
        jump = np.abs(np.diff(values)[twice])
        wrong = np.flatnonzero(jump > limit)
        if len(wrong):
            i = int(twice[wrong[0]]) + 1
            what = (
                f"is repeated with another state ({name} jumps by {jump[wrong[0]]:.3g}); "
                "the times must increase, but where two pieces are joined"
            )
            raise ParameterError(f"t[{i}]", float(samples.t[i]), what)


def _column(name: str, values: Any) -> np.ndarray:
    """Return one column as an array of floats."""
    if values is None:
        raise ParameterError(name, None, "is missing: give t, x and v")
    unmasked(name, values)
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError, RecursionError):
        _refuse_wrong(name, values)
        raise ParameterError(name, values, "is not a column of real numbers") from None
    is_mixed = isinstance(values, (list, tuple)) and any(
        isinstance(value, bool) for value in values
    )
    if is_mixed:
        _refuse_wrong(name, values)
    if array.ndim != 1:
        if array.dtype.kind not in "iuf":
            _refuse_wrong(name, array.ravel().tolist())
        raise ParameterError(name, array.shape, "must be one-dimensional; this is its shape")
    if array.dtype.kind not in "iuf":  # text and objects may be numbers
        cells = enumerate(array.tolist())
        return np.array([read_cell(f"{name}[{i}]", value) for i, value in cells])
    array = array.astype(float)
    bad = np.flatnonzero(~(np.abs(array) <= LARGEST_SAMPLE))
    if len(bad):
        value = float(array[bad[0]])
        if isfinite(value):
            what = f"must be at most {LARGEST_SAMPLE:g} in size"
        else:
            what = "must be finite"
        raise ParameterError(f"{name}[{bad[0]}]", value, f"{what} ({len(bad)} are not)")
    return array


def _refuse_wrong(name: str, values: object) -> None:
    """Raise ParameterError for the first entry that is not a real number."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        values = [values]
    for i, value in enumerate(values):
        read_cell(f"{name}[{i}]", value)


def read_cell(name: str, value: Any) -> float:
    """Return the entry of a column as a float."""
    if isinstance(value, bytes):
        value = value.decode("ascii", "replace")
    try:
        return read_double(name, value)
    except ParameterError as error:
        what = error.allowed
        if what in (NUMBER_FORMS, NO_EXPRESSION):
            what = "is not a number"
        raise ParameterError(error.name, value, what) from None


def check_kind(row: int, kind: Any) -> None:
    """Raise ParameterError unless the entry of a column of kinds is one of events."""
    kinds = tuple(KIND_NAMES.values())
    if not isinstance(kind, str) or kind not in kinds:
        allowed = f"must be one of {', '.join(kinds)}{meant(str(kind), kinds)}"
        value = str(kind) if isinstance(kind, str) else kind  # as plain text, not numpy's
        raise ParameterError(f"kind[{row}]", value, allowed)


def checked_events(events: object) -> tuple[tuple[float, str], ...]:
    """Check a list of events and return it as pairs (t, kind)."""
    if (
        isinstance(events, (str, bytes))
        or not isinstance(events, Iterable)
        or getattr(events, "shape", None) == ()
    ):
        raise ParameterError("events", events, "must be pairs (t, kind)")
    pairs: list[tuple[float, str]] = []
    for i, pair in enumerate(events):
        try:
            time, kind = pair
        except (TypeError, ValueError):
            raise ParameterError(f"events[{i}]", pair, "must be a pair (t, kind)") from None
        time = read_cell(f"t of events[{i}]", time)
        kind = str(kind)
        if kind not in KIND_NAMES.values():
            what = f"t must be finite, kind one of {', '.join(KIND_NAMES.values())}"
            raise ParameterError(f"events[{i}]", (time, brief(kind)), what)
        pairs.append((time, kind))
    return tuple(pairs)
