"""Checks of Figs. 7 and 8: the grazes of belt 1, from below and from above."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from math import cos, sin
from typing import Any

import numpy as np
from scipy.optimize import brentq

from symosc.engine.arithmetic import mp_context
from symosc.engine.flow import constants
from symosc.engine.next_event import never_leaves
from symosc.engine.state import Covariance, Launch
from symosc.grazing.start import GrazingStart, grazing_start
from symosc.grazing.state import is_grazing
from symosc.grazing.window import grazing_window
from symosc.mappings.theorem7_cases import place
from symosc.model import NEIGHBOURS, Parameters
from symosc.paper.checks.contacts import (
    contacts,
    force_name,
    force_text,
    forces,
    is_zero,
    lowered,
    motion,
    text,
    verdict,
)
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.proven import certificate_of
from symosc.paper.evidence import UNDECIDED, Evidence
from symosc.paper.graze_search import nearest_graze
from symosc.scenes import Scene, load_scene
from symosc.simulation.trajectory import Trajectory

#: Half a unit of the fourth decimal, to which the paper prints its starts.
LAST_HALF_UNIT = Fraction(1, 20000)
LATE = 60
GRAZE_SAMPLES = 8000


@dataclass(frozen=True)
class Graze:
    """A figure of a grazing motion.

    Attributes
    ----------
    printed : Scene
        All numbers as printed.
    scene : Scene
        With a corrected parameter, if one is needed.
    mapping : str
    half_turns : int
        Phase of the grazing point, in units of pi.
    """

    printed: Scene
    scene: Scene
    mapping: str
    half_turns: int

    def source(self, to_start: bool = True) -> GrazingStart:
        """Return where the flow that grazes was at t0, or on the switching plane before."""
        theta = +mp_context(60).pi * self.half_turns
        return grazing_start(self.scene.parameters, self.mapping, theta, t0=self.scene.t0 if to_start else None)

    @property
    def parameters(self) -> Parameters:
        """The corrected parameters."""
        return self.scene.parameters

    @property
    def belt(self) -> int:
        """The belt that the motion grazes."""
        return place(self.mapping).boundary


@cache
def exact(figure: Graze, t_end: Any = None) -> Scene:
    """Return the scene of a figure from the start that grazes, to 40 decimals."""
    start = figure.source().start
    return replace(figure.scene, **(start | {"t0": figure.scene.t0, "t_end": t_end or figure.scene.t_end}))


def fig7() -> Graze:
    """Return Fig. 7: it needs A0 = 10."""
    return Graze(load_scene("fig7"), load_scene("fig7-corrected"), "P2", 1)


def fig8() -> Graze:
    """Return Fig. 8."""
    scene = replace(load_scene("fig8"), t_end=Fraction(9))
    return Graze(scene, scene, "P3", 0)


def print_is_right(figure: Graze) -> bool:
    """Tell whether a start that grazes rounds to the printed start, with all parameters as printed."""
    return nearest_graze(figure.printed, figure.mapping, float(LAST_HALF_UNIT)).rounds


# --- is there a graze at all? ---


def reaches_belt(scene: Scene, belt: int) -> Evidence:
    """Check whether a motion below a belt touches it: by the event search, and for all later times by a bound."""
    p, path = scene.parameters, motion(scene, LATE)
    first = next((event for event in path.events if event.boundary == belt), None)
    square = steady_square(p)
    numbers = {
        "square of the steady velocity amplitude": text(square),
        f"square of v{lowered(belt)}": text(p.belt(belt) ** 2),
    }
    if first is not None:
        numbers["t of the first contact"] = text(first.t, 20)
        finding = f"The first contact is a {first.kind} at t = {text(first.t, 11)}."
        return Evidence(verdict(first.kind == "graze"), finding, numbers)
    t_max, v_max = highest_velocity(path)
    since = clear_since(path, belt)
    numbers["highest velocity"] = f"{text(v_max, 12)} at t = {text(t_max, 9)} (to 1e-12)"
    numbers["contacts until t"] = f"0 until {LATE}"
    numbers["no contact after t, by steady amplitude and energy of the transient"] = text(since, 6)
    if since > LATE:
        return Evidence(UNDECIDED, f"There is no contact until t = {LATE}; later is not known.", numbers)
    finding = (
        f"There is no contact, ever: until t = {LATE} the velocity rises to {text(v_max, 7)} (v{lowered(belt)} = "
        f"{text(p.belt(belt))}), and what it tends to has the amplitude √{text(square)} = "
        f"{text(float(square) ** 0.5, 6)}, whatever A₀ is."
    )
    return Evidence(verdict(False), finding, numbers)


def steady_square(p: Parameters) -> Fraction:
    """Return the square of the amplitude of the steady velocity in one domain; friction and A0 do not enter."""
    return (p.B0 * p.Omega) ** 2 / ((p.k - p.m * p.Omega**2) ** 2 + (p.c * p.Omega) ** 2)


def highest_velocity(path: Trajectory, since: float | None = None) -> tuple[float, float]:
    """Return when the velocity of a flight in domain 1 is highest, and how high."""
    times = np.linspace(float(path.t_start) if since is None else since, float(path.t_end), GRAZE_SAMPLES)
    i = int(np.argmax(path(times)[1]))
    if i in (0, GRAZE_SAMPLES - 1):
        return float(times[i]), float(path(times[i])[1])
    top = brentq(lambda t: float(path.force(1, t)), times[i - 1], times[i + 1], xtol=1e-13)
    return top, float(path(top)[1])


def clear_since(path: Trajectory, belt: int) -> float:
    """Return a time after which the flight in the domain below a belt cannot reach it; inf if none is seen."""
    p = path.parameters
    K, level = constants(p), float(p.belt(belt))
    for t in np.linspace(float(path.t_start), float(path.t_end), 400):
        v, a, phase = float(path(t)[1]), float(path.force(NEIGHBOURS[belt][0], t)), float(p.Omega) * t
        start = Launch(v, a, sin(phase), cos(phase))
        if never_leaves(start, Covariance(0.0, 0.0, 0.0), -np.inf, level, NEIGHBOURS[belt][0], K):
            return float(t)
    return float("inf")


# --- the touch ---


@flown_again
def fig7_tangential() -> Evidence:
    """Check that the motion is tangential to belt 1's boundary at the red point and leaves again."""
    return tangential(fig7())


