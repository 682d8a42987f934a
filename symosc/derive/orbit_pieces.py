"""The pieces of a periodic orbit: the equations of its flights and sticks at the root, and what happens inside them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from typing import Any

import sympy as sp

from symosc.derive.chapters.maps import force
from symosc.derive.latex import named
from symosc.derive.scope import BELTS, Scope
from symosc.derive.steps import CONTEXT, STEP_DIGITS
from symosc.model import NEIGHBOURS, Parameters
from symosc.orbits.find import find_orbit
from symosc.symbolic import maps, solution
from symosc.symbolic.solution import BASIS, Omega, a_i, tau, theta_i, v_i, x_i
from symosc.words import Map, read_word


@cache
def root(parameters: Parameters, word: str) -> tuple[tuple[Any, Any], ...]:
    """Return the switching points (x, theta) of the orbit, 50 digits, found by the numeric package."""
    orbit = find_orbit(parameters, word, digits=STEP_DIGITS + 5)
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
        ends = letters_of(0 if last else i + 1)
        here = letters_of(i)
        end_phase = ends[1] + 2 * sp.pi if last else ends[1]
        duration = named(rf"\tau_{{{i + 1}}}")
        start, end = BELTS[row.start.boundary], BELTS[row.end.boundary]
        letters = {x_i: here[0], theta_i: here[1], maps.x_j: ends[0], maps.theta_j: ends[1], tau: duration}
        meaning: dict[Any, Any] = {duration: (end_phase - here[1]) / Omega}
        after_stick = rows[i - 1].sticks
        if row.sticks:
            domain = NEIGHBOURS[row.end.boundary][0 if leaves == "below" else 1]
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
    return tuple((row, put(scope, f1), put(scope, f2), _values(scope, m)) for row, f1, f2, m in found)


def letters_of(i: int) -> tuple[Any, Any]:
    """Return the letters of position and phase at the switching point i + 1."""
    return named(f"x_{{{i + 1}}}"), named(rf"\theta_{{{i + 1}}}")


def put(scope: Scope, expr: Any) -> Any:
    """Put the scene's numbers in."""
    return expr.xreplace(scope.display).xreplace(scope.numbers)


def _values(scope: Scope, meaning: dict[Any, Any]) -> dict[Any, Any]:
    return {name: put(scope, value) for name, value in meaning.items()}


def point(scope: Scope, word: str, meaning: dict[Any, Any]) -> dict[Any, Any]:
    """Return the numbers of all letters at the root."""
    assert scope.parameters is not None
    values: dict[Any, Any] = {}
    for i, (x, theta) in enumerate(root(scope.parameters, word)):
        for letter, number in zip(letters_of(i), (x, theta), strict=True):
            values[letter] = sp.Float(CONTEXT.nstr(number, STEP_DIGITS + 8), STEP_DIGITS + 10)
    for name, value in meaning.items():
        values[name] = sp.N(value.subs(values), STEP_DIGITS + 10)
    return values


def extremes(scope: Scope, word: str, i: int) -> Iterator[tuple[str, Any, tuple[str, list[tuple[str, Any]]]]]:
    """Yield name, value and bounds of what must not reach a bound during the piece from point i + 1."""
    row = equations(scope, word)[i][0]
    points = root(scope.parameters, word)
    (x, phase), (_, end) = points[i], points[(i + 1) % len(points)]
    turn = CONTEXT.mpf(scope.numbers[Omega].p) / scope.numbers[Omega].q
    duration = ((end - phase) % (2 * CONTEXT.pi)) / turn
    if row.sticks:
        yield from _stick_extremes(scope, row, x, phase, duration)
        return
    velocity, acceleration = _flight(scope, row, x, phase)
    low, high = ({1: None, 2: 1, 3: 2}[row.domain], {1: 1, 2: 2, 3: None}[row.domain])
    for at in _zeros(acceleration, duration):
        value = velocity(at)
        limits = [(op, scope.numbers[BELTS[belt]]) for op, belt in ((">", low), ("<", high)) if belt]
        words = {1: "$< v_1$", 2: "between $v_1$ and $v_2$", 3: "$> v_2$"}[row.domain]
        yield r"extreme of $\dot{x}$", value, (words, limits)


def _flight(scope: Scope, row: Map, x: Any, phase: Any) -> tuple[Any, Any]:
    """Return velocity and acceleration of a flight as functions of tau, in many digits."""
    belt = BELTS[row.start.boundary]
    start = force(row.domain, x_i, belt, theta_i)
    flow = solution.flow(scope.regimes[0])
    functions = []
    for expr in (flow.v, flow.a):
        shown = put(scope, expr.xreplace({a_i: start, v_i: belt}).xreplace(scope.display)).xreplace(scope.numbers)
        code = sp.lambdify((tau, x_i, theta_i), shown, CONTEXT_MODULE)
        functions.append(partial(_call, code, x, phase))
    return functions[0], functions[1]


CONTEXT_MODULE = [
    {name: getattr(CONTEXT, name) for name in ("sin", "cos", "sinh", "cosh", "exp", "sqrt", "mpf")},
    "mpmath",
]


def _call(code: Any, x: Any, phase: Any, at: Any) -> Any:
    return code(at, x, phase)


def _zeros(function: Any, duration: Any, pieces: int = 120) -> list[Any]:
    """Return the zeros of a function inside (0, duration) where it changes its sign, by halving."""
    grid = [duration * (n + CONTEXT.mpf("0.5")) / pieces for n in range(pieces)]
    signs = [function(at) > 0 for at in grid]
    found = []
    for n in range(pieces - 1):
        if signs[n] != signs[n + 1]:
            low, high = grid[n], grid[n + 1]
            for _ in range(110):
                middle = (low + high) / 2
                low, high = (middle, high) if (function(middle) > 0) == signs[n] else (low, middle)
            found.append(low)
    return found


def _difference(function: Any, step: Any, at: Any) -> Any:
    return function(at + step) - function(at)


def _stick_extremes(scope: Scope, row: Map, x: Any, phase: Any, duration: Any) -> Iterator[Any]:
    belt = row.start.boundary
    turn = CONTEXT.mpf(scope.numbers[Omega].p) / scope.numbers[Omega].q
    speed = CONTEXT.mpf(scope.numbers[BELTS[belt]].p) / scope.numbers[BELTS[belt]].q
    for alpha, op, best in ((belt, ">", min), (belt + 1, "<", max)):
        expr = put(scope, force(alpha, x_i, BELTS[belt], theta_i)).xreplace(scope.numbers)
        code = sp.lambdify((x_i, theta_i), expr, CONTEXT_MODULE)

        def value(at: Any, code: Any = code) -> Any:
            return code(x + speed * at, phase + turn * at)

        step = duration / 10**6
        slope = partial(_difference, value, step)
        # The end, where one of them vanishes, is left out.
        places = [CONTEXT.mpf(0), *_zeros(slope, duration), duration * CONTEXT.mpf("0.9")]
        yield (
            rf"{'least' if op == '>' else 'largest'} $F^{{({alpha})}}$ on $[0, 0.9\tau]$",
            best(value(at) for at in places),
            (f"${op} 0$", [(op, sp.Integer(0))]),
        )
