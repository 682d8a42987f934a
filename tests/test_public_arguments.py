"""Bad input of anything public: one clear error, and never a raw one.

Nothing that makes no sense is accepted.
"""

from __future__ import annotations

import contextlib
import inspect
import random
import re
import signal
import types
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest
from bad_values import refused
from hostile import CALLED, P9, VALUES, full, functions, is_valid, made, of_answers

import symosc
from symosc import ParameterError, SymoscError, plot
from symosc.base import arguments
from symosc.base.arguments import public, require, require_or_none

#: Seconds after which a call is given up; it is then neither right nor wrong.
GIVEN_UP = 5

#: Kinds, and a value that is of none of them.
WRONG: list[tuple[tuple[Any, ...], object]] = [
    ((arguments.WHOLE,), True),
    ((arguments.WHOLE,), 1.0),
    ((arguments.FLAG,), 1),
    ((arguments.REAL,), "1"),
    ((arguments.NUMBER,), None),
    ((arguments.NUMBER,), np.timedelta64(3, "s")),
    ((arguments.TEXT, arguments.NONE), b"x"),
    (arguments.FILE, 1),
    ((arguments.POINT,), (1, 2, 3)),
    ((arguments.row_of(2, arguments.WHOLE),), (1, "x")),
    ((arguments.row_of(2, arguments.WHOLE),), "12"),
    ((arguments.sequence_of(arguments.TEXT),), iter("ab")),
    ((arguments.mapping_of(arguments.NUMBER),), {1: 2}),
    ((arguments.one_of("x", "v"),), "t"),
    ((arguments.function_of(2),), lambda: None),
    ((arguments.function_of(1),), int),
    ((arguments.EXECUTOR,), object()),
    ((symosc.Scene, symosc.Parameters), "fig5"),
]


class GivenUp(BaseException):
    """A call that takes too long."""


@contextlib.contextmanager
def time_limit() -> Iterator[None]:
    """Give up what takes too long."""

    def give_up(*_: object) -> None:
        raise GivenUp

    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(GIVEN_UP)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def wrong(
    name: str, call: Callable[..., Any], given: dict[str, Any], parameter: str, value: str
) -> str:
    """Return what is wrong with what a call does with a value, "" if nothing is."""
    usual = inspect.signature(call).parameters.get(parameter)
    valid = is_valid(name, parameter, value, usual and usual.default)
    try:
        with time_limit():
            call(**given | {parameter: VALUES[value]()})
    except ParameterError as error:
        line = str(error)
        named = line.startswith((parameter, *CALLED.get(parameter, ())))
        if named and "\n" not in line and len(line) < 400:
            return ""
        return f"says {line!r}"
    except (SymoscError, GivenUp):
        return ""
    except Exception as error:
        index = name.endswith("__getitem__") and isinstance(error, IndexError)  # as of any sequence
        if index or (valid and value == "broken"):
            return ""
        return f"raises {error!r:.200}"
    if valid:
        return ""
    return "is accepted"


def fuzz(
    calls: dict[str, tuple[Callable[..., Any], dict[str, Any]]], rng: random.Random, share: float
) -> int:
    """Try a share of all values for all parameters of calls; return how many that were."""
    results = []
    count = 0
    for name, (call, valid) in calls.items():
        valid = full(call, valid)
        for parameter in valid:
            for value in VALUES:
                if rng.random() < share and (parameter, value) != (
                    "use_numba",
                    "True",
                ):  # which compiles for a minute
                    count += 1
                    reason = wrong(name, call, valid, parameter, value)
                    if reason:
                        results.append(f"{name}({parameter} = {value}) {reason}")
        plt.close("all")
    assert results == []
    return count


@pytest.fixture
def somewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.usefixtures("somewhere")
def test_some_hostile_values() -> None:
    calls = functions()
    del calls["atlas"]  # which takes as long as one lets it
    assert fuzz(calls, random.Random(1), 0.02) > 140


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.usefixtures("somewhere")
@pytest.mark.parametrize("share", [0.02, pytest.param(1.0, marks=pytest.mark.campaign)])
def test_hostile_values_of_every_parameter(share: float) -> None:
    calls = functions() | of_answers()
    for call, valid in calls.values():
        call(**valid)
    assert fuzz(calls, random.Random(2), share) > 15_000 * share


