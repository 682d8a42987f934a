#!/usr/bin/env -S uv run --script
# /// script
# dependencies = ["nox>=2025.2.9"]
# ///
"""The tasks of a developer, each in an environment of its own: `nox` runs the short ones, `nox --list` names all."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import nox

nox.needs_version = ">=2025.2.9"
nox.options.default_venv_backend = "uv|virtualenv"
nox.options.reuse_venv = "yes"
PROJECT = nox.project.load_toml("pyproject.toml")["project"]
PYTHONS = ["3.11", "3.12", "3.13"]
EXTRAS = [
    "fast",
    "bench",
    "sweep",
    "certify",
    "units",
    "tables",
    "explore",
    "jax",
    "docs",
]


@nox.session
def quick(session: nox.Session) -> None:
    """Run the tests that take no more than a few seconds each."""
    session.install("-e", ".[dev]")
    session.run("pytest", "-n", "2", "-m", "not slow", *session.posargs)


@nox.session(default=False)
def tests(session: nox.Session) -> None:
    """Run all tests."""
    session.install("-e", ".[dev]")
    session.run("pytest", "-n", "2", "--dist", "worksteal", *session.posargs)


@nox.session(default=False)
def lowest(session: nox.Session) -> None:
    """Run the quick tests with the lowest versions that pyproject.toml allows."""
    extras = PROJECT["optional-dependencies"].values()
    bounds = [each for part in (PROJECT["dependencies"], *extras) for each in part if ">=" in each]
    session.install("-e", ".[dev]", *(each.replace(">=", "==") for each in bounds))
    session.run("pytest", "-n", "2", "-m", "not slow", *session.posargs)


@nox.session(default=False, python=PYTHONS)
def pythons(session: nox.Session) -> None:
    """Run the quick tests on each Python that is here."""
    session.install("-e", ".[dev]")
    session.run("pytest", "-n", "2", "-m", "not slow", *session.posargs)


@nox.session(default=False)
@nox.parametrize("extra", EXTRAS)
def without(session: nox.Session, extra: str) -> None:
    """Run the quick tests without one extra, and what it alone brings."""
    needs = {extra, "docs"} | (
        {"bench"} if extra == "fast" else set()
    )  # docs has nearly all the others
    kept = ",".join(name for name in EXTRAS if name not in needs)
    session.install("-e", f".[{kept},test]")
    session.run("pytest", "-n", "2", "-m", "not slow", *session.posargs)


@nox.session(default=False)
def release(session: nox.Session) -> None:
    """Build wheel and source, check them, and use them without the repository."""
    session.install("-e", ".[test]")
    session.run("pytest", "-m", "campaign", "tests/test_release.py", *session.posargs)


@nox.session(default=False)
def build(session: nox.Session) -> None:
    """Build wheel and source of this commit in dist, to be uploaded to a package index.

    The README's links become absolute, to the version's tag at `origin`: an index has no files
    beside the page.
    """

    def git(*words: str) -> str:
        return subprocess.run(["git", *words], capture_output=True, text=True, check=True).stdout

    session.install("build", "twine")
    source = Path(session.create_tmp()).resolve() / "source"
    session.run("git", "clone", "--quiet", ".", str(source), external=True)
    found = re.search(r'__version__ = "(.+)"', (source / "symosc/__init__.py").read_text("utf-8"))
    assert found
    readme = source / "README.md"
    address = repository_address(git("remote", "get-url", "origin").strip())
    text = with_absolute_links(readme.read_text("utf-8"), address, f"v{found[1]}")
    readme.write_text(text, "utf-8")
    session.run("python", "-m", "build", "--outdir", "dist", str(source))
    session.run("twine", "check", "--strict", *map(str, Path("dist").iterdir()))


def repository_address(remote: str) -> str:
    """Return the address of a repository's page, from that of a remote, which may be one for SSH."""
    return re.sub(r"^git@([^:]+):", r"https://\1/", remote).removesuffix(".git")


def with_absolute_links(text: str, address: str, tag: str) -> str:
    """Return a README whose links and pictures lead to the repository at `address`, at `tag`."""

    def absolute(match: re.Match[str]) -> str:
        picture, target = match.groups()
        if target.startswith("../../"):
            return f"{picture}({address}/{target.removeprefix('../../')})"
        kind = "raw" if picture.startswith("!") else "blob"
        return f"{picture}({address}/{kind}/{tag}/{target})"

    # The text in brackets may be a picture itself: inner links come first.
    inner = re.compile(r"(!\[[^\]]*\])\((?!https?:)([^)\s]+)\)")
    outer = re.compile(r"((?<!!)\[(?:[^\[\]]|!\[[^\]]*\]\([^)]*\))*\])\((?!https?:)([^)\s]+)\)")
    return outer.sub(absolute, inner.sub(absolute, text))


@nox.session
def lint(session: nox.Session) -> None:
    """Look for faults of style and form."""
    session.install("ruff", "codespell", "cffconvert", "sp-repo-review[cli]", "zizmor")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("codespell")
    session.run("cffconvert", "--validate")
    session.run("sp-repo-review", ".")
    session.run("zizmor", "--offline", ".github")


@nox.session
def types(session: nox.Session) -> None:
    """Check the types."""
    session.install("-e", ".[dev]")
    session.run("mypy")


@nox.session
def codegen(session: nox.Session) -> None:
    """Compare the generated kernels with the formulas; `nox -s codegen -- --regenerate` prints them anew."""
    session.install("-e", ".")
    session.run("symosc", "codegen", *(session.posargs or ["--check"]))


@nox.session
def examples(session: nox.Session) -> None:
    """Run the examples of docstrings and README, and check the derivations."""
    session.install("-e", ".[dev]")
    session.run("pytest", "--doctest-modules", "symosc", "tests/test_readme.py")
    session.run("symosc", "derive", "all", "-o", session.create_tmp())


@nox.session
def docs(session: nox.Session) -> None:
    """Build the site in build/docs, running all its pages; a warning is an error."""
    session.install("-e", ".[docs]")
    session.run("sphinx-build", "-W", "-j", "2", "docs", "build/docs", *session.posargs)


if __name__ == "__main__":
    nox.main()
