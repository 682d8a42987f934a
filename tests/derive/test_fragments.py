"""Fragments for a user's paper.

Checked, complete, LaTeX takes them, and what a reader computes from them is right.
"""

from __future__ import annotations

import json
import math
import random
import re
import subprocess
from fractions import Fraction
from functools import cache
from itertools import cycle
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from latex_reader import Reader
from parameter_sets import NUMBERS
from step_mutants import mutations
from symbols import KNOWN, symbols

from symosc import grazing_window, residual
from symosc.cli.app import main
from symosc.derive import document
from symosc.derive.fragments import FRAGMENTS, as_latex, check_fragment
from symosc.derive.scope import LETTERS, fragment_scope
from symosc.derive.steps import Step, StepError, StepEvidence, flat
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.symbolic.latex import latex

#: Damping and stiffness of m = 3/2 and Omega = 7/5 in each regime.
REGIMES = {
    "underdamped": ("1/5", "3"), "critical": ("6", "6"), "overdamped": ("9", "2"), "undamped": ("0", "2"),
    "resonance": ("0", "147/50"), "no spring": ("2/5", "0"), "free": ("0", "0"),
}  # fmt: skip
#: Their checks take more than a moment.
HEAVY = {"flow", *(f"P{n}" for n in (2, 3, 5, 6, 7, 8))}
#: Always tried, with a map from one belt to the other.
ALWAYS = {"undamped": "P7", "no spring": "P8"}
FLIGHTS = ("P2", "P3", "P5", "P6", "P7", "P8")


@cache
def printed(name: str) -> str:
    scope = fragment_scope({})
    return as_latex(check_fragment(name, scope), scope)


