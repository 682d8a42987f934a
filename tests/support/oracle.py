"""An independent oracle.

The double-belt oscillator integrated from its ODE alone, to as many digits as asked.

Nothing here knows the closed-form flow or where Theorem 7 puts the zeros of the acceleration.

- `simulate_oracle` steps the ODE with its power series. The recurrences come from x' = v, v' = (A +
  B0 C - k x - c v)/m, C' = -Omega S, S' = Omega C, and run in fixed-point Python integers. On each
  step all roots of v - v_lambda are isolated: a derivative of the series whose first term outweighs
  the sum of the rest keeps its sign, so the derivative before it is monotone, and so on down to the
  series itself; a step on which no derivative qualifies is halved.
- `flow_oracle` moves within one domain by the matrix exponential of the 5x5 linear system (x, v,
  cos, sin, 1).

Contacts are resolved by Theorems 4 to 6, a vanishing F by the first G-function that does not
vanish. Numbers within 10**(5 - dps) of zero, measured in the scale of the forces, count as zero; so
does a peak that close to a belt.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, lgamma, log, log2, sqrt
from typing import Any, NamedTuple

import mpmath

GUARD_BITS = 80
MAX_DERIVATIVE = 6  # derivatives that are tried for a constant sign before a step is halved
MAX_ORDER = 12  # G-functions that are tried before a contact is called an equilibrium on the belt
STIFF = 300  # ratio of rates above which a step may span many times the fastest one


class OracleEvent(NamedTuple):
    """One event with its time, position and velocity as mpf."""

    t: Any
    kind: str
    boundary: int
    source: str
    target: str
    x: Any
    v: Any


@dataclass
class OracleRun:
    """Events up to t_end and the state there."""

    events: list[OracleEvent] = field(default_factory=list)
    mode: str = ""
    t: Any = None
    x: Any = None
    v: Any = None


def exact(value: Any) -> Fraction:
    """Read a number as tests write them: floats as the decimal they print as."""
    if isinstance(value, Fraction):
        return value
    return Fraction(str(value))


def flow_oracle(
    p: Any, alpha: int, t0: Any, x0: Any, v0: Any, tau: Any, dps: int = 50
) -> tuple[Any, Any, Any]:
    """Return x, v and the acceleration at t0 + tau in domain `alpha`, by the exponential of the 5x5 system."""
    t0, x0, v0, tau = map(exact, (t0, x0, v0, tau))
    rate = float(p.c / p.m + p.k / p.m + p.Omega + 1)
    # The series of exp is summed at norm <= 1; squaring back loses a bit per squaring, growing
    # modes more.
    squarings = max(0, ceil(log2(max(1e-300, rate * abs(float(tau)))))) + 4
    backwards = 0.5 * max(0.0, -float(p.c / p.m * tau))
    start_digits = len(str(int(abs(p.Omega * t0)))) + len(
        str(int(abs(x0) + abs(v0) + abs(p.A(alpha) / p.m)))
    )
    with mpmath.workdps(dps + 30 + squarings + start_digits + int(backwards)):
        matrix = _system(p, alpha)
        theta = _mpf(p.Omega * t0)
        state = mpmath.matrix(
            [_mpf(x0), _mpf(v0), mpmath.cos(theta), mpmath.sin(theta), mpmath.mpf(1)]
        )
        step = matrix * (_mpf(tau) / 2**squarings)
        total = mpmath.eye(5)
        term = mpmath.eye(5)
        n = 0
        while mpmath.mnorm(term, 1) > mpmath.eps * mpmath.eps:
            n += 1
            term = term * step / n
            total += term
        for _ in range(squarings):
            total = total * total
        x, v, cosine = (total * state)[:3]
        acceleration = matrix[1, 0] * x + matrix[1, 1] * v + matrix[1, 2] * cosine + matrix[1, 4]
        return x, v, acceleration


def _system(p: Any, alpha: int) -> Any:
    matrix = mpmath.zeros(5)
    matrix[0, 1] = 1
    matrix[1, 0], matrix[1, 1] = _mpf(-p.k / p.m), _mpf(-p.c / p.m)
    matrix[1, 2], matrix[1, 4] = _mpf(p.B0 / p.m), _mpf(p.A(alpha) / p.m)
    matrix[2, 3], matrix[3, 2] = _mpf(-p.Omega), _mpf(p.Omega)
    return matrix


def _mpf(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


def simulate_oracle(
    p: Any, t0: Any, x0: Any, v0: Any, t_end: Any, dps: int = 50, max_events: int = 10_000
) -> OracleRun:
    """Return the trajectory of `p` (anything with the fields of Parameters, as Fractions) from t0 to t_end."""
    return _Integrator(p, dps).run(exact(t0), exact(x0), exact(v0), exact(t_end), max_events)


class _Integrator:
    """The fixed-point state (t, x, v, cos, sin) and what moves it.

    Integers stand for value * 2**bits.
    """

    def __init__(self, p: Any, dps: int) -> None:
        self.p, self.dps = p, dps
        self.cm, self.w0sq, self.f0, self.Om = p.c / p.m, p.k / p.m, p.B0 / p.m, p.Omega
        self.A = {alpha: p.A(alpha) / p.m for alpha in (1, 2, 3)}
        self.belts = {1: p.v1, 2: p.v2}
        fast = float(self.cm) + sqrt(self.w0sq) + float(self.Om)
        slow = float(self.Om) + min(
            sqrt(self.w0sq), float(self.w0sq / self.cm) if self.cm else 1e300
        )
        if fast > STIFF * slow:
            reach = 32.0
        else:
            reach = 1.0
        self.shift = max(0, ceil(log2(fast / reach)))  # a step is 2**-shift
        reach = fast / 2.0**self.shift
        scale = (
            1
            + abs(self.f0)
            + max(map(abs, self.A.values()))
            + max(self.cm, 1) * max(map(abs, self.belts.values()))
        )
        self.bits = int(dps * 3.33) + GUARD_BITS + int(1.5 * reach) + 2 * int(scale).bit_length()
        self.order = 8
        while self.order * log(reach) - lgamma(self.order + 1) > -self.bits * log(2):
            self.order += 1
        self.one = 1 << self.bits
        self.tolerance = max(1, int(self.one * scale / 10 ** (dps - 5)))
        step = Fraction(1, 1 << self.shift)
        self.h_cm, self.h_w0sq, self.h_f0, self.h_Om = (
            self.fixed(value * step) for value in (self.cm, self.w0sq, self.f0, self.Om)
        )
        self.h_A = {alpha: self.fixed(value * step) for alpha, value in self.A.items()}
        self.f_cm, self.f_w0sq, self.f_f0, self.f_Om = map(
            self.fixed, (self.cm, self.w0sq, self.f0, self.Om)
        )
        self.f_A = {alpha: self.fixed(value) for alpha, value in self.A.items()}
        self.v_belt = {boundary: self.fixed(value) for boundary, value in self.belts.items()}

    def fixed(self, value: Fraction) -> int:
        return round(value * self.one)

    def number(self, value: int) -> Any:
        with mpmath.workdps(self.dps + 30):
            return mpmath.ldexp(mpmath.mpf(value), -self.bits)

    # -- the trajectory ------------------------------------------------------------------------------------------

    def run(
        self, t0: Fraction, x0: Fraction, v0: Fraction, t_end: Fraction, max_events: int
    ) -> OracleRun:
        self.t, self.x, self.v = self.fixed(t0), self.fixed(x0), self.fixed(v0)
        with mpmath.workprec(self.bits + int(abs(self.Om * t0)).bit_length() + 20):
            theta = _mpf(self.Om * t0)
            self.C, self.S = (
                int(mpmath.nint(mpmath.ldexp(f(theta), self.bits)))
                for f in (mpmath.cos, mpmath.sin)
            )
        end = self.fixed(t_end)
        result = OracleRun()
        # `contact` is the boundary that the mass is on and leaves, or 0
        self.contact = next((b for b, speed in self.belts.items() if v0 == speed), 0)
        domain = 1 + (v0 > self.belts[1]) + (v0 > self.belts[2])
        if self.contact:
            mode = self.resolve(self.contact)
        else:
            mode = f"Omega{domain}"
        while self.t < end and len(result.events) < max_events:
            source = mode
            if mode.startswith("belt"):
                stepped = self.slide(int(mode[-1]), end)
            else:
                stepped = self.fly(int(mode[-1]), end)
            if stepped is None:
                continue
            kind, boundary = stepped
            self.contact = boundary
            if kind != "graze":
                mode = self.resolve(boundary)
                if source.startswith("belt"):
                    kind = "slip"
                elif mode.startswith("belt"):
                    kind = "stick"
                else:
                    kind = "cross"
                if mode == source:  # a touch of a belt, or of F = 0 while sticking
                    kind = "graze"
            if kind == "graze" and source.startswith("belt"):
                continue
            t = self.number(self.t)
            x = self.number(self.x)
            v = self.number(self.v_belt[boundary])
            result.events.append(OracleEvent(t, kind, boundary, source, mode, x, v))
        result.mode, result.t, result.x, result.v = (
            mode,
            self.number(self.t),
            self.number(self.x),
            self.number(self.v),
        )
        return result

    def derivatives(self, alpha: int) -> list[int]:
        """Return F^(alpha) and its G-functions at the present state, set to 0 where they vanish."""
        b = self.bits
        drive = [self.f_f0 * self.C >> b, -(self.f_f0 * self.S >> b)]  # f0 cos, f0 cos'/Omega, ...
        values = [
            self.v,
            self.f_A[alpha] + drive[0] - (self.f_w0sq * self.x + self.f_cm * self.v >> b),
        ]
        size = self.tolerance
        power = self.one
        if abs(values[1]) <= size:
            values[1] = 0
        rate = max(1, int(self.cm + self.Om + 1))
        for n in range(1, MAX_ORDER):
            power = power * self.f_Om >> b
            size *= rate
            forcing = drive[n % 2] * (1 if n % 4 < 2 else -1) * power >> b
            value = forcing - (self.f_cm * values[n] + self.f_w0sq * values[n - 1] >> b)
            values.append(0 if abs(value) <= size else value)
        return values[1:]

    def effective(self, alpha: int) -> int:
        return next((1 if value > 0 else -1 for value in self.derivatives(alpha) if value), 0)

    def resolve(self, boundary: int) -> str:
        """Return the mode in which the flow goes on from the boundary (Theorems 4 to 6)."""
        self.v = self.v_belt[boundary]
        low = self.effective(boundary)
        high = self.effective(boundary + 1)
        if low > 0 and high > 0:
            return f"Omega{boundary + 1}"
        if low < 0 and high < 0:
            return f"Omega{boundary}"
        return f"belt{boundary}"

    # -- one step --------------------------------------------------------------------------------------------------

    def fly(self, alpha: int, end: int) -> tuple[str, int] | None:
        """Move one step in domain `alpha`, or to its first contact, which is returned as (kind, boundary)."""
        b = self.bits
        xs = [self.x]
        vs = [self.v]
        Cs = [self.C]
        Ss = [self.S]
        constant = self.h_A[alpha]
        for n in range(self.order):
            C = Cs[n]
            S = Ss[n]
            force = (self.h_f0 * C - self.h_w0sq * xs[n] - self.h_cm * vs[n] >> b) + constant
            xs.append((vs[n] >> self.shift) // (n + 1))
            vs.append(force // (n + 1))
            Cs.append(-(self.h_Om * S >> b) // (n + 1))
            Ss.append((self.h_Om * C >> b) // (n + 1))
            constant = 0
        best: tuple[int, str, int] | None = None
        for boundary in (1, 2):
            if boundary not in (alpha - 1, alpha):
                continue
            gap = [vs[0] - self.v_belt[boundary], *vs[1:]]
            if boundary == self.contact:  # divide the root at the start out
                order = next((i for i, value in enumerate(self.derivatives(alpha)) if value), None)
                if order is None:  # at rest there, for ever
                    continue
                gap = gap[order + 1 :]
            root = first_root(gap, b, self.tolerance)
            if root is not None and (best is None or root[0] < best[0]):
                best = (*root, boundary)
        return self.move(xs, vs, Cs, Ss, best, end)

    def slide(self, boundary: int, end: int) -> tuple[str, int] | None:
        """Stick for one step, or to the first zero of F below or above the belt."""
        b = self.bits
        xs = [self.x, self.v_belt[boundary] >> self.shift]
        Cs = [self.C]
        Ss = [self.S]
        for n in range(self.order):
            Cs.append(-(self.h_Om * Ss[n] >> b) // (n + 1))
            Ss.append((self.h_Om * Cs[n] >> b) // (n + 1))
        best: tuple[int, str, int] | None = None
        for alpha in (boundary, boundary + 1):
            force = [self.f_f0 * C >> b for C in Cs]
            force[0] += self.f_A[alpha] - (
                self.f_cm * self.v_belt[boundary] + self.f_w0sq * self.x >> b
            )
            force[1] -= self.f_w0sq * xs[1] >> b
            if self.contact:
                # F may start at 0 and turn into the stick; the first derivative along the belt says
                # so
                while force and abs(force[0]) <= self.tolerance:
                    force.pop(0)
            if force:
                root = first_root(force, b, self.tolerance)
            else:
                root = None
            if root is not None and (best is None or root[0] < best[0]):
                best = (*root, boundary)
        return self.move(xs, [self.v_belt[boundary], 0], Cs, Ss, best, end)

    def move(
        self, xs: Any, vs: Any, Cs: Any, Ss: Any, best: Any, end: int
    ) -> tuple[str, int] | None:
        """Advance the state to the event `best`, to the end of the step or to `end`, whichever is first."""
        if best:
            s = best[0]
        else:
            s = self.one
        last = end - self.t << self.shift
        if best and s <= last:
            found = best[1:]
        else:
            found = None
        s = min(s, last)
        self.x, self.v, self.C, self.S = (
            horner(series, s, self.bits) for series in (xs, vs, Cs, Ss)
        )
        self.t += s >> self.shift
        if s == last:
            self.t = end
        self.contact = 0
        return found


# -- roots of a series on [0, 1] -------------------------------------------------------------------------------------


def horner(series: list[int], s: int, bits: int) -> int:
    total = 0
    for coefficient in reversed(series):
        total = (total * s >> bits) + coefficient
    return total


def differentiate(series: list[int]) -> list[int]:
    return [n * coefficient for n, coefficient in enumerate(series)][1:]


def first_root(
    series: list[int], bits: int, tolerance: int, depth: int = 0
) -> tuple[int, str] | None:
    """Return (s, kind) of the first root of the series on (0, 1], or None. A touch within `tolerance` is a "graze"."""
    one = 1 << bits
    derivatives = [series]
    while True:
        top = derivatives[-1]
        if abs(top[0]) > sum(map(abs, top[1:])) or not any(top):
            break
        if len(derivatives) > MAX_DERIVATIVE:
            return _halve(series, bits, tolerance, depth)
        derivatives.append(differentiate(top))
    if len(derivatives) == 1:
        return None
    cuts: list[int] = []
    for lower in reversed(
        derivatives[1:-1]
    ):  # each is monotone between the zeros of the one after it
        cuts = [s for s, _ in _monotone_roots(lower, cuts, bits, -1)]
    roots = _monotone_roots(series, cuts, bits, tolerance)
    return next(
        ((_multiple(series, s, bits, tolerance), kind) for s, kind in roots if 0 < s <= one), None
    )


def _monotone_roots(
    series: list[int], cuts: list[int], bits: int, tolerance: int
) -> list[tuple[int, str]]:
    points = [0, *cuts, 1 << bits]
    values = [horner(series, s, bits) for s in points]
    slope = differentiate(series)
    roots = []
    # the last point with a sure sign, and the touches since then
    before = 0
    touches = []
    for i in range(1, len(points)):
        if i < len(points) - 1 and abs(values[i]) <= tolerance:
            touches.append(i)
            continue
        changes = (values[before] > 0) != (values[i] > 0)
        if touches:
            nearest = min(touches, key=lambda touch: abs(values[touch]))
            roots.append((points[nearest], "contact" if changes else "graze"))
        elif changes:
            roots.append(
                (
                    _polish(series, slope, points[before], points[i], values[before] > 0, bits),
                    "contact",
                )
            )
        before = i
        touches = []
    return roots


def _polish(
    series: list[int], slope: list[int], low: int, high: int, starts_positive: bool, bits: int
) -> int:
    """Newton's method kept inside a bracket, to the last bit."""
    s = (low + high) >> 1
    for _ in range(4 * bits):
        value = horner(series, s, bits)
        if (value > 0) == starts_positive:
            low = s
        else:
            high = s
        derivative = horner(slope, s, bits)
        if derivative:
            following = s - (value << bits) // derivative
        else:
            following = low
        if not low < following < high:
            following = (low + high) >> 1
        if abs(following - s) <= 1 or high - low <= 1:
            return following
        s = following
    return s


