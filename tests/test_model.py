"""Parameters and scenes: exact reading, immutability, and an error for everything that is wrong."""

from __future__ import annotations

import dataclasses
import pickle
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from types import ModuleType

import mpmath
import numpy as np
import pytest
import sympy

from symosc import simulate
from symosc.base.errors import ParameterError, SceneError, SymoscError
from symosc.base.exact import read_start_error, show, unmasked
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import Scene, load_scene, scene_names

VALUES = {
    "m": 1,
    "c": 1,
    "k": 1,
    "A0": -15,
    "B0": 10,
    "Omega": 1,
    "v1": 1,
    "v2": 5,
    "mu1": "0.8",
    "mu2": "0.6",
}
VALUES["FN"] = "9.81"
P = load_scene("fig5").parameters
START = {"t0": 0, "x0": 0, "v0": 0, "t_end": 5}
SHIPPED = ["fig5", "fig6", "fig7", "fig7-corrected", "fig7-exact", "fig8", "fig8-exact"]
SHIPPED += ["fig9", "fig9-orbit", "fig10", "fig10-orbit"]
CONTRACT = ["Parameters", "Scene", "ParameterError", "load_scene", "scene_names"]
CONTRACT += ["simulate", "simulate_many", "Trajectory", "Event"]


def parameters(**changes: object) -> Parameters:
    return Parameters(**(VALUES | changes))


# -- exact reading ---------------------------------------------------------------------------------------------------


def test_an_mpf_keeps_every_bit() -> None:
    with mpmath.workdps(60):
        tenth = mpmath.mpf(1) / 10
    read = parameters(c=tenth).c
    assert read != Fraction(1, 10)
    assert abs(read - Fraction(1, 10)) < Fraction(1, 10**59)
    assert read.denominator & (read.denominator - 1) == 0


def test_a_long_decimal_keeps_every_digit() -> None:
    text = "-3.10490096305158165661870252120914982217742324"
    assert load_scene("fig7-exact").x0 == Fraction(text)
    assert load_scene("fig7-exact").x0 != Fraction(text[:-1])
    assert Fraction(text) == parameters(A0=Decimal(text)).A0


def test_a_start_that_is_read_to_forty_digits_has_an_error() -> None:
    exact = Scene("mine", parameters(), t0=0, x0=Fraction(1, 3), v0="1/4 - 1/8", t_end="2*pi")
    rounded = Scene("mine", parameters(), t0=0, x0="pi/3", v0=0, t_end=9)
    assert exact.start_error is None
    assert rounded.start_error == (0, Fraction(1, 2 * 10**39), 0)
    assert rounded.started({"x0": 1}).start_error == (0, 0, 0)
    assert exact.started({"v0": "sqrt(2)"}).start_error == (0, 0, Fraction(1, 2 * 10**39))
    assert (
        simulate(parameters(), x0="pi/3", t_end="1T").events == simulate(rounded, t_end="1T").events
    )


def test_masked_numbers_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """While a thread loads numpy.ma, which has no classes yet, others read their numbers."""
    for value in (np.ma.array([1, 2], mask=[0, 1]), [np.ma.array(1, mask=True)], np.ma.masked):
        with pytest.raises(ParameterError, match="masked"):
            unmasked("x", value)
    assert unmasked("x", np.ma.array([1, 2])).tolist() == [1, 2]
    monkeypatch.setitem(sys.modules, "numpy.ma", ModuleType("numpy.ma"))
    assert unmasked("x", [1]) == [1]


def test_friction_forces_are_exact() -> None:
    p = parameters()
    assert [p.A(alpha) for alpha in (1, 2, 3)] == [
        Fraction("-1.266"),
        Fraction("-16.962"),
        Fraction("-28.734"),
    ]
    assert p.A(1) - p.A(2) == 2 * p.mu1 * p.FN
    assert p.A(2) - p.A(3) == 2 * p.mu2 * p.FN
    assert (p.belt(1), p.belt(2)) == (1, 5)
    assert (p.friction(1), p.friction(2)) == (p.mu1 * p.FN, p.mu2 * p.FN)
    for wrong in (p.A, p.belt, p.friction):
        with pytest.raises(ParameterError, match=r"alpha|boundary"):
            wrong(4)


