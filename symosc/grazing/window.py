"""Grazing windows (Theorem 7): the phases at which a flow that meets a belt's speed turns back.

At a contact x'' = 0 and x' = v_lambda. So the parameters give gamma = k v_lambda/m and the
contact's place x_m(theta), and a window is a closed form. Its case is decided in rational numbers.
Only what needs sympy loads it: sympy takes longer to load than everything else that `symosc
grazing` does, whose exact texts (`phases_text`) do without it. `grazing_windows` computes many
windows at once, in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import Expr, Number, NumberLike, Order
from symosc.base.arguments import ARRAY, ARRAY_LIKE, NUMBER, ORDER, TEXT, public, require
from symosc.base.arrays import real_array
from symosc.base.display.drawable import Drawable
from symosc.base.display.latex import LatexAnswer
from symosc.base.errors import MissingExtraError, ParameterError
from symosc.base.exact import show
from symosc.base.expressions import ExactPhase
from symosc.base.phases import number_of, of_sympy, read_phase, read_phase_text
from symosc.engine.arithmetic import column_functions, mp_context
from symosc.grazing.exact_sine import sine_sign
from symosc.kernels import double_double
from symosc.kernels import theorem7_cases as cases
from symosc.kernels.compiling import compile_modules
from symosc.kernels.theorem7_cases import EMPTY, EVERYTHING, Place, place
from symosc.model import Parameters
from symosc.scenes import ParametersLike, parameters_for

WINDOW_DIGITS = 30
# numpy's sine is right to 1e-15: phases whose sine is nearer to that of an end are decided exactly.
NEAR_END = 1e-12


@public
def grazing_window(p: ParametersLike, mapping: str, order: Order = "full") -> GrazingWindow:
    """Return the phases at which the flow of a map grazes its boundary (Theorem 7).

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping : {"P2", "P3", "P5", "P6"}
        P2: domain 1 at belt 1. P3: domain 2 at belt 1. P5: domain 2 at belt 2. P6: domain 3 at belt
        2.
    order : {"full", "paper"}
        "paper" is the theorem as printed, which stops at G^(1) and supposes B0 > 0. For B0 < 0 it
        is not what the paper prints: the sets are those for -B0, moved by pi. "full" goes on to the
        first G-function that does not vanish: it adds the tangency of fourth order at
        |k v_lambda| = |B0| Omega.

    Raises
    ------
    ParameterError
        For a map without grazing, or another order.

    Examples
    --------
    >>> from symosc import grazing_window, load_scene
    >>> grazing_window(load_scene("fig9").parameters, "P2")
    GrazingWindow(P2, gamma=30, case=(55.1), [0, 3.22502) or (6.19976, 6.28319))
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(ORDER, order=order)
    return GrazingWindow(p, mapping, order, place(mapping))


