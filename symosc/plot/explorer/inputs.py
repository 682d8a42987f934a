"""The state of the page: a text for each number, and how it becomes a link, a scene, and what is wrong with it.

A text is read exactly, as in scene files: 0.8 and 4/5 are the same number.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from math import tau
from typing import Any
from urllib.parse import parse_qsl, urlencode

from symosc.errors import ParameterError
from symosc.exact import NO_EXPRESSION, NUMBER_FORMS, read_exact, read_start_error, show
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import Scene, load_scene, scene_names
from symosc.scenes.quantities import QUANTITIES, unit_of

#: More periods than this crowd the pictures.
MOST_SHOWN_PERIODS = 100
#: To so many digits the number of periods is shown; the end of the motion is the shortest decimal that gives them.
PERIODS_DIGITS = 12
STARTS = ("t0", "x0", "v0")
#: How the page says what is wrong with a text that is no number.
IN_SHORT = {
    NUMBER_FORMS: "is not a number; 0.8, 4/5 and 8e-1 are",
    NO_EXPRESSION: "is an expression; write its value, such as 3.14159 for pi",
}
CHANGED, SOURCE = ", changed", "symosc explore"


@dataclass(frozen=True)
class Field:
    """A number of the page: how it is called, and what its slider covers until a number beyond that is typed.

    Attributes
    ----------
    name, symbol, meaning, unit : str
    low, high, step : float
    """

    name: str
    symbol: str
    meaning: str
    unit: str
    low: float
    high: float
    step: float


def _field(name: str, symbol: str, low: float, high: float, step: float) -> Field:
    unit = unit_of(name)
    return Field(name, symbol, QUANTITIES[name][0], "" if unit == "1" else unit, low, high, step)


#: The numbers of the page in the groups that it shows them in.
GROUPS: dict[str, tuple[Field, ...]] = {
    "Mass": (
        _field("m", "m", 0.1, 5, 0.01),
        _field("c", "c", 0, 5, 0.01),
        _field("k", "k", 0, 20, 0.05),
    ),
    "Excitation A₀ + B₀ cos Ωt": (
        _field("A0", "A₀", -30, 30, 0.1),
        _field("B0", "B₀", -30, 30, 0.1),
        _field("Omega", "Ω", 0.05, 8, 0.01),
    ),
    "Belts": (
        _field("v1", "v₁", -15, 15, 0.05),
        _field("v2", "v₂", -15, 30, 0.05),
        _field("mu1", "μ₁", 0, 1.5, 0.01),
        _field("mu2", "μ₂", 0, 1.5, 0.01),
        _field("FN", "F_N", 0, 30, 0.1),
    ),
    "Start, and how much is shown": (
        _field("t0", "t₀", 0, 10, 0.01),
        _field("x0", "x₀", -10, 10, 0.01),
        _field("v0", "v₀", -15, 15, 0.01),
        Field("periods", "N", "forcing periods shown", "2π/Ω", 0.1, 20, 0.1),
    ),
}
FIELDS = {field.name: field for fields in GROUPS.values() for field in fields}
#: What else is in a link: the name of the scene, and to how much its start is known.
OTHER_KEYS = ("scene", "start_error")


@cache
def shipped_scenes() -> dict[str, Scene]:
    """Return the shipped scenes by name; they are read once."""
    return {name: load_scene(name) for name in scene_names()}


def _sound() -> Scene:
    """Return a scene whose numbers stand in for wrong ones, until all that is wrong is found."""
    return shipped_scenes()["fig5"]


def state_of(scene: Scene) -> dict[str, str]:
    """Return the page's texts for a scene."""
    state = {"scene": scene.name, **scene.parameters.as_dict()}
    state |= {name: show(getattr(scene, name)) for name in STARTS}
    state["periods"] = _periods_text(scene.t0, scene.t_end, scene.parameters.Omega)
    if scene.start_error is not None:
        state["start_error"] = ",".join(map(show, scene.start_error))
    return state


