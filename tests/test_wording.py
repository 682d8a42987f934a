"""What a user reads: numbers as one writes them, hints that are right, messages and summaries whole."""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction
from math import pi
from pathlib import Path
from typing import Any

import pytest
from cli_runs import COMMANDS, good, run

import symosc
from symosc import (
    OtherModel,
    Scene,
    SymoscError,
    load_scene,
    plot,
    simulate,
    simulate_many,
)
from symosc.base.errors import meant
from symosc.base.phases import read_phase
from symosc.base.quantities import read_number
from symosc.reference.cases import chosen
from symosc.scenes import as_toml

FIG9 = load_scene("fig9")


def refusal(call: Callable[[], object]) -> str:
    """Return the text of the error that a call raises."""
    with pytest.raises((SymoscError, TypeError)) as caught:
        call()
    return str(caught.value)


def test_a_function_is_shown_by_its_name() -> None:
    def falling(w: float) -> float:
        raise ValueError("no")

    message = refusal(lambda: symosc.Belt.from_function(1, falling, until=2))
    assert message == "mu = falling: fails at w = 0 with ValueError: no"
    assert refusal(lambda: simulate(print)).startswith("scene = print: ")  # type: ignore[arg-type]
    assert " at 0x" not in refusal(lambda: simulate(object()))  # type: ignore[arg-type]


def test_a_word_of_belts_is_answered_by_words_of_belts() -> None:
    law = symosc.Oscillator(m=1, c="0.1", k=1, belts=[symosc.Belt("0.2", "0.5", mu_s=1)])
    message = refusal(lambda: symosc.find_orbit(law, "S1B1"))
    assert "the mappings of one belt are S1, B1 and A1, written A1∘B1, 'A1 B1' or" in message


# --- ends in periods of the drive ---


@pytest.mark.parametrize("count", ["10", "2.5", "1/2"])
def test_an_end_in_periods_is_read_everywhere(count: str, tmp_path: Path) -> None:
    text = f"{count}T"
    period = 2 * pi / float(FIG9.parameters.Omega)
    end = float(FIG9.t0) + float(Fraction(count)) * period
    lines = as_toml(FIG9).splitlines()
    lines = [f't_end = "{text}"' if line.startswith("t_end") else line for line in lines]
    file = tmp_path / "mine.toml"
    file.write_text("\n".join(lines), encoding="utf-8")
    start = {"t0": FIG9.t0, "x0": FIG9.x0, "v0": FIG9.v0}
    scene = Scene("mine", FIG9.parameters, **start, t_end=text)  # type: ignore[arg-type]
    assert float(scene.t_end) == end
    assert load_scene(file).t_end == scene.t_end
    assert simulate(file).t_end == simulate(FIG9, t_end=text).t_end == end
    assert simulate(FIG9.parameters, **start, t_end=text).t_end == end
    assert (
        simulate_many(FIG9.parameters, [tuple(map(float, start.values()))], text, record="t").t
        == end
    )
    assert good("simulate", str(file)) == good("simulate", "fig9", "--t-end", text)


def test_an_end_in_periods_of_another_model() -> None:
    model = OtherModel(m=1, k=1, Omega=2, FN="1/4", Y=1, joined=True)
    scene = Scene("mine", model, t0=0, x0=0, v0=0, t_end="10T")  # type: ignore[arg-type]
    assert scene.original is not None
    assert float(scene.original.t_end) == 10 * (2 * pi / 2)


@pytest.mark.parametrize("text", ["T", "manyT", "-T", "1e3.5T"])
def test_what_is_no_count_of_periods_is_refused(text: str) -> None:
    message = refusal(lambda: Scene("mine", FIG9.parameters, 0, 0, 0, text))  # type: ignore[arg-type]
    assert "periods of the drive such as '10T'" in message
    assert "symosc[units]" not in message


