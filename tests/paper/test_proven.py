"""What the evidence says of certificates, with python-flint and without it."""

from __future__ import annotations

import builtins
import sys

import pytest

from symosc import find_orbit, load_scene
from symosc.paper.checks.proven import CERTIFICATE, certificate_of


def test_orbits_sticks_and_grazes_cite_a_proof() -> None:
    pytest.importorskip("flint")
    scene = load_scene("fig9")
    for what in (find_orbit(scene.parameters, scene.structure), load_scene("fig6"), load_scene("fig8-exact")):
        assert certificate_of(what)[CERTIFICATE].startswith("proven: "), what


def test_without_python_flint_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = builtins.__import__

    def without(name: str, *rest: object, **more: object) -> object:
        if name.partition(".")[0] == "flint":
            raise ImportError(name)
        return whole(name, *rest, **more)  # type: ignore[arg-type]

    for name in [each for each in sys.modules if each.startswith("symosc.certificates")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(builtins, "__import__", without)
    assert certificate_of(load_scene("fig6")) == {CERTIFICATE: "none here: python-flint is not installed"}
