"""`symosc atlas`: the words of a plane of two parameters, their borders, and proofs."""

from __future__ import annotations

from typing import Any

import click

from symosc.cli.common import (
    WholeNumber,
    check_picture,
    complete,
    goes_to_stdout,
    json_option,
    read_span,
    scene_argument,
    scene_with,
    set_option,
    write,
    write_json,
    write_table,
    wrote,
)
from symosc.model import PARAMETER_NAMES


@click.command()
@scene_argument
@click.option(
    "--over",
    "sides",
    multiple=True,
    metavar="NAME=LO:HI",
    shell_complete=complete(PARAMETER_NAMES, "="),
    help="A parameter of the plane and its range. Give two.",
)
@set_option
@click.option("--prove", default="0", show_default=True, metavar="SHARE", help="Part of the area to prove: 0 to 1.")
@click.option("--seconds", metavar="S", help="When to stop proving.")
@click.option("--workers", type=WholeNumber(), metavar="N", help="Processes. Default: one for each core.")
@click.option("-o", "--output", metavar="FILE", help="Write it as JSON; what an earlier run left there is taken up.")
@click.option("--plot", "picture", metavar="FILE", help="Draw it: .pdf, .svg or .png. -: SVG to stdout.")
@json_option
def atlas(scene: str, sides: tuple[str, ...], settings: tuple[str, ...], picture: str | None, **options: Any) -> None:
    """Draw up the plane of two parameters: words, borders, special points, and boxes in which the word is proven.

    `symosc verify` proves the file of -o once more.

    \b
    Examples:
      symosc atlas fig9 --over Omega=3:5 --over FN=5:12 --plot plane.svg
      symosc atlas fig9 --over Omega=3.9:4.1 --over FN=9.5:10.5 --prove 0.9 -o plane.json
    """
    from symosc.certificates.atlas import atlas as draw_up

    output, as_json = options["output"], options["as_json"]
    piped = goes_to_stdout(picture, "--plot", as_json)
    goes_to_stdout(output, "--output")
    spans = [read_span(side, "--over") for side in sides]
    if len({name for name, _ in spans}) != 2 or len(spans) != 2:
        raise click.UsageError("give --over twice, with two parameters")
    check_picture(picture)
    how = {name: options[name] for name in ("prove", "seconds", "workers")}
    made = draw_up(scene_with(scene, settings, {}), dict(spans), **how, path=output, progress=True)
    if picture is not None:
        from symosc import plot

        plot.save(plot.atlas_figure(made), picture)
    if as_json:
        write_json(made.statement())
    elif not piped:
        rows = [[region.word or "none found", f"{region.share:.4%}", f"{region.proven:.4%}"] for region in made.regions]
        write_table(rows, ["word", "share", "proven"])
        for border in made.borders:
            words = " | ".join(word or "?" for word in border.words)
            write(f"border {words}: {border.sliding or border.kind}, {len(border)} points")
        for point in made.special:
            at = ", ".join(f"{name} = {value:.10g}" for name, value in zip(made.over, point.values, strict=True))
            write(f"{point.kind}: {at}")
        for path in (output, picture):
            if path is not None:
                write(wrote(path))
