"""Motions as functions that JAX differentiates, maps and compiles into larger programs.

Values and derivatives are those of `symosc.simulate_many` and `symosc.sensitivities`, computed on
the CPU in doubles: JAX differentiates nothing itself. All functions are differentiable once,
forwards and backwards, by parameters, the start and the time, and serve ``jax.vmap`` and
``jax.jit``. They need ``jax.config.update("jax_enable_x64", True)``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from symosc.base.errors import ParameterError, meant, optional
from symosc.base.exact import whole_number
from symosc.base.quantities import number_of_belt
from symosc.derivatives.sensitivities import sensitivities
from symosc.model import PARAMETER_NAMES, Model, model_from
from symosc.scenes import STARTS
from symosc.simulation.ensemble import simulate_many

__all__ = ["Events", "events", "flow"]


class Events(NamedTuple):
    """The first events of a motion, as arrays of a fixed length.

    The rest is filled up, with inf, 0 or False.

    Attributes
    ----------
    t, x : (count,) arrays
        Times and positions; inf where the motion has no more events.
    kind : (count,) int array
        1 cross, 2 stick, 3 slip, 4 graze; 0 where there is no event.
    boundary : (count,) int array
        The number of the belt; 0 where there is no event.
    regular : (count,) bool array
        Whether the event is there and has all derivatives; see `Sensitivities`.

    Examples
    --------
    >>> from symosc.jax import Events
    >>> Events._fields
    ('t', 'x', 'kind', 'boundary', 'regular')
    """

    t: Any
    x: Any
    kind: Any
    boundary: Any
    regular: Any


def events(
    parameters: Model | Mapping[str, Any],
    *,
    t0: Any = 0.0,
    x0: Any = 0.0,
    v0: Any = 0.0,
    t_end: Any,
    count: int,
) -> Events:
    """Return the first `count` events of a motion until t_end.

    Parameters
    ----------
    parameters : Parameters, Oscillator or mapping
        All numbers by name, numbers or JAX scalars: those of `Parameters`, or those of an
        `Oscillator`, such as mu_s1 and w1_1. A static coefficient equal to the kinetic one is left
        out.
    t0, x0, v0, t_end : number or JAX scalar
    count : int
        The number of rows, which JAX must know beforehand.

    Returns
    -------
    Events

    Raises
    ------
    MissingExtraError
        If JAX is not installed (extra ``jax``).
    ParameterError
        If a name is unknown or missing, or JAX computes in single precision.

    Examples
    --------
    >>> import jax
    >>> jax.config.update("jax_enable_x64", True)
    >>> from symosc import load_scene
    >>> from symosc.jax import events
    >>> p = {name: float(value) for name, value in load_scene("fig5").parameters.as_dict().items()}
    >>> first = lambda mu1: events(p | {"mu1": mu1}, t_end=7, count=3).t[1]
    >>> print(f"{jax.grad(first)(0.8):.6f}")
    0.936995
    """
    events_, _ = _functions()
    from jax import numpy

    count = whole_number("count", count, 1)
    values, names = _values(parameters, t0, x0, v0)
    return Events(*events_(values, numpy.asarray(t_end, float), count, names))


def flow(
    parameters: Model | Mapping[str, Any],
    t: Any,
    *,
    t0: Any = 0.0,
    x0: Any = 0.0,
    v0: Any = 0.0,
) -> Any:
    """Return [x, v] of a motion at a time, of shape (2,), or at n times, of shape (2, n).

    At an event the derivatives are those of the piece that begins there. Parameters and errors are
    those of `events`.

    Examples
    --------
    >>> import jax
    >>> jax.config.update("jax_enable_x64", True)
    >>> from symosc import load_scene
    >>> from symosc.jax import flow
    >>> p = load_scene("fig5").parameters
    >>> print(jax.jacobian(lambda x0: flow(p, 2.5, x0=x0))(0.0).round(6))
    [ 0.017646 -0.060594]
    """
    _, flow_ = _functions()
    from jax import numpy

    times = numpy.asarray(t, float)
    values, names = _values(parameters, t0, x0, v0)
    return flow_(values, times.reshape(-1), names).reshape((2, *times.shape))


def _values(parameters: Any, *start: Any) -> tuple[Any, tuple[str, ...]]:
    """Return the parameters, and the numbers t0, x0, v0 of `start`, as one JAX array, and the names
    of its numbers.
    """
    if isinstance(parameters, Model):
        parameters = {name: float(value) for name, value in parameters.given_numbers().items()}
    if not isinstance(parameters, Mapping):
        raise ParameterError(
            "parameters", parameters, "must be Parameters, an Oscillator, or a mapping of all names"
        )
    _check_names(parameters)
    if parameters.keys() == set(PARAMETER_NAMES):
        names = PARAMETER_NAMES
    else:
        names = tuple(parameters)
    from jax import numpy

    numbers = [numpy.asarray(value, float) for value in (*map(parameters.get, names), *start)]
    return numpy.stack(numbers), (*names, *STARTS)


def _check_names(parameters: Mapping[str, Any]) -> None:
    """Raise ParameterError unless the names are all those of one oscillator."""
    for name in parameters:
        if name not in PARAMETER_NAMES and number_of_belt(str(name)) is None:
            hint = (
                "unknown parameter; choose from "
                f"{', '.join(PARAMETER_NAMES)}{meant(str(name), PARAMETER_NAMES)}"
            )
            raise ParameterError("parameters", name, hint)
    required = [name for name in PARAMETER_NAMES if name not in ("v2", "mu2")]
    for name in required:
        if name not in parameters:
            raise ParameterError(
                "parameters", sorted(parameters), f"must have all parameters; {name} is missing"
            )
    # The values may be known to JAX alone: any that are in order tell whether the names belong
    # together.
    model_from({name: _placeholder(name) for name in parameters})


def _placeholder(name: str) -> int:
    """Return a number that an oscillator may have under this name."""
    of_belt = number_of_belt(name)
    if of_belt is None:
        return 1
    placeholders = {"v": of_belt.belt, "w": of_belt.point, "mu_s": 2}
    return placeholders.get(of_belt.quantity, 1)


def _functions() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return the two functions behind `events` and `flow` (see `_jax_functions`).

    Raise an error if JAX is missing or does not compute in doubles.
    """
    jax = optional("jax", "symosc.jax", "jax")
    if not jax.config.read("jax_enable_x64"):
        hint = 'must be True, since events need doubles: jax.config.update("jax_enable_x64", True)'
        raise ParameterError("jax_enable_x64", False, hint)
    return _jax_functions()


