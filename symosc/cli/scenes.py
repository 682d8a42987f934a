"""`symosc scenes` and `symosc new`: list the shipped scenes, and write a scene file to edit."""

from __future__ import annotations

from dataclasses import replace
from itertools import takewhile
from os.path import lexists
from pathlib import Path

import click

from symosc.aliases import Record
from symosc.cli.common import goes_to_stdout, json_option, optional_scene, write, write_json, write_table
from symosc.errors import OutputError
from symosc.exact import show
from symosc.files import write_text
from symosc.scenes import START_NAMES, Scene, as_toml, figure_of, load_scene, scene_names


@click.command()
@optional_scene
@json_option
def scenes(scene: str | None, as_json: bool) -> None:
    """List the shipped scenes, or print one as a TOML file.

    \b
    Examples:
      symosc scenes
      symosc scenes fig9 > mine.toml
    """
    if scene is not None:
        chosen = load_scene(scene)
        if as_json:
            write_json(_scene_data(chosen))
        else:
            write(as_toml(chosen))
        return
    listed = [load_scene(name) for name in scene_names()]
    if as_json:
        write_json([_scene_data(each) for each in listed])
        return
    # The source of every scene of the paper begins with the paper; once is enough.
    sources = [each.source for each in listed if figure_of(each.name)]
    same = takewhile(lambda pair: pair[0] == pair[1], zip(min(sources), max(sources), strict=False))
    common = "".join(letter for letter, _ in same).rpartition(", ")[0]
    rows = []
    for each in listed:
        since, until = (f"{float(time):.6g}" for time in (each.t0, each.t_end))
        rows.append([each.name, since, until, each.structure or "", each.source.removeprefix(f"{common}, ")])
    write_table(rows, ["scene", "from t", "to t", "structure", "what it is"])
    write(f"\nsource of the figures: {common}")


def _scene_data(scene: Scene) -> Record:
    start = {name: show(getattr(scene, name)) for name in START_NAMES}
    about = {"name": scene.name, "source": scene.source, "structure": scene.structure}
    error = None if scene.start_error is None else [show(each) for each in scene.start_error]
    data: Record = {**about, **start, "start_error": error, "parameters": scene.parameters.as_dict()}
    if scene.original is not None:
        own: Record = {name: show(getattr(scene.original, name)) for name in START_NAMES}
        data["original"] = own | {"model": scene.original.model.as_dict()}
    return data


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
