"""The command line: what it prints, its exit codes, and that bad input costs one line and leaves nothing behind."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import click
import pytest
from click.testing import CliRunner, Result

import symosc
from symosc.cli import main

COMMANDS = main.list_commands(click.Context(main))
PROGRAM = [sys.executable, "-m", "symosc"]


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, prog_name="symosc")


def shell(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*PROGRAM, *arguments], capture_output=True, text=True, **options)  # type: ignore[call-overload]


def good(*arguments: str) -> str:
    result = run(*arguments)
    assert (result.exit_code, result.stderr) == (0, ""), result.output
    return result.stdout


# --- simulate ---


def test_the_table_shows_every_event_of_fig5() -> None:
    lines = good("simulate", "fig5").splitlines()
    assert re.split(r"\s{2,}", lines[0].strip()) == [
        *("t", "x", "v", "theta", "kind", "belt", "from -> to", "t error", "x error")
    ]
    trajectory = symosc.simulate("fig5")
    rows = [re.split(r"\s{2,}", line.strip()) for line in lines[2 : 2 + len(trajectory.events)]]
    for row, event in zip(rows, trajectory.events, strict=True):
        assert [float(value) for value in row[:4]] == pytest.approx([event.t, event.x, event.v, event.theta], rel=1e-13)
        assert row[4:7] == [event.kind, str(event.boundary), f"{event.source} -> {event.target}"]
        assert float(row[7]) == pytest.approx(event.t_error, rel=0.5)
    assert lines[-2] == f"word, in order of time: {' '.join(trajectory.word)}"
    assert lines[-1] == "t_end: reached t_end = 40; 16 events"


def test_no_events_and_one_event() -> None:
    assert good("simulate", "fig7").splitlines() == [
        "word, in order of time: none",
        "t_end: reached t_end = 15.1; 0 events",
    ]
    assert good("simulate", "fig7-exact").endswith("; 1 event\n")
    assert "stopped after max_events = 3" in good("simulate", "fig5", "--max-events", "3")


def test_json_is_the_trajectory() -> None:
    data = json.loads(good("simulate", "fig10", "--json", "--t-end", "5"))
    trajectory = symosc.simulate("fig10", t_end=5)
    assert data == {"scene": "fig10", **trajectory.as_dict()}
    assert [event["t"] for event in data["events"]] == [event.t for event in trajectory.events]


def test_digits_are_all_there() -> None:
    text = good("simulate", "fig8", "--digits", "40", "--t-end", "8")
    assert "3.139006225737682851938965627055696709296" in text
    data = json.loads(good("simulate", "fig8", "--digits", "40", "--t-end", "8", "--json"))
    assert data["events"][0]["t"] == "3.139006225737682851938965627055696709296"


def test_csv_round_trips(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    good("simulate", "fig9", "--csv", str(path))
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row, event in zip(rows, symosc.simulate("fig9").events, strict=True):
        assert (float(row["t"]), float(row["x"]), float(row["theta"])) == (event.t, event.x, event.theta)
        assert (row["kind"], row["source"], row["target"]) == (event.kind, event.source, event.target)


def test_starts_and_parameters_from_the_command_line() -> None:
    arguments = ["--t0", "1/3", "--x0", "-0.5", "--v0", "-2", "--t-end", "12", "--set", "k=3/2", "--set", "mu2=0"]
    data = json.loads(good("simulate", "fig5", "--json", *arguments))
    p = symosc.load_scene("fig5").parameters.replace(k="3/2", mu2=0)
    assert data["parameters"] == p.as_dict()
    trajectory = symosc.simulate(p, t0="1/3", x0="-0.5", v0=-2, t_end=12)
    assert data["events"] == trajectory.table()


def test_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(good("scenes", "fig9"))
    assert good("simulate", str(path)) == good("simulate", "fig9")


@pytest.mark.slow
def test_what_double_precision_cannot_decide_is_said_and_exits_1() -> None:
    result = run("simulate", "fig8", "--t-end", "160")
    assert result.exit_code == 1
    assert result.stderr.startswith("symosc: undecidable: ")
    assert result.stderr.count("\n") == 1
    assert "word, in order of time: P1 P3" in result.stdout
    as_json = run("simulate", "fig8", "--t-end", "160", "--json")
    assert as_json.exit_code == 1
    assert json.loads(as_json.stdout)["status"] == "undecidable"


# --- figure, scenes, codegen ---


def test_figure_writes_the_file_and_says_what_it_shows(tmp_path: Path) -> None:
    path = tmp_path / "fig5.pdf"
    assert good("figure", "fig5", "-o", str(path)) == f"{path}: t = 0 to 9, 6 events\n"
    assert path.read_bytes().startswith(b"%PDF-")
    assert "t = 0 to 3," in good("figure", "fig5", "-o", str(path), "--t-end", "3", "--panels", "c", "--columns", "1")


def test_scenes_lists_all_with_their_source() -> None:
    text = good("scenes")
    for name in symosc.scene_names():
        assert re.search(rf"^{name} ", text, re.MULTILINE)
    assert "WSEAS" in text.splitlines()[-1]
    data = json.loads(good("scenes", "--json"))
    assert [entry["name"] for entry in data] == symosc.scene_names()


@pytest.mark.parametrize("name", symosc.scene_names())
def test_a_printed_scene_is_the_scene(name: str, tmp_path: Path) -> None:
    path = tmp_path / "copy.toml"
    path.write_text(good("scenes", name))
    assert symosc.load_scene(path) == symosc.load_scene(name)


def test_the_error_of_a_start_survives_the_scene_file(tmp_path: Path) -> None:
    text = good("scenes", "fig8-exact")
    assert "start_error = [0, 5e-45, 5e-45]" in text
    assert json.loads(good("scenes", "fig8-exact", "--json"))["start_error"] == ["0", "5e-45", "5e-45"]
    assert "start_error" not in good("scenes", "fig8")
    path = tmp_path / "one.toml"
    for given, read in (('"1/3"', Fraction(1, 3)), ("1e-9", Fraction(1, 10**9)), ("0", Fraction(0))):
        path.write_text(re.sub(r"start_error = .*", f"start_error = {given}", text))
        assert symosc.load_scene(path).start_error == (read,) * 3
        copy = tmp_path / "copy.toml"
        copy.write_text(good("scenes", str(path)))
        assert symosc.load_scene(copy).start_error == (read,) * 3


def test_a_start_from_the_command_line_is_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    simulated = symosc.simulate
    seen: list[symosc.Scene] = []
    monkeypatch.setattr(symosc, "simulate", lambda scene, **rest: seen.append(scene) or simulated("fig6"))
    half = Fraction("5e-45")
    for arguments, errors in (([], (0, half, half)), (["--x0", "6"], (0, 0, half)), (["--v0", "2"], (0, half, 0))):
        good("simulate", "fig8-exact", *arguments)
        assert seen[-1].start_error == errors
    good("simulate", "fig8", "--x0", "6")
    assert seen[-1].start_error is None


def test_the_error_of_a_start_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    simulated = symosc.simulate
    seen: list[dict[str, Any]] = []
    monkeypatch.setattr(symosc, "simulate", lambda scene, **rest: seen.append(rest) or simulated("fig6"))
    for text, errors in (("1e-9", ("1e-9",) * 3), ("0,1/3,2e-8", ("0", "1/3", "2e-8")), (" 0, 0 ,0", ("0",) * 3)):
        good("simulate", "fig5", "--start-error", text)
        assert seen[-1]["start_error"] == tuple(map(Fraction, errors))
    good("simulate", "fig5")
    assert "start_error" not in seen[-1]


def test_a_fraction_survives_the_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "third.toml"
    path.write_text(good("scenes", "fig5").replace("k = 1", 'k = "1/3"'))
    copy = tmp_path / "copy.toml"
    copy.write_text(good("scenes", str(path)))
    assert symosc.load_scene(copy).parameters == symosc.load_scene("fig5").parameters.replace(k="1/3")


def test_codegen_check_prints_the_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    import symosc.symbolic.codegen as codegen

    monkeypatch.setattr(codegen, "check", lambda: "")
    assert "is what the formulas print" in good("codegen", "--check")
    monkeypatch.setattr(codegen, "check", lambda: "-committed\n+generated\n")
    result = run("codegen", "--check")
    assert (result.exit_code, result.stdout) == (1, "-committed\n+generated\n\n")
    assert "accept: symosc codegen --regenerate" in result.stderr


def test_codegen_writes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import symosc.symbolic.codegen as codegen

    monkeypatch.setattr(codegen, "PATH", tmp_path / "_generated.py")
    monkeypatch.setattr(codegen, "generate", lambda: "pass\n")
    assert run("codegen").exit_code == 2
    assert not (tmp_path / "_generated.py").exists()
    assert good("codegen", "--regenerate") == f"wrote {tmp_path / '_generated.py'}\n"
    assert (tmp_path / "_generated.py").read_text() == "pass\n"


# --- standard output as a file ---


def test_csv_to_standard_output_is_the_file(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    good("simulate", "fig6", "--csv", str(path))
    assert good("simulate", "fig6", "--csv", "-") == path.read_text()


def test_a_figure_to_standard_output_is_svg(tmp_path: Path) -> None:
    path = tmp_path / "fig6.svg"
    good("figure", "fig6", "-o", str(path), "--panels", "a")
    assert good("figure", "fig6", "-o", "-", "--panels", "a") == path.read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ["orbit", "fig9", "-o"],
        ["grazing", "fig9", "--map", "P2", "--plot"],
        ["check", "s.csv", "--scene", "fig6", "-o"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_the_figures_of_other_commands_go_there_too(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    trajectory = symosc.simulate("fig6", t_end=5)
    rows = [f"{t},{x!r},{v!r}" for t in (n / 64 for n in range(321)) for x, v in [trajectory(t).tolist()]]
    Path("s.csv").write_text("\n".join(["t,x,v", *rows]))
    text = good(*arguments, "-")
    assert text.startswith("<?xml")
    assert text.endswith("</svg>\n")
    assert [path.name for path in tmp_path.iterdir()] == ["s.csv"]


# --- help and errors ---


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command: str) -> None:
    assert re.search(rf"Examples?:\n +symosc {command}", good(command, "--help"))


BROKEN = {
    "broken.toml": "t_end = ",
    "keys.toml": "t_end = 3",
    "binary.toml": "\x00",
    "empty.toml": "",
}

BAD = [
    ([], "Missing command"),
    (["bogus"], "No such command 'bogus'"),
    (["simulate"], "Missing argument 'SCENE'"),
    (["simulate", "fig5", "--bogus"], "No such option"),
    (["simulate", "fig5", "fig6"], "unexpected extra argument"),
    (["simulate", "fig55"], "scene fig55: unknown"),
    (["simulate", "none.toml"], "No such file"),
    (["simulate", "broken.toml"], "is not valid TOML"),
    (["simulate", "keys.toml"], "is missing"),
    (["simulate", "binary.toml"], "is not valid TOML"),
    (["simulate", "fig5", "--set", "k"], "'k' is not NAME=VALUE"),
    (["simulate", "fig5", "--set", "kk=1"], "kk = '1': is no parameter"),
    (["simulate", "fig5", "--set", "k=x"], "k = 'x'"),
    (["simulate", "fig5", "--set", "k=nan"], "must be finite"),
    (["simulate", "fig5", "--set", "m=0"], "m = '0': must be > 0"),
    (["simulate", "fig5", "--set", "v1=5"], "must be less than v2"),
    (["simulate", "fig5", "--set", "k=1", "--set", "k=2"], "k is set twice"),
    (["simulate", "fig5", "--set", "t_end=1"], "use --t-end"),
    (["simulate", "fig5", "--t-end", "-1"], "must be later than t0"),
    (["simulate", "fig5", "--x0", "one"], "x0 = 'one'"),
    (["simulate", "fig5", "--start-error", ""], "start_error = ''"),
    (["simulate", "fig5", "--start-error", "x"], "start_error = 'x'"),
    (["simulate", "fig5", "--start-error", "-1"], "must be >= 0"),
    (["simulate", "fig5", "--start-error", "1,2"], "or three"),
    (["simulate", "fig5", "--start-error", "0,0,"], "start_error = ''"),
    (["simulate", "fig5", "--start-error", "nan"], "must be finite"),
    (["simulate", "fig5", "--max-events", "1_000"], "not a valid integer"),
    (["simulate", "fig5", "--max-events", "１"], "not a valid integer"),
    (["simulate", "fig5", "--digits", "1_0"], "not a valid integer"),
    (["simulate", "fig5", "--digits", "9" * 5000], "not a valid integer"),
    (["figure", "fig5", "-o", "a.pdf", "--columns", "２"], "not a valid integer"),
    (["grazing", "fig9", "--check", "1_000"], "not a valid integer"),
    (["grazing", "fig9", "--plot", ""], "name of a file"),
    (["grazing", "fig9", "--plot", "-", "--json"], "standard output"),
    (["grazing", "fig9", "--plot", "-", "--latex"], "standard output"),
    (["orbit", "fig9", "--periods", "1_000"], "not a valid integer"),
    (["orbit", "fig9", "--periods", "1000"], "from 1 to 200"),
    (["orbit", "fig9", "--structure", ""], "is empty"),
    (["orbit", "fig9", "-o", "-", "--json"], "standard output"),
    (["check", "keys.toml", "--scene", "fig9", "-o", ""], "name of a file"),
    (["bench", "-o", "-", "--json"], "standard output"),
    (["bench", "-o", ""], "name of a file"),
    (["simulate", "fig5", "--digits", "2"], "from 5 to 10000"),
    (["simulate", "fig5", "--digits", "many"], "not a valid integer"),
    (["simulate", "fig5", "--max-events", "0"], "must be a whole number >= 1"),
    (["simulate", "fig5", "--csv", "none/events.csv"], "cannot write none/events.csv: No such file"),
    (["simulate", "fig5", "--csv", "."], "is a folder"),
    (["figure", "fig5"], "Missing option '-o'"),
    (["figure", "fig5", "-o", "fig5.eps"], ".pdf, .svg or .png"),
    (["figure", "fig5", "-o", "none/fig5.pdf"], "cannot write none/fig5.pdf"),
    (["figure", "fig5", "-o", "a.pdf", "--panels", "z"], "panels = 'z'"),
    (["figure", "fig5", "-o", "a.pdf", "--panels", ""], "panels = ''"),
    (["figure", "fig5", "-o", "a.pdf", "--columns", "3"], "--columns"),
    (["figure", "fig5", "-o", "a.pdf", "--columns", ""], "--columns"),
    (["figure", "fig9", "-o", "a.pdf", "--t-end", "1e7"], "give an earlier end"),
    (["figure", "fig5", "-o", ""], "name of a file"),
    (["simulate", "fig5", "--csv", ""], "name of a file"),
    (["simulate", "fig5", "--csv", "-", "--json"], "standard output"),
    (["simulate", "fig5", "--set", "Omega=2*pi"], "is an expression"),
    (["simulate", "fig5", "--set", "k=1_000"], "k = '1_000'"),
    (["simulate", "fig5", "--set", "k=１"], "k = '１'"),
    (["simulate", "empty.toml"], "is empty"),
    (["simulate", ""], "scene '': unknown"),
    (["scenes", ""], "scene '': unknown"),
    (["scenes", "fig55"], "scene fig55: unknown"),
    (["codegen", "now"], "is no mapping"),
    (["bench", "--slow"], "No such option"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD, ids=[" ".join(each[0]) or "nothing" for each in BAD])
def test_bad_input_is_one_line_and_exit_2(
    arguments: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in BROKEN.items():
        Path(name).write_text(text)
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("symosc: error: ")
    assert result.stderr.count("\n") == 1
    assert message in result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(BROKEN)


#: For every option that takes a value; what the quick commands make of it must be an answer or one line.
NONSENSE = ["", " ", "abc", "nan", "-inf", "1e400", "1_000", "１", "None", "1j", "[]", "a\0b", "none/x", "folder"]
NONSENSE += ["k=", "=1", "k=1=2", "P99", "P33", "x" * 3000, "/proc/self/x", "a.pdf/b.pdf", "\n", "-1e50", "1e51"]
QUICK = {"simulate": ["fig6"], "figure": ["fig6", "-o", "a.svg", "--panels", "a"], "scenes": [], "codegen": ["P32"]}
QUICK |= {"grazing": ["fig9"], "derive": ["none"], "reproduce": ["--only", "none"], "bench": ["--none"]}


@pytest.mark.slow
@pytest.mark.parametrize("command", QUICK)
def test_nonsense_is_answered_in_one_line(command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    found = main.get_command(click.Context(main), command)
    assert found is not None
    takes_value = [each for each in found.params if not getattr(each, "is_flag", False)]
    for parameter in takes_value:
        for text in NONSENSE:
            if isinstance(parameter, click.Option):
                arguments = [*QUICK[command], f"{max(parameter.opts, key=len)}={text}"]
            else:
                arguments = [text, *QUICK[command][1:]]
            result = run(command, *arguments)
            assert result.exception is None or isinstance(result.exception, SystemExit), (arguments, result.exception)
            assert result.exit_code in (0, 1, 2), arguments
            if result.exit_code == 2:
                assert re.fullmatch(r"symosc: error: [^\n]+\n", result.stderr), arguments


def test_an_existing_file_survives_a_failed_write(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    path.write_text("mine")
    assert run("simulate", "fig5", "--csv", str(path), "--t-end", "-1").exit_code == 2
    assert path.read_text() == "mine"


# --- the real program ---


def test_exit_codes_of_the_program(tmp_path: Path) -> None:
    assert shell("simulate", "fig7").returncode == 0
    failed = shell("simulate", str(tmp_path))
    assert failed.returncode == 2
    assert failed.stdout == ""
    assert re.fullmatch(r"symosc: error: [^\n]+\n", failed.stderr)


def test_a_closed_pipe_is_quiet() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as out:
        result = subprocess.run([*PROGRAM, "simulate", "fig5"], stdout=out, stderr=subprocess.PIPE, text=True)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk_is_one_line() -> None:
    with open("/dev/full", "w") as out:
        result = subprocess.run([*PROGRAM, "simulate", "fig5"], stdout=out, stderr=subprocess.PIPE, text=True)
    assert result.returncode == 2
    assert result.stderr == "symosc: error: cannot write standard output: No space left on device\n"


#: The program, which prints a line when it begins to simulate.
TELLS_WHEN_IT_BEGINS = """
import runpy, symosc
simulate = symosc.simulate
def told(*arguments, **rest):
    print("begins", flush=True)
    return simulate(*arguments, **rest)
