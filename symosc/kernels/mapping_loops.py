"""Residuals and derivatives of one map between many pairs of points: loops that the compiler turns into SIMD.

`points` are four arrays x_i, theta_i, x_j, theta_j. A block of them is copied into rows of one array: the compiler then
knows that no two rows overlap, which it cannot know of arrays that a caller gives.
"""

from __future__ import annotations

import numpy as np

from symosc.kernels.elementary import WIDEST
from symosc.kernels.entire import APART_ABOVE, SERIES_BELOW
from symosc.kernels.mapping import flight, flight_slopes, stick, stick_slopes

BLOCK = 256

# What evaluates the entire functions at a point: the formulas of `symosc.kernels.entire_branchless`, in their order.
CLOSED_FORM, DIVISION, MIXED, SERIES = range(4)
WIDE = 4  # `symosc.kernels.entire.basis`, with the C library's functions
BACKWARD = 5  # nothing: theta_j < theta_i
KINDS = 6


def kinds_of(theta_i, theta_j, K, kinds):
    """Write into `kinds` what is to evaluate each flight, and return how many of each kind there are."""
    counts = np.zeros(KINDS, dtype=np.int64)
    fastest = K.Om + K.omega_d if K.under else K.Om
    for n in range(len(theta_i)):
        tau = (theta_j[n] - theta_i[n]) / K.Om
        if tau < 0.0:
            kind = BACKWARD
        elif abs(theta_i[n]) > WIDEST or abs(theta_j[n]) > WIDEST or fastest * tau > WIDEST:
            kind = WIDE
        elif K.rate * tau < SERIES_BELOW:
            kind = SERIES
        elif K.apart and K.w0 * tau >= APART_ABOVE:
            kind = CLOSED_FORM
        else:
            kind = MIXED if K.rate0 * tau < SERIES_BELOW else DIVISION
        kinds[n] = kind
        counts[kind] += 1
    return counts


def load(block, points, begin):
    """Copy points into the first four rows of the block; return how many. What is left of a row repeats one of them."""
    count = min(BLOCK, len(points[0]) - begin)
    for row in range(4):
        column = points[row]
        for n in range(count):
            block[row * BLOCK + n] = column[begin + n]
        for n in range(count, BLOCK):
            block[row * BLOCK + n] = column[begin]
    return count


def pair(block, n):
    """Return x_i, theta_i, x_j, theta_j: one of the pairs of points that were loaded."""
    return block[n], block[BLOCK + n], block[2 * BLOCK + n], block[3 * BLOCK + n]


def store(column, begin, count, block, row):
    """Copy the first `count` numbers of a row of the block into a column."""
    for n in range(count):
        column[begin + n] = block[row * BLOCK + n]


def flights(points, speeds, A, K, f):
    """Fill f (2, n) with f1, f2 of flights through the domain with A = A_alpha/m between belts of these two speeds."""
    v_i, v_j = speeds
    block = np.empty(6 * BLOCK)
    for begin in range(0, len(points[0]), BLOCK):
        count = load(block, points, begin)
        for n in range(BLOCK):
            x_i, theta_i, x_j, theta_j = pair(block, n)
            f1, f2 = flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K)
            block[4 * BLOCK + n], block[5 * BLOCK + n] = f1, f2
        for equation in range(2):
            store(f[equation], begin, count, block, 4 + equation)


def flights_and_slopes(points, speeds, A, K, f, J):
    """Fill f as `flights` does, and J (2, 4, n) with the derivatives by x_i, theta_i, x_j, theta_j."""
    v_i, v_j = speeds
    block = np.empty(12 * BLOCK)
    J[0, 2], J[1, 2] = -1.0, 0.0
    for begin in range(0, len(points[0]), BLOCK):
        count = load(block, points, begin)
        for n in range(BLOCK):
            x_i, theta_i, x_j, theta_j = pair(block, n)
            f1, f2 = flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K)
            x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = flight_slopes(x_i, theta_i, theta_j, v_i, A, K)
            block[4 * BLOCK + n], block[5 * BLOCK + n] = f1, f2
            block[6 * BLOCK + n], block[7 * BLOCK + n], block[8 * BLOCK + n] = x_x0, x_th0, x_th1
            block[9 * BLOCK + n], block[10 * BLOCK + n], block[11 * BLOCK + n] = v_x0, v_th0, v_th1
        for equation in range(2):
            store(f[equation], begin, count, block, 4 + equation)
            store(J[equation, 0], begin, count, block, 6 + 3 * equation)
            store(J[equation, 1], begin, count, block, 7 + 3 * equation)
            store(J[equation, 3], begin, count, block, 8 + 3 * equation)


def sticks(points, v, sides, K, f):
    """Fill f (2, n) with f1, f2 of sticks at speed v.

    `sides` has A_alpha/m of the domains that a stick may slip into; of f2 the smaller counts.
    """
    below, above = sides
    block = np.empty(6 * BLOCK)
    for begin in range(0, len(points[0]), BLOCK):
        count = load(block, points, begin)
        for n in range(BLOCK):
            x_i, theta_i, x_j, theta_j = pair(block, n)
            f1, force_below = stick(x_i, theta_i, x_j, theta_j, v, below, K)
            _, force_above = stick(x_i, theta_i, x_j, theta_j, v, above, K)
            smaller = force_below if abs(force_below) <= abs(force_above) else force_above
            block[4 * BLOCK + n], block[5 * BLOCK + n] = f1, smaller
        for equation in range(2):
            store(f[equation], begin, count, block, 4 + equation)


def sticks_and_slopes(points, v, sides, K, f, J):
    """Fill f as `sticks` does, and J (2, 4, n) with the derivatives by x_i, theta_i, x_j, theta_j."""
    sticks(points, v, sides, K, f)
    J[0, 0], J[0, 2], J[1, 0], J[1, 1] = 1.0, -1.0, 0.0, 0.0
    for n in range(len(points[0])):
        J[0, 1, n], J[0, 3, n], J[1, 2, n], J[1, 3, n] = stick_slopes(points[3][n], v, K)
