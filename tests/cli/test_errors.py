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

from symosc.base.display import progress
from symosc.cli.app import main

# --- help and errors ---


@pytest.mark.parametrize("command", COMMANDS)
def test_help_has_an_example(command: str) -> None:
    assert re.search(rf"Examples?:\n +symosc {command}", good(command, "--help"))


@pytest.mark.slow
@pytest.mark.parametrize("command", ["simulate fig5", "figure fig5 -o -"])
def test_results_that_nobody_can_get_are_no_success(command: str) -> None:
    def in_shell(redirection: str) -> tuple[int, str]:
        program = shlex.join([*PROGRAM, *command.split()])
        result = subprocess.run(
            f"{program} {redirection}", shell=True, capture_output=True, text=True, check=False
        )
        return result.returncode, result.stderr

    assert in_shell(">&-") == (2, "symosc: error: standard output is closed\n")
    if Path("/dev/full").exists():
        code, said = in_shell("> /dev/full")
        assert (code, said.count("\n")) == (2, 1)
        assert "No space left on device" in said
    assert in_shell("| head -c 1") == (0, "")


SAMPLES = "t,x,v\n0,1,2\n1,1,2\n"
BROKEN = {
    "broken.toml": "t_end = ",
    "keys.toml": "t_end = 3",
    "run.csv": SAMPLES,
    "plain.md": "nothing",
}

