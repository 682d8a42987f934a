"""The tables of published results: every value agrees, and the committed page is what they print."""

from __future__ import annotations

import pytest
from chapters import table

from symosc.derive import bibliography, literature_page
from symosc.derive.comparisons import BORDER, CLOSED, TABLES, Value
from symosc.derive.published import MP

#: The others bisect, or expand long expressions, for seconds each.
QUICK = ("amplitude", "resonance", "decay", "continuum", "rests")
KEYS = [key if key in QUICK else pytest.param(key, marks=pytest.mark.slow) for key in TABLES]


@pytest.mark.quick(2)
@pytest.mark.parametrize("key", KEYS)
def test_formula_and_package_agree(key: str) -> None:
    values = table(key)
    assert len(values) >= 2
    for value in values:
        assert value.tolerance in (CLOSED, BORDER)
        assert abs(value.difference) <= value.tolerance, value


@pytest.mark.slow
def test_counts_of_stops_go_from_0_to_14() -> None:
    said = " ".join(value.said for key in ("border", "stops") for value in table(key))
    assert {int(word) for word in said.replace(",", "").split() if word.isdigit()} == {0, 2, 4, 6, 8, 10, 12, 14}


@pytest.mark.slow
def test_the_committed_page_is_current(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(literature_page, "table", table)
    committed = (literature_page.DOCS / literature_page.PAGE).read_text(encoding="utf-8")
    assert committed == literature_page.page(), "accept it with: python -m symosc.derive.literature_page"


def test_sources_are_known() -> None:
    assert {source for _, sources, _ in TABLES.values() for source in sources} <= set(bibliography.entries())
    assert set(literature_page.NOTES) == set(TABLES)


def test_a_difference_is_relative() -> None:
    assert abs(Value("x", "", MP.mpf(200), 202.0).difference + MP.mpf("0.01")) < 1e-15
    assert abs(Value("x", "", 0, 0.5).difference + MP.mpf("0.5")) < 1e-15


@pytest.mark.slow
def test_the_figure_has_points_on_its_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    """The amplitudes drawn for P32 lie on the curves; borders by running are left out here, they take long."""
    monkeypatch.setattr(literature_page, "_border_near", lambda r, c: 0.5)
    monkeypatch.setattr(literature_page, "FINE", 9)
    drawn = literature_page.figure().axes[1]
    for axes in literature_page.figure().axes:
        colours = {line.get_color() for line in axes.lines}
        assert colours == {"0"}
    assert len(drawn.lines) >= 4
    assert all(len(line.get_xdata()) for line in drawn.lines)
