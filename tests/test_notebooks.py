"""What notebooks show: LaTeX of parameters, mappings, windows and orbits."""

from __future__ import annotations

from symosc import (
    OtherModel,
    Scene,
    find_orbit,
    frequency_response,
    grazing_window,
    load_scene,
    read_word,
)


def test_parameters_in_the_papers_letters() -> None:
    text = load_scene("fig9").parameters._repr_latex_()
    assert text.startswith("$m = 0.1")
    assert r"\Omega = 4" in text
    assert r"\mu_2 = 0.2" in text
    assert text.endswith("F_N = 10$")


def test_words_are_compositions() -> None:
    assert read_word("P32")._repr_latex_() == r"$P_{32} = P_3 \circ P_2$"
    assert read_word("P4645").latex() == r"P_{4645} = P_4 \circ P_6 \circ P_4 \circ P_5"


def test_windows_and_orbits() -> None:
    p = load_scene("fig9").parameters
    assert r"\arcsin\left(\frac{1}{12}\right)" in grazing_window(p, "P2")._repr_latex_()
    text = find_orbit(p, "P32")._repr_latex_()
    assert r"P_2: & 0.181670397924 & 4.15492066133" in text
    assert r"\lambda = -0.0168023 + 0.0695943\,\mathrm{i}" in text


def test_frequency_responses_and_scenes_of_other_models() -> None:
    assert "<svg" in (frequency_response("fig9", {"Omega": [4, 5]})._repr_html_() or "")
    model = OtherModel(m=1, k=1, Omega=1, FN=1, Y="5/3", joined=True)
    assert "5/3" in (Scene("wall", model, 0, 0, 0, 9)._repr_html_() or "")  # type: ignore[arg-type]
