"""The motion at chosen times, as columns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from symosc.base.arguments import public
from symosc.base.display.drawable import Comparable
from symosc.base.display.frames import imported
from symosc.base.exact import whole_number
from symosc.simulation.tables import counted, write_csv

#: The columns of samples.
SAMPLE_COLUMNS = ("t", "x", "v", "mode")
#: As many samples as a table may have.
MOST_SAMPLES = 10**8


@dataclass(frozen=True, eq=False, repr=False)
class MotionSamples(Comparable):
    """A motion at chosen times, a row each.

    Attributes
    ----------
    t, x, v : (n,) float arrays
        Time, position and velocity.
    mode : (n,) array of str
        "Omega1", "Omega2" and so on between the belts, "belt1", "belt2" on them; at an event the
        one that follows.

    Examples
    --------
    >>> from symosc import simulate
    >>> samples = simulate("fig5", t_end=2).samples(3)
    >>> samples.t.tolist(), samples.x.round(6).tolist(), samples.mode.tolist()
    ([0.0, 1.0, 2.0], [0.0, 0.940267, 1.253602], ['Omega1', 'belt1', 'Omega1'])
    """

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    mode: np.ndarray

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        if not len(self):
            return "<MotionSamples: none>"
        low = self.t.min()
        high = self.t.max()
        return f"<MotionSamples: {counted(len(self), 'time')} from t = {low:g} to {high:g}>"

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns by name."""
        return {name: getattr(self, name) for name in SAMPLE_COLUMNS}

    @public
    def to_csv(self, path: str | Path) -> None:
        """Write the rows as CSV with a header ("-": to standard output).

        OutputError if it cannot be written.
        """
        columns = self.columns()
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        write_csv(path, columns, rows)

    def to_pandas(self) -> Any:
        """Return a DataFrame, a row per time; MissingExtraError if pandas is not installed."""
        return imported("pandas").DataFrame(self.columns())

    def to_xarray(self) -> Any:
        """Return a Dataset over `t`; MissingExtraError if xarray is not installed."""
        columns = self.columns()
        times = columns.pop("t")
        return imported("xarray").Dataset(
            {name: (("t",), column) for name, column in columns.items()}, coords={"t": times}
        )


def even_samples(count: Any, low: float, high: float) -> np.ndarray:
    """Return so many evenly spaced times, from `low` to `high`."""
    return np.linspace(low, high, whole_number("times", count, 2, MOST_SAMPLES))
