"""Inverse queries: for which values of one parameter a window contains a phase, is empty or is everything."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest
import sympy as sp
from samples import sample_of
from sympy import Interval, Rational, S, oo, pi

from symosc.errors import ParameterError
from symosc.grazing.window import grazing_window
from symosc.mappings.theorem7_cases import EMPTY, EVERYTHING
from symosc.model import Parameters
from symosc.scenes import load_scene
from symosc.symbolic.grazing_answers import QUERY_LETTERS, Answer
from symosc.symbolic.grazing_queries import THETA, values_containing, values_empty, values_everything

MAPS = ("P2", "P3", "P5", "P6")
FIG9 = load_scene("fig9").parameters  # k v1 = 3, B0 Omega = 36


def belt(mapping: str) -> str:
    return "v1" if mapping in ("P2", "P3") else "v2"


def parameters(rng: random.Random) -> Parameters:
    def number(low: int, high: int) -> Fraction:
        return Fraction(rng.randint(low, high), rng.randint(1, 6))

    v1 = rng.choice([Fraction(0), number(-20, 10)])
    v2 = rng.choice([Fraction(0), v1 + 1]) if v1 < 0 else v1 + number(1, 20)
    B0, k = (
        rng.choice([Fraction(0), number(-20, 20), number(-20, 20)]),
        rng.choice([Fraction(0), number(0, 9), number(1, 9)]),
    )
    return FIG9.replace(v1=v1, v2=v2, B0=B0, k=k, Omega=number(1, 20))


def samples(found: Any, p: Parameters, name: str, rng: random.Random) -> list[Fraction]:
    """Return allowed values of a parameter: the ends of the answer, what is next to them, zero, and random ones."""
    ends = [Fraction(int(end.p), int(end.q)) for end in found.boundary if end.is_Rational] if found else []
    tried = [end + step for end in ends for step in (0, Fraction(1, 10**12), Fraction(-1, 10**12))]
    tried += [Fraction(0), Fraction(1, 3), Fraction(-2)] + [Fraction(rng.randint(-60, 60), 7) for _ in range(5)]
    return [value for value in tried if allowed(p, name, value)]


def allowed(p: Parameters, name: str, value: Fraction) -> bool:
    try:
        p.replace(**{name: value})
    except ParameterError:
        return False
    return True


@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ["full", "paper"])
@sample_of(3, 20)
def test_answers_agree_with_the_windows(mapping: str, order: str, count: int) -> None:
    rng = random.Random(mapping + order)
    ends_that_belong = 0
    for _ in range(count):
        p = parameters(rng)
        for name in ("Omega", "B0", "k", belt(mapping)):
            theta = pi * Rational(rng.choice([0, 1, 3, 5, 6, 7, 9, 9, 3, 11]), 6)
            containing = values_containing(p, mapping, name, theta, order)
            empty, everything = values_empty(p, mapping, name), values_everything(p, mapping, name, order)
            for found, holds in (
                (containing, lambda window, theta=theta: window.contains(theta)),
                (empty, lambda window: window.kind == EMPTY),
                (everything, lambda window: window.kind == EVERYTHING),
            ):
                for value in samples(found, p, name, rng):
                    window = grazing_window(p.replace(**{name: value}), mapping, order)
                    assert (Rational(value) in found) == holds(window), (p, name, value, theta, found)
                    ends_that_belong += Rational(value) in found and Rational(value) in found.boundary
    assert ends_that_belong > count


@pytest.mark.quick(2)
@pytest.mark.parametrize("mapping", MAPS)
def test_answers_stay_in_what_parameters_allow(mapping: str) -> None:
    rng = random.Random(mapping)
    for _ in range(15):
        p = parameters(rng)
        other = Rational(p.v2 if belt(mapping) == "v1" else p.v1)
        belts = Interval.open(-oo, other) if belt(mapping) == "v1" else Interval.open(other, oo)
        domains = {"Omega": Interval.open(0, oo), "k": Interval(0, oo), belt(mapping): belts, "B0": S.Reals}
        for name, domain in domains.items():
            for found in (values_empty(p, mapping, name), values_everything(p, mapping, name)):
                assert found.is_subset(domain)


def test_known_answers() -> None:
    # P2 of fig9 contains 7 pi/6 while 3 > 9 Omega/2
    assert values_containing(FIG9, "P2", "Omega", 7 * pi / 6) == Interval.open(0, Rational(2, 3))
    assert values_containing(FIG9, "P2", "v_lambda", 7 * pi / 6) == Interval.open(6, 25)  # up to v2
    assert values_containing(FIG9, "P3", "k", 0) == S.EmptySet
    assert values_containing(FIG9, "P2", "k", pi / 2) == Interval(0, oo)
    # The equality of fourth order is in the full window, and not in the paper's.
    assert values_containing(FIG9, "P2", "Omega", 3 * pi / 2) == Interval.Lopen(0, Rational(1, 3))
    assert values_containing(FIG9, "P2", "Omega", 3 * pi / 2, "paper") == Interval.open(0, Rational(1, 3))
    assert values_containing(FIG9, "P2", "Omega", -pi / 2) == Interval.Lopen(0, Rational(1, 3))
    assert values_everything(FIG9, "P2", "B0") == Interval(-Rational(3, 4), Rational(3, 4))
    assert values_everything(FIG9, "P2", "B0", "paper") == Interval.open(-Rational(3, 4), Rational(3, 4))
    assert values_empty(FIG9, "P3", "v1") == Interval.Ropen(12, 25)
    assert values_empty(FIG9.replace(B0=0), "P3", "k") == Interval(0, oo)
    assert values_empty(FIG9.replace(B0=0), "P2", "k") == sp.FiniteSet(0)
    assert values_everything(FIG9.replace(B0=0), "P2", "k") == Interval.open(0, oo)


def test_phases_that_are_no_multiple_of_pi() -> None:
    assert values_containing(FIG9, "P2", "k", pi + sp.asin(Rational(1, 3))) == Interval.open(12, oo)
    assert values_containing(FIG9, "P2", "k", 4) == Interval.open(-36 * sp.sin(4), oo)
    assert values_containing(FIG9, "P2", "k", 4.0) == Interval.open(-36 * sp.sin(4), oo)
    assert values_containing(FIG9, "P2", "k", 1) == Interval(0, oo)


@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("name", ["Omega", "B0", "k", "v_lambda"])
@pytest.mark.parametrize("order", ["full", "paper"])
@sample_of(3, 20)
def test_answers_with_letters(mapping: str, name: str, order: str, count: int) -> None:
    """With numbers put in exactly one condition holds, and its set is the answer for numbers."""
    rng = random.Random(mapping + name)
    questions: list[Any] = [
        lambda p, theta: values_containing(p, mapping, name, theta, order),
        lambda p, theta: values_empty(p, mapping, name),
        lambda p, theta: values_everything(p, mapping, name, order),
    ]
    lettered = [question(None, None) for question in questions]
    for answers in lettered:
        assert all(isinstance(answer, Answer) for answer in answers)
    for _ in range(count):
        p = parameters(rng)
        theta = pi * Rational(rng.choice([0, 1, 3, 7, 9, 9, 11]), 6)
        values = {QUERY_LETTERS[each]: Rational(getattr(p, each)) for each in ("k", "B0", "Omega", "v1", "v2")}
        values |= {QUERY_LETTERS["v"]: Rational(getattr(p, belt(mapping))), THETA: theta}
        for question, answers in zip(questions, lettered, strict=True):
            held = [answer for answer in answers if answer.condition.subs(values) == sp.true]
            assert len(held) == 1
            assert held[0].values.subs(values) == question(p, theta)


def test_bad_questions() -> None:
    for mapping in ("P1", "P7", ""):
        with pytest.raises(ParameterError, match="P2, P3, P5, P6"):
            values_empty(FIG9, mapping, "k")
    for name in ("v2", "c", "A0", "abc", ""):
        with pytest.raises(ParameterError, match="depends on Omega, B0, k and v1"):
            values_everything(FIG9, "P2", name)
    with pytest.raises(ParameterError, match="depends on Omega, B0, k and v2"):
        values_everything(None, "P6", "v1")
    for theta in ("abc", None, sp.Symbol("theta"), float("nan"), sp.I):
        with pytest.raises(ParameterError, match="theta"):
            values_containing(FIG9, "P2", "k", theta)
    with pytest.raises(ParameterError, match="order"):
        values_containing(FIG9, "P2", "k", 1, "second")