# --- numbers as one writes them; no extra is needed ---


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2π", 2 * pi), ("2pi", 2 * pi), ("3π/2", 1.5 * pi), ("-π/2", -pi / 2),
        ("0.5π", pi / 2), (".5pi", pi / 2), ("2π + 1", 2 * pi + 1), ("2*3π", 6 * pi),
    ],
)  # fmt: skip
def test_multiples_of_pi(monkeypatch: pytest.MonkeyPatch, text: str, value: float) -> None:
    monkeypatch.setitem(sys.modules, "pint", None)
    result, exact = read_number("phase", text)
    assert float(result) == pytest.approx(value, rel=1e-15)
    assert not exact
    assert read_number("mu1", text)[0] == result  # of no dimension


@pytest.mark.parametrize("text", ["1/2π", "2^3π", "2**3π", "1/ 2pi"])
def test_of_what_pi_is_a_factor_must_be_clear(text: str) -> None:
    assert "such as '3*pi/2'" in refusal(lambda: read_number("phase", text))


def test_percent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pint", None)
    assert read_number("mu1", "80%") == (Fraction(4, 5), True)
    assert read_number("mu2", "2.5 %") == (Fraction(1, 40), True)
    assert FIG9.parameters.replace(mu1="80%").mu1 == Fraction(4, 5)
    assert "k is the stiffness: give it in N/m" in refusal(lambda: read_number("k", "80%"))


def test_phases_too() -> None:
    for text in ("2π/3", "2pi/3"):
        assert float(read_phase("theta", text)) == pytest.approx(2 * pi / 3)


# --- shapes ---


def test_an_axis_with_one_value() -> None:
    pytest.importorskip("xarray")
    dataset = symosc.sweep(FIG9, {"FN": "10:10:1"}, t_end="4T", record="events")
    assert dataset.FN.values.tolist() == [10.0]
    message = refusal(lambda: symosc.sweep(FIG9, {"FN": "10:12:1"}))
    assert (
        message == "FN = '10:12:1': must have 2 or more values to go from a lower to a higher one"
    )
    message = refusal(lambda: symosc.sweep(FIG9, {"FN": "10:12:0"}))
    assert message == "the number of values of FN = 0: must be a whole number >= 1"
    result = run("sweep", "fig9", "--over", "FN=10:12:1", "-o", "-")
    assert result.exit_code == 2
    assert "must have 2 or more values" in result.stderr


def test_columns_of_different_lengths() -> None:
    columns = {"t0": 0, "x0": [1, 2], "v0": [1, 2, 3]}
    message = refusal(lambda: simulate_many(FIG9.parameters, columns, 3))
    expected = "x0 = '2 values': must have 1 or 3 values, since v0 has 3"
    assert message == expected
    starts = [(0, 0, 0)] * 3
    message = refusal(
        lambda: simulate_many(FIG9.parameters, starts, 3, record="summary", skip=[1, 2])
    )
    expected = "skip = '2 values': must have 1 or 3 values, as many as motions"
    assert message == expected


# --- hints ---


def test_a_figure_suggests_its_own_arguments() -> None:
    motion = simulate("fig5", t_end=7)
    for draw in (lambda: motion.plot(panel="b"), lambda: plot.figure("fig5", panel="b")):
        assert refusal(draw).endswith("did you mean panels?")
    assert refusal(lambda: motion.plot(lwidth=1)).endswith("did you mean linewidth?")


def _public() -> list[str]:
    return [
        name
        for name in sorted(symosc.__all__)
        if callable(getattr(symosc, name)) and not isinstance(getattr(symosc, name), type)
    ]


