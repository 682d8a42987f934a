"""The checker is weakened, one requirement at a time.

Each time a forged file gets through that it refuses.

A row is: what is dropped or loosened in the source, and a forged file.
docs/explanation/certificates.md has the same table in words.
"""

from __future__ import annotations

import ast
import json
import re
import sys
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import law_forgeries as laws
import pytest
from certificate_files import Document, document, forged, moved, put
from flint import arb, ctx, fmpq
from mpmath import cos, expm, matrix, mpf, nstr, pi, sin, workdps

import symosc.certificates.verify as verify
import symosc.certificates.verify_orbits as verify_orbits
from symosc import Parameters, Scene, certify, find_orbit, grazing_window, load_scene, sensitivities
from symosc.certificates.propose_orbits import certify_orbit


def weakened(module: ModuleType, changes: tuple[tuple[str, str], ...]) -> Any:
    """Return `judge` of a checker whose source is changed; its sister is loaded with it."""
    sources = {
        each: Path(str(each.__file__)).read_text(encoding="utf-8")
        for each in (verify, verify_orbits)
    }
    for old, new in changes:
        assert sources[module].count(old) >= 1, f"no such line any more: {old}"
        sources[module] = sources[module].replace(old, new)
    loaded = {}
    for each, name in ((verify, "verify"), (verify_orbits, "verify_orbits")):
        loaded[name] = ModuleType(name)
        before = sys.modules.get("verify")
        sys.modules["verify"] = loaded["verify"]  # the second imports the first as a file beside it
        try:
            exec(compile(sources[each], name, "exec"), loaded[name].__dict__)
        finally:
            del sys.modules["verify"]
            if before is not None:
                sys.modules["verify"] = before
    return loaded["verify"].judge


def altered(name: str, *path: Any) -> Document:
    return put(document(name), *path)


def shifted(name: str, *path: Any, by: Any = 1) -> Document:
    return altered(name, *path, lambda ends: moved(ends, by))


def excursions(x0: str, v0: str) -> list[Document]:
    """Say that nothing happens, until several times, while v goes beyond v1 and comes back."""
    start = {"t0": "0", "x0": x0, "v0": v0}
    return [
        document("swing") | {"events": [], "t_end": f"{t / 8}", "start": start}
        for t in range(24, 60)
    ]


class Row(NamedTuple):
    """What is changed in the checker, and forged files, one of which at least gets through then."""

    changes: tuple[tuple[str, str], ...]
    forged: Callable[[], Document | list[Document]]
    module: ModuleType = verify


@cache
def requirements() -> set[str]:
    """Return the calls in both checkers that refuse a file."""
    found = set()
    for module in (verify, verify_orbits):
        source = Path(str(module.__file__)).read_text(encoding="utf-8")
        lines = source.splitlines()
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Expr) and re.match(
                r"\s*(require|check|inside)\(", lines[node.lineno - 1]
            ):
                # `ast.get_source_segment` splits the whole source for each of them: that took 4 s.
                first = lines[node.lineno - 1 : node.end_lineno]
                text = "\n".join(first)
                last = len(first[-1]) - (node.end_col_offset or 0)
                found.add(text[node.col_offset : len(text) - last])
    return found


def dropped(text: str) -> tuple[tuple[str, str], ...]:
    """Drop the requirement that has a text in it."""
    (found,) = (each for each in requirements() if text in each)
    return ((found, "pass"),)


def without_the_last_event(name: str) -> Document:
    whole = document(name)
    del whole["events"][-1]
    return whole


def without_a_graze() -> Document:
    return document("motion fig7-exact") | {"events": [], "t_end": "3"}


