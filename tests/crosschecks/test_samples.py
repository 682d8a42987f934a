"""Input of cross-checks that is none: one clear line that names the argument, whatever it is."""

from __future__ import annotations

import json
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck

from symosc import ParameterError, simulate
from symosc.crosschecks.files import read_samples
from symosc.crosschecks.samples import LONGEST_ITEM, short, shown

T = np.linspace(0.1324, 3, 30)
X, V = simulate("fig9", t_end=3)(T)

COLUMNS: dict[str, Any] = {
    "nothing": None,
    "text": "abc",
    "a number": 5.0,
    "truth values": T > 1,
    "True among numbers": [True, *T[1:]],
    "complex": T + 0j,
    "complex without a part": [1j * 0] * 30,
    "dates": np.arange(30).astype("datetime64[s]"),
    "spans of time": np.arange(30).astype("timedelta64[s]"),
    "masked": np.ma.array(T, mask=[1] + [0] * 29),
    "NaN": np.where(T > 1, np.nan, T),
    "infinite": np.where(T > 1, np.inf, T),
    "too large": np.where(T > 1, 1e200, T),
    "a huge int": [10**400] * 30,
    "more digits than Python prints": [10**5000] * 30,
    "ragged": [[1, 2], [3]],
    "two-dimensional": [[1.0]] * 30,
    "a mapping": {"a": 1},
    "underscores": ["1_000"] * 30,
    "full-width digits": ["１"] * 30,
    "a generator": (value for value in T),
    "too short": T[:3],
    "empty": [],
    "None inside": [None] * 30,
    "records": np.array([(1.0, 2.0)] * 30, dtype="f8,f8"),
    "long text": ["a" * 10000] * 30,
}

EVENTS: dict[str, Any] = {
    "a number": 5,
    "text": "abc",
    "bytes": b"ab",
    "an array of nothing": np.array(5),
    "None inside": [None],
    "a number inside": [1.0],
    "three": [(1, "cross", 2)],
    "NaN": [(np.nan, "cross")],
    "infinite": [(np.inf, "cross")],
    "complex": [(1j, "cross")],
    "True": [(True, "cross")],
    "huge": [(10**400, "cross")],
    "underscore": [("1_0", "cross")],
    "no kind": [(1.0, None)],
    "another kind": [(1.0, "jump")],
    "a list for a kind": [(1.0, [])],
    "deep": [[[[[1]]]]],
    "rows": [{"t": 1, "kind": "cross"}],
}


def one_line(call: Callable[[], Any], *words: str) -> None:
    with pytest.raises(ParameterError) as caught:
        call()
    text = str(caught.value)
    assert "\n" not in text
    assert len(text) < 300
    text.encode()  # it can be printed
    for word in words:
        assert word in text


@pytest.mark.parametrize("what", COLUMNS)
def test_what_is_no_column(what: str) -> None:
    for name in "tx" if what == "nothing" else "txv":  # without velocities they are computed
        columns = {"t": T, "x": X, "v": V} | {name: COLUMNS[what]}
        words = ("lengths", f"'{name}'") if what in ("too short", "empty") else (f"{name}",)
        one_line(lambda columns=columns: crosscheck("fig9", columns["t"], columns["x"], columns["v"]), *words)  # type: ignore[misc]


def test_what_is_a_column_all_the_same() -> None:
    for kind in (np.float32, np.longdouble, object):
        assert crosscheck("fig9", T.astype(kind), X, V, tolerance=1e-5).ok
    assert crosscheck("fig9", [str(value) for value in T], [Fraction(value) for value in X.tolist()], V.tolist()).ok
    assert crosscheck("fig9", np.ma.array(T, mask=False), X, V).ok


@pytest.mark.parametrize("what", EVENTS)
def test_what_is_no_list_of_events(what: str) -> None:
    one_line(lambda: crosscheck("fig9", T, X, V, events=EVENTS[what]), "events")


