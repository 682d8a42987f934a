"""The files of the cases, and somebody's files.

Each form is read the same, and a broken one is one line.
"""

from __future__ import annotations

import csv
import json
import tomllib
from dataclasses import replace
from fractions import Fraction
from math import inf, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_set import small_set

from symosc import OutputError, ResultError, load_scene, simulate
from symosc.certificates.verify_orbits import verify
from symosc.reference import folder
from symosc.reference.case import COMPUTED
from symosc.reference.cases import reference_case
from symosc.reference.folder import SET_FORMAT, checksum, exact_text, read_set, write_cases
from symosc.reference.results import GivenEvent, read_results
from symosc.reference.score import SCORE_TOLERANCE

# -- folder ----------------------------------------------------------------------------------------


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_what_is_read_back_is_what_the_cases_say(written: Path) -> None:
    version, cases = read_set(written)
    assert version == folder.SET_VERSION
    for found, known in zip(cases, small_set(), strict=True):
        assert (found.name, found.events, found.count, found.t0) == (
            known.name,
            known.events,
            known.count,
            known.t0,
        )
        for a, b in zip(found.conditions, known.conditions, strict=True):
            assert a == pytest.approx(b, rel=5e-3) or a == b == inf
        assert found.derivatives == known.derivatives


def test_a_case_is_a_scene_file_too(written: Path) -> None:
    for case in small_set():
        scene = load_scene(written / case.name / "case.toml")
        assert scene.parameters == case.parameters
        for name in ("t0", "x0", "v0", "t_end", "start_error"):
            assert getattr(scene, name) == getattr(case.scene, name)


def test_every_table_says_the_same(written: Path) -> None:
    table = {row["name"]: row for row in rows(written / "cases.csv")}
    for case in small_set():
        about = tomllib.loads((written / case.name / "case.toml").read_text())
        row = table[case.name]
        assert '"' not in "".join(row.values())
        assert not any("," in value for value in row.values())
        assert {name: Fraction(row[name]) for name in about["parameters"]} == {
            name: getattr(case.parameters, name) for name in about["parameters"]
        }
        assert all(
            Fraction(row[name]) == getattr(case, name) for name in ("t0", "x0", "v0", "t_end")
        )
        assert (
            about["reference"]["events"]
            == int(row["events"])
            == len(rows(written / case.name / "events.csv"))
        )
        assert row["proven"] == ("yes" if case.proven else "no")
        for condition in (row["condition"], about["reference"]["condition"]):
            assert float(condition) == pytest.approx(case.condition, rel=5e-3)
        assert tuple(about["reference"]["closed_form"]) == case.closed_form
        assert bool(about["reference"]["reason"]) == (about["reference"]["status"] == COMPUTED)


def test_enclosures_have_40_digits_and_hold_what_simulate_says(written: Path) -> None:
    for case in small_set():
        exact = simulate(case.scene, digits=50).events
        listed = rows(written / case.name / "events.csv")
        for row, event in zip(listed, exact, strict=True):
            for name in "tx":
                low = Fraction(row[f"{name}_low"])
                high = Fraction(row[f"{name}_high"])
                value = Fraction(str(getattr(event, name)))
                scale = max(1, abs(value))
                assert 0 <= high - low < Fraction(1, 10**38) * scale
                assert low - Fraction(1, 10**38) <= value <= high + Fraction(1, 10**38)
            assert (row["kind"], row["boundary"]) == (event.kind, str(event.boundary))
            assert (row["source"], row["target"]) == (event.source, event.target)


def test_words_are_those_of_the_trajectory(written: Path) -> None:
    for name in ("paper-fig5", "paper-fig6"):
        case = next(case for case in small_set() if case.name == name)
        words = [row["word"] for row in rows(written / name / "events.csv") if row["word"]]
        assert words == simulate(case.scene).word


