"""`symosc certify` and `symosc verify`: propose and prove events, orbits, branches and windows, and
prove a file again.
"""

from __future__ import annotations

from typing import Any

import click

import symosc
from symosc.base.errors import MissingExtraError
from symosc.certificates.certificate import common_complex, common_digits
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, option


@click.command()
@options.optional_scene
@option("--t-end T", "End time in place of the scene's; 10T: after 10 periods.")
@options.start_error_option
@option(
    "--wrt NAMES",
    "Enclose the derivatives of all events too, by parameters and t0, x0, v0, such as mu1,x0.",
)
@option("--orbit WORD", "Prove the periodic orbit with this structure, such as P32.", "word")
@option("--branch NAME=LO:HI", "Prove the orbit for every value of a parameter.", "span")
@option("--window MAP", "Prove the grazing window of a map, such as P2.", "mapping")
@options.set_option
@option(
    "-o, --output FILE", "Write the certificate, a JSON file. -: to stdout, and only that.", "path"
)
@options.json_option
def certify(
    scene: Text, settings: Settings, t_end: Text, path: Text, **subject_options: Any
) -> int:
    """Prove all events of a scene: none is missed, and each has its kind, and time and position
    within bounds.

    Or prove its periodic orbit, a branch of such orbits up to its ends, or a grazing window. With
    --branch the structure is that of --orbit, or the scene's. The table rounds an enclosure to the
    digits that both ends share. The engine proposes the bounds; proven is only what the checker,
    `symosc verify`, proves by ball arithmetic. If anything stays open, one line says what, and the
    exit code is 1.

    \b
    Examples:
      symosc certify fig5
      symosc certify fig8 --t-end 12 -o fig8.json
      symosc certify fig5 --wrt mu1,x0
      symosc certify fig9 --orbit P32
      symosc certify fig9 --branch Omega=3:6
    """
    from symosc.orbits.find import is_of_paper

    if scene is None:
        raise click.UsageError("Missing argument 'SCENE'.")
    is_no_motion = any(subject_options[name] for name in ("word", "span", "mapping"))
    is_for_motion = t_end or subject_options["start_error"] or subject_options["wrt"]
    if is_no_motion and is_for_motion:
        raise click.UsageError(
            "--t-end, --start-error and --wrt are for motions, not for an orbit, branch or window"
        )
    problem = options.scene_with(scene, settings, t_end=t_end)
    problem = options.reduced_scene(problem, any_law=not is_of_paper(problem.parameters))
    certificate = _proof(problem, **subject_options)
    if path is not None:
        certificate.to_json(path)
    output.report(certificate.as_dict, lambda: _print_certificate(certificate))
    if not certificate.proven:
        output.fail(f"not proven: {certificate.message}")
    return 0


def _proof(
    problem: symosc.Scene, start_error: Any, wrt: Text, word: Text, span: Text, mapping: Text
) -> symosc.Certificate:
    """Return the certificate of a motion, of an orbit (`word`), a branch (`span`) or a window
    (`mapping`).
    """
    if mapping is not None:
        return symosc.certify(symosc.grazing_window(problem.parameters, mapping))
    if word is None and span is None:
        if wrt is None:
            names = None
        else:
            names = [name.strip() for name in wrt.split(",")]
        return symosc.certify(problem, start_error=start_error, wrt=names)
    word = word or problem.structure
    options.refuse(
        (word is None, f"the scene {problem.name} has no structure of its own; give --orbit")
    )
    with output.failing(symosc.ConvergenceError, "not proven: "):
        orbit = symosc.find_orbit(problem.parameters, word)
    if not orbit.admissible:
        output.fail(f"not proven: {orbit.word} is {orbit.message}")
    if span is None:
        return symosc.certify(orbit)
    name, limits = options.read_span(span, "--branch")
    branch = symosc.continue_orbit(orbit.parameters, orbit.word, name, limits, orbit)
    return symosc.certify(branch, progress=True)


def _print_certificate(certificate: symosc.Certificate) -> None:
    """Print tables of events and derivatives, the multipliers, and what is proven."""
    # An event is its kind, the modes before and after it and, unless it is one of a branch, bounds
    # of time and position: on a branch these depend on the parameter.
    timed = [event for event in certificate.events if len(event) > 3]
    if timed:
        rows = [
            [common_digits(*t_bounds), common_digits(*x_bounds), kind, f"{old} -> {new}"]
            for kind, old, new, t_bounds, x_bounds in timed
        ]
        output.write_table(rows, ["t", "x", "kind", "from -> to"])
        output.write("")
    if certificate.derivatives:
        rows = [
            [common_digits(*bounds) for bounds in (*dt, *dx)] for dt, dx in certificate.derivatives
        ]
        names = certificate.statement["wrt"]
        heads = [f"d{coordinate}/d{name}" for coordinate in "tx" for name in names]
        output.write_table(rows, heads)
        output.write("")
    for i, multiplier in enumerate(certificate.multipliers, 1):
        output.write(f"multiplier {i}: {common_complex(*multiplier)}")
    if certificate.proven:
        output.write(f"proven: {certificate.message}")


@click.command()
@click.argument("file")
@option("--bytes N", "Largest file. Default: 10,000,000.", type=options.WholeNumber(1))
@option("--events N", "Most events and boxes. Default: 50,000.", type=options.WholeNumber(1))
@option("--steps N", "Most steps of the proof. Default: 2,000,000.", type=options.WholeNumber(1))
def verify(file: str, **limits: int | None) -> int:
    """Prove the file of a certificate again, and print what is proven.

    The checker is symosc/certificates/verify.py, with verify_orbits.py beside it for orbits,
    branches and atlases. They need python-flint and nothing of symosc: copy them, read them, and
    run them alone. Exit codes: 0 proven, 1 false or not proven, 2 no certificate.

    \b
    Examples:
      symosc verify fig8.json
    """
    try:
        from symosc.certificates import verify_orbits
    except ImportError:
        raise MissingExtraError("verify", "certify") from None
    given_limits = {name: limit for name, limit in limits.items() if limit is not None}
    code, answer = verify_orbits.verify(file, **given_limits)
    if code:
        output.complain(answer)
    else:
        output.write(answer)
    return code
