"""The forms in which other tools leave a solution: one text, file or object of each kind.

All hold the samples of `solution_files`. A form is a file by its name, written by a function of the
path, or an object; `columns` is what its user says with --columns, "" for nothing.
"""

from __future__ import annotations

import json
from collections import namedtuple
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from solution_files import LISTS, ROWS, T, V, X, frame

COUNT = len(T)
STATES = np.array([X, V])
ALL = np.array([T, X, V])


class Form(NamedTuple):
    """A file in some form: what writes it, and what its user says of its columns."""

    write: Callable[[Path], Any]
    columns: str = ""


# -- text ------------------------------------------------------------------------------------------


def lines_of(
    head: Iterable[str],
    sign: str = ",",
    *,
    end: str = "",
    before: Callable[[int], str] = lambda row: "",
    comma: bool = False,
    quoted: bool = False,
) -> str:
    """Return a table: the lines of its `head`, then a line of t, x and v for each sample."""
    lines = list(head)
    for row, values in enumerate(zip(T.tolist(), X.tolist(), V.tolist(), strict=True)):
        cells = [repr(value) for value in values]
        if comma:
            cells = [cell.replace(".", ",") for cell in cells]
        if quoted:
            cells = [f'"{cell}"' for cell in cells]
        lines.append(before(row) + sign.join(cells) + end)
    return "\n".join(lines) + "\n"


def text(*head: str, columns: str = "", encoding: str = "utf-8", **layout: Any) -> Form:
    """Return a form that is a text table."""
    content = lines_of(head, **layout).encode(encoding)
    return Form(lambda path: path.write_bytes(content), columns)


def plain(content: str, columns: str = "") -> Form:
    """Return a form that is a text as it stands."""
    return Form(lambda path: path.write_text(content, encoding="utf-8"), columns)


def index(row: int) -> str:
    return f"{row},"


def names_of_r(row: int) -> str:
    return f'"{row + 1}",'


MARKDOWN = lines_of(["| t | x | v |", "|---|---:|---:|"], " | ", end=" |", before=lambda row: "| ")
FOUR = "\n".join(
    f"{t!r},{x!r},{v!r},{mode}"
    for (t, x, v), mode in zip(ALL.T.tolist(), np.arange(COUNT) % 2, strict=True)
)
MODES = "\n".join(f"{t!r},{x!r},{v!r},Omega1" for t, x, v in ALL.T.tolist())

