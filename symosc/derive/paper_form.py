r"""The motion in one domain as papers print it: e^{-ct/2m} (C_1 cos omega_d t + C_2 sin omega_d t) and a steady part.

The form has a case for each regime of damping; near the borders of the regimes it loses digits, which the entire
functions of `symosc.symbolic.solution` do not.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import sympy as sp

from symosc.derive.latex import named
from symosc.derive.steps import Solves
from symosc.symbolic import solution
from symosc.symbolic.solution import B0, A, Omega, Regime, c, eta, k, m, omega_0, omega_d, tau, theta_i, v_i, x_i

Expr = Any  # sympy ships no types

C1, C2, D1, D2 = (named(name) for name in ("C_1", "C_2", "D_1", "D_2"))
NORM = named(r"\Delta_k")
DECAY = sp.exp(-c * tau / (2 * m))
PHASE = theta_i + Omega * tau

#: Two solutions of the unforced equation in each regime.
MODES = {
    "underdamped": (DECAY * sp.cos(omega_d * tau), DECAY * sp.sin(omega_d * tau)),
    "critical": (DECAY, tau * DECAY),
    "overdamped": (DECAY * sp.cosh(eta * tau), DECAY * sp.sinh(eta * tau)),
    "undamped": (sp.cos(omega_0 * tau), sp.sin(omega_0 * tau)),
    "resonance": (sp.cos(Omega * tau), sp.sin(Omega * tau)),
    "no spring": (sp.Integer(1), sp.exp(-c * tau / m)),
    "free": (sp.Integer(1), tau),
}


class PaperForm(NamedTuple):
    """The motion of a regime.

    Attributes
    ----------
    x, v : Expr
        Position and velocity at tau, with the letters below.
    constants : dict
        What C_1, C_2 and D_1, D_2 are; the second ones may use the first.
    check : Solves
        Of the position.
    """

    x: Expr
    v: Expr
    constants: dict[Expr, Expr]
    check: Solves


def _steady(name: str) -> tuple[Expr, dict[Expr, Expr]]:
    """Return a particular motion, and what its letters are."""
    if name == "resonance":
        return A / k + B0 / (2 * m * Omega) * tau * sp.sin(PHASE), {}
    if name == "free":
        return A * tau**2 / (2 * m) - B0 / (m * Omega**2) * sp.cos(PHASE), {}
    wave = D1 * sp.cos(PHASE) + D2 * sp.sin(PHASE)
    if name == "undamped":
        return A / k + D1 * sp.cos(PHASE), {D1: B0 / (k - m * Omega**2)}
    norm = (k - m * Omega**2) ** 2 + c**2 * Omega**2
    letters = {D1: B0 * (k - m * Omega**2) / norm, D2: B0 * c * Omega / norm}
    if name == "no spring":
        norm = m**2 * Omega**2 + c**2
        return A * tau / c + wave, {D1: -B0 * m / norm, D2: B0 * c / (Omega * norm)}
    return A / k + wave, letters


@cache
def paper_form(regime: Regime) -> PaperForm:
    """Return the motion of a regime in the form of papers."""
    first, second = MODES[regime.name]
    below = {"underdamped": omega_d, "overdamped": eta, "undamped": omega_0, "resonance": Omega}
    steady, letters = _steady(regime.name)
    x = C1 * first + C2 * second + steady
    v = x.diff(tau)
    joined = sp.collect(C1 * first + C2 * second, [DECAY]) + steady
    start = {tau: sp.Integer(0)}
    equations = [x.subs(start) - x_i, v.subs(start) - v_i]
    found = sp.solve(equations, [C1, C2], dict=True)[0]
    shorter = {C1: found[C1], C2: found[C2]}
    if regime.name != "no spring":  # C_1 is plain there; C_2 is shorter with it
        shorter[C2] = sp.solve(equations[1], C2)[0]
    constants = letters | {C1: sp.expand(shorter[C1]), C2: _over(shorter[C2], below.get(regime.name, sp.Integer(1)))}
    values = regime.parameters()
    back = {c: m * values[solution.cm], k: m * values[solution.w0sq]}
    force = ((A + B0 * sp.cos(PHASE)) / m).xreplace(back)
    meaning = {letter: _resolved(value, constants).xreplace(back) for letter, value in constants.items()}
    check = _PaperSolves(force, x_i, v_i, *values.values(), meaning=meaning, back=tuple(back.items()))
    return PaperForm(joined, _grouped(v, first), constants, check)


def _over(expr: Expr, below: Expr) -> Expr:
    """Write a sum over one denominator."""
    return sp.Mul(sp.expand(expr * below), 1 / below, evaluate=False) if below != 1 else sp.expand(expr)


def _resolved(expr: Expr, meaning: dict[Expr, Expr]) -> Expr:
    return expr.xreplace(meaning).xreplace(meaning)


def _grouped(v: Expr, mode: Expr) -> Expr:
    """Write e^{-ct/2m} once, and within it each wave once."""
    if not mode.has(sp.exp):
        return sp.expand(v)
    v, stand_in = sp.expand(v), sp.Dummy()
    inside = v.xreplace({DECAY: stand_in}).coeff(stand_in)
    waves = sorted(inside.atoms(sp.sin, sp.cos, sp.sinh, sp.cosh), key=sp.default_sort_key)
    rows = {wave: inside.coeff(wave) for wave in waves} or {sp.Integer(1): inside}
    signed = (
        -wave * (-row) if all(term.could_extract_minus_sign() for term in sp.Add.make_args(row)) else wave * row
        for wave, row in rows.items()
    )
    return DECAY * sp.Add(*signed) + v.xreplace({DECAY: sp.S.Zero})


class _PaperSolves(Solves):
    """`Solves`, with c and k of the printed formula in the letters of the regime."""

    def __init__(self, *args: Any, back: tuple[tuple[Expr, Expr], ...] = (), **named_args: Any) -> None:
        super().__init__(*args, **named_args)
        object.__setattr__(self, "back", back)

    def run(self, statement: Any) -> Any:
        """See `Check`."""
        back = dict(self.back)  # type: ignore[attr-defined]
        return super().run(statement._replace(right=statement.right.xreplace(back)))
