"""Derivatives of a motion by parameters and by its start: of every event, and of the state at any time.

Between two events the end of a flight is a function of its launch, of both phases and of the parameters; the kernels
of the mappings have its partial derivatives in closed form. What ends it (a belt's speed is reached, or a force on the
belt vanishes) gives the derivative of its time by the implicit function theorem. So the derivatives of all events
follow from each other, through crossings and sticks; nothing is differenced.

At a graze a motion is differentiable on one side only by each number that moves the gap. There the derivatives are
those of the side on which the touch opens, `regular` is False from there on, and `reasons` names the side.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from math import inf, log
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symosc.aliases import Number, NumberLike, SceneName
from symosc.arguments import public
from symosc.engine.arithmetic import many_digits, mp_context
from symosc.engine.flow import constant_force
from symosc.engine.start import Start
from symosc.engine.state import ON_BELT
from symosc.errors import ParameterError, meant
from symosc.kernels._generated import acceleration
from symosc.mappings.equations import friction_weights, map_arithmetic
from symosc.model import MODE_NAMES, PARAMETER_NAMES, Parameters
from symosc.scenes import Scene
from symosc.simulation.simulate import read_start, simulate
from symosc.simulation.trajectory import Event, Trajectory, read_times

STARTS = ("t0", "x0", "v0")
#: A gap is not moved by what changes it by less than this part of the terms of its derivative.
UNMOVED = 1e-9
#: What decides an event vanishes where it is smaller than this part of its terms.
VANISHES = 1e-12
#: Digits beside those that are asked for, and of the phase of a start in doubles.
SPARE, PHASE_DIGITS = 10, 40
MODES = {name: code for code, name in MODE_NAMES.items()}


@dataclass(frozen=True)
class Launch:
    """The start of a piece: its mode, time, reduced phase and state, with the derivatives of t, x and v."""

    mode: int
    t: Number
    theta: Number
    x: Number
    v: Number
    dt: np.ndarray
    dx: np.ndarray
    dv: np.ndarray


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities:
    """The derivatives of a motion.

    Calling it gives those of the state: ``s(t)`` are the derivatives of [x, v] at a fixed time, of shape (2, wrt) for a
    scalar and (2, n, wrt) for n times.

    Attributes
    ----------
    trajectory : Trajectory
        The motion.
    wrt : tuple of str
        What it is differentiated by.
    dt, dx : array, (events, wrt)
        Total derivatives of the time and the position of each event.
    regular : array of bool, (events, wrt)
        Whether the derivative exists; where not, the number is that of one side.
    reasons : tuple
        For each event a text on what is not regular from there on, or None.
    lyapunov : array, (2,)
        The exponents, per unit of time, of the distance of neighbouring motions over this motion; the second is -inf
        where a stick occurred.

    Examples
    --------
    >>> from symosc import sensitivities
    >>> s = sensitivities("fig9", ("Omega", "x0"))
    >>> s.dt.shape, bool(s.regular.all()), bool(s.lyapunov[0] < 0)
    ((12, 2), True, True)
    """

    trajectory: Trajectory
    wrt: tuple[str, ...]
    dt: np.ndarray
    dx: np.ndarray
    regular: np.ndarray
    reasons: tuple[str | None, ...]
    lyapunov: np.ndarray
    _launches: tuple[Launch, ...] = field(repr=False)

    @public
    def __call__(self, t: ArrayLike) -> np.ndarray:
        """Return the derivatives of [x, v] at the times `t`.

        Raises
        ------
        ParameterError
            If a time is outside [t_start, t_end].

        Examples
        --------
        >>> from symosc import sensitivities
        >>> s = sensitivities("fig9", ("x0", "k"))
        >>> s(2.0).shape, s([2.0, 3.0]).shape
        ((2, 2), (2, 2, 2))
        """
        given = read_times(t)
        self.trajectory(given)  # which checks their range
        tangent, rows = Tangent(self.trajectory, self.wrt), []
        for each in map(tangent.number, given.ravel().tolist()):
            launch = next((launch for launch in reversed(self._launches) if launch.t <= each), self._launches[0])
            rows.append(tangent.state_change(launch, each)[:2])
        return np.moveaxis(np.array(rows), 0, 1).reshape((2, *given.shape, len(self.wrt)))

    def __eq__(self, other: object) -> bool:
        """Whether all public entries are equal."""
        if not isinstance(other, Sensitivities):
            return NotImplemented
        names = [each.name for each in fields(self) if not each.name.startswith("_")]
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in names)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        first = next((n for n, row in enumerate(self.regular) if not row.all()), None)
        about = "" if first is None else f", not all regular from event {first} on"
        return f"<Sensitivities of {len(self.dt)} events by {', '.join(self.wrt)}{about}>"


class Tangent:
    """The linearised motion: what changes with the numbers `wrt`, in the arithmetic of a trajectory."""

    def __init__(self, trajectory: Trajectory, wrt: tuple[str, ...]) -> None:
        self.p, self.wrt, digits = trajectory.parameters, wrt, trajectory.digits
        self.context = None if digits is None else mp_context(digits + SPARE)
        self.numbers = map_arithmetic(self.p, self.context)
        self.K, self.of = self.numbers.K, self.numbers.of
        self.m, self.Omega = self.numbers.number(self.p.m), self.numbers.number(self.p.Omega)

    def number(self, value: Any) -> Any:
        """Return a number of this arithmetic."""
        return float(value) if self.context is None else self.context.mpf(value)

    def change_of(self, name: str) -> np.ndarray:
        """Return the derivative of a parameter or number of the start: 1 by itself, 0 by the others."""
        return np.array([self.number(each == name) for each in self.wrt])

    def by_parameters(self, parts: dict[str, Any], domain: int) -> np.ndarray:
        """Return derivatives by all parameters from those by m, c, k, A_alpha, B0 and Omega."""
        whole = parts | {"A0": parts["A"]}
        for name, weight in friction_weights(self.p, domain, self.numbers.number).items():
            whole[name] = parts["A"] * weight
        return np.array([self.number(0) + whole.get(name, 0) for name in self.wrt])

    def first(self, start: Start, mode: int) -> Launch:
        """Return the launch at the start of a motion."""
        number = self.numbers.number
        theta = many_digits(self.p, PHASE_DIGITS if self.context is None else self.context.dps).phase(start.t0)[1]
        changes = (self.change_of(name) for name in STARTS)
        t, x, v = number(start.t0), number(start.x0), number(start.v0)
        return Launch(mode, t, self.number(theta), x, v, *changes)

    def state_change(self, launch: Launch, t: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the derivatives of x and v at a fixed time in a piece, and the size of the terms of the latter."""
        if launch.mode > ON_BELT:
            dv = self.change_of(f"v{launch.mode - ON_BELT}")
            return launch.dx + dv * (t - launch.t) - launch.v * launch.dt, dv, abs(dv)
        K, A = self.K, constant_force(launch.mode, self.K)
        theta = launch.theta + self.Omega * (t - launch.t)
        start = launch.x, launch.theta, theta, launch.v, A
        x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = self.of["flight_slopes"](*start, K)
        *letters, x_v0, v_v0 = self.of["flight_by_parameters"](*start, self.m, K)
        names = ("m", "c", "k", "A", "B0", "Omega")
        of_x, of_v = (self.by_parameters(dict(zip(names, letters[n::2], strict=True)), launch.mode) for n in (0, 1))
        dOmega = self.change_of("Omega")
        theta0, theta1 = self.Omega * launch.dt + launch.t * dOmega, t * dOmega
        dx = x_x0 * launch.dx + x_th0 * theta0 + x_th1 * theta1 + x_v0 * launch.dv + of_x
        terms = v_x0 * launch.dx, v_th0 * theta0, v_th1 * theta1, (1 + v_v0) * launch.dv, of_v
        return dx, np.sum(terms, axis=0), np.sum(np.abs(terms), axis=0)

    def force(self, domain: int, x: Any, v: Any, theta: Any) -> tuple[Any, bool]:
        """Return the acceleration in a domain, and whether it vanishes."""
        K, A = self.K, constant_force(domain, self.K)
        F = acceleration(x, v, self.of["cos"](theta), A, K.cm, K.w0sq, K.f0)
        return F, abs(F) <= VANISHES * (abs(A) + abs(K.cm * v) + abs(K.w0sq * x) + abs(K.f0))

    def vanishing(self, domain: int, point: tuple[Any, Any, Any, Any], dx: Any, dv: Any) -> tuple[np.ndarray, bool]:
        """Return the derivative of the time at which the acceleration of a domain vanishes, and whether it exists.

        `point` is t, x, v, theta there; dx and dv are derivatives at this fixed time.
        """
        t, x, v, theta = point
        F, _ = self.force(domain, x, v, theta)
        of_c, of_k, of_A, of_B, of_v, of_m, _, _ = self.of["stick_by_parameters"](x, theta, theta, v, F, self.m, self.K)
        _, _, of_x, of_theta = self.of["stick_slopes"](theta, v, self.K)
        parts = {"m": of_m, "c": of_c, "k": of_k, "A": of_A, "B0": of_B, "Omega": of_theta * t}
        rate = of_x * v + of_theta * self.Omega
        flat = abs(rate) <= VANISHES * (abs(of_x * v) + abs(self.K.f0 * self.Omega))
        # of_v is the derivative by a belt's speed, which changes the damping force alone
        change = of_x * dx + of_v * dv + self.by_parameters(parts, domain)
        return -change / (rate if rate else 1), not flat


