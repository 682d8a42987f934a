"""Names for types: of what mpmath and sympy ship no types for, and of what callers may hand in."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np

#: A number of mpmath.
Mpf: TypeAlias = Any
#: A float, or a number of mpmath.
Number: TypeAlias = float | Mpf
#: A number, or an array of floats.
Numbers: TypeAlias = "Number | np.ndarray"
#: An mpmath context, as a rule a `symosc.kernels.multiprecision.FixedContext`.
Context: TypeAlias = Any
#: An expression or a set of sympy.
Expr: TypeAlias = Any
#: An exact phase or time: a fraction, or a real constant of sympy.
Angle: TypeAlias = Fraction | Expr
#: What `symosc.exact.read_exact` reads: one of these, or a rational number of sympy or numpy.
NumberLike: TypeAlias = int | float | str | Fraction | Decimal | Any
#: A point of a switching plane: position x and phase theta.
Point: TypeAlias = tuple[Number, Number]
#: Such points in order of time, or an (n, 2) array of them.
Points: TypeAlias = "Sequence[Point] | np.ndarray"
#: Values by name, as JSON and TOML have them.
Record: TypeAlias = dict[str, Any]
