"""Read solutions and events from files: text tables, JSON, numpy, parquet, feather, HDF5, MATLAB and Octave.

`read_solutions` reads samples for `symosc check`, `read_content` whatever a file holds, for `symosc score`.
"""

from __future__ import annotations

import bz2
import csv
import gzip
import io
import json
import lzma
import re
import struct
import sys
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from functools import partial
from importlib import import_module
from itertools import chain, islice
from pathlib import Path
from typing import IO, Any, NamedTuple

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.objects import (
    ID_COLUMN,
    Asked,
    SolverTask,
    find_columns,
    is_wanted,
    names_text,
    read_column_names,
    refuse_twice,
    solutions_in,
)
from symosc.crosschecks.samples import SAMPLE_COLUMNS, Samples, number_of, short
from symosc.errors import MissingExtraError, ParameterError
from symosc.files import STDOUT, read_path

TEXT_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".asc")
PACKED: dict[str, Callable[[Any], Any]] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
PACKED_BEGINNINGS = ((b"\x1f\x8b", ".gz"), (b"BZh", ".bz2"), (b"\xfd7zXZ", ".xz"))
#: How files without a suffix begin, standard input above all.
BEGINNINGS = (
    (b"PK\x03\x04", ".npz"), (b"\x93NUMPY", ".npy"), (b"PAR1", ".parquet"), (b"ARROW1", ".feather"),
    (b"\x89HDF", ".h5"), (b"MATLAB", ".mat"), (b"{", ".json"), (b"[", ".json"),
)  # fmt: skip
# A text that Octave's `save` has written, under any suffix; an HDF5 file, which MATLAB puts behind a block of text.
OCTAVE_SIGN, HDF5_SIGN, MATLAB_BLOCK = b"# Created by Octave", b"\x89HDF\r\n\x1a\n", 512
#: The largest unpacked size, and the largest file that must be in memory as a whole.
MOST_BYTES = 2_000_000_000
EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'
# Groups of an HDF5 file that are entered, one inside the other; values inside values of Octave and MATLAB.
DEEPEST_GROUP, DEEPEST_VALUE = 8, 50
#: Choose the columns of a table by their names: {"t": "Time (s)", ...}.
Choose = Callable[[list[str]], dict[str, str]]


class Kind(NamedTuple):
    """A file format: the name if a library reads it, and a function of (file, wanted columns or None, location)."""

    library: str
    read: Callable[[IO[bytes], Any, str], Any]


def read_solutions(
    source: Any, columns: Mapping[str, str | None] | None = None, problem: SolverTask | None = None
) -> list[Samples]:
    """Read solutions from a file, standard input ("-"), a list of files, or any object of docs/checking.md.

    `columns` names the columns t, x, v and id (None: there is no such column); a function needs a `problem` for its
    times. ParameterError if the file cannot be read, a column is missing or the samples are wrong.
    """
    asked: Asked = read_column_names(columns)
    if isinstance(source, (list, tuple)) and source and all(isinstance(each, (str, Path)) for each in source):
        found = [(path, each) for path in source for each in read_solutions(path, columns, problem)]
        return [replace(each, name=f"{path}:{each.name}" if each.name else str(path)) for path, each in found]
    if not isinstance(source, (str, Path)):
        return solutions_in(source, asked, problem)
    where = "standard input" if source == STDOUT else str(source)
    content = _read(source, where, asked, read_text)
    if isinstance(content, TextColumns):  # the columns asked for have been found
        asked = {}
    return solutions_in(content, asked, problem, where)


def read_content(path: str | Path, choose: Choose) -> Any:
    """Return the contents of a file: columns, an array, JSON values with Decimals, or text rows (`read_cells`)."""
    return _read(path, str(path), None, lambda file, _, where: read_cells(file, choose, where))


def _read(path: str | Path, where: str, asked: Asked | None, text: Callable[..., Any]) -> Any:
    """Return the contents of a file; convert any library error into a one-line ParameterError."""
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
        match error:
            case gzip.BadGzipFile() | lzma.LZMAError() | zlib.error() | EOFError():
                reason = "it is damaged, or cut off"
            case UnicodeError():
                reason = "it is not text in UTF-8"
            case RecursionError():
                reason = "its brackets are nested too deeply"
            case _:
                reason = getattr(error, "strerror", None) or first
    raise ParameterError("file", where, f"cannot be read: {reason}")


