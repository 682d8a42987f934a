"""Files and objects that samples are read from."""

from __future__ import annotations

import csv
import gzip
import json
import lzma
import random
import zlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError
from symosc.crosschecks import files
from symosc.crosschecks.compare import crosscheck
from symosc.crosschecks.files import read_samples


def test_what_is_read(tmp_path: Path, grid: Any) -> None:
    t, x, v = grid["fig9"]
    columns = {"t": t.tolist(), "x": x.tolist(), "v": v.tolist()}
    rows = "\n".join(",".join(map(repr, row)) for row in zip(*columns.values(), strict=True))
    (tmp_path / "run.csv").write_text(f"t,x,v\n{rows}\n")
    np.savez(tmp_path / "run.npz", t=t, x=x, v=v)
    (tmp_path / "run.json").write_text(json.dumps(columns))
    (tmp_path / "rows.json").write_text(json.dumps([{"t": a, "x": b, "v": c} for a, b, c in zip(t, x, v, strict=True)]))
    result = SimpleNamespace(t=t, y=np.array([x, v]))
    sources = [*sorted(tmp_path.iterdir()), str(tmp_path / "run.csv"), columns, result]
    assert len(sources) == 7
    for source in sources:
        samples = read_samples(source)
        np.testing.assert_array_equal([samples.t, samples.x, samples.v], [t, x, v])
    samples = read_samples({"time": t, "x": x, "w": v}, {"t": "time", "v": "w"})
    np.testing.assert_array_equal(samples.v, v)
    assert crosscheck("fig9", result).ok


def test_what_cannot_be_read(tmp_path: Path) -> None:
    files = {
        "two.csv": ("t,x,w\n0,1,2\n1,2,3\n", "column = 'v': is missing"),
        "short.csv": ("t,x,v\n0,1,2\n1,2\n", "row 3 has 2 entries"),
        "text.csv": ("t,x,v\n0,1,2\n1,2,three\n", "'three': is not a number"),
        "empty.csv": ("", "is empty"),
        "bad.json": ("{", "cannot be read"),
        "list.json": ("[1, 2]", "must hold columns"),
        "bad.npz": ("no zip", "is not an npz file"),
        "run.doc": ("", "must end in"),
        "run.txt": ("", "is empty"),
    }
    for name, (text, words) in files.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(ParameterError, match=words):
            read_samples(tmp_path / name)
    with pytest.raises(ParameterError, match="cannot be read"):
        read_samples(tmp_path / "none.csv")


def test_columns_of_a_table_are_found_however_it_is_laid_out(tmp_path: Path) -> None:
    """Spaces behind commas, quotes, a byte order mark, empty lines, a comment sign, more columns in any order."""
    rng = random.Random(1)
    for number in range(60):
        rows = rng.randint(2, 9)
        names = ["t", "x", "v", *rng.sample(["a", "b b", "c,d", "events in"], rng.randint(0, 3))]
        columns = {name: [round(rng.uniform(-9, 9), 6) for _ in range(rows)] for name in names}
        columns["t"] = sorted(columns["t"])
        rng.shuffle(names)
        behind, quoted = rng.choice(["", " ", "   "]), rng.random() < 0.5

        def cell(value: Any, behind: str = behind, quoted: bool = quoted) -> str:
            return behind + (f'"{value}"' if quoted or "," in str(value) else str(value))

        table = [names, *zip(*(columns[name] for name in names), strict=True)]
        lines = [",".join(map(cell, row)) for row in table]
        for _ in range(rng.randint(0, 3)):
            lines.insert(rng.randint(1, len(lines)), rng.choice(["", "  ", ",,"]))
        lines[0] = rng.choice(["", "# ", "#"]) * (not quoted and "," not in names[0]) + lines[0].lstrip()
        text = rng.choice(["\n", "\r\n"]).join(lines) + rng.choice(["", "\n"])
        path = tmp_path / f"{number}.csv"
        path.write_bytes(text.encode(rng.choice(["utf-8", "utf-8-sig"])))
        samples = read_samples(path)
        assert [samples.t.tolist(), samples.x.tolist(), samples.v.tolist()] == [
            columns["t"],
            columns["x"],
            columns["v"],
        ]
        assert samples.events is None


