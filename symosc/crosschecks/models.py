"""Other systems as causes of wrong steps.

Common modelling mistakes, unchanged, and with fitted numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from math import cos, inf, pi, remainder, sqrt
from typing import Any, NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.crosschecks.causes import (
    FEW_TELLING,
    LEFT_OVER,
    Diagnosis,
    Explanation,
    FaultySteps,
    FittedNumber,
    fitted,
    larger,
)
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants
from symosc.engine.state import ON_BELT
from symosc.kernels._generated import acceleration
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.simulation.tables import counted

LEAST_FLIGHTS = 3
MOST_FLIGHTS = 24
GRAVITY = 9.81
# Flights that a fit uses, and steps over which a wrong sign is tried first.
MOST_FLOWN = 400
FEW_INTEGRATED = 8
# Wrong steps that determine a number.
FEWEST_FITTED = 3
# Difference quotients are taken over this part of a coefficient.
TICK = 1e-5
# The same for a phase, and how many phases are tried first.
TICK_OF_PHASE = 1e-5
PHASES_TRIED = 48
# Far coefficients: the fewest flights that show one, those on which values are compared, and
# frequencies of the drive.
FEWEST_FAR = 8
FEW_FAR = 24
MOST_FREQUENCIES = 4000
# Speeds of a belt from which a fit may begin: the right one, and by so much of the belts' distance
# faster or slower.
BELT_GRID = np.linspace(-0.25, 0.25, 41)
# A phase this near to a quarter of a turn is taken as a quarter.
QUARTER = 1e-4


# -- systems that people write by mistake ----------------------------------------------------------


def other_systems(case: FaultySteps) -> Iterator[Explanation]:
    """Yield each common modelling mistake that explains the wrong steps, with a change that tests
    it.
    """
    p = case.paper
    seen = {case.paper}
    flights = case.thinned(case.inside_wrong, MOST_FLIGHTS)
    for mistake in _systems(p):
        system = _replaced(p, **mistake.values)
        if system is None or system in seen:
            continue
        seen.add(system)
        # A few flights rule out most systems; they do not tell the speeds of the belts.
        if len(flights) >= LEAST_FLIGHTS and (system.v1, system.v2) == (p.v1, p.v2):
            few = larger(case.flight_misses(Arithmetic(system).K, chosen=flights))
            if np.mean(few <= case.limits()[flights]) < 0.5:
                continue
        left = case.left_with(system)
        if left is not None:
            value = error = None
            if len(mistake.values) == 1:
                (changed,) = mistake.values.values()
                value = float(changed)
                error = 0.0
            diagnosis = Diagnosis(mistake.cause, mistake.subject, mistake.words, "", value, error)
            yield Explanation(diagnosis, f"with {mistake.change}", parameters=system, left=left)
    yield from _wrong_signs(case)


class Mistake(NamedTuple):
    """A common modelling mistake: cause, subject and words of its `Diagnosis`, the change in words,
    and the changed parameters by name.
    """

    cause: str
    subject: str
    words: str
    change: str
    values: Record


def _systems(p: Parameters) -> Iterator[Mistake]:
    """Yield common modelling mistakes, likely ones first."""
    m = float(p.m)
    Om = float(p.Omega)
    for name in ("A0", "B0", "v1", "v2"):
        words = f"{name} has the wrong sign"
        yield Mistake("sign", name, words, f"-{name}", {name: -getattr(p, name)})
    of_belts = f"belt 1 has mu2 = {float(p.mu2):g}, belt 2 has mu1 = {float(p.mu1):g}"
    swapped = f"the belts are swapped: {of_belts}"
    exchanged = {"mu1": p.mu2, "mu2": p.mu1}
    yield Mistake("swapped belts", "", swapped, "mu1 and mu2 swapped", exchanged)
    if p.mu1 + p.mu2:
        words = "there is no friction at all (FN = 0)"
        yield Mistake("coefficient", "FN", words, "FN = 0", {"FN": 0})
    changes: list[tuple[str, Any, str]] = [
        ("Omega", Om * 2 * pi, "times 2 pi"), ("Omega", Om / (2 * pi), "divided by 2 pi"),
        ("Omega", Om * pi / 180, "Omega t in degrees"),
        ("Omega", Om * 180 / pi, "Omega in degrees"),
        ("Omega", Om * Om, "its square"), ("Omega", 2 * Om, "twice"), ("Omega", Om / 2, "half"),
        ("m", m * m, "divided by twice"), ("m", 1.0, "left out"),
        ("m", m * 1000, "times 1000"), ("m", m / 1000, "/1000"),
    ]  # fmt: skip
    for factor, why in ((0, "missing"), (0.5, "half"), (2, "twice")):
        names = ("c", "k", "B0", "A0", "FN", "mu1", "mu2", "m")
        changes += [(name, float(getattr(p, name)) * factor, why) for name in names]
    changes += [
        ("FN", float(p.FN) * GRAVITY, "times g"),
        ("FN", float(p.FN) * (1 / GRAVITY), "divided by g"),
    ]
    changes += [("mu1", p.mu2, "mu2 in its place"), ("mu2", p.mu1, "mu1 in its place")]
    for name, value, why in changes:
        # 0, not -0
        text = f"{float(value) + 0.0:.15g}"
        right = float(getattr(p, name))
        words = f"the solution has {name} = {text}, which should be {right:.10g}: {why}"
        yield Mistake("coefficient", name, words, f"{name} = {text}", {name: float(text)})
    for group, where in (
        (("A0", "B0", "FN"), "the forces A0, B0 and FN are"),
        (("k", "c"), "k and c are"),
    ):
        for factor, fault in ((m, "not divided by m"), (1.0 / m, "divided by m twice")):
            values = {name: float(getattr(p, name)) * factor for name in group}
            change = ", ".join(f"{name} = {float(value):.17g}" for name, value in values.items())
            yield Mistake("coefficient", "m", f"{where} {fault}", change, values)


class WrongSign(NamedTuple):
    """A force with the wrong sign: what makes it (0 if it is absent), its effect in words, and the
    equation with it: constant forces by domain, and factors of damper and spring.
    """

    name: str
    size: Any
    effect: str
    forces: tuple[float, ...]
    damping: int = 1
    spring: int = 1


def _wrong_signs(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that friction, spring or damper has the wrong sign, by integration over
    steps.
    """
    p = case.paper
    K = case.steps.K
    steps = case.telling
    # A0 minus the friction, in place of A0 plus the friction.
    against = tuple(float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3))
    right = (K.A1, K.A2, K.A3)
    candidates = (
        WrongSign("friction", p.FN * (p.mu1 + p.mu2), "it pushes away from the belts", against),
        WrongSign("k", p.k, "the spring pushes away", right, spring=-1),
        WrongSign("c", p.c, "the damper pushes", right, damping=-1),
    )
    for candidate in candidates:
        if not candidate.size or not len(steps):
            continue

        def force(x: float, v: float, phase: float, wrong: WrongSign = candidate) -> float:
            """Return the acceleration of the mass with this wrong sign."""
            A = wrong.forces[(v > K.belt1.v) + (v > K.belt2.v)]
            cm = wrong.damping * K.cm
            w0sq = wrong.spring * K.w0sq
            return float(acceleration(x, v, cos(phase), A, cm, w0sq, K.f0))

        few = case.thinned(steps, FEW_INTEGRATED)
        if np.mean(larger(case.integrated(force, few)) <= case.limits()[few]) < 0.5:
            continue
        sizes = larger(case.integrated(force, steps))
        fits = int(np.sum(sizes <= case.limits()[steps]))
        evidence = f"with it {fits} of {counted(len(steps), 'step')} tried are right"
        words = f"{candidate.name} has the wrong sign: {candidate.effect}"
        diagnosis = Diagnosis("sign", candidate.name, words, evidence)
        yield Explanation(diagnosis, left=case.leaving(sizes, steps))


