"""The disk cache of numba's compiled code, with checksums.

A damaged or unwritable cache never raises.

numba itself raises if no folder is writable or a file is damaged, and runs code whose bytes have
changed.
"""

from __future__ import annotations

import os
import pickle
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from time import monotonic
from typing import Any

from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    IndexDataCacheFile,
    InTreeCacheLocator,
)

from symosc.base.display.progress import Report, bar
from symosc.base.errors import CodeCacheWarning

DIGEST_SIZE = sha256().digest_size
DAMAGED = "is damaged"
NOT_READ = "cannot be read"
NOT_KEPT = "cannot be kept"
# Seconds after which a folder of compiled code is searched again: that takes as long as thousands
# of events.
SEARCH_AGAIN = 1.0
_warned: set[str] = set()


def _warn(problem: str, reason: str) -> None:
    """Warn of a problem of the cache, only once per program although it concerns dozens of
    functions.
    """
    if problem not in _warned:
        _warned.add(problem)
        if problem == NOT_KEPT:
            advice = "; each program compiles it; NUMBA_CACHE_DIR names another folder"
        else:
            advice = ""
        warnings.warn(f"compiled code {problem}: {reason}{advice}", CodeCacheWarning, stacklevel=2)


class _CheckedFiles(IndexDataCacheFile):
    """Reader and writer of numba's cache files.

    A checksum at the end of each shows whether it is damaged.
    """

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[Any]:
        with super()._open_for_write(filepath) as file:
            content = BytesIO()
            yield content
            file.write(content.getvalue() + sha256(content.getvalue()).digest())

    def _load_index(self) -> Any:
        with suppress(FileNotFoundError):
            _check(self._index_path)
        return super()._load_index()

    def _load_data(self, name: str) -> Any:
        _check(self._data_path(name))
        return super()._load_data(name)


def _check(path: str) -> None:
    """Raise an error unless a file ends with the checksum of its contents."""
    content = Path(path).read_bytes()
    if content[-DIGEST_SIZE:] != sha256(content[:-DIGEST_SIZE]).digest():
        raise pickle.UnpicklingError(path)


class _BesideSource(InTreeCacheLocator):
    """Locator of the cache folder next to the source.

    A read-only one may hold code compiled for all users.
    """

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Any:
        if os.path.exists(py_file):
            return cls(py_func, py_file)
        return None


class _Places(CompileResultCacheImpl):
    """Chooser of a function's cache folder: tries numba's standard folders first, then the one next
    to the source.
    """

    _locator_classes = [*CompileResultCacheImpl._locator_classes, _BesideSource]  # noqa: RUF012


class _CheckedCache(FunctionCache):
    """A numba cache that counts as empty if it cannot be read, and ignores failures to write."""

    _impl_class = _Places

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        files = self._cache_file
        name = files._index_name.removesuffix(".nbi")
        self._cache_file = _CheckedFiles(files._cache_path, name, files._source_stamp)
        self._found = False
        self._searched_at = -SEARCH_AGAIN

    def has_code(self) -> bool:
        """Return whether code of this function is on disk; look once in SEARCH_AGAIN seconds."""
        if not self._found and monotonic() - self._searched_at >= SEARCH_AGAIN:
            self._found = os.path.exists(self._cache_file._index_path)
            self._searched_at = monotonic()
        return self._found

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return compiled code from the disk; None, so that it is compiled, where that fails."""
        try:
            return super().load_overload(sig, target_context)
        except OSError:  # there is nothing that could be read
            return None
        except pickle.UnpicklingError:  # a wrong checksum, or no pickle
            _warn(DAMAGED, f"it is compiled anew (in {self.cache_path})")
            with suppress(OSError):
                os.unlink(self._cache_file._index_path)
            return None
        except Exception as error:  # such as a module of a library that cannot be imported
            reason = f"{type(error).__name__}: {error}"
            _warn(NOT_READ, f"{reason}; it is compiled anew (in {self.cache_path})")
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        try:
            super().save_overload(sig, data)
        except (OSError, pickle.UnpicklingError) as error:
            _warn(NOT_KEPT, f"{getattr(error, 'strerror', None) or error} (in {self.cache_path})")


class _CompilingBar:
    """The bar that is shown while functions are compiled, which happens once: later programs load
    them from disk.

    A function compiles those that it calls, so the bar is for the outermost one, and counts all
    that it compiles. How many these are is not known before; all of its family, which are not
    compiled yet, are at most so many.
    """

    def __init__(self) -> None:
        self._families: dict[str, list[Any]] = {}
        self._depth = 0
        self._done = 0
        self._total = 0
        self._report: Report | None = None
        self._closing = ExitStack()

    def watch(self, dispatcher: Any) -> None:
        """Report each compilation of a function to the bar."""
        # Behind the dash of its name is the version that all functions of a family share.
        family = self._families.setdefault(dispatcher.py_func.__qualname__.rpartition("-")[2], [])
        family.append(dispatcher)
        compiler = dispatcher._compiler
        compile_function: Callable[..., Any] = compiler.compile

        def compile_and_report(*arguments: Any) -> Any:
            with self._compiling(family):
                return compile_function(*arguments)

        compiler.compile = compile_and_report

    @contextmanager
    def _compiling(self, family: list[Any]) -> Iterator[None]:
        """Open the bar around the outermost function, and count each one."""
        if self._depth == 0:
            self._done = 0
            self._total = sum(not _is_there(dispatcher) for dispatcher in family)
            label = "compiling, once for all programs"
            self._report = self._closing.enter_context(bar(label, self._total, "functions"))
        self._depth += 1
        try:
            yield
            self._done += 1
            self._total = max(self._total, self._done)
        finally:
            self._depth -= 1
            if self._report and self._depth:
                self._report(self._done, self._total)
            elif self._report:
                self._report(self._total, self._total)
                self._report = None
                self._closing.close()


def _is_there(dispatcher: Any) -> bool:
    """Return whether the code of a function is in memory or on disk."""
    return bool(dispatcher.overloads) or getattr(dispatcher._cache, "has_code", bool)()


_bar = _CompilingBar()


def keep_on_disk(dispatcher: Any) -> Any:
    """Enable the disk cache of a compiled function where possible, and show a bar while it is
    compiled; return the function.
    """
    try:
        dispatcher._cache = _CheckedCache(dispatcher.py_func)
    except RuntimeError as error:
        # The source is in no folder, or the environment names strange ones.
        _warn(NOT_KEPT, str(error))
    _bar.watch(dispatcher)
    return dispatcher
