"""Families of scenes whose motion is known in closed form.

Exact periodic grazes, near misses, creeping approaches.

A periodic motion v = V + alpha cos(Omega t) + beta sin(Omega t) with rational alpha, beta and a
rational amplitude solves the equation of one domain exactly, in rational numbers; a belt that runs
at its fastest or slowest speed is grazed once in every period. Belts that a decaying exponential
approaches are never reached.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import pi, sin
from random import Random
from typing import Any

import mpmath
from oracle import OracleEvent, OracleRun, flow_oracle
from scene_families import (
    TOUCHES,
    TRIPLES,
    FuzzScene,
    fastest,
    periods,
    signed,
    size,
    span,
    tenth,
    wide_parameters,
    with_digits,
)

from symosc import Parameters

DIGITS_OF_TRUTH = 60


def number(value: Fraction) -> Any:
    return mpmath.mpf(value.numerator) / value.denominator


@dataclass(frozen=True)
class Periodic:
    """The motion x = X + V t + (alpha sin - beta cos)/Omega, v = V + alpha cos + beta sin of the angle Omega t."""

    Omega: Fraction
    X: Fraction
    V: Fraction
    alpha: Fraction
    beta: Fraction
    amplitude: Fraction

    def state(self, t: Any) -> tuple[Any, Any]:
        Omega, X, V, alpha, beta = map(number, (self.Omega, self.X, self.V, self.alpha, self.beta))
        sine = mpmath.sin(Omega * t)
        cosine = mpmath.cos(Omega * t)
        return X + V * t + (alpha * sine - beta * cosine) / Omega, V + alpha * cosine + beta * sine

    def peaks(self, sign: int, t_end: Fraction) -> list[Any]:
        """Return the times after 0 at which the velocity is largest (sign 1) or smallest (sign -1)."""
        first = mpmath.atan2(sign * number(self.beta), sign * number(self.alpha))
        Omega = number(self.Omega)
        turn = 2 * mpmath.pi
        times = []
        if first <= 0:
            first += turn
        else:
            first += 0
        while (first + turn * len(times)) / Omega <= number(t_end):
            times.append((first + turn * len(times)) / Omega)
        return times


def graze(rng: Random, number: int) -> FuzzScene:
    """Exact touches, once or twice in each period."""
    scene, _, _ = periodic_graze(rng)
    return with_digits(scene, number=number)


def periodic_graze(rng: Random) -> tuple[FuzzScene, int, int]:
    """Return a scene that grazes a belt in every period, the belt, and the side that the touching peak points to."""
    m, Omega, c, k, motion, B0 = periodic_motion(rng)
    word = rng.choice(list(TOUCHES))
    alpha, boundary, side = TOUCHES[word]
    top = motion.V + motion.amplitude
    bottom = motion.V - motion.amplitude
    room = size(rng, -1.5, 1)
    both = alpha == 2 and rng.random() < 0.25
    v1, v2 = {
        "P2": (top, top + room),
        "P3": (bottom, top if both else top + room),
        "P5": (bottom if both else bottom - room, top),
        "P6": (bottom - room, bottom),
    }[word]
    mu1, mu2 = (rng.choice([Fraction(0), Fraction(rng.randint(1, 99), 100)]) for _ in "12")
    p = Parameters(
        m=m, c=c, k=k, A0=0, B0=B0, Omega=Omega, v1=v1, v2=v2, mu1=mu1, mu2=mu2, FN=size(rng, -1, 1)
    )
    p = p.replace(A0=k * motion.X + c * motion.V - p.A(alpha))
    x0 = motion.X - motion.beta / Omega
    v0 = motion.V + motion.alpha
    t_end = periods(p, rng.choice([5, 15, 15, 40, 100]) + rng.uniform(0.1, 0.9))
    if both:
        belts = {1: [-1], 2: [1]}
    else:
        belts = {boundary: [side]}
    truth = partial(
        graze_truth, motion, alpha, {b: sides[0] for b, sides in belts.items()}, p, t_end
    )
    scene = FuzzScene("graze", 0, p, Fraction(0), x0, v0, t_end, touch=True, dps=50, truth=truth)
    return scene, boundary, side


def periodic_motion(
    rng: Random,
) -> tuple[Fraction, Fraction, Fraction, Fraction, Periodic, Fraction]:
    """Return m, Omega, c, k, the motion and B0."""
    kind = rng.choice(
        [
            "plain",
            "plain",
            "plain",
            "over",
            "critical",
            "resonance",
            "undamped",
            "no spring",
            "free",
        ]
    )
    Omega = rng.choice([Fraction(rng.randint(1, 12), rng.randint(1, 6)), size(rng, -1.3, 1.3, 2)])
    m = rng.choice([Fraction(1), size(rng, -1, 1, 2)])
    if kind in ("undamped", "free"):
        c = Fraction(0)
    else:
        c = rng.choice([Fraction(rng.randint(1, 9)), size(rng, -2, 1, 2)])
    r = signed(rng, -1, 1, rng.choice([1, 2]))
    p, q, h = rng.choice(TRIPLES)
    X = tenth(rng, -3, 3)
    V = Fraction(0)
    if kind in ("no spring", "free"):
        if c:
            m = c * Fraction(p, q) / Omega
        if c:
            amplitude = c * Fraction(h, q)
        else:
            amplitude = m * Omega
        alpha = c * r
        beta = m * Omega * r
        V = tenth(rng, -2, 2)
        motion = Periodic(Omega, X, V, alpha, beta, abs(r) * amplitude)
        return m, Omega, c, Fraction(0), motion, r * amplitude**2
    kappa = rng.choice([1, -1]) * c * Omega * Fraction(p, q)  # k - m Omega^2
    if kind == "over":  # the spring is weak, the mass is light
        m = c / Omega * Fraction(1, rng.randint(10, 40))
        kappa = c * Omega * Fraction(20, 99)
        h = 101
        q = 99
    if kind == "critical":
        kappa = c * c / (4 * m) - m * Omega**2
    if kind == "resonance":
        kappa = Fraction(0)
    if kind == "undamped":
        kappa = signed(rng, -1, 0.5, 2)
    if m * Omega**2 + kappa <= 0:
        kappa = abs(kappa)
    sizes = {
        "critical": c * c / (4 * m) + m * Omega**2,
        "resonance": c * Omega,
        "undamped": abs(kappa),
    }
    amplitude = sizes.get(kind, c * Omega * Fraction(h, q))
    motion = Periodic(Omega, X, V, c * Omega**2 * r, -Omega * kappa * r, Omega * abs(r) * amplitude)
    return m, Omega, c, m * Omega**2 + kappa, motion, r * amplitude**2


def graze_truth(
    motion: Periodic, alpha: int, touched: dict[int, int], p: Parameters, t_end: Fraction
) -> OracleRun:
    mode = f"Omega{alpha}"
    with mpmath.workdps(DIGITS_OF_TRUTH):
        events = [
            OracleEvent(
                t, "graze", boundary, mode, mode, motion.state(t)[0], number(p.belt(boundary))
            )
            for boundary, side in touched.items()
            for t in motion.peaks(side, t_end)
        ]
        x, v = motion.state(number(t_end))
        return OracleRun(sorted(events, key=lambda event: event.t), mode, number(t_end), x, v)


def near(rng: Random, number: int) -> FuzzScene:
    """A peak that misses a belt, or reaches beyond it, by 1e-6 to 1e-30."""
    scene, boundary, _ = periodic_graze(rng)
    exponent = rng.choice([6, 8, 10, 11, 12, 13, 14, 15, 16, 16, 18, 22, 30])
    name = f"v{boundary}"
    shift = Fraction(rng.choice([1, -1]) * rng.randint(1, 9), 10**exponent)
    p = scene.p.replace(**{name: getattr(scene.p, name) + shift})
    t_end = min(scene.t_end, span(rng, p, 3, 15, 800))
    if scene.v0 == getattr(scene.p, name) and rng.random() < 0.5:
        v0 = getattr(p, name)
    else:
        v0 = scene.v0
    if exponent < 14:
        dps = 33
    else:
        dps = 2 * exponent + 30
    return FuzzScene("near", number, p, scene.t0, scene.x0, v0, t_end, touch=exponent > 13, dps=dps)


def approach(rng: Random, number: int) -> FuzzScene:
    """A velocity that tends to a belt's and never gets there.

    V - v_belt is a positive sum of decaying exponentials.
    """
    alpha, boundary, side = TOUCHES[rng.choice(list(TOUCHES))]
    kind = rng.choice(
        ["two", "two", "slow only", "fast only", "critical", "no spring", "no spring"]
    )
    m = size(rng, -1, 1, 2)
    slow = size(rng, -2, 0.5, 2)
    fast = slow * (1 + size(rng, -2, 1.5, 2))
    c1 = size(rng, -1, 1, 2)
    c2 = size(rng, -1, 1, 2)
    if kind == "two" and rng.random() < 0.5:
        c2 = -c1 * Fraction(rng.choice([100, rng.randint(1, 99)]), 100)  # -c1: a start on the belt
    if kind in ("slow only", "no spring"):
        c2 = Fraction(0)
    elif kind == "fast only":
        c1 = Fraction(0)
    if kind == "no spring":
        belt = rng.choice([Fraction(0), tenth(rng, -3, 3)])
    else:
        belt = Fraction(0)
    if kind == "critical":
        fast = slow
    elif kind == "no spring":
        fast = Fraction(0)
    X = tenth(rng, -3, 3)
    room = 2 * (abs(c1) + abs(c2)) + size(rng, -1, 1, 2) + (c2 / slow if kind == "critical" else 0)
    if boundary == 1:
        v1, v2 = (belt, belt + room)
    else:
        v1, v2 = (belt - room, belt)
    mu1, mu2 = (rng.choice([Fraction(0), Fraction(rng.randint(1, 99), 100)]) for _ in "12")
    Omega = rng.choice([size(rng, -3, 1, 2), Fraction(1, 1000)])
    numbers = {
        "m": m,
        "c": m * (slow + fast),
        "k": m * slow * fast,
        "Omega": Omega,
        "mu1": mu1,
        "mu2": mu2,
    }
    p = Parameters(
        **numbers, A0=0, B0=0, v1=v1, v2=v2, FN=size(rng, -1, 1)
    )  # friction is balanced below
    p = p.replace(A0=p.k * X + p.c * belt - p.A(alpha))
    if kind == "critical":  # (c1 + c2 t) e^(-slow t)
        offset = c1 / slow + c2 / slow**2
        v0 = c1
    else:
        offset = c1 / slow + (c2 / fast if fast else 0)
        v0 = c1 + c2
    if kind == "fast only":
        rate = fast
    else:
        rate = slow
    t_end = Fraction(f"{float(rng.choice([5, 40, 100, 500]) / rate):.4g}")
    truth = partial(approach_truth, f"Omega{alpha}")
    return FuzzScene(
        "approach",
        number,
        p,
        Fraction(0),
        X + side * offset,
        belt - side * v0,
        t_end,
        dps=300,
        truth=truth,
    )


def approach_truth(mode: str) -> OracleRun:
    return OracleRun([], mode)


def settle(rng: Random, number: int) -> FuzzScene:
    """A transient that brings a motion ever closer to a periodic graze, which it never reaches.

    The belt is approached from inside by exp(-slow t); doubles cannot tell the touches from misses
    after a while.
    """
    while True:
        scene, boundary, side = periodic_graze(rng)
        p = scene.p
        root = p.c**2 - 4 * p.m * p.k
        if p.k == 0 and p.c > 0:
            rate = p.c / p.m
            offset = p.m / p.c
            break
        if root == 0 and p.c > 0:
            rate = p.c / (2 * p.m)
            offset = 2 * p.m / p.c
            break
    amount = size(rng, -2, 0, 1)
    t_end = min(scene.t_end, Fraction(f"{rng.choice([10, 30, 60]) / float(rate):.4g}"))
    other = 3 - boundary
    gap = p.replace(**{f"v{other}": p.belt(other) + (other * 2 - 3) * 2 * amount})
    return FuzzScene(
        "settle", number, gap, scene.t0, scene.x0 + side * amount * offset, scene.v0 - side * amount, t_end,
        touch=True, dps=90, truth=partial(approach_truth, scene.truth().mode),
    )  # fmt: skip


def limit(rng: Random, number: int) -> FuzzScene:
    """Without a spring the velocity tends to a limit just beyond or just before a belt's speed."""
    alpha, boundary, side = TOUCHES[rng.choice(list(TOUCHES))]
    exponent = rng.choice([6, 9, 12, 14, 16, 20])
    p = wide_parameters(rng).replace(k=0, B0=0)
    rate = size(rng, -1, 0.5, 2)
    p = p.replace(c=p.m * rate)
    belt = p.belt(boundary)
    speed = belt + Fraction(rng.choice([1, -1]) * rng.randint(1, 9), 10**exponent)
    p = p.replace(A0=p.A0 + p.c * speed - p.A(alpha))
    v0 = belt - side * min((p.v2 - p.v1) / 2, size(rng, -1, 1, 2))
    t_end = Fraction(f"{rng.choice([20, 60]) / float(rate):.4g}")
    return FuzzScene("limit", number, p, Fraction(0), tenth(rng, -3, 3), v0, t_end, dps=100)


