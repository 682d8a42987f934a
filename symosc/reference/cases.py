"""All reference cases: scenes of the paper, hard cases, exact grazes, rests, Coulomb oscillators,
long runs.

All numbers of the hard cases are decimals of at most 17 digits, except for the periodic orbits of
the long runs: every solver gets the same problem, up to the rounding of a decimal to a double,
whose effect is the condition number.

The Coulomb oscillator: with A0 = 0, B0 = P, v1 = 0, mu1 FN = F, mu2 = 0 and a v2 that no velocity
reaches, the model is m x'' + c x' + k x = P cos(Omega t) - F sgn(x'), here with m = k = FN = 1. The
closed forms of its events are kept as text; a test evaluates them and compares.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from difflib import get_close_matches
from fractions import Fraction
from functools import lru_cache
from math import pi

from symosc.base.aliases import Number, NumberLike
from symosc.base.display.drawable import Listing
from symosc.base.errors import ParameterError
from symosc.base.exact import read_exact, show
from symosc.engine.arithmetic import mp_context
from symosc.grazing.start import grazing_start
from symosc.kernels.theorem7_cases import place
from symosc.model import Parameters
from symosc.orbits.find import find_orbit
from symosc.reference.case import ReferenceCase
from symosc.reference.law_cases import LAW_GROUPS, law_cases
from symosc.scenes import Scene, figure_of, load_scene, scene_names

#: One more whenever a case is added or changed, so that scores name the set that they belong to.
SET_VERSION = 2
PAPER_SCENES = "paper"
GRAZES = "exact graze"
RESTS = "creeping and rest"
COULOMB = "Coulomb oscillator"
CONTINUUM = "continuum"
LONG_RUNS = "long run"
#: The difficulty of each group of hard cases, in order of the table.
GROUPS = {
    "easy": "nothing: a scene of the paper, for comparison",
    "peak beyond a belt": "two roots of the velocity so close that a step sees neither; then a "
    "short stick",
    "peak short of a belt": "no root, but only just: nothing may happen",
    "short stick or flight": "a contact that ends at once, or a force that dips through zero on "
    "a belt, or just not",
    "fig8's sticks": "at resonance each stick is 3/8 as long as the one before",
    "near-critical damping": "two characteristic roots merge: differences of exponentials cancel",
    "resonance": "k = m Omega^2 and c -> 0: steady state and transient grow without bound and "
    "cancel",
    "weak spring": "k -> 0: nothing bounds the position",
    "light mass": "m -> 0: stiff",
    "fast and slow drive": "rates that differ by a factor of 1000 and more",
    "late start": "Omega t0 has used up the digits of a double",
    "belts": "transparent, very weak, close together, far apart; or no excitation",
    "1e5 periods": "errors and drift over 2e5 to 4e5 events",
}
#: The difficulty of each group, in order.
CASE_GROUPS = {
    PAPER_SCENES: "the scenes of Chen and Fan (2016), and the orbits and exact grazes that "
    "belong to them",
    **GROUPS,
    GRAZES: "double roots of the velocity, in each regime of damping, at each belt and from each "
    "side",
    RESTS: "velocities that creep to a belt's speed, and rest on a belt",
    COULOMB: "published closed forms: amplitudes, growth and decay, the border of motions "
    "without stops",
    CONTINUUM: "orbits that no motion returns to after an error",
    LONG_RUNS: "hundreds of events: errors that add up",
    **LAW_GROUPS,
}


@lru_cache(maxsize=1)
def reference_cases() -> Sequence[ReferenceCase]:
    """Return all reference cases: motions with known, mostly proven events.

    Nothing is computed yet; a case computes its events, certificate and condition when they are
    asked for.

    Examples
    --------
    >>> from symosc import reference_cases
    >>> cases = reference_cases()
    >>> cases[0].name, cases[-1].group
    ('paper-fig5', 'friction curve')
    """
    resting = (_creeping_cases, _limit_speed_cases, _belt_start_cases)
    oscillating = (_slide_cases, _first_stop_cases, _resonance_cases, _decay_cases)
    of_groups = (
        _paper_cases,
        hard_cases,
        grazes,
        *resting,
        *oscillating,
        continuum,
        _long_run_cases,
        law_cases,
    )
    return Listing([case for cases in of_groups for case in cases()])


def reference_case(name: str) -> ReferenceCase:
    """Return the reference case of a name.

    ParameterError with the nearest names if there is none.
    """
    cases = {case.name: case for case in reference_cases()}
    if name not in cases:
        near = get_close_matches(name, cases, 3)
        hint = f"near it: {', '.join(near)}" if near else "`symosc cases` lists all"
        raise ParameterError("case", name, f"is no reference case; {hint}")
    return cases[name]


def chosen(group: str | None) -> Sequence[ReferenceCase]:
    """Return the cases of a group, or all; ParameterError if there is no such group."""
    if group is not None and group not in CASE_GROUPS:
        raise ParameterError("group", group, f"unknown group; choose from {', '.join(CASE_GROUPS)}")
    return [case for case in reference_cases() if group in (None, case.group)]


# -- the paper's scenes ----------------------------------------------------------------------------


def _paper_cases() -> Iterator[ReferenceCase]:
    """Yield the shipped scenes of the paper's figures as they are."""
    at_a_slip = (
        "the start is the end of a stick to all its digits: within its error the mass may stick or "
        "slip"
    )
    for name in filter(figure_of, scene_names()):
        scene = load_scene(name)
        if name == "fig10-orbit":
            reason = at_a_slip
        else:
            reason = ""
        yield ReferenceCase(
            f"paper-{name}", PAPER_SCENES, scene, f"the paper's {name}", scene.source, open=reason
        )


