"""symosc simulate: its table, JSON, CSV, and starts from the command line."""

from __future__ import annotations

import csv
import json
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from cli_runs import good, run

import symosc


def test_the_table_shows_every_event_of_fig5() -> None:
    lines = good("simulate", "fig5").splitlines()
    assert re.split(r"\s{2,}", lines[0].strip()) == [
        *("t", "x", "v", "theta", "kind", "belt", "from -> to", "t error", "x error")
    ]
    trajectory = symosc.simulate("fig5")
    rows = [re.split(r"\s{2,}", line.strip()) for line in lines[2 : 2 + len(trajectory.events)]]
    for row, event in zip(rows, trajectory.events, strict=True):
        assert [float(value) for value in row[:4]] == pytest.approx([event.t, event.x, event.v, event.theta], rel=1e-13)
        assert row[4:7] == [event.kind, str(event.boundary), f"{event.source} -> {event.target}"]
        assert float(row[7]) == pytest.approx(event.t_error, rel=0.5)
    assert lines[-2] == f"word, in order of time: {' '.join(trajectory.word)}"
    assert lines[-1] == "t_end: reached t_end = 40; 16 events"


def test_no_events_and_one_event() -> None:
    assert good("simulate", "fig7").splitlines() == [
        "word, in order of time: none",
        "t_end: reached t_end = 15.1; 0 events",
    ]
    assert good("simulate", "fig7-exact").endswith("; 1 event\n")
    assert "stopped after max_events = 3" in good("simulate", "fig5", "--max-events", "3")


def test_json_is_the_trajectory() -> None:
    data = json.loads(good("simulate", "fig10", "--json", "--t-end", "5"))
    trajectory = symosc.simulate("fig10", t_end=5)
    assert data == {"scene": "fig10", **trajectory.as_dict()}
    assert [event["t"] for event in data["events"]] == [event.t for event in trajectory.events]


def test_digits_are_all_there() -> None:
    text = good("simulate", "fig8", "--digits", "40", "--t-end", "8")
    assert "3.139006225737682851938965627055696709296" in text
    data = json.loads(good("simulate", "fig8", "--digits", "40", "--t-end", "8", "--json"))
    assert data["events"][0]["t"] == "3.139006225737682851938965627055696709296"


def test_csv_round_trips(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    good("simulate", "fig9", "--csv", str(path))
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for row, event in zip(rows, symosc.simulate("fig9").events, strict=True):
        assert (float(row["t"]), float(row["x"]), float(row["theta"])) == (event.t, event.x, event.theta)
        assert (row["kind"], row["source"], row["target"]) == (event.kind, event.source, event.target)


def test_starts_and_parameters_from_the_command_line() -> None:
    arguments = ["--t0", "1/3", "--x0", "-0.5", "--v0", "-2", "--t-end", "12", "--set", "k=3/2", "--set", "mu2=0"]
    data = json.loads(good("simulate", "fig5", "--json", *arguments))
    p = symosc.load_scene("fig5").parameters.replace(k="3/2", mu2=0)
    assert data["parameters"] == p.as_dict()
    trajectory = symosc.simulate(p, t0="1/3", x0="-0.5", v0=-2, t_end=12)
    assert data["events"] == trajectory.table()


def test_a_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(good("scenes", "fig9"))
    assert good("simulate", str(path)) == good("simulate", "fig9")


@pytest.mark.slow
def test_what_double_precision_cannot_decide_is_said_and_exits_1() -> None:
    result = run("simulate", "fig8", "--t-end", "160")
    assert result.exit_code == 1
    assert result.stderr.startswith("symosc: undecidable: ")
    assert result.stderr.count("\n") == 1
    assert "word, in order of time: P1 P3" in result.stdout
    as_json = run("simulate", "fig8", "--t-end", "160", "--json")
    assert as_json.exit_code == 1
    assert json.loads(as_json.stdout)["status"] == "undecidable"


def test_a_start_from_the_command_line_is_exact(monkeypatch: pytest.MonkeyPatch) -> None:
    simulated = symosc.simulate
    seen: list[symosc.Scene] = []
    monkeypatch.setattr(symosc, "simulate", lambda scene, **rest: seen.append(scene) or simulated("fig6"))
    half = Fraction("5e-45")
    for arguments, errors in (([], (0, half, half)), (["--x0", "6"], (0, 0, half)), (["--v0", "2"], (0, half, 0))):
        good("simulate", "fig8-exact", *arguments)
        assert seen[-1].start_error == errors
    good("simulate", "fig8", "--x0", "6")
    assert seen[-1].start_error is None


def test_the_error_of_a_start_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    simulated = symosc.simulate
    seen: list[dict[str, Any]] = []
    monkeypatch.setattr(symosc, "simulate", lambda scene, **rest: seen.append(rest) or simulated("fig6"))
    for text, errors in (("1e-9", ("1e-9",) * 3), ("0,1/3,2e-8", ("0", "1/3", "2e-8")), (" 0, 0 ,0", ("0",) * 3)):
        good("simulate", "fig5", "--start-error", text)
        assert seen[-1]["start_error"] == tuple(map(Fraction, errors))
    good("simulate", "fig5")
    assert "start_error" not in seen[-1]


def test_csv_to_standard_output_is_the_file(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    good("simulate", "fig6", "--csv", str(path))
    assert good("simulate", "fig6", "--csv", "-") == path.read_text()
