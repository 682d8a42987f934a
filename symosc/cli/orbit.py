"""`symosc orbit`: a periodic orbit, its stability, and its branch over a parameter."""

from __future__ import annotations

from functools import partial
from math import isnan
from typing import Any

import click

import symosc
from symosc.base.aliases import Record
from symosc.base.exact import show
from symosc.base.files import STDOUT
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, option
from symosc.reductions import MODEL_NAMES
from symosc.words import Word


@click.command()
@options.scene_argument
@option(
    "--structure WORD",
    "Mapping structure, such as P32. Default: the scene's, or that of the settled motion.",
)
@options.set_option
@option("--periods N", "Close after N forcing periods. Default: what simulations do.")
@option("--digits N", "N correct digits, instead of double precision.")
@option("--continue NAME=LOW:HIGH", "Follow it over a parameter, such as Omega=3:5.", "span")
@option(
    "--response NAME=LOW:HIGH:N",
    "Amplitude, energies and so on of the settled motion over a parameter, such as Omega=1:5:80.",
    shell_complete=options.complete(lambda: MODEL_NAMES, "="),
)
@option(
    "-o, --output FIGURE",
    "Draw orbit, branch or response: .pdf, .svg or .png. -: SVG to stdout.",
    "picture",
)
@options.json_option
def orbit(
    scene: str,
    structure: Text,
    settings: Settings,
    span: Text,
    response: Text,
    picture: Text,
    **exact: int | None,
) -> int:
    """Find the periodic orbit of a mapping structure, or the one that a motion settles to, and its
    stability.

    Prints the switching points, the multipliers, and how far the scene's start is from the orbit.
    With --continue the orbit is followed both ways until it ends or leaves the range. Each end is
    located, and printed with its reason and with the structure of the orbit beyond it. A structure
    without an orbit at these parameters gives exit code 1.

    \b
    Examples:
      symosc orbit fig9
      symosc orbit fig10 --structure P4645 --digits 30
      symosc orbit fig9 --structure P32 --continue Omega=3:5 -o branch.pdf
      symosc orbit fig9 --response Omega=1:8:80 -o response.pdf
    """
    problem = options.scene_with(scene, settings)
    if response is not None:
        if structure or span or any(exact.values()):
            reason = (
                "it is that of the settled motion: leave out --structure, --continue, --periods "
                "and --digits"
            )
            raise click.BadParameter(reason, param_hint="--response")
        _print_response(problem, response, picture)
        return 0
    if span is not None and problem.original is not None:
        reason = (
            f"{problem.name} is of another model, whose drive changes with its parameters: no "
            "branch is followed"
        )
        raise click.BadParameter(reason, param_hint="--continue")
    problem = options.reduced_scene(problem, any_law=True)
    with output.failing(symosc.ConvergenceError):
        closed_orbit = symosc.find_orbit(problem, structure or problem.structure, **exact)
    branch = None
    if closed_orbit.admissible:
        if span is not None:
            name, limits = options.read_span(span, "--continue")
            follow_options: Record = {"periods": exact["periods"], "progress": True}
            branch = symosc.continue_orbit(
                closed_orbit.parameters,
                closed_orbit.word or None,
                name,
                limits,
                closed_orbit,
                **follow_options,
            )
        output.draw(picture, (branch or closed_orbit).plot)
    text = partial(_report_text, problem, closed_orbit, branch)
    output.report(lambda: _orbit_data(problem, closed_orbit, branch), lambda: output.write(text()))
    if picture == STDOUT and not closed_orbit.admissible:
        output.complain(text())
    if closed_orbit.admissible:
        return 0
    return output.FAILED