@dataclass(frozen=True, repr=False)
class GrazingWindow(Drawable, LatexAnswer):
    """The grazing window of a map, made by `grazing_window`.

    Attributes
    ----------
    parameters : Parameters
    mapping : str
    order : {"full", "paper"}
        For "paper" and B0 <= 0, which the paper leaves out, `not_as_printed` says so.
    place : Place
        Domain, boundary and side of the contact, and the paper's equation.

    Examples
    --------
    >>> from sympy import pi
    >>> from symosc import grazing_window, load_scene
    >>> window = grazing_window(load_scene("fig9").parameters, "P2")
    >>> window.theta_cr, window.contains(pi / 2), window.contact(pi / 2)
    (-asin(1/12), True, 14/15)
    """

    _drawn_by = "window_figure"
    _made_by = "grazing_window(...)"

    parameters: Parameters
    mapping: str
    order: Order
    place: Place

    @cached_property
    def gamma(self) -> Fraction:
        """gamma = (c/m) x'' + (k/m) x' at a contact, which is k v_lambda/m for a belt with the
        speed v_lambda.
        """
        return self.parameters.k * self.speed / self.parameters.m

    @cached_property
    def amplitude(self) -> Fraction:
        """B0 Omega/m, the amplitude of the time derivative of the drive, to which gamma is
        compared.
        """
        return self.parameters.B0 * self.parameters.Omega / self.parameters.m

    @property
    def speed(self) -> Fraction:
        """Speed v_lambda of the belt that the flow touches."""
        return self.parameters.belt(self.place.boundary)

    @cached_property
    def signs(self) -> tuple[int, int, int]:
        """Signs of gamma, of the amplitude and of |gamma| - |amplitude|, which determine the case."""
        numbers = self.gamma, self.amplitude, abs(self.gamma) - abs(self.amplitude)
        return tuple((number > 0) - (number < 0) for number in numbers)  # type: ignore[return-value]

    @cached_property
    def kind(self) -> int:
        """The kind of window: EMPTY, EVERYTHING, ALL_BUT_ONE (phase), ARC or WRAPPED_ARC of
        `theorem7_cases`.
        """
        return cases.window_kind(self.place.side, *self.signs, self.order == "full")

    @property
    def case(self) -> str:
        """The paper's case: "(55.1)" is the first case of (55).

        A letter in place of the number marks a case that the paper lacks. a: |gamma| = |B0| Omega/m
        and the window is empty. b: B0 = 0 and every phase grazes. c: B0 = 0 and none does. B0 < 0
        adds "shifted by pi".
        """
        return cases.case_label(self.place, *self.signs)

    @property
    def not_as_printed(self) -> str:
        """Why this window, in the paper's order, is not in the paper.

        "" if it is, or in full order.
        """
        if self.order == "full" or self.amplitude > 0:
            return ""
        return "not as printed: the paper supposes B0 > 0"

    @cached_property
    def phases(self) -> Expr:
        """The phases theta = Omega t mod 2 pi in [0, 2 pi) at which a contact grazes: an exact
        sympy set.
        """
        from symosc.symbolic.theorem7 import rational, window_phases

        return window_phases(
            self.place, rational(self.gamma), rational(self.amplitude), self.order == "full"
        )

    @cached_property
    def theta_cr(self) -> Expr:
        """Theta_cr = asin(-k v_lambda/(B0 Omega)) in [-pi/2, pi/2], exactly; None where it does not
        exist.
        """
        from symosc.symbolic.theorem7 import critical_phase, rational

        return critical_phase(rational(self.gamma), rational(self.amplitude))

    @cached_property
    def intervals(self) -> tuple[tuple[float, float, bool, bool], ...]:
        """The window as (low, high, low_closed, high_closed) in double precision, each end the
        nearest double.

        Points of the circle: an arc through 0 is two intervals, one from 0 (closed) and one up to 2
        pi (open).
        """
        turn, _ = double_double.TWO_PI_PAIR  # the double next to 2 pi, and what it lacks
        is_closed = True
        if self.kind == EMPTY:
            return ()
        if self.kind == EVERYTHING:
            return ((0.0, turn, is_closed, not is_closed),)
        low, high = self.ends
        if self.kind == cases.ARC:
            return ((low, high, not is_closed, not is_closed),)
        first = (0.0, high, is_closed, not is_closed)
        return first, (low, turn, not is_closed, not is_closed)

    @cached_property
    def ends(self) -> tuple[float, float]:
        """The first and last phase of a window that is one arc.

        The first is the larger if the arc goes through 0.
        """
        gamma_sign, amplitude_sign, _ = self.signs
        if self.kind == cases.ALL_BUT_ONE:  # where the sine is 1 or -1
            if gamma_sign * amplitude_sign < 0:
                point, _ = double_double.HALF_PI
            else:
                point = double_double.THREE_HALVES_PI
            return point, point
        # Both phases with G^(1) = 0: Theta_cr, a turn later if it is negative, and its mirror image.
        context = mp_context(WINDOW_DIGITS)
        theta_cr = self.critical_phase()
        mirrored = context.pi - theta_cr
        rising = (2 * context.pi if theta_cr < 0 else 0) + theta_cr
        # It grazes where the sine is above that of Theta_cr (between it and its mirror image), or
        # else below.
        if self.place.side * amplitude_sign < 0:
            low, high = mirrored, rising
        else:
            low, high = rising, mirrored
        turn, _ = double_double.TWO_PI_PAIR
        return float(low), float(high) if high != 0 else turn

    def critical_phase(self) -> Number:
        """Return Theta_cr as an mpmath number of WINDOW_DIGITS digits; nan where it does not
        exist.
        """
        context = mp_context(WINDOW_DIGITS)
        _, _, excess_sign = self.signs  # of |gamma| - |amplitude|
        if self.amplitude == 0 or excess_sign > 0:
            return context.nan
        sine = -self.gamma / self.amplitude
        # 1 - sine^2 from whole numbers, since next to 1 it cancels: the arcsine would lose half the
        # digits.
        square = (sine.denominator - sine.numerator) * (sine.denominator + sine.numerator)
        return context.atan2(sine.numerator, context.sqrt(square))

    # --- phases and places ---

    @public
    def contains(self, theta: NumberLike | np.ndarray) -> Any:
        """Return whether a contact at the phase `theta` grazes, decided exactly.

        Parameters
        ----------
        theta : number, text, sympy expression or numpy array
            Any real number; it is taken mod 2 pi. Text such as "3*pi/2" and sympy expressions such
            as pi/3 or pi + asin(3/5) are exact. A float is used as the exact binary number, because
            phases are computed and not typed.

        Returns
        -------
        bool, or numpy array of bool

        Raises
        ------
        ParameterError
            If theta is not a real number.
        """
        require(NUMBER, ARRAY, theta=theta)
        if not (isinstance(theta, np.ndarray) and theta.ndim):
            return self._sign_at(theta) > 0
        if theta.dtype.kind not in "fiu":
            inside = np.array([self.contains(phase) for phase in theta.flat], dtype=bool)
            return inside.reshape(theta.shape)
        if not np.all(np.isfinite(theta)):
            raise ParameterError("theta", theta[~np.isfinite(theta)][0], "must be finite")
        if self.kind in (EMPTY, EVERYTHING):
            return np.full(theta.shape, self.kind == EVERYTHING)
        # gamma + amplitude sin(theta), divided by the amplitude, has the sign that decides.
        _, amplitude_sign, _ = self.signs
        distance = np.sin(theta.astype(float)) + float(self.gamma / self.amplitude)
        inside = distance * (self.place.side * amplitude_sign) > 0
        close = np.nonzero(np.abs(distance) <= NEAR_END)
        for index in zip(*close, strict=True):
            inside[index] = self._sign_at(theta[index]) > 0
        return inside

    @public
    def contact(self, theta: NumberLike | np.ndarray) -> Any:
        """Return the position x_m = (A_alpha + B0 cos theta - c v_lambda)/k of a grazing contact at
        `theta`.

        Parameters
        ----------
        theta : number, text, sympy expression or numpy array
            A phase in the window.

        Returns
        -------
        sympy expression, float or numpy array
            A float for a float, an array for an array, otherwise exact.

        Raises
        ------
        ParameterError
            If theta is outside the window, or if k = 0: then F = 0 fixes theta (see
            `contact_phases`), and x_m is free.
        """
        require(NUMBER, ARRAY, theta=theta)
        inside = self.contains(theta)
        if not np.all(inside):
            if isinstance(inside, np.ndarray):
                outside = np.asarray(theta)[~inside][0]
            else:
                outside = theta
            raise ParameterError(
                "theta",
                outside,
                f"must be inside the grazing window of {self.mapping}: {self._as_text()}",
            )
        p = self.parameters
        if p.k == 0:
            free = f"k = 0: x_m is free, F = 0 fixes theta; the phases are {self.contact_phases}"
            raise ParameterError("theta", theta, free)
        middle = (p.A(self.place.domain) - p.c * self.speed) / p.k
        gain = p.B0 / p.k
        if isinstance(theta, np.ndarray) and theta.ndim:
            return float(middle) + float(gain) * column_functions()["cos"](theta.astype(float))
        if isinstance(theta, float | np.floating):
            context = mp_context(WINDOW_DIGITS)
            wave = context.cos(context.mpf(float(theta))) * gain.numerator / gain.denominator
            return float(wave + number_of(middle, context))
        from symosc.symbolic.theorem7 import rational, real, sp

        return rational(middle) + rational(gain) * sp.cos(real("theta", theta))

    @cached_property
    def contact_phases(self) -> Expr:
        """The phases at which a contact exists and grazes: all of `phases`, but for k = 0 only the
        one with F = 0.

        Without a spring F does not depend on x: B0 cos theta = c v_lambda - A_alpha leaves at most
        one phase.
        """
        if self.parameters.k != 0:
            return self.phases
        from symosc.symbolic.theorem7 import rational, sp

        p = self.parameters
        if p.B0 == 0:
            return sp.S.EmptySet  # F = 0 would be an equilibrium: the flow stays in the boundary
        cosine = (p.c * self.speed - p.A(self.place.domain)) / p.B0
        if abs(cosine) >= 1:
            return sp.S.EmptySet  # at |cosine| = 1 the sine is 0: an inflection
        # Of the two phases with F = 0 one grazes, the other leads out: by the sign of the sine.
        theta = sp.acos(rational(cosine))
        return sp.FiniteSet(theta if self.place.side * p.B0 > 0 else 2 * sp.pi - theta)

    def _sign_at(self, theta: NumberLike) -> int:
        """Decide exactly whether a contact at theta grazes: 1 if it does, -1 if not, 0 at an end of
        the window.
        """
        if isinstance(theta, np.ndarray):  # of dimension 0
            theta = theta[()]
        exact: Any
        if isinstance(theta, str):
            exact = read_phase_text("theta", theta)
        else:
            angle = read_phase("theta", theta)
            if isinstance(angle, Fraction):
                exact = ExactPhase(angle)
            else:
                exact = of_sympy(angle) or angle
        if self.kind in (EMPTY, EVERYTHING):
            if self.kind == EVERYTHING:
                return 1
            return -1
        if isinstance(exact, ExactPhase):
            return self.place.side * sine_sign(self.gamma, self.amplitude, exact)
        from symosc.symbolic.theorem7 import rational, sign_of, sp

        return self.place.side * sign_of(
            rational(self.gamma) + rational(self.amplitude) * sp.sin(exact)
        )

    def latex(self) -> str:
        """Return the window with its case as LaTeX (no dollar signs)."""
        from symosc.symbolic.latex import latex
        from symosc.symbolic.theorem7 import rational

        number = self.mapping.removeprefix("P")
        belt = self.place.boundary
        gamma, size, amplitude = (
            latex(rational(q)) for q in (self.gamma, abs(self.gamma), abs(self.amplitude))
        )
        _, _, excess_sign = self.signs
        relation = {0: "=", 1: ">", -1: "<"}[excess_sign]
        return (
            rf"P_{{{number}}}:\quad \gamma_{{{number}}} = \frac{{k}}{{m}} v_{{{belt}}} = "
            rf"{gamma},\quad |\gamma_{{{number}}}| = {size} {relation} {amplitude} = "
            rf"\frac{{|B_0|}}{{m}}\,\Omega:\quad \mathrm{{mod}}(\Omega t_m, 2\pi) \in "
            rf"{latex(self.phases)}"
        )

    def __repr__(self) -> str:
        parts = [self.mapping, f"gamma={show(self.gamma)}", f"case={self.case}", self._as_text()]
        return f"GrazingWindow({', '.join(filter(None, [*parts, self.not_as_printed]))})"

    def _as_text(self) -> str:
        """Return the intervals as short text."""
        parts = [
            f"{'[' if closed else '('}{low:.6g}, {high:.6g})"
            for low, high, closed, _ in self.intervals
        ]
        return " or ".join(parts) or "empty"


