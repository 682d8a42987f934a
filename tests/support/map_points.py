"""Random maps between random points, the textbook solution in mpmath, and the sizes that errors are measured by."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import mpmath
from mpmath import mp

from symosc import Parameters
from symosc.friction import MAPS
from symosc.kernels import entire, mapping
from symosc.kernels.rebind import bind
from symosc.mappings import equations as m

REGIMES = ["underdamped", "critical", "near-critical", "overdamped", "undamped"]
REGIMES += ["resonance", "near-resonance", "no-spring", "free", "weak"]


class Size:
    """Stands for a number in a kernel and adds up the sizes of its terms.

    Differences count as sums.
    """

    def __init__(self, value: Any) -> None:
        if isinstance(value, Size):
            self.value = value.value
        else:
            self.value = abs(float(value))

    def __add__(self, other: Any) -> Size:
        return Size(self.value + Size(other).value)

    def __mul__(self, other: Any) -> Size:
        return Size(self.value * Size(other).value)

    def __truediv__(self, other: Any) -> Size:
        return Size(self.value / Size(other).value)

    def __rtruediv__(self, other: Any) -> Size:
        return Size(Size(other).value / self.value)

    def __neg__(self) -> Size:
        return self

    __radd__ = __sub__ = __rsub__ = __add__
    __rmul__ = __mul__


def sizes(p: Parameters, label: str, points: list[float], exit: str | None) -> tuple[Any, Any, Any]:
    """Return the sizes of the terms of f1, f2 and of the derivatives.

    The kernels, run on `Size`.
    """
    K = m.constants(p)
    tau = (points[3] - points[1]) / K.Om
    coarse = K._replace(
        **{name: Size(value) for name, value in K._asdict().items() if isinstance(value, float)},
        belt1=K.belt1._replace(v=Size(K.belt1.v)),
        belt2=K.belt2._replace(v=Size(K.belt2.v)),
    )

    def of(function: Any, *arguments: Any) -> Any:
        return lambda *_: [Size(value) for value in function(*arguments)]

    replaced = {
        "sin": lambda angle: Size(mpmath.sin(angle)),
        "cos": lambda angle: Size(mpmath.cos(angle)),
    }
    replaced |= {
        "basis": of(entire.basis, tau, K),
        "repeated": of(mapping.repeated, tau, *entire.basis(tau, K), K),
    }
    numbers = m.MapArithmetic(coarse, bind((mapping,), replaced), Size)
    x_i, theta_i, x_j, theta_j = points
    z = (Size(x_i), theta_i, Size(x_j), theta_j)
    row = MAPS[label]
    exit = exit or "below"
    return (
        m._residual(row, numbers, z, exit),
        m._jacobian(row, numbers, z),
        m._parameter_jacobian(p, row, numbers, z, exit),
    )


def truth(
    q: dict[str, Any], label: str, z: list[Any], exit: str | None, lift: Any
) -> tuple[Any, Any]:
    """Return f1, f2 from the textbook solution with distinct roots.

    `lift` moves equal ones apart.
    """
    row = MAPS[label]
    (x_i, theta_i, x_j, theta_j) = z
    v_i, v_j = (q["v1"] if plane.boundary == 1 else q["v2"] for plane in (row.start, row.end))
    tau = (theta_j - theta_i) / q["Omega"]
    domain = row.domain or row.start.boundary + (exit == "above")
    drag = {1: q["mu1"] + q["mu2"], 2: q["mu2"] - q["mu1"], 3: -q["mu1"] - q["mu2"]}[domain]
    A = q["A0"] + drag * q["FN"]
    mass = q["m"]
    B0 = q["B0"]
    Omega = q["Omega"]
    if row.sticks:
        return x_i + v_i * tau - x_j, (
            A + B0 * mp.cos(theta_j) - q["k"] * x_j - q["c"] * v_i
        ) / mass
    c = q["c"] + mass * lift
    k = q["k"] + mass * lift
    l2 = -(c + mp.sqrt(mp.mpc(c * c - 4 * k * mass))) / (2 * mass)
    l1 = k / mass / l2
    wave = B0 * mp.expj(theta_i) / (k - mass * Omega * Omega + 1j * c * Omega)
    x0 = x_i - A / k - wave.real
    v0 = v_i - (1j * Omega * wave).real
    a = (v0 - l2 * x0) / (l1 - l2) * mp.exp(l1 * tau)
    b = (l1 * x0 - v0) / (l1 - l2) * mp.exp(l2 * tau)
    wave = wave * mp.expj(Omega * tau)
    return A / k + (wave + a + b).real - x_j, (1j * Omega * wave + l1 * a + l2 * b).real - v_j


def draw(rng: random.Random, regime: str) -> Parameters:
    """Return random parameters of a regime.

    C, k and Omega are exact, so that borders are met exactly.
    """

    def number(low: float, high: float) -> Fraction:
        return Fraction(f"{rng.uniform(low, high):.6g}")

    def near_one(lowest: int) -> Fraction:
        return 1 + rng.choice([-1, 1]) * Fraction(10) ** -rng.randint(3, lowest)

    mass = number(0.1, 3)
    Omega = number(0.3, 5)
    w0 = number(0.3, 5)
    v1 = number(-6, 5)
    c = 2 * mass * w0
    k = mass * w0 * w0
    tiny = Fraction(10) ** -rng.randint(1, 12)
    c, k = {
        "underdamped": (c * number(0.001, 0.95), k),
        "critical": (c, k),
        "near-critical": (c * near_one(14), k),
        "overdamped": (c * number(1.05, 20), k),
        "undamped": (Fraction(0), k),
        "resonance": (Fraction(0), mass * Omega**2),
        "near-resonance": (rng.choice([0, c * tiny]), mass * Omega**2 * near_one(12)),
        "no-spring": (c, Fraction(0)),
        "free": (Fraction(0), Fraction(0)),
        "weak": (c * tiny, k * Fraction(10) ** -rng.randint(1, 12)),
    }[regime]
    forces = {"A0": number(-15, 15), "B0": number(-15, 15), "FN": number(0, 20)}
    friction = {"mu1": number(0, 1), "mu2": number(0, 1)}
    return Parameters(
        m=mass, c=c, k=k, Omega=Omega, v1=v1, v2=v1 + number(0.5, 10), **forces, **friction
    )


def draw_points(rng: random.Random, p: Parameters) -> list[float]:
    """Return x_i, theta_i, x_j, theta_j with a duration from 1e-4 to 10."""
    theta = rng.uniform(0, 6.28)
    return [
        rng.uniform(-8, 8),
        theta,
        rng.uniform(-8, 8),
        theta + float(p.Omega) * 10 ** rng.uniform(-4, 1),
    ]