# -- cases that are hard for solvers ---------------------------------------------------------------

DIGITS_OF_A_NUMBER = 17
LATE_PERIODS = 100_000
# Starts (t0, x0, v0) of the scenes whose parameters are changed.
FIG5 = ("0", "0", "0")
FIG6 = ("0", "0", "5")
FIG9 = ("0.1324", "4.5447", "1")
FIG10 = ("0.4588", "3.0837", "1")
# Scene of the parameters, grazing mapping, time of the peak, start, end, exponents of the
# distances, those for quick.
PEAKS = (
    ("fig7-corrected", "P2", "3.14", "2.5", "15", (3, 5, 7, 9, 11, 13), (3, 13)),
    ("fig8", "P3", "3.14", "2.5", "4.5", (8, 13), ()),
    ("fig10", "P5", "1", "0.8", "8", (8, 13), (13,)),
    ("fig10", "P6", "3", "2.8", "9", (8, 13), (13,)),
)
Start = tuple[NumberLike, NumberLike, NumberLike]


@lru_cache(maxsize=1)
def hard_cases() -> tuple[ReferenceCase, ...]:
    """Return all hard cases, in the order of GROUPS.

    Those that are `quick` are in `symosc bench --quick`.
    """
    cases = [
        _hard("easy", name, replace(load_scene(name), t_end=Fraction(10)), quick=True)
        for name in ("fig9", "fig10")
    ]
    cases += [*_peak_cases(), *_short_contact_cases(), *_changed_scenes()]
    return tuple(sorted(cases, key=lambda case: list(GROUPS).index(case.group)))


def _hard(
    group: str, name: str, scene: Scene, quick: bool = False, periods: int = 0
) -> ReferenceCase:
    """Return a hard case of a group, named by the group and by `name`, which must be unique in the
    group.
    """
    own = f"{group} {name}"  # in letters, digits and single hyphens
    for sign, word in {"+": " plus ", "=": " ", "^": "", "'": "", "- ": "minus "}.items():
        own = own.replace(sign, word)
    own = re.sub(r"(?<=\d)\.(?=\d)", "p", own)  # a decimal point
    own = re.sub(r"[^A-Za-z0-9]+", "-", own).strip("-")
    source = "a scene of the paper with numbers that make it hard"
    hard = f"{GROUPS[group]}; {name}"
    return ReferenceCase(
        own, group, replace(scene, name=own), hard, source, periods=periods, quick=quick
    )


def short(value: Number | Fraction) -> str:
    """Return a number as a decimal with the digits of a double."""
    context = mp_context(60)
    return str(
        context.nstr(
            context.convert(value),
            DIGITS_OF_A_NUMBER,
            min_fixed=-context.inf,
            max_fixed=context.inf,
        )
    )