@public
def sensitivities(
    what: Scene | Parameters | SceneName,
    wrt: str | Sequence[str] = ("Omega", "mu1", "x0"),
    *,
    t0: NumberLike | None = None,
    x0: NumberLike | None = None,
    v0: NumberLike | None = None,
    t_end: NumberLike | None = None,
    max_events: int | None = None,
    digits: int | None = None,
) -> Sensitivities:
    """Differentiate a motion: every event, and the state at any time, by parameters and by the start.

    Parameters
    ----------
    what, t0, x0, v0, t_end, max_events, digits
        The motion, as for `symosc.simulate`.
    wrt : str or sequence of str
        Names of parameters, and t0, x0, v0.

    Returns
    -------
    Sensitivities

    Raises
    ------
    ParameterError
        If a name is unknown or given twice; and what `simulate` raises.

    Examples
    --------
    >>> from symosc import sensitivities
    >>> s = sensitivities("fig5", ("mu1", "x0"), t_end=3)
    >>> s.trajectory.events[1].kind, s.dt[1].round(6).tolist()
    ('slip', [0.93701, -0.095516])
    """
    names = (wrt,) if isinstance(wrt, str) else tuple(wrt)
    known = (*PARAMETER_NAMES, *STARTS)
    for name in names:
        if name not in known:
            raise ParameterError("wrt", name, f"must be of {', '.join(known)}{meant(str(name), known)}")
    if not names or len(set(names)) < len(names):
        raise ParameterError("wrt", names, "must be one or more different names")
    start = read_start(what, {"t0": t0, "x0": x0, "v0": v0, "t_end": t_end}, None)
    about: dict[str, Any] = {"t0": start.t0, "x0": start.x0, "v0": start.v0, "t_end": start.t_end}
    if start.start_error:
        about["start_error"] = start.start_error
    motion = simulate(start.parameters, **about, max_events=max_events, digits=digits)
    return _differentiated(motion, start, names)


