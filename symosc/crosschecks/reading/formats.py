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
from collections.abc import Iterator, Mapping
from functools import partial
from itertools import islice
from typing import IO, Any, NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError, brief, optional
from symosc.crosschecks.reading.names import is_usual
from symosc.crosschecks.reading.tables import ColumnTable, Stored, flattened

#: The largest unpacked size, and the largest file that must be in memory as a whole.
MOST_BYTES = 2_000_000_000
#: Of so many values advice about columns is made.
ADVICE = 50
ARROW_SIGN = b"ARROW1"
FEATHER_1_SIGN = b"FEA1"
EXAMPLE = '{"t": [...], "x": [...], "v": [...]}'
#: How often one array may be nested in others.
DEEPEST_NESTING = 50


def check_size(count: int, where: str) -> None:
    """Raise ParameterError if a file has too many bytes."""
    if count > MOST_BYTES:
        raise ParameterError("file", where, f"is larger than {MOST_BYTES:.0e} bytes")


def whole(file: IO[bytes], where: str) -> bytes:
    """Return all bytes of a file; ParameterError if they are too many."""
    data = file.read(MOST_BYTES + 1)
    check_size(len(data), where)
    return data


# -- JSON ------------------------------------------------------------------------------------------


def read_json(file: IO[bytes], where: str) -> Any:
    """Return the content of a JSON file: columns by name, or a list of rows.

    A value in each line, as in .jsonl, is a row.
    """
    data = whole(file, where)
    text = data.decode(json.detect_encoding(data)).removeprefix("\ufeff")
    if not text.strip():
        raise ParameterError("file", where, f"is empty; it must hold columns, such as {EXAMPLE}")

    def table(pairs: list[tuple[str, Any]]) -> Record:
        content = dict(pairs)
        if len(content) < len(pairs):
            names = [name for name, _ in pairs if is_usual(name)]
            twice = [name for name in content if names.count(name) > 1]
            if twice:
                raise ParameterError("file", where, f"has {brief(twice[0])!r} twice")
        return content

    decode = partial(json.loads, object_pairs_hook=table)
    try:
        try:
            content = decode(text)
        except json.JSONDecodeError as error:
            lines = [line for line in text.splitlines() if line.strip()]
            if error.msg != "Extra data" or len(lines) < 2:
                raise
            content = [decode(line) for line in lines]
    except (ParameterError, json.JSONDecodeError):
        raise
    except ValueError:  # Python's own limit
        raise ParameterError(
            "file", where, "cannot be read: a number in it has thousands of digits"
        ) from None
    content = _unpacked(content)
    rows = content if isinstance(content, list) else [content]
    kinds = {type(row) for row in rows}
    if kinds != {dict} and not (isinstance(content, list) and kinds == {list}):
        raise ParameterError("file", where, f"must hold columns, such as {EXAMPLE}")
    return content


def _unpacked(content: Any) -> Any:
    """Return the columns or rows in what pandas writes with orient="split", "table", "index" or
    "columns"; other content as it is.
    """
    if not isinstance(content, dict) or not content:
        return content
    rows = content.get("data")
    names = content.get("columns")
    if isinstance(rows, list) and isinstance(names, list):
        return [names, *rows]
    if isinstance(rows, list) and "schema" in content:
        return rows
    values = list(content.values())
    if not all(isinstance(value, dict) and value for value in values):
        return content
    if all(map(str.isdecimal, content)):  # rows by number
        return values
    if all(all(map(str.isdecimal, value)) for value in values):
        return {name: list(value.values()) for name, value in content.items()}
    return content


# -- numpy, parquet, feather -----------------------------------------------------------------------


def read_numpy(file: IO[bytes], where: str) -> Any:
    """Return the content of a numpy file: its array, or its arrays by name.

    Arrays that numpy has named, arr_0, arr_1, ..., are a list.
    """
    data = np.load(file)
    if isinstance(data, np.ndarray):
        return data
    columns: Record = {}
    with data:
        for name in data.files:
            try:
                columns[name] = data[name]
            except ValueError:
                columns[name] = Stored((), partial(_refuse_objects, name, where))
    if list(columns) == [f"arr_{i}" for i in range(len(columns))]:
        return tuple(columns.values()) if len(columns) > 1 else columns["arr_0"]
    return columns


def _refuse_objects(name: str, where: str) -> None:
    """Raise ParameterError for an array of Python objects, when it is needed."""
    allowed = "must be an array of numbers (events, id: of text), not of Python objects"
    raise ParameterError("file", where, f"{name} {allowed}")


