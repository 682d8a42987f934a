"""Solve the grazing conditions, equations (54) with F = 0 at the end of the map, for one given
unknown.

Three equations and an inequality have four unknowns (x_i, Omega t_i, x_j, Omega t_j), the start of
a map and its end, which is the tangency. A given theta_j or x_j fixes the tangency in closed form.
For x_i or Omega t_i the samples of the grazing curve show between which neighbours the value lies,
on both sides of an extremum between them too. There Newton's method solves v(theta_m, tau) =
v_lambda with the value's equation for theta_m and tau, the time of the flight. A solution counts if
it lies between its neighbours in both; otherwise the stretch is halved. Then the flow back from
that tangency is computed anew.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import pairwise
from math import pi
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Angle, Number, NumberLike, Progress
from symosc.base.arguments import NUMBER, PROGRESS, TEXT, public, require
from symosc.base.display.latex import LatexAnswer, latex_number, latex_table, latex_words
from symosc.base.errors import ParameterError
from symosc.base.exact import read_digits, read_exact, whole_number
from symosc.base.phases import number_of, read_phase, reduced, symbolic, times
from symosc.engine.arithmetic import mp_context
from symosc.grazing import curve as curves
from symosc.grazing.backward import SEARCH_PERIODS, TOUCH, Flights, Instant
from symosc.grazing.curve import (
    CURVE_POINTS,
    OWN,
    CurveEnd,
    CurvePiece,
    GrazingCurve,
    Sample,
    grazing_curve,
)
from symosc.grazing.start import (
    DEFAULT_DIGITS,
    MOST_START_DIGITS,
    GrazingStart,
    grazing_start,
    start_of,
)
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.kernels.elementary import cos
from symosc.model import Parameters
from symosc.scenes import ParametersLike, parameters_for

UNKNOWNS = ("x_i", "theta_i", "x_j", "theta_j", "theta_m")
MOST_NOTES = 3
MOST_CURVE_NEWTON = 20
NEWTON_HALVINGS = 60
SAME_ROOT = 1e-30  # solutions nearer to each other than this are one
# A start must have the value asked for to so many units of the last digit; it is computed with so
# many digits more than wanted, so that the comparison loses none of them.
ALLOWED_UNITS = 100
SPARE_DIGITS = 30
# With so many digits more than wanted slopes up to 1e15 can be distinguished from a jump in doubles.
SEARCH_DIGITS = 40
# Beside an end of the curve the unknown may change by so many times what the slope at the outermost
# point says, as the slope may grow towards the end.
STEEPER_AT_END = 4
# A piece of the curve ends with a contact of no duration if its outermost flight takes less than so
# many times the phase that is left.
SHORT_FLIGHT = 10
# Newton's method has left its solution where theta_m changes by more than this in one step: more
# than a turn.
MOST_TURN = 7
# Rounding of a value on the curve and of its extrema, as a part of it; how near to an extremum
# halving leads.
ROUNDED_VALUE = 1e-9
ROUNDED_EXTREMUM = 1e-12
AT_EXTREMUM = 1e-15
# A solution between two samples may lie outside of them by rounding of theta_m; in time by rounding
# and by a part of how much the times differ, as the flight time need not be monotone.
ROUNDED_THETA = 1e-14
ROUNDED_TIME = 1e-9
BEYOND_TIMES = 0.1
# A time over the largest rate by which a flight next to an end of the curve may be longer.
SHORT_TIME = 1e-3
# A curve rises by more than this from its outermost sample, by the slope there, only if it goes on
# for ever.
LEAST_ENDLESS_RISE = 1e-4


class GrazingSolutions(list[GrazingStart], LatexAnswer):
    """Solutions of the grazing conditions in order of theta_m: a list with notes on omitted ones.

    Attributes
    ----------
    complete : bool
        Whether the search left nothing out that it met. Even then it may not see solutions that lie
        nearer to each other than the samples of the curve.
    message : str
        Why there is no solution, or what was left out; "" if there is nothing to say.

    Examples
    --------
    >>> from symosc import load_scene, solve_grazing
    >>> solutions = solve_grazing(load_scene("fig9").parameters, "P2", x_i=100)
    >>> len(solutions), solutions.message
    (0, 'x_i goes over 3.65106 to 11.2811 on the grazing curve')
    """

    def __init__(
        self, starts: Iterable[GrazingStart] = (), complete: bool = True, message: str = ""
    ) -> None:
        super().__init__(starts)
        self.complete = complete
        self.message = message

    def latex(self) -> str:
        """Return the solutions as a table in LaTeX (an array, no dollar signs).

        The message if there is none.
        """
        if not self:
            return latex_words(self.message)
        rows = [
            [latex_number(number) for number in (start.theta, start.x, start.theta_m, start.x_m)]
            for start in self
        ]
        return latex_table((r"\Omega t_i", "x_i", r"\Omega t_m", "x_m"), rows)


@public
def solve_grazing(
    p: ParametersLike,
    mapping: str,
    *,
    n: int = CURVE_POINTS,
    digits: int | None = None,
    progress: Progress = False,
    **given: NumberLike,
) -> GrazingSolutions:
    """Solve the grazing conditions of a mapping with one of the unknowns given.

    The map leads from (x_i, theta_i) to the tangency (x_j, theta_j), theta = Omega t mod 2 pi;
    theta_j is theta_m.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping : str
        "P2", "P3", "P5" or "P6".
    n : int
        The number of samples of the curve for x_i and theta_i, as for `grazing_curve`.
    digits : int, optional
        Correct digits of the results; None: floats.
    progress : optional, as for `grazing_curve`
    **given : number
        Exactly one of x_i, theta_i, x_j, theta_j, theta_m.

    Returns
    -------
    GrazingSolutions
        A list of GrazingStart, in order of theta_m, with `complete` and `message`. Each start has
        the value asked for in all its digits. Where a curve runs to minus infinity, theta_i has
        infinitely many solutions, which gather at its end. Listed are those whose theta_m differs
        from the end in double precision.

    Raises
    ------
    ParameterError
        If not exactly one unknown is given, the mapping has no grazing, k = 0, or the unknown does
        not fix the tangency: x_i or x_j with B0 = 0.

    Examples
    --------
    >>> from symosc import load_scene, solve_grazing
    >>> [start] = solve_grazing(load_scene("fig9").parameters, "P2", x_i=4)
    >>> f"{start.theta:.6f}", f"{start.theta_m:.6f}"
    ('5.085819', '0.612081')
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(*PROGRESS, progress=progress)
    require(NUMBER, **given)
    window = grazing_window(p, mapping)
    if len(given) != 1 or next(iter(given)) not in UNKNOWNS:
        raise ParameterError(
            "given", ", ".join(given) or None, f"must be exactly one of {', '.join(UNKNOWNS)}"
        )
    ((name, value),) = given.items()
    if p.k == 0:
        raise ParameterError(
            "k", p.k, "must be > 0 here: without a spring F = 0 fixes the phase, not the contact"
        )
    if p.B0 == 0 and name in ("x_i", "x_j"):
        raise ParameterError(
            name, value, "B0 = 0: all starts have one x, which does not fix the phase"
        )
    whole_number("n", n, curves.LEAST_CURVE_POINTS, curves.MOST_CURVE_POINTS)
    read_digits(digits, MOST_START_DIGITS)
    if name in ("x_i", "x_j"):
        exact = read_exact(name, value)
    else:
        exact = read_phase(name, value)
    if name in ("x_i", "theta_i"):
        curve = grazing_curve(p, mapping, n, progress=progress)
        candidates = Candidates(curve, name, exact, digits or DEFAULT_DIGITS)
        solutions, notes = _confirmed(candidates, curve, window, digits)
        complete = not notes
        if not solutions and complete:
            notes = [candidates.why_none()]
    else:
        starts, notes = _from_contacts(window, name, exact, digits)
        solutions = [start for start in starts if start.found]
        complete = not any(start.undecided for start in starts)
    solutions.sort(key=lambda start: float(start.theta_m))
    if solutions or window.kind:
        message = "; ".join(notes)
    else:
        message = "the grazing window is empty"
    return GrazingSolutions(solutions, complete, message)