TEXTS: dict[str, Form] = {
    # headers that are longer or shorter than the rows
    "delimiters at the ends of rows.csv": text("t,x,v", end=","),
    "a delimiter at the end of the header.csv": text("t,x,v,"),
    "delimiters at all ends.csv": text("t;x;v;", sign=";", end=";"),
    "a tab at the ends.tsv": text("t\tx\tv", sign="\t", end="\t"),
    "OpenModelica with nrows.csv": text('time,"x","v",nrows=60'),
    "two names too many.csv": text("t,x,v,mode,force"),
    "names of rows as R writes.csv": text('"t","x","v"', before=names_of_r),
    "names of rows and their name.csv": text('"","t","x","v"', before=names_of_r),
    "numbers of rows without a name.csv": text("t,x,v", before=index),
    "a word behind the last name.csv": plain("t,x,v\n" + MODES),
    "a number behind the last name.csv": plain("t,x,v\n" + FOUR, "t=1,x=2,v=3"),
    "columns apart by signs at both ends.txt": plain(MARKDOWN),
    # lines that are no data
    "a row of units.csv": text("time,x,v", "s,m,m/s"),
    "units in brackets.csv": text("time,x,v", "[s],[m],[m/s]"),
    "units and remarks.csv": text("time,x,v", "s,m,m/s", "clock,of the mass,of the mass"),
    "units below blanks.txt": text("time x v", "(s) (m) (m/s)", sign=" "),
    "lines before the header.csv": text("Results of a run", "solver: mine, 1.2", "", "t,x,v"),
    "numbers before the header.csv": text("Steps,60", "Step size,0.05", "t,x,v"),
    "an empty line below the header.csv": text("t,x,v", ",,"),
    "a ruled header.txt": text("t x v", "------------", sign=" "),
    "another delimiter in the header.txt": text("t, x, v", sign=" "),
    "units apart from names.txt": text("Time (s)   x (m)   v (m/s)", sign="   "),
    "two blanks between names.txt": text("sim time  mass position  mass velocity", sign=" "),
    # names
    "commas in quoted names.csv": text('"t","x, the position","v, the velocity"'),
    "commas in indices.csv": text("t,y(1,1),y(1,2)"),
    "commas in unquoted names.csv": text("time (s, from 0),x,v"),
    "Modelica.csv": text('"time","mass.s","mass.v"'),
    "Modelica derivative.csv": text('"time","x","der(x)"'),
    "Julia.csv": text("timestamp,value1,value2"),
    "x1 and x2.csv": text("t,x1,x2"),
    "x_1 and x_2.csv": text("t,x_1,x_2"),
    "x0 and x1.csv": text("t,x0,x1"),
    "y1 and y2.csv": text("t,y1,y2"),
    "u1 and u2.csv": text("t,u1,u2"),
    "y in brackets.csv": text("t,y[0],y[1]"),
    "y(t) in brackets.csv": text("t,y[1](t),y[2](t)"),
    "functions of t.csv": text("t,x(t),v(t)"),
    "q and dq.csv": text("t,q,dq"),
    "s and v.csv": text("t,s,v"),
    "y and dy.csv": text("t,y,dy"),
    "y and ydot.csv": text("t,y,y_dot"),
    "x and xd.csv": text("t,x,xd"),
    "primes.csv": text("t,x,x'"),
    "dots.csv": text("t,x,ẋ"),
    "dx over dt.csv": text("t,x,dx/dt"),
    "German.csv": text("Zeit;Weg;Geschwindigkeit", sign=";", comma=True),
    "German with umlauts.csv": text("Zeit;Schwingweg x (µm·10⁶);Geschw.", sign=";", columns="x=2,v=3"),
    "French.csv": text("temps,déplacement,vitesse"),
    "Spanish.csv": text("tiempo,posición,velocidad"),
    "Italian.csv": text("tempo,spostamento,velocità"),
    "Chinese.csv": text("时间,位移,速度"),
    "Russian.csv": text("время,перемещение,скорость"),
    "units in names.csv": text("Time [s],Position [m],Velocity [m/s]"),
    "units behind a line.csv": text("t_s,x_m,v_m_s"),
    "units behind a slash.csv": text("t / s,x / m,v / (m/s)"),
    "units behind in.csv": text("t in s,x in m,v in m/s"),
    "words about names.csv": text("Simulation time,Mass position,Mass velocity"),
    "other words.csv": text("elapsed,deflection,rate", columns="x=deflection,v=rate"),
    "names of others and numbers.csv": text("a,b,c", columns="t=1,x=2,v=3"),
    "numbers from 0.csv": text("a,b,c", columns="t=0,x=1,v=2"),
    "columns in another order.csv": Form(
        lambda path: np.savetxt(path, ALL[[2, 0, 1]].T, "%.17g", ",", header="c,a,b", comments=""),
        "t=2,x=3,v=1",
    ),
    "names with commas asked for.csv": text('"a, b","c, d","e, f"', columns="t=a, b,x=c, d,v=e, f"),
    "indices asked for.csv": text('t,"w[1]","w[2]"', columns="x=w[1],v=w[2]"),
    "an index without a name.csv": text(",x,v"),
    # numbers as names, and no names
    "numbers from 0 as names.csv": text("0,1,2"),
    "numbers from 1 as names.csv": text("1,2,3"),
    "numbers as names of pandas.csv": text(",0,1,2", before=index),
    "no names.csv": text(),
    "no names and a delimiter.csv": text(end=","),
    "no names and numbers of rows.csv": text(before=index, columns="t=2,x=3,v=4"),
    "no names and four columns.csv": plain(FOUR, "t=1,x=2,v=3"),
    # letters and numbers
    "UTF-16 as Windows writes.csv": text("t,x,v", encoding="utf-16"),
    "UTF-16 the other way.csv": Form(
        lambda path: path.write_bytes(b"\xfe\xff" + lines_of(["t,x,v"]).encode("utf-16-be"))
    ),
    "UTF-16 without a mark.txt": text("t\tx\tv", sign="\t", encoding="utf-16-le"),
    "UTF-16 without a mark or names.txt": text(sign="\t", encoding="utf-16-be"),
    "UTF-8 with a mark.csv": text("t,x,v", encoding="utf-8-sig"),
    "Latin 1.csv": text("Zeit in s,Größe x,Geschwindigkeit v", encoding="latin-1"),
    "decimal commas.csv": text("t;x;v", sign=";", comma=True),
    "decimal commas and tabs.txt": text("t\tx\tv", sign="\t", comma=True),
    "decimal commas and blanks.txt": text("t x v", sign="  ", comma=True),
    "decimal commas in quotes.csv": text("t,x,v", comma=True, quoted=True),
    "decimal commas before comma and blank.txt": text("t, x, v", sign=", ", comma=True),
    "quotes around numbers.csv": text('"t","x","v"', quoted=True),
    "bars.txt": text("t|x|v", sign="|"),
    "sep.csv": text("sep=;", "t;x;v", sign=";"),
    "brackets around rows.txt": text(sign=" ", before=lambda row: "[", end="]"),
    "braces around rows.txt": text(sign=", ", before=lambda row: "{{"[row > 0 :], end="},"),
    "Mathematica.csv": plain(lines_of(["t,x,v"]).replace("e-", "*^-")),
    "Fortran.txt": plain(lines_of([], "  ").replace("e-", "D-")),
}  # fmt: skip


