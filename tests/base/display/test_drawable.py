"""Answers: when two of them are equal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symosc.base.display.drawable import Comparable


def test_answers_are_compared_by_their_public_fields() -> None:
    @dataclass(eq=False)
    class Answer(Comparable):
        value: Any
        _hidden: int = 0

    @dataclass
    class Entry:
        number: float
        array: Any = None

    def nan() -> float:
        return float("nan")

    texts = np.array(["a", "b"])
    numbers = np.array([1.0, nan()])
    equal = [
        (nan(), nan()),
        ((nan(), "a"), (nan(), "a")),
        ({"a": [nan()]}, {"a": [nan()]}),
        (Entry(nan(), numbers), Entry(nan(), numbers.copy())),
        (texts, texts.copy()),
        (1, 1.0),
    ]
    different = [
        (nan(), 1.0),
        ((1, 2), (1, 2, 3)),
        ({"a": 1}, {"b": 1}),
        (Entry(1.0, numbers), Entry(1.0, numbers + 1)),
        (texts, numbers),
        (numbers, None),
        (1, "1"),
    ]
    for first, second in equal:
        assert Answer(first) == Answer(second, 1)
    for first, second in different:
        assert Answer(first) != Answer(second)
