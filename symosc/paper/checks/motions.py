"""Motions in many digits with an independent recomputation, and their sticks: Figs. 5 and 6,
Section 6 on all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple, TypeVar

import numpy as np
from scipy.optimize import brentq

from symosc.base.errors import MissingExtraError
from symosc.base.exact import show
from symosc.certificates.certify import certify
from symosc.engine.arithmetic import MpArithmetic
from symosc.friction import MAPS, NEIGHBOURS
from symosc.kernels._generated import acceleration
from symosc.mappings.equations import residual
from symosc.model import Parameters
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.paper.checks.exact import flow
from symosc.paper.claims import (
    CORRECTED,
    NOT_AS_PRINTED,
    UNDECIDED,
    Evidence,
    Refuted,
    evidence,
    verdict,
)
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

Found = TypeVar("Found", Trajectory, PeriodicOrbit)

CONTACT_DIGITS = 30
#: A force (acceleration) below this at a contact that is known to 30 digits is 0.
NO_FORCE = 1e-20
#: The paper's equation for the end of a stick on each belt.
EXIT_EQUATIONS = {1: 52, 2: 53}
#: Half a unit of the fourth decimal, to which the paper prints its starts.
LAST_HALF_UNIT = Fraction(1, 20000)


class SceneContact(NamedTuple):
    """A contact of a scene's motion with a belt: its time, position and phase, with 30 digits."""

    belt: int
    t: Any
    x: Any
    theta: Any


class Stick(NamedTuple):
    """A stick: its onset and its end (each a SceneContact).

    The end is None if the motion was not followed to it.
    """

    belt: int
    onset: SceneContact
    end: Any
    into: str | None


class Forces(NamedTuple):
    """F^(below) and F^(above) of a belt at one instant, eq. (9), and the time since the onset of
    the stick.
    """

    below: Any
    above: Any
    elapsed: Any = 0

    @property
    def product(self) -> Any:
        """F^(below) F^(above): negative in a stick (Theorem 4), positive where the motion passes
        (Theorem 5).
        """
        return self.below * self.above


# --- numbers as text ---

_SUBSCRIPTS = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
_SUPERSCRIPTS = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")


def text(value: Any, digits: int = 15) -> str:
    """Return numbers of any kind as text: a Fraction or an int exactly, others with `digits`
    digits.
    """
    if isinstance(value, Iterable):
        return ", ".join(text(item, digits) for item in value)
    if isinstance(value, int | Fraction):
        return show(Fraction(value))
    if hasattr(value, "context"):
        return str(value.context.nstr(value, digits)).removesuffix(".0")
    return f"{value:.{digits}g}"


def force_text(*values: Any) -> str:
    """Return forces at a contact as text.

    A force that vanishes appears as 0 with the bound that it is below.
    """
    return ", ".join(f"0 (to {NO_FORCE:g})" if is_zero(value) else text(value) for value in values)


def subscripted(label: Any) -> str:
    """Return "P2" as P₂."""
    return str(label).translate(_SUBSCRIPTS)


def mode_text(mode: Any) -> str:
    """Return "Omega1" as Ω₁ and "belt1" as belt 1."""
    kind = str(mode)[:-1]
    number = str(mode)[-1]
    if kind == "Omega":
        return f"Ω{subscripted(number)}"
    return f"{kind} {number}"


def force_names(*domains: int) -> str:
    """Return the names of the forces in domains, such as "F⁽¹⁾, F⁽²⁾" for 1 and 2."""
    return ", ".join(f"F⁽{str(domain).translate(_SUPERSCRIPTS)}⁾" for domain in domains)


# --- motions ---

# What the current check has simulated and solved, for the recomputation.
_seen: list[Trajectory | PeriodicOrbit] = []


def recorded(found: Found) -> Found:
    """Return the given motion or orbit after noting it for `judge`, which recomputes all that a
    check has used.
    """
    _seen.append(found)
    return found


def motion(scene: Scene, t_end: Any = None) -> Trajectory:
    """Return the motion of a scene with 30 digits."""
    return recorded(_motion(scene, t_end))