def _scene(
    p: Parameters | str, start: Start, t_end: NumberLike, name: str = "case", **changes: NumberLike
) -> Scene:
    """Return a scene with the parameters p; if p names a shipped scene, with that scene's
    parameters and `changes`.
    """
    if isinstance(p, str):
        p = load_scene(p).parameters.replace(**changes)
    t0, x0, v0, end = (read_exact("start", value) for value in (*start, t_end))
    return Scene(name, p, t0, x0, v0, end)


def minus_if(negative: bool) -> str:
    """Return the sign of a closed form: "-", or nothing."""
    return "-" if negative else ""


def start_before_a_peak(
    p: Parameters, mapping: str, height: Fraction, t_m: str, t0: str
) -> tuple[str, str, str]:
    """Return t0, x0, v0 from which v peaks at t_m, `height` beyond the belt of a graze."""
    # That is the start of the orbit that grazes a belt which is faster by `height`, or short of it
    # (height < 0).
    grazing_place = place(mapping)
    speed = p.belt(grazing_place.boundary)
    if grazing_place.domain == grazing_place.boundary:
        speed += height
    else:
        speed -= height
    start = grazing_start(
        p.replace(**{f"v{grazing_place.boundary}": speed}), mapping, t_m=t_m, t0=t0
    ).start
    return t0, short(Fraction(start["x0"])), short(Fraction(start["v0"]))


def _peak_cases() -> Iterator[ReferenceCase]:
    """Yield motions whose velocity peaks a little beyond the speed of a belt, or short of it."""
    for base, mapping, t_m, t0, t_end, exponents, quick in PEAKS:
        p = load_scene(base).parameters
        for group, sign in (("peak beyond a belt", 1), ("peak short of a belt", -1)):
            for exponent in exponents:
                start = start_before_a_peak(p, mapping, Fraction(sign, 10**exponent), t_m, t0)
                name = f"by 1e-{exponent} ({mapping}, {base})"
                yield _hard(group, name, _scene(p, start, t_end), quick=exponent in quick)


def start_with_force(
    p: Parameters, domain: int, boundary: int, t0: str, force: str
) -> tuple[str, str, str]:
    """Return t0, x0, v0 of a start on a belt at which F^(domain) has the value `force`."""
    context = mp_context(40)
    cosine = Fraction(
        str(context.cos(context.mpf(p.Omega.numerator) / p.Omega.denominator * context.mpf(t0)))
    )
    speed = p.belt(boundary)
    x = (p.A(domain) + p.B0 * cosine - p.c * speed - p.m * Fraction(force)) / p.k
    return t0, short(context.mpf(x.numerator) / x.denominator), str(speed)


def start_before_a_dip(p: Parameters, height: str, t0: str) -> tuple[str, str, str]:
    """Return t0, x0, v0 of a start on belt 1; in the stick that follows, the minimum of the force
    F^(1) is `height`.
    """
    # It is least at the phase pi + asin(k v1/(B0 Omega)), where its slope -(k v1 + B0 Omega
    # sin(theta))/m turns positive.
    context = mp_context(40)
    ratio = p.k * p.v1 / (p.B0 * p.Omega)
    theta = context.pi + context.asin(context.mpf(ratio.numerator) / ratio.denominator)
    t_m = Fraction(str(theta)) / p.Omega
    t_m_text = str(context.mpf(t_m.numerator) / t_m.denominator)
    _, x_m, speed = start_with_force(p, 1, 1, t_m_text, height)
    # Back from the minimum to t0 along the belt.
    return t0, short(Fraction(x_m) - p.v1 * (t_m - Fraction(t0))), speed


def _short_contact_cases() -> Iterator[ReferenceCase]:
    """Yield motions of fig5 that start with a stick or a flight that is over almost at once."""
    p = load_scene("fig5").parameters
    # F^(1) - F^(2) is 2e-8 on belt 1: a stick ends below or above it at once.
    weak = p.replace(mu1="1e-9")
    # Name, parameters, start, and whether it is quick.
    rows: list[tuple[str, Parameters, Start, bool]] = []
    for height, side in (("-1e-6", "below"), ("-1e-12", "below"), ("1e-12", "above")):
        name = f"stick: force {height.lstrip('-')} {side} 0"
        rows.append((name, p, start_before_a_dip(p, height, "2.5"), True))
    for force in ("1e-7", "1e-9"):
        quick = force == "1e-7"
        rows.append(
            (f"flight from F = {force}", p, start_with_force(p, 1, 1, "5", f"-{force}"), quick)
        )
        rows.append((f"stick from F = {force}", p, start_with_force(p, 1, 1, "1", force), quick))
    for t0, side in (("1", "below"), ("4", "above")):
        start = start_with_force(weak, 1, 1, t0, "1e-8")
        rows.append((f"forces 2e-8 apart, ends {side}", weak, start, side == "above"))
    for name, parameters, begin, quick in rows:
        yield _hard("short stick or flight", name, _scene(parameters, begin, "12"), quick=quick)
    yield _hard(
        "short stick or flight",
        "fig7-corrected as printed",
        load_scene("fig7-corrected"),
        quick=True,
    )


