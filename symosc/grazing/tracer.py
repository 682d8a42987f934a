"""Samples of a grazing curve: for a phase of the tangency, where its flow came from and how that moves.

Between a tangency and its start, tau earlier, a shift of theta_m along the contacts moves the start by

    d(Omega t_i)/d(theta_m) = -exp(c tau/m) E1(tau) G1/a_i
    d(x_i)/d(theta_m)       = (v_lambda d(Omega t_i)/d(theta_m) + exp(c tau/m) E0(tau) G1 m/k)/Omega

with G1 = G^(1) at the tangency and a_i the acceleration at the start: at a fixed time neighbouring contacts differ in x
only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, exp, inf, nan, sin

from symosc.grazing.backward_flow import CONTACT, MOST_BACKWARD_STEPS, NEVER, STEP, TOUCH, Arrival
from symosc.grazing.origin import Origins
from symosc.kernels.entire import basis
from symosc.model import Parameters

# The work of a curve, in steps of all its searches; when it is used up, each search has LEAST_STEPS left.
MOST_CURVE_STEPS, LEAST_STEPS = 40_000, 50
# Digits with which a contact that doubles leave open is looked at.
CURVE_DIGITS = 30
LARGEST_EXPONENT = 700.0
# At |k v_lambda| = |B0| Omega, G^(1) below this part of its terms is that of the tangency of fourth order.
QUARTIC = 1e-13

#: Where the flow of a sample came from.
OWN, OTHER, NOWHERE, UNKNOWN = "own belt", "other belt", "no belt", "not within the search"


@dataclass(frozen=True)
class Sample:
    """A tangency at theta_m and where its flow came from: `origin`, x, and Omega t = theta_m - Omega tau, unwrapped."""

    theta_m: float
    x_m: float
    origin: str
    x: float
    theta: float
    slope_x: float
    slope_theta: float
    is_open: bool = False  # a touch that was not looked at with more digits


class Tracer:
    """Samples the curve of one mapping, in double precision backed up by more digits."""

    def __init__(self, p: Parameters, mapping: str) -> None:
        self.origins = Origins(p, mapping)
        self.p, self.mapping, self.place, self.K = p, mapping, self.origins.place, self.origins.K
        self.v = float(p.belt(self.place.boundary))
        self.rest = float((p.A(self.place.domain) - p.c * p.belt(self.place.boundary)) / p.k)
        self.gain = float(p.B0 / p.k)
        self.steps_left = MOST_CURVE_STEPS

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.p, self.mapping)

    def _is_quartic(self, theta_m: float) -> bool:
        """Return whether a phase is that of the tangency of fourth order, to the digits of a double."""
        p, level = self.p, self.K.w0sq * self.v
        equal = abs(p.k * p.belt(self.place.boundary)) == abs(p.B0 * p.Omega)
        return equal and abs(level + self.K.fB * sin(theta_m)) <= QUARTIC * abs(level)

    @cached_property
    def _autonomous(self) -> Arrival:
        return self.origins.arrival(0.0)

    def sample(self, theta_m: float, careful: bool = True) -> Sample:
        """Return the sample at theta_m; without `careful` a contact may stay open, as a touch."""
        K = self.K
        steps = max(LEAST_STEPS, min(MOST_BACKWARD_STEPS, self.steps_left))
        if self.p.B0 == 0:  # every phase has the same flight
            arrival = self._autonomous
        else:
            order = 3 if self._is_quartic(theta_m) else 1
            arrival = self.origins.arrival(
                theta_m, order, careful=careful, digits=CURVE_DIGITS, looks=1, most_steps=steps
            )
        arrival = Arrival(arrival.kind, arrival.boundary, *map(float, arrival[2:]))
        self.steps_left -= int(arrival.tau * K.rate / STEP)
        x_m = self.rest + self.gain * cos(theta_m)
        if arrival.kind not in (CONTACT, TOUCH):
            return Sample(theta_m, x_m, NOWHERE if arrival.kind == NEVER else UNKNOWN, nan, nan, nan, nan)
        G1 = -(K.w0sq * self.v + K.fB * sin(theta_m))
        E0, E1, *_ = basis(arrival.tau, K)
        growth = exp(min(K.cm * arrival.tau, LARGEST_EXPONENT))
        slope_theta = -growth * E1 * G1 / arrival.a if arrival.a != 0.0 else inf
        if arrival.kind == TOUCH:  # neighbours that touch as well do it after the same time
            slope_theta = 1.0
        slope_x = (self.v * slope_theta + growth * E0 * G1 / K.w0sq) / K.Om
        origin = OWN if arrival.boundary == self.place.boundary else OTHER
        is_open = not careful and arrival.kind == TOUCH
        x, theta = x_m + arrival.dx, theta_m - K.Om * arrival.tau
        return Sample(theta_m, x_m, origin, x, theta, slope_x, slope_theta, is_open)