@lru_cache(maxsize=1)
def _jax_functions() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """Return two functions that JAX can differentiate by the array of `_values`: of events, and of
    [x, v] at times. Their last argument is the names of its numbers.
    """
    import jax

    def computed(function: Callable[..., Any], shapes: Any, *arguments: Any) -> Any:
        """Call a numpy function of the `arguments` from JAX.

        `shapes` are shapes and types of its results.
        """
        out = tuple(jax.ShapeDtypeStruct(shape, kind) for shape, kind in shapes)
        return jax.pure_callback(function, out, *arguments, vmap_method="broadcast_all")

    def all_of_events(values: Any, t_end: Any, count: int, names: tuple[str, ...]) -> Any:
        """Return the columns of the events, and the derivatives of t and x by the `values`."""
        kinds = (float, float, np.int32, np.int32, bool)
        shapes = [((count,), kind) for kind in kinds] + [((count, len(names)), float)] * 2
        return computed(partial(_events_of, count=count, names=names), shapes, values, t_end)

    @partial(jax.custom_jvp, nondiff_argnums=(2, 3))
    def events_(values: Any, t_end: Any, count: int, names: tuple[str, ...]) -> Any:
        return all_of_events(values, t_end, count, names)[: len(Events._fields)]

    @events_.defjvp
    def _(count: int, names: tuple[str, ...], primals: Any, tangents: Any) -> Any:
        values, t_end = primals
        *columns, dt, dx = all_of_events(values, t_end, count, names)
        none = [np.zeros(count, jax.dtypes.float0)] * 3  # kind, boundary, regular do not vary
        return tuple(columns), (dt @ tangents[0], dx @ tangents[0], *none)

    def all_of_flow(values: Any, times: Any, names: tuple[str, ...]) -> Any:
        """Return [x, v] at times, and their derivatives by the `values` and by time."""
        shape = (2, len(times))
        return computed(
            partial(_states_of, names=names),
            [(shape, float), ((*shape, len(names)), float), (shape, float)],
            values,
            times,
        )

    @partial(jax.custom_jvp, nondiff_argnums=(2,))
    def flow_(values: Any, times: Any, names: tuple[str, ...]) -> Any:
        return all_of_flow(values, times, names)[0]

    @flow_.defjvp
    def _(names: tuple[str, ...], primals: Any, tangents: Any) -> Any:
        values, times = primals
        states, slopes, rates = all_of_flow(values, times, names)
        return states, slopes @ tangents[0] + rates * tangents[1]

    return events_, flow_


