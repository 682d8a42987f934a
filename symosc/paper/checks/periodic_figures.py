"""Checks of Figs. 9 and 10: periodic motions without sticks (P32) and with sticks (P4645)."""

from __future__ import annotations

from functools import cache
from itertools import cycle, pairwise

from symosc.mappings.equations import residual
from symosc.model import NEIGHBOURS
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.paper.checks.contacts import (
    CONTACT_DIGITS,
    NO_FORCE,
    SceneContact,
    contacts,
    force_name,
    force_text,
    forces,
    is_zero,
    looked_at,
    lowered,
    mode_text,
    motion,
    number,
    start_contact,
    sticks,
    text,
    verdict,
)
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.grazing_figures import LAST_HALF_UNIT
from symosc.paper.checks.proven import certificate_of
from symosc.paper.checks.stick_figures import sticks_at_start
from symosc.paper.evidence import NOT_AS_PRINTED, Evidence
from symosc.scenes import Scene, load_scene
from symosc.words import read_word

WITHIN = 1e-4


def orbit_of(scene: Scene) -> PeriodicOrbit | None:
    """Return the periodic orbit of a scene's structure with 30 digits, or None if there is none."""
    found = _orbit_of(scene)
    return None if found is None else looked_at(found)


@cache
def _orbit_of(scene: Scene) -> PeriodicOrbit | None:
    try:
        found = find_orbit(scene.parameters, str(scene.structure), digits=CONTACT_DIGITS)
    except ConvergenceError:
        return None
    return found if found.admissible else None


def no_orbit(scene: Scene) -> Evidence:
    """Return the evidence that a structure has no orbit: what the motion does instead."""
    numbers = {"mappings from the printed start": " ".join(motion(scene).word[-8:]) or "none"}
    return Evidence(verdict(False), f"There is no periodic motion {lowered(str(scene.structure))}.", numbers)


# --- the periodic motion, and the start ---


@flown_again
def fig9_orbit() -> Evidence:
    """Check that the parameters of Fig. 9 have a periodic motion P32."""
    return orbit_exists(load_scene("fig9"))


@flown_again
def fig10_orbit() -> Evidence:
    """Check that the parameters of Fig. 10 have a periodic motion P4645."""
    return orbit_exists(load_scene("fig10"))


def orbit_exists(scene: Scene) -> Evidence:
    """Solve the closing equations (54) of the structure and check every inequality that makes the root a motion."""
    found, name = orbit_of(scene), lowered(str(scene.structure))
    if found is None:
        return no_orbit(scene)
    margin = min(found.conditions(), key=lambda condition: condition.value)
    finding = (
        f"{name} exists: it has the period of the excitation, {text(found.period, 10)}, all {len(found.conditions())} "
        f"inequalities hold, and it is {'stable' if found.stable else 'unstable'} (largest |multiplier| "
        f"{float(abs(found.multipliers[0])):.6g})."
    )
    numbers = {
        f"{i + 1}. {lowered(label)} starts at t, x": f"{text(point.t, 22)}, {text(point.x, 22)}"
        for i, (label, point) in enumerate(zip(found.labels, found.points, strict=True))
    }
    numbers |= {
        "largest residual of (54)": text(found.residual, 2),
        "smallest margin of an inequality": f"{margin.value:.6g} ({margin.text})",
        "distance from grazing, as a velocity": f"{found.grazing_distance:.6g}",
        "|multipliers|": ", ".join(f"{float(abs(value)):.8g}" for value in found.multipliers),
    }
    numbers |= certificate_of(found)
    return Evidence(verdict(found.periods == 1 and found.stable is True), finding, numbers)


