"""The web server of the page and its plots; it listens on this machine only, and answers its own page and links.

The plots are models of bokeh and empty: the browser fills their sources, ranges and belts by name.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache, partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from math import cos, pi, sin
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

from symosc.aliases import Record
from symosc.errors import MissingExtraError, ParameterError, SymoscError
from symosc.plot.explorer.answers import (
    ARC_COLUMNS,
    GROUPS,
    RINGS,
    answer,
    link_of,
    read_link,
    scene_of,
    settled,
    shipped_scenes,
    state_of,
)
from symosc.plot.panels import BELT_COLOR, FORCE_ABOVE, FORCE_BELOW, MASS_COLOR
from symosc.scenes import Scene, as_toml, read_scene

try:
    from bokeh.embed import components
    from bokeh.models import (
        ColumnDataSource,
        CrosshairTool,
        FixedTicker,
        HoverTool,
        LinearAxis,
        PanTool,
        PointDrawTool,
        Range1d,
        ResetTool,
        SaveTool,
        WheelZoomTool,
    )
    from bokeh.models.annotations import Span
    from bokeh.models.tools import BoxZoomTool
    from bokeh.plotting import figure
    from bokeh.settings import settings
except ImportError:
    raise MissingExtraError("explore", "explore") from None

HOST, PORT = "127.0.0.1", 8519
#: A scene file has about 500 bytes.
MOST_BYTES = 100_000
#: The page loads nothing from elsewhere.
POLICY = "default-src 'self' 'unsafe-inline'; img-src 'self' data: blob:"


class ExplorerServer(ThreadingHTTPServer):
    """The server of the page; `scene` is shown for a link without data, port 0 is any free one."""

    daemon_threads = True

    def __init__(self, scene: Scene, port: int = PORT) -> None:
        self.scene, self.busy = scene, Lock()
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            reason = f"cannot be used ({error.strerror or error}): name another one; 0 is any free one"
            raise ParameterError("port", port, reason) from None

    @property
    def address(self) -> str:
        """The link of the page."""
        return f"http://{HOST}:{self.server_address[1]}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore connections closed by the browser."""


