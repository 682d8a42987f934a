"""Checks of Figs. 5 and 6: sticks on belt 1 and on belt 2."""

from __future__ import annotations

from scipy.optimize import brentq

from symosc.mappings.equations import residual
from symosc.model import NEIGHBOURS
from symosc.paper.checks.contacts import (
    NO_FORCE,
    SceneContact,
    Stick,
    contacts,
    force_name,
    force_text,
    forces,
    forces_along,
    is_zero,
    lowered,
    mode_text,
    motion,
    number,
    start_contact,
    stick_holds,
    sticks,
    text,
    verdict,
)
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.proven import certificate_of
from symosc.paper.evidence import UNDECIDED, Evidence
from symosc.scenes import Scene, load_scene

STICK_SAMPLES = 2000


# --- the first stick of a scene: what Figs. 5 and 6 say about it ---


def first_stick(scene: Scene, belt: int) -> tuple[Stick, SceneContact] | None:
    """Return the first stick on a belt that ends, and its end."""
    return next(((s, s.end) for s in sticks(scene) if s.belt == belt and s.end is not None), None)


def no_stick(scene: Scene, belt: int) -> Evidence:
    """Return the evidence that a scene has no stick on a belt that ends."""
    numbers = {"events": str(len(motion(scene).events)), "followed until t": text(scene.t_end)}
    return Evidence(verdict(False), f"There is no stick on belt {belt} that ends.", numbers)


@flown_again
def fig5_onset() -> Evidence:
    """Check that the stick on belt 1 appears some time after the start."""
    return onset_later(load_scene("fig5"), 1)


def onset_later(scene: Scene, belt: int) -> Evidence:
    """Check that the first stick starts after t₀, with F F < 0 (Theorem 4)."""
    found = first_stick(scene, belt)
    if found is None:
        return no_stick(scene, belt)
    onset, p = found[0].onset, scene.parameters
    wait = onset.t - number(p, scene.t0)
    finding = (
        f"The stick on belt {belt} starts {text(wait, 11)} after t₀ = {text(scene.t0)}, at x = {text(onset.x, 11)}."
    )
    numbers = {
        "t of the blue point": text(onset.t, 25),
        "x of the blue point": text(onset.x, 25),
        "ẋ₀, velocity of the belt": f"{text(scene.v0)}, {text(p.belt(belt))}",
    }
    return Evidence(verdict(wait > 0), finding, numbers | certificate_of(scene))


@flown_again
def fig5_together() -> Evidence:
    """Check that mass and belt 1 move together from the blue to the green point."""
    return together(load_scene("fig5"), 1)


@flown_again
def fig6_together() -> Evidence:
    """Check that mass and belt 2 move together from the blue to the green point."""
    return together(load_scene("fig6"), 2)


def together(scene: Scene, belt: int) -> Evidence:
    """Check x = x_i + v (t - t_i) over the first stick, and that static friction suffices for it: eqs. (2) to (4)."""
    found = first_stick(scene, belt)
    if found is None:
        return no_stick(scene, belt)
    (stick, end), p = found, scene.parameters
    most = (p.mu1 if belt == 1 else p.mu2) * p.FN
    grip, m = number(p, most), number(p, p.m)
    # The force of (2) on the mass is m F^(below) - mu FN.
    needed = [m * each.below - grip for each in forces_along(p, stick)]
    lasts, way = end.t - stick.onset.t, end.x - stick.onset.x
    apart = abs(way - number(p, p.belt(belt)) * lasts)
    enough = max(abs(force) for force in needed) <= grip + NO_FORCE
    used_up = is_zero(abs(needed[-1]) - grip)
    grips = f"stays within μ{lowered(belt)} F_N = {text(most)}" if enough else f"exceeds {text(most)}"
    finding = (
        f"For {text(lasts, 11)} the mass moves with belt {belt}, both by {text(way, 11)}. The static friction that "
        f"this needs {grips}{'; it is used up at the green point' if used_up else ''}."
    )
    numbers = {
        "t of the blue and of the green point": f"{text(stick.onset.t, 20)}, {text(end.t, 20)}",
        "x of the blue and of the green point": f"{text(stick.onset.x, 20)}, {text(end.x, 20)}",
        "way of the mass minus way of the belt": text(apart, 2),
        f"F_s{belt} of eq. (2) at the onset, where it turns, at the end": ", ".join(text(each, 10) for each in needed),
    }
    return Evidence(verdict(bool(lasts > 0 and apart < NO_FORCE and enough)), finding, numbers)


