"""What single ideas of the event loop gain: own functions against the C library's, and ways to search for a contact."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from math import cos, exp, inf, sin
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.engine import batch
from symosc.engine.arithmetic import SOURCES, Arithmetic, bind
from symosc.engine.first_exit import Marched, fourth_derivative_bound
from symosc.engine.start import Start, first_state
from symosc.engine.summary import no_tally
from symosc.kernels import elementary
from symosc.scenes import load_scene
from symosc.simulation.motion import last_time

SEARCHED_SCENES = ("fig5", "fig9", "fig10")
SEARCHED_EVENTS, QUICK_SEARCHED_EVENTS = 1_000, 300
TIMED_CALLS = 20_000
COUNTED_FUNCTIONS = ("state_at", "gain", "stays_open", "gap_bound")
SEARCHES = ("the bound at one end", "march, short steps", "march with strides")


def run(quick: bool = False) -> Record:
    """Measure and return a plain dictionary.

    Notes
    -----
    Keys: search (rows: scene, way, flow and force evaluations, looks at a gap, and microseconds per event in CPython);
    functions (rows: name, in_turn and in_arrays, each a pair of nanoseconds: the C library's and our own; with numba).
    """
    events = QUICK_SEARCHED_EVENTS if quick else SEARCHED_EVENTS
    rows = [_search(name, way, events) for name in SEARCHED_SCENES for way in SEARCHES]
    try:
        return {"search": rows, "functions": _functions(3 if quick else 9)}
    except ImportError:
        return {"search": rows, "functions": []}


def _search(name: str, way: str, events: int) -> Record:
    """Follow a scene by one way to search, once with a count of what is evaluated, once with a clock."""
    scene = load_scene(name)
    start = Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t0 + 10**7)
    arithmetic = Arithmetic(scene.parameters)
    K = arithmetic.K._replace(sigmas=0.0)
    if way == SEARCHES[1]:
        K = K._replace(stride=K.march)
    replaced = {"march": _no_march} if way == SEARCHES[0] else {}
    counts: Counter[str] = Counter()

    def counting(function: Any) -> Any:
        def call(*arguments: Any) -> Any:
            counts[function.__name__] += 1
            return function(*arguments)

        return call if function.__name__ in COUNTED_FUNCTIONS else function

    def follow(functions: dict[str, Any]) -> float:
        motions = batch.batch_of(np.array([batch.row_of(first_state(start, arithmetic), *end)]))
        begin = time.process_time()
        functions["follow_all"](0, motions, events, inf, batch.event_buffer(events), no_tally(), [K])
        return (time.process_time() - begin) / events

    end = last_time(start, arithmetic)
    follow(bind(SOURCES, replaced, counting))
    plain = bind(SOURCES, replaced)
    seconds = min(follow(plain) for _ in range(3))
    flow, force, *looks = (counts[each] / events for each in COUNTED_FUNCTIONS)
    return {"scene": name, "way": way, "flow": flow, "force": force, "looks": sum(looks), "python_us": seconds * 1e6}


def _no_march(tau_max: float, v0: float, now: Any, walls: Any, margin: float, K: Any) -> Marched:
    """Leave the search to steps of their own length, each with an evaluation of the flow."""
    return Marched(now, fourth_derivative_bound(now.G2, now.G3, now.s, now.c, K), 0, now)


def _functions(repeats: int) -> list[Record]:
    """Measure compiled calls that wait for each other, as in the event loop, and calls over an array."""
    import numba

    own = bind((elementary,), {}, lambda function: numba.njit(function, error_model="numpy"))
    library = {"sine_cosine": numba.njit(lambda x: (sin(x), cos(x))), "exp": numba.njit(lambda x: (exp(x), 0.0))}
    exp_of = own["exp"]
    ours = {"sine_cosine": own["sine_cosine"], "exp": numba.njit(lambda x: (exp_of(x), 0.0))}
    numbers, rows = np.linspace(-3.0, 3.0, 256), []
    passes = TIMED_CALLS // len(numbers)
    for name in library:
        waiting, beside = [], []
        for function in (library[name], ours[name]):
            turns, arrays = numba.njit(_in_turn(function)), numba.njit(_over_array(function))
            waiting.append(_nanoseconds(partial(turns, 0.3, TIMED_CALLS), repeats, TIMED_CALLS))
            beside.append(_nanoseconds(partial(arrays, numbers, passes), repeats, passes * len(numbers)))
        rows.append({"name": name, "in_turn": waiting, "in_arrays": beside})
    return rows


def _in_turn(function: Any) -> Callable[[float, int], float]:
    def chain(x, count):
        for _ in range(count):
            first, second = function(x)
            x = 0.3 + 1e-3 * (first + second)
        return x

    return chain


def _over_array(function: Any) -> Callable[[np.ndarray, int], np.ndarray]:
    def fill(numbers, passes):
        found = np.empty((2, len(numbers)))
        for n in range(passes):
            for i in range(len(numbers)):
                found[0, i], found[1, i] = function(numbers[i] + n)
        return found

    return fill


def _nanoseconds(action: Callable[[], Any], repeats: int, calls: int) -> float:
    action()
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        action()
        times.append(time.process_time() - begin)
    return min(times) / calls * 1e9


def table(result: Record) -> str:
    """Return the result of `run` as text."""
    from tabulate import tabulate

    rows = [
        [row["scene"], row["way"], *(row[each] for each in ("flow", "force", "looks", "python_us"))]
        for row in result["search"]
    ]
    heads = ["scene", "search by", "flow", "force on a belt", "looks at a gap", "CPython [us]"]
    parts = ["per event:", tabulate(rows, heads, floatfmt=("", "", ".2f", ".2f", ".1f", ".0f"))]
    if result["functions"]:
        times = [[row["name"], *row["in_turn"], *row["in_arrays"]] for row in result["functions"]]
        heads = ["function [ns]", "libm, in turn", "own, in turn", "libm, array", "own, array"]
        parts += ["", tabulate(times, heads, floatfmt=".1f")]
        parts += ["the event loop calls functions in turn, mapping residuals call them over arrays"]
    return "\n".join(parts)
