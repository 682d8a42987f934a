"""Motion within one domain, and on a belt: the constants of parameter sets and the evaluation of
the flow.

This file is executed with other globals: see symosc/kernels/rebind.py.

Everything is divided by the mass. A flight starts at the phase theta with position x0, velocity v0
and acceleration F0; the displacement dx, the gain in velocity dv and the acceleration F after a
time tau are the kernel `motion` of the entire functions at tau: E1, the response to an impulse, its
derivative E0, its integral E2, and R2 + i I2, the response to the drive (`symosc.kernels.entire`).
Gains are returned rather than sums: a flight that starts on a belt leaves it by dv exactly.

The constants of many sets are made at once, from columns of pairs (`symosc.kernels.pair_columns`),
as the rows of a table with the fields of `Constants`: compiled functions take either.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import lru_cache
from math import atan2, inf, pi, sqrt
from typing import Any, NamedTuple, get_type_hints

import numpy as np

from symosc.base.aliases import Number
from symosc.engine.state import Flown
from symosc.friction import EdgeOfLaw
from symosc.kernels._generated import acceleration, motion, next_derivative
from symosc.kernels.elementary import cos, exp, select, sin
from symosc.kernels.entire import SIXTH, basis
from symosc.kernels.pair_columns import (
    PairColumn,
    angle_of_columns,
    as_double,
    atan2_of_columns,
    either,
    exactly,
    larger,
    root_of_columns,
    sign,
)
from symosc.kernels.pair_programs import Program, Recorder, flat
from symosc.kernels.rebind import outlined
from symosc.model import Model, OtherNumbers

# Steady state and transient are separated (in bounds, and in the closed form) when |i Omega - l1|
# |i Omega - l2| is at least this part of max(Omega, w0)^2. Nearer to undamped resonance both grow
# without limit and cancel.
APART = Fraction(1, 5)
# The longest time that is evaluated from one starting point, times the rate of the free motion.
LONGEST_PHASE = 50
LONGEST_SWING = 10**9  # `Constants.swing`, times `rate`, without a spring
# Forcing periods that are passed in one evaluation, at most: their number is a whole number of 64
# bits.
MOST_TURNS = 2.0**60
# A free motion is over after LONGEST_PHASE of its decay times, and heavily damped when that are few
# of its periods.
HEAVY = 50
SLOW_DRIVE = 100  # a drive is slow if the free motion is this many times as fast
# A free oscillation that loses less than a twentieth of its velocity per radian.
LASTING = 400
# Roots this many times as large as all other rates make a system stiff.
STIFF = 16
# In a band with negative damping nothing is evaluated for longer than this from one starting point,
# times 1/|h|. A search goes on for at most 5/8 of it beyond (`apart_from_walls`), in which the free
# motion grows by less than exp(2 * 0.35 * 1.625) = 3.1.
LONGEST_GROWTH = Fraction(7, 20)
GROWTH = 4
SIGMAS = Fraction(8)  # standard errors of the state that a decision must exceed
# The step of the march along a flight near a wall, times `rate`.
MARCH_STEP = 1.0
# The longer step away from walls: about what a bound of the fourth derivative allows in mid-flight.
STRIDE = 2.0
# The same if the drive is more than SLOW times as slow as `rate`: once the transient has died away
# nothing moves as fast as that.
SLOW_STRIDE = 4.0
SLOW = 5.0
# Numbers between these sizes neither overflow nor underflow in any product on the way.
SMALLEST_IN_COLUMNS = 1e-20
LARGEST_IN_COLUMNS = 1e20


class BeltConstants(NamedTuple):
    """Constants of a stick on one belt.

    Along it both forces F obey m dF/dt = -(k v + B0 Omega sin(theta)).
    """

    v: Number  # speed of the belt, or of the corner; infinite where there is no such belt
    J: Number  # F^(below) - F^(above) = 2 mu FN/m
    E: Number  # by how much static friction exceeds kinetic friction: (mu_s - mu) FN/m
    hold: Number  # J + 2 E, the width of the range of forces that hold the mass
    drift: Number  # -(k/m) v, the mean slope of both forces
    turns: bool  # whether the slope changes sign, at sin(theta) = s_cr
    s_cr: Number
    c_cr: Number  # +sqrt(1 - s_cr^2)
    angle: Number  # asin(s_cr) in (-pi/2, pi/2)
    # signs of F^(below) and F^(above) on the belt without spring and drive: of A_alpha - c v
    limit_below: Number
    limit_above: Number
    is_corner: bool  # whether only the slope of the friction changes here
    # whether a motion that is over rests on this corner: there is no drive, its speed is 0, and
    # motions near it do not grow
    is_rest: bool


class MarchConstants(NamedTuple):
    """The coefficients that carry the transient and the steady state of a flight over one fixed
    step.

    They are the matrix ((C, E1), (D, E0)) for velocity and acceleration of the transient, and the
    turn of the phase.
    """

    step: Number
    C: Number  # transient velocity from transient velocity: 1 - (k/m) E2
    E1: Number  # transient velocity from transient acceleration
    D: Number  # transient acceleration from transient velocity: -(k/m) E1
    E0: Number  # transient acceleration from transient acceleration
    s: Number  # sine and cosine of Omega step
    c: Number


class Constants(NamedTuple):
    """The numbers that the engine computes from a parameter set, correctly rounded: floats or
    mpmath numbers.
    """

    # Units: 1/time for cm, h, omega_d, w0, Om and the roots; acceleration for f0 and A1 to A3;
    # velocity for V0.

    cm: Number  # c/m
    w0sq: Number  # k/m
    f0: Number  # B0/m
    Om: Number  # Omega
    beat: Number  # Omega; without a drive, where Omega means nothing, the rate of the free motion
    driven: bool  # whether B0 is not 0
    fB: Number  # B0 Omega/m
    h: Number  # c/(2m)
    omega_d: Number  # sqrt(|k/m - h^2|), the damped frequency
    w0: Number  # sqrt(k/m)
    p: Number  # k/m - Omega^2
    q: Number  # 2 h Omega
    detuning: Number  # imaginary part of l1 - i Omega
    l1: Number  # slow root, when not underdamped
    l2: Number  # fast root, when not underdamped
    rate0: Number  # larger |root|
    rate: Number  # max(rate0, Omega)
    moment: Number  # 1/rate
    # 1/w0, how long a velocity counts for the position; LONGEST_SWING/rate without a spring
    swing: Number
    under: bool  # underdamped
    apart: bool  # underdamped and far from resonance: the cheap closed form is accurate
    creeps: bool  # no drive and no oscillation: a motion may come to rest without ever arriving
    lasting: bool  # no spring, or so little damping that errors of many flights add up
    slow_drive: bool  # the drive is much slower than the free motion
    stiff: bool  # overdamped, with a free motion that is over long before anything else has moved
    steady: bool  # far from resonance: steady state and transient may be bounded one by one
    # how much a free motion may grow in one search: 1, or GROWTH with negative damping
    growth: Number
    # whether the law has a row of constants for each of its bands; then a motion is in the middle
    # domain of its row, number `row`, which is a part of the domain `shift` + 2 of the law
    banded: bool
    row: int
    shift: int
    A1: Number  # A_alpha/m
    A2: Number
    A3: Number
    V0: Number  # amplitude of the steady velocity, when `steady`
    Ss: Number  # steady velocity = Ss sin(theta) + Sc cos(theta), when `steady`
    Sc: Number
    period: Number  # 2 pi/Omega
    # (Om - Omega)/Omega: by how much a time that is a phase over Om is too small; see `clock_time`
    Om_gain: Number
    period_low: Number  # what the rounding of 2 pi/Om took from `period`
    chunk: Number  # longest time that is evaluated from one starting point
    sigmas: Number  # how many standard errors of the state a decision must exceed
    belt1: BeltConstants
    belt2: BeltConstants
    march: MarchConstants
    stride: MarchConstants


NESTED: dict[str, Any] = {
    "belt1": BeltConstants,
    "belt2": BeltConstants,
    "march": MarchConstants,
    "stride": MarchConstants,
}


def _row_type(kind: Any, types: dict[Any, Any], number: Any) -> np.dtype[Any]:
    """Return the numpy row type for a NamedTuple, also for those nested in it.

    An entry has the type that `types` has for its annotation, or else `number`.
    """
    entries = list[tuple[str, Any]]()
    for name, annotation in get_type_hints(kind).items():
        if name in NESTED:
            entries.append((name, _row_type(NESTED[name], types, number)))
        else:
            entries.append((name, types.get(annotation, number)))
    return np.dtype(entries)


# Flags and whole numbers are doubles here.
ROW = _row_type(Constants, {}, np.float64)
# Constants in double-double numbers: hi + lo stored as the complex number hi + i lo.
PAIR_CONSTANTS = _row_type(Constants, {bool: np.bool_, int: np.int64}, np.complex128)


def constants(
    parameters: Model,
    number: Callable[[Any], Number] = float,
    root: Callable[[Number], Number] = sqrt,
    angle: Callable[[Number, Number], Number] = atan2,
    pi: Number = pi,
    driven: Any = None,
    row: int = 0,
) -> Constants:
    """Return a row of the constants of `parameters`, rounded once by `number`.

    `root`, `angle`: sqrt, atan2 of such numbers. `driven` is True for derivatives by B0, which
    depend on Omega where B0 = 0 too; None: whether B0 is not 0. `row` is a number in `law.rows`.
    """
    # `number` is ``float``, or a conversion to mpmath. Parameters may be columns of pairs
    # (`constant_table`): then the constants are arrays, and so `either` and `flag ^ True` stand for
    # conditional expressions and `not`.
    law = parameters.law
    of_row = law.rows[row]
    c = law.damping(parameters.c, row)
    m = parameters.m
    Om = parameters.Omega
    h = c / (2 * m)
    w0sq = parameters.k / m
    f0 = parameters.B0 / m
    omega = number(Om)
    zero = number(Fraction(0))
    doubles = isinstance(pi, float)
    period = 2 * pi / omega
    if driven is None:
        driven = parameters.B0 != 0
    # The free motion: its roots, frequencies and rates.
    square = w0sq - h * h
    under = square > 0
    omega_d = root(number(abs(square)))
    w0 = root(number(w0sq))
    over = under ^ True
    # Without oscillation: the product of both roots is w0sq, so that nothing cancels in the slow one.
    grows = h < 0
    fast = either(grows, omega_d - number(h), -(number(h) + omega_d))
    slow = number(w0sq) / either(fast != 0, fast, 1)  # fast = 0 only where w0sq = 0
    rate0 = either(under, w0, abs(fast))
    moves = rate0 > 0
    # Without a drive nothing depends on Omega but the phase: where steps, limits and formulas ask
    # for a frequency of the drive it is 0, and where they divide by it the rate of the free motion.
    beat = either(driven | (moves ^ True), omega, rate0)
    pull = either(driven, Om, Fraction(0))
    rate = larger(rate0, beat)
    # The steady motion, which is of use if p^2 + q^2 is large enough.
    drive = f0 * Om
    p = w0sq - pull * pull
    q = 2 * h * pull
    size = p * p + q * q
    steady = size >= (APART * larger(w0sq, pull * pull)) ** 2
    response = number(either(steady & (size != 0), size, Fraction(1)))
    # The longest time to evaluate from one starting point: a forcing period, with two exceptions.
    # The phase of a free oscillation is known to rate * time ulp: that must not grow without need,
    # unless the oscillation is over long before. Without a drive a motion is evaluated until it is
    # over; the count of phases must stay a whole number.
    is_over = (w0 < HEAVY * number(h)) & (number(h) * period > LONGEST_PHASE)
    longest = LONGEST_PHASE / either(moves, rate0, 1)
    swinging = either(is_over, period, either(longest < period, longest, period))
    most = MOST_TURNS * period
    fades = either(slow < 0, LONGEST_PHASE / either(slow < 0, -slow, 1), most)
    free = either(under, longest, fades)
    chunk = either(driven, either(under, swinging, period), either(free < most, free, most))
    tamed = number(LONGEST_GROWTH) / either(grows, -number(h), 1)
    chunk = either(grows & (tamed < chunk), tamed, chunk)
    if doubles:
        Om_gain = number(either(driven, exactly(omega) - Om, Fraction(0))) / omega
        period_low = number(_period_rest(period, omega))
    else:
        Om_gain = zero
        period_low = zero
    return Constants(
        cm=number(2 * h),
        w0sq=number(w0sq),
        f0=number(f0),
        Om=omega,
        beat=beat,
        driven=driven,
        fB=number(drive),
        h=number(h),
        omega_d=omega_d,
        w0=w0,
        p=number(p),
        q=number(q),
        detuning=either(under, number(square - Om * Om) / (omega_d + omega), -omega),
        l1=slow,
        l2=fast,
        rate0=rate0,
        rate=rate,
        moment=1 / rate,
        swing=either(w0sq != 0, 1 / either(w0 > 0, w0, 1), LONGEST_SWING / rate),
        under=under,
        apart=under & steady,
        creeps=over & (driven ^ True),
        lasting=either(under, w0sq > LASTING * h * h, w0sq == 0) | grows,
        slow_drive=rate0 > SLOW_DRIVE * beat,
        stiff=steady & over & (-fast > STIFF * larger(-slow, number(pull))),
        steady=steady,
        growth=either(grows, number(Fraction(GROWTH)), number(Fraction(1))),
        banded=not law.is_plain,
        row=row,
        shift=of_row.domain - 2,
        A1=number((parameters.A0 + of_row.forces[0]) / m),
        A2=number((parameters.A0 + of_row.forces[1]) / m),
        A3=number((parameters.A0 + of_row.forces[2]) / m),
        V0=either(steady, abs(number(drive)) / root(response), zero),
        Ss=number(-drive * p) / response,
        Sc=number(drive * q) / response,
        period=period,
        Om_gain=Om_gain,
        period_low=period_low,
        chunk=chunk,
        sigmas=number(SIGMAS),
        belt1=_belt_constants(parameters, row, 1, number, root, angle),
        belt2=_belt_constants(parameters, row, 2, number, root, angle),
        march=MarchConstants(*[zero] * 7),
        stride=MarchConstants(*[zero] * 7),
    )


def with_march(K: Constants, basis: Callable[[Number, Constants], tuple[Number, ...]]) -> Constants:
    """Return K with the coefficients that carry a flight over a fixed step: `march`, and the longer
    `stride`.
    """
    march, stride = (
        MarchConstants(*march_constants(step, basis(step, K), K)) for step in march_steps(K)
    )
    return K._replace(march=march, stride=stride)


def march_steps(K):
    """Return the lengths of both fixed steps along a flight: the usual step, and the longer stride."""
    return MARCH_STEP / K.rate, (SLOW_STRIDE if K.rate > SLOW * K.beat else STRIDE) / K.rate


@outlined
def march_rows(table, out):
    """Write the coefficients of both fixed steps for each parameter set of `table` into `out`,
    (sets, 2, fields).
    """
    for i in range(out.shape[0]):
        K = table[i]
        for which in range(2):  # the usual step, then the stride
            step = march_steps(K)[which]
            entries = march_constants(step, basis(step, K), K)
            for n in range(7):  # the fields of MarchConstants
                out[i, which, n] = entries[n]


def march_constants(step, functions, K):
    """Return the numbers of a MarchConstants in the order of its fields: step, C, E1, D, E0, s, c.

    `functions` are E0, E1, E2, R2, I2, sin and cos of `basis` at the time `step`.
    """
    # A plain tuple: `march_rows` writes its entries into a table by their numbers.
    E0, E1, E2, _, _, s, c = functions
    C = 1 - K.w0sq * E2
    D = -K.w0sq * E1
    return step, C, E1, D, E0, s, c


def _period_rest(period: float, Om: float) -> Fraction:
    """Return the rounding error of a period, 2 pi/Om - period, where Om and period are doubles."""
    # what rounding took from the double 2 pi is added back
    two_pi = Fraction(2.0 * pi) + Fraction(2.4492935982947064e-16)
    return (two_pi - exactly(Om) * exactly(period)) / exactly(Om)


def _belt_constants(
    parameters: Model, row: int, boundary: int, number: Any, root: Any, angle: Any
) -> BeltConstants:
    """Return the constants of a stick on the edge below (`boundary` 1) or above (2) the middle
    domain of a row.

    `number`, `root`, `angle` are as in `constants`.
    """
    of_row = parameters.law.rows[row]
    edge = (of_row.below, of_row.above)[boundary - 1]
    if edge is None:
        return no_belt(boundary, number)
    v = edge.v
    J = edge.J / parameters.m
    E = edge.E / parameters.m
    c = parameters.law.damping(parameters.c, row)
    # Signs, as the forces themselves may be too small for a double.
    below, above = (
        number(sign(parameters.A0 + force - c * v))
        for force in of_row.forces[boundary - 1 : boundary + 1]
    )
    pull = -parameters.k * v
    drive = parameters.B0 * parameters.Omega
    turns = abs(pull) < abs(drive)  # with equality the slope touches 0 and keeps its sign
    sine = either(turns, pull / either(turns, drive, Fraction(1)), Fraction(0))
    s_cr = number(sine)
    c_cr = root(number(1 - sine * sine))
    return BeltConstants(
        v=number(v),
        is_corner=edge.belt == 0,
        is_rest=edge.belt == 0 and v == 0 and _fades_at(parameters, edge),
        J=number(J),
        E=number(E),
        hold=number(J + 2 * E),
        drift=number(pull / parameters.m),
        turns=turns,
        s_cr=s_cr,
        c_cr=c_cr,
        angle=angle(s_cr, c_cr),
        limit_below=below,
        limit_above=above,
    )


def _fades_at(parameters: Model, edge: EdgeOfLaw) -> bool:
    """Return whether motions near the equilibrium on a corner at the speed 0 do not grow."""
    if parameters.B0 != 0 or parameters.k == 0:
        return False
    smaller, larger = sorted(
        parameters.law.damping(parameters.c, n)
        for n, row in enumerate(parameters.law.rows)
        if edge in (row.below, row.above)
    )
    if smaller >= 0:
        return True
    # With c_j^2 < 4 m k half a turn takes the factor exp(-pi c_j/sqrt(4 m k - c_j^2)), and the
    # product of both factors is below 1 where the sum of the c_j is positive. Without a turn on the
    # growing side a motion there does not come back.
    return smaller**2 < 4 * parameters.m * parameters.k and smaller + larger > 0


def no_belt(boundary: int, number: Callable[[Any], Number]) -> BeltConstants:
    """Return the constants in place of an edge where there is none: it is out of reach, below
    (`boundary` 1) or above (2), at any velocity.
    """
    zero = number(Fraction(0))
    one = number(Fraction(1))
    return BeltConstants(
        v=(-inf if boundary == 1 else inf) + zero,
        is_corner=False,
        is_rest=False,
        J=zero,
        E=zero,
        hold=zero,
        drift=zero,
        turns=False,
        s_cr=zero,
        c_cr=one,
        angle=zero,
        limit_below=zero,
        limit_above=zero,
    )


class ConstantRows(Sequence[Constants]):
    """A table of constants for interpreted code: indexing returns a row as `Constants` with
    Python's floats.
    """

    def __init__(self, table: np.ndarray) -> None:
        self.table = table
        self._last: tuple[int, Constants] | None = None

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, i: Any) -> Any:
        if self._last is None or self._last[0] != i:
            values = dict(zip(Constants._fields, self.table[i].item(), strict=True))
            for name, kind in NESTED.items():
                values[name] = kind(*values[name])
            self._last = int(i), Constants(**values)
        _, row = self._last
        return row


def table_of(rows: Iterable[Constants]) -> np.ndarray:
    """Return a table with a row for each of the given constants."""
    return np.array([tuple(row) for row in rows], dtype=ROW)


def pair_table_of(rows: Iterable[Constants]) -> np.ndarray:
    """Return a table with a row for each of the given constants of complex numbers hi + i lo."""
    return np.array([tuple(row) for row in rows], dtype=PAIR_CONSTANTS)


def constants_in(row: np.void) -> Constants:
    """Return a row of a table as Constants of Python's numbers."""
    numbers = dict(zip(Constants._fields, row.item(), strict=True))
    for name, kind in NESTED.items():
        numbers[name] = kind._make(numbers[name])
    return Constants(**numbers)


