"""The same call gives the same bytes, whatever loops OpenBLAS and numpy choose for a processor."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy._core import _multiarray_umath as loops
from parameter_sets import COULOMB
from sources import nodes
from test_layers import MODULES

from symosc import find_orbit
from symosc.kernels import linear

SCRIPT = Path(__file__).parent / "support" / "last_bits.py"
#: OpenBLAS has loops for each; those of the last one need AVX-512.
KERNELS = ("Nehalem", "Haswell", "Zen", "SkylakeX")
#: What numpy chooses beside its least, and of that what came with AVX-512.
CHOSEN = [name for name in loops.__cpu_dispatch__ if loops.__cpu_features__[name]]
WIDEST = [name for name in CHOSEN if "AVX512" in name or name == "X86_V4"]


@cache
def answers(kernel: str = "", without: tuple[str, ...] = (), noise: str = "") -> dict[str, object]:
    """Return the answers of another process with loops of OpenBLAS for a processor.

    `without` are features that numpy is to leave alone, and `noise` is a seed.
    """
    variables = {"OPENBLAS_CORETYPE": kernel, "NPY_DISABLE_CPU_FEATURES": " ".join(without)}
    given = {name: value for name, value in variables.items() if value}
    others = {name: value for name, value in os.environ.items() if name not in variables}
    command = [sys.executable, str(SCRIPT), *([noise] if noise else [])]
    run = subprocess.run(command, env=others | given, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    found: dict[str, object] = json.loads(run.stdout)
    return found


def same(found: dict[str, object]) -> bool:
    """Assert that answers are those of this processor, byte by byte."""
    plain = answers()
    assert [name for name in plain if found.get(name) != plain[name]] == []
    return len(plain) > 10


@pytest.mark.slow
@pytest.mark.parametrize("kernel", KERNELS)
def test_answers_are_the_same_bytes_with_the_kernels_of_any_processor(kernel: str) -> None:
    if kernel == "SkylakeX" and not loops.__cpu_features__["AVX512F"]:
        pytest.skip("this processor has no AVX-512")
    assert same(answers(kernel, tuple(CHOSEN if kernel == "Nehalem" else WIDEST)))


@pytest.mark.slow
def test_answers_are_the_same_bytes_whatever_the_last_bits_of_numpy_are() -> None:
    assert same(answers(noise="1"))


@pytest.mark.full(3)
@pytest.mark.parametrize("seed", range(8))
def test_of_two_mirrored_roots_the_same_is_reported(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Both fail by the same, so that rounding errors alone would choose."""
    p = COULOMB.replace(FN="1.1")
    plain = find_orbit(p, "P32")
    rng = np.random.default_rng(seed)
    solve = linear.Factors.solve

    def noisy(self: linear.Factors, right: np.ndarray) -> np.ndarray:
        found = solve(self, right)
        return found + np.spacing(found) * rng.integers(-2, 3, found.shape)

    monkeypatch.setattr(linear.Factors, "solve", noisy)
    moved = find_orbit(p, "P32")
    assert np.allclose(plain.points, moved.points, rtol=0, atol=1e-12)
    assert plain.message == moved.message


# -- what the source may call ----------------------------------------------------------------------

#: Packages whose answers rest on no such functions, and why others may.
FREE = {
    "bench": "times other solvers",
    "crosschecks": "judges by tolerances that are far above last bits",
    "derive": "draws, and evaluates examples",
    "analysis.fitting": "hands its search to scipy, and judges by tolerances",
    "jax": "computes in jax's arithmetic",
    "paper": "integrates by scipy to compare, and draws",
    "plot": "draws",
}
NAMES = {
    "linalg",
    "dot",
    "vdot",
    "inner",
    "matmul",
    "einsum",
    "tensordot",
    "polyfit",
    "roots",
    "sin",
    "cos",
    "tan",
    "exp",
    "expm1",
    "log",
    "log1p",
    "sinh",
    "cosh",
    "tanh",
    "arcsin",
    "arccos",
    "arctan",
    "arctan2",
    "power",
    "hypot",
    "angle",
}
#: Uses that decide nothing and of which no bit is handed out, by module.
KNOWN = {
    "engine.arithmetic": {"sin", "cos"},  # of angles beyond WIDEST
    "grazing.check": {"sin", "cos"},  # samples of a numerical check with tolerances
    "grazing.window": {"sin"},  # what is nearer to an end than 1e-12 is decided exactly
    "kernels.entire_array": {"sin", "cos", "exp", "expm1"},  # replaced by `column_functions`
    "kernels.pair_columns": {"arctan2"},
    "reductions": {"sin", "cos"},  # the motion of belts in the coordinates of another model
}


@pytest.mark.parametrize(
    "name",
    sorted(name for name in MODULES if not any(f"{name}.".startswith(f"{free}.") for free in FREE)),
)
def test_no_answer_rests_on_functions_whose_last_bits_differ(name: str) -> None:
    found = set()
    for node in nodes(MODULES[name]):
        if isinstance(node, ast.Attribute) and ast.unparse(node.value) == "np":
            found |= {node.attr} & NAMES
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            found.add("@")
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "np.argsort":
            # The order of equal numbers depends on the processor unless it is "stable".
            found |= {"argsort"} - {"argsort" for each in node.keywords if each.arg == "kind"}
    assert found <= KNOWN.get(name, set())


# -- linear algebra --------------------------------------------------------------------------------


def random_matrix(rng: np.random.Generator, rows: int, columns: int, rank: int) -> np.ndarray:
    return rng.normal(size=(rows, rank)) @ rng.normal(size=(rank, columns))


@pytest.mark.parametrize("size", [1, 2, 3, 4, 8, 17])
def test_own_linear_algebra_agrees_with_lapack(size: int) -> None:
    rng = np.random.default_rng(size)
    matrix, right = rng.normal(size=(size, size)), rng.normal(size=size)
    assert np.allclose(linear.solve(matrix, right), np.linalg.solve(matrix, right))
    assert np.allclose(linear.inverse(matrix), np.linalg.inv(matrix))
    assert np.allclose(linear.product(matrix, right), matrix @ right)
    two = rng.normal(size=(2, 2))
    assert linear.largest_stretch(two) == pytest.approx(np.linalg.norm(two, 2))
    assert linear.norm(right) == pytest.approx(np.linalg.norm(right))
    for rank in {1, (size + 1) // 2, size}:
        poor = random_matrix(rng, size, size, rank)
        shortest = np.linalg.lstsq(poor, right, rcond=1e-9)[0]
        assert np.allclose(linear.Shortest(poor, 1e-9).solve(right), shortest)
    tall = rng.normal(size=(size + 2, size))
    assert np.allclose(linear.pseudo_inverse(tall, 1e-15), np.linalg.pinv(tall))
    wide = rng.normal(size=(size, size + 1))
    null = linear.null_vector(wide)
    assert np.abs(wide @ null).max() < 1e-13
    assert linear.norm(null) == pytest.approx(1)


def test_a_singular_matrix_is_refused_and_nothing_is_made_of_zeros() -> None:
    with pytest.raises(ZeroDivisionError, match="singular"):
        linear.solve(np.array([[1.0, 2.0], [2.0, 4.0]]), np.ones(2))
    assert linear.Shortest(np.zeros((2, 2)), 1e-9).solve(np.ones(2)).tolist() == [0.0, 0.0]
    with pytest.raises(ValueError, match="not finite"):
        linear.Shortest(np.array([[np.nan]]), 1e-9)
