"""Random friction laws that attack the engine, one seeded generator per family.

Static friction from equal to several times kinetic, on one, two or three belts; curves where a
family has them. Every scene is reproducible from (family, seed, number); numbers are exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from math import pi, sqrt
from random import Random
from typing import Any

import mpmath
from law_oracle import LawBelt, LawRun, Motion, exact, first_peak, follow, friction_table
from scene_families import TRIPLES, signed, size, tenth, text

NUMBERS = ("m", "c", "k", "A0", "B0", "Omega", "FN")
START = ("t0", "x0", "v0", "t_end")
EVENTS = 20  # at most, of a scene
TURNS = 300  # of the fastest rate, at most: what an oracle steps through


@dataclass(frozen=True)
class LawScene:
    """A law, a start and an end.

    Attributes
    ----------
    near : bool
        Something is decided by equality, or by less than doubles tell: "undecidable" is an answer.
    """

    family: str
    number: int
    m: Fraction
    c: Fraction
    k: Fraction
    A0: Fraction
    B0: Fraction
    Omega: Fraction | None
    FN: Fraction
    belts: tuple[LawBelt, ...]
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    near: bool = False
    max_events: int = EVENTS

    def truth(self, digits: int, motion: type[Motion] = Motion) -> LawRun:
        names = (*NUMBERS, "belts", *START, "max_events")
        return follow(**{name: getattr(self, name) for name in names}, digits=digits, motion=motion)

    def snippet(self) -> str:
        """Return Python that makes the scene again."""
        law = ", ".join(
            f"{name}={text(getattr(self, name))}"
            for name in NUMBERS
            if getattr(self, name) is not None
        )
        belts = ", ".join(map(belt_text, self.belts))
        start = ", ".join(f"{name}={text(getattr(self, name))}" for name in START)
        return (
            f"oscillator = Oscillator({law}, belts=[{belts}])\n"
            f"simulate(oscillator, {start}, max_events={self.max_events})"
        )


def belt_text(belt: LawBelt) -> str:
    parts = [text(belt.v)]
    if belt.curve is None:
        parts.append(f"mu={text(belt.mu)}")
    else:
        points = ", ".join(f"({text(w)}, {text(mu)})" for w, mu in belt.curve)
        parts.append(f"curve=[{points}], slope={text(exact(belt.slope))}")
    if belt.mu_s is not None:
        parts.append(f"mu_s={text(belt.mu_s)}")
    return f"Belt({', '.join(parts)})"


# -- drawing ---------------------------------------------------------------------------------------


def static(rng: Random, mu: Fraction) -> Fraction:
    """Return a static coefficient: equal, hardly above, or up to some times the kinetic one."""
    kind = rng.random()
    if kind < 0.15:
        return mu
    if kind < 0.25:
        return mu * (1 + size(rng, -9, -3, 2))
    return Fraction(f"{float(mu) * rng.choice([1.2, 2, 5]) ** rng.uniform(0.2, 1):.3g}") + mu / 1000


def belts_of(rng: Random, count: int) -> tuple[LawBelt, ...]:
    """Return belts that are not closer than a fifth of their speeds."""
    speeds: list[Fraction] = []
    while len(speeds) < count:
        speed = Fraction(round(rng.uniform(-15, 15) * rng.choice([1, 3])), 20)
        if all(abs(speed - taken) >= Fraction(1, 10) for taken in speeds):
            speeds.append(speed)
    belts = []
    for speed in speeds:
        mu = size(rng, -1.3, 0, 2)
        belts.append(LawBelt(speed, mu, static(rng, mu)))
    return tuple(sorted(belts, key=lambda belt: belt.v))


def number_of_belts(rng: Random, number: int, most: int) -> int:
    return 1 + number % most


def plain_law(rng: Random, number: int, most: int) -> dict[str, Any]:
    """Return a law and a start of moderate numbers."""
    m = rng.choice([Fraction(1), size(rng, -0.5, 0.5)])
    k = rng.choice([Fraction(1), size(rng, -0.5, 0.7)])
    zeta = rng.choice([0.0, 0.02, 0.1, 0.3]) * rng.uniform(0.3, 1.5)
    c = Fraction(f"{2 * zeta * sqrt(float(k * m)):.3g}")
    Omega = Fraction(f"{sqrt(float(k / m)) * 10 ** rng.uniform(-0.6, 0.5):.3g}")
    belts = belts_of(rng, number_of_belts(rng, number, most))
    FN = rng.choice([Fraction(1), size(rng, -0.3, 0.5, 2)])
    force = float(FN * max(belt.mu_s for belt in belts))
    B0 = Fraction(f"{force * 10 ** rng.uniform(-0.7, 0.5) * rng.choice([1, 1, -1]):.3g}")
    A0 = rng.choice([Fraction(0), Fraction(f"{force * rng.uniform(-0.8, 0.8):.2g}")])
    x0 = Fraction(f"{force / float(k) * rng.uniform(-2, 2):.3g}")
    speeds = [belt.v for belt in belts]
    v0 = Fraction(f"{rng.uniform(float(min(speeds)) - 0.5, float(max(speeds)) + 0.5):.3g}")
    t0 = rng.choice([Fraction(0), Fraction(0), tenth(rng, -20, 100)])
    return {
        "m": m,
        "c": c,
        "k": k,
        "A0": A0,
        "B0": B0,
        "Omega": Omega,
        "FN": FN,
        "belts": belts,
        "t0": t0,
        "x0": x0,
        "v0": v0,
    }


def finished(family: str, number: int, law: dict[str, Any], rng: Random, **more: Any) -> LawScene:
    """Return the scene of a law, with an end after some periods."""
    Omega = law["Omega"] or Fraction(1)
    rate = float(Omega) + sqrt(law["k"] / law["m"]) + float(law["c"] / law["m"])
    slow = min(float(Omega), sqrt(law["k"] / law["m"]) or float(Omega))
    length = min(rng.uniform(4, 12) * 2 * pi / slow, TURNS / rate)
    return LawScene(family, number, **law, t_end=law["t0"] + Fraction(f"{length:.4g}"), **more)


# -- families --------------------------------------------------------------------------------------


def plain(rng: Random, number: int, most: int) -> LawScene:
    return finished("plain", number, plain_law(rng, number, most), rng)


def onbelt(rng: Random, number: int, most: int) -> LawScene:
    """Start on a belt, stuck or not."""
    law = plain_law(rng, number, most)
    law["v0"] = rng.choice(law["belts"]).v
    return finished("onbelt", number, law, rng)


def still(rng: Random, number: int, most: int) -> LawScene:
    """A belt at rest: a wall."""
    law = plain_law(rng, number, most)
    belts = [belt for belt in law["belts"] if abs(belt.v) >= Fraction(1, 10)]
    here = rng.choice(law["belts"])._replace(v=Fraction(0))
    law["belts"] = tuple(sorted([*belts[: most - 1], here], key=lambda belt: belt.v))
    law["v0"] = rng.choice([Fraction(0), law["v0"]])
    return finished("still", number, law, rng)


def free(rng: Random, number: int, most: int) -> LawScene:
    """No spring, and sometimes no damper."""
    law = plain_law(rng, number, most)
    law["k"] = Fraction(0)
    law["c"] = rng.choice([Fraction(0), law["c"]])
    return finished("free", number, law, rng)


def undamped(rng: Random, number: int, most: int) -> LawScene:
    """No damper; sometimes in resonance."""
    law = plain_law(rng, number, most)
    law["c"] = Fraction(0)
    if rng.random() < 0.4:
        law["Omega"] = Fraction(f"{rng.uniform(0.5, 2):.2g}")
        law["k"] = law["m"] * law["Omega"] ** 2
        if rng.random() < 0.5:
            law["k"] *= 1 + signed(rng, -12, -4, 2)
    return finished("undamped", number, law, rng)


def undriven(rng: Random, number: int, most: int) -> LawScene:
    """No excitation: stick-slip, decay or rest."""
    law = plain_law(rng, number, most)
    law["B0"] = Fraction(0)
    law["Omega"] = rng.choice([None, law["Omega"]])
    return finished("undriven", number, law, rng)


def overdamped(rng: Random, number: int, most: int) -> LawScene:
    """Critical, nearly critical and large damping."""
    law = plain_law(rng, number, most)
    zeta = rng.choice(["critical", "near", "large", "large"])
    if zeta == "large":
        factor = 10 ** rng.uniform(0.05, 1.1)
        law["c"] = Fraction(f"{2 * factor * sqrt(float(law['k'] * law['m'])):.3g}")
    else:
        root = size(rng, -0.4, 0.4, 2)
        law["k"] = law["m"] * root**2
        law["c"] = 2 * law["m"] * root
        if zeta == "near":
            law["k"] *= 1 + signed(rng, -14, -4, 2)
    scale = 3 * float(law["c"]) / sqrt(float(law["k"] * law["m"]))
    law["B0"] *= Fraction(f"{max(1.0, scale):.2g}")
    return finished("overdamped", number, law, rng)


def transparent(rng: Random, number: int, most: int) -> LawScene:
    """A belt that does not rub, but may hold; alone or beside another."""
    law = plain_law(rng, number, most)
    belts = list(law["belts"])
    place = rng.randrange(len(belts))
    hold = rng.choice([Fraction(0), belts[place].mu_s])
    belts[place] = belts[place]._replace(mu=Fraction(0), mu_s=hold)
    law["belts"] = tuple(belts)
    if rng.random() < 0.3:
        law["v0"] = belts[place].v
    return finished("transparent", number, law, rng)


def chaotic(rng: Random, number: int, most: int) -> LawScene:
    """One belt with much static friction, near motions known to be chaotic."""
    law = plain_law(rng, number, most)
    if rng.random() < 0.5:
        kinetic = Fraction(7, 10)
        law |= {
            "c": Fraction(1, 20),
            "B0": Fraction(3, 5),
            "Omega": tenth(rng, 13, 15),
            "A0": Fraction(0),
        }
        law["belts"] = (
            LawBelt(Fraction(1, 10), kinetic, Fraction(round(rng.uniform(90, 140)), 100)),
        )
    else:
        law |= {"c": Fraction(0), "B0": Fraction(1), "A0": Fraction(0)}
        law["Omega"] = Fraction(round(rng.uniform(40, 65)), 100)
        kinetic = Fraction(round(rng.uniform(5, 25)), 100)
        law["belts"] = (LawBelt(Fraction(0), kinetic, Fraction(round(rng.uniform(70, 90)), 100)),)
    law |= {"m": Fraction(1), "k": Fraction(1), "FN": Fraction(1)}
    return finished("chaotic", number, law, rng)


def held(rng: Random, number: int, most: int) -> LawScene:
    """Start on a belt with exactly, or nearly, the force that it holds."""
    law = plain_law(rng, number, most)
    if law["k"] == 0:
        law["k"] = Fraction(1)
    belt = rng.choice(law["belts"])
    law["t0"] = Fraction(0)
    law["v0"] = belt.v
    if rng.random() < 0.4 and law["B0"]:
        # the rate of the needed force vanishes there too
        law["belts"] = tuple(other._replace(v=other.v - belt.v) for other in law["belts"])
        law["v0"] = Fraction(0)
    others = sum(
        (
            law["FN"] * other.mu * (1 if other.v > belt.v else -1)
            for other in law["belts"]
            if other.v != belt.v
        ),
        Fraction(0),
    )
    limit = rng.choice([1, -1]) * law["FN"] * belt.mu_s
    push = rng.choice([Fraction(0), Fraction(0), signed(rng, -18, -4, 2)])
    pull = law["A0"] + law["B0"] + others - law["c"] * law["v0"] - limit
    law["x0"] = pull / law["k"] + push
    return finished("held", number, law, rng, near=abs(push) < Fraction(1, 10**9))


def arriving(rng: Random, number: int, most: int) -> LawScene:
    """Arrive at a belt with exactly, or nearly, the force that it holds (S3 of the references)."""
    p, q, hypotenuse = rng.choice(TRIPLES)
    mu = size(rng, -1, 0, 2)
    mu_s = mu * rng.choice([1, Fraction(3, 2), 2, 3])
    root = Fraction(rng.choice([1, 2, 3]), rng.choice([1, 2]))
    m = size(rng, -0.3, 0.3, 2)
    k = m * root**2
    FN = rng.choice([Fraction(1), size(rng, -0.3, 0.3, 2)])
    A0 = rng.choice([Fraction(0), tenth(rng, -10, 10)])
    # below the belt the mass turns around (A0 + mu FN)/k; there it needs FN mu_s at distance p
    distance = (mu + mu_s) * FN / k
    speed = distance * Fraction(q, p) * root
    push = rng.choice([Fraction(0), Fraction(0), signed(rng, -16, -4, 2)])
    x0 = (A0 + mu * FN) / k + distance * Fraction(hypotenuse, p) * (1 + push)
    law = {
        "m": m, "c": Fraction(0), "k": k, "A0": A0, "B0": Fraction(0), "Omega": None, "FN": FN,
        "belts": (LawBelt(speed, mu, mu_s),), "t0": tenth(rng, 0, 20), "x0": x0, "v0": Fraction(0),
    }  # fmt: skip
    return finished("arriving", number, law, rng, near=abs(push) < Fraction(1, 10**9))


def touching(rng: Random, number: int, most: int) -> LawScene:
    """A steady motion whose largest speed is a belt's, exactly or nearly (S2 of the references)."""
    m = size(rng, -0.3, 0.3, 2)
    Omega = Fraction(round(rng.uniform(4, 30)), 10)
    k = rng.choice([Fraction(0), size(rng, -0.3, 0.7, 2)])
    while k == m * Omega**2:
        k += Fraction(1, 7)
    mu = size(rng, -1, 0, 2)
    FN = Fraction(1)
    B0 = signed(rng, -0.3, 0.5, 2)
    A0 = -mu * FN  # so that k may be 0
    if k:
        A0 += rng.choice([Fraction(0), tenth(rng, -5, 5)])
    amplitude = B0 / (k - m * Omega**2)
    speed = abs(amplitude) * Omega
    push = rng.choice([Fraction(0), signed(rng, -18, -4, 2), signed(rng, -18, -4, 2)])
    x0 = amplitude
    if k:
        x0 += (A0 + mu * FN) / k
    belt = LawBelt(speed * (1 + push), mu, static(rng, mu))
    law = {
        "m": m, "c": Fraction(0), "k": k, "A0": A0, "B0": B0, "Omega": Omega, "FN": FN, "belts": (belt,),
        "t0": Fraction(0), "x0": x0, "v0": Fraction(0),
    }  # fmt: skip
    return finished("touching", number, law, rng, near=abs(push) < Fraction(1, 10**9))