def a_miss() -> Document:
    """State a graze of an exact start, which misses the belt by a little."""
    whole = document("circle")
    start = whole["start"] | {"v0": str(-1 + Fraction(1, 10**20))}
    (t, x) = (whole["events"][0][name] for name in "tx")
    row = whole["events"][0]
    row = row | {
        "t": [moved(t, "-1e-6")[0], moved(t, "1e-6")[1]],
        "x": [moved(x, "-1e-6")[0], moved(x, "1e-6")[1]],
    }
    return whole | {"start": start, "events": [row], "t_end": moved(t, "0.1")[0]}


def by_v0() -> Document:
    """State derivatives by v0 of a flight from a belt.

    For starts below the belt they are others.
    """
    s = sensitivities("fig9", "v0", t_end=2, digits=40)
    ends = [
        [[moved([str(d[n, 0])] * 2, 0, "1e-20")] for d in (s.dt, s.dx)] for n in range(len(s.dt))
    ]
    return document("derivatives fig9 2") | {
        "wrt": ["v0"],
        "derivatives": [dict(zip(("dt", "dx"), e, strict=True)) for e in ends],
    }


def at_the_edge_of_a_stick() -> Document:
    """Begin on a belt where a force is 0 and falls.

    With a little more of mu2 it would stick at first. The derivatives are those from the other
    side.
    """
    p = Parameters(m=1, c=1, k=1, A0=0, B0=0, Omega=1, v1="-0.1", v2=1, mu1="1/2", mu2="1/2", FN=1)
    scene = Scene("edge", p, Fraction(0), Fraction(-1), Fraction(1), Fraction(3))
    beside = replace(scene, parameters=p.replace(mu2=Fraction(1, 2) - Fraction(1, 10**40)))
    edge: Document = json.loads(json.dumps(certify(scene).as_dict()))
    del edge["message"]
    one_sided = certify(beside, wrt="mu2").as_dict()
    return edge | {key: one_sided[key] for key in ("wrt", "derivatives")}


def everywhere() -> Document:
    found = certify(grazing_window(load_scene("fig9").parameters.replace(B0="0.1"), "P2")).as_dict()
    del found["message"]
    return found


def another_cycle() -> Document:
    whole = document("settled fig9-orbit 2000")
    whole["last"] = whole["last"][-1:]
    return put(whole, "cycle", 0, "kind", "stick")


def one_cycle_more() -> Document:
    """State two events more than there are until t_end; the last ones a period later."""
    whole = document("settled fig9-orbit 2000")
    with workdps(60):
        turn = Fraction(nstr(2 * pi / mpf(whole["parameters"]["Omega"]), 55))
    for row in whole["last"]:
        row["t"] = moved(row["t"], turn)
    return whole | {"count": whole["count"] + len(whole["cycle"]) - 1}


def twice_round() -> Document:
    """State an orbit of one period as one of two."""
    whole = document("orbit fig9")
    with workdps(60):
        turn = Fraction(nstr(2 * pi / mpf(whole["parameters"]["Omega"]), 55))
    rows = whole["events"]
    again = [
        row | {"t": moved(row["t"], turn), "reach": str(100 * Fraction(row["reach"]))}
        for row in rows[1:]
    ]
    wide = {"re": ["-1", "1"], "im": ["-1", "1"]}
    return whole | {
        "events": rows + again,
        "word": "P3232",
        "periods": 2,
        "multipliers": [wide, wide],
    }


def off_the_range() -> Document:
    whole = document("branch short")
    return put(
        whole, "ends", 1, {"kind": "end of the range", "inside": "4.005", "outside": "4.005"}
    )


def another_family() -> Document:
    """State the end of a branch for the same orbit a period later, which is no event of the rows."""
    whole = put(forged("end_with_a_wrong_name"), "ends", 1, "kind", "grazing")
    end = whole["ends"][1]
    with workdps(60):
        turn = Fraction(nstr(2 * pi / mpf(end["inside"]), 55))
    change = turn * abs(
        1 - Fraction(end["inside"]) / Fraction(end["outside"])
    )  # of the turn from value to value
    moves = {"t": [moved(t, turn, change) for t in end["t"]], "at": str(Fraction(end["at"]) + turn)}
    return put(whole, "ends", 1, end | moves)


