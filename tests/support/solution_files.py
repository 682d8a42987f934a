"""Files of one solution in every format, each written by the library that people write it with."""

from __future__ import annotations

import bz2
import gzip
import json
import lzma
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from symosc import simulate
from symosc.crosschecks.reading.solutions import read_solutions
from symosc.crosschecks.samples import Samples

T = np.linspace(0.1324, 3, 60)
X, V = simulate("fig9", t_end=3)(T)
COLUMNS = {"t": T, "x": X, "v": V}


def read_samples(source: Any, columns: Any = None) -> Samples:
    """Return the one solution in a file or an object."""
    (found,) = read_solutions(source, columns)
    return found


def frame() -> Any:
    import pandas

    return pandas.DataFrame(COLUMNS)


def _table(delimiter: str, head: str, comments: str = "") -> Callable[[Path], None]:
    return lambda path: np.savetxt(
        path,
        np.column_stack([T, X, V]),
        fmt="%.17g",
        delimiter=delimiter,
        header=head,
        comments=comments,
    )


def _text(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _packed(opened: Callable[..., Any]) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        with opened(path, "wt") as file:
            frame().to_csv(file, index=False, float_format="%.17g")

    return write


def _mat(**variables: Any) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        from scipy.io import savemat

        savemat(path, variables)

    return write


def _h5(**datasets: Any) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        import h5py

        with h5py.File(path, "w") as file:
            for name, values in datasets.items():
                file[name] = values

    return write


def _matlab_73(path: Path) -> None:
    """Write as MATLAB does with -v7.3.

    HDF5 behind 512 bytes of text, a struct as a group, columns as rows.
    """
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        file.create_group("#refs#")["a"] = [1.0]
        for name, column in COLUMNS.items():
            file[f"sol/{name}"] = column[None]
    with path.open("r+b") as raw:
        raw.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def _arrow() -> Any:
    import pyarrow

    return pyarrow.table(COLUMNS)


def _parquet(path: Path) -> None:
    import pyarrow.parquet

    pyarrow.parquet.write_table(_arrow(), path)


def _feather(path: Path) -> None:
    import pyarrow.feather

    pyarrow.feather.write_feather(_arrow(), path)


def _netcdf(path: Path) -> None:
    import xarray

    xarray.Dataset({"x": ("t", X), "v": ("t", V)}, {"t": T}).to_netcdf(path, engine="h5netcdf")


LISTS = {name: column.tolist() for name, column in COLUMNS.items()}
ROWS = [dict(zip(LISTS, row, strict=True)) for row in zip(*LISTS.values(), strict=True)]
RECORDS = np.rec.fromarrays([T, X, V], names="t,x,v")
PLAIN = "\n".join(f"{t!r} {x!r} {v!r}" for t, x, v in zip(*LISTS.values(), strict=True))

#: What writes a file, by its name.
WRITERS: dict[str, Callable[[Path], None]] = {
    "pandas.csv": lambda path: frame().to_csv(path, index=False),
    "numbered.csv": lambda path: frame().to_csv(path, index_label="id"),
    "savetxt.csv": _table(",", "t,x,v", "# "),
    "capitals.csv": _table(",", "Time (s),Position [m],Velocity [m/s]"),
    "headless.csv": _table(",", ""),
    "tabs.tsv": _table("\t", "T\tX\tV"),
    "semicolon.csv": lambda path: frame().to_csv(path, index=False, sep=";", decimal=","),
    "decimal comma.txt": lambda path: frame().to_csv(path, index=False, sep="\t", decimal=","),
    "blanks.txt": lambda path: _text(path, PLAIN),
    "columns.dat": _table("   ", "run of a solver\nt   x   v", "% "),
    "comments.txt": lambda path: _text(path, f"# a comment\n\n# t x v\n{PLAIN}\n# the end\n"),
    "packed.csv.gz": _packed(gzip.open),
    "packed.csv.bz2": _packed(bz2.open),
    "packed.txt.xz": _packed(lzma.open),
    "columns.json": lambda path: _text(path, json.dumps(LISTS)),
    "rows.json": lambda path: _text(path, json.dumps(ROWS)),
    "pandas.json": lambda path: frame().to_json(path, orient="records", double_precision=15),
    "packed.json.gz": lambda path: (
        path.write_bytes(gzip.compress(json.dumps(LISTS).encode())) and None
    ),
    "arrays.npz": lambda path: np.savez(path, T=T, Position=X, vel=V),
    "packed.npz": lambda path: np.savez_compressed(path, **COLUMNS),
    "states.npz": lambda path: np.savez(path, t=T, y=np.array([X, V])),
    "array.npy": lambda path: np.save(path, np.column_stack([T, X, V])),
    "records.npy": lambda path: np.save(path, RECORDS),
    "columns.mat": _mat(t=T[:, None], x=X[:, None], v=V[:, None]),
    "ode45.mat": _mat(t=T[:, None], y=np.column_stack([X, V])),
    "struct.mat": _mat(sol={"t": T, "x": X, "v": V}),
    "nested.mat": _mat(out={"run": {"t": T, "x": X, "v": V}}),
    "version 7.3.mat": _matlab_73,
    "pyarrow.parquet": _parquet,
    "pandas.parquet": lambda path: frame().assign(note="text").to_parquet(path),
    "pyarrow.feather": _feather,
    "pandas.feather": lambda path: frame().to_feather(path),
    "datasets.h5": _h5(**COLUMNS),
    "group.h5": _h5(**{f"run/out/{name}": column for name, column in COLUMNS.items()}),
    "records.h5": _h5(samples=np.array(RECORDS)),
    "matrix.hdf5": _h5(data=np.column_stack([T, X, V])),
    "xarray.nc": _netcdf,
}