def aimed(rng: Random, number: int, most: int) -> LawScene:
    """A flight whose largest speed is a belt's but for a little: the belt is moved there."""
    law = plain_law(rng, number, 1)
    belt = law["belts"][0]._replace(v=Fraction(1000))
    law["belts"] = (belt,)
    law["v0"] = Fraction(f"{rng.uniform(-1, 1):.3g}")
    peak = first_peak(**law)
    if peak is None:
        return finished("aimed", number, law, rng)
    push = signed(rng, -16, -3, 2)
    speed = Fraction(mpmath.nstr(peak, 40)) + push
    law["belts"] = (belt._replace(v=speed),)
    return finished("aimed", number, law, rng, near=abs(push) < Fraction(1, 10**9))


def turning(rng: Random, number: int, most: int) -> LawScene:
    """The needed force turns at, or next to, the limit: k V = B0 Omega, or nearly."""
    law = plain_law(rng, number, 1)
    belt = law["belts"][0]
    if belt.v == 0:
        belt = belt._replace(v=Fraction(1, 5))
    ratio = rng.choice([Fraction(1), 1 + signed(rng, -10, -1, 2), Fraction(4, 5), Fraction(3, 5)])
    law["B0"] = ratio * law["k"] * belt.v / law["Omega"]
    law["belts"] = (belt,)
    law["v0"] = belt.v
    return finished("turning", number, law, rng)


