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
WITHIN = 1e-4


def orbit_of(scene: Scene) -> PeriodicOrbit:
    """Return the periodic orbit of the word that a scene names, with 30 digits.

    Raise Refuted if there is none.
    """
    if found := _orbit_of(scene):
        return recorded(found)
    numbers = {"mappings from the printed start": " ".join(motion(scene).word[-8:]) or "none"}
    raise Refuted(f"There is no periodic motion {subscripted(scene.structure)}.", numbers)


@cache
def _orbit_of(scene: Scene) -> PeriodicOrbit | None:
    try:
        found = find_orbit(scene.parameters, str(scene.structure), digits=CONTACT_DIGITS)
    except ConvergenceError:
        return None
    if found.admissible:
        return found
    return None


def orbit_exists(scene: Scene) -> Evidence:
    """Solve (54), closed after one period, for the scene's word.

    Check all inequalities that the orbit must fulfil.
    """
    found = orbit_of(scene)
    conditions = orbit_of(scene).conditions()
    margin = min(conditions, key=lambda condition: condition.value)
    finding = (
        f"{subscripted(scene.structure)} exists: it has the period of the excitation, "
        f"{text(found.period, 10)}, "
    )
    finding += (
        f"all {len(conditions)} inequalities hold, and it is "
        f"{'stable' if found.stable else 'unstable'} "
    )
    finding += f"(largest |multiplier| {float(abs(found.multipliers[0])):.6g})."
    numbers = {
        f"{i}. {subscripted(label)} starts at t, x": text((point.t, point.x), 22)
        for i, (label, point) in enumerate(zip(found.labels, found.points, strict=True), 1)
    } | {
        "largest residual of (54)": text(found.residual, 2),
        "smallest margin of an inequality": f"{margin.value:.6g} ({margin.text})",
        "distance from grazing, as a velocity": f"{found.grazing_distance:.6g}",
        "|multipliers|": text((float(abs(value)) for value in found.multipliers), 8),
    }
    return Evidence(
        verdict(found.periods == 1 and found.stable is True),
        finding,
        numbers | certificate_of(found),
    )


def in_order(scene: Scene) -> Evidence:
    """Check that the motion follows the scene's word, and by (54) that each mapping starts where
    the last one ended.
    """
    p = scene.parameters
    path = motion(scene)
    at = scene_contacts(scene)
    points = [start_contact(scene, path.events[0].boundary), *at]
    Omega = number(p, p.Omega)
    word = path.word
    if scene.structure:
        labels = read_word(scene.structure).labels
    else:
        labels = ()
    # The start may be anywhere on the orbit.
    turns = [cycle(labels[i:] + labels[:i]) for i in range(len(labels))]
    ordered = bool(word) and any(all(map(eq, word, turn)) for turn in turns)
    worst = 0 * Omega
    for segment, (start, end) in zip(path.segments, pairwise(points), strict=False):
        if segment.label:
            rest = residual(p, segment.label, (start.x, Omega * start.t), (end.x, Omega * end.t))
            worst = max([worst, *map(abs, rest)])
    crossings = [
        forces(p, point)
        for point, event in zip(at, path.events, strict=True)
        if event.kind == "cross"
    ]
    numbers = {
        "mappings in order of time": subscripted(" ".join(word)) or "none",
        "largest residual f₁, f₂ of (54) from each switching point to the next": text(worst, 2),
    }
    first = ", ".join(map(subscripted, word[:5]))
    finding = (
        f"From the start on the mappings are {first}, …: the structure "
        f"{subscripted(scene.structure)}, "
    )
    finding += (
        f"{len(word)} mappings long. Each begins where the last one ends: x and ẋ are continuous"
    )
    if crossings:
        jump = max(abs(each.below - each.above) for each in crossings)
        numbers["jump of the acceleration where the mass crosses"] = text(jump, 12)
        finding += f"; the acceleration jumps, by {text(jump, 6)}"
    return evidence(ordered and worst < NO_FORCE, finding + ".", numbers)


