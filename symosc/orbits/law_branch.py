"""Branches of periodic orbits of any friction law: `LawCurve` both ways, and what becomes of the orbit
at the ends.

The margin that has vanished at an end, measured by the size of its like on the orbit, names the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from symosc.base.errors import ParameterError, SymoscError
from symosc.orbits.admissibility import Condition
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.law_border import ONSET
from symosc.orbits.law_curve import CurvePoint, LawCurve, LawCurveEnd
from symosc.orbits.law_margins import margins
from symosc.orbits.settling import settled_orbit_of

#: A margin that is a larger part of its like than this has not vanished.
VANISHED = 1e-3
#: Samples of each piece of an orbit.
SAMPLES = 256
#: Distances beyond an end, as parts of the range, at which an orbit is looked for.
BEYOND = (1e-9, 1e-7, 1e-5)
#: How near to the last orbit the one beyond an end is, as a part of its size.
NEAR = 1e-2


class LawEnd(NamedTuple):
    """An end of a branch: its kind, the value, a message, margins that vanish, and the word beyond."""

    kind: str
    value: float
    message: str
    conditions: tuple[Condition, ...]
    beyond: str | None


def end_of(curve: LawCurve, points: list[CurvePoint], end: LawCurveEnd) -> LawEnd:
    """Return the end of a branch with what happens there."""
    name = curve.parameter
    if end.why == "range":
        message = f"{name} reaches the end of its range"
        if not _is_allowed_beyond(curve, points[-1]):
            message += ", beyond which there is no such friction law"
        return LawEnd("end of the range", end.value, message, (), None)
    if end.why == "most":
        return LawEnd("max_points", end.value, "the branch goes on", (), None)
    if end.why == "closed":
        return LawEnd("closed curve", end.value, "the branch comes back to its beginning", (), None)
    if end.why == "shrunk":
        message = "the cycle shrinks to a rest, at a corner of the friction curve"
        return LawEnd(ONSET, end.value, message, (), None)
    if end.why == "family":
        message = "the cycle stays in a band without damping, and so does every smaller one"
        return LawEnd(ONSET, end.value, message, (), None)
    last = points[-1]
    found = margins(last.orbit)
    vanished = tuple(margin for margin in found if margin.value < VANISHED * margin.scale)
    beyond, near = _beyond(curve, points)
    if not vanished:
        message = "no orbit with the word is found beyond"
        return LawEnd("no convergence", end.value, message, tuple(found[:1]), beyond)
    first = min(vanished, key=lambda margin: (margin.rank, margin.value / margin.scale))
    message = f"the condition '{first.text}' fails at t = {first.t:.6g}"
    kind = first.event
    if not near:
        message += "; no orbit is near beyond"
        other = _instead(curve, points)
        if other:
            message += f", the motion goes to {other}"
    return LawEnd(kind, end.value, message, vanished, beyond)


def _is_allowed_beyond(curve: LawCurve, last: CurvePoint) -> bool:
    """Return whether a law may have a value of the parameter just beyond the last one."""
    goes = 1.0 if last.tangent[2] > 0 else -1.0
    try:
        curve.law(last.value + goes * BEYOND[0] * (curve.high - curve.low))
    except ParameterError:
        return False
    return True


def _beyond(curve: LawCurve, points: list[CurvePoint]) -> tuple[str | None, bool]:
    """Return the word of an orbit just beyond the end, None if none is found, and whether one is."""
    last = points[-1]
    goes = 1.0 if last.tangent[2] > 0 else -1.0
    for part in BEYOND:
        value = last.value + goes * part * (curve.high - curve.low)
        orbit = curve.orbit_near(last, value)
        if orbit is None or orbit.labels == last.orbit.labels:
            continue
        off = abs(float(orbit.period) - last.span) / last.span
        times = np.linspace(0.0, last.span, SAMPLES)
        if curve.periods:
            off = max(off, float(np.abs(orbit(times) - last.orbit(times)).max()) / curve.size)
        if off < NEAR:
            return orbit.word or None, True
    return None, False


def _instead(curve: LawCurve, points: list[CurvePoint]) -> str:
    """Describe where the motion goes just beyond an end without an orbit near."""
    last = points[-1]
    goes = 1.0 if last.tangent[2] > 0 else -1.0
    try:
        law = curve.law(last.value + goes * BEYOND[-1] * (curve.high - curve.low))
        orbit = settled_orbit_of(law, last.t, last.x, last.section.speed)
    except ConvergenceError as error:
        return "chaos" if "chaotic" in error.reason else ""
    except SymoscError:
        return ""
    if orbit.is_rest:
        return orbit.message
    return orbit.word