def _differentiated(motion: Trajectory, start: Start, wrt: tuple[str, ...]) -> Sensitivities:
    """Return the derivatives of a motion.

    Two more columns, by x0 and v0, are divided by their size at each event: from these follow the exponents.
    """
    tangent, count = Tangent(motion, (*wrt, "x0", "v0")), len(wrt)
    launch = tangent.first(start, MODES[motion.segments[0].mode])
    launches, rows, reasons = [launch], [], list[str | None]()
    regular, said = _regular_at(launch, tangent)
    grown, volume = 0.0, 0.0
    for event in motion.events:
        point = tuple(tangent.number(each) for each in (event.t, event.x, event.v, event.theta))
        dx, dv, size = tangent.state_change(launch, point[0])
        belt = tangent.change_of(f"v{event.boundary}")
        if event.kind == "graze":
            dt, _ = tangent.vanishing(launch.mode, point, dx, dv)
            moved = (dv - belt) * (-1 if launch.mode == event.boundary else 1)  # > 0 where the touch opens
            kink = abs(moved) > UNMOVED * (size + abs(belt))
            sides = [f"{name} {'larger' if up > 0 else 'smaller'}" for name, up, is_kink in
                     zip(wrt, moved, kink, strict=False) if is_kink]  # fmt: skip
            why = f"after the graze at t = {float(event.t):.6g} for {', '.join(sides)}" if sides else None
            exists = ~np.array(kink, dtype=bool)
        else:
            dt, why = _event_time(tangent, launch, event, point, (dx, dv))
            exists = np.full(len(regular), why is None)
        regular = regular & exists
        rows.append((dt[:count], (dx + point[2] * dt)[:count], regular[:count]))
        reasons.append("; ".join(filter(None, (said, why))) or None)
        said = None
        if event.kind != "graze":
            volume += _log_volume(tangent, launch, event, point)
            after = Launch(MODES[event.target], *_at(point), dt, dx + point[2] * dt, belt)
            launch, scale = _rescaled(after, count)
            grown += scale
            launches.append(launch)
    kind: Any = float if tangent.context is None else object
    dts, dxs, regulars = (
        np.array([row[n] for row in rows], dtype=dtype).reshape(-1, count) for n, dtype in enumerate((kind, kind, bool))
    )
    cut = tuple(replace(each, dt=each.dt[:count], dx=each.dx[:count], dv=each.dv[:count]) for each in launches)
    exponents = _exponents(tangent, launch, motion, grown, volume)
    return Sensitivities(motion, wrt, dts, dxs, regulars, tuple(reasons), exponents, cut)


