"""Files of other people: what a file is, how it is opened, and what it holds, each kind read by the library for it.

`read_solutions` reads samples for `symosc check`, `read_content` whatever there is, for `symosc score`: the same files,
the same way.
"""

from __future__ import annotations

import bz2
import gzip
import io
import json
import lzma
import struct
import sys
import zlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from decimal import Decimal
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.columns import Asked, asked_columns, is_wanted, refuse_twice
from symosc.crosschecks.functions import SolverTask, of_function, solver_task
from symosc.crosschecks.objects import solutions_in
from symosc.crosschecks.samples import Samples, checked, checked_positions, short
from symosc.crosschecks.text_tables import Choose, TextColumns, read_cells, read_text
from symosc.errors import MissingExtraError, ParameterError
from symosc.files import STDOUT, read_path
from symosc.model import Parameters
from symosc.scenes import Scene

TEXT_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".asc")
PACKED: dict[str, Callable[[Any], Any]] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
PACKED_BEGINNINGS = ((b"\x1f\x8b", ".gz"), (b"BZh", ".bz2"), (b"\xfd7zXZ", ".xz"))
#: How files begin that are no text: for what has no suffix, standard input above all.
BEGINNINGS = (
    (b"PK\x03\x04", ".npz"),
    (b"\x93NUMPY", ".npy"),
    (b"PAR1", ".parquet"),
    (b"ARROW1", ".feather"),
    (b"\x89HDF", ".h5"),
    (b"MATLAB", ".mat"),
    (b"{", ".json"),
    (b"[", ".json"),
)
#: How a text begins that Octave's `save` has written, whatever its suffix is.
OCTAVE_SIGN = b"# Created by Octave"
# An HDF5 file begins so; one of MATLAB behind a block of text.
HDF5_SIGN, BLOCK_OF_MATLAB = b"\x89HDF\r\n\x1a\n", 512
STDIN_NAME = "standard input"
#: What libraries raise for packed files that are cut off.
DAMAGED: tuple[type[Exception], ...] = (gzip.BadGzipFile, lzma.LZMAError, zlib.error, EOFError)
#: No more bytes are unpacked, and no more of a file that must be in memory as a whole.
MOST_BYTES = 2_000_000_000
#: The extra that brings the libraries.
EXTRA = "tables"
EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'
# Groups of an HDF5 file that are entered, one inside the other; values inside values of Octave and MATLAB.
DEEPEST_GROUP, DEEPEST_VALUE = 8, 50


def given_solutions(
    scene: Scene | Parameters, given: tuple[Any, Any, Any], events: Any, columns: Mapping[str, str | None] | None
) -> list[Samples]:
    """Return the solutions in t, x and v as `crosscheck` takes them, with the events that were listed beside."""
    t, x, v = given
    problem = solver_task(scene)
    if x is None and v is None:
        found = read_solutions(t, columns, problem)
    elif callable(x) and not hasattr(x, "__array__"):
        found = [of_function(x, problem, t)]
    else:
        found = [checked(t, x, v, events) if v is not None else checked_positions(t, x, events)]
    if events is None:
        return found
    if len(found) > 1:
        raise ParameterError("events", "given", f"can be listed for one solution; there are {len(found)}")
    return [replace(found[0], events=checked(found[0].t, found[0].x, found[0].x, events).events)]


def read_samples(source: Any, columns: Mapping[str, str | None] | None = None) -> Samples:
    """Read one solution; see `read_solutions`. ParameterError if there are several."""
    found = read_solutions(source, columns)
    if len(found) != 1:
        raise ParameterError("solutions", len(found), "one was expected")
    return found[0]


