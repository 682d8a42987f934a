"""Theorem 7's cases from signs: against the set of phases itself, sampled."""

from __future__ import annotations

from math import isclose, pi, sin
from typing import Any

import pytest

from symosc import ParameterError, load_scene
from symosc.mappings.theorem7_cases import (
    ALL_BUT_ONE,
    ARC,
    EMPTY,
    EVERYTHING,
    PLACES,
    WRAPPED_ARC,
    case_label,
    place,
    window_kind,
)

P = load_scene("fig9").parameters
NUMBERS = [(gamma, amplitude) for gamma in (-3, -2, -1, 0, 1, 2, 3) for amplitude in (-2, 0, 2)]


def sign(value: Any) -> int:
    return (value > 0) - (value < 0)


def signs(gamma: int, amplitude: int) -> tuple[int, int, int]:
    return sign(gamma), sign(amplitude), sign(abs(gamma) - abs(amplitude))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("gamma", "amplitude"), NUMBERS)
def test_a_kind_is_what_the_set_of_phases_is(side: int, gamma: int, amplitude: int) -> None:
    """The phases with side (gamma + amplitude sin theta) > 0: none, all, all but one, an arc, or one through 0."""
    count = 360
    values = [side * (gamma + amplitude * sin(2 * pi * n / count)) for n in range(count)]
    inside = [value > 1e-12 for value in values]
    edges = sum(a != b for a, b in zip(inside, inside[1:] + inside[:1], strict=True))
    if not any(inside):
        expected = {EMPTY}
    elif all(inside):
        expected = {EVERYTHING}
    elif sum(inside) == count - 1:
        expected = {ALL_BUT_ONE}
    else:
        assert edges == 2
        # B0 < 0 is B0 > 0 half a period later: the kind is that of the window before the shift
        start = inside[0] if amplitude > 0 else inside[count // 2]
        expected = {WRAPPED_ARC} if start else {ARC}
        if isclose(values[0], 0, abs_tol=1e-12):  # gamma = 0: from 0 to pi, or the other half
            expected = {ARC}
    assert window_kind(side, *signs(gamma, amplitude), full=False) in expected


@pytest.mark.parametrize("side", [1, -1])
def test_at_equality_the_full_order_takes_the_last_phase_too(side: int) -> None:
    """There G^(3) = -gamma Omega^2 decides: for a flow from below a graze needs G^(3) < 0."""
    for gamma in (-2, 2):
        graze = side * gamma > 0
        assert window_kind(side, *signs(gamma, 2), full=True) == (EVERYTHING if graze else EMPTY)
        assert window_kind(side, *signs(gamma, 2), full=False) == (ALL_BUT_ONE if graze else EMPTY)


@pytest.mark.parametrize("mapping", PLACES)
def test_labels_tell_all_cases_apart(mapping: str) -> None:
    """What has one label has one kind; shifted ones are those of B0 > 0."""
    where = place(mapping)
    kinds: dict[str, set[int]] = {}
    for gamma, amplitude in NUMBERS:
        label = case_label(where, *signs(gamma, amplitude))
        kinds.setdefault(label, set()).add(window_kind(where.side, *signs(gamma, amplitude), full=False))
        assert label.startswith(f"({where.equation}.")
        if amplitude < 0:
            assert label == case_label(where, *signs(gamma, -amplitude)) + " shifted by pi"
    assert all(len(kind) == 1 for kind in kinds.values())
    plain = {label for label in kinds if "shifted" not in label}
    assert {label[4:-1] for label in plain} >= {"1", "2", "3", "4", "5", "6", "b", "c"}


@pytest.mark.parametrize("mapping", ["P1", "P4", "P7", "P8", "P9", "", None, 2, ["P2"]])
def test_maps_without_grazing_say_why(mapping: Any) -> None:
    with pytest.raises(ParameterError, match="grazing is defined for P2, P3, P5, P6") as caught:
        place(mapping)
    assert ("sticks" in str(caught.value)) == (mapping in ("P1", "P4"))
    assert ("leads from" in str(caught.value)) == (mapping in ("P7", "P8"))


def test_places_are_where_the_maps_begin_and_end() -> None:
    from symosc.words import MAPS

    for mapping, (domain, boundary, side, _) in PLACES.items():
        row = MAPS[mapping]
        assert (row.mode, row.start.boundary, row.end.boundary) == (domain, boundary, boundary)
        assert side == (1 if domain == boundary else -1)
    assert [where.equation for where in PLACES.values()] == [55, 56, 57, 58]
