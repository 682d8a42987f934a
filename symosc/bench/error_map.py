"""Map of the errors of the flow's kernels in double precision over damping, drive and time, against
50 digits.

The flow from any start is linear in the start's data, with the entire functions E0, E1, E2, R2, I2
of `symosc.kernels.entire` as coefficients. The error of a time is the largest error of these
functions, each relative to the amplitude of its oscillation:

    E0: max(1, |E0|),   E1: |E1| + |E0| tau/(1 + w0 tau),   E2: |E2|,   R2 and I2: |R2| + |I2|

(a function that goes through 0 has no error relative to itself there). It is mapped over the
damping ratio zeta = c/(2 m w0) and over Omega/w0, with w0 = sqrt(k/m), for some w0 tau. There are
two maps: one of the cheap closed form, wherever it can be evaluated, and one of what symosc does.
That is the cheap form up to a border, and other forms beyond it.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import cos, exp, log10, nan, sin
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patheffects import withStroke

from symosc.base.aliases import Number, Record
from symosc.bench import Progress
from symosc.engine.arithmetic import mp_context
from symosc.engine.flow import Constants, constants
from symosc.kernels import entire
from symosc.kernels.multiprecision import BasisMP
from symosc.model import Parameters
from symosc.plot.drawing import STYLE

MAP_DIGITS = 50
TAUS = (1e-6, 1e-2, 1.0, 6.0)
#: Points per axis of the map, and of the finer grid on which the border is found.
MAP_POINTS = 57
QUICK_MAP_POINTS = 25
BORDER_POINTS = 229
# Values are spread by their distance from 1, down to this power of ten.
NEAREST = 10
#: From 10^low to 10^high.
RATIO_RANGE = (-2, 2)
ZETA_RANGE = (-10, 2)


def value_at(place: float) -> Fraction:
    """Return the number at a coordinate of an axis that spreads out numbers near 0, numbers near 1,
    and large ones.
    """
    # Up to NEAREST the place is log10(value/(1 - value)), from there on 2 NEAREST + log10(value -
    # 1); 1 is at NEAREST.
    if abs(place - NEAREST) < 1e-9:
        return Fraction(1)
    part = Fraction(repr(float(10.0 ** (place - 2 * NEAREST if place > NEAREST else -abs(place)))))
    if place > NEAREST:
        return 1 + part
    if place < 0:
        return part / (1 + part)
    return 1 / (1 + part)


def place_of(value: float, beyond: float = 0.0) -> float:
    """Return the coordinate, as `value_at` takes it, of the number `value` + `beyond`, which may be
    very close to 1.
    """
    below = (1.0 - value) - beyond
    if below == 0.0:
        return float(NEAREST)
    if below < 0.0:
        return 2 * NEAREST + log10(-below)
    return log10((value + beyond) / below)


def axis(low: int, high: int, points: int) -> np.ndarray:
    """Return coordinates, as `value_at` takes them, evenly from that of 10^low to that of 10^high,
    with that of 1.
    """
    first = place_of(10.0**low)
    last = place_of(10.0**high)
    before = round((points - 1) * (NEAREST - first) / (last - first))
    below = np.linspace(first, NEAREST, before + 1)
    above = np.linspace(NEAREST, last, points - before)
    return np.concatenate([below, above[1:]])


def scaled_parameters(zeta: Fraction, ratio: Fraction) -> Parameters:
    """Return parameters with m = k = 1 (so w0 = 1), damping ratio zeta and Omega/w0 = ratio,
    without friction.
    """
    return Parameters(m=1, c=2 * zeta, k=1, A0=0, B0=1, Omega=ratio, v1=0, v2=1, mu1=0, mu2=0, FN=0)


def run(quick: bool = False, progress: Progress = iter, taus: Sequence[float] = TAUS) -> Record:
    """Return errors of the flow in doubles over damping ratio and Omega/w0, for each w0 tau in
    `taus`: plain data.
    """
    # Keys: taus; zeta and ratio (places on the axes, see `value_at`); cheap and symosc: errors, a
    # matrix per tau, zeta in rows and Omega/w0 in columns, nan where the formula cannot be
    # evaluated or the time is longer than what symosc evaluates at once; formulas (matrices on the
    # finer grid border_zeta, border_ratio): "series", "apart" (the cheap closed form), "careful",
    # or "" for such a time; largest: the largest error of symosc, in the map.
    if quick:
        points = QUICK_MAP_POINTS
    else:
        points = MAP_POINTS
    zetas = axis(*ZETA_RANGE, points)
    ratios = axis(*RATIO_RANGE, points)
    shape = (len(taus), len(zetas), len(ratios))
    cheap = np.full(shape, nan)
    shipped = np.full(shape, nan)
    for i, zeta in progress(list(enumerate(zetas))):
        for j, ratio in enumerate(ratios):
            p = scaled_parameters(value_at(zeta), value_at(ratio))
            K = constants(p)
            exact = _exact(p)
            for n, tau in enumerate(taus):
                if tau > K.chunk:
                    continue
                truth = exact(tau)
                shipped[n, i, j] = error(entire.basis(tau, K), truth, tau)
                if K.under:
                    cheap[n, i, j] = error(closed_form(tau, K), truth, tau)
    fine_zetas = axis(*ZETA_RANGE, BORDER_POINTS)
    fine_ratios = axis(*RATIO_RANGE, BORDER_POINTS)
    exact_ratios = [value_at(each) for each in fine_ratios]
    rows = [
        [constants(scaled_parameters(value_at(zeta), each)) for each in exact_ratios]
        for zeta in fine_zetas
    ]
    return {
        "taus": list(taus),
        "zeta": zetas.tolist(),
        "ratio": ratios.tolist(),
        "cheap": cheap.tolist(),
        "symosc": shipped.tolist(),
        "border_zeta": fine_zetas.tolist(),
        "border_ratio": fine_ratios.tolist(),
        "formulas": [[[_formula(tau, K) for K in row] for row in rows] for tau in taus],
        "largest": float(np.nanmax(shipped)),
    }


def error(values: Sequence[float], exact: Sequence[Number], tau: float) -> float:
    """Return the largest error of the flow's five basis functions at `tau`, each relative to its
    amplitude there.
    """
    E0, E1, E2, R2, I2 = (abs(value) for value in exact[:5])
    sizes = (max(1, E0), E1 + E0 * tau / (1 + tau), E2, R2 + I2, R2 + I2)
    return max(float(abs(b - a) / size) for a, b, size in zip(values, exact, sizes, strict=False))


def closed_form(tau: float, K: Constants) -> tuple[float, ...]:
    """Return the flow's five basis functions at `tau` by the underdamped closed form, even where it
    is inaccurate.
    """
    angle = K.omega_d * tau
    drive = K.Om * tau
    waves = (sin(angle), cos(angle), sin(drive), cos(drive))
    values: tuple[float, ...] = entire.basis_apart(
        exp(-K.h * tau), *waves, K.h, K.omega_d, K.w0sq, K.Om, K.p, K.q
    )
    return values


# The kernel itself, with formulas that return their names: so the border on the map is the one that
# is shipped.
_NAMES = {"series": "series", "closed_form": "apart", "careful": "careful"}
_naming_basis = types.FunctionType(
    entire.basis_with_drive.__code__,
    vars(entire) | {formula: lambda *_, name=name: (name,) * 5 for formula, name in _NAMES.items()},
)


def _formula(tau: float, K: Constants) -> str:
    """Return the name of the formula by which symosc computes the basis functions at `tau`.

    "" if tau is too long.
    """
    if tau > K.chunk:
        return ""
    return str(_naming_basis(tau, 0.0, 1.0, K)[0])


def _exact(p: Parameters) -> Callable[[float], tuple[Number, ...]]:
    """Return a function from the time tau to the flow's five basis functions with 50 digits."""
    context = mp_context(MAP_DIGITS)

    def number(value: Fraction) -> Number:
        return context.mpf(value.numerator) / value.denominator

    K = constants(p, number, context.sqrt, context.atan2, +context.pi)
    basis = BasisMP(context, p)
    return lambda tau: basis(context.mpf(tau), K)


