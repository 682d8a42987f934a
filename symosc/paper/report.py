"""The report on a run: data for machines (JSON), and one HTML file that needs nothing else."""

from __future__ import annotations

import json
import os
import re
from base64 import b64encode
from collections.abc import Callable, Mapping
from dataclasses import asdict
from html import escape
from pathlib import Path
from typing import Any
from unicodedata import normalize

from markupsafe import Markup

from symosc.base.display.pages import render
from symosc.base.errors import OutputError
from symosc.base.files import draft_in
from symosc.bench import machine
from symosc.derive.chapters import CHAPTERS
from symosc.derive.citation import paper_reference
from symosc.derive.errata import SEVERITIES
from symosc.derive.mathml import font_style
from symosc.paper.claims import (
    CONFIRMED,
    CORRECTED,
    DEFINITION,
    NOT_AS_PRINTED,
    PARTS,
    UNDECIDED,
)
from symosc.paper.run import ERROR, Done, Results

TEMPLATE = "paper/templates/report.html.j2"
#: A word of its own for each verdict (used as a class name), and its sign: colour is never alone.
BADGES = {
    CONFIRMED: ("confirmed", "✓"),
    DEFINITION: ("definition", "≡"),
    CORRECTED: ("corrected", "±"),
    NOT_AS_PRINTED: ("misprinted", "✗"),
    UNDECIDED: ("undecided", "?"),
    ERROR: ("failed", "!"),
}
#: Words and symbols that the findings use without explaining them each time.
NUMBER_MEANINGS = {
    "F(1), F(2), F(3)": "The acceleration in each domain, eq. (9); F⁽ˡᵒ⁾ and F⁽ʰⁱ⁾ are those "
    "below and above a belt.",
    "G⁽⁰⁾, G⁽¹⁾, G⁽²⁾, …": "F and its derivatives along the flow; G(1,2) is the first one in "
    "domain 2.",
    "P1 to P8": "The motions from one contact with a belt to the next, Fig. 4. P32 is P2, then P3.",
    "stick, slip, graze": "The mass begins to move with a belt; it leaves that belt; its "
    "velocity touches a belt's and "
    "returns.",
    "rational or exact contact": "Parameters, place and the sine and cosine of the phase are "
    "rational numbers: what "
    "happens there is decided exactly, without rounding.",
    "exact start": "A start with 40 digits from which the motion grazes at a round phase; it "
    "rounds to the printed one "
    "(in Fig. 8 up to the last digit).",
    "by definition": "The paper lays it down, and this program as well: there is nothing to find "
    "out.",
    "flown again": "Every stretch of a motion computed once more by another closed form in "
    "doubles, and what follows "
    "each contact decided by Theorems 4 and 5.",
    "residual": "What is left of an equation, 0 in theory, where computed numbers are put in.",
    "DOP853": "A Runge-Kutta method of order 8 in SciPy, as a second opinion.",
}
FIGURES = "figures"


def data(results: Results) -> dict[str, Any]:
    """Return all results of a run as plain data, the content of report.json."""
    plan = results.plan
    return {
        "paper": paper_reference(),
        "ok": results.ok,
        "counts": results.counts,
        "errata": [asdict(e) | {"claims": results.shown_by(e)} for e in plan.errata],
        "unjudged": [part._asdict() for part in plan.unjudged or ()],
        "changed": [judged.claim.id for judged in results.changed],
        "failures": results.failures,
        "made": {"seconds": round(results.seconds, 1), **machine()},
        "claims": [
            {name: value for name, value in judged.claim._asdict().items() if name != "check"}
            | {name: getattr(judged, name) for name in ("verdict", "finding", "numbers")}
            | {"committed": judged.claim.verdict, "seconds": round(judged.seconds, 3)}
            for judged in results.judged
        ],
        "figures": [
            {name: getattr(picture, name) for name in ("key", "title", "alt", "paper_figure")}
            | {
                "caption": done.value.caption if done.value else "",
                "file": f"{FIGURES}/{picture.key}.svg" if done.value else None,
                "claims": [claim.id for claim in plan.claims if picture.key in claim.figures],
                "seconds": round(done.seconds, 3),
            }
            for picture, done in zip(plan.pictures.values(), results.drawn.values(), strict=True)
        ],
        "derivations": [
            {
                "subject": subject,
                "number": number,
                "title": CHAPTERS[subject],
                "steps": _step_count(done),
                "file": f"report.html#derivation-{number}" if done.value else None,
                "claims": [claim.id for claim in plan.claims if claim.derivation == subject],
                "seconds": round(done.seconds, 3),
            }
            for number, subject in enumerate(CHAPTERS, 1)
            if (done := results.chapters.get(subject))
        ],
    }


def _step_count(chapter: Done) -> int:
    """Return the number of steps of a chapter of derivations, 0 if it failed."""
    if not chapter.value:
        return 0
    steps, _ = chapter.value
    return int(steps)


def files(results: Results) -> dict[str, str]:
    """Return the text of every file of the report by its path in the folder."""
    content = data(results)
    plan = results.plan
    drawn = {key: done.value for key, done in results.drawn.items() if done.value}
    # Pictures that belong to one figure of the paper stand together: fig7, fig7-corrected and
    # fig7-exact.
    groups: dict[str, list[dict[str, Any]]] = {}
    for figure in content["figures"]:
        number, _, _ = figure["key"].removeprefix("fig").partition("-")
        groups.setdefault(number, []).append(figure)
    context = content | {
        "parts": {
            part: PARTS[part] for part in PARTS if any(claim.part == part for claim in plan.claims)
        },
        "badges": BADGES,
        "groups": groups,
        "words": NUMBER_MEANINGS,
        "severities": SEVERITIES,
        "erratum_numbers": {erratum.id: erratum.number for erratum in plan.errata},
        "drawn": drawn,
        "chapters": results.chapters,
        "font_style": Markup(font_style()),
    }
    texts = {f"{FIGURES}/{key}.svg": picture.svg for key, picture in drawn.items()}
    texts["report.html"] = render(TEMPLATE, context, FILTERS)
    texts["report.json"] = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    return texts


