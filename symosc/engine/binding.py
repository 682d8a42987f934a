"""One source for several kinds of numbers: functions bound to other globals, in mpmath or compiled by numba.

The fast paths are plain functions on numbers. A copy of a function that sees other globals (mpmath's sin, cos and
precision, or the compiled forms of the functions that it calls) does the same with other numbers. Nothing is written
twice, and each copy still says in which file and line it was written.
"""

from __future__ import annotations

import builtins
import hashlib
import inspect
import sys
import types
from collections.abc import Callable, Iterable
from glob import escape
from pathlib import Path
from time import monotonic
from typing import Any

from symosc.errors import MissingExtraError

# What numba compiles into the code as a number.
CONSTANTS = (bool, int, float, complex, str)


def functions_of(modules: Iterable[types.ModuleType]) -> dict[str, types.FunctionType]:
    """Return the functions that are written in `modules`, by name.

    Raises
    ------
    ValueError
        If two of them have the same name.
    """
    found: dict[str, types.FunctionType] = {}
    for module in modules:
        for name, value in vars(module).items():
            if isinstance(value, types.FunctionType) and value.__module__ == module.__name__:
                if name in found:
                    raise ValueError(f"{name} is written in {found[name].__module__} and in {module.__name__}")
                found[name] = value
    return found


def bind(
    modules: Iterable[types.ModuleType],
    replaced: dict[str, Any],
    wrap: Callable[[Any], Any] | None = None,
    literal: Callable[[float], Any] | None = None,
) -> dict[str, Any]:
    """Return copies of the functions of `modules` that see `replaced` and each other, not their modules' globals.

    Parameters
    ----------
    modules : iterable of modules
    replaced : dict
        What stands for the globals of these names.
    wrap : callable, optional
        Applied to every copy, such as ``numba.njit``.
    literal : callable, optional
        Makes numbers of the floats that stand in the source, once: such as 0.5 and the limits with a name. Else they
        would be converted whenever they are used, which takes longer than to multiply two numbers of 40 digits.

    Raises
    ------
    ValueError
        If a name in `replaced` is nothing that the functions could see, or is one that two modules write.
    """
    modules = tuple(modules)
    shared: dict[str, Any] = {}
    for module in modules:
        shared |= {name: value for name, value in vars(module).items() if not name.startswith("__")}
    unknown = sorted(name for name in replaced if name not in shared and not hasattr(builtins, name))
    if unknown:
        raise ValueError(f"{unknown} are no names in {[module.__name__ for module in modules]}")
    if literal is not None:
        shared = {name: literal(value) if type(value) is float else value for name, value in shared.items()}
    shared |= replaced | {"__name__": __name__}  # numba asks globals for their module
    for name, function in functions_of(modules).items():
        if name not in replaced:
            code = function.__code__
            if literal is not None:
                constants = (literal(value) if type(value) is float else value for value in code.co_consts)
                code = code.replace(co_consts=tuple(constants))
            copy = types.FunctionType(code, shared, name, function.__defaults__)
            copy.__module__ = function.__module__
            shared[name] = wrap(copy) if wrap else copy
    return shared


def compiled(
    modules: Iterable[types.ModuleType],
    outlined: Iterable[str] | None = None,
    callees: dict[str, Any] | None = None,
    replaced: dict[str, Any] | None = None,
    literal: Callable[[float], Any] | None = None,
    beside: Iterable[types.ModuleType] = (),
) -> dict[str, Any]:
    """Return the functions of `modules` compiled by numba: each when it is first called, and kept on disk.

    Parameters
    ----------
    modules : iterable of modules
    outlined : iterable of str, optional
        Functions of which not every caller gets a copy of its own. None: all.
    callees : dict, optional
        From an earlier call: what stands here for imported functions.
    replaced, literal : optional
        As in `bind`: constants of another kind of numbers.
    beside : iterable of modules, optional
        What else is compiled: operators of a type, for instance.

    Raises
    ------
    MissingExtraError
        If numba is not installed.
    """
    try:
        import numba

        from symosc.engine.code_cache import keep_on_disk
    except ImportError:
        raise MissingExtraError("compiling", "fast") from None
    modules = tuple(modules)
    seen, written = bind(modules, {}), functions_of(modules)
    inlined = set() if outlined is None else set(written) - set(outlined)
    called = {name: value for name, value in (callees or {}).items() if hasattr(value, "py_func")}
    called = {name: value for name, value in called.items() if name in seen or hasattr(builtins, name)}
    called = {name: value for name, value in called.items() if name not in written}
    own = {name: repr(value) for name, value in (replaced or {}).items()}
    functions = {name: value.py_func for name, value in called.items()}
    sources = version(seen | own, (*modules, *beside), functions, inlined)

    def wrap(function: Any) -> Any:
        # numba's disk cache looks for changes in the function's own file only. The name of the entry says the rest.
        function.__qualname__ = f"{function.__name__}-{sources}"
        # Inlined ones are called by compiled code alone: what Python would call them by is never made. Each function
        # says all three: one that did not would take forceinline from the function that calls it first.
        inline = function.__name__ in inlined
        options: dict[str, Any] = {"forceinline": inline, "no_cpython_wrapper": inline, "no_cfunc_wrapper": inline}
        return keep_on_disk(numba.njit(error_model="numpy", nogil=True, **options)(function))

    return bind(modules, called | (replaced or {}), wrap, literal)


def is_compiled(function: Any) -> bool:
    """Return whether numba has compiled a function of `compiled`, or finds it on disk."""
    if not hasattr(function, "py_func") or function.overloads:
        return True
    folder, name = function.stats.cache_path, function.py_func.__qualname__
    if folder is None:  # nothing is kept on disk
        return False
    there, looked = _ON_DISK.get((folder, name), (False, -LOOK_AGAIN))
    if not there and monotonic() - looked >= LOOK_AGAIN:
        there = any(Path(folder).glob(f"*.{escape(name)}-*.nbi"))
        _ON_DISK[folder, name] = there, monotonic()
    return there


#: Seconds after which a folder is looked through again: that takes as long as thousands of events.
LOOK_AGAIN = 1.0
_ON_DISK: dict[tuple[str, str], tuple[bool, float]] = {}


def version(
    seen: dict[str, Any],
    modules: Iterable[types.ModuleType],
    callees: dict[str, Any] | None = None,
    inlined: Iterable[str] = (),
) -> str:
    """Return a short text that changes with anything that the functions of `modules` are compiled from.

    Parameters
    ----------
    seen : dict
        Their globals; constants count, wherever they are written.
    modules : iterable of modules
    callees : dict, optional
        Functions of other modules that these call, by the name that they have here.
    inlined : iterable of str
        Functions of which every caller gets a copy of its own.
    """
    constants = sorted((name, repr(value)) for name, value in seen.items() if isinstance(value, CONSTANTS))
    called = sorted((name, function.__module__, function.__qualname__) for name, function in (callees or {}).items())
    digest = hashlib.sha256(repr((constants, called, sorted(inlined))).encode())
    others = (sys.modules[name] for name in sorted({module for _, module, _ in called}))
    for module in (sys.modules[__name__], *modules, *others):
        digest.update(inspect.getsource(module).encode())
    return digest.hexdigest()[:12]