class _Handler(BaseHTTPRequestHandler):
    """The request handler of the page."""

    server: ExplorerServer
    protocol_version = "HTTP/1.1"
    timeout = 30.0  # seconds for which a connection may say nothing
    disable_nagle_algorithm = True  # else the kernel holds the text back until the headers are acknowledged

    def do_GET(self) -> None:
        """Send the page, an answer, a scene file, or a static file."""
        url = urlsplit(self.path)
        replies: dict[str, Callable[[str], None]] = {
            "/": self._page,
            "/answer": self._answer,
            "/settled": lambda query: self._json(settled(query, self.server.scene)),
            "/scene.toml": self._file,
            "/page.css": partial(self._static, "page.css", "text/css"),
            "/page.js": partial(self._static, "page.js", "text/javascript"),
            "/bokeh.js": lambda query: self._send(_bokeh_script(), "text/javascript", "max-age=3600"),
        }
        self._reply(replies.get(url.path), url.query)

    def do_POST(self) -> None:
        """Read a scene file, and return the link of its page."""
        self._reply(self._read_file if urlsplit(self.path).path == "/scene" else None, "")

    def log_message(self, format: str, *args: Any) -> None:
        """Do not log requests."""

    def _reply(self, reply: Callable[[str], None] | None, query: str) -> None:
        """Send what `reply` does with a query, or an error."""
        if not self._is_for_us():
            self.send_error(HTTPStatus.FORBIDDEN)
        elif reply is None:
            self.send_error(HTTPStatus.NOT_FOUND)
        else:
            reply(query)

    def _is_for_us(self) -> bool:
        """Return whether a request is for this machine, and from our page, a link, or no browser."""
        host = self.headers.get("Host", "").lower()
        if host.partition(":")[0] not in (HOST, "localhost"):
            return False  # a page of another site may point a name of its own here
        if self.headers.get("Origin", f"http://{host}").lower() != f"http://{host}":
            return False
        site, mode = (self.headers.get(f"Sec-Fetch-{name}") for name in ("Site", "Mode"))
        return site in (None, "same-origin", "none") or mode == "navigate"

    def _send(self, text: str, kind: str, keep: str = "no-store", **headers: str) -> None:
        """Send a text with its headers."""
        content = text.encode()
        self.send_response(HTTPStatus.OK)
        about = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content)), "Cache-Control": keep}
        about |= {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff"}
        for name, value in (about | headers).items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(content)

    def _json(self, content: Record) -> None:
        """Send content as JSON."""
        self._send(json.dumps(content), "application/json")

    def _page(self, query: str) -> None:
        """Send the page of a link."""
        self._send(page(read_link(query, self.server.scene)[0]), "text/html")

    def _static(self, name: str, kind: str, query: str) -> None:
        """Send a file of the page."""
        self._send((files("symosc.plot.explorer") / "page" / name).read_text(encoding="utf-8"), kind)

    def _answer(self, query: str) -> None:
        """Send the data of the page for a link."""
        with self.server.busy:
            self._json(answer(query, self.server.scene))

    def _file(self, query: str) -> None:
        """Send the scene file of a link."""
        scene, errors = scene_of(read_link(query, self.server.scene)[0])
        if scene is None:
            said = "; ".join(f"{name} {said}" for name, said in errors.items())
            self.send_error(HTTPStatus.BAD_REQUEST, explain=said)
            return
        self._send(as_toml(scene) + "\n", "application/toml", Content_Disposition='attachment; filename="scene.toml"')

    def _read_file(self, query: str) -> None:
        """Send the texts and notes of an uploaded scene file, or its error."""
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdecimal()):
            self.send_error(HTTPStatus.BAD_REQUEST, explain="Content-Length is no number")
            return
        if len(length) > len(str(MOST_BYTES)) or int(length) > MOST_BYTES:
            self.close_connection = True
            self._json({"error": f"the file has more than {MOST_BYTES} bytes: it is no scene"})
            return
        try:
            scene = read_scene(self.rfile.read(int(length)).decode("utf-8-sig"), "of this file")
            self._json({"state": state_of(scene), "notes": list(scene.notes)})
        except TimeoutError:
            self.send_error(HTTPStatus.REQUEST_TIMEOUT)
        except UnicodeDecodeError:
            self._json({"error": "the file is not UTF-8 text"})
        except SymoscError as error:
            self._json({"error": str(error)})