def a_gap() -> Document:
    whole = document("branch short")
    low, high = whole["boxes"][0]["value"]
    return put(whole, "boxes", 0, "value", 1, str((Fraction(low) + Fraction(high)) / 2))


BEFORE = "a number is not above the lower end stated"
BEHIND = "a number is not below the upper end stated"
ROWS: dict[str, Row] = {
    # 2: nothing happens before the next event
    "a step, from its start on": Row(
        (("sure = f > 0 and f + slope * half - bend * half * half / 2 > 0", "sure = f > 0"),),
        lambda: excursions("-3", "-1"),
    ),
    "the bound of f'' in it": Row(
        (("self.bound(z, n + 2, h)", "arb(0)"),), lambda: excursions("3", "-1")
    ),
    "a flight that settles": Row(
        (("- most > 0", "- most > -1e9"),), lambda: without_the_last_event("motion fig9 2")
    ),
    "a stick that rests": Row(
        (("if least > 0:", "if f > 0:"),), lambda: without_the_last_event("motion fig6")
    ),
    "the step from a belt": Row(
        (("f > 0 and f + slope * half - bend", "f > 0 and n > 0 or f + slope * half - bend"),),
        lambda: excursions("3", "1"),
    ),
    # 3: events
    "the lower end of an interval": Row(
        dropped(BEFORE), lambda: shifted("motion fig6", "events", 0, "x")
    ),
    "the upper end of an interval": Row(
        dropped(BEHIND), lambda: shifted("motion fig6", "events", 0, "x", by=-1)
    ),
    "the belt of a slip": Row(
        ((" and edge == self.edge", ""),),
        lambda: altered("motion fig6", "events", 0, "boundary", 1),
    ),
    "the kind of an event": Row(
        dropped("{kind}: {self.mode.name} to"),
        lambda: altered("motion fig6", "events", 1, "kind", "cross"),
    ),
    "the mode behind an event": Row(
        dropped("{kind}: {self.mode.name} to"),
        lambda: altered("motion fig6", "events", 1, "target", "Omega1"),
    ),
    "the first mode": Row(
        (('check(data["mode"] == motion.mode.name', "check(True"),),
        lambda: altered("motion fig6", "mode", "Omega2"),
    ),
    "the velocity of a start on a belt": Row(
        dropped("whose velocity is known exactly"),
        lambda: altered("motion fig6", "start_error", ["0", "0", "1e-40"]),
    ),
    # 4: grazes
    "that one start goes beyond the belt": Row(
        dropped("one start goes beyond the belt"), lambda: forged("graze_that_no_start_has")
    ),
    "that there is a start that touches": Row(dropped("a graze of no start"), a_miss),
    "that a graze is stated": Row(dropped("and no graze is stated"), without_a_graze),
    "that the free number is within the error": Row(
        dropped("a free number within the start's error"),
        lambda: altered("motion fig7-exact", "start_error", ["0", "1e-60", "1e-60"]),
    ),
    # 6: motions that settle
    "how many events there are": Row(dropped("so many events until t_end"), one_cycle_more),
    "the kinds of the last events": Row(
        dropped("the kinds of the last events"),
        lambda: altered("settled fig9-orbit 2000", "last", -1, "kind", "stick"),
    ),
    "that the cycle begins with the last event": Row(
        dropped("a cycle from the last event on"), another_cycle
    ),
    "when the mass has left the belt": Row(
        dropped("the end of a stick before the time stated"),
        lambda: altered(
            "settled fig10-orbit 4000", "may_stick_until", "0.44364498555745564947209095001"
        ),
    ),
    # 7: derivatives
    "the lower end of a derivative": Row(
        dropped(BEFORE), lambda: shifted("derivatives fig5 7", "derivatives", 2, "dt", 0)
    ),
    "the upper end of a derivative": Row(
        dropped(BEHIND), lambda: shifted("derivatives fig5 7", "derivatives", 2, "dx", 1, by=-1)
    ),
    "that a start on a belt has none by v0": Row(dropped("takes the start off its belt"), by_v0),
    "that there is none where a force is 0 at the start": Row(
        dropped("where a force is 0 at the start"), at_the_edge_of_a_stick
    ),
    # 8: windows
    "the sign of s": Row(
        (
            ('require(arb(bias) + arb(swing) * end.sin(), "phases on', 'check(True, "phases on'),
            ("require(low - least - before * turn, outside)", "pass"),
            ("require(least + (before + 1) * turn - high, outside)", "pass"),
        ),
        lambda: put(everywhere(), "grazes", "nowhere"),
    ),
    "that s is 0 at an end": Row(
        dropped("an end where s is not 0"),
        lambda: altered(
            "window fig9 P2", "ends", 0, "sine", str(Fraction(-1, 12) + Fraction(1, 10**26))
        ),
    ),
    "the order at the phase where s is 0": Row(
        dropped("not so at the phase where s is 0"),
        lambda: altered("window fig8 P5", "order", "paper"),
    ),
    # orbits
    "the word": Row(
        dropped("the word {word[:40]!r}, of events that say {shown"),
        lambda: altered("orbit fig9", "word", "P23456"),
        verify_orbits,
    ),
    "the least period": Row(dropped("that the least period is"), twice_round, verify_orbits),
    "the stability": Row(
        dropped("not as stable as it is said to be"),
        lambda: altered("orbit fig9", "stable", False),
        verify_orbits,
    ),
    "the sizes of multipliers": Row(
        dropped('inside(re, ends["re"])'),
        lambda: shifted("orbit fig9", "multipliers", 0, "re"),
        verify_orbits,
    ),
    "where the orbit is": Row(
        dropped('inside(x, row["x"])'),
        lambda: shifted("orbit fig9", "events", 1, "x"),
        verify_orbits,
    ),
    # branches
    "that the boxes follow each other": Row(
        dropped("rows that follow each other"), a_gap, verify_orbits
    ),
    "that the ends are those of the range": Row(
        dropped("an end of the range, or one outside of it"), off_the_range, verify_orbits
    ),
    "that the orbits beyond an end are those of the rows": Row(
        (('found.within(row, *found.root(end["inside"]))', "pass"),), another_family, verify_orbits
    ),
    # other friction laws
    "static friction at a contact": Row(
        ((" - arb(law.edges[edge].excess)", ""),), laws.crossing_through_static_friction
    ),
    "static friction during a stick": Row(
        (
            ("held = [0, 0, excess, 0, 0]", "held = [0] * 5"),
            ("if edge.excess > 0:", "if False:"),
        ),
        laws.slip_of_kinetic_friction,
    ),
    "the growth of a transient": Row((("(h * self.growth).exp()", "arb(1)"),), laws.hidden_growth),
    "that a flight that settles does not grow": Row(
        ((" and square > 0 and c >= 0:", " and square > 0:"),), laws.growth_that_settles
    ),
    "the parts of a curve": Row(
        (("slope = (next_mu - mu) / (end - begin)", "pass"),), laws.constant_friction_with_a_curve
    ),
    "that static friction holds what touches it": Row(
        dropped("which holds what touches it"), laws.graze_of_static_friction
    ),
    "what follows an arrival at the limit": Row(
        (("if onward * v > 0:", "if False:"),), laws.arrival_at_the_limit_that_crosses
    ),
    "that an arrival is at the limit": Row(
        (("if square != limit * limit or v == 0:", "if v == 0:"),),
        laws.arrival_beyond_the_limit_that_sticks,
    ),
    "that a rest is held": Row((("return min(least) >= 0", "return True"),), laws.rest_that_slips),
    "the number of a belt": Row(
        dropped("a belt or a corner that there is not"), laws.belt_without_number
    ),
    "static friction of the model": Row(
        ((' and belt["mu_s"] >= belt["curve"][0][1]', ""),),
        lambda: laws.belts_not_met("mu_s", "1/5"),
    ),
    "a slope of the model": Row(
        (('belt["slope"] >= 0 and ', ""),), lambda: laws.belts_not_met("slope", "-1/5")
    ),
    "a curve of the model": Row(
        (('min(mu for _, mu in belt["curve"]) >= 0', "True"),),
        lambda: laws.belts_not_met("curve", 1, ["1", "-1/5"]),
    ),
    "where a curve begins": Row(
        (("ws[:1] == [0]", "True"),), lambda: laws.belts_not_met("curve", 0, ["-1/5", "2/5"])
    ),
    "the event that closes an orbit": Row(
        (('check(steps[0] == steps[-1], "', 'check(True, "'),), laws.other_way_in, verify_orbits
    ),
    "open intervals": Row(
        (("check(low < high, f", "check(low <= high, f"),), laws.cycle_between_0_and_0
    ),
    "the least cycle": Row(
        dropped("no part of the cycle is all of it"), laws.twice_round_a_cycle, verify_orbits
    ),
    "that a steady motion stays in its band": Row(
        dropped("that the steady motion stays in its band"),
        laws.steady_motion_beyond_a_belt,
        verify_orbits,
    ),
    "that a cycle has no drive": Row(
        (
            (
                'data["periods"] == data["parameters"]["B0"] == 0',
                'data["periods"] == 0',
            ),
        ),
        laws.drive_left_out,
        verify_orbits,
    ),
    "the word of a law": Row(
        dropped("the word {word[:40]!r}, of events that say {' '.join"),
        lambda: altered("law-orbit three", "word", "S1∘B1"),
        verify_orbits,
    ),
    "the kind of an end": Row(
        dropped("an end that is a {kind[:40]!r}"),
        lambda: forged("end_with_a_wrong_name"),
        verify_orbits,
    ),
    "the range of the model at an end": Row(
        ((', *(end["outside"] for end in data["ends"])', ""),),
        lambda: forged("branch_end_outside_the_model"),
        verify_orbits,
    ),
    "that events follow each other": Row(
        dropped("events that do not follow each other"),
        lambda: altered("branch short", "events", 1, "kind", "slip"),
        verify_orbits,
    ),
}


