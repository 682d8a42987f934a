"""What all figures share: their style, a figure that notebooks show, axes of a user's own, and files.

A figure is built without pyplot, so that nothing global changes and nothing stays open.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import ScalarFormatter

from symosc.arguments import public
from symosc.errors import OutputError, ParameterError
from symosc.files import STDOUT, read_path, write_whole
from symosc.plot.panel_axes import PanelAxes

FIGURE_SUFFIXES = (".pdf", ".svg", ".png")

STYLE: dict[Any, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "axes.linewidth": 0.6,
    "axes.formatter.use_mathtext": True,
    "axes.unicode_minus": False,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.fontsize": 8.0,
    "lines.solid_capstyle": "round",
    "savefig.dpi": 200.0,
    "figure.dpi": 100.0,
    "pdf.fonttype": 42,  # TrueType: text stays text
    "svg.fonttype": "path",  # drawn letters: the same on machines without these fonts
    "svg.hashsalt": "symosc",  # the same figure gives the same file
}

# Pixels per inch of a figure in a notebook.
NOTEBOOK_DPI = 120.0


class PlainNumbers(ScalarFormatter):
    """Numbers at ticks as plain text: mathtext takes ten times as long to set them, and they look the same."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the number at a tick; the power of ten of an axis is still mathtext."""
        text = super().__call__(x, pos)
        return text.removeprefix(r"$\mathdefault{").removesuffix("}$").replace("-", "\N{MINUS SIGN}")


def plain_numbers(axes: Iterable[Axes]) -> None:
    """Let axes, and those inside them, have plain numbers where they have mathtext by default."""
    for each in axes:
        for axis in (each.xaxis, each.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter and axis.isDefault_majfmt:
                axis.set_major_formatter(PlainNumbers())
        plain_numbers(child for child in each.child_axes if isinstance(child, Axes))


class Drawing(Figure):
    """A figure that a notebook shows by itself; everything else is as for any matplotlib Figure."""

    def draw(self, renderer: Any) -> None:
        """Draw it; what saves a figure asks for that twice, and the first time only the layout counts."""
        plain_numbers(self.axes)
        for each in self.axes:
            if isinstance(each, PanelAxes):
                each.forget_labels()
        layout = self.get_layout_engine()
        if isinstance(layout, ConstrainedLayoutEngine) and self.canvas.is_saving():
            layout.execute(self)
        else:
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        """Return the figure as a notebook shows it."""
        picture = BytesIO()
        with rc_context(STYLE):
            self.savefig(picture, format="png", dpi=NOTEBOOK_DPI)
        return picture.getvalue()


def style_for(ax: Axes | None) -> AbstractContextManager[None]:
    """Return the style of new figures; axes of a user's own keep theirs."""
    return rc_context(STYLE) if ax is None else nullcontext()


def one_axes(ax: Any, size: tuple[float, float]) -> tuple[Figure, Axes]:
    """Return the axes that a user gave with their figure, or new ones in a figure of their own.

    Raises
    ------
    ParameterError
        If `ax` is neither None nor matplotlib's Axes.
    """
    if ax is None:
        drawing = Drawing(figsize=size, layout="constrained")
        return drawing, drawing.subplots()
    return figure_of(ax), ax


def figure_of(ax: Any) -> Figure:
    """Return the figure that holds axes of a user's own; raises ParameterError if these are none."""
    if not isinstance(ax, Axes) or ax.figure is None:
        raise ParameterError("ax", type(ax).__name__, "must be axes of matplotlib, such as plt.subplots() makes")
    return ax.figure  # type: ignore[return-value]


def read_panels(panels: Any, known: Sequence[str], ax: Any = None, alone: str = "a") -> str:
    """Return the letters of panels; None is all of them, with `ax` the one that stands for all `alone`.

    Raises
    ------
    ParameterError
        Unless they are different known letters; with `ax`, which must be axes, it must be one.
    """
    letters = "".join(known)
    if panels is None:
        panels = letters if ax is None else alone
    if not (panels and not set(panels) - set(known) and len(set(panels)) == len(panels)):
        raise ParameterError("panels", panels, f"must be different letters out of {letters}")
    if ax is not None:
        figure_of(ax)
    if ax is not None and len(panels) > 1:
        raise ParameterError("panels", panels, f"axes hold one panel: give ax= with one letter out of {letters}")
    return panels


@public
def check_suffix(path: str | Path) -> None:
    """Raise OutputError unless figures can be written to a file of that name.

    Examples
    --------
    >>> from symosc import plot
    >>> plot.check_suffix("motion.gif")
    Traceback (most recent call last):
        ...
    symosc.errors.OutputError: cannot write motion.gif: a figure's name must end in .pdf, .svg or .png
    """
    _suffix(path)


def _suffix(path: str | Path) -> str:
    """Return the suffix of a figure's file; standard output gets SVG."""
    name = read_path(path)
    suffix = ".svg" if name == STDOUT else Path(name).suffix.lower()
    if suffix not in FIGURE_SUFFIXES:
        raise OutputError(
            name, f"a figure's name must end in {', '.join(FIGURE_SUFFIXES[:-1])} or {FIGURE_SUFFIXES[-1]}"
        )
    return suffix


@public
def save(drawing: Figure, path: str | Path) -> Path:
    """Write a figure as PDF, SVG or PNG, as the suffix says, whole or not at all; ``"-"``: SVG to standard output.

    Raises
    ------
    ParameterError
        If `drawing` is no figure or `path` no file name.
    OutputError
        If the suffix is another one or the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from symosc import plot
    >>> with TemporaryDirectory() as folder:
    ...     plot.save(plot.figure("fig5", panels="a"), f"{folder}/motion.svg").name
    'motion.svg'
    """
    suffix = _suffix(path)
    kind = suffix.removeprefix(".")
    # No date in the file: drawing it again gives the same bytes.
    metadata = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": None}[kind]

    def write(draft: Path) -> None:
        with rc_context(STYLE):
            drawing.savefig(draft, format=kind, metadata=metadata)

    return write_whole(path, write, suffix)