def _confirmed(
    candidates: Candidates,
    curve: curves.GrazingCurve,
    window: GrazingWindow,
    digits: int | None,
) -> tuple[list[GrazingStart], list[str]]:
    """Return the candidates on a curve that are grazing motions, and notes about what is left open."""
    p = window.parameters
    notes = candidates.notes
    solutions = []
    for phase in filter(window.contains, candidates.phases):
        start = start_of(curve._source, times(phase, 1 / p.Omega), phase, digits=digits)
        value = candidates.value
        if start.found and _has_value(start, p, candidates.name, value, digits or DEFAULT_DIGITS):
            solutions.append(start)
        else:
            notes.append(f"near theta_m = {float(phase):.12g} a solution could not be confirmed")
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [f"and {len(notes) - MOST_NOTES} more such places"]
    return solutions, notes


def _from_contacts(
    window: GrazingWindow, name: str, exact: Any, digits: int | None
) -> tuple[list[GrazingStart], list[str]]:
    """Return the starts of motions whose contact has the value `exact` of x_j, theta_j or theta_m,
    whether they are found or not, and notes about those that are not.
    """
    if name == "x_j":
        phases = _phases_of_contact(window, exact)
    else:
        phases = [reduced(exact)]
    starts = [
        grazing_start(window.parameters, window.mapping, phase, digits=digits)
        for phase in phases
        if window.contains(phase)
    ]
    if not starts:
        return [], [f"no tangency in the grazing window has this value: {window!r}"]
    notes = [
        f"theta_m = {float(start.theta_m):.12g}: {start.reason}"
        for start in starts
        if not start.found
    ]
    return starts, notes