@pytest.mark.quick(8)
@pytest.mark.parametrize("name", ROWS)
def test_without_the_requirement_a_forged_file_gets_through(name: str) -> None:
    row = ROWS[name]
    made = row.forged()
    if isinstance(made, list):
        files = made
    else:
        files = [made]
    for each in files:
        code, answer = verify_orbits.judge(each, steps=20_000)
        assert code > 0, answer
    judge = weakened(row.module, row.changes)
    answers = [judge(each, steps=20_000) for each in files]
    assert 0 in [code for code, _ in answers], {answer for _, answer in answers}


@pytest.mark.slow
def test_a_branch_of_too_many_events_is_refused_before_its_matrices_are_made() -> None:
    """They had 10,000 rows and more: FLINT ended the process for want of memory."""
    whole = document("branch short")
    n = 2500
    rows = whole["events"]
    box = whole["boxes"][0]
    for name in "tx":
        box[name] = box[name][:-1] * n + box[name][:1]
    ends = [
        {"kind": "end of the range", "inside": value, "outside": value} for value in box["value"]
    ]
    whole |= {"events": rows[:-1] * n + rows[:1], "word": "P" + "32" * n, "ends": ends}
    code, answer = verify_orbits.judge(whole | {"boxes": [box], "range": box["value"]})
    assert (code, "--steps" in answer) == (1, True), answer


