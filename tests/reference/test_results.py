"""Somebody's files: every form that is allowed reads the same, and what is broken is one line."""

from __future__ import annotations

import gzip
import json
from fractions import Fraction
from pathlib import Path

import numpy as np
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


OCTAVE = Path(__file__).parents[1] / "crosschecks" / "octave"
COLUMNS = {"t": [1.5, 2.25, 9], "x": [-2, None, None], "kind": ["stick", "slip", "end"], "boundary": [1, None, None]}
#: The same as text in other ways.
TEXTS = {
    "one.csv": "t;x;kind;boundary\n1,5;-2,0;stick;1\n2,25;;slip;\n9;;end;\n",
    "one.tsv": "# mine\nTime\tPosition (m)\tKind\tBelt\n15D-1\t-2d0\tstick\t1.0\n\n2.25\t\tslip\t0e+00\n9\t\tend\t\n",
    "one.txt": "% t kind\n1.5 stick\n2.25 slip\n# done\n9.0 end\n",
    "one.json": json.dumps(COLUMNS),
}


@pytest.mark.parametrize("name", TEXTS)
def test_score_reads_what_check_reads(name: str, tmp_path: Path) -> None:
    """Semicolons, decimal commas, comments, exponents of Fortran, 1.0 for a belt, columns; and packed."""
    wanted = EVENTS if name != "one.txt" else [event._replace(x=None, boundary=0) for event in EVENTS]
    (tmp_path / name).write_text(TEXTS[name])
    found = read_results(tmp_path, NAMES)["one"]
    assert (found.events, found.end) == (wanted, 9)
    (tmp_path / name).unlink()
    (tmp_path / f"{name}.gz").write_bytes(gzip.compress(TEXTS[name].encode()))
    assert read_results(tmp_path, NAMES)["one"].events == wanted


@pytest.mark.parametrize("suffix", ["npz", "mat", "parquet", "feather", "h5"])
def test_score_reads_arrays(suffix: str, tmp_path: Path) -> None:
    import h5py
    import pandas
    from scipy.io import savemat

    path, frame = tmp_path / f"all.{suffix}", pandas.DataFrame({"case": ["one", "one", "two"], **COLUMNS})
    words = ("case", "kind")
    arrays = {name: frame[name].to_numpy(dtype=object if name in words else float) for name in frame}
    if suffix == "npz":
        np.savez(path, **(arrays | {name: arrays[name].astype(str) for name in words}))
    elif suffix == "mat":
        savemat(path, arrays)
    elif suffix == "h5":
        with h5py.File(path, "w") as file:
            for name, column in arrays.items():
                file[name] = column
    else:
        getattr(frame, f"to_{suffix}")(path)
    found = read_results(path, NAMES)
    assert (found["one"].events, found["two"].events, found["two"].end) == (EVENTS, [], 9)


@pytest.mark.parametrize("name", ["events.txt", "events.h5", "events.mat", "chars.txt", "chars.h5"])
def test_score_reads_what_octave_saves(name: str, tmp_path: Path) -> None:
    (tmp_path / f"one{Path(name).suffix}").write_bytes((OCTAVE / name).read_bytes())
    found = read_results(tmp_path, NAMES)["one"]
    assert found.events == [EVENTS[0], GivenEvent(Fraction("2.25"), Fraction(1, 2), "slip", 2)]
    assert found.end == 9


LIST = [{"t": 1.5, "x": -2, "kind": "stick", "boundary": 1}, {"t": "9/4", "kind": "slip", "x": None}]


