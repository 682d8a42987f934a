"""Named scenes: parameters, a start and a source.

The shipped ones are the TOML files in this folder.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cache
from math import inf, pi
from os.path import isfile
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from symosc.base.aliases import NumberLike, SceneName
from symosc.base.arguments import (
    FLAG,
    NUMBER,
    SCENE_NAME,
    SCENE_OR_NAME,
    mapping_of,
    public,
    require,
)
from symosc.base.display.drawable import Drawable
from symosc.base.errors import ParameterError, SceneError, meant
from symosc.base.exact import read_start_error, show
from symosc.base.quantities import (
    forcing_periods,
    half_unit,
    quantity_of,
    read_number,
    unit_of,
)
from symosc.friction import MAPS
from symosc.model import OSCILLATOR_NAMES, PARAMETER_NAMES, Belt, Model, Oscillator, Parameters
from symosc.reductions import OtherModel, reduced_model, reduced_start, reduced_time
from symosc.scenes.files import MOST_CHARACTERS, SceneFile, read_scene_file
from symosc.words import WordError, of_belts, read_word

#: Parameters or an Oscillator; or a Scene, the name or file of one, or an OtherModel, of which a
#: public function takes the parameters.
ParametersLike: TypeAlias = "Model | Scene | OtherModel | SceneName"
#: Half-widths of t0, x0 and v0.
StartErrors: TypeAlias = tuple[Fraction, Fraction, Fraction]

SCENES_FOLDER = Path(__file__).parent
TEMPLATES_FOLDER = SCENES_FOLDER / "templates"
#: The numbers of a start, with the end and without.
START_NAMES = ("t0", "x0", "v0", "t_end")
STARTS = START_NAMES[:3]


class Original(NamedTuple):
    """The problem as it was given for a scene of an `OtherModel`, in the coordinates of that model.

    In the example the base moves by Y cos(Omega t), and the belts are joined to it.

    Attributes
    ----------
    model : OtherModel
    t0, x0, v0, t_end : Fraction
    start_error : three Fractions or None
        By how much t0, x0 and v0 may be off, up or down; None if they are exact.

    Examples
    --------
    >>> from symosc import OtherModel, Scene
    >>> scene = Scene("mine", OtherModel(m=1, k=1, Omega=2, FN=1, Y=3, joined=True), t0=0, x0=4, v0=0, t_end=9)
    >>> scene.x0, scene.original.x0
    (Fraction(1, 1), Fraction(4, 1))
    """

    model: OtherModel
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    start_error: StartErrors | None = None


@dataclass(frozen=True)
class Scene(Drawable):
    """A named initial value problem.

    Parameters
    ----------
    name : str
        What messages and figures call it.
    parameters : Parameters, Oscillator or OtherModel
        With an OtherModel, give start and end in its coordinates. The scene converts all to
        symosc's oscillator, and keeps as `original` what was given; `simulate` gives the motion of
        the model.
    t0, x0, v0 : number
        Start time, position and velocity, read exactly like parameters.
    t_end : number or text
        Where a simulation of the scene ends; later than t0. "10T" is ten periods of the drive after
        t0.
    structure : str, optional
        Mapping structure of the periodic orbit that the scene is about, such as "P32". The scene
        keeps the rotation of `Word.cycle`, as all answers do, with one belt in the labels S1, B1
        and A1.
    source : str
        Where the numbers come from.
    start_error : number or three numbers, optional
        By how much t0, x0 and v0 may be off, up or down; kept as three Fractions. None: the start
        is exact.
    notes : tuple of str
        What is to be said about its numbers, such as that one is known to 40 digits; not compared.
    original : Original or None
        The model and the start that were given, if they are of another model. A copy with other
        numbers, such as ``dataclasses.replace`` makes, has none; `started` and `changed` keep to
        the model.
    in_si : bool
        Whether the numbers are in kg, m, s, N and rad, so that figures name the units. It is True
        for a file in which a number has a unit; not compared.

    Raises
    ------
    ParameterError
        If a number is not finite, t_end <= t0, or another argument is not of its type.
    WordError
        If the structure is not one.

    Examples
    --------
    >>> from symosc import Scene, load_scene, simulate
    >>> scene = Scene("mine", load_scene("fig5").parameters, t0=0, x0="1/3", v0=-2, t_end=6)
    >>> simulate(scene).word
    ['P1', 'P2', 'P1']
    """

    _drawn_by = "figure"
    _made_by = "load_scene(...)"

    name: str
    parameters: Parameters  # or an Oscillator, which most scenes are not
    t0: Fraction
    x0: Fraction
    v0: Fraction
    t_end: Fraction
    structure: str | None = None
    source: str = ""
    start_error: tuple[Fraction, Fraction, Fraction] | None = None
    notes: tuple[str, ...] = field(default=(), compare=False, repr=False)
    original: Original | None = None
    in_si: bool = field(default=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        self._check_kinds()
        if self.structure is not None:
            belts = len(model_of(self.parameters).law.belts)
            whole = of_belts(read_word(self.structure), belts).cycle
            object.__setattr__(self, "structure", str(whole))
        model: Any = self.parameters
        # The end may be in periods of the drive after t0.
        given_start = {name: getattr(self, name) for name in START_NAMES}
        given_start["t_end"] = end_time(self.t_end, model_of(model, "parameters"), self.t0)
        numbers, rounding = start_numbers(given_start, model_of(model, "parameters"))
        if self.start_error is None:
            error = rounding
        else:
            error = read_start_error(self.start_error)
        if numbers["t_end"] <= numbers["t0"]:
            raise ParameterError(
                "t_end", show(numbers["t_end"]), f"must be later than t0 = {show(numbers['t0'])}"
            )
        if isinstance(model, OtherModel):
            original = Original(model, **numbers, start_error=error)
            object.__setattr__(self, "original", original)
            object.__setattr__(self, "parameters", reduced_model(model))
            numbers, error = _reduced_problem(original)
        # A copy with other numbers, as `dataclasses.replace` makes, is no longer that of the model.
        elif self.original and not (
            model in (self.original.model.parameters, self.original.model.oscillator)
            and numbers == _reduced_problem(self.original)[0]
        ):
            object.__setattr__(self, "original", None)
        object.__setattr__(self, "start_error", error)
        for name, number in numbers.items():
            object.__setattr__(self, name, number)

    def _check_kinds(self) -> None:
        """Raise ParameterError if an argument is not of its type."""
        for name in ("name", "source", "structure"):
            value = getattr(self, name)
            if not isinstance(value, str) and not (name == "structure" and value is None):
                raise ParameterError(name, value, "must be text")
        if not self.name.strip():
            raise ParameterError("name", self.name, "must be text that is not empty")
        if not isinstance(self.parameters, Parameters | Oscillator | OtherModel):
            raise ParameterError(
                "parameters",
                self.parameters,
                "must be Parameters, an Oscillator or an OtherModel",
            )
        require(FLAG, in_si=self.in_si)
        if not isinstance(self.original, Original | None):
            raise ParameterError(
                "original", self.original, "must be None, or what a scene of an OtherModel keeps"
            )
        are_texts = isinstance(self.notes, tuple) and all(
            isinstance(note, str) for note in self.notes
        )
        if not are_texts:
            raise ParameterError("notes", self.notes, "must be a tuple of texts")

    @public
    def started(self, given: Mapping[str, NumberLike]) -> Scene:
        """Return a copy with another t0, x0, v0 or t_end.

        Numbers that are not given keep the scene's `start_error`.

        The end may be text such as "10T": so many periods of the drive after t0. For a scene of
        another model, give the numbers in the coordinates of that model.
        """
        require(mapping_of(NUMBER), given=given)
        for name in given:
            if name not in START_NAMES:
                raise ParameterError(
                    name,
                    given[name],
                    f"unknown number of a start; choose from {', '.join(START_NAMES)}",
                )
        if not given:
            return self
        if self.original is None:
            own: Scene | Original = self
        else:
            own = self.original
        if "t_end" in given:
            given = dict(given) | {
                "t_end": end_time(given["t_end"], self.parameters, given.get("t0", own.t0))
            }
        numbers, rounding = start_numbers(given, self.parameters)
        start = dict[str, Any](numbers)
        errors = own.start_error
        exact = (Fraction(0),) * 3
        if errors is not None or rounding is not None:
            # A new number has the error of its rounding, another one keeps what it had.
            known = zip(STARTS, errors or exact, rounding or exact, strict=True)
            errors = tuple(new if name in given else old for name, old, new in known)  # type: ignore[assignment]
        start["start_error"] = errors
        if self.original is None:
            return replace(self, **start)
        return moved_scene(self, self.original, **start)

    @public
    def changed(self, **changes: NumberLike | bool) -> Scene:
        """Return a copy with other parameters: ``scene.changed(Omega=2)``."""
        require(NUMBER, FLAG, **changes)
        if self.original is not None:
            return moved_scene(
                self, self.original, parameters=self.original.model.replace(**changes)
            )
        return replace(self, parameters=self.parameters.replace(**changes))

    def reduced(self) -> Scene:
        """Return the scene in the coordinates of symosc's oscillator, without an OtherModel as its
        `original`.
        """
        return replace(self, original=None)


# The __init__ that the dataclass makes.
Scene.__init__ = public(Scene.__init__)  # type: ignore[method-assign]


def moved_scene(scene: Scene, original: Original, **changes: Any) -> Scene:
    """Return a copy of another model's scene with some values changed, given in that model's
    coordinates.
    """
    start = original._asdict()
    return replace(scene, **{"parameters": start.pop("model")} | start | changes)


def _reduced_problem(original: Original) -> tuple[dict[str, Fraction], StartErrors | None]:
    """Return start and end of another model in symosc's coordinates, by name, and the `start_error`
    there.
    """
    model, t0, x0, v0, t_end, error = original
    start, known = reduced_start(model, t0, x0, v0)
    if error is not None:
        # An error of t0 is also one of the belts' position and velocity, which are subtracted.
        t_error = error[0]
        rate = model.shift.rate(model.Omega)
        speed = rate.bound() + abs(model.pull)
        moved = Fraction(0), speed * t_error, rate.rate(model.Omega).bound() * t_error
        known = tuple(map(sum, zip(known, error, moved, strict=True)))  # type: ignore[assignment]
    numbers = dict(zip(START_NAMES, (*start, reduced_time(model, t_end)), strict=True))
    return numbers, known if any(known) else error


def not_reduced_error(scene: Scene) -> ParameterError:
    """Return the error that `scene` is of another model, for a function that cannot give results in
    its coordinates.
    """
    allowed = (
        "must not be a scene of another model, as the results are not converted back to its "
        "coordinates; pass scene.reduced()"
    )
    return ParameterError("scene", scene.name, allowed)


def start_numbers(
    start: Mapping[str, Any], p: Model
) -> tuple[dict[str, Fraction], StartErrors | None]:
    """Read the numbers of a start.

    Return them by name, and how far t0, x0, v0 may be off (None if all are exact).
    """
    # An expression with pi is known to 40 digits. On a belt the mass has its speed, however many
    # digits that has.
    numbers = dict[str, Fraction]()
    errors = dict.fromkeys(START_NAMES, Fraction(0))
    for name, value in start.items():
        numbers[name], exact = read_number(name, value)
        on_belt = name == "v0" and p.law.boundary_of(numbers[name])
        if not (exact or on_belt):
            errors[name] = half_unit(numbers[name])
    t0, x0, v0, _ = errors.values()
    return numbers, ((t0, x0, v0) if t0 or x0 or v0 else None)


def parameters_of(what: ParametersLike, name: str = "p") -> Parameters:
    """Return the parameters of a model, or of a scene or its name or file.

    Return `Parameters` unchanged, and refuse what follows another friction law than these. Messages
    call the argument `name`.
    """
    if isinstance(what, OtherModel):
        return what.parameters
    if isinstance(what, Scene) and what.original is not None:
        return what.original.model.parameters
    return model_of(what, name).parameters


def parameters_for(what: ParametersLike, **mapping: object) -> Parameters:
    """Return the parameters of `what` for a function about a mapping, given by the name of its
    argument.

    Raise ParameterError if the mapping meets belt 2, and there is one belt.
    """
    if len(model_of(what).law.belts) == 1:
        for name, label in mapping.items():
            row = MAPS.get(label) if isinstance(label, str) else None
            if row is not None and 2 in (row.start.boundary, row.end.boundary):
                raise ParameterError(
                    name, label, "this mapping meets belt 2, and there is one belt"
                )
    return parameters_of(what)


def belts_of(what: ParametersLike, name: str = "p") -> Model:
    """Return the oscillator of what `parameters_of` takes, with the belts that it has.

    It is an `Oscillator` if there is one belt, and else `Parameters`.
    """
    model = model_of(what, name)
    p = model.parameters
    if len(model.law.belts) == 1:
        return model
    return p


def model_of(what: ParametersLike, name: str = "p") -> Model:
    """Return the oscillator of a model, or of a scene or its name or file, with any friction law.

    Return `Parameters` and an `Oscillator` unchanged. Messages call the argument `name`.
    """
    if isinstance(what, Model):
        return what
    if isinstance(what, OtherModel):
        return reduced_model(what)
    if isinstance(what, Scene):
        return what.parameters
    require(Parameters, Oscillator, SCENE_OR_NAME, **{name: what})
    return load_scene(what).parameters


def scene_of(
    what: Scene | Model | SceneName, name: str, any_law: bool = False
) -> Scene | Parameters:
    """Return a scene if `what` is one, or its name or file; return `Parameters` unchanged.

    Unless `any_law`, what follows another friction law is refused, and an `Oscillator` with the law
    of `Parameters` becomes these. Messages call the argument `name`.
    """
    if not isinstance(what, Scene | Model):
        require(Scene, Parameters, Oscillator, SCENE_NAME, **{name: what})
        what = load_scene(what)
    if any_law or (isinstance(what, Scene) and isinstance(what.parameters, Parameters)):
        return what  # type: ignore[return-value]
    if isinstance(what, Scene):
        return replace(what, parameters=parameters_of(what))
    return what.parameters


def problem_of(
    what: Scene | Model | OtherModel | SceneName, name: str, any_law: bool = False
) -> Scene | Parameters | OtherModel:
    """Return a scene if `what` is one, or its name or file; return Parameters and models unchanged.

    `any_law` is that of `scene_of`. Messages call the argument `name`.
    """
    if isinstance(what, OtherModel):
        return what
    require(Scene, Parameters, Oscillator, OtherModel, SCENE_NAME, **{name: what})
    return scene_of(what, name, any_law)


def end_time(end: Any, p: Model, t0: Any) -> Any:
    """Return an end time; text such as "10T" means that many periods of the drive after t0."""
    periods = forcing_periods("t_end", end)
    if periods is None:
        return end
    check_periods("t_end", end, p)
    return float(read_number("t0", t0)[0]) + float(periods) * (2 * pi / float(p.Omega))


def passed(what: Any) -> str:
    """Return what a caller passed in place of a scene, for the message that something is missing."""
    names = {Parameters: "Parameters", Oscillator: "an Oscillator"}
    return names.get(type(what), "an OtherModel")


def check_periods(name: str, text: Any, p: Model) -> None:
    """Raise ParameterError for a time in periods of the drive where there is no Omega."""
    if not p.has_periods:
        raise ParameterError(
            name, text, "periods of the drive require Omega, which this Oscillator lacks"
        )


def from_rest(p: Model, t_end: NumberLike) -> Scene:
    """Return a scene with these parameters that starts from rest at x = 0 and t = 0."""
    zero = Fraction(0)
    end = end_time(t_end, p, zero)
    return Scene("parameters", p, zero, zero, zero, end)  # type: ignore[arg-type]


def scene_names() -> list[str]:
    """Return the names of the shipped scenes: in the order of the paper's figures, then all others.

    Examples
    --------
    >>> from symosc import scene_names
    >>> scene_names()[:4]
    ['fig5', 'fig6', 'fig7', 'fig7-exact']
    """
    return list(_shipped_names())


@cache
def _shipped_names() -> tuple[str, ...]:
    """Return the names of the shipped scenes, in the order of `scene_names`."""
    names = [path.stem for path in SCENES_FOLDER.glob("*.toml")]
    return tuple(sorted(names, key=lambda name: (figure_of(name) or inf, len(name), name)))


@cache
def _shipped(name: str) -> Scene:
    return _read_file(SCENES_FOLDER / f"{name}.toml", name)


def template_names() -> list[str]:
    """Return the names of the scenes that only `symosc new` writes, to begin with."""
    return sorted(path.stem for path in TEMPLATES_FOLDER.glob("*.toml"))


def load_template(name: str) -> Scene:
    """Return the template of this name, or else what `load_scene` returns."""
    if name in template_names():
        return _read_file(TEMPLATES_FOLDER / f"{name}.toml", name)
    return load_scene(name)


def figure_of(name: str) -> int | None:
    """Return the number of the paper's figure in a scene's name; None if the scene is not from the
    paper.
    """
    match = re.match(r"fig(\d+)(-|$)", name, re.ASCII)
    if match:
        return int(match[1])
    return None


@public
def load_scene(name_or_path: SceneName) -> Scene:
    """Load a shipped scene by name, or a TOML file of the same form by path.

    `symosc new` writes one to begin with.

    In a file a number may be an expression such as "3*pi/2", which is read to 40 digits
    (`Scene.notes` says so, and a start is then known to these only), and may have a unit, such as
    "2.5 cm" (extra `units`), which is converted to kg, m, s, N and rad. A table [model] makes the
    file one of an `OtherModel`.

    Raises
    ------
    SceneError
        If there is no such scene, or the file is not TOML, or a key is missing or unknown; with the
        line.
    ParameterError
        If a number is out of range; with the line and the table.
    MissingExtraError
        If a number has a unit, and pint is not installed.

    Examples
    --------
    >>> from symosc import load_scene
    >>> scene = load_scene("fig6")
    >>> print(scene.v0, scene.t_end, scene.parameters.Omega)
    5 20 1/10
    """
    require(SCENE_NAME, name_or_path=name_or_path)
    text = str(name_or_path)
    if text in _shipped_names():
        return _shipped(text)
    path = Path(text)
    if "\0" in text:
        raise SceneError(repr(text), "the name of a file has no character \\0")
    if path.suffix != ".toml" and not isfile(path):
        known = f"unknown; shipped are {', '.join(scene_names())}; or give the path of a TOML file"
        raise SceneError(text, known + meant(text, scene_names()))
    return _read_file(path, text)


def _read_file(path: Path, where: str) -> Scene:
    """Return the scene in a TOML file, which messages call `where`."""
    try:
        with path.open(encoding="utf-8-sig") as file:
            content = file.read(MOST_CHARACTERS + 1)
    except OSError as error:
        raise SceneError(where, f"cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise SceneError(where, "is not UTF-8 text") from None
    return read_scene(content, where)


def read_scene(text: str, where: str) -> Scene:
    """Return a scene from the text of a TOML file, which messages call `where`.

    `load_scene` explains its form.
    """
    file = read_scene_file(text, where)
    data = file.data
    belts = _read_belts(file)
    try:
        numbers = data["parameters"]
        problem: OtherModel | Model
        if "model" in data:
            problem = OtherModel(**numbers, **data["model"], belts=tuple(belts))
        elif belts:
            problem = Oscillator(**numbers, belts=belts)
        else:
            problem = Parameters(**numbers)
        return Scene(
            name=data.get("name", Path(where).stem),
            parameters=problem,  # type: ignore[arg-type]
            t_end=data["t_end"],
            structure=data.get("structure"),
            source=data.get("source", ""),
            notes=tuple(file.notes),
            in_si=file.has_units,
            **data["start"],
        )
    except ParameterError as error:
        raise file.located(error) from None
    except WordError as error:
        raise SceneError(file.where, f"{file.place('structure')}: structure: {error}") from None


def _read_belts(file: SceneFile) -> list[Belt]:
    """Return the belts of a file; the message of an error says which table is meant."""
    belts = []
    for n, numbers in enumerate(file.data.get("belts", ())):
        try:
            belts.append(Belt(**numbers))
        except ParameterError as error:
            raise file.located(error, n) from None
    return belts


# --- writing ---

#: What stands at the top of a file with comments.
INTRODUCTION = """\
# A scene of symosc. Try it:  symosc simulate {file}
#
# Numbers are exact: 0.8, "4/5" and 8e-1 are the same. Any consistent system of units will do; in brackets are those of
# the SI. A number may have a unit, such as "2.5 cm" or "60 rpm" (extra units); plain numbers are then in these too.
# Where a number need not be exact it may be an expression, such as "3*pi/2": it is read to 40 digits, and symosc says
# so. With pi, sqrt, sin, cos and exp a value is no fraction, and a start is then known to these digits only.
"""
MODEL_COMMENT = """\
# Another model, which symosc turns into its own. The base moves by Y cos(Omega t + Y_phase) + pull t; the belts have
# the speeds v1 and v2 and W cos(Omega t + W_phase), and joined = true moves them with the base; the force is A0 + B0
# cos(Omega t + phase); g and angle are gravity on a slope. What is left out is 0, mu1 is 1; without v2 there is one
# belt or wall. Tables [[belts]] in place of v1, mu1, v2 and mu2 may have static friction and curves."""
BELTS_COMMENT = """\
# One belt or more: a table each. The mass sticks to a belt while the force that this needs is at most mu_s FN, and
# slides with mu FN; without mu_s there is no static friction beyond mu. In place of mu there may be a curve over the
# relative speed w, linear between its points [w, mu], such as curve = [[0, 0.4], [0.5, 0.25]], and a slope beyond the
# last one. What is left out of [parameters] is A0 = B0 = 0 and FN = 1, so that the coefficients are forces; without a
# drive there is no Omega."""
START_COMMENT = (
    "# The mass at the start. start_error = 1e-9 would say that these three may be off by so much."
)


