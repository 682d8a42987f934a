"""The residuals of a fit: how far the motion with given numbers is from what was measured."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from symosc.analysis.fitting.coordinates import Coordinates
from symosc.analysis.fitting.measured import Measured
from symosc.analysis.fitting.other_models import ModelSensitivities, model_sensitivities
from symosc.base.errors import ParameterError
from symosc.derivatives.sensitivities import Sensitivities, sensitivities
from symosc.engine.start import Start
from symosc.model import Model
from symosc.reductions import numbers_of, with_numbers
from symosc.scenes import STARTS, Original, Scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

#: Residuals of numbers that no motion has, such as v1 > v2, in sizes of the data (`Problem.sizes`).
IMPOSSIBLE = 1e3
#: The motion goes on after the last measured event for this part of its length: an event may come
#: late.
BEYOND = 0.05


class Evaluation(NamedTuple):
    """Residuals of a motion, their derivatives by the free numbers, and the motion."""

    residuals: np.ndarray
    slopes: np.ndarray
    trajectory: Trajectory


@dataclass
class Effort:
    """How many motions a fit has simulated."""

    motions: int = 0


@dataclass
class FitProblem:
    """What is fitted to what: the motion `scene` with the numbers `names` to `measured`.

    `sigmas` are the standard deviations of the columns. Parts of a problem share its `effort`.
    """

    scene: Start
    names: tuple[str, ...]
    measured: Measured
    sigmas: np.ndarray
    end: float
    effort: Effort = field(default_factory=Effort)
    _last: tuple[tuple[float, ...], Evaluation] | None = field(default=None, repr=False)

    def first_values(self) -> np.ndarray:
        """Return the first values of the free numbers."""
        scene = self.scene
        values = scene.parameters.numbers() | {name: getattr(scene, name) for name in STARTS}
        return np.array([float(values[name]) for name in self.names])

    @cached_property
    def belt_speeds(self) -> list[float]:
        """The speeds of the belts, in the coordinates of the data."""
        return [float(belt.v) for belt in self.scene.parameters.law.belts]

    @cached_property
    def coordinates(self) -> Coordinates:
        """What the search varies."""
        return Coordinates(self.names, self.scene.parameters)

    @cached_property
    def weights(self) -> np.ndarray:
        """The standard deviation of each residual."""
        return np.repeat(self.sigmas[: len(self.measured.columns)], len(self.measured.t))

    @cached_property
    def sizes(self) -> np.ndarray:
        """How large a residual may be, in sigmas: the time between events, or the size of x, v."""
        measured = self.measured
        if measured.states is not None:
            sizes = np.repeat(np.std(measured.states, axis=1), len(measured.t))
        else:
            sizes = np.full(len(measured.t), spacing(measured.t, measured.kinds))
        return np.maximum(sizes, 1e-9) / self.weights

    def until(self, time: float) -> FitProblem:
        """Return the problem of the data up to a time."""
        measured = self.measured
        rows = measured.t <= time
        kinds = measured.kinds
        extra = 0.0
        if kinds is not None:
            extra = 2.0 * spacing(measured.t, kinds)
            kinds = kinds[rows]
        states = measured.states
        if states is not None:
            states = states[:, rows]
        early = replace(measured, t=measured.t[rows], kinds=kinds, states=states)
        return replace(self, measured=early, end=min(self.end, time + extra), _last=None)

    def thinned(self, most: int) -> FitProblem:
        """Return the problem with at most about `most` samples."""
        return replace(self, measured=self.measured.thinned(most), _last=None)

    def distances(self, values: np.ndarray) -> np.ndarray:
        """Return the residuals with these values; infinite ones if no motion has them."""
        self.effort.motions += 1
        try:
            motion = self._simulated(values)
        except ParameterError:
            return np.full(len(self.weights), np.inf)
        residuals, _ = self._compare(motion, None)
        return residuals

    def evaluate(self, values: np.ndarray) -> Evaluation:
        """Return residuals, derivatives and motion; ParameterError for values of no motion."""
        # The search asks for residuals and for slopes at the same values, one after the other.
        key = tuple(values.tolist())
        if self._last is not None:
            last_key, last_evaluation = self._last
            if last_key == key:
                return last_evaluation
        self.effort.motions += 1
        moved = self._differentiated(values)
        residuals, slopes = self._compare(moved.trajectory, moved)
        evaluation = Evaluation(residuals, slopes, moved.trajectory)
        self._last = key, evaluation
        return evaluation

    def _simulated(self, values: np.ndarray) -> Trajectory:
        """Return the motion with these values."""
        p, start = self._motion(values)
        return simulate(p, **start)

    def _differentiated(self, values: np.ndarray) -> Sensitivities | ModelSensitivities:
        """Return the motion with these values and its derivatives by the free numbers."""
        p, start = self._motion(values)
        return sensitivities(p, self.names, **start)

    def _texts(self, values: np.ndarray) -> dict[str, str]:
        """Return the values by name, as texts: `replace` and `simulate` read them exactly."""
        return dict(zip(self.names, map(repr, values.tolist()), strict=True))

    def _motion(self, values: np.ndarray) -> tuple[Model, dict[str, Any]]:
        """Return the parameters and the start with these values, as `simulate` takes them."""
        new = self._texts(values)
        changes = {name: new[name] for name in self.names if name not in STARTS}
        start = {name: new.get(name, getattr(self.scene, name)) for name in STARTS}
        return self.scene.parameters.replace(**changes), {**start, "t_end": self.end}

    def _compare(
        self, motion: Trajectory, moved: Sensitivities | ModelSensitivities | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return (motion - data) / sigma, and derivatives if `moved` has those of the motion."""
        if self.measured.states is None:
            off, slopes = self._compare_events(motion, None if moved is None else moved.dt)
        else:
            off, slopes = self._compare_states(motion, moved)
        return off / self.weights, slopes / self.weights[:, None]

    def _compare_states(
        self, motion: Trajectory, moved: Sensitivities | ModelSensitivities | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the motion minus the samples, and derivatives."""
        states = self.measured.states
        assert states is not None
        times = np.clip(self.measured.t, float(motion.t_start), float(motion.t_end))
        rows = len(states)
        off = (np.asarray(motion(times), dtype=float)[:rows] - states).ravel()
        slopes = np.zeros((len(off), len(self.names)))
        if moved is not None:
            slopes = moved(times)[:rows].reshape(slopes.shape)
        return off, slopes

    def _compare_events(
        self, motion: Trajectory, changes: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return times of events minus measured times, each of the nearest event of its kind.

        A measured event of a kind that the motion lacks is compared with the end.
        """
        measured = self.measured
        times = np.array([float(event.t) for event in motion.events])
        kinds = np.array([event.kind for event in motion.events], dtype=object)
        off = self.end - measured.t
        slopes = np.zeros((len(off), len(self.names)))
        for kind in dict.fromkeys(measured.kinds.tolist() if measured.kinds is not None else ()):
            rows = np.flatnonzero(measured.kinds == kind)
            events = np.flatnonzero(kinds == kind)
            if not len(events):
                continue
            # The nearest event is the one before a measured time or the one after it. Before the
            # first event and after the last one both are clipped to the events that there are.
            after = np.maximum(np.searchsorted(times[events], measured.t[rows]), 1)
            after = np.minimum(after, len(events) - 1)
            before = np.maximum(after - 1, 0)
            gap_before = times[events[before]] - measured.t[rows]
            gap_after = times[events[after]] - measured.t[rows]
            nearest = events[np.where(abs(gap_before) <= abs(gap_after), before, after)]
            off[rows] = times[nearest] - measured.t[rows]
            if changes is not None:
                slopes[rows] = changes[nearest]
        return off, slopes


@dataclass
class ModelFitProblem(FitProblem):
    """A fit of another model, in its own coordinates: `original` is the motion as it was given, and
    `scene` that of the oscillator, whose friction has the same orders and bounds.
    """

    original: Original = field(kw_only=True)

    def first_values(self) -> np.ndarray:
        """Return the first values of the free numbers."""
        original = self.original
        values = numbers_of(original.model)
        values |= {name: getattr(original, name) for name in STARTS}
        return np.array([float(values[name]) for name in self.names])

    @cached_property
    def belt_speeds(self) -> list[float]:
        """The mean speeds of the belts, in the coordinates of the data."""
        pull = float(self.original.model.pull)
        return [speed + pull for speed in super().belt_speeds]

    def _simulated(self, values: np.ndarray) -> Trajectory:
        return simulate(self._model_scene(values))

    def _differentiated(self, values: np.ndarray) -> ModelSensitivities:
        return model_sensitivities(self._model_scene(values), self.names)

    def _model_scene(self, values: np.ndarray) -> Scene:
        """Return the scene of the model with these values."""
        new = self._texts(values)
        changes = {name: new[name] for name in self.names if name not in STARTS}
        start = {name: new.get(name, getattr(self.original, name)) for name in STARTS}
        model: Any = with_numbers(self.original.model, changes)
        return Scene("fit", model, **start, t_end=self.end)  # type: ignore[arg-type]


def spacing(times: np.ndarray, kinds: np.ndarray | None) -> float:
    """Return the median time between events of one kind, or without two of a kind between all."""
    if kinds is None:
        groups = [times]
    else:
        groups = [times[kinds == kind] for kind in sorted(set(kinds))]
    gaps = np.concatenate([np.diff(np.sort(group)) for group in groups])
    gaps = gaps[gaps > 0.0]
    if not len(gaps):
        gaps = np.diff(np.unique(times))
    if not len(gaps):
        return 1.0
    return float(np.median(gaps))
