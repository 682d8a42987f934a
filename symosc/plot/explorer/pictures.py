"""The plots of the page, empty, as models of bokeh. The browser fills their sources, ranges and belts by name."""

from __future__ import annotations

from math import cos, pi, sin
from typing import Any

from bokeh.models import (
    ColumnDataSource,
    CrosshairTool,
    FixedTicker,
    HoverTool,
    LinearAxis,
    PanTool,
    Range1d,
    ResetTool,
    SaveTool,
    WheelZoomTool,
)
from bokeh.models.annotations import Span
from bokeh.models.tools import BoxZoomTool
from bokeh.plotting import figure

from symosc.plot.explorer.answer import RINGS
from symosc.plot.panels import BELT_COLOR, FORCE_ABOVE, FORCE_BELOW, MASS_COLOR

TALL, LOW = 380, 190
#: Room beside the plots, so that their time axes are one below the other.
LEFT, RIGHT = 70, 78
INK = "#1d2129"
#: The colour of each force, and its dashes, which tell the three apart without colour.
FORCES = {1: (FORCE_BELOW, "solid"), 2: ("black", "dashed"), 3: (FORCE_ABOVE, "dotted")}
#: Columns of each source, as an answer fills them.
COLUMNS = {
    "curves": ("t", "x", "v", "F1", "F2", "F3"),
    "marks": ("t", "x", "v", "marker", "size", "color", "label", "belt"),
    "sticks": ("since", "until", "shade"),
    "arcs": ("radius", "low", "high", "color", "text", "map", "label_x", "label_y"),
    "contacts": ("x", "y", "phase", "marker", "size", "color", "label"),
}
RING_WIDTH = 15


def pictures() -> dict[str, Any]:
    """Return the plots by name: plane, dial, displacement, velocity, forces."""
    sources = {
        name: ColumnDataSource({column: [] for column in columns}, name=name) for name, columns in COLUMNS.items()
    }
    ranges = {name: Range1d(start=0, end=1, name=f"range-{name}") for name in ("t", "x", "v", "F")}
    return {
        "plane": _plane(sources, ranges),
        "dial": _dial(sources),
        "displacement": _in_time(sources, ranges, "x", "position x [m]"),
        "velocity": _in_time(sources, ranges, "v", "velocity v [m/s]"),
        "forces": _forces(sources, ranges),
    }


def _plot(x_label: str, y_label: str, x_range: Range1d, y_range: Range1d, height: int, **options: Any) -> Any:
    """Return an empty plot. Nothing is dragged until a tool is chosen, so that a finger scrolls the page."""
    tools = [PanTool(), BoxZoomTool(), WheelZoomTool(), ResetTool(), SaveTool()]
    plot = figure(
        x_range=x_range,
        y_range=y_range,
        height=height,
        sizing_mode="stretch_width",
        tools=tools,
        x_axis_label=x_label,
        y_axis_label=y_label,
        min_border_left=LEFT,
        min_border_right=RIGHT,
        **options,
    )
    plot.toolbar.active_drag = None
    plot.toolbar.active_scroll = None
    plot.toolbar.logo = None
    plot.toolbar.autohide = True
    plot.outline_line_color = "#8a8f98"
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_color = axis.major_label_text_color = INK
        axis.axis_label_text_font_size = "13px"
        axis.major_label_text_font_size = "12px"
        axis.minor_tick_line_color = None
    plot.grid.grid_line_color = "#e8eaee"
    return plot


def _marks(plot: Any, sources: dict[str, ColumnDataSource], x: str, y: str) -> None:
    style: dict[str, Any] = {"marker": "marker", "size": "size", "fill_color": "color", "line_width": 1}
    marks = plot.scatter(x, y, source=sources["marks"], line_color="black", level="overlay", **style)
    place = [("t", "@t{0.000000}"), ("x", "@x{0.000000}"), ("v", "@v{0.000000}")]
    plot.add_tools(HoverTool(renderers=[marks], tooltips=[("", "@label @belt"), *place]))


