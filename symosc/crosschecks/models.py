"""Other systems as causes of wrong steps.

Common modelling mistakes, unchanged, and with fitted numbers.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf, pi, remainder, sqrt
from typing import Any

import numpy as np

from symosc.aliases import Record
from symosc.crosschecks.causes import (
    FITS,
    LEFT_OVER,
    SURE,
    Candidate,
    Case,
    Diagnosis,
    Fit,
    fitted,
    larger,
)
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants
from symosc.errors import ParameterError
from symosc.model import PARAMETER_NAMES, Parameters

LEAST_FLIGHTS = 3
MOST_FLIGHTS = 24
GRAVITY = 9.81
# A diagnosis explains the samples if it explains this part of the wrong steps.
ENOUGH = 0.9
# Steps that a fit through events uses, and those of a fit through flights.
MOST_FOLLOWED = 80
MOST_FLOWN = 400
# Difference quotients are taken over this part of a coefficient.
TICK = 1e-5
# Far coefficients: the fewest flights that show one, those on which values are compared, and
# frequencies of the drive.
FEWEST_FAR = 8
FEW_FAR = 24
MOST_FREQUENCIES = 4000
# A phase this near to a quarter of a turn is taken as a quarter.
QUARTER = 1e-4


# -- systems that people write by mistake ------------------------------------------------------------------------------


def other_systems(case: Case) -> Iterator[Candidate]:
    """Yield each common modelling mistake that explains the wrong steps, with a change that tests it."""
    p = case.parameters
    seen = {case.parameters}
    tried = case.thinned(case.moving_wrong, 60)
    flights = case.thinned(case.inside, MOST_FLIGHTS)
    for cause, subject, words, change, values in _systems(p):
        other = _replaced(p, **values)
        if other is None or other in seen or not len(tried):
            continue
        seen.add(other)
        if len(flights) >= LEAST_FLIGHTS and (other.v1, other.v2) == (p.v1, p.v2):
            few = case.flight_misses(Arithmetic(other).K, chosen=flights)
            chosen = flights
        else:
            few = case.some_defects_with(other, tried)
            chosen = tried
        if (
            np.mean(larger(few) <= case.limits()[chosen]) >= 0.5
        ):  # else it is not followed over all steps
            if len(values) == 1:
                value, error = (float(next(iter(values.values()))), 0.0)
            else:
                value, error = (None, None)
            found = Diagnosis(
                cause,
                subject,
                words,
                "",
                value,
                error,
                case.share(larger(case.defects_with(other))),
            )
            yield Candidate(found, f"with {change}", parameters=other)
    yield from _wrong_signs(case)


def _systems(p: Parameters) -> Iterator[tuple[str, str, str, str, Record]]:
    """Yield common modelling mistakes, likely ones first, each as five values.

    These are cause, subject and words of the `Diagnosis`, the change in words, and the changed
    parameters by name.
    """
    m = float(p.m)
    Om = float(p.Omega)
    for name in ("A0", "B0", "v1", "v2"):
        yield "sign", name, f"{name} has the wrong sign", f"-{name}", {name: -getattr(p, name)}
    swapped = f"the belts are swapped: belt 1 has mu2 = {float(p.mu2):g}, belt 2 has mu1 = {float(p.mu1):g}"
    yield "swapped belts", "", swapped, "mu1 and mu2 swapped", {"mu1": p.mu2, "mu2": p.mu1}
    if p.mu1 + p.mu2:
        yield "coefficient", "FN", "there is no friction at all (FN = 0)", "FN = 0", {"FN": 0}
    changes: list[tuple[str, Any, str]] = [
        ("Omega", Om * 2 * pi, "times 2 pi"), ("Omega", Om / (2 * pi), "divided by 2 pi"),
        ("Omega", Om * pi / 180, "Omega t in degrees"), ("Omega", Om * 180 / pi, "Omega in degrees"),
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
        yield "coefficient", name, words, f"{name} = {text}", {name: float(text)}
    for group, where in (
        (("A0", "B0", "FN"), "the forces A0, B0 and FN are"),
        (("k", "c"), "k and c are"),
    ):
        for mass, how in ((m, "not divided by m"), (1.0 / m, "divided by m twice")):
            values = {name: float(getattr(p, name)) * mass for name in group}
            change = ", ".join(f"{name} = {float(value):.17g}" for name, value in values.items())
            yield "coefficient", "m", f"{where} {how}", change, values


def _wrong_signs(case: Case) -> Iterator[Candidate]:
    """Yield the diagnosis that friction, spring or damper has the wrong sign, tried on flights inside domains."""
    p = case.parameters
    inside = case.thinned(case.inside, 10 * MOST_FLIGHTS)
    K = case.steps.K
    if len(inside) < LEAST_FLIGHTS:
        return
    from scipy.linalg import expm

    s = case.steps
    tau = np.diff(case.steps.t)[inside]
    theta = case.steps.theta[inside]
    begin = np.column_stack([s.states[inside], np.cos(theta), np.sin(theta), np.ones(len(inside))])
    against = tuple(float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3))
    right = (K.A1, K.A2, K.A3)
    for name, present, what, forces, damping, spring in (
        ("friction", p.FN * (p.mu1 + p.mu2), "it pushes away from the belts", against, 1, 1),
        ("k", p.k, "the spring pushes away", right, 1, -1),
        ("c", p.c, "the damper pushes", right, -1, 1),
    ):
        if present:
            rates = np.zeros((len(inside), 5, 5))  # of x, v, cos theta, sin theta, 1
            rates[:, 0, 1] = 1.0
            rates[:, 1, 0], rates[:, 1, 1], rates[:, 1, 2] = -spring * K.w0sq, -damping * K.cm, K.f0
            rates[:, 1, 4] = np.array(forces)[case.domain[inside] - 1]
            rates[:, 2, 3], rates[:, 3, 2] = -K.Om, K.Om
            ends = np.einsum("nij,nj->ni", expm(rates * tau[:, None, None]), begin)[:, :2]
            sizes = np.nan_to_num(case.miss_sizes(ends, inside), nan=np.inf)
            fits = sizes <= 1.0
            evidence = (
                f"with it {int(np.sum(fits))} of {len(inside)} steps inside a domain are right"
            )
            if np.all(fits) and case.flights_wrong > 0.5:
                share = 0.5 * (1.0 + SURE)
            else:
                share = case.share(sizes, inside)
            yield Candidate(
                Diagnosis("sign", name, f"{name} has the wrong sign: {what}", evidence, share=share)
            )


# -- fitted coefficients -----------------------------------------------------------------------------------------------


def coefficients(case: Case) -> Iterator[Candidate]:
    """Yield for each parameter the diagnosis that it is wrong, its value fitted to flights (v1, v2: wrong steps)."""
    for name in PARAMETER_NAMES:
        if name not in ("v1", "v2"):
            yield from _coefficient(case, name, _fit_flights(case, name))
        elif case.flights_wrong <= 0.5:
            yield from _coefficient(case, name, _fit_belt(case, name))


def far_coefficients(case: Case) -> Iterator[Candidate]:
    """Yield wrong coefficients that are too far off for a direct fit.

    The fit begins at the best value of a grid.
    """
    flights = case.thinned(case.inside, MOST_FLOWN)
    p = case.parameters
    if len(flights) < FEWEST_FAR or case.flights_wrong < 0.5:
        return
    few = case.thinned(flights, FEW_FAR)
    for name in ("m", "c", "k", "Omega"):
        factors = np.geomspace(1e-3, 1e3, 61)
        if name == "Omega":
            values = _frequencies(case, flights)
        else:
            values = (float(getattr(p, name)) or 1.0) * factors
        constants = [
            (K, float(value))
            for value in values
            if (K := _constants(p, name, float(value))) is not None
        ]
        tried = [
            (_median(larger(case.flight_misses(K, chosen=few))), value) for K, value in constants
        ]
        if tried:
            yield from _coefficient(case, name, _fit_flights(case, name, min(tried)[1]))


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


def _coefficient(case: Case, name: str, fit: Fit | None) -> Iterator[Candidate]:
    """Yield the diagnosis of a wrong coefficient, with its fitted value to the digits that are significant."""
    if fit is None:
        return
    value = float(fit.value[0])
    error = float(fit.error[0])
    right = float(getattr(case.parameters, name))
    text = rounded(value, error)
    other = _replaced(case.parameters, **{name: float(text)})
    if other is not None and other != case.parameters:
        words = f"the solution has {name} = {text}, which should be {right:.10g}"
        evidence = f"{text} ± {error:.1g}"
        share = case.share(larger(case.defects_with(other)), part=FITS)
        found = Diagnosis(
            "coefficient", name, words, f"fitted: {name} = {evidence}", value, error, share
        )
        yield Candidate(found, f"with {name} = {text}", parameters=other)


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
    return np.array([TICK * (units[name] if name in units else float(getattr(p, name)) or push)])


def _fit_flights(case: Case, name: str, start: float | None = None) -> Fit | None:
    """Fit the parameter `name` to the flights of the samples.

    None if the fit does not remove most of their defects.
    """
    p = case.parameters
    flights = case.thinned(case.inside, MOST_FLOWN)
    before = _median(case.sizes[flights])
    if not before > 1.0:
        return None

    def misses(value: np.ndarray) -> np.ndarray:
        K = _constants(p, name, float(value[0]))
        if K is None:
            return np.full((len(flights), 2), np.nan)
        return case.flight_misses(K, chosen=flights)

    fit = fitted(
        misses, np.array([float(getattr(p, name)) if start is None else start]), _tick(p, name)
    )
    if fit is not None and _median(fit.sizes) <= max(1.0, LEFT_OVER * before):
        return fit
    return None


def _constants(p: Parameters, name: str, value: float) -> Constants | None:
    """Return the engine's constants with one parameter replaced.

    None if the model does not allow the value.
    """
    other = _replaced(p, **{name: value})
    if other is not None:
        return Arithmetic(other).K
    if name in (
        "mu1",
        "mu2",
        "FN",
    ):  # beyond 0, for a derivative at 0: the forces are linear in them
        low, high = (Arithmetic(p.replace(**{name: part})).K for part in (0, abs(value)))
        changes = {
            field: 2 * getattr(low, field) - getattr(high, field)
            for field in ("cm", "w0sq", "A1", "A2", "A3")
        }
        return low._replace(**changes)
    return None


def _fit_belt(case: Case, name: str) -> Fit | None:
    """Return the speed of a belt.

    From samples that move with it if there are any, else by a fit.
    """
    p = case.parameters
    s = case.steps
    chosen = case.thinned(case.moving_wrong, MOST_FOLLOWED)

    def misses(value: np.ndarray) -> np.ndarray:
        other = _replaced(p, **{name: float(value[0])})
        if other is None:
            return np.full((len(chosen), 2), np.nan)
        return case.some_defects_with(other, chosen)

    step = np.diff(s.t)
    start = np.array([float(getattr(p, name))])
    still = (np.abs(np.diff(s.v)) <= 0.1 * case.allowed[:, 1]) & (step > 0.0)
    still &= np.abs(np.diff(s.x) - s.v[:-1] * step) <= case.allowed[:, 0]
    speeds = s.v[:-1][still & case.wrong]
    near = speeds[
        np.abs(speeds - start[0]) < np.abs(speeds - float(p.v2 if name == "v1" else p.v1))
    ]
    if len(near) >= 2:
        error = np.array([float(case.allowed[0, 1])])
        return Fit(np.array([float(np.median(near))]), error, larger(misses(start)))
    if len(chosen):
        return fitted(misses, start, _tick(p, name))
    return None


def _frequencies(case: Case, flights: np.ndarray) -> np.ndarray:
    """Return the frequencies of the drive that fit the mean accelerations of the flights best."""
    s = case.steps
    K = case.steps.K
    after = flights + 1
    begin = s.t[flights]
    end = s.t[after]
    tau = end - begin
    # The mean of x over a step is that of the cubic through its ends.
    x = 0.5 * (s.x[flights] + s.x[after]) + tau * (s.v[flights] - s.v[after]) / 12.0
    rest = (s.v[after] - s.v[flights]) / tau + K.cm * (s.x[after] - s.x[flights]) / tau + K.w0sq * x
    rest -= np.array([K.A1, K.A2, K.A3])[case.domain[flights] - 1]
    grid = np.arange(1, MOST_FREQUENCIES + 1) * min(
        0.5 / (end[-1] - begin[0]), 100.0 * K.Om / MOST_FREQUENCIES
    )
    made = (np.sin(np.outer(grid, end)) - np.sin(np.outer(grid, begin))) / np.outer(grid, tau)
    left = np.median(np.abs(K.f0 * made - rest), axis=1)
    return np.asarray(grid[np.argsort(left)[:FEW_FAR]])


# -- the phase of the drive, the forces of the domains -----------------------------------------------------------------


def phases_of_drive(case: Case) -> Iterator[Candidate]:
    """Yield the diagnosis of a drive with another phase, or of a shifted clock."""
    # Both make the same steps; the clock is shifted if the first sample is not where the scene
    # starts.
    flights = case.thinned(case.inside, MOST_FLOWN)
    K = case.steps.K
    fit = None
    if not case.parameters.B0:
        return
    if len(flights) >= FEWEST_FAR:
        turn = _phase_shift(case, flights)
    else:
        turn = None
    tick = np.array([1e-5])
    chosen = case.thinned(case.moving_wrong, MOST_FOLLOWED)

    def misses(value: np.ndarray) -> np.ndarray:
        return case.defects_with(case.parameters, float(value[0]) / K.Om)[chosen]

    if turn is not None:
        fit = fitted(lambda q: case.flight_misses(K, float(q[0]), flights), np.array([turn]), tick)
    elif len(case.wrong) <= MOST_FLOWN and len(
        chosen
    ):  # all steps, also those with events: the best of a grid
        turns = np.linspace(-pi, pi, 48, endpoint=False).reshape(-1, 1)
        fit = fitted(
            misses, min(turns, key=lambda turn: float(np.median(larger(misses(turn))))), tick
        )
    if fit is not None:
        yield _shift_or_phase(case, remainder(float(fit.value[0]), 2.0 * pi), float(fit.error[0]))


def _phase_shift(case: Case, flights: np.ndarray) -> float | None:
    """Return by which angle the drive is ahead in the steps `flights`.

    None if its amplitude is not right either.
    """
    K = case.steps.K

    def misses(value: np.ndarray) -> np.ndarray:
        size = float(np.hypot(*value))
        turn = float(np.arctan2(value[1], value[0]))
        return case.flight_misses(K._replace(f0=K.f0 * size, fB=K.fB * size), turn, flights)

    fit = fitted(misses, np.array([1.0, 0.0]), np.array([1e-4, 1e-4]))
    if fit is None or abs(np.hypot(*fit.value) - 1.0) > max(1e-3, 10.0 * float(np.max(fit.error))):
        return None
    return float(np.arctan2(fit.value[1], fit.value[0]))


def _shift_or_phase(case: Case, turn: float, error: float) -> Candidate:
    """Return the diagnosis of a drive ahead by the angle `turn`.

    A shifted clock, or another phase of the drive.
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
    near = quarters and abs(turn - quarters * pi / 2) <= max(QUARTER, 3 * error)
    if near:
        turn = quarters * pi / 2
    shift = -turn / Om
    share = case.share(larger(case.defects_with(case.parameters, turn / Om)), part=FITS)
    evidence = f"fitted: {rounded(turn, error)} ± {error:.1g}"
    words = (
        f"the drive is ahead by a phase of {rounded(turn, error)}{names[quarters] if near else ''}"
    )
    phase = Diagnosis("phase", "", words, evidence, turn, error, share)
    words = f"the clock of the samples is {'fast' if shift > 0 else 'slow'} by {rounded(abs(shift), error / Om)}"
    clock = Diagnosis("time shift", "", words, evidence, shift, error / Om, share)
    change = Candidate(
        clock, f"with {shift:.17g} taken from t", columns=lambda t, x, v: (t - shift, x, v)
    )
    if start is None:
        return change._replace(diagnosis=replace(clock, alternatives=(phase,)))
    # The scene's motion at the first sample's own time, at this phase or one of whole periods
    # later.
    off = np.abs(np.array([s.t[0], s.x[0], s.v[0]]) - start)
    if not case.offset and np.any(
        off > [4.0 * np.spacing(abs(start[0])), *(1e3 * case.allowed[0])]
    ):
        return change
    return change._replace(diagnosis=phase, words=f"with the phase turned by {turn:.17g}")


