"""The command `symosc certify`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from symosc.certificates.certificate import common_complex, common_digits
from symosc.cli.orbit import read_span
from symosc.cli.output import complain, json_option, write, write_json, write_table
from symosc.cli.settings import complete, complete_scene, goes_to_stdout, scene_with, set_option
from symosc.display.progress import bar
from symosc.exact import read_start_error
from symosc.mappings.theorem7_cases import PLACES
from symosc.model import PARAMETER_NAMES

if TYPE_CHECKING:
    from symosc.certificates.certificate import Certificate
    from symosc.orbits.periodic_orbit import PeriodicOrbit
    from symosc.scenes import Scene

NOT_PROVEN = 1


@click.command()
@click.argument("scene", required=False, shell_complete=complete_scene)
@click.option("--t-end", metavar="T", help="End time in place of the scene's; 10T: after 10 periods.")
@click.option("--start-error", metavar="E", help="How far t0, x0, v0 may be off: a number, or three with commas.")
@click.option("--orbit", "word", metavar="WORD", help="Prove the periodic orbit with this structure, such as P32.")
@click.option(
    "--branch",
    "span",
    metavar="NAME=LO:HI",
    shell_complete=complete(PARAMETER_NAMES, "="),
    help="Prove the orbit for every value of a parameter.",
)
@click.option(
    "--window",
    "mapping",
    metavar="MAP",
    shell_complete=complete(PLACES),
    help="Prove the grazing window of a map, such as P2.",
)
@click.option("--orbits", "listed", is_flag=True, help="Prove the list of orbits that ships, in two processes.")
@set_option
@click.option("-o", "--output", metavar="FILE", help="Write the certificate, a JSON file. -: to stdout, and only that.")
@json_option
def certify(
    scene: str | None,
    *,
    t_end: str | None,
    start_error: str | None,
    word: str | None,
    span: str | None,
    mapping: str | None,
    listed: bool,
    settings: tuple[str, ...],
    output: str | None,
    as_json: bool,
) -> int:
    """Prove all events of a scene: that each is the next one, of its kind, and between which times and positions.

    Or prove its periodic orbit, a branch of such orbits up to its ends, or a grazing window. With --branch the
    structure is that of --orbit, or the scene's. The table shows as many digits as both ends of an enclosure round to.
    Proven is only what the checker, `symosc verify`, proves again by other means. If anything stays open, one line says
    what, and the exit code is 1.

    \b
    Examples:
      symosc certify fig5
      symosc certify fig8 --t-end 12 -o fig8.json
      symosc certify fig9 --orbit P32
      symosc certify fig9 --branch Omega=3:6
    """
    piped = goes_to_stdout(output, "--output", as_json)
    if listed:
        if scene is not None:
            raise click.UsageError("--orbits proves its own list; give no scene")
        return _list()
    if scene is None:
        raise click.UsageError("Missing argument 'SCENE'.")
    if (word or span or mapping) and (t_end or start_error):
        raise click.UsageError("--t-end and --start-error are for the motion of a scene, not for its orbit or a window")
    problem = scene_with(scene, settings, {"t_end": t_end})
    certificate = _proof(problem, start_error, word, span, mapping)
    if certificate is None:
        return NOT_PROVEN
    if output is not None:
        certificate.to_json(output)
    if as_json:
        write_json(certificate.as_dict())
    elif not piped:
        _report(certificate)
    if not certificate.proven:
        complain(f"not proven: {certificate.message}")
    return 0 if certificate.proven else NOT_PROVEN


def _proof(
    problem: Scene, start_error: str | None, word: str | None, span: str | None, mapping: str | None
) -> Certificate | None:
    """Return the certificate that is asked for; None, after a line that says so, if there is no such orbit."""
    from symosc.certificates.certify import certify as prove

    if mapping is not None:
        from symosc.grazing.window import grazing_window

        return prove(grazing_window(problem.parameters, mapping))
    if word is None and span is None:
        parts = None if start_error is None else start_error.split(",")
        error = None if parts is None else read_start_error(parts if len(parts) > 1 else start_error)
        return prove(problem, start_error=error)
    found = _orbit(problem, word)
    if found is None or span is None:
        return None if found is None else prove(found)
    from symosc.orbits.branch import continue_orbit

    name, limits = read_span(span, "--branch")
    branch = continue_orbit(found.parameters, found.word, name, limits, found)
    return prove(branch, progress=True)


def _orbit(problem: Scene, word: str | None) -> PeriodicOrbit | None:
    from symosc.orbits.closing_equations import ConvergenceError
    from symosc.orbits.find import find_orbit

    word = word or problem.structure
    if word is None:
        raise click.UsageError(f"the scene {problem.name} has no structure of its own; give --orbit")
    try:
        found = find_orbit(problem.parameters, word)
    except ConvergenceError as error:
        complain(f"not proven: {error}")
        return None
    if not found.admissible:
        complain(f"not proven: {found.word} is {found.message}")
        return None
    return found


def _report(certificate: Certificate) -> None:
    rows = [[*_ends(event), event[0], f"{event[1]} -> {event[2]}"] for event in certificate.events]
    if rows and rows[0][0]:
        write_table(rows, ["t", "x", "kind", "from -> to"])
        write("")
    for i, multiplier in enumerate(certificate.multipliers, 1):
        write(f"multiplier {i}: {common_complex(*multiplier)}")
    if certificate.proven:
        write(f"proven: {certificate.message}")


def _ends(event: tuple[Any, ...]) -> tuple[str, str]:
    """Return t and x of an event, "" where it has none: the events of a branch are at other times for each value."""
    return (common_digits(*event[3]), common_digits(*event[4])) if len(event) > 3 else ("", "")


def _list() -> int:
    from symosc.certificates.orbit_list import listed_orbits, prove_list

    count = len(listed_orbits())
    with bar("proven", count, "orbits") as report:
        done = prove_list(progress=report)
    regimes = ", ".join(f"{number} {name}" for name, number in done.regimes.items())
    write(f"proven: {done.orbits} of {count} orbits ({regimes}), with {done.words} words")
    for message in done.undecided:
        complain(f"not proven: {message}")
    return NOT_PROVEN if done.undecided else 0
