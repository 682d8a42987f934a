"""One run over everything: claims judged, pictures drawn, derivations checked, in worker processes.

The processes are spawned, not forked: it is the one way that works alike on every system, and numerical libraries keep
threads that do not survive a fork.
"""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable, Generator, Mapping
from concurrent.futures import Future, as_completed
from concurrent.futures import TimeoutError as Overdue
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

from matplotlib.figure import Figure
from pebble import ProcessExpired, ProcessPool

from symosc.derive.errata import Erratum
from symosc.errors import ParameterError
from symosc.paper.claims import FAULTY, Claim, Unjudged
from symosc.paper.evidence import VERDICTS, Evidence
from symosc.paper.pictures import Picture

Key = tuple[str, str]
Tasks = dict[Key, Callable[[], Any]]
#: Verdict of a check that raised, hung or died.
ERROR = "error"
#: Seconds after which a task counts as hanging; the longest takes one minute on a usual machine.
TASK_LIMIT = 3600.0
#: How many pools of processes are tried. One in which a process dies while it takes its task may break down whole.
POOLS = 3


@dataclass(frozen=True)
class Done:
    """What became of a task: its value, or the error that it ended with; and the processor time that it took."""

    value: Any = None
    error: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Plan:
    """What to do.

    Attributes
    ----------
    claims : tuple of Claim
    pictures : dict of str to Picture
    chapters : tuple of str, optional
        Subjects of the derivations; None: those that the claims refer to.
    errata : tuple of Erratum, optional
        Those that the claims show.
    unjudged : tuple of Unjudged, optional
        What of the paper gets no verdict; None if the claims are a part of all.
    """

    claims: tuple[Claim, ...]
    pictures: Mapping[str, Picture]
    chapters: tuple[str, ...] | None = None
    errata: tuple[Erratum, ...] = ()
    unjudged: tuple[Unjudged, ...] | None = None

    @property
    def subjects(self) -> tuple[str, ...]:
        """Subjects of the derivations."""
        if self.chapters is not None:
            return self.chapters
        return tuple(dict.fromkeys(claim.derivation for claim in self.claims if claim.derivation))

    def __len__(self) -> int:
        return len(self.claims) + len(self.pictures) + len(self.subjects)

    def only(self, prefix: str) -> Plan:
        """Return the part of it whose claims' ids begin with `prefix`, with the pictures that they refer to.

        Derivations are left out: one chapter may take as long as all claims together.

        Raises
        ------
        ParameterError
            If there is no such claim.
        """
        claims = tuple(claim for claim in self.claims if prefix and claim.id.startswith(prefix))
        if not claims:
            heads = dict.fromkeys(claim.id.partition("-")[0] for claim in self.claims)
            raise ParameterError("only", prefix, f"no claim's id begins so; ids begin with {', '.join(heads)}")
        cited = {key for claim in claims for key in claim.figures}
        shown = {key for claim in claims for key in claim.errata}
        return Plan(
            claims,
            {key: picture for key, picture in self.pictures.items() if key in cited},
            chapters=(),
            errata=tuple(erratum for erratum in self.errata if erratum.id in shown),
        )


@dataclass(frozen=True)
class Judged:
    """A claim and what its check found.

    Attributes
    ----------
    claim : Claim
    verdict : str
        One of VERDICTS, or ERROR.
    finding : str
        What was found, or what went wrong.
    numbers : dict of str to str
    seconds : float
    """

    claim: Claim
    verdict: str
    finding: str
    numbers: dict[str, str]
    seconds: float

    @property
    def changed(self) -> bool:
        """Whether the verdict is not the committed one."""
        return self.verdict != self.claim.verdict


@dataclass(frozen=True)
class Drawn:
    """A picture's file, its caption, and what a phone shows in place of it, if that is another file."""

    svg: str
    caption: str
    narrow: str = ""


@dataclass(frozen=True)
class Chapter:
    """Derivations on one subject; each step was checked."""

    name: str
    number: int
    steps: int
    html: str


@dataclass(frozen=True)
class Results:
    """What a run found.

    Attributes
    ----------
    judged : tuple of Judged
    pictures : dict of str to Picture
    drawn : dict of str to Done
        With a Drawn each, by the picture's key.
    chapters : dict of str to Done
        With a Chapter each, by its subject.
    seconds : float
        How long all of it took.
    errata, unjudged
        As in the plan.
    """

    judged: tuple[Judged, ...]
    pictures: Mapping[str, Picture]
    drawn: Mapping[str, Done]
    chapters: Mapping[str, Done]
    seconds: float = field(default=0.0)
    errata: tuple[Erratum, ...] = ()
    unjudged: tuple[Unjudged, ...] | None = None

    def shown_by(self, erratum: Erratum) -> tuple[Judged, ...]:
        """Return the claims that show an erratum in this run."""
        return tuple(each for each in self.judged if erratum.id in each.claim.errata and each.verdict in FAULTY)

    @property
    def counts(self) -> dict[str, int]:
        """How many claims got each verdict."""
        verdicts = [each.verdict for each in self.judged]
        return {
            verdict: verdicts.count(verdict) for verdict in (*VERDICTS, ERROR) if verdict != ERROR or ERROR in verdicts
        }

    @property
    def changed(self) -> tuple[Judged, ...]:
        """Claims whose verdict is not the committed one."""
        return tuple(each for each in self.judged if each.changed)

    @property
    def failures(self) -> dict[str, str]:
        """Pictures and derivations that failed, and why."""
        return {key: done.error for key, done in {**self.drawn, **self.chapters}.items() if done.error}

    @property
    def ok(self) -> bool:
        """Whether every verdict is the committed one and nothing failed."""
        return not self.changed and not self.failures


