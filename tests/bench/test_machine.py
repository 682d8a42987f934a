"""What is said of the machine."""

from __future__ import annotations

from symosc.bench.machine import machine, sentence


def test_machine_names_the_versions() -> None:
    about = machine()
    assert {"processor", "cores", "date", "symosc", "python", "numpy", "heyoka"} <= set(about)
    assert all(about.values())
    assert f"numpy {about['numpy']}" in sentence(about)