@flown_again
def fig8_tangential() -> Evidence:
    """Check the same for Fig. 8."""
    return tangential(fig8())


def tangential(figure: Graze) -> Evidence:
    """Check the contact at the red point: with the printed start, and with the one that is exact."""
    printed, scene, p = motion(figure.printed), exact(figure), figure.parameters
    path = motion(scene)
    numbers = {"contacts as printed until the first slip": contacts_text(printed)}
    if figure.scene.parameters != figure.printed.parameters:
        numbers["contacts with the corrected parameter"] = contacts_text(motion(figure.scene))
    if not path.events:
        return Evidence(verdict(False), "There is no contact from the exact start either.", numbers)
    at, event, side = contacts(scene)[0], path.events[0], place(figure.mapping).domain
    force = forces(p, at)[side - NEIGHBOURS[at.belt][0]]
    order = is_grazing(p, figure.mapping, at.x, at.theta)
    touches = event.kind == "graze" and is_zero(force) and order.grazing
    numbers["t, x of the red point from the exact start"] = f"{text(event.t, 25)}, {text(event.x, 12)}"
    numbers[f"{force_name(side)}, G⁽¹⁾ at the red point"] = f"{force_text(force)}, {text(order.values[-1], 12)}"
    finding = (
        f"From the start to 40 decimals the motion {'grazes' if touches else 'does not graze'} belt {at.belt} at t = "
        f"{text(event.t, 12)}, with {force_name(side)} = {force_text(force)} and G⁽¹⁾ = {text(order.values[-1], 6)}."
    )
    usual = motion(figure.scene).events
    if len(usual) > 1 and usual[0].kind == "stick":
        lasts = usual[1].t - usual[0].t
        numbers["stick in place of the graze, from the printed start, lasts"] = text(lasts, 12)
        finding += f" From the printed digits it overshoots and sticks for a time of {text(lasts, 4)}."
    if not printed.events:
        finding += " With the printed parameters there is no contact at all."
    numbers |= certificate_of(scene)
    as_printed = bool(printed.events) and printed.events[0].kind == "graze"
    return Evidence(verdict(as_printed or (touches and print_is_right(figure)), touches), finding, numbers)


def contacts_text(path: Trajectory) -> str:
    """Return the first two contacts of a motion as text."""
    shown = [f"{e.kind} at t = {text(e.t, 16)}" for e in path.events[:2]]
    return ", ".join(shown) or f"none until t = {text(path.t_end)}"


@flown_again
def fig7_once() -> Evidence:
    """Check that the velocity is equal to the belt's at the red point only."""
    return touches_once(fig7())