@cache
def _motion(scene: Scene, t_end: Any = None) -> Trajectory:
    return simulate(scene, t_end=t_end, digits=CONTACT_DIGITS)


@cache
def arithmetic(p: Parameters) -> MpArithmetic:
    """Return the arithmetic of 40 digits that holds the constants of a parameter set's closed
    forms.
    """
    return MpArithmetic(p, CONTACT_DIGITS + 10)


def number(p: Parameters, value: Fraction) -> Any:
    """Return a Fraction as a number of 40 digits, in the arithmetic of the parameters p."""
    return arithmetic(p).number(value)


def start_contact(scene: Scene, belt: int) -> SceneContact:
    """Return the start of a scene that begins on a belt."""
    exact = arithmetic(scene.parameters)
    return SceneContact(
        belt, exact.number(scene.t0), exact.number(scene.x0), exact.phase(scene.t0)[0]
    )


def scene_contacts(scene: Scene, t_end: Any = None) -> list[SceneContact]:
    """Return belt, time, position and phase of each event of a scene's motion."""
    convert = arithmetic(scene.parameters).context.convert
    return [
        SceneContact(e.boundary, *map(convert, (e.t, e.x, e.theta)))
        for e in motion(scene, t_end).events
    ]


def sticks(scene: Scene, t_end: Any = None) -> list[Stick]:
    """Return the sticks of a motion in order of time; one that begins at the start counts."""
    path = motion(scene, t_end)
    contacts = scene_contacts(scene, t_end)
    stretches = []
    # Segment i ends with event i; the last one may end with t_end instead.
    for i, segment in enumerate(path.segments):
        if segment.mode.startswith("belt"):
            belt = int(segment.mode[-1])
            if i == 0:
                onset = start_contact(scene, belt)
            else:
                onset = contacts[i - 1]
            if i < len(contacts):
                end = contacts[i]
                into = path.events[i].target
            else:
                end = None
                into = None
            stretches.append(Stick(belt, onset, end, into))
    return stretches


def first_stick(scene: Scene, belt: int) -> Stick:
    """Return the first stick on a belt that ends; raise Refuted if there is none before t_end."""
    for stick in sticks(scene):
        if stick.belt == belt and stick.end is not None:
            return stick
    numbers = {"events": len(motion(scene).events), "followed until t": text(scene.t_end)}
    raise Refuted(f"There is no stick on belt {belt} that ends.", numbers)


def forces(p: Parameters, contact: SceneContact) -> Forces:
    """Return the forces of the domains below and above the belt at a contact."""
    exact = arithmetic(p)
    K = exact.K
    cosine = exact.context.cos(contact.theta)
    v = exact.number(p.belt(contact.belt))
    constants = {1: K.A1, 2: K.A2, 3: K.A3}
    below, above = (
        acceleration(contact.x, v, cosine, constants[domain], K.cm, K.w0sq, K.f0)
        for domain in NEIGHBOURS[contact.belt]
    )
    return Forces(below, above)


def forces_along(p: Parameters, stick: Stick) -> list[Forces]:
    """Return the forces at the onset of a stick, at their extrema during the stick, and at its end."""
    # On a belt both forces are monotone between the phases Theta_cr of Theorem 7: what holds here
    # holds in between.
    exact = arithmetic(p)
    K = exact.K
    context = exact.context
    theta = stick.onset.theta
    if stick.belt == 1:
        belt = K.belt1
    else:
        belt = K.belt2
    first = forces(p, stick.onset)
    duration = stick.end.t - stick.onset.t
    along = [first]
    critical_phases: tuple[Any, ...]
    if belt.turns:
        critical_phases = (belt.angle, context.pi - belt.angle)
    else:
        critical_phases = ()
    for phase in critical_phases:
        elapsed = ((phase - theta) % (2 * context.pi)) / K.Om
        while elapsed < duration:
            gain, *_ = exact.namespace["force_gain"](
                elapsed, context.sin(theta), context.cos(theta), belt, K
            )
            along.append(Forces(first.below + gain, first.above + gain, elapsed))
            elapsed += K.period
    last = forces(p, stick.end)._replace(elapsed=duration)
    return [*sorted(along, key=lambda sides: sides.elapsed), last]


