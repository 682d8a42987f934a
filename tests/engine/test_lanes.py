"""Motions side by side in vector registers.

The bits of the scalar source, at any width and beside any neighbours.
"""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from regimes import random_sets

from symosc import Belt, Oscillator, load_scene, simulate_many
from symosc.engine import arithmetic
from symosc.engine.batch import end_by_phase, is_inexact, keep_state, state_of
from symosc.engine.flow import ConstantRows, TableLoops
from symosc.engine.lanes import (
    BELT_THERE,
    KIND,
    OF_MOTION,
    OF_RESULT,
    OF_STATE,
    T_ERROR,
    suits_lanes,
)
from symosc.engine.next_event import advance, time_with_errors
from symosc.engine.state import GRAZE, MOVED, ON_BELT
from symosc.model import Model, by_name
from symosc.simulation.problems import Problems

pytest.importorskip("numba")

ACCURACY = 1e-6
SCENES = [load_scene(name).parameters for name in ("fig5", "fig9", "fig10")]


def starts_of(rng: random.Random, p: Model, count: int) -> np.ndarray:
    """Return random starts about the belts."""
    widest = 2.0 * max(abs(float(belt.v)) for belt in p.law.belts) + 1.0
    return np.array(
        [
            (rng.uniform(0, 7), rng.uniform(-5, 5), rng.uniform(-widest, widest))
            for _ in range(count)
        ]
    )


