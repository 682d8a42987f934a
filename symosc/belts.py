"""A belt with its friction, as users give it, and the names of its numbers.

Those of belt 1 are called v1, mu1 and mu_s1 wherever all numbers of an oscillator have names. Where
friction depends on the relative speed w, mu1 is the coefficient at w = 0, the points after it are
w1_1, mu1_1, w1_2, mu1_2 and so on, and slope1 is the slope beyond the last of them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from itertools import count, islice, pairwise
from typing import Any, TypeAlias

from symosc.base.aliases import NumberLike
from symosc.base.arguments import (
    NUMBER,
    Kind,
    function_of,
    public,
    require,
    require_or_none,
    row_of,
    sequence_of,
)
from symosc.base.display.drawable import MOST_SHOWN, SHOWN
from symosc.base.errors import ParameterError, meant, shown
from symosc.base.exact import as_source, show, unmasked, whole_number
from symosc.base.quantities import QUANTITIES, NumberOfBelt, check_range, read_number
from symosc.friction import BELT_NAMES, MOST_BELTS

#: Points of a friction curve: as they are given, and exact.
Curve: TypeAlias = Iterable[Sequence[NumberLike] | Any]
Points: TypeAlias = tuple[tuple[Fraction, Fraction], ...]


@dataclass(frozen=True, init=False, repr=False)
class Belt:
    """A belt that presses on the mass: its speed and its friction.

    The mass sticks to the belt while the force that this needs is at most mu_s FN. At equality it
    sticks for as long as it can. Otherwise it slides with the friction mu FN, where mu may depend
    on the relative speed w = |v - v_belt|.

    Parameters
    ----------
    v : number
        Speed of the belt; 0 is a wall.
    mu : number
        Kinetic coefficient of friction, >= 0. A belt with mu = mu_s = 0 is transparent.
    curve : sequence of (w, mu), optional
        The kinetic coefficient over the relative speed, linear between these points, in place of
        `mu`. The first point has w = 0, and w increases from point to point; mu >= 0 may rise and
        fall. An array of shape (n, 2) will do, and so will ``zip(w, mu)``.
    slope : number, optional
        How much the coefficient grows with w beyond the last point of the curve, or from mu on;
        >= 0. With 0 friction is constant there.
    mu_s : number, optional
        Static coefficient of friction, not less than the kinetic one at w = 0. None: equal to it.

    Attributes
    ----------
    mu : Fraction
        The kinetic coefficient at w = 0.
    curve : tuple of (Fraction, Fraction)
        The points of the curve; empty if friction does not depend on the relative speed.

    Raises
    ------
    ParameterError
        If a number is not finite or out of range; the message names it.

    Examples
    --------
    >>> from symosc import Belt
    >>> Belt("0.1", mu="2/5", mu_s="0.7")
    Belt(0.1, mu=0.4, mu_s=0.7)
    >>> falling = Belt(1, curve=[(0, 0.4), (0.5, 0.25)], slope=0.1)
    >>> falling.mu, falling.replace(v=2)
    (Fraction(2, 5), Belt(2, curve=[(0, 0.4), (0.5, 0.25)], slope=0.1))
    """

    v: Fraction
    mu: Fraction
    curve: tuple[tuple[Fraction, Fraction], ...]
    slope: Fraction
    mu_s: Fraction

    @public
    def __init__(
        self,
        v: NumberLike,
        mu: NumberLike | None = None,
        *,
        curve: Curve | None = None,
        slope: NumberLike = 0,
        mu_s: NumberLike | None = None,
    ) -> None:
        for name, value in {"mu": mu, "curve": curve}.items():
            if callable(value):
                allowed = "must not be a function; Belt.from_function(v, mu, until) takes one"
                raise ParameterError(name, value, allowed)
        require(NUMBER, v=v, slope=slope)
        require_or_none(NUMBER, mu=mu, mu_s=mu_s)
        if mu is not None and curve is not None:
            read_number("mu", mu)
            raise ParameterError("curve", curve, "must be omitted if mu is given, or mu omitted")
        points: Points = ()
        if curve is not None:
            points = _read_curve(curve)
            mu = points[0][1]
        if mu is None:
            raise ParameterError(
                "mu", None, "mu is required, or a curve: the kinetic coefficient of friction"
            )
        numbers = {"v": v, "mu": mu, "slope": slope, "mu_s": mu if mu_s is None else mu_s}
        for name, value in numbers.items():
            object.__setattr__(self, name, read_number(name, value)[0])
            check_range(name, getattr(self, name))
        if self.slope and not points:
            points = ((Fraction(0), self.mu),)
        elif len(points) == 1 and not self.slope:
            points = ()  # friction is constant
        object.__setattr__(self, "curve", points)
        if self.mu_s < self.mu:
            at_rest = f"at least mu = {show(self.mu)}"
            if len(points) > 1:
                at_rest += " of the curve at w = 0"
            raise ParameterError("mu_s", show(self.mu_s), f"must be {at_rest}, or be omitted")

    @classmethod
    @public
    def from_function(
        cls,
        v: NumberLike,
        mu: Callable[[float], NumberLike],
        until: NumberLike | Sequence[NumberLike],
        pieces: int = 64,
        mu_s: NumberLike | None = None,
    ) -> Belt:
        """Return a belt whose kinetic coefficient is linear between values of a function.

        Parameters
        ----------
        v : number
            Speed of the belt.
        mu : function
            The kinetic coefficient over the relative speed, called with a float; >= 0. A float
            that it returns is the decimal that it prints as.
        until : number, or several of them
            The relative speed > 0 up to which the law follows the function; beyond it friction is
            constant. Give more than the mass reaches. Or several speeds in order: at each of them
            a piece ends.
        pieces : int, optional
            The number n of straight pieces up to `until`, or from each of several speeds to the
            next. They are narrower at small speeds, where friction bends most: the points are at
            until (i/n)^2. Between several speeds they are narrower at both ends: a part of the way
            of u^2 (3 - 2 u) with u = i/n.
        mu_s : number, optional
            Static coefficient. None: the function's value at 0.

        Returns
        -------
        Belt

        Raises
        ------
        ParameterError
            If the function fails, or returns something else than a number >= 0; with the relative
            speed.

        Notes
        -----
        On a piece of the width h, between until (i/n)^2 and until ((i + 1)/n)^2, the law differs
        from a smooth function by at most h^2/8 max|mu''|. So twice the pieces divide the error by
        four, and so they do with times and positions that depend smoothly on the law.
        `symosc.law_error` says how far these are off. Motions along the piecewise-linear law
        itself are as exact as along any other.

        Points of your own are given by ``curve=``.

        Examples
        --------
        >>> from math import exp
        >>> from symosc import Belt
        >>> falling = Belt.from_function(1, lambda w: 0.25 + 0.25 * exp(-w / 0.5), until=4)
        >>> len(falling.curve), falling.mu, f"{float(falling.curve[-1][1]):.6f}"
        (65, Fraction(1, 2), '0.250084')
        """
        require(NUMBER, v=v)
        require(NUMBER, sequence_of(NUMBER), until=until)
        require(function_of(1), mu=mu)
        require_or_none(NUMBER, mu_s=mu_s)
        pieces = whole_number("pieces", pieces, 1, MOST_POINTS - 1)
        speeds = _speeds_until(until, pieces)
        return cls(v, curve=[(w, _value_at(mu, w)) for w in speeds], mu_s=mu_s)

    @public
    def replace(self, **changes: Any) -> Belt:
        """Return a copy with some numbers changed, or another curve; mu_s stays equal to mu where
        it was.

        mu of a belt with a curve is the coefficient at w = 0; ``replace(curve=None, mu=1)`` leaves
        out the curve.
        """
        known = (*BELT_NAMES, "curve", "slope")
        for name, value in changes.items():
            if name not in known:
                allowed = f"unknown number of a belt; choose from {', '.join(known)}"
                raise ParameterError(name, value, allowed + meant(name, known))
        numbers = self.as_given()
        if "curve" in changes:
            numbers.pop("mu", None)
        elif "mu" in changes and "curve" in numbers:
            mu = changes.pop("mu")
            require(NUMBER, mu=mu)
            number = read_number("mu", mu)[0]
            check_range("mu", number)
            numbers["curve"] = ((Fraction(0), number), *self.curve[1:])
        return Belt(**numbers | changes)

    def as_given(self) -> dict[str, Any]:
        """Return the arguments of which the belt is made; mu_s only where it differs from mu."""
        numbers = {name: getattr(self, name) for name in BELT_NAMES}
        if self.curve[1:]:
            numbers["curve"] = self.curve
            del numbers["mu"]
        if self.slope:
            numbers["slope"] = self.slope
        if not self.has_static:
            del numbers["mu_s"]
        return {name: numbers[name] for name in _AS_WRITTEN if name in numbers} | numbers

    @property
    def has_static(self) -> bool:
        """Whether static friction exceeds kinetic friction."""
        return self.mu_s > self.mu

    def _repr_latex_(self) -> str:
        """Return the belt in the paper's letters, for notebooks."""
        numbers = self.as_given()
        terms = [
            f"{QUANTITIES[name].letter} = {show(value)}"
            for name, value in numbers.items()
            if name != "curve"
        ]
        if "curve" in numbers:
            points = [rf"({show(w)}, {show(mu)})" for w, mu in self.curve]
            if len(points) > MOST_SHOWN:
                points = [*points[:SHOWN], r"\ldots", points[-1]]
            terms.insert(1, rf"(w, \mu) = {', '.join(points)}")
        joined = r",\; ".join(terms)
        return f"${joined}$"

    def __repr__(self) -> str:
        numbers = dict[str, str]()
        for name, value in self.as_given().items():
            if name == "curve":
                points = (f"({as_source(show(w))}, {as_source(show(mu))})" for w, mu in value)
                numbers[name] = f"[{', '.join(points)}]"
            else:
                numbers[name] = as_source(show(value))
        speed, *others = (f"{name}={text}" for name, text in numbers.items())
        return f"Belt({', '.join([speed.removeprefix('v='), *others])})"


