#!/usr/bin/env -S uv run --script
# /// script
# dependencies = ["nox>=2025.2.9"]
# ///
"""The tasks of a developer, each in an environment of its own: `nox` runs the short ones, `nox --list` names all."""

from __future__ import annotations

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


@nox.session
def lint(session: nox.Session) -> None:
    """Look for faults of style and form."""
    session.install("ruff", "codespell", "cffconvert", "sp-repo-review[cli]")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("codespell")
    session.run("cffconvert", "--validate")
    session.run("sp-repo-review", ".")


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
