"""Atlases: proven words against the engine's, forged files, and what an earlier call has left."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from copy import deepcopy
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from parameter_sets import AT_REST
from samples import sample_of

import symosc.certificates.atlas as atlases
import symosc.certificates.verify_orbits as checker
from symosc import Atlas, ParameterError, atlas, certify, find_orbit
from symosc.certificates.balls import OscillatorInBalls, ball
from symosc.certificates.verify_orbits import BallOscillator as InBalls
from symosc.certificates.verify_orbits import Flight, PartOfFlight, judge, marks
from symosc.model import PARAMETER_NAMES, by_name
from symosc.orbits.border import borders_between

PLANE = {"Omega": ("0.95", "1.05"), "FN": ("0.8", "1.1")}


@pytest.fixture(autouse=True)
def _few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(atlases, "GRID", 3)


@pytest.fixture(scope="module")
def small() -> Atlas:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(atlases, "GRID", 3)
        return atlas(AT_REST, PLANE, prove=0.4, workers=1)


def contents(plane: Atlas) -> dict[str, Any]:
    about = {"format": "symosc certificate 1", "kind": "atlas", "proven": True}
    return json.loads(json.dumps(about | plane.statement()))


def test_the_parts_of_an_atlas_fit_together(small: Atlas) -> None:
    assert 0.4 <= small.proven < 1
    assert {region.word for region in small.regions} == {"P3121", "rest"}
    rest = next(region for region in small.regions if region.word == "rest")
    assert rest.proven == pytest.approx(1 / 3)  # FN >= |B0|/mu1, and nothing else
    assert small.word_at(Omega=1, FN=1) == small.word_at(Omega=1, FN="1.05") == "rest"
    assert certify(small).proven


def differences(plane: Atlas, count: int, seed: int) -> tuple[int, list[tuple[float, float]]]:
    """Return how many random points are in proven boxes, and those where the settled motion has another word."""
    rng = random.Random(seed)
    inside = 0
    wrong = []
    for _ in range(count):
        x, y = (round(rng.uniform(float(low), float(high)), 9) for low, high in plane.range)
        at = Fraction(str(x)), Fraction(str(y))
        boxes = [
            b
            for b in plane.boxes
            if all(low <= v <= high for v, (low, high) in zip(at, b.range, strict=True))
        ]
        if not boxes or boxes[0].word == "rest":
            continue
        inside += 1
        orbit = find_orbit(plane.parameters.replace(**dict(zip(plane.over, at, strict=True))))
        if boxes[0].word != atlases.canonical(orbit.labels):
            wrong.append((x, y))
    return inside, wrong


def test_proven_words_are_those_of_the_settled_motions(small: Atlas) -> None:
    inside, wrong = differences(small, 12, 1)
    assert inside
    assert not wrong


@pytest.mark.slow
def test_borders_that_the_grid_meets() -> None:
    """A part of the plane below, at a third of the work."""
    plane = atlas(AT_REST, {"Omega": ("0.3", "0.45"), "FN": ("0.05", "0.2")}, workers=1)
    assert sorted(
        ("|".join(sorted(each.words, key=str)), each.sliding) for each in plane.borders
    ) == [
        ("P231321|P3121", "switching-sliding"),
        ("P231321|P32", "grazing-sliding"),
        ("P3121|P32", "crossing-sliding"),
    ]
    assert plane.special == ()


@pytest.mark.campaign
def test_borders_that_the_grid_misses_are_found() -> None:
    plane = atlas(AT_REST, {"Omega": ("0.3", "0.6"), "FN": ("0.05", "0.3")}, workers=1)
    assert sorted(
        ("|".join(sorted(each.words, key=str)), each.sliding) for each in plane.borders
    ) == [
        ("P231321|P3121", "switching-sliding"),
        ("P231321|P32", "grazing-sliding"),
        ("P3121|P31312121", "adding-sliding"),
        ("P3121|P31312121", "grazing-sliding"),
        ("P3121|P32", "crossing-sliding"),
        ("P3121|P32", "crossing-sliding"),  # a corner of 0.004 by 0.0035
    ]
    assert [point.kind for point in plane.special] == ["degenerate crossing-sliding"]


@pytest.mark.slow
@sample_of(1, 40)
def test_borders_explain_the_changes_of_words_in_random_planes(count: int) -> None:
    for seed in range(count):
        rng = random.Random(seed)
        v1 = rng.choice([0, round(rng.uniform(-1, 1), 2)])
        given: dict[str, Any] = {
            name: round(rng.uniform(0.4, 2), 2) for name in ("B0", "k", "Omega", "FN", "mu2")
        }
        p = AT_REST.replace(
            v1=v1,
            v2=v1 + rng.choice([0.5, 1, 3]),
            A0=round(rng.uniform(-1, 1), 2),
            c="0.3",
            **given,
        )
        names = rng.choice(
            [("Omega", "FN"), ("B0", "A0"), ("k", "m"), ("mu1", "Omega"), ("c", "B0")]
        )
        limits = {name: sorted(float(getattr(p, name)) * by for by in (0.6, 1.4)) for name in names}
        if "A0" in names:
            limits |= {"A0": [-1.0, 1.0]}
        else:
            limits |= {}
        plane = atlas(p, {name: (low, high) for name, (low, high) in limits.items()}, workers=1)
        for _ in range(20):
            a = [rng.uniform(*limits[name]) for name in names]
            b = [
                0.8 * value + 0.2 * rng.uniform(*limits[name])
                for value, name in zip(a, names, strict=True)
            ]
            words = [atlases.ParameterPlane(p, names, plane.range).word(point) for point in (a, b)]
            if words[0] != words[1]:
                assert atlases.border_known(plane.borders, (*a, words[0]), (*b, words[1])), (
                    seed,
                    a,
                    b,
                    words,
                )


@pytest.mark.campaign
def test_a_proven_plane_against_2000_motions() -> None:
    plane = atlas(AT_REST, {"Omega": ("0.3", 2), "FN": ("0.05", 1)}, prove=0.95, workers=1)
    inside, wrong = differences(plane, 2000, 2)
    assert inside > 1800
    assert not wrong
    assert judge(contents(plane))[0] == 0


@pytest.mark.parametrize(
    ("changes", "over"),
    [
        pytest.param(  # no symmetry
            {"v1": "0.2", "mu2": "0.3", "v2": 1},
            {"Omega": ("0.998", "1.0"), "FN": ("0.298", "0.3")},
            marks=pytest.mark.slow,
        ),
        ({"c": 3}, {"Omega": ("0.98", "1.02"), "B0": ("2", "2.05")}),  # overdamped
        pytest.param(  # both belts
            {"v1": -1, "v2": 1, "mu2": 1, "FN": "0.2"},
            {"Omega": ("0.98", "0.99"), "m": ("1.06", "1.07")},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_other_oscillators(changes: dict[str, Any], over: dict[str, Any]) -> None:
    plane = atlas(AT_REST.replace(**changes), over, prove=0.9, seconds=20, workers=1)
    assert plane.proven >= 0.9
    assert judge(contents(plane))[0] == 0
    assert not differences(plane, 4, 3)[1]


def first(data: dict[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = next(row for row in data["boxes"] if row["word"] != "rest")
    return row


def at_rest(data: dict[str, Any]) -> dict[str, Any]:
    row: dict[str, Any] = next(row for row in data["boxes"] if row["word"] == "rest")
    return row


def another_word(data: dict[str, Any]) -> None:
    row = first(data)
    row.update(word="P32", phases=row["phases"][::2], x=row["x"][::2])


def a_word_at_rest(data: dict[str, Any]) -> None:
    at_rest(data).update({name: first(data)[name] for name in ("word", "phases", "x")})


def open_box_at(data: dict[str, Any], corner: list[Fraction]) -> None:
    """Move an open box, so that the areas still add up."""
    box = data["open"][0]
    sides = [Fraction(high) - Fraction(low) for low, high in box]
    box[:] = [[str(low), str(low + side)] for low, side in zip(corner, sides, strict=True)]


def left_out_with_its_area_counted(data: dict[str, Any]) -> None:
    sides = [Fraction(high) - Fraction(low) for low, high in data["open"][0]]
    ends = zip(first(data)["range"], data["range"], sides, strict=True)
    open_box_at(
        data, [min(Fraction(low), Fraction(high) - side) for (low, _), (_, high), side in ends]
    )


def overlapping(data: dict[str, Any]) -> None:
    """Let a box of rest, and what is open, lie a little over others, so that the areas still add up."""
    for box, by in ((at_rest(data)["range"], -1), (data["open"][0], 1)):
        box[1] = [str(Fraction(end) + by * Fraction(1, 10**6)) for end in box[1]]


def a_shifted_point(data: dict[str, Any]) -> None:
    """Move a point of the border of rest into a box of P3121."""
    row = first(data)["range"]
    data["found"]["borders"][0]["points"][7] = [
        sum(float(Fraction(end)) for end in side) / 2 for side in row
    ]


FORGERIES: list[Callable[[dict[str, Any]], object]] = [
    overlapping,
    a_shifted_point,
    lambda it: it["boxes"].pop(),
    lambda it: first(it).update(word="rest", phases=[], x=[]),
    lambda it: it.update(share="99/100"),
    left_out_with_its_area_counted,
    lambda it: open_box_at(it, [Fraction(high) for _, high in it["range"]]),  # beyond the range
    lambda it: it["open"].pop(),
]


def test_forged_atlases_are_refused(small: Atlas) -> None:
    data = contents(small)
    assert judge(data)[0] == 0
    for i, forge in enumerate(FORGERIES):
        forged = deepcopy(data)
        forge(forged)
        assert judge(forged)[0] == 1, i


@pytest.fixture(params=[48, pytest.param(checker.MOST_BOX_PARTS, marks=pytest.mark.campaign)])
def parts(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    """Let the checker divide a box into so many parts.

    It divides a false box as often as it may; 48 parts reach a tenth of a millionth of its area.
    """
    monkeypatch.setattr(checker, "MOST_BOX_PARTS", request.param)
    return int(request.param)


@pytest.mark.slow
@pytest.mark.usefixtures("parts")
@pytest.mark.parametrize("forge", [a_word_at_rest, another_word])
def test_a_word_that_is_another_one_is_refused_in_all_parts(
    small: Atlas, forge: Callable[[dict[str, Any]], None]
) -> None:
    data = contents(small)
    forge(data)
    assert judge(data)[0] == 1


def test_a_second_call_takes_up_the_first(tmp_path: Path) -> None:
    path = tmp_path / "plane.json"
    before = atlas(AT_REST, PLANE, prove=0.35, workers=1, path=path)
    after = atlas(AT_REST, PLANE, prove=round(before.proven + 0.02, 6), workers=1, path=path)
    assert after.proven > before.proven >= 0.35
    assert (
        [each.words for each in after.borders]
        == [each.words for each in before.borders]
        == [("P3121", "rest")]
    )
    assert set(before.boxes[:1]) <= {
        box._replace(points=before.boxes[0].points) for box in after.boxes
    }
    with pytest.raises(ParameterError, match="another plane"):
        atlas(AT_REST, PLANE | {"FN": ("0.8", 1)}, path=path)
    path.write_text("{}")
    with pytest.raises(ParameterError, match="no file of an atlas"):
        atlas(AT_REST, PLANE, path=path)


@pytest.mark.parametrize(
    ("how", "named"),
    [
        ({"over": {"Omega": (1, 2)}}, "two parameters"),
        ({"over": {"Omega": (2, 1), "FN": (0, 1)}}, "lowest"),
        ({"over": {"c": (0, 1), "FN": (0, 1)}}, "c = 0"),
        ({"over": PLANE, "prove": 2}, "prove"),
        ({"over": PLANE, "seconds": 0}, "seconds"),
    ],
)
def test_bad_arguments(how: dict[str, Any], named: str) -> None:
    with pytest.raises(ParameterError, match=named):
        atlas(AT_REST, **how)


def test_the_figure_and_the_page(small: Atlas) -> None:
    (axes,) = small.plot().axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("$\\Omega$", "$F_N$")
    page = small._repr_html_()
    assert page is not None
    assert "P3121" in page
    with pytest.raises(ParameterError, match="must be between"):
        small.word_at(Omega=2, FN=1)


def one_box(word: str, box: Any, phases: list[str], x: list[str], **changes: Any) -> dict[str, Any]:
    """Return a file with one box in the plane of Omega and FN."""
    row = {"word": word, "range": box, "phases": phases, "x": x}
    about = {
        "format": "symosc certificate 1",
        "kind": "atlas",
        "proven": True,
        "over": ["Omega", "FN"],
        "open": [],
    }
    parameters = AT_REST.replace(**changes).as_dict()
    return about | {
        "parameters": parameters,
        "range": box,
        "share": "1",
        "boxes": [row],
        "found": {},
    }


@pytest.mark.slow
@pytest.mark.usefixtures("parts")
def test_a_box_over_its_border_is_refused() -> None:
    (border,) = borders_between(
        AT_REST.replace(Omega="1.655", FN="0.5"),
        AT_REST.replace(Omega="1.655", FN="0.7"),
        ("Omega", "FN"),
        {"Omega": (1, 2), "FN": ("0.3", 1)},
        step="0.05",
    )
    lowest = min(border.at(Omega=end)[0] for end in ("1.65", "1.66"))
    for over, code in ((-1e-6, 0), (1e-6, 1)):
        data = p32()
        data["boxes"][0]["range"] = data["range"] = [
            ["1.65", "1.66"],
            ["0.58", repr(lowest + over)],
        ]
        assert judge(data)[0] == code, over


@pytest.mark.parametrize(
    ("changes", "low", "code"), [({}, "1", 0), ({}, "0.999999999999", 1), ({"v1": "1e-30"}, "1", 1)]
)
def test_rest_is_decided_exactly(changes: dict[str, Any], low: str, code: int) -> None:
    assert judge(one_box("rest", [["1", "2"], [low, "2"]], [], [], **changes))[0] == code


GHOST_PHASES = [0.51688145, 2.789497, 3.6584741, 5.9310897]
GHOST_X = ["0.9368645", "-0.9368645", "-0.9368645", "0.9368645"]
P32_BOX = [["1.65", "1.7"], ["0.4", "0.5"]]


def p32(**changes: Any) -> dict[str, Any]:
    points = find_orbit(AT_REST.replace(Omega="1.675", FN="0.45"), "P32").points[:2]
    return one_box(
        "P32",
        P32_BOX,
        [str(1.675 * float(t)) for t, _ in points],
        [str(float(x)) for _, x in points],
        **changes,
    )


def test_the_mirror_image_crosses_a_belt_without_friction() -> None:
    from symosc.certificates.plane import NotInBox, Surface, box_arithmetic

    assert judge(p32())[0] == 0
    assert judge(p32(v2="0.5"))[0] == 1  # there the word is P7682
    near = AT_REST.replace(v2="0.5")
    box = ((Fraction("1.65"), Fraction("1.7")), (Fraction("0.4"), Fraction("0.5")))
    names = ("Omega", "FN")
    row = p32()["boxes"][0]
    for labels, first in ((("P2", "P3"), 0), (("P3", "P2"), 1)):
        flights = atlases._flights(labels, near, names)
        points = [
            (float(row["phases"][i % 2]) + 6.283185307 * (i > 1), float(row["x"][i % 2]))
            for i in (first, first + 1)
        ]
        surface = Surface(near, names, box, flights, flights.unknowns(1.675, points))
        with pytest.raises(NotInBox), box_arithmetic():
            surface.prove()


@pytest.mark.slow
@pytest.mark.usefixtures("parts")
def test_a_stick_that_slips_is_found_at_all_phases() -> None:
    box = [["0.313125", "0.3134375"], ["0.0625", "0.06375"]]  # there the word is P31312121
    phases = [repr(each - 400 * 6.283185307179586) for each in GHOST_PHASES]
    assert judge(one_box("P3121", box, phases, GHOST_X))[0] == 1


@pytest.mark.parametrize("slips", [False, True])
def test_a_flight_obeys_the_equation_of_motion(slips: bool) -> None:
    """By differences; with a damper, and a belt that moves."""
    p = dict(zip(PARAMETER_NAMES, (2, 3, 5, 1, 7, 2, 4, 9, 0.25, 0.5, 8), strict=True))
    e = InBalls({name: arb(value) for name, value in p.items()})
    step = 1e-4
    flight = Flight((1, 2, 1), 0, slips, 0)
    if slips:
        u = [arb(0.5), arb(1.5)]
    else:
        u = [arb(0.5), arb(-1), arb(1.5)]
    for s in (0.3, 1.5):
        (x, v, a), before, after = (flight.after(e, u, arb(s + by * step)) for by in (0, -1, 1))
        assert abs(float(after[0] - before[0]) / (2 * step) - float(v)) < 1e-6
        assert abs(float(after[1] - before[1]) / (2 * step) - float(a)) < 1e-6
        assert abs(float(x)) + abs(float(v)) > 0.1


def test_a_share_is_rounded_down_and_a_rest_has_no_switchings() -> None:
    data = one_box("rest", [["1", "2"], ["1", "2"]], [], [])
    data.update(
        range=[["1", "2"], ["1", "2.0000001"]],
        open=[[["1", "2"], ["2", "2.0000001"]]],
        share="10000000/10000001",
    )
    code, answer = judge(data)
    assert code == 0
    assert "0.999999 of the area" in answer
    data["boxes"][0].update(phases=["1"], x=["1"])
    assert judge(data)[0] == 2


def test_a_plane_without_a_damper_is_refused() -> None:
    rest = [["1", "2"], ["1", "2"]]
    assert judge(one_box("rest", rest, [], []))[0] == 0
    assert judge(one_box("rest", rest, [], [], c=0))[0] == 1


def test_long_words_end_at_the_limit_of_work() -> None:
    phases = [str(j * 0.314) for j in range(20)]
    x = ["0.1"] * 20
    code, answer = judge(one_box("P" + "32" * 10, P32_BOX, phases, x), steps=2_000)
    assert code == 1
    assert "steps" in answer


def test_a_stiff_spring_takes_no_memory() -> None:
    assert len(marks([PartOfFlight(True, arb(0), arb(1))], arb("1e-5"))) < 20
    stiff = AT_REST.replace(k="1e20")
    o = OscillatorInBalls(stiff, by_name(stiff, ball))
    flights = atlases._flights(("P2", "P1", "P3", "P1"), stiff, ("Omega", "FN"))
    assert flights.cuts(o, flights.legs[0], [arb(1), arb(1)]) is None
