"""A few reference cases of all kinds that are quick to compute, and results made of what is known of them."""

from __future__ import annotations

from collections.abc import Sequence

from symosc import ReferenceCase, reference_cases
from symosc.reference.results import CaseResult, GivenEvent

NAMES = (
    "paper-fig5",
    "paper-fig6",
    "graze-overdamped-P3",
    "rest-1",
    "free-decay-2",
    "continuum-1-2",
)


def small_set() -> Sequence[ReferenceCase]:
    """Return the cases."""
    return [case for case in reference_cases() if case.name in NAMES]


def right(case: ReferenceCase) -> CaseResult:
    """Return the results of a perfect solver."""
    events = [GivenEvent(*event.middle, event.kind, event.boundary) for event in case.events]
    return CaseResult(events, end=case.t_end)
