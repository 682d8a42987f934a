"""What probably went wrong in a step that does not agree with the exact motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symosc.crosschecks.steps import ExactSteps
from symosc.model import MODE_NAMES

#: Reasons by name, in words.
REASONS = {
    "jump": "a jump where two pieces are joined",
    "wrong force": "wrong friction force",
    "outlier": "a sample off by itself",
    "event at the start": "an event at the start of the step",
    "sign tolerance": "sign tolerance",
    "drift on the belt": "drift on the belt",
    "double root": "double root near a graze",
    "crossing inside the step": "a crossing inside the step",
    "undecidable": "a contact that cannot be decided",
    "local error": "local error of the method",
}
# Another motion explains a step if its defect is this part of the exact motion's.
EXPLAINS = 0.02


@dataclass(frozen=True)
class Fault:
    """A step that does not agree with the exact motion over it.

    Attributes
    ----------
    step : int
        From sample `step` to the next one.
    t, t_next : float
    defect_x, defect_v : float
        Exact motion minus the next sample.
    expected, found : str
        Mode at the end of the step: of the exact motion, and of the samples ("" where they are passing a belt).
    reason : str
        A guess at the cause, one of REASONS.
    words : str
        The guess in words.

    Examples
    --------
    >>> import numpy as np
    >>> from symosc import crosscheck, simulate
    >>> t = np.linspace(0, 7, 200)
    >>> x, v = simulate("fig5", t_end=7)(t)
    >>> v[100] += 0.1
    >>> crosscheck("fig5", t, x, v).first_wrong.words
    'without sample 100 the step from 99 to 101 is right'
    """

    step: int
    t: float
    t_next: float
    defect_x: float
    defect_v: float
    expected: str
    found: str
    reason: str
    words: str

    @property
    def wrong_decision(self) -> bool:
        """Whether the samples stick, slip or pass where the exact motion does something else."""
        return self.found not in ("", self.expected)


def explain(
    steps: ExactSteps,
    chosen: Sequence[int],
    modes: np.ndarray,
    sizes: np.ndarray,
    allowed: np.ndarray,
    near: np.ndarray,
) -> tuple[Fault, ...]:
    """Return the faults of steps.

    Parameters
    ----------
    steps : ExactSteps
    chosen : sequence of int
    modes : (n,) int array
        Modes of the samples, 0 where they only pass a belt.
    sizes : (n - 1,) array
        Defects in units of what is allowed.
    allowed : (n - 1, 2) array
    near : (n,) array
        Distances from a belt that count as on it.
    """
    since = np.array(chosen, dtype=int)
    misfits = np.stack([_misfits(steps, since, np.minimum(since + n, len(steps.t) - 1), allowed) for n in (1, 2)])
    found = []
    for k, i in enumerate(since.tolist()):
        reason, words = _guess(steps, i, modes, sizes, allowed, near, misfits[:, :, k])
        dx, dv = (float(value) for value in steps.defects[i])
        expected, mode = MODE_NAMES[int(steps.last[i])], MODE_NAMES.get(int(modes[i + 1]), "")
        found.append(Fault(i, float(steps.t[i]), float(steps.t[i + 1]), dx, dv, expected, mode, reason, words))
    return tuple(found)


def _misfits(steps: ExactSteps, since: np.ndarray, until: np.ndarray, allowed: np.ndarray) -> np.ndarray:
    """Return what flights with the force of each domain miss, in units of what is allowed, shape (3, steps)."""
    ahead = np.column_stack([steps.x, steps.v])[until]
    gaps = np.array([steps.flight(domain, since, until) - ahead for domain in (1, 2, 3)])
    return np.asarray(np.max(np.abs(gaps / allowed[since]), axis=2))


def _guess(
    steps: ExactSteps,
    i: int,
    modes: np.ndarray,
    sizes: np.ndarray,
    allowed: np.ndarray,
    near: np.ndarray,
    misfits: np.ndarray,
) -> tuple[str, str]:
    """Return a reason and its words; `misfits` are those to the next sample, and to the one after, for each domain."""
    if not np.isfinite(sizes[i]):
        return "undecidable", "the exact motion over the step cannot be decided in double precision"
    if steps.t[i + 1] == steps.t[i]:
        return "jump", f"samples {i} and {i + 1} are at one time and differ"
    first, last, found = int(steps.first[i]), int(steps.last[i]), int(modes[i + 1])
    rows = steps.events.rows(i, i)
    targets, times = steps.events.target[rows], steps.events.t[rows]
    boundaries = steps.events.boundary[rows]
    limit = max(1.0, EXPLAINS * float(sizes[i]))

    fitting = [domain for domain in (1, 2, 3) if misfits[0, domain - 1] <= limit]
    gaps = steps.v[i : i + 2] - np.array([[steps.K.belt1.v], [steps.K.belt2.v]])
    nearest = int(np.argmin(np.abs(gaps[:, 0]))) + 1
    here = f"v - v{nearest} = {gaps[nearest - 1, 0]:.2g} at its start"
    near_start = abs(gaps[nearest - 1, 0]) <= near[i]
    if last > 3 and found == last and abs(gaps[last - 4, 1]) > 0.0 and abs(steps.defects[i, 0]) <= allowed[i, 0]:
        return "drift on the belt", f"v should be v{last - 3} in the stick and is off by {gaps[last - 4, 1]:.2g}"
    if fitting and not len(times) and first <= 3:
        return "wrong force", f"the force of Omega{fitting[0]} explains the step, which lies in Omega{first}"
    if first > 3 and found <= 3:
        return "event at the start", f"the mass sticks to belt {first - 3} here, the samples leave it ({here})"
    if fitting and near_start and (not len(times) or times[0] - steps.t[i] <= 1e-6 * steps.K.period):
        return "event at the start", f"the force of Omega{fitting[0]} explains the step ({here})"
    if found <= 3 and first <= 3 and len(times) and times[0] - steps.t[i] <= 1e-6 * steps.K.period:
        return "sign tolerance", f"{here}: the step begins on the wrong side of the belt"
    if found > 3 and last <= 3 and modes[i] == found:
        return "sign tolerance", f"the mass leaves belt {found - 3}, the samples stay on it ({here})"
    if len(times) and last == first and found == first:
        what = f"the motion meets belt {boundaries[0]} at t = {times[0]:.10g} and is back at t = {times[-1]:.10g}"
        return "double root", f"{what}; signs at the ends of the step do not show it"
    if not len(times) and i + 2 < len(steps.t) and first <= 3 and misfits[1, first - 1] <= limit:
        part = (
            "is right" if misfits[1, first - 1] <= 1.0 else f"is off by {misfits[1, first - 1] / sizes[i]:.0e} of that"
        )
        return "outlier", f"without sample {i + 1} the step from {i} to {i + 2} {part}"
    if len(times):
        force = f"; the force of Omega{fitting[0]} was kept" if fitting else ""
        what = f"{MODE_NAMES[first]} -> {MODE_NAMES[int(targets[0])]} at t = {times[0]:.10g}"
        return "crossing inside the step", what + force
    return (
        "local error",
        f"no event in the step, motion in {MODE_NAMES[first]}: tolerances of the method, or another model",
    )
