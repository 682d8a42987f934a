"""The event loops are compiled once.

By a process beside the tests that do not need them, for those that do.

Compiling takes twenty seconds for doubles and a minute for double-double numbers. Without this each
worker would do it for itself. Nobody holds a lock: whoever needs a loop looks whether it is on
disk. If the other process comes to its end without one, or takes too long, the loop is compiled
where it is needed.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from once import SHARED

#: Seconds after which nobody waits for the other process any longer.
LONGEST_WAIT = 600
#: Events that no session follows.
NEVER_SPENT = 10**12
#: The environment variable that says: this module was run as a program, which makes the files of
#: this name, with "-doubles" and "-pairs" behind it, when the loops are there.
BEGUN = "SYMOSC_COMPILED"
_wait_until: list[float] = []


#: What the marker `compiled` asks for -> a program that compiles it. Before pairs, which take
#: longest, come doubles and what fits and sensitivities need.
LOOPS = {
    "doubles": "from symosc import load_scene, simulate_many\n"
    "simulate_many(load_scene('fig5').parameters, [0, 0, 0], 1, use_numba=True)",
    "pairs": "from symosc import load_scene, simulate_many\n"
    "simulate_many(load_scene('fig5').parameters, [0, 0, 0], 1, use_numba=True)\n"
    "simulate_many(load_scene('fig5').parameters, [0, 0, 0], 1, wrt='mu1', use_numba=True)\n"
    "from symosc.simulation.batch import warm\nwarm()",
}


def is_there(loops: str) -> bool:
    """Return whether loops are on disk, or nothing can be compiled."""
    if find_spec("numba") is None:
        return True
    from symosc.engine.arithmetic import compiled, pairs_are_compiled
    from symosc.kernels.compiling import is_compiled

    doubles = is_compiled(compiled()["follow_all"])
    return doubles and (loops == "doubles" or pairs_are_compiled())


def ended() -> Path:
    """Return the path of a file that is there when the other process has come to its end, whatever it was."""
    if begun := os.environ.get(BEGUN):
        return Path(f"{begun}-pairs")
    return Path(os.environ[SHARED]) / "compiling-has-ended"


def begin(loops: str) -> subprocess.Popen[bytes] | None:
    """Compile what is not on disk, in a process of its own."""
    if is_there(loops) or os.environ.get(BEGUN):
        return None
    code = f"import pathlib, sys\ntry: exec({LOOPS[loops]!r})\nfinally: pathlib.Path(sys.argv[1]).touch()"
    nowhere = subprocess.DEVNULL
    return subprocess.Popen(
        [sys.executable, "-c", code, str(ended())], stdout=nowhere, stderr=nowhere
    )


def leave_to_the_other() -> None:
    """Let this process interpret what is not on disk yet, however much: the other one compiles it.

    Else it would compile the same loops, once it has interpreted as much as that takes.
    """
    from symosc.simulation.loops import CHOICE

    for budget in (CHOICE.doubles, CHOICE.pairs, CHOICE.searches, CHOICE.derivatives):
        budget.events = NEVER_SPENT


def end(process: subprocess.Popen[bytes], others_wait: bool) -> None:
    """End the other process, or let it come to its end if another worker may still wait for what it makes."""
    try:
        process.wait(LONGEST_WAIT if others_wait else 0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def wait(loops: str) -> None:
    """Wait until loops are there, all tests of this process together not longer than LONGEST_WAIT."""
    _wait_until[:] = _wait_until or [time.monotonic() + LONGEST_WAIT]
    while not is_there(loops) and not ended().exists() and time.monotonic() < _wait_until[0]:
        time.sleep(0.2)


@cache
def load() -> None:
    """Load the loop for doubles: single motions and checks of solutions use it from then on."""
    if find_spec("numba") is not None:
        exec(LOOPS["doubles"])


if __name__ == "__main__":
    try:
        exec(LOOPS["doubles"])
        Path(f"{os.environ[BEGUN]}-doubles").touch()
        exec(LOOPS["pairs"])
    finally:
        Path(f"{os.environ[BEGUN]}-pairs").touch()
