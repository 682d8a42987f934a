"""Every public callable with a valid call, hostile values for its parameters, and which of them are valid there."""

from __future__ import annotations

import datetime
import decimal
import inspect
import itertools
import os
import types
from collections.abc import Callable
from fractions import Fraction
from functools import cache, partial
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pandas as pd
import sympy
import xarray as xr

import symosc
from symosc import load_scene, plot

P5 = load_scene("fig5").parameters
P9 = load_scene("fig9").parameters
FREE = symosc.Oscillator(m=1, c="0.1", k=1, belts=[symosc.Belt("1/2", mu="1/2", mu_s=1)])


class Broken:
    """An object whose every method fails."""

    def __getattr__(self, name: str) -> Any:
        raise RuntimeError(f"no {name}")

    def _fail(self, *_: object) -> Any:
        raise RuntimeError("broken")

    __len__ = __iter__ = __getitem__ = __float__ = __index__ = __bool__ = __array__ = __eq__ = (
        __repr__
    ) = _fail
    __hash__ = None  # type: ignore[assignment]


def _circle() -> list[Any]:
    circle: list[Any] = []
    circle.append(circle)
    return circle


PLAIN = "None True False 0 -1 3 10**400 -10**60 1e51 0.5 1j [] () {} [1,2] [None] range(10**12)"
#: Makers of hostile values by name: an iterator is used up by its first reader.
VALUES: dict[str, Callable[[], Any]] = {source: partial(eval, source) for source in PLAIN.split()}
VALUES |= {
    "nan": lambda: float("nan"),
    "inf": lambda: float("inf"),
    "fraction": lambda: Fraction(1, 3),
    "decimal_nan": lambda: decimal.Decimal("NaN"),
    "mpf_nan": lambda: mpmath.nan,
    "symbol": lambda: sympy.Symbol("x"),
    "oo": lambda: sympy.oo,
    "text": lambda: "nonsense",
    "text_empty": lambda: "",
    "text_1": lambda: "1",
    "text_null": lambda: "a\0b",
    "text_long": lambda: "P" * 100_000,
    "text_half": lambda: "\ud800",
    "bytes": lambda: b"P2",
    "bytearray": lambda: bytearray(b"123"),
    "memoryview": lambda: memoryview(b"123"),
    "[text]": lambda: ["a", "b"],
    "ragged": lambda: [[1], [1, 2]],
    "circle": _circle,
    "unhashable": lambda: [{}, []],
    "dict": lambda: {"a": 1},
    "dict_of_int": lambda: {1: 2},
    "set": lambda: {1, 2},
    "generator": lambda: (i for i in range(3)),
    "iterator": lambda: iter([]),
    "array": lambda: np.array([1.0, 2.0]),
    "array_0": lambda: np.array(1.0),
    "array_empty": lambda: np.zeros(0),
    "array_odd": lambda: np.zeros((2, 3, 4)),
    "array_nan": lambda: np.array([0.0, np.nan]),
    "array_object": lambda: np.array([None, {}], dtype=object),
    "array_text": lambda: np.array(["a", "b"]),
    "array_bool": lambda: np.array([True, False]),
    "array_1j": lambda: np.array([1j, 2]),
    "array_time": lambda: np.array(["2020-01-01"], dtype="datetime64[s]"),
    "frame": lambda: pd.DataFrame({"a": [1.0, 2.0], "b": [3.0, 4.0]}),
    "series": lambda: pd.Series([1.0, 2.0]),
    "dataset": lambda: xr.Dataset({"a": ("b", [1.0, 2.0])}),
    "datetime": lambda: datetime.datetime(2020, 1, 1),
    "timedelta": lambda: datetime.timedelta(seconds=3),
    "timedelta64": lambda: np.timedelta64(3, "s"),
    "lambda": lambda: lambda *_: None,
    "type": lambda: int,
    "module": lambda: types,
    "object": object,
    "ellipsis": lambda: ...,
    "exception": lambda: ValueError("x"),
    "path": lambda: Path("no/such/folder/at/all.xyz"),
    "broken": Broken,
    "Parameters": lambda: P5,
    "Scene": lambda: load_scene("fig6"),
    "Trajectory": lambda: made("trajectory"),
}


