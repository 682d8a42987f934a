"""Formulas as LaTeX in the paper's notation, with terms in its order, and conditions as chains."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any, NamedTuple

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.latex import LatexPrinter

from symosc.base.aliases import Expr
from symosc.base.exact import show
from symosc.symbolic import maps, solution

_dot = r"\dot{x}"
_x = "x_{i+1}"
LATEX_NAMES = {
    solution.v: _dot,
    solution.v_i: rf"{_dot}_{{i}}",
    solution.a_i: r"\ddot{x}_{i}",
    maps.x_j: _x,
    maps.v_j: rf"{_dot}_{{i+1}}",
    maps.theta_j: r"\theta_{i+1}",
    maps.v_end: rf"{_dot}(\tau)",
    maps.a_end: r"\ddot{x}(\tau)",
    solution.A: r"A_\alpha",
    solution.A_m: r"\tfrac{A_\alpha}{m}",
    **{symbol: f"{symbol.name[0]}_{symbol.name[1]}" for symbol in solution.BASIS},
}

#: Terms of a sum stand in the order of the first of these letters that they have (the order of eq.
#: (5)).
ORDER = [
    "g", r"\dot{g}", r"\ddot{g}", "g^{(3)}", "C_4", "C_1", "C_2", "D_1", "D_2", "a_i", "A_m",
    "A", "A_0", "f0", "B_0", "k", "w0sq", "c", "cm", "mu_1", "mu_2", r"\mu_\lambda"
]  # fmt: skip
#: A term with x_i or one of these, and none of `ORDER`, stands in front.
SPEEDS = {"v_i", "v_1", "v_2", "v_lambda"}
#: What stands in front of a product as a fraction of its own, such as k/m.
PARAMETERS = {
    "m",
    "c",
    "k",
    "A",
    "A_0",
    "B_0",
    "Omega",
    "mu_1",
    "mu_2",
    "F_N",
    "cm",
    "w0sq",
    "f0",
    "h",
    "v_lambda",
}
PARAMETERS |= {r"\mu_\lambda", "a", r"\gamma", r"\kappa", "F", "c_j", "c_{j+1}"}
#: Sums that the paper writes with mu_1 in front, and so with the other sign: mu_1 - mu_2 and mu_1 +
#: mu_2.
DRAGS = {solution.mu2 - solution.mu1, -solution.mu1 - solution.mu2}


def named(latex: str, **assumptions: Any) -> Expr:
    """Return a symbol, real unless said otherwise, that prints as the given LaTeX."""
    return sp.Symbol(latex, **({"real": True} | assumptions))


def _term_key(term: Expr) -> tuple[float, bool, Any]:
    """Return the key by which the terms of a sum are sorted: the paper's order of their letters."""
    outside = [
        factor
        for factor in sp.Mul.make_args(term)
        if not factor.is_Add and not isinstance(factor, sp.exp)
    ]
    letters = {symbol.name for factor in outside or [term] for symbol in factor.free_symbols}
    letters = letters or {symbol.name for symbol in term.free_symbols}
    negative = term.could_extract_minus_sign()
    # Terms without a letter of ORDER stand in front of all others: positive numbers (-3), positions
    # and F_s (-2), positive terms of basis functions alone (-1.5), speeds (-1).
    rank: float = _place(letters)
    if rank == len(ORDER):
        bare = {
            symbol for factor in outside if not factor.is_Function for symbol in factor.free_symbols
        }
        if "x_i" in letters or any(name.startswith("F_{s") for name in letters):
            rank = -2
        elif letters & SPEEDS:
            rank = -1
        elif term.is_number and not negative:
            rank = -3
        elif bare <= set(solution.BASIS) and not negative:
            rank = -1.5
    return rank, negative, sp.default_sort_key(term)


def terms(expr: Expr) -> list[Expr]:
    """Return the terms of a sum in the order of printing, a positive one first if there is one."""
    ordered = sorted(sp.Add.make_args(expr), key=_term_key)
    first = next((term for term in ordered if not term.could_extract_minus_sign()), ordered[0])
    return [first, *(term for term in ordered if term is not first)]


#: Inequalities, and how each is printed once its smaller side stands first.
INEQUALITIES = sp.StrictLessThan, sp.LessThan, sp.StrictGreaterThan, sp.GreaterThan
LESS = {"<": "<", ">": "<", "<=": r"\leq", ">=": r"\leq"}


class _Quotient(NamedTuple):
    """The factors above and below the bar of a fraction."""

    above: list[Expr]
    below: list[Expr]


