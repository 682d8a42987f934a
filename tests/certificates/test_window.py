"""Proven windows: their ends, and the flow's own answer at many phases."""

from __future__ import annotations

import itertools
import random
from fractions import Fraction

import pytest

from symosc import Parameters, certify, grazing_window, load_scene
from symosc.certificates.window import ALL_PHASES, BUT_ONE_PHASE, NO_PHASE, ON_AN_ARC

CHANGES: tuple[dict[str, int], ...] = ({}, {"B0": 0}, {"k": 0}, {"B0": -3})


def grazes(parameters: Parameters, mapping: str, order: str, statement: dict[str, object], theta: float) -> bool:
    """Return what a certificate states about a phase."""
    if statement["grazes"] != ON_AN_ARC:
        return statement["grazes"] != NO_PHASE
    low, high = (float(end["phase"][0]) for end in statement["ends"])  # type: ignore[attr-defined]
    return (theta - low) % 6.283185307179586 < high - low


@pytest.mark.parametrize("order", ["full", "paper"])
def test_windows_say_what_their_phases_do(order: str) -> None:
    rng, kinds = random.Random(order), set()
    for name, mapping, change in itertools.product(
        ("fig5", "fig7", "fig8", "fig9", "fig10"), ("P2", "P3", "P5", "P6"), CHANGES
    ):
        window = grazing_window(load_scene(name).parameters.replace(**change), mapping, order)
        proof = certify(window)
        assert (proof.kind, proof.proven) == ("window", True)
        kinds.add(proof.statement["grazes"])
        for _ in range(10):
            theta = rng.uniform(0, 6.28)
            assert bool(window.contains(theta)) is grazes(window.parameters, mapping, order, proof.statement, theta)
    assert kinds == {NO_PHASE, ALL_PHASES, ON_AN_ARC} | ({BUT_ONE_PHASE} if order == "paper" else set())


def test_ends_are_exact() -> None:
    window = grazing_window(load_scene("fig9").parameters, "P2")
    ends = certify(window).statement["ends"]
    assert [end["sine"] for end in ends] == ["-1/12", "-1/12"]
    for end, value in zip(ends, window.ends[::1], strict=True):
        low, high = map(Fraction, end["phase"])
        assert high - low < Fraction(1, 10**22)
        turns = round((float(low) - value) / 6.283185307179586)
        assert abs(float(low) - value - turns * 6.283185307179586) < 1e-14


def test_the_two_orders_differ_at_a_touch_of_fourth_order() -> None:
    p = load_scene("fig8").parameters
    full, paper = (certify(grazing_window(p, "P3", order)).statement for order in ("full", "paper"))
    assert (full["grazes"], paper["grazes"]) == (ALL_PHASES, BUT_ONE_PHASE)
    assert paper["ends"][0]["sine"] == "1"
