"""The paper's claims with their evidence: each check is run once in a session.

The environment variable SYMOSC_REPORT names a report that was just made: its evidence is taken.
"""

from __future__ import annotations

import json
import os
import pickle
from functools import cache
from pathlib import Path
from typing import Any

from once import SHARED, alone

from symosc.paper.checks import motions
from symosc.paper.claims import Claim, Evidence, read_claims
from symosc.paper.pictures import PICTURES


@cache
def claims() -> tuple[Claim, ...]:
    """Return all claims."""
    return read_claims(PICTURES)[0]


@cache
def reported(folder: str) -> dict[str, Evidence]:
    """Return the evidence for all claims of a report by their ids."""
    content = json.loads((Path(folder) / "report.json").read_text(encoding="utf-8"))
    return {
        row["id"]: Evidence(row["verdict"], row["finding"], row["numbers"])
        for row in content["claims"]
    }


def judged(check: Any) -> Evidence:
    """Return what `judge` finds.

    The first process that asks runs the check, the others wait and read it.
    """
    if SHARED not in os.environ:  # outside of a test session
        return motions.judge(check)
    called = check.func, check.args
    name = next(each.id for each in claims() if (each.check.func, each.check.args) == called)  # type: ignore[attr-defined]
    if made := os.environ.get("SYMOSC_REPORT"):
        return reported(made)[name]
    with alone(f"claim-{name}") as path:
        if not path.exists():
            path.write_bytes(pickle.dumps(motions.judge(check)))
        evidence: Evidence = pickle.loads(path.read_bytes())
    return evidence


def evidence_of(part: str) -> dict[str, Evidence]:
    """Return the evidence for the claims of one part of the report by their ids."""
    return {claim.id: judged(claim.check) for claim in claims() if claim.part == part}
