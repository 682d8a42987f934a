"""The page of `symosc explore`, served inside a test."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread

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
