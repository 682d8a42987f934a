"""Figs. 9 and 10: is the printed start on the periodic orbit, and if not, does one misprinted number explain it?"""

from __future__ import annotations

from math import cos, sin

from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.periodic_figures import start_on_orbit
from symosc.paper.evidence import CONFIRMED, CORRECTED, NOT_AS_PRINTED, Evidence
from symosc.paper.misprints import REACH, Nearest, search_parameters, search_start
from symosc.scenes import Scene, load_scene

#: Half a unit of the last printed digit of t0 and x0.
PRINTED_HALF_UNIT = 0.00005


def start(scene: Scene) -> Evidence:
    """Compare the printed start with the orbit; if it is not on it, search for one number that explains why."""
    distance = start_on_orbit(scene)
    if distance.verdict == CONFIRMED:
        return distance
    search = misprint(scene)
    return Evidence(search.verdict, f"{distance.finding} {search.finding}", distance.numbers | search.numbers)


def misprint(scene: Scene) -> Evidence:
    """Search for one number whose misprint explains the start of a periodic scene."""
    start = search_start(scene)
    if any(
        _explains(each) and abs(each.value - float(getattr(scene, each.name))) <= PRINTED_HALF_UNIT for each in start
    ):
        numbers = {f"{each.name} free": _nearest(each) for each in start}
        return Evidence(CONFIRMED, "The printed start is on the orbit, to all its digits.", numbers)
    parameters = search_parameters(scene)
    explaining = [each for each in (*parameters, *start) if _explains(each)]
    numbers = {f"{each.name} free": _nearest(each) for each in (*parameters, *start)}
    numbers |= _end_of_stick(scene)
    free = f"each of {len(parameters)} parameters and {len(start)} numbers of the start left free in turn"
    if not explaining:
        best = min((*parameters, *start), key=lambda each: each.distance)
        finding = (
            f"No single number explains the start. With {free}, parameters up to {REACH} times the printed value, the "
            f"motion misses the start after one period by {best.distance:.4f} at least, in t or x (with {best.name} = "
            f"{best.value:.5g}); an orbit would have to go through it to within {PRINTED_HALF_UNIT}."
        )
        return Evidence(NOT_AS_PRINTED, finding + _remark(scene, start), numbers)
    values = " or ".join(f"{each.name} = {each.value:.5g}" for each in explaining)
    return Evidence(CORRECTED, f"With {free}: {values} puts the start on the orbit, to all printed digits.", numbers)


def _explains(each: Nearest) -> bool:
    # With v0 free, x is compared at the printed t0, whose own rounding moves x by v times half a unit.
    allowed = PRINTED_HALF_UNIT * (1 + abs(each.value)) if each.name == "v0" else PRINTED_HALF_UNIT
    return each.orbit and each.distance <= allowed


def _nearest(each: Nearest) -> str:
    what = "orbit minus start" if each.orbit else "misses the start after one period by"
    text = f"nearest at {each.value:.6g}: {what} {each.dt:+.4f} in t, {each.dx:+.4f} in x"
    if each.name in ("t0", "x0", "v0"):
        return text
    return f"{text}; searched {each.searched[0]:.5g} to {each.searched[1]:.5g}"


def _end_of_stick(scene: Scene) -> dict[str, str]:
    """Say what the force in domain 2 is at a start on belt 2, where the stick is to end: with c v2 and without."""
    p = scene.parameters
    if scene.v0 != p.v2:
        return {}
    theta = float(p.Omega * scene.t0)
    known = float(p.A(2) - p.k * scene.x0) + float(p.B0) * cos(theta)
    spread = PRINTED_HALF_UNIT * (float(p.k) + abs(float(p.B0 * p.Omega) * sin(theta)))
    return {
        "m F⁽²⁾ at the start": f"{known - float(p.c * p.v2):+.4f} ± {spread:.4f} (0 at the end of a stick)",
        "m F⁽²⁾ without the damping c v₂": f"{known:+.4f} ± {spread:.4f}",
    }


def _remark(scene: Scene, start: list[Nearest]) -> str:
    """Point out a start whose x0 or t0 alone differs from the orbit's in one digit."""
    found = []
    for each in start:
        if each.name in ("t0", "x0"):
            printed, orbit = f"{float(getattr(scene, each.name)):.4f}", f"{each.value:.4f}"
            if len(printed) == len(orbit) and sum(a != b for a, b in zip(printed, orbit, strict=True)) == 1:
                found.append(f" The orbit's {each.name} = {orbit} differs from the printed {printed} in one digit")
    return "".join(f"{text}, but the other number of the start does not agree." for text in found)


@flown_again
def fig9_start() -> Evidence:
    """Check that the printed start of Fig. 9 is on the periodic motion, or is but for one misprinted number."""
    return start(load_scene("fig9"))


@flown_again
def fig10_start() -> Evidence:
    """Check that the printed start of Fig. 10 is on the periodic motion, or is but for one misprinted number."""
    return start(load_scene("fig10"))
