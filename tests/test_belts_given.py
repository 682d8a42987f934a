"""Belts as users give them: plausible mistakes, each answered by one sentence, and scene files."""

from __future__ import annotations

import itertools
import random
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symosc
from symosc import Belt, Oscillator, ParameterError, Scene, SceneError, load_scene
from symosc.scenes import as_toml, load_template, read_scene, template_names

FREE: Any = {"m": 1, "c": 0, "k": 1}
PULLED = Oscillator(**FREE, belts=[Belt("1/5", mu="1/2", mu_s=1)])
FALLING = Belt(1, curve=[(0, "1/2"), ("1/2", "1/4")])
CURVED = Oscillator(**FREE, belts=[FALLING])
FIG9 = load_scene("fig9").parameters

TOO_FAST = Oscillator(
    m=1, c="0.1", k=1, belts=[Belt("1/2", "0.3", mu_s="0.6"), Belt(10**12, "0.1")]
)

#: Columns by name, with belt 1 faster than belt 2.
PASSED: Any = FIG9.numbers() | {"mu_s1": Fraction(2), "v1": Fraction(99)}

MISTAKES: dict[str, tuple[Callable[[], Any], str, str]] = {
    "negative mu": (lambda: Belt(1, mu=-1), "mu", ">= 0"),
    "negative mu_s": (lambda: Belt(1, mu=0, mu_s=-1), "mu_s", ">= 0"),
    "mu_s below mu": (lambda: Belt(1, mu=1, mu_s="1/2"), "mu_s", "at least mu = 1"),
    "no mu": (lambda: Belt(1), "mu", "required"),
    "mu_s alone": (lambda: Belt(1, mu_s=1), "mu", "required"),
    "mu and curve": (lambda: Belt(1, mu=1, curve=[(0, 1)]), "curve", "omitted"),
    "a speed in words": (lambda: Belt("fast", mu=1), "v", "give a number"),
    "nan": (lambda: Belt(float("nan"), mu=1), "v", "finite"),
    "an endless mu_s": (lambda: Belt(1, mu=1, mu_s=float("inf")), "mu_s", "finite"),
    "a list of speeds": (lambda: Belt([1, 2], mu=1), "v", "must be"),
    "equal speeds": (
        lambda: Oscillator(**FREE, belts=[Belt(1, mu=1), Belt("2/2", mu=2)]),
        "belts",
        "belts 1 and 2 both have the speed 1",
    ),
    "no belts": (lambda: Oscillator(**FREE, belts=[]), "belts", "at least one Belt"),
    "too many": (
        lambda: Oscillator(**FREE, belts=[Belt(v, 1) for v in range(51)]),
        "belts",
        "at most 50",
    ),
    "belts are a number": (lambda: Oscillator(**FREE, belts=3), "belts", "Belt"),  # type: ignore[arg-type]
    "numbers for belts": (
        lambda: Oscillator(**FREE, belts=[1, 2]),  # type: ignore[list-item]
        "belts",
        "must be a sequence of Belt objects, such as [Belt(1, mu=0.2)]",
    ),
    "a belt too fast for a section": (
        lambda: symosc.return_map(TOO_FAST),
        "v2",
        "belt 2 is too fast, compared with the other speeds",
    ),
    "a belt too fast for an orbit": (
        lambda: symosc.find_orbit(TOO_FAST.replace(B0=1, Omega=2)),
        "v2",
        "if the mass never reaches it, leave it out",
    ),
    "a dict for a belt": (
        lambda: Oscillator(**FREE, belts=[{"v": 1, "mu": 1}]),  # type: ignore[list-item]
        "belts",
        "Belt",
    ),
    "no Omega with a drive": (
        lambda: Oscillator(**FREE, B0=1, belts=[Belt(1, mu=1)]),
        "Omega",
        "required unless B0 = 0",
    ),
    "a drive for what has no Omega": (lambda: PULLED.replace(B0=1), "Omega", "required"),
    "no mass": (lambda: PULLED.replace(m=0), "m", "> 0"),
    "the second belt of one": (lambda: PULLED.replace(mu_s2=1), "mu_s2", "did you mean mu_s1?"),
    "belt 0": (lambda: PULLED.replace(mu_s0=1), "mu_s0", "unknown"),
    "mu above mu_s": (lambda: PULLED.replace(mu1=2), "mu_s1", "at least mu = 2"),
    "a changed belt in words": (lambda: PULLED.replace(v1="fast"), "v1", "give a number"),
    "belts replaced by a number": (lambda: PULLED.replace(belts=3), "belts", "Belt"),
    "belts that pass each other": (
        lambda: FIG9.oscillator.replace(v1=99),
        "v1",
        f"less than v2 = {FIG9.v2}",
    ),
    "columns that pass each other": (
        lambda: symosc.simulate_many(PASSED, [0, 0, 0], 5),
        "v1",
        "less than v2",
    ),
    "an unknown number of a belt": (lambda: Belt(1, mu=1).replace(speed=2), "speed", "unknown"),
    "a unit of another kind": (lambda: Belt("2 kg", mu=1), "v", "m/s"),
    "periods without Omega": (
        lambda: symosc.simulate(PULLED, t_end="10T"),
        "t_end",
        "require Omega",
    ),
    "many periods without Omega": (
        lambda: symosc.simulate_many(PULLED, [0, 0, 0], "10T"),
        "t_end",
        "require Omega",
    ),
    "sections without Omega": (
        lambda: symosc.simulate_many(PULLED, [0, 0, 0], 9, record="section"),
        "record",
        "require Omega",
    ),
    "a figure's periods without Omega": (
        lambda: symosc.plot.figure(symosc.simulate(PULLED, t_end=9), skip="1T"),
        "t_end",
        "require Omega",
    ),
    "no end": (lambda: symosc.simulate(PULLED), "t_end", "you pass an Oscillator"),
    "the force above two domains": (lambda: PULLED.A(3), "alpha", "from 1 to 2"),
    # -- friction that depends on speed
    "a number for a curve": (
        lambda: Belt(1, curve=0.4),
        "curve",
        "must be points (w, mu), such as",
    ),  # type: ignore[arg-type]
    "text for a curve": (lambda: Belt(1, curve="0, 0.4"), "curve", "must be points"),
    "an empty curve": (lambda: Belt(1, curve=[]), "curve", "must be points"),
    "an empty array": (lambda: Belt(1, curve=np.zeros((0, 2))), "curve", "must be points"),
    "a curve without speeds": (lambda: Belt(1, curve=[0.4, 0.3]), "curve", "must be points"),
    "points of three numbers": (lambda: Belt(1, curve=[(0, 1, 2)]), "curve", "must be points"),
    "a dict for a curve": (lambda: Belt(1, curve={0: 0.4}), "curve", "must be points"),
    "columns for a curve": (
        lambda: Belt(1, curve=([0, 1, 2], [0.4, 0.3, 0.2])),
        "curve",
        "make them of columns by zip(w, mu)",
    ),
    "columns in an array": (
        lambda: Belt(1, curve=np.array([[0, 1, 2], [0.4, 0.3, 0.2]])),
        "curve",
        "zip(w, mu)",
    ),
    "a function for mu": (lambda: Belt(1, mu=abs), "mu", "Belt.from_function"),
    "a function for a curve": (lambda: Belt(1, curve=abs), "curve", "Belt.from_function"),  # type: ignore[arg-type]
    "a curve that begins late": (
        lambda: Belt(1, curve=[(0.1, 0.4), (1, 0.3)]),
        "curve",
        "w of the point (0.1, 0.4) must be 0 at the first point",
    ),
    "both sides of a belt": (
        lambda: Belt(1, curve=[(-1, 0.3), (0, 0.4), (1, 0.3)]),
        "curve",
        "w of the point (-1, 0.3) must be >= 0",
    ),
    "speeds out of order": (
        lambda: Belt(1, curve=[(0, 0.4), (1, 0.3), (0.5, 0.2)]),
        "curve",
        "w of the point (0.5, 0.2) must be greater than 1, that of the point before",
    ),
    "friction that jumps": (
        lambda: Belt(1, curve=np.array([(0, 0.4), (1, 0.3), (1, 0.2)])),
        "curve",
        "w of the point (1.0, 0.2) must be greater than 1",
    ),
    "static friction as a point": (
        lambda: Belt(1, curve=[(0, 0.6), (0, 0.4), (1, 0.3)]),
        "curve",
        "static friction is given by mu_s",
    ),
    "negative friction": (
        lambda: Belt(1, curve=[(0, 0.4), (1, -0.1)]),
        "curve",
        "mu of the point (1, -0.1) must be >= 0",
    ),
    "a coefficient in words": (
        lambda: Belt(1, curve=[(0, 0.4), (1, "less")]),
        "curve",
        "mu of the point (1, 'less'): give a number",
    ),
    "no coefficient": (
        lambda: Belt(1, curve=[(0, 0.4), (1, None)]),
        "curve",
        "mu of the point (1, None) must be a number",
    ),
    "nan in a curve": (
        lambda: Belt(1, curve=np.array([(0, 0.4), (1, np.nan)])),
        "curve",
        "mu of the point (1.0, nan) must be finite",
    ),
    "a masked curve": (
        lambda: Belt(1, curve=np.ma.masked_greater([[0, 0.4], [1, 9.0]], 5)),
        "curve",
        "masked",
    ),
    "a curve without an end": (
        lambda: Belt(1, curve=((w, 1) for w in itertools.count())),
        "curve",
        "at most 10001 points",
    ),
    "a slope below 0": (lambda: Belt(1, curve=[(0, 1)], slope=-1), "slope", "must be >= 0"),
    "a slope below 0 of mu": (lambda: Belt(1, mu=1, slope=-1), "slope", "must be >= 0"),
    "a slope alone": (lambda: Belt(1, slope=1), "mu", "required, or a curve"),
    "a slope in words": (lambda: Belt(1, mu=1, slope="up"), "slope", "give a number"),
    "mu_s below a curve": (
        lambda: Belt(1, curve=[(0, 0.4), (1, 0.2)], mu_s=0.3),
        "mu_s",
        "must be at least mu = 0.4 of the curve at w = 0, or be omitted",
    ),
    "mu with a new curve": (
        lambda: Belt(1, mu=1).replace(mu=2, curve=[(0, 1)]),
        "curve",
        "omitted",
    ),
    "a negative mu of a curve": (lambda: FALLING.replace(mu=-1), "mu", "must be >= 0"),
    "a curve in words": (lambda: FALLING.replace(curve="less"), "curve", "must be points"),
    "edges that nearly coincide": (
        lambda: Oscillator(**FREE, belts=[FALLING, Belt("1.5000000001", mu=1)]),
        "belts",
        "a corner at 1.5 and belt 2 are 1e-10 apart, less than 1e-9 of the largest speed",
    ),
    "a narrow piece": (
        lambda: Oscillator(**FREE, belts=[Belt(9, curve=[(0, 1), ("1e-9", 0), (1, 1)])]),
        "belts",
        "a corner at 8.999999999 and belt 1 are 1e-09 apart",
    ),
    "a point that is not there": (lambda: CURVED.replace(mu1_2=1), "mu1_2", "did you mean mu1_1"),
    "a point of a belt without a curve": (lambda: PULLED.replace(w1_1=1), "w1_1", "unknown"),
    "a negative point": (lambda: CURVED.replace(mu1_1=-1), "mu1_1", "must be >= 0"),
    "a point at the belt": (lambda: CURVED.replace(w1_1=0), "w1_1", "must be greater than 0"),
    "a point in words": (lambda: CURVED.replace(w1_1="far"), "w1_1", "give a number"),
    "a negative slope1": (lambda: CURVED.replace(slope1=-1), "slope1", "must be >= 0"),
    "the paper's law of a curve": (
        lambda: CURVED.parameters,
        "belts",
        "friction of belt 1 that depends on speed (its curve or slope) cannot be followed here",
    ),
    "one force of a curve": (lambda: CURVED.A(1), "alpha", "the friction depends on the speed"),
    # -- a function for a curve
    "a number for a function": (
        lambda: Belt.from_function(1, 0.4, 2),  # type: ignore[arg-type]
        "mu",
        "must be a function of one number",
    ),
    "a function of two numbers": (
        lambda: Belt.from_function(1, lambda v, w: 1, 2),  # type: ignore[arg-type,misc]
        "mu",
        "must be a function of one number",
    ),
    "a function that fails": (
        lambda: Belt.from_function(1, lambda w: 1 / w, 2),
        "mu",
        "fails at w = 0 with ZeroDivisionError: ",
    ),
    "a function that is negative": (
        lambda: Belt.from_function(1, lambda w: 1 - w, 2, pieces=2),
        "mu",
        "its value -1.0 at w = 2 must be >= 0",
    ),
    "a function of nothing": (
        lambda: Belt.from_function(1, lambda w: None, 2),
        "mu",
        "its value None at w = 0 must be a number",
    ),
    "a function with a pole": (
        lambda: Belt.from_function(1, lambda w: np.inf if w == 0.5 else 1, 2),
        "mu",
        "its value inf at w = 0.5 must be finite",
    ),
    "no range": (lambda: Belt.from_function(1, abs, 0), "until", "must be > 0"),
    "a range in words": (lambda: Belt.from_function(1, abs, "far"), "until", "give a number"),
    "no pieces": (lambda: Belt.from_function(1, abs, 1, pieces=0), "pieces", "from 1 to 10000"),
    "half a piece": (lambda: Belt.from_function(1, abs, 1, pieces=2.5), "pieces", "whole number"),  # type: ignore[arg-type]
    "static below a function": (
        lambda: Belt.from_function(1, lambda w: 1, 1, mu_s=0.5),
        "mu_s",
        "at least mu = 1",
    ),
    "static friction of Parameters": (lambda: FIG9.replace(mu_s1=1), "mu_s1", "unknown"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_with_belts_is_answered_by_one_sentence(mistake: str) -> None:
    call, name, said = MISTAKES[mistake]
    with pytest.raises(ParameterError) as caught:
        call()
    assert caught.value.name == name
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


# -- scene files

TEXT = """\
t_end = 9
[parameters]
m = 1
c = 0
k = 1
[[belts]]
v = 2
mu = 0.5
[[belts]]
v = "2.5 cm/s"
mu = 0.5
mu_s = 1
[start]
t0 = 0
x0 = 0
v0 = 0
"""

WRONG_FILES = {
    "v1 as well": (("k = 1", "k = 1\nv1 = 2"), "line 6, [parameters]: parameters.v1 and [[belts]]"),
    "an unknown key": (("mu_s = 1", "mus = 1"), "line 12, table 2 of [[belts]]: belts.mus is unkn"),
    "no mu": (("mu = 0.5\n[start", "[start"), None),
    "no speed": (("v = 2\n", ""), "belts.v is missing; it begins in line 6"),
    "no belt in a table": (("[[belts]]\nv = 2\nmu = 0.5\n", "belts = 3\n"), None),
    "mu_s below mu": (("mu_s = 1", "mu_s = 0.1"), "(scene mine.toml, line 12, table 2 of [[belts]])"),
    "negative": (("mu = 0.5\n[[", "mu = -1\n[["), "line 8, table 1 of [[belts]]"),
    "in words": (("v = 2\n", 'v = "fast"\n'), "line 7, table 1 of [[belts]]"),
    "a late curve": (("mu = 0.5\n[[", "curve = [[1, 1]]\n[["), "must be 0 at the first point (mine.toml, line 8, "),
    "decimals in a curve": (
        ("mu = 0.5\n[[", "curve = [[0, 0.5], [0, 0.3]]\n[["),
        "curve = [[0, 0.5], [0, 0.3]]: w of the point (0, 0.3)",
    ),
    "a negative point": (
        ("mu = 0.5\n[[", "curve = [\n  [0, 1],\n  [1, -1],\n]\n[["),
        "mu of the point (1, -1) must be >= 0 (mine.toml, line 11, table 1 of [[belts]])",
    ),
    "a point in words": (
        ("mu = 0.5\n[[", 'curve = [[0, 1], ["far", 1]]\n[['),
        "w of the point ('far', 1): give a number",
    ),
    "a point in other units": (
        ("mu = 0.5\n[[", 'curve = [[0, 1], ["1 kg", 1]]\n[['),
        "w is the relative speed of a belt: give it in m/s",
    ),
    "a curve in a table": (("mu = 0.5\n[[", "curve = {w = 0, mu = 1}\n[["), "must be points"),
    "a slope below 0": (("mu = 0.5\n[[", "mu = 1\nslope = -1\n[["), "slope = '-1': must be >= 0 (mine"),
    "mu_s below a curve": (("mu = 0.5\nmu_s = 1", "curve = [[0, 2]]\nmu_s = 1"), "mu_s = '1': must be at least mu = 2"),
    "a curve in parameters": (("k = 1", "k = 1\nslope1 = 2"), "tables [[belts]] have v, mu or curve"),
    "mu and a curve": (("mu = 0.5\n[[", "mu = 1\ncurve = [[0, 1]]\n[["), "curve"),
    "equal speeds": (('v = "2.5 cm/s"', "v = 2"), "both have the speed 2"),
    "a drive without Omega": (("k = 1", "k = 1\nB0 = 1"), "Omega is required unless B0 = 0"),
    "no damping": (("c = 0\n", ""), "parameters.c is missing"),
    "a model": (("[start]", "[model]\nv = 1\n[start]"), "Omega is missing"),
    "static friction in parameters": (("k = 1", "k = 1\nmu_s1 = 2"), "tables [[belts]] have v, mu or curve"),
}  # fmt: skip


def test_a_file_of_belts_has_units() -> None:
    pytest.importorskip("pint")
    scene = read_scene(TEXT, "mine.toml")
    slow, fast = scene.parameters.belts  # type: ignore[attr-defined]
    assert slow == Belt("1/40", mu="1/2", mu_s=1)
    assert fast == Belt(2, mu="1/2")
    assert not scene.parameters.has_periods


@pytest.mark.parametrize("wrong", WRONG_FILES)
def test_a_wrong_file_of_belts_is_refused_with_its_place(wrong: str) -> None:
    (old, new), said = WRONG_FILES[wrong]
    text = TEXT.replace('"2.5 cm/s"', "1").replace(old, new, 1)
    if wrong == "equal speeds":
        text = TEXT.replace(old, new)
    if wrong == "no mu":
        text = TEXT.replace('"2.5 cm/s"', "1").replace("mu = 0.5\nmu_s = 1", "mu_s = 1")
        said = "table 2 of [[belts]]"
    if wrong == "no belt in a table":
        text = "belts = 3\n" + TEXT.partition("[[")[0] + "[start]" + TEXT.partition("[start]")[2]
        said = "line 1: belts must be tables"
    with pytest.raises((SceneError, ParameterError)) as caught:
        read_scene(text, "mine.toml")
    assert said is not None
    assert said.removeprefix("(scene ").rstrip(")") in str(caught.value)
    assert str(caught.value).count("mine.toml") == 1
    assert "\n" not in str(caught.value)


def test_a_file_of_a_curve() -> None:
    pytest.importorskip("pint")
    text = TEXT.replace("mu = 0.5\n[[", 'curve = [[0, "2/5"], ["pi/10", 0.25]]\nslope = 0.1\n[[')
    text = text.replace("mu = 0.5\nmu_s", 'curve = [[0, 0.4], ["50 cm/s", 0.25]]\nmu_s')
    scene = read_scene(text, "mine.toml")
    slow, fast = scene.parameters.belts  # type: ignore[attr-defined]
    assert slow == Belt("1/40", curve=[(0, "2/5"), ("1/2", "1/4")], mu_s=1)
    assert (fast.v, fast.slope, fast.curve[0]) == (2, Fraction(1, 10), (0, Fraction(2, 5)))
    assert abs(float(fast.curve[1][0]) - np.pi / 10) < 1e-15
    assert scene.notes == ("w = pi/10: read to 40 digits, 0.3141592653589793238462…",)


@pytest.mark.parametrize("seed", range(40))
def test_a_written_scene_of_belts_is_the_scene(seed: int) -> None:
    dice = random.Random(seed)

    def number(low: int = 0) -> Fraction:
        return Fraction(dice.randint(low, 99), dice.choice([1, 7, 10]))

    belts = []
    for speed in dice.sample(range(-9, 9), dice.choice([1, 2])):
        mu = number()
        friction: Any = {"mu": mu}
        if dice.random() < 0.5:
            ends = itertools.accumulate(number(1) for _ in range(dice.choice([1, 3, 4, 70])))
            friction = {"curve": [(0, mu), *((w, number()) for w in ends)]}
        friction |= dice.choice([{}, {"slope": number()}])
        belts.append(Belt(speed, **friction, mu_s=dice.choice([None, mu, mu + number()])))
    drive: Any = dice.choice([{}, {"Omega": number(1)}, {"B0": number(), "Omega": number(1)}])
    oscillator: Any = Oscillator(
        m=number(1), c=number(), k=number(), FN=number(), belts=belts, **drive
    )
    start: Any = {"t0": number(), "x0": number(-99), "v0": number(-99), "t_end": 999}
    scene = Scene("mine", oscillator, **start, source="a draw")
    for explained in (False, True):
        read = read_scene(as_toml(scene, explained), "mine.toml")
        assert read == scene
        assert read.parameters.has_periods == bool(drive)


def test_templates_are_motions_that_stick_and_slip(tmp_path: Path) -> None:
    assert template_names() == ["stick-slip", "stribeck"]
    assert not set(template_names()) & set(symosc.scene_names())
    scene = load_template("stick-slip")
    assert [event.kind for event in symosc.simulate(scene).events[:2]] == ["slip", "stick"]
    path = tmp_path / "mine.toml"
    path.write_text(as_toml(scene, explained=True), encoding="utf-8")
    for read in (scene, load_scene(path)):
        oscillator: Any = read.parameters
        assert oscillator == PULLED


# -- sweeps


def test_a_sweep_of_static_friction_has_the_motions_of_simulate() -> None:
    coefficients = [0.5, 0.75, 1.0]
    swept = symosc.sweep(PULLED, {"mu_s1": coefficients, "x0": [0, 1]}, t_end=30)
    for mu_s in coefficients:
        for x0 in (0, 1):
            motion = symosc.simulate(PULLED.replace(mu_s1=mu_s), x0=x0, t_end=30)
            many = symosc.simulate_many(motion.parameters, [0, x0, 0], 30, record="word").word
            assert swept.word.sel(mu_s1=mu_s, x0=x0).item() == many[0]
    assert swept.mu_s1.attrs["units"] == "1"
    assert "Oscillator(" in swept.symosc.call


def test_parameters_are_swept_over_static_friction() -> None:
    swept = symosc.sweep(FIG9, {"mu_s1": [1.0, 3.0], "mu_s2": [1.0]}, t_end="4T", record="events")
    own = [FIG9.oscillator.replace(mu_s1=mu_s, mu_s2=1) for mu_s in (1, 3)]
    events = [len(symosc.simulate(p, t_end="4T").events) for p in own]
    assert swept.events.values.ravel().tolist() == events


@pytest.mark.parametrize(
    ("over", "said"),
    [
        ({"mu_s1": [0.4, 1]}, "mu_s1 = '0.4': must be at least mu = 0.5"),
        ({"mu1": [0.4, 1.5]}, "must be at least mu = 1.5"),
        ({"mu1": [0.1, 0.6], "mu_s1": [0.5, 1]}, "must be at least mu = 0.6"),
        ([{"mu1": 0.1, "mu_s1": 0.2}, {"mu1": 0.3, "mu_s1": 0.2}], "must be at least mu = 0.3"),
        ({"mu1": [-1, 0]}, "mu1 = '-1': must be >= 0"),
        ({"mu_s2": [1]}, "did you mean mu_s1?"),
        ({"Omega": [1]}, "unknown number"),
        ({"B0": [1]}, "Omega is required"),
    ],
)
def test_swept_belts_are_checked_before_a_motion_is_followed(over: Any, said: str) -> None:
    with pytest.raises(ParameterError) as caught:
        symosc.sweep(PULLED, over, t_end=9)
    assert said in str(caught.value)


# -- notebooks and figures


def test_notebooks_show_belts_and_oscillators() -> None:
    assert Belt("1/5", mu="1/2", mu_s=1)._repr_latex_() == r"$v = 0.2,\; \mu = 0.5,\; \mu_s = 1$"
    assert Belt("1/5", mu="1/2")._repr_latex_() == r"$v = 0.2,\; \mu = 0.5$"
    latex = PULLED._repr_latex_()
    assert r"v_1 = 0.2,\; \mu_1 = 0.5,\; \mu_{s,1} = 1" in latex
    assert "Omega" not in latex
    assert r"\mu_{s,1}" not in FIG9.oscillator._repr_latex_()
    page = load_template("stick-slip")._repr_html_() or ""
    assert "static coefficient of belt 1" in page
    assert "v2" not in page


def test_a_figure_shows_one_belt_and_what_static_friction_adds() -> None:
    motion = symosc.simulate(PULLED, v0="1/5", t_end=20)
    drawing = symosc.plot.figure(motion, panels="bdg")
    velocities, forces, product = drawing.axes
    assert [text.get_text() for text in velocities.texts] == ["$v_1$"]
    assert forces.get_ylabel() == "forces per mass $F^{(1)}$, $F^{(2)}$"
    assert product.get_ylabel() == r"product $(F^{(1)} + E)\, (F^{(2)} - E)$"
    (legend,) = drawing.legends
    assert "static friction" in [text.get_text() for text in legend.get_texts()]
    # The stick from 0 ends at t = 5, where F^(1) + E falls to 0; a band is drawn on each side.
    bands = [band for band in forces.collections if band.get_label() == "static friction"]
    vertices = [np.array(band.get_paths()[0].vertices) for band in bands]
    ends = [edge[abs(edge[:, 0] - 5) < 1e-9, 1].max() for edge in vertices if edge[0, 0] < 1]
    assert min(map(abs, ends)) < 1e-9
    plain = symosc.plot.figure(symosc.simulate(PULLED.replace(mu_s1="1/2"), t_end=20), panels="dg")
    labels = [text.get_text() for text in plain.legends[0].get_texts()]
    assert "static friction" not in labels
    assert plain.axes[1].get_ylabel() == r"product $F^{(1)}\, F^{(2)}$"
    with pytest.raises(ParameterError, match="boundary"):
        symosc.plot.figure(motion, boundary=2)
