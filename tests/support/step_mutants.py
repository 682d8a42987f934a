"""Wrong neighbours of a step: what its check has to refuse."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from random import Random
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from symosc.derive.steps import DIFFERENT, KNOWN, Step, points

Expr = Any  # sympy ships no types
Changes = Callable[[Expr], Iterator[Expr]]
#: An inequality is broken by turning it round.
TURNED = {">": "<", "<": ">", ">=": "<", "<=": ">"}


def mutations(
    step: Step, kinds: tuple[str, ...] = ("sign", "factor", "exponent"), dice: Random | None = None
) -> Iterator[Step]:
    """Yield the step with one sign, factor or exponent of a side changed, or with < and > exchanged.

    Changes that leave the statement true, such as cos(-x) or 0 = 2 f, are left out. `dice` shuffles
    the changes of a side.
    """
    if step.op in TURNED:
        yield replace(step, op=TURNED[step.op])
        return
    for kind in kinds:
        for name in ("left", "right"):
            side = getattr(step, name)
            if side.is_Symbol and (name == "left" or step.left.is_Symbol):
                continue
            rest = step.right if name == "left" else step.left
            changes = list(CHANGES[kind](side))
            if dice:
                dice.shuffle(changes)
            for changed in changes:
                if _differs(side, changed) and not (rest == 0 and _is_multiple(side, changed)):
                    yield replace(step, **{name: changed})


def broken_once(step: Step, dice: Random) -> Step:
    """Return the step broken at one place: in a sign, a factor or an exponent, or, without any, by adding 1."""
    kinds = ["sign", "factor", "exponent"]
    dice.shuffle(kinds)
    for kind in kinds:
        if found := next(mutations(step, (kind,), dice), None):
            return found
    if isinstance(step.right, sp.Set):
        return replace(step, right=sp.S.EmptySet)
    return replace(step, right=step.right + 1)


def _is_multiple(side: Expr, changed: Expr) -> bool:
    """Tell whether a side was only multiplied by a number, or raised to a power."""
    if changed.is_Pow and changed.base == side:
        return True
    places = list(points(sp.Tuple(side, changed), count=2))
    ratios = [sp.N((changed / side).xreplace(place), 30) for place in places]
    return bool(abs(ratios[0] - ratios[1]) < DIFFERENT)


# --- signs ---


def _sign_changes(expr: Expr) -> Iterator[Expr]:
    if isinstance(expr, sp.Expr) and not expr.is_Add and expr != 0:
        yield -expr
    yield from _inner_signs(expr)


def _inner_signs(expr: Expr) -> Iterator[Expr]:
    if isinstance(expr, (sp.Derivative, sp.Integral, sp.Limit)):
        return
    if isinstance(expr, sp.Set):
        yield from _set_changes(expr)
        return
    if isinstance(expr, sp.Function):
        yield expr.func(-expr.args[0])
    if expr.is_Add:
        for term in expr.args:
            yield sp.Add(*(-other if other is term else other for other in expr.args))
    yield from _in_parts(expr, _inner_signs)


def _set_changes(phases: Expr) -> Iterator[Expr]:
    """Yield the set with the sign of one part of an end changed.

    The empty set becomes everything and vice versa.
    """
    circle = sp.Interval.Ropen(0, 2 * sp.pi)
    if phases in (sp.S.EmptySet, circle):
        if phases == sp.S.EmptySet:
            yield circle
        else:
            yield sp.S.EmptySet
        return
    parts = (phases,)
    if isinstance(phases, sp.Union):
        parts = phases.args
    for place, part in enumerate(parts):
        for end in (0, 1):
            for changed in _inner_signs(part.args[end]):
                new = [*part.args]
                new[end] = changed
                others = [
                    sp.Basic.__new__(sp.Interval, *new) if at == place else p
                    for at, p in enumerate(parts)
                ]
                if len(others) == 1:
                    yield others[0]
                else:
                    yield sp.Union(*others, evaluate=False)


# --- factors and exponents ---


def _factor_changes(expr: Expr) -> Iterator[Expr]:
    """Yield the expression with one term doubled, anywhere in it."""
    if not isinstance(expr, sp.Expr) or isinstance(expr, (sp.Derivative, sp.Integral, sp.Limit)):
        return
    if expr.is_Add:
        for term in expr.args:
            yield sp.Add(*(2 * other if other is term else other for other in expr.args))
    elif expr != 0:
        yield 2 * expr
    if not expr.is_number:
        yield from _in_parts(expr, _factor_changes)


def _exponent_changes(expr: Expr) -> Iterator[Expr]:
    """Yield the expression with one power raised, anywhere in it."""
    if not isinstance(expr, sp.Expr) or isinstance(expr, (sp.Derivative, sp.Integral, sp.Limit)):
        return
    if expr.is_number or isinstance(expr, AppliedUndef):
        return
    if expr.is_Symbol or isinstance(expr, sp.Function):
        yield expr**2
    elif expr.is_Pow and expr.exp.is_number:
        yield expr.base ** (expr.exp + 1)
    yield from _in_parts(expr, _exponent_changes)


CHANGES: dict[str, Changes] = {
    "sign": _sign_changes,
    "factor": _factor_changes,
    "exponent": _exponent_changes,
}


def _in_parts(expr: Expr, changes: Changes) -> Iterator[Expr]:
    """Yield the expression with one of its parts changed."""
    for position, part in enumerate(expr.args):
        if part.is_Number and not expr.is_Add:
            continue
        for changed in changes(part):
            parts = [*expr.args]
            parts[position] = changed
            yield expr.func(*parts)


def _differs(one: Expr, other: Expr) -> bool:
    if isinstance(one, sp.Set):
        return bool(one != other)
    if one.has(sp.Function) and one.atoms(sp.Function) - one.atoms(*KNOWN):
        return bool(sp.simplify(one - other) != 0)
    return any(
        abs(sp.N((one - other).subs(point, simultaneous=True), 30)) > DIFFERENT
        for point in points(one - other, count=2)
    )