# -- fitted coefficients ---------------------------------------------------------------------------


def coefficients(case: FaultySteps) -> Iterator[Explanation]:
    """Yield for each parameter the diagnosis that it is wrong, its value fitted to flights (v1, v2:
    wrong steps).
    """
    for name in PARAMETER_NAMES:
        if name not in ("v1", "v2"):
            yield from _coefficient(case, name, _fit_flights(case, name))
        elif case.flights_wrong <= 0.5:
            yield from _coefficient(case, name, _fit_belt(case, name))


def far_coefficients(case: FaultySteps) -> Iterator[Explanation]:
    """Yield wrong coefficients that are too far off for a direct fit.

    The fit begins at the best value of a grid.
    """
    flights = case.thinned(case.inside, MOST_FLOWN)
    p = case.paper
    if len(flights) < FEWEST_FAR or case.flights_wrong < 0.5:
        return
    few = case.thinned(flights, FEW_FAR)
    for name in ("m", "c", "k", "Omega"):
        factors = np.geomspace(1e-3, 1e3, 25)
        if name == "Omega":
            values = _frequencies(case, flights)
        else:
            values = (float(getattr(p, name)) or 1.0) * factors
        misses_and_values = list[tuple[float, float]]()
        for value in map(float, values):
            K = _constants(p, name, value)
            if K is not None:
                miss = _median(larger(case.flight_misses(K, chosen=few)))
                misses_and_values.append((miss, value))
        if misses_and_values:
            _, best = min(misses_and_values)
            yield from _coefficient(case, name, _fit_flights(case, name, best))


