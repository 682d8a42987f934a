"""Arrays that compiled code reads and writes without counting references; needs numba.

numba counts the references to an array wherever a function takes it, with instructions that wait for the memory: a
fifth of the time of an event. A borrowed array has no owner to count for; its caller keeps the real one.
"""

from __future__ import annotations

from typing import Any

import numba
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def _without_owner(typing_context: Any, array: Any) -> Any:
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        view = context.make_array(array)(context, builder, value=arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), code


@numba.njit(forceinline=True)
def borrowed(array):
    """Return a view of an array whose references numba does not count."""
    return _without_owner(array)  # type: ignore[call-arg]
