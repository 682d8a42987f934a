"""A chunk of motions: what is recorded, and what its numbers depend on."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import symosc
from symosc.sweeps import motions
from symosc.sweeps.motions import RECORDED, computed, cycles
from symosc.sweeps.sweep import planned


def test_a_share_can_be_sent_and_gives_all_that_is_recorded() -> None:
    pytest.importorskip("xarray")
    plan, _ = planned("fig9", {"FN": "1:20:9"}, RECORDED, "5T", "3T", None)
    chunk = computed(pickle.loads(pickle.dumps(plan.share(2, 6))))
    assert {*chunk.columns} == {*RECORDED}
    assert all(len(column) == 4 for column in chunk.columns.values())
    assert chunk.seconds > 0
    parts = [computed(plan.share(begin, begin + 1)).columns for begin in range(2, 6)]
    for name, column in chunk.columns.items():
        assert column.tobytes() == np.concatenate([part[name] for part in parts]).astype(column.dtype).tobytes(), name
        assert column.dtype.kind in "Uif"


def test_the_sources_that_decide_are_there() -> None:
    root = Path(symosc.__file__).parent
    assert all((root / name).exists() for name in motions.DECISIVE)


@pytest.mark.parametrize("word", ["P32", "P4645", "P3212", "P1", "P112233", ""])
def test_a_cycle_has_one_word(word: str) -> None:
    labels = word[1:]
    rotations = [word[:1] + labels[i:] + labels[:i] for i in range(max(len(labels), 1))]
    found = cycles(np.array([*rotations, "P7"]))
    assert len({*found[:-1]}) == 1
    assert found[0] in rotations
    assert found[-1] == "P7"


def test_words_that_are_no_rotations_stay_apart() -> None:
    words = np.array(["P3212", "P3221", "P32", "P3232", ""])
    assert len({*cycles(words)}) == len(words)
    assert cycles(np.array(["P23", "P12"])).tolist() == ["P32", "P21"]