class TableLoops(NamedTuple):
    """The functions that compute the rows of a table of constants: `march_rows`, compiled or not,
    and `run_program`, compiled (None: columns of numpy instead).
    """

    march_rows: Callable[..., None]
    run_program: Callable[..., None] | None


def constant_table(
    columns: dict[str, PairColumn],
    count: int,
    alone: Callable[[int], Constants],
    loops: TableLoops,
) -> np.ndarray:
    """Return a table of the constants of `count` parameter sets, computed from columns of
    double-double numbers.

    `alone` returns the constants of a set that needs more digits.
    """
    doubts = np.zeros(count, dtype=bool)
    for column in columns.values():
        size = abs(column.hi)
        doubts |= (size != 0.0) & ~((size >= SMALLEST_IN_COLUMNS) & (size <= LARGEST_IN_COLUMNS))
    table = np.zeros(count, dtype=ROW)
    if loops.run_program is None:
        _fill_by_columns(table, columns, doubts)
    else:
        _fill_by_program(table, columns, doubts, loops.run_program)
    for i in np.flatnonzero(doubts).tolist():
        table[i] = tuple(alone(i))
    marches = np.zeros((count, 2, len(MarchConstants._fields)))
    loops.march_rows(table, marches)
    for which, name in enumerate(("march", "stride")):
        for n, field in enumerate(MarchConstants._fields):
            table[name][field] = marches[:, which, n]
    return table


