"""Verdicts that were wrong: belts that are never met, positions alone, ends at events, lists,
matrices, chatter.
"""

from __future__ import annotations

from math import cos
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from excerpts import crosscheck
from scipy.integrate import solve_ivp
from scipy.io import savemat
from scipy.optimize import brentq

from symosc import CrossCheck, Parameters, Scene, load_scene, simulate
from symosc.crosschecks import velocities, verdict
from symosc.crosschecks.steps import StepEvents

# -- a belt that is never met ----------------------------------------------------------------------

ONE_BELT = Parameters(m=1, c=0, k=1, A0=0, B0=1, Omega=2, v1=0, v2=3, mu1=1, mu2=0, FN="0.1")
FAR = [3, 100, 10**6, 10**9]
TIMES = np.linspace(0, 20, 1001)


def of(p: Parameters, t: np.ndarray = TIMES) -> np.ndarray:
    """Return x, v of the motion from x = 1 at rest."""
    return np.asarray(simulate(p, t0=0, x0=1, v0=0, t_end=20)(t))


def findings(check: CrossCheck) -> tuple[Any, ...]:
    """Return what may not depend on a belt that is never met."""
    counts = [len(part) for part in (check.matched, check.missed, check.invented, check.unresolved)]
    faults = [(fault.step, fault.reason) for fault in check.faults]
    return check.ok, check.scales, counts, faults, check.limits.tolist(), check.allowed.tolist()


def wrong_of_one_belt() -> dict[str, np.ndarray]:
    right = of(ONE_BELT)
    frozen = np.zeros((2, len(TIMES)))
    frozen[0, 0] = 1.0
    return {
        "frozen": frozen,
        "no friction": of(ONE_BELT.replace(mu1=0)),
        "a jump": right + 1e-4 * (TIMES > 7),
        "chatter": right + [[0], [1e-3]] * (-1.0) ** np.arange(len(TIMES)),
    }


@pytest.mark.parametrize("kind", wrong_of_one_belt())
def test_a_belt_that_is_never_met_hides_no_fault(kind: str) -> None:
    states = wrong_of_one_belt()[kind]
    near, *far = (crosscheck(ONE_BELT.replace(v2=v2), TIMES, *states) for v2 in FAR)
    assert not near.ok
    for check in far:
        assert findings(check) == findings(near)


@pytest.mark.parametrize("shape", ["columns", "positions", "decimals"])
def test_a_belt_that_is_never_met_blames_nothing(shape: str) -> None:
    x, v = of(ONE_BELT)
    columns = {"columns": (x, v), "positions": (x,), "decimals": (np.round(x, 4), np.round(v, 4))}
    near, *far = (crosscheck(ONE_BELT.replace(v2=v2), TIMES, *columns[shape]) for v2 in FAR)
    assert near.ok, near.summary()
    # The units are those of the motion: its largest |x| and |v|.
    assert near.scales == pytest.approx(np.max(np.abs([x, v]), axis=1), rel=1e-3)
    for check in far:
        assert findings(check) == findings(near)


@pytest.mark.parametrize("v2", FAR)
def test_events_of_a_users_own_function_are_no_contacts(v2: int) -> None:
    """An event x = 0, of which one may happen on a belt: in a stick, where v is the belt's
    speed.
    """
    p = ONE_BELT.replace(v2=v2)
    exact = simulate(p, t0=0, x0=1, v0=0, t_end=20)
    states = of(p)
    passes = np.flatnonzero(states[0, :-1] * states[0, 1:] < 0.0)
    zeros = [brentq(lambda t: exact(t)[0], TIMES[i], TIMES[i + 1], xtol=1e-14) for i in passes]
    assert len(zeros) == 6
    result = SimpleNamespace(
        t=TIMES, y=states, t_events=[zeros], y_events=[exact(zeros).T], success=True
    )
    assert crosscheck(p, result).ok
    stick = next(part for part in exact.segments if part.mode == "belt1")
    inside = [float(stick.t_start + stick.t_end) / 2]
    result.t_events = [inside]
    result.y_events = [exact(inside).T]
    assert crosscheck(p, result).ok


def test_a_motion_at_rest_has_units() -> None:
    p = ONE_BELT.replace(B0=0, FN=10)
    x = np.ones_like(TIMES)
    assert crosscheck(p, TIMES, x, 0 * x).ok
    assert not crosscheck(p, TIMES, x, 0 * x + 1.234567e-6).ok
    assert not crosscheck(p, TIMES, x + 1.234567e-6 * (TIMES > 3), 0 * x).ok
    assert crosscheck(p, TIMES, 0 * x, 0 * x).ok