@pytest.mark.parametrize("suffix", [".csv", ".json", ".npz", ".CSV", ".Json"])
def test_a_column_that_is_there_twice_is_refused_only_if_it_is_read(tmp_path: Path, suffix: str) -> None:
    for twice, wanted in (("x", True), ("other", False)):
        path = tmp_path / f"{twice}{suffix}"
        if suffix.lower() == ".csv":
            path.write_text(f"t,x,v,{twice},other\n0,1,2,3,4\n1,2,3,4,5\n")
        elif suffix.lower() == ".json":
            path.write_text(f'{{"t": [0, 1], "x": [1, 2], "v": [2, 3], "{twice}": [3, 4], "other": [4, 5]}}')
        else:
            ragged = np.array([[1], [1, 2]], dtype=object)
            np.savez(path, **{"t": [0, 1], "x": [1, 2], "v": [2, 3], twice: ragged})
        if wanted:
            with pytest.raises(ParameterError, match="twice" if suffix != ".npz" else "x must be an array of numbers"):
                read_samples(path)
        else:
            assert read_samples(path).v.tolist() == [2, 3]


def test_names_of_columns_are_checked() -> None:
    data = {"t": [0, 1], "p": [1, 2], "v": [2, 3]}
    assert read_samples(data, {"x": "p"}).x.tolist() == [1, 2]
    for columns, words in (
        ("x", "must be a mapping"),
        ({"y": "p"}, "only t, x and v are read"),
        ({"x": 1}, "the name of the column that holds x"),
        ({"x": "v"}, "must be three columns"),
        ({"x": "q"}, "is missing in dict; there are: t, p, v"),
    ):
        with pytest.raises(ParameterError, match=words):
            read_samples(data, columns)  # type: ignore[arg-type]
    many = {f"column{i}": [0] for i in range(30)}
    with pytest.raises(ParameterError, match=r"there are: column0, .*, column11, and 18 more$"):
        read_samples(many)
    with pytest.raises(ParameterError, match=r"there are: column0, .*, column11$"):
        read_samples(dict(list(many.items())[:12]))


def test_results_of_solvers_have_two_rows() -> None:
    t = np.linspace(0, 1, 5)
    assert read_samples(SimpleNamespace(t=t, y=np.array([t, 2 * t]))).v.tolist() == (2 * t).tolist()
    for y in (t, np.array([t, t, t]), np.array([[t, t], [t, t]]), [[0], [1, 2]]):
        with pytest.raises(ParameterError, match="must have two rows"):
            read_samples(SimpleNamespace(t=t, y=y))


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (EOFError(), "it is damaged, or cut off"), (zlib.error("x"), "it is damaged, or cut off"),
        (gzip.BadGzipFile("x"), "it is damaged, or cut off"), (lzma.LZMAError("x"), "it is damaged, or cut off"),
        (OSError(5, "no such thing"), "no such thing"), (OSError("odd"), "odd"),
        (UnicodeDecodeError("utf-8", b"x", 0, 1, "bad"), "it is not text in UTF-8"),
        (RecursionError(), "its brackets are nested too deeply"), (MemoryError(), "it does not fit into memory"),
        (ValueError("no number"), "no number"), (csv.Error("no line"), "no line"),
    ],
)  # fmt: skip
def test_whatever_a_reader_raises_is_one_line(
    error: Exception, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = said_of_a_reader_that_raises(error, tmp_path, monkeypatch)
    assert str(said) == f"file = 'some.csv': cannot be read: {words}"


def test_a_readers_own_word_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = ParameterError("x", 3, "is odd")
    assert said_of_a_reader_that_raises(own, tmp_path, monkeypatch) is own


def said_of_a_reader_that_raises(error: Exception, folder: Path, monkeypatch: pytest.MonkeyPatch) -> ParameterError:
    def read(*_: object) -> None:
        raise error

    (folder / "some.csv").write_text("t,x,v")
    monkeypatch.setattr(files, "_reader", lambda *_: read)
    with pytest.raises(ParameterError) as caught:
        files._read_file(folder / "some.csv", {}, "some.csv")
    return caught.value
