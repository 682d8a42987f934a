"""Checks of what follows the grazes: the "simple periodic motion" of Fig. 7 and the stick of Fig. 8."""

from __future__ import annotations

from fractions import Fraction
from math import hypot, pi

import numpy as np

from symosc.paper.checks.contacts import lowered, mode_text, motion, number, text, verdict
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.grazing_figures import (
    LAST_HALF_UNIT,
    LATE,
    Graze,
    exact,
    fig7,
    fig8,
    print_is_right,
    steady_square,
)
from symosc.paper.checks.stick_figures import flight_after, forces_hold, together
from symosc.paper.evidence import Evidence
from symosc.scenes import Scene
from symosc.simulation.trajectory import Trajectory

# --- Fig. 7 ---


@flown_again
def fig7_periodic() -> Evidence:
    """Check that the grazing motion is a simple periodic one."""
    return periodic(fig7())


@flown_again
def fig7_same_point() -> Evidence:
    """Check that the blue point and the green one, a period later, are the same in the phase plane."""
    return same_point(fig7())


def returns(scene: Scene, periods: int) -> list[tuple[float, float]]:
    """Return by how much x and v have changed from one blue point to the next, one period of the excitation later."""
    period = 2 * pi / float(scene.parameters.Omega)
    times = float(scene.t0) + period * np.arange(periods + 1)
    states = motion(scene, LATE)(times)
    return [(float(dx), float(dv)) for dx, dv in np.diff(states, axis=1).T]


def same_point(figure: Graze) -> Evidence:
    """Compare the states at t0 and one period later, from the exact start and from the printed one."""
    dx, dv = returns(exact(figure), 1)[0]
    path = motion(exact(figure), LATE)
    blue, green = path(float(path.t_start)), path(float(path.t_start) + 2 * pi / float(figure.parameters.Omega))
    raw = returns(figure.printed, 1)[0]
    same = max(abs(dx), abs(dv)) <= LAST_HALF_UNIT
    numbers = {
        "x, ẋ at the blue point": f"{text(blue[0], 10)}, {text(blue[1], 10)}",
        "x, ẋ at the green point": f"{text(green[0], 10)}, {text(green[1], 10)}",
        "differences": f"{text(dx, 10)}, {text(dv, 10)}",
        "differences with all numbers as printed": f"{text(raw[0], 10)}, {text(raw[1], 10)}",
    }
    finding = (
        f"One period after the start the mass is at (x, ẋ) = ({text(green[0], 7)}, {text(green[1], 7)}), and it was at "
        f"({text(blue[0], 7)}, {text(blue[1], 7)}): {'one point' if same else 'two points'} of the phase plane."
    )
    return Evidence(verdict(max(abs(raw[0]), abs(raw[1])) <= LAST_HALF_UNIT, same), finding, numbers)


def periodic(figure: Graze) -> Evidence:
    """Check whether the motion is periodic, or approaches one; and whether the periodic motion can graze."""
    p, count = figure.parameters, 4
    changes = [hypot(*each) for each in returns(exact(figure), count)]
    fixed = changes[0] <= LAST_HALF_UNIT
    factor = changes[-1] / changes[-2] if changes[-2] > 0 else 0.0
    square, level = steady_square(p), p.belt(figure.belt) ** 2
    approaches = factor < 1 and motion(exact(figure), LATE).segments[-1].mode == "Omega1"
    numbers = {f"change of (x, ẋ) over period {i + 1}": text(change, 8) for i, change in enumerate(changes)}
    numbers["ratio of the last two changes"] = text(factor, 8)
    numbers["square of the steady velocity amplitude, of v₁"] = f"{text(square)}, {text(level)}"
    detuning = (p.B0 * p.Omega) ** 2 / level - (p.c * p.Omega) ** 2
    numbers["(k − mΩ²)²; for a periodic motion that just touches v₁"] = (
        f"{text((p.k - p.m * p.Omega**2) ** 2)}; {text(detuning)}"
    )
    what = "periodic" if fixed else "not periodic"
    what += ", but approaching a periodic motion" if approaches and not fixed else ""
    finding = (
        f"(x, ẋ) changes by {text(changes[0], 6)} over the first period, by {text(changes[1], 6)} over the next: "
        f"{what}. The periodic motion has the velocity amplitude √{text(square)} = {text(float(square) ** 0.5, 5)} "
        f"and {'can' if square >= level else 'never can'} touch v₁ = {text(p.v1)}, whatever A₀ is."
    )
    return Evidence(verdict(fixed, approaches), finding, numbers)


