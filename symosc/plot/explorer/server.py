"""The web server of the page and its plots.

It listens on this machine only, for requests from its page and links.

The plots are models of bokeh and empty: the browser fills their sources, ranges and belts by name.
"""

from __future__ import annotations

import json
from functools import cache
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from math import cos, pi, sin
from threading import Lock
from typing import Any, TypeAlias
from urllib.parse import urlsplit

from symosc.base.aliases import Record
from symosc.base.display.pages import render
from symosc.base.errors import MissingExtraError, ParameterError, SymoscError
from symosc.plot.explorer import answers
from symosc.plot.panels import BELT_COLOR, FORCE_ABOVE, FORCE_BELOW, MASS_COLOR
from symosc.scenes import Scene, as_toml, read_scene

try:
    from bokeh import models
    from bokeh.embed import components
    from bokeh.plotting import figure
    from bokeh.settings import settings
except ImportError:
    raise MissingExtraError("explore", "explore") from None

HOST = "127.0.0.1"
PORT = 8519
#: A scene file has about 500 bytes.
MOST_BYTES = 100_000
#: The page loads nothing from elsewhere, and is no part of another page.
POLICY = "default-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; frame-ancestors 'none'"
#: What every answer says, errors too: a page of another site may neither frame it nor guess its
#: type.
GUARDS = {
    "Content-Security-Policy": POLICY,
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
}


class ExplorerServer(ThreadingHTTPServer):
    """The server of the page; a link without data shows `scene`; with port 0 it takes any free
    port.
    """

    daemon_threads = True

    def __init__(self, scene: Scene, port: int = PORT) -> None:
        self.scene = scene
        self.busy = Lock()
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            reason = (
                f"cannot be used ({error.strerror or error}): name another one; 0 is any free one"
            )
            raise ParameterError("port", port, reason) from None

    @property
    def address(self) -> str:
        """The address at which a browser finds the page."""
        return f"http://{HOST}:{self.server_address[1]}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore connections closed by the browser."""


