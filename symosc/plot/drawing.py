"""Common parts of all figures: style, a figure class for notebooks, axes given by the user, and files.

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
from matplotlib.spines import Spine
from matplotlib.text import Text
from matplotlib.ticker import ScalarFormatter
from matplotlib.transforms import Bbox
from numpy import isfinite

from symosc.aliases import Record
from symosc.arguments import public
from symosc.errors import OutputError, ParameterError
from symosc.files import STDOUT, read_path, write_whole

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

PARAMETER_LABELS = {"A0": "$A_0$", "B0": "$B_0$", "Omega": r"$\Omega$", "FN": "$F_N$"} | {
    f"{letter}{number}": rf"${symbol}_{number}$" for letter, symbol in (("v", "v"), ("mu", r"\mu")) for number in (1, 2)
}

# Pixels per inch of a figure in a notebook.
NOTEBOOK_DPI = 120.0


class PlainNumbers(ScalarFormatter):
    """A tick formatter with plain text: mathtext takes ten times as long and looks the same."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the number at a tick; the power of ten of an axis is still mathtext."""
        text = super().__call__(x, pos)
        return text.removeprefix(r"$\mathdefault{").removesuffix("}$").replace("-", "\N{MINUS SIGN}")


def use_plain_tick_labels(axes: Iterable[Axes]) -> None:
    """Set plain-text tick labels on axes and their inset axes, in place of mathtext."""
    for each in axes:
        for axis in (each.xaxis, each.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter and axis.isDefault_majfmt:
                axis.set_major_formatter(PlainNumbers())
        use_plain_tick_labels(child for child in each.child_axes if isinstance(child, Axes))


class PanelAxes(Axes):
    """Axes with ticks inside, so that only labels, names and marks extend beyond them.

    matplotlib lays a figure out twice, as axes of another size may have other ticks, and asks each axis for its labels
    some nine times: more than half of the time that a figure takes. Here it is asked once, and again only if its ticks
    are others.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        #: For each axis its ticks, and how far its labels stood out of the axes on each side, in pixels.
        self.labels_of: dict[Any, tuple[tuple[float, ...], tuple[float, ...]]] = {}
        super().__init__(*args, **options)

    def get_tightbbox(self, renderer: Any = None, **options: Any) -> Bbox | None:
        """Return the box of the axes with everything that extends beyond them."""
        ours = options.get("for_layout_only") and renderer and options.get("bbox_extra_artists") is None
        if not ours or not self.get_visible() or self.yaxis.get_offset_text().get_text():  # titles give way to it
            return super().get_tightbbox(renderer, **options)
        inside = self.get_default_bbox_extra_artists()
        titles = [each for each in self.get_children() if isinstance(each, Text) and each not in inside]
        boxes: list[Any] = [self.get_window_extent(renderer)]
        boxes += [self._with_labels(axis, renderer) for axis in (self.xaxis, self.yaxis)]
        boxes += [each.get_tightbbox(renderer) for each in inside if not isinstance(each, Spine)]
        for box in (title.get_window_extent(renderer) for title in titles):
            middle = (box.x0 + box.x1) / 2  # margins at the side do not depend on a title's text
            boxes.append(Bbox.from_extents(middle - 0.5, box.y0, middle + 0.5, box.y1) if box.width else box)
        return Bbox.union([box for box in boxes if box is not None and isfinite(box.extents).all()])

    def _with_labels(self, axis: Any, renderer: Any) -> Bbox:
        """Return the box of these axes with the labels of one axis."""
        inner: Any = self.bbox.extents
        ticks = (*axis.get_view_interval(), *axis.get_majorticklocs())
        if axis not in self.labels_of or self.labels_of[axis][0] != ticks:
            labels = axis.get_tightbbox(renderer, for_layout_only=True)
            sides = (0.0,) * 4 if labels is None else tuple(Bbox.union([self.bbox, labels]).extents - inner)
            self.labels_of[axis] = ticks, sides
        return Bbox.from_extents(*(inner + self.labels_of[axis][1]))


class Drawing(Figure):
    """A matplotlib Figure that notebooks display."""

    def draw(self, renderer: Any) -> None:
        """Draw the figure; saving draws twice, the first time only for the layout."""
        use_plain_tick_labels(self.axes)
        for each in self.axes:
            if isinstance(each, PanelAxes):
                each.labels_of.clear()  # something may have changed since the figure was laid out
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
    """Return the style of new figures; axes given by the user keep their style."""
    return rc_context(STYLE) if ax is None else nullcontext()


def one_axes(ax: Any, size: tuple[float, float]) -> tuple[Figure, Axes]:
    """Return the axes given by the user with their figure, or new axes in a new figure."""
    if ax is None:
        drawing = Drawing(figsize=size, layout="constrained")
        return drawing, drawing.subplots()
    return figure_of(ax), ax


def figure_of(ax: Any) -> Figure:
    """Return the figure of axes given by the user; raise ParameterError for any other object."""
    if not isinstance(ax, Axes) or ax.figure is None:
        raise ParameterError("ax", type(ax).__name__, "must be axes of matplotlib, such as plt.subplots() makes")
    return ax.figure  # type: ignore[return-value]


def legend_entries(axes: Iterable[Axes]) -> Record:
    """Return handles and labels of a legend for several axes, each label once."""
    entries: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(str(label), handle)
    return {"handles": list(entries.values()), "labels": list(entries)}


def read_panels(panels: Any, known: Sequence[str], ax: Any = None, alone: str = "a") -> str:
    """Return the letters of the panels; None means all, or the panel `alone` for axes given by the user.

    ParameterError unless they are different known letters; with `ax`, which must be axes, it must be one.
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
    """Write a figure as PDF, SVG or PNG, by its suffix, atomically; ``"-"``: SVG to standard output.

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
