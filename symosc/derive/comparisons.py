"""The values that are compared with published results: each from a formula, and from running this package.

The chapter `literature`, the page docs/literature.md and the tests use the same lists.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

from symosc.derive import published, stops
from symosc.derive.published import MP, Formulas, wall
from symosc.exact import show
from symosc.model import Parameters
from symosc.orbits.floquet import rest_positions
from symosc.simulation.simulate import simulate

#: (c, F, Omega): under-, critically and overdamped too.
AMPLITUDES = (
    ("0", "0.4", "1.5"),
    ("0.2", "0.4", "1.5"),
    ("0.1", "0.25", "0.6"),
    ("2", "0.1", "0.8"),
    ("3", "0.1", "0.7"),
)
#: (c, Omega), and two values of F/P between which the motions without stops end.
BORDERS = (
    ("0", "1.5", "0.646", "0.647"),
    ("0", "0.8", "0.817", "0.818"),
    ("0", "0.3", "0.086", "0.087"),
    ("0.2", "1.5", "0.598", "0.599"),
)
#: Omega, and two values of F/P between which the number of stops per cycle changes.
COUNTS = (
    ("0.1", "0.120", "0.121"),
    ("0.1", "0.373", "0.374"),
    ("0.1", "0.505", "0.506"),
    ("0.1", "0.804", "0.805"),
    ("0.04", "0.263", "0.264"),
    ("0.04", "0.379", "0.380"),
    ("0.04", "0.439", "0.440"),
    ("0.04", "0.457", "0.458"),
)
#: n of Omega = 1/(2 n), F, and the middles of the turning points.
CONTINUA = ((1, "0.1", ("-0.2", "0", "0.1")), (2, "0.02", ("0", "0.04")))
#: A mass that may rest on belt 1, with damping.
RESTING = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)

#: Digits of the orbits, and decimals that are worth printing.
COMPARISON_DIGITS, SHOWN_DECIMALS, SHOWN_BORDER = 30, 12, 7
CLOSED, BORDER, TINY = 1e-12, 1e-7, 1e-4


class Value(NamedTuple):
    """A number computed twice.

    Attributes
    ----------
    name : str
        Its letter, in LaTeX.
    case : str
        The parameters, in LaTeX; those that are not named are 1 (m, k, P, F_N) or 0 (c).
    formula, package : number
    decimals : int
        How many are worth printing.
    tolerance : float
        What the two may differ by, relative to the value.
    said : str
        What else was seen in running.
    """

    name: str
    case: str
    formula: Any
    package: Any
    decimals: int = SHOWN_DECIMALS
    tolerance: float = CLOSED
    said: str = ""

    @property
    def difference(self) -> Any:
        """Formula minus package, relative to the formula's value if that is not 0."""
        formula = number(self.formula)
        return (formula - number(self.package)) / (abs(formula) or 1)


def number(value: Any) -> Any:
    """Return a number of any kind as one of 60 digits."""
    return MP.mpf(value.numerator) / value.denominator if isinstance(value, Fraction) else MP.mpf(value)


def amplitudes() -> list[Value]:
    """Return Den Hartog's amplitudes and those of P32."""
    found = []
    for c, F, Omega in AMPLITUDES:
        p = wall(F, Omega, c)
        highest = max(point.x for point in published.slide_orbit(p, COMPARISON_DIGITS).points)
        found.append(Value("x_0", _damped(c, F, Omega), Formulas(p).amplitude(), highest))
    return found


def multipliers() -> list[Value]:
    """Return sum and product of the multipliers of P32; products that are too small for a table are left out."""
    found = []
    for c, F, Omega in AMPLITUDES:
        p = wall(F, Omega, c)
        one, other = published.slide_orbit(p, COMPARISON_DIGITS).multipliers
        names = (r"\rho_1 + \rho_2", r"\rho_1 \rho_2")
        numbers = zip(names, Formulas(p).trace_and_determinant(), (one + other, one * other), strict=True)
        found += [Value(name, _damped(c, F, Omega), formula, value.real) for name, formula, value in numbers]
    return [value for value in found if abs(value.formula) > TINY]


def borders() -> list[Value]:
    """Return where the motions without stops end."""
    found = []
    for c, Omega, low, high in BORDERS:
        border = stops.find_border(Fraction(low), Fraction(high), Omega, c)
        found.append(_border(rf"$c = {c}$, $\Omega = {Omega}$", Formulas(wall(1, Omega, c)).border(), border))
    return found