class PaperPrinter(LatexPrinter):
    """A sympy LaTeX printer with the paper's symbols, order and fractions."""

    def __init__(self, decimals: bool = False) -> None:
        super().__init__({"mul_symbol": "", "inv_trig_style": "full"})
        self.decimals = decimals

    def _print_Symbol(self, expr: Expr, style: str = "plain") -> str:
        """Print a symbol by its name in LATEX_NAMES, else as sympy does but x_i instead of x_{i}."""
        if expr in LATEX_NAMES:
            return LATEX_NAMES[expr]
        if re.search(r"[\\{^]", expr.name):
            return str(expr.name)
        return re.sub(r"_\{(\w|\\[a-z]+)\}", r"_\1", super()._print_Symbol(expr))

    def _print_Rational(self, expr: Expr) -> str:
        text = show(Fraction(int(expr.p), int(expr.q)))
        if self.decimals and "/" not in text:
            return text
        return super()._print_Rational(expr)

    def _print_Add(self, expr: Expr, order: Any = None) -> str:
        """Print a sum, its terms in the order of `terms`."""
        first, *rest = map(self._print, terms(expr))
        signed = (
            f" - {part[1:].lstrip()}" if part.startswith("-") else f" + {part}" for part in rest
        )
        return str(first) + "".join(signed)

    def _print_Mul(self, expr: Expr) -> str:
        """Print a product, with its quotients in front."""
        coefficient, _ = expr.as_coeff_Mul()
        negative = expr.could_extract_minus_sign() and coefficient < 0
        if negative:
            expr = -expr
        # A factor of DRAGS gives its minus sign to the whole product.
        for drag in DRAGS.intersection(sp.Mul.make_args(expr)):
            negative = not negative
            others = (factor for factor in sp.Mul.make_args(expr) if factor != drag)
            expr = sp.Mul(*others, -drag, evaluate=False)
        sign = "- " if negative else ""
        expr = _one_root(expr)
        if not expr.is_Mul:
            return sign + self._print(expr)
        front, rest = self._quotients(expr)
        if rest.below or not rest.above:
            return sign + self._fraction(front.above + rest.above, front.below + rest.below)
        # One fraction of all: without a quotient in front, with a sum below it, or where 1/m would
        # stand before a single factor.
        has_sum_below = any(factor.as_base_exp()[0].is_Add for factor in front.below)
        has_single_factor = not front.above and len(rest.above) == 1
        if not front.below or has_sum_below or has_single_factor:
            return sign + self._fraction(front.above + rest.above, front.below)
        fraction = self._fraction(front.above, front.below)
        return f"{sign}{fraction} {self._product(rest.above, alone=False)}"

    def _quotients(self, product: Expr) -> tuple[_Quotient, _Quotient]:
        """Return the factors of the fraction that stands in front (numbers and parameters), and all
        others.
        """
        front = _Quotient([], [])
        rest = _Quotient([], [])
        for factor in product.args:
            base, power = factor.as_base_exp()
            known = {symbol.name for symbol in base.free_symbols} <= PARAMETERS
            if factor.is_Rational:
                top, bottom = self._number_parts(factor)
                front.above.extend([top] * (top != 1))
                front.below.extend([bottom] * (bottom != 1))
            elif power.is_Rational and power < 0 and not factor.has(sp.exp):
                part = front if known else rest
                part.below.append(sp.Pow(base, -power))
            else:
                plain = known and not base.is_Add and not base.is_Function
                part = front if plain else rest
                part.above.append(factor)
        return front, rest

    def _number_parts(self, number: Expr) -> tuple[Expr, Expr]:
        """Return what stands above and below the bar for a rational number."""
        if self.decimals and "/" not in show(Fraction(int(number.p), int(number.q))):
            return number, sp.Integer(1)
        return sp.Integer(number.p), sp.Integer(number.q)

    def _fraction(self, above: list[Expr], below: list[Expr]) -> str:
        """Return the LaTeX of a quotient of two products of factors, without fractions in
        fractions.
        """
        if not below:
            return self._product(above)
        # A single factor needs no parentheses within a fraction, whatever it is.
        top, bottom = (
            self._print(factors[0]) if len(factors) == 1 else self._product(factors)
            for factors in (above, below)
        )
        if len(above) == 1 and above[0].is_Add and r"\frac" in top:  # no fractions in fractions
            return rf"\frac{{1}}{{{bottom}}} {_parentheses(top)}"
        return rf"\frac{{{top}}}{{{bottom}}}"

    def _product(self, factors: list[Expr], alone: bool = True) -> str:
        """Return the LaTeX of a product in the paper's order; if it is not `alone`, a single sum
        has parentheses.
        """
        parts: list[str] = []
        for factor in sorted(factors, key=_factor_key):
            text = self._print(factor)
            if factor.is_Add and not (alone and len(factors) == 1):
                text = _parentheses(text)
            elif parts and re.match(r"[\d.]", text):
                text = rf"\cdot {text}"
            parts.append(text)
        # A factor such as x_{i}(t) needs more room before the next one.
        has_function = any(part.startswith(("x_{", r"\dot")) and ")" in part for part in parts[:-1])
        if has_function:
            space = r" \, "
        else:
            space = " "
        return space.join(parts) or "1"

    def _print_Pow(self, expr: Expr) -> str:
        """Print a power; a symbol with a superscript gets parentheses, a negative power is a
        fraction.
        """
        base, power = expr.as_base_exp()
        if base.is_Symbol and power.is_Integer and power > 1 and "^" in self._print(base):
            return rf"\bigl({self._print(base)}\bigr)^{{{power}}}"
        if power.is_Rational and power < 0 and base != sp.E:
            return rf"\frac{{1}}{{{self._print(sp.Pow(base, -power))}}}"
        if base.is_Add and power.is_Integer:
            return rf"{_parentheses(self._print(base))}^{{{power}}}"
        return str(super()._print_Pow(expr))

    def _print_ExpBase(self, expr: Expr, exp: Any = None) -> str:
        """Print an exponential, with a quotient in the exponent on one line."""
        (exponent,) = expr.args
        above, below = sp.fraction(exponent)
        if below == 1 or above.is_Add or below.is_Add:
            return rf"e^{{{self._print(exponent)}}}"
        bottom = self._print(below)
        return rf"e^{{{self._print(above)}/{bottom if len(below.args) < 2 else f'({bottom})'}}}"

    def _print_sin(self, expr: Expr, exp: Any = None) -> str:
        """Print a sine or another function of an angle, without parentheses where none are needed."""
        name = rf"\{expr.func.__name__}" + (f"^{{{exp}}}" if exp else "")
        argument = expr.args[0]
        above, below = sp.fraction(argument)
        if below != 1 and not above.is_Add and not argument.could_extract_minus_sign():
            # As one fraction, with nothing beside it.
            factors_above, factors_below = (
                list(sp.Mul.make_args(product)) for product in (above, below)
            )
            text = self._fraction(factors_above, factors_below)
        else:
            text = self._print(argument)
        if argument.is_Symbol or argument.is_Mul:
            return f"{name} {text}"
        return f"{name}{_parentheses(text)}"

    _print_cos = _print_sinh = _print_cosh = _print_coth = _print_sin

    def _print_asin(self, expr: Expr, exp: Any = None) -> str:
        return rf"\arcsin{_parentheses(self._print(expr.args[0]))}"

    def _print_atan(self, expr: Expr, exp: Any = None) -> str:
        return rf"\arctan{_parentheses(self._print(expr.args[0]))}"

    def _print_log(self, expr: Expr, exp: Any = None) -> str:
        return rf"\ln{_parentheses(self._print(expr.args[0]))}"

    def _print_Interval(self, expr: Expr) -> str:
        """Print an interval, with tall brackets around fractions."""
        low, high, left_open, right_open = expr.args
        if left_open:
            opening = "("
        else:
            opening = "["
        if right_open:
            closing = ")"
        else:
            closing = "]"
        inside = f"{self._print(low)},\\, {self._print(high)}"
        if r"\frac" in inside:
            return rf"\left{opening}{inside}\right{closing}"
        return f"{opening}{inside}{closing}"

    def _print_Union(self, expr: Expr) -> str:
        parts = sorted(expr.args, key=lambda part: (part.args[0] != 0, sp.default_sort_key(part)))
        return r" \cup ".join(self._print(part) for part in parts)

    def _print_EmptySet(self, expr: Expr) -> str:
        return r"\varnothing"

    def _print_And(self, expr: Expr, char: Any = None) -> str:
        """Print conditions, separated by commas."""
        # Equations stand first, and two bounds of one expression as a chain a < b < c. Texts are
        # sorted together with whether they stand behind.
        texts = []
        conditions = list(expr.args)
        while conditions:
            condition = conditions.pop(0)
            partner = next(
                (partner for partner in conditions if _from_both_sides(condition, partner)), None
            )
            if partner is None:
                if isinstance(condition, sp.Or):
                    text = rf"\left({self._print(condition)}\right)"
                else:
                    text = self._print(condition)
                texts.append((not isinstance(condition, sp.Eq), text))
                continue
            conditions.remove(partner)
            if condition.lhs == condition.gts:
                low = condition
                high = partner
            else:
                low = partner
                high = condition
            a, b, c = (self._print(expr) for expr in (low.rhs, low.lhs, high.rhs))
            texts.append((False, f"{a} {LESS[low.rel_op]} {b} {LESS[high.rel_op]} {c}"))
        return r",\ ".join(text for _, text in sorted(texts))

    def _print_Or(self, expr: Expr, char: Any = None) -> str:
        # A chain of conditions has commas, so alternatives are joined by words.
        return r"\ \text{or}\ ".join(sorted(self._print(part) for part in expr.args))

    def _print_Derivative(self, expr: Expr) -> str:
        """Print a derivative d/dt, of a sum in parentheses."""
        (variable, count), *_ = expr.variable_count
        if count == 1:
            power = ""
        else:
            power = f"^{{{count}}}"
        operand = self._print(expr.expr)
        if expr.expr.is_Add:
            operand = _parentheses(operand)
        return rf"\frac{{d{power}}}{{d {self._print(variable)}{power}}} {operand}"

    def _print_Function(self, expr: Expr, exp: Any = None) -> str:
        """Print an undefined function with its arguments, such as x(t)."""
        if isinstance(expr, AppliedUndef):
            name = expr.func.__name__
            if exp:
                power = f"^{{{exp}}}"
            else:
                power = ""
            return rf"{name}{power}({', '.join(self._print(a) for a in expr.args)})"
        return str(super()._print_Function(expr, exp))