@flown_again
def fig5_forces() -> Evidence:
    """Check F(1) > 0 and F(2) < 0 between the blue and the green point."""
    return forces_hold(load_scene("fig5"), 1)


@flown_again
def fig6_forces() -> Evidence:
    """Check F(2) > 0 and F(3) < 0 during the stick on belt 2."""
    return forces_hold(load_scene("fig6"), 2)


def forces_hold(scene: Scene, belt: int) -> Evidence:
    """Check Theorem 4's conditions over the whole of the first stick."""
    found = first_stick(scene, belt)
    if found is None:
        return no_stick(scene, belt)
    (stick, end), (lo, hi) = found, NEIGHBOURS[belt]
    along = forces_along(scene.parameters, stick)
    held = stick_holds(along)
    lowest, highest = min(each.below for each in along), max(each.above for each in along)
    finding = (
        f"From t = {text(stick.onset.t, 11)} to {text(end.t, 11)} {force_name(lo)} is at least {force_text(lowest)}, "
        f"{force_name(hi)} at most {force_text(highest)}{', with 0 at the green point only' if held else ''}. Both are "
        "monotone between the instants listed: this is decided for the whole stick, not at samples."
    )
    numbers = {
        f"{force_name(lo)}, {force_name(hi)} at t = {text(stick.onset.t + each.elapsed)}": (
            f"{force_text(each.below)}, {force_text(each.above)}"
        )
        for each in along
    }
    return Evidence(verdict(held), finding, numbers)


# --- how it ends, and what follows ---


@flown_again
def fig6_end() -> Evidence:
    """Check F(2) = 0 and F(3) < 0 where the stick of Fig. 6 vanishes."""
    return ends_below(load_scene("fig6"), 2)


def ends_below(scene: Scene, belt: int) -> Evidence:
    """Check that the first stick ends by the force of the domain below while the other one still holds."""
    found = first_stick(scene, belt)
    if found is None:
        return no_stick(scene, belt)
    (stick, end), (lo, hi) = found, NEIGHBOURS[belt]
    at = forces(scene.parameters, end)
    held = is_zero(at.below) and at.above < 0 and stick.into == f"Omega{lo}"
    finding = (
        f"At t = {text(end.t, 13)} {force_name(lo)} = {force_text(at.below)}, {force_name(hi)} = {text(at.above)}; "
        f"the mass slips into {mode_text(stick.into)}. Eq. ({51 + belt}) of the paper wants {force_name(hi)} = 0 there."
    )
    numbers = {
        "t of the green point": text(end.t, 25),
        f"{force_name(lo)}": force_text(at.below),
        f"{force_name(hi)}": text(at.above, 25),
    }
    return Evidence(verdict(bool(held)), finding, numbers)


@flown_again
def fig5_after_friction() -> Evidence:
    """Check that after the stick the mass moves under kinetic friction."""
    return flight_after(load_scene("fig5"), 1, (1, 2))


@flown_again
def fig6_after() -> Evidence:
    """Check that after the stick on belt 2 the mass is in domain 2 for some time."""
    return flight_after(load_scene("fig6"), 2, (2,))


def flight_after(scene: Scene, belt: int, domains: tuple[int, ...]) -> Evidence:
    """Check that a flight in one of the domains follows the first stick and obeys (5) up to the next contact."""
    found, p, path = first_stick(scene, belt), scene.parameters, motion(scene)
    if found is None:
        return no_stick(scene, belt)
    (stick, end), at = found, contacts(scene)
    i = at.index(end)
    if i + 1 == len(at):
        return Evidence(UNDECIDED, "No contact follows.", {"followed until t": text(scene.t_end)})
    flight, after, Omega = path.segments[i + 1], at[i + 1], number(p, p.Omega)
    label = str(flight.label)
    f1, f2 = residual(p, label, (end.x, Omega * end.t), (after.x, Omega * after.t))
    lasts, domain = after.t - end.t, int(str(stick.into)[-1])
    # The engine flies with gains from the contact; (54) is evaluated here from one contact to the next.
    held = domain in domains and lasts > 0 and max(abs(f1), abs(f2)) < NO_FORCE
    drag = p.A(domain) - p.A0
    finding = (
        f"For {text(lasts, 11)}, from t = {text(end.t, 11)} to {text(after.t, 11)}, the mass is in "
        f"{mode_text(flight.mode)} ({lowered(label)}) with the kinetic friction {text(drag)}; then it is at "
        f"belt {after.belt}."
    )
    numbers = {
        "t from, to": f"{text(end.t, 20)}, {text(after.t, 20)}",
        "friction force A_α − A₀": text(drag),
        f"residuals f₁, f₂ of (54) for {lowered(label)}": f"{text(abs(f1), 2)}, {text(abs(f2), 2)}",
    }
    return Evidence(verdict(bool(held)), finding, numbers)


