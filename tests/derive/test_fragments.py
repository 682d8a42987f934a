"""Fragments for a user's paper: complete, right with numbers put in, and LaTeX takes them alone and in an article."""

from __future__ import annotations

import json
import re
import subprocess
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sympy as sp
from click.testing import CliRunner
from samples import few

from symosc.cli.app import main
from symosc.derive import fragment_pages, notation, pdf
from symosc.derive.fragment_scope import fragment_scope
from symosc.derive.fragments import FRAGMENTS
from symosc.derive.mutations import mutations
from symosc.derive.paper_form import paper_form
from symosc.derive.steps import Check, Relation, Step, StepError, StepEvidence
from symosc.errors import ParameterError
from symosc.model import Parameters
from symosc.simulation.simulate import simulate
from symosc.symbolic import solution

NUMBERS = {"m": "1", "c": "2/5", "k": "4", "A0": "1", "B0": "3", "Omega": "3/2", "FN": "9.81"}
NUMBERS |= {"v1": "1", "v2": "5", "mu1": "0.8", "mu2": "0.6"}
#: With letters in one form, with numbers in the other.
KINDS = [(name, *kind) for name in FRAGMENTS for kind in (("entire", False), ("paper", True))]
#: Their checks take more than a moment.
HEAVY = {"flow", *(f"P{n}" for n in (2, 3, 5, 6, 7, 8))}


@cache
def latex(name: str, form: str = "entire", numbers: bool = False, alone: bool = False) -> str:
    scope = fragment_scope(NUMBERS if numbers else {}, form=form)
    return fragment_pages.as_latex(fragment_pages.check_fragment(name, scope), scope, alone=alone)


@pytest.fixture
def unchecked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Checks are skipped where only what is printed counts."""
    monkeypatch.setattr(Step, "verify", lambda step: StepEvidence("exact", "0"))


def run(*arguments: str) -> Any:
    return CliRunner().invoke(main, ["derive", *arguments])


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", [name for name in FRAGMENTS if name not in HEAVY])
def test_every_step_has_evidence(name: str) -> None:
    assert fragment_pages.check_fragment(name, fragment_scope({})).steps()


@pytest.mark.slow
@pytest.mark.parametrize("form", ["entire", "paper"])
def test_every_step_of_a_flight_has_evidence(form: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The flights share the motion: a step that comes again, with an equal check, is not checked again."""
    verify, passed = Step.verify, dict[Relation, list[tuple[Check, StepEvidence]]]()

    def once(step: Step) -> StepEvidence:
        known = passed.setdefault(step.statement, [])
        for check, evidence in known:
            if type(check) is type(step.check) and vars(check) == vars(step.check):
                return evidence
        known.append((step.check, verify(step)))
        return known[-1][1]

    monkeypatch.setattr(Step, "verify", once)
    for name in sorted(HEAVY):
        assert fragment_pages.check_fragment(name, fragment_scope({}, form=form)).steps()


@pytest.mark.quick(2)
@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("name", FRAGMENTS)
def test_a_fragment_has_labels_and_no_tags(name: str) -> None:
    text = latex(name)
    labels = re.findall(r"\\label\{([^{}]*)\}", text)
    rows = re.findall(r"\\begin\{align\}(.*?)\\end\{align\}", text, re.DOTALL)
    assert labels
    assert len(labels) == len(set(labels))
    assert all(label.startswith(f"symosc:{name}-") for label in labels)
    assert r"\tag" not in text
    assert sum(row.count(r"\label") for row in rows) == len(labels)
    assert not re.findall(r"\\(?:ref|eqref|cite|checkedby|markit)\b", text)  # nothing that is elsewhere


