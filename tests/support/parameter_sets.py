"""Parameter sets that tests and stored outputs share, beside those of the paper's figures."""

from __future__ import annotations

from symosc import Parameters, Scene

EASY = Parameters(m=1, c=1, k=4, A0=1, B0=9, Omega="3/2", v1=-1, v2=2, mu1="2/5", mu2="3/10", FN=5)
#: A flight of 2.5 ms, 3.4e-6 below belt 1, seen from 2 s before: it is shorter than the first step
#: of most integrators.
DIP = Scene(
    "dip",
    Parameters(
        m="1.966", c="1.541", k="4.409", A0="3.603", B0="4.25", Omega="2.25", v1="-0.987", v2="4.752", mu1="0.462",
        mu2="0.367", FN="2.693",
    ),
    "2.491758084473163", "0.162784459", "-0.987", 6,
)  # fmt: skip
#: One belt at rest, the other one out of reach: the oscillator of Den Hartog, and the plane of the
#: tests.
COULOMB = Parameters(
    m=1, c="0.1", k=1, A0=0, B0=1, Omega="0.9", v1=0, v2=1000, mu1=1, mu2=0, FN="0.4"
)
PLANE = {"Omega": (0.25, 2), "FN": (0.02, 1)}
#: The same, with the other belt nearer.
AT_REST = COULOMB.replace(Omega=1, v2=10, FN="0.5")
#: Sticks on both belts; found by simulating random parameters.
MANY_SLIPS = Parameters(
    m=1,
    c="0.26",
    k="4.04",
    A0="3.53",
    B0="10.37",
    Omega="1.44",
    v1="-2.02",
    v2="1.02",
    mu1="0.68",
    mu2="0.71",
    FN=10,
)
#: v2 lies just below the greatest velocity that P32 has at any Omega; it does not act on P32
#: otherwise.
SHRINKS = Parameters(
    m="0.774", c="1.682", k="2.765", A0="-0.236", B0="4.57", Omega="2.043", v1="-2.927", v2="2.681", mu1="0.38",
    mu2="0.247", FN="5.058",
)  # fmt: skip
#: Too strong a damper, and neither damper nor drive.
OVER = Parameters(
    m="1.991", c="3.353", k="0.524", A0="1.449", B0="7.585", Omega="1.157", v1="1.675", v2="2.836", mu1="0.392",
    mu2="0.398", FN="6.522",
)  # fmt: skip
FREE = Parameters(
    m=1, c=0, k=2, A0="0.5", B0=0, Omega="1.3", v1=1, v2="1.5", mu1="0.4", mu2="0.3", FN=3
)
#: Numbers of a fragment, as texts.
NUMBERS = {"m": "1", "c": "2/5", "k": "4", "A0": "1", "B0": "3", "Omega": "3/2", "FN": "9.81"}
NUMBERS |= {"v1": "1", "v2": "5", "mu1": "0.8", "mu2": "0.6"}
