"""What the checks of Figs. 5 to 10 share: motions in many digits, sticks, forces, and a second opinion on motions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from symosc.certificates.certify import certify
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.flow import BeltConstants
from symosc.errors import MissingExtraError
from symosc.exact import show
from symosc.kernels._generated import acceleration
from symosc.model import NEIGHBOURS, Parameters
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.paper.checks.exact import flow
from symosc.paper.claims import UNDECIDED, Evidence
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory
from symosc.words import MAPS

CONTACT_DIGITS = 30
#: A force (acceleration) below this at a contact that is known to 30 digits is 0.
NO_FORCE = 1e-20
#: Half a unit of the fourth decimal, to which the paper prints its starts.
LAST_HALF_UNIT = Fraction(1, 20000)
#: The name of the number that cites a certificate.
CERTIFICATE = "certificate (symosc certify)"


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


# --- numbers as text ---

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def text(value: Any, digits: int = 15) -> str:
    """Return a number of any kind as text: a Fraction or an int exactly, others with so many digits."""
    if isinstance(value, int):
        return str(value)
    if isinstance(value, Fraction):
        return show(value)
    if hasattr(value, "context"):
        return str(value.context.nstr(value, digits)).removesuffix(".0")
    return f"{value:.{digits}g}"


def texts(values: Iterable[Any], digits: int = 15) -> str:
    """Return several numbers as text, with commas between them."""
    return ", ".join(text(value, digits) for value in values)


def force_text(value: Any) -> str:
    """Return a force at a contact as text; one that vanishes as 0 with its bound."""
    return f"0 (to {NO_FORCE:g})" if is_zero(value) else text(value)


def subscripted(label: Any) -> str:
    """Return "P2" as P₂."""
    return str(label).translate(_SUBSCRIPTS)


def mode_text(mode: Any) -> str:
    """Return "Omega1" as Ω₁ and "belt1" as belt 1."""
    name, digit = str(mode)[:-1], str(mode)[-1]
    return f"Ω{subscripted(digit)}" if name == "Omega" else f"{name} {digit}"


def force_name(domain: int) -> str:
    """Return F⁽¹⁾ for 1."""
    return f"F⁽{str(domain).translate(_SUPERSCRIPTS)}⁾"


def force_names(belt: int) -> str:
    """Return F⁽¹⁾, F⁽²⁾ for belt 1."""
    return ", ".join(map(force_name, NEIGHBOURS[belt]))


# --- motions ---

_recorders: list[list[Any]] = []


@contextmanager
def recording() -> Iterator[list[Any]]:
    """Collect the motions and orbits that checks use meanwhile, for the second opinion."""
    _recorders.append([])
    try:
        yield _recorders[-1]
    finally:
        _recorders.pop()


def recorded(found: Any) -> Any:
    """Return a motion or orbit, and add it to what is being recorded."""
    for each in _recorders:
        each.append(found)
    return found


def motion(scene: Scene, t_end: Any = None) -> Trajectory:
    """Return the motion of a scene with 30 digits."""
    found: Trajectory = recorded(_motion(scene, t_end))
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


def scene_contacts(scene: Scene, t_end: Any = None) -> list[SceneContact]:
    """Return the places of a motion's events."""
    convert = arithmetic(scene.parameters).context.convert
    path = motion(scene, t_end)
    return [SceneContact(e.boundary, convert(e.t), convert(e.x), convert(e.theta)) for e in path.events]


def sticks(scene: Scene, t_end: Any = None) -> list[Stick]:
    """Return the sticks of a motion in order of time; one that begins at the start counts."""
    path, at, found = motion(scene, t_end), scene_contacts(scene, t_end), []
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
    lo, hi = NEIGHBOURS[at.belt]
    return Forces(*(acceleration(at.x, v, cosine, constants[a - 1], K.cm, K.w0sq, K.f0) for a in (lo, hi)))


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


def is_zero(force: Any) -> bool:
    """Return whether a force at a contact is 0 to all digits."""
    return bool(abs(force) < NO_FORCE)


def certificate_of(what: Scene | PeriodicOrbit) -> dict[str, str]:
    """Return what a certificate of a motion or an orbit says, for the numbers of an evidence.

    Without python-flint it says that nothing is proven here; the verdict does not rest on it.
    """
    try:
        proof = certify(what)
    except MissingExtraError:
        return {CERTIFICATE: "none here: python-flint is not installed"}
    return {CERTIFICATE: f"{'proven' if proof.proven else 'not proven'}: {proof.message}"}


# --- a second opinion: every stretch computed by another closed form, every switch decided anew by Theorems 4 and 5 ---

#: What two closed forms may differ by in doubles, relative to the size of the motion.
AGREEMENT = 1e-9
SAMPLES = 101


class Stretch(NamedTuple):
    """A motion in one domain (1 to 3) or on one belt (-1, -2), from a state to the next contact."""

    where: int
    start: tuple[float, ...]
    end: tuple[float, ...]


