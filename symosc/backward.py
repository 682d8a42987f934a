"""Backward in time from a tangency to the boundary that the flow came from, guaranteed: no contact is passed over.

Why nothing can be missed
-------------------------
With s = t_m - t the velocity of a flight obeys v'' - (c/m) v' + (k/m) v = -(B0 Omega/m) sin(theta - Omega s): damping
has changed its sign, the transient grows. So the bounds of `symosc.events`, which rest on an energy that never grows,
do not hold backward. For the n-th derivative y of v the energy E = y'^2 + (k/m) y^2 obeys

    d/ds sqrt(E) <= (c/m) sqrt(E) + (|B0| Omega/m) Omega^n,

hence over a step H, with y = v^(n) and y' = v^(n+1) taken at its beginning,

    |v^(n+1)| <= exp(c H/m) (sqrt(E) + H (|B0| Omega/m) Omega^n),

which bounds the remainder of the Taylor polynomial of degree n. The steps are short (STEP over the largest rate), so
the remainder is below the rounding error. On each step the gap to a wall is that polynomial, known within `noise`:
remainder, rounding, and the errors of all steps before, which grow like the energy. If its Bernstein coefficients all
exceed the noise there is no contact; if they change sign exactly once, whatever the noise, there is exactly one, from
which Newton's method starts; otherwise the interval is divided. What is still open at the smallest width is a touch as
far as this precision tells. At the tangency where the search starts, the known root is divided out of the polynomial.

A flight that never met a wall is recognised where that can happen at all, in an over- or critically damped system: by
a transient that runs away from the only wall for ever (`never_came`). An underdamped transient that grows comes back.

The functions are scalar and run on floats and on mpmath numbers; `functions` is `math` or an mpmath context.
"""

from __future__ import annotations

from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

from symosc.flow import Constants
from symosc.kernels._generated import next_derivative

# What a search ends with.
CONTACT, TOUCH, REACHED, NEVER = "contact", "touch", "reached", "never"

# Length of a step, times the largest rate of the system.
STEP = 0.5
# Rounding error of a Taylor polynomial in units of eps times the size of its terms.
ROUNDING = 8
# Where an interval is divided: not a fraction at which roots like to be.
CUT = 0.4831
# Newton's method halves its bracket at worst: enough for thousands of digits.
MOST_STEPS = 20_000
# What a flight must stay away from a wall to be said never to have met it, as a part of the velocity's size.
CLEAR = 1e-9


class Arrival(NamedTuple):
    """Where a backward flight ends: `tau` before the tangency, displaced by dx, with velocity v and acceleration a."""

    kind: str
    boundary: int  # of the wall that was met, else 0
    tau: Any
    dx: Any
    v: Any
    a: Any
    v_error: Any  # bound of the error of v at that time
    x_error: Any


class Wall(NamedTuple):
    """A wall of the domain: its number, its velocity, and the direction into the domain, 1 up or -1 down."""

    boundary: int
    v: Any
    inward: int


def walls_of(domain: int, K: Constants) -> list[Wall]:
    """Return the walls of domain 1, 2 or 3."""
    walls = [Wall(domain - 1, K.belt1.v if domain == 2 else K.belt2.v, 1)] if domain > 1 else []
    return walls + ([Wall(domain, K.belt1.v if domain == 1 else K.belt2.v, -1)] if domain < 3 else [])


