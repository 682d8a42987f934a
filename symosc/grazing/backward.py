"""The origin of a flow into a tangency: integration backward in time to its first contact, missing
none.

Why nothing can be missed in real arithmetic
--------------------------------------------
With s = t_m - t the velocity of a flight obeys v'' - (c/m) v' + (k/m) v = -(B0 Omega/m) sin(theta -
Omega s): damping has changed its sign, the transient grows. So the bounds of
`symosc.engine.first_exit`, which rest on an energy that never grows, do not hold backward. For the
n-th derivative y of v the energy E = y'^2 + (k/m) y^2 obeys

    d/ds sqrt(E) <= (c/m) sqrt(E) + (|B0| Omega/m) Omega^n,

hence over a step H, with y = v^(n) and y' = v^(n+1) taken at its beginning,

    |v^(n+1)| <= exp(c H/m) (sqrt(E) + H (|B0| Omega/m) Omega^n),

which bounds the remainder of the Taylor polynomial of degree n. The steps are short (STEP over the
largest rate), so the remainder is below the rounding error. On each step the gap to a boundary is
that polynomial, known within `noise`: remainder, rounding, and the errors of all steps before,
which grow like the energy. `first_root` finds its first root. At the tangency where the search
starts, the known root is divided out of the polynomial. The bounds hold in real arithmetic; what
rounding may add to them (BACKWARD_ROUNDING) was measured.

A contact that the noise leaves undecided counts as a touch. A search in double precision
(`Origins.arrival`) hands such a step to one with more digits, and goes on from there as if it had
just begun. `Flights` has the same flight in closed form, in any number of digits, by the kernel
`motion` at the time -tau: Newton's method refines a contact with it.

A flight may never have met a boundary. That can happen in an over- or critically damped system
only, and is recognised by a transient that runs away from the only boundary for ever
(`Origins._never_came`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Angle, Context, Number
from symosc.base.errors import ParameterError
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.flow import Constants, belt_at, constants, derivatives
from symosc.kernels import linear
from symosc.kernels._generated import motion, next_derivative
from symosc.kernels.entire import EPS
from symosc.kernels.theorem7_cases import place
from symosc.model import Parameters

# What a search ends with: a contact; a touch, as far as the precision can decide; the end of the
# time; a flight that never met a boundary; velocities beyond HUGE; all steps used up; a contact
# that no number of digits tried decides.
CONTACT = "contact"
TOUCH = "touch"
REACHED = "reached"
NEVER = "never"
LARGE = "large"
LONG = "long"
UNDECIDED = "undecided"

# Length of a step, times the largest rate of the system. An undecided step is repeated with other
# lengths, so that the decision does not depend on where steps end.
STEP = 1.0
REPEATED_STEPS = (1.21, 1.37)
# Rounding error of a Taylor polynomial in units of eps times the size of its terms.
BACKWARD_ROUNDING = 8
# Larger velocities are not followed: nothing can be simulated from there.
HUGE = 1e100
# The work of a search: more than 100 periods at the fastest drive, and less than a second.
MOST_BACKWARD_STEPS = 20_000
# How far back a start is searched, in periods of the excitation.
SEARCH_PERIODS = 100
# At most so many undecided steps of a search are repeated: a flight that stays near a boundary for
# longer stays undecided.
MOST_REPEATS = 40
# How far Newton's method may carry a contact, as a part of a step.
MOST_SHIFT = 1e-3
MOST_CONTACT_NEWTON = 200
# The rounding errors of a flight in closed form are taken to be less than so many units of the
# sizes of its terms.
FLIGHT_ROUNDING = 2**10
# A touch is one of fourth order where v'' times the rate is below this part of the next derivative.
FOURTH_ORDER = 1e-6
# Digits beyond those wanted, with which a refinement begins; the search for it has no more than so
# many digits, and more digits than the missing ones are added.
SPARE_DIGITS = 20
MOST_SEARCH_DIGITS = 200
MORE_DIGITS = 3
# A term of a Taylor polynomial that rounding hides, in units of eps.
HIDDEN = 0.1
# How much more than needed a transient must be beyond its boundary, as a part of the velocities.
SURELY = 1e-9
# Where the steps of Newton's method are below this power of eps (times the number), those that no
# longer shrink are rounding.
ROUNDED_STEPS = 0.75


# --- the first root of a polynomial that is known within a noise ---

CUT = 0.4831  # where an interval is divided: not a fraction at which roots are likely


class FirstRoot(NamedTuple):
    """The first root sigma of a polynomial in (0, 1]; None if there is none.

    With `touch` the polynomial comes within its noise of 0 at sigma, so that it is undecided
    whether there is a root.
    """

    touch: bool
    sigma: Number


NO_ROOT = FirstRoot(False, None)


def first_root(p: list[Number], noise: Number, eps: Number) -> FirstRoot:
    """Return the first root in (0, 1] of a polynomial whose values are known within `noise`."""
    # On all of [0, 1] p is at least p[0] less the sizes of all other terms.
    if p[0] - sum(abs(term) for term in p[1:]) > noise:
        return NO_ROOT
    unit = 1 + 0 * p[0]
    slope = _derivative(p)
    # The smallest interval: where the slope has several roots nearer to each other than this, it is
    # a touch.
    narrowest = max(eps**0.5 / 16, 2.0**-60)
    stack = [(0 * unit, unit, bernstein(p))]
    while stack:
        low, high, b = stack.pop()
        # The polynomial is not below its least Bernstein coefficient: no root in this interval.
        if min(b) > noise:
            continue
        # It falls from above the noise to below it with one change of sign: exactly one root.
        falls = b[0] > noise and b[-1] < -noise
        if falls and _changes_once(b, noise) and _changes_once(b, -noise):
            return FirstRoot(False, _newton(p, slope, low, high, eps))
        # Its slope changes sign exactly once, from falling to rising: the value at the bottom
        # decides. Above the noise there is no root; below it there are two, of which the first one
        # counts; within the noise it is a touch.
        rising = [second > first for first, second in pairwise(b)]
        has_bottom = rising and not rising[0] and rising[-1] and _count_changes(rising) == 1
        if has_bottom:
            falling_slope = [-term for term in slope]  # `_newton` looks for a root from > 0 to < 0
            bottom = _newton(falling_slope, _derivative(falling_slope), low, high, eps)
            value = _polynomial(p, bottom)
            if value > noise:
                continue
            if b[0] > noise and value < -noise:
                return FirstRoot(False, _newton(p, slope, low, bottom, eps))
            return FirstRoot(True, bottom)
        # Undecided at the smallest width: a touch. Else the interval is divided.
        if high - low < narrowest:
            return FirstRoot(True, 0.5 * (low + high))
        left, right = _divided(b)
        middle = low + CUT * (high - low)
        stack += [(middle, high, right), (low, middle, left)]  # the left one is next
    return NO_ROOT


def _divided(b: list[Number]) -> tuple[list[Number], list[Number]]:
    """Return the Bernstein coefficients on both parts of an interval divided at CUT (de
    Casteljau).
    """
    left = [b[0]]
    right = [b[-1]]
    row = b
    while len(row) > 1:
        row = [first + CUT * (second - first) for first, second in pairwise(row)]
        left.append(row[0])
        right.append(row[-1])
    return left, right[::-1]


def _derivative(p: list[Number]) -> list[Number]:
    """Return the power coefficients of the derivative of a polynomial."""
    return [k * term for k, term in enumerate(p)][1:]


def _changes_once(values: list[Number], level: Number) -> bool:
    """Return whether a sequence passes a level exactly once."""
    return _count_changes([value > level for value in values]) == 1


def bernstein(p: list[Number]) -> list[Number]:
    """Convert power coefficients of a polynomial to Bernstein coefficients on [0, 1]."""
    row = [term / math.comb(len(p) - 1, j) for j, term in enumerate(p)]
    coefficients = []
    while row:  # a table of sums: b_i = sum_j comb(i, j) row_j
        coefficients.append(row[0])
        row = [first + second for first, second in pairwise(row)]
    return coefficients


def _count_changes(flags: list[bool]) -> int:
    """Count how often neighbours in a sequence differ."""
    return sum(first != second for first, second in pairwise(flags))


def _polynomial(p: list[Number], sigma: Number) -> Number:
    """Return the value of the polynomial p at sigma."""
    value = 0 * sigma
    for term in reversed(p):
        value = value * sigma + term
    return value


def _newton(p: list[Number], slope: list[Number], low: Number, high: Number, eps: Number) -> Number:
    """Find the root of p between `low`, where p > 0, and `high`, where p < 0.

    `slope` has p's derivative.
    """
    # Only steps of Newton's method can show that it has converged. A step that leaves the bracket
    # is replaced by a halving, whose length says nothing.
    sigma = 0.5 * (low + high)
    last_step = high - low
    settled = eps**ROUNDED_STEPS
    for _ in range(20_000):  # at worst it halves its bracket: enough for thousands of digits
        value = _polynomial(p, sigma)
        rise = _polynomial(slope, sigma)
        if value > 0:
            low = sigma
        else:
            high = sigma
        if rise != 0:
            shift = -value / rise
        else:
            shift = high - low
        is_rounding = last_step <= abs(shift) <= settled * sigma
        if abs(shift) <= eps * sigma or is_rounding:
            return sigma
        if low < sigma + shift < high:
            sigma = sigma + shift
            last_step = abs(shift)
            continue
        middle = 0.5 * (low + high)
        if middle in (low, high):
            return sigma
        sigma = middle
    return sigma


# --- steps backward ---


class Boundary(NamedTuple):
    """A boundary of the domain of a flight: number, velocity, and direction into this domain (1 up,
    -1 down).
    """

    number: int
    v: Number
    inward: int


class BackwardState(NamedTuple):
    """The state of a flight at the time `tau` before its tangency.

    `dx` is its position minus that of the tangency.

    In the last state of a search, `kind` says how the search ended, and `boundary` is the boundary
    that was reached.
    """

    tau: Number
    dx: Number
    v: Number
    a: Number
    v_error: Number
    x_error: Number
    energy_error: Number
    kind: str = ""
    boundary: int = 0


class BackwardHit(NamedTuple):
    """A contact in a step: whether it is a touch, after which share of the step, and the
    boundary.
    """

    touch: bool
    share: Number
    boundary: Boundary


class BackwardStep(NamedTuple):
    """A backward step: first state (with the error bounds of its end), Taylor coefficients T of v,
    first contact.
    """

    begin: BackwardState
    T: list[Number]
    end: tuple[Number, ...]  # change of v, a, and change of dx, in double precision only
    hit: BackwardHit | None


class BackwardSteps:
    """A maker of backward steps from tangencies at one belt.

    `functions` is math or a context of mpmath.
    """

    # A step is linear in v, a and the sine and cosine of the phase. So in double precision one
    # product with a matrix gives its Taylor coefficients, its Bernstein coefficients (less v) and
    # the state at its end.

    def __init__(
        self,
        K: Constants,
        boundary: int,
        domain: int,
        functions: Context = math,
        eps: Number = EPS,
        step: float = STEP,
    ) -> None:
        self.K = K
        self.functions = functions
        self.eps = eps
        self.H = step / K.rate
        # The boundaries of each domain: number, and the direction into the domain (1 up, -1 down).
        numbers = {1: ((1, -1),), 2: ((1, 1), (2, -1)), 3: ((2, 1),)}[domain]
        self.boundaries = [Boundary(n, belt_at(n, K).v, inward) for n, inward in numbers]
        self.touched = next(line for line in self.boundaries if line.number == boundary)
        self.growth = functions.exp(K.cm * self.H)
        # Taylor coefficients T[k] = v^(k) H^k/k! backward: the equation of motion with these in
        # place of its constants.
        cm = -K.cm * self.H
        w0sq = K.w0sq * self.H * self.H
        power = K.fB * self.H * self.H
        self.recurrence: list[tuple[Number, Number, Number]] = []
        term = 1.0 / eps  # in units of eps
        while term > HIDDEN:  # up to the degree whose term rounding hides
            k = len(self.recurrence)
            term = term * step / (k + 1)
            power = power / (k + 2)
            self.recurrence.append((power, cm / (k + 2), w0sq / ((k + 1) * (k + 2))))
            power = power * K.Om * self.H
        self.drive_remainder = abs(power)
        self._matrix: np.ndarray | None = None
        if functions is math:  # only doubles have a matrix
            self._matrix = self._step_matrix()

    def _step_matrix(self) -> np.ndarray:
        """Return the matrix from (v, a, sin, cos) to all of a step at once.

        Its rows: Taylor coefficients, the bound of the remainder, Bernstein coefficients less v,
        and the changes over the step.
        """
        # Its columns are the steps from unit vectors.
        columns = []
        for unit in np.eye(4).tolist():
            *T, behind = self._taylor(*unit)
            dv, slope, area = _changes_over(T, 1.0)
            end = (dv, -slope / self.H, -self.H * area)
            columns.append([*T, behind, *bernstein([0.0, *T[1:]]), *end])
        return np.array(columns).T.copy()

    def begin(self, zero: Number) -> BackwardState:
        """Return the state at the tangency, where the steps begin.

        `zero` is 0 in the arithmetic that is used.
        """
        return BackwardState(zero, zero, self.touched.v + zero, zero, zero, zero, zero)

    def take(self, theta: Number, order: int, state: BackwardState) -> BackwardStep:
        """Take a step backward from `state`.

        `order` is 1, or 3 if G^(1) = G^(2) = 0 at the tangency.
        """
        K = self.K
        H = self.H
        eps = self.eps
        n = len(self.recurrence) + 1
        tau = state.tau
        v = state.v
        a = state.a
        s, c = self.wave(theta, tau)
        if self._matrix is None:
            *T, behind = self._taylor(v, a, s, c)
            end = ()
            reach = sum(map(abs, T[1:]))
            low = v - reach
            high = v + reach
        else:
            rows = linear.product(self._matrix, np.array((v, a, s, c))).tolist()
            T = rows[:n]
            behind = rows[n]
            changes = rows[n + 1 : -3]
            end = tuple(rows[-3:])
            low = v + min(changes)
            high = v + max(changes)
        # Errors of v and of the energy at the end of the step: those at its start, which grow, and
        # new ones. (`energy_error` is that of its root, an acceleration, as in the module's
        # docstring.) The remainder is bounded by the last coefficient and the next one (`behind`).
        remainder = self.growth * (abs(behind) + K.w0 * H * abs(T[-1]) / n + self.drive_remainder)
        drive = abs(K.fB) * (1 + abs(theta) + K.Om * tau)
        rounding = BACKWARD_ROUNDING * eps * (abs(a) * H + (K.w0sq * abs(v) + drive) * H * H)
        energy_error = self.growth * state.energy_error + rounding / H
        v_error = self.growth * state.v_error + H * energy_error + rounding + eps * abs(v)
        if K.w0 > 0:
            v_error = min(v_error, energy_error / K.w0 + rounding + eps * abs(v))
        energy_error = max(energy_error, K.w0 * rounding)
        hit: BackwardHit | None = None
        for boundary in self.boundaries:
            at_start = tau == 0 and boundary is self.touched
            noise = remainder + (rounding if at_start else v_error)
            if boundary.inward > 0:
                least_gap = low - boundary.v
            else:
                least_gap = boundary.v - high
            if not at_start and least_gap > noise:
                continue
            if at_start:  # the root at the tangency is divided out
                p = [boundary.inward * term for term in T[order + 1 :]]
            else:
                p = [
                    boundary.inward * (v - boundary.v),
                    *(boundary.inward * term for term in T[1:]),
                ]
            root = first_root(p, noise, eps)
            if root.sigma is None:
                continue
            if hit is None or root.sigma < hit.share:
                hit = BackwardHit(root.touch, root.sigma, boundary)
        return BackwardStep(state._replace(v_error=v_error, energy_error=energy_error), T, end, hit)

    def wave(self, theta: Number, tau: Number) -> tuple[Number, Number]:
        """Return sine and cosine of the drive's phase at the time tau before the tangency at the
        phase theta.
        """
        angle = theta - self.K.Om * tau
        return self.functions.sin(angle), self.functions.cos(angle)

    def moved(self, step: BackwardStep, sigma: Number = None) -> BackwardState:
        """Return the state at the fraction `sigma` of a step (None: 1), with the error bounds at
        the step's end.
        """
        state = step.begin
        if sigma is None:
            tau = self.H
            (dv, a, dx) = step.end
        else:
            dv, slope, area = _changes_over(step.T, sigma)
            tau = sigma * self.H
            a = -slope / self.H
            dx = -self.H * area
        dx = state.dx + dx
        x_error = state.x_error + self.H * state.v_error + self.eps * abs(dx)
        return BackwardState(
            state.tau + tau, dx, state.v + dv, a, state.v_error, x_error, state.energy_error
        )

    def contact(self, step: BackwardStep, hit: BackwardHit) -> BackwardState:
        """Return the state at the contact `hit` in a step."""
        touch, sigma, boundary = hit
        if touch:
            kind = TOUCH
        else:
            kind = CONTACT
        return self.moved(step, sigma)._replace(v=boundary.v, kind=kind, boundary=boundary.number)

    def _taylor(self, v: Number, a: Number, s: Number, c: Number) -> list[Number]:
        """Return Taylor coefficients of v from v, a and the phase's sine s, cosine c.

        The last bounds the remainder.
        """
        sines = (s, -c, -s, c)  # (-d/dphase)^k sin
        T = [v, -a * self.H]
        for k, (power, cm, w0sq) in enumerate(self.recurrence):
            T.append(next_derivative(T[k + 1], T[k], power * sines[k % 4], cm, w0sq))
        return T


def _changes_over(T: list[Number], sigma: Number) -> tuple[Number, Number, Number]:
    """Return the change of the polynomial T from 0 to sigma, its slope at sigma, and its integral
    from 0 to sigma.
    """
    change = 0 * sigma
    slope = change
    area = change
    for k in range(len(T) - 1, -1, -1):
        slope = slope * sigma + change
        change = change * sigma + (T[k] if k else 0)
        area = area * sigma + T[k] / (k + 1)
    return change, slope, sigma * area


# --- flights in closed form, in any number of digits ---


class Instant(NamedTuple):
    """The state of a flight at the time tau before its tangency, with derivatives and error bounds."""

    # A shift of theta_m along the contacts moves the state at fixed tau by
    #
    #     dv/d(theta_m) = (a - E1(-tau) G1)/Omega
    #     dx/d(theta_m) = (v + (E0(-tau) + (c/m) E1(-tau)) G1 m/k)/Omega
    #
    # with G1 = G^(1) at the tangency: at a fixed time neighbouring contacts differ in x only.

    dx: Number  # displacement from the tangency
    v: Number
    a: Number
    b: Number  # dv''
    w: Number  # dv'''
    v_theta: Number  # derivatives with respect to theta_m at fixed tau
    x_theta: Number
    v_error: Number
    x_error: Number


class Flights:
    """The flights of one mapping into its tangencies, computed with `digits` decimal digits."""

    def __init__(self, p: Parameters, mapping: str, digits: int) -> None:
        self.p = p
        self.place = place(mapping)
        self.digits = digits
        self.arithmetic = MpArithmetic(p, digits)
        self.context = self.arithmetic.context
        self.K = self.arithmetic.K
        self.v = self.number(p.belt(self.place.boundary))  # of the belt that is touched
        self._basis = self.arithmetic.namespace["basis"]
        self._steps: dict[float, BackwardSteps] = {}

    def number(self, value: Any) -> Number:
        """Return a Fraction, float or sympy constant as a number of this precision."""
        if hasattr(value, "evalf"):
            return self.context.mpf(str(value.evalf(self.digits + 5)))
        if hasattr(value, "numerator"):
            return self.arithmetic.number(value)
        return self.context.mpf(value)

    def contact(self, theta: Number) -> Number:
        """Return the position x_m(theta) of a tangency at the phase theta, at which F = 0 on the
        belt.
        """
        rest = self.number(
            (self.p.A(self.place.domain) - self.p.c * self.p.belt(self.place.boundary)) / self.p.k
        )
        return rest + self.number(self.p.B0 / self.p.k) * self.context.cos(theta)

    def instant(self, theta: Number, tau: Number) -> Instant:
        """Return the state of the flight at the time tau before its tangency at the phase theta."""
        K = self.K
        v0 = self.v
        s = self.context.sin(theta)
        c = self.context.cos(theta)
        E0, E1, E2, R2, I2, s_Om, c_Om = self._basis(-tau, K)
        dx, dv, a = motion(v0, 0 * v0, s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        v = v0 + dv
        b, w, _ = derivatives(v, a, s * c_Om + c * s_Om, c * c_Om - s * s_Om, K)
        G1 = -(K.w0sq * v0 + K.fB * s)
        drive = abs(R2) + abs(I2)
        v_size = abs(v0) * (1 + K.w0sq * abs(E2)) + abs(K.fB) * drive
        x_size = abs(v0) * (abs(E1) + K.cm * abs(E2)) + abs(K.f0) * (drive + abs(E2))
        # The phases are rounded too: the larger they are, the more.
        noise = FLIGHT_ROUNDING * self.context.eps * (1 + abs(theta) + K.Om * tau)
        v_theta = (a - E1 * G1) / K.Om
        x_theta = (v + (E0 + K.cm * E1) * G1 / K.w0sq) / K.Om
        return Instant(dx, v, a, b, w, v_theta, x_theta, noise * v_size, noise * x_size)

    def state(self, theta: Number, tau: Number) -> BackwardState:
        """Return the state from which a search backward can start at the time tau before the
        tangency.
        """
        instant = self.instant(theta, tau)
        return BackwardState(
            tau,
            instant.dx,
            instant.v,
            instant.a,
            v_error=instant.v_error,
            x_error=instant.x_error,
            energy_error=instant.v_error * self.K.rate,
        )

    def refined(
        self, theta: Number, arrival: BackwardState, tau_max: Number
    ) -> BackwardState | None:
        """Refine the result `arrival` of a search back to `tau_max` to all digits; None if Newton's
        method fails.
        """
        if arrival.kind in (NEVER, LARGE, LONG):
            return arrival
        tau = self.number(tau_max if arrival.kind == REACHED else arrival.tau)
        speed = None
        if arrival.boundary:
            speed = self.number(self.p.belt(arrival.boundary))
            searched_tau = tau
            tau = self._contact_time(theta, tau, speed, arrival.kind == TOUCH)
            # How far Newton's method may carry a contact from where the search has found it.
            time_error = abs(float(arrival.v_error) / (float(arrival.a) or 1.0))
            farthest = MOST_SHIFT * STEP / float(self.K.rate) + time_error
            if tau is None or abs(tau - searched_tau) > farthest:
                return None
        instant = self.instant(theta, tau)
        return arrival._replace(
            tau=tau,
            dx=instant.dx,
            v=instant.v if speed is None else speed,
            a=instant.a,
            v_error=instant.v_error,
            x_error=instant.x_error,
        )

    def _contact_time(self, theta: Number, tau: Number, speed: Number, touch: bool) -> Number:
        """Find the time near `tau` at which v = `speed`, or, with `touch`, at which v is nearest to
        `speed`.
        """
        last_shift = None
        for _ in range(MOST_CONTACT_NEWTON):
            instant = self.instant(theta, tau)
            bend = abs(instant.b) * float(self.K.rate)
            is_of_fourth_order = bend < FOURTH_ORDER * abs(instant.w)
            # At a contact v - speed is 0; at a touch v' or, at one of fourth order, v''.
            if not touch:
                residual = instant.v - speed
                slope = instant.a
            elif is_of_fourth_order:
                residual = instant.b
                slope = instant.w
            else:
                residual = instant.a
                slope = instant.b
            if slope == 0:
                if residual == 0:
                    return tau
                return None
            # tau runs backward, so Newton's step has the sign +.
            shift = residual / slope
            tau = tau + shift
            if abs(shift) <= self.context.eps * 4 * abs(tau):
                return tau
            is_small = abs(shift) < self.context.eps**ROUNDED_STEPS * abs(tau)
            if last_shift is not None and abs(shift) >= last_shift and is_small:  # rounding
                return tau
            last_shift = abs(shift)
        return None

    def repeat_step(
        self, theta: Number, order: int, tau: float, step: float
    ) -> tuple[BackwardState | None, BackwardState]:
        """Repeat the step at `tau` in more digits, with the length `step`; return its contact (or
        None), and the state from which a search in doubles goes on.
        """
        if step not in self._steps:
            where = self.place
            context = self.context
            self._steps[step] = BackwardSteps(
                self.K, where.boundary, where.domain, context, context.eps, step
            )
        steps = self._steps[step]
        # The longer step has the same middle as the one that it repeats; near the tangency, where
        # it cannot, it begins there.
        earlier = (step - STEP) / 2 / self.K.rate
        if tau > earlier:
            state = self.state(theta, tau - earlier)
        else:
            state = steps.begin(0 * theta)
        taken = steps.take(theta, order, state)
        if taken.hit is None:
            return None, rounded(self.state(theta, state.tau + steps.H))
        return steps.contact(taken, taken.hit), rounded(state)


def rounded(state: BackwardState) -> BackwardState:
    """Round a state to doubles; add the rounding errors to its error bounds."""
    tau, dx, v, a, v_error, x_error, energy_error, *_ = state
    tau, dx, v, a = map(float, (tau, dx, v, a))
    v_error, x_error, energy_error = map(float, (v_error, x_error, energy_error))
    eps = 2.0**-53  # half a unit of the last bit
    return BackwardState(
        tau, dx, v, a, v_error + eps * abs(v), x_error + eps * abs(dx), energy_error + eps * abs(a)
    )


class Origins:
    """A search backward from the tangencies of one mapping for the contacts that their flows come
    from.

    It raises ParameterError for a mapping that cannot graze, and for k = 0.
    """

    def __init__(self, p: Parameters, mapping: str) -> None:
        where = place(mapping)
        if p.k == 0:
            raise ParameterError(
                "k",
                p.k,
                "must be > 0 here: without a spring F = 0 fixes the phase, not the contact",
            )
        self.p = p
        self.mapping = mapping
        self.place = where
        self.K = constants(p)
        self.steps = BackwardSteps(self.K, where.boundary, where.domain)
        self._flights: dict[int, Flights] = {}

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.p, self.mapping)

    def flights(self, digits: int) -> Flights:
        """Return the flights of the mapping with that many digits, from a cache."""
        if digits not in self._flights:
            self._flights[digits] = Flights(self.p, self.mapping, digits)
        return self._flights[digits]

    def arrival(
        self,
        angle: Angle | float,
        order: int = 1,
        far: float | None = None,
        digits: int = 60,
        repeats: int = len(REPEATED_STEPS),
        most_steps: int = MOST_BACKWARD_STEPS,
    ) -> BackwardState:
        """Follow the flow back from the tangency at a phase, in doubles, to the first contact or to
        the time `far`.

        `order` is that of the first G-function that does not vanish at the tangency. A step with an
        undecided contact is repeated up to `repeats` times, with `digits`, then with twice as many.
        A contact that stays undecided is returned as a touch.
        """
        steps = self.steps
        theta = float(angle)
        if far is None:
            far = SEARCH_PERIODS * self.K.period
        state = steps.begin(0.0)
        undecided_left = MOST_REPEATS
        for _ in range(most_steps):
            step = steps.take(theta, order, state)
            state = step.begin
            hit = step.hit
            is_touch = hit is not None and hit.touch
            if repeats and is_touch and state.tau <= far:
                undecided_left = undecided_left - 1
                arrival, state = self._repeated(angle, order, state.tau, digits, repeats)
                if arrival is None and undecided_left:
                    continue  # there was no contact: the search goes on behind the step
                if arrival is None:
                    arrival = state._replace(kind=LONG)  # too many steps were undecided
                if arrival.tau <= far:
                    return arrival
                return self._state_at_limit(theta, order, state, far)
            share = hit.share if hit else 1.0
            if state.tau + share * steps.H > far:
                return self._state_at_limit(theta, order, state, far)
            if hit:
                return steps.contact(step, hit)
            if state.tau > 0 and self._never_came(theta, state):
                return state._replace(kind=NEVER)
            state = steps.moved(step)
            if abs(state.v) > HUGE:
                return state._replace(kind=LARGE)
        return state._replace(kind=LONG)

    def _repeated(
        self, angle: Angle | float, order: int, tau: float, digits: int, repeats: int
    ) -> tuple[BackwardState | None, BackwardState]:
        """Repeat the backward step at `tau`, in which doubles left a contact undecided, up to
        `repeats` times.

        Return the contact, or a touch if it stays undecided, or None if there is none; and the
        state behind the step.
        """
        # With another length, then with yet another one and twice as many digits.
        for times, length in enumerate(REPEATED_STEPS[:repeats], start=1):
            flights = self.flights(times * digits)
            arrival, state = flights.repeat_step(flights.number(angle), order, tau, length)
            if arrival is None or arrival.kind == CONTACT:
                break
        return arrival, state

    def _state_at_limit(
        self, theta: float, order: int, state: BackwardState, far: float
    ) -> BackwardState:
        """Return the state of the flow at the time `far`, which lies in the backward step that
        begins at `state`.
        """
        step = self.steps.take(theta, order, state)
        return self.steps.moved(step, (far - state.tau) / self.steps.H)._replace(kind=REACHED)

    def _never_came(self, theta: float, state: BackwardState) -> bool:
        """Return whether the flow back from `state` surely meets no boundary: it runs away from its
        only one.
        """
        K = self.K
        if K.under or self.place.domain == 2:
            return False
        s, c = self.steps.wave(theta, state.tau)
        u = state.v - (K.Ss * s + K.Sc * c)
        u_slope = -(state.a - K.Om * (K.Ss * c - K.Sc * s))
        # u, the transient, is alpha exp(p s) + beta exp(q s) with p >= q >= 0: once it falls with
        # alpha <= 0 it falls for ever.
        sign = self.steps.touched.inward
        boundary = self.steps.touched.v
        runs_away = sign * u_slope >= 0 and sign * (u_slope + K.l1 * u) >= 0
        # The steady motion never exceeds V0.
        gap = K.V0 + state.v_error + SURELY * (abs(state.v) + K.V0)
        return bool(runs_away and sign * (u - boundary) > gap)

    def refined_arrival(
        self, angle: Angle | float, order: int, far: Callable[[Flights], Number], wanted: int
    ) -> tuple[BackwardState, Flights]:
        """Return where the flow came from with `wanted` right decimals, and the `Flights` used.

        It is what `arrival` finds, refined; or UNDECIDED if that fails. `far` returns the time to
        search back, as a number of the flights that it gets.
        """
        begin_digits = wanted + SPARE_DIGITS
        flights = self.flights(begin_digits)
        search_digits = min(begin_digits, MOST_SEARCH_DIGITS)
        doubles = self.arrival(angle, order, float(far(flights)), digits=search_digits)
        while True:
            arrival = flights.refined(flights.number(angle), doubles, far(flights))
            if arrival is None:
                return doubles._replace(kind=UNDECIDED), flights
            # In more digits the contact may lie just beyond the end of the search.
            if arrival.kind not in (REACHED, LONG) and arrival.tau > far(flights):
                doubles = doubles._replace(kind=REACHED, boundary=0)
                continue
            # The errors of a contact's time and position, or of the state at the end of the search.
            worst = 0 * arrival.a
            context = flights.context
            if arrival.kind == CONTACT:
                t_error = arrival.v_error / abs(arrival.a)
                worst = max(t_error, arrival.x_error + abs(arrival.v) * t_error)
            elif arrival.kind == REACHED:
                worst = max(arrival.x_error, arrival.v_error)
            if worst > 0:  # it must be below 10^-(wanted + 2)
                missing_digits = int(context.ceil(context.log10(worst))) + wanted + 2
            else:
                missing_digits = 0
            if missing_digits <= 0:
                return arrival, flights
            flights = self.flights(flights.digits + missing_digits + MORE_DIGITS)
