"""Exports that are refused: bad arguments, names that a language keeps, files that are there already."""

from __future__ import annotations

from pathlib import Path

import pytest

from symosc import load_scene
from symosc.errors import OutputError, ParameterError
from symosc.symbolic.export import export, write_export
from symosc.words import WordError


def test_errors(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="one of python, numpy, c, julia"):
        export("P32", "fortran")
    with pytest.raises(ParameterError, match="a letter first"):
        export("P32", "c", name="3 d")
    with pytest.raises(WordError, match="P5 cannot follow P2"):
        export("P52")
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        write_export(tmp_path / "file" / "folder", "P32")
    with pytest.raises(WordError, match="P3 cannot follow P3"):
        export("P33")
    for fix in ("fig9", {}, load_scene("fig9")):
        with pytest.raises(ParameterError, match="fix = "):
            export("P32", fix=fix)  # type: ignore[arg-type]
    for name in ("", "3d", "a b", "a-b", "ä", "１", 5, "a\n", "../a"):
        with pytest.raises(ParameterError, match="name = "):
            export("P32", name=name)  # type: ignore[arg-type]
    with pytest.raises(OutputError):
        write_export(tmp_path / ("n" * 300), "P32")
    for folder in (None, "", 5):
        with pytest.raises(ParameterError, match="path = "):
            write_export(folder, "P32")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("language", "names"),
    [
        ("python", ["for", "class", "None", "match", "math", "collections", "numpy"]),
        ("numpy", ["lambda", "math", "numpy"]),
        ("c", ["for", "double", "restrict", "math", "stdlib"]),
        ("julia", ["end", "module", "begin", "Main", "Base"]),
    ],
)
def test_words_of_the_language_are_no_names(language: str, names: list[str]) -> None:
    for name in names:
        with pytest.raises(ParameterError, match=f"^name = '{name}': is a word or a library"):
            export("P32", language, name=name)


@pytest.mark.slow
def test_a_file_with_another_content_stays(tmp_path: Path) -> None:
    (path,) = write_export(tmp_path, "P32", "python")
    text = path.read_text()
    write_export(tmp_path, "P32", "python")  # the same once more
    for other in ({"language": "numpy"}, {"fix": load_scene("fig9").parameters}):
        with pytest.raises(OutputError, match=r"p32\.py: is there with another content"):
            write_export(tmp_path, "P32", **other)
        assert path.read_text() == text
    path.write_bytes(b"\xff mine")
    with pytest.raises(OutputError, match="another content"):
        write_export(tmp_path, "P32")
    write_export(tmp_path, "P32", "numpy", force=True)
    assert "import numpy" in path.read_text()
    (tmp_path / "p32.c").write_text("mine")
    with pytest.raises(OutputError, match=r"p32\.c"):
        write_export(tmp_path, "P32", "c")
    assert not (tmp_path / "p32.h").exists()


def test_of_two_files_none_is_written_where_one_cannot_be(tmp_path: Path) -> None:
    (tmp_path / "p32.c").mkdir()
    for force in (False, True):
        with pytest.raises(OutputError, match="is a folder"):
            write_export(tmp_path, "P32", "c", force=force)
    assert [path.name for path in tmp_path.iterdir()] == ["p32.c"]
