"""Theorem 7's cases: where the flow of a map touches, and what its window is, from signs alone."""

from __future__ import annotations

from typing import NamedTuple

from symosc.aliases import Order
from symosc.errors import ParameterError


class Place(NamedTuple):
    """Where the flow of a map touches a boundary.

    Attributes
    ----------
    domain, boundary : int
    side : int
        Where the flow touches its domain's boundary: 1 above itself (a contact from below), -1 below itself.
    equation : int
        Its number in the paper: 55 to 58.

    Examples
    --------
    >>> from symosc import grazing_window, load_scene
    >>> grazing_window(load_scene("fig9").parameters, "P2").place
    Place(domain=1, boundary=1, side=1, equation=55)
    """

    domain: int
    boundary: int
    side: int  # it grazes where side (gamma + amplitude sin(theta)) > 0
    equation: int


PLACES = {"P2": Place(1, 1, 1, 55), "P3": Place(2, 1, -1, 56), "P5": Place(2, 2, 1, 57), "P6": Place(3, 2, -1, 58)}

_NO_GRAZING = {
    "P1": "sticks on belt 1",
    "P4": "sticks on belt 2",
    "P7": "leads from v2 to v1",
    "P8": "leads from v1 to v2",
}

ORDERS: tuple[Order, ...] = ("full", "paper")

# What a window is; a wrapped arc goes through 0.
EQUALITY_IN_DOUBT, EMPTY, EVERYTHING, ALL_BUT_ONE, ARC, WRAPPED_ARC = -1, 0, 1, 2, 3, 4


def place(mapping: str) -> Place:
    """Return where the flow of a map touches a boundary.

    Raises
    ------
    ParameterError
        If the map has no grazing (only P2, P3, P5 and P6 return to the boundary that they left).
    """
    if not isinstance(mapping, str) or mapping not in PLACES:
        reason = f"it {_NO_GRAZING[mapping]}; " if isinstance(mapping, str) and mapping in _NO_GRAZING else ""
        raise ParameterError("mapping", mapping, f"{reason}grazing is defined for {', '.join(PLACES)}")
    return PLACES[mapping]


def window_kind(side: int, gamma_sign: int, amplitude_sign: int, excess_sign: int, full: bool) -> int:
    """Return what the window is from the signs of gamma, the amplitude and |gamma| - |amplitude|.

    At |gamma| = |amplitude| the order 1 excludes one phase. G^(1) = G^(2) = 0 there. G^(3) = -gamma Omega^2 has the
    sign of a graze at `side` iff the rest of the circle is in the window; then `full` includes the phase.
    """
    level = side * gamma_sign
    if amplitude_sign == 0:
        return EVERYTHING if level > 0 else EMPTY  # with gamma = 0 too, the flow stays in the boundary for ever
    if excess_sign < 0:
        return WRAPPED_ARC if level > 0 else ARC
    if level < 0:
        return EMPTY
    return EVERYTHING if excess_sign > 0 or full else ALL_BUT_ONE


def case_label(place: Place, gamma_sign: int, amplitude_sign: int, excess_sign: int) -> str:
    """Return the paper's case: (55.1) is the first of (55). Letters are cases that the paper lacks.

    a: gamma has the wrong sign and |gamma| = |amplitude|; b, c: B0 = 0, everything and nothing. B0 < 0 is B0 > 0
    half a period later.
    """
    if amplitude_sign == 0:
        return f"({place.equation}.{'b' if place.side * gamma_sign > 0 else 'c'})"
    # By the sign of gamma, then of |gamma| - |amplitude| from -1 to 1.
    below, above = {1: "123", 0: "4", -1: "5a6"}, {1: "122", 0: "3", -1: "456"}
    number = (below if place.side > 0 else above)[gamma_sign][excess_sign + 1]
    label = f"({place.equation}.{number})"
    return label if amplitude_sign > 0 else f"{label} shifted by pi"
