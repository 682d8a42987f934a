"""Fixed-point equations of the periodic motions P32 (Fig. 9) and P4645 (Fig. 10), with their numbers."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from typing import Any

import sympy as sp

from symosc.derive.chapters.maps import force
from symosc.derive.latex import named
from symosc.derive.scope import BELTS, SIDES, Scope
from symosc.derive.steps import CONTEXT, DIGITS, AtRoot, Close, Heading, Prose, Relation, Step, evaluate, rounded
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene
from symosc.symbolic import maps
from symosc.symbolic.solution import BASIS, Omega, a_i, tau, theta_i, v_i, x_i
from symosc.words import Map, read_word

TITLE = "Periodic motions"
DECIMALS = 20


def items(scope: Scope) -> Iterator[Any]:
    """Yield the chapter."""
    yield from _uniqueness()
    if scope.scene is None:
        yield from _orbit(Scope(load_scene("fig9")), "P32", "Fig.~9")
        yield from _orbit(Scope(load_scene("fig10")), "P4645", "Fig.~10")
    elif scope.scene.structure:
        yield from _orbit(scope, scope.scene.structure, rf"Scene \texttt{{{scope.scene.name}}}")
    else:
        yield Prose(r"This scene has no mapping structure of a periodic motion.")


UNIQUENESS = (
    r"Let $y$ be the difference of two motions with the same parameters, and "
    r"$E = \frac{1}{2} m \dot y^2 + \frac{1}{2} k y^2$. The friction force never grows with the velocity, so "
    r"$\dot E \le -c\, \dot y^2 \le 0$: no difference grows. For $c > 0$ and $k > 0$ all motions are bounded, and "
    r"by Brouwer's theorem the map over one period of the excitation has a fixed point: a periodic motion.",
    r"Where $E$ stays constant, $\dot y = 0$ and $y = d$ for all times. If $d \ne 0$, the two equations of motion "
    r"differ by $k d$, which only set-valued friction can take up: both motions ride the same belt for ever, and "
    r"being bounded they ride one at rest. So for $c > 0$ and $k > 0$ a periodic motion that is not a rest on a belt "
    r"is the only one, and attracts all others.",
    r"The exception: $v_\lambda = 0$ and $|B_0| \le \mu_\lambda F_N$. Then the mass may rest on it for ever, at "
    r"every $x$ of an interval of length $2 (\mu_\lambda F_N - |B_0|)/k$; each of these motions is periodic, and a "
    r"multiplier of each is 1. For $c = 0$ the argument shows only that no multiplier is larger than 1 in size; one "
    r"may be exactly 1, and then the orbit is marginal.",
)


def _uniqueness() -> Iterator[Any]:
    yield Heading("What holds about uniqueness and stability")
    yield from map(Prose, UNIQUENESS)


@cache
def root(parameters: Parameters, word: str) -> tuple[tuple[Any, Any], ...]:
    """Return the switching points (x, theta) of the orbit, 50 digits, found by the numeric package."""
    orbit = find_orbit(parameters, word, digits=DIGITS + 5)
    turn = CONTEXT.mpf(parameters.Omega.numerator) / parameters.Omega.denominator
    return tuple((x, turn * t) for t, x in orbit.points)


@cache
def equations(scope: Scope, word: str) -> tuple[tuple[Map, Any, Any, dict[Any, Any]], ...]:
    """Return for each map its row, f1, f2 with the scene's numbers, and what a_i, tau and the basis functions are."""
    rows = read_word(word).maps
    exits = read_word(word).exits()
    regime = scope.regimes[0]
    found = []
    for i, (row, leaves) in enumerate(zip(rows, exits, strict=True)):
        last = i == len(rows) - 1
        ends = _letters(0 if last else i + 1)
        here = _letters(i)
        end_phase = ends[1] + 2 * sp.pi if last else ends[1]
        duration = named(rf"\tau_{{{i + 1}}}")
        start, end = BELTS[row.start.boundary], BELTS[row.end.boundary]
        letters = {x_i: here[0], theta_i: here[1], maps.x_j: ends[0], maps.theta_j: ends[1], tau: duration}
        meaning: dict[Any, Any] = {duration: (end_phase - here[1]) / Omega}
        after_stick = rows[i - 1].sticks
        if row.sticks:
            domain = SIDES[row.end.boundary][0 if leaves == "below" else 1]
            f1 = maps.stick_residual()["f1"].xreplace({v_i: start})
            f2 = force(domain, maps.x_j, start, maps.theta_j)
        else:
            f1, f2 = (expr.xreplace({v_i: start, maps.v_j: end}) for expr in maps.flight_residual().values())
            names = {f: named(rf"{f.name[0]}_{f.name[1]}(\tau_{{{i + 1}}})") for f in BASIS}
            # The force that ended a stick vanishes where the next flight starts.
            letters |= names | {a_i: sp.S.Zero if after_stick else named(rf"\ddot{{x}}_{{{i + 1}}}")}
            closed = {names[f]: expr.xreplace({tau: duration}) for f, expr in regime.basis().items()}
            meaning |= closed
            if not after_stick:
                meaning[letters[a_i]] = force(row.domain, x_i, start, theta_i).xreplace(letters)
        found.append((row, f1.xreplace(letters), f2.xreplace(letters), meaning))
    return tuple((row, _put(scope, f1), _put(scope, f2), _values(scope, m)) for row, f1, f2, m in found)


