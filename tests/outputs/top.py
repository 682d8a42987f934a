"""What the modules beside the packages give.

Responses, fits, derivatives, other models, words, numbers, files.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import sympy
from other_models import KINDS, drawn
from paper_orbits import FIG9
from regimes import random_sets
from said import empty_folder, error_of, errors_of, outcome, written

from symosc import (
    Fit,
    OtherModel,
    ParameterError,
    Parameters,
    Scene,
    Sensitivities,
    find_orbit,
    fit,
    frequency_response,
    load_scene,
    read_word,
    sensitivities,
    simulate,
    simulate_many,
)
from symosc.analysis.response import FrequencyResponse, harmonic_balance, meets_no_belt
from symosc.base.errors import brief, meant
from symosc.base.exact import read_exact, read_start_error, show
from symosc.base.files import check_folder_of, check_new_folder, write_folder, write_text
from symosc.base.quantities import half_unit, read_number, rounded
from symosc.reductions import cos_sin, reduced_start
from symosc.words import WordError, cycle, why_not

FIG5 = load_scene("fig5").parameters
ONE_BELT = OtherModel(m=1, k=1, c="0.1", Omega=1, FN="0.4", B0=1)


def whole(found: FrequencyResponse) -> Iterator[Any]:
    """Yield the columns of a response, the small differences left out, and what it says."""
    for name, column in found.columns().items():
        if name not in ("error", "dissipated"):
            yield [name, *column.tolist()]
    yield repr(found)


def responses() -> Iterator[Any]:
    """Yield responses of each kind of settled motion and model, over several parameters."""
    yield whole(frequency_response("fig9", {"Omega": "3:5:5"}))
    yield whole(frequency_response("fig10", {"B0": [-5, 4, 5]}))
    yield whole(frequency_response(ONE_BELT, {"FN": [0, "0.1", "0.5", "0.9", "1.1"]}))
    yield whole(frequency_response(ONE_BELT.replace(c=0), {"Omega": ["0.5", 1, "1.3"]}))
    yield whole(frequency_response(ONE_BELT.replace(c=0, FN="0.1"), {"Omega": ["0.5"]}))
    yield whole(frequency_response(ONE_BELT.replace(c=0, FN=1, v1=-9, v2=9), {"Omega": [3]}))
    one, other = (frequency_response("fig9", {"FN": [5, FN]}) for FN in (9, 10))
    yield [one == one, one == other, len(one), error_of(lambda: one.colour)]
    head, *rows = written(one.to_csv, "a.csv").splitlines()
    yield [head, *(row.rpartition(",")[0].rpartition(",")[0] for row in rows)]
    base = OtherModel(m=1, k=1, c="0.2", Omega=1, FN="1/4", Y=1, joined=True)
    yield whole(frequency_response(base, {"Y": [1, 2]}))
    yield whole(
        frequency_response(base.replace(joined=False, v1=-3, v2=3, mu2=1), {"Y_phase": [0, 1]})
    )
    yield whole(frequency_response(ONE_BELT.replace(B0=0, W=1, v1="0.2"), {"W": [1, 2]}))
    yield whole(frequency_response(ONE_BELT.replace(v1=-9, v2=9), {"c": ["0.3", 0]}))
    seeds = random.Random("responses")
    for kind in KINDS:
        model = drawn(kind, seeds.randrange(99)).replace(c="1/2")
        yield whole(frequency_response(model, {"Omega": [float(model.Omega)]}))


def balances() -> Iterator[Any]:
    """Yield means and harmonics by harmonic balance, and which motions meet no belt."""
    for p in random_sets(8, 24):
        if p.k:
            mean, z = harmonic_balance(p)
            yield [mean, z.real, z.imag, str(meets_no_belt(p))]
    still = Parameters(m=1, c=0, k=1, A0=1, B0=1, Omega=1, v1=-1, v2=2, mu1="0.1", mu2="0.2", FN=1)
    yield [*map(str, harmonic_balance(still)), str(meets_no_belt(still))]


def told(s: Sensitivities) -> Iterator[Any]:
    """Yield the derivatives of a motion."""
    yield repr(s)
    yield s.dt.astype(float)
    yield s.dx.astype(float)
    yield [*s.regular.ravel().tolist()]
    yield [str(each) for each in s.reasons]
    yield s.lyapunov
    times = np.linspace(float(s.trajectory.t_start), float(s.trajectory.t_end), 15)
    yield s(times).astype(float)
    yield s(float(times[4])).astype(float)


def derivatives() -> Iterator[Any]:
    """Yield derivatives of motions by all numbers, at grazes, from starts on belts, and with digits."""
    every = (*FIG9.as_dict(), "t0", "x0", "v0")
    yield told(sensitivities("fig5", every, t_end=7))
    yield told(sensitivities("fig10", ("Omega", "v2", "x0"), t_end=5))
    yield told(sensitivities("fig9", ("FN", "v0"), v0=3, t_end=2))
    yield told(sensitivities("fig8-exact", ("FN", "x0", "v1"), t_end=9))
    yield told(sensitivities("fig5", ("mu1", "x0"), t_end=3, digits=20))
    yield told(sensitivities("fig5", ("mu1", "x0"), t_end=8, max_events=3))
    yield told(sensitivities("fig7", ("x0", "v0"), t_end=3))
    undriven = Parameters(m=1, c=0, k=1, A0=0, B0=0, Omega=1, v1=0, v2=5, mu1="0.3", mu2=0, FN=1)
    yield told(sensitivities(undriven, ("k", "v1", "x0"), x0=2, t_end=9))
    yield told(sensitivities(undriven, ("mu1", "FN"), x0="0.3", t_end=2))
    yield told(sensitivities(undriven.replace(v1=1), ("A0", "v0"), x0="0.3", v0=1, t_end=5))
    for p in random_sets(12, 6):
        yield told(sensitivities(p, ("m", "c", "v2", "t0"), x0=1, v0=p.v2, t_end=6, max_events=9))


def fits() -> Iterator[Any]:
    """Yield fits to events and samples in each form, and to data that do not determine the numbers."""

    def said(found: Fit) -> list[Any]:
        message = found.message.partition(" motions")[2] or found.message
        numbers = [*found.values.values(), *found.errors.values()]
        return [found.success, message, *numbers, *np.ravel(found.covariance), len(found.residuals)]

    dice = np.random.RandomState(5)
    motion = simulate("fig5", t_end=20)
    events = [(event.t + dice.normal() * 1e-3, event.kind) for event in motion.events]
    yield said(fit("fig5", events, ("mu1", "c"), sigma=1e-3, start={"mu1": "0.82"}))
    yield said(fit("fig5", events[:6], "FN"))
    yield said(fit("fig5", events[:1], "mu1"))
    t = np.linspace(0.1, 20, 60)
    x, v = motion(t) + dice.normal(size=(2, 60)) * 1e-3
    yield said(fit("fig5", {"t": t, "x": x, "v": v}, ("k", "x0"), sigma=(1e-3, 2e-3)))
    yield said(fit("fig5", list(zip(t, x, strict=True)), "B0", start={"B0": "10.1"}))
    scaled = fit("fig5", events, ("m", "c", "k", "A0", "B0", "FN"), sigma=1e-3)
    yield [scaled.success, scaled.message.partition("(")[0], *scaled.errors.values()]
    yield said(fit(FIG5, [(t, "graze") for t in (1, 2)], "mu1", sigma=1))


def models() -> Iterator[Any]:
    """Yield other models as symosc's oscillator, in both directions."""
    kinds: list[dict[str, Any]] = [
        {},
        {"phase": "-pi/2"},
        {"phase": "pi/3", "Y": "0.3", "c": "0.2"},
        {"Y": 1, "joined": True, "B0": 0},
        {"Y": 3, "Y_phase": "pi/2", "c": "0.5", "B0": 0, "v2": 2, "mu2": "0.4"},
        {"W": "0.7", "W_phase": 1, "B0": 0},
        {"FN": None, "g": "9.81", "angle": "pi/6", "mu1": "0.3"},
        {"FN": None, "g": "9.81", "angle": 0, "v1": -1},
        {"W": 1, "Y": 2, "joined": True, "Y_phase": "pi", "c": "0.1"},
    ]
    for changes in kinds:
        model = OtherModel(**({"m": 2, "k": "1.5", "Omega": "1.2", "FN": "0.8", "B0": 1} | changes))
        yield [repr(model), model.exact, float(model.delay), str(model.parameters)]
        yield [float(np.sum(each)) for each in model.back(1.5, "0.25", [2])]
        yield [float(each) for each in model.forth(1.5, "0.25", 2)]
        start, error = reduced_start(model, Fraction(1, 2), Fraction(3), Fraction(-1, 3))
        yield [float(each) for each in start]
        yield [show(each) for each in error]
    for text in ("0", "pi/2", "-3*pi/2", "7*pi", "1", "1e-40", "pi/4"):
        cos, sin, exact = cos_sin(read_number("phase", text)[0])
        yield [text, float(cos), float(sin), exact]


