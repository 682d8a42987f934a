"""Follow the reference cases with scipy's solve_ivp (DOP853), and write the events that it finds.

python with_scipy.py cases/cases.csv mine.csv && symosc score cases mine.csv

A solver is a function `leave`: it follows one flight or stick to its end. The rules at the belts
are those of `symosc.bench.event_logic`. Steps are at most a twentieth of a period. Two roots inside
one step are not seen. Cases under other friction laws (laws.csv) are followed by the class `Law`,
which has rules of its own.
"""

from __future__ import annotations

import csv
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from math import cos
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from symosc import load_scene
from symosc.bench.event_logic import PeerError, PeerProblem, force, margins, runner, with_solver
from symosc.bench.solvers import processor_limit

TOLERANCE = 1e-13
STEPS_PER_PERIOD = 20
#: The same under other laws: corners of friction curves make short steps anyway.
LAW_STEPS = 50
#: Seconds of processor time for a case.
LIMIT = 5.0


def leave(
    q: PeerProblem, settings: None, mode: int, t: float, x: float, v: float, t_end: float
) -> tuple[int, float, float]:
    """Follow a flight (modes 1 to 3) or a stick (4 and 5).

    Return the side where it ends (-1 or 1; 0 where it lasts until t_end), and t and x there.
    """

    def rates(t: float, y: Any) -> tuple[float, float]:
        if mode > 3:
            return y[1], 0.0
        return y[1], force(q, mode, t, y[0], y[1])

    def margin(place: int, t: float, y: Any) -> float:
        return margins(q, mode, t, y[0], y[1])[place]

    ends: list[Any] = [partial(margin, 0), partial(margin, 1)]
    for end in ends:
        end.terminal = True
        end.direction = -1
    solution = solve_ivp(
        rates,
        (t, t_end),
        (x, v),
        method="DOP853",
        events=ends,
        rtol=TOLERANCE,
        atol=TOLERANCE,
        max_step=q.period / STEPS_PER_PERIOD,
    )
    if not solution.success:
        raise PeerError(solution.message)
    for side, times in zip((-1, 1), solution.t_events, strict=True):
        if len(times):
            return side, float(solution.t[-1]), float(solution.y[0, -1])
    return 0, t_end, float(solution.y[0, -1])


class Law:
    """A motion with static friction and friction curves: belts with a speed, a curve and a limit.

    Domain n is between the belts n - 1 and n, counted from 0 by speed.
    """

    def __init__(self, scene: Any) -> None:
        p = scene.parameters
        self.scene = scene
        names = ("m", "c", "k", "A0", "B0", "Omega")
        self.m, self.c, self.k, self.A0, self.B0, self.Omega = (float(getattr(p, n)) for n in names)
        self.FN = float(p.FN)
        self.belts = p.belts
        self.speeds = [float(belt.v) for belt in p.belts]
        self.curves = [np.array(belt.curve or [(0, belt.mu)], dtype=float).T for belt in p.belts]
        self.excess = [self.FN * float(belt.mu_s - belt.mu) for belt in p.belts]

    def friction(self, n: int, v: float) -> float:
        """Return the kinetic friction of belt n."""
        w = abs(v - self.speeds[n])
        ws, mus = self.curves[n]
        beyond = max(w - ws[-1], 0.0) * float(self.belts[n].slope)
        return self.FN * (float(np.interp(w, ws, mus)) + beyond)

    def force(self, domain: int, t: float, x: float, v: float) -> float:
        """Return m v' in a domain."""
        total = self.A0 + self.B0 * cos(self.Omega * t) - self.k * x - self.c * v
        for n in range(len(self.speeds)):
            total += self.friction(n, v) * (1 if n >= domain else -1)
        return total

    def decide(self, n: int, t: float, x: float) -> int | None:
        """Return the domain that follows a contact with belt n; None: the mass sticks."""
        v = self.speeds[n]
        if self.force(n, t, x, v) + self.excess[n] <= 0:
            return n
        if self.force(n + 1, t, x, v) - self.excess[n] >= 0:
            return n + 1
        return None

    def run(self, rates: Any, t: float, y: list[float], ends: list[tuple[Any, int]]) -> Any:
        """Integrate until one of the functions `ends` passes 0 in its direction, or t_end."""
        functions = []
        for function, direction in ends:
            end = partial(function)
            end.terminal = True  # type: ignore[attr-defined]
            end.direction = direction  # type: ignore[attr-defined]
            functions.append(end)
        step = 6.283 / max(self.Omega, (self.k / self.m) ** 0.5) / LAW_STEPS
        solution = solve_ivp(
            rates, (t, float(self.scene.t_end)), y, "DOP853",
            events=functions, rtol=TOLERANCE, atol=TOLERANCE, max_step=step,
        )  # fmt: skip
        which = [n for n, times in enumerate(solution.t_events) if len(times)]
        return float(solution.t[-1]), solution.y[:, -1].tolist(), which[0] if which else None

    def stick(self, n: int, t: float, x: float) -> tuple[float, float, int | None]:
        """Follow a stick; return where it ends, and the domain after it."""
        v = self.speeds[n]
        ends = [
            (lambda t, y: self.force(n, t, y[0], v) + self.excess[n], -1),
            (lambda t, y: self.force(n + 1, t, y[0], v) - self.excess[n], 1),
        ]
        t, (x,), which = self.run(lambda t, y: [v], t, [x], ends)
        return t, x, None if which is None else n + which

    def fly(self, domain: int, t: float, x: float, v: float) -> tuple[float, float, int | None]:
        """Follow a flight; return where it ends, and the belt there."""
        near = [n for n in (domain - 1, domain) if 0 <= n < len(self.speeds)]
        ends = [(lambda t, y, n=n: y[1] - self.speeds[n], 1 if n == domain else -1) for n in near]
        t, (x, _), which = self.run(
            lambda t, y: [y[1], self.force(domain, t, y[0], y[1]) / self.m], t, [x, v], ends
        )
        return t, x, None if which is None else near[which]

    def events(self) -> Iterator[tuple[float, float, str, int]]:
        """Yield t, x, kind and belt of each event."""
        scene = self.scene
        t, x, v = float(scene.t0), float(scene.x0), float(scene.v0)
        belt = self.speeds.index(v) if v in self.speeds else None
        domain: int | None = sum(v > speed for speed in self.speeds)
        if belt is not None:
            domain = self.decide(belt, t, x)
        while True:
            if domain is None:
                assert belt is not None
                t, x, domain = self.stick(belt, t, x)
                if domain is None:
                    return
                yield t, x, "slip", belt + 1
                v = self.speeds[belt]
            t, x, belt = self.fly(domain, t, x, v)
            if belt is None:
                return
            v = self.speeds[belt]
            domain = self.decide(belt, t, x)
            yield t, x, "stick" if domain is None else "cross", belt + 1


