"""The grazing curve on the switching plane: all starts (x_i, Omega t_i) of a mapping from which the flow grazes.

Theorem 7's window gives the phases theta_m of the tangencies, and the flow back from each gives the start
(`symosc.grazing.backward_flow`). That is done in double precision with error bounds, and with more digits where these
leave a contact open. The curve ends where the window ends, or where the flow no longer comes from the mapping's belt:
it touches the other belt or its own on the way, or it has met no belt.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import numpy as np

from symosc.aliases import NumberLike, Progress
from symosc.arguments import public
from symosc.display.drawable import Drawable
from symosc.display.progress import late_bar
from symosc.exact import read_exact, whole_number
from symosc.grazing.origin import Origins
from symosc.grazing.phase_runs import PhaseRun, arcs_of, cut, filled, phases_of
from symosc.grazing.tracer import OWN, Sample, Tracer
from symosc.grazing.window import grazing_window
from symosc.mappings.latex import number, point, table, words
from symosc.model import Parameters

CURVE_POINTS = 400
LEAST_CURVE_POINTS, MOST_CURVE_POINTS = 8, 20_000


@dataclass(frozen=True)
class CurveEnd:
    """An end of a piece of the curve.

    Attributes
    ----------
    theta_m : float
        Phase of the tangency there.
    x, theta : float
        The start on the switching plane.
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
        start = rf"{point('i', self.theta, self.x)},\quad \Omega t_m = {number(self.theta_m)}"
        return rf"{start}\quad {words(f'({self.reason})')}"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


@dataclass(frozen=True, eq=False)
class CurvePiece:
    """A stretch of theta_m over which the start moves continuously; columns in order of theta_m.

    Attributes
    ----------
    theta_m, x_m : (n,) arrays
        Phase and place of the tangency. The phase is continuous, so it may leave [0, 2 pi).
    theta, x : (n,) arrays
        The start on the switching plane: Omega t_i = theta_m - Omega tau, unwrapped, and x_i.
    slope_theta, slope_x : (n,) arrays
        Their derivatives by theta_m.
    low, high : CurveEnd
        Both ends in order of theta_m. A closed curve (everything grazes) ends where it began: reason "closed".

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
        return all(np.array_equal(getattr(self, each.name), getattr(other, each.name)) for each in fields(self))

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True)
class GrazingCurve(Drawable):
    """The grazing curve of a mapping.

    Attributes
    ----------
    parameters : Parameters
    mapping : str
    pieces : tuple of CurvePiece
        Empty where no flow from the mapping's belt grazes.
    gaps : tuple of (low, high, origin)
        Stretches of theta_m in the window that have no start, and where the flow comes from there.
    windows : tuple of (low, high)
        The window of theta_m, an arc through 0 in one piece.

    Examples
    --------
    >>> from symosc import grazing_curve, load_scene
    >>> curve = grazing_curve(load_scene("fig9").parameters, "P2")
    >>> curve.mapping, len(curve.pieces), curve.gaps
    ('P2', 1, ())
    """

    parameters: Parameters
    mapping: str
    pieces: tuple[CurvePiece, ...]
    gaps: tuple[tuple[float, float, str], ...]
    windows: tuple[tuple[float, float], ...]
    _source: Tracer = field(repr=False, compare=False)

    def latex(self) -> str:
        """Return the ends of the pieces as LaTeX: a table of (Omega t_i, x_i), Omega t_m and why it ends there."""
        ends = [end for piece in self.pieces for end in (piece.low, piece.high)]
        cells = [(number(end.theta), number(end.x), number(end.theta_m), words(end.reason)) for end in ends]
        heads = r"\Omega t_i", "x_i", r"\Omega t_m", r"\text{end}"
        return table(heads, cells)

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"

    @public
    def sample(self, theta_m: NumberLike) -> Sample:
        """Return the sample at any phase of the window, computed anew."""
        return self._source.sample(float(read_exact("theta_m", theta_m)))

    @property
    def origins(self) -> Origins:
        """The searches that the samples come from."""
        return self._source.origins


@public
def grazing_curve(p: Parameters, mapping: str, n: int = CURVE_POINTS, *, progress: Progress = False) -> GrazingCurve:
    """Return the curve of the starts from which a mapping grazes, with its ends located.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".
    n : int
        Phases to sample over each arc of the window. A piece shorter than their spacing is found where the flow from
        the other belt jumps; elsewhere it may be overlooked. A piece shorter than 1e-6 is always overlooked.
    progress : bool or callable, optional
        True: if it takes more than two seconds, a bar with rate and time left on a terminal. Or a function of two
        numbers: the part that is done, and 1.

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
    window = grazing_window(p, mapping)
    n = whole_number("n", n, LEAST_CURVE_POINTS, MOST_CURVE_POINTS)
    tracer = Tracer(p, mapping)
    arcs = arcs_of(window.intervals)
    runs: list[PhaseRun] = []
    phases = [phases_of(*arc, n) for arc in arcs]
    count, done = sum(map(len, phases)), 0
    with late_bar(progress, f"grazing curve of {mapping}", "phases") as advance:
        for arc, over in zip(arcs, phases, strict=True):
            samples = []
            for theta in over:
                samples.append(tracer.sample(float(theta)))
                done += 1
                if advance:
                    advance(done / count, done)
            runs += cut(tracer, samples, arc)
    pieces = tuple(_piece(filled(tracer, run)) for run in runs if run.origin == OWN)
    gaps = tuple((*run.span, run.origin) for run in runs if run.origin != OWN)
    return GrazingCurve(p, mapping, pieces, gaps, tuple(arc[:2] for arc in arcs), tracer)


def _piece(run: PhaseRun) -> CurvePiece:
    names = ("theta_m", "x_m", "theta", "x", "slope_theta", "slope_x")
    columns = {name: np.array([getattr(sample, name) for sample in run.samples]) for name in names}
    ends = [
        CurveEnd(theta_m, sample.x, sample.theta, reason)
        for theta_m, sample, reason in zip(run.span, (run.samples[0], run.samples[-1]), run.reasons, strict=True)
    ]
    return CurvePiece(**columns, low=ends[0], high=ends[1])
