"""Line numbers in TOML files: right for every key, however the file writes it."""

from __future__ import annotations

import random

import pytest

from symosc.scenes.positions import line_of

FORMS = '''# m = 1
name = """
m = 2
[parameters]
"""
t_end = 5
inline = {m = 1, deep = {k = 2}}
list = [
  1,
  2,
]
[parameters]
m = 3
"k" = 4
dotted.key = 5
'''


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("name",), 5),
        (("t_end",), 6),
        (("inline", "deep", "k"), 7),
        (("list",), 11),
        (("parameters",), 12),
        (("parameters", "m"), 13),
        (("parameters", "k"), 14),
        (("parameters", "dotted", "key"), 15),
        (("m",), None),
        (("t_end", "x"), None),
    ],
)
def test_lines_of_all_forms(path: tuple[str, ...], line: int | None) -> None:
    assert line_of(FORMS, path) == line
    assert line_of(FORMS.replace("\n", "\r\n"), path) == line


@pytest.mark.parametrize("seed", range(10))
def test_lines_of_random_files(seed: int) -> None:
    rng, lines, places = random.Random(seed), [], {}
    for table in rng.sample(["a", "b", "c"], 3):
        lines += [*rng.choices(["", "# a = 1", "   "], k=rng.randint(0, 3)), f"[{table}]"]
        for key in rng.sample("mckxyz", 4):
            lines += rng.choices(["", "# k = 1"], k=rng.randint(0, 2))
            lines.append(f"{key} = {rng.choice(['1', '[1,' + chr(10) + '2]', '{q = 1}'])}")
            places[table, key] = len("\n".join(lines).split("\n"))
    for path, line in places.items():
        assert line_of("\n".join(lines), path) == line
    assert line_of("b = 1\n" + "# much\n" * 5000 + "a = 1", ("a",)) is None
