"""Three independent ways to decide whether a contact at a phase grazes, for `symosc.grazing.check`.

- the signs of the G-functions: in double precision with a bound of the rounding error, or in 50-digit intervals, where
  a value whose interval contains 0 counts as 0 only if that is known exactly;
- the exact flow a short time before and after the contact: both points must be in the domain;
- scipy's DOP853, on the same equation in coordinates that start at the contact.

A way answers YES, NO or NOT_DECIDED, never on less than its error.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from symosc.aliases import Context, Number, Numbers
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.flow import Constants, constants
from symosc.grazing.window import GrazingWindow
from symosc.kernels._generated import motion
from symosc.kernels.entire import EPS

YES, NO, NOT_DECIDED = 1, -1, 0
# Rounding errors, in units of EPS and the size of the terms.
FLOW_ROUNDING = 16.0
INTERVAL_DIGITS = 50
# Digits of the exact flow at adversarial phases: a quartic tangency at the smallest time below needs 100 of them.
FLOW_DIGITS = 130
# Times before and after a contact, over the largest rate: in double precision, and two for the adversarial phases.
FLOW_TIME = 1e-9
FINE_FLOW_TIMES = ("1e-21", "1e-24")
# DOP853: times before and after the contact, over the largest rate; the second one where the first leaves it open.
DOP853_TIMES = (1e-2, 1e-13)
DECIDER_TOLERANCE = 1e-13
# What the scaled result of DOP853 may be wrong by (measured: 1e-15).
DOP853_ERROR = 1e-13


class Ways:
    """The three ways for one mapping; the contact is at x_m(theta), v_lambda, acceleration 0.

    Attributes
    ----------
    window : GrazingWindow
        Its parameters and its place are used, not its phases.
    size : float
        Sum of the sizes of the terms of G^(1); > 0.
    fine : MpArithmetic
        With FLOW_DIGITS digits.
    """

    def __init__(self, window: GrazingWindow) -> None:
        self.window, self.p, self.side = window, window.parameters, window.place.side
        self.K: Constants = constants(self.p)
        self.fine = MpArithmetic(self.p, FLOW_DIGITS)
        self.v, self.v_fine = float(window.speed), self.fine.number(window.speed)
        self.size = abs(self.K.w0sq * self.v) + abs(self.K.fB)
        context, basis = self.fine.context, self.fine.namespace["basis"]
        times = [sign * context.mpf(tau) / self.fine.K.rate for tau in FINE_FLOW_TIMES for sign in (-1, 1)]
        self._fine_bases = [basis(tau, self.fine.K)[:5] for tau in times]
        self._intervals = interval_context()

    # -- G-functions -------------------------------------------------------------------------------------------------

    def slope(self, theta: np.ndarray) -> np.ndarray:
        """Return -side G^(1) over `size`, positive for a graze."""
        return self.side * (self.K.w0sq * self.v + self.K.fB * np.sin(theta)) / self.size

    def fine_slope(self, theta: Number) -> float:
        """Return what `slope` returns, for an mpmath phase."""
        slope = self.fine.K.w0sq * self.v_fine + self.fine.K.fB * self.fine.context.sin(theta)
        return self.side * float(slope) / self.size

    def signs(self, theta: np.ndarray) -> np.ndarray:
        """Return verdicts of G^(1) in double precision."""
        slope = self.slope(theta)
        return np.where(np.abs(slope) > FLOW_ROUNDING * EPS, np.where(slope > 0, YES, NO), NOT_DECIDED)

    def fine_signs(self, theta: Number, zero: bool) -> tuple[int, int]:
        """Return the verdict of the first G-function that does not vanish, from 50-digit intervals, and its order.

        `zero` says that G^(1) is exactly 0 at theta. F = 0 at the contact, so G^(1) = -(k v + B0 Omega sin)/m. Where
        that is 0, G^(2) = -(B0 Omega/m) Omega cos decides. It is 0 too iff |k v| = |B0| Omega; then the next one
        decides.
        """
        iv, p = self._intervals, self.p

        def interval(q: Fraction) -> Any:
            return iv.mpf(q.numerator) / q.denominator

        angle = iv.mpf(bounds(theta, self.fine.context))
        s, c, Om, drive = iv.sin(angle), iv.cos(angle), interval(p.Omega), interval(p.B0 * p.Omega / p.m)
        values = [-(interval(p.k * self.window.speed / p.m) + drive * s), -drive * Om * c, drive * Om * Om * s]
        equal = abs(p.k * self.window.speed) == abs(p.B0) * p.Omega
        known_zero = [zero, zero and equal, False]
        for order, G in enumerate(values, start=1):
            if known_zero[order - 1]:
                if 0 not in G:  # the interval contradicts the zero
                    return NOT_DECIDED, order
                continue
            if 0 in G:
                return NOT_DECIDED, order
            inward = bool(-self.side * G.a > 0)
            return (YES if order % 2 == 1 and inward else NO), order
        return NOT_DECIDED, len(values)

    # -- the exact flow ----------------------------------------------------------------------------------------------

    def flow(self, theta: np.ndarray) -> np.ndarray:
        """Return verdicts of the exact flow FLOW_TIME before and after.

        They are NOT_DECIDED where the third order could decide.
        """
        tau = FLOW_TIME / self.K.rate
        basis, convert = self.fine.namespace["basis"], self.fine.context.convert
        bases = [[float(value) for value in basis(convert(at), self.fine.K)[:5]] for at in (-tau, tau)]
        gaps = [self._gap(each, np.sin(theta), np.cos(theta), self.v, self.K) for each in bases]
        return _verdicts(gaps, (FLOW_ROUNDING * EPS * self.size + self._third_order(tau)) * tau**2)

    def fine_flow(self, theta: Number) -> int:
        """Return the verdict of the exact flow with FLOW_DIGITS digits, if it is the same at both FINE_FLOW_TIMES."""
        context = self.fine.context
        s, c = context.sin(theta), context.cos(theta)
        gaps = [self._gap(basis, s, c, self.v_fine, self.fine.K) for basis in self._fine_bases]
        least = self.size * context.mpf(10) ** (20 - FLOW_DIGITS)
        if any(abs(gap) <= least * abs(basis[2]) for gap, basis in zip(gaps, self._fine_bases, strict=True)):
            return NOT_DECIDED
        verdicts = [YES if gaps[i] > 0 and gaps[i + 1] > 0 else NO for i in (0, 2)]
        return verdicts[0] if verdicts[0] == verdicts[1] else NOT_DECIDED

    def _gap(self, basis: Sequence[Numbers], s: Numbers, c: Numbers, v: Number, K: Constants) -> Any:
        """Return how far into the domain the velocity is, after the flight over which `basis` was taken."""
        _, dv, _ = motion(v, 0.0 * v, s, c, K.cm, K.w0sq, K.f0, K.Om, *basis)
        return -self.side * dv

    def _third_order(self, tau: float) -> float:
        """Return a bound of what terms of third order and above add to the gap, over tau^2 (tau * rate << 1)."""
        third = abs(self.K.fB) * self.K.Om + self.K.cm * self.size + self.K.w0sq * self.size * tau
        return third * tau / 3.0

    # -- DOP853 ------------------------------------------------------------------------------------------------------

    def solver(self, theta: np.ndarray) -> np.ndarray:
        """Return verdicts of DOP853, all phases in one system; NOT_DECIDED where the third order could decide."""
        verdicts = np.zeros(len(theta), dtype=int)
        for time_over_rate in DOP853_TIMES:
            left = np.nonzero(verdicts == NOT_DECIDED)[0]
            if len(left):
                tau = time_over_rate / self.K.rate
                gaps = [self.integrated(theta[left], sign * tau) for sign in (-1.0, 1.0)]
                verdicts[left] = _verdicts(gaps, DOP853_ERROR + self._third_order(tau) / self.size)
        return verdicts

    def integrated(self, theta: np.ndarray, tau: float) -> np.ndarray:
        """Return how far into the domain the velocity is at tau, over size tau^2, by DOP853.

        The unknowns are y = (x - x_m)/tau and u = (v - v_lambda)/(size tau^2), as functions of time/tau. The force is
        the difference from its value 0 at the contact, where a difference of cosines is written as a product.
        """
        from scipy.integrate import solve_ivp

        K, n = self.K, len(theta)

        def rhs(sigma: float, state: np.ndarray) -> np.ndarray:
            y, u = state[:n], state[n:] * (self.size * tau * tau)
            half = 0.5 * K.Om * tau * sigma
            force = -2.0 * K.f0 * np.sin(theta + half) * np.sin(half) - K.w0sq * tau * y - K.cm * u
            return np.concatenate([self.v + u, force / (self.size * tau)])

        accuracy = {"rtol": DECIDER_TOLERANCE, "atol": DECIDER_TOLERANCE, "max_step": 0.25}
        done = solve_ivp(rhs, (0.0, 1.0), np.zeros(2 * n), method="DOP853", **accuracy)
        return -self.side * done.y[n:, -1]


def _verdicts(gaps: list[np.ndarray], least: float) -> np.ndarray:
    """Return YES where both gaps are positive, NO where one is negative.

    It is NOT_DECIDED where one is within `least` of 0.
    """
    clear = (np.abs(gaps[0]) > least) & (np.abs(gaps[1]) > least)
    return np.where(clear, np.where((gaps[0] > 0) & (gaps[1] > 0), YES, NO), NOT_DECIDED)


def interval_context() -> Context:
    """Return an interval arithmetic of INTERVAL_DIGITS digits of its own."""
    from mpmath.ctx_iv import MPIntervalContext

    context = MPIntervalContext()
    context.dps = INTERVAL_DIGITS
    return context


def bounds(value: Number, context: Context) -> list[str]:
    """Return decimals just below and above a value, 5 digits finer than the intervals are."""
    shift = context.mpf(10) ** (-INTERVAL_DIGITS - 5) * max(1, abs(value))
    return [context.nstr(value + sign * shift, INTERVAL_DIGITS + 15) for sign in (-1, 1)]
