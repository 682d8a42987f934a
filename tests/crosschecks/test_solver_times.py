"""Times of events that a solver lists without kinds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from symosc import load_scene, simulate
from symosc.crosschecks.compare import STEP_TOLERANCE, Judge
from symosc.crosschecks.samples import checked

FIG9 = load_scene("fig9")
MOTION = simulate(FIG9, t_end=6)
T = np.linspace(0.1324, 6, 400)
SAMPLES = checked(T, *MOTION(T))
TIMES = [float(event.t) for event in MOTION.events]


def verdict(times: list[float]):  # type: ignore[no-untyped-def]
    listed = replace(SAMPLES, events=tuple((time, "") for time in sorted(times)))
    return Judge(FIG9, STEP_TOLERANCE, None, True, True)(listed)


def test_a_list_may_have_all_or_some_of_the_events() -> None:
    for times in (TIMES, TIMES[::2], TIMES[:1], [float(T[0]), *TIMES]):
        check = verdict(times)
        assert check.ok, check.summary()
        assert [match.event for match in check.matched] == list(MOTION.events)


def test_a_time_that_is_late_or_at_no_event_is_invented() -> None:
    for late in (1e-3, 1.0):
        check = verdict([*TIMES[:-1], TIMES[-1] - late])
        assert not check.ok
        assert [event.t for event in check.invented] == [TIMES[-1] - late]
    errors = [match.error for match in verdict([TIMES[0] + 1e-10]).matched]
    assert abs(errors[0] - 1e-10) < 1e-13
