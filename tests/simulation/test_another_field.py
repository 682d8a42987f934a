"""What CONTRIBUTING says of a new field of an event and of a new column of sweeps, done to the letter in a copy."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from project_files import ROOT

pytestmark = pytest.mark.slow


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "symosc", tmp_path / "symosc")  # with what is compiled of it
    return tmp_path


def change(path: Path, *changes: tuple[str, str]) -> None:
    text = path.read_text(encoding="utf-8")
    for before, after in changes:
        assert text.count(before) == 1, before
        text = text.replace(before, after)
    path.write_text(text, encoding="utf-8")


def run(folder: Path, *command: str) -> str:
    done = subprocess.run(
        [sys.executable, *command], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stdout


EVENTS = """
import csv, importlib.util
from symosc import load_scene, simulate, simulate_many

def right(motion):
    for event in motion.events:
        after = float(motion.force(int(event.target[-1]), float(event.t))) if event.kind == "cross" else None
        assert after is None or abs(float(event.a) - after) < 1e-9 * (1 + abs(after)), event
        assert event.period == int(float(event.t) * float(motion.parameters.Omega) / 6.283185307179586)

fig9, fig8 = load_scene("fig9"), load_scene("fig8")
motion = simulate(fig9)
right(motion)
right(simulate(fig9, digits=20, max_events=9))
assert len(str(simulate(fig9, digits=20, max_events=1).table()[0]["a"])) > 18
expected = [event.a for event in motion.events], [event.period for event in motion.events]
table = simulate_many(fig9.parameters, (fig9.t0, fig9.x0, fig9.v0), fig9.t_end, use_numba=False)
for name, values in zip(("a", "period"), expected):
    assert [abs(x - y) < 1e-9 for x, y in zip(getattr(table, name), values)] == [True] * len(values)
    for each in (motion, table):
        each.to_csv("events.csv")
        assert [float(row[name]) for row in csv.DictReader(open("events.csv"))] == list(map(float, each.columns()[name]
            if each is table else values))
        assert name in each.to_pandas().columns and name in each.to_xarray().variables
if importlib.util.find_spec("numba"):  # pairs of doubles
    many = simulate_many(fig8.parameters, [(fig8.t0, fig8.x0, fig8.v0)], 12, accuracy=3e-16, max_events=6)
    alone = simulate(fig8, t_end=12, accuracy=3e-16, max_events=6)
    assert [abs(x - event.a) < 1e-9 for x, event in zip(many.a, alone.events, strict=True)] == [True] * 6
"""


def test_a_field_of_an_event_is_added_as_contributing_says(copy: Path) -> None:
    change(
        copy / "symosc" / "engine" / "events.py",
        ("    theta: Number\n", "    theta: Number\n    a: Number\n"),
        ("    boundary: int\n", "    boundary: int\n    period: int\n"),
        ("state.theta, t_error", "state.theta, state.Fb, t_error"),
        ("event.boundary, before.mode", "event.boundary, event.state.n, before.mode"),
    )
    run(copy, "-c", EVENTS)
    events = json.loads(run(copy, "-m", "symosc", "simulate", "fig9", "--json"))["events"]
    assert all({"a", "period"} <= event.keys() for event in events)
    assert {"a", "period"} <= {
        *run(copy, "-m", "symosc", "simulate", "fig9").splitlines()[0].split()
    }


SWEPT = """
from symosc import load_scene, simulate_many, sweep
p = load_scene("fig9").parameters
found = simulate_many(p, [(0, 0, 0), (0, 1, 2)], 5, record=("speed", "v"), use_numba=False)
assert found.speed.tolist() == abs(found.v).tolist()
dataset = sweep("fig9", {"FN": [1, 2]}, record="speed", t_end=3, path="map.csv")
assert dataset.speed.attrs == {"long_name": "size of the last velocity", "dimension": "length/time"}
assert sweep("fig9", {"FN": [1, 2]}, record="speed", t_end=3, path="map.csv").identical(dataset)
"""


@pytest.mark.campaign  # the field above goes the same way
def test_a_column_of_sweeps_is_added_as_contributing_says(copy: Path) -> None:
    pytest.importorskip("xarray")
    simulation = copy / "symosc" / "simulation"
    change(
        simulation / "tables.py",
        (
            '    "mode": (',
            '    "speed": ("size of the last velocity", "length/time"),\n    "mode": (',
        ),
    )
    change(
        simulation / "ensemble.py",
        (
            "    counted_time = columns",
            '    columns["speed"] = abs(columns["v"])\n    counted_time = columns',
        ),
    )
    run(copy, "-c", SWEPT)
    printed = json.loads(
        run(
            copy,
            "-m",
            "symosc",
            "sweep",
            "fig9",
            "--over",
            "FN=1:2:2",
            "--record",
            "speed",
            "--json",
        )
    )
    assert {"least", "largest"} <= printed["columns"]["speed"].keys()
