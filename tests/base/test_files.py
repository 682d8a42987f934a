"""Files are written whole or not at all, and "-" is standard output."""

from __future__ import annotations

from pathlib import Path

import pytest

from symosc.base.errors import OutputError
from symosc.base.files import write_text, write_whole


@pytest.mark.parametrize(
    "error", [OSError(28, "No space left on device"), ValueError("no figure"), KeyboardInterrupt()]
)
@pytest.mark.parametrize("old", [None, "old"])
def test_a_failed_write_leaves_the_folder_as_it_was(
    tmp_path: Path, error: BaseException, old: str | None
) -> None:
    path = tmp_path / "events.csv"
    if old is not None:
        path.write_text(old)
    drafts = []

    def write(draft: Path) -> None:
        draft.write_text("half a line")
        drafts.append(draft)
        raise error

    with pytest.raises(OutputError if isinstance(error, OSError) else type(error)):
        write_whole(path, write)
    assert drafts[0].parent == tmp_path  # there was something to clean up
    assert [path.name for path in tmp_path.iterdir()] == ([] if old is None else ["events.csv"])
    assert old is None or path.read_text() == old


def test_a_whole_write_replaces_the_file_and_keeps_a_link(tmp_path: Path) -> None:
    target = tmp_path / "target.txt"
    link = tmp_path / "link.txt"
    target.write_text("old")
    link.symlink_to(target)
    assert write_text(link, "new") == link
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["link.txt", "target.txt"]


@pytest.mark.parametrize("path", ["none/a.csv", ".", "file/a.csv", "n" * 300])
def test_what_cannot_be_written(path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(OutputError):
        write_text(path, "text")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
