"""What the scripts of this folder share: closed forms, runs, and the table of both.

    x'' + c x' + x = P cos(Omega t) - F sgn(x')

Closed forms know nothing of symosc and have 30 digits. They hold for c = 0, underdamped, critically
damped and overdamped alike, because mpmath's sine takes complex numbers.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable
from decimal import Decimal
from fractions import Fraction
from functools import cache
from math import pi
from typing import Any, NamedTuple

import mpmath
import numpy as np

from symosc import Parameters, Trajectory, simulate
from symosc.reference.cases import wall

MP = mpmath.MPContext()
MP.dps = 30


def number(value: Any) -> Any:
    """Return a number, or its text, with 30 digits."""
    if isinstance(value, Fraction):
        return MP.mpf(value.numerator) / value.denominator
    return MP.mpf(value)


# --- closed forms ---


class Free(NamedTuple):
    """The solution E1 of x'' + c x' + x = 0 from (x, v) = (0, 1) at a time, and its derivative E0."""

    c: Any
    E0: Any
    E1: Any

    def carry(self, x: Any, v: Any) -> tuple[Any, Any]:
        """Return position and velocity of the motion that starts at (x, v)."""
        return (self.E0 + self.c * self.E1) * x + self.E1 * v, self.E0 * v - self.E1 * x


def free(c: Any, time: Any) -> Free:
    """Return the free motion with damping c at a time."""
    h = c / 2
    turned = MP.sqrt(1 - h * h) * time
    fall = MP.exp(-h * time)
    E1 = MP.re(fall * time * MP.sinc(turned))
    E0 = MP.re(fall * MP.cos(turned)) - h * E1
    return Free(c, E0, E1)


class Symmetric:
    """The symmetric motion without stops, as Den Hartog found it.

    From the highest point x_0 on, with the angle phi since then, it is F + p cos(phi) + q sin(phi)
    plus a free motion. Half a period later it is at -x_0.
    """

    def __init__(self, F: Any, Omega: Any, c: Any = 0, P: Any = 1) -> None:
        self.F = number(F)
        self.Omega = number(Omega)
        self.c = number(c)
        self.P = number(P)
        self.half = free(self.c, MP.pi / self.Omega)
        determinant = MP.exp(-self.c * MP.pi / self.Omega)
        trace = 2 * self.half.E0 + self.c * self.half.E1
        below = 1 + trace + determinant
        self.G = (1 - determinant - self.c * self.half.E1) / below
        self.H = 2 * self.half.E1 / (self.Omega * below)
        #: The amplitude without friction, for P = 1.
        self.gain = 1 / MP.sqrt((1 - self.Omega**2) ** 2 + (self.c * self.Omega) ** 2)
        p_squared = (self.P * self.gain) ** 2 - (self.H * self.F) ** 2
        self.p = MP.sqrt(p_squared)
        self.q = self.H * self.F
        self.highest = self.p - self.G * self.F

    def multipliers(self) -> tuple[Any, Any]:
        """Return sum and product of the multipliers (Shaw's, from half a period)."""
        push = -(self.Omega**2) * self.p + self.c * self.Omega * self.q + self.p - self.highest
        after = push + self.F
        before = push - self.F
        ratio = after / before
        trace = self.half.E0 + self.c * self.half.E1 + ratio * self.half.E0
        determinant = ratio * MP.exp(-self.c * MP.pi / self.Omega)
        return trace**2 - 2 * determinant, determinant**2

    def acceleration_after_turning(self) -> Any:
        """Return x'' just after the highest point: it is 0 where the mass begins to stick there."""
        push = -(self.Omega**2) * self.p + self.c * self.Omega * self.q + self.p - self.highest
        return push + self.F

    def drive_at_peak(self) -> Any:
        """Return what is 0 where the mass turns just when the drive has its peak."""
        return (1 - self.Omega**2) * self.q - self.c * self.Omega * self.p

    def slide_bound(self, angle: Any) -> Any:
        """Return B: at an angle after the highest point the mass moves down iff p > B F."""
        here = free(self.c, angle / self.Omega)
        rate = (1 + self.G) * here.E1 / self.Omega - self.H * here.E0
        return (rate + self.H * MP.cos(angle)) / MP.sin(angle)

    def largest_slide_bound(self) -> tuple[Any, Any]:
        """Return the supremum of B over (0, pi), and its angle: 0 if it is the limit there."""
        limit = (1 + self.G) / self.Omega**2 + self.H * self.c / self.Omega
        angles = np.linspace(0, pi, 4001)[1:-1]
        bounds = self._bounds_in_doubles(angles)
        top = int(np.argmax(bounds))
        if bounds[top] <= limit + 1e-10 * abs(limit):
            return limit, MP.mpf(0)

        def slope(angle: Any) -> Any:
            return MP.diff(self.slide_bound, angle)

        low = angles[top - 1] if top else angles[0] / 100
        if slope(low) <= 0:
            return limit, MP.mpf(0)
        angle = MP.findroot(slope, (low, angles[top + 1]), solver="anderson")
        return self.slide_bound(angle), angle

    def _bounds_in_doubles(self, angles: Any) -> Any:
        c = float(self.c)
        times = angles / float(self.Omega)
        turned = np.sqrt(complex(1 - c * c / 4)) * times
        fall = np.exp(-c / 2 * times)
        E1 = (fall * times * np.sinc(turned / pi)).real
        E0 = (fall * np.cos(turned)).real - c / 2 * E1
        H = float(self.H)
        rate = float(1 + self.G) * E1 / float(self.Omega) - H * E0
        return (rate + H * np.cos(angles)) / np.sin(angles)

    def largest_force_ratio(self) -> Any:
        """Return the largest F/P for which the symmetric motion has no stops."""
        bound, _ = self.largest_slide_bound()
        return self.gain / MP.sqrt(bound**2 + self.H**2)


