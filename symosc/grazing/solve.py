"""The grazing conditions with one unknown given: equations (54) with F = 0 at the end of the map.

Three equations and an inequality have four unknowns (x_i, Omega t_i, x_j, Omega t_j), the start of a map and its end,
which is the tangency. A given theta_j or x_j fixes the tangency in closed form. For x_i or Omega t_i the grazing curve
shows between which of its samples the value lies. There Newton's method solves for the phase of the tangency and the
time of the flight (`symosc.grazing.newton`). Then the flow back from that tangency is computed anew.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from symosc.aliases import Angle, NumberLike, Progress
from symosc.arguments import public
from symosc.engine.arithmetic import mp_context
from symosc.errors import ParameterError
from symosc.exact import read_digits, read_exact, whole_number
from symosc.grazing.angles import number_of, phase_of, read_phase, times
from symosc.grazing.curve import CURVE_POINTS, LEAST_CURVE_POINTS, MOST_CURVE_POINTS, grazing_curve
from symosc.grazing.newton import Candidates
from symosc.grazing.start import DEFAULT_DIGITS, MOST_START_DIGITS, GrazingStart, grazing_start, start_of
from symosc.grazing.window import GrazingWindow, grazing_window
from symosc.mappings.latex import number, table, words
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters

UNKNOWNS = ("x_i", "theta_i", "x_j", "theta_j", "theta_m")
# Part of a value's size within which a solution must have it, in units of the last digit that was asked for.
CLOSE = 100
MOST_NOTES = 3


class GrazingSolutions(list[GrazingStart]):
    """Solutions of the grazing conditions, in order of theta_m: a list that says what it leaves out.

    Attributes
    ----------
    complete : bool
        Whether the search left nothing out that it met. Even then it may not see solutions that lie nearer to each
        other than the samples of the curve.
    message : str
        Why there is no solution, or what was left out; "" if there is nothing to say.

    Examples
    --------
    >>> from symosc import load_scene, solve_grazing
    >>> solutions = solve_grazing(load_scene("fig9").parameters, "P2", x_i=100)
    >>> len(solutions), solutions.message
    (0, 'x_i goes over 3.65106 to 11.2811 on the grazing curve')
    """

    def __init__(self, starts: Iterable[GrazingStart] = (), complete: bool = True, message: str = "") -> None:
        super().__init__(starts)
        self.complete, self.message = complete, message

    def latex(self) -> str:
        """Return the solutions as a table in LaTeX (an array, no dollar signs); the message if there is none."""
        if not self:
            return words(self.message)
        rows = [[number(each) for each in (start.theta, start.x, start.theta_m, start.x_m)] for start in self]
        return table((r"\Omega t_i", "x_i", r"\Omega t_m", "x_m"), rows)

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


@public
def solve_grazing(
    p: Parameters,
    mapping: str,
    *,
    n: int = CURVE_POINTS,
    digits: int | None = None,
    progress: Progress = False,
    **given: NumberLike,
) -> GrazingSolutions:
    """Solve the grazing conditions of a mapping with one of the unknowns given.

    The map leads from (x_i, theta_i) to the tangency (x_j, theta_j), theta = Omega t mod 2 pi; theta_j is theta_m.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".
    n : int
        Samples of the curve for x_i and theta_i (`grazing_curve`).
    digits : int, optional
        Correct digits of the results; None: floats.
    progress : optional, as for `grazing_curve`
    **given : number
        Exactly one of x_i, theta_i, x_j, theta_j, theta_m.

    Returns
    -------
    GrazingSolutions
        A list of GrazingStart, in order of theta_m, with `complete` and `message`. Each start has the value asked for
        in all its digits. Where a curve runs to minus infinity, theta_i has infinitely many solutions, which gather at
        its end. Listed are those whose theta_m differs from the end in double precision.

    Raises
    ------
    ParameterError
        If not exactly one unknown is given, the mapping has no grazing, k = 0, or the unknown does not fix the
        tangency: x_i or x_j with B0 = 0.

    Examples
    --------
    >>> from symosc import load_scene, solve_grazing
    >>> [start] = solve_grazing(load_scene("fig9").parameters, "P2", x_i=4)
    >>> f"{start.theta:.6f}", f"{start.theta_m:.6f}"
    ('5.085819', '0.612081')
    """
    place(mapping)
    name, value = _read_given(p, given)
    whole_number("n", n, LEAST_CURVE_POINTS, MOST_CURVE_POINTS)
    read_digits(digits, MOST_START_DIGITS)
    window = grazing_window(p, mapping)
    exact = read_exact(name, value) if name in ("x_i", "x_j") else read_phase(name, value)
    if name in ("x_i", "theta_i"):
        solutions = _on_curve(window, name, exact, n, digits, progress)
    else:
        phases = _phases_of_contact(p, mapping, exact) if name == "x_j" else [phase_of(exact)]
        solutions = _at_phases(window, phases, digits)
    if not solutions and not window.kind:
        solutions.message = "the grazing window is empty"
    return solutions


def _read_given(p: Parameters, given: dict[str, NumberLike]) -> tuple[str, NumberLike]:
    """Return the one unknown that is given, if it can fix a tangency."""
    if len(given) != 1 or next(iter(given)) not in UNKNOWNS:
        raise ParameterError("given", ", ".join(given) or None, f"give exactly one of {', '.join(UNKNOWNS)}")
    name, value = next(iter(given.items()))
    if p.k == 0:
        raise ParameterError("k", "0", "must be > 0 here: without a spring F = 0 fixes the phase, not the contact")
    if p.B0 == 0 and name in ("x_i", "x_j"):
        raise ParameterError(name, value, "B0 = 0: all starts have one x, which does not fix the phase")
    return name, value


def _at_phases(window: GrazingWindow, phases: list[Angle], digits: int | None) -> GrazingSolutions:
    """Return the starts of tangencies at exact phases."""
    inside = [phase for phase in phases if window.contains(phase)]
    starts = [grazing_start(window.parameters, window.mapping, phase, digits=digits) for phase in inside]
    found = sorted((start for start in starts if start.found), key=lambda start: float(start.theta_m))
    lost = [f"theta_m = {float(start.theta_m):.12g}: {start.reason}" for start in starts if not start.found]
    message = "; ".join(lost)
    if not inside:
        message = f"no tangency in the grazing window has this value: {window!r}"
    return GrazingSolutions(found, not any(start.undecided for start in starts), message)


def _phases_of_contact(p: Parameters, mapping: str, value: Fraction) -> list[Angle]:
    """Return the phases theta with x_m(theta) = value, exactly."""
    import sympy

    where = place(mapping)
    cosine = (p.k * value + p.c * p.belt(where.boundary) - p.A(where.domain)) / p.B0
    if abs(cosine) > 1:
        return []
    theta = sympy.acos(sympy.Rational(cosine.numerator, cosine.denominator))
    return [theta] if cosine in (1, -1) else [theta, 2 * sympy.pi - theta]


def _on_curve(
    window: GrazingWindow, name: str, value: Any, n: int, digits: int | None, progress: Any
) -> GrazingSolutions:
    """Return the starts on the grazing curve that have a value of x_i or theta_i."""
    p, mapping = window.parameters, window.mapping
    curve = grazing_curve(p, mapping, n, progress=progress)
    candidates = Candidates(curve, name, value, digits or DEFAULT_DIGITS)
    found: list[GrazingStart] = []
    notes = list(candidates.notes)
    for phase in candidates.phases:
        if not window.contains(phase):
            continue
        start = start_of(curve.origins, times(phase, 1 / p.Omega), phase, digits=digits)
        if start.found and has_value(start, p, name, value, digits or DEFAULT_DIGITS):
            found.append(start)
        else:
            notes.append(f"near theta_m = {float(phase):.12g} a solution could not be confirmed")
    found.sort(key=lambda start: float(start.theta_m))
    complete = not notes
    if not found and complete:
        notes.append(candidates.why_none())
    if len(notes) > MOST_NOTES:
        notes[MOST_NOTES:] = [f"and {len(notes) - MOST_NOTES} more such places"]
    return GrazingSolutions(found, complete, "; ".join(notes))


def has_value(start: GrazingStart, p: Parameters, name: str, value: Any, digits: int) -> bool:
    """Return whether a start has a value of x_i or theta_i (mod 2 pi) to the digits of its `start`."""
    context = mp_context(digits + 30)
    if name == "x_i":
        gap, size = number_of(Fraction(start.start["x0"]) - value, context), abs(float(value))
    else:
        angle = number_of(Fraction(start.start["t0"]) * p.Omega, context)
        turns = (angle - number_of(value, context)) / (2 * context.pi)
        gap, size = (turns - context.nint(turns)) * 2 * context.pi, max(float(p.Omega), abs(float(value)))
    return bool(abs(gap) <= CLOSE * context.mpf(10) ** -digits * max(1.0, size))