def _mean(sizes: np.ndarray) -> float:
    """Return the mean of the sizes of defects; inf if one is not known."""
    return float(np.mean(np.nan_to_num(sizes, nan=inf)))


def _median(sizes: np.ndarray) -> float:
    """Return the median of the sizes of defects without NaN.

    Inf if all are NaN, 0 if `sizes` is empty.
    """
    known = sizes[~np.isnan(sizes)]
    if len(known):
        return float(np.median(known))
    if not len(sizes):
        return 0.0
    return inf


def _coefficient(case: FaultySteps, name: str, fit: FittedNumber | None) -> Iterator[Explanation]:
    """Yield the diagnosis of a wrong coefficient, with its fitted value to the digits that are
    significant.
    """
    if fit is None or len(case.moving_wrong) < FEWEST_FITTED:
        return
    value = float(fit.value[0])
    error = float(fit.error[0])
    right = float(getattr(case.paper, name))
    text = rounded(value, error)
    changed = _replaced(case.paper, **{name: float(text)})
    if changed is None or changed == case.paper:
        left = None
    else:
        left = case.left_with(changed)
    if left is not None:
        words = f"the solution has {name} = {text}, which should be {right:.10g}"
        evidence = f"fitted: {name} = {text} ± {error:.1g}"
        diagnosis = Diagnosis("coefficient", name, words, evidence, value, error)
        yield Explanation(diagnosis, f"with {name} = {text}", parameters=changed, left=left)


def rounded(value: float, error: float) -> str:
    """Return a number rounded to the digits that its error justifies, at most 10."""
    if not error > 0.0 or not value:
        return f"{value:.10g}"
    digits = int(np.clip(np.ceil(np.log10(abs(value) / error)) + 1, 2, 10))
    return f"{value:.{digits}g}"


def _replaced(p: Parameters, **values: Any) -> Parameters | None:
    """Return the parameters with new values, or None if the model does not allow them."""
    try:
        return p.replace(**values)
    except ParameterError:
        return None


def _tick(p: Parameters, name: str) -> np.ndarray:
    """Return a small change of a parameter, to be used in a difference quotient."""
    rate = max(float(p.Omega), sqrt(float(p.k / p.m)), float(p.c / p.m))
    push = max(abs(float(p.A(alpha))) for alpha in (1, 2, 3)) + abs(float(p.B0))
    units = {
        "c": float(p.m) * rate,
        "k": float(p.m) * rate**2,
        "A0": push,
        "B0": push,
        "mu1": 1.0,
        "mu2": 1.0,
    }
    units |= {"v1": float(p.v2 - p.v1), "v2": float(p.v2 - p.v1)}
    # m and Omega have their own size, and so has FN, unless it is 0.
    unit = units[name] if name in units else float(getattr(p, name)) or push
    return np.array([TICK * unit])


