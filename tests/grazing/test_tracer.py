"""Samples of a grazing curve: what the flow says of them, and the work that they may take."""

from __future__ import annotations

from math import isnan

import numpy as np
import pytest

from symosc import grazing_window, load_scene
from symosc.grazing import tracer
from symosc.grazing.backward_flow import CONTACT, LARGE, LONG, NEVER, REACHED, STEP, TOUCH, Arrival
from symosc.grazing.tracer import NOWHERE, OTHER, OWN, UNKNOWN, Tracer


@pytest.mark.parametrize(("scene", "mapping"), [("fig10", "P5"), ("fig9", "P3"), ("fig9", "P2"), ("fig10", "P6")])
def test_each_search_takes_its_steps_from_those_of_the_curve(scene: str, mapping: str) -> None:
    p = load_scene(scene).parameters
    source, inside = Tracer(p, mapping), grazing_window(p, mapping)
    K, left = source.K, source.steps_left
    assert left == tracer.MOST_CURVE_STEPS
    lengths = []
    for theta_m in np.linspace(0.1, 6.2, 40):
        if not inside.contains(theta_m):
            continue
        sample = source.sample(float(theta_m))
        taken, left = left - source.steps_left, source.steps_left
        assert taken >= 0
        if sample.origin in (OWN, OTHER):
            tau = (theta_m - sample.theta) / K.Om
            assert taken == pytest.approx(tau * K.rate / STEP, abs=1 + 1e-9)
            lengths.append(taken)
    assert max(lengths) > 0


def test_a_search_has_what_is_left_within_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    source, asked = Tracer(load_scene("fig9").parameters, "P2"), []

    def arrival(*_: object, most_steps: int, **__: object) -> Arrival:
        asked.append(most_steps)
        return Arrival(NEVER, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    monkeypatch.setattr(source.origins, "arrival", arrival)
    for left in (10**9, tracer.MOST_BACKWARD_STEPS, 1_000, tracer.LEAST_STEPS + 1, tracer.LEAST_STEPS, 3, 0, -10):
        source.steps_left = left
        source.sample(4.0)
        assert asked.pop() == min(tracer.MOST_BACKWARD_STEPS, max(tracer.LEAST_STEPS, left))


@pytest.mark.parametrize("careful", [True, False])
def test_where_a_flow_came_from_is_what_its_search_ended_with(careful: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A contact, or a touch, is with the own belt or the other one; else there is no start, or it is not known."""
    source = Tracer(load_scene("fig9").parameters, "P3")
    own = source.place.boundary
    for kind in (CONTACT, TOUCH, REACHED, NEVER, LARGE, LONG):
        for boundary in (own, 3 - own):
            arrival = Arrival(kind, boundary, 0.25, -0.5, 1.0, 2.0, 0.0, 0.0)
            monkeypatch.setattr(source.origins, "arrival", lambda *_, arrival=arrival, **__: arrival)
            sample = source.sample(4.0) if careful else source.sample(4.0, careful=False)
            assert sample.theta_m == 4.0
            if kind not in (CONTACT, TOUCH):
                assert sample.origin == (NOWHERE if kind == NEVER else UNKNOWN)
                assert all(map(isnan, (sample.x, sample.theta, sample.slope_x, sample.slope_theta)))
                assert not sample.is_open
                continue
            assert sample.origin == (OWN if boundary == own else OTHER)
            assert sample.x == sample.x_m - 0.5
            assert sample.theta == 4.0 - source.K.Om * 0.25
            assert sample.is_open == (kind == TOUCH and not careful)
            assert (sample.slope_theta == 1.0) == (kind == TOUCH)
