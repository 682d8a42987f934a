"""The page of `symosc explore`.

What it shows is what `simulate` says, and nothing that it is sent makes it fail.
"""

from __future__ import annotations

import json
import random
from dataclasses import replace
from fractions import Fraction
from math import atan, hypot, pi
from urllib.parse import urlsplit

import numpy as np
import pytest
from explorer_states import FIG5, random_state
from exploring import ask

from symosc import (
    Belt,
    Oscillator,
    ParameterError,
    Scene,
    grazing_window,
    load_scene,
    scene_names,
    simulate,
)
from symosc.plot.explorer.answers import (
    FIELDS,
    KINETIC,
    MOST_SHOWN_EVENTS,
    RINGS,
    TABLE_ROWS,
    answer,
    link_of,
    notes_of,
    read_link,
    scene_of,
    settled,
    state_of,
)
from symosc.scenes import as_toml, read_scene

# -- answers ----------------------------------------------------------------------------------------------------------


STATES = [
    state_of(load_scene(name)) for name in ("fig5", "fig6", "fig8", "fig9", "fig10", "fig7-exact")
]
STATES += [random_state(random.Random(seed)) for seed in range(6)]
BAD_TEXTS = [
    "",
    "0",
    "-1",
    "1e50",
    "1e-50",
    "1e51",
    "nan",
    "1/0",
    "½",
    "1_000",
    "<b>",
    "0x10",
    "é" * 90,
    "9" * 5000,
]


def shown(state: dict[str, str]) -> dict:
    content = answer(link_of(state), FIG5)
    assert content["errors"] == {}, content["errors"]
    return json.loads(json.dumps(content, allow_nan=False))


@pytest.mark.parametrize("state", STATES[::3])
def test_word_and_events_are_those_of_simulate(state: dict[str, str]) -> None:
    content = shown(state)
    trajectory = simulate(scene_of(state)[0], max_events=MOST_SHOWN_EVENTS)
    assert (content["word"], content["status"]) == (trajectory.word, trajectory.status)
    assert content["count"] == len(trajectory.events)
    for row, event in zip(content["table"], trajectory.events[:TABLE_ROWS], strict=True):
        assert (row[0], row[5]) == (event.kind, str(event.boundary))
        assert [float(text) for text in row[1:4]] == pytest.approx(
            [event.t, event.x, event.v], rel=1e-7, abs=1e-8
        )
    marks = content["sources"]["marks"]
    assert marks["t"][1:] == pytest.approx([event.t for event in trajectory.events], rel=1e-8)
    shapes = {"stick": "circle", "slip": "square", "cross": "triangle", "graze": "star"}
    assert marks["marker"][1:] == [shapes[event.kind] for event in trajectory.events]


@pytest.mark.parametrize("state", STATES[1::3])
def test_curves_are_the_motion_and_its_forces(state: dict[str, str]) -> None:
    content = shown(state)
    trajectory = simulate(scene_of(state)[0], max_events=MOST_SHOWN_EVENTS)
    curves = content["sources"]["curves"]
    ranges = content["ranges"]
    t = np.clip(curves["t"], trajectory.t_start, trajectory.t_end)
    expected = {"x": trajectory(t)[0], "v": trajectory(t)[1]}
    expected |= {f"F{domain}": trajectory.force(domain, t) for domain in (1, 2, 3)}
    for name, values in expected.items():
        assert curves[name] == pytest.approx(
            values, abs=1e-5 * max(np.ptp(values), 1e-3 * np.abs(values).max())
        )
        low, high = ranges["F" if name[0] == "F" else name]
        assert low <= min(curves[name]) <= max(curves[name]) <= high
    sticks = content["sources"]["sticks"]
    on_belts = [segment for segment in trajectory.segments if segment.mode.startswith("belt")]
    assert sticks["since"] == pytest.approx([segment.t_start for segment in on_belts], rel=1e-8)
    assert sticks["until"] == pytest.approx([segment.t_end for segment in on_belts], rel=1e-8)
    assert len(set(sticks["shade"])) == len({segment.mode for segment in on_belts})