def _fit_flights(case: FaultySteps, name: str, start: float | None = None) -> FittedNumber | None:
    """Fit the parameter `name` to the flights of the samples.

    None if the fit does not remove most of their defects.
    """
    p = case.paper
    flights = case.thinned(case.inside, MOST_FLOWN)
    before = _median(case.sizes[flights])
    if not before > 1.0:
        return None

    def misses(value: np.ndarray) -> np.ndarray:
        K = _constants(p, name, float(value[0]))
        if K is None:
            return np.full((len(flights), 2), np.nan)
        return case.flight_misses(K, chosen=flights)

    first = float(getattr(p, name)) if start is None else start
    fit = fitted(misses, np.array([first]), _tick(p, name))
    if fit is not None and _median(fit.sizes) <= max(1.0, LEFT_OVER * before):
        return fit
    return None


def _constants(p: Parameters, name: str, value: float) -> Constants | None:
    """Return the engine's constants with one parameter replaced.

    None if the model does not allow the value.
    """
    changed = _replaced(p, **{name: value})
    if changed is not None:
        return Arithmetic(changed).K
    if name in ("mu1", "mu2", "FN"):
        # A difference quotient at 0 takes a value below 0. The forces are linear in it, and follow
        # from those at 0 and at its mirror image.
        at_zero, at_image = (Arithmetic(p.replace(**{name: size})).K for size in (0, abs(value)))
        changes = {
            field: 2 * getattr(at_zero, field) - getattr(at_image, field)
            for field in ("cm", "w0sq", "A1", "A2", "A3")
        }
        return at_zero._replace(**changes)
    return None


def _fit_belt(case: FaultySteps, name: str) -> FittedNumber | None:
    """Return the speed of a belt, from samples that move with it if there are any, else by a
    fit.
    """
    p = case.paper
    s = case.steps
    chosen = case.thinned(case.telling, MOST_FLIGHTS)

    def misses(value: np.ndarray) -> np.ndarray:
        changed = _replaced(p, **{name: float(value[0])})
        if changed is None:
            return np.full((len(chosen), 2), np.nan)
        return case.some_defects_with(changed, chosen)

    step = np.diff(s.t)
    allowed_x, allowed_v = case.allowed.T
    start = np.array([float(getattr(p, name))])
    # Steps that move at one velocity are sticks: on this belt if they are nearer to its speed.
    is_steady = (np.abs(np.diff(s.v)) <= 0.1 * allowed_v) & (step > 0.0)
    is_steady &= np.abs(np.diff(s.x) - s.v[:-1] * step) <= allowed_x
    speeds = s.v[:-1][is_steady & case.wrong]
    if name == "v1":
        other_speed = float(p.v2)
    else:
        other_speed = float(p.v1)
    own_speeds = speeds[np.abs(speeds - start[0]) < np.abs(speeds - other_speed)]
    if len(own_speeds) >= 2:
        speed = np.array([float(np.median(own_speeds))])
        error = np.array([float(allowed_v[0])])
        return FittedNumber(speed, error, larger(misses(start)))
    if not len(chosen):
        return None
    # Steps that do not meet the belt with one speed may meet it with another: the fit begins at the
    # best speed of a grid.
    few = case.thinned(chosen, FEW_TELLING)
    speeds = start + BELT_GRID[:, None] * float(p.v2 - p.v1)
    left = [
        (_mean(larger(case.some_defects_with(second, few))), value)
        for value in speeds
        if (second := _replaced(p, **{name: float(value[0])})) is not None
    ]
    return fitted(misses, min(left, key=lambda pair: pair[0])[1], _tick(p, name))


