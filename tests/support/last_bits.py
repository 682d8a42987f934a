"""Answers with all their bits, under other last bits of what numpy computes.

    python tests/support/last_bits.py       prints the answers as JSON
    python tests/support/last_bits.py 7     the same, with noise of seed 7 in what numpy returns

BLAS, LAPACK and numpy's vector loops differ in their last bits from processor to processor. The
promise is that no answer does. Noise plays a processor that is not here: each number that such a
function returns is moved by up to two units in its last place.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from functools import wraps
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np
from paper_orbits import BOTH_BELTS, FIG9, FIG10
from parameter_sets import COULOMB, PLANE, SHRINKS

from symosc import (
    continue_border,
    continue_orbit,
    find_orbit,
    frequency_response,
    residual,
    sensitivities,
    simulate,
)

#: Functions of numpy whose loops are chosen by the processor and differ in the last bits.
NOISY = (
    "sin",
    "cos",
    "tan",
    "exp",
    "exp2",
    "expm1",
    "log",
    "log2",
    "log10",
    "log1p",
    "sinh",
    "cosh",
    "tanh",
    "arcsin",
    "arccos",
    "arctan",
    "arctan2",
    "arcsinh",
    "arccosh",
    "arctanh",
    "cbrt",
    "power",
    "hypot",
    "angle",
    "dot",
    "vdot",
    "inner",
    "matmul",
    "einsum",
    "tensordot",
    "polyfit",
    "roots",
)
NOISY_LINALG = (
    "solve",
    "lstsq",
    "inv",
    "pinv",
    "eig",
    "eigh",
    "eigvals",
    "eigvalsh",
    "svd",
    "qr",
    "det",
    "norm",
    "cholesky",
    "cond",
)
UNDAMPED = COULOMB.replace(c=0, FN=1, mu1="0.1", Omega="1.5", v2=100)


def noisy(function: Callable[..., Any], rng: np.random.Generator) -> Callable[..., Any]:
    """Return `function` with errors of up to two units in the last place of all it returns."""

    def moved(value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(map(moved, value))
        array = np.asarray(value)
        if array.dtype.kind == "c":
            return moved(array.real) + 1j * moved(array.imag)
        if array.dtype.kind != "f":
            return value
        array = array + np.spacing(array) * rng.integers(-2, 3, array.shape)
        return array if np.ndim(value) else array[()]

    @wraps(function)
    def replaced(*args: Any, **kwargs: Any) -> Any:
        if kwargs.get("out") is not None:
            raise NotImplementedError("noise does not know where to go")
        return moved(function(*args, **kwargs))

    return replaced


def make_noise(seed: int) -> None:
    """Put noise into numpy's functions in this process."""
    if find_spec("numba"):
        import_module("numba.np.npyimpl")  # it asks numpy's own functions for their types
    rng = np.random.default_rng(seed)
    for module, names in ((np, NOISY), (np.linalg, NOISY_LINALG)):
        for name in names:
            setattr(module, name, noisy(getattr(module, name), rng))


def numbers(value: Any) -> Any:
    """Return a value as lists of text with all bits."""
    if isinstance(value, np.ndarray):
        return numbers(value.tolist())
    if isinstance(value, list | tuple):
        return [numbers(part) for part in value]
    if isinstance(value, dict):
        return {str(name): numbers(part) for name, part in value.items()}
    return repr(value)


def answers() -> Iterator[tuple[str, Any]]:
    """Yield answers by name."""
    roots = (
        ("Omega = 3", FIG9.replace(Omega=3), "P32", None),
        ("one belt at rest", COULOMB.replace(FN="1.1"), "P32", None),
        ("B0 = 4", FIG10.replace(B0=4), "P4645", None),
    )
    for name, p, word, periods in roots:
        yield f"root that is not an orbit: {name}", find_orbit(p, word, periods=periods).as_dict()
    for name, p, word in (
        ("fig9", FIG9, "P32"),
        ("fig10", FIG10, "P4645"),
        ("two belts", BOTH_BELTS, "P1748"),
    ):
        orbit = find_orbit(p, word)
        yield f"orbit: {name}", [orbit.as_dict(), orbit([0.1, 1.0, 2.5]), orbit.lyapunov]
    yield "orbit in digits", find_orbit(FIG9, "P32", digits=20).as_dict()
    yield "orbit's derivatives", find_orbit(FIG10, "P4645").sensitivities(("FN", "Omega")).dt
    yield (
        "without a damper",
        [find_orbit(UNDAMPED.replace(Omega=Omega), "P32").as_dict() for Omega in ("1.5", "0.5")],
    )
    yield "settled", find_orbit(SHRINKS).as_dict()
    for name, p, over, limits in (
        ("fig9", FIG9, "Omega", (3.98, 4.02)),
        ("no damper", UNDAMPED, "Omega", (1.49, 1.51)),
    ):
        branch = continue_orbit(p, "P32", over, limits)
        yield (
            f"branch: {name}",
            [branch.values, branch.points, branch.multipliers, branch.as_dict()["ends"]],
        )
    stick = continue_orbit(COULOMB.replace(FN="0.72"), "P32", "FN", (0.7, 0.8))
    border = continue_border(stick, 1, "Omega", PLANE, step="0.1")
    yield (
        "border",
        [border.points, border.words, [(each.kind, each.values) for each in border.special]],
    )
    response = frequency_response("fig9", {"Omega": [3.5, 4, 4.5]})
    yield (
        "response",
        [
            getattr(response, name)
            for name in ("word", "amplitude", "harmonic", "phase", "friction")
        ],
    )
    motion = sensitivities("fig5", ("mu1", "x0"))
    yield "derivatives", [motion.dt, motion([1.0, 2.0]), motion.lyapunov]
    yield "motion", simulate("fig5")([0.5, 1.5, 2.5])
    phases = np.linspace(0.1, 0.9, 9)
    yield "equations of a map", residual(FIG9, "P2", (phases, phases), (-phases, phases + 2))


def main() -> None:
    """Print the answers."""
    if sys.argv[1:]:
        make_noise(int(sys.argv[1]))
    print(json.dumps({name: numbers(value) for name, value in answers()}, indent=0))


if __name__ == "__main__":
    main()