def products_positive(scene: Scene, belt: int) -> Evidence:
    """Check that both forces have one sign at every switching point (Theorem 5), of the motion and
    of the orbit.
    """
    p = scene.parameters
    found = orbit_of(scene)
    if scene.v0 == p.belt(belt):
        points = [start_contact(scene, belt)]
    else:
        points = []
    points += [at for at in scene_contacts(scene) if at.belt == belt]
    for piece, point in zip(found.equations().pieces, found.points, strict=True):
        if piece.start == belt:
            points.append(SceneContact(belt, point.t, point.x, number(p, p.Omega) * point.t))
    both = [forces(p, at) for at in points]
    products = [each.product for each in both]
    numbers = {
        "switching points (start, motion, periodic motion)": str(len(points)),
        "lowest and highest product": text((min(products), max(products)), 10),
    }
    names = force_names(*NEIGHBOURS[belt])
    for at, each in list(zip(points, both, strict=True))[-2:]:
        numbers[f"{names} at t = {text(at.t, 12)} (periodic motion)"] = text(each[:2], 12)
    least = text(min(products), 8)
    finding = (
        f"At all {len(points)} switching points the product is positive; the smallest is {least}."
    )
    return evidence(min(products) > 0, finding, numbers)


def passes(scene: Scene, belt: int) -> Evidence:
    """Check that every contact is a crossing in the direction of both forces, as Theorem 5 says."""
    p = scene.parameters
    path = motion(scene)
    (lo, hi) = NEIGHBOURS[belt]
    places: dict[str, list[SceneContact]] = {"up": [], "down": []}
    right = True
    for at, event in zip(scene_contacts(scene), path.events, strict=True):
        below, above, _ = forces(p, at)
        if below > 0 and above > 0:
            way = "up"
        elif below < 0 and above < 0:
            way = "down"
        else:
            way = ""
        to = {"up": (f"Omega{lo}", f"Omega{hi}"), "down": (f"Omega{hi}", f"Omega{lo}")}.get(way)
        right = right and event.kind == "cross" and (event.source, event.target) == to
        if way:
            places[way].append(at.x)
    numbers = {
        f"passages {way}: number, x from, to": f"{len(found)}, {text((min(found), max(found)), 9)}"
        for way, found in places.items()
        if found
    } | {"contacts": str(len(path.events))}
    finding = (
        f"All {len(path.events)} contacts are passages to the side that both forces point to: up "
        "where both are "
    )
    finding += (
        f"positive ({len(places['up'])}), down where both are negative ({len(places['down'])})."
    )
    return evidence(right and path.events, finding, numbers)


def never_sticks(scene: Scene) -> Evidence:
    """Check that neither the motion from the printed start nor the periodic motion sticks."""
    path = motion(scene)
    found = orbit_of(scene)
    modes = sorted({segment.mode for segment in path.segments})
    none = not any(mode.startswith("belt") for mode in modes) and not {"P1", "P4"} & set(
        found.labels
    )
    count = len(sticks(scene))
    until = text(path.t_end, 6)
    velocities = found([float(found.period) * i / 2000 for i in range(2000)])[1]
    numbers = {
        "modes of motion": ", ".join(map(mode_text, modes)),
        f"sticks, passages until t = {until}": f"{count}, {len(path.events)}",
        "velocities of the periodic motion": f"{velocities.min():.6g} to {velocities.max():.6g} "
        "(sampled)",
    }
    finding = (
        f"The motion has {count} sticks and {len(path.events)} passages of the boundary until t = "
        f"{until}; it is "
    )
    finding += f"in {' and '.join(map(mode_text, modes))} only."
    return Evidence(verdict(none), finding, numbers)


def stick_parts(scene: Scene, label: str, count: int) -> Evidence:
    """Count the sticks `label` (P1 or P4) in one period of the periodic motion, and measure how
    long they last.
    """
    found = orbit_of(scene)
    ends = [*[point.t for point in found.points[1:]], found.points[0].t + found.period]
    lasts = [
        end - point.t
        for each, point, end in zip(found.labels, found.points, ends, strict=True)
        if each == label
    ]
    numbers = {f"length of stick {i}": text(value, 20) for i, value in enumerate(lasts, 1)}
    numbers["period"] = text(found.period, 20)
    finding = (
        f"One period of {subscripted(found.word)} has {len(lasts)} parts {subscripted(label)}, "
    )
    finding += (
        f"{' and '.join(text(value, 8) for value in lasts)} long: "
        f"{100 * float(sum(lasts) / found.period):.2f} "
    )
    finding += "% of the period."
    return Evidence(verdict(len(lasts) == count), finding, numbers)


