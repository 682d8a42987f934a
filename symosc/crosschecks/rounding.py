"""Samples that were written with few digits: how many, and what they leave open."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from symosc.crosschecks.samples import Samples

# Significant digits. Hardly a double has so few by chance (one of a thousand).
MOST_SAMPLE_DIGITS = 13
# Numbers that show the rounding; 0, the belts' speeds and the start may be short by nature.
LEAST_SHOWN = 3
FEW_VALUES = 1000
# An even grid that is not decimal is that of a converter: so many of its steps, at most, reach the largest number. So
# many different numbers must be on it, other than 0; with fewer than some, no one alone may make it finer, but for a
# factor of 2 that the others have by chance.
MOST_GRID_STEPS, LEAST_ON_GRID, SOME_ON_GRID, LARGEST_FACTOR = 2.0**24, 6, 16, 2
OFF_GRID = 1e-6
DOUBLE_ROUNDING = 4.0 * np.finfo(float).eps


@dataclass(frozen=True)
class Digits:
    """How the numbers of a column were rounded.

    Attributes
    ----------
    text : str
        For example "6 decimals", "6 significant digits".
    units : (n,) float array
        One unit of the last digit of each number.
    """

    text: str
    units: np.ndarray


@dataclass(frozen=True)
class Rounding:
    """How samples were rounded; a column is None if it has all digits of a double.

    Attributes
    ----------
    t, x, v, events : Digits or None
        `events` are the times of a list of events.
    """

    t: Digits | None
    x: Digits | None
    v: Digits | None
    events: Digits | None

    def units(self, count: int) -> np.ndarray:
        """Return the units of the last digits of t, x and v, shape (3, n); 0 where nothing was rounded."""
        columns = (self.t, self.x, self.v)
        if columns == (None, None, None):
            return np.broadcast_to(0.0, (3, count))  # takes no memory
        return np.array([np.zeros(count) if digits is None else digits.units for digits in columns])

    def of_events(self, count: int) -> np.ndarray:
        """Return the units of the last digits of the listed times."""
        return np.zeros(count) if self.events is None else self.events.units

    @property
    def texts(self) -> dict[str, str]:
        """What is rounded, and to how many digits."""
        columns = {"t": self.t, "x": self.x, "v": self.v, "events": self.events}
        return {name: digits.text for name, digits in columns.items() if digits is not None}


def find_rounding(samples: Samples, speeds: Iterable[float], start: float | None = None) -> Rounding:
    """Return how samples were rounded.

    Times are taken as rounded only if x or v are rounded and the times are not an even grid: a time such as 0.05 is
    exact, unless the first one is the start of the scene, rounded.

    Parameters
    ----------
    samples : Samples
    speeds : floats
        Speeds of the belts: v has them in a stick, with as few digits as they have.
    start : float, optional
        Time at which the scene starts.
    """
    x, v = find_digits(samples.x, samples.x[:1]), find_digits(samples.v, [*speeds, samples.v[0]])
    if not samples.lacks_v:
        x, v = x or _as_beside(samples.x, v), v or _as_beside(samples.v, x)
    t = None
    if x is not None or v is not None:
        t = find_digits(samples.t, samples.t[:1])
        if t is not None and _even(samples.t, t.units):
            near = start is not None and 0.0 < abs(samples.t[0] - start) <= 0.5000001 * t.units[0]
            t = t if near else None
    listed = np.array([time for time, _ in samples.events or ()])
    # A list given with rounded samples is likely to be rounded too: one time shows it.
    least = LEAST_SHOWN if x is None and v is None else 1
    return Rounding(t, x, v, find_digits(listed, samples.t[:1], least))


def find_digits(values: np.ndarray, natural: Iterable[float] = (), least: int = LEAST_SHOWN) -> Digits | None:
    """Return how `values` were rounded, or None if they have the digits of doubles, or too few of them show it.

    Both fixed decimals and significant digits are tried. Any rounded numbers fit both, one of them with more digits
    than were written; the coarser unit is the right one for every number. At least `least` numbers must be other than
    0 and the `natural` ones.
    """
    shown = values[(values != 0.0) & ~np.isin(values, list(natural))]
    if len(shown) < least:
        return None
    found, grid = _decimal(values, shown) or _single(values, shown), _grid(values, shown)
    # Steps of a converter may have a few decimals, or a few bits, themselves.
    coarser = grid is not None and (found is None or np.min(grid.units) > 1.5 * np.max(found.units))
    return grid if coarser else found


def _as_beside(values: np.ndarray, beside: Digits | None) -> Digits | None:
    """Return the decimals of the column beside, if these numbers fit them: few numbers, such as zeros, show none."""
    if beside is None or np.ptp(beside.units) > 0.0:
        return None
    unit = beside.units[0]
    fits = np.abs(np.rint(values / unit) * unit - values) <= DOUBLE_ROUNDING * np.abs(values)
    return beside if fits.all() else None


def _decimal(values: np.ndarray, shown: np.ndarray) -> Digits | None:
    """Return to how many decimals or significant digits numbers were rounded, or None."""
    exponents = _exponents(shown)
    significant = next((n for n in range(1, MOST_SAMPLE_DIGITS + 1) if _fits(shown, n - 1 - exponents)), None)
    if significant is None:
        return None
    places = significant - 1 - exponents
    tried = range(int(np.min(places)), int(np.max(places)))
    decimals = next((d for d in tried if _fits(shown, np.full(len(shown), float(d)))), int(np.max(places)))
    fixed = 10.0 ** -float(decimals)
    floating = 10.0 ** (_exponents(values) + 1 - significant)
    if np.any(floating[values != 0.0] > fixed * 1.5):
        return Digits(f"{significant} significant digits", np.maximum(floating, fixed))
    text = f"{decimals} decimals" if decimals >= 0 else f"multiples of {fixed:g}"
    return Digits(text, np.full(len(values), fixed))


def _single(values: np.ndarray, shown: np.ndarray) -> Digits | None:
    """Return the digits of numbers in single or half precision."""
    for kind, name in ((np.float16, "half"), (np.float32, "single")):
        with np.errstate(over="ignore"):
            fits = np.array_equal(shown.astype(kind), shown)
        if fits:
            return Digits(f"{name} precision", np.spacing(np.abs(values).astype(kind)).astype(float))
    return None


def _grid(values: np.ndarray, shown: np.ndarray) -> Digits | None:
    """Return the step of an even grid that holds all numbers, as a converter makes them.

    Two halves of the numbers must give the same step: a single number beside a grid would make a much finer one.
    """
    levels = np.unique(np.abs(shown))
    if len(levels) < LEAST_ON_GRID:
        return None
    largest = float(levels[-1])
    few = len(levels) < SOME_ON_GRID
    parts = [np.delete(levels, i) for i in range(len(levels))] if few else [levels[::2], levels[1::2]]
    counts = [round(largest / step) if (step := _common_step(part, largest)) else 0 for part in parts]
    most, least = max(counts), min(counts)
    if not least or most % least or most > (LARGEST_FACTOR if few else 1) * least:
        return None
    step = largest / most
    if np.any(np.abs(values - np.rint(values / step) * step) > OFF_GRID * step):
        return None
    return Digits(f"multiples of {step:.6g}", np.full(len(values), step))


def _common_step(levels: np.ndarray, largest: float) -> float | None:
    """Return the largest number of which all levels are multiples, by Euclid's algorithm; None if it is too small."""
    step, least = float(levels[0]), largest / MOST_GRID_STEPS
    for level in levels[1:].tolist():
        rest, step = step, level
        while rest > 0.5 * least:
            step, rest = rest, abs(step - round(step / rest) * rest)
        if step < least:
            return None
        step = level / round(level / step)  # without the rounding of the divisions
    return step


def _exponents(values: np.ndarray) -> np.ndarray:
    """Return the decimal exponents of numbers; 0 for 0."""
    sizes = np.abs(values)
    exponents = np.floor(np.log10(np.where(sizes > 0.0, sizes, 1.0)))
    # A logarithm just below a whole number is the next decade.
    return np.asarray(exponents + (sizes >= 10.0 ** (exponents + 1.0) * (1.0 - DOUBLE_ROUNDING)))


def _fits(values: np.ndarray, places: np.ndarray) -> bool:
    """Tell whether all values are whole multiples of 10^-places; most that are not show it in the first few."""
    if len(values) > FEW_VALUES and not _fits(values[:FEW_VALUES], places[:FEW_VALUES]):
        return False
    with np.errstate(over="ignore", invalid="ignore"):
        units = 10.0**-places
        return bool(np.all(np.abs(np.rint(values / units) * units - values) <= DOUBLE_ROUNDING * np.abs(values)))


def _even(times: np.ndarray, units: np.ndarray) -> bool:
    """Tell whether times are an even grid, exactly."""
    gaps = np.diff(np.rint(times / np.min(units)))
    return bool(np.all(gaps == gaps[0]))