@pytest.mark.parametrize("content", [LIST, {"events": LIST, "seconds": 1}, {"events": LIST[::-1], "solver": "mine"}])
def test_json_for_one_case_and_for_all(content: object, tmp_path: Path) -> None:
    (tmp_path / "one.json").write_text(json.dumps(content))
    assert read_results(tmp_path, NAMES)["one"].events == EVENTS
    path = tmp_path / "all.json"
    path.write_text(json.dumps({"two": content}))
    assert read_results(path, NAMES)["two"].events == EVENTS
    path.write_text(json.dumps([{"case": "two", **event} for event in LIST]))
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
    "time,what\n1,stick\n": "has no column kind; its columns are time, what",
    "t,x\n1,2\n": "has no column kind",
    "t,t,kind\n1,1,stick\n": "has two columns named 't'",
    "t,kind\nnan,stick\n": "line 2: t = 'nan': must be finite",
    "t,kind\ninf,stick\n": "line 2: t = 'inf': must be finite",
    "t,kind\n1,stick\n1e999999,slip\n": "line 3: t = '1e999999'",
    "t,kind\n,stick\n": "line 2: has no t",
    "t,kind\n1,jump\n": "line 2: kind is 'jump'",
    "t,kind\n1,\n": "line 2: kind is ''",
    "t,kind,boundary\n1,stick,3\n": "line 2: boundary is '3'",
    "t,kind,boundary\n1,stick,1.5\n": "line 2: boundary is '1.5'",
    "t,x,kind\n1,nan,stick\n": "line 2: x = 'nan': must be finite",
    "t,kind\n1,stick,2\n": "row 2 has 3 entries, the header 2",
    "t,x,kind\n1,2\n": "row 2 has 2 entries, the header 3",
    "t,kind,seconds\n1,stick,-1\n": "line 2: seconds = -1: must be >= 0",
    't,kind\n"1,stick\n': "row 2 has 1 entries, the header 2",
    "time,ts,kind\n1,1,stick\n": "has two columns named 'time'",
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
    "{": "cannot be read: Expecting",
    "[" * 100_000: "its brackets are nested too deeply",
    "[NaN]": "event 1: must be an object",
    '[{"t": Infinity, "kind": "stick"}]': "t = inf: must be finite",
    '[{"t": 1e400, "kind": "stick"}]': "t = 1E+400: must be at most 1e+50",
    '[{"t": ' + "9" * 5000 + ', "kind": "stick"}]': "thousands of digits",
    '[{"t": 1, "t": 2, "kind": "stick"}]': "has 't' twice",
    '[{"t": true, "kind": "stick"}]': "t = True",
    '[{"t": [1], "kind": "stick"}]': "t = [1]",
    '[{"t": 1, "kind": ["stick"]}]': "kind is",
    '[{"t": 1, "kind": "stick", "boundary": {}}]': "boundary is '{}'",
    '[{"t": 1, "kind": "stick", "boundary": ""}]': "boundary is ''",
    '{"t": [1, 2], "kind": ["stick"]}': "has columns of several lengths",
    '{"t": [[1, 2]], "kind": [["stick", {}]]}': "kind is '{}'",
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
    (tmp_path / "notes.txt").write_text("in a folder it is not read")
    (tmp_path / "notes.md").write_text("t,kind\n")
    with pytest.raises(ResultError, match=r"must end in \.csv, "):
        read_results(tmp_path / "notes.md", NAMES)
    (tmp_path / "all.csv").write_text("case,t,kind\nthree,1,stick\n")
    with pytest.raises(ResultError, match="has results for 'three', which is no case"):
        read_results(tmp_path / "all.csv", NAMES)
    (tmp_path / "all.csv").write_text("t,kind\n1,stick\n")
    with pytest.raises(ResultError, match="has no column case"):
        read_results(tmp_path / "all.csv", NAMES)
    with pytest.raises(ResultError, match="is named 'all', which is no case"):
        read_results(tmp_path, NAMES)
    (tmp_path / "all.csv").write_bytes(b"t,kind\n\xff\xfe,stick\n")
    with pytest.raises(ResultError, match="it is not text in UTF-8"):
        read_results(tmp_path / "all.csv", NAMES)
    (tmp_path / "all.csv").unlink()
    for name in ("one.csv", "one.json"):
        (tmp_path / name).write_text("[]" if name.endswith("json") else "t,kind\n")
    with pytest.raises(ResultError, match="second file with results for one"):
        read_results(tmp_path, NAMES)
    (tmp_path / "all.json").write_text("[]")
    with pytest.raises(ResultError, match="must be an object: names of cases"):
        read_results(tmp_path / "all.json", NAMES)
