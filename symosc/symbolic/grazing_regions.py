"""Regions of two parameters in which the window of a map has a property; see `symosc.symbolic.grazing_queries`.

With two parameters free the same inequalities as for one are written down, k v_lambda on the left and the drive on the
right. Points are decided exactly.
"""

from __future__ import annotations

import sympy as sp

from symosc.aliases import Expr
from symosc.errors import ParameterError
from symosc.mappings.theorem7_cases import Place
from symosc.model import Parameters
from symosc.symbolic.grazing_answers import (
    ASKS_EVERYTHING,
    ASKS_NOTHING,
    ASKS_PHASES,
    QUERY_LETTERS,
    GrazingQuestion,
    ParameterRegion,
)
from symosc.symbolic.phase_interval import PhaseInterval
from symosc.symbolic.theorem7 import rational, sign_of

# A Boolean `a > b` that sympy keeps as it is written.
OPEN_REGION, CLOSED_REGION = sp.StrictGreaterThan, sp.GreaterThan


def region(p: Parameters | None, where: Place, question: GrazingQuestion, full: bool) -> ParameterRegion:
    """Return the region of two parameters in which the answer to a question is yes."""
    if p is None:
        raise ParameterError("p", p, "must be Parameters where a region of two parameters is asked for")
    belt = f"v{where.boundary}"
    letters = {name: rational(getattr(p, name)) for name in ("k", "B0", "Omega", belt)}
    letters |= {name: QUERY_LETTERS[name] for name in question.names}
    level = where.side * letters["k"] * letters[belt]
    scale = abs(level.as_coeff_Mul()[0]) or sp.S.One  # k > 2, not 25 k > 50
    level, Omega = level / scale, letters["Omega"] / scale
    drive, size = where.side * letters["B0"] * Omega, sp.Abs(letters["B0"]) * Omega
    condition = {
        ASKS_PHASES: lambda: _containing(level, drive, question.theta, full),
        ASKS_NOTHING: lambda: CLOSED_REGION(-level, size),
        ASKS_EVERYTHING: lambda: _everything(level, size, full),
    }[question.asked]()
    return ParameterRegion(question, condition, p)


def _containing(level: Expr, drive: Expr, theta: Expr | PhaseInterval, full: bool) -> Expr:
    """Return when level + drive sin > 0 at a phase, or at every one of an interval."""
    if not isinstance(theta, PhaseInterval):
        return _at(level, drive, theta, True, full)
    lowest, highest = theta.extremes()
    # The smallest value is where the sine is smallest if drive > 0, and where it is largest if drive < 0.
    sign = 1 if drive.is_positive else -1 if drive.is_negative else 0
    extremes = [lowest] * (sign >= 0) + [highest] * (sign <= 0)
    conditions = [_at(level, drive, each.theta, each.attained, full) for each in extremes]
    if not all(each.attained for each in extremes):
        conditions.append(_at(level, drive, theta.between(), True, False))
    return sp.And(*conditions)


def _at(level: Expr, drive: Expr, theta: Expr, attained: bool, full: bool) -> Expr:
    """Return when a phase grazes; one that is not attained may be an end of the window."""
    left, right = level, -drive * sp.sin(theta)
    if not attained:
        return CLOSED_REGION(left, right)
    if full and sign_of(sp.cos(theta)) == 0 and not right.is_nonpositive:
        # The tangency of fourth order, where k v_lambda has the right sign.
        if right.is_positive:
            return CLOSED_REGION(left, right)
        return sp.Or(OPEN_REGION(left, right), sp.And(CLOSED_REGION(left, right), OPEN_REGION(left, 0)))
    return OPEN_REGION(left, right)


def _everything(level: Expr, size: Expr, full: bool) -> Expr:
    if not full:
        return OPEN_REGION(level, size)
    reached = CLOSED_REGION(level, size)
    return reached if size.is_positive else sp.And(reached, OPEN_REGION(level, 0))
