"""Read solutions and events from files.

Text tables, JSON, numpy, parquet, feather, HDF5, MATLAB and Octave.

`read_solutions` reads samples for `symosc check`, `read_content` whatever a file holds, for `symosc
score`.
"""

from __future__ import annotations

import bz2
import csv
import gzip
import io
import json
import lzma
import os
import re
import struct
import sys
import zlib
from array import array
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from decimal import Decimal
from functools import partial
from itertools import chain, islice
from pathlib import Path
from typing import IO, Any

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, SymoscError, brief, optional
from symosc.base.files import STDIN_CLOSED, STDOUT, read_path
from symosc.crosschecks.objects import (
    ID_COLUMN,
    Asked,
    Problem,
    find_columns,
    is_wanted,
    names_text,
    read_column_names,
    refuse_twice,
    solutions_in,
)
from symosc.crosschecks.samples import SAMPLE_COLUMNS, Samples, number_of

TEXT_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".asc")
PACKED: dict[str, Callable[[Any], Any]] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
#: How files without a suffix begin, standard input above all.
BEGINNINGS = {
    b"\x1f\x8b": ".gz", b"BZh": ".bz2", b"\xfd7zXZ": ".xz",
    b"PK\x03\x04": ".npz", b"\x93NUMPY": ".npy", b"PAR1": ".parquet", b"ARROW1": ".feather",
    b"\x89HDF": ".h5", b"MATLAB": ".mat", b"{": ".json", b"[": ".json",
}  # fmt: skip
#: The largest unpacked size, and the largest file that must be in memory as a whole.
MOST_BYTES = 2_000_000_000
EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'
#: Choose the columns of a table by their names: {"t": "Time (s)", ...}.
Choose = Callable[[list[str]], dict[str, str]]
#: Return the content of a file: (file, wanted columns or None for all, its name for messages).
Reader = Callable[[IO[bytes], Any, str], Any]


def read_solutions(
    source: Any, columns: Mapping[str, str | None] | None = None, problem: Problem = None
) -> list[Samples]:
    """Read solutions from a file, standard input ("-"), a list of files, or an object such as a table or a function.

    `columns` says how the columns t, x, v and id are called, None for a missing one; from `problem`
    a function gets its times. ParameterError if the file cannot be read, a column is missing or the
    samples are wrong.
    """
    # docs/checking.md lists the objects.
    asked = read_column_names(columns)
    if (
        isinstance(source, (list, tuple))
        and source
        and all(isinstance(each, (str, Path)) for each in source)
    ):
        found = [(path, each) for path in source for each in read_solutions(path, columns, problem)]
        return [
            replace(each, name=f"{path}:{each.name}" if each.name else str(path))
            for path, each in found
        ]
    if not isinstance(source, (str, Path)):
        return solutions_in(source, asked, problem)
    if source == STDOUT:
        where = "standard input"
    else:
        where = str(source)
    content = _read(source, where, asked, read_text)
    # Of text the columns asked for have been found.
    return solutions_in(content, {} if isinstance(content, TextColumns) else asked, problem, where)


def read_content(path: str | Path, choose: Choose) -> Any:
    """Return the contents of a file.

    Arrays, JSON values, or the rows of a text table in columns named by `choose`.
    """
    # A line is its place in the file, and its cells that are not empty by the names that `choose`
    # gives them.

    def cells_by_name(file: IO[bytes], asked: Any, where: str) -> list[tuple[str, dict[str, str]]]:
        _, columns, rows = _table(file, choose, where)
        return [
            (f"line {number}", {name: cells[i] for name, i in columns.items() if cells[i]})
            for number, cells in rows
        ]

    return _read(path, str(path), None, cells_by_name)


def _read(path: str | Path, where: str, asked: Asked | None, text: Reader) -> Any:
    """Return the columns `asked` for (None: all) of a file; `text` reads plain text.

    Any error is a ParameterError.
    """
    library = ""
    try:
        with _opened(path, where) as file:
            library, read = _format_of(path, file, where, text)
            if library and isinstance(file.raw, _Unpacked):  # libraries seek
                return read(io.BytesIO(_whole(file, where)), asked, where)
            return read(file, asked, where)
    except SymoscError:
        raise
    except MemoryError:
        reason = "it does not fit into memory"
    except Exception as error:
        first = str(error).partition("\n")[0]
        if library:
            what = f"is not {library}, or it is damaged{': ' if first else ''}{brief(first)}"
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
    """Return all bytes of a file; ParameterError if they are too many."""
    data = file.read(MOST_BYTES + 1)
    _check_size(len(data), where)
    return data