class _Unpacked(io.RawIOBase):
    """A decompressed file, limited to MOST_BYTES: a small file may decompress to a huge one."""

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
    """Raise ParameterError if a file has too many bytes."""
    if count > MOST_BYTES:
        raise ParameterError("file", where, f"is larger than {MOST_BYTES:.0e} bytes")


def _whole(file: IO[bytes], where: str) -> bytes:
    """Return all bytes of a file."""
    data = file.read(MOST_BYTES + 1)
    _check_size(len(data), where)
    return data


def _opened(path: str | Path, where: str) -> io.BufferedReader:
    """Open a file or standard input, decompressed; `peek` shows its beginning."""
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


def _kind(path: str | Path, file: io.BufferedReader, where: str, text: Callable[..., Any]) -> Kind:
    """Return the format of a file by its suffix, or by its first bytes without one."""
    kinds = {**dict.fromkeys(TEXT_SUFFIXES, Kind("", text)), **FILE_KINDS}
    suffix = "" if path == STDOUT else suffix_of(path)
    if suffix and suffix not in kinds:
        raise ParameterError("file", where, f"must end in {', '.join(kinds)}, and perhaps {', '.join(PACKED)}")
    beginning = file.peek(32).lstrip()[:32]
    if beginning.startswith(OCTAVE_SIGN) and suffix in ("", ".mat", *TEXT_SUFFIXES):
        return Kind("a file of Octave", read_octave)
    kind = kinds[suffix or next((suffix for sign, suffix in BEGINNINGS if beginning.startswith(sign)), ".txt")]
    if not (kind.library and isinstance(file.raw, _Unpacked)):
        return kind
    return Kind(kind.library, lambda file, asked, where: kind.read(io.BytesIO(_whole(file, where)), asked, where))


def suffix_of(path: str | Path) -> str:
    """Return the suffix of a file in lower case, before that of a compression; "" without one."""
    return next((each for each in map(str.lower, Path(path).suffixes[::-1]) if each not in PACKED), "")


# -- tables as text ----------------------------------------------------------------------------------------------------

# The last is no comment: with it a spreadsheet says which delimiter it uses.
COMMENT_SIGNS = ("#", "%", "//", "!", "sep=")
LONGEST_LINE = MOST_EMPTY_LINES = 1_000_000
# The header is looked for in so many lines.
HEAD_LINES = 1000
# Characters of a line without data.
EMPTY = " \t\n\r\v\f,;"
QUOTED = re.compile('"[^"]*"')
#: Exponents of Fortran, 1.5D-03.
FORTRAN = re.compile(r"([\d.])[dD]([+-]?\d)")


class TextColumns(dict[str, np.ndarray]):
    """The columns of a text file, under the names t, x, v and id."""


#: A line that is not empty: its number in the file, its text, and whether it holds data.
Line = tuple[int, str, bool]


class Layout(NamedTuple):
    """The layout of a text table: delimiter (None: blanks), number of cells, and the column numbers to read."""

    delimiter: str | None
    width: int
    columns: dict[str, int]

    def check_width(self, width: int, number: int, where: str) -> None:
        """Raise ParameterError for a line with too few or too many cells."""
        if width != self.width:
            raise ParameterError("file", where, f"row {number} has {width} entries, the header {self.width}")

    def plain(self, line: str, number: int, where: str) -> str:
        """Return a line of unquoted numbers, with decimal points and exponents with e."""
        delimiter = self.delimiter
        if '"' in line:
            sign = delimiter or " "
            line = sign.join(cell.replace(sign, " ") if delimiter else cell for cell in _split_cells(line, delimiter))
        if delimiter != "," and "," in line:
            line = line.replace(",", ".")
        if "D" in line or "d" in line:
            line = FORTRAN.sub(r"\1e\2", line)
        self.check_width(line.count(delimiter) + 1 if delimiter else len(line.split()), number, where)
        return line


