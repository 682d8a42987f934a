"""Small campaigns of random friction laws, and checks of their judge.

Larger ones: python tests/support/law_fuzz.py --scenes 5000 --seed 1
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import law_fuzz
import pytest
from law_families import CURVES, FAMILIES, STATIC, scene_of, with_changes
from law_oracle import Motion
from samples import sample_of

SEED = 1
CAUGHT_WITHIN = 30  # scenes of a family that shows the mistake


@sample_of(1, 60)
@pytest.mark.parametrize("family", STATIC | CURVES)
def test_random_laws(family: str, count: int) -> None:
    for number in range(count):
        verdict = law_fuzz.verdict_of(scene_of(family, SEED, number, 3), ["simulate", "digits"])
        assert not verdict.faults, law_fuzz.report(verdict, SEED)


@pytest.mark.full(8)
@pytest.mark.parametrize("family", FAMILIES)
def test_the_oracle_with_other_digits_is_found_right(family: str) -> None:
    verdict = law_fuzz.verdict_of(scene_of(family, SEED, 1, 3), ["oracle"])
    assert not verdict.faults, law_fuzz.report(verdict, SEED)


# -- mistakes that a solver may make ---------------------------------------------------------------


class ArrivesAtKinetic(Motion):
    """Filippov's rule: a flight crosses where kinetic friction would not hold."""

    def settle(self, edge: int) -> None:
        kept = self.E[edge]
        self.E[edge] = 0 * kept
        super().settle(edge)
        self.E[edge] = kept


class SlipsAtKinetic(Motion):
    """A stick ends where the force exceeds the kinetic friction."""

    def slide(self) -> bool:
        edge = self.stuck
        kept = self.E[edge]
        self.E[edge] = 0 * kept
        left = super().slide()
        self.E[edge] = kept
        return left


class NeverHoldsAtEquality(Motion):
    """At equality the mass leaves."""

    def tendency(self, edge: int) -> int:
        return 1


class MissesTouches(Motion):
    """A distance of zero is none."""

    def sign(self, value: Any, scale: Any, what: str) -> int:
        found = super().sign(value, scale, what)
        if found == 0 and "distance" in what:
            return -1
        return found


class LeavesAtTurns(Motion):
    """A force that only touches the static limit ends the stick."""

    def sign(self, value: Any, scale: Any, what: str) -> int:
        found = super().sign(value, scale, what)
        if found == 0 and "turn" in what:
            return 1 if "above" in what else -1
        return found


@pytest.mark.parametrize(
    ("mistake", "family"),
    [
        (ArrivesAtKinetic, "plain"),
        (SlipsAtKinetic, "plain"),
        (NeverHoldsAtEquality, "arriving"),
        (NeverHoldsAtEquality, "held"),
        (MissesTouches, "touching"),
        (LeavesAtTurns, "resting"),
    ],
)
def test_a_mistake_is_found(mistake: type[Motion], family: str) -> None:
    scenes = (scene_of(family, SEED, number) for number in range(CAUGHT_WITHIN))
    assert any(law_fuzz.stand_in(scene, motion=mistake).faults for scene in scenes)


def answers(family: str, number: int) -> tuple[Any, list[SimpleNamespace], str]:
    scene = scene_of(family, SEED, number)
    run = scene.truth(50)
    events = [
        SimpleNamespace(**event._asdict(), t_error=1e-13, x_error=1e-13) for event in run.events
    ]
    return scene, events, run.status


def test_each_fault_has_its_name() -> None:
    scene, events, status = answers("plain", 2)
    assert len(events) > 4
    assert not law_fuzz.compare(scene, events, status).faults

    def faults(changed: list[SimpleNamespace], said: str = status, **more: Any) -> list[str]:
        return [fault for fault, _ in law_fuzz.compare(scene, changed, said, **more).faults]

    def with_event(number: int, **changes: Any) -> list[SimpleNamespace]:
        event = SimpleNamespace(**(vars(events[number]) | changes))
        return [*events[:number], event, *events[number + 1 :]]

    assert faults(events[:2] + events[3:]) == ["missed"]
    assert faults(events[:-1]) == ["missed"]
    early = SimpleNamespace(**(vars(events[2]) | {"t": (events[1].t + events[2].t) / 2}))
    assert faults([*events[:2], early, *events[2:]]) == ["invented"]
    assert faults(with_event(2, kind="graze")) == ["wrong kind"]
    assert faults(with_event(2, boundary=3)) == ["wrong kind"]
    assert faults(with_event(2, t=events[2].t + 1e-11)) == ["estimate"]
    assert faults(with_event(2, x=events[2].x + 1e-11), accuracy=1e-12) == ["digits"]
    assert faults(events, "equilibrium" if status == "max_events" else "max_events") == ["status"]
    assert faults(events[:3], "undecidable") == ["undecidable"]


def test_the_end_is_compared() -> None:
    scene, events, status = answers("plain", 3)
    run = scene.truth(50)
    assert status == "t_end"
    ends = [(run.x, run.v), (run.x + 1e-4, run.v), (run.x, run.v - 1e-4)]
    verdicts = [law_fuzz.compare(scene, events, status, end=end) for end in ends]
    assert [len(verdict.faults) for verdict in verdicts] == [0, 1, 1]


def test_undecidable_is_an_answer_at_a_tie() -> None:
    scene = next(
        scene
        for scene in (scene_of("touching", SEED, number) for number in range(30))
        if any(event.tie for event in scene.truth(50).events)
    )
    verdict = law_fuzz.compare(with_changes(scene, near=False), [], "undecidable")
    assert verdict.doubt
    assert not verdict.faults


def test_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert law_fuzz.main(["--scenes", "3", "--solver", "oracle", "--curves"]) == 0
    assert "0 of 3 scenes failed" in capsys.readouterr().out
    assert list(CURVES) == ["curved", "cornered", "brushing"]
