"""LaTeX as Unicode: letters, indices, powers and signs; what it does not know is refused."""

from __future__ import annotations

import pytest

from symosc.derive.unicode_words import unicode_words


@pytest.mark.parametrize(
    ("latex", "plain"),
    [
        (r"At $F^{(1)} = 0$ it sticks.", "At F⁽¹⁾ = 0 it sticks."),
        (r"$\dot{x} - v_\lambda = F^{(\alpha)} \tau + \ldots$", "ẋ − v_λ = F⁽ᵅ⁾ τ + …"),
        (r"$B_0\Omega/\sqrt{(k - m\Omega^2)^2 + c^2\Omega^2} = \sqrt{20}$", "B₀Ω/√((k − mΩ²)² + c²Ω²) = √20"),
        (r"$-(B_0\Omega/m) \sin\Omega t_m$", "−(B₀Ω/m) sin Ωtₘ"),
        (r"$\partial\Omega_{ij}$ in $\mathbb{R}^{n-1}$", "∂Ωᵢⱼ in Rⁿ⁻¹"),
        (r"$v_\lambda^-$ for $\delta \to 0$", "v_λ⁻ for δ → 0"),
        (r"$F_{s1} = -\mu_1 F_N$, $\Theta^{\mathrm{cr}}$, $e^{-2\pi}$", "Fₛ₁ = −μ₁ FN, Θcr, e^(−2π)"),
        (r"$F^{(1)} \times F^{(2)} > 0$", "F⁽¹⁾ × F⁽²⁾ > 0"),
        ("$P_{4645}$, Fig.~10, (55)--(58)", "P₄₆₄₅, Fig. 10, (55)–(58)"),
    ],
)
def test_as_unicode(latex: str, plain: str) -> None:
    assert unicode_words(latex) == plain


@pytest.mark.parametrize("latex", [r"$\frac{1}{2}$", r"see \ref{a}", r"$x_$", r"$\foo$"])
def test_what_it_does_not_know_is_refused(latex: str) -> None:
    with pytest.raises(ValueError, match=r"unknown|only formulas|ends with"):
        unicode_words(latex)
