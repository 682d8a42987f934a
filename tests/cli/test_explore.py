"""symosc explore: how it begins and ends; the page itself is tested in plot/explorer."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from urllib.request import urlopen

import pytest
from cli_runs import run
from effort import PATIENCE


@pytest.mark.slow
def test_it_serves_the_scene_and_ends_quietly() -> None:
    pytest.importorskip("bokeh")
    # An interrupt that a shell's background job ignores would be ignored by its children too.
    heard = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    begin = f"{heard}; from symosc.cli.app import main; main()"
    command = [sys.executable, "-c", begin, "explore", "fig9", "--set", "k=1/3", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        try:
            line = process.stdout.readline()
            assert line.startswith("http://127.0.0.1:")
            assert 'value="1/3"' in urlopen(line.split()[0], timeout=PATIENCE).read().decode()
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 130
            assert process.stderr.read() == ""
        finally:
            process.kill()


def test_a_port_in_use_is_one_line() -> None:
    pytest.importorskip("bokeh")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        result = run("explore", "--no-browser", "--port", str(taken.getsockname()[1]))
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "name another one" in result.stderr


@pytest.mark.parametrize("arguments", [("--port", "99999"), ("--port", "x"), ("nofig",), ("--set", "k=x"), ("a", "b")])
def test_bad_input_is_one_line(arguments: tuple[str, ...]) -> None:
    result = run("explore", "--no-browser", *arguments)
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)


def test_without_the_extra_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith(("bokeh", "symosc.plot.explorer"))]:
        monkeypatch.delitem(sys.modules, name)
    for name in ("bokeh", "bokeh.embed", "bokeh.models", "bokeh.plotting", "bokeh.settings"):
        monkeypatch.setitem(sys.modules, name, None)
    result = run("explore", "--no-browser")
    assert result.exit_code == 2
    assert result.stderr == "symosc: error: explore needs an optional package: pip install 'symosc[explore]'\n"


def test_the_browser_is_opened_unless_told_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("bokeh")
    from symosc.plot.explorer import server

    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr(server.ExplorerServer, "serve_forever", lambda self: None)
    assert run("explore", "--port", "0").exit_code == 0
    assert run("explore", "--port", "0", "--no-browser").exit_code == 0
    assert len(opened) == 1
    assert opened[0].startswith("http://127.0.0.1:")
