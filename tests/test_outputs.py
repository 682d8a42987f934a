"""Figures, tables and answers are what they were when somebody last looked at all of them."""

from __future__ import annotations

import pytest
from stored_outputs import NAMES, cases, difference, lines_of, stored


@pytest.mark.quick(20)
@pytest.mark.parametrize(("name", "case"), [(name, case) for name in NAMES for case in cases(name)])
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
