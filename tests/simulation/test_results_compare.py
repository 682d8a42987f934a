"""What functions return: equal, copied and pickled as values are.

And every class of it is public.
"""

from __future__ import annotations

import copy
import inspect
import pickle
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from samples import few

import symosc
from symosc import EventTable, Trajectory, load_scene, simulate, simulate_many

P = load_scene("fig5").parameters
FIG9 = load_scene("fig9").parameters
TRAJECTORY = simulate("fig5", t_end=5)


@pytest.mark.parametrize(
    "make",
    [
        lambda end: simulate("fig5", t_end=end),
        lambda end: simulate_many(P, [[0, 0, 0], [0, 1, 0]], end),
    ],
)
def test_results_compare_copy_and_pickle(make: Callable[[int], Trajectory | EventTable]) -> None:
    first = make(7)
    same = make(7)
    second = make(6)
    assert (first == same) is True
    assert (first == second) is False
    assert (first != second) is True
    assert (first == None) is False  # noqa: E711
    assert (first == "text") is False
    for copied in (copy.copy(first), copy.deepcopy(first), pickle.loads(pickle.dumps(first))):
        assert (copied == first) is True
    if isinstance(first, Trajectory):
        assert hash(first) == hash(same)


STICK_SLIP = symosc.Oscillator(m=1, c="1/10", k=1, belts=[symosc.Belt("1/5", mu="1/2", mu_s=1)])
SYMBOLS = sympy.symbols("gamma amplitude", real=True)
ORBIT = symosc.find_orbit(FIG9, "P32")

#: Samples that are off from some time on.
TIMES = np.linspace(0, 3, 31)
WRONG = TRAJECTORY(TIMES) + np.where(TIMES > 2, 0.01, 0) * np.array([[0], [1]])

#: A call of each public function, by its name; None for those that return no class of symosc.
CALLS: dict[str, Callable[[], Any] | None] = {
    "atlas": lambda: symosc.atlas(FIG9, {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, workers=1),
    "attractors": lambda: symosc.attractors(STICK_SLIP, [(0, 0, 0), (0, 2, 0)]),
    "bifurcation": None,  # its result is xarray's
    "certify": lambda: symosc.certify("fig5", t_end=5),
    "check_grazing": lambda: symosc.check_grazing(FIG9, "P2", n=5),
    "compiled_residual": None,
    "continue_border": lambda: symosc.continue_border(
        symosc.continue_orbit(FIG9, "P32", "Omega", (3.2, 4)), 0, "FN", (9, 11), step="0.1"
    ),
    "continue_orbit": lambda: symosc.continue_orbit(FIG9, "P32", "Omega", ("3.99", "4.01"), ORBIT),
    "crosscheck": lambda: symosc.crosscheck("fig5", TIMES, *WRONG),
    "find_orbit": lambda: ORBIT,
    "fit": lambda: symosc.fit("fig5", [(0.1223, "stick"), (1.221, "slip")], "mu1"),
    "frequency_response": lambda: symosc.frequency_response("fig9", {"Omega": [4, 5]}),
    "grazing_curve": lambda: symosc.grazing_curve(FIG9, "P2", n=9),
    "grazing_start": lambda: symosc.grazing_start(FIG9, "P2", "3.1"),
    "grazing_window": lambda: symosc.grazing_window(FIG9, "P2"),
    "grazing_windows": lambda: symosc.grazing_windows(FIG9, "P2", k=[1, 2]),
    "is_grazing": lambda: symosc.is_grazing(FIG9, "P2", 1, 2),
    "jacobian": None,
    "law_error": lambda: symosc.law_error(
        lambda pieces: STICK_SLIP.replace(k=1 + Fraction(1, pieces**2)), lambda law: float(law.k), 4
    ),
    "load_scene": lambda: load_scene("fig5"),
    "parameter_jacobian": None,
    "read_word": lambda: symosc.read_word("P32"),
    "residual": None,
    "return_map": lambda: symosc.return_map(FIG9, points=8),
    "scene_names": None,
    "sensitivities": lambda: symosc.sensitivities("fig5", t_end=5),
    "simulate": lambda: simulate("fig5", t_end=5),
    "simulate_many": lambda: simulate_many(P, [[0, 0, 0]], 5, use_numba=False),
    "solve_grazing": lambda: symosc.solve_grazing(FIG9, "P2", theta_j=3, n=9),
    "solve_map": lambda: symosc.solve_map(
        FIG9, "P2", ORBIT.points[0].x, float(FIG9.Omega) * ORBIT.points[0].t
    ),
    "sweep": None,  # its result is xarray's
    "sweep_status": None,  # tests/sweeps/test_sweep.py
    "theorem7": lambda: symosc.theorem7("P2", *SYMBOLS),
    "values_containing": lambda: symosc.values_containing(None, "P2", "k"),
    "values_empty": lambda: symosc.values_empty(None, "P2", "k"),
    "values_everything": lambda: symosc.values_everything(None, "P2", "k"),
}


SLOW = ("continue_orbit", "continue_border", "check_grazing", "grazing_windows", "atlas")


def test_every_public_function_is_called_below() -> None:
    functions = {name for name in symosc.__all__ if inspect.isfunction(getattr(symosc, name))}
    assert functions == set(CALLS)


def classes_in(value: Any) -> set[type]:
    """Return the classes of symosc of a value and of what its public attributes hold."""
    if (
        isinstance(value, (str, bytes, np.ndarray, int, float, complex, sympy.Basic))
        or value is None
    ):
        return set()
    if type(value).__module__.startswith("symosc"):
        computed = {type(value)}
    else:
        computed = set()
    names = [*getattr(type(value), "__slots__", ()), *getattr(value, "__dict__", ())]
    held = [getattr(value, name) for name in names if not name.startswith("_")]
    if isinstance(value, (dict, list, tuple)):
        if isinstance(value, dict):
            held += value.values()
        else:
            held += value
    return computed.union(*(classes_in(entry) for entry in held))


@pytest.mark.parametrize("name", few([name for name, call in CALLS.items() if call], *SLOW))
def test_what_a_public_function_returns_is_public_documented_and_comparable(name: str) -> None:
    call = CALLS[name]
    assert call is not None
    value = call()
    again = call()
    classes = classes_in(value)
    assert classes
    for entry in classes:
        assert getattr(symosc, entry.__name__, None) is entry, entry
        assert len((entry.__doc__ or "").split()) > 8, entry
        assert not (entry.__doc__ or "").startswith(f"{entry.__name__}("), (
            entry
        )  # what dataclasses and tuples write
    assert (value == again) is True
    assert (value != again) is False
    assert (value == "text") is False
    for copied in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
        assert (copied == value) is True
