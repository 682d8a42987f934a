"""What a certificate's file may be: strict UTF-8; and windows whose ends almost meet, true and false."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from symosc import certify, grazing_window, load_scene
from symosc.certificates import verify, verify_orbits

NARROW = load_scene("fig8").parameters.replace(B0="16.00000000000001")


def judged(data: Any, steps: int = 1000) -> tuple[int, str]:
    """Return what the checker says; no window takes steps."""
    found: tuple[int, str] = verify.judge(json.loads(json.dumps(data)), steps=steps)
    return found


@pytest.mark.parametrize("checker", [verify, verify_orbits])
@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-32", "utf-8-sig", "latin-1"])
def test_a_file_that_is_not_utf_8_is_none(checker: Any, encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "window.json"
    data = certify(grazing_window("fig9", "P2")).as_dict() | {"made_by": "größer"}
    text = json.dumps(data, ensure_ascii=False)
    path.write_text(text, encoding="utf-8")
    assert checker.verify(path)[0] == 0
    path.write_text(text, encoding=encoding)
    code, answer = checker.verify(path)
    assert (code, answer.count("\n")) == (2, 0)
    assert answer.startswith("no certificate: ")


@pytest.mark.parametrize("more", ["1", "1e-3", "1e-14", "1e-18", "1e-22"])
@pytest.mark.parametrize("mapping", ["P2", "P3", "P5", "P6"])
def test_a_window_whose_ends_almost_meet_is_proven(mapping: str, more: str) -> None:
    """The example of an audit is 1e-14 and P5: |k v| = 16 is just less than |B0| Omega / 2."""
    from fractions import Fraction

    p = NARROW.replace(B0=16 + Fraction(more))
    proof = certify(grazing_window(p, mapping))
    assert proof.proven, proof.message
    assert judged(proof.as_dict())[0] == 0


@pytest.mark.parametrize("mapping", ["P2", "P3", "P5", "P6"])
def test_a_false_window_is_answered(mapping: str) -> None:
    true = certify(grazing_window(NARROW, mapping)).as_dict()
    del true["message"]
    ends = true["ends"]
    assert len(ends) == 2
    other = {"P2": "P3", "P3": "P2", "P5": "P6", "P6": "P5"}[mapping]
    falsified = [true | {"map": other}]
    turned = copy.deepcopy(ends)
    for end in turned:
        end["cosine"] = -end["cosine"]
    falsified += [
        true | {"ends": turned},
        true | {"ends": turned[::-1]},
        true | {"ends": ends[::-1]},
    ]
    for digits in (1e-3, 1e-9, 1e-12):
        wide = copy.deepcopy(ends)
        wide[0]["phase"] = [f"{float(end) - digits:.20f}" for end in ends[0]["phase"]]
        falsified.append(true | {"ends": wide})
    for where in ("everywhere", "nowhere", "everywhere but at one phase"):
        falsified += [
            true | {"grazes": where, "ends": []},
            true | {"grazes": where, "ends": ends[:1]},
        ]
    for data in falsified:
        code, answer = judged(data)
        assert code in (1, 2), answer
        assert "steps" not in answer