def _opened(path: str | Path, where: str) -> io.BufferedReader:
    """Open a file or standard input to read bytes, decompressed if it is compressed."""
    if path == STDOUT:
        if sys.stdin is None:
            raise ParameterError("file", where, STDIN_CLOSED)
        data = _whole(sys.stdin.buffer, where)
        file: Any = io.BytesIO(data)
        packed = _suffix_of_content(data)
    else:
        file = Path(read_path(path))
        if file.is_dir():
            raise IsADirectoryError(None, "it is a folder")
        packed = file.suffix.lower()
    if packed in PACKED:
        return io.BufferedReader(_Unpacked(PACKED[packed](file), where))
    if path == STDOUT:
        return io.BufferedReader(file)
    return file.open("rb")


def _suffix_of_content(beginning: bytes) -> str:
    """Return the suffix of the format whose files begin with these bytes, ".txt" if there is none."""
    return next(
        (suffix for sign, suffix in BEGINNINGS.items() if beginning.startswith(sign)), ".txt"
    )


def _format_of(
    path: str | Path, file: io.BufferedReader, where: str, text: Reader
) -> tuple[str, Reader]:
    """Return the name of a file's format for messages, and the function that reads it.

    Plain text is read by `text`.
    """
    if path == STDOUT:
        suffix = ""
    else:
        suffix = suffix_of(path)
    if suffix and suffix not in SUFFIXES:
        raise ParameterError(
            "file", where, f"must end in {', '.join(SUFFIXES)}, and perhaps {', '.join(PACKED)}"
        )
    beginning = file.peek(32).lstrip()[:32]
    if beginning.startswith(b"# Created by Octave") and suffix in ("", ".mat", *TEXT_SUFFIXES):
        return "a file of Octave", read_octave
    return FILE_KINDS.get(suffix or _suffix_of_content(beginning), ("", text))


def suffix_of(path: str | Path) -> str:
    """Return the suffix of a file in lower case, without that of a compression.

    "" if it has none.
    """
    return next(
        (each for each in map(str.lower, Path(path).suffixes[::-1]) if each not in PACKED), ""
    )


# -- tables as text ----------------------------------------------------------------------------------------------------

# "sep=" begins no comment, but a line by which a spreadsheet says which delimiter it uses.
COMMENT_SIGNS = ("#", "%", "//", "!", "sep=")
LONGEST_LINE = MOST_EMPTY_LINES = 1_000_000


class TextColumns(dict[str, np.ndarray]):
    """The columns of a text file, already found and renamed to t, x, v and id."""


def read_text(file: IO[bytes], asked: Asked, where: str) -> TextColumns:
    """Return the columns t and x of a text table, and v and id if present.

    `asked` may say how they are called.
    """
    choose = partial(sample_columns, asked=asked, where=where)
    delimiter, columns, rows = _table(file, choose, where)
    id_column = columns.pop(ID_COLUMN, None)
    ids = list[str]()
    values = {name: array("d") for name in columns}
    for row, (number, cells) in enumerate(rows):
        for name, i in columns.items():
            try:
                values[name].append(_number(cells[i], delimiter))
            except ValueError:
                raise ParameterError(
                    f"{name}[{row}]", brief(cells[i]), f"is not a number (line {number})"
                ) from None
        if id_column is not None:
            ids.append(sys.intern(cells[id_column]))  # one string for all rows of an id
    found = TextColumns((name, np.array(column)) for name, column in values.items())
    if id_column is None:
        return found
    return TextColumns({**found, ID_COLUMN: np.array(ids)})


def sample_columns(names: list[str], asked: Asked, where: str) -> dict[str, str]:
    """Find t, x and perhaps v, id among the columns of a text table.

    They are numbered if it has no header.
    """
    if names != [str(i + 1) for i in range(len(names))] or set(asked.values()) & set(names):
        return find_columns(names, asked, where)
    if len(names) not in (2, 3):
        what = f"has no header and {len(names)} columns; say which are meant, such as t=1,x=2,v=3"
        raise ParameterError("file", where, what)
    numbers = dict(zip(SAMPLE_COLUMNS, names, strict=False))
    columns = find_columns([*numbers], asked, where)
    return {name: numbers[column] for name, column in columns.items()}