class OwnText(float):
    """A number whose text is none."""

    def __repr__(self) -> str:
        raise RuntimeError("no text")

    __str__ = __repr__


VALUES |= {
    "mpf_huge": lambda: mpmath.mpf("1e1000000000"),
    "mpf_tiny": lambda: mpmath.mpf("1e-1000000000"),
    "1e22": lambda: 1e22,
    "1e200": lambda: 1e200,
    "10**5000": lambda: 10**5000,
    "fraction_tiny": lambda: Fraction(1, 10**5000),
    "fraction_long": lambda: Fraction(1, 10**40_000),
    "text_1e-900": lambda: "1e-900",
    "text_close": lambda: "1." + "0" * 330 + "1",
    "str_": lambda: np.str_("0.1"),
    "own_text": lambda: OwnText(0.5),
    "endless": lambda: itertools.repeat("P2"),
    "endless_numbers": lambda: itertools.count(),
    "array_no_texts": lambda: np.array([], dtype=str),
    "array_0_whole": lambda: np.array(3),
    "array_0_text": lambda: np.array("1/2"),
    "array_0_bool": lambda: np.array(True),
    "array_0_masked": lambda: np.ma.masked,
    "dataarray_0": lambda: xr.DataArray(0.5),
    "[[]]": lambda: [[]],
}

FLAG = {"True", "False"}
#: Arrays without dimensions are numbers wherever numbers are.
ENTRIES = {"array_0", "array_0_whole", "array_0_text", "dataarray_0"}
NUMBER = {"0", "-1", "3", "0.5", "fraction", "text_1", "1e22", "own_text", "str_", *ENTRIES}
NUMBER |= {"fraction_tiny", "text_1e-900", "text_close"}
LARGE = {"3", "10**400", "10**5000", "array_0_whole"}
ROWS = {
    "[[]]",
    "array_no_texts",
    "[]",
    "()",
    "[1,2]",
    "array",
    "array_0",
    "array_empty",
    "array_odd",
    "series",
}
TEXT = {
    "text",
    "text_1",
    "text_null",
    "text_long",
    "text_half",
    "str_",
    "text_close",
    "text_1e-900",
}
BOTH = {"Parameters", "Scene"}
PAIRS = {"[1,2]", "array", "series"}


def _each(names: str, values: set[str]) -> dict[str, set[str]]:
    return dict.fromkeys(names.split(", "), values)


