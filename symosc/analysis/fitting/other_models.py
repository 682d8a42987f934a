"""Derivatives of a motion of another model by the model's own numbers, in its own coordinates.

The model has x(t) = z(t - delay) + w(t) + pull t, where z is the motion of an oscillator whose
numbers and start depend on those of the model. So its derivatives follow by the chain rule from the
`sensitivities` of z. What depends on the model's numbers there is smooth and cheap, and is computed
in rational numbers of 40 digits and more: a forward difference with a tiny step has all digits of a
double.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError
from symosc.base.exact import show
from symosc.derivatives.sensitivities import Sensitivities, sensitivities
from symosc.friction import geometry
from symosc.reductions import (
    OtherModel,
    numbers_of,
    reduced_model,
    reduced_start,
    with_numbers,
)
from symosc.scenes import STARTS, Original, Scene
from symosc.simulation.tangents import names_of, read_wrt
from symosc.simulation.trajectory import MovedTrajectory, Trajectory

#: The step of differences, relative to a number or, if that is less than 1, absolute: its square
#: is above the rounding of numbers with 40 digits, and the step itself below that of doubles.
STEP = Fraction(1, 10**18)


@dataclass(frozen=True, eq=False)
class ModelSensitivities:
    """The derivatives of a motion of another model, called like `Sensitivities`.

    Attributes
    ----------
    trajectory : MovedTrajectory
        The motion, in the coordinates of the model.
    wrt : tuple of str
        The numbers of the model and of its start by which the motion is differentiated.
    dt : array, (events, wrt)
        Total derivatives of the time of each event.
    """

    trajectory: MovedTrajectory
    wrt: tuple[str, ...]
    dt: np.ndarray
    _reduced: Sensitivities = field(repr=False)
    _slopes: ReductionSlopes = field(repr=False)

    def __call__(self, t: np.ndarray) -> np.ndarray:
        """Return the derivatives of [x, v] at times of the model, (2, times, wrt)."""
        motion = self.trajectory.reduced
        _, times = self.trajectory._times(t)
        changes = self._reduced(times) @ self._slopes.jacobian
        # At a fixed time of the model a longer delay means an earlier time of the oscillator.
        rates = np.stack([motion(times)[1], _acceleration(motion, times)])
        changes -= rates[..., None] * self._slopes.delay
        return np.asarray(changes + self._slopes.frame(t))


@dataclass(frozen=True, eq=False)
class ReductionSlopes:
    """How the reduction of a problem depends on numbers of the model and its start.

    Attributes
    ----------
    names : tuple of str
        The numbers of the oscillator and of its start.
    jacobian : array, (names, wrt)
        Their derivatives.
    delay : array, (wrt,)
        Those of the delay.
    """

    model: OtherModel
    names: tuple[str, ...]
    jacobian: np.ndarray
    delay: np.ndarray
    _rates: Mapping[str, np.ndarray] = field(repr=False)

    def frame(self, t: np.ndarray) -> np.ndarray:
        """Return the derivatives of w + pull t and of its rate at times t, (2, times, wrt)."""
        model = self.model
        rates = self._rates
        angles = float(model.Omega) * t
        cos = np.cos(angles)[:, None]
        sin = np.sin(angles)[:, None]
        changes = []
        for name, wave in (("shift", model.shift), ("rate", model.shift.rate(model.Omega))):
            by_sizes = rates[f"{name} cos"] * cos + rates[f"{name} sin"] * sin
            by_angle = float(wave.S) * cos - float(wave.C) * sin
            changes.append(by_sizes + by_angle * t[:, None] * rates["Omega"])
        position, velocity = changes
        return np.stack([position + rates["pull"] * t[:, None], velocity + rates["pull"]])


def model_sensitivities(scene: Scene, wrt: Sequence[str]) -> ModelSensitivities:
    """Differentiate the motion of a scene of another model by numbers of the model and its start.

    Raises ParameterError if a name is unknown or given twice, or if the reduction is not smooth:
    where the drive vanishes, a number may move its phase at will.
    """
    assert scene.original is not None
    wrt = read_wrt(wrt, (*numbers_of(scene.original.model), *STARTS))
    slopes = reduction_slopes(scene.original, wrt)
    reduced = sensitivities(scene.reduced(), slopes.names)
    motion = MovedTrajectory(reduced.trajectory, scene.original)
    return ModelSensitivities(
        motion, wrt, reduced.dt @ slopes.jacobian + slopes.delay, reduced, slopes
    )


def reduction_slopes(original: Original, wrt: Sequence[str]) -> ReductionSlopes:
    """Return how the reduction of a problem depends on the numbers `wrt`."""
    model = original.model
    values = numbers_of(model) | {name: getattr(original, name) for name in STARTS}
    here = _reduction(original)
    slopes = {name: np.zeros(len(wrt)) for name in here}
    for n, name in enumerate(wrt):
        value = values[name]
        step = STEP * max(abs(value), 1)
        beyond = _reduction(_with_number(original, name, value + step))
        for key, number in here.items():
            slopes[key][n] = float((beyond[key] - number) / step)
    B0, lag = _polar_slopes(model, slopes, wrt)
    Omega = float(model.Omega)
    delay = lag / Omega - float(model.lag) / Omega**2 * slopes["Omega"]
    by_name = slopes | {"B0": B0, "t0": slopes["t0"] - delay}
    own = names_of(reduced_model(model))
    names = tuple(name for name in own if name in STARTS or by_name[name].any())
    jacobian = np.array([by_name[name] for name in names])
    return ReductionSlopes(model, names, jacobian, delay, slopes)


def _with_number(original: Original, name: str, value: Fraction) -> Original:
    """Return a problem with another number of its model or of its start."""
    change: dict[str, Any] = {name: value}
    if name not in STARTS:
        change = {"model": with_numbers(original.model, change)}
    return original._replace(**change)


def _reduction(original: Original) -> dict[str, Fraction]:
    """Return what a reduction consists of, by name, in quantities that are smooth functions of the
    problem: the drive by its two parts, and the start without the delay.
    """
    model = original.model
    start, _ = reduced_start(model, original.t0, original.x0, original.v0)
    _, x0, v0 = start
    rate = model.shift.rate(model.Omega)
    parts = {"t0": original.t0, "x0": x0, "v0": v0, "pull": model.pull}
    for name, wave in (("drive", model.drive), ("shift", model.shift), ("rate", rate)):
        parts |= {f"{name} cos": wave.C, f"{name} sin": wave.S}
    return reduced_model(model).numbers() | parts


def _polar_slopes(
    model: OtherModel, slopes: Mapping[str, np.ndarray], wrt: Sequence[str]
) -> tuple[np.ndarray, np.ndarray]:
    """Return the derivatives of R and psi of the drive R cos(Omega t - psi), where R may be
    negative.
    """
    P = float(model.drive.C)
    Q = float(model.drive.S)
    R = float(model.oscillator.B0)
    by_cos = slopes["drive cos"]
    by_sin = slopes["drive sin"]
    if R == 0:
        for name, slope in zip(wrt, by_sin.tolist(), strict=True):
            if slope:
                allowed = (
                    "must be such that there is a drive: the phase of a drive that vanishes has no "
                    "derivative by this number"
                )
                raise ParameterError(name, show(numbers_of(model)[name]), allowed)
        return by_cos, np.zeros_like(by_sin)
    return (P * by_cos + Q * by_sin) / R, (P * by_sin - Q * by_cos) / R**2


def _acceleration(motion: Trajectory, times: np.ndarray) -> np.ndarray:
    """Return the acceleration of an oscillator at times; at an event the one that follows."""
    modes = motion.mode(times)
    accelerations = np.zeros(len(times))  # what it is in a stick
    for domain in geometry(len(motion.parameters.law.belts)).domains:
        here = modes == f"Omega{domain}"
        if here.any():
            accelerations[here] = motion.force(domain, times[here])
    return accelerations
