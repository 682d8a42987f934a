"""Files that hold arrays, each read by the library for it: npz, json, mat, parquet, feather and HDF5."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from typing import IO, Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.columns import NO_COLUMNS, USUAL_NAMES, plain
from symosc.crosschecks.matlab_tags import has_wrong_tags
from symosc.crosschecks.samples import short
from symosc.errors import MissingExtraError, ParameterError

EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'
#: The extra that brings the libraries.
EXTRA = "tables"
# Groups of an HDF5 file that are looked into, one inside the other.
DEEPEST_GROUP = 8
# An HDF5 file begins so; one of MATLAB behind a block of text.
HDF5_SIGN, BLOCK_OF_MATLAB = b"\x89HDF\r\n\x1a\n", 512

#: Columns that are asked for by name.
Asked = Mapping[str, str | None]


def library(name: str, what: str) -> Any:
    """Return a package that reads `what`; MissingExtraError if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(what, EXTRA) from None


def wanted(name: str, asked: Asked) -> bool:
    """Tell whether a column may be one that is read; others need not be numbers."""
    given = {column.lower() for column in asked.values() if column}
    usual = plain(name) in set().union(*USUAL_NAMES.values())
    return usual or name.lower() in given or name in NO_COLUMNS or name.lower() in BOTH_IN_ONE


#: Names of arrays that hold x and v together.
BOTH_IN_ONE = ("y", "ys", "u", "z", "state", "states", "sol", "solution", "data")


def refuse_twice(where: str, names: Iterable[str], asked: Asked) -> None:
    """Raise ParameterError if a column that is read is there twice."""
    seen: set[str] = set()
    for name in names:
        if name in seen and wanted(name, asked):
            raise ParameterError("file", where, f"has {short(name)!r} twice")
        seen.add(name)


def read_npz(file: IO[bytes], asked: Asked, where: str) -> Any:
    """Return the arrays of an npz file, or the array of an npy file."""
    try:
        data = np.load(file)
        if isinstance(data, np.ndarray):
            return data
        with data:
            return {name: _plain(where, data, name) if wanted(name, asked) else None for name in data.files}
    except (ParameterError, MemoryError):
        raise
    except Exception:  # zipfile, zlib and numpy raise a dozen kinds, all for the same reason
        raise ParameterError("file", where, "is not an npz file, or it is damaged") from None


def _plain(where: str, data: Any, name: str) -> Any:
    try:
        return data[name]
    except ValueError:
        what = f"{name} must be an array of numbers (events, id: of text), not of Python objects"
        raise ParameterError("file", where, what) from None


def read_json(file: IO[bytes], asked: Asked, where: str) -> Any:
    """Return what a JSON file holds: columns, or a list."""
    text = file.read().decode("utf-8-sig")
    if not text.strip():
        raise ParameterError("file", where, f"is empty; it must hold columns, such as {EXAMPLE}")

    def table(pairs: list[tuple[str, Any]]) -> Record:
        refuse_twice(where, (name for name, _ in pairs), asked)
        return dict(pairs)

    try:
        data = json.loads(text, object_pairs_hook=table)
    except (ParameterError, json.JSONDecodeError):
        raise
    except ValueError:  # Python's own limit
        raise ParameterError("file", where, "cannot be read: a number in it has thousands of digits") from None
    kinds = {type(each) for each in data} if isinstance(data, list) else {dict}
    if not (isinstance(data, (dict, list)) and kinds in ({dict}, {list})):
        raise ParameterError("file", where, f"must hold columns, such as {EXAMPLE}")
    return data


def read_mat(file: IO[bytes], asked: Asked, where: str) -> Any:
    """Return the variables of a MATLAB file; version 7.3 is HDF5."""
    begins = file.read(BLOCK_OF_MATLAB + len(HDF5_SIGN))
    file.seek(0)
    if begins.startswith(HDF5_SIGN) or begins.endswith(HDF5_SIGN):
        return read_hdf5(file, asked, where)
    if has_wrong_tags(file.read()):
        raise ParameterError("file", where, "is not a MATLAB file, or it is damaged")
    file.seek(0)
    try:
        from scipy.io import loadmat

        data = loadmat(file, squeeze_me=True, struct_as_record=True)
    except MemoryError:
        raise
    except Exception:  # scipy raises what its parser meets
        raise ParameterError("file", where, "is not a MATLAB file, or it is damaged") from None
    found = {name: value for name, value in data.items() if not name.startswith("__")}
    structs = [value for value in found.values() if isinstance(value, np.ndarray) and value.dtype.names]
    if len(structs) == 1 and len(found) == 1:  # a struct with the columns as its fields
        found = {name: structs[0][name][()] for name in structs[0].dtype.names}
    return found


def read_parquet(file: IO[bytes], asked: Asked, where: str) -> Any:
    """Return the table of a parquet file."""
    parquet = library("pyarrow.parquet", "a parquet file")
    return _arrow(where, "parquet", lambda: _some(parquet.ParquetFile(file), asked))


def _some(file: Any, asked: Asked) -> Any:
    names = file.schema_arrow.names
    table = file.read(columns=[name for name in names if wanted(name, asked)])
    return {name: table.column(name).to_numpy() if name in table.column_names else None for name in names}


def read_feather(file: IO[bytes], asked: Asked, where: str) -> Any:
    """Return the table of a feather (Arrow) file."""
    feather = library("pyarrow.feather", "a feather file")
    return _arrow(where, "feather", lambda: feather.read_table(file))


def _arrow(where: str, kind: str, read: Callable[[], Any]) -> Any:
    try:
        return read()
    except MemoryError:
        raise
    except Exception as error:  # pyarrow raises its own kinds, and OSError with many lines
        reason = short(str(error).partition("\n")[0])
        raise ParameterError("file", where, f"is not a {kind} file, or it is damaged: {reason}") from None


def read_hdf5(file: IO[bytes], asked: Asked, where: str) -> Any:
    """Return the datasets of an HDF5 (or netCDF 4) file: those of the first group that has some."""
    h5py = library("h5py", "an HDF5 file")
    try:
        with h5py.File(file, "r") as data:
            group = _first_group(h5py, data)
            found = {name: each for name, each in group.items() if isinstance(each, h5py.Dataset)}
            if len(found) == 1:
                return next(iter(found.values()))[()]
            return {name: _of_hdf5(each) if wanted(name, asked) else None for name, each in found.items()}
    except (ParameterError, MemoryError):
        raise
    except Exception:  # h5py raises what its C library says
        raise ParameterError("file", where, "is not an HDF5 file, or it is damaged") from None


def _first_group(h5py: Any, group: Any) -> Any:
    for _ in range(DEEPEST_GROUP):
        # MATLAB keeps what it refers to in a group of its own, "#refs#".
        inner = [each for name, each in group.items() if isinstance(each, h5py.Group) and not name.startswith("#")]
        if len(inner) != 1 or any(isinstance(each, h5py.Dataset) for each in group.values()):
            break
        group = inner[0]
    return group


def _of_hdf5(dataset: Any) -> Any:
    values = dataset[()]
    if isinstance(values, np.ndarray) and values.dtype.kind == "O":
        values = np.array([each.decode() if isinstance(each, bytes) else each for each in values.ravel().tolist()])
    return np.squeeze(values) if isinstance(values, np.ndarray) and values.ndim > 1 else values
