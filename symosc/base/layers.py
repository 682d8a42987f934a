"""The layers of symosc: each package uses only those of lower levels, and itself.

The package's docstring, the page about the code and the test of the layers read this list.
"""

from __future__ import annotations

#: Packages and the modules beside them, from the lowest level to the highest. Those of one level do
#: not use each other.
LAYERS: tuple[tuple[str, ...], ...] = (
    ("base",),
    ("friction",),
    ("belts",),
    ("model",),
    ("words", "reductions"),
    ("scenes",),
    ("kernels",),
    ("engine",),
    ("mappings",),
    ("simulation",),
    ("derivatives",),
    ("symbolic",),
    ("orbits", "crosschecks", "sweeps"),
    ("grazing", "basins"),
    ("analysis",),
    ("certificates", "jax"),
    ("reference",),
    ("plot",),
    ("derive", "bench"),
    ("paper",),
    ("cli",),
    ("__main__",),
)
