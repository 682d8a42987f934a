"""Uniqueness and stability of periodic motions.

Fixed-point equations of P32 (Fig. 9) and P4645 (Fig. 10).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from itertools import pairwise
from typing import Any, NamedTuple

import sympy as sp

from symosc.base.display.latex import latex_text
from symosc.derive import steps
from symosc.derive.chapters.maps import force
from symosc.derive.scope import BELTS, Scope, stated
from symosc.derive.steps import (
    CONTEXT,
    STEP_DIGITS,
    Items,
    Table,
    at_root,
    decimal,
    equation,
    exact,
    facts,
    sign,
    step,
)
from symosc.friction import NEIGHBOURS, Map
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.orbits.find import find_orbit
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate
from symosc.symbolic import maps, solution
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import (
    BASIS,
    E0,
    E1,
    E2,
    FN,
    Omega,
    a_i,
    h,
    k,
    m,
    omega_d,
    tau,
    theta_i,
    v_i,
    x_i,
)
from symosc.symbolic.theorem7 import rational
from symosc.words import read_word

TITLE = "Periodic motions"
#: A mass that may rest on belt 1, with damping.
RESTING = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)


def items(scope: Scope) -> Items:
    """Yield the chapter: one attractor or an interval of rests, and the orbits of Figs. 9 and 10 in
    numbers.
    """
    mu = sp.Symbol(r"\mu_\lambda", nonnegative=True)
    held = named(r"H_\lambda")
    size = sp.Symbol("B_0", real=True)
    upper_end, lower_end = ((held + sign * (mu * FN - sp.Abs(size))) / k for sign in (1, -1))
    yield (
        r"\subsection{Existence, uniqueness, stability}",
        r"\begin{theorem}[one attractor, or an interval of rests]\label{thm:orbits-unique} Let $c "
        r"> 0$ and $k > 0$.\begin{enumerate}\item[(i)] There is a periodic motion with the period "
        r"$2\pi/\Omega$.\item[(ii)] Unless $v_\lambda = 0$ and $|B_0| < \mu_\lambda F_N$ for one "
        r"of the belts, it is the only periodic motion, and every other motion tends to "
        r"it.\item[(iii)] If $v_\lambda = 0$ and $|B_0| < \mu_\lambda F_N$, the periodic motions "
        r"are the rests on belt $\lambda$ at the positions of an interval, and every motion tends "
        r"to one of them. Inside the interval each has the multiplier 1.\end{enumerate}",
        r"The interval of (iii) has the length",
        equation(named(r"\ell"), 2 * (mu * FN - sp.Abs(size)) / k, upper_end - lower_end, "length"),
        r"\end{theorem}",
        r"\begin{proof} Let $y$ be the difference of two motions and $W = \frac{m}{2}\dot{y}^2 + "
        r"\frac{k}{2}y^2$. By \eqref{eq:motion-energy} and Lemma~\ref{thm:motion-monotone}, "
        r"$\dot{W} \le -c\,\dot{y}^2 \le 0$.",
        r"(i) A motion answers the bounded force $A_0 + B_0\cos\Omega t + T_1 + T_2$ in an "
        r"oscillator whose unforced motions decay exponentially. So the map over one period takes "
        r"a large ball, in a norm in which this linear oscillator contracts, into itself; it is "
        r"continuous because $W$ does not grow, and has a fixed point by Brouwer's theorem.",
        r"(ii) Let $x^*$ be the motion of (i) and $x$ any other one; $W$ falls to some $W_\infty "
        r"\ge 0$. The motions $x(t + 2\pi n/\Omega)$, $n = 1, 2, \ldots$, are bounded with their "
        r"first two derivatives, so some of them converge, with the velocities, to a function "
        r"$\tilde{x}$, which is a motion too because the right side of \eqref{eq:motion-newton} is "
        r"closed and convex. Its difference to $x^*$ has the constant energy $W_\infty$. Then "
        r"$\dot{y} = 0$ and $y = d$ for all times, and the two equations of motion leave "
        r"$\tilde{T} - T^* = k d$ for the frictions of the two motions, which have the same "
        r"velocity. If $d \ne 0$, this needs set-valued friction at almost all times: $\dot{x}^*$ "
        r"is always $v_1$ or $v_2$, by continuity always the same $v_\lambda$, and since $x^*$ is "
        r"bounded $v_\lambda = 0$. Both motions then rest on belt $\lambda$ for ever. By "
        r"Proposition~\ref{thm:motion-held} a rest at $x$ lasts iff $|H_\lambda - k x + "
        r"B_0\cos\theta| \le \mu_\lambda F_N$ at all phases, with the constant $H_\lambda = A_0 "
        r"\pm \mu_{3-\lambda}F_N$ ($+$ for $\lambda = 1$), that is iff $|H_\lambda - k x| \le "
        r"\mu_\lambda F_N - |B_0|$. For $|B_0| = \mu_\lambda F_N$ this is one point, so $d \ne 0$ "
        r"needs $|B_0| < \mu_\lambda F_N$. Without it $d = 0$ and $W_\infty = 0$: every motion "
        r"tends to $x^*$, and no other one is periodic.",
        r"(iii) The rests are motions by (ii), at the positions between $(H_\lambda \pm "
        r"(\mu_\lambda F_N - |B_0|))/k$. If a motion is periodic, its difference to a rest has "
        r"constant energy, so it is a rest by the argument of (ii), on the same belt because its "
        r"velocity is 0. Every motion $x$ has a limit $\tilde{x}$ as in (ii) that is a rest, and "
        r"its energy relative to that rest falls to 0. Moving a rest inside the interval changes "
        r"nothing else: the multiplier is 1.\end{proof}",
    )
    if scope.scene is None:
        yield how_far()
    text, numbers = stated(RESTING, *PARAMETER_NAMES)
    middle = rational(RESTING.A0 + RESTING.mu2 * RESTING.FN)
    reach = rational(RESTING.mu1 * RESTING.FN - abs(RESTING.B0))
    stiff = rational(RESTING.k)
    low = named("x_-")
    high = named("x_+")
    places = (
        equation(named("H_1"), sp.Rational("1/10"), middle),
        equation(low, sp.Rational("-4/5"), {low: (middle - reach) / stiff}),
        equation(high, 1, {high: (middle + reach) / stiff}),
    )
    # |H - k x| + |B0| <= mu F_N: the worst phase, in exact numbers.
    needed = named("|H_1 - k x|")
    inside = [sp.Rational(x) for x in ("0", "1/2", "-3/5")]
    held = (step(needed, "<=", reach, sign({needed: sp.Abs(middle - stiff * x)})) for x in inside)
    at = (equation(named("x"), x, x) for x in inside)
    examples = [f"${latex(x)}$" for x in inside]
    yield (
        rf"\begin{{example}}\label{{thm:orbits-example}} Let {text}.",
        facts(*numbers),
        rf"Then $H_1 = {latex(places[0].right)}$, and the mass may rest at every $x$ from "
        rf"${latex(places[1].right)}$ to ${latex(places[2].right)}$, for example at {examples[0]}, "
        rf"{examples[1]} and {examples[2]}.",
        facts(*places, *held, *at),
        r"\end{example}",
        r"\begin{remark}[no damping]\label{thm:orbits-undamped} For $c = 0$ no difference grows "
        r"either, but nothing has to attract: a multiplier may be exactly 1, and the motion is "
        r"then marginal, neither attracting nor repelling (Chapter~\ref{sec:undamped}). Such "
        r"continua of marginal motions are known in the oscillator with one belt at rest "
        r"\cite{csernak2007}; for its symmetric motions see also "
        r"\cite{denhartog1931,hongliu2000,luogegg2006,shaw1986}.\end{remark}",
    )
    if scope.scene is None:
        yield _orbit_section(Scope(load_scene("fig9")), "P32", "The paper's Fig.~9")
        yield _orbit_section(Scope(load_scene("fig10")), "P4645", "The paper's Fig.~10")
    elif scope.scene.structure:
        yield _orbit_section(
            scope, scope.scene.structure, rf"Scene \texttt{{{latex_text(scope.scene.name)}}}"
        )
    else:
        yield r"This scene has no mapping structure of a periodic motion."


def how_far() -> Items:
    """Return the proposition on how far a motion goes from the origin in the long run."""
    norm = named("N_E")
    first = named(r"\int_0^{\pi/\omega_d} |E_1|\,d\tau")
    decay = sp.exp(-sp.pi * h / omega_d)
    basis = solution.REGIMES["underdamped"].basis()
    half = basis[E2].subs(tau, sp.pi / omega_d)
    stiffness = {k: m * (h**2 + omega_d**2)}
    (e2_by_others,) = sp.solve(solution.relations()[0], E2)
    limit = {norm: e2_by_others.subs({E0: 0, E1: 0}).xreplace(solution.PAPER_LETTERS)}
    summed = exact(
        {norm: half / (1 - decay), **stiffness}, lambda expr: sp.simplify(expr.rewrite(sp.exp))
    )
    return (
        r"\begin{proposition}[how far a motion goes]\label{thm:orbits-bound} Let $c > 0$, $k > 0$, "
        r"$F_* = |A_0| + |B_0| + (\mu_1 + \mu_2) F_N$ and $N_E = \int_0^\infty |E_1|\,d\tau$. "
        r"Every motion has $\limsup_{t\to\infty} |x(t)| \le F_* N_E/m$, where",
        equation(
            norm,
            m / k * sp.coth(sp.pi * h / (2 * omega_d)),
            summed,
            "bound",
            note="if $c^2 < 4km$,",
        ),
        equation(norm, m / k, limit, "bound-overdamped", note=r"if $c^2 \ge 4km$."),
        r"\end{proposition}",
        r"\begin{proof} The force $f = A_0 + B_0\cos\Omega t + T_1 + T_2$ is at most $F_*$ in "
        r"size, and by variation of constants $x(t)$ is $\frac{1}{m}\int_0^{t - t_0} E_1(\tau) f(t "
        r"- \tau)\,d\tau$ and a free motion, which decays. This gives the bound by $N_E$. If $c^2 "
        r"< 4km$, $|E_1| = e^{-h\tau}|\sin\omega_d\tau|/\omega_d$ comes back after each "
        r"$\pi/\omega_d$ with the factor $e^{-\pi h/\omega_d}$. So $N_E$ is a geometric series "
        r"that begins with",
        equation(first, (1 + decay) / (h**2 + omega_d**2), {first: half}, "half-wave"),
        r"and $h^2 + \omega_d^2 = k/m$. If $c^2 \ge 4km$, $E_1 > 0$ for $\tau > 0$, and $N_E$ is "
        r"the limit of $E_2$ in \eqref{eq:domains-E2}, where $E_0$ and $E_1$ tend to 0.\end{proof}",
    )


# --- one orbit: its equations at the root, and what happens between the switching points ---


class MappingPiece(NamedTuple):
    """One mapping of an orbit: its entry `row` and the previous one's, `before`, in `MAPS`, and its
    equations f1, f2.

    `letters` are the symbols of x and theta at its start; `meaning` defines the other symbols in f1
    and f2.
    """

    row: Map
    before: Map
    letters: tuple[Any, Any]
    f1: Any
    f2: Any
    meaning: dict[Any, Any]


@cache
def orbit_points(parameters: Parameters, word: str) -> tuple[tuple[Any, Any], ...]:
    """Return the switching points (x, theta) of an orbit, by `find_orbit` with 55 digits.

    The first point is where the first mapping of `word` starts, with theta in [0, 2 pi).
    """
    orbit = find_orbit(parameters, word, digits=STEP_DIGITS + 5)
    points = [(x, steps.number(parameters.Omega) * t) for t, x in orbit.points]
    turn = 2 * CONTEXT.pi
    # `find_orbit` may list the cycle from another mapping on: the points before the start of the
    # word follow one round later.
    labels = read_word(word).labels
    first = next(i for i in range(len(labels)) if orbit.labels[i:] + orbit.labels[:i] == labels)
    later = [(x, theta + turn * orbit.periods) for x, theta in points[:first]]
    _, theta_first = points[first]
    whole_turns = turn * CONTEXT.floor(theta_first / turn)
    return tuple((x, theta - whole_turns) for x, theta in points[first:] + later)


def pieces(scope: Scope, word: str) -> list[MappingPiece]:
    """Return the mappings of a word's orbit, with the scene's numbers put in."""
    rows = read_word(word).maps
    basis = scope.regimes[0].basis()
    mapping_pieces = []
    for i, (row, exit_side) in enumerate(zip(rows, read_word(word).exits(), strict=True)):
        before = rows[i - 1]
        after = (i + 1) % len(rows)  # 0 after the last one: the orbit is closed
        (x_start, theta_start), (x_end, theta_end) = (
            (named(f"x_{{{n + 1}}}"), named(rf"\theta_{{{n + 1}}}")) for n in (i, after)
        )
        duration = named(rf"\tau_{{{i + 1}}}")
        start = BELTS[row.start.boundary]
        end = BELTS[row.end.boundary]
        letters = {
            x_i: x_start,
            theta_i: theta_start,
            maps.x_j: x_end,
            maps.theta_j: theta_end,
            tau: duration,
        }
        # The last mapping ends at the first point, one period of the drive later.
        if after == 0:
            phase_at_end = theta_end + 2 * sp.pi
        else:
            phase_at_end = theta_end
        meaning: dict[Any, Any] = {duration: (phase_at_end - theta_start) / Omega}
        if row.sticks:
            below, above = NEIGHBOURS[row.end.boundary]
            if exit_side == "below":
                domain_after = below
            else:
                domain_after = above
            f1 = maps.stick_residual()["f1"].xreplace({v_i: start})
            f2 = force(domain_after, maps.x_j, start, maps.theta_j)
        else:
            f1, f2 = (
                expr.xreplace({v_i: start, maps.v_j: end})
                for expr in maps.flight_residual().values()
            )
            # E0 becomes E_0(tau_1), and so on.
            names = {f: named(rf"{f.name[0]}_{f.name[1]}(\tau_{{{i + 1}}})") for f in BASIS}
            # The force that ended a stick vanishes where the next flight starts.
            letters |= names | {
                a_i: sp.S.Zero if before.sticks else named(rf"\ddot{{x}}_{{{i + 1}}}")
            }
            meaning |= {names[f]: expr.xreplace({tau: duration}) for f, expr in basis.items()}
            if not before.sticks:
                meaning[letters[a_i]] = force(row.domain, x_i, start, theta_i).xreplace(letters)
        f1, f2 = (_substituted(scope, f.xreplace(letters)) for f in (f1, f2))
        meaning = {name: _substituted(scope, value) for name, value in meaning.items()}
        mapping_pieces.append(MappingPiece(row, before, (x_start, theta_start), f1, f2, meaning))
    return mapping_pieces


def _substituted(scope: Scope, expr: Any) -> Any:
    """Substitute the scene's numbers for the symbols of an expression."""
    return expr.xreplace(scope.display).xreplace(scope.numbers)


