"""Many trajectories at once: arrays in, columns of events out, compiled by numba where it is installed."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import acos
from pathlib import Path
from typing import Any

import numpy as np

from symosc import loop
from symosc.advance import END, REST
from symosc.errors import MissingExtraError, ParameterError
from symosc.exact import read_exact
from symosc.files import write_whole
from symosc.model import MODE_NAMES, Parameters
from symosc.numerics import Arithmetic, compiled
from symosc.path import EVENT_KINDS, START_DIGITS, Start, first_state, rounded
from symosc.numerics import MpArithmetic
from symosc.simulate import MOST_EVENTS, simulate, whole_number

CAPACITY = 1 << 16
#: Names of the codes in the columns of an EventTable.
KIND_NAMES = {code: name for code, name in EVENT_KINDS.items()}
STATUS_NAMES = {END: "t_end", REST: "t_end", loop.FULL: "max_events", loop.IN_DOUBT: "undecidable"}