def _changed_scenes() -> Iterator[ReferenceCase]:
    """Yield the paper's scenes with one number so changed that solvers are in trouble."""
    for periods, end in ((2, 9), (5, 18), (10, 34)):
        scene = replace(load_scene("fig8"), t_end=Fraction(end))
        yield _hard("fig8's sticks", f"{periods} periods of the drive", scene, quick=periods == 5)
    quarter = Fraction(1, 4)
    for small in ("1e-4", "1e-8", "1e-14"):
        for sign in ("+", "-"):
            scene = _scene("fig5", FIG5, "25", k=quarter * (1 + Fraction(f"{sign}{small}")))
            yield _hard(
                "near-critical damping",
                f"k = c^2/4m (1 {sign} {small})",
                scene,
                quick=(sign, small) == ("+", "1e-14"),
            )
    yield _hard(
        "near-critical damping", "k = c^2/4m", _scene("fig5", FIG5, "25", k=quarter), quick=True
    )
    for c in ("1e-2", "1e-7", "1e-12", "0"):
        scene = _scene("fig9", FIG9, "7.5", c=c, k="1.6", FN=20)
        yield _hard("resonance", f"c = {c}", scene, quick=c in ("1e-12", "0"))
    for k in ("1e-3", "1e-9", "1e-15", "0"):
        yield _hard(
            "weak spring",
            f"k = {k}",
            _scene("fig10", FIG10, "12.2", k=k),
            quick=k in ("1e-15", "0"),
        )
    for m in ("1e-2", "1e-5", "1e-8"):
        yield _hard("light mass", f"m = {m}", _scene("fig10", FIG10, "9.5", m=m), quick=m == "1e-5")
    yield _hard("light mass", "m = 1e-5, c = 0", _scene("fig10", FIG10, "1.47", m="1e-5", c=0))
    scene = _scene("fig9", ("0", "0", "0"), "0.04", Omega=1000, B0=3000)
    yield _hard("fast and slow drive", "Omega = 1e3", scene, quick=True)
    yield _hard(
        "fast and slow drive",
        "Omega = 1e-3",
        _scene("fig6", FIG6, "6000", Omega="1e-3"),
        quick=True,
    )
    for t0, text in ((10**8, "1e8"), (10**10, "1e10")):
        for base, (_, x0, v0), span in (("fig9", FIG9, 10), ("fig10", FIG10, 15)):
            yield _hard(
                "late start",
                f"t0 = {text} ({base})",
                _scene(base, (t0, x0, v0), t0 + span),
                quick=text == "1e10",
            )
    belts = {
        "mu1 = 0": _scene("fig5", FIG5, "25", mu1=0),
        "mu1 = mu2 = 0": _scene("fig5", FIG5, "25", mu1=0, mu2=0),
        "FN = 1e-9": _scene("fig5", FIG5, "25", FN="1e-9"),
        "v2 - v1 = 1e-6": _scene("fig5", FIG5, "25", v2="1.000001"),
        "v2 - v1 = 999": _scene("fig5", FIG5, "25", v2=1000),
        "B0 = 0, c = 0": _scene("fig9", ("0", "30", "0"), "8", B0=0, c=0),
        "x0 = 1e8": _scene("fig9", ("0", "1e8", "0"), "5"),
    }
    for name, scene in belts.items():
        yield _hard("belts", name, scene, quick=name in ("mu1 = 0", "v2 - v1 = 1e-6"))
    for name in ("fig9-orbit", "fig10-orbit"):
        scene = load_scene(name)
        # a twentieth of a period after the last event, where nothing happens
        turns = Fraction(2 * LATE_PERIODS + Fraction(1, 10)) * Fraction(str(mp_context(30).pi))
        scene = replace(scene, t_end=scene.t0 + turns / scene.parameters.Omega)
        yield _hard("1e5 periods", name, scene, quick=name == "fig10-orbit", periods=LATE_PERIODS)


