"""Where the flow into a tangency came from: searched in double precision, decided and polished with more digits."""

from __future__ import annotations

from collections.abc import Callable

from symosc.aliases import Angle, Number
from symosc.engine.flow import constants
from symosc.errors import ParameterError
from symosc.grazing.backward_flow import CONTACT, LONG, MOST_BACKWARD_STEPS, REACHED, Arrival, BackwardState, Search
from symosc.grazing.flight import LOOK_STEPS, Flights, rounded
from symosc.mappings.theorem7_cases import place
from symosc.model import Parameters

# How far back a start is looked for, in periods of the excitation.
SEARCH_PERIODS = 100
# Digits of the first look at a step that is open; the second look has twice as many.
LOOK_DIGITS, MOST_LOOK_DIGITS = 60, 200
# How many open steps of one flight are looked at: a flight that keeps to a boundary for longer stays open.
MOST_LOOKS = 40
#: A kind of arrival besides those of `symosc.grazing.backward_flow`: no number of digits tried has decided.
OPEN_ORIGIN = "open"


class Origins:
    """The origins of the flows into the tangencies of one mapping.

    Parameters
    ----------
    p : Parameters
    mapping : str
        "P2", "P3", "P5" or "P6".

    Raises
    ------
    ParameterError
        For a mapping without grazing, and for k = 0.
    """

    def __init__(self, p: Parameters, mapping: str) -> None:
        where = place(mapping)
        if p.k == 0:
            raise ParameterError("k", "0", "must be > 0 here: without a spring F = 0 fixes the phase, not the contact")
        self.p, self.mapping, self.place, self.K = p, mapping, where, constants(p)
        self._search = Search(self.K, where.boundary, where.domain)
        self._flights: dict[int, Flights] = {}

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.p, self.mapping)

    def flights(self, digits: int) -> Flights:
        """Return flights with that many digits, made once."""
        if digits not in self._flights:
            self._flights[digits] = Flights(self.p, self.mapping, digits)
        return self._flights[digits]

    def arrival(
        self,
        angle: Angle | float,
        order: int = 1,
        far: float | None = None,
        careful: bool = True,
        digits: int = LOOK_DIGITS,
        looks: int = len(LOOK_STEPS),
        most_steps: int = MOST_BACKWARD_STEPS,
    ) -> Arrival:
        """Return where the flow into the tangency at an exact angle (or a float) came from, in double precision.

        What was looked at with more digits keeps them.

        Parameters
        ----------
        angle : float, Fraction or sympy constant
        order : int
            Order of the first G-function that does not vanish there.
        far : float, optional
            Time to search; default SEARCH_PERIODS periods.
        careful : bool
            Whether to look with more digits at what is open; otherwise it is a touch.
        digits : int
            Digits of the first look at what is open; the second look has twice as many.
        looks : int
        most_steps : int
        """
        far = SEARCH_PERIODS * self.K.period if far is None else far
        look = self._look(angle, order, digits, looks) if careful else None
        return self._search.run(float(angle), order, far, look, most_steps)

    def _look(
        self, angle: Angle | float, order: int, digits: int, looks: int
    ) -> Callable[[float], tuple[Arrival | None, BackwardState]]:
        left = MOST_LOOKS

        def look(tau: float) -> tuple[Arrival | None, BackwardState]:
            nonlocal left
            arrival, state = None, self._search.begin(0.0)
            if tau > 0:  # often it is only the bound of the error that has grown
                flights = self.flights(digits)
                fresh = rounded(flights.state(flights.number(angle), tau))
                found, step_taken, after = self._search.over(float(angle), order, fresh)
                if found is None:
                    return None, self._search.ended(after, step_taken)
                if not found.touch:
                    return self._search.arrival(after, step_taken, found), fresh
            left -= 1
            for times, step in enumerate(LOOK_STEPS[:looks], start=1):
                flights = self.flights(times * digits)
                arrival, state = flights.look(flights.number(angle), order, tau, step)
                if arrival is None or arrival.kind == CONTACT:
                    break
            if arrival is None:
                return (None, state) if left else (Arrival(LONG, 0, *state[:4], *state[5:]), state)
            return arrival, state

        return look

    def exact(
        self, angle: Angle | float, order: int, far: Callable[[Flights], Number], wanted: int
    ) -> tuple[Arrival, Flights]:
        """Return where the flow came from with `wanted` digits after the point, and the flights that it is one of.

        Parameters
        ----------
        angle : Fraction or sympy constant
        order : int
        far : callable
            The time to search as a number of the given flights.
        wanted : int
        """
        flights = self.flights(wanted + 20)
        found = self.arrival(angle, order, float(far(flights)), digits=min(wanted + 20, MOST_LOOK_DIGITS))
        while True:
            theta = flights.number(angle)
            arrival = flights.polished(theta, found, far(flights))
            if arrival is None:
                return found._replace(kind=OPEN_ORIGIN), flights
            if arrival.kind not in (REACHED, LONG) and arrival.tau > far(flights):
                found = found._replace(kind=REACHED, boundary=0)
                continue
            missing = flights.missing_digits(arrival, wanted)
            if missing <= 0:
                return arrival, flights
            flights = self.flights(flights.digits + missing + 3)