#: Commands that need an optional package.
NEEDS = {
    "sweep": "xarray",
    "certify": "flint",
    "verify": "flint",
    "cases": "flint",
    "score": "flint",
    "explore": "bokeh",
    "bench": "numba",
    "check run.csv --case": "flint",
}
#: Command lines, and what their one line of error says. Values of all kinds are tried by
#: test_public_arguments.
BAD = {
    "": "Missing command",
    "bogus": "No such command 'bogus'; choose from atlas, attractors, ",
    "fig": "did you mean figure?",
    "c": "did you mean cases or certify or check or codegen?",
    "simulate": "Missing argument 'SCENE'",
    "simulate fig5 --bogus": "No such option",
    "simulate fig55": "scene fig55: unknown",
    "simulate none.toml": "No such file",
    "simulate broken.toml": "is not valid TOML",
    "simulate keys.toml": "is missing",
    "simulate fig5 --set k": "'k' is not NAME=VALUE",
    "simulate fig5 --set kk=1": "kk = '1': unknown parameter",
    "simulate fig5 --set mu=1": "did you mean mu1 or mu2?",
    "simulate fig5 --mu1 1": "--set mu1=VALUE",
    "simulate fig5 --set k=1 --set k=2": "k is given twice",
    "simulate fig5 --set t_end=1": "use --t-end",
    "simulate fig5 --t-end -1": "must be later than t0",
    "simulate fig5 --start-error 1,2": "or three",
    "simulate fig5 --max-events 1_000": "not a valid integer",
    "simulate fig5 --csv none/events.csv": "cannot write none/events.csv: No such file",
    "simulate fig5 --csv ''": "name of a file",
    "simulate fig5 --csv - --json": "standard output",
    "figure fig5": "Missing option '-o'",
    "figure fig5 -o a.pdf --panels z": "panels = 'z'",
    "figure fig5 -o a.pdf --columns 3": "--columns",
    "figure fig9 -o a.pdf --t-end 1e7": "give an earlier end",
    "grazing": "missing: m, c,",
    "grazing fig9 --map P1": "sticks on belt 1; grazing is defined for P2, P3, P5, P6",
    "grazing --set w=1": "unknown parameter",
    "grazing fig9 --check 1 --set k=0 --plot w.png": "k = 0: ",
    "grazing fig9 --latex --json": "not both",
    "grazing fig9 --plot - --latex": "standard output",
    "grazing fig9 --against Omega --plot w.png": "--against needs --plot FIGURE and one --map",
    "grazing fig9 --map P2 --against Omega=3 --plot w.png": "NAME=LOW:HIGH",
    "grazing fig9 --phase pi": "--phase needs --solve",
    "grazing fig9 --solve Omega,k,B0": "is not NAME or NAME,NAME",
    "grazing fig9 --solve Omega --phase pi:": "is not PHASE or LOW:HIGH",
    "grazing fig9 --solve Omega --plot a.png": "draws one region",
    "grazing fig9 --solve Omega --check 5": "goes without --check and --against",
    "grazing --solve Omega,k --phase 1": "needs numbers: give a SCENE",
    "orbit fig9 --continue Omega=3": "is not NAME=LOW:HIGH",
    "orbit fig9 -o - --json": "standard output",
    "codegen": "give --check or --regenerate, or a WORD",
    "codegen --check --regenerate": "not both",
    "codegen --regenerate --name a --json": "--name, --json needs a WORD",
    "codegen P32 --check": "leave WORD out",
    "codegen P32 -o - --force": "leave it out",
    "check fig9": "give SCENE FILE",
    "check --scene fig9": "give a file of samples",
    "check run.csv": "--scene",
    "check fig9 run.csv --solver a:b": "not both",
    "check fig9 --solver nothing": "must be MODULE:FUNCTION",
    "check fig9 none.parquet": "cannot be read",
    "check fig9 .": "folder",
    "check fig9 run.csv --columns z=1": "is not t=NAME",
    "check fig9 run.csv -o errors.doc": ".svg",
    "check run.csv --case free-decay-2 --scene fig9": "give --scene or --case, not both",
    "check run.csv --case none-such": "no reference case; `symosc cases` lists all",
    "cases --group none": "group",
    "cases -o -": "is not a folder",
    "score": "Missing argument",
    "score nothing run.csv": "nothing",
    "certify": "Missing argument 'SCENE'",
    "certify fig5 -o - --json": "standard output",
    "certify fig5 --orbit P32 --t-end 3": "are for motions, not for an orbit",
    "verify": "Missing argument 'FILE'",
    "sweep fig9": "give --over NAME=LO:HI:N, such as",
    "fit fig9 run.csv --free k --sigma small": "must be the standard deviation of the data",
    "check run.csv fig9": "give the scene first: symosc check fig9 run.csv",
    "simulate fig5 --t-end ten": "periods of the drive such as '10T', a quantity such as '3 s'",
    "sweep fig9 --over Omega": "'Omega' is not NAME=LO:HI:N",
    "sweep fig9 --over Omega=1:2:3 --over Omega=1:2:3": "Omega is given twice",
    "sweep fig9 --over k=1:2:3 --executor tcp://host": "is not dask:ADDRESS",
    "sweep fig9 --over k=1:2:3 --status": "name it",
    "atlas fig9 --over Omega=3:5 --over FN=5:12 -o none/map.json": "cannot write none/map.json: No such file",
    "explore --port 99999": "--port",
    "bench -o work.eps": ".pdf, .svg or .png",
    "bench --gradients plain.md": "No such option '--gradients'",
    "bench --scores plain.md --hard": "--scores is a run of its own",
    "bench --scores plain.txt": "must end in .md",
    "bench --results none.md": "cannot write none.md: No such file",
    "bench --results plain.md": "cannot write plain.md: needs the lines '<!-- results: begin -->'",
    "bench --results plain.md --hard": "leave out --hard and -o",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_one_line_and_exit_2(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for command, extra in NEEDS.items():
        if line.startswith(command):
            pytest.importorskip(extra)
    monkeypatch.chdir(tmp_path)
    for name, text in BROKEN.items():
        Path(name).write_text(text)
    result = run(*shlex.split(line))
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("symosc: error: ")
    assert result.stderr.count("\n") == 1
    assert BAD[line] in result.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(BROKEN)


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


#: The program, which prints a line when it begins to simulate.
ANNOUNCED = """
import runpy, symosc
simulate = symosc.simulate
def announced(*arguments, **rest):
    print("begins", flush=True)
    return simulate(*arguments, **rest)
symosc.simulate = announced
runpy.run_module("symosc", run_name="__main__", alter_sys=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
def test_an_interrupt_is_quiet(tmp_path: Path) -> None:
    arguments = ["simulate", "fig8", "--digits", "4000", "--t-end", "4000", "--csv", "events.csv"]
    command = [sys.executable, "-c", ANNOUNCED, *arguments]
    heed = partial(
        signal.signal, signal.SIGINT, signal.SIG_DFL
    )  # a shell's background job is told to ignore it
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True, preexec_fn=heed
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begins\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE)
    assert (process.returncode, out, err) == (130, "", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "cause", [KeyboardInterrupt(), ZeroDivisionError("a fault"), None], ids=repr
)
def test_an_interrupt_while_a_class_is_made(
    cause: BaseException | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python wraps it into a RuntimeError there; an error of another cause is not hidden."""

    @click.command()
    def loading() -> None:
        raise RuntimeError("Error calling __set_name__") from cause

    monkeypatch.setattr(type(main), "get_command", lambda *_: loading)
    interrupted = isinstance(cause, KeyboardInterrupt)
    with pytest.raises(SystemExit if interrupted else RuntimeError) as caught:
        main(["loading"])
    assert not interrupted or caught.value.args == (130,)


def test_the_level_of_output_ends_with_its_command() -> None:
    """A program may run commands itself."""
    for option in ("--quiet", "--verbose"):
        run("simulate", "fig7", option)
        assert progress.level == progress.NORMAL


def test_simulate_loads_nothing_heavy() -> None:
    result = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "symosc", "simulate", "fig5"],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = {
        line.rpartition("|")[2].strip().partition(".")[0] for line in result.stderr.splitlines()
    }
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
        int(
            subprocess.run(
                [sys.executable, "-c", COUNTED + code], capture_output=True, check=True
            ).stderr
        )
        for code in (main, "import numpy")
    )
    assert ours <= 2.5 * numpy, (ours, numpy)
