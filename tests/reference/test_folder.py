"""The files of the cases: they say what the cases say, twice the same, whole or not at all."""

from __future__ import annotations

import csv
import json
import tomllib
from fractions import Fraction
from math import inf
from pathlib import Path
from typing import Any

import pytest
from small_set import small_set, stored_set

from symosc import OutputError, ResultError, load_scene, simulate
from symosc.certificates.verify_orbits import verify
from symosc.reference import case, folder
from symosc.reference.case import COMPUTED
from symosc.reference.compare import SCORE_TOLERANCE
from symosc.reference.folder import SET_FORMAT, checksum, exact_text, write_cases
from symosc.reference.stored import read_set


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_what_is_read_back_is_what_the_cases_say(written: Path) -> None:
    version, cases = read_set(written)
    assert version == folder.SET_VERSION
    for found, known in zip(cases, stored_set(), strict=True):
        assert (found.name, found.events, found.count, found.t0) == (known.name, known.events, known.count, known.t0)
        for a, b in zip(found.conditions, known.conditions, strict=True):
            assert a == pytest.approx(b, rel=5e-3) or a == b == inf


def test_a_case_is_a_scene_file_too(written: Path) -> None:
    for each in small_set():
        scene = load_scene(written / each.name / "case.toml")
        assert scene.parameters == each.parameters
        for name in ("t0", "x0", "v0", "t_end", "start_error"):
            assert getattr(scene, name) == getattr(each.scene, name)


def test_every_table_says_the_same(written: Path) -> None:
    table = {row["name"]: row for row in rows(written / "cases.csv")}
    for each in small_set():
        about = tomllib.loads((written / each.name / "case.toml").read_text())
        row = table[each.name]
        assert '"' not in "".join(row.values())
        assert not any("," in value for value in row.values())
        assert {name: Fraction(row[name]) for name in about["parameters"]} == {
            name: getattr(each.parameters, name) for name in about["parameters"]
        }
        assert all(Fraction(row[name]) == getattr(each, name) for name in ("t0", "x0", "v0", "t_end"))
        assert about["reference"]["events"] == int(row["events"]) == len(rows(written / each.name / "events.csv"))
        assert row["proven"] == ("yes" if each.proven else "no")
        assert bool(about["reference"]["reason"]) == (about["reference"]["status"] == COMPUTED)


def test_enclosures_have_40_digits_and_hold_what_simulate_says(written: Path) -> None:
    for each in small_set():
        exact = simulate(each.scene, digits=50).events
        listed = rows(written / each.name / "events.csv")
        for row, event in zip(listed, exact, strict=True):
            for name in "tx":
                low, high = Fraction(row[f"{name}_low"]), Fraction(row[f"{name}_high"])
                value = Fraction(str(getattr(event, name)))
                scale = max(1, abs(value))
                assert 0 <= high - low < Fraction(1, 10**38) * scale
                assert low - Fraction(1, 10**38) <= value <= high + Fraction(1, 10**38)
            assert (row["kind"], row["boundary"]) == (event.kind, str(event.boundary))
            assert (row["source"], row["target"]) == (event.source, event.target)


def test_words_are_those_of_the_trajectory(written: Path) -> None:
    for name in ("paper-fig5", "paper-fig6"):
        each = next(each for each in small_set() if each.name == name)
        words = [row["word"] for row in rows(written / name / "events.csv") if row["word"]]
        assert words == simulate(each.scene).word


def test_trajectories_are_the_motion_with_events_twice(written: Path) -> None:
    for each in small_set():
        listed = rows(written / each.name / "trajectory.csv")
        times = [float(row["t"]) for row in listed]
        assert times == sorted(times)
        assert (times[0], times[-1]) == (float(each.t0), float(each.t_end))
        motion = simulate(each.scene)
        x, v = motion(times)
        assert [float(row["x"]) for row in listed] == pytest.approx(list(x), rel=1e-9, abs=1e-9)
        assert [float(row["v"]) for row in listed] == pytest.approx(list(v), rel=1e-9, abs=1e-9)
        for event in each.events:
            t = float(event.middle[0])
            modes = [row["mode"] for row in listed if float(row["t"]) == t]
            assert modes[:2] == [event.source, event.target] or event.source in modes


def test_certificates_are_proven_by_the_checker(written: Path) -> None:
    for each in small_set():
        code, _ = verify(str(written / each.name / "certificate.json"))
        assert code == (0 if each.proven else 1)


