"""How the columns of samples were rounded.

Decimals, significant digits, single precision, a converter.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from symosc.crosschecks.samples import Samples

# Numbers that show the rounding; 0, the speeds of the belts and the start may be short by nature.
LEAST_SHOWN = 3
FEW_VALUES = 1000
DOUBLE_ROUNDING = 4.0 * np.finfo(float).eps


# Levels of an even grid: the fewest that show one, and those up to which they are few.
FEWEST_LEVELS = 6
FEW_LEVELS = 16


class Digits(NamedTuple):
    """The rounding of a column as text ("6 decimals"), and one unit in the last digit of each of
    its numbers.
    """

    text: str
    units: np.ndarray


def find_rounding(
    samples: Samples, speeds: Iterable[float], start: float | None = None
) -> dict[str, Digits]:
    """Return the rounding of the columns "t", "x", "v" and of listed "events" that have fewer
    digits than a double.

    Velocities equal to one of the belts' `speeds` may have few digits anyway and show no rounding.
    Evenly spaced times, such as multiples of 0.05, count as rounded only if the first one is the
    scene's time `start`, rounded.
    """
    if samples.rounding is not None:
        return {name: _for(samples, name, digits) for name, digits in samples.rounding.items()}
    # Times are taken as rounded only if x or v are.
    x = find_digits(samples.x, samples.x[:1])
    v = find_digits(samples.v, [*speeds, samples.v[0]])
    if not samples.lacks_v:
        as_v = x or _as_neighbour(samples.x, v)
        as_x = v or _as_neighbour(samples.v, x)
        x = as_v
        v = as_x
    t = None
    if x is not None or v is not None:
        t = find_digits(samples.t, samples.t[:1])
        if t is not None and _are_even(samples.t, t):
            off = 0.0 if start is None else abs(samples.t[0] - start)
            is_rounded_start = 0.0 < off <= 0.5000001 * t.units[0]
            if not is_rounded_start:
                t = None
    listed = np.array([time for time, _ in samples.events or ()])
    # A list given with rounded samples is likely to be rounded too: one time shows it.
    events = find_digits(listed, samples.t[:1], LEAST_SHOWN if x is None and v is None else 1)
    return {
        name: digits
        for name, digits in zip(("t", "x", "v", "events"), (t, x, v, events), strict=True)
        if digits
    }


def digits_of(samples: Samples, name: str) -> Digits | None:
    """Return the rounding of the column "t" or "x" of samples by itself; None if it has none."""
    if samples.rounding is not None:
        digits = samples.rounding.get(name)
        return digits and _for(samples, name, digits)
    values = getattr(samples, name)
    return find_digits(values, values[:1])


def _for(samples: Samples, name: str, digits: Digits) -> Digits:
    """Return a rounding that is known for the numbers in a column, of which some may have been left
    out since: then the largest unit is that of all.
    """
    if name == "events":
        count = len(samples.events or ())
    else:
        count = len(samples.t)
    if len(digits.units) == count:
        return digits
    return digits._replace(units=np.full(count, np.max(digits.units)))


def _are_even(t: np.ndarray, digits: Digits) -> bool:
    """Return whether rounded times are evenly spaced."""
    return bool(np.ptp(np.diff(np.rint(t / np.min(digits.units)))) == 0.0)


def find_digits(
    values: np.ndarray, natural: Iterable[float] = (), least: int = LEAST_SHOWN
) -> Digits | None:
    """Return the rounding of `values`.

    None if they are full doubles, or if too few of them show a rounding.

    At least `least` values must show it. 0 and the numbers in `natural`, which have few digits
    anyway, do not count.
    """
    # Fixed decimals and significant digits are tried. Rounded numbers fit both, one of them with
    # more digits than were written: the coarser unit is the right one for every number.
    numbers = values[(values != 0.0) & ~np.isin(values, list(natural))]
    if len(numbers) < least:
        return None
    decimal = _decimal(values, numbers) or _single(values, numbers)
    grid = _grid(values, numbers)
    # Steps of a converter may have a few decimals, or a few bits, themselves.
    coarser = grid is not None and (
        decimal is None or np.min(grid.units) > 1.5 * np.max(decimal.units)
    )
    if coarser:
        return grid
    return decimal


def _as_neighbour(values: np.ndarray, beside: Digits | None) -> Digits | None:
    """Return `beside`, the rounding of the column x (or v), if it fits the `values` of v (or x)
    too; else None.
    """
    if beside is None or np.ptp(beside.units) > 0.0:
        return None
    if _are_multiples(values, beside.units):
        return beside
    return None


def _decimal(values: np.ndarray, numbers: np.ndarray) -> Digits | None:
    """Return the decimals or digits to which `values` are rounded, or None.

    `numbers` are those that can show it.
    """
    exponents = _exponents(numbers)
    # Hardly a double has at most 13 significant digits by chance (one of a thousand).
    significant = next((n for n in range(1, 14) if _fits(numbers, n - 1 - exponents)), None)
    if significant is None:
        return None
    places = significant - 1 - exponents
    # The fewest decimals that all numbers have, at most as many as the digits need.
    decimals = int(np.min(places))
    most_decimals = int(np.max(places))
    while decimals < most_decimals and not _fits(numbers, np.full(len(numbers), float(decimals))):
        decimals += 1
    fixed = 10.0 ** -float(decimals)
    floating = 10.0 ** (_exponents(values) + 1 - significant)
    if np.any(floating[values != 0.0] > fixed * 1.5):
        return Digits(f"{significant} significant digits", np.maximum(floating, fixed))
    if decimals >= 0:
        text = f"{decimals} decimals"
    else:
        text = f"multiples of {fixed:g}"
    return Digits(text, np.full(len(values), fixed))


def _single(values: np.ndarray, numbers: np.ndarray) -> Digits | None:
    """Return the rounding of `values` to single or half precision, or None.

    `numbers` are those that can show it.
    """
    for kind, name in ((np.float16, "half"), (np.float32, "single")):
        with np.errstate(over="ignore"):
            fits = np.array_equal(numbers.astype(kind), numbers)
        if fits:
            return Digits(
                f"{name} precision", np.spacing(np.abs(values).astype(kind)).astype(float)
            )
    return None


def _grid(values: np.ndarray, numbers: np.ndarray) -> Digits | None:
    """Return the even grid to which `values` are rounded, as by an A/D converter, or None.

    `numbers` can show it.
    """
    # Two halves of the numbers, or all but one of a few, must give the same step, of a few numbers
    # to a factor of 2: a single number beside a grid would make a much finer one.
    levels = np.unique(np.abs(numbers))
    if len(levels) < FEWEST_LEVELS:
        return None
    largest = float(levels[-1])
    are_few = len(levels) < FEW_LEVELS
    if are_few:
        subsets = [np.delete(levels, i) for i in range(len(levels))]
        most_ratio = 2
    else:
        subsets = [levels[::2], levels[1::2]]
        most_ratio = 1
    counts = []  # how many steps the largest level has, by each subset; 0 if none is found
    for subset in subsets:
        step_of_subset = _common_step(subset, largest)
        counts.append(round(largest / step_of_subset) if step_of_subset else 0)
    most = max(counts)
    least = min(counts)
    if not least or most % least or most > most_ratio * least:
        return None
    step = largest / most
    if np.any(np.abs(values - np.rint(values / step) * step) > 1e-6 * step):
        return None
    return Digits(f"multiples of {step:.6g}", np.full(len(values), step))


def _common_step(levels: np.ndarray, largest: float) -> float | None:
    """Return the largest common divisor of all levels by Euclid's algorithm; None if it is too
    small.
    """
    step = float(levels[0])
    least = largest / 2.0**24  # converters have at most 24 bits
    for level in levels[1:].tolist():
        remainder = step
        step = level
        while remainder > 0.5 * least:
            step, remainder = remainder, abs(step - round(step / remainder) * remainder)
        if step < least:
            return None
        step = level / round(level / step)  # without the rounding of the divisions
    return step


def _exponents(values: np.ndarray) -> np.ndarray:
    """Return the decimal exponents of numbers; 0 for 0."""
    sizes = np.abs(values)
    exponents = np.floor(np.log10(np.where(sizes > 0.0, sizes, 1.0)))
    # A logarithm just below a whole number, by rounding, is that of the next decade.
    next_decades = 10.0 ** (exponents + 1.0)
    are_next = sizes >= next_decades * (1.0 - DOUBLE_ROUNDING)
    return np.asarray(exponents + are_next)


def _fits(values: np.ndarray, places: np.ndarray) -> bool:
    """Return whether each of `values` is a multiple of 10^-n, n being its number of decimals in
    `places`.
    """
    if len(values) > FEW_VALUES and not _fits(values[:FEW_VALUES], places[:FEW_VALUES]):
        return False
    with np.errstate(over="ignore", invalid="ignore"):
        return _are_multiples(values, 10.0**-places)


def _are_multiples(values: np.ndarray, units: np.ndarray) -> bool:
    """Return whether all values are multiples of `units`, up to the rounding of doubles."""
    return bool(
        np.all(np.abs(np.rint(values / units) * units - values) <= DOUBLE_ROUNDING * np.abs(values))
    )
