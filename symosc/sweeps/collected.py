"""The columns of a sweep while its chunks come in."""

from __future__ import annotations

import numpy as np


class Collected:
    """Columns over all cells, filled chunk by chunk in any order. Text is kept as numbers of a list of texts.

    Parameters
    ----------
    count : int
        Cells.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._columns: dict[str, np.ndarray] = {}
        self._texts: dict[str, dict[str, int]] = {}

    def fill(self, begin: int, end: int, columns: dict[str, np.ndarray]) -> None:
        """Put the columns of a chunk into their place."""
        for name, values in columns.items():
            kept = self._coded(name, values) if values.dtype.kind == "U" else values
            if name not in self._columns:
                self._columns[name] = np.zeros((self.count, *kept.shape[1:]), dtype=kept.dtype)
            self._columns[name][begin:end] = kept

    def _coded(self, name: str, values: np.ndarray) -> np.ndarray:
        known = self._texts.setdefault(name, {})
        texts, inverse = np.unique(values, return_inverse=True)
        return np.array([known.setdefault(str(text), len(known)) for text in texts], dtype=np.int32)[inverse]

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns, text as text; they are the same in whatever order the chunks came."""
        texts = {name: np.array(list(known)) for name, known in self._texts.items()}
        return {name: texts[name][column] if name in texts else column for name, column in self._columns.items()}
