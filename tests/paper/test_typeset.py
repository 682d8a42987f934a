"""Formulas in running text: letters, signs, indices and powers as a printer sets them."""

from __future__ import annotations

import pytest

from symosc.paper.typeset import typeset


@pytest.mark.parametrize(
    ("text", "html"),
    [
        ("F(1) F(2) >= -mu1 FN", "F<sup>(1)</sup> F<sup>(2)</sup> ≥ −μ<sub>1</sub> F<sub>N</sub>"),
        ("F⁽¹⁾ at x₀", "F<sup>(1)</sup> at x<sub>0</sub>"),
        ("x_{i+1}, v_lambda and Omega^2", "x<sub>i+1</sub>, v<sub>λ</sub> and Ω<sup>2</sup>"),
        ("1.2e-05, 1e+3 and -7", "1.2·10<sup>−5</sup>, 10<sup>3</sup> and −7"),
        ("P4645 of v1.", "P<sub>4645</sub> of v<sub>1</sub>."),
        ("x'' + x' = 0 <b>", "ẍ + ẋ\u00a0=\u00a00 &lt;b&gt;"),
        ("F⁽ˡᵒ⁾ at ∂Ωᵢⱼ, μ FN", "F<sup>(lo)</sup> at ∂Ω<sub>ij</sub>, μ F<sub>N</sub>"),
        ("x0 = −3.1049009630…, −(c/m)", "x<sub>0</sub>\u00a0=\u00a0−3.1049009630…, −\u2060(c/m)"),
        ("fig7-corrected and fig10: belt2", "Fig.\u00a07 (corrected) and Fig.\u00a010: belt\u00a02"),
        ("|γ| = a where |F(1)| > 0", "|\u2060γ\u2060|\u00a0=\u00a0a where |\u2060F<sup>(1)</sup>\u2060| &gt; 0"),
        ("DOP853, version v0.1, the mass's", "DOP853, version v0.1, the mass's"),
    ],
)
def test_formulas_in_text(text: str, html: str) -> None:
    assert typeset(text) == html
