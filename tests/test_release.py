"""What is released: wheel and source build, and work in an environment that knows nothing of this repository."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
from pathlib import Path
from zipfile import ZipFile

import pytest
from project_files import ROOT

import symosc
from symosc.scenes import scene_names

pytestmark = [pytest.mark.campaign, pytest.mark.slow]


def run(*command: str, folder: Path) -> str:
    environment = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith(("PYTHON", "PIP_REQUIRE"))
    }
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def fresh(folder: Path, *requirements: str) -> Path:
    """Return the programs of a new environment with some packages."""
    run(sys.executable, "-m", "venv", str(folder), folder=folder.parent)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    run(str(programs / "python"), "-m", "pip", "install", "-q", *requirements, folder=folder.parent)
    return programs


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("built")
    source = folder / "source"
    listed = run("git", "ls-files", folder=ROOT).splitlines()
    for name in filter(lambda name: (ROOT / name).is_file(), listed):
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_bytes((ROOT / name).read_bytes())
    programs = fresh(folder / "tools", "build", "twine")
    run(str(programs / "python"), "-m", "build", "--outdir", str(folder / "dist"), folder=source)
    found = sorted((folder / "dist").iterdir())
    run(str(programs / "twine"), "check", "--strict", *map(str, found), folder=folder)
    return found


def test_wheel_and_source_have_what_they_need(built: list[Path]) -> None:
    wheel, source = built
    assert wheel.name == f"symosc-{symosc.__version__}-py3-none-any.whl"
    inside = [path for path in (ROOT / "symosc").rglob("*") if "__pycache__" not in path.parts]
    wanted = {
        str(path.relative_to(ROOT))
        for path in inside
        if path.suffix in (".py", ".pyi", ".toml", ".csv", ".bib", ".typed")
    }
    packed = set(ZipFile(wheel).namelist())
    assert wanted <= packed
    assert not [name for name in packed if name.startswith(("tests", "docs"))]
    with tarfile.open(source) as archive:
        assert {name.partition("/")[2] for name in archive.getnames()} >= wanted | {
            "README.md",
            "LICENSE",
        }


@pytest.mark.parametrize("kind", ["wheel", "source"])
def test_it_works_without_the_repository(built: list[Path], kind: str, tmp_path: Path) -> None:
    package = built[("wheel", "source").index(kind)]
    programs = fresh(tmp_path / "environment", str(package))
    program = str(programs / "symosc")
    about = (
        "import symosc, sys; print(symosc.__file__); print(symosc.simulate('fig5', t_end=7).word)"
    )
    place, word = run(str(programs / "python"), "-c", about, folder=tmp_path).splitlines()
    assert str(tmp_path) in place
    assert word == "['P1', 'P2', 'P1', 'P3']"
    assert run(program, "--version", folder=tmp_path).split()[-1] == symosc.__version__
    assert [
        each["name"] for each in json.loads(run(program, "scenes", "--json", folder=tmp_path))
    ] == scene_names()
    assert "P32" in run(program, "orbit", "fig9", folder=tmp_path)
    refused = subprocess.run(
        (program, "certify", "fig6"), cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert refused.returncode == 2
    assert refused.stderr.splitlines() == [
        "symosc: error: certify needs an optional package: pip install 'symosc[certify]'"
    ]
    run(program, "new", "mine.toml", folder=tmp_path)
    run(program, "figure", "mine.toml", "-o", "mine.pdf", folder=tmp_path)
    assert (tmp_path / "mine.pdf").read_bytes().startswith(b"%PDF")
    if kind == "wheel":
        what = ["reproduce", "-o", "reproduced"]
    else:
        what = ["reproduce", "--only", "fig9", "-o", "reproduced"]
    run(program, *what, folder=tmp_path)
    assert (
        json.loads((tmp_path / "reproduced" / "report.json").read_text(encoding="utf-8"))["ok"]
        is True
    )
