"""The events of a scene as a reference to measure others against: proven, or why not."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from symosc.aliases import Number
from symosc.certificates.certificate import proven_rows
from symosc.certificates.certify import certify
from symosc.errors import MissingExtraError
from symosc.scenes import Scene


class ProvenMiddle(NamedTuple):
    """A proven event: the middles of its enclosures, which have at least 24 digits, and what it is."""

    t: Number
    x: Number
    kind: str
    boundary: int


class Known(NamedTuple):
    """The proven events of a scene; or none, and why they are not proven."""

    events: tuple[ProvenMiddle, ...]
    reason: str = ""


def known_events(scene: Scene) -> Known:
    """Return the events of a scene from its certificate, as fractions, or say why it has none.

    Of a motion that settles on an orbit they are those of its last periods.
    """
    try:
        certificate = certify(scene)
    except MissingExtraError as error:
        return Known((), str(error))
    if not certificate.proven:
        return Known((), certificate.message)
    events = (
        ProvenMiddle(_middle(r["t"]), _middle(r["x"]), r["kind"], r["boundary"]) for r in proven_rows(certificate)
    )
    return Known(tuple(events))


def _middle(ends: list[str]) -> Fraction:
    low, high = map(Fraction, ends)
    return (low + high) / 2
