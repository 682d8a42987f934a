"""`symosc sweep`: what it prints, writes and draws, and how it goes on."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click
import pytest
from cli_runs import good, run

from symosc import SweepError, sweep
from symosc.cli import sweep as command
from symosc.cli.app import main

pytest.importorskip("xarray")
CALL = ("sweep", "fig9", "--over", "Omega=3:5:3", "--over", "FN=5:10:2", "--t-end", "6T", "--skip", "4T")


def test_it_tells_what_was_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = sweep("fig9", {"Omega": "3:5:3", "FN": "5:10:2"}, t_end="6T", skip="4T").word.values.ravel().tolist()
    first, second, third, *wrote = good(*CALL, "-o", "map.nc", "--plot", "map.svg").splitlines()
    assert first == "Omega (3) × FN (2): 6 motions"
    assert all(f"{word} {words.count(word) / 6:.1%}" in second for word in words)
    assert third == "status: t_end 100.0%"
    assert wrote == ["wrote map.nc", "wrote map.svg"]
    assert {path.name for path in tmp_path.iterdir()} == {"map.nc", "map.svg"}
    data = json.loads(good(*CALL, "-o", "map.nc", "--json"))  # read, not computed
    assert (data["sizes"], data["output"]) == ({"Omega": 3, "FN": 2}, "map.nc")
    assert data["columns"]["word"] == {word: words.count(word) for word in words}
    assert data["call"].startswith("sweep(Scene('fig9', ")


def test_numbers_are_told_by_their_range() -> None:
    found = sweep("fig9", {"k": "2:4:5"}, record=("events", "x"), t_end=3)
    lines = good("sweep", "fig9", "--over", "k=2:4:5", "--record", "events,x", "--t-end", "3").splitlines()
    assert lines[1] == f"events: from {found.events.values.min()} to {found.events.values.max()}"
    assert lines[2] == f"x: from {found.x.values.min():.6g} to {found.x.values.max():.6g}"


def test_status(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    output = ("-o", "map.csv", "--status")
    assert good(*CALL, *output) == "map.csv: 0 of 6 motions (0.0%), not yet written\n"
    good(*CALL, "-o", "map.csv")
    assert good(*CALL, *output) == "map.csv: 6 of 6 motions (100.0%), written\n"
    assert json.loads(good(*CALL, *output, "--json")) == {"path": "map.csv", "done": 6, "total": 6, "written": True}


def test_settings_and_restart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    good(*CALL, "-o", "map.nc")
    assert run(*CALL, "--set", "k=2", "-o", "map.nc").exit_code != 0
    data = json.loads(good(*CALL, "--set", "k=2", "-o", "map.nc", "--restart", "--json"))
    assert json.loads(data["scene"])["k"] == "2"


def test_svg_to_stdout() -> None:
    assert "<svg" in good(*CALL, "--plot", "-")


def test_an_interrupt_tells_how_far_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("symosc.sweeps.sweep.sweep", interrupted)
    result = run(*CALL, "-o", "map.nc")
    assert result.exit_code == 130
    assert result.stderr == "symosc: interrupted: 0 of 6 motions are kept; the same command goes on\n"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "over"),
        (["--over", "Omega"], "'Omega' is not NAME=LO:HI:N"),
        (["--over", "Omega=1:2"], "LO:HI:N"),
        (["--over", "Omega=1:2:3", "--over", "Omega=1:2:3"], "Omega is there twice"),
        (["--over", "omega=1:2:3"], "cannot be swept"),
        (["--over", "Omega=0:2:3"], "Omega = "),
        (["--over", "k=1:2:3", "--record", "words"], "is not recorded"),
        (["--over", "k=1:2:3", "--t-end", "0T"], "t_end = "),
        (["--over", "k=1:2:3", "--workers", "0"], "workers = "),
        (["--over", "k=1:2:3", "--executor", "tcp://host"], "is not dask:ADDRESS"),
        (["--over", "k=1:2:3", "--executor", "dask:none.json"], "no such scheduler file"),
        (["--over", "k=1:2:3", "-o", "map.txt"], "must end in .nc, .zarr, .csv"),
        (["--over", "k=1:2:3", "-o", "-"], "goes to a file"),
        (["--over", "k=1:2:3", "-o", "no/map.nc"], "No such file or directory"),
        (["--over", "k=1:2:3", "--plot", "map.gif"], "must end in .pdf, .svg or .png"),
        (["--over", "k=1:2:3", "--plot", "-", "--json"], "standard output"),
        (["--over", "k=1:2:3", "--status"], "name it"),
    ],
)
def test_bad_input_costs_one_line(
    options: list[str],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        main.main(["sweep", "fig9", *options], prog_name="symosc")
    printed = capsys.readouterr()
    assert (ended.value.code, printed.out) == (2, "")
    assert message in printed.err
    assert printed.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_worker_that_fails_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: Any, **__: Any) -> None:
        raise SweepError("a worker failed: of something")

    monkeypatch.setattr("symosc.sweeps.sweep.sweep", failing)
    with pytest.raises(SweepError, match="a worker failed"):
        main.main([*CALL], standalone_mode=False)


def test_the_cluster_is_named_by_its_address(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    asked = []
    monkeypatch.setattr("symosc.sweeps.run.dask_client", asked.append)
    command._executor("dask:tcp://host:8786")
    assert asked == ["tcp://host:8786"]
    with pytest.raises(click.BadParameter):
        command._executor("dask:")
