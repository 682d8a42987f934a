"""Published results on the oscillator with Coulomb friction: derived, and compared with what this package computes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import sympy as sp

from symosc.citation import LITERATURE, reference
from symosc.derive.comparisons import Value, number, table
from symosc.derive.latex import named
from symosc.derive.published import MP
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



@dataclass(frozen=True)
class BothWays(Check):
    """A printed decimal is the formula's value to its last digit, and the package's value is near the formula's."""

    value: Value

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        Close(lambda: number(self.value.formula), self.value.decimals).run(statement)
        off = abs(self.value.difference)
        if not off <= self.value.tolerance:
            raise StepError(str(statement), f"formula and package differ by {MP.nstr(off, 3)}")
        return StepEvidence("numeric", MP.nstr(off, 2), 1)


def values(key: str, reason: str) -> Iterator[Step]:
    """Yield the steps that print each value of a table twice: as the formula's, and behind it as the package's."""
    for value in table(key):
        run = MP.nstr(number(value.package), value.decimals, strip_zeros=False)
        words = "; ".join(part for part in (value.case, value.said, f"run: ${run}$") if part)
        statement = Relation(named(value.name), "=", rounded(number(value.formula), value.decimals))
        yield Step(statement, reason, BothWays(value), f"({words})", decimals=True)
        reason = ""


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
    for fields in LITERATURE.values():
        yield Prose(reference(fields, title=r"\emph{{{}}}", space="~") + ".")


# --- the motion without stops ---


def _free(start: Any, rate: Any) -> tuple[Any, Any]:
    """Return x and v of the free motion at tau: the flow of the second chapter without forces."""
    flow = solution.flow()
    at = {solution.x_i: start, solution.v_i: rate, solution.a_i: -w0sq * start - cm * rate, solution.f0: 0}
    known = {E0: 1 - w0sq * E2 - cm * E1}
    return tuple(sp.expand(part.xreplace(at).xreplace(known)) for part in (flow.x, flow.v))


def _symmetric_motion() -> Iterator[Any]:
    yield Heading("The symmetric motion without stops (Den Hartog 1930, 1931)")
    u_0, w_0 = named("u_0"), named(r"\dot{u}_0")
    yield Prose(
        r"Let $x(t + \pi/\Omega) = -x(t)$, let $x_0$ be its highest point and $\varphi$ the angle $\Omega t$ since then. "
        r"For $0 < \varphi < \pi$ the mass moves down and friction is $+F$, so that $x = x_f + p_0 \cos\varphi + "
        r"q_0 \sin\varphi + u$ with a free motion $u$. It starts at $u_0 = x_0 - p_0 - x_f$ with the velocity "
        r"$\dot{u}_0 = -\Omega q_0$. In this chapter $E_1$, $E_2$ and $E_0 = \dot{E}_1$ are those of the second one, "
        r"taken at $\tau = \pi/\Omega$ unless another time is named."
    )
    x, v = _free(u_0, w_0)
    ends = named(r"u(\tau)"), named(r"\dot{u}(\tau)")
    matrix = coulomb.transition() * sp.Matrix([u_0, w_0])
    reason = "Without forces the flow is"
    for name, shown, meaning in zip(ends, matrix, (x, v), strict=True):
        check = Exact({name: meaning, E0: 1 - w0sq * E2 - cm * E1}, sp.expand)
        yield equation(name, shown, reason, check)
        reason = ""
    stiffness, damping = k - m * Omega**2, c * Omega
    push = sp.sqrt((stiffness * p_0 + damping * q_0) ** 2 + (stiffness * q_0 - damping * p_0) ** 2)
    yield equation(
        P**2,
        (stiffness**2 + damping**2) * (p_0**2 + q_0**2),
        r"The steady part obeys the equation of motion without friction: $P\cos\Omega t$ is $(k - m\Omega^2) p_0 + "
        r"c\Omega q_0$ at $\varphi = 0$ and $(k - m\Omega^2) q_0 - c\Omega p_0$ a quarter of a period later. So",
        Exact({P: push}, sp.expand),
    )
    yield Prose(r"Call $Q = \sqrt{p_0^2 + q_0^2}$: the amplitude that the mass would have without friction.")
    yield from _conditions()
    yield from _closed_forms()
    yield from values("amplitude", "With 50 digits, and from the orbit $P_{32}$ that the package finds:")


