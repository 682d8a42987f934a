"""The double-belt friction oscillator: parameters, domains, boundaries and forces (eqs. (1) to
(9)).

    m x'' + c x' + k x = A_alpha + B0 cos(Omega t)    in domain Omega_alpha, alpha = 1, 2, 3

A mass is pressed with the force FN between two belts that move with v1 < v2. Below v1 (domain 1)
both belts drag it forward, between the belts (domain 2) they pull against each other, above v2
(domain 3) both hold it back. Boundary 1 is v = v1, boundary 2 is v = v2. docs/reference/glossary.md
explains the words that the code uses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import sqrt
from typing import Any, NamedTuple

from symosc.base.aliases import NumberLike
from symosc.base.arguments import NUMBER, public, require, require_or_none
from symosc.base.display.drawable import Drawable
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import as_source, power_of_ten, show, whole_number
from symosc.base.quantities import (
    QUANTITIES,
    NumberOfBelt,
    check_range,
    number_of_belt,
    quantity_of,
    read_number,
)
from symosc.belts import (
    Belt,
    belt_from,
    belts_named,
    check_order,
    given_by_name,
    numbers_by_name,
    numbers_of_belt,
    read_belts,
)
from symosc.friction import TWO_BELTS, BeltNumbers, FrictionLaw


class Model(Drawable):
    """An oscillator with any friction law: what `Parameters` and `Oscillator` share."""

    _drawn_by = "friction_figure"

    m: Fraction
    c: Fraction
    k: Fraction
    A0: Fraction
    B0: Fraction
    Omega: Fraction
    FN: Fraction
    _law: FrictionLaw

    @property
    def law(self) -> FrictionLaw:
        """The friction law: the belts in order of speed, and the normal force between them."""
        return self._law

    @public
    def A(self, alpha: int) -> Fraction:
        """Return A_alpha, the constant force in domain `alpha` with friction included (eqs. (1),
        (5)).

        Friction that depends on the speed is refused: it has no constant force in a whole domain.
        """
        alpha = whole_number("alpha", alpha, 1, len(self.law.domains))
        if self.law.has_curves:
            raise ParameterError(
                "alpha",
                alpha,
                "the friction depends on the speed, so that no force is constant in a domain; "
                "see `Oscillator.bands`",
            )
        return self.A0 + self.law.force(alpha)

    @public
    def belt(self, boundary: int) -> Fraction:
        """Return the speed of the belt at `boundary`, which is its number from 1 by speed."""
        return self.law.belts[self._number("boundary", boundary) - 1].v

    @public
    def friction(self, boundary: int) -> Fraction:
        """Return mu FN, the kinetic friction of the belt at `boundary`, at the belt's speed."""
        return self.law.kinetic(self._number("boundary", boundary))

    def _number(self, name: str, boundary: int) -> int:
        return whole_number(name, boundary, 1, len(self.law.belts))

    def numbers(self) -> dict[str, Fraction]:
        """Return all parameters by name."""
        raise NotImplementedError

    def given_numbers(self) -> dict[str, Fraction]:
        """Return the numbers that are to be given for this model, by name."""
        return self.numbers()

    @property
    def has_periods(self) -> bool:
        """Whether Omega is given, so that times may be counted in periods of the drive."""
        return True

    @property
    def parameters(self) -> Parameters:
        """The oscillator as the paper's, with two belts; ParameterError if it is another one."""
        raise NotImplementedError

    def replace(self, **changes: Any) -> Model:
        """Return a copy with some parameters changed, for example ``p.replace(c="0.3")``."""
        raise NotImplementedError

    def as_dict(self) -> dict[str, str]:
        """Return the parameters as text that reads back exactly."""
        return {name: show(value) for name, value in self.numbers().items()}


