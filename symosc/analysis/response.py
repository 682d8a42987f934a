"""The frequency response: what the settled motion does per cycle of the drive, over one parameter.

The settled motion is the periodic orbit, or the motion that meets no belt, or a rest: for each of
them one cycle is followed, exactly (`symosc.analysis.response_cycle`). Under a law that does not
contract, which of several settled motions is reached depends on the start: the motion is followed
from value to value, upwards and downwards.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from fractions import Fraction
from math import asin, hypot, inf, nan, pi, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from symosc.analysis.response_cycle import cycle_response, phasor, unsettled
from symosc.base.aliases import Number, Progress, Record, SceneName
from symosc.base.arguments import (
    ARRAY_LIKE,
    PROGRESS,
    TEXT,
    mapping_of,
    public,
    require,
    require_or_none,
)
from symosc.base.display.frames import imported
from symosc.base.display.progress import late_bar
from symosc.base.errors import ParameterError, meant
from symosc.base.exact import show
from symosc.base.files import write_text
from symosc.kernels.elementary import cos, sin
from symosc.model import OSCILLATOR_NAMES, Model, Oscillator, Parameters, by_name
from symosc.orbits.closing_equations import ConvergenceError
from symosc.orbits.find import find_orbit, is_of_paper, settled_orbit
from symosc.orbits.floquet import rest_positions
from symosc.orbits.followed_orbit import FollowedOrbit
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.orbits.settling import settled_orbit_of
from symosc.reductions import OtherModel, number_names, reduced_model, with_numbers
from symosc.scenes import Scene, problem_of
from symosc.simulation.simulate import simulate
from symosc.simulation.tables import Columns
from symosc.sweeps.plan import read_axis
from symosc.words import Word, WordError

#: Periods after which a motion from harmonic balance is examined for an orbit, one after the other.
FOLLOWED = 3, 12, 48
#: The columns of a response, beside that of the parameter.
COLUMNS = (
    "status", "word", "amplitude", "transmissibility", "phase", "harmonic", "work", "dissipated", "damper", "friction",
    "stuck", "balance", "balance_error", "error",
)  # fmt: skip
#: What is said of an oscillator without a spring.
NEEDS_SPRING = "must be > 0: without a spring nothing fixes the position of a settled motion"
#: The ways in which a motion is followed from value to value.
UPWARDS = "up"
DOWNWARDS = "down"
BOTH_WAYS = "both"
#: Forcing periods after which a motion that does not settle hands its state on.
HANDED_ON = 20


class FrequencyResponse(Columns):
    """The settled motion for each value of one parameter, as columns in the coordinates of the
    model that was given.

    Attributes
    ----------
    name : str
        The parameter.
    values : array, (n,)
        Its values, which its own name has too: `response.Omega`.
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
    direction : array of str
        "up" or "down": how the motion came to this value, where several may be settled; "" under
        the paper's law.

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
        if name == "direction":
            return np.full(len(self.values), "")
        parameter = self.__dict__.get("name", "name")
        if name == parameter:
            return self.values
        has = ", ".join([parameter, *COLUMNS])
        raise AttributeError(f"FrequencyResponse has no column {name!r}; it has {has}")

    def columns(self) -> dict[str, np.ndarray]:
        """Return all columns by name, first the column of the parameter."""
        columns = {self.name: self.values}
        if (self.direction != "").any():
            columns["direction"] = self.direction
        return columns | {name: getattr(self, name) for name in COLUMNS}

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per value; MissingExtraError if pandas is not installed."""
        return imported("pandas").DataFrame(self.columns())

    @public
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
    what: Scene | Model | OtherModel | SceneName,
    over: Mapping[str, ArrayLike],
    *,
    direction: str | None = None,
    progress: Progress = False,
) -> FrequencyResponse:
    """Return amplitude, transmissibility, phase, energies and time of sticking of the settled
    motion over a parameter.

    Parameters
    ----------
    what : Scene, its name or file, Parameters, Oscillator or OtherModel
        With k > 0. The start of a scene counts only under another law than the paper's.
    over : mapping
        One parameter, or number of the model, with its values, or text ``"LO:HI:N"``: ``{"Omega":
        "0.5:2:100"}``. Numbers of belts have the names of `Oscillator.numbers`.
    direction : str, optional
        With static friction, or friction that depends on speed, several motions may be settled. The
        motion is followed from value to value, each from the state of the one before: "up", "down"
        or, the default, "both": all rows upwards and then all downwards.
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
    require_or_none(TEXT, direction=direction)
    problem = problem_of(what, "what", any_law=True)
    model = _model_of(problem)
    if not isinstance(over, Mapping) or len(over) != 1:
        raise ParameterError(
            "over", over, 'must be one parameter with its values, such as {"Omega": "0.5:2:100"}'
        )
    ((name, axis),) = over.items()
    known = number_names(model)
    if name not in known:
        allowed = f"is not a parameter of the model; choose one of {', '.join(known)}"
        raise ParameterError("over", name, allowed + meant(str(name), known))
    if name == "pull" or model.pull != 0:
        raise ParameterError(
            "pull", show(model.pull), "must be 0: the motion of a pulled spring is not periodic"
        )
    values = read_axis(name, axis)
    if is_of_paper(reduced_model(with_numbers(model, {name: values[0].item()}))):
        if direction is not None:
            allowed = "must be omitted: under this law the settled motion is the only one"
            raise ParameterError("direction", direction, allowed)
        ways = [""]
    else:
        ways = _ways(direction)
    rows = list[Record]()
    settled_at = list[np.ndarray]()
    total = len(ways) * len(values)
    before = None
    state = _start_of(problem)
    with late_bar(progress, f"response over {name}", "values") as advance:
        for way in ways:
            followed = _in_order(values, way)
            settled_at.append(followed)
            for value in followed.tolist():
                changed = with_numbers(model, {name: value})
                if way:
                    row, state = respond_from(changed, state)
                else:
                    row, before = respond(changed, before)
                rows.append(row)
                if advance:
                    advance(len(rows) / total, len(rows))
    missing: Record = {"word": ""}
    columns = {
        column: np.array([row.get(column, missing.get(column, nan)) for row in rows])
        for column in COLUMNS
    }
    if ways != [""]:
        columns["direction"] = np.repeat(ways, len(values))
    return FrequencyResponse(name=name, values=np.concatenate(settled_at), **columns)


