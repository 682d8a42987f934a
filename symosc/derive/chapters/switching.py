"""G-functions, Lemmas 1 to 3 and Theorems 4 to 6: eqs. (13) to (48)."""

from __future__ import annotations

from typing import Any

import sympy as sp

from symosc.derive.chapters.motion import balance
from symosc.derive.scope import F, G, Scope, v_lambda
from symosc.derive.steps import Illustration, Items, Step, equation, exact, facts
from symosc.symbolic import solution
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, Omega, c, k, m, t, tau, theta, theta_i, v, x_i

TITLE = "What happens at a boundary"


def items(scope: Scope) -> Items:
    """Yield the chapter: G-functions, the first that does not vanish, and Theorems 4 to 6."""
    n = sp.Function("n")(t)
    y = sp.Function("y")(t)
    first = named(r"G^{(0,\alpha)}")
    second = named(r"G^{(1,\alpha)}")

    def product(normal: str, dot: str) -> Any:
        """Return a symbol that prints the product n^T (x^(alpha) - x^(0)), also with derivatives of
        n or x.

        `normal` is printed before n ("", "D" or "D^2"), and `dot` over each x: a LaTeX accent for
        time derivatives.
        """
        x_alpha, x_0 = (rf"{dot}{{\mathbf{{x}}}}^{{({index})}}" for index in (r"\alpha", "0"))
        return named(
            rf"{normal}\mathbf{{n}}^T ({x_alpha} - {x_0})".replace("{\\mathbf{x}}", r"{\mathbf{x}}")
        )

    parts = {
        ("", r"\ddot"): n * y.diff(t, 2),
        ("D", r"\dot"): n.diff(t) * y.diff(t),
        ("D^2", ""): n.diff(t, 2) * y,
    }
    parts |= {("", r"\dot"): n * y.diff(t), ("D", ""): n.diff(t) * y}
    letters = {product(*key): value for key, value in parts.items()}
    check = exact({first: (n * y).diff(t), second: (n * y).diff(t, 2)} | letters)
    normal = [
        equation(letter, value, {letter: (v - v_lambda).diff(by)})
        for letter, value, by in ((named("n_1"), 0, solution.x), (named("n_2"), 1, v))
    ]
    yield (
        r"\subsection{G-functions}",
        r"Luo's theory of flow switchability \cite{luo2008,luo2009} compares the flow "
        r"$\mathbf{x}^{(\alpha)}(t)$ of a domain with the flow $\mathbf{x}^{(0)}(t)$ in its "
        r"boundary, along the boundary's normal $\mathbf{n}$; a dot is the derivative along each "
        r"flow, and $D$ the derivative of $\mathbf{n}$ along $\mathbf{x}^{(0)}$.",
        r"\begin{definition}[Luo's G-functions]\label{thm:switching-G} The G-functions of the "
        r"orders 0 and 1 are (the paper's (15) and (16))",
        equation(first, product("D", "") + product("", r"\dot"), check, "G0"),
        equation(
            second,
            product("D^2", "") + 2 * product("D", r"\dot") + product("", r"\ddot"),
            check,
            "G1",
        ),
        r"and so on: $G^{(j,\alpha)}$ is the derivative of the order $j + 1$ of "
        r"$\mathbf{n}^T(\mathbf{x}^{(\alpha)} - \mathbf{x}^{(0)})$.\end{definition}",
        r"\begin{lemma}[reduction]\label{thm:switching-reduction} Where the flow meets a flat "
        r"boundary that does not move, $G^{(0,\alpha)} = \mathbf{n}^T\dot{\mathbf{x}}^{(\alpha)}$ "
        r"and $G^{(1,\alpha)} = \mathbf{n}^T\ddot{\mathbf{x}}^{(\alpha)}$ (the paper's (18) and "
        r"(19)). On the boundary $\dot{x} = v_\lambda$, with $\mathbf{x} = (x, \dot{x})^T$ and "
        r"$\mathbf{n} = (0, 1)^T$ (the paper's (25)), $G^{(j,\alpha)} = d^{\,j} "
        r"F^{(\alpha)}/dt^{\,j}$ for all $j \ge 0$, along the flow of $\Omega_\alpha$.\end{lemma}",
        facts(*normal, *(_gap_derivative(order) for order in (1, 2))),
        r"\begin{proof} $\mathbf{n}$ is constant, so its derivatives vanish, and "
        r"$\mathbf{n}^T\mathbf{x}^{(0)}$ is constant because $\mathbf{x}^{(0)}$ stays in the "
        r"boundary, so its derivatives vanish too. What is left is "
        r"$d^{\,j+1}(\mathbf{n}^T\mathbf{x}^{(\alpha)})/dt^{\,j+1}$, and here "
        r"$\mathbf{n}^T\mathbf{x}^{(\alpha)} = \dot{x}$ with $\ddot{x} = F^{(\alpha)}$.\end{proof}",
    )
    yield g_functions()
    gap = named(r"\dot{x}(\tau) - v_\lambda")
    orders = [F(r"\alpha"), *(G(n) for n in (1, 2, 3))]
    taylor = sp.Add(*(value * tau**n / sp.factorial(n) for n, value in enumerate(orders, 1)))
    meaning = {gap: gap_series(len(orders))} | dict(zip(orders, along_flow(3), strict=True))
    yield (
        r"\subsection{The first G-function that does not vanish}",
        r"\begin{lemma}[which side before, which side after]\label{thm:switching-side} Let the "
        r"flow of $\Omega_\alpha$ have $\dot{x} = v_\lambda$ at $\tau = 0$, and let "
        r"$G^{(n,\alpha)}$ be the first of its G-functions there that does not vanish. Shortly "
        r"after the contact $\dot{x} - v_\lambda$ has the sign of $G^{(n,\alpha)}$, shortly before "
        r"it that of $(-1)^{n+1} G^{(n,\alpha)}$. So for even $n$ the flow crosses, and for odd "
        r"$n$ it touches and returns to the side that it came from.\end{lemma}",
        r"\begin{proof} By Taylor's theorem, here from the equation of motion and up to terms of "
        r"the order $\tau^5$,",
        equation(gap, taylor, meaning, "taylor"),
        r"and the first term that does not vanish, $G^{(n,\alpha)}\tau^{n+1}/(n+1)!$, is larger "
        r"than all that follow for small $|\tau|$; $\tau^{n+1}$ is positive before the contact iff "
        r"$n$ is odd.\end{proof}",
        r"If all G-functions vanish, the flow of $\Omega_\alpha$ stays in the boundary for ever. "
        r"By \eqref{eq:switching-g1} this needs $k v_\lambda + B_0\Omega\sin\theta = 0$ at all "
        r"times: $B_0 = 0$ and $k v_\lambda = 0$.",
        Illustration(
            "quartic",
            "fig:switching-orders",
            r"The gap $\dot{x} - v_\lambda$ near a contact with $G^{(n,\alpha)} < 0$ for the first "
            r"$n$ that counts.",
            0.8,
        ),
    )
    yield (
        r"\subsection{The paper's Lemmas 1 to 3 and Theorems 4 to 6}",
        r"\begin{theorem}[stick, passage, graze]\label{thm:switching-cases} Let a motion have "
        r"$\dot{x} = v_\lambda$ at the time $t_m$, at the position $x_m$, and let $F^{(\lambda)}$ "
        r"and $F^{(\lambda+1)}$ be taken there. \begin{enumerate}\item[(i)] It sticks after $t_m$ "
        r"if $F^{(\lambda)} > 0$ and $F^{(\lambda+1)} < 0$ (Lemma 1, Theorem 4).\item[(ii)] It "
        r"passes if $F^{(\lambda)} F^{(\lambda+1)} > 0$: into $\Omega_{\lambda+1}$ if both are "
        r"positive, into $\Omega_\lambda$ if both are negative (Lemma 2, Theorem 5).\item[(iii)] A "
        r"flow that comes to the boundary in $\Omega_\lambda$ returns into $\Omega_\lambda$ if "
        r"$F^{(\lambda)} = 0$ and $G^{(1,\lambda)} < 0$; one that comes in $\Omega_{\lambda+1}$ "
        r"returns if $F^{(\lambda+1)} = 0$ and $G^{(1,\lambda+1)} > 0$ (Lemma 3, Theorem "
        r"6).\item[(iv)] If $F^{(\alpha)}$ and $G^{(1,\alpha)}$ vanish, the first G-function that "
        r"does not vanish takes their part: the flow of $\Omega_\lambda$ returns iff its order is "
        r"odd and it is negative, that of $\Omega_{\lambda+1}$ iff its order is odd and it is "
        r"positive.\end{enumerate}\end{theorem}",
        r"\begin{proof} By Lemma~\ref{thm:switching-side} with $n = 0$, for $F^{(\lambda)} > 0$ no "
        r"motion can go below the boundary: there $\ddot{x}$ is near $F^{(\lambda)}$, and "
        r"$\dot{x}$ would grow back. For $F^{(\lambda+1)} < 0$ none can go above it. With both the "
        r"mass stays, and by Theorem~\ref{thm:motion-unique} this is the motion: (i). If both are "
        r"positive, it cannot go below, and cannot stay by Proposition~\ref{thm:motion-held}; so "
        r"it follows the flow of $\Omega_{\lambda+1}$, which by Lemma~\ref{thm:switching-side} "
        r"goes above. The mirror image is the other half of (ii). (iii) and (iv) are "
        r"Lemma~\ref{thm:switching-side} with odd $n$; for $F^{(\lambda)} = 0$ "
        r"Lemma~\ref{thm:motion-jump} has $F^{(\lambda+1)} \le 0$, so that the returning flow is "
        r"the motion.\end{proof}",
        r"\begin{remark}[what ``iff'' needs]\label{thm:switching-iff} As conditions on strict "
        r"signs the paper's Theorems 4 and 5 are necessary as well, but not where an acceleration "
        r"vanishes. A flow that comes from below with $F^{(\lambda)} = 0$ has a first $n$ that is "
        r"odd with $G^{(n,\lambda)} < 0$, and grazes, or even with $G^{(n,\lambda)} > 0$, and then "
        r"it sticks if the belt has friction, since $F^{(\lambda+1)} < 0$ by "
        r"Lemma~\ref{thm:motion-jump}; and so on. The ``iff'' of Lemma 3, with $n = 1$ alone, "
        r"leaves out the tangencies of higher order; this is where Theorem 7 loses its case of "
        r"equality (Theorem~\ref{thm:grazing-equality}).\end{remark}",
        r"What (iii) asks for is at the boundary $\dot{x} = v_\lambda$, on either side of either "
        r"belt,",
        at_belt("decides"),
        r"where the term with $F^{(\alpha)}$ vanishes at a graze.",
    )