def forces(case: Case) -> Iterator[Diagnosis]:
    """Yield the diagnosis of another friction law of any form, with the fitted forces of the domains."""
    flights = case.thinned(case.inside, MOST_FLOWN)
    K = case.steps.K
    visited = [d for d in (1, 2, 3) if np.sum(case.domain[flights] == d) >= 3]
    if not visited:
        return
    names = [f"A{d}" for d in visited]
    start = np.array([float(getattr(K, name)) for name in names])

    def misses(value: np.ndarray) -> np.ndarray:
        rows = case.flight_misses(
            K._replace(**dict(zip(names, value.tolist(), strict=True))), chosen=flights
        )
        return np.where(np.isin(case.domain[flights], visited)[:, None], rows, 0.0)

    fit = fitted(misses, start, np.full(len(start), TICK * (np.max(np.abs(start)) + abs(K.f0))))
    if fit is None:
        return
    m = float(case.parameters.m)
    share = case.share(fit.sizes, flights, FITS)
    parts = [
        f"{name} = {rounded(m * value, m * error)} (should be {m * right:.6g})"
        for name, value, error, right in zip(names, fit.value, fit.error, start, strict=True)
        if abs(value - right) > 5.0 * error
    ]
    if parts:
        words = f"the forces of the flights are {', '.join(parts)}"
        yield Diagnosis("forces", "", words, "fitted to the flights of each domain", share=share)