def read_solutions(
    source: Any, columns: Mapping[str, str | None] | None = None, problem: SolverTask | None = None
) -> list[Samples]:
    """Read solutions from a file, or from an object of any kind in the table of docs/checking.md.

    Parameters
    ----------
    source : path or object
        A file, "-" for standard input, a list of files, or what `symosc.crosschecks.objects.solutions_in` takes.
    columns : mapping, optional
        What the columns t, x and v, and id, are called, for example ``{"x": "position"}``; None for a v or an id that
        is not there. Default: usual names in any case.
    problem : SolverTask, optional
        What is to be solved; a function needs times at which it is asked.

    Raises
    ------
    ParameterError
        If the file cannot be read, a column is missing, or the samples are not what `checked` demands.
    """
    asked = asked_columns(columns)
    if isinstance(source, (list, tuple)) and source and all(isinstance(each, (str, Path)) for each in source):
        found = [(path, each) for path in source for each in read_solutions(path, columns, problem)]
        return [replace(each, name=f"{path}:{each.name}" if each.name else str(path)) for path, each in found]
    if not isinstance(source, (str, Path)):
        return solutions_in(source, asked, problem)
    where = STDIN_NAME if source == STDOUT else str(source)
    content = _read(source, where, asked, Kind("", read_text))
    if isinstance(content, TextColumns):  # what was asked for has been found
        asked = {}
    return solutions_in(content, asked, problem, where)


def read_content(path: str | Path, choose: Choose) -> Any:
    """Return what a file holds: columns, an array, what JSON has, or the rows of a text (see `read_cells`).

    Numbers of JSON are Decimals and those of text are text, so that no digit is lost. `choose` says what the columns of
    a text are.
    """
    return _read(path, str(path), None, Kind("", lambda file, _, where: read_cells(file, choose, where)))


class Kind(NamedTuple):
    """What is read, if by a library; and what reads the columns that are asked for (None: all) of an opened file."""

    what: str
    read: Callable[[IO[bytes], Any, str], Any]


def _read(path: str | Path, where: str, asked: Asked | None, text: Kind) -> Any:
    """Return what a file holds; whatever a library raises is a ParameterError of one line."""
    library = ""
    try:
        with _opened(path, where) as file:
            library, read = _kind(path, file, where, text)
            return read(file, asked, where)
    except (ParameterError, MissingExtraError):
        raise
    except MemoryError:
        reason = "it does not fit into memory"
    except Exception as error:
        first = str(error).partition("\n")[0]
        if library:
            what = f"is not {library}, or it is damaged{': ' if first else ''}{short(first)}"
            raise ParameterError("file", where, what) from None
        reasons: dict[type[Exception], str] = dict.fromkeys(DAMAGED, "it is damaged, or cut off")
        reasons |= {UnicodeError: "it is not text in UTF-8", RecursionError: "its brackets are nested too deeply"}
        reasons[OSError] = getattr(error, "strerror", None) or first
        reason = next((words for kind, words in reasons.items() if isinstance(error, kind)), first)
    raise ParameterError("file", where, f"cannot be read: {reason}")


class _Unpacked(io.RawIOBase):
    """What a packed file unpacks to, up to MOST_BYTES: a small file may hold very much."""

    def __init__(self, inner: IO[bytes], where: str) -> None:
        self.inner, self.where, self.count = inner, where, 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        data = self.inner.read(len(buffer))
        buffer[: len(data)] = data
        self.count += len(data)
        _check_size(self.count, self.where)
        return len(data)

    def close(self) -> None:
        self.inner.close()
        super().close()


def _check_size(count: int, where: str) -> None:
    if count > MOST_BYTES:
        raise ParameterError("file", where, f"is larger than {MOST_BYTES:.0e} bytes")


def _whole(file: IO[bytes], where: str) -> bytes:
    data = file.read(MOST_BYTES + 1)
    _check_size(len(data), where)
    return data


def _opened(path: str | Path, where: str) -> io.BufferedReader:
    """Return a file, or standard input, unpacked, of which one can see the beginning."""
    if path == STDOUT:
        data = _whole(sys.stdin.buffer, where)
        file: Any = io.BytesIO(data)
        packed = next((suffix for sign, suffix in PACKED_BEGINNINGS if data.startswith(sign)), "")
    else:
        file = Path(read_path(path))
        if file.is_dir():
            raise IsADirectoryError(None, "it is a folder")
        packed = file.suffix.lower()
    if packed in PACKED:
        return io.BufferedReader(_Unpacked(PACKED[packed](file), where))
    return io.BufferedReader(file) if path == STDOUT else file.open("rb")


