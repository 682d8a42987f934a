"""Somebody's files: every form that is allowed reads the same, and what is broken is one line."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest

from symosc import ResultError
from symosc.reference.results import GivenEvent, read_results

NAMES = {"one", "two"}
EVENTS = [GivenEvent(Fraction("1.5"), Fraction(-2), "stick", 1), GivenEvent(Fraction("2.25"), None, "slip", 0)]
FOR_ALL = "case,t,x,kind,boundary,seconds\none,1.5,-2,stick,1,\none,2.25,,slip,,0.5\ntwo,9,,end,,0.25\n"


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
        "T, X ,Kind,Boundary\n3/2,-2.0,STICK,1\n2.25,,slip,0\n",
        "﻿kind,t,boundary,x,comment\nslip,225e-2,,,later\nstick,1.5,1,-2,\n",
        "t_low,t_high,x_low,x_high,kind,boundary\n1.4,1.6,-3,-1,stick,1\n2.25,2.25,,,slip,\n",
        't,x,kind,boundary\r\n"1.5","-2","stick","1"\r\n2.25,,slip,\r\n9,,end,\r\n',
    ],
)
def test_a_folder_of_csv_files(text: str, tmp_path: Path) -> None:
    (tmp_path / "one.csv").write_text(text, encoding="utf-8", newline="")
    (tmp_path / "README.md").write_text("not read")
    (tmp_path / "cases.csv").write_text("not read")
    assert read_results(tmp_path, NAMES)["one"].events == EVENTS
    (tmp_path / "one.csv").rename(tmp_path / "other.csv")
    (tmp_path / "two").mkdir()
    (tmp_path / "other.csv").rename(tmp_path / "two" / "events.csv")
    assert read_results(tmp_path, NAMES)["two"].events == EVENTS


LIST = [{"t": 1.5, "x": -2, "kind": "stick", "boundary": 1}, {"t": "9/4", "kind": "slip", "x": None}]


@pytest.mark.parametrize("content", [LIST, {"events": LIST, "seconds": 1}, {"events": LIST[::-1], "solver": "mine"}])
def test_json_for_one_case_and_for_all(content: object, tmp_path: Path) -> None:
    (tmp_path / "one.json").write_text(json.dumps(content))
    assert read_results(tmp_path, NAMES)["one"].events == EVENTS
    path = tmp_path / "all.json"
    path.write_text(json.dumps({"two": content}))
    assert read_results(path, NAMES)["two"].events == EVENTS


def test_numbers_keep_all_their_digits(tmp_path: Path) -> None:
    digits = "3.14159265358979323846264338327950288419716939937510"
    (tmp_path / "one.csv").write_text(f"t,kind\n{digits},graze\n")
    (tmp_path / "two.json").write_text(f'[{{"t": {digits}, "kind": "graze"}}]')
    found = read_results(tmp_path, NAMES)
    assert found["one"].events[0].t == found["two"].events[0].t == Fraction(digits)


BROKEN = {
    "": "is empty",
    "  \n\n": "is empty",
    "time,what\n1,stick\n": "has no column t; its columns are time, what",
    "t,x\n1,2\n": "has no column kind",
    "t,t,kind\n1,1,stick\n": "has two columns named 't'",
    "t,kind\nnan,stick\n": "line 2: t = 'nan': must be finite",
    "t,kind\ninf,stick\n": "line 2: t = 'inf': must be finite",
    "t,kind\n1,stick\n1e999999,slip\n": "line 3: t = '1e999999'",
    "t,kind\n,stick\n": "line 2: has no t",
    "t,kind\n1,jump\n": "line 2: kind is 'jump'",
    "t,kind\n1,\n": "line 2: kind is ''",
    "t,kind,boundary\n1,stick,3\n": "line 2: boundary is '3'",
    "t,kind,boundary\n1,stick,1.0\n": "line 2: boundary is '1.0'",
    "t,x,kind\n1,nan,stick\n": "line 2: x = 'nan': must be finite",
    "t,kind\n1,stick,2\n": "line 2: has not as many entries as the header",
    "t,x,kind\n1,2\n": "line 2: has not as many entries as the header",
    "t,kind,seconds\n1,stick,-1\n": "line 2: seconds = -1: must be >= 0",
    't,kind\n"1,stick\n': "is not CSV",
    "t,kind\n1,st\0ick\n": "",
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
    "{": "is not JSON",
    "[" * 100_000: "is not JSON: nested too deeply",
    "[NaN]": "NaN is no number",
    '[{"t": Infinity, "kind": "stick"}]': "Infinity is no number",
    '[{"t": 1e400, "kind": "stick"}]': "t = 1E+400: must be at most 1e+50",
    '[{"t": ' + "9" * 5000 + ', "kind": "stick"}]': "is not JSON",
    '[{"t": 1, "t": 2, "kind": "stick"}]': "'t' is there twice",
    '[{"t": true, "kind": "stick"}]': "t = True",
    '[{"t": [1], "kind": "stick"}]': "t = [1]",
    '[{"t": 1, "kind": ["stick"]}]': "kind is",
    '[{"t": 1, "kind": "stick", "boundary": {}}]': "boundary is '{}'",
    "[1, 2]": "event 1: must be an object",
    "7": "must be a list of events",
    "null": "must be a list of events",
    '"text"': "must be a list of events",
    '{"events": 3}': "must be a list of events",
    '{"events": [], "seconds": "fast"}': "seconds = 'fast'",
}


@pytest.mark.parametrize("text", HOSTILE, ids=lambda text: text[:20])
def test_hostile_json_is_one_line(text: str, tmp_path: Path) -> None:
    (tmp_path / "one.json").write_text(text)
    with pytest.raises(ResultError) as error:
        read_results(tmp_path, NAMES)
    assert HOSTILE[text] in str(error.value)
    assert len(str(error.value)) < 400
    assert len(str(error.value).splitlines()) == 1


def test_files_that_belong_to_no_case(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match="has no results"):
        read_results(tmp_path, NAMES)
    with pytest.raises(ResultError, match="does not exist"):
        read_results(tmp_path / "nothing", NAMES)
    (tmp_path / "notes.txt").write_text("t,kind\n")
    with pytest.raises(ResultError, match=r"must be a folder, a \.csv file or a \.json file"):
        read_results(tmp_path / "notes.txt", NAMES)
    (tmp_path / "all.csv").write_text("case,t,kind\nthree,1,stick\n")
    with pytest.raises(ResultError, match="has results for 'three', which is no case"):
        read_results(tmp_path / "all.csv", NAMES)
    (tmp_path / "all.csv").write_text("t,kind\n1,stick\n")
    with pytest.raises(ResultError, match="has no column case"):
        read_results(tmp_path / "all.csv", NAMES)
    with pytest.raises(ResultError, match="is named 'all', which is no case"):
        read_results(tmp_path, NAMES)
    (tmp_path / "all.csv").write_bytes(b"t,kind\n\xff\xfe,stick\n")
    with pytest.raises(ResultError, match="is not UTF-8 text"):
        read_results(tmp_path / "all.csv", NAMES)
    (tmp_path / "all.csv").unlink()
    for name in ("one.csv", "one.json"):
        (tmp_path / name).write_text("[]" if name.endswith("json") else "t,kind\n")
    with pytest.raises(ResultError, match="second file with results for one"):
        read_results(tmp_path, NAMES)
    (tmp_path / "all.json").write_text("[]")
    with pytest.raises(ResultError, match="must be an object: names of cases"):
        read_results(tmp_path / "all.json", NAMES)
