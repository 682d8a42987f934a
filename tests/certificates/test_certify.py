"""What `certify` takes, and what it hands over."""

from __future__ import annotations

import ast
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import symosc
from symosc import ParameterError, SceneError, certify, load_scene
from symosc.certificates.verify import verify


@pytest.mark.parametrize("what", [None, 1, b"fig5", ["fig5"]])
def test_what_is_no_scene(what: Any) -> None:
    with pytest.raises(ParameterError, match=r"^what = .*must be a Scene"):
        certify(what)


def test_bad_numbers_are_named() -> None:
    with pytest.raises(SceneError):
        certify("fig55")
    with pytest.raises(ParameterError, match="t_end"):
        certify("fig5", t_end=-1)
    with pytest.raises(ParameterError, match="t_end"):
        certify("fig5", t_end="nan")
    with pytest.raises(ParameterError, match="start_error"):
        certify("fig5", start_error=-1)


def test_the_file_is_exact_input_and_decimals(tmp_path: Path) -> None:
    path = tmp_path / "fig6.json"
    certificate = certify("fig6")
    certificate.to_json(path)
    document = json.loads(path.read_text(encoding="utf-8"))
    assert document == certificate.as_dict()
    scene = load_scene("fig6")
    assert {name: Fraction(value) for name, value in document["parameters"].items()} == {
        name: getattr(scene.parameters, name) for name in document["parameters"]
    }
    assert Fraction(document["start"]["v0"]) == scene.v0
    rows = [
        (*(row[name] for name in ("kind", "source", "target")), *map(tuple, (row["t"], row["x"])))
        for row in document["events"]
    ]
    assert tuple(rows) == certificate.events
    assert verify(str(path))[0] == 0


def test_proofs_take_nothing_from_the_engine() -> None:
    """No kernel (their series have no remainder), no mpmath (its intervals are unsound), no simulation."""
    for path in (Path(symosc.__file__).parent / "certificates").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                assert name.split(".")[0] not in ("mpmath", "numpy", "scipy", "sympy"), path
                assert name.split(".")[:2] not in (["symosc", "kernels"], ["symosc", "engine"]), path


@pytest.mark.parametrize("digits", [40, 70])
def test_enclosures_have_as_many_digits_as_are_asked_for(digits: int, tmp_path: Path) -> None:
    usual, fine = certify("fig6"), certify("fig6", digits=digits)
    assert fine.proven
    for event, same in zip(fine.events, usual.events, strict=True):
        for (low, high), (rough_low, rough_high) in zip(event[3:], same[3:], strict=True):
            assert Fraction(rough_low) <= Fraction(low) < Fraction(high) <= Fraction(rough_high)
            assert Fraction(high) - Fraction(low) < abs(Fraction(high)) / 10 ** (digits - 2)
    fine.to_json(tmp_path / "it.json")
    assert verify(str(tmp_path / "it.json"))[0] == 0