# -- exact grazes ----------------------------------------------------------------------------------

GRAZE_HARD = (
    "a double root of the velocity: a step sees no change of sign, "
    "and rounding of the start makes two roots or none"
)
GRAZE_SOURCE = "Theorem 7 of the paper (symosc.grazing_start): the flow back from the tangency"
#: How long before the graze a motion starts, and how long it is followed.
BEFORE = Fraction(3, 10)
FOLLOWED = 8

GRAZING = Parameters(
    m=1, c=1, k=2, A0=0, B0=4, Omega=1, v1=-1, v2="1/2", mu1="0.3", mu2="0.2", FN=5
)
DAMPED: dict[str, dict[str, NumberLike]] = {
    "underdamped": {},
    "critically damped": {"c": 2, "k": 1},
    "overdamped": {"c": 5},
    "undamped": {"c": 0},
    "undamped resonance": {"c": 0, "k": 1},
    "near resonance": {"c": "1e-6", "k": 1},
    "weak spring": {"k": "1e-3"},
}
#: Times of the grazes: in the window of Theorem 7, with a flight of `BEFORE` to them.
GRAZE_TIMES = {"P2": "1.1", "P3": "3.3", "P5": "0.55", "P6": "3.85"}


def grazes() -> Iterator[ReferenceCase]:
    """Yield motions that graze a belt exactly."""
    for regime, changes in DAMPED.items():
        p = GRAZING.replace(**changes)
        for mapping, t_m in GRAZE_TIMES.items():
            grazing_place = place(mapping)
            t0 = Fraction(t_m) - BEFORE
            # Half of the digits remain at the graze, where the gap is a square.
            start = grazing_start(p, mapping, t_m=t_m, t0=t0, digits=95).start
            _, _, last_digit = start["start_error"]  # a unit of v0's
            error = 5 * last_digit  # the exact v0 is within so many units of the last digit
            name = f"graze-{regime.replace(' ', '-')}-{mapping}"
            scene = Scene(name, p, t_end=t0 + FOLLOWED, **start | {"start_error": (0, 0, error)})
            hard = f"{GRAZE_HARD}; {regime}, belt {grazing_place.boundary} touched from domain {grazing_place.domain}"
            yield _case(GRAZES, scene, hard, GRAZE_SOURCE, (f"t[0] = {t_m}",))


# -- creeping and rest -----------------------------------------------------------------------------

UNIQUENESS = (
    "uniqueness of the periodic motion and its exception (symosc derive orbits): rests form an "
    "interval"
)
AT_THE_EDGE = (
    "the force on the belt is 0 where it turns; it is never beyond, by elementary reasons: min of "
    "A + B0 cos"
)
ELEMENTARY = "the solution of the linear equation in one domain"

#: Overdamped, no drive, belt 1 at rest, far from belt 2; the roots are -1 and -3.
CREEPER = Parameters(m=1, c=4, k=3, A0=0, B0=0, Omega=1, v1=0, v2=50, mu1="0.2", mu2="0.1", FN=1)
GAP = Fraction(1)


def _case(
    group: str, scene: Scene, hard: str, source: str, closed: Sequence[str] = (), reason: str = ""
) -> ReferenceCase:
    """Return a case with the scene's name.

    `closed` are known values of events, `reason` is why they are unproven.
    """
    return ReferenceCase(scene.name, group, scene, hard, source, tuple(closed), reason)


