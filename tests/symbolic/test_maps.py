"""The derivatives of the mappings are proven."""

from __future__ import annotations

import pytest

from symosc.symbolic import maps as derived


@pytest.mark.slow
def test_proof() -> None:
    residuals = derived.prove()
    assert len(residuals) == 9
    assert {name: residual for name, residual in residuals.items() if residual != 0} == {}
