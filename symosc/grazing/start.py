"""The start of a grazing orbit: the flow back from a tangency to the switching plane.

The windows of Theorem 7 (`symosc.grazing.window`) are necessary for a mapping to graze, not
sufficient. The flow that touches the belt at phase theta must also have come from the plane on
which the mapping starts. Flowing back from the contact

    x_m(theta) = (A_alpha + B0 cos(theta) - c v_lambda)/k,   v = v_lambda,   acceleration 0

decides it (`symosc.grazing.backward`): the first contact is on the mapping's own belt (a start), on
the other one, or there is none. Equations (54) with (61) for P2, and their counterparts for P3, P5
and P6, are three equations in the four unknowns (x_i, Omega t_i, x_m, Omega t_m): a curve
(`symosc.grazing.curve`).

`is_grazing` decides Theorem 6 at a given state, to any order: does the flow touch the belt there?
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf

from symosc.base.aliases import Angle, Context, Number, NumberLike, Record
from symosc.base.arguments import NUMBER, TEXT, public, require, require_or_none
from symosc.base.display.latex import LatexAnswer, latex_number, latex_point, latex_words
from symosc.base.errors import ParameterError
from symosc.base.exact import read_digits, read_exact, show
from symosc.base.phases import number_of, read_angle, read_phase, reduced, symbolic, times
from symosc.engine.arithmetic import mp_context
from symosc.grazing import backward
from symosc.grazing.backward import SEARCH_PERIODS, Flights, Origins
from symosc.grazing.window import grazing_window
from symosc.kernels._generated import next_derivative
from symosc.kernels.theorem7_cases import place
from symosc.scenes import ParametersLike, parameters_for

DEFAULT_DIGITS = 40
MOST_START_DIGITS = 2000
# Digits beyond those wanted, with which t_m and t0 are compared.
SPARE_DIGITS = 20
VERDICT_DIGITS = 50
MOST_PERIODS_BACK = 1e6


@dataclass(frozen=True)
class GrazingStart(LatexAnswer):
    """The start of the flow that grazes at a phase.

    Attributes
    ----------
    mapping : str
    found : bool
        Whether the flow, traced back from the graze, comes from the belt on which the mapping
        starts; with t0, whether the flow has been in the mapping's domain since t0.
    reason : str or None
        Why there is no start.
    t, x, v, theta : number or None
        The start: time, position, velocity, phase Omega t mod 2 pi. If there is no start, the
        contact with the other belt that the reason names. None if there was no contact. Floats, or
        mpmath numbers with ``digits=``.
    boundary : int
        The belt of the start, 0 if it is on none.
    touch : bool
        Whether the flow only touches this belt, as far as twice the working precision can decide.
    t_m, x_m, theta_m : number
        The tangency to the belt. Without t_m= or t0= its time is theta/Omega, so that t may be
        negative.
    undecided : bool
        Whether the search ended before it was known where the flow came from; the reason says why.
    start : dict
        t0, x0 and v0 of the start, and start_error, a unit of their last digits. `simulate` takes
        them as they are: ``simulate(p, **found.start, t_end=...)``.

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
        """Return start and tangency as LaTeX, or the reason why there is no start (no dollar
        signs).
        """
        name = f"P_{{{self.mapping.removeprefix('P')}}}"
        tangency = latex_point("m", self.theta_m, self.x_m)
        if not self.found:
            return rf"{name}:\quad {tangency},\quad {latex_words(self.reason)}"
        return rf"{name}:\quad {latex_point('i', self.theta, self.x)} \mapsto {tangency}"

    def to_dict(self) -> Record:
        """Return the attributes as a dict with numbers as text, without `start` and `undecided`."""
        values = {
            name: getattr(self, name) for name in ("t", "x", "v", "theta", "t_m", "x_m", "theta_m")
        }
        texts = {name: None if value is None else str(value) for name, value in values.items()}
        first = {"mapping": self.mapping, "found": self.found, "reason": self.reason}
        return first | texts | {"boundary": self.boundary, "touch": self.touch}


