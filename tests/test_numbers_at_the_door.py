"""Numbers, names and ends that are hard to read: what is meant is taken, what is not is a sentence."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
import xarray as xr
from bad_values import refused

import symosc
from symosc import (
    OutputError,
    ParameterError,
    WordError,
    load_scene,
    simulate,
    simulate_many,
)
from symosc.base.exact import read_double, read_exact
from symosc.base.workers import process_pool

SCENE = load_scene("fig9")
P = SCENE.parameters
PARAMETERS = {name: getattr(P, name) for name in P.as_dict()}
ROWS = [[0, 0, 0], [0, 1, 0]]
#: A list in itself.
CIRCLE: list[Any] = []
CIRCLE.append(CIRCLE)
#: A number that no double can tell from 1.
CLOSE = "1." + "0" * 330 + "1"


class Nameless(float):
    """A number of a class whose text says something else."""

    def __str__(self) -> str:
        return "nonsense"

    __repr__ = __str__


class Mute(float):
    """A number whose text cannot be had."""

    def __str__(self) -> str:
        raise RuntimeError("no text")

    __repr__ = __str__


@pytest.mark.parametrize(
    ("name", "call", "words"),
    [
        ("v0", lambda: simulate("fig5", v0=mpmath.mpf("1e1000000000")), "exponent"),
        ("v0", lambda: simulate("fig5", v0=mpmath.mpf("-1e-1000000000")), "exponent"),
        ("k", lambda: P.replace(k=mpmath.mpf("1e1000000000")), "exponent"),
        ("t_end", lambda: simulate("fig5", t_end=mpmath.mpf("1e1000000000")), "exponent"),
        ("t_end", lambda: simulate("fig5", t_end=1e22), r"more than 1e\+08 forcing periods"),
        ("t_end", lambda: simulate_many(P, ROWS, 1e22), r"more than 1e\+08 forcing periods"),
        ("digits", lambda: simulate("fig5", digits=10**5000), "from 5 to 10000"),
        (
            "parameters",
            lambda: simulate_many(PARAMETERS | {"FN": []}, ROWS, 5),
            "since starts has 2",
        ),
        ("x_i", lambda: symosc.solve_map("fig9", "P2", 1e200, 0.727), r"at most 1e\+50"),
        ("wrt", lambda: simulate_many(P, ROWS, 5, wrt=np.array([])), "one or more"),  # type: ignore[arg-type]
        ("wrt", lambda: symosc.sensitivities("fig5", np.array([], dtype=str)), "one or more"),  # type: ignore[arg-type]
        ("record", lambda: symosc.sweep(SCENE, {"FN": [1]}, record=itertools.repeat("P2")), "text"),  # type: ignore[arg-type]
        ("FN", lambda: P.replace(FN=np.ma.masked), "masked"),
        ("FN", lambda: P.replace(FN=np.array(True)), "number"),
        ("FN", lambda: P.replace(FN=xr.DataArray(np.nan)), "finite"),
        ("FN", lambda: symosc.sweep(SCENE, {"FN": xr.DataArray(5.0)}), "LO:HI:N"),
        ("FN", lambda: symosc.sweep(SCENE, {"FN": np.array(5.0)}), "LO:HI:N"),
    ],
)
def test_what_is_no_number_in_range_is_one_sentence(
    name: str, call: Callable[[], Any], words: str
) -> None:
    with pytest.raises(ParameterError, match=words):
        call()
    refused(call, name)


@pytest.mark.parametrize(
    "word",
    [itertools.repeat("P2"), itertools.count(), iter(lambda: "P3", 0)],
    ids=["repeat", "count", "function"],
)
def test_a_word_without_an_end_is_refused(word: Any) -> None:
    with pytest.raises(WordError, match="may have at most 10,000 mappings"):
        symosc.read_word(word)
    with pytest.raises(WordError, match="may have at most 10,000 mappings"):
        symosc.find_orbit(P, itertools.cycle(["P2", "P3"]))


@pytest.mark.parametrize(("v0", "side"), [(CLOSE, "Omega2"), ("0." + "9" * 331, "Omega1")])
def test_a_start_beside_a_belt_by_less_than_any_double(v0: str, side: str) -> None:
    """Belt 1 of fig5 has v1 = 1: the mass begins above or below it, and sticks at once."""
    first = simulate("fig5", v0=v0, t_end=1).events[0]
    assert (first.t, first.kind, first.source, first.target) == (0, "stick", side, "belt1")
    assert simulate("fig5", v0="1", t_end=1).events == ()


@pytest.mark.parametrize("wrap", [np.array, xr.DataArray])
def test_arrays_without_dimensions_are_numbers(wrap: Callable[[Any], Any]) -> None:
    """Parameters, starts, ends, and entries of rows."""
    scalar = {name: wrap(float(value)) for name, value in PARAMETERS.items()}
    assert symosc.Parameters(**scalar) == P
    start: dict[str, Any] = {"t0": 0.0, "x0": 0.25, "v0": 0.5, "t_end": 3.0}
    wanted = simulate(P, **start)
    assert simulate(P, **{name: wrap(value) for name, value in start.items()}).events == (
        wanted.events
    )
    row = [wrap(0.0), wrap(0.25), wrap(0.5)]
    table = simulate_many(P, [row, row], wrap(3.0), use_numba=False)
    assert table[0].t.tolist() == table[wrap(1)].t.tolist() == [event.t for event in wanted.events]
    several = PARAMETERS | {"FN": [wrap(10.0), wrap("10")]}
    ends = [wrap(3.0), wrap(3)]
    starts = {"t0": wrap(0), "x0": [wrap(0.25)], "v0": wrap("1/2")}
    many = simulate_many(several, starts, ends, use_numba=False)
    assert many.t.tolist() == table.t.tolist()
    swept = symosc.sweep(SCENE, {"FN": [wrap(5.0), wrap(6.0)]}, t_end=wrap(1.0))
    assert swept.FN.values.tolist() == [5, 6]


def test_a_loop_over_a_coordinate() -> None:
    ds = symosc.sweep(SCENE, {"Omega": "3:5:3"}, t_end=1)
    sets = [P.replace(Omega=Omega) for Omega in ds.Omega]
    assert [p.Omega for p in sets] == [3, 4, 5]
    for p, Omega in zip(sets, ds.Omega, strict=True):
        window = symosc.grazing_windows(P, "P2", Omega=Omega)
        assert float(window.low) == float(symosc.grazing_windows(p, "P2").low)
    assert simulate(P, t0=0, x0=0, v0=0, t_end=ds.Omega[0]).t_end == 3


@pytest.mark.parametrize(
    "data", [itertools.repeat("P2"), range(10**12), CIRCLE], ids=["texts", "range", "circle"]
)
def test_data_without_an_end_are_refused(data: Any) -> None:
    refused(lambda: symosc.fit("fig5", data), "data")


@pytest.mark.parametrize("name", ["x" * 300, "a/" * 3000 + "b"])
def test_an_atlas_whose_file_cannot_be_named_is_not_begun(name: str) -> None:
    with pytest.raises(OutputError, match="File name too long"):
        symosc.atlas(P, {"Omega": (3.9, 4.1), "FN": (9.5, 10.5)}, path=name, workers=10**400)


def test_a_pool_has_no_more_processes_than_the_machine_has_cores() -> None:
    with process_pool(10**400, "spawn") as pool:
        assert list(pool.map(abs, [-1])) == [1]


def test_phases_of_no_number_have_no_contacts() -> None:
    window = symosc.grazing_window(P, "P2")
    assert window.contact(np.array([], dtype=str)).tolist() == []


def test_a_row_of_a_table_by_a_number_of_an_array() -> None:
    table = simulate_many(P, ROWS, 2, use_numba=False)
    assert table[np.array(-1)].t.tolist() == table[1].t.tolist()
    with pytest.raises(IndexError):
        table[2]
    for bad in (np.array(1.0), np.array("1"), True):
        refused(lambda bad=bad: table[bad], "trajectory")  # type: ignore[misc]
    summary = simulate_many(P, ROWS, 7, record="summary", use_numba=False)
    assert str(summary[np.array(1)]) == str(summary[1])


def test_a_word_of_an_array_is_a_word() -> None:
    words = np.array(["P32", "P2"])
    assert str(symosc.read_word(words[0])) == "P32"
    assert str(symosc.find_orbit(P, words[0]).word) == "P32"


@pytest.mark.parametrize(
    "number",
    [np.str_("0.1"), np.array("1/10"), Nameless(0.1), Mute(0.1)],
    ids=["str_", "array", "nameless", "mute"],
)
def test_a_number_of_any_class_is_that_number(number: Any) -> None:
    force = P.replace(FN=number).FN
    assert force == Fraction(1, 10)
    wanted = simulate("fig5", v0="0.1", t_end=1, start_error="0.1")
    made = simulate("fig5", v0=number, t_end=1, start_error=number)
    assert (made.status, made.events) == (wanted.status, wanted.events)
    assert str(simulate_many(P, [[0, 0, number]], number, use_numba=False).status[0]) == "t_end"


def test_a_double_is_the_one_next_to_the_exact_number() -> None:
    """`read_double` has a quick way for floats and plain text, which reads and refuses the same."""
    rng = np.random.default_rng(1)
    texts = ["0", "-0.0", "nan", "inf", "1_0", "1e-2000", "1e51", "３", "1/3", "x", "", " 2 "]
    texts += ["+.5", "5.", "1e"]
    forms = ("{:.17g}", "{:.3f}", "{:e}", "{!r}")
    sizes = 10.0 ** rng.integers(-60, 60, 500)
    texts += [
        str(rng.choice(forms)).format(float(size)) for size in rng.uniform(-9, 9, 500) * sizes
    ]

    def outcome(read: Callable[[str, str], Any], text: str) -> Any:
        try:
            return float(read("x", text))
        except ParameterError as error:
            return str(error)

    for text in texts:
        assert outcome(read_double, text) == outcome(read_exact, text)
    for number in (0.1, 1e50, 1e51, float("nan"), np.float64(0.3), Fraction(1, 3), 7, True, None):
        assert outcome(read_double, number) == outcome(read_exact, number)  # type: ignore[arg-type]
