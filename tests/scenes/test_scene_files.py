"""Scene files: what is wrong is said with its line and table; expressions and units are read.

What is written reads.
"""

from __future__ import annotations

import random
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import pytest
from bad_values import refused
from effort import at_most

from symosc import ParameterError, Scene, SymoscError, load_scene, scene_names, simulate
from symosc.base.exact import read_exact
from symosc.base.quantities import (
    KNOWN_DIGITS,
    half_unit,
    is_quantity,
    read_expression,
    read_quantity,
)
from symosc.scenes import as_toml
from symosc.scenes.files import line_of

TEXT = as_toml(load_scene("fig9"), explained=True) + "\n"
PI = Fraction("3.1415926535897932384626433832795028841971693993751")


def scene(tmp_path: Path, **numbers: str) -> Scene:
    text = TEXT
    for name, value in numbers.items():
        text = re.sub(rf"^{name} = .*", f"{name} = {value}", text, flags=re.M)
    file = tmp_path / "mine.toml"
    file.write_text(text, encoding="utf-8")
    return load_scene(file)


def line(name: str) -> int:
    return 1 + TEXT.splitlines().index(
        next(item for item in TEXT.splitlines() if item.startswith(f"{name} = "))
    )


@pytest.mark.parametrize("name", scene_names())
def test_a_commented_scene_is_the_scene(name: str, tmp_path: Path) -> None:
    file = tmp_path / "copy.toml"
    for explained in (True, False):
        file.write_text(as_toml(load_scene(name), explained), encoding="utf-8")
        assert load_scene(file) == load_scene(name)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a." * 20_000 + "a = 1", "line 1: a line has at most 200 dots"),
        ("[start]\n['" + "'.'".join("a" * 500) + "']", "line 2: a line has at most 200 dots"),
        ("#" * 200_000, "a scene has at most 100000 characters"),
        ("x = " + "[" * 50_000, "nested too deeply"),
        ("t_end = 1e" + "9" * 30, "is not valid TOML"),
        ("k" * 90_000 + " = 1", "is unknown"),
    ],
    ids=lambda text: text[:12],
)
def test_hostile_files_are_refused_in_a_line_before_they_cost_much(
    text: str, message: str, tmp_path: Path
) -> None:
    """The first one took twelve seconds and 1.5 GB."""
    file = tmp_path / "mine.toml"
    file.write_text(text)
    with pytest.raises(SymoscError) as caught:
        load_scene(file)
    assert message in str(caught.value)
    assert len(str(caught.value)) < 400 + len(str(file))


@pytest.mark.parametrize(
    ("name", "allowed"),
    [("", "text that is not empty"), (" ", "text that is not empty"), (3, "text")],
)
def test_a_scene_has_a_name(name: Any, allowed: str) -> None:
    with pytest.raises(ParameterError, match=rf"^name = .*: must be {allowed}$"):
        Scene(name, load_scene("fig5").parameters, 0, 0, 0, 5)


def test_expressions_are_noted_and_their_starts_have_an_error(tmp_path: Path) -> None:
    scene_read = scene(tmp_path, x0='"pi/6"', Omega='"2*pi"', t0='"1/3 + 1/3"')
    assert scene_read.t0 == Fraction(2, 3)
    assert abs(scene_read.x0 - PI / 6) < Fraction(1, 10**39)
    assert abs(scene_read.parameters.Omega - 2 * PI) < Fraction(1, 10**38)
    assert scene_read.start_error == (0, half_unit(scene_read.x0), 0)
    assert [note.partition(":")[0] for note in scene_read.notes] == [
        "x0 = pi/6",
        "Omega = 2*pi",
    ] or len(scene_read.notes) == 2
    assert "40 digits, 0.5235987755982988730771" in " ".join(scene_read.notes)
    assert scene(tmp_path, x0='"pi/6"').notes != load_scene("fig9").notes == ()
    assert scene(tmp_path, x0="0.5").start_error is None
    plain = simulate(scene_read.parameters, t0="2/3", x0=float(PI / 6), v0=1, t_end=3)
    assert simulate(scene_read, t_end=3).word == plain.word


def test_a_start_on_a_belt_stays_on_it(tmp_path: Path) -> None:
    scene_read = scene(tmp_path, v1='"pi"', v0='"pi"', FN="500")
    assert scene_read.v0 == scene_read.parameters.v1
    assert scene_read.start_error is None
    assert simulate(scene_read, t_end=1).segments[0].mode == "belt1"


# --- lines ---


@pytest.mark.parametrize("seed", range(10))
def test_lines_of_random_files(seed: int) -> None:
    rng = random.Random(seed)
    lines = []
    places = {}
    for table in rng.sample(["a", "b", "c"], 3):
        lines += [*rng.choices(["", "# a = 1", "   "], k=rng.randint(0, 3)), f"[{table}]"]
        for key in rng.sample("mckxyz", 4):
            lines += rng.choices(["", "# k = 1"], k=rng.randint(0, 2))
            lines.append(f"{key} = {rng.choice(['1', '[1,' + chr(10) + '2]', '{q = 1}'])}")
            places[table, key] = len("\n".join(lines).split("\n"))
    for path, line in places.items():
        assert line_of("\n".join(lines), path) == line
    assert line_of("b = 1\n" + "# much\n" * 5000 + "a = 1", ("a",)) is None