def _multiple(series: list[int], s: int, bits: int, tolerance: int) -> int:
    """Return where the multiple root at `s` is exactly.

    At the simple root of the highest derivative that allows it.

    A root of multiplicity k is known to a k-th of the digits from the series, to all of them from
    derivative k - 1.
    """
    lower = [series]
    best = s
    while len(lower) <= 4 and abs(horner(differentiate(lower[-1]), best, bits)) < 1 << (
        bits - bits // 8
    ):
        top = differentiate(lower[-1])
        place = best
        for _ in range(8):
            slope = horner(differentiate(top), place, bits)
            if slope:
                place -= (horner(top, place, bits) << bits) // slope
            else:
                place -= 0
        # each derivative weighs the rounding of the coefficients by their index
        if all(abs(horner(row, place, bits)) <= tolerance << 5 * n for n, row in enumerate(lower)):
            best = place
        lower.append(top)
    return best


def _halve(series: list[int], bits: int, tolerance: int, depth: int) -> tuple[int, str] | None:
    if depth > bits:
        raise ArithmeticError(
            "the roots of a step cannot be isolated: ask the oracle for more digits"
        )
    left = [coefficient >> n for n, coefficient in enumerate(series)]
    found = first_root(left, bits, tolerance, depth + 1)
    if found is not None:
        return found[0] >> 1, found[1]
    right = left[:]
    for i in range(len(right) - 1):  # the series about the midpoint
        for j in range(len(right) - 2, i - 1, -1):
            right[j] += right[j + 1]
    found = first_root(right, bits, tolerance, depth + 1)
    if found is None:
        return None
    return ((found[0] + (1 << bits)) >> 1, found[1])
