"""Sizes of random samples: small ones in every run, large ones on request (pytest -m campaign)."""

import pytest


def sample_of(quick: int, full: int) -> pytest.MarkDecorator:
    """Parametrise a test by the `count` of its sample."""
    return pytest.mark.parametrize("count", [quick, pytest.param(full, marks=pytest.mark.campaign)])