def run(plan: Plan, progress: Callable[[], None] | None = None, workers: int | None = None) -> Results:
    """Do everything in a plan.

    Parameters
    ----------
    plan : Plan
    progress : callable, optional
        Called after each task.
    workers : int, optional
        How many processes; default: one per processor. 0: none, everything is done in this one, without time limits.
    """
    begin = perf_counter()
    # The longest first (chapters, and the searches, which are among the last claims), so that no worker is left alone
    # with one.
    tasks: Tasks = {}
    tasks |= {("chapter", subject): partial(derive, subject) for subject in plan.subjects}
    tasks |= {("claim", claim.id): partial(judge, claim.check) for claim in reversed(plan.claims)}
    tasks |= {("picture", key): partial(draw, picture) for key, picture in plan.pictures.items()}
    done = {}
    with closing(_done_here(tasks) if workers == 0 else _in_parallel(tasks, workers or _processors())) as outcomes:
        for key, outcome in outcomes:
            done[key] = outcome
            if progress:
                progress()
    return Results(
        judged=tuple(_judged(claim, done["claim", claim.id]) for claim in plan.claims),
        pictures=plan.pictures,
        drawn={key: done["picture", key] for key in plan.pictures},
        chapters={subject: done["chapter", subject] for subject in plan.subjects},
        seconds=perf_counter() - begin,
        errata=plan.errata,
        unjudged=plan.unjudged,
    )


def _processors() -> int:
    affinity = getattr(os, "sched_getaffinity", None)  # not on every system
    return len(affinity(0)) if affinity else os.cpu_count() or 1


def _done_here(tasks: Tasks) -> Generator[tuple[Key, Done], None, None]:
    yield from ((key, timed(task)) for key, task in tasks.items())


def _in_parallel(tasks: Tasks, workers: int) -> Generator[tuple[Key, Done], None, None]:
    for _ in range(POOLS):
        left: Tasks = {}
        for key, outcome in _in_a_pool(tasks, workers):
            if outcome is None:
                left[key] = tasks[key]
            else:
                yield key, outcome
        if not left:
            return
        tasks = left
    yield from ((key, Done(error=f"the pool of processes broke down, {POOLS} times")) for key in tasks)


def _in_a_pool(tasks: Tasks, workers: int) -> Generator[tuple[Key, Done | None], None, None]:
    """Yield what became of each task; None if the pool broke down before it."""
    pool = ProcessPool(max_workers=max(1, min(workers, len(tasks))), context=get_context("spawn"))
    try:
        futures = {_scheduled(pool, task): key for key, task in tasks.items()}
        for future in as_completed(futures):
            yield futures[future], _outcome(future)
    finally:
        pool.stop()  # nothing is left to do, or the user has interrupted it
        pool.join()


def _scheduled(pool: ProcessPool, task: Callable[[], Any]) -> Future[Done]:
    try:
        return pool.schedule(timed, args=(task,), timeout=TASK_LIMIT)
    except RuntimeError as error:  # the pool has already broken down
        future: Future[Done] = Future()
        future.set_exception(BrokenProcessPool(str(error)))
        return future


def _outcome(future: Future[Done]) -> Done | None:
    try:
        return future.result()
    except Overdue:
        return Done(error=f"no result within {TASK_LIMIT:g} s")
    except ProcessExpired as death:
        return Done(error=f"the process ended with exit code {death.exitcode}")
    except BrokenProcessPool:
        return None


def _judged(claim: Claim, done: Done) -> Judged:
    if done.error:
        return Judged(claim, ERROR, done.error, {}, done.seconds)
    return Judged(claim, done.value.verdict, done.value.finding, dict(done.value.numbers), done.seconds)


# --- what a worker does ---


def timed(task: Callable[[], Any]) -> Done:
    """Call a task; its error, if it raises one, is a result too."""
    begin = process_time()
    try:
        value, problem = task(), ""
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        value, problem = None, f"{type(error).__name__}: {error} ({Path(last.filename).name}, line {last.lineno})"
    return Done(value, problem, process_time() - begin)


def judge(check: Callable[[], Evidence]) -> Evidence:
    """Return the evidence of a check."""
    evidence = check()
    if not isinstance(evidence, Evidence):
        raise TypeError(f"{check.__name__} returned {type(evidence).__name__}, not Evidence")
    return evidence


def draw(picture: Picture) -> Drawn:
    """Return a picture as SVG, with its caption, whose numbers are computed as well."""
    return Drawn(_svg(picture.build), picture.caption, _svg(picture.narrow) if picture.narrow else "")


def _svg(build: Callable[[], Figure]) -> str:
    from symosc import plot

    with TemporaryDirectory() as scratch:
        return plot.save(build(), Path(scratch) / "picture.svg").read_text(encoding="utf-8")


def derive(subject: str) -> Chapter:
    """Return a chapter of derivations, checked."""
    from symosc.derive import document
    from symosc.derive.scope import Scope

    scope = Scope()
    chapter = document.check_chapter(subject, scope)
    html = document.as_html(chapter, scope, level=4)
    return Chapter(chapter.key, chapter.number, len(chapter.steps()), html)