@pytest.fixture
def unchecked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Checks are skipped where only what is printed counts."""
    monkeypatch.setattr(Step, "verify", lambda step: StepEvidence("exact", "0"))


def run(*arguments: str) -> Any:
    return CliRunner().invoke(main, ["derive", *arguments])


# --- the checks ---


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", [name for name in FRAGMENTS if name not in HEAVY])
def test_every_step_has_evidence(name: str) -> None:
    assert check_fragment(name, fragment_scope({})).steps()


@pytest.mark.slow
@pytest.mark.full(1)
@pytest.mark.parametrize("form", ["paper", "entire"])
def test_every_step_of_a_flight_has_evidence(form: str) -> None:
    """The flights share the motion; the chapters on motion and maps check what is theirs alone."""
    assert check_fragment("P7", fragment_scope({}, form=form)).steps()


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["stick", "theorem6", "theorem7", "P1", "saltation"])
def test_a_changed_sign_fails(name: str) -> None:
    for item in flat(FRAGMENTS[name].items(fragment_scope({}))):
        for wrong in mutations(item) if isinstance(item, Step) else ():
            with pytest.raises(StepError):
                wrong.verify()


@pytest.mark.quick(3)
@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("name", FRAGMENTS)
def test_every_letter_of_a_fragment_is_defined_in_it(name: str) -> None:
    text = printed(name)
    body = re.sub(
        r"(?m)^%.*$|\\begin\{(?:tabular|center)\}(?:\{\w*\})?|\\end\{tabular\}|\\hline|\[8pt\]",
        "",
        text,
    )
    defined = set(re.findall(r"(?m)^(.+?) &", body)) | {"m", "c", "k", "F_N"}
    defined = {s for left in defined for s in symbols(left)}
    prose = {s for math in re.findall(r"\$(.*?)\$", body, re.DOTALL) for s in symbols(math)}
    model = {
        "A_0",
        "B_0",
        r"\Omega",
        "v_1",
        "v_2",
        r"\mu_1",
        r"\mu_2",
        "x",
        r"\dot{x}",
        r"\ddot{x}",
        "t",
        "e",
        r"\pi",
    }
    used = {s for rows in re.findall(r"&(.*)", body) for s in symbols(rows.split(r"\label")[0])}
    known = {s for s in used if KNOWN.fullmatch(s)}
    model |= {"x_i", r"\theta_i", "x_i+1", r"\theta_i+1", r"\dot{x}_i", r"\ddot{x}_i"}
    model |= {r"\tau", r"A_\alpha", r"v_\lambda"}
    assert used - known - defined - prose - model == set()


# --- read back by a reader who has nothing else ---


def some_parameters(rng: random.Random, regime: str) -> Parameters:
    c, k = REGIMES[regime]
    others = {
        name: Fraction(rng.randint(1, 30), rng.randint(2, 9))
        for name in ("A0", "B0", "mu1", "mu2", "FN")
    }
    v1 = Fraction(rng.randint(-9, 9), 2)
    return Parameters(m="3/2", Omega="7/5", c=c, k=k, v1=v1, v2=v1 + rng.randint(1, 9), **others)


def formulas(text: str) -> dict[str, str]:
    """Return the right sides of the displayed formulas by their left sides.

    Broken lines are joined.
    """
    values = {}
    for display in re.findall(r"\\begin\{align\}(.*?)\\end\{align\}", text, re.DOTALL):
        joined = re.sub(r"\\notag\s*\\\\\s*&(?:\\quad)?", " ", display).replace("_{i}", "_i")
        for row in joined.split(r"\\"):
            left, right = re.sub(r"\\label\{[^{}]*\}|\\tag\{[^{}]*\}", "", row).split("&=", 1)
            assert left.strip() not in values
            values[left.strip()] = right.strip()
    return values


def read(text: str, letters: dict[str, Any]) -> dict[str, complex]:
    """Return the value of every formula, each computed when all that it needs is known."""
    values = {name: complex(value) for name, value in letters.items()}
    waiting = formulas(text)
    while waiting:
        done = {}
        for left, right in waiting.items():
            try:
                done[left] = Reader(right, values).value()
            except AssertionError:
                continue
        assert done, f"nothing more can be computed: {waiting}"
        values |= done
        waiting = {left: right for left, right in waiting.items() if left not in done}
    return values


def letters_of(p: Parameters, names: list[str]) -> dict[str, Any]:
    return {latex(LETTERS[name]): getattr(p, name) for name in names}


@pytest.mark.quick(1)
@pytest.mark.full(5)
@pytest.mark.parametrize(
    ("form", "regime"), [(form, regime) for regime in REGIMES for form in ("entire", "paper")]
)
@pytest.mark.usefixtures("unchecked")
def test_the_equations_of_a_flight(form: str, regime: str) -> None:
    """A random flight map with all, some or no numbers put in: f1 and f2 at a random point."""
    rng = random.Random(f"{form} {regime}")
    p = some_parameters(rng, regime)
    name = ALWAYS.get(regime) or rng.choice(FLIGHTS)
    deciding = ["m", "c", "k", *(["Omega"] if p.c == 0 else [])]
    numbers = rng.choice([deciding, list(PARAMETER_NAMES), [*deciding, "B0", "v1"]])
    scope = fragment_scope(
        {parameter: str(getattr(p, parameter)) for parameter in numbers}, form=form
    )
    assert scope.regimes[0].name == regime
    text = as_latex(check_fragment(name, scope), scope)
    start = (rng.uniform(-3, 3), rng.uniform(0, 6))
    end = (rng.uniform(-3, 3), rng.uniform(6, 12))
    letters = letters_of(
        p, [parameter for parameter in PARAMETER_NAMES if parameter not in numbers]
    )
    letters |= {"x_i": start[0], r"\theta_i": start[1], "x_{i+1}": end[0], r"\theta_{i+1}": end[1]}
    values = read(text, letters)
    assert (values["f_1"], values["f_2"]) == pytest.approx(
        residual(p, name, start, end), rel=1e-9, abs=1e-9
    )


@pytest.mark.parametrize("name", ["P1", "P4"])
@pytest.mark.usefixtures("unchecked")
def test_the_equations_of_a_stick(name: str) -> None:
    rng = random.Random(name)
    p = some_parameters(rng, "underdamped")
    scope = fragment_scope({})
    text = as_latex(check_fragment(name, scope), scope, paper_tags=True)
    start = (rng.uniform(-3, 3), 1.0)
    end = (rng.uniform(-3, 3), 2.5)
    letters = letters_of(p, list(PARAMETER_NAMES)) | {
        "x_i": start[0],
        "x_{i+1}": end[0],
        r"\theta_{i+1}": end[1],
    }
    letters[r"\tau"] = (end[1] - start[1]) / float(p.Omega)
    values = read(text, letters)
    below = {"P1": 1, "P4": 2}[name]
    for domain, way in ((below, "below"), (below + 1, "above")):
        f1, f2 = residual(p, name, start, end, exit=way)
        assert (values["f_1"], values[f"f_2^{{({domain})}}"] / float(p.m)) == pytest.approx(
            (f1, f2), rel=1e-12
        )


@pytest.mark.quick(1)
@pytest.mark.parametrize("mapping", ["P2", "P3", "P5", "P6"])
@pytest.mark.usefixtures("unchecked")
def test_the_contact_and_the_windows_of_theorem_7(mapping: str) -> None:
    """The row of the table that gamma and a choose has the ends of the exact window, and x_m is its contact."""
    rng = random.Random(mapping)
    text = as_latex(check_fragment("theorem7", fragment_scope({})), fragment_scope({}))
    table = re.search(r"\\hline\n(.*?)\\end\{tabular\}", text, re.DOTALL)
    assert table
    if mapping in ("P2", "P5"):
        column = 1
    else:
        column = 2
    for _ in range(12):
        p = some_parameters(rng, "underdamped").replace(
            v1=Fraction(rng.randint(-9, 9), 3), v2=Fraction(10, 3)
        )
        if mapping in ("P5", "P6") and rng.random() < 0.5:
            p = p.replace(v1=-9, v2=Fraction(rng.randint(-9, 9), 3))
        window = grazing_window(p, mapping)
        speed = p.belt(window.place.boundary)
        letters = letters_of(p, ["m", "c", "k", "B0", "Omega"]) | {
            r"v_\lambda": speed,
            r"\theta_m": 1.25,
        }
        letters[r"A_\alpha"] = p.A(window.place.domain)
        values = read(text, letters)
        gamma = values[r"\gamma"].real
        a = values["a"].real
        assert (gamma, a) == pytest.approx((float(window.gamma), float(window.amplitude)))
        force = float(p.A(window.place.domain) - p.c * speed)
        assert values["x_m"].real == pytest.approx(
            (force + float(p.B0) * math.cos(1.25)) / float(p.k)
        )
        if abs(gamma) >= a or gamma == 0:
            continue
        row = {True: "$0 < \\gamma < a$", False: "$-a < \\gamma < 0$"}[gamma > 0]
        cells = next(line for line in table[1].splitlines() if line.startswith(row)).split(" & ")
        ends = re.findall(r"[\[(](.*?),\\, (.*?)[\])](?: \\cup|\$| \\\\)", cells[column])
        critical = {r"\Theta^{\mathrm{cr}}": -math.asin(gamma / a)}
        shown = [Reader(end, critical).value().real for pair in ends for end in pair]
        assert shown == pytest.approx(
            [end for low, high, *_ in window.intervals for end in (low, high)]
        )


# --- the command ---


def test_options(tmp_path: Path) -> None:
    text = run("P1", "--tags", "paper", "--prefix", "my", "--alone").stdout
    assert r"\tag{52}" in text
    assert r"\label{my:P1-f1}" in text
    assert text.startswith(r"\documentclass")
    assert json.loads(run("P1", "--json").stdout)["steps"]
    path = tmp_path / "p1.tex"
    result = run("P1", "-o", str(path))
    assert (result.exit_code, result.stdout) == (0, f"{path}\n")
    assert path.read_text(encoding="utf-8") == run("P1").stdout


# --- LaTeX ---


@pytest.mark.slow
@pytest.mark.usefixtures("unchecked")
@pytest.mark.skipif(not document.has_latex(), reason="no pdflatex")
def test_latex_takes_all_of_them_in_an_article(tmp_path: Path) -> None:
    article = "\\documentclass{article}\n\\usepackage{amsmath,amsthm}\n\\begin{document}\n"
    for name, (form, numbers) in zip(
        FRAGMENTS, cycle((("entire", False), ("paper", True))), strict=False
    ):
        scope = fragment_scope(NUMBERS if numbers else {}, form=form)
        text = as_latex(check_fragment(name, scope), scope, paper_tags=numbers)
        labels = re.findall(r"\\label\{([^{}]*)\}", text)
        article += text + " ".join(rf"\eqref{{{label}}}" for label in labels) + "\n\n"
    (tmp_path / "mine.tex").write_text(article + "\\end{document}\n", encoding="utf-8")
    for _ in range(2):
        command = [
            "pdflatex",
            "-interaction=nonstopmode",
            "-halt-on-error",
            "-draftmode",
            "mine.tex",
        ]
        subprocess.run(command, cwd=tmp_path, capture_output=True, check=True)
    complaints = document.complaints_of((tmp_path / "mine.log").read_text(encoding="latin-1"))
    assert not [line for line in complaints if not line.startswith("Overfull")]
