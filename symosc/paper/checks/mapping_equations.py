"""Section 5: switching planes, the eight mappings, and their governing equations (49) to (54)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import cache
from math import pi, sqrt, tanh
from typing import Any

import numpy as np

from symosc.mappings.equations import residual
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import SIDES, Parameters
from symosc.paper.checks import dop853
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, Evidence
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

SCENES = ("fig5", "fig6", "fig8", "fig9", "fig10", "fig7-exact", "fig8-exact")
FLIGHTS = ("P2", "P3", "P5", "P6", "P7", "P8")
EVENTS = 40
#: A residual that vanishes, relative to the size of its terms.
ZERO = 1e-11
#: Fractions of a flight at which its domain is looked at, and how long before and after an event.
INSIDE = np.linspace(0.01, 0.99, 25)


# --- what the paper prints ---

#: Eqs. (50) and (51): belt and side at the start and at the end (0 on the belt, -1 below, 1 above its speed).
PLANES = {
    "P1": ((1, 0), (1, 0)),
    "P2": ((1, -1), (1, -1)),
    "P3": ((1, 1), (1, 1)),
    "P4": ((2, 0), (2, 0)),
    "P5": ((2, -1), (2, -1)),
    "P6": ((2, 1), (2, 1)),
    "P7": ((2, -1), (1, 1)),
    "P8": ((1, 1), (2, -1)),
}


def stick_exit(p: Parameters, boundary: int, x: float, phase: float) -> float:
    """Eqs. (52) and (53): left side minus right side of the second equation, at the end of a stick."""
    rest = float(p.A0) + float(p.B0) * np.cos(phase) - float(p.k) * x - float(p.c * p.belt(boundary))
    if boundary == 1:
        return rest + float(p.mu2 * p.FN) - float(p.mu1 * p.FN)
    return rest - float(p.mu1 * p.FN) - float(p.mu2 * p.FN)


# --- the motions ---


@cache
def _motions() -> tuple[tuple[str, Trajectory], ...]:
    return tuple((name, simulate(load_scene(name), max_events=EVENTS)) for name in SCENES)


def _segments() -> Iterator[tuple[str, Trajectory, Any, Any, Any]]:
    """Yield (scene, motion, segment, event at its start or None, event at its end) for segments between events."""
    for name, motion in _motions():
        starts = (None, *motion.events)
        for segment, start, end in zip(motion.segments, starts, motion.events, strict=False):
            yield name, motion, segment, start, end


def _scale(p: Parameters, x: float) -> float:
    """Return the size of the terms of a force."""
    return float(abs(p.A0) + abs(p.B0) + p.k * abs(int(x) + 1) + (p.mu1 + p.mu2) * p.FN)


# --- checks ---


def switching_planes() -> Evidence:
    """Eq. (49): every event has the speed of a belt, and is on one of three sides of it."""
    sides: Counter[str] = Counter()
    worst, events = 0.0, 0
    for _, motion in _motions():
        for event in motion.events:
            speed = float(motion.parameters.belt(event.boundary))
            worst = max(
                worst, abs(float(event.v) - speed), abs(motion(float(event.t))[1] - speed) / max(1.0, abs(speed))
            )
            events += 1
            for mode in (event.source, event.target):
                number = 0 if mode.startswith("belt") else -1 if int(mode[-1]) == event.boundary else 1
                sides[f"Sigma^{ {0: 0, -1: 1, 1: 2}[number] }_({event.boundary})"] += 1
    numbers = {"events": str(events), "largest |ẋ − v_λ|, relative": f"{worst:.2g}"}
    numbers |= {f"ends of stretches in {plane}": str(sides[plane]) for plane in sorted(sides)}
    right = worst < ZERO and len(sides) == 6
    finding = (
        f"All {events} events have the speed of a belt; as ends of motions they are on {len(sides)} planes, three "
    )
    finding += "at each belt, which differ by the side only"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def basic_mappings() -> Evidence:
    """Eqs. (50) and (51): every stretch between two events is one of the eight mappings."""
    found: Counter[str] = Counter()
    other = 0
    for _, _, segment, start, end in _segments():
        if start is None and not segment.mode.startswith("belt"):
            continue  # a start between the belts
        ends = _end(start, segment.mode) if start else (int(segment.mode[-1]), 0), _end(end, segment.mode)
        matching = [label for label, planes in PLANES.items() if planes == ends]
        other += len(matching) != 1
        found.update(matching)
    numbers = {f"stretches that are {label}": str(found[label]) for label in PLANES}
    numbers["stretches that are none or several of the eight"] = str(other)
    right = not other and set(found) == set(PLANES) and len(PLANES) == 8
    finding = f"{sum(found.values())} stretches between events: each is one of P₁ to P₈, and each of these occurs"
    if right:
        return Evidence(CONFIRMED, f"{finding}.", numbers)
    missing = ", ".join(sorted(set(PLANES) - set(found))) or "none"
    return Evidence(NOT_AS_PRINTED, f"{other} stretches are no mapping of (50); mappings not seen: {missing}.", numbers)


def _end(event: Any, mode: str) -> tuple[int, int]:
    """Return belt and side of an end of a stretch in `mode`."""
    if mode.startswith("belt"):
        return event.boundary, 0
    return event.boundary, -1 if int(mode[-1]) == event.boundary else 1


def trajectories_in_domains() -> Evidence:
    """Fig. 4: between its ends the trajectory of a mapping stays in its domain, or on its belt."""
    outside = looked = 0
    for _, motion, segment, start, _ in _segments():
        if start is None or float(segment.t_end) - float(segment.t_start) < 1e-6:
            continue
        t = float(segment.t_start) + INSIDE * (float(segment.t_end) - float(segment.t_start))
        v, p = motion(t)[1], motion.parameters
        looked += len(t)
        if segment.mode.startswith("belt"):
            off = np.abs(v - float(p.belt(int(segment.mode[-1])))) > ZERO * max(1.0, float(np.abs(v).max()))
        else:
            edges = -np.inf, float(p.v1), float(p.v2), np.inf
            alpha = int(segment.mode[-1])
            off = (v <= edges[alpha - 1]) | (v >= edges[alpha])
        outside += int(off.sum())
    numbers = {"points between the ends of mappings": str(looked), "outside the domain or off the belt": str(outside)}
    finding = f"{outside} of {looked} points between the ends of mappings are outside their domain"
    return Evidence(NOT_AS_PRINTED if outside or not looked else CONFIRMED, f"{finding}.", numbers)


def _stick_exits(boundary: int, equation: int) -> Evidence:
    """Compare a printed end of sticks with the ends of simulated ones."""
    lo, hi = SIDES[boundary]
    exits: Counter[str] = Counter()
    satisfied: Counter[str] = Counter()
    by_scene: Counter[tuple[str, str]] = Counter()
    worst_place = worst_both = 0.0
    largest: tuple[float, str] = (0.0, "none")
    for name, motion, segment, _, end in _segments():
        if segment.mode != f"belt{boundary}" or end.kind != "slip":
            continue
        p = motion.parameters
        first = np.atleast_1d(motion(float(segment.t_start)))[0]
        x, scale = float(end.x), _scale(p, float(end.x))
        place = x - first - float(p.belt(boundary)) * (float(end.t) - float(segment.t_start))
        worst_place = max(worst_place, abs(place) / max(1.0, abs(x)))
        printed = stick_exit(p, boundary, x, float(end.theta))
        exits[end.target] += 1
        by_scene[name, end.target] += 1
        satisfied[end.target] += abs(printed) < ZERO * scale
        both = min(abs(float(motion.force(alpha, float(end.t)) * float(p.m))) for alpha in (lo, hi))
        worst_both = max(worst_both, both / scale)
        if abs(printed) > max(largest[0], ZERO * scale):
            largest = abs(printed), f"{name}, t = {float(end.t):.10g}, into {end.target}: {printed:.6g} instead of 0"
    total, right = sum(exits.values()), sum(satisfied.values())
    numbers = {"sticks that end": str(total)}
    for target in sorted(exits):
        scenes = ", ".join(f"{count} in {name}" for (name, into), count in sorted(by_scene.items()) if into == target)
        numbers[f"into {target}"] = f"{exits[target]} ({scenes})"
        numbers[f"into {target}: ({equation}) satisfied"] = f"{satisfied[target]} of {exits[target]}"
    numbers |= {
        f"largest residual of ({equation})": largest[1],
        f"largest min(|F({lo})|, |F({hi})|) m at the ends, relative": f"{worst_both:.2g}",
        "largest residual of x = v_λ (t − tᵢ) + xᵢ, relative": f"{worst_place:.2g}",
    }
    if max(worst_place, worst_both) > ZERO or not total:
        return Evidence(NOT_AS_PRINTED, "Some sticks end where neither force is 0.", numbers)
    finding = f"({equation}) holds at {right} of {total} ends of sticks; at the others F({lo}) = 0, the exit into "
    finding += f"Ω{lo} that it lacks"
    if right == total:
        return Evidence(CONFIRMED, f"({equation}) holds at all {total} ends of sticks.", numbers)
    return Evidence(NOT_AS_PRINTED, f"{finding}.", numbers)


def stick_exit_belt1() -> Evidence:
    """Eq. (52): where a stick on belt 1 ends."""
    return _stick_exits(1, 52)


def stick_exit_belt2() -> Evidence:
    """Eq. (53): where a stick on belt 2 ends."""
    return _stick_exits(2, 53)


def governing_equations() -> Evidence:
    """Eq. (54): f1 and f2 of the flights vanish at the events of simulated motions; so they do for DOP853."""
    worst: dict[str, float] = dict.fromkeys(FLIGHTS, 0.0)
    other: dict[str, float] = dict.fromkeys(FLIGHTS, 0.0)
    counts: Counter[str] = Counter()
    for _, motion, segment, start, end in _segments():
        label = segment.label
        if start is None or label not in FLIGHTS:
            continue
        p, counts[label] = motion.parameters, counts[label] + 1
        Omega = float(p.Omega)
        points = (float(start.x), Omega * float(start.t)), (float(end.x), Omega * float(end.t))
        f1, f2 = residual(p, label, *points)
        size = max(1.0, abs(points[1][0])), max(1.0, abs(float(end.v)))
        worst[label] = max(worst[label], abs(f1) / size[0], abs(f2) / size[1])
        if counts[label] > 3:
            continue
        alpha, span = int(segment.mode[-1]), (float(start.t), float(end.t))
        _, states = dop853.flight(p, p.A(alpha), span, (float(start.x), float(start.v)))
        gaps = abs(states[0, -1] - float(end.x)) / size[0], abs(states[1, -1] - float(end.v)) / size[1]
        other[label] = max(other[label], *map(float, gaps))
    numbers = {label: f"{counts[label]} flights, largest |f₁|, |f₂| {worst[label]:.2g}, by DOP853 {other[label]:.2g}"
               for label in FLIGHTS}  # fmt: skip
    right = all(counts[label] for label in FLIGHTS)
    right = right and max(worst.values()) < ZERO and max(other.values()) < dop853.DOP853_AGREEMENT
    finding = f"f₁ = f₂ = 0 at the ends of {sum(counts.values())} flights of six kinds, to {max(worst.values()):.1g}"
    finding += f"; by DOP853 to {max(other.values()):.1g}"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def four_grazes() -> Evidence:
    """Before Theorem 7: four cases of grazing, those of P2, P3, P5 and P6."""
    pairs = sorted((domain, boundary) for boundary, sides in SIDES.items() for domain in sides)
    of_maps = sorted((row.domain, row.boundary) for row in PLACES.values())
    grazes: Counter[str] = Counter()
    returning = 0
    for name in ("fig7-exact", "fig8-exact"):
        for event in simulate(load_scene(name), max_events=8).events:
            if event.kind == "graze":
                grazes[f"{event.source} at belt {event.boundary}"] += 1
                returning += event.source == event.target
    numbers = {
        "pairs of a domain and a boundary that it has": str(len(pairs)),
        "of them the place of P₂, P₃, P₅ or P₆": str(sum(pair in of_maps for pair in pairs)),
        "grazes of fig7-exact and fig8-exact": ", ".join(f"{key}: {count}" for key, count in sorted(grazes.items())),
        "of them back into the same domain": str(returning),
    }
    right = pairs == of_maps and len(pairs) == 4 and returning == sum(grazes.values()) > 0
    finding = f"{len(pairs)} pairs of domain and boundary, one for each of P₂, P₃, P₅ and P₆"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def position_bound(p: Parameters) -> float:
    """Return what |x| comes down to in the long run, from the L1 norm of the impulse response; c, k > 0.

    Friction and drive together stay below a force M; then lim sup |x| <= (M/k) coth(pi zeta/(2 sqrt(1 - zeta^2))), or
    M/k without oscillation.
    """
    force = float(abs(p.A0) + abs(p.B0) + (p.mu1 + p.mu2) * p.FN)
    damping = float(p.c) / (2 * sqrt(p.k * p.m))
    if damping >= 1:
        return force / float(p.k)
    return force / float(p.k) / tanh(pi * damping / (2 * sqrt(1 - damping**2)))


def bounded_motions() -> Evidence:
    """Section 5: three bounded motions in the three unbounded domains; and what becomes of that without a damper."""
    within = total = 0
    numbers = {}
    for name in ("fig5", "fig6", "fig8", "fig9", "fig10"):
        scene = load_scene(name)
        period = 2 * pi / float(scene.parameters.Omega)
        motion = simulate(scene, t_end=float(scene.t0) + 30 * period, max_events=2000)
        late = np.linspace(
            float(motion.t_start) + 0.5 * (float(motion.t_end) - float(motion.t_start)), float(motion.t_end), 400
        )
        reach, bound = float(np.abs(motion(late)[0]).max()), position_bound(scene.parameters)
        total, within = total + 1, within + (reach <= bound)
        numbers[f"{name}: largest |x| in the second half of 30 periods, bound"] = f"{reach:.4g}, {bound:.4g}"
    growth = _growth(load_scene("fig8").parameters.replace(c=0, mu1="0.1", mu2="0.1", FN=10, B0=16))
    swings = ", ".join(f"{value:.4g}" for value in growth)
    numbers["undamped at resonance, c = 0, Ω² = k/m: largest |x| in periods 10, 20, 40"] = swings
    unbounded = growth[1] > 1.5 * growth[0] and growth[2] > 1.5 * growth[1]
    finding = f"{within} of {total} motions of the figures stay within the bound that the damper gives"
    if within < total:
        return Evidence(NOT_AS_PRINTED, f"{finding}.", numbers)
    if unbounded:
        finding += f"; without a damper, at resonance, the swings grow: {swings}"
        return Evidence(CORRECTED, f"{finding}.", numbers)
    return Evidence(CONFIRMED, f"{finding}.", numbers)


def _growth(p: Parameters) -> list[float]:
    """Return the largest |x| in the 10th, 20th and 40th period of a motion from rest."""
    period = 2 * pi / float(p.Omega)
    motion = simulate(p, t0=0, x0=0, v0=0, t_end=41 * period, max_events=400)
    return [float(np.abs(motion(np.linspace(n * period, (n + 1) * period, 200))[0]).max()) for n in (10, 20, 40)]