symosc.simulate = told
runpy.run_module("symosc", run_name="__main__", alter_sys=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
def test_an_interrupt_is_quiet(tmp_path: Path) -> None:
    arguments = ["simulate", "fig8", "--digits", "4000", "--t-end", "150", "--csv", "events.csv"]
    command = [sys.executable, "-c", TELLS_WHEN_IT_BEGINS, *arguments]
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # a shell's background job is told to ignore it
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True, preexec_fn=heed)
    assert process.stdout is not None
    assert process.stdout.readline() == "begins\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", "")
    assert list(tmp_path.iterdir()) == []


def test_simulate_loads_nothing_heavy() -> None:
    result = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "symosc", "simulate", "fig5"],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = {line.rpartition("|")[2].strip().partition(".")[0] for line in result.stderr.splitlines()}
    assert "numpy" in loaded
    assert not loaded & {"sympy", "matplotlib", "numba", "scipy"}


@pytest.mark.slow
def test_a_cold_start_costs_little_more_than_numpy(tmp_path: Path) -> None:
    """In processor time, with everything compiled to bytecode before: the ratio does not depend on the machine."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = str(tmp_path)

    def seconds(*command: str) -> float:
        start = sum(os.times()[2:4])
        subprocess.run(command, check=True, capture_output=True, env=environment)
        return sum(os.times()[2:4]) - start

    commands = (*PROGRAM, "simulate", "fig5"), (sys.executable, "-c", "import numpy")
    ours, numpy = (min(times) for times in zip(*([seconds(*each) for each in commands] for _ in range(6)), strict=True))
    assert ours <= 3 * numpy, (ours, numpy)