def _number(cell: str, delimiter: str | None) -> float:
    """Return a cell as a float.

    Read Fortran exponents and, unless the `delimiter` is a comma, decimal commas too.
    """
    try:
        if "_" not in cell and cell.isascii():
            return float(cell)
        return number_of(cell)
    except ValueError:
        if delimiter == "," and "," in cell:
            raise
        return number_of(plain_number(cell))


def plain_number(cell: str) -> str:
    """Return the text of a number with a point for a decimal comma, and with e for the d of a Fortran exponent."""
    return re.sub(r"([\d.])[dD]([+-]?\d)", r"\1e\2", cell.replace(",", "."))


def _table(
    file: IO[bytes], choose: Choose, where: str
) -> tuple[str | None, dict[str, int], Iterator[tuple[int, list[str]]]]:
    """Return a text table's delimiter, the positions of columns that `choose` names, and its rows with line numbers."""
    lines = _lines(file, where)
    head = list(islice(lines, 1000))  # lines that may hold the header
    data = [i for i, (_, _, has_data) in enumerate(head) if has_data]
    # one may be the header: numpy.savetxt writes such
    if data:
        comments = head[: data[0]]
    else:
        comments = head
    if not head:
        raise ParameterError(
            "file", where, "is empty; its first line must name the columns, such as t,x,v"
        )
    # The second line shows the delimiter better than a header.
    samples = [head[i][1] for i in data[1::-1]] or [comments[-1][1]]
    delimiter = next((sign for sign in map(_delimiter, samples) if sign), None)

    def places(names: list[str]) -> dict[str, int]:
        found = choose(names)
        for name in found.values():
            if names.count(name) > 1:
                raise ParameterError(
                    "file", where, f"has {brief(name)!r} twice; there are: {names_text(names)}"
                )
        return {name: names.index(column) for name, column in found.items()}

    if data:
        first = _split_cells(head[data[0]][1], delimiter)
    else:
        first = []
    in_comments = [
        _split_cells(line.lstrip("".join(COMMENT_SIGNS) + " "), delimiter)
        for _, line, _ in comments[::-1]
    ]
    tried = [
        names
        for names in in_comments
        if not _are_numbers(names, None) and len(names) == (len(first) or len(names))
    ]
    has_header = not _are_numbers(
        first, delimiter
    )  # or it is a row with words, below a header that is a comment
    if has_header:
        usual = first
    else:
        usual = [str(i) for i in range(1, len(first) + 1)]
    wrong: list[ParameterError] = []
    for names in [usual, *tried] if has_header else [*tried, usual]:
        try:
            columns = places(names)
            width = len(names)
            break
        except ParameterError as error:  # of a comment it only says that it is no header
            if names is usual:
                wrong += [error]
            else:
                wrong += []
    else:
        raise wrong[0]
    begin = len(comments) + (has_header and names is usual)

    def rows() -> Iterator[tuple[int, list[str]]]:
        for number, text, has_data in chain(head[begin:], lines):
            if has_data:
                cells = _split_cells(text, delimiter)
                if len(cells) != width:
                    what = f"row {number} has {len(cells)} entries, the header {width}"
                    raise ParameterError("file", where, what)
                yield number, cells

    return delimiter, columns, rows()


def _lines(file: IO[bytes], where: str) -> Iterator[tuple[int, str, bool]]:
    """Yield each line of a text file that is not empty.

    Its number, its text, and whether it holds data.
    """
    empty = 0
    with io.TextIOWrapper(file, "utf-8-sig", newline=None) as text:
        for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE), ""), 1):
            if len(line) >= LONGEST_LINE or (number <= 10 and "\0" in line):
                raise ParameterError("file", where, "cannot be read: it is not text in lines")
            content = line.strip(" \t\n\r\v\f,;")
            has_data = bool(content) and not content.startswith(COMMENT_SIGNS)
            empty += not has_data
            if empty > MOST_EMPTY_LINES and empty > 0.9 * number:
                raise ParameterError("file", where, f"has {empty:,} lines without data")
            if content:
                yield number, line.strip("\n"), has_data


def _delimiter(line: str) -> str | None:
    """Return the character that separates the cells of a line; None if blanks do."""
    line = re.sub('"[^"]*"', "", line)
    if ";" in line or "\t" in line:
        if ";" in line:
            return ";"
        return "\t"
    cells = line.split()
    if "," in line and not (len(cells) > 1 and _are_numbers(cells, None)):
        return ","
    return None