def followed(
    p: Any,
    starts: np.ndarray,
    steps: int,
    functions: dict[str, Any],
    span: float = 500.0,
    accuracy: float = ACCURACY,
) -> tuple[int, int]:
    """Follow motions in blocks and by the interpreted source, compare them, and return the steps in lanes, and all."""
    width = functions["LANES"]
    batch, table = Problems(p, starts, starts[:, 0] + span, None).begin(
        slice(0, len(starts)), TableLoops(functions["march_rows"], None)
    )
    arguments = np.zeros((OF_MOTION, width))
    computed = np.zeros((OF_RESULT, width))
    K = ConstantRows(table)[0]
    if suits_lanes(K):
        running = set(range(len(starts)))
    else:
        running = set()
    good = 0
    tried = 0
    for _ in range(steps):
        for flights in (True, False):
            members = [i for i in sorted(running) if (batch.states[i].mode <= ON_BELT) == flights][
                :width
            ]
            if not members:
                continue
            # lanes without a motion have one of any other's states
            chosen = batch.states[[members[n % len(members)] for n in range(width)]]
            arguments[:] = np.array(chosen.tolist()).T
            flags = functions["block"](flights, arguments, computed, accuracy, table[0])
            for lane, i in enumerate(members):
                before = state_of(batch.states[i])
                event = advance(before, *end_by_phase(batch.states[i], K)[:2], K)
                tried += 1
                if flags >> lane & 1:
                    good += 1
                    assert event.decided
                    there = computed[[KIND, BELT_THERE, T_ERROR], lane].tolist()
                    assert there == [event.code, event.boundary, event.t_error], (p, i)
                    s = event.state
                    t0 = batch.states[i].t0
                    t, t_error, x_error = time_with_errors(
                        s.t, s.t_low, t0, s.x, s.v, event.t_error, s.S.S11, K
                    )
                    assert not is_inexact(t, t_error, s.x, x_error, t0, accuracy)
                if event.code > GRAZE and event.code != MOVED:
                    running.discard(i)
                keep_state(batch.states[i], event.state)
                if flags >> lane & 1:
                    state = np.array(batch.states[i].item()[:OF_STATE])
                    assert state.tobytes() == computed[:OF_STATE, lane].tobytes(), (p, i)
    return good, tried


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_a_block_takes_the_steps_of_the_scalar_source() -> None:
    functions = arithmetic.compiled()
    rng = random.Random(1)
    for p in SCENES:
        good, tried = followed(p, starts_of(rng, p, functions["LANES"]), 40, functions)
        assert good > 0.8 * tried, p
    all_good = [
        followed(p, starts_of(rng, p, functions["LANES"]), 12, functions)[0]
        for p in random_sets(7, 40)
    ]
    assert sum(good > 0 for good in all_good) > 6


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_static_friction_stays_in_lanes() -> None:
    functions = arithmetic.compiled()
    rng = random.Random(4)
    for p in SCENES:
        for factor in (Fraction(11, 10), Fraction(3, 2)):
            belts = [Belt(p.belt(n), mu, mu_s=factor * mu) for n, mu in ((1, p.mu1), (2, p.mu2))]
            shared = {name: getattr(p, name) for name in ("m", "c", "k", "A0", "B0", "Omega", "FN")}
            for law in (Oscillator(**shared, belts=belts), Oscillator(**shared, belts=belts[:1])):
                starts = starts_of(rng, law, functions["LANES"])
                good, tried = followed(law, starts, 40, functions)
                if p is SCENES[0]:  # others soon rest on a belt
                    assert good > 0.75 * tried, law


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_sets_with_and_without_a_drive_do_not_share_a_block() -> None:
    """A stick without a drive is searched in another way."""
    count = 40
    columns = by_name(load_scene("fig5").parameters, float) | {"c": 0.1, "A0": -3.0}
    columns["B0"] = np.where(np.arange(count) % 2, 10.0, 0.0)
    columns["FN"] = np.linspace(1.0, 20.0, count)
    starts = [(0, 1, float(columns["v1"]))] * count
    together = simulate_many(columns, starts, 60, use_numba=True)
    for parity in (0, 1):
        half = {name: np.broadcast_to(column, count)[parity::2] for name, column in columns.items()}
        apart = simulate_many(half, starts[parity::2], 60, use_numba=True)
        for i in range(count // 2):
            assert np.array_equal(together[2 * i + parity].t, apart[i].t)


@pytest.mark.slow
@pytest.mark.compiled("doubles")
def test_ends_and_inexact_events_are_left_to_the_scalar_loop() -> None:
    functions = arithmetic.compiled()
    rng = random.Random(2)
    for p in SCENES:
        starts = starts_of(rng, p, functions["LANES"])
        period = 6.3 / float(p.Omega)
        followed(p, starts, 20, functions, span=3 * period)
        good, tried = followed(p, starts, 20, functions, accuracy=1e-15)
        assert 0 < good < 0.9 * tried


@pytest.mark.campaign  # to compile it takes as long as 200 tests; the usual width is tested above
def test_another_width_has_the_same_bits() -> None:
    functions = arithmetic.compiled(2)
    rng = random.Random(2)
    for p in [*SCENES, *random_sets(3, 20)]:
        followed(p, starts_of(rng, p, 16), 12, functions)


@pytest.mark.compiled("doubles")
@pytest.mark.parametrize("number", range(4))
def test_a_motion_has_no_neighbours(number: int) -> None:
    rng = random.Random(number)
    if number < len(SCENES):
        p = SCENES[number]
    else:
        p = rng.choice([p for p in random_sets(7, 60) if p.B0 > 0])
    starts = starts_of(rng, p, 150)
    span = 30 * 6.3 / float(p.Omega)
    columns: dict[str, Any] = by_name(p, float)
    columns["Omega"] = float(p.Omega) * np.linspace(0.9, 1.1, 150)
    for parameters in (p, columns):
        for record in ("summary", ("events", "sticks", "t", "x")):
            call: dict[str, Any] = {
                "record": record,
                "use_numba": True,
                "workers": 1,
                "skip": 0.3 * span,
            }
            whole = simulate_many(parameters, starts, starts[:, 0] + span, **call)
            for i in rng.sample(range(150), 25):
                if parameters is p:
                    of_one = parameters
                else:
                    of_one = columns | {"Omega": columns["Omega"][i]}
                alone = simulate_many(of_one, starts[i], starts[i, 0] + span, **call)
                for name in vars(alone):
                    first = getattr(alone, name)
                    many = getattr(whole, name)[i : i + 1]
                    assert np.array_equal(first, many, equal_nan=first.dtype.kind == "f"), (
                        p,
                        i,
                        name,
                    )