# --- exact text without sympy: ends are multiples of pi, or asin of a rational number and these ---

#: Rational sines with a rational multiple of pi (Niven), all of them in [-pi/2, pi/2].
NIVEN = {Fraction(0): Fraction(0), Fraction(1, 2): Fraction(1, 6), Fraction(1): Fraction(1, 2)}
NIVEN |= {-sine: -part for sine, part in NIVEN.items()}


def angle_text(sign: int, sine: Fraction, halves: Fraction | int) -> str:
    """Return the angle ``sign asin(sine) + halves pi`` as sympy prints it."""
    if sine in NIVEN:
        halves = halves + sign * NIVEN[sine]
        sign = 0
    top = {0: "0", 1: "pi", -1: "-pi"}.get(halves.numerator, f"{halves.numerator}*pi")
    if halves.denominator == 1:
        multiple = top
    else:
        multiple = f"{top}/{halves.denominator}"
    if not sign:
        return multiple
    minus = sign * sine < 0  # the arcsine is odd
    arcsine = f"asin({abs(sine)})"
    if minus and halves == 1:
        return f"pi - {arcsine}"
    return ("-" if minus else "") + arcsine + (f" + {multiple}" if halves else "")


def critical_text(window: GrazingWindow) -> str:
    """Return Theta_cr as text, "none" where it does not exist."""
    _, _, excess_sign = window.signs  # of |gamma| - |amplitude|
    if window.amplitude == 0 or excess_sign > 0:
        return "none"
    return angle_text(1, -window.gamma / window.amplitude, 0)