def test_trajectories_are_the_motion_with_events_twice(written: Path) -> None:
    for case in small_set():
        listed = rows(written / case.name / "trajectory.csv")
        times = [float(row["t"]) for row in listed]
        assert times == sorted(times)
        assert (times[0], times[-1]) == (float(case.t0), float(case.t_end))
        motion = simulate(case.scene)
        x, v = motion(times)
        assert [float(row["x"]) for row in listed] == pytest.approx(list(x), rel=1e-9, abs=1e-9)
        assert [float(row["v"]) for row in listed] == pytest.approx(list(v), rel=1e-9, abs=1e-9)
        for event in case.events:
            t = float(event.middle[0])
            modes = [row["mode"] for row in listed if float(row["t"]) == t]
            assert modes[:2] == [event.source, event.target] or event.source in modes


def test_samples_of_a_long_run_show_twenty_periods() -> None:
    case = reference_case("1e5-periods-fig10-orbit")
    first, *_, last = folder._samples(case)
    assert float(last[0]) - float(first[0]) == pytest.approx(
        20 * 2 * pi / float(case.parameters.Omega)
    )


def test_certificates_are_proven_by_the_checker(written: Path) -> None:
    for case in small_set():
        code, _ = verify(str(written / case.name / "certificate.json"))
        assert code == (0 if case.proven else 1)


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
    assert all(
        len(line.split(",")) == len(lines[0].split(",")) and ",," not in f"{line},"
        for line in lines
    )
    assert f"may be {SCORE_TOLERANCE:g}" in text


def content(path: Path) -> dict[str, bytes]:
    return {
        each.relative_to(path).as_posix(): each.read_bytes()
        for each in path.rglob("*")
        if each.is_file()
    }


def test_a_second_run_writes_the_same_bytes(tmp_path: Path) -> None:
    cases = small_set()[:2]
    first = content(write_cases(tmp_path / "cases", cases))
    again = write_cases(tmp_path / "cases", [replace(case) for case in cases])  # computed anew
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
    with pytest.raises(OutputError, match=r"its file mine\.csv would be lost"):
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

    monkeypatch.setattr(folder, "_manifest_text", fail)
    with pytest.raises(KeyboardInterrupt):
        write_cases(target, small_set()[:2])
    assert content(target) == before
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize(
    "value",
    [Fraction(1, 3), Fraction(-5, 4), Fraction(7), 1 + Fraction(1, 10**95), Fraction(10**40)],
)
def test_numbers_read_back_exactly(value: Fraction) -> None:
    assert Fraction(exact_text(value)) == value


# -- results ---------------------------------------------------------------------------------------


NAMES = {"one", "two"}
EVENTS = [
    GivenEvent(Fraction("1.5"), Fraction(-2), "stick", 1),
    GivenEvent(Fraction("2.25"), None, "slip", 0),
]
FOR_ALL = (
    "case,t,x,kind,boundary,seconds\none,1.5,-2,stick,1,\none,2.25,,slip,,0.5\ntwo,9,,end,,0.25\n"
)


def test_one_csv_for_all_cases(tmp_path: Path) -> None:
    path = tmp_path / "all.csv"
    path.write_text(FOR_ALL)
    found = read_results(path, NAMES)
    assert (found["one"].events, found["one"].seconds) == (EVENTS, 0.5)
    assert (found["two"].events, found["two"].seconds) == ([], 0.25)


