"""The oscillator with Coulomb friction: cases with published closed forms, and the continuum of Csernak.

With A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no velocity reaches, the model is m x'' + c x' + k x =
P cos(Omega t) - F sgn(x'). Here m = k = FN = 1. The closed forms are kept as text; a test evaluates them and compares.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import pi
from typing import Any

from symosc.aliases import NumberLike
from symosc.engine.arithmetic import mp_context
from symosc.exact import show
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.reference.case import ReferenceCase
from symosc.scenes import Scene

COULOMB, CONTINUUM = "Coulomb oscillator", "continuum"
DEN_HARTOG = "Den Hartog, Phil. Mag. 9 (1930) and Trans. ASME 53 (1931)"
BORDER_SOURCE = "Den Hartog (1931); Hong and Liu, J. Sound Vib. 229 (2000)"
CSERNAK = "Csernak, Stepan and Shaw, Nonlinear Dynamics 50 (2007), doi:10.1007/s11071-006-9145-6"
BALANCE = "the energy of a free or resonant oscillator with constant friction, half a cycle at a time"
AT_A_TURN = (
    "contacts are exactly where the drift of the belt turns, between two pieces of the proof; see the closed form"
)
FAR_BELT = 10**6
#: Digits of a start on an orbit whose amplitude is not rational.
ORBIT_DIGITS = 60


def wall(F: NumberLike, Omega: NumberLike, c: NumberLike = 0, P: NumberLike = 1) -> Parameters:
    """Return the parameters of a mass on a spring that rubs on a wall.

    Examples
    --------
    >>> wall("0.4", "1.5").mu1
    Fraction(2, 5)
    """
    return Parameters(m=1, c=c, k=1, A0=0, B0=P, Omega=Omega, v1=0, v2=FAR_BELT, mu1=F, mu2=0, FN=1)


def coulomb() -> Iterator[ReferenceCase]:
    """Yield the cases with closed forms."""
    yield from _slides()
    yield from _borders()
    yield from _resonance()
    yield from _decay()


def _case(name: str, p: Parameters, start: tuple[Any, Any, Any], t_end: Any, *said: Any, group: str = COULOMB) -> Any:
    hard, source, closed = said
    reason = AT_A_TURN if group == CONTINUUM else ""
    return ReferenceCase(name, group, Scene(name, p, *start, t_end), hard, source, tuple(closed), reason)


def _slides() -> Iterator[ReferenceCase]:
    """Yield motions without stops from their highest point: the amplitude is Den Hartog's."""
    for number, (c, F, Omega) in enumerate((("0", "0.4", "1.5"), ("0.2", "0.4", "1.5"), ("0.1", "0.25", "0.6")), 1):
        p = wall(F, Omega, c)
        orbit = find_orbit(p, "P32", guess=find_orbit(p, "P32"), digits=ORBIT_DIGITS)
        context = mp_context(ORBIT_DIGITS)
        t0, x0 = (Fraction(context.nstr(value, ORBIT_DIGITS)) for value in orbit.points[0][:2])
        cycles, period = 4, 2 * pi / float(p.Omega)
        closed = [f"x[{i}] = {'-' if i % 2 == 0 else ''}({amplitude(c, F, Omega)})" for i in range(2 * cycles)]
        t_end = Fraction(f"{float(t0) + (cycles + 0.25) * period:.6g}")
        hard = "a start and events at velocity 0, on the belt at rest; the motion passes it and does not stop"
        yield _case(f"den-hartog-{number}", p, (t0, x0, 0), t_end, hard, DEN_HARTOG, closed)


def amplitude(c: str, F: str, Omega: str) -> str:
    """Return Den Hartog's amplitude for m = k = P = FN = 1 as an expression.

    Examples
    --------
    >>> amplitude("0", "0.4", "1.5")[:40]
    'sqrt((1/(1 - (1.5)**2))**2 - (0.4)**2*(t'
    """
    if Fraction(c) == 0:
        return f"sqrt((1/(1 - ({Omega})**2))**2 - ({F})**2*(tan(pi/(2*({Omega})))/({Omega}))**2)"
    zeta = f"(({c})/2)"
    root, g = f"sqrt(1 - {zeta}**2)", f"(pi*{zeta}/({Omega}))"
    s = f"(pi*{root}/({Omega}))"
    below = f"(cosh({g}) + cos({s}))"
    G = f"((sinh({g}) - {zeta}/{root}*sin({s}))/{below})"
    H = f"(sin({s})/(({Omega})*{root}*{below}))"
    Q = f"(1/((1 - ({Omega})**2)**2 + 4*{zeta}**2*({Omega})**2))"
    return f"-({F})*{G} + sqrt({Q} - ({F})**2*{H}**2)"


