"""Single motions use compiled code where it is loaded, and only there; the numbers are those of CPython."""

from __future__ import annotations

from fractions import Fraction
from math import inf
from types import SimpleNamespace
from typing import Any

import pytest

from symosc import Parameters, load_scene, simulate
from symosc.engine import arithmetic
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.start import Start, first_state
from symosc.engine.state import END, REST
from symosc.simulation import search
from symosc.simulation.search import Compiled, Interpreted


def starts() -> list[Start]:
    scenes = [load_scene(name) for name in ("fig5", "fig8", "fig9", "fig10", "fig6")]
    made = [Start(s.parameters, s.t0, s.x0, s.v0, s.t_end) for s in scenes]
    still = Parameters(m=1, c=3, k=1, A0=0, B0=0, Omega=1, v1=-1, v2=5, mu1="0.3", mu2=0, FN=1)
    return [*made, Start(still, Fraction(0), Fraction(3), Fraction(-1), Fraction(9))]


@pytest.mark.compiled("doubles")
@pytest.mark.slow
def test_compiled_steps_are_those_of_cpython() -> None:
    pytest.importorskip("numba")
    function = arithmetic.compiled()["search_row"]
    for start in starts():
        doubles = Arithmetic(start.parameters)
        for K in (doubles.K, doubles.K._replace(sigmas=0.0)):
            both = Interpreted(start, K), Compiled(function, start, K)
            state, count = first_state(start, doubles), 0
            while count < 60:
                found, same = (each(state) for each in both)
                assert found == same
                assert [type(each) for each in same] == [int, int, bool, float, type(state)]
                assert [type(each) for each in same.state[:3]] == [int, int, int]
                state, count = found.state, count + 1
                if found.code in (END, REST):
                    break


def test_nothing_is_loaded_for_a_single_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without use of the loop, or without the step on disk, CPython searches."""
    asked = []

    def compiled() -> Any:
        asked.append(True)
        return {"follow_all": SimpleNamespace(overloads=in_use), "search_row": "the step"}

    info = SimpleNamespace(currsize=0)
    monkeypatch.setattr(compiled, "cache_info", lambda: info, raising=False)
    monkeypatch.setattr(search, "compiled", compiled)
    monkeypatch.setattr(search, "is_compiled", lambda function: on_disk)
    in_use, on_disk = {}, True
    assert search.loaded() is None
    assert asked == []
    info.currsize = 1
    assert search.loaded() is None
    in_use, on_disk = {"a signature": 1}, False
    assert search.loaded() is None
    on_disk = True
    assert search.loaded() == "the step"


@pytest.mark.compiled("doubles")
@pytest.mark.slow
@pytest.mark.parametrize("more", [{}, {"accuracy": inf}, {"accuracy": 1e-15}, {"digits": 25}])
def test_motions_are_the_same(more: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    for name in ("fig5", "fig8", "fig9", "fig8-exact"):
        monkeypatch.setattr(search, "loaded", lambda: None)
        alone = simulate(name, **more)
        function, calls = arithmetic.compiled()["search_row"], []
        monkeypatch.setattr(search, "loaded", lambda: lambda *given: calls.append(given) or function(*given))  # noqa: B023
        beside = simulate(name, **more)
        assert (beside.events, beside.status, beside.message) == (alone.events, alone.status, alone.message)
        assert calls or name == "fig8-exact"