#: Which values are valid for parameters of a name, or of one call; None is where it is the default,
#: and no others are.
VALID: dict[str, set[str]] = {
    **_each(
        "m, c, k, A0, B0, Omega, v1, v2, mu1, mu2, FN, t0, x0, v0, t_end, t_m, x, theta, x_i, theta_m",
        NUMBER,
    ),
    **_each(
        "tolerance, global_tolerance, within, low, high, skip, start_error, phase, pull, Y, Y_phase, W, W_phase",
        NUMBER,
    ),
    **_each("Belt v, Belt mu, Belt mu_s, Belt.replace mu, Oscillator.replace mu_s1", NUMBER),
    **_each("Belt slope, Belt.from_function v, Belt.from_function mu_s", NUMBER),
    "until": NUMBER | PAIRS,
    "doublings": {"3", "array_0_whole"},
    "Belt.from_function mu": {"lambda"},
    "pieces": {"3", "array_0_whole"},
    **_each("g, angle, atlas prove, atlas seconds, grazing_start periods", NUMBER),
    **_each("Scene start_error, simulate_many skip", NUMBER | {"array_0"}),
    **_each("theorem7 gamma, theorem7 amplitude", NUMBER | {"symbol"}),
    **_each("fit sigma, values_containing theta", NUMBER | {"[1,2]"}),
    **_each("ReturnMap.orbit at, ReturnMap.exponent at, plot.return_map_figure start", NUMBER),
    "Bifurcation.name_at value": NUMBER,
    "ReturnMap.__call__ at": NUMBER | ROWS | {"mpf_tiny", "fraction_long"},
    "ReturnMap.exponent skip": {"0", "3", "array_0_whole"},
    "return_map over": PAIRS,
    "accuracy": NUMBER | {"inf"},
    "ParameterValues.__contains__ value": NUMBER | {"oo"},
    "solve_map theta_i": NUMBER | {"mpf_tiny", "fraction_long"},
    "solve_map x_i": NUMBER | {"mpf_tiny"},
    **_each(
        "GrazingWindow.contact theta, grazing_windows Omega, simulate_many t_end", NUMBER | ROWS
    ),
    **_each(
        "Sensitivities.__call__ t, Trajectory.__call__ t, Trajectory.mode t, Trajectory.force t",
        NUMBER | ROWS,
    ),
    "Trajectory.samples times": ({"3", "array_0_whole", *ROWS} - {"[[]]", "array_0", "array_odd"}),
    **{f"MovedTrajectory.{name} t": NUMBER | ROWS for name in ("__call__", "mode", "force")},
    **{f"OtherModel.{way} {name}": NUMBER | ROWS for way in ("back", "forth") for name in "txv"},
    "GrazingWindow.contains theta": NUMBER | ROWS | {"1e51"},
    "FollowedOrbit.__call__ t": NUMBER | ROWS,
    "PeriodicOrbit.__call__ t": (
        NUMBER | ROWS | {"-10**60", "1e51", "1e200", "fraction_long", "mpf_tiny"}
    ),
    **_each("closed, grazing, jacobian, own_start, partial, resume, robust, use_numba", FLAG),
    "Scene in_si": FLAG,
    **_each("OtherModel joined, OtherModel.replace joined", FLAG),
    "progress": {*FLAG, "lambda"},
    "certify progress": {*FLAG, "lambda", "Trajectory"},
    **_each("max_events, max_points, workers", LARGE),
    "crosscheck workers": LARGE | {"None"},
    **_each("n, alpha, periods", {"3", "array_0_whole"}),
    **_each("seed, sections, step", {"0", "3", "array_0_whole"}),
    **_each("continue_border step, Border.network step", NUMBER),
    "i": {"0", "-1", "3", "array_0_whole"},
    "continue_border end": {"0"},
    "EventTable.__getitem__ trajectory": {"0", "-1"},
    "Summary.__getitem__ motion": {"0", "-1", "[]", "()", "array_bool"},
    **_each("scene, what, subject, windows", {"Scene"}),
    **_each(
        "p, parameters, sweep scene, sweep_status scene, crosscheck scene, simulate scene", BOTH
    ),
    **_each(
        "atlas what, attractors what, bifurcation what, return_map what, frequency_response what, "
        "fit what, sensitivities what",
        BOTH,
    ),
    **_each("values_containing p, values_empty p, values_everything p", BOTH | {"None"}),
    "certify what": BOTH | {"Atlas"},
    **_each("first, second, figsize", PAIRS),
    "plot.friction_figure v": PAIRS,
    "end": PAIRS | {"ragged"},
    "guess": PAIRS | {"frame"},
    "start": PAIRS | {"array_odd", "ragged"},
    "CompiledResidual.__call__ x": PAIRS | {"array_nan", "broken"},
    **_each("columns, given, fit start", {"{}"}),
    "events": {"[]", "()", "iterator", "array_empty", "array_no_texts"},
    "path": {"text", "text_1", "str_", "text_1e-900"},
    "plane": {"lambda"},
    "Scene name": TEXT,
    "Scene notes": {"()"},
    "Scene source": TEXT | {"text_empty"},
    "crosscheck t": {"Trajectory", "broken"},  # what an object of a user raises is the user's
    "crosscheck x": {"Trajectory"},
    "fit data": {"broken", "Trajectory"},  # as above
}
#: What a message may name in place of a parameter: the parts of it.
CALLED = {
    "data": ("file", "path", "t", "kind", "x", "v", "column", "function", "solution"),
    "curve": ("mu",),
    "law": ("quantity",),
    "quantity": ("law",),
    "end": ("x_j", "theta_j"),
    "events": ("t of events",),
    "first": ("Omega",),
    "given": ("a",),
    "high": ("Omega",),
    "low": ("Omega",),
    "m": ("v2",),
    "mu": ("curve", "mu_s"),
    "Omega": ("v2",),
    "phase": ("angle",),
    "Y_phase": ("angle",),
    "W": ("phase",),
    "W_phase": ("angle",),
    "parameters": ("a", "range"),
    "scene": ("t0",),
    "second": ("k",),
    "start": ("x_i", "theta_i"),
    "t_end": ("skip",),
    "t": (
        "DataArray",
        "MaskedConstant",
        "column",
        "file",
        "function",
        "lengths",
        "list",
        "ndarray",
        "path",
        "solution",
    ),
    "t0": ("t_end",),
    "subject": ("t_end",),
    "times": ("t",),
    "t_m": ("theta",),
    "v": ("t", "lengths"),
    "v2": ("v1",),
    "value": ("Omega",),
    "x": ("columns", "function", "lengths", "points", "t"),
}


