"""Cases that are hard for solvers, as data: scenes of exact numbers, what is hard about each, and its reference.

All numbers are decimals of at most 17 digits, except for the periodic orbits of the long runs. So every solver gets the
same problem, up to the rounding of a decimal to a double. What that rounding alone can do to the events is their
condition number (`symosc.reference.condition`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

from symosc.aliases import Number, NumberLike
from symosc.engine.arithmetic import mp_context
from symosc.exact import read_exact
from symosc.grazing.start import grazing_start
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.reference.compare import REFERENCE_DIGITS
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Event

DIGITS_OF_A_NUMBER = 17
LATE_PERIODS = 100_000


@dataclass(frozen=True)
class HardCase:
    """A hard case.

    Attributes
    ----------
    name : str
        The case within its group.
    group : str
        What kind of difficulty it is; one of GROUPS.
    scene : Scene
    quick : bool
        Whether ``--quick`` runs it too.
    periods : int
        0, or the number of forcing periods of a long run that starts on a periodic orbit. Of a long run the events of
        the last period are compared, and the number of all events.
    """

    name: str
    group: str
    scene: Scene
    quick: bool = False
    periods: int = 0

    def reference(self, scene: Scene | None = None, digits: int = REFERENCE_DIGITS) -> Sequence[Event]:
        """Return the events that a solver must find, as mpmath numbers with that many correct digits.

        Parameters
        ----------
        scene : Scene, optional
            A neighbour of the case's scene instead of it (`symosc.reference.condition`).
        digits : int
        """
        scene = scene or self.scene
        return last_period(scene, digits) if self.periods else simulate(scene, digits=digits).events


#: What is hard about each group, in order of the table.
GROUPS = {
    "easy": "nothing: a scene of the paper, for comparison",
    "peak beyond a belt": "two roots of the velocity so close that a step sees neither; then a short stick",
    "peak short of a belt": "no root, but only just: nothing may happen",
    "short stick or flight": "a contact that ends at once, or a force that dips through zero on a belt, or just not",
    "fig8's sticks": "at resonance each stick is 3/8 as long as the one before",
    "near-critical damping": "two characteristic roots merge: differences of exponentials cancel",
    "resonance": "k = m Omega^2 and c -> 0: steady state and transient grow without bound and cancel",
    "weak spring": "k -> 0: nothing bounds the position",
    "light mass": "m -> 0: stiff",
    "fast and slow drive": "rates that differ by a factor of 1000 and more",
    "late start": "Omega t0 has used up the digits of a double",
    "belts": "transparent, very weak, close together, far apart; or no excitation",
    "1e5 periods": "errors and drift over 2e5 to 4e5 events",
}


def last_period(scene: Scene, digits: int) -> Sequence[Event]:
    """Return the events of the last forcing period before t_end on the orbit that attracts the scene's motion.

    They are those of a period on the orbit, a whole number of periods later. A long run must end with them even if its
    start is not exactly on the orbit: every period multiplies the distance by the orbit's multipliers, 0.56 and less.
    """
    p, word, context = scene.parameters, str(scene.structure), mp_context(digits + 10)
    orbit = find_orbit(p, word, guess=find_orbit(p, word), digits=digits + 10)
    start, count = orbit.points[0], len(orbit.points)
    once = simulate(p, t0=start.t, x0=start.x, v0=scene.v0, t_end=start.t + 2 * orbit.period, digits=digits)
    last = context.mpf(scene.t_end.numerator) / scene.t_end.denominator
    period = 2 * context.pi * p.Omega.denominator / p.Omega.numerator
    shifted = [
        replace(event, t=event.t + period * context.floor((last - event.t) / period)) for event in once.events[:count]
    ]
    return sorted(shifted, key=lambda event: event.t)


@lru_cache(maxsize=1)
def hard_cases() -> tuple[HardCase, ...]:
    """Return all cases, in the order of GROUPS."""
    cases = [
        *(HardCase(name, "easy", replace(load_scene(name), t_end=Fraction(10)), True) for name in ("fig9", "fig10")),
        *_peaks(),
        *_short_contacts(),
        *_shrinking_sticks(),
        *_regimes(),
        *_belts(),
        *_long_runs(),
    ]
    return tuple(sorted(cases, key=lambda case: list(GROUPS).index(case.group)))


def short(value: Number | Fraction) -> str:
    """Return a number as a decimal with the digits of a double."""
    context = mp_context(60)
    return str(context.nstr(context.convert(value), DIGITS_OF_A_NUMBER, min_fixed=-context.inf, max_fixed=context.inf))


def _scene(
    name: str, base: str, start: tuple[NumberLike, NumberLike, NumberLike], t_end: NumberLike, **changes: NumberLike
) -> Scene:
    return _named(name, load_scene(base).parameters.replace(**changes), start, t_end)


def _named(name: str, p: Parameters, start: tuple[NumberLike, NumberLike, NumberLike], t_end: NumberLike) -> Scene:
    t0, x0, v0, end = (read_exact("start", value) for value in (*start, t_end))
    return Scene(name, p, t0, x0, v0, end)


# -- peaks beside a belt -----------------------------------------------------------------------------------------------


def start_before_a_peak(p: Parameters, mapping: str, height: Fraction, t_m: str, t0: str) -> tuple[str, str, str]:
    """Return t0, x0, v0 from which v peaks at t_m, `height` beyond the belt that `mapping` grazes (short of it if < 0).

    That is the start of the orbit that grazes a belt which is faster by `height`.
    """
    where = place(mapping)
    beyond = 1 if where.domain == where.boundary else -1
    speed = p.belt(where.boundary) + beyond * height
    moved = p.replace(v1=speed) if where.boundary == 1 else p.replace(v2=speed)
    start = grazing_start(moved, mapping, t_m=t_m, t0=t0)
    if not start.found:
        raise ValueError(f"no flight from t = {t0} peaks at t = {t_m}: {start.reason}")
    return t0, short(Fraction(start.start["x0"])), short(Fraction(start.start["v0"]))


# scene whose parameters, mapping that grazes, time of the peak, start, end, exponents of the distances, quick ones
PEAKS = (
    ("fig7-corrected", "P2", "3.14", "2.5", "15", (3, 5, 7, 9, 11, 13), (3, 13)),
    ("fig8", "P3", "3.14", "2.5", "4.5", (8, 13), ()),
    ("fig10", "P5", "1", "0.8", "8", (8, 13), (13,)),
    ("fig10", "P6", "3", "2.8", "9", (8, 13), (13,)),
)


def _peaks() -> list[HardCase]:
    cases = []
    for base, mapping, t_m, t0, t_end, exponents, quick in PEAKS:
        p = load_scene(base).parameters
        for group, sign in (("peak beyond a belt", 1), ("peak short of a belt", -1)):
            for exponent in exponents:
                start = start_before_a_peak(p, mapping, Fraction(sign, 10**exponent), t_m, t0)
                name = f"by 1e-{exponent} ({mapping}, {base})"
                cases.append(HardCase(name, group, _named(name, p, start, t_end), exponent in quick))
    return cases


# -- contacts that end at once -----------------------------------------------------------------------------------------


def start_with_force(p: Parameters, domain: int, boundary: int, t0: str, force: str) -> tuple[str, str, str]:
    """Return t0, x0, v0 on a belt from which F^(domain) is `force` there."""
    context = mp_context(40)
    cosine = Fraction(str(context.cos(context.mpf(p.Omega.numerator) / p.Omega.denominator * context.mpf(t0))))
    speed = p.belt(boundary)
    x = (p.A(domain) + p.B0 * cosine - p.c * speed - p.m * Fraction(force)) / p.k
    return t0, short(context.mpf(x.numerator) / x.denominator), str(speed)


def start_before_a_dip(p: Parameters, height: str, t0: str) -> tuple[str, str, str]:
    """Return t0, x0, v0 on belt 1 from which F^(1), falling along the stick, has its least value `height`.

    It is least at the phase pi + asin(k v1/(B0 Omega)), where its slope -(k v1 + B0 Omega sin(theta))/m turns positive.
    """
    context = mp_context(40)
    ratio = p.k * p.v1 / (p.B0 * p.Omega)
    theta = context.pi + context.asin(context.mpf(ratio.numerator) / ratio.denominator)
    t_m = Fraction(str(theta)) / p.Omega
    _, x_m, speed = start_with_force(p, 1, 1, str(context.mpf(t_m.numerator) / t_m.denominator), height)
    return t0, short(Fraction(x_m) - p.v1 * (t_m - Fraction(t0))), speed


def _short_contacts() -> list[HardCase]:
    p, group, cases = load_scene("fig5").parameters, "short stick or flight", []
    for height, where in (("-1e-6", "below"), ("-1e-12", "below"), ("1e-12", "above")):
        start = start_before_a_dip(p, height, "2.5")
        cases.append(
            HardCase(f"stick: force {height.lstrip('-')} {where} 0", group, _named("dip", p, start, "12"), True)
        )
    for force in ("1e-7", "1e-9"):
        start = start_with_force(p, 1, 1, "5", f"-{force}")
        cases.append(HardCase(f"flight from F = {force}", group, _named("flight", p, start, "12"), force == "1e-7"))
        start = start_with_force(p, 1, 1, "1", force)
        cases.append(HardCase(f"stick from F = {force}", group, _named("stick", p, start, "12"), force == "1e-7"))
    weak = p.replace(mu1="1e-9")  # F^(1) - F^(2) is 2e-8 on belt 1: a stick ends below or above it at once
    for t0, where in (("1", "below"), ("4", "above")):
        start = start_with_force(weak, 1, 1, t0, "1e-8")
        cases.append(
            HardCase(f"forces 2e-8 apart, ends {where}", group, _named("weak", weak, start, "12"), where == "above")
        )
    cases.append(HardCase("fig7-corrected as printed", group, load_scene("fig7-corrected"), True))
    return cases


def _shrinking_sticks() -> list[HardCase]:
    scene, group = load_scene("fig8"), "fig8's sticks"
    return [
        HardCase(f"{periods} periods of the drive", group, replace(scene, t_end=Fraction(t_end)), periods == 5)
        for periods, t_end in ((2, 9), (5, 18), (10, 34))
    ]


# -- parameters at their limits ----------------------------------------------------------------------------------------

# Starts (t0, x0, v0) of the scenes whose parameters are changed.
FIG5, FIG6, FIG9, FIG10 = ("0", "0", "0"), ("0", "0", "5"), ("0.1324", "4.5447", "1"), ("0.4588", "3.0837", "1")


def _regimes() -> list[HardCase]:
    cases: list[HardCase] = []

    def add(group: str, name: str, scene: Scene, quick: bool = False) -> None:
        cases.append(HardCase(name, group, scene, quick))

    for small in ("1e-4", "1e-8", "1e-14", "0"):
        for sign, letter in ((1, "+"), (-1, "-"))[: 1 if small == "0" else 2]:
            quarter = Fraction(1, 4) * (1 + sign * Fraction(small))
            name = "k = c^2/4m" if small == "0" else f"k = c^2/4m (1 {letter} {small})"
            scene = _scene(name, "fig5", FIG5, "25", k=quarter)
            add("near-critical damping", name, scene, name in ("k = c^2/4m", "k = c^2/4m (1 + 1e-14)"))
    for c in ("1e-2", "1e-7", "1e-12", "0"):
        scene = _scene(f"c = {c}", "fig9", FIG9, "7.5", c=c, k="1.6", FN=20)
        add("resonance", f"c = {c}", scene, c in ("1e-12", "0"))
    for k in ("1e-3", "1e-9", "1e-15", "0"):
        add("weak spring", f"k = {k}", _scene(f"k = {k}", "fig10", FIG10, "12.2", k=k), k in ("1e-15", "0"))
    for m in ("1e-2", "1e-5", "1e-8"):
        add("light mass", f"m = {m}", _scene(f"m = {m}", "fig10", FIG10, "9.5", m=m), m == "1e-5")
    free = _scene("m = 1e-5, c = 0", "fig10", FIG10, "1.47", m="1e-5", c=0)
    add("light mass", free.name, free)
    group = "fast and slow drive"
    add(group, "Omega = 1e3", _scene("Omega = 1e3", "fig9", ("0", "0", "0"), "0.04", Omega=1000, B0=3000), True)
    add(group, "Omega = 1e-3", _scene("Omega = 1e-3", "fig6", FIG6, "6000", Omega="1e-3"), True)
    for t0, text in ((10**8, "1e8"), (10**10, "1e10")):
        for base, (_, x0, v0), span in (("fig9", FIG9, 10), ("fig10", FIG10, 15)):
            add("late start", f"t0 = {text} ({base})", _scene("late", base, (t0, x0, v0), t0 + span), t0 == 10**10)
    return cases


def _belts() -> list[HardCase]:
    scenes = (
        _scene("mu1 = 0", "fig5", FIG5, "25", mu1=0),
        _scene("mu1 = mu2 = 0", "fig5", FIG5, "25", mu1=0, mu2=0),
        _scene("FN = 1e-9", "fig5", FIG5, "25", FN="1e-9"),
        _scene("v2 - v1 = 1e-6", "fig5", FIG5, "25", v2="1.000001"),
        _scene("v2 - v1 = 999", "fig5", FIG5, "25", v2=1000),
        _scene("B0 = 0, c = 0", "fig9", ("0", "30", "0"), "8", B0=0, c=0),
        _scene("x0 = 1e8", "fig9", ("0", "1e8", "0"), "5"),
    )
    return [HardCase(scene.name, "belts", scene, scene.name in ("mu1 = 0", "v2 - v1 = 1e-6")) for scene in scenes]


# -- long runs ---------------------------------------------------------------------------------------------------------


def _long_runs() -> list[HardCase]:
    cases = []
    for name in ("fig9-orbit", "fig10-orbit"):
        scene = load_scene(name)
        # a twentieth of a period after the last event, where nothing happens
        turns = Fraction(2 * LATE_PERIODS + Fraction(1, 10)) * Fraction(str(mp_context(30).pi))
        t_end = scene.t0 + turns / scene.parameters.Omega
        cases.append(HardCase(name, "1e5 periods", replace(scene, t_end=t_end), name == "fig10-orbit", LATE_PERIODS))
    return cases
