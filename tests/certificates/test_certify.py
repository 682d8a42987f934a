"""What `certify` takes, and what it hands over."""

from __future__ import annotations

import ast
import json
import sys
from fractions import Fraction
from pathlib import Path

import pytest

import symosc
from symosc import certify, find_orbit, grazing_window, load_scene, simulate
from symosc.certificates import propose, propose_orbits
from symosc.certificates.verify import verify


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


@pytest.mark.parametrize("name", ["verify.py", "verify_orbits.py"])
def test_proofs_take_nothing_from_the_engine(name: str) -> None:
    """The checkers import nothing of symosc, and no mpmath, whose intervals are unsound."""
    allowed = {*sys.stdlib_module_names, "flint", "verify"}
    path = Path(symosc.__file__).parent / "certificates" / name
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0
            names = [node.module or ""]
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "import_module":
            names = [
                each.value for each in ast.walk(node.args[0]) if isinstance(each, ast.Constant)
            ]
            names = [each.lstrip(".") for each in names if isinstance(each, str)]
        assert {each.split(".")[0] for each in names} <= allowed, names


def test_a_wrong_proposal_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """The checker alone decides: what the engine proposes a little off is not proven."""
    right = propose.around

    def wrong(number: object, radius: object) -> tuple[Fraction, Fraction]:
        return right(propose.fraction(number) + Fraction(1, 10**20), radius)

    things = ("fig6", "fig7-exact", find_orbit("fig9"), grazing_window("fig9", "P2"))
    for module in (propose, propose_orbits):
        monkeypatch.setattr(module, "around", wrong)
    for thing in things:
        found = certify(thing)
        assert not found.proven, thing
        assert "not confirmed by the checker" in found.message


@pytest.mark.parametrize("digits", [40, 70])
def test_enclosures_have_as_many_digits_as_are_asked_for(digits: int, tmp_path: Path) -> None:
    usual = certify("fig6")
    fine = certify("fig6", digits=digits)
    assert fine.proven
    for event, same in zip(fine.events, usual.events, strict=True):
        for (low, high), (rough_low, rough_high) in zip(event[3:], same[3:], strict=True):
            assert Fraction(rough_low) <= Fraction(low) < Fraction(high) <= Fraction(rough_high)
            assert Fraction(high) - Fraction(low) < abs(Fraction(high)) / 10 ** (digits - 2)
    fine.to_json(tmp_path / "it.json")
    assert verify(str(tmp_path / "it.json"))[0] == 0


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["fig5", "fig8", "fig10"])
def test_derivatives_are_enclosed(name: str) -> None:
    """They contain the difference quotients of motions with 60 digits, to all digits that these have."""
    scene = load_scene(name)
    names = ("m", "c", "k", "A0", "B0", "Omega", "mu1", "FN", "t0", "x0")
    end = scene.t0 + 7
    step = Fraction(1, 10**22)
    proof = certify(scene, t_end=end, wrt=names)
    assert proof.proven, proof.message
    for j, each in enumerate(names):
        runs = []
        for by in (step, -step):
            start = {
                own: getattr(scene, own) + (by if own == each else 0) for own in ("t0", "x0", "v0")
            }
            p = scene.parameters
            if each not in start:
                p = p.replace(**{each: getattr(p, each) + by})
            runs.append(simulate(p, **start, t_end=end, digits=60).events)
        for n, (a, b) in enumerate(zip(*runs, strict=True)):
            for axis, enclosures in zip("tx", proof.derivatives[n], strict=True):
                quotient = Fraction(str((getattr(a, axis) - getattr(b, axis)) / 2)) / step
                low, high = map(Fraction, enclosures[j])
                assert low - Fraction(1, 10**22) < quotient < high + Fraction(1, 10**22), (
                    each,
                    n,
                    axis,
                )
                assert high - low < Fraction(1, 10**20) * max(1, abs(low))


def test_an_error_of_the_start_below_the_limits_of_the_format_is_not_proven() -> None:
    certificate = certify("fig6", t_end=2, start_error=Fraction(1, 10**5000))
    assert not certificate.proven
    assert "between 1e-100 and 1e100" in certificate.message
