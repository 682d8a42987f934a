"""When chaos is possible and when not, and a driven stick-slip motion that is proven to have it."""

from __future__ import annotations

from functools import cache, partial
from random import Random
from typing import Any, NamedTuple

import sympy as sp

from symosc.derivatives.sensitivities import sensitivities
from symosc.derive.chapters.friction_curves import LEAST
from symosc.derive.chapters.return_maps import DRIVEN
from symosc.derive.scope import Scope
from symosc.derive.slip_enclosure import is_continuous
from symosc.derive.slip_map import (
    Slip,
    by_phase,
    derivative_by_series,
    in_digits,
    next_by_series,
    next_slip,
)
from symosc.derive.steps import (
    CONTEXT,
    Check,
    Items,
    Step,
    StepError,
    StepEvidence,
    Table,
    at_root,
    close,
    decimal,
    equation,
    facts,
    number,
    sign,
    step,
)
from symosc.model import Belt, Oscillator
from symosc.symbolic.latex import named
from symosc.symbolic.solution import m

TITLE = "When chaos is possible"
DECIMALS = 15
#: Decimals of images in the table of intervals, and of the exponent of a long motion.
IMAGE_DECIMALS = 6
EXPONENT_DECIMALS = 4
#: Static friction of the example: where one motion attracts, and where the map has a horseshoe.
SETTLED = ("7/10", "77/100", "49/50")
CHAOTIC = "63/50"
#: Places of the maps that check a bound.
PLACES_OF_MAP = 60
#: Slips of the long motion, and how far its twin begins from it.
LONG = 150
APART = CONTEXT.mpf(10) ** -36


def items(scope: Scope) -> Items:
    """Yield the chapter: where there is no chaos, what remains, an example that becomes chaotic."""
    yield _none()
    yield _possible()
    yield _period_one()
    yield _horseshoe()
    yield _in_a_band()


# --- where there is none ---


def _none() -> Items:
    """Return the items on the two reasons why there is no chaos."""
    count = sp.Symbol("n", positive=True)
    length = sp.Symbol("ell", positive=True)
    scale = sp.Symbol("epsilon", positive=True)
    entropy = named(r"h_\epsilon")
    most = named("N")
    many = 1 + count * length / scale
    return (
        r"\subsection{Where there is none}",
        r"Chaos is meant as positive topological entropy: the number of motions that can be told "
        r"apart at a scale $\epsilon$ within $n$ returns grows exponentially with $n$.",
        r"\begin{theorem}[two reasons for order]\label{thm:chaos-none} Let $k > 0$. The entropy is "
        r"0, \begin{enumerate}\item[(i)] if the law contracts, that is if $E = 0$ at all belts and "
        r"$c_j \ge 0$ in all bands, with or without a drive; for $c_* > 0$ one motion attracts all "
        r"others, or each tends to a rest;\item[(ii)] if there is no drive, $B_0 = 0$, whatever "
        r"the law is; all bounded motions then tend to rests and closed "
        r"curves.\end{enumerate}\end{theorem}",
        r"\begin{proof} (i) is Theorem~\ref{thm:exponents-chaos} with "
        r"Theorem~\ref{thm:friction_curves-contraction} (i), and "
        r"Corollary~\ref{thm:friction_curves-attractor}. (ii) By "
        r"Theorem~\ref{thm:return_maps-monotone} the turns of motions in an interval of the length "
        r"$\ell$ follow a map $P$ that never falls. Let $a_1 < \cdots < a_N$ be turns of which "
        r"each two are at least $\epsilon$ apart at one of the first $n$ returns. At a given "
        r"return the $N - 1$ gaps between neighbours add up to at most $\ell$, so that at most "
        r"$\ell/\epsilon$ of them reach $\epsilon$; each of them does so at one of $n$ returns at "
        r"least. So",
        step(most, "<=", many, _counted(count, length, scale), "count"),
        r"and the entropy at the scale $\epsilon$ is",
        equation(entropy, 0, _vanishing(many, count), "entropy"),
        r"$P$ need not be continuous for this.\end{proof}",
    )