def test_times() -> None:
    one_line(lambda: crosscheck("fig9", T[::-1], X, V), "t[1]", "comes after")
    one_line(lambda: crosscheck("fig9", np.ones(30), X, V), "t", "repeated")
    one_line(lambda: crosscheck("fig9", T + 1e40, X, V), "t", "repeated")
    for shift in (1e6, -1e6):
        assert not crosscheck("fig9", T + shift, X, V).ok


def test_a_missing_column_is_said() -> None:
    one_line(lambda: crosscheck("fig9", T, v=V), "x = None", "missing")
    for source in (None, 5, [1, 2], b"x", np.zeros((3, 4)), {}, {"t": T}, (value for value in T)):
        one_line(lambda source=source: crosscheck("fig9", source), " = ")  # type: ignore[misc]


@pytest.mark.parametrize("y", [np.zeros((4, 30)), np.zeros((1, 30)), np.zeros(30), [[1, 2], [3]], None, 5])
def test_results_of_another_number_of_rows(y: Any) -> None:
    one_line(lambda: crosscheck("fig9", SimpleNamespace(t=T, y=y)), "y = ", "two rows")


@pytest.mark.parametrize("columns", ["t=x", [1], {"q": "x"}, {"x": None}, {"x": ["x"]}, {"t": "x"}])
def test_names_of_columns(columns: Any) -> None:
    one_line(lambda: read_samples({"t": T, "x": X, "v": V}, columns), "columns")


GOOD = {"t": T.tolist(), "x": X.tolist(), "v": V.tolist()}
ROWS = "\n".join(",".join(map(repr, row)) for row in zip(*GOOD.values(), strict=True))

