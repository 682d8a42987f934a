"""Checks and claims that stand in for the paper's."""

from __future__ import annotations

from matplotlib.figure import Figure

CHECKS = """
import os
import time
from pathlib import Path
from symosc.paper.claims import CONFIRMED, NOT_AS_PRINTED, Evidence
def right(): return Evidence(CONFIRMED, "It is 1 <2>.", {"a|b": "1e-20", "F(1)": "-3"})
def wrong(): return Evidence(NOT_AS_PRINTED, "It is 3.", {"x": "3"})
def raises(): raise ZeroDivisionError("by nothing")
def dies(): os._exit(7)
def no_evidence(): return True
def interrupts(): raise KeyboardInterrupt
NUMBER = 9
def given(number, letter): return Evidence(CONFIRMED, "It is so.", {"number": number, "letter": letter})
def shared():
    own = Path(__file__).with_name(f"process-{os.getpid()}")
    own.touch()
    until = time.monotonic() + 600
    while len(list(own.parent.glob("process-*"))) < 2 and time.monotonic() < until:
        time.sleep(0.01)
    return Evidence(CONFIRMED, "Done.", {"process": str(os.getpid())})
"""

CLAIM = """
[model.{id}]
source = "Section 9, Fig. 1"
says = "1 < 2"
check = "stand_ins.{check}"
"""


# Worker processes import these by the name of this module; they cannot import a module of tests.


def good_picture() -> Figure:
    figure = Figure(figsize=(1, 1))
    figure.add_subplot().plot([0, 1], [0, 1])
    return figure


def bad_picture() -> Figure:
    raise ValueError("no such curve")