def _values(
    orbit_pieces: list[MappingPiece], points: tuple[tuple[Any, Any], ...], meaning: dict[Any, Any]
) -> dict[Any, Any]:
    """Return the values of all symbols: x and theta at the switching `points`, and those that
    `meaning` defines.
    """
    letters = [letter for piece in orbit_pieces for letter in piece.letters]
    numbers = [CONTEXT.nstr(value, STEP_DIGITS + 8) for point in points for value in point]
    values = {
        letter: sp.Float(text, STEP_DIGITS + 10)
        for letter, text in zip(letters, numbers, strict=True)
    }
    for name, value in meaning.items():
        values[name] = sp.N(value.subs(values), STEP_DIGITS + 10)
    return values


def _orbit_section(scope: Scope, word: str, figure: str) -> Items:
    """Yield the section on the orbit of a word, with `figure` in its title: equations, switching
    points, and checks.
    """
    assert scope.scene is not None
    p = scope.scene.parameters
    orbit_pieces = pieces(scope, word)
    points = orbit_points(p, word)
    numbers = ", ".join(scope.given())
    inner = r" \circ ".join(f"P_{digit}" for digit in word[1:])
    yield (
        rf"\subsection{{{figure}: $P_{{{word[1:]}}} = {inner}$}}",
        rf"The numbers are {numbers}. The last map ends where the first one starts, one period "
        r"of the drive later, so "
        rf"there are {2 * len(orbit_pieces)} equations for the {2 * len(orbit_pieces)} unknowns $x_j$, "
        r"$\theta_j$. A basis function of the flight from point $j$ is taken at its duration "
        r"$\tau_j$.",
        _closing_equations(orbit_pieces, points),
    )
    yield _points_table(word, orbit_pieces, points)
    yield _forces_table(scope, word, orbit_pieces, points)
    between = _between_table(scope, word, orbit_pieces, points)
    digits = named("P")
    followed = equation(digits, int(word[1:]), at_root(lambda: {digits: _followed(p, word)}))
    yield (
        rf"Between the switching points nothing happens: Table~\ref{{tab:orbits-between-{word}}} "
        r"has all extreme values of the velocity inside the flights, and the least favourable "
        r"accelerations during the sticks. The motion that starts at point 1 was also followed "
        r"with 30 digits for one period, by the search of "
        rf"Chapter~\ref{{sec:events}}: its events are those of $P_{{{word[1:]}}}$ and no others.",
        between._replace(facts=(*between.facts, followed)),
    )


