"""Exceptions of symosc. Each one carries the data that a program needs to react to it."""

from __future__ import annotations

from typing import Any


class SymoscError(Exception):
    """Base class of every error that symosc raises on purpose."""


class ParameterError(SymoscError, ValueError):
    """A value that the model does not allow.

    Attributes
    ----------
    name : str
        The parameter.
    value : object
        What was given.
    allowed : str
        What would have been accepted.
    """

    def __init__(self, name: str, value: Any, allowed: str) -> None:
        self.name, self.value, self.allowed = name, value, allowed
        super().__init__(f"{name} = {value!r}: {allowed}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.name, self.value, self.allowed)


class SceneError(SymoscError, ValueError):
    """A scene that does not exist, or a scene file that cannot be read.

    Attributes
    ----------
    scene : str
        The scene's name or the file's path.
    """

    def __init__(self, scene: str, reason: str) -> None:
        self.scene, self.reason = scene, reason
        super().__init__(f"scene {scene}: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.scene, self.reason)


class OutputError(SymoscError, OSError):
    """A file that cannot be written; nothing is left behind.

    Attributes
    ----------
    path : str
        The file that was asked for.
    """

    def __init__(self, path: str, reason: str) -> None:
        self.path, self.reason = path, reason
        super().__init__(f"cannot write {path}: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path, self.reason)


class MissingExtraError(SymoscError, ImportError):
    """An optional dependency is needed and not installed.

    Attributes
    ----------
    extra : str
        The extra of symosc that brings it.
    """

    def __init__(self, what: str, extra: str) -> None:
        self.what, self.extra = what, extra
        super().__init__(f"{what} needs an optional package: pip install 'symosc[{extra}]'")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.what, self.extra)
