"""The motion of another model, from that of the oscillator that it is (`symosc.reductions`)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.arguments import public
from symosc.engine.events import Event
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.reductions import event_back, motion_of_belts, number_of
from symosc.scenes import Original
from symosc.simulation.trajectory import Trajectory, read_times


class MovedTrajectory(Trajectory):
    """The motion of another model that is this one in other coordinates; a `Trajectory` in those of the model.

    Attributes
    ----------
    model : OtherModel
    reduced : Trajectory
        The motion of the oscillator that the model is.

    Examples
    --------
    >>> from symosc import OtherModel, simulate
    >>> motion = simulate(OtherModel(m=1, k=1, Omega="3/2", FN="1/2", Y=1, joined=True), t_end=8)
    >>> motion(2.5).round(6).tolist(), motion.reduced(2.5).round(6).tolist()
    ([-0.627853, -0.79439], [0.192706, -1.651732])
    """

    def __init__(self, reduced: Trajectory, original: Original) -> None:
        self.model, self.reduced = original.model, reduced
        number, message = number_of(reduced.t_end), f"reached t_end = {show(original.t_end)}"
        delay, end = number(self.model.delay), number(original.t_end)
        if reduced.status != "t_end":
            message = f"{reduced.message} (of the oscillator that the model is; its time is {float(delay):.6g} less)"
            end = end if reduced.status == "equilibrium" else reduced.t_end + delay
        super().__init__(
            reduced.parameters,
            lambda: [self._event(event) for event in reduced.events],
            reduced._pieces,
            reduced.status,
            message,
            (number(original.t0), end),
            reduced._first_at,
            reduced.digits,
        )

    def _event(self, event: Event) -> Event:
        """Return an event in the coordinates of the model."""
        t, x, v, theta = event_back(self.model, event.t, event.x, event.v, event.theta)
        x_error = event.x_error + float(abs(v - event.v)) * event.t_error
        return replace(event, t=t, x=x, v=v, theta=theta, x_error=x_error)

    def _times(self, t: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return times of the model, and those of the oscillator; ParameterError for one that is out of range."""
        times, low, high = read_times(t), float(self.t_start), float(self.t_end)
        for outside in times[~((times >= low) & (times <= high))][:1]:
            raise ParameterError("t", float(outside), f"must be within [{low!r}, {high!r}]")
        ends = float(self.reduced.t_start), float(self.reduced.t_end)
        return times, np.clip(times - float(self.model.delay), *ends)

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return [x, v] at the times `t`, as those of a Trajectory."""
        times, own = self._times(t)
        return np.asarray(self.reduced(own) + np.stack(motion_of_belts(self.model, times)))

    @public
    def mode(self, t: ArrayLike) -> Any:
        """Return the mode at a time, or an array of them."""
        return self.reduced.mode(self._times(t)[1])

    @public
    def force(self, alpha: int, t: ArrayLike) -> Any:
        """Return F^(alpha) of eq. (9): the acceleration in a domain less that of the belts, whose sign decides."""
        return self.reduced.force(alpha, self._times(t)[1])

    def as_dict(self) -> dict[str, Any]:
        """Return parameters, status, events and the numbers of the model as plain values."""
        return {"model": self.model.as_dict()} | super().as_dict()

    def _content(self) -> tuple[Any, ...]:
        return self.model, *super()._content()


def belt_path(trajectory: Trajectory, boundary: int, t: np.ndarray) -> np.ndarray:
    """Return displacement and velocity of a point of a belt at some times, (2, n), in the coordinates of a motion."""
    speed = float(trajectory.parameters.belt(boundary))
    path = np.stack([speed * t, np.full(t.shape, speed)])
    return path + np.stack(motion_of_belts(trajectory.model, t)) if isinstance(trajectory, MovedTrajectory) else path
