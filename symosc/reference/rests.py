"""Creeping and rest: motions that come near a belt's speed slowly or never, and motions that stay on a belt."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from symosc.aliases import NumberLike
from symosc.exact import show
from symosc.model import Parameters
from symosc.reference.case import ReferenceCase
from symosc.scenes import Scene

RESTS = "creeping and rest"
UNIQUENESS = "uniqueness of the periodic motion and its exception (symosc derive literature): rests form an interval"
AT_THE_EDGE = "the force on the belt is 0 where it turns; it is never beyond, by elementary reasons: min of A + B0 cos"
ELEMENTARY = "the solution of the linear equation in one domain"

#: Overdamped, no drive, belt 1 at rest, far from belt 2; the roots are -1 and -3.
CREEPER = Parameters(m=1, c=4, k=3, A0=0, B0=0, Omega=1, v1=0, v2=50, mu1="0.2", mu2="0.1", FN=1)
GAP = Fraction(1)


def rests() -> Iterator[ReferenceCase]:
    """Yield the cases."""
    yield from _creeping()
    yield from _towards_a_limit()
    yield from _on_a_belt()


def _case(
    name: str,
    p: Parameters,
    start: tuple[NumberLike, NumberLike],
    t_end: NumberLike,
    hard: str,
    source: str = ELEMENTARY,
    closed: tuple[str, ...] = (),
    reason: str = "",
) -> ReferenceCase:
    scene = Scene(name, p, Fraction(0), start[0], start[1], t_end)  # type: ignore[arg-type]
    return ReferenceCase(name, RESTS, scene, hard, source, closed, reason)


def _creeping() -> Iterator[ReferenceCase]:
    """Yield flights from v = -1 to v = 0: with u = g' + r2 g = `push` at the start, g = |v|, contact only if u < 0.

    Then it is at t = log(1 + (r2 - r1) g/|u|)/(r2 - r1), and at t = g/|u| if the two roots are one.
    """
    for number, push in enumerate(("-1e-1", "-1e-9", "0", "1e-9"), 1):  # late, very late, just not, not
        for roots, (r1, r2) in (("two roots", (1, 3)), ("one root", (2, 2))):
            u = Fraction(push)
            if r1 == r2 and -u < Fraction(1, 1000) and u < 0:
                continue  # a contact after 1e9 time constants, where nothing is left of the velocity
            p = CREEPER.replace(c=r1 + r2, k=r1 * r2)
            a0 = -(u - r2 * GAP)
            x0 = (p.A(1) + p.c * GAP - p.m * a0) / p.k
            expression = "log(1 + 2/(%s))/2" if r1 != r2 else "1/(%s)"
            closed = (f"t[0] = {expression % show(-u)}",) if u < 0 else ()
            hard = f"the velocity creeps to the belt's, and {'meets it late' if u < 0 else 'never meets it'}: {roots}"
            t_end = 150 if r1 == r2 and u < 0 else 30
            yield _case(f"creeping-{number}-{roots.replace(' ', '-')}", p, (x0, -GAP), t_end, hard, closed=closed)


def _towards_a_limit() -> Iterator[ReferenceCase]:
    """Yield flights without spring and drive: v tends to A/c, which is `beyond` past the belt's speed 1."""
    for number, beyond in enumerate(("1e-3", "1e-12", "0", "-1e-12"), 1):
        p = CREEPER.replace(c=2, k=0, v1=1, A0=2 + 2 * Fraction(beyond) - Fraction("0.3"))
        b = Fraction(beyond)
        closed = (f"t[0] = log((1 + {beyond})/({beyond}))/2",) if b > 0 else ()
        hard = "the velocity tends to a limit " + (
            f"{beyond} beyond the belt's speed" if b > 0 else "that is the belt's speed" if not b else "short of it"
        )
        yield _case(f"limit-speed-{number}", p, (0, 0), 40, hard, closed=closed)


def _on_a_belt() -> Iterator[ReferenceCase]:
    p = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)
    for number, x0 in enumerate((0, "1/2", "-3/5", "-4/5", 1), 1):
        edge = x0 in ("-4/5", 1)
        hard = "rest on a belt: nothing may happen, for ever" + (
            "; on the edge, where the force just falls to 0" * edge
        )
        yield _case(f"rest-{number}", p, (x0, 0), 200, hard, UNIQUENESS, reason=AT_THE_EDGE if edge else "")
    hard = "the force reaches the edge of friction by 1e-9 or misses it by that, on a belt at rest"
    for name, x0 in (("slips", "1.000000001"), ("stays", "0.999999999")):  # A1 - |B0| = 1
        yield _case(f"rest-edge-{name}", p, (x0, 0), 60, hard, UNIQUENESS)
    fast = p.replace(v1=1, B0=0)
    hard = "one stick, one flight, then a slow approach to rest between the belts' speeds, with nothing more to find"
    yield _case("stick-then-settling", fast, (0, 1), 60, hard)