@pytest.mark.parametrize("name", _public())
def test_a_mistyped_keyword_suggests_the_right_one(name: str) -> None:
    """Of each argument one letter is left out, doubled, or changed; never is another one meant."""
    from inspect import Parameter, signature

    parameters = signature(getattr(symosc, name)).parameters.values()
    if any(item.kind is Parameter.VAR_KEYWORD for item in parameters):
        pytest.skip("takes any name")
    names = [item.name for item in parameters]
    for right in names:
        if len(right) < 4:
            continue
        middle = len(right) // 2
        wrong = {right[:-1], f"{right}s", right[:middle] + "q" + right[middle + 1 :]}
        for mistyped in wrong - set(names):
            message = refusal(lambda mistyped=mistyped: getattr(symosc, name)(**{mistyped: 1}))
            assert "did you mean" in message, mistyped
            assert right in message.rpartition("did you mean ")[2].rstrip("?").split(" or ")


def test_no_word_is_meant_that_is_another() -> None:
    assert meant("panel", ["label", "color"]) == ""
    assert meant("panel", ["label", "panels"]) == "; did you mean panels?"
    assert meant("mv1", ["mu1", "mu2", "FN"]) == "; did you mean mu1?"


#: How users may write what belts have beyond the paper's parameters, and what messages call it.
OF_BELTS = {
    "mu_s": "static friction",
    "mu_s1": "static friction",
    "mu_s2": "static friction",
    "mus": "static friction",
    "mu_static": "static friction",
    "curve": "friction that depends on speed",
    "slope": "friction that depends on speed",
    "slope1": "friction that depends on speed",
    "w1_1": "friction that depends on speed",
    "mu1_2": "friction that depends on speed",
    "belts": "another number of belts",
    "v3": "another number of belts",
    "mu3": "another number of belts",
}


@pytest.mark.parametrize("name", OF_BELTS)
def test_numbers_of_belts_are_answered_by_where_they_are_given(name: str) -> None:
    """Not by the name of another number that looks alike, such as mu1 for mu_s1."""
    p = FIG9.parameters
    calls: list[Callable[[], object]] = [
        lambda: symosc.Parameters(**{name: 1}),
        lambda: p.replace(**{name: 1}),
        lambda: FIG9.changed(**{name: 1}),
        lambda: symosc.sensitivities(FIG9, name),
        lambda: symosc.fit(FIG9, [(0.1, "stick")], name),
        lambda: symosc.continue_orbit(p, "P32", name, (0, 2)),
    ]
    for call in calls:
        message = refusal(call)
        assert f"; {OF_BELTS[name]} requires an Oscillator with belts=[Belt(v, " in message
        assert "did you mean" not in message
    assert OF_BELTS[name] in run("simulate", "fig9", "--set", f"{name}=1").stderr
    if name != "belts":
        wall = {"m": 1, "k": 1, "Omega": 1, "FN": 1}
        text = refusal(lambda: symosc.OtherModel(**wall, **{name: 1}))
        assert f"{OF_BELTS[name]} requires belts=[Belt(v, " in text or name in ("v3", "mu3")


@pytest.mark.parametrize("name", ["v1", "mu1", "mu_s1", "v2", "curve", "slope1"])
def test_an_oscillator_says_that_belts_have_these_numbers(name: str) -> None:
    message = refusal(lambda: symosc.Oscillator(m=1, c=0, k=1, belts=[], **{name: 1}))
    assert "belts=[Belt(v, " in message


@pytest.mark.parametrize("key", ["mu_s1", "mu_s", "curve", "slope", "w1_1", "belts"])
def test_a_scene_file_says_where_these_numbers_are_given(key: str, tmp_path: Path) -> None:
    """Where the name of another number is not wrongly taken as meant."""
    path = tmp_path / "mine.toml"
    path.write_text(as_toml(FIG9).replace("mu1 = ", f"{key} = 1\nmu1 = "))
    message = refusal(lambda: load_scene(path))
    assert "tables [[belts]] have v, mu or curve, slope and mu_s of each belt" in message
    assert "did you mean" not in message


