"""Files and objects that samples are read from."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symosc import ParameterError
from symosc.crosschecks.compare import crosscheck
from symosc.crosschecks.files import read_samples


def test_what_is_read(tmp_path: Path, grid: Any) -> None:
    t, x, v = grid["fig9"]
    columns = {"t": t.tolist(), "x": x.tolist(), "v": v.tolist()}
    rows = "\n".join(",".join(map(repr, row)) for row in zip(*columns.values(), strict=True))
    (tmp_path / "run.csv").write_text(f"t,x,v\n{rows}\n")
    np.savez(tmp_path / "run.npz", t=t, x=x, v=v)
    (tmp_path / "run.json").write_text(json.dumps(columns))
    (tmp_path / "rows.json").write_text(json.dumps([{"t": a, "x": b, "v": c} for a, b, c in zip(t, x, v, strict=True)]))
    result = SimpleNamespace(t=t, y=np.array([x, v]))
    sources = [*sorted(tmp_path.iterdir()), str(tmp_path / "run.csv"), columns, result]
    assert len(sources) == 7
    for source in sources:
        samples = read_samples(source)
        np.testing.assert_array_equal([samples.t, samples.x, samples.v], [t, x, v])
    samples = read_samples({"time": t, "x": x, "w": v}, {"t": "time", "v": "w"})
    np.testing.assert_array_equal(samples.v, v)
    assert crosscheck("fig9", result).ok


def test_what_cannot_be_read(tmp_path: Path) -> None:
    files = {
        "two.csv": ("t,x\n0,1\n1,2\n", "column = 'v': is missing"),
        "short.csv": ("t,x,v\n0,1,2\n1,2\n", "row 3 has 2 entries"),
        "text.csv": ("t,x,v\n0,1,2\n1,2,three\n", "'three': is not a number"),
        "empty.csv": ("", "is empty"),
        "bad.json": ("{", "cannot be read"),
        "list.json": ("[1, 2]", "must hold columns"),
        "bad.npz": ("no zip", "is not an npz file"),
        "run.txt": ("", "must end in"),
    }
    for name, (text, words) in files.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(ParameterError, match=words):
            read_samples(tmp_path / name)
    with pytest.raises(ParameterError, match="cannot be read"):
        read_samples(tmp_path / "none.csv")
