"""Residuals and derivatives of one map between two points: scalar source for every kind of number,
and loops.

This file is executed with other globals: see symosc/kernels/rebind.py.

`symosc.mappings.equations` binds these functions to numpy's and mpmath's sin, cos and entire
functions; numba compiles them; `symosc.symbolic.export` prints them in other languages. A flight
goes from a belt of speed v_i to one of speed v_j through the domain with A = A_alpha/m.

Derivatives by parameters take divided differences over repeated nodes (`repeated`). With the
characteristic roots l1, l2 and e[...] the divided differences of z -> exp(z tau)

    U1 = e[l1, l1, l2, l2],   U0 = dU1/dtau,   U2 = e[0, l1, l1, l2, l2]
    V + i W = e[i Omega, l1, l1, l2, l2],      P + i Q = e[i Omega, i Omega, l1, l2]

(`symosc.symbolic.maps` derives their use). One rule is good in every regime, at resonance and for
short times. If the pair of nodes that are farthest apart are at least FAR_NODES / tau apart, it is
the difference over that pair, otherwise the Taylor series about the nodes' centre. A difference
over a far pair loses at most a few bits, and a series over near nodes none.

The loops are over many pairs of points, and the compiler turns them into SIMD. `points` are four
arrays x_i, theta_i, x_j, theta_j. A block of them is copied into rows of one array: the compiler
then knows that no two rows overlap, which it cannot know of arrays that a caller gives.
"""

from __future__ import annotations

from cmath import exp

import numpy as np

from symosc.kernels._generated import (
    acceleration,
    flight_jacobian,
    flight_parameters,
    flight_residual,
    motion,
    repeated_apart,
    stick_jacobian,
    stick_parameters,
    stick_residual,
)
from symosc.kernels.elementary import WIDEST, cos, sin
from symosc.kernels.entire import APART_ABOVE, EPS, SERIES_BELOW, basis
from symosc.kernels.rebind import outlined

# From this time on, times the damped frequency, the closed form with its square below loses no more
# than a digit.
FAR_APART = 0.5
# Nodes farther apart than this, times tau, are separated by a difference.
FAR_NODES = 3.0
# All nodes nearer to 0 than this, times tau: a series about 0 keeps small imaginary parts to their
# own size.
NEAR_ZERO = 0.5
BLOCK = 256

# What evaluates the entire functions at a point: the formulas of `symosc.kernels.formulas`, in
# their order.
CLOSED_FORM, DIVISION, MIXED, SERIES = range(4)
WIDE = 4  # `symosc.kernels.entire.basis`, with the C library's functions
BACKWARD = 5  # nothing: theta_j < theta_i
KINDS = 6


def flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K):
    """Return the residuals of a flight, eq. (54): at its end, f1 = position - x_j and f2 = velocity
    - v_j.
    """
    s0 = sin(theta_i)
    c0 = cos(theta_i)
    E0, E1, E2, R2, I2, _, _ = basis((theta_j - theta_i) / K.Om, K)
    a0 = acceleration(x_i, v_i, c0, A, K.cm, K.w0sq, K.f0)
    return flight_residual(
        x_i, v_i, a0, s0, c0, x_j, v_j, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2
    )