@public
def grazing_start(
    p: ParametersLike,
    mapping: str,
    theta: NumberLike | None = None,
    *,
    t_m: NumberLike | None = None,
    t0: NumberLike | None = None,
    digits: int | None = None,
    periods: NumberLike = SEARCH_PERIODS,
) -> GrazingStart:
    """Follow the flow back from the tangency at a phase to the mapping's start.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping : str
        "P2", "P3", "P5" or "P6".
    theta, t_m : number
        Phase Omega t_m or time of the tangency (one of them): a number, a string or a sympy
        constant such as sympy.pi. A phase is taken at the time theta/Omega; with t0, at the first
        such time after t0. A float phase is used as the exact binary number; a float time is read
        as the decimal that it prints as.
    t0 : number, optional
        Flow back to this time instead of to the switching plane.
    digits : int, optional
        Correct digits of the result. None: floats, rounded from 40 digits, which `start` keeps.
    periods : float
        How far back to search, in periods of the excitation.

    Raises
    ------
    ParameterError
        For a mapping without grazing, a phase outside the mapping's window, k = 0, or a t0 that is
        not before t_m.

    Examples
    --------
    >>> from symosc import grazing_start, load_scene, simulate
    >>> p = load_scene("fig9").parameters
    >>> found = grazing_start(p, "P2", theta=1)
    >>> simulate(p, **found.start, t_end="0.3").events[0].kind
    'graze'
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require_or_none(NUMBER, theta=theta, t_m=t_m)
    origins = Origins(p, mapping)
    until = None
    if (theta is None) == (t_m is None):
        raise ParameterError("theta", theta, "give either theta or t_m")
    if t_m is not None:
        time = read_angle("t_m", t_m)
        angle = reduced(times(time, p.Omega))
    else:
        angle = reduced(read_phase("theta", theta))
        time = times(angle, 1 / p.Omega)
    if t0 is not None:
        until = read_exact("t0", t0)
        if t_m is None:  # the first time after t0
            import sympy

            gap = symbolic(until * p.Omega) - symbolic(angle)
            turns = sympy.floor(gap / (2 * sympy.pi)) + 1
            time = times(symbolic(angle) + 2 * sympy.pi * turns, 1 / p.Omega)
    digits = read_digits(digits, MOST_START_DIGITS)
    number = float(read_exact("periods", periods))
    if not 0 < number <= MOST_PERIODS_BACK:
        raise ParameterError("periods", periods, f"must be > 0 and at most {MOST_PERIODS_BACK:g}")
    return start_of(origins, time, angle, until, digits, number)


def start_of(
    origins: Origins,
    time: Angle,
    angle: Angle,
    until: Fraction | None = None,
    digits: int | None = None,
    periods: float = SEARCH_PERIODS,
) -> GrazingStart:
    """Return the result of `grazing_start` for a tangency at the exact `time` and phase `angle`,
    with t0 = `until`.
    """
    p = origins.p
    mapping = origins.mapping
    decimals = digits or DEFAULT_DIGITS
    window = grazing_window(p, mapping)
    if not window.contains(angle):
        raise ParameterError("theta", str(angle), f"must be inside the grazing window: {window!r}")
    order = _order_of(origins, angle)

    def far(flights: Flights) -> Number:
        """Return how far back to search, as a number of the flights' precision."""
        if until is None:
            return flights.K.period * periods
        return flights.number(time) - flights.number(until)

    if far(origins.flights(decimals + SPARE_DIGITS)) <= 0:
        raise ParameterError("t0", float(until or 0), f"must be earlier than t_m = {float(time)!r}")
    arrival, flights = origins.refined_arrival(angle, order, far, decimals)
    context = flights.context
    belt = origins.place.boundary
    boundary = arrival.boundary
    kind = arrival.kind
    theta_m = flights.number(angle)
    t_m = flights.number(time)
    x_m = flights.contact(theta_m)
    t = t_m - arrival.tau
    x = x_m + arrival.dx
    theta = theta_m - flights.K.Om * arrival.tau
    two_pi = 2 * context.pi
    theta -= two_pi * context.floor(theta / two_pi)
    # `nowhere`: the flow was followed to no start. `matches`: the start is what is looked for, a
    # contact with the mapping's belt or, with t0, the state at t0.
    is_contact = kind in (backward.CONTACT, backward.TOUCH)
    if until is None:
        nowhere = not is_contact
        matches = is_contact and boundary == belt
    else:
        nowhere = not (is_contact or kind == backward.REACHED)
        matches = kind == backward.REACHED
    point = f"belt {boundary} at t = {float(t):.12g}"
    if matches:
        reason = None
    elif nowhere:
        reason = _reason_nowhere(kind, float(t), belt, point, periods)
    else:
        reason = _reason_elsewhere(kind, float(x), belt, point, until is not None)
    shown = mp_context(decimals)

    def out(value: Number) -> Number:
        """Return a number of the result: a float, or rounded to the digits that are asked for."""
        if digits:
            return shown.convert(value) * 1  # a product is rounded, a conversion is not
        return float(value)

    if boundary:
        velocity: object = p.belt(boundary)
    else:
        velocity = arrival.v
    start: Record = {}
    if not nowhere:
        start = _start_for_simulate(t, x, velocity, decimals, shown)
    values = {"t": t, "x": x, "v": flights.number(velocity), "theta": theta}
    return GrazingStart(
        mapping=mapping,
        found=matches,
        reason=reason,
        **{name: None if nowhere else out(value) for name, value in values.items()},
        boundary=0 if nowhere else boundary,
        touch=kind == backward.TOUCH,
        t_m=out(t_m),
        x_m=out(x_m),
        theta_m=out(theta_m),
        start=start,
        undecided=nowhere and kind != backward.NEVER,
    )