def creep(rng: Random, number: int) -> FuzzScene:
    """An overdamped mass creeps beside a belt at rest while a weak or slow drive moves it less and less visibly."""
    p = wide_parameters(rng)
    slow = size(rng, -1, 0.3, 2)
    ratio = 1 + size(rng, -1, 1, 2)
    p = p.replace(
        c=p.m * slow * (1 + ratio),
        k=p.m * slow**2 * ratio,
        B0=signed(rng, -20, 0, 2),
        Omega=size(rng, -4, 0, 2),
    )
    p = p.replace(**rng.choice([{"v1": 0, "v2": abs(p.v2) + 1}, {"v2": 0, "v1": -abs(p.v1) - 1}]))
    if p.v1 == 0:
        boundary = 1
    else:
        boundary = 2
    alpha = boundary + rng.choice([0, 1])
    if alpha == boundary:
        side = 1
    else:
        side = -1
    start = size(rng, -1, 0, 2)
    x0 = p.A(alpha) / p.k + side * start / slow
    t_end = Fraction(f"{rng.choice([20, 60, 200]) / float(slow):.4g}")
    return FuzzScene("creep", number, p, Fraction(0), x0, -side * start, t_end, dps=150)


def aimed(rng: Random, index: int) -> FuzzScene:
    """A start that a motion with a touch at t_m has passed, known to 10 to 40 digits.

    It misses by as little as that.

    Some touches are of fourth order, where k v_belt = -B0 Omega sin(Omega t_m) as far as the digits
    go.
    """
    places = rng.choice([10, 14, 16, 18, 20, 25, 30, 40])
    while True:
        p = wide_parameters(rng)
        alpha, boundary, side = TOUCHES[rng.choice(list(TOUCHES))]
        if not p.k or not p.B0:
            continue
        t_m = Fraction(f"{rng.uniform(0.2, 9) / float(p.Omega):.3g}")
        flat = rng.random() < 0.25
        if flat:
            t_m = cut(
                (mpmath.pi / 2) * (4 + side * (1 if p.B0 < 0 else -1)) / number(p.Omega), places
            )
            speed = side * abs(p.B0) * p.Omega / p.k
            if boundary == 1:
                v1, v2 = (speed, speed + p.v2 - p.v1)
            else:
                v1, v2 = (speed - p.v2 + p.v1, speed)
            p = p.replace(v1=v1, v2=v2)
        speed = p.belt(boundary)
        bend = -float(p.k * speed) - float(p.B0 * p.Omega) * sin(float(p.Omega * t_m))
        if flat or side * bend < -0.05 * float(abs(p.B0) * p.Omega):
            break
    tau = Fraction(f"{rng.uniform(0.1, 1) / fastest(p):.3g}")
    with mpmath.workdps(90):
        cosine = mpmath.cos(number(p.Omega * t_m))
        x_m = (number(p.A(alpha) - p.c * speed) + number(p.B0) * cosine) / number(p.k)
        x, v = flow_oracle(p, alpha, t_m, cut(x_m, 85), speed, -tau, 90)[:2]
        x0 = cut(x, places)
        v0 = cut(v, places)
    t0 = t_m - tau
    scene = FuzzScene("aimed", index, p, t0, x0, v0, t_m + span(rng, p, 1, 4, 100))
    return with_digits(scene, touch=places >= 14, dps=2 * places + 40)