# -- values, not variables -------------------------------------------------------------------------------------------


def test_parameters_are_frozen_hashable_values() -> None:
    p = parameters()
    same = parameters(mu1=0.8, m=Fraction(2, 2))
    assert p == same
    assert hash(p) == hash(same)
    assert len({p, same, p.replace(c=2)}) == 2
    with pytest.raises(dataclasses.FrozenInstanceError):
        p.c = Fraction(1)  # type: ignore[misc]
    assert pickle.loads(pickle.dumps(p)) == p


def test_repr_reads_back_exactly() -> None:
    p = parameters(c=Fraction(1, 3), A0="-1e-20", B0="12345678901234567890.5")
    assert eval(repr(p)) == p
    assert Parameters(**p.as_dict()) == p


def test_replace_changes_only_what_it_names() -> None:
    p = parameters()
    q = p.replace(c="0.3", v2=7)
    assert (q.c, q.v2) == (Fraction(3, 10), 7)
    assert {name for name in PARAMETER_NAMES if getattr(p, name) != getattr(q, name)} == {"c", "v2"}
    assert q.replace(c=1, v2=5) == p
    assert p.c == 1


# -- errors ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "value"),
    [("m", 0), ("m", -1), ("Omega", 0), ("Omega", "-1e-9"), ("v1", 5), ("v1", "5.0000001")]
    + [(name, "-1e-30") for name in ("c", "k", "mu1", "mu2", "FN")],
)
def test_values_out_of_range(name: str, value: object) -> None:
    with pytest.raises(ParameterError, match=f"^{name} = ") as caught:
        parameters(**{name: value})
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, SymoscError)
    assert "\n" not in str(caught.value)


# -- scenes ----------------------------------------------------------------------------------------------------------


def test_shipped_scenes_in_the_order_of_the_figures() -> None:
    papers = [name for name in scene_names() if name.startswith("fig")]
    assert sorted(papers) == sorted(SHIPPED)
    figures = [int(name.split("-")[0].removeprefix("fig")) for name in papers]
    assert figures == sorted(figures)
    assert papers == scene_names()[: len(papers)]


def test_every_shipped_scene_loads_and_is_sourced() -> None:
    for name in SHIPPED:
        scene = load_scene(name)
        assert scene.name == name
        assert scene.t_end > scene.t0
        assert "WSEAS" in scene.source
        assert hash(scene) == hash(load_scene(name))


PAPER = {  # A0, B0, Omega, c, k, m, v1, v2, mu1, mu2, FN; t0, x0, v0
    "fig5": "-15 10 1 1 1 1 1 5 0.8 0.6 9.81 0 0 0",
    "fig6": "5 10 0.1 1 1 1 1 5 0.8 0.6 9.81 0 0 5",
    "fig7": "5 10 1 2 2 1 5 10 0.7 0.2 9.81 2.5 -3.1049 1.3369",
    "fig8": "10 16 2 4 8 2 -4 4 0.8 0.5 19.62 2.5 5.8980 2.2580",
    "fig9": "-2 9 4 0.2 3 0.1 1 25 0.3 0.2 10 0.1324 4.5447 1",
    "fig10": "5 9 1.75 0.2 3 0.1 -12 1 0.5 0.3 10 0.4588 3.0837 1",
}


def test_scenes_hold_the_paper_s_numbers() -> None:
    names = ("A0", "B0", "Omega", "c", "k", "m", "v1", "v2", "mu1", "mu2", "FN")
    for name, row in PAPER.items():
        numbers = [Fraction(text) for text in row.split()]
        scene = load_scene(name)
        assert scene.parameters == Parameters(**dict(zip(names, numbers[:11], strict=True)))
        assert [scene.t0, scene.x0, scene.v0] == numbers[11:]
    printed, corrected, grazing = (
        load_scene(name) for name in ("fig7", "fig7-corrected", "fig7-exact")
    )
    assert printed.parameters.replace(A0=10) == corrected.parameters == grazing.parameters
    assert (printed.t0, printed.x0, printed.v0) == (corrected.t0, corrected.x0, corrected.v0)