def page(state: dict[str, str]) -> str:
    """Return the page's HTML with these texts in its fields."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("symosc.plot.explorer", "page"), autoescape=True, undefined=StrictUndefined
    )
    script, places = _plots()
    scenes = {name: link_of(state_of(scene)) for name, scene in shipped_scenes().items()}
    content = {"state": state, "groups": GROUPS, "scenes": scenes, "script": script, "places": places}
    return environment.get_template("page.html.j2").render(content)


@cache
def _plots() -> tuple[str, Any]:
    """Return the script that creates the plots, and the HTML element of each; the same for all pages."""
    return components(pictures())


@cache
def _bokeh_script() -> str:
    """Return the script of the bokeh library."""
    return (settings.bokehjs_path() / "js" / "bokeh.min.js").read_text(encoding="utf-8")


# --- the plots ---

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
    "arcs": ARC_COLUMNS,
    "contacts": ("x", "y", "phase", "marker", "size", "color", "label"),
    "section": ("x", "v"),
    "settled": ("x", "v"),
    "start": ("x", "v"),
    "now": ("t", "x", "v"),
}


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
        "forces": _in_time(sources, ranges, "F", "force per mass F [m/s²]"),
    }


def _plot(x_label: str, y_label: str, x_range: Range1d, y_range: Range1d, height: int, **options: Any) -> Any:
    """Return an empty plot, without a drag tool at first, so that a finger scrolls the page."""
    tools = [PanTool(), BoxZoomTool(), WheelZoomTool(), ResetTool(), SaveTool()]
    style: Record = {
        "sizing_mode": "stretch_width",
        "min_border_left": LEFT,
        "min_border_right": RIGHT,
        "height": height,
    }
    ranges: Record = {"x_range": x_range, "y_range": y_range, "x_axis_label": x_label, "y_axis_label": y_label}
    plot = figure(tools=tools, **style, **ranges, **options)
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
    """Draw the marks of events."""
    style: Record = {"marker": "marker", "size": "size", "fill_color": "color", "line_width": 1}
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


def _plane(sources: dict[str, ColumnDataSource], ranges: dict[str, Range1d]) -> Any:
    """Return the plot of the phase plane."""
    plot = _plot("position x [m]", "velocity v [m/s]", ranges["x"], ranges["v"], TALL, name="plane")
    plot.line("x", "v", source=sources["settled"], line_color="black", line_width=5, line_alpha=0.22)
    plot.line("x", "v", source=sources["curves"], line_color=MASS_COLOR, line_width=1.8)
    _belts(plot)
    _marks(plot, sources, "x", "v")
    plot.scatter("x", "v", source=sources["section"], marker="x", size=9, line_color="black", line_width=1.6)
    start = plot.scatter("x", "v", source=sources["start"], size=16, fill_alpha=0.0, line_color="#5b616e")
    plot.add_tools(PointDrawTool(renderers=[start], add=False, tags=["drag-start"]))
    _now(plot, sources, "x", "v")
    return plot


def _now(plot: Any, sources: dict[str, ColumnDataSource], x: str, y: str) -> None:
    """Draw where the mass is while the motion is played."""
    plot.scatter(x, y, source=sources["now"], size=11, fill_color=MASS_COLOR, line_color="white", level="overlay")


def _in_time(sources: dict[str, ColumnDataSource], ranges: dict[str, Range1d], name: str, label: str) -> Any:
    """Return the plot of x, v or the forces F against time, with the sticks shaded, darker on belt 2."""
    plot = _plot("time t [s]", label, ranges["t"], ranges[name], LOW + 40 * (name == "F"), name=f"{name}-of-t")
    style = {"fill_color": "shade", "line_color": None, "level": "underlay"}
    plot.vstrip(x0="since", x1="until", source=sources["sticks"], **style)
    if name == "F":
        plot.add_layout(Span(dimension="width", location=0, line_color="#5b616e", line_width=1))
        for domain, (color, dash) in FORCES.items():
            plot.line("t", f"F{domain}", source=sources["curves"], line_color=color, line_dash=dash, line_width=1.8)
    else:
        plot.line("t", name, source=sources["curves"], line_color=MASS_COLOR, line_width=1.8)
        if name == "v":
            _belts(plot)
        _marks(plot, sources, "t", name)
        _now(plot, sources, "t", name)
    plot.add_tools(CrosshairTool(dimensions="height", line_color="#8a8f98"))
    return plot


def _dial(sources: dict[str, ColumnDataSource]) -> Any:
    """Return the phases on a circle: a ring for each belt with windows as arcs and events inside."""
    reach = 1.45
    ranges = {name: Range1d(start=-reach, end=reach) for name in ("x_range", "y_range")}
    size: Record = {"width": 300, "height": 300, "match_aspect": True}
    plot = figure(**ranges, **size, tools="save", toolbar_location=None, name="dial")
    plot.axis.visible = False
    plot.grid.visible = False
    plot.outline_line_color = None
    for radius in RINGS.values():
        plot.arc(0, 0, radius, 0, 2 * pi, line_color="#8a8f98", line_width=1)
    for quarter, text in enumerate(("0", "π/2", "π", "3π/2")):
        across, up = cos(quarter * pi / 2), sin(quarter * pi / 2)
        plot.segment([1.1 * across], [1.1 * up], [1.17 * across], [1.17 * up], line_color="black")
        aside: Record = {
            "text_align": ("left", "center", "right", "center")[quarter],
            "y_offset": (0, -7, 0, 7)[quarter],
        }
        plot.text([1.23 * across], [1.23 * up], [text], text_font_size="13px", text_baseline="middle", **aside)
    ring: Record = {"line_color": "color", "line_width": 15}
    plot.arc(0, 0, "radius", "low", "high", source=sources["arcs"], **ring)
    name: Record = {"text_font_size": "11px", "text_font_style": "bold", "text_align": "center", "text_color": "text"}
    plot.text("label_x", "label_y", "map", source=sources["arcs"], text_baseline="middle", **name)
    style: Record = {"marker": "marker", "size": "size", "fill_color": "color", "line_width": 1}
    marks = plot.scatter("x", "y", source=sources["contacts"], line_color="black", **style)
    plot.add_tools(HoverTool(renderers=[marks], tooltips=[("", "@label"), ("phase", "@phase{0.0000} rad")]))
    return plot
