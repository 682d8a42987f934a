"""How a motion starts: an exact initial value problem, and its first state in any arithmetic."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, log10
from typing import Any

from symosc.engine.arithmetic import Arithmetic, MpArithmetic
from symosc.engine.switching import BELT, DOMAIN_ABOVE
from symosc.engine.touches import ROUNDING
from symosc.kernels._generated import acceleration
from symosc.model import PARAMETER_NAMES, Parameters

# A force on a belt at the start that is smaller than this part of its terms is looked at with more digits.
CLEAR_FORCE = 1e-9
# Digits beyond those of the numbers of a problem, for a force that is 0 or not.
SPARE_DIGITS = 40


@dataclass(frozen=True)
class Start:
    """An exact initial value problem: parameters, start and end as Fractions.

    Attributes
    ----------
    start_error : (3,) tuple of Fraction, optional
        Half-widths to which t0, x0 and v0 are known; None: they are exact.
    """

    parameters: Parameters
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    start_error: tuple[Fraction, Fraction, Fraction] | None = None

    def __post_init__(self) -> None:
        if self.start_error and max(self.start_error) == 0:
            object.__setattr__(self, "start_error", None)

    @property
    def spare_digits(self) -> int:
        """Digits after the decimal point that show the errors of the start, and that v0 is not quite a belt's speed."""
        p = self.parameters
        small = [abs(value) for value in (*(self.start_error or ()), self.v0 - p.v1, self.v0 - p.v2) if value != 0]
        return max(0, *(ceil(-log10(value)) for value in small))


@dataclass
class State:
    """The arguments of `symosc.engine.next_event.advance` between events, in its order."""

    mode: int
    at: int
    n: int
    theta: Any
    x: Any
    v: Any
    Fb: Any
    Fa: Any
    S11: Any
    S12: Any
    S22: Any
    t: Any
    t_low: Any

    def as_tuple(self) -> tuple[Any, ...]:
        """Return the entries in order."""
        return tuple(self.__dict__.values())


def first_state(start: Start, arithmetic: Arithmetic) -> State:
    """Return the state at t0, with periods counted from there.

    On a belt the forces decide where it goes (Theorems 4 and 5). Where one of them may be 0 that is decided with more
    digits than the numbers of the problem have together: at t0 = 0 the forces are rational, and so this is exact. A
    force that the error of the start can make 0 is 0.
    """
    p, K, number = start.parameters, arithmetic.K, arithmetic.number
    eps, cosine = arithmetic.namespace["EPS"], arithmetic.namespace["cos"]
    _, theta = arithmetic.phase(start.t0)
    x, v, c = number(start.x0), number(start.v0), cosine(theta)
    dt, dx, dv = (number(error) for error in start.start_error or (Fraction(0),) * 3)
    A = {1: K.A1, 2: K.A2, 3: K.A3}
    at = 1 if start.v0 == p.v1 else 2 if start.v0 == p.v2 else 0
    mode = 1 if start.v0 < p.v1 else 2 if start.v0 < p.v2 else 3
    forces = [acceleration(x, v, c, A[domain], K.cm, K.w0sq, K.f0) for domain in ((at, at + 1) if at else (mode, mode))]
    if at:
        reach = K.w0sq * (dx + abs(v) * dt) + K.cm * dv + abs(K.fB) * dt
        size = max(abs(A[at]), abs(A[at + 1])) + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * v)
        if min(abs(force) for force in forces) <= CLEAR_FORCE * size + reach:
            where, exact = _decided(start)
            forces = [arithmetic.rounded(force) for force in exact]
        else:
            where = DOMAIN_ABOVE if forces[1] > 0 else BELT if forces[0] > 0 else -DOMAIN_ABOVE
        mode = 3 + at if where == BELT else at + 1 if where == DOMAIN_ABOVE else at
        if where != BELT:
            forces = [forces[1] if where == DOMAIN_ABOVE else forces[0]] * 2
    rounding_x, rounding_v = eps * abs(x), eps * abs(v) * (0 if at else 1)
    # Half-widths, no standard errors: with the factor 3 no sum of the three is underestimated (Cauchy-Schwarz).
    S11 = rounding_x**2 + 3 * (dx**2 + (v * dt) ** 2)
    S22 = rounding_v**2 + 3 * (dv**2 + (forces[0] * dt) ** 2)
    S12 = 3 * v * forces[0] * dt**2
    return State(mode, at, 0, theta, x, v, forces[0], forces[1], S11, S12, S22, *arithmetic.time(start.t0))