@pytest.mark.parametrize(
    "text",
    [
        "t,x,kind,boundary\n1.5,-2,stick,1\n2.25,,slip,\n",
        "t, x ,kind,boundary\n3/2,-2.0,STICK,1.0\n2.25,,slip,0\n",
        "﻿kind,t,boundary,x,comment\nslip,225e-2,,,later\n\nstick,1.5,1,-2,\n",
        "t_low,t_high,x_low,x_high,kind,boundary\n1.4,1.6,-3,-1,stick,1\n2.25,2.25,,,slip,\n",
        't,x,kind,boundary\r\n"1.5","-2","stick","1"\r\n2.25,,slip,\r\n9,,end,\r\n',
        "t;x;kind;boundary\n1,5;-2;stick;1\n2,25;;slip;\n",
        "# my solver\nTime (s)\tPosition\tevent\tbelt\n1.5\t-2\tstick\t1\n2.25\t\tslip\t\n",
        "t,x,kind,boundary,\n1.5d0,-2,stick,1,\n0.225e1,,slip,,\n",
    ],
)
def test_a_folder_of_csv_files(text: str, tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text(text, encoding="utf-8", newline="")
    (tmp_path / "README.md").write_text("not read")
    (tmp_path / "cases.csv").write_text("not read")
    assert read_results(tmp_path, NAMES)["one"].events == EVENTS
    (tmp_path / "two").mkdir()
    (tmp_path / "one.csv").rename(tmp_path / "two" / "events.csv")
    assert read_results(tmp_path, NAMES)["two"].events == EVENTS


def test_a_table_in_any_format(tmp_path: Path) -> None:
    columns = {
        "time": [1.5, 2.25, 9.0],
        "x": [-2.0, np.nan, np.nan],
        "kind": ["stick", "slip", "end"],
        "belt": [1, 0, 0],
        "case": ["one"] * 3,
    }
    np.savez(tmp_path / "all.npz", **{name: np.array(values) for name, values in columns.items()})
    result = read_results(tmp_path / "all.npz", NAMES)["one"]
    assert (result.events, result.end) == (EVENTS, 9)


EVENT_LIST = [
    {"t": 1.5, "x": -2, "kind": "stick", "boundary": 1},
    {"t": "9/4", "kind": "slip", "x": None},
]


@pytest.mark.parametrize("events", [EVENT_LIST, EVENT_LIST[::-1]])
def test_json_for_all_cases(events: object, tmp_path: Path) -> None:
    path = tmp_path / "all.json"
    about = {"two": {"events": events, "seconds": 0.5, "solver": "mine"}, "one": {"events": []}}
    path.write_text(json.dumps(about))
    results = read_results(path, NAMES)
    assert (results["two"].events, results["two"].seconds) == (EVENTS, 0.5)
    assert (results["one"].events, results["one"].seconds) == ([], None)


@pytest.mark.parametrize("ends", [(3, 9), (9, 3), (9, None)])
def test_the_end_is_the_latest_time_that_is_stated(ends: object, tmp_path: Path) -> None:
    path = tmp_path / "all.json"
    events = [{"t": t, "kind": "end"} for t in ends]  # type: ignore[attr-defined]
    path.write_text(json.dumps({"one": {"events": events}}))
    assert read_results(path, NAMES)["one"].end == 9


def test_numbers_keep_all_their_digits(tmp_path: Path) -> None:
    digits = "3.14159265358979323846264338327950288419716939937510"
    (tmp_path / "one.csv").write_text(f"t,kind\n{digits},graze\n")
    assert read_results(tmp_path, NAMES)["one"].events[0].t == Fraction(digits)
    path = tmp_path / "all.json"
    path.write_text(f'{{"two": {{"events": [{{"t": {digits}, "kind": "graze"}}]}}}}')
    assert read_results(path, NAMES)["two"].events[0].t == Fraction(digits)


BROKEN = {
    "  \n\n": "is empty",
    "time,what\n1,stick\n": "has no column kind; its columns are time, what",
    "t,t,kind\n1,1,stick\n": "has two columns for t: 't' and 't'",
    "time,zeit,kind\n1,1,stick\n": "has two columns for t: 'time' and 'zeit'",
    "t,kind\n1,stick\nnan,slip\n": "line 3: t = 'nan': must be finite",
    "t,kind\n,stick\n": "line 2: it has no t",
    "t,kind\n1,jump\n": "line 2: kind is 'jump'",
    "t,kind,boundary\n1,stick,1.5\n": "line 2: boundary is '1.5'",
    "t,kind,boundary\n1,stick,one\n": "line 2: boundary = 'one'",
    "t,x,kind\n1,2\n": "row 2 has 2 entries, and the others have 3",
    "t,kind,seconds\n1,stick,-1\n": "line 2: seconds = -1: must be >= 0",
    't,kind\n1,"stick\n': "cannot be read: unexpected end of data",
    "t,kind\n1,st\0ick\n": "it is not text in lines",
}


@pytest.mark.parametrize("text", BROKEN)
def test_broken_csv_is_one_line(text: str, tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text(text)
    with pytest.raises(ResultError) as error:
        read_results(tmp_path, NAMES)
    assert BROKEN[text] in str(error.value)
    assert str(error.value).startswith(str(tmp_path / "one.csv")[:20])
    assert len(str(error.value).splitlines()) == 1


HOSTILE = {
    "{": "cannot be read: Expecting",
    "[" * 100_000: "its brackets are nested too deeply",
    '{"one": {"events": [{"t": 1e400, "kind": "stick"}]}}': "t = '1e400': must be at most 1e+50",
    '{"one": {"events": [{"t": '
    + "9" * 5000
    + ', "kind": "stick"}]}}': "may have at most 4000 characters",
    '{"one": {"events": [{"t": true, "kind": "stick"}]}}': "t = True",
    '{"one": {"events": [{"t": NaN, "kind": "stick"}]}}': "t = 'NaN': must be finite",
    '{"one": {"events": [{"t": 1, "kind": ["stick"]}]}}': "kind is",
    '{"one": {"events": [{"t": 1, "kind": "stick", "boundary": {}}]}}': "boundary = {}",
    '{"one": {"t": [1, 2], "kind": ["stick"]}}': "it must be an object with a list 'events'",
    '{"one": [1, 2]}': "it must be an object with a list 'events'",
    '{"one": {"events": [1, 2]}}': "one, event 1: it must be an object",
    "null": "must be an object: names of cases",
    '{"one": {"events": [], "seconds": "fast"}}': "seconds = 'fast'",
}


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: text[:20])
def test_hostile_json_is_one_line(text: str, tmp_path: Path) -> None:
    path = tmp_path / "all.json"
    path.write_text(text)
    with pytest.raises(ResultError) as error:
        read_results(path, NAMES)
    assert HOSTILE[text] in str(error.value)
    assert len(str(error.value)) < 400
    assert len(str(error.value).splitlines()) == 1


def test_files_that_belong_to_no_case(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="has no results"):
        read_results(tmp_path, NAMES)
    with pytest.raises(ResultError, match="does not exist"):
        read_results(tmp_path / "nothing", NAMES)
    (tmp_path / "notes.txt").write_text("in a folder it is not read")
    (tmp_path / "all.md").write_text("t,kind\n")
    with pytest.raises(ResultError, match=r"must end in \.csv, \.tsv"):
        read_results(tmp_path / "all.md", NAMES)
    (tmp_path / "all.mat").write_text("t,kind\n")
    with pytest.raises(ResultError, match="not a readable MATLAB file"):
        read_results(tmp_path / "all.mat", NAMES)
    (tmp_path / "all.mat").unlink()
    (tmp_path / "all.csv").write_text("case,t,kind\nthree,1,stick\n")
    with pytest.raises(ResultError, match="has results for 'three', which is no case"):
        read_results(tmp_path / "all.csv", NAMES)
    (tmp_path / "all.csv").write_text("t,kind\n1,stick\n")
    with pytest.raises(ResultError, match="has no column case"):
        read_results(tmp_path / "all.csv", NAMES)
    with pytest.raises(ResultError, match="is named 'all', which is no case"):
        read_results(tmp_path, NAMES)
    (tmp_path / "all.csv").write_bytes(b"t,kind\n\xff\xfe,stick\n")
    with pytest.raises(ResultError, match="has no column case"):
        read_results(tmp_path / "all.csv", NAMES)
    (tmp_path / "all.csv").unlink()
    (tmp_path / "one").mkdir()
    for name in ("one.csv", "one/events.csv"):
        (tmp_path / name).write_text("t,kind\n")
    with pytest.raises(ResultError, match="second file with results for one"):
        read_results(tmp_path, NAMES)