def _order_of(origins: Origins, angle: Angle) -> int:
    """Return the order of the first G-function that is not 0 at a tangency at the phase `angle`."""
    # G^(1) = G^(2) = 0 in the full window only, at the quartic tangency of the equality: there
    # G^(3) decides.
    if grazing_window(origins.p, origins.mapping, "paper").contains(angle):
        return 1
    return 3


def _reason_elsewhere(kind: str, x: float, belt: int, point: str, between: bool) -> str:
    """Return text that says to which start, at a `point` of a belt, the flow was followed instead of
    one on `belt` or, if `between`, instead of the state at t0.
    """
    if kind == backward.TOUCH:
        verb = "touches"
    else:
        verb = "comes from"
    if between:
        return f"between t0 and t_m the flow {verb} {point}, x = {x:.12g}"
    return f"the flow {verb} {point}, x = {x:.12g}, not belt {belt}"


def _reason_nowhere(kind: str, t: float, belt: int, point: str, periods: float) -> str:
    """Return text that says why the flow backward from a contact was followed to no start."""
    ended = f"the search ended at t = {t:.6g}"
    if kind == backward.NEVER:
        since = f"backward from t = {t:.6g}"
        return f"the flow never met a belt before: {since} its velocity runs away from belt {belt}"
    if kind == backward.REACHED:
        return f"the flow met no belt in the {periods:g} periods before; ask for more with periods="
    if kind == backward.LARGE:
        return f"{ended}: before that the velocity exceeds {backward.HUGE:g}, and no belt was met"
    if kind == backward.LONG:
        return f"{ended}, after as many steps as it may take; until there no belt was met"
    return f"whether the flow meets {point} could not be decided"


def _start_for_simulate(
    t: Number, x: Number, velocity: object, decimals: int, shown: Context
) -> Record:
    """Return the start as text of so many decimals, with half-widths of its rounding.

    A velocity that is a Fraction is that of a belt, and exact.
    """
    start: Record = {"t0": _text(t, decimals, shown), "x0": _text(x, decimals, shown)}
    is_exact = isinstance(velocity, Fraction)
    if isinstance(velocity, Fraction):
        start["v0"] = show(velocity)
    else:
        start["v0"] = _text(velocity, decimals, shown)
    units = []  # of the last decimals
    for text in start.values():
        places = len(text.partition(".")[2])
        if places:
            units.append(Fraction(1, 10**places))
        else:
            units.append(Fraction(0))
    if is_exact:
        units[-1] = Fraction(0)  # of v0
    start["start_error"] = tuple(units)
    return start


def _text(value: Number, digits: int, context: Context) -> str:
    """Return a decimal with at least `digits` digits after the point, readable as an exact number."""
    whole = len(str(int(abs(value))))
    return str(
        context.nstr(value, digits + whole, strip_zeros=False, min_fixed=-inf, max_fixed=inf)
    )


# --- Theorem 6 at a state ---

MOST_G_ORDERS = 6


@dataclass(frozen=True)
class GrazingVerdict(LatexAnswer):
    """Whether the flow grazes at a state, by Theorem 6 continued to any order.

    Attributes
    ----------
    grazing : bool
    order : int
        The order n of the first G-function that does not vanish; G^(0) is F, G^(n) its n-th
        derivative along the flow. MOST_G_ORDERS if none was found.
    values : tuple of float
        G^(0), G^(1), ... up to that order; each is computed with those before it that count as 0
        set to 0.
    margins : tuple of float
        Each value relative to the sum of the sizes of its terms; at or below `tolerance` it counts
        as 0.
    tolerance : float
    reason : str

    Examples
    --------
    >>> from symosc import is_grazing, load_scene
    >>> verdict = is_grazing(load_scene("fig9").parameters, "P2", x=0, theta=1)
    >>> verdict.grazing, verdict.order, verdict.reason
    (False, 0, 'F does not vanish: the flow is transversal')
    """

    grazing: bool
    order: int
    values: tuple[float, ...]
    margins: tuple[float, ...]
    tolerance: float
    reason: str

    def latex(self) -> str:
        """Return the G-functions that decide, with the reason, as LaTeX (no dollar signs)."""
        names = ["F", *(f"G^{{({order})}}" for order in range(1, len(self.values)))]
        values = zip(self.values, self.margins, strict=True)
        texts = [
            "0" if margin <= self.tolerance else latex_number(value) for value, margin in values
        ]
        shown = ", ".join(f"{name} = {text}" for name, text in zip(names, texts, strict=True))
        return rf"{shown}:\quad \text{{{'it grazes' if self.grazing else 'it does not graze'}}}"