def resting(rng: Random, number: int, most: int) -> LawScene:
    """At rest under a drive that touches the static limit in every period, or nearly (S3b)."""
    law = plain_law(rng, number, 1)
    belt = law["belts"][0]._replace(v=Fraction(0))
    limit = law["FN"] * belt.mu_s
    law["B0"] = limit * Fraction(rng.randint(1, 9), 10)
    law |= {"belts": (belt,), "A0": Fraction(0), "v0": Fraction(0), "t0": Fraction(0)}
    side = rng.choice([1, -1])
    law["B0"] *= side
    push = rng.choice([Fraction(0), signed(rng, -18, -4, 2)])
    law["x0"] = -side * (limit - abs(law["B0"])) / law["k"] * (1 + push)
    return finished("resting", number, law, rng, near=abs(push) < Fraction(1, 10**9))


def curved(rng: Random, number: int, most: int) -> LawScene:
    """Belts with up to 8 corners each, falling parts among them."""
    law = plain_law(rng, number, most)
    belts = []
    for belt in law["belts"]:
        w = Fraction(0)
        mu = belt.mu
        curve = [(w, mu)]
        for _ in range(rng.randint(1, 8)):
            w += Fraction(rng.randint(2, 30), 50)
            mu = max(Fraction(0), mu * Fraction(rng.randint(5, 13), 10))
            curve.append((w, mu))
        slope = rng.choice([Fraction(0), tenth(rng, 0, 5)])
        belts.append(LawBelt(belt.v, None, belt.mu_s, tuple(curve), slope))
    law["belts"] = tuple(belts)
    return finished("curved", number, law, rng)


