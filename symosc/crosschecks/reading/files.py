"""Open a file of any format, or standard input, and read what it holds as named columns."""

from __future__ import annotations

import bz2
import gzip
import io
import lzma
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar

from symosc.base.errors import ParameterError, SymoscError, brief
from symosc.base.files import STDIN_CLOSED, STDOUT, read_path
from symosc.crosschecks.reading import formats
from symosc.crosschecks.reading.text import read_text

#: Return what a file holds: (file, its name for messages).
Reader = Callable[[io.BufferedReader, str], Any]
Result = TypeVar("Result")


class Format(NamedTuple):
    """A format of files: its name before "file" in messages, "" if those of its reader are clear,
    and the reader.
    """

    name: str
    read: Reader


TEXT = Format("", read_text)
TEXT_SUFFIXES = (".csv", ".tsv", ".txt", ".dat", ".out", ".asc")
OCTAVE = Format("Octave", formats.read_octave)
#: The formats other than text, by suffix.
FORMATS: dict[str, Format] = {
    **dict.fromkeys((".json", ".jsonl", ".ndjson"), Format("", formats.read_json)),
    **dict.fromkeys((".npz", ".npy"), Format("npz", formats.read_numpy)),
    ".mat": Format("MATLAB", formats.read_mat),
    **dict.fromkeys((".parquet", ".pq"), Format("parquet", formats.read_parquet)),
    **dict.fromkeys((".feather", ".arrow"), Format("feather", formats.read_feather)),
    **dict.fromkeys((".h5", ".hdf5", ".hdf"), Format("HDF5", formats.read_hdf5)),
    ".nc": Format("netCDF", formats.read_netcdf),
}
SUFFIXES = (*TEXT_SUFFIXES, *FORMATS)
PACKED: dict[str, Callable[[Any], Any]] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
#: How files without a suffix begin, standard input above all.
BEGINNINGS = {
    b"\x1f\x8b": ".gz", b"BZh": ".bz2", b"\xfd7zXZ": ".xz",
    b"PK\x03\x04": ".npz", b"\x93NUMPY": ".npy", b"PAR1": ".parquet", b"ARROW1": ".feather",
    b"\x89HDF": ".h5", b"CDF": ".nc", b"MATLAB": ".mat", b"{": ".json", b"[": ".json",
}  # fmt: skip
OCTAVE_BEGINNING = b"# Created by Octave"
# So many bytes show what a file without a suffix is.
BEGINNING_BYTES = 32


def read_file(
    path: str | Path, where: str, use: Callable[[Any], Result], text: Reader = read_text
) -> Result:
    """Return what `use` makes of the content of a file: a table, columns by name, rows or an array.

    Columns may be read while the file is open, so `use` reads those that it needs; `text` reads a
    table that is text. Any error is a ParameterError, which calls the file `where`.
    """
    library = ""
    try:
        with _opened(path, where) as file:
            library, read = _format_of(path, file, where)
            if read is read_text:
                read = text
            if library and isinstance(file.raw, _Unpacked):  # libraries seek, which it cannot
                file = io.BufferedReader(io.BytesIO(formats.whole(file, where)))
            return use(read(file, where))
    except SymoscError:
        raise
    except Exception as error:
        raise ParameterError("file", where, _reason(error, library)) from None


def _reason(error: Exception, library: str) -> str:
    """Return why a file cannot be read, given the error of the `library` that reads its format."""
    first = str(error).partition("\n")[0]
    if isinstance(error, MemoryError):
        return "cannot be read: it does not fit into memory"
    if library:
        said = f": {brief(first)}" if first else ""
        return f"is not a readable {library} file, or is damaged{said}"
    match error:
        case gzip.BadGzipFile() | lzma.LZMAError() | zlib.error() | EOFError():
            reason = "it is damaged, or cut off"
        case UnicodeError():
            reason = "it is not text in UTF-8"
        case RecursionError():
            reason = "its brackets are nested too deeply"
        case _:
            reason = getattr(error, "strerror", None) or first
    return f"cannot be read: {reason}"


class _Unpacked(io.RawIOBase):
    """A decompressed file of limited size: a small file may decompress to a huge one."""

    def __init__(self, inner: IO[bytes], where: str) -> None:
        self.inner = inner
        self.where = where
        self.count = 0

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: Any) -> int:
        data = self.inner.read(len(buffer))
        buffer[: len(data)] = data
        self.count += len(data)
        formats.check_size(self.count, self.where)
        return len(data)

    def close(self) -> None:
        self.inner.close()
        super().close()


def _opened(path: str | Path, where: str) -> io.BufferedReader:
    """Open a file or standard input to read bytes, decompressed if it is compressed."""
    if path == STDOUT:
        if sys.stdin is None:
            raise ParameterError("file", where, STDIN_CLOSED)
        data = formats.whole(sys.stdin.buffer, where)
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


def _format_of(path: str | Path, file: io.BufferedReader, where: str) -> Format:
    """Return the format of a file, by its suffix or else by how it begins."""
    suffix = "" if path == STDOUT else suffix_of(path)
    if suffix and suffix not in SUFFIXES:
        what = f"must end in {', '.join(SUFFIXES)}, and perhaps {', '.join(PACKED)}"
        raise ParameterError("file", where, what)
    beginning = file.peek(BEGINNING_BYTES).lstrip()[:BEGINNING_BYTES]
    if beginning.startswith(OCTAVE_BEGINNING) and suffix in ("", ".mat", *TEXT_SUFFIXES):
        return OCTAVE
    return FORMATS.get(suffix or _suffix_of_content(beginning), TEXT)


def _suffix_of_content(beginning: bytes) -> str:
    """Return the suffix of the format whose files begin with these bytes, ".txt" if there is
    none.
    """
    suffixes = (suffix for sign, suffix in BEGINNINGS.items() if beginning.startswith(sign))
    return next(suffixes, ".txt")


def suffix_of(path: str | Path) -> str:
    """Return the suffix of a file in lower case, without that of a compression.

    "" if it has none.
    """
    suffixes = (suffix.lower() for suffix in reversed(Path(path).suffixes))
    return next((suffix for suffix in suffixes if suffix not in PACKED), "")
