"""`symosc atlas`: the words of a plane of two parameters, their borders, and proofs."""

from __future__ import annotations

from typing import Any

import click

import symosc
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, option


@click.command()
@options.scene_argument
@option("--over NAME=LO:HI", "A parameter of the plane and its range. Give two.", multiple=True)
@options.set_option
@option("--prove SHARE", "Part of the area to prove: 0 to 1.", default="0", show_default=True)
@option("--seconds S", "When to stop proving.")
@option("--workers N", "Processes. Default: one for each core.")
@option(
    "-o, --output FILE", "Write it as JSON; what an earlier run left there is taken up.", "path"
)
@options.plot_option
@options.json_option
def atlas(
    scene: str, over: tuple[str, ...], settings: Settings, path: Text, plot: Text, **limits: Any
) -> None:
    """Map a plane of two parameters: words, borders, special points, and boxes in which the word is
    proven.

    `symosc verify` proves again the file that -o writes.

    \b
    Examples:
      symosc atlas fig9 --over Omega=3:5 --over FN=5:12 --plot plane.svg
      symosc atlas fig9 --over Omega=3.9:4.1 --over FN=9.5:10.5 --prove 0.9 -o plane.json
    """
    spans = [options.read_span(side, "--over") for side in over]
    ranges = dict(spans)
    are_two = len(spans) == 2 and len(ranges) == 2
    options.refuse((not are_two, "give --over twice, with two parameters"))
    problem = options.scene_with(scene, settings)
    plane = symosc.atlas(problem, ranges, **limits, path=path, progress=True)
    output.draw(plot, plane.plot)
    output.report(plane.statement, lambda: _print_atlas(plane, path, plot))


def _print_atlas(plane: symosc.Atlas, *files: Text) -> None:
    """Print an atlas: the words with their shares, the borders, the special points, the files."""
    rows = [
        [region.word or "none found", f"{region.share:.4%}", f"{region.proven:.4%}"]
        for region in plane.regions
    ]
    output.write_table(rows, ["word", "share", "proven"])
    for border in plane.borders:
        words = " | ".join(word or "?" for word in border.words)
        output.write(f"border {words}: {border.sliding or border.kind}, {len(border)} points")
    for point in plane.special:
        values = ", ".join(
            f"{name} = {value:.10g}" for name, value in zip(plane.over, point.values, strict=True)
        )
        output.write(f"{point.kind}: {values}")
    output.name_files(*files)
