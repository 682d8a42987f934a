"""What a motion under a drive is that never repeats itself: chaotic, or quasi-periodic.

Its states at the ends of forcing periods (its *section points*) tell. On a torus they go round
closed curves, turn after turn by the same part of a turn on the average, and neighbours keep their
distances. In chaos neighbours move apart exponentially.

Averages along the motion are weighted by w(s) = exp(-1/(s (1 - s))) at the part s of its time (Das,
Sander, Yorke and others). On a torus they converge faster than any power of the time where it is
smooth, and with a high power where it is not; in chaos with the square root of the time, as all
averages do; and while a motion drifts to something else they do not converge. So averages of two
halves of a motion that agree to many digits are the sign of a torus, and their difference bounds
the error of what is averaged.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from math import ceil, inf, isnan, log, nan, pi, sqrt
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Number
from symosc.base.display.drawable import Comparable
from symosc.derivatives.sensitivities import Sensitivities, sensitivities
from symosc.engine.arithmetic import column_functions
from symosc.engine.events import CODE_COLUMNS
from symosc.engine.state import SLIP
from symosc.kernels import linear
from symosc.kernels.pair_columns import atan2_of_columns
from symosc.model import Model
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.simulate import simulate

#: Forcing periods over which exponents are computed, and parts of them that tell their error.
EXPONENT_PERIODS = 1000
PARTS = 16
#: An exponent is positive if it exceeds so many of its errors, and makes distances grow by this
#: part in a forcing period.
SIGMAS = 3.0
LEAST_EXPONENT = 1e-2
#: On a torus neighbours stay within this multiple of their distance along it, either way; towards
#: one that attracts they come nearer by the same factor at least.
BOUNDED = 1e3
#: Forcing periods of a motion that may be on a torus, the more the nearer it is to a resonance.
#: Those of its path from which turns are counted, and the least number of returns to a curve in
#: them. Section points that are kept.
TORUS_PERIODS = (16_384, 65_536)
PATH_PERIODS = 512
LEAST_RETURNS = 128
POINTS = 1024
#: States of a motion in each forcing period, or in each turn of the free oscillator if it is
#: shorter, from which its turns are counted.
SAMPLES = 32
#: Averages of two halves agree if they differ by less than this part of the extent.
AGREE = 1e-5
#: The motion has been everywhere on the curve: after n of N forcing periods it is away from where it
#: was by more than this part of a turn over N, for all n up to this part of N.
WENT_ROUND = 1 / 4
#: Closed curves on the section, at most; they are apart if points of others are farther away than
#: this nearest one on the same curve, by the mean over so many points.
MOST_CURVES = 16
NEIGHBOUR = 8
TRIED = 64
COMPARED = 4096
#: The steps of angles around the centre of a curve leave out this part of a turn.
LEAST_GAP = 0.02
#: The row of the kinds of events.
KIND_ROW = 1 + CODE_COLUMNS.index("kind")
#: The error of a rotation number by rounding.
ROUNDING = 1e-14


@dataclass(frozen=True, eq=False, repr=False)
class Chaotic(Comparable):
    """A chaotic attractor: neighbouring motions move apart, and nothing recurs.

    Attributes
    ----------
    exponent : float
        The largest Lyapunov exponent, per unit of time.
    error : float
        Its standard error as a mean over time.
    per_slip : float
        The exponent per slip from a belt; NaN without slips.
    points : (n, 2) float array
        Position and velocity at the ends of forcing periods.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, attractors
    >>> law = Oscillator(m=1, c=0, k=1, B0=1, Omega="0.58", belts=[Belt(0, mu="0.1", mu_s="0.829")])
    >>> (chaos,) = attractors(law, [(0, 1, 1)], t_end="150T").orbits
    >>> chaos.exponent > 3 * chaos.error, 0.2 < chaos.per_slip < 0.3
    (True, True)
    """

    exponent: float
    error: float
    per_slip: float = nan
    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))

    @property
    def is_rest(self) -> bool:
        """Whether the mass rests: not in chaos."""
        return False

    @property
    def name(self) -> str:
        """A short name for legends."""
        return f"chaos, exponent {self.exponent:.2g}"

    def __repr__(self) -> str:
        return f"<Chaotic: exponent {self.exponent:.4g} +- {self.error:.2g} per unit of time>"


@dataclass(frozen=True, eq=False, repr=False)
class QuasiPeriodic(Comparable):
    """A quasi-periodic motion: it has a second frequency beside that of the drive, and their ratio
    is not a fraction, so that it never repeats itself. It goes round a torus.

    A motion of finite time cannot tell this from an orbit of very many forcing periods: one of
    4,000 or fewer is not taken for it.

    Attributes
    ----------
    frequency, frequency_error : float
        The second (angular) frequency: the mean rate at which the state turns around the closed
        motion inside the torus, in the plane of x and v.
    rotation, rotation_error : float
        The number of these turns in a forcing period. Its fractional part is the rotation number
        of the curve on the section.
    exponents : (2,) float array
        The Lyapunov exponents per unit of time. The first is 0 but for its error, the other one is
        negative if the torus attracts; -inf where the mass sticks.
    error : float
        The standard error of the first exponent as a mean over time.
    curves : int
        The number of closed curves on the section, through which the motion goes in turn.
    points : (n, 2) float array
        Position and velocity at the ends of forcing periods.

    Examples
    --------
    >>> from symosc import Belt, Oscillator, attractors
    >>> belt = Belt("3/2", curve=[(0, 1), ("1/4", "4/5"), (1, "14/25"), (3, "1/2")])
    >>> law = Oscillator(m=1, c="1/10", k=1, B0="1/10", Omega="0.934", belts=[belt])
    >>> (torus,) = attractors(law, [(0, 1, 0)], t_end="1500T").orbits
    >>> f"{torus.rotation:.6f}", torus.rotation_error < 1e-6, torus.curves
    ('1.064931', True, 1)
    """

    frequency: float
    frequency_error: float
    rotation: float
    rotation_error: float
    exponents: np.ndarray
    error: float
    curves: int = 1
    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))

    @property
    def is_rest(self) -> bool:
        """Whether the mass rests: not on a torus."""
        return False

    @property
    def attracts(self) -> bool:
        """Whether neighbours of the torus come nearer to it, by the second exponent."""
        span = EXPONENT_PERIODS * 2 * pi * self.rotation / self.frequency
        return bool(self.exponents[1] * span < -log(BOUNDED))

    @property
    def name(self) -> str:
        """A short name for legends."""
        return f"quasi-periodic, rotation {self.rotation:.5g}"

    def __repr__(self) -> str:
        return (
            f"<QuasiPeriodic: frequency {self.frequency:.8g} +- {self.frequency_error:.1g}, "
            f"{self.rotation:.8g} turns in a forcing period>"
        )


def period_of(model: Model) -> float:
    """Return the period of the drive."""
    return 2 * pi / float(model.Omega)


def unsettled_at(model: Model, t: Number, x: Number, v: Number) -> Chaotic | QuasiPeriodic | None:
    """Return what a motion under a drive is that is known not to repeat itself, from a state behind
    its transient; None if that is open.
    """
    exponents = exponents_at(model, t, x, v)
    if exponents is None:
        return None
    first = float(exponents.values[0])
    if first > SIGMAS * exponents.error and first * period_of(model) > LEAST_EXPONENT:
        per_slip = first * exponents.span / exponents.slips if exponents.slips else nan
        return Chaotic(first, exponents.error, per_slip)
    is_bounded = (
        abs(first) * exponents.span <= log(BOUNDED) or abs(first) <= SIGMAS * exponents.error
    )
    if not is_bounded:
        return None
    turns = torus_at(model, t, x, v)
    if turns is None:
        return None
    return QuasiPeriodic(
        turns.rotation * float(model.Omega),
        turns.error * float(model.Omega),
        turns.rotation,
        turns.error,
        exponents.values,
        exponents.error,
        turns.curves,
        turns.points,
    )


# -- exponents -------------------------------------------------------------------------------------


class Exponents(NamedTuple):
    """The Lyapunov exponents of a motion, the standard error of the first one, the time over which
    they are means, and the number of slips in it.
    """

    values: np.ndarray
    error: float
    span: float
    slips: int


def exponents_at(model: Model, t: Number, x: Number, v: Number) -> Exponents | None:
    """Return the exponents of the motion from a state under a drive; None if it ends before."""
    end = float(t) + EXPONENT_PERIODS * period_of(model)
    changes = sensitivities(model, ("x0", "v0"), t0=t, x0=x, v0=v, t_end=end)
    if changes.trajectory.status != "t_end":
        return None
    error = float(changes.lyapunov_error)
    if isnan(error):
        error = _error_over_time(changes)
    slips = int((changes.trajectory.rows().ints[KIND_ROW] == SLIP).sum())
    return Exponents(changes.lyapunov, error, end - float(t), slips)


def _error_over_time(changes: Sensitivities) -> float:
    """Return the standard error of the first exponent of a motion with few events, from parts of
    its time.
    """
    motion = changes.trajectory
    times = np.linspace(float(motion.t_start), float(motion.t_end), PARTS + 1)
    with np.errstate(all="ignore"):
        matrices = changes(times)
    stretches = [linear.largest_stretch(matrices[:, n]) for n in range(PARTS + 1)]
    if not all(0 < stretch < inf for stretch in stretches):
        return nan
    rates = np.diff([log(stretch) for stretch in stretches]) / np.diff(times)
    return float(rates.std(ddof=1) / sqrt(PARTS))


# -- tori ------------------------------------------------------------------------------------------


class TorusTurns(NamedTuple):
    """How a motion goes round a torus: the turns in a forcing period and their error, the number of
    curves on the section, and section points.
    """

    rotation: float
    error: float
    curves: int
    points: np.ndarray


def torus_at(model: Model, t: Number, x: Number, v: Number) -> TorusTurns | None:
    """Return how the motion from a state goes round a torus, None if it is not known to do so."""
    for periods in TORUS_PERIODS:
        points = sections_of(model, t, x, v, periods)
        if points is None or not np.ptp(points, axis=0).all() or not averages_agree(points):
            return None
        turns = _turns_of(model, t, x, v, points)
        if turns is None or turns.error > AGREE:
            return None
        if _goes_round(turns.curves * turns.rotation, turns.error, len(points) // turns.curves):
            return turns
    return None


def _turns_of(
    model: Model, t: Number, x: Number, v: Number, points: np.ndarray
) -> TorusTurns | None:
    """Return how the motion with some section points goes round a curve; None if no curve is seen."""
    curves = _curves_of(points[:COMPARED])
    lifted = _turns_of_path(model, t, x, v, curves)
    returns = points[::curves]
    increments = np.diff(_angles(returns, averages(returns))) % 1.0
    # On a circle no step is a whole turn, so that the steps leave a gap.
    steps = np.sort(increments)
    gaps = np.diff(steps, append=1.0 + steps[0])
    widest = int(gaps.argmax())
    if lifted is None or gaps[widest] < LEAST_GAP:
        return None
    if widest + 1 < len(steps):
        increments = np.where(increments > steps[widest], increments - 1.0, increments)
    half = len(increments) // 2
    first, second, both = (
        float(averages(part[:, None])[0])
        for part in (increments[:half], increments[half : 2 * half], increments)
    )
    error = max(abs(first - second), ROUNDING)
    turns = both + round(curves * lifted - both)
    return TorusTurns(turns / curves, error / curves, curves, points[-POINTS:])


def sections_of(model: Model, t: Number, x: Number, v: Number, periods: int) -> np.ndarray | None:
    """Return the states of a motion at the ends of so many forcing periods, None if it is not
    followed for so long.
    """
    found = simulate_many(
        model, [(float(t), float(x), float(v))], float(t) + (periods + 1) * period_of(model),
        accuracy=inf, record=("status", "section"), sections=periods,
    )  # fmt: skip
    (points,) = found.section
    if found.status[0] != "t_end" or not np.isfinite(points).all():
        return None
    return np.asarray(points)


def _angles(states: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Return the angles of states around a centre, in turns: clockwise, as motions turn."""
    across, up = ((states - centre) / np.ptp(states, axis=0)).T
    return -atan2_of_columns(up, across) / (2 * pi)