def _decided(start: Start) -> tuple[int, list[Any]]:
    """Return where a start on a belt goes (as `symosc.engine.switching.resolve`), and both forces."""
    p = start.parameters
    numbers = [start.t0, start.x0, start.v0, *(getattr(p, name) for name in PARAMETER_NAMES)]
    digits = SPARE_DIGITS + sum(len(str(abs(q.numerator))) + len(str(q.denominator)) for q in numbers)
    arithmetic = MpArithmetic(p, digits)
    K, number, context = arithmetic.K, arithmetic.number, arithmetic.context
    dt, dx, dv = (number(error) for error in start.start_error or (Fraction(0),) * 3)
    _, theta = arithmetic.phase(start.t0)
    x, v, c, s = number(start.x0), number(start.v0), context.cos(theta), context.sin(theta)
    at, A = (1 if start.v0 == p.v1 else 2), (K.A1, K.A2, K.A3)
    forces = [acceleration(x, v, c, A[domain - 1], K.cm, K.w0sq, K.f0) for domain in (at, at + 1)]
    size = max(map(abs, A)) + abs(K.f0) + abs(K.w0sq * x) + abs(K.cm * v)
    allowed = ROUNDING * arithmetic.namespace["EPS"] * size
    allowed += K.w0sq * (dx + abs(v) * dt) + K.cm * dv + abs(K.fB) * dt
    forces = [0 * force if abs(force) <= allowed else force for force in forces]
    return arithmetic.namespace["resolve"](v, *forces, s, c, K), forces


def is_steady(start: Start) -> bool:
    """Return whether a start at t0 = 0 is on the steady motion of its domain: a decision in rational numbers."""
    p = start.parameters
    pull, drag = p.k - p.m * p.Omega**2, p.c * p.Omega
    size = pull * pull + drag * drag
    if start.t0 != 0 or size == 0 or start.start_error:
        return False
    x, v = p.B0 * pull / size, p.B0 * drag * p.Omega / size
    if p.k == 0:
        return p.c > 0 and any(start.v0 == v + p.A(domain) / p.c for domain in (1, 2, 3))
    return start.v0 == v and any(start.x0 == x + p.A(domain) / p.k for domain in (1, 2, 3))


def settles(start: Start) -> bool:
    """Return whether a start between the belts surely comes to rest without a contact: a decision in rational numbers.

    As `symosc.engine.rests.creeps_for_ever`, with u = g' + (h + w) g >= 0 told from the squares of its two parts.
    """
    p = start.parameters
    h = p.c / (2 * p.m)
    square = h * h - p.k / p.m
    domain = 1 + (start.v0 > p.v1) + (start.v0 > p.v2)
    if p.B0 != 0 or square < 0 or start.v0 in (p.v1, p.v2) or start.start_error:
        return False
    a = (p.A(domain) - p.k * start.x0 - p.c * start.v0) / p.m
    for boundary, side in ((domain - 1, 1), (domain, -1)):
        if boundary in (1, 2):
            v = p.belt(boundary)
            gap = side * (start.v0 - v)
            part = side * a + h * gap
            if side * p.k * v > 0 or (part < 0 and part * part > square * gap * gap):
                return False
    return True


def rounded(state: State) -> State:
    """Return a state in double precision, with the rounding as a part of its error."""
    theta, x, v, Fb, Fa, t = (float(value) for value in (state.theta, state.x, state.v, state.Fb, state.Fa, state.t))
    eps, t_low = 2.0**-53, float(state.t - t + state.t_low)
    v_error = 0.0 if state.at else eps * v
    S11, S12, S22 = (float(value) for value in (state.S11, state.S12, state.S22))
    S11, S22 = S11 + (eps * x) ** 2, S22 + v_error**2
    return State(state.mode, state.at, state.n, theta, x, v, Fb, Fa, S11, S12, S22, t, t_low)
