"""Motions with static friction and falling curves, known to 26 digits.

Computed by another program than the oracle and the package, with 60 and with 90 digits, which agree.
Some are exact: S2 touches the belt at 3 pi; S3 sticks at 2 pi - acos(-3/5), x = -1, and slips at
x = 1; S8 slips at 4, then repeats 3 + (2 pi - 2 atan(3 sqrt 2/2))/sqrt 2.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple


class ReferenceEvent(NamedTuple):
    """One event; t and x in decimals."""

    kind: str
    boundary: int
    source: str
    target: str
    t: str
    x: str


class Reference(NamedTuple):
    """A law, a start, the first events, and the state at `t_end` where these are all events."""

    name: str
    law: dict[str, Any]
    belts: tuple[dict[str, Any], ...]
    start: tuple[Any, Any, Any]
    t_end: Any
    events: tuple[ReferenceEvent, ...]
    mode: str = ""
    x: str = ""
    v: str = ""


def _events(text: str) -> tuple[ReferenceEvent, ...]:
    rows = [line.split() for line in text.split("\n") if line.strip()]
    return tuple(
        ReferenceEvent(kind, 1, source, target, t, x) for kind, source, target, t, x in rows
    )


def _law(**changes: Any) -> dict[str, Any]:
    return {"m": 1, "c": 0, "k": 1, "A0": 0, "B0": 0, "Omega": None, "FN": 1} | changes


TINY = Fraction(1, 10**12)
HALF_AND_ONE = ({"v": 1, "mu": "1/2", "mu_s": 1},)

REFERENCES = (
    Reference(
        "S1",  # a static jump
        _law(c="1/10", B0="3/10", Omega="21/10"),
        ({"v": "1/10", "mu": "2/5", "mu_s": "7/10"},),
        (0, 0, 0),
        "16.5",
        _events("""
stick Omega1 belt1  0.14537534018933512210331765 0.0073237829778299831722639022
slip  belt1  Omega1 4.2729273795659047628034132  0.42007898691548694724227346
stick Omega1 belt1  6.0960307553613300276995754  0.35358462715073167381677121
slip  belt1  Omega1 7.150421167360820547741346   0.45902366835068072582094828
stick Omega1 belt1  9.1792227536134926041299287  0.31961081606583209632599824
slip  belt1  Omega1 10.238005650643797923026497  0.42548910576886262821565508
stick Omega1 belt1  12.094637511912330303984015  0.34861518385426918061322808
slip  belt1  Omega1 13.147390546960096179109295  0.45389048735904576812575606
stick Omega1 belt1  15.152740481985560329011419  0.32398188983493854246289113
slip  belt1  Omega1 16.208614118495949597158135  0.42956925348597746927756275
"""),
    ),
    Reference(
        "S2",  # a graze that becomes a stick
        _law(B0="3/2", Omega="1/2"),
        HALF_AND_ONE,
        (0, "5/2", 0),
        "62.5",
        _events("""
stick Omega1 belt1  9.4247779607693797153879301  0.5
slip  belt1  Omega1 10.973860227165149546200439  2.0490822663957698308125088
stick Omega1 belt1  21.5572536915869997101332    -0.252080497118933901456767
slip  belt1  Omega1 24.121728119660101031482897  2.3123939309541674198929295
stick Omega1 belt1  35.056199661086607511224294  0.47492378777209450870788174
slip  belt1  Omega1 36.987263034696461813279441  2.4059871613819488107630285
stick Omega1 belt1  48.123375475187037678869589  0.81767002824511582862718216
slip  belt1  Omega1 49.75760022441463096270001   2.4518947774727091124576031
stick Omega1 belt1  61.02025427951017537092956   1.0161134159214991145535592
slip  belt1  Omega1 62.481137082642558769335168  2.4769962190538825129591668
"""),
    ),
    Reference(
        "S2-",  # misses the belt by 1e-12
        _law(B0=Fraction(3, 2) * (1 - TINY), Omega="1/2"),
        HALF_AND_ONE,
        (0, Fraction(5, 2) - 2 * TINY, 0),
        80,
        (),
        "Omega1",
        "-0.83387612330318981264488104",
        "-0.74511316047860367382723005",
    ),
    Reference(
        "S3",  # arrives exactly at the static limit
        _law(),
        ({"v": 2, "mu": "1/2", "mu_s": 1},),
        (0, 3, 0),
        "30.25",
        _events("""
