"""Check of Theorem 7 by numerics.

Three independent decisions whether a contact grazes, against the window.

A contact is built at each phase (x_m from F = 0). Whether the flow of the domain turns back there
is decided in three independent ways (`Ways`), each of which answers YES, NO or NOT_DECIDED, never
on less than its error:

- the signs of the G-functions: in double precision with a bound of the rounding error, or in
  50-digit intervals, where a value whose interval contains 0 counts as 0 only if that is known
  exactly;
- the exact flow a short time before and after the contact: both points must be in the domain;
- scipy's DOP853, on the same equation in coordinates that start at the contact.

Domain, belt and side of the contact are those of the definition of the map (`symosc.friction.MAPS`),
with which the window must agree: the ways take nothing from the window that they judge.

Some phases are random, in double precision. The others are adversarial, and exact: the ends of the
window, the points of equality and the quarters of the circle, and phases 1e-3 to 1e-14 before and
after each of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from itertools import product
from math import inf, pi
from typing import Any, NamedTuple

import numpy as np
from mpmath.ctx_iv import MPIntervalContext

from symosc.base.aliases import Expr, Number, Numbers, Progress, Record
from symosc.base.arguments import PROGRESS, TEXT, public, require
from symosc.base.display.progress import late_bar
from symosc.base.errors import ParameterError
from symosc.base.exact import whole_number
from symosc.base.phases import number_of, symbolic
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.flow import Constants, constant_force, constants
from symosc.friction import MAPS
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.kernels._generated import motion
from symosc.kernels.entire import EPS
from symosc.kernels.theorem7_cases import Place
from symosc.scenes import ParametersLike, parameters_for

CHECK_PHASES = 10_000
YES = 1
NO = -1
NOT_DECIDED = 0
FLOW_ROUNDING = 16.0  # rounding errors, in units of EPS and the size of the terms
INTERVAL_DIGITS = 50
# Digits of the exact flow at adversarial phases: a quartic tangency at the smallest time below
# needs 100 of them.
FLOW_DIGITS = 130
# Times before and after a contact, over the largest rate: in double precision, and two for the
# adversarial phases.
FLOW_TIME = 1e-9
FINE_FLOW_TIMES = ("1e-21", "1e-24")
# A gap in FLOW_DIGITS digits counts only if it exceeds 10^SPARE_DIGITS units of the last digit.
SPARE_DIGITS = 20
# Times over the largest rate at which DOP853 decides. What the long one leaves undecided, the short
# one may decide: its third-order term is small.
SOLVER_TIMES = (1e-2, 1e-13)
SOLVER_TOLERANCE = 1e-13
# What the scaled result of DOP853 may be wrong by (measured: 1e-15).
SOLVER_ERROR = 1e-13
# Decimal exponents of the distances of adversarial phases: 1e-3 to 1e-14.
DISTANCE_EXPONENTS = range(3, 15)
MOST_SHOWN_MISMATCHES = 20
#: The three ways, and why they leave a phase undecided.
G_SIGNS = "G-functions"
EXACT_FLOW = "exact flow"
DOP853 = "DOP853"
WHY_UNDECIDED = {
    G_SIGNS: "an interval contains 0",
    EXACT_FLOW: "the gap is 0 to all digits, or its sign depends on the time",
    DOP853: "the gap before or after is within the solver's error and the third-order term",
}


@dataclass(frozen=True)
class GrazingReport:
    """The results of `check_grazing`, which compares the window of Theorem 7 with three numerical
    ways of deciding.

    The ways are the signs of the G-functions, the exact flow around the contact, and the solver
    DOP853.

    Attributes
    ----------
    mapping, window, case : str
    n_random, n_adversarial : int
        Phases that were tried.
    n_grazing : int
        Those in the window.
    agreements : dict
        For each way of deciding, the number of phases at which it agrees with the window.
    undecided : dict
        For each way and reason, the number of phases that this way could not decide.
    mismatches : tuple of dict
        Every phase where a way contradicts the window, or where F is not 0 at the window's x_m.
        Each dict has the phase, the way, what the window says and what the way says.
    closest : dict
        For each way, the smallest |G^(1)| at a phase that it decided, over the sum of the sizes of
        the terms of G^(1).
    closest_phase : float
        The smallest distance of a decided phase from a phase with G^(1) = 0; distance 0 is not
        counted. inf where there is no such phase.
    orders : dict
        How many phases were decided by the G-function of each order.
    finely : int
        Phases that needed intervals.
    seconds : float
        How long the check took. Two reports that differ only in this are equal.

    Examples
    --------
    >>> from symosc import check_grazing, load_scene
    >>> report = check_grazing(load_scene("fig9").parameters, "P2", n=100)
    >>> report.case, report.n_random, report.mismatches
    ('(55.1)', 100, ())
    """

    mapping: str
    window: str
    case: str
    seed: int
    n_random: int
    n_adversarial: int
    n_grazing: int
    agreements: dict[str, int]
    undecided: dict[str, dict[str, int]]
    mismatches: tuple[dict[str, str], ...]
    closest: dict[str, float]
    closest_phase: float
    orders: dict[int, int]
    finely: int
    seconds: float = field(compare=False)

    @property
    def ok(self) -> bool:
        """Whether nothing contradicts the window, and G-functions and exact flow both decided every
        phase.
        """
        return (
            not self.mismatches and not self.undecided[G_SIGNS] and not self.undecided[EXACT_FLOW]
        )

    def to_dict(self) -> Record:
        """Return the report as a dict of plain values."""
        return {"ok": self.ok, **{name: getattr(self, name) for name in self.__dataclass_fields__}}

    def summary(self) -> str:
        """Return the report as text."""
        total = self.n_random + self.n_adversarial
        lines = [
            f"{self.mapping} {self.case}: {self.window}",
            f"{'ok' if self.ok else 'FAILED'}: {len(self.mismatches)} mismatches at {total} phases "
            f"({self.n_random} random, seed {self.seed}; {self.n_adversarial} adversarial); "
            f"{self.n_grazing} graze",
        ]
        for way in (G_SIGNS, EXACT_FLOW, DOP853):
            line = (
                f"  {way:11s} agrees at {self.agreements[way]}, down to |G1|/size = "
                f"{self.closest[way]:.1e}"
            )
            lines.append(
                line
                + "".join(f"; cannot decide {n}: {why}" for why, n in self.undecided[way].items())
            )
        orders = ", ".join(
            f"order {order}: {count}" for order, count in sorted(self.orders.items())
        )
        lines.append(
            f"  decided by {orders}; {self.finely} phases needed intervals; {self.seconds:.2f} s"
        )
        lines += [f"  mismatch: {mismatch}" for mismatch in self.mismatches[:MOST_SHOWN_MISMATCHES]]
        return "\n".join(lines)


@public
def check_grazing(
    p: ParametersLike,
    mapping: str,
    n: int = CHECK_PHASES,
    seed: int = 0,
    *,
    progress: Progress = False,
) -> GrazingReport:
    """Compare the grazing window of a mapping with three independent numerical decisions.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping : str
        "P2", "P3", "P5" or "P6".
    n : int
        The number of random phases, at most a million; some hundred adversarial ones come on top.
    seed : int
        The seed of the random phases.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a
        function of two numbers: the part that is done, and 1.

    Raises
    ------
    ParameterError
        For a mapping without grazing, an n or a seed out of range, and where there is no isolated
        contact to check: k = 0 (F = 0 fixes the phase), or B0 = 0 with v_lambda = 0 (the flow stays
        on the belt for ever).

    Examples
    --------
    >>> from symosc import check_grazing, load_scene
    >>> check_grazing(load_scene("fig9").parameters, "P2", n=100).ok
    True
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(*PROGRESS, progress=progress)
    n = whole_number("n", n, 1, 1_000_000)
    seed = whole_number("seed", seed, 0, 2**63 - 1)
    begin = time.perf_counter()
    window = grazing_window(p, mapping)
    if p.k == 0:
        raise ParameterError(
            "k", p.k, "must be > 0 here: without a spring F = 0 fixes the phase, there is no x_m"
        )
    ways = Ways(window)
    if p.B0 == 0 and ways.speed == 0:
        raise ParameterError(
            "B0",
            p.B0,
            "must not be 0 if v_lambda is 0, because the flow then never leaves the belt",
        )
    theta = np.random.default_rng(seed).uniform(0.0, 2 * pi, n)
    mismatches = list[dict[str, str]]()
    parts = []
    done = 0  # random phases

    def disagree(phase: object, way: str, expected: str, seen: str) -> None:
        """Add a mismatch of a way with the window, which expects something else than is seen."""
        mismatches.append({"theta": str(phase), "way": way, "window": expected, "found": seen})

    of_window = place_text(window.place)
    of_map = place_text(ways.place)
    if of_window != of_map:
        disagree("all", f"definition of {mapping}", of_window, of_map)
    with late_bar(progress, f"check {mapping}", "phases") as advance:
        for chunk in np.array_split(theta, range(CHECK_PHASES, n, CHECK_PHASES)):
            parts.append(_decide_random(ways, chunk, disagree))
            done += len(chunk)
            if advance:
                advance(done / n, done)
        parts.append(_decide_special(ways))
    d = Decisions(*map(np.concatenate, zip(*parts, strict=True)))
    counts = _counted_by_way(d, disagree)
    distances = d.offset[(d.by_sign != NOT_DECIDED) & (d.by_flow != NOT_DECIDED)]
    return GrazingReport(
        mapping=mapping,
        window=repr(window),
        case=window.case,
        seed=seed,
        n_random=n,
        n_adversarial=len(d.phase) - n,
        n_grazing=int(d.inside.sum()),
        agreements=counts.agreements,
        undecided=counts.undecided,
        mismatches=tuple(mismatches),
        closest=counts.closest,
        closest_phase=float(distances.min(initial=inf)),
        orders={order: int((d.order == order).sum()) for order in (1, 2, 3) if order in d.order},
        finely=int(d.finely.sum()),
        seconds=time.perf_counter() - begin,
    )