# --- expressions ---


def written(rng: random.Random, depth: int) -> str:
    """Return a random expression that is defined."""
    if depth == 0:
        return rng.choice(
            [
                "pi",
                "π",
                str(rng.randint(1, 99)),
                f"{rng.randint(0, 9)}.{rng.randint(1, 999)}",
                "2e-3",
            ]
        )
    kind = rng.randrange(7)
    one = written(rng, depth - 1)
    if kind < 4:
        return f"({one} {'+-*/'[kind]} ({written(rng, depth - 1)} + 7/3))"
    return [f"sqrt(({one})^2)", f"cos({one})", f"-({one})**{rng.randint(1, 3)}"][kind - 4]


@pytest.mark.parametrize("seed", range(30))
def test_digits_are_those_of_mpmath(seed: int) -> None:
    rng = random.Random(seed)
    text = written(rng, rng.randint(1, 3))
    value, exact = read_expression("x0", text)
    names = {"pi": mpmath.pi, "π": mpmath.pi, "sqrt": mpmath.sqrt, "cos": mpmath.cos}
    with mpmath.workdps(120):
        # Numbers become mpmath's, so that none is rounded to a double.
        source = "".join(
            f"mpf('{part}')" if part[0] in "0123456789" else part for part in pieces(text)
        )
        right = eval(source.replace("^", "**"), names | {"mpf": mpmath.mpf})
        error = abs(mpmath.mpf(value.numerator) / value.denominator - right)
        assert error <= abs(right) * mpmath.mpf(10) ** (1 - KNOWN_DIGITS) / 2, text
    if not exact:
        assert value == read_exact("x0", str(value))
        assert len(str(value.numerator).rstrip("0")) <= KNOWN_DIGITS + 20


def pieces(text: str) -> list[str]:
    """Return an expression cut at its numbers.

    The exponents of powers stay whole numbers of Python.
    """
    parts = re.findall(r"(?:\*\*|\^)\d+|\d+\.?\d*(?:e-?\d+)?|[^\d]+?(?=\d|$)|\D", text)
    return [part for part in parts if part]


@pytest.mark.parametrize(
    "text",
    [
        "", "pi pi", "pi(2)", "e", "x", "open(1)", "pi.real", "[pi]", "pi if 1 else 2", "sqrt(2, 3)", "sqrt()",
        "sqrt(-1)", "1/0", "1/(pi - pi)", "sin(pi)", "pi*pi - pi*pi", "pi^pi", "2^0.5", "2^101", "9^99^99", "1_000",
        "pi\n;1", "1 // 2", "7 % 2", "sqrt(x=1)", "exp(1e9)", "pi**100**100", "ｐｉ", "２*pi", "0x10*pi", "1j*pi",
        "'pi'", "pi" * 101,
        "(" * 190 + "pi", "((((((10^100)^100)^100)^100)^100)^100)", "sin((((pi^100)^100)^100)^100)", "0^-1",
        "1e99999*pi",
    ],
)  # fmt: skip
def test_what_is_refused_is_refused_at_once(text: str) -> None:
    with at_most(10_000):
        refused(lambda: read_expression("x0", text), "x0")


@pytest.mark.parametrize("seed", range(20))
def test_half_a_unit_of_the_last_digit(seed: int) -> None:
    rng = random.Random(seed)
    digits = rng.randint(10**39, 10**40 - 1)
    value = Fraction(digits) * Fraction(10) ** rng.randint(-60, 20)
    unit = value / digits
    assert unit / 2 <= half_unit(value) <= 10 * unit
    assert half_unit(-value) == half_unit(value)


# --- units ---


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("m", "500 g", "1/2"),
        ("m", "1/3 kg", "1/3"),
        ("c", "3 N*s/m", "3"),
        ("c", "3 N s / m", "3"),
        ("k", "2.5e-1 kN/m", "250"),
        ("FN", "1 lbf", "8896443230521/2000000000000"),
        ("v1", "-36 km/hour", "-10"),
        ("v1", "5 mm s^-1", "1/200"),
        ("t0", "2 min", "120"),
        ("mu1", "30 %", "3/10"),
        ("Omega", "4 rad/s", "4"),
    ],
)
def test_units_are_converted_exactly(name: str, text: str, value: str) -> None:
    pytest.importorskip("pint")
    assert is_quantity(text)
    assert read_quantity(name, text) == (Fraction(value), True)


@pytest.mark.parametrize(
    ("text", "turns"), [("60 rpm", 1), ("2 turn/s", 2), ("90 deg/s", Fraction(1, 4))]
)
def test_turns_are_known_as_well_as_pi(text: str, turns: Fraction) -> None:
    pytest.importorskip("pint")
    value, exact = read_quantity("Omega", text)
    assert not exact
    assert abs(value - 2 * PI * turns) < Fraction(1, 10**38)


@pytest.mark.parametrize(
    "text",
    [
        "2 Hz",
        "2 kHz",
        "3 foo",
        "3 kg**9",
        "3 degC",
        "3 rad/s/",
        "1 __import__",
        "3 pi",
        "1 " + "m" * 60,
        "3 m^999999",
    ],
)
def test_units_that_are_refused(text: str) -> None:
    pytest.importorskip("pint")
    message = refused(lambda: read_quantity("Omega", text), "Omega")
    assert ("turn/s" in message) == ("Hz" in text)
