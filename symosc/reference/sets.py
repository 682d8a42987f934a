"""The set of all reference cases, its groups and its version."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches
from fractions import Fraction
from functools import lru_cache
from math import pi

from symosc.errors import ParameterError
from symosc.reference.case import ReferenceCase
from symosc.reference.coulomb import AT_A_TURN, BALANCE, CONTINUUM, COULOMB, CSERNAK, continuum, coulomb, wall
from symosc.reference.grazes import GRAZES, grazes
from symosc.reference.hard_cases import GROUPS, hard_cases
from symosc.reference.rests import RESTS, rests
from symosc.scenes import Scene, figure_of, load_scene, scene_names

#: One more whenever a case is added or changed, so that scores name what they are scores of.
SET_VERSION = 1
PAPER_SCENES, LONG_RUNS = "paper", "long run"
AT_A_SLIP = "the start is the end of a stick to all its digits: within its error the mass may stick or slip"
HARD_SOURCE = "a scene of the paper with numbers that make it hard"

#: What is hard about each group, in order.
CASE_GROUPS = {
    PAPER_SCENES: "the scenes of Chen and Fan (2016), and the orbits and exact grazes that belong to them",
    **GROUPS,
    GRAZES: "double roots of the velocity, in each regime of damping, at each belt and from each side",
    RESTS: "velocities that creep to a belt's speed, and rest on a belt",
    COULOMB: "published closed forms: amplitudes, growth and decay, the border of motions without stops",
    CONTINUUM: "orbits that no motion returns to after an error",
    LONG_RUNS: "hundreds of events: errors that add up",
}


@lru_cache(maxsize=1)
def reference_cases() -> Sequence[ReferenceCase]:
    """Return all reference cases: motions whose events are known for certain, and mostly proven.

    Nothing is computed yet; a case computes its events, certificate and condition when they are asked for.

    Examples
    --------
    >>> from symosc import reference_cases
    >>> cases = reference_cases()
    >>> len(cases), cases[0].name, cases[-1].group
    (158, 'paper-fig5', 'long run')
    """
    found = [*_paper(), *_hard(), *grazes(), *rests(), *coulomb(), *continuum(), *_long_runs()]
    return tuple(found)


def reference_case(name: str) -> ReferenceCase:
    """Return the reference case of a name.

    Raises
    ------
    ParameterError
        If there is none; the message has the names that are nearest to it.
    """
    cases = {case.name: case for case in reference_cases()}
    if name not in cases:
        near = get_close_matches(name, cases, 3) or ["symosc cases lists all"]
        raise ParameterError("case", name, f"is no reference case; near it: {', '.join(near)}")
    return cases[name]


def chosen(group: str | None) -> Sequence[ReferenceCase]:
    """Return the cases of a group; all for None.

    Raises
    ------
    ParameterError
        If there is no such group.
    """
    if group is not None and group not in CASE_GROUPS:
        raise ParameterError("group", group, f"is none; there are: {', '.join(CASE_GROUPS)}")
    return [case for case in reference_cases() if group in (None, case.group)]


def _slug(text: str) -> str:
    """Return a text as a name of letters, digits and single hyphens."""
    signs = {"+": " plus ", "=": " ", "^": "", "'": "", "- ": "minus "}
    for sign, word in signs.items():
        text = text.replace(sign, word)
    text = re.sub(r"(?<=\d)\.(?=\d)", "p", text)
    return re.sub(r"[^A-Za-z0-9]+", "-", text).strip("-")


def _paper() -> Iterator[ReferenceCase]:
    for name in filter(figure_of, scene_names()):
        scene = load_scene(name)
        reason = AT_A_SLIP if name == "fig10-orbit" else ""
        yield ReferenceCase(f"paper-{name}", PAPER_SCENES, scene, f"the paper's {name}", scene.source, open=reason)


def _hard() -> Iterator[ReferenceCase]:
    for case in hard_cases():
        name = _slug(f"{case.group} {case.name}")
        scene = replace(case.scene, name=name)
        hard = f"{GROUPS[case.group]}; {case.name}"
        yield ReferenceCase(name, case.group, scene, hard, HARD_SOURCE, periods=case.periods)


def _long_runs() -> Iterator[ReferenceCase]:
    for base, periods, hard in (
        ("fig9-orbit", 150, "300 crossings of one belt on an orbit without sticks"),
        ("fig10", 75, "300 sticks and slips at two belts"),
        ("fig5", 150, "300 sticks and slips at one belt"),
    ):
        scene = load_scene(base)
        end = scene.t0 + Fraction(f"{(periods + 0.05) * 2 * pi / float(scene.parameters.Omega):.8g}")
        name = f"long-{base}"
        yield ReferenceCase(name, LONG_RUNS, replace(scene, name=name, t_end=end), hard, scene.source)
    name, start = "long-resonance", Fraction(1, 2) - Fraction("0.4")
    scene = Scene(name, wall("0.4", 1), Fraction(0), start, Fraction(5), Fraction(630))
    hard = "200 turning points at undamped resonance, each farther out"
    yield ReferenceCase(name, LONG_RUNS, scene, hard, BALANCE, ("t[199] = 199*pi + pi/2",))
    name = "long-continuum"
    scene = Scene(name, wall("0.1", "1/2"), Fraction(0), Fraction(1, 5) + Fraction(4, 3), Fraction(0), Fraction(1260))
    hard = "200 turning points on a continuum of orbits: errors add up and nothing draws them back"
    closed = ("x[199] = 1/5 + 4/3", "t[199] = 400*pi")
    yield ReferenceCase(name, LONG_RUNS, scene, hard, CSERNAK, closed, AT_A_TURN)
