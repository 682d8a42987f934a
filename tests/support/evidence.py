"""Sentences "with … all steps are right" of a diagnosis, tried as a reader would.

The check with that change.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from symosc import crosscheck
from symosc.crosschecks.report import CrossCheck

SENTENCE = re.compile(
    r"(?:^|; )(with(?:out)? .*?|swapped) (?:all (\d+) steps are right|(\d+) of (\d+) steps are wrong)"
)
NUMBER = r"(-?[\d.]+(?:e[-+]?\d+)?)"


def sentences(check: CrossCheck) -> Iterator[tuple[str, int, int]]:
    """Yield what the evidence of all diagnoses claims.

    The change, how many steps are wrong with it, of how many.
    """
    for first in check.diagnosis:
        for one in (first, *first.alternatives):
            for change, right, wrong, steps in SENTENCE.findall(one.evidence):
                yield change, int(wrong or 0), int(steps or right)


def tried(check: CrossCheck, change: str) -> CrossCheck | None:
    """Return the check with a change; None if the words alone do not say how to make it."""
    p = check.trajectory.parameters
    t = check.t
    x = check.x
    v = check.v
    if found := re.fullmatch(rf"with {NUMBER} taken from t after t = {NUMBER}", change):
        shift, begin = map(float, found.groups())
        # The time is printed with ten digits; it is that of a sample.
        late = t > t[np.argmin(np.abs(t - begin))]
        return crosscheck(p, np.where(late, t - shift, t), x, v)
    if values := re.findall(rf"(\w+) = {NUMBER}", change):
        return crosscheck(p.replace(**{name: float(value) for name, value in values}), t, x, v)
    if found := re.fullmatch(r"with -(A0|B0|v1|v2)", change):
        return crosscheck(p.replace(**{found[1]: -getattr(p, found[1])}), t, x, v)
    if found := re.fullmatch(rf"with (x|v|x and v|t) divided by {NUMBER}", change):
        columns = found[1].split(" and ")
        by = float(found[2])
        return crosscheck(
            p, *(a / by if name in columns else a for name, a in (("t", t), ("x", x), ("v", v)))
        )
    if found := re.fullmatch(rf"with {NUMBER} taken from t", change):
        return crosscheck(p, t - float(found[1]), x, v)
    if found := re.fullmatch(rf"with the phase turned by {NUMBER}", change):
        return crosscheck(p, t + float(found[1]) / float(p.Omega), x, v)
    if found := re.fullmatch(rf"with even times, {NUMBER} apart,", change):
        begins = (float(t[0]), float(f"{t[0]:.6g}"))
        made_even = [
            crosscheck(p, begin + float(found[1]) * np.arange(len(t)), x, v) for begin in begins
        ]
        return min(made_even, key=lambda check: len(check.wrong_steps))
    made: dict[str, Any] = {
        "with mu1 and mu2 swapped": lambda: (p.replace(mu1=p.mu2, mu2=p.mu1), t, x, v),
        "with -x": lambda: (p, t, -x, v),
        "with -v": lambda: (p, t, x, -v),
        "with -x, -v": lambda: (p, t, -x, -v),
        "swapped": lambda: (p, t, v, x),
        "with v + v1": lambda: (p, t, x, v + float(p.v1)),
        "with v + v2": lambda: (p, t, x, v + float(p.v2)),
        "with v of the next sample": lambda: (p, t[:-1], x[:-1], v[1:]),
        "with v of the sample before": lambda: (p, t[1:], x[1:], v[:-1]),
        "with positions alone": lambda: (p, t, x),
    }
    if change in made:
        return crosscheck(*made[change]())
    return None


def false_sentences(check: CrossCheck) -> list[str]:
    """Return the changes with which not as many steps are wrong as a diagnosis says."""
    found = []
    for change, wrong, steps in sentences(check):
        again = tried(check, change)
        if again is not None and (len(again.wrong_steps), len(again.defects)) != (wrong, steps):
            found.append(
                f"{change}: {wrong} of {steps}, and is {len(again.wrong_steps)} of {len(again.defects)}"
            )
    return found
