"""Results go into the README and their own pages, between the marks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from bench_work import SPEED, rows

from symosc.bench import plot_work, results
from symosc.errors import OutputError

MARKED = "# Title\n\n<!-- results: begin -->\nold\n<!-- results: end -->\n\nend\n"


def test_only_what_is_between_the_marks_is_replaced() -> None:
    text = results.replaced(MARKED.replace("begin", "begin; by hand"), "results", "new \\1\n")
    assert text == "# Title\n\n<!-- results: begin; by hand -->\nnew \\1\n<!-- results: end -->\n\nend\n"


@pytest.mark.parametrize(
    "text",
    ["", MARKED.replace("end -->", "-->"), MARKED + MARKED, "<!-- results: end -->\n<!-- results: begin -->\n"],
    ids=["none", "no end", "twice", "wrong order"],
)
def test_a_readme_without_a_place_for_results_is_refused(text: str, tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    path.write_text(text)
    with pytest.raises(OutputError, match=r"needs the lines '<!-- results: begin -->'"):
        results.check(path)
    assert path.read_text() == text


def test_a_readme_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="No such file"):
        results.check(tmp_path / "none.md")


@pytest.mark.slow
def test_results_are_written_into_the_readme(
    work: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "README.md"
    path.write_text(MARKED)
    heyoka = [{**rows(work, "careless", scene)[1], "solver": "heyoka", "over_ours": 17.4} for scene in ("fig5", "fig9")]
    measured = {**work, "rows": [*work["rows"], *heyoka]}
    case = {"failure": "", "error": 1e-14, "missed": 0, "invented": 0, "found": 3, "worst": 0.1, "undecidable": None}
    hard = {"machine": SPEED["machine"], "limit_s": 6.0, "skipped": {}, "ok": True, "violations": []}
    hard["solvers"] = [{"name": "symosc", "raw": False, "tolerance": 0.0, "note": "", "ours": True}]
    hard["rows"] = [
        {"group": "near-grazing", "case": "c", "events": 3, "condition": 2.0, "open": "", "cells": {"symosc": case}}
    ]
    monkeypatch.setattr(results.plot_error_map, "figure", lambda result: plot_work.figure(work))
    result = {"quick": True, "work_precision": measured, "speed": SPEED, "hard": hard, "error_map": {}}
    written = results.write(path, result)
    text = path.read_text()
    assert text.startswith("# Title\n\n<!-- results: begin -->\nOne run of `symosc bench`")
    assert text.endswith("<!-- results: end -->\n\nend\n")
    assert "old" not in text
    assert max(map(len, text.splitlines())) <= 120
    assert "heyoka at its finest tolerance takes 17 (fig5), 17 (fig9) times as long as symosc." in " ".join(
        text.split()
    )
    page = tmp_path / results.RESULTS_FOLDER / "README.md"
    assert text.split("](")[1].partition(")")[0] == f"{results.RESULTS_FOLDER}/README.md"
    assert page.read_text().startswith("# Results\n\nOne run of `symosc bench --quick --results README.md`")
    links = [part.partition(")")[0] for part in page.read_text().split("](")[1:]]
    assert sorted(page.parent / link for link in links) == sorted(written[2:])
    assert all(file.stat().st_size > 100 for file in written)
    assert "hang: more than 1 s" in (tmp_path / results.RESULTS_FOLDER / "work_precision.md").read_text()
    before = [file.read_bytes() for file in written]
    results.write(path, result)
    assert [file.read_bytes() for file in written] == before
