"""What CONTRIBUTING says of a new figure, done to the letter in a copy."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from project_files import ROOT

pytestmark = pytest.mark.slow

ANSWER = """
from symosc.base.display.drawable import Drawable


class Drive(Drawable):
    _drawn_by = "drive_figure"

    def __init__(self, parameters):
        self.parameters = parameters
"""
FIGURE = """
import numpy as np

from symosc.base.arguments import public
from symosc.plot.drawing import axes_for


@public
def drive_figure(drive, *, ax=None):
    t = np.linspace(0, 10, 100)
    with axes_for(ax, (4.0, 3.0)) as (drawing, (axes,)):
        axes.plot(t, float(drive.parameters.B0) * np.cos(float(drive.parameters.Omega) * t))
        axes.set(xlabel="time $t$", ylabel="drive")
    return drawing
"""
PAGE = """

from symosc.simulation.drive import Drive


def drive_page(drive):
    return page("Drive", f"Omega = {drive.parameters.Omega}")


PAGES[Drive] = drive_page
"""
USE = """
import sys
from pathlib import Path
from symosc import load_scene, plot
from symosc.simulation.drive import Drive

drive = Drive(load_scene("fig9").parameters)
assert "matplotlib" not in sys.modules
print(drive.plot().axes[0].get_ylabel())
from matplotlib.figure import Figure
own = Figure().subplots()
assert plot.drive_figure(drive, ax=own) is own.figure and own.lines
assert plot.save(plot.drive_figure(drive), Path(sys.argv[1]) / "drive.svg").is_file()
assert "drive_figure" in plot.__all__
assert "Omega = 4" in drive._repr_html_()
"""


def test_a_figure_is_added_as_contributing_says(tmp_path: Path) -> None:
    package = tmp_path / "symosc"
    shutil.copytree(ROOT / "symosc", package)  # with what is compiled of it
    (package / "simulation" / "drive.py").write_text(ANSWER)
    (package / "plot" / "drive.py").write_text(FIGURE)
    with open(package / "plot" / "__init__.pyi", "a") as names:
        names.write("from .drive import drive_figure as drive_figure\n")
    with open(package / "plot" / "notebooks.py", "a") as pages:
        pages.write(PAGE)
    (tmp_path / "use.py").write_text(USE)
    command = [sys.executable, "use.py", str(tmp_path)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "drive\n"), done.stderr[-3000:]
