"""The checker of motions that settle refuses what is false and accepts what is true."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
import pytest

import symosc.certificates.verify as checker
from symosc import certify, find_orbit, load_scene
from symosc.certificates.settled import prove_settled
from symosc.certificates.trajectory import EXACT, ToProve
from symosc.reference.cases import hard_cases

NAMES = ("fig9-orbit", "fig10-orbit")
Document = dict[str, Any]


@cache
def document(name: str) -> str:
    return json.dumps(
        certify(next(case for case in hard_cases() if case.periods and case.name == name).scene).as_dict()
    )


def judged(content: Any, tmp_path: Path) -> tuple[int, str]:
    path = tmp_path / "certificate.json"
    if isinstance(content, dict):  # the message is checked last of all: see test_format.py
        content = {name: value for name, value in content.items() if name != "message"}
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return checker.verify(str(path))


def moved(row: Document, name: str, by: Fraction, wider: Fraction = Fraction(0)) -> None:
    low, high = map(Fraction, row[name])
    row[name] = [str(low + by - wider), str(high + by + wider)]


def widths(row: Document, name: str) -> Fraction:
    low, high = map(Fraction, row[name])
    return high - low


def shift(where: str, place: int, name: str, sign: int) -> Callable[[Document], None]:
    return lambda it: moved(it[where][place], name, sign * 2 * widths(it[where][place], name))


def put(*path: Any) -> Callable[[Document], None]:
    *way, last, value = path

    def change(it: Document) -> None:
        for step in way:
            it = it[step]
        it[last] = value(it[last]) if callable(value) else value

    return change


def resized(factor: Fraction) -> Callable[[Document], None]:
    def change(it: Document) -> None:
        for row in (it["cycle"][0], it["cycle"][-1]):
            for name in "tx":
                moved(row, name, Fraction(0), (factor - 1) * widths(row, name) / 2)

    return change


#: Changes after which a certificate states something that is false.
FALSE: dict[str, Callable[[Document], None]] = {
    **{
        f"{where}[{place}].{name} {sign:+d}": shift(where, place, name, sign)
        for where, place in (("events", 0), ("cycle", 0), ("cycle", 1), ("cycle", -1), ("last", 0), ("last", -1))
        for name in "tx"
        for sign in (-1, 1)
    },
    **{f"count {by:+d}": put("count", lambda it, by=by: it + by) for by in (-4, -2, -1, 1, 2, 4, 10**6)},
    "twice the periods": put("periods", lambda it: 2 * it),
    "no cycle": put("cycle", lambda it: it[:1]),
    "half a cycle": put("cycle", lambda it: it[: len(it) // 2 + 1]),
    "a cycle backwards": put("cycle", lambda it: it[::-1]),
    "a kind": put("cycle", 1, "kind", lambda it: "stick" if it != "stick" else "cross"),
    "a mode": put("cycle", 1, "target", lambda it: "Omega3" if it != "Omega3" else "Omega2"),
    "a belt": put("cycle", 1, "boundary", lambda it: 3 - it),
    "a kind of the last": put("last", -1, "kind", lambda it: "stick" if it != "stick" else "cross"),
    "a last event too many": put("last", lambda it: [it[0], *it]),
    "no first event": put("events", []),
    "the first event twice": put("events", lambda it: it * 2),
    "the first mode": put("mode", lambda it: "Omega3"),
    "a box that is not mapped into itself": resized(Fraction(10**18)),
    "a box that the motion does not come into": resized(Fraction(1, 10**12)),
    "later": put("t_end", lambda it: str(Fraction(it) + 2)),
    "earlier": put("t_end", lambda it: str(Fraction(it) - 2)),
    "a larger error of the start": put("start_error", ["1e-9", "1e-9", "0"]),
    **{
        f"{name} {sign:+d}e-6": put("parameters", name, lambda it, sign=sign: str(Fraction(it) + Fraction(sign, 10**6)))
        for name in ("m", "c", "k", "A0", "B0", "Omega", "FN")
        for sign in (-1, 1)
    },
    "a start": put("start", "x0", lambda it: str(Fraction(it) + Fraction(1, 1000))),
}
TRUE: dict[str, Callable[[Document], None]] = {
    "nothing": lambda it: None,
    "wider last": lambda it: moved(it["last"][0], "t", Fraction(0), Fraction(1, 10**9)),
    "wider in the cycle": lambda it: moved(it["cycle"][1], "x", Fraction(0), Fraction(1, 10**12)),
    "fewer last": put("last", lambda it: it[1:]),
    "a little later": put("t_end", lambda it: str(Fraction(it) + Fraction(1, 100))),
    "a smaller error of the start": put("start_error", lambda it: [str(Fraction(each) / 2) for each in it]),
}


@pytest.mark.parametrize("name", NAMES)
def test_what_is_true_is_proven(name: str, tmp_path: Path) -> None:
    for change in TRUE.values():
        changed = json.loads(document(name))
        change(changed)
        code, line = judged(changed, tmp_path)
        assert code == 0, line


@pytest.mark.parametrize("change", FALSE)
@pytest.mark.quick(12)
def test_what_is_false_is_refused(change: str, tmp_path: Path) -> None:
    for name in NAMES:
        changed = json.loads(document(name))
        before = copy.deepcopy(changed)
        FALSE[change](changed)
        assert changed != before
        code, line = judged(changed, tmp_path)
        assert (code >= 1, len(line.splitlines())) == (True, 1), (name, line)


@pytest.mark.parametrize("name", NAMES)
def test_the_motion_has_to_come_into_the_box(name: str, tmp_path: Path) -> None:
    """All that follows is as true of a cycle that begins a period later, with as many events less."""
    changed = json.loads(document(name))
    with mpmath.workdps(80):
        Omega = Fraction(changed["parameters"]["Omega"])
        turn = Fraction(mpmath.nstr(2 * mpmath.pi * Omega.denominator / Omega.numerator, 75))
    for row in changed["cycle"]:
        moved(row, "t", turn)
    changed["count"] -= len(changed["cycle"]) - 1
    assert judged(changed, tmp_path) == (1, "not proven: a number is not above the lower end stated")


@pytest.mark.parametrize("name", NAMES)
def test_a_box_of_another_shape_is_not_mapped_into_itself(name: str, tmp_path: Path) -> None:
    for place in (0, 1):
        changed = json.loads(document(name))
        for row in (changed["cycle"][0], changed["cycle"][-1]):
            for at, each in enumerate("tx"):
                factor = Fraction(1, 100) if at == place else 100
                moved(row, each, Fraction(0), (factor - 1) * widths(row, each) / 2)
        assert judged(changed, tmp_path)[0] == 1


def test_a_short_run_ends_as_near_to_the_orbit_as_it_has_come(tmp_path: Path) -> None:
    """From starts within 1e-9 the events of the 7th period are not yet those of the orbit to 20 digits."""
    scene = load_scene("fig9-orbit").started({"t_end": "11.2"})
    what = ToProve(
        scene.parameters, (scene.t0, scene.x0, scene.v0), (Fraction(0), Fraction(1, 10**9), Fraction(0)), scene.t_end
    )
    orbit = find_orbit(scene.parameters, "P32")
    wide, narrow = (prove_settled(each, orbit).as_dict() for each in (what, what._replace(errors=EXACT)))
    assert judged(wide, tmp_path)[0] == judged(narrow, tmp_path)[0] == 0
    assert judged(wide | {"last": narrow["last"]}, tmp_path)[0] == 1


@pytest.mark.parametrize(
    "until", ["0.44364498555745564947209096", "0.4436449855574556494720909", "0.4", "1", "1e9", None]
)
def test_until_when_the_start_may_stick(until: str | None, tmp_path: Path) -> None:
    """By the time stated all have left the belt; until 1 they would still be held to be there."""
    code, line = judged(json.loads(document("fig10-orbit")) | {"may_stick_until": until}, tmp_path)
    assert code == 1, line


@pytest.mark.parametrize(
    "name", ["events", "cycle", "last", "count", "periods", "start", "start_error", "mode", "t_end"]
)
def test_what_is_missing_or_nonsense_is_one_line(name: str, tmp_path: Path) -> None:
    whole = json.loads(document("fig9-orbit"))
    assert judged({key: value for key, value in whole.items() if key != name}, tmp_path)[0] == 2
    for nonsense in (7.5, "x", [], {}, [None], ["x", "y"], -1, 10**4000, True, None):
        code, line = judged(whole | {name: nonsense}, tmp_path)
        assert (code >= 1, len(line.splitlines())) == (True, 1), (nonsense, line)
