"""The result of a sweep as an xarray.Dataset, and its files: netCDF, zarr and CSV, written whole
with their plan.

Each file has a SHA-256 checksum of all its bytes, those of the checksum itself as zeros: after the
netCDF file, in the attributes of the zarr group, in the first line of the CSV file. The columns in
netCDF and zarr have checksums too.
"""

from __future__ import annotations

import json
import os
import re
import warnings
from collections.abc import Callable
from contextlib import nullcontext, suppress
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import symosc
from symosc.base.display.drawable import Drawable
from symosc.base.errors import MissingExtraError, OutputError, SweepError, optional
from symosc.base.exact import show
from symosc.base.files import STDOUT, read_path
from symosc.base.quantities import QUANTITIES, quantity_of
from symosc.model import Model, Parameters
from symosc.scenes import START_NAMES, STARTS
from symosc.simulation.tables import SUMMARY_COLUMNS
from symosc.sweeps.plan import SET_AXIS, START_AXIS, SweepPlan
from symosc.sweeps.store import DRAFT, Columns, remove

if TYPE_CHECKING:
    import xarray

#: The attribute of a Dataset under which symosc's accessor is found.
ACCESSOR = "symosc"
#: xarray's engine for each format of its own.
ENGINES: dict[str, Any] = {".nc": "h5netcdf", ".zarr": "zarr"}
#: The first line of a CSV file: the attributes and the types of the columns, as JSON.
COMMENT = "# "
NO_CHECKSUM = "0" * 64
#: An axis of more values is not written out in the call.
MOST_WRITTEN = 2000
PLAN_FORM, CHECKSUM_FORM = (
    re.compile(name + rb'"?: "?([0-9a-f]{64})') for name in (b"plan", b"sha256")
)
#: The lines that symosc appends after the HDF5 part of a netCDF file.
NETCDF_END = "\nplan: {}\nsha256: {}\n"
SECTION_NAMES = ("period", "component")
#: Files of a zarr group that is a sweep's.
ZARR_NAMES = "|".join((*SUMMARY_COLUMNS, *QUANTITIES, *SECTION_NAMES))
ZARR_FORM = re.compile(rf"zarr\.json|({ZARR_NAMES})/(zarr\.json|c(/\d+)*)")


def need_xarray() -> ModuleType:
    """Return xarray; MissingExtraError if it is not installed."""
    xarray: ModuleType = optional("xarray", "sweep", "sweep")
    if ACCESSOR not in vars(xarray.Dataset):
        xarray.register_dataset_accessor(ACCESSOR)(SweptDataset)
    return xarray


class SweptDataset(Drawable):
    """The accessor ``dataset.symosc`` of a sweep's result: ``dataset.symosc.plot()`` draws it.

    Examples
    --------
    >>> from symosc import sweep
    >>> found = sweep("fig9", {"Omega": "3:5:3"}, t_end="12T", skip="10T")
    >>> [axes.get_xlabel() for axes in found.symosc.plot().axes]
    ['$\\\\Omega$']
    """

    _drawn_by = "swept_figure"

    def __init__(self, dataset: xarray.Dataset) -> None:
        self.dataset = dataset

    @property
    def call(self) -> str:
        """The call of `sweep` that gives this result again, as Python source."""
        return str(self.dataset.attrs.get("call", ""))


def dataset_of(plan: SweepPlan, columns: Columns) -> xarray.Dataset:
    """Return the result of a sweep from columns with a row for each cell, in C order of the
    dimensions.
    """

    def about(name: str, dimension: str) -> dict[str, str]:
        """Return the attributes of a variable; a `dimension` "1" is that of a pure number."""
        if dimension == "1":
            units = {"units": "1"}
        elif dimension:
            units = {"dimension": dimension}
        else:
            units = {}
        return {"long_name": name} | units

    variables = {}
    for name in plan.column_names:
        values = columns[name].reshape(*plan.sizes.values(), *columns[name].shape[1:])
        if name == "section":
            dimensions = (*plan.sizes, *SECTION_NAMES)
        else:
            dimensions = tuple(plan.sizes)
        variables[name] = (dimensions, values, about(*SUMMARY_COLUMNS[name]))
    coordinates: dict[str, Any] = {}
    for name, coordinate in plan.coordinates.items():
        quantity = quantity_of(name)
        attributes_of_axis = about(quantity.meaning, quantity.dimension)
        coordinates[name] = (coordinate.dimension, coordinate.values, attributes_of_axis)
    if plan.sections:
        coordinates |= {"period": np.arange(-plan.sections, 0), "component": ["x", "v"]}
    attributes = {
        "title": f"Sweep of {plan.scene.name} over {', '.join(plan.coordinates)}",
        "source": f"symosc {symosc.__version__}, kernels {plan.content['kernels']}",
        "scene": json.dumps(plan.content["parameters"] | plan.content["start"]),
        "call": _call_text(plan),
        "plan": plan.key,
    }
    return need_xarray().Dataset(variables, coordinates, attributes)


