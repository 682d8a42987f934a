"""Uniqueness and stability of periodic motions; fixed-point equations of P32 (Fig. 9) and P4645 (Fig. 10)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import sympy as sp

from symosc.derive.blocks import Table, block, proof
from symosc.derive.chapters.maps import force
from symosc.derive.latex import named
from symosc.derive.orbit_pieces import equations, extremes, letters_of, point, put, root
from symosc.derive.scope import BELTS, Scope
from symosc.derive.steps import (
    CONTEXT,
    STEP_DIGITS,
    AtRoot,
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
    evaluate,
    fact,
    rounded,
)
from symosc.model import NEIGHBOURS, Parameters
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic.solution import FN, k
from symosc.words import Map, read_word

TITLE = "Periodic motions"
DECIMALS = 20


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _uniqueness()
    yield from _what_uniqueness_needs()
    if scope.scene is None:
        yield from _orbit(Scope(load_scene("fig9")), "P32", "The paper's Fig.~9")
        yield from _orbit(Scope(load_scene("fig10")), "P4645", "The paper's Fig.~10")
    elif scope.scene.structure:
        yield from _orbit(scope, scope.scene.structure, rf"Scene \texttt{{{scope.scene.name}}}")
    else:
        yield Prose(r"This scene has no mapping structure of a periodic motion.")


def _uniqueness() -> Iterator[Any]:
    yield Heading("Existence, uniqueness, stability")
    mu = sp.Symbol(r"\mu_\lambda", nonnegative=True)
    held, size = named(r"H_\lambda"), sp.Symbol("B_0", real=True)
    ends = [(held + sign * (mu * FN - sp.Abs(size))) / k for sign in (1, -1)]
    length = named(r"\ell")
    yield from block(
        "theorem",
        r"Let $c > 0$ and $k > 0$."
        r"\begin{enumerate}"
        r"\item[(i)] There is a periodic motion with the period $2\pi/\Omega$."
        r"\item[(ii)] Unless $v_\lambda = 0$ and $|B_0| < \mu_\lambda F_N$ for one of the belts, it is the only "
        r"periodic motion, and every other motion tends to it."
        r"\item[(iii)] If $v_\lambda = 0$ and $|B_0| < \mu_\lambda F_N$, the periodic motions are the rests on belt "
        r"$\lambda$ at the positions of an interval, and every motion tends to one of them. Inside the interval each "
        r"has the multiplier 1."
        r"\end{enumerate}",
        equation(
            length,
            2 * (mu * FN - sp.Abs(size)) / k,
            r"The interval of (iii) has the length",
            Exact({length: ends[0] - ends[1]}, sp.expand),
            label="orbits-length",
        ),
        title="one attractor, or an interval of rests",
        label="thm:orbits-unique",
    )
    yield from proof(
        r"Let $y$ be the difference of two motions and $W = \frac{m}{2}\dot{y}^2 + \frac{k}{2}y^2$. By "
        r"\eqref{eq:motion-energy} and Lemma~\ref{thm:motion-monotone}, $\dot{W} \le -c\,\dot{y}^2 \le 0$.",
        r"(i) A motion answers the bounded force $A_0 + B_0\cos\Omega t + T_1 + T_2$ in an oscillator whose unforced "
        r"motions decay exponentially. So the map over one period takes a large ball, in a norm in which this linear "
        r"oscillator contracts, into itself; it is continuous because $W$ does not grow, and has a fixed point by "
        r"Brouwer's theorem.",
        r"(ii) Let $x^*$ be the motion of (i) and $x$ any other one; $W$ falls to some $W_\infty \ge 0$. The motions "
        r"$x(t + 2\pi n/\Omega)$, $n = 1, 2, \ldots$, are bounded with their first two derivatives, so some of them "
        r"converge, with the velocities, to a function $\tilde{x}$, which is a motion too because the right side of "
        r"\eqref{eq:motion-newton} is closed and convex. Its difference to $x^*$ has the constant energy $W_\infty$. "
        r"Then $\dot{y} = 0$ and $y = d$ for all times, and the two equations of motion leave $\tilde{T} - T^* = k d$ "
        r"for the frictions of the two motions, which have the same velocity. If $d \ne 0$, this needs set-valued "
        r"friction at almost all times: $\dot{x}^*$ is always $v_1$ or $v_2$, by continuity always the same "
        r"$v_\lambda$, and since $x^*$ is bounded $v_\lambda = 0$. Both motions then rest on belt $\lambda$ for ever. "
        r"By Proposition~\ref{thm:motion-held} a rest at $x$ lasts iff "
        r"$|H_\lambda - k x + B_0\cos\theta| \le \mu_\lambda F_N$ at all phases, with the constant "
        r"$H_\lambda = A_0 \pm \mu_{3-\lambda}F_N$ ($+$ for $\lambda = 1$), that is iff "
        r"$|H_\lambda - k x| \le \mu_\lambda F_N - |B_0|$. For $|B_0| = \mu_\lambda F_N$ this is one point, so "
        r"$d \ne 0$ needs $|B_0| < \mu_\lambda F_N$. Without it $d = 0$ and $W_\infty = 0$: every motion tends to "
        r"$x^*$, and no other one is periodic.",
        r"(iii) The rests are motions by (ii), at the positions between $(H_\lambda \pm (\mu_\lambda F_N - |B_0|))/k$. "
        r"If a motion is periodic, its difference to a rest has constant energy, so it is a rest by the argument "
        r"of (ii), on the same belt because its velocity is 0. Every motion $x$ has a limit $\tilde{x}$ as "
        r"in (ii) that is "
        r"a rest, and its energy relative to that rest falls to 0. Moving a rest inside the interval changes nothing "
        r"else: the multiplier is 1.",
    )


def _what_uniqueness_needs() -> Iterator[Any]:
    yield from block(
        "example",
        Prose(
            r"Let $m = c = k = 1$, $A_0 = 0$, $B_0 = \frac{1}{10}$, $\Omega = 1$, $v_1 = 0$, $v_2 = 10$, $\mu_1 = 1$, "
            r"$\mu_2 = \frac{1}{10}$, $F_N = 1$. Then $H_1 = \frac{1}{10}$, and the mass may rest at every $x$ from "
            r"$-\frac{4}{5}$ to $1$, for example at $0$, $\frac{1}{2}$ and $-\frac{3}{5}$.",
            tuple(_rests(sp.Rational(place)) for place in ("0", "1/2", "-3/5", "-4/5", "1")),
        ),
        label="thm:orbits-example",
    )
    yield from block(
        "remark",
        r"For $c = 0$ no difference grows either, but nothing has to attract: a multiplier may be exactly 1, and the "
        r"motion is then marginal, neither attracting nor repelling. Such continua of marginal motions are "
        r"known in the oscillator with one belt at rest \cite{csernak2007}; for its symmetric motions see also "
        r"\cite{denhartog1931,hongliu2000,luogegg2006,shaw1986}.",
        title="no damping",
        label="thm:orbits-undamped",
    )


def _rests(place: Any) -> Step:
    """Return the check that |H - k x| + |B0| <= mu F_N in the example: the worst phase, in exact numbers."""
    tenth = sp.Rational(1, 10)
    return fact(sp.Abs(tenth - place) + tenth, "<=", 1, Sign())


def _orbit(scope: Scope, word: str, figure: str) -> Iterator[Any]:
    rows = equations(scope, word)
    inner = r" \circ ".join(f"P_{digit}" for digit in word[1:])
    yield Heading(rf"{figure}: $P_{{{word[1:]}}} = {inner}$")
    numbers = ", ".join(f"${name} = {value}$" for name, value in scope.table())
    yield Prose(
        rf"The numbers are {numbers}. The last map ends where the first one starts, one period of the drive later, so "
        rf"there are {2 * len(rows)} equations for the {2 * len(rows)} unknowns $x_j$, $\theta_j$. A basis function of "
        rf"the flight from point $j$ is taken at its duration $\tau_j$."
    )
    for i, (row, f1, f2, meaning) in enumerate(rows, 1):
        after = i % len(rows) + 1
        turned = r" + 2\pi" if after == 1 else ""
        reason = (
            rf"$P_{row.label[1]}$ from point {i} to point {after}, with $\tau_{i} = (\theta_{after}{turned} - "
            rf"\theta_{i})/\Omega$"
            rf"{_start_force(row, i, rows[i - 2][0].sticks)}"
        )
        for expr in (f1, f2):
            yield Step(Relation(sp.Integer(0), "=", expr), reason, _at(scope, word, meaning), decimals=True)
            reason = ""
    yield from _solution(scope, word)
    yield from _admissible(scope, word)
    yield from _between(scope, word)


def _start_force(row: Map, i: int, after_stick: bool) -> str:
    if row.sticks:
        return ":"
    value = f"F^{{({row.domain})}}"
    return (
        rf" and ${value} = 0$ at point {i}, where a stick ended:"
        if after_stick
        else (rf" and $\ddot{{x}}_{i} = {value}$ at point {i}:")
    )


def _at(scope: Scope, word: str, meaning: dict[Any, Any]) -> AtRoot:
    return AtRoot(lambda: point(scope, word, meaning), CONTEXT.mpf(10) ** -43)


def _decimal(name: str, number: Any, decimals: int) -> Step:
    check = Close(partial(CONTEXT.mpf, number), decimals)
    return Step(Relation(named(name), "=", rounded(number, decimals)), "", check, decimals=True)


def _solution(scope: Scope, word: str) -> Iterator[Any]:
    assert scope.parameters is not None
    rows = []
    for i, ((x, theta), (row, *_)) in enumerate(zip(root(scope.parameters, word), equations(scope, word), strict=True)):
        place, phase = (_decimal("x", x, DECIMALS), _decimal("theta", theta, DECIMALS))
        rows.append((str(i + 1), phase, place, str(row.start.boundary), f"$P_{row.label[1]}$"))
    yield Table(
        f"tab:orbits-{word}",
        rf"The switching points of $P_{{{word[1:]}}}$, to 20 decimals (half a unit of the last one).",
        ("$j$", r"$\theta_j$", "$x_j$", "belt", "next"),
        tuple(rows),
    )


def _admissible(scope: Scope, word: str) -> Iterator[Any]:
    """Yield the accelerations at each switching point: which case of the theorem on boundaries applies."""
    everything = point(scope, word, {})
    rows, facts = [], []
    for i, (row, *_) in enumerate(equations(scope, word)):
        belt = row.start.boundary
        before = equations(scope, word)[i - 1][0]
        cells: list[Any] = [str(i + 1)]
        for alpha in NEIGHBOURS[belt]:
            value = put(scope, force(alpha, letters_of(i)[0], BELTS[belt], letters_of(i)[1]))
            if before.sticks and row.domain == alpha:
                cells.append("0")  # the stick ends where this one vanishes: an equation above
                continue
            number = evaluate(value, everything)
            cells.append(_decimal(f"F^{{({alpha})}}", number, 10))
            facts.append(_sign_at_point(row, before, alpha, value, everything))
        rows.append((*cells, f"$P_{row.label[1]}$"))
    yield Table(
        f"tab:orbits-forces-{word}",
        rf"The accelerations on both sides at the switching points of $P_{{{word[1:]}}}$. By their signs the next "
        r"mapping is the one that the word demands (Theorem~\ref{thm:switching-cases}).",
        ("$j$", "below", "above", "next"),
        tuple(rows),
        tuple(facts),
    )


def _sign_at_point(row: Map, before: Map, alpha: int, value: Any, values: dict[Any, Any]) -> Step:
    """Return what the sign of an acceleration has to be for the next mapping."""
    belt = row.start.boundary
    if row.sticks:
        op = ">" if alpha == belt else "<"
    elif before.sticks:  # the other side still holds the mass
        op = "<" if alpha == belt + 1 else ">"
    else:
        op = "<" if row.domain == belt else ">"
    return fact(value, op, 0, AtRoot(lambda: values))


def _between(scope: Scope, word: str) -> Iterator[Any]:
    """Yield what holds between the switching points: no flight meets a belt, each stick is held."""
    assert scope.parameters is not None
    rows, facts = [], []
    for i, (row, *_) in enumerate(equations(scope, word)):
        for name, number, bounds in extremes(scope, word, i):
            rows.append((f"$P_{row.label[1]}$ from {i + 1}", name, _decimal("z", number, 8), bounds[0]))
            shown = sp.Float(CONTEXT.nstr(number, STEP_DIGITS), STEP_DIGITS)
            for op, bound in bounds[1]:
                facts.append(fact(shown, op, bound, AtRoot(dict)))
    facts.append(fact(_word_number(word), "=", _word_number(word), Followed(scope.parameters, word)))
    yield Prose(
        rf"Between the switching points nothing happens: Table~\ref{{tab:orbits-between-{word}}} has all "
        rf"extreme values "
        r"of the velocity inside the flights, and the least favourable accelerations during the sticks. The motion "
        r"that starts at point 1 was also followed with 30 digits for one period, by the search of "
        rf"Chapter~\ref{{sec:events}}: its events are those of $P_{{{word[1:]}}}$ and no others."
    )
    yield Table(
        f"tab:orbits-between-{word}",
        rf"Between the switching points of $P_{{{word[1:]}}}$.",
        ("piece", "what", "value", "has to be"),
        tuple(rows),
        tuple(facts),
    )


def _word_number(word: str) -> Any:
    return sp.Integer(int(word[1:]))


@dataclass(frozen=True)
class Followed(Check):
    """The motion from the orbit's first point has, for one period, exactly the mappings of the word."""

    parameters: Parameters
    word: str

    def run(self, statement: Relation) -> StepEvidence:
        """See `Check`."""
        orbit = find_orbit(self.parameters, self.word, digits=STEP_DIGITS)
        (t, x), belt = orbit.points[0], read_word(self.word).maps[0].start.boundary
        speed = getattr(self.parameters, f"v{belt}")
        error = (CONTEXT.mpf(10) ** -40, CONTEXT.mpf(10) ** -40, 0)
        end = CONTEXT.mpf(t) + CONTEXT.mpf("1.001") * CONTEXT.mpf(orbit.period)
        start = {"t0": CONTEXT.nstr(t, 42), "x0": CONTEXT.nstr(x, 42), "v0": speed, "t_end": CONTEXT.nstr(end, 20)}
        motion = simulate(self.parameters, **start, digits=30, start_error=tuple(CONTEXT.nstr(e, 3) for e in error))
        found = "P" + "".join(label[1] for label in reversed(motion.word[: len(self.word) - 1]))
        if statement.left != statement.right or found != f"P{statement.left}":
            raise StepError(str(statement), f"the motion is {found}")
        return StepEvidence("numeric", f"{len(motion.events)} events", 1)