def is_zero(force: Any) -> bool:
    """Return whether a force at a contact is 0 to all digits."""
    return bool(abs(force) < NO_FORCE)


def certificate_of(subject: Scene | PeriodicOrbit) -> dict[str, str]:
    """Return a line for the `numbers` of an Evidence: what the certificate of a motion or orbit
    states.
    """
    try:
        proof = certify(subject)
        statement = f"{'proven' if proof.proven else 'not proven'}: {proof.message}"
    except MissingExtraError:
        statement = "none here: python-flint is not installed"
    return {"certificate (symosc certify)": statement}


# --- a second opinion: every stretch computed by another closed form, every switch decided anew by
# Theorems 4 and 5 ---

#: What two closed forms may differ by in doubles, relative to the size of the motion.
AGREEMENT = 1e-9
SAMPLES = 101


class Stretch(NamedTuple):
    """A part of a motion in one domain (1 to 3) or on one belt (-1, -2), from a state (t, x, v) to
    the next contact.
    """

    place: int
    start: tuple[float, ...]
    end: tuple[float, ...]


def stretches_of(path: Trajectory | PeriodicOrbit) -> list[Stretch]:
    """Split a motion, or one period of an orbit, at its contacts.

    An orbit's last part ends at its first point.
    """
    p = path.parameters
    states: list[tuple[Any, ...]]
    if isinstance(path, Trajectory):
        # Places as in `Stretch`: the number of a domain, or minus that of a belt.
        modes = [segment.mode for segment in path.segments]
        places = [int(mode[-1]) * (-1 if mode.startswith("belt") else 1) for mode in modes]
        states = [
            (path.t_start, *path(path.t_start)),
            *((event.t, event.x, event.v) for event in path.events[: len(places)]),
        ]
        if len(places) == len(states):  # the last stretch ends without a contact
            states.append((path.t_end, *path(path.t_end)))
    else:
        rows = [MAPS[label] for label in path.labels]
        places = [row.domain or -row.start.boundary for row in rows]
        states = [
            (*point, p.belt(row.start.boundary))
            for row, point in zip(rows, path.points, strict=True)
        ]
        (t, x, v) = states[0]
        states.append((t + path.period, x, v))
    in_doubles = (tuple(map(float, state)) for state in states)
    return [
        Stretch(place, start, end)
        for place, (start, end) in zip(places, pairwise(in_doubles), strict=True)
    ]


def fly_again(p: Parameters, stretches: list[Stretch]) -> tuple[float, int]:
    """Recompute each stretch of a motion.

    Return the largest relative difference between computed and stored ends, and how many stretches
    leave their domain or belt, or begin where Theorems 4 and 5 forbid it.
    """
    differences = [0.0]
    contradictions = 0
    for stretch in stretches:
        (t0, x0, v0) = stretch.start
        (t_end, x_end, v_end) = stretch.end
        t = np.linspace(t0, t_end, SAMPLES)
        if stretch.place > 0:
            x, v = flow(p, p.A(stretch.place), stretch.start, t)
            v1 = float(p.v1)
            v2 = float(p.v2)
            low, high = {1: (-np.inf, v1), 2: (v1, v2), 3: (v2, np.inf)}[stretch.place]
            margin = np.minimum(v - low, high - v)
        else:
            belt = -stretch.place
            x = x0 + v0 * (t - t0)
            v = np.full_like(t, float(p.belt(belt)))
            lo, hi = NEIGHBOURS[belt]
            margin = np.minimum(field(p, lo, t, x, v), -field(p, hi, t, x, v))
        size = max(1.0, float(np.abs(x).max()), float(np.abs(v).max()))
        differences.append(max(abs(float(x[-1]) - x_end), abs(float(v[-1]) - v_end)) / size)
        contradictions += int(margin.min() < -AGREEMENT * size)
    contradictions += sum(
        not _follows(p, before.end, after.place) for before, after in pairwise(stretches)
    )
    return max(differences), contradictions


