"""What commands print: tables, JSON, counts, and a word where a motion could not be decided."""

from __future__ import annotations

import pytest

from symosc import simulate
from symosc.cli import output


def test_an_undecided_motion_is_said_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    class Undecided:
        status, message = "undecidable", "the contact near t = 3"

    assert output.undecidable(Undecided()) is True  # type: ignore[arg-type]
    assert capsys.readouterr() == ("", "symosc: undecidable: the contact near t = 3\n")
    assert output.undecidable(simulate("fig5", t_end=2)) is False
    assert capsys.readouterr() == ("", "")
