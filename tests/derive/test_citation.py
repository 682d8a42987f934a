"""Tool and paper are cited alike everywhere."""

from __future__ import annotations

import re

from click.testing import CliRunner
from project_files import PROJECT, cff, text

import symosc
from symosc.cli.app import main
from symosc.derive import citation
from symosc.scenes import load_scene, scene_names


def test_citation_file_and_bibtex_agree() -> None:
    tool, paper = cff(), cff("    ")
    assert {"cff-version", "message", "title", "version", "date-released"} <= set(tool)
    assert tool["version"] == symosc.__version__
    assert tool["title"] == citation.SYMOSC["title"]
    assert tool["license"] == PROJECT["license"]
    assert tool["date-released"][:4] == citation.SYMOSC["year"]
    assert f"{{{cff('  - ')['name']}}}" == citation.SYMOSC["author"]
    assert [cff("  - ")["name"]] == [author["name"] for author in PROJECT["authors"]]
    people = re.findall(r"family-names: (\w+)\n +given-names: (\w+)", text("CITATION.cff"))
    assert " and ".join(f"{family}, {given}" for family, given in people) == citation.PAPER["author"]
    assert f"{paper['start']}--{paper['end']}" == citation.PAPER["pages"]
    for name in ("title", "journal", "volume", "year", "issn"):
        assert paper[name] == citation.PAPER[name], name
    keywords = re.search(r"^keywords:\n((?:  - .+\n)+)", text("CITATION.cff"), re.M)
    assert keywords is not None
    assert re.findall(r"- (.+)", keywords[1]) == PROJECT["keywords"]


def test_cite_prints_both_entries() -> None:
    result = CliRunner().invoke(main, ["--cite"])
    assert (result.exit_code, result.stderr) == (0, "")
    for entry, fields in zip(result.stdout.split("\n\n"), (citation.SYMOSC, citation.PAPER), strict=True):
        assert dict(re.findall(r"^  (\w+) += \{(.*)\},$", entry, re.M)) == fields
        assert entry.count("{") == entry.count("}")
    assert f"Version {symosc.__version__}" in result.stdout


def test_every_text_cites_the_same_paper() -> None:
    start = citation.paper_reference().rpartition(",")[0]
    for name in scene_names():
        assert load_scene(name).source.startswith(start), name
    readme = " ".join(text("README.md").split())
    for name in ("title", "journal", "volume", "year"):
        assert citation.PAPER[name] in readme, name
    assert citation.paper_reference(r"\emph{{{}}}", "~", "--") in text("derivations/derivations.tex")
