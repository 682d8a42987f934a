"""Where grazing orbits come from: the way back from a tangency to the switching plane.

The windows of Theorem 7 (`symosc.grazing.window`) are necessary for a mapping to graze, not sufficient. The flow that
touches the belt at phase theta must also have come from the plane on which the mapping starts. Flowing back from the
contact

    x_m(theta) = (A_alpha + B0 cos(theta) - c v_lambda)/k,   v = v_lambda,   acceleration 0

decides it (`symosc.grazing.backward_flow`): the first contact is on the mapping's own belt (a start), on the other one,
or there is none. Equations (54) with (61) for P2, and their counterparts for P3, P5 and P6, are three equations in the
four unknowns (x_i, Omega t_i, x_m, Omega t_m): a curve (`symosc.grazing.curve`).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf

from symosc.aliases import Angle, Context, Number, NumberLike, Record
from symosc.arguments import public
from symosc.engine.arithmetic import mp_context
from symosc.errors import ParameterError
from symosc.exact import read_digits, read_exact, show
from symosc.grazing.angles import number_of, phase_of, read_angle, read_phase, symbolic, times
from symosc.grazing.backward_flow import HUGE, LARGE, LONG, NEVER, REACHED, TOUCH, Arrival
from symosc.grazing.flight import Flights
from symosc.grazing.origin import OPEN_ORIGIN, SEARCH_PERIODS, Origins
from symosc.grazing.window import grazing_window
from symosc.mappings.latex import point, words
from symosc.model import Parameters

DEFAULT_DIGITS = 40
MOST_START_DIGITS = 2000
MOST_PERIODS_BACK = 1e6


@dataclass(frozen=True)
class GrazingStart:
    """Where the flow that grazes at a phase came from.

    Attributes
    ----------
    mapping : str
    found : bool
        Whether it came from the plane on which the mapping starts. With t0: whether it was in the domain since t0.
    reason : str or None
        Why there is no start.
    t, x, v, theta : number or None
        The start: time, position, velocity, phase Omega t mod 2 pi. If there is no start, the contact with the other
        belt that the reason names. None if there was no contact. Floats, or mpmath numbers with ``digits=``.
    boundary : int
        The belt of that point, 0 if it is on none.
    touch : bool
        Whether the flow only touches that belt, as far as twice the working precision tells.
    t_m, x_m, theta_m : number
        The tangency. Without t_m= or t0= its time is theta/Omega, so that t may be negative.
    undecided : bool
        Whether the search ended before it was known where the flow came from; the reason says why.
    start : dict
        t0, x0 and v0 of the point, and start_error, a unit of their last digits. `simulate` takes them as they are:
        ``simulate(p, **found.start, t_end=...)``.

    Examples
    --------
    >>> from symosc import grazing_start, load_scene
    >>> found = grazing_start(load_scene("fig9").parameters, "P2", theta=1)
    >>> found.found, f"{found.t:.6f}", f"{found.x:.6f}", found.v
    (True, '-0.332121', '5.531851', 1.0)
    """

    mapping: str
    found: bool
    reason: str | None
    t: Number
    x: Number
    v: Number
    theta: Number
    boundary: int
    touch: bool
    t_m: Number
    x_m: Number
    theta_m: Number
    start: Record
    undecided: bool = False

    def latex(self) -> str:
        """Return start and tangency as LaTeX, or why there is no start (no dollar signs)."""
        name, tangency = f"P_{{{self.mapping.removeprefix('P')}}}", point("m", self.theta_m, self.x_m)
        if not self.found:
            return rf"{name}:\quad {tangency},\quad {words(self.reason)}"
        return rf"{name}:\quad {point('i', self.theta, self.x)} \mapsto {tangency}"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"

    def to_dict(self) -> Record:
        """Return the entries as text and booleans."""
        values = {name: getattr(self, name) for name in ("t", "x", "v", "theta", "t_m", "x_m", "theta_m")}
        texts = {name: None if value is None else str(value) for name, value in values.items()}
        first = {"mapping": self.mapping, "found": self.found, "reason": self.reason}
        return first | texts | {"boundary": self.boundary, "touch": self.touch}


@public
def grazing_start(
    p: Parameters,
    mapping: str,
    theta: NumberLike | None = None,
    *,
    t_m: NumberLike | None = None,
    t0: NumberLike | None = None,
    digits: int | None = None,
    periods: NumberLike = SEARCH_PERIODS,
) -> GrazingStart:
    """Flow back from the tangency at a phase to where the mapping starts.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".
    theta, t_m : number
        Phase Omega t_m or time of the tangency (one of them): a number, a string or a sympy constant such as sympy.pi.
        A phase is taken at the time theta/Omega; with t0, at the first such time after t0. A float phase is used as
        the exact binary number; a float time is read as the decimal that it prints as.
    t0 : number, optional
        Flow back to this time instead of to the switching plane.
    digits : int, optional
        Correct digits of the result. None: floats, rounded from 40 digits, which `start` keeps.
    periods : float
        How far back to look, in periods of the excitation.

    Raises
    ------
    ParameterError
        For a mapping without grazing, a phase outside the mapping's window, k = 0, or a t0 that is not before t_m.

    Examples
    --------
    >>> from symosc import grazing_start, load_scene, simulate
    >>> p = load_scene("fig9").parameters
    >>> found = grazing_start(p, "P2", theta=1)
    >>> simulate(p, **found.start, t_end="0.3").events[0].kind
    'graze'
    """
    origins = Origins(p, mapping)
    time, angle = _tangency(p, theta, t_m, t0)
    until = None if t0 is None else read_exact("t0", t0)
    return start_of(origins, time, angle, until, read_digits(digits, MOST_START_DIGITS), _check_periods(periods))


def start_of(
    origins: Origins,
    time: Angle,
    angle: Angle,
    until: Fraction | None = None,
    digits: int | None = None,
    periods: float = SEARCH_PERIODS,
) -> GrazingStart:
    """Return what `grazing_start` returns, for an exact time and phase and checked arguments."""
    order = order_at(origins.p, origins.mapping, angle)
    wanted = digits or DEFAULT_DIGITS

    def far(flights: Flights) -> Number:
        if until is None:
            return flights.K.period * periods
        return flights.number(time) - flights.number(until)

    if far(origins.flights(wanted + 20)) <= 0:
        raise ParameterError("t0", float(until or 0), f"must be earlier than t_m = {float(time)!r}")
    arrival, flights = origins.exact(angle, order, far, wanted)
    return _result(arrival, flights, origins.mapping, time, angle, until is not None, digits, periods)


def _check_periods(periods: object) -> float:
    number = float(read_exact("periods", periods))
    if not 0 < number <= MOST_PERIODS_BACK:
        raise ParameterError("periods", periods, f"must be > 0 and at most {MOST_PERIODS_BACK:g}")
    return number


def _tangency(
    p: Parameters, theta: NumberLike | None, t_m: NumberLike | None, t0: NumberLike | None
) -> tuple[Angle, Angle]:
    """Return the exact time and phase of the tangency."""
    if (theta is None) == (t_m is None):
        raise ParameterError("theta", theta, "give either theta or t_m")
    if t_m is not None:
        time = read_angle("t_m", t_m)
        return time, phase_of(times(time, p.Omega))
    angle = phase_of(read_phase("theta", theta))
    if t0 is None:
        return times(angle, 1 / p.Omega), angle
    import sympy

    begin = read_exact("t0", t0) * p.Omega
    gap = sympy.Rational(begin.numerator, begin.denominator) - symbolic(angle)
    turns = sympy.floor(gap / (2 * sympy.pi)) + 1
    return times(symbolic(angle) + 2 * sympy.pi * turns, 1 / p.Omega), angle


def order_at(p: Parameters, mapping: str, angle: Angle) -> int:
    """Return the order of the first G-function that does not vanish at a phase of the mapping's window: 1 or 3."""
    window = grazing_window(p, mapping)
    if not window.contains(angle):
        raise ParameterError("theta", str(angle), f"is outside the grazing window: {window!r}")
    context = mp_context(60)
    pull, drive = p.k * window.speed, p.B0 * p.Omega
    slope = number_of(pull, context) + number_of(drive, context) * context.sin(number_of(angle, context))
    if abs(slope) > 1e-40 * (abs(pull) + abs(drive)):
        return 1
    # In the window and G^(1) = 0: the quartic tangency of the equality. Rational phases but 0 have no rational sine.
    exact = angle == 0 or not isinstance(angle, Fraction)
    return 3 if exact and abs(pull) == abs(drive) else 1