def counts() -> list[Value]:
    """Return where other numbers of stops change."""
    found = []
    for Omega, low, high in COUNTS:
        border = stops.find_border(Fraction(low), Fraction(high), Omega)
        found.append(_border(rf"$\Omega = {Omega}$", stops.meeting(Omega, border).ratio, border))
    return found


def growth() -> list[Value]:
    """Return how much a cycle at resonance raises the highest point."""
    found = []
    for F, P in (("0.5", "1"), ("0.3", "0.5")):
        formula = MP.pi * MP.mpf(P) - 4 * MP.mpf(F)
        rises = published.resonance_growth(F, P)
        worst = max(rises, key=lambda rise: abs(MP.mpf(rise) - formula))
        found.append(Value(r"\Delta x", rf"$P = {P}$, $F = {F}$", formula, worst, said=f"{len(rises)} cycles"))
    return found


def decay() -> list[Value]:
    """Return the turning points of a free motion that starts at rest, the last one where it stays."""
    F, start = Fraction(1, 10), Fraction(19, 20)
    found, formula = [], start
    for i, x in enumerate(published.turning_points(wall(F, 1, P=0), start, 0, 40), 1):
        formula = -formula + (2 * F if formula > 0 else -2 * F)
        found.append(Value(f"x_{i}", "$F = 0.1$", formula, x))
    return found


def continuum() -> list[Value]:
    """Return turning points and second multipliers of members of the continua."""
    found = []
    for n, F, middles in CONTINUA:
        half, x_f = 1 / (1 - Fraction(1, 4 * n * n)), Fraction(F)
        for middle in map(Fraction, middles):
            orbit = published.one_sided_orbit(F, n, middle)
            assert orbit.stable is None
            case = rf"$\Omega = 1/{2 * n}$, $F = {F}$, $\bar{{x}} = {show(middle)}$"
            highest, lowest = (point.x for point in orbit.points)
            low, high = (half / (4 * n * n) - x_f) ** 2, (half / (4 * n * n) + x_f) ** 2
            product = (low - middle**2) / (high - middle**2)
            pairs = (middle + half, highest, r"x_{\max}"), (middle - half, lowest, r"x_{\min}")
            for formula, x, name in (*pairs, (product, orbit.multipliers[1].real, r"\rho_2")):
                found.append(Value(name, case, formula, x))
        case = rf"$\Omega = 1/{2 * n}$, $F = {F}$"
        end = half / (4 * n * n) - x_f
        found.append(Value("d_*", case, end, published.one_sided_end(F, n), SHOWN_BORDER, BORDER))
    return found


@cache
def settles_at(start: Fraction, t_end: int = 60) -> float:
    """Return the x at which the mass of `RESTING` is at the end."""
    return float(simulate(RESTING, t0=0, x0=start, v0=0, t_end=t_end)(t_end)[0])


def rests() -> list[Value]:
    """Return the ends of the interval of rests, and where motions from inside of it are after 60 units of time."""
    ends = rest_positions(RESTING, 1)
    assert ends is not None
    p = RESTING
    low, high = (p.A(2) + abs(p.B0)) / p.k, (p.A(1) - abs(p.B0)) / p.k
    found = [Value("x_-", "", low, ends[0]), Value("x_+", "", high, ends[1])]
    return found + [Value("x(60)", f"from ${show(x)}$", x, settles_at(x)) for x in map(Fraction, ("-3/5", "0", "1/2"))]


def _damped(c: str, F: str, Omega: str) -> str:
    return rf"$c = {c}$, $F = {F}$, $\Omega = {Omega}$"


def _border(case: str, formula: Any, border: stops.Border) -> Value:
    said = f"{border.below} stops below, {border.above} above"
    return Value("F/P", case, formula, border.middle, SHOWN_BORDER, BORDER, said)


#: What is compared, with the sources' keys.
TABLES: dict[str, tuple[str, tuple[str, ...], Callable[[], list[Value]]]] = {
    "amplitude": ("Amplitude of the motion without stops", ("denhartog1930", "denhartog1931"), amplitudes),
    "stability": ("Its multipliers", ("shaw1986",), multipliers),
    "border": ("Where motions without stops end", ("denhartog1930", "hongliu2000"), borders),
    "resonance": ("Growth per cycle at resonance", ("denhartog1930",), growth),
    "decay": ("Turning points of a free motion", ("denhartog1930",), decay),
    "stops": ("Where the number of stops per cycle changes", ("hongliu2000",), counts),
    "continuum": (r"Motions around a middle $\bar{x}$", ("csernak2007",), continuum),
    "rests": ("Rest positions on a belt at rest", (), rests),
}


@cache
def table(key: str) -> tuple[Value, ...]:
    """Return the values of one table."""
    return tuple(TABLES[key][2]())
