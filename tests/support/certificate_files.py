"""Certificates by name, each made once, and what the checkers say of them."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from orbit_list import listed_orbits

import symosc.certificates.verify_orbits as checker
from symosc import (
    Certificate,
    Parameters,
    Scene,
    certify,
    continue_orbit,
    find_orbit,
    grazing_window,
    load_scene,
)
from symosc.reference.cases import hard_cases

Document = dict[str, Any]
FORGED = Path(__file__).parents[1] / "certificates" / "forged"
#: A flight below v1 that returns to it again and again, and would go on above it.
SWING = Parameters(
    m=1, c="0.1", k=4, A0=0, B0="0.5", Omega="0.7", v1=1, v2=9, mu1="0.1", mu2="0.1", FN=1
)
#: c = B0 = 0: v and v' w go round a circle; from this start it grazes v1 = 1 exactly.
CIRCLE = Parameters(m=1, c=0, k=1, A0=0, B0=0, Omega=1, v1=1, v2=3, mu1="0.1", mu2="0.1", FN=1)
#: Branches in Omega, with where they are begun: ends at the birth of a stick, at a graze; the end
#: of the range.
BRANCHES = {
    "stick": ("fig9", "3.28", "3.2885766", "3.2885765"),
    "graze": ("fig9", "5.017619656", "5.1", "5.0176196565"),
    "sticks": ("fig10", "1.74", "1.76", "1.75"),
    "short": ("fig9", "4", "4.01", "4"),
}


def _made(kind: str, *names: str) -> Certificate:
    if kind == "motion":  # a scene, and its end
        return certify(names[0], t_end=names[1] if len(names) > 1 else None)
    if kind == "derivatives":
        return certify(names[0], t_end=names[1], wrt=("mu1", "Omega", "x0"))
    if kind == "law":  # a reference of another law, or seed and number of a random one
        from law_certificates import certificate_of  # which uses this module

        return certificate_of(*names)
    if kind == "law-orbit":
        from law_orbit_certificates import orbit_of

        return certify(orbit_of(*names))
    if kind == "circle":
        return certify(
            Scene("a motion", CIRCLE, Fraction(0), Fraction("0.2"), Fraction(-1), Fraction(4))
        )
    if kind == "swing":
        return certify(
            Scene("a motion", SWING, Fraction(0), Fraction(-3), Fraction(-1), Fraction(2))
        )
    if kind == "settled":  # with an end, or a hundred thousand periods
        if len(names) > 1:
            return certify(*names[:1], t_end=names[1])
        return certify(
            next(case for case in hard_cases() if case.name == f"1e5-periods-{names[0]}").scene
        )
    if kind == "orbit" and names[0].isdigit():
        return listed_orbits()[int(names[0])].prove()
    scene = load_scene(BRANCHES[names[0]][0] if kind == "branch" else names[0])
    if kind == "orbit":
        return certify(find_orbit(scene.parameters, scene.structure))
    if kind == "window":
        return certify(
            grazing_window(scene.parameters, names[1], "paper" if "paper" in names else "full")
        )
    _, low, high, start = BRANCHES[names[0]]
    return certify(
        continue_orbit(scene.parameters.replace(Omega=start), scene.structure, "Omega", (low, high))
    )


@cache
def text_of(name: str) -> str:
    """Return the file of a certificate, such as "motion fig6 12", "orbit fig9" or "window fig9 P2 paper"."""
    made = _made(*name.split())
    assert made.proven, made.message
    return json.dumps(made.as_dict())


def document(name: str) -> Document:
    """Return a certificate without its message, which is checked last of all."""
    found: Document = json.loads(text_of(name))
    del found["message"]
    return found


def forged(name: str) -> Document:
    """Return a forged file that somebody found, without its message."""
    found: Document = json.loads((FORGED / f"{name}.json").read_text(encoding="utf-8"))
    found.pop("message", None)
    return found


def judged(content: Document, **limits: int) -> tuple[int, str]:
    """Return the exit code and the answer of the checker, which gives its reason in one line."""
    code, answer = checker.judge(
        {key: value for key, value in content.items() if key != "message"}, **limits
    )
    assert code == 0 or (len(answer.splitlines()) == 1 and len(answer) < 300), answer
    return code, answer


def put(content: Document, *path: Any) -> Document:
    """Return a document with another value, or that of a function, at a place."""
    changed: Document = json.loads(json.dumps(content))
    *way, last, value = path
    place: Any = changed
    for step in way:
        place = place[step]
    if callable(value):
        place[last] = value(place[last])
    else:
        place[last] = value
    return changed


def moved(ends: list[str], by: Any, wider: Any = 0) -> list[str]:
    """Return an enclosure moved, and wider on both sides."""
    by = Fraction(by)
    wider = Fraction(wider)
    return [str(Fraction(ends[0]) + by - wider), str(Fraction(ends[1]) + by + wider)]


def width(ends: list[str]) -> Fraction:
    """Return how wide an enclosure is."""
    return Fraction(ends[1]) - Fraction(ends[0])