#: Points of a friction curve in one line of a file.
POINTS_IN_A_LINE = 4


def as_toml(scene: Scene, explained: bool = False, file: str = "mine.toml") -> str:
    """Return a scene as the text of a TOML file, which reads back as the same scene.

    `explained` adds comments.
    """

    def line(name: str, text: str) -> str:
        """Return the line of a number, with its meaning and unit as a comment if `explained`."""
        written = f"{name} = {_toml_number(text)}"
        if not explained:
            return written
        meaning, _, _, allowed = quantity_of(name)
        unit = unit_of(name)
        return (
            f"{written:<15} # "
            f"{meaning}{allowed and f', {allowed}'}{'' if unit == '1' else f' [{unit}]'}"
        )

    if explained:
        lines = [INTRODUCTION.format(file=file)]
    else:
        lines = []
    # A JSON string is a TOML string too.
    about = {"name": scene.name, "source": scene.source, "structure": scene.structure}
    lines += [f"{key} = {json.dumps(value)}" for key, value in about.items() if value]
    if explained and not scene.structure:
        lines.append(
            '# structure = "P32"   # the periodic orbit that the scene is about, if there is one'
        )
    if scene.original is None:
        own: Scene | Original = scene
    else:
        own = scene.original
    p: Model = scene.parameters
    parameters: dict[str, Any] = p.as_dict()
    of_belts: Sequence[Belt] = ()
    if scene.original is not None:
        of_belts = scene.original.model.belts
    elif isinstance(p, Oscillator):
        of_belts = p.belts
        parameters = {n: text for n, text in parameters.items() if n in OSCILLATOR_NAMES}
    belts = [BELTS_COMMENT] if explained and of_belts else []
    for belt in of_belts:
        belts.append("[[belts]]")
        for name, value in belt.as_given().items():
            if name == "curve":
                belts += _curve_lines(value, explained)
            else:
                belts.append(line(name, show(value)))
        belts.append("")
    lines += [line("t_end", show(own.t_end)), ""]
    if scene.original is not None:
        parameters = scene.original.model.as_dict()
        parameters.pop("belts", None)
        lines += [*([MODEL_COMMENT] if explained else []), "[model]"]
        if parameters.pop("joined", False):
            lines.append("joined = true")
        lines += [
            line(name, parameters.pop(name))
            for name in list(parameters)
            if name not in PARAMETER_NAMES
        ]
        lines.append("")
    lines += [
        "[parameters]",
        *(line(name, text) for name, text in parameters.items()),
        "",
        *belts,
        "[start]",
    ]
    if explained:
        lines += [START_COMMENT]
    lines += [line(name, show(getattr(own, name))) for name in STARTS]
    if own.start_error is not None:
        lines.append(
            f"start_error = [{', '.join(_toml_number(show(error)) for error in own.start_error)}]"
        )
    return "\n".join(lines)


def _curve_lines(points: Sequence[tuple[Fraction, Fraction]], explained: bool) -> list[str]:
    """Return the lines of a friction curve."""
    written = [f"[{_toml_number(show(w))}, {_toml_number(show(mu))}]" for w, mu in points]
    rows = [
        ", ".join(written[i : i + POINTS_IN_A_LINE])
        for i in range(0, len(written), POINTS_IN_A_LINE)
    ]
    lines = []
    if explained:
        lines.append("# kinetic coefficient of friction over the relative speed: [w [m/s], mu]")
    if len(rows) == 1:
        return [*lines, f"curve = [{rows[0]}]"]
    return [*lines, "curve = [", *(f"  {row}," for row in rows), "]"]


def _toml_number(text: str) -> str:
    """Return a number's text as TOML writes it."""
    # TOML has no fractions; as text they are read exactly.
    if "/" in text:
        return json.dumps(text)
    return text