def onsets(scene: Scene, belt: int) -> Evidence:
    """Check that the product of both forces is negative wherever the mass begins to stick, on the
    printed motion.
    """
    found = [stick.onset for stick in sticks(scene) if stick.belt == belt]
    both = [forces(scene.parameters, at) for at in found]
    products = [each.product for each in both]
    if not found:
        raise Refuted(f"There is no stick on belt {belt}.", {"sticks": "0"})
    names = force_names(*NEIGHBOURS[belt])
    numbers = {
        f"{names} at t = {text(at.t, 14)}": text(each[:2], 12)
        for at, each in zip(found[:4], both[:4], strict=True)
    } | {"lowest and highest product": text((min(products), max(products)), 10)}
    finding = (
        f"At all {len(found)} blue points the product is negative; the highest is "
        f"{text(max(products), 7)}."
    )
    return evidence(max(products) < 0, finding, numbers)


def ends(scene: Scene, belt: int) -> Evidence:
    """Check that one force vanishes where a stick ends, and that a flight into its domain follows."""
    found = [stick for stick in sticks(scene) if stick.belt == belt and stick.end is not None]
    if not found:
        raise Refuted(f"No stick on belt {belt} ends.", {"sticks": "0"})
    held = True
    numbers = {}
    names = force_names(*NEIGHBOURS[belt])
    for i, stick in enumerate(found):
        both = forces(scene.parameters, stick.end)[:2]
        free = [
            domain for domain, force in zip(NEIGHBOURS[belt], both, strict=True) if is_zero(force)
        ]
        held = held and [stick.into] == [f"Omega{domain}" for domain in free]
        if i < 4:
            numbers[f"{names} at t = {text(stick.end.t, 14)}, into"] = (
                f"{force_text(*both)}, {mode_text(stick.into)}"
            )
    into = [stick.into for stick in found]
    ways = [
        (
            f"{into.count(f'Omega{domain}')} times {force_names(domain)}, into "
            f"{mode_text(f'Omega{domain}')}"
        )
        for domain in NEIGHBOURS[belt]
    ]
    finding = (
        f"At all {len(found)} green points one force is 0 and the mass slips into its domain: "
    )
    finding += (
        f"{', and '.join(ways)}. Eq. ({51 + belt}) of the paper knows "
        f"{force_names(NEIGHBOURS[belt][1])} only."
    )
    return evidence(held, finding, numbers)


def closing_conditions(scene: Scene, closed: bool = False) -> Evidence:
    """Check whether eqs. (54) determine a periodic motion: as printed or, if `closed`, with closing
    conditions.
    """
    found = orbit_of(scene)
    p = scene.parameters
    Omega = number(p, p.Omega)
    count = len(found.labels)
    points = [(point.x, Omega * point.t) for point in found.points]
    points.append((points[0][0], points[0][1] + Omega * found.period))
    rows = np.zeros((2 * count + 2, 2 * count + 2))
    for i, label in enumerate(found.labels):
        rows[2 * i : 2 * i + 2, 2 * i : 2 * i + 4] = jacobian(
            p, label, points[i], points[i + 1]
        ).astype(float)
    rows[-2:, :2] = -np.eye(2)
    rows[-2:, -2:] = np.eye(2)
    if closed:
        printed = rows
    else:
        printed = rows[: 2 * count]
    rank, full = (int(np.linalg.matrix_rank(matrix)) for matrix in (printed, rows))
    at = [start_contact(scene, motion(scene).events[0].boundary), *scene_contacts(scene)[:count]]
    rest = [
        max(map(abs, residual(p, label, (a.x, Omega * a.t), (b.x, Omega * b.t))))
        for label, (a, b) in zip(motion(scene).word[:count], pairwise(at), strict=True)
    ]
    unknowns = printed.shape[1]
    free = printed.shape[1] - rank
    numbers = {
        f"unknowns and equations of (54) for {subscripted(found.word)}": f"{unknowns}, "
        f"{printed.shape[0]}",
        "rank of its Jacobian at the orbit": str(rank),
        "rank with the closing conditions": str(full),
        "largest residual of (54) on the motion from the printed start": text(max(rest), 2),
        "x at the end of that motion's first round minus x₀": text(at[-1].x - at[0].x, 10),
    }
    finding = (
        f"(54) leaves {free} of {unknowns} unknowns open. The motion from the printed start of "
        "Fig. "
    )
    finding += f"{scene.name.removeprefix('fig')} fulfils it, and is not periodic."
    return Evidence(verdict(not free, full == unknowns), finding, numbers)