def flight_slopes(x_i, theta_i, theta_j, v_i, A, K):
    """Return the derivatives of a flight's residuals f1 (position), then f2 (velocity), by x_i,
    theta_i, theta_j.
    """
    s0 = sin(theta_i)
    c0 = cos(theta_i)
    E0, E1, E2, R2, I2, _, _ = basis((theta_j - theta_i) / K.Om, K)
    a0 = acceleration(x_i, v_i, c0, A, K.cm, K.w0sq, K.f0)
    _, dv, a = motion(v_i, a0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    return flight_jacobian(v_i, a0, v_i + dv, a, K.w0sq, K.Om, E0, E1, E2)


def flight_by_parameters(x_i, theta_i, theta_j, v_i, A, m, K):
    """Return derivatives of a flight's final x, v - v_i by m, then by c, k, A_alpha, B0, Omega,
    v_i; A is A_alpha/m.
    """
    s0 = sin(theta_i)
    c0 = cos(theta_i)
    tau = (theta_j - theta_i) / K.Om
    E0, E1, E2, R2, I2, s, c = basis(tau, K)
    U0, U1, U2, V, W, P, Q = repeated(tau, E0, E1, E2, R2, I2, s, c, K)
    a0 = acceleration(x_i, v_i, c0, A, K.cm, K.w0sq, K.f0)
    _, dv, a = motion(v_i, a0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    *letters, x_Om, v_Om, x_v0, v_v0 = flight_parameters(
        x_i, v_i, a0, s0, c0, m, K.cm, K.w0sq, K.f0, K.Om, E1, E2, R2, I2, U0, U1, U2, V, W, P, Q
    )
    sooner = -tau / K.Om  # by which the end moves, as theta_j is fixed
    return *letters, x_Om + (v_i + dv) * sooner, v_Om + a * sooner, x_v0, v_v0


def stick(x_i, theta_i, x_j, theta_j, v, A, K):
    """Return the residuals of a stick at belt speed v: f1 = position - x_j at its end, and f2, the
    force there.
    """
    return stick_residual(
        x_i, v, (theta_j - theta_i) / K.Om, x_j, cos(theta_j), A, K.cm, K.w0sq, K.f0
    )


def stick_slopes(theta_j, v, K):
    """Return df1/dtheta_i, df1/dtheta_j, df2/dx_j, df2/dtheta_j for the residuals f1, f2 of a stick
    (x, force).
    """
    return stick_jacobian(v, sin(theta_j), K.w0sq, K.f0, K.Om)


def stick_by_parameters(x_j, theta_i, theta_j, v, F, m, K):
    """Return derivatives of a stick's final force F by c, k, A_alpha, B0, v, m, then of its
    position by Omega, v.
    """
    return stick_parameters(v, (theta_j - theta_i) / K.Om, x_j, cos(theta_j), F, m, K.cm, K.Om)


# --- divided differences over repeated nodes ---


@outlined
def repeated(tau, E0, E1, E2, R2, I2, s, c, K):
    """Return the divided differences U0, U1, U2, V, W, P, Q at `tau` that derivatives by parameters
    are made of.
    """
    if K.apart and K.omega_d * tau >= FAR_APART:
        return repeated_apart(
            tau, K.h, K.omega_d, K.cm, K.w0sq, K.Om, K.p, K.q, E0, E1, E2, R2, I2, s, c
        )
    zero = 0.0 * K.Om
    if K.under:
        l1 = complex(-K.h, K.omega_d)
        l2 = complex(-K.h, -K.omega_d)
    else:
        l1 = complex(K.l1, zero)
        l2 = complex(K.l2, zero)
    nodes = (complex(zero, zero), complex(zero, K.Om), l1, l2)
    # One slot for each key (`key_of`), of which there are 2 * 3 * 3 * 3.
    known = [complex(zero, zero)] * 54
    there = [False] * 54
    # The four numbers say how often 0, i Omega, l1 and l2 are taken.
    U1 = divided_difference(0, 0, 2, 2, nodes, tau, known, there)
    # Leibniz' rule for z exp(z tau): differentiating by tau multiplies by z.
    U0 = l1 * U1 + divided_difference(0, 0, 1, 2, nodes, tau, known, there)
    U2 = divided_difference(1, 0, 2, 2, nodes, tau, known, there)
    Z = divided_difference(0, 1, 2, 2, nodes, tau, known, there)
    Y = divided_difference(0, 2, 1, 1, nodes, tau, known, there)
    return U0.real, U1.real, U2.real, Z.real, Z.imag, Y.real, Y.imag


@outlined
def divided_difference(n0, n1, n2, n3, nodes, tau, known, there):
    """Return the divided difference of exp(z tau) over four `nodes`, taken n0 to n3 times.

    `known`, `there`: cache.
    """
    # A stack, since numba keeps no recursion on disk.
    stack = [(n0, n1, n2, n3)]
    key = key_of(stack[0])
    while not there[key]:
        counts = stack[-1]
        far, first, last = farthest(counts, nodes)
        # One node less, the last one or the first one: the difference of both, over that of the
        # nodes, is the one with all. `first_key` and `second_key` are in the order of need.
        without_last = one_less(counts, last)
        without_first = one_less(counts, first)
        first_key = key_of(without_last)
        second_key = key_of(without_first)
        if far * tau < FAR_NODES:
            known[key_of(counts)] = difference_by_series(counts, nodes, tau)
        elif not there[first_key]:
            stack.append(without_last)
            continue
        elif not there[second_key]:
            stack.append(without_first)
            continue
        else:
            known[key_of(counts)] = (known[first_key] - known[second_key]) / (
                nodes[first] - nodes[last]
            )
        there[key_of(counts)] = True
        stack.pop()
    return known[key]


def key_of(counts):
    """Return the index (0 to 53) in the cache of the divided difference that takes node i
    `counts[i]` times: the first at most once, others at most twice.
    """
    return ((counts[0] * 3 + counts[1]) * 3 + counts[2]) * 3 + counts[3]


def one_less(counts, i):
    """Return `counts`, how often a divided difference takes each of four nodes, with node `i` taken
    once less.
    """
    return counts[0] - (i == 0), counts[1] - (i == 1), counts[2] - (i == 2), counts[3] - (i == 3)


def farthest(counts, nodes):
    """Return the distance and the numbers of the two farthest `nodes` among those whose `counts`
    are not 0.
    """
    far = -1.0
    first = 0
    last = 3
    for i in range(4):
        for j in range(i):
            if counts[i] > 0 and counts[j] > 0:
                gap = abs(nodes[i] - nodes[j])
                if gap > far:
                    far = gap
                    first = j
                    last = i
    return far, first, last


@outlined
def difference_by_series(counts, nodes, tau):
    """Return the divided difference of exp(z tau) over `nodes` near each other, node i taken
    counts[i] times.
    """
    # h_j is the complete homogeneous symmetric polynomial of degree j of the nodes, n + 1 of them.
    # Each 0.0 * something is a 0 of its type: complex, or real, or an array.
    size = 0
    largest = 0.0 * tau
    total = 0.0 * nodes[0]
    for i in range(4):
        if counts[i] > 0:
            size = size + counts[i]
            total = total + nodes[i] * counts[i]
            largest = max(largest, abs(nodes[i]))
    n = size - 1
    if largest * tau > NEAR_ZERO:
        centre = total / size
    else:
        centre = 0.0 * total
    offsets = [0.0 * centre] * 5  # of all nodes, each as often as it is taken: five at most
    radius = 0.0 * tau
    scale = exp(centre * tau)  # times tau^n / n! below
    at = 0
    for i in range(4):
        for _ in range(counts[i]):
            offsets[at] = (nodes[i] - centre) * tau
            radius = max(radius, abs(offsets[at]))
            at = at + 1
    for i in range(1, n + 1):
        scale = scale * tau / i
    # h_j(z_0 .. z_k) = h_j(z_0 .. z_(k-1)) + z_k h_(j-1)(z_0 .. z_k); `partial` holds h_j n! / (n +
    # j)! by k.
    partial = [1.0 + 0.0 * centre] * 5
    total = partial[n]
    bound = 1.0 + 0.0 * radius
    j = 0
    while bound > EPS:
        j = j + 1
        bound = bound * radius / j  # radius^j / j! bounds the term
        below = 0.0 * centre
        for i in range(n + 1):
            below = below + offsets[i] * partial[i] / (n + j)
            partial[i] = below
        total = total + below
    return scale * total


# --- loops over many pairs of points ---


def kinds_of(theta_i, theta_j, K, kinds):
    """Write the number of the formula that suits each flight (0 CLOSED_FORM to 5 BACKWARD) into
    `kinds`; count them.
    """
    counts = np.zeros(KINDS, dtype=np.int64)
    if K.under:
        fastest = K.Om + K.omega_d
    else:
        fastest = K.Om
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
            if K.rate0 * tau < SERIES_BELOW:
                kind = MIXED
            else:
                kind = DIVISION
        kinds[n] = kind
        counts[kind] += 1
    return counts


def load(block, points, begin):
    """Copy up to BLOCK pairs of points, from number `begin` on, into the first four rows of `block`.

    Return how many.
    """
    count = min(BLOCK, len(points[0]) - begin)
    for row in range(4):
        column = points[row]
        for n in range(count):
            block[row * BLOCK + n] = column[begin + n]
        # What is left repeats a point: the loops run over whole blocks.
        for n in range(count, BLOCK):
            block[row * BLOCK + n] = column[begin]
    return count


def pair(block, n):
    """Return x_i, theta_i, x_j, theta_j of the n-th pair of points in `block`, which `load` has
    filled.
    """
    return block[n], block[BLOCK + n], block[2 * BLOCK + n], block[3 * BLOCK + n]


def store(column, begin, count, block, row):
    """Copy the first `count` numbers of a row of the block into a column."""
    for n in range(count):
        column[begin + n] = block[row * BLOCK + n]


def flights(points, speeds, A, K, f):
    """Fill f (2, n) with the residuals (position, velocity) of flights between belts with the two
    `speeds`.
    """
    v_i, v_j = speeds
    block = np.empty(6 * BLOCK)  # rows 0 to 3: the points; 4 and 5: the residuals
    for begin in range(0, len(points[0]), BLOCK):
        count = load(block, points, begin)
        for n in range(BLOCK):
            x_i, theta_i, x_j, theta_j = pair(block, n)
            f1, f2 = flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K)
            block[4 * BLOCK + n] = f1
            block[5 * BLOCK + n] = f2
        for equation in range(2):
            store(f[equation], begin, count, block, 4 + equation)


def flights_and_slopes(points, speeds, A, K, f, J):
    """Fill f (2, n) with the residuals (x, v) of flights, J (2, 4, n) with derivatives by x_i,
    theta_i, x_j, theta_j.

    `points` are the arrays x_i, theta_i, x_j, theta_j, `speeds` the speeds of both belts, and A is
    A_alpha/m.
    """
    v_i, v_j = speeds
    # Rows of a block: 0 to 3 points, 4 and 5 residuals, 6 to 8 derivatives of f1 by x_i, theta_i,
    # theta_j, 9 to 11 those of f2. Derivatives by x_j are constant.
    block = np.empty(12 * BLOCK)
    J[0, 2] = -1.0
    J[1, 2] = 0.0
    for begin in range(0, len(points[0]), BLOCK):
        count = load(block, points, begin)
        for n in range(BLOCK):
            x_i, theta_i, x_j, theta_j = pair(block, n)
            f1, f2 = flight(x_i, theta_i, x_j, theta_j, v_i, v_j, A, K)
            x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = flight_slopes(x_i, theta_i, theta_j, v_i, A, K)
            block[4 * BLOCK + n] = f1
            block[5 * BLOCK + n] = f2
            block[6 * BLOCK + n] = x_x0
            block[7 * BLOCK + n] = x_th0
            block[8 * BLOCK + n] = x_th1
            block[9 * BLOCK + n] = v_x0
            block[10 * BLOCK + n] = v_th0
            block[11 * BLOCK + n] = v_th1
        for equation in range(2):
            store(f[equation], begin, count, block, 4 + equation)
            store(J[equation, 0], begin, count, block, 6 + 3 * equation)
            store(J[equation, 1], begin, count, block, 7 + 3 * equation)
            store(J[equation, 3], begin, count, block, 8 + 3 * equation)


def sticks(points, v, sides, K, f):
    """Fill f (2, n) with the residuals of sticks at belt speed v: x, and the smaller force of
    `sides` (A_alpha/m).
    """
    # `sides` has A_alpha/m of the domains that a stick may slip into; of f2 the smaller counts.
    below, above = sides
    block = np.empty(6 * BLOCK)  # rows 0 to 3: the points; 4 and 5: the residuals
    for begin in range(0, len(points[0]), BLOCK):
        count = load(block, points, begin)
        for n in range(BLOCK):
            x_i, theta_i, x_j, theta_j = pair(block, n)
            f1, force_below = stick(x_i, theta_i, x_j, theta_j, v, below, K)
            _, force_above = stick(x_i, theta_i, x_j, theta_j, v, above, K)
            if abs(force_below) <= abs(force_above):
                smaller = force_below
            else:
                smaller = force_above
            block[4 * BLOCK + n] = f1
            block[5 * BLOCK + n] = smaller
        for equation in range(2):
            store(f[equation], begin, count, block, 4 + equation)


def sticks_and_slopes(points, v, sides, K, f, J):
    """Fill f (2, n) with the residuals of sticks, J (2, 4, n) with derivatives by x_i, theta_i,
    x_j, theta_j.
    """
    sticks(points, v, sides, K, f)
    # f1 is x_i - x_j and a function of the phases; f2 depends on x_j and theta_j only.
    J[0, 0] = 1.0
    J[0, 2] = -1.0
    J[1, 0] = 0.0
    J[1, 1] = 0.0
    for n in range(len(points[0])):
        J[0, 1, n], J[0, 3, n], J[1, 2, n], J[1, 3, n] = stick_slopes(points[3][n], v, K)
