"""Theorem 6 at a given state, to any order: does the flow touch the belt there?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from symosc.aliases import Context, Mpf, NumberLike
from symosc.arguments import public
from symosc.engine.arithmetic import mp_context
from symosc.errors import ParameterError
from symosc.exact import read_exact
from symosc.grazing.angles import number_of, read_angle, read_phase
from symosc.kernels._generated import next_derivative
from symosc.mappings.latex import number
from symosc.mappings.theorem7_cases import Place, place
from symosc.model import Parameters

# G-functions up to this part of the size of their terms count as 0.
G_TOLERANCE = 1e-12
MOST_G_ORDERS = 6


@dataclass(frozen=True)
class GrazingVerdict:
    """Theorem 6 at a state, to any order.

    Attributes
    ----------
    grazing : bool
    order : int
        Of the first G-function that does not vanish (0 is F); MOST_G_ORDERS if none was found.
    values : tuple of float
        G^(0), G^(1), ... up to that order; a value that counts as 0 enters the next one as 0.
    margins : tuple of float
        Each value relative to the sum of the sizes of its terms; at or below `tolerance` it counts as 0.
    tolerance : float
    reason : str

    Examples
    --------
    >>> from symosc import is_grazing, load_scene
    >>> verdict = is_grazing(load_scene("fig9").parameters, "P2", x=0, theta=1)
    >>> verdict.grazing, verdict.order, verdict.reason
    (False, 0, 'F does not vanish: the flow is transversal')
    """

    grazing: bool
    order: int
    values: tuple[float, ...]
    margins: tuple[float, ...]
    tolerance: float
    reason: str

    def latex(self) -> str:
        """Return the G-functions that decide, with the reason, as LaTeX (no dollar signs)."""
        names = ["F", *(f"G^{{({order})}}" for order in range(1, len(self.values)))]
        small = [margin <= self.tolerance for margin in self.margins]
        shown = [
            f"{name} = {'0' if zero else number(value)}"
            for name, value, zero in zip(names, self.values, small, strict=True)
        ]
        return rf"{', '.join(shown)}:\quad \text{{{'it grazes' if self.grazing else 'it does not graze'}}}"

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"


@public
def is_grazing(
    p: Parameters, mapping: str, x: NumberLike, theta: NumberLike, *, tolerance: NumberLike = G_TOLERANCE
) -> GrazingVerdict:
    """Decide Theorem 6 for a state on the belt of a mapping: does the flow of its domain touch the belt there?

    The flow grazes if F = 0, and the first G-function that does not vanish has odd order and the sign that leads back
    into the domain. (Order 1 is the theorem as printed.) Values are computed with 50 digits; `tolerance` says what
    counts as 0.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6": belt and domain.
    x, theta : number
        Position and phase; strings and sympy constants are exact.
    tolerance : float
        Part of the size of its terms up to which a G-function counts as 0; less than 1.

    Raises
    ------
    ParameterError
        For a mapping without grazing, and for values that are not numbers or are out of range.

    Examples
    --------
    >>> from symosc import grazing_window, is_grazing, load_scene
    >>> p = load_scene("fig9").parameters
    >>> x = grazing_window(p, "P2").contact("1")
    >>> is_grazing(p, "P2", x, "1").grazing
    True
    """
    where = place(mapping)
    limit = read_exact("tolerance", tolerance)
    if not 0 <= limit < 1:
        raise ParameterError("tolerance", tolerance, "must be >= 0 and < 1")
    tolerance = float(limit)
    context = mp_context(50)
    angle = number_of(read_phase("theta", theta), context)
    position = number_of(read_angle("x", x), context)
    values, margins = [], []
    for order, (value, size) in enumerate(_g_functions(p, where, position, angle, context)):
        margin = abs(value) / size if size > 0 else abs(value)
        values.append(float(value))
        margins.append(float(margin))
        if margin > tolerance:
            grazing = order % 2 == 1 and where.side * value < 0
            return GrazingVerdict(grazing, order, tuple(values), tuple(margins), tolerance, _why(order, grazing))
    reason = "F and all its derivatives vanish: the flow stays on the belt"
    return GrazingVerdict(False, MOST_G_ORDERS, tuple(values), tuple(margins), tolerance, reason)


def _g_functions(p: Parameters, where: Place, x: Mpf, theta: Mpf, context: Context) -> Iterator[tuple[Mpf, Mpf]]:
    """Yield G^(0) = F, G^(1), ... on the belt, each with the size of its terms; those before it count as 0."""
    v = number_of(p.belt(where.boundary), context)
    cm, w0sq, f0 = (number_of(q / p.m, context) for q in (p.c, p.k, p.B0))
    Om = number_of(p.Omega, context)
    terms = [number_of(p.A(where.domain) / p.m, context), f0 * context.cos(theta), -w0sq * x, -cm * v]
    value, size = sum(terms), sum(abs(term) for term in terms)
    before, sines = v, (context.sin(theta), context.cos(theta))
    for order in range(MOST_G_ORDERS):
        yield value, size
        now = 0 * value
        forcing = f0 * Om ** (order + 1) * sines[order % 2] * (1 if order % 4 < 2 else -1)
        value = next_derivative(now, before, forcing, cm, w0sq)
        size = abs(forcing) + abs(w0sq * before) + abs(f0) * Om ** (order + 1)
        before = now


def _why(order: int, grazing: bool) -> str:
    if order == 0:
        return "F does not vanish: the flow is transversal"
    if order % 2 == 0:
        return f"the first G-function that does not vanish has even order {order}: the flow passes with an inflection"
    if grazing:
        return f"F = 0 and G^({order}) leads back into the domain"
    return f"G^({order}) leads out of the domain: there is no flow of it near"