# -- JSON ------------------------------------------------------------------------------------------


def as_json(content: Any, columns: str = "") -> Form:
    return plain(json.dumps(content), columns)


MATRIX = ALL.T.tolist()
JSONS: dict[str, Form] = {
    "rows.json": as_json(MATRIX),
    "columns without names.json": as_json(ALL.tolist()),
    "states.json": as_json({"t": LISTS["t"], "y": STATES.tolist()}),
    "states in rows.json": as_json({"t": LISTS["t"], "u": STATES.T.tolist()}),
    "nested.json": as_json({"solver": "mine", "result": {"steps": 60, **LISTS}}),
    "nested beside another.json": as_json({"in": {"x": 5, "t": 0}, "out": LISTS}),
    "split.json": as_json({"columns": ["t", "x", "v"], "index": [*range(COUNT)], "data": MATRIX}),
    "table of pandas.json": plain(frame().to_json(orient="table", double_precision=15)),
    "columns of pandas.json": plain(frame().to_json(double_precision=15)),
    "index of pandas.json": plain(frame().to_json(orient="index", double_precision=15)),
    "values of pandas.json": plain(frame().to_json(orient="values", double_precision=15)),
    "header and rows.json": as_json([["t", "x", "v"], *MATRIX]),
    "lines.jsonl": plain("\n".join(map(json.dumps, ROWS))),
    "lines of lists.ndjson": plain("\n".join(map(json.dumps, MATRIX))),
    "other names.json": as_json(dict(zip("abc", ALL.tolist(), strict=True)), "t=a,x=b,v=c"),
    "by number.json": as_json(dict(zip("abc", ALL.tolist(), strict=True)), "t=1,x=2,v=3"),
    "by index.json": as_json({"t": LISTS["t"], "w": STATES.tolist()}, "x=w[1],v=w[2]"),
}


# -- MATLAB ----------------------------------------------------------------------------------------


def mat(columns: str = "", version: str = "5", **variables: Any) -> Form:
    def write(path: Path) -> None:
        from scipy.io import savemat

        savemat(path, variables, format=version)

    return Form(write, columns)


def signals(*labels: str) -> np.ndarray:
    """Return the signals of a Simulink structure, one for each label."""
    kinds = [("values", object), ("dimensions", float), ("label", object), ("blockName", object)]
    array = np.zeros(len(labels), dtype=kinds)
    for i, label in enumerate(labels):
        array[i] = (STATES[i][:, None], 1.0, label, f"model/Integrator{i}")
    return array


def modelica(transposed: bool) -> Form:
    """Return the form of Dymola ("binNormal": a row for each name) or OpenModelica ("binTrans")."""
    names = ["time", "x", "v", "der(x)", "y", "m"]
    # number of the matrix, and of the column with its sign: der(x) is v, y is -x, m a constant
    info = [
        [0, 1, 0, -1],
        [2, 2, 0, -1],
        [2, 3, 0, -1],
        [2, 3, 0, -1],
        [2, -2, 0, -1],
        [1, 2, 0, 0],
    ]

    def letters(words: list[str]) -> np.ndarray:
        width = max(map(len, words))
        rows = np.array([list(word.ljust(width)) for word in words])
        return np.array(["".join(row) for row in (rows.T if transposed else rows)])

    def write(path: Path) -> None:
        from scipy.io import savemat

        kind = "binTrans" if transposed else "binNormal"
        constants = np.array([[T[0], 2.0], [T[-1], 2.0]])
        variables = {
            "Aclass": np.array([list(word.ljust(11)) for word in ["Atrajectory", "1.1", "", kind]]),
            "name": letters(names),
            "description": letters([f"of {name}" for name in names]),
            "dataInfo": np.array(info).T if transposed else np.array(info),
            "data_1": constants.T if transposed else constants,
            "data_2": ALL if transposed else ALL.T,
        }
        savemat(path, variables, format="4")

    return Form(write)


