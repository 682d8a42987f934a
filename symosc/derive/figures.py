"""The figures of the derivations.

Greyscale is enough to read them: shapes, hatching and line styles differ.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from symosc.model import by_name
from symosc.scenes import load_scene
from symosc.simulation.simulate import simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DARK = "black"
GREY = "0.45"
LIGHT = "0.82"
POINT: dict[str, Any] = {"marker": "o", "color": "white", "markeredgecolor": DARK, "linestyle": ""}
#: Size of all text, in points; no figure is printed smaller than it is drawn.
FONT_SIZE = 10.0


def friction(axes: Axes) -> None:
    """Draw the friction of both belts against the velocity, set-valued at the belts' speeds."""
    v1 = 1.0
    v2 = 3.0
    mu1 = 1.0
    mu2 = 0.55
    # Below v1, between the belts' speeds, and above v2.
    low, middle, high = levels = mu1 + mu2, mu2 - mu1, -mu1 - mu2
    for ends, level in zip(((-1, v1), (v1, v2), (v2, 5)), levels, strict=True):
        axes.plot(ends, [level] * 2, color=DARK, linewidth=1.6)
    for speed, jump in ((v1, (low, middle)), (v2, (middle, high))):
        axes.plot([speed] * 2, jump, color=DARK, linewidth=3.2, solid_capstyle="butt")
        axes.axvline(speed, color=GREY, linewidth=0.5, linestyle=":")
    axes.axhline(0, color=GREY, linewidth=0.5)
    axes.set_xticks([v1, v2], ["$v_1$", "$v_2$"])
    axes.set_yticks(levels, [r"$(\mu_1+\mu_2)F_N$", r"$-(\mu_1-\mu_2)F_N$", r"$-(\mu_1+\mu_2)F_N$"])
    for x, name in ((0, r"$\Omega_1$"), (2, r"$\Omega_2$"), (4, r"$\Omega_3$")):
        axes.text(x, 0.12, name, ha="center")
    axes.set(xlabel=r"$\dot{x}$", xlim=(-1, 5), ylim=(-1.9, 1.9), ylabel=r"friction $T_1 + T_2$")


def stick_exits(axes: Axes) -> None:
    """Draw the accelerations on both sides of belt 2 during the stick of the paper's Fig. 6."""
    scene = load_scene("fig6")
    until = next(event.t for event in simulate(scene).events if event.kind == "slip")
    p = by_name(scene.parameters, float)
    t = np.linspace(0, 1.25 * until, 200)
    x = float(scene.x0) + p["v2"] * t
    without_friction = (
        p["A0"] + p["B0"] * np.cos(p["Omega"] * t) - p["k"] * x - p["c"] * p["v2"]
    ) / p["m"]
    below = without_friction + (p["mu2"] - p["mu1"]) * p["FN"] / p["m"]
    above = without_friction - (p["mu1"] + p["mu2"]) * p["FN"] / p["m"]
    axes.axvspan(0, until, color=LIGHT, linewidth=0)
    axes.plot(t, below, color=DARK, label=r"$F^{(2)}$, below the belt's speed")
    axes.plot(t, above, color=DARK, linestyle="--", label=r"$F^{(3)}$, above it")
    axes.axhline(0, color=GREY, linewidth=0.6)
    axes.plot([until], [0], label="the stick ends", **POINT)
    axes.set(xlabel="$t$", xlim=(0, t[-1]), ylabel="acceleration")


def windows(axes: Axes) -> None:
    """Draw where sin theta lies above and below its critical value: Theorem 7's windows for one
    gamma of each kind.
    """
    theta = np.linspace(0, 2 * np.pi, 721)
    sine = np.sin(theta)
    critical_sine = -0.5  # -gamma/a
    critical = np.arcsin(critical_sine)
    axes.plot(theta, sine, color=DARK, label=r"$\sin\theta$")
    axes.axhline(
        critical_sine,
        color=GREY,
        linewidth=0.8,
        linestyle="--",
        label=r"$-\gamma/a = \sin\Theta^{\mathrm{cr}}$",
    )
    above = sine > critical_sine
    below = sine < critical_sine
    axes.fill_between(
        theta, critical_sine, sine, where=above, color=LIGHT, label="$P_2$, $P_5$ graze"
    )
    hatched: dict[str, Any] = {"facecolor": "white", "edgecolor": GREY, "hatch": "////"}
    axes.fill_between(
        theta, critical_sine, sine, where=below, label="$P_3$, $P_6$ graze", **hatched
    )
    names = [
        "0",
        r"$\pi/2$",
        r"$\pi$",
        r"$\pi-\Theta^{\mathrm{cr}}$",
        r"$2\pi+\Theta^{\mathrm{cr}}$",
        r"$2\pi$",
    ]
    axes.set_xticks([0, np.pi / 2, np.pi, np.pi - critical, 2 * np.pi + critical, 2 * np.pi], names)
    axes.plot([np.pi - critical, 2 * np.pi + critical], [critical_sine] * 2, **POINT)
    axes.set(xlabel=r"$\theta$", xlim=(0, 2 * np.pi), ylim=(-1.15, 1.15), yticks=[-1, 0, 1])


def quartic(axes: Axes) -> None:
    """Draw the gap near a contact: a graze, an inflection, and the tangency of fourth order."""
    tau = np.linspace(-1, 1, 201)
    axes.plot(tau, -(tau**2), color=DARK, label=r"$n = 1$: graze")
    axes.plot(tau, -(tau**3), color=GREY, linestyle="--", label=r"$n = 2$: the flow passes")
    axes.plot(tau, -(tau**4), color=DARK, linestyle="-.", label=r"$n = 3$: graze of fourth order")
    axes.axhline(0, color=GREY, linewidth=0.6)
    axes.set(
        xlabel=r"$\tau$", ylabel=r"$\dot{x} - v_\lambda$", xlim=(-1, 1), xticks=[0], yticks=[0]
    )


#: Key -> what draws it, and its size in inches.
FIGURES: dict[str, tuple[Callable[[Axes], None], tuple[float, float]]] = {
    "friction": (friction, (4.6, 2.3)),
    "stick-exits": (stick_exits, (4.6, 2.3)),
    "windows": (windows, (5.4, 2.4)),
    "quartic": (quartic, (4.6, 2.2)),
}


@cache
def figure(key: str) -> Figure:
    """Return the figure with a key of `FIGURES`, in the style of `symosc.plot`."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    from symosc.plot.drawing import STYLE

    sized = ("font.size", "axes.labelsize", "xtick.labelsize", "ytick.labelsize", "legend.fontsize")
    draw, size = FIGURES[key]
    with rc_context(STYLE | dict.fromkeys(sized, FONT_SIZE)):
        drawing = Figure(figsize=size, layout="constrained")
        draw(drawing.subplots())
        if key != "friction":
            drawing.legend(loc="outside right center", frameon=False)
    return drawing


def svg(key: str) -> str:
    """Return the figure with a key of `FIGURES` as the text of an SVG file."""
    from symosc.plot import save

    with TemporaryDirectory() as folder:
        return save(figure(key), Path(folder) / "figure.svg").read_text(encoding="utf-8")