# -- the picture -----------------------------------------------------------------------------------

#: Range of the colours, as powers of ten.
COLOUR_RANGE = (-17, 0)
# Marks of both axes by their label, as `place_of` takes them: numbers next to 1 by their distance
# from it.
RATIO_TICKS: Record = {
    "0.01": (0.01,),
    r"$1{-}10^{-3}$": (1, -1e-3),
    r"$1{-}10^{-6}$": (1, -1e-6),
    "1": (1,),
}
RATIO_TICKS |= {r"$1{+}10^{-6}$": (1, 1e-6), r"$1{+}10^{-3}$": (1, 1e-3), "100": (100,)}
ZETA_TICKS: Record = {
    r"$10^{-9}$": (1e-9,),
    r"$10^{-6}$": (1e-6,),
    r"$10^{-3}$": (1e-3,),
    "0.5": (0.5,),
}
ZETA_TICKS |= {r"$1{-}10^{-5}$": (1, -1e-5), "1": (1,), r"$1{+}10^{-5}$": (1, 1e-5), "100": (100,)}
FORMULA_LABELS = {"apart": "cheap", "careful": "careful", "series": "series"}
OUTLINE = [withStroke(linewidth=2.0, foreground="black")]


def figure(result: Record) -> Figure:
    """Draw the errors of the cheap formula and of symosc, with the borders that symosc draws
    between its formulas.
    """
    taus = result["taus"]
    with rc_context(STYLE):
        drawing = Figure(figsize=(7.0, 4.9), layout=ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.04))
        grid = drawing.subplots(2, len(taus), sharex=True, sharey=True, squeeze=False)
        for row, (key, name) in enumerate(
            (("cheap", "the cheap formula everywhere"), ("symosc", "symosc"))
        ):
            for column, tau in enumerate(taus):
                ax = grid[row, column]
                errors = np.array(result[key][column])
                logs = np.log10(np.maximum(errors, 10.0 ** COLOUR_RANGE[0]))
                options = {"cmap": "viridis", "shading": "nearest", "rasterized": True}
                ax.set_facecolor("0.88")
                mesh = ax.pcolormesh(
                    result["ratio"], result["zeta"], logs, norm=Normalize(*COLOUR_RANGE), **options
                )
                _borders(ax, result, column, all_borders=key == "symosc")
                largest = float(np.nanmax(errors))
                ax.set_title(
                    rf"$\omega_0\tau = {_number(tau)}$: up to ${_number(largest)}$", fontsize=8.0
                )
                ax.tick_params(labelfontfamily="STIXGeneral", labelsize=7.0, direction="out")
            grid[row, 0].set_ylabel(rf"{name}" + "\n" + r"damping ratio $\zeta = c/(2m\omega_0)$")
        for ax, ticks in ((grid[0, 0].xaxis, RATIO_TICKS), (grid[0, 0].yaxis, ZETA_TICKS)):
            ax.set_ticks([place_of(*each) for each in ticks.values()], list(ticks))
        for ax in grid[1]:
            ax.tick_params(axis="x", labelrotation=90)
            ax.set_xlabel(r"$\Omega/\omega_0$")
        bar = drawing.colorbar(mesh, ax=grid, pad=0.01, aspect=40, extend="max")
        bar.set_label(
            r"$\log_{10}$ of the error of the flow (its worst entire function, against 50 digits)"
        )
        bar.ax.tick_params(labelfontfamily="STIXGeneral")
        return drawing


