"""The list of orbits that ships, how it was made, and the proof of it."""

from __future__ import annotations

import itertools

import pytest

from symosc.certificates.collect import collect
from symosc.certificates.orbit_list import listed_orbits, prove_list, prove_listed, summary, verify_list, written

REGIMES = {"underdamped", "overdamped", "critically damped", "undamped"}


def test_there_are_many_of_all_kinds() -> None:
    orbits = listed_orbits()
    assert len({orbit.p for orbit in orbits}) == len(orbits) >= 1000
    assert len({orbit.cycle for orbit in orbits}) >= 20
    assert min(sum(orbit.regime == regime for orbit in orbits) for regime in REGIMES) >= 200


def test_a_sample_is_proven() -> None:
    orbits = listed_orbits()[::60]
    proofs = [prove_listed(orbit) for orbit in orbits]
    assert [proof.message for proof in proofs if not proof.proven] == []
    assert all(proof.stable for orbit, proof in zip(orbits, proofs, strict=True) if orbit.p.c > 0)


def test_an_orbit_that_is_not_there_is_named() -> None:
    orbit = listed_orbits()[0]
    wrong = orbit._replace(p=orbit.p.replace(B0=orbit.p.B0 / 100))
    answers = ["" if prove_listed(each).proven else "open" for each in (orbit, wrong)]
    assert answers == ["", "open"]
    done = summary([orbit, wrong], answers)
    assert (done.orbits, done.regimes, done.words, done.open) == (1, {orbit.regime: 1}, 1, ("open",))


def test_the_seed_gives_the_list() -> None:
    assert [written(orbit) for orbit in itertools.islice(collect(3, 17), 3)] == [
        written(o) for o in listed_orbits()[:3]
    ]


@pytest.mark.slow
def test_processes_prove_their_files_again() -> None:
    orbits = [*listed_orbits()[:30], listed_orbits()[0]._replace(x=99.0)]
    answers = verify_list(orbits, workers=2)
    assert answers[:30] == [""] * 30
    assert orbits[-1].word in answers[-1]
    assert "not proven" in answers[-1]


@pytest.mark.slow
def test_processes_prove_it() -> None:
    done = prove_list(listed_orbits()[:60], workers=2)
    assert (done.orbits, done.open) == (60, ())