def along_flow(order: int) -> list[Any]:
    """Return F and its derivatives up to an order along the flow, on a belt at x_i and theta_i,
    from Newton's law.
    """
    place, speed, phase = sp.symbols("x v theta", real=True)
    push = balance(place, speed, phase)
    derivatives = [push]
    for _ in range(order):
        last = derivatives[-1]
        derivatives.append(
            last.diff(place) * speed + last.diff(speed) * push + last.diff(phase) * Omega
        )
    start = {place: x_i, speed: v_lambda, phase: theta_i}
    return [derivative.subs(start, simultaneous=True) for derivative in derivatives]


def gap_series(order: int) -> Any:
    """Return the gap to a belt up to tau^order, with the coefficients that the equation of motion
    asks for.
    """
    # m g'' + c g' + k (g + v_lambda) = -B0 Omega sin(theta): the equation of motion,
    # differentiated.
    rates = sp.symbols(f"g_1:{order + 1}")
    gap = sp.Add(*(rate * tau**n for n, rate in enumerate(rates, 1)))
    drive = B0 * Omega * sp.sin(theta_i + Omega * tau)
    residual = m * gap.diff(tau, 2) + c * gap.diff(tau) + k * (gap + v_lambda) + drive
    first_rate, *other_rates = rates
    solved = {first_rate: balance(x_i, v_lambda, theta_i)}
    for n, rate in enumerate(other_rates):
        condition = residual.diff(tau, n).subs(tau, 0).subs(solved)  # linear in the rate
        solved[rate] = -condition.subs(rate, 0) / condition.diff(rate)
    return gap.subs(solved)