def test_checksums_and_readme(written: Path) -> None:
    manifest = json.loads((written / "manifest.json").read_text())
    files = {path.relative_to(written).as_posix() for path in written.rglob("*") if path.is_file()}
    assert set(manifest["files"]) == files - {"manifest.json"}
    assert manifest["format"] == SET_FORMAT
    for name, sha in manifest["files"].items():
        assert checksum((written / name).read_bytes()) == sha
    text = (written / "README.md").read_text()
    assert "@" not in text
    assert f"{len(small_set())} cases" in text
    for file in ("cases.csv", "case.toml", "events.csv", "trajectory.csv", "certificate.json"):
        assert f"{file}`" in text
    lines = (written / "cases.csv").read_text().splitlines()
    assert all(f"`{name}`" in text for name in lines[0].split(","))
    assert f"longest has {max(map(len, lines))} characters" in " ".join(text.split())
    assert all(len(line.split(",")) == len(lines[0].split(",")) and ",," not in f"{line}," for line in lines)
    assert f"may be {SCORE_TOLERANCE:g}" in text


def content(path: Path) -> dict[str, bytes]:
    return {each.relative_to(path).as_posix(): each.read_bytes() for each in path.rglob("*") if each.is_file()}


def test_a_second_run_writes_the_same_bytes(tmp_path: Path) -> None:
    cases = small_set()[:2]
    first = content(write_cases(tmp_path / "cases", cases))
    for cache in (case._events, case._certificate, case._conditions):
        cache.cache_clear()
    again = write_cases(tmp_path / "cases", cases)
    assert content(again) == first
    write_cases(again, cases[1:])  # in place of the others: nothing of them is left
    tops = {name.partition("/")[0] for name in content(again)}
    assert tops == {cases[1].name, "README.md", "manifest.json", "cases.csv"}


@pytest.mark.slow
def test_processes_write_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folder, "CASES_IN_LINE", 1)
    cases = small_set()[:3]
    one, two = (write_cases(tmp_path / str(n), cases, workers=n) for n in (1, 2))
    assert content(one) == content(two)


def test_somebodys_files_are_not_touched(tmp_path: Path) -> None:
    target = tmp_path / "cases"
    write_cases(target, small_set()[:1])
    (target / "mine.csv").write_text("t,kind\n")
    before = content(target)
    with pytest.raises(OutputError, match=r"has a file that would be lost: mine\.csv"):
        write_cases(target, small_set()[:1])
    assert content(target) == before
    other = tmp_path / "other"
    other.mkdir()
    (other / "manifest.json").write_text('{"format": "something"}')
    with pytest.raises(OutputError, match="would be lost"):
        write_cases(other, small_set()[:1])
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_nothing_is_left_where_it_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "cases"
    write_cases(target, small_set()[:1])
    before = content(target)

    def fail(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(folder, "_manifest", fail)
    with pytest.raises(KeyboardInterrupt):
        write_cases(target, small_set()[:2])
    assert content(target) == before
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize(
    ("file", "text", "message"),
    [
        ("manifest.json", "{", "is not JSON"),
        ("manifest.json", "[]", "is not of the format"),
        ("manifest.json", '{"format": "symosc reference cases 1"}', "is not a set of reference cases: KeyError"),
        (
            "manifest.json",
            '{"format": "symosc reference cases 1", "set_version": 1, "files": {}, "cases": [{"name": 3}]}',
            "cannot be read",
        ),
        ("paper-fig6/events.csv", "t\n1\n", "is not the file that was written: its checksum differs"),
        ("paper-fig6/events.csv", None, "cannot be read"),
        ("manifest.json", None, "has no manifest.json; `symosc cases -o"),
    ],
)
def test_a_broken_set_is_one_line(file: str, text: str | None, message: str, tmp_path: Path) -> None:
    target = write_cases(tmp_path / "cases", [each for each in small_set() if each.name == "paper-fig6"])
    if text is None:
        (target / file).unlink()
    else:
        (target / file).write_text(text)
    with pytest.raises(ResultError, match=message) as error:
        read_set(target)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    "value", [Fraction(1, 3), Fraction(-5, 4), Fraction(7), 1 + Fraction(1, 10**95), Fraction(10**40)]
)
def test_numbers_read_back_exactly(value: Fraction) -> None:
    assert Fraction(exact_text(value)) == value