def phases_text(window: GrazingWindow) -> str:
    """Return the window in the paper's notation, "empty" if it is."""
    if window.kind in (EMPTY, EVERYTHING):
        if window.kind == EVERYTHING:
            return "[0, 2*pi)"
        return "empty"
    _, amplitude_sign, _ = window.signs
    above = window.place.side * amplitude_sign > 0  # it grazes where the sine is larger
    sine = -window.gamma / window.amplitude
    if window.kind == cases.ALL_BUT_ONE:
        if above:
            low = "3*pi/2"
        else:
            low = "pi/2"
        high = low
    else:
        later = (window.kind == cases.WRAPPED_ARC) == above  # a turn after Theta_cr
        low = angle_text(1, sine, 2 * later)
        high = angle_text(-1, sine, 1)
        if not above:
            low, high = high, low
    if window.kind == cases.ARC:
        return f"({low}, {high})"
    return f"[0, {high}) U ({low}, 2*pi)"


# --- many windows ---


class WindowColumns(NamedTuple):
    """Windows of many parameter sets, as arrays of one shape.

    Attributes
    ----------
    kind : int8
        EMPTY, EVERYTHING, ALL_BUT_ONE, ARC or WRAPPED_ARC, constants of
        `symosc.kernels.theorem7_cases`; always exact.
    low, high : float
        An ARC reaches from low up to high, a WRAPPED_ARC from low through 0 to high, ends excluded.
        ALL_BUT_ONE: low = high is the excluded phase. nan otherwise.
    theta_cr : float
        Theta_cr in [-pi/2, pi/2], nan where it does not exist.

    Examples
    --------
    >>> from symosc import grazing_windows, load_scene
    >>> columns = grazing_windows(load_scene("fig9").parameters, "P2", Omega=[0.05, 1, 4])
    >>> columns.high.round(4).tolist()
    [nan, 3.4814, 3.225]
    """

    kind: np.ndarray
    low: np.ndarray
    high: np.ndarray
    theta_cr: np.ndarray

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, WindowColumns):
            return False
        return all(
            np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
            for a, b in zip(self, other, strict=True)
        )

    def __ne__(self, other: object) -> bool:
        return not self == other


