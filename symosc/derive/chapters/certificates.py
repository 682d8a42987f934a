"""Proof of each kind of certificate: interval Newton, Krawczyk, Brouwer, Banach; and that no event
is missed.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from symosc.derive.scope import Scope, v_lambda
from symosc.derive.steps import Items, Step, equation, exact, facts, sign, step
from symosc.symbolic.latex import named
from symosc.symbolic.solution import B0, A, Omega, c, k, m, t, theta

TITLE = "Certificates"

U, W = sp.symbols("u w", positive=True)
RATE = sp.Symbol("h", nonnegative=True)
ONE = named(r"\rho_1")
TWO = named(r"\rho_2")
TRACE = named("T")
DET = named("D")
SECOND = named(r"\ddot{g}")
FOURTH = named(r"g^{(4)}")


def items(scope: Scope) -> Items:
    """Yield the chapter: why enclosures prove motions, orbits, branches, motions that settle, and
    grazing windows.
    """
    yield _motions()
    yield _laws()
    yield _orbits()
    yield _windows()


def _motions() -> Items:
    """Yield the items on the arithmetic of balls, and motions."""
    x = sp.Symbol("x", real=True)
    y = sp.Symbol("Y", real=True)
    f = sp.Function("f")(x)
    circle = named(r"\frac{d}{dt}\bigl(\dot{x}^2 + \frac{m}{k}\ddot{x}^2\bigr)")
    yield (
        r"\subsection{What a ball proves}",
        r"A \emph{ball} is an interval of real numbers. Arithmetic with balls returns balls that "
        r"contain every result for numbers in the operands, rounding included; arb "
        r"\cite{johansson2017} does so for exponentials, sines and cosines with any number of "
        r"bits. A sign is certain if a ball does not contain 0. The engine only proposes: what it "
        r"computes in many digits, with a radius. The checker proves a list of such signs and "
        r"uses nothing of the engine. What they prove is the subject of this chapter. "
        r"\cite{tucker2011, neumaier1990}",
        r"\begin{theorem}[Krawczyk and Moore, \cite{krawczyk1969, "
        r"moore1977}]\label{thm:certificates-krawczyk} Let $f$ be continuously differentiable on a "
        r"box $X$ with the middle $c$, let the ball matrix $J$ contain $f'(x)$ for all $x \in X$, "
        r"and let $Y$ be a matrix. If $K = c - Y f(c) + (1 - Y J)(X - c)$ lies inside $X$, then "
        r"$f$ has exactly one zero in $X$, and it lies in $K$.\end{theorem}",
        r"\begin{proof} The map $\Phi(x) = x - Y f(x)$ has the derivative $1 - Y f'(x)$. By the "
        r"mean value theorem in each component $\Phi(X) \subset \Phi(c) + (1 - Y J)(X - c) = K "
        r"\subset X$. By Brouwer's theorem $\Phi$ has a fixed point in $X$, and it lies in $K$. "
        r"$K$ is inside $X$, so all matrices in $1 - Y J$ shrink the box $X - c$ strictly, in the "
        r"norm whose ball it is. So $Y$ and all matrices in $J$ are regular, fixed points of "
        r"$\Phi$ are zeros of $f$, and $\Phi$ is a contraction: by Banach's theorem there is only "
        r"one.\end{proof}",
        facts(equation((x - y * f).diff(x), 1 - y * f.diff(x), exact())),
        r"\begin{theorem}[interval Newton]\label{thm:certificates-newton} Let $P$ be continuously "
        r"differentiable on $X = c + E$ and the ball matrix $D$ contain all its derivatives. If "
        r"all $1 - M$ with $M \in D$ are regular and the solutions $w$ of $(1 - M) w = P(c) - c$ "
        r"lie inside $E$, then $P$ has exactly one fixed point in $X$, and it lies in $c + "
        r"w$.\end{theorem}",
        r"\begin{proof} For $u \in E$ there is $M(u) \in D$, continuous in $u$, with $P(c + u) = "
        r"P(c) + M(u) u$: the mean of the derivative along the segment. The map $u \mapsto (1 - "
        r"M(u))^{-1}(P(c) - c)$ takes $E$ into itself, so it has a fixed point by Brouwer's "
        r"theorem, and that is a fixed point of $P$. Two of them would differ by a vector $d$ with "
        r"$(1 - M) d = 0$ for some $M \in D$.\end{proof}",
        r"\subsection{Motions: every event is the next one}",
        r"Between events the motion is a closed form (Table~\ref{tab:domains-regimes}), so balls "
        r"enclose it for all times in a ball. In a bounded time it has finitely many events "
        r"(Theorem~\ref{thm:accumulation-finite}). Two ways show that nothing happens before an "
        r"event. One uses the gap of Lemma~\ref{thm:events-gap}, between the critical phases; the "
        r"other needs no critical phases.",
        r"\begin{lemma}[a straightened gap]\label{thm:certificates-height} On a piece of time from "
        r"$u = 0$, shorter than $\pi/(2\omega_d)$ if $c^2 < 4km$, let $C'' = \kappa C$, $S'' = "
        r"\kappa S$, $C(0) = S'(0) = 1$, $C'(0) = S(0) = 0$ with $h = c/2m$, $\kappa = h^2 - k/m$. "
        r"As a function of $s = S/C$, $H = e^{hu} g/C$ has $d^2 H/ds^2 = C^3 e^{hu} L g$. So "
        r"between critical phases it is convex or concave.\end{lemma}",
        r"\begin{proof} Write $g = e^{-hu} C q$, so that $H = q$. With $ds/du = (S'C - SC')/C^2 = "
        r"1/C^2$ it is $dH/ds = C^2 q'$ and $d^2 H/ds^2 = C^3 (C q'' + 2 C' q')$, while $L g = "
        r"e^{-hu} (C q'' + 2 C' q')$.",
        facts(*(fact for wave in (sp.cos, sp.cosh) for fact in _gap_facts(wave))),
        r"The sign of $L g$ is that of Lemma~\ref{thm:events-gap}, and $C > 0$ on the "
        r"piece.\end{proof}",
        r"So $g > 0$ at both ends of a piece means $g > 0$ on it if $H$ is concave, or convex with "
        r"tangents at the ends that meet above 0; else the piece is cut. Opposite signs mean one "
        r"zero, which interval Newton encloses. On a belt both forces are monotone between "
        r"critical phases (Section~\ref{sec:sticks}).",
        r"\begin{lemma}[steps without critical phases]\label{thm:certificates-steps} Let $g$ be "
        r"twice differentiable for times from $a$ to $b$, with $g(a) > 0$, or $a$ a start on the "
        r"belt. Then $g > 0$ up to $b$ if for all these times $g > 0$; or $g' > 0$; or, at a start "
        r"with $g = g' = 0$, $g'' > 0$; or $g' < 0$, $g(b) = 0$ and $b$ itself is left "
        r"out.\end{lemma}",
        r"\begin{proof} In each case $g$ is monotone, or its sign is what is asked for; integrate "
        r"once or twice.\end{proof}",
        r"Steps side by side, which are halved where none of the four holds, show where a piece "
        r"ends first. This is how the checker proves motions and orbits. It takes $g(a) + "
        r"u\,\dot{g}(a) - u^2 \max|\ddot{g}|/2$ as a lower bound at $a + u$; it is concave in "
        r"$u$, so that its ends decide; for the last step also the same backwards from its end. "
        r"In a flight $u = \ddot{g}$ solves $\ddot{u} + (c/m)\dot{u} + (k/m) u = r$ with $|r| \le "
        r"D = |B_0|\Omega^3/m$, so its energy bounds it, at resonance too: $|u(h)| \le (u^2 + "
        r"(m/k)\dot{u}^2)^{1/2} + h D (m/k)^{1/2}$; where $k$ is small, two integrations do. What "
        r"happens at the event follows from certain signs of the forces "
        r"(Section~\ref{sec:switching}). Starts that are known to an error are a set; its image "
        r"is enclosed by the value at its centre and the derivatives of "
        r"Section~\ref{sec:jacobians} over the whole set.",
        r"A graze is a double zero of the gap, which no error of the start allows. It is proven as "
        r"a statement about one start: a number $s$ of the start is left free, and with it the "
        r"zero is a simple one.",
        r"\begin{proposition}[one start touches]\label{thm:certificates-touch} Let $g(t, s)$ be "
        r"the gap of the flights from starts with $s$ from $a$ to $b$. Let $\ddot{g} > 0$ for all "
        r"of them and all times of an interval, $\dot{g} < 0 < g$ at its beginning and $g, \dot{g} "
        r"> 0$ at its end. Exactly one of these flights touches the belt in the interval, and does "
        r"not cross it, if one of these holds. (i)~Krawczyk's operator of $(g, \dot{g})$ maps a "
        r"box of times and of $s$ between $a$ and $b$, which contains all zeros of $\dot{g}$, into "
        r"its interior. (ii)~The least gap of the interval has different signs at $s = a$ and at "
        r"$s = b$, and $\partial g/\partial s \ne 0$ where $\dot{g} = 0$.\end{proposition}",
        r"\begin{proof} A touch is a zero of $(g, \dot{g})$, and such a zero is a touch, as $g$ is "
        r"convex in $t$. (i)~is Theorem~\ref{thm:certificates-krawczyk}; at the zero the Jacobian "
        r"has the determinant $-\ddot{g}\,\partial g/\partial s$. (ii)~As $\ddot{g} > 0$, the time "
        r"of the least gap is unique, and by the implicit function theorem it depends on $s$ "
        r"continuously differentiably. So the least gap is continuous in $s$ and has a zero by the "
        r"intermediate value theorem. Its derivative is $\partial g/\partial s$ at that time, "
        r"since $\dot{g} = 0$ there. That has one sign, so there is only one zero.\end{proof}",
        r"The checker uses (ii). That there is no event before the interval is proven for all $s$ "
        r"as above. The start that touches is between $a$ and $b$, two fractions within the error "
        r"of the start; nothing is claimed about the given digits themselves.",
        r"\begin{lemma}[exact touches]\label{thm:certificates-circles} Let $c = B_0 = 0$, $k > 0$, "
        r"and let a flight start with $\dot{x}_i$ and $\ddot{x}_i$. It touches the belt "
        r"$v_\lambda$ of its domain, and does not cross it, if and only if $\dot{x}_i^2 + "
        r"\frac{m}{k} \ddot{x}_i^2 = v_\lambda^2 > 0$ and it meets no other belt before.\end{lemma}",
        r"\begin{proof} In the flight $m \ddot{x} = A_\alpha - k x$, and along it the sum stays "
        r"what it is:",
        equation(circle, 0, {circle: _circle()}, "circle"),
        r"So, continued beyond all belts, the velocity has the amplitude $(\dot{x}_i^2 + "
        r"\frac{m}{k} \ddot{x}_i^2)^{1/2}$, and $\ddot{x} = 0$ exactly where it is reached. A "
        r"flight ends at the first belt that it meets or, at a touch, goes on.\end{proof}",
        r"This is the one graze of an exact start that is decided, in rational numbers: "
        r"$\dot{x}_i$ and $\ddot{x}_i$ are rational at an exact start, where a stick ends "
        r"($\dot{x}_i = v_\lambda$, $\ddot{x}_i = 0$), and at such a touch.",
    )


def _laws() -> Items:
    """Yield the items on motions under other friction laws."""
    u = sp.Function("u")(U)
    weighted = named(r"\frac{d}{ds}\bigl(e^{cs/m}\dot{u}\bigr)")
    r = named("r")
    push = named("D")
    most = sp.Symbol("M", positive=True)
    known = sp.Symbol("K", positive=True)
    factor = sp.Symbol("ell", positive=True)
    weight = sp.exp(c / m * U)
    pushed = (weight * u.diff(U)).diff(U).subs(u.diff(U, 2), r - c / m * u.diff(U) - k / m * u)
    bound = known + U * factor * (push + k / m * most)
    solved = (known + U * factor * push) / (1 - U * factor * k / m)
    square = named("F^2")
    amplitude = named("a^2")
    yield (
        r"\subsection{Motions under any friction law}",
        r"The checker derives the bands of Proposition~\ref{thm:friction_curves-bands} from the "
        r"belts, and follows a motion from edge to edge. In each band it has the linear equation "
        r"with the damping $c$ of the band, of any sign; at a belt "
        r"Theorem~\ref{thm:static_friction-cases} says what follows, and during a stick the gaps "
        r"are $F^{(\lambda)} + E$ and $E - F^{(\lambda+1)}$. At a corner with $F \ne 0$ the motion goes on "
        r"into the other band (Theorem~\ref{thm:friction_curves-corner}). Only the bound of "
        r"$u = \ddot{g}$ in a step and the use of its energy for all times depend on the sign of "
        r"$c$; the latter is left to bands with $c \ge 0$.",
        r"\begin{lemma}[a step in any band]\label{thm:certificates-growth} Let $\ddot{u} + "
        r"(c/m)\dot{u} + (k/m)u = r$ with $|r| \le D$, let $\gamma = e^{\max(-c, 0)\,h/m}$, and "
        r"$\ell = \min(h, m/c)$ if $c > 0$, else $\ell = \gamma h$. For times $s$ from 0 to $h$, "
        r"with $u$ and $\dot{u}$ on the right at $s = 0$,\begin{enumerate}\item[(i)] $|u(s)|$ is at "
        r"most $\gamma$ times the sum of $(u^2 + (m/k)\dot{u}^2)^{1/2}$ and $h D (m/k)^{1/2}$, for "
        r"$k > 0$;\item[(ii)] $|u(s)|$ is at most $|u| + \gamma h |\dot{u}| + h \ell D$, divided by "
        r"$1 - h \ell k/m$, if this is positive.\end{enumerate}\end{lemma}",
        r"\begin{proof} (i) is the proof of Theorem~\ref{thm:friction_curves-bounds}~(ii), with "
        r"$D$ in place of $|a|\Omega^3$ and divided by $(k/m)^{1/2}$; there $2h_{-} = "
        r"\max(-c, 0)/m$. (ii) Let $M$ be the largest $|u|$ of these times. By",
        equation(
            weighted,
            sp.exp(c / m * U) * (r - k / m * u),
            exact({weighted: pushed}),
            "weighted",
        ),
        r"(with $s$ for the time), $|\dot{u}(s)|$ is at most the sum of $e^{-cs/m}|\dot{u}|$ and "
        r"$\int_0^s e^{-c(s - \sigma)/m}\,d\sigma\,(D + kM/m)$, "
        r"so at most $\gamma|\dot{u}| + \ell\,(D + kM/m)$. "
        r"So $M \le |u| + \gamma h|\dot{u}| + h\ell\,(D + kM/m)$; equality is reached at the "
        r"bound of (ii).",
        facts(equation(bound.subs(most, solved), solved, exact())),
        r"\end{proof}",
        r"\begin{lemma}[exact arrivals]\label{thm:certificates-arrival} Let $c = B_0 = 0 < k$ in "
        r"the band of a flight with the constant sum $a^2$ of \eqref{eq:certificates-circle}. It "
        r"meets an edge of the speed $v_\lambda$ with",
        equation(
            square,
            k / m * (amplitude - v_lambda**2),
            exact({amplitude: v_lambda**2 + m / k * square}),
            "arrival",
        ),
        r"If this is exactly the limit up to which the belt holds, and $v_\lambda \ne 0$, the mass "
        r"sticks if it arrives in the direction of $v_\lambda$, and crosses if not.\end{lemma}",
        r"\begin{proof} During a stick the force changes at the rate $-k v_\lambda/m$: it falls, "
        r"and holds, where $v_\lambda$ points in the direction of the arrival.\end{proof}",
        r"At the end of a stick $F$ is 0 or the excess of static friction, so that $a^2$ is rational "
        r"there too. A touch of a belt with static friction, or of a corner, is a double zero and "
        r"stays open. A cycle without a drive is a fixed point of the map $P$ of $x$ alone, from an "
        r"arrival at a belt to the next one of its kind: no time is another. "
        r"Theorem~\ref{thm:certificates-newton} in one dimension proves it; its multipliers are 1 "
        r"and the derivative of $P$. No theorem asks that the motions contract: unstable orbits are proven alike. An "
        r"orbit that meets no edge is the steady motion of the band around $\dot{x} = 0$. Its "
        r"largest speed is the amplitude $V_0$ of Chapter~\ref{sec:events}, and its multipliers are "
        r"those of the band.",
    )


def _orbits() -> Items:
    """Yield the items on orbits, branches, and motions that settle."""
    meaning = {TRACE: ONE + TWO, DET: ONE * TWO}
    yield (
        r"\subsection{Orbits: existence, uniqueness, word, stability}",
        r"The unknowns are all switching points, the equations those of \eqref{eq:maps-f1} piece "
        r"by piece, the last piece ending where the first begins, $N$ periods later. "
        r"Theorem~\ref{thm:certificates-krawczyk} proves one root in a box. It is an orbit with "
        r"its word if each piece ends where it first can (Lemma~\ref{thm:certificates-steps}), if "
        r"at each crossing both forces have the sign of the passage and at each onset of a stick "
        r"the signs of Theorem~4, and if both forces hold during the whole stick. All these are "
        r"certain signs over the box. The checker proves it by "
        r"Theorem~\ref{thm:certificates-newton}, for the map from the first event to itself.",
        r"\begin{proposition}[stability from trace and determinant]\label{thm:certificates-stable} "
        r"Both multipliers lie inside the unit circle if and only if $|D| < 1$ and $|T| < 1 + D$, "
        r"with trace $T$ and determinant $D$ of the monodromy matrix.\end{proposition}",
        r"\begin{proof} With $T = \rho_1 + \rho_2$ and $D = \rho_1\rho_2$",
        equation(1 - TRACE + DET, (1 - ONE) * (1 - TWO), meaning, "minus"),
        "and",
        equation(1 + TRACE + DET, (1 + ONE) * (1 + TWO), meaning, "plus"),
        r"A complex pair has $D = |\rho|^2$, and then both products are positive; so $D < 1$ "
        r"decides. For real multipliers both products are positive if and only if both multipliers "
        r"lie in $(-1, 1)$, or both are beyond the same end of it.",
        r"Beyond the same end $|D| > 1$, which is excluded; beyond different ends both products "
        r"are negative.",
        facts(*_beyond()),
        r"\end{proof}",
        r"A multiplier of exactly 1 makes the closing equations singular: neither theorem can then "
        r"be applied, with any number of bits. So a member of a continuum, as without damping at "
        r"$\Omega = \omega_0/(2n)$ \cite{csernak2007}, is never proven to be the only one. With "
        r"damping every orbit is the only one (Section~\ref{sec:orbits}).",
        r"\subsection{Branches: every value of a parameter}",
        r"Let $\delta$ be the change of a parameter from the middle of an interval, $|\delta| \le "
        r"d$, and $p(\delta)$ a polynomial near the curve of roots. Taylor's theorem encloses "
        r"$f(p(\delta), \delta)$ by its first coefficients at 0 and one more over the whole "
        r"interval; arithmetic with power series of balls gives both. "
        r"Theorem~\ref{thm:certificates-krawczyk} with this enclosure for $f(c)$ and $J$ over all "
        r"$p(\delta) + R$ proves one root in $p(\delta) + R$ for \emph{every} $\delta$, and it "
        r"depends continuously on $\delta$. The signs that make it an orbit are certain over the "
        r"whole tube, or the interval is halved. Neighbouring intervals have the same root where "
        r"they meet: it lies in both tubes. Since $1 - YJ$ has a norm below 1 for $J$ over all of "
        r"a box, $f$ is one-to-one there, and the root is the only one in that box. The flow is "
        r"made of $\cosh w\tau$ and $\sinh(w\tau)/w$ with $w^2 = (c/2m)^2 - k/m$, entire "
        r"functions of $w^2$, so a branch may pass through critical damping. The checker takes "
        r"derivatives that are coefficients of power series, and interval Newton in place of "
        r"Krawczyk's operator.",
        r"\begin{proposition}[the end of a branch]\label{thm:certificates-end} Let one root be "
        r"proven for every parameter value between $a$ and $b$, all inequalities at $a$, and that "
        r"one of them is violated at $b$. Then between $a$ and $b$ there is a first value at which "
        r"an inequality of the orbit becomes an equality. There the branch ends.\end{proposition}",
        r"\begin{proof} Each side of each inequality is continuous in the root, or is the least "
        r"value of a continuous function over a piece, and the root is continuous in the "
        r"parameter. Use the intermediate value theorem.\end{proof}",
        r"\subsection{Motions that settle: any number of periods}",
        r"Carried from event to event, an enclosure says something of some thousand periods. One "
        r"that settles on an orbit is enclosed for ever. Let $P$ be the map from an arrival at a "
        r"belt, with its time and position, to the same arrival some periods later, less these "
        r"periods. Let $B$ be the box of all $y$ with $|y_i - c_i| \le e_i$, and let the entries "
        r"of $D$ contain the derivatives of $P$ over $B$. All three are balls: the events of all "
        r"motions from $B$ are proven as those of one motion are "
        r"(Lemma~\ref{thm:certificates-steps}), and $D$ is the product of the Jacobians of their "
        r"maps.",
        r"\begin{proposition}[a motion that settles]\label{thm:certificates-settled} Let every "
        r"motion from $B$ have the events of one word, and let $P(B) \subset B$. Then every motion "
        r"that comes into $B$ has the events of this word in every later period, at the phases and "
        r"positions of the first one's enclosures. If also $q = \max_i \sum_j |D_{ij}|\, e_j/e_i < "
        r"1$, there is one orbit that passes $B$ once in every turn, and $n$ turns later a motion "
        r"is within $2 q^n e_i$ of it.\end{proposition}",
        r"\begin{proof} The first part is induction: a motion in $B$ has these events and comes "
        r"into $B$ again. For the second let $\|y\| = \max_i |y_i|/e_i$. By the mean value theorem "
        r"$|P(a) - P(b)|_i \le \sum_j |D_{ij}|\,|a_j - b_j| \le q\, e_i\, \|a - b\|$ for all $a$, "
        r"$b$ in $B$, which is convex. So $P$ is a contraction of the complete set $B$ into "
        r"itself, and Banach's theorem gives one fixed point $y^*$. Two points of $B$ have $\|a - "
        r"b\| \le 2$, hence $\|P^n(a) - y^*\| \le 2 q^n$.\end{proof}",
        r"So the last events of a motion of $10^5$ periods are known to as many digits as are "
        r"asked for: the orbit is enclosed by Theorem~\ref{thm:certificates-newton}, and $2 q^n$ "
        r"is added. The checker follows $B$ once round with exponentials of matrices.",
    )


def _windows() -> Items:
    """Yield the items on windows."""
    path = sp.Function("x")(t)
    newton = (A + B0 * sp.cos(Omega * t) - c * path.diff(t) - k * path) / m
    velocity = path.diff(t)
    # F^(alpha) along the flow and its first three time derivatives.
    derivatives = [newton]
    for _ in range(3):
        derivatives.append(derivatives[-1].diff(t).subs(path.diff(t, 2), newton))
    # At the contact x' = v_lambda and x'' = F = 0, which gives x.
    place = sp.solve(newton.subs(velocity, v_lambda), path)[0]
    force, first, second, third = (
        derivative.subs(velocity, v_lambda).subs(path, place).subs(Omega * t, theta)
        for derivative in derivatives
    )
    touch = third.subs(sp.cos(theta), 0).subs(sp.sin(theta), -k * v_lambda / (B0 * Omega))
    yield (
        r"\subsection{Windows: every phase}",
        r"\begin{lemma}[a contact without force]\label{thm:certificates-window} Let a flight meet "
        r"a belt with $F = 0$, so that $g = \dot{g} = 0$ for its gap. Then",
        equation(
            SECOND,
            -(k * v_lambda + B0 * Omega * sp.sin(theta)) / m,
            sp.simplify(first),
            "second",
        ),
        r"Where this is 0 and $\cos\theta = 0$, also $g''' = 0$ and",
        equation(FOURTH, -k * Omega**2 * v_lambda / m, sp.simplify(touch), "fourth"),
        r"\end{lemma}",
        r"\begin{proof} Differentiate the equation of motion and put $\dot{x} = v_\lambda$, "
        r"$\ddot{x} = 0$. The third derivative is $-(c/m)\ddot{g} - "
        r"(B_0\Omega^2/m)\cos\theta$.\end{proof}",
        facts(
            equation(force, 0),
            equation(second, -c / m * first - B0 * Omega**2 / m * sp.cos(theta)),
        ),
        r"So the sign of \eqref{eq:certificates-second} decides at every phase but its zeros. "
        r"Those are the phases with $\sin\theta = -k v_\lambda/(B_0\Omega)$, at most two, and "
        r"between them the sign is constant: one phase of each arc proves it. At a zero with "
        r"$\cos\theta \ne 0$ the gap changes its sign; at one with $\cos\theta = 0$ "
        r"\eqref{eq:certificates-fourth} decides, or, in the paper's order, nothing does. The "
        r"checker covers the circle outside the ends with intervals of certain sign, and shows "
        r"that the derivative has one sign at the ends.",
    )


def _circle() -> Any:
    """Return the rate of v^2 + (m/k) a^2 along a flight without damper and drive."""
    path = sp.Function("x")(t)
    newton = (A - k * path) / m
    total = path.diff(t) ** 2 + m / k * newton**2
    return total.diff(t).subs(path.diff(t, 2), newton)


def _beyond() -> tuple[Step, ...]:
    """Return the steps on two multipliers beyond the same end of (-1, 1), and beyond different
    ends.
    """
    above = 1 + U
    below = -1 - W
    product = named("D")
    minus = named(r"(1 - \rho_1)(1 - \rho_2)")
    plus = named(r"(1 + \rho_1)(1 + \rho_2)")
    same = sign({product: above * (1 + W)}), sign({product: below * (-1 - U)})
    differ = sign({minus: (1 - above) * (1 - below)}), sign({plus: (1 + above) * (1 + below)})
    return (
        *(step(product, ">", 1, check) for check in same),
        *(step(name, "<", 0, check) for name, check in zip((minus, plus), differ, strict=True)),
    )


def _gap_facts(wave: Any) -> Items:
    """Return the steps of the proof that e^{hu} g/C is convex or concave, for a gap g and C =
    `wave`, cos or cosh.
    """
    C = wave(W * U)
    q = sp.Function("q")(U)
    kappa = C.diff(U, 2) / C
    S = {sp.cos: sp.sin, sp.cosh: sp.sinh}[wave](W * U) / W
    g = sp.exp(-RATE * U) * C * q
    operator = g.diff(U, 2) + 2 * RATE * g.diff(U) + (RATE**2 - kappa) * g
    slope = (S / C).diff(U)
    first = q.diff(U) / slope
    letters = LG, _C, _C1, Q1, Q2, SLOPE, FIRST, SECOND_H = [
        named(name)
        for name in ("L g", "C", "C'", "q'", "q''", "s'", "dH/ds", r"\frac{d^2 H}{ds^2}")
    ]
    values = operator, C, C.diff(U), q.diff(U), q.diff(U, 2), slope, first, first.diff(U) / slope
    meaning = dict(zip(letters, values, strict=True))
    check = exact(meaning, lambda rest: sp.simplify(sp.expand(rest)))
    return (
        equation(LG, sp.exp(-RATE * U) * (_C * Q2 + 2 * _C1 * Q1), check),
        equation(SLOPE, 1 / _C**2, check),
        equation(FIRST, _C**2 * Q1, check),
        equation(SECOND_H, _C**3 * (_C * Q2 + 2 * _C1 * Q1), check),
    )
