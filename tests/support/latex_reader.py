"""Reads the LaTeX that derivations print back to a number, by the rules of a human reader.

An independent check.
"""

from __future__ import annotations

import cmath
import re

FUNCTIONS = {
    r"\sin": cmath.sin,
    r"\cos": cmath.cos,
    r"\sinh": cmath.sinh,
    r"\cosh": cmath.cosh,
    r"\coth": lambda z: 1 / cmath.tanh(z),
    r"\arcsin": cmath.asin,
    r"\arctan": cmath.atan,
    r"\ln": cmath.log,
}
SKIP = re.compile(
    r"(?:\s|\\,|\\cdot(?![a-z])|\\qquad|\\quad|&|\\left(?![a-z])|\\right(?![a-z])|\\[bB]igg?[lr](?![a-z]))+"
)
NUMBER = re.compile(r"\d+(?:\.\d+)?")


class Reader:
    """Evaluates one formula with `values`: printed name -> number."""

    def __init__(self, text: str, values: dict[str, complex]) -> None:
        self.text, self.place = text, 0
        self.in_bars = False
        self.values = dict(sorted(values.items(), key=lambda item: -len(item[0])))

    def value(self) -> complex:
        """Return the value of the whole text."""
        result = self.sum()
        assert self.place == len(self.text), (
            f"cannot read {self.text[self.place :]!r} in {self.text!r}"
        )
        return result

    def sum(self) -> complex:
        """Read terms up to a closing bracket or the end."""
        total = 0j
        if self.take("-"):
            sign = -1
        else:
            sign = 1
        while True:
            total += sign * self.product()
            if self.take("+"):
                sign = 1
            elif self.take("-"):
                sign = -1
            else:
                return total

    def product(self) -> complex:
        """Read juxtaposed factors."""
        result = self.factor()
        assert result is not None, f"no factor at {self.text[self.place :]!r} in {self.text!r}"
        while True:
            if self.take("/"):
                further = self.factor()
                assert further is not None, (
                    f"no divisor at {self.text[self.place :]!r} in {self.text!r}"
                )
                result /= further
            elif (further := self.factor()) is not None:
                result *= further
            else:
                return result

    def factor(self, plain: bool = False) -> complex | None:
        """Read a factor with its power.

        `plain`: only what may be the argument of a function without parentheses.
        """
        self.skip()
        base = self.base(plain)
        if base is not None and self.take("^"):
            base **= self.group()
        return base

    def base(self, plain: bool) -> complex | None:
        for name, number in self.values.items():
            if self.take(name):
                return number
        if found := NUMBER.match(self.text, self.place):
            self.place = found.end()
            return complex(found[0])
        if self.take(r"\frac") or self.take(r"\tfrac"):
            above = self.group()
            return above / self.group()
        if self.take(r"\pi"):
            return complex(cmath.pi)
        if plain:
            return None
        if self.take("("):
            return self.closed(")")
        if self.take("{"):
            return self.closed("}")
        if not self.in_bars and self.take("|"):
            self.in_bars = True
            inside = self.closed("|")
            self.in_bars = False
            return complex(abs(inside))
        if self.take(r"\sqrt"):
            return cmath.sqrt(self.group())
        if self.take("e^"):
            return cmath.exp(self.group())
        for name in sorted(FUNCTIONS, key=len, reverse=True):
            if self.take(name):
                return self.function(name)
        return None

    def function(self, name: str) -> complex:
        if self.take("^"):
            power = self.group()
        else:
            power = 1
        self.skip()
        if self.take("("):
            argument = self.closed(")")
        else:
            argument = 1 + 0j
            while (further := self.factor(plain=True)) is not None:
                argument *= further
        return FUNCTIONS[name](argument) ** power

    def group(self) -> complex:
        self.skip()
        assert self.take("{"), self.text[self.place :]
        return self.closed("}")

    def closed(self, bracket: str) -> complex:
        result = self.sum()
        assert self.take(bracket), (
            f"{bracket} expected at {self.text[self.place :]!r} in {self.text!r}"
        )
        return result

    def take(self, token: str) -> bool:
        self.skip()
        if not self.text.startswith(token, self.place):
            return False
        self.place += len(token)
        self.skip()
        return True

    def skip(self) -> None:
        if found := SKIP.match(self.text, self.place):
            self.place = found.end()
