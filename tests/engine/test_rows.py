"""Rows of tables of motions: their numbers have the names of a State's fields."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from symosc import load_scene
from symosc.engine import batch, lanes
from symosc.engine.arithmetic import Arithmetic
from symosc.engine.batch import keep_state, row_of, state_of
from symosc.engine.start import Start, first_state
from symosc.engine.state import (
    NUMBERS_OF_STATE,
    PAIR_ROW,
    STATE_ROW,
    Covariance,
    RowNumbers,
    State,
    numbers_of_state,
)

SCENE = load_scene("fig8")
START = Start(SCENE.parameters, SCENE.t0, SCENE.x0, SCENE.v0, SCENE.t_end)


def test_a_row_has_the_numbers_of_a_state_and_then_the_ends() -> None:
    names = [name for name in State._fields if name != "S"]
    names[names.index("Fa") + 1 : names.index("Fa") + 1] = Covariance._fields
    assert tuple(names) == NUMBERS_OF_STATE
    for row in (STATE_ROW, PAIR_ROW):
        assert row.names == (*names, "t_end", "t_end_low", "t0")


def test_a_state_comes_back_from_its_row() -> None:
    state = first_state(START, Arithmetic(SCENE.parameters))
    table = np.array([row_of(state, 7.5, 1e-20)], STATE_ROW)
    row = table[0]
    assert (row.t_end, row.t_end_low, row.t0) == (7.5, 1e-20, state.t)
    assert state_of(row) == state
    assert state_of(RowNumbers._make(row.item())) == state
    assert numbers_of_state(state) == row.item()[: len(NUMBERS_OF_STATE)]
    moved = state._replace(x=2.5, S=Covariance(1.0, 2.0, 3.0))
    keep_state(row, moved)
    assert state_of(table[0]) == moved
    assert table["x"].tolist() == [2.5]
    assert row.t_end == 7.5
    with pytest.raises(ValueError, match="no field"):
        row.elapsed = 1.0


def test_no_number_of_a_motion_is_told_by_its_place() -> None:
    """A place such as states[i, 16] says nothing, and is wrong once a field is added."""
    by_place = re.compile(r"\w+\[(\w+, \d+|\d+, \w+)\]")
    for module in (batch, lanes):
        places = by_place.findall(Path(module.__file__ or "").read_text())
        assert set(places) <= {"0, row", "0, waiting"}, module.__name__  # of buffers and queues
