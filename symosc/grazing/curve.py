"""The grazing curve on the switching plane: all starts (x_i, Omega t_i) of a mapping from which the
flow grazes.

Theorem 7's window gives the phases theta_m of the tangencies, and the flow back from each gives the
start (`symosc.grazing.backward`). That is done in double precision with error bounds, and with more
digits where these leave a contact undecided. The curve ends where the window ends, or where the
flow no longer comes from the mapping's belt: it touches the other belt or its own on the way, or it
has met no belt. Between neighbours of which one comes from the mapping's belt and the other does
not the edge is found by halving, and so is a jump of the start. A stretch that is steep gets more
samples, until its slopes explain it.

Between a tangency and its start, tau earlier, a shift of theta_m along the contacts moves the start
by

    d(Omega t_i)/d(theta_m) = -exp(c tau/m) E1(tau) G1/a_i
    d(x_i)/d(theta_m)       = (v_lambda d(Omega t_i)/d(theta_m) + exp(c tau/m) E0(tau) G1 m/k)/Omega

with G1 = G^(1) at the tangency and a_i the acceleration at the start: at a fixed time neighbouring
contacts differ in x only.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from math import cos, exp, inf, nan, pi, sin
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import NumberLike, Progress
from symosc.base.arguments import PROGRESS, TEXT, public, require
from symosc.base.display.drawable import Drawable
from symosc.base.display.latex import (
    LatexAnswer,
    latex_number,
    latex_point,
    latex_table,
    latex_words,
)
from symosc.base.display.progress import late_bar
from symosc.base.exact import read_exact, whole_number
from symosc.engine.arithmetic import column_functions
from symosc.grazing.backward import (
    CONTACT,
    MOST_BACKWARD_STEPS,
    NEVER,
    STEP,
    TOUCH,
    BackwardState,
    Origins,
)
from symosc.grazing.window import grazing_window
from symosc.kernels.entire import basis
from symosc.kernels.theorem7_cases import ARC, EMPTY, EVERYTHING
from symosc.model import Parameters
from symosc.scenes import ParametersLike, parameters_for

CURVE_POINTS = 400
LEAST_CURVE_POINTS = 8
MOST_CURVE_POINTS = 20_000
PIECE_POINTS = 33
# Omega t_i changes by more than the slopes explain, and so much is left of it after halving: it is
# a jump.
CURVE_JUMP = 1e-3
# Shorter pieces are not searched: there double precision begins to take near contacts for touches.
FINEST_CURVE = 1e-6
# A piece has enough samples if PIECE_POINTS of them are farther than this part of it from its ends.
NEAR_ENDS = 0.1
# How near to an open end of the window the curve is sampled, as a part of the arc.
GAP_AT_END = 1e-7
# A change of theta_i is continuous if the slopes explain it but for this part.
EXPLAINED = 0.25
# Digits with which a contact is decided that doubles leave undecided.
CAREFUL_DIGITS = 30
# At |k v_lambda| = |B0| Omega a G^(1) below this part of its terms is that of the tangency of fourth
# order.
FLAT = 1e-13
# Steps of all searches for one curve; when they are used up, each search has LEAST_STEPS left.
MOST_STEPS_OF_ALL = 40_000
LEAST_STEPS = 50

#: The slope of the start's phase among flows that start at a graze too.
SLOPE_OF_TOUCHES = 1.0
#: exp of more overflows.
LARGEST_EXPONENT = 700.0
#: A change of theta_i between samples that is always continuous.
SMALL_CHANGE = 0.2
#: How often an edge is halved: down to rounding, or a few times where a search ended.
MOST_HALVINGS = 50
FEW_HALVINGS = 8

#: Where the flow of a sample came from.
OWN = "own belt"
OTHER = "other belt"
NOWHERE = "no belt"
UNKNOWN = "not within the search"


@dataclass(frozen=True)
class CurveEnd(LatexAnswer):
    """An end of a piece of the grazing curve, with the reason why the curve ends there.

    Attributes
    ----------
    theta_m : float
        Phase of the tangency at this end.
    x, theta : float
        The start of the flight on the switching plane.
    reason : str
        Why the curve ends.

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene
    >>> end = grazing_curve(load_scene("fig9").parameters, "P2").pieces[0].high
    >>> f"{end.theta_m:.4f}", end.reason
    ('3.2250', 'end of the window')
    """

    theta_m: float
    x: float
    theta: float
    reason: str

    def latex(self) -> str:
        """Return the end as LaTeX (no dollar signs)."""
        start = (
            rf"{latex_point('i', self.theta, self.x)},\quad \Omega t_m = "
            rf"{latex_number(self.theta_m)}"
        )
        return rf"{start}\quad {latex_words(f'({self.reason})')}"


@dataclass(frozen=True, eq=False)
class CurvePiece:
    """A piece of the grazing curve, along which the start of the flight moves continuously with
    theta_m.

    Attributes
    ----------
    theta_m, x_m : (n,) arrays
        Phase and position of the tangency. Phases are continuous along the piece, so they may leave
        [0, 2 pi).
    theta, x : (n,) arrays
        Phase and position of the start on the switching plane: Omega t_i = theta_m - Omega tau,
        unwrapped, and x_i.
    slope_theta, slope_x : (n,) arrays
        The derivatives of theta and x with respect to theta_m.
    low, high : CurveEnd
        Both ends in order of theta_m. A closed curve (everything grazes) ends where it began:
        reason "closed".

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene
    >>> piece = grazing_curve(load_scene("fig9").parameters, "P2").pieces[0]
    >>> print(f"theta_m from {piece.theta_m[0]:.4f} to {piece.theta_m[-1]:.4f}")
    theta_m from -0.0834 to 3.2250
    """

    theta_m: np.ndarray
    x_m: np.ndarray
    theta: np.ndarray
    x: np.ndarray
    slope_theta: np.ndarray
    slope_x: np.ndarray
    low: CurveEnd
    high: CurveEnd

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, CurvePiece):
            return NotImplemented
        return all(
            np.array_equal(getattr(self, field.name), getattr(other, field.name))
            for field in fields(self)
        )


@dataclass(frozen=True, repr=False)
class GrazingCurve(Drawable, LatexAnswer):
    """The grazing curve of a mapping: the starts whose flights graze, in pieces over the phase
    theta_m of the graze.

    Attributes
    ----------
    parameters : Parameters
    mapping : str
    pieces : tuple of CurvePiece
        Empty where no flow from the mapping's belt grazes.
    gaps : tuple of (low, high, origin)
        The intervals (low, high) of theta_m in the window for which no flight from the mapping's
        belt grazes; `origin` says where the flow comes from instead.
    windows : tuple of (low, high)
        The window of theta_m, an arc through 0 in one piece.

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene
    >>> curve = grazing_curve(load_scene("fig9").parameters, "P2")
    >>> curve.mapping, len(curve.pieces), curve.gaps
    ('P2', 1, ())
    """

    _drawn_by = "figure_grazing_curve"
    _made_by = "grazing_curve(...)"

    parameters: Parameters
    mapping: str
    pieces: tuple[CurvePiece, ...]
    gaps: tuple[tuple[float, float, str], ...]
    windows: tuple[tuple[float, float], ...]
    _source: Tracer = field(compare=False)

    def __repr__(self) -> str:
        return f"<GrazingCurve of {self.mapping}: pieces {len(self.pieces)}, gaps {len(self.gaps)}>"

    def latex(self) -> str:
        """Return the ends of the pieces as a LaTeX table: (Omega t_i, x_i), Omega t_m and the
        reason.
        """
        ends = [end for piece in self.pieces for end in (piece.low, piece.high)]
        rows = [
            [*map(latex_number, (end.theta, end.x, end.theta_m)), latex_words(end.reason)]
            for end in ends
        ]
        return latex_table((r"\Omega t_i", "x_i", r"\Omega t_m", r"\text{end}"), rows)

    @public
    def sample(self, theta_m: NumberLike) -> Sample:
        """Compute the tangency at theta_m, the start of the flow into it, and the derivatives of
        the start.
        """
        return self._source.sample(float(read_exact("theta_m", theta_m)))


@public
def grazing_curve(
    p: ParametersLike, mapping: str, n: int = CURVE_POINTS, *, progress: Progress = False
) -> GrazingCurve:
    """Return the curve of the starts from which a mapping grazes, with its ends located.

    Parameters
    ----------
    p : Parameters, or a Scene, its name or its file
    mapping : str
        "P2", "P3", "P5" or "P6".
    n : int
        The number of phases to sample over each arc of the window. A piece of the curve shorter
        than their spacing may be overlooked, unless the start of the flow on the other belt jumps
        there. A piece shorter than 1e-6 is always overlooked.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a
        function of two numbers: the part that is done, and 1.

    Raises
    ------
    ParameterError
        For a mapping without grazing, k = 0, or too small an n.

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene
    >>> curve = grazing_curve(load_scene("fig9").parameters, "P2")
    >>> [f"{end.x:.4f}" for end in (curve.pieces[0].low, curve.pieces[0].high)]
    ['3.9229', '11.0820']
    """
    p = parameters_for(p, mapping=mapping)
    require(TEXT, mapping=mapping)
    require(*PROGRESS, progress=progress)
    window = grazing_window(p, mapping)
    n = whole_number("n", n, LEAST_CURVE_POINTS, MOST_CURVE_POINTS)
    tracer = Tracer(p, mapping)
    if window.kind == EMPTY:
        return GrazingCurve(p, mapping, (), (), (), tracer)
    if window.kind == EVERYTHING:
        low = 0.0
        high = 2 * pi
    else:
        low, high = window.ends
    if window.kind not in (EVERYTHING, ARC):  # an arc through 0 has a negative low end
        low -= 2 * pi
    arc = (low, high, window.kind == EVERYTHING)
    samples = []
    with late_bar(progress, f"grazing curve of {mapping}", "phases") as advance:
        phases = _phases_of(*arc, n)
        for done, theta in enumerate(phases, start=1):
            samples.append(tracer.sample(float(theta)))
            if advance:
                advance(done / len(phases), done)
    runs = _cut(tracer, samples, arc)
    pieces = tuple(_piece(tracer, run) for run in runs if run.origin == OWN)
    gaps = tuple((*run.span, run.origin) for run in runs if run.origin != OWN)
    return GrazingCurve(p, mapping, pieces, gaps, ((low, high),), tracer)


def _piece(tracer: Tracer, run: PhaseRun) -> CurvePiece:
    """Return a run of samples as a piece of the curve, with PIECE_POINTS more samples if it has few
    inner ones.
    """
    samples = run.samples
    first = samples[0].theta_m
    last = samples[-1].theta_m
    margin = NEAR_ENDS * (last - first)
    inside = [s for s in samples if first + margin < s.theta_m < last - margin]
    has_few = len(inside) < PIECE_POINTS
    if has_few and last - first >= FINEST_CURVE:
        between = [
            tracer.sample(float(theta)) for theta in np.linspace(first, last, PIECE_POINTS)[1:-1]
        ]
        inner = [sample for sample in between if sample.origin == OWN]
        samples = sorted([*samples, *inner], key=lambda sample: sample.theta_m)
    names = ("theta_m", "x_m", "theta", "x", "slope_theta", "slope_x")
    columns = {name: np.array([getattr(sample, name) for sample in samples]) for name in names}
    low_phase, high_phase = run.span
    low_reason, high_reason = run.reasons
    low = CurveEnd(low_phase, samples[0].x, samples[0].theta, low_reason)
    high = CurveEnd(high_phase, samples[-1].x, samples[-1].theta, high_reason)
    return CurvePiece(**columns, low=low, high=high)


# --- samples ---


@dataclass(frozen=True)
class Sample:
    """A tangency at theta_m and where its flow starts: on which belt (`origin`), x, and theta =
    theta_m - Omega tau.
    """

    theta_m: float
    x_m: float
    origin: str
    x: float
    theta: float
    slope_x: float
    slope_theta: float
    undecided: bool = False  # a touch that more digits may decide


class Tracer(Origins):
    """A sampler of one mapping's curve, in doubles with precision escalation."""

    def __init__(self, p: Parameters, mapping: str) -> None:
        super().__init__(p, mapping)
        self.v = float(p.belt(self.place.boundary))
        self.rest = float((p.A(self.place.domain) - p.c * p.belt(self.place.boundary)) / p.k)
        self.gain = float(p.B0 / p.k)
        self.steps_left = MOST_STEPS_OF_ALL

    def sample(self, theta_m: float, careful: bool = True) -> Sample:
        """Return the sample at theta_m; without `careful` an undecided contact counts as a graze."""
        K = self.K
        order = self._order_at(theta_m)
        steps = max(LEAST_STEPS, min(MOST_BACKWARD_STEPS, self.steps_left))
        arrival = self.arrival(
            theta_m, order, digits=CAREFUL_DIGITS, repeats=int(careful), most_steps=steps
        )
        tau = float(arrival.tau)
        dx = float(arrival.dx)
        self.steps_left -= int(tau * K.rate / STEP)
        x_m = self.rest + self.gain * cos(theta_m)
        if arrival.kind not in (CONTACT, TOUCH):
            origin = NOWHERE if arrival.kind == NEVER else UNKNOWN
            return Sample(theta_m, x_m, origin, x=nan, theta=nan, slope_x=nan, slope_theta=nan)
        slope_x, slope_theta = self._slopes(theta_m, arrival)
        if arrival.boundary == self.place.boundary:
            origin = OWN
        else:
            origin = OTHER
        return Sample(
            theta_m,
            x_m,
            origin,
            x=x_m + dx,
            theta=theta_m - K.Om * tau,
            slope_x=slope_x,
            slope_theta=slope_theta,
            undecided=not careful and arrival.kind == TOUCH,
        )

    def _slopes(self, theta_m: float, arrival: BackwardState) -> tuple[float, float]:
        """Return the derivatives by theta_m of x and theta at the start `arrival` of a flow."""
        # By the implicit function theorem: at the start v is that of the belt (the formulas at the
        # top of the module). `growth` is that of a flow followed back.
        K = self.K
        tau = float(arrival.tau)
        a = float(arrival.a)
        G1 = -(K.w0sq * self.v + K.fB * sin(theta_m))
        E0, E1, *_ = basis(tau, K)
        growth = exp(min(K.cm * tau, LARGEST_EXPONENT))
        if arrival.kind == TOUCH:  # neighbours that touch as well do it after the same time
            slope_theta = SLOPE_OF_TOUCHES
        elif a != 0.0:
            slope_theta = -growth * E1 * G1 / a
        else:
            slope_theta = inf
        slope_x = (self.v * slope_theta + growth * E0 * G1 / K.w0sq) / K.Om
        return slope_x, slope_theta

    def _order_at(self, theta_m: float) -> int:
        """Return the order of the first G-function that does not vanish at the tangency: 1, or 3
        where it is one of fourth order.
        """
        K = self.K
        level = K.w0sq * self.v
        is_flat = abs(level + K.fB * sin(theta_m)) <= FLAT * abs(level)
        pull = abs(self.p.k * self.p.belt(self.place.boundary))
        if is_flat and pull == abs(self.p.B0 * self.p.Omega):
            return 3
        return 1


