"""Benchmarks: other people's event logic and solvers on small scenes, and the tables and pictures of measurements."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from importlib.metadata import PackageNotFoundError
from inspect import isgeneratorfunction
from itertools import count, product
from math import nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock, patch

import numpy as np
from cli_runs import run
from outputs import reference
from parameter_sets import DIP, EASY
from said import empty_folder, outcome
from stored_outputs import some_lines

from symosc import Scene, bench, load_scene, simulate
from symosc.base.errors import OutputError
from symosc.bench import (
    cases,
    event_logic,
    peers_scan,
    peers_scipy,
    results,
    speed,
    work,
)
from symosc.bench.event_logic import PeerError, from_now, problem, runner
from symosc.bench.solvers import OURS, Outcome, Solver, SolverEvent, Worker
from symosc.kernels.rebind import bind
from symosc.mappings.equations import residual

ABOUT = {"processor": "a processor", "cores": "2", "date": "a day", "symosc": "1.2", "numpy": "3.4"}
SCENES = {
    "fig5": replace(load_scene("fig5"), t_end=Fraction(7)),
    "fig8": replace(load_scene("fig8"), t_end=Fraction(5)),
    "fig10": replace(load_scene("fig10"), t_end=Fraction(6)),
    "critical": Scene("critical", EASY.replace(c=4), 0, "1/10", 3, 6),  # type: ignore[arg-type]
    "overdamped": Scene("overdamped", EASY.replace(c=5), 10**6, "1/10", 3, 10**6 + 6),  # type: ignore[arg-type]
    "peak": replace(load_scene("fig7-corrected"), t_end=Fraction(5)),
    "dip": replace(DIP, t_end=Fraction(5)),
    "from a belt": Scene("from a belt", EASY.replace(v1=0), 1, -6, 0, 5),  # type: ignore[arg-type]
}


# -- event logic and solvers, interpreted ----------------------------------------------------------


@cache
def interpreted(module: Any) -> dict[str, Any]:
    return bind((event_logic, module), {})


def followed(
    scene: Scene, functions: dict[str, Any], settings: Callable[[], Any], offset: float = 0.0
) -> str:
    """Return the events that a solver finds, or why it gives up."""

    def found() -> str:
        events = runner(scene, functions, settings(), offset)()
        return "\n".join(
            f"{event.t:.8f} {event.x:.7f} {event.kind} {event.boundary}" for event in events
        )

    return str(outcome(found, PeerError))


def by_scan(name: str, points: int = 40, **changes: Any) -> str:
    scene = replace(SCENES[name], parameters=SCENES[name].parameters.replace(**changes))
    settings = partial(peers_scan.scan_of, problem(scene.parameters), points, 1e-12)
    return followed(scene, interpreted(peers_scan), settings)


def by_scipy(name: str, method: str, tolerance: float) -> str:
    return "\n".join(
        f"{e.t:.6f} {e.x:.6f} {e.kind} {e.boundary}"
        for e in peers_scipy.prepare(method, SCENES[name], tolerance)()
    )


def forces() -> str:
    """Return forces, margins and the modes that follow, at many states of two parameter sets."""
    lines = []
    for p, origin in ((EASY, Fraction(0)), (load_scene("fig10").parameters, Fraction(10**9))):
        q = problem(p, origin)
        lines += [
            " ".join(f"{each:.9g}" for each in q),
            " ".join(f"{each:.9g}" for each in from_now(q, 7.5)),
        ]
        for t, x, mode in product((0.3, 4.0), (-3.0, 0.5, 2.0), (1, 2, 3, 4, 5)):
            v = (q.v1 - 1, 0.3 * q.v1 + 0.7 * q.v2, q.v2 + 1, q.v1, q.v2)[mode - 1]
            numbers = *event_logic.margins(q, mode, t, x, v), event_logic.turn(q, mode, t, x, v)
            signs = [event_logic.sign_of_force(q, alpha, t, x, v) for alpha in (1, 2, 3)]
            after = [event_logic.resolve(q, boundary, t, x) for boundary in (1, 2)]
            start = event_logic.start_mode(q, x, v)
            lines.append(
                f"{mode}: {' '.join(f'{each:.9g}' for each in numbers)} {signs} {after} {start}"
            )
    q = problem(EASY.replace(B0=0, v1=0, c=0))
    at_rest = q.A2 / q.stiffness
    lines.append(
        f"{[event_logic.sign_of_force(q, 2, t, at_rest, v) for t in (0, 1) for v in (0.0, 0.5, -0.5)]}"
    )
    q = problem(EASY.replace(A0=-9 - Fraction(1, 2), v1=0, c=0, k=4, mu1="1/2", mu2="0", FN=1))
    for t in (0.0, np.pi / 1.5, np.pi / 3.0):
        x = (q.A2 + q.swing * np.cos(q.Omega * t)) / q.stiffness
        lines.append(f"{[event_logic.sign_of_force(q, 2, t, x, v) for v in (0.0, 1e-3, -1e-3)]}")
    return "\n".join(lines)


def gives_up(outcome: str) -> str:
    """Return what is said of a solver that finds events for ever, or none."""

    def leave(
        q: Any, s: Any, mode: int, t: float, x: float, v: float, t_end: float
    ) -> tuple[int, float, float]:
        if outcome == "unsolved":
            return (event_logic.UNSOLVED, t, x)
        return ((1, -1, -1, 1, 1)[mode - 1], t + 1e-3, x)

    return followed(SCENES["from a belt"], bind((event_logic,), {"leave": leave}), lambda: None)


# -- work and precision ----------------------------------------------------------------------------


def late(scene: Scene, tolerance: float) -> Callable[[], Iterator[SolverEvent]]:
    """Prepare a solver whose events are late, and which misses the third one and reports another."""
    found = [event._replace(t=event.t + tolerance) for event in exactly(scene, 0.0)()]
    other = [SolverEvent(float(scene.t0) + 1, 0.0, "cross", 1)]
    return lambda: iter([*found[:2], *found[3:], *other])


def exactly(scene: Scene, tolerance: float) -> Callable[[], list[SolverEvent]]:
    return lambda: [
        SolverEvent(float(e.t), float(e.x), e.kind, e.boundary) for e in simulate(scene).events
    ]


def nearly(scene: Scene, tolerance: float) -> Callable[[], list[SolverEvent]]:
    """Prepare a solver whose events are late by more than rounding, such that no number that is shown is near a tie."""
    return lambda: [event._replace(t=event.t + 4.6e-13) for event in exactly(scene, 0.0)()]


def fails(scene: Scene, tolerance: float) -> Callable[[], list[SolverEvent]]:
    if tolerance < 1e-4:
        raise ArithmeticError("chatters for ever\nand more")
    return nearly(scene, tolerance)


SOLVERS = (
    replace(OURS[0], prepare=exactly, needs=""),
    Solver("heyoka", late, (1e-3, 1e-7), note="all events are late"),
    Solver("scipy RK45", fails, (1e-3, 1e-5)),
    Solver("scipy LSODA", late, (1e-5,)),
    Solver("absent", exactly, (1e-3,), needs="no_such_module"),
)


class Direct:
    """A worker that calls at once, in this process; a call of LSODA hangs."""

    def __enter__(self) -> Direct:
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def warm(self, *arguments: object) -> None:
        pass

    def call(self, limit: float, function: Callable[..., Any], *arguments: Any) -> Outcome:
        if arguments[0].name == "scipy LSODA":
            return Outcome(failure="hang", warnings=("slow",))
        try:
            return Outcome(function(*arguments), warnings=("careful", "careful"))
        except ArithmeticError as error:
            return Outcome(failure=f"exception: {error}".partition("\n")[0])


def ticking(step: float = 0.125) -> Any:
    """Return a clock that goes on by so many seconds at each look."""
    return SimpleNamespace(perf_counter=count(0.0, step).__next__)


@cache
def worked(quick: bool = False, step: float = 1e-3) -> dict[str, Any]:
    """Return a run of work and precision with a clock of its own."""
    scenes = {"fig5": (6, 9, 12), "fig9": (5, 5, 5), "fig10": (4, 6, 8), "fig6": (2, 3, 3)}
    with (
        patch.object(work, "Worker", Direct), patch.object(work, "floor_s", count(25e-9, 1e-9).__next__),
        patch.object(work, "time", ticking(step)), patch.object(work, "machine", lambda: ABOUT),
    ):  # fmt: skip
        return work.run(quick=quick, solvers=SOLVERS, scenes=scenes)


def measured_times() -> str:
    """Return how often calls are repeated that take long or short, within some budgets."""
    lines = []
    for step, limit, budget in (
        (0.05, 1.0, 0.2),
        (0.05, 1.0, 1.0),
        (0.35, 5.0, 0.2),
        (0.35, 1.0, 0.2),
        (1e-3, 1.0, 9.0),
    ):
        with patch.object(work, "time", ticking(step)), patch.object(work, "floor_s", lambda: 1e-8):
            times, floors, found = work.measure(SOLVERS[0], SCENES["fig5"], 0.0, 5.0, limit, budget)
        lines.append(f"{len(times)} {len(floors)} {len(found)} {sum(times):.6g}")
    return "\n".join(lines)


def compared() -> list[Any]:
    """Return what is said of right, wrong and missing events."""
    scene = load_scene("fig5")
    exact = simulate(scene, t_end=7).events
    right = exactly(SCENES["fig5"], 0.0)()
    lists = [
        right,
        right[1:],
        [],
        [right[0]._replace(t=nan), *right[1:]],
        [e._replace(t=e.t + 1e-4, x=e.x - 1e-3) for e in right],
    ]
    lists.append([e._replace(t=e.t + 0.1) for e in right])
    lists.append(
        [*right[:3], right[3]._replace(kind="cross"), *right[4:], right[0]._replace(t=6.99)]
    )
    return [work.compare(given, scene, exact) for given in lists]


# -- speed -----------------------------------------------------------------------------------------


@cache
def timed() -> dict[str, Any]:
    """Return measurements of made-up calls by a clock of their own."""
    clock = count(0.0, 0.001).__next__
    slow = count(0.0, 3.0).__next__
    rows = [
        speed.Call("fig5", "event", lambda: simulate("fig5", t_end=7)),
        speed.Call("fig9", "event", lambda: [3, 4]),
    ]
    rows.append(speed.Call("fig5, 1,000 events", "call", lambda: None, 4.0, once=True))
    groups = [
        speed.Group("One long motion, events counted", rows, clock),
        speed.Group("simulate", rows[1:], slow),
    ]
    groups.append(speed.Group("slower", rows[:1], count(0.0, 6.0).__next__))
    groups.append(speed.Group("faster", rows[:1], (1e-4 * each**1.5 for each in count()).__next__))
    patches = {
        "groups": lambda quick: iter(groups),
        "floor_s": lambda: 2e-8,
        "machine": lambda: ABOUT,
    }
    patches["measure_errors"] = lambda: [
        {"scene": "fig5", "events": 16, "error": 3e-15, "estimate": 2.4e-13}
    ]
    with patch.multiple(speed, **patches):
        return speed.run(quick=True)


def named_calls() -> str:
    """Return the names of calls to measure, and the numbers of their units."""
    groups = {
        "long": speed._long_motions(2000), "single": speed._single_motions(2000),
        "sticks": speed._shrinking_sticks(4, 100), "workers": speed._workers(20),
        "orbits": speed._orbits_and_windows(3), "quick": speed._processes(True, "cache"),
        "all": speed._processes(False, "cache"),
    }  # fmt: skip
    rows = [
        (name, c, getattr(c.action, "args", ())) for name, calls in groups.items() for c in calls
    ]
    sizes = [
        [np.size(each) for each in arguments if isinstance(each, list | np.ndarray)]
        for _, _, arguments in rows
    ]
    texts = [f"{name}: {c.what} | {c.per} | {c.units} | {c.once}" for name, c, _ in rows]
    return "\n".join(f"{text} {size}" for text, size in zip(texts, sizes, strict=True))


# -- the reference cases, and pages of results -----------------------------------------------------


def at_once(
    chunks: Sequence[Sequence[tuple[Any, ...]]], steps: Iterable[Any], limit: float = 1.0
) -> dict[Any, Outcome]:
    """Call at once what is to run in processes; what fails says so."""
    found = {}
    for key, function, *arguments in (job for chunk in chunks for job in chunk):
        try:
            found[key] = Outcome(function(*arguments))
        except (ArithmeticError, PeerError) as error:
            found[key] = Outcome(failure=str(error))
    return found


def chosen_cases() -> list[Any]:
    names = ("paper-fig6", "rest-1", "free-decay-2", "easy-fig9", "light-mass-m-1e-2")
    return [reference.computed(name) for name in names]


@cache
def scored(wrong: bool = False) -> dict[str, Any]:
    """Return the scores of solvers on a few cases."""
    ours = replace(OURS[1], prepare=late if wrong else nearly)
    solvers = [
        ours,
        Solver("late", late, (1e-3, 1e-7)),
        Solver("fails", fails, (1e-5,)),
        SOLVERS[-1],
    ]
    with (
        patch.object(cases, "in_parallel", at_once), patch.object(cases, "machine", lambda: ABOUT),
        patch.object(cases, "OURS", (ours,)),
    ):  # fmt: skip
        return cases.run(solvers=solvers, cases=chosen_cases(), limit=4.0)


def bench_files() -> str:
    """Return the pages that are written into a folder with a README."""
    with empty_folder() as folder:
        readme = folder / "README.md"
        text = "above\n<!-- results: begin, by the command -->\nold\n<!-- results: end -->\nbelow\n"
        readme.write_text(text, encoding="utf-8")
        whole = {
            "speed": timed(),
            "work_precision": worked(),
            "scores": scored(),
            "quick": True,
        }
        with patch.object(results.plot, "save", lambda figure, path: Path(path)):
            paths = results.write(readme, whole)
        texts = [path.read_text(encoding="utf-8") for path in paths if path.suffix == ".md"]
    return "\n".join([*(str(path.relative_to(folder)) for path in paths), *texts])


def compared_in_words() -> str:
    """Return the paragraph that compares the solvers, if a looser accuracy pays, if heyoka did not run."""
    found = {"work_precision": worked(), "scores": scored()}
    rows = [
        row
        | {"us_per_event": (row["us_per_event"] or 0) * (0.1 if row["tolerance"] == 1e-9 else 1)}
        for row in worked()["rows"]
    ]
    without = [row for row in rows if row["solver"] != "heyoka"]
    many = [found | {"work_precision": {"rows": each}} for each in (rows, without)]
    return "\n".join(results.comparison(each) for each in (found, *many))


def planned(quick: bool) -> str:
    """Return the groups of calls, with the sizes of their tasks."""
    made = [
        name
        for name, each in vars(speed).items()
        if isgeneratorfunction(each) and each is not speed.groups
    ]
    noted = dict.fromkeys(
        made, lambda *given: [each for each in given if not isinstance(each, str)]
    )
    with patch.multiple(speed, warm=lambda: None, find_spec=lambda name: True, **noted):
        groups = [(group.title, group.calls, group.clock.__name__) for group in speed.groups(quick)]
    return "\n".join(map(str, groups))


def lambdified() -> str:
    """Return the residuals that sympy makes, which are those of symosc."""
    p = load_scene("fig9").parameters
    points = [np.array([each, each + 0.5]) for each in (1.0, 0.3, 0.8, 1.6)]
    x_i, theta_i, x_j, theta_j = points
    found = [
        *(speed.lambdified(p, cse)(*points) for cse in (True, False)),
        residual(p, "P3", (x_i, theta_i), (x_j, theta_j)),
    ]
    return "\n".join(" ".join(f"{value:.9g}" for row in rows for value in row) for rows in found)


def first_calls() -> list[Any]:
    """Return the calls that a worker makes, which imports and compiles before the first call of each solver."""
    # its process starts with a call
    worker = Worker()
    calls = list[Any]()
    with patch.object(worker, "call", lambda *arguments: calls.append(arguments)):
        for name in ("one", "one", "two"):
            worker.warm(name, len, "abc")
    return [(limit, arguments) for limit, _, *arguments in calls]


def protected() -> str:
    """Return what is said of a README that cannot be written."""
    with empty_folder() as folder, patch.object(results.os, "access", lambda path, mode: False):
        (folder / "README.md").write_text("text", encoding="utf-8")
        return str(outcome(lambda: results.check(folder / "README.md"), OutputError))


def without_packages() -> list[str]:
    """Return what is said of packages that are not installed."""
    with patch.object(bench, "version", Mock(side_effect=PackageNotFoundError)):
        return [bench.machine()[name] for name in bench.PACKAGES]


def command(*arguments: str, wrong: bool = False) -> str:
    """Return the exit code of `symosc bench`, what it prints, and titles and lists of its pages, without measuring."""
    runs = {
        cases: scored(wrong),
        speed: timed(),
        work: worked(),
    }
    with empty_folder() as folder, ExitStack() as stack:
        for module, found in runs.items():
            stack.enter_context(
                patch.object(module, "run", lambda *_, found=found, **options: found)
            )
        stack.enter_context(patch("symosc.plot.save", lambda figure, path: Path(path)))
        stack.enter_context(patch("symosc.cli.bench.find_spec", lambda name: name))
        done = run("bench", *arguments)
        pages = [
            line
            for path in sorted(folder.iterdir())
            for line in path.read_text(encoding="utf-8").splitlines()
        ]
        pages = [line for line in pages if line.startswith(("# ", "- "))]
    return "\n".join([str(done.exit_code), done.output, *pages])


CASES: dict[str, Callable[[], object]] = {
    "forces": forces,
    **{
        f"scan: {name}": partial(by_scan, name)
        for name in ("critical", "overdamped", "from a belt")
    },
    "scan: no spring": lambda: by_scan("fig5", k=0),
    "fine scan": lambda: by_scan("fig8", 2000),
    "LSODA of scipy": lambda: by_scipy("fig5", "LSODA", 1e-8),
    "Radau of scipy": lambda: by_scipy("from a belt", "Radau", 1e-6),
    "chatters": lambda: gives_up("chatters"),
    "gives up": lambda: gives_up("unsolved"),
    "compared": compared,
    "measured times": measured_times,
    "work": lambda: worked()["rows"],
    "work, slow": lambda: worked(True, 0.125)["rows"],
    "work as Markdown": lambda: work.table(worked(True, 0.125), markdown=True),
    "work as a picture": lambda: work.figure(worked()),
    "speed": lambda: timed()["groups"],
    "calls to measure": named_calls,
    "durations": lambda: [
        speed.duration(value) for value in (12.3456, 1.0, 0.0123456, 1e-3, 4.5e-5, 1e-6, 3.21e-8)
    ],
    "scores": lambda: cases.table(scored()),
    "wrong scores": lambda: cases.our_verdict(scored(True)),
    "scores as data": lambda: {
        key: cases.as_json(scored())[key] for key in ("ok", "limit_s", "skipped", "violations")
    },
    "calls in groups": lambda: planned(False),
    "calls in quick groups": lambda: planned(True),
    "residuals by sympy": lambdified,
    "closed form": lambda: speed.closed_form(4000, 0.5, 0.8, 1.2, 1.0, 2.0, 3.0, 4.0),
    "first calls": first_calls,
    "README that cannot be written": protected,
    "without packages": without_packages,
    "command": command,
    "command with a picture": lambda: some_lines(command("-o", "FOLDER/work.svg"), -2),
    "command --hard": lambda: some_lines(command("--hard", "-o", "FOLDER/map.svg"), -11),
    "command --hard, wrong": lambda: some_lines(command("--hard", wrong=True), 0, 5),
    "command --scores": lambda: command("--scores", "FOLDER/scores.md"),
    "command --scores, wrong": lambda: command("--scores", "FOLDER/scores.md", wrong=True),
    "results in words": compared_in_words,
    "pages of results": bench_files,
}