def touches_once(figure: Graze) -> Evidence:
    """Check that a motion in the domain below touches belt 1 once and never again."""

    def once(scene: Scene) -> bool:
        return [event.kind for event in motion(scene, LATE).events] == ["graze"]

    scene = exact(figure)
    path = motion(scene, LATE)
    after = clear_since(path, figure.belt)
    only = once(scene) and after < LATE
    numbers = {f"contacts until t = {LATE}, exact start": str(len(path.events))}
    numbers["none by the energy bound after t"] = text(after, 6)
    numbers[f"contacts until t = {LATE} as printed"] = str(len(motion(figure.printed, LATE).events))
    if not path.events:
        return Evidence(verdict(False), "There is no contact.", numbers)
    t, v = highest_velocity(path, float(path.events[0].t) + 1)
    numbers["highest velocity later"] = f"{text(v, 9)} at t = {text(t, 7)}"
    finding = (
        f"From the exact start mass and belt {figure.belt} have the same velocity at t = {text(path.events[0].t, 12)} "
        f"only, where the mass meets the red point's curve, and never again: later ẋ is at most {text(v, 5)}."
    )
    return Evidence(verdict(once(figure.printed), only), finding, numbers)


# --- mapping and Theorem 7 ---


@flown_again
def fig7_mapping() -> Evidence:
    """Check that the graze of Fig. 7 ends a mapping P2."""
    return of_mapping(fig7())


@flown_again
def fig8_mapping() -> Evidence:
    """Check that the graze of Fig. 8 ends a mapping P3."""
    return of_mapping(fig8())


def of_mapping(figure: Graze) -> Evidence:
    """Flow back from the graze: does it come from where the mapping starts? And does the mapping follow it?"""
    found, name = figure.source(to_start=False), lowered(figure.mapping)
    word = motion(exact(figure)).word
    follows = word[:1] == [figure.mapping]
    shift = figure.source().t_m - found.t_m
    numbers = {
        f"comes from the plane of {name}": "yes" if found.found else "no",
        "mappings that follow": lowered(" ".join(word)) or "none",
    }
    came = "never was at a belt before"
    if found.t is not None:
        came = f"came from belt {found.boundary} at t = {text(found.t + shift, 9)}, x = {text(found.x, 9)}"
        numbers["last contact before: t, x, belt"] = (
            f"{text(found.t + shift, 12)}, {text(found.x, 12)}, {found.boundary}"
        )
    ending = f"so a {name} ends in it" if found.found else f"so no {name} ends in it"
    finding = f"Flowing back, the motion {came}: {ending}; "
    finding += f"a {name} begins at it." if follows else f"no {name} begins at it."
    same = figure.scene.parameters == figure.printed.parameters
    either = found.found or follows
    return Evidence(verdict(either and same, either), finding, numbers)


@flown_again
def fig7_theorem_7() -> Evidence:
    """Check (55) at the red point of Fig. 7."""
    return in_window(fig7())


@flown_again
def fig8_theorem_7() -> Evidence:
    """Check (56) at the red point of Fig. 8."""
    return in_window(fig8())


def in_window(figure: Graze) -> Evidence:
    """Check that the phase of the touch is in Theorem 7's window, as printed, whose case is decided exactly."""
    p, mapping = figure.parameters, figure.mapping
    window = grazing_window(p, mapping, "paper")
    event = next((e for e in motion(exact(figure)).events if e.kind == "graze"), None)
    numbers = {"γ, B₀Ω/m": f"{text(window.gamma)}, {text(window.amplitude)}", "case": window.case}
    if event is None:
        return Evidence(verdict(False), "There is no graze.", numbers)
    at = contacts(exact(figure))[0]
    theta = figure.half_turns * mp_context(60).pi
    inside, touch = window.contains(theta), is_grazing(p, mapping, at.x, at.theta)
    numbers["Ωt mod 2π at the graze"] = text(event.theta, 25)
    numbers["G⁽⁰⁾, G⁽¹⁾"] = ", ".join(f"{value:.6g}" for value in touch.values)
    phase = "π" if figure.half_turns else "0"
    finding = (
        f"γ = {text(window.gamma)} and B₀Ω/m = {text(window.amplitude)}, in rational numbers: case {window.case}. Its "
        f"window {'contains' if inside else 'does not contain'} Ωt = {phase}, and the flow touches with order "
        f"{touch.order}, G⁽¹⁾ = {touch.values[-1]:.6g}."
    )
    return Evidence(verdict(bool(inside and touch.grazing and touch.order == 1)), finding, numbers)