def _frequencies(case: FaultySteps, flights: np.ndarray) -> np.ndarray:
    """Return the frequencies of the drive that fit the mean accelerations of the flights best."""
    s = case.steps
    K = case.steps.K
    after = flights + 1
    begin = s.t[flights]
    end = s.t[after]
    tau = end - begin
    # The mean of x over a step is that of the cubic through its ends.
    x = 0.5 * (s.x[flights] + s.x[after]) + tau * (s.v[flights] - s.v[after]) / 12.0
    # What is left of the mean acceleration without damper, spring and friction is the drive.
    mean_a = (s.v[after] - s.v[flights]) / tau
    mean_v = (s.x[after] - s.x[flights]) / tau
    drive = mean_a + K.cm * mean_v + K.w0sq * x
    drive -= np.array([K.A1, K.A2, K.A3])[case.domain[flights] - 1]
    # Half a radian apart over the whole time, or so far that they reach up to 100 Omega.
    spacing = min(0.5 / (end[-1] - begin[0]), 100.0 * K.Om / MOST_FREQUENCIES)
    grid = np.arange(1, MOST_FREQUENCIES + 1) * spacing
    # The mean of cos(Omega t) over each step, for each Omega of the grid.
    cosines = (np.sin(np.outer(grid, end)) - np.sin(np.outer(grid, begin))) / np.outer(grid, tau)
    left = np.median(np.abs(K.f0 * cosines - drive), axis=1)
    return np.asarray(grid[np.argsort(left)[:FEW_FAR]])


# -- the clock, and the phase of the drive ---------------------------------------------------------


