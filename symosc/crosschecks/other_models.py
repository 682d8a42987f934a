"""Whether samples are the exact motion of another model: signs, swapped belts, phases, coefficients, forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf, pi, remainder, sqrt

import numpy as np

from symosc.crosschecks.causes import Diagnosis
from symosc.crosschecks.clues import LEFT_OVER, Clues, Fit, fitted
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.flow import Constants
from symosc.errors import ParameterError
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import Scene

# A diagnosis explains the samples if it explains this part of the wrong steps.
ENOUGH = 0.9
# Others that explain nearly as much as the best one cannot be told from it.
AS_GOOD = 0.02
# Steps that a fit through events uses, and those of a fit through flights.
MOST_FOLLOWED, MOST_FLOWN = 80, 400
# Derivatives are taken over this part of a coefficient.
TICK = 1e-5
# A phase so near to a quarter of a turn is one.
QUARTER = 1e-4


def other_signs(clues: Clues) -> Iterator[Diagnosis]:
    """Yield wrong signs, swapped columns and swapped belts: nothing is fitted."""
    p, s = clues.parameters, clues.steps
    columns = {"x": (-s.x, s.v), "v": (s.x, -s.v), "x and v": (-s.x, -s.v)}
    for name, (x, v) in columns.items():
        share = clues.share(clues.followed(p, x=x, v=v))
        evidence = f"with -{name.replace(' and ', ', -')} steps are right"
        yield Diagnosis("sign", name, f"{name} has the wrong sign", evidence, share=share)
    share = clues.share(clues.followed(p, x=s.v, v=s.x))
    yield Diagnosis("columns", "x and v", "the columns x and v are swapped", "swapped, steps are right", share=share)
    for boundary in (1, 2):
        speed = float(p.belt(boundary))
        if speed:
            share = clues.share(clues.followed(p, v=s.v + speed))
            words = f"v is the velocity relative to belt {boundary}"
            yield Diagnosis("columns", "v", words, f"with v + v{boundary} steps are right", share=share)
    for name in ("A0", "B0"):
        if getattr(p, name):
            share = clues.share(clues.followed(p.replace(**{name: -getattr(p, name)})))
            words = f"{name} has the wrong sign"
            yield Diagnosis("sign", name, words, f"with -{name} steps are right", -float(getattr(p, name)), 0.0, share)
    if p.mu1 != p.mu2:
        share = clues.share(clues.followed(p.replace(mu1=p.mu2, mu2=p.mu1)))
        words = f"the belts are swapped: belt 1 has mu2 = {float(p.mu2):g}, belt 2 has mu1 = {float(p.mu1):g}"
        yield Diagnosis("swapped belts", "", words, "with mu1 and mu2 swapped steps are right", share=share)


def sign_of_friction(clues: Clues) -> Iterator[Diagnosis]:
    """Yield friction that pushes away from the belts; only flights can show it, for the mass never sticks."""
    p, inside = clues.parameters, clues.inside
    if not len(inside) or not p.FN * (p.mu1 + p.mu2):
        return
    A1, A2, A3 = (float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3))
    sizes = np.max(np.abs(clues.flown(clues.steps.K._replace(A1=A1, A2=A2, A3=A3))), axis=1)
    yield Diagnosis("sign", "friction", "friction has the wrong sign: it pushes away from the belts",
                    "with -mu1 and -mu2 the flights are right", share=clues.share(sizes, inside))  # fmt: skip


def coefficients(clues: Clues) -> Iterator[Diagnosis]:
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
        if fit is None or not (_middle(fit.sizes) <= max(1.0, LEFT_OVER * before) or moved):
            continue
        other = _other(clues.parameters, name, float(fit.value[0]))
        if other is None or other == clues.parameters:
            continue
        sizes = clues.followed(other)
        yield _coefficient(clues, name, fit, clues.share(sizes))


def _middle(sizes: np.ndarray) -> float:
    shown = sizes[~np.isnan(sizes)]
    return float(np.median(shown)) if len(shown) else 0.0 if not len(sizes) else inf


def _coefficient(clues: Clues, name: str, fit: Fit, share: float) -> Diagnosis:
    value, error, right = float(fit.value[0]), float(fit.error[0]), float(getattr(clues.parameters, name))
    words = f"the solution has {name} = {rounded(value, error)}, which should be {right:.10g}"
    evidence = f"fitted: {name} = {with_error(value, error)}"
    return Diagnosis("coefficient", name, words, evidence, value, error, share)


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


def _fit_flights(clues: Clues, name: str, flights: np.ndarray) -> Fit | None:
    p = clues.parameters

    def misses(value: np.ndarray) -> np.ndarray:
        K = _constants(p, name, float(value[0]))
        return np.full((len(flights), 2), np.nan) if K is None else clues.flown(K, chosen=flights)

    return fitted(misses, np.array([float(getattr(p, name))]), np.array([_tick(p, name)]))


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


def phases_of_drive(clues: Clues, start: tuple[float, float, float] | None) -> Iterator[Diagnosis]:
    """Yield another phase of the drive, as a phase or as a shifted clock: the steps cannot tell, the start can.

    Parameters
    ----------
    clues : Clues
    start : tuple of floats (t0, x0, v0) or None
        Where the scene starts.
    """
    flights, p = clues.some(clues.inside, MOST_FLOWN), clues.parameters
    if not p.B0 or not len(flights):
        return
    K = clues.steps.K

    def misses(value: np.ndarray) -> np.ndarray:
        a, b = value
        size, turn = float(np.hypot(a, b)), float(np.arctan2(b, a))
        return clues.flown(K._replace(f0=K.f0 * size, fB=K.fB * size), turn, flights)

    fit = fitted(misses, np.array([1.0, 0.0]), np.array([1e-4, 1e-4]))
    if fit is None:
        return
    turn, size = float(np.arctan2(fit.value[1], fit.value[0])), float(np.hypot(*fit.value))
    if abs(size - 1.0) > max(1e-3, 10.0 * float(np.max(fit.error))):
        return
    finer = fitted(lambda q: clues.flown(K, float(q[0]), flights), np.array([turn]), np.array([1e-5]))
    if finer is not None:
        turn, error = float(finer.value[0]), float(finer.error[0])
        turn = remainder(turn, 2.0 * pi)
        share = clues.share(clues.followed(p, ahead=turn / K.Om))
        yield _shift_or_phase(clues, turn, error, share, start)


def _shift_or_phase(
    clues: Clues, turn: float, error: float, share: float, start: tuple[float, float, float] | None
) -> Diagnosis:
    """Return which of the two it is: with a shifted clock the samples are the scene's own motion at other times."""
    Om, s = clues.steps.K.Om, clues.steps
    quarters = round(turn / (pi / 2))
    names = {-1: " (sine in place of cosine)", 1: " (-sine in place of cosine)", 2: " (-cosine)", -2: " (-cosine)"}
    named = names.get(quarters, "") if abs(turn - quarters * pi / 2) <= max(QUARTER, 3 * error) else ""
    words = f"the drive is ahead by a phase of {rounded(turn, error)}{named}"
    evidence = f"fitted to the flights: {with_error(turn, error)}"
    phase = Diagnosis("phase", "", words, evidence, turn, error, share)
    shift = -turn / Om
    words = f"the clock of the samples is {'fast' if shift > 0 else 'slow'} by {rounded(abs(shift), error / Om)}"
    clock = Diagnosis("time shift", "", words, evidence, shift, error / Om, share)
    if start is None:
        return replace(clock, alternatives=(phase,))
    t0, x0, v0 = start
    # The scene's motion at the first sample's own time, at this phase or one of whole periods later.
    far = abs(s.t[0] - t0) > 4.0 * np.spacing(abs(t0)) if not clues.offset else False
    slack = 1e3 * clues.allowed[0]
    moved = not clues.offset and (abs(s.x[0] - x0) > slack[0] or abs(s.v[0] - v0) > slack[1])
    return clock if far or moved else phase


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
    m, share = float(clues.parameters.m), clues.share(fit.sizes, flights)
    parts = [
        f"A{d} = {rounded(m * value, m * error)} (should be {m * right:.6g})"
        for d, value, error, right in zip(visited, fit.value, fit.error, start, strict=True)
        if abs(value - right) > 5.0 * error
    ]
    if parts:
        yield Diagnosis("forces", "", f"the forces of the flights are {', '.join(parts)}",
                        "fitted to the flights of each domain", share=share)  # fmt: skip
