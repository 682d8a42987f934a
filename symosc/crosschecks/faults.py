"""The wrong steps of a solution, each with a guess why it is wrong."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from symosc.crosschecks.bands import BELT_OF, DOMAIN_OF
from symosc.crosschecks.steps import ExactSteps
from symosc.friction import ALL_MODE_NAMES

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
# An event is at the start of a step if it is this part of a forcing period after it.
AT_ONCE = 1e-6


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


class WrongStep:
    """A wrong step, the exact motion over it, and flights from its first sample.

    `mode` is that of the samples at its end, 0 where they only pass a belt; `first` and `last` are
    the modes of the exact motion, `times` those of its events. A flight with the force of one of
    the domains `fitting` reaches the next sample. `over_next` is how far the flight of each domain
    misses the sample after that, in units of the allowed defect. `held` and `held_first` are the
    belts of the samples' mode at the end and of the exact motion's at the start, 0 if it is none.
    """

    def __init__(
        self,
        steps: ExactSteps,
        i: int,
        modes: np.ndarray,
        sizes: np.ndarray,
        allowed: np.ndarray,
        near: np.ndarray,
        to_next: np.ndarray,
        over_next: np.ndarray,
    ) -> None:
        self.steps = steps
        self.i = i
        self.size = float(sizes[i])
        self.allowed = allowed[i]
        self.near = float(near[i])
        self.over_next = over_next
        self.mode_before = int(modes[i])
        self.mode = int(modes[i + 1])
        self.first = int(steps.first[i])
        self.last = int(steps.last[i])
        self.held = int(BELT_OF[self.mode])
        self.held_first = int(BELT_OF[self.first])
        self.held_last = int(BELT_OF[self.last])
        self.rows = steps.events.rows(i, i)
        self.times = steps.events.t[self.rows]
        self.limit = max(1.0, EXPLAINS * self.size)
        self.fitting: list[int] = (1 + np.flatnonzero(to_next <= self.limit)).tolist()
        self.at_once = False
        if len(self.times):
            self.at_once = bool(self.times[0] - steps.t[i] <= AT_ONCE * steps.K.period)
        #: v minus the speeds of all belts, at the first and at the next sample.
        self.gaps_before = steps.v[i] - steps.belts
        self.gaps_after = steps.v[i + 1] - steps.belts
        #: The index of the belt that is nearest to v at the first sample.
        self.nearest = int(np.argmin(np.abs(self.gaps_before)))

    @property
    def start_text(self) -> str:
        """Where v is at the start of the step, in words."""
        gap = self.gaps_before[self.nearest]
        return f"v - v{self.nearest + 1} = {gap:.2g} at its start"


def _undecidable(step: WrongStep) -> str:
    """Say that doubles cannot decide the exact motion over the step."""
    if np.isfinite(step.size):
        return ""
    return "the exact motion over the step cannot be decided in double precision"


def _jump(step: WrongStep) -> str:
    """Say that no time passes in the step."""
    if step.steps.t[step.i + 1] != step.steps.t[step.i]:
        return ""
    return f"samples {step.i} and {step.i + 1} are at one time and differ"


def _drift(step: WrongStep) -> str:
    """Say that v drifts off the belt in a stick."""
    belt = step.held_last
    if not belt or step.mode != step.last:
        return ""
    gap = step.gaps_after[belt - 1]
    defect_x, _ = step.steps.defects[step.i]
    allowed_x, _ = step.allowed
    if gap == 0.0 or abs(defect_x) > allowed_x:
        return ""
    return f"v should be v{belt} in the stick and is off by {gap:.2g}"


def _wrong_force(step: WrongStep) -> str:
    """Say that the force of another domain explains a step without event."""
    if not step.fitting or len(step.times) or step.held_first:
        return ""
    own = ALL_MODE_NAMES[step.first]
    if own == f"Omega{step.fitting[0]}":  # it is the force of the domain in another band
        return ""
    return f"the force of Omega{step.fitting[0]} explains the step, which lies in {own}"


def _event_at_start(step: WrongStep) -> str:
    """Say that an event at the start of the step is decided otherwise."""
    if step.held_first and not step.held:
        return (
            f"the mass sticks to belt {step.held_first} here, the samples leave it "
            f"({step.start_text})"
        )
    near_start = abs(step.gaps_before[step.nearest]) <= step.near
    if step.fitting and near_start and (not len(step.times) or step.at_once):
        return f"the force of Omega{step.fitting[0]} explains the step ({step.start_text})"
    return ""


def _sign_tolerance(step: WrongStep) -> str:
    """Say that the step begins, or ends a stick, on the wrong side of a belt."""
    if not step.held and not step.held_first and step.at_once:
        return f"{step.start_text}: the step begins on the wrong side of the belt"
    if step.held and not step.held_last and step.mode_before == step.mode:
        return f"the mass leaves belt {step.held}, the samples stay on it ({step.start_text})"
    return ""


def _double_root(step: WrongStep) -> str:
    """Say that the motion meets a belt and comes back within the step."""
    if not len(step.times) or not step.first == step.last == step.mode:
        return ""
    belt = step.steps.events.boundary[step.rows][0]
    met = f"the motion meets belt {belt} at t = {step.times[0]:.10g}"
    back = f"is back at t = {step.times[-1]:.10g}"
    return f"{met} and {back}; signs at the ends of the step do not show it"


def _outlier(step: WrongStep) -> str:
    """Say that the next sample alone is off."""
    i = step.i
    if len(step.times) or i + 2 >= len(step.steps.t) or step.held_first:
        return ""
    left = step.over_next[DOMAIN_OF[step.first] - 1]
    if not left <= step.limit:
        return ""
    verdict = "is right" if left <= 1.0 else f"is off by {left / step.size:.0e} of that"
    return f"without sample {i + 1} the step from {i} to {i + 2} {verdict}"


def _crossing(step: WrongStep) -> str:
    """Say which event the step has."""
    if not len(step.times):
        return ""
    target = int(step.steps.events.target[step.rows][0])
    event = f"{ALL_MODE_NAMES[step.first]} -> {ALL_MODE_NAMES[target]} at t = {step.times[0]:.10g}"
    if step.fitting:
        return f"{event}; the force of Omega{step.fitting[0]} was kept"
    return event


def _local(step: WrongStep) -> str:
    """Say that the step has no event."""
    return f"the step lies in {ALL_MODE_NAMES[step.first]} and has no event"


#: What says in words how a step shows each of REASONS, "" if it does not; the first that fits
#: counts.
GUESSES: tuple[tuple[str, Callable[[WrongStep], str]], ...] = (
    ("undecidable", _undecidable),
    ("jump", _jump),
    ("drift on the belt", _drift),
    ("wrong force", _wrong_force),
    ("event at the start", _event_at_start),
    ("sign tolerance", _sign_tolerance),
    ("double root", _double_root),
    ("outlier", _outlier),
    ("crossing inside the step", _crossing),
    ("local error", _local),
)


def _first_guess(step: WrongStep) -> tuple[str, str]:
    """Return the first of REASONS that fits a step, and how the step shows it."""
    for reason, in_words in GUESSES:
        words = in_words(step)
        if words:
            return reason, words
    raise AssertionError("the last guess fits every step")


def _flight_misses(
    steps: ExactSteps, since: np.ndarray, count: int, allowed: np.ndarray
) -> np.ndarray:
    """Return how far flights over `count` steps miss the sample at their end, in units of the
    allowed defect.

    The flights begin at the samples numbered `since`; there is a row for the force of each domain.
    """
    until = np.minimum(since + count, len(steps.t) - 1)
    domains = range(1, len(steps.belts) + 2)
    ends = np.array([steps.flight(domain, since, until) for domain in domains])
    gaps = ends - steps.states[until]
    return np.asarray(np.max(np.abs(gaps / allowed[since]), axis=2))


def explain(
    steps: ExactSteps,
    chosen: Sequence[int],
    modes: np.ndarray,
    sizes: np.ndarray,
    allowed: np.ndarray,
    near: np.ndarray,
) -> tuple[Fault, ...]:
    """Return a `Fault` with a guess at the cause for each of the wrong steps with the numbers
    `chosen`.

    `modes` are the mode codes of the samples, 0 where a sample only passes a belt. `allowed` is the
    defect in x and v up to which each step is right, and `sizes` the defect of each step divided by
    it. A sample is on a belt if its v differs from the belt's speed by at most `near`.
    """
    since = np.array(chosen, dtype=int)
    to_next = _flight_misses(steps, since, 1, allowed)
    # Over two steps a flight shows whether the sample between them is the only wrong one.
    over_next = _flight_misses(steps, since, 2, allowed)
    faults = []
    for k, i in enumerate(chosen):
        step = WrongStep(steps, i, modes, sizes, allowed, near, to_next[:, k], over_next[:, k])
        reason, words = _first_guess(step)
        t, t_next = steps.t[i : i + 2].tolist()
        dx, dv = steps.defects[i].tolist()
        expected = ALL_MODE_NAMES[step.last]
        mode = ALL_MODE_NAMES.get(step.mode, "")
        faults.append(Fault(i, t, t_next, dx, dv, expected, mode, reason, words))
    return tuple(faults)