TEXTS = {
    "text.json": ('{"t": "abc", "x": [1, 2], "v": [1, 2]}', "t[0] = 'abc'"),
    "events.json": (json.dumps(GOOD | {"events": 5}), "events = 5"),
    "deep.json": ("[" * 100000 + "]" * 100000, "nested too deeply"),
    "deep_column.json": ('{"t": ' + "[" * 800 + "]" * 800 + ', "x": [1], "v": [1]}', "t[0]"),
    "empty.json": ("", "is empty"),
    "blank.json": (" \n", "is empty"),
    "number.json": ("5", "must hold columns"),
    "null.json": ("null", "must hold columns"),
    "mixed.json": ("[{}, 1]", "must hold columns"),
    "cut.json": (json.dumps(GOOD)[:-5], "cannot be read"),
    "rows.json": ('[{"t": 0, "x": 0, "v": 0}, {"t": 1, "x": 1}]', "v[1] = None"),
    "twice.json": ('{"t": [0, 1], "t": [0, 2], "x": [0, 1], "v": [0, 1]}', "has 't' twice"),
    "nan.json": ('{"t": [0, NaN], "x": [0, 1], "v": [0, 1]}', "t[1] = nan"),
    "digits.json": ('{"t": [0, ' + "1" * 5000 + '], "x": [0, 1], "v": [0, 1]}', "thousands of digits"),
    "long.json": ('{"t": [0, ' + "1" * 400 + '], "x": [0, 1], "v": [0, 1]}', "t[1]"),
    "mapping.json": ('{"t": {"a": 1}, "x": [0, 1], "v": [0, 1]}', "t[0]"),
    "true.json": ('{"t": [true, false], "x": [0, 1], "v": [0, 1]}', "t[0] = True"),
    "surrogate.json": ('{"\\ud800": ["0"], "x": [0], "v": [0]}', "there are: \\ud800"),
    "empty.csv": ("", "is empty"),
    "header.csv": ("t,x,v\n", "at least 2"),
    "one.csv": ("t,x,v\n0,0,0\n", "at least 2"),
    "headless.csv": ("0,0,0,0\n1,1,1,1", "has no header and 4 columns; say which are meant, such as t=1,x=2,v=3"),
    "semicolons.csv": ("t;x;w\n0;0;0", "there are: t, x, w"),
    "twice.csv": ("t,x,v,v\n0,0,0,0\n1,1,1,1", "has 'v' twice"),
    "holes.csv": ("t,x,v\n0,,0\n1,1,1", "x[0] = ''"),
    "blank.csv": ("\nt,x,v\n\n0,0,0\n\n1,1\n", "row 6 has 2 entries"),
    "field.csv": ("t,x,v\n" + "1" * 200000 + ",0,0\n1,1,1", "must be finite"),
    "hex.csv": ("t,x,v\n0x10,0,0\n1,1,1", "'0x10'"),
    "underscore.csv": ("t,x,v\n0,0,0\n1_0,1,1", "'1_0'"),
    "infinite.csv": ("t,x,v\n0,0,inf\n1,1,1", "v[0] = inf"),
    "wide.csv": (",".join(f"c{i}" for i in range(5000)), "and 4988 more"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_files_of_text(name: str, tmp_path: Path) -> None:
    text, words = TEXTS[name]
    (tmp_path / name).write_text(text)
    with pytest.raises(ParameterError) as caught:
        crosscheck("fig9", tmp_path / name)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 300 + len(str(tmp_path))
    str(caught.value).encode()


def test_files_that_are_read_although_they_look_odd(tmp_path: Path) -> None:
    texts = {
        "bom.json": "\ufeff" + json.dumps(GOOD),
        "none.json": json.dumps(GOOD | {"events": None}),
        "bom.csv": "\ufefft,x,v\n" + ROWS,
        "crlf.csv": ("t,x,v\n" + ROWS).replace("\n", "\r\n"),
        "savetxt.csv": "# t,x,v\n" + ROWS,
        "spaces.csv": " t , x , v \n" + ROWS.replace(",", " , ") + "\n\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_bytes(text.encode())
        assert crosscheck("fig9", tmp_path / name).ok


@pytest.mark.parametrize("suffix", [".csv", ".json"])
def test_files_that_are_no_text(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"file{suffix}"
    path.write_text(json.dumps(GOOD), encoding="utf-16")
    one_line(lambda: crosscheck("fig9", path), "not text in UTF-8" if suffix == ".json" else "'t': is missing")


def test_npz_files(tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    objects = np.array([None])
    for arrays, words in (
        (GOOD | {"t": np.array([0, None])}, "not of Python objects"),
        (GOOD | {"events": np.array([(0.5, "stick")], object)}, "not of Python objects"),
        (GOOD | {"events": 5}, "events"),
        (GOOD | {"t": T + 0j}, "t[0]"),
        ({"t": T, "pos": X, "velo": V}, "there are: t, pos"),
    ):
        np.savez(path, **arrays)
        one_line(lambda: crosscheck("fig9", path), words)
    np.savez(path, **GOOD, other=objects)  # type: ignore[arg-type]
    assert crosscheck("fig9", path).ok
    np.savez(path, **GOOD, events=np.array([["0.5", "stick"]]))  # type: ignore[arg-type]
    assert [event.t for event in crosscheck("fig9", path).invented] == [0.5]
    content = path.read_bytes()
    for damaged in (b"", b"no zip", content[: len(content) // 2], b"\x80\x04]."):
        path.write_bytes(damaged)
        one_line(lambda: crosscheck("fig9", path), "is not an npz file")


@pytest.mark.slow
def test_more_events_than_can_be_meant() -> None:
    """Two samples and a million periods between them: an answer in seconds, not a search for hours."""
    result = crosscheck("fig9", [0.1324, 1e6], [4.5447, 1.0], [1.0, 1.0])
    assert not result.ok
    assert "later only steps are compared" in result.notes[0]


def test_texts_of_messages_are_cut_where_they_are_too_long() -> None:
    for length in (1, LONGEST_ITEM - 1, LONGEST_ITEM):
        assert short("a" * length) == "a" * length
    assert short("a" * (LONGEST_ITEM + 1)) == "a" * LONGEST_ITEM + "…"
    assert shown("a" * LONGEST_ITEM) == "a" * LONGEST_ITEM