def _at(point: tuple[Any, Any, Any, Any]) -> tuple[Any, Any, Any, Any]:
    """Return t, theta, x, v from t, x, v, theta."""
    t, x, v, theta = point
    return t, theta, x, v


def _regular_at(launch: Launch, tangent: Tangent) -> tuple[np.ndarray, str | None]:
    """Return by what a motion is differentiable at its start: not by what takes a flight off the belt it starts on."""
    belts = [
        f"v{n}" for n in (1, 2) if launch.mode <= ON_BELT and launch.v == tangent.numbers.number(tangent.p.belt(n))
    ]
    moved = [name for name in tangent.wrt[:-2] if belts and name in ("v0", *belts)]
    why = f"the start is on a belt: by {', '.join(moved)} for starts on the side of the flight" if moved else None
    return np.array([name not in moved for name in tangent.wrt]), why


def _event_time(
    tangent: Tangent, launch: Launch, event: Event, point: tuple[Any, Any, Any, Any], changes: tuple[Any, Any]
) -> tuple[np.ndarray, str | None]:
    """Return the derivative of the time of an event, or why there is none."""
    _, x, v, theta = point
    if launch.mode > ON_BELT:
        dt, exists = tangent.vanishing(MODES[event.target], point, *changes)
        return dt, None if exists else f"the force that ends the stick at t = {float(event.t):.6g} has no slope there"
    F, flat = tangent.force(launch.mode, x, v, theta)
    dt = (tangent.change_of(f"v{event.boundary}") - changes[1]) / (F if F else 1)
    if flat:
        return dt, f"the contact at t = {float(event.t):.6g} has no slope"
    other = event.boundary + 1 if launch.mode == event.boundary else event.boundary
    if tangent.force(other, x, v, theta)[1]:
        return dt, f"a force on belt {event.boundary} vanishes at t = {float(event.t):.6g}"
    return dt, None


def _log_volume(tangent: Tangent, launch: Launch, event: Event, point: tuple[Any, Any, Any, Any]) -> float:
    """Return the logarithm by which a piece and its end multiply areas of the phase plane."""
    t, x, v, theta = point
    if launch.mode > ON_BELT or event.kind == "stick":
        return -inf
    before, after = (tangent.force(domain, x, v, theta)[0] for domain in (launch.mode, MODES[event.target]))
    return -float(tangent.K.cm * (t - launch.t)) + log(abs(float(after / before)) or 1.0)


def _rescaled(launch: Launch, count: int) -> tuple[Launch, float]:
    """Return a launch with its last two columns divided by their size, and the logarithm of that."""
    size = max(float(abs(each)) for column in (launch.dt, launch.dx, launch.dv) for each in column[count:])
    if not 0.0 < size < inf:
        return launch, 0.0
    factors = np.array([1.0] * count + [1.0 / size] * 2)
    return replace(launch, dt=launch.dt * factors, dx=launch.dx * factors, dv=launch.dv * factors), log(size)


def _exponents(tangent: Tangent, launch: Launch, motion: Trajectory, grown: float, volume: float) -> np.ndarray:
    """Return the Lyapunov exponents over a motion, the larger one first."""
    end = tangent.number(motion.t_end)
    span = float(end - tangent.number(motion.t_start))
    if launch.mode <= ON_BELT:
        volume -= float(tangent.K.cm * (end - launch.t))
    else:
        volume = -inf
    dx, dv, _ = tangent.state_change(launch, end)
    matrix = np.array([dx[-2:], dv[-2:]], dtype=float)
    size = float(np.linalg.norm(matrix, 2))
    first = (grown + log(size)) / span if size > 0.0 else -inf
    second = volume / span - first if volume > -inf else -inf
    return np.array(sorted((first, second), reverse=True))