def ode45_solution() -> dict[str, Any]:
    """Return MATLAB's sol = ode45(...): times are x, states are y, and what the solver needs."""
    return {
        "solver": "ode45",
        "extdata": {"odefun": "rhs", "options": {"RelTol": 1e-10}, "varargin": np.zeros((0, 0))},
        "x": T[None],
        "y": STATES,
        "stats": {"nsteps": 59.0, "nfailed": 0.0, "nfevals": 355.0},
        "idata": {"f3d": np.zeros((2, 7, COUNT))},
    }


MATS: dict[str, Form] = {
    "plain.mat": mat(t=T[:, None], x=X[:, None], v=V[:, None]),
    "version 4.mat": mat(version="4", t=T[:, None], x=X[:, None], v=V[:, None]),
    "states called x.mat": mat(t=T[:, None], x=STATES.T),
    "states called X.mat": mat(t=T[:, None], X=STATES.T),
    "states in rows.mat": mat(t=T[None], x=STATES),
    "states with constants.mat": mat(
        t=T[:, None], y=STATES.T, m=1.0, tspan=[0.0, 3.0], x0=[0.0, 1.0]
    ),
    "states called anything.mat": mat(T=T[:, None], Q=STATES.T),
    "tout and yout.mat": mat(tout=T[:, None], yout=STATES.T),
    "tout and xout.mat": mat(tout=T[:, None], xout=STATES.T),
    "single simulation output.mat": mat(out={"tout": T[:, None], "yout": STATES.T, "info": "run"}),
    "by index.mat": mat("x=w[1],v=w[2]", t=T[:, None], w=STATES.T),
    "by number.mat": mat("t=3,x=1,v=2", a=X[:, None], b=V[:, None], c=T[:, None]),
    "sol.mat": mat(sol=ode45_solution()),
    "sol beside others.mat": mat(sol=ode45_solution(), m=1.0, k=20.0),
    "structure with time.mat": mat(
        out={"time": T[:, None], "signals": signals("x", "v"), "blockName": "model/Scope"}
    ),
    "structure with time and no labels.mat": mat(
        simout={"time": T[:, None], "signals": signals("", ""), "blockName": "model/Scope"}
    ),
    "structure with time and one signal.mat": mat(
        simout={
            "time": T[:, None],
            "signals": {"values": STATES.T, "dimensions": 2.0, "label": "", "title": ""},
            "blockName": "model/To Workspace",
        }
    ),
    "two structures with time.mat": mat(
        "t=xs.time,x=xs.signals.values,v=vs.signals.values",
        xs={"time": T[:, None], "signals": {"values": X[:, None], "dimensions": 1.0}},
        vs={"time": T[:, None], "signals": {"values": V[:, None], "dimensions": 1.0}},
    ),
    "To File.mat": mat(ans=ALL),
    "To File, four rows.mat": mat("t=1,x=2,v=3", ans=np.array([T, X, V, X])),
    "To File by index.mat": mat("t=ans[1],x=ans[3],v=ans[2]", ans=np.array([T, V, X])),
    "To Workspace.mat": mat(simout=ALL.T),
    "structs in an array.mat": mat(run=np.array([{"t": T, "x": X, "v": V}], dtype=object)),
    "rows as structs.mat": mat(rows=np.rec.fromarrays([T, X, V], names="t,x,v")),
    "a cell of columns.mat": mat(out=np.array([T, X, V], dtype=object)),
    "OpenModelica.mat": modelica(True),
    "Dymola.mat": modelica(False),
}


# -- numpy, HDF5, parquet --------------------------------------------------------------------------


def npz(columns: str = "", *arrays: np.ndarray, **named: np.ndarray) -> Form:
    return Form(lambda path: np.savez(path, *arrays, **named), columns)


