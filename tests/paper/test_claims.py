"""The claims: complete, refused with a reason where they are wrong, covering the paper, and added as documented."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from project_files import ROOT
from stand_in_claims import CLAIM

from symosc.derive.errata import SEVERITIES, RecordsError, read_errata
from symosc.paper import checks
from symosc.paper.checks.motions import judge
from symosc.paper.claims import (
    CONFIRMED,
    DEFINITION,
    FAULTY,
    PAPER,
    items_of,
    read_claims,
)
from symosc.paper.pictures import PICTURES

CLAIMS, UNJUDGED = read_claims(PICTURES)
FOUND = [erratum.in_unicode() for erratum in read_errata()]


def test_every_figure_is_shown_by_a_claim() -> None:
    assert {key for claim in CLAIMS for key in claim.figures} == set(PICTURES)
    assert {picture.paper_figure for picture in PICTURES.values()} == {None, *range(1, 11)}


def test_every_check_is_named_in_the_claims() -> None:
    """A function that returns an Evidence and is not called by another one is a check."""
    called = {(claim.check.func.__module__, claim.check.func.__name__) for claim in CLAIMS}  # type: ignore[attr-defined]
    for path in Path(checks.__file__).parent.glob("*.py"):
        source = path.read_text(encoding="utf-8")
        for node in ast.parse(source).body:
            if (
                isinstance(node, ast.FunctionDef)
                and ast.unparse(node.returns or ast.Constant(0)) == "Evidence"
            ):
                used = len(re.findall(rf"\b{node.name}\(", source)) > 1 or node.name == "judge"
                assert used or (f"{checks.__name__}.{path.stem}", node.name) in called, node.name


# --- wrong claims ---


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        (
            "source = ",
            "sauce = ",
            "has sauce, says, check; must have source, says, and may have check, see",
        ),
        ("says", 'verdict = "true"\nsays', "verdict = 'true': must be one of confirmed, "),
        (
            "says",
            'verdict = "not as printed"\nsays',
            "must have a correction and see an erratum if its verdict is",
        ),
        (
            "says",
            'verdict = "confirmed"\ncorrection = "no"\nsays',
            "must have a correction and see an erratum",
        ),
        ("says", 'see = ["fig11"]\nsays', "see = 'fig11': must be one of fig1, motion, "),
        ("says", 'see = ["motion", "maps"]\nsays', "one chapter at most, not motion and maps"),
        ('"1 < 2"', "3", "says = 3: must be text"),
        (
            "stand_ins.right",
            "stand_ins.left",
            "check = 'stand_ins.left': there is no such function",
        ),
        ("stand_ins.right", "stand_ins.given(NUMBER", "there is no such function, or value"),
        ("one]", "One]", "must be kebab case"),
        ("model.", "preface.", "part = 'preface': must be one of model"),
        ("[model.one]", "[unjudged]", "must be a place, and a reason"),
    ],
)
def test_a_wrong_claim_is_refused(read: Any, old: str, new: str, complaint: str) -> None:
    text = CLAIM.format(id="one", check="right")
    assert read(text)
    with pytest.raises(RecordsError, match=re.escape(complaint)):
        read(text.replace(old, new))


def test_claims_are_in_order_and_unique_and_give_arguments(read: Any) -> None:
    text = CLAIM.format(id="two", check="right").replace("model", "theorems")
    first = CLAIM.format(id="one", check="given(NUMBER, 'a')")
    one, two = read(text + first)
    assert (one.id, two.id) == ("one", "two")
    assert judge(one.check).numbers == {"number": "9", "letter": "a"}
    with pytest.raises(RecordsError, match="claim one: is in model already"):
        read(text.replace("two", "one") + first)


# --- coverage and errata ---


def coverage(entries: Iterable[Any]) -> dict[str, list[Any]]:
    """Return for each section, equation, theorem and so on of the paper the entries about it."""
    about: dict[str, list[Any]] = {item: [] for item in PAPER}
    for entry in entries:
        for item in items_of(entry.source):
            about[item].append(entry)
    return about


def test_each_erratum_is_shown_by_claims_and_no_other_claim_has_one() -> None:
    assert {key for claim in CLAIMS for key in claim.errata} == {erratum.id for erratum in FOUND}
    for claim in CLAIMS:
        assert bool(claim.errata) == (claim.verdict in FAULTY), claim.id
        assert claim.remark is None or claim.verdict in (CONFIRMED, DEFINITION), claim.id
    assert {erratum.severity for erratum in FOUND} == set(SEVERITIES)
    assert (
        len({erratum.printed for erratum in FOUND})
        == len(FOUND)
        < sum(claim.verdict in FAULTY for claim in CLAIMS)
    )
    first = [
        item
        for erratum in FOUND
        for item in items_of(erratum.where)[:1]
        if PAPER[item] == "equation"
    ]
    assert first == sorted(first, key=list(PAPER).index)
    for erratum in FOUND:
        assert max(len(erratum.proof), len(erratum.printed) + len(erratum.holds)) <= 340, erratum.id


# --- extension points, as CONTRIBUTING says, in a copy of the package ---


@pytest.mark.slow
def test_a_claim_and_a_figure_are_added_as_contributing_says(tmp_path: Path) -> None:
    paper = tmp_path / "symosc" / "paper"
    out = tmp_path / "out"
    shutil.copytree(ROOT / "symosc", tmp_path / "symosc")  # with what is compiled of it
    with (paper / "claims.toml").open("a", encoding="utf-8") as file:
        file.write(
            '\n[figures.my-claim]\nsource = "Section 6, Fig. 9"\nsays = "The spring of Fig. 9 is weak."\n'
            'check = "orbits.weak(FIG9, 1000)"\nsee = ["fig9-mine", "motion"]\nverdict = "by definition"\n'
        )
    with (paper / "checks" / "orbits.py").open("a", encoding="utf-8") as file:
        file.write(
            '\n\ndef weak(scene: Scene, most: int) -> Evidence:\n    """Check that the spring is weak."""\n'
            '    return Evidence("by definition", f"k is less than {most}.", {"k": scene.parameters.k})\n'
        )
    scenes = paper.parent / "scenes"
    pictures = paper / "pictures.py"
    scene = (
        (scenes / "fig9-orbit.toml").read_text(encoding="utf-8").replace("fig9-orbit", "fig9-mine")
    )
    (scenes / "fig9-mine.toml").write_text(scene, encoding="utf-8")
    row = '    ("fig9-mine", "my orbit", orbit_figure, orbit_caption, "The orbit of Fig. 9 is shown once more."),\n'
    source = pictures.read_text(encoding="utf-8").replace('    ("fig10",', f'{row}    ("fig10",', 1)
    pictures.write_text(
        source.replace('"orbit": ', '"mine": ", mine", "orbit": '), encoding="utf-8"
    )

    command = [sys.executable, "-m", "symosc", "reproduce", "--only", "my-claim", "-o", str(out)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert "1 claim: 1 by definition" in done.stdout
    assert (out / "figures" / "fig9-mine.svg").is_file()
    report = (out / "report.html").read_text(encoding="utf-8")
    assert "k is less than 1000" in report
    assert "my orbit" in report


def test_every_numbered_item_of_the_paper_has_a_claim() -> None:
    assert [item for item, on in coverage(CLAIMS).items() if not on] == []
    assert list(PAPER.values()).count("equation") == 66
    assert set(PAPER) >= {"Abstract", "(1)", "(66)", "Lemma 3", "Theorem 4", "Fig. 10", "Section 7"}
    # A claim that is taken away leaves a gap.
    table = coverage(claim for claim in CLAIMS if "(15)" not in claim.source)
    assert [item for item, on in table.items() if not on] == ["(15)", "(16)"]
    for entry in (*CLAIMS, *UNJUDGED):
        assert set(items_of(entry.source)) <= set(PAPER), entry.source
        assert items_of(entry.source), entry.source