def rows_of_law(case: Path) -> Iterator[tuple[Any, ...]]:
    """Yield the rows of results of a case under another friction law."""
    scene = load_scene(case / "case.toml")
    begin = time.perf_counter()
    with processor_limit(LIMIT):
        events = list(Law(scene).events())
    seconds = time.perf_counter() - begin
    for t, x, kind, belt in events:
        yield case.name, repr(t), repr(x), kind, belt, ""
    yield case.name, repr(float(scene.t_end)), "", "end", "", f"{seconds:.3g}"


def rows_of(case: Path, follow: Callable[..., Any]) -> Iterator[tuple[Any, ...]]:
    """Yield the rows of results of a case: a row for each event, and one for the end."""
    scene = load_scene(case / "case.toml")
    begin = time.perf_counter()
    with processor_limit(LIMIT):
        events = list(follow(scene)())
    seconds = time.perf_counter() - begin
    for event in events:
        yield case.name, repr(event.t), repr(event.x), event.kind, event.boundary, ""
    yield case.name, repr(float(scene.t_end)), "", "end", "", f"{seconds:.3g}"


def main() -> None:
    """Follow the cases of a table, cases.csv, and write the events.

    Both files are named on the command line.
    """
    table, results = map(Path, sys.argv[1:])
    follow = partial(runner, functions=with_solver(leave), settings=None, offset=0.0)
    with table.open(newline="") as file, results.open("w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["case", "t", "x", "kind", "boundary", "seconds"])
        for row in csv.DictReader(file):
            if row["periods"] != "0":  # 1e5 periods take too long
                continue
            _write(writer, row["name"], partial(rows_of, table.parent / row["name"], follow))
        laws = table.parent / "laws.csv"
        if laws.exists():
            for line in laws.read_text(encoding="utf-8").splitlines()[1:]:
                name, *_ = line.split(",")
                _write(writer, name, partial(rows_of_law, table.parent / name))


def _write(writer: Any, name: str, rows: Callable[[], Iterator[tuple[Any, ...]]]) -> None:
    """Write the rows of a case, if the solver comes to its end."""
    try:
        writer.writerows(list(rows()))
    except (TimeoutError, PeerError) as error:
        print(f"{name} is left out: {error}", file=sys.stderr)


if __name__ == "__main__":
    main()