def h5(columns: str = "", attributes: Any = None, **datasets: Any) -> Form:
    def write(path: Path) -> None:
        import h5py

        with h5py.File(path, "w") as file:
            for name, values in datasets.items():
                file[name.replace("__", "/")] = values
            for place, words in (attributes or {}).items():
                file[place].attrs.update(words)

    return Form(write, columns)


def _arrow_stream(path: Path) -> None:
    import pyarrow

    table = pyarrow.table({"t": T, "x": X, "v": V})
    with pyarrow.OSFile(str(path), "wb") as file, pyarrow.ipc.new_stream(file, table.schema) as out:
        out.write_table(table)


def _netcdf_3(path: Path) -> None:
    from scipy.io import netcdf_file

    with netcdf_file(path, "w") as file:
        file.createDimension("time", COUNT)
        for name, values in (("time", T), ("x", X), ("v", V)):
            variable = file.createVariable(name, "d", ("time",))
            variable[:] = values


ARRAYS: dict[str, Form] = {
    "unnamed.npz": npz("", T, X, V),
    "unnamed states.npz": npz("", T, STATES),
    "one.npz": npz(out=ALL.T),
    "one in rows.npz": npz(out=ALL),
    "states in columns.npz": npz(time=T, sol=STATES.T),
    "states beside a scalar.npz": npz(t=T, y=STATES, m=np.array(2.0)),
    "by index.npz": npz("x=w[1],v=w[2]", t=T, w=STATES),
    "by index from 0.npz": npz("x=w[0],v=w[1]", t=T, w=STATES),
    "by number.npz": npz("t=1,x=2,v=3", a=T, b=X, c=V),
    "rows.npy": Form(lambda path: np.save(path, ALL)),
    "four columns.npy": Form(
        lambda path: np.save(path, np.column_stack([T, X, V, X])), "t=1,x=2,v=3"
    ),
    "groups.h5": h5(run__t=T, run__x=X, run__v=V, grid__z=np.arange(5.0), run__more__m=2.0),
    "paths asked for.h5": h5("t=b/t,x=b/p,v=b/w", a__t=T, b__t=T, b__p=X, b__w=V),
    "time outside.h5": h5(t=T, states__x=X, states__v=V),
    "states.h5": h5(time=T, y=STATES.T),
    "rows.h5": h5(data=ALL),
    "by number.h5": h5("t=1,x=2,v=3", a=T, b=X, c=V),
    "names beside a matrix.h5": h5(data=ALL.T[:, [2, 0, 1]], header=np.array([b"v", b"t", b"x"])),
    "as pandas keeps it.h5": h5(
        df__axis0=np.array([b"t", b"x", b"v"]),
        df__axis1=np.arange(COUNT),
        df__block0_items=np.array([b"t", b"x", b"v"]),
        df__block0_values=ALL.T,
    ),
    "other names.parquet": Form(
        lambda path: frame().set_axis(["Zeit", "Weg", "Geschwindigkeit"], axis=1).to_parquet(path)
    ),
    "index.parquet": Form(lambda path: frame().set_index("t").to_parquet(path)),
    "by number.parquet": Form(
        lambda path: frame().set_axis(["a", "b", "c"], axis=1).to_parquet(path), "t=1,x=2,v=3"
    ),
    "stream.arrow": Form(_arrow_stream),
    "netCDF 3.nc": Form(_netcdf_3),
}

FILES: dict[str, Form] = {**TEXTS, **JSONS, **MATS, **ARRAYS}


# -- objects ---------------------------------------------------------------------------------------


@dataclass
class Result:
    """A solver's own result."""

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray


@dataclass
class States:
    """A solver's own result with states."""

    time: np.ndarray
    states: np.ndarray


class Slots:
    """A result that has no dictionary."""

    __slots__ = ("t", "y")

    def __init__(self) -> None:
        self.t = T
        self.y = STATES


class Polars:
    """What polars' DataFrame has: names, columns by name, and Arrow's stream."""

    def __init__(self) -> None:
        self.columns = ["t", "x", "v"]

    def __getitem__(self, name: str) -> np.ndarray:
        return ALL[self.columns.index(name)]


class Lazy:
    """What a lazy frame has: names, and the frame after a call."""

    columns = ("t", "x", "v")

    def collect(self) -> Polars:
        return Polars()


class Duck:
    """What a relation of DuckDB has."""

    columns = ("t", "x", "v")

    def fetchnumpy(self) -> dict[str, np.ndarray]:
        return dict(zip(self.columns, ALL, strict=True))


class Stars:
    """What a table of astropy has."""

    colnames = ("t", "x", "v")

    def __getitem__(self, name: str) -> np.ndarray:
        return ALL[self.colnames.index(name)]


class Tensor:
    """An array of another library."""

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values)
        self.shape = self.values.shape

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        return self.values

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, place: Any) -> Tensor:
        return Tensor(self.values[place])


class Stream:
    """A table that only Arrow's interface shows."""

    def __init__(self) -> None:
        import pyarrow

        self.table = pyarrow.table({"t": T, "x": X, "v": V})

    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any:
        return self.table.__arrow_c_stream__(requested_schema)


def objects() -> dict[str, tuple[Any, dict[str, str]]]:
    """Return an object of each kind, with what its user says of the columns."""
    import pandas
    import pyarrow
    import xarray
    from scipy.integrate._ivp.ivp import OdeResult

    Named = namedtuple("Named", "t x v")
    by_time = pandas.DataFrame({"x": X, "v": V}, index=T)
    states = xarray.DataArray(STATES.T, dims=("time", "state"), coords={"time": T})
    named_states = states.assign_coords(state=["x", "v"])
    forms: dict[str, Any] = {
        "array (n, 3)": ALL.T,
        "array (3, n)": ALL,
        "array (n, 2)": (np.column_stack([T, X]), {}),
        "array (n, 4) by number": (np.column_stack([X, T, X, V]), {"t": "2", "x": "3", "v": "4"}),
        "array by number": (ALL[::-1].T, {"t": "3", "x": "2", "v": "1"}),
        "tensor (n, 3)": Tensor(ALL.T),
        "tuple t, y": (T, STATES),
        "tuple t, y in columns": (T, STATES.T),
        "tuple t, x, v": (T, X, V),
        "list t, x, v": [T, X, V],
        "list of lists": ALL.tolist(),
        "tuple of tensors": (Tensor(T), Tensor(STATES)),
        "pair t, (x, v)": (T, (X, V)),
        "list of states": (T.tolist(), STATES.T.tolist()),
        "namedtuple": Named(T, X, V),
        "dataclass": Result(T, X, V),
        "dataclass with states": States(T, STATES.T),
        "slots": Slots(),
        "namespace": SimpleNamespace(t=T, x=X, v=V),
        "OdeResult": OdeResult(t=T, y=STATES, sol=None, t_events=None, y_events=None, nfev=5),
        "OdeResult by index": (OdeResult(t=T, y=STATES[::-1]), {"x": "y[2]", "v": "y[1]"}),
        "Julia's names": {"timestamp": T, "value1": X, "value2": V},
        "mapping by number": ({"a": T, "b": X, "c": V}, {"t": "1", "x": "2", "v": "3"}),
        "mapping by index": ({"t": T, "w": STATES}, {"x": "w[1]", "v": "w[2]"}),
        "mapping in a mapping": {"out": {"t": T, "x": X, "v": V}, "m": 2.0},
        "DataFrame by unnamed time": by_time,
        "DataFrame by timedelta": by_time.set_axis(pandas.to_timedelta(T, unit="s")),
        "DataFrame of numbers": pandas.DataFrame(ALL.T),
        "DataFrame by number": (frame().set_axis(list("abc"), axis=1), {"t": "1", "x": "2", "v": "3"}),
        "DataFrame with levels": pandas.DataFrame(
            ALL.T, columns=pandas.MultiIndex.from_tuples([("time", "s"), ("mass", "x"), ("mass", "v")])
        ),
        "DataFrame of pyarrow": frame().convert_dtypes(dtype_backend="pyarrow"),
        "polars-like": Polars(),
        "lazy": Lazy(),
        "DuckDB-like": Duck(),
        "astropy-like": Stars(),
        "Arrow's stream": Stream(),
        "Arrow's reader": pyarrow.table({"t": T, "x": X, "v": V}).to_reader(),
        "DataArray of states": states,
        "DataArray of named states": named_states,
        "Dataset with states": xarray.Dataset({"y": states}),
        "ufunc dict of tuples": {"t": tuple(T), "y": tuple(map(tuple, STATES))},
    }  # fmt: skip
    return {
        name: form if isinstance(form, tuple) and isinstance(form[-1], dict) else (form, {})
        for name, form in forms.items()
    }