# --- pieces ---


def _phases_of(low: float, high: float, closed: bool, n: int) -> np.ndarray:
    """Return n phases in an arc, densest near open ends, with both ends of a closed one included."""
    if closed:
        return low + (high - low) * (np.arange(n + 1) / n)
    # Chebyshev's nodes, and one phase just inside each end.
    waves = column_functions()["cos"](pi * (np.arange(n - 2) + 0.5) / (n - 2))
    inner = 0.5 * (low + high) - 0.5 * (high - low) * waves
    gap = GAP_AT_END * (high - low)
    first = low + gap
    last = high - gap
    return np.concatenate([[first], inner[(inner > first) & (inner < last)], [last]])


@dataclass
class PhaseRun:
    """Neighbouring samples whose flows come from one belt without a jump, and their interval of
    theta_m.
    """

    samples: list[Sample]
    span: tuple[float, float]
    reasons: tuple[str, str]

    @property
    def origin(self) -> str:
        """Where the flow backward from these tangencies ends: own belt, other belt, no belt, or not
        found.
        """
        return self.samples[0].origin


def _cut(tracer: Tracer, samples: list[Sample], arc: tuple[float, float, bool]) -> list[PhaseRun]:
    """Split the samples of an arc into runs where the origin of the flow changes or the start
    jumps.
    """
    low, high, is_closed = arc
    if is_closed:
        limit = "closed"
    else:
        limit = "end of the window"
    runs: list[PhaseRun] = []
    run = [samples[0]]
    begin = low
    reason = limit
    ahead = samples[:0:-1]  # all but the first, the next one last
    while ahead:
        left = run[-1]
        right = ahead[-1]
        are_own = left.origin == right.origin == OWN
        distance = right.theta_m - left.theta_m
        if are_own and distance > FINEST_CURVE and not _continuous(left, right):
            # Steep, or a jump: a sample between them tells.
            ahead.append(tracer.sample(0.5 * (left.theta_m + right.theta_m)))
            continue
        edge = _edge(tracer, left, right)
        if edge is None:
            run.append(ahead.pop())
            continue
        run += edge.before
        last_before = run[-1]
        first_behind = edge.behind[-1]
        end_reason = _end_reason(tracer, last_before, first_behind)
        runs.append(PhaseRun(run, (begin, edge.theta_m), (reason, end_reason)))
        begin = edge.theta_m
        reason = _end_reason(tracer, first_behind, last_before)
        ahead[-1:] = edge.behind  # in place of `right`, which is the first of them
        run = [ahead.pop()]
    runs.append(PhaseRun(run, (begin, high), (reason, limit)))
    first = runs[0]
    last = runs[-1]
    if not is_closed or first is last or first.origin != last.origin:
        return runs
    # The last run of a full circle is joined to the first, one turn later.
    turn = 2 * pi
    later = [
        replace(sample, theta_m=sample.theta_m + turn, theta=sample.theta + turn)
        for sample in first.samples[1:]
    ]
    begin, _ = last.span
    _, end = first.span
    begin_reason, _ = last.reasons
    _, end_reason = first.reasons
    joined = PhaseRun(last.samples + later, (begin, end + turn), (begin_reason, end_reason))
    return [*runs[1:-1], joined]


