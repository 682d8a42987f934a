"""Inverse answers for one parameter and two, for phases and intervals, against windows and the exact flow."""

from __future__ import annotations

import random
from fractions import Fraction
from functools import partial
from itertools import combinations
from typing import Any

import pytest
import sympy as sp
from bad_values import refused
from samples import sample_of
from sympy import Interval, Rational, pi

from symosc import (
    Parameters,
    grazing_window,
    load_scene,
    values_containing,
    values_empty,
    values_everything,
)
from symosc.base.errors import ParameterError
from symosc.grazing.check import YES, Ways
from symosc.kernels.theorem7_cases import EMPTY, EVERYTHING
from symosc.symbolic import inverse
from symosc.symbolic.inverse import QUERY_LETTERS, THETA, Answer

MAPS = ("P2", "P3", "P5", "P6")
FIG9 = load_scene("fig9").parameters  # k v1 = 3, B0 Omega = 36


def belt(mapping: str) -> str:
    if mapping in ("P2", "P3"):
        return "v1"
    return "v2"


def parameters(rng: random.Random) -> Parameters:
    """Return random parameters, with a belt at rest, no drive or no spring now and then."""
    v1 = rng.choice([Fraction(0), Fraction(rng.randint(-20, 10), rng.randint(1, 4))])
    if v1 < 0 and rng.random() < 0.2:
        v2 = Fraction(0)
    else:
        v2 = v1 + rng.randint(1, 9)
    B0 = rng.choice([0, rng.randint(-9, 9), rng.randint(-9, 9)])
    k = rng.choice([0, *range(1, 6)])
    return FIG9.replace(v1=v1, v2=v2, Omega=Fraction(rng.randint(1, 9), 2), B0=B0, k=k)


def text(multiple: Fraction) -> str:
    return f"{multiple.numerator}*pi/{multiple.denominator}"


def tried(answer: Any, rng: random.Random) -> list[Fraction]:
    """Return the ends of an answer that are fractions, what is next to the others, and random values."""
    values = [Fraction(rng.randint(-40, 40), 7) for _ in range(3)] + [Fraction(0)]
    for end in answer.boundary if answer else ():
        if end.is_Rational:
            values.append(Fraction(int(end.p), int(end.q)))
        near = Fraction(str(end.evalf(25)))
        values += [near + step for step in (Fraction(1, 10**12), Fraction(-1, 10**12))]
    return values


def changed(p: Parameters, **values: Any) -> Parameters | None:
    try:
        return p.replace(**values)
    except ParameterError:
        return None


@pytest.mark.full(3)
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
            empty = values_empty(p, mapping, name)
            everything = values_everything(p, mapping, name, order)
            for answers, holds in (
                (containing, lambda window, theta=theta: window.contains(theta)),
                (empty, lambda window: window.kind == EMPTY),
                (everything, lambda window: window.kind == EVERYTHING),
            ):
                for value in tried(answers, rng):
                    there = changed(p, **{name: value})
                    if there is None:
                        continue
                    window = grazing_window(there, mapping, order)
                    assert (Rational(value) in answers) == holds(window), (
                        p,
                        name,
                        value,
                        theta,
                        answers,
                    )
                    ends_that_belong += (
                        Rational(value) in answers and Rational(value) in answers.boundary
                    )
    assert ends_that_belong > count


@pytest.mark.full(8)
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
        values = {
            QUERY_LETTERS[parameter]: Rational(getattr(p, parameter))
            for parameter in ("k", "B0", "Omega", "v1", "v2")
        }
        values |= {QUERY_LETTERS["v"]: Rational(getattr(p, belt(mapping))), THETA: theta}
        for question, answers in zip(questions, lettered, strict=True):
            held = [answer for answer in answers if answer.condition.subs(values) == sp.true]
            assert len(held) == 1
            assert held[0].values.subs(values) == question(p, theta)


def test_bad_names_and_phases() -> None:
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


def intervals(rng: random.Random) -> tuple[Any, list[Fraction], list[Fraction]]:
    """Return an interval of phases, multiples of pi that lie in it, and those that are near its open ends."""
    low = Fraction(rng.randint(-12, 24), 12)
    length = Fraction(rng.randint(1, 24), 12)
    open_ends = rng.random() < 0.4, rng.random() < 0.4
    ends = [Rational(end.numerator, end.denominator) * pi for end in (low, low + length)]
    if any(open_ends) or rng.random() < 0.3:
        phases = Interval(*ends, *open_ends)
    else:
        phases = tuple(ends)
    inside = [low + length * Fraction(i, 12) for i in range(1, 12)]
    quarters = [Fraction(i, 2) for i in range(-4, 12)]
    inside += [phase for phase in quarters if low < phase < low + length]
    inside += [
        end for end, is_open in zip((low, low + length), open_ends, strict=True) if not is_open
    ]
    near = [length * Fraction(1, 10**digits) for digits in (3, 7, 14, 30)]
    return phases, inside, [low + step for step in near] + [low + length - step for step in near]