def _counted(count: Any, length: Any, scale: Any) -> Check:
    """Return the check of the bound by the sum of gaps, and with maps drawn at random."""
    reached = sp.Symbol("epsilon_1", nonnegative=True)
    # (N - 1) epsilon, summed over all returns, is at most n ell
    meaning = {named("N"): 1 + (count * length - reached) / scale}

    def check(statement: Step) -> StepEvidence:
        evidence = sign(meaning)(statement)
        dice = Random(47)
        for returns in range(1, 13):
            images = sorted(dice.randint(0, PLACES_OF_MAP) for _ in range(PLACES_OF_MAP + 1))
            least = dice.randint(1, 9)
            values = {named("N"): _separated(images, returns, least), count: returns}
            values |= {length: PLACES_OF_MAP, scale: least}
            left, right = (side.subs(values) for side in (statement.left, statement.right))
            if not left <= right:
                raise StepError(str(statement), f"{left} motions are told apart, not {right}")
        return evidence

    return check


def _separated(images: list[int], returns: int, least: int) -> int:
    """Return the largest number of starts of which each two are `least` apart at one of the returns.

    A map that never falls keeps the order, so that it is enough to look at neighbours.
    """
    chosen = 1
    last = [0] * returns
    for start in range(PLACES_OF_MAP + 1):
        path = [start]
        for _ in range(returns - 1):
            path.append(images[path[-1]])
        if start == 0:
            last = path
        elif max(there - here for here, there in zip(last, path, strict=True)) >= least:
            last = path
            chosen += 1
    return chosen


def _vanishing(many: Any, count: Any) -> Check:
    """Return the check that ln(bound)/n tends to the right side."""

    def check(statement: Step) -> StepEvidence:
        limit = sp.limit(sp.log(many) / count, count, sp.oo)
        if limit != statement.right:
            raise StepError(str(statement), f"the limit is {limit}")
        return StepEvidence("exact", "0")

    return check


# --- what remains ---


def _possible() -> Items:
    """Return the items on the exponents where chaos is possible."""
    total = named(r"\Lambda_1 + \Lambda_2")
    more = sp.Symbol("epsilon_1", nonnegative=True)
    passed = sp.Symbol("epsilon_2", nonnegative=True)
    rows = (
        (r"no excess, no $c_j < 0$", "0", "0", r"one attractor for $c_* > 0$"),
        (r"an excess or $c_j < 0$", "0", "possible", "without a drive: rests and cycles"),
    )
    return (
        r"\subsection{What remains possible}",
        r"So, for $k > 0$, chaos needs a drive, and a belt with $E > 0$ or a band with $c_j < 0$ "
        r"(Table~\ref{tab:chaos-when}).",
        Table(
            "tab:chaos-when",
            "Topological entropy of an oscillator with $k > 0$, by its law and its drive.",
            ("law", "$B_0 = 0$", r"$B_0 \ne 0$", "attractors"),
            rows,
        ),
        r"\begin{proposition}[exponents]\label{thm:chaos-exponents} \begin{enumerate}\item[(i)] A "
        r"motion that sticks again and again, and slips with $b \ne 0$, has $\Lambda_2 = -\infty$, "
        r"and $\Lambda_1$ is the sum of the $\ln|d\xi'/d\xi|$ of "
        r"Theorem~\ref{thm:return_maps-derivative} per unit of time. For $E > 0$ it may be "
        r"positive.\item[(ii)] A motion that never sticks has",
        step(
            total,
            "<=",
            -LEAST / m,
            sign({total: -(LEAST + more) / m - passed}),
            "sum",
        ),
        r"so that both exponents cannot be positive unless $c_* < "
        r"0$.\end{enumerate}\end{proposition}",
        r"\begin{proof} (i) The derivative of the motion from stick to stick has rank one "
        r"(Theorem~\ref{thm:jacobians-monodromy}), and the line is what remains. (ii) "
        r"\eqref{eq:friction_curves-area} for the flights, and each passage of a belt multiplies "
        r"areas by a ratio $F^{+}/F^{-}$ between 0 and 1, by "
        r"\eqref{eq:jacobians-bound}.\end{proof}",
    )


# --- motions with the period of the drive ---


class FixedSlip(NamedTuple):
    """A slip that repeats after a period of the drive, and the multiplier of its motion."""

    phase: Any
    multiplier: Any


