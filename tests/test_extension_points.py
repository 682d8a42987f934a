"""What CONTRIBUTING says of each extension point, done to the letter in a copy of the project."""

from __future__ import annotations

from pathlib import Path

import pytest
from scratch import Scratch

pytestmark = pytest.mark.slow


@pytest.fixture
def scratch(tmp_path: Path) -> Scratch:
    return Scratch(tmp_path)


COMMAND = '''"""`symosc energy`: the energy of the mass at the events."""

from __future__ import annotations

import click

import symosc
from symosc.cli.common import json_option, scene_argument, scene_with, set_option, write_json, write_table


@click.command()
@scene_argument
@set_option
@json_option
def energy(scene: str, settings: tuple[str, ...], as_json: bool) -> int:
    """Print the energy at each event.

    \\b
    Example:
      symosc energy fig5
    """
    problem = scene_with(scene, settings, {})
    m, k = float(problem.parameters.m), float(problem.parameters.k)
    events = symosc.simulate(problem).events
    rows = [[f"{each.t:.6g}", f"{(m * each.v**2 + k * each.x**2) / 2:.6g}"] for each in events]
    write_json(rows) if as_json else write_table(rows, ["t", "energy"])
    return 0
'''


def test_a_command(scratch: Scratch) -> None:
    scratch.write("symosc/cli/energy.py", COMMAND)
    scratch.replace("symosc/cli/app.py", '    "orbit": "orbit",\n', '    "energy": "energy",\n    "orbit": "orbit",\n')
    scratch.replace("README.md", "for proofs.\n", "for proofs,\n`symosc energy` for energies.\n")
    lines = scratch.run("symosc", "energy", "fig5", "--set", "k=3", "--quiet").splitlines()
    assert lines[0].split() == ["t", "energy"]
    scratch.pytest("tests/cli/test_errors.py", "tests/test_readme.py", "tests/test_layers.py", "tests/test_project.py")