stick Omega1 belt1  4.0688878715914054708911558  -1
slip  belt1  Omega1 5.0688878715914054708911558  1
stick Omega1 belt1  10.862115852517263639472278  0
slip  belt1  Omega1 11.362115852517263639472278  1
stick Omega1 belt1  17.155343833443121808053399  0
slip  belt1  Omega1 17.655343833443121808053399  1
stick Omega1 belt1  23.448571814368979976634521  0
slip  belt1  Omega1 23.948571814368979976634521  1
stick Omega1 belt1  29.741799795294838145215643  0
slip  belt1  Omega1 30.241799795294838145215643  1
"""),
    ),
    Reference(
        "S3b",  # at rest, and touches the static limit in every period
        _law(B0="1/2", Omega=1),
        ({"v": 0, "mu": "1/2", "mu_s": 1},),
        (0, "-1/2", 0),
        60,
        (),
        "belt1",
        "-0.5",
        "0",
    ),
    Reference(
        "S3b-",  # S3b a little to the left: leaves at once
        _law(B0="1/2", Omega=1),
        ({"v": 0, "mu": "1/2", "mu_s": 1},),
        (0, -Fraction(1, 2) - Fraction(1, 10**20), 0),
        60,
        _events("""
stick Omega2 belt1  2.02875783811043422359024 -0.045073564710086738443839374
"""),
        "belt1",
        "-0.045073564710086738443839374",
        "0",
    ),
    Reference(
        "S6",  # the steady motion touches a corner in every period
        _law(c=1, k="8/5", B0=1, Omega=1),
        ({"v": 3, "curve": [(0, 2), (2, 1), (5, "2/5")]},),
        (0, "11/10", "4/5"),
        40,
        (),
        "Omega1",
        "0.69592769139212192295971185",
        "-0.98061834560941874769989987",
    ),
    Reference(
        "S6c",  # starts on a corner with v' = v'' = 0
        _law(c="1/5", B0=1, Omega=1),
        ({"v": 2, "curve": [(0, 1), (2, "1/2")]},),
        (0, "3/2", 0),
        "17.5",
        _events("""
stick Omega1 belt1  5.511734127013212306086218   -0.47387046711833026915261787
slip  belt1  Omega1 6.5331321467887391101205013  1.5689255724327233389159488
cross Omega1 Omega2 11.551629266286554322513468  -2.334140985435105148674954
stick Omega2 belt1  13.064135558056103360260192  1.3480904707490383563236045
slip  belt1  Omega1 13.116356319530086795900119  1.4525319936970052276034589
"""),
    ),
    Reference(
        "S8",  # a spring pulled at constant speed
        _law(k=2),
        ({"v": "-1/10", "mu": "1/2", "mu_s": "4/5"},),
        (0, 0, "-1/10"),
        "30.25",
        _events("""
slip  belt1  Omega2 4                            -0.4
stick Omega2 belt1  6.8444176230703917303347836  -0.1
slip  belt1  Omega2 9.8444176230703917303347836  -0.4
stick Omega2 belt1  12.688835246140783460669567  -0.1
slip  belt1  Omega2 15.688835246140783460669567  -0.4
stick Omega2 belt1  18.533252869211175191004351  -0.1
slip  belt1  Omega2 21.533252869211175191004351  -0.4
stick Omega2 belt1  24.377670492281566921339134  -0.1
slip  belt1  Omega2 27.377670492281566921339134  -0.4
stick Omega2 belt1  30.222088115351958651673918  -0.1
"""),
    ),
)
