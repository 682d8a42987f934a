"""A letter to the authors: the distinct errata, each with a short proof, on one page."""

from __future__ import annotations

from datetime import date
from typing import Any

from symosc import __version__
from symosc.derive.citation import paper_reference
from symosc.derive.errata import SEVERITIES
from symosc.paper.rendering import render
from symosc.paper.run import Results


def texts(results: Results) -> dict[str, str]:
    """Return the letter as HTML and as plain text, by file name; it has the errata that this run has shown."""
    shown = [erratum for erratum in results.errata if results.shown_by(erratum)]
    held = [each for each in results.judged if not each.claim.errata]
    context: dict[str, Any] = {
        "paper": paper_reference(),
        "errata": shown,
        "numbers": {severity: sum(each.severity == severity for each in shown) for severity in SEVERITIES},
        "held": len(held),
        "judged": len(results.judged),
        "version": __version__,
        "date": date.today().isoformat(),
    }
    return {f"letter.{kind}": render(f"letter.{kind}.j2", context) for kind in ("html", "txt")}
