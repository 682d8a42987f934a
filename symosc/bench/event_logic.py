"""The event logic that a careful user of an ODE integrator writes: floats, Theorems 4 to 6, nothing of our engine.

The motion is a chain of phases, a flight through a domain or a stick on a belt. Each is a smooth ODE with functions
that are positive in its inside and fall through zero where it ends. An integrator is asked to leave one phase at a
time; what follows there is decided here, from the forces on both sides of the belt.

A touch of a belt without a change of sign is no event to an integrator: exact grazes are not found. Only a flight that
ends at a belt by so little that the forces send it back is a "graze" here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import cos, pi, sin, sqrt
from typing import NamedTuple

from symosc.engine.arithmetic import mp_context
from symosc.errors import SymoscError
from symosc.model import MODE_NAMES, NEIGHBOURS, Parameters
from symosc.reference.compare import FoundEvents
from symosc.scenes import Scene

State = Sequence[float]
Scalar = Callable[[float, State], float]

#: This oscillator never has so many events within one period (of `Motion`).
CHATTER = 100

# What careful users of step-by-step integrators set, found by trial on the shipped scenes and some hundred random ones:
#: Flights from a belt start this part of the larger belt speed off it. Errors after a near graze are in proportion
#: (1e-12 costs two digits in fig8); from the belt itself, some flights come back at once for ever.
INTEGRATOR_OFFSET = 1e-14
#: Multistep methods: at least this part of rtol. They start with order 1, so that the first steps away from the belt
#: are wrong by as much as rtol allows; closer to it, the way back is found at the start, and there for ever.
MULTISTEP_OFFSET = 0.1
#: Steps per period at least. With 4, coarse tolerances lose events of fig8; with more than 8, fine ones gain nothing.
STEPS_PER_PERIOD = 8
#: atol by rtol. With atol = rtol the same error costs the same.
ATOL = 1e-3

# A force, or a derivative of one, within this part of the sum of its terms is zero up to rounding.
FORCE_ROUNDING = 1e-15
# Derivatives that are looked at where a force vanishes.
MOST_DERIVATIVES = 5


class PeerError(SymoscError, RuntimeError):
    """A peer that cannot go on.

    Attributes
    ----------
    reason : str
    found : list of FoundEvents
        The events up to there.
    """

    def __init__(self, reason: str, found: Sequence[FoundEvents] = ()) -> None:
        self.reason, self.found = reason, list(found)
        super().__init__(reason)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.reason, self.found)


class Phase(NamedTuple):
    """A stretch of smooth motion, as an integrator is given it. All functions are of (t, (x, v)).

    Attributes
    ----------
    mode : int
        1 to 3 a domain, 4 and 5 a stick on belt 1 and 2 (the codes of `symosc.model.MODE_NAMES`).
    rate : callable
        The right-hand side, (dx/dt, dv/dt).
    exits : tuple of (int, callable)
        Ways out: -1 downward, +1 upward, each with a function that is positive inside and falls through 0 at the exit.
    turn : callable
        The time derivative of the exit functions, up to its sign: between two of its zeros each of them is monotone.
    jacobian : tuple
        The derivative of `rate` to (x, v), constant.
    """

    mode: int
    rate: Callable[[float, State], tuple[float, float]]
    exits: tuple[tuple[int, Scalar], ...]
    turn: Scalar
    jacobian: tuple[tuple[float, float], tuple[float, float]]


class Exit(NamedTuple):
    """Where a phase was left: side -1 or +1, or 0 if it lasts to the end that was asked for."""

    side: int
    t: float
    x: float


#: ``leave(phase, t, x, v, t_end)`` follows a phase from there until it ends.
Leave = Callable[[Phase, float, float, float, float], Exit]
#: The same, and the turning points that were passed, as pairs (t, (x, v)).
LeaveWithTurns = Callable[[Phase, float, float, float, float], tuple[Exit, Iterable[tuple[float, State]]]]


def _angle(value: Fraction) -> float:
    """Return an angle, which may be large, modulo 2 pi."""
    context = mp_context(40 + len(str(abs(value.numerator))))
    return float(context.fmod(context.mpf(value.numerator) / value.denominator, 2 * context.pi))


class Motion:
    """A parameter set in floats: forces, phases, and what happens at a boundary.

    Parameters
    ----------
    parameters : Parameters
    origin : Fraction
        The time from which t is counted. Counted from a late start, times keep their digits, and so does the drive.

    Attributes
    ----------
    theta : float
        Phase of the drive at the origin.
    belts : dict of float
        Speed of belt 1 and 2.
    speed : float
        The larger belt speed: the unit of small velocities.
    period : float
        The shorter one of the periods of the drive and of the free oscillation, if there is one.
    phases : dict of Phase
        By mode.
    """

    def __init__(self, parameters: Parameters, origin: Fraction = Fraction(0)) -> None:
        self.origin, self.theta = origin, _angle(parameters.Omega * origin)
        self.m, self.c, self.k, self.B0, self.Omega = (
            float(getattr(parameters, name)) for name in ("m", "c", "k", "B0", "Omega")
        )
        self.A = {alpha: float(parameters.A(alpha)) for alpha in (1, 2, 3)}
        self.belts = {boundary: float(parameters.belt(boundary)) for boundary in NEIGHBOURS}
        self.speed = max(map(abs, self.belts.values()))
        stiffness, decay = self.k / self.m, self.c / (2 * self.m)
        self.period = 2 * pi / max(self.Omega, sqrt(max(0.0, stiffness - decay * decay)))
        self.phases = {alpha: self._flight(alpha) for alpha in self.A}
        self.phases |= {3 + boundary: self._stick(boundary) for boundary in NEIGHBOURS}

    def force(self, alpha: int) -> Scalar:
        """Return F^(alpha), the acceleration in a domain (eq. (9)), as a function of (t, (x, v))."""
        A, B0, Omega, theta, k, c, m = self.A[alpha], self.B0, self.Omega, self.theta, self.k, self.c, self.m

        def force(t: float, y: State) -> float:
            return (A + B0 * cos(Omega * t + theta) - k * y[0] - c * y[1]) / m

        return force

    def _flight(self, alpha: int) -> Phase:
        force, exits = self.force(alpha), []
        if alpha > 1:
            lower = self.belts[alpha - 1]
            exits.append((-1, lambda t, y: y[1] - lower))
        if alpha < 3:
            upper = self.belts[alpha]
            exits.append((1, lambda t, y: upper - y[1]))

        def rate(t: float, y: State) -> tuple[float, float]:
            return y[1], force(t, y)

        return Phase(alpha, rate, tuple(exits), force, ((0.0, 1.0), (-self.k / self.m, -self.c / self.m)))

    def _stick(self, boundary: int) -> Phase:
        below, above = (self.force(alpha) for alpha in NEIGHBOURS[boundary])
        speed = self.belts[boundary]
        pull, swing = -self.k * speed / self.m, self.B0 * self.Omega / self.m
        Omega, theta = self.Omega, self.theta
        # Both exits: into the domain below when F^(below) falls to 0, above when F^(above) rises to 0.
        exits = ((-1, below), (1, lambda t, y: -above(t, y)))

        def rate(t: float, y: State) -> tuple[float, float]:
            return speed, 0.0

        def slope(t: float, y: State) -> float:
            return pull - swing * sin(Omega * t + theta)

        return Phase(3 + boundary, rate, exits, slope, ((0.0, 0.0), (0.0, 0.0)))

    def sign_of_force(self, alpha: int, t: float, x: float, v: float) -> int:
        """Return the sign that F^(alpha) has at a boundary; where it is 0, the one that it gets at once (Theorem 6)."""
        phase, swing, stiffness = self.Omega * t + self.theta, self.B0 / self.m, self.k / self.m
        terms = self.A[alpha] / self.m, swing * cos(phase), -stiffness * x, -self.c / self.m * v
        before, now, size = v, sum(terms), sum(map(abs, terms)) + abs(swing * phase)
        for order in range(MOST_DERIVATIVES):
            if abs(now) > FORCE_ROUNDING * size:
                return 1 if now > 0 else -1
            # The next derivative of m v'' + c v' + k v = -B0 Omega sin(Omega t); v' and what follows is 0 so far.
            swing *= self.Omega
            wave = (-sin(phase), -cos(phase), sin(phase), cos(phase))[order % 4]
            now, size = swing * wave - stiffness * before, abs(swing) * (1 + abs(phase)) + abs(stiffness * before)
            before = 0.0
        return 0

    def resolve(self, boundary: int, t: float, x: float) -> int:
        """Return the mode that follows at a point of a boundary: passing (Theorem 5) or else a stick (Theorem 4)."""
        below, above = NEIGHBOURS[boundary]
        v = self.belts[boundary]
        if self.sign_of_force(above, t, x, v) > 0:
            return above
        if self.sign_of_force(below, t, x, v) < 0:
            return below
        return 3 + boundary

    def start(self, t: float, x: float, v: float) -> tuple[int, int]:
        """Return the mode in which a motion starts, and the boundary that it starts on or 0."""
        boundary = next((boundary for boundary, speed in self.belts.items() if v == speed), 0)
        if boundary:
            return self.resolve(boundary, t, x), boundary
        return 1 + sum(v > speed for speed in self.belts.values()), 0


def follow(scene: Scene, motion: Motion, leave: Leave, offset: float = 0.0) -> list[FoundEvents]:
    """Follow a scene from phase to phase and return its events.

    Parameters
    ----------
    scene : Scene
    motion : Motion
        That of the scene's parameters, with any origin.
    leave : callable
        The integrator, see `Leave`.
    offset : float
        Flights from a belt start this part of the larger belt speed off it, on their own side. 0.0 starts them on it,
        where the function that should find the way back is 0.

    Raises
    ------
    PeerError
        If the integrator gives up, or there are CHATTER events within one period; with the events up to there.
    """
    t, x, v, t_end = map(float, (scene.t0 - motion.origin, scene.x0, scene.v0, scene.t_end - motion.origin))
    origin = float(motion.origin)
    mode, boundary = motion.start(t, x, v)
    found: list[FoundEvents] = []
    while t < t_end:
        if boundary and mode < 4:
            v += (1 if mode > boundary else -1) * offset * motion.speed
        try:
            side, t, x = leave(motion.phases[mode], t, x, v, t_end)
        except PeerError as error:
            raise PeerError(error.reason, found) from None
        if side == 0:
            break
        source = mode
        if source > 3:
            boundary = source - 3
            mode, kind = NEIGHBOURS[boundary][side > 0], "slip"
        else:
            boundary = source - (side < 0)
            mode = motion.resolve(boundary, t, x)
            kind = "stick" if mode > 3 else "graze" if mode == source else "cross"
        v = motion.belts[boundary]
        found.append(FoundEvents(origin + t, x, kind, boundary))
        if len(found) > CHATTER and found[-1].t - found[-1 - CHATTER].t < motion.period:
            where = f"between {MODE_NAMES[source]} and {MODE_NAMES[mode]} near t = {origin + t:.6g}"
            raise PeerError(f"chatters {where}: {CHATTER} events within one period", found)
    return found


def watching(leave: LeaveWithTurns) -> Leave:
    """Return an integrator that goes back when an exit function has turned outside.

    Out and back within one step leaves no change of sign between the ends of the step. But it turned in between, and
    from the start to there the sign changes once.
    """

    def watch(phase: Phase, t: float, x: float, v: float, t_end: float) -> Exit:
        end, turns = leave(phase, t, x, v, t_end)
        for turn, state in turns:
            if t < turn < end.t and any(function(turn, state) < 0 for _, function in phase.exits):
                before, _ = leave(phase, t, x, v, float(turn))
                if before.side:
                    return before
        return end

    return watch