def field(p: Parameters, alpha: int, t: Any, x: Any, v: Any) -> Any:
    """Return the acceleration F^(alpha) of eq. (9)."""
    A, B0, Omega, k, c, m = (float(value) for value in (p.A(alpha), p.B0, p.Omega, p.k, p.c, p.m))
    return (A + B0 * np.cos(Omega * t) - k * x - c * v) / m


def _follows(p: Parameters, state: tuple[float, ...], place: int) -> bool:
    """Return whether by Theorems 4 and 5 a stretch in `place` may follow at a `state` (t, x, v) on
    a belt.
    """
    (t, x, v) = state
    if abs(v - float(p.v1)) < abs(v - float(p.v2)):
        belt = 1
    else:
        belt = 2
    lo, hi = NEIGHBOURS[belt]
    below = float(field(p, lo, t, x, v))
    above = float(field(p, hi, t, x, v))
    slack = AGREEMENT * max(1.0, abs(below), abs(above))
    allowed = {-belt: below > -slack and above < slack, hi: above > -slack, lo: below < slack}
    return allowed.get(place, False)


def judge(check: Callable[[], Any]) -> Evidence:
    """Run a check and recompute every motion and orbit that it used by independent means."""
    _seen.clear()  # `check` fills it: `recorded` notes what it simulates and solves
    try:
        result = check()
    except Refuted as refuted:
        result = refuted.evidence
    if not isinstance(result, Evidence):
        name = getattr(getattr(check, "func", check), "__name__", str(check))
        raise TypeError(f"{name} returned {type(result).__name__}, not Evidence")
    if not _seen:
        return result
    different_paths = {id(path): path for path in _seen}.values()
    flights = [(path.parameters.parameters, stretches_of(path)) for path in different_paths]
    differences, contradictions = zip(
        *(fly_again(p, stretches) for p, stretches in flights), strict=True
    )
    compared = (
        f"{sum(len(stretches) for _, stretches in flights)} stretches, largest relative difference "
        f"{max(differences):.1g}"
    )
    result = replace(
        result, numbers=result.numbers | {"flown again in another closed form": compared}
    )
    if max(differences) <= AGREEMENT and not any(contradictions):
        return result
    return replace(
        result, verdict=UNDECIDED, finding=f"Two ways do not agree ({compared}). {result.finding}"
    )


# --- Figs. 5 and 6 ---

FIG5, FIG6, FIG10 = map(load_scene, ("fig5", "fig6", "fig10"))
PRINTED = tuple(load_scene(f"fig{number}") for number in range(5, 11))
#: The figures with sticks, and how far they are followed for the force products.
FOLLOWED = {"fig5": 40, "fig6": 20, "fig8": 9, "fig10": 15}
WITH_STICKS = tuple(map(load_scene, FOLLOWED))
PRODUCT_SAMPLES = 2000


def onset_later(scene: Scene, belt: int) -> Evidence:
    """Check that the first stick on a belt starts after t0."""
    onset = first_stick(scene, belt).onset
    p = scene.parameters
    wait = text(onset.t - number(p, scene.t0), 11)
    finding = (
        f"The stick on belt {belt} starts {wait} after t₀ = {text(scene.t0)}, at x = "
        f"{text(onset.x, 11)}."
    )
    numbers = {
        "t of the blue point": text(onset.t, 25),
        "x of the blue point": text(onset.x, 25),
        "ẋ₀, velocity of the belt": text((scene.v0, p.belt(belt))),
    }
    return Evidence(
        verdict(onset.t > number(p, scene.t0)), finding, numbers | certificate_of(scene)
    )


