"""The command line on a real terminal: bars, colours, and Ctrl-C at any moment.

Nothing of that in a pipe.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from cli_runs import good
from terminals import on_terminal

pytestmark = pytest.mark.slow
COLOUR = re.compile(r"\x1b\[[\d;]*m")
SWEEP = ["sweep", "fig9", "--over", "Omega=3:5:40", "--t-end", "12T", "--skip", "10T"]
LEFT = r"\d left"  # the end of a bar
#: Commands that take long, what to wait for before Ctrl-C, and what may be left behind.
LONG = {
    "sweep": (
        ["sweep", "fig9", "--over", "Omega=1:6:90000", "--t-end", "9T", "-o", "map.csv"],
        r"\d/90000",
        True,
    ),
    "digits": (
        ["simulate", "fig8", "--digits", "2000", "--t-end", "400000", "--csv", "events.csv"],
        LEFT,
        False,
    ),
    "check": (["grazing", "fig9", "--check", "1000000", "--plot", "window.svg"], LEFT, False),
    "derive": (["derive", "all", "-o", "pages"], LEFT, False),
    "reproduce": (["reproduce", "-o", "reproduced"], LEFT, False),
}


def test_a_sweep_shows_a_bar_with_rate_and_time_left(tmp_path: Path) -> None:
    pytest.importorskip("xarray")
    shown = on_terminal(*SWEEP, folder=tmp_path, SYMOSC_PROGRESS_DELAY="0")
    assert shown.code == 0
    for text in ("40/40", "motions/s", "0:00:00 left", "P32"):
        assert text in shown.text, text
    quiet = on_terminal(*SWEEP, "--quiet", folder=tmp_path)
    assert "motions/s" not in quiet.text
    assert "P32" in quiet.text
    assert quiet.text.replace("\r\n", "\n") == good(*SWEEP)


def test_tables_have_colours_on_a_terminal_alone(tmp_path: Path) -> None:
    shown = on_terminal("simulate", "fig6", folder=tmp_path)
    plain = on_terminal("simulate", "fig6", folder=tmp_path, NO_COLOR="1")
    narrow = on_terminal("simulate", "fig6", folder=tmp_path, columns=60)
    assert len(set(COLOUR.findall(shown.text))) > 2
    assert not COLOUR.search(plain.text)
    piped = good("simulate", "fig6")
    assert "\x1b" not in piped
    for each in (shown, plain, narrow):  # no number is cut, no cell folded
        assert COLOUR.sub("", each.text).replace("\r\n", "\n") == piped


def test_work_of_unknown_length_shows_that_it_goes_on(tmp_path: Path) -> None:
    shown = on_terminal(
        "simulate",
        "fig8",
        "--digits",
        "3000",
        "--t-end",
        "4000",
        folder=tmp_path,
        interrupt="working",
    )
    assert shown.code == 130
    assert "0:00:0" in shown.text


#: Commands that take long, and what their bars count.
COUNTED = {
    "simulate": (["simulate", "fig9", "--t-end", "1e8", "--max-events", "100000000"], "events/s"),
    "digits": (["simulate", "fig9", "--digits", "1500", "--t-end", "2000000"], "events/s"),
    "check": (["grazing", "fig9", "--map", "P2", "--check", "1000000"], "phases/s"),
}


@pytest.mark.full(2)
@pytest.mark.parametrize("name", COUNTED)
def test_work_of_known_length_has_a_bar_with_rate_and_time_left(name: str, tmp_path: Path) -> None:
    command, unit = COUNTED[name]
    shown = on_terminal(*command, folder=tmp_path, interrupt=LEFT)
    assert shown.code == 130, shown.text
    assert re.search(rf"━ .* \d+ %.*{unit}, .*\d:\d\d:\d\d left", COLOUR.sub("", shown.text))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.full(2)
@pytest.mark.parametrize("name", LONG)
def test_an_interrupt_ends_quietly_and_leaves_nothing_half_written(
    name: str, tmp_path: Path
) -> None:
    if name == "sweep":
        pytest.importorskip("xarray")
    command, when, keeps = LONG[name]
    shown = on_terminal(*command, folder=tmp_path, interrupt=when)
    assert shown.code == 130, shown.text
    assert "Traceback" not in shown.text
    left = [path.name for path in tmp_path.iterdir()]
    assert len(left) <= int(keeps), left  # the finished chunks of a sweep
    assert "map.csv" not in left


#: The program, which gets an interrupt when it opens its n-th module.
INTERRUPTED = """
import runpy, signal, sys
def opened(event, arguments, left=[int(sys.argv.pop(1))]):
    left[0] -= event == "import"
    if left[0] == 0:
        left[0] = -1
        signal.raise_signal(signal.SIGINT)
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.addaudithook(opened)
runpy.run_module("symosc", run_name="__main__", alter_sys=True)
"""


@pytest.mark.parametrize("module", [1, 30, 150, 450])
def test_an_interrupt_while_it_loads(module: int, tmp_path: Path) -> None:
    command = [sys.executable, "-c", INTERRUPTED, str(module), "figure", "fig5", "-o", "fig5.pdf"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert list(tmp_path.iterdir()) == []
    if (
        "KeyboardInterrupt" in ended.stderr
    ):  # Python's own words, before it comes to the command line
        assert "symosc/cli" not in ended.stderr
    else:
        assert (ended.returncode, ended.stderr) == (130, "")