def _closing_equations(
    orbit_pieces: list[MappingPiece], points: tuple[tuple[Any, Any], ...]
) -> list[Any]:
    """Return f1 = 0 and f2 = 0 of each mapping, checked at the switching points, with a line of
    text before them.
    """
    equations: list[Any] = []
    for i, (row, before, _, f1, f2, meaning) in enumerate(orbit_pieces, 1):
        after = i % len(orbit_pieces) + 1
        if row.sticks:
            start = ""
        elif before.sticks:
            start = rf" and $F^{{({row.domain})}} = 0$ at point {i}, where a stick ended"
        else:
            start = rf" and $\ddot{{x}}_{i} = F^{{({row.domain})}}$ at point {i}"
        if after == 1:
            turn = r" + 2\pi"
        else:
            turn = ""
        equations.append(
            rf"$P_{row.label[1]}$ from point {i} to point {after}, with $\tau_{i} = "
            rf"(\theta_{after}{turn} - \theta_{i})/\Omega${start}:"
        )
        check = at_root(partial(_values, orbit_pieces, points, meaning), CONTEXT.mpf(10) ** -43)
        equations += [equation(0, f, check, decimals=True) for f in (f1, f2)]
    return equations


def _points_table(
    word: str, orbit_pieces: list[MappingPiece], points: tuple[tuple[Any, Any], ...]
) -> Table:
    """Return the table of an orbit's switching points."""
    rows: list[Any] = [
        (
            str(j),
            decimal("theta", theta, 20),
            decimal("x", x, 20),
            str(row.start.boundary),
            f"$P_{row.label[1]}$",
        )
        for j, ((x, theta), (row, *_)) in enumerate(zip(points, orbit_pieces, strict=True), 1)
    ]
    return Table(
        f"tab:orbits-{word}",
        rf"The switching points of $P_{{{word[1:]}}}$, to 20 decimals (half a unit of the last "
        r"one).",
        ("$j$", r"$\theta_j$", "$x_j$", "belt", "next"),
        tuple(rows),
    )


