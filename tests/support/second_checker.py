"""The second checker (second_checker.cpp).

Certificates of trajectories and orbits, proven by other mathematics.

It reads numbers as words, so that no code of this project reads them for it but the few lines
below.
"""

from __future__ import annotations

import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

from programs import built

NAMES = ("m", "c", "k", "A0", "B0", "Omega", "FN")
STARTS = ("t0", "x0", "v0")
UNDECIDED = 3  # the exit code that asks for more bits


def program() -> Path | None:
    """Return the compiled checker, or None where there is no compiler or no GMP."""
    return built(Path(__file__).with_suffix(".cpp"), "-std=c++20", "-lgmpxx", "-lgmp")


def words(data: dict[str, Any]) -> str:
    """Return what the checker reads of a certificate."""
    p = data["parameters"]
    belts = p.get("belts") or [
        {"v": p[f"v{n}"], "slope": 0, "mu_s": p[f"mu{n}"], "curve": [[0, p[f"mu{n}"]]]}
        for n in (1, 2)
    ]
    domains = [f"Omega{n + 1}" for n in range(len(belts) + 1)]
    modes = ["", *domains, *(f"belt{n + 1}" for n in range(len(belts)))]
    found = [data["kind"], *(p[name] for name in NAMES), len(belts)]
    for belt in belts:
        found += [belt[name] for name in ("v", "slope", "mu_s")]
        found += [len(belt["curve"]), *(number for point in belt["curve"] for number in point)]
    if data["kind"] == "trajectory":
        found += [*(data["start"][name] for name in STARTS), *data["start_error"], data["t_end"]]
        if data["starts"] == "some":
            free = data["free"]
        else:
            free = {"name": None, "low": 0, "high": 0}
        found += [
            STARTS.index(free["name"]) if free["name"] else -1,
            free["low"],
            free["high"],
            modes.index(data["mode"]),
        ]
    else:
        found += [data["periods"], *data["alone_within"]]
        found += [end for each in data["multipliers"] for end in (*each["re"], *each["im"])]
        found.append({True: 1, False: 0, None: -1}[data["stable"]])
    found.append(len(data["events"]))
    for row in data["events"]:
        found += [
            row["kind"],
            row["boundary"],
            modes.index(row["source"]),
            modes.index(row["target"]),
        ]
        found += [*row["t"], *row["x"], row.get("reach", 0)]
    kinds = {"trajectory", "orbit", "stick", "slip", "cross", "graze", "corner"}
    return " ".join(str(word if word in kinds else Fraction(word)) for word in found)


def second_opinion(data: dict[str, Any], most_bits: int = 512) -> str:
    """Return "proven", or why the second checker does not confirm a certificate."""
    text = words(data)
    bits = 256
    while True:
        done = subprocess.run(
            [str(program())], input=f"{bits} {text}", capture_output=True, text=True
        )
        if done.returncode != UNDECIDED or bits >= most_bits:
            return done.stdout.strip() or f"exit code {done.returncode}"
        bits *= 2
