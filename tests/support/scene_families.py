"""Random scenes that attack the engine, one seeded generator per family.

Every scene is reproducible from (family, seed, number). Numbers are exact Fractions. Where the
motion is known in closed form by construction, the scene carries its events (`truth`), so no oracle
is needed to judge it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi, sqrt
from random import Random
from typing import Any

from oracle import OracleRun

from symosc import Parameters

# (domain, belt, sign of the velocity's extremum that touches) of the mappings that can graze
TOUCHES = {"P2": (1, 1, 1), "P3": (2, 1, -1), "P5": (2, 2, 1), "P6": (3, 2, -1)}
TRIPLES = [
    (3, 4, 5),
    (4, 3, 5),
    (5, 12, 13),
    (12, 5, 13),
    (8, 15, 17),
    (15, 8, 17),
    (7, 24, 25),
    (20, 21, 29),
]


@dataclass(frozen=True)
class FuzzScene:
    """A scene, and what is known about it.

    Attributes
    ----------
    touch : bool
        It has contacts that are exact touches, or nearer to one than doubles tell: they may end it
        as "undecidable".
    dps : int
        Digits that an oracle needs to tell what happens.
    truth : callable, optional
        Returns the run in closed form.
    """

    family: str
    number: int
    p: Parameters
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    touch: bool = False
    dps: int = 33
    truth: Callable[[], OracleRun] | None = None

    def snippet(self) -> str:
        """Return Python that makes the scene again."""
        names = ("m", "c", "k", "A0", "B0", "Omega", "v1", "v2", "mu1", "mu2", "FN")
        values = ", ".join(f"{name}={text(getattr(self.p, name))}" for name in names)
        start = ", ".join(
            f"{name}={text(getattr(self, name))}" for name in ("t0", "x0", "v0", "t_end")
        )
        return f"p = Parameters({values})\nsimulate(p, {start})"


def text(value: Fraction) -> str:
    """Return a number as Python source that is read back exactly."""
    if value.denominator == 1:
        return str(value)
    return f'"{value}"'


with_digits = replace

# -- drawing numbers -------------------------------------------------------------------------------------------------


def size(rng: Random, low: float, high: float, digits: int = 3) -> Fraction:
    """Return a positive number, log-uniform between powers of ten, with a few digits."""
    return Fraction(f"{10 ** rng.uniform(low, high):.{digits}g}")


def signed(rng: Random, low: float, high: float, digits: int = 3) -> Fraction:
    return rng.choice([1, -1]) * size(rng, low, high, digits)


def tenth(rng: Random, low: float, high: float) -> Fraction:
    return Fraction(round(10 * rng.uniform(low, high)), 10)


def periods(p: Parameters, count: float) -> Fraction:
    """Return a time of about `count` forcing periods."""
    return Fraction(f"{count * 2 * pi / float(p.Omega):.6g}")


def fastest(p: Parameters) -> float:
    return float(p.c / p.m) + sqrt(p.k / p.m) + float(p.Omega)


def span(rng: Random, p: Parameters, least: float, most: float, turns: float = 600) -> Fraction:
    """Return a time of so many forcing periods, less if the fastest rate turns too often for an oracle."""
    length = min(rng.uniform(least, most) * 2 * pi / float(p.Omega), turns / fastest(p))
    return Fraction(f"{length:.5g}")


# -- wide random -----------------------------------------------------------------------------------------------------


def wide_parameters(rng: Random) -> Parameters:
    """Return parameters of any damping regime, with special values mixed in."""
    m = size(rng, -1, 1)
    Omega = size(rng, -1, 1)
    k = size(rng, -1.5, 1.5)
    zeta = size(rng, -2, 0.7)
    c = Fraction(f"{2 * float(zeta) * sqrt(float(k * m)):.3g}")
    special = ["c=0", "k=0", "free", "critical", "resonance", "near resonance", "near critical"]
    kind = rng.choice(["plain"] * 8 + special)
    if kind in ("c=0", "free"):
        c = Fraction(0)
    if kind in ("k=0", "free"):
        k = Fraction(0)
    if kind in ("critical", "near critical"):
        k = c * c / (4 * m)
    if kind == "near critical":
        k *= 1 + signed(rng, -14, -4, 2)
    if kind in ("resonance", "near resonance"):
        k = m * Omega**2
        c = rng.choice([c, Fraction(0), size(rng, -12, -3, 2)])
    if kind == "near resonance":
        k *= 1 + signed(rng, -14, -3, 2)
    B0 = rng.choice([1] * 3 + [-1]) * size(rng, -1, 1.5)
    B0 = rng.choice([B0] * 9 + [Fraction(0)])
    speed = float(abs(B0)) / sqrt(float(k / Omega - m * Omega) ** 2 + float(c) ** 2 + 1e-4)
    scale = min(max(speed, 1e-2), 1e2)
    v1 = Fraction(f"{scale * rng.uniform(-1.3, 1):.3g}")
    v2 = v1 + Fraction(f"{scale * 10 ** rng.uniform(-2, 0.3):.3g}")
    still = rng.random()
    if still < 0.12 and v2 > 0:
        v1, v2 = (Fraction(0), v2)
    elif still < 0.24 and v1 < 0:
        v1, v2 = (v1, Fraction(0))
    else:
        v1, v2 = (v1, v2)
    mu1, mu2 = (rng.choice([Fraction(0)] + [Fraction(rng.randint(1, 999), 1000)] * 6) for _ in "12")
    A0 = rng.choice([Fraction(0), signed(rng, -1.5, 1.5)])
    return Parameters(
        m=m,
        c=c,
        k=k,
        A0=A0,
        B0=B0,
        Omega=Omega,
        v1=v1,
        v2=v2,
        mu1=mu1,
        mu2=mu2,
        FN=size(rng, -1.5, 1),
    )


def wide_start(rng: Random, p: Parameters) -> tuple[Fraction, Fraction, Fraction]:
    width = p.v2 - p.v1
    inside = p.v1 + width * Fraction(rng.randint(-20, 30), 10)
    v0 = rng.choice([inside, inside, p.v1, p.v2, Fraction(0)])
    if p.k:
        rest = p.A0 / p.k
    else:
        rest = Fraction(0)
    x0 = Fraction(f"{float(rest) + rng.choice([0, 0.1, 1, 3]) * rng.uniform(-1, 1):.4g}")
    return rng.choice([Fraction(0), tenth(rng, -20, 100)]), x0, v0


def wide(rng: Random, number: int) -> FuzzScene:
    p = wide_parameters(rng)
    t0, x0, v0 = wide_start(rng, p)
    return FuzzScene("wide", number, p, t0, x0, v0, t0 + span(rng, p, 2, 30))


def long(rng: Random, number: int) -> FuzzScene:
    """Hundreds of forcing periods."""
    p = wide_parameters(rng)
    t0, x0, v0 = wide_start(rng, p)
    return FuzzScene("long", number, p, t0, x0, v0, t0 + span(rng, p, 100, 500, 6000))


def late(rng: Random, number: int) -> FuzzScene:
    """Starts at so late a time that a double knows it to few digits."""
    p = wide_parameters(rng)
    _, x0, v0 = wide_start(rng, p)
    t0 = rng.choice(
        [size(rng, 3, 8, rng.randint(3, 15)), size(rng, 8, 12, 6) / p.Omega.limit_denominator(10)]
    )
    t0 = Fraction(round(t0 * 1000), 1000)
    return FuzzScene("late", number, p, t0, x0, v0, t0 + span(rng, p, 2, 20))


def digits(rng: Random, number: int) -> FuzzScene:
    """Starts with 18 to 45 digits: they are exact, however many there are."""
    p = wide_parameters(rng)
    t0, x0, v0 = wide_start(rng, p)
    tail = lambda: Fraction(rng.randrange(10**17, 10**44), 10 ** rng.randint(45, 48))  # noqa: E731
    if v0 not in (p.v1, p.v2):
        v0 += tail()
    return FuzzScene(
        "digits",
        number,
        p,
        t0 + rng.choice([0, 1]) * tail(),
        x0 + tail(),
        v0,
        t0 + span(rng, p, 2, 12),
    )


def coincide(rng: Random, number: int) -> FuzzScene:
    """Two belts of nearly the same speed, weak friction.

    Events that follow each other within an ulp.
    """
    p = wide_parameters(rng)
    v1 = rng.choice([p.v1, Fraction(f"{float(p.v1):.2g}")])
    gap = size(rng, -15, -6, rng.choice([1, 3]))
    weak = rng.choice([Fraction(1), Fraction(1, 10), Fraction(0)])
    p = p.replace(v1=v1, v2=v1 + gap, mu1=p.mu1 * weak, mu2=p.mu2 * rng.choice([weak, 1]))
    t0, x0, v0 = wide_start(rng, p)
    t0 = rng.choice([t0, t0 + 10 ** rng.randint(3, 6)])
    v0 = rng.choice([v0, p.v1, p.v2, p.v1 + (p.v2 - p.v1) / 3, tenth(rng, -3, 3)])
    return FuzzScene("coincide", number, p, t0, x0, v0, t0 + span(rng, p, 2, 15))


def extreme(rng: Random, number: int) -> FuzzScene:
    """Parameters of very different sizes.

    Light and heavy masses, weak springs, slow and fast drives.
    """
    p = wide_parameters(rng)
    zero = Fraction(0)

    def light() -> dict[str, Any]:
        numbers = {"m": size(rng, -7, -4), "k": rng.choice([0, p.k]), "Omega": size(rng, -7, -1)}
        return numbers | {"c": rng.choice([zero, size(rng, -9, -4)])}

    def scaled() -> dict[str, Any]:
        scale = size(rng, -6, 6, 1)
        return {name: getattr(p, name) * scale for name in ("v1", "v2", "A0", "B0", "FN")}

    changes: list[Callable[[], dict[str, Any]]] = [
        light,
        lambda: {"m": size(rng, -5, -2), "Omega": size(rng, 0, 1.5), "c": size(rng, -3, -1)},
        lambda: {"k": size(rng, -12, -4), "c": rng.choice([p.c, 0, size(rng, -9, -3)])},
        lambda: {"Omega": size(rng, 1, 4)},
        lambda: {"Omega": size(rng, -6, -2)},
        lambda: {"m": size(rng, 2, 7), "B0": signed(rng, 0, 6)},
        scaled,
    ]
    p = p.replace(**changes[rng.randrange(7)]())
    t0, x0, v0 = wide_start(rng, p)
    return FuzzScene("extreme", number, p, t0, x0, v0, t0 + span(rng, p, 1, 20, 2000))


# -- starts on a belt --------------------------------------------------------------------------------------------------


def onbelt(rng: Random, number: int) -> FuzzScene:
    """A start on a belt where a force is exactly 0, or tiny."""
    p = wide_parameters(rng)
    if not p.k:
        p = p.replace(k=size(rng, -1, 1))
    if rng.random() < 0.4:
        p = p.replace(
            **rng.choice(
                [{"v1": Fraction(0), "v2": max(p.v2, -p.v2, Fraction(1))}, {"B0": Fraction(0)}]
            )
        )
    boundary = rng.choice([1, 2])
    alpha = boundary + rng.choice([0, 1])
    speed = (p.v1, p.v2)[boundary - 1]
    x0 = (p.A(alpha) + p.B0 - p.c * speed) / p.k
    tiny = rng.choice([0, 0, signed(rng, -12, -6, 1), signed(rng, -30, -14, 1)])
    scene = FuzzScene("onbelt", number, p, Fraction(0), x0 + tiny, speed, span(rng, p, 2, 15))
    if abs(tiny) > 1e-15:
        return scene
    return with_digits(scene, touch=True, dps=70)


def shortened(scene: FuzzScene, part: Fraction) -> FuzzScene:
    """Return the first part of a scene; its closed form loses the state at the end."""
    t_end = scene.t0 + (scene.t_end - scene.t0) * part
    whole = scene.truth

    def truth() -> OracleRun:
        run = whole()
        return OracleRun(
            [event for event in run.events if event.t <= t_end.numerator / t_end.denominator],
            run.mode,
        )

    return with_digits(scene, t_end=t_end, truth=truth if whole else None)


def rest(rng: Random, number: int) -> FuzzScene:
    """Equilibria, belts at rest, sticks for ever."""
    p = wide_parameters(rng)
    kind = rng.randrange(5)
    if kind == 0:  # at rest in a domain, with no drive
        p = p.replace(B0=0, v1=tenth(rng, -3, -0.5), v2=tenth(rng, 0.5, 3), k=size(rng, -1, 1))
        x0 = p.A(2) / p.k
        v0 = Fraction(0)
    elif kind == 1:  # a belt at rest that holds
        p = p.replace(v1=0, v2=abs(p.v2) + 1, mu1=1, FN=abs(p.B0) + abs(p.A0) + 1)
        x0 = Fraction(0)
        v0 = rng.choice([Fraction(0), tenth(rng, -5, 5)])
    elif kind == 2:  # no spring, held for ever by a moving belt
        p = p.replace(k=0, mu2=1, FN=abs(p.B0) + abs(p.A0) + abs(p.c * p.v2) + 1)
        x0 = Fraction(0)
        v0 = rng.choice([p.v2, p.v2 + tenth(rng, -1, 1)])
    elif kind == 3:  # settling by friction and damping, with no drive
        p = p.replace(
            B0=0, **rng.choice([{"v1": 0, "v2": abs(p.v2) + 1}, {"v2": 0, "v1": -abs(p.v1) - 1}])
        )
        x0 = tenth(rng, -5, 5)
        v0 = tenth(rng, -5, 5)
    else:  # no drive, moving belts
        p = p.replace(B0=0)
        _, x0, v0 = wide_start(rng, p)
    return FuzzScene("rest", number, p, Fraction(0), x0, v0, span(rng, p, 2, 60, 1500), dps=60)


def undriven(rng: Random, number: int) -> FuzzScene:
    """No drive. Without damping a mass that slips off a belt comes back to it in exact grazes, period after period."""
    p = wide_parameters(rng)
    k = p.k or size(rng, -1, 1)
    p = p.replace(
        B0=0,
        k=k,
        c=rng.choice([Fraction(0), Fraction(0), p.c]),
        Omega=rng.choice([p.Omega, Fraction(1, 1000)]),
    )
    if rng.random() < 0.3:
        p = p.replace(
            **rng.choice([{"v1": 0, "v2": abs(p.v2) + 1}, {"v2": 0, "v1": -abs(p.v1) - 1}])
        )
    _, x0, v0 = wide_start(rng, p)
    t_end = Fraction(f"{rng.uniform(2, 40) * 2 * pi * sqrt(p.m / p.k):.4g}")
    return FuzzScene("undriven", number, p, Fraction(0), x0, v0, t_end, touch=p.c == 0, dps=40)