def _samples() -> dict[str, Any]:
    t = np.linspace(0, 3, 40)
    x, v = made("trajectory")(t)
    return {"t": t, "x": x, "v": v}


def _scores() -> Any:
    from symosc.reference.score import score

    return [score("nobody", [symosc.reference_cases()[1]], {})]


OVER = {"Omega": "3:5:3", "FN": [5, 10]}
TWO = [(0, 0, 0), (0, 1, 0)]
MAKERS: dict[str, Callable[[], Any]] = {
    "trajectory": lambda: symosc.simulate("fig5", t_end=3),
    "response": lambda: symosc.frequency_response("fig9", {"Omega": [4, 5]}),
    "moved": lambda: symosc.simulate(
        symosc.OtherModel(m=1, k=1, Omega=2, FN=1, Y=1, joined=True), t_end=3
    ),
    "sensitivities": lambda: symosc.sensitivities("fig5", "mu1", t_end=3),
    "orbit": lambda: symosc.find_orbit(P9, "P32"),
    "branch": lambda: symosc.continue_orbit(P9, "P32", "Omega", (3.9, 4.0), max_points=5),
    "ended branch": lambda: symosc.continue_orbit(P9, "P32", "Omega", (3.2, 4)),
    "border": lambda: symosc.continue_border(made("ended branch"), 0, "FN", (9, 11), step="0.1"),
    "window": lambda: symosc.grazing_window(P9, "P2"),
    "atlas": lambda: symosc.atlas(P9, {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, workers=1),
    "return map": lambda: symosc.return_map(FREE, points=9),
    "bifurcation": lambda: symosc.bifurcation(FREE, {"v1": [0.4, 0.5]}),
    "curve": lambda: symosc.grazing_curve(P9, "P2", n=50),
    "samples": _samples,
    "fit": lambda: symosc.fit("fig5", [(0.1223, "stick"), (1.221, "slip")], "mu1", sigma=1e-3),
    "check": lambda: symosc.crosscheck("fig5", **made("samples")),
    "certificate": lambda: symosc.certify("fig6"),
    "events": lambda: symosc.simulate_many(P5, TWO, 3, use_numba=False),
    "summary": lambda: symosc.simulate_many(P5, TWO, 7, use_numba=False, record="summary"),
    "residual": lambda: symosc.compiled_residual(P9, "P2"),
    "region": lambda: symosc.values_containing(P9, "P2", ("Omega", "k"), "7*pi/6"),
    "values": lambda: symosc.values_containing(P9, "P2", "Omega", "7*pi/6"),
    "dataset": lambda: symosc.sweep("fig9", OVER, t_end="12T", skip="10T"),
    "basins": lambda: symosc.sweep(
        "fig9", {"v0": "0:2:2", "x0": "-1:1:2"}, t_end="12T", skip="10T"
    ),
    "line": lambda: symosc.sweep(
        "fig9", {"Omega": "3:5:3"}, record=["section:2", "events"], t_end="12T"
    ),
    "law scene": lambda: symosc.Scene("a", FREE, t0=0, x0=2, v0=0, t_end=9),
    "cycle": lambda: symosc.find_orbit(FREE, x0=2),
    "attractors": lambda: symosc.attractors(P9, {"x0": [0, 1], "v0": [0, 1]}, t_end="40T"),
    "scores": _scores,
    "drawing": lambda: plot.figure("fig6", panels="a"),
}


@cache
def made(name: str) -> Any:
    """Return an answer, made once."""
    return MAKERS[name]()


def functions() -> dict[str, tuple[Callable[..., Any], dict[str, Any]]]:
    """Return the functions that need no answer of another, each with valid arguments.

    The rest are defaults.
    """
    s = symosc
    grazes = {"p": P9, "mapping": "P2"}
    points = {"p": P9, "label": "P2", "start": (4.5, 0.5), "end": (-4, 4)}
    start = {"t0": 0, "x0": 0, "v0": 0, "t_end": 3}
    scene = load_scene("fig6")
    wall = {"m": 1, "k": 1, "Omega": 2, "FN": 1, "Y": 1, "joined": True}
    belt = s.Belt(1, "1/2", mu_s=1)
    law = {"m": 1, "c": 0, "k": 1, "B0": 1, "Omega": 2, "FN": 1, "belts": [belt]}
    swept = {"scene": "fig9", "over": {"Omega": [4]}, "record": "events", "t_end": "1"}
    return {
        "Parameters": (s.Parameters, {name: getattr(P5, name) for name in P5.as_dict()}),
        "Parameters.replace": (P5.replace, {"m": 1}),
        "Parameters.A": (P5.A, {"alpha": 1}),
        "Parameters.belt": (P5.belt, {"boundary": 1}),
        "Parameters.friction": (P5.friction, {"boundary": 1}),
        "Scene": (s.Scene, {"name": "a", "parameters": P5, **start}),
        "Scene.changed": (scene.changed, {"m": 1}),
        "OtherModel": (s.OtherModel, wall),
        "OtherModel.replace": (s.OtherModel(**wall).replace, {"m": 1}),
        "OtherModel.back": (s.OtherModel(**wall).back, {"t": 0, "x": 1, "v": [1]}),
        "OtherModel.forth": (s.OtherModel(**wall).forth, {"t": 0, "x": 1, "v": [1]}),
        "Scene.started": (scene.started, {"given": {"t0": 1}}),
        "load_scene": (s.load_scene, {"name_or_path": "fig5"}),
        "scene_names": (s.scene_names, {}),
        "reference_cases": (s.reference_cases, {}),
        "read_word": (s.read_word, {"word": "P32"}),
        "simulate": (s.simulate, {"scene": P5, **start, "max_events": 3}),
        "simulate digits": (s.simulate, {"scene": "fig6", "t_end": 2, "digits": 20}),
        "sensitivities": (s.sensitivities, {"what": P5, "wrt": ("mu1",), **start, "max_events": 3}),
        "attractors": (s.attractors, {"what": P9, "starts": [(0, 0, 0)], "t_end": "40T"}),
        "bifurcation": (
            s.bifurcation,
            {"what": P9, "over": {"Omega": [4, 4.1]}, "sections": 2, "skip": 2},
        ),
        "return_map": (s.return_map, {"what": P9, "points": 8}),
        "frequency_response": (s.frequency_response, {"what": "fig9", "over": {"Omega": [4]}}),
        "fit": (
            s.fit,
            {
                "what": "fig5",
                "data": [(0.1223, "stick"), (1.221, "slip")],
                "free": "mu1",
                "sigma": 1e-3,
            },
        ),
        "simulate_many": (
            s.simulate_many,
            {
                "parameters": P5,
                "starts": (0, 0, 0),
                "t_end": 3,
                "record": "summary",
                "use_numba": False,
            },
        ),
        "residual": (s.residual, points),
        "jacobian": (s.jacobian, points),
        "parameter_jacobian": (s.parameter_jacobian, points),
        "solve_map": (s.solve_map, {"p": P9, "label": "P2", "x_i": 4.5, "theta_i": 0.5}),
        "compiled_residual": (s.compiled_residual, {"p": P9, "label": "P2"}),
        "find_orbit": (s.find_orbit, {"parameters": P9, "word": "P32"}),
        "continue_orbit": (
            s.continue_orbit,
            {
                "parameters": P9,
                "word": "P32",
                "parameter": "Omega",
                "range": (3.9, 4.0),
                "max_points": 3,
            },
        ),
        "grazing_window": (s.grazing_window, grazes),
        "grazing_windows": (s.grazing_windows, grazes | {"Omega": [1, 2]}),
        "grazing_start": (s.grazing_start, grazes | {"theta": 1}),
        "grazing_start t_m": (s.grazing_start, grazes | {"t_m": "1/2"}),
        "grazing_curve": (s.grazing_curve, grazes | {"n": 50}),
        "check_grazing": (s.check_grazing, grazes | {"n": 20}),
        "is_grazing": (s.is_grazing, grazes | {"x": 0, "theta": 1}),
        "solve_grazing": (s.solve_grazing, grazes | {"n": 50, "x_i": 4}),
        "theorem7": (s.theorem7, {"mapping": "P3", "gamma": 3, "amplitude": 5}),
        "values_containing": (s.values_containing, grazes | {"name": "Omega", "theta": "7*pi/6"}),
        "values_empty": (s.values_empty, {"p": P9, "mapping": "P3", "name": "Omega"}),
        "values_everything": (s.values_everything, grazes | {"name": "Omega", "order": "paper"}),
        "atlas": (
            s.atlas,
            {
                "what": P9,
                "over": {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)},
                "seconds": 1,
                "workers": 1,
            },
        ),
        "sweep": (s.sweep, swept),
        "sweep_status": (s.sweep_status, swept | {"path": "nowhere.nc"}),
        "plot.figure": (plot.figure, {"subject": "fig6", "t_end": 2, "panels": "a"}),
        "plot.sweep_figure": (
            plot.sweep_figure,
            grazes | {"name": "Omega", "low": "0.1", "high": 4},
        ),
        "Belt": (s.Belt, {"v": 1, "mu": 1, "mu_s": 2}),
        "Belt.replace": (belt.replace, {"mu": "1/3"}),
        "Oscillator": (s.Oscillator, law),
        "Oscillator.replace": (s.Oscillator(**law).replace, {"m": 1, "mu_s1": 2}),
        "Belt curve": (s.Belt, {"v": 1, "curve": [(0, 1), (1, "1/2")], "slope": 1}),
        "Belt.from_function": (
            s.Belt.from_function,
            {"v": 1, "mu": lambda w: 1, "until": 2, "pieces": 3, "mu_s": 2},
        ),
        "law_error": (
            s.law_error,
            {"law": lambda n: n, "quantity": lambda n: 1 / n**2, "pieces": 3},
        ),
        "plot.friction_figure": (plot.friction_figure, {"p": P9, "v": (0, 6)}),
    }


