"""`symosc orbit`: a periodic orbit, its stability, and its branch over a parameter."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

import click

from symosc.aliases import Record
from symosc.cli.common import (
    FAILED,
    FLOAT_FORMAT,
    WholeNumber,
    check_picture,
    complain,
    complete,
    goes_to_stdout,
    json_option,
    read_span,
    reduced_scene,
    scene_argument,
    scene_with,
    set_option,
    split_setting,
    write,
    write_json,
    write_table,
)
from symosc.display.tables import plain_table
from symosc.exact import show
from symosc.model import PARAMETER_NAMES
from symosc.reductions import MODEL_NAMES

if TYPE_CHECKING:
    from symosc.orbits.branch import Branch
    from symosc.orbits.periodic_orbit import PeriodicOrbit
    from symosc.scenes import Scene


@click.command()
@scene_argument
@click.option(
    "--structure",
    metavar="WORD",
    help="Mapping structure, such as P32. Default: the scene's, or that of the settled motion.",
)
@set_option
@click.option(
    "--periods", type=WholeNumber(), metavar="N", help="Close after N forcing periods. Default: what simulations do."
)
@click.option("--digits", type=WholeNumber(), metavar="N", help="N correct digits, instead of double precision.")
@click.option(
    "--continue",
    "span",
    metavar="NAME=LOW:HIGH",
    shell_complete=complete(PARAMETER_NAMES, "="),
    help="Follow it over a parameter, such as Omega=3:5.",
)
@click.option(
    "--response",
    metavar="NAME=LOW:HIGH:N",
    shell_complete=complete(MODEL_NAMES, "="),
    help="Amplitude, energies and so on of the settled motion over a parameter, such as Omega=1:5:80.",
)
@click.option(
    "-o", "--output", metavar="FILE", help="Draw orbit, branch or response: .pdf, .svg or .png. -: SVG to stdout."
)
@json_option
def orbit(
    scene: str,
    structure: str | None,
    settings: tuple[str, ...],
    periods: int | None,
    digits: int | None,
    span: str | None,
    response: str | None,
    output: str | None,
    as_json: bool,
) -> int:
    """Find a periodic orbit, and say whether it is stable: that of a mapping structure, or of the settled motion.

    Prints the switching points, the multipliers, and how far the scene's start is from the orbit. With --continue the
    orbit is followed both ways until it ends or leaves the range. Each end is located, and printed with its reason and
    with the structure of the orbit beyond it. A structure without an orbit at these parameters gives exit code 1.

    \b
    Examples:
      symosc orbit fig9
      symosc orbit fig10 --structure P4645 --digits 30
      symosc orbit fig9 --structure P32 --continue Omega=3:5 -o branch.pdf
      symosc orbit fig9 --response Omega=1:8:80 -o response.pdf
    """
    from symosc.orbits.closing_equations import ConvergenceError
    from symosc.orbits.find import find_orbit

    piped = goes_to_stdout(output, "--output", as_json)
    problem = scene_with(scene, settings, {})
    if response is not None:
        if structure or span or periods or digits:
            reason = "it is that of the settled motion: leave out --structure, --continue, --periods and --digits"
            raise click.BadParameter(reason, param_hint="--response")
        return _response(problem, response, output, as_json, piped)
    if span is not None and problem.original is not None:
        reason = f"{problem.name} is of another model, whose drive changes with its parameters: no branch is followed"
        raise click.BadParameter(reason, param_hint="--continue")
    problem = reduced_scene(problem)
    structure = problem.structure if structure is None else structure  # None: that of the settled motion
    check_picture(output)
    try:
        found = find_orbit(problem.parameters, structure, digits=digits, periods=periods)
    except ConvergenceError as error:
        complain(f"{error}")
        return FAILED
    branch = None
    if span is not None and found.admissible:
        from symosc.orbits.branch import continue_orbit

        name, limits = read_span(span, "--continue")
        branch = continue_orbit(found.parameters, found.word, name, limits, found, periods=periods, progress=True)
    if output is not None and found.admissible:
        from symosc import plot

        plot.save(plot.orbit_figure(found) if branch is None else plot.branch_figure(branch), output)
    if as_json:
        write_json(_orbit_data(problem, found, branch))
    elif not piped:
        write(_report_text(problem, found, branch))
    elif not found.admissible:
        click.echo(_report_text(problem, found, branch), err=True)
    return 0 if found.admissible else FAILED


def _response(problem: Scene, over: str, output: str | None, as_json: bool, piped: bool) -> int:
    """Print and draw a frequency response."""
    from symosc.response import frequency_response

    name, values = split_setting(over, "--response", "NAME=LOW:HIGH:N, such as Omega=1:5:80")
    check_picture(output)
    found = frequency_response(problem, {name: values}, progress=True)
    if output is not None:
        from symosc import plot

        plot.save(plot.response_figure(found), output)
    columns = {head: column.tolist() for head, column in found.columns().items()}
    if as_json:
        known = {
            head: [None if isinstance(value, float) and not isfinite(value) else value for value in column]
            for head, column in columns.items()
        }
        write_json({"scene": problem.name, **known})  # JSON has no infinity
    elif not piped:
        table = zip(*columns.values(), strict=True)
        rows = [[f"{each:.8g}" if isinstance(each, float) else each for each in row] for row in table]
        write_table(rows, [head.replace("_", " ") for head in columns])
    return 0


def _orbit_data(scene: Scene, found: PeriodicOrbit, branch: Branch | None) -> Record:
    data = {"scene": scene.name, **found.as_dict()}
    if found.admissible:
        data["start"] = found.approach(scene)._asdict()
        for name in ("dt", "dx"):
            data["start"][name] = None if data["start"][name] != data["start"][name] else data["start"][name]
    return data if branch is None else data | {"branch": branch.as_dict()}


def _report_text(scene: Scene, found: PeriodicOrbit, branch: Branch | None) -> str:
    rows = []
    for piece, (t, x) in zip(found.equations().pieces, found.points, strict=True):
        does = f"moves in Omega{piece.mode} from v{piece.start} to v{piece.end}"
        if piece.sticks:
            does = f"sticks to belt {piece.start}"
        rows.append([_decimal(t, found.digits), _decimal(x, found.digits), piece.label, does])
    table = plain_table(["t", "x", "map", "from here it"], rows)
    sizes = ", ".join(_complex(value) for value in found.multipliers)
    lines = [table, "", f"{found.word}: {found.message}"]
    lines.append(f"period {_decimal(found.period, found.digits)}, multipliers {sizes}, residual {found.residual:.1e}")
    if found.admissible:
        lines.append(_start_text(scene, found))
    if branch is not None:
        lines += ["", f"{len(branch.values)} orbits over {branch.parameter}:"]
        for end in branch.ends:
            beyond = f"; beyond it {end.beyond}" if end.beyond else ""
            lines.append(f"  {branch.parameter} = {end.value:.12g}: {end.kind}, {end.message}{beyond}")
    return "\n".join(lines)


def _start_text(scene: Scene, found: PeriodicOrbit) -> str:
    near = found.approach(scene)
    place = f"the start of {scene.name} (t = {show(scene.t0)}) is off the orbit by {near.offset_x:.3g} in x and"
    place += f" {near.offset_v:.3g} in v"
    if near.dt == near.dt:
        place += f", from its nearest switching by {near.dt:.3g} in t and {near.dx:.3g} in x"
    if near.periods is None:
        return f"{place}; the motion from it does not come within {near.within:g}"
    periods = f"{near.periods} period{'' if near.periods == 1 else 's'}"
    return f"{place}; the motion from it is within {near.within:g} after {periods}"


def _decimal(value: Any, digits: int | None) -> str:
    return FLOAT_FORMAT.format(value) if digits is None else value.context.nstr(value, digits)


def _complex(value: Any) -> str:
    if abs(value.imag) == 0:
        return f"{float(value.real):.12g}"
    return f"{float(value.real):.12g} {'+' if value.imag > 0 else '-'} {float(abs(value.imag)):.12g} i"
