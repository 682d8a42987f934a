"""Files in every format, as their own libraries write them, and broken ones: one line each."""

from __future__ import annotations

import io
import pickle
import sys
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from solution_files import COLUMNS, WRITERS, T, V, X

from symosc import MissingExtraError, ParameterError
from symosc.crosschecks import files
from symosc.crosschecks.files import SUFFIXES, read_samples

BINARY = ("npz", "mat", "parquet", "feather", "h5", "nc")


@pytest.mark.parametrize("name", WRITERS)
def test_what_a_library_writes_is_read_to_the_last_digit(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    samples = read_samples(path)
    few = 1e-14 if name == "pandas.json" else 0.0  # it has 15 digits
    for column, right in (("t", T), ("x", X), ("v", V)):
        np.testing.assert_allclose(getattr(samples, column), right, rtol=few, atol=few)


def test_every_suffix_has_a_file_in_this_test() -> None:
    tested = {Path(name.removesuffix(".gz").removesuffix(".bz2").removesuffix(".xz")).suffix for name in WRITERS}
    alike = {".out": ".dat", ".asc": ".dat", ".pq": ".parquet", ".arrow": ".feather", ".hdf": ".h5"}
    assert {alike.get(suffix, suffix) for suffix in SUFFIXES} == tested


@pytest.mark.parametrize("name", [name for name in WRITERS if name != "utf16.csv"])
def test_standard_input_is_known_by_its_content(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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


@pytest.mark.parametrize("name", [name for name in WRITERS if name.endswith(BINARY) or ".csv." in name])
def test_a_file_that_is_cut_off_or_damaged_is_one_line(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    WRITERS[name](path)
    content, rng = path.read_bytes(), np.random.default_rng(1)
    for part in (0, 1, 7, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:part])
        if part == len(content) - 1 and name.endswith(("mat", "nc", "h5", "npz")):
            continue  # the last byte need not be read
        one_line(path)
    for _ in range(0 if name.endswith("mat") else 20):  # random bytes; scipy itself crashes for some of those
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
    for content in (b"", b"\n\n", b"\0" * 5000, rng.bytes(5000), pickle.dumps(COLUMNS), b"[" * 200_000, b"t,x,v\n" * 3):
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
    one_line(tmp_path / "trap.npy", "not an npz file")
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
    one_line(tmp_path / "other.parquet", "column = 'v': is missing", "there are: t, x, w")
    (tmp_path / "none.parquet").write_bytes(b"PAR1" * 9)
    with pytest.raises(ParameterError, match=r"is not a parquet file, or it is damaged: \w.*\w"):
        read_samples(tmp_path / "none.parquet")


def test_a_library_that_is_missing_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for suffix, package in ((".parquet", "pyarrow"), (".feather", "pyarrow"), (".h5", "h5py")):
        (tmp_path / f"run{suffix}").write_bytes(b"anything")

        def none_of(name: str, package: str = package) -> Any:
            assert name.partition(".")[0] == package
            raise ImportError(name)

        monkeypatch.setattr(files, "import_module", none_of)
        with pytest.raises(MissingExtraError, match=r"file needs an optional package: pip install 'symosc\[tables\]'"):
            read_samples(tmp_path / f"run{suffix}")
