"""Section 5: switching planes, the eight mappings, and their governing equations (49) to (54)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import product
from math import pi, sqrt, tanh
from typing import Any

import numpy as np
from scipy.optimize import brentq

from symosc.mappings.equations import residual
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import NEIGHBOURS, Parameters
from symosc.paper.checks import dop853
from symosc.paper.checks.contacts import looked_at
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.rational_cases import contacts
from symosc.paper.evidence import CONFIRMED, CORRECTED, DEFINITION, NOT_AS_PRINTED, Evidence
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

MAPPED_SCENES = ("fig5", "fig6", "fig8", "fig9", "fig10", "fig7-exact", "fig8-exact")
FLIGHTS = ("P2", "P3", "P5", "P6", "P7", "P8")
MAPPED_EVENTS = 40
#: A residual that vanishes, relative to the size of its terms.
NO_RESIDUAL = 1e-11
#: Exact contacts that are looked through for ends of sticks.
EXIT_DOMAINS = 300
SIDE_NAMES = {-1: "below", 0: "on it", 1: "above"}


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


def stick_exit(p: Parameters, boundary: int, x: Any, cosine: Any) -> Any:
    """Eqs. (52) and (53): left side minus right side of the second equation, at the end of a stick."""
    number = (lambda value: value) if isinstance(x, Fraction) else float
    rest = number(p.A0) + number(p.B0) * cosine - number(p.k) * x - number(p.c * p.belt(boundary))
    if boundary == 1:
        return rest + number(p.mu2 * p.FN) - number(p.mu1 * p.FN)
    return rest - number(p.mu1 * p.FN) - number(p.mu2 * p.FN)


def printed_planes(speed: Any, delta: Any) -> tuple[Any, Any]:
    """Eq. (49): the expressions whose limits for delta -> 0 define v^- and v^+."""
    return speed - delta, speed + delta


# --- the motions ---


@cache
def _motions() -> tuple[tuple[str, Trajectory], ...]:
    return tuple((name, simulate(load_scene(name), max_events=MAPPED_EVENTS)) for name in MAPPED_SCENES)


def _segments() -> Iterator[tuple[str, Trajectory, Any, Any, Any]]:
    """Yield (scene, motion, segment, event at its start or None, event at its end) for segments between events."""
    for name, motion in _motions():
        starts = (None, *motion.events)
        for segment, start, end in zip(motion.segments, starts, motion.events, strict=False):
            yield name, motion, segment, start, end


# --- checks ---


def switching_planes() -> Evidence:
    """Eq. (49): three planes at each belt, by the motion that is there."""
    ends = Counter(end for pair in PLANES.values() for end in pair)
    numbers = {f"belt {belt}, {SIDE_NAMES[side]}: ends of mappings": str(count) for (belt, side), count in ends.items()}
    finding = f"{len(ends)} planes, three at each belt: what is there goes on below, on or above the belt's speed"
    return Evidence(DEFINITION if len(ends) == 6 else NOT_AS_PRINTED, f"{finding}.", numbers)


def planes_as_limits() -> Evidence:
    """Eq. (49) as it stands: v_lambda^- and v_lambda^+ as limits."""
    import sympy as sp

    speed, delta = sp.symbols("v_lambda delta", positive=True)
    limits = [sp.limit(expression, delta, 0, "+") for expression in printed_planes(speed, delta)]
    numbers = {f"limit that defines v_λ{sign}": str(limit) for sign, limit in zip("⁻⁺", limits, strict=True)}
    numbers["different planes among Σ⁰, Σ¹, Σ²"] = str(len({speed, *limits}))
    if len({speed, *limits}) == 3:
        return Evidence(CONFIRMED, "The three planes are different.", numbers)
    return Evidence(CORRECTED, "Both limits are v_λ, so that Σ⁰, Σ¹ and Σ² are one and the same set.", numbers)


def basic_mappings() -> Evidence:
    """Eqs. (50) and (51): every way from plane to plane through one domain, or on one belt, is one of the eight."""
    ways = {((belt, 0), (belt, 0)) for belt in NEIGHBOURS}
    for domain in (1, 2, 3):
        # The belts at a domain, and the side of them on which it is.
        planes = [(belt, -1 if domain == belt else 1) for belt, sides in NEIGHBOURS.items() if domain in sides]
        ways |= set(product(planes, planes))
    listed = set(PLANES.values())
    numbers = {
        "ways from plane to plane in one domain or on one belt": str(len(ways)),
        "mappings of (50)": str(len(PLANES)),
        "ways that (50) lacks": str(len(ways - listed)),
        "mappings of (50) that are no way": str(len(listed - ways)),
    }
    if ways == listed and len(PLANES) == len(ways):
        return Evidence(DEFINITION, f"(50) lists all {len(ways)} ways from plane to plane, each once.", numbers)
    return Evidence(NOT_AS_PRINTED, "(50) does not list all ways from plane to plane once.", numbers)


def trajectories_in_domains() -> Evidence:
    """Fig. 4: between its ends a trajectory is in one domain or on one belt; that is what a mapping is."""
    numbers = {}
    for label, (start, end) in PLANES.items():
        common = set(_domains(*start)) & set(_domains(*end))
        numbers[f"{label}: in between"] = ", ".join(f"Ω{domain}" for domain in sorted(common)) or f"belt {start[0]}"
    flights = [label for label in PLANES if numbers[f"{label}: in between"].count("Ω") == 1]
    finding = f"The planes at its ends leave one domain to each of {len(flights)} flights, and the belt to P₁ and P₄"
    return Evidence(DEFINITION if len(flights) == 6 else NOT_AS_PRINTED, f"{finding}.", numbers)


def _domains(belt: int, side: int) -> tuple[int, ...]:
    """Return the domain on a side of a belt, none for the belt itself."""
    return () if side == 0 else (NEIGHBOURS[belt][side > 0],)


# --- the ends of sticks ---


def _stick_exits(boundary: int, equation: int) -> Evidence:
    """Compare a printed end of sticks with the exact flow where one of the forces vanishes, and with a figure."""
    lo, hi = NEIGHBOURS[boundary]
    exits: Counter[int] = Counter()
    satisfied: Counter[int] = Counter()
    for contact in contacts(boundary, EXIT_DOMAINS, seed=50 + boundary):
        # The stick ends here: held so far by both forces, and the exact flow leaves the belt.
        slopes = {alpha: contact.slope(alpha) for alpha in (lo, hi)}
        if contact.force(lo) == 0 > contact.force(hi) and slopes[lo] < 0:
            left = lo
        elif contact.force(hi) == 0 < contact.force(lo) and slopes[hi] > 0:
            left = hi
        else:
            continue
        if contact.next_mode != f"Omega{left}":
            raise ArithmeticError(f"the exact flow goes on in {contact.next_mode}")
        exits[left] += 1
        satisfied[left] += stick_exit(contact.p, boundary, contact.x, contact.c) == 0
    numbers = {
        f"exact ends of sticks into Ω{alpha}; ({equation}) holds": f"{exits[alpha]}; {satisfied[alpha]}"
        for alpha in (lo, hi)
    }
    numbers |= _first_exit(boundary, equation)
    total, right = sum(exits.values()), sum(satisfied.values())
    if right == total and total:
        return Evidence(CONFIRMED, f"({equation}) holds at all {total} ends of sticks.", numbers)
    finding = f"({equation}) holds at {satisfied[hi]} of {exits[hi]} exact ends of sticks with F({hi}) = 0, and at "
    finding += f"{satisfied[lo]} of {exits[lo]} with F({lo}) = 0, where the mass leaves as well, into Ω{lo}"
    return Evidence(NOT_AS_PRINTED, f"{finding}.", numbers)


def _first_exit(boundary: int, equation: int) -> dict[str, str]:
    """Say how the first stick of Fig. 5 or 6 ends, by scipy's DOP853 and by the roots of the forces on the belt."""
    scene = load_scene("fig5" if boundary == 1 else "fig6")
    p, name = scene.parameters, f"Fig. {4 + boundary}"
    t, x = float(scene.t0), float(scene.x0)
    if scene.v0 != p.belt(boundary):
        t, x = dop853.reaches(p, p.A(1), t, (x, float(scene.v0)), float(p.belt(boundary)))

    def forces(elapsed: Any) -> dict[int, Any]:
        place, phase = x + float(p.belt(boundary)) * elapsed, np.cos(float(p.Omega) * (t + elapsed))
        rest = float(p.B0) * phase - float(p.k) * place - float(p.c * p.belt(boundary))
        return {alpha: (float(p.A(alpha)) + rest) / float(p.m) for alpha in NEIGHBOURS[boundary]}

    lo, hi = NEIGHBOURS[boundary]
    grid = np.linspace(0.0, 20.0, 4001)
    along = forces(grid)
    last = int(np.argmax((along[lo] < 0) | (along[hi] > 0)))
    left = lo if along[lo][last] < 0 else hi
    end = float(brentq(lambda elapsed: forces(elapsed)[left], grid[last - 1], grid[last], xtol=1e-13))
    printed = stick_exit(p, boundary, x + float(p.belt(boundary)) * end, np.cos(float(p.Omega) * (t + end)))
    return {
        f"{name}: first stick begins, ends at t": f"{t:.9g}, {t + end:.9g}",
        f"{name}: F({lo}), F({hi}) at its end": ", ".join(f"{value + 0.0:.6g}" for value in _clean(forces(end))),
        f"{name}: left side of ({equation}) minus right side there": f"{float(printed):.6g}",
    }