class WayCounts(NamedTuple):
    """How each way decides, as in `GrazingReport`: agreements, undecided phases by reason, and the
    smallest |G^(1)| over its size that it decides.
    """

    agreements: dict[str, int]
    undecided: dict[str, dict[str, int]]
    closest: dict[str, float]


def _counted_by_way(d: Decisions, disagree: Callable[..., None]) -> WayCounts:
    """Count how each way decides; call `disagree` for each phase at which one contradicts the
    window.
    """
    counts = WayCounts({}, {}, {})
    words = ("does not graze", "grazes")
    verdicts = (d.by_sign, d.by_flow, d.by_solver)
    for (way, why), verdict in zip(WHY_UNDECIDED.items(), verdicts, strict=True):
        decided = verdict != NOT_DECIDED
        right = decided & ((verdict == YES) == d.inside)
        counts.agreements[way] = int(right.sum())
        counts.undecided[way] = {} if decided.all() else {why: int((~decided).sum())}
        counts.closest[way] = float(d.margin[right & (d.margin > 0)].min(initial=inf))
        for j in np.flatnonzero(decided & ~right):
            disagree(d.phase[j], way, words[int(d.inside[j])], words[int(verdict[j] == YES)])
    return counts


def place_text(place: Place) -> str:
    """Return where a contact is, such as "domain 1 at belt 1 from below"."""
    if place.side > 0:
        direction = "from below"
    else:
        direction = "from above"
    return f"domain {place.domain} at belt {place.boundary} {direction}"


