"""Exact answers: Theorem 7 and its inverse, for numbers, letters and regions.

Exported source in each language.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import sympy as sp
from paper_orbits import FIG9, FIG10
from said import empty_folder, outcome

from symosc import Parameters, theorem7, values_containing, values_empty, values_everything
from symosc.kernels.theorem7_cases import PLACES
from symosc.symbolic import codegen, inverse
from symosc.symbolic.export import LANGUAGES, export, write_export
from symosc.symbolic.theorem7 import critical_phase, sign_of

#: Belt 1 stands still, belt 2 has the speed of equality at Omega = 2; no drive; no spring.
STILL = Parameters(m=1, c=1, k=2, A0=0, B0=-3, Omega=2, v1=0, v2=3, mu1=1, mu2=1, FN=1)
SCENES = {
    "fig9": FIG9,
    "fig10": FIG10,
    "still": STILL,
    "no drive": STILL.replace(B0=0),
    "no spring": FIG9.replace(k=0),
}
PHASES: tuple[Any, ...] = (
    "0", "pi/2", "3*pi/2", "7*pi/6", sp.pi / 7, ("pi", "5*pi/4"), ("7*pi/4", "9*pi/4"), sp.Interval.open(0, sp.pi),
    sp.Interval.Lopen(sp.pi / 2, 3 * sp.pi / 2), sp.Interval.Ropen(0, 2 * sp.pi), (-1, 1),
    sp.Interval.Ropen(5 * sp.pi / 4, 7 * sp.pi / 4), sp.Interval.Lopen(5 * sp.pi / 4, 7 * sp.pi / 4),
)  # fmt: skip
a = sp.Symbol("a", positive=True)
g = sp.Symbol("g", negative=True)


def theorem(mapping: str, order: Any) -> str:
    """Return Theorem 7 of a mapping: for letters, for letters of known sign, and for numbers."""
    found = [
        theorem7(mapping, order=order).latex(),
        str(theorem7(mapping, g, 2, order).piecewise()),
    ]
    found += [
        case.latex() for case in (*theorem7(mapping, -1, a, order), *theorem7(mapping, 0, a, order))
    ]
    numbers = [(3, 5), (5, 5), (7, 5), (0, 5), (-3, 5), (-5, 5), (-7, 5), (1, 0), (-1, 0), (0, 0)]
    numbers += [(gamma, -amplitude) for gamma, amplitude in numbers[:7]] + [
        ("pi/4", sp.sqrt(2)),
        ("0.5", "1/2"),
    ]
    found += [
        f"{gamma}, {size}: {theorem7(mapping, gamma, size, order)}" for gamma, size in numbers
    ]
    return "\n".join(found)


def questions(mapping: str, p: Parameters | None, names: Any, phases: Any, order: Any) -> list[Any]:
    """Return the answers to the three questions; for several phases."""
    found = [values_containing(p, mapping, names, phase, order) for phase in phases]
    return [*found, values_empty(p, mapping, names), values_everything(p, mapping, names, order)]


def answers(mapping: str, scene: str) -> str:
    """Return all answers on one parameter, and on pairs of them, for numbers."""
    p = SCENES[scene]
    belt = f"v{PLACES[mapping].boundary}"
    lines = []
    if scene == "fig10":
        order = "paper"
    else:
        order = "full"
    for name in ("Omega", "B0", "k", belt):
        lines += [each.text() for each in questions(mapping, p, name, PHASES, order)]
    for pair in (("Omega", "B0"), ("k", "v_lambda"), ("B0", "k"), (belt, "Omega")):
        lines += [each.text() for each in questions(mapping, p, pair, PHASES[1::2], order)]
    return "\n".join(lines)


def lettered(mapping: str) -> str:
    """Return all answers on one parameter in letters, as text and as LaTeX."""
    lines = []
    for name in ("Omega", "B0", "k", "v_lambda"):
        for each in questions(mapping, None, name, (None, "3*pi/2", "pi", "pi/3"), "full"):
            lines += [each.text(), each[0].latex()]
    return "\n".join([*lines, each.latex()])


def formatted() -> str:
    """Return what answers say besides their text."""
    found = values_containing(FIG9, "P2", "Omega", ("pi", "5*pi/4"))
    lines = []
    lines += [
        found.latex(),
        repr(found),
        str(bool(found)),
        str([value in found for value in ("1/3", 1, sp.sqrt(2) / 4)]),
    ]
    lines += [
        str(found.sup),
        str(found == found.values),
        str(sp.sympify(found) & sp.Interval(0, sp.Rational(1, 10))),
    ]
    for p, names, theta in (
        (FIG9, ("Omega", "k"), "7*pi/6"),
        (STILL, ("v2", "B0"), "3*pi/2"),
        (STILL, ("v1", "k"), "0"),
    ):
        region = values_containing(p, "P5" if "v2" in names else "P2", names, theta)
        lines += [region.latex(), repr(region), str(region.letters), str(region.allowed)]
    lines.append(values_containing(FIG9, "P2", ("B0", "k"), (0, "2*pi")).latex())
    region = values_everything(STILL, "P5", ("k", "v2"))
    lines += [
        region.latex(),
        *(str(region.contains(k=k, v2=v2)) for k, v2 in ((2, 3), (1, 3), (1, "6.1"), (0, 1))),
    ]
    empty = values_empty(STILL.replace(B0=0), "P2", ("Omega", "k"))
    lines += [
        empty.latex(),
        str(empty.contains(Omega=1, k=1)),
        values_everything(STILL, "P2", "k").latex(),
    ]
    for question in (
        found.question,
        region.question,
        empty.question,
        values_empty(None, "P3", "B0").question,
    ):
        lines += [question.text(), question.latex()]
    return "\n".join(lines)


def signs() -> list[object]:
    """Return signs of numbers that are 0 or nearly so, and critical phases."""
    zero = sp.sqrt(2) * sp.sqrt(3) - sp.sqrt(6)
    numbers = [
        zero,
        sp.sin(sp.pi / 5) ** 2 + sp.cos(sp.pi / 5) ** 2 - 1,
        zero + sp.Rational(1, 10**60),
        -sp.exp(-300),
    ]
    pairs = [(3, 5), (5, -5), (6, 5), (0, 0), (-1, 2)]
    return [
        *map(sign_of, numbers),
        *(str(critical_phase(*map(sp.Integer, pair))) for pair in pairs),
    ]


def source(word: str, language: str, name: str | None = None) -> str:
    """Return the exported source of a word, without empty lines."""
    texts = export(word, language, name)
    lines = [
        line
        for file, text in texts.items()
        for line in (f"--- {file}", *text.splitlines())
        if line.strip()
    ]
    return "\n".join(lines)


def code_of(kernel: codegen.Kernel) -> str:
    return "\n".join(codegen.function_source(kernel).splitlines()[2:])


def kernels() -> str:
    """Return the code of kernels that are made up, or why there is none."""
    x, y, z, w = sp.symbols("x y z w")
    formulas = [
        -x - y,
        x - y * z - z**2,
        3 * x / y,
        -x * y,
        (x + y) / z,
        x / (y * z),
        1 / (x + y),
        -(x + y) * z,
        sp.S.Zero,
    ]
    formulas += [
        2 - x,
        x * y + x * y * z + 1,
        x + y * z + 2 * z * x,
        (x + y * z) ** 2,
        sp.Rational(2, 3) * x - 1,
        x**3,
    ]
    formulas += [
        sp.expand((x + 2 * y + 3 * z) ** 4),
        sp.sqrt(x),
        sp.Rational(1, 3),
        x + w,
        sp.sin(x),
        x / y - y / x,
    ]
    lines = []
    for formula in formulas:
        kernel = codegen.Kernel(
            "f", "Made up.", {"x": x, "y": y, "z": z}, {"u": x * y, "r": formula}, ("u", "r")
        )
        lines += outcome(partial(code_of, kernel), ValueError, before="error: ").splitlines()
    return "\n".join(lines)


def written() -> str:
    """Return which files are written."""
    with empty_folder() as folder:
        paths = write_export(folder / "new", "P2", "c")
        return "\n".join(f"{path.parent.name}/{path.name}" for path in paths)


CASES: dict[str, Callable[[], object]] = {
    f"Theorem 7 for {mapping}, {order}": partial(theorem, mapping, order)
    for mapping, order in (("P2", "full"), ("P3", "full"), ("P5", "paper"), ("P6", "paper"))
}
CASES |= {
    f"answers in letters for {mapping}": partial(lettered, mapping) for mapping in ("P2", "P6")
}
CASES |= {
    f"answers for {mapping}, {scene}": partial(answers, mapping, scene)
    for mapping, scene in zip(("P2", "P3", "P5", "P6", "P3", "P6"), (*SCENES, "fig9"), strict=True)
}
CASES |= {f"source in {language}": partial(source, "P12", language) for language in LANGUAGES}
CASES |= {
    "what answers say": formatted,
    "signs": signs,
    "kernels": kernels,
    "written files": written,
    "conditions": lambda: [
        inverse.condition_text(condition)
        for condition in (
            sp.Or(sp.And(a > 1, g < -1), sp.Eq(a, 2)),
            sp.And(sp.Or(a > 1, g < -1), sp.Eq(a, 2)),
        )
    ],
}