@pytest.mark.quick(3)
@pytest.mark.usefixtures("unchecked")
@pytest.mark.parametrize("name", FRAGMENTS)
def test_every_letter_of_a_fragment_is_defined_in_it(name: str) -> None:
    text = latex(name)
    body = re.sub(r"(?m)^%.*$|\\begin\{(?:tabular|center)\}(?:\{\w*\})?|\\end\{tabular\}|\\hline|\[8pt\]", "", text)
    defined = set(re.findall(r"(?m)^(.+?) &", body)) | {"m", "c", "k", "F_N"}
    defined = {s for left in defined for s in notation.symbols(left)}
    prose = {s for math in re.findall(r"\$(.*?)\$", body, re.DOTALL) for s in notation.symbols(math)}
    model = {"A_0", "B_0", r"\Omega", "v_1", "v_2", r"\mu_1", r"\mu_2", "x", r"\dot{x}", r"\ddot{x}", "t", "e", r"\pi"}
    used = {s for rows in re.findall(r"&(.*)", body) for s in notation.symbols(rows.split(r"\label")[0])}
    known = {s for s in used if notation.KNOWN.fullmatch(s)}
    index = {
        "x_i",
        r"\theta_i",
        "x_i+1",
        r"\theta_i+1",
        r"\dot{x}_i",
        r"\ddot{x}_i",
        r"\tau",
        r"A_\alpha",
        r"v_\lambda",
    }
    assert used - known - defined - prose - model - index == set()


