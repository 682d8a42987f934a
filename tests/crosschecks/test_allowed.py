"""What rounding allows: of a sample, of a step, and over a step."""

from __future__ import annotations

import numpy as np
import pytest
from careful_solver import random_parameters

from symosc import simulate
from symosc.crosschecks import allowed
from symosc.crosschecks.samples import Samples


def test_the_acceleration_is_bounded_at_any_state() -> None:
    """In every domain and at every phase; and there is a state of that size where it is reached."""
    rng = np.random.default_rng(1)
    for _ in range(40):
        p = random_parameters(rng)
        x, v = rng.uniform(-9, 9, 2)
        m, c, k, B0 = (float(getattr(p, name)) for name in ("m", "c", "k", "B0"))
        largest = max(
            abs(float(p.A(domain)) + sign * B0 - k * at * x - c * by * v) / m
            for domain in (1, 2, 3) for sign in (1, -1) for at in (1, -1) for by in (1, -1)
        )  # fmt: skip
        assert allowed.push(p, x, v) == pytest.approx(largest, rel=1e-12)
        assert allowed.push(p, np.array([x, -x]), np.array([v, v])) == pytest.approx([largest, largest], rel=1e-12)


def test_rounded_samples_may_be_off_by_their_rounding_and_that_of_their_times() -> None:
    """The exact state at the written time is as near to the sample as said."""
    rng = np.random.default_rng(2)
    for name in ("fig5", "fig9", "fig10"):
        exact = simulate(name)
        t = np.sort(rng.uniform(1, 9, 300))
        for decimals in (1, 2, 4):
            written, (x, v) = np.round(t, decimals), np.round(exact(t), decimals)
            half = np.full((3, 300), 0.5 * 10.0**-decimals)
            loose = allowed.looseness(exact.parameters, Samples(written, x, v), half)
            off = np.abs(np.column_stack([x, v]) - exact(written).T)
            assert (off <= loose + 1e-12).all()
            assert (np.max(off, axis=0) > 0.05 * np.max(loose, axis=0)).all()


@pytest.mark.slow
def test_exact_motions_stay_as_near_as_is_said() -> None:
    """Of random systems and starts, through switchings and sticks; a bound that is reached at some time."""
    rng, nearest = np.random.default_rng(3), 0.0
    for number in range(40):
        p = random_parameters(rng)
        p = p.replace(k=0) if number % 10 == 0 else p
        start, off = rng.uniform(-4, 4, 2), rng.uniform(0, 10.0 ** rng.uniform(-3, 0), 2)
        one = simulate(p, t0=0, x0=start[0], v0=start[1], t_end=12)
        other = simulate(p, t0=0, x0=start[0] + off[0], v0=start[1] - off[1], t_end=12)
        t = np.linspace(0, min(one.t_end, other.t_end), 400)
        most = allowed.propagated(p, off, t)
        apart = np.abs(one(t) - other(t)).T
        assert (apart <= most * (1 + 1e-9) + 1e-12).all()
        nearest = max(nearest, float(np.max(apart[50:] / most[50:])))
    assert nearest > 0.95
    assert not allowed.propagated(p, np.zeros(2), 1.0).any()
