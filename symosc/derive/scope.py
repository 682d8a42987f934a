"""What a derivation is about: the general oscillator, or one scene with its numbers put in exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import sympy as sp

from symosc.derive.latex import named
from symosc.model import NEIGHBOURS, Parameters
from symosc.scenes import Scene
from symosc.symbolic import solution
from symosc.symbolic.theorem7 import rational
from symosc.words import MAPS, read_word

Expr = Any  # sympy ships no types

v1, v2 = sp.symbols("v_1 v_2", real=True)
v_lambda = sp.Symbol("v_lambda", real=True)
BELTS = {1: v1, 2: v2}


@dataclass(frozen=True)
class Scope:
    """The scene of a derivation, or None for the general case."""

    scene: Scene | None = None

    @property
    def parameters(self) -> Parameters | None:
        """The scene's parameters."""
        return self.scene.parameters if self.scene else None

    @property
    def decimal(self) -> bool:
        """Whether numbers are printed as decimals where they end."""
        return self.scene is not None

    @cached_property
    def maps(self) -> tuple[str, ...]:
        """The mappings that occur: those of the scene's structure, or of its simulated motion."""
        if self.scene is None:
            return tuple(MAPS)
        if self.scene.structure:
            used = set(read_word(self.scene.structure).labels)
        else:
            from symosc.simulation.simulate import simulate

            used = set(simulate(self.scene, max_events=200).word)
        return tuple(label for label in MAPS if label in used)

    @cached_property
    def domains(self) -> tuple[int, ...]:
        """The domains that occur: of the maps, and on both sides of their belts."""
        if self.scene is None:
            return 1, 2, 3
        return tuple(sorted({side for boundary in self.boundaries for side in NEIGHBOURS[boundary]}))

    @cached_property
    def boundaries(self) -> tuple[int, ...]:
        """The boundaries (belts) that occur."""
        if self.scene is None:
            return 1, 2
        return tuple(sorted({plane.boundary for label in self.maps for plane in MAPS[label][1:3]})) or (1, 2)

    @cached_property
    def regimes(self) -> tuple[solution.Regime, ...]:
        """The damping regimes: the scene's only one, or all."""
        table = tuple(solution.REGIMES.values())
        if self.parameters is None:
            return table
        return tuple(r for r in table if r.condition.subs(self.numbers, simultaneous=True) == sp.true)

    @cached_property
    def numbers(self) -> dict[Expr, Expr]:
        """The scene's numbers for the letters, exactly."""
        p = self.parameters
        if p is None:
            return {}
        named_numbers = {name: rational(getattr(p, name)) for name in p.as_dict()}
        letters = {"A0": solution.A0, "B0": solution.B0, "mu1": solution.mu1, "mu2": solution.mu2, "FN": solution.FN}
        letters |= {"m": solution.m, "c": solution.c, "k": solution.k, "Omega": solution.Omega, "v1": v1, "v2": v2}
        found = {letters[name]: value for name, value in named_numbers.items()}
        m, c, k, B0 = (found[letter] for letter in (solution.m, solution.c, solution.k, solution.B0))
        return found | {solution.cm: c / m, solution.w0sq: k / m, solution.f0: B0 / m}

    @cached_property
    def display(self) -> dict[Expr, Expr]:
        """What is put in before printing: numbers, or the paper's letters for the quantities divided by m."""
        if self.parameters is not None:
            regime = {} if not self.regimes else self.regimes[0].letters
            return self.numbers | {letter: value.subs(self.numbers) for letter, value in regime.items()}
        s = solution
        return {s.cm: s.c / s.m, s.w0sq: s.k / s.m, s.f0: s.B0 / s.m, s.A_m: s.A / s.m}

    def shown(self, expr: Expr) -> Expr:
        """Return an expression as it is printed."""
        return sp.sympify(expr).xreplace(self.display) if self.display else expr

    def table(self) -> list[tuple[str, str]]:
        """Return the scene's numbers as (LaTeX name, value)."""
        return latex_names(self.parameters.as_dict()) if self.parameters else []


def latex_names(numbers: dict[str, str]) -> list[tuple[str, str]]:
    """Return parameters as (LaTeX name, value)."""
    latex = {"A0": "A_0", "B0": "B_0", "Omega": r"\Omega", "v1": "v_1", "v2": "v_2", "FN": "F_N"}
    latex |= {"mu1": r"\mu_1", "mu2": r"\mu_2"}
    return [(latex.get(name, name), value) for name, value in numbers.items()]


#: Letters of belt lambda, whichever it is: its friction coefficient, and the domains below and above its speed.
mu_lambda = sp.Symbol(r"\mu_\lambda", nonnegative=True)
LOWER, UPPER = r"\lambda", r"\lambda+1"


def F(alpha: int | str) -> Expr:
    """Return the letter of the acceleration in a domain."""
    return named(f"F^{{({alpha})}}")


def G(order: int | str, alpha: int | str = r"\alpha") -> Expr:
    """Return the letter of a G-function."""
    return named(f"G^{{({order},{alpha})}}")
