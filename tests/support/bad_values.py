"""Values that are no numbers or no choices, and what a refusal looks like.

Used by several tests.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy

from symosc.base.errors import ParameterError

#: Nothing of this is a number.
NO_NUMBERS = [
    "",
    " ",
    "abc",
    "1_000",
    "１",
    "٣",
    "1 2",
    "1/0",
    "0x1",
    "--1",
    "nan",
    "inf",
    "1e5000",
    "9" * 5000,
]
NO_NUMBERS += [True, False, 1j, [], [1], {}, (), b"1", NotImplemented, str, 10**400, -(10**60)]
NO_NUMBERS += [
    float("nan"),
    float("inf"),
    np.float64("nan"),
    Decimal("NaN"),
    Decimal("sNaN"),
    np.True_,
    mpmath.nan,
]
NO_NUMBERS += [sympy.oo, sympy.Symbol("x"), np.array([1.0, 2.0])]


def refused(call: Callable[[], Any], name: str) -> str:
    """Return the message of the error that a call ends with.

    One line of reasonable length that begins with a name.
    """
    with pytest.raises(ParameterError) as caught:
        call()
    message = str(caught.value)
    assert message.startswith(f"{name} = "), message
    assert "\n" not in message
    assert len(message) < 400
    return message