class _Handler(BaseHTTPRequestHandler):
    """The handler of the browser's requests: for the page, its data and scripts, and scene files."""

    server: ExplorerServer
    protocol_version = "HTTP/1.1"
    timeout = 30.0  # seconds for which a connection may say nothing
    # Else the kernel holds the text back until the headers are acknowledged.
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        """Send the page, the data for a link, a scene file, or a static file."""
        url = urlsplit(self.path)
        scene = self.server.scene
        if not self._is_for_us():
            self.send_error(HTTPStatus.FORBIDDEN)
        elif url.path == "/":
            state, _ = answers.read_link(url.query, scene)
            self._send(page(state), "text/html")
        elif url.path == "/answer":
            with self.server.busy:  # one motion at a time
                self._send_json(answers.answer(url.query, scene))
        elif url.path == "/settled":
            self._send_json(answers.settled(url.query, scene))
        elif url.path == "/scene.toml":
            self._send_file(url.query)
        elif url.path in ("/page.css", "/page.js"):
            file = files("symosc.plot.explorer") / "page" / url.path[1:]
            self._send(
                file.read_text(encoding="utf-8"),
                "text/css" if url.path.endswith("css") else "text/javascript",
            )
        elif url.path == "/bokeh.js":
            self._send(_bokeh_script(), "text/javascript", "max-age=3600")
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """Read an uploaded scene file, and answer with the texts for the page's fields."""
        if not self._is_for_us():
            self.send_error(HTTPStatus.FORBIDDEN)
        elif urlsplit(self.path).path == "/scene":
            self._read_file()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def end_headers(self) -> None:
        """End the headers of an answer, also of an error, with those that guard it."""
        for name, value in GUARDS.items():
            self.send_header(name, value)
        super().end_headers()

    def log_message(self, format: str, *args: Any) -> None:
        """Do not log requests."""

    def _is_for_us(self) -> bool:
        """Return whether a request names this machine as its host and does not come from a page of
        another site.
        """
        host = self.headers.get("Host", "").lower()
        if host.partition(":")[0] not in (HOST, "localhost"):
            return False  # a page of another site may point a name of its own here
        if self.headers.get("Origin", f"http://{host}").lower() != f"http://{host}":
            return False
        site, mode = (self.headers.get(f"Sec-Fetch-{name}") for name in ("Site", "Mode"))
        return site in (None, "same-origin", "none") or mode == "navigate"

    def _send(self, text: str, kind: str, keep: str = "no-store", **headers: str) -> None:
        """Send a text of the media type `kind` with more `headers`.

        `keep` says how long browsers may keep it.
        """
        content = text.encode()
        self.send_response(HTTPStatus.OK)
        about = {
            "Content-Type": f"{kind}; charset=utf-8",
            "Content-Length": str(len(content)),
            "Cache-Control": keep,
        }
        for name, value in (about | headers).items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(content)

    def _send_json(self, content: Record) -> None:
        """Send content as JSON."""
        self._send(json.dumps(content), "application/json")

    def _send_file(self, query: str) -> None:
        """Send the scene file of a link."""
        state, _ = answers.read_link(query, self.server.scene)
        scene, errors = answers.scene_of(state)
        if scene is None:
            explanation = "; ".join(f"{name} {allowed}" for name, allowed in errors.items())
            self.send_error(HTTPStatus.BAD_REQUEST, explain=explanation)
            return
        self._send(
            as_toml(scene) + "\n",
            "application/toml",
            Content_Disposition='attachment; filename="scene.toml"',
        )

    def _read_file(self) -> None:
        """Send the fields' texts and the notes that follow from an uploaded scene file, or its
        error.
        """
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdecimal()):
            self.send_error(HTTPStatus.BAD_REQUEST, explain="Content-Length is no number")
            return
        # By its length first: Python refuses to convert thousands of digits.
        if len(length) > len(str(MOST_BYTES)) or int(length) > MOST_BYTES:
            self.close_connection = True
            self._send_json({"error": f"the file has more than {MOST_BYTES} bytes: it is no scene"})
            return
        try:
            scene = read_scene(self.rfile.read(int(length)).decode("utf-8-sig"), "of this file")
            self._send_json({"state": answers.state_of(scene), "notes": answers.notes_of(scene)})
        except TimeoutError:
            self.send_error(HTTPStatus.REQUEST_TIMEOUT)
        except UnicodeDecodeError:
            self._send_json({"error": "the file is not UTF-8 text"})
        except SymoscError as error:
            self._send_json({"error": str(error)})


def page(state: dict[str, str]) -> str:
    """Return the page's HTML with these texts in its input fields."""
    script, places = _plots()
    scenes = {
        name: answers.link_of(answers.state_of(scene))
        for name, scene in answers.shipped_scenes().items()
    }
    content = {
        "state": state,
        "groups": answers.GROUPS,
        "scenes": scenes,
        "script": script,
        "places": places,
    }
    return render("plot/explorer/page/page.html.j2", content)


@cache
def _plots() -> tuple[str, Any]:
    """Return the script that creates the plots, and the HTML elements that hold them, the same for
    all pages.
    """
    return components(pictures())


@cache
def _bokeh_script() -> str:
    """Return the script of the bokeh library."""
    return (settings.bokehjs_path() / "js" / "bokeh.min.js").read_text(encoding="utf-8")


# --- the plots ---

INK = "#1d2129"
AXIS = "#8a8f98"
GREY = "#5b616e"
#: The colour of each force, and its dashes, which tell the three apart without colour.
FORCES = {1: (FORCE_BELOW, "solid"), 2: ("black", "dashed"), 3: (FORCE_ABOVE, "dotted")}
Sources: TypeAlias = dict[str, models.ColumnDataSource]
Ranges: TypeAlias = dict[str, models.Range1d]
#: How the marks of events are drawn.
MARKS: Record = {
    "marker": "marker",
    "size": "size",
    "fill_color": "color",
    "line_width": 1,
    "line_color": "black",
}


