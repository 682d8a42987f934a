"""Derivatives in the random scenes of the fuzzer.

Python tests/support/derivative_checks.py --seconds 600 --seed 1

Each is compared with the difference quotient of motions that the independent oracle follows in
quadruple precision, and where that differs or is not sure, of motions with 60 and 110 digits and
far smaller steps. Where both sides have other events, or other one-sided quotients, there is no
derivative, and `regular` must be False.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from random import Random
from typing import Any

import fuzz
from fast_oracle import DIGITS as QUADRUPLE
from fast_oracle import simulate_fast
from scene_families import FuzzScene
from verdicts import label

from symosc import ParameterError, sensitivities, simulate
from symosc.model import PARAMETER_NAMES
from symosc.simulation.tangents import NAMES

#: Steps by the digits of the motions; None: those of the independent oracle.
STEPS = {None: Fraction(1, 10**11), 60: Fraction(1, 10**25), 110: Fraction(1, 10**45)}
WRONG = 1e-9  # of the largest derivative of the column so far, or of 1
KINK = 1e-3  # by which one-sided quotients differ, relative to the same
EPS = 1e-16
#: Relative errors of the input of so many EPS are no fault of a derivative.
ROUNDINGS = 100.0


@dataclass
class Judged:
    """A derivative: what was found, and whether it exists.

    `allowed` is the error that rounding the input makes.
    """

    scene: FuzzScene
    name: str
    event: int
    regular: bool
    smooth: bool
    error: float
    allowed: float
    clear: bool = False  # said to be regular by 30 digits, where doubles cannot tell

    @property
    def verdict(self) -> str:
        if not self.smooth:
            if self.regular:
                return "kink missed"
            return "kink named"
        if not self.regular:
            if self.clear:
                return "not told by doubles"
            return "said to be a kink"
        if self.error <= WRONG:
            return "right"
        if self.error <= self.allowed:
            return "right for doubles"
        return "wrong"


def moved(scene: FuzzScene, name: str, by: Fraction, digits: int | None) -> Any:
    """Return the events of a scene with a changed number."""
    p = scene.p
    start = {each: getattr(scene, each) for each in ("t0", "x0", "v0")}
    if name in start:
        start[name] += by
    elif name:
        p = p.replace(**{name: getattr(p, name) + by})
    if digits is None:
        return simulate_fast(p, *start.values(), scene.t_end, scene.dps).events
    return simulate(p, **start, t_end=scene.t_end, digits=digits).events


def quotients(scene: FuzzScene, name: str, base: Any, digits: int | None) -> Any:
    """Yield for each event of `base` by differences dt, dx and how one-sided ones differ.

    None from where events do.
    """
    own = abs(getattr(scene if name in ("t0", "x0", "v0") else scene.p, name))
    h = STEPS[digits] * (own or 1)
    more, less = (moved(scene, name, sign * h, digits) for sign in (1, -1))
    same = True
    for n, event in enumerate(base):
        same = (
            same
            and n < min(len(more), len(less))
            and label(more[n]) == label(less[n]) == label(event)
        )
        if same:
            triples = [
                [getattr(each[n], axis) for each in (more, base, less)] for axis in ("t", "x")
            ]
        else:
            triples = ()
        rows = [
            (float(a - c) / (2 * float(h)), float(a - 2 * b + c) / float(h), float(own) or 1.0)
            for a, b, c in triples
        ]
        yield rows or None


def judged(scene: FuzzScene, names: tuple[str, ...] = NAMES) -> list[Judged]:
    """Judge all derivatives of a scene."""
    start = {each: getattr(scene, each) for each in ("t0", "x0", "v0", "t_end")}
    s = sensitivities(scene.p, names, **start)
    base = cache(lambda digits: moved(scene, "", Fraction(0), digits))
    found: list[Judged] = []
    for j, name in enumerate(names):
        rows: list[Judged] = []
        with suppress(ParameterError):  # a step to values that are not allowed
            for digits in list(STEPS)[scene.dps > QUADRUPLE :]:
                rows = column(scene, s, j, name, base(digits), digits)
                if all(row.verdict in ("right", "kink named") for row in rows):
                    break
            found += rows
    if any(row.verdict == "said to be a kink" for row in found) and any(
        "rounding" in (r or "") for r in s.reasons
    ):
        exact = sensitivities(scene.p, names, **start, digits=30)
        for row in found:
            row.clear = row.event < len(exact.dt) and bool(
                exact.regular[row.event, names.index(row.name)]
            )
    wrong = [row for row in found if row.verdict == "wrong"]
    if wrong:
        rounded(scene, s, names, wrong)
    return found


def rounded(scene: FuzzScene, s: Any, names: tuple[str, ...], rows: list[Judged]) -> None:
    """Set the errors that are allowed to those which relative errors of EPS in all numbers make, times ROUNDINGS."""
    start = {each: getattr(scene, each) for each in ("t0", "x0", "v0")}
    dice = Random(1)
    belt = next((each for each in ("v1", "v2") if getattr(scene.p, each) == scene.v0), "")

    def nearby(by: Fraction) -> Any:
        p = scene.p.replace(
            **{q: getattr(scene.p, q) * (1 + dice.choice((-1, 1)) * by) for q in PARAMETER_NAMES}
        )
        moved = {each: value * (1 + dice.choice((-1, 1)) * by) for each, value in start.items()}
        # a start on a belt stays there
        if belt:
            moved |= {"v0": getattr(p, belt)}
        else:
            moved |= {}
        return sensitivities(p, names, **moved, t_end=scene.t_end, digits=30)

    exact, *beside = map(nearby, (Fraction(0), *[Fraction(1, 10**16)] * 3))
    for row in rows:
        j = names.index(row.name)
        n = row.event
        scale = max(
            1.0, float(abs(exact.dt[: n + 1, j]).max()), float(abs(exact.dx[: n + 1, j]).max())
        )
        near = [each for each in beside if n < len(each.dt)]  # the last event may be at t_end
        off = [
            abs(getattr(each, axis)[n, j] - getattr(exact, axis)[n, j])
            for each in near
            for axis in ("dt", "dx")
        ]
        row.allowed = ROUNDINGS * float(max(off)) / scale


def column(
    scene: FuzzScene, s: Any, j: int, name: str, base: Any, digits: int | None
) -> list[Judged]:
    """Judge the derivatives of all events by one number."""
    rows = []
    scale = [1.0, 1.0]
    for n, quotient in enumerate(quotients(scene, name, base, digits)):
        if n >= len(s.dt) or label(s.trajectory.events[n]) != label(base[n]):
            break
        for axis, value in enumerate((float(s.dt[n, j]), float(s.dx[n, j]))):
            smooth = quotient is not None
            error = 0.0
            allowed = 0.0
            if quotient is not None:
                middle, apart, size = quotient[axis]
                scale[axis] = max(scale[axis], abs(middle))
                h = size * float(STEPS[digits])
                smooth = abs(apart) <= KINK * scale[axis]
                error = abs(value - middle) / scale[axis]
                allowed = ROUNDINGS * EPS * abs(apart) / h * size / scale[axis]
            rows.append(Judged(scene, name, n, bool(s.regular[n, j]), smooth, error, allowed))
    return rows


def scene_of(family: str, seed: int, number: int, most_events: int) -> FuzzScene:
    """Return a scene of the fuzzer, up to so many events."""
    scene = fuzz.scene_of(family, seed, number)
    motion = simulate(scene.p, t0=scene.t0, x0=scene.x0, v0=scene.v0, t_end=scene.t_end)
    if len(motion.events) <= most_events:
        return scene
    cut = Fraction(float(motion.events[most_events].t)).limit_denominator(10**6)
    return fuzz.plain.with_digits(scene, t_end=cut, truth=None)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--family", choices=fuzz.FAMILIES, action="append")
    parser.add_argument("--most-events", type=int, default=40)
    options = parser.parse_args()
    begin = time.perf_counter()
    number = options.first
    families = Counter[Any]()
    while time.perf_counter() - begin < options.seconds:
        for family in options.family or fuzz.FAMILIES:
            try:
                rows = judged(scene_of(family, options.seed, number, options.most_events))
            except Exception as error:
                print(f"# {family} {number}: {type(error).__name__}: {error}", flush=True)
                families[family, "unjudged scenes"] += 1
                continue
            families.update((family, row.verdict) for row in rows)
            for verdict in ("wrong", "kink missed", "said to be a kink"):
                bad = [row for row in rows if row.verdict == verdict]
                if bad:
                    names = ", ".join(dict.fromkeys(row.name for row in bad))
                    worst = max(row.error for row in bad)
                    first = min(row.event for row in bad)
                    print(
                        f"# {family} {number}: {verdict} {len(bad)} times by {names} from event {first}, {worst:.1e}"
                    )
        number += 1
        print(
            f"{number - options.first} scenes of each family, {time.perf_counter() - begin:.0f} s",
            flush=True,
        )
    for key, count in sorted(families.items()):
        print(*key, count)
    return int(any(verdict in ("wrong", "kink missed") for _, verdict in families))


if __name__ == "__main__":
    sys.exit(main())
