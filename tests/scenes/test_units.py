"""Quantities in scene files: the number that they are in kg, m, s, N and rad, or one line that says what is wanted."""

from __future__ import annotations

import sys
from fractions import Fraction

import pytest
from bad_values import refused

from symosc import MissingExtraError
from symosc.scenes import units
from symosc.scenes.quantities import QUANTITIES, UNITS, unit_of
from symosc.scenes.units import is_quantity, read_quantity

PI = Fraction("3.1415926535897932384626433832795028841971693993751")


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
        ("Omega", "4 1/s", "4"),
        ("Omega", "4 rad/s", "4"),
    ],
)
def test_units_are_converted_exactly(name: str, text: str, value: str) -> None:
    pytest.importorskip("pint")
    assert is_quantity(text) or text == "4 1/s"
    if is_quantity(text):
        assert read_quantity(name, text) == (Fraction(value), True)


@pytest.mark.parametrize(("text", "turns"), [("60 rpm", 1), ("2 turn/s", 2), ("90 deg/s", Fraction(1, 4))])
def test_turns_are_known_as_well_as_pi(text: str, turns: Fraction) -> None:
    pytest.importorskip("pint")
    value, exact = read_quantity("Omega", text)
    assert not exact
    assert abs(value - 2 * PI * turns) < Fraction(1, 10**45)


@pytest.mark.parametrize("name", QUANTITIES)
def test_every_quantity_has_its_unit_and_no_other(name: str) -> None:
    pytest.importorskip("pint")
    right, others = unit_of(name), set(UNITS.values()) - {"1", unit_of(name)}
    for unit in others:
        message = refused(lambda unit=unit: read_quantity(name, f"3 {unit}"), name)  # type: ignore[misc]
        assert (right if right != "1" else "without a unit") in message
    if right != "1":
        assert read_quantity(name, f"3 {right}") == (3, True)


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
def test_what_is_refused(text: str) -> None:
    pytest.importorskip("pint")
    message = refused(lambda: read_quantity("Omega", text), "Omega")
    assert ("turn/s" in message) == ("Hz" in text)


def test_without_pint_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    units._registry.cache_clear()
    monkeypatch.setitem(sys.modules, "pint", None)
    with pytest.raises(MissingExtraError, match=r"symosc\[units\]"):
        read_quantity("m", "3 kg")