@dataclass(frozen=True, kw_only=True, repr=False)
class Parameters(Model):
    """Parameters of the oscillator, each an exact Fraction.

    Parameters
    ----------
    m, c, k : number
        Mass, damper and spring; m > 0, c >= 0, k >= 0.
    A0, B0, Omega : number
        Constant force, excitation amplitude (any sign) and its angular frequency > 0; optional in
        an `Oscillator`.
    v1, v2 : number
        Belt speeds, v1 < v2.
    mu1, mu2 : number
        Friction coefficients of belt 1 and belt 2, >= 0. A belt with coefficient 0 is transparent.
    FN : number
        Normal force >= 0; optional in an `Oscillator`.

    Raises
    ------
    ParameterError
        If a value is not a finite number or is out of range; the message names it.

    Notes
    -----
    Any consistent system of units will do. A number is an int, a float (read as the decimal that it
    prints as), a string such as "0.8" or "4/5", a Fraction, a Decimal or a rational sympy number.
    An expression with pi such as "2*pi" is read to 40 digits, and a quantity such as "2.5 cm"
    (extra `units`) in kg, m, s, N and rad.

    Examples
    --------
    >>> from symosc import Parameters
    >>> p = Parameters(m=1, c=1, k=1, A0=-15, B0=10, Omega=1, v1=1, v2=5, mu1="4/5", mu2=0.6, FN="9.81")
    >>> p.mu1, p.replace(k="1/3").k
    (Fraction(4, 5), Fraction(1, 3))
    >>> eval(repr(p)) == p
    True
    """

    m: Fraction
    c: Fraction
    k: Fraction
    A0: Fraction
    B0: Fraction
    Omega: Fraction
    v1: Fraction
    v2: Fraction
    mu1: Fraction
    mu2: Fraction
    FN: Fraction

    @public
    def __init__(
        self, *, m: NumberLike, c: NumberLike, k: NumberLike, A0: NumberLike, B0: NumberLike, Omega: NumberLike,
        v1: NumberLike, v2: NumberLike, mu1: NumberLike, mu2: NumberLike, FN: NumberLike,
    ) -> None:  # fmt: skip
        require(
            NUMBER, m=m, c=c, k=k, A0=A0, B0=B0, Omega=Omega, v1=v1, v2=v2, mu1=mu1, mu2=mu2, FN=FN
        )
        numbers = {"m": m, "c": c, "k": k, "A0": A0, "B0": B0, "Omega": Omega, "v1": v1, "v2": v2}
        self._read(numbers | {"mu1": mu1, "mu2": mu2, "FN": FN})

    def _read(self, given: Mapping[str, Any]) -> None:
        """Read numbers that are given by name, all or those that are changed, and check them."""
        for name, value in given.items():
            object.__setattr__(self, name, read_number(name, value)[0])
        for name in given:
            check_range(name, getattr(self, name))
        if self.v1 >= self.v2:
            raise ParameterError("v1", show(self.v1), f"must be less than v2 = {show(self.v2)}")

    def __hash__(self) -> int:
        # Many tables are kept by parameters, and to hash eleven fractions takes as long as an
        # event.
        kept: int | None = self.__dict__.get("_hash")
        if kept is None:
            kept = hash(tuple(getattr(self, name) for name in PARAMETER_NAMES))
            self.__dict__["_hash"] = kept
        return kept

    @public
    def replace(self, **changes: NumberLike) -> Parameters:
        """Return a copy with some parameters changed, for example ``p.replace(c="0.3")``."""
        for name, value in changes.items():
            if name not in PARAMETER_NAMES:
                allowed = f"unknown parameter; choose from {', '.join(PARAMETER_NAMES)}"
                raise ParameterError(name, value, allowed + meant(name, PARAMETER_NAMES))
        require(NUMBER, **changes)
        # What stays has been read: searches and branches change one number thousands of times.
        changed = object.__new__(type(self))
        vars(changed).update(by_name(self))
        changed._read({name: changes[name] for name in PARAMETER_NAMES if name in changes})
        return changed

    def numbers(self) -> dict[str, Fraction]:
        """Return all parameters by name."""
        return by_name(self)

    @property
    def parameters(self) -> Parameters:
        """The parameters themselves, as for an `Oscillator`."""
        return self

    @property
    def oscillator(self) -> Oscillator:
        """The same oscillator as an `Oscillator`, which may have static friction."""
        shared = {name: getattr(self, name) for name in OSCILLATOR_NAMES}
        return Oscillator(**shared, belts=[Belt(self.v1, self.mu1), Belt(self.v2, self.mu2)])

    @cached_property
    def _law(self) -> FrictionLaw:  # type: ignore[override]
        belts = (BeltNumbers(self.v1, self.mu1), BeltNumbers(self.v2, self.mu2))
        return FrictionLaw(belts, self.FN)

    def _repr_latex_(self) -> str:
        """Return the parameters in the paper's letters, for notebooks."""
        terms = r",\; ".join(
            f"{QUANTITIES[name].letter} = {value}" for name, value in self.as_dict().items()
        )
        return f"${terms}$"

    def __repr__(self) -> str:
        return f"Parameters({', '.join(f'{name}={as_source(value)}' for name, value in self.as_dict().items())})"


