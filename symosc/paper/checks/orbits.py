"""Figs. 9 and 10: periodic motions without sticks (P32) and with sticks (P4645), their starts, and
Section 7.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import cycle, pairwise, zip_longest
from math import cos, inf, pi, sin
from operator import eq
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from symosc.base.errors import SymoscError
from symosc.friction import NEIGHBOURS
from symosc.mappings.equations import jacobian, residual
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.paper.checks.motions import (
    CONTACT_DIGITS,
    EXIT_EQUATIONS,
    LAST_HALF_UNIT,
    NO_FORCE,
    SceneContact,
    certificate_of,
    force_names,
    force_text,
    forces,
    is_zero,
    mode_text,
    motion,
    number,
    recorded,
    scene_contacts,
    start_contact,
    sticks,
    subscripted,
    text,
)
from symosc.paper.claims import (
    CONFIRMED,
    CORRECTED,
    NOT_AS_PRINTED,
    Evidence,
    Refuted,
    evidence,
    verdict,
)
from symosc.scenes import Scene, load_scene
from symosc.simulation.ensemble import simulate_many
from symosc.words import read_word

FIG9, FIG10 = map(load_scene, ("fig9", "fig10"))
#: How near to the periodic motion a motion counts as settled, in x and x'.
WITHIN = 1e-4
#: Sticks whose forces are listed; of the others the summary tells.
SHOWN_STICKS = 4


def orbit_of(scene: Scene) -> PeriodicOrbit:
    """Return the periodic orbit of the word that a scene names, with 30 digits.

    Raise Refuted if there is none.
    """
    orbit = _orbit_of(scene)
    if orbit:
        return recorded(orbit)
    numbers = {"mappings from the printed start": " ".join(motion(scene).word[-8:]) or "none"}
    raise Refuted(f"There is no periodic motion {subscripted(scene.structure)}.", numbers)


@cache
def _orbit_of(scene: Scene) -> PeriodicOrbit | None:
    """Return the periodic orbit of the word that a scene names, None if there is none."""
    try:
        orbit = find_orbit(scene.parameters, str(scene.structure), digits=CONTACT_DIGITS)
    except ConvergenceError:
        return None
    if orbit.admissible:
        return orbit
    return None


def orbit_exists(scene: Scene) -> Evidence:
    """Solve (54), closed after one period, for the scene's word.

    Check all inequalities that the orbit must fulfil.
    """
    orbit = orbit_of(scene)
    conditions = orbit_of(scene).conditions()
    margin = min(conditions, key=lambda condition: condition.value)
    finding = (
        f"{subscripted(scene.structure)} exists: it has the period of the excitation, "
        f"{text(orbit.period, 10)}, all {len(conditions)} inequalities hold, and it is "
        f"{'stable' if orbit.stable else 'unstable'} (largest |multiplier| "
        f"{float(abs(orbit.multipliers[0])):.6g})."
    )
    numbers = {
        f"{i}. {subscripted(label)} starts at t, x": text((point.t, point.x), 22)
        for i, (label, point) in enumerate(zip(orbit.labels, orbit.points, strict=True), 1)
    } | {
        "largest residual of (54)": text(orbit.residual, 2),
        "smallest margin of an inequality": f"{margin.value:.6g} ({margin.text})",
        "distance from grazing, as a velocity": f"{orbit.grazing_distance:.6g}",
        "|multipliers|": text((float(abs(value)) for value in orbit.multipliers), 8),
    }
    holds = orbit.periods == 1 and orbit.stable is True
    return Evidence(verdict(holds), finding, numbers | certificate_of(orbit))


def in_order(scene: Scene) -> Evidence:
    """Check that the motion follows the scene's word, and by (54) that each mapping starts where
    the last one ended.
    """
    p = scene.parameters
    path = motion(scene)
    contacts = scene_contacts(scene)
    points = [start_contact(scene, path.events[0].boundary), *contacts]
    Omega = number(p, p.Omega)
    word = path.word
    if scene.structure:
        labels = read_word(scene.structure).labels
    else:
        labels = ()
    # The start may be anywhere on the orbit: the motion may begin with any of its mappings.
    rotations = [cycle(labels[i:] + labels[:i]) for i in range(len(labels))]
    ordered = bool(word) and any(all(map(eq, word, rotation)) for rotation in rotations)
    worst = 0 * Omega
    for segment, (start, end) in zip(path.segments, pairwise(points), strict=False):
        if segment.label:
            residuals = residual(
                p, segment.label, (start.x, Omega * start.t), (end.x, Omega * end.t)
            )
            worst = max([worst, *map(abs, residuals)])
    crossings = [
        forces(p, contact)
        for contact, event in zip(contacts, path.events, strict=True)
        if event.kind == "cross"
    ]
    numbers = {
        "mappings in order of time": subscripted(" ".join(word)) or "none",
        "largest residual f₁, f₂ of (54) from each switching point to the next": text(worst, 2),
    }
    first = ", ".join(map(subscripted, word[:5]))
    finding = (
        f"From the start on the mappings are {first}, …: the structure "
        f"{subscripted(scene.structure)}, {len(word)} mappings long. Each begins where the last "
        "one ends: x and ẋ are continuous"
    )
    if crossings:
        jump = max(abs(sides.below - sides.above) for sides in crossings)
        numbers["jump of the acceleration where the mass crosses"] = text(jump, 12)
        finding += f"; the acceleration jumps, by {text(jump, 6)}"
    return evidence(ordered and worst < NO_FORCE, finding + ".", numbers)


def products_positive(scene: Scene, belt: int) -> Evidence:
    """Check that both forces have one sign at every switching point (Theorem 5), of the motion and
    of the orbit.
    """
    p = scene.parameters
    orbit = orbit_of(scene)
    if scene.v0 == p.belt(belt):
        contacts = [start_contact(scene, belt)]
    else:
        contacts = []
    contacts += [contact for contact in scene_contacts(scene) if contact.belt == belt]
    for piece, point in zip(orbit.equations().pieces, orbit.points, strict=True):
        if piece.start == belt:
            contacts.append(SceneContact(belt, point.t, point.x, number(p, p.Omega) * point.t))
    pairs = [forces(p, contact) for contact in contacts]
    products = [pair.product for pair in pairs]
    numbers = {
        "switching points (start, motion, periodic motion)": str(len(contacts)),
        "lowest and highest product": text((min(products), max(products)), 10),
    }
    names = force_names(*NEIGHBOURS[belt])
    for contact, (below, above, _) in list(zip(contacts, pairs, strict=True))[-2:]:
        numbers[f"{names} at t = {text(contact.t, 12)} (periodic motion)"] = text(
            (below, above), 12
        )
    least = text(min(products), 8)
    finding = (
        f"At all {len(contacts)} switching points the product is positive; the smallest is {least}."
    )
    return evidence(min(products) > 0, finding, numbers)


def passes(scene: Scene, belt: int) -> Evidence:
    """Check that every contact is a crossing in the direction of both forces, as Theorem 5 says."""
    p = scene.parameters
    path = motion(scene)
    (lo, hi) = NEIGHBOURS[belt]
    passages = {"up": (f"Omega{lo}", f"Omega{hi}"), "down": (f"Omega{hi}", f"Omega{lo}")}
    positions: dict[str, list[Any]] = {"up": [], "down": []}
    right = True
    for contact, event in zip(scene_contacts(scene), path.events, strict=True):
        below, above, _ = forces(p, contact)
        if below > 0 and above > 0:
            direction = "up"
        elif below < 0 and above < 0:
            direction = "down"
        else:
            direction = ""
        expected = passages.get(direction)
        right = right and event.kind == "cross" and (event.source, event.target) == expected
        if direction:
            positions[direction].append(contact.x)
    numbers = {
        f"passages {direction}: number, x from, to": f"{len(xs)}, {text((min(xs), max(xs)), 9)}"
        for direction, xs in positions.items()
        if xs
    } | {"contacts": str(len(path.events))}
    finding = (
        f"All {len(path.events)} contacts are passages to the side that both forces point to: up "
        f"where both are positive ({len(positions['up'])}), down where both are negative "
        f"({len(positions['down'])})."
    )
    return evidence(right and path.events, finding, numbers)


def never_sticks(scene: Scene) -> Evidence:
    """Check that neither the motion from the printed start nor the periodic motion sticks."""
    path = motion(scene)
    orbit = orbit_of(scene)
    modes = sorted({segment.mode for segment in path.segments})
    motion_sticks = any(mode.startswith("belt") for mode in modes)
    orbit_sticks = not {"P1", "P4"}.isdisjoint(orbit.labels)
    count = len(sticks(scene))
    until = text(path.t_end, 6)
    _, velocities = orbit([float(orbit.period) * i / 2000 for i in range(2000)])
    numbers = {
        "modes of motion": ", ".join(map(mode_text, modes)),
        f"sticks, passages until t = {until}": f"{count}, {len(path.events)}",
        "velocities of the periodic motion": f"{velocities.min():.6g} to {velocities.max():.6g} "
        "(sampled)",
    }
    finding = (
        f"The motion has {count} sticks and {len(path.events)} passages of the boundary until t = "
        f"{until}; it is in {' and '.join(map(mode_text, modes))} only."
    )
    return Evidence(verdict(not motion_sticks and not orbit_sticks), finding, numbers)


def stick_parts(scene: Scene, label: str, count: int) -> Evidence:
    """Count the sticks `label` (P1 or P4) in one period of the periodic motion, and measure how
    long they last.
    """
    orbit = orbit_of(scene)
    ends = [*[point.t for point in orbit.points[1:]], orbit.points[0].t + orbit.period]
    durations = [
        end - point.t
        for mapping, point, end in zip(orbit.labels, orbit.points, ends, strict=True)
        if mapping == label
    ]
    numbers = {f"length of stick {i}": text(value, 20) for i, value in enumerate(durations, 1)}
    numbers["period"] = text(orbit.period, 20)
    finding = (
        f"One period of {subscripted(orbit.word)} has {len(durations)} parts {subscripted(label)}, "
        f"{' and '.join(text(value, 8) for value in durations)} long: "
        f"{100 * float(sum(durations) / orbit.period):.2f} % of the period."
    )
    return Evidence(verdict(len(durations) == count), finding, numbers)


def onsets(scene: Scene, belt: int) -> Evidence:
    """Check that the product of both forces is negative wherever the mass begins to stick, on the
    printed motion.
    """
    contacts = [stick.onset for stick in sticks(scene) if stick.belt == belt]
    pairs = [forces(scene.parameters, contact) for contact in contacts]
    products = [pair.product for pair in pairs]
    if not contacts:
        raise Refuted(f"There is no stick on belt {belt}.", {"sticks": "0"})
    names = force_names(*NEIGHBOURS[belt])
    shown = zip(contacts[:SHOWN_STICKS], pairs[:SHOWN_STICKS], strict=True)
    numbers = {
        f"{names} at t = {text(contact.t, 14)}": text((below, above), 12)
        for contact, (below, above, _) in shown
    } | {"lowest and highest product": text((min(products), max(products)), 10)}
    finding = (
        f"At all {len(contacts)} blue points the product is negative; the highest is "
        f"{text(max(products), 7)}."
    )
    return evidence(max(products) < 0, finding, numbers)


def ends(scene: Scene, belt: int) -> Evidence:
    """Check that one force vanishes where a stick ends, and that a flight into its domain follows."""
    ended = [stick for stick in sticks(scene) if stick.belt == belt and stick.end is not None]
    if not ended:
        raise Refuted(f"No stick on belt {belt} ends.", {"sticks": "0"})
    holds = True
    numbers = {}
    (lo, hi) = NEIGHBOURS[belt]
    names = force_names(lo, hi)
    for i, stick in enumerate(ended):
        below, above, _ = forces(scene.parameters, stick.end)
        forceless = [domain for domain, force in ((lo, below), (hi, above)) if is_zero(force)]
        holds = holds and [stick.into] == [f"Omega{domain}" for domain in forceless]
        if i < SHOWN_STICKS:
            numbers[f"{names} at t = {text(stick.end.t, 14)}, into"] = (
                f"{force_text(below, above)}, {mode_text(stick.into)}"
            )
    targets = [stick.into for stick in ended]
    exits = [
        (
            f"{targets.count(f'Omega{domain}')} times {force_names(domain)}, into "
            f"{mode_text(f'Omega{domain}')}"
        )
        for domain in (lo, hi)
    ]
    finding = (
        f"At all {len(ended)} green points one force is 0 and the mass slips into its domain: "
        f"{', and '.join(exits)}. Eq. ({EXIT_EQUATIONS[belt]}) of the paper knows "
        f"{force_names(hi)} only."
    )
    return evidence(holds, finding, numbers)


def closing_conditions(scene: Scene, closed: bool = False) -> Evidence:
    """Check whether eqs. (54) determine a periodic motion: as printed or, if `closed`, with closing
    conditions.
    """
    orbit = orbit_of(scene)
    p = scene.parameters
    Omega = number(p, p.Omega)
    count = len(orbit.labels)
    points = [(point.x, Omega * point.t) for point in orbit.points]
    (x, theta) = points[0]
    points.append((x, theta + Omega * orbit.period))
    # The unknowns are x and theta at the n + 1 points. Two rows for each mapping, (54), and two
    # that close the orbit: the last point is the first one, a period later.
    all_rows = np.zeros((2 * count + 2, 2 * count + 2))
    for i, label in enumerate(orbit.labels):
        block = jacobian(p, label, points[i], points[i + 1])  # 2 x 4: f1, f2 by both points
        all_rows[2 * i : 2 * i + 2, 2 * i : 2 * i + 4] = block.astype(float)
    all_rows[-2:, :2] = -np.eye(2)
    all_rows[-2:, -2:] = np.eye(2)
    if closed:
        printed = all_rows
    else:
        printed = all_rows[:-2]
    rank, full_rank = (int(np.linalg.matrix_rank(matrix)) for matrix in (printed, all_rows))
    contacts = [
        start_contact(scene, motion(scene).events[0].boundary),
        *scene_contacts(scene)[:count],
    ]
    residuals = []
    for label, (start, end) in zip(motion(scene).word[:count], pairwise(contacts), strict=True):
        f = residual(p, label, (start.x, Omega * start.t), (end.x, Omega * end.t))
        residuals.append(max(map(abs, f)))
    equations, unknowns = printed.shape
    free = unknowns - rank
    numbers = {
        f"unknowns and equations of (54) for {subscripted(orbit.word)}": f"{unknowns}, {equations}",
        "rank of its Jacobian at the orbit": str(rank),
        "rank with the closing conditions": str(full_rank),
        "largest residual of (54) on the motion from the printed start": text(max(residuals), 2),
        "x at the end of that motion's first round minus x₀": text(
            contacts[-1].x - contacts[0].x, 10
        ),
    }
    finding = (
        f"(54) leaves {free} of {unknowns} unknowns open. The motion from the printed start of "
        f"Fig. {scene.name.removeprefix('fig')} fulfils it, and is not periodic."
    )
    return Evidence(verdict(not free, full_rank == unknowns), finding, numbers)


# --- is the printed start on the periodic orbit, and if not, does one misprinted number explain it?
# ---


def start_on_orbit(scene: Scene) -> Evidence:
    """Compare the printed start, which is on a belt, with the switching points of the periodic
    motion.
    """
    orbit = orbit_of(scene)
    path = motion(scene)
    near = orbit.approach(scene, WITHIN)
    on_orbit = max(abs(near.dt), abs(near.dx)) <= LAST_HALF_UNIT
    period = float(orbit.period)
    name = subscripted(orbit.word)
    count = min(3, int((float(path.t_end) - float(path.t_start)) / period))
    states = [path(float(scene.t0) + i * period) for i in range(count + 1)]
    numbers = {
        "start minus nearest switching point: t, x": f"{near.dt:+.7f}, {near.dx:+.7f}",
        "half a unit of the last printed digit": f"{float(LAST_HALF_UNIT):g}",
        "start minus periodic motion at the same time: x, ẋ": f"{near.offset_x:+.7f}, "
        f"{near.offset_v:+.7f}",
        f"periods until x and ẋ are within {WITHIN:g} for good": str(near.periods),
        f"switching points of {name}: t, x": "; ".join(
            text((point.t, point.x), 9) for point in orbit.points
        ),
    }
    for i, (before, after) in enumerate(pairwise(states), 1):
        dx, dv = after - before
        numbers[f"change of x, ẋ over period {i}"] = f"{dx:+.5g}, {dv:+.5g}"
    if on_orbit:
        return Evidence(
            CONFIRMED,
            f"The start is on the periodic motion {name}, to all printed digits.",
            numbers,
        )
    if near.dt < 0:
        later = "later"
    else:
        later = "earlier"
    if near.dx < 0:
        higher = "higher"
    else:
        higher = "lower"
    finding = (
        f"The start is not on the periodic motion {name}, whose nearest switching point is "
        f"{abs(near.dt):.6f} {later} and {abs(near.dx):.6f} {higher} in x. The motion is within "
        f"{WITHIN:g} of it after {near.periods} period{'' if near.periods == 1 else 's'}."
    )
    return Evidence(NOT_AS_PRINTED, finding, numbers)


def start_or_misprint(scene: Scene) -> Evidence:
    """Compare the printed start with the orbit; if they differ, search for one misprinted number
    that explains it.
    """
    distance = start_on_orbit(scene)
    if distance.verdict == CONFIRMED:
        return distance
    start = search_start(scene)
    parameters = search_parameters(scene)
    numbers = dict(distance.numbers)
    candidates = [*parameters, *start]
    for near in candidates:
        numbers[f"{near.name} free"] = _nearest_text(near)
    numbers |= _end_of_stick(scene)
    free = (
        f"each of {len(parameters)} parameters and {len(start)} numbers of the start left free in "
        "turn"
    )
    explaining = " or ".join(
        f"{near.name} = {near.value:.5g}" for near in candidates if near.explains
    )
    if explaining:
        finding = (
            f"{distance.finding} With {free}: {explaining} puts the start on the orbit, to all "
            "printed digits."
        )
        return Evidence(CORRECTED, finding, numbers)
    best = min(candidates, key=lambda near: near.distance)
    finding = (
        f"{distance.finding} No single number explains the start. With {free}, parameters up to "
        f"{REACH} times the printed value, the motion misses the start after one period by "
        f"{best.distance:.4f} at least, in t or x (with {best.name} = {best.value:.5g}); an orbit "
        f"would have to go through it to within {float(LAST_HALF_UNIT)}."
    )
    for near in start:
        printed = f"{float(getattr(scene, near.name)):.4f}"
        orbit = f"{near.value:.4f}"
        digits = list(zip_longest(printed, orbit))
        if near.name != "v0" and sum(a != b for a, b in digits) == 1:
            finding += (
                f" The orbit's {near.name} = {orbit} differs from the printed {printed} in one "
                "digit, but the other number of the start does not agree."
            )
    return Evidence(NOT_AS_PRINTED, finding, numbers)


def _nearest_text(near: Nearest) -> str:
    """Return as text how near to a periodic motion one number, left free, brings the start."""
    if near.orbit:
        gap = "orbit minus start"
    else:
        gap = "misses the start after one period by"
    line = f"nearest at {near.value:.6g}: {gap} {near.dt:+.4f} in t, {near.dx:+.4f} in x"
    if near.name in PARAMETER_NAMES:
        low, high = near.searched
        line += f"; searched {low:.5g} to {high:.5g}"
    return line


def _end_of_stick(scene: Scene) -> dict[str, str]:
    """Return lines on m F^(2) at a start on belt 2, with and without the damping force c v2.

    It is 0 where a stick ends in domain 2.
    """
    p = scene.parameters
    if scene.v0 != p.v2:
        return {}
    theta = float(p.Omega * scene.t0)
    undamped = float(p.A(2) - p.k * scene.x0) + float(p.B0) * cos(theta)
    # By how much half a unit of the printed x0 and t0 changes the force.
    spread = float(LAST_HALF_UNIT) * (float(p.k) + abs(float(p.B0 * p.Omega) * sin(theta)))
    return {
        "m F⁽²⁾ at the start": f"{undamped - float(p.c * p.v2):+.4f} ± {spread:.4f} (0 at the end "
        "of a stick)",
        "m F⁽²⁾ without the damping c v₂": f"{undamped:+.4f} ± {spread:.4f}",
    }


# --- the search: a periodic motion comes back to its start after one period of the drive --- Every
# parameter is left free in turn: from the printed start, on its belt, one period is followed for
# many values, and between those next to the smallest misses the miss is minimised. A value explains
# the start if the orbit of the printed structure then goes through it. Then each number of the
# start is left free; the parameters stay as printed.

#: How far a parameter is varied: this many times its size (at least 1) both ways, as far as the
#: model allows.
REACH = 10
# The least of a parameter that must stay positive, as a part of its printed value (k = 0 has no
# orbit).
LEAST = 1e-3
# How many periods a motion is followed: the event at which it comes back can be late.
FOLLOWED = Fraction(5, 4)
# The smallest misses in whose neighbourhood is searched, and the miss below which the orbit itself
# is sought there.
VALLEYS = 3
ORBIT_NEAR = 0.002


@dataclass(frozen=True)
class Nearest:
    """The value of one number, all others as printed, with which the start comes nearest to a
    periodic motion.
    """

    name: str  # the parameter, or "t0", "x0", "v0", that is left free
    value: float
    # by how much the motion misses the start after one period; on an orbit, its switching point
    # minus the start
    dt: float
    dx: float
    orbit: bool = True  # whether dt and dx are those of an orbit of the printed structure
    searched: tuple[float, float] = (-inf, inf)  # the range of values that was tried

    @property
    def distance(self) -> float:
        """The distance from a periodic motion: the larger one of |dt| and |dx|."""
        return max(abs(self.dt), abs(self.dx))

    @property
    def explains(self) -> bool:
        """Whether with this value an orbit goes through the printed start, to half a unit of the
        start's last digit.
        """
        # With v0 free, x is compared at the printed t0, whose own rounding moves x by v times half
        # a unit.
        allowed = float(LAST_HALF_UNIT) * (1 + abs(self.value) if self.name == "v0" else 1)
        return self.orbit and self.distance <= allowed


def search_start(scene: Scene) -> list[Nearest]:
    """Return for each of t0, x0, v0 the value that alone brings the printed start nearest to the
    periodic orbit.
    """
    orbit = find_orbit(scene.parameters, str(scene.structure))
    t0 = float(scene.t0)
    x0 = float(scene.x0)
    gaps = _gaps(orbit, scene)

    # With t0 free, the best switching point is the one whose x is nearest; with x0 free, the one
    # whose t is. With v0 free, the orbit is taken at t0, wherever it is.
    def size_of_dt(gap: tuple[float, float]) -> float:
        dt, _ = gap
        return abs(dt)

    def size_of_dx(gap: tuple[float, float]) -> float:
        _, dx = gap
        return abs(dx)

    dt_free, dx_left = min(gaps, key=size_of_dx)
    dt_left, dx_free = min(gaps, key=size_of_dt)
    x, v = orbit(t0)
    return [
        Nearest("t0", t0 + dt_free, 0.0, dx_left),
        Nearest("x0", x0 + dx_free, dt_left, 0.0),
        Nearest("v0", float(v), 0.0, float(x) - x0),
    ]


def search_parameters(scene: Scene, names: tuple[str, ...] = PARAMETER_NAMES) -> list[Nearest]:
    """Return for each parameter the value with which an orbit is nearest to the printed start,
    nearest first.
    """
    return sorted(
        (_search_parameter(scene, name) for name in names), key=lambda near: near.distance
    )


def _search_parameter(scene: Scene, name: str) -> Nearest:
    """Return the value of one parameter for which the motion is nearest to a periodic orbit."""
    printed = float(getattr(scene.parameters, name))
    low, high = range_of(scene.parameters, name)
    # Values evenly spaced, and on each side ever closer to what is printed; the smallest misses are
    # minimised.
    closer = np.geomspace(LEAST, 1.0, 50)
    near = [printed - (printed - low) * closer, printed + (high - printed) * closer]
    values = np.unique(np.concatenate([np.linspace(low, high, 120), *near, [printed]]))
    misses = _misses(scene, name, values)
    sizes = np.abs(misses).max(axis=1)
    best = misses[sizes.argmin()]
    value = float(values[sizes.argmin()])
    is_orbit = False
    # Local minima: no larger than the neighbours, which the ends lack on one side.
    before = np.array([inf, *sizes[:-1]])
    after = np.array([*sizes[1:], inf])
    valleys = np.flatnonzero((sizes <= before) & (sizes <= after) & (sizes < inf))

    def miss_at(number: float) -> Any:
        (miss,) = _misses(scene, name, np.array([number]))
        return miss

    deepest = valleys[np.argsort(sizes[valleys])][:VALLEYS]
    for i in deepest:
        around = float(values[max(i - 1, 0)]), float(values[min(i + 1, len(values) - 1)])
        nearest, miss = _least(miss_at, around)
        if np.abs(miss).max() < ORBIT_NEAR:
            # So near that there is an orbit: its own distance from the start is smaller still.
            nearest, gap = _least(lambda number: _gap(scene, name, number), around)
            if np.abs(gap).max() < np.abs(best).max():
                best = gap
                value = nearest
                is_orbit = True
        elif np.abs(miss).max() < np.abs(best).max():
            best = miss
            value = nearest
    dt, dx = map(float, best)
    span = (float(values[0]), float(values[-1]))
    return Nearest(name, value, dt, dx, is_orbit, span)


def _least(
    miss: Callable[[float], np.ndarray], around: tuple[float, float]
) -> tuple[float, np.ndarray]:
    """Minimize max(|dt|, |dx|) of ``miss(number) = (dt, dx)`` in a range.

    Return the number, and (dt, dx) there.
    """

    def size(number: float) -> float:
        # Finite: the search lays parabolas through the values.
        return min(float(np.abs(miss(float(number))).max()), 1e9)

    number = float(minimize_scalar(size, bounds=around, method="bounded").x)
    return number, np.asarray(miss(number))


def range_of(p: Parameters, name: str) -> tuple[float, float]:
    """Return the range to search for a parameter: `REACH` times its size to both sides, but only
    values it may have.
    """
    value = float(getattr(p, name))
    margin = LEAST * float(p.v2 - p.v1)
    reach = REACH * max(1.0, abs(value))
    # Values that Parameters allows, and no degenerate ones.
    least = -inf
    most = inf
    if name in ("m", "k", "Omega"):
        least = LEAST * value
    elif name in ("c", "mu1", "mu2", "FN"):
        least = 0.0
    elif name == "v1":
        most = float(p.v2) - margin
    elif name == "v2":
        least = float(p.v1) + margin
    return max(value - reach, least), min(value + reach, most)


def _misses(scene: Scene, name: str, values: np.ndarray) -> np.ndarray:
    """Return, for each of a parameter's `values`, how far, (dt, dx), the motion misses its start
    after one period.
    """
    if scene.v0 == scene.parameters.v1:
        boundary = 1
    else:
        boundary = 2
    sets = [scene.parameters.replace(**{name: float(value)}) for value in values]
    periods = np.array([2 * pi / float(p.Omega) for p in sets])
    t0 = float(scene.t0)
    x0 = float(scene.x0)
    starts = [(scene.t0, scene.x0, p.belt(boundary)) for p in sets]
    # A few thousand short motions: compiling would take longer.
    table = simulate_many(
        sets, starts, t0 + float(FOLLOWED) * periods, accuracy=inf, use_numba=False
    )
    misses = np.full((len(values), 2), inf)
    dt = table.t - t0 - periods[table.trajectory]
    dx = table.x - x0
    size = np.where(table.boundary == boundary, np.maximum(np.abs(dt), np.abs(dx)), inf)
    # Each trajectory's events come from the farthest to the nearest, so that the nearest one stays.
    for row in np.lexsort((-size, table.trajectory)):
        if size[row] < inf:
            misses[table.trajectory[row]] = dt[row], dx[row]
    return misses


def _gap(scene: Scene, name: str, value: float) -> np.ndarray:
    """Return (dt, dx) from the printed start to the orbit's nearest point if `name` = `value`.

    Inf without an orbit.
    """
    try:
        orbit = find_orbit(scene.parameters.replace(**{name: value}), str(scene.structure))
    except SymoscError:
        return np.array([inf, inf])
    if not orbit.admissible:
        return np.array([inf, inf])
    return np.array(min(_gaps(orbit, scene), key=lambda gap: max(map(abs, gap))))


def _gaps(orbit: PeriodicOrbit, scene: Scene) -> list[tuple[float, float]]:
    """Return (dt, dx) from the printed start to each switching point, dt modulo the period."""
    period = float(orbit.period)
    points = np.array([(float(point.t), float(point.x)) for point in orbit.points])
    t, x = points.T
    dt = (t - float(scene.t0) + period / 2) % period - period / 2
    dx = x - float(scene.x0)
    return list(zip(dt.tolist(), dx.tolist(), strict=True))
