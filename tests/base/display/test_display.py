"""Progress: bars with rate and time left on a terminal, or what a function of the caller gets."""

from __future__ import annotations

from symosc.base.display.progress import late_bar, reporting

# --- progress ---


def test_a_function_of_the_caller_gets_the_progress() -> None:
    calls: list[tuple[float, float]] = []

    def note(done: float, total: float) -> None:
        calls.append((done, total))

    with reporting(note, 0, 9) as report, late_bar(note, "simulate", "events") as advance:
        report(4, 9)
        assert advance is not None
        advance(0.5, 7)
    assert calls == [(4, 9), (0.5, 1.0)]
