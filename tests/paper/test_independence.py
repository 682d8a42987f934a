"""No claim is judged by the simulator alone: what looks at a motion also names what it was compared with."""

from __future__ import annotations

import random
import re

import pytest

from symosc.orbits.periodic_orbit import PeriodicOrbit
from symosc.paper.claims import Claim, read_claims
from symosc.paper.evidence import DEFINITION, Evidence
from symosc.paper.pictures import PICTURES
from symosc.simulation.trajectory import Trajectory

CLAIMS = read_claims(PICTURES)
#: How evidence names its other source: another closed form, exact rational decisions, an integrator, a bound.
INDEPENDENT = re.compile(r"another closed form|exact flow|exact contacts|rational contacts|DOP853|residual")


def flown_again(claim: Claim) -> bool:
    """Tell whether a second opinion is put into the evidence by the decorator."""
    return hasattr(claim.check, "__wrapped__")


OTHERS = [claim for claim in CLAIMS if not flown_again(claim)]
QUICK = {claim.id for claim in random.Random(14).sample(OTHERS, 3)} | {"stick-exit-belt-1"}


def sources(evidence: Evidence) -> list[str]:
    """Return the names of the numbers that tell of another source."""
    return [name for name, value in evidence.numbers.items() if INDEPENDENT.search(f"{name} {value}")]


def test_claims_on_motions_are_flown_again() -> None:
    """All claims on Figs. 5 to 10, but for the searches for a misprint, which name their sources below."""
    on_motions = {claim.id for claim in CLAIMS if re.match(r"fig(?:5|6|7|8|9|10)-", claim.id)}
    others = {claim.id for claim in OTHERS} & on_motions
    assert len(on_motions) > 40
    assert others <= {"fig7-parameters-graze", "fig7-start", "fig8-start", "fig9-start", "fig10-start"}


@pytest.mark.parametrize(
    "claim",
    [pytest.param(claim, id=claim.id, marks=[pytest.mark.slow] * (claim.id not in QUICK)) for claim in OTHERS],
)
def test_other_claims_that_look_at_motions_name_another_source(claim: Claim, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    for kind in (Trajectory, PeriodicOrbit):
        first = kind.__init__

        def noted(self: object, *given: object, first: object = first, **named: object) -> None:
            made.append(type(self).__name__)
            first(self, *given, **named)  # type: ignore[operator]

        monkeypatch.setattr(kind, "__init__", noted)
    evidence = claim.check()
    if made and evidence.verdict != DEFINITION:
        assert sources(evidence), (claim.id, made[:3], list(evidence.numbers))
