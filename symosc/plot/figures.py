"""Figures of trajectories, in the form of the paper's Figs. 5 to 10.

A figure is built without pyplot, so that nothing global changes and nothing stays open.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from symosc.errors import OutputError, ParameterError
from symosc.exact import whole_number
from symosc.files import STDOUT, read_path, write_whole
from symosc.plot.panels import PANELS, Panel, View, view_of
from symosc.scenes import Scene, load_scene
from symosc.simulation.simulate import simulate
from symosc.simulation.trajectory import Trajectory

SUFFIXES = (".pdf", ".svg", ".png")

#: Where figures of the shipped scenes end that run on for longer: what the paper's text speaks of fills the panels.
SPANS = {"fig5": 9.0, "fig6": 5.0, "fig8": 9.0}
#: A periodic scene is shown for this many periods of the excitation.
PERIODS_SHOWN = 2.5
#: More events than these are a black band, and take long to draw.
MOST_DRAWN_EVENTS = 1000

LEGEND_ORDER = ("mass", "belt", "onset of stick", "end of stick", "crossing", "grazing point", "start")

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


def figure(
    subject: Trajectory | Scene | str,
    *,
    t_end: Any = None,
    panels: str | None = None,
    boundary: int | None = None,
    columns: int = 2,
) -> Figure:
    """Draw a trajectory: displacement, velocity, phase plane and forces.

    Parameters
    ----------
    subject : Trajectory, Scene or str
        A scene (or its name) is simulated first.
    t_end : number, optional
        End of the time axis, for scenes only. Default: the scene's own end, a few periods for a scene with a periodic
        structure, and for the paper's scenes what the paper speaks of.
    panels : str, optional
        Letters of the panels: a x(t), b x'(t), c phase plane, d forces against t, e forces against x, f forces
        against x'. Default: "abcd", for scenes with a periodic structure "abcdef" (as the paper's Figs. 9 and 10).
    boundary : int, optional
        1 to draw F^(1) and F^(2), 2 to draw F^(2) and F^(3) (accelerations, eq. (9)). Default: the boundary of the
        first event.
    columns : int, optional
        2: panels side by side, for the width of a page (7 in). 1: above each other, for one column of it (3.4 in).

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ParameterError
        If an argument is out of range.

    Examples
    --------
    >>> from symosc import plot
    >>> drawing = plot.figure("fig9", panels="ac")
    >>> [axes.get_xlabel() for axes in drawing.axes]
    ['time $t$', 'displacement $x$']
    """
    scene = load_scene(subject) if isinstance(subject, str) else subject
    if not isinstance(scene, (Scene, Trajectory)):
        raise ParameterError("subject", subject, "give a Trajectory, a Scene or the name of one")
    if isinstance(scene, Trajectory) and t_end is not None:
        raise ParameterError("t_end", t_end, "is only for scenes; a trajectory has its own")
    if panels is None:
        panels = default_panels(scene) if isinstance(scene, Scene) else "abcd"
    check_panels(panels)
    boundary = None if boundary is None else whole_number("boundary", boundary, 1, 2)
    columns = whole_number("columns", columns, 1, 2)
    subject = simulated(scene, t_end) if isinstance(scene, Scene) else scene
    if len(subject.events) > MOST_DRAWN_EVENTS:
        allowed = f"a figure shows at most {MOST_DRAWN_EVENTS} events; simulate a shorter time"
        raise ParameterError("subject", subject, allowed)
    view = view_of(subject, boundary)
    drawn = [(PANELS[letter], view) for letter in panels]
    tall = panels.index("b") if "b" in panels and view.magnified else None
    return assemble(drawn, min(columns, len(panels)), 7.0 if columns == 2 else 3.4, tall=tall)


def simulated(scene: Scene, t_end: Any = None) -> Trajectory:
    """Return the motion that a figure of a scene shows.

    Raises
    ------
    ParameterError
        If it has more events than a figure can show.

    Examples
    --------
    >>> from symosc import load_scene, plot
    >>> plot.simulated(load_scene("fig5"))
    <Trajectory t = 0 … 9, 6 events: t_end>
    """
    end = default_end(scene) if t_end is None else t_end
    found = simulate(scene, t_end=end, max_events=MOST_DRAWN_EVENTS)
    if found.status == "max_events":
        reached = (
            f"the motion has {MOST_DRAWN_EVENTS} events by t = {float(found.t_end):.6g}, and a figure shows no more"
        )
        raise ParameterError("t_end", end, f"{reached}; give an earlier end, or a scene that starts later")
    return found


def check_panels(panels: Any) -> None:
    """Raise ParameterError unless these are letters of panels.

    Examples
    --------
    >>> from symosc import plot
    >>> plot.check_panels("az")
    Traceback (most recent call last):
        ...
    symosc.errors.ParameterError: panels = 'az': must be different letters out of abcdef
    """
    if isinstance(panels, str) and panels and not set(panels) - set(PANELS) and len(set(panels)) == len(panels):
        return
    raise ParameterError("panels", panels, f"must be different letters out of {''.join(PANELS)}")


def default_end(scene: Scene) -> Any:
    """Return where a figure of a scene ends if nobody says where."""
    end: Any = SPANS.get(scene.name, scene.t_end)
    if scene.structure:
        end = float(scene.t0) + PERIODS_SHOWN * 2 * pi / float(scene.parameters.Omega)
    return min(end, scene.t_end) if end > scene.t0 else scene.t_end


def default_panels(scene: Scene) -> str:
    """Return the panels of a scene's figure if nobody says which.

    Examples
    --------
    >>> from symosc import load_scene, plot
    >>> plot.default_panels(load_scene("fig9"))
    'abcdef'
    """
    return "abcdef" if scene.structure else "abcd"


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
    if suffix not in SUFFIXES:
        raise OutputError(name, f"a figure's name must end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    return suffix


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
    if not isinstance(drawing, Figure):
        raise ParameterError("drawing", drawing, "must be a figure, such as figure(...) returns")
    suffix = _suffix(path)
    kind = suffix.removeprefix(".")
    # No date in the file: drawing it again gives the same bytes.
    metadata = {"pdf": {"CreationDate": None}, "svg": {"Date": None}, "png": None}[kind]

    def write(draft: Path) -> None:
        with rc_context(STYLE):
            drawing.savefig(draft, format=kind, metadata=metadata)

    return write_whole(path, write, suffix)


def assemble(panels: Sequence[tuple[Panel, View]], columns: int, width: float, *, tall: int | None = None) -> Figure:
    """Draw panels into the rows of one figure, with a letter for each and one legend for all below them.

    Parameters
    ----------
    panels : sequence of (panel, view)
        The panel draws the view into the axes that it is given.
    columns : int
    width : float
        In inches.
    tall : int, optional
        Index of a panel in whose row insets need more room.
    """
    with rc_context(STYLE):
        heights = [2.0] * -(-len(panels) // columns)
        if tall is not None:
            heights[tall // columns] *= 1.4
        layout = ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.04)
        drawing = Figure(figsize=(width, sum(heights) + 0.35), layout=layout)
        grid = drawing.add_gridspec(len(heights), columns, height_ratios=heights)
        entries: dict[str, Any] = {}
        for number, (panel, view) in enumerate(panels):
            ax = drawing.add_subplot(grid[number // columns, number % columns])
            panel(ax, view)
            ax.set_title(f"({'abcdef'[number]})", loc="left", x=-0.12, pad=4)
            ax.tick_params(labelfontfamily="STIXGeneral")
            for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
                entries.setdefault(label, handle)
        order = [label for label in LEGEND_ORDER if label in entries]
        order += [label for label in entries if label not in order]  # the forces
        rows = -(-len(order) // round(width))
        if rows == 2:  # filled by columns: what belongs together stands in one
            order.sort(key=lambda label: label not in LEGEND_ORDER[:4] and not label.startswith("$F"))
        drawing.legend(
            [entries[label] for label in order],
            order,
            loc="outside lower center",
            ncols=-(-len(order) // rows),
            frameon=False,
            handlelength=1.6,
            columnspacing=1.4,
            borderpad=0.1,
        )
    return drawing