def _turns_of_path(model: Model, t: Number, x: Number, v: Number, curves: int) -> float | None:
    """Return about how many turns a motion makes in a forcing period; None if it is not followed for
    long enough.

    The turns are those around the mean of all states at the same phase, which is inside if the
    torus is not bent much; if it is outside, the turns are whole ones.
    """
    period = period_of(model)
    samples = SAMPLES * max(1, ceil(sqrt(float(model.k / model.m)) / float(model.Omega)))
    returns = max(PATH_PERIODS // curves, LEAST_RETURNS)
    times = float(t) + period / samples * np.arange(returns * curves * samples)
    motion = simulate(model, t0=t, x0=x, v0=v, t_end=times[-1] + period, accuracy=inf)
    if motion.status != "t_end":
        return None
    states = motion(times).T
    paths = states.reshape(returns, curves * samples, 2)
    centre = (weights(returns)[:, None, None] * paths).sum(axis=0)
    around = states - np.tile(centre, (returns, 1))
    turns = np.unwrap(_angles(around, np.zeros(2)), period=1.0)
    return float((turns[-1] - turns[0]) * samples / (len(turns) - 1))


@cache
def weights(count: int) -> np.ndarray:
    """Return the weights of so many successive values in an average; their sum is 1."""
    s = (np.arange(count) + 1) / (count + 1.0)
    bump = column_functions()["exp"](-1.0 / (s * (1.0 - s)))
    return np.asarray(bump / bump.sum())


def averages(values: np.ndarray) -> np.ndarray:
    """Return the weighted averages of the columns of values along a motion."""
    mean: np.ndarray = (weights(len(values))[:, None] * values).sum(axis=0)
    return mean


def averages_agree(points: np.ndarray) -> bool:
    """Return whether the averages of the two halves of a motion's section points agree, as on a torus
    or an orbit; they do not in chaos, nor while the motion drifts.
    """
    half = len(points) // 2
    # A motion that has decayed since then has another extent.
    extent = np.ptp(points[-half // 2 :], axis=0)
    if not extent.any():
        return False
    # A mass that always sticks then has the speed of the belt.
    extent = np.where(extent > 0, extent, 1.0)
    x, v = ((points - points[-half:].mean(axis=0)) / extent).T
    moments = np.column_stack([x, v, x * x, x * v, v * v, x * x * x, v * v * v])
    apart = averages(moments[:half]) - averages(moments[half : 2 * half])
    return bool(np.abs(apart).max() < AGREE)


def _curves_of(points: np.ndarray) -> int:
    """Return on how many separate closed curves section points lie in turn."""
    scaled = points / np.ptp(points, axis=0)
    for count in range(MOST_CURVES, 1, -1):
        own = scaled[::count]
        others = np.delete(scaled, np.s_[::count], axis=0)
        tried = own[:TRIED]
        apart = np.abs(tried[:, None] - others).max(axis=-1).min(axis=1).mean()
        # Beside a long orbit a few points are much nearer than all others on the curve.
        within = np.sort(np.abs(tried[:, None] - own).max(axis=-1), axis=1)[:, NEIGHBOUR].mean()
        if apart > within:
            return count
    return 1


def _goes_round(rotation: float, error: float, returns: int) -> bool:
    """Return whether a motion has been everywhere on a curve after so many returns to it, with a
    rotation number: it does not stay beside an orbit that closes after fewer.
    """
    count = np.arange(1, int(returns * WENT_ROUND))
    turns = rotation * count
    away = np.abs(turns - np.round(turns))
    return bool((away > WENT_ROUND / returns + error * count).all())