def _belt(static: Any) -> Any:
    return in_digits(DRIVEN._replace(holding=0))._replace(holding=number(static))


def _exact_belt(static: str) -> Any:
    value = sp.Rational(static)
    return _belt(CONTEXT.mpf(value.p) / value.q)


def _repeating(belt: Any, guess: Any) -> FixedSlip:
    """Return the slip downward that repeats after one period of the drive, by Newton's method."""
    phase = CONTEXT.mpf(guess)
    for _ in range(8):
        following, steepness = by_phase(belt, Slip(phase, -1))
        phase += (following.phase - 2 * CONTEXT.pi - phase) / (1 - steepness)
    return FixedSlip(phase, by_phase(belt, Slip(phase, -1))[1])


@cache
def _settled(static: str) -> FixedSlip:
    return _repeating(_exact_belt(static), "2.2")


@cache
def _at_limit() -> tuple[Any, FixedSlip]:
    """Return the static friction at which the multiplier is -1, and the slip, by secants."""
    limits = [CONTEXT.mpf("1.05"), CONTEXT.mpf("1.06")]
    misses = [_repeating(_belt(limit), "2.5").multiplier + 1 for limit in limits]
    while abs(limits[1] - limits[0]) > CONTEXT.mpf(10) ** -32:
        slope = (misses[1] - misses[0]) / (limits[1] - limits[0])
        limits = [limits[1], limits[1] - misses[1] / slope]
        misses = [misses[1], _repeating(_belt(limits[1]), "2.5").multiplier + 1]
    return limits[1], _repeating(_belt(limits[1]), "2.5")


def _returned(belt: Any, phase: Any) -> Any:
    """Return the phase of the next slip by Taylor series, less one period of the drive."""
    return next_by_series(belt, Slip(phase, -1)).phase - 2 * CONTEXT.pi


def _period_one() -> Items:
    """Return the items on the periodic motions of the example."""
    rows = []
    for static in SETTLED:
        belt = _exact_belt(static)
        fixed = _settled(static)
        rows.append(_row(f"${_shown(static)}$", belt, fixed))
    limit, fixed = _at_limit()
    return (
        r"\subsection{A driven mass that becomes chaotic}",
        r"Take the mass and the belt of Example~\ref{thm:return_maps-example}, $m = k = 1$, $c = "
        r"\frac{1}{20}$, $\Omega = \frac{7}{5}$, $B_0 = \frac{3}{5}$, with the speed "
        r"$\frac{1}{10}$ and kinetic friction $f = \frac{7}{10}$, and raise the static friction "
        r"$s$. For $s = f$ the law contracts. A fixed point $\theta^{*}$ of the map from slip to "
        r"slip is a motion with the period of the drive; its multipliers are 0 and",
        equation(
            named(r"\rho"),
            named(r"d\theta'/d\theta"),
            _multiplier_check(),
            "multiplier",
        ),
        r"Table~\ref{tab:chaos-fixed} has three that attract. The multiplier is $-1$ at",
        decimal("s", limit, DECIMALS, close(_limit_by_series, DECIMALS), label="limit"),
        r"beyond which this motion repels.",
        Table(
            "tab:chaos-fixed",
            r"Motions with the period of the drive: phase of the slip, multiplier, exponent per "
            r"slip.",
            ("$s$", r"$\theta^{*}$", r"$\rho$", r"$\ln|\rho|$"),
            (*rows, _row(r"\eqref{eq:chaos-limit}", _belt(limit), fixed)),
        ),
    )


def _shown(static: str) -> str:
    value = sp.Rational(static)
    return rf"\frac{{{value.p}}}{{{value.q}}}"


def _row(name: str, belt: Any, fixed: FixedSlip) -> tuple[Any, ...]:
    """Return a row of the table of motions with the period of the drive."""
    steepness = partial(_steepness, belt, fixed.phase)
    return (
        name,
        decimal(
            r"\theta^{*}",
            fixed.phase,
            DECIMALS,
            close(partial(_returned, belt, fixed.phase), DECIMALS),
        ),
        decimal(r"\rho", fixed.multiplier, DECIMALS, close(steepness, DECIMALS)),
        decimal(
            r"\ln|\rho|",
            CONTEXT.log(abs(fixed.multiplier)),
            DECIMALS,
            close(lambda: CONTEXT.log(abs(steepness())), DECIMALS),
        ),
    )