@pytest.mark.slow
@pytest.mark.parametrize("regime", solution.REGIMES)
def test_the_form_of_papers_is_the_motion(regime: str) -> None:
    """In every regime its closed form, with its constants, has the position and the velocity of the other form."""
    form, dice = paper_form(solution.REGIMES[regime]), {"m": sp.Rational(3, 2), "Omega": sp.Rational(7, 5)}
    coefficients = {
        "underdamped": ("1/5", "3"), "critical": ("6", "6"), "overdamped": ("9", "2"), "undamped": ("0", "2"),
        "resonance": ("0", "147/50"), "no spring": ("2/5", "0"), "free": ("0", "0"),
    }  # fmt: skip
    c, k = (sp.Rational(each) for each in coefficients[regime])
    p = Parameters(**NUMBERS | {"m": "3/2", "Omega": "7/5", "c": str(c), "k": str(k), "v1": "-90", "v2": "90"})
    letters = {solution.m: dice["m"], solution.Omega: dice["Omega"], solution.c: c, solution.k: k}
    letters |= {name: value.subs(letters) for name, value in solution.REGIMES[regime].letters.items()}
    tau = sp.Rational(4, 5)
    put = {solution.x_i: sp.Rational(2, 3), solution.v_i: 2, solution.theta_i: 0, solution.B0: 3, solution.tau: tau}
    put |= {solution.A: sp.Rational(1) - sp.Rational("0.2") * sp.Rational("9.81")}
    motion = simulate(p, t0=0, x0="2/3", v0=2, t_end=1)
    for expr, expected in zip((form.x, form.v), motion(0.8), strict=True):
        value = expr.subs(form.constants).subs(form.constants).subs(letters).subs(put)
        assert float(sp.N(value, 20)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", few(["stick", "theorem6", "theorem7", "P1", "saltation"], "theorem6", "theorem7"))
def test_a_changed_sign_fails(name: str) -> None:
    scope = fragment_scope({})
    for item in FRAGMENTS[name].items(scope):
        if hasattr(item, "check"):
            for wrong in mutations(item):
                with pytest.raises(StepError):
                    wrong.verify()


def test_numbers_are_exact_or_rounded() -> None:
    exact, rounded = run("P1", "--set", "A0=1/3"), run("P1", "--set", "A0=1/3", "--digits", "4")
    assert r"\frac{1}{3}" in exact.stdout
    assert "0.3333" in rounded.stdout
    assert "A_0" not in exact.stdout.replace("$A_0 = 1/3$", "")
    assert "- 17.962" in run("P1", "--scene", "fig5").stdout  # A_0 - c v_1 - (mu_1 - mu_2) F_N


@pytest.mark.slow
def test_theorem_7_in_numbers_names_the_windows() -> None:
    text = run("theorem7", "--set", "m=1", "--set", "k=1", "--set", "B0=2", "--set", "Omega=1", "--set", "v1=1").stdout
    window = next(row for row in text.splitlines() if "window-P3" in row)
    assert r"\left(\frac{7 \pi}{6},\, \frac{11 \pi}{6}\right)" in window
    assert "window-P5" not in text  # v2 is open


@pytest.mark.slow
def test_without_a_spring_theorem_7_has_no_position() -> None:
    assert "x_m" not in run("theorem7", "--set", "k=0").stdout


def test_options() -> None:
    text = run("P1", "--tags", "paper", "--prefix", "my", "--alone").stdout
    assert r"\tag{52}" in text
    assert r"\label{my:P1-f1}" in text
    assert text.startswith(r"\documentclass")
    assert json.loads(run("P1", "--json").stdout)["steps"]


def test_a_fragment_goes_into_a_file(tmp_path: Path) -> None:
    path = tmp_path / "p1.tex"
    result = run("P1", "-o", str(path))
    assert (result.exit_code, result.stdout) == (0, f"{path}\n")
    assert path.read_text(encoding="utf-8") == run("P1").stdout


@pytest.mark.slow
def test_text_has_words_apart() -> None:
    text = run("theorem7", "--format", "text").stdout + run("stick", "--format", "text").stdout
    assert not re.findall(r"cost|sint|\)Omega|\)theta|\\|[a-z]_\d[a-z]", text)
    assert "B_0*cos(theta_m)" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["therem7"], "did you mean theorem7?"),
        (["P9"], "P1, P2"),
        (["P3", "--set", "A=5"], "A = '5': is not a parameter; the parameters are m, c, k, A0"),
        (["P3", "--set", "k"], "is not NAME=VALUE"),
        (["P3", "--set", "k=x"], "k = 'x'"),
        (["P3", "--set", "m=-1"], "m = '-1': must be > 0"),
        (["P3", "--set", "v1=3", "--set", "v2=2"], "v1"),
        (["P3", "--digits", "0"], "--digits"),
        (["P3", "--form", "short"], "--form"),
        (["P3", "--pdf"], "is for chapters"),
        (["P3", "--format", "html"], "is for chapters"),
        (["P1", "--prefix", "{x"], "prefix = '{x'"),
        (["maps", "--set", "k=3"], "is for fragments"),
        (["maps", "--digits", "3"], "is for fragments"),
        (["P1", "-o", "missing/p1.tex"], "missing"),
    ],
)
def test_bad_input_costs_one_line(arguments: list[str], message: str, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert (result.exit_code, result.stdout) == (2, ""), result.output
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_scope_refuses_an_unknown_form() -> None:
    with pytest.raises(ParameterError, match="form"):
        fragment_scope({}, form="short")


def compiled(folder: Path, name: str) -> str:
    """Compile twice and return the log of the second run."""
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", name]
    for _ in range(2):
        subprocess.run(command, cwd=folder, capture_output=True, check=True)
    return (folder / name).with_suffix(".log").read_text(encoding="latin-1")


@pytest.mark.slow
@pytest.mark.full(5)  # all of them are compiled in the article below
@pytest.mark.usefixtures("unchecked")
@pytest.mark.skipif(not pdf.has_latex(), reason="no pdflatex")
@pytest.mark.parametrize("name", FRAGMENTS)
def test_latex_takes_a_fragment_alone(name: str, tmp_path: Path) -> None:
    (tmp_path / "alone.tex").write_text(latex(name, alone=True), encoding="utf-8")
    assert not [c for c in pdf.complaints_of(compiled(tmp_path, "alone.tex")) if not c.startswith("Overfull")]


@pytest.mark.slow
@pytest.mark.usefixtures("unchecked")
@pytest.mark.skipif(not pdf.has_latex(), reason="no pdflatex")
def test_latex_takes_all_of_them_in_an_article(tmp_path: Path) -> None:
    inputs, labels = [], []
    for name, form, numbers in KINDS:
        scope = fragment_scope(NUMBERS if numbers else {}, form=form)
        fragment = fragment_pages.check_fragment(name, scope)
        text = fragment_pages.as_latex(fragment, scope, prefix=form, paper_tags=numbers)
        path = f"{name}-{form}.tex"
        (tmp_path / path).write_text(text, encoding="utf-8")
        inputs.append(rf"\section{{x}}\input{{{path}}}")
        labels += re.findall(r"\\label\{([^{}]*)\}", text)
    references = " ".join(rf"\eqref{{{label}}}" for label in labels)
    article = (
        "\\documentclass[11pt,a4paper]{article}\n\\usepackage{amsmath,amsthm}\n\\newtheorem{theorem}{Theorem}\n"
        "\\begin{document}\n\\begin{equation}\\label{eq:mine} x = 1 \\end{equation}\n"
        + "\n".join(inputs)
        + f"\n{references}\n\\end{{document}}\n"
    )
    (tmp_path / "mine.tex").write_text(article, encoding="utf-8")
    complaints = pdf.complaints_of(compiled(tmp_path, "mine.tex"))
    assert not [each for each in complaints if not each.startswith("Overfull")]