@pytest.mark.full(3)
@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ["full", "paper"])
def test_intervals_of_phases(mapping: str, order: str) -> None:
    """A value is in the answer iff every phase of the interval is in the window, ends and tops of the sine included."""
    rng = random.Random(mapping + order)
    yes = 0
    no = 0
    for _ in range(14):
        p = parameters(rng)
        name = rng.choice(["Omega", "B0", "k", belt(mapping)])
        phases, inside, near = intervals(rng)
        values = values_containing(p, mapping, name, phases, order)
        for value in tried(values, rng):
            there = changed(p, **{name: value})
            if there is None:
                assert value not in values
                continue
            window = grazing_window(there, mapping, order)
            everywhere = all(window.contains(text(phase)) for phase in inside + near)
            assert (value in values) == everywhere, (p, mapping, name, phases, value)
            yes = yes + everywhere
            no = no + (not everywhere)
    assert min(yes, no) > 8


@pytest.mark.full(3)
@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
@pytest.mark.parametrize("order", ["full", "paper"])
def test_regions_of_two_parameters(mapping: str, order: str) -> None:
    rng = random.Random(f"region {mapping} {order}")
    yes = 0
    no = 0
    pairs = list(combinations(("Omega", "B0", "k", belt(mapping)), 2))
    for names in pairs:
        p = parameters(rng)
        theta = Fraction(rng.choice([0, 1, 3, 5, 7, 9, 9, 3]), 6)
        phases, inside, near = intervals(rng)
        questions = [
            (
                values_containing(p, mapping, names, text(theta), order),
                lambda w, t=theta: w.contains(text(t)),
            ),
            (
                values_containing(p, mapping, names, phases, order),
                lambda w, some=(*inside, *near): all(w.contains(text(t)) for t in some),
            ),
            (values_empty(p, mapping, names), lambda w: w.kind == EMPTY),
            (values_everything(p, mapping, names, order), lambda w: w.kind == EVERYTHING),
        ]
        for _ in range(6):
            values = {name: Fraction(rng.randint(-6, 6), rng.choice([1, 2])) for name in names}
            if rng.random() < 0.5:  # on the border of equality
                values["B0" if "B0" in names else names[0]] = Fraction(rng.choice([-1, 0, 1, 2, 3]))
            there = changed(p, **values)
            if there is None:
                ask = partial(questions[0][0].contains, **values)
                refused(ask, next(iter(_refusing(p, values))))
                continue
            window = grazing_window(there, mapping, order)
            for region, holds in questions:
                assert region.contains(**values) == holds(window), (
                    p,
                    mapping,
                    names,
                    values,
                    region,
                )
                yes = yes + holds(window)
                no = no + (not holds(window))
    assert min(yes, no) > 4


def _refusing(p: Parameters, values: dict[str, Any]) -> list[str]:
    with pytest.raises(ParameterError) as caught:
        p.replace(**values)
    return [caught.value.name]


@pytest.mark.full(2)
@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
def test_answers_agree_with_the_exact_flow(mapping: str) -> None:
    """The flow with 130 digits turns back, just inside an answer, and does not just outside."""
    rng = random.Random(f"flow {mapping}")
    seen = {True: 0, False: 0}
    while min(seen.values()) < 6:
        p = parameters(rng)
        name = rng.choice(["Omega", "B0", "k", belt(mapping)])
        theta = Fraction(rng.randint(0, 11), 6)
        values = values_containing(p, mapping, name, text(theta))
        for value in tried(values, rng):
            there = changed(p, **{name: value})
            if (
                there is None
                or there.k == 0
                or there.k * there.belt(1 if belt(mapping) == "v1" else 2) == 0
            ):
                continue
            ways = Ways(grazing_window(there, mapping))
            verdict = ways.verdict_by_fine_flow(
                ways.fine.context.pi * theta.numerator / theta.denominator
            )
            if verdict:
                assert (verdict == YES) == (value in values), (there, mapping, name, theta)
                seen[verdict == YES] += 1


def test_a_symbol_is_no_value() -> None:
    values = values_containing(FIG9, "P2", "Omega", "pi/3")
    refused(lambda: sp.Symbol("Omega") in values, "Omega")


def test_each_comparison_is_decided_with_numbers() -> None:
    x = sp.Symbol("x", real=True)
    for number in (-1, 0, 1):
        pairs = ((sp.Eq(x, 0), number == 0), (x > 0, number > 0), (x >= 0, number >= 0))
        for condition, due in (*pairs, (x < 0, number < 0), (x <= 0, number <= 0)):
            assert inverse.holds(condition, {x: sp.Integer(number)}) == due, (condition, number)


def test_bad_questions() -> None:
    refused(lambda: values_containing(None, "P2", "Omega", (1, 2)), "theta")
    refused(lambda: values_containing(None, "P2", ("Omega", "k"), 1), "p")
    for names in (
        ("Omega", "Omega"),
        ("Omega",) * 3,
        (),
        ("Omega", "v2"),
        ("v1", "v_lambda"),
        ("Omega", 5),
    ):
        refused(lambda names=names: values_containing(FIG9, "P2", names, 1), "name")  # type: ignore[misc]
    region = values_empty(FIG9, "P2", ("Omega", "k"))
    for values in ({}, {"Omega": 1}, {"Omega": 1, "B0": 1}, {"Omega": 1, "k": 1, "B0": 1}):
        refused(lambda values=values: region.contains(**values), "values")  # type: ignore[misc]
    refused(lambda: region.contains(Omega=0, k=1), "Omega")
    refused(lambda: region.contains(Omega=1, k="x"), "k")
