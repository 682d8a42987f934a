"""More digits where doubles are in doubt: the same problem once more, and what makes an open contact a touch.

A contact that stays open with BACKUP_DIGITS digits is looked at with `touch_digits`. Open still, it is a graze. Decided
only there, the trajectory ends as "undecidable": from here on double precision, backed up as it is, would guess.

How many digits a touch takes: a motion that tends to one that grazes has gaps that shrink like exp(-rate t), and each
of them is a near miss, or a crossing. Only digits beyond that tell them from a touch.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from math import ceil, log

from symosc.aliases import Number
from symosc.engine.flow import Constants, constants
from symosc.engine.start import Start, is_steady
from symosc.engine.state import FAILED
from symosc.simulation.run import Path, Searched

BACKUP_DIGITS = 36
# A contact that is open with this many times the digits may be a touch.
TOUCH_TIMES = 3
TOUCH_SPARE = 20
# Digits up to which also the fast root of an overdamped system is counted, and up to which touches are told.
MOST_FAST = 600
MOST_TOUCH = 2500


def touch_digits(path: Path, elapsed: Number, digits: int) -> int | None:
    """Return with how many digits a contact after the time `elapsed` must be open to be a touch; None for too many.

    The influence of the start may have shrunk by exp(-rate elapsed), with the larger rate of decay of the free motion,
    or, where that takes too many digits, with the smaller one: only starts without any share of the slow decay are
    fooled by that. A start that is on the steady motion has none of it, until something else than a graze happens.
    """
    start = path.start
    K: Constants = constants(start.parameters)
    fast, slow = (K.h, K.h) if K.under else (-K.l2, -K.l1)
    fast_digits, slow_digits = (ceil(float(elapsed) * rate / log(10)) for rate in (fast, slow))
    if is_steady(start) and all(event.kind == "graze" for event in path.events):
        fast_digits = 0
    decay = fast_digits if fast_digits <= MOST_FAST else max(MOST_FAST, slow_digits)
    needed = max(TOUCH_TIMES * digits, digits + TOUCH_SPARE + decay)
    return needed if needed <= max(MOST_TOUCH, TOUCH_TIMES * digits) else None


class Backup:
    """The same problem with more digits, followed only as far as it is asked for.

    Attributes
    ----------
    digits : int
        The working precision.
    path : Path
        What has been followed so far.
    """

    def __init__(self, start: Start) -> None:
        self.start = start
        self.digits = BACKUP_DIGITS + start.spare_digits
        self.path = Path(start, self.digits, rounds=True)
        self._finer: Path | None = None

    def follow(self, count: int, searches: Iterable[Searched] = ()) -> bool:
        """Follow the path to `count` events or to its end; False if a contact on the way is open.

        `searches` is what doubles found from where this path is, by decisions that exceed their errors.
        """
        path = self.path
        path.searches = deque(searches)
        while len(path.events) < count and not path.ended:
            before = len(path.events)
            path.step()
            if path.code == FAILED or not (path.decided or self.start.start_error or self._is_touch(before)):
                return False
        return True

    def _is_touch(self, before: int) -> bool:
        """Tell whether the contact after `before` events is open with many more digits too; if so, take that one."""
        base = 2 * self.digits // TOUCH_TIMES  # at least twice the digits
        needed = touch_digits(self.path, self.path.elapsed, base)
        if needed is None:
            return False
        if self._finer is None or self._finer.arithmetic.digits < needed:
            whole = touch_digits(self.path, self.start.t_end - self.start.t0, base)
            self._finer = Path(self.start, min(whole or MOST_TOUCH, 3 * needed))
        finer = self._finer
        while len(finer.events) <= before and not finer.ended:
            finer.step()
            if not finer.decided and len(finer.events) >= before:
                if len(self.path.events) > before and len(finer.events) > before:
                    self.path.events[-1] = finer.events[-1]
                return finer.code != FAILED
        return False
