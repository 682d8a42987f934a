"""What CONTRIBUTING says of a new chapter, done to the letter in a copy."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from scratch import Scratch

from symosc.derive.chapters import CHAPTERS

CHAPTER = r'''"""The energy of the mass."""

from symosc.symbolic.latex import named
from symosc.derive.steps import sign, equation, step
from symosc.symbolic.solution import k, m, v, x

TITLE = "Energy"


def items(scope):
    """Return the chapter."""
    energy, still = named(r"\mathcal{E}"), named(r"\mathcal{E}_0")
    total = m * v**2 / 2 + k * x**2 / 2
    return (
        r"\subsection{The sum}",
        r"\begin{lemma}[energy]\label{thm:energy-sum} The energy \cite{newton1687} is",
        equation(energy, total, total, "total"),
        r"and never negative at rest:",
        step(still, ">=", 0, sign({still: total.subs(v, 0)})),
        r"\end{lemma}",
    )
'''
REFERENCE = """@book{newton1687,
  author    = {Newton, Isaac},
  title     = {Principia},
  publisher = {Royal Society},
  address   = {London},
  year      = {1687},
  checked   = {title},
}

"""


@pytest.mark.slow
def test_a_chapter_is_added_as_contributing_says(tmp_path: Path) -> None:
    scratch = Scratch(tmp_path)
    scratch.write("symosc/derive/chapters/energy.py", CHAPTER)
    last = '    "chaos": "when chaos is possible and when not",\n'
    scratch.replace(
        "symosc/derive/chapters/__init__.py",
        last,
        last + '    "energy": "the energy of the mass",\n',
    )
    symbol = r"$\mathcal{E}$, $\mathcal{E}_0$ & energy, at rest & \eqref{eq:energy-total} \\"
    scratch.replace("symosc/derive/front.py", '"""\nNOTATION', f'{symbol}\n"""\nNOTATION')
    scratch.replace(
        "symosc/derive/references.bib", "@article{luo2008", REFERENCE + "@article{luo2008"
    )
    # All chapters would take long.
    log = json.loads(scratch.run("symosc", "derive", "energy", "-o", "derivations", "--json"))
    number = len(CHAPTERS) + 1
    assert [(step["step"], step["kind"]) for step in log["steps"]] == [
        (f"{number}.1", "exact"),
        (f"{number}.2", "sign"),
    ]
    assert r"\label{eq:energy-total}" in (tmp_path / "derivations/chapters/energy.tex").read_text(
        encoding="utf-8"
    )
    assert r"\bibitem{newton1687}" in (tmp_path / "derivations" / "derivations.tex").read_text(
        encoding="utf-8"
    )
    assert "chaos, energy, or all" in " ".join(scratch.run("symosc", "derive", "--help").split())
