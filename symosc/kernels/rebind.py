"""Functions bound to other globals: one source for every kind of number.

The event loop and the kernels are plain functions of numbers. To run them with pairs of doubles or
with any number of digits, `bind` copies each function with other globals, in which `sin`, `EPS` or
a function that it calls are those for these numbers, and rewrites the floats among the constants of
its code: 0.5 becomes a number with all digits. To compile them, `symosc.kernels.compiling` wraps
each copy by numba.

This is unusual, and it stays for four reasons:

- the alternatives are worse. Six arithmetics (floats, compiled doubles, lanes, both kinds of pairs,
  mpmath and MPFR) would need six copies of the search, or each function would take the arithmetic
  as an argument: half as fast in CPython, and numba does not compile it;
- a proof that a formula is right, and every test of it, holds for all arithmetics at once;
- a traceback and a debugger show the line of the source, since the copies share its code;
- its effects are tested: that no constant with the 16 digits of a double gets into more digits
  (tests/engine/test_binding.py), and that all arithmetics return the same events
  (tests/engine/test_digits.py, tests/simulation/test_fuzz.py).

The price: all modules that are bound together share one namespace, so that none may define a
function, or a constant with another value, of a name that another one has (`bind` refuses that),
and a literal float in them must be a number that is meant exactly. Each module says at its top that
it is executed with other globals.
"""

from __future__ import annotations

import builtins
import types
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

# What numba compiles into the code as a number.
CONSTANTS = (bool, int, float, complex, str)

Function = TypeVar("Function", bound=Callable[..., Any])


def outlined(function: Function) -> Function:
    """Mark a function that is called from several places, or rarely: compiled code calls it instead
    of having a copy of it in each caller.
    """
    function.is_outlined = True  # type: ignore[attr-defined]
    return function


def outlined_in(modules: Iterable[types.ModuleType]) -> set[str]:
    """Return the names of the functions of `modules` that are marked as `outlined`."""
    functions = functions_of(modules)
    return {name for name, function in functions.items() if hasattr(function, "is_outlined")}


def functions_of(modules: Iterable[types.ModuleType]) -> dict[str, types.FunctionType]:
    """Return by name the functions that `modules` define, not import.

    ValueError if two have the same name.
    """
    functions: dict[str, types.FunctionType] = {}
    for module in modules:
        for name, value in vars(module).items():
            if not isinstance(value, types.FunctionType):
                continue
            if (value.__module__, value.__name__) != (module.__name__, name):
                continue
            if name in functions:
                before = functions[name].__module__
                raise ValueError(f"{name} is written in {before} and in {module.__name__}")
            functions[name] = value
    return functions


def bind(
    modules: Iterable[types.ModuleType],
    replaced: dict[str, Any],
    wrap: Callable[[Any], Any] | None = None,
    literal: Callable[[float], Any] | None = None,
) -> dict[str, Any]:
    """Copy the functions of `modules` so that they call each other, and use `replaced[name]` for a
    global `name`.

    `wrap`, such as a compiler, is applied to each copy; `literal` converts each float that is
    written in the source, such as 0.5.
    """
    # `literal` converts limits with a name too. A name in `replaced` must be one that the functions
    # could see.
    modules = tuple(modules)
    shared = _shared_names(modules, replaced)
    if literal is not None:
        for name, value in shared.items():
            shared[name] = _converted_float(value, literal)
    # numba asks globals for their module, and numpy for the builtins
    shared |= replaced | {"__name__": __name__, "__builtins__": builtins}
    for name, function in functions_of(modules).items():
        if name not in replaced:
            copy = _with_globals(function, shared, literal)
            if wrap:
                shared[name] = wrap(copy)
            else:
                shared[name] = copy
    return shared


def _shared_names(
    modules: tuple[types.ModuleType, ...], replaced: dict[str, Any]
) -> dict[str, Any]:
    """Return the names that functions of `modules` see.

    ValueError if one has two values, or if a name in `replaced` is none of them.
    """
    shared: dict[str, Any] = {}
    for module in modules:
        seen = {name: value for name, value in vars(module).items() if not name.startswith("__")}
        clashes = [
            name
            for name in sorted(seen.keys() & shared.keys())
            if isinstance(seen[name], CONSTANTS)
            and name not in replaced
            and seen[name] != shared[name]
        ]
        if clashes:
            raise ValueError(f"{clashes} have another value in {module.__name__}")
        shared |= seen
    unknown = sorted(
        name for name in replaced if name not in shared and not hasattr(builtins, name)
    )
    if unknown:
        raise ValueError(f"{unknown} are no names in {[module.__name__ for module in modules]}")
    return shared


def _with_globals(
    function: types.FunctionType,
    names: dict[str, Any],
    literal: Callable[[float], Any] | None,
) -> types.FunctionType:
    """Return a copy of a function with the globals `names`, its floats converted by `literal`."""
    code = function.__code__
    if literal is not None:
        numbers = tuple(_converted_float(value, literal) for value in code.co_consts)
        code = code.replace(co_consts=numbers)
    copy = types.FunctionType(code, names, function.__name__, function.__defaults__)
    copy.__module__ = function.__module__
    return copy


def _converted_float(value: Any, literal: Callable[[float], Any]) -> Any:
    """Return a float converted by `literal`, anything else unchanged."""
    if type(value) is float:
        return literal(value)
    return value
