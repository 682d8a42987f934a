"""Files of every format.

Those of their libraries, damaged ones, any layout of text, and the page about them.
"""

from __future__ import annotations

import bz2
import gzip
import io
import os
import pickle
import random
import re
import shlex
import struct
import subprocess
import sys
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat
from solution_files import COLUMNS, WRITERS, T, V, X, read_samples

from symosc import ParameterError, simulate
from symosc.crosschecks.reading import files, formats
from symosc.crosschecks.reading import text as text_tables
from symosc.crosschecks.reading.files import PACKED, SUFFIXES
from symosc.crosschecks.reading.formats import has_wrong_tags
from symosc.crosschecks.reading.solutions import read_solutions
from symosc.crosschecks.reading.text import read_text

# -- formats ---------------------------------------------------------------------------------------


BINARY = ("npz", "mat", "parquet", "feather", "h5", "nc")


@pytest.mark.parametrize("name", WRITERS)
def test_what_a_library_writes_is_read_to_the_last_digit(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    samples = read_samples(path)
    # it has 15 digits
    if name == "pandas.json":
        few = 1e-14
    else:
        few = 0.0
    for column, right in (("t", T), ("x", X), ("v", V)):
        np.testing.assert_allclose(getattr(samples, column), right, rtol=few, atol=few)


@pytest.mark.parametrize("name", list(WRITERS))
def test_standard_input_is_known_by_its_content(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO(path.read_bytes())))
    np.testing.assert_allclose(read_samples("-").x, X, rtol=1e-14)


def one_line(path: Path, *words: str) -> None:
    with pytest.raises(ParameterError) as caught:
        read_samples(path)
    text = str(caught.value)
    assert "\n" not in text
    assert len(text) < 300 + len(str(path))
    assert all(word in text for word in words), text


@pytest.mark.parametrize(
    "name", [name for name in WRITERS if name.endswith(BINARY) or ".csv." in name]
)
def test_a_file_that_is_cut_off_or_damaged_is_one_line(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    content = path.read_bytes()
    rng = np.random.default_rng(1)
    for part in (0, 1, 7, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:part])
        if part == len(content) - 1 and name.endswith(("mat", "nc", "h5", "npz")):
            continue  # the last byte need not be read
        one_line(path)
    for _ in range(
        0 if name.endswith("mat") else 20
    ):  # random bytes; scipy itself crashes for some of those
        damaged = bytearray(content)
        for place in rng.integers(0, len(content), 20).tolist():
            damaged[place] = int(rng.integers(0, 256))
        path.write_bytes(damaged)
        with suppress(ParameterError):
            read_samples(path)


