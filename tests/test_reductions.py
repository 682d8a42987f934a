"""Other models that are this one.

By substitution, against their own equations, exactly, and from scene files.
"""

from __future__ import annotations

import random
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from cli_runs import run
from other_models import KINDS, TURN, Original, drawn

import symosc
from symosc import Belt, OtherModel, ParameterError, Scene, frequency_response, load_scene, simulate
from symosc.scenes import as_toml, read_scene


@pytest.mark.parametrize(
    "seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.campaign) for seed in range(2, 6))]
)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.quick(8)
def test_a_motion_is_that_of_the_models_own_equation(kind: str, seed: int) -> None:
    model = drawn(kind, seed)
    dice = random.Random(seed)
    t0, x0, v0 = (round(dice.uniform(-2, 2), 3) for _ in range(3))
    end = t0 + 3 * TURN / float(model.Omega)
    motion = simulate(model, t0=t0, x0=x0, v0=v0, t_end=end)
    events, state = Original(model).follow(t0, x0, v0, end)
    assert [event.kind for event in motion.events] == [kind for _, _, kind in events]
    for event, (t, x, _) in zip(motion.events, events, strict=True):
        assert event.t == pytest.approx(t, abs=1e-9, rel=1e-9)
        assert event.x == pytest.approx(x, abs=1e-9, rel=1e-9)
        assert event.theta == pytest.approx((float(model.Omega) * event.t) % TURN, abs=1e-9)
    times = np.linspace(t0, end, 200)
    assert np.abs(motion(times) - np.array([state(t) for t in times]).T).max() < 1e-9


def test_the_substitution_is_an_identity() -> None:
    """Put x = z + w into each model's equation.

    What is left is this oscillator's, with the drive that is computed.
    """
    t, m, c, k, Om, g = sp.symbols("t m c k Omega g", positive=True)
    A0, B0, Y, W, phase, Y_phase, W_phase, angle = sp.symbols(
        "A0 B0 Y W phase Y_phase W_phase angle", real=True
    )
    friction = sp.Function("f")
    z = sp.Function("z")(t)
    for joined in (False, True):
        y = Y * sp.cos(Om * t + Y_phase)
        w = sp.integrate(W * sp.cos(Om * t + W_phase), t) + (y if joined else 0)
        x = z + w
        force = A0 + B0 * sp.cos(Om * t + phase) + m * g * sp.sin(angle)
        rest = (
            m * x.diff(t, 2)
            + c * (x - y).diff(t)
            + k * (x - y)
            - force
            - friction(sp.expand((x - w).diff(t)))
        )
        own = (
            m * z.diff(t, 2)
            + c * z.diff(t)
            + k * z
            - A0
            - m * g * sp.sin(angle)
            - friction(z.diff(t))
        )
        drive = sp.expand(sp.expand_trig(own - rest))
        P, Q = (drive.coeff(part(Om * t)) for part in (sp.cos, sp.sin))
        assert sp.simplify(drive - P * sp.cos(Om * t) - Q * sp.sin(Om * t)) == 0
        model = drawn("all", 3).replace(joined=joined)
        names = {Om: "Omega"} | {symbol: symbol.name for symbol in (P * Q).free_symbols - {Om}}
        values = {symbol: sp.Rational(str(getattr(model, name))) for symbol, name in names.items()}
        P, Q = (sp.N(each.subs(values), 60) for each in (P, Q))
        assert abs(sp.Rational(str(model.parameters.B0)) - sp.sqrt(P**2 + Q**2)) < 1e-38
        assert abs(sp.Rational(str(model.delay * model.Omega)) - sp.atan2(Q, P)) < 1e-38


# -- numbers