def _clean(values: dict[int, float]) -> list[float]:
    return [0.0 if abs(value) < 1e-10 else value for value in values.values()]


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
    right = right and max(worst.values()) < NO_RESIDUAL and max(other.values()) < dop853.DOP853_AGREEMENT
    finding = f"f₁ = f₂ = 0 at the ends of {sum(counts.values())} flights of six kinds, to {max(worst.values()):.1g}"
    finding += f"; by DOP853 to {max(other.values()):.1g}"
    return Evidence(CONFIRMED if right else NOT_AS_PRINTED, f"{finding}.", numbers)


def four_grazes() -> Evidence:
    """Before Theorem 7: four cases of grazing, those of P2, P3, P5 and P6."""
    pairs = sorted((domain, boundary) for boundary, sides in NEIGHBOURS.items() for domain in sides)
    of_maps = sorted((row.domain, row.boundary) for row in PLACES.values())
    grazes: Counter[tuple[int, int]] = Counter()
    for boundary in NEIGHBOURS:
        for contact in contacts(boundary, EXIT_DOMAINS, seed=60 + boundary):
            grazes.update((alpha, boundary) for alpha in NEIGHBOURS[boundary] if contact.grazes(alpha))
    numbers = {
        "pairs of a domain and a boundary that it has": str(len(pairs)),
        "of them the place of P₂, P₃, P₅ or P₆": str(sum(pair in of_maps for pair in pairs)),
    }
    numbers |= {f"exact grazes of belt {belt} from Ω{domain}": str(grazes[domain, belt]) for domain, belt in pairs}
    right = pairs == of_maps == sorted(grazes) and len(pairs) == 4
    finding = f"{len(pairs)} pairs of domain and boundary, one for each of P₂, P₃, P₅ and P₆; each of them can graze"
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