def _letters(i: int) -> tuple[Any, Any]:
    return named(f"x_{{{i + 1}}}"), named(rf"\theta_{{{i + 1}}}")


def _put(scope: Scope, expr: Any) -> Any:
    return expr.xreplace(scope.display).xreplace(scope.numbers)


def _values(scope: Scope, meaning: dict[Any, Any]) -> dict[Any, Any]:
    return {name: _put(scope, value) for name, value in meaning.items()}


def point(scope: Scope, word: str, meaning: dict[Any, Any]) -> dict[Any, Any]:
    """Return the numbers of all letters at the root."""
    assert scope.parameters is not None
    values: dict[Any, Any] = {}
    for i, (x, theta) in enumerate(root(scope.parameters, word)):
        for letter, number in zip(_letters(i), (x, theta), strict=True):
            values[letter] = sp.Float(CONTEXT.nstr(number, DIGITS + 8), DIGITS + 10)
    for name, value in meaning.items():
        values[name] = sp.N(value.subs(values), DIGITS + 10)
    return values


def _orbit(scope: Scope, word: str, figure: str) -> Iterator[Any]:
    rows = equations(scope, word)
    inner = r" \circ ".join(f"P_{digit}" for digit in word[1:])
    yield Heading(rf"{figure}: $P_{{{word[1:]}}} = {inner}$")
    numbers = ", ".join(f"${name} = {value}$" for name, value in scope.table())
    yield Prose(
        rf"With {numbers}. The last map ends where the first one starts, one period of the excitation later, so "
        rf"there are "
        rf"{2 * len(rows)} equations for {2 * len(rows)} unknowns."
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


def _solution(scope: Scope, word: str) -> Iterator[Any]:
    assert scope.parameters is not None
    reason = r"The root, to 20 decimals (half a unit of the last one):"
    for i, (x, theta) in enumerate(root(scope.parameters, word)):
        for letter, number in zip(_letters(i), (x, theta), strict=True):
            check = Close(partial(CONTEXT.mpf, number), DECIMALS)
            yield Step(Relation(letter, "=", rounded(number, DECIMALS)), reason, check, decimals=True)
            reason = ""


def _admissible(scope: Scope, word: str) -> Iterator[Any]:
    """Yield the forces at each switching point: which Theorem of 4 and 5 applies."""
    rows = equations(scope, word)
    everything = point(scope, word, {})
    reason = (
        r"At each switching point the forces on both sides say that the next map is the one that the structure demands "
        r"(Theorems 4 and 5):"
    )
    for i, (row, *_) in enumerate(rows):
        before = rows[i - 1][0]
        lo, hi = SIDES[row.start.boundary]
        belt = BELTS[row.start.boundary]
        for alpha in (lo, hi):
            if before.sticks and row.domain == alpha:
                continue  # the stick ends where this force vanishes: an equation above
            value = _put(scope, force(alpha, *_letters(i)[:1], belt, _letters(i)[1]))
            positive = evaluate(value, everything) > 0
            check = AtRoot(lambda: everything)
            yield Step(
                Relation(value, ">" if positive else "<", sp.Integer(0)),
                reason,
                check,
                rf"($F^{{({alpha})}}$ at point {i + 1}, before $P_{row.label[1]}$)",
                decimals=True,
            )
            reason = ""
