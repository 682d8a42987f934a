"""The format of certificate files: what is written fits the schema, and what does not fit is refused in one line."""

from __future__ import annotations

import copy
import json
import threading
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from flint import ctx

import symosc.certificates.verify_orbits as checker
from symosc import Parameters, Scene, certify, continue_orbit, find_orbit, grazing_window, load_scene

FORGED = Path(__file__).parent / "forged"
SCHEMA = json.loads(Path(checker.__file__).with_name("certificate.schema.json").read_text(encoding="utf-8"))
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)
KINDS = ("trajectory", "touch", "settled", "orbit", "branch", "window", "one phase", "open")


@cache
def text_of(kind: str) -> str:
    p = load_scene("fig9").parameters
    made: Any = {
        "trajectory": lambda: certify("fig6"),
        "touch": lambda: certify("fig7-exact"),
        "settled": lambda: certify("fig10-orbit", t_end=4000),
        "orbit": lambda: certify(find_orbit(p, "P32")),
        "branch": lambda: certify(continue_orbit(p, "P32", "Omega", ("4", "4.01"))),
        "window": lambda: certify(grazing_window(p, "P2")),
        "one phase": lambda: certify(grazing_window(load_scene("fig8").parameters, "P5", order="paper")),
        "open": lambda: certify("fig10-orbit", t_end=5),
    }[kind]()
    assert made.proven is (kind != "open"), made.message
    return json.dumps(made.as_dict())