def together(scene: Scene, belt: int) -> Evidence:
    """Check x = x_i + v (t - t_i) over the first stick, and that static friction suffices for it:
    eqs. (2) to (4).
    """
    stick = first_stick(scene, belt)
    p = scene.parameters
    most_friction = (p.mu1 if belt == 1 else p.mu2) * p.FN
    grip = number(p, most_friction)
    m = number(p, p.m)
    # The force of (2) on the mass is m F^(below) - mu FN.
    needed = [m * sides.below - grip for sides in forces_along(p, stick)]
    duration = stick.end.t - stick.onset.t
    distance = stick.end.x - stick.onset.x
    apart = abs(distance - number(p, p.belt(belt)) * duration)
    enough = max(abs(force) for force in needed) <= grip + NO_FORCE
    if is_zero(abs(needed[-1]) - grip):
        used_up = "; it is used up at the green point"
    else:
        used_up = ""
    finding = (
        f"For {text(duration, 11)} the mass moves with belt {belt}, both by {text(distance, 11)}. "
        f"The static friction that this needs stays within μ{subscripted(belt)} F_N = "
        f"{text(most_friction)}{used_up}."
    )
    numbers = {
        "t of the blue and of the green point": text((stick.onset.t, stick.end.t), 20),
        "x of the blue and of the green point": text((stick.onset.x, stick.end.x), 20),
        "way of the mass minus way of the belt": text(apart, 2),
        f"F_s{belt} of eq. (2) at the onset, where it turns, at the end": text(needed, 10),
    }
    return evidence(duration > 0 and apart < NO_FORCE and enough, finding, numbers)


def forces_hold(scene: Scene, belt: int) -> Evidence:
    """Check Theorem 4's conditions, F^(below) > 0 > F^(above), over the whole first stick.

    At its end one may be 0.
    """
    stick = first_stick(scene, belt)
    domains = NEIGHBOURS[belt]
    along = forces_along(scene.parameters, stick)
    *during, last = along
    held_during = all(sides.below > NO_FORCE and sides.above < -NO_FORCE for sides in during)
    held_at_end = last.below > -NO_FORCE and last.above < NO_FORCE
    lowest = min(sides.below for sides in along)
    highest = max(sides.above for sides in along)
    finding = (
        f"From t = {text(stick.onset.t, 11)} to {text(stick.end.t, 11)} {force_names(domains[0])} "
        f"is at least {force_text(lowest)}, {force_names(domains[1])} at most "
        f"{force_text(highest)}, with 0 at the green point only. Both are monotone between the "
        "instants listed: this is decided for the whole stick, not at samples."
    )
    numbers = {
        f"{force_names(*domains)} at t = {text(stick.onset.t + sides.elapsed)}": force_text(
            sides.below, sides.above
        )
        for sides in along
    }
    return evidence(held_during and held_at_end, finding, numbers)


def ends_below(scene: Scene, belt: int) -> Evidence:
    """Check that F^(below) is 0 at the end of the first stick, while F^(above) < 0 would still hold
    the mass.
    """
    stick = first_stick(scene, belt)
    (lo, hi) = NEIGHBOURS[belt]
    below, above, _ = forces(scene.parameters, stick.end)
    holds = is_zero(below) and above < 0 and stick.into == f"Omega{lo}"
    finding = (
        f"At t = {text(stick.end.t, 13)} {force_names(lo)} = {force_text(below)}, "
        f"{force_names(hi)} = {text(above)}; the mass slips into {mode_text(stick.into)}. "
        f"Eq. ({EXIT_EQUATIONS[belt]}) of the paper wants {force_names(hi)} = 0 there."
    )
    numbers = {
        "t of the green point": text(stick.end.t, 25),
        force_names(lo): force_text(below),
        force_names(hi): text(above, 25),
    }
    return Evidence(verdict(holds), finding, numbers)


