"""What more digits cost: motions that doubles cannot follow, beside those that they can."""

from __future__ import annotations

from fractions import Fraction
from importlib.util import find_spec
from math import inf, pi
from statistics import median
from typing import Any

from symosc.bench.formulas import in_turns
from symosc.engine.arithmetic import MpArithmetic
from symosc.engine.start import Start
from symosc.scenes import load_scene
from symosc.simulation.ensemble import simulate_many
from symosc.simulation.motion import Motion
from symosc.simulation.simulate import simulate

MOTIONS, QUICK_MOTIONS = 2_000, 300
EVENTS = 100_000
SETS, SWEPT_PERIODS = 300, 50
ASKED_DIGITS, WORKING_DIGITS = 30, 40  # the second is what `simulate` computes with when the first is asked for


def run(quick: bool = False) -> dict[str, Any]:
    """Measure processor times and return a plain dictionary.

    Notes
    -----
    Keys: fig5_us and fig8_us (per event in `simulate_many`, all of it), fig8_over_fig5;
    sweep_default_over_inf (values of Omega from 1 to 6 in fig9, at default accuracy and with ``math.inf``),
    sweep_sets_per_s; simulate_fig8_us (per event, one motion at default accuracy); digits_over_mpmath (how many
    times as fast as with mpmath's numbers, median over scenes), digits_us (per event with 30 digits, fig8), mpfr
    (whether gmpy2 is there).
    """
    repeats = 3 if quick else 7
    return _many(QUICK_MOTIONS if quick else MOTIONS, repeats) | _sweep(repeats) | _one(repeats)


def _many(motions: int, repeats: int) -> dict[str, Any]:
    """Compare one long motion of fig5, which doubles follow, with many of fig8, as long as the scene."""
    easy, hard = load_scene("fig5"), load_scene("fig8")
    starts = [(hard.t0, hard.x0, hard.v0)] * motions
    actions = (
        lambda: simulate_many(easy.parameters, (easy.t0, easy.x0, easy.v0), easy.t0 + 10**7, max_events=EVENTS),
        lambda: simulate_many(hard.parameters, starts, hard.t_end),
    )
    events = [len(action()) for action in actions]
    columns = in_turns(repeats, *actions)
    fig5, fig8 = ([time / count * 1e6 for time in column] for column, count in zip(columns, events, strict=True))
    ratio = median(b / a for a, b in zip(fig5, fig8, strict=True))
    return {"motions": motions, "fig5_us": min(fig5), "fig8_us": min(fig8), "fig8_over_fig5": ratio}


def _sweep(repeats: int) -> dict[str, Any]:
    p = load_scene("fig9").parameters
    sets = [p.replace(Omega=1 + Fraction(5 * n, SETS - 1)) for n in range(SETS)]
    ends = [SWEPT_PERIODS * 2 * pi / float(each.Omega) for each in sets]
    default, as_it_is = in_turns(
        repeats,
        lambda: simulate_many(sets, (0, 0, 0), ends),
        lambda: simulate_many(sets, (0, 0, 0), ends, accuracy=inf),
    )
    ratio = median(a / b for a, b in zip(default, as_it_is, strict=True))
    return {"sweep_default_over_inf": ratio, "sweep_sets_per_s": SETS / min(default)}


def _one(repeats: int) -> dict[str, Any]:
    gains, per_event = [], []
    for name in ("fig8", "fig5", "fig9"):
        scene = load_scene(name)
        fast, plain = (MpArithmetic(scene.parameters, WORKING_DIGITS, fast) for fast in (True, False))
        start = Start(scene.parameters, scene.t0, scene.x0, scene.v0, scene.t_end)
        columns = in_turns(repeats, lambda s=start, a=fast: _followed(s, a), lambda s=start, a=plain: _followed(s, a))  # type: ignore[misc]
        gains.append(median(b / a for a, b in zip(*columns, strict=True)))
        per_event.append(min(columns[0]) / len(_followed(start, fast).events) * 1e6)
    fig8 = load_scene("fig8")
    single, doubles = in_turns(repeats, lambda: simulate(fig8), lambda: simulate(fig8, accuracy=inf))
    events = len(simulate(fig8).events)
    return {
        "simulate_fig8_us": min(single) / events * 1e6,
        "simulate_fig8_as_doubles_us": min(doubles) / events * 1e6,
        "digits": ASKED_DIGITS,
        "digits_us": per_event[0],
        "digits_over_mpmath": median(gains),
        "mpfr": find_spec("gmpy2") is not None,
    }


def _followed(start: Start, arithmetic: MpArithmetic) -> Motion:
    motion = Motion(start, arithmetic)
    while not motion.ended:
        motion.step()
    return motion


def table(result: dict[str, Any]) -> str:
    """Return the result of `run` as text."""
    r = result
    by = "MPFR" if r["mpfr"] else "mpmath (gmpy2 is missing)"
    return "\n".join(
        [
            f"fig8 in simulate_many, {r['motions']} motions: {r['fig8_us']:.1f} us per event, "
            f"{r['fig8_over_fig5']:.1f} times fig5's {r['fig5_us']:.2f}",
            f"{SETS} values of Omega, {SWEPT_PERIODS} periods of fig9: {r['sweep_sets_per_s']:.0f} per second, "
            f"{r['sweep_default_over_inf']:.2f} times the time without more digits",
            f"simulate fig8: {r['simulate_fig8_us']:.0f} us per event, "
            f"{r['simulate_fig8_as_doubles_us']:.0f} in doubles alone",
            f"{r['digits']} digits by {by}: {r['digits_us']:.0f} us per event of fig8, "
            f"{r['digits_over_mpmath']:.1f} times as fast as mpmath alone",
        ]
    )
