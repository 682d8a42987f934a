"""Certificates that the evidence cites: what is proven about a motion or an orbit, with balls for numbers."""

from __future__ import annotations

from symosc.certificates.certify import certify
from symosc.errors import MissingExtraError
from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.scenes import Scene

CERTIFICATE = "certificate (symosc certify)"


def certificate_of(what: Scene | PeriodicOrbit) -> dict[str, str]:
    """Return what a certificate of a motion or an orbit says, for the numbers of an evidence.

    Without python-flint it says that nothing is proven here; the verdict does not rest on it.
    """
    try:
        proof = certify(what)
    except MissingExtraError:
        return {CERTIFICATE: "none here: python-flint is not installed"}
    return {CERTIFICATE: f"{'proven' if proof.proven else 'not proven'}: {proof.message}"}