def start_on_orbit(scene: Scene) -> Evidence:
    """Compare the printed start, which is on a belt, with the switching points of the periodic motion."""
    found = orbit_of(scene)
    if found is None:
        return no_orbit(scene)
    near = found.approach(scene, WITHIN)
    on_orbit = max(abs(near.dt), abs(near.dx)) <= LAST_HALF_UNIT
    path, period = motion(scene), float(found.period)
    count = min(3, int((float(path.t_end) - float(path.t_start)) / period))
    states = [path(float(scene.t0) + i * period) for i in range(count + 1)]
    numbers = {
        "start minus nearest switching point: t, x": f"{near.dt:+.7f}, {near.dx:+.7f}",
        "half a unit of the last printed digit": f"{float(LAST_HALF_UNIT):g}",
        "start minus periodic motion at the same time: x, ẋ": f"{near.offset_x:+.7f}, {near.offset_v:+.7f}",
        f"periods until x and ẋ are within {WITHIN:g} for good": str(near.periods),
        f"switching points of {lowered(found.word)}: t, x": "; ".join(
            f"{text(point.t, 9)}, {text(point.x, 9)}" for point in found.points
        ),
    }
    for i, (before, after) in enumerate(pairwise(states)):
        dx, dv = after - before
        numbers[f"change of x, ẋ over period {i + 1}"] = f"{dx:+.5g}, {dv:+.5g}"
    name = f"the periodic motion {lowered(found.word)}"
    finding = f"The start is on {name}, to all printed digits."
    if not on_orbit:
        later, higher = "later" if near.dt < 0 else "earlier", "higher" if near.dx < 0 else "lower"
        finding = (
            f"The start is not on {name}, whose nearest switching point is {abs(near.dt):.6f} {later} and "
            f"{abs(near.dx):.6f} {higher} in x. The motion is within {WITHIN:g} of it after "
            f"{near.periods} period{'' if near.periods == 1 else 's'}."
        )
    return Evidence(verdict(on_orbit), finding, numbers)


# --- the order of the mappings ---


@flown_again
def fig9_word() -> Evidence:
    """Check that P2 and P3 follow each other without a gap: their switching is continuous."""
    return in_order(load_scene("fig9"))


@flown_again
def fig10_word() -> Evidence:
    """Check that the mappings come in the order P5, P4, P6, P4."""
    return in_order(load_scene("fig10"))


def in_order(scene: Scene) -> Evidence:
    """Check the order of the mappings from the start, and with (54) that each starts where the last one ended."""
    p, path, at = scene.parameters, motion(scene), contacts(scene)
    points = [start_contact(scene, path.events[0].boundary), *at]
    Omega, word = number(p, p.Omega), path.word
    expected = cycle(read_word(scene.structure).labels) if scene.structure else cycle([""])
    ordered = bool(word) and all(label == next(expected) for label in word)
    worst = 0 * Omega
    for segment, (start, end) in zip(path.segments, pairwise(points), strict=False):
        if segment.label:
            off = residual(p, segment.label, (start.x, Omega * start.t), (end.x, Omega * end.t))
            worst = max([worst, *map(abs, off)])
    crossings = [forces(p, point) for point, event in zip(at, path.events, strict=True) if event.kind == "cross"]
    numbers = {
        "mappings in order of time": lowered(" ".join(word)) or "none",
        "largest residual f₁, f₂ of (54) from each switching point to the next": text(worst, 2),
    }
    named = f"the structure {lowered(scene.structure)}" if ordered else "not the order of the structure"
    finding = (
        f"From the start on the mappings are {', '.join(lowered(label) for label in word[:5])}, …: {named}, "
        f"{len(word)} mappings long. Each begins where the last one ends: x and ẋ are continuous"
    )
    if crossings:
        jump = max(abs(each.below - each.above) for each in crossings)
        numbers["jump of the acceleration where the mass crosses"] = text(jump, 12)
        finding += f"; the acceleration jumps, by {text(jump, 6)}"
    return Evidence(verdict(bool(ordered and worst < NO_FORCE)), finding + ".", numbers)


# --- Fig. 9: passing ---


@flown_again
def fig9_product() -> Evidence:
    """Check F(1) x F(2) > 0 at the switching points."""
    return products_positive(load_scene("fig9"), 1)


def switching_points(scene: Scene, belt: int) -> list[SceneContact]:
    """Return the switching points at a belt: of the motion from the printed start, that start, and of the orbit."""
    points = [at for at in contacts(scene) if at.belt == belt]
    if scene.v0 == scene.parameters.belt(belt):
        points.insert(0, start_contact(scene, belt))
    found = orbit_of(scene)
    if found is not None:
        Omega = number(scene.parameters, scene.parameters.Omega)
        for piece, point in zip(found.equations().pieces, found.points, strict=True):
            if piece.start == belt:
                points.append(SceneContact(belt, point.t, point.x, Omega * point.t))
    return points