def _from_both_sides(first: Expr, second: Expr) -> bool:
    """Return whether one condition bounds an expression from below and the other bounds the same
    one from above.
    """
    comparable = (
        isinstance(first, INEQUALITIES)
        and isinstance(second, INEQUALITIES)
        and first.lhs == second.lhs
    )
    return comparable and (first.lhs == first.gts) != (second.lhs == second.gts)


def _factor_key(factor: Expr) -> tuple[int, int, Any]:
    """Return the key by which factors are sorted: numbers, parameters, other symbols and powers of
    sums, exponentials and sums, other functions.
    """
    base, _ = factor.as_base_exp()
    letters = {symbol.name for symbol in base.free_symbols}
    # First the kind of factor (0 to 4, in the order above), then its place among those of its kind.
    if factor.is_Rational:
        rank = 0, 0
    elif isinstance(factor, sp.exp):
        rank = 3, 0
    elif base.is_Add:
        if letters <= {"mu_1", "mu_2"}:  # mu_1 + mu_2 stands in front, as in the paper
            kind = 0
        elif factor.is_Pow:
            kind = 2
        else:
            kind = 3
        rank = kind, 1
    elif base.is_Function:
        rank = 4, 0
    elif letters <= PARAMETERS:
        rank = 1, _place(letters) + (letters == {"Omega"})  # Omega behind m and a
    else:
        rank = 2, int(not letters & {"x_i", "v_i", "a_i"})
    return *rank, sp.default_sort_key(factor)


