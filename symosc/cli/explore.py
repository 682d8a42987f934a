"""The command `symosc explore`."""

from __future__ import annotations

import webbrowser
from threading import Thread

import click

from symosc.cli.output import write
from symosc.cli.settings import WholeNumber, complete_scene, scene_with, set_option


@click.command()
@click.argument("scene", default="fig5", shell_complete=complete_scene)
@set_option
@click.option(
    "--port", type=WholeNumber(0, 65_535), metavar="N", help="The port of the page; 0: any free one. Default: 8519."
)
@click.option("--no-browser", is_flag=True, help="Only print the page's address.")
def explore(scene: str, settings: tuple[str, ...], port: int | None, no_browser: bool) -> None:
    """Open a page in the browser with a slider for each number, and what becomes of the motion.

    The page shows the phase plane, position, velocity and forces, the events and the grazing windows. Its link has all
    its numbers, and it saves and opens scene files. It is on this machine only. Ctrl-C ends it.

    \b
    Examples:
      symosc explore
      symosc explore fig9 --set Omega=3.5
    """
    problem = scene_with(scene, settings, {})
    from symosc.plot.explorer.server import PORT, ExplorerServer

    with ExplorerServer(problem, PORT if port is None else port) as server:
        write(f"{server.address} (Ctrl-C ends it)")
        if not no_browser:  # in a thread: some browsers come back only when they are closed
            Thread(target=webbrowser.open, args=[server.address], daemon=True).start()
        server.serve_forever()
