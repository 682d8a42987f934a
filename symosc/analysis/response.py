"""The frequency response: what the settled motion does per cycle of the drive, over one parameter.

The settled motion is the periodic orbit, or the motion that meets no belt, or a rest: for each of
them one cycle is followed, exactly. Its pieces are analytic; on each, cut in halves until that has
converged, Legendre polynomials through Gauss's points give the integrals and the extremes. The
energies that go in and that are lost are integrals of their own, so that their difference shows the
error.
"""

from __future__ import annotations

import csv
import io
from cmath import phase
from collections.abc import Iterator, Mapping
from fractions import Fraction
from functools import cache
from itertools import pairwise
from math import asin, hypot, inf, nan, pi, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from symosc.base.aliases import Progress, Record, SceneName
from symosc.base.arguments import ARRAY_LIKE, PROGRESS, mapping_of, public, require
from symosc.base.display.frames import imported
from symosc.base.display.progress import late_bar
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import show
from symosc.base.files import write_text
from symosc.engine.arithmetic import column_functions
from symosc.kernels import linear
from symosc.kernels.elementary import cos, sin
from symosc.model import Model, Parameters, by_name
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit, settled_orbit
from symosc.orbits.floquet import rest_positions
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.reductions import NUMBER_NAMES, Harmonic, OtherModel, harmonic, motion_of_belts
from symosc.scenes import Scene, problem_of
from symosc.simulation.simulate import simulate
from symosc.simulation.tables import Columns
from symosc.simulation.trajectory import Segment, Trajectory
from symosc.sweeps.plan import read_axis
from symosc.words import Word, WordError, of_belts

#: Gauss points of a part of a piece, and what the last coefficients of its polynomials may be: as a
#: part of the size of the motion or, where that is less, of this part of what the drive would do to
#: the mass alone, or to the spring.
POINTS = 24
CONVERGED = 1e-14
SMALL_MOTION = 1e-2
#: How often a piece is halved at most, and where halving no longer helps because rounding is all
#: that is left.
MOST_HALVES = 30
ROUNDING = 1e-10
#: Periods after which a motion from harmonic balance is examined for an orbit, one after the other.
FOLLOWED = 3, 12, 48
#: The columns of a response, beside that of the parameter.
COLUMNS = (
    "status", "word", "amplitude", "transmissibility", "phase", "harmonic", "work", "dissipated", "damper", "friction",
    "stuck", "balance", "balance_error", "error",
)  # fmt: skip


