"""The command `symosc verify`."""

from __future__ import annotations

import click

from symosc.cli.output import complain, write
from symosc.display.progress import bar
from symosc.errors import MissingExtraError


@click.command()
@click.argument("file", required=False)
@click.option("--orbits", "listed", is_flag=True, help="Certify and verify the list of orbits that ships.")
@click.option("--bytes", "size", metavar="N", type=click.IntRange(1), help="Largest file. Default: 10,000,000.")
@click.option("--events", metavar="N", type=click.IntRange(1), help="Most events and boxes. Default: 50,000.")
@click.option("--steps", metavar="N", type=click.IntRange(1), help="Most steps of the proof. Default: 2,000,000.")
def verify(file: str | None, *, listed: bool, size: int | None, events: int | None, steps: int | None) -> int:
    """Prove a certificate file once more, by other means than `symosc certify`, and print what is proven.

    The checker is symosc/certificates/verify.py, with verify_orbits.py beside it for orbits and branches. They need
    python-flint and nothing of symosc: copy them, read them, and run them alone. Exit codes: 0 proven, 1 false or not
    proven, 2 no certificate.

    \b
    Examples:
      symosc verify fig8.json
      symosc verify --orbits
    """
    if (file is None) != listed:
        raise click.UsageError("--orbits verifies its own list; give no file" if listed else "Missing argument 'FILE'.")
    try:
        from symosc.certificates import verify_orbits
    except ImportError:
        raise MissingExtraError("verify", "certify") from None
    if file is None:
        return _list()
    limits = {name: most for name, most in (("bytes", size), ("events", events), ("steps", steps)) if most is not None}
    code, answer = verify_orbits.verify(file, **limits)
    if code:
        complain(answer)
    else:
        write(answer)
    return code


def _list() -> int:
    from symosc.certificates.orbit_list import listed_orbits, verify_list

    count = len(listed_orbits())
    with bar("proven again", count, "orbits") as report:
        answers = verify_list(progress=report)
    wrong = [answer for answer in answers if answer]
    write(f"proven again: {count - len(wrong)} of {count} orbits")
    for line in wrong:
        click.echo(f"symosc: {line}", err=True)
    return 1 if wrong else 0