def by_name(
    p: Parameters, number: Callable[[Fraction], Any] = lambda value: value
) -> dict[str, Any]:
    """Return parameters by name, exact or converted by the function `number`."""
    return {name: number(getattr(p, name)) for name in PARAMETER_NAMES}


class OtherNumbers(Model):
    """Parameters that are not Fractions but, for example, columns.

    It has the formulas of `Parameters`.
    """

    def __init__(self, values: Mapping[str, Any]) -> None:
        vars(self).update(values)
        belts = [
            BeltNumbers(**numbers_of_belt(n, values)) for n in range(1, belts_named(values) + 1)
        ]
        self._law = FrictionLaw(belts, values["FN"])


class Edge(NamedTuple):
    """A speed at which friction jumps, or its slope: that of a belt, or of a corner.

    A corner is where a belt's friction curve has a point, on either side of the belt. The force is
    continuous there, nothing sticks, and no event is reported.

    Attributes
    ----------
    v : Fraction
        The speed.
    J : Fraction
        By how much the force below exceeds the force above: twice the kinetic friction of the belt
        at its speed; 0 at a corner.
    E : Fraction
        By how much static friction exceeds kinetic friction; 0 at a corner.
    belts : tuple of int
        The numbers of the belts with this speed; empty at a corner.

    Examples
    --------
    >>> from symosc import Belt, Oscillator
    >>> (edge,) = Oscillator(m=1, c=0, k=1, FN=2, belts=[Belt(3, mu="1/2", mu_s="3/4")]).edges
    >>> float(edge.v), float(edge.J), float(edge.E), edge.belts
    (3.0, 2.0, 0.5, (1,))

    Friction that falls up to the relative speed 2 has corners at 1 and 5.

    >>> falling = Oscillator(m=1, c=0, k=1, belts=[Belt(3, curve=[(0, "1/2"), (2, "1/4")])])
    >>> [(float(edge.v), float(edge.J), edge.belts) for edge in falling.edges]
    [(1.0, 0.0, ()), (3.0, 1.0, (1,)), (5.0, 0.0, ())]
    """

    v: Fraction
    J: Fraction
    E: Fraction
    belts: tuple[int, ...]


class Band(NamedTuple):
    """A range of velocities with one linear equation m x'' + c x' + k x = A + B0 cos(Omega t).

    Attributes
    ----------
    c, A : Fraction
        Damping and constant force, friction included. Where friction falls with the relative
        speed, c is less than the damping of the oscillator, and may be negative.
    below, above : Fraction or None
        The speeds of the edges that bound the band; None where there is none.

    Examples
    --------
    >>> from symosc import Belt, Oscillator
    >>> bands = Oscillator(m=1, c=0, k=1, belts=[Belt(3, mu="1/2")]).bands
    >>> [(str(band.A), band.below, band.above) for band in bands]
    [('1/2', None, Fraction(3, 1)), ('-1/2', Fraction(3, 1), None)]

    Friction that falls up to the relative speed 2 makes four bands.

    >>> falling = Oscillator(m=1, c=0, k=1, belts=[Belt(3, curve=[(0, "1/2"), (2, "1/4")])])
    >>> [(str(band.c), str(band.A)) for band in falling.bands]
    [('0', '1/4'), ('-1/8', '1/8'), ('-1/8', '-7/8'), ('0', '-1/4')]
    """

    c: Fraction
    A: Fraction
    below: Fraction | None
    above: Fraction | None


#: Notebooks show so many numbers of an oscillator, and messages so many names of them.
MOST_TERMS = 60
#: The numbers of an oscillator beside those of its belts.
OSCILLATOR_NAMES = ("m", "c", "k", "A0", "B0", "Omega", "FN")
#: A missing belt is replaced by one faster, by this factor, than the forces can make the mass in
#: the time 1/Omega or, without a drive, in the time that the free motion takes.
FAR = 10**6


