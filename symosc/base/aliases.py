"""Type aliases: for mpmath and sympy, which ship no types, and for the arguments of public
functions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

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
#: What `symosc.base.exact.read_exact` reads: one of these, or a rational number of sympy or numpy.
NumberLike: TypeAlias = int | float | str | Fraction | Decimal | Any
#: A DataFrame of pandas, which has no types either.
DataFrame: TypeAlias = Any
#: A point of a switching plane: position x and phase theta.
Point: TypeAlias = tuple[Number, Number]
#: Such points in order of time, or an (n, 2) array of them.
Points: TypeAlias = "Sequence[Point] | np.ndarray"
#: Half-widths to which t0, x0 and v0 are known: one number for all, or three.
StartError: TypeAlias = NumberLike | tuple[NumberLike, NumberLike, NumberLike]
#: The name of a shipped scene, or the path of a scene file.
SceneName: TypeAlias = str | Path
#: True: a bar on a terminal. Or what is called with how much is done, and how much there is in all.
Progress: TypeAlias = bool | Callable[[float, float], Any]
#: A solution that somebody computed, of any kind that `symosc.crosschecks.reading.solutions.read_solutions`
#: reads.
SolutionLike: TypeAlias = Any
#: How many of Theorem 7's conditions of order are asked: all, or those that the paper has.
Order: TypeAlias = Literal["full", "paper"]
#: Values by name, as JSON and TOML have them.
Record: TypeAlias = dict[str, Any]
