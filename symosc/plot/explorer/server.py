"""The server of the page. It listens on this machine only, and answers its own page and who asks for it by name."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache, partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from socket import SHUT_RDWR, socket
from threading import Lock
from typing import Any
from urllib.parse import urlsplit

from symosc.aliases import Record
from symosc.errors import MissingExtraError, ParameterError, SymoscError
from symosc.plot.explorer.answer import answer
from symosc.plot.explorer.inputs import GROUPS, link_of, read_link, scene_of, shipped_scenes, state_of
from symosc.scenes import Scene, as_toml, read_scene

try:
    from bokeh.embed import components
    from bokeh.settings import settings

    from symosc.plot.explorer.pictures import pictures
except ImportError:
    raise MissingExtraError("explore", "explore") from None

HOST, PORT = "127.0.0.1", 8519
HOST_NAMES = (HOST, "localhost")
#: A scene file has about 500 bytes.
MOST_BYTES = 100_000
#: Seconds for which a connection may say nothing, and how many may be open; a browser has six.
IDLE_SECONDS, MOST_CONNECTIONS = 30.0, 32
TYPES = {".css": "text/css", ".js": "text/javascript", ".toml": "application/toml"}
#: The page loads nothing from elsewhere.
POLICY = "default-src 'self' 'unsafe-inline'; img-src 'self' data: blob:"


class ExplorerServer(ThreadingHTTPServer):
    """The server of the page.

    Parameters
    ----------
    scene : Scene
        What the page shows if its link says nothing.
    port : int
        0: any free one.

    Raises
    ------
    ParameterError
        If another program listens on that port.
    """

    daemon_threads = True

    def __init__(self, scene: Scene, port: int = PORT) -> None:
        self.scene, self.busy = scene, Lock()
        # Open connections, and whether each waits for what its client says; the oldest of these are first.
        self.waiting: dict[socket, bool] = {}
        self._guard = Lock()
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            reason = f"cannot be used ({error.strerror or error}): name another one; 0 is any free one"
            raise ParameterError("port", port, reason) from None

    @property
    def address(self) -> str:
        """The link of the page."""
        return f"http://{HOST}:{self.server_address[1]}/"

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a new connection; if there are too many, end the one that has been waiting longest, or the new one."""
        with self._guard:
            full = len(self.waiting) >= MOST_CONNECTIONS
            oldest = next((each for each, waits in self.waiting.items() if waits), request) if full else None
            if oldest is not None:
                self.waiting.pop(oldest, None)
            if oldest is not request:
                self.waiting[request] = True
        if oldest is request:
            self.shutdown_request(request)
            return
        if oldest is not None:
            with suppress(OSError):
                oldest.shutdown(SHUT_RDWR)  # its thread closes it
        super().process_request(request, client_address)

    def set_waiting(self, connection: socket, waits: bool) -> None:
        """Note whether a connection waits for its client; it is then the youngest of those."""
        with self._guard:
            if self.waiting.pop(connection, None) is not None:
                self.waiting[connection] = waits

    def shutdown_request(self, request: Any) -> None:
        """Close a connection."""
        with self._guard:
            self.waiting.pop(request, None)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing if a browser hangs up."""


class _Handler(BaseHTTPRequestHandler):
    server: ExplorerServer
    protocol_version = "HTTP/1.1"
    timeout = IDLE_SECONDS
    disable_nagle_algorithm = True  # else the kernel holds the text back until the headers are acknowledged

    def do_GET(self) -> None:
        """Hand out the page, an answer, a scene file, or what the page is made of."""
        url = urlsplit(self.path)
        replies = {
            "/": partial(self._page, url.query),
            "/answer": partial(self._answer, url.query),
            "/scene.toml": partial(self._file, url.query),
            "/page.css": partial(self._static, "page.css"),
            "/page.js": partial(self._static, "page.js"),
            "/bokeh.js": partial(self._send, _bokeh_script(), TYPES[".js"], "max-age=3600"),
        }
        self.server.set_waiting(self.connection, False)
        self._reply(replies.get(url.path))
        self.server.set_waiting(self.connection, True)

    def do_POST(self) -> None:
        """Read a scene file, and return the link of its page."""
        url = urlsplit(self.path)
        self._reply(partial(self._read_file, url.query) if url.path == "/scene" else None)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing of requests."""

    def _reply(self, reply: Any) -> None:
        if not self._is_for_us():
            self.send_error(HTTPStatus.FORBIDDEN)
        elif reply is None:
            self.send_error(HTTPStatus.NOT_FOUND)
        else:
            reply()

    def _is_for_us(self) -> bool:
        """Return whether a request asks for this machine, and comes from our page, from a link, or from no browser."""
        host = self.headers.get("Host", "").lower()
        if host.partition(":")[0] not in HOST_NAMES:
            return False  # a page of another site may point a name of its own here
        if self.headers.get("Origin", f"http://{host}").lower() != f"http://{host}":
            return False
        site, mode = (self.headers.get(f"Sec-Fetch-{name}") for name in ("Site", "Mode"))
        return site in (None, "same-origin", "none") or mode == "navigate"

    def _send(self, text: str, kind: str, keep: str = "no-store", **headers: str) -> None:
        content = text.encode()
        self.send_response(HTTPStatus.OK)
        about = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content)), "Cache-Control": keep}
        about |= {"Content-Security-Policy": POLICY, "X-Content-Type-Options": "nosniff"}
        for name, value in (about | headers).items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(content)

    def _json(self, content: Record) -> None:
        self._send(json.dumps(content), "application/json")

    def _page(self, query: str) -> None:
        self._send(page(read_link(query, self.server.scene)[0]), "text/html")

    def _static(self, name: str) -> None:
        self._send(_text(name), TYPES[Path(name).suffix])

    def _answer(self, query: str) -> None:
        with self.server.busy:
            self._json(answer(query, self.server.scene))

    def _file(self, query: str) -> None:
        scene, errors = scene_of(read_link(query, self.server.scene)[0])
        if scene is None:
            said = "; ".join(f"{name} {said}" for name, said in errors.items())
            self.send_error(HTTPStatus.BAD_REQUEST, explain=said)
            return
        self._send(as_toml(scene) + "\n", TYPES[".toml"], Content_Disposition='attachment; filename="scene.toml"')

    def _read_file(self, name: str) -> None:
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdecimal()):
            self.send_error(HTTPStatus.BAD_REQUEST, explain="Content-Length is no number")
            return
        if len(length) > len(str(MOST_BYTES)) or int(length) > MOST_BYTES:
            self.close_connection = True
            self._json({"error": f"the file has more than {MOST_BYTES} bytes: it is no scene"})
            return
        try:
            content = self.rfile.read(int(length))
        except TimeoutError:
            self.send_error(HTTPStatus.REQUEST_TIMEOUT)
            return
        try:
            scene = read_scene(content.decode("utf-8-sig"), "of this file")
        except UnicodeDecodeError:
            self._json({"error": "the file is not UTF-8 text"})
        except SymoscError as error:
            self._json({"error": str(error)})
        else:
            self._json({"state": state_of(scene), "notes": list(scene.notes)})


def page(state: dict[str, str]) -> str:
    """Return the page with these texts in its fields."""
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
    """Return the script that makes the plots, and the place of each; both are the same for all pages."""
    return components(pictures())


def _text(name: str) -> str:
    return (files("symosc.plot.explorer") / "page" / name).read_text(encoding="utf-8")


@cache
def _bokeh_script() -> str:
    return (settings.bokehjs_path() / "js" / "bokeh.min.js").read_text(encoding="utf-8")