def _phases_of_contact(window: GrazingWindow, value: Fraction) -> list[Angle]:
    """Return exactly the phases theta at which the contact position x_m(theta) is `value`."""
    import sympy

    p = window.parameters
    cosine = (p.k * value + p.c * window.speed - p.A(window.place.domain)) / p.B0
    if abs(cosine) > 1:
        return []
    theta = sympy.acos(symbolic(cosine))
    if abs(cosine) == 1:
        return [theta]
    return [theta, 2 * sympy.pi - theta]


def _has_value(start: GrazingStart, p: Parameters, name: str, value: Any, digits: int) -> bool:
    """Return whether the unknown `name` (x_i or theta_i) of a start is `value`, to ALLOWED_UNITS
    units of the last digit.
    """
    context = mp_context(digits + SPARE_DIGITS)
    if name == "x_i":
        gap = number_of(Fraction(start.start["x0"]) - value, context)
        size = abs(float(value))
    else:
        angle = number_of(Fraction(start.start["t0"]) * p.Omega, context)
        turns = (angle - number_of(value, context)) / (2 * context.pi)
        gap = (turns - context.nint(turns)) * 2 * context.pi
        # An error of t0 is one of the angle Omega t0, Omega times as large.
        size = max(float(p.Omega), abs(float(value)))
    last_digit = context.mpf(10) ** -digits
    return bool(abs(gap) <= ALLOWED_UNITS * last_digit * max(1.0, size))


# --- the grazing curve at a value ---


class Point(NamedTuple):
    """A point of the grazing curve: phase theta_m, x_i or theta_i, its derivative by theta_m, and
    flight time tau.
    """

    theta_m: float
    value: float
    slope: float
    tau: float


class CurveRoot(NamedTuple):
    """A solution on the grazing curve: phase theta_m, and flight time tau."""

    theta: Number
    tau: Number


class Residual(NamedTuple):
    """By how much the unknown at the start of a flight misses its value, with the derivatives by
    theta_m and by the flight time tau.
    """

    value: Number
    by_theta: Number
    by_tau: Number