def shallow(rng: Random, index: int) -> FuzzScene:
    """A touch as shallow as what the rounding of the phase does to a force, from a launch where that force is small.

    Speeds and friction are small beside the drive, whose force is near 0 at a phase that has large
    rounding errors. Many flights between the belts are launched by a crossing, the others begin at
    the start.
    """
    while True:
        p = wide_parameters(rng)
        alpha, boundary, side = TOUCHES[rng.choice(list(TOUCHES))]
        if p.k and p.B0:
            break
    f0 = abs(p.B0) / p.m
    Omega = size(rng, -3, -1, 2)
    v1 = signed(rng, -5, -3, 2)
    p = p.replace(
        A0=0, FN=p.FN * size(rng, -5, -3, 1), Omega=Omega, v1=v1, v2=v1 + size(rng, -5, -3, 2)
    )
    quarter = rng.choice([1, 3, 3, 3])
    tau = Fraction(f"{rng.uniform(0.05, 0.5) / fastest(p):.3g}")
    angle = (quarter / 2 + 2 * rng.randint(0, 9)) * pi + rng.uniform(-0.03, 0.03)
    # Near a quarter period B0 cos(theta) is steep: it bends the gap away from the belt if B0 has
    # this sign.
    if quarter == 1:
        bends = 1
    else:
        bends = -1
    p = p.replace(B0=side * bends * abs(p.B0))
    t_m = Fraction(f"{angle / float(Omega):.5g}")
    depth = rng.uniform(-4, 4) * 2.0**-53 * float(f0 * tau)
    speed = p.belt(boundary) + side * Fraction(f"{depth:.3g}")
    with mpmath.workdps(90):
        cosine = mpmath.cos(number(p.Omega * t_m))
        x_m = (number(p.A(alpha) - p.c * speed) + number(p.B0) * cosine) / number(p.k)
        x, v, F = flow_oracle(p, alpha, t_m, cut(x_m, 85), speed, -tau, 90)
        t0 = t_m - tau
        other = cut(v, 6)
        if alpha == 2 and rng.random() < 0.7 and side * (p.belt(boundary) - other) > 0:
            p = p.replace(**{f"v{3 - boundary}": other})
            t = t0 + cut((number(other) - v) / F, 6)
            tau = tau * Fraction(rng.randint(1, 9), 10)
            x, v = flow_oracle(p, alpha, t_m, cut(x_m, 85), speed, t - t_m, 90)[:2]
            t0 = t - tau
            x, v = flow_oracle(p, 2 - side, t, cut(x, 85), cut(v, 85), -tau, 90)[:2]
        x0 = cut(x, 30)
        v0 = cut(v, 30)
    scene = FuzzScene("shallow", index, p, t0, x0, v0, t_m + span(rng, p, 1, 4, 100))
    return with_digits(scene, touch=True, dps=80)


def cut(value: Any, places: int) -> Fraction:
    return Fraction(mpmath.nstr(value, places, min_fixed=-1000, max_fixed=1000))