def _fill_by_columns(table: np.ndarray, columns: dict[str, PairColumn], doubts: np.ndarray) -> None:
    """Compute the constants column by column, and add to `doubts` the rows that need more digits."""
    watched = {name: PairColumn(column.hi, column.lo, doubts) for name, column in columns.items()}
    with np.errstate(all="ignore"):
        _fill(table, _constants_of(watched))


def _fill(table: np.ndarray, values: Any) -> None:
    """Write the fields of a named tuple of columns, and of the tuples in it, into the fields of the
    same names.
    """
    for name, value in zip(values._fields, values, strict=True):
        if name in NESTED:
            _fill(table[name], value)
        else:
            table[name] = value


def _fill_by_program(
    table: np.ndarray,
    columns: dict[str, PairColumn],
    doubts: np.ndarray,
    run_program: Callable[..., None],
) -> None:
    """Compute the constants as `_fill_by_columns` does, by a program for all rows."""
    program = _constants_program(tuple(columns))
    arguments = np.empty((len(columns), 2, len(table)))
    for n, column in enumerate(columns.values()):
        arguments[n, 0] = column.hi
        arguments[n, 1] = column.lo
    rows = table.view(np.float64).reshape(len(table), -1)
    run_program(program.operations, program.constants, program.results, arguments, rows, doubts)
    for column_number, y, x in program.angles:
        rows[:, column_number] = atan2_of_columns(rows[:, y], rows[:, x])