def _conditions() -> Iterator[Any]:
    solved = coulomb.half_period()
    meaning = {p_0: x_0 + G * x_f, q_0: H * x_f, G: solved.G, H: solved.H}
    reason = r"Half a period later position and velocity are those of the start, negated:"
    for row in coulomb.symmetry():
        yield Step(Relation(sp.Integer(0), "=", row), reason, Exact(meaning))
        reason = ""
    matrix = coulomb.transition()
    traces = {T: matrix.trace(), D: matrix.det()}
    yield equation(
        p_0, x_0 + G * x_f, "These equations are linear in $p_0$ and $q_0$. They are solved by", Exact(_solved())
    )
    yield equation(q_0, H * x_f, "", Exact(_solved()))
    below = 1 + T + D
    relation = {E0: 1 - w0sq * E2 - cm * E1}
    yield equation(G, (1 - D - cm * E1) / below, "with", Exact({G: solved.G, **traces, **relation}))
    yield equation(H, 2 * w0sq * E1 / (Omega * below), "", Exact({H: solved.H, **traces, **relation}))
    yield equation(T, E0 + 1 - w0sq * E2, "where trace and determinant of the free motion are", Exact(traces))
    yield equation(D, E0 - w0sq * (E0 * E2 - E1**2), "", Exact(traces))
    yield equation(
        x_0,
        coulomb.amplitude(),
        "so that $Q$ decides on the amplitude, which exists for $Q > |H| x_f$:",
        Exact({Q: sp.sqrt(named("y", positive=True) ** 2 + H**2 * x_f**2), x_0: -G * x_f + named("y", positive=True)}),
    )


def _solved() -> dict[Any, Any]:
    """Return p_0 and q_0 by Cramer's rule from the two conditions."""
    rows = coulomb.symmetry()
    matrix = rows.jacobian([p_0, q_0])
    right = -rows.subs({p_0: 0, q_0: 0})
    first, second = matrix.copy(), matrix.copy()
    first[:, 0], second[:, 1] = right, right
    solved = coulomb.half_period()
    return {p_0: first.det() / matrix.det(), q_0: second.det() / matrix.det(), G: solved.G, H: solved.H}


def _closed_forms() -> Iterator[Any]:
    regimes, solved = solution.REGIMES, coulomb.half_period()
    printed = coulomb.den_hartog_damped()

    def tidy(expr: Any) -> Any:
        return sp.simplify(sp.expand(sp.numer(sp.together(expr.rewrite(sp.exp)))))

    reason = r"For $0 < c^2 < 4 k m$ this is Den Hartog's form, with $h = c/2m$ and $\omega_d^2 = k/m - h^2$:"
    for letter, shown, derived in zip((G, H), printed, solved, strict=True):
        yield equation(letter, shown, reason, Exact({letter: coulomb.closed(derived, regimes["underdamped"])}, tidy))
        reason = ""
    free = regimes["undamped"]
    undamped = {solution.omega_0: Omega / r}
    G_0, H_0 = (coulomb.closed(part, free).subs(undamped) for part in solved)
    reason = r"For $c = 0$, with $Q = P |V|/k$,"
    yield equation(G, sp.Integer(0), reason, Exact({G: G_0}))
    angle = sp.pi / r
    yield equation(H, sp.sin(angle) / (r * (1 + sp.cos(angle))), "", Exact({H: H_0}), r"$= U = \frac{1}{r}\tan\frac{\pi}{2 r}$")
    yield equation(V, 1 / (1 - r**2), "", Exact({V: k / (k - m * Omega**2), Omega: r * sp.sqrt(k / m)}))
    yield equation(
        x_0**2, V**2 * P**2 / k**2 - U**2 * x_f**2, "", Exact({x_0: coulomb.amplitude().subs(G, 0), Q: P * sp.Abs(V) / k, H: U})
    )
