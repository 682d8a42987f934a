"""The second opinion on motions: it agrees with right ones, and finds out wrong ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symosc import find_orbit, load_scene, simulate
from symosc.paper.checks import contacts, flown_again, stick_figures
from symosc.paper.checks.flown_again import FlownPiece, Opinion, fly_again, stretches_of, stretches_of_orbit
from symosc.paper.evidence import CONFIRMED, UNDECIDED
from symosc.simulation.trajectory import Trajectory


def stretches(name: str) -> tuple[Any, list[FlownPiece]]:
    motion = simulate(load_scene(name))
    return motion.parameters, stretches_of(motion)


@pytest.mark.parametrize("name", ["fig5", "fig6", "fig7", "fig7-exact", "fig8-exact", "fig9", "fig10"])
def test_it_agrees_with_motions(name: str) -> None:
    p, motion = stretches(name)
    opinion = fly_again(p, motion)
    assert opinion.agrees
    assert opinion.stretches == len(motion)
    assert opinion.difference < 1e-11


@pytest.mark.parametrize("name", ["fig9", "fig10"])
def test_it_agrees_with_orbits(name: str) -> None:
    scene = load_scene(name)
    orbit = find_orbit(scene.parameters, scene.structure)
    assert fly_again(scene.parameters, stretches_of_orbit(orbit)).agrees


def test_a_wrong_place_is_found_out() -> None:
    p, motion = stretches("fig10")
    t, x, v = motion[2].end
    motion[2] = motion[2]._replace(end=(t + 1e-7, x, v))
    assert fly_again(p, motion).difference > 1e-9


def test_a_missed_contact_is_found_out() -> None:
    p, motion = stretches("fig9")
    long = motion[0].start[0] + 2 * motion[0].end[0]
    t = np.array([long])
    x, v = flown_again.flow(p, p.A(motion[0].where), motion[0].start, t)
    one = FlownPiece(motion[0].where, motion[0].start, (long, float(x[0]), float(v[0])))
    assert fly_again(p, [one]).outside == 1


def test_a_wrong_mode_is_found_out() -> None:
    p, motion = stretches("fig5")
    at = next(i for i, each in enumerate(motion) if each.where == -1)
    assert fly_again(p, motion[: at + 1]).agrees
    motion[at] = motion[at]._replace(where=1)
    assert fly_again(p, motion[: at + 1]).otherwise == 1
    stuck = motion[at]._replace(where=-1, end=(motion[at].end[0] + 1, motion[at].end[1] + 1, motion[at].end[2]))
    assert fly_again(p, [stuck]).outside == 1  # it sticks for too long


def test_a_claim_whose_motion_is_not_confirmed_is_not_decided(monkeypatch: pytest.MonkeyPatch) -> None:
    assert stick_figures.fig5_onset().verdict == CONFIRMED
    count = len(contacts.motion(load_scene("fig5")).segments)
    told = stick_figures.fig5_onset().numbers["flown again in another closed form"]
    assert told.startswith(f"{count} stretches, ")
    monkeypatch.setattr(flown_again, "fly_again", lambda *_: Opinion(3, 1e-3))
    evidence = stick_figures.fig5_onset()
    assert evidence.verdict == UNDECIDED
    assert evidence.finding.startswith("Two ways do not agree (3 stretches, largest relative difference 0.001)")


def test_motions_are_recorded_only_meanwhile() -> None:
    scene = load_scene("fig6")
    with contacts.recording() as outer, contacts.recording() as inner:
        contacts.motion(scene)
    contacts.motion(scene)
    assert [type(each) for each in inner] == [type(each) for each in outer] == [Trajectory]
