"""The oracle in quadruple precision (fast_oracle.cpp), compiled on first use with g++ where that is installed."""

from __future__ import annotations

import subprocess
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

import mpmath
from oracle import OracleEvent, OracleRun, exact, simulate_oracle
from programs import built

SOURCE = Path(__file__).with_suffix(".cpp")
DIGITS = 33  # runs that need more are left to oracle.py
WRITTEN = 40
MOST_TURNS = 3e5  # of the fastest rate; some ten seconds


def program() -> Path | None:
    """Return the compiled oracle, or None without a compiler."""
    return built(SOURCE, "-std=gnu++17", "-lquadmath")


@cache
def _process() -> Any:
    return subprocess.Popen(
        [str(program())], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def simulate_fast(
    p: Any, t0: Any, x0: Any, v0: Any, t_end: Any, dps: int = DIGITS, max_events: int = 10_000
) -> OracleRun:
    """Return what `simulate_oracle` returns.

    It is called for more digits, and without a compiler.
    """
    t0, x0, v0, t_end = map(exact, (t0, x0, v0, t_end))
    fastest = float(p.c / p.m) + float(p.k / p.m) ** 0.5 + float(p.Omega)
    if dps > DIGITS or program() is None or fastest * float(t_end - t0) > MOST_TURNS:
        return simulate_oracle(p, t0, x0, v0, t_end, dps, max_events)
    with mpmath.workdps(WRITTEN + len(str(int(abs(p.Omega * t0))))):
        theta = _mpf(p.Omega * t0)
        numbers = [
            _mpf(value / p.m) for value in (p.c, p.k, p.B0, p.Omega * p.m, *map(p.A, (1, 2, 3)))
        ]
        numbers += [_mpf(value) for value in (p.v1, p.v2, x0, v0)]
        numbers += [mpmath.cos(theta), mpmath.sin(theta), _mpf(t_end - t0), max_events]
        line = " ".join(mpmath.nstr(value, WRITTEN) for value in numbers)
    process = _process()
    process.stdin.write(line + "\n")
    process.stdin.flush()
    run = OracleRun()
    with mpmath.workdps(60):
        start = _mpf(t0)
        belts = {boundary: _mpf(p.belt(boundary)) for boundary in (1, 2)}
        while True:
            what, *words = process.stdout.readline().split()
            if what == "event":
                t, x, kind, boundary, source, target = words
                v = belts[int(boundary)]
                event = OracleEvent(
                    start + mpmath.mpf(t), kind, int(boundary), source, target, mpmath.mpf(x), v
                )
                run.events.append(event)
            elif what == "end":
                run.mode, (t, run.x, run.v) = words[0], map(mpmath.mpf, words[1:])
                run.t = start + t
                return run
            else:
                raise ArithmeticError(" ".join(words))


def _mpf(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator
