"""The fast paths with many digits by MPFR (gmpy2): the same source as with mpmath, and six times as fast.

The precision is that of an mpmath context, in bits. Both round the four operations and the square root correctly, so
what comes out differs, if at all, in the last bits of a sine. Numbers are computed with between `enter` and `leave`
only; everything that is handed out is made mpmath's by `outward`, exactly.
"""

from __future__ import annotations

from collections.abc import Iterable
from types import ModuleType
from typing import Any

from symosc.engine import binding
from symosc.engine.flow import Constants
from symosc.engine.paths import Paths, converted
from symosc.kernels.entire_mp import BasisMP
from symosc.kernels.mpfr import from_mpf, mpfr, mpfr_context, to_mpf
from symosc.model import Parameters

FUNCTIONS = ("sin", "cos", "exp", "sqrt")


class MpfrPaths(Paths):
    """Fast paths with MPFR.

    Parameters
    ----------
    parameters : Parameters
    context : mpmath context
        Numbers that go out are its own, and it says how many bits numbers have.
    sources : iterable of modules
    replaced : dict
        What the sources are bound to with mpmath: its numbers are taken over.
    """

    def __init__(
        self, parameters: Parameters, context: Any, sources: Iterable[ModuleType], replaced: dict[str, Any]
    ) -> None:
        self._context, inner = context, mpfr_context(context.prec)
        self._constants: Constants | None = None
        self.enter, self.leave = inner.enter, inner.leave  # type: ignore[method-assign]
        changed = {name: getattr(inner, name) for name in FUNCTIONS}
        changed |= {"basis": BasisMP(inner, parameters, mpfr_context)}
        changed = {name: self.inward(value) for name, value in replaced.items()} | changed
        super().__init__(binding.bind(sources, changed, literal=mpfr))

    def inward(self, value: Any) -> Any:
        """Return a number of mpmath, or a tuple with some, as numbers of MPFR."""
        before = self.enter()
        try:
            return converted(value, lambda entry: from_mpf(entry) if hasattr(entry, "_mpf_") else entry)
        finally:
            self.leave(before)

    def constants(self, K: Constants) -> Constants:
        """Return the constants, which always are those of the same parameters, with numbers of MPFR."""
        if self._constants is None:
            self._constants = self.inward(K)
        return self._constants

    def outward(self, value: Any) -> Any:
        """Return a number of MPFR, or a tuple with some, as numbers of mpmath."""
        if type(value) is tuple:  # the numbers of an event
            return tuple([to_mpf(entry, self._context) for entry in value])
        return converted(value, lambda entry: to_mpf(entry, self._context) if type(entry) is mpfr else entry)
