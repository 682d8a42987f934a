"""The command `symosc scenes`."""

from __future__ import annotations

from itertools import takewhile

import click

from symosc.aliases import Record
from symosc.cli.output import json_option, write, write_json, write_table
from symosc.cli.settings import complete_scene
from symosc.exact import show
from symosc.scenes import START_NAMES, Scene, figure_of, load_scene, scene_names
from symosc.scenes.writing import as_toml


@click.command()
@click.argument("scene", required=False, shell_complete=complete_scene)
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
    return {**about, **start, "start_error": error, "parameters": scene.parameters.as_dict()}
