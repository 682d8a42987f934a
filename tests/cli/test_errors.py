"""The command line: exit codes; bad input costs one line and leaves nothing behind."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
from functools import partial
from pathlib import Path

import click
import pytest
from cli_runs import COMMANDS, PROGRAM, good, run, shell
from effort import PATIENCE

from symosc.cli.app import main

# --- help and errors ---


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command: str) -> None:
    assert re.search(rf"Examples?:\n +symosc {command}", good(command, "--help"))


@pytest.mark.slow
@pytest.mark.parametrize("command", [[], ["simulate"], ["sweep"]])
def test_help_is_the_same_without_docstrings(command: list[str]) -> None:
    """With -OO Python leaves them out."""
    usual, bare = ([sys.executable, *options, "-m", "symosc", *command, "--help"] for options in ((), ("-OO",)))
    assert subprocess.check_output(bare) == subprocess.check_output(usual)


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", ["simulate fig5", "--help", "--version", "simulate fig5 --json", "figure fig5 -o -"]
)
def test_results_that_nobody_can_get_are_no_success(command: str) -> None:
    def in_shell(redirection: str) -> tuple[int, str]:
        program = shlex.join([*PROGRAM, *command.split()])
        result = subprocess.run(f"{program} {redirection}", shell=True, capture_output=True, text=True, check=False)
        return result.returncode, result.stderr

    assert in_shell(">&-") == (2, "symosc: error: standard output is closed\n")
    assert in_shell(">&- 2>&-")[0] == 2
    if Path("/dev/full").exists():
        code, said = in_shell("> /dev/full")
        assert (code, said.count("\n")) == (2, 1)
        assert "No space left on device" in said
    assert in_shell("| head -c 1") == (0, "")


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
    (["simulate", "fig5", "--set", "kk=1"], "kk = '1': is not a parameter"),
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
    (["simulate", "fig5", "--set", "k=1_000"], "k = '1_000'"),
    (["simulate", "fig5", "--set", "k=１"], "k = '１'"),
    (["simulate", "empty.toml"], "is empty"),
    (["simulate", ""], "scene '': unknown"),
    (["scenes", ""], "scene '': unknown"),
    (["scenes", "fig55"], "scene fig55: unknown"),
    (["codegen", "now"], "is not a mapping"),
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


@pytest.mark.full(4)
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


@pytest.mark.slow
def test_exit_codes_of_the_program(tmp_path: Path) -> None:
    assert shell("simulate", "fig7").returncode == 0
    failed = shell("simulate", str(tmp_path))
    assert failed.returncode == 2
    assert failed.stdout == ""
    assert re.fullmatch(r"symosc: error: [^\n]+\n", failed.stderr)


@pytest.mark.slow
def test_a_closed_pipe_is_quiet() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as out:
        result = subprocess.run([*PROGRAM, "simulate", "fig5"], stdout=out, stderr=subprocess.PIPE, text=True)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.slow
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
    arguments = ["simulate", "fig8", "--digits", "4000", "--t-end", "4000", "--csv", "events.csv"]
    command = [sys.executable, "-c", TELLS_WHEN_IT_BEGINS, *arguments]
    heed = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # a shell's background job is told to ignore it
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True, preexec_fn=heed)
    assert process.stdout is not None
    assert process.stdout.readline() == "begins\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out, err) == (130, "", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("cause", [KeyboardInterrupt(), ZeroDivisionError("a fault"), None], ids=repr)
def test_an_interrupt_while_a_class_is_made(cause: BaseException | None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python wraps it into a RuntimeError there; an error of another cause is not hidden."""

    @click.command()
    def loading() -> None:
        raise RuntimeError("Error calling __set_name__") from cause

    monkeypatch.setattr(type(main), "get_command", lambda *_: loading)
    interrupted = isinstance(cause, KeyboardInterrupt)
    with pytest.raises(SystemExit if interrupted else RuntimeError) as caught:
        main(["loading"])
    assert not interrupted or caught.value.args == (130,)


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


#: Says, when the program ends, how many functions it has called.
COUNTED = """
import atexit, sys
calls = 0
def count(frame, event, argument):
    global calls
    calls += event in ("call", "c_call")
atexit.register(lambda: print(calls, file=sys.stderr))
sys.setprofile(count)
"""


def test_a_cold_start_costs_little_more_than_numpy() -> None:
    """In calls of functions, which do not depend on the machine."""
    main = "from symosc.cli.app import main\nmain(['simulate', 'fig5'])"
    ours, numpy = (
        int(subprocess.run([sys.executable, "-c", COUNTED + code], capture_output=True, check=True).stderr)
        for code in (main, "import numpy")
    )
    assert ours <= 2.5 * numpy, (ours, numpy)