def _kind(path: str | Path, file: io.BufferedReader, where: str, text: Kind) -> Kind:
    """Return the kind of a file: by its suffix, or by how it begins if it has none."""
    kinds = {**dict.fromkeys(TEXT_SUFFIXES, text), **FILE_KINDS}
    suffix = "" if path == STDOUT else suffix_of(path)
    if suffix and suffix not in kinds:
        raise ParameterError("file", where, f"must end in {', '.join(kinds)}, and perhaps {', '.join(PACKED)}")
    beginning = file.peek(32).lstrip()[:32]
    if beginning.startswith(OCTAVE_SIGN) and suffix in ("", ".mat", *TEXT_SUFFIXES):
        return OCTAVE_TEXT
    kind = kinds[suffix or next((suffix for sign, suffix in BEGINNINGS if beginning.startswith(sign)), ".txt")]
    if not (kind.what and isinstance(file.raw, _Unpacked)):
        return kind
    return Kind(kind.what, lambda file, asked, where: kind.read(io.BytesIO(_whole(file, where)), asked, where))


def suffix_of(path: str | Path) -> str:
    """Return the suffix of a file in small letters, of a packed one that before; "" without one."""
    return next((each for each in map(str.lower, Path(path).suffixes[::-1]) if each not in PACKED), "")


# -- JSON and arrays ---------------------------------------------------------------------------------------------------


