"""Periodic orbits, roots that are none, branches with each kind of end, and borders with their special points."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
from paper_orbits import BOTH_BELTS, FIG9, FIG10
from parameter_sets import COULOMB, MANY_SLIPS, PLANE, SHRINKS
from said import errors_of

from symosc import (
    Border,
    Branch,
    Parameters,
    PeriodicOrbit,
    Scene,
    continue_border,
    continue_orbit,
    find_orbit,
)
from symosc.orbits.admissibility import conditions, grazing_distance
from symosc.orbits.border import borders_between, passes
from symosc.orbits.branch import piece_margins
from symosc.orbits.closing_equations import ClosingEquations
from symosc.orbits.find import resting_text
from symosc.orbits.floquet import rest_positions
from symosc.words import read_word

#: No damper.
UNDAMPED = COULOMB.replace(c=0, FN=1, mu1="0.1", Omega="1.5", v2=100)
MARGINAL = UNDAMPED.replace(Omega="0.5")


def numbers(p: Parameters) -> list[float]:
    """Return parameters as doubles, which may differ by rounding."""
    return [float(getattr(p, name)) for name in p.as_dict()]


def whole(orbit: PeriodicOrbit) -> Iterator[Any]:
    """Yield all that an orbit says: its numbers, states over two periods, and nearest start."""
    yield orbit.as_dict()
    yield orbit(np.linspace(-0.3, 1.7, 30) * float(orbit.period))
    yield orbit.phases()


@cache
def found(p: Parameters, word: str | None = None, **how: Any) -> PeriodicOrbit:
    return find_orbit(p, word, **how)


def ways_to_guess() -> Iterator[Any]:
    """Yield the orbits found from each kind of guess."""
    points = [(t + 0.01, x - 0.02) for t, x in found(FIG9, "P32").points]
    guesses = [points, (0.18, 4.15), {"t": [0.2, 1.0], "x": [4, -4]}, found(FIG9, "P32")]
    for guess in guesses:
        orbit = find_orbit(FIG9.replace(Omega="4.1"), "P32", guess)
        yield [*np.ravel(orbit.points), orbit.message]


def columns(branch: Branch) -> Iterator[Any]:
    """Yield what a branch has that reaches both ends of its range."""
    about = branch.as_dict()
    for name in ("values", "points", "multipliers"):
        yield getattr(branch, name)
    yield {name: about[name] for name in ("word", "parameter", "periods", "ends")}
    yield [bool(branch.stable.all()), branch.orbit(2, digits=20).message]
    yield repr(branch)


def ends(branch: Branch) -> Iterator[Any]:
    """Yield what a branch says about its ends, and the orbit in its middle."""
    about = branch.as_dict()
    yield {name: about[name] for name in ("word", "parameter", "periods", "ends")}
    yield bool(branch.stable.all())
    middle = branch.orbit(len(branch.values) // 2)
    yield middle.admissible


@cache
def branch(p: Parameters, word: str, parameter: str, *limits: Any, **how: Any) -> Branch:
    return continue_orbit(p, word, parameter, limits, **how)


#: Belt 2 or 1 is met from B0 = 1.0169 on, where the steady motion without friction is as fast.
BELOW = COULOMB.replace(v1=-9, v2="1.9", mu2=1, c="0.5", Omega="1.1", FN=1)
ABOVE = BELOW.replace(v1="1.9", v2=9)


def free_branch() -> Branch:
    """Return a branch that ends where the motion no longer meets a belt."""
    return branch(BELOW.replace(B0="1.2"), "P45", "B0", "0.9", "1.25")


def graze_branch() -> Branch:
    return branch(FIG9.replace(Omega=5), "P32", "Omega", 4.99, 5.1)


def between(p: Parameters, changed: str, low: Any, high: Any, **ranges: Any) -> Iterator[Any]:
    """Yield what is said of the borders between two sets of parameters."""
    ends = [p.replace(**{changed: value}) for value in (low, high)]
    for border in borders_between(*ends, tuple(ranges), ranges, step="0.1"):
        yield from of_border(border)


@cache
def stick_border() -> Border:
    """Return the border on which P32 loses to sticks, with a fold and a point of codimension two."""
    return continue_border(
        branch(COULOMB.replace(FN="0.72"), "P32", "FN", 0.7, 0.8), 1, "Omega", PLANE, step="0.05"
    )


def where_it_passes() -> list[bool]:
    """Return whether points of a border are on the same border in long steps, and whether points beside it are."""
    border = stick_border()
    coarse = continue_border(
        branch(COULOMB.replace(FN="0.72"), "P32", "FN", 0.7, 0.8), 1, "Omega", PLANE, step="0.1"
    )
    places = [border.points[i] + shift for shift in (0, 1e-3) for i in range(2, len(border), 5)]
    return [
        passes(coarse, place, words)
        for words in (border.words, ("P32", "rest"))
        for place in places
    ]


def of_border(border: Border) -> Iterator[Any]:
    """Yield what a border says but for its points, and what is beside it."""
    about = border.as_dict()
    yield {name: value for name, value in about.items() if name not in ("points", "errors")}
    middle = len(border) // 2
    yield list(map(numbers, border.beside(middle, "0.01")))
    yield border.words_beside(middle, "1e-5")
    yield [str(border.orbit(middle).word), border.orbit(middle).periods]
    yield border.orbit(middle).points


def margins() -> Iterator[Any]:
    """Yield the inequalities of random points, of all kinds of pieces, and the functions that bound them."""
    rng = random.Random("margins")
    for word in ("P32", "P12", "P312", "P4645", "P1748", "P7482", "P174648"):
        v1 = rng.uniform(-2, 0.5)
        p = Parameters(
            m=f"{rng.uniform(0.5, 2):.3f}", c=f"{rng.uniform(0, 1):.3f}", k=f"{rng.uniform(0.5, 4):.3f}", A0=1,
            B0=f"{rng.choice([-1, 1]) * rng.uniform(1, 6):.3f}", Omega=f"{rng.uniform(0.3, 2):.3f}", v1=f"{v1:.3f}",
            v2=f"{v1 + 1.5:.3f}", mu1="0.5", mu2="0.4", FN=5,
        )  # fmt: skip
        equations = ClosingEquations(p, read_word(word), rng.choice([1, 3]))
        count = len(equations.pieces)
        begin = rng.uniform(0, 6)
        cuts = sorted(float(equations.turn) * rng.random() for _ in range(count - 1))
        points = np.array([(rng.uniform(-3, 3), begin + cut) for cut in (0.0, *cuts)])
        yield [word, *equations.residuals(points), grazing_distance(equations, points)]
        yield np.array(equations.matrix(points))
        for c in conditions(equations, points):
            yield [c.text, c.event, c.rank, c.piece, c.value, c.t, c.scale]
        for i in range(count):
            yield [
                values.sum() for values in piece_margins(equations, points, i, np.linspace(0, 1, 7))
            ]


def undriven() -> Iterator[Any]:
    """Yield the positions of rest of belts at rest, with and without drive."""
    for p in (
        COULOMB,
        COULOMB.replace(FN=2),
        COULOMB.replace(FN=2, A0="0.3", mu2="0.25"),
        COULOMB.replace(k=0),
    ):
        yield [str(rest_positions(p, belt)) for belt in (1, 2)]
        yield str(rest_positions(p.replace(v1=-2, v2=0, mu1="0.1", mu2="0.6"), 2))


CASES: dict[str, Callable[[], object]] = {
    "P32": lambda: whole(found(FIG9, "P32")),
    "P4645": lambda: whole(found(FIG10, "P4645")),
    "P1748 of two belts": lambda: whole(found(BOTH_BELTS, "P1748")),
    "P174648 with slips": lambda: whole(found(MANY_SLIPS, "P174648")),
    "P32 with digits": lambda: found(FIG9, "P32", digits=20).as_dict(),
    "formulas": lambda: "\n".join(
        found(p, w)._repr_latex_() for p, w in ((FIG9, "P32"), (FIG10, "P4645"))
    ),
    "exponents": lambda: [found(FIG9, "P32").lyapunov, found(FIG10, "P4645").lyapunov],
    "margins of P32": lambda: [c._asdict() for c in found(FIG9, "P32").conditions()],
    "margins of P4645": lambda: [c._asdict() for c in found(FIG10, "P4645").conditions()],
    "derivatives of an orbit": lambda: found(FIG10, "P4645").sensitivities(("FN", "v2", "A0")),
    "settled": lambda: [
        repr(find_orbit(p)) for p in (FIG9, FIG10, COULOMB, COULOMB.replace(FN="0.9"), SHRINKS)
    ],
    "words for where motions end": lambda: [resting_text(SHRINKS, mode) for mode in range(1, 6)],
    "approaches": lambda: [
        found(FIG9, "P32").approach("fig9"),
        found(FIG10, "P4645").approach("fig10", within="1e-3"),
        found(FIG9, "P32").approach("fig9-orbit"),
        found(FIG10, "P4645").approach("fig10-orbit"),
        found(MARGINAL, "P32").approach(Scene("never near", MARGINAL, 0, 2, 1, 4)),
        found(FIG9, "P3232", periods=2).approach(Scene("off a belt", FIG9, 1, 2, -3, 4)),
    ],
    "rotations": lambda: [
        found(p, w).points for p, w in ((FIG9, "P23"), (FIG10, "P6454"), (FIG10, "P5464"))
    ],
    "guesses": ways_to_guess,
    "roots that are no orbits": lambda: [
        find_orbit(FIG9.replace(Omega=3), "P32").as_dict(),
        find_orbit(FIG9, "P32", periods=3).message,
        find_orbit(COULOMB.replace(FN="1.1"), "P32").message,
        find_orbit(FIG9.replace(Omega="3.4"), "P132").message,
        find_orbit(FIG10.replace(B0=4), "P4645").as_dict(),
    ],
    "more periods": lambda: found(FIG9, "P3232", periods=2).as_dict(),
    "no damper": lambda: [
        find_orbit(UNDAMPED.replace(Omega=Omega), "P32").message for Omega in ("1.5", "0.5")
    ],
    "no orbit": lambda: errors_of(
        [
            lambda: find_orbit("fig7"),
            lambda: find_orbit("fig8"),
            lambda: find_orbit(COULOMB.replace(FN="1.1")),
            lambda: find_orbit(UNDAMPED),
            lambda: find_orbit(FIG10, "P32", [(0.2, 4.0), (1.0, -4.0)]),
            lambda: find_orbit(FIG9, "P4645", (0.18, 4.15)),
            lambda: find_orbit(FIG9, "P32", [(1, 4), (0.2, 4)]),
            lambda: find_orbit(FIG9, "P32", [(1, 4), (3.2, 4)], periods=1),
            lambda: find_orbit(FIG9, "P42"),
            lambda: find_orbit(FIG9, ["P3", "P2"] * 21),
            lambda: find_orbit(FIG9.replace(k=0), "P32"),
            lambda: find_orbit(FIG9, "P32", periods=0),
            lambda: find_orbit(FIG9, periods=2),
            lambda: find_orbit(FIG9, "P32", digits=2.5),  # type: ignore[arg-type]
            lambda: find_orbit(5, "P32"),
            lambda: found(FIG9, "P32").approach("fig9", within=0),
            lambda: found(FIG9, "P32").approach("fig10"),
            lambda: found(FIG9, "P32").sensitivities("FM"),
        ]
    ),
    "margins anywhere": margins,
    "positions of rest": undriven,
    "branch: range": lambda: columns(branch(FIG9, "P32", "Omega", 3.9, 4.1)),
    "branch: stick is born": lambda: ends(
        branch(FIG9.replace(Omega="3.29"), "P32", "Omega", "3.28", "3.3")
    ),
    "branch: graze": lambda: ends(graze_branch()),
    "branch: slip is born": lambda: ends(branch(FIG10.replace(B0=5), "P45", "B0", "4.99", "5.1")),
    "branch: no belt": lambda: ends(free_branch()),
    "branch: most points": lambda: [
        end.kind for end in branch(FIG9, "P32", "Omega", 3.5, 4.5, max_points=5).ends
    ],
    "branch: undamped": lambda: columns(
        branch(UNDAMPED.replace(Omega="1.45"), "P32", "Omega", 1.45, 1.55)
    ),
    "branch: errors": lambda: errors_of(
        [
            lambda: branch(FIG9.replace(Omega=3), "P32", "Omega", 2, 4),
            lambda: branch(FIG9, "P32", "omega", 3, 5),
            lambda: branch(FIG9, "P32", "Omega", 5, 6),
            lambda: branch(FIG9, "P32", "Omega", 4, 4),
            lambda: branch(FIG9, "P32", "mu1", -1, 1),
            lambda: branch(FIG9, "P32", "Omega", 3, 5, max_points=1),
            lambda: continue_orbit(FIG9, "P32", "Omega", 5),  # type: ignore[arg-type]
            lambda: continue_border(graze_branch(), 0, "FN", (9, 11)),
            lambda: continue_border(graze_branch(), 2, "FN", (9, 11)),
            lambda: continue_border(graze_branch(), 1, "Omega", (4, 6)),
            lambda: continue_border(graze_branch(), 1, "FN", (11, 12)),
            lambda: continue_border(graze_branch(), 1, "FN", {"FN": (9, 11), "k": (1, 2)}),
            lambda: continue_border(graze_branch(), 1, "FN", (9, 11), step=0),
            lambda: continue_border(graze_branch(), 1, "FN", (9, 11), max_points=1),
            lambda: stick_border().at(c=1),
            lambda: stick_border().beside(0, 1),
            lambda: stick_border().orbit(99),
        ]
    ),
    "border: stick": lambda: of_border(stick_border()),
    "border: where it passes": where_it_passes,
    "border: at": lambda: [
        stick_border().at(Omega="1.5"),
        stick_border().at(FN="0.7"),
        stick_border().at(FN=1),
    ],
    "border: graze": lambda: of_border(
        continue_border(graze_branch(), 1, "FN", {"Omega": (4.9, 5.2), "FN": (9, 11)}, step="0.1")
    ),
    "border: no belt": lambda: of_border(
        continue_border(
            free_branch(), 0, "Omega", {"Omega": ("0.5", 2), "B0": (0.24, 6)}, step="0.05"
        )
    ),
    "border: no belt above": lambda: between(
        ABOVE, "B0", "0.95", "1.2", c=("0.4", "0.6"), B0=(0.24, 6)
    ),
    "border: rest": lambda: between(COULOMB, "FN", "0.9", "1.1", **PLANE),
    "border: between": lambda: between(
        COULOMB, "FN", "0.71", "0.89", FN=(0.7, 0.9), Omega=(0.85, 0.95)
    ),
}
