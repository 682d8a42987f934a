"""What a fragment is about: all letters, or numbers for some of them; and in which form it is printed."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import sympy as sp

from symosc.derive.scope import Scope, latex_names, v1, v2
from symosc.errors import ParameterError
from symosc.exact import read_exact, show
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import Scene
from symosc.symbolic import solution
from symosc.symbolic.theorem7 import rational

Expr = Any  # sympy ships no types

FORMS = ("entire", "paper")
LETTERS = {
    "m": solution.m,
    "c": solution.c,
    "k": solution.k,
    "A0": solution.A0,
    "B0": solution.B0,
    "Omega": solution.Omega,
    "v1": v1,
    "v2": v2,
    "mu1": solution.mu1,
    "mu2": solution.mu2,
    "FN": solution.FN,
}
#: Any allowed parameters, to check the ones that are given.
STAND_INS = dict.fromkeys(PARAMETER_NAMES, 1) | {"v1": -1, "v2": 1}


@dataclass(frozen=True)
class FragmentScope(Scope):
    """Numbers for some letters, and the form of the motion.

    Attributes
    ----------
    values : tuple of (str, Fraction)
        Parameters that are given as numbers.
    form : {"entire", "paper"}
        The five basis functions, or e^{-ct/2m} cos omega_d t.
    digits : int or None
        Numbers are rounded to so many digits; None: exact.
    instances : dict
        What letters are in this fragment, such as the velocity at the start.
    """

    values: tuple[tuple[str, Any], ...] = ()
    form: str = "entire"
    digits: int | None = None
    instances: dict[Expr, Expr] = field(default_factory=dict, hash=False, compare=False)

    @property
    def decimal(self) -> bool:
        """Whether numbers are printed as decimals where they end."""
        return bool(self.values)

    @property
    def letters(self) -> dict[Expr, Expr]:
        """The numbers by their letters."""
        return {LETTERS[name]: rational(value) for name, value in self.values}

    @property
    def regime(self) -> solution.Regime:
        """The damping regime that the numbers decide; if they leave several, the first of the table."""
        decided = {r: r.condition.subs(self.letters, simultaneous=True) for r in solution.REGIMES.values()}
        certain = [regime for regime, holds in decided.items() if holds == sp.true]
        return (certain or [regime for regime, holds in decided.items() if holds != sp.false])[0]

    def table(self) -> list[tuple[str, str]]:
        """Return the numbers as (LaTeX name, value)."""
        return latex_names({name: show(value) for name, value in self.values})

    def has(self, *names: str) -> bool:
        """Tell whether all of these parameters are numbers."""
        return set(names) <= {name for name, _ in self.values}

    def zero(self, name: str) -> bool:
        """Tell whether a parameter is the number 0."""
        return dict(self.values).get(name) == 0

    def shown(self, expr: Expr) -> Expr:
        """Return an expression as it is printed: instances and numbers put in, and rounded if wanted."""
        s = solution
        paper = {s.cm: s.c / s.m, s.w0sq: s.k / s.m, s.f0: s.B0 / s.m, s.A_m: s.A / s.m}
        expr = sp.sympify(expr).xreplace(self.instances).xreplace(paper).xreplace(self.instances)
        numbers = self.letters
        expr = expr.xreplace(numbers) if numbers else expr
        if self.digits is None or not numbers:
            return expr
        return _rounded(expr, self.digits)


def _rounded(expr: Expr, digits: int) -> Expr:
    """Round numbers, and constants such as sqrt(3), to so many digits; whole numbers up to 100 stay."""
    if expr.is_number and not expr.has(sp.pi) and not (expr.is_Integer and abs(expr) <= 100):
        value = sp.N(expr, digits + 5)
        if value.is_Float and value != 0:
            return sp.Rational(str(sp.Float(value, digits)))
        return expr
    if not expr.args or (expr.is_Pow and expr.exp.is_number):
        return expr if not expr.args else sp.Pow(_rounded(expr.base, digits), expr.exp)
    return expr.func(*(_rounded(part, digits) for part in expr.args))


def fragment_scope(
    settings: dict[str, str], scene: Scene | None = None, form: str = "entire", digits: int | None = None
) -> FragmentScope:
    """Return the scope for numbers as text; a scene gives all numbers that are not set.

    Raises
    ------
    ParameterError
        For a name that is no parameter, or a value that is not allowed.
    """
    if form not in FORMS:
        raise ParameterError("form", form, f"must be one of {', '.join(FORMS)}")
    if digits is not None and not 1 <= digits <= 50:
        raise ParameterError("digits", digits, "must be a whole number from 1 to 50")
    base = scene.parameters if scene else Parameters(**STAND_INS)
    stand_ins = {} if scene else _other_belt(settings)
    checked = base.replace(**{**stand_ins, **settings})
    given = [name for name in PARAMETER_NAMES if scene or name in settings]
    return FragmentScope(None, tuple((name, getattr(checked, name)) for name in given), form, digits)


def _other_belt(settings: dict[str, str]) -> dict[str, Any]:
    """Return an allowed speed of the belt that is not given, if the other one is."""
    if "v1" in settings and "v2" not in settings:
        return {"v2": read_exact("v1", settings["v1"]) + 1}
    if "v2" in settings and "v1" not in settings:
        return {"v1": read_exact("v2", settings["v2"]) - 1}
    return {}