def flow_back(
    theta: Any,
    order: int,
    boundary: int,
    domain: int,
    tau_max: Any,
    K: Constants,
    functions: Any,
    eps: Any,
    step: float = STEP,
) -> Arrival:
    """Follow the flow backward from a tangency, to the first contact with a wall or over tau_max.

    Parameters
    ----------
    theta : phase of the tangency.
    order : order of the first G-function that does not vanish there, 1 or 3.
    boundary, domain : the belt that is touched and the domain of the flow.
    tau_max : time to search.
    K : Constants
    functions, eps : arithmetic of `theta` and `K`, and its unit of rounding.
    step : length of a step times K.rate.
    """
    walls = walls_of(domain, K)
    n = _degree(eps, step)
    zero = 0 * theta
    tau, dx, v, a = zero, zero, next(wall.v for wall in walls if wall.boundary == boundary), zero
    energy_error, v_error, x_error = zero, zero, zero
    while True:
        H = step / K.rate
        last = tau_max - tau <= H
        if last:
            H = tau_max - tau
        angle = theta - K.Om * tau
        s, c = functions.sin(angle), functions.cos(angle)
        growth = functions.exp(K.cm * H)
        T, remainder = taylor(v, a, s, c, H, n, growth, K, functions)
        rounding = ROUNDING * eps * (abs(a) * H + (K.w0sq * abs(v) + abs(K.fB) * (1 + abs(theta) + K.Om * tau)) * H * H)
        energy_error = growth * energy_error + rounding / H
        v_error = growth * v_error + H * energy_error + rounding + eps * abs(v)
        if K.w0 > 0:
            v_error = min(v_error, energy_error / K.w0 + rounding + eps * abs(v))
        energy_error = max(energy_error, K.w0 * rounding)
        found = None
        for wall in walls:
            gap = [wall.inward * (T[0] - wall.v), *(wall.inward * term for term in T[1:])]
            at_start = tau == 0 and wall.boundary == boundary
            noise = remainder + (rounding if at_start else v_error)
            touch, sigma = first_root(gap[order + 1 :] if at_start else gap, noise, eps)
            if sigma is not None and (found is None or sigma < found[1]):
                found = touch, sigma, wall
        if found is None and tau > 0 and never_came(v, a, s, c, domain, walls, v_error, K):
            return Arrival(NEVER, 0, tau, dx, v, a, v_error, x_error)
        sigma = found[1] if found else 1 + zero
        v_new, a_new, dx_new = at(T, sigma, H)
        tau, dx, a = tau + sigma * H, dx + dx_new, a_new
        x_error = x_error + H * v_error + eps * abs(dx)
        if found:
            return Arrival(TOUCH if found[0] else CONTACT, found[2].boundary, tau, dx, found[2].v, a, v_error, x_error)
        v = v_new
        if last:
            return Arrival(REACHED, 0, tau_max, dx, v, a, v_error, x_error)


def taylor(
    v: Any, a: Any, s: Any, c: Any, H: Any, n: int, growth: Any, K: Constants, functions: Any
) -> tuple[list[Any], Any]:
    """Return the Taylor coefficients of v over the part of a step H gone back, and the bound of the remainder."""
    cm, w0sq = -K.cm * H, K.w0sq * H * H
    drive, turn = K.fB * H * H, K.Om * H
    sines = (s, -c, -s, c)  # (-d/dphase)^k sin
    D = [v, -a * H]
    power = drive
    for k in range(n):
        D.append(next_derivative(D[k + 1], D[k], power * sines[k % 4], cm, w0sq))
        power = power * turn
    terms, factorial = [], 1
    for k in range(n + 1):
        factorial *= max(k, 1)
        terms.append(D[k] / factorial)
    size = functions.sqrt(D[n + 1] * D[n + 1] + w0sq * D[n] * D[n]) + abs(power)
    return terms, growth * size / (factorial * (n + 1))


def at(T: list[Any], sigma: Any, H: Any) -> tuple[Any, Any, Any]:
    """Return v, a and the displacement at the part `sigma` of a step of length H backward."""
    v = slope = area = 0 * sigma
    for k in range(len(T) - 1, -1, -1):
        v = v * sigma + T[k]
        area = area * sigma + T[k] / (k + 1)
        slope = slope * sigma + (k + 1) * T[k + 1] if k + 1 < len(T) else slope
    return v, -slope / H, -H * sigma * area


def _degree(eps: Any, step: float) -> int:
    n, term = 0, 1.0 / eps
    while term > 0.1:
        n += 1
        term = term * step / n
    return n


# -- the first root of a polynomial on [0, 1] ------------------------------------------------------------------------


