"""Other oscillators of the literature that are symosc's in other coordinates.

    m x'' + c (x' - y') + k (x - y) = A0 + m g sin(angle) + B0 cos(Omega t + phase) + friction of the belts
    y = Y cos(Omega t + Y_phase) + pull t    the base, to which spring and damper are joined
    v1 + w', v2 + w'                         the speeds of the belts, w' = W cos(Omega t + W_phase); joined to the base
                                             they have its velocity y' as well

Friction depends on the velocity relative to the belts alone. So z = x - w - pull t obeys

    m z'' + c z' + k z = A0 + m g sin(angle) + P cos(Omega t) + Q sin(Omega t) + friction of belts
    at v1 - pull and v2 - pull (joined to the base: v1 and v2)

where P cos + Q sin = B0 cos(Omega t + phase) + c y' + k y - m w'' - c w' - k w. In the time s = t -
delay that is hypot(P, Q) cos(Omega s).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cache, cached_property
from math import isqrt
from typing import TYPE_CHECKING, Any, NamedTuple

from symosc.base.aliases import Number
from symosc.base.arguments import ARRAY_LIKE, FLAG, NUMBER, public, require, require_or_none
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import read_exact, show, unmasked
from symosc.base.quantities import half_unit, read_number, rounded
from symosc.belts import Belt, read_belts
from symosc.model import OSCILLATOR_NAMES, Model, Oscillator, Parameters, out_of_reach

if TYPE_CHECKING:  # scenes are read without numpy
    import numpy as np
    from numpy.typing import ArrayLike

#: Digits to compute irrational numbers with; 40 of them are kept.
DIGITS = 80
PI = Fraction(
    "3.1415926535897932384626433832795028841971693993751058209749445923078164062862089986280348253421170680"
)
#: Numbers, or half-widths, of t0, x0 and v0.
Three = tuple[Fraction, Fraction, Fraction]


class Harmonic(NamedTuple):
    """A function C cos(Omega t) + S sin(Omega t) with rational C and S.

    `exact` is False if these were rounded.
    """

    C: Fraction
    S: Fraction
    exact: bool = True

    def plus(self, other: Harmonic, factor: Fraction | int = 1) -> Harmonic:
        """Return the sum of this harmonic and `factor` times another."""
        return Harmonic(
            self.C + factor * other.C, self.S + factor * other.S, self.exact and other.exact
        )

    def rate(self, Omega: Fraction) -> Harmonic:
        """Return the time derivative of the harmonic."""
        return Harmonic(Omega * self.S, -Omega * self.C, self.exact)

    def at(self, cos: Any, sin: Any, number: Callable[[Fraction], Any] = float) -> Any:
        """Return the value of the harmonic, given cos(Omega t) and sin(Omega t).

        `number` converts C and S.
        """
        return number(self.C) * cos + number(self.S) * sin

    def bound(self) -> Fraction:
        """Return |C| + |S|, an upper bound of the harmonic's absolute value."""
        return abs(self.C) + abs(self.S)


def harmonic(size: Fraction, phase: Fraction) -> Harmonic:
    """Return size cos(Omega t + phase) as a harmonic."""
    cos, sin, exact = cos_sin(phase)
    return Harmonic(size * cos, -size * sin, exact or size == 0)


def cos_sin(angle: Fraction) -> tuple[Fraction, Fraction, bool]:
    """Return the cosine and the sine of an angle, and whether they are exact.

    They are exact for 0, and for an angle that differs from a multiple of pi/2 by no more than the
    rounding of its 40th digit: then they are those of the multiple.
    """
    turns = round(2 * angle / PI)
    if abs(angle - turns * PI / 2) <= (half_unit(angle) if turns else 0):
        return Fraction((1, 0, -1, 0)[turns % 4]), Fraction((0, 1, 0, -1)[turns % 4]), True
    context = _context(DIGITS + len(str(abs(turns))))
    turned = context.cos_sin(context.mpf(angle.numerator) / angle.denominator)
    cos, sin = (read_exact("angle", number) for number in turned)
    return cos, sin, False


@cache
def _context(digits: int) -> Any:
    """Return an mpmath context with `digits` digits."""
    from mpmath import mp

    context = mp.clone()
    context.dps = digits
    return context


