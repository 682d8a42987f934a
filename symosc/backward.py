"""Backward in time from a tangency to the boundary that the flow came from: no contact is passed over.

Why nothing can be missed
-------------------------
With s = t_m - t the velocity of a flight obeys v'' - (c/m) v' + (k/m) v = -(B0 Omega/m) sin(theta - Omega s): damping
has changed its sign, the transient grows. So the bounds of `symosc.events`, which rest on an energy that never grows,
do not hold backward. For the n-th derivative y of v the energy E = y'^2 + (k/m) y^2 obeys

    d/ds sqrt(E) <= (c/m) sqrt(E) + (|B0| Omega/m) Omega^n,

hence over a step H, with y = v^(n) and y' = v^(n+1) taken at its beginning,

    |v^(n+1)| <= exp(c H/m) (sqrt(E) + H (|B0| Omega/m) Omega^n),

which bounds the remainder of the Taylor polynomial of degree n. The steps are short (STEP over the largest rate), so
the remainder is below the rounding error. On each step the gap to a wall is that polynomial, known within `noise`:
remainder, rounding, and the errors of all steps before, which grow like the energy. `symosc.grazing_roots` finds its
first root. At the tangency where the search starts, the known root is divided out of the polynomial. The bounds hold in
real arithmetic; what rounding may add to them (ROUNDING) was measured.

A contact that the noise leaves open is a touch as far as this precision tells. A search in double precision hands such
a step to one with more digits (`look`), and goes on from there as if it had just begun.

A flight that never met a wall is recognised where that can happen at all, in an over- or critically damped system: by
a transient that runs away from the only wall for ever (`never_came`). An underdamped transient that grows comes back.

The functions are scalar and run on floats and on mpmath numbers; `functions` is `math` or an mpmath context.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from symosc.flow import Constants
from symosc.grazing_roots import first_root
from symosc.kernels._generated import next_derivative

# What a search ends with: a contact; a touch, as far as the precision tells; the end of the time; a flight that never
# met a wall; velocities beyond HUGE; all steps used up.
CONTACT, TOUCH, REACHED, NEVER, LARGE, LONG = "contact", "touch", "reached", "never", "large", "long"

# Length of a step, times the largest rate of the system.
STEP = 0.5
# Rounding error of a Taylor polynomial in units of eps times the size of its terms.
ROUNDING = 8
# What a flight must stay away from a wall to be said never to have met it, as a part of the velocity's size.
CLEAR = 1e-9
# Velocities that are no longer followed: doubles end not far above.
HUGE = 1e250
# The work of a search: more than 100 periods at the fastest drive, and less than a second.
MOST_STEPS = 20_000


class Arrival(NamedTuple):
    """Where a backward flight ends: `tau` before the tangency, displaced by dx, with velocity v and acceleration a."""

    kind: str
    boundary: int  # of the wall that was met, else 0
    tau: Any
    dx: Any
    v: Any
    a: Any
    v_error: Any  # bound of the error of v at that time
    x_error: Any


class Wall(NamedTuple):
    """A wall of the domain: its number, its velocity, and the direction into the domain, 1 up or -1 down."""

    boundary: int
    v: Any
    inward: int


class State(NamedTuple):
    """A flight `tau` before the tangency, with the bounds of its errors."""

    tau: Any
    dx: Any
    v: Any
    a: Any
    energy_error: Any
    v_error: Any
    x_error: Any


class Found(NamedTuple):
    """A contact on a step: at its part `sigma`, with which wall, and whether it is open (a touch)."""

    touch: bool
    sigma: Any
    wall: Wall


def walls_of(domain: int, K: Constants) -> list[Wall]:
    """Return the walls of domain 1, 2 or 3."""
    walls = [Wall(domain - 1, K.belt1.v if domain == 2 else K.belt2.v, 1)] if domain > 1 else []
    return walls + ([Wall(domain, K.belt1.v if domain == 1 else K.belt2.v, -1)] if domain < 3 else [])


class Backward:
    """Searches of one system from tangencies at one belt, in one arithmetic.

    Parameters
    ----------
    K : Constants
    boundary, domain : int
        The belt that is touched and the domain of the flow.
    functions, eps :
        The arithmetic of `K`, and its unit of rounding.
    step : float
        Length of a step times K.rate.
    """

    def __init__(self, K: Constants, boundary: int, domain: int, functions: Any, eps: Any, step: float = STEP) -> None:
        self.K, self.boundary, self.functions, self.eps = K, boundary, functions, eps
        self.domain, self.walls = domain, walls_of(domain, K)
        self.v = next(wall.v for wall in self.walls if wall.boundary == boundary)
        n, H = _degree(eps, step), step / K.rate
        self.n, self.H, self.growth = n, H, functions.exp(K.cm * H)
        # Taylor coefficients T[k] = v^(k) H^k/k! backward: the equation of motion with these in place of its constants.
        power, self.recurrence = K.fB * H * H, []
        for k in range(n):
            power = power / (k + 2) if k else power / 2
            self.recurrence.append((power, -K.cm * H / (k + 2), K.w0sq * H * H / ((k + 1) * (k + 2))))
            power = power * K.Om * H
        self.drive_remainder = abs(power)

    def begin(self, zero: Any) -> State:
        """Return the state at the tangency."""
        return State(zero, zero, self.v + zero, zero, zero, zero, zero)

    def run(
        self,
        theta: Any,
        order: int,
        tau_max: Any,
        look: Callable[[Any], tuple[Arrival | None, State]] | None = None,
        most_steps: int = MOST_STEPS,
    ) -> Arrival:
        """Follow the flow backward from the tangency at the phase theta, to the first contact or over tau_max.

        Parameters
        ----------
        theta : number of this arithmetic
        order : int
            Order of the first G-function that does not vanish there, 1 or 3.
        tau_max : number
            Time to search.
        look : callable, optional
            Judges with more digits what is open on the step that begins at a given time: returns the arrival there, or
            None and the state behind.
        most_steps : int
        """
        state = self.begin(0 * theta)
        for _ in range(most_steps):
            found, T, state = self.over(theta, order, state)
            if found and found.touch and look is not None and state.tau <= tau_max:
                arrival, state = look(state.tau)
                if arrival is not None:
                    return arrival if arrival.tau <= tau_max else self._reached(theta, order, state, tau_max)
                continue
            tau = state.tau + (found.sigma if found else 1) * self.H
            if tau > tau_max:
                return self._reached(theta, order, state, tau_max)
            if found:
                ended = self._moved(state, T, found.sigma)
                kind = TOUCH if found.touch else CONTACT
                return Arrival(kind, found.wall.boundary, *ended[:2], found.wall.v, *ended[3:4], *ended[5:])
            s, c = self._wave(theta, state.tau)
            if state.tau > 0 and self.never_came(state, s, c):
                return Arrival(NEVER, 0, *state[:4], *state[5:])
            state = self._moved(state, T, 1)
            if abs(state.v) > HUGE:
                return Arrival(LARGE, 0, *state[:4], *state[5:])
        return Arrival(LONG, 0, *state[:4], *state[5:])

    def over(self, theta: Any, order: int, state: State) -> tuple[Found | None, list[Any], State]:
        """Return the first contact on the step from a state, Taylor coefficients of v, and the errors at its end."""
        K, H, eps = self.K, self.H, self.eps
        tau, v, a = state.tau, state.v, state.a
        T, remainder = self._taylor(v, a, *self._wave(theta, tau))
        rounding = ROUNDING * eps * (abs(a) * H + (K.w0sq * abs(v) + abs(K.fB) * (1 + abs(theta) + K.Om * tau)) * H * H)
        energy_error = self.growth * state.energy_error + rounding / H
        v_error = self.growth * state.v_error + H * energy_error + rounding + eps * abs(v)
        if K.w0 > 0:
            v_error = min(v_error, energy_error / K.w0 + rounding + eps * abs(v))
        energy_error = max(energy_error, K.w0 * rounding)
        spread = sum(map(abs, T)) - abs(T[0])
        found = None
        for wall in self.walls:
            at_start = tau == 0 and wall.boundary == self.boundary
            noise = remainder + (rounding if at_start else v_error)
            gap = wall.inward * (T[0] - wall.v)
            if not at_start and gap - spread > noise:
                continue
            p = [wall.inward * term for term in (T[order + 1 :] if at_start else T)]
            touch, sigma = first_root(p if at_start else [gap, *p[1:]], noise, eps)
            if sigma is not None and (found is None or sigma < found.sigma):
                found = Found(touch, sigma, wall)
        return found, T, state._replace(energy_error=energy_error, v_error=v_error)

    def _wave(self, theta: Any, tau: Any) -> tuple[Any, Any]:
        angle = theta - self.K.Om * tau
        return self.functions.sin(angle), self.functions.cos(angle)

    def _taylor(self, v: Any, a: Any, s: Any, c: Any) -> tuple[list[Any], Any]:
        """Return the Taylor coefficients of v over the part of a step gone back, and the bound of the remainder."""
        sines = (s, -c, -s, c)  # (-d/dphase)^k sin
        T = [v, -a * self.H]
        for k, (power, cm, w0sq) in enumerate(self.recurrence):
            T.append(next_derivative(T[k + 1], T[k], power * sines[k % 4], cm, w0sq))
        last = T.pop()
        size = abs(last) + self.K.w0 * self.H * abs(T[-1]) / (self.n + 1) + self.drive_remainder
        return T, self.growth * size

    def _moved(self, state: State, T: list[Any], sigma: Any) -> State:
        """Return the state at the part `sigma` of the step from `state`, whose errors are those at its end."""
        v = slope = area = 0 * state.v
        for k in range(len(T) - 1, -1, -1):
            slope = slope * sigma + v
            v = v * sigma + T[k]
            area = area * sigma + T[k] / (k + 1)
        dx = state.dx - self.H * sigma * area
        x_error = state.x_error + self.H * state.v_error + self.eps * abs(dx)
        return State(
            state.tau + sigma * self.H, dx, v, -slope / self.H, state.energy_error, state.v_error, x_error
        )

    def _reached(self, theta: Any, order: int, state: State, tau_max: Any) -> Arrival:
        """Return the end of the search, reached on the step from a state."""
        _, T, state = self.over(theta, order, state)
        ended = self._moved(state, T, (tau_max - state.tau) / self.H)
        return Arrival(REACHED, 0, *ended[:4], *ended[5:])

    def never_came(self, state: State, s: Any, c: Any) -> bool:
        """Return whether, going on backward from a state where the phase has sine s and cosine c, no wall is met."""
        K = self.K
        if K.under or self.domain == 2:
            return False
        u = state.v - (K.Ss * s + K.Sc * c)
        u_slope = -(state.a - K.Om * (K.Ss * c - K.Sc * s))
        # u = alpha exp(p s) + beta exp(q s) with p >= q >= 0: once it falls with alpha <= 0 it falls for ever
        sign = self.walls[0].inward
        away = sign * u_slope >= 0 and sign * (u_slope + K.l1 * u) >= 0
        clear = K.V0 + state.v_error + CLEAR * (abs(state.v) + K.V0)
        return bool(away and sign * (u - self.walls[0].v) > clear)


def _degree(eps: Any, step: float) -> int:
    n, term = 0, 1.0 / eps
    while term > 0.1:
        n += 1
        term = term * step / n
    return n