def pictures() -> dict[str, Any]:
    """Return the plots by name: plane, dial, displacement, velocity, forces."""
    # The answer for any scene has the names of all columns; the plots begin empty.
    columns = answers.answer("", answers.shipped_scenes()["fig5"])["sources"]
    columns |= {"settled": ["x", "v"], "now": ["t", "x", "v"]}
    sources = {
        name: models.ColumnDataSource({key: [] for key in keys}, name=name)
        for name, keys in columns.items()
    }
    ranges = {
        name: models.Range1d(start=0, end=1, name=f"range-{name}") for name in ("t", "x", "v", "F")
    }
    return {
        "plane": _plane(sources, ranges),
        "dial": _dial(sources),
        "displacement": _time_plot(sources, ranges, "x", "position x [m]"),
        "velocity": _time_plot(sources, ranges, "v", "velocity v [m/s]"),
        "forces": _time_plot(sources, ranges, "F", "force per mass F [m/s²]"),
    }


def _plot(
    x_label: str,
    y_label: str,
    x_range: models.Range1d,
    y_range: models.Range1d,
    height: int,
    name: str,
) -> Any:
    """Return an empty plot; no drag tool is active at first, so that a finger scrolls the page."""
    tools = [
        models.PanTool(),
        models.BoxZoomTool(),
        models.WheelZoomTool(),
        models.ResetTool(),
        models.SaveTool(),
    ]
    ranges: Record = {
        "x_range": x_range,
        "y_range": y_range,
        "x_axis_label": x_label,
        "y_axis_label": y_label,
    }
    # With this room beside the plots their time axes are one below the other.
    style: Record = {
        "sizing_mode": "stretch_width",
        "min_border_left": 70,
        "min_border_right": 78,
        "height": height,
    }
    plot = figure(tools=tools, name=name, **style, **ranges)
    plot.toolbar.update(active_drag=None, active_scroll=None, logo=None, autohide=True)
    plot.outline_line_color = AXIS
    for axis in (*plot.xaxis, *plot.yaxis):
        axis.update(
            axis_label_text_font_style="normal",
            axis_label_text_color=INK,
            major_label_text_color=INK,
        )
        axis.update(
            axis_label_text_font_size="13px",
            major_label_text_font_size="12px",
            minor_tick_line_color=None,
        )
    plot.grid.grid_line_color = "#e8eaee"
    return plot


def _marks(plot: Any, sources: Sources, x: str, y: str) -> None:
    """Draw event marks, and a moving dot for the mass, from the columns `x` and `y` of the
    browser's data `sources`.
    """
    marks = plot.scatter(x, y, source=sources["marks"], level="overlay", **MARKS)
    coordinates = [("t", "@t{0.000000}"), ("x", "@x{0.000000}"), ("v", "@v{0.000000}")]
    plot.add_tools(
        models.HoverTool(renderers=[marks], tooltips=[("", "@label @belt"), *coordinates])
    )
    plot.scatter(
        x,
        y,
        source=sources["now"],
        size=11,
        fill_color=MASS_COLOR,
        line_color="white",
        level="overlay",
    )


def _belts(plot: Any) -> None:
    """Draw lines for both belts and their names on an axis to the right.

    The browser moves them to the speeds.
    """
    for belt, dash in ((1, "solid"), (2, "dashed")):
        style = {"line_color": BELT_COLOR, "line_width": 1.4, "line_dash": dash}
        plot.add_layout(models.Span(dimension="width", location=0, tags=[f"belt-{belt}"], **style))
    names: Record = {
        "major_label_text_font_size": "12px",
        "major_label_text_color": INK,
        "axis_line_color": None,
    }
    names |= {
        "major_tick_line_color": BELT_COLOR,
        "major_tick_in": 0,
        "ticker": models.FixedTicker(ticks=[]),
    }
    plot.add_layout(models.LinearAxis(tags=["belt-names"], **names), "right")