def _reason_of_verdict(order: int, grazing: bool) -> str:
    """Return what the first G-function that does not vanish, of this order, says about the flow."""
    if order == 0:
        return "F does not vanish: the flow is transversal"
    if order % 2 == 0:
        return (
            f"the first G-function that does not vanish has even order {order}: the flow "
            "passes with an inflection"
        )
    if grazing:
        return f"F = 0 and G^({order}) leads back into the domain"
    return f"G^({order}) leads out of the domain: there is no flow of it near"


@public
def is_grazing(
    p: ParametersLike,
    mapping: str,
    x: NumberLike,
    theta: NumberLike,
    *,
    tolerance: NumberLike = 1e-12,
) -> GrazingVerdict:
    """Decide by Theorem 6 whether the flow grazes at a state on the belt of a mapping.

    The flow grazes if F = 0, and the first G-function that does not vanish has odd order and the
    sign that leads back into the domain. (Order 1 is the theorem as printed.) Values are computed
    with 50 digits; `tolerance` says what counts as 0.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping : str
        "P2", "P3", "P5" or "P6": belt and domain.
    x, theta : number
        Position and phase; strings and sympy constants are exact.
    tolerance : float
        Part of the size of its terms up to which a G-function counts as 0; less than 1.

    Raises
    ------
    ParameterError
        For a mapping without grazing, and for values that are not numbers or are out of range.

    Examples
    --------
    >>> from symosc import grazing_window, is_grazing, load_scene
    >>> p = load_scene("fig9").parameters
    >>> x = grazing_window(p, "P2").contact("1")
    >>> is_grazing(p, "P2", x, "1").grazing
    True
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(NUMBER, x=x, theta=theta)
    where = place(mapping)
    limit = read_exact("tolerance", tolerance)
    if not 0 <= limit < 1:
        raise ParameterError("tolerance", tolerance, "must be >= 0 and < 1")
    tolerance = float(limit)
    context = mp_context(VERDICT_DIGITS)
    angle = number_of(read_phase("theta", theta), context)
    position = number_of(read_angle("x", x), context)
    v, Om = (number_of(q, context) for q in (p.belt(where.boundary), p.Omega))
    cm, w0sq, f0 = (number_of(q / p.m, context) for q in (p.c, p.k, p.B0))
    terms = [
        number_of(p.A(where.domain) / p.m, context),
        f0 * context.cos(angle),
        -w0sq * position,
        -cm * v,
    ]
    value = sum(terms)
    size = sum(abs(term) for term in terms)
    before = v
    waves = (context.sin(angle), context.cos(angle))
    values = list[float]()
    margins = list[float]()
    grazing = False
    reason = "F and all its derivatives vanish: the flow stays on the belt"
    last = MOST_G_ORDERS
    # G^(0) = F, G^(1), ..., each with the size of its terms, as long as all before are 0.
    for order in range(MOST_G_ORDERS):
        if size > 0:
            margin = abs(value) / size
        else:
            margin = abs(value)
        values.append(float(value))
        margins.append(float(margin))
        if margin > tolerance:  # the first one that does not vanish decides
            last = order
            grazing = order % 2 == 1 and where.side * value < 0
            reason = _reason_of_verdict(order, grazing)
            break
        # This G counts as 0 in the next one, so that its rounding does not decide there. The
        # derivatives of the drive run through -sin, -cos, sin, cos, and enter with a minus.
        zero = 0 * value
        sign = 1 if order % 4 < 2 else -1
        forcing = f0 * Om ** (order + 1) * waves[order % 2] * sign
        value = next_derivative(zero, before, forcing, cm, w0sq)
        size = abs(forcing) + abs(w0sq * before) + abs(f0) * Om ** (order + 1)
        before = zero
    return GrazingVerdict(grazing, last, tuple(values), tuple(margins), tolerance, reason)
