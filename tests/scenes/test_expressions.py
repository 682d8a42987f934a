"""Expressions in scene files: fractions stay fractions, 40 digits are right, and the rest is refused at once."""

from __future__ import annotations

import random
from fractions import Fraction

import mpmath
import pytest
from bad_values import refused
from effort import at_most

from symosc.exact import read_exact
from symosc.scenes.expressions import KNOWN_DIGITS, read_expression


def written(rng: random.Random, depth: int) -> str:
    """Return a random expression that is defined."""
    if depth == 0:
        return rng.choice(["pi", "π", str(rng.randint(1, 99)), f"{rng.randint(0, 9)}.{rng.randint(1, 999)}", "2e-3"])
    kind, one = rng.randrange(7), written(rng, depth - 1)
    if kind < 4:
        return f"({one} {'+-*/'[kind]} ({written(rng, depth - 1)} + 7/3))"
    return [f"sqrt(({one})^2)", f"cos({one})", f"-({one})**{rng.randint(1, 3)}"][kind - 4]


@pytest.mark.parametrize("seed", range(60))
def test_digits_are_those_of_mpmath(seed: int) -> None:
    rng = random.Random(seed)
    text = written(rng, rng.randint(1, 3))
    value, exact = read_expression("x0", text)
    names = {"pi": mpmath.pi, "π": mpmath.pi, "sqrt": mpmath.sqrt, "cos": mpmath.cos}
    with mpmath.workdps(120):
        # Numbers become mpmath's, so that none is rounded to a double.
        source = "".join(f"mpf('{part}')" if part[0] in "0123456789" else part for part in pieces(text))
        right = eval(source.replace("^", "**"), names | {"mpf": mpmath.mpf})
        error = abs(mpmath.mpf(value.numerator) / value.denominator - right)
        assert error <= abs(right) * mpmath.mpf(10) ** (1 - KNOWN_DIGITS) / 2, text
    if not exact:
        assert value == read_exact("x0", str(value))
        assert len(str(value.numerator).rstrip("0")) <= KNOWN_DIGITS + 20


def pieces(text: str) -> list[str]:
    """Return an expression cut at its numbers; the exponents of powers stay whole numbers of Python."""
    import re

    found = re.findall(r"(?:\*\*|\^)\d+|\d+\.?\d*(?:e-?\d+)?|[^\d]+?(?=\d|$)|\D", text)
    return [part for part in found if part]


@pytest.mark.parametrize(
    ("text", "value"),
    [("1/3 + 1/6", "1/2"), ("0.1*3", "3/10"), ("2^-3", "1/8"), ("-(2 - 5)", "3"), ("(1/2)**100 * 2^100", "1")],
)
def test_fractions_stay_exact(text: str, value: str) -> None:
    assert read_expression("x0", text) == (Fraction(value), True)


@pytest.mark.parametrize(
    "text",
    [
        "", "pi pi", "2 pi", "pi(2)", "e", "x", "open(1)", "pi.real", "[pi]", "pi if 1 else 2", "sqrt(2, 3)", "sqrt()",
        "sqrt(-1)", "1/0", "1/(pi - pi)", "pi - pi", "sin(pi)", "pi^pi", "2^0.5", "2^101", "9^99^99", "1_000", "pi\n;1",
        "1 // 2", "7 % 2", "sqrt(x=1)", "exp(1e9)", "pi**100**100", "ｐｉ", "２*pi", "0x10*pi", "1j*pi", "'pi'",
        "pi" * 101,
        "(" * 190 + "pi", "((((((10^100)^100)^100)^100)^100)^100)", "sin((((pi^100)^100)^100)^100)", "0^-1",
        "1e99999*pi",
    ],
)  # fmt: skip
def test_what_is_refused_is_refused_at_once(text: str) -> None:
    with at_most(10_000):
        refused(lambda: read_expression("x0", text), "x0")
