"""A trajectory in the form of other packages."""

from __future__ import annotations

import copy
import pickle

import pytest

from symosc import crosscheck, load_scene, simulate


@pytest.mark.parametrize("digits", [None, 25])
def test_a_motion_as_the_result_of_scipy(digits: int | None) -> None:
    scene = load_scene("fig6")
    trajectory = simulate(scene, digits=digits)
    computed = trajectory.to_scipy()
    assert (computed.status, computed.success, computed.message) == (0, True, trajectory.message)
    assert computed.t.tolist() == [
        float(scene.t0),
        *(float(event.t) for event in trajectory.events),
        float(scene.t_end),
    ]
    assert (computed.t.dtype, computed.y.dtype, computed.y.shape) == (
        float,
        float,
        (2, len(computed.t)),
    )
    assert [len(times) for times in computed.t_events] == [2, 1]
    assert computed.y_events[1][0].tolist() == pytest.approx([float(trajectory.events[0].x), 5.0])
    assert computed.sol(1.0) == pytest.approx(trajectory(1.0))
    assert crosscheck("fig6", computed).ok
    stopped = simulate("fig6", max_events=3)  # at the time of its last event, to the last bit
    assert not stopped.to_scipy().success
    assert stopped.t_end == stopped.events[-1].t


def test_a_motion_with_many_digits_is_copied_before_its_events_are_read() -> None:
    """They are made when somebody reads them, from what cannot be pickled."""
    for again in (lambda motion: pickle.loads(pickle.dumps(motion)), copy.deepcopy):
        motion = simulate("fig6", digits=25)
        computed = again(motion)
        assert computed == motion
        assert [str(event.t) for event in computed.events] == [
            str(event.t) for event in simulate("fig6", digits=25).events
        ]
