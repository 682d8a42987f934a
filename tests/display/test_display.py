"""Bars with rate and time left on a terminal, plain tables, and what pages of notebooks are made of."""

from __future__ import annotations

import io
import random
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from tabulate import tabulate

from symosc.display import progress
from symosc.display.html import HEAD_ROWS, PICTURE_HEIGHT, PICTURE_WIDTH, TAIL_ROWS, curve, ends, table
from symosc.display.progress import late_bar, pace, reporting
from symosc.display.tables import plain_table, print_table

# --- progress ---


def test_rate_and_time_left() -> None:
    assert pace(5000, 10_000, 2.0) == "2,500 motions/s, 0:00:04 left"
    assert pace(3, 3600, 6.0) == "0.5 motions/s, 2:00:00 left"
    assert pace(86_400, 864_000, 86_400.0) == "1 motions/s, 10 days, 0:00:00 left"


class Terminal(io.StringIO):
    """A terminal with a clock that is put forward by hand."""

    now = 0.0

    def isatty(self) -> bool:
        return True


def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setattr(progress, "monotonic", lambda: shown.now)
    monkeypatch.delenv("SYMOSC_PROGRESS_DELAY", raising=False)
    return shown


def test_a_bar_on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with reporting(True, 40, 100) as report:  # 40 of an earlier run
        for terminal.now, done in ((1.0, 70), (2.0, 100)):
            report(done, 100)
    for text in ("40/100", "70/100", "100/100", "30 motions/s", "left"):
        assert text in terminal.getvalue()


def test_a_bar_comes_after_two_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = on_terminal(monkeypatch)
    with late_bar(True, "simulate", "events") as advance:
        assert advance is not None
        for terminal.now, part, count in ((1.0, 0.1, 10), (1.9, 0.2, 20)):
            advance(part, count)
        assert terminal.getvalue() == ""
        for terminal.now, part, count in ((2.5, 0.25, 25), (4.0, 0.5, 400)):
            advance(part, count)
        assert all(text in terminal.getvalue() for text in ("simulate", "50 %", "100 events/s, 0:00:04 left"))
        for terminal.now, part, count in ((4.0, 0.0, 0), (8.0, 0.25, 48)):  # work that begins anew
            advance(part, count)
        assert "12 events/s, 0:00:12 left" in terminal.getvalue()


@pytest.mark.parametrize(("delay", "shows"), [("0", (True, True)), ("100", (False, False)), ("x", (False, True))])
def test_the_delay_is_a_setting(delay: str, shows: tuple[bool, bool], monkeypatch: pytest.MonkeyPatch) -> None:
    """What is no number counts as the usual two seconds."""
    terminal = on_terminal(monkeypatch)
    monkeypatch.setenv("SYMOSC_PROGRESS_DELAY", delay)
    with late_bar(True, "simulate", "events") as advance:
        assert advance is not None
        for terminal.now, shown in zip((1.0, 3.0), shows, strict=True):
            advance(0.1, 1)
            assert ("simulate" in terminal.getvalue()) is shown
    if delay == "0":
        with progress.working("waits"):
            assert "waits" in terminal.getvalue()


def test_a_pipe_has_no_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    for wanted in (True, False):
        with reporting(wanted, 0, 100) as report, late_bar(wanted, "simulate", "events") as advance:
            report(100, 100)
            assert advance is None
    assert sys.stderr.getvalue() == ""  # type: ignore[attr-defined]


def test_a_function_of_the_caller_gets_the_progress() -> None:
    calls: list[tuple[float, float]] = []

    def note(done: float, total: float) -> None:
        calls.append((done, total))

    with reporting(note, 0, 9) as report, late_bar(note, "simulate", "events") as advance:
        report(4, 9)
        assert advance is not None
        advance(0.5, 7)
    assert calls == [(4, 9), (0.5, 1.0)]


# --- tables ---

CELLS = ["", "x", "P4645", "Omega1 -> belt1", "1e-15", "3", "-4.0", "1.5e-07", "0.25", "12345.678", "nan", "-17", "…"]


@pytest.mark.parametrize("seed", range(8))
def test_plain_tables_are_those_of_tabulate(seed: int) -> None:
    rng = random.Random(seed)
    heads = rng.sample(["t", "x", "kind", "from -> to", "t error", "belt"], rng.randint(1, 6))
    rows = [[rng.choice(CELLS) for _ in heads] for _ in range(rng.randint(1, 9))]
    decimals = rng.sample(heads, rng.randint(0, len(heads)))
    align = ["decimal" if head in decimals else "left" for head in heads]
    expected = tabulate(rows, heads, tablefmt="simple", disable_numparse=True, colalign=align)
    assert plain_table(heads, rows, decimals) == expected
    assert plain_table(heads, []).splitlines()[0].split() == " ".join(heads).split()


def test_a_table_is_drawn_on_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    for shown, drawn in ((Terminal(), True), (io.StringIO(), False)):
        monkeypatch.setattr(sys, "stdout", shown)
        assert print_table(["t", "kind"], [["1.5", "stick"]], ["t"]) is drawn
        assert ("stick" in shown.getvalue()) is drawn


# --- pages ---

SVG = "{http://www.w3.org/2000/svg}"


@pytest.mark.parametrize("count", [0, 10, 11, 100_000])
def test_a_long_table_shows_its_ends(count: int) -> None:
    numbers = ends(count)
    root = ElementTree.fromstring(table(["i"], [[i] for i in numbers], count))
    cells = [cell.text or "" for cell in root.iter("td")]
    if count > HEAD_ROWS + TAIL_ROWS:
        assert cells.pop(HEAD_ROWS) == f"… {count - HEAD_ROWS - TAIL_ROWS:,} more"
        assert numbers == [*range(HEAD_ROWS), *range(count - TAIL_ROWS, count)]
    assert cells == [str(i) for i in numbers]
    assert len(numbers) == min(count, HEAD_ROWS + TAIL_ROWS)


@pytest.mark.parametrize("seed", range(3))
def test_a_curve_stays_inside_its_frame(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size, shift = 10.0 ** rng.integers(-200, 200), 10.0 ** rng.integers(-3, 9)
    x, y = rng.normal(size=(2, 900)) * size + shift
    y[rng.random(900) < 0.1] = np.nan
    root = ElementTree.fromstring(curve("a & b", x, y, [(float(np.nanmax(x)), float(np.nanmin(y)))]))
    path = root.find(f"{SVG}path").attrib["d"]  # type: ignore[union-attr]
    points = np.array([pair.split() for pair in path.replace("M", "L").split("L") if pair], dtype=float)
    assert len(points) > 400
    assert path.count("M") > 10  # it is broken where y is not known
    assert (points >= 0).all()
    assert (points <= [PICTURE_WIDTH, PICTURE_HEIGHT]).all()
    assert root.find(f"{SVG}title").text == "a & b"  # type: ignore[union-attr]


def test_what_is_no_curve_has_no_picture() -> None:
    nan = float("nan")
    assert [curve("", *each) for each in (([], []), ([1.0], [2.0]), ([1.0, 2.0], [nan, 1.0]))] == ["", "", ""]
    assert "M6.0 65.0L254.0 65.0" in curve("", [0, 1], [5, 5])  # a constant one is in the middle