def _plane(sources: Sources, ranges: Ranges) -> Any:
    """Return the plot of v against x, with curve, belts, Poincaré section, marks and a start that
    can be dragged.
    """
    plot = _plot("position x [m]", "velocity v [m/s]", ranges["x"], ranges["v"], 380, "plane")
    plot.line(
        "x", "v", source=sources["settled"], line_color="black", line_width=5, line_alpha=0.22
    )
    plot.line("x", "v", source=sources["curves"], line_color=MASS_COLOR, line_width=1.8)
    _belts(plot)
    plot.scatter(
        "x", "v", source=sources["section"], marker="x", size=9, line_color="black", line_width=1.6
    )
    start = plot.scatter(
        "x", "v", source=sources["start"], size=16, fill_alpha=0.0, line_color=GREY
    )
    plot.add_tools(models.PointDrawTool(renderers=[start], add=False, tags=["drag-start"]))
    _marks(plot, sources, "x", "v")
    return plot


def _time_plot(sources: Sources, ranges: Ranges, name: str, label: str) -> Any:
    """Return the plot of x, v or the forces F over time, with sticks shaded, those on belt 2
    darker.
    """
    if name == "F":
        height = 230
    else:
        height = 190
    plot = _plot("time t [s]", label, ranges["t"], ranges[name], height, f"{name}-of-t")
    style = {"fill_color": "shade", "line_color": None, "level": "underlay"}
    plot.vstrip(x0="since", x1="until", source=sources["sticks"], **style)
    if name == "F":
        plot.add_layout(models.Span(dimension="width", location=0, line_color=GREY, line_width=1))
        for domain, (color, dash) in FORCES.items():
            plot.line(
                "t",
                f"F{domain}",
                source=sources["curves"],
                line_color=color,
                line_dash=dash,
                line_width=1.8,
            )
    else:
        plot.line("t", name, source=sources["curves"], line_color=MASS_COLOR, line_width=1.8)
        if name == "v":
            _belts(plot)
        _marks(plot, sources, "t", name)
    plot.add_tools(models.CrosshairTool(dimensions="height", line_color=AXIS))
    return plot


def _dial(sources: Sources) -> Any:
    """Return the plot of phases on a circle: a ring for each belt, with windows as arcs and events
    inside.
    """
    ranges: Record = {
        name: models.Range1d(start=-1.45, end=1.45) for name in ("x_range", "y_range")
    }
    size: Record = {
        "width": 300,
        "height": 300,
        "match_aspect": True,
        "tools": "save",
        "toolbar_location": None,
    }
    plot = figure(name="dial", **ranges, **size)
    plot.axis.visible = plot.grid.visible = False
    plot.outline_line_color = None
    for radius in answers.RINGS.values():
        plot.arc(0, 0, radius, 0, 2 * pi, line_color=AXIS, line_width=1)
    sides = (("0", "left", 0), ("π/2", "center", -7), ("π", "right", 0), ("3π/2", "center", 7))
    for quarter, (text, side, down) in enumerate(sides):
        across = cos(quarter * pi / 2)
        up = sin(quarter * pi / 2)
        plot.segment([1.1 * across], [1.1 * up], [1.17 * across], [1.17 * up], line_color="black")
        style: Record = {
            "text_font_size": "13px",
            "text_baseline": "middle",
            "text_align": side,
            "y_offset": down,
        }
        plot.text([1.23 * across], [1.23 * up], [text], **style)
    plot.arc(
        0, 0, "radius", "low", "high", source=sources["arcs"], line_color="color", line_width=15
    )
    name: Record = {
        "text_font_size": "11px",
        "text_font_style": "bold",
        "text_align": "center",
        "text_color": "text",
    }
    plot.text("label_x", "label_y", "map", source=sources["arcs"], text_baseline="middle", **name)
    marks = plot.scatter("x", "y", source=sources["contacts"], **MARKS)
    plot.add_tools(
        models.HoverTool(
            renderers=[marks], tooltips=[("", "@label"), ("phase", "@phase{0.0000} rad")]
        )
    )
    return plot
