"""A periodic orbit: its data, its states at any time, and its distance from a start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, nan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.base.aliases import Number, NumberLike, Record, SceneName
from symosc.base.arguments import ARRAY_LIKE, NAMES, SCENE_NAME, public, require
from symosc.base.arrays import real_array
from symosc.base.display.drawable import Drawable
from symosc.base.display.latex import latex_number
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import read_exact
from symosc.engine.arithmetic import mp_context
from symosc.engine.flow import state_at
from symosc.model import PARAMETER_NAMES, Model
from symosc.orbits.admissibility import Condition, conditions
from symosc.orbits.closing_equations import ClosingEquations, ConvergenceError, polish
from symosc.orbits.floquet import multipliers_of
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.words import MOST_PRINTED, Word, latex_label

# The step of a difference quotient, as a part of the parameter, or of LEAST_SIZE if this is smaller.
SENSITIVITY_STEP = Fraction(1, 10**15)
LEAST_SIZE = Fraction(1, 1000)
SENSITIVITY_DIGITS = 50
# Multipliers that differ by no more are one double multiplier.
DOUBLE_MULTIPLIER = 1e-7
# Periods of an orbit for which the approach of a motion is followed.
APPROACH_PERIODS = 400.5
# Multipliers that differ from 1 by less are written as 1 and the difference.
NEAR_ONE_TEXT = 1e-5


class SwitchingPoint(NamedTuple):
    """Time and position of a switching; unpacks as (t, x).

    Attributes
    ----------
    t, x : number
        Floats, or mpmath numbers with ``digits=``.

    Examples
    --------
    >>> from symosc import find_orbit, load_scene
    >>> t, x = find_orbit(load_scene("fig9").parameters, "P32").points[0]
    >>> print(f"t = {t:.6f}, x = {x:.6f}")
    t = 0.181670, x = 4.154921
    """

    t: Number
    x: Number


class Approach(NamedTuple):
    """The distance of a start from a periodic orbit, and the time until its motion is near.

    Attributes
    ----------
    dt, dx : float
        Time and position of the start minus those of the nearest switching point of the orbit on
        the same belt; nan if the start is not on a belt.
    offset_x, offset_v : float
        Position and velocity of the start minus those of the orbit at the same phase.
    periods : int or None
        Periods of the orbit after which |x - x_orbit| and |v - v_orbit| are below `within` for
        good; None: never seen.
    within : float

    Examples
    --------
    >>> from symosc import find_orbit, load_scene
    >>> approach = find_orbit(load_scene("fig9").parameters, "P32").approach("fig9")
    >>> f"{approach.dt:.6f}", approach.periods
    ('-0.049270', 6)
    """

    dt: float
    dx: float
    offset_x: float
    offset_v: float
    periods: int | None
    within: float


class OrbitSensitivities(NamedTuple):
    """The derivatives of a periodic orbit.

    Attributes
    ----------
    wrt : tuple of str
        The parameters with respect to which it is differentiated.
    dt, dx : array, (points, wrt)
        Derivatives of the times and positions of the switchings.
    dmultipliers : complex array, (2, wrt)
        Derivatives of the multipliers; nan where the two multipliers are equal, since a double one
        has no derivative.

    Examples
    --------
    >>> from symosc import find_orbit
    >>> s = find_orbit("fig9").sensitivities("FN")
    >>> s.dt.shape, s.dx.shape, s.dmultipliers.shape
    ((2, 1), (2, 1), (2, 1))
    """

    wrt: tuple[str, ...]
    dt: np.ndarray
    dx: np.ndarray
    dmultipliers: np.ndarray

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, OrbitSensitivities):
            return False
        return all(
            np.array_equal(np.asarray(a), np.asarray(b)) for a, b in zip(self, other, strict=True)
        )

    def __ne__(self, other: object) -> bool:
        return not self == other


def read_approach(scene: Scene | SceneName, within: NumberLike) -> tuple[Scene, float]:
    """Return the scene and the distance that `PeriodicOrbit.approach` is given."""
    require(Scene, SCENE_NAME, scene=scene)
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    near = float(read_exact("within", within))
    if near <= 0:
        raise ParameterError("within", within, "must be > 0")
    return scene, near


def periods_until(distance: np.ndarray, near: float) -> int | None:
    """Return the period after the last one at which a motion is not near; None if it is the last."""
    periods = int(np.flatnonzero(distance > near).max(initial=-1)) + 1
    if periods < len(distance):
        return periods
    return None


@dataclass(frozen=True)
class PeriodicOrbit(Drawable):
    """A periodic orbit, or a root of its closing equations that is not one (`admissible` is False).

    Calling it gives the state: ``orbit(t)`` is ``[x, v]``, of shape (2,) or (2, n), for any times.

    Attributes
    ----------
    parameters : Parameters or Oscillator
        An Oscillator if there is one belt.
    word : str
        The mapping structure, read right to left.
    labels : tuple of str
        The mappings of the word in order of time: labels[0] starts at points[0].
    points : tuple of SwitchingPoint
        (t, x) at each switching, in order of time, the first in the first forcing period. Floats,
        or mpmath numbers.
    period : number
        2 pi periods/Omega.
    periods : int
        Number of forcing periods.
    multipliers : tuple of two complex numbers
        Floquet multipliers, the larger one first; 0 is one of them if the orbit sticks.
    stable : bool or None
        Whether both lie inside the unit circle; None: the orbit is marginal, one lies on it to 50
        digits. An admissible orbit with c > 0 is stable by proof (`symosc.orbits.floquet`).
    residual : float
        Largest |f1|, |f2| of eq. (54).
    admissible : bool
        Whether each piece stays in its domain, each event is the first, and Theorems 4 and 5 hold
        at every switching. The engine has followed every such orbit over its period and found it
        closed (`symosc.orbits.admissibility`).
    failures : tuple of Condition
        What does not hold, where and by how much; empty for an orbit.
    grazing_distance : float
        The smallest difference in velocity between a belt and a turn of a flight before it, or, if
        the flight went on, beyond it.
    message : str
        A summary in words.
    steps : int
        Newton steps from the guess.
    digits : int or None

    Examples
    --------
    >>> from symosc import find_orbit, load_scene
    >>> orbit = find_orbit(load_scene("fig9").parameters, "P32")
    >>> [f"{abs(multiplier):.6f}" for multiplier in orbit.multipliers]
    ['0.071594', '0.071594']
    >>> orbit(0.5).round(6).tolist()
    [2.181503, -14.315533]
    """

    _drawn_by = "orbit_figure"
    _made_by = "find_orbit(...)"

    parameters: Model
    word: str
    labels: tuple[str, ...]
    points: tuple[SwitchingPoint, ...]
    period: Number
    periods: int
    multipliers: tuple[Number, Number]
    stable: bool | None
    residual: float
    admissible: bool
    failures: tuple[Condition, ...]
    grazing_distance: float
    message: str
    steps: int
    digits: int | None = None

    def _repr_latex_(self) -> str:
        """Return word, switching points and multipliers, for notebooks."""

        def shown(value: complex) -> str:
            real, imag = (
                latex_number(float(f"{part:.6g}")) for part in (value.real, abs(value.imag))
            )
            if value.imag == 0:
                return real
            return rf"{real} {'-' if value.imag < 0 else '+'} {imag}\,\mathrm{{i}}"

        points = zip(self.labels, self.points, strict=True)
        rows = r" \\ ".join(
            f"{latex_label(label)}: & {float(t):.12g} & {float(x):.12g}" for label, (t, x) in points
        )
        multipliers = r",\; ".join(shown(complex(value)) for value in self.multipliers)
        table = rf"\begin{{array}}{{lll}} \text{{from}} & t & x \\ {rows} \end{{array}}"
        return rf"${Word(self.labels).latex()},\quad {table},\quad \lambda = {multipliers}$"

    @property
    def is_rest(self) -> bool:
        """Whether the mass rests: no orbit with a word does."""
        return False

    @property
    def span_of_loop(self) -> float:
        """The time of a loop in the phase plane: the period."""
        return float(self.period)

    @property
    def start(self) -> tuple[Number, Number, Number]:
        """A state (t, x, v) on the orbit: at its first switching point."""
        t, x = self.points[0]
        return t, x, self.parameters.belt(self.equations().pieces[0].start)

    @property
    def first_belt(self) -> int | None:
        """The belt at which the points begin; None if no belt is met."""
        return self.equations().pieces[0].start

    def equations(self) -> ClosingEquations:
        """Return the closing equations in double precision."""
        return ClosingEquations(self.parameters.parameters, Word(self.labels), self.periods)

    def phases(self) -> np.ndarray:
        """Return the switching points as an (n, 2) array of (x, theta), phases unwrapped."""
        Omega = float(self.parameters.Omega)
        return np.array([(float(x), Omega * float(t)) for t, x in self.points])

    def conditions(self) -> list[Condition]:
        """Return every inequality that makes the root an orbit, with its margin."""
        return conditions(self.equations(), self.phases())

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return [x, v] at times t."""
        require(*ARRAY_LIKE, t=t)
        times = real_array("t", t, "must be real numbers")
        equations = self.equations()
        points = self.phases()
        K = equations.K
        turn = float(equations.turn)
        states = np.empty((2, times.size))
        _, phases = points.T
        for j, time in enumerate(times.ravel()):
            # In the first period of the orbit, and the last point before it.
            theta = (time * K.Om - phases[0]) % turn + phases[0]
            i = int(np.searchsorted(phases, theta, side="right")) - 1
            piece = equations.pieces[i]
            (x, begin) = (float(value) for value in points[i])
            tau = (theta - begin) / K.Om
            v = equations.belt(piece.start).v
            if piece.sticks:
                states[:, j] = x + v * tau, v
            else:
                state = state_at(tau, equations.start_of_flight(piece, (x, begin)), K)
                states[:, j] = x + state.dx, v + state.dv
        return states.reshape((2, *times.shape))

    @public
    def sensitivities(self, wrt: str | Sequence[str]) -> OrbitSensitivities:
        """Return the derivatives of the switching points and multipliers with respect to
        parameters.

        They are difference quotients of orbits whose parameter is larger and smaller by 1e-15 of
        its size. These orbits are found with 50 digits, so the quotients are right to about 20
        digits; they are rounded to doubles.

        Raises
        ------
        ParameterError
            If a name is no parameter, or given twice.
        ConvergenceError
            If there is no such orbit beside this one.

        Examples
        --------
        >>> from symosc import find_orbit
        >>> find_orbit("fig9").sensitivities(("FN", "Omega")).dt.round(6).tolist()
        [[0.006374, 0.053576], [0.0068, -0.154111]]
        """
        require(*NAMES, wrt=wrt)
        if isinstance(wrt, str):
            names: tuple[str, ...] = (wrt,)
        else:
            names = tuple(wrt)
        known = [name for name in PARAMETER_NAMES if name in self.parameters.numbers()]
        for name in names or ("",):
            if name not in known or names.count(name) > 1:
                allowed = f"must be different names of {', '.join(known)}"
                if name in known:
                    hint = ""
                else:
                    hint = meant(str(name), known)
                raise ParameterError("wrt", name, allowed + hint)
        columns = []
        for name in names:
            value = self.parameters.numbers()[name]
            step = max(abs(value), LEAST_SIZE) * SENSITIVITY_STEP
            above, below = (_neighbour(self, name, value + sign * step) for sign in (1, -1))
            columns.append(
                [complex(a - b) / (2 * float(step)) for a, b in zip(above, below, strict=True)]
            )
        # Rows: t of all points, x of all points, both multipliers.
        changes = np.array(columns).T
        n = len(self.points)
        dt, dx, slopes = np.split(changes, [n, 2 * n])
        first, second = map(complex, self.multipliers)
        if abs(first - second) <= DOUBLE_MULTIPLIER:
            slopes = np.full_like(slopes, np.nan)
        return OrbitSensitivities(names, dt.real, dx.real, slopes)

    @property
    def lyapunov(self) -> np.ndarray:
        """The two Lyapunov exponents per unit of time.

        An orbit with a stick has the multiplier 0, exponent -inf.
        """
        sizes = sorted((abs(complex(multiplier)) for multiplier in self.multipliers), reverse=True)
        log = mp_context(25).log  # the C library's may have other last bits on other machines
        rates = [float(log(size)) if size > 0.0 else -inf for size in sizes]
        return np.array(rates) / float(self.period)

    @public
    def approach(self, scene: Scene | SceneName, within: NumberLike = 1e-6) -> Approach:
        """Return how far a scene's start is from the orbit, and when its motion comes within
        `within` of the orbit.

        Raises
        ------
        ParameterError
            If the scene has other parameters than the orbit.
        """
        scene, near = read_approach(scene, within)
        if scene.parameters.parameters != self.parameters.parameters:
            raise ParameterError("scene", scene.name, "must have the orbit's parameters")
        (t0, x0, v0) = map(float, (scene.t0, scene.x0, scene.v0))
        length = float(self.period)
        distances = []
        T = length / self.periods
        for piece, (t, x) in zip(self.equations().pieces, self.points, strict=True):
            if scene.v0 == self.parameters.belt(piece.start):
                late = (t0 - float(t) + T / 2) % T - T / 2  # in [-T/2, T/2)
                distances.append((late, x0 - float(x)))
        dt, dx = min(distances, key=lambda pair: max(map(abs, pair)), default=(nan, nan))
        path = simulate(scene.reduced(), t_end=t0 + APPROACH_PERIODS * length)
        elapsed = length * np.arange(1 + int((float(path.t_end) - t0) / length))
        # The orbit's states at these times, shifted by the whole forcing periods that fit best.
        choices = [self(t0 + elapsed + shift * T) for shift in range(self.periods)]
        start = np.array([x0, v0])
        states = min(choices, key=lambda choice: float(np.abs(choice[:, 0] - start).max()))
        offset_x, offset_v = (start - states[:, 0]).tolist()
        distance = np.abs(path(t0 + elapsed) - states).max(axis=0)
        return Approach(dt, dx, offset_x, offset_v, periods_until(distance, near), near)

    def as_dict(self) -> Record:
        """Return everything as plain values.

        Numbers with more than double precision become text.
        """

        def plain(value: Any) -> float | str:
            if self.digits is None:
                return float(value)
            return value.context.nstr(value, self.digits)

        rows = zip(self.labels, self.points, strict=True)
        return {
            "word": self.word,
            "parameters": self.parameters.as_dict(),
            "points": [{"map": label, "t": plain(t), "x": plain(x)} for label, (t, x) in rows],
            "period": plain(self.period),
            "periods": self.periods,
            "multipliers": [[float(value.real), float(value.imag)] for value in self.multipliers],
            "stable": self.stable,
            "residual": float(self.residual),
            "admissible": self.admissible,
            "failures": [condition._asdict() for condition in self.failures],
            "grazing_distance": self.grazing_distance if self.grazing_distance < inf else None,
            "message": self.message,
        }

    def __repr__(self) -> str:
        if len(self.labels) > MOST_PRINTED:
            name = f"of {len(self.labels)} mappings"
        else:
            name = self.word or "without a belt"
        return f"<PeriodicOrbit {name}: {self.message}>"


