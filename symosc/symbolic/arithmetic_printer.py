"""Writes formulas as arithmetic of names and small integers: what kernels are printed with."""

from __future__ import annotations

import sympy as sp

from symosc.aliases import Expr


class ArithmeticPrinter:
    """Writes an expression with + - * / over names and small integers.

    Terms and factors stand in the order in which the names were declared, not in sympy's, which may differ between its
    versions.
    """

    def __init__(self, names: dict[Expr, str], scratch: set[Expr]) -> None:
        self.names, self.scratch = names, scratch
        self.rank = {symbol: position for position, symbol in enumerate(names)}

    def text(self, expr: Expr) -> str:
        """Return the source of an expression."""
        if expr in self.names:
            return self.names[expr]
        if expr.is_Add:
            return self._sum(list(expr.args))
        if expr.is_Integer and expr >= 0:
            return str(expr)
        if _is_negative(expr):
            return f"-{self.text(-expr)}"
        above: list[Expr] = []
        below: list[Expr] = []
        for factor in sp.Mul.make_args(expr):
            base, power = (factor, sp.Integer(1)) if factor.is_Rational else factor.as_base_exp()
            if base.is_Rational:
                above += [sp.Integer(base.p)] * (base.p != 1)
                below += [sp.Integer(base.q)] * (base.q != 1)
            elif power.is_Integer and (base.is_Symbol or (base.is_Add and abs(power) == 1)):
                (above if power > 0 else below).extend([base] * abs(int(power)))
            else:
                raise ValueError(f"{factor} is no arithmetic of names: make it an argument or a step")
        if below and all(factor.is_Integer for factor in above + below):
            raise ValueError(f"{expr} would be rounded to a float")
        numerator, denominator = self._product(above), self._product(below)
        if len(below) > 1:
            denominator = f"({denominator})"
        return f"{numerator} / {denominator}" if below else numerator

    def _product(self, factors: list[Expr]) -> str:
        ordered = sorted(factors, key=lambda factor: (factor.is_Add, not factor.is_Integer, self._key(factor)))
        return " * ".join(f"({self.text(f)})" if f.is_Add else self.text(f) for f in ordered) or "1"

    def _sum(self, terms: list[Expr]) -> str:
        """Write names first and add the products up among themselves: x0 + (v0 * E1 + a0 * E2).

        After a short flight the start value is by far the largest term: so the sum is rounded once at its size.
        """
        if all(_is_negative(term) for term in terms):
            return f"-({self._sum([-term for term in terms])})"
        plain = self._sorted([term for term in terms if self._is_plain(term)])
        products = self._sorted([term for term in terms if not self._is_plain(term)])
        if not plain or len(products) < 2:
            return self._join(plain + products)
        if all(_is_negative(term) for term in products):
            return f"{self._join(plain)} - ({self._join([-term for term in products])})"
        return f"{self._join(plain)} + ({self._join(products)})"

    def _join(self, terms: list[Expr]) -> str:
        head = next((term for term in terms if not _is_negative(term)), terms[0])
        tail = [term for term in terms if term is not head]
        signed = (f" - {self.text(-term)}" if _is_negative(term) else f" + {self.text(term)}" for term in tail)
        return self.text(head) + "".join(signed)

    def _is_plain(self, term: Expr) -> bool:
        symbol = -term if _is_negative(term) else term
        return symbol.is_Integer or (symbol in self.names and symbol not in self.scratch)

    def _sorted(self, terms: list[Expr]) -> list[Expr]:
        return sorted(terms, key=self._key)

    def _key(self, expr: Expr) -> tuple[list[int], str]:
        return sorted(self.rank[symbol] for symbol in expr.free_symbols), self.text(expr)


def _is_negative(expr: Expr) -> bool:
    return bool(expr.as_coeff_Mul()[0].is_negative)
