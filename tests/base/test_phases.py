"""Exact phases in every form: text with pi, signs of sines, membership in windows, LaTeX."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
import pytest
import sympy
import sympy as sp
from bad_values import refused
from sympy import pi

from symosc import ParameterError, Parameters, grazing_start, grazing_window, is_grazing, load_scene
from symosc.base.expressions import ExactPhase
from symosc.base.phases import (
    number_of,
    of_sympy,
    read_angle,
    read_phase,
    read_phase_text,
    reduced,
    symbolic,
)
from symosc.base.quantities import read_number
from symosc.grazing.exact_sine import sine_sign
from symosc.kernels.multiprecision import mp_context

FIG9 = load_scene("fig9").parameters
MAPS = ("P2", "P3", "P5", "P6")


def fraction(rng: random.Random, size: int = 9) -> Fraction:
    return Fraction(rng.randint(-size, size), rng.randint(1, 7))


def texts(rng: random.Random) -> tuple[str, Any]:
    """Return a way to write a phase, and what it means."""
    a = fraction(rng)
    b = fraction(rng)
    rest, multiple = (sp.Rational(part.numerator, part.denominator) for part in (a, b))
    return rng.choice(
        [
            (f"{b.numerator}*pi/{b.denominator}", multiple * pi),
            (f"{b.numerator}pi/{b.denominator}", multiple * pi),
            (f"({b})*pi", multiple * pi),
            (f"pi*({b})", multiple * pi),
            (f"{b.numerator}*π/{b.denominator}", multiple * pi),
            (f"({b})*pi + {a.numerator}/{a.denominator}", multiple * pi + rest),
            (f"({a}) - 2*(pi - {abs(b)})", rest - 2 * pi + 2 * abs(multiple)),
            (f"-(-pi)/{b.denominator}", pi / b.denominator),
            ("0.1*pi + 0.25", pi / 10 + sp.Rational(1, 4)),
        ]
    )


def test_text_is_read_exactly() -> None:
    rng = random.Random(1)
    for _ in range(300):
        text, meant = texts(rng)
        assert sp.expand(read_phase_text("theta", text).symbolic() - meant) == 0, text
    assert read_phase_text("theta", "pi") == ExactPhase(Fraction(0), Fraction(1))
    assert read_phase_text("theta", "3*pi/2") == ExactPhase(Fraction(0), Fraction(3, 2))
    assert read_phase_text("theta", " 1.5 ") == ExactPhase(Fraction(3, 2), Fraction(0))


@pytest.mark.parametrize(
    "text",
    [
        "pi*pi", "1/pi", "pi/0", "pi**2", "pi//2", "sin(pi)", "pipi", "pi pi", "exp(pi)", "2*", "pi +", "pi)", "(pi",
        "１*pi", "1_0*pi", "pi.real", "1e53*pi", "1/2pi", "[pi]", "pi,pi", "lambda: pi",
        "(" * 90 + "pi" + ")" * 90 + "*pi", "9" * 5000 + "*pi", "9" * 100 + "*pi", "e", "two pi", "-pi-", "pi\n.x",
    ],
)  # fmt: skip
def test_other_expressions_cost_one_line(text: str) -> None:
    window = grazing_window(FIG9, "P2")
    refused(lambda: window.contains(text), "theta")
    refused(lambda: grazing_start(FIG9, "P2", text), "theta")


def random_parameters(rng: random.Random) -> Parameters:
    """Return parameters near the cases' borders: sines of the windows' ends are often rational."""
    v1 = fraction(rng, 20)
    changes = {
        "v1": v1,
        "v2": v1 + abs(fraction(rng)) + 1,
        "k": rng.randint(0, 6),
        "Omega": rng.randint(1, 6),
    }
    p = FIG9.replace(**changes, B0=rng.randint(-8, 8))
    if (
        p.B0 and rng.random() < 0.6
    ):  # k v1 = -B0 Omega sine: the window's end is at a multiple of pi/6
        sine = rng.choice([Fraction(1), Fraction(1, 2), Fraction(-1, 2), Fraction(-1)])
        v1 = -p.B0 * p.Omega * sine / max(p.k, 1)
        p = p.replace(k=max(p.k, 1), v1=v1, v2=v1 + 1)
    return p


@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", MAPS)
def test_windows_contain_what_their_exact_sets_contain(mapping: str) -> None:
    """Against sympy's sets, whose ends are compared by sympy, at their ends and at random multiples of pi."""
    rng = random.Random(mapping)
    at_ends = 0
    for _ in range(10):
        p = random_parameters(rng)
        order = rng.choice(["full", "paper"])
        window = grazing_window(p, mapping, order)
        if window.phases:
            ends = [of_sympy(end) for end in window.phases.boundary]
        else:
            ends = []
        tried = [end.multiple for end in ends if end is not None and end.rest == 0]
        at_ends += len(tried)
        for multiple in [*tried, Fraction(rng.randint(0, 23), 12), abs(fraction(rng)) % 2]:
            text = f"{multiple.numerator}*pi/{multiple.denominator}"
            phase = pi * sp.Rational(multiple.numerator, multiple.denominator)
            inside = window.contains(text + rng.choice(["", " + 2*pi", " - 4*pi"]))
            assert inside == (phase % (2 * pi) in window.phases), (p, mapping, order, text)
            assert inside == window.contains(phase)
            if inside and p.k:
                assert sp.expand(window.contact(text) - window.contact(phase)) == 0
    assert at_ends > 4


