"""What every command reads alike: scenes, parameters (``--set NAME=VALUE``), and ``-`` as the name of a file."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import click
from click.shell_completion import CompletionItem

from symosc.cli.output import tell
from symosc.files import STDOUT
from symosc.scenes import START_NAMES, Scene, load_scene, scene_names


def complete_scene(context: click.Context, argument: click.Parameter, begun: str) -> list[CompletionItem]:
    """Return the scenes whose names begin so, for the shell; it adds files itself."""
    names = [CompletionItem(name) for name in scene_names() if name.startswith(begun)]
    return names or [CompletionItem(begun, type="file")]


scene_argument = click.argument("scene", shell_complete=complete_scene)
set_option = click.option(
    "--set", "settings", multiple=True, metavar="NAME=VALUE", help="Change a parameter, such as k=3. Repeatable."
)


class WholeNumber(click.IntRange):
    """A whole number in ASCII digits; Python's own reading takes 1_000 and full-width digits as well."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number."""
        if isinstance(value, str) and not re.fullmatch(r"\s*[+-]?\d{1,1000}\s*", value, re.ASCII):
            self.fail(f"{value!r} is not a valid integer.", param, ctx)
        return super().convert(value, param, ctx)


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


def scene_with(name_or_path: str, settings: tuple[str, ...], start: dict[str, str | None]) -> Scene:
    """Return a scene with ``--set`` parameters and a start from the command line; what it notes goes to stderr."""
    scene = load_scene(name_or_path)
    for note in scene.notes:
        tell(f"{scene.name}: {note}")
    changed = replace(scene, parameters=scene.parameters.replace(**read_settings(settings)))
    return changed.started({name: value for name, value in start.items() if value is not None})
