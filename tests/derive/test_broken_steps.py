"""Checked steps, broken, are refused; so is every number of a sentence with a raised letter."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from random import Random
from types import ModuleType
from typing import Any

import pytest
import sympy as sp
from chapters import unchecked_items
from step_mutants import broken_once, mutations

from symosc.derive import document
from symosc.derive.chapters import (
    CHAPTERS,
    borders,
    chaos,
    domains,
    equilibria,
    events,
    friction_curves,
    maps,
    return_maps,
    static_friction,
    stick_slip,
    switching,
)
from symosc.derive.scope import Scope
from symosc.derive.steps import Step, StepError, equation, exact, facts, flat, steps_of
from symosc.symbolic import solution
from symosc.symbolic.solution import A_m, cm, f0, v_i, w0sq, x_i

#: The checks of the other chapters take a second each and more.
QUICK = ("switching",)
KEYS = [pytest.param(key, marks=[] if key in QUICK else pytest.mark.slow) for key in CHAPTERS]


def all_steps(key: str) -> list[Step]:
    return [step for item in unchecked_items(key)[1] for step in steps_of(item)]


# --- steps ---


@pytest.mark.parametrize("key", KEYS)
def test_a_step_broken_once_is_refused(key: str) -> None:
    """A sign, a factor or an exponent of half of the printed formulas, all chosen at random."""
    dice = Random(f"{key}, 43")
    steps = all_steps(key)
    for step in dice.sample(steps, (len(steps) + 1) // 2):
        wrong = broken_once(step, dice)
        with pytest.raises(StepError):
            wrong.verify()


@pytest.mark.campaign
@pytest.mark.parametrize("part", range(6))
@pytest.mark.parametrize("key", CHAPTERS)
def test_each_step_broken_in_every_way_is_refused(key: str, part: int) -> None:
    """Every sixth step: each sign, factor and exponent in it; few steps, such as E_0 = 1, have none."""
    without_change = 0
    steps = all_steps(key)[part::6]
    for step in steps:
        changed = list(mutations(step))
        without_change += not changed
        for wrong in changed:
            with pytest.raises(StepError):
                wrong.verify()
    assert without_change <= 0.5 * len(steps) + 1


# --- the source of a step: a check that is made of the same parts as the formula cannot fail ---


def from_source(module: ModuleType, old: str, new: str) -> ModuleType:
    """Return a chapter with another text at one place of its source."""
    source = Path(str(module.__file__)).read_text(encoding="utf-8")
    assert source.count(old) == 1, old
    changed = ModuleType(module.__name__)
    exec(compile(source.replace(old, new), "changed", "exec"), changed.__dict__)
    return changed


def steps_with(module: ModuleType, label: str) -> list[Step]:
    """Return the steps of a chapter with a label, not checked yet."""
    items = flat(module.items(Scope()))
    return [step for item in items for step in steps_of(item) if step.label == label]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "old", "new", "label"),
    [
        pytest.param(*row, id=row[-1])
        for row in (
            (switching, "sp.factorial(n)", "sp.factorial(n + 1)", "taylor"),
            (borders, "jump = -2 *", "jump = -3 *", "other"),
            (events, "sp.factorial(n)", "sp.factorial(n + 1)", "p"),
            (events, "LETTER_A * Omega**3", "LETTER_A * Omega**2", "pushed"),
            (static_friction, "SIDE * EXCESS * late,", "-SIDE * EXCESS * late,", "saltation"),
            (static_friction, "least = EXCESS * tau -", "least = EXCESS * tau +", "least"),
            (static_friction, "second = -B0 * Omega**2", "second = -B0 * Omega", "length"),
            (friction_curves, "slope * sp.Abs(relative)", "2 * slope * sp.Abs(relative)", "piece"),
            (friction_curves, "Omega**counter * sp.cos", "Omega**counter * sp.sin", "recursion"),
            (
                friction_curves,
                "change, -4 * RATE * speed**2, exact",
                "change, -2 * RATE * speed**2, exact",
                "energy",
            ),
            (friction_curves, "BEYOND = sp.Rational(5, 8)", "BEYOND = sp.Rational(9, 8)", "reach"),
            (
                friction_curves,
                'named(r"|c_{*}|"): size,',
                'named(r"|c_{*}|"): size / 2,',
                "separation",
            ),
            (friction_curves, "inner = 4 * (_COUNT - 1)", "inner = 3 * (_COUNT - 1)", "labels"),
            (equilibria, "third * size**4 / 16", "third * size**4 / 8", "power"),
            (equilibria, "8 * WIDTH * (SPEED - onset)", "4 * WIDTH * (SPEED - onset)", "beside"),
            (stick_slip, "-(SPRING * SPEED * E2", "-(2 * SPRING * SPEED * E2", "gap"),
            (stick_slip, "E1 / E2**2 + (2 * ratio", "E1 / E2**2 + (ratio", "bend"),
            (return_maps, "shove = SIDE * EXCESS", "shove = -SIDE * EXCESS", "kick"),
            (return_maps, "square = 2 * k", "square = k", "root"),
            (chaos, "many = 1 + count * length", "many = 1 + count * length / 8", "count"),
            (chaos, '"L", "2.125"', '"L", "2.120"', "map-L"),
        )
    ],
)
def test_a_formula_broken_at_its_source_is_refused(
    module: ModuleType, old: str, new: str, label: str
) -> None:
    changed = from_source(module, old, new)
    changed.__dict__["_examples_table"] = tuple  # its branches would take long
    (step,) = steps_with(changed, label)
    with pytest.raises(StepError):
        step.verify()


def wrong_acceleration(x: Any = x_i, v: Any = v_i, theta: Any = solution.theta) -> Any:
    """Return the acceleration with the damper's sign turned."""
    return A_m + f0 * sp.cos(theta) + cm * v - w0sq * x


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "label"), [(domains, "start"), (maps, "start"), (maps, "stick-f2")]
)
def test_an_acceleration_broken_at_its_source_is_refused(
    monkeypatch: pytest.MonkeyPatch, module: ModuleType, label: str
) -> None:
    monkeypatch.setattr(solution, "acceleration", wrong_acceleration)
    steps = [step for step in flat(_flights(module)()) if isinstance(step, Step)]
    (step,) = [step for step in steps if step.label == label]
    with pytest.raises(StepError):
        step.verify()