def test_behind_an_event_the_velocity_is_that_of_the_belt() -> None:
    """A speed that is no binary fraction was rounded, and the ball about it left out."""
    row = verify.read(document("swing")["events"][0], verify.EVENTS[0], "event")
    p = verify.read(document("swing")["parameters"], verify.MOTION["parameters"], "p") | {
        "v1": fmpq(1000001, 1000000)
    }
    row |= {"t": (row["t"][0] - fmpq(1, 1000), row["t"][1] + fmpq(1, 1000))}
    start = [fmpq(0), fmpq(-3), fmpq(-1)]
    with ctx.workprec(256):
        then = verify.begin(
            verify.StatedOscillator(p, {"left": 1000, "steps": 1000}), start, [fmpq(0)] * 3, []
        ).after_event(row)
        assert then.centre[2].contains(fmpq(1000001, 1000000))


def test_the_state_at_the_first_of_uncertain_times_is_enclosed() -> None:
    """For each time that the start may have, the state is followed back by the exponential of the ODE's matrix."""
    p = verify.read(document("swing")["parameters"], verify.MOTION["parameters"], "p")
    m, c, k, A0, B0, Om, *_, mu1, mu2, FN = (
        mpf(int(q.p)) / int(q.q) for q in (p[name] for name in verify.NAMES)
    )
    rows = [[0, 1, 0, 0, 0], [-k / m, -c / m, (A0 + (mu2 - mu1) * FN) / m, B0 / m, 0]]
    M = matrix([*rows, [0] * 5, [0, 0, 0, 0, -Om], [0, 0, 0, Om, 0]])
    half = Fraction(1, 64)
    for x, v in ((-5, -1), (-5, 1), (7, -2), (7, 2)):
        centre = [arb(1), arb(x), arb(v)]
        with ctx.workprec(128):
            problem = verify.StatedOscillator(p, {"left": 1000, "steps": 1000})
            found = verify.VerifiedMotion(
                problem, 2, 0, centre, [[arb(float(half)), arb(0), arb(0)]]
            )
        for part in range(-4, 5):
            late = half * (4 + part) / 4  # after the first time
            t = 1 - float(half) + float(late)
            z = expm(-M * float(late)) * matrix([x, v, 1, cos(Om * t), sin(Om * t)])
            assert all(found.z0[i, 0].contains(arb(nstr(z[i], 12))) or i == 2 for i in range(5)), (
                x,
                v,
                part,
            )


