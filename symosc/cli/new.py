"""The command `symosc new`."""

from __future__ import annotations

from dataclasses import replace
from os.path import lexists
from pathlib import Path

import click

from symosc.cli.output import write
from symosc.cli.settings import goes_to_stdout
from symosc.errors import OutputError
from symosc.files import write_text
from symosc.scenes import load_scene
from symosc.scenes.writing import as_toml


@click.command()
@click.argument("file")
@click.option("--like", default="fig5", show_default=True, metavar="SCENE", help="The scene whose numbers it has.")
@click.option("--force", is_flag=True, help="Replace a file that is there.")
def new(file: str, like: str, force: bool) -> None:
    """Write a scene file of your own to begin with: each number with what it is, its unit and what is allowed.

    All commands take such a file in place of a scene's name.

    \b
    Examples:
      symosc new mine.toml
      symosc new orbit.toml --like fig9
    """
    piped = goes_to_stdout(file, "FILE")
    scene = load_scene(like)
    if not piped:
        if Path(file).suffix != ".toml":
            raise OutputError(file, "the name of a scene file ends in .toml")
        if lexists(file) and not force:
            raise OutputError(file, "there is such a file already; --force replaces it")
        scene = replace(scene, name=Path(file).stem, source=f"the numbers of {like}")
    shown = click.format_filename(file)
    write_text(file, as_toml(scene, explained=True, file="mine.toml" if piped else shown) + "\n")
    if not piped:
        write(f"{shown}: a scene like {like}; symosc simulate {shown} follows it")