def _print_response(problem: symosc.Scene, over: str, picture: Text) -> None:
    """Print and draw the frequency response of a scene over the parameter in `over`,
    NAME=LOW:HIGH:N.
    """
    name, values = options.split_setting(
        over, "--response", "NAME=LOW:HIGH:N, such as Omega=1:5:80"
    )
    curves = symosc.frequency_response(problem, {name: values}, progress=True)
    output.draw(picture, curves.plot)
    columns = {head: column.tolist() for head, column in curves.columns().items()}
    rows = zip(*columns.values(), strict=True)
    texts = [
        [f"{value:.8g}" if isinstance(value, float) else value for value in row] for row in rows
    ]
    heads = [head.replace("_", " ") for head in columns]
    output.report(
        lambda: {"scene": problem.name, **columns}, lambda: output.write_table(texts, heads)
    )


def _orbit_data(
    scene: symosc.Scene, orbit: symosc.PeriodicOrbit, branch: symosc.Branch | None
) -> Record:
    """Return an orbit, and its branch if there is one, as the data that --json prints."""
    data = {"scene": scene.name, **orbit.as_dict()}
    if orbit.admissible:
        data["start"] = orbit.approach(scene)._asdict()
    if branch is None:
        return data
    return data | {"branch": branch.as_dict()}


def _report_text(
    scene: symosc.Scene, orbit: symosc.PeriodicOrbit, branch: symosc.Branch | None
) -> str:
    """Return the switching points, multipliers and ends of an orbit (and its branch) as text."""

    def decimal(value: Any) -> str:
        if orbit.digits is None:
            return output.FLOAT_FORMAT.format(value)
        return value.context.nstr(value, orbit.digits)

    rows = []
    for row, (t, x) in zip(Word(orbit.labels).maps, orbit.points, strict=True):
        if row.sticks:
            action = f"sticks to belt {row.start.boundary}"
        else:
            action = f"moves in Omega{row.domain} from v{row.start.boundary} to v{row.end.boundary}"
        rows.append([decimal(t), decimal(x), row.label, action])
    sizes = ", ".join(_complex(value) for value in orbit.multipliers)
    lines = [
        output.plain_table(["t", "x", "map", "from here it"], rows),
        "",
        f"{orbit.word or 'no belt'}: {orbit.message}",
    ]
    if not rows:
        del lines[:2]
    lines.append(
        f"period {decimal(orbit.period)}, multipliers {sizes}, residual {orbit.residual:.1e}"
    )
    if orbit.admissible:
        lines.append(_start_text(scene, orbit))
    if branch is not None:
        lines += ["", f"branch of {len(branch.values)} points over {branch.parameter}:"]
        for place in branch.special:
            lines.append(f"  {branch.parameter} = {place.value:.12g}: {place.kind}")
        for end in branch.ends:
            if end.beyond:
                beyond = f"; beyond it {end.beyond}"
            else:
                beyond = ""
            lines.append(
                f"  {branch.parameter} = {end.value:.12g}: {end.kind}, {end.message}{beyond}"
            )
    return "\n".join(lines)


def _start_text(scene: symosc.Scene, orbit: symosc.PeriodicOrbit) -> str:
    """Return a sentence on how far a scene's start is from its orbit, and whether its motion comes
    near.
    """
    near = orbit.approach(scene)
    text = (
        f"the start of {scene.name} (t = {show(scene.t0)}) differs from the orbit by "
        f"{near.offset_x:.3g} in x and"
    )
    text += f" {near.offset_v:.3g} in v"
    is_on_belt = not isnan(near.dt)  # one of the orbit's
    if is_on_belt:
        text += f", from its nearest switching by {near.dt:.3g} in t and {near.dx:.3g} in x"
    if near.periods is None:
        return f"{text}; the motion from it does not come within {near.within:g}"
    periods = f"{near.periods} period{'' if near.periods == 1 else 's'}"
    return f"{text}; the motion from it is within {near.within:g} after {periods}"


def _complex(value: Any) -> str:
    real = f"{float(value.real):.12g}"
    if value.imag:
        return f"{real} {'+' if value.imag > 0 else '-'} {float(abs(value.imag)):.12g} i"
    return real
