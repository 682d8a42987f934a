"""Whether friction is smoothed, or the velocity chatters about a belt's speed or drifts off it in a stick."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import Clues
from symosc.crosschecks.other_models import rounded
from symosc.crosschecks.steps import follow_steps
from symosc.kernels._generated import acceleration
from symosc.model import NEIGHBOURS

#: Smoothed friction, from -1 to 1 over (v - v_belt)/width.
SMOOTH_CURVES: dict[str, Callable[[Any], Any]] = {
    "tanh": np.tanh,
    "arctan": lambda z: np.arctan(z) * (2.0 / np.pi),
    "z/sqrt(1 + z^2)": lambda z: z / np.sqrt(1.0 + z * z),
}
#: Of each curve the inverse, and the integral of the curve less the sign, over the gap, in units of the width.
CURVES: dict[str, tuple[Callable[[Any], Any], Callable[[Any], Any]]] = {
    "tanh": (np.arctanh, lambda z: np.log1p(np.exp(-2.0 * np.abs(z))) - np.log(2.0)),
    "arctan": (
        lambda u: np.tan(np.pi * u / 2.0),
        lambda z: 2.0 / np.pi * (z * np.arctan(z) - 0.5 * np.log1p(z * z)) - np.abs(z),
    ),
    "z/sqrt(1 + z^2)": (lambda u: u / np.sqrt(1.0 - u * u), lambda z: 1.0 / (np.sqrt(1.0 + z * z) + np.abs(z))),
}
# Widths are told apart to this part of themselves, or friction is not smoothed by that curve.
SAME_WIDTH = 0.2
# A curve that is wider than so many times the distance of the belts is no smoothed sign.
WIDEST = 3.0
# Steps that are looked at, and pieces of each.
MOST_SMOOTHED, PIECES = 40, 48
# Needed friction beyond this tells nothing: the curve is flat.
FLAT_ABOVE = 0.97
# Samples off a belt that change the side so often chatter.
TURNS_OFTEN = 0.2
SAME_RATE = 0.1
# What is left of the defects if all is of first order in the width.
FIRST_ORDER = 0.05


def held_samples(clues: Clues) -> np.ndarray:
    """Return the wrong steps at whose end the mass should stick and the sample is beside the belt."""
    s = clues.steps
    belts = np.array([s.K.belt1.v, s.K.belt2.v])
    steps = np.flatnonzero(clues.wrong & (s.last > 3) & (np.diff(s.t) > 0.0))
    gap = np.abs(s.v[steps + 1] - belts[s.last[steps] - 4])
    return steps[(gap > 0.0) & (gap < 0.5 * (belts[1] - belts[0]))]


def at_belts(clues: Clues) -> Iterator[Diagnosis]:
    """Yield what samples do that should be on a belt and are not."""
    steps = held_samples(clues)
    if len(steps) < 3:
        return
    s, share = clues.steps, len(steps) / int(np.sum(clues.wrong))
    boundary = s.last[steps] - 3
    gap = s.v[steps + 1] - np.array([s.K.belt1.v, s.K.belt2.v])[boundary - 1]
    curves = _smoothed_sticks(clues, steps, boundary, gap)
    name, width, error, spread = min(curves, key=lambda curve: curve[3])
    rate, same, count = _rates(clues, steps, boundary, gap)
    if spread <= SAME_WIDTH and spread < same and width <= WIDEST * (s.K.belt2.v - s.K.belt1.v):
        evidence = f"in sticks v creeps off the belt by the {name} of the needed friction, {len(steps)} samples"
        yield smoothed(name, width, error, evidence, 1.0)
        return
    runs = np.diff(steps) == 1
    turned = float(np.mean(gap[1:][runs] * gap[:-1][runs] < 0.0)) if np.any(runs) else 0.0
    largest = float(np.max(np.abs(gap)))
    if same <= SAME_RATE:
        words = f"in a stick v drifts off the belt, by {rate:.3g} per unit of time"
        yield Diagnosis("drift", "", words, f"one rate in all {count} steps", rate, same * abs(rate), 1.0)
    elif turned > TURNS_OFTEN:
        words = f"v jumps to and fro about the belt's speed, by up to {largest:.3g}, where the mass should stick"
        evidence = f"{len(gap)} samples; {turned:.0%} of them are on the other side than the one before"
        yield Diagnosis("chatter", "", words, evidence, largest, None, share)
    else:
        words = f"in a stick v drifts off the belt, by up to {largest:.3g}"
        yield Diagnosis("drift", "", words, f"{len(gap)} samples, on one side of the belt", largest, None, share)


def smoothed(name: str, width: float, error: float, evidence: str, share: float) -> Diagnosis:
    """Return that friction is smoothed, by a curve of some width."""
    words = f"friction is smoothed: like {name}((v - v_belt)/{rounded(width, error)}) in place of a sign"
    return Diagnosis("smoothed friction", name, words, evidence, width, error, share)


def _smoothed_sticks(
    clues: Clues, steps: np.ndarray, boundary: np.ndarray, gap: np.ndarray
) -> list[tuple[str, float, float, float]]:
    """Return for each curve the width that the samples beside a belt show, its error and its relative spread."""
    s, K, i = clues.steps, clues.steps.K, steps + 1
    speeds, jumps = np.array([K.belt1.v, K.belt2.v]), np.array([K.belt1.J, K.belt2.J])
    A, half = np.array([K.A1, K.A2, K.A3]), 0.5 * jumps[boundary - 1]
    below, above = np.array([NEIGHBOURS[b] for b in (1, 2)])[boundary - 1].T
    mean = 0.5 * (A[below - 1] + A[above - 1])
    push = acceleration(s.x[i], s.v[i], np.cos(s.theta[i]), mean, K.cm, K.w0sq, K.f0)
    slope = -K.w0sq * speeds[boundary - 1] - K.fB * np.sin(s.theta[i])  # of the push, in a stick
    found = []
    for name, (inverse, _) in CURVES.items():
        width = spread = np.nan
        needed = push / half
        for _ in range(4):  # the creep has an acceleration of its own
            good = (np.abs(needed) < FLAT_ABOVE) & (np.abs(needed) > 1.0 - FLAT_ABOVE)
            if np.sum(good) < 3:
                width, spread = np.nan, np.inf
                break
            ratio = gap[good] / inverse(needed[good])
            width = float(np.median(ratio))
            spread = 1.4826 * float(np.median(np.abs(ratio - width))) / abs(width)
            steep = (
                inverse(np.clip(needed, -FLAT_ABOVE, FLAT_ABOVE) + 1e-6)
                - inverse(np.clip(needed, -FLAT_ABOVE, FLAT_ABOVE))
            ) / 1e-6
            needed = (push - width * steep * slope / half) / half
        if not width > 0.0:
            spread = np.inf
        found.append((name, width, float(spread * abs(width) / np.sqrt(len(steps))), spread))
    return found


def _rates(clues: Clues, steps: np.ndarray, boundary: np.ndarray, gap: np.ndarray) -> tuple[float, float, int]:
    """Return how fast the gap grows in steps from the belt or beside it, how much that differs, and their number."""
    s = clues.steps
    before = s.v[steps] - np.array([s.K.belt1.v, s.K.belt2.v])[boundary - 1]
    inside = np.isin(steps - 1, steps) | (np.abs(before) <= clues.near[steps])
    if np.sum(inside) < 2:
        return 0.0, np.inf, 0
    rates = ((gap - before) / (s.t[steps + 1] - s.t[steps]))[inside]
    rate = float(np.median(rates))
    spread = 1.4826 * float(np.median(np.abs(rates - rate)))
    return rate, spread / abs(rate) if rate else np.inf, len(rates)


def smoothed_passages(clues: Clues) -> Iterator[Diagnosis]:
    """Yield smoothed friction that shows in flights and passages: what it does beside the belts, to first order."""
    s = clues.steps
    usable = clues.wrong & (s.first < 4) & (s.last < 4) & (np.diff(s.t) > 0.0) & np.isfinite(clues.sizes)
    usable &= np.isin(np.arange(len(usable)), s.events.step[s.events.target > 3], invert=True)
    steps = np.flatnonzero(usable)
    steps = steps[np.argsort(-clues.sizes[steps])[:MOST_SMOOTHED]]
    if len(steps) < 3:
        return
    measured = -s.defects[steps]
    time, velocity = _paths(clues, steps)
    K, best = s.K, None
    widths = (K.belt2.v - K.belt1.v) * np.geomspace(1e-6, 1.0, 121)
    for name, (_, integral) in CURVES.items():
        for width in widths:
            made = _effect(clues, steps, time, velocity, width, integral)
            misses = np.max(np.abs((made - measured) / clues.allowed[steps]), axis=1) / clues.sizes[steps]
            middle = float(np.median(misses))
            if best is None or middle < best[0]:
                best = middle, name, float(width), misses
    if best is not None and best[0] <= SAME_WIDTH:
        middle, name, width, misses = best
        evidence = f"to first order it leaves {middle:.0%} of the defects of {len(steps)} steps"
        # One width for all steps says more than a delay for each.
        share = float(np.mean(misses < 2.0 * SAME_WIDTH)) + 0.01
        share = share if middle <= FIRST_ORDER else share * (1.0 - middle / SAME_WIDTH)
        yield smoothed(name, width, 2.0 * max(middle, FIRST_ORDER) * width, evidence, share)


def _paths(clues: Clues, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return times since the beginning of steps and velocities of the exact motion there, shape (steps, pieces + 1)."""
    s = clues.steps
    length = s.t[steps + 1] - s.t[steps]
    order = np.argsort(steps)
    time, velocity = np.outer(length, np.linspace(0.0, 1.0, PIECES + 1)), np.empty((len(steps), PIECES + 1))
    velocity[:, 0] = s.v[steps]
    for k, i in enumerate(steps.tolist()):  # the path has a kink at each event: it is the end of a piece
        for event in s.events.t[s.events.rows(i, i)].tolist():
            after = event - s.t[i]
            time[k, 1 + int(np.argmin(np.abs(time[k, 1:-1] - after)))] = after
    for j in range(1, PIECES + 1):
        i = steps[order]
        times = np.column_stack([s.t[i], s.t[i] + time[order, j]]).ravel()
        times = np.maximum.accumulate(times)
        twice = np.repeat(i, 2)
        there = follow_steps(clues.parameters, times, s.x[twice], s.v[twice], 0.0, clues.scales)
        velocity[order, j] = there.defects[::2, 1] + s.v[i]
    return time, velocity


