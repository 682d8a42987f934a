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


def assert_same_figures(readme: str, page: str) -> None:
    """All that stands between the README's marks, but the link at its end, is on the page of results."""
    block = readme.partition("<!-- results: begin -->\n")[2].partition("<!-- results: end -->")[0]
    figures = block.partition("[All solvers")[0]
    assert "| units per event" in figures
    assert figures in page


def cells(table: str) -> list[list[str]]:
    lines = [line for line in table.splitlines() if line.startswith("|") and "|--" not in line]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]


def test_readme_and_pages_of_results_say_the_same() -> None:
    """Those that are committed: the ratios are quotients of the times beside them, and all are of one table."""
    top = Path(__file__).parents[2]
    readme, folder = (top / "README.md").read_text(encoding="utf-8"), top / results.RESULTS_FOLDER
    page = (folder / "README.md").read_text(encoding="utf-8")
    assert_same_figures(readme, page)
    best = {row[0]: row[1:] for row in cells(page.partition("## Work and precision")[2].partition("## Hard")[0])}
    scenes, compared = best.pop(""), 0
    for part in (folder / "work_precision.md").read_text(encoding="utf-8").split("\n**")[1:]:
        scene, (heads, *rows) = part.partition("**")[0], cells(part)
        assert heads[2:5] == ["time / ours", "us per event", "error"]
        timed = [(row[0], *map(float, row[2:5])) for row in rows if row[2] and row[4]]
        ours = [us for solver, _, us, _ in timed if solver == "symosc, compiled"][-1]
        assert [ratio for _, ratio, _, _ in timed] == pytest.approx([us / ours for _, _, us, _ in timed], rel=0.02)
        for solver, shown in best.items():
            ratio, _, rest = shown[scenes.index(scene)].partition(" ×, ")
            if rest:
                error = float(rest.partition(",")[0])
                same = [row for row in timed if row[0] == solver and 0.6 < row[3] / error < 1.6]
                assert any(abs(row[1] / float(ratio) - 1) < 0.06 for row in same), (solver, scene)
                compared += 1
        heyoka = [ratio for solver, ratio, _, _ in timed if solver == "heyoka"][-1]
        assert any(f"{heyoka * part:.2g} ({scene}" in " ".join(readme.split()) for part in (1, 1.001, 0.999))
    assert compared > 100


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
    assert page.read_text().startswith("# Results\n\nWritten by one run of `symosc bench --quick --results README.md`")
    assert_same_figures(text, page.read_text())
    links = [part.partition(")")[0] for part in page.read_text().split("](")[1:]]
    assert sorted(page.parent / link for link in links) == sorted(written[2:])
    assert all(file.stat().st_size > 100 for file in written)
    assert "hang: more than 600 s" in (tmp_path / results.RESULTS_FOLDER / "work_precision.md").read_text()
    before = [file.read_bytes() for file in written]
    results.write(path, result)
    assert [file.read_bytes() for file in written] == before