@cache
def _steepness(belt: Any, phase: Any) -> Any:
    """Return the derivative of the map by a difference of Taylor series."""
    return derivative_by_series(belt, Slip(phase, -1))


def _multiplier_check() -> Check:
    """Return the check that the line's factor and the phase's agree where the slip repeats."""

    def check(statement: Step) -> StepEvidence:
        belt = _exact_belt(SETTLED[1])
        phase = _settled(SETTLED[1]).phase
        names = {named(r"\rho"): next_slip(belt, Slip(phase, -1)).growth}
        names[named(r"d\theta'/d\theta")] = _steepness(belt, phase)
        return at_root(lambda: names, CONTEXT.mpf(10) ** -27)(statement)

    return check


@cache
def _limit_by_series() -> Any:
    """Return the static friction after one step of Newton's method with a multiplier from series."""
    limit, fixed = _at_limit()
    small = CONTEXT.mpf(10) ** -9
    beside = _repeating(_belt(limit + small), fixed.phase).multiplier
    slope = (beside - fixed.multiplier) / small
    by_series = _steepness(_belt(limit), fixed.phase)
    return limit - (by_series + 1) / slope


# --- a horseshoe ---


class Covering(NamedTuple):
    """An interval of phases whose image covers others: its ends, and minima before the slip."""

    name: str
    low: str
    high: str
    minima: int
    covers: str


#: The interval that all begins and ends in.
WHOLE = ("2.976", "3.192")
COVERINGS = (
    Covering("I", "2.976", "3.04", 0, "Q"),
    Covering("J", "3.152", "3.192", 0, "K"),
    Covering("K", "2.723", "2.771", 1, "L"),
    Covering("L", "2.125", "2.162", 1, "Q"),
)


def _ends(name: str) -> tuple[str, str]:
    if name == "Q":
        return WHOLE
    (row,) = [row for row in COVERINGS if row.name == name]
    return row.low, row.high


def _image(phase: str) -> Any:
    """Return the phase of the next slip modulo 2 pi, by closed forms."""
    return next_slip(_exact_belt(CHAOTIC), Slip(CONTEXT.mpf(phase), -1)).slip.phase % (
        2 * CONTEXT.pi
    )


def _image_by_series(phase: str) -> Any:
    """Return the same by Taylor series."""
    return next_by_series(_exact_belt(CHAOTIC), Slip(CONTEXT.mpf(phase), -1)).phase % (
        2 * CONTEXT.pi
    )


def _proven(row: Covering) -> Check:
    """Return the check by intervals that the map is continuous, and of the number of minima."""

    def check(statement: Step) -> StepEvidence:
        minima = statement.right
        exact = DRIVEN._replace(holding=sp.Rational(CHAOTIC))
        proven = (
            minima.is_Integer
            and minima >= 0
            and is_continuous(exact, row.low, row.high, int(minima))
        )
        if not proven:
            raise StepError(str(statement), "is not proven by intervals")
        return StepEvidence("sign", "by interval arithmetic")

    return check


def _covers(row: Covering) -> list[Step]:
    """Return the two inequalities by which the image of an interval covers another one."""
    below, above = _ends(row.covers)
    ends = (named(f"f({row.low})"), named(f"f({row.high})"))
    values = {ends[0]: _image(row.low), ends[1]: _image(row.high)}
    return [
        step(ends[0], ">", sp.Rational(above), at_root(lambda: values), decimals=True),
        step(ends[1], "<", sp.Rational(below), at_root(lambda: values), decimals=True),
    ]