def write(folder: Path, texts: Mapping[str, str]) -> None:
    """Write the files of a report; only when all are on the disk are they moved to their places."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with draft_in(folder) as draft:
            draft.mkdir()
            for name, text in texts.items():
                (draft / name).parent.mkdir(exist_ok=True)
                (draft / name).write_text(text, encoding="utf-8")
            for name in texts:
                (folder / name).parent.mkdir(exist_ok=True)
                os.replace(draft / name, folder / name)
    except OSError as error:
        raise OutputError(str(folder), error.strerror or str(error)) from None


def data_uri(svg: str) -> str:
    """Return a picture as an address that holds all of it."""
    return f"data:image/svg+xml;base64,{b64encode(svg.encode()).decode('ascii')}"


def typeset_html(text: str) -> Markup:
    """Return running text with its formulas as HTML."""
    return Markup(typeset(text))


#: What the template calls to fill in texts and pictures.
FILTERS = {"typeset": typeset_html, "data_uri": data_uri}


# --- short formulas in running text, such as F(1) >= -mu1 FN or 1.2e-30, as HTML ---

_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "theta": "θ", "lambda": "λ", "mu": "μ", "pi": "π",
    "tau": "τ", "omega": "ω", "Theta": "Θ", "Sigma": "Σ", "Omega": "Ω",
}  # fmt: skip
_SIGNS = {
    ">=": "≥",
    "<=": "≤",
    "!=": "≠",
    "->": "→",
    "+-": "±",
    "x'''": "x‴",
    "x''": "ẍ",
    "x'": "ẋ",
    " - ": " − ",
}
_LETTER = r"(?<![^\W_\d])([A-Za-zα-ωΑ-Ωẋẍ])"  # alone, not the end of a word
_RAISED = "[⁰¹²³⁴-⁹⁺⁻⁼⁽⁾ʰⁱˡⁿᵅᵒ]+"
_LOWERED = "[₀-₉₊₋₌₍₎ₐ-ₜᵢ-ᵥⱼ]+"
_Replacement = str | Callable[[re.Match[str]], str]
_PLAIN: list[tuple[str, _Replacement]] = [
    # Names that are for the command line.
    (r"\bfig(\d+)\b(?!-)", "Fig.\u00a0\\1"),
    (r"\bfig(\d+)-(\w+)", "Fig.\u00a0\\1 (\\2)"),
    (r"\bbelt([12])\b", "belt\u00a0\\1"),
    (rf"(?<![A-Za-z])({'|'.join(_GREEK)})(?![A-Za-z])", lambda found: _GREEK[found[1]]),
    (r"(?<![A-Za-z])oo\b", "∞"),
    (r" = (?=[\w.…−-]{1,16}(?![\w.…]))", "\u00a0=\u00a0"),  # a short equation stays on its line
    (r"(^|[\s(\[{=<>≤≥≠,;:|/·])-(?=[\w.(∞])", r"\1−"),
    (r"−(?=\()", "−\u2060"),  # no line ends with a sign
    (r"\|(\w[^|\s]{0,6})\|", "|\u2060\\1\u2060|"),  # nor with the first bar of an absolute value
]
_MARKED: list[tuple[str, _Replacement]] = [
    (r"\b(\d(?:\.\d+)?)e([+-]?)0*(\d+)\b", lambda found: (
        f"{'' if found[1] == '1' else f'{found[1]}·'}10<sup>{'−' if found[2] == '-' else ''}{found[3]}</sup>"
    )),
    (_LETTER + r"\^(?:\{([^{}]+)\}|\(([^()]+)\)|(\w))", lambda found: (
        f"{found[1]}<sup>{found[2] or found[4] or (f'({found[3]})' if found[1] in 'FG' else found[3])}</sup>"
    )),
    (_LETTER + r"((?:<sup>.*?</sup>)?)_(?:\{([^{}]+)\}|(\([^()]+\)|\w+))", lambda found: (
        f"{found[1]}{found[2]}<sub>{found[3] or found[4]}</sub>"
    )),
    (r"\b(d?[FG])\((\d(?:, ?[\dα])?)\)", r"\1<sup>(\2)</sup>"),
    (_LETTER + r"(\d+)(?!\w|\.\d|<)", r"\1<sub>\2</sub>"),
    (r"(?<![A-Za-z])FN\b", "F<sub>N</sub>"),
    # The raised and lowered characters of Unicode look the same.
    (_RAISED, lambda found: f"<sup>{normalize('NFKC', found[0]).replace('ɑ', 'α')}</sup>"),
    (_LOWERED, lambda found: f"<sub>{normalize('NFKC', found[0])}</sub>"),
]  # fmt: skip


def typeset(text: str) -> str:
    """Return a text as HTML, with symbols, signs, indices and powers set typographically."""
    for sign, replacement in _SIGNS.items():
        text = re.sub(
            rf"(?<![\w]){re.escape(sign)}" if sign[0] == "x" else re.escape(sign), replacement, text
        )
    for pattern, plain in _PLAIN:
        text = re.sub(pattern, plain, text)
    text = escape(text, quote=False)
    for pattern, marked in _MARKED:
        text = re.sub(pattern, marked, text)
    return text