@dataclass(frozen=True, init=False, repr=False)
class Oscillator(Model):
    """A mass between any number of belts, with static friction, and with friction that depends on
    the relative speed, where belts have some.

        m x'' + c x' + k x = A0 + B0 cos(Omega t) + friction of the belts

    Two belts with mu alone make the oscillator of the paper, and the same answers as `Parameters`.
    What cannot follow static friction, friction that depends on speed, or another number of belts,
    refuses it in a line that names the belt.

    Parameters
    ----------
    m, c, k : number
        Mass, damper and spring; m > 0, c >= 0, k >= 0.
    A0, B0 : number, optional
        Constant force, and amplitude of the excitation (any sign).
    Omega : number, optional
        Angular frequency > 0 of the excitation; required unless B0 = 0.
    FN : number, optional
        Normal force >= 0 at each belt. With FN = 1 the coefficients of friction are forces.
    belts : sequence of Belt, such as ``[Belt(1, mu=0.2)]``
        At least one; numbered from 1 by speed, in whatever order they are given.

    Attributes
    ----------
    bands : tuple of Band
        The linear equations between the edges, from below.
    edges : tuple of Edge
        The speeds at which friction or its slope jumps: belts, and corners of their curves.
    contracts : bool
        Whether no two motions move apart. Every theorem about one attracting motion needs E = 0 at
        all belts, which is no static friction beyond the kinetic one, and c >= 0 in all bands.
    parameters : Parameters
        The oscillator as the paper's; ParameterError if it is another one. In place of a second
        belt there is one without friction, too fast to be met.

    Raises
    ------
    ParameterError
        If a number is out of range, if two belts have one speed, if two edges nearly coincide
        (where friction depends on speed), or if Omega is missing.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, simulate
    >>> stick_slip = Oscillator(m=1, c=0, k=1, belts=[Belt("1/5", mu="1/2", mu_s=1)])
    >>> [(event.kind, f"{event.t:.6f}") for event in simulate(stick_slip, v0="1/5", t_end=14).events]
    [('slip', '5.000000'), ('stick', '8.902605'), ('slip', '13.902605')]
    >>> stick_slip.contracts
    False

    The numbers of belts have names, for `replace` and in sweeps: w1_1 and mu1_1 are the first point
    of belt 1's curve after w = 0.

    >>> falling = Oscillator(m=1, c=1, k=1, belts=[Belt(2, curve=[(0, 0.5), (1, 0.2)])])
    >>> falling.replace(mu1_1=0.3, slope1=0.1).belts
    (Belt(2, curve=[(0, 0.5), (1, 0.3)], slope=0.1),)
    >>> float(falling.bands[1].c), falling.contracts
    (0.7, True)
    """

    m: Fraction
    c: Fraction
    k: Fraction
    A0: Fraction
    B0: Fraction
    Omega: Fraction
    FN: Fraction
    belts: tuple[Belt, ...]
    #: Whether Omega was left out, so that there are no periods to count by.
    has_free_clock: bool = field(compare=False)

    @public
    def __init__(
        self, *, m: NumberLike, c: NumberLike, k: NumberLike, A0: NumberLike = 0, B0: NumberLike = 0,
        Omega: NumberLike | None = None, FN: NumberLike = 1, belts: Sequence[Belt],
    ) -> None:  # fmt: skip
        require(NUMBER, m=m, c=c, k=k, A0=A0, B0=B0, FN=FN)
        require_or_none(NUMBER, Omega=Omega)
        given = {"m": m, "c": c, "k": k, "A0": A0, "B0": B0, "Omega": Omega, "FN": FN}
        if Omega is None:
            if read_number("B0", B0)[0] != 0:
                raise ParameterError(
                    "Omega", None, "Omega is required unless B0 = 0: the frequency of the drive"
                )
            given["Omega"] = 1  # nothing depends on it
        for name in OSCILLATOR_NAMES:
            object.__setattr__(self, name, read_number(name, given[name])[0])
            check_range(name, getattr(self, name))
        object.__setattr__(self, "belts", read_belts(belts))
        object.__setattr__(self, "has_free_clock", Omega is None)
        _check_bands(self)

    def __hash__(self) -> int:
        kept: int | None = self.__dict__.get("_hash")
        if kept is None:
            kept = hash(tuple(self.numbers().values()))
            self.__dict__["_hash"] = kept
        return kept

    @cached_property
    def _law(self) -> FrictionLaw:  # type: ignore[override]
        return FrictionLaw(self.belts, self.FN)  # type: ignore[arg-type]

    @property
    def has_periods(self) -> bool:
        """Whether Omega is given, so that times may be counted in periods of the drive."""
        return not self.has_free_clock

    @cached_property
    def edges(self) -> tuple[Edge, ...]:
        """The speeds at which friction or its slope jumps, in order."""
        return tuple(
            Edge(edge.v, edge.J, edge.E, (edge.belt,) if edge.belt else ())
            for edge in self.law.edges
        )

    @cached_property
    def bands(self) -> tuple[Band, ...]:
        """The linear equations between the edges, from below."""
        speeds = [None, *(edge.v for edge in self.law.edges), None]
        bands = []
        for below, above in pairwise(speeds):
            slope, force = self.law.line_between(below, above)
            bands.append(Band(self.c + slope, self.A0 + force, below, above))
        return tuple(bands)

    @property
    def contracts(self) -> bool:
        """Whether no two motions move apart: E = 0 at all belts, and c >= 0 in all bands."""
        return not any(belt.has_static for belt in self.belts) and all(
            band.c >= 0 for band in self.bands
        )

    @property
    def parameters(self) -> Parameters:
        """The oscillator as the paper's, with two belts."""
        for n, belt in enumerate(self.belts, 1):
            if belt.has_static:
                raise ParameterError(
                    "belts",
                    belt,
                    f"static friction of belt {n} (mu_s = {show(belt.mu_s)} > mu = "
                    f"{show(belt.mu)}) cannot be followed here; give mu_s = mu",
                )
            if belt.curve:
                raise ParameterError(
                    "belts",
                    belt,
                    f"friction of belt {n} that depends on speed (its curve or slope) cannot be "
                    "followed here; give mu alone",
                )
        if len(self.belts) > len(TWO_BELTS.boundaries):
            raise ParameterError(
                "belts", self.belts[2], f"belt 3 of {len(self.belts)} is one too many here"
            )
        first, *second = self.belts
        if second:
            v2 = second[0].v
            mu2 = second[0].mu
        else:
            v2 = self._out_of_reach()
            mu2 = Fraction(0)
        shared = {name: getattr(self, name) for name in OSCILLATOR_NAMES}
        return Parameters(**shared, v1=first.v, mu1=first.mu, v2=v2, mu2=mu2)

    def _out_of_reach(self) -> Fraction:
        """Return the speed of a belt that this oscillator cannot meet."""
        (belt,) = self.belts
        forces = abs(self.A0) + abs(self.B0) + belt.mu * self.FN
        return out_of_reach(
            belt.v, abs(belt.v), forces, m=self.m, c=self.c, k=self.k, B0=self.B0, Omega=self.Omega
        )

    def numbers(self) -> dict[str, Fraction]:
        """Return all parameters by name.

        Those of belt 1 are called v1, mu1 and mu_s1. If its friction depends on the relative speed,
        mu1 is the coefficient at w = 0, the points after it are w1_1, mu1_1, w1_2 and so on, and
        slope1 is the slope beyond the last of them.
        """
        numbers = {name: value for name, value in self._shared().items() if value is not None}
        for n, belt in enumerate(self.belts, 1):
            numbers |= numbers_by_name(n, belt)
        return numbers

    def given_numbers(self) -> dict[str, Fraction]:
        """Return what `model_from` reads: all numbers but static coefficients equal to kinetic ones."""
        numbers: dict[str, Fraction] = {name: getattr(self, name) for name in OSCILLATOR_NAMES}
        return numbers | given_by_name(self.belts)

    def _shared(self) -> dict[str, Fraction | None]:
        """Return the numbers beside those of the belts, as they were given."""
        shared: dict[str, Any] = {name: getattr(self, name) for name in OSCILLATOR_NAMES}
        if self.has_free_clock:
            shared["Omega"] = None
        return shared

    @public
    def replace(self, **changes: Any) -> Oscillator:
        """Return a copy with some parameters changed: ``oscillator.replace(c="0.3", mu_s1=2)``.

        The numbers of belts have the names of `numbers`: v1, mu1, mu_s1, v2 and so on, and mu1_2
        or slope1 where friction depends on speed; `belts` replaces all belts. A belt without
        static friction keeps mu_s = mu if only its mu is changed.
        """
        shared = self._shared()
        belts = read_belts(changes.pop("belts", self.belts))
        of_belts = given_by_name(belts)
        known = dict[str, None]()
        for n, belt in enumerate(belts, 1):
            known |= dict.fromkeys([*numbers_by_name(n, belt), str(NumberOfBelt("slope", n))])
        for name, value in changes.items():
            if name in shared:
                shared[name] = value
            elif name in known:
                of_belts[name] = value
            else:
                names = (*self._shared(), *known, "belts")
                allowed = f"unknown parameter; choose from {some(names)}"
                raise ParameterError(name, value, allowed + meant(name, names))
        changed = [belt_from(n, of_belts) for n in range(1, len(belts) + 1)]
        check_order(changed)
        return Oscillator(**shared, belts=changed)

    def _repr_latex_(self) -> str:
        """Return the parameters in the paper's letters, for notebooks."""
        shown = self.given_numbers()
        terms = [
            f"{quantity_of(name).letter} = {text}"
            for name, text in self.as_dict().items()
            if name in shown
        ]
        if len(terms) > MOST_TERMS:
            terms = [*terms[:MOST_TERMS], r"\ldots"]
        joined = r",\; ".join(terms)
        return f"${joined}$"

    def __repr__(self) -> str:
        numbers = ", ".join(
            f"{name}={as_source(show(value))}"
            for name, value in self._shared().items()
            if value is not None
        )
        return f"Oscillator({numbers}, belts={list(self.belts)!r})"