def counted_periods(periods: int) -> str:
    """Return text such as "2 forcing periods"."""
    if periods == 1:
        return "1 forcing period"
    return f"{periods} forcing periods"


def multiplier_text(gap: float | None) -> str:
    """Return the largest |multiplier|, 1 - gap, as text.

    Near 1 it is "1 - 2e-9", so that it does not read as 1. None stands for exactly 1.
    """
    if gap is None:
        return "1"
    if abs(gap) > NEAR_ONE_TEXT:
        return f"{1 - gap:.6g}"
    if gap > 0:
        return f"1 - {abs(gap):.3g}"
    return f"1 + {abs(gap):.3g}"


def _neighbour(orbit: PeriodicOrbit, name: str, value: Fraction) -> list[Any]:
    """Return times, positions and multipliers, in one list, of the word's orbit at another value of
    `name`.
    """
    parameters = orbit.parameters.replace(**{name: value}).parameters
    word = Word(orbit.labels)
    equations = ClosingEquations(parameters, word, orbit.periods, SENSITIVITY_DIGITS)
    solution = polish(
        equations, [(float(x), float(t) * float(parameters.Omega)) for t, x in orbit.points]
    )
    if not solution.converged:
        raise ConvergenceError(
            orbit.word, (), orbit.periods, float(solution.residual), solution.reason
        )
    # In the order of the orbit's multipliers: the one nearest to its first comes first.
    target = complex(orbit.multipliers[0])
    pair = sorted(
        multipliers_of(equations, solution.points), key=lambda value: abs(complex(value) - target)
    )
    return [
        *(theta / equations.K.Om for _, theta in solution.points),
        *(x for x, _ in solution.points),
        *pair,
    ]