@public
def grazing_windows(
    p: ParametersLike, mapping: str, order: Order = "full", **swept: ArrayLike
) -> WindowColumns:
    """Return the windows for arrays of parameters, in double precision; see `grazing_window`.

    Every end is within one unit in the last place, and every case is exact: array entries are used
    as exact binary numbers, the other parameters stay rational. Compiled where numba is installed.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping, order :
        As for `grazing_window`.
    **swept : array_like of float
        Values of k, B0, Omega and v1 or v2 (the belt of the map); they are broadcast. The window
        depends on no others.

    Raises
    ------
    ParameterError
        For another parameter, and for values that Parameters would refuse.

    Examples
    --------
    >>> from symosc import grazing_windows, load_scene
    >>> columns = grazing_windows(load_scene("fig9").parameters, "P2", Omega=[0.05, 1, 4])
    >>> columns.kind.tolist()
    [1, 4, 4]
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(ORDER, order=order)
    require(*ARRAY_LIKE, **swept)
    where = place(mapping)
    full = order == "full"
    names = ("k", f"v{where.boundary}", "B0", "Omega")
    for name in swept:
        if name not in names:
            raise ParameterError(
                name,
                swept[name],
                f"the window of {mapping} depends on {', '.join(names)} only",
            )
    arrays = {name: real_array(name, values, "must be numbers") for name, values in swept.items()}
    try:
        arrays = dict(zip(arrays, np.broadcast_arrays(*arrays.values()), strict=True))
    except (ValueError, RuntimeError):  # RuntimeError: more dimensions than numpy broadcasts
        shapes = ", ".join(f"{name}: {array.shape}" for name, array in arrays.items())
        allowed = "the shapes must be equal, or broadcast to one as numpy does it"
        raise ParameterError("swept", shapes, allowed) from None
    for name, array in arrays.items():  # Parameters judges the extreme values
        for value in (array.min(), array.max()) if array.size else ():
            p.replace(**{name: float(value)})
    if arrays:
        shape = next(iter(arrays.values())).shape
    else:
        shape = ()
    size = math.prod(shape)
    pairs = list[np.ndarray]()
    for name in names:
        pairs += _pair_columns(arrays.get(name), getattr(p, name), size)
    columns = WindowColumns(np.empty(size, np.int8), *(np.empty(size) for _ in range(3)))
    _window_loop()(tuple(pairs), where.side, full, tuple(columns))
    for i in np.flatnonzero(columns.kind == cases.EQUALITY_UNDECIDED):
        values = {name: Fraction(float(array.flat[i])) for name, array in arrays.items()}
        exact = grazing_window(p.replace(**values), mapping, order)
        columns.kind[i] = exact.kind
        columns.theta_cr[i] = float(exact.critical_phase())
        if exact.kind in (EMPTY, EVERYTHING):
            columns.low[i] = math.nan
            columns.high[i] = math.nan
        else:
            columns.low[i], columns.high[i] = exact.ends
    return WindowColumns(*(column.reshape(shape) for column in columns))


def _pair_columns(
    array: np.ndarray | None, constant: Fraction, size: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return a parameter as columns of pairs of doubles: an array as it is, or a constant, which is
    right to 2^-106.
    """
    if array is not None:
        return array.ravel(), np.zeros(size)
    high = float(constant)
    return np.full(size, high), np.full(size, float(constant - Fraction(high)))


@lru_cache(maxsize=1)
def _window_loop() -> Callable[..., None]:
    """Return `theorem7_cases.windows`, which computes many windows at once, compiled if numba is
    installed.
    """
    try:
        return compile_modules((double_double, cases), {"windows"})["windows"]
    except MissingExtraError:
        return cases.windows