def _creeping_cases() -> Iterator[ReferenceCase]:
    """Yield flights without a drive whose velocity creeps to 0, the speed of the belt, and reaches
    it late or never.
    """
    # With decay rates r1 <= r2 the gap g = -v closes only if u = g' + r2 g < 0 at the start: at the
    # time log(1 + (r2 - r1) g/|u|)/(r2 - r1), or g/|u| if the two rates are equal.
    pushes = ("-1e-1", "-1e-9", "0", "1e-9")  # it meets the belt late, very late, just not, not
    for number, push in enumerate(pushes, 1):
        for roots, (r1, r2) in (("two-roots", (1, 3)), ("one-root", (2, 2))):
            u = Fraction(push)
            if r1 == r2 and -u < Fraction(1, 1000) and u < 0:
                # a contact after 1e9 time constants, where nothing is left of the velocity
                continue
            p = CREEPER.replace(c=r1 + r2, k=r1 * r2)
            a0 = -(u - r2 * GAP)
            start = (0, (p.A(1) + p.c * GAP - p.m * a0) / p.k, -GAP)
            if r1 != r2:
                expression = "log(1 + 2/(%s))/2"
            else:
                expression = "1/(%s)"
            if u < 0:
                closed: tuple[str, ...] = (f"t[0] = {expression % show(-u)}",)
            else:
                closed = ()
            meets = "meets it late" if u < 0 else "never meets it"
            hard = f"the velocity creeps to the belt's, and {meets}: "
            hard += roots.replace("-", " ")
            if r1 == r2 and u < 0:
                t_end = 150
            else:
                t_end = 30
            yield _case(
                RESTS,
                _scene(p, start, t_end, f"creeping-{number}-{roots}"),
                hard,
                ELEMENTARY,
                closed,
            )


def _limit_speed_cases() -> Iterator[ReferenceCase]:
    """Yield flights without spring and drive whose velocity tends to a limit at, or close to, the
    belt's speed 1.
    """
    for number, beyond in enumerate(("1e-3", "1e-12", "0", "-1e-12"), 1):
        b = Fraction(beyond)
        p = CREEPER.replace(c=2, k=0, v1=1, A0=2 + 2 * b - Fraction("0.3"))
        if b > 0:
            closed: tuple[str, ...] = (f"t[0] = log((1 + {beyond})/({beyond}))/2",)
        else:
            closed = ()
        if b > 0:
            limit_text = f"{beyond} beyond the belt's speed"
        elif not b:
            limit_text = "that is the belt's speed"
        else:
            limit_text = "short of it"
        hard = f"the velocity tends to a limit {limit_text}"
        yield _case(
            RESTS, _scene(p, (0, 0, 0), 40, f"limit-speed-{number}"), hard, ELEMENTARY, closed
        )


def _belt_start_cases() -> Iterator[ReferenceCase]:
    """Yield motions that start on a belt: rests, rests on the edge of friction, and a settling."""
    p = Parameters(m=1, c=1, k=1, A0=0, B0="1/10", Omega=1, v1=0, v2=10, mu1=1, mu2="1/10", FN=1)
    for number, x0 in enumerate((0, "1/2", "-3/5", "-4/5", 1), 1):
        hard = "rest on a belt: nothing may happen, for ever"
        reason = ""
        if x0 in ("-4/5", 1):
            hard = f"{hard}; on the edge, where the force just falls to 0"
            reason = AT_THE_EDGE
        yield _case(
            RESTS, _scene(p, (0, x0, 0), 200, f"rest-{number}"), hard, UNIQUENESS, reason=reason
        )
    hard = "the force reaches the edge of friction by 1e-9 or misses it by that, on a belt at rest"
    for name, x0 in (("slips", "1.000000001"), ("stays", "0.999999999")):  # A1 - |B0| = 1
        yield _case(RESTS, _scene(p, (0, x0, 0), 60, f"rest-edge-{name}"), hard, UNIQUENESS)
    fast = p.replace(v1=1, B0=0)
    hard = (
        "one stick, one flight, then a slow approach to rest between the belts' speeds, with "
        "nothing more to find"
    )
    yield _case(RESTS, _scene(fast, (0, 0, 1), 60, "stick-then-settling"), hard, ELEMENTARY)


# -- the Coulomb oscillator and its continuum of orbits --------------------------------------------

DEN_HARTOG = "Den Hartog, Phil. Mag. 9 (1930) and Trans. ASME 53 (1931)"
BORDER_SOURCE = "Den Hartog (1931); Hong and Liu, J. Sound Vib. 229 (2000)"
CSERNAK = "Csernak, Stepan and Shaw, Nonlinear Dynamics 50 (2007), doi:10.1007/s11071-006-9145-6"
BALANCE = (
    "the energy of a free or resonant oscillator with constant friction, half a cycle at a time"
)
# Digits of a start on an orbit whose amplitude is not rational.
ORBIT_DIGITS = 60