@pytest.mark.slow
def test_everything_public_is_tried() -> None:
    """What takes no argument cannot be given a wrong one.

    Constructors of answers are for symosc alone.
    """
    tried = {name.split()[0] for name in functions() | of_answers()}
    for prefix, module in (("", symosc), ("plot.", plot)):
        for name in module.__all__:
            result = getattr(module, name)
            if isinstance(result, types.FunctionType):
                assert prefix + name in tried
            elif isinstance(result, type) and not issubclass(result, Exception):
                for method, each in vars(result).items():
                    called = method in (
                        "__call__",
                        "__getitem__",
                        "__contains__",
                    ) or not method.startswith("_")
                    if (
                        called
                        and isinstance(each, types.FunctionType)
                        and len(inspect.signature(each).parameters) > 1
                    ):
                        assert f"{name}.{method}" in tried


@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("scene", lambda: made("orbit").approach(1, 1)),  # type: ignore[arg-type]
        ("plane", lambda: plot.window_figure(symosc.grazing_window(P9, "P2"), "x")),  # type: ignore[arg-type]
        ("over", lambda: symosc.sweep("fig9", {("a",): [1]})),  # type: ignore[dict-item]
        ("over", lambda: symosc.sweep("fig9", [{"Omega": {}}])),
        ("record", lambda: symosc.sweep("fig9", {"Omega": [1]}, record=[{}])),  # type: ignore[list-item]
        ("t0", lambda: symosc.simulate_many(P9, [[np.timedelta64(3, "s"), 0, 0]], 3)),
        ("columns", lambda: symosc.crosscheck("fig5", [0, 1], [0, 1], [0, 1], columns=print)),  # type: ignore[arg-type]
        ("progress", lambda: symosc.crosscheck("fig5", [0, 1], [0, 1], [0, 1], progress=5)),  # type: ignore[arg-type]
        ("progress", lambda: symosc.simulate("fig5", progress=lambda part: None)),  # type: ignore[arg-type,misc]
    ],
)
def test_cases_of_an_audit(name: str, call: Callable[[], Any]) -> None:
    refused(call, name)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: symosc.simulate("fig5", tend=4),
            r"simulate.*'tend'; known are scene, .*; did you mean t_end\?",
        ),
        (
            lambda: symosc.Parameters(mu_1=1),
            r"Parameters\(\).*'mu_1'; known are m, c, k, .*, FN; did you mean mu1\?",
        ),
        (
            lambda: symosc.OtherModel(m=1, k=1, Omega=1, FN=1, join=True),
            r"^OtherModel\(\).*'join'; known are m, k, .*, belts; did you mean joined\?",
        ),
        (lambda: symosc.Parameters(mu=1), r"'mu'; known are m, .*; did you mean mu1 or mu2\?"),
        (
            lambda: symosc.simulate(P9, 14),
            r"^simulate\(\) takes only scene .*: t0=, .*t_end=.*progress=$",
        ),
        (
            lambda: symosc.Parameters(1, 2),
            r"^Parameters\(\) takes nothing without a name; .*: m=, c=, k=, .*, FN=$",
        ),
        (
            lambda: P9.replace("mu1", 3),
            r"^Parameters.replace\(\) takes nothing without a name; .*: NAME=VALUE$",
        ),
        (
            lambda: symosc.simulate("fig5", t_end=1).plot("b"),
            r"^figure\(\) takes only subject .*: .*panels=, ",
        ),
    ],
)
def test_arguments_that_no_function_takes(call: Callable[[], Any], words: str) -> None:
    with pytest.raises(TypeError, match=words):
        call()


