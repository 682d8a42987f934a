"""`symosc reproduce`, with the evidence that the tests have.

No step and no claim is checked twice in a session.

A program: what it is given are the arguments of the command. Only `derive` and `judge`, which the
processes of the run call for each chapter and claim, are others.
"""

from __future__ import annotations

import sys
from unittest.mock import patch

from chapters import chapter
from judging import judged

from symosc.derive import document
from symosc.paper import run

_derive = run.derive


def derive(subject: str) -> tuple[int, str]:
    """Return a chapter as `symosc.paper.run.derive` does."""
    checked = chapter(subject)
    with patch.object(document, "check_chapter", lambda *_: checked):
        return _derive(subject)


if __name__ == "__main__":
    import whole_report  # the processes of the run find it by this name

    from symosc.__main__ import run as command

    with patch.object(run, "derive", whole_report.derive), patch.object(run, "judge", judged):
        sys.argv[0] = "symosc"
        command()