def _continuous(left: Sample, right: Sample) -> bool:
    """Return whether the start's phase does not jump between two samples: it changes by little or
    as its slope says.
    """
    change = right.theta - left.theta
    expected = 0.5 * (left.slope_theta + right.slope_theta) * (right.theta_m - left.theta_m)
    is_large = abs(change) > SMALL_CHANGE  # so nan counts as continuous
    return not is_large or abs(change - expected) <= EXPLAINED * abs(change)


class OriginEdge(NamedTuple):
    """A change of origin, or a jump of the start, at `theta_m`: new samples before it, and those
    behind it, the one that is farthest from it first.
    """

    before: list[Sample]
    behind: list[Sample]
    theta_m: float


def _edge(tracer: Tracer, left: Sample, right: Sample) -> OriginEdge | None:
    """Locate the change of origin, or the jump of the start, between two samples; None if there is
    none. The first sample behind it is `right`.
    """
    # Jumps among flows from the other belt are no edges, but something may hide behind them.
    if left.origin == right.origin and _continuous(left, right):
        return None
    lefts = list[Sample]()
    rights = [right]
    # Down to rounding, but not where the search ends in one of them: that is not an end of the
    # curve.
    rounds = FEW_HALVINGS if UNKNOWN in (left.origin, right.origin) else MOST_HALVINGS
    for _ in range(rounds):
        theta = 0.5 * (left.theta_m + right.theta_m)
        if not left.theta_m < theta < right.theta_m:
            break
        if left.origin == right.origin and abs(right.theta - left.theta) < CURVE_JUMP:
            return None
        middle = tracer.sample(theta, careful=False)
        # A change of origin is halved by the origin, a jump by which side the start is nearer to.
        to_left = middle.origin == left.origin
        if left.origin == right.origin:
            # Another origin between two equal ones: too short a piece.
            if not to_left and right.theta_m - left.theta_m < FINEST_CURVE:
                return None
            to_left = to_left and abs(middle.theta - left.theta) < abs(right.theta - middle.theta)
        if to_left:
            left = middle
            lefts.append(middle)
        else:
            right = middle
            rights.append(middle)
    is_jump = left.origin == OWN and not abs(right.theta - left.theta) < CURVE_JUMP
    if left.origin == right.origin and not is_jump:
        return None
    return OriginEdge(
        [sample for sample in lefts if not sample.undecided],
        [sample for sample in rights if not sample.undecided],
        0.5 * (left.theta_m + right.theta_m),
    )


def _end_reason(tracer: Tracer, here: Sample, beyond: Sample) -> str:
    """Say why a run of samples of one origin ends between its last sample `here` and the sample
    `beyond`.

    The run may be followed in either direction, so that this is why it begins too.
    """
    own = tracer.place.boundary
    if beyond.origin == OTHER:
        return f"beyond, the flow comes from belt {3 - own}"
    if beyond.origin in (NOWHERE, UNKNOWN):
        met_no_belt = "beyond, the flow met no belt before"
        if beyond.origin == UNKNOWN:
            return f"{met_no_belt} (within the search)"
        return met_no_belt
    if here.origin != OWN:
        return f"beyond, the flow comes from belt {own}"
    return f"the flow touches belt {own} on the way"