@pytest.mark.parametrize("state", STATES[2::3])
def test_the_dial_has_the_windows(state: dict[str, str]) -> None:
    content = shown(state)
    scene = scene_of(state)[0]
    assert scene is not None
    arcs = content["sources"]["arcs"]
    for mapping, _, _, said, _ in content["windows"]:
        window = grazing_window(scene.parameters, mapping)
        mine = [i for i, name in enumerate(arcs["map"]) if name == mapping]
        length = sum(arcs["high"][i] - arcs["low"][i] for i in mine)
        assert length == pytest.approx(sum(high - low for low, high, *_ in window.intervals))
        assert len(mine) <= 1  # through the phase 0 as well
        assert (said == "none") == (not mine)
        for i in mine:
            assert arcs["radius"][i] == RINGS[window.place.boundary]
            middle = (arcs["low"][i] + arcs["high"][i]) / 2 % (2 * pi)
            assert window.contains(middle) or length > 6.28
    contacts = content["sources"]["contacts"]
    phases = np.arctan2(contacts["y"], contacts["x"]) % (2 * pi)
    assert phases == pytest.approx(np.array(contacts["phase"]) % (2 * pi), abs=1e-9)
    assert {round(hypot(x, y), 2) for x, y in zip(contacts["x"], contacts["y"], strict=True)} <= {
        0.47,
        0.85,
    }


def test_no_input_makes_it_fail() -> None:
    rng = random.Random(3)
    queries = ["", "&&&", "k=", "scene=<script>", "%ff=%ff", "start_error=1", "k=1&k=2"]
    for _ in range(60):
        changes = {
            name: rng.choice(BAD_TEXTS) for name in rng.sample(list(FIELDS), rng.randint(1, 3))
        }
        queries.append(link_of(state_of(FIG5) | changes))
    for query in queries:
        content = answer(query, FIG5)
        json.dumps(content, allow_nan=False)
        assert content["errors"] or content["count"] >= 0
        assert all(said and "\n" not in said for said in content["errors"].values())
        assert content["link"].startswith("scene=")


# -- static friction --------------------------------------------------------------------------------------------------


BELT = Belt("1/5", mu="1/2", mu_s=1)
ONE_BELT = Scene(
    "mine", Oscillator(m=1, c=0, k=1, belts=[BELT]), t0=0, x0=0, v0="1/5", t_end=40, source="here"
)


def test_static_friction_is_followed() -> None:
    """The motion is that of the oscillator with these belts; it differs from that without."""
    p = FIG5.parameters
    law = Oscillator(
        m=1, c=1, k=1, A0=-15, B0=10, Omega=1, FN="9.81", belts=[Belt(1, "0.8", mu_s=2), Belt(5, "0.6")]
    )  # fmt: skip
    content = shown(state_of(FIG5) | {"mu_s1": "2"})
    expected = simulate(law, t_end=40)
    assert content["word"] == expected.word != simulate(p, t_end=40).word
    times = [float(row[1]) for row in content["table"]]
    assert times == pytest.approx([event.t for event in expected.events], rel=1e-7)
    same = shown(state_of(FIG5) | {"mu_s1": "4/5", "mu_s2": " "})
    assert same["name"] == "fig5"  # static friction equal to kinetic friction is the scene itself


def test_one_belt_is_shown_with_a_second_one_far_away() -> None:
    content = shown(state_of(ONE_BELT))
    expected = simulate(ONE_BELT)
    times = [float(row[1]) for row in content["table"]]
    assert times == pytest.approx([event.t for event in expected.events], rel=1e-7)
    assert content["belts"]["drawn"] == [True, False]
    assert any("one belt" in note for note in notes_of(ONE_BELT))
    assert notes_of(FIG5) == []


def test_the_settled_motion_of_a_belt_is_its_limit_cycle() -> None:
    """Its period has a closed form, and so has its largest position."""
    found = settled(link_of(state_of(ONE_BELT)), FIG5)
    period = 2 * 0.5 / 0.2 + 2 * (pi - atan(0.5 / 0.2))
    assert f"period {period:.6g} s" in found["text"]
    assert max(found["curve"]["x"]) == pytest.approx(0.5 + hypot(0.5, 0.2), abs=1e-3)


@pytest.mark.parametrize(
    ("text", "allowed"), [("0.7", "at least mu1"), ("x", "not a number"), ("-1", "at least")]
)
def test_static_friction_that_is_wrong_is_said(text: str, allowed: str) -> None:
    content = answer(link_of(state_of(FIG5) | {"mu_s1": text}), FIG5)
    assert list(content["errors"]) == ["mu_s1"]
    assert allowed in content["errors"]["mu_s1"]


def test_laws_without_fields_are_refused(address: str) -> None:
    laws = (
        [Belt(1, curve=[(0, 1), (1, "1/2")])],
        [Belt(1, 1, slope=1)],
        [Belt(0, 1), Belt(1, 1), Belt(2, 1)],
    )
    for belts in laws:
        scene = replace(ONE_BELT, parameters=Oscillator(m=1, c=0, k=1, belts=belts))
        with pytest.raises(ParameterError, match="symosc simulate and symosc figure follow"):
            state_of(scene)
        response, text = ask(address, "/scene", as_toml(scene).encode())
        assert response.status == 200
        assert "follow" in json.loads(text)["error"]
    _, text = ask(address, "/scene", as_toml(ONE_BELT).encode())
    assert json.loads(text)["state"] == state_of(ONE_BELT)