def test_what_is_rational_is_exact() -> None:
    joined = OtherModel(m="1/3", c="1/7", k=2, Omega="3/2", FN=1, Y="1/5", joined=True)
    assert joined.exact
    assert joined.delay == 0
    assert Fraction(1, 3) * Fraction(1, 5) * Fraction(9, 4) == joined.parameters.B0
    sine = OtherModel(m=1, k=2, Omega=3, FN=1, Y="1/5", Y_phase="-pi/2")
    assert Fraction(2, 5) == sine.parameters.B0
    assert not sine.exact
    assert (
        abs(
            sine.delay * 3
            - Fraction("1.5707963267948966192313216916397514420985846996875529104874723")
        )
        < 1e-60
    )
    base = OtherModel(m=1, c=3, k=4, Omega=1, FN=1, Y=1)  # 5 cos(t - psi)
    assert base.parameters.B0 == 5
    slope = OtherModel(m=2, k=1, Omega=1, g=10, angle="pi/6")
    assert (10, Fraction("17.32050807568877293527446341505872366943")) == (
        slope.parameters.A0,
        slope.parameters.FN,
    )
    hung = OtherModel(m=2, k=1, Omega=1, FN=1, g=10, angle="pi/2", B0=1)
    assert hung.parameters.A0 == 20
    assert hung.exact
    scene = Scene("s", joined, t0=0, x0=1, v0="1/4", t_end=3)
    assert (scene.x0, scene.v0, scene.start_error) == (Fraction(4, 5), Fraction(1, 4), None)


def test_the_table_of_the_page_has_the_drives() -> None:
    m = 1.5
    c = 0.4
    k = 2.0
    Om = 1.3
    size = 0.7
    numbers = {"m": m, "c": c, "k": k, "Omega": Om, "FN": 1}
    table: list[tuple[dict[str, object], float, float]] = [
        ({"B0": size, "phase": "-pi/2"}, size, np.pi / 2 / Om),
        ({"B0": size, "phase": 0.6}, size, -0.6 / Om),
        ({"Y": size}, size * np.hypot(k, c * Om), -np.arctan(c * Om / k) / Om),
        ({"Y": size, "joined": True}, m * size * Om**2, 0.0),
        ({"W": size}, size * np.hypot(m * Om - k / Om, c), np.arctan2(m * Om - k / Om, -c) / Om),
    ]
    for given, B0, delay in table:
        model = OtherModel(**numbers | given)  # type: ignore[arg-type]
        assert (float(model.parameters.B0), float(model.delay)) == pytest.approx(
            (B0, delay), abs=1e-14
        )


def test_a_pulled_block_has_static_friction() -> None:
    """It is S8 of the references, seen from the floor: it slips after 4 and again after 3 + slip."""
    block = OtherModel(m=1, k=2, Omega=1, FN=1, pull="1/10", belts=[Belt(0, "1/2", mu_s="4/5")])
    slip = (2 * np.pi - 2 * np.arctan(3 * np.sqrt(2) / 2)) / np.sqrt(2)
    ends = [4, 4 + slip, 7 + slip, 7 + 2 * slip]
    motion = simulate(block, t_end=13)
    assert [event.t for event in motion.events] == pytest.approx(ends, abs=1e-12)
    # the spring slackens from 2/5 to 1/10 while the block slips
    gain = 0.1 * slip + 0.3
    assert [event.x for event in motion.events] == pytest.approx(
        [0, gain, gain, 2 * gain], abs=1e-12
    )
    assert [event.v for event in motion.events] == pytest.approx([0] * 4, abs=1e-15)
    assert motion(12.9)[1] == 0
    assert eval(repr(block)) == block
    scene = Scene("pulled", block, t0=0, x0=0, v0=0, t_end=13)
    for explained in (False, True):
        again = read_scene(as_toml(scene, explained), "pulled.toml")
        assert again.original == scene.original
    with pytest.raises(ParameterError, match="static friction of belt 1"):
        block.parameters  # noqa: B018
    for wrong, said in (
        ({"v1": 1}, "v1 = '1': must be omitted if belts are given"),
        ({"mu2": 1}, "mu2 = '1': must be omitted"),
        ({"belts": 3}, "belts = 3"),
        ({"pull": "fast"}, "pull = 'fast'"),
    ):
        with pytest.raises(ParameterError, match=said):
            block.replace(**wrong)


def test_the_phase_of_a_late_start_is_right() -> None:
    """At t0 = 1e8 the position of the base has 40 digits, and a mass that rides on it does so for ever."""
    model = OtherModel(m=1, k=1, Omega=7, FN=1000, Y=1, Y_phase="1/3", joined=True)
    t0 = Fraction(10**8)
    angle = sp.Integer(7 * 10**8) + sp.Rational(1, 3)
    y, rate = (sp.N(each, 60) for each in (sp.cos(angle), -7 * sp.sin(angle)))
    scene = Scene("s", model, t0=t0, x0=str(sp.N(y, 45)), v0=str(sp.N(rate, 45)), t_end=t0 + 2)
    assert abs(scene.x0) < 1e-38
    assert scene.v0 == 0
    assert abs(sp.Rational(str(scene.t0)) - t0 + sp.Rational(str(model.delay))) < 1e-31
    motion = simulate(scene)
    assert set(motion.mode(np.linspace(1e8, 1e8 + 2, 9))) == {"belt1"}