def products_positive(scene: Scene, belt: int) -> Evidence:
    """Check that both forces have one sign at every switching point (Theorem 5)."""
    points, (lo, hi) = switching_points(scene, belt), NEIGHBOURS[belt]
    both = [forces(scene.parameters, at) for at in points]
    if not both:
        return Evidence(verdict(False), "There is no switching point.", {"switching points": "0"})
    products = [each.product for each in both]
    numbers = {"switching points (start, motion, periodic motion)": str(len(points))}
    numbers["lowest and highest product"] = f"{text(min(products), 10)}, {text(max(products), 10)}"
    for at, each in list(zip(points, both, strict=True))[-2:]:
        name = f"{force_name(lo)}, {force_name(hi)} at t = {text(at.t, 12)} (periodic motion)"
        numbers[name] = f"{text(each.below, 12)}, {text(each.above, 12)}"
    held = min(products) > 0
    finding = (
        f"At {'all' if held else 'not all'} {len(points)} switching points the product is positive; the smallest is "
        f"{text(min(products), 8)}."
    )
    return Evidence(verdict(bool(held)), finding, numbers)


@flown_again
def fig9_passes() -> Evidence:
    """Check that the motion passes through the boundary, to the side that both forces point to."""
    return passes(load_scene("fig9"), 1)


def passes(scene: Scene, belt: int) -> Evidence:
    """Check that every contact is a crossing in the direction of both forces, as Theorem 5 says."""
    p, path = scene.parameters, motion(scene)
    lo, hi = (f"Omega{domain}" for domain in NEIGHBOURS[belt])
    rows: dict[str, list[SceneContact]] = {"up": [], "down": []}
    right = True
    for at, event in zip(contacts(scene), path.events, strict=True):
        each = forces(p, at)
        way = "up" if each.below > 0 and each.above > 0 else "down" if each.below < 0 and each.above < 0 else ""
        to = {"up": (lo, hi), "down": (hi, lo)}.get(way)
        right = right and event.kind == "cross" and (event.source, event.target) == to
        if way:
            rows[way].append(at)
    numbers = {}
    for way, found in rows.items():
        if found:
            places = sorted(at.x for at in found)
            numbers[f"passages {way}: number, x from, to"] = (
                f"{len(found)}, {text(places[0], 9)}, {text(places[-1], 9)}"
            )
    numbers["contacts"] = str(len(path.events))
    finding = (
        f"{'All' if right else 'Not all'} {len(path.events)} contacts are passages to the side that both forces "
        f"point to: up where both are positive ({len(rows['up'])}), down where both are negative ({len(rows['down'])})."
    )
    return Evidence(verdict(bool(right and path.events)), finding, numbers)


@flown_again
def fig9_no_stick() -> Evidence:
    """Check that there is no stick in the phase plane."""
    return never_sticks(load_scene("fig9"))


def never_sticks(scene: Scene) -> Evidence:
    """Check that neither the motion from the printed start nor the periodic motion sticks."""
    path, found = motion(scene), orbit_of(scene)
    modes = sorted({segment.mode for segment in path.segments})
    none = not any(mode.startswith("belt") for mode in modes) and found is not None
    numbers = {"modes of motion": ", ".join(mode_text(mode) for mode in modes)}
    numbers["sticks, passages until t = " + text(path.t_end, 6)] = f"{len(sticks(scene))}, {len(path.events)}"
    if found is not None:
        none = none and not {"P1", "P4"} & set(found.labels)
        velocities = found([float(found.period) * i / 2000 for i in range(2000)])[1]
        numbers["velocities of the periodic motion"] = f"{velocities.min():.6g} to {velocities.max():.6g} (sampled)"
    finding = (
        f"The motion has {len(sticks(scene))} sticks and {len(path.events)} passages of the boundary until t = "
        f"{text(path.t_end, 6)}; it is in {' and '.join(mode_text(mode) for mode in modes)} only."
    )
    return Evidence(verdict(none), finding, numbers)


# --- Fig. 10: sticks ---


@flown_again
def fig10_stick_appears() -> Evidence:
    """Check that the stick on the boundary 23 appears from the initial conditions."""
    return stick_appears(load_scene("fig10"), 2)


def stick_appears(scene: Scene, belt: int) -> Evidence:
    """Check that a stick appears on a belt, at the start or later."""
    at_start = sticks_at_start(scene, belt)
    appears = at_start.verdict != NOT_AS_PRINTED
    return Evidence(verdict(appears), at_start.finding, at_start.numbers)


