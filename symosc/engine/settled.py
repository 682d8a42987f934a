"""What a motion is like in the end: its last sections, and after how many periods it repeats.

A tally keeps from where each section is reached (`symosc.engine.tally`). Only those that are asked for, or that words
do not already tell apart, are computed here, once.

All functions are scalar and run on floats (CPython, numba).
"""

from __future__ import annotations

from math import cos, sin, sqrt

from symosc.engine.state import Launch
from symosc.engine.tally import (
    FLIES,
    FROM_F,
    FROM_THETA,
    FROM_V,
    FROM_X,
    S11_THERE,
    S22_THERE,
    SECTIONS,
    SINCE,
    V_HIGH,
    V_LOW,
    X_HIGH,
    X_LOW,
    flown,
)

# Periods after which a motion may repeat, at most.
LONGEST_REPEAT = 32
# Two sections are the same if they differ by less than this part of the motion's extent, and this times their errors.
SAME_PART, SAME_ERRORS = 1e-6, 8.0


def settle(tally, sets, table, sections, repeats):
    """Write the last sections of motions, and after how many periods these repeat.

    Parameters
    ----------
    tally : Tally
        Its sections are computed where they are needed.
    sets : (n,) the parameter set of each motion.
    table : constants of the parameter sets.
    sections : (n, m, 2) array
        Filled with x and v at the last m sections, in order of time; what was not reached stays as it is.
    repeats : (n,) or (0,) int array
        Filled with the periods, 0 for a motion that does not repeat.
    """
    wanted = sections.shape[1]
    for i in range(sets.shape[0]):
        K = table[sets[i]]
        there = tally.ints[i, SECTIONS]
        for n in range(wanted if wanted < there else there):
            kept = section(i, there - 1 - n, tally, K)
            sections[i, wanted - 1 - n, 0], sections[i, wanted - 1 - n, 1] = kept[FROM_X], kept[FROM_V]
        if repeats.shape[0] > 0:
            repeats[i] = periods(i, tally, K)


def periods(i, tally, K):
    """Return after how many periods words and sections repeat, twice in a row; 0 if they do not."""
    there = tally.ints[i, SECTIONS]
    for m in range(1, LONGEST_REPEAT + 1):
        if 2 * m > there:
            return 0
        if same_words(i, m, tally) and same_sections(i, m, tally, K):
            return m
    return 0


def same_words(i, m, tally):
    """Return whether the last m words are whole and those of the m periods before."""
    words, ring, there = tally.words, tally.words.shape[1], tally.ints[i, SECTIONS]
    for n in range(there - m, there):
        before = words[i, (n - m) % ring]
        if before < 0 or words[i, n % ring] != before:
            return False
    return True


def same_sections(i, m, tally, K):
    """Return whether the last m sections are those of the m periods before."""
    floats, there = tally.floats, tally.ints[i, SECTIONS]
    x_room, v_room = floats[i, X_HIGH] - floats[i, X_LOW], floats[i, V_HIGH] - floats[i, V_LOW]
    for n in range(there - m, there):
        now, before = section(i, n, tally, K), section(i, n - m, tally, K)
        x_error = sqrt(now[S11_THERE]) + sqrt(before[S11_THERE])
        v_error = sqrt(now[S22_THERE]) + sqrt(before[S22_THERE])
        same = abs(now[FROM_X] - before[FROM_X]) <= SAME_PART * x_room + SAME_ERRORS * x_error
        if not (same and abs(now[FROM_V] - before[FROM_V]) <= SAME_PART * v_room + SAME_ERRORS * v_error):
            return False
    return True


def section(i, n, tally, K):
    """Return a section that has room, by its number: as one that is reached at once, from where it is."""
    kept = tally.sections[i, n % tally.words.shape[1]]
    x, v, tau, theta = kept[FROM_X], kept[FROM_V], kept[SINCE], kept[FROM_THETA]
    if kept[FLIES] > 0.0:
        s, c = sin(theta), cos(theta)
        x, v = flown(x, Launch(v, kept[FROM_F], s, c), tau, -s, c, K)
    else:
        x = x + v * tau
    kept[FLIES], kept[SINCE], kept[FROM_X], kept[FROM_V] = 0.0, 0.0, x, v
    return kept
