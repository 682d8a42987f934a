"""Whether samples are the exact motion of a system that is fitted to them: coefficients, a phase, forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf, pi, remainder, sqrt

import numpy as np

from symosc.crosschecks.causes import Candidate, Change, Diagnosis
from symosc.crosschecks.clues import FITS, LEFT_OVER, Clues, Fit, fitted
from symosc.crosschecks.steps import follow_steps
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants
from symosc.errors import ParameterError
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import Scene

# A diagnosis explains the samples if it explains this part of the wrong steps.
ENOUGH = 0.9
# Steps that a fit through events uses, and those of a fit through flights.
MOST_FOLLOWED, MOST_FLOWN = 80, 400
# Derivatives are taken over this part of a coefficient.
TICK = 1e-5
# Far coefficients: factors of the right one, the fewest flights that show one, flights on which factors are compared,
# and frequencies of the drive that are compared.
FAR_FACTORS = np.geomspace(1e-3, 1e3, 61)
FEWEST_FAR, FEW_FAR, MOST_FREQUENCIES, TURNS_TRIED = 8, 24, 4000, 48
# A phase so near to a quarter of a turn is one.
QUARTER = 1e-4


def coefficients(clues: Clues) -> Iterator[Candidate]:
    """Yield one wrong coefficient after the other, each fitted to the flights, those of belts to all steps."""
    flights = clues.some(clues.inside, MOST_FLOWN)
    before = _middle(clues.sizes[flights])
    for name in PARAMETER_NAMES:
        moved = name in ("v1", "v2")
        if not moved and len(flights) and before > 1.0:
            fit = _fit_flights(clues, name, flights)
        elif not moved or clues.flights_wrong > 0.5:
            continue
        else:
            fit = _fit_steps(clues, name)
        if fit is not None and (moved or _middle(fit.sizes) <= max(1.0, LEFT_OVER * before)):
            yield from _coefficient(clues, name, fit)


def far_coefficients(clues: Clues) -> Iterator[Candidate]:
    """Yield coefficients so far away that no fit from the right one finds them: the best of a grid is fitted."""
    flights = clues.some(clues.inside, MOST_FLOWN)
    before, p = _middle(clues.sizes[flights]), clues.parameters
    if len(flights) < FEWEST_FAR or clues.flights_wrong < 0.5:
        return
    few = clues.some(flights, FEW_FAR)
    for name in ("m", "c", "k", "Omega"):
        right = float(getattr(p, name))
        values = _frequencies(clues, flights) if name == "Omega" else (right or 1.0) * FAR_FACTORS
        tried = [(_middle(np.max(np.abs(clues.flown(K, chosen=few)), axis=1)), value)
                 for value in values if (K := _constants(p, name, float(value))) is not None]  # fmt: skip
        if tried:
            fit = _fit_flights(clues, name, flights, float(min(tried)[1]))
            if fit is not None and _middle(fit.sizes) <= max(1.0, LEFT_OVER * before):
                yield from _coefficient(clues, name, fit)


def _frequencies(clues: Clues, flights: np.ndarray) -> np.ndarray:
    """Return the frequencies of the drive that fit the mean accelerations of flights best."""
    s, K = clues.steps, clues.steps.K
    begin, end = s.t[flights], s.t[flights + 1]
    tau = end - begin
    # The mean of x over a step is that of the cubic through its ends.
    x = 0.5 * (s.x[flights] + s.x[flights + 1]) + tau * (s.v[flights] - s.v[flights + 1]) / 12.0
    rest = (s.v[flights + 1] - s.v[flights]) / tau + K.cm * (s.x[flights + 1] - s.x[flights]) / tau + K.w0sq * x
    rest -= np.array([K.A1, K.A2, K.A3])[clues.label[flights] - 1]
    grid = np.arange(1, MOST_FREQUENCIES + 1) * min(0.5 / (end[-1] - begin[0]), 100.0 * K.Om / MOST_FREQUENCIES)
    made = (np.sin(np.outer(grid, end)) - np.sin(np.outer(grid, begin))) / np.outer(grid, tau)
    left = np.median(np.abs(K.f0 * made - rest), axis=1)
    return np.asarray(grid[np.argsort(left)[:FEW_FAR]])


def _middle(sizes: np.ndarray) -> float:
    shown = sizes[~np.isnan(sizes)]
    return float(np.median(shown)) if len(shown) else 0.0 if not len(sizes) else inf


def _coefficient(clues: Clues, name: str, fit: Fit) -> Iterator[Candidate]:
    """Yield a fitted coefficient, with the digits that are named."""
    value, error, right = float(fit.value[0]), float(fit.error[0]), float(getattr(clues.parameters, name))
    text = rounded(value, error)
    other = _other(clues.parameters, name, float(text))
    if other is not None and other != clues.parameters:
        words = f"the solution has {name} = {text}, which should be {right:.10g}"
        evidence = f"fitted: {name} = {with_error(value, error)}"
        found = Diagnosis("coefficient", name, words, evidence, value, error,
                          clues.share(clues.followed(other), part=FITS))  # fmt: skip
        yield Candidate(found, Change(f"with {name} = {text}", parameters=other))


def with_error(value: float, error: float) -> str:
    """Return a number and its error as text."""
    return f"{rounded(value, error)} ± {error:.1g}"


def rounded(value: float, error: float) -> str:
    """Return a number with the digits that its error leaves, at most 10."""
    if not error > 0.0 or not value:
        return f"{value:.10g}"
    digits = int(np.clip(np.ceil(np.log10(abs(value) / error)) + 1, 2, 10))
    return f"{value:.{digits}g}"


def _other(p: Parameters, name: str, value: float) -> Parameters | None:
    """Return the parameters with one changed, or None if there is no such system."""
    try:
        return p.replace(**{name: value})
    except ParameterError:
        return None


def _tick(p: Parameters, name: str) -> float:
    """Return a small change of a parameter."""
    rate = max(float(p.Omega), sqrt(float(p.k / p.m)), float(p.c / p.m))
    push = max(abs(float(p.A(alpha))) for alpha in (1, 2, 3)) + abs(float(p.B0))
    units = {"c": float(p.m) * rate, "k": float(p.m) * rate**2, "A0": push, "B0": push, "mu1": 1.0, "mu2": 1.0}
    units |= {"v1": float(p.v2 - p.v1), "v2": float(p.v2 - p.v1)}
    return TICK * (units[name] if name in units else float(getattr(p, name)) or push)


def _fit_flights(clues: Clues, name: str, flights: np.ndarray, start: float | None = None) -> Fit | None:
    p = clues.parameters
    start = float(getattr(p, name)) if start is None else start

    def misses(value: np.ndarray) -> np.ndarray:
        K = _constants(p, name, float(value[0]))
        return np.full((len(flights), 2), np.nan) if K is None else clues.flown(K, chosen=flights)

    return fitted(misses, np.array([start]), np.array([_tick(p, name)]))


def _constants(p: Parameters, name: str, value: float) -> Constants | None:
    other = _other(p, name, value)
    if other is not None:
        return Arithmetic(other).K
    if name in ("mu1", "mu2", "FN", "c", "k"):  # beyond 0, for a derivative at 0
        low, high = (Arithmetic(p.replace(**{name: part})).K for part in (0, abs(value)))
        changes = {field: 2 * getattr(low, field) - getattr(high, field) for field in ("cm", "w0sq", "A1", "A2", "A3")}
        return low._replace(**changes) if name in ("mu1", "mu2", "FN") else None
    return None


def _fit_steps(clues: Clues, name: str) -> Fit | None:
    p = clues.parameters
    chosen = clues.some(np.flatnonzero(clues.wrong & (np.diff(clues.steps.t) > 0.0)), MOST_FOLLOWED)

    def misses(value: np.ndarray) -> np.ndarray:
        other = _other(p, name, float(value[0]))
        return np.full((len(chosen), 2), np.nan) if other is None else clues.followed_some(other, chosen)

    start = np.array([float(getattr(p, name))])
    held = _held_speed(clues, name)
    if held is not None:
        return Fit(np.array([held]), np.array([float(clues.allowed[0, 1])]), np.max(np.abs(misses(start)), axis=1))
    return fitted(misses, start, np.array([_tick(p, name)])) if len(chosen) else None


def _held_speed(clues: Clues, name: str) -> float | None:
    """Return a constant velocity of samples near to that belt, at which x goes on as well, or None."""
    s = clues.steps
    step = np.diff(s.t)
    still = (np.abs(np.diff(s.v)) <= 0.1 * clues.allowed[:, 1]) & (step > 0.0)
    still &= np.abs(np.diff(s.x) - s.v[:-1] * step) <= clues.allowed[:, 0]
    speeds = s.v[:-1][still & clues.wrong]
    if len(speeds) < 2:
        return None
    own, others = (float(clues.parameters.v1), float(clues.parameters.v2))[:: 1 if name == "v1" else -1]
    near = speeds[np.abs(speeds - own) < np.abs(speeds - others)]
    return float(np.median(near)) if len(near) >= 2 else None


def own_start(scene: Scene | Parameters) -> tuple[float, float, float] | None:
    """Return where a scene starts: t0, x0, v0; None for Parameters, which start nowhere."""
    return None if isinstance(scene, Parameters) else (float(scene.t0), float(scene.x0), float(scene.v0))


def phases_of_drive(clues: Clues, start: tuple[float, float, float] | None) -> Iterator[Candidate]:
    """Yield another phase of the drive, as a phase or as a shifted clock: the steps cannot tell, the start can.

    Parameters
    ----------
    clues : Clues
    start : tuple of floats (t0, x0, v0) or None
        Where the scene starts.
    """
    flights, K = clues.some(clues.inside, MOST_FLOWN), clues.steps.K
    if not clues.parameters.B0:
        return
    turn = _turn_of_flights(clues, flights) if len(flights) >= FEWEST_FAR else None
    finer = None
    if turn is not None:
        finer = fitted(lambda q: clues.flown(K, float(q[0]), flights), np.array([turn]), np.array([1e-5]))
    elif len(clues.wrong) <= MOST_FLOWN:
        finer = _turn_of_steps(clues)
    if finer is not None:
        turn, error = remainder(float(finer.value[0]), 2.0 * pi), float(finer.error[0])
        yield _shift_or_phase(clues, turn, error, start)


def _turn_of_flights(clues: Clues, flights: np.ndarray) -> float | None:
    """Return the phase by which the drive of flights is ahead, if they have a drive of that size."""
    K = clues.steps.K

    def misses(value: np.ndarray) -> np.ndarray:
        a, b = value
        size, turn = float(np.hypot(a, b)), float(np.arctan2(b, a))
        return clues.flown(K._replace(f0=K.f0 * size, fB=K.fB * size), turn, flights)

    fit = fitted(misses, np.array([1.0, 0.0]), np.array([1e-4, 1e-4]))
    if fit is None or abs(np.hypot(*fit.value) - 1.0) > max(1e-3, 10.0 * float(np.max(fit.error))):
        return None
    return float(np.arctan2(fit.value[1], fit.value[0]))


def _turn_of_steps(clues: Clues) -> Fit | None:
    """Return the phase of all steps, also of those with events: the best of a grid is fitted."""
    s, chosen = clues.steps, clues.some(np.flatnonzero(clues.wrong & (np.diff(clues.steps.t) > 0.0)), MOST_FOLLOWED)

    def misses(value: np.ndarray) -> np.ndarray:
        found = follow_steps(clues.parameters, s.t + float(value[0]) / s.K.Om, s.x, s.v, clues.near, clues.scales)
        return np.asarray((found.defects / clues.allowed)[chosen])

    turns = np.linspace(-pi, pi, TURNS_TRIED, endpoint=False)
    best = min(turns.tolist(), key=lambda turn: float(np.median(np.max(np.abs(misses(np.array([turn]))), axis=1))))
    return fitted(misses, np.array([best]), np.array([1e-5])) if len(chosen) else None


def _shift_or_phase(clues: Clues, turn: float, error: float, start: tuple[float, float, float] | None) -> Candidate:
    """Return which of the two it is: with a shifted clock the samples are the scene's own motion at other times."""
    Om, s = clues.steps.K.Om, clues.steps
    quarters = round(turn / (pi / 2))
    names = {-1: " (sine in place of cosine)", 1: " (-sine in place of cosine)", 2: " (-cosine)", -2: " (-cosine)"}
    near = quarters and abs(turn - quarters * pi / 2) <= max(QUARTER, 3 * error)
    turn = quarters * pi / 2 if near else turn
    share = clues.share(clues.followed(clues.parameters, ahead=turn / Om), part=FITS)
    words = f"the drive is ahead by a phase of {rounded(turn, error)}{names[quarters] if near else ''}"
    evidence = f"fitted: {with_error(turn, error)}"
    phase = Diagnosis("phase", "", words, evidence, turn, error, share)
    shift = -turn / Om
    words = f"the clock of the samples is {'fast' if shift > 0 else 'slow'} by {rounded(abs(shift), error / Om)}"
    clock = Diagnosis("time shift", "", words, evidence, shift, error / Om, share)
    change = Change(f"with {shift:.17g} taken from t", columns=lambda t, x, v: (t - shift, x, v))
    if start is None:
        return Candidate(replace(clock, alternatives=(phase,)), change)
    t0, x0, v0 = start
    # The scene's motion at the first sample's own time, at this phase or one of whole periods later.
    far = abs(s.t[0] - t0) > 4.0 * np.spacing(abs(t0)) if not clues.offset else False
    slack = 1e3 * clues.allowed[0]
    moved = not clues.offset and (abs(s.x[0] - x0) > slack[0] or abs(s.v[0] - v0) > slack[1])
    if far or moved:
        return Candidate(clock, change)
    return Candidate(phase, change._replace(words=f"with the phase turned by {turn:.17g}"))


