"""The paper: findings on its motions and on others, pictures and captions, the report and the letter."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import partial
from typing import Any
from unittest.mock import patch

import paper_motions as other
import paper_statements
from judging import claims, evidence_of
from stored_outputs import lines_of, lines_of_figure

from symosc import load_scene
from symosc.derive.chapters import CHAPTERS
from symosc.derive.errata import read_errata
from symosc.paper import figures, report
from symosc.paper.checks import exact, grazes, motions, orbits
from symosc.paper.claims import (
    CONFIRMED,
    NOT_AS_PRINTED,
    PARTS,
    UNDECIDED,
    Claim,
    Evidence,
    Unjudged,
)
from symosc.paper.pictures import PICTURES, Picture, printed_view, stick_signs
from symosc.paper.run import ERROR, Done, Drawn, Judged, Plan, Results
from symosc.plot.panels import Contact

ERRATA = tuple(erratum.in_unicode() for erratum in read_errata())


def picture(key: str) -> str:
    """Return what a picture shows, and its caption.

    Of the form for phones only where the panels stand.
    """
    found = PICTURES[key]
    lines = [found.title, found.alt, found.describe(), *lines_of_figure(found.build())]
    if found.narrow:
        drawing = found.narrow()
        specs = [axes.get_subplotspec() for axes in drawing.axes]
        rows = [
            f"row {each.rowspan.start} of {each.get_gridspec().get_height_ratios()}"
            for each in specs
        ]
        lines += [next(lines_of_figure(drawing)), *rows]
    return "\n".join(lines)


# --- a report on claims that are made up ---


def claim(name: str, verdict: str, **more: Any) -> Claim:
    """Return a claim that is made up."""
    part = more.pop("part", "model")
    source = more.pop("source", "Section 2, eqs. (1), (3) to (5)")
    return Claim(name, part, source, f"says {name} < 1e-9 at fig5", partial(str), verdict, **more)


def results(whole: bool) -> Results:
    """Return results in which claims and pictures of every kind are, changed and failed ones too."""
    one = ERRATA[0]
    two = ERRATA[4]
    faulty: dict[str, Any] = {"correction": "x'' >= -mu1 FN", "errata": (one.id,)}
    found = [
        (
            claim("one", CONFIRMED, figures=("fig1",), derivation="events", remark="F_N > 0"),
            CONFIRMED,
        ),
        (claim("two", NOT_AS_PRINTED, **faulty), NOT_AS_PRINTED),
        (claim("three", NOT_AS_PRINTED, part="figures", source="Fig. 5", **faulty), CONFIRMED),
        (claim("four", UNDECIDED, part="figures", source="Abstract"), UNDECIDED),
        (claim("five", NOT_AS_PRINTED, correction="no", errata=(two.id,)), ERROR),
    ]
    judged = [
        Judged(
            each, verdict, f"Is <{each.id}>, 2e-20 | F^(1).", {"x_0 | a": "1e-20", "b": "-3"}, 0.5
        )
        for each, verdict in found
    ]
    pictures = {
        key: Picture(key, f"Fig. {key[3]}: a {key}", f"A {key}.", 1, figures.fig1, partial(str, ""))
        for key in ("fig1", "fig1-exact", "fig2")
    }
    plan = Plan(tuple(each for each, _ in found), pictures, ("events", "maps"), (one, two))
    if whole:
        plan = replace(plan, unjudged=(Unjudged("Section 3", "is well known", "a judgement"),))
    drawn = {
        "fig1": Done(Drawn("<svg>wide</svg>", "Is *x_0*.", "<svg>narrow</svg>"), seconds=1.0),
        "fig1-exact": Done(Drawn("<svg>both</svg>", "At v1.")),
        "fig2": Done(error="ValueError: no such curve"),
    }
    chapters = {
        "events": Done((7, "<p>chapter</p>"), seconds=2.0),
        "maps": Done(error="StepError: wrong"),
    }
    return Results(plan, tuple(judged), drawn, chapters, 3.0)


def part_of_plan(prefix: str) -> list[list[str]]:
    """Return what a plan does for the claims whose ids begin so."""
    part = Plan(claims(), PICTURES, tuple(CHAPTERS), ERRATA, ()).only(prefix)
    return [
        [each.id for each in (*part.claims, *part.errata)],
        [*part.pictures],
        [*part.chapters],
        [str(len(part))],
    ]


def shown_report(whole: bool) -> str:
    """Return the files of a report without their style and the list of words."""
    lines = []
    made = {"date": "then", "symosc": "this"}
    with patch.object(report, "machine", lambda: made):
        texts = report.files(results(whole))
    data = json.loads(texts.pop("report.json"))
    for name, text in texts.items():
        kept = re.sub(r"<style>.*?</style>|<dl>.*?</dl>", "", text, flags=re.DOTALL).splitlines()
        lines += [f"--- {name}", *(line for line in kept if line.strip())]
    return "\n".join([*lines, *lines_of(data)])


TYPESET = [
    "F(1) >= -mu1 FN, x'' <= 1.2e-30 and x' != 0", "a -> b +- c - d", "fig5, fig7-exact and belt2 at Omega t = 2 pi",
    "(-oo, v1] is -1, or [-2.5; alpha_beta", "F^(1) and x^(2), e^{-ct/2m}, y^2 and G(1,2), dF(2)", "P32, x12 and v1.5",
    "|x| < 3, -(a + b)", "1e5, 3.20e-07 and 1e+3", "tₘ₋ and G⁽⁰⁾, F⁽ˡᵒ⁾, F^(α)_{ij}", "x''' < b & c",
]  # fmt: skip


def contact_text(contact: exact.RationalContact) -> list[object]:
    """Return all that a rational contact says."""
    own = [
        [f(alpha) for alpha in contact.domains]
        for f in (contact.slope, contact.grazes, contact.derivatives)
    ]
    return [str(contact), contact.forces, contact.goes_on, contact.sticks, contact.passes, own]


def nearest(**change: str) -> grazes.NearestGraze:
    """Return the grazing start next to a start of Fig. 8."""
    return grazes.nearest_graze(other.changed(grazes.FIG8.scene, **change), "P3")


def found_again(scene: Any, *names: str) -> list[Any]:
    """Return the values of numbers of a scene with which it grazes, and what they are in short."""
    found = [each for name in names for each in grazes.values_that_graze(scene, "P2", name)]
    return [
        *((each, each.shortest, each.as_short_as_printed) for each in found),
        grazes.misprints(scene, found),
    ]


def other_evidence(name: str) -> Evidence:
    """Return the evidence of a check for another motion than the paper's."""
    check, expected = other.OTHER[name]
    found = motions.judge(check)
    assert found.verdict == expected
    return without_certificate(found)