def _gap_derivative(order: int) -> Any:
    """Return the step that n.(x - x0) and n.x have the same `order`-th derivative, for x0 on a
    straight boundary.
    """
    # x = (X, Y), and x0 = p + s (-n_2, n_1) moves along the line with the normal n.
    n1, n2, p1, p2 = sp.symbols("n_1 n_2 p_1 p_2", real=True)
    first, second, moved = (sp.Function(name)(t) for name in ("X", "Y", "s"))
    gap = n1 * (first - p1 + n2 * moved) + n2 * (second - p2 - n1 * moved)
    right = n1 * first.diff(t, order) + n2 * second.diff(t, order)
    return equation(gap.diff(t, order), right, exact())


def at_belt(label: str) -> Step:
    """Return the step on G^(1) at a belt's speed, in terms of the acceleration there."""
    true = {G(1): solution.g_function(1), F(r"\alpha"): solution.acceleration()}
    on_belt = {Omega * t: theta, v: v_lambda}
    true = {name: solution.in_paper_letters(value).subs(on_belt) for name, value in true.items()}
    return equation(
        G(1), -c * F(r"\alpha") / m - k * v_lambda / m - B0 * Omega * sp.sin(theta) / m, true, label
    )


def g_functions() -> Items:
    """Return the lemma on G^(1) to G^(3), the derivatives of the acceleration F^(alpha) along its
    flow.
    """
    path = sp.Function("x")(t)
    newton = (solution.A + B0 * sp.cos(Omega * t) - c * path.diff(t) - k * path) / m
    # The names of x', x'' = F^(alpha), and of the higher derivatives, as far as they are known.
    names = [v, F(r"\alpha")]
    rows = []
    for n in (1, 2, 3):
        # The highest derivative first: a lower one is part of it.
        named_derivatives = [(path.diff(t, j + 1), names[j]) for j in range(n, -1, -1)]
        true = newton.diff(t, n).doit().subs(named_derivatives)
        *_, before_last, last = names
        right = solution.next_derivative(last, before_last, solution.forcing(n)).xreplace(
            solution.PAPER_LETTERS
        )
        rows.append(equation(G(n), right, true.subs(Omega * t, theta), f"g{n}"))
        names.append(G(n))
    return (
        r"\begin{lemma}[the first G-functions]\label{thm:switching-g} Along the flow of "
        r"$\Omega_\alpha$, with $\theta = \Omega t$,",
        rows,
        r"\end{lemma}",
        r"\begin{proof} Differentiate \eqref{eq:motion-acceleration} along the motion. The first "
        r"one is the paper's (47) and (48): $\nabla F^{(\alpha)}\cdot(\dot{x}, F^{(\alpha)})^T + "
        r"\partial F^{(\alpha)}/\partial t$.\end{proof}",
    )
