"""What each command prints, writes and draws, if all is right.

`grazing`, `check`, `score` have files of their own.
"""

from __future__ import annotations

import json
import re
import signal
import socket
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import pytest
from cli_runs import good, run
from effort import PATIENCE

import symosc
from symosc.symbolic.export import export

# -- simulate


def test_the_table_shows_every_event_of_fig5() -> None:
    lines = good("simulate", "fig5").splitlines()
    assert re.split(r"\s{2,}", lines[0].strip()) == [
        *("t", "x", "v", "theta", "kind", "belt", "from -> to", "t error", "x error")
    ]
    trajectory = symosc.simulate("fig5")
    rows = [re.split(r"\s{2,}", line.strip()) for line in lines[2 : 2 + len(trajectory.events)]]
    for row, event in zip(rows, trajectory.events, strict=True):
        assert [float(value) for value in row[:4]] == pytest.approx(
            [event.t, event.x, event.v, event.theta], rel=1e-13
        )
        assert row[4:7] == [event.kind, str(event.boundary), f"{event.source} -> {event.target}"]
        assert float(row[7]) == pytest.approx(event.t_error, rel=0.5)
    assert lines[-2] == f"word, in order of time: {' '.join(trajectory.word)}"
    assert lines[-1] == "t_end: reached t_end = 40; 16 events"


def test_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(good("scenes", "fig9"))
    assert good("simulate", str(path)) == good("simulate", "fig9")


def test_samples_are_a_csv_file(tmp_path: Path) -> None:
    path = tmp_path / "motion.csv"
    assert good("simulate", "fig5", "--samples", "41", "-o", str(path)) == good("simulate", "fig5")
    header, *rows = path.read_text().splitlines()
    assert header == "t,x,v,mode"
    assert [float(row.split(",")[0]) for row in rows] == [float(t) for t in range(41)]
    assert good("simulate", "fig5", "--samples", "41", "-o", "-") == path.read_text()
    t, x, _, mode = rows[5].split(",")
    assert float(x) == symosc.simulate("fig5")(5.0)[0]
    assert mode == symosc.simulate("fig5").mode(float(t))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--samples", "9"], "--samples needs --output FILE"),
        (["-o", "motion.csv"], "--output needs --samples N"),
        (["--samples", "1", "-o", "motion.csv"], "1 is not in the range"),
        (["--samples", "9", "-o", "-", "--json"], "something else prints there already"),
    ],
)
def test_samples_need_a_count_and_a_file(options: list[str], message: str) -> None:
    found = run("simulate", "fig5", *options)
    assert found.exit_code == 2
    assert message in found.stderr


# -- scenes and new


@pytest.mark.parametrize("name", symosc.scene_names())
def test_a_printed_scene_is_the_scene(name: str, tmp_path: Path) -> None:
    path = tmp_path / "copy.toml"
    path.write_text(good("scenes", name))
    assert symosc.load_scene(path) == symosc.load_scene(name)


def test_the_error_of_a_start_survives_the_scene_file(tmp_path: Path) -> None:
    text = good("scenes", "fig8-exact")
    assert "start_error = [0, 5e-45, 5e-45]" in text
    assert json.loads(good("scenes", "fig8-exact", "--json"))["start_error"] == [
        "0",
        "5e-45",
        "5e-45",
    ]
    assert "start_error" not in good("scenes", "fig8")
    path = tmp_path / "one.toml"
    for given, read in (
        ('"1/3"', Fraction(1, 3)),
        ("1e-9", Fraction(1, 10**9)),
        ("0", Fraction(0)),
    ):
        path.write_text(re.sub(r"start_error = .*", f"start_error = {given}", text))
        assert symosc.load_scene(path).start_error == (read,) * 3
        copy = tmp_path / "copy.toml"
        copy.write_text(good("scenes", str(path)))
        assert symosc.load_scene(copy).start_error == (read,) * 3


@pytest.mark.parametrize("name", ["mine.toml", "no/such/folder.toml", "mine.txt", "link.toml"])
def test_nothing_is_lost_and_nothing_half_written(name: str, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("mine")
    (tmp_path / "link.toml").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.iterdir())
    found = run("new", str(tmp_path / name))
    assert found.exit_code == 2
    assert found.stderr.count("\n") == 1
    assert (tmp_path / "mine.toml").read_text() == "mine"
    assert sorted(tmp_path.iterdir()) == before
    assert run("new", str(tmp_path / "mine.toml"), "--force").exit_code == 0


def test_notes_go_to_stderr(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    good("new", str(file))
    file.write_text(file.read_text().replace("x0 = 0 ", 'x0 = "pi/6" '))
    found = run("simulate", str(file), "--t-end", "2", "--json")
    assert found.stderr == "symosc: mine: x0 = pi/6: read to 40 digits, 0.5235987755982988730771…\n"
    assert found.stdout.startswith("{")


# -- codegen


@pytest.mark.slow
def test_codegen_prints_and_compares(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    from symosc.symbolic import codegen

    assert (
        good("codegen", "P32", "--language", "numpy", "-o", "-") == export("P32", "numpy")["p32.py"]
    )
    assert "is what the formulas print" in good("codegen", "--check")
    committed = codegen.PATH.read_text()
    monkeypatch.setattr(codegen, "PATH", tmp_path / "_generated.py")
    codegen.PATH.write_text("committed\n")
    result = run("codegen", "--check")
    assert (result.exit_code, "-committed\n" in result.stdout) == (1, True)
    assert "accept: symosc codegen --regenerate" in result.stderr
    good("codegen", "--regenerate")
    assert codegen.PATH.read_text() == committed


# -- explore


@pytest.mark.slow
def test_it_serves_the_scene_and_ends_quietly() -> None:
    pytest.importorskip("bokeh")
    # An interrupt that a shell's background job ignores would be ignored by its children too.
    heard = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    begin = f"{heard}; from symosc.cli.app import main; main()"
    command = [
        sys.executable,
        "-c",
        begin,
        "explore",
        "fig9",
        "--set",
        "k=1/3",
        "--no-browser",
        "--port",
        "0",
    ]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        try:
            line = process.stdout.readline()
            assert line.startswith("http://127.0.0.1:")
            assert 'value="1/3"' in urlopen(line.split()[0], timeout=PATIENCE).read().decode()
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 130
            assert process.stderr.read() == ""
        finally:
            process.kill()


def test_a_port_in_use_is_one_line() -> None:
    pytest.importorskip("bokeh")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        result = run("explore", "--no-browser", "--port", str(taken.getsockname()[1]))
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "name another one" in result.stderr


def test_an_interrupt_tells_how_far_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("symosc.sweep", interrupted)
    result = run("sweep", "fig9", "--over", "k=3:5:6", "-o", "map.nc")
    assert result.exit_code == 130
    assert (
        result.stderr == "symosc: interrupted: 0 of 6 motions are kept; the same command goes on\n"
    )
