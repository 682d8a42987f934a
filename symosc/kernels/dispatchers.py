"""How compiled functions call each other: in one version for each kind of numbers, and without a way
in from Python where Python does not call.

Both make less code to compile. It is a third of the time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn

from numba.core.types import unliteral


def without_literals(dispatcher: Any) -> Any:
    """Let compiled code call a function by the types of its arguments alone; return the function.

    Numba would compile it once more for each number, such as 0, that a caller writes down or counts
    from.
    """
    compiler = dispatcher._compiler
    fold: Callable[..., Any] = compiler.fold_argument_types

    def fold_types(arguments: Any, keywords: Any) -> Any:
        signature, folded = fold(arguments, keywords)
        return signature, tuple(map(unliteral, folded))

    compiler.fold_argument_types = fold_types
    return dispatcher


def for_compiled_code(dispatcher: Any) -> Any:
    """Let Python refuse to call a function that has no wrapper for it; return the function.

    Numba would call an address that is not there.
    """
    name = dispatcher.py_func.__name__

    def refuse(*arguments: Any, **keywords: Any) -> NoReturn:
        raise TypeError(f"{name} was compiled for compiled code only: `entries` does not name it")

    # The first is how numba tells its C code about a version, the second what that calls for others.
    dispatcher._insert = lambda *version, **about: None
    dispatcher._compile_for_args = refuse
    return dispatcher