class Slides:
    """Half a cycle with stops (P = 1): slides down, each from where the stop before it ends.

    A stop ends at x = cos(theta) + F. Each slide ends at rest where the next one starts, the last
    one at minus the start of the first: 2 n equations for n phases and n durations.
    """

    def __init__(self, Omega: Any, c: Any = 0) -> None:
        self.Omega = number(Omega)
        self.c = number(c)
        stiff = 1 - self.Omega**2
        damp = self.c * self.Omega
        self.p = stiff / (stiff**2 + damp**2)
        self.q = damp / (stiff**2 + damp**2)

    def state(self, F: Any, phase: Any, time: Any) -> tuple[Any, Any]:
        """Return position and velocity of a slide, a time after it starts at a phase."""
        later = phase + self.Omega * time
        x, v = self._steady(phase)
        dx, dv = free(self.c, time).carry(MP.cos(phase) - x, -v)
        x, v = self._steady(later)
        return F + x + dx, v + dv

    def acceleration(self, F: Any, phase: Any, time: Any) -> Any:
        """Return the acceleration of a slide."""
        x, v = self.state(F, phase, time)
        return MP.cos(phase + self.Omega * time) - x - self.c * v + F

    def equations(self, F: Any, phases: Any, times: Any) -> list[Any]:
        """Return what is 0 if each slide ends at rest where the next one starts."""
        ends = self.ends(F, phases)
        states = [self.state(F, phase, time) for phase, time in zip(phases, times, strict=True)]
        gaps = [x - end for (x, _), end in zip(states, ends, strict=True)]
        return [v for _, v in states] + gaps

    def ends(self, F: Any, phases: Any) -> list[Any]:
        """Return where each slide ends."""
        starts = [MP.cos(phase) + F for phase in phases]
        return [*starts[1:], -starts[0]]

    def _steady(self, phase: Any) -> tuple[Any, Any]:
        x = self.p * MP.cos(phase) + self.q * MP.sin(phase)
        v = self.Omega * (self.q * MP.cos(phase) - self.p * MP.sin(phase))
        return x, v


def stop_positions(p: Parameters) -> list[Any]:
    """Solve for the positions of the stops in half a settled cycle (P = 1), the highest first."""
    few = (stops(p) or 0) // 2
    runs = slides_seen(p, few)
    equations = Slides(p.Omega, p.c)
    F = number(p.mu1)
    guess = [*(phase for phase, _, _ in runs), *(time for _, time, _ in runs)]

    def residuals(*unknowns: Any) -> list[Any]:
        return equations.equations(F, unknowns[:few], unknowns[few:])

    phases = list(MP.findroot(residuals, guess))[:few]
    return sorted((abs(MP.cos(phase) + F) for phase in phases), reverse=True)


# --- runs ---