def _belts(plot: Any) -> None:
    """Draw lines for both belts, and their names on an axis on the right; the browser moves them."""
    for belt, dash in ((1, "solid"), (2, "dashed")):
        style = {"line_color": BELT_COLOR, "line_width": 1.4, "line_dash": dash}
        plot.add_layout(Span(dimension="width", location=0, tags=[f"belt-{belt}"], **style))
    names = LinearAxis(tags=["belt-names"], axis_line_color=None)
    names.ticker = FixedTicker(ticks=[])
    names.major_label_text_font_size = "12px"
    names.major_label_text_color = INK
    names.major_tick_line_color = BELT_COLOR
    names.major_tick_in = 0
    plot.add_layout(names, "right")


def _shade(plot: Any, sources: dict[str, ColumnDataSource]) -> None:
    """Shade the sticks, those on belt 2 darker."""
    plot.vstrip(
        x0="since",
        x1="until",
        source=sources["sticks"],
        fill_color="shade",
        line_color=None,
        level="underlay",
    )


def _plane(sources: dict[str, ColumnDataSource], ranges: dict[str, Range1d]) -> Any:
    plot = _plot("position x [m]", "velocity v [m/s]", ranges["x"], ranges["v"], TALL, name="plane")
    plot.line("x", "v", source=sources["curves"], line_color=MASS_COLOR, line_width=1.8)
    _belts(plot)
    _marks(plot, sources, "x", "v")
    return plot


def _in_time(sources: dict[str, ColumnDataSource], ranges: dict[str, Range1d], name: str, label: str) -> Any:
    plot = _plot("time t [s]", label, ranges["t"], ranges[name], LOW, name=f"{name}-of-t")
    _shade(plot, sources)
    plot.line("t", name, source=sources["curves"], line_color=MASS_COLOR, line_width=1.8)
    if name == "v":
        _belts(plot)
    _marks(plot, sources, "t", name)
    plot.add_tools(CrosshairTool(dimensions="height", line_color="#8a8f98"))
    return plot


def _forces(sources: dict[str, ColumnDataSource], ranges: dict[str, Range1d]) -> Any:
    plot = _plot("time t [s]", "force per mass F [m/s²]", ranges["t"], ranges["F"], LOW + 40, name="F-of-t")
    _shade(plot, sources)
    plot.add_layout(Span(dimension="width", location=0, line_color="#5b616e", line_width=1))
    for domain, (color, dash) in FORCES.items():
        plot.line("t", f"F{domain}", source=sources["curves"], line_color=color, line_dash=dash, line_width=1.8)
    plot.add_tools(CrosshairTool(dimensions="height", line_color="#8a8f98"))
    return plot


def _dial(sources: dict[str, ColumnDataSource]) -> Any:
    """Return the phases on a circle: a ring for each belt, with the windows as arcs, and the events inside of it."""
    reach = 1.45
    plot = figure(
        x_range=Range1d(start=-reach, end=reach),
        y_range=Range1d(start=-reach, end=reach),
        width=300,
        height=300,
        tools="save",
        toolbar_location=None,
        name="dial",
        match_aspect=True,
    )
    plot.axis.visible = False
    plot.grid.visible = False
    plot.outline_line_color = None
    for radius in RINGS.values():
        plot.arc(0, 0, radius, 0, 2 * pi, line_color="#8a8f98", line_width=1)
    for quarter, text in enumerate(("0", "π/2", "π", "3π/2")):
        across, up = cos(quarter * pi / 2), sin(quarter * pi / 2)
        plot.segment([1.1 * across], [1.1 * up], [1.17 * across], [1.17 * up], line_color="black")
        plot.text(
            [1.23 * across], [1.23 * up], [text], text_font_size="13px", text_baseline="middle",
            text_align=("left", "center", "right", "center")[quarter],
            y_offset=(0, -7, 0, 7)[quarter],
        )  # fmt: skip
    ring: dict[str, Any] = {"line_color": "color", "line_width": RING_WIDTH}
    plot.arc(0, 0, "radius", "low", "high", source=sources["arcs"], **ring)
    name: dict[str, Any] = {"text_font_size": "11px", "text_font_style": "bold", "text_align": "center"}
    plot.text(
        "label_x", "label_y", "map", source=sources["arcs"], text_baseline="middle", text_color="text", **name
    )  # fmt: skip
    style: dict[str, Any] = {"marker": "marker", "size": "size", "fill_color": "color", "line_width": 1}
    marks = plot.scatter("x", "y", source=sources["contacts"], line_color="black", **style)
    plot.add_tools(HoverTool(renderers=[marks], tooltips=[("", "@label"), ("phase", "@phase{0.0000} rad")]))
    return plot