def _result(
    arrival: Arrival,
    flights: Flights,
    mapping: str,
    time: Angle,
    angle: Angle,
    to_time: bool,
    digits: int | None,
    periods: float,
) -> GrazingStart:
    p, boundary, context = flights.p, flights.place.boundary, flights.context
    theta_m, when, two_pi = flights.number(angle), flights.number(time), 2 * flights.context.pi
    x_m = flights.contact(theta_m)
    t, x = when - arrival.tau, x_m + arrival.dx
    theta = theta_m - flights.K.Om * arrival.tau
    theta -= two_pi * context.floor(theta / two_pi)
    point = f"belt {arrival.boundary} at t = {float(t):.12g}, x = {float(x):.12g}"
    verb = "touches" if arrival.kind == TOUCH else "comes from"
    if to_time:
        found = arrival.kind == REACHED
        reason = f"between t0 and t_m the flow {verb} {point}"
    else:
        found = arrival.boundary == boundary
        reason = f"the flow {verb} {point}, not belt {boundary}"
    reason = _no_end(arrival, float(t), boundary, periods) or reason
    nowhere = arrival.kind in (NEVER, LONG, LARGE, OPEN_ORIGIN) or (arrival.kind == REACHED and not to_time)
    found = found and not nowhere
    keep = digits or DEFAULT_DIGITS
    shown = mp_context(keep)

    def out(value: Number) -> Number:
        return shown.convert(value) * 1 if digits else float(value)

    velocity = p.belt(arrival.boundary) if arrival.boundary else arrival.v
    texts = {"t0": _text(t, keep, shown), "x0": _text(x, keep, shown)}
    texts["v0"] = show(velocity) if isinstance(velocity, Fraction) else _text(velocity, keep, shown)
    errors = _unit(texts["t0"]), _unit(texts["x0"]), Fraction(0) if arrival.boundary else _unit(texts["v0"])
    v = flights.number(velocity)
    return GrazingStart(
        mapping=mapping,
        found=found,
        reason=None if found else reason,
        t=None if nowhere else out(t),
        x=None if nowhere else out(x),
        v=None if nowhere else out(v),
        theta=None if nowhere else out(theta),
        boundary=0 if nowhere else arrival.boundary,
        touch=arrival.kind == TOUCH,
        t_m=out(when),
        x_m=out(x_m),
        theta_m=out(theta_m),
        start={} if nowhere else texts | {"start_error": errors},
        undecided=nowhere and arrival.kind != NEVER,
    )