def read_parquet(file: IO[bytes], where: str) -> ColumnTable:
    """Return the table in a parquet file, whose columns are read when they are chosen."""
    parquet = optional("pyarrow.parquet", "a parquet file", "tables").ParquetFile(file)
    names = list(parquet.schema_arrow.names)

    def load(places: Mapping[str, int]) -> Record:
        table = parquet.read(columns=[names[place] for place in places.values()])
        return {role: table.column(names[place]).to_numpy() for role, place in places.items()}

    return ColumnTable([names], load, peek=lambda place: load({"": place})[""][:ADVICE])


def read_feather(file: IO[bytes], where: str) -> ColumnTable:
    """Return the table in a feather file, or in a stream of Arrow."""
    arrow = optional("pyarrow.feather", "a feather file", "tables")
    beginning = file.read(len(ARROW_SIGN))
    file.seek(0)
    if beginning == ARROW_SIGN or beginning == FEATHER_1_SIGN + beginning[4:]:
        table = arrow.read_table(file)
    else:
        table = optional("pyarrow", "a feather file", "tables").ipc.open_stream(file).read_all()

    def load(places: Mapping[str, int]) -> Record:
        return {role: table.column(place).to_numpy() for role, place in places.items()}

    return ColumnTable(
        [list(table.column_names)], load, peek=lambda place: load({"": place})[""][:ADVICE]
    )


def read_netcdf(file: IO[bytes], where: str) -> Any:
    """Return the variables of a netCDF file, of version 3 or of version 4, which is HDF5."""
    sign = file.read(3)
    file.seek(0)
    if sign != b"CDF":
        return read_hdf5(file, where)
    from scipy.io import netcdf_file

    with netcdf_file(io.BytesIO(whole(file, where)), "r", mmap=False) as data:
        return {name: np.array(variable[...]) for name, variable in data.variables.items()}


# -- HDF5, also of MATLAB and Octave; text of Octave -----------------------------------------------


def read_hdf5(file: IO[bytes], where: str) -> Record:
    """Return the datasets of an HDF5 or netCDF 4 file by their paths, with dots.

    They are read when they are needed, while the file is open.
    """
    h5py = optional("h5py", "an HDF5 file", "tables")
    columns: Record = {}

    def visit(path: str, item: Any) -> None:
        """Enter the dataset `item`; the cells of an Octave cell array go into one dict, by number."""
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
            name, number = cell.groups()
            columns.setdefault(name.replace("/", "."), {})[int(number)] = item
        else:
            columns[path.replace("/", ".")] = item

    root = _opened_hdf5(h5py, file, where)
    root.visititems(visit)
    return _named_by_text({name: _stored(item, where) for name, item in columns.items()})


def _stored(item: Any, where: str) -> Any:
    """Return a dataset as a column that is read when it is needed; texts and records at once."""
    is_plain = not isinstance(item, dict) and item.dtype.kind in "iuf"
    if is_plain and "OCTAVE_NEW_FORMAT" not in item.parent.attrs:
        shape = tuple(size for size in item.shape if size != 1) or (1,) * min(item.ndim, 1)
        if item.attrs.get("MATLAB_class") == b"char":
            return "".join(map(chr, np.ravel(item[()]).tolist()))
        return Stored(shape, partial(_hdf5_value, item, where))
    try:
        return _hdf5_value(item, where)
    except (ParameterError, TypeError, ValueError, OSError) as error:
        return Stored((), partial(_raise, error))


def _raise(error: Exception) -> None:
    raise error


def _named_by_text(columns: Record) -> Record:
    """Return columns with the names in a dataset of texts for the rows or columns of the matrix
    beside it.
    """
    texts = {name: value.tolist() for name, value in columns.items()
             if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind == "U"}  # fmt: skip
    matrices = [name for name, value in columns.items() if len(getattr(value, "shape", ())) == 2]
    if len(matrices) != 1:
        return columns
    (matrix,) = matrices
    values = np.asarray(columns[matrix])
    fitting = [own for own, names in texts.items() if len(set(names)) == len(names) in values.shape]
    if not fitting:
        return columns
    names = texts[fitting[0]]
    rows = values if len(values) == len(names) else values.T
    others = {name: value for name, value in columns.items() if name not in (*texts, matrix)}
    return others | dict(zip(names, rows, strict=True))


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
        cells = [item.file[cell] if type(cell).__name__ == "Reference" else cell
                 for cell in values.ravel().tolist()]  # fmt: skip
        values = np.empty(len(cells), dtype=object)
        for i, cell in enumerate(cells):
            values[i] = _hdf5_value(cell, where) if hasattr(cell, "parent") else cell
            if isinstance(cell, bytes):
                values[i] = cell.decode()
        if all(isinstance(cell, str) for cell in values):
            values = values.astype(str)
    if values.dtype.kind == "S":
        values = np.char.decode(values, "utf-8", "replace")
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


