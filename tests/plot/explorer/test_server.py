"""The server of the page: on this machine only, and nothing that it is sent makes it fail."""

from __future__ import annotations

import json
from contextlib import ExitStack
from http.client import HTTPConnection, HTTPResponse
from queue import Queue
from socket import IPPROTO_TCP, TCP_NODELAY, create_connection
from socketserver import StreamRequestHandler
from urllib.parse import urlsplit

import pytest
from effort import PATIENCE

from symosc import ParameterError, load_scene
from symosc.plot.explorer.inputs import link_of, state_of
from symosc.scenes import as_toml, read_scene

GOOD = as_toml(load_scene("fig5"))


def ask(address: str, target: str, body: bytes | None = None, **headers: str) -> tuple[HTTPResponse, str]:
    connection = HTTPConnection(urlsplit(address).netloc, timeout=PATIENCE)
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
    assert ask(address, "/answer", Host="127.0.0.1")[0].status == 200
    for name in (f"example.org:{port}", "example.org", f"127.0.0.1.example.org:{port}", ""):
        assert ask(address, "/answer", Host=name)[0].status == 403
        assert ask(address, "/scene", b"", Host=name)[0].status == 403


def test_only_its_own_page_may_send_it_files(address: str) -> None:
    own = address.rstrip("/")
    assert ask(address, "/scene", GOOD.encode(), Origin=own)[0].status == 200
    for origin in ("http://example.org", "null", "https" + own[4:], "http://127.0.0.1:1", f"{own}.example.org"):
        assert ask(address, "/scene", GOOD.encode(), Origin=origin)[0].status == 403
        assert ask(address, "/answer", Origin=origin)[0].status == 403
    picture = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"}
    assert ask(address, "/answer", **picture)[0].status == 403
    assert ask(address, "/", **picture | {"Sec-Fetch-Mode": "navigate"})[0].status == 200  # a link to it


@pytest.mark.parametrize("length", ["x", "-5", "", "1e3", "٣", "1" * 5000 + "x", None])
def test_a_bad_length_is_a_bad_request(address: str, length: str | None) -> None:
    header = "" if length is None else f"Content-Length: {length}\r\n"
    with create_connection((urlsplit(address).hostname, urlsplit(address).port), 20) as connection:
        connection.sendall(f"POST /scene HTTP/1.1\r\nHost: 127.0.0.1\r\n{header}\r\n".encode())
        assert connection.recv(1000).startswith(b"HTTP/1.1 400 ")


def test_who_says_nothing_is_not_waited_for(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from symosc.plot.explorer import server

    monkeypatch.setattr(server._Handler, "timeout", 0.05)
    for said in (b"", b"GET / HT", b"POST /scene HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 9\r\n\r\nhalf"):
        with create_connection((urlsplit(address).hostname, urlsplit(address).port), 20) as connection:
            connection.sendall(said)
            assert connection.recv(1000).startswith(b"HTTP/1.1 408 " if said.startswith(b"POST") else b"")
            while connection.recv(1000):
                pass


def test_connections_without_a_request_keep_nobody_out(address: str) -> None:
    """Each has a thread: the oldest are closed."""
    where = (urlsplit(address).hostname, urlsplit(address).port)
    with ExitStack() as stack:
        idle = [stack.enter_context(create_connection(where, 20)) for _ in range(100)]
        assert ask(address, "/answer")[0].status == 200
        assert [connection.recv(1) for connection in idle[:60]] == [b""] * 60


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
    assert found.get(timeout=PATIENCE)


def test_a_scene_file_goes_out_and_comes_in(address: str) -> None:
    response, text = ask(address, f"/scene.toml?{link_of(state_of(load_scene('fig9-orbit')))}")
    assert "attachment" in response.headers["Content-Disposition"]
    assert read_scene(text, "file") == load_scene("fig9-orbit")
    _, back = ask(address, "/scene", text.encode())
    assert json.loads(back)["state"] == state_of(load_scene("fig9-orbit"))
    for wrong in ("x", "%CF%80", "%0D%0AX:1"):
        assert ask(address, f"/scene.toml?k={wrong}")[0].status == 400


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