def without_certificate(found: Evidence) -> Evidence:
    """Leave out what an optional package says."""
    return replace(
        found,
        numbers={
            name: text for name, text in found.numbers.items() if "symosc certify" not in name
        },
    )


def short(found: Evidence) -> list[str]:
    """Return evidence without the names of its numbers."""
    return [found.verdict, found.finding, *found.numbers.values()]


def other_statements() -> list[list[str]]:
    """Return the evidence if the paper says something else than it does."""
    return [
        short(paper_statements.evidence(number))
        for number in range(len(paper_statements.STATEMENTS))
    ]


def found_on(part: str) -> dict[str, Evidence]:
    """Return the evidence for the claims of one part of the report."""
    return {name: without_certificate(found) for name, found in evidence_of(part).items()}


CASES: dict[str, Callable[[], object]] = {
    f"claims on {part}": partial(found_on, part) for part in PARTS
}
CASES |= {f"other motions: {name}": partial(other_evidence, name) for name in other.OTHER}
CASES |= {"other statements": other_statements}
CASES |= {key: partial(picture, key) for key in PICTURES}
CASES |= {
    "a whole report": lambda: shown_report(True),
    "a part of the report": lambda: shown_report(False),
    "a part of a plan": lambda: part_of_plan("fig7"),
    "formulas in text": lambda: "\n".join(map(report.typeset, TYPESET)),
    "rational contacts": lambda: [
        contact_text(each) for belt in (1, 2) for each in exact.contacts(belt, 6, 3)
    ],
    "nearest graze": lambda: [nearest(), nearest(x0="5.9"), nearest(t0="0.3")],
    "what makes Fig. 7 graze": lambda: found_again(load_scene("fig7"), "A0", "x0", "t0", "v1"),
    "search for the start of Fig. 9": lambda: orbits.search_start(motions.PRINTED[4]),
    "search for Omega of Fig. 9": lambda: orbits.search_parameters(motions.PRINTED[4], ("Omega",)),
    "no stick in a caption": lambda: stick_signs(printed_view("fig5"), [Contact(0.5, 3.0, 1)]),
    "sides of contacts": lambda: [
        each.side(alpha, after)
        for each in exact.contacts(1, 60, 4)
        for alpha in (1, 2)
        for after in (False, True)
    ],
    "a force of Fig. 2": lambda: [
        exact.friction_on_mass(motions.FIG5.parameters, alpha) for alpha in (1, 2, 3)
    ],
    "flow of a system with equal roots": lambda: exact.flow(
        load_scene("fig7").parameters.replace(k=1), Fraction(3), (0, 1, 2), [0.5, 2.0]
    ),
}