def polar(wave: Harmonic) -> tuple[Fraction, Fraction, bool]:
    """Return R and psi of a harmonic R cos(Omega t - psi), and whether both are exact."""
    P = wave.C
    Q = wave.S
    if Q == 0:
        return P, Fraction(0), wave.exact
    if P == 0:
        return Q, PI / 2, False
    context = _context(DIGITS)
    square = P * P + Q * Q
    p, q = (context.mpf(number.numerator) / number.denominator for number in (P, Q))
    size = Fraction(isqrt(square.numerator), isqrt(square.denominator))
    if size * size != square or not wave.exact:
        size = rounded(read_exact("B0", context.hypot(p, q)))
    return size, read_exact("phase", context.atan2(q, p)), False


@dataclass(frozen=True, kw_only=True, repr=False)
class OtherModel:
    """An oscillator of the literature that is symosc's in other coordinates: base motion, moving
    walls, inclines.

    m x'' + c (x' - y') + k (x - y) = A0 + m g sin(angle) + B0 cos(Omega t + phase) + friction, with
    the base y = Y cos(Omega t + Y_phase) + pull t, and belts with the speeds v1 + w' and v2 + w'.
    Functions that take Parameters take such a model too and work on the oscillator that it is;
    `simulate`, `fit` and `frequency_response` give their results in the coordinates of the model.

    Parameters
    ----------
    m, k, Omega : number
        Mass, spring, and the angular frequency of all that oscillates.
    FN : number, optional
        Normal force. None: the weight m g cos(angle). It is the force of friction if mu1 is left
        out.
    c, A0, B0, v1, mu1, v2, mu2 : number, optional
        As in Parameters; 0 if left out, and mu1 = 1. Without v2 there is no second belt.
    phase : number, optional
        That of the force B0 cos(Omega t + phase); "-pi/2" makes it a sine.
    Y, Y_phase : number, optional
        Oscillation of the base.
    pull : number, optional
        The constant speed at which the base, the free end of the spring, is pulled.
    belts : sequence of Belt, optional
        Any belts, with static friction or curves, in place of v1, mu1, v2 and mu2.
    W, W_phase : number, optional
        What belts, or a wall, have in addition to v1 and v2: w' = W cos(Omega t + W_phase).
    joined : bool, optional
        Whether belts, or a wall, move with the base as well.
    g, angle : number, optional
        Gravity, and the slope down which x is counted.

    Attributes
    ----------
    oscillator : Oscillator
        The oscillator that it is, with one belt without v2.
    parameters : Parameters
        Its parameters as the paper's. In place of a second belt there is one without friction, too
        fast to be met. ParameterError if the belts are none of the paper's.
    exact : bool
        Whether these are exact. If not they, and a start, are known to 40 digits.
    delay : Fraction
        The time of the model minus that of the oscillator at the same instant, a constant, to 80
        digits.

    Raises
    ------
    ParameterError
        As for Parameters; and if FN is neither given nor a weight.

    Examples
    --------
    >>> from symosc import OtherModel, simulate
    >>> model = OtherModel(m=1, k=1, Omega="3/2", FN="1/2", Y=1, joined=True)  # the wall moves with the base
    >>> model.parameters.B0, model.exact
    (Fraction(9, 4), True)
    >>> motion = simulate(model, t_end=8)
    >>> [(event.kind, f"{event.t:.6f}", f"{event.x:.6f}") for event in motion.events[:2]]
    [('cross', '1.766468', '-0.047600'), ('cross', '3.748057', '-0.800286')]

    A block on a floor, pulled by a spring:

    >>> from symosc import Belt
    >>> block = OtherModel(m=1, k=2, Omega=1, FN=1, pull="1/10", belts=[Belt(0, "1/2", mu_s="4/5")])
    >>> [(event.kind, f"{event.t:.6f}", f"{event.x:.6f}") for event in simulate(block, t_end=9).events]
    [('slip', '4.000000', '0.000000'), ('stick', '6.844418', '0.584442')]
    """

    m: Fraction
    k: Fraction
    Omega: Fraction
    FN: Fraction | None = None
    c: Fraction = Fraction(0)
    A0: Fraction = Fraction(0)
    B0: Fraction = Fraction(0)
    v1: Fraction = Fraction(0)
    v2: Fraction | None = None
    mu1: Fraction = Fraction(1)
    mu2: Fraction = Fraction(0)
    phase: Fraction = Fraction(0)
    Y: Fraction = Fraction(0)
    Y_phase: Fraction = Fraction(0)
    W: Fraction = Fraction(0)
    W_phase: Fraction = Fraction(0)
    joined: bool = False
    g: Fraction = Fraction(0)
    angle: Fraction = Fraction(0)
    pull: Fraction = Fraction(0)
    belts: tuple[Belt, ...] = ()

    def __post_init__(self) -> None:
        joined: Any = self.joined
        if isinstance(joined, str):
            joined = {"true": True, "false": False}.get(joined)
        if not isinstance(joined, bool):
            raise ParameterError("joined", self.joined, "must be true or false")
        object.__setattr__(self, "joined", joined)
        for name in NUMBER_NAMES:
            value = getattr(self, name)
            if value is not None or name not in ("FN", "v2"):
                object.__setattr__(self, name, read_number(name, value)[0])
        if self.FN is None and self.g <= 0:
            raise ParameterError(
                "FN", None, "FN is required unless g > 0, where it is the weight m g cos(angle)"
            )
        if not isinstance(self.belts, tuple) or self.belts:
            self._check_belts()
        if self.v2 is None and self.mu2 != 0:
            raise ParameterError(
                "mu2", show(self.mu2), "mu2 requires v2: without v2 there is no second belt"
            )
        self.oscillator  # noqa: B018  raises errors of numbers that are out of range

    def _check_belts(self) -> None:
        """Read the belts; ParameterError if those of the paper are given too."""
        object.__setattr__(self, "belts", read_belts(self.belts))
        for field in fields(self):
            if field.name in BELT_NUMBERS:
                value = getattr(self, field.name)
                if value != field.default:
                    allowed = "must be omitted if belts are given"
                    raise ParameterError(field.name, show(value), allowed)

    @cached_property
    def base(self) -> Harmonic:
        """The motion y of the base."""
        return harmonic(self.Y, self.Y_phase)

    @cached_property
    def shift(self) -> Harmonic:
        """The oscillation w of the belts about their constant motion: the model has x = z + w, the
        oscillator z.
        """
        rate = harmonic(self.W, self.W_phase)
        # Its integral with mean 0.
        own = Harmonic(-rate.S / self.Omega, rate.C / self.Omega, rate.exact)
        if self.joined:
            return own.plus(self.base)
        return own

    @cached_property
    def force(self) -> Harmonic:
        """The force B0 cos(Omega t + phase)."""
        return harmonic(self.B0, self.phase)

    @cached_property
    def drive(self) -> Harmonic:
        """The drive P cos(Omega t) + Q sin(Omega t) of the reduced oscillator."""
        shift_rate = self.shift.rate(self.Omega)
        shift = self.shift
        base = self.base
        # The right side of the equation for z in the module's docstring.
        drive = self.force.plus(base.rate(self.Omega), self.c).plus(base, self.k)
        return (
            drive.plus(shift_rate.rate(self.Omega), -self.m)
            .plus(shift_rate, -self.c)
            .plus(shift, -self.k)
        )

    @cached_property
    def _drive(self) -> tuple[Fraction, Fraction, bool]:
        """The drive as R cos(Omega t - psi): R, psi, and whether both are exact."""
        return polar(self.drive)

    @property
    def lag(self) -> Fraction:
        """The phase psi of the drive R cos(Omega t - psi)."""
        return self._drive[1]

    @property
    def delay(self) -> Fraction:
        """The constant shift of time: the time of this model minus that of symosc's oscillator at
        the same instant.
        """
        return self.lag / self.Omega

    @cached_property
    def exact(self) -> bool:
        """Whether the numbers of `parameters`, and `delay`, are exact and not rounded."""
        return self._drive[2] and (self.g == 0 or cos_sin(self.angle)[2])

    @cached_property
    def _forces(self) -> tuple[Fraction, Fraction]:
        """The constant force A0 along the slope, and the normal force."""
        cos, sin, exact = cos_sin(self.angle)
        down, press = (self.m * self.g * component for component in (sin, cos))
        A0 = self.A0 + down
        if self.FN is None:
            FN = press
        else:
            FN = self.FN
        if not exact and self.g:
            A0 = rounded(A0)
            if self.FN is None:
                FN = rounded(FN)
        return A0, FN

    @cached_property
    def parameters(self) -> Parameters:
        """The parameters of symosc's oscillator to which this model reduces."""
        if self.belts:
            return self.oscillator.parameters
        if self.Omega <= 0:
            raise ParameterError("Omega", show(self.Omega), "must be > 0")
        A0, FN = self._forces
        B0 = self._drive[0]
        v1 = self.v1 - self.speed_of_frame
        if self.v2 is not None:
            v2 = self.v2 - self.speed_of_frame
        elif self.m > 0:
            forces = abs(A0) + abs(B0) + abs(self.mu1 * FN)
            speeds = abs(v1) + self.shift.bound()
            own = {name: getattr(self, name) for name in ("m", "c", "k", "Omega")}
            v2 = out_of_reach(v1, speeds, forces, **own, B0=B0)
        else:  # `Parameters` refuses m
            v2 = v1 + 1
        unchanged = {name: getattr(self, name) for name in ("m", "c", "k", "Omega", "mu1", "mu2")}
        return Parameters(**unchanged, A0=A0, B0=B0, v1=v1, v2=v2, FN=FN)

    @property
    def speed_of_frame(self) -> Fraction:
        """The constant speed of the base relative to the belts."""
        if self.joined:
            return Fraction(0)
        return self.pull

    @cached_property
    def oscillator(self) -> Oscillator:
        """The oscillator to which this model reduces, with the belts that it has."""
        if not self.belts:
            p = self.parameters
            if self.v2 is not None:
                return p.oscillator
            shared = {name: getattr(p, name) for name in OSCILLATOR_NAMES}
            return Oscillator(**shared, belts=[Belt(p.v1, p.mu1)])
        if self.Omega <= 0:
            raise ParameterError("Omega", show(self.Omega), "must be > 0")
        A0, FN = self._forces
        own = {name: getattr(self, name) for name in ("m", "c", "k", "Omega")}
        belts = [belt.replace(v=belt.v - self.speed_of_frame) for belt in self.belts]
        return Oscillator(**own, A0=A0, B0=self._drive[0], FN=FN, belts=belts)

    @public
    def replace(self, **changes: Any) -> OtherModel:
        """Return a copy with some numbers changed, for example ``model.replace(Omega="1/2")``."""
        numbers = {name: value for name, value in changes.items() if name != "belts"}
        require_or_none(NUMBER, FLAG, **numbers)
        for name in changes:
            if name not in MODEL_NAMES:
                allowed = f"unknown number of a model; choose from {', '.join(MODEL_NAMES)}"
                raise ParameterError(name, changes[name], allowed + meant(name, MODEL_NAMES))
        return OtherModel(**{name: getattr(self, name) for name in MODEL_NAMES} | changes)

    @public
    def back(
        self, t: ArrayLike, x: ArrayLike, v: ArrayLike
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Convert times, positions and velocities of symosc's oscillator to those of this model.

        Examples
        --------
        >>> from symosc import OtherModel, find_orbit
        >>> model = OtherModel(m=1, k=1, c="1/10", Omega="3/2", FN="1/2", Y=1, joined=True)
        >>> orbit = find_orbit(model)
        >>> t, x = zip(*orbit.points)
        >>> model.back(t, x, [0, 0])[1].round(6).tolist()
        [-0.73026, 0.73026]
        """
        require(*ARRAY_LIKE, t=t, x=x, v=v)
        t, x, v = _read_arrays(t=t, x=x, v=v)
        w, rate = motion_of_frame(self, t + float(self.delay))
        return t + float(self.delay), x + w, v + rate

    @public
    def forth(
        self, t: ArrayLike, x: ArrayLike, v: ArrayLike
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Convert times, positions and velocities of this model to those of symosc's oscillator, in
        doubles.

        Examples
        --------
        >>> from symosc import OtherModel
        >>> model = OtherModel(m=1, k=1, Omega=2, FN=1, B0=3, phase="-pi/2")
        >>> s, z, u = model.forth(0, 1, 2)
        >>> f"{s:.6f}", float(z), float(u)
        ('-0.785398', 1.0, 2.0)
        """
        require(*ARRAY_LIKE, t=t, x=x, v=v)
        t, x, v = _read_arrays(t=t, x=x, v=v)
        w, rate = motion_of_frame(self, t)
        return t - float(self.delay), x - w, v - rate

    def as_dict(self) -> dict[str, Any]:
        """Return all numbers that are not at their defaults as text that reads back exactly.

        `joined` is a bool.
        """
        values = {field.name: getattr(self, field.name) for field in fields(self)}
        changed = {
            field.name: values[field.name]
            for field in fields(self)
            if values[field.name] != field.default
        }
        return {
            name: value if isinstance(value, bool) else _shown(value)
            for name, value in changed.items()
        }

    def __repr__(self) -> str:
        shown = self.as_dict()
        if self.belts:
            shown["belts"] = list(self.belts)
        return f"OtherModel({', '.join(f'{name}={value!r}' for name, value in shown.items())})"


def _shown(value: Any) -> Any:
    """Return a number as text, belts as dictionaries of texts."""
    if not isinstance(value, tuple):
        return show(value)
    return [
        {
            name: [[show(w), show(mu)] for w, mu in number] if name == "curve" else show(number)
            for name, number in belt.as_given().items()
        }
        for belt in value
    ]


def reduced_model(model: OtherModel) -> Model:
    """Return the oscillator that a model is: `Parameters` if it has the two belts of the paper,
    else an `Oscillator`.
    """
    if model.belts or model.v2 is None:
        return model.oscillator
    return model.parameters


def number_names(model: OtherModel) -> tuple[str, ...]:
    """Return the names of the numbers that a model may have, with those of its belts."""
    if not model.belts:
        return NUMBER_NAMES
    own = [name for name in NUMBER_NAMES if name not in BELT_NUMBERS]
    numbers = _belts_alone(model).numbers()
    return (*own, *(name for name in numbers if name not in OSCILLATOR_NAMES))


def numbers_of(model: OtherModel) -> dict[str, Fraction]:
    """Return the numbers that a model has, by the names of `number_names`: without FN if that is
    the weight, and without those of a second belt if there is none.
    """
    if model.belts:
        numbers = _belts_alone(model).numbers()
    else:
        numbers = {name: getattr(model, name) for name in BELT_NUMBERS}
        if model.v2 is None:
            del numbers["v2"]
            del numbers["mu2"]
    for name in NUMBER_NAMES:
        if name not in BELT_NUMBERS:
            numbers[name] = getattr(model, name)
    if model.FN is None:
        del numbers["FN"]
    return {name: numbers[name] for name in number_names(model) if name in numbers}


def with_numbers(model: OtherModel, changes: Mapping[str, Any]) -> OtherModel:
    """Return a model with other numbers, by the names of `number_names`."""
    own = dict(changes)
    of_belts = {}
    for name in changes:
        if model.belts and (name not in NUMBER_NAMES or name in BELT_NUMBERS):
            of_belts[name] = own.pop(name)
    if of_belts:
        own["belts"] = _belts_alone(model).replace(**of_belts).belts
    return model.replace(**own)


def _belts_alone(model: OtherModel) -> Oscillator:
    """Return an oscillator that has the belts of a model, and nothing else of it."""
    return Oscillator(m=1, c=0, k=1, belts=model.belts)


def motion_of_frame(model: OtherModel, t: Any) -> tuple[Any, Any]:
    """Return w + pull t, by which the model's position exceeds the oscillator's, and its rate."""
    w, rate = motion_of_belts(model, t)
    pull = float(model.pull)
    return w + pull * t, rate + pull


def motion_of_belts(model: OtherModel, t: Any) -> tuple[Any, Any]:
    """Return the oscillation w of the belts and its rate w' at times of the model, in doubles."""
    import numpy as np

    cos = np.cos(float(model.Omega) * t)
    sin = np.sin(float(model.Omega) * t)
    return model.shift.at(cos, sin), model.shift.rate(model.Omega).at(cos, sin)


def event_back(
    model: OtherModel, t: Number, x: Number, v: Number, theta: Number
) -> tuple[Number, Number, Number, Number]:
    """Convert t, x, v and phase of an event to the model's coordinates, in floats or mpf as they
    are given.
    """
    number = number_like(t)
    context = getattr(t, "context", math)
    theta = (theta + number(model.lag)) % (2 * context.pi)
    cos = context.cos(theta)
    sin = context.sin(theta)
    w = model.shift.at(cos, sin, number)
    rate = model.shift.rate(model.Omega).at(cos, sin, number)
    t = t + number(model.delay)
    pull = number(model.pull)
    return t, x + w + pull * t, v + rate + pull, theta


def reduced_time(model: OtherModel, t: Fraction) -> Fraction:
    """Convert a time of the model to the time of symosc's oscillator."""
    if model.delay:
        return rounded(t - model.delay)
    return t


def reduced_start(
    model: OtherModel, t0: Fraction, x0: Fraction, v0: Fraction
) -> tuple[Three, Three]:
    """Return a model's start as t0, x0, v0 of symosc's oscillator, and by how much each may be off
    (0 if exact).
    """
    zero = Fraction(0)
    x0 = x0 - model.pull * t0
    v0 = v0 - model.pull
    (cos, sin, exact) = cos_sin(model.Omega * t0)
    s0 = reduced_time(model, t0)
    if model.delay:
        s_error = half_unit(abs(t0) + abs(model.delay))
    else:
        s_error = zero
    if model.shift.bound() == 0:
        return (s0, x0, v0), (s_error, zero, zero)
    w, rate = (wave.at(cos, sin, Fraction) for wave in (model.shift, model.shift.rate(model.Omega)))
    if exact and model.shift.exact:
        return (s0, x0 - w, v0 - rate), (s_error, zero, zero)
    (z0, z_error), (u0, u_error) = (_difference(a, b) for a, b in ((x0, w), (v0, rate)))
    # A velocity that may be that of a belt, up to rounding, is that of the belt.
    for belt in model.oscillator.belts:
        if abs(u0 - belt.v) <= half_unit(abs(v0) + abs(rate)):
            u0 = belt.v
            u_error = zero
    return (s0, z0, u0), (s_error, z_error, u_error)


def _read_arrays(**columns: Any) -> list[np.ndarray]:
    """Return numbers or arrays as arrays of doubles.

    ParameterError unless they are finite and of matching shapes.
    """
    import numpy as np

    arrays: dict[str, np.ndarray] = {}
    for name, value in columns.items():
        array = np.asarray(unmasked(name, value), dtype=None if hasattr(value, "dtype") else object)
        if array.dtype.kind not in "iuf" or not np.isfinite(array).all():
            array = np.vectorize(
                lambda number, name=name: float(read_exact(name, number)), otypes=[float]
            )(array)
        arrays[name] = array.astype(float)
        try:
            np.broadcast_shapes(*(item.shape for item in arrays.values()))
        except ValueError:
            raise ParameterError(
                name, array, "must have length 1 or the length of the others"
            ) from None
    return list(arrays.values())


def number_like(value: Number) -> Callable[[Fraction], Number]:
    """Return the function that turns a Fraction into a number like `value`: a float, or an mpf of
    the same context.
    """
    context = getattr(value, "context", None)
    if context is None:
        return float
    return lambda exact: context.mpf(exact.numerator) / exact.denominator


def _difference(a: Fraction, b: Fraction) -> tuple[Fraction, Fraction]:
    """Return a - b of two numbers that are known to 40 digits, and a bound of the error of this
    difference.
    """
    size = abs(a) + abs(b)
    if abs(a - b) * 10 ** (DIGITS - 20) > size:
        difference = rounded(a - b)
    else:  # both agree up to the rounding of these digits
        difference = Fraction(0)
    return difference, half_unit(size)


# The generated __init__ takes any keyword to Python's own message, which suggests no name.
OtherModel.__init__ = public(OtherModel.__init__)  # type: ignore[method-assign]

MODEL_NAMES = tuple(field.name for field in fields(OtherModel))
NUMBER_NAMES = tuple(name for name in MODEL_NAMES if name not in ("joined", "belts"))
#: The numbers for which `belts` stands.
BELT_NUMBERS = ("v1", "v2", "mu1", "mu2")
