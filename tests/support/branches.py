"""Branches that several tests look at: each is followed once."""

from functools import cache
from typing import Any

from symosc import Parameters, continue_orbit
from symosc.orbits.branch import Branch


@cache
def branch_of(p: Parameters, word: str, name: str, limits: Any) -> Branch:
    """Return what `continue_orbit` does with these arguments."""
    return continue_orbit(p, word, name, limits)
