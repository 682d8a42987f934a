"""Files of records: what is missing, unknown or no text is refused in one line."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from symosc.derive.records import RecordsError, records, tables


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[[part]]\na = 'x'\nb = ''", "b = ''"),
        ("[[part]]\na = 'x'\nb = 3", "b = 3"),
        ("[[part]]\na = 'x'", "part 1: has a; must have a, b"),
        ("[[part]]\nid = 'y'\na = 'x'\nb = 'x'", "part y: has id, a, b; must have a, b"),
        ("part = 3", "another part"),
        ("[[other]]\na = 'x'", "not other"),
        ("[[part", "cannot be read"),
    ],
)
def test_bad_files(text: str, complaint: str, tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(RecordsError) as caught:
        records(path, "part", ("a", "b"), ("c",))
    assert complaint in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_good_files(tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text("[[part]]\na = 'two  words'\nb = 'y'\n[[part]]\na = 'x'\nb = 'y'\nc = 'z'", encoding="utf-8")
    assert records(path, "part", ("a", "b"), ("c",)) == [
        {"a": "two words", "b": "y"},
        {"a": "x", "b": "y", "c": "z"},
    ]
    with pytest.raises(RecordsError, match="cannot be read"):
        tables(tmp_path / "none.toml", "part")
