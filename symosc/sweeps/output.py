"""Files of finished sweeps: netCDF, zarr and CSV, written whole, each with the plan that it belongs to."""

from __future__ import annotations

import json
import os
import shutil
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from symosc.errors import MissingExtraError, OutputError, SweepError
from symosc.files import STDOUT, read_path, write_whole
from symosc.sweeps.dataset import PLAN_ATTRIBUTE, need_xarray

if TYPE_CHECKING:
    import xarray

NETCDF_ENGINE: Literal["h5netcdf"] = "h5netcdf"
#: The first line of a CSV file: the attributes and the types of the columns, as JSON.
COMMENT = "# "

Columns = dict[str, np.ndarray]


def output_path(path: Any) -> Path:
    """Return the file that a sweep is to make.

    Raises
    ------
    ParameterError
        If `path` can name no file.
    OutputError
        If its suffix is none that can be written, or its folder does not exist.
    MissingExtraError
        If what writes such files is not installed.
    """
    name = read_path(path)
    target = Path(name)
    if name == STDOUT:
        raise OutputError(name, "a sweep goes to a file, beside which its chunks are kept")
    if target.suffix.lower() not in WRITERS:
        raise OutputError(name, f"a sweep's name must end in {', '.join(WRITERS)}")
    if not target.parent.is_dir():
        raise OutputError(name, "No such file or directory")
    needed = {".nc": NETCDF_ENGINE, ".zarr": "zarr"}.get(target.suffix.lower())
    if needed and needed not in need_xarray().backends.list_engines():
        raise MissingExtraError(f"a {target.suffix} file", "sweep")
    return target


def plan_of(path: Path) -> str | None:
    """Return the name of the plan that a finished output belongs to; None if there is no output.

    Raises
    ------
    SweepError
        If there is a file that is no output of a sweep.
    """
    if not path.exists():
        return None
    try:
        key = READERS[path.suffix.lower()](path, False)
    except Exception:  # whatever the libraries raise for files that are not theirs
        key = None
    if not isinstance(key, str):
        raise SweepError(f"{path} exists and is no output of a sweep: name another file")
    return key


def read_columns(path: Path) -> Columns:
    """Return the columns of a finished output, over all cells."""
    columns: Columns = READERS[path.suffix.lower()](path, True)
    return columns


def write_output(dataset: xarray.Dataset, path: Path, folder: Path) -> None:
    """Write a result whole: first into `folder`, which is beside it, and from there to its place.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    suffix = path.suffix.lower()
    draft = folder / f"whole{suffix}"
    try:
        if draft.is_dir():
            shutil.rmtree(draft)
        WRITERS[suffix](dataset, draft)
        if path.is_dir():
            shutil.rmtree(path)
        os.replace(draft, path)
    except OutputError as error:
        raise OutputError(str(path), error.reason) from None
    except OSError as error:
        raise OutputError(str(path), error.strerror or str(error)) from None


def _write_netcdf(dataset: xarray.Dataset, draft: Path) -> None:
    write_whole(draft, lambda path: dataset.to_netcdf(path, engine=NETCDF_ENGINE))


def _write_zarr(dataset: xarray.Dataset, draft: Path) -> None:
    plain = dataset.copy()
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "U":  # texts of fixed width have no place in zarr's specification yet
            plain[name] = variable.astype(object)
    with warnings.catch_warnings():
        # Readers expect the metadata in one piece, which is not in zarr's specification yet either.
        warnings.filterwarnings("ignore", message="Consolidated metadata|.*not part in the Zarr format 3")
        plain.to_zarr(draft, mode="w", consolidated=True)


def _write_csv(dataset: xarray.Dataset, draft: Path) -> None:
    frame = _flat(dataset).to_dataframe().reset_index()
    kept = [name for name in frame.columns if name in dataset.coords or name not in dataset.dims]
    kinds = {str(name): "U" if each.dtype.kind == "U" else str(each.dtype) for name, each in dataset.items()}
    head = json.dumps(dataset.attrs | {"types": kinds})

    def fill(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as file:
            file.write(f"{COMMENT}{head}\n")
            frame[kept].to_csv(file, index=False, lineterminator="\n", na_rep="nan")

    write_whole(draft, fill)


def _flat(dataset: xarray.Dataset) -> xarray.Dataset:
    """Return a dataset without sections in it: each of their points is two columns."""
    if "section" not in dataset:
        return dataset
    flat = dataset.drop_vars(["section", "period", "component"])
    for i in range(dataset.sizes["period"]):
        for j, component in enumerate("xv"):
            flat[f"section_{component}_{i}"] = dataset["section"].isel(period=i, component=j, drop=True)
    return flat


def _read_dataset(path: Path, whole: bool, **options: Any) -> Any:
    with need_xarray().open_dataset(path, **options) as dataset:
        if not whole:
            return dataset.attrs.get(PLAN_ATTRIBUTE)
        dimensions = dataset["status"].dims
        cells = int(np.prod([dataset.sizes[name] for name in dimensions]))
        columns = {}
        for name, variable in dataset.data_vars.items():
            values = variable.values.reshape(cells, *variable.shape[len(dimensions) :])
            columns[str(name)] = np.array(values.tolist()) if values.dtype.kind in "OT" else values
        return columns


def _read_netcdf(path: Path, whole: bool) -> Any:
    return _read_dataset(path, whole, engine=NETCDF_ENGINE)


def _read_zarr(path: Path, whole: bool) -> Any:
    return _read_dataset(path, whole, engine="zarr")


def _read_csv(path: Path, whole: bool) -> Any:
    with path.open(encoding="utf-8") as file:
        head = json.loads(file.readline().removeprefix(COMMENT))
    if not whole:
        return head[PLAN_ATTRIBUTE]
    from pandas import read_csv

    frame = read_csv(path, skiprows=1, dtype=str, na_filter=False)  # as text: numpy reads every digit
    text = {str(name): np.array(frame[name].tolist()) for name in frame.columns}
    points = sum(name.startswith("section_x_") for name in text)
    if points:
        pairs = [[text[f"section_{component}_{i}"] for component in "xv"] for i in range(points)]
        text["section"] = np.moveaxis(np.array(pairs), -1, 0)
    return {name: text[name].astype(kind) for name, kind in head["types"].items()}


WRITERS: dict[str, Callable[[Any, Path], None]] = {".nc": _write_netcdf, ".zarr": _write_zarr, ".csv": _write_csv}
READERS: dict[str, Callable[[Path, bool], Any]] = {".nc": _read_netcdf, ".zarr": _read_zarr, ".csv": _read_csv}
