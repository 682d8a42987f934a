"""How far a quantity under a piecewise-linear friction law is from that under the smooth law.

The quantity is computed with n, 2n, 4n and more pieces. Where its differences fall as 1/n^2 does, as
they should, Richardson's extrapolation gives the value of the smooth law, and where what is left
falls as 1/n^4 does, so does a further one, and so on (Romberg's table).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from math import inf, isfinite, log2, nan
from typing import Any, NamedTuple

from symosc.base.aliases import Number
from symosc.base.arguments import TEXT, WHOLE, function_of, public, require
from symosc.base.errors import ParameterError, shown
from symosc.base.exact import whole_number
from symosc.kernels.entire import EPS
from symosc.model import Model
from symosc.orbits.find import find_orbit
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import Scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.simulate import simulate

#: Quantities of the settled motion of a law, by name.
EXTREMES = ("x_min", "x_max", "v_min", "v_max")
ORBIT_QUANTITIES = ("period", *EXTREMES)
#: A quantity of an event of a scene, such as t[5].
EVENT_QUANTITY = re.compile(r"([txv])\[(\d{1,6})\]")
#: An observed order may differ by so much from the one that is expected.
ORDER_OFF = 0.5
#: Differences of less than this part of the quantity are those of rounding.
ROUNDED = 64 * EPS
MOST_PIECES = 10_000
MOST_DOUBLINGS = 10


class LawError(NamedTuple):
    """The error of a piecewise-linear friction law on a quantity.

    Attributes
    ----------
    value : float
        The quantity with as many pieces as was asked for.
    extrapolated : float
        That of the smooth law.
    error : float
        By how much `value` is off: value - extrapolated.
    uncertainty : float
        An estimate of the error of `extrapolated`.
    order : float
        The order that was observed: errors fall by 2^order with twice the pieces. nan if all values
        agree to rounding.
    pieces, values : tuple
        The numbers of pieces, each twice the one before, and the quantity with each.

    Examples
    --------
    >>> from symosc import LawError
    >>> LawError._fields
    ('value', 'extrapolated', 'error', 'uncertainty', 'order', 'pieces', 'values')
    """

    value: Number
    extrapolated: Number
    error: Number
    uncertainty: float
    order: float
    pieces: tuple[int, ...]
    values: tuple[Number, ...]


@public
def law_error(
    law: Callable[[int], Any],
    quantity: str | Callable[[Any], Any],
    pieces: int = 64,
    *,
    doublings: int = 2,
) -> LawError:
    """Return how far a quantity under a law of straight pieces is from that under the smooth law.

    Parameters
    ----------
    law : function
        From a number of pieces to the Oscillator with this law, or to a Scene with it.
    quantity : str or function
        A function of what `law` returns. Or "period", "x_min", "x_max", "v_min" or "v_max" of the
        motion to which it settles (`find_orbit`); or of a Scene the time or place of an event,
        counted from 0: "t[5]" or "x[5]".
    pieces : int, optional
        The number of pieces whose error is asked for.
    doublings : int, optional
        How often the pieces are doubled, at least twice. The more, the better is `extrapolated`.

    Returns
    -------
    LawError

    Raises
    ------
    ParameterError
        If the errors do not fall as 1/n^2 does: then nothing is known of the smooth law, and more
        pieces are needed, or the motions differ in their events.

    Notes
    -----
    Errors fall regularly, by a factor of 4 with twice the pieces, if a piece ends at each relative
    speed where the motion turns or is measured, such as those where it is fastest: they are given to
    `Belt.from_function` as ``until=[...]``. Then each doubling gives more than one digit. Else
    errors of about 1/n^2.5 remain after the first extrapolation. The smooth law is the one that
    is constant beyond the last of these speeds: give more than the mass reaches.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, law_error
    >>> def law(pieces):
    ...     belt = Belt.from_function("1/5", lambda w: 1 / (1 + 3 * w), [1.04], pieces)
    ...     return Oscillator(m=1, c=0, k=1, belts=[belt])
    >>> found = law_error(law, "period", 16)
    >>> f"{found.error:.1e}, {found.order:.1f}, {found.extrapolated:.5f}"
    '6.0e-03, 1.9, 12.00104'
    """
    require(function_of(1), law=law)
    require(TEXT, function_of(1), quantity=quantity)
    require(WHOLE, pieces=pieces, doublings=doublings)
    doublings = whole_number("doublings", doublings, 2, MOST_DOUBLINGS)
    pieces = whole_number("pieces", pieces, 1, MOST_PIECES >> doublings)
    counts = tuple(pieces << n for n in range(doublings + 1))
    values = tuple(_value(law, quantity, count) for count in counts)
    extrapolated, uncertainty, order = _limit(values, counts)
    value, *_ = values
    return LawError(value, extrapolated, value - extrapolated, uncertainty, order, counts, values)


def _limit(values: tuple[Number, ...], counts: tuple[int, ...]) -> tuple[Number, float, float]:
    """Return what values with doubled pieces tend to, how uncertain that is, and the order."""
    rounding = ROUNDED * max(1.0, *(abs(float(value)) for value in values))
    steps = [abs(float(fine - coarse)) for coarse, fine in pairwise(values)]
    if max(steps) <= rounding:
        return values[-1], max(steps) + rounding, nan
    order = _order(values)
    column = list(values)
    expected = 2
    while len(column) >= 3 and abs(_order(column) - expected) <= ORDER_OFF:
        factor = 2**expected
        column = [fine + (fine - coarse) / (factor - 1) for coarse, fine in pairwise(column)]
        # The next column falls faster than this one, by a factor that is not known for sure.
        uncertainty = abs(float(column[-1] - column[-2])) / (factor - 1) + rounding
        expected += 2
    if expected == 2:
        texts = ", ".join(f"{float(value):.10g}" for value in values)
        raise ParameterError(
            "pieces",
            counts[0],
            f"the errors do not fall as 1/n^2: with {', '.join(map(str, counts))} pieces the "
            f"quantity is {texts}, so the observed order is {order:.2g}; give more pieces, or end "
            "pieces where the motion turns (until=[...])",
        )
    return column[-1], uncertainty, order


def _order(values: Any) -> float:
    """Return the order with which the last three of values fall; -inf if they do not."""
    coarse, middle, fine = (float(value - values[-1]) for value in values[-3:])
    before = middle - coarse
    after = fine - middle
    if after == 0.0 or before / after <= 0.0:
        return -inf
    return log2(before / after)


def _value(law: Callable[[int], Any], quantity: Any, pieces: int) -> Number:
    """Return a quantity with so many pieces."""
    what = _called("law", law, pieces, pieces)
    if isinstance(quantity, str):
        return _named_value(what, quantity)
    value = _called("quantity", quantity, what, pieces)
    try:
        is_number = isfinite(float(value)) and not isinstance(value, bool)
    except (TypeError, ValueError):
        is_number = False
    if not is_number:
        allowed = f"must return a finite number, and not {shown(value)} with {pieces} pieces"
        raise ParameterError("quantity", quantity, allowed)
    if hasattr(value, "_mpf_"):
        return value
    return float(value)


def _called(name: str, function: Callable[[Any], Any], argument: Any, pieces: int) -> Any:
    """Return the answer of a user's function, the argument `name`."""
    try:
        return function(argument)
    except Exception as error:  # whatever a user's function raises
        reason = f"{type(error).__name__}: {error}".removesuffix(": ")
        raise ParameterError(name, function, f"fails with {pieces} pieces: {reason}") from error