class Candidates:
    """A search for solutions on a grazing curve: `phases` collects their theta_m, `notes` says what
    was omitted.
    """

    def __init__(self, curve: GrazingCurve, name: str, value: Number, digits: int) -> None:
        self.curve = curve
        self.source = curve._source
        self.name = name
        self.value = value
        self.K = curve._source.K
        self.flights: Flights = self.source.flights(digits + SEARCH_DIGITS)
        self.target = self.flights.number(value)
        self.notes: list[str] = []
        self._broken: set[Point] = set()
        self._solutions: list[CurveRoot] = []
        for piece in curve.pieces:
            self._on_piece(piece)
        for low, high, origin in curve.gaps:
            if origin == curves.UNKNOWN:
                self.notes.append(
                    f"for theta_m in ({low:.6g}, {high:.6g}) the flights are longer than the search"
                )
        self.phases = [read_exact("theta_m", theta) for theta, _ in self._solutions]

    def why_none(self) -> str:
        """Return the reason why there is no solution."""
        if not self.curve.pieces:
            gaps = (
                f"({low:.6g}, {high:.6g}) the flow comes from {origin}"
                for low, high, origin in self.curve.gaps
            )
            return "no flow from the mapping's belt grazes: " + "; ".join(
                f"for theta_m in {gap}" for gap in gaps
            )
        spans = [piece.x if self.name == "x_i" else piece.theta for piece in self.curve.pieces]
        reach = ", ".join(f"{values.min():.6g} to {values.max():.6g}" for values in spans)
        if self.name == "theta_i":
            unwrapped = " (not reduced mod 2 pi)"
        else:
            unwrapped = ""
        return f"{self.name} goes over {reach} on the grazing curve{unwrapped}"

    # -- stretches between samples -----------------------------------------------------------------

    def _on_piece(self, piece: CurvePiece) -> None:
        """Find the solutions on a piece of the curve and store them."""
        points = self._points(piece)
        values = np.array([point.value for point in points])
        self._extrema = dict[Point, Point | None]()  # of this piece, by the point before
        # Each end of the curve, and the outermost point there.
        ends = ((piece.low, points[0]), (piece.high, points[-1]))
        targets = [self.target]
        if self.name == "theta_i":  # all values that differ by whole turns, and one beyond
            turn = 2 * self.flights.context.pi
            reach = (values.min() - 1e-3, values.max() + 1e-3)  # the ends are a bit beyond
            low, high = (int(np.floor((end - float(self.target)) / (2 * pi))) for end in reach)
            targets = [self.target + j * turn for j in range(low, high + 2)]
        for target in targets:
            for end, point in ends:
                self._beside_end(end, point, target)
            for first, last in pairwise(points):
                self._on_stretch(first, last, target)
        for index, (end, point) in zip((0, -1), ends, strict=True):
            self._note_endless(end, point, index, piece)

    def _beside_end(self, end: CurveEnd, point: Point, target: Number) -> None:
        """Store the solution between the outermost point and the end of the curve, if there is
        one.
        """
        gap = abs(end.theta_m - point.theta_m)
        rounding = ROUNDED_VALUE * max(1.0, abs(point.value))
        reachable = STEEPER_AT_END * abs(point.slope) * gap + rounding
        if gap > 0 and abs(float(target) - point.value) <= reachable:
            solution = self._newton(point.theta_m, point.tau, target)
            self._store_if_between(solution, point, point, gap)

    def _on_stretch(self, first: Point, last: Point, target: Number) -> None:
        """Store the solutions between two neighbouring points: where the unknown passes the target,
        or has it as an extreme value.
        """
        wanted = float(target)
        turning = None
        if first.slope * last.slope < 0:  # an extremum between them may reach the value
            steepest = max(abs(first.slope), abs(last.slope))
            largest_change = steepest * (last.theta_m - first.theta_m)
            nearest = min(abs(first.value - wanted), abs(last.value - wanted))
            if nearest <= largest_change:
                if first not in self._extrema:
                    self._extrema[first] = self._extremum(first, last)
                turning = self._extrema[first]
        if turning is None:
            passed = [first, last]
        else:
            passed = [first, turning, last]
        crosses = False
        for before, after in pairwise(passed):
            if (before.value >= wanted) != (after.value >= wanted):
                crosses = True
                self._between(before, after, target)
        if turning is None or crosses:
            return
        # The extremum itself may have the value, as far as doubles can tell.
        if abs(turning.value - wanted) <= ROUNDED_EXTREMUM * max(1.0, abs(turning.value)):
            solution = self._newton(turning.theta_m, turning.tau, target)
            self._store_if_between(solution, first, last)

    def _points(self, piece: CurvePiece) -> list[Point]:
        """Return a piece's samples as points, and the end of the piece too if the flights become
        infinitely short there.
        """
        columns: Any = self._point_of(piece)
        points = [Point(*map(float, row)) for row in zip(*columns, strict=True)]
        # From the back: an insertion moves what follows.
        for end, index in ((piece.high, len(points)), (piece.low, 0)):
            outermost = points[min(index, len(points) - 1)]
            distance = abs(outermost.theta_m - end.theta_m)
            turned = outermost.tau * self.K.Om  # in phase, like the distance
            if end.reason == "end of the window" and turned < SHORT_FLIGHT * distance:
                contact = self.source.rest + self.source.gain * cos(end.theta_m)
                if self.name == "x_i":
                    value = contact
                else:
                    value = end.theta_m
                points.insert(index, Point(end.theta_m, float(value), outermost.slope, 0.0))
        return points

    def _point_of(self, source: CurvePiece | Sample) -> Point:
        """Return a sample as a point; of a piece, arrays of its samples in place of numbers."""
        if self.name == "x_i":
            value: Any = source.x
            slope: Any = source.slope_x
        else:
            value = source.theta
            slope = source.slope_theta
        theta_m: Any = source.theta_m
        return Point(theta_m, value, slope, (theta_m - source.theta) / self.K.Om)

    def _extremum(self, first: Point, last: Point) -> Point | None:
        """Return the point between two points where the unknown is extreme; None at a break of the
        curve.
        """
        for _ in range(NEWTON_HALVINGS):
            middle = self._sampled(0.5 * (first.theta_m + last.theta_m))
            if middle is None or middle.slope == 0.0:
                return middle
            if not first.theta_m < middle.theta_m < last.theta_m:  # doubles end here
                return middle
            if middle.slope * last.slope > 0:
                last = middle
            else:
                first = middle
            change = abs(first.slope) * (last.theta_m - first.theta_m)
            if change < AT_EXTREMUM * max(1.0, abs(first.value)):
                break
        return first

    def _sampled(self, theta_m: float) -> Point | None:
        """Return the point of the curve at theta_m; None if no flight from the mapping's belt
        grazes there.
        """
        sample = self.curve.sample(theta_m)
        if sample.origin == OWN:
            return self._point_of(sample)
        return None

    # -- Newton's method ---------------------------------------------------------------------------

    def _between(self, first: Point, last: Point, target: Number) -> None:
        """Store the solution between points with unknowns on both sides of `target`, or add a note
        if none is found.
        """
        wanted = float(target)
        for _ in range(NEWTON_HALVINGS):
            if first in self._broken:
                return
            # Newton's method from where the chord has the value; if that fails, the half of the
            # stretch that has it.
            first_gap = first.value - wanted
            last_gap = last.value - wanted
            if first_gap != last_gap:
                fraction = first_gap / (first_gap - last_gap)
            else:
                fraction = 0.5
            theta_m = first.theta_m + fraction * (last.theta_m - first.theta_m)
            solution = self._newton(theta_m, first.tau + fraction * (last.tau - first.tau), target)
            if self._store_if_between(solution, first, last):
                return
            theta_m = 0.5 * (first.theta_m + last.theta_m)
            if first.theta_m < theta_m < last.theta_m:
                middle = self._sampled(theta_m)
            else:
                middle = None
            if middle is None:
                break
            if (middle.value >= wanted) == (first.value >= wanted):
                first = middle
            else:
                last = middle
        is_touch = self.curve.sample(theta_m).slope_theta == curves.SLOPE_OF_TOUCHES
        if is_touch:
            solution = self._solve_among_grazes(theta_m, target)
            if self._store_if_between(solution, first, last):
                return
        self._broken.add(first)
        broken = "a solution could not be distinguished from a break of the curve"
        self.notes.append(f"near theta_m = {first.theta_m:.12g} {broken}")

    def _equation(self, theta: Number, tau: Number, start: Instant, target: Number) -> Residual:
        """Return by how much x_i or theta_i at the `start` of a flight misses `target`."""
        if self.name == "x_i":
            gap = self.flights.contact(theta) + start.dx - target
            return Residual(gap, start.x_theta, -start.v)
        Om = self.flights.K.Om
        return Residual(theta - Om * tau - target, 1, -Om)

    def _newton(self, theta_m: float, tau: float, target: Number) -> CurveRoot | None:
        """Find (theta_m, tau) of the flight with x_i or theta_i = `target` by Newton's method from
        a guess; or None.
        """
        context = self.flights.context
        K = self.flights.K
        theta = context.mpf(theta_m)
        tau = context.mpf(tau)
        settled = False
        for _ in range(MOST_CURVE_NEWTON):
            # Two equations: v at the start is that of the belt (its derivative by tau is -a, as tau
            # runs backward), and the unknown has the value.
            start = self.flights.instant(theta, tau)
            gap = start.v - self.flights.v
            residual, by_theta, by_tau = self._equation(theta, tau, start, target)
            determinant = start.v_theta * by_tau + start.a * by_theta
            if determinant == 0:
                return None
            # Cramer's rule for v_theta dtheta - a dtau = -gap, by_theta dtheta + by_tau dtau =
            # -residual.
            theta_step = (-gap * by_tau - residual * start.a) / determinant
            tau_step = (gap * by_theta - residual * start.v_theta) / determinant
            theta = theta + theta_step
            tau = tau + tau_step
            if settled:  # one step after that has all digits
                if tau > 0:
                    return CurveRoot(theta, tau)
                return None
            # More than a turn, or than about a period, leads to another solution.
            most_time = 1 / K.rate + 3 / K.Om
            is_too_far = abs(theta_step) > MOST_TURN or abs(tau_step) > most_time
            if is_too_far or tau <= 0:
                return None
            shrunk = context.eps**0.6
            settled = abs(theta_step) <= shrunk * (1 + abs(theta)) and abs(tau_step) <= shrunk * tau
        return None

    def _solve_among_grazes(self, theta_m: float, target: Number) -> CurveRoot | None:
        """Find the solution among flights that start at a graze too, and so all take one time; None
        if not found.
        """
        flights = self.flights
        phase = Fraction(theta_m)
        arrival, _ = self.source.refined_arrival(
            phase, 1, lambda family: family.K.period * SEARCH_PERIODS, flights.digits
        )
        if arrival.kind != TOUCH:
            return None
        theta = flights.number(phase)
        tau = flights.number(arrival.tau)
        for _ in range(MOST_CURVE_NEWTON):
            residual, by_theta, _ = self._equation(theta, tau, flights.instant(theta, tau), target)
            if by_theta == 0:
                return None
            theta -= residual / by_theta
            if abs(residual / by_theta) <= flights.context.eps * 100:  # rounding
                return CurveRoot(theta, tau)
        return None

    def _store_if_between(
        self, solution: CurveRoot | None, first: Point, last: Point, more: float = 0.0
    ) -> bool:
        """Store a solution if it lies between two points of the curve, give or take a phase `more`,
        and return whether it does.
        """
        if solution is None:
            return False
        theta, tau = solution
        theta_slack = ROUNDED_THETA * max(1.0, abs(float(theta))) + more
        low, high = sorted((first.tau, last.tau))
        short_time = SHORT_TIME / self.K.rate
        tau_slack = ROUNDED_TIME * max(high, short_time) + BEYOND_TIMES * (high - low)
        if more:
            tau_slack += short_time
        is_phase_between = first.theta_m - theta_slack <= float(theta) <= last.theta_m + theta_slack
        is_time_between = low - tau_slack <= float(tau) <= high + tau_slack
        if not (is_phase_between and is_time_between):
            return False
        turn = 2 * self.flights.context.pi
        theta -= turn * self.flights.context.floor(theta / turn)
        for angle, time in self._solutions:
            apart = abs(angle - theta)
            is_same_phase = min(apart, turn - apart) < SAME_ROOT
            # Stored already.
            if is_same_phase and abs(time - tau) < ROUNDED_TIME * max(tau, 1e-9):
                return True
        self._solutions.append(CurveRoot(theta, tau))
        return True

    def _note_endless(self, end: CurveEnd, point: Point, index: int, piece: CurvePiece) -> None:
        """Add a note if solutions past the outermost sample `point` may be nearer to `end` than
        doubles resolve.
        """
        if end.reason in ("end of the window", "closed"):
            return
        if end.reason.endswith("(within the search)"):
            self.notes.append(
                f"beside theta_m = {end.theta_m:.6g} the flights are longer than the search"
            )
            return
        # How far the curve still rises to its end, by the slope at the outermost sample.
        rise = abs(piece.slope_theta[index]) * abs(end.theta_m - point.theta_m)
        is_endless = not rise < LEAST_ENDLESS_RISE  # or nan
        is_beyond = self.name != "x_i" or abs(float(self.target)) > abs(point.value)
        if is_endless and is_beyond:
            last = f"theta = {piece.theta[index]:.6g}, x = {piece.x[index]:.6g}"
            ends = f"at theta_m = {end.theta_m:.12g} the curve goes on for ever"
            self.notes.append(
                f"{ends}; solutions beyond {last} are nearer to its end than doubles resolve"
            )