def forces(clues: Clues) -> Iterator[Diagnosis]:
    """Yield the forces of the domains, fitted to the flights: another law of friction, whatever it is."""
    flights, K = clues.some(clues.inside, MOST_FLOWN), clues.steps.K
    visited = [d for d in (1, 2, 3) if np.sum(clues.label[flights] == d) >= 3]
    if not visited:
        return
    names = [f"A{d}" for d in visited]
    start = np.array([float(getattr(K, name)) for name in names])
    tick = TICK * (np.max(np.abs(start)) + abs(K.f0))

    def misses(value: np.ndarray) -> np.ndarray:
        rows = clues.flown(K._replace(**dict(zip(names, value.tolist(), strict=True))), chosen=flights)
        return np.where(np.isin(clues.label[flights], visited)[:, None], rows, 0.0)

    fit = fitted(misses, start, np.full(len(start), tick))
    if fit is None:
        return
    m, share = float(clues.parameters.m), clues.share(fit.sizes, flights, FITS)
    parts = [
        f"A{d} = {rounded(m * value, m * error)} (should be {m * right:.6g})"
        for d, value, error, right in zip(visited, fit.value, fit.error, start, strict=True)
        if abs(value - right) > 5.0 * error
    ]
    if parts:
        yield Diagnosis("forces", "", f"the forces of the flights are {', '.join(parts)}",
                        "fitted to the flights of each domain", share=share)  # fmt: skip
