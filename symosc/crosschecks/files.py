"""Samples of somebody's solution, from files: what a file is, how it is opened, and what may be wrong with it."""

from __future__ import annotations

import bz2
import csv
import gzip
import io
import lzma
import sys
import zlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

from symosc.crosschecks.columns import asked_columns
from symosc.crosschecks.formats import Asked, read_feather, read_hdf5, read_json, read_mat, read_npz, read_parquet
from symosc.crosschecks.objects import SolverTask, solutions_in
from symosc.crosschecks.samples import Samples
from symosc.crosschecks.text_tables import TextColumns, read_text
from symosc.errors import ParameterError
from symosc.files import STDOUT, read_path

#: What reads a file, by its suffix.
FILE_READERS: dict[str, Callable[[IO[bytes], Asked, str], Any]] = {
    **dict.fromkeys((".csv", ".tsv", ".txt", ".dat", ".out", ".asc"), read_text),
    ".json": read_json,
    **dict.fromkeys((".npz", ".npy"), read_npz),
    ".mat": read_mat,
    **dict.fromkeys((".parquet", ".pq"), read_parquet),
    **dict.fromkeys((".feather", ".arrow"), read_feather),
    **dict.fromkeys((".h5", ".hdf5", ".hdf", ".nc"), read_hdf5),
}
PACKED: dict[str, Callable[[Any], Any]] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
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
PACKED_BEGINNINGS = ((b"\x1f\x8b", ".gz"), (b"BZh", ".bz2"), (b"\xfd7zXZ", ".xz"))
STDIN_NAME = "standard input"


def read_samples(source: Any, columns: Mapping[str, str | None] | None = None) -> Samples:
    """Read one solution; see `read_solutions`.

    Raises
    ------
    ParameterError
        If there are several.
    """
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
        return [named for path in source for named in _named(path, read_solutions(path, columns, problem))]
    if not isinstance(source, (str, Path)):
        return solutions_in(source, asked, problem)
    where = STDIN_NAME if source == STDOUT else str(source)
    content = _read_file(source, asked, where)
    if isinstance(content, TextColumns):  # what was asked for has been found
        asked = {}
    return solutions_in(content, asked, problem, where)


def _named(path: str | Path, found: list[Samples]) -> list[Samples]:
    return [replace(each, name=f"{path}:{each.name}" if each.name else str(path)) for each in found]


def _read_file(path: str | Path, asked: Asked, where: str) -> Any:
    """Return what a file holds: columns, an array, a table or a list."""
    try:
        with _opened(path) as file:
            return _reader(path, file, where)(file, asked, where)
    except ParameterError:
        raise
    except (gzip.BadGzipFile, lzma.LZMAError, zlib.error, EOFError):
        raise ParameterError("file", where, "cannot be read: it is damaged, or cut off") from None
    except OSError as error:
        raise ParameterError("file", where, f"cannot be read: {error.strerror or error}") from None
    except UnicodeError:
        raise ParameterError("file", where, "cannot be read: it is not text in UTF-8") from None
    except RecursionError:
        raise ParameterError("file", where, "cannot be read: its brackets are nested too deeply") from None
    except MemoryError:
        raise ParameterError("file", where, "cannot be read: it does not fit into memory") from None
    except (ValueError, csv.Error) as error:
        raise ParameterError("file", where, f"cannot be read: {error}") from None


def _opened(path: str | Path) -> IO[bytes]:
    """Return a file, or standard input, unpacked, in which one can look ahead and go back."""
    if path == STDOUT:
        data = sys.stdin.buffer.read()
        unpack = next((PACKED[suffix] for sign, suffix in PACKED_BEGINNINGS if data.startswith(sign)), None)
        file: Any = io.BytesIO(data)
        return io.BufferedReader(unpack(file) if unpack else file)
    place = Path(read_path(path))
    if place.is_dir():
        raise IsADirectoryError(None, "it is a folder")
    unpack = PACKED.get(place.suffix.lower())
    return io.BufferedReader(unpack(place)) if unpack else place.open("rb")


def _reader(path: str | Path, file: IO[bytes], where: str) -> Callable[[IO[bytes], Asked, str], Any]:
    name = "" if path == STDOUT else Path(path)
    suffixes = [suffix.lower() for suffix in name.suffixes] if isinstance(name, Path) else []
    suffix = next((each for each in suffixes[::-1] if each not in PACKED), "")
    if suffix in FILE_READERS:
        return FILE_READERS[suffix]
    if suffix:
        raise ParameterError("file", where, f"must end in {', '.join(FILE_READERS)}, and perhaps {', '.join(PACKED)}")
    beginning = file.peek(16).lstrip()[:16] if isinstance(file, io.BufferedReader) else b""
    return FILE_READERS[next((suffix for sign, suffix in BEGINNINGS if beginning.startswith(sign)), ".txt")]