BELTS = Kind(
    "a sequence of Belt objects, such as [Belt(1, mu=0.2)]", by_value=sequence_of(Belt).takes
)
#: The order in which the arguments of a belt are written.
_AS_WRITTEN = ("v", "mu", "curve", "slope", "mu_s")
#: The most points of a friction curve.
MOST_POINTS = 10_001
A_CURVE = "must be points (w, mu), such as [(0, 0.4), (0.5, 0.25)]"


def _speeds_until(until: Any, pieces: int) -> list[Fraction]:
    """Return the relative speeds at which the straight pieces of a law end, from 0 on."""
    if sequence_of(NUMBER).takes(until):
        ends = [read_number(f"until[{i}]", end)[0] for i, end in enumerate(until)]
    else:
        ends = [read_number("until", until)[0]]
    if not ends or ends[0] <= 0:
        raise ParameterError("until", until, "must be > 0")
    for before, end in pairwise(ends):
        if end <= before:
            raise ParameterError("until", until, "must be speeds in order")
    parts = [Fraction(i, pieces) for i in range(1, pieces + 1)]
    if not sequence_of(NUMBER).takes(until):
        return [Fraction(0), *(ends[0] * part**2 for part in parts)]
    return [
        Fraction(0),
        *(
            begin + (end - begin) * part**2 * (3 - 2 * part)
            for begin, end in pairwise([Fraction(0), *ends])
            for part in parts
        ),
    ]