def read_text(file: IO[bytes], asked: Asked, where: str) -> TextColumns:
    """Return the columns t, x, and v and id if present; numpy reads line by line."""

    def choose(names: list[str]) -> dict[str, str]:
        if names != [str(i + 1) for i in range(len(names))] or set(asked.values()) & set(names):
            return find_columns(names, asked, where)
        if len(names) not in (2, 3):
            what = f"has no header and {len(names)} columns; say which are meant, such as t=1,x=2,v=3"
            raise ParameterError("file", where, what)
        numbers = dict(zip(SAMPLE_COLUMNS, names, strict=False))
        return {name: numbers[column] for name, column in find_columns([*numbers], asked, where).items()}

    layout, lines = _table(file, choose, where)
    wanted = {name: i for name, i in layout.columns.items() if name != ID_COLUMN}
    id_column, ids, known = layout.columns.get(ID_COLUMN), list[str](), dict[str, str]()
    row, number, line = -1, 0, ""  # the last that numpy has asked for

    def plain_lines() -> Iterator[str]:
        nonlocal row, number, line
        for row, (number, text, _) in enumerate(lines):  # noqa: B007
            line = layout.plain(text, number, where)
            if id_column is not None:
                cell = _split_cells(line, layout.delimiter)[id_column]
                ids.append(known.setdefault(cell, cell))
            yield line

    rest = plain_lines()
    first = next(rest, None)
    if first is None:
        return TextColumns((name, np.empty(0)) for name in layout.columns)
    try:
        table = np.loadtxt(
            chain([first], rest), delimiter=layout.delimiter, usecols=[*wanted.values()], ndmin=2, comments=None
        )
    except ValueError:
        cells = _split_cells(line, layout.delimiter)
        for name, i in wanted.items():
            if not _is_number(cells[i], ","):
                raise ParameterError(f"{name}[{row}]", short(cells[i]), f"is not a number (line {number})") from None
        raise
    columns = {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(wanted)}
    return TextColumns(columns if id_column is None else columns | {ID_COLUMN: np.array(ids)})


def read_cells(file: IO[bytes], choose: Choose, where: str) -> list[tuple[str, dict[str, str]]]:
    """Return the rows of a text table with their line numbers, without empty cells."""
    layout, lines = _table(file, choose, where)
    found = []
    for number, text, _ in lines:
        cells = _split_cells(text, layout.delimiter)
        layout.check_width(len(cells), number, where)
        found.append((f"line {number}", {name: cells[i] for name, i in layout.columns.items() if cells[i]}))
    return found


def plain_number(cell: str) -> str:
    """Return a number as text with a decimal point, and with e before its exponent."""
    return FORTRAN.sub(r"\1e\2", cell.replace(",", "."))


def _table(file: IO[bytes], choose: Choose, where: str) -> tuple[Layout, Iterator[Line]]:
    """Return the layout of a table, and its lines with data."""
    lines = _lines(file, where)
    head = list(islice(lines, HEAD_LINES))
    layout, header = _layout(head, choose, where)
    return layout, (line for line in chain(head[header:], lines) if line[2])


def _lines(file: IO[bytes], where: str) -> Iterator[Line]:
    """Return the lines of a text file."""
    empty = 0
    with io.TextIOWrapper(file, "utf-8-sig", newline=None) as text:
        for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE), ""), 1):
            if len(line) >= LONGEST_LINE or (number <= 10 and "\0" in line):
                raise ParameterError("file", where, "cannot be read: it is not text in lines")
            content = line.strip(EMPTY)
            has_data = bool(content) and not content.startswith(COMMENT_SIGNS)
            empty += not has_data
            if empty > MOST_EMPTY_LINES and empty > 0.9 * number:
                raise ParameterError("file", where, f"has {empty:,} lines without data")
            if content:
                yield number, line.strip("\n"), has_data