def from_rest(p: Parameters, cycles: int) -> Trajectory:
    """Simulate the first cycles of the motion from rest at x = 0."""
    t_end = Fraction(cycles * (2 * pi / float(p.Omega)))
    return simulate(p, t0=0, x0=0, v0=0, t_end=t_end, accuracy=1e-6)


@cache
def stops(p: Parameters) -> int | None:
    """Count the stops per cycle of the settled motion from rest; None if it does not settle."""
    turn = 2 * pi / float(p.Omega)
    for cycles in (8, 30, 120, 480, 1920):
        path = from_rest(p, cycles + 2)
        before = path((cycles + 0.5) * turn)
        after = path((cycles + 1.5) * turn)
        if np.abs(after - before).max() < 1e-12 * (1 + np.abs(after).max()):
            onsets = [event.t / turn for event in path.events if event.kind == "stick"]
            return sum(cycles + 0.5 <= onset < cycles + 1.5 for onset in onsets)
    return None


def slides_seen(p: Parameters, count: int) -> list[tuple[float, float, Any]]:
    """Return phase, duration and (start, end, path) of simulated slides down in a settled cycle."""
    path = from_rest(p, 22)
    late = [event for event in path.events if event.t > 40 * pi / float(p.Omega)]
    pairs = [(slip, stick) for slip, stick in itertools.pairwise(late) if slip.kind == "slip"]
    targets = [slip.target for slip, _ in pairs]
    turns = itertools.pairwise(targets)
    first = next(i for i, turn in enumerate(turns, 1) if turn == ("Omega2", "Omega1"))
    return [
        (float(p.Omega) * slip.t, stick.t - slip.t, (slip, stick, path))
        for slip, stick in pairs[first : first + count]
    ]


class Border(NamedTuple):
    """Two values of F/P close to each other with different numbers of stops per cycle."""

    low: float
    high: float
    below: int
    above: int

    @property
    def middle(self) -> float:
        """The border, to 1e-8."""
        return (self.low + self.high) / 2

    @property
    def note(self) -> str:
        """The numbers of stops, in words."""
        return f"{self.below} stops below, {self.above} above"


@cache
def find_border(low: Any, high: Any, Omega: Any, c: Any = 0) -> Border:
    """Bisect F/P until the number of stops per cycle changes within 1e-8."""

    def count(ratio: Fraction) -> int:
        settled = stops(wall(1, Omega, c, P=1 / ratio))
        assert settled is not None, f"the motion at F/P = {float(ratio)} does not settle"
        return settled

    a = Fraction(low)
    b = Fraction(high)
    below = count(a)
    above = count(b)
    assert below != above, f"{below} stops at F/P = {low} and at {high}"
    while b - a > 1e-8 * a:
        middle = (a + b) / 2
        seen = count(middle)
        if seen == below:
            a = middle
        else:
            b = middle
            above = seen
    return Border(float(a), float(b), below, above)


# --- the table of both ---


class Row(NamedTuple):
    """A number computed twice; what is not named in its case is 1 (P) or 0 (c)."""

    name: str
    case: str
    formula: Any
    run: Any
    decimals: int = 12
    tolerance: float = 1e-12
    note: str = ""

    @property
    def difference(self) -> float:
        """The difference of both, relative to the formula's value unless that is 0."""
        formula = number(self.formula)
        return float(abs(formula - number(self.run)) / (abs(formula) or 1))


def decimal(value: Any, places: int) -> str:
    """Return a number, or its text, rounded to some decimal places."""
    return f"{Decimal(MP.nstr(number(value), MP.dps)):.{places}f}"


def show(rows: Callable[[], Iterable[Row]]) -> None:
    """Print a table, with its title; a row whose numbers differ is an error."""
    print(f"{(rows.__doc__ or '').strip().rstrip('.')}:")
    lines = []
    for row in rows():
        assert row.difference <= row.tolerance, row
        numbers = [decimal(value, row.decimals) for value in (row.formula, row.run)]
        lines.append((row.name, row.case, *numbers, f"{row.difference:.0e}", row.note))
    heads = ("", "", "formula", "run", "difference", "")
    widths = [max(map(len, column)) for column in zip(heads, *lines, strict=True)]
    for name, case, formula, run, difference, note in (heads, *lines):
        cells = (
            name.ljust(widths[0]),
            case.ljust(widths[1]),
            formula.rjust(widths[2]),
            run.rjust(widths[3]),
            difference.rjust(widths[4]),
            note,
        )
        print("  ".join(cells).rstrip())
