"""The double-belt friction oscillator: parameters, domains, boundaries and forces (eqs. (1) to
(9)).

    m x'' + c x' + k x = A_alpha + B0 cos(Omega t)    in domain Omega_alpha, alpha = 1, 2, 3

A mass is pressed with the force FN between two belts that move with v1 < v2. Below v1 (domain 1)
both belts drag it forward, between the belts (domain 2) they pull against each other, above v2
(domain 3) both hold it back. Boundary 1 is v = v1, boundary 2 is v = v2. docs/reference/glossary.md
explains the words that the code uses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from functools import cached_property
from typing import Any

from symosc.base.aliases import NumberLike
from symosc.base.arguments import NUMBER, public, require
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import show, whole_number
from symosc.base.quantities import QUANTITIES, least, read_number
from symosc.friction import TWO_BELTS, Belt, FrictionLaw


@dataclass(frozen=True, kw_only=True, repr=False)
class Parameters:
    """Parameters of the oscillator, each an exact Fraction.

    Parameters
    ----------
    m, c, k : number
        Mass, damper and spring; m > 0, c >= 0, k >= 0.
    A0, B0, Omega : number
        Constant force, excitation amplitude (any sign) and its angular frequency > 0.
    v1, v2 : number
        Belt speeds, v1 < v2.
    mu1, mu2 : number
        Friction coefficients of belt 1 and belt 2, >= 0. A belt with coefficient 0 is transparent.
    FN : number
        Normal force >= 0.

    Any consistent system of units will do. A number is an int, a float (read as the decimal that it
    prints as), a string such as "0.8" or "4/5", a Fraction, a Decimal or a rational sympy number.
    An expression with pi such as "2*pi" is read to 40 digits, and a quantity such as "2.5 cm"
    (extra `units`) in kg, m, s, N and rad.

    Raises
    ------
    ParameterError
        If a value is not a finite number or is out of range; the message names it.

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
        for name, value in (numbers | {"mu1": mu1, "mu2": mu2, "FN": FN}).items():
            object.__setattr__(self, name, read_number(name, value)[0])
        for name in PARAMETER_NAMES:
            value = getattr(self, name)
            lowest = least(name)
            if lowest is not None and value < lowest:
                tiny = 0 < value < lowest
                if tiny:
                    allowed = f"at least {float(lowest):g}"
                else:
                    allowed = QUANTITIES[name].allowed
                raise ParameterError(name, show(value), f"must be {allowed}")
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
        require(NUMBER, **changes)
        for name, value in changes.items():
            if name not in PARAMETER_NAMES:
                allowed = f"unknown parameter; choose from {', '.join(PARAMETER_NAMES)}"
                raise ParameterError(name, value, allowed + meant(name, PARAMETER_NAMES))
        return Parameters(**by_name(self) | changes)

    def as_dict(self) -> dict[str, str]:
        """Return the parameters as text that reads back exactly."""
        return by_name(self, show)

    @cached_property
    def _law(self) -> FrictionLaw:
        """The friction law of the two belts."""
        return FrictionLaw((Belt(self.v1, self.mu1), Belt(self.v2, self.mu2)), self.FN)

    @public
    def A(self, alpha: int) -> Fraction:
        """Return A_alpha, the constant force in domain `alpha` with friction included (eqs. (1),
        (5)).
        """
        alpha = whole_number("alpha", alpha, 1, len(TWO_BELTS.domains))
        return self.A0 + self._law.force(alpha)

    @public
    def belt(self, boundary: int) -> Fraction:
        """Return the speed v1 or v2 of the belt at `boundary` 1 or 2."""
        boundary = whole_number("boundary", boundary, 1, len(TWO_BELTS.boundaries))
        return self._law.belts[boundary - 1].v

    @public
    def friction(self, boundary: int) -> Fraction:
        """Return mu FN, the force of friction of the belt at `boundary` 1 or 2."""
        boundary = whole_number("boundary", boundary, 1, len(TWO_BELTS.boundaries))
        return self._law.holding(boundary)

    def _repr_latex_(self) -> str:
        """Return the parameters in the paper's letters, for notebooks."""
        terms = r",\; ".join(
            f"{QUANTITIES[name].letter} = {value}" for name, value in self.as_dict().items()
        )
        return f"${terms}$"

    def __repr__(self) -> str:
        return f"Parameters({', '.join(f'{name}={_source(value)}' for name, value in self.as_dict().items())})"


def by_name(
    p: Parameters, number: Callable[[Fraction], Any] = lambda value: value
) -> dict[str, Any]:
    """Return parameters by name, exact or converted by the function `number`."""
    return {name: number(getattr(p, name)) for name in PARAMETER_NAMES}


class OtherNumbers:
    """Parameters that are not Fractions but, for example, columns.

    It has the formulas of `Parameters`.
    """

    A = Parameters.A
    belt = Parameters.belt
    friction = Parameters.friction

    def __init__(self, values: Mapping[str, Any]) -> None:
        vars(self).update(values)
        belts = (Belt(values["v1"], values["mu1"]), Belt(values["v2"], values["mu2"]))
        self._law = FrictionLaw(belts, values["FN"])


def _source(text: str) -> str:
    """Return a number's text as Python source for `Parameters`: in quotes if a float would not read
    as that number.
    """
    # A float is read as the decimal that it prints as; a fraction, or a decimal with more digits,
    # stays text.
    exact = "/" not in text and Fraction(str(float(text))) == Fraction(text)
    if exact:
        return text
    return repr(text)


PARAMETER_NAMES = tuple(field.name for field in fields(Parameters))
