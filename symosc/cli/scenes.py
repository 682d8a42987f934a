"""`symosc scenes` and `symosc new`: list the shipped scenes, and write a scene file to edit."""

from __future__ import annotations

from dataclasses import replace
from os.path import commonprefix, lexists
from pathlib import Path

import click

from symosc.base.aliases import Record
from symosc.base.errors import OutputError
from symosc.base.exact import show
from symosc.base.files import STDOUT, write_text
from symosc.cli import options, output
from symosc.scenes import (
    START_NAMES,
    Original,
    Scene,
    as_toml,
    figure_of,
    load_scene,
    load_template,
    scene_names,
    template_names,
)


@click.command()
@options.optional_scene
@options.json_option
def scenes(scene: str | None) -> None:
    """List the shipped scenes, or print one as a TOML file.

    \b
    Examples:
      symosc scenes
      symosc scenes fig9 > mine.toml
    """
    if scene is not None:
        chosen = load_scene(scene)
        output.report(lambda: _scene_data(chosen), lambda: output.write(as_toml(chosen)))
        return
    listed = [load_scene(name) for name in scene_names()]
    output.report(lambda: list(map(_scene_data, listed)), lambda: _print_scenes(listed))


def _print_scenes(listed: list[Scene]) -> None:
    """Print the table of scenes, with the source that those of the paper share below it."""
    # The source of every scene of the paper begins with the paper; once is enough.
    sources = [scene.source for scene in listed if figure_of(scene.name)]
    common = commonprefix(sources).rpartition(", ")[0]  # noqa: RUF071  letter by letter
    rows = []
    for scene in listed:
        span = [f"{float(time):.6g}" for time in (scene.t0, scene.t_end)]
        rows.append(
            [scene.name, *span, scene.structure or "", scene.source.removeprefix(f"{common}, ")]
        )
    output.write_table(rows, ["scene", "from t", "to t", "structure", "what it is"])
    output.write(f"\nsource of the figures: {common}")


def _scene_data(scene: Scene) -> Record:
    """Return a scene as the data that --json prints."""

    def start(problem: Scene | Original) -> Record:
        return {name: show(getattr(problem, name)) for name in START_NAMES}

    if scene.start_error is None:
        error = None
    else:
        error = [show(number) for number in scene.start_error]
    data: Record = {
        "name": scene.name,
        "source": scene.source,
        "structure": scene.structure,
        **start(scene),
    }
    data |= {"start_error": error, "parameters": scene.parameters.as_dict()}
    if scene.original is not None:
        data["original"] = start(scene.original) | {"model": scene.original.model.as_dict()}
    return data


@click.command()
@click.argument("file", callback=options.checked_file)
@options.option(
    "--like SCENE",
    "The scene whose numbers it has; stick-slip: one belt with static friction; stribeck: one whose "
    "friction depends on speed.",
    default="fig5",
    show_default=True,
    shell_complete=options.complete(lambda: (*scene_names(), *template_names())),
)
@options.flag("--force", "Replace a file that is there.")
def new(file: str, like: str, force: bool) -> None:
    """Write a scene file of your own to begin with: each number with what it is, its unit and what
    is allowed.

    All commands take such a file in place of a scene's name.

    \b
    Examples:
      symosc new mine.toml
      symosc new orbit.toml --like fig9
      symosc new mine.toml --like stick-slip
    """
    scene = load_template(like)
    if file == STDOUT:
        write_text(file, as_toml(scene, explained=True) + "\n")
        return
    if Path(file).suffix != ".toml":
        raise OutputError(file, "the name of a scene file ends in .toml")
    if lexists(file) and not force:
        raise OutputError(file, "there is such a file already; --force replaces it")
    scene = replace(scene, name=Path(file).stem, source=f"the numbers of {like}")
    shown = click.format_filename(file)
    write_text(file, as_toml(scene, explained=True, file=shown) + "\n")
    output.write(f"{shown}: a scene like {like}; symosc simulate {shown} follows it")
