"""The basis functions of a flight for given parameters, from their closed forms with 60 digits."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import sympy as sp

from symosc.derive.steps import CONTEXT, number
from symosc.model import Parameters
from symosc.symbolic import solution
from symosc.symbolic.theorem7 import rational

#: The functions that the closed forms of E0, E1 and E2 contain.
FUNCTIONS = ("sin", "cos", "sinh", "cosh", "exp", "sqrt")


@cache
def flight_basis(p: Parameters) -> Callable[[Any], list[Any]]:
    """Return the function of a time that returns E0, E1 and E2 there."""
    values = {solution.m: p.m, solution.c: p.c, solution.k: p.k, solution.Omega: p.Omega}
    known = {letter: rational(value) for letter, value in values.items()}
    (regime,) = solution.possible_regimes(known)
    numbers = {letter: number(value) for letter, value in values.items()}
    for letter, meaning in regime.letters.items():
        numbers[letter] = _function(tuple(values), meaning)(*(numbers[name] for name in values))
    closed = regime.basis()
    letters = (solution.tau, *numbers)
    closed_forms = _function(
        letters, [closed[name] for name in (solution.E0, solution.E1, solution.E2)]
    )

    def basis(time: Any) -> list[Any]:
        return [number(value) for value in closed_forms(number(time), *numbers.values())]

    return basis


def _function(letters: tuple[Any, ...], expr: Any) -> Callable[..., Any]:
    # Numbers are arguments: written into the function, a fraction would be a double.
    return sp.lambdify(letters, expr, {name: getattr(CONTEXT, name) for name in FUNCTIONS})
