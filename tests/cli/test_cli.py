"""The command line: what it prints, and what goes to standard output."""

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

# --- simulate ---


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


# --- figure, scenes, codegen ---


@pytest.mark.slow
def test_figure_writes_the_file_and_says_what_it_shows(tmp_path: Path) -> None:
    path = tmp_path / "fig5.pdf"
    assert good("figure", "fig5", "-o", str(path)) == f"{path}: t = 0 to 9, 6 events\n"
    assert path.read_bytes().startswith(b"%PDF-")
    assert "t = 0 to 3," in good("figure", "fig5", "-o", str(path), "--t-end", "3", "--panels", "c", "--columns", "1")


def test_scenes_lists_all_with_their_source() -> None:
    text = good("scenes")
    for name in symosc.scene_names():
        assert re.search(rf"^{name} ", text, re.MULTILINE)
    assert "WSEAS" in text.splitlines()[-1]
    data = json.loads(good("scenes", "--json"))
    assert [entry["name"] for entry in data] == symosc.scene_names()


@pytest.mark.parametrize("name", symosc.scene_names())
def test_a_printed_scene_is_the_scene(name: str, tmp_path: Path) -> None:
    path = tmp_path / "copy.toml"
    path.write_text(good("scenes", name))
    assert symosc.load_scene(path) == symosc.load_scene(name)


def test_the_error_of_a_start_survives_the_scene_file(tmp_path: Path) -> None:
    text = good("scenes", "fig8-exact")
    assert "start_error = [0, 5e-45, 5e-45]" in text
    assert json.loads(good("scenes", "fig8-exact", "--json"))["start_error"] == ["0", "5e-45", "5e-45"]
    assert "start_error" not in good("scenes", "fig8")
    path = tmp_path / "one.toml"
    for given, read in (('"1/3"', Fraction(1, 3)), ("1e-9", Fraction(1, 10**9)), ("0", Fraction(0))):
        path.write_text(re.sub(r"start_error = .*", f"start_error = {given}", text))
        assert symosc.load_scene(path).start_error == (read,) * 3
        copy = tmp_path / "copy.toml"
        copy.write_text(good("scenes", str(path)))
        assert symosc.load_scene(copy).start_error == (read,) * 3


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


def test_a_fraction_survives_the_scene_file(tmp_path: Path) -> None:
    path = tmp_path / "third.toml"
    path.write_text(good("scenes", "fig5").replace("k = 1", 'k = "1/3"'))
    copy = tmp_path / "copy.toml"
    copy.write_text(good("scenes", str(path)))
    assert symosc.load_scene(copy).parameters == symosc.load_scene("fig5").parameters.replace(k="1/3")


def test_codegen_check_prints_the_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    import symosc.symbolic.codegen as codegen

    monkeypatch.setattr(codegen, "check", lambda: "")
    assert "is what the formulas print" in good("codegen", "--check")
    monkeypatch.setattr(codegen, "check", lambda: "-committed\n+generated\n")
    result = run("codegen", "--check")
    assert (result.exit_code, result.stdout) == (1, "-committed\n+generated\n\n")
    assert "accept: symosc codegen --regenerate" in result.stderr


def test_codegen_writes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import symosc.symbolic.codegen as codegen

    monkeypatch.setattr(codegen, "PATH", tmp_path / "_generated.py")
    monkeypatch.setattr(codegen, "generate", lambda: "pass\n")
    assert run("codegen").exit_code == 2
    assert not (tmp_path / "_generated.py").exists()
    assert good("codegen", "--regenerate") == f"wrote {tmp_path / '_generated.py'}\n"
    assert (tmp_path / "_generated.py").read_text() == "pass\n"


# --- standard output as a file ---


def test_csv_to_standard_output_is_the_file(tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    good("simulate", "fig6", "--csv", str(path))
    assert good("simulate", "fig6", "--csv", "-") == path.read_text()


def test_a_figure_to_standard_output_is_svg(tmp_path: Path) -> None:
    path = tmp_path / "fig6.svg"
    good("figure", "fig6", "-o", str(path), "--panels", "a")
    assert good("figure", "fig6", "-o", "-", "--panels", "a") == path.read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ["orbit", "fig9", "-o"],
        ["grazing", "fig9", "--map", "P2", "--plot"],
        ["check", "s.csv", "--scene", "fig6", "-o"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_the_figures_of_other_commands_go_there_too(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    trajectory = symosc.simulate("fig6", t_end=5)
    rows = [f"{t},{x!r},{v!r}" for t in (n / 64 for n in range(321)) for x, v in [trajectory(t).tolist()]]
    Path("s.csv").write_text("\n".join(["t,x,v", *rows]))
    text = good(*arguments, "-")
    assert text.startswith("<?xml")
    assert text.endswith("</svg>\n")
    assert [path.name for path in tmp_path.iterdir()] == ["s.csv"]
