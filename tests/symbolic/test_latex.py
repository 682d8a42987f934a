"""One table of letters: formulas print parameters as labels of figures and tables do."""

from __future__ import annotations

import pytest

from symosc.base.quantities import QUANTITIES
from symosc.derive.scope import LETTERS
from symosc.symbolic.inverse import QUERY_LETTERS
from symosc.symbolic.latex import latex

SYMBOLS = [
    *LETTERS.items(),
    *((name, QUERY_LETTERS[name]) for name in QUERY_LETTERS if name != "v"),
]


@pytest.mark.parametrize(("name", "symbol"), SYMBOLS)
def test_a_parameter_has_one_letter(name: str, symbol: object) -> None:
    assert latex(symbol) == QUANTITIES[name].letter