def flight_after(scene: Scene, belt: int, *domains: int) -> Evidence:
    """Check that a flight in one of the domains follows the first stick and obeys (5) up to the
    next contact.
    """
    (_, _, end, into) = first_stick(scene, belt)
    contacts = scene_contacts(scene)
    p = scene.parameters
    i = contacts.index(end)
    if i + 1 == len(contacts):
        return Evidence(UNDECIDED, "No contact follows.", {"followed until t": text(scene.t_end)})
    after = contacts[i + 1]
    Omega = number(p, p.Omega)
    label = str(motion(scene).segments[i + 1].label)
    # The engine flies with gains from the contact; (54) is evaluated here from one contact to the
    # next.
    residuals = [
        abs(f) for f in residual(p, label, (end.x, Omega * end.t), (after.x, Omega * after.t))
    ]
    duration = after.t - end.t
    domain = int(str(into)[-1])
    drag = p.A(domain) - p.A0
    finding = (
        f"For {text(duration, 11)}, from t = {text(end.t, 11)} to {text(after.t, 11)}, the mass is "
        f"in {mode_text(into)} ({subscripted(label)}) with the kinetic friction {text(drag)}; then "
        f"it is at belt {after.belt}."
    )
    numbers = {
        "t from, to": text((end.t, after.t), 20),
        "friction force A_α − A₀": text(drag),
        f"residuals f₁, f₂ of (54) for {subscripted(label)}": text(residuals, 2),
    }
    holds = domain in domains and duration > 0 and max(residuals) < NO_FORCE
    return Evidence(verdict(holds), finding, numbers)


def product_after(scene: Scene, belt: int) -> Evidence:
    """Check the sign of the product of both forces from the end of the first stick up to the next
    contact.
    """
    end = first_stick(scene, belt).end
    path = motion(scene)
    (lo, hi) = NEIGHBOURS[belt]
    following = next((contact for contact in scene_contacts(scene) if contact.t > end.t), None)
    since = float(end.t)
    until = float(path.t_end if following is None else following.t)

    def product(t: float) -> float:
        return float(path.force(lo, t) * path.force(hi, t))

    times = [
        since + (until - since) * (j + 1) / (PRODUCT_SAMPLES + 1) for j in range(PRODUCT_SAMPLES)
    ]
    products = [product(t) for t in times]
    # The first sample whose product has another sign than the one before.
    turn = next(
        (j for j in range(1, PRODUCT_SAMPLES) if (products[j] > 0) != (products[j - 1] > 0)), None
    )
    numbers = {
        "t of the green point": text(since),
        "followed until t": text(until),
        "product just after the green point": text(products[0], 6),
        "lowest product": text(min(products), 6),
    }
    if following is not None:
        numbers["product at the next contact"] = text(forces(scene.parameters, following).product)
    finding = f"The product has one sign from the green point until t = {text(until, 8)}."
    if turn is not None:
        zero = brentq(product, times[turn - 1], times[turn], xtol=1e-14)
        _, v_zero = path(zero)
        numbers["the product changes its sign at t"] = f"{zero:.12g} (to 1e-12)"
        finding = (
            f"The product is positive only until t = {zero:.10g}, {zero - since:.7g} after the "
            f"green point: there ẋ has its extremum {v_zero:.7g} and {force_names(lo)} "
            f"changes its sign. At the next contact, t = {text(until, 8)}, the product is "
            f"{'negative' if products[-1] < 0 else 'positive'}."
        )
    return Evidence(verdict(min(products) > 0, products[0] > 0), finding, numbers)


def sticks_at_start(scene: Scene, belt: int) -> Evidence:
    """Check that the mass sticks from the start on (Theorem 4).

    The verdict is CORRECTED if it sticks only later.
    """
    p = scene.parameters
    (lo, hi) = NEIGHBOURS[belt]
    mode = mode_text(motion(scene).segments[0].mode)
    below, above, _ = forces(p, start_contact(scene, belt))
    finding = (
        f"At t₀ = {text(scene.t0)} {force_names(lo)} = {text(below, 8)}, "
        f"{force_names(hi)} = {text(above, 8)}: "
    )
    numbers = {
        f"{force_names(lo, hi)} at the start": text((below, above)),
        "ẋ₀, velocity of the belt": text((scene.v0, p.belt(belt))),
        "first mode of motion": mode,
    } | certificate_of(scene)
    if scene.v0 == p.belt(belt) and below > NO_FORCE and above < -NO_FORCE:
        return Evidence(verdict(True), f"{finding}the mass sticks at once (Theorem 4).", numbers)
    first = next((stick for stick in sticks(scene) if stick.belt == belt), None)
    if first is None:
        return Evidence(NOT_AS_PRINTED, f"{finding}the mass does not stick, nor later.", numbers)
    numbers["t of the first stick"] = text(first.onset.t, 20)
    finding += (
        f"no stick at the start (Theorem 5), the mass leaves into {mode} and sticks to belt {belt} "
        f"only at t = {text(first.onset.t, 11)}."
    )
    return Evidence(CORRECTED, finding, numbers)