@pytest.mark.parametrize("suffix", sorted(SUFFIXES))
def test_rubbish_is_one_line_under_any_name(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"file{suffix}"
    rng = np.random.default_rng(2)
    for content in (
        b"",
        b"\n\n",
        b"\0" * 5000,
        rng.bytes(5000),
        pickle.dumps(COLUMNS),
        b"[" * 200_000,
        b"t,x,v\n" * 3,
    ):
        path.write_bytes(content)
        one_line(path)


def test_objects_of_python_are_not_loaded(tmp_path: Path) -> None:
    """A pickle could run anything."""

    class Trap:
        def __reduce__(self) -> Any:
            return (tmp_path / "sprung").touch, ()

    np.savez(tmp_path / "trap.npz", t=T, x=np.array([Trap()] * 60), v=V)
    one_line(tmp_path / "trap.npz", "not of Python objects")
    np.save(tmp_path / "trap.npy", np.array([Trap()] * 60))
    one_line(tmp_path / "trap.npy", "not a readable npz file")
    assert not (tmp_path / "sprung").exists()


def test_wrong_columns_and_no_numbers_are_named(tmp_path: Path) -> None:
    import pandas

    for values, words in (
        ({"x": np.where(T > 1, np.nan, X)}, "x[18] = nan: must be finite"),
        ({"x": ["text"] * 60}, "x[0] = 'text': is not a number"),
        ({"x": X + 0j}, "x[0]"),
    ):
        frame = pandas.DataFrame({**COLUMNS, **values})
        for name, write in (("parquet", frame.to_parquet), ("feather", frame.to_feather)):
            if "0]" in words and np.iscomplexobj(values["x"]):
                continue  # these have no complex numbers
            write(tmp_path / f"run.{name}")
            one_line(tmp_path / f"run.{name}", words)
        np.savez(tmp_path / "run.npz", **{**COLUMNS, **values})
        one_line(tmp_path / "run.npz", words)
    pandas.DataFrame({"t": T, "x": X, "w": V}).to_parquet(tmp_path / "other.parquet")
    one_line(
        tmp_path / "other.parquet",
        "column = 'v': not found in",
        "its columns are t, x, w;",
        "--columns v=w",
    )
    (tmp_path / "none.parquet").write_bytes(b"PAR1" * 9)
    with pytest.raises(
        ParameterError, match=r"is not a readable parquet file, or is damaged: \w.*\w"
    ):
        read_samples(tmp_path / "none.parquet")


def test_the_kind_of_events_is_proposed_for_no_other_column(tmp_path: Path) -> None:
    (tmp_path / "events.csv").write_text("t,kind\n0.1,stick\n", encoding="utf-8")
    with pytest.raises(ParameterError, match=r"are t, kind; say which is which by name or number$"):
        read_samples(tmp_path / "events.csv")


def test_what_is_in_a_struct_is_named_after_it(tmp_path: Path) -> None:
    variables = {"out": {"run": COLUMNS, "limits": {"x": 5.0}}, "step": 0.1}
    savemat(tmp_path / "run.mat", variables)
    for asked in ({}, {name: f"out.run.{name}" for name in "txv"}):
        np.testing.assert_array_equal(read_samples(tmp_path / "run.mat", asked).v, V)
    savemat(tmp_path / "run.mat", {"out": {"one": COLUMNS, "other": COLUMNS}})
    words = r"its columns are one\.t, .*other\.v; .* --columns t=one\.t,x=one\.x,v=one\.v"
    with pytest.raises(ParameterError, match=words):
        read_samples(tmp_path / "run.mat")
    asked = {name: f"other.{name}" for name in "txv"}
    np.testing.assert_array_equal(read_samples(tmp_path / "run.mat", asked).v, V)


# -- files -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("piece", [b"\n", b"\0"])
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
def test_no_more_is_unpacked_than_a_limit(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(formats, "MOST_BYTES", 100_000)
    (tmp_path / f"{name}.bz2").write_bytes(bz2.compress(b"0,1,2\n" * 100_000))
    with pytest.raises(ParameterError, match=r"is larger than 1e\+05 bytes"):
        read_samples(tmp_path / f"{name}.bz2")


def test_columns_of_a_table_are_found_however_it_is_laid_out(tmp_path: Path) -> None:
    """Spaces behind commas, quotes, a byte order mark, empty lines, a comment sign, more columns in
    any order.
    """
    rng = random.Random(1)
    for number in range(60):
        rows = rng.randint(2, 9)
        names = ["t", "x", "v", *rng.sample(["a", "b b", "c,d", "events in"], rng.randint(0, 3))]
        columns = {name: [round(rng.uniform(-9, 9), 6) for _ in range(rows)] for name in names}
        columns["t"] = sorted(columns["t"])
        rng.shuffle(names)
        behind = rng.choice(["", " ", "   "])
        quoted = rng.random() < 0.5

        def cell(value: Any, behind: str = behind, quoted: bool = quoted) -> str:
            return behind + (f'"{value}"' if quoted or "," in str(value) else str(value))

        table = [names, *zip(*(columns[name] for name in names), strict=True)]
        lines = [",".join(map(cell, row)) for row in table]
        for _ in range(rng.randint(0, 3)):
            lines.insert(rng.randint(1, len(lines)), rng.choice(["", "  ", ",,"]))
        lines[0] = (
            rng.choice(["", "# ", "#"]) * (not quoted and "," not in names[0]) + lines[0].lstrip()
        )
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


# -- text tables -----------------------------------------------------------------------------------


def read(content: str, **asked: str | None) -> dict[str, np.ndarray]:
    file = io.BufferedReader(io.BytesIO(content.encode()))  # type: ignore[arg-type]
    return read_text(file, "here").chosen(asked, "here")


NOTES = {
    "t,x,v": [],
    "t,x,v,a": ["names without a column are left out: a"],
    "0,1,2": ["the first line is taken for names, not for a sample: 0, 1, 2"],
    "t,y,dy": ["x is the column y; say so by --columns x=... if it is another"],
    ",x,v": ["t is the first column, which has no name"],
}


@pytest.mark.parametrize("header", NOTES)
def test_a_note_says_what_was_not_sure(header: str, tmp_path: Path) -> None:
    rows = [f"{t},{x},{v}" for t, x, v in zip(T.tolist(), X.tolist(), V.tolist(), strict=True)]
    path = tmp_path / "mine.csv"
    path.write_text("\n".join([header, *rows]))
    (samples,) = read_solutions(path)
    assert list(samples.notes) == NOTES[header]
    # What the user says is sure.
    (samples,) = read_solutions(path, {"t": "1", "x": "2", "v": "3"})
    assert not [note for note in samples.notes if note.startswith(("x is", "t is"))]


def test_numbers_are_read_however_they_are_written() -> None:
    """Any delimiter, decimal sign, order and name of columns, header or none, comments, a few lines
    at a time.
    """
    rng = random.Random(3)
    for _ in range(150):
        count = rng.randint(2, 9)
        sign = rng.choice([",", ";", "\t", " ", "  "])
        columns = {name: [rng.choice([rng.uniform(-9, 9), rng.uniform(-9, 9) * 1e-30, float(rng.randint(0, 9))])
                          for _ in range(count)] for name in "txv"}  # fmt: skip
        names = {
            "t": ["t", "T", "time", "Time"],
            "x": ["x", "X", "position", "POS"],
            "v": ["v", "vel", "Velocity", "dx/dt"],
        }
        headless = rng.random() < 0.3
        if headless:
            order = ["t", "x", "v"]
        else:
            order = rng.sample("txv", 3)
        comma = sign != "," and rng.random() < 0.5
        if headless:
            lines = []
        else:
            lines = [sign.join(rng.choice(names[name]) for name in order)]
        for row in zip(*(columns[name] for name in order), strict=True):
            cells = [repr(value) for value in row]
            lines.append(
                sign.join(cell.replace(".", ",") for cell in cells) if comma else sign.join(cells)
            )
        for _ in range(rng.randint(0, 4)):
            lines.insert(
                rng.randint(0, len(lines)), rng.choice(["", "# why", "% 1 2", "// t x", " "])
            )
        columns_read = read(rng.choice(["\n", "\r\n", "\r"]).join(lines) + rng.choice(["", "\n"]))
        assert {name: column.tolist() for name, column in columns_read.items()} == columns, lines


# -- octave ----------------------------------------------------------------------------------------


SAVED = Path(__file__).parent / "octave"
OCTAVE_T = np.arange(12) / 8  # all numbers are exact, in single precision too
FILES = ("samples.txt", "samples.h5", "struct.mat", "struct.h5", "matrix.h5", "range", "range.h5")


def assert_right(source: str | Path) -> None:
    samples = read_samples(source)
    np.testing.assert_array_equal(
        [samples.t, samples.x, samples.v], [OCTAVE_T, OCTAVE_T**2, 2 * OCTAVE_T]
    )


@pytest.mark.parametrize("name", FILES)
def test_what_octave_saves_is_read(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Columns beside values of every other kind, a struct, a matrix, a range.

    Of standard input too.
    """
    assert_right(SAVED / name)
    if name != "struct.mat":
        monkeypatch.setattr(
            sys, "stdin", SimpleNamespace(buffer=io.BytesIO((SAVED / name).read_bytes()))
        )
        assert_right("-")


def test_a_range_ends_where_octave_ends_it(tmp_path: Path) -> None:
    """3 * 0.1 is beyond 0.3 in doubles, and Octave ends at 0.3.

    A range may go down, or end before its limit.
    """
    for text, values in (
        ("0 0.3 0.1", [0, 0.1, 0.2, 0.3]),
        ("0 0.35 0.1", [0, 0.1, 0.2, 0.1 * 3]),
        ("1 0 -0.5", [1, 0.5, 0]),
    ):
        head = "# Created by Octave 7.3.0\n# name: x\n# type: range\n# base, limit, increment\n"
        times = f"# name: t\n# type: matrix\n# rows: 1\n# columns: {len(values)}\n"
        (tmp_path / "run.txt").write_text(
            f"{head}{text}\n\n\n{times} {' '.join(map(str, range(len(values))))}\n"
        )
        assert read_samples(tmp_path / "run.txt").x.tolist() == values


def test_a_damaged_text_of_octave_is_one_line(tmp_path: Path) -> None:
    """Each line left out, cut off there, or with other numbers: read, or refused in one line."""
    lines = (SAVED / "range").read_text().splitlines(keepends=True)
    path = tmp_path / "range"
    said = list[str]()
    for i in range(1, len(lines)):
        bad = "".join(letter if letter.isalpha() else "9" for letter in lines[i].strip()) + "\n"
        for text in (lines[:i] + lines[i + 1 :], lines[:i], [*lines[:i], bad, *lines[i + 1 :]]):
            path.write_text("".join(text))
            try:
                read_samples(path)
            except ParameterError as error:
                said.append(str(error))
    assert len(said) > len(lines)
    assert not any("\n" in text for text in said)


# -- matlab tags -----------------------------------------------------------------------------------


def written(variables: dict[str, Any], packed: bool = False) -> bytes:
    file = BytesIO()
    savemat(file, variables, do_compression=packed)
    return file.getvalue()


@pytest.mark.parametrize(
    ("at", "value"), [(176, 0xFF), (176, 0), (145, 0x08), (133, 0xFF), (180, 0xFF), (128, 99)]
)
def test_a_damaged_one_is_refused(at: int, value: int, tmp_path: Path) -> None:
    """The kind of the numbers, a second (imaginary) part that is not there, sizes beyond the
    end.
    """
    data = bytearray(written(COLUMNS))
    assert struct.unpack_from("<I", data, 176) == (9,)  # numbers in double precision
    data[at] = value
    assert has_wrong_tags(bytes(data))
    (tmp_path / "run.mat").write_bytes(data)
    with pytest.raises(ParameterError, match="is not a readable MATLAB file, or is damaged"):
        read_samples(tmp_path / "run.mat")


# -- page ------------------------------------------------------------------------------------------


PAGE = (Path(__file__).parents[2] / "docs" / "checking.md").read_text(encoding="utf-8")
SOLVER, EXAMPLE, *_ = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
COMMANDS = re.findall(r"^\$ (.*)$", PAGE, re.MULTILINE)
# Those that find the solution wrong: its method steps over belts.
WRONG = ("--solver",)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    import pandas

    folder = tmp_path_factory.mktemp("checking")
    t = np.linspace(0.1324, 10, 500)
    x, v = simulate("fig9")(t)
    frame = pandas.DataFrame({"t": t, "x": x, "v": v})
    frame.to_csv(folder / "run.csv", index=False)
    frame.to_parquet(folder / "other.parquet")
    frame[["t", "x"]].to_csv(folder / "positions.csv", index=False)
    np.savetxt(folder / "run.txt", np.column_stack([t, x, 0 * t, v]), fmt="%.17g")
    (folder / "mysolver.py").write_text(SOLVER)
    program = folder / "bin" / "symosc"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m symosc "$@"\n')
    program.chmod(0o755)
    return folder


@pytest.mark.full(4)
@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_the_commands_run(command: str, folder: Path) -> None:
    environment = {**os.environ, "PATH": os.pathsep.join([str(folder / "bin"), os.environ["PATH"]])}
    result = subprocess.run(
        command, shell=True, cwd=folder, env=environment, capture_output=True, text=True
    )
    assert (result.returncode, result.stderr) == (
        int(any(word in command for word in WRONG)),
        "",
    ), result.stdout
    assert result.stdout.startswith(("ok", "{", "FAILED"))


@pytest.mark.slow
def test_the_example_prints_what_it_says(tmp_path: Path) -> None:
    expected, *_ = re.findall(r"^```text\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    result = subprocess.run(
        [sys.executable, "-c", EXAMPLE], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert (result.stderr, result.stdout) == ("", expected)


def test_every_format_is_named() -> None:
    alike = {".out", ".asc", ".pq", ".arrow", ".hdf"}
    for suffix in {*SUFFIXES, *PACKED} - alike:
        assert f"`{suffix}`" in PAGE, suffix


READ_IN_A_PROCESS = """
import sys
from pathlib import Path
from symosc.crosschecks.reading.solutions import read_solutions
from symosc.base.errors import ParameterError
for path in sys.argv[1:]:
    try:
        print("read", len(read_solutions(path)[0].t))
    except ParameterError as error:
        print(error)
"""


@pytest.mark.slow
def test_an_hdf5_file_whose_values_are_elsewhere_is_refused(tmp_path: Path) -> None:
    """HDF5 crashed at the one, and showed the bytes of any file for the other."""
    h5py = pytest.importorskip("h5py")
    t = np.linspace(0, 1, 20)
    with h5py.File(tmp_path / "source.h5", "w") as file:
        for name in "txv":
            file[name] = t
    with h5py.File(tmp_path / "virtual.h5", "w") as file:
        for name in "txv":
            layout = h5py.VirtualLayout(shape=t.shape, dtype="f8")
            layout[:] = h5py.VirtualSource("source.h5", name, shape=t.shape)
            file.create_virtual_dataset(name, layout)
    (tmp_path / "bytes").write_bytes(b"secret" * 100)
    with h5py.File(tmp_path / "external.h5", "w") as file:
        for name in "txv":
            outside = [(str(tmp_path / "bytes"), 0, 8 * len(t))]
            file.create_dataset(name, shape=t.shape, dtype="f8", external=outside)
    with h5py.File(tmp_path / "linked.h5", "w") as file:
        for name in "txv":
            file[name] = h5py.ExternalLink("source.h5", name)
    names = ["source", "virtual", "external", "linked"]
    for name in names:
        packed = gzip.compress((tmp_path / f"{name}.h5").read_bytes())
        (tmp_path / f"{name}.h5.gz").write_bytes(packed)
    paths = [f"{name}.h5{packed}" for packed in ("", ".gz") for name in names]
    done = subprocess.run(
        [sys.executable, "-c", READ_IN_A_PROCESS, *paths],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    said = done.stdout.splitlines()
    for first in (0, 4):
        assert said[first] == "read 20"
        assert "/t is a virtual dataset: its values are in other files" in said[first + 1]
        assert "/t is kept in external raw storage" in said[first + 2]
        assert "'t': not found" in said[first + 3]
    assert "secret" not in done.stdout
