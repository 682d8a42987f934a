"""A trajectory in the form of other packages."""

from __future__ import annotations

import copy
import pickle

import pytest

from symosc import crosscheck, load_scene, simulate


@pytest.mark.parametrize("digits", [None, 25])
def test_a_motion_as_the_result_of_scipy(digits: int | None) -> None:
    one = load_scene("fig6")
    trajectory = simulate(one, digits=digits)
    found = trajectory.to_scipy()
    assert (found.status, found.success, found.message) == (0, True, trajectory.message)
    assert found.t.tolist() == [
        float(one.t0),
        *(float(event.t) for event in trajectory.events),
        float(one.t_end),
    ]
    assert (found.t.dtype, found.y.dtype, found.y.shape) == (float, float, (2, len(found.t)))
    assert [len(times) for times in found.t_events] == [2, 1]
    assert found.y_events[1][0].tolist() == pytest.approx([float(trajectory.events[0].x), 5.0])
    assert found.sol(1.0) == pytest.approx(trajectory(1.0))
    assert crosscheck("fig6", found).ok
    stopped = simulate("fig6", max_events=3)  # at the time of its last event, to the last bit
    assert not stopped.to_scipy().success
    assert stopped.t_end == stopped.events[-1].t


def test_a_motion_with_many_digits_is_copied_before_its_events_are_read() -> None:
    """They are made when somebody reads them, from what cannot be pickled."""
    for again in (lambda motion: pickle.loads(pickle.dumps(motion)), copy.deepcopy):
        motion = simulate("fig6", digits=25)
        found = again(motion)
        assert found == motion
        assert [str(event.t) for event in found.events] == [
            str(event.t) for event in simulate("fig6", digits=25).events
        ]
