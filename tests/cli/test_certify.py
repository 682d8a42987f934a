"""`symosc certify` and `symosc verify`."""

from __future__ import annotations

from pathlib import Path

from cli_runs import good, run


def test_a_branch_is_verified(tmp_path: Path) -> None:
    path = tmp_path / "branch.json"
    good("certify", "fig9", "--branch", "Omega=3.99:4.01", "-o", str(path))
    assert good("verify", str(path)).startswith(
        "proven: an orbit P32 for every Omega from 3.99 to 4.01, "
    )


def test_what_is_not_proven_is_one_line_and_exit_code_1(tmp_path: Path) -> None:
    path = tmp_path / "open.json"
    result = run("certify", "fig10-orbit", "-o", str(path))
    assert result.exit_code == 1
    assert result.stderr.startswith(
        "symosc: not proven: not confirmed by the checker: not proven: F on the belt at the start, "
        "after 0 events, from t = 0.44"
    )
    assert len(result.stderr.splitlines()) == 1
    assert run("verify", str(path)).exit_code == 1


def test_a_false_file_and_no_certificate(tmp_path: Path) -> None:
    path = tmp_path / "it.json"
    path.write_text(
        good("certify", "fig6", "-o", "-").replace('"cross"', '"stick"').replace("belt2", "belt1")
    )
    result = run("verify", str(path))
    assert (result.exit_code, result.stdout, len(result.stderr.splitlines())) == (1, "", 1)
    for content in ("", "[]", "{}", "nonsense"):
        path.write_text(content)
        result = run("verify", str(path))
        assert (result.exit_code, result.stdout, len(result.stderr.splitlines())) == (2, "", 1)
    assert run("verify", str(tmp_path / "none.json")).exit_code == 2