def wall(F: NumberLike, Omega: NumberLike, c: NumberLike = 0, P: NumberLike = 1) -> Parameters:
    """Return the parameters of a mass on a spring that rubs on a wall: friction F, damping c, drive
    P cos(Omega t).
    """
    return Parameters(m=1, c=c, k=1, A0=0, B0=P, Omega=Omega, v1=0, v2=10**6, mu1=F, mu2=0, FN=1)


def _slide_cases() -> Iterator[ReferenceCase]:
    """Yield motions without stops that start at their highest point and have the amplitude of Den
    Hartog's formula.
    """
    for number, (c, F, Omega) in enumerate(
        (("0", "0.4", "1.5"), ("0.2", "0.4", "1.5"), ("0.1", "0.25", "0.6")), 1
    ):
        p = wall(F, Omega, c)
        orbit = find_orbit(p, "P32", guess=find_orbit(p, "P32"), digits=ORBIT_DIGITS)
        context = mp_context(ORBIT_DIGITS)
        first = orbit.points[0]
        t0, x0 = (Fraction(context.nstr(value, ORBIT_DIGITS)) for value in (first.t, first.x))
        cycles = 4
        period = 2 * pi / float(p.Omega)
        closed = [
            f"x[{i}] = {minus_if(i % 2 == 0)}({amplitude(c, F, Omega)})" for i in range(2 * cycles)
        ]
        t_end = Fraction(f"{float(t0) + (cycles + 0.25) * period:.6g}")
        hard = (
            "a start and events at velocity 0, on the belt at rest; the motion passes it and does "
            "not stop"
        )
        yield _case(
            COULOMB, _scene(p, (t0, x0, 0), t_end, f"den-hartog-{number}"), hard, DEN_HARTOG, closed
        )


def amplitude(c: str, F: str, Omega: str) -> str:
    """Return Den Hartog's amplitude for m = k = P = FN = 1 and friction F, as the text of an
    expression.
    """
    if Fraction(c) == 0:
        return f"sqrt((1/(1 - ({Omega})**2))**2 - ({F})**2*(tan(pi/(2*({Omega})))/({Omega}))**2)"
    # Den Hartog's G and H, the parts of friction along and across the motion, and the magnification
    # Q without friction, squared; zeta is the damping ratio.
    zeta = f"(({c})/2)"
    root = f"sqrt(1 - {zeta}**2)"
    g = f"(pi*{zeta}/({Omega}))"
    s = f"(pi*{root}/({Omega}))"
    below = f"(cosh({g}) + cos({s}))"
    G = f"((sinh({g}) - {zeta}/{root}*sin({s}))/{below})"
    H = f"(sin({s})/(({Omega})*{root}*{below}))"
    Q = f"(1/((1 - ({Omega})**2)**2 + 4*{zeta}**2*({Omega})**2))"
    return f"-({F})*{G} + sqrt({Q} - ({F})**2*{H}**2)"


def _first_stop_cases() -> Iterator[ReferenceCase]:
    """Yield motions whose friction is just below or just above the least friction with which the
    mass stops.
    """
    # The mass stops in each cycle if F > 0.64657909 P (Omega = 1.5), or F > 0.81740639 P (Omega =
    # 0.8).
    for Omega, below, above in (("1.5", "0.64", "0.65"), ("0.8", "0.81", "0.82")):
        for side, F in (("below", below), ("above", above)):
            hard = f"friction just {side} the border of motions without stops, r = {Omega}: "
            hard += "stops are short or not there"
            scene = _scene(
                wall(F, Omega), (0, 1, 0), 150, f"border-{Omega}-{side}".replace(".", "-")
            )
            yield _case(COULOMB, scene, hard, BORDER_SOURCE)


def _resonance_cases() -> Iterator[ReferenceCase]:
    """Yield undamped motions at resonance, which turn at the times pi/2, 3 pi/2, ..., each time
    farther out.
    """
    for number, F in enumerate(("0.1", "0.4", "0.75"), 1):
        p = wall(F, 1)
        closed = [f"t[{i}] = pi/2 + {i}*pi" for i in range(12)]
        closed += [
            f"x[{i}] = {minus_if(i % 2 == 1)}(5 + pi/4 - {F} + {i}*(pi/2 - 2*{F}))"
            for i in range(12)
        ]
        scene = _scene(p, (0, Fraction(1, 2) - Fraction(F), 5), 40, f"resonance-growth-{number}")
        yield _case(
            COULOMB, scene, "undamped resonance: the amplitude grows for ever", BALANCE, closed
        )