# -- positions alone -------------------------------------------------------------------------------


@pytest.mark.full(3)
@pytest.mark.parametrize(
    "name",
    [
        "fig7",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("fig5", "fig6", "fig8", "fig9", "fig10")
        ),
    ],
)
def test_positions_at_any_spacing(name: str) -> None:
    """Positions of the exact motion, as close together at its events as the steps of scipy's
    solve_ivp.
    """
    rng = np.random.default_rng(5)
    scene = load_scene(name)
    t_end = min(float(scene.t_end), 12.0)
    exact = simulate(name, t_end=t_end)
    for spacing in (1e-10, 3e-9, 2e-8, 1e-6):
        t = [np.linspace(float(scene.t0), t_end, 600)]
        for event in exact.events:
            t.append(float(event.t) + spacing * np.cumsum(rng.uniform(0.5, 2.0, 12)))
            t.append(float(event.t) - spacing * rng.uniform(0.0, 5.0, 4))
        times = np.unique(np.concatenate(t))
        times = times[times <= t_end]
        check = crosscheck(name, times, exact(times)[0])
        assert check.ok, (spacing, check.summary())
        x = exact(times)[0] + 1e-3 * (times > 0.6 * t_end)
        assert not crosscheck(name, times, x).ok


@pytest.mark.parametrize("before", [1e-8, 1e-7, 1e-6, 1e-5])
def test_a_position_just_before_the_first_stick(before: float) -> None:
    """The positions of the step to the next sample are those of a stick, but v is not yet the
    belt's.
    """
    p = Parameters(
        m="1.251", c=0, k="2.08", A0="0.078", B0="5.984", Omega="2.054", v1="-0.091", v2=100,
        mu1="0.415", mu2="0.237", FN="16.635",
    )  # fmt: skip
    scene = Scene("early-stick", p, t0="3.87", x0="1.597", v0="-0.032", t_end=7)
    exact = simulate(scene)
    first = exact.events[0]
    assert (first.kind, round(float(first.t), 6)) == ("stick", 3.880794)
    t = np.append(3.87, np.arange(float(first.t) - before, 7.0, 0.0125))
    check = crosscheck(scene, t, exact(t)[0], partial=True)
    assert check.ok, check.summary()
    assert len(check.t) == len(t)


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("before", [1e-8, 1e-7])
def test_velocities_of_the_samples_before_the_first_stick(number: int, before: float) -> None:
    """The stick begins so soon after sample `number` that no position shows it: v of the second
    sample is told by the motion, that of the first one by the scene.
    """
    onset = float(simulate("fig5").events[0].t)
    t0 = onset - before - 0.01 * number
    x0, v0 = simulate("fig5")(t0)
    scene = Scene("before-stick", load_scene("fig5").parameters, t0, float(x0), float(v0), t0 + 5)
    t = np.linspace(t0, t0 + 5, 501)
    x, v = simulate(scene)(t)
    check = crosscheck(scene, t, x, tolerance=1e-11)
    assert check.ok, check.summary()
    assert np.max(np.abs(check.v - v)[:3]) < 1e-12


@pytest.mark.parametrize("method", ["DOP853", pytest.param("RK23", marks=pytest.mark.slow)])
def test_positions_at_the_steps_of_scipy(method: str) -> None:
    """Not those of LSODA, whose steps at a switch may become so short that it never ends."""
    scene = load_scene("fig9")
    p = scene.parameters
    m, c, k, A0, B0, Omega = (float(getattr(p, n)) for n in ("m", "c", "k", "A0", "B0", "Omega"))
    belts = [(float(p.v1), float(p.mu1 * p.FN)), (float(p.v2), float(p.mu2 * p.FN))]

    def rhs(t: float, state: Any) -> tuple[float, float]:
        x, v = state
        held = sum(force if v < speed else -force for speed, force in belts)
        return v, (A0 + B0 * cos(Omega * t) - c * v - k * x + held) / m

    span = float(scene.t0), float(scene.t_end)
    start = float(scene.x0), float(scene.v0)
    t = solve_ivp(rhs, span, start, method, rtol=1e-8, atol=1e-8).t
    assert np.min(np.diff(t)) < 2e-8
    check = crosscheck("fig9", t, simulate("fig9")(t)[0])
    assert check.ok, check.summary()


# -- ends at, just before and just after an event --------------------------------------------------


