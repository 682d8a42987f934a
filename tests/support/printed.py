"""What the scripts of docs/literature have to print."""

from __future__ import annotations

import re
from decimal import Decimal
from math import pi

#: What the sources print, or what was computed elsewhere: a script, the beginning of a row, and the
#: number. Both numbers of the row have to agree with it in all digits that are given.
PRINTED = (
    ("den_hartog", "x_0 c = 0, F = 0.4, Omega = 1.5", "0.653197264742"),
    ("den_hartog", "x_0 c = 0.2, F = 0.4, Omega = 1.5", "0.548832491792"),
    ("den_hartog", "x_0 c = 0.1, F = 0.25, Omega = 0.6", "1.487067086811"),
    ("den_hartog", "F/P c = 0, Omega = 1.5", "0.6465791"),
    ("den_hartog", "F/P c = 0, Omega = 0.8", "0.8174064"),
    ("den_hartog", "rise P = 1, F = 0.5", f"{pi - 2:.12f}"),
    ("den_hartog", "rise P = 0.5, F = 0.3", f"{pi / 2 - 1.2:.12f}"),
    ("murari", "±x_1 Omega = 0.3", "0.77658213"),
    ("murari", "±x_1 Omega = 0.15", "0.60303691"),
    ("murari", "±x_2 Omega = 0.15", "0.26546352"),
    ("guardia_hogan_seara", "F/P A_1: Omega = 1/2", "0.3333333"),
    ("guardia_hogan_seara", "F/P A_2: Omega = 1/4", "0.0666667"),
    ("guardia_hogan_seara", "Omega c = 0.1", "0.4759318789"),
    ("guardia_hogan_seara", "F c = 0.1", "0.2482868963"),
    ("iklodi_dombovari", "Omega 0.7", "0.7486857"),
    ("iklodi_dombovari", "Omega 1.2", "1.2062691"),
    ("iklodi_dombovari", "stops Omega = 0.7486", "2"),
    ("iklodi_dombovari", "stops Omega = 0.7487", "0"),
    ("iklodi_dombovari", "stops Omega = 1.2062", "0"),
    ("iklodi_dombovari", "stops Omega = 1.2063", "2"),
    ("iklodi_dombovari", "Omega s = F", "0.722679194438"),
    ("andronov_vitt_khaikin", "T m = 1, k = 1", "8.9026054078145230110698192"),
    ("andronov_vitt_khaikin", "V", "0.549046312058"),
    ("pulled_spring", "first stick V = 1/10, k = 2", "4.000000000000"),
    ("pulled_spring", "second stick", "3.000000000000"),
    ("pulled_spring", "slip", "2.844417623070"),
    ("bossolini_brons_kristiansen", "t where it stops", "2.028757838110"),
    ("leine", "x_max extrapolated", "1.1339446764"),
    ("falling_friction", "V bSTAB, n = 1024", "1.1513"),
    ("falling_friction", "V Veraszto and Stepan, n = 1024", "0.1906"),
    ("falling_friction", "V from both", "1.8366"),
    ("bossolini_brons_kristiansen", "x there", "-0.045073564710"),
    ("stender_hoffmann", "share V = 1.5", "0.31"),
    ("stender_hoffmann", "share V = 1.775", "0.558"),
)
#: The abstract of Hong and Liu (2000) names these numbers of stops per cycle.
COUNTS = {0, *range(2, 15, 2)}


def assert_as_printed(name: str, output: str) -> None:
    """Assert that a script printed what is known of its results."""
    rows = [re.split(r"\s{2,}", line.strip()) for line in output.splitlines()]
    for script, beginning, wanted in PRINTED:
        if script == name:
            row = next(row for row in rows if " ".join(row).startswith(beginning))
            digits = len(wanted.partition(".")[2])
            numbers = [cell for cell in row if re.fullmatch(r"-?\d+(\.\d+)?", cell)]
            assert [f"{Decimal(number):.{digits}f}" for number in numbers] == [wanted] * 2
    if name == "hong_liu":
        notes = re.findall(r"(\d+) stops below, (\d+) above", output)
        assert {int(count) for note in notes for count in note} <= COUNTS
