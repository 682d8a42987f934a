"""Wrong neighbours of a step: what its check has to refuse."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import sympy as sp

from symosc.derive.steps import DIFFERENT, KNOWN, Step, points

Expr = Any  # sympy ships no types


def mutations(step: Step) -> Iterator[Step]:
    """Yield the step with one sign changed.

    Of a term anywhere in a side, of a side, or with < and > exchanged.

    Changes that change nothing, such as cos(-x), are left out.
    """
    if step.op not in ("=", "in"):
        turned = {">": "<", "<": ">", ">=": "<", "<=": ">"}[step.op]
        yield replace(step, op=turned)
        return
    for name in ("left", "right"):
        side = getattr(step, name)
        if side.is_Symbol:
            continue
        for changed in _sign_changes(side):
            if _differs(side, changed):
                yield replace(step, **{name: changed})


def _sign_changes(expr: Expr) -> Iterator[Expr]:
    if isinstance(expr, sp.Expr) and not expr.is_Add and expr != 0:
        yield -expr
    yield from _inner_changes(expr)


def _inner_changes(expr: Expr) -> Iterator[Expr]:
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
    for position, part in enumerate(expr.args):
        for changed in _inner_changes(part):
            yield expr.func(
                *(changed if place == position else other for place, other in enumerate(expr.args))
            )


def _set_changes(phases: Expr) -> Iterator[Expr]:
    """Yield the set with the sign of one part of an end changed.

    The empty set becomes everything and vice versa.
    """
    circle = sp.Interval.Ropen(0, 2 * sp.pi)
    if phases in (sp.S.EmptySet, circle):
        yield circle if phases == sp.S.EmptySet else sp.S.EmptySet
        return
    if isinstance(phases, sp.Union):
        parts = phases.args
    else:
        parts = (phases,)
    for place, part in enumerate(parts):
        for end in (0, 1):
            for changed in _inner_changes(part.args[end]):
                new = [*part.args]
                new[end] = changed
                others = [
                    sp.Basic.__new__(sp.Interval, *new) if at == place else p
                    for at, p in enumerate(parts)
                ]
                yield others[0] if len(others) == 1 else sp.Union(*others, evaluate=False)


def _differs(one: Expr, other: Expr) -> bool:
    if isinstance(one, sp.Set):
        return bool(one != other)
    if one.has(sp.Function) and one.atoms(sp.Function) - one.atoms(*KNOWN):
        return bool(sp.simplify(one - other) != 0)
    return any(
        abs(sp.N((one - other).subs(point, simultaneous=True), 30)) > DIFFERENT
        for point in points(one - other, count=2)
    )