@lru_cache(maxsize=64)
def _constants_program(names: tuple[str, ...]) -> Program:
    """Return the program that computes the constants from the parameters `names`."""
    recorder = Recorder()
    K = _constants_of({name: recorder.argument() for name in names})
    return recorder.program(flat(K))


def _constants_of(numbers: dict[str, Any]) -> Constants:
    """Return the constants for columns of pairs, or recorded pairs, by the names of parameters."""
    parameters: Any = OtherNumbers(numbers)
    return constants(parameters, as_double, root_of_columns, angle_of_columns)


# --- the flow ---


def clock_time(t, t_low, t0, K):
    """Return the time of a state with its true Omega: `t` + `t_low` is phase/Omega with Omega
    rounded to a double.
    """
    return t + (t_low + (t - t0) * K.Om_gain)


def constant_force(domain, K):
    """Return A_alpha/m, the constant part of the acceleration in a domain."""
    return select(domain == 1, K.A1, select(domain == 2, K.A2, K.A3))


def belt_at(boundary, K):
    """Return the constants of the belt at a boundary, which is its number."""
    if boundary == 1:
        return K.belt1
    return K.belt2


def held_forces(below, above, belt):
    """Return the forces that decide whether a belt holds the mass, from the accelerations on both
    sides: both are 0 or beyond where static friction no longer suffices.
    """
    return below + belt.E, above - belt.E


