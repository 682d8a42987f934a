"""What the paper does not say.

Statements in place of its own, with the verdict that a check comes to for each.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Any
from unittest.mock import patch

from symosc import Parameters, load_scene
from symosc.kernels.theorem7_cases import PLACES
from symosc.paper.checks import model, motions, orbits, theorem_7, theorems
from symosc.paper.checks.theorems import CONDITIONS
from symosc.paper.claims import CONFIRMED, CORRECTED, NOT_AS_PRINTED, UNDECIDED, Evidence


def _added(p: Parameters, alpha: int) -> Fraction:
    return {1: p.mu1 + p.mu2, 2: p.mu1 - p.mu2, 3: -(p.mu1 + p.mu2)}[alpha] * p.FN


def _half_interval(
    p: Parameters, boundary: int, true: Any = model.friction_interval
) -> tuple[Fraction, Fraction]:
    low, high = true(p, boundary)
    return low, (low + high) / 2


def _repeated_field(
    p: Parameters, alpha: int, *state: Any, true: Any = model.vector_field
) -> Fraction:
    return true(p, min(alpha, 2), *state)


def _both_exits(
    p: Parameters, boundary: int, x: Any, cosine: Any, true: Any = model.stick_exit
) -> Any:
    upper = true(p, boundary, x, cosine)
    return min(upper, upper + 2 * (p.mu1 if boundary == 1 else p.mu2) * p.FN, key=abs)


def _off(*_: Any) -> tuple[float, float]:
    return 1e-6, 0.0


def _zero(*_: Any) -> Fraction:
    return Fraction(0)


def _wrong_second(n: Any, y: Any, t: Any, true: Any = theorems.g_functions) -> Any:
    first, second = true(n, y, t)
    return first, second + t


def _windows(
    change: Callable[..., Any], true: Any = theorem_7.printed_window
) -> Callable[..., Any]:
    return lambda *given: change(true(*given), *given)


def _wrong_end(cases: Any, mapping: str, gamma: Any, amplitude: Any) -> Any:
    if not 0 < gamma < amplitude:
        return cases
    return [
        (number, [arcs[0]._replace(high=arcs[0].high + 1), *arcs[1:]]) for number, arcs in cases
    ]


def _without_third(cases: Any, *_: Any) -> Any:
    return [case for case in cases if case[0] != 3]


def _twice(cases: Any, *_: Any) -> Any:
    return cases * 2


def _whole(cases: Any, mapping: str, gamma: Any, amplitude: Any) -> Any:
    side = PLACES[mapping].side
    circle = [theorem_7.Arc(Fraction(0), Fraction(4), True)]
    if abs(gamma) != amplitude:
        return cases
    return [(2 if side > 0 else 5, circle if gamma * side > 0 else [])]


WITHOUT_P8 = {label: planes for label, planes in model.PLANES.items() if label != "P8"}
# What the paper says, what it says instead, the check, and its verdict then.
STATEMENTS: list[tuple[Any, str, Any, Callable[[], Evidence], str]] = [
    (
        model,
        "friction_force",
        lambda p, alpha: -_added(p, alpha),
        model.friction_between_the_jumps,
        NOT_AS_PRINTED,
    ),
    (model, "friction_interval", _half_interval, model.friction_at_the_jumps, NOT_AS_PRINTED),
    (model, "friction_interval", _half_interval, model.friction_characteristics, NOT_AS_PRINTED),
    (model, "added_force", _added, model.equations_of_motion, NOT_AS_PRINTED),
    (model, "vector_field", _repeated_field, model.vector_fields, NOT_AS_PRINTED),
    (model, "vector_field", _zero, model.forces_or_accelerations, NOT_AS_PRINTED),
    (
        model,
        "stick_force",
        lambda p, b, x, c: p.A0 - p.k * x,
        model.stick_if_friction_holds,
        NOT_AS_PRINTED,
    ),
    (
        model,
        "domain_of",
        lambda p, v: [1] if v <= p.v1 else [],
        model.domains_and_boundaries,
        NOT_AS_PRINTED,
    ),
    (model, "stick_exit", _both_exits, partial(model.stick_exits, 1), CONFIRMED),
    (model, "PLANES", WITHOUT_P8, model.basic_mappings, NOT_AS_PRINTED),
    (model, "PLANES", WITHOUT_P8, model.trajectories_in_domains, NOT_AS_PRINTED),
    (model, "residual", _off, model.governing_equations, NOT_AS_PRINTED),
    (model, "position_bound", lambda p: 1.0, model.bounded_motions, NOT_AS_PRINTED),
    (model, "printed_planes", lambda v, d: (v - 1, v + 1), model.planes_as_limits, NOT_AS_PRINTED),
    (
        CONDITIONS,
        "sticks, (26), (27)",
        lambda below, above: above < 0,
        partial(theorems.theorem, 4, 1),
        NOT_AS_PRINTED,
    ),
    (
        CONDITIONS,
        "passes, (34), (35)",
        lambda below, above: below > 0,
        partial(theorems.theorem, 5, 1),
        NOT_AS_PRINTED,
    ),
    (
        CONDITIONS,
        "passes, (34), (35)",
        lambda below, above: above < 0,
        theorems.no_repelling_boundary,
        NOT_AS_PRINTED,
    ),
    (
        theorems,
        "grazing_condition",
        lambda b, F, G: F == 0 and G < 0,
        partial(theorems.theorem, 6, 1),
        NOT_AS_PRINTED,
    ),
    (
        theorems,
        "grazing_condition",
        lambda b, F, G: F == 0,
        partial(theorems.theorem, 6, 2),
        NOT_AS_PRINTED,
    ),
    (theorems, "slope_of_field", _zero, theorems.theorem_6_both_sides, NOT_AS_PRINTED),
    (theorems, "slope_of_field", _zero, theorems.g_functions_are_derivatives, NOT_AS_PRINTED),
    (theorems, "BEFORE", "tₘ₋", theorems.time_before_and_after, CONFIRMED),
    (
        CONDITIONS,
        "slides, (20)",
        lambda below, above: above < 0,
        partial(theorems.lemma, 1),
        NOT_AS_PRINTED,
    ),
    (
        CONDITIONS,
        "slides, (20)",
        lambda below, above: above < 0,
        theorems.necessary_and_sufficient,
        NOT_AS_PRINTED,
    ),
    (
        CONDITIONS,
        "passes, (21), (22)",
        lambda below, above: below > 0,
        partial(theorems.lemma, 2),
        NOT_AS_PRINTED,
    ),
    (
        theorems,
        "grazing_condition",
        lambda below, F, G: F == 0,
        partial(theorems.lemma, 3),
        NOT_AS_PRINTED,
    ),
    (
        theorems,
        "g_functions",
        lambda n, y, t: (y[0], y[0]),
        theorems.general_g_functions,
        NOT_AS_PRINTED,
    ),
    (
        theorems,
        "g_functions",
        lambda n, y, t: ((n.T * y)[0],) * 2,
        theorems.reduced_g_functions,
        NOT_AS_PRINTED,
    ),
    (theorems, "g_functions", _wrong_second, theorems.reduced_g_functions, NOT_AS_PRINTED),
    (
        theorems,
        "slope_along_boundary",
        theorems.slope_of_field,
        theorems.derivative_along_the_flow,
        CONFIRMED,
    ),
    (theorems, "slope_along_boundary", _zero, theorems.derivative_along_the_flow, NOT_AS_PRINTED),
    (
        theorem_7,
        "gamma_of",
        lambda p, a, v: p.c / p.m * v,
        theorem_7.grazing_inequality,
        NOT_AS_PRINTED,
    ),
    (
        theorem_7,
        "gamma_of",
        lambda p, a, v: p.k / p.m * v + 1,
        theorem_7.gamma_is_fixed,
        NOT_AS_PRINTED,
    ),
    (theorem_7, "printed_window", lambda *_: [], theorem_7.without_force, CONFIRMED),
    (
        model,
        "residual",
        lambda p, label, *_: (1e-6 * (label == "P5"), 0.0),
        model.governing_equations,
        NOT_AS_PRINTED,
    ),
    (orbits, "residual", _off, partial(orbits.in_order, load_scene("fig9")), NOT_AS_PRINTED),
    (orbits, "residual", _off, partial(orbits.closing_conditions, load_scene("fig9")), CORRECTED),
    (
        motions,
        "residual",
        _off,
        partial(motions.flight_after, load_scene("fig6"), 2, 2),
        NOT_AS_PRINTED,
    ),
    (theorem_7, "TRACED", {"fig5": ("P2",)}, theorem_7.mappings_that_graze, UNDECIDED),
    (
        theorem_7,
        "ENDS",
        dict.fromkeys(PLACES, ("P2",)),
        theorem_7.mappings_that_graze,
        NOT_AS_PRINTED,
    ),
    (
        theorem_7,
        "printed_window",
        _windows(_wrong_end),
        partial(theorem_7.window, "P6"),
        NOT_AS_PRINTED,
    ),
    (
        theorem_7,
        "printed_window",
        _windows(_without_third),
        partial(theorem_7.window, "P5"),
        NOT_AS_PRINTED,
    ),
    (
        theorem_7,
        "printed_window",
        _windows(_without_third),
        partial(theorem_7.complete, "P3", "P6"),
        CORRECTED,
    ),
    (theorem_7, "printed_window", _windows(_whole), theorem_7.equality, CONFIRMED),
    (
        theorem_7,
        "printed_window",
        _windows(_whole),
        partial(theorem_7.complete, "P2", "P5"),
        CONFIRMED,
    ),
    (
        theorem_7,
        "printed_window",
        _windows(_twice),
        partial(theorem_7.complete, "P3", "P6"),
        NOT_AS_PRINTED,
    ),
]


def _forget() -> None:
    """Forget what claims share of the printed statements."""
    theorem_7.rows_of.cache_clear()
    theorems.lemma.cache_clear()


def evidence(number: int) -> Evidence:
    """Return the evidence if the paper says something else."""
    module, name, instead, check, verdict = STATEMENTS[number]
    _forget()
    try:
        if isinstance(module, dict):
            patched = patch.dict(module, {name: instead})
        else:
            patched = patch.object(module, name, instead)
        with patched:
            found = check()
    finally:
        _forget()
    assert found.verdict == verdict
    return found
