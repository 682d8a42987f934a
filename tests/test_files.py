"""Files are written whole or not at all, and "-" is standard output."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from symosc.errors import OutputError, ParameterError
from symosc.files import write_text, write_whole


@pytest.mark.parametrize(
    "error", [OSError(28, "No space left on device"), ValueError("no figure"), KeyboardInterrupt()]
)
@pytest.mark.parametrize("old", [None, "old"])
def test_a_failed_write_leaves_the_folder_as_it_was(tmp_path: Path, error: BaseException, old: str | None) -> None:
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
    assert [each.name for each in tmp_path.iterdir()] == ([] if old is None else ["events.csv"])
    assert old is None or path.read_text() == old


def test_a_whole_write_replaces_the_file_and_keeps_a_link(tmp_path: Path) -> None:
    target, link = tmp_path / "target.txt", tmp_path / "link.txt"
    target.write_text("old")
    link.symlink_to(target)
    assert write_text(link, "new") == link
    assert link.is_symlink()
    assert target.read_text() == "new"
    assert sorted(each.name for each in tmp_path.iterdir()) == ["link.txt", "target.txt"]


@pytest.mark.parametrize("path", [None, "", 5, 1.5, b"a.csv", "a\0b", [], True, {}])
def test_what_is_no_file_name(path: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ParameterError, match=r"^path = .*: must be the name of a file") as caught:
        write_text(path, "text")  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", ["none/a.csv", ".", "file/a.csv", "n" * 300])
def test_what_cannot_be_written(path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(OutputError):
        write_text(path, "text")
    assert [each.name for each in tmp_path.iterdir()] == ["file"]


def test_standard_output(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    print("before")
    write_text("-", "Ω\n")
    print("after")
    sys.stdout.flush()
    assert capfd.readouterr().out == "before\nΩ\nafter\n"
    write_text("./-", "a file")
    assert [each.name for each in tmp_path.iterdir()] == ["-"]


def test_a_closed_pipe_is_quiet() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    program = "from symosc.files import write_text; write_text('-', 'x' * 100000); print('more')"
    with os.fdopen(writer, "w") as out:
        result = subprocess.run([sys.executable, "-c", program], stdout=out, stderr=subprocess.PIPE, text=True)
    assert (result.returncode, result.stderr) == (0, "")