def of_answers() -> dict[str, tuple[Callable[..., Any], dict[str, Any]]]:
    """Return the functions and methods that need an answer of another, each with valid arguments."""
    s = symosc
    m = made
    nowhere = {"path": os.devnull}
    return {
        "certify": (s.certify, {"what": "fig6", "t_end": 2}),
        "crosscheck": (s.crosscheck, {"scene": "fig5", **m("samples")}),
        "crosscheck table": (
            s.crosscheck,
            {"scene": "fig5", "t": pd.DataFrame(m("samples")), "columns": {"t": "t"}},
        ),
        "CompiledResidual.__call__": (
            lambda x: m("residual")(x, *[np.array([0.5, 4])] * 3),
            {"x": np.array([1, 2])},
        ),
        "Sensitivities.__call__": (m("sensitivities"), {"t": [1, 2]}),
        "Trajectory.__call__": (m("trajectory"), {"t": [1, 2]}),
        "Trajectory.mode": (m("trajectory").mode, {"t": 1}),
        "Trajectory.force": (m("trajectory").force, {"alpha": 1, "t": 1}),
        "MovedTrajectory.__call__": (m("moved"), {"t": [1, 2]}),
        "MovedTrajectory.mode": (m("moved").mode, {"t": 1}),
        "MovedTrajectory.force": (m("moved").force, {"alpha": 1, "t": 1}),
        "FrequencyResponse.to_csv": (m("response").to_csv, nowhere),
        "FrequencyResponse.plot": (m("response").plot, {"panels": "a"}),
        "Trajectory.to_csv": (m("trajectory").to_csv, nowhere),
        "Trajectory.to_json": (m("trajectory").to_json, nowhere),
        "Trajectory.plot": (m("trajectory").plot, {"panels": "a", "boundary": 1, "columns": 1}),
        "PeriodicOrbit.__call__": (m("orbit"), {"t": [1, 2]}),
        "PeriodicOrbit.sensitivities": (m("orbit").sensitivities, {"wrt": "FN"}),
        "PeriodicOrbit.approach": (m("orbit").approach, {"scene": "fig9", "within": 1e-3}),
        "FollowedOrbit.__call__": (m("cycle"), {"t": [1, 2]}),
        "FollowedOrbit.sensitivities": (m("cycle").sensitivities, {"wrt": "FN"}),
        "FollowedOrbit.approach": (m("cycle").approach, {"scene": m("law scene"), "within": 1e-3}),
        "Branch.orbit": (m("branch").orbit, {"i": 0}),
        "Branch.parameters": (m("branch").parameters, {"i": 0}),
        "continue_border": (
            s.continue_border,
            {
                "branch": m("ended branch"),
                "end": 0,
                "parameter": "FN",
                "range": (9.9, 10.1),
                "step": 0.1,
                "max_points": 3,
            },
        ),
        "Border.at": (m("border").at, {"FN": 10}),
        "Border.beside": (m("border").beside, {"i": 0}),
        "Border.orbit": (m("border").orbit, {"i": 0}),
        "Border.network": (m("border").network, {}),
        "Border.words_beside": (m("border").words_beside, {"i": 0}),
        "plot.border_figure": (plot.border_figure, {"border": m("border")}),
        "Atlas.word_at": (m("atlas").word_at, {"Omega": 4, "FN": 10}),
        "Atlas.to_json": (m("atlas").to_json, nowhere),
        "GrazingWindow.contact": (m("window").contact, {"theta": 1}),
        "GrazingWindow.contains": (m("window").contains, {"theta": 1}),
        "GrazingCurve.sample": (m("curve").sample, {"theta_m": 1}),
        "ParameterRegion.contains": (m("region").contains, {"Omega": "1/5", "k": 1}),
        "ParameterValues.__contains__": (m("values").__contains__, {"value": "1/2"}),
        "EventTable.__getitem__": (m("events").__getitem__, {"trajectory": 0}),
        "EventTable.to_csv": (m("events").to_csv, nowhere),
        "Summary.__getitem__": (m("summary").__getitem__, {"motion": 0}),
        "CrossCheck.to_html": (m("check").to_html, nowhere),
        "Certificate.to_json": (m("certificate").to_json, nowhere),
        "plot.orbit_figure": (plot.orbit_figure, {"orbit": m("orbit"), "panels": "c"}),
        "plot.atlas_figure": (plot.atlas_figure, {"atlas": m("atlas")}),
        "plot.branch_figure": (plot.branch_figure, {"branch": m("branch"), "panels": "a"}),
        "plot.basin_figure": (plot.basin_figure, {"dataset": m("basins")}),
        "plot.bifurcation_figure": (plot.bifurcation_figure, {"dataset": m("line")}),
        "plot.attractors_figure": (plot.attractors_figure, {"found": m("attractors")}),
        "plot.return_map_figure": (plot.return_map_figure, {"found": m("return map"), "start": 1}),
        "ReturnMap.__call__": (m("return map").__call__, {"at": 1.0}),
        "ReturnMap.fixed_points": (m("return map").fixed_points, {}),
        "ReturnMap.orbit": (m("return map").orbit, {"at": 1.0, "n": 3}),
        "Bifurcation.name_at": (m("bifurcation").name_at, {"value": 0.4, "branch": "rest"}),
        "ReturnMap.exponent": (m("return map").exponent, {"at": 1.0, "n": 3, "skip": 1}),
        "plot.curve_figure": (plot.curve_figure, {"dataset": m("line"), "name": "events"}),
        "plot.map_figure": (plot.map_figure, {"dataset": m("dataset")}),
        "plot.swept_figure": (plot.swept_figure, {"dataset": m("dataset")}),
        "plot.certificate_figure": (plot.certificate_figure, {"certificate": m("certificate")}),
        "plot.response_figure": (plot.response_figure, {"found": m("response"), "panels": "b"}),
        "plot.fit_figure": (plot.fit_figure, {"found": m("fit"), "panels": "b"}),
        "plot.crosscheck_figure": (plot.crosscheck_figure, {"check": m("check"), "panels": "b"}),
        "plot.step_figure": (plot.step_figure, {"check": m("check"), "step": 0, "panels": "a"}),
        "plot.events_figure": (plot.events_figure, {"events": m("events")}),
        "plot.summary_figure": (plot.summary_figure, {"summary": m("summary")}),
        "plot.figure_grazing_curve": (
            plot.figure_grazing_curve,
            {"curve": m("curve"), "panels": "a"},
        ),
        "plot.region_figure": (plot.region_figure, {"region": m("region")}),
        "plot.save": (plot.save, {"drawing": m("drawing"), "path": "figure.png"}),
        "plot.score_figure": (plot.score_figure, {"scores": m("scores")}),
        "plot.window_figure": (plot.window_figure, {"windows": m("window"), "panels": "a"}),
        "Trajectory.samples": (m("trajectory").samples, {"times": 3}),
        "MotionSamples.to_csv": (m("trajectory").samples(3).to_csv, nowhere),
    }


def full(call: Callable[..., Any], given: dict[str, Any]) -> dict[str, Any]:
    """Return valid arguments with the defaults of all other parameters, in order."""
    named = inspect.signature(call).parameters.values()
    usual = {each.name: each.default for each in named if each.default is not each.empty}
    order = [
        each.name for each in named if each.kind not in (each.VAR_KEYWORD, each.VAR_POSITIONAL)
    ]
    found = usual | given
    return {name: found[name] for name in [*order, *(set(found) - set(order))]}


def is_valid(name: str, parameter: str, value: str, usual: Any) -> bool:
    """Tell whether a value may be accepted for a parameter of a call, as the documentation has it."""
    call = name.split()[0]
    special = f"{call} {parameter}"
    own = VALID.get(special, VALID.get(parameter, set()))
    return value in own or (value == "None" and usual is None)
