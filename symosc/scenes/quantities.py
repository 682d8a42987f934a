"""What the numbers of a scene are: in words, with their dimension, and their unit where units are given."""

from __future__ import annotations

#: Long name and dimension of every parameter and start value. Any consistent system of units will do for them.
QUANTITIES = {
    "m": ("mass", "mass"),
    "c": ("damping", "mass/time"),
    "k": ("stiffness", "mass/time^2"),
    "A0": ("constant force", "force"),
    "B0": ("amplitude of the excitation", "force"),
    "Omega": ("frequency of the excitation", "angle/time"),
    "v1": ("speed of belt 1", "length/time"),
    "v2": ("speed of belt 2", "length/time"),
    "mu1": ("friction coefficient of belt 1", "1"),
    "mu2": ("friction coefficient of belt 2", "1"),
    "FN": ("normal force", "force"),
    "t0": ("start time", "time"),
    "x0": ("start position", "length"),
    "v0": ("start velocity", "length/time"),
    "t_end": ("end time", "time"),
}
#: The unit of each dimension in scene files where a number has one; plain numbers of such a file are in these too.
UNITS = {
    "mass": "kg",
    "mass/time": "kg/s",
    "mass/time^2": "N/m",
    "force": "N",
    "angle/time": "rad/s",
    "length/time": "m/s",
    "1": "1",
    "time": "s",
    "length": "m",
}
#: What the model allows, for who writes a scene; `Parameters` and `Scene` hold it.
ALLOWED = {
    "m": "> 0",
    "c": ">= 0",
    "k": ">= 0",
    "B0": "any sign",
    "Omega": "> 0",
    "v1": "less than v2",
    "mu1": ">= 0",
    "mu2": ">= 0",
    "FN": ">= 0",
    "t_end": "later than t0",
}


def unit_of(name: str) -> str:
    """Return the unit of a parameter or start value."""
    return UNITS[QUANTITIES[name][1]]
