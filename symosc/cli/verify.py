"""The command `symosc verify`."""

from __future__ import annotations

import click

from symosc.cli.output import complain, write
from symosc.errors import MissingExtraError


@click.command()
@click.argument("file")
def verify(file: str) -> int:
    """Prove a certificate file once more, by other means than `symosc certify`.

    The checker is symosc/certificates/verify.py, and verify_orbits.py beside it for orbits and windows. They need
    python-flint and nothing of symosc: copy them, read them, and run them alone. Exit codes: 0 proven, 1 false or not
    proven, 2 no certificate.

    \b
    Example:
      symosc verify fig8.json
    """
    try:
        from symosc.certificates.verify_orbits import verify as prove
    except ImportError:
        raise MissingExtraError("verify", "certify") from None
    code, line = prove(file)
    if code:
        complain(f"{line}")
    else:
        write(line)
    return code