def test_a_call_that_does_not_fit_is_a_type_error() -> None:
    @public
    def f(self: Any, a: int, /, *more: object, b: object = None) -> object:
        if a:
            raise TypeError("from inside")
        return b

    assert f(0, 0, 1, 2, b=3) == 3
    with pytest.raises(TypeError, match=r"f\(\) is missing a$"):
        f(0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="missing"):
        f()  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"'c'; known are a, more, b"):
        f(0, 0, c=1)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match=r"^from inside$"):
        f(0, 1)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: symosc.Belt(), "Belt() is missing v (speed of the belt; 0 is a wall)"),
        (
            lambda: symosc.Oscillator(m=1, c=0),
            "Oscillator() is missing k (m, c, k: mass, damper and spring; m > 0, c >= 0, k >= 0) and "
            "belts (sequence of Belt, such as [Belt(1, mu=0.2)])",
        ),
        (
            lambda: symosc.Parameters(**{name: 1 for name in P9.as_dict() if name != "FN"}),
            "Parameters() is missing FN (normal force >= 0; optional in an Oscillator)",
        ),
        (
            lambda: symosc.Scene("mine", P9, 0, 0, 0),
            "Scene() is missing t_end (where a simulation of the scene ends; later than t0)",
        ),
        (lambda: symosc.Belt(1, v=2), "Belt() got v twice: without a name, and by name"),
        (
            lambda: made("trajectory").to_csv(),
            "Trajectory.to_csv() is missing path (name of a file, or '-' for standard output)",
        ),
    ],
)
def test_a_missing_argument_is_named_and_explained(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(TypeError) as caught:
        call()
    assert str(caught.value) == message


def _with_required_arguments() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield what users call that requires an argument: functions, classes and methods of answers."""
    made_by_users = (
        symosc.Belt, symosc.Oscillator, symosc.OtherModel, symosc.Parameters, symosc.Scene,
    )  # fmt: skip
    for prefix, module in (("", symosc), ("plot.", plot)):
        for name in module.__all__:
            subject = getattr(module, name)
            if isinstance(subject, types.FunctionType) or subject in made_by_users:
                yield prefix + name, subject
            elif isinstance(subject, type) and not issubclass(subject, Exception):
                for method, function in vars(subject).items():
                    if isinstance(function, types.FunctionType) and not method.startswith("_"):
                        yield f"{name}.{method}", partial(function, None)


def test_every_missing_argument_is_explained() -> None:
    """One mechanism for all: a name alone, or Python's own message, says too little."""
    count = 0
    for name, call in _with_required_arguments():
        parameters = inspect.signature(call).parameters.values()
        variable = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
        required = [
            item.name
            for item in parameters
            if item.default is item.empty and item.kind not in variable
        ]
        if not required:
            continue
        count += 1
        with pytest.raises(TypeError) as caught:
            call()
        title, missing, rest = str(caught.value).partition("() is missing ")
        assert missing, f"{name}: {title}"
        assert rest.count("(") >= 1, f"{name}: {rest}"
        for parameter in required:
            explained = rf"\b{parameter}(, \w+)* \("
            assert re.search(explained, rest), f"{name}: {rest}"
    assert count > 80


def test_require_refuses_what_is_of_no_kind() -> None:
    require(arguments.WHOLE, arguments.TEXT, a=1, b="x")
    require_or_none(arguments.NUMBER, a=None, b="4/5", c=np.array(1.0))
    require(symosc.Scene, a=symosc.load_scene("fig5"))
    for kinds, value in WRONG:
        message = refused(lambda kinds=kinds, value=value: require(*kinds, a=value), "a")
        assert ": must be " in message


def test_a_refusal_lists_the_kinds() -> None:
    with pytest.raises(ParameterError, match=r"^a = 1: must be text, a slice or None$"):
        require_or_none(arguments.TEXT, arguments.SLICE, a=1)
    with pytest.raises(ParameterError, match=r"must be a Scene; load_scene\(\.\.\.\) makes one$"):
        require(symosc.Scene, a=1)
    with pytest.raises(ParameterError, match=r"must be a mapping of names, each a number or None$"):
        require(arguments.mapping_of(arguments.REAL, arguments.NONE), a={"x": "1"})


def slope_of_text(w: float) -> str:
    return f"{w} N"


def test_messages_name_functions_and_not_where_they_are_in_memory() -> None:
    law = symosc.Oscillator(m=1, c=0, k=1, belts=[symosc.Belt(1, mu=1)])
    wrong: list[Callable[[], Any]] = [
        lambda: symosc.Belt.from_function(1, slope_of_text, 4),
        lambda: symosc.Belt(1, curve=slope_of_text),
        lambda: symosc.attractors(law, {"x0": slope_of_text, "v0": [1]}),
        lambda: symosc.return_map(law, belt=slope_of_text),
        lambda: symosc.bifurcation(law, {"v1": [slope_of_text]}),
    ]
    for call in wrong:
        with pytest.raises(ParameterError) as error:
            call()
        assert "slope_of_text" in str(error.value)
        assert "0x" not in str(error.value)