def _ways(direction: str | None) -> list[str]:
    """Return the ways in which the values are followed, given the argument `direction`."""
    if direction in (None, BOTH_WAYS):
        return [UPWARDS, DOWNWARDS]
    if direction not in (UPWARDS, DOWNWARDS):
        raise ParameterError("direction", direction, 'must be "up", "down" or "both"')
    return [direction]


def _in_order(values: np.ndarray, way: str) -> np.ndarray:
    """Return values in the order in which they are followed."""
    if way == UPWARDS:
        return np.sort(values)
    if way == DOWNWARDS:
        return np.sort(values)[::-1]
    return values


def _start_of(problem: Scene | Model | OtherModel) -> tuple[Number, Number]:
    """Return x and v from where the first settled motion is reached."""
    if isinstance(problem, Scene):
        return problem.x0, problem.v0
    return 0.0, 0.0


def _model_of(problem: Scene | Model | OtherModel) -> OtherModel:
    """Return a problem as an OtherModel; by default its base is at rest."""
    if isinstance(problem, OtherModel):
        return problem
    if isinstance(problem, Scene):
        if problem.original is not None:
            return problem.original.model
        problem = problem.parameters
    if isinstance(problem, Oscillator) and not is_of_paper(problem):
        if problem.has_free_clock:
            raise ParameterError("Omega", None, "Omega is required: a response is to a drive")
        shared = {name: getattr(problem, name) for name in OSCILLATOR_NAMES}
        return OtherModel(**shared, belts=problem.belts)
    numbers = by_name(problem.parameters)
    if len(problem.law.belts) == 1:
        del numbers["v2"]
        del numbers["mu2"]
    return OtherModel(**numbers)


def respond_from(
    model: OtherModel, state: tuple[Number, Number]
) -> tuple[Record, tuple[Number, Number]]:
    """Return one row of a `FrequencyResponse`, of the motion that settles from x and v at the phase
    0 of the drive, and x and v there once it has settled.
    """
    p = reduced_model(model)
    if p.k == 0:
        raise ParameterError("k", 0, NEEDS_SPRING)
    if p.B0 == 0:
        allowed = (
            "must not be 0 under this law: a response is to a drive; `find_orbit` and "
            "`continue_orbit` follow limit cycles"
        )
        raise ParameterError("B0", 0, allowed)
    x, v = state
    try:
        orbit = settled_orbit_of(p, 0, x, v)
        row = cycle_response(model, p, orbit.start, orbit)
    except ConvergenceError as error:
        end = HANDED_ON * 2 * pi / float(p.Omega)
        motion = simulate(p, t0=0, x0=x, v0=v, t_end=end, accuracy=inf)
        x, v = motion(motion.t_end).tolist()
        return {"status": error.reason}, (x, v)
    x, v = orbit(0.0).tolist()
    return {"status": _status_of(orbit)} | row, (x, v)


def _status_of(orbit: FollowedOrbit) -> str:
    """Return the status of a motion that has settled to an orbit or a rest."""
    if orbit.is_rest:
        return "rest"
    if not orbit.stable:
        return "marginal orbit"
    if orbit.labels:
        return "orbit"
    return "linear"


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
        raise ParameterError("k", 0, NEEDS_SPRING)
    delay = float(model.delay * model.Omega)
    late = complex(cos(delay), -sin(delay))
    mean, z = harmonic_balance(p)
    if z == inf:
        balance = inf
    else:
        balance = abs(phasor(model.shift) + late * z)
    try:
        if z == inf:
            raise unsettled("the motion grows for ever, at resonance without a damper")
        status, start, orbit = settle(p, (mean + z.real, -float(p.Omega) * z.imag), before)
        row = cycle_response(model, p, start, orbit)
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
            raise unsettled("without a damper the motion between the belts goes on for ever")
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