def read_link(query: str, default: Scene) -> tuple[dict[str, str], list[str]]:
    """Return the texts of a link, and what is wrong with the link.

    Numbers that it lacks are those of the shipped scene that it names, else of `default`.
    """
    given, notes = {}, []
    for name, text in parse_qsl(query, keep_blank_values=True):
        if name in FIELDS or name in OTHER_KEYS:
            given[name] = text
        else:
            notes.append(f"the link has an unknown name {name!r}, which is left out")
    rest = state_of(shipped_scenes().get(given.get("scene", ""), default))
    if not set(STARTS).isdisjoint(given):
        rest.pop("start_error", None)  # it is not that of another start
    return rest | given, notes


def link_of(state: dict[str, str]) -> str:
    """Return the texts as the query of a link."""
    return urlencode(state)


def scene_of(state: dict[str, str]) -> tuple[Scene | None, dict[str, str]]:
    """Return the scene of these texts, and for each text that is wrong what is allowed; then there is no scene."""
    numbers, errors = _read_numbers(state)
    parameters = _parameters(numbers, errors)
    if errors:
        return None, errors
    t_end = _end(numbers["t0"], numbers["periods"], parameters.Omega)
    start: dict[str, Any] = {name: numbers[name] for name in STARTS}
    name = state.get("scene", "").strip() or "explored"
    try:
        start_error = state.get("start_error") or None
        known = read_start_error(start_error.split(",")) if start_error else None
        return _named(Scene(name, parameters, **start, t_end=t_end, start_error=known)), {}
    except ParameterError as error:
        return None, {error.name: error.allowed}


def _read_numbers(state: dict[str, str]) -> tuple[dict[str, Fraction], dict[str, str]]:
    """Return the numbers, and what is wrong with texts that are none; a sound number stands in for each of these."""
    numbers, errors = {}, {}
    stand_in = state_of(_sound())
    for name in FIELDS:
        try:
            numbers[name] = read_exact(name, state[name])
        except ParameterError as error:
            errors[name] = IN_SHORT.get(error.allowed, error.allowed)
            numbers[name] = read_exact(name, stand_in[name])
    if not 0 < numbers["periods"] <= MOST_SHOWN_PERIODS:
        errors["periods"] = f"must be more than 0 and at most {MOST_SHOWN_PERIODS}"
    return numbers, errors


def _parameters(numbers: dict[str, Fraction], errors: dict[str, str]) -> Parameters:
    """Return the parameters; adds what is out of range to `errors`, all of it at once."""
    sound = _sound().parameters
    tried = {name: numbers[name] for name in PARAMETER_NAMES}
    while True:
        try:
            return Parameters(**tried)
        except ParameterError as error:
            errors.setdefault(error.name, error.allowed)
            tried[error.name] = getattr(sound, error.name)
            if error.name == "v1":  # both belts are needed for v1 < v2
                tried["v2"] = sound.v2


def _named(scene: Scene) -> Scene:
    """Return a scene with the source of the shipped one of its name, or with a name that says it is another."""
    base = scene.name.removesuffix(CHANGED)
    shipped = shipped_scenes().get(base)
    if shipped is None:
        return replace(scene, source=SOURCE)
    if state_of(shipped) == state_of(replace(scene, name=base)):
        return shipped
    return replace(scene, name=base + CHANGED, source=SOURCE)


def _periods_text(t0: Fraction, t_end: Fraction, Omega: Fraction) -> str:
    return f"{float((t_end - t0) * Omega) / tau:.{PERIODS_DIGITS}g}"


def _end(t0: Fraction, periods: Fraction, Omega: Fraction) -> Fraction:
    """Return the shortest decimal that is so many periods after t0, as far as their digits are shown."""
    wanted = f"{float(periods):.{PERIODS_DIGITS}g}"
    exact = t0 + Fraction(wanted) * Fraction(tau) / Omega
    for decimals in range(PERIODS_DIGITS + 4 + len(str(int(Omega)))):
        end = round(exact, decimals)
        if end > t0 and _periods_text(t0, end, Omega) == wanted:
            return end
    return exact