def belt_forces(boundary, x, c, K):
    """Return F^(below) and F^(above), the accelerations on both sides of a belt, at `x` and the
    cosine `c`.
    """
    v = belt_at(boundary, K).v
    below = acceleration(x, v, c, constant_force(boundary, K), K.cm, K.w0sq, K.f0)
    return below, acceleration(x, v, c, constant_force(boundary + 1, K), K.cm, K.w0sq, K.f0)


def drag(boundary, domain):
    """Return the sign of a belt's friction in A_alpha, the constant force of a domain: a faster belt
    drags forward.
    """
    if boundary >= domain:
        return 1.0
    return -1.0


def speeds_around(domain, K):
    """Return the speeds of the belts below and above a domain, -inf and inf where there is none."""
    if domain == 2:
        return K.belt1.v, K.belt2.v
    if domain == 1:
        return (-inf, K.belt1.v)
    return (K.belt2.v, inf)


def state_at(tau, start, K):
    """Return the point (`Flown`) of a flight at `tau` after its launch `start`, with v' to v''''."""
    v0, F0, s0, c0 = start
    E0, E1, E2, R2, I2, s_Om, c_Om = basis(tau, K)
    dx, dv, F = motion(v0, F0, s0, c0, K.cm, K.w0sq, K.f0, K.Om, E0, E1, E2, R2, I2)
    s = s0 * c_Om + c0 * s_Om
    c = c0 * c_Om - s0 * s_Om
    if K.stiff:
        G1, G2, G3 = stiff_derivatives(tau, start, s, c, K)
    else:
        G1, G2, G3 = derivatives(v0 + dv, F, s, c, K)
    return Flown(tau, dx, dv, F, G1, G2, G3, s, c, E0, E1, E2)


