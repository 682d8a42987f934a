"""Claims that tests make up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from stand_in_claims import CHECKS

from symosc.paper.claims import Claim, read_claims


@pytest.fixture
def read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[Claim, ...]]:
    """Return a function that reads claims given as TOML, whose checks are those above."""
    package = tmp_path / "fake_checks"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "stand_ins.py").write_text(CHECKS)
    monkeypatch.syspath_prepend(tmp_path)

    def read(text: str) -> tuple[Claim, ...]:
        (tmp_path / "claims.toml").write_text(text, encoding="utf-8")
        return read_claims(["fig1"], tmp_path / "claims.toml", "fake_checks")[0]

    return read