# --- what Section 6 says of all figures ---


def _figure(scene: Scene) -> str:
    """Return the figure of a scene as text, such as "Fig. 5"."""
    return f"Fig. {scene.name.removeprefix('fig')}"


def hypotheses(scenes: tuple[Scene, ...]) -> Evidence:
    """Check what Section 2 and Theorem 7 assume of the parameters, in rational numbers."""
    numbers = {}
    holds = True
    for scene in scenes:
        p = scene.parameters
        are_ordered = p.v1 < p.v2 and p.mu1 >= p.mu2
        are_positive = min(p.m, p.FN, p.B0, p.Omega) > 0
        holds = holds and are_ordered and are_positive
        numbers[f"{_figure(scene)}: v₂ − v₁, μ₁ − μ₂"] = text((p.v2 - p.v1, p.mu1 - p.mu2))
    finding = (
        f"v₁ < v₂, μ₁ ≥ μ₂ and B₀ > 0, decided in rational numbers, holds in all {len(scenes)} "
        "figures."
    )
    return evidence(holds, finding, numbers)


def weight(scenes: tuple[Scene, ...]) -> Evidence:
    """Compare FN with the weight m g: all captions list g = 9.81, and no equation contains it."""
    weights = {
        _figure(scene): (scene.parameters.FN, scene.parameters.m * Fraction("9.81"))
        for scene in scenes
    }
    equal = [name for name, (force, weight_force) in weights.items() if force == weight_force]
    unequal = [name for name in weights if name not in equal]
    finding = f"No equation contains g. F_N = m g in {', '.join(equal) or 'no figure'}"
    if unequal:
        unequal_weights = [weights[name] for name in unequal]
        ratios = text((float(force / weight_force) for force, weight_force in unequal_weights), 4)
        finding += f"; in {', '.join(unequal)} F_N is {ratios} times the weight"
    numbers = {f"{name}: F_N, m g": text(pair) for name, pair in weights.items()}
    return Evidence(verdict(equal), f"{finding}.", numbers)


def force_products(scenes: tuple[Scene, ...]) -> Evidence:
    """Check that the product of both forces is < 0 where each stick of the scenes starts, and 0
    where it ends.
    """
    numbers = {}
    holds = True
    count = 0
    for scene in scenes:
        p = scene.parameters
        name = _figure(scene)
        ended = [
            stick for stick in sticks(scene, FOLLOWED.get(scene.name)) if stick.end is not None
        ]
        if not ended:
            continue
        starts = [forces(p, stick.onset).product for stick in ended]
        ends = [forces(p, stick.end) for stick in ended]
        one_vanishes = all(is_zero(end.below) != is_zero(end.above) for end in ends)
        holds = holds and max(starts) < 0 and one_vanishes
        count += len(ended)
        vanishing = max(min(abs(end.below), abs(end.above)) for end in ends)
        numbers[f"{name}: sticks"] = str(len(ended))
        numbers[f"{name}: product where they start"] = (
            f"{text(min(starts), 8)} to {text(max(starts), 8)}"
        )
        numbers[f"{name}: the force that vanishes where they end"] = f"at most {text(vanishing, 2)}"
    if not count:
        return Evidence(UNDECIDED, "There is no stick.", {"sticks": "0"})
    finding = f"All {count} sticks start with a negative product and end with exactly one force 0."
    return evidence(holds, finding, numbers)