def _forces_table(
    scope: Scope, word: str, orbit_pieces: list[MappingPiece], points: tuple[tuple[Any, Any], ...]
) -> Table:
    """Return the table of the accelerations on both sides at the switching points, with checks of
    their signs.

    They say which case of the theorem on boundaries applies.
    """
    values = _values(orbit_pieces, points, {})
    rows: list[Any] = []
    signs = list[Any]()
    for j, (row, before, (x, theta), *_) in enumerate(orbit_pieces, 1):
        belt = row.start.boundary
        signed: list[Any] = [str(j)]
        for alpha in NEIGHBOURS[belt]:
            value = _substituted(scope, force(alpha, x, BELTS[belt], theta))
            if before.sticks and row.domain == alpha:
                signed.append("0")  # the stick ends where this one vanishes: an equation above
                continue
            signed.append(decimal(f"F^{{({alpha})}}", steps.evaluate(value, values), 10))
            # On a belt, and on the other side at the end of a stick, both hold the mass: the domain
            # below pushes up, the one above down. Else both push into the domain of the flight.
            if row.sticks or before.sticks:
                upward = alpha == belt
            else:
                upward = row.domain != belt
            signs.append(step(value, ">" if upward else "<", 0, at_root(lambda: values)))
        rows.append((*signed, f"$P_{row.label[1]}$"))
    return Table(
        f"tab:orbits-forces-{word}",
        rf"The accelerations on both sides at the switching points of $P_{{{word[1:]}}}$. By "
        r"their signs the next mapping is the one that the word demands "
        r"(Theorem~\ref{thm:switching-cases}).",
        ("$j$", "below", "above", "next"),
        tuple(rows),
        tuple(signs),
    )