def _read_curve(curve: Any) -> Points:
    """Return the points of a friction curve, as a user gives it, as exact numbers."""
    unmasked("curve", curve)
    if hasattr(type(curve), "__next__"):  # such as zip(w, mu)
        curve = list(islice(curve, MOST_POINTS + 1))
    if not sequence_of(row_of(2)).takes(curve):
        allowed = A_CURVE
        if row_of(2, sequence_of(NUMBER)).takes(curve):
            allowed += "; make them of columns by zip(w, mu)"
        raise ParameterError("curve", curve, allowed)
    if len(curve) == 0:
        raise ParameterError("curve", curve, A_CURVE)
    if len(curve) > MOST_POINTS:
        raise ParameterError(
            "curve", f"{len(curve)} points", f"must have at most {MOST_POINTS} points"
        )
    try:
        return _read_points(curve)
    except ParameterError as error:
        name, _, i = error.name.partition("_")
        w, mu = curve[int(i)]
        subject = f"{name} of the point ({shown(w)}, {shown(mu)})"
        raise ParameterError("curve", curve, _sentence(subject, error.allowed)) from None


def _read_points(points: Any) -> Points:
    """Return the points of a friction curve as exact numbers.

    Errors call the numbers of a point w_1 and mu_1, from 0 on.
    """
    exact = list[tuple[Fraction, Fraction]]()
    for i, point in enumerate(points):
        numbers = dict[str, Fraction]()
        for name, value in zip(("w", "mu"), point, strict=True):
            try:
                require(NUMBER, **{name: value})
                numbers[name] = read_number(name, value)[0]
                check_range(name, numbers[name])
            except ParameterError as error:
                raise ParameterError(f"{name}_{i}", error.value, error.allowed) from None
        w = numbers["w"]
        if not exact and w != 0:
            raise ParameterError("w_0", show(w), "must be 0 at the first point")
        if exact and w <= exact[-1][0]:
            allowed = f"must be greater than {show(exact[-1][0])}, that of the point before"
            if w == 0:
                allowed += "; static friction is given by mu_s"
            raise ParameterError(f"w_{i}", show(w), allowed)
        exact.append((w, numbers["mu"]))
    return tuple(exact)


def _value_at(function: Callable[[float], Any], w: Fraction) -> Fraction:
    """Return the value of a friction curve that a user gives as a function."""
    speed = float(w)
    try:
        value = function(speed)
    except Exception as error:  # whatever a user's function raises
        reason = f"{type(error).__name__}: {error}".removesuffix(": ")
        raise ParameterError("mu", function, f"fails at w = {speed:g} with {reason}") from error
    try:
        require(NUMBER, mu=value)
        number = read_number("mu", value)[0]
        check_range("mu", number)
    except ParameterError as error:
        subject = f"its value {shown(value)} at w = {speed:g}"
        raise ParameterError("mu", function, _sentence(subject, error.allowed)) from None
    return number