def places(value: Any, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return where there are objects in a document."""
    found = [way] if isinstance(value, dict) else []
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return found + [each for key, part in parts for each in places(part, (*way, key))]


def at(document: Any, way: tuple[Any, ...]) -> Any:
    for step in way:
        document = document[step]
    return document


def verified(content: str, tmp_path: Path, **limits: int) -> tuple[int, str]:
    path = tmp_path / "it.json"
    path.write_text(content, encoding="utf-8")
    return checker.verify(str(path), **limits)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_written_fits_the_schema_and_says_what_the_checker_prints(kind: str, tmp_path: Path) -> None:
    document = json.loads(text_of(kind))
    VALIDATOR.validate(document)
    code, answer = verified(text_of(kind), tmp_path)
    assert code == (kind == "open"), answer
    if code == 0:
        head, *details = answer.splitlines()
        assert head == f"proven: {document['message']}"
        ends = [end for row in document.get("events", []) for name in "tx" for end in row.get(name, [])]
        assert all(end in "".join(details) for end in ends)  # the whole statement is printed
        assert all(f"{name} = " in details[0] for name in document["parameters"])


@pytest.mark.quick(2)
@pytest.mark.parametrize("kind", KINDS[:-1])
def test_no_key_may_be_added_dropped_or_be_there_twice(kind: str, tmp_path: Path) -> None:
    document = json.loads(text_of(kind))
    for way in places(document):
        added, names = copy.deepcopy(document), at(document, way)
        at(added, way)["note"] = "1"
        forms = [json.dumps(added)]
        for name in names.keys() - {"message", "made_by", "kind"}:
            less = copy.deepcopy(document)
            del at(less, way)[name]
            forms.append(json.dumps(less))
        for form in forms:
            assert not VALIDATOR.is_valid(json.loads(form)), (way, form[:80])
            assert verified(form, tmp_path)[0] == 2, (way, form[:80])
    twice = text_of(kind).replace('"kind":', '"kind": "", "kind":', 1)
    assert verified(twice, tmp_path) == (2, "no certificate: a key that is twice in an object")


def test_a_message_is_what_is_proven(tmp_path: Path) -> None:
    document = json.loads(text_of("orbit"))
    for word in ("stable orbit P32 for ever", "", document["message"] + "."):
        code, answer = verified(json.dumps(document | {"message": word}), tmp_path)
        assert (code, "a message that says something else" in answer) == (1, True)
    del document["message"], document["made_by"]
    assert verified(json.dumps(document), tmp_path)[0] == 0


@pytest.mark.parametrize(
    ("name", "code", "reason"),
    [
        ("graze_that_no_start_has", 1, "one start goes beyond the belt, and one does not reach it"),
        ("end_with_a_wrong_name", 1, "an end that is a 'vanishing of a slip', and not a grazing"),
        ("branch_end_outside_the_model", 2, "parameters out of range"),
        ("negative_reach", 2, "reach out of range"),
    ],
)
def test_the_forged_files_of_the_audit_are_refused(name: str, code: int, reason: str) -> None:
    found, answer = checker.verify(str(FORGED / f"{name}.json"))
    assert (found, reason in answer) == (code, True), answer


def test_some_start_needs_a_graze() -> None:
    document = json.loads(text_of("touch")) | {"events": [], "t_end": "3"}
    del document["message"]
    code, answer = checker.judge(document)
    assert (code, answer) == (1, "not proven: a graze that only one start has, and no graze is stated")


def test_work_is_limited_and_each_limit_is_an_option(tmp_path: Path) -> None:
    text = text_of("settled")
    assert verified(text, tmp_path)[0] == 0
    assert verified(text, tmp_path, steps=50) == (1, "not proven: more than 50 steps (--steps)")
    assert verified(text, tmp_path, events=3) == (1, "not proven: more than 3 events and boxes (--events)")
    assert verified(text, tmp_path, bytes=500) == (2, "no certificate: more than 500 bytes (--bytes)")
    document = json.loads(json.dumps(certify("fig7").as_dict())) | {"t_end": "1e90"}  # it meets no belt, for ever
    assert checker.judge(document, steps=5000) == (1, "not proven: more than 5000 steps (--steps)")


@pytest.mark.parametrize(
    ("kind", "change", "words"),
    [
        ("orbit", {"multipliers": ["x", {}]}, "orbit.multipliers[0] is no object"),
        ("orbit", {"alone_within": ["1"]}, "orbit.alone_within is no list"),
        ("orbit", {"kind": []}, "no kind"),
        ("trajectory", {"start_error": ["-1e-9", "0", "0"]}, "start_error: a negative number"),
        ("settled", {"count": "7"}, "settled.count: '7' is no int"),
    ],
)
def test_what_is_wrong_is_named(kind: str, change: dict[str, Any], words: str) -> None:
    code, answer = checker.judge(json.loads(text_of(kind)) | change)
    assert (code, words in answer) == (2, True), answer


def test_precision_and_cap_are_given_back_also_by_threads() -> None:
    """All threads share the precision of flint: two proofs at a time would spoil it."""
    before = ctx.prec, ctx.cap
    answers: list[int] = []

    def prove(kind: str) -> None:
        answers.append(checker.judge(json.loads(text_of(kind)))[0])

    for kind in KINDS[:6]:
        text_of(kind)  # proving is not for threads
    work = [threading.Thread(target=prove, args=(kind,)) for kind in KINDS[:6]]
    for each in work:
        each.start()
    for each in work:
        each.join()
    assert answers == [0] * 6
    assert (ctx.prec, ctx.cap) == before


@pytest.mark.parametrize("Omega", ["2", "2.0000001"])
def test_near_resonance_the_checker_confirms(Omega: str) -> None:
    """At resonance with c = 1e-10 the steady motion is 1e9 times the true one: it may not bound it."""
    p = Parameters(
        m=1, c="1e-10", k=4, A0=0, B0="0.7", Omega=Omega, v1=-3, v2=3, mu1="0.1", mu2="0.05", FN=1
    )  # fmt: skip
    found = certify(Scene("resonance", p, Fraction(0), Fraction(0), Fraction(0), Fraction("17.79")))
    assert (found.proven, len(found.events)) == (True, 11), found.message


def test_what_the_checker_refuses_is_not_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(checker.base.LIMITS, "steps", 20)
    found = certify("fig5")
    assert not found.proven
    assert found.message == "not confirmed by the checker: not proven: more than 20 steps (--steps)"