def _borders(ax: Axes, result: Record, column: int, all_borders: bool) -> None:
    """Draw the border of the cheap formula at the time number `column`; if `all_borders`, all
    borders, with names.
    """
    from scipy.ndimage import label

    chosen = np.array(result["formulas"][column])
    ratios = np.array(result["border_ratio"])
    zetas = np.array(result["border_zeta"])
    for formula in (
        ("apart", "careful") if all_borders else ("apart",)
    ):  # two borders between three formulas
        inside = np.where(chosen == "", nan, chosen == formula)
        if np.nanmin(inside) < np.nanmax(inside):
            border = ax.contour(ratios, zetas, inside, [0.5], colors="white", linewidths=1.0)
            border.set_path_effects([*OUTLINE])
    for formula, name in FORMULA_LABELS.items() if all_borders else ():
        parts, count = label(chosen == formula)
        for part in range(1, count + 1):
            _label(ax, ratios, zetas, parts == part, name)
    _label(
        ax,
        ratios,
        zetas,
        chosen == "",
        "longer than one period",
        color="0.25",
        rotation=90,
        path_effects=None,
    )
    if not all_borders:
        over = np.broadcast_to(zetas[:, np.newaxis] > NEAREST, chosen.shape) & (chosen != "")
        _label(
            ax, ratios, zetas, over, "overdamped:\nno such formula", color="0.25", path_effects=None
        )


def _label(
    ax: Axes, ratios: np.ndarray, zetas: np.ndarray, inside: np.ndarray, name: str, **style: Any
) -> None:
    """Write `name` into a plot where the region in which `inside` is true is widest, if there is
    enough room.
    """
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
    if depth.max() < 0.05 * len(ratios):
        return
    i, j = (round(float(np.mean(index))) for index in np.nonzero(depth > depth.max() - 1))
    options: Record = {"ha": "center", "va": "center", "fontsize": 7.5, "linespacing": 1.0}
    options |= {"color": "white", "path_effects": OUTLINE}
    ax.text(ratios[j], zetas[i], name, **(options | style))


def _number(value: float) -> str:
    """Return a positive number as math text: a whole number from 1 to 100, else one digit times a
    power of ten.
    """
    if 0.95 <= value < 100:
        return f"{value:.0f}"
    mantissa, exponent = f"{value:.0e}".split("e")
    if mantissa == "1":
        return f"10^{{{int(exponent)}}}"
    return rf"{mantissa}{{\times}}10^{{{int(exponent)}}}"