def cornered(rng: Random, number: int, most: int) -> LawScene:
    """Start on a corner of a curve with v' = 0, exactly or nearly; at speed 0 with v'' = 0 too."""
    scene = curved(rng, number, most)
    belt = rng.choice(scene.belts)
    place = rng.choice(belt.curve[1:])[0]
    speed = belt.v + rng.choice([1, -1]) * place
    belts = scene.belts
    if rng.random() < 0.4:
        belts = tuple(other._replace(v=other.v - speed) for other in belts)
        speed = Fraction(0)
    edges, bands = friction_table(scene.c, scene.A0, scene.FN, belts)
    band = bands[[edge.V for edge in edges].index(speed)]
    push = rng.choice([Fraction(0), Fraction(0), signed(rng, -18, -4, 2)])
    x0 = (band.A - band.c * speed + scene.B0) / scene.k + push
    t_end = scene.t_end - scene.t0
    return replace(
        scene, family="cornered", belts=belts, t0=Fraction(0), x0=x0, v0=speed, t_end=t_end
    )


def brushing(rng: Random, number: int, most: int) -> LawScene:
    """Reach the speed of a belt or a corner with v' = 0, exactly (to 60 digits) or nearly.

    The start is the state some time before, by the linear equation of the band alone.
    """
    scene = curved(rng, number, most)
    edges, bands = friction_table(scene.c, scene.A0, scene.FN, scene.belts)
    place = rng.randrange(len(edges))
    above = rng.random() < 0.5
    band = bands[place + above]
    V = edges[place].V
    Omega = scene.Omega or Fraction(1)
    push = rng.choice([Fraction(0), signed(rng, -18, -4, 2), signed(rng, -18, -4, 2)])
    k = scene.k or Fraction(1)  # so that a position has v' = 0
    with mpmath.workdps(80):
        when = mpmath.mpf(rng.uniform(0, 2 * pi)) / number_in(Omega)
        drive = number_in(scene.B0) * mpmath.cos(number_in(Omega) * when)
        x = (number_in(band.A - band.c * V) + drive) / number_in(k)
        early = rng.uniform(0.05, 0.5) / max(1.0, float(Omega), sqrt(k / scene.m), abs(band.c))
        x0, v0 = before(scene, band, k, (x, number_in(V)), when, early)
        t0, x0, v0 = (Fraction(mpmath.nstr(value, 60)) for value in (when - early, x0, v0))
    return replace(
        scene, family="brushing", k=k, t0=t0, x0=x0, v0=v0 + push, t_end=t0 + scene.t_end - scene.t0,
        near=abs(push) < Fraction(1, 10**9),
    )  # fmt: skip


