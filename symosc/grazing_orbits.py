"""Where grazing orbits come from: the way back from a tangency to the switching plane.

The windows of Theorem 7 (`symosc.grazing`) are necessary for a mapping to graze, not sufficient: the flow that touches
the belt at phase theta must have come from the plane on which the mapping starts. Flowing back from the contact

    x_m(theta) = (A_alpha + B0 cos(theta) - c v_lambda)/k,   v = v_lambda,   acceleration 0

decides it (`symosc.backward`): the first contact is on the mapping's own belt (a start), on the other one, or there is
none. Equations (54) with (61) for P2, and their counterparts for P3, P5 and P6, are three equations in the four
unknowns (x_i, Omega t_i, x_m, Omega t_m): a curve (`symosc.grazing_curves`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite
from typing import Any

from symosc.backward import CONTACT, NEVER, REACHED, STEP, TOUCH, Arrival, flow_back
from symosc.errors import ParameterError
from symosc.exact import NUMBER_FORMS, read_exact, show
from symosc.grazing import grazing_window
from symosc.model import Parameters
from symosc.numerics import MpArithmetic, mp_context
from symosc.windows import place

DEFAULT_DIGITS = 40
# How far back a start is looked for, in periods of the excitation.
PERIODS = 100
MOST_DIGITS = 2000
# A touch is looked at again with this step, so that it is no accident of where steps and intervals end.
OTHER_STEP = 0.39


@dataclass(frozen=True)
class GrazingStart:
    """Where the flow that grazes at a phase came from.

    Attributes
    ----------
    mapping : str
    found : bool
        Whether it came from the plane on which the mapping starts (with t0: whether it was in the domain since t0).
    reason : str or None
        Why there is no start.
    t, x, v, theta : number or None
        The start: time, position, velocity, phase Omega t mod 2 pi; or the contact with the other belt that the reason
        speaks of. None if there was no contact. Floats, or mpmath numbers with ``digits=``.
    boundary : int
        The belt of that point, 0 if it is on none.
    touch : bool
        Whether the flow only touches that belt, as far as twice the working precision tells.
    t_m, x_m, theta_m : number
        The tangency. Without t_m= or t0= its time is theta/Omega, so that t may be negative.
    start : dict
        t0, x0 and v0 of the point as exact numbers that `simulate` takes: ``simulate(p, **found.start, t_end=...)``.
    """

    mapping: str
    found: bool
    reason: str | None
    t: Any
    x: Any
    v: Any
    theta: Any
    boundary: int
    touch: bool
    t_m: Any
    x_m: Any
    theta_m: Any
    start: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """Return the entries as text and booleans."""
        values = {name: getattr(self, name) for name in ("t", "x", "v", "theta", "t_m", "x_m", "theta_m")}
        texts = {name: None if value is None else str(value) for name, value in values.items()}
        first = {"mapping": self.mapping, "found": self.found, "reason": self.reason}
        return first | texts | {"boundary": self.boundary, "touch": self.touch}


def read_angle(name: str, value: Any) -> Any:
    """Return a Fraction, or a real sympy constant, for a number, a text such as "3*pi/2" or a sympy expression."""
    forms = f"{NUMBER_FORMS}, or a real constant such as sympy.pi or '3*pi/2'"
    if isinstance(value, str) and re.fullmatch(r"(?!.*\*\*)(?=.*pi)(?:pi|[\d.\s()+\-*/])+", value):
        import sympy

        try:
            value = sympy.nsimplify(sympy.sympify(value), rational=True)
        except (sympy.SympifyError, TypeError, SyntaxError):
            raise ParameterError(name, value, forms) from None
    if hasattr(value, "free_symbols") and not getattr(value, "is_Rational", False) and not value.is_Float:
        if value.free_symbols or value.is_real is False or not value.is_number or not value.evalf().is_Float:
            raise ParameterError(name, value, forms)
        return value
    try:
        return read_exact(name, value)
    except ParameterError as error:
        raise ParameterError(name, value, error.allowed if "finite" in error.allowed else forms) from None


def number_of(value: Any, context: Any) -> Any:
    """Return a Fraction or a sympy constant as an mpf of the context."""
    if isinstance(value, Fraction):
        return context.mpf(value.numerator) / value.denominator
    return context.mpf(str(value.evalf(context.dps + 5)))


def phase_of(angle: Any) -> Any:
    """Return an exact angle reduced to [0, 2 pi), exactly."""
    if isinstance(angle, Fraction):
        if 0 <= angle < 6:
            return angle
        import sympy

        angle = sympy.Rational(angle.numerator, angle.denominator)
    import sympy

    return angle - 2 * sympy.pi * sympy.floor(angle / (2 * sympy.pi))


def contact_position(p: Parameters, mapping: str, theta: Any, arithmetic: MpArithmetic) -> Any:
    """Return x_m(theta) in the arithmetic's precision.

    Raises
    ------
    ParameterError
        For k = 0, where F = 0 fixes the phase and leaves the position free.
    """
    if p.k == 0:
        raise ParameterError("k", "0", "must be > 0 here: without a spring F = 0 fixes the phase, not the contact")
    where = place(mapping)
    rest = arithmetic.number((p.A(where.domain) - p.c * p.belt(where.boundary)) / p.k)
    return rest + arithmetic.number(p.B0 / p.k) * arithmetic.context.cos(theta)


def grazing_start(
    p: Parameters,
    mapping: str,
    theta: Any = None,
    *,
    t_m: Any = None,
    t0: Any = None,
    digits: int | None = None,
    periods: float = PERIODS,
) -> GrazingStart:
    """Flow back from the tangency at a phase to where the mapping starts.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".
    theta, t_m : number
        Phase Omega t_m or time of the tangency (one of them): a number, a string or a sympy constant such as sympy.pi.
        A phase is taken at the time theta/Omega; with t0, at the first such time after t0. A float phase is the binary
        number that it is, a float time the decimal that it prints as.
    t0 : number, optional
        Flow back to this time instead of to the switching plane.
    digits : int, optional
        Correct digits of the result; None: floats (from 40 digits, which `start` keeps).
    periods : float
        How far back to look, in periods of the excitation.

    Raises
    ------
    ParameterError
        For a mapping without grazing, a phase outside the mapping's window, k = 0, or a t0 that is not before t_m.
    """
    where = place(mapping)
    time, angle = _tangency(p, theta, t_m, t0)
    order = _order(p, mapping, angle)
    if digits is not None and not (isinstance(digits, int) and 5 <= digits <= MOST_DIGITS):
        raise ParameterError("digits", digits, f"must be a whole number from 5 to {MOST_DIGITS}")
    until = None if t0 is None else read_exact("t0", t0)
    wanted = digits or DEFAULT_DIGITS
    working, confirmed = wanted + 20, False
    while True:
        arithmetic = MpArithmetic(p, working)
        context = arithmetic.context
        far = arithmetic.K.period * periods if until is None else number_of(time, context) - arithmetic.number(until)
        if far <= 0:
            raise ParameterError("t0", t0, f"must be earlier than t_m = {float(number_of(time, context))!r}")
        step = OTHER_STEP if confirmed else STEP
        theta_m = number_of(angle, context)
        arrival = flow_back(theta_m, order, where.boundary, where.domain, far, arithmetic.K, context, context.eps, step)
        if arrival.kind == TOUCH and not confirmed:
            working, confirmed = 2 * working, True
            continue
        missing = _missing_digits(arrival, wanted, context)
        if missing <= 0 or working > 20 * wanted:
            break
        working += missing + 3
    return _result(p, mapping, arrival, arithmetic, time, angle, until is not None, digits, periods)


def _tangency(p: Parameters, theta: Any, t_m: Any, t0: Any) -> tuple[Any, Any]:
    """Return the exact time and phase of the tangency."""
    if (theta is None) == (t_m is None):
        raise ParameterError("theta", theta, "give either theta or t_m")
    if t_m is not None:
        time = read_angle("t_m", t_m)
        return time, phase_of(_times(time, p.Omega))
    angle = phase_of(read_angle("theta", Fraction(theta) if isinstance(theta, float) and isfinite(theta) else theta))
    if t0 is None:
        return _times(angle, 1 / p.Omega), angle
    import sympy

    begin = read_exact("t0", t0) * p.Omega
    gap = sympy.Rational(begin.numerator, begin.denominator) - _symbolic(angle)
    turns = sympy.floor(gap / (2 * sympy.pi)) + 1
    return _times(_symbolic(angle) + 2 * sympy.pi * turns, 1 / p.Omega), angle


def _symbolic(value: Any) -> Any:
    import sympy

    return sympy.Rational(value.numerator, value.denominator) if isinstance(value, Fraction) else value


def _times(value: Any, factor: Fraction) -> Any:
    return value * factor if isinstance(value, Fraction) else value * _symbolic(factor)


def _order(p: Parameters, mapping: str, angle: Any) -> int:
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


def _missing_digits(arrival: Arrival, wanted: int, context: Any) -> int:
    """Return how many digits the arrival lacks."""
    if arrival.kind in (NEVER, TOUCH) or arrival.v_error == 0:
        return 0
    t_error = arrival.v_error / abs(arrival.a) if arrival.kind == CONTACT else 0 * arrival.a
    x_error = arrival.x_error + abs(arrival.v) * t_error
    v_error = arrival.v_error if arrival.kind == REACHED else 0 * arrival.a
    sizes = max(1, abs(arrival.tau)), max(1, abs(arrival.dx)), max(1, abs(arrival.v))
    worst = max(error / size for error, size in zip((t_error, x_error, v_error), sizes, strict=True))
    return int(context.ceil(context.log10(worst))) + wanted + 2 if worst > 0 else 0


def _result(
    p: Parameters,
    mapping: str,
    arrival: Arrival,
    arithmetic: MpArithmetic,
    time: Any,
    angle: Any,
    to_time: bool,
    digits: int | None,
    periods: float,
) -> GrazingStart:
    boundary = place(mapping).boundary
    context, two_pi = arithmetic.context, 2 * arithmetic.context.pi
    theta_m, when = number_of(angle, context), number_of(time, context)
    x_m = contact_position(p, mapping, theta_m, arithmetic)
    t, x = when - arrival.tau, x_m + arrival.dx
    theta = theta_m - arithmetic.K.Om * arrival.tau
    theta -= two_pi * context.floor(theta / two_pi)
    point = f"belt {arrival.boundary} at t = {float(t):.12g}, x = {float(x):.12g}"
    verb = "touches" if arrival.kind == TOUCH else "comes from"
    if to_time:
        found = arrival.kind == REACHED
        reason = f"between t0 and t_m the flow {verb} {point}"
    else:
        found = arrival.boundary == boundary
        reason = f"the flow {verb} {point}, not belt {boundary}"
    if arrival.kind == NEVER:
        away = f"backward from t = {float(t):.6g} its velocity runs away from belt {boundary}"
        reason = f"the flow never met a belt before: {away}"
    if arrival.kind == REACHED and not to_time:
        reason = f"the flow met no belt in the {periods:g} periods before; ask for more with periods="
    nowhere = arrival.kind == NEVER or (arrival.kind == REACHED and not to_time)
    keep = digits or DEFAULT_DIGITS
    shown = mp_context(keep)

    def out(value: Any) -> Any:
        return shown.convert(value) * 1 if digits else float(value)

    velocity = p.belt(arrival.boundary) if arrival.boundary else arrival.v
    texts = {"t0": _text(t, keep, shown), "x0": _text(x, keep, shown)}
    texts["v0"] = show(velocity) if isinstance(velocity, Fraction) else _text(velocity, keep, shown)
    v = number_of(velocity, context) if isinstance(velocity, Fraction) else velocity
    return GrazingStart(
        mapping=mapping,
        found=found,
        reason=None if found else reason,
        t=None if nowhere else out(t),
        x=None if nowhere else out(x),
        v=None if nowhere else out(v),
        theta=None if nowhere else out(theta),
        boundary=arrival.boundary,
        touch=arrival.kind == TOUCH,
        t_m=out(when),
        x_m=out(x_m),
        theta_m=out(theta_m),
        start={} if nowhere else texts,
    )


def _text(value: Any, digits: int, context: Any) -> str:
    """Return a decimal with `digits` digits behind the point's side that matters, readable as an exact number."""
    whole = len(str(int(abs(value))))
    return str(context.nstr(value, digits + whole, strip_zeros=False, min_fixed=-inf, max_fixed=inf))
