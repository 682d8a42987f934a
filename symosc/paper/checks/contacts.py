"""What the checks of Figs. 5 to 10 share: motions in many digits, their sticks, and the forces at contacts."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.flow import BeltConstants
from symosc.exact import show
from symosc.kernels._generated import acceleration
from symosc.model import NEIGHBOURS, Parameters
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

CONTACT_DIGITS = 30
#: A force (acceleration) below this at a contact that is known to 30 digits is 0.
NO_FORCE = 1e-20
SHOWN = 15
SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
DIGITS_ABOVE = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


class SceneContact(NamedTuple):
    """A state on a belt: time, position and phase, with 30 digits."""

    belt: int
    t: Any
    x: Any
    theta: Any


class Stick(NamedTuple):
    """A stick from its onset to its end, which is None if the motion was not followed so far."""

    belt: int
    onset: SceneContact
    end: SceneContact | None
    into: str | None


class Forces(NamedTuple):
    """F^(below) and F^(above) of a belt at one instant, eq. (9), and the time since the onset of the stick."""

    below: Any
    above: Any
    elapsed: Any = 0

    @property
    def product(self) -> Any:
        """F^(below) F^(above): negative in a stick (Theorem 4), positive where the motion passes (Theorem 5)."""
        return self.below * self.above


_seen: list[list[Any]] = []


@contextmanager
def recording() -> Iterator[list[Any]]:
    """Collect the motions, and orbits, that are looked at meanwhile."""
    _seen.append([])
    try:
        yield _seen[-1]
    finally:
        _seen.pop()


def looked_at(found: Any) -> Any:
    """Return a motion or orbit, and tell who is recording."""
    for each in _seen:
        each.append(found)
    return found


def motion(scene: Scene, t_end: Any = None) -> Trajectory:
    """Return the motion of a scene with 30 digits."""
    found: Trajectory = looked_at(_motion(scene, t_end))
    return found


@cache
def _motion(scene: Scene, t_end: Any = None) -> Trajectory:
    return simulate(scene, t_end=t_end, digits=CONTACT_DIGITS)


@cache
def arithmetic(p: Parameters) -> MpArithmetic:
    """Return the constants of a parameter set, with 40 digits."""
    return MpArithmetic(p, CONTACT_DIGITS + 10)


def number(p: Parameters, value: Fraction) -> Any:
    """Return a Fraction as a number of 40 digits."""
    return arithmetic(p).number(value)


def start_contact(scene: Scene, belt: int) -> SceneContact:
    """Return the start of a scene that begins on a belt."""
    exact = arithmetic(scene.parameters)
    return SceneContact(belt, exact.number(scene.t0), exact.number(scene.x0), exact.phase(scene.t0)[1])


def contacts(scene: Scene, t_end: Any = None) -> list[SceneContact]:
    """Return the places of a motion's events."""
    convert = arithmetic(scene.parameters).context.convert
    path = motion(scene, t_end)
    return [SceneContact(e.boundary, convert(e.t), convert(e.x), convert(e.theta)) for e in path.events]


def sticks(scene: Scene, t_end: Any = None) -> list[Stick]:
    """Return the sticks of a motion in order of time; one that begins at the start counts."""
    path, at, found = motion(scene, t_end), contacts(scene, t_end), []
    for i, segment in enumerate(path.segments):
        if segment.mode.startswith("belt"):
            belt = int(segment.mode[-1])
            onset = at[i - 1] if i else start_contact(scene, belt)
            end, into = (at[i], path.events[i].target) if i < len(at) else (None, None)
            found.append(Stick(belt, onset, end, into))
    return found


def forces(p: Parameters, at: SceneContact) -> Forces:
    """Return both forces at a contact."""
    exact = arithmetic(p)
    K, cosine, v = exact.K, exact.context.cos(at.theta), exact.number(p.belt(at.belt))
    constants = (K.A1, K.A2, K.A3)
    below, above = (
        acceleration(at.x, v, cosine, constants[domain - 1], K.cm, K.w0sq, K.f0) for domain in NEIGHBOURS[at.belt]
    )
    return Forces(below, above)


def forces_along(p: Parameters, stick: Stick) -> list[Forces]:
    """Return the forces at the onset of a stick, wherever they turn during it, and at its end.

    On a belt both forces are monotone between the phases Theta_cr of Theorem 7: what holds at these instants holds
    between them, not only at samples.
    """
    if stick.end is None:
        raise ValueError("the motion was not followed to the end of the stick")
    exact = arithmetic(p)
    belt: BeltConstants = exact.K.belt1 if stick.belt == 1 else exact.K.belt2
    first, last = forces(p, stick.onset), forces(p, stick.end)
    lasts = stick.end.t - stick.onset.t
    context, theta = exact.context, stick.onset.theta
    found = [first]
    for angle in (belt.angle, context.pi - belt.angle) if belt.turns else ():
        elapsed = ((angle - theta) % (2 * context.pi)) / exact.K.Om
        while elapsed < lasts:
            change = exact.namespace["gain"](elapsed, context.sin(theta), context.cos(theta), belt, exact.K)[0]
            found.append(Forces(first.below + change, first.above + change, elapsed))
            elapsed += exact.K.period
    return [*sorted(found, key=lambda each: each.elapsed), last._replace(elapsed=lasts)]


def stick_holds(along: list[Forces]) -> bool:
    """Return whether F^(below) > 0 > F^(above) (Theorem 4) from the onset on up to the end, at which one may be 0."""
    inside, end = along[:-1], along[-1]
    return (
        all(each.below > NO_FORCE and each.above < -NO_FORCE for each in inside)
        and end.below > -NO_FORCE
        and end.above < NO_FORCE
    )


def is_zero(force: Any) -> bool:
    """Return whether a force at a contact is 0 to all digits."""
    return bool(abs(force) < NO_FORCE)


def verdict(as_printed: bool, corrected: bool = False) -> str:
    """Return the verdict on a statement that holds as printed, or only when corrected."""
    return CONFIRMED if as_printed else CORRECTED if corrected else NOT_AS_PRINTED


def text(value: Any, digits: int = SHOWN) -> str:
    """Return a number of any kind as text: a Fraction or an int exactly, others with so many digits."""
    if isinstance(value, int):
        return str(value)
    if isinstance(value, Fraction):
        return show(value)
    if hasattr(value, "context"):
        return str(value.context.nstr(value, digits)).removesuffix(".0")
    return f"{value:.{digits}g}"


def force_text(value: Any) -> str:
    """Return a force at a contact as text; one that vanishes as 0 with its bound."""
    return f"0 (to {NO_FORCE:g})" if is_zero(value) else text(value)


def mode_text(mode: Any) -> str:
    """Return "Omega1" as Ω₁ and "belt1" as belt 1."""
    name, digit = str(mode)[:-1], str(mode)[-1]
    return f"Ω{lowered(digit)}" if name == "Omega" else f"{name} {digit}"


def lowered(label: Any) -> str:
    """Return "P2" as P₂."""
    return str(label).translate(SUBSCRIPTS)


def force_name(domain: int) -> str:
    """Return F⁽¹⁾ for 1."""
    return f"F⁽{str(domain).translate(DIGITS_ABOVE)}⁾"
