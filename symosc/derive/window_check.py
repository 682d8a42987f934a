"""The check of a window of Theorem 7: a set of phases, for given signs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from symosc.derive.steps import Check, Relation, StepError, StepEvidence

g, a = sp.symbols("gamma a", real=True)
p, q = sp.symbols("p q", positive=True)


@dataclass(frozen=True)
class Window(Check):
    """The set on the right is where side (gamma + a sin theta) > 0, for given signs of gamma, a and |gamma| - |a|.

    Exact: the ends are zeros of gamma + a sin theta, which has at most two, and on each piece the sign is decided at a
    phase where the sine is 1, 0 or -1.
    """

    side: int
    gamma: Any
    amplitude: Any
    names: tuple[tuple[Any, Any], ...] = ()

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        parts = statement.right.args if isinstance(statement.right, sp.Union) else (statement.right,)
        for part in parts:
            for end in part.args[:2] if isinstance(part, sp.Interval) else ():
                self._check_end(statement, end, parts)
        for sine, phase in ((1, sp.pi / 2), (-1, 3 * sp.pi / 2), (0, sp.Integer(0)), (0, sp.pi)):
            value = self.side * (self.gamma + self.amplitude * sine)
            inside = sp.simplify(value).is_positive
            if inside is None:
                raise StepError(str(statement), f"the sign of {value} is undecided")
            if inside != self._contains(parts, phase):
                raise StepError(str(statement), f"is wrong at {phase}")
        return StepEvidence("exact", "0")

    def _check_end(self, statement: Relation, end: Any, parts: Any) -> None:
        if end in (0, 2 * sp.pi) and any(part.args[0] == 0 and part.args[2] == sp.false for part in parts):
            return  # an arc through 0
        angle = self._angle(end)
        zero = sp.simplify(sp.expand_trig(sp.sin(angle)) * self.amplitude + self.gamma)
        if zero != 0:
            raise StepError(str(statement), f"{end} is no zero of gamma + a sin theta, which is {zero} there")

    def _angle(self, end: Any) -> Any:
        for name, value in self.names:
            end = end.subs(name, value)
        return end.subs({g: self.gamma, a: self.amplitude})

    def _contains(self, parts: Any, phase: Any) -> bool:
        # Ends cannot cross a multiple of pi/2 while the signs stay: one set of numbers stands for all.
        numbers = {p: sp.Rational(3, 7), q: sp.Rational(2, 5)}
        for part in parts:
            if part == sp.S.EmptySet:
                continue
            low, high = (self._angle(end).subs(numbers) for end in part.args[:2])
            above = phase - low
            below = high - phase
            after = above > 0 or (part.args[2] == sp.false and above == 0)
            if after and (below > 0 or (part.args[3] == sp.false and below == 0)):
                return True
        return False