def _between_table(
    scope: Scope, word: str, orbit_pieces: list[MappingPiece], points: tuple[tuple[Any, Any], ...]
) -> Table:
    """Return the table that shows that between the switching points no flight meets a belt, and
    each stick is held.
    """
    rows: list[Any] = []
    limited = list[Any]()
    for j, piece in enumerate(orbit_pieces):
        _, theta_at_end = points[(j + 1) % len(points)]
        for name, value, words, limits in _extremes(scope, piece, points[j], theta_at_end):
            rows.append(
                (f"$P_{piece.row.label[1]}$ from {j + 1}", name, decimal("z", value, 8), words)
            )
            shown = sp.Float(CONTEXT.nstr(value, STEP_DIGITS), STEP_DIGITS)
            limited += [step(shown, op, bound, at_root(dict)) for op, bound in limits]
    return Table(
        f"tab:orbits-between-{word}",
        rf"Between the switching points of $P_{{{word[1:]}}}$.",
        ("piece", "what", "value", "has to be"),
        tuple(rows),
        tuple(limited),
    )


def _followed(p: Parameters, word: str) -> Any:
    """Simulate one period from the orbit's first point.

    Return its mappings' numbers as one integer, such as 4645.
    """
    orbit = find_orbit(p, word, digits=STEP_DIGITS)
    (x, theta), *_ = orbit_points(p, word)
    t = theta / steps.number(p.Omega)
    # A little more than a period, so that the last mapping ends before.
    end = CONTEXT.mpf(t) + CONTEXT.mpf("1.001") * CONTEXT.mpf(orbit.period)
    start = {
        "t0": CONTEXT.nstr(t, 42),
        "x0": CONTEXT.nstr(x, 42),
        "v0": p.belt(read_word(word).maps[0].start.boundary),
    }
    motion = simulate(
        p, **start, t_end=CONTEXT.nstr(end, 20), digits=30, start_error=("1e-40", "1e-40", 0)
    )
    # A word such as P4645 is read from right to left, one digit for each mapping.
    mappings = motion.word[: len(word) - 1]
    return sp.Integer("".join(label[1] for label in reversed(mappings)))


