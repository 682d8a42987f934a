"""The checker refuses what is false, accepts what is true, and says in one line what is no certificate."""

from __future__ import annotations

import copy
import json
import random
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from certificate_mutants import CHANGES, is_true
from flint import arb

import symosc.certificates.verify as checker
from symosc import Parameters, Scene, certify
from symosc.certificates.balls import ball, outward, working_bits
from symosc.certificates.contact import Wall, gap_of, zero_in
from symosc.certificates.flow import Flight, FlightStart, Oscillator
from symosc.certificates.turns import Turns

SCENES = (("fig5", 3), ("fig6", 12), ("fig7-corrected", 5), ("fig9", 3), ("fig10", 4), ("fig8", 9))


@cache
def document(name: str, t_end: int | None = None) -> str:
    return json.dumps(certify(name, t_end=t_end).as_dict())


def judged(content: Any, tmp_path: Path) -> tuple[int, str]:
    path = tmp_path / "certificate.json"
    if isinstance(content, dict):  # the message is checked last of all: see test_format.py
        content = {name: value for name, value in content.items() if name != "message"}
    path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return checker.verify(str(path))


@pytest.mark.quick(6)
@pytest.mark.parametrize("change", CHANGES)
def test_a_changed_certificate_is_proven_only_if_it_is_still_true(change: str, tmp_path: Path) -> None:
    _judge(change, tmp_path, 3)


@pytest.mark.campaign
@pytest.mark.parametrize("change", CHANGES)
def test_many_changed_certificates(change: str, tmp_path: Path) -> None:
    _judge(change, tmp_path, 40)


def _judge(change: str, tmp_path: Path, count: int) -> None:
    rng = random.Random(f"{change} {count}")
    for _ in range(count):
        changed = copy.deepcopy(json.loads(document(*rng.choice(SCENES))))
        before = copy.deepcopy(changed)
        CHANGES[change](rng, changed)
        code, line = judged(changed, tmp_path)
        if changed != before and not is_true(changed):
            assert code >= 1, (line, changed)  # 2 where an upper end is below the lower one
        elif change in ("box wider", "end"):
            assert code == 0, (line, changed)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fig7-exact", "fig8-exact"])
def test_a_graze_is_refused_where_no_start_touches(name: str, tmp_path: Path) -> None:
    good = json.loads(document(name))
    assert judged(good, tmp_path)[0] == 0
    for change in (
        lambda it: it.update(starts="all"),
        lambda it: it.update(start_error=["0", "1e-60", "1e-60"]),  # the start that touches is further off
        lambda it: it["events"].clear(),
        lambda it: it["events"].append(it["events"][0]),
        lambda it: it["events"][0].update(kind="cross"),
        lambda it: it["events"][0].update(t=["3.1", "3.14"]),
        lambda it: it["parameters"].update(A0="10.0000001"),
        lambda it: it["free"].update(name="v0"),
    ):
        bad = copy.deepcopy(good)
        change(bad)
        code, line = judged(bad, tmp_path)
        assert code >= 1, line


@pytest.mark.parametrize("starts", ["", "none", "1_000", 1, None, True, []])
def test_starts_are_all_or_some(starts: Any, tmp_path: Path) -> None:
    """Every other text was read as "some"."""
    assert judged(json.loads(document("fig7-exact")) | {"starts": starts}, tmp_path)[0] == 2


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", ["fig7-exact", "fig8-exact"])
@pytest.mark.parametrize("shift", [-9, 0, 9])
def test_starts_that_all_miss_or_all_meet_the_belt_have_no_graze(name: str, shift: int, tmp_path: Path) -> None:
    good = json.loads(document(name))
    low, high = (Fraction(good["free"][end]) for end in ("low", "high"))
    moved = {"low": str(low + shift * (high - low)), "high": str(high + shift * (high - low))}
    code, line = judged(good | {"free": good["free"] | moved}, tmp_path)
    assert (code, "one start goes beyond" in line) == ((1, True) if shift else (0, False)), line