def _named_value(what: Any, name: str) -> Number:
    """Return a quantity by its name, of a law or of a scene with it."""
    if not isinstance(what, Model | Scene):
        raise ParameterError("law", what, "must return an Oscillator or a Scene")
    of_event = EVENT_QUANTITY.fullmatch(name)
    if of_event is None and name not in ORBIT_QUANTITIES:
        allowed = f'must be a function, one of {", ".join(ORBIT_QUANTITIES)}, or such as "t[5]"'
        raise ParameterError("quantity", name, allowed)
    if of_event is None:
        return _of_orbit(what, name)
    if not isinstance(what, Scene):
        raise ParameterError("quantity", name, "is of a motion: law must return a Scene")
    letter, number = of_event.groups()
    events = simulate(what).events
    if int(number) >= len(events):
        raise ParameterError("quantity", name, f"there are {len(events)} events, counted from 0")
    value: Number = getattr(events[int(number)], letter)
    return value


def _of_orbit(what: Model | Scene, name: str) -> Number:
    """Return a quantity of the orbit to which a motion settles."""
    orbit = find_orbit(what)
    if name == "period":
        return orbit.period
    begin, x, v = _state_on(orbit)
    end = begin + float(orbit.period or 1.0)
    extremes = simulate_many(orbit.parameters, [(begin, x, v)], end, record=(name,))
    return float(getattr(extremes, name)[0])


def _state_on(orbit: PeriodicOrbit) -> tuple[float, float, float]:
    """Return t, x and v on an orbit."""
    if isinstance(orbit, FollowedOrbit):
        t, x, v = orbit.start
    else:
        t, x = orbit.points[0]
        v = orbit.parameters.belt(orbit.equations().pieces[0].start)
    return float(t), float(x), float(v)
