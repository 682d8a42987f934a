"""Scene files: what is wrong is said with its line, its table and what is allowed; expressions and units are read."""

from __future__ import annotations

import random
import re
from fractions import Fraction
from pathlib import Path

import pytest

from symosc import Scene, SymoscError, load_scene, scene_names, simulate
from symosc.scenes.reading import half_unit
from symosc.scenes.writing import as_toml

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
    return 1 + TEXT.splitlines().index(next(each for each in TEXT.splitlines() if each.startswith(f"{name} = ")))


@pytest.mark.parametrize("name", scene_names())
def test_a_commented_scene_is_the_scene(name: str, tmp_path: Path) -> None:
    file = tmp_path / "copy.toml"
    for explained in (True, False):
        file.write_text(as_toml(load_scene(name), explained), encoding="utf-8")
        assert load_scene(file) == load_scene(name)


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        ("m", "-1", "must be > 0"),
        ("k", '"x"', "give a number"),
        ("mu1", "true", "must be a number"),
        ("v1", "30", "less than v2 = 25"),
        ("t0", "[1]", "give an int"),
        ("t_end", '"pi - pi"', "40 digits"),
        ("x0", '"1/0"', "denominator must not be 0"),
        ("structure", '"P99"', "P99"),
        ("name", "5", "name must be text"),
    ],
)
def test_what_is_wrong_has_its_line_and_table(name: str, value: str, allowed: str, tmp_path: Path) -> None:
    with pytest.raises(SymoscError) as caught:
        scene(tmp_path, **{name: value})
    message = str(caught.value)
    assert f"line {line(name)}" in message
    assert allowed in message
    assert "\n" not in message
    if name in ("m", "k", "mu1", "v1"):
        assert f"line {line(name)}, [parameters]" in message


def test_keys_that_are_wrong(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    cases = {
        "Omega = ": (
            "omega = ",
            f"line {line('Omega')}, [parameters]: parameters.omega is unknown; did you mean Omega?",
        ),
        "x0 = ": ("# x0 = ", f"start.x0 is missing; [start] begins in line {1 + TEXT.splitlines().index('[start]')}"),
        "[start]": ("[starts]", "starts is unknown; did you mean start?"),
    }
    for old, (new, message) in cases.items():
        file.write_text(TEXT.replace(f"\n{old}", f"\n{new}"), encoding="utf-8")
        with pytest.raises(SymoscError, match=re.escape(message)):
            load_scene(file)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a." * 20_000 + "a = 1", "line 1: has more than 200 dots"),
        ("[start]\n['" + "'.'".join("a" * 500) + "']", "line 2: has more than 200 dots"),
        ("#" * 200_000, "has more than 100000 characters"),
        ("x = " + "[" * 50_000, "nested too deeply"),
        ("t_end = 1e" + "9" * 30, "is not valid TOML"),
        ("k" * 90_000 + " = 1", "is unknown"),
    ],
    ids=lambda text: text[:12],
)
def test_hostile_files_are_refused_in_a_line_before_they_cost_much(text: str, message: str, tmp_path: Path) -> None:
    """The first one took twelve seconds and 1.5 GB."""
    file = tmp_path / "mine.toml"
    file.write_text(text)
    with pytest.raises(SymoscError) as caught:
        load_scene(file)
    assert message in str(caught.value)
    assert len(str(caught.value)) < 400 + len(str(file))


def test_a_file_without_an_end_is_refused(tmp_path: Path) -> None:
    if not Path("/dev/zero").exists():
        pytest.skip("no /dev/zero")
    (tmp_path / "mine.toml").symlink_to("/dev/zero")
    with pytest.raises(SymoscError, match="has more than 100000 characters"):
        load_scene(tmp_path / "mine.toml")


def test_expressions_are_noted_and_their_starts_have_an_error(tmp_path: Path) -> None:
    found = scene(tmp_path, x0='"pi/6"', Omega='"2*pi"', t0='"1/3 + 1/3"')
    assert found.t0 == Fraction(2, 3)
    assert abs(found.x0 - PI / 6) < Fraction(1, 10**39)
    assert abs(found.parameters.Omega - 2 * PI) < Fraction(1, 10**38)
    assert found.start_error == (0, half_unit(found.x0), 0)
    assert [note.partition(":")[0] for note in found.notes] == ["x0 = pi/6", "Omega = 2*pi"] or len(found.notes) == 2
    assert "40 digits, 0.5235987755982988730771" in " ".join(found.notes)
    assert scene(tmp_path, x0='"pi/6"').notes != load_scene("fig9").notes == ()
    assert scene(tmp_path, x0="0.5").start_error is None
    plain = simulate(found.parameters, t0="2/3", x0=float(PI / 6), v0=1, t_end=3)
    assert simulate(found, t_end=3).word == plain.word


def test_a_start_on_a_belt_stays_on_it(tmp_path: Path) -> None:
    found = scene(tmp_path, v1='"pi"', v0='"pi"', FN="500")
    assert found.v0 == found.parameters.v1
    assert found.start_error == (0, 0, 0)
    assert simulate(found, t_end=1).segments[0].mode == "belt1"


@pytest.mark.parametrize("seed", range(20))
def test_half_a_unit_of_the_last_digit(seed: int) -> None:
    rng = random.Random(seed)
    digits = rng.randint(10**39, 10**40 - 1)
    value = Fraction(digits) * Fraction(10) ** rng.randint(-60, 20)
    unit = value / digits
    assert unit / 2 <= half_unit(value) <= 10 * unit
    assert half_unit(-value) == half_unit(value)


def test_units_and_expressions_agree(tmp_path: Path) -> None:
    pytest.importorskip("pint")
    assert scene(tmp_path, Omega='"60 rpm"').parameters == scene(tmp_path, Omega='"2*pi"').parameters
    assert scene(tmp_path, m='"100 g"', x0='"454.47 cm"') == scene(tmp_path)
