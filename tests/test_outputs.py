"""Figures, tables and answers are what they were when somebody last looked at all of them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest
from stored_outputs import NAMES, cases, difference, lines_of, stored

#: Kinds of many cases that take half a minute together; `kind_of` says what a kind is.
LONG_KINDS = {"crosschecks": ("causes of", "said of")}


def all_cases() -> Iterator[Any]:
    """Yield all cases; every third of a long kind is in the full run, the others are a campaign."""
    for name in NAMES:
        seen = Counter[str]()
        for case in cases(name):
            kind = kind_of(case)
            seen[kind] += 1
            seldom = kind in LONG_KINDS.get(name, ()) and seen[kind] % 3 != 1
            yield pytest.param(name, case, marks=pytest.mark.campaign if seldom else ())


def kind_of(case: str) -> str:
    """Return what a case has before a colon or a brace; cases alike have the same."""
    return re.split("[:{]", case)[0]


@pytest.mark.quick(20)
@pytest.mark.parametrize(("name", "case"), [*all_cases()])
def test_an_output_is_what_was_stored(name: str, case: str) -> None:
    old = stored(name)[case]
    new = list(lines_of(cases(name)[case]()))
    changes = [text for pair in zip(old, new, strict=False) if (text := difference(*pair))]
    changes += [f"- {line}" for line in old[len(new) :]] + [f"+ {line}" for line in new[len(old) :]]
    assert not changes, "\n".join(
        [*changes, f"if this is right: python tests/support/stored_outputs.py {name}"]
    )


def test_each_stored_output_has_a_case() -> None:
    for name in NAMES:
        assert list(stored(name)) == list(cases(name))


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ("x 1.25 at fig5", "x  1.2500000001 at fig5", True),
        ("-0.5 +1.25 i", "-0.5 +1.2500000001 i", True),
        ("error 3e-12", "error 1.5e-13", True),
        ("x 1.25", "x 1.2501", False),
        ("fig5", "fig6", False),
        ("t 0.123456789012345678901", "t 0.123456789012345678999", True),
        ("t 0.123456789012345678901", "t 0.123456789012345688901", False),
        ("[1, 2]", "[1, 3]", False),
        ("1 2", "1", False),
        ("t = -1.5e3", "t = 1.5e3", False),
    ],
)
def test_words_are_compared_exactly_and_numbers_nearly(old: str, new: str, same: bool) -> None:
    assert (difference(old, new) == "") is same
