"""The files of the project that tests compare: as text, and what stands in them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


PYPROJECT = tomllib.loads(text("pyproject.toml"))

PROJECT = PYPROJECT["project"]


def cff(indent: str = "") -> dict[str, str]:
    """Return the plain values of CITATION.cff at one depth."""
    return {
        key: value.strip('"')
        for key, value in re.findall(rf"^{indent}([\w-]+): (.+)$", text("CITATION.cff"), re.M)
    }
