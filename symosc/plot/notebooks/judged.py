"""Pages of what was judged: a solution of somebody else's, and a proof."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

from markupsafe import Markup

from symosc.aliases import Record
from symosc.certificates.certificate import Certificate, common_complex, common_digits
from symosc.crosschecks.report import CrossCheck
from symosc.display.html import curve, ends, facts, page, table


def crosscheck_page(check: CrossCheck) -> str:
    """Return the page of a comparison: its findings, and the samples with what is wrong in them."""
    strange = [("missed", event) for event in check.missed] + [("invented", event) for event in check.invented]
    rows = [[what, event.kind, event.boundary or "", float(event.t)] for what, event in strange]
    lines = Markup('<pre style="margin:0;white-space:pre-wrap">{}</pre>').format(check.summary())
    wrong = check.wrong_steps[:20].tolist()
    marks = [(float(check.t[step]), float(check.x[step])) for step in wrong]
    drawn = curve("the samples' x against t; dots are wrong steps", check.t, check.x, marks)
    found = table(("", "kind", "belt", "t"), rows) if rows else ""
    line = f"{'ok' if check.ok else 'FAILED'}, {len(check.t):,} samples"
    return page("CrossCheck", line, found, drawn, lines)


def certificate_page(certificate: Certificate) -> str:
    """Return the page of a proof: what is proven, and the enclosures."""
    said = "proven" if certificate.proven else "not proven"
    line = f"{certificate.kind}, {said}: {certificate.message}"
    events = certificate.events
    rows = [_event(events[i]) for i in ends(len(events))]
    heads = ("kind", "from", "to", "t", "x", "width of t", "width of x")[: len(rows[0]) if rows else 0]
    about: Record = {f"multiplier {i}": common_complex(*each) for i, each in enumerate(certificate.multipliers, 1)}
    about |= {"stable": None if certificate.stable is None else "yes" if certificate.stable else "no"}
    about |= {name: certificate.statement.get(key) for name, key in (("made by", "made_by"), ("map", "map"))}
    return page("Certificate", line, table(heads, rows, len(events)) if rows else "", facts(about))


def _event(event: tuple[Any, ...]) -> list[str]:
    """Return an event as a row; the events of a branch have no enclosures of their own."""
    enclosures = event[3:]
    widths = (f"{float(Decimal(high) - Decimal(low)):.0e}" for low, high in enclosures)
    return [*event[:3], *(common_digits(*each) for each in enclosures), *widths]
