"""python-flint's balls for the boxes of an atlas: the oscillator, and signs along a motion.

The working precision of arb is global to the process. `ctx.workprec` sets and restores it; nothing
here may run in threads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any, NamedTuple, TypeAlias

from symosc.base.errors import MissingExtraError
from symosc.friction import NEIGHBOURS
from symosc.model import Parameters, by_name

try:
    from flint import __version__ as FLINT_VERSION
    from flint import acb_series, arb, arb_mat, arb_series, fmpq
except ImportError:
    raise MissingExtraError("certify", "certify") from None

# Before this version the negative of a ball was wrong.
FIRST_SOUND_VERSION = (0, 9)
if tuple(int(part) for part in FLINT_VERSION.split(".")[:2]) < FIRST_SOUND_VERSION:
    raise MissingExtraError(
        f"certify with python-flint {FLINT_VERSION}, which has unsound balls,", "certify"
    )

#: A ball: an enclosure of a real number.
Ball: TypeAlias = Any
Values: TypeAlias = list[Ball]
#: A family counts as critically damped unless its frequency is at least so many times its error.
ROUGH = 32
#: First step, as a part of the flight; shortest step; by how much a step grows after one that was
#: enough; how many there may be.
FIRST_COURSE_STEP = 1 / 8
SHORTEST_COURSE_STEP = 2.0**-60
COURSE_GROWTH = 1.5
MOST_COURSE_STEPS = 4000


class Undecided(Exception):
    """Raised if balls cannot decide a sign."""


def ball(number: Fraction | int) -> Ball:
    """Return an enclosure of a rational number."""
    return arb(fmpq(number.numerator, number.denominator))


def sure_sign(value: Ball) -> int:
    """Return the sign of all numbers in a ball, 0 if they differ in sign."""
    if value > 0:
        return 1
    if value < 0:
        return -1
    return 0


def coefficient(value: Ball, order: int = 0) -> Ball:
    """Return the coefficient of a given `order` in a power series.

    A ball counts as a constant series.
    """
    if isinstance(value, arb_series):
        return value[order]
    if order:
        return arb(0)
    return value


def entire_0f1(b: Ball, z: Ball) -> Ball:
    """Return the hypergeometric function 0F1(b; z) of a real or complex ball or power series z."""
    # 0F1(1/2; w^2/4) is cosh w, and 0F1(3/2; w^2/4) is sinh w/w, where w^2 may have any sign. The
    # derivative is 0F1(b + 1; z)/b, which gives the Taylor series.
    if not isinstance(z, arb_series | acb_series):
        return z.hypgeom_0f1(b)
    kind: Any = type(z)
    change = kind([0, *list(z)[1:]], prec=z.prec)
    total = kind([0], prec=z.prec)
    factor = kind([1], prec=z.prec)  # change^j / (b (b + 1) ... (b + j - 1) j!)
    for j in range(z.prec):
        total = total + factor * z[0].hypgeom_0f1(b + j)
        factor = factor * change / ((b + j) * (j + 1))
    return total


class OscillatorInBalls:
    """The constants of an oscillator as balls or, for a family, as wide balls or power series."""

    # `ranges` replaces parameters of `p`. The first coefficient of a power series in a change of one
    # parameter (arb_series) may be a ball.

    def __init__(self, p: Parameters, ranges: Mapping[str, Ball] | None = None) -> None:
        b = by_name(p, ball) | dict(ranges or {})
        self.p = p
        self.B0 = b["B0"]
        self.c = b["c"]
        self.k = b["k"]
        self.m = b["m"]
        self.Omega = b["Omega"]
        self.h = self.c / (2 * self.m)
        self.cm = self.c / self.m
        self.km = self.k / self.m
        self.drive = self.B0 * self.Omega / self.m
        #: (c/2m)^2 - k/m, its sign (0 if undecided), and the root of its size: the damped frequency
        #: or its twin.
        self.kappa = self.h * self.h - self.km
        self.damping = sure_sign(coefficient(self.kappa))
        # Exactly, where none of them varies.
        if not {"m", "c", "k"} & (ranges or {}).keys():
            exact = p.c * p.c / (4 * p.m * p.m) - p.k / p.m
            self.damping = (exact > 0) - (exact < 0)
            self.kappa = ball(exact)
        self.omega_d = (self.kappa if self.damping >= 0 else -self.kappa).sqrt()
        frequency = coefficient(self.omega_d)
        if not frequency > ROUGH * frequency.rad():  # it is critical, or nearly so in the family
            self.damping = 0
        if self.damping > 0:
            self.fast = -(self.h + self.omega_d)
            self.slow = self.km / self.fast
        friction = {1: b["mu1"] + b["mu2"], 2: b["mu2"] - b["mu1"], 3: -b["mu1"] - b["mu2"]}
        self.A = {domain: b["A0"] + mu * b["FN"] for domain, mu in friction.items()}
        self.speed = {1: b["v1"], 2: b["v2"]}
        #: The jump of the acceleration at each belt, F^(below) - F^(above).
        self.jump = {boundary: 2 * b[f"mu{boundary}"] * b["FN"] / self.m for boundary in (1, 2)}

    def entire(self, tau: Ball) -> tuple[Ball, Ball, Ball]:
        """Return E, E' and phi = E' + (c/m) E at the time `tau`: E is the free motion with E(0) = 0
        and E'(0) = 1.
        """
        if self.damping > 0:
            fast = (self.fast * tau).exp()
            slow = (self.slow * tau).exp()
            width = 2 * self.omega_d
            E = (slow - fast) / width
            E1 = (self.slow * slow - self.fast * fast) / width
        else:
            decay = (-self.h * tau).exp()
            if self.damping == 0:
                z = self.kappa * tau * tau / 4
                E = decay * tau * entire_0f1(arb(1.5), z)
                E1 = decay * entire_0f1(arb(0.5), z) - self.h * E
            else:
                s, c = (self.omega_d * tau).sin_cos()
                E = decay * s / self.omega_d
                E1 = decay * c - self.h * E
        return E, E1, E1 + self.cm * E


class Jet(NamedTuple):
    """The value g of a function at a time tau after a start, with its first two derivatives dg and
    ddg.
    """

    tau: Ball
    g: Ball
    dg: Ball
    ddg: Ball


Curve = Callable[[Ball], Jet]


class SignedGap(NamedTuple):
    """A function of the time since a flight's start that must be > 0 during the flight."""

    what: str
    curve: Curve
    at_start: int = 0  # 1 if g, 2 if g and g' are known to be 0 where the flight starts
    at_end: bool = False  # whether g is known to be 0 where it ends


