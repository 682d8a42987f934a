"""The command `symosc figure`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from symosc.cli.output import counted, undecidable, write
from symosc.cli.quick_drawing import load_matplotlib, without_collection
from symosc.cli.settings import WholeNumber, goes_to_stdout, read_end, scene_argument, scene_with, set_option

if TYPE_CHECKING:
    from symosc.scenes import Scene
    from symosc.simulation.trajectory import Trajectory


@click.command()
@scene_argument
@click.option("-o", "--output", required=True, metavar="FILE", help="The file: .pdf, .svg or .png. -: SVG to stdout.")
@click.option(
    "--t-end",
    metavar="T",
    help="End of the time axis; 10T: 10 periods. Default: what the paper shows, else the scene's.",
)
@set_option
@click.option(
    "--panels",
    metavar="LETTERS",
    help="a x(t), b v(t), c phase plane, forces: d (t), e (x), f (v), g their product (t).",
)
@click.option("--boundary", type=WholeNumber(1, 2), help="Forces at belt 1 or 2. Default: of the first event.")
@click.option("--columns", type=WholeNumber(1, 2), default=2, help="2: as wide as a page. 1: as a column of it.")
def figure(
    scene: str,
    output: str,
    settings: tuple[str, ...],
    t_end: str | None,
    panels: str | None,
    boundary: int | None,
    columns: int,
) -> int:
    """Draw a scene in panels like those of the paper's figures 5 to 10.

    \b
    Examples:
      symosc figure fig5 -o fig5.pdf
      symosc figure fig8 -o phase.svg --panels c --t-end 22
      symosc figure fig10 -o product.pdf --panels bdg --boundary 2
    """
    piped = goes_to_stdout(output, "--output")
    problem = scene_with(scene, settings, {})
    end = None if t_end is None else read_end(t_end, problem.parameters, problem.t0)
    with without_collection():
        load_matplotlib()
        trajectory = _drawn(problem, output, end, panels, boundary, columns)
    if piped:
        return int(undecidable(trajectory))
    span = f"t = {float(trajectory.t_start):.6g} to {float(trajectory.t_end):.6g}"
    write(f"{click.format_filename(output)}: {span}, {counted(trajectory.events)}")
    return int(undecidable(trajectory))


def _drawn(
    problem: Scene, output: str, t_end: Any, panels: str | None, boundary: int | None, columns: int
) -> Trajectory:
    """Draw a scene into a file, and return its motion."""
    from symosc import plot

    plot.check_suffix(output)
    panels = plot.default_panels(problem) if panels is None else panels
    plot.check_panels(panels)
    trajectory = plot.simulated(problem, t_end)
    plot.save(plot.figure(trajectory, panels=panels, boundary=boundary, columns=columns), output)
    return trajectory
