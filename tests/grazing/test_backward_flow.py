"""The flow backwards from a graze: what it meets on the way."""

from __future__ import annotations

from itertools import pairwise
from math import pi, sqrt

import mpmath
import numpy as np
import pytest

from symosc import Parameters, load_scene
from symosc.engine.flow import constants
from symosc.grazing.backward_flow import Search
from symosc.grazing.start import grazing_start

BASE = Parameters(m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3)


def test_a_flow_that_touches_the_other_belt_on_the_way() -> None:
    # fig8's orbit to which all motions tend grazes both belts, half a period apart
    start = grazing_start(load_scene("fig8").parameters, "P5", 0)
    assert (start.found, start.touch, start.boundary) == (False, True, 1)
    assert abs(start.t + pi / 2) < 1e-12
    assert "touches belt 1" in str(start.reason)


def test_unforced_overdamped_flow_runs_away() -> None:
    # v'' + 3 v' + 2 v = 0 from v = -1, a = 0: v = -2 e^{-t} + e^{-2t}, backward -> +infinity; belt 1 at -1 is met at
    # the root of e^{2s} - 2 e^s + 1 = (e^s - 1)^2: only s = 0, so domain 2 is left through belt 2
    p = BASE.replace(c=3, k=2, B0=0)
    start = grazing_start(p, "P3", 1)
    s = _log_root(float(p.v2))
    assert (start.found, start.boundary) == (False, 2)
    assert abs(float(start.t_m) - float(start.t) - s) < 1e-12
    # P5, from v = 1.5 below belt 2: v = 3 e^{-t} - 1.5 e^{-2t}: falls backward through belt 1
    start = grazing_start(p, "P5", 1)
    assert (start.found, start.boundary) == (False, 1)
    # P2 with v1 > 0: v = 2 v1 e^{-t} - v1 e^{-2t} runs away downward and never was on belt 1
    start = grazing_start(p.replace(v1=1), "P2", 1)
    assert (start.found, start.t, start.boundary, start.start) == (False, None, 0, {})
    assert "never met a belt" in str(start.reason)


def _log_root(v: float) -> float:
    # e^{2s} - 2 e^s = v
    return float(mpmath.log(1 + sqrt(1 + v)))


def test_search_that_is_too_short_says_so() -> None:
    p = BASE.replace(c=0, B0=0, v1=1, k=1)  # v = cos t: on belt 1 again 2 pi earlier, by a touch
    start = grazing_start(p, "P2", 0)
    assert start.found
    assert start.touch
    assert abs(start.t + 2 * pi) < 1e-12
    short = grazing_start(p, "P2", 0, periods=0.5)
    assert not short.found
    assert "periods" in str(short.reason)


@pytest.mark.parametrize("c", ["0", "0.4", "9"])
def test_bounds_of_errors_add_up_backward(c: str) -> None:
    """An error of the energy grows as backward motions do, and each step adds its own rounding."""
    p = load_scene("fig9").parameters.replace(c=c)
    K = constants(p)
    search = Search(K, 1, 1)
    state, errors = search.begin(0.0), []
    for _ in range(40):
        _, step, state = search.over(1.0, 1, state)
        errors.append((state.energy_error, state.v_error))
        state = search.ended(state, step)
    growth = float(np.exp(K.cm * search.H))
    for (before, _), (after, v_error) in pairwise(errors):
        assert after > growth * before > 0.0
        assert 0.0 < v_error < 2.0 * after / K.w0 * max(1.0, K.rate / K.w0)
    assert errors[-1][0] > 20 * errors[0][0]
