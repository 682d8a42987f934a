"""What CONTRIBUTING says of each extension point, done to the letter in a copy of the project."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from scratch import Scratch

from symosc import simulate

pytestmark = pytest.mark.slow


@pytest.fixture
def scratch(tmp_path: Path) -> Scratch:
    return Scratch(tmp_path)


COMMAND = '''"""`symosc energy`: the energy of the mass at the events."""

from __future__ import annotations

import click

import symosc
from symosc.cli import options, output


@click.command()
@options.scene_argument
@options.set_option
@options.json_option
def energy(scene: str, settings: options.Settings) -> None:
    """Print the energy at each event.

    \\b
    Example:
      symosc energy fig5
    """
    problem = options.scene_with(scene, settings)
    m, k = float(problem.parameters.m), float(problem.parameters.k)
    events = symosc.simulate(problem).events
    rows = [[f"{each.t:.6g}", f"{(m * each.v**2 + k * each.x**2) / 2:.6g}"] for each in events]
    output.report(lambda: rows, lambda: output.write_table(rows, ["t", "energy"]))
'''


def test_a_command(scratch: Scratch) -> None:
    scratch.write("symosc/cli/energy.py", COMMAND)
    scratch.replace(
        "symosc/cli/app.py",
        '    "orbit": "orbit",\n',
        '    "energy": "energy",\n    "orbit": "orbit",\n',
    )
    scratch.replace("README.md", "# symosc\n", "# symosc (`symosc energy` for energies)\n")
    lines = scratch.run("symosc", "energy", "fig5", "--set", "k=3", "--quiet").splitlines()
    assert lines[0].split() == ["t", "energy"]
    scratch.pytest("tests/test_readme.py", "tests/test_layers.py", "tests/test_project.py")
    scratch.pytest("tests/cli/test_errors.py", only="help or command")


SHARE = '''"""The share of the normal force that presses a belt."""

from symosc import Belt, Oscillator, simulate, simulate_many


def test_share() -> None:
    numbers = {"m": 1, "c": "1/10", "k": 1, "B0": 3, "Omega": 2}
    pressed = Oscillator(**numbers, belts=[Belt(1, "1/2", mu_s="3/4", share=2)])
    usual = Oscillator(**numbers, belts=[Belt(1, 1, mu_s="3/2")])
    start = {"x0": 2, "t_end": 30}
    assert simulate(pressed, **start).events == simulate(usual, **start).events
    assert eval(repr(pressed)) == pressed
    assert repr(pressed.replace(share1=3).belts[0]) == "Belt(1, mu=0.5, mu_s=0.75, share=3)"
    columns = {name: number for name, number in pressed.numbers().items() if name != "share1"}
    table = simulate_many(columns | {"share1": [1, 2]}, [(0, 2, 0)] * 2, 30, use_numba=False)
    assert table[1].t.tolist() == [event.t for event in simulate(usual, **start).events]
'''


def test_a_property_of_a_belt(scratch: Scratch) -> None:
    scratch.replace(
        "symosc/base/quantities.py",
        '    "t0": Quantity("start time"',
        '    "share": Quantity("share of the normal force", "1", "s", ">= 0"),\n'
        '    "t0": Quantity("start time"',
    )
    law = "symosc/friction.py"
    scratch.replace(law, "    mu_s: Any = None\n", "    mu_s: Any = None\n    share: Any = 1\n")
    scratch.replace(law, "    return belt.mu\n", "    return belt.mu * belt.share\n")
    scratch.replace(law, "    return belt.mu_s\n", "    return belt.mu_s * belt.share\n")
    model = "symosc/belts.py"
    scratch.replace(model, "    mu_s: Fraction\n\n", "    mu_s: Fraction\n    share: Fraction\n\n")
    scratch.replace(
        model,
        "        mu_s: NumberLike | None = None,\n    ) -> None",
        "        mu_s: NumberLike | None = None,\n        share: NumberLike = 1,\n    ) -> None",
    )
    scratch.replace(
        model,
        '"mu_s": mu if mu_s is None else mu_s}',
        '"mu_s": mu if mu_s is None else mu_s, "share": share}',
    )
    scratch.write("tests/test_share.py", SHARE)
    scratch.pytest("tests/test_share.py", "tests/test_friction.py", "tests/test_model.py")


REST = """    yield ReferenceCase(
        "my-rest", RESTS, Scene("my-rest", CREEPER, 0, 0, 0, 30), "nothing happens", "my own work"
    )
"""


@pytest.mark.campaign  # it runs the tests of all cases in a copy, which takes 12 s
def test_a_reference_case(scratch: Scratch) -> None:
    pytest.importorskip("flint")
    cases = "symosc/reference/cases.py"
    tests = "tests/reference/test_cases.py"
    page = "docs/cases.md"
    scratch.replace(cases, "\n\n\n# -- the Coulomb", f"\n{REST}\n\n# -- the Coulomb")
    scratch.replace(cases, "SET_VERSION = 2\n", "SET_VERSION = 3\n")
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        tests,
        "-k",
        "new_version",
        "-p",
        "no:cacheprovider",
    ]
    said = subprocess.run(
        command, cwd=scratch.folder, capture_output=True, text=True, check=False
    ).stdout
    (found,) = set(re.findall(r"the sum of version 3 is (\w{64})", said))
    scratch.replace(tests, "SUMS = {\n", f'SUMS = {{\n    3: "{found}",\n')
    scratch.replace(
        page, "167, in version 2 of the set. For 155 of", "168, in version 3 of the set. For 156 of"
    )
    scratch.replace(page, "| creeping and rest | 19 |", "| creeping and rest | 20 |")
    listed = scratch.run("symosc", "cases", "--group", "creeping and rest", "--events", "--json")
    assert (
        json.loads(listed)["cases"][-1] | {"events": 0, "status": "proven"}
        == json.loads(listed)["cases"][-1]
    )
    scratch.pytest(
        tests, "tests/reference/test_folder.py", only="set or version or page or read_back"
    )


SOLVER = """
def solve(p, t0, x0, v0, t_end):
    t, x, v, h = [t0], [x0], [v0], (t_end - t0) / 400
    for i in range(400):
        force = p.A0 - p.c * v[-1] - p.k * x[-1]
        x, v, t = [*x, x[-1] + h * v[-1]], [*v, v[-1] + h * float(force / p.m)], [*t, t0 + (i + 1) * h]
    return {"t": t, "x": x, "v": v}
"""


def test_a_solver_to_check(scratch: Scratch) -> None:
    """Its prints and its errors are its own; the results of another one are scored from a file."""
    pytest.importorskip("flint")
    scratch.write("mysolver.py", SOLVER)
    command = [
        sys.executable,
        "-m",
        "symosc",
        "check",
        "fig9",
        "--solver",
        "mysolver:solve",
        "--t-end",
        "4",
    ]
    said = subprocess.run(command, cwd=scratch.folder, capture_output=True, text=True, check=False)
    assert (said.returncode, said.stderr) == (1, "")
    assert "wrong steps: 400 of 400" in said.stdout
    scratch.run("symosc", "cases", "-o", "cases", "--group", "easy", "--quiet")
    rows = [
        f"easy-fig9,{event.t!r},{event.x!r},{event.kind},{event.boundary}"
        for event in simulate("fig9", t_end=10).events
    ]
    scratch.write("mine.csv", "\n".join(["case,t,x,kind,boundary", *rows, "easy-fig9,10,,end,"]))
    assert "mine: right in 1 of 1 cases; 1 case without results" in scratch.run(
        "symosc", "score", "cases", "mine.csv"
    )