class Decisions(NamedTuple):
    """What is known of some phases, in columns.

    The phase, whether it is in the window, |G^(1)| over its size, its distance from a phase with
    G^(1) = 0 (inf: not known), whether it took intervals, the order that decides (0: none), and the
    verdicts of the three ways.
    """

    phase: np.ndarray
    inside: np.ndarray
    margin: np.ndarray
    offset: np.ndarray
    finely: np.ndarray
    order: np.ndarray
    by_sign: np.ndarray
    by_flow: np.ndarray
    by_solver: np.ndarray


def _decide_random(ways: Ways, theta: np.ndarray, disagree: Callable[..., None]) -> Decisions:
    """Decide by all three ways which random phases graze.

    `disagree` is called where F is not 0.
    """
    inside = ways.window.contains(theta)
    K = ways.K
    if inside.any():  # F must vanish at the window's x_m
        drive = K.f0 * np.cos(theta[inside])
        spring = -K.w0sq * ways.window.contact(theta[inside])
        terms = [constant_force(ways.place.domain, K), drive, spring, -K.cm * ways.v]
        F = sum(terms)
        size = sum(map(abs, terms))
        for i in np.flatnonzero(np.abs(F) > FLOW_ROUNDING * EPS * size):
            disagree(theta[inside][i], "contact", "F = 0", f"F = {F[i]}")
    signs = ways.verdicts_by_sign(theta)
    flow = ways.verdicts_by_flow(theta)
    orders = np.ones(len(theta), dtype=int)
    finely = (signs == NOT_DECIDED) | (flow == NOT_DECIDED)
    for i in np.flatnonzero(finely):
        value = ways.fine.context.mpf(float(theta[i]))
        (signs[i], orders[i]) = ways.verdict_by_intervals(value, False)
        flow[i] = ways.verdict_by_fine_flow(value)
    return Decisions(
        phase=theta.astype(object),
        inside=inside,
        margin=np.abs(ways.slope(theta)),
        offset=np.full(len(theta), inf),
        finely=finely,
        order=orders,
        by_sign=signs,
        by_flow=flow,
        by_solver=ways.verdicts_by_solver(theta),
    )


