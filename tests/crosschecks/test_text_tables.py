"""Tables as text, whatever they are laid out like, and what is wrong with those that are none."""

from __future__ import annotations

import io
import random

import numpy as np
import pytest

from symosc import ParameterError
from symosc.crosschecks import text_tables
from symosc.crosschecks.text_tables import read_text


def read(text: str, **asked: str | None) -> dict[str, np.ndarray]:
    return read_text(io.BufferedReader(io.BytesIO(text.encode())), asked, "here")  # type: ignore[arg-type]


def test_numbers_are_read_however_they_are_written(monkeypatch: pytest.MonkeyPatch) -> None:
    """Any delimiter, decimal sign, order and name of columns, header or none, comments, a few lines at a time."""
    rng = random.Random(3)
    monkeypatch.setattr(text_tables, "LINES_TOGETHER", 3)
    for _ in range(150):
        count, sign = rng.randint(2, 9), rng.choice([",", ";", "\t", " ", "  "])
        columns = {name: [rng.choice([rng.uniform(-9, 9), rng.uniform(-9, 9) * 1e-30, float(rng.randint(0, 9))])
                          for _ in range(count)] for name in "txv"}  # fmt: skip
        names = {
            "t": ["t", "T", "time", "Time"],
            "x": ["x", "X", "position", "POS"],
            "v": ["v", "vel", "Velocity", "dx/dt"],
        }
        headless = rng.random() < 0.3
        order = ["t", "x", "v"] if headless else rng.sample("txv", 3)
        comma = sign != "," and rng.random() < 0.5
        lines = [] if headless else [sign.join(rng.choice(names[name]) for name in order)]
        for row in zip(*(columns[name] for name in order), strict=True):
            cells = [repr(value) for value in row]
            lines.append(sign.join(cell.replace(".", ",") for cell in cells) if comma else sign.join(cells))
        for _ in range(rng.randint(0, 4)):
            lines.insert(rng.randint(0, len(lines)), rng.choice(["", "# why", "% 1 2", "// t x", " "]))
        found = read(rng.choice(["\n", "\r\n", "\r"]).join(lines) + rng.choice(["", "\n"]))
        assert {name: column.tolist() for name, column in found.items()} == columns, lines


def test_a_header_may_be_a_comment_and_a_comment_is_no_header() -> None:
    assert read("# t v x\n0 1 2\n1 2 3\n")["x"].tolist() == [2, 3]
    assert read("# made by hand\n0 1 2\n1 2 3\n")["x"].tolist() == [1, 2]
    assert set(read("# t x\n0 1\n1 2\n")) == {"t", "x"}


def test_columns_may_be_named_by_their_numbers() -> None:
    text = "9 0 5 1\n9 1 6 2\n"
    found = read(text, t="2", x="4", v="3")
    assert [found[name].tolist() for name in "txv"] == [[0, 1], [1, 2], [5, 6]]
    with pytest.raises(ParameterError, match="has no header and 4 columns; say which are meant, such as t=1,x=2,v=3"):
        read(text)


def test_what_spreadsheets_and_fortran_write() -> None:
    assert read("sep=;\nt;x;v\n0,5;1;2\n1,5;2;3\n")["t"].tolist() == [0.5, 1.5]
    assert read("1.5D-03 1.D0 2d+1\n1.5 2 3\n")["t"].tolist() == [1.5e-3, 1.5]
    assert read("1.5D-03 1.D0 2d+1\n1.5 2 3\n")["v"].tolist() == [20, 3]


def test_a_file_without_lines_is_not_read_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_tables, "LONGEST_LINE", 1000)
    with pytest.raises(ParameterError, match="not text in lines"):
        read("0" * 5000)


def test_ids_are_texts() -> None:
    found = read('id;t;x;v\n"a 1";0;0,5;1\nb;1;2;3\n')
    assert found["id"].tolist() == ["a 1", "b"]
    assert found["x"].tolist() == [0.5, 2]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,x,v\n0,1,2\n1,x,2\n", r"x\[1\] = 'x': is not a number \(line 3\)"),
        ("t;x;v\n0;1;2\n1;1.234,5;2\n", r"x\[1\] = '1.234.5': is not a number \(line 3\)"),
        ("t,x,v\n0,1,2\n\n1,2\n", "row 4 has 2 entries, the header 3"),
        ("t x v\n0 1 2\n1 2 3 4\n", "row 3 has 4 entries, the header 3"),
        ("0,1\n1\n", "row 2 has 1 entries, the header 2"),
        ("t,x,v,x\n0,1,2,3\n", "has 'x' twice"),
        ("time,pos,position,v\n0,1,2,3\n", "may be any of pos, position in here; say which, such as x=pos"),
        ("a,b,c\n0,1,2\n", "is missing in here; there are: a, b, c"),
        ("", "is empty"),
        ("\n \n", "is empty"),
        ("t,x,v\n0,1,2\n\x00\n", "is not text in lines"),
    ],
)
def test_what_is_wrong_is_said(text: str, words: str) -> None:
    with pytest.raises(ParameterError, match=words) as caught:
        read(text)
    assert "\n" not in str(caught.value)