def _call_text(plan: SweepPlan) -> str:
    """Return the call of `sweep` that gives this result again, as Python source."""
    over = {
        name: coordinate
        for name, coordinate in plan.coordinates.items()
        if coordinate.dimension != START_AXIS
    }
    scene = plan.scene
    axes = list[str]()
    for name, axis in over.items():
        if axis.text:
            values = repr(axis.text)
        elif len(axis.values) > MOST_WRITTEN:  # the coordinates have them
            values = f"dataset[{name!r}].values"
        else:
            values = repr(axis.values.tolist())
        axes.append(f"{name!r}: {values}")
    written = "{" + ", ".join(axes) + "}"
    if SET_AXIS in plan.sizes:
        written = (
            f"[{{name: float(dataset[name][i]) for name in {[*over]}}} for i in "
            "range(dataset.sizes['set'])]"
        )
    record = tuple(f"{name}:{plan.sections}" if name == "section" else name for name in plan.record)
    options = [f"record={record!r}", f"t_end={str(plan.t_end)!r}", f"skip={str(plan.skip)!r}"]
    if START_AXIS in plan.sizes:
        rows = np.stack([plan.coordinates[name].values for name in STARTS], axis=-1).tolist()
        options.append(f"starts={rows!r}")
    p: Model = scene.parameters
    if isinstance(p, Parameters):
        numbers = p.as_dict().items()
        parameters = f"Parameters({', '.join(f'{name}={text!r}' for name, text in numbers)})"
    else:
        parameters = repr(p)
    start = ", ".join(f"{name}={show(getattr(scene, name))!r}" for name in START_NAMES)
    if scene.start_error is not None:
        start += f", start_error={[show(error) for error in scene.start_error]!r}"
    return f"sweep(Scene({scene.name!r}, {parameters}, {start}), {written}, {', '.join(options)})"


def output_path(path: Any) -> Path:
    """Check the name of a sweep's output file.

    OutputError if it cannot be written, or a package for it is missing.
    """
    name = read_path(path)
    target = Path(name)
    if name == STDOUT:
        raise OutputError(
            name, "a sweep must be written to a file, because its chunks are kept beside it"
        )
    if target.suffix.lower() not in WRITERS:
        raise OutputError(name, f"a sweep's name must end in {', '.join(WRITERS)}")
    if not target.parent.is_dir():
        raise OutputError(name, "No such file or directory")
    engine = ENGINES.get(target.suffix.lower())
    if engine and engine not in need_xarray().backends.list_engines():
        raise MissingExtraError(f"a {target.suffix} file", "sweep")
    return target


def plan_of(path: Path, to_replace: bool = False) -> str | None:
    """Return the plan's key (`SweepPlan.key`) that an output file states; None if there is no such
    file.

    SweepError if the file is no output of a sweep or, if `to_replace`, is a folder that has other
    files too.
    """
    # The file is read as bytes: the libraries do not fail well. A netCDF file has the plan at its
    # end, a CSV file in its first line.
    if not os.path.lexists(path):
        return None
    plans = list[bytes]()
    file_with_plan = _text_file(path)
    ending = path.suffix.lower()
    if file_with_plan.is_file():
        with suppress(OSError), file_with_plan.open("rb") as file:
            if ending == ".nc":
                end_size = len(NETCDF_END.format(NO_CHECKSUM, NO_CHECKSUM))
                file_size = file.seek(0, os.SEEK_END)
                file.seek(-min(end_size, file_size), os.SEEK_END)
            if ending == ".csv":
                content = file.readline(1 << 24)  # a file of others may be one endless line
            else:
                content = file.read()
            plans = PLAN_FORM.findall(content)
    is_output = bool(plans)
    if is_output and to_replace:
        is_output = all(map(ZARR_FORM.fullmatch, _files_in(path)))
    if not is_output:
        raise SweepError(f"{path} exists and is not the output of a sweep: name another file")
    return plans[-1].decode()