def phases_of_drive(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis of a drive with another phase, or of a shifted clock."""
    # Both make the same steps; the clock is shifted if the first sample is not where the scene
    # starts.
    flights = case.thinned(case.inside, MOST_FLOWN)
    K = case.steps.K
    fit = None
    if not case.paper.B0 or len(case.moving_wrong) < FEWEST_FITTED:
        return
    if len(flights) >= FEWEST_FAR:
        turn = _phase_shift(case, flights)
    else:
        turn = None
    tick = np.array([TICK_OF_PHASE])
    chosen = case.thinned(case.telling, MOST_FLIGHTS)

    def misses(value: np.ndarray) -> np.ndarray:
        return case.some_defects_with(case.paper, chosen, float(value[0]) / K.Om)

    if turn is not None:
        fit = fitted(lambda q: case.flight_misses(K, float(q[0]), flights), np.array([turn]), tick)
    elif len(case.wrong) <= MOST_FLOWN and len(chosen):
        # Too few flights: steps with events are used too, and the fit begins at the best of a grid.
        turns = np.linspace(-pi, pi, PHASES_TRIED, endpoint=False).reshape(-1, 1)
        best = min(turns, key=lambda turn: float(np.median(larger(misses(turn)))))
        fit = fitted(misses, best, tick)
    if fit is not None:
        angle = remainder(float(fit.value[0]), 2.0 * pi)
        yield from _shift_or_phase(case, angle, float(fit.error[0]))


def _phase_shift(case: FaultySteps, flights: np.ndarray) -> float | None:
    """Return by which angle the drive is ahead in the steps `flights`.

    None if its amplitude is not right either.
    """
    K = case.steps.K

    # The drive times `cosine` plus its quadrature times `sine`: defects are linear in both.
    def misses(value: np.ndarray) -> np.ndarray:
        """Return what flights miss with the drive's amplitude and phase from (cosine, sine)."""
        cosine, sine = value
        size = float(np.hypot(cosine, sine))
        turn = float(np.arctan2(sine, cosine))
        return case.flight_misses(K._replace(f0=K.f0 * size, fB=K.fB * size), turn, flights)

    fit = fitted(misses, np.array([1.0, 0.0]), np.array([1e-4, 1e-4]))
    if fit is None:
        return None
    cosine, sine = fit.value
    off_size = abs(np.hypot(cosine, sine) - 1.0)
    if off_size > max(1e-3, 10.0 * float(np.max(fit.error))):
        return None
    return float(np.arctan2(sine, cosine))


def _shift_or_phase(case: FaultySteps, turn: float, error: float) -> Iterator[Explanation]:
    """Yield the diagnoses of a drive ahead by the angle `turn`: a shifted clock, or another phase
    of the drive, or both.
    """
    Om = case.steps.K.Om
    s = case.steps
    start = case.check.own_start
    quarters = round(turn / (pi / 2))
    names = {
        -1: " (sine in place of cosine)",
        1: " (-sine in place of cosine)",
        2: " (-cosine)",
        -2: " (-cosine)",
    }
    remark = ""
    if quarters and abs(turn - quarters * pi / 2) <= max(QUARTER, 3 * error):
        turn = quarters * pi / 2
        remark = names[quarters]
    shift = -turn / Om
    left = case.left_with(case.paper, turn / Om)
    if left is None:
        return
    evidence = f"fitted: {rounded(turn, error)} ± {error:.1g}"
    words = f"the drive is ahead by a phase of {rounded(turn, error)}{remark}"
    change = f"with the phase turned by {turn:.17g}"
    phase = Diagnosis("phase", "", words, evidence, turn, error)
    turned = Explanation(phase, change, columns=lambda t, x, v: (t - shift, x, v), left=left)
    if shift > 0:
        pace = "fast"
    else:
        pace = "slow"
    words = f"the clock of the samples is {pace} by {rounded(abs(shift), error / Om)}"
    clock = Diagnosis("time shift", "", words, evidence, shift, error / Om)
    change = f"with {shift:.17g} taken from t"
    moved = Explanation(clock, change, columns=lambda t, x, v: (t - shift, x, v), left=left)
    # Where the scene's own start is among the samples, at its own time, the clock is right.
    at_start = False
    if start is not None:
        t0, _, _ = start
        off = np.abs(np.array([s.t[0], s.x[0], s.v[0]]) - start)
        limits = [4.0 * np.spacing(abs(t0)), *(1e3 * case.allowed[0])]
        at_start = bool(case.offset) or not np.any(off > limits)
    if not at_start:
        yield moved
    if at_start or start is None:
        yield turned


def jumps_of_clock(case: FaultySteps) -> Iterator[Explanation]:
    """Yield the diagnosis that the clock jumps in the first wrong step.

    All later times are off by one number.
    """
    s = case.steps
    i = int(case.moving_wrong[0])
    is_stick = bool(s.first[i] > ON_BELT and s.last[i] == s.first[i] and i not in s.events.step)
    # Steps with events do not tell it, and a jump in the first step is a shift of the whole clock.
    if not (is_stick or i in case.inside) or i + case.offset == 0:
        return
    step = np.array([i])  # arrays of one element, as `fly` and `misses` take them
    x = s.x[step]
    v = s.v[step]

    def misses(value: np.ndarray) -> np.ndarray:
        """Return by how much the step is missed if the clock is ahead at its end by `value`."""
        tau = s.t[step + 1] - s.t[step] - value
        if is_stick:
            ends = np.column_stack([x + v * tau, v])
        else:
            ends = s.fly(case.domain[step], x, v, s.theta[step], tau)
        return case.misses(ends, step)

    fit = fitted(misses, np.zeros(1), np.array([1e-6 * (s.t[i + 1] - s.t[i])]))
    if fit is None or fit.sizes[0] > case.limits()[i]:
        return
    shift = float(fit.value[0])
    error = float(fit.error[0])
    time = float(s.t[i])
    if shift > 0:
        pace = "fast"
    else:
        pace = "slow"
    words = f"the clock of the samples jumps after t = {time:.10g}: from there on it is {pace} by "
    evidence = f"fitted: {rounded(shift, error)} ± {error:.1g}"
    diagnosis = Diagnosis(
        "time shift", "", words + rounded(abs(shift), error), evidence, shift, error
    )
    change = f"with {shift:.17g} taken from t after t = {time:.10g}"
    yield Explanation(diagnosis, change, columns=partial(_moved_after, time, shift))


def _moved_after(
    time: float, shift: float, t: np.ndarray, x: np.ndarray, v: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the columns with `shift` taken from all times after a `time`."""
    return np.where(t > time, t - shift, t), x, v