#: The functions of `lambdify` in numbers of 60 digits.
FUNCTIONS = [
    {name: getattr(CONTEXT, name) for name in ("sin", "cos", "sinh", "cosh", "exp", "sqrt", "mpf")},
    "mpmath",
]


def _extremes(
    scope: Scope, piece: MappingPiece, start: tuple[Any, Any], end: Any
) -> Iterator[tuple[str, Any, str, list[tuple[str, Any]]]]:
    """Yield each extreme of v in a flight or of the forces in a stick: name, value, allowed range
    (LaTeX), bounds.
    """
    belt = piece.row.start.boundary
    row = piece.row
    speed = BELTS[belt]
    _, theta_at_start = start
    duration = ((end - theta_at_start) % (2 * CONTEXT.pi)) / steps.evaluate(Omega, scope.numbers)

    def extremes(expr: Any, slope: Any) -> tuple[Any, list[Any]]:
        """Return `expr` as a function of the time since the start, and the zeros of its time
        derivative `slope`.
        """
        pair = (_substituted(scope, part.xreplace(scope.display)) for part in (expr, slope))
        value, rate = (
            partial(sp.lambdify((x_i, theta_i, tau), part, FUNCTIONS), *start) for part in pair
        )
        return value, _zeros(rate, duration)

    if row.sticks:
        # Domain `belt` is below the belt and pushes up during a stick, domain belt + 1 down.
        for alpha, op, best, words in ((belt, ">", min, "least"), (belt + 1, "<", max, "largest")):
            held = force(alpha, x_i + speed * tau, speed, theta_i + Omega * tau)
            value, times = extremes(held, held.diff(tau))
            # The end of the stick, where one of both forces is 0, is left out.
            worst = best(
                value(at) for at in (CONTEXT.mpf(0), *times, duration * CONTEXT.mpf("0.9"))
            )
            yield rf"{words} $F^{{({alpha})}}$ on $[0, 0.9\tau]$", worst, f"${op} 0$", [(op, 0)]
        return
    start_values = {a_i: force(row.domain, x_i, speed, theta_i), v_i: speed}
    flow = solution.flow(scope.regimes[0])
    value, times = extremes(flow.v.xreplace(start_values), flow.a.xreplace(start_values))
    # Domain n is above the speed of belt n - 1 and below that of belt n, where there are such.
    neighbours = ((">", row.domain - 1), ("<", row.domain))
    limits = [(op, scope.numbers[BELTS[belt]]) for op, belt in neighbours if belt in BELTS]
    words = {1: "$< v_1$", 2: "between $v_1$ and $v_2$", 3: "$> v_2$"}[row.domain]
    for at in times:
        yield r"extreme of $\dot{x}$", value(at), words, limits


def _zeros(function: Any, duration: Any) -> list[Any]:
    """Return the zeros of a function in (0, duration), one for each sign change between neighbours
    on a grid.
    """
    # The grid has no point at either end: the function may be 0 there.
    grid = pairwise(duration * (n + CONTEXT.mpf("0.5")) / 120 for n in range(120))
    brackets = [(low, high) for low, high in grid if (function(low) > 0) != (function(high) > 0)]
    return [CONTEXT.clone().findroot(function, ends, solver="anderson") for ends in brackets]
