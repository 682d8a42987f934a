"""Derivations: fragments, chapters of a scene, pages, figures, references and errata, and what checks say of steps."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from html import unescape
from typing import Any
from unittest.mock import patch

import sympy as sp
from parameter_sets import NUMBERS
from project_files import ROOT
from said import outcome

from chapters import unchecked
from symosc import Scene, load_scene
from symosc.derive import citation, document, figures, front, mathml, steps
from symosc.derive.errata import latex_to_unicode, read_errata
from symosc.derive.fragments import FRAGMENTS, as_latex, check_fragment
from symosc.derive.latex import lines, width
from symosc.derive.scope import Scope, fragment_scope
from symosc.derive.steps import Step, StepError, StepEvidence, equation, step
from symosc.symbolic.latex import latex, named
from symosc.symbolic.solution import (
    B0,
    FN,
    Omega,
    c,
    h,
    k,
    m,
    mu1,
    mu2,
    omega_d,
    t,
    tau,
    theta_i,
    v,
    x,
    x_i,
)

#: A damper and no spring, equal roots, resonance, neither, and too strong a damper.
REGIMES = (
    {"c": "2/5", "k": "0"},
    {"c": "6", "k": "6", "m": "3/2"},
    {"c": "0", "k": "9/4", "m": "1", "Omega": "3/2"},
    {"c": "0", "k": "0"},
)
REGIMES += ({"c": "0", "k": "2", "m": "3/2"}, {"c": "9", "k": "2", "m": "3/2"})


def unproven() -> Any:
    """Return a context in which steps are not checked: only what is printed counts."""
    return patch.object(Step, "verify", lambda step: StepEvidence("exact", "0"))


def fragment(
    name: str, settings: dict[str, str] | None = None, scene: Scene | None = None, **how: Any
) -> str:
    """Return a fragment as LaTeX, without the version."""
    scope = fragment_scope(
        settings or {}, scene, how.pop("form", "entire"), how.pop("digits", None)
    )
    with unproven():
        text = as_latex(check_fragment(name, scope), scope, **how)
    return re.sub(r"\(symosc .*?\)", "", text)


def of_scene(key: str, name: str, html: bool = False) -> str:
    """Return a chapter with the numbers of a scene.

    Of LaTeX the lines that the general chapter does not have.
    """
    scope = Scope(load_scene(name))
    with unproven():
        chapter = document.check_chapter(key, scope)
    if html:
        return shown(document.as_html(chapter, scope))
    paths = (ROOT / "derivations" / document.CHAPTER_FOLDER).glob("*.tex")
    general = {path.stem: path.read_text(encoding="utf-8") for path in paths}
    labels = dict.fromkeys(re.findall(r"\\label\{([^{}]*)\}", "".join(general.values())), "")
    printed = document.as_latex(chapter, scope, labels).splitlines()
    return "\n".join(line for line in printed if line not in general[key].splitlines())


def shown(html: str) -> str:
    """Return a page without formulas, pictures and style: the converter's MathML is not ours."""
    html = re.sub(r"<style>.*?</style>", "", html, flags=re.DOTALL)
    html = re.sub(r'(base64,)[^"]*', r"\1", re.sub(r"<math.*?</math>", "<math>", html))
    return re.sub(r"(symosc|[Vv]ersion) \d[\w.]*", r"\1", html)


def bare(formula: str) -> str:
    """Return the tags and characters of a formula, with the attributes that are our own."""
    ours = r' (?:displaystyle="true"|accent="true"|mathvariant="normal"|width="[^"]*")'
    found = re.sub(
        r"<([^ >]+)( [^>]*)>",
        lambda tag: f"<{tag[1]}{''.join(sorted(re.findall(ours, tag[2])))}>",
        formula,
    )
    return unescape(found)


def page(*keys: str) -> str:
    """Return chapters as one page."""
    return shown(document.as_page([unchecked(key) for key in keys], Scope()))


def verified(given: Step) -> str:
    """Return the evidence for a step, or why it fails."""
    return outcome(lambda: f"{given}: {' '.join(map(str, given.verify()))}", StepError)


y, z = sp.symbols("y z", real=True)
p = sp.Symbol("p", positive=True)
f = sp.Function("f")