# -- texts, links and files -------------------------------------------------------------------------------------------


def test_a_link_and_a_file_have_the_whole_state() -> None:
    rng = random.Random(1)
    for state in [
        *(state_of(load_scene(name)) for name in scene_names()),
        *(random_state(rng) for _ in range(20)),
        *(random_state(rng) | {"mu_s1": "31/2"} for _ in range(3)),
        *(random_state(rng) | {"mu_s1": "20.5", "mu_s2": "1e2"} for _ in range(3)),
    ]:
        scene, errors = scene_of(state)
        assert scene is not None, (state, errors)
        assert read_link(link_of(state), FIG5) == (state, [])
        again, _ = scene_of(state_of(read_scene(as_toml(scene), "file")))
        assert again == scene
        for field in FIELDS:
            text = state_of(scene)[field]
            if field in KINETIC and not state[field]:
                assert text == ""
            else:
                assert field == "periods" or Fraction(text) == Fraction(state[field].strip())
    for name in scene_names():
        assert scene_of(state_of(load_scene(name))) == (load_scene(name), {})


# -- the server -------------------------------------------------------------------------------------------------------


GOOD = as_toml(load_scene("fig5"))


def test_the_page_has_the_numbers_of_its_link(address: str) -> None:
    response, text = ask(address, "/?k=4%2F5&scene=%3Cscript%3Ealert(1)")
    assert response.status == 200
    assert 'value="4/5"' in text
    assert "<script>alert" not in text
    assert "http" not in text.replace("http-equiv", "")  # nothing is loaded from elsewhere
    policy = response.headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'self'")


@pytest.mark.parametrize(
    "path", ["/", "/answer", "/page.js", "/scene.toml", "/scene.toml?k=x", "/nothing"]
)
def test_no_other_page_may_frame_an_answer(path: str, address: str) -> None:
    headers = ask(address, path)[0].headers
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers.get_all("Content-Security-Policy") == [headers["Content-Security-Policy"]]
    assert (headers["X-Frame-Options"], headers["X-Content-Type-Options"]) == ("DENY", "nosniff")


def test_a_foreign_host_is_refused_with_the_same_guards(address: str) -> None:
    response, _ = ask(address, "/", Host="example.org")
    assert (response.status, response.headers["X-Frame-Options"]) == (403, "DENY")


def test_only_this_machine_is_answered(address: str) -> None:
    assert urlsplit(address).hostname == "127.0.0.1"
    port = urlsplit(address).port
    assert ask(address, "/answer", Host=f"localhost:{port}")[0].status == 200
    assert ask(address, "/answer", Host="127.0.0.1")[0].status == 200
    for name in (f"example.org:{port}", "example.org", f"127.0.0.1.example.org:{port}", ""):
        assert ask(address, "/answer", Host=name)[0].status == 403
        assert ask(address, "/scene", b"", Host=name)[0].status == 403


def test_only_its_own_page_may_send_it_files(address: str) -> None:
    own = address.rstrip("/")
    assert ask(address, "/scene", GOOD.encode(), Origin=own)[0].status == 200
    for origin in (
        "http://example.org",
        "null",
        "https" + own[4:],
        "http://127.0.0.1:1",
        f"{own}.example.org",
    ):
        assert ask(address, "/scene", GOOD.encode(), Origin=origin)[0].status == 403
        assert ask(address, "/answer", Origin=origin)[0].status == 403
    picture = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"}
    assert ask(address, "/answer", **picture)[0].status == 403
    assert (
        ask(address, "/", **picture | {"Sec-Fetch-Mode": "navigate"})[0].status == 200
    )  # a link to it


def test_a_scene_file_goes_out_and_comes_in(address: str) -> None:
    response, text = ask(address, f"/scene.toml?{link_of(state_of(load_scene('fig9-orbit')))}")
    assert "attachment" in response.headers["Content-Disposition"]
    assert read_scene(text, "file") == load_scene("fig9-orbit")
    _, back = ask(address, "/scene", text.encode())
    assert json.loads(back)["state"] == state_of(load_scene("fig9-orbit"))
    for wrong in ("x", "%CF%83", "%0D%0AX:1"):
        assert ask(address, f"/scene.toml?k={wrong}")[0].status == 400


def test_a_bad_scene_file_is_one_clear_line(address: str) -> None:
    for content in (
        b"",
        b"\xff\xfe",
        b"x" * 200_000,
        b"[[[",
        GOOD.replace("m = 1\n", "m = -1\n").encode(),
    ):
        response, text = ask(address, "/scene", content)
        said = json.loads(text)["error"]
        assert response.status == 200
        assert said
        assert "\n" not in said