@dataclass(frozen=True)
class Opinion:
    """What came out: stretches, the largest relative difference, and stretches or switches that are not so."""

    stretches: int = 0
    difference: float = 0.0
    outside: int = 0
    otherwise: int = 0

    @property
    def agrees(self) -> bool:
        """Whether the motion is confirmed."""
        return self.difference <= AGREEMENT and not self.outside and not self.otherwise


def stretches_of(what: Trajectory | PeriodicOrbit) -> list[Stretch]:
    """Return the stretches of a motion, or of one period of an orbit, the last one back to the first point."""
    p = what.parameters
    if isinstance(what, Trajectory):
        modes = [segment.mode for segment in what.segments]
        places = [int(mode[-1]) * (-1 if mode.startswith("belt") else 1) for mode in modes]
        events = what.events[: len(places)]
        states: list[tuple[Any, ...]] = [(what.t_start, *what(what.t_start)), *((e.t, e.x, e.v) for e in events)]
        if len(places) > len(events):
            states.append((what.t_end, *what(what.t_end)))
        ends = list(pairwise(states))
    else:
        rows = [MAPS[label] for label in what.labels]
        places = [row.domain or -row.start.boundary for row in rows]
        points = [*what.points, (what.points[0][0] + what.period, what.points[0][1])]
        ends = [
            ((*points[i], p.belt(row.start.boundary)), (*points[i + 1], p.belt(row.end.boundary)))
            for i, row in enumerate(rows)
        ]
    return [
        Stretch(where, tuple(map(float, start)), tuple(map(float, end)))
        for where, (start, end) in zip(places, ends, strict=True)
    ]


def fly_again(p: Parameters, stretches: list[Stretch]) -> Opinion:
    """Compute stretches again, and decide anew what follows each of them but the last."""
    differences, outside = [0.0], 0
    for stretch in stretches:
        (t0, x0, v0), (t1, x1, v1) = stretch.start, stretch.end
        t = np.linspace(t0, t1, SAMPLES)
        if stretch.where > 0:
            x, v = flow(p, p.A(stretch.where), stretch.start, t)
            edges = -np.inf, float(p.v1), float(p.v2), np.inf
            margin = np.minimum(v - edges[stretch.where - 1], edges[stretch.where] - v)
        else:
            x, v = x0 + v0 * (t - t0), np.full_like(t, float(p.belt(-stretch.where)))
            lo, hi = NEIGHBOURS[-stretch.where]
            margin = np.minimum(_force(p, lo, t, x, v), -_force(p, hi, t, x, v))
        size = max(1.0, float(np.abs(x).max()), float(np.abs(v).max()))
        differences.append(max(abs(float(x[-1]) - x1), abs(float(v[-1]) - v1)) / size)
        outside += int(margin.min() < -AGREEMENT * size)
    otherwise = sum(not _follows(p, one.end, then.where) for one, then in pairwise(stretches))
    return Opinion(len(stretches), max(differences), outside, otherwise)


def _force(p: Parameters, alpha: int, t: Any, x: Any, v: Any) -> Any:
    """Eq. (9)."""
    A, B0, Omega, k, c, m = (float(value) for value in (p.A(alpha), p.B0, p.Omega, p.k, p.c, p.m))
    return (A + B0 * np.cos(Omega * t) - k * x - c * v) / m


def _follows(p: Parameters, end: tuple[float, ...], then: int) -> bool:
    """Tell whether Theorems 4 and 5 let a motion go on so from a contact; where a force is 0 they allow both."""
    belt = 1 if abs(end[2] - float(p.v1)) < abs(end[2] - float(p.v2)) else 2
    lo, hi = NEIGHBOURS[belt]
    below, above = float(_force(p, lo, *end)), float(_force(p, hi, *end))
    slack = AGREEMENT * max(1.0, abs(below), abs(above))
    allowed = {-belt: below > -slack and above < slack, hi: above > -slack, lo: below < slack}
    return allowed.get(then, False)


def judge(check: Callable[[], Any]) -> Evidence:
    """Return the evidence of a check, with a second opinion on every motion and orbit that it uses.

    Without it a claim about a motion would be judged by the simulator alone.
    """
    with recording() as seen:
        evidence = check()
    if not isinstance(evidence, Evidence):
        name = getattr(getattr(check, "func", check), "__name__", str(check))
        raise TypeError(f"{name} returned {type(evidence).__name__}, not Evidence")
    opinions = [fly_again(each.parameters, stretches_of(each)) for each in {id(each): each for each in seen}.values()]
    count = sum(opinion.stretches for opinion in opinions)
    if not count:
        return evidence
    difference = max(opinion.difference for opinion in opinions)
    compared = f"{count} stretches, largest relative difference {difference:.1g}"
    evidence = replace(evidence, numbers=evidence.numbers | {"flown again in another closed form": compared})
    if all(opinion.agrees for opinion in opinions):
        return evidence
    return replace(evidence, verdict=UNDECIDED, finding=f"Two ways do not agree ({compared}). {evidence.finding}")
