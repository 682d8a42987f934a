"""What surrounds the program fails: full disks, few descriptors, little memory, closed streams, killed workers."""

from __future__ import annotations

import os
import resource
import shlex
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from cli_runs import PROGRAM, good, run
from effort import PATIENCE

import symosc
from symosc.base.errors import OutputError
from symosc.base.files import write_folder, write_text
from symosc.base.workers import process_pool

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits and devices of Linux")
PROGRAM_TEXT = shlex.join(PROGRAM)


def in_shell(command: str, folder: Path, **environment: str) -> tuple[int, str]:
    """Run a command line of a shell; return its exit code and what it writes to standard error."""
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONWARNINGS": "ignore"} | environment,
    )
    return done.returncode, done.stderr


def limited(which: int, most: int, *words: str, folder: Path) -> tuple[int, str]:
    """Run a command line of symosc under a limit of `resource`; return exit code and standard error."""
    done = subprocess.run(
        [*PROGRAM, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        # Of a compiled module CPython would keep as much as it could write.
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
        preexec_fn=partial(resource.setrlimit, which, (most, most)),
    )
    return done.returncode, done.stderr


# --- disks and descriptors ---


@pytest.mark.slow
@pytest.mark.full(2)  # an SVG is text, as a PDF is
@pytest.mark.parametrize("suffix", ["pdf", "svg", "png"])
def test_a_figure_on_a_full_disk(suffix: str, tmp_path: Path) -> None:
    (tmp_path / f"full.{suffix}").symlink_to("/dev/full")
    code, said = in_shell(f"{PROGRAM_TEXT} figure fig6 -o full.{suffix} --panels a", tmp_path)
    assert (code, said) == (
        2,
        f"symosc: error: cannot write full.{suffix}: No space left on device\n",
    )
    code, said = limited(
        resource.RLIMIT_FSIZE, 4096, "figure", "fig6", "-o", f"z.{suffix}", folder=tmp_path
    )
    assert (code, said) == (2, f"symosc: error: cannot write z.{suffix}: File too large\n")
    assert [path.name for path in tmp_path.iterdir()] == [f"full.{suffix}"]


@pytest.mark.slow
@pytest.mark.full(2)
@pytest.mark.parametrize(("suffix", "most"), [("pdf", 8), ("pdf", 9), ("svg", 8)])
def test_a_figure_with_few_descriptors(suffix: str, most: int, tmp_path: Path) -> None:
    code, said = limited(
        resource.RLIMIT_NOFILE, most, "figure", "fig6", "-o", f"z.{suffix}", folder=tmp_path
    )
    left = [path.name for path in tmp_path.iterdir()]
    if code == 0:
        assert left == [f"z.{suffix}"]
    else:
        assert (code, left) == (2, [])
        assert said.count("\n") == 1
        assert "Too many open files" in said


WITH_FEW = """
import os, resource
from symosc.base.files import write_folder, write_text
os.mkdir("old")
write = {
    "text": lambda: write_text("a.txt", "text"),
    "folder": lambda: write_folder("old", {"b/c.txt": "c"}, lambda _: ()),
}
held = []
try:
    while True:
        held.append(os.open(os.devnull, os.O_RDONLY))
except OSError:
    os.close(held.pop())
write[os.environ["WHAT"]]()
"""


@pytest.mark.parametrize("what", ["text", "folder"])
def test_one_descriptor_is_enough_to_write_and_to_clean_up(what: str, tmp_path: Path) -> None:
    limit = partial(resource.setrlimit, resource.RLIMIT_NOFILE, (64, 64))
    environment = os.environ | {"WHAT": what}
    command = [sys.executable, "-c", WITH_FEW]
    subprocess.run(command, cwd=tmp_path, preexec_fn=limit, env=environment, check=True)
    left = sorted(path.name for path in tmp_path.rglob("*"))
    assert left == {"text": ["a.txt", "old"], "folder": ["b", "c.txt", "old"]}[what]


def test_a_file_that_is_replaced_by_a_folder_of_texts_is_said(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="it is not a folder"):
        write_folder(write_text(tmp_path / "a", "text"), {"b": "c"}, lambda _: ())


# --- streams ---

#: Command lines of a shell, with {} for the program, their exit codes, and what they say.
STREAMS = {
    "{} check - --scene fig5 <&-": (2, "standard input is closed"),
    "{} fit fig5 - --free mu1 <&-": (2, "standard input is closed"),
    "{} simulate fig5 --set k=x 2>/dev/full": (2, ""),
    "{} simulate --bogus 2>/dev/full": (2, ""),
    "{} simulate fig5 --verbose 2>/dev/full": (0, ""),
    "{} certify fig8 --orbit P2 2>/dev/full": (2, ""),
    "{} simulate fig55 2>&-": (2, ""),
    "{} simulate fig55 <&- >&- 2>&-": (2, ""),
}


@pytest.mark.slow
@pytest.mark.parametrize("line", STREAMS)
def test_closed_and_full_streams(line: str, tmp_path: Path) -> None:
    wanted, said = STREAMS[line]
    code, errors = in_shell(line.format(PROGRAM_TEXT), tmp_path)
    assert code == wanted
    assert errors.count("\n") <= 1
    assert said in errors


@pytest.mark.slow
@pytest.mark.parametrize(
    "module", ["symosc verify", "symosc.certificates.verify", "symosc.certificates.verify_orbits"]
)
def test_a_checker_whose_output_nobody_reads(module: str, tmp_path: Path) -> None:
    pytest.importorskip("flint")
    good("certify", "fig8", "-o", str(tmp_path / "fig8.json"))
    checker = f"{shlex.quote(sys.executable)} -m {module}"
    for reader in ("head -1 >/dev/null", "true"):
        assert in_shell(f"set -o pipefail; {checker} fig8.json | {reader}", tmp_path) == (0, "")
    for redirection in (">/dev/full", ">&-"):
        code, said = in_shell(f"{checker} fig8.json {redirection}", tmp_path)
        assert (code, said.count("\n"), "Traceback" in said) == (2, 1, False)
    assert in_shell(f"{checker} nothing.json 2>/dev/full", tmp_path) == (2, "")
    assert in_shell(f"{checker} nothing.json 2>&-", tmp_path) == (2, "")


# --- backends, memory, workers ---


@pytest.mark.slow
def test_a_backend_that_matplotlib_does_not_know(tmp_path: Path) -> None:
    code, said = in_shell(f"{PROGRAM_TEXT} figure fig6 -o z.svg", tmp_path, MPLBACKEND="nonsense")
    assert (code, said.count("\n")) == (2, 1)
    assert "MPLBACKEND = 'nonsense': must be a backend of matplotlib" in said
    assert list(tmp_path.iterdir()) == []
    assert in_shell(
        f"{PROGRAM_TEXT} simulate fig6 > motion.txt", tmp_path, MPLBACKEND="nonsense"
    ) == (0, "")


#: The program with as many megabytes more than numpy takes: the library behind numpy's matrices ends
#: the process if it gets no memory for its buffers.
WITH_LITTLE = """
import os, re, resource, sys
import numpy
import symosc.cli.app
from symosc.__main__ import run
numpy.ones((300, 300)) @ numpy.ones((300, 300))
used = int(re.search(r"VmData:\\s+([0-9]+)", open("/proc/self/status").read())[1])
most = (used + 1024 * int(os.environ["MORE"])) * 1024
resource.setrlimit(resource.RLIMIT_DATA, (most, most))
run()
"""


@pytest.mark.slow
@pytest.mark.parametrize("megabytes", ["0", "10", "30"])
def test_little_memory(megabytes: str, tmp_path: Path) -> None:
    command = [sys.executable, "-c", WITH_LITTLE, "figure", "fig6", "-o", "z.pdf"]
    environment = os.environ | {"MORE": megabytes, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, check=False, env=environment
    )
    code, said = done.returncode, done.stderr
    assert code in (0, 2), said
    assert said.count("\n") == (code == 2), said
    assert [path.name for path in tmp_path.iterdir()] == ["z.pdf"] * (code == 0)


def test_no_memory_is_bad_luck_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(symosc, "simulate", fail)
    result = run("simulate", "fig5")
    assert (result.exit_code, result.stderr) == (
        2,
        "symosc: error: there is not enough memory for this\n",
    )


def killed(_: object) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_killed_worker_is_one_sentence() -> None:
    lost = r"^a worker process ended before its work was done"
    with pytest.raises(symosc.SymoscError, match=lost) as caught, process_pool(1, "spawn") as pool:
        list(pool.map(killed, [1]))
    assert caught.value.__cause__ is None


def kill_children(command: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command, kill the first worker process that it starts, and return how it ends."""
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as program:
        children = Path(f"/proc/{program.pid}/task/{program.pid}/children")
        while program.poll() is None:
            workers = [pid for pid in children.read_text().split() if is_worker(pid)]
            if workers:
                os.kill(int(workers[0]), signal.SIGKILL)
                break
            time.sleep(0.05)
        out, err = program.communicate(timeout=PATIENCE)
    return subprocess.CompletedProcess(command, program.returncode, out, err)


def is_worker(pid: str) -> bool:
    """Return whether a process does the work of a pool, and is not the tracker of its resources."""
    try:
        command = Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return False
    return "resource_tracker" not in command and ("spawn_main" in command or "atlas" in command)


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "atlas fig9 --over Omega=3.9:4.1 --over FN=9.5:10.5 --prove 1 --workers 2",
        "cases -o cases",
    ],
)
def test_a_killed_worker_of_a_command(words: str, tmp_path: Path) -> None:
    pytest.importorskip("flint")
    done = kill_children([*PROGRAM, *words.split(), "--quiet"], tmp_path)
    assert done.returncode == 2, done.stderr
    assert done.stderr.startswith("symosc: error: a worker process ended before its work was done")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