def _decide_special(ways: Ways) -> Decisions:
    """Decide, as `_decide_random` does, which phases at and beside zeros of G^(1) and multiples of
    pi/2 graze.
    """
    import sympy

    zeros = _exact_zeros(ways)
    quarters = {sympy.Integer(0), sympy.pi / 2, sympy.pi, 3 * sympy.pi / 2}
    special = sorted(zeros | quarters, key=float)
    offsets = [Fraction(0)]
    offsets += [Fraction(sign, 10**k) for k in DISTANCE_EXPONENTS for sign in (1, -1)]
    numbers = {base: ways.fine.context.mpf(str(base.evalf(FLOW_DIGITS + 10))) for base in special}
    rows = []
    for base, offset in product(special, offsets):
        phase = base + symbolic(offset)
        zero = offset == 0 and base in zeros
        value = numbers[base] + ways.fine.number(offset)
        by_sign, order = ways.verdict_by_intervals(value, zero)
        by_flow = ways.verdict_by_fine_flow(value)
        if base in zeros and offset:
            away = float(abs(offset))
        else:
            away = inf
        if zero:
            margin = 0.0
        else:
            margin = abs(ways.slope(value))
        inside = bool(ways.window.contains(phase))
        rows.append((phase, inside, margin, away, True, order, by_sign, by_flow, float(value)))
    phases, are_inside, margins, distances, finely, orders, signs, flow, floats = zip(
        *rows, strict=True
    )
    exact_phases = np.empty(len(phases), dtype=object)  # or numpy would convert them
    exact_phases[:] = phases
    return Decisions(
        phase=exact_phases,
        inside=np.array(are_inside),
        margin=np.array(margins),
        offset=np.array(distances),
        finely=np.array(finely),
        order=np.array(orders),
        by_sign=np.array(signs),
        by_flow=np.array(flow),
        by_solver=ways.verdicts_by_solver(np.array(floats)),
    )


def _exact_zeros(ways: Ways) -> set[Expr]:
    """Return the phases in [0, 2 pi) at which G^(1) = 0 exactly."""
    import sympy

    if not ways.amplitude or abs(ways.gamma) > abs(ways.amplitude):
        return set()
    angle = sympy.asin(symbolic(-ways.gamma / ways.amplitude))
    ends = (angle, sympy.pi - angle)
    return {end + 2 * sympy.pi if end.is_negative else end for end in ends}