def _place(letters: set[str]) -> int:
    """Return the place in `ORDER` of the first letter that is in `letters`; if none is, the length
    of `ORDER`.
    """
    return next((place for place, name in enumerate(ORDER) if name in letters), len(ORDER))


def _one_root(expr: Expr) -> Expr:
    """Write a quotient of roots, such as sqrt(k)/sqrt(m), as one root sqrt(k/m)."""
    roots = [
        factor
        for factor in sp.Mul.make_args(expr)
        if factor.is_Pow and abs(factor.exp) == sp.S.Half and factor.base.is_Symbol
    ]
    if not any(root.exp < 0 for root in roots):
        return expr
    others = [factor for factor in sp.Mul.make_args(expr) if factor not in roots]
    # A symbol with this text as its name: sympy would take the root apart again.
    root_symbol = sp.Symbol(rf"\sqrt{{{latex(sp.Mul(*roots) ** 2)}}}", positive=True)
    if others:
        return sp.Mul(*others, root_symbol, evaluate=False)
    return root_symbol


def _parentheses(text: str) -> str:
    """Return LaTeX in parentheses, large ones if it contains a fraction."""
    if r"\frac" in text:
        return rf"\left({text}\right)"
    return f"({text})"


def latex(expr: Expr, decimals: bool = False) -> str:
    """Return the LaTeX of an expression in the paper's notation."""
    return str(PaperPrinter(decimals).doprint(sp.sympify(expr)))