def read_json(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return what a JSON file holds; where columns are asked for it must be columns, or a list of rows or pieces."""
    text = _whole(file, where).decode("utf-8-sig")
    if not text.strip():
        raise ParameterError("file", where, f"is empty; it must hold columns, such as {EXAMPLE}")

    def table(pairs: list[tuple[str, Any]]) -> Record:
        refuse_twice(where, (name for name, _ in pairs), asked)
        return dict(pairs)

    try:
        data = json.loads(text, object_pairs_hook=table, parse_float=Decimal if asked is None else None)
    except (ParameterError, json.JSONDecodeError):
        raise
    except ValueError:  # Python's own limit
        raise ParameterError("file", where, "cannot be read: a number in it has thousands of digits") from None
    kinds = {type(each) for each in data} if isinstance(data, list) else {type(data)}
    if asked is not None and kinds != {dict} and not (isinstance(data, list) and kinds == {list}):
        raise ParameterError("file", where, f"must hold columns, such as {EXAMPLE}")
    return data


def _read_npz(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the arrays of an npz file, or the array of an npy file."""
    data = np.load(file)
    if isinstance(data, np.ndarray):
        return data

    def array(name: str) -> Any:
        try:
            return data[name]
        except ValueError:
            what = f"{name} must be an array of numbers (events, id: of text), not of Python objects"
            raise ParameterError("file", where, what) from None

    with data:
        return {name: array(name) if is_wanted(name, asked) else None for name in data.files}


def _read_parquet(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    parquet = _library("pyarrow.parquet", "a parquet file").ParquetFile(file)
    names = parquet.schema_arrow.names
    table = parquet.read(columns=[name for name in names if is_wanted(name, asked)])
    return {name: table.column(name).to_numpy() if name in table.column_names else None for name in names}


def _read_feather(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    table = _library("pyarrow.feather", "a feather file").read_table(file)
    return {name: table.column(name).to_numpy() if is_wanted(name, asked) else None for name in table.column_names}


def _library(name: str, what: str) -> Any:
    """Return a package that reads `what`; MissingExtraError if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(what, EXTRA) from None


def _one_alone(found: Record) -> Any:
    """Return the variables of a file; of one that is a struct the fields, of one array the array."""
    only = next(iter(found.values())) if len(found) == 1 else None
    return found if only is None or (np.ndim(only) == 0 and not isinstance(only, dict)) else only


# -- HDF5, with that of MATLAB and Octave ------------------------------------------------------------------------------


def _read_hdf5(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the datasets of an HDF5 (or netCDF 4) file: those of the first group that has some."""
    h5py = _library("h5py", "an HDF5 file")
    with h5py.File(file, "r") as group:
        for _ in range(DEEPEST_GROUP):
            # MATLAB keeps what it refers to in a group of its own, "#refs#".
            inner = [each for name, each in group.items() if isinstance(each, h5py.Group) and not name.startswith("#")]
            if len(inner) != 1 or _is_of_octave(inner[0]) or any(isinstance(e, h5py.Dataset) for e in group.values()):
                break
            group = inner[0]
        found = {name: e for name, e in group.items() if isinstance(e, h5py.Dataset) or _is_of_octave(e)}
        alone = len(found) == 1
        return _one_alone({n: _of_hdf5(e) if alone or is_wanted(n, asked) else None for n, e in found.items()})


def _is_of_octave(group: Any) -> bool:
    return "OCTAVE_NEW_FORMAT" in group.attrs


def _of_hdf5(item: Any, depth: int = 0) -> Any:
    """Return a dataset, or a variable of Octave: a group with its type and value."""
    if not _is_of_octave(item):
        values = item[()]
        if isinstance(values, np.ndarray) and values.dtype.kind == "O":
            values = np.array([each.decode() if isinstance(each, bytes) else each for each in values.ravel().tolist()])
        return np.squeeze(values) if isinstance(values, np.ndarray) and values.ndim > 1 else values
    kind, value = item["type"][()].decode(), item["value"]
    if depth > DEEPEST_VALUE:
        raise RecursionError("values inside values")
    if kind == "cell":
        return [_of_hdf5(value[f"_{i}"], depth + 1) for i in range(len(value) - 1)]
    if kind.endswith("struct"):
        return {name: _of_hdf5(each, depth + 1) for name, each in value.items()}
    if kind.endswith("range"):
        base, limit, increment = value[()].tolist()
        return _range(base, limit, increment, int(value.attrs["OCTAVE_RANGE_NELEM"]))
    if "OCTAVE_EMPTY_MATRIX" in item.attrs:
        return np.empty(0)
    if kind.endswith("string"):
        texts = [bytes(row.astype(np.uint8)).decode("utf-8", "replace").strip() for row in np.atleast_2d(value[()].T)]
        return texts[0] if len(texts) == 1 else texts
    return np.squeeze(value[()].T)


def _range(base: float, limit: float, increment: float, count: int) -> np.ndarray:
    """Return the numbers of a range of Octave; rounding leads none beyond its limit."""
    values = base + increment * np.arange(count)
    return np.minimum(values, limit) if increment > 0 else np.maximum(values, limit)


def read_octave(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables of a text that Octave's `save` has written."""
    lines = iter(_whole(file, where).decode("utf-8-sig", "replace").splitlines())
    found: Record = {}
    for line in lines:
        if line.startswith("# name: "):
            found[line.removeprefix("# name: ")] = _octave_value(lines)
    return _one_alone(found)


def _octave_value(lines: Iterator[str], depth: int = 0) -> Any:
    """Return the value that follows; None for one of another kind."""
    if depth > DEEPEST_VALUE:
        raise RecursionError("values inside values")

    def number(name: str) -> int:
        return int(next(lines).removeprefix(f"# {name}: "))

    def inner() -> tuple[str, Any]:
        name = next(line for line in lines if line.startswith("# name: "))
        return name.removeprefix("# name: "), _octave_value(lines, depth + 1)

    def sizes() -> tuple[list[int], bool]:
        """Return the size in each dimension, and whether a line is a row (else it is a number)."""
        line = next(lines)
        if line.startswith("# ndims: "):
            return [int(size) for size in next(lines).split()], False
        return [int(line.removeprefix("# rows: ")), number("columns")], True

    kind = next(lines).removeprefix("# type: ")
    if kind.startswith("complex") or "sparse" in kind or "diagonal" in kind:
        return None
    if kind.endswith("range"):
        next(lines)
        base, limit, increment = map(float, next(lines).split())
        return _range(base, limit, increment, int((limit - base) / increment * (1 + 1e-15) + 1e-9) + 1)
    if kind.endswith("string"):
        texts = []
        for _ in range(number("elements")):
            texts.append(next(lines).strip() if number("length") else "")
        return texts[0] if len(texts) == 1 else texts
    if kind == "cell":
        return [inner()[1] for _ in range(int(np.prod(sizes()[0])))]
    if kind == "scalar struct":
        sizes()
        return dict(inner() for _ in range(number("length")))
    if not kind.endswith("matrix"):
        return float(next(lines)) if kind.endswith(("scalar", "bool")) else None
    shape, by_rows = sizes()
    rows = islice(lines, shape[0] if by_rows else int(np.prod(shape)))
    values = np.array(" ".join(rows).split(), dtype=float)
    return np.squeeze(values.reshape(shape, order="C" if by_rows else "F"))


# -- MATLAB ------------------------------------------------------------------------------------------------------------

MAT_HEADER = 128
#: The kinds of data that the format has; a matrix is made of such, a packed one has a checksum of its own.
NUMBER_TAGS, MATRIX_TAG, PACKED_TAG, TEXT_TAGS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13), 14, 15, (16, 17, 18)
#: Classes of a matrix that holds numbers; a sparse one has two lists of places as well.
SPARSE, NUMBER_CLASSES = 5, range(5, 16)


def _read_mat(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables of a MATLAB file; version 7.3 is HDF5."""
    begins = file.read(BLOCK_OF_MATLAB + len(HDF5_SIGN))
    file.seek(0)
    if begins.startswith(HDF5_SIGN) or begins.endswith(HDF5_SIGN):
        return _read_hdf5(file, asked, where)
    data = _whole(file, where)
    if has_wrong_tags(data):
        raise ValueError
    from scipy.io import loadmat

    variables = loadmat(io.BytesIO(data), squeeze_me=True, struct_as_record=True)
    found = {name: value for name, value in variables.items() if not name.startswith("__")}
    for name, value in found.items():
        if isinstance(value, np.ndarray) and value.dtype.names:  # a struct with the columns as its fields
            found[name] = {field: value[field][()] for field in value.dtype.names}
    return _one_alone(found)


def has_wrong_tags(data: bytes) -> bool:
    """Return whether a file of version 5 has a tag of no known kind, or one that reaches beyond its matrix.

    scipy ends the whole program at such a file.

    Examples
    --------
    >>> from io import BytesIO
    >>> from scipy.io import savemat
    >>> file = BytesIO()
    >>> savemat(file, {"t": [0.0, 1.0]})
    >>> data = file.getvalue()
    >>> has_wrong_tags(data), has_wrong_tags(data[:176] + b"\\xff" + data[177:])
    (False, True)
    """
    order = {b"IM": "<", b"MI": ">"}.get(data[126:MAT_HEADER])
    if order is None:
        return False  # version 4, or no such file: scipy says so
    try:
        return not all(_is_sound(data, order, *tag, 1) for tag in _tags(data, order, MAT_HEADER, len(data), False))
    except (struct.error, ValueError):
        return True


def _is_sound(data: bytes, order: str, kind: int, begin: int, end: int, depth: int) -> bool:
    if kind != MATRIX_TAG:
        return kind in (*NUMBER_TAGS, PACKED_TAG, *TEXT_TAGS)
    parts = list(_tags(data, order, begin, end, True))
    if parts:  # a matrix of numbers has as many as its flags say: flags, size, name, numbers
        (flags,) = struct.unpack_from(f"{order}I", data, parts[0][1])
        own, complex_too = flags & 0xFF, flags >> 11 & 1
        if own in NUMBER_CLASSES and len(parts) != 4 + complex_too + 2 * (own == SPARSE):
            return False
    return depth <= DEEPEST_VALUE and all(_is_sound(data, order, *part, depth + 1) for part in parts)


def _tags(data: bytes, order: str, at: int, end: int, inside: bool) -> Iterator[tuple[int, int, int]]:
    """Yield kind, beginning and end of the elements between two places; those inside a matrix are multiples of 8."""
    while at < end:
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind >> 16:  # a short one, in the tag itself
            yield kind & 0xFFFF, at + 4, at + 8
            at += 8
            continue
        begin, at = at + 8, at + 8 + size
        if at > end:
            raise ValueError("an element reaches beyond its end")
        yield kind, begin, at
        at += -size % 8 if inside else 0


OCTAVE_TEXT = Kind("a file of Octave", read_octave)
#: The kinds of files that are no tables of text, by their suffix.
FILE_KINDS: dict[str, Kind] = {
    ".json": Kind("", read_json),
    **dict.fromkeys((".npz", ".npy"), Kind("an npz file", _read_npz)),
    ".mat": Kind("a MATLAB file", _read_mat),
    **dict.fromkeys((".parquet", ".pq"), Kind("a parquet file", _read_parquet)),
    **dict.fromkeys((".feather", ".arrow"), Kind("a feather file", _read_feather)),
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".nc"), Kind("an HDF5 file", _read_hdf5)),
}
#: All suffixes that are read.
SUFFIXES = (*TEXT_SUFFIXES, *FILE_KINDS)
