"""Every form in which other tools leave a solution becomes the same samples."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.io import savemat
from scipy.io.matlab import MatlabOpaque
from solution_files import T, V, X, read_samples
from solution_forms import ALL, FILES, objects

from symosc import ParameterError, load_scene
from symosc.analysis.fitting.measured import read_measured
from symosc.cli.app import main
from symosc.cli.options import split_columns
from symosc.crosschecks.samples import Samples

OBJECTS = objects()


def assert_same(samples: Samples, few: float = 0.0) -> None:
    np.testing.assert_allclose(samples.t, T, rtol=few, atol=few)
    np.testing.assert_allclose(samples.x, X, rtol=few, atol=few)
    if not samples.lacks_v:
        np.testing.assert_allclose(samples.v, V, rtol=few, atol=few)


@pytest.mark.parametrize("name", FILES)
def test_a_file_in_any_form_is_read(name: str, tmp_path: Path) -> None:
    form = FILES[name]
    path = tmp_path / name
    form.write(path)
    asked = split_columns(form.columns, ("t", "x", "v", "id")) if form.columns else None
    samples = read_samples(path, asked)
    assert not samples.lacks_v
    # pandas writes 15 digits
    assert_same(samples, 1e-14 if "pandas.json" in name else 0.0)


@pytest.mark.parametrize("name", OBJECTS)
def test_an_object_of_any_kind_is_read(name: str) -> None:
    source, asked = OBJECTS[name]
    samples = read_samples(source, asked)
    assert samples.lacks_v == (name == "array (n, 2)")
    # pandas keeps durations to a nanosecond
    assert_same(samples, 1e-8 if "timedelta" in name else 0.0)


#: The forms of the files that eight tools have left, and that were refused once.
EIGHT = ("OpenModelica.mat", "Julia.csv", "OpenModelica with nrows.csv", "To File.mat",
         "delimiters at the ends of rows.csv", "states called x.mat", "a row of units.csv",
         "UTF-16 as Windows writes.csv")  # fmt: skip


@pytest.mark.parametrize("name", [*EIGHT[:2], "by index.mat", "two structures with time.mat"])
def test_the_command_calls_a_right_solution_right(name: str, tmp_path: Path) -> None:
    form = FILES[name]
    form.write(tmp_path / name)
    words = ["check", "fig9", str(tmp_path / name), "--partial"]
    said = CliRunner().invoke(main, words + (["--columns", form.columns] if form.columns else []))
    assert said.exit_code == 0, said.output
    assert said.output.startswith("ok: 60 samples")


#: Names that say nothing, numbers that may be anything, and groups that are alike.
UNCLEAR: dict[str, Any] = {
    "names that say nothing": dict(zip("abc", ALL, strict=True)),
    "in another order": dict(zip("abc", ALL[[2, 0, 1]], strict=True)),
    "a time and others": {"t": T, "b": X, "c": V},
    "no velocity by name": {"t": T, "x": X, "why": np.cos(T), "w": V},
    "two positions": {"t": T, "pos": X, "position": X, "v": V},
    "four columns": np.column_stack([T, X, V, X]),
    "four columns in rows": np.array([V, T, X, X]),
    "states among three": {"t": T, "y": np.array([np.sin(T), X, V])},
    "two groups": {"one": {"t": T, "x": X, "v": V}, "two": {"t": T, "x": X, "v": V}},
    "names with blanks and commas": {"at, the": T, "that = it": X, "o'clock": V},
}


@pytest.mark.parametrize("name", UNCLEAR)
def test_a_refusal_lists_the_columns_and_shows_an_option_that_works(name: str) -> None:
    source = UNCLEAR[name]
    with pytest.raises(ParameterError) as caught:
        read_samples(source)
    said = str(caught.value)
    assert "\n" not in said
    assert len(said) < 400
    option = re.search(r"--columns ([^\s;]+)", said)
    assert option
    if isinstance(source, dict) and name != "two groups":
        assert all(str(column) in said for column in source)
    assert_same(read_samples(source, split_columns(option[1], ("t", "x", "v"))))


@pytest.mark.parametrize(
    ("lines", "t", "x"),
    [
        # a sample 0, 1, 2 leads to the next sample; the names 0, 1, 2 do not
        (["0,1,2", "0.5,2,2", "1,3,2"], [0, 0.5, 1], [1, 2, 3]),
        (["0,1,2", "0,5,2", "1,7,2"], [0, 1], [5, 7]),
        (["t,x,v", "0,1,2", "1,5,2", "2,7,2"], [0, 1, 2], [1, 5, 7]),
        (["# t,x,v", "0,1,2", "1,5,2", "2,7,2"], [0, 1, 2], [1, 5, 7]),
        # words in the first row are no row of units
        (["t,x,v,mode", "0,1,2,slip", "1,3,2,slip"], [0, 1], [1, 3]),
        # a comment names the columns of a table whose first row has words
        (["# t x mode v", "0 1 slip 2", "1 3 slip 2"], [0, 1], [1, 3]),
    ],
)
def test_which_line_is_the_header(lines: list[str], t: Any, x: Any, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("\n".join(lines))
    samples = read_samples(tmp_path / "run.csv")
    assert (samples.t.tolist(), samples.x.tolist()) == (t, x)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["t,x,v", "0,1,two", "1,2,3", "2,3,4"], r"v\[0\] = 'two': is not a number \(line 2\)"),
        (["t,x,v", "0,1,2", "1,2", "2,3,4"], "row 3 has 2 entries, and the others have 3"),
        (["t,x,v", "0,1,2", "1,2,3,4", "2,3,4", "3,4,5"], "row 3 has 4 entries"),
        (["t,x,v", "0,1,2", "1,2,", "2,3,4"], r"v\[1\] = '': is not a number \(line 3\)"),
    ],
)
def test_a_wrong_row_is_named(lines: list[str], words: str, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("\n".join(lines))
    with pytest.raises(ParameterError, match=words):
        read_samples(tmp_path / "run.csv")


def test_objects_of_matlab_are_refused_in_a_sentence(tmp_path: Path) -> None:
    """What scipy makes of a timeseries or a table."""
    fields = [(name, object) for name in ("s0", "s1", "s2", "arr")]
    opaque = MatlabOpaque(np.array([(b"", b"MCOS", b"timeseries", 0)], dtype=fields))
    with patch("scipy.io.loadmat", lambda *given, **options: {"run": opaque}):
        savemat(tmp_path / "run.mat", {"run": T})
        with pytest.raises(ParameterError, match=r"objects of MATLAB.*save run\.mat t x v"):
            read_samples(tmp_path / "run.mat")


def test_a_fit_knows_the_same_forms(tmp_path: Path) -> None:
    scene = load_scene("fig9")
    for name in ("Julia.csv", "sol.mat", "by index.npz"):
        form = FILES[name]
        form.write(tmp_path / name)
        asked = split_columns(form.columns, ("t", "x", "v")) if form.columns else None
        measured = read_measured(tmp_path / name, asked, scene)
        np.testing.assert_array_equal([measured.t, *measured.states], ALL)  # type: ignore[misc]
    events = "when;what\n[s];[-]\n0,5;stick\n0,75;slip\n"
    (tmp_path / "events.csv").write_text(events, encoding="utf-16")
    for columns in ({"t": "when", "kind": "what"}, {"t": "1", "kind": "2"}):
        measured = read_measured(tmp_path / "events.csv", columns, scene)
        assert (measured.t.tolist(), list(measured.kinds)) == ([0.5, 0.75], ["stick", "slip"])  # type: ignore[arg-type]
