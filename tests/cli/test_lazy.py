"""What each command loads: only what its work needs, so that the shell answers fast."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

#: Packages that take long to load, and what no command needs but those that name it here.
HEAVY = {
    "sympy",
    "matplotlib",
    "numba",
    "scipy",
    "pandas",
    "xarray",
    "rich",
    "pint",
    "tabulate",
    "jinja2",
    "IPython",
}
HEAVY |= {"mpmath", "numpy", "flint", "gmpy2", "dask", "h5py", "fontTools"}
#: Commands with what of the above they may load.
ALLOWED = {
    "--version": set(),
    "scenes": set(),
    "new mine.toml": set(),
    "simulate fig5": {"numpy"},
    "grazing fig9": {"numpy"},
    "orbit fig9": {"numpy", "mpmath", "gmpy2"},
    "figure fig5 -o fig5.svg": {"numpy", "matplotlib", "fontTools"},
    "simulate fig5 --digits 20": {"numpy", "mpmath", "gmpy2"},
}


@pytest.mark.slow
@pytest.mark.parametrize("command", ALLOWED)
def test_a_command_loads_only_what_it_needs(command: str, tmp_path: Path) -> None:
    code = (
        "import sys; from symosc.cli.app import main\n"
        f"main({command.split()!r}, prog_name='symosc', standalone_mode=False)\n"
        f"print(sorted({HEAVY!r} & set(sys.modules)), file=sys.stderr)"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True, cwd=tmp_path
    )
    assert set(eval(run.stderr.splitlines()[-1])) <= ALLOWED[command], command


@pytest.mark.slow
def test_names_of_plot_load_only_their_figures() -> None:
    code = (
        "import sys; from symosc import plot; assert 'matplotlib' not in sys.modules; plot.figure;"
        "print({'scipy', 'symosc.plot.sweeps', 'symosc.orbits', 'symosc.crosschecks'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout == "set()\n"