def test_a_later_contact_of_the_same_flight_is_not_the_next_event(tmp_path: Path) -> None:
    """The flight is continued beyond its contact, as if nothing happened there, to where it meets the belt again."""
    p = Parameters(m=1, c="0.1", k=4, A0=0, B0="0.5", Omega="0.7", v1=1, v2=9, mu1="0.1", mu2="0.1", FN=1)
    scene = Scene("later", p, Fraction(0), Fraction(-3), Fraction(-1), Fraction(9))
    whole = certify(scene).as_dict()
    assert judged(whole, tmp_path)[0] == 0
    with working_bits(200):
        flight = Flight(Oscillator(p), 1, FlightStart(arb(0), arb(-3), arb(-1)))
        gap = gap_of(flight, Wall(1, -1, Turns(p, 1)))
        falls = [
            tau / 100 for tau in range(900) if gap(ball(Fraction(tau, 100))).g > 0 > gap(ball(Fraction(tau + 1, 100))).g
        ]
        assert len(falls) > 1
        for number, tau in enumerate(falls):
            t = zero_in(gap, arb(tau), arb(tau) + arb("0.011"), "a contact", flight.start.t)
            there = flight.at(t)
            target = "Omega2" if there.a > Oscillator(p).jump[1] else "belt1"
            row = {"kind": "cross" if target == "Omega2" else "stick", "boundary": 1, "source": "Omega1"}
            row |= {"target": target, "t": list(outward(t, 25)), "x": list(outward(flight.x(there), 25))}
            end = str(Fraction(row["t"][1]) + Fraction(1, 10**6))
            code, line = judged(whole | {"events": [row], "t_end": end}, tmp_path)
            assert code == (1 if number else 0), line


HOSTILE = {
    "empty": "",
    "no JSON": "{",
    "a list": "[]",
    "a number": "1",
    "NaN": "NaN",
    "deep": "[" * 100_000,
    "deeper in": '{"format": ' + "[" * 100_000,
    "huge int": "1" + "0" * 5000,
    "other format": '{"format": "x", "proven": true, "kind": "trajectory"}',
    "bytes": "\udcff".encode("utf-8", "surrogatepass").decode("latin-1"),
}
#: Where, and what is put there.
WRONG: list[tuple[tuple[Any, ...], Any]] = [
    (("kind",), "circle"),
    (("kind",), []),
    (("proven",), 1),
    (("proven",), None),
    (("parameters", "m"), "0"),
    (("parameters", "m"), "-1"),
    (("parameters", "m"), 1),
    (("parameters", "m"), "1e-999"),
    (("parameters", "k"), "1e999"),
    (("parameters", "c"), "1/0"),
    (("parameters", "c"), "nan"),
    (("parameters", "FN"), "9" * 3000),
    (("parameters",), []),
    (("parameters", "v2"), "-7"),
    (("start", "t0"), float("nan")),
    (("start", "x0"), "１"),
    (("start_error",), ["0", "0"]),
    (("start_error",), ["0", "-1", "0"]),
    (("start_error",), None),
    (("t_end",), "1e170"),
    (("t_end",), "-1"),
    (("t_end",), "1" * 10_000),
    (("events",), {}),
    (("events",), [1]),
    (("events", 0), None),
    (("events", 0, "t"), ["1"]),
    (("events", 0, "t"), ["2", "1"]),
    (("events", 0, "t"), "12"),
    (("events", 0, "boundary"), 3),
    (("events", 0, "boundary"), "1"),
    (("events", 0, "source"), "Omega9"),
    (("events", 0, "target"), ""),
    (("starts",), "none"),
    (("free",), {"name": "m"}),
    (("mode",), 7),
]


@pytest.mark.parametrize("content", HOSTILE.values(), ids=list(HOSTILE))
def test_no_certificate_is_one_line_and_exit_code_2(content: str, tmp_path: Path) -> None:
    code, line = judged(content, tmp_path)
    assert (code, len(line.splitlines())) == (2, 1)


@pytest.mark.parametrize(("where", "value"), WRONG, ids=str)
def test_a_certificate_with_nonsense_in_it(where: tuple[Any, ...], value: Any, tmp_path: Path) -> None:
    bad = json.loads(document("fig6"))
    *path, last = where
    place = bad
    for name in path:
        place = place[name]
    place[last] = value
    code, line = judged(bad, tmp_path)
    assert code == 2, line
    assert len(line.splitlines()) == 1
    assert len(line) < 300


def test_what_was_not_proven_states_nothing(tmp_path: Path) -> None:
    assert judged(json.loads(document("fig6")) | {"proven": False}, tmp_path)[0] == 1


def test_a_touch_within_40_digits_is_proven_with_more_bits(tmp_path: Path) -> None:
    """Near the touch steps are short for want of bits; 50,000 of them said that its time is too far away."""
    code, line = judged(certify("fig8-exact", digits=40).as_dict(), tmp_path)
    assert (code, line.splitlines()[0]) == (0, "proven: 1 event until t = 7, for some x0 within the error of the start")