# --- is the printed start on the periodic orbit, and if not, does one misprinted number explain it?
# ---


def start_on_orbit(scene: Scene) -> Evidence:
    """Compare the printed start, which is on a belt, with the switching points of the periodic
    motion.
    """
    found = orbit_of(scene)
    path = motion(scene)
    near = found.approach(scene, WITHIN)
    on_orbit = max(abs(near.dt), abs(near.dx)) <= LAST_HALF_UNIT
    period = float(found.period)
    name = subscripted(found.word)
    count = min(3, int((float(path.t_end) - float(path.t_start)) / period))
    states = [path(float(scene.t0) + i * period) for i in range(count + 1)]
    numbers = {
        "start minus nearest switching point: t, x": f"{near.dt:+.7f}, {near.dx:+.7f}",
        "half a unit of the last printed digit": f"{float(LAST_HALF_UNIT):g}",
        "start minus periodic motion at the same time: x, ẋ": f"{near.offset_x:+.7f}, "
        f"{near.offset_v:+.7f}",
        f"periods until x and ẋ are within {WITHIN:g} for good": str(near.periods),
        f"switching points of {name}: t, x": "; ".join(
            text((point.t, point.x), 9) for point in found.points
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
        f"{abs(near.dt):.6f} "
    )
    finding += (
        f"{later} and {abs(near.dx):.6f} {higher} in x. The motion is within {WITHIN:g} of it "
        "after "
    )
    finding += f"{near.periods} period{'' if near.periods == 1 else 's'}."
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
    found = [*parameters, *start]
    for each in found:
        if each.orbit:
            what = "orbit minus start"
        else:
            what = "misses the start after one period by"
        value = f"nearest at {each.value:.6g}: {what} {each.dt:+.4f} in t, {each.dx:+.4f} in x"
        if each.name in PARAMETER_NAMES:
            value += f"; searched {each.searched[0]:.5g} to {each.searched[1]:.5g}"
        numbers[f"{each.name} free"] = value
    numbers |= _end_of_stick(scene)
    free = (
        f"each of {len(parameters)} parameters and {len(start)} numbers of the start left free in "
        "turn"
    )
    explaining = " or ".join(f"{each.name} = {each.value:.5g}" for each in found if each.explains)
    if explaining:
        finding = (
            f"{distance.finding} With {free}: {explaining} puts the start on the orbit, to all "
            "printed digits."
        )
        return Evidence(CORRECTED, finding, numbers)
    best = min(found, key=lambda each: each.distance)
    finding = (
        f"{distance.finding} No single number explains the start. With {free}, parameters up to "
        f"{REACH} times "
    )
    finding += (
        f"the printed value, the motion misses the start after one period by {best.distance:.4f} "
        "at least, in t "
    )
    finding += (
        f"or x (with {best.name} = {best.value:.5g}); an orbit would have to go through it to "
        "within "
    )
    finding += f"{float(LAST_HALF_UNIT)}."
    for each in start:
        printed = f"{float(getattr(scene, each.name)):.4f}"
        orbit = f"{each.value:.4f}"
        if each.name != "v0" and [a == b for a, b in zip_longest(printed, orbit)].count(False) == 1:
            finding += (
                f" The orbit's {each.name} = {orbit} differs from the printed {printed} in one "
                "digit"
            )
            finding += ", but the other number of the start does not agree."
    return Evidence(NOT_AS_PRINTED, finding, numbers)


def _end_of_stick(scene: Scene) -> dict[str, str]:
    """Return m F^(2), which is 0 where a stick ends, at a start on belt 2, with and without the
    damping force c v2.
    """
    p = scene.parameters
    if scene.v0 != p.v2:
        return {}
    theta = float(p.Omega * scene.t0)
    known = float(p.A(2) - p.k * scene.x0) + float(p.B0) * cos(theta)
    spread = float(LAST_HALF_UNIT) * (float(p.k) + abs(float(p.B0 * p.Omega) * sin(theta)))
    return {
        "m F⁽²⁾ at the start": f"{known - float(p.c * p.v2):+.4f} ± {spread:.4f} (0 at the end "
        "of a stick)",
        "m F⁽²⁾ without the damping c v₂": f"{known:+.4f} ± {spread:.4f}",
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
    dt, off_x = min(gaps, key=lambda gap: abs(gap[1]))
    off_t, dx = min(gaps, key=lambda gap: abs(gap[0]))
    x, v = orbit(t0)
    return [
        Nearest("t0", t0 + dt, 0.0, off_x),
        Nearest("x0", x0 + dx, off_t, 0.0),
        Nearest("v0", float(v), 0.0, float(x) - x0),
    ]


def search_parameters(scene: Scene, names: tuple[str, ...] = PARAMETER_NAMES) -> list[Nearest]:
    """Return for each parameter the value with which an orbit is nearest to the printed start,
    nearest first.
    """
    return sorted(
        (_search_parameter(scene, name) for name in names), key=lambda each: each.distance
    )


def _search_parameter(scene: Scene, name: str) -> Nearest:
    """Return the value of one parameter for which the motion is nearest to a periodic orbit."""
    value = float(getattr(scene.parameters, name))
    (low, high) = range_of(scene.parameters, name)
    # Values evenly spaced, and on each side ever closer to what is printed; the smallest misses are
    # minimised.
    closer = np.geomspace(LEAST, 1.0, 50)
    near = [value - (value - low) * closer, value + (high - value) * closer]
    values = np.unique(np.concatenate([np.linspace(low, high, 120), *near, [value]]))
    misses = _misses(scene, name, values)
    sizes = np.abs(misses).max(axis=1)
    best = misses[sizes.argmin()]
    value = float(values[sizes.argmin()])
    orbit = False
    padded = np.array([inf, *sizes, inf])
    valleys = np.flatnonzero((sizes <= padded[:-2]) & (sizes <= padded[2:]) & (sizes < inf))
    for i in valleys[np.argsort(sizes[valleys])][:3]:
        around = float(values[max(i - 1, 0)]), float(values[min(i + 1, len(values) - 1)])
        at, miss = _least(lambda number: _misses(scene, name, np.array([number]))[0], around)
        if np.abs(miss).max() < 0.002:
            exact, gap = _least(lambda number: _gap(scene, name, number), around)
            if np.abs(gap).max() < np.abs(best).max():
                best = gap
                value = exact
                orbit = True
        elif np.abs(miss).max() < np.abs(best).max():
            best = miss
            value = at
    return Nearest(
        name, value, float(best[0]), float(best[1]), orbit, (float(values[0]), float(values[-1]))
    )


def _least(
    miss: Callable[[float], np.ndarray], around: tuple[float, float]
) -> tuple[float, np.ndarray]:
    """Minimize max(|dt|, |dx|) of ``miss(number) = (dt, dx)`` in a range.

    Return the number, and (dt, dx) there.
    """

    def size(number: float) -> float:
        return min(
            float(np.abs(miss(float(number))).max()), 1e9
        )  # parabolas through infinite values are none

    found = minimize_scalar(size, bounds=around, method="bounded")
    return float(found.x), np.asarray(miss(float(found.x)))


def range_of(p: Parameters, name: str) -> tuple[float, float]:
    """Return the range to search for a parameter: `REACH` times its size to both sides, but only
    values it may have.
    """
    value = float(getattr(p, name))
    margin = LEAST * float(p.v2 - p.v1)
    reach = REACH * max(1.0, abs(value))
    least = {
        "m": LEAST * value,
        "k": LEAST * value,
        "Omega": LEAST * value,
        "v2": float(p.v1) + margin,
    }
    least |= dict.fromkeys(("c", "mu1", "mu2", "FN"), 0.0)
    if name == "v1":
        most = float(p.v2) - margin
    else:
        most = inf
    return max(value - reach, least.get(name, -inf)), min(value + reach, most)


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
    for row in np.lexsort(
        (-size, table.trajectory)
    ):  # the last one of each trajectory is the nearest
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
    dt = (points[:, 0] - float(scene.t0) + period / 2) % period - period / 2
    return list(zip(dt.tolist(), (points[:, 1] - float(scene.x0)).tolist(), strict=True))