@flown_again
def bounded_motions() -> Evidence:
    """Section 5: three bounded motions in the three unbounded domains; and what becomes of that without a damper."""
    within = total = 0
    numbers = {}
    for name in ("fig5", "fig6", "fig8", "fig9", "fig10"):
        scene = load_scene(name)
        period = 2 * pi / float(scene.parameters.Omega)
        motion = looked_at(simulate(scene, t_end=float(scene.t0) + 30 * period, max_events=2000))
        late = np.linspace(
            float(motion.t_start) + 0.5 * (float(motion.t_end) - float(motion.t_start)), float(motion.t_end), 400
        )
        reach, bound = float(np.abs(motion(late)[0]).max()), position_bound(scene.parameters)
        total, within = total + 1, within + (reach <= bound)
        numbers[f"{name}: largest |x| in the second half of 30 periods, bound"] = f"{reach:.4g}, {bound:.4g}"
    numbers["bound"] = "lim sup |x| ≤ (M/k) coth(πζ/(2√(1 − ζ²))), M the sum of all forces"
    growth = _growth(load_scene("fig8").parameters.replace(c=0, mu1="0.1", mu2="0.1", FN=10, B0=16))
    swings = ", ".join(f"{value:.4g}" for value in growth)
    numbers["undamped at resonance, c = 0, Ω² = k/m: largest |x| in periods 10, 20, 40"] = swings
    finding = f"{within} of {total} motions of the figures stay within the bound that the damper gives"
    if within < total:
        return Evidence(NOT_AS_PRINTED, f"{finding}.", numbers)
    finding += ", which holds for every motion with c, k > 0 (one kind in each of three domains)"
    if growth[1] > 1.5 * growth[0] and growth[2] > 1.5 * growth[1]:
        finding += f". Without a damper, at resonance, the swings grow: {swings}"
    return Evidence(CONFIRMED, f"{finding}.", numbers)


def _growth(p: Parameters) -> list[float]:
    """Return the largest |x| in the 10th, 20th and 40th period of a motion from rest."""
    period = 2 * pi / float(p.Omega)
    motion = simulate(p, t0=0, x0=0, v0=0, t_end=41 * period, max_events=400)
    return [float(np.abs(motion(np.linspace(n * period, (n + 1) * period, 200))[0]).max()) for n in (10, 20, 40)]