def _split_cells(line: str, delimiter: str | None) -> list[str]:
    """Split a line of a table at its delimiter into cells."""
    if delimiter is None:
        return line.replace('"', " ").split()
    if '"' not in line:
        if " " not in line:
            return line.split(delimiter)
        return [cell.strip() for cell in line.split(delimiter)]
    return [
        cell.strip()
        for cell in next(
            csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True), []
        )
    ]


def _are_numbers(cells: list[str], delimiter: str | None) -> bool:
    """Return whether all cells are numbers."""
    with suppress(ValueError):
        for cell in cells:
            _number(cell, delimiter)
        return True
    return False


# -- JSON, arrays, tables of pyarrow -----------------------------------------------------------------------------------


def read_json(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the content of a JSON file, with Decimals for floats if all of it is wanted (`asked` is None)."""
    text = _whole(file, where).decode("utf-8-sig")
    if not text.strip():
        raise ParameterError("file", where, f"is empty; it must hold columns, such as {EXAMPLE}")

    def table(pairs: list[tuple[str, Any]]) -> Record:
        refuse_twice(where, (name for name, _ in pairs), asked)
        return dict(pairs)

    try:
        data = json.loads(
            text, object_pairs_hook=table, parse_float=Decimal if asked is None else None
        )
    except (ParameterError, json.JSONDecodeError):
        raise
    except ValueError:  # Python's own limit
        raise ParameterError(
            "file", where, "cannot be read: a number in it has thousands of digits"
        ) from None
    if isinstance(data, list):
        kinds = {type(each) for each in data}
    else:
        kinds = {type(data)}
    if asked is not None and kinds != {dict} and not (isinstance(data, list) and kinds == {list}):
        raise ParameterError("file", where, f"must hold columns, such as {EXAMPLE}")
    return data


def _read_numpy(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the content of a numpy file: its array, or its arrays by name."""
    data = np.load(file)
    if isinstance(data, np.ndarray):
        return data
    found: Record = {}
    with data:
        for name in data.files:
            try:
                if is_wanted(name, asked):
                    found[name] = data[name]
                else:
                    found[name] = None
            except ValueError:
                what = f"{name} must be an array of numbers (events, id: of text), not of Python objects"
                raise ParameterError("file", where, what) from None
    return found


def _read_parquet(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the wanted columns of a parquet file."""
    parquet = optional("pyarrow.parquet", "a parquet file", "tables").ParquetFile(file)
    names = parquet.schema_arrow.names
    table = parquet.read(columns=[name for name in names if is_wanted(name, asked)])
    return {
        name: table.column(name).to_numpy() if name in table.column_names else None
        for name in names
    }


def _read_feather(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the wanted columns of a feather file."""
    table = optional("pyarrow.feather", "a feather file", "tables").read_table(file)
    return {
        name: table.column(name).to_numpy() if is_wanted(name, asked) else None
        for name in table.column_names
    }


def _unwrapped(found: Record) -> Any:
    """Return the variables of a file by name.

    Of a file with a single array or struct return this alone.
    """
    if len(found) == 1:
        only = next(iter(found.values()))
    else:
        only = None
    if only is None or (np.ndim(only) == 0 and not isinstance(only, dict)):
        return found
    return only


# -- HDF5, also of MATLAB and Octave; text of Octave -------------------------------------------------------------------


def _read_hdf5(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the datasets in one group of an HDF5 or netCDF 4 file.

    The group nearest to the root that has any.
    """
    h5py = optional("h5py", "an HDF5 file", "tables")
    groups: dict[str, Record] = {}

    def visit(path: str, item: Any) -> None:
        """Enter the dataset `item` into `groups`.

        The cells of an Octave cell array go into one dict, by number.
        """
        # MATLAB keeps the targets of references in a group "#refs#", Octave x as x/type and
        # x/value.
        octave = "OCTAVE_NEW_FORMAT" in item.parent.attrs
        if (
            not isinstance(item, h5py.Dataset)
            or path.startswith("#")
            or (octave and path.endswith("/type"))
        ):
            return
        if octave:
            path = path.removesuffix("/value")
        cell = re.fullmatch(r"(.*)/value/_(\d+)", path)
        group, _, name = (cell[1] if cell else path).rpartition("/")
        if cell:
            groups.setdefault(group, {}).setdefault(name, {})[int(cell[2])] = item
        else:
            groups.setdefault(group, {})[name] = item

    with _opened_hdf5(h5py, file, where) as root:
        root.visititems(visit)
        if groups:
            found = groups[min(groups, key=lambda group: len(group.split("/")) if group else 0)]
        else:
            found = {}
        wanted = {name: len(found) == 1 or is_wanted(name, asked) for name in found}
        return _unwrapped(
            {
                name: _hdf5_value(item, where) if wanted[name] else None
                for name, item in found.items()
            }
        )


def _opened_hdf5(h5py: Any, file: IO[bytes], where: str) -> Any:
    """Open an HDF5 file by its name, or what is no file on the disk from a copy in memory."""
    # Not as an object of Python: with such, HDF5 crashes at data that it looks for in other files.
    name = getattr(file, "name", None)
    if name is not None and os.path.isfile(name):
        return h5py.File(os.fspath(name), "r", locking=False)
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_fapl_core(backing_store=False)
    access.set_file_image(_whole(file, where))
    return h5py.File(h5py.h5f.open(b"memory", h5py.h5f.ACC_RDONLY, access))


def _check_own(item: Any, where: str) -> None:
    """Raise ParameterError if the values of an HDF5 dataset are in other files than its own."""
    if item.is_virtual:
        kind = "a virtual dataset"
    elif item.external:
        kind = "kept in external raw storage"
    else:
        return
    what = f"{brief(item.name)} is {kind}: its values are in other files, which are not read"
    raise ParameterError("file", where, f"{what}; write them into this one")


def _hdf5_value(item: Any, where: str) -> Any:
    """Return the value of an HDF5 dataset, or the list of values in a dict of datasets (an Octave cell array)."""
    if isinstance(item, dict):
        return [_hdf5_value(item[i], where) for i in sorted(item)]
    _check_own(item, where)
    values = item[()]
    octave = "OCTAVE_NEW_FORMAT" in item.parent.attrs
    if "base" in (item.dtype.names or ()):
        base, limit, increment = values.tolist()
        return _octave_range(base, limit, increment, int(item.attrs["OCTAVE_RANGE_NELEM"]))
    if not isinstance(values, np.ndarray):
        return values
    if octave and "OCTAVE_EMPTY_MATRIX" in item.parent.attrs:
        return np.empty(0)
    if octave and _octave_type(item.parent, where).endswith("string"):
        texts = [
            bytes(row.astype(np.uint8)).decode("utf-8", "replace").strip()
            for row in np.atleast_2d(values.T)
        ]
        if len(texts) == 1:
            return texts[0]
        return texts
    if values.dtype.kind == "O":
        values = np.array(
            [each.decode() if isinstance(each, bytes) else each for each in values.ravel().tolist()]
        )
    if values.ndim > 1:
        return np.squeeze(values.T if octave else values)
    return values


def _octave_type(group: Any, where: str) -> str:
    """Return what Octave says about the type of the value in a group; "" if it says that elsewhere."""
    link = group.get("type", getlink=True)
    if type(link).__name__ != "HardLink":  # the others may lead to another file
        return ""
    _check_own(group["type"], where)
    return str(group["type"][()].decode())


def _octave_range(base: float, limit: float, increment: float, count: int) -> np.ndarray:
    """Return the numbers of a range that Octave has saved by its base, limit, increment and count."""
    values = base + increment * np.arange(count)  # rounding leads none beyond the limit
    if increment > 0:
        return np.minimum(values, limit)
    return np.maximum(values, limit)


def read_octave(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables in a text of Octave's `save` by name.

    The fields of a struct count as variables.
    """
    lines = iter(_whole(file, where).decode("utf-8-sig", "replace").splitlines())
    found = dict[str, Any]()
    name = ""
    cells = list[Any]()
    for line in lines:
        if line.startswith("# name: "):
            name = line[8:]
        if line.startswith("# type: "):
            kind = line.removeprefix("# type: ")
        else:
            kind = ""
        if kind == "cell":
            found[name] = cells = []
        elif kind and not re.search("complex|sparse|diagonal|struct", kind):
            value = _octave_value(kind, lines)
            if name == "<cell-element>":
                cells.append(value)
            else:
                found[name] = value
    return _unwrapped(found)


def _octave_value(kind: str, lines: Iterator[str]) -> Any:
    """Read the next value, of a named kind, from the lines of an Octave file.

    None if the kind is unknown.
    """

    def number(name: str, line: str = "") -> int:
        return int((line or next(lines)).removeprefix(f"# {name}: "))

    if kind.endswith("range"):
        next(lines)
        base, limit, increment = map(float, next(lines).split())
        return _octave_range(
            base, limit, increment, int((limit - base) / increment * (1 + 1e-15) + 1e-9) + 1
        )
    if kind.endswith("string"):
        texts = [next(lines).strip() if number("length") else "" for _ in range(number("elements"))]
        if len(texts) == 1:
            return texts[0]
        return texts
    if not kind.endswith("matrix"):
        if kind.endswith(("scalar", "bool")):
            return float(next(lines))
        return None
    sizes = next(lines)
    if sizes.startswith("# ndims: "):  # a number in each line
        shape = [int(size) for size in next(lines).split()]
        values = np.array(list(islice(lines, int(np.prod(shape)))), dtype=float)
        return np.squeeze(values.reshape(shape, order="F"))
    rows = number("rows", sizes)
    columns = number("columns")
    return np.squeeze(
        np.array(" ".join(islice(lines, rows)).split(), dtype=float).reshape(rows, columns)
    )


# -- MATLAB ------------------------------------------------------------------------------------------------------------

MAT_HEADER = 128


def _read_mat(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables of a MATLAB file by name, also of version 7.3, which is HDF5."""
    # perhaps behind a block of text
    begins = file.read(512 + 8)
    sign = b"\x89HDF\r\n\x1a\n"
    file.seek(0)
    if begins.startswith(sign) or begins.endswith(sign):
        return _read_hdf5(file, asked, where)
    data = _whole(file, where)
    if has_wrong_tags(data):
        raise ValueError
    from scipy.io import loadmat

    variables = loadmat(io.BytesIO(data), squeeze_me=True, struct_as_record=True)
    found = {name: value for name, value in variables.items() if not name.startswith("__")}
    for name, value in found.items():
        if (
            isinstance(value, np.ndarray) and value.dtype.names
        ):  # a struct with the columns as its fields
            found[name] = {field: value[field][()] for field in value.dtype.names}
    return _unwrapped(found)


def has_wrong_tags(data: bytes) -> bool:
    """Return whether a MATLAB file of version 5 has an unknown or overlong tag, at which scipy crashes."""
    order = {b"IM": "<", b"MI": ">"}.get(data[126:MAT_HEADER])
    if order is None:
        return False  # version 4, or no such file: scipy says so
    try:
        return not all(
            _is_sound(data, order, *tag, 1)
            for tag in _tags(data, order, MAT_HEADER, len(data), False)
        )
    except (struct.error, ValueError):
        return True


def _is_sound(data: bytes, order: str, kind: int, begin: int, end: int, depth: int) -> bool:
    """Return whether a MATLAB data element of type number `kind`, and every element nested in it, has a valid tag."""
    if kind != 14:  # no matrix: numbers, a packed matrix, which has a checksum of its own, or text
        return kind in (1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 15, 16, 17, 18)
    parts = list(_tags(data, order, begin, end, True))
    if parts:  # a matrix of numbers has as many as its flags say: flags, size, name, numbers
        (flags,) = struct.unpack_from(f"{order}I", data, parts[0][1])
        own = flags & 0xFF
        complex_too = flags >> 11 & 1
        if own in range(5, 16) and len(parts) != 4 + complex_too + 2 * (
            own == 5
        ):  # sparse: two lists of places
            return False
    return depth <= 50 and all(_is_sound(data, order, *part, depth + 1) for part in parts)


def _tags(
    data: bytes, order: str, at: int, end: int, inside: bool
) -> Iterator[tuple[int, int, int]]:
    """Yield the tags of the data elements between two positions of a MATLAB file.

    Number of the type, begin and end.

    Elements `inside` a matrix are followed by zeros up to a multiple of 8 bytes. `order` is the
    byte order.
    """
    while at < end:
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind >> 16:  # a short one, in the tag itself
            yield kind & 0xFFFF, at + 4, at + 8
            at += 8
            continue
        begin = at + 8
        at = at + 8 + size
        if at > end:
            raise ValueError("an element reaches beyond its end")
        yield kind, begin, at
        if inside:
            at += -size % 8
        else:
            at += 0


#: The formats other than text, by suffix.
FILE_KINDS: dict[str, tuple[str, Reader]] = {
    ".json": ("", read_json),
    **dict.fromkeys((".npz", ".npy"), ("an npz file", _read_numpy)),
    ".mat": ("a MATLAB file", _read_mat),
    **dict.fromkeys((".parquet", ".pq"), ("a parquet file", _read_parquet)),
    **dict.fromkeys((".feather", ".arrow"), ("a feather file", _read_feather)),
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".nc"), ("an HDF5 file", _read_hdf5)),
}
SUFFIXES = (*TEXT_SUFFIXES, *FILE_KINDS)
