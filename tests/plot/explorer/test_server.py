"""The server of the page: on this machine only, and nothing that it is sent makes it fail."""

from __future__ import annotations

import json
from http.client import HTTPConnection, HTTPResponse
from queue import Queue
from socket import IPPROTO_TCP, TCP_NODELAY
from socketserver import StreamRequestHandler
from urllib.parse import urlsplit

import pytest

from symosc import ParameterError, load_scene
from symosc.plot.explorer.inputs import link_of, state_of
from symosc.scenes import read_scene
from symosc.scenes.writing import as_toml


def ask(address: str, target: str, body: bytes | None = None, **headers: str) -> tuple[HTTPResponse, str]:
    connection = HTTPConnection(urlsplit(address).netloc, timeout=20)
    connection.request("GET" if body is None else "POST", target, body, headers)
    response = connection.getresponse()
    text = response.read().decode()
    connection.close()
    return response, text


def test_the_page_has_the_numbers_of_its_link(address: str) -> None:
    response, text = ask(address, "/?k=4%2F5&scene=%3Cscript%3Ealert(1)")
    assert response.status == 200
    assert 'value="4/5"' in text
    assert "<script>alert" not in text
    assert "http" not in text.replace("http-equiv", "")  # nothing is loaded from elsewhere
    policy = response.headers["Content-Security-Policy"]
    assert policy.startswith("default-src 'self'")


@pytest.mark.parametrize("part", ["page.css", "page.js", "bokeh.js"])
def test_what_the_page_is_made_of(address: str, part: str) -> None:
    response, text = ask(address, f"/{part}")
    assert (response.status, len(text) > 2000) == (200, True)


@pytest.mark.parametrize("target", ["/server.py", "/../server.py", "/page/page.js", "//etc/passwd", "/%2e%2e/x"])
def test_nothing_else_is_there(address: str, target: str) -> None:
    assert ask(address, target)[0].status == 404
    assert ask(address, target, b"")[0].status == 404


def test_only_this_machine_is_answered(address: str) -> None:
    assert urlsplit(address).hostname == "127.0.0.1"
    port = urlsplit(address).port
    assert ask(address, "/answer", Host=f"localhost:{port}")[0].status == 200
    for name in (f"example.org:{port}", "example.org", f"127.0.0.1.example.org:{port}", ""):
        assert ask(address, "/answer", Host=name)[0].status == 403
        assert ask(address, "/scene", b"", Host=name)[0].status == 403


def test_answers_are_json(address: str) -> None:
    response, text = ask(address, "/answer?k=2")
    assert response.headers["Content-Type"].startswith("application/json")
    assert json.loads(text)["name"] == "fig5, changed"


def test_no_answer_is_held_back(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernel would wait 40 ms for the headers to be acknowledged before it sends the rest."""
    found: Queue[int] = Queue()
    finish = StreamRequestHandler.finish

    def noted(handler: StreamRequestHandler) -> None:
        found.put(handler.connection.getsockopt(IPPROTO_TCP, TCP_NODELAY))
        finish(handler)

    monkeypatch.setattr(StreamRequestHandler, "finish", noted)
    ask(address, "/answer")
    assert found.get(timeout=20)


def test_a_scene_file_goes_out_and_comes_in(address: str) -> None:
    response, text = ask(address, f"/scene.toml?{link_of(state_of(load_scene('fig9-orbit')))}")
    assert "attachment" in response.headers["Content-Disposition"]
    assert read_scene(text, "file") == load_scene("fig9-orbit")
    _, back = ask(address, "/scene", text.encode())
    assert json.loads(back)["state"] == state_of(load_scene("fig9-orbit"))
    assert ask(address, "/scene.toml?k=x")[0].status == 400


GOOD = as_toml(load_scene("fig5"))


@pytest.mark.parametrize(
    "content",
    [b"", b"\xff\xfe", b"x" * 200_000, b"[[[", GOOD.replace("m = 1\n", "m = -1\n").encode(), b"a = 1", b"\0" * 9],
)  # fmt: skip
def test_a_bad_scene_file_is_one_clear_line(address: str, content: bytes) -> None:
    response, text = ask(address, "/scene", content)
    said = json.loads(text)["error"]
    assert response.status == 200
    assert said
    assert "\n" not in said


def test_a_file_with_numbers_that_are_not_exact_says_so(address: str) -> None:
    _, text = ask(address, "/scene", GOOD.replace("x0 = 0", 'x0 = "pi/6"').encode())
    assert "40 digits" in json.loads(text)["notes"][0]


def test_a_port_that_is_taken_is_said(address: str) -> None:
    from symosc.plot.explorer.server import ExplorerServer

    with pytest.raises(ParameterError, match="name another one"):
        ExplorerServer(load_scene("fig5"), urlsplit(address).port or 0)