def two() -> dict[Any, Any]:
    """Return the root of x^2 = 2."""
    return {y: sp.sqrt(2), z: sp.Rational(7, 5)}


STEPS = [
    equation(y, 2 * z, {y: z + z}),
    equation(y, 2 * z, {y: z - z}),
    equation(y, z, {y: f(z)}),
    equation(y, 1, {y: sp.sin(z) ** 2 + sp.cos(z) ** 2}),
    equation(y, 0, {y: z, z: y + 1}),
    equation(y, 1, steps.exact({y: sp.cos(z)}, independent=False)),
    equation(y, z, steps.cases(steps.exact({y: 1, z: 1}), steps.exact({y: 2, z: 2}))),
    step(y, ">", 0, steps.cases(steps.sign({y: p}), steps.sign({y: 3}))),
    equation(y, 1, steps.cases(steps.at_root(lambda: {y: sp.Integer(1)}), steps.exact({y: 1}))),
    equation(y, sp.exp(-tau), steps.solves(0, 1, -1, cm=sp.Integer(2), w0sq=sp.Integer(1))),
    equation(y, sp.exp(-tau), steps.solves(0, 1, -1, cm=sp.Integer(2), w0sq=sp.Integer(2))),
    equation(y, sp.cos(tau), steps.solves(0, 1, 1, cm=sp.Integer(0), w0sq=sp.Integer(1))),
    step(y, ">=", 0, steps.sign({y: p**2})),
    step(y, "<", 0, steps.sign({y: p})),
    step(y, "<=", 0, steps.sign({y: -abs(z)})),
    step(y, ">", 1, steps.sign({y: z})),
    step(y, ">", 1, steps.sign({y: sp.Rational(3, 2)})),
    step(y, ">", z, steps.at_root(two)),
    step(y, "<", z, steps.at_root(two)),
    equation(y**2, 2, steps.at_root(two)),
    equation(y, z, steps.at_root(two)),
    equation(y, x, steps.at_root(two)),
    equation(sp.sqrt(-y), 1, steps.at_root(two)),
    steps.decimal("y", steps.CONTEXT.sqrt(2), 4),
    steps.decimal("y", 2, 3, steps.close(lambda: 2.0004, 3)),
    steps.decimal("y", 2, 3, steps.close(lambda: 2.0006, 3)),
]
PRINTED = [
    -x - mu1 * FN, (mu2 - mu1) * FN / m, (-mu1 - mu2) * FN, sp.sqrt(k / m), 1 / sp.sqrt(1 + x), -k * x_i / (c + m),
    sp.exp(-c * t / (2 * m)), sp.exp(-h * tau) * sp.cos(omega_d * tau), sp.exp((x + 1) / 2), sp.sin(-x), sp.sin(x / 2),
    sp.cos(x + 1) ** 2, sp.asin(x / 2), sp.Interval.Ropen(0, sp.pi / 2), sp.EmptySet, sp.Derivative(f(x), x, 2),
    sp.Union(sp.Interval.open(1, 2), sp.Interval(3, 4)), sp.Derivative(x + v, x, evaluate=False), 5 * x / 4, -2 * x / 3,
    named(r"F^{(1)}") ** 2, x * 3 * (x + 1), B0 * sp.cos(Omega * t) / (m * x), k**2 * (x + 1) ** 3, (x / m + 1) / k,
    x_i * (v + 1) * (x + 1), 1 / x, -1 / (2 * m), f(x) ** 2, 6 * x * Omega * m, theta_i + Omega * tau, sp.Integer(0),
]  # fmt: skip
FORMULAS = [
    r"\sin x + \cosh\tau", r"\bigl(F^{(1)}\bigr)^2", r"\Omega\,|_{x = 0}", r"\frac{a}{b}|_{t}", r"\ddot{x} \ge 0",
    r"x\arcsin y",
]  # fmt: skip
WORDS = [
    r"A \emph{word}, \textbf{bold} -- \texttt{-{}-pdf} and \textsc{e}, ``so'' by Csern\'ok~1, a<b.",
    r"see $x$, then $y$.",
    r"\begin{enumerate}\item one \item[(b)] two\end{enumerate} and \hyperlink{step-1.2}{(1.2)}",
]  # fmt: skip
UNICODE = [
    r"$\dot{x}^2 \le \sqrt{2}$ -- $\sqrt{a+b}$", r"$\Theta^{\mathrm{cr}}$~is $\arcsin(-\gamma/a)$",
    r"$F^{(\alpha)}_{12}$, $a^{xy}$", r"$\omega$", r"\emph{no}", "$x_$", r"$t_m^\pm \to\infty$, $x_{ij}$ \ldots",
]  # fmt: skip