def _sentence(subject: str, allowed: str) -> str:
    """Return what is allowed of a part of an argument, as a part of a message."""
    if allowed.startswith("must"):
        return f"{subject} {allowed}"
    return f"{subject}: {allowed}"


def belts_named(names: Collection[str]) -> int:
    """Return how many belts the names v1, v2 and so on among `names` are of."""
    return next(n for n in count() if f"v{n + 1}" not in names)


def numbers_of_belt(number: int, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of one belt by the names of `BeltNumbers`, from values by those of
    `Model.numbers`.
    """
    names = {name: str(NumberOfBelt(name, number)) for name in (*BELT_NAMES, "slope")}
    numbers = {name: values[numbered] for name, numbered in names.items() if numbered in values}
    points = list[tuple[Any, Any]]()
    for i in count(1):
        w = str(NumberOfBelt("w", number, i))
        mu = str(NumberOfBelt("mu", number, i))
        if w not in values and mu not in values:
            break
        for name, partner in ((w, mu), (mu, w)):
            if name not in values:
                raise ParameterError(name, None, f"{name} is required beside {partner}")
        points.append((values[w], values[mu]))
    if (points or "slope" in numbers) and "mu" in numbers:
        numbers["curve"] = ((Fraction(0), numbers["mu"]), *points)
    return numbers


def numbers_by_name(n: int, belt: Belt) -> dict[str, Fraction]:
    """Return the numbers of belt n by the names of `Model.numbers`."""
    numbers = {NumberOfBelt(name, n): getattr(belt, name) for name in BELT_NAMES}
    for i, (w, mu) in enumerate(belt.curve[1:], 1):
        numbers[NumberOfBelt("w", n, i)] = w
        numbers[NumberOfBelt("mu", n, i)] = mu
    if belt.curve:
        numbers[NumberOfBelt("slope", n)] = belt.slope
    return {str(name): value for name, value in numbers.items()}


def given_by_name(belts: Sequence[Belt]) -> dict[str, Fraction]:
    """Return the numbers of belts by name, without static coefficients equal to kinetic ones."""
    numbers = dict[str, Fraction]()
    for n, belt in enumerate(belts, 1):
        numbers |= numbers_by_name(n, belt)
        if not belt.has_static:
            del numbers[str(NumberOfBelt("mu_s", n))]
    return numbers


def belt_from(n: int, values: Mapping[str, Any]) -> Belt:
    """Return belt n from values by the names of `Model.numbers`, which errors use."""
    numbers = numbers_of_belt(n, values)
    with _named_after_belt(n):
        if "curve" in numbers:
            numbers["curve"] = _read_points(numbers["curve"])
            del numbers["mu"]
        return Belt(**numbers)


def check_order(belts: Sequence[Belt]) -> None:
    """Raise ParameterError unless the speeds v1, v2 and so on increase."""
    for n, (lower, upper) in enumerate(pairwise(belts), 1):
        if lower.v >= upper.v:
            raise ParameterError(
                f"v{n}", show(lower.v), f"must be less than v{n + 1} = {show(upper.v)}"
            )


@contextmanager
def _named_after_belt(n: int) -> Iterator[None]:
    """Call the numbers of belt n v1, mu1, mu1_2 and so on in a ParameterError."""
    try:
        yield
    except ParameterError as error:
        name, _, point = error.name.rpartition("_")
        if point.isdecimal():
            number = NumberOfBelt(name, n, int(point))
        else:
            number = NumberOfBelt(error.name, n)
        raise ParameterError(str(number), error.value, error.allowed) from None


def read_belts(belts: Any) -> tuple[Belt, ...]:
    """Return belts in order of their speeds."""
    if isinstance(belts, Belt):
        belts = (belts,)
    require(BELTS, belts=belts)
    if len(belts) == 0:
        raise ParameterError("belts", belts, "must have at least one Belt")
    if len(belts) > MOST_BELTS:
        raise ParameterError("belts", f"{len(belts)} of them", f"must be at most {MOST_BELTS}")
    in_order = tuple(sorted(belts, key=lambda belt: belt.v))
    for n, (lower, upper) in enumerate(pairwise(in_order), 1):
        if lower.v == upper.v:
            raise ParameterError(
                "belts",
                upper,
                f"belts {n} and {n + 1} both have the speed {show(upper.v)}; make them one belt, "
                "with the sum of their coefficients",
            )
    return in_order
