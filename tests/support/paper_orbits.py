"""The paper's two orbits to 25 digits, and a word with sticks on both belts."""

from __future__ import annotations

from symosc import Parameters, load_scene

FIG9 = load_scene("fig9").parameters
FIG10 = load_scene("fig10").parameters

BOTH_BELTS = Parameters(
    m=1,
    c="0.34",
    k="0.74",
    A0="-1.81",
    B0="3.82",
    Omega="0.64",
    v1="-2.92",
    v2="1.95",
    mu1="0.6",
    mu2="0.55",
    FN=10,
)

# (t, x) with 25 digits, computed independently of this project.
P32 = (
    ("0.1816703979243204630141381", "4.154920661325319221515248"),
    ("0.9923714390339600100212899", "-4.22494466419768724790154"),
)

# In the order of P6454, the rotation whose labels come first.
P6454 = (
    ("3.558887049321458781783653", "2.598550711472922186572334"),
    ("4.034036589660076493429398", "3.073700251811539898218079"),
    ("5.523452747339989346851072", "-2.108982871187313815691341"),
    ("6.216508258576260068575719", "-1.415927359951043093966694"),
)

P32_MULTIPLIER = complex(-0.016802303836361, 0.069594338756153)
