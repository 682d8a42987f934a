"""Other systems and other columns that are tried as they are, nothing fitted: one table of each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from math import pi
from typing import Any

import numpy as np

from symosc.crosschecks.causes import Candidate, Change, Diagnosis
from symosc.crosschecks.clues import SURE, Clues
from symosc.engine.arithmetic import Arithmetic
from symosc.errors import ParameterError
from symosc.model import Parameters

# Steps on which a system is tried first, and the part of them that it must explain to be followed over all.
MOST_TRIED, SEEMS_RIGHT = 60, 0.5
# x must be the way that v makes, to this factor.
SAME_WAY = 5.0
LEAST_FLIGHTS, MOST_FLIGHTS, SERIES_TERMS = 3, 24, 18
GRAVITY = 9.81
# A system: cause, subject, words, the change in words, values that change.
System = tuple[str, str, str, str, dict[str, Any]]
# A transform of the columns: cause, subject, words, the change in words, its number, and the function.
Column = tuple[str, str, str, str, float | None, Any]


def other_systems(clues: Clues) -> Iterator[Candidate]:
    """Yield the systems of the table that explain the steps, each with the change that tests it."""
    p, seen = clues.parameters, {clues.parameters}
    tried = clues.some(np.flatnonzero(clues.wrong & (np.diff(clues.steps.t) > 0.0)), MOST_TRIED)
    flights = clues.some(clues.inside, MOST_FLIGHTS)
    for cause, subject, words, change, values in _systems(p):
        try:
            other = p.replace(**values)
        except ParameterError:
            continue
        if other in seen or not len(tried):
            continue
        seen.add(other)
        if len(flights) >= LEAST_FLIGHTS and (other.v1, other.v2) == (p.v1, p.v2):
            few, chosen = clues.flown(Arithmetic(other).K, chosen=flights), flights
        else:
            few, chosen = clues.followed_some(other, tried), tried
        if np.mean(np.max(np.abs(few), axis=1) <= clues.limits()[chosen]) < SEEMS_RIGHT:
            continue
        value = float(next(iter(values.values()))) if len(values) == 1 else None
        share = clues.share(clues.followed(other))
        found = Diagnosis(cause, subject, words, "", value, None if value is None else 0.0, share)
        yield Candidate(found, Change(f"with {change}", parameters=other))
    yield from _flights_of_no_system(clues)


def _systems(p: Parameters) -> Iterator[System]:
    """Yield what people write in place of the right system, the likeliest first."""
    m, Om = float(p.m), float(p.Omega)
    for name in ("A0", "B0", "v1", "v2"):
        yield "sign", name, f"{name} has the wrong sign", f"-{name}", {name: -getattr(p, name)}
    swapped = f"the belts are swapped: belt 1 has mu2 = {float(p.mu2):g}, belt 2 has mu1 = {float(p.mu1):g}"
    yield "swapped belts", "", swapped, "mu1 and mu2 swapped", {"mu1": p.mu2, "mu2": p.mu1}
    if p.mu1 + p.mu2:
        yield "coefficient", "FN", "there is no friction at all (FN = 0)", "FN = 0", {"FN": 0}

    def coefficient(name: str, value: Any, why: str) -> System:
        text, right = f"{float(value):.15g}", float(getattr(p, name))
        words = f"the solution has {name} = {text}, which should be {right:.10g}: {why}"
        return "coefficient", name, words, f"{name} = {text}", {name: float(text)}

    for value, why in ((Om * 2 * pi, "times 2 pi"), (Om / (2 * pi), "divided by 2 pi"),
                       (Om * pi / 180, "Omega t in degrees"), (Om * 180 / pi, "Omega in degrees"),
                       (Om * Om, "its square"), (2 * Om, "twice"), (Om / 2, "half")):  # fmt: skip
        yield coefficient("Omega", value, why)
    for value, why in (
        (m * m, "divided by twice"),
        (1.0, "left out"),
        (m * 1000, "times 1000"),
        (m / 1000, "/1000"),
    ):
        yield coefficient("m", value, why)
    for factor, why in ((0, "missing"), (0.5, "half"), (2, "twice")):
        for name in ("c", "k", "B0", "A0", "FN", "mu1", "mu2", "m"):
            yield coefficient(name, float(getattr(p, name)) * factor, why)
    for gravity, why in ((GRAVITY, "times g"), (1 / GRAVITY, "divided by g")):
        yield coefficient("FN", float(p.FN) * gravity, why)
    for name, other in (("mu1", "mu2"), ("mu2", "mu1")):
        yield coefficient(name, getattr(p, other), f"{other} in its place")
    for names, where in ((("A0", "B0", "FN"), "the forces A0, B0 and FN are"), (("k", "c"), "k and c are")):
        for mass, how in ((m, "not divided by m"), (1.0 / m, "divided by m twice")):
            values = {name: float(getattr(p, name)) * mass for name in names}
            change = ", ".join(f"{name} = {float(value):.17g}" for name, value in values.items())
            yield "coefficient", "m", f"{where} {how}", change, values


def _flights_of_no_system(clues: Clues) -> Iterator[Candidate]:
    """Yield wrong signs with which there is no system: only flights can show them."""
    p, inside, K = clues.parameters, clues.some(clues.inside, 10 * MOST_FLIGHTS), clues.steps.K
    if len(inside) < LEAST_FLIGHTS:
        return
    against = tuple(float((2 * p.A0 - p.A(alpha)) / p.m) for alpha in (1, 2, 3))
    for name, there, what, forces, damping, spring in (
        ("friction", p.FN * (p.mu1 + p.mu2), "it pushes away from the belts", against, 1, 1),
        ("k", p.k, "the spring pushes away", (K.A1, K.A2, K.A3), 1, -1),
        ("c", p.c, "the damper pushes", (K.A1, K.A2, K.A3), -1, 1),
    ):
        if there:
            sizes = _linear_flights(clues, inside, forces, damping * K.cm, spring * K.w0sq)
            right = sizes <= 1.0
            evidence = f"with it {int(np.sum(right))} of {len(inside)} steps inside a domain are right"
            share = 0.5 * (1.0 + SURE) if np.all(right) and clues.flights_wrong > 0.5 else clues.share(sizes, inside)
            yield Candidate(Diagnosis("sign", name, f"{name} has the wrong sign: {what}", evidence, share=share))


def _linear_flights(clues: Clues, chosen: np.ndarray, forces: Sequence[float], cm: float, w0sq: float) -> np.ndarray:
    """Return the defects of flights in any linear system, in units of what is allowed."""
    s, K = clues.steps, clues.steps.K
    tau = s.t[chosen + 1] - s.t[chosen]
    rows = np.zeros((len(chosen), 5, 5))  # of x, v, cos theta, sin theta, 1
    rows[:, 0, 1] = 1.0
    rows[:, 1, 0], rows[:, 1, 1], rows[:, 1, 2] = -w0sq, -cm, K.f0
    rows[:, 1, 4] = np.array(forces)[clues.label[chosen] - 1]
    rows[:, 2, 3], rows[:, 3, 2] = -K.Om, K.Om
    theta = s.theta[chosen]
    begin = np.column_stack([s.x[chosen], s.v[chosen], np.cos(theta), np.sin(theta), np.ones(len(chosen))])
    ends = np.einsum("nij,nj->ni", _exponential(rows * tau[:, None, None]), begin)[:, :2]
    misses = (ends - np.column_stack([s.x, s.v])[chosen + 1]) / clues.allowed[chosen]
    return np.asarray(np.nan_to_num(np.max(np.abs(misses), axis=1), nan=np.inf))


def _exponential(rows: np.ndarray) -> np.ndarray:
    """Return the exponentials of matrices, by their series and repeated squares."""
    squares = max(0, int(np.ceil(np.log2(max(float(np.max(np.sum(np.abs(rows), axis=2))), 1e-300)))) + 1)
    rows = rows / 2.0**squares
    total = term = np.broadcast_to(np.eye(rows.shape[-1]), rows.shape)
    for n in range(1, SERIES_TERMS):
        term = term @ rows / n
        total = total + term
    for _ in range(squares):
        total = total @ total
    return np.asarray(total)


def other_columns(clues: Clues) -> Iterator[Candidate]:
    """Yield the columns of the table that explain the steps, each with the change that tests it."""
    s = clues.steps
    for one in changed_columns(clues.parameters, s.t, s.x, s.v):
        columns = one.change.columns(s.t, s.x, s.v)  # type: ignore[union-attr,misc]
        yield one._replace(diagnosis=replace(one.diagnosis, share=clues.share_of(*columns)))


def changed_columns(p: Parameters, t: np.ndarray, x: np.ndarray, v: np.ndarray) -> Iterator[Candidate]:
    """Yield the columns of the table; those in other units only if x is about the way that v makes."""
    for cause, subject, words, change, value, make in (*_signs_and_places(p), *_units(p)):
        if value is None or 1.0 / SAME_WAY < _way(*make(t, x, v)) < SAME_WAY:
            found = Diagnosis(cause, subject, words, "", value, None if value is None else 0.0)
            yield Candidate(found, Change(change, columns=make))


def _way(t: np.ndarray, x: np.ndarray, v: np.ndarray) -> float:
    """Return the way that x makes over the one that v makes."""
    way = float(np.sum(np.abs(v[1:] + v[:-1]) * np.abs(np.diff(t))) / 2.0)
    return float(np.sum(np.abs(np.diff(x)))) / way if way else np.inf


def _signs_and_places(p: Parameters) -> Iterator[Column]:
    yield "sign", "x", "x has the wrong sign", "with -x", None, lambda t, x, v: (t, -x, v)
    yield "sign", "v", "v has the wrong sign", "with -v", None, lambda t, x, v: (t, x, -v)
    yield "sign", "x and v", "x and v have the wrong sign", "with -x, -v", None, lambda t, x, v: (t, -x, -v)
    yield "columns", "x and v", "the columns x and v are swapped", "swapped", None, lambda t, x, v: (t, v, x)
    for boundary in (1, 2):
        speed = float(p.belt(boundary))
        if speed:
            yield ("columns", "v", f"v is the velocity relative to belt {boundary}", f"with v + v{boundary}", speed,
                   lambda t, x, v, speed=speed: (t, x, v + speed))  # fmt: skip
    yield ("columns", "v", "v is one sample late", "with v of the next sample", None,
           lambda t, x, v: (t[:-1], x[:-1], v[1:]))  # fmt: skip
    yield ("columns", "v", "v is one sample early", "with v of the sample before", None,
           lambda t, x, v: (t[1:], x[1:], v[:-1]))  # fmt: skip


def _units(p: Parameters) -> Iterator[Column]:
    m, Om = float(p.m), float(p.Omega)
    divided: dict[str, Any] = {
        "x": lambda t, x, v, f: (t, x / f, v),
        "v": lambda t, x, v, f: (t, x, v / f),
        "x and v": lambda t, x, v, f: (t, x / f, v / f),
        "t": lambda t, x, v, f: (t / f, x, v),
    }
    rows = [
        (name, factor, f"{name} {'are' if ' ' in name else 'is'} {size}: other units")
        for factor, size in zip(
            (1000.0, 100.0, 0.01, 0.001),
            ("1000 times too large", "100 times too large", "100 times too small", "1000 times too small"),
            strict=True,
        )
        for name in ("x", "v", "x and v", "t")
    ]
    rows += [
        ("v", m, "v is the momentum, m times the velocity"), ("v", 1.0 / Om, "v is dx/d(Omega t)"),
        ("t", Om, "t is the phase Omega t of the drive"), ("t", Om / (2 * pi), "t is in periods of the drive"),
        ("t", Om * 180 / pi, "t is the phase of the drive in degrees"), ("t", 1 / 60, "t is in minutes"),
    ]  # fmt: skip
    for name, factor, words in rows:
        if factor != 1.0:
            yield ("columns", name, words, f"with {name} divided by {factor:.17g}", factor,
                   partial(divided[name], f=factor))  # fmt: skip
