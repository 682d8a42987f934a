"""Common parts of all figures: style, a figure class for notebooks, axes given by the user, and
files.

A figure is built without pyplot, so that nothing global changes and nothing stays open.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from inspect import signature
from io import BytesIO
from pathlib import Path
from string import ascii_lowercase
from typing import Any, TypeAlias

from matplotlib import rc_context, rcParams, rcParamsDefault
from matplotlib.artist import ArtistInspector
from matplotlib.axes import Axes
from matplotlib.cbook import normalize_kwargs
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from symosc.base.aliases import NumberLike, Record
from symosc.base.arguments import FILE, NUMBER, TEXT, Kind, public, require, require_or_none, row_of
from symosc.base.display.latex import latex_text
from symosc.base.errors import OutputError, ParameterError, brief, meant
from symosc.base.exact import read_exact
from symosc.base.files import STDOUT, read_path, write_whole
from symosc.base.quantities import QUANTITIES

STYLE: dict[Any, Any] = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "axes.linewidth": 0.6,
    "axes.formatter.use_mathtext": False,  # mathtext takes ten times as long at ticks
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

#: Width and height of a figure in inches; None: the usual ones.
FigureSize: TypeAlias = "tuple[NumberLike, NumberLike] | None"
#: The least and the greatest width and height of a figure, in inches.
SIZES = (0.5, 200.0)
#: Letters of parameters and of the numbers of a start, for axes.
FIGURE = Kind("a figure, such as plot.figure(...) returns", lambda kind: issubclass(kind, Figure))
PARAMETER_LABELS = {name: f"${quantity.letter}$" for name, quantity in QUANTITIES.items()}


class Drawing(Figure):
    """A matplotlib Figure that notebooks display."""

    def draw(self, renderer: Any) -> None:
        """Draw the figure; in the first of the two passes that saving makes, only compute the
        layout.
        """
        layout = self.get_layout_engine()
        if isinstance(layout, ConstrainedLayoutEngine) and self.canvas.is_saving():
            layout.execute(self)
        else:
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        """Return the figure as the bytes of a PNG picture, which notebooks show."""
        picture = BytesIO()
        with own_style():
            self.savefig(picture, format="png", dpi=120.0)
        return picture.getvalue()


@contextmanager
def own_style() -> Iterator[None]:
    """Apply STYLE to figures made in a `with` block, except for settings that the user has changed
    in rcParams.
    """
    with rc_context(
        {name: value for name, value in STYLE.items() if rcParams[name] == rcParamsDefault[name]}
    ):
        yield


def read_size(
    figsize: FigureSize, ax: Axes | None, usual: tuple[float, float]
) -> tuple[float, float]:
    """Return the size of a figure in inches: `figsize`, or if that is None the `usual` one.

    ParameterError unless `figsize` is a width and a height, without axes given by the user.
    """
    if figsize is None:
        return usual
    require(row_of(2, NUMBER), figsize=figsize)
    if ax is not None:
        raise ParameterError(
            "figsize", figsize, "must be omitted with ax=, whose figure has a size"
        )
    width, height = (float(read_exact("figsize", side)) for side in figsize)
    low, high = SIZES
    if not (low <= width <= high and low <= height <= high):
        allowed = f"must be width and height in inches, each from {low:g} to {high:g}"
        raise ParameterError("figsize", figsize, allowed)
    return width, height


@contextmanager
def axes_for(
    ax: Axes | None,
    size: tuple[float, float],
    count: int = 1,
    *,
    figsize: FigureSize = None,
    columns: int | None = None,
    letter_at: float | None = None,
) -> Iterator[tuple[Figure, Any]]:
    """Yield a figure and a list of its axes: new ones in the style of symosc or, if `ax` is given,
    its figure and `ax`.

    `size` in inches, which a `figsize` of the user replaces, `count`, `columns` and `letter_at` are
    for a new figure. It has `count` axes:
    in one row, or in `columns` with one common horizontal axis below. If they are several, letters
    (a), (b) ... stand above them at the horizontal place `letter_at`, unless it is None.
    """
    size = read_size(figsize, ax, size)
    if ax is not None:
        yield figure_of(ax), [ax]
        return
    if columns is None:
        across = count
    else:
        across = columns
    with own_style():
        drawing = Drawing(figsize=size, layout="constrained")
        rows = -(-count // across)  # rounded up
        grid = drawing.subplots(rows, across, sharex=columns is not None, squeeze=False).ravel()
        axes = grid[:count]
        for unused in grid[count:]:
            unused.remove()
        for panel, letter in zip(axes, ascii_lowercase, strict=False):
            if letter_at is not None and count > 1:
                panel.set_title(f"({letter})", loc="left", x=letter_at, pad=4)
            panel.tick_params(labelfontfamily=rcParams["font.family"][0])
        for panel in axes[-across:]:  # the lowest in each column
            panel.tick_params(labelbottom=True)
        yield drawing, axes


@contextmanager
def panels_for(
    answer: Any,
    draw: Mapping[str, Callable[[Axes, Any], None]],
    panels: str | None,
    ax: Axes | None,
    size: tuple[float, float],
    *,
    figsize: FigureSize = None,
    alone: str = "a",
    more: float = 0.0,
    columns: int | None = None,
    letter_at: float | None = None,
) -> Iterator[tuple[Figure, Any]]:
    """Make axes for the panels, draw each by ``draw[letter](axes, answer)``, and yield the figure
    and its axes.

    In the `with` block the panels are already drawn, so that only common parts are left to add:
    labels below the last one, a legend.

    `answer` is the result to draw. `panels` has the letters; None means all or, if the user gives
    `ax`, only the panel `alone`. A panel has this `size` in inches; `more` inches are added to the
    height of the figure. A `figsize` of the user is that of the whole figure.
    """
    letters = read_panels(panels, draw, ax, alone)
    if columns is None:
        across = len(letters)
    else:
        across = min(columns, len(letters))
    width, height = size
    rows = -(-len(letters) // across)  # rounded up
    figure_size = width * across, more + height * rows
    layout: Record = {"columns": None if columns is None else across, "letter_at": letter_at}
    layout["figsize"] = figsize
    with axes_for(ax, figure_size, len(letters), **layout) as (drawing, axes):
        for panel, letter in zip(axes, letters, strict=True):
            draw[letter](panel, answer)
        yield drawing, axes


def shown_name(name: str) -> str:
    """Return a name that a user chose for a figure.

    No part of it is a formula, or a command of TeX.
    """
    if rcParams["text.usetex"]:
        letters = re.sub(r"\\letter\{\d+\}", r"\\symbol{92}", latex_text(name))
        return rf"\texttt{{{letters}}}"
    return brief(name).replace("$", r"\$")


def typeset(word: str) -> str:
    """Return a word such as P32 as LaTeX in the paper's notation, "no event" if empty.

    Other text is shown as it is.
    """
    if not word:
        return "no event"
    if word[0] == "P" and word[1:].isdigit():
        return f"$P_{{{word[1:]}}}$"
    return shown_name(word)


def read_style(style: Any, figure: Callable[..., object]) -> Record:
    """Return options of a line by their long names, such as linewidth for lw.

    ParameterError for unknown ones; it suggests arguments of the function `figure` too.
    """
    try:
        options = normalize_kwargs(style, Line2D)
    except TypeError as error:
        raise ParameterError(" ".join(style), style, f"must be given only once: {error}") from None
    for name, value in options.items():
        try:
            Line2D([], []).set(**{name: value})  # matplotlib's own check
        except AttributeError:
            known = [*signature(figure).parameters, *ArtistInspector(Line2D).get_setters()]
            allowed = (
                "unknown argument; pass one of this figure, or a property of matplotlib's "
                f"lines{meant(name, known)}"
            )
            raise ParameterError(name, value, allowed) from None
        except (TypeError, ValueError) as error:
            raise ParameterError(
                name, value, f"must be a style of matplotlib for lines: {error}"
            ) from None
    return options


def figure_of(ax: object) -> Figure:
    """Return the figure of axes given by the user; raise ParameterError for any other object."""
    if not isinstance(ax, Axes) or ax.figure is None:
        raise ParameterError(
            "ax", type(ax).__name__, "must be axes of matplotlib, such as plt.subplots() makes"
        )
    return ax.figure  # type: ignore[return-value]


def write_above(ax: Axes, x: float, text: str, up: float = 4.0) -> None:
    """Write a text above axes, `up` points over them, with its middle at x."""
    style: Record = {
        "xycoords": ("data", "axes fraction"),
        "textcoords": "offset points",
        "fontsize": 8,
    }
    ax.annotate(text, (x, 1), (0, up), ha="center", **style)


def draw_belts(ax: Axes, speeds: Iterable[Any], low: float, high: float) -> None:
    """Draw dashed lines, with names on the right, at those belt speeds that lie between `low` and
    `high`.
    """
    for belt, speed in enumerate(map(float, speeds), 1):
        if low < speed < high:
            ax.axhline(speed, color="black", lw=0.8, ls=(0, (4, 2)))
            ax.annotate(
                f"$v_{belt}$",
                (1, speed),
                (3, 0),
                ("axes fraction", "data"),
                "offset points",
                va="center",
            )


def legend_entries(axes: Iterable[Axes]) -> dict[str, Any]:
    """Return what several axes show in a legend: the drawn objects by their labels, each label
    once.
    """
    entries: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(str(label), handle)
    return entries


def add_legend(
    drawing: Figure, ax: Axes | None, shown: dict[str, Any] | Iterable[Axes], columns: int
) -> None:
    """Add a legend of `shown` (entries, or axes with them) to `ax` or, if None, in `columns` below
    the figure, or in fewer if the figure is too narrow for them.
    """
    if isinstance(shown, dict):
        entries = shown
    else:
        entries = legend_entries(shown)
    if ax is not None and entries:
        ax.legend(list(entries.values()), list(entries))
    elif entries:
        labels = list(entries)
        columns = min(columns, len(labels))
        while columns > 1 and _legend_width(labels, columns) > drawing.get_figwidth():
            columns -= 1
        style: Record = {"loc": "outside lower center", "frameon": False, "ncols": columns}
        style |= {"handlelength": 1.6, "columnspacing": 1.4, "borderpad": 0.1}
        drawing.legend(list(entries.values()), list(entries), **style)


def _legend_width(labels: list[str], columns: int) -> float:
    """Estimate the width of a legend in inches: letters, marks and gaps of the style above."""
    read = [len(re.sub(r"\\[a-z]+|[${}^_]", "", label)) for label in labels]
    rows, longer = divmod(len(labels), columns)  # the first columns have a row more
    widest = []
    for number in range(columns):
        first = number * rows + min(number, longer)
        widest.append(max(read[first : first + rows + (number < longer)]))
    return 0.05 * sum(widest) + 0.43 * len(widest)


def read_panels(
    panels: str | None, known: Iterable[str], ax: Axes | None = None, alone: str = "a"
) -> str:
    """Return the letters of the panels; None means all, or the panel `alone` for axes given by the
    user.

    ParameterError unless they are different letters out of `known`, and a single one where axes are
    given.
    """
    require_or_none(TEXT, panels=panels)
    letters = "".join(known)
    if panels is None:
        if ax is None:
            panels = letters
        else:
            panels = alone
    if not panels or set(panels) - set(letters) or len(set(panels)) < len(panels):
        raise ParameterError("panels", panels, f"must be different letters out of {letters}")
    if ax is not None:
        figure_of(ax)
    if ax is not None and len(panels) > 1:
        raise ParameterError(
            "panels",
            panels,
            f"an Axes holds a single panel; pass one of the letters {letters} together with ax=",
        )
    return panels


def check_suffix(path: str | Path) -> str:
    """Return the suffix of a figure's file name (.svg for "-").

    Raise OutputError unless it is .pdf, .svg or .png.
    """
    name = read_path(path)
    if name == STDOUT:
        suffix = ".svg"
    else:
        suffix = Path(name).suffix.lower()
    if suffix not in (".pdf", ".svg", ".png"):
        raise OutputError(name, "a figure's name must end in .pdf, .svg or .png")
    return suffix


@public
def save(drawing: Figure, path: str | Path) -> Path:
    """Write a figure as PDF, SVG or PNG, by its suffix, atomically.

    ``"-"``: SVG to standard output.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from symosc import plot
    >>> with TemporaryDirectory() as folder:
    ...     plot.save(plot.figure("fig5", panels="a"), f"{folder}/motion.svg").name
    'motion.svg'
    """
    require(FIGURE, drawing=drawing)
    require(*FILE, path=path)
    suffix = check_suffix(path)
    # No date in the file: drawing it again gives the same bytes.
    metadata = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}, ".png": None}[suffix]

    # In memory first: matplotlib's writers fail in ways of their own on a disk that is full.
    content = BytesIO()
    with own_style():
        drawing.savefig(content, format=suffix[1:], metadata=metadata)
    return write_whole(path, lambda draft: draft.write_bytes(content.getvalue()), suffix)
