"""One run of all checks: claims judged, pictures drawn, derivations checked, in worker processes.

The processes are spawned, not forked: it is the one way that works alike on every system, and
numerical libraries keep threads that do not survive a fork.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Generator, Mapping
from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, suppress
from dataclasses import dataclass
from functools import partial
from math import ceil
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any, NamedTuple

from matplotlib.figure import Figure
from pebble import ProcessExpired, ProcessPool

from symosc.base.errors import ParameterError
from symosc.derive.errata import Erratum
from symosc.paper.checks.motions import judge
from symosc.paper.claims import FAULTY, VERDICTS, Claim, Unjudged
from symosc.paper.pictures import Picture
from symosc.simulation.batch import read_workers

Tasks = dict[tuple[str, str], Callable[[], Any]]
#: Verdict of a check that raised, hung or died.
ERROR = "error"
#: Seconds after which a task counts as hanging; the longest takes one minute on a usual machine.
TASK_LIMIT = 3600.0
#: Seconds of processor time that the parts of the whole report take on average (AMD EPYC, November
#: 2026; `report.json` has those of each part), and seconds until two processes have begun.
SECONDS_PER_CLAIM = 0.3
SECONDS_PER_PICTURE = 1.4
SECONDS_PER_CHAPTER = 3.1
SECONDS_TO_BEGIN = 4.0
#: How many pools of processes are tried. One in which a process dies while it takes its task may
#: break down whole.
POOLS = 3


class Done(NamedTuple):
    """The result of a task: its value, or its error as text; and the seconds of processor time that
    it took.
    """

    value: Any = None
    error: str = ""
    seconds: float = 0.0


class Drawn(NamedTuple):
    """A picture as SVG text, its caption, and SVG text for phones; if that is "", the first one
    serves for both.
    """

    svg: str
    caption: str
    narrow: str = ""


@dataclass(frozen=True)
class Plan:
    """What a run does: the claims, pictures by key, chapters of the derivations, and the errata
    that claims show.
    """

    claims: tuple[Claim, ...]
    pictures: Mapping[str, Picture]
    chapters: tuple[str, ...] = ()
    errata: tuple[Erratum, ...] = ()
    # the parts of the paper without a verdict; None if the claims are not all
    unjudged: tuple[Unjudged, ...] | None = None

    def __len__(self) -> int:
        return len(self.claims) + len(self.pictures) + len(self.chapters)

    @property
    def about(self) -> str:
        """What a run does, and about how long that takes on two cores, as a sentence."""
        work = [
            f"{verb} {count} {one if count == 1 else many}"
            for verb, count, one, many in (
                ("judges", len(self.claims), "claim", "claims"),
                ("draws", len(self.pictures), "figure", "figures"),
                ("checks", len(self.chapters), "chapter", "chapters of derivations"),
            )
            if count
        ]
        seconds = SECONDS_TO_BEGIN + SECONDS_PER_CLAIM * len(self.claims) / 2
        seconds += SECONDS_PER_PICTURE * len(self.pictures) / 2
        seconds += SECONDS_PER_CHAPTER * len(self.chapters) / 2
        if seconds < 50:
            time = f"{5 * ceil(seconds / 5)} seconds"
        else:
            minutes = round(seconds / 60)
            time = "a minute" if minutes == 1 else f"{minutes} minutes"
        return f"{', '.join(work)}; takes about {time} on two cores"

    def only(self, prefix: str) -> Plan:
        """Return the plan for the claims whose ids begin with `prefix`, and their pictures; without
        derivations.
        """
        claims = tuple(claim for claim in self.claims if prefix and claim.id.startswith(prefix))
        if not claims:
            heads = dict.fromkeys(claim.id.partition("-")[0] for claim in self.claims)
            raise ParameterError(
                "only", prefix, f"no claim's id begins so; ids begin with {', '.join(heads)}"
            )
        cited = {key for claim in claims for key in (*claim.figures, *claim.errata)}
        pictures = {key: picture for key, picture in self.pictures.items() if key in cited}
        return Plan(
            claims,
            pictures,
            errata=tuple(erratum for erratum in self.errata if erratum.id in cited),
        )


class Judged(NamedTuple):
    """A claim and the result of its check: a verdict (or ERROR), the finding (or the error), and
    the numbers.
    """

    claim: Claim
    verdict: str
    finding: str
    numbers: dict[str, str]
    seconds: float


@dataclass(frozen=True)
class Results:
    """The results of a run: judged claims, pictures (each value a Drawn), and chapters (number of
    steps, HTML).
    """

    plan: Plan
    judged: tuple[Judged, ...]
    drawn: Mapping[str, Done]
    chapters: Mapping[str, Done]
    seconds: float = 0.0

    def shown_by(self, erratum: Erratum) -> list[str]:
        """Return the ids of the claims that show an erratum in this run."""
        return [
            result.claim.id
            for result in self.judged
            if erratum.id in result.claim.errata and result.verdict in FAULTY
        ]

    @property
    def counts(self) -> dict[str, int]:
        """How many claims got each verdict."""
        verdicts = [result.verdict for result in self.judged]
        if ERROR in verdicts:
            names: tuple[str, ...] = (*VERDICTS, ERROR)
        else:
            names = VERDICTS
        return {name: verdicts.count(name) for name in names}

    @property
    def changed(self) -> list[Judged]:
        """Claims with a verdict that differs from the one in claims.toml."""
        return [result for result in self.judged if result.verdict != result.claim.verdict]

    @property
    def failures(self) -> dict[str, str]:
        """Failed pictures and derivations, and why."""
        return {
            key: done.error for key, done in {**self.drawn, **self.chapters}.items() if done.error
        }

    @property
    def ok(self) -> bool:
        """Whether every verdict is the one in claims.toml and nothing failed."""
        return not self.changed and not self.failures


def run(
    plan: Plan, progress: Callable[[], None] | None = None, workers: int | None = None
) -> Results:
    """Do everything in a plan, in `workers` processes (None: one per processor).

    Call `progress` after each task.
    """
    # With 0 workers everything is done in this process, without time limits.
    begin = perf_counter()
    # The longest first (chapters, and the searches, which are among the last claims), so that no
    # worker is left alone with one.
    tasks: Tasks = {("chapter", subject): partial(derive, subject) for subject in plan.chapters}
    tasks |= {("claim", claim.id): partial(judge, claim.check) for claim in reversed(plan.claims)}
    tasks |= {("picture", key): partial(draw, picture) for key, picture in plan.pictures.items()}
    done: dict[tuple[str, str], Done] = {}
    in_this_process = ((key, timed(task)) for key, task in tasks.items())
    with closing(in_this_process if workers == 0 else _in_processes(tasks, workers)) as outcomes:
        for key, outcome in outcomes:
            done[key] = outcome
            if progress:
                progress()
    judged = []
    for claim in plan.claims:
        evidence, error, seconds = done["claim", claim.id]
        if error:
            result = Judged(claim, ERROR, error, {}, seconds)
        else:
            result = Judged(claim, evidence.verdict, evidence.finding, evidence.numbers, seconds)
        judged.append(result)
    drawn = {key: done["picture", key] for key in plan.pictures}
    chapters = {subject: done["chapter", subject] for subject in plan.chapters}
    return Results(plan, tuple(judged), drawn, chapters, perf_counter() - begin)


def _in_processes(
    tasks: Tasks, workers: int | None
) -> Generator[tuple[tuple[str, str], Done], None, None]:
    """Run tasks in worker processes; yield their keys and results.

    If a pool breaks down, a new one runs the rest.
    """
    for _ in range(POOLS):
        pool = ProcessPool(
            max_workers=min(read_workers(workers), len(tasks)), context=get_context("spawn")
        )
        futures: dict[Any, tuple[str, str]] = {}
        try:
            with suppress(RuntimeError):  # the pool has already broken down
                for key, task in tasks.items():
                    futures[pool.schedule(timed, args=(task,), timeout=TASK_LIMIT)] = key
            for future in as_completed(futures):
                try:
                    outcome = future.result()
                except TimeoutError:
                    outcome = Done(error=f"no result within {TASK_LIMIT:g} s")
                except ProcessExpired as death:
                    outcome = Done(error=f"the process ended with exit code {death.exitcode}")
                except BrokenProcessPool:
                    continue  # the task stays in `tasks`, for the next pool
                yield futures[future], outcome
                tasks = {key: task for key, task in tasks.items() if key != futures[future]}
        finally:
            pool.stop()  # nothing is left to do, or the user has interrupted it
            pool.join()
        if not tasks:
            return
    yield from (
        (key, Done(error=f"the pool of processes broke down, {POOLS} times")) for key in tasks
    )


def timed(task: Callable[[], Any]) -> Done:
    """Call a task; return its result or its error, with the processor time."""
    begin = process_time()
    done = Done()
    try:
        done = Done(task())
    except Exception as error:
        last = traceback.extract_tb(error.__traceback__)[-1]
        done = Done(
            error=f"{type(error).__name__}: {error} ({Path(last.filename).name}, line "
            f"{last.lineno})"
        )
    return done._replace(seconds=process_time() - begin)


def draw(picture: Picture) -> Drawn:
    """Return a picture as SVG, and its computed caption."""
    from symosc import plot

    def svg(build: Callable[[], Figure]) -> str:
        with TemporaryDirectory() as scratch:
            return plot.save(build(), Path(scratch) / "picture.svg").read_text(encoding="utf-8")

    return Drawn(
        svg(picture.build), picture.describe(), svg(picture.narrow) if picture.narrow else ""
    )


def derive(subject: str) -> tuple[int, str]:
    """Check all steps of a chapter of derivations; return their number, and the chapter as HTML."""
    from symosc.derive import document
    from symosc.derive.scope import Scope

    scope = Scope()
    chapter = document.check_chapter(subject, scope)
    return len(chapter.steps()), document.as_html(chapter, scope, level=4)