class FrequencyResponse(Columns):
    """The settled motion for each value of one parameter, as columns in the coordinates of the
    model that was given.

    Attributes
    ----------
    name : str
        The parameter.
    values : array, (n,)
    status : array of str
        "orbit", "marginal orbit", "linear" (meets no belt), "rest" (stays on a belt at rest), or
        why there is no settled motion; then the numbers are nan.
    word : array of str
        The mapping structure of an orbit.
    amplitude : array
        Half the distance between the largest and the smallest x.
    transmissibility : array
        Of a moving base: the amplitude over that of the base. Else: half the range of the force
        that spring, damper and friction pass on, over that of the excitation. nan if neither base
        nor force oscillates.
    phase : array
        By how much the first harmonic of x lags the excitation, in (-pi, pi]: the base, if that
        moves, else the force, else the speeds of the belts.
    harmonic : array
        The amplitude of the first harmonic of x.
    work, dissipated : array
        Energies per cycle of the drive: what excitation, base and belts do on the mass, and what
        damper and belts turn into heat. They are computed independently and are equal.
    damper, friction : array
        The two parts of `dissipated`.
    stuck : array
        Share of the time for which the mass is stuck to a belt.
    balance, balance_error : array
        The amplitude by harmonic balance (a single harmonic, and the first harmonic of friction),
        and how far it is from `amplitude`, as a part of this.
    error : array
        Estimated error of `amplitude`.

    Examples
    --------
    >>> from symosc import frequency_response
    >>> found = frequency_response("fig9", {"Omega": [3.5, 4, 4.5]})
    >>> found.word.tolist(), found.amplitude.round(6).tolist()
    (['P32', 'P32', 'P32'], [3.845533, 4.200526, 4.618052])
    >>> bool(abs(found.work - found.dissipated).max() < 1e-11)
    True
    """

    _drawn_by = "response_figure"

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(
            f"FrequencyResponse has no column {name!r}; it has {', '.join(COLUMNS)}"
        )

    def columns(self) -> dict[str, np.ndarray]:
        """Return all columns by name, first the column of the parameter."""
        return {self.name: self.values} | {name: getattr(self, name) for name in COLUMNS}

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per value; MissingExtraError if pandas is not installed."""
        return imported("pandas").DataFrame(self.columns())

    def to_csv(self, path: str | Path) -> None:
        """Write the columns as CSV with a header ("-": to standard output).

        OutputError if it cannot be written.
        """
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns())
        writer.writerows(zip(*(column.tolist() for column in self.columns().values()), strict=True))
        write_text(path, text.getvalue())

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        low = self.values.min()
        high = self.values.max()
        return f"<FrequencyResponse over {self.name} from {low:g} to {high:g}, {len(self)} values>"


@public
def frequency_response(
    what: Scene | Parameters | OtherModel | SceneName,
    over: Mapping[str, ArrayLike],
    *,
    progress: Progress = False,
) -> FrequencyResponse:
    """Return amplitude, transmissibility, phase, energies and time of sticking of the settled
    motion over a parameter.

    Parameters
    ----------
    what : Scene, its name or file, Parameters or OtherModel
        With k > 0. The start of a scene does not count.
    over : mapping
        One parameter, or number of the model, with its values, or text ``"LO:HI:N"``: ``{"Omega":
        "0.5:2:100"}``.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a
        function of two numbers: the part that is done, and 1.

    Returns
    -------
    FrequencyResponse

    Raises
    ------
    ParameterError
        If the parameter is not known, a value is out of range, or k = 0.

    Notes
    -----
    With c > 0 the settled motion is the only one. With c = 0 it is too, if it attracts its
    neighbours: the period map does not expand, so that periodic motions form a convex set. Where a
    marginal orbit has others beside it the status is "marginal orbit", and the numbers are those of
    one of them.

    Examples
    --------
    >>> from symosc import OtherModel, frequency_response
    >>> model = OtherModel(m=1, k=1, Omega=1, FN="1/4", Y=1, joined=True)
    >>> frequency_response(model, {"Omega": [1.2, 1.6]}).transmissibility.round(6).tolist()
    [2.219519, 0.648392]
    """
    require(mapping_of(*ARRAY_LIKE), over=over)
    require(*PROGRESS, progress=progress)
    model = _model_of(problem_of(what, "what", any_law=True))
    if not isinstance(over, Mapping) or len(over) != 1:
        raise ParameterError(
            "over", over, 'must be one parameter with its values, such as {"Omega": "0.5:2:100"}'
        )
    ((name, axis),) = over.items()
    if name not in NUMBER_NAMES:
        allowed = f"is not a parameter of the model; choose one of {', '.join(NUMBER_NAMES)}"
        raise ParameterError("over", name, allowed + meant(str(name), NUMBER_NAMES))
    if name == "pull" or model.pull != 0:
        raise ParameterError(
            "pull", show(model.pull), "must be 0: the motion of a pulled spring is not periodic"
        )
    values = read_axis(name, axis)
    rows = list[Record]()
    before = None
    with late_bar(progress, f"response over {name}", "values") as advance:
        for i, value in enumerate(values.tolist()):
            row, before = respond(model.replace(**{name: value}), before)
            rows.append(row)
            if advance:
                advance((i + 1) / len(values), i + 1)
    missing: Record = {"word": ""}
    columns = {
        column: np.array([row.get(column, missing.get(column, nan)) for row in rows])
        for column in COLUMNS
    }
    return FrequencyResponse(name=name, values=values, **columns)


def _model_of(problem: Scene | Model | OtherModel) -> OtherModel:
    """Return a problem as an OtherModel; by default its base is at rest."""
    if isinstance(problem, OtherModel):
        return problem
    if isinstance(problem, Scene):
        if problem.original is not None:
            return problem.original.model
        problem = problem.parameters
    numbers = by_name(problem.parameters)
    if len(problem.law.belts) == 1:
        del numbers["v2"]
        del numbers["mu2"]
    return OtherModel(**numbers)


def respond(
    model: OtherModel, before: PeriodicOrbit | None = None
) -> tuple[Record, PeriodicOrbit | None]:
    """Return one row of a `FrequencyResponse` by the names of its columns, and an orbit to begin
    the next row with.

    This is the orbit of the `model`, or, if none was found, `before`: an orbit at nearby
    parameters, or None.
    """
    p = model.parameters
    if p.k == 0:
        raise ParameterError(
            "k", 0, "must be > 0: without a spring nothing fixes the position of a settled motion"
        )
    delay = float(model.delay * model.Omega)
    late = complex(cos(delay), -sin(delay))
    mean, z = harmonic_balance(p)
    if z == inf:
        balance = inf
    else:
        balance = abs(_phasor(model.shift) + late * z)
    try:
        if z == inf:
            raise _unsettled("the motion grows for ever, at resonance without a damper")
        status, start, orbit = settle(p, (mean + z.real, -float(p.Omega) * z.imag), before)
        row = cycle_response(model, start, orbit)
    except ConvergenceError as error:
        return {"status": error.reason, "balance": balance}, before
    if row["amplitude"]:
        balance_error = balance / row["amplitude"] - 1
    elif balance == 0:
        balance_error = nan
    else:
        balance_error = inf
    return {
        "status": status,
        "balance": balance,
        "balance_error": balance_error,
    } | row, orbit or before


def _unsettled(reason: str) -> ConvergenceError:
    """Return the error that says why there is no settled motion."""
    return ConvergenceError("", (), 1, inf, reason)


# -- the settled motion


class Settled(NamedTuple):
    """A settled motion: its status, a state t, x, v on it, and the orbit that it is, if any."""

    status: str
    state: tuple[Any, Any, Any]
    orbit: PeriodicOrbit | None


def settle(p: Parameters, guess: tuple[float, float], before: PeriodicOrbit | None) -> Settled:
    """Return the settled motion, found from x, v of `guess` or the nearby orbit `before`; else
    ConvergenceError.
    """
    for boundary in p.law.boundaries:
        rests = rest_positions(p, boundary)
        if rests is not None:
            low, high = rests
            nearest_to_0 = min(max(low, 0), high)
            return Settled("rest", (0, nearest_to_0, 0), None)
    domain = meets_no_belt(p)
    if domain is not None:
        if p.c == 0:
            raise _unsettled("without a damper the motion between the belts goes on for ever")
        # Without events the motion is its mean and the first harmonic z e^(i Omega t).
        z = float(p.B0) / complex(float(p.k - p.m * p.Omega**2), float(p.c * p.Omega))
        mean = float(p.A(domain) / p.k)
        # Its x and v at t = 0.
        return Settled("linear", (0, mean + z.real, -float(p.Omega) * z.imag), None)
    # In the order of their costs: the last one may follow 1,000 periods.
    orbit = _nearby_orbit(p, before) or _orbit_reached(p, guess) or settled_orbit(p, most=1000)
    (t, x) = orbit.points[0]
    belt = orbit.equations().pieces[0].start
    if orbit.stable:
        status = "orbit"
    else:
        status = "marginal orbit"
    return Settled(status, (t, x, p.belt(belt)), orbit)


def _nearby_orbit(p: Parameters, before: PeriodicOrbit | None) -> PeriodicOrbit | None:
    """Find the stable orbit with the word of `before`, an orbit at other parameters; None if there
    is none.
    """
    if before is None:
        return None
    scale = float(before.parameters.Omega / p.Omega)
    orbit = _orbit(p, before.word, [(t * scale, x) for t, x in before.points])
    # A stable one attracts all motions, so that there is no other.
    if orbit and orbit.stable:
        return orbit
    return None


def _orbit_reached(p: Parameters, guess: tuple[float, float]) -> PeriodicOrbit | None:
    """Follow the motion from x and v of `guess` and find the orbit that it approaches; None if
    none, or unstable.

    The orbit is looked for near the events of the second last period followed: mappings that begin
    there end before the motion does. A marginal orbit counts as stable.
    """
    period = 2 * pi / float(p.Omega)
    for count in FOLLOWED:
        motion = simulate(p, t0=0, x0=guess[0], v0=guess[1], t_end=count * period)
        begin = (count - 2) * period
        cycle = [
            i for i, event in enumerate(motion.events) if begin <= float(event.t) < begin + period
        ]
        labels = [motion.segments[i + 1].label for i in cycle]  # i + 1 begins at the event i
        if labels and None not in labels:
            events = [motion.events[i] for i in cycle]
            points = [(float(event.t), float(event.x)) for event in events]
            orbit = _orbit(p, str(Word(tuple(filter(None, labels)))), points)
            if orbit and orbit.stable is not False:
                return orbit
    return None


def _orbit(p: Parameters, word: str, points: list[tuple[float, float]]) -> PeriodicOrbit | None:
    """Return the orbit of one period with the word `word` near the switching points (t, x) of
    `points`, or None.
    """
    try:
        orbit = find_orbit(p, word, points, periods=1)
    except (ConvergenceError, ParameterError, WordError):
        return None
    if orbit.admissible:
        return orbit
    return None


def meets_no_belt(p: Parameters) -> int | None:
    """Decide exactly whether the steady linear motion meets no belt.

    Return the domain in which it stays, or None.
    """
    stiffness = (p.k - p.m * p.Omega**2) ** 2 + (p.c * p.Omega) ** 2
    if stiffness == 0:
        return None
    square = (p.B0 * p.Omega) ** 2 / stiffness  # of its largest velocity

    def is_below(speed: Fraction) -> bool:
        """Return whether the velocity stays below a speed > 0, and above its negative."""
        return square < speed * speed and speed > 0

    if is_below(p.v1):
        return 1
    if is_below(-p.v2):  # v > v2 throughout
        return 3
    if is_below(-p.v1) and is_below(p.v2):
        return 2
    return None


def harmonic_balance(p: Parameters) -> tuple[float, complex]:
    """Return mean and first harmonic of x by harmonic balance, dropping the higher harmonics of x
    and friction.
    """
    # For v = -V sin(a) these are, of a belt, (2/pi) mu FN arcsin(v_lambda/V) and -(4/pi) mu FN
    # sqrt(1 - (v_lambda/V)^2) sin(a), and where V < |v_lambda| the whole force and 0. The size of
    # both sides of the balance increases with V, so that there is one solution; inf where it grows
    # for ever.
    m, c, k, Omega, B0 = (float(number) for number in (p.m, p.c, p.k, p.Omega, p.B0))
    belts = [(float(p.friction(belt)), float(p.belt(belt))) for belt in p.law.boundaries]
    # The drive that friction holds at least, by the belts at rest, and at most.
    smallest, most = (
        4 / pi * sum(force for force, v in belts if abs(v) <= limit) for limit in (0, inf)
    )
    stiffness = hypot(k / Omega - m * Omega, c)

    def drive_parts(V: float) -> tuple[float, float]:
        """Return the parts of the drive in phase with x and with x' that sustain the velocity
        amplitude V.
        """
        friction = sum(force * sqrt(1 - (v / V) ** 2) for force, v in belts if abs(v) < V)
        return (k / Omega - m * Omega) * V, c * V + 4 / pi * friction

    V = 0.0
    z = 0j
    if abs(B0) > smallest:
        # At resonance without a damper friction alone holds the drive.
        if stiffness == 0 and abs(B0) >= most:
            return 0.0, complex(inf)
        from scipy.optimize import brentq

        if stiffness:
            high = abs(B0) / stiffness
        else:
            high = 1.0
        while hypot(*drive_parts(high)) < abs(B0):
            high *= 2
        V = brentq(
            lambda V: (hypot(*drive_parts(V)) if V else smallest) - abs(B0),
            0.0,
            high,
            xtol=1e-300,
            rtol=1e-15,
        )
        elastic, loss = drive_parts(V)
        z = V / Omega * complex(elastic, -loss) / hypot(elastic, loss) * (1 if B0 > 0 else -1)
    pull = sum(
        2 / pi * force * asin(max(-1.0, min(v / V, 1.0)) if V else float(np.sign(v)))
        for force, v in belts
    )
    return (float(p.A0) + pull) / k, z


# -- one cycle of it


class MotionPart(NamedTuple):
    """A part of a segment: its ends, Gauss's points and weights of an integral over it, and
    position `z` and velocity `u` of the motion at these points.
    """

    segment: Segment
    ends: tuple[float, float]
    t: np.ndarray
    weights: np.ndarray
    z: np.ndarray
    u: np.ndarray


class GaussRule(NamedTuple):
    """Points and weights of Gauss in [-1, 1], and the matrix from values there to Legendre
    coefficients.
    """

    points: np.ndarray
    weights: np.ndarray
    coefficients: np.ndarray


@cache
def _gauss() -> GaussRule:
    """Return the rule of Gauss with POINTS points."""
    # Not by legendre.leggauss: the eigenvalues that it begins with have other last bits on other
    # processors.
    points = np.array([-cos(pi * (i + 0.75) / (POINTS + 0.5)) for i in range(POINTS)])
    highest = np.append(np.zeros(POINTS), 1.0)
    slope = legendre.legder(highest)
    # Newton's method doubles the digits of the first points, the usual estimates by a cosine.
    for _ in range(6):
        points -= legendre.legval(points, highest) / legendre.legval(points, slope)
    weights = 2.0 / ((1.0 - points * points) * legendre.legval(points, slope) ** 2)
    degrees = np.arange(POINTS)
    # The coefficient of P_n is (n + 1/2) times the integral of values times P_n.
    coefficients = (degrees + 0.5)[:, None] * legendre.legvander(points, POINTS - 1).T * weights
    return GaussRule(points, weights, coefficients)


def parts(motion: Trajectory) -> Iterator[MotionPart]:
    """Yield the parts of a motion on which a polynomial through its values at Gauss's points is
    accurate.
    """
    p = motion.parameters
    (points, weights, coefficients) = _gauss()
    # Long segments are cut into parts of an angle of 2 of the faster of drive and oscillator: on
    # longer ones the polynomial would hardly ever be accurate.
    longest = 2.0 / max(float(p.Omega), sqrt(p.k / p.m))
    times = np.linspace(float(motion.t_start), float(motion.t_end), POINTS)
    forces = float(abs(p.B0) + p.friction(1) + p.friction(2))
    least = SMALL_MOTION * np.array([forces / float(p.k), forces / float(p.m * p.Omega)])
    scale = np.maximum(np.maximum(np.abs(motion(times)).max(axis=1), least), 1e-300)  # of z and u
    for segment in motion.segments:
        begin = float(segment.t_start)
        end = float(segment.t_end)
        ends = np.linspace(begin, end, 2 + int((end - begin) / longest))
        # Ends of a part, how often it was halved, and the tail of the part that it is a half of.
        todo = [(a, b, 0, inf) for a, b in pairwise(ends) if b > a]
        while todo:
            a, b, halved, tail_before = todo.pop()
            t = np.clip(a + (b - a) * (points + 1) / 2, a, b)
            z, u = motion(t)
            last_coefficients = [
                [abs(linear.dot(row, values)) for values in (z, u)] for row in coefficients[-2:]
            ]
            tail = float((np.array(last_coefficients).max(axis=0) / scale).max())
            is_rounding = ROUNDING > tail > tail_before / 4  # halving hardly helps any more
            if tail > CONVERGED and not is_rounding and halved < MOST_HALVES:
                middle = (a + b) / 2
                todo += [(a, middle, halved + 1, tail), (middle, b, halved + 1, tail)]
            else:
                yield MotionPart(segment, (a, b), t, weights * (b - a) / 2, z, u)


def turning_points(values: np.ndarray) -> np.ndarray:
    """Return where in [-1, 1] a function may have extremes, given its values at Gauss's points.

    These are the two ends, and the turning points of the polynomial that goes through the values.
    """
    series = linear.product(_gauss().coefficients, values)
    slope = legendre.legder(legendre.legtrim(series, CONVERGED * np.abs(series).max()))
    # The polynomial bends too little for two turning points between neighbours of these to matter.
    grid = np.linspace(-1.0, 1.0, 8 * POINTS + 1)
    slopes = legendre.legval(grid, slope)
    turns = np.flatnonzero((slopes[:-1] > 0.0) != (slopes[1:] > 0.0))
    low = grid[turns]
    high = grid[turns + 1]
    # Where the straight line between both slopes is 0; Newton's method starts there.
    inside = low + (high - low) * slopes[turns] / (slopes[turns] - slopes[turns + 1])
    bend = legendre.legder(slope)
    for _ in range(4 if len(turns) else 0):  # Newton's method doubles the digits
        with np.errstate(divide="ignore", invalid="ignore"):
            change = legendre.legval(inside, slope) / legendre.legval(inside, bend)
        inside = np.clip(np.where(np.isfinite(change), inside - change, inside), low, high)
    return np.concatenate([[-1.0, 1.0], inside])


class _Cycle:
    """Integrals and extremes over one cycle of the settled motion, whose parts are added one after
    the other.
    """

    def __init__(self, model: OtherModel) -> None:
        self.model = model
        p = model.parameters
        self.friction_and_speed = [
            (float(p.friction(belt)), float(p.belt(belt))) for belt in p.law.boundaries
        ]
        self.turns = list[np.ndarray]()  # times at which x may be extreme
        self.base_forces = list[float]()  # extremes of the force that the mass passes on
        self.first_harmonic = 0j  # the integral of x exp(-i Omega t)
        self.damper = 0.0  # energy that the damper takes
        self.work = 0.0  # energy that the drive puts in
        self.heat = 0.0  # energy that friction takes
        self.stuck = 0.0  # time on a belt

    def add(self, part: MotionPart) -> None:
        """Add a part of the motion."""
        segment, (begin, end), t, weights, z, u = part
        model = self.model
        belts = self.friction_and_speed
        m, c, k = (float(number) for number in (model.m, model.c, model.k))
        Omega = float(model.Omega)
        delay = float(model.delay)
        columns = column_functions()
        c_late = columns["cos"](Omega * (t + delay))
        s_late = columns["sin"](Omega * (t + delay))
        shift_rate = model.shift.rate(model.Omega)
        base_rate = model.base.rate(model.Omega)
        w, w_rate, w_second = (
            wave.at(c_late, s_late)
            for wave in (model.shift, shift_rate, shift_rate.rate(model.Omega))
        )
        y, y_rate = (wave.at(c_late, s_late) for wave in (model.base, base_rate))
        force = model.force.at(c_late, s_late)
        # z and u are relative to the belts, which move by w; x and v are in the fixed frame.
        x = z + w
        v = u + w_rate
        # All forces but friction.
        drive = float(model.parameters.B0) * columns["cos"](Omega * t)
        driven = float(model.parameters.A0) + drive - c * u - k * z
        pulls = [
            np.full(POINTS, friction * (-1 if u.mean() > speed else 1)) for friction, speed in belts
        ]
        if segment.mode.startswith("belt"):
            # The belt that holds the mass balances all other forces.
            held = int(segment.mode[-1])
            others = [pull for belt, pull in enumerate(pulls, 1) if belt != held]
            pulls[held - 1] = -driven - sum(others)
            self.stuck += end - begin
        acceleration = (driven + sum(pulls)) / m
        # On a belt u is its speed, and it takes nothing.
        self.heat += sum(
            friction * abs(linear.dot(weights, u - speed)) for friction, speed in belts
        )
        self.damper += c * linear.dot(weights, (v - y_rate) ** 2)
        # The power of the force and of the base, then that of the belts.
        pushed = force * v + (k * (y - x) + c * (y_rate - v)) * y_rate
        drawn = sum(pull * (speed + w_rate) for pull, (_, speed) in zip(pulls, belts, strict=True))
        self.work += linear.dot(weights, pushed + drawn)
        self.first_harmonic += complex(
            linear.dot(weights, x * c_late), -linear.dot(weights, x * s_late)
        )
        self.turns.append(begin + (end - begin) * (turning_points(x) + 1) / 2)
        felt = force - m * (acceleration + w_second)
        series = linear.product(_gauss().coefficients, felt)
        self.base_forces += legendre.legval(turning_points(felt), series).tolist()


def cycle_response(
    model: OtherModel, start: tuple[Any, Any, Any], orbit: PeriodicOrbit | None
) -> Record:
    """Return the columns of a response from one cycle of the settled motion through `start` (on
    `orbit`, if any).
    """
    p = model.parameters
    Omega = float(model.Omega)
    if orbit:
        n = orbit.periods
    else:
        n = 1
    period = 2 * pi * n / Omega
    (t0, x0, v0) = start
    motion = simulate(p, t0=t0, x0=x0, v0=v0, t_end=float(t0) + period)
    if motion.status == "undecidable":
        raise _unsettled(motion.message)
    cycle = _Cycle(model)
    for part in parts(motion):
        cycle.add(part)
    times = np.clip(np.concatenate(cycle.turns), float(motion.t_start), float(motion.t_end))
    z_extremes, _ = motion(times)
    belt_positions, *_ = motion_of_belts(model, times + float(model.delay))
    amplitude = float(np.ptp(z_extremes + belt_positions)) / 2
    first = cycle.first_harmonic * (2 / period)
    excitation = _phasor(_excitation(model))
    Y = abs(float(model.Y))
    B0 = abs(float(model.B0))
    ends = motion([motion.t_start, motion.t_end])
    state_at_start, state_at_end = ends.T
    closure = np.abs(state_at_start - state_at_end) / [1, Omega]
    if orbit:
        multiplier = max(abs(complex(value)) for value in orbit.multipliers)
    else:
        multiplier = 0.0
    transmissibility = nan
    if Y:
        transmissibility = amplitude / Y
    elif B0:
        transmissibility = float(np.ptp(cycle.base_forces)) / 2 / B0
    # How far the start is off the orbit: by the gap after this cycle and, times the multiplier each
    # time, after all later ones, which is a geometric series.
    start_error = float(closure.max()) / max(1 - multiplier, CONVERGED)
    return {
        "word": _word(model, orbit) if orbit else "",
        "amplitude": amplitude,
        "transmissibility": transmissibility,
        "phase": phase(excitation / first) if abs(first) > CONVERGED * abs(excitation) else nan,
        "harmonic": abs(first),
        "work": cycle.work / n,
        "dissipated": (cycle.damper + cycle.heat) / n,
        "damper": cycle.damper / n,
        "friction": cycle.heat / n,
        "stuck": cycle.stuck / period,
        "error": start_error + float(np.spacing(amplitude)),
    }


def _word(model: OtherModel, orbit: PeriodicOrbit) -> str:
    """Return the word of an orbit, with the labels of the model's belts."""
    belts = len(model.oscillator.law.belts)
    return str(of_belts(Word(orbit.labels), belts).cycle)


def _excitation(model: OtherModel) -> Harmonic:
    """Return what phases refer to: the motion of the base, else the force, else the belts' speeds."""
    if model.Y:
        return model.base
    if model.B0:
        return model.force
    return harmonic(model.W, model.W_phase)


def _phasor(function: Harmonic) -> complex:
    """Return the complex amplitude E of a harmonic Re(E exp(i Omega t))."""
    return complex(float(function.C), -float(function.S))