def model_from(numbers: Mapping[str, Any]) -> Model:
    """Return `Parameters` or an `Oscillator` from numbers by the names of `Model.numbers`."""
    if set(numbers) == set(PARAMETER_NAMES):
        return Parameters(**numbers)
    belts = [belt_from(n, numbers) for n in range(1, belts_named(numbers) + 1)]
    check_order(belts)
    shared = {name: numbers[name] for name in OSCILLATOR_NAMES if name in numbers}
    oscillator = Oscillator(**shared, belts=belts)
    known = oscillator.numbers()
    for name in numbers:
        of_belt = number_of_belt(name)
        # a slope 0 of constant friction is no number of the oscillator
        if name not in known and of_belt is not None and of_belt.quantity != "slope":
            raise ParameterError(name, numbers[name], "is a number of no belt, or of no point")
    return oscillator


def some(names: Sequence[str]) -> str:
    """Return names for a message, of very many the first ones."""
    if len(names) <= MOST_TERMS:
        return ", ".join(names)
    return f"{', '.join(names[:MOST_TERMS])} and so on"


#: The narrowest band of velocities, as a part of the largest speed of an edge.
LEAST_BAND = Fraction(1, 10**9)


def _check_bands(oscillator: Oscillator) -> None:
    """Raise ParameterError if two edges of a law that depends on speed nearly coincide."""
    law = oscillator.law
    if law.is_plain:
        return
    edges = law.edges
    least = LEAST_BAND * max(abs(edge.v) for edge in edges)
    for below, above in pairwise(edges):
        if above.v - below.v < least:
            names = " and ".join(
                f"belt {edge.belt}" if edge.belt else f"a corner at {show(edge.v)}"
                for edge in (below, above)
            )
            raise ParameterError(
                "belts",
                list(oscillator.belts),
                f"{names} are {float(above.v - below.v):.3g} apart, less than 1e-9 of the largest "
                "speed; give both the same speed, move them apart, or leave out belts that the mass "
                "never reaches",
            )


