"""LaTeX of grazing answers as papers print them: arcsin, pi before arcsines, brackets as tall as what they hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import sympy as sp
from sympy.printing.latex import LatexPrinter

from symosc.aliases import Expr

LESS = {sp.StrictLessThan: "<", sp.LessThan: r"\leq"}


class AnswerPrinter(LatexPrinter):
    """sympy's printer with the order of terms and the chains of inequalities that a reader expects."""

    def __init__(self) -> None:
        super().__init__({"inv_trig_style": "full"})

    def _as_ordered_terms(self, expr: Expr, order: Any = None) -> Sequence[Expr]:
        """Return multiples of pi first where arcsines follow."""
        terms: Sequence[Expr] = super()._as_ordered_terms(expr, order)
        arcs = [term for term in terms if term.has(sp.asin, sp.acos)]
        return [term for term in terms if term not in arcs] + arcs

    def _print_EmptySet(self, expr: Expr) -> str:
        return r"\varnothing"

    def _print_And(self, expr: Expr, char: Any = None) -> str:
        return r",\ ".join(self._chained(list(expr.args)))

    def _print_Or(self, expr: Expr, char: Any = None) -> str:
        # A chain has commas, so that alternatives are words.
        return r"\ \text{or}\ ".join(sorted(self._print(each) for each in expr.args))

    def _chained(self, conditions: list[Expr]) -> Iterable[str]:
        """Yield conditions, two bounds of one expression as a chain a < b < c; what is compared most comes last."""
        bounds = [_bound(each) for each in conditions]
        texts = []
        while conditions:
            each, (low, subject, high) = conditions.pop(0), bounds.pop(0)
            for i, (other_low, other, other_high) in enumerate(bounds):
                if subject is not None and subject == other and (low is None) != (other_low is None):
                    low, high = low or other_low, high or other_high
                    del conditions[i], bounds[i]
                    break
            if low and high:
                ends = [self._print(part) for part in (low[0], subject, high[0])]
                texts.append((True, f"{ends[0]} {LESS[low[1]]} {ends[1]} {LESS[high[1]]} {ends[2]}"))
            else:
                texts.append((isinstance(each, sp.Eq), self._print(each)))
        yield from (text for _, text in sorted(texts, key=lambda pair: (not pair[0], pair[1])))


def _bound(condition: Expr) -> tuple[Any, Any, Any]:
    """Return (low, subject, high) of an inequality, where low or high is (expression, kind) or None."""
    if not isinstance(condition, sp.StrictLessThan | sp.LessThan | sp.StrictGreaterThan | sp.GreaterThan):
        return None, None, None
    strict = isinstance(condition, sp.StrictLessThan | sp.StrictGreaterThan)
    kind = sp.StrictLessThan if strict else sp.LessThan
    bound = condition.rhs, kind
    return (bound, condition.lhs, None) if condition.lhs == condition.gts else (None, condition.lhs, bound)


def latex(expr: Expr) -> str:
    """Return LaTeX of a set of phases or values, a condition or an expression (no dollar signs)."""
    return str(AnswerPrinter().doprint(expr))