class Ways:
    """The three ways to decide whether a contact at a phase grazes: G-functions, exact flow, and
    DOP853.
    """

    # They use the parameters and the map of the window, but neither its place nor its phases.

    def __init__(self, window: GrazingWindow) -> None:
        self.window = window
        self.p = window.parameters
        row = MAPS[window.mapping]
        self.place = Place(row.domain, row.end.boundary, row.side, window.place.equation)
        self.side = row.side
        self.speed = self.p.belt(row.end.boundary)
        self.gamma = self.p.k * self.speed / self.p.m
        self.amplitude = self.p.B0 * self.p.Omega / self.p.m
        self.K: Constants = constants(self.p)
        self.fine = MpArithmetic(self.p, FLOW_DIGITS)
        self.v = float(self.speed)
        self.v_fine = self.fine.number(self.speed)
        self.size = abs(self.K.w0sq * self.v) + abs(self.K.fB)
        context = self.fine.context
        basis = self.fine.namespace["basis"]
        times = [
            sign * context.mpf(tau) / self.fine.K.rate
            for tau in FINE_FLOW_TIMES
            for sign in (-1, 1)
        ]
        self._fine_bases = [basis(tau, self.fine.K)[:5] for tau in times]
        self._intervals = MPIntervalContext()
        self._intervals.dps = INTERVAL_DIGITS

    # -- G-functions -------------------------------------------------------------------------------

    def slope(self, theta: Numbers) -> Any:
        """Return G^(1), scaled by the sizes of its terms and with the sign that makes it positive
        for a graze.
        """
        if isinstance(theta, np.ndarray):
            return self.side * (self.K.w0sq * self.v + self.K.fB * np.sin(theta)) / self.size
        slope = self.fine.K.w0sq * self.v_fine + self.fine.K.fB * self.fine.context.sin(theta)
        return self.side * float(slope) / self.size

    def verdicts_by_sign(self, theta: np.ndarray) -> np.ndarray:
        """Return by the sign of G^(1), in doubles, whether each phase grazes: YES, NO or
        NOT_DECIDED.
        """
        slope = self.slope(theta)
        decided = np.abs(slope) > FLOW_ROUNDING * EPS
        return np.where(decided, np.where(slope > 0, YES, NO), NOT_DECIDED)

    def verdict_by_intervals(self, theta: Number, zero: bool) -> tuple[int, int]:
        """Return the verdict by the first G-function that is not 0, in 50-digit intervals, and the
        order of this function (0 if the verdict is NOT_DECIDED).

        `zero` tells that G^(1) is exactly 0 at theta.
        """
        # F = 0 at the contact, so G^(1) = -(k v + B0 Omega sin)/m. Where that is 0, G^(2) = -(B0
        # Omega/m) Omega cos decides. It is 0 too iff |k v| = |B0| Omega; then the next one decides.
        iv = self._intervals
        p = self.p
        interval = partial(number_of, context=self._intervals)
        context = self.fine.context
        # Decimals just below and above theta are the ends of its interval.
        shift = context.mpf(10) ** (-INTERVAL_DIGITS - 5) * max(1, abs(theta))
        angle = iv.mpf(
            [context.nstr(theta + sign * shift, INTERVAL_DIGITS + 15) for sign in (-1, 1)]
        )
        s = iv.sin(angle)
        c = iv.cos(angle)
        Om = interval(p.Omega)
        drive = interval(p.B0 * p.Omega / p.m)
        values = [
            -(interval(self.gamma) + drive * s),
            -drive * Om * c,
            drive * Om * Om * s,
        ]
        known_zero = [zero, zero and abs(self.gamma) == abs(self.amplitude), False]
        for order, (G, is_zero) in enumerate(zip(values, known_zero, strict=True), start=1):
            # An interval with 0 that is not known to be 0 is undecided; one without 0 contradicts a
            # known zero.
            if is_zero == (0 not in G):
                break
            if not is_zero:
                # The whole interval has the sign of its lower end. Only an odd order turns back.
                leads_back = bool(-self.side * G.a > 0)
                verdict = YES if order % 2 == 1 and leads_back else NO
                return verdict, order
        return NOT_DECIDED, 0

    # -- the exact flow ----------------------------------------------------------------------------

    def verdicts_by_flow(self, theta: np.ndarray) -> np.ndarray:
        """Decide which phases graze by the exact flow shortly before and after; NOT_DECIDED where
        the gap is too small.
        """
        tau = FLOW_TIME / self.K.rate
        # The basis in many digits, rounded: only the rounding of the gap itself is left.
        basis = self.fine.namespace["basis"]
        convert = self.fine.context.convert
        bases = [
            [float(value) for value in basis(convert(at), self.fine.K)[:5]] for at in (-tau, tau)
        ]
        s = np.sin(theta)
        c = np.cos(theta)
        before, after = (self._velocity_gap(basis_at, s, c, self.v, self.K) for basis_at in bases)
        least = (FLOW_ROUNDING * EPS * self.size + self._third_order_bound(tau)) * tau**2
        return _verdicts(before, after, least)

    def verdict_by_fine_flow(self, theta: Number) -> int:
        """Decide whether theta grazes by the flow in many digits; NOT_DECIDED if the verdicts at two
        distances differ.
        """
        context = self.fine.context
        s = context.sin(theta)
        c = context.cos(theta)
        gaps = [
            self._velocity_gap(basis, s, c, self.v_fine, self.fine.K) for basis in self._fine_bases
        ]
        least = self.size * context.mpf(10) ** (SPARE_DIGITS - FLOW_DIGITS)
        for gap, (_, _, E2, _, _) in zip(gaps, self._fine_bases, strict=True):
            if abs(gap) <= least * abs(E2):
                return NOT_DECIDED
        # In the order of `_fine_bases`: before and after the contact, at the first time, then at the
        # second.
        before_1, after_1, before_2, after_2 = (gap > 0 for gap in gaps)
        grazes_1 = before_1 and after_1
        grazes_2 = before_2 and after_2
        if grazes_1 != grazes_2:
            return NOT_DECIDED
        return YES if grazes_1 else NO

    def _velocity_gap(
        self, basis: Sequence[Numbers], s: Numbers, c: Numbers, v: Number, K: Constants
    ) -> Any:
        """Return the distance of v from the belt's speed (> 0: in the domain) at the time tau that
        `basis` is for.
        """
        _, dv, _ = motion(v, 0.0 * v, s, c, K.cm, K.w0sq, K.f0, K.Om, *basis)
        return -self.side * dv

    def _third_order_bound(self, tau: float) -> float:
        """Return a bound of the terms of order tau^3 and higher in the velocity gap at the time tau,
        divided by tau^2.
        """
        K = self.K
        jerk = abs(K.fB) * K.Om + K.cm * self.size + K.w0sq * self.size * tau
        return jerk * tau / 3.0

    # -- DOP853 ------------------------------------------------------------------------------------

    def verdicts_by_solver(self, theta: np.ndarray) -> np.ndarray:
        """Decide which phases graze by DOP853, run for all at once; NOT_DECIDED where the gap is
        within its error.
        """
        verdicts = np.zeros(len(theta), dtype=int)
        for time_over_rate in SOLVER_TIMES:
            left = np.flatnonzero(verdicts == NOT_DECIDED)
            if len(left):
                tau = time_over_rate / self.K.rate
                before = self.gap_by_solver(theta[left], -tau)
                after = self.gap_by_solver(theta[left], tau)
                least = SOLVER_ERROR + self._third_order_bound(tau) / self.size
                verdicts[left] = _verdicts(before, after, least)
        return verdicts

    def gap_by_solver(self, theta: np.ndarray, tau: float) -> np.ndarray:
        """Return v's distance from the belt's speed at the time tau by DOP853, over size tau^2 (>
        0: in the domain).
        """
        # The unknowns are y = (x - x_m)/tau and u = (v - v_lambda)/(size tau^2), as functions of
        # time/tau. The force is the difference from its value 0 at the contact, where a difference
        # of cosines is written as a product.
        from scipy.integrate import solve_ivp

        K = self.K
        n = len(theta)

        def rhs(sigma: float, state: np.ndarray) -> np.ndarray:
            """Return the derivatives of y and u of all phases by sigma = time/tau."""
            y = state[:n]
            u = state[n:] * (self.size * tau * tau)
            half = 0.5 * K.Om * tau * sigma
            force = -2.0 * K.f0 * np.sin(theta + half) * np.sin(half) - K.w0sq * tau * y - K.cm * u
            return np.concatenate([self.v + u, force / (self.size * tau)])

        done = solve_ivp(
            rhs,
            (0.0, 1.0),
            np.zeros(2 * n),
            method="DOP853",
            rtol=SOLVER_TOLERANCE,
            atol=SOLVER_TOLERANCE,
            max_step=0.25,
        )
        return -self.side * done.y[n:, -1]


def _verdicts(before: np.ndarray, after: np.ndarray, least: float) -> np.ndarray:
    """Return YES where the gaps before and after contact are both > 0, else NO; NOT_DECIDED where
    one is within `least`.
    """
    decided = (np.abs(before) > least) & (np.abs(after) > least)
    grazes = (before > 0) & (after > 0)
    return np.where(decided, np.where(grazes, YES, NO), NOT_DECIDED)