def with_section(law: Oscillator, v: Fraction) -> Oscillator:
    """Return an oscillator with a belt at the speed v beside its own, which has no friction: that
    the mass meets it are events.

    Raise ParameterError if the speeds differ too much for it.
    """
    try:
        return law.replace(belts=[*law.belts, Belt(v, mu=0)])
    except ParameterError:
        raise too_fast_error(law) from None


def too_fast_error(law: Model) -> ParameterError:
    """Return the error that a belt is too much faster than others for a section between them."""
    speeds = [belt.v for belt in law.law.belts]
    number = speeds.index(max(speeds, key=abs)) + 1
    return ParameterError(
        f"v{number}",
        show(law.belt(number)),
        f"belt {number} is too fast, compared with the other speeds, for orbits to be found; if "
        "the mass never reaches it, leave it out and give its friction as a constant force A0",
    )


def out_of_reach(
    slowest: Fraction, speeds: Fraction, forces: Fraction, *, m: Fraction, c: Fraction, k: Fraction,
    B0: Fraction, Omega: Fraction,
) -> Fraction:  # fmt: skip
    """Return the speed, far above `slowest`, of a belt that a mass never meets.

    `speeds` and `forces` are sums of all that the mass is subject to.
    """
    # The rate of the drive or, if there is none, of the free motion.
    if B0 == 0 and k > 0:
        pace = Fraction(sqrt(k / m))
    elif B0 == 0 and c > 0:
        pace = c / m
    else:
        pace = Omega
    reached = forces / (m * pace) + speeds
    return slowest + FAR * Fraction(10) ** power_of_ten(reached or Fraction(1))


PARAMETER_NAMES = tuple(field.name for field in fields(Parameters))
