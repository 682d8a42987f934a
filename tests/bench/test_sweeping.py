"""What a sweep costs beyond its motions: measured on a small one."""

from __future__ import annotations

import pytest

from symosc.bench import sweeping


@pytest.mark.slow
def test_what_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("xarray")
    monkeypatch.setattr(sweeping, "QUICK_SWEPT_MOTIONS", 20)
    monkeypatch.setattr(sweeping, "FORCING_PERIODS", 2)
    found = sweeping.run(quick=True)
    assert (found["motions"], found["periods"]) == (20, 2)
    assert found["motions_per_s"] > 0
    assert f"{100 * found['overhead']:+.1f} % over the bare call" in sweeping.table(found)


def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweeping, "find_spec", lambda name: None)
    assert sweeping.run() == {}
    assert sweeping.table({}) == "sweeps: they need the extra sweep"
