"""Published results on the oscillator with Coulomb friction: derived, and compared with what this package computes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from symosc.citation import LITERATURE, reference
from symosc.derive import published, stops
from symosc.derive.latex import named
from symosc.derive.published import MP, Formulas, wall
from symosc.derive.scope import Scope
from symosc.derive.steps import (
    Check,
    Close,
    Exact,
    Heading,
    Prose,
    Relation,
    Sign,
    Step,
    StepError,
    StepEvidence,
    equation,
    rounded,
)
from symosc.exact import show
from symosc.model import Parameters
from symosc.symbolic import coulomb, solution
from symosc.symbolic.coulomb import F, G, H, P, Q, d, p_0, phi, q_0, r, x_0, x_f
from symosc.symbolic.solution import BASIS, E0, E1, E2, FN, Omega, c, cm, h, k, m, omega_d, tau, w0sq

TITLE = "Published results that the model contains"

# Names of what is derived: trace and determinant of the free motion over half a period, and of what it does to a
# perturbation; accelerations before and after a turning point.
T, D, T_h, D_h = (named(name) for name in ("T", "D", "T_h", "D_h"))
RHO, LAMBDA = named(r"\rho"), (named(r"\lambda_1"), named(r"\lambda_2"))
A_MINUS, A_PLUS = named(r"\ddot{x}_-"), named(r"\ddot{x}_+")
B, B_0, LARGEST = named(r"B(\varphi)"), named("B(0)"), named(r"B_*", positive=True)
U, V, S = named("U"), named("V"), named(r"S(\varphi)")
UNDAMPED = {cm: 0, c: 0, G: 0, Omega: r * sp.sqrt(w0sq)}

#: (c, F, Omega) with m = k = P = F_N = 1: under-, critically and overdamped, too.
AMPLITUDES = (("0", "0.4", "1.5"), ("0.2", "0.4", "1.5"), ("0.1", "0.25", "0.6"), ("2", "0.1", "0.8"), ("3", "0.1", "0.7"))
#: (c, Omega) and two values of F/P between which the motion without stops ends.
BORDERS = (("0", "1.5", "0.6", "0.7"), ("0", "0.8", "0.8", "0.83"), ("0", "0.3", "0.08", "0.0866"), ("0.2", "1.5", "0.55", "0.65"))
#: Omega, and two values of F/P between which the number of stops changes.
COUNTS = (
    ("0.1", "0.12", "0.13"),
    ("0.1", "0.36", "0.38"),
    ("0.1", "0.49", "0.51"),
    ("0.1", "0.79", "0.82"),
    ("0.04", "0.25", "0.3"),
    ("0.04", "0.35", "0.4"),
    ("0.04", "0.4", "0.45"),
    ("0.04", "0.45", "0.5"),
)
DIGITS_SHOWN, BORDER_DIGITS = 15, 7
BORDER_TOLERANCE = 1e-7


@dataclass(frozen=True)
class BothWays(Check):
    """A printed decimal is the formula's value to its last digit, and the package's value is the formula's."""

    formula: Callable[[], Any]
    package: Callable[[], Any]
    decimals: int
    tolerance: float

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        Close(self.formula, self.decimals).run(statement)
        off = abs(MP.mpf(self.formula()) - MP.mpf(self.package()))
        if not off <= self.tolerance:
            raise StepError(str(statement), f"formula and package differ by {MP.nstr(off, 3)}")
        return StepEvidence("numeric", MP.nstr(off, 2), 1)


def both(left: Any, formula: Any, package: Any, note: str, reason: str, decimals: int, tolerance: float) -> Step:
    """Return the step that prints a value twice: as the formula's, and in the note as the package's."""
    check = BothWays(lambda: formula, lambda: package, decimals, tolerance)
    shown = f"({note}; run: ${MP.nstr(MP.mpf(package), decimals, strip_zeros=False)}$)"
    return Step(Relation(left, "=", rounded(formula, decimals)), reason, check, shown, decimals=True)


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield Prose(
        r"With $A_0 = 0$, $B_0 = P$, $v_1 = 0$, $\mu_1 F_N = F$, $\mu_2 = 0$ and a belt 2 that is faster than the mass "
        r"ever gets, the model is the oscillator $m \ddot{x} + c \dot{x} + k x = P \cos\Omega t - F \operatorname{sgn} "
        r"\dot{x}$ on which much has been published. Below $x_f = F/k$, $r = \Omega\sqrt{m/k}$, and each number stands "
        r"there twice: computed from a formula or from equations with 50 digits, and, after the word \emph{run}, "
        r"found by this package. Where nothing else is said, $m = k = P = F_N = 1$ and $c = 0$."
    )
    yield from _symmetric_motion()
    yield from _stability()
    yield from _border()
    yield from _growth_and_decay()
    yield from _stops()
    yield from _continuum()
    yield from _rests()
    yield Heading("Sources")
    yield from (Prose(f"{reference(fields, title=r'\emph{{{}}}', space='~')}.") for fields in LITERATURE.values())
