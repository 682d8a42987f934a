"""Four ways to decide a graze: each as accurate as assumed."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from oracle import flow_oracle

from symosc import Parameters, load_scene
from symosc.grazing import deciders
from symosc.grazing.deciders import DOP853_ERROR, DOP853_TIMES, FLOW_DIGITS, NO, NOT_DECIDED, YES, Ways
from symosc.grazing.window import grazing_window

MAPS = ("P2", "P3", "P5", "P6")

BASE = Parameters(m=1, c="0.4", k=2, A0="0.5", B0=4, Omega="1.3", v1=-1, v2="1.5", mu1="0.4", mu2="0.3", FN=3)


@pytest.mark.full(2)
@pytest.mark.slow
@pytest.mark.parametrize("mapping", MAPS)
def test_ways_agree_with_the_oracles_flow(mapping: str) -> None:
    ways = Ways(grazing_window(BASE, mapping))
    place = ways.window.place
    theta = np.random.default_rng(4).uniform(0, 2 * np.pi, 25)
    signs, flow, solver = ways.signs(theta), ways.flow(theta), ways.solver(theta)
    for i, phase in enumerate(theta):
        exact = ways.fine.context.mpf(float(phase))
        t_m = Fraction(float(phase)) / BASE.Omega
        rest = (BASE.A(place.domain) - BASE.c * ways.window.speed) / BASE.k
        x = Fraction(str(ways.fine.number(rest) + ways.fine.number(BASE.B0 / BASE.k) * ways.fine.context.cos(exact)))
        gaps = []
        for tau in ("-1e-6", "1e-6"):
            v = flow_oracle(BASE, place.domain, t_m, x, ways.window.speed, tau, dps=40)[1]
            gaps.append(-place.side * float(ways.fine.context.convert(v) - ways.v_fine))
        expected = YES if gaps[0] > 0 and gaps[1] > 0 else NO
        assert signs[i] == flow[i] == solver[i] == expected
        assert ways.fine_signs(exact, False) == (expected, 1)
        assert ways.fine_flow(exact) == expected


@pytest.mark.slow
def test_dop853_is_as_accurate_as_assumed() -> None:
    worst = 0.0
    for mapping in MAPS:
        ways = Ways(grazing_window(BASE, mapping))
        context, basis = ways.fine.context, ways.fine.namespace["basis"]
        theta = np.random.default_rng(5).uniform(0, 2 * np.pi, 200)
        for part in DOP853_TIMES:
            tau = part / ways.K.rate
            values = basis(context.convert(tau), ways.fine.K)[:5]
            for phase, found in zip(theta[::20], ways.integrated(theta, tau)[::20], strict=True):
                exact = context.convert(float(phase))
                gap = ways._gap(values, context.sin(exact), context.cos(exact), ways.v_fine, ways.fine.K)
                worst = max(worst, abs(float(gap / ways.size / context.convert(tau) ** 2) - float(found)))
    assert worst < DOP853_ERROR / 20


def test_double_precision_leaves_open_what_it_cannot_tell() -> None:
    ways = Ways(grazing_window(load_scene("fig9").parameters, "P2"))
    low, high = 3.225022740200408, 3.225022740200408 + 1e-15  # an end of the window, and an ulp or two beside it
    assert list(ways.signs(np.array([low, high]))) == [NOT_DECIDED, NOT_DECIDED]
    assert list(ways.flow(np.array([low, high]))) == [NOT_DECIDED, NOT_DECIDED]
    assert list(ways.solver(np.array([low, high]))) == [NOT_DECIDED, NOT_DECIDED]
    exact = ways.fine.context.pi + ways.fine.context.asin(ways.fine.context.mpf(1) / 12)
    assert ways.fine_signs(exact, False)[0] == NOT_DECIDED  # without being told that it is 0, intervals cannot know
    assert ways.fine_signs(exact, True) == (NO, 2)


def test_the_exact_flow_decides_only_if_both_times_say_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before and after the contact, at two times: in the domain both times is a graze, and too small a gap is open."""
    ways = Ways(grazing_window(BASE, "P2"))
    theta = ways.fine.context.mpf(1)
    least = [ways.size * ways.fine.context.mpf(10) ** (20 - FLOW_DIGITS) * abs(basis[2]) for basis in ways._fine_bases]
    for signs in product((1, -1), repeat=4):
        for small in (None, 0, 3):
            gaps = iter([(0.9 if i == small else 1.1) * sign * least[i] for i, sign in enumerate(signs)])
            monkeypatch.setattr(ways, "_gap", lambda *_, gaps=gaps: next(gaps))
            first, second = (YES if signs[i] == signs[i + 1] == 1 else NO for i in (0, 2))
            right = NOT_DECIDED if small is not None or first != second else first
            assert ways.fine_flow(theta) == right


def test_double_precision_decides_if_both_gaps_are_clear() -> None:
    """Beyond what is open: in the domain before and after is a graze, outside on one side is none."""
    for signs in product((1, -1), repeat=2):
        for sizes in product((0.99, 1.01), repeat=2):
            gaps = [np.array([sign * size * 1e-3]) for sign, size in zip(signs, sizes, strict=True)]
            clear = sizes == (1.01, 1.01)
            right = NOT_DECIDED if not clear else YES if signs == (1, 1) else NO
            assert deciders._verdicts(gaps, 1e-3).tolist() == [right]


def test_decimals_around_a_number_hold_it() -> None:
    """Just below and above, 5 digits finer than the intervals are, and relative for large numbers."""
    context = Ways(grazing_window(BASE, "P2")).fine.context
    for value in (context.mpf(1) / 3, -context.mpf(10) / 7, 1000 * context.pi, context.mpf(0)):
        low, high = (context.mpf(each) for each in deciders.bounds(value, context))
        shift = context.mpf(10) ** -55 * max(1, abs(value))
        assert low < value < high
        assert abs(high - value - shift) < shift / 100
        assert abs(value - low - shift) < shift / 100