@flown_again
def fig10_two_sticks() -> Evidence:
    """Check that the periodic motion has two stick parts."""
    return stick_parts(load_scene("fig10"), "P4", 2)


def stick_parts(scene: Scene, label: str, count: int) -> Evidence:
    """Count the sticks in one period of the periodic motion."""
    found = orbit_of(scene)
    if found is None:
        return no_orbit(scene)
    ends = [*[point.t for point in found.points[1:]], found.points[0].t + found.period]
    lasts = [end - point.t for each, point, end in zip(found.labels, found.points, ends, strict=True) if each == label]
    numbers = {f"length of stick {i + 1}": text(value, 20) for i, value in enumerate(lasts)}
    numbers["period"] = text(found.period, 20)
    part = 100 * float(sum(lasts) / found.period)
    finding = (
        f"One period of {lowered(found.word)} has {len(lasts)} parts {lowered(label)}, "
        f"{' and '.join(text(value, 8) for value in lasts)} long: {part:.2f} % of the period."
    )
    return Evidence(verdict(len(lasts) == count), finding, numbers)


@flown_again
def fig10_onsets() -> Evidence:
    """Check F(2) x F(3) < 0 at the blue points."""
    return onsets(load_scene("fig10"), 2)


def onsets(scene: Scene, belt: int) -> Evidence:
    """Check the force product where the mass begins to stick, on the printed motion up to its end."""
    p, (lo, hi) = scene.parameters, NEIGHBOURS[belt]
    found = [stick for stick in sticks(scene) if stick.belt == belt]
    if not found:
        return Evidence(verdict(False), f"There is no stick on belt {belt}.", {"sticks": "0"})
    both = [forces(p, stick.onset) for stick in found]
    products = [each.product for each in both]
    numbers = {}
    for stick, each in list(zip(found, both, strict=True))[:4]:
        name = f"{force_name(lo)}, {force_name(hi)} at t = {text(stick.onset.t, 14)}"
        numbers[name] = f"{text(each.below, 12)}, {text(each.above, 12)}"
    numbers["lowest and highest product"] = f"{text(min(products), 10)}, {text(max(products), 10)}"
    held = max(products) < 0
    how = "all" if held else "not all"
    finding = f"At {how} {len(found)} blue points the product is negative; the highest is {text(max(products), 7)}."
    return Evidence(verdict(bool(held)), finding, numbers)


@flown_again
def fig10_ends() -> Evidence:
    """Check F(2) x F(3) = 0 at the green points, and that a non-stick motion begins there."""
    return ends(load_scene("fig10"), 2)


def ends(scene: Scene, belt: int) -> Evidence:
    """Check that one force vanishes where a stick ends, and that a flight into its domain follows."""
    p, (lo, hi) = scene.parameters, NEIGHBOURS[belt]
    found = [(stick, stick.end) for stick in sticks(scene) if stick.belt == belt and stick.end is not None]
    if not found:
        return Evidence(verdict(False), f"No stick on belt {belt} ends.", {"sticks": "0"})
    held, into = True, []
    numbers = {}
    for i, (stick, end) in enumerate(found):
        at = forces(p, end)
        free = [domain for domain, force in ((lo, at.below), (hi, at.above)) if is_zero(force)]
        held = held and len(free) == 1 and stick.into == f"Omega{free[0]}"
        into.append(str(stick.into))
        if i < 4:
            name = f"{force_name(lo)}, {force_name(hi)} at t = {text(end.t, 14)}, into"
            numbers[name] = f"{force_text(at.below)}, {force_text(at.above)}, {mode_text(stick.into)}"
    counts = {domain: into.count(f"Omega{domain}") for domain in (lo, hi)}
    finding = (
        f"At all {len(found)} green points one force is 0 and the mass slips into its domain: {counts[lo]} times "
        f"{force_name(lo)}, into {mode_text(f'Omega{lo}')}, and {counts[hi]} times {force_name(hi)}, into "
        f"{mode_text(f'Omega{hi}')}. Eq. ({51 + belt}) of the paper knows {force_name(hi)} only."
        if held
        else "Not at all green points exactly one force is 0."
    )
    return Evidence(verdict(held), finding, numbers)
