"""The flight that ends in a tangency, in closed form and in any number of digits: polishing what a search has found.

A search back in time (`symosc.grazing.backward_flow`) tells in double precision which contact comes first, and where
about. Here the same flight is evaluated by the kernel `motion` at the time -tau. Newton's method makes the contact
right to as many digits as wanted, and the steps that double precision leaves open are decided.

Between a tangency at the phase theta_m and a point tau earlier, a shift of theta_m along the contacts moves the
state at fixed tau by

    dv/d(theta_m) = (a - E1(-tau) G1)/Omega
    dx/d(theta_m) = (v + (E0(-tau) + (c/m) E1(-tau)) G1 m/k)/Omega

with G1 = G^(1) at the tangency and v, a the state at the point: at a fixed time neighbouring contacts differ in x only.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from symosc.aliases import Number
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.flow import derivatives
from symosc.grazing.backward_flow import (
    CONTACT,
    LARGE,
    LONG,
    NEVER,
    REACHED,
    STEP,
    TOUCH,
    Arrival,
    BackwardState,
    BackwardSteps,
)
from symosc.kernels._generated import motion
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters

# A step that is open is looked at again with other lengths, so that it does not depend on where steps end.
LOOK_STEPS = (1.21, 1.37)
# Rounding error of the closed form, in units of eps times the size of its terms.
DIGITS_ROUNDING = 2**10
MOST_CONTACT_NEWTON = 200
# How far Newton's method may carry a contact away from where the search has found it, as a part of a step.
NEAR_TOUCH = 1e-3


class Instant(NamedTuple):
    """A flight at the time tau before its tangency."""

    dx: Number  # displacement from the tangency
    v: Number
    a: Number
    b: Number  # dv''
    w: Number  # dv'''
    v_theta: Number  # derivatives by theta_m at fixed tau
    x_theta: Number
    v_error: Number
    x_error: Number


class Flights:
    """Flights of one mapping into its tangencies, with `digits` decimal digits.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".
    digits : int
    """

    def __init__(self, p: Parameters, mapping: str, digits: int) -> None:
        self.p, self.place, self.digits = p, place(mapping), digits
        self.arithmetic = MpArithmetic(p, digits)
        self.context, self.K = self.arithmetic.context, self.arithmetic.K
        self.v = self.number(p.belt(self.place.boundary))  # of the belt that is touched
        self._basis = self.arithmetic.namespace["basis"]
        self._steps: dict[float, BackwardSteps] = {}

    def number(self, value: Any) -> Number:
        """Return a Fraction, a float or a sympy constant as a number of this precision."""
        if hasattr(value, "evalf"):
            return self.context.mpf(str(value.evalf(self.digits + 5)))
        return self.arithmetic.number(value) if hasattr(value, "numerator") else self.context.mpf(value)

    def contact(self, theta: Number) -> Number:
        """Return x_m(theta)."""
        rest = self.number((self.p.A(self.place.domain) - self.p.c * self.p.belt(self.place.boundary)) / self.p.k)
        return rest + self.number(self.p.B0 / self.p.k) * self.context.cos(theta)

    def instant(self, theta: Number, tau: Number) -> Instant:
        """Return the flight tau before the tangency at the phase theta."""
        K, v0 = self.K, self.v
        s, c = self.context.sin(theta), self.context.cos(theta)
        E0, E1, E2, R2, I2, s_Om, c_Om = self._basis(-tau, K)
        dx, dv, a = motion(v0, 0 * v0, s, c, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
        v = v0 + dv
        b, w, _ = derivatives(v, a, s * c_Om + c * s_Om, c * c_Om - s * s_Om, K)
        G1 = -(K.w0sq * v0 + K.fB * s)
        drive = abs(R2) + abs(I2)
        v_size = abs(v0) * (1 + K.w0sq * abs(E2)) + abs(K.fB) * drive
        x_size = abs(v0) * (abs(E1) + K.cm * abs(E2)) + abs(K.f0) * (drive + abs(E2))
        noise = DIGITS_ROUNDING * self.context.eps * (1 + abs(theta) + K.Om * tau)
        v_theta = (a - E1 * G1) / K.Om
        x_theta = (v + (E0 + K.cm * E1) * G1 / K.w0sq) / K.Om
        return Instant(dx, v, a, b, w, v_theta, x_theta, noise * v_size, noise * x_size)

    # -- polishing ---------------------------------------------------------------------------------------------------

    def polished(self, theta: Number, found: Arrival, tau_max: Number) -> Arrival | None:
        """Return an arrival in double precision with all digits; None if Newton's method leads elsewhere."""
        if found.kind in (NEVER, LARGE, LONG):
            return found
        tau = self.number(tau_max if found.kind == REACHED else found.tau)
        speed = self.number(self.p.belt(found.boundary)) if found.boundary else None
        if speed is not None:
            begin, reach = (
                tau,
                NEAR_TOUCH * STEP / float(self.K.rate) + abs(float(found.v_error) / (float(found.a) or 1.0)),
            )
            tau = self._root(theta, tau, speed, found.kind == TOUCH)
            if tau is None or abs(tau - begin) > reach:
                return None
        now = self.instant(theta, tau)
        v = now.v if speed is None else speed
        return found._replace(tau=tau, dx=now.dx, v=v, a=now.a, v_error=now.v_error, x_error=now.x_error)

    def _root(self, theta: Number, tau: Number, speed: Number, touch: bool) -> Number:
        """Return where v is `speed` by Newton's method, or where it is nearest to it, for a touch."""
        before = None
        for _ in range(MOST_CONTACT_NEWTON):
            now = self.instant(theta, tau)
            top, slope = (now.v - speed, now.a) if not touch else (now.a, now.b)
            if touch and abs(now.b) * float(self.K.rate) < 1e-6 * abs(now.w):
                top, slope = now.b, now.w  # a touch of fourth order
            if slope == 0:
                return tau if top == 0 else None
            shift = top / slope
            tau = tau + shift
            if abs(shift) <= self.context.eps * 4 * abs(tau):
                return tau
            if before is not None and abs(shift) >= before and abs(shift) < self.context.eps**0.75 * abs(tau):
                return tau
            before = abs(shift)
        return None

    # -- judging -----------------------------------------------------------------------------------------------------

    def look(self, theta: Number, order: int, tau: float, step: float) -> tuple[Arrival | None, BackwardState]:
        """Judge a step of a search in double precision that begins at tau; see `backward_flow.Search.run`."""
        steps = self._steps_of(step)
        back = (step - STEP) / 2 / self.K.rate
        state = self.state(theta, tau - back) if tau > back else steps.begin(0 * theta)
        found, taken, after = steps.over(theta, order, state)
        if found is None:
            return None, rounded(self.state(theta, state.tau + steps.H))
        return steps.arrival(after, taken, found), rounded(state)

    def state(self, theta: Number, tau: Number) -> BackwardState:
        """Return the flight as the state of a search."""
        now = self.instant(theta, tau)
        return BackwardState(tau, now.dx, now.v, now.a, now.v_error * self.K.rate, now.v_error, now.x_error)

    def _steps_of(self, step: float) -> BackwardSteps:
        if step not in self._steps:
            where, context = self.place, self.context
            self._steps[step] = BackwardSteps(self.K, where.boundary, where.domain, context, context.eps, step)
        return self._steps[step]

    def missing_digits(self, arrival: Arrival, wanted: int) -> int:
        """Return how many digits after the decimal point a polished arrival lacks."""
        if arrival.kind not in (CONTACT, REACHED):
            return 0
        t_error = arrival.v_error / abs(arrival.a) if arrival.kind == CONTACT else 0 * arrival.a
        x_error = arrival.x_error + abs(arrival.v) * t_error
        v_error = arrival.v_error if arrival.kind == REACHED else 0 * arrival.a
        worst = max(t_error, x_error, v_error)
        return int(self.context.ceil(self.context.log10(worst))) + wanted + 2 if worst > 0 else 0


def rounded(state: BackwardState) -> BackwardState:
    """Return a state in doubles, with the errors that rounding it adds."""
    eps = 2.0**-53
    tau, dx, v, a, energy_error, v_error, x_error = map(float, state)
    return BackwardState(tau, dx, v, a, energy_error + eps * abs(a), v_error + eps * abs(v), x_error + eps * abs(dx))