def turned(s, c, angle):
    """Return the sine `s` and cosine `c` of a phase after it has moved by a small `angle`, by
    Taylor's formula.
    """
    half = 0.5 * angle
    sixth = SIXTH * angle * angle
    last = 0.25 * angle * sixth
    return s + (c - (s * half + c * sixth - s * last)) * angle, c - (
        s + (c * half - s * sixth - c * last)
    ) * angle


def sine_and_cosine(theta, theta_low):
    """Return sine and cosine of the phase theta + theta_low."""
    return corrected(sin(theta), cos(theta), theta_low)


def corrected(s, c, theta_low):
    """Return sine and cosine of the phase theta + theta_low, given those of theta, which is
    rounded.
    """
    # Left alone this rounding would be the largest error of the force B0 cos(theta): up to 4 EPS
    # |B0|.
    return s + c * theta_low, c - s * theta_low


def derivatives(v, F, s, c, K):
    """Return v'', v''' and v'''' (the paper's G^(1) to G^(3)) from v, F = v', and sine and cosine
    of the phase.
    """
    G1 = next_derivative(F, v, K.fB * s, K.cm, K.w0sq)
    G2 = next_derivative(G1, F, K.fB * K.Om * c, K.cm, K.w0sq)
    G3 = next_derivative(G2, G1, -K.fB * K.Om * K.Om * s, K.cm, K.w0sq)
    return G1, G2, G3