@pytest.mark.slow
def test_an_unstable_orbit_is_known_as_one() -> None:
    """With c < 0, outside the model, there are some: the range check is loosened for them.

    `stable` may not be true.
    """
    p = load_scene("fig9").parameters.replace(v2=1000)
    orbit = find_orbit(p, "P32")
    near: tuple[tuple[Any, Any], ...] = tuple(orbit.points)
    for c in range(18, -17, -2):  # along the branch
        other = p.replace(c=0)
        object.__setattr__(other, "c", Fraction(c, 100))
        found = certify_orbit(other, orbit.labels, 1, near)
        rows = found.statement["events"]
        near = tuple(
            (float(Fraction(row["t"][0])), float(Fraction(row["x"][0]))) for row in rows[:-1]
        )
        if rows[0]["target"] != "Omega1":  # it begins with another event than the word
            near = (*near[1:], (near[0][0] + float(orbit.period), near[0][1]))
    assert not found.proven
    assert "parameters out of range" in found.message
    whole = json.loads(json.dumps(found.as_dict() | {"proven": True}))
    del whole["message"]
    judge = weakened(
        verify,
        (('for name in ("c", "k", "FN")', 'for name in ("k", "FN")'),),
    )
    code, answer = judge(whole)
    assert (code, answer.startswith("proven: an unstable orbit P32")) == (0, True), answer
    assert judge(whole | {"stable": True})[0] == 1
    assert judge(whole | {"stable": None})[0] == 0