def _borders() -> Iterator[ReferenceCase]:
    """Yield motions on both sides of the border of those without stops, F*/P = 0.64657909 and 0.81740639."""
    for Omega, below, above in (("1.5", "0.64", "0.65"), ("0.8", "0.81", "0.82")):
        for side, F in (("below", below), ("above", above)):
            hard = (
                f"friction just {side} the border of motions without stops, r = {Omega}: stops are short or not there"
            )
            yield _case(
                f"border-{Omega}-{side}".replace(".", "-"), wall(F, Omega), (0, 1, 0), 150, hard, BORDER_SOURCE, ()
            )


def _resonance() -> Iterator[ReferenceCase]:
    """Yield motions at Omega = omega_0, c = 0, whose turning points are at pi/2 + i pi and grow."""
    for number, F in enumerate(("0.1", "0.4", "0.75"), 1):
        p = wall(F, 1)
        closed = [f"t[{i}] = pi/2 + {i}*pi" for i in range(12)]
        closed += [f"x[{i}] = {'-' if i % 2 else ''}(5 + pi/4 - {F} + {i}*(pi/2 - 2*{F}))" for i in range(12)]
        start = (0, Fraction(1, 2) - Fraction(F), 5)
        hard = "undamped resonance: the amplitude grows for ever"
        yield _case(f"resonance-growth-{number}", p, start, 40, hard, BALANCE, closed)


def _decay() -> Iterator[ReferenceCase]:
    """Yield motions without a drive that lose 2 F/k per half cycle and stop at the first turning point within F/k."""
    for number, (x0, F) in enumerate((("10", "0.3"), ("1", "0.07"), ("100", "0.9")), 1):
        last = next(i for i in range(1000) if abs(Fraction(x0) - 2 * i * Fraction(F)) <= Fraction(F))
        closed = [f"t[{i}] = {i + 1}*pi" for i in range(last)]
        closed += [f"x[{i}] = {'-' if i % 2 == 0 else ''}({x0} - {2 * (i + 1)}*{F})" for i in range(last)]
        hard = "free decay: all turning points are on the belt at rest, and the last one is a stop for ever"
        p, t_end = wall(F, 1, P=0), int(pi * last) + 20
        yield _case(f"free-decay-{number}", p, (0, x0, 0), t_end, hard, BALANCE, closed)


def continuum() -> Iterator[ReferenceCase]:
    """Yield motions at Omega = 1/(2 n), c = 0: from d + x_0, with x_0 = 1/(1 - Omega^2), turning at d -+ x_0 for ever.

    That is so for |d| < Omega^2 x_0 - F; beyond it they stop.
    """
    members = ((1, "0.1", ("0", "0.1", "-0.2", "0.2333", "0.2334", "0.3")), (2, "0.05", ("0", "0.01", "-0.0166")))
    for n, F, middles in members:
        Omega = Fraction(1, 2 * n)
        x_0 = 1 / (1 - Omega**2)
        for number, d in enumerate(middles, 1):
            stays = abs(Fraction(d)) < Omega**2 * x_0 - Fraction(F)
            count = 8 if stays else 0
            closed = [f"t[{i}] = {2 * n * (i + 1)}*pi" for i in range(count)]
            closed += [f"x[{i}] = {d} {'+' if i % 2 else '-'} {show(x_0)}" for i in range(count)]
            hard = "a continuum of orbits: nothing draws the motion back, so that errors stay" + (
                "" if stays else "; beyond its end, where the motion stops"
            )
            name, t_end = f"continuum-{n}-{number}", Fraction(f"{(8 + 1 / 4) * 2 * n * pi:.6g}")
            start = (0, Fraction(d) + x_0, 0)
            yield _case(name, wall(F, Omega), start, t_end, hard, CSERNAK, closed, group=CONTINUUM)
