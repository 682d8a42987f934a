"""The pieces of the chapter on published results: tables of numbers, the free and the steady part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from symosc.derive.blocks import Table
from symosc.derive.comparisons import Value, number, table
from symosc.derive.latex import named
from symosc.derive.published import MP
from symosc.derive.steps import Check, Close, Relation, Step, StepError, StepEvidence, rounded
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import G, H, p_0, q_0
from symosc.symbolic.solution import E0, E1, E2, cm, w0sq

#: The basis functions are not independent.
RELATION = {E0: 1 - w0sq * E2 - cm * E1}
#: The multipliers.
LAMBDA = named(r"\rho_1"), named(r"\rho_2")


@dataclass(frozen=True)
class Ran(Check):
    """A printed decimal is the package's value to its last digit, and that value is near the formula's."""

    value: Value

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        Close(lambda: number(self.value.package), self.value.decimals).run(statement)
        off = abs(self.value.difference)
        if not off <= self.value.tolerance:
            raise StepError(str(statement), f"formula and package differ by {MP.nstr(off, 3)}")
        return StepEvidence("numeric", MP.nstr(off, 2), 1)


def numbers(key: str, caption: str) -> Table:
    """Return the table of values that are computed twice: by the formula, and by running the package."""
    values = table(key)
    said = any(value.said for value in values)
    rows = []
    for value in values:
        formula = Close(lambda value=value: number(value.formula), value.decimals)  # type: ignore[misc]
        cells = [_decimal(value.formula, value, formula), _decimal(value.package, value, Ran(value))]
        rows.append((f"${value.name}$", value.case, *cells, *([value.said] if said else [])))
    heads = ("", "", "formula", "run", *([""] if said else []))
    return Table(f"tab:literature-{key}", caption, heads, tuple(rows), columns="llrr" + "l" * said)


def _decimal(shown: Any, value: Value, check: Check) -> Step:
    statement = Relation(named("z"), "=", rounded(number(shown), value.decimals))
    return Step(statement, "", check, decimals=True)


def free_motion(start: Any, rate: Any) -> tuple[Any, Any]:
    """Return x and v of the free motion at tau: the flow without forces."""
    flow = solution.flow()
    at = {solution.x_i: start, solution.v_i: rate, solution.a_i: -w0sq * start - cm * rate, solution.f0: 0}
    return tuple(sp.expand(part.xreplace(at).xreplace(RELATION)) for part in (flow.x, flow.v))


def steady_part() -> dict[Any, Any]:
    """Return p_0 and q_0 by Cramer's rule from the two conditions of symmetry, with what G and H are."""
    rows = coulomb.symmetry()
    matrix = rows.jacobian([p_0, q_0])
    right = -rows.subs({p_0: 0, q_0: 0})
    first, second = matrix.copy(), matrix.copy()
    first[:, 0], second[:, 1] = right, right
    solved = coulomb.half_period()
    return {p_0: first.det() / matrix.det(), q_0: second.det() / matrix.det(), G: solved.G, H: solved.H}
