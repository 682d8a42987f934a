"""What Section 7 says of periodic motions: are the printed equations conditions of them?"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from symosc.mappings.equations import jacobian, residual
from symosc.paper.checks.contacts import contacts, lowered, motion, number, start_contact, text, verdict
from symosc.paper.checks.flown_again import flown_again
from symosc.paper.checks.periodic_figures import no_orbit, orbit_of
from symosc.paper.evidence import Evidence
from symosc.scenes import Scene, load_scene


@flown_again
def conditions_of_orbits() -> Evidence:
    """Check whether the printed equations are conditions of a periodic motion."""
    return closing_conditions(load_scene("fig9"))


def closing_conditions(scene: Scene, closed: bool = False) -> Evidence:
    """Count what (54) leaves open on the orbit of a scene, and try it on the motion from the printed start.

    `closed` adds the closing conditions, that the orbit ends where it starts, one period later; (54) lacks them.
    """
    found, p = orbit_of(scene), scene.parameters
    if found is None:
        return no_orbit(scene)
    Omega, count = number(p, p.Omega), len(found.labels)
    points = [(point.x, Omega * point.t) for point in found.points]
    points.append((points[0][0], points[0][1] + Omega * found.period))
    rows = np.zeros((2 * count + 2, 2 * count + 2))
    for i, label in enumerate(found.labels):
        rows[2 * i : 2 * i + 2, 2 * i : 2 * i + 4] = jacobian(p, label, points[i], points[i + 1]).astype(float)
    rows[2 * count :, :2], rows[2 * count :, -2:] = -np.eye(2), np.eye(2)
    printed = rows if closed else rows[: 2 * count]
    rank, full = (int(np.linalg.matrix_rank(matrix)) for matrix in (printed, rows))
    free = printed.shape[1] - rank
    at = [start_contact(scene, motion(scene).events[0].boundary), *contacts(scene)[:count]]
    off = [
        max(map(abs, residual(p, label, (a.x, Omega * a.t), (b.x, Omega * b.t))))
        for label, (a, b) in zip(found.labels, pairwise(at), strict=True)
    ]
    numbers = {
        f"unknowns and equations of (54) for {lowered(found.word)}": f"{printed.shape[1]}, {printed.shape[0]}",
        "rank of its Jacobian at the orbit": str(rank),
        "rank with the closing conditions": str(full),
        "largest residual of (54) on the motion from the printed start": text(max(off), 2),
        "x at the end of that motion's first round minus x₀": text(at[-1].x - at[0].x, 10),
    }
    if not free:
        return Evidence(verdict(True), "The printed equations determine the orbit.", numbers)
    finding = (
        f"(54) leaves {free} of {printed.shape[1]} unknowns open. The motion from the printed start of Fig. "
        f"{scene.name.removeprefix('fig')} fulfils it, and is not periodic"
    )
    return Evidence(verdict(False, full == rows.shape[1]), f"{finding}.", numbers)
