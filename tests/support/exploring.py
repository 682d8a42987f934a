"""The page of `symosc explore`, served inside a test, and what it answers."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse
from threading import Thread
from urllib.parse import urlsplit

from effort import PATIENCE

from symosc import load_scene


@contextmanager
def served(scene: str) -> Iterator[str]:
    """Serve the page on a free port; its address."""
    from symosc.plot.explorer.server import ExplorerServer

    with ExplorerServer(load_scene(scene), 0) as server:
        thread = Thread(target=server.serve_forever, args=[0.02])
        thread.start()
        try:
            yield server.address
        finally:
            server.shutdown()
            thread.join()


def ask(
    address: str, target: str, body: bytes | str | None = None, **headers: str
) -> tuple[HTTPResponse, str]:
    connection = HTTPConnection(urlsplit(address).netloc, timeout=PATIENCE)
    connection.request("GET" if body is None else "POST", target, body, headers)
    response = connection.getresponse()
    text = response.read().decode()
    connection.close()
    return response, text