@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
def test_windows_agree_with_theorem_6_at_the_contact(mapping: str) -> None:
    """A phase is in the full window iff F and its derivatives at the contact say so, in 50 digits."""
    rng = random.Random(f"contact {mapping}")
    for _ in range(12):
        p = random_parameters(rng)
        p = p.replace(k=max(p.k, 1))
        window = grazing_window(p, mapping)
        text = f"{rng.randint(0, 23)}*pi/12"
        where = window.place
        phase = sp.sympify(text)
        x = (
            sp.Rational(p.A(where.domain) - p.c * window.speed) + sp.Rational(p.B0) * sp.cos(phase)
        ) / sp.Rational(p.k)
        verdict = is_grazing(p, mapping, x if x.is_Rational else sp.nsimplify(x), text)
        assert window.contains(text) == verdict.grazing, (p, text)


def test_signs_next_to_zero() -> None:
    """The sign is right however near a rational level comes to an irrational sine."""
    rng = random.Random(5)
    for _ in range(60):
        phase = ExactPhase(
            rng.choice([Fraction(0), fraction(rng), 10**40 * fraction(rng)]), fraction(rng)
        )
        digits = rng.choice([10, 40, 120])
        near = Fraction(str(sp.sin(phase.symbolic()).evalf(digits + 20))[: digits + 2])
        difference = sp.sin(phase.symbolic()).evalf(400) - sp.Rational(
            near.numerator, near.denominator
        )
        if difference == 0 or abs(difference) < sp.Rational(1, 10**300):
            expected = 0
        else:
            expected = int(sp.sign(difference))
        assert sine_sign(-near, Fraction(1), phase) == expected
        assert sine_sign(near, Fraction(-3, 2) * 2 / 3, phase) == -expected
    for sixths in range(-12, 24):  # pi/6, and sines that are rational
        sine = sp.sin(sixths * sp.pi / 6)
        if sine.is_Rational:
            level = Fraction(int(sine.p), int(sine.q))
        else:
            level = Fraction(0)
        phase = ExactPhase(Fraction(0), Fraction(sixths, 6))
        assert sine_sign(-level, Fraction(1), phase) == (0 if sine.is_Rational else sp.sign(sine))
        assert sine_sign(Fraction(1, 10**30) - level, Fraction(1), phase) == (
            1 if sine.is_Rational else sp.sign(sine)
        )


def test_a_phase_that_was_computed_is_the_binary_number_that_it_is() -> None:
    assert read_phase("theta", 0.1) == Fraction(0.1) != Fraction(1, 10)
    assert read_phase("theta", "0.1") == Fraction(1, 10)


NONE = [
    "pi**2",
    "pi pi",
    "2*",
    "pi/0",
    "x",
    "pi + x",
    "",
    None,
    True,
    1j,
    float("nan"),
    "__import__('os')*pi",
]
NONE += [sympy.Symbol("x"), sympy.I, sympy.oo, "pi" + "+pi" * 100]
NONE += [
    sympy.true,
    sympy.Interval(0, 1),
    sympy.EmptySet,
    sympy.Tuple(1),
    sympy.Symbol("x", real=True) + sympy.pi,
]


@pytest.mark.parametrize("value", NONE, ids=str)
def test_what_is_no_angle(value: Any) -> None:
    with pytest.raises(ParameterError, match=r"^theta = "):
        read_angle("theta", value)


def test_phases_are_the_angles_less_whole_turns() -> None:
    rng = random.Random(5)
    context = mp_context(60)
    for _ in range(30):
        part = Fraction(rng.randint(-9999, 9999), rng.randint(1, 99))
        for angle in (part, symbolic(part) * sympy.pi):
            phase = reduced(angle)
            turns = (number_of(angle, context) - number_of(phase, context)) / (2 * context.pi)
            assert abs(turns - round(turns)) < 1e-50
            assert 0 <= number_of(phase, context) < 2 * context.pi
    assert reduced(Fraction(599, 100)) == Fraction(599, 100)
    assert reduced(Fraction(6)) == 6  # 6 < 2 pi
    assert float(reduced(Fraction(7))) == pytest.approx(7 - 2 * mpmath.pi)
    assert reduced(2 * sympy.pi) == 0


# --- one parser ---


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("pi - pi", Fraction(0)),
        ("2*pi - 2 pi + 1/3", Fraction(1, 3)),
        ("-(-2)^3", Fraction(8)),
        ("pi^0 + 1e-3", Fraction(1001, 1000)),
        ("(3*pi/2 + 1)/(1/2) - 3pi", Fraction(2)),
    ],
)
def test_multiples_of_pi_that_cancel_leave_an_exact_number(text: str, value: Fraction) -> None:
    assert read_number("x0", text) == (value, True)


@pytest.mark.parametrize(
    "text", ["1e3*pi", "2^3*pi/3 - 1/7", "-(-pi)/3", "0.1 pi", "2(pi)", "--pi"]
)
def test_phases_and_parameters_take_the_same_expressions(text: str) -> None:
    """Either both refuse a text, or the phase is the parameter to 40 digits."""
    context = mp_context(60)
    try:
        phase = read_phase_text("theta", text)
    except ParameterError:
        refused(lambda: read_number("x0", text), "x0")
        return
    value, _ = read_number("x0", text)
    assert abs(phase.number(context) / number_of(value, context) - 1) < 1e-39