@pytest.mark.parametrize("off", [-1e-10, -1e-13, -4e-16, 0.0, 4e-16, 1e-13, 1e-10])
@pytest.mark.parametrize("number", [0, 1, pytest.param(None, marks=pytest.mark.campaign)])
def test_a_solution_may_end_at_its_terminal_event(number: int | None, off: float) -> None:
    """Every event of fig5 ends a solution, which locates it early, late or exactly; in every
    shape. The first two are of its two kinds: a stick and a slip.
    """
    exact = simulate("fig5")
    assert len(exact.events) == 16
    belts = {boundary: float(exact.parameters.belt(boundary)) for boundary in (1, 2)}
    for i in range(16) if number is None else [number]:
        last = exact.events[i]
        end = float(last.t) * (1.0 + off)
        t = np.append(np.linspace(0, end, 400)[:-1], end)
        x, v = exact(t)
        v[-1] = belts[last.boundary]
        kinds = [(float(event.t), event.kind) for event in exact.events[:i]]
        times = [time for time, _ in kinds] + [end]
        states = [[exact(time)[0], belts[e.boundary]] for time, e in zip(times, exact.events)]  # noqa: B905
        result = SimpleNamespace(
            t=t, y=np.array([x, v]), t_events=[times], y_events=[states], success=True
        )
        middle = len(t) // 2
        pieces = [
            SimpleNamespace(t=t[part], y=np.array([x[part], v[part]]), success=True)
            for part in (slice(0, middle + 1), slice(middle, None))
        ]
        pieces[1].t_events = [[end]]
        pieces[1].y_events = [[[x[-1], v[-1]]]]
        shapes: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {
            "arrays": ((t, x, v), {}),
            "positions": ((t, x), {}),
            "events": ((t, x, v), {"events": [*kinds, (end, last.kind)]}),
            "events without the last": ((t, x, v), {"events": kinds}),
            "result": ((result,), {}),
            "pieces": ((pieces,), {}),
            "function": ((t, exact), {}),
            "table": (({"t": t, "x": x, "v": v, "te": times, "xe": states},), {}),
        }
        for shape, (solution, options) in shapes.items():
            check = crosscheck("fig5", *solution, **options)
            assert check.ok, (i, shape, check.summary())


# -- events that a list lacks ----------------------------------------------------------------------


def crossings() -> tuple[Parameters, Any]:
    """Return a scene without friction, and DOP853's result, which steps over the contacts with belt
    2.
    """
    p = Parameters(m=1, c=0, k=0, A0=0, B0=1, Omega=1, v1="0.2", v2="0.9999", mu1=0, mu2=0, FN=0)
    functions = [lambda t, y: y[1] - 0.2, lambda t, y: y[1] - 0.9999]
    result = solve_ivp(
        lambda t, y: (y[1], cos(t)), (0, 12), (0, 0), "DOP853", rtol=1e-11, atol=1e-12, events=functions
    )  # fmt: skip
    assert [len(times) for times in result.t_events] == [4, 0]
    return p, result


def test_events_that_a_solver_lacks_are_missed() -> None:
    p, result = crossings()
    listed = [(time, "cross") for time in result.t_events[0]]
    for solution, options in (((result,), {}), ((result.t, *result.y), {"events": listed})):
        check = crosscheck(p, *solution, **options)
        assert (check.ok, len(check.matched), len(check.missed)) == (False, 4, 4)
        assert {event.boundary for event in check.missed} == {2}


def test_what_the_times_of_a_solver_claim() -> None:
    """All contacts at a belt, or all from one side; no slips; nothing about a belt that no function
    looks for.
    """
    exact = simulate("fig5")
    t = np.linspace(0, 40, 2001)
    reached = [event for event in exact.events if event.kind in ("stick", "cross")]
    contacts = [float(event.t) for event in reached]
    sides = [event.source for event in reached]
    slips = [float(event.t) for event in exact.events if event.kind == "slip"]

    def missed(*lists: list[float]) -> int:
        states = [[exact(time) for time in times] for times in lists]
        result = SimpleNamespace(
            t=t, y=exact(t), t_events=list(lists), y_events=states, success=True
        )
        check = crosscheck("fig5", result)
        assert check.ok == (not check.missed)
        return len(check.missed)

    assert missed(contacts) == missed(contacts, slips) == missed(contacts, slips[:2]) == 0
    assert missed(contacts, []) == 0  # fig5 never meets belt 2
    for number in range(len(contacts)):
        # Without the only contact from one side it is the list of a function for the other.
        lacking = 1 if sides.count(sides[number]) > 1 else 0
        assert missed(contacts[:number] + contacts[number + 1 :]) == lacking
    assert len(set(sides)) == 2
    assert len(contacts) == 8
    assert missed([]) == missed([], []) == 0  # no list is about a belt
    p, result = crossings()
    up = result.t_events[0][::2]
    down = result.t_events[0][1::2]
    for times in (up, down):
        one_way = SimpleNamespace(t=result.t, y=result.y, t_events=[times], success=True)
        assert crosscheck(p, one_way).ok


