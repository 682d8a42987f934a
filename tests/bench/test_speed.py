"""What the speed section says, and what a looser accuracy saves."""

from __future__ import annotations

from bench_work import SPEED

from symosc.bench import results, speed
from symosc.bench.ours import SOLVERS as OURS

# --- time limit ---


# --- machine and README ---


def test_what_a_looser_accuracy_saves_is_said() -> None:
    times = {("fig5", 1e-9): 0.2, ("fig5", 1e-13): 0.2, ("fig8", 1e-9): 8, ("fig8", 1e-13): 2000}
    rows = [
        {"scene": scene, "solver": OURS[0].name, "tolerance": tolerance, "us_per_event": time, "error": 2e-12}
        for (scene, tolerance), time in times.items()
    ]
    assert results.looser({"rows": rows}).splitlines() == [
        "Where doubles cannot keep errors below 1e-13, more digits are taken, which cost time:",
        "fig8 takes 2000 µs per event with an error of 2e-12, and with",
        "`accuracy=1e-09` 8 µs with 2e-12.",
    ]
    assert results.looser({"rows": rows[:2]}) == ""


def test_the_speed_section_has_the_numbers() -> None:
    text = speed.section(SPEED)
    assert "| fig5" in text
    assert "9.1" in text
    assert "200,000 events" in text
    assert "4.2 (1.1) times as fast" in text
