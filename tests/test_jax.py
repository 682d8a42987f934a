"""Motions as functions of JAX.

Values and derivatives are those of symosc, through grad, jacobian, vmap and jit.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from bad_values import refused

from symosc import Belt, MissingExtraError, Oscillator, load_scene, sensitivities, simulate
from symosc import jax as ours

jax = pytest.importorskip("jax")
P = {name: float(value) for name, value in load_scene("fig5").parameters.as_dict().items()}


@pytest.fixture(autouse=True)
def doubles() -> Any:
    jax.config.update("jax_enable_x64", True)
    yield
    jax.config.update("jax_enable_x64", False)


def test_events_and_their_gradients() -> None:
    found = ours.events(P, t_end=7, count=8)
    motion = simulate("fig5", t_end=7)
    count = len(motion.events)
    np.testing.assert_allclose(found.t[:count], [event.t for event in motion.events], rtol=1e-13)
    assert np.isinf(found.t[count:]).all()
    assert found.kind.tolist() == [2, 3, 2, 3, 2, 0, 0, 0]
    assert found.regular.tolist() == [True] * count + [False] * (8 - count)
    expected = sensitivities("fig5", ("mu1", "Omega", "x0"), t_end=7)

    def time(mu1: Any, Omega: Any, x0: Any) -> Any:
        return ours.events(P | {"mu1": mu1, "Omega": Omega}, x0=x0, t_end=7, count=8).t[4]

    slopes = jax.jit(jax.grad(time, argnums=(0, 1, 2)))(P["mu1"], P["Omega"], 0.0)
    np.testing.assert_allclose(slopes, expected.dt[4], rtol=1e-12)
    np.testing.assert_allclose(
        jax.jacfwd(time)(P["mu1"], P["Omega"], 0.0), expected.dt[4, 0], rtol=1e-12
    )


@pytest.mark.slow
def test_many_motions_by_vmap() -> None:
    values = np.array([0.6, 0.7, 0.8])

    def position(mu1: Any) -> Any:
        return ours.events(P | {"mu1": mu1}, t_end=7, count=3).x[2]

    slopes = jax.vmap(jax.grad(position))(values)
    p = load_scene("fig5").parameters
    alone = [sensitivities(p.replace(mu1=str(mu1)), "mu1", t_end=7).dx[2, 0] for mu1 in values]
    np.testing.assert_allclose(slopes, alone, rtol=1e-12)


def test_flow_by_start_and_time() -> None:
    times = np.array([0.05, 0.5, 2.5, 5.0])
    expected = sensitivities("fig5", ("x0", "k"), t_end=7)

    def states(x0: Any, k: Any, t: Any) -> Any:
        return ours.flow(P | {"k": k}, t, x0=x0)

    forward = jax.jacfwd(states, argnums=(0, 1))(0.0, P["k"], times)
    backward = jax.jacrev(states, argnums=(0, 1))(0.0, P["k"], times)
    for each in (forward, backward):
        np.testing.assert_allclose(np.stack(each, axis=-1), expected(times), rtol=1e-10, atol=1e-12)
    rates = jax.jacfwd(states, argnums=2)(0.0, P["k"], 2.5)
    motion = simulate("fig5", t_end=7)
    h = 1e-6
    np.testing.assert_allclose(rates, (motion(2.5 + h) - motion(2.5 - h)) / (2 * h), rtol=1e-7)


def test_what_is_wrong_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "did you mean" in refused(
        lambda: ours.events(P | {"mu": 1.0}, t_end=7, count=3), "parameters"
    )
    assert "FN is missing" in refused(
        lambda: ours.flow({n: P[n] for n in P if n != "FN"}, 1.0), "parameters"
    )
    refused(lambda: ours.events(P, t_end=7, count=0), "count")
    jax.config.update("jax_enable_x64", False)
    refused(lambda: ours.events(P, t_end=7, count=3), "jax_enable_x64")
    monkeypatch.setitem(__import__("sys").modules, "jax", None)
    with pytest.raises(MissingExtraError, match=r"symosc\[jax\]"):
        ours.flow(P, 1.0)


#: A falling friction curve with static friction, and a second belt without.
CURVED = Oscillator(
    m=1, c="1/10", k=1, B0="9/10", Omega="11/10",
    belts=[Belt("1/2", curve=[(0, "1/2"), (1, "1/5")], mu_s="7/10"), Belt(2, "1/10")],
)  # fmt: skip


def test_other_laws() -> None:
    """Events and flows by the numbers of a friction curve, as `sensitivities` has them."""
    names = ("mu1_1", "mu_s1", "x0")
    expected = sensitivities(CURVED, names, x0=1, t_end=12)
    count = len(expected.dt)
    assert count > 3
    values = {name: float(value) for name, value in CURVED.given_numbers().items()}

    def last_time(mu1_1: Any, mu_s1: Any, x0: Any) -> Any:
        changed = values | {"mu1_1": mu1_1, "mu_s1": mu_s1}
        return ours.events(changed, x0=x0, t_end=12, count=count).t[-1]

    slopes = jax.grad(last_time, argnums=(0, 1, 2))(0.2, 0.7, 1.0)
    np.testing.assert_allclose(slopes, expected.dt[-1], rtol=1e-10)

    def states(mu1_1: Any, mu_s1: Any, x0: Any) -> Any:
        return ours.flow(values | {"mu1_1": mu1_1, "mu_s1": mu_s1}, 9.0, x0=x0)

    by_all = jax.jacobian(states, argnums=(0, 1, 2))(0.2, 0.7, 1.0)
    np.testing.assert_allclose(np.stack(by_all, axis=-1), expected(9.0), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(ours.flow(CURVED, 9.0, x0=1), simulate(CURVED, x0=1, t_end=10)(9.0))
    refused(lambda: ours.flow({n: values[n] for n in values if n != "w1_1"}, 1.0), "w1_1")