# -- matrices of states ----------------------------------------------------------------------------


def of_ode45() -> dict[str, Any]:
    """Return fig5 up to its third event as MATLAB's ode45 returns it: columns, states as rows."""
    exact = simulate("fig5")
    events = exact.events[:3]
    times = np.array([float(event.t) for event in events])
    t = np.append(np.linspace(0, times[-1], 300)[:-1], times[-1])
    return {
        "t": t[:, None],
        "x": exact(t).T,
        "te": times[:, None],
        "xe": exact(times).T,
        "ie": np.array([[float(event.boundary)] for event in events]),
    }


@pytest.mark.parametrize("names", [("t", "x"), ("t", "x", "te", "xe", "ie")])
def test_states_of_ode45(names: tuple[str, ...], tmp_path: Path) -> None:
    variables = {name: of_ode45()[name] for name in names}
    path = tmp_path / "run.mat"
    savemat(path, variables)
    rows = variables | {"t": variables["t"].ravel(), "x": variables["x"].T}
    wrong = variables | {"x": variables["x"] + 1e-3 * (variables["t"] > 0.5)}
    for source in (variables, path, rows):
        check = crosscheck("fig5", source)
        assert isinstance(check, CrossCheck)
        assert check.ok, check.summary()
        assert len(check.matched) == 3
    check = crosscheck("fig5", wrong)
    assert isinstance(check, CrossCheck)
    assert not check.ok
    if "te" in names:
        fewer = variables | {name: variables[name][1:] for name in ("te", "xe", "ie")}
        assert len(crosscheck("fig5", fewer).missed) == 1


def test_states_as_two_arguments() -> None:
    variables = of_ode45()
    for t, x in ((variables["t"], variables["x"]), (variables["t"].ravel(), variables["x"].T)):
        assert crosscheck("fig5", t, x).ok


def test_positions_beside_events_of_a_solver_need_no_option() -> None:
    variables = of_ode45()
    variables["x"] = variables["x"][:, 0]
    assert crosscheck("fig5", variables).ok


# -- how much work a verdict is --------------------------------------------------------------------


def test_the_work_of_a_verdict_grows_with_the_samples_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Chatter, v = 0, 2, 0, 2 at steps of 1e-9, makes every step wrong and invents an event in
    each.
    """
    explained: list[int] = []
    searched: list[int] = []
    plain = verdict.explain
    rows = StepEvents.rows
    read = verdict.find_events

    def explain(steps: Any, chosen: Any, *others: Any) -> Any:
        explained.append(len(chosen))
        return plain(steps, chosen, *others)

    def counted(self: StepEvents, first: int, last: int) -> slice:
        searched.append(first)
        return rows(self, first, last)

    looked = []
    monkeypatch.setattr(verdict, "explain", explain)
    monkeypatch.setattr(StepEvents, "rows", counted)
    monkeypatch.setattr(verdict, "find_events", lambda *taken: looked.append(1) or read(*taken))
    for count in (2_000, 20_000):
        t = np.arange(count) * 1e-9
        check = crosscheck("fig5", t, 0 * t, np.arange(count) % 2 * 2.0)
        assert len(check.wrong_steps) == count - 1
        assert len(check.invented) >= count - 2
    # Steps are described, and event rows searched, in numbers that do not grow; events are read once.
    assert max(explained) <= 1_500
    assert len(searched) <= 6_000
    assert len(looked) == len(explained) == 2


@pytest.mark.parametrize("count", [500, pytest.param(4_000, marks=pytest.mark.slow)])
def test_positions_of_no_motion_are_not_fitted_for_long(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rounded positions of another spring: a start that fails at the first of them is fitted to no
    more.
    """
    p = load_scene("fig5").parameters
    t = np.linspace(0, 40, count)
    x = simulate(p.replace(k=2 * p.k), t0=0, x0=0, v0=0, t_end=40)(t)[0]
    spans: list[float] = []
    plain = velocities._motion

    def motion(scene: Any, t_end: float, *start: float) -> Any:
        spans.append(float(t_end))
        return plain(scene, t_end, *start)

    monkeypatch.setattr(velocities, "_motion", motion)
    assert not crosscheck("fig5", t, np.round(x, 4)).ok
    # The scene's own motion and the first guesses reach the end, fits do not: 72 of theirs would.
    assert len([end for end in spans if end > 20.0]) <= 5
    assert len(spans) <= 140