def _flights(module: ModuleType) -> Callable[[], Any]:
    return domains.flow if module is domains else lambda: module.items(Scope())


# --- numbers in sentences with a raised letter ---


def sentences(key: str) -> list[Any]:
    return [item for item in unchecked_items(key)[1] if steps_of(item)]


@pytest.mark.parametrize("key", KEYS)
def test_each_number_of_a_checked_sentence_is_tied_to_a_step(key: str) -> None:
    for item in sentences(key):
        text = document.sentence_of(item)
        tied = getattr(item, "facts", ())
        assert document.untied(text, tied) == []
        for match in document.numbers_in(text):
            changed = f"{text[: match.start()]}97{text[match.end() :]}"
            assert document.untied(changed, tied) == ["97"], changed


def test_a_number_without_a_step_stops_the_chapter() -> None:
    """Corollary 3.4 with -7 pi in its text."""
    turn = sp.Symbol("turn")
    statement = equation(turn, -2 * sp.pi, exact({turn: -2 * sp.pi}))
    right = flat([r"It changes by $-2\pi$ on $E_3$ (\eqref{eq:sticks-7}).", facts(statement)])
    wrong = flat([r"It changes by $-7\pi$.", facts(statement)])
    assert document.check("sticks", "Sticks", right).steps()
    with pytest.raises(StepError, match="no step has the number 7"):
        document.check("sticks", "Sticks", wrong)