def _text_file(path: Path) -> Path:
    """Return the file with the plan and the checksum of an output: the output itself or, in a
    folder, zarr.json.
    """
    if path.is_dir():
        return path / "zarr.json"
    return path


def _files_in(path: Path) -> dict[str, Path]:
    """Return the files of a folder under their relative names, in order.

    Nothing if the path is a file.
    """
    entries = (entry for entry in path.rglob("*") if entry.is_symlink() or not entry.is_dir())
    return dict(sorted((entry.relative_to(path).as_posix(), entry) for entry in entries))


def read_columns(path: Path) -> Columns:
    """Return the columns of a finished output, over all cells.

    SweepError if the file was damaged or changed.
    """
    actual, stated, _ = _checksum(path)
    if actual != stated:
        raise SweepError(
            f"{path} is damaged, or was changed after it was written: start anew, or name "
            "another file"
        )
    ending = path.suffix.lower()
    if ending == ".csv":
        return _read_csv(path)
    return _read_dataset(path, ENGINES[ending])


def write_output(dataset: xarray.Dataset, path: Path, folder: Path) -> None:
    """Write the result of a sweep atomically: as a draft in `folder`, which is then moved to its
    place `path`.
    """
    # OutputError if that fails, SweepError if there is something in its place that is no output of
    # a sweep.
    suffix = path.suffix.lower()
    draft = folder / f"{DRAFT}{suffix}"
    try:
        remove(draft)
        WRITERS[suffix](dataset.assign_attrs({"sha256": NO_CHECKSUM}), draft)
        checksum = _checksum(draft)
        with _text_file(draft).open("r+b") as file:
            file.seek(checksum.begin)
            file.write(checksum.actual.encode())
        for entry in (*_files_in(draft).values(), *filter(Path.is_dir, draft.rglob("*")), draft):
            _to_disk(entry)
        if plan_of(path, to_replace=True) is not None and path.is_dir():
            remove(path)
        os.replace(draft, path)
        _to_disk(path.parent)
    except OSError as error:
        raise OutputError(str(path), error.strerror or str(error)) from None
    finally:
        with suppress(OSError):
            remove(draft)


