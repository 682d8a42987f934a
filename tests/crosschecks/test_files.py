"""Files and objects that samples are read from."""

from __future__ import annotations

import bz2
import gzip
import random
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError
from symosc.crosschecks import files, text_tables
from symosc.crosschecks.files import read_samples


def test_what_cannot_be_read(tmp_path: Path) -> None:
    wrong = {
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
    for name, (text, words) in wrong.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(ParameterError, match=words):
            read_samples(tmp_path / name)
    with pytest.raises(ParameterError, match="cannot be read"):
        read_samples(tmp_path / "none.csv")


@pytest.mark.parametrize("piece", [b"\n", b",,\n", b"# a comment\n", b" ", b"\0"])
def test_a_small_file_that_unpacks_to_very_much_is_refused_soon(
    piece: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """300 MB of nothing in a .gz took 38 s: no more than a part of it is unpacked."""
    unpacked = 0

    class Counting(gzip.GzipFile):
        def read(self, size: int | None = -1) -> bytes:
            nonlocal unpacked
            data = super().read(size)
            unpacked += len(data)
            return data

    monkeypatch.setitem(files.PACKED, ".gz", Counting)
    monkeypatch.setattr(text_tables, "MOST_EMPTY_LINES", 50_000)
    path = tmp_path / "run.csv.gz"
    path.write_bytes(gzip.compress(b"t,x,v\n" + piece * (8_000_000 // len(piece)), compresslevel=1))
    with pytest.raises(ParameterError, match=r"lines without data|not text in lines"):
        read_samples(path)
    assert unpacked <= 2_000_000


@pytest.mark.parametrize("name", ["run.json", "run.csv", "run.npz", "run.h5"])
def test_no_more_is_unpacked_than_a_limit(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "MOST_BYTES", 100_000)
    (tmp_path / f"{name}.bz2").write_bytes(bz2.compress(b"0,1,2\n" * 100_000))
    with pytest.raises(ParameterError, match=r"is larger than 1e\+05 bytes"):
        read_samples(tmp_path / f"{name}.bz2")


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
