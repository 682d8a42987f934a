"""The paper's figures, as printed and corrected, and its Theorem 7: how each is built, and its texts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from matplotlib.figure import Figure

from symosc.mappings.theorem7_cases import place
from symosc.paper import captions, drawings, oscillator
from symosc.paper.paper_figures import (
    grazing_figure_P2,
    grazing_figure_P3,
    motion_figure,
    orbit_figure,
    product_figure,
    stick_figure,
)
from symosc.paper.window_figures import WINDOW_SCENES, window_caption, window_sweep


@dataclass(frozen=True)
class Picture:
    """A figure of the report.

    Attributes
    ----------
    key : str
        Its name in PICTURES and in file names.
    title, alt : str
        Heading, and one sentence for readers who do not see the figure.
    paper_figure : int or None
        The number of the paper's figure that it reproduces; None for our own.
    build : callable
        Draws it; can be pickled.
    describe : callable
        Returns the caption, with the numbers computed.
    narrow : callable, optional
        Draws it for the screen of a phone, its panels above each other.
    """

    key: str
    title: str
    alt: str
    paper_figure: int | None
    build: Callable[[], Figure]
    describe: Callable[[], str]
    narrow: Callable[[], Figure] | None = None

    @property
    def caption(self) -> str:
        """What the figure shows, without the paper at hand."""
        return self.describe()


def _drawn(build: Callable[[], Figure], describe: Callable[[], str], number: int, title: str, alt: str) -> Picture:
    return Picture(f"fig{number}", f"Fig. {number}: {title}", alt, number, build, describe)


def _computed(form: tuple[Callable[..., Figure], Callable[[str], str]], scene: str, title: str, alt: str) -> Picture:
    build, describe = form
    number, _, form_of = scene.removeprefix("fig").partition("-")
    heading = f"Fig. {number}{FORMS[form_of]}: {title}"
    return Picture(
        scene,
        heading,
        alt,
        None if form_of else int(number),
        partial(build, scene),
        partial(describe, scene),
        partial(build, scene, columns=1),
    )


def _window(mapping: str) -> Picture:
    where = place(mapping)
    return Picture(
        f"theorem7-{mapping.lower()}",
        f"Theorem 7, eq. ({where.equation}): when {mapping} grazes",
        f"The phases at which {mapping} grazes, against the belt's speed, lie between the two branches of an arcsine.",
        None,
        partial(window_sweep, mapping),
        partial(window_caption, mapping),
    )


# What scenes of a figure are called: as printed, with a number corrected, with a start of many digits, on the orbit.
FORMS = {"": "", "corrected": ", corrected", "exact": ", exact start", "orbit": ", corrected"}
# What draws and what describes each form of figure.
STICK_PICTURE = stick_figure, captions.stick_caption
GRAZING_P2 = grazing_figure_P2, captions.grazing_P2_caption
GRAZING_P3 = grazing_figure_P3, captions.grazing_P3_caption
MOTION = motion_figure, captions.motion_caption
ORBIT = orbit_figure, captions.orbit_caption

_ALL = (
    _drawn(
        oscillator.fig1,
        captions.model_caption,
        1,
        title="physical model",
        alt="A block on a spring and a damper is pressed between two belts that move at different speeds.",
    ),
    _drawn(
        drawings.fig2,
        captions.friction_caption,
        2,
        title="friction force",
        alt="The friction force is a staircase of three levels with a vertical jump at each belt speed.",
    ),
    _drawn(
        drawings.fig3,
        captions.domains_caption,
        3,
        title="domains and boundaries",
        alt="Two horizontal lines at the belt speeds cut the phase plane into three strips.",
    ),
    _drawn(
        drawings.fig4,
        captions.mappings_caption,
        4,
        title="basic mappings",
        alt="Arcs in the strips of the phase plane and pieces of the boundaries, labelled P1 to P8.",
    ),
    _computed(
        STICK_PICTURE,
        "fig5",
        title="stick on belt 1",
        alt="The mass starts at rest, sticks to belt 1 three times and slips off it in between.",
    ),
    _computed(
        STICK_PICTURE,
        "fig6",
        title="stick on belt 2",
        alt="The mass sticks to belt 2 from the start, slips, slows down between the belts and sticks to belt 1.",
    ),
    _computed(
        GRAZING_P2,
        "fig7",
        title="grazing of P2",
        alt="With the printed parameters the velocity of the mass stays below both belts.",
    ),
    _computed(
        GRAZING_P2,
        "fig7-corrected",
        title="with A0 = 10",
        alt="The velocity rises to belt 1, where an inset shows a very short stick, and stays below it from then on.",
    ),
    _computed(
        GRAZING_P2,
        "fig7-exact",
        title="the graze, with A0 = 10",
        alt="The velocity touches belt 1 from below in one point and stays below it from then on.",
    ),
    _computed(
        GRAZING_P3,
        "fig8",
        title="grazing of P3, then a stick",
        alt="The velocity falls to belt 1, where an inset shows a very short stick, swings up and falls to it again.",
    ),
    _computed(
        GRAZING_P3,
        "fig8-exact",
        title="the graze, then a stick",
        alt="The velocity touches belt 1 from above in one point, swings up and falls to it again, where it sticks.",
    ),
    _computed(
        MOTION,
        "fig9",
        title="non-stick periodic motion P32",
        alt="The mass passes belt 1 upward and downward; its phase curve starts outside of the loop that it joins.",
    ),
    _computed(
        ORBIT,
        "fig9-orbit",
        title="the periodic orbit P32",
        alt="The orbit is a closed loop through belt 1; the printed start lies outside of it.",
    ),
    _computed(
        MOTION,
        "fig10",
        title="stick periodic motion P4645",
        alt="The mass sticks to belt 2 twice in each period, between a swing below and a swing above it.",
    ),
    _computed(
        ORBIT,
        "fig10-orbit",
        title="the periodic orbit P4645",
        alt="The orbit is a closed loop with two straight pieces on belt 2; the printed start lies close to it.",
    ),
    Picture(
        "force-product",
        "Section 6: product of the forces",
        "Four curves of products, positive where the mass passes a belt and negative while it sticks to one.",
        None,
        product_figure,
        captions.product_caption,
        partial(product_figure, columns=1),
    ),
    *map(_window, WINDOW_SCENES),
)

#: Every picture by its key: the paper's figures in its order, then Theorem 7.
PICTURES: dict[str, Picture] = {picture.key: picture for picture in _ALL}