def read_octave(file: IO[bytes], where: str) -> Any:
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
    return variables


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


def read_mat(file: IO[bytes], where: str) -> Record:
    """Return the variables of a MATLAB file by name, also of version 7.3, which is HDF5."""
    # HDF5 begins with its sign, perhaps behind MATLAB's block of 512 bytes of text.
    sign = b"\x89HDF\r\n\x1a\n"
    beginning = file.read(512 + len(sign))
    file.seek(0)
    if beginning.startswith(sign) or beginning.endswith(sign):
        return _of_matlab(flattened(read_hdf5(file, where)))
    data = whole(file, where)
    if has_wrong_tags(data):
        raise ValueError
    from scipy.io import loadmat

    variables = loadmat(io.BytesIO(data), squeeze_me=True, struct_as_record=True)
    variables = {name: value for name, value in variables.items() if name[:2] != "__"}
    if {"Aclass", "name", "dataInfo"} <= variables.keys():
        return _of_modelica(loadmat(io.BytesIO(data)))
    plain = {name: value for name, value in variables.items() if not _is_object(value)}
    if variables and not plain:
        what = "holds objects of MATLAB, such as a table or a timeseries, which MATLAB alone reads"
        raise ParameterError("file", where, f"{what}; save arrays: save run.mat t x v")
    return _of_matlab(flattened(plain))


def _is_object(value: Any) -> bool:
    """Return whether a variable is an object of a class of MATLAB."""
    return type(value).__name__ in ("MatlabOpaque", "MatlabFunction", "MatlabObject")


def _of_matlab(columns: Record) -> Record:
    """Return variables with the usual names of what MATLAB's and Simulink's results hold."""
    renamed: Record = {}
    for name, value in columns.items():
        path, _, last = name.rpartition(".")
        prefix = f"{path}." if path else ""
        # sol = ode45(...) has times x and states y.
        if last == "x" and {f"{prefix}solver", f"{prefix}y"} <= columns.keys():
            renamed[f"{prefix}t"] = value
            continue
        # A structure with time has signals, which may have labels.
        labels = _labels(columns, prefix)
        signal = re.fullmatch(r"values\[(\d+)\]", last)
        if signal and labels:
            renamed[prefix + labels[int(signal[1]) - 1]] = value
        else:
            renamed[name] = value
    return renamed


def _labels(columns: Record, prefix: str) -> list[str]:
    """Return the labels of the signals in a structure; [] if one has none, or two have the same."""
    labels: list[str] = []
    while f"{prefix}label[{len(labels) + 1}]" in columns:
        label = columns[f"{prefix}label[{len(labels) + 1}]"]
        labels.append(str(label) if np.size(label) else "")
    if all(labels) and len(set(labels)) == len(labels):
        return labels
    return []


def _of_modelica(variables: Record) -> Record:
    """Return the variables of a result of Dymola or OpenModelica by name.

    Constants have two values, and are as long as the others here.
    """
    is_transposed = str(variables["Aclass"][-1]).strip() == "binTrans"
    letters = [str(row) for row in np.ravel(variables["name"])]
    if is_transposed:
        count = max(map(len, letters))
        letters = ["".join(row.ljust(count)[i] for row in letters) for i in range(count)]
    info = variables["dataInfo"] if is_transposed else variables["dataInfo"].T
    matrices: dict[int, np.ndarray] = {}
    for number in (1, 2):
        matrix = variables[f"data_{number}"]
        matrices[number] = matrix if is_transposed else matrix.T
    times = matrices[2][0]
    columns: Record = {}
    numbers = np.asarray(info, dtype=int)
    for name, matrix, column in zip(letters, *numbers[:2].tolist(), strict=True):
        if matrix == 0:  # the time, which all matrices have
            values = times
        else:
            values = matrices[matrix][abs(column) - 1]
        if len(values) < len(times):
            values = np.broadcast_to(values[0], times.shape)
        columns[name.strip()] = -values if column < 0 else values
    return columns


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
