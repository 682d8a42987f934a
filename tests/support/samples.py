"""Sizes of random samples: small ones in every run, large ones on request (pytest -m campaign)."""

from collections.abc import Iterable
from typing import Any

import pytest


def sample_of(quick: int, full: int) -> pytest.MarkDecorator:
    """Parametrise a test by the `count` of its sample."""
    return pytest.mark.parametrize("count", [quick, pytest.param(full, marks=pytest.mark.campaign)])


def few(cases: Iterable[Any], *slow: Any) -> list[Any]:
    """Return the cases as parameters of a test.

    Those in `slow` take long, and others of the quick set do like them.
    """
    cases = list(cases)
    assert set(slow) < set(cases), "a case that is not there, or none left"
    return [pytest.param(case, marks=pytest.mark.slow) if case in slow else case for case in cases]
