"""What a reader of a printed fragment computes from it, and from nothing else, is what the package computes."""

from __future__ import annotations

import math
import random
import re
from fractions import Fraction
from typing import Any

import pytest
from latex_reader import Reader

from symosc import grazing_window, residual
from symosc.derive import fragment_pages
from symosc.derive.fragment_scope import LETTERS, fragment_scope
from symosc.derive.latex import latex
from symosc.derive.steps import Step, StepEvidence
from symosc.model import PARAMETER_NAMES, Parameters

#: Damping and stiffness of m = 3/2 and Omega = 7/5 in each regime.
REGIMES = {
    "underdamped": ("1/5", "3"), "critical": ("6", "6"), "overdamped": ("9", "2"), "undamped": ("0", "2"),
    "resonance": ("0", "147/50"), "no spring": ("2/5", "0"), "free": ("0", "0"),
}  # fmt: skip
FLIGHTS = ("P2", "P3", "P5", "P6", "P7", "P8")


@pytest.fixture(autouse=True)
def unchecked(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checks of the steps are other tests."""
    monkeypatch.setattr(Step, "verify", lambda step: StepEvidence("exact", "0"))


def some_parameters(rng: random.Random, regime: str) -> Parameters:
    c, k = REGIMES[regime]
    others = {name: Fraction(rng.randint(1, 30), rng.randint(2, 9)) for name in ("A0", "B0", "mu1", "mu2", "FN")}
    v1 = Fraction(rng.randint(-9, 9), 2)
    return Parameters(m="3/2", Omega="7/5", c=c, k=k, v1=v1, v2=v1 + rng.randint(1, 9), **others)


def formulas(text: str) -> dict[str, str]:
    """Return the right sides of the displayed formulas by their left sides; broken lines are joined."""
    found = {}
    for display in re.findall(r"\\begin\{align\}(.*?)\\end\{align\}", text, re.DOTALL):
        joined = re.sub(r"\\notag\s*\\\\\s*&(?:\\quad)?", " ", display).replace("_{i}", "_i")
        for row in joined.split(r"\\"):
            left, right = re.sub(r"\\label\{[^{}]*\}|\\tag\{[^{}]*\}", "", row).split("&=", 1)
            assert left.strip() not in found
            found[left.strip()] = right.strip()
    return found


def read(text: str, given: dict[str, Any]) -> dict[str, complex]:
    """Return the value of every formula, each computed when all that it needs is known."""
    values, open_ones = {name: complex(value) for name, value in given.items()}, formulas(text)
    while open_ones:
        done = {}
        for left, right in open_ones.items():
            try:
                done[left] = Reader(right, values).value()
            except AssertionError:
                continue
        assert done, f"nothing more can be computed: {open_ones}"
        values |= done
        open_ones = {left: right for left, right in open_ones.items() if left not in done}
    return values


def letters_of(p: Parameters, names: list[str]) -> dict[str, Any]:
    return {latex(LETTERS[name]): getattr(p, name) for name in names}


#: Always tried, with a map from one belt to the other.
QUICK = {"undamped": "P7", "no spring": "P8"}


@pytest.mark.quick(2)
@pytest.mark.parametrize("regime", [pytest.param(r, marks=[pytest.mark.slow] * (r not in QUICK)) for r in REGIMES])
@pytest.mark.parametrize("form", ["entire", "paper"])
def test_the_equations_of_a_flight(form: str, regime: str) -> None:
    """A random flight map with all, some or no numbers put in: f1 and f2 at a random point."""
    rng = random.Random(f"{form} {regime}")
    p, name = some_parameters(rng, regime), QUICK.get(regime) or rng.choice(FLIGHTS)
    deciding = ["m", "c", "k", *(["Omega"] if p.c == 0 else [])]
    numbers = rng.choice([deciding, list(PARAMETER_NAMES), [*deciding, "B0", "v1"]])
    scope = fragment_scope({each: str(getattr(p, each)) for each in numbers}, form=form)
    assert scope.regime.name == regime
    text = fragment_pages.as_latex(fragment_pages.check_fragment(name, scope), scope)
    start, end = (rng.uniform(-3, 3), rng.uniform(0, 6)), (rng.uniform(-3, 3), rng.uniform(6, 12))
    given = letters_of(p, [each for each in PARAMETER_NAMES if each not in numbers])
    given |= {"x_i": start[0], r"\theta_i": start[1], "x_{i+1}": end[0], r"\theta_{i+1}": end[1]}
    values = read(text, given)
    assert (values["f_1"], values["f_2"]) == pytest.approx(residual(p, name, start, end), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", ["P1", "P4"])
def test_the_equations_of_a_stick(name: str) -> None:
    rng = random.Random(name)
    p = some_parameters(rng, "underdamped")
    scope = fragment_scope({})
    text = fragment_pages.as_latex(fragment_pages.check_fragment(name, scope), scope, paper_tags=True)
    start, end = (rng.uniform(-3, 3), 1.0), (rng.uniform(-3, 3), 2.5)
    given = letters_of(p, list(PARAMETER_NAMES)) | {"x_i": start[0], "x_{i+1}": end[0], r"\theta_{i+1}": end[1]}
    given[r"\tau"] = (end[1] - start[1]) / float(p.Omega)
    values = read(text, given)
    below = {"P1": 1, "P4": 2}[name]
    for domain, way in ((below, "below"), (below + 1, "above")):
        f1, f2 = residual(p, name, start, end, exit=way)
        assert (values["f_1"], values[f"f_2^{{({domain})}}"] / float(p.m)) == pytest.approx((f1, f2), rel=1e-12)


@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", ["P2", "P3", "P5", "P6"])
def test_the_contact_and_the_windows_of_theorem_7(mapping: str) -> None:
    """The row of the table that gamma and a choose has the ends of the exact window, and x_m is its contact."""
    rng = random.Random(mapping)
    text = fragment_pages.as_latex(fragment_pages.check_fragment("theorem7", fragment_scope({})), fragment_scope({}))
    table = re.search(r"\\hline\n(.*?)\\end\{tabular\}", text, re.DOTALL)
    assert table
    column = 1 if mapping in ("P2", "P5") else 2
    for _ in range(12):
        p = some_parameters(rng, "underdamped").replace(v1=Fraction(rng.randint(-9, 9), 3), v2=Fraction(10, 3))
        if mapping in ("P5", "P6") and rng.random() < 0.5:
            p = p.replace(v1=-9, v2=Fraction(rng.randint(-9, 9), 3))
        window = grazing_window(p, mapping)
        speed = p.belt(window.place.boundary)
        given = letters_of(p, ["m", "c", "k", "B0", "Omega"]) | {r"v_\lambda": speed, r"\theta_m": 1.25}
        given[r"A_\alpha"] = p.A(window.place.domain)
        values = read(text, given)
        gamma, a = values[r"\gamma"].real, values["a"].real
        assert (gamma, a) == pytest.approx((float(window.gamma), float(window.amplitude)))
        force = float(p.A(window.place.domain) - p.c * speed)
        assert values["x_m"].real == pytest.approx((force + float(p.B0) * math.cos(1.25)) / float(p.k))
        if abs(gamma) >= a or gamma == 0:
            continue
        row = {True: "$0 < \\gamma < a$", False: "$-a < \\gamma < 0$"}[gamma > 0]
        cells = next(line for line in table[1].splitlines() if line.startswith(row)).split(" & ")
        ends = re.findall(r"[\[(](.*?),\\, (.*?)[\])](?: \\cup|\$| \\\\)", cells[column])
        critical = {r"\Theta^{\mathrm{cr}}": -math.asin(gamma / a)}
        printed = [Reader(end, critical).value().real for pair in ends for end in pair]
        assert printed == pytest.approx([end for low, high, *_ in window.intervals for end in (low, high)])


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("numbers", "regime"),
    [
        ({"k": "0"}, "no spring"),
        ({"c": "0"}, "undamped"),
        ({"c": "0", "k": "0"}, "free"),
        ({"c": "0", "k": "4", "m": "1", "Omega": "2"}, "resonance"),
        ({"c": "4", "k": "4", "m": "1"}, "critical"),
        ({}, "underdamped"),
    ],
)
@pytest.mark.parametrize("form", ["entire", "paper"])
def test_a_few_numbers_decide_the_regime(numbers: dict[str, str], regime: str, form: str) -> None:
    """And no formula divides by 0 with them."""
    scope = fragment_scope(numbers, form=form)
    assert scope.regime.name == regime
    text = fragment_pages.as_latex(fragment_pages.check_fragment("P3", scope), scope)
    assert ("The number is" in text) == (len(numbers) == 1)
    assert ("The numbers are" in text) == (len(numbers) > 1)


@pytest.mark.slow
def test_what_a_theorem_speaks_of_is_said_in_it() -> None:
    scope = fragment_scope({})
    text = fragment_pages.as_latex(fragment_pages.check_fragment("theorem7", scope), scope, paper_tags=True)
    head = next(line for line in text.splitlines() if line.endswith(r"\hline"))
    assert [word in head for word in ("(55), (57)", "(56), (58)", r"\tag")] == [True, True, False]
    for needed in (r"\sigma = 1$ where", r"A_\alpha + B_0\cos\Omega t$"):
        assert needed in text
    flight = fragment_pages.as_latex(fragment_pages.check_fragment("P7", scope), scope)
    assert r"\Sigma^{2}_{(\lambda)}$ are the points" in flight
    assert r"m\ddot{x} + c\dot{x} + k x = A_2 + B_0\cos\Omega t" in flight
