"""What Octave's `save` writes, as text (its default, under any name) and as HDF5; see `octave/save_all.m`."""

from __future__ import annotations

import gzip
import io
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from symosc import ParameterError
from symosc.crosschecks.files import read_samples

SAVED = Path(__file__).parent / "octave"
T = np.arange(12) / 8  # all numbers are exact, in single precision too
FILES = ("samples.txt", "samples.h5", "struct.mat", "struct.h5", "matrix.h5", "range", "range.h5")


def assert_right(source: str | Path) -> None:
    samples = read_samples(source)
    np.testing.assert_array_equal([samples.t, samples.x, samples.v], [T, T**2, 2 * T])


@pytest.mark.parametrize("name", FILES)
def test_what_octave_saves_is_read(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Columns beside values of every other kind, a struct, a matrix, a range; of standard input too."""
    assert_right(SAVED / name)
    if name != "struct.mat":
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(buffer=io.BytesIO((SAVED / name).read_bytes())))
        assert_right("-")


def test_a_range_ends_where_octave_ends_it(tmp_path: Path) -> None:
    """3 * 0.1 is beyond 0.3 in doubles, and Octave ends at 0.3. A range may go down, or end before its limit."""
    for text, values in (
        ("0 0.3 0.1", [0, 0.1, 0.2, 0.3]),
        ("0 0.35 0.1", [0, 0.1, 0.2, 0.1 * 3]),
        ("1 0 -0.5", [1, 0.5, 0]),
    ):
        head = "# Created by Octave 7.3.0\n# name: x\n# type: range\n# base, limit, increment\n"
        times = f"# name: t\n# type: matrix\n# rows: 1\n# columns: {len(values)}\n"
        (tmp_path / "run.txt").write_text(f"{head}{text}\n\n\n{times} {' '.join(map(str, range(len(values))))}\n")
        assert read_samples(tmp_path / "run.txt").x.tolist() == values


@pytest.mark.parametrize("name", ["packed.txt.gz", "packed.dat.gz", "packed.gz", "packed.mat.gz"])
def test_a_packed_text_of_octave_is_read(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(gzip.compress((SAVED / "samples.txt").read_bytes()))
    assert_right(tmp_path / name)


@pytest.mark.parametrize("name", ["range", pytest.param("samples.txt", marks=pytest.mark.slow)])
def test_a_damaged_text_of_octave_is_one_line(name: str, tmp_path: Path) -> None:
    """Each line left out, cut off there, or with other numbers: read, or refused in one line."""
    lines, path, refused = (SAVED / name).read_text().splitlines(keepends=True), tmp_path / name, 0
    for i in range(1, len(lines)):
        bad = "".join(letter if letter.isalpha() else "9" for letter in lines[i].strip()) + "\n"
        for text in (lines[:i] + lines[i + 1 :], lines[:i], [*lines[:i], bad, *lines[i + 1 :]]):
            path.write_text("".join(text))
            said = what_is_said(path)
            assert "\n" not in said
            refused += bool(said)
    assert refused > len(lines)


def what_is_said(path: Path) -> str:
    try:
        read_samples(path)
    except ParameterError as error:
        return str(error)
    return ""
