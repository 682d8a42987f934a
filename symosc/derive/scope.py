"""The scope of a derivation: the general oscillator, one scene, or numbers for some symbols of a
fragment.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import sympy as sp

from symosc.base.aliases import Expr
from symosc.base.exact import read_exact, show
from symosc.derive.steps import Step, equation
from symosc.friction import MAPS, NEIGHBOURS
from symosc.model import PARAMETER_NAMES, Parameters, by_name
from symosc.scenes import Scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import PAPER_LETTERS
from symosc.symbolic.theorem7 import rational
from symosc.words import read_word

v1, v2, v_lambda = sp.symbols("v_1 v_2 v_lambda", real=True)
BELTS = {1: v1, 2: v2}
#: Letters of belt lambda, whichever it is: its friction coefficient, and the domains below and
#: above its speed.
mu_lambda = sp.Symbol(r"\mu_\lambda", nonnegative=True)
LOWER = r"\lambda"
UPPER = r"\lambda+1"
#: The letters of the parameters.
LETTERS = {
    name: getattr(solution, name) for name in PARAMETER_NAMES if name not in ("v1", "v2")
} | {"v1": v1, "v2": v2}


def F(alpha: int | str) -> Expr:
    """Return the symbol of the acceleration in a domain alpha, F^(alpha)."""
    return named(f"F^{{({alpha})}}")


def G(order: int | str, alpha: int | str = r"\alpha") -> Expr:
    """Return the symbol of the G-function of an order in a domain alpha, G^(order, alpha)."""
    return named(f"G^{{({order},{alpha})}}")


@dataclass(frozen=True)
class Scope:
    """The subject of a derivation: a scene or, if `scene` is None, the oscillator with symbols for
    all parameters.
    """

    scene: Scene | None = None

    @property
    def values(self) -> tuple[tuple[str, Any], ...]:
        """The parameters given as numbers, by name; none without a scene."""
        if self.scene:
            return tuple(by_name(self.scene.parameters).items())
        return ()

    @cached_property
    def maps(self) -> tuple[str, ...]:
        """The mappings that occur: those of the scene's structure, or of its simulated motion."""
        if self.scene is None:
            return tuple(MAPS)
        structure = self.scene.structure
        if structure:
            used: Any = read_word(structure).labels
        else:
            used = simulate(self.scene, max_events=200).word
        return tuple(label for label in MAPS if label in used)

    @cached_property
    def domains(self) -> tuple[int, ...]:
        """The domains that occur: those on both sides of the boundaries that occur."""
        return tuple(
            sorted({side for boundary in self.boundaries for side in NEIGHBOURS[boundary]})
        )

    @cached_property
    def boundaries(self) -> tuple[int, ...]:
        """The boundaries (belts) that occur."""
        rows = [MAPS[label] for label in self.maps]
        belts = {plane.boundary for row in rows for plane in (row.start, row.end)}
        return tuple(sorted(belts)) or (1, 2)

    @cached_property
    def regimes(self) -> tuple[solution.Regime, ...]:
        """The damping regimes that the known numbers leave possible; just one if they decide it."""
        return solution.possible_regimes(self.numbers)

    @cached_property
    def numbers(self) -> dict[Expr, Expr]:
        """The known numbers by their symbols; for a scene also those of cm = c/m, w0sq = k/m and f0
        = B0/m.
        """
        numbers = {LETTERS[name]: rational(value) for name, value in self.values}
        if self.scene:
            derived = [solution.cm, solution.w0sq, solution.f0]
        else:
            derived = []
        return numbers | {name: PAPER_LETTERS[name].xreplace(numbers) for name in derived}

    @cached_property
    def display(self) -> dict[Expr, Expr]:
        """What to substitute before printing: numbers or, without a scene, the paper's symbols,
        such as c/m for cm.
        """
        if self.scene is None:
            return PAPER_LETTERS
        # The numbers of a scene leave one regime.
        return self.numbers | {
            name: value.subs(self.numbers) for name, value in self.regimes[0].letters.items()
        }

    def shown(self, expr: Expr) -> Expr:
        """Return an expression in the form to be printed, with `display` substituted."""
        return sp.sympify(expr).xreplace(self.display)

    def given(self) -> list[str]:
        """Return the given numbers as LaTeX equations, such as "$m = 1$"."""
        return [f"${latex(LETTERS[name])} = {show(value)}$" for name, value in self.values]


