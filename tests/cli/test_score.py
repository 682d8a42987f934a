"""`symosc cases` and `symosc score`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from cli_runs import good


@pytest.mark.slow
def test_a_folder(tmp_path: Path) -> None:
    target = tmp_path / "cases"
    assert good("cases", "--group", "easy", "-o", str(target)) == f"wrote 2 cases into {target}\n"
    assert (target / "easy-fig9" / "events.csv").is_file()
    answer = json.loads(good("cases", "--group", "easy", "-o", str(target), "--json"))
    assert answer == {"folder": str(target), "cases": ["easy-fig9", "easy-fig10"]}
    assert good("score", str(target), str(target)).splitlines()[-1] == "cases: right in all 2 cases"
