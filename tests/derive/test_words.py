"""LaTeX as plain words."""

from __future__ import annotations

import pytest

from symosc.derive.words import plain_math, plain_words


@pytest.mark.parametrize(
    ("latex", "text"),
    [
        (r"\cos\theta", "cos theta"),
        (r"\frac{B_0}{m}\Omega", "(B_0/m) Omega"),
        (r"\frac{a + b}{2m}", "(a + b)/(2 m)"),
        (r"e^{-c\tau/2m}\cos\omega_d\tau", "e^(-c tau/2 m) cos omega_d tau"),
        (r"F^{(\lambda+1)}(x, \dot{x}, t)", "F^(lambda + 1) (x, x', t)"),
        (r"\Theta^{\mathrm{cr}} = \arcsin(-\gamma/a)", "Theta^cr = arcsin(-gamma/a)"),
        (r"x_{i+1}", "x_(i+1)"),
        (r"\sqrt{k/m - h^2}", "sqrt(k/m - h^2)"),
        (r"[-1, 1]", "[-1, 1]"),
    ],
)
def test_formulas_as_text(latex: str, text: str) -> None:
    assert plain_math(latex) == text


def test_words_as_text() -> None:
    assert plain_words(r"P\'olya's \emph{lemma}: for $\cos\theta > 0$~-- or not") == (
        "Polya's lemma: for cos theta > 0 - or not"
    )