@flown_again
def fig7_no_other_grazing_point() -> Evidence:
    """Check that the velocities at the blue and the green point are not equal to the belt's."""
    return not_at_belt([fig7().printed, exact(fig7())], 1)


def not_at_belt(scenes: list[Scene], belt: int) -> Evidence:
    """Check that the velocity differs from the belt's at the start and one period later."""
    numbers, gaps = {}, []
    for scene, name in zip(scenes, ("as printed", "A₀ = 10, exact start"), strict=False):
        level, period = float(scene.parameters.belt(belt)), 2 * pi / float(scene.parameters.Omega)
        velocities = [float(motion(scene, LATE)(t)[1]) for t in (float(scene.t0), float(scene.t0) + period)]
        gaps += [abs(v - level) for v in velocities]
        numbers[f"ẋ at the blue and the green point, {name}"] = ", ".join(text(v, 10) for v in velocities)
    finding = (
        f"The velocities differ from v{lowered(belt)} by {text(min(gaps), 6)} or more: these are no grazing points."
    )
    return Evidence(verdict(min(gaps) > LAST_HALF_UNIT), finding, numbers)


# --- the stick after the graze of Fig. 8 ---


@flown_again
def fig8_again() -> Evidence:
    """Check that after the graze the velocity reaches the boundary again, at the blue point, and sticks."""
    return sticks_later(fig8())


def sticks_later(figure: Graze) -> Evidence:
    """Check that the contact that follows the red point is the onset of a stick on the same belt, for both starts."""
    numbers, held, times = {}, True, []
    for name, scene in (("printed start", figure.printed), ("exact start", exact(figure))):
        events = [e for e in motion(scene).events if e.kind != "slip"]
        following = events[1] if len(events) > 1 else None
        held = held and following is not None and following.kind == "stick" and following.boundary == figure.belt
        if following is not None:
            times.append(following.t)
            numbers[f"t, x of the next contact, {name}"] = f"{text(following.t, 16)}, {text(following.x, 12)}"
    if len(times) < 2:
        numbers["contacts after the red point"] = str(len(times))
        return Evidence(verdict(False), "No contact follows.", numbers)
    what = f"sticks to belt {figure.belt}" if held else "does something else"
    finding = (
        f"The next contact is at t = {text(times[1], 11)} from the exact start ({text(times[0], 11)} from the "
        f"printed one): there the mass {what}."
    )
    return Evidence(verdict(held), finding, numbers)


@flown_again
def fig8_forces() -> Evidence:
    """Check F(1) > 0 and F(2) < 0 between the blue and the green point."""
    return forces_hold(exact(fig8()), 1)


@flown_again
def fig8_together() -> Evidence:
    """Check that mass and belt 1 move together between the blue and the green point."""
    return together(exact(fig8()), 1)


@flown_again
def fig8_leaves() -> Evidence:
    """Check that after the stick the velocity leaves the boundary again."""
    return flight_after(exact(fig8(), Fraction(10)), 1, (2,))


@flown_again
def fig8_intersections() -> Evidence:
    """Check that mass and black curves meet at the red point, and from the blue to the green point, only."""
    return curves_meet(fig8())


def curves_meet(figure: Graze) -> Evidence:
    """Check that the mass never is slower than belt 1: then it meets each point of the belt once."""

    def as_told(path: Trajectory) -> bool:
        kinds = [(event.kind, event.boundary) for event in path.events]
        slower = any(segment.mode == "Omega1" for segment in path.segments)
        return not slower and kinds == [("graze", 1), ("stick", 1), ("slip", 1)]

    path, printed, p = motion(exact(figure)), motion(figure.printed), figure.parameters
    numbers = {
        "modes of motion, exact start": ", ".join(mode_text(segment.mode) for segment in path.segments),
        "modes of motion, printed start": ", ".join(mode_text(each.mode) for each in printed.segments),
    }
    if min(len(path.events), len(printed.events)) < 2:
        return Evidence(verdict(False), "There are no two contacts.", numbers)
    red, blue = path.events[:2]
    ahead = blue.x - (red.x + number(p, p.v1) * (blue.t - red.t))
    numbers["mass minus the red point's curve, at the blue point"] = text(ahead, 12)
    meets = "meets the curves as described only" if as_told(path) else "meets the curves elsewhere too"
    finding = (
        f"From the exact start the mass gets ahead of the red point's curve, by {text(ahead, 6)} at the blue point, "
        f"and {meets}. From the printed start there is a {printed.events[0].kind} at the red point."
    )
    told = as_told(path)
    return Evidence(verdict(as_told(printed) or (told and print_is_right(figure)), told), finding, numbers)