def words() -> Iterator[str]:
    """Yield words read from each form, what can follow what, and words in print."""
    for given in (
        "P32", "P3∘P2", "P3 P2", ["P3", "P2"], "P_{4645}", "P4, P1", "P52", "P9", "", "P22", "P44", "P3 5", " P3*P2 ",
        "P3·P2,P8", "P_3 P_2", ("P32",), "P47", "P313", "P57", "P58", [3],
    ):  # fmt: skip
        for how in ({}, {"closed": False}, {"grazing": True}):
            try:
                word = read_word(given, **how)
                yield f"{given} {how}: {word} {word.exits()} {word.latex()} {cycle(str(word))}"
            except WordError as error:
                yield f"{given} {how}: {error} {error.step}"
    labels = [f"P{n}" for n in range(1, 9)]
    yield "\n".join(why_not(a, b) or f"{a} {b}" for a in labels for b in labels)
    yield f"{why_not('P2', 'P2', grazing=True)!r} {why_not('P5', 'P3', grazing=True)}"
    yield repr(simulate("fig5", t_end=300).word)
    yield repr(simulate("fig9", t_end=60).word)
    yield repr(simulate("fig10", t_end=19).word)


def numbers() -> Iterator[str]:
    """Yield numbers read from all forms, shown, rounded, and refused."""
    values: list[Any] = [
        0.8, np.float64(0.8), sympy.Rational(4, 5), np.array(0.8)[()], "4/5", " 8e-1 ", 3, Fraction(2, 7), True,
        Decimal("1.50"), np.float32(0.1), np.int8(-3), mpmath.mpf("0.1"),
        "1e2000", "nan", "1/0", "2*pi", "0,5", None, 1e51, float("inf"), "1_0", "1" * 30, "1e-30", "-12.5e25", 2.0**-60,
    ]  # fmt: skip
    for value in values:
        yield outcome(
            lambda value=value: f"{value!r:.40}: {show(read_exact('x', value))}", ParameterError
        )
    for text in (
        "3*pi/2", "2*3 - 1/4", "-(1 + 2)^2/3", "sqrt(2)", "sin(pi/6)*2", "exp(-1)", "cos(1)", "pi - pi", "sqrt(-1)",
        "2^0.5", "1/(1-1)", "2 pi", "--1", "import", "exp(1000)", "+pi", "2**3", "π/4", "sqrt(2)^2", "1e3*pi",
    ):  # fmt: skip
        found = outcome(lambda text=text: read_number("k", text), ParameterError)  # type: ignore[misc]
        yield f"{text}: {found if isinstance(found, str) else f'{show(found[0])[:60]} {found[1]}'}"
    for value in (Fraction(1, 3), Fraction(-2, 7) * 10**9, Fraction(10**50 + 1), Fraction(5)):
        yield f"{show(rounded(value))} {show(half_unit(value))}"
    for given in (None, 1, "0.5", [1, 2, "1/3"], (1, 2), -1):
        yield f"{given}: {error_of(lambda given=given: read_start_error(given))} "
    yield brief("a	b" * 300)
    yield "".join(
        meant(each, [*FIG9.as_dict()]) for each in ("Omga", "zzz", "mu", "v3", "FN", "b0")
    )
    yield f"{FIG9!r} {FIG9._repr_latex_()} {FIG9.replace(k='1/3', c='1e-30')!r} {[str(FIG9.A(n)) for n in (1, 2, 3)]}"


