"""Every public name has an example in its docstring.

It runs as it stands there, and prints what it says.
"""

from __future__ import annotations

import doctest
import inspect
import re
from functools import cache
from pathlib import Path

import pytest
from samples import few

import symosc
from symosc import plot

PUBLIC = {name: getattr(symosc, name) for name in symosc.__all__}
PUBLIC |= {
    f"plot.{name}": getattr(plot, name) for name in plot.__all__ if callable(getattr(plot, name))
}
#: Examples that need an optional package, and which.
NEEDED = {
    "compiled_residual": "numba",
    "SweepStatus": "h5netcdf",
    "sweep": "xarray",
    "sweep_status": "h5netcdf",
}
NEEDED |= dict.fromkeys(
    ("Certificate", "ReferenceCase", "certify", "plot.certificate_figure"), "flint"
)
NEEDED |= {
    f"plot.{form}_figure": "xarray" for form in ("basin", "bifurcation", "curve", "map", "swept")
}
#: Examples that take half a second and more.
LONG = (
    "Branch",
    "BranchEnd",
    "Case",
    "CompiledResidual",
    "ConvergenceError",
    "GrazingReport",
    "continue_orbit",
)
LONG += ("Border", "BorderError", "compiled_residual", "continue_border")
LONG += ("plot.border_figure", "plot.branch_figure")
#: What several examples follow: the same branch, and the same border.
SHARED = (cache(symosc.continue_orbit), cache(symosc.continue_border))
SECTION = re.compile(r"^ *Examples\n *--------\n *>>> ", re.MULTILINE)


@pytest.mark.quick(9)
@pytest.mark.parametrize("name", few(PUBLIC, *LONG))
def test_public_name_has_an_example_that_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    subject = PUBLIC[name]
    assert SECTION.search(subject.__doc__ or ""), (
        f"the docstring of {name} has no section Examples with >>>"
    )
    if name in NEEDED:
        pytest.importorskip(NEEDED[name])
    monkeypatch.chdir(tmp_path)
    for function in SHARED:
        monkeypatch.setattr(symosc, function.__name__, function)
    # Without the names of its module: what a user can paste. A class is searched with its methods.
    finder = doctest.DocTestFinder(recurse=inspect.isclass(subject))
    runner = doctest.DocTestRunner(verbose=False)
    printed: list[str] = []
    for example in finder.find(subject, name, module=False, globs={}):
        runner.run(example, out=printed.append)
    assert runner.tries > 0
    assert runner.failures == 0, "".join(printed)
    assert not list(tmp_path.iterdir()), "an example left a file behind"
