"""Compilation of plain Python functions by numba, with the code kept on disk."""

from __future__ import annotations

import builtins
import hashlib
import inspect
import sys
import types
from collections.abc import Callable, Iterable
from typing import Any

from symosc.base.errors import MissingExtraError
from symosc.kernels import rebind
from symosc.kernels.rebind import CONSTANTS, bind, functions_of


def compile_modules(
    modules: Iterable[types.ModuleType],
    outlined: Iterable[str] | None = None,
    callees: dict[str, Any] | None = None,
    replaced: dict[str, Any] | None = None,
    literal: Callable[[float], Any] | None = None,
    beside: Iterable[types.ModuleType] = (),
    entries: Iterable[str] | None = None,
) -> dict[str, Any]:
    """Compile the functions of `modules` by numba, each at its first call; return them by name.

    The code is kept on disk. Functions that are not in `outlined` are inlined into their callers.
    `callees` are compiled functions to call instead of those of the same name. `replaced` and
    `literal` are as in `bind`, and the code counts as old when a module in `beside` changes. Python
    can call the functions in `entries`; if that is None, all that are not inlined.
    """
    # If `outlined` is None, nothing is inlined. `callees` that no module sees are left out. The
    # modules `beside` are compiled too, such as operators of a type. Raise MissingExtraError
    # without numba.
    try:
        import numba

        from symosc.kernels.code_cache import keep_on_disk
        from symosc.kernels.dispatchers import for_compiled_code, without_literals
    except ImportError:
        raise MissingExtraError("compiling", "fast") from None
    modules = tuple(modules)
    replaced = replaced or {}
    seen = bind(modules, {})  # all names that the functions can see
    written = functions_of(modules)
    if outlined is None:
        inlined = set[str]()
    else:
        inlined = set(written) - set(outlined)
    # A builtin such as abs may be replaced too; only what numba has compiled counts.
    called = {
        name: value
        for name, value in (callees or {}).items()
        if hasattr(value, "py_func") and (name in seen or hasattr(builtins, name))
    }
    values = seen | {name: repr(value) for name, value in replaced.items()}
    version = _version(modules, values, called, inlined, tuple(beside))

    if entries is None:
        internal = inlined
    else:
        internal = set(written) - set(entries)

    def wrap(function: Any) -> Any:
        # numba's disk cache sees changes in the function's own file only. The name of the entry
        # says the rest.
        function.__qualname__ = f"{function.__name__}-{version}"
        # Wrappers for Python take tuples of a hundred numbers apart: where Python does not call, they
        # would be a large part of the code. Nothing is called from C. Each function sets all three
        # options: without them it would take forceinline from the function that calls it first.
        options: dict[str, Any] = {
            "forceinline": function.__name__ in inlined,
            "no_cpython_wrapper": function.__name__ in internal,
            "no_cfunc_wrapper": True,
        }
        dispatcher = numba.njit(error_model="numpy", nogil=True, **options)(function)
        if function.__name__ in internal:
            for_compiled_code(dispatcher)
        return keep_on_disk(without_literals(dispatcher))

    return bind(modules, called | replaced, wrap, literal)


def _version(
    modules: tuple[types.ModuleType, ...],
    values: dict[str, Any],
    called: dict[str, Any],
    inlined: set[str],
    beside: tuple[types.ModuleType, ...],
) -> str:
    """Return a text that changes with anything that the functions are compiled from."""
    numbers = sorted(
        (name, repr(value)) for name, value in values.items() if isinstance(value, CONSTANTS)
    )
    others = sorted(
        (name, callee.py_func.__module__, callee.py_func.__qualname__)
        for name, callee in called.items()
    )
    homes = [sys.modules[name] for name in sorted({module for _, module, _ in others})]
    digest = hashlib.sha256(repr((numbers, others, sorted(inlined))).encode())
    for module in (rebind, sys.modules[__name__], *modules, *beside, *homes):
        digest.update(inspect.getsource(module).encode())
    return digest.hexdigest()[:12]


def is_compiled(function: Any) -> bool:
    """Return whether the compiled code of a function of `compile_modules` is in memory or on disk.

    What is not for numba needs no compiling.
    """
    if not hasattr(function, "py_func") or function.overloads:
        return True
    on_disk = getattr(function._cache, "has_code", None)  # None: nothing is kept on disk
    return on_disk is not None and bool(on_disk())