def _horseshoe() -> Items:
    """Return the items on the proof of chaos."""
    rows = []
    for row in COVERINGS:
        images = [
            decimal(
                f"f({phase})",
                _image(phase),
                IMAGE_DECIMALS,
                close(partial(_image_by_series, phase), IMAGE_DECIMALS),
            )
            for phase in (row.low, row.high)
        ]
        minima = equation(named("n"), row.minima, _proven(row), f"map-{row.name}")
        interval = f"${row.name} = [{row.low}, {row.high}]$"
        rows.append((interval, *images, minima, f"${row.covers}$"))
    growth = named(r"\lambda^3")
    base = named(r"\lambda")
    words = named("N_n")
    value = _growth_rate()
    return (
        r"\begin{theorem}[chaos, proven]\label{thm:chaos-horseshoe} Let $s = \frac{63}{50}$, and "
        r"$f$ the map from the phase of a slip downward to that of the next slip, modulo $2\pi$. "
        r"With $Q = [2.976, 3.192]$ and the intervals of Table~\ref{tab:chaos-cover} $f$ is "
        r"continuous on $I$, $J$, $K$ and $L$, its slips are downward, and $f(I) \supset Q$, $f(J) "
        r"\supset K$, $f(K) \supset L$, $f(L) \supset Q$. Therefore\begin{enumerate}\item[(i)] for "
        r"each sequence of the two blocks $I$ and $J K L$ there is a motion whose slips follow it, "
        r"and a periodic one if the sequence is periodic;\item[(ii)] the topological entropy per "
        r"slip is at least $\ln\lambda$, where",
        equation(growth, base**2 + 1, _root_check(value), "growth"),
        decimal(r"\ln\lambda", CONTEXT.log(value), DECIMALS, close(_entropy_by_count, DECIMALS)),
        r"\item[(iii)] motions with different sequences of blocks are at some time more than "
        r"$0.11$ apart in the phase of their slips.",
        facts(
            step(
                sp.Rational("3.152") - sp.Rational("3.04"),
                ">",
                sp.Rational("0.11"),
                sign(),
                decimals=True,
            ),
        ),
        r"\end{enumerate}\end{theorem}",
        Table(
            "tab:chaos-cover",
            r"Intervals of phases, the images of both ends, how often the force that the next "
            r"stick needs is lowest before the slip, and the interval that the image covers.",
            ("interval", "image of its begin", "of its end", "$n$", "covers"),
            tuple(rows),
            tuple(part for row in COVERINGS for part in _covers(row)),
        ),
        r"\begin{proof} Interval arithmetic shows for all phases of each interval at once, in "
        r"cells that are halved as needed, that the flight falls at first, is below the belt then, "
        r"and rises until it is above: it returns once, with $\ddot{x} > 0$. It also shows that "
        r"the belt holds the mass there and that the needed force, which falls and rises as "
        r"$B_0\cos\theta - V\theta/\Omega$ does, stays within the limits at its next $n$ minima "
        r"and at the maxima between, and passes the lower limit before the minimum after them: it "
        r"slips there with $b > 0$. So $f$ is continuous, and the images of the ends show what it "
        r"covers. (i) A continuous map whose image of an interval $A$ covers an interval $B$ maps "
        r"a smaller one, in $A$, onto $B$. So there are nested intervals of phases that follow the "
        r"first blocks of a sequence, and a phase in all of them. A block that is repeated maps an "
        r"interval onto one that contains it, which gives a fixed point. (ii) Words of $n$ slips "
        r"end with $I$ or with $J K L$, so that for their number",
        equation(words, named("N_{n-1}") + named("N_{n-3}"), _recursion_check(), "words"),
        r"which grows like $\lambda^n$. (iii) Where two sequences differ for the first time, one "
        r"phase is in $I$ and the other in $J$.\end{proof}",
        r"A theorem about a set of motions does not say how a typical one moves. The motion that "
        r"slips at $\theta = 3$ has over 150 slips the mean of $\ln|d\theta'/d\theta|$ per slip, "
        r"and per unit of time,",
        decimal(
            r"\Lambda",
            _long_motion().per_slip,
            EXPONENT_DECIMALS,
            close(lambda: _twins().per_slip, EXPONENT_DECIMALS),
        ),
        decimal(
            r"\Lambda_1",
            _long_motion().per_time,
            EXPONENT_DECIMALS,
            close(lambda: _twins().per_time, EXPONENT_DECIMALS),
        ),
        r"which the distance of a twin confirms that begins $10^{-36}$ beside it. The sum "
        r"converges slowly; the sign does not change.",
    )