def test_digits_are_those_of_the_doubles() -> None:
    model = drawn("joined wall", 5)
    coarse, fine = (simulate(model, x0=1, t_end=9, digits=digits) for digits in (None, 30))
    assert len(coarse.events) > 2
    for a, b in zip(coarse.events, fine.events, strict=True):
        assert all(
            abs(getattr(a, name) - getattr(b, name)) < 1e-13 for name in ("t", "x", "v", "theta")
        )
        assert a.x_error >= abs(a.x - b.x) / 10
    t = fine.events[-1].t
    x = fine.events[-1].x
    v = fine.events[-1].v
    assert (
        abs(v + model.Omega * model.Y * t.context.sin(model.Omega * t)) < 1e-28
    )  # the wall's velocity
    s, z, u = model.forth(float(t), float(x), float(v))
    assert abs(u) < 1e-13
    assert np.allclose(model.back(s, z, u), [float(t), float(x), float(v)], atol=1e-13)


# -- scenes

FILE = """
name = "wall"
t_end = 60
[model]
Y = 1
Y_phase = "-pi/2"
joined = true
[parameters]
m = 1
k = 1
c = 0.1
Omega = 1.5
FN = 0.5
[start]
t0 = 0
x0 = 0.25
v0 = 1.5
"""


def test_a_scene_file_names_a_model(tmp_path: Path) -> None:
    scene = read_scene(FILE, "wall.toml")
    assert scene.original is not None
    assert scene.original.x0 == Fraction(1, 4)
    for explained in (False, True):
        assert read_scene(as_toml(scene, explained), "wall.toml") == scene
    later = scene.started({"x0": 1, "t_end": "3T"})
    assert later.original is not None
    assert later.original.x0 == 1
    assert later.start_error == scene.start_error
    motion = simulate(later)
    assert motion(0).tolist() == pytest.approx([1, 1.5])
    assert float(motion.t_end) == pytest.approx(3 * TURN / 1.5)
    assert scene.changed(Omega=3).parameters.B0 == 9  # m Y Omega^2
    assert scene.parameters == scene.original.model.oscillator
    assert symosc.find_orbit(scene).parameters == scene.original.model.oscillator
    assert scene.reduced().original is None
    assert scene.reduced().x0 == scene.x0


def test_what_does_not_turn_back_says_so() -> None:
    scene = read_scene(FILE, "wall.toml")
    with pytest.raises(
        ParameterError, match=r"must not be a scene of another model.*scene\.reduced"
    ):
        symosc.sweep(scene, {"Omega": [1, 2]})
    with pytest.raises(ParameterError, match=r"Yphase.*did you mean Y_phase"):
        drawn("all", 1).replace(Yphase=1)
    for given in ({"x0": 1}, {"t_end": -1}):
        with pytest.raises(ParameterError, match="t_end"):
            simulate(drawn("all", 1), **given)


@pytest.mark.parametrize(
    "line",
    [
        "simulate wall.toml --set Y=2",
        "figure wall.toml -o a.svg",
        "orbit wall.toml",
        "orbit wall.toml --response Omega=1:2:3 -o b.svg",
        "grazing wall.toml --map P2 --set Y=2",
        "scenes wall.toml --json",
        "new mine.toml --like wall.toml",
    ],
)
def test_commands_take_such_a_file(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("wall.toml").write_text(FILE)
    done = run(*line.split())
    assert done.exit_code == 0, done.output
    reduced = line.split()[0] in ("orbit", "grazing") and "--response" not in line
    assert ("about the oscillator that it is" in done.stderr) == reduced
    if line.startswith("new"):
        assert load_scene("mine.toml").original == load_scene("wall.toml").original
    if "--response" in line:
        assert len(done.stdout.splitlines()) == 5
        found = frequency_response("wall.toml", {"Omega": "1:2:3"})
        assert f"{found.amplitude[1]:.8g}" in done.stdout