def first_root(p: list[Any], noise: Any, eps: Any) -> tuple[bool, Any]:
    """Return (touch, sigma) for the first root in (0, 1] of a polynomial known within `noise`; sigma None: no root.

    `touch` says that the polynomial comes to 0 within the noise, and whether it passes is open.
    """
    if p[0] - sum(abs(term) for term in p[1:]) > noise:
        return False, None
    one = 1 + 0 * p[0]
    narrowest = eps**0.5 / 16
    stack = [(0 * one, one, bernstein(p))]
    while stack:
        low, high, b = stack.pop()
        if min(b) > noise:
            continue
        if b[0] > noise and b[-1] < -noise and _changes(b, noise) == 1 and _changes(b, -noise) == 1:
            return False, _newton(p, low, high, eps)
        if high - low < narrowest:
            return True, _lowest(p, low, high)
        left, right = _divided(b)
        middle = low + CUT * (high - low)
        stack += [(middle, high, right), (low, middle, left)]
    return False, None


def bernstein(p: list[Any]) -> list[Any]:
    """Return the Bernstein coefficients on [0, 1] of a polynomial in powers."""
    n = len(p) - 1
    scaled = [term / comb(n, j) for j, term in enumerate(p)]
    return [sum((comb(i, j) * scaled[j] for j in range(1, i + 1)), scaled[0]) for i in range(n + 1)]


def _divided(b: list[Any]) -> tuple[list[Any], list[Any]]:
    left, right, row = [b[0]], [b[-1]], b
    while len(row) > 1:
        row = [first + CUT * (second - first) for first, second in pairwise(row)]
        left.append(row[0])
        right.append(row[-1])
    return left, right[::-1]


def _changes(b: list[Any], level: Any) -> int:
    signs = [value > level for value in b]
    return sum(first != second for first, second in pairwise(signs))


def _value(p: list[Any], sigma: Any) -> Any:
    value = 0 * sigma
    for term in reversed(p):
        value = value * sigma + term
    return value


def _newton(p: list[Any], low: Any, high: Any, eps: Any) -> Any:
    """Return the root of p, positive at `low` and negative at `high`, by Newton's method kept inside the bracket.

    Only steps of Newton's method tell that it has converged: one that leaves the bracket is replaced by a halving,
    whose length says nothing.
    """
    slope = [k * term for k, term in enumerate(p)][1:]
    sigma = 0.5 * (low + high)
    before, settled = high - low, eps**0.75
    for _ in range(MOST_STEPS):
        value, rise = _value(p, sigma), _value(slope, sigma)
        if value > 0:
            low = sigma
        else:
            high = sigma
        shift = -value / rise if rise != 0 else high - low
        if abs(shift) <= eps * sigma or (before <= abs(shift) <= settled * sigma):
            return sigma
        if low < sigma + shift < high:
            sigma, before = sigma + shift, abs(shift)
        else:
            following = 0.5 * (low + high)
            if following in (low, high):
                return sigma
            sigma = following
    return sigma


def _lowest(p: list[Any], low: Any, high: Any) -> Any:
    """Return where p is lowest near a narrow interval: the place of a touch."""
    slope = [k * term for k, term in enumerate(p)][1:]
    bend = [k * term for k, term in enumerate(slope)][1:]
    start = sigma = 0.5 * (low + high)
    for _ in range(12):
        curvature = _value(bend, sigma) if bend else 0
        if curvature <= 0:
            return start
        sigma = sigma - _value(slope, sigma) / curvature
    return sigma if abs(sigma - start) < 0.01 else start


def never_came(v: Any, a: Any, s: Any, c: Any, domain: int, walls: list[Wall], v_error: Any, K: Constants) -> bool:
    """Return whether, going on backward from here, no wall can ever be met."""
    if K.under or domain == 2:
        return False
    u = v - (K.Ss * s + K.Sc * c)
    u_slope = -(a - K.Om * (K.Ss * c - K.Sc * s))
    # u = alpha exp(p s) + beta exp(q s) with p >= q >= 0: once it falls with alpha <= 0 it falls for ever
    sign = walls[0].inward
    away = sign * u_slope >= 0 and sign * (u_slope + K.l1 * u) >= 0
    return away and sign * (u - walls[0].v) > K.V0 + v_error + CLEAR * (abs(v) + K.V0)
