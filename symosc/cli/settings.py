"""What every command reads alike: scenes, parameters (``--set NAME=VALUE``), and ``-`` as the name of a file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import replace
from fractions import Fraction
from math import pi
from typing import Any

import click
from click.shell_completion import CompletionItem

from symosc.cli.output import tell
from symosc.exact import read_exact
from symosc.files import STDOUT
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import START_NAMES, Scene, load_scene, scene_names
from symosc.scenes.reading import half_unit, read_number

Completion = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def complete(names: Iterable[str], end: str = "") -> Completion:
    """Return what gives the shell the names that begin as the last word of a list with commas does."""

    def begin_so(context: click.Context, argument: click.Parameter, begun: str) -> list[CompletionItem]:
        before, comma, word = begun.rpartition(",")
        return [CompletionItem(f"{before}{comma}{name}{end}") for name in names if name.startswith(word)]

    return begin_so


def complete_scene(context: click.Context, argument: click.Parameter, begun: str) -> list[CompletionItem]:
    """Return the scenes whose names begin so, for the shell; it adds files itself."""
    return complete(scene_names())(context, argument, begun) or [CompletionItem(begun, type="file")]


scene_argument = click.argument("scene", shell_complete=complete_scene)
set_option = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    shell_complete=complete(PARAMETER_NAMES, "="),
    help="Change a parameter, such as k=3 or Omega=2*pi. Repeatable.",
)


class WholeNumber(click.IntRange):
    """A whole number in ASCII digits; Python's own reading takes 1_000 and full-width digits as well."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number."""
        if isinstance(value, str) and not re.fullmatch(r"\s*[+-]?\d{1,1000}\s*", value, re.ASCII):
            self.fail(f"{value!r} is not a valid integer.", param, ctx)
        return super().convert(value, param, ctx)

    def _describe_range(self) -> str:
        """Return the range that --help shows: nothing, not x<=None, where there is none."""
        return "" if self.min is None and self.max is None else super()._describe_range()


def read_settings(settings: tuple[str, ...]) -> dict[str, str]:
    """Return names and values of ``--set`` options.

    Raises
    ------
    click.BadParameter
        For one that is not NAME=VALUE, is given twice or belongs to the start.
    """
    changes: dict[str, str] = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals:
            raise click.BadParameter(f"{setting!r} is not NAME=VALUE, such as k=3", param_hint="--set")
        if name in START_NAMES:
            raise click.BadParameter(f"{name} is not a parameter; use --{name.replace('_', '-')}", param_hint="--set")
        if name in changes:
            raise click.BadParameter(f"{name} is set twice", param_hint="--set")
        changes[name] = value
    return changes


def goes_to_stdout(output: str | None, option: str, as_json: bool = False) -> bool:
    """Tell whether a file goes to standard output; then the command prints nothing else there.

    Raises
    ------
    click.BadParameter
        If the name is empty, or JSON or the like is to be printed as well.
    """
    if output == "":
        raise click.BadParameter("give the name of a file; '-' is standard output", param_hint=option)
    if output == STDOUT and as_json:
        raise click.BadParameter(
            "'-' is standard output, and something else prints there already; name a file", param_hint=option
        )
    return output == STDOUT


def folder_name(output: str, option: str = "--output") -> str:
    """Return the name of a folder.

    Raises
    ------
    click.BadParameter
        If it is empty or standard output.
    """
    if output in ("", STDOUT):
        raise click.BadParameter(f"{output!r} is not a folder; './-' is one named -", param_hint=option)
    return output


def scene_with(scene: str | Scene, settings: tuple[str, ...], start: dict[str, str | None]) -> Scene:
    """Return a scene with ``--set`` parameters and a start from the command line; what it notes goes to stderr."""
    scene = load_scene(scene) if isinstance(scene, str) else scene
    for note in scene.notes:
        tell(f"{scene.name}: {note}")
    scene = replace(scene, parameters=scene.parameters.replace(**read_parameters(settings)))
    given = {name: read_typed(name, text) for name, text in start.items() if text is not None and name != "t_end"}
    known = {name: number for name, (number, _) in given.items()}
    if (end := start.get("t_end")) is not None:
        known["t_end"] = read_end(end, scene.parameters, known.get("t0", scene.t0))
    scene = scene.started(known)
    belts = (scene.parameters.v1, scene.parameters.v2)
    rounded = [name for name, (_, exact) in given.items() if not (exact or (name == "v0" and scene.v0 in belts))]
    if not rounded:
        return scene
    errors = dict(zip(START_NAMES, scene.start_error or (Fraction(0),) * 3, strict=False))
    t0, x0, v0 = (errors | {name: half_unit(getattr(scene, name)) for name in rounded}).values()
    return replace(scene, start_error=(t0, x0, v0))


def read_parameters(settings: tuple[str, ...]) -> dict[str, Any]:
    """Return the numbers of ``--set`` options; expressions such as 2*pi are read as in scene files."""
    return {name: read_typed(name, text)[0] for name, text in read_settings(settings).items()}


def read_end(text: str, p: Parameters, t0: Any) -> Any:
    """Return the end time that ``--t-end`` gives: a number, an expression, or periods of the forcing such as 10T."""
    duration = read_duration_typed("t_end", text)
    if not (isinstance(duration, str) and duration.endswith("T")):
        return duration
    period = 2 * pi / float(p.Omega)  # as of a sweep
    return float(read_exact("t0", t0)) + float(read_exact("t_end", duration[:-1].strip())) * period


def read_duration_typed(name: str, text: str) -> Any:
    """Return periods such as 10T as they are, and the number of what else somebody typed as a time."""
    return text.strip() if text.strip().endswith("T") else read_typed(name, text)[0]


def read_typed(name: str, text: str) -> tuple[Any, bool]:
    """Return a number that somebody typed, and whether it is exact; a line on stderr says if it is not."""
    if not re.search(r"pi|π|[*^()]", text):
        return text, True  # a number, or who uses it says what is wrong with it
    number, exact = read_number(name, text)
    if not exact:
        tell(f"{name} = {text}: read to 40 digits")
    return number, exact