def _decay_cases() -> Iterator[ReferenceCase]:
    """Yield motions without a drive that lose 2 F/k per half cycle and stop at the first turning
    point within F/k.
    """
    for number, (x0, F) in enumerate((("10", "0.3"), ("1", "0.07"), ("100", "0.9")), 1):
        stop = next(
            i for i in range(1000) if abs(Fraction(x0) - 2 * i * Fraction(F)) <= Fraction(F)
        )
        closed = [f"t[{i}] = {i + 1}*pi" for i in range(stop)]
        closed += [
            f"x[{i}] = {minus_if(i % 2 == 0)}({x0} - {2 * (i + 1)}*{F})" for i in range(stop)
        ]
        hard = (
            "free decay: all turning points are on the belt at rest, and the last one is a stop "
            "for ever"
        )
        t_end = int(pi * stop) + 20
        scene = _scene(wall(F, 1, P=0), (0, x0, 0), t_end, f"free-decay-{number}")
        yield _case(COULOMB, scene, hard, BALANCE, closed)


def continuum() -> Iterator[ReferenceCase]:
    """Yield undamped motions at Omega = 1/(2 n): the middle d of the oscillation may be any value
    of an interval.
    """
    # They have the amplitude x_0 = 1/(1 - Omega^2) for all |d| < Omega^2 x_0 - F; beyond it they
    # stop.
    members = (
        (1, "0.1", ("0", "0.1", "-0.2", "0.2333", "0.2334", "0.3")),
        (2, "0.05", ("0", "0.01", "-0.0166")),
    )
    for n, F, middles in members:
        Omega = Fraction(1, 2 * n)
        x_0 = 1 / (1 - Omega**2)
        for number, d in enumerate(middles, 1):
            stays = abs(Fraction(d)) < Omega**2 * x_0 - Fraction(F)
            if stays:
                count = 8
            else:
                count = 0
            # Half a period of the drive from turn to turn, at the lowest and highest place in turn.
            closed = [f"t[{i}] = {2 * n * (i + 1)}*pi" for i in range(count)]
            closed += [f"x[{i}] = {d} {'-+'[i % 2]} {show(x_0)}" for i in range(count)]
            hard = "a continuum of orbits: nothing draws the motion back, so that errors stay"
            if not stays:
                hard += "; beyond its end, where the motion stops"
            t_end = Fraction(f"{(8 + 1 / 4) * 2 * n * pi:.6g}")
            start = (0, Fraction(d) + x_0, 0)
            scene = _scene(wall(F, Omega), start, t_end, f"continuum-{n}-{number}")
            yield _case(CONTINUUM, scene, hard, CSERNAK, closed)


# -- long runs -------------------------------------------------------------------------------------


def _long_run_cases() -> Iterator[ReferenceCase]:
    """Yield motions of two or three hundred events, in which errors may add up."""
    for base, periods, hard in (
        ("fig9-orbit", 150, "300 crossings of one belt on an orbit without sticks"),
        ("fig10", 75, "300 sticks and slips at two belts"),
        ("fig5", 150, "300 sticks and slips at one belt"),
    ):
        scene = load_scene(base)
        end = scene.t0 + Fraction(
            f"{(periods + 0.05) * 2 * pi / float(scene.parameters.Omega):.8g}"
        )
        yield _case(LONG_RUNS, replace(scene, name=f"long-{base}", t_end=end), hard, scene.source)
    hard = "200 turning points at undamped resonance, each farther out"
    closed = ["t[199] = 199*pi + pi/2"]
    start = (0, Fraction(1, 2) - Fraction("0.4"), 5)
    yield _case(
        LONG_RUNS, _scene(wall("0.4", 1), start, 630, "long-resonance"), hard, BALANCE, closed
    )
    hard = "200 turning points on a continuum of orbits: errors add up and nothing draws them back"
    start = (0, Fraction(1, 5) + Fraction(4, 3), 0)
    closed = ["x[199] = 1/5 + 4/3", "t[199] = 400*pi"]
    scene = _scene(wall("0.1", "1/2"), start, 1260, "long-continuum")
    yield _case(LONG_RUNS, scene, hard, CSERNAK, closed)
