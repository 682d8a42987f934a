"""The wrong steps of a solution, each with a guess why it is wrong."""

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
    "double root": "a belt met and left within the step",
    "crossing inside the step": "a crossing inside the step",
    "undecidable": "a contact that cannot be decided",
    "local error": "an error inside a domain",
}
# Another motion explains a step if its defect is at most this fraction of the exact motion's
# defect.
EXPLAINS = 0.02


@dataclass(frozen=True)
class Fault:
    """A wrong step: the exact motion from its first sample does not reach the next one.

    Attributes
    ----------
    step : int
        From sample `step` to the next one.
    t, t_next : float
    defect_x, defect_v : float
        Exact motion minus the next sample.
    expected, found : str
        Mode at the end of the step: of the exact motion, and of the samples ("" where they are
        passing a belt).
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
        """Whether the samples stick, slip or cross where the exact motion does otherwise."""
        return self.found not in ("", self.expected)


def explain(
    steps: ExactSteps,
    chosen: Sequence[int],
    modes: np.ndarray,
    sizes: np.ndarray,
    allowed: np.ndarray,
    near: np.ndarray,
) -> tuple[Fault, ...]:
    """Return a `Fault` with a guess at the cause for each of the wrong steps that have the numbers `chosen`.

    `modes` are the mode codes of the samples, 0 where a sample only passes a belt. `allowed` is the
    defect in x and v up to which each step is right, and `sizes` the defect of each step divided by
    it. A sample is on a belt if its v differs from the belt's speed by at most `near`.
    """
    since = np.array(chosen, dtype=int)
    misses = []  # of flights with the force of each domain, to the next sample and to the one after
    for n in (1, 2):
        until = np.minimum(since + n, len(steps.t) - 1)
        gaps = np.array(
            [steps.flight(domain, since, until) - steps.states[until] for domain in (1, 2, 3)]
        )
        misses.append(np.max(np.abs(gaps / allowed[since]), axis=2))

    def guess(i: int, to_next: np.ndarray, over_next: np.ndarray) -> tuple[str, str]:
        """Return why step `i` is probably wrong: a key of REASONS, and a sentence about this step.

        Three flights from sample i, one with the force of each domain, miss the next sample by
        `to_next`, and the sample after that by `over_next`; both are arrays of three numbers in
        units of the allowed defect.
        """
        if not np.isfinite(sizes[i]):
            return (
                "undecidable",
                "the exact motion over the step cannot be decided in double precision",
            )
        if steps.t[i + 1] == steps.t[i]:
            return "jump", f"samples {i} and {i + 1} are at one time and differ"
        first = int(steps.first[i])
        last = int(steps.last[i])
        found = int(modes[i + 1])
        rows = steps.events.rows(i, i)
        limit = max(1.0, EXPLAINS * float(sizes[i]))
        times = steps.events.t[rows]
        fitting = (1 + np.flatnonzero(to_next <= limit)).tolist()
        at_once = len(times) and times[0] - steps.t[i] <= 1e-6 * steps.K.period
        gaps = steps.v[i : i + 2] - steps.belts[:, None]
        nearest = int(np.argmin(np.abs(gaps[:, 0]))) + 1
        here = f"v - v{nearest} = {gaps[nearest - 1, 0]:.2g} at its start"
        near_start = abs(gaps[nearest - 1, 0]) <= near[i]
        if (
            last > 3
            and found == last
            and abs(gaps[last - 4, 1]) > 0.0
            and abs(steps.defects[i, 0]) <= allowed[i, 0]
        ):
            return (
                "drift on the belt",
                f"v should be v{last - 3} in the stick and is off by {gaps[last - 4, 1]:.2g}",
            )
        if fitting and not len(times) and first <= 3:
            return (
                "wrong force",
                f"the force of Omega{fitting[0]} explains the step, which lies in Omega{first}",
            )
        if first > 3 and found <= 3:
            return (
                "event at the start",
                f"the mass sticks to belt {first - 3} here, the samples leave it ({here})",
            )
        if fitting and near_start and (not len(times) or at_once):
            return (
                "event at the start",
                f"the force of Omega{fitting[0]} explains the step ({here})",
            )
        if found <= 3 and first <= 3 and at_once:
            return "sign tolerance", f"{here}: the step begins on the wrong side of the belt"
        if found > 3 and last <= 3 and modes[i] == found:
            return (
                "sign tolerance",
                f"the mass leaves belt {found - 3}, the samples stay on it ({here})",
            )
        if len(times) and last == first and found == first:
            what = f"the motion meets belt {steps.events.boundary[rows][0]} at t = {times[0]:.10g} and is back at t ="
            return (
                "double root",
                f"{what} {times[-1]:.10g}; signs at the ends of the step do not show it",
            )
        if not len(times) and i + 2 < len(steps.t) and first <= 3 and over_next[first - 1] <= limit:
            left = over_next[first - 1]
            if left <= 1.0:
                part = "is right"
            else:
                part = f"is off by {left / sizes[i]:.0e} of that"
            return "outlier", f"without sample {i + 1} the step from {i} to {i + 2} {part}"
        if len(times):
            if fitting:
                force = f"; the force of Omega{fitting[0]} was kept"
            else:
                force = ""
            what = f"{MODE_NAMES[first]} -> {MODE_NAMES[int(steps.events.target[rows][0])]} at t = {times[0]:.10g}"
            return "crossing inside the step", what + force
        what = f"the step lies in {MODE_NAMES[first]} and has no event"
        return "local error", what

    found = []
    for k, i in enumerate(chosen):
        (t, t_next) = steps.t[i : i + 2].tolist()
        (dx, dv) = steps.defects[i].tolist()
        expected = MODE_NAMES[int(steps.last[i])]
        mode = MODE_NAMES.get(int(modes[i + 1]), "")
        reason, words = guess(i, misses[0][:, k], misses[1][:, k])
        found.append(Fault(i, t, t_next, dx, dv, expected, mode, reason, words))
    return tuple(found)