def _events_of(
    values: Any, t_end: Any, count: int, names: tuple[str, ...]
) -> tuple[np.ndarray, ...]:
    """Return t, x, kind, boundary, regular, dt, dx of the first `count` events of motions: one per
    row of `values`, whose columns are called `names`.
    """
    values = np.asarray(values)
    lead = values.shape[:-1]
    rows = values.reshape(-1, len(names))
    ends = np.broadcast_to(np.asarray(t_end), lead).reshape(-1)
    columns = dict(zip(names, rows.T, strict=True))
    starts = {name: columns.pop(name) for name in STARTS}  # the other columns are parameters
    table = simulate_many(columns, starts, ends, max_events=count, wrt=names)
    # The table has the events of all motions one after the other, here there is a row for each.
    first = np.searchsorted(table.trajectory, np.arange(len(rows)))
    # The row of each event of the table, and its number in this row.
    places_in_rows = table.trajectory, np.arange(len(table)) - first[table.trajectory]

    def placed(column: Any, empty: Any, kind: Any = float) -> np.ndarray:
        """Return a column as rows of `count` events, filled up with `empty`."""
        filled = np.full((len(rows), count, *column.shape[1:]), empty, dtype=kind)
        filled[places_in_rows] = column
        return filled.reshape((*lead, *filled.shape[1:]))

    places = placed(table.t, np.inf), placed(table.x, np.inf)
    codes = placed(table.kind_code, 0, np.int32), placed(table.boundary, 0, np.int32)
    return (
        *places,
        *codes,
        placed(table.regular.all(axis=1), False, bool),
        placed(table.dt, 0.0),
        placed(table.dx, 0.0),
    )


def _states_of(values: Any, times: Any, names: tuple[str, ...]) -> tuple[np.ndarray, ...]:
    """Return [x, v] at `times` of motions, one per row of `values`, whose columns are called
    `names`, and its derivatives by these and by time.
    """
    values = np.asarray(values)
    times = np.asarray(times)
    lead = values.shape[:-1]
    n = times.shape[-1]
    rows = values.reshape(-1, len(names))
    instants = np.broadcast_to(times, (*lead, n)).reshape(-1, n)
    states, slopes, rates = (np.empty((len(rows), 2, n, *last)) for last in ((), (len(names),), ()))
    for i, (row, row_times) in enumerate(zip(rows.tolist(), instants, strict=True)):
        numbers = dict(zip(names, row, strict=True))
        start = {name: numbers.pop(name) for name in STARTS}
        last = float(row_times.max())
        if not last > start["t0"]:  # a motion must have a length, whatever it is
            last = start["t0"] + 1.0
        s = sensitivities(model_from(numbers), names, **start, t_end=last)
        states[i] = s.trajectory(row_times)
        slopes[i] = s(row_times)
        forces = {
            f"Omega{alpha}": s.trajectory.force(alpha, row_times)
            for alpha in s.trajectory.parameters.law.domains
        }
        rates[i, 0] = states[i, 1]
        rates[i, 1] = [  # 0 in a stick
            forces[mode][k] if mode in forces else 0.0
            for k, mode in enumerate(s.trajectory.mode(row_times))
        ]
    # As many leading axes as `vmap` has put in front of `values`.
    results = (states, slopes, rates)
    return tuple(array.reshape((*lead, *array.shape[1:])) for array in results)
