"""One function for each format of files: it returns columns by name, arrays, or JSON values.

The libraries are imported when a file of theirs is read. None of them opens another file, or builds
objects of Python that a file describes.
"""

from __future__ import annotations

import io
import json
import os
import re
import struct
from collections.abc import Iterator
from decimal import Decimal
from itertools import islice
from typing import IO, Any, NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, brief, optional
from symosc.crosschecks.reading.names import Asked, is_wanted, refuse_twice

#: The largest unpacked size, and the largest file that must be in memory as a whole.
MOST_BYTES = 2_000_000_000
EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'


def check_size(count: int, where: str) -> None:
    """Raise ParameterError if a file has too many bytes."""
    if count > MOST_BYTES:
        raise ParameterError("file", where, f"is larger than {MOST_BYTES:.0e} bytes")


def whole(file: IO[bytes], where: str) -> bytes:
    """Return all bytes of a file; ParameterError if they are too many."""
    data = file.read(MOST_BYTES + 1)
    check_size(len(data), where)
    return data


def read_json(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the content of a JSON file, with Decimals for floats if all of it is wanted (`asked`
    is None).
    """
    text = whole(file, where).decode("utf-8-sig")
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
    rows = data if isinstance(data, list) else [data]
    kinds = {type(row) for row in rows}
    are_columns = kinds == {dict} or (isinstance(data, list) and kinds == {list})
    if asked is not None and not are_columns:
        raise ParameterError("file", where, f"must hold columns, such as {EXAMPLE}")
    return data


def read_numpy(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the content of a numpy file: its array, or its arrays by name.

    As with the other formats the value of a column that is not wanted is None.
    """
    data = np.load(file)
    if isinstance(data, np.ndarray):
        return data
    columns: Record = {}
    with data:
        for name in data.files:
            try:
                columns[name] = data[name] if is_wanted(name, asked) else None
            except ValueError:
                allowed = "must be an array of numbers (events, id: of text), not of Python objects"
                raise ParameterError("file", where, f"{name} {allowed}") from None
    return columns


def read_parquet(file: IO[bytes], asked: Asked | None, where: str) -> Record:
    """Return the wanted columns of a parquet file."""
    parquet = optional("pyarrow.parquet", "a parquet file", "tables").ParquetFile(file)
    names = parquet.schema_arrow.names
    table = parquet.read(columns=[name for name in names if is_wanted(name, asked)])
    return {
        name: table.column(name).to_numpy() if name in table.column_names else None
        for name in names
    }


def read_feather(file: IO[bytes], asked: Asked | None, where: str) -> Record:
    """Return the wanted columns of a feather file."""
    table = optional("pyarrow.feather", "a feather file", "tables").read_table(file)
    return {
        name: table.column(name).to_numpy() if is_wanted(name, asked) else None
        for name in table.column_names
    }


def flattened(variables: Record, prefix: str = "") -> Record:
    """Return the variables of a file by name, with those in a struct after the struct's name.

    A struct is a dict or a record of numpy; `t` in `run` in `out` is called "out.run.t".
    """
    columns: Record = {}
    for name, value in variables.items():
        if isinstance(value, np.ndarray) and value.dtype.names:
            value = {field: value[field][()] for field in value.dtype.names}
        if isinstance(value, dict):
            columns |= flattened(value, f"{prefix}{name}.")
        else:
            columns[f"{prefix}{name}"] = value
    return columns


def _content(variables: Record) -> Any:
    """Return the variables of a file as columns; of a file with a single array this alone.

    The name of a struct in which all of them are is left out of their names.
    """
    columns = flattened(variables)
    while columns:
        parts = [name.partition(".") for name in columns]
        structs = {struct for struct, _, _ in parts}
        if len(structs) > 1 or not all(dot for _, dot, _ in parts):
            break
        fields = [field for _, _, field in parts]
        columns = dict(zip(fields, columns.values(), strict=True))
    if len(columns) == 1:
        (only,) = columns.values()
        if only is not None and np.ndim(only):
            return only
    return columns


# -- HDF5, also of MATLAB and Octave; text of Octave -----------------------------------------------


def read_hdf5(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the datasets in one group of an HDF5 or netCDF 4 file, the one nearest to the root
    that has any.
    """
    h5py = optional("h5py", "an HDF5 file", "tables")
    groups: dict[str, Record] = {}

    def visit(path: str, item: Any) -> None:
        """Enter the dataset `item` into `groups`.

        The cells of an Octave cell array go into one dict, by number.
        """
        # MATLAB keeps the targets of references in a group "#refs#", Octave x as x/type and
        # x/value.
        is_octave = "OCTAVE_NEW_FORMAT" in item.parent.attrs
        if not isinstance(item, h5py.Dataset) or path.startswith("#"):
            return
        if is_octave and path.endswith("/type"):
            return
        if is_octave:
            path = path.removesuffix("/value")
        cell = re.fullmatch(r"(.*)/value/_(\d+)", path)
        if cell:
            array, number = cell.groups()
            group, _, name = array.rpartition("/")
            groups.setdefault(group, {}).setdefault(name, {})[int(number)] = item
        else:
            group, _, name = path.rpartition("/")
            groups.setdefault(group, {})[name] = item

    with _opened_hdf5(h5py, file, where) as root:
        root.visititems(visit)
        if not groups:
            return {}
        nearest = min(groups, key=lambda group: len(group.split("/")) if group else 0)
        items = groups[nearest]
        columns: Record = {}
        for name, item in items.items():
            is_read = len(items) == 1 or is_wanted(name, asked)
            columns[name] = _hdf5_value(item, where) if is_read else None
        return _content(columns)


def _opened_hdf5(h5py: Any, file: IO[bytes], where: str) -> Any:
    """Open an HDF5 file by its name, or what is no file on the disk from a copy in memory."""
    # Not as an object of Python: with such, HDF5 crashes at data that it looks for in other files.
    name = getattr(file, "name", None)
    if name is not None and os.path.isfile(name):
        return h5py.File(os.fspath(name), "r", locking=False)
    access = h5py.h5p.create(h5py.h5p.FILE_ACCESS)
    access.set_fapl_core(backing_store=False)
    access.set_file_image(whole(file, where))
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
    """Return the value of an HDF5 dataset, or the list of values in a dict of datasets (an Octave
    cell array).
    """
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
        cells = values.ravel().tolist()
        values = np.array([cell.decode() if isinstance(cell, bytes) else cell for cell in cells])
    if octave:
        values = values.T
    return np.squeeze(values) if values.ndim > 1 else values


def _octave_type(group: Any, where: str) -> str:
    """Return what Octave says about the type of the value in a group; "" if it says that
    elsewhere.
    """
    link = group.get("type", getlink=True)
    if type(link).__name__ != "HardLink":  # the others may lead to another file
        return ""
    _check_own(group["type"], where)
    return str(group["type"][()].decode())


def _octave_range(base: float, limit: float, increment: float, count: int) -> np.ndarray:
    """Return the numbers of a range that Octave has saved by its base, limit, increment and
    count.
    """
    values = base + increment * np.arange(count)  # rounding leads none beyond the limit
    if increment > 0:
        return np.minimum(values, limit)
    return np.maximum(values, limit)


def read_octave(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables in a text of Octave's `save` by name.

    The fields of a struct count as variables.
    """
    lines = iter(whole(file, where).decode("utf-8-sig", "replace").splitlines())
    variables = dict[str, Any]()
    name = ""
    cells = list[Any]()
    for line in lines:
        if line.startswith("# name: "):
            name = line.removeprefix("# name: ")
        kind = ""
        if line.startswith("# type: "):
            kind = line.removeprefix("# type: ")
        if kind == "cell":
            cells = []
            variables[name] = cells
        elif kind and not re.search("complex|sparse|diagonal|struct", kind):
            value = _octave_value(kind, lines)
            if name == "<cell-element>":
                cells.append(value)
            else:
                variables[name] = value
    return _content(variables)


def _octave_value(kind: str, lines: Iterator[str]) -> Any:
    """Read the next value, of a named kind, from the lines of an Octave file.

    None if the kind is unknown.
    """

    def number(name: str, line: str = "") -> int:
        """Return the number in a line "# name: number", which is the next one if none is given."""
        return int((line or next(lines)).removeprefix(f"# {name}: "))

    if kind.endswith("range"):
        next(lines)  # a comment that names the three numbers
        base, limit, increment = map(float, next(lines).split())
        # Rounding of the quotient must not lose the last number.
        count = int((limit - base) / increment * (1 + 1e-15) + 1e-9) + 1
        return _octave_range(base, limit, increment, count)
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
    texts = " ".join(islice(lines, rows)).split()
    return np.squeeze(np.array(texts, dtype=float).reshape(rows, columns))


# -- MATLAB ----------------------------------------------------------------------------------------

MAT_HEADER = 128
# Types of data elements of version 5: a matrix, and numbers, a packed matrix, or text.
MATRIX_TYPE = 14
OTHER_TYPES = (1, 2, 3, 4, 5, 6, 7, 9, 12, 13, 15, 16, 17, 18)
# Classes of matrices: a sparse one is the first that holds numbers.
SPARSE_CLASS = 5
NUMBER_CLASSES = range(SPARSE_CLASS, 16)
DEEPEST_NESTING = 50


def read_mat(file: IO[bytes], asked: Asked | None, where: str) -> Any:
    """Return the variables of a MATLAB file by name, also of version 7.3, which is HDF5."""
    # HDF5 begins with its sign, perhaps behind MATLAB's block of 512 bytes of text.
    sign = b"\x89HDF\r\n\x1a\n"
    beginning = file.read(512 + len(sign))
    file.seek(0)
    if beginning.startswith(sign) or beginning.endswith(sign):
        return read_hdf5(file, asked, where)
    data = whole(file, where)
    if has_wrong_tags(data):
        raise ValueError
    from scipy.io import loadmat

    variables = loadmat(io.BytesIO(data), squeeze_me=True, struct_as_record=True)
    return _content({name: value for name, value in variables.items() if name[:2] != "__"})


def has_wrong_tags(data: bytes) -> bool:
    """Return whether a MATLAB file of version 5 has an unknown or overlong tag, at which scipy
    crashes.
    """
    order = {b"IM": "<", b"MI": ">"}.get(data[126:MAT_HEADER])
    if order is None:
        return False  # version 4, or no such file: scipy says so
    try:
        tags = _tags(data, order, MAT_HEADER, len(data), False)
        return not all(_is_sound(data, order, tag, 1) for tag in tags)
    except (struct.error, ValueError):
        return True


class Tag(NamedTuple):
    """The number of the type of a MATLAB data element, and where its content begins and ends."""

    kind: int
    begin: int
    end: int


def _is_sound(data: bytes, order: str, tag: Tag, depth: int) -> bool:
    """Return whether a MATLAB data element, and every element nested in it, has a valid tag and as
    many parts as its class needs, and is not nested too deeply.
    """
    if tag.kind != MATRIX_TYPE:  # a packed matrix has a checksum of its own
        return tag.kind in OTHER_TYPES
    parts = list(_tags(data, order, tag.begin, tag.end, True))
    if parts:
        (flags,) = struct.unpack_from(f"{order}I", data, parts[0].begin)
        matrix_class = flags & 0xFF
        imaginary_parts = flags >> 11 & 1
        index_lists = 2 if matrix_class == SPARSE_CLASS else 0  # of rows and of columns
        # A matrix of numbers has these parts: flags, size, name, numbers.
        expected = 4 + imaginary_parts + index_lists
        if matrix_class in NUMBER_CLASSES and len(parts) != expected:
            return False
    are_sound = (_is_sound(data, order, part, depth + 1) for part in parts)
    return depth <= DEEPEST_NESTING and all(are_sound)


def _tags(data: bytes, order: str, at: int, end: int, inside: bool) -> Iterator[Tag]:
    """Yield the tags of the data elements between two positions of a MATLAB file.

    Elements `inside` a matrix are followed by zeros up to a multiple of 8 bytes. `order` is the
    byte order.
    """
    while at < end:
        kind, size = struct.unpack_from(f"{order}II", data, at)
        if kind >> 16:  # a short one, in the tag itself
            yield Tag(kind & 0xFFFF, at + 4, at + 8)
            at += 8
            continue
        begin = at + 8
        at = at + 8 + size
        if at > end:
            raise ValueError("an element reaches beyond its end")
        yield Tag(kind, begin, at)
        if inside:
            at += -size % 8