def number_in(value: Fraction) -> Any:
    """Return a fraction as an mpmath number."""
    return mpmath.mpf(value.numerator) / value.denominator


def before(
    scene: LawScene, band: Any, k: Fraction, there: tuple[Any, Any], when: Any, early: float
) -> tuple[Any, Any]:
    """Return x and v a time `early` before the state `there` at the time `when`, in a band."""
    m, c, k, A, B0, Omega = map(
        number_in, (scene.m, band.c, k, band.A, scene.B0, scene.Omega or Fraction(1))
    )
    # x, v, 1, and the drive's cosine and sine
    rates = mpmath.matrix(
        [[0, 1, 0, 0, 0], [-k / m, -c / m, A / m, B0 / m, 0], [0] * 5, [0, 0, 0, 0, -Omega], [0, 0, 0, Omega, 0]]
    )  # fmt: skip
    phase = Omega * when
    state = mpmath.matrix([*there, 1, mpmath.cos(phase), mpmath.sin(phase)])
    x, v, *_ = mpmath.expm(-early * rates) * state
    return x, v


Family = Callable[[Random, int, int], LawScene]
STATIC: dict[str, Family] = {
    family.__name__: family
    for family in (
        plain, onbelt, still, free, undamped, undriven, overdamped, transparent, chaotic, held,
        arriving, touching, aimed, turning, resting,
    )
}  # fmt: skip
CURVES: dict[str, Family] = {"curved": curved, "cornered": cornered, "brushing": brushing}
FAMILIES = STATIC | CURVES


def scene_of(family: str, seed: int, number: int, most: int = 2) -> LawScene:
    """Return the scene with that number; the same arguments give the same scene."""
    return FAMILIES[family](Random(f"{family}:{seed}:{number}:{most}"), number, most)


with_changes = replace