@flown_again
def fig5_after_product() -> Evidence:
    """Check F(1) x F(2) > 0 after the vanishing of the stick: for how long?"""
    return product_after(load_scene("fig5"), 1)


def product_after(scene: Scene, belt: int) -> Evidence:
    """Check the sign of the force product from the end of the first stick up to the next contact."""
    found, path, (lo, hi) = first_stick(scene, belt), motion(scene), NEIGHBOURS[belt]
    if found is None:
        return no_stick(scene, belt)
    end = found[1]
    following = next((at for at in contacts(scene) if at.t > end.t), None)
    since, until = float(end.t), float(path.t_end if following is None else following.t)

    def product(t: float) -> float:
        return float(path.force(lo, t) * path.force(hi, t))

    times = [since + (until - since) * (j + 1) / (STICK_SAMPLES + 1) for j in range(STICK_SAMPLES)]
    products = [product(t) for t in times]
    turn = next((j for j in range(1, STICK_SAMPLES) if (products[j] > 0) != (products[j - 1] > 0)), None)
    numbers = {"t of the green point": text(since), "followed until t": text(until)}
    numbers["product just after the green point"] = text(products[0], 6)
    numbers["lowest product"] = text(min(products), 6)
    if following is not None:
        numbers["product at the next contact"] = text(forces(scene.parameters, following).product)
    if turn is None:
        sign = "positive" if products[0] > 0 else "not positive"
        finding = f"The product is {sign} from the green point until t = {text(until, 8)}."
    else:
        zero = brentq(product, times[turn - 1], times[turn], xtol=1e-14)
        numbers["the product changes its sign at t"] = f"{zero:.12g} (to 1e-12)"
        finding = (
            f"The product is positive only until t = {zero:.10g}, {zero - since:.7g} after the green point: there "
            f"ẋ has its extremum {path(zero)[1]:.7g} and {force_name(lo)} changes its sign. At the next contact, "
            f"t = {text(until, 8)}, the product is {'negative' if products[-1] < 0 else 'positive'}."
        )
    return Evidence(verdict(min(products) > 0, products[0] > 0), finding, numbers)


# --- the start of Fig. 6 ---


@flown_again
def fig6_start() -> Evidence:
    """Check that the stick on belt 2 appears with the initial conditions."""
    return sticks_at_start(load_scene("fig6"), 2)


def sticks_at_start(scene: Scene, belt: int) -> Evidence:
    """Check that the start is on the belt and holds (Theorem 4); a stick that only comes later is a correction."""
    p, lo, hi = scene.parameters, *NEIGHBOURS[belt]
    at = start_contact(scene, belt)
    both = forces(p, at)
    on_belt = scene.v0 == p.belt(belt)
    held = on_belt and both.below > NO_FORCE and both.above < -NO_FORCE
    first = next((stick for stick in sticks(scene) if stick.belt == belt), None)
    where = (
        f"At t₀ = {text(scene.t0)} {force_name(lo)} = {text(both.below, 8)}, {force_name(hi)} = {text(both.above, 8)}"
    )
    numbers = {
        f"{force_name(lo)}, {force_name(hi)} at the start": f"{text(both.below)}, {text(both.above)}",
        "ẋ₀, velocity of the belt": f"{text(scene.v0)}, {text(p.belt(belt))}",
        "first mode of motion": mode_text(motion(scene).segments[0].mode),
    } | certificate_of(scene)
    if held:
        return Evidence(verdict(True), f"{where}: the mass sticks at once (Theorem 4).", numbers)
    if first is None:
        return Evidence(verdict(False), f"{where}: the mass does not stick, nor later.", numbers)
    numbers["t of the first stick"] = text(first.onset.t, 20)
    finding = (
        f"{where}: no stick at the start (Theorem 5), the mass leaves into {mode_text(motion(scene).segments[0].mode)} "
        f"and sticks to belt {belt} only at t = {text(first.onset.t, 11)}."
    )
    return Evidence(verdict(False, True), finding, numbers)
