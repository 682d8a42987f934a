"""What pages of notebooks are made of."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from symosc import Belt, Oscillator, attractors, find_orbit
from symosc.plot.laws import _kinetic
from symosc.plot.notebooks import (
    HEAD_ROWS,
    TAIL_ROWS,
    friction_curve,
    page_of,
    rows_to_show,
    table,
)

STICK_SLIP = Oscillator(m=1, c="1/10", k=1, belts=[Belt("1/2", mu="1/2", mu_s=1)])
CURVED = Oscillator(
    m=1, c="1/2", k=1, A0=2, belts=[Belt(0, 1), Belt(2, curve=[(0, 1), (1, "1/2")], slope="1/3")]
)


@pytest.mark.parametrize("count", [1, 10, 11, 100_000])
def test_a_long_table_shows_its_ends(count: int) -> None:
    numbers = rows_to_show(count)
    root = ElementTree.fromstring(table(["i"], count, lambda i: [i]))
    cells = [cell.text or "" for cell in root.iter("td")]
    if count > HEAD_ROWS + TAIL_ROWS:
        assert cells.pop(HEAD_ROWS) == f"… {count - HEAD_ROWS - TAIL_ROWS:,} more"
        assert numbers == [*range(HEAD_ROWS), *range(count - TAIL_ROWS, count)]
    assert cells == [str(i) for i in numbers]
    assert len(numbers) == min(count, HEAD_ROWS + TAIL_ROWS)


def texts(of: object) -> list[str]:
    """Return the texts of a page."""
    found = page_of(of)
    assert found is not None
    return [part for part in ElementTree.fromstring(found).itertext() if part.strip()]


def test_the_page_of_an_oscillator_names_its_friction() -> None:
    assert {"1 belt, motions may move apart: several may attract"} < {
        text.strip() for text in texts(STICK_SLIP)
    }
    assert texts(STICK_SLIP)[2:10] == ["belt", "v", "kinetic μ", "static μ", "1", "0.5", "0.5", "1"]
    assert "curve of 2 points from 1" in texts(CURVED)


def test_its_picture_is_the_friction_force() -> None:
    """Against the figure, which has breaks at belts; static friction is a longer jump."""
    speeds, forces = friction_curve(CURVED)
    drawn = zip(*_kinetic(CURVED, speeds[0], speeds[-1]), strict=True)
    known = [pair for pair in drawn if pair[0] == pair[0]]
    assert sorted({*zip(speeds, forces, strict=True)}) == sorted({*known})
    assert forces[0] == pytest.approx(-1 - 1 / 2 - (3.5 - 1) / 3)
    speeds, forces = friction_curve(STICK_SLIP)
    at_belt = [force for speed, force in zip(speeds, forces, strict=True) if speed == 0.5]
    assert at_belt == [-0.5, -1, 1, 0.5]
    assert (forces[0], forces[-1]) == (-0.5, 0.5)


def test_the_pages_of_rests_and_cycles() -> None:
    cycle, rest = (find_orbit(STICK_SLIP, x0=0, v0=v0) for v0 in ("1/2", 0))
    assert "S1∘B1: a stable limit cycle" in " ".join(texts(cycle))
    assert rest.is_rest
    assert texts(rest)[1].strip() == rest.message
    assert "<svg" not in str(page_of(rest))


def test_the_page_of_attractors_has_their_shares() -> None:
    found = attractors(STICK_SLIP, {"x0": "-2:2:9", "v0": "-1:1:5"})
    assert {"cycle", "rest", "0.9111", "0.08889"} <= set(texts(found))