def attempted(call: Callable[[str], str], texts: list[str]) -> str:
    """Return what a function makes of texts, or why it refuses them."""
    return "\n".join(outcome(partial(call, text), ValueError, before="error: ") for text in texts)


def references() -> str:
    """Return all references as lists print them, and how they are cited."""
    keys = citation.cited(r"\cite{shaw1986, denhartog1931}\cite[p.~2]{chen2016}")
    found = [f"{key}: {citation.plain_line(key)}" for key in citation.entries() if key != "symosc"]
    return "\n".join(
        [*found, *keys, citation.paper_reference(), citation.paper_reference("<i>{}</i>", "_", "-")]
    )


def errata() -> str:
    """Return the errata as mails and tables take them."""
    fields = ("severity", "where", "printed", "holds", "proof")
    return "\n".join(
        f"{e.number} {e.id}: {[getattr(e.in_unicode(), name) for name in fields]}"
        for e in read_errata()
    )


CASES: dict[str, Callable[[], object]] = {
    f"fragment {name}": partial(fragment, name) for name in FRAGMENTS
}
CASES |= {
    f"fragment {name} with numbers": partial(
        fragment, name, NUMBERS, form="paper", digits=digits, paper_tags=True
    )
    for name, digits in (
        ("P1", None),
        ("P5", 4),
        ("P8", None),
        ("theorem7", 3),
        ("friction", None),
        ("stick", 5),
    )
}
CASES |= {
    f"motion with {given}, {form}": partial(fragment, "flow", given, form=form)
    for given in REGIMES for form in ("entire", "paper")
}  # fmt: skip
CASES |= {
    "fragment of a scene, alone": lambda: fragment(
        "theorem6", scene=load_scene("fig9"), prefix="", alone=True
    ),
    "fragment without a spring": lambda: fragment("theorem7", {"k": "0"}, prefix="a.b"),
}
SCENES = {
    "maps": "fig10",
    "domains": "fig7",
    "grazing": "fig8",
    "motion": "fig5",
    "sticks": "fig6",
    "orbits": "fig9",
}
CASES |= {f"{key} of {scene}": partial(of_scene, key, scene) for key, scene in SCENES.items()}
CASES |= {
    f"errata of {scene}": partial(of_scene, "errata", scene) for scene in ("fig7", "fig8-exact")
}
CASES |= {"page of two chapters": partial(page, "sticks", "switching")}
CASES |= {
    "maps of a scene in HTML": partial(of_scene, "maps", "fig9", True),
    "front of a scene": lambda: front.scene_numbers(Scope(load_scene("fig9"))),
    "checks of steps": lambda: "\n".join(map(verified, STEPS)),
    "formulas in LaTeX": lambda: "\n".join(
        f"{latex(e)} | {latex(e, True)} | {width(latex(e)):.2f}" for e in PRINTED
    ),
    "long lines": lambda: [
        lines(equation(y, sp.expand((x + v + t) ** n)), False, left)
        for n in (3, 8)
        for left in (None, 40)
    ],
    "words in HTML": lambda: attempted(lambda text: shown(mathml.words(text)), WORDS),
    "formulas in HTML": lambda: attempted(
        lambda text: bare(mathml.formula(text, "x" in text)), FORMULAS
    ),
    "LaTeX in Unicode": lambda: attempted(latex_to_unicode, UNICODE),
    "references": references,
    "errata": errata,
    "complaints": lambda: document.complaints_of(
        "! no\nOverfull \\hbox (5.1pt too\nOverfull \\vbox (5.0pt\nLaTeX Warning: x\nok"
    ),
}
CASES |= {f"figure {key}": partial(figures.figure, key) for key in figures.FIGURES}