def _to_disk(path: Path) -> None:
    """Force a file, or the names of the files in a folder, out of the system's memory onto the
    disk.
    """
    # Not every system does it for folders.
    with suppress(OSError) if path.is_dir() else nullcontext():
        handle = os.open(path, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


class Checksum(NamedTuple):
    """The checksum of an output, the one that is stated in it ("" if none), and where that begins."""

    actual: str
    stated: str
    begin: int


def _checksum(path: Path) -> Checksum:
    """Return the checksums of an output; the place of the stated one counts as NO_CHECKSUM."""
    file_with_checksum = _text_file(path)
    stated = ""
    begin = 0
    checksum = sha256()
    for name, file in (_files_in(path) or {"": path}).items():
        content = memoryview(file.read_bytes())
        checksum.update(f"{name} {len(content)}\n".encode())
        if file == file_with_checksum and (matches := list(CHECKSUM_FORM.finditer(content))):
            # The last one: before it, the name of a scene may look like a checksum.
            begin, end = matches[-1].span(1)
            stated = bytes(content[begin:end]).decode()
            checksum.update(content[:begin])
            checksum.update(NO_CHECKSUM.encode())
            content = content[end:]
        checksum.update(content)
    return Checksum(checksum.hexdigest(), stated, begin)


# -- formats ---------------------------------------------------------------------------------------


def _write_netcdf(dataset: xarray.Dataset, draft: Path) -> None:
    """Write a netCDF file that is built in memory: on a full disk HDF5 would crash the program."""
    import h5netcdf

    content = BytesIO()
    checksum = dataset.attrs.pop("sha256")
    checked = {
        name: {"fletcher32": True} for name, column in dataset.items() if column.dtype.kind != "U"
    }
    with h5netcdf.File(content, "w") as file:
        store = need_xarray().backends.H5NetCDFStore(file)
        dataset.dump_to_store(store, encoding=checked)
        store.sync()
    content.seek(0, os.SEEK_END)
    content.write(NETCDF_END.format(dataset.attrs["plan"], checksum).encode())
    draft.write_bytes(content.getbuffer())


def _write_zarr(dataset: xarray.Dataset, draft: Path) -> None:
    """Write a zarr group."""
    from zarr.codecs import Crc32cCodec, ZstdCodec

    plain = dataset.copy()
    for name, variable in dataset.variables.items():
        # Texts of fixed width have no place in zarr's specification yet.
        if variable.dtype.kind == "U":
            plain[name] = variable.astype(object)
    checked = {name: {"compressors": (ZstdCodec(), Crc32cCodec())} for name in dataset.variables}
    with warnings.catch_warnings():
        # Readers expect the metadata in one piece, which is not in zarr's specification yet either.
        warnings.filterwarnings(
            "ignore", message="Consolidated metadata|.*not part in the Zarr format 3"
        )
        plain.to_zarr(draft, mode="w", consolidated=True, encoding=checked)


def _write_csv(dataset: xarray.Dataset, draft: Path) -> None:
    """Write a CSV file with a row for each cell.

    A point of a Poincaré section takes two columns.
    """
    kinds = {
        str(name): "U" if column.dtype.kind == "U" else str(column.dtype)
        for name, column in dataset.items()
    }
    flat = dataset.drop_vars(["section", *SECTION_NAMES], errors="ignore")
    for i in range(dataset.sizes.get("period", 0)):
        for j, component in enumerate("xv"):
            flat[f"section_{component}_{i}"] = dataset["section"].isel(
                period=i, component=j, drop=True
            )
    frame = flat.to_dataframe().reset_index()
    kept = [name for name in frame.columns if name in dataset.coords or name not in dataset.dims]
    with draft.open("w", encoding="utf-8", newline="") as file:
        file.write(f"{COMMENT}{json.dumps(dataset.attrs | {'types': kinds})}\n")
        frame[kept].to_csv(file, index=False, lineterminator="\n", na_rep="nan")


def _read_dataset(path: Path, engine: Any) -> Columns:
    """Return the columns of a netCDF file or a zarr group, read by the backend of xarray with the
    name `engine`.
    """
    columns: Columns = {}
    with need_xarray().open_dataset(path, engine=engine) as dataset:
        # Each cell has one status, so that its dimensions are those of the sweep.
        swept = dataset["status"].ndim
        cells = dataset["status"].size
        for name, variable in dataset.data_vars.items():
            values = variable.values.reshape(cells, *variable.shape[swept:])
            if values.dtype.kind in "OT":  # texts, which symosc keeps in fixed width
                values = np.array(values.tolist())
            columns[str(name)] = values
    return columns


def _read_csv(path: Path) -> Columns:
    """Return the columns of a CSV file."""
    with path.open(encoding="utf-8") as file:
        head = json.loads(file.readline().removeprefix(COMMENT))
    from pandas import read_csv

    # As text: numpy reads every digit.
    frame = read_csv(path, skiprows=1, dtype=str, na_filter=False)
    text = {str(name): np.array(frame[name].tolist()) for name in frame.columns}
    if points := sum(name.startswith("section_x_") for name in text):
        pairs = [[text[f"section_{component}_{i}"] for component in "xv"] for i in range(points)]
        text["section"] = np.moveaxis(np.array(pairs), -1, 0)
    return {name: text[name].astype(kind) for name, kind in head["types"].items()}


WRITERS: dict[str, Callable[[Any, Path], None]] = {
    ".nc": _write_netcdf,
    ".zarr": _write_zarr,
    ".csv": _write_csv,
}