def _unit(text: str) -> Fraction:
    """Return a unit of the last decimal of a number, 0 for one without decimals."""
    decimals = len(text.partition(".")[2])
    return Fraction(1, 10**decimals) if decimals else Fraction(0)


def _no_end(arrival: Arrival, t: float, boundary: int, periods: float) -> str | None:
    """Return why a search has met no belt."""
    if arrival.kind == NEVER:
        return (
            f"the flow never met a belt before: backward from t = {t:.6g} its velocity runs away from belt {boundary}"
        )
    if arrival.kind == REACHED:
        return f"the flow met no belt in the {periods:g} periods before; ask for more with periods="
    if arrival.kind == LARGE:
        return f"the search ended at t = {t:.6g}: before that the velocity exceeds {HUGE:g}, and no belt was met"
    if arrival.kind == LONG:
        return f"the search ended at t = {t:.6g}, after as many steps as it may take; until there no belt was met"
    if arrival.kind == OPEN_ORIGIN:
        return f"whether the flow meets belt {arrival.boundary} at t = {t:.12g} could not be decided"
    return None


def _text(value: Number, digits: int, context: Context) -> str:
    """Return a decimal with at least `digits` digits after the point, readable as an exact number."""
    whole = len(str(int(abs(value))))
    return str(context.nstr(value, digits + whole, strip_zeros=False, min_fixed=-inf, max_fixed=inf))