@outlined
def stiff_derivatives(tau, start, s, c, K):
    """Return v'', v''' and v'''' at `tau` after launch, for strong damping, as sums over decaying
    and steady terms.
    """
    # `derivatives` multiplies what rounding left of F by the fast root once per order; here it has
    # died away.
    v0, F0, s0, c0 = start
    Om2 = K.Om * K.Om
    # With k = 0 the mean velocity is a part of the transient, as one of its roots is 0.
    v_free = v0 - (K.Ss * s0 + K.Sc * c0)
    F_free = F0 - K.Om * (K.Ss * c0 - K.Sc * s0)
    # v_free is the sum of a term for each root, F_free that of the terms times their roots. `fast` is
    # that of the fast root at launch first; then both names are second derivatives at `tau`.
    fast = (F_free - K.l1 * v_free) / (K.l2 - K.l1)
    slow = (v_free - fast) * exp(K.l1 * tau) * K.l1 * K.l1
    fast = fast * exp(K.l2 * tau) * K.l2 * K.l2
    v_steady = K.Ss * s + K.Sc * c
    F_steady = K.Om * (K.Ss * c - K.Sc * s)
    G1 = slow + fast - Om2 * v_steady
    G2 = slow * K.l1 + fast * K.l2 - Om2 * F_steady
    return G1, G2, slow * K.l1 * K.l1 + fast * K.l2 * K.l2 + Om2 * Om2 * v_steady


def fifth_derivative(G3, G2, c, K):
    """Return the fifth derivative of v from the fourth, G3, the third, G2, and the cosine `c` of
    the phase.
    """
    return next_derivative(G3, G2, -K.fB * K.Om * K.Om * K.Om * c, K.cm, K.w0sq)


def velocity_scale(tau, v0, F0, K):
    """Return the size of the terms of v - v0, at `tau` after a launch with velocity `v0` and
    acceleration `F0`.
    """
    # Not the terms themselves: they come back to 0 after a period of a free oscillation, their
    # errors do not. They grow with tau at first (`early`), and stop after about 1/w0 (`late`).
    rise = 0.5 * tau * tau
    drive = abs(K.fB) * rise
    if K.steady:
        drive = select(drive > 2.0 * K.V0, 2.0 * K.V0, drive)
    early = abs(F0) * tau + K.w0sq * abs(v0) * rise
    late = abs(F0) * K.swing + 2.0 * abs(v0)
    return select(K.w0 * tau < 1.0, early, late) * K.growth + drive
