"""Backward in time from a tangency to the boundary that the flow came from: no contact is passed over.

Why nothing can be missed in real arithmetic
--------------------------------------------
With s = t_m - t the velocity of a flight obeys v'' - (c/m) v' + (k/m) v = -(B0 Omega/m) sin(theta - Omega s): damping
has changed its sign, the transient grows. So the bounds of `symosc.engine.first_exit`, which rest on an energy that
never grows, do not hold backward. For the n-th derivative y of v the energy E = y'^2 + (k/m) y^2 obeys

    d/ds sqrt(E) <= (c/m) sqrt(E) + (|B0| Omega/m) Omega^n,

hence over a step H, with y = v^(n) and y' = v^(n+1) taken at its beginning,

    |v^(n+1)| <= exp(c H/m) (sqrt(E) + H (|B0| Omega/m) Omega^n),

which bounds the remainder of the Taylor polynomial of degree n. The steps are short (STEP over the largest rate), so
the remainder is below the rounding error. On each step the gap to a boundary is that polynomial, known within `noise`:
remainder, rounding, and the errors of all steps before, which grow like the energy. `symosc.grazing.roots` finds its
first root. At the tangency where the search starts, the known root is divided out of the polynomial. The bounds hold in
real arithmetic; what rounding may add to them (BACKWARD_ROUNDING) was measured.

A contact that the noise leaves open is a touch as far as this precision tells. A search in double precision hands such
a step to one with more digits (`look`), and goes on from there as if it had just begun.

A flight may never have met a boundary. That can happen in an over- or critically damped system only, and is recognised
by a transient that runs away from the only boundary for ever (`_never_came`). An underdamped transient comes back.

`BackwardSteps` run on floats and on mpmath numbers; a `Search` over many steps runs on floats.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from symosc.aliases import Context, Number
from symosc.engine.flow import Constants
from symosc.grazing.roots import bernstein, first_root
from symosc.kernels._generated import next_derivative
from symosc.kernels.entire import EPS

# What a search ends with: a contact; a touch, as far as the precision tells; the end of the time; a flight that never
# met a boundary; velocities beyond HUGE; all steps used up.
CONTACT, TOUCH, REACHED, NEVER, LARGE, LONG = "contact", "touch", "reached", "never", "large", "long"

# Length of a step, times the largest rate of the system.
STEP = 1.0
# Rounding error of a Taylor polynomial in units of eps times the size of its terms.
BACKWARD_ROUNDING = 8
# What a flight must stay away from a boundary to be said never to have met it, as a part of the velocity's size.
CLEAR_GAP = 1e-9
# Larger velocities are not followed: nothing can be simulated from there.
HUGE = 1e100
# The work of a search: more than 100 periods at the fastest drive, and less than a second.
MOST_BACKWARD_STEPS = 20_000


class Arrival(NamedTuple):
    """Where a backward flight ends: `tau` before the tangency, displaced by dx, with velocity v and acceleration a."""

    kind: str
    boundary: int  # the number of the one that was met, else 0
    tau: Number
    dx: Number
    v: Number
    a: Number
    v_error: Number  # bound of the error of v at that time
    x_error: Number


class Boundary(NamedTuple):
    """A boundary of the domain: its number, its velocity, and the direction into the domain, 1 up or -1 down."""

    number: int
    v: Number
    inward: int


class BackwardState(NamedTuple):
    """A flight `tau` before the tangency, with the bounds of its errors."""

    tau: Number
    dx: Number
    v: Number
    a: Number
    energy_error: Number
    v_error: Number
    x_error: Number


class BackwardHit(NamedTuple):
    """A contact on a step: at its part `sigma`, with which boundary, and whether it is open (a touch)."""

    touch: bool
    sigma: Number
    boundary: Boundary


def boundaries_of(domain: int, K: Constants) -> list[Boundary]:
    """Return the boundaries of domain 1, 2 or 3, the lower one first."""
    found = [Boundary(domain - 1, K.belt1.v if domain == 2 else K.belt2.v, 1)] if domain > 1 else []
    return found + ([Boundary(domain, K.belt1.v if domain == 1 else K.belt2.v, -1)] if domain < 3 else [])


class BackwardStep(NamedTuple):
    """A step of a flight: Taylor coefficients of v over it, bounds of them and of v, and the changes of v, a, dx."""

    T: list[Number]
    remainder: Number
    low: Number
    high: Number
    end: tuple[Number, Number, Number]


class BackwardSteps:
    """Steps backward from tangencies of one system at one belt, in any arithmetic.

    Parameters
    ----------
    K : Constants
    boundary, domain : int
        The belt that is touched and the domain of the flow.
    functions, eps :
        The arithmetic of `K`, and its unit of rounding.
    step : float
        Length of a step times K.rate.
    """

    def __init__(self, K: Constants, boundary: int, domain: int, functions: Context, eps: Number, step: float) -> None:
        self.K, self.functions, self.eps = K, functions, eps
        self.domain, self.boundaries = domain, boundaries_of(domain, K)
        self.touched = next(each for each in self.boundaries if each.number == boundary)
        self.n, self.H = _degree(eps, step), step / K.rate
        self.growth = functions.exp(K.cm * self.H)
        # Taylor coefficients T[k] = v^(k) H^k/k! backward: the equation of motion with these in place of its constants.
        cm, w0sq, power = -K.cm * self.H, K.w0sq * self.H * self.H, K.fB * self.H * self.H
        self.recurrence = []
        for k in range(self.n):
            power = power / (k + 2)
            self.recurrence.append((power, cm / (k + 2), w0sq / ((k + 1) * (k + 2))))
            power = power * K.Om * self.H
        self.drive_remainder = abs(power)

    def begin(self, zero: Number) -> BackwardState:
        """Return the state at the tangency."""
        return BackwardState(zero, zero, self.touched.v + zero, zero, zero, zero, zero)

    def over(
        self, theta: Number, order: int, state: BackwardState
    ) -> tuple[BackwardHit | None, BackwardStep, BackwardState]:
        """Return the first contact on the step from a state, the step, and the state with the errors at its end.

        `order` is that of the first G-function that does not vanish at the tangency, 1 or 3.
        """
        K, H, eps = self.K, self.H, self.eps
        tau, v, a = state.tau, state.v, state.a
        step = self._step(v, a, *self.wave(theta, tau))
        rounding = (
            BACKWARD_ROUNDING
            * eps
            * (abs(a) * H + (K.w0sq * abs(v) + abs(K.fB) * (1 + abs(theta) + K.Om * tau)) * H * H)
        )
        energy_error = self.growth * state.energy_error + rounding / H
        v_error = self.growth * state.v_error + H * energy_error + rounding + eps * abs(v)
        if K.w0 > 0:
            v_error = min(v_error, energy_error / K.w0 + rounding + eps * abs(v))
        energy_error = max(energy_error, K.w0 * rounding)
        found = None
        for boundary in self.boundaries:
            at_start = tau == 0 and boundary is self.touched
            noise = step.remainder + (rounding if at_start else v_error)
            if not at_start and (step.low - boundary.v if boundary.inward > 0 else boundary.v - step.high) > noise:
                continue
            if at_start:
                p = [boundary.inward * term for term in step.T[order + 1 :]]
            else:
                p = [boundary.inward * (v - boundary.v), *(boundary.inward * term for term in step.T[1:])]
            touch, sigma = first_root(p, noise, eps)
            if sigma is not None and (found is None or sigma < found.sigma):
                found = BackwardHit(touch, sigma, boundary)
        return found, step, BackwardState(tau, state.dx, v, a, energy_error, v_error, state.x_error)

    def wave(self, theta: Number, tau: Number) -> tuple[Number, Number]:
        """Return sine and cosine of the phase tau before theta."""
        angle = theta - self.K.Om * tau
        return self.functions.sin(angle), self.functions.cos(angle)

    def moved(self, state: BackwardState, step: BackwardStep, sigma: Number) -> BackwardState:
        """Return the state at the part `sigma` of a step, whose errors are those at its end."""
        dv, slope, area = at(step.T, sigma)
        return self._at(state, sigma * self.H, dv, -slope / self.H, -self.H * area)

    def arrival(self, state: BackwardState, step: BackwardStep, found: BackwardHit) -> Arrival:
        """Return the contact found on a step from a state."""
        here = self.moved(state, step, found.sigma)
        kind = TOUCH if found.touch else CONTACT
        number, v, _ = found.boundary
        return Arrival(kind, number, here.tau, here.dx, v, here.a, here.v_error, here.x_error)

    def _at(self, state: BackwardState, tau: Number, dv: Number, a: Number, dx: Number) -> BackwardState:
        dx = state.dx + dx
        x_error = state.x_error + self.H * state.v_error + self.eps * abs(dx)
        return BackwardState(state.tau + tau, dx, state.v + dv, a, state.energy_error, state.v_error, x_error)

    def _taylor(self, v: Number, a: Number, s: Number, c: Number) -> list[Number]:
        """Return the Taylor coefficients of v over the part of a step gone back, and the one behind them."""
        sines = (s, -c, -s, c)  # (-d/dphase)^k sin
        T = [v, -a * self.H]
        for k, (power, cm, w0sq) in enumerate(self.recurrence):
            T.append(next_derivative(T[k + 1], T[k], power * sines[k % 4], cm, w0sq))
        return T

    def _remainder(self, behind: Number, last: Number) -> Number:
        """Return the bound of what the Taylor polynomial lacks, from its last coefficient and the one behind it."""
        return self.growth * (abs(behind) + self.K.w0 * self.H * abs(last) / (self.n + 1) + self.drive_remainder)

    def _step(self, v: Number, a: Number, s: Number, c: Number) -> BackwardStep:
        *T, behind = self._taylor(v, a, s, c)
        spread = sum(map(abs, T[1:]))
        return BackwardStep(T, self._remainder(behind, T[-1]), v - spread, v + spread, ())  # type: ignore[arg-type]


class Search(BackwardSteps):
    """Searches of one system in double precision.

    A step is linear in v, a and the sine and cosine of the phase. So one product with a matrix gives its Taylor
    coefficients, its Bernstein coefficients (less v) and the state at its end.
    """

    def __init__(self, K: Constants, boundary: int, domain: int) -> None:
        super().__init__(K, boundary, domain, math, EPS, STEP)
        columns = []
        for i in range(4):
            unit = [float(i == j) for j in range(4)]
            *T, behind = self._taylor(*unit)
            dv, slope, area = at(T, 1.0)
            columns.append([*T, behind, *bernstein([0.0, *T[1:]]), dv, -slope / self.H, -self.H * area])
        self._matrix = np.array(columns).T.copy()

    def _step(self, v: float, a: float, s: float, c: float) -> BackwardStep:
        rows, n = (self._matrix @ np.array((v, a, s, c))).tolist(), self.n + 1
        changes = rows[n + 1 : -3]
        remainder = self._remainder(rows[n], rows[n - 1])
        return BackwardStep(rows[:n], remainder, v + min(changes), v + max(changes), tuple(rows[-3:]))

    def run(
        self,
        theta: float,
        order: int,
        tau_max: float,
        look: Callable[[float], tuple[Arrival | None, BackwardState]] | None = None,
        most_steps: int = MOST_BACKWARD_STEPS,
    ) -> Arrival:
        """Follow the flow backward from the tangency at the phase theta, to the first contact or over tau_max.

        Parameters
        ----------
        theta : float
        order : int
            Order of the first G-function that does not vanish there, 1 or 3.
        tau_max : float
            Time to search.
        look : callable, optional
            Decides with more digits what is open on the step that begins at a given time. It returns the arrival there,
            or None and the state after the step. Without it what is open is a touch.
        most_steps : int
        """
        state = self.begin(0.0)
        for _ in range(most_steps):
            found, step, state = self.over(theta, order, state)
            if found and found.touch and look is not None and state.tau <= tau_max:
                arrival, state = look(state.tau)
                if arrival is None:
                    continue
                return arrival if arrival.tau <= tau_max else self._reached(theta, order, state, tau_max)
            if state.tau + (found.sigma if found else 1.0) * self.H > tau_max:
                return self._reached(theta, order, state, tau_max)
            if found:
                return self.arrival(state, step, found)
            if state.tau > 0 and self._never_came(theta, state):
                return _ended(NEVER, state)
            state = self.ended(state, step)
            if abs(state.v) > HUGE:
                return _ended(LARGE, state)
        return _ended(LONG, state)

    def ended(self, state: BackwardState, step: BackwardStep) -> BackwardState:
        """Return the state at the end of a step."""
        dv, a, dx = step.end
        return self._at(state, self.H, dv, a, dx)

    def _reached(self, theta: float, order: int, state: BackwardState, tau_max: float) -> Arrival:
        """Return the end of the search, reached on the step from a state."""
        _, step, state = self.over(theta, order, state)
        return _ended(REACHED, self.moved(state, step, (tau_max - state.tau) / self.H))

    def _never_came(self, theta: float, state: BackwardState) -> bool:
        """Return whether, going on backward from a state, no boundary is met."""
        K = self.K
        if K.under or self.domain == 2:
            return False
        s, c = self.wave(theta, state.tau)
        u = state.v - (K.Ss * s + K.Sc * c)
        u_slope = -(state.a - K.Om * (K.Ss * c - K.Sc * s))
        # u = alpha exp(p s) + beta exp(q s) with p >= q >= 0: once it falls with alpha <= 0 it falls for ever
        sign = self.boundaries[0].inward
        away = sign * u_slope >= 0 and sign * (u_slope + K.l1 * u) >= 0
        clear = K.V0 + state.v_error + CLEAR_GAP * (abs(state.v) + K.V0)
        return bool(away and sign * (u - self.boundaries[0].v) > clear)


def _ended(kind: str, state: BackwardState) -> Arrival:
    """Return an end of a search without a contact."""
    return Arrival(kind, 0, state.tau, state.dx, state.v, state.a, state.v_error, state.x_error)


def at(T: list[Number], sigma: Number) -> tuple[Number, Number, Number]:
    """Return the change of a polynomial from 0 to sigma, its slope at sigma and its integral."""
    change = slope = area = 0 * sigma
    for k in range(len(T) - 1, -1, -1):
        slope = slope * sigma + change
        change = change * sigma + (T[k] if k else 0)
        area = area * sigma + T[k] / (k + 1)
    return change, slope, sigma * area


def _degree(eps: Number, step: float) -> int:
    n, term = 0, 1.0 / eps
    while term > 0.1:
        n += 1
        term = term * step / n
    return n