SCENE_TEXT = """
name = "mine"
t_end = 2.5
[parameters]
m = 1
c = 0.2
k = "4/5"
A0 = 0.1
B0 = 1e1
Omega = 1
v1 = -1
v2 = 1
mu1 = 0.3
mu2 = 0.2
FN = 9.81
[start]
t0 = 0
x0 = 0.1000000000000000000000000000001
v0 = 0
"""


def test_a_scene_file_is_read_exactly(tmp_path: Path) -> None:
    file = tmp_path / "some file.toml"
    file.write_text(SCENE_TEXT, encoding="utf-8")
    for scene in (load_scene(file), load_scene(str(file))):
        assert scene.name == "mine"
        assert scene.parameters.k == Fraction(4, 5)
        assert scene.parameters.B0 == 10
        assert scene.x0 == Fraction(10**30 + 1, 10**31)
        assert (scene.t_end, scene.structure, scene.source) == (Fraction(5, 2), None, "")


@pytest.mark.parametrize(
    "name", ["fig11", "Fig5", "", "fig5.toml", "no/such/file.toml", ".", "a\0b", "n" * 5000]
)
def test_unknown_scenes(name: str) -> None:
    with pytest.raises(SceneError) as caught:
        load_scene(name)
    assert not {"\n", "\0"} & set(str(caught.value))


def test_start_errors_are_read_exactly() -> None:
    assert read_start_error(None) is None
    assert read_start_error("1e-30") == (Fraction(1, 10**30),) * 3
    assert read_start_error([0, 0.1, "1/3"]) == (0, Fraction(1, 10), Fraction(1, 3))
    assert Scene("s", P, **START).start_error is None
    scene = Scene("s", P, **START, start_error=(0, "5e-45", Decimal("5e-45")))
    assert scene.start_error == (0, Fraction(1, 2 * 10**44), Fraction(1, 2 * 10**44))
    assert hash(scene) == hash(pickle.loads(pickle.dumps(scene)))


@pytest.mark.parametrize("name", ["fig7-exact", "fig8-exact"])
def test_exact_scenes_are_known_to_half_a_unit_of_their_last_digit(name: str) -> None:
    scene = load_scene(name)
    assert scene.start_error is not None
    assert scene.start_error[0] == 0
    for value, error in zip((scene.x0, scene.v0), scene.start_error[1:], strict=True):
        digits = len(show(value).partition(".")[2])
        assert error == Fraction(1, 2 * 10**digits)


# -- layers ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "code",
    [
        "import symosc",
        "import symosc; assert len(symosc.simulate(symosc.load_scene('fig5')).events) == 16",
        "from symosc import sweep",
    ],
)
def test_the_numeric_path_loads_no_heavy_package(code: str) -> None:
    heavy = {"sympy", "matplotlib", "numba", "xarray", "pandas", "distributed"}
    program = f"{code}\nimport sys\nprint(*{heavy} & set(sys.modules))"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout.strip(), done.stderr) == (0, "", "")


def test_symosc_exposes_the_names_of_its_contract() -> None:
    import symosc

    for name in CONTRACT:
        assert hasattr(symosc, name), name
    assert symosc.Parameters is Parameters
    assert symosc.ParameterError is ParameterError
    with pytest.raises(AttributeError, match="no_such_name"):
        symosc.no_such_name  # noqa: B018


def test_four_fifths_in_every_form() -> None:
    texts = 0.8, "0.8", " 4/5 ", "8e-1", Fraction(4, 5), Decimal("0.80"), sympy.Rational(4, 5)
    for value in (*texts, np.float64(0.8), np.float32(0.8), np.array(0.8)[()]):
        assert parameters(mu1=value).mu1 == Fraction(4, 5)


def test_expressions_are_read_to_forty_digits() -> None:
    two_pi = "6.283185307179586476925286766559005768394"
    root = "0.3535533905932737622004221810524245196424"
    for given, digits in (("2*pi", two_pi), ("sqrt(2)/4", root), ("1/3 + 1/6", "0.5")):
        assert Fraction(digits) == parameters(A0=given).A0 == parameters(A0=sympy.sympify(given)).A0