@cache
def _growth_rate() -> Any:
    """Return the root of the cubic equation by Newton's method."""
    value = CONTEXT.mpf("1.5")
    for _ in range(9):
        value -= (value**3 - value**2 - 1) / (3 * value**2 - 2 * value)
    return value


def _root_check(value: Any) -> Check:
    """Return the check that lambda is a root of the characteristic equation of the recursion."""
    base = named(r"\lambda")
    return at_root(lambda: {base: value, named(r"\lambda^3"): value**3})


def _words(length: int) -> int:
    """Return how many words of a length are made of blocks of one and of three slips, by listing them."""

    def words(left: int) -> list[str]:
        if left == 0:
            return [""]
        longer = [
            block + rest
            for block in ("I", "JKL")
            if len(block) <= left
            for rest in words(left - len(block))
        ]
        return longer

    return len(set(words(length)))


def _entropy_by_count() -> Any:
    """Return the logarithm of the growth of the number of words, by counting them."""
    counts = [1, 1, 1]
    while len(counts) < 200:
        counts.append(counts[-1] + counts[-3])
    return CONTEXT.log(CONTEXT.mpf(counts[-1]) / counts[-2])


def _recursion_check() -> Check:
    """Return the check of the recursion with all words of up to 14 slips."""

    def check(statement: Step) -> StepEvidence:
        for n in range(3, 15):
            meaning = {
                named("N_n"): _words(n),
                named("N_{n-1}"): _words(n - 1),
                named("N_{n-3}"): _words(n - 3),
            }
            left, right = (side.xreplace(meaning) for side in (statement.left, statement.right))
            if left != right:
                raise StepError(str(statement), f"is wrong for n = {n}: {left} and {right}")
        return StepEvidence("exact", "0")

    return check


class Rates(NamedTuple):
    """Exponents of a motion per slip and per unit of time."""

    per_slip: Any
    per_time: Any


def _rates(total: Any, begin: Any, end: Any) -> Rates:
    return Rates(total / LONG, total * number(DRIVEN.frequency) / (end - begin))


@cache
def _long_motion() -> Rates:
    """Return the exponents of the long motion by the derivatives of the map."""
    belt = _exact_belt(CHAOTIC)
    slip = Slip(CONTEXT.mpf(3), -1)
    total = CONTEXT.mpf(0)
    for _ in range(LONG):
        slip, steepness = by_phase(belt, slip)
        total += CONTEXT.log(abs(steepness))
    return _rates(total, CONTEXT.mpf(3), slip.phase)


@cache
def _twins() -> Rates:
    """Return the same by the distance of two motions."""
    belt = _exact_belt(CHAOTIC)
    slips = [Slip(CONTEXT.mpf(3) + part * APART, -1) for part in (0, 1)]
    for _ in range(LONG):
        slips = [next_slip(belt, slip).slip for slip in slips]
    first, second = slips
    total = CONTEXT.log(abs(second.phase - first.phase) / APART)
    return _rates(total, CONTEXT.mpf(3), first.phase)


def _in_a_band() -> Items:
    """Return the items on chaos without static excess."""
    exponent = named(r"\Lambda_1")
    return (
        r"\begin{example}[a band that grows]\label{thm:chaos-band} Static excess is not needed. "
        r"Let the friction of the same belt fall from $\frac{63}{50}$ at the relative speed 0 to "
        r"$\frac{7}{10}$ at $\frac{1}{10}$, and stay there, with $E = 0$. Two bands have a "
        r"negative damping, and over 60 periods of the drive \texttt{sensitivities} returns an "
        r"exponent with",
        step(exponent, ">", sp.Rational(1, 20), at_root(_band_exponent), "band"),
        r"while the second one is $-\infty$, since the mass sticks. This is a measurement, not a "
        r"proof.\end{example}",
    )


@cache
def _band_exponent() -> dict[Any, Any]:
    """Return the exponent of a long motion of the law without excess."""
    belt = Belt("1/10", curve=[(0, "63/50"), ("1/10", "7/10")])
    moving = Oscillator(m=1, c="1/20", k=1, B0="3/5", Omega="7/5", belts=[belt])
    found = sensitivities(moving, "x0", t0=0, x0=0, v0="1/10", t_end="60T")
    return {named(r"\Lambda_1"): CONTEXT.mpf(float(found.lyapunov[0]))}