def _layout(head: list[Line], choose: Choose, where: str) -> tuple[Layout, int]:
    """Return the layout of a text table, and the number of header lines."""
    data = [i for i, (_, _, has_data) in enumerate(head) if has_data]
    comments = head[: data[0]] if data else head  # one may be the header: numpy.savetxt writes such
    if not data and not comments:
        raise ParameterError("file", where, "is empty; its first line must name the columns, such as t,x,v")
    # The second line shows the delimiter better than a header.
    samples = [head[i][1] for i in data[1::-1]] or [comments[-1][1]]
    delimiter = next((sign for sign in map(_delimiter, samples) if sign), None)

    def layout(names: list[str]) -> Layout:
        found = choose(names)
        for name in found.values():
            if names.count(name) > 1:
                raise ParameterError("file", where, f"has {short(name)!r} twice; there are: {names_text(names)}")
        return Layout(delimiter, len(names), {name: names.index(column) for name, column in found.items()})

    first = _split_cells(head[data[0]][1], delimiter) if data else []
    wrong = None
    if data and not all(_is_number(cell, delimiter) for cell in first):
        try:
            return layout(first), data[0] + 1
        except ParameterError as error:  # it may be a row with words, below a header that is a comment
            wrong = error
    for _, line, _ in comments[::-1]:
        names = _split_cells(line.lstrip("".join(COMMENT_SIGNS) + " "), delimiter)
        if all(_is_number(name, None) for name in names) or (data and len(names) != len(first)):
            continue
        with suppress(ParameterError):  # it is only a comment
            return layout(names), len(comments)
    if wrong is not None:
        raise wrong
    return layout([str(i) for i in range(1, len(first) + 1)]), len(comments)


def _delimiter(line: str) -> str | None:
    """Return the delimiter of a line."""
    line = QUOTED.sub("", line)
    cells = line.split()
    if ";" in line or "\t" in line:
        return ";" if ";" in line else "\t"
    return "," if "," in line and not (len(cells) > 1 and all(_is_number(cell, None) for cell in cells)) else None


def _split_cells(line: str, delimiter: str | None) -> list[str]:
    """Split a line into cells."""
    if delimiter is None:
        return line.replace('"', " ").split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(delimiter)]
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]


def _is_number(cell: str, delimiter: str | None) -> bool:
    """Return whether a cell is a number."""
    try:
        number_of(FORTRAN.sub(r"\1e\2", cell) if delimiter == "," else plain_number(cell))
    except (TypeError, ValueError):
        return False
    return True


# -- JSON, arrays, tables of pyarrow -----------------------------------------------------------------------------------


