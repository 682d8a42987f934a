"""symosc figure, and figures on standard output."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_runs import good

import symosc


@pytest.mark.slow
def test_figure_writes_the_file_and_says_what_it_shows(tmp_path: Path) -> None:
    path = tmp_path / "fig5.pdf"
    assert good("figure", "fig5", "-o", str(path)) == f"{path}: t = 0 to 9, 6 events\n"
    assert path.read_bytes().startswith(b"%PDF-")
    assert "t = 0 to 3," in good("figure", "fig5", "-o", str(path), "--t-end", "3", "--panels", "c", "--columns", "1")


@pytest.mark.slow
def test_a_figure_to_standard_output_is_svg(tmp_path: Path) -> None:
    path = tmp_path / "fig6.svg"
    good("figure", "fig6", "-o", str(path), "--panels", "a")
    assert good("figure", "fig6", "-o", "-", "--panels", "a") == path.read_text()


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ["orbit", "fig9", "-o"],
        ["grazing", "fig9", "--map", "P2", "--plot"],
        ["check", "s.csv", "--scene", "fig6", "--partial", "-o"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_the_figures_of_other_commands_go_there_too(
    arguments: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    trajectory = symosc.simulate("fig6", t_end=5)
    rows = [f"{t},{x!r},{v!r}" for t in (n / 64 for n in range(321)) for x, v in [trajectory(t).tolist()]]
    Path("s.csv").write_text("\n".join(["t,x,v", *rows]))
    text = good(*arguments, "-")
    assert text.startswith("<?xml")
    assert text.endswith("</svg>\n")
    assert [path.name for path in tmp_path.iterdir()] == ["s.csv"]