def files() -> Iterator[str]:
    """Yield what is written, and what cannot be."""
    with empty_folder() as folder:
        yield f"{write_text(folder / 'a.txt', 'words').name} {(folder / 'a.txt').read_text(encoding='utf-8')}"
        write_folder(folder / "new", {"one.txt": "1", "in/two.txt": "2"}, lambda _: ())
        write_folder(folder / "new", {"three.txt": "3"}, lambda _: ("one.txt", "in/two.txt"))
        yield " ".join(sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*")))
        calls: list[Callable[[], object]] = [
            lambda: write_folder(folder / "new", {"one.txt": "1"}, lambda _: ()),
            lambda: write_folder(folder / "a.txt", {}, lambda _: ()),
            lambda: write_folder("-", {}, lambda _: ()),
            lambda: write_text(folder, "x"),
            lambda: write_text(folder / "no" / "b.txt", "x"),
            lambda: write_text("", "x"),
            lambda: write_text(3, "x"),  # type: ignore[arg-type]
            lambda: check_folder_of(folder / "no" / "b.txt"),
            lambda: check_folder_of(folder / "b.txt"),
            lambda: check_new_folder(folder / "a.txt" / "b"),
            lambda: check_new_folder(folder / "b" / "c"),
        ]
        yield errors_of(calls).replace(f"{Path.cwd()}/", "")


def bad_arguments() -> str:
    """Return what public functions say to arguments of wrong types."""
    return errors_of(
        [
            lambda: simulate(3),  # type: ignore[arg-type]
            lambda: simulate("fig99"),
            lambda: simulate("fig9", t_end=[1]),  # type: ignore[arg-type]
            lambda: simulate("fig9", progress="yes"),  # type: ignore[arg-type]
            lambda: sensitivities("fig9", 3),  # type: ignore[arg-type]
            lambda: sensitivities("fig9", "mu"),
            lambda: sensitivities("fig9", ("mu1", "mu1")),
            lambda: sensitivities("fig9", ("mu1", 3)),  # type: ignore[arg-type]
            lambda: read_word("P32", closed=1),  # type: ignore[arg-type]
            *(lambda over=over: frequency_response("fig9", over) for over in WRONG_OVER),
            *(lambda data=data: fit("fig5", data, "mu1") for data in WRONG_DATA),
            lambda: fit("fig5", [(1, "slip")], "mu"),
            lambda: sensitivities("fig5", ()),
            lambda: sensitivities("fig5", "mu1", t_end=3)(99),
            lambda: find_orbit("fig9").sensitivities(("mu1", "mu1")),
            lambda: simulate_many(FIG9, (0, 0, 1), 3, wrt="mu"),
            lambda: frequency_response("fig9", {"omega": [1]}),
            lambda: frequency_response(FIG9.replace(k=0), {"c": [1, 2]}),
            lambda: fit("fig5", [(1, "slip")], "mu1", start={"c": 1}),
            lambda: fit("fig5", [(1, "slip")], "mu1", sigma=0),
            lambda: FIG9.replace(Mu1=2),
            lambda: FIG9.replace(v1=30),
            lambda: Parameters(**(FIG9.as_dict() | {"omega": 1})),  # type: ignore[arg-type]
            lambda: FIG9.replace(m="1e-60"),
            lambda: FIG9.A(4),
            lambda: OtherModel(m=1, k=1, Omega=1),
            lambda: OtherModel(m=1, k=1, Omega=1, FN=1, mu2=1),
            lambda: OtherModel(m=1, k=1, Omega=0, FN=1),
            lambda: OtherModel(m=1, k=1, Omega=1, FN=1, joined="maybe"),  # type: ignore[arg-type]
            lambda: sensitivities(Scene("mine", ONE_BELT, 0, 0, 0, 5)),
        ]
    )


WRONG_OVER: tuple[Any, ...] = (
    {"Omega": 1, "k": 2}, {"X": [1]}, {"Omega": "1:2"}, {"m": [0]}, {"k": [0]}, 5,
)  # fmt: skip
WRONG_DATA: tuple[Any, ...] = (
    [(1, 2, 3, 4)], [(1, "slop")], [], {"t": [1.0]}, {"time": [1.0], "kind": ["stick"]}, "stops.csv",
    {"t": [1.0, 2.0], "x": [1.0]},
)  # fmt: skip

CASES: dict[str, Callable[[], object]] = {
    "responses": responses,
    "balances": balances,
    "derivatives": derivatives,
    "fits": fits,
    "models": models,
    "words": lambda: "\n".join(words()),
    "numbers": lambda: "\n".join(numbers()),
    "files": lambda: "\n".join(files()),
    "bad arguments": bad_arguments,
}