def read_json(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the content of a JSON file; for samples it must be columns, or a list of rows or pieces."""
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


def _read_numpy(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Read a numpy file."""
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
    """Read a parquet file."""
    parquet = _library("pyarrow.parquet", "a parquet file").ParquetFile(file)
    names = parquet.schema_arrow.names
    table = parquet.read(columns=[name for name in names if is_wanted(name, asked)])
    return {name: table.column(name).to_numpy() if name in table.column_names else None for name in names}


def _read_feather(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Read a feather file."""
    table = _library("pyarrow.feather", "a feather file").read_table(file)
    return {name: table.column(name).to_numpy() if is_wanted(name, asked) else None for name in table.column_names}


def _library(name: str, what: str) -> Any:
    """Import a package that reads `what`; MissingExtraError if it is not installed."""
    try:
        return import_module(name)
    except ImportError:
        raise MissingExtraError(what, "tables") from None


def _unwrapped(found: Record) -> Any:
    """Return the variables of a file; of a single one, the fields of the struct, or the array."""
    only = next(iter(found.values())) if len(found) == 1 else None
    return found if only is None or (np.ndim(only) == 0 and not isinstance(only, dict)) else only


# -- HDF5, also of MATLAB and Octave; text of Octave -------------------------------------------------------------------


def _read_hdf5(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the datasets of an HDF5 or netCDF 4 file: those of the first group that has some."""
    h5py = _library("h5py", "an HDF5 file")
    with h5py.File(file, "r") as group:
        for _ in range(DEEPEST_GROUP):
            # MATLAB keeps the targets of references in a group of its own, "#refs#".
            inner = [each for name, each in group.items() if isinstance(each, h5py.Group) and not name.startswith("#")]
            if len(inner) != 1 or _is_octave(inner[0]) or any(isinstance(e, h5py.Dataset) for e in group.values()):
                break
            group = inner[0]
        found = {name: e for name, e in group.items() if isinstance(e, h5py.Dataset) or _is_octave(e)}
        alone = len(found) == 1
        return _unwrapped({n: _hdf5_value(e) if alone or is_wanted(n, asked) else None for n, e in found.items()})


def _is_octave(group: Any) -> bool:
    """Return whether an HDF5 group was written by Octave."""
    return "OCTAVE_NEW_FORMAT" in group.attrs


def _hdf5_value(item: Any, depth: int = 0) -> Any:
    """Return the value of a dataset, or of an Octave variable: a group with type and value."""
    if not _is_octave(item):
        values = item[()]
        if isinstance(values, np.ndarray) and values.dtype.kind == "O":
            values = np.array([each.decode() if isinstance(each, bytes) else each for each in values.ravel().tolist()])
        return np.squeeze(values) if isinstance(values, np.ndarray) and values.ndim > 1 else values
    kind, value = item["type"][()].decode(), item["value"]
    if depth > DEEPEST_VALUE:
        raise RecursionError("values inside values")
    if kind == "cell":
        return [_hdf5_value(value[f"_{i}"], depth + 1) for i in range(len(value) - 1)]
    if kind.endswith("struct"):
        return {name: _hdf5_value(each, depth + 1) for name, each in value.items()}
    if kind.endswith("range"):
        base, limit, increment = value[()].tolist()
        return _octave_range(base, limit, increment, int(value.attrs["OCTAVE_RANGE_NELEM"]))
    if "OCTAVE_EMPTY_MATRIX" in item.attrs:
        return np.empty(0)
    if kind.endswith("string"):
        texts = [bytes(row.astype(np.uint8)).decode("utf-8", "replace").strip() for row in np.atleast_2d(value[()].T)]
        return texts[0] if len(texts) == 1 else texts
    return np.squeeze(value[()].T)


def _octave_range(base: float, limit: float, increment: float, count: int) -> np.ndarray:
    """Return the numbers of an Octave range."""
    values = base + increment * np.arange(count)  # rounding leads none beyond the limit
    return np.minimum(values, limit) if increment > 0 else np.maximum(values, limit)


def read_octave(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables of a text file written by Octave's `save`."""
    lines = iter(_whole(file, where).decode("utf-8-sig", "replace").splitlines())
    return _unwrapped({line[8:]: _octave_value(lines) for line in lines if line.startswith("# name: ")})


def _octave_value(lines: Iterator[str], depth: int = 0) -> Any:
    """Return the next value; None if it cannot hold samples."""
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
        return _octave_range(base, limit, increment, int((limit - base) / increment * (1 + 1e-15) + 1e-9) + 1)
    if kind.endswith("string"):
        texts = [next(lines).strip() if number("length") else "" for _ in range(number("elements"))]
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
# Kinds of data in the format; a packed matrix has a checksum of its own.
NUMBER_TAGS, MATRIX_TAG, PACKED_TAG, TEXT_TAGS = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13), 14, 15, (16, 17, 18)
# Classes of matrices that hold numbers; a sparse one has two lists of places as well.
SPARSE, NUMBER_CLASSES = 5, range(5, 16)


def _read_mat(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables of a MATLAB file; version 7.3 is HDF5."""
    begins = file.read(MATLAB_BLOCK + len(HDF5_SIGN))
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
    return _unwrapped(found)


def has_wrong_tags(data: bytes) -> bool:
    """Return whether a version 5 file has an unknown or overlong tag, at which scipy crashes.

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
    """Return whether the elements between two positions have valid tags."""
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
    """Yield kind, begin and end of the elements between two positions; those inside a matrix are multiples of 8."""
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


#: The formats other than text, by suffix.
FILE_KINDS: dict[str, Kind] = {
    ".json": Kind("", read_json),
    **dict.fromkeys((".npz", ".npy"), Kind("an npz file", _read_numpy)),
    ".mat": Kind("a MATLAB file", _read_mat),
    **dict.fromkeys((".parquet", ".pq"), Kind("a parquet file", _read_parquet)),
    **dict.fromkeys((".feather", ".arrow"), Kind("a feather file", _read_feather)),
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".nc"), Kind("an HDF5 file", _read_hdf5)),
}
SUFFIXES = (*TEXT_SUFFIXES, *FILE_KINDS)
