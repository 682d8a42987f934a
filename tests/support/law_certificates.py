"""Certificates of motions under other friction laws than the paper's, and whether a file about one
states what an oracle of the law finds.
"""

from __future__ import annotations

from copy import deepcopy
from fractions import Fraction
from random import Random
from typing import Any

import mpmath
from certificate_files import Document
from certificate_mutants import CHANGES, EVENT, Change, another, swap
from law_families import LawScene, scene_of
from law_fuzz import MORE, oscillator_of, truth_of
from law_oracle import LawBelt, LawRun, follow
from law_reference import REFERENCES, Reference

from symosc import Belt, Certificate, Oscillator, Scene, certify

DIGITS = 40
#: What the oracle's numbers may be off by.
OFF = Fraction(1, 10**28)
#: Random laws, of one to three belts each.
FAMILIES = ("plain", "curved", "onbelt", "undriven", "curved", "chaotic")


def scene_until(scene: LawScene, t_end: Fraction) -> Scene:
    return Scene(scene.family, oscillator_of(scene), scene.t0, scene.x0, scene.v0, t_end)


def judged_law(seed: int, number: int) -> tuple[Certificate, LawRun, LawScene]:
    """Return the certificate of a random law's motion up to its last event that the oracle finds,
    and the oracle's motion.
    """
    family = FAMILIES[number % len(FAMILIES)]
    law = scene_of(family, seed, number, 3)
    run = truth_of(law, DIGITS)
    t_end = law.t_end
    if run.status == "max_events":
        t_end = exact(run.events[-1].t) + Fraction(1, 10**9)
    return certify(scene_until(law, t_end)), run, law


def exact(value: Any) -> Fraction:
    """Return a number of the oracle as a fraction."""
    with mpmath.workdps(DIGITS + 20):
        return Fraction(mpmath.nstr(value, DIGITS + 10))


def says_the_same(rows: list[Document], run: LawRun) -> bool:
    """Whether rows of a file, without corners, are the oracle's events."""
    rows = [row for row in rows if row["kind"] != "corner"]
    if len(rows) != len(run.events):
        return False
    for row, event in zip(rows, run.events, strict=True):
        if any(row[name] != getattr(event, name) for name in EVENT):
            return False
        for name in "tx":
            value = exact(getattr(event, name))
            low, high = map(Fraction, row[name])
            off = OFF * max(1, abs(value))
            if not low - off <= value <= high + off:
                return False
    return True


def reference_scene(reference: Reference) -> Scene:
    law = Oscillator(**reference.law, belts=[Belt(**belt) for belt in reference.belts])
    start = [Fraction(value) for value in (*reference.start, reference.t_end)]
    return Scene(reference.name, law, *start)


def certificate_of(*names: str) -> Certificate:
    """Return the certificate of a reference ("S1"), or of a random law by its seed and number."""
    if len(names) == 2:
        made, _, _ = judged_law(*map(int, names))
        return made
    return certify(reference_scene(next(each for each in REFERENCES if each.name == names[0])))


def law_is_true(document: Document) -> bool:
    """Whether a file about a law states what the oracle finds; corners are not looked at."""
    p = dict(document["parameters"])
    belts = [
        LawBelt(belt["v"], None, belt["mu_s"], belt["curve"], belt["slope"])
        for belt in p.pop("belts")
    ]
    for digits in (DIGITS, *MORE):
        run = follow(
            **p, belts=belts, **document["start"], t_end=document["t_end"], digits=digits
        )  # fmt: skip
        if run.status != "undecided":
            break
    if run.status != "t_end":
        return False
    mode = run.events[0].source if run.events else run.mode
    return document["mode"] == mode and says_the_same(document["events"], run)


# -- files with one thing changed ------------------------------------------------------------------


def of_belt(change: Any) -> Change:
    """Return a change of one of the belts."""

    def changed(rng: Random, document: Document) -> None:
        change(rng, rng.choice(document["parameters"]["belts"]))

    return changed


def moved_number(rng: Random, text: str) -> str:
    step = Fraction(rng.choice([-1, 1]), 10 ** rng.randint(1, 12))
    return str(Fraction(text) + step)


def number_of_belt(rng: Random, belt: Document) -> None:
    name = rng.choice(["v", "slope", "mu_s"])
    belt[name] = moved_number(rng, belt[name])


def point_of_curve(rng: Random, belt: Document) -> None:
    point = rng.choice(belt["curve"])
    i = rng.randrange(2)
    point[i] = moved_number(rng, point[i])


def no_static_friction(rng: Random, belt: Document) -> None:
    belt["mu_s"] = belt["curve"][0][1]


def without_a_point(rng: Random, belt: Document) -> None:
    belt["curve"].pop(rng.randrange(len(belt["curve"])))


def step_dropped(*kinds: str) -> Change:
    def change(rng: Random, document: Document) -> None:
        rows = document["events"]
        some = [i for i, row in enumerate(rows) if row["kind"] in kinds]
        if some:
            rows.pop(rng.choice(some))

    return change


def without_a_belt(rng: Random, document: Document) -> None:
    belts = document["parameters"]["belts"]
    belts.pop(rng.randrange(len(belts)))


def parameter(rng: Random, document: Document) -> None:
    p = document["parameters"]
    name = rng.choice([name for name in p if name != "belts"])
    p[name] = moved_number(rng, p[name])


NAMES = ("Omega1", "Omega2", "Omega3", "Omega4", "belt1", "belt2", "belt3")
LAW_CHANGES: dict[str, Change] = CHANGES | {
    "kind": another("events", "kind", among=("cross", "stick", "slip", "graze", "corner")),
    "source": another("events", "source", among=NAMES),
    "target": another("events", "target", among=NAMES),
    "boundary": another("events", "boundary", among=(-1, 0, 1, 2, 3, 4)),
    "first mode": another("mode", among=NAMES),
    "parameter": parameter,
    "number of a belt": of_belt(number_of_belt),
    "point of a curve": of_belt(point_of_curve),
    "static friction left out": of_belt(no_static_friction),
    "a point of a curve dropped": of_belt(without_a_point),
    "a belt dropped": without_a_belt,
    "a corner dropped": step_dropped("corner"),
    "a stick dropped": step_dropped("stick", "slip"),
    "belts swapped": lambda rng, it: swap(rng, it["parameters"]["belts"]),
}


def changed(document: Document, change: str, rng: Random) -> Document:
    """Return a file with one thing changed."""
    other = deepcopy(document)
    LAW_CHANGES[change](rng, other)
    return other