@dataclass(frozen=True)
class FragmentScope(Scope):
    """The subject of a fragment: numbers for some of its symbols, and the form in which the motion
    is written.
    """

    values: tuple[tuple[str, Any], ...] = ()
    form: str = (
        "entire"  # "entire" (the five basis functions) or "paper" (e^{-ct/2m} cos omega_d t)
    )
    digits: int | None = None  # to which numbers are rounded
    # what letters stand for in this fragment, such as the belt's speed for the velocity at the
    # start
    instances: dict[Expr, Expr] = field(default_factory=dict, hash=False, compare=False)

    def shown(self, expr: Expr) -> Expr:
        """Return an expression as printed: with the letters in `instances` and numbers put in,
        rounded to `digits`.
        """
        # Twice: the paper's letters may bring in letters that have an instance.
        expr = (
            sp.sympify(expr)
            .xreplace(self.instances)
            .xreplace(PAPER_LETTERS)
            .xreplace(self.instances)
        )
        expr = expr.xreplace(self.numbers)
        if self.digits is None or not self.values:
            return expr
        return _rounded(expr, self.digits)


def stated(p: Parameters, *names: str) -> tuple[str, tuple[Step, ...]]:
    """Return some parameters as LaTeX, such as "$m = k = 1$, $c = 2$", and the steps that check the
    numbers in it.
    """
    return valued({LETTERS[name]: rational(getattr(p, name)) for name in names})


def valued(values: dict[Expr, Expr]) -> tuple[str, tuple[Step, ...]]:
    """Return letters with their exact numbers as LaTeX, and the steps that check the numbers, as
    `stated` does.
    """
    groups: dict[Expr, list[str]] = {}
    for letter, value in values.items():
        groups.setdefault(value, []).append(latex(letter))
    text = ", ".join(f"${' = '.join(group)} = {latex(value)}$" for value, group in groups.items())
    return text, tuple(equation(letter, value, value) for letter, value in values.items())


def _rounded(expr: Expr, digits: int) -> Expr:
    """Round numbers, and constants such as sqrt(3), to `digits` digits.

    Whole numbers up to 100 stay.
    """
    if expr.is_number and not expr.has(sp.pi) and not (expr.is_Integer and abs(expr) <= 100):
        value = sp.N(expr, digits + 5)
        if value.is_Float and value != 0:
            return sp.Rational(str(sp.Float(value, digits)))
        return expr
    if expr.args and expr.is_Pow and expr.exp.is_number:
        return sp.Pow(_rounded(expr.base, digits), expr.exp)
    if expr.args:
        return expr.func(*(_rounded(part, digits) for part in expr.args))
    return expr


def fragment_scope(
    settings: dict[str, str],
    scene: Scene | None = None,
    form: str = "entire",
    digits: int | None = None,
) -> FragmentScope:
    """Return a fragment's scope, parameters from `settings` (texts) or `scene`.

    `form` is "entire" or "paper".
    """
    # To check the given parameters, the others get any allowed values, and so does the speed of the
    # other belt.
    if scene:
        base = scene.parameters
    else:
        base = Parameters(**dict.fromkeys(PARAMETER_NAMES, 1) | {"v1": -1, "v2": 1})
    speeds = {
        name: read_exact(name, settings[name])
        for name in ("v1", "v2")
        if name in settings and not scene
    }
    if "v1" in speeds:
        second_speed = {"v2": speeds["v1"] + 1}
    elif speeds:
        second_speed = {"v1": speeds["v2"] - 1}
    else:
        second_speed = {}
    complete = base.replace(**{**second_speed, **settings})
    values = tuple(
        (name, value) for name, value in by_name(complete).items() if scene or name in settings
    )
    return FragmentScope(None, values, form, digits)
