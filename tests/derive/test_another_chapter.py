"""What CONTRIBUTING says of a new chapter, done to the letter in a copy."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from project_files import ROOT

pytestmark = pytest.mark.slow
CHAPTER = r'''"""The energy of the mass."""

from symosc.derive.latex import named
from symosc.derive.steps import Sign, equation, step
from symosc.symbolic.solution import k, m, v, x

TITLE = "Energy"


def items(scope):
    """Return the chapter."""
    energy, still = named(r"\mathcal{E}"), named(r"\mathcal{E}_0")
    total = m * v**2 / 2 + k * x**2 / 2
    return (
        r"\subsection{The sum}",
        r"\begin{lemma}[energy]\label{thm:energy-sum} The energy \cite{newton1687} is",
        equation(energy, total, total, label="energy-total"),
        r"and never negative at rest:",
        step(still, ">=", 0, Sign({still: total.subs(v, 0)})),
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


def test_a_chapter_is_added_as_contributing_says(tmp_path: Path) -> None:
    for name in ("symosc", "tests", "derivations"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "CITATION.cff", "README.md"):
        shutil.copy(ROOT / name, tmp_path)
    derive = tmp_path / "symosc" / "derive"

    def insert(path: str, before: str, text: str) -> None:
        old = (derive / path).read_text(encoding="utf-8")
        assert before in old
        (derive / path).write_text(old.replace(before, text + before, 1), encoding="utf-8")

    def run(*command: str) -> str:
        env = os.environ | {"PYTHONPATH": str(tmp_path)}
        code = f"import sys, runpy; sys.path.insert(0, {str(tmp_path)!r}); sys.argv = {list(command)!r}; "
        code += f"runpy.run_module({command[0]!r}, run_name='__main__', alter_sys=True)"
        done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
        return done.stdout

    (derive / "chapters" / "energy.py").write_text(CHAPTER, encoding="utf-8")
    insert("chapters/__init__.py", "}\n", '    "energy": "the energy of the mass",\n')
    insert(
        "notation.py",
        '"""\nNOTATION',
        r"$\mathcal{E}$, $\mathcal{E}_0$ & energy, at rest & \eqref{eq:energy-total} \\" + "\n",
    )
    insert("references.bib", "@", REFERENCE)
    # All chapters would take long.
    log = json.loads(run("symosc", "derive", "energy", "-o", "derivations", "--json"))
    assert [(step["step"], step["kind"]) for step in log["steps"]] == [("13.1", "exact"), ("13.2", "sign")]
    assert r"\bibitem{newton1687}" in (tmp_path / "derivations" / "derivations.tex").read_text(encoding="utf-8")
    assert "energy" in run("symosc", "derive", "--help")
    tests = "energy or symbol_is_in or labels"
    run(
        "pytest",
        "-q",
        "-p",
        "no:cacheprovider",
        "-n0",
        "-m",
        "not campaign",
        "tests/derive/test_chapters.py",
        "-k",
        tests,
    )