def _effect(
    clues: Clues,
    steps: np.ndarray,
    time: np.ndarray,
    velocity: np.ndarray,
    width: float,
    integral: Callable[[Any], Any],
) -> np.ndarray:
    """Return how smoothed friction moves the ends of steps in x and v, to first order, shape (steps, 2)."""
    K = clues.steps.K
    push = np.zeros((len(steps), PIECES))
    for belt in (K.belt1, K.belt2):
        gap = velocity - belt.v
        change = np.diff(gap, axis=1)
        steep = np.abs(change) > 1e-12 * (np.abs(gap[:, 1:]) + width)
        total = width * np.diff(integral(gap / width), axis=1)
        push -= 0.5 * belt.J * np.where(steep, total / np.where(steep, change, 1.0), 0.0)
    impulse = push * np.diff(time, axis=1)
    left = time[:, -1:] - 0.5 * (time[:, 1:] + time[:, :-1])
    decay = np.exp(-0.5 * K.cm * left)
    frequency = np.sqrt(complex(K.w0sq - 0.25 * K.cm**2))
    wave = np.real(np.sin(frequency * left) / frequency) if frequency else left
    level = np.real(np.cos(frequency * left))
    return np.column_stack([
        np.sum(impulse * decay * wave, axis=1),
        np.sum(impulse * decay * (level - 0.5 * K.cm * wave), axis=1),
    ])  # fmt: skip