@pytest.mark.parametrize(
    ("call", "right"),
    [
        (lambda: symosc.sweep(FIG9, Omega=[3, 4]), "over={'Omega': ...}"),
        (lambda: symosc.return_map(FIG9, n=100), "points"),
        (lambda: simulate(FIG9, T=3), "t_end"),
        (lambda: simulate(FIG9, t_final=3), "t_end"),
        (lambda: simulate(FIG9, y0=[0, 1]), "x0 or v0"),
        (lambda: simulate(FIG9, precision=30), "digits"),
        (lambda: simulate(FIG9, rtol=1e-9), "accuracy"),
        (lambda: simulate_many(FIG9.parameters, [0, 0, 0], 3, n_jobs=2), "workers"),
        (lambda: FIG9.parameters.replace(mass=2), "m"),
        (lambda: FIG9.parameters.replace(frequency=2), "Omega"),
        (lambda: symosc.Belt(0, mu_k=1), "mu"),
        (lambda: symosc.find_orbit(FIG9, structure="P32"), "word"),
        (lambda: symosc.plot.figure(FIG9, size=(3, 2)), "figsize"),
    ],
)
def test_names_of_other_programs_suggest_the_right_one(call: Callable[[], Any], right: str) -> None:
    assert refusal(call).endswith(f"; did you mean {right}?")


# --- messages ---


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda: simulate(FIG9.parameters), "t_end is required when you pass Parameters"),
        (lambda: symosc.sweep(FIG9, {"omega": [1]}), "unknown number; choose from m, c, k"),
        (
            lambda: symosc.sweep(FIG9, {"FN": [1]}, record="words"),
            "unknown column; choose from status, events",
        ),
        (lambda: symosc.sensitivities(FIG9, wrt="mass"), "must be one of m, c, k"),
        (
            lambda: symosc.values_containing(None, "P2", "Omega", ("pi", "5*pi/4")),
            "must be a single phase when the parameters are symbolic",
        ),
        (
            lambda: plot.figure("fig5", panels="ab", ax=_axes()),
            "an Axes holds a single panel; pass one of the letters",
        ),
        (
            lambda: symosc.crosscheck(FIG9, [0, 1, 2], [0, 1]),
            "t, x and v must have the same length",
        ),
        (
            lambda: symosc.continue_orbit(symosc.find_orbit("fig9"), None, "c", (0, 1)),
            "or the name or file of one; give its .parameters",
        ),
        (
            lambda: symosc.continue_orbit(FIG9, symosc.find_orbit("fig9"), "c", (0, 1)),
            "or None; give its .word",
        ),
    ],
)
def test_messages_say_what_is_allowed(call: Callable[[], object], expected: str) -> None:
    assert expected in refusal(call)


def _axes() -> object:
    from matplotlib.figure import Figure

    return Figure().subplots()


def test_messages_of_commands() -> None:
    code = ["codegen", "P2", "--language", "c", "-o", "-"]
    assert "is a reserved word or a library name in c; choose" in run(*code, "--name", "int").stderr
    assert "Mapping P2. Generated by symosc" in good(*code)
    assert "Mapping structure P32: P2, then P3. Generated" in good("codegen", "P32", "-o", "-")
    assert "unknown group; choose from " in refusal(lambda: chosen("x"))
    orbit = good("orbit", "fig9", "--structure", "P32", "--continue", "Omega=3.9:4.1")
    assert "branch of " in orbit
    assert " points over Omega:" in orbit
    assert "differs from the orbit by" in orbit


# --- summaries ---


def test_summaries_of_commands_are_whole() -> None:
    """Click cuts a summary off to fit one line, and marks this by three dots."""
    text = " ".join(good("--help").split()).partition("Commands: ")[2]
    assert "..." not in text
    for name in COMMANDS:
        summary = text.partition(f"{name} ")[2]
        first = " ".join(good(name, "--help").split()).partition("[OPTIONS]")[2]
        end = summary.index(".") + 1
        assert summary[:end] in first, name