def prove_positive(margin: SignedGap, span: Ball) -> None:
    """Prove that a margin is > 0 from time 0 to any time in the ball `span`, or raise Undecided."""
    # As g > 0 at the start of a step (or 0 at that of the flight), one of these is enough: g > 0 or
    # g' > 0 all the way; g'' > 0 on the first step after a stick; g' < 0 on the last step, if g = 0
    # at its end.
    last = span.upper().mid()
    begin = arb(0)
    zeros = margin.at_start
    if zeros == 0 and not margin.curve(begin).g > 0:
        raise Undecided(f"{margin.what} at its start")
    step = (last * FIRST_COURSE_STEP).mid()
    for _ in range(MOST_COURSE_STEPS):
        end = (begin + step).mid()
        is_last = bool(end >= last)
        times = begin.union(last if is_last else end)
        whole = margin.curve(times)
        middle = margin.curve(times.mid())
        # g and g' by Taylor's theorem about the middle.
        off = times - times.mid()
        slope = middle.dg + whole.ddg * off
        if is_last and margin.at_end:
            sure = not zeros and slope < 0
        else:
            g = middle.g + middle.dg * off + whole.ddg * (off * off).nonnegative_part() / 2
            sure = g > 0 or whole.g > 0 or slope > 0 or (zeros == 2 and whole.ddg > 0)
        if sure and is_last:
            return
        if sure:
            begin = end
            zeros = 0
            step = (step * COURSE_GROWTH).mid()
        else:
            step = (((last if is_last else end) - begin) / 2).mid()
            if step <= last * SHORTEST_COURSE_STEP:
                break
    raise Undecided(margin.what)


def belts_around(domain: int) -> list[int]:
    """Return the belts that border a domain."""
    return [boundary for boundary in (1, 2) if domain in NEIGHBOURS[boundary]]


def unit_matrix(count: int) -> arb_mat:
    """Return the unit matrix with `count` rows and columns."""
    return arb_mat([[int(i == j) for j in range(count)] for i in range(count)])


def column(values: Sequence[Ball]) -> arb_mat:
    """Return a vector as a matrix with one column."""
    return arb_mat([[value] for value in values])
