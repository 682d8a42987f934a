"""What the commands print, write and draw; their options, as --help has them.

Bars of work that takes long.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from importlib.util import find_spec
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import click
import pytest
from cli_runs import COMMANDS, run
from matplotlib.figure import Figure
from said import empty_folder
from stored_outputs import PLACE, lines_of_figure

import symosc
from symosc import load_scene, simulate
from symosc.base.display import progress
from symosc.base.errors import CodeCacheWarning
from symosc.cli import app, output
from symosc.scenes import as_toml

Case = Callable[[], object]
#: What is not the same on every machine and in every version.
VOLATILE = {
    r"\d+\.\d\d s; symosc \S+, Python \S+": "TIME",
    r"symosc[- ]\d+\.\d+\.\d+\S*": "symosc VERSION",
}
VOLATILE |= {
    r'"seconds": [\d.e-]+': '"seconds": TIME',
    r'"(version|made_by|symosc)": ".*?"': r'"\1": VERSION',
}
VOLATILE |= {PLACE: r"\1", r"/\S*/(?=\w+\.\w+)": ""}
VOLATILE |= {
    r"kernels \w{16}": "KERNELS",
    r'"plan": "\w{64}"': "PLAN",
    r'"sha256": "\w{64}"': "SHA256",
    r"Version [\d.]+": "VERSION",
    r"year += .*": "YEAR",
}
VOLATILE |= {
    r"; \d+\.\d\d s$": "",
    r"DOP853 .*": "DOP853",
    r"-{4,}": "---",
    r"-?\d+\.\d+ +inf$": "ANY  inf",
}


def told(line: str, lines: int = 60, **files: str) -> str:
    """Return what a command line prints and draws, its exit code, and the files that it leaves in an empty folder.

    `files` are there before, by names with _ for a point. Figures are not written, but noted. Of
    several commands, with && between them, it is about the last one.
    """
    drawn: list[str] = []

    def save(drawing: Figure, path: Any) -> Path:
        drawn.append(f"draws {path}: {drawing.get_figwidth():g} by {drawing.get_figheight():.6g}")
        drawn.extend(
            text
            for text in lines_of_figure(drawing)
            if re.match(" +(axes|limits|legend|text)", text)
        )
        return Path(path)

    with (
        empty_folder() as folder,
        contextlib.chdir(folder),
        patch.object(symosc.plot, "save", save, create=True),
        noted_bars(drawn),
    ):
        for name, text in files.items():
            Path(name.replace("_", ".")).write_text(text, encoding="utf-8")
        *before, last = line.split(" && ")
        assert all(run(*shlex.split(each)).exit_code == 0 for each in before)
        result = run(*shlex.split(last))
        left = {path.name: path for path in sorted(Path().rglob("*")) if path.is_file()}
        left = {name: path for name, path in left.items() if path.suffix != ".pyc"}
        texts = [f"leaves {name}" for name in left if name.replace(".", "_") not in files]
        for name, path in left.items():
            if name.replace(".", "_") not in files and path.suffix in (".csv", ".toml", ".h"):
                texts += path.read_text(encoding="utf-8").splitlines()[:20]
    parts = [f"exit code {result.exit_code}", *result.stdout.splitlines()[:lines], *drawn]
    parts += [f"on stderr: {each}" for each in result.stderr.splitlines()] + texts
    if not isinstance(result.exception, (SystemExit, type(None))):
        raise result.exception
    return cut("\n".join(parts))


@contextlib.contextmanager
def noted_bars(notes: list[str]) -> Iterator[None]:
    """Note what the commands tell their bars."""

    @contextlib.contextmanager
    def noted(*about: Any, **more: Any) -> Iterator[Callable[..., None]]:
        calls: list[tuple[Any, ...]] = []
        yield lambda *call: calls.append(call)
        engine = about[0].startswith(
            ("simulate", "sweep")
        )  # how often it reports is its own affair
        notes.append(f"bar {about} {more}: {'' if engine else calls[:1] + calls[-1:]}")

    with patch.multiple(
        progress, _bar_drawer=noted, shows_bars=lambda: True, working=contextlib.nullcontext
    ):
        yield


def cut(text: str) -> str:
    """Return a text without what is not the same everywhere, and numbers with ten digits."""
    for pattern, word in VOLATILE.items():
        text = re.sub(pattern, word, text, flags=re.MULTILINE)
    return re.sub(r"-?\d+\.\d{7,}(?![\d…])", lambda found: f"{float(found[0]):.10g}", text)


def needing(extra: str, make: Case) -> Case:
    """Return a case that is skipped where a package is not installed."""

    def case() -> object:
        pytest.importorskip(extra)
        return make()

    return case


# -- files that commands read ------------------------------------------------------------------------------------------


@cache
def samples(scene: str = "fig9", t_end: float = 3, bump: float = 0.0) -> str:
    """Return a CSV file of a motion from its start on, one of whose velocities may be off."""
    t0 = float(load_scene(scene).t0)
    times = [t0 + (t_end - t0) * i / 59 for i in range(60)]
    x, v = simulate(scene, t_end=t_end)(times)
    v[30] += bump
    rows = [",".join(map(repr, map(float, row))) for row in zip(times, x, v, strict=True)]
    return "\n".join(["t,x,v", *rows, ""])


@cache
def measured() -> str:
    events = simulate("fig5", t_end=9).events
    return "\n".join(
        [
            "t,kind",
            *(f"{event.t + 0.001 * (-1) ** i:.6f}, {event.kind}" for i, event in enumerate(events)),
        ]
    )


def both() -> str:
    """Return two solutions in one file, told apart by a column."""
    good = samples().splitlines()[1:]
    bad = samples(bump=0.5).splitlines()[1:]
    return "\n".join(["which,t,x,v", *(f"a,{row}" for row in good), *(f"b,{row}" for row in bad)])


SOLVER = """
from symosc import simulate

def solve(p, t0, x0, v0, t_end):
    return simulate(p, t0=t0, x0=x0, v0=v0, t_end=t_end)
"""
WALL = symosc.OtherModel(m=1, k=1, Omega=1, FN=1, Y="5/3", joined=True)
MODEL = as_toml(symosc.Scene("wall", WALL, t0=0, x0=1, v0=0, t_end=9))
LIMIT = " ".join(
    f"--set {text}"
    for text in (
        f"A0=-0.{700 * '9'}",
        "c=1",
        "k=0",
        "B0=0",
        "v1=1",
        "v2=5",
        "mu1=0.5",
        "mu2=0.5",
        "FN=2",
    )
)

MOTIONS = {
    "simulate": "simulate fig5",
    "simulate with a start": "simulate fig5 --t0 1/3 --x0 -0.5 --v0 -2 --t-end 3T --set mu2=0 --set Omega=2*pi",
    "derive without a name": "derive --output ''",
    "simulate few events": "simulate fig10 --max-events 3",
    "simulate digits": "simulate fig8 --digits 20 --t-end 8",
    "simulate json": "simulate fig6 --t-end 4 --json",
    "simulate json of digits": "simulate fig8 --digits 20 --t-end 3.2 --json",
    "simulate csv": "simulate fig6 --csv events.csv",
    "simulate csv only": "simulate fig6 --csv -",
    "simulate csv and json": "simulate fig6 --csv - --json",
    "simulate undecidable": f"simulate fig5 --t-end 1600 {LIMIT}",
    "simulate an uncertain start": "simulate fig5 --start-error 0.5",
    "simulate a start known roughly": "simulate fig8 --start-error 1e-3,1e-3,1e-3 --t-end 8",
    "simulate quiet": "simulate fig6 --set Omega=2*pi -q --t-end 2",
    "figure": "figure fig5 -o a.svg",
    "figure of a column": "figure fig10 -o a.pdf --panels bdg --boundary 2 --columns 1 --t-end 1T",
    "figure to stdout": "figure fig7 -o - --panels c --t-end 3",
    "figure undecidable": f"figure fig5 -o a.svg --panels a --t-end 1600 {LIMIT}",
    "scenes": "scenes",
    "a scene": "scenes fig8-exact",
    "a scene as json": "scenes fig9-orbit --json",
    "new": "new mine.toml --like fig9",
    "new to stdout": "new -",
    "new, followed": "new mine.toml --like fig6 && simulate mine.toml --t-end 2",
    "new where one is": "new mine.toml",
}
ORBITS = {
    "orbit": "orbit fig9",
    "orbit in digits": "orbit fig10 --structure P4645 --digits 20",
    "orbit json": "orbit fig9 --json -o orbit.svg",
    "orbit of no motion": "orbit fig9 --structure P32 --set Omega=3 -o -",
    "orbit not found": "orbit fig5 --structure P232323 --periods 1",
    "orbit in two periods": "orbit fig9 --periods 2",
    "orbit with its branch": "orbit fig9 --continue Omega=3.99:4.01 -o branch.svg",
    "response": "orbit fig9 --response Omega=3.9:4.1:2 -o response.svg",
    "response json": "orbit fig9 --response Omega=4:5:2 --json",
    "response of an orbit": "orbit fig9 --response Omega=4 --structure P32",
}
FITS = {
    "fit": "fit fig5 it.csv --free mu1 --sigma 1e-3 --plot fit.svg",
    "fit json": "fit fig5 it.csv --free mu1 --json",
    "fit from a first value": "fit fig5 it.csv --free mu1,c --start mu1=0.7 --start c=1.1",
    "fit of too much": "fit fig5 it.csv --free A0,x0 --sigma 1e-3",
}
BAD_FITS = {
    "a short row": "t,kind\n1,stick\n2\n",
    "a kind": "t,kind\n1,stuck\n",
    "no number": "t,kind\nx,stick\n",
}
BAD_FITS |= {"a quote": 't,kind\n"1"2,stick\n'}
GRAZING = {
    "grazing": "grazing fig9",
    "grazing in the paper's order": "grazing fig8 --map P3 --order paper",
    "grazing latex": "grazing fig9 --map P2 --map P2 --map P6 --latex",
    "grazing json": "grazing fig9 --json --map P3 --map P5",
    "grazing checked": "grazing fig9 --map P2 --check 3",
    "grazing without a spring": "grazing fig9 --set k=0 --set A0=0 --set mu1=0 --set mu2=0 --set v1=3 --set B0=6",
    "grazing without a spring, damped": "grazing fig9 --set k=0 --set c=90 --plot a.svg --map P2",
    "grazing drawn": "grazing fig9 --map P2 --plot window.svg",
    "grazing against a parameter": "grazing fig9 --map P2 --against Omega=0.1:4 --plot a.svg",
    "grazing against the whole range": "grazing fig9 --map P3 --against k --plot a.svg --order paper",
    "grazing solved": "grazing fig9 --solve Omega --phase 7*pi/6",
    "grazing solved between": "grazing fig9 --map P2 --solve k --phase pi:3*pi/2 --json",
    "grazing solved for a belt": "grazing fig9 --solve v2",
    "grazing solved for both belts": "grazing fig9 --solve v1,v2 --phase pi",
    "grazing solved for two": "grazing fig9 --map P2 --solve Omega,k --phase 7*pi/6 --plot a.svg --json",
    "grazing solved in letters": "grazing --map P3 --solve Omega --phase pi",
    "grazing solved in letters, json": "grazing --map P3 --solve Omega --phase pi --json",
    "grazing solved, latex": "grazing fig9 --map P3 --solve k --latex",
    "grazing of all parameters": "grazing --map P2 --json "
    "--set m=1 --set c=1 --set k=1 --set A0=0 --set B0=2 --set Omega=1 --set v1=-1 --set v2=1 --set mu1=1/2 "
    "--set mu2=1/2 --set FN=1",
}
CHECKS = {
    "check": "check fig9 run.csv --t-end 3",
    "check json": "check run.csv --scene fig9 --partial --json",
    "check early end": "check fig9 run.csv",
    "check a bump": "check fig9 bump.csv --partial -o errors.svg --report page.html",
    "check with a tolerance": "check fig9 bump.csv --partial --tolerance 1 --global-tolerance 1",
    "check other columns": "check fig9 named.csv --partial --columns t=time,x=pos,v=none",
    "check several": "check fig9 run.csv bump.csv --partial --workers 1",
    "check ids": "check fig9 both.csv --partial --columns id=which",
    "check several, drawn": "check fig9 run.csv bump.csv --partial -o a.svg",
    "check own start": "check fig9 run.csv --partial --own-start --tolerance 1e-3",
    "check a page of another kind": "check fig9 run.csv --report page.pdf",
    "check bad columns": "check fig9 run.csv --columns t",
}
CODE = {
    "derive": "derive friction",
    "derive a form": "derive friction --form paper --set mu1=1/3 --digits 5 --tags paper --prefix mine --alone",
    "derive into a file": "derive friction --scene fig5 -o it.tex",
    "derive json": "derive friction --json",
    "derive a page of a fragment": "derive P3 --format html",
    "derive a chapter with digits": "derive sticks --digits 5",
    "derive a chapter, pdf of html": "derive sticks --pdf --format html",
    "derive into a file of a chapter": "derive sticks -o a.tex",
    "codegen": "codegen P32 --language c -o code",
    "codegen json": "codegen P5 --language python --name mine -o code --json",
    "codegen to stdout": "codegen P32 --language numpy -o -",
    "codegen over another": "codegen P32 -o .",
    "codegen over another, forced": "codegen P32 -o . --force",
}
SWEEP = "sweep fig9 --over Omega=3:5:3 --over FN=5:10:2 --t-end 6T --skip 4T"
SWEEPS = {
    "sweep": f"{SWEEP} -o map.csv --plot map.svg --workers 1",
    "sweep numbers": f"{SWEEP} --record word,x,sticks --json",
    "sweep status": f"{SWEEP} -o map.csv --status",
    "sweep status json": f"{SWEEP} -o map.csv && {SWEEP} -o map.csv --status --json",
    "sweep status, written": f"{SWEEP} -o map.csv && {SWEEP} -o map.csv --status",
    "sweep again": f"{SWEEP} -o map.csv && {SWEEP} -o map.csv --json",
    "sweep on another cluster": "sweep fig9 --over k=1:2:3 --executor dask:",
    "sweep over starts": "sweep fig9 --over x0=-1:1:12 --t-end 2 --record events,word",
}
CERTIFIED = {
    "certify": "certify fig6 --t-end 2",
    "certify derivatives": "certify fig6 --t-end 2 --wrt mu1,x0",
    "certify an orbit": "certify fig9 --orbit P32 -o orbit.json",
    "certify a window": "certify fig9 --window P2",
    "certify no structure": "certify fig5 --branch Omega=3:4",
    "certify what is not proven": "certify fig10-orbit",
    "cases": "cases --group easy",
    "cases json": "cases --group easy --json",
}


def models() -> dict[str, Case]:
    lines = (
        "simulate wall.toml --json",
        "scenes wall.toml --json",
        "orbit wall.toml --continue k=1:2",
        "grazing wall.toml --map P3",
    )
    return {f"another model: {line}": partial(told, line, wall_toml=MODEL) for line in lines}


def named() -> str:
    return samples().replace("t,x,v", "time,pos,vel", 1)


CHECKED = {
    "run_csv": samples,
    "bump_csv": partial(samples, bump=0.5),
    "named_csv": named,
    "both_csv": both,
}


def checked(line: str) -> str:
    return told(
        line, **{name: make() for name, make in CHECKED.items() if name.replace("_", ".") in line}
    )


# -- commands whose work is not theirs ---------------------------------------------------------------------------------


def benched(line: str, ok: bool = True, **files: str) -> str:
    """Return what `symosc bench` says where nothing is measured; what it asks for is noted."""
    if find_spec("numba") is None or find_spec("flint") is None:
        pytest.skip("numba or flint is not installed")
    from symosc.bench import cases, results, speed, work

    asked: list[str] = []

    def measured(name: str) -> Callable[..., Any]:
        def run(progress: Any = None, **how: Any) -> Any:
            asked.append(f"{name} {sorted(how)} {how.get('quick')} {len(how.get('cases', ()))}")
            return {
                "ok": ok,
                "scores": [],
                "steps": list(progress([1, 2])) if progress else [],
                "empty": float("nan"),
            }

        return run

    def drawn(found: Any) -> Figure:
        return Figure(figsize=(3, 2))

    def write(path: Any, *more: Any) -> list[Any]:
        asked.append(f"{more if len(more) > 1 else sorted(more[0])}")
        return [path]

    names = {"speed": speed, "work": work, "cases": cases}
    with contextlib.ExitStack() as stack:
        for name, module in names.items():
            new = {
                "run": measured(name),
                "table": lambda _, name=name: f"table of {name}",
                "figure": drawn,
            }
            stack.enter_context(patch.multiple(module, create=True, **new))
        stack.enter_context(patch.object(cases, "as_json", lambda found: found))
        stack.enter_context(patch("symosc.plot.score_figure", drawn))
        for module in (cases, results):
            stack.enter_context(patch.object(module, "write", write))
        text = told(line, **files)
    return "\n".join([text, *asked])


def warmed(line: str) -> str:
    from symosc.simulation import batch

    rows = [batch.Warmed("doubles", True, 0.25), batch.Warmed("pairs", False, 12.0)]
    with patch.object(batch, "warm", lambda: rows):
        return told(line)


def mapped(line: str) -> str:
    """Return what `symosc atlas` prints of an atlas that is given."""
    from outputs.plot import plane

    asked: list[str] = []

    def atlas(scene: Any, over: Any, **how: Any) -> Any:
        asked.append(f"{scene.name} {over} {how}")
        return plane(True)

    with (
        patch.object(symosc, "atlas", atlas),
        patch("symosc.certificates.atlas.Atlas.statement", lambda _: {"a": 1}),
    ):
        return "\n".join([told(line), *asked])


def explored(line: str) -> str:
    """Return what `symosc explore` serves and opens."""
    pytest.importorskip("bokeh")
    from symosc.plot.explorer import server

    said: list[str] = []

    class Server:
        def __init__(self, scene: Any, port: int) -> None:
            said.append(f"serves {scene.name}, k = {scene.parameters.k}, port {port}")
            self.address = "http://here/"

        def __enter__(self) -> Server:
            return self

        def __exit__(self, *_: Any) -> None:
            said.append("closed")

        def serve_forever(self) -> None:
            said.append("serving")

    class Thread(SimpleNamespace):
        def start(self) -> None:
            said.append(f"opens {self.args} {self.daemon}")

    with (
        patch.object(server, "ExplorerServer", Server),
        patch("symosc.cli.simulate.Thread", Thread),
    ):
        return "\n".join([told(line), *said])


def verified(answer: tuple[int, str], line: str) -> str:
    pytest.importorskip("flint")
    asked: list[str] = []

    def verify(file: str, **limits: Any) -> tuple[int, str]:
        asked.append(f"{file} {limits}")
        return answer

    with patch("symosc.certificates.verify_orbits.verify", verify):
        return "\n".join([told(line), *asked])


def scored(line: str, *short: int) -> str:
    """Return what `symosc score` says of scores that are given, and what it asks for."""
    from outputs.plot import scores

    asked: list[str] = []

    def judge(name: str, cases: Any, given: Any, limit: float) -> Any:
        found = scores()[len(asked)]
        asked.append(f"{name} {len(cases)} {given} {limit}")
        if short:
            cases_of = [case for case in found.cases if case.right]
        else:
            cases_of = found.cases
        return replace(found, name=name, cases=cases_of)

    with (
        patch("symosc.reference.folder.read_set", lambda _: (7, [SimpleNamespace(name="one")])),
        patch("symosc.reference.results.read_results", lambda each, names: f"{each} {names}"),
        patch("symosc.reference.score.score", judge),
    ):
        return "\n".join([told(line), *asked])


def written_cases(line: str) -> str:
    """Return what `symosc cases` says of a folder that is not written."""
    pytest.importorskip("flint")

    def write(folder: str, cases: Any, progress: Any) -> Path:
        for each in cases:
            progress(each)
        return Path(folder)

    with patch("symosc.reference.folder.write_cases", write):
        return told(line)


def derived(line: str, latex: bool = True) -> str:
    """Return what `symosc derive` says of chapters that are not derived."""
    from symosc.derive import document

    asked: list[str] = []
    steps = [("", SimpleNamespace(kind=kind)) for kind in ("exact", "exact", "numeric")]

    def check(key: str, scope: Any, progress: Any) -> Any:
        for done in (1, 2):
            progress(key, done, 2)
        return SimpleNamespace(key=key, steps=lambda: steps, log=lambda: [{"step": "1"}])

    def write(chapters: Any, scope: Any, folder: Path, form: str) -> list[Path]:
        asked.append(
            f"{[each.key for each in chapters]} {scope.scene and scope.scene.name} {folder} {form}"
        )
        return [folder / "main.tex"]

    def compiled(path: Path) -> Path:
        if not latex:
            raise symosc.OutputError(str(path), "is too long")
        return path.with_suffix(".pdf")

    def printed(chapters: Any, scope: Any, form: str) -> str:
        return f"printed {len(chapters)} {form}\n"

    new: dict[str, Any] = {
        "check_chapter": check,
        "write_document": write,
        "make_pdf": compiled,
        "printed": printed,
    }
    with patch.multiple(document, has_latex=lambda: "none" not in line, **new):
        return "\n".join([told(line), *asked])


def reproduced(line: str, changed: int = 0, failed: int = 0) -> str:
    """Return what `symosc reproduce` says of a run in which verdicts may have changed and pictures failed."""
    from symosc.paper import report
    from symosc.paper.run import Done, Judged, Plan, Results

    def everything(plan: Plan, progress: Any, workers: Any) -> Results:
        claims = plan.claims[:4]
        verdicts = ["not as printed"] * changed + [claim.verdict for claim in claims[changed:]]
        judged = (
            Judged(claim, verdict, "found", {}, 0.1)
            for claim, verdict in zip(claims, verdicts, strict=True)
        )
        keys = list(plan.pictures)[:3]
        drawn = {
            key: Done(None, "it hangs") if i < failed else Done("svg") for i, key in enumerate(keys)
        }
        chapters = {key: Done((12, "html")) for key in plan.chapters[:2]}
        for _ in range(len(plan)):
            progress()
        return Results(plan, tuple(judged), drawn, chapters, 65.4)

    new: dict[str, Any] = {
        "write": lambda *_: None,
        "files": lambda _: {},
        "data": lambda _: {"ok": 1},
    }
    with patch("symosc.paper.run.run", everything), patch.multiple(report, **new):
        return told(line)


OTHERS: dict[str, Case] = {
    "score": lambda: scored("score cases mine.csv theirs.csv --plot all.svg"),
    "score json": lambda: scored("score cases a/it.csv b/it.csv --json --tolerance 1e-6"),
    "score, all right": lambda: scored("score cases mine.csv", 1),
    "score into a page": lambda: scored("score cases mine.csv -o page.html"),
    "cases into a folder": lambda: written_cases("cases --group easy -o them"),
    "cases into a folder, json": lambda: written_cases("cases --group easy -o them --json"),
    "derive chapters": lambda: derived("derive all --pdf -o them -v"),
    "derive a chapter, json": lambda: derived("derive sticks --scene fig9 --format html --json"),
    "derive a chapter to stdout": lambda: derived("derive sticks -o -"),
    "derive, pdf fails": lambda: derived("derive sticks --pdf -o them", latex=False),
    "derive, no latex": lambda: derived("derive sticks --pdf -o none"),
    "reproduce": lambda: reproduced("reproduce -o it"),
    "reproduce, changed": lambda: reproduced("reproduce --only fig8", changed=2, failed=1),
    "reproduce json": lambda: reproduced("reproduce --only fig8 --json", failed=1),
    "bench": lambda: benched("bench -o work.svg"),
    "bench quick, json": lambda: benched("bench --quick --json"),
    "bench hard": lambda: benched("bench --hard -o map.svg --quick"),
    "bench hard, wrong": lambda: benched("bench --hard --json", ok=False),
    "bench results": lambda: benched(
        "bench --results README.md --quick",
        README_md="<!-- results: begin -->\n<!-- results: end -->\n",
    ),
    "bench scores": lambda: benched("bench --scores page.md"),
    "bench scores of another kind": lambda: benched("bench --scores page.txt"),
    "bench scores and more": lambda: benched("bench --scores page.md --quick"),
    "warm": lambda: warmed("warm"),
    "warm json": lambda: warmed("warm --json"),
    "atlas": lambda: mapped(
        "atlas fig9 --over Omega=3:5 --over FN=5:12 -o a.json --plot a.svg --prove 0.5 --set k=2"
    ),
    "atlas json": lambda: mapped(
        "atlas fig9 --over Omega=3:5 --over FN=5:12 --json --seconds 3 --workers 2"
    ),
    "atlas of one parameter": lambda: mapped("atlas fig9 --over Omega=3:5"),
    "explore": lambda: explored("explore fig9 --set k=1/3"),
    "explore on a port": lambda: explored("explore --port 0 --no-browser"),
    "verify": lambda: verified((0, "proven: it"), "verify it.json --steps 9 --events 8 --bytes 7"),
    "verify a false one": lambda: verified((1, "not proven: it"), "verify it.json"),
    "verify none": lambda: verified((2, "no certificate"), "verify it.json"),
    "cite": lambda: told("--cite"),
}


# -- the program -------------------------------------------------------------------------------------------------------


def options() -> Iterator[str]:
    """Yield the options of all commands: names, types, defaults."""
    context = click.Context(app.main)
    for name in COMMANDS:
        command = app.main.get_command(context, name)
        assert command is not None
        for each in command.params:
            about = each.to_info_dict()
            kind = {key: value for key, value in sorted(about["type"].items()) if key != "name"}
            flags = [
                key for key in ("required", "multiple", "is_flag", "is_eager") if about.get(key)
            ]
            if each.default in (None, False) or "UNSET" in repr(each.default):
                default = ""
            else:
                default = each.default
            yield f"{name}: {' '.join(each.opts)} {each.nargs} {kind} {flags} {default} {getattr(each, 'metavar', '')}"


class Terminal(io.StringIO):
    """A stream that is a terminal."""

    def isatty(self) -> bool:
        return True


def on_a_terminal(**environment: str) -> str:
    """Return a table with words that have colours, as a terminal gets it."""
    rows = [
        ["1.5", "stick", "Omega1"],
        ["-10", "confirmed", "slip"],
        ["2e-3", "not as printed", "cross"],
    ]
    rows += [["3", "confirmed with a correction", "undecidable"]]
    shown = Terminal()
    with patch.object(sys, "stdout", shown), patch.dict("os.environ", environment):
        output.write_table(rows, ["t", "kind", "from"])
    return shown.getvalue().replace("\x1b", "ESC")


def bars() -> str:
    """Return what bars show at given times.

    Of counted steps, of percents, of work that begins anew, late ones.
    """
    clock = count(0.0, 0.5)
    shown = Terminal()
    environment = {"SYMOSC_PROGRESS_DELAY": "1", "COLUMNS": "100", "TERM": "xterm", "NO_COLOR": "1"}
    with (
        patch.object(progress, "monotonic", lambda: next(clock)),
        patch.object(sys, "stderr", shown),
        patch.dict("os.environ", environment),
    ):
        with progress.bar("counted", 8) as report:
            for done in (1, 2, 4, 3, 8):
                report(done, 8)
        shown.write("\n")
        with progress.reporting(True, 100, 400, "percents", "") as report:
            for done in (100, 200, 300, 400):
                report(done, 400)
        shown.write("\n")
        with progress.late_bar(True, "late", "events") as advance:
            assert advance is not None
            for part in (0.1, 0.5, 0.7, 1.0):
                advance(part, int(1e4 * part))
        shown.write("\n")
        clock = count(0.0, 0.03)
        with progress.bar("fast", 100) as report:
            for done in range(1, 101):
                report(done, 100)
    text = re.sub(r"\x1b\[[\d;?]*[A-Za-z]|\x1b.", "", shown.getvalue())
    return re.sub("[━╸╺ ]{6,}", " ━ ", text).replace("\r", "\n")


def delays() -> list[float]:
    found = []
    for text in ("0", "3.5", "-1", "86400", "86401", "x", "nan"):
        with patch.dict("os.environ", {"SYMOSC_PROGRESS_DELAY": text}):
            found.append(progress.delay())
    return found


def spinner() -> list[str]:
    """Return what is begun and ended for work of unknown length.

    When it is quiet, late, at once.
    """
    said: list[str] = []

    class Timer:
        def __init__(self, seconds: float, call: Any, given: Any) -> None:
            said.append(f"timer {seconds} {given}")
            self.call, self.given = call, given

        def start(self) -> None:
            said.append(f"started, daemon: {self.daemon}")  # type: ignore[attr-defined]
            self.call(*self.given)

        def cancel(self) -> None:
            said.append("cancelled")

    for delay in ("2", "0"):
        for quiet in (False, True):
            shown = Terminal()
            with (
                patch.object(progress, "Timer", Timer),
                patch.object(sys, "stderr", shown),
                patch.object(progress, "level", progress.QUIET if quiet else progress.NORMAL),
                patch.dict(
                    "os.environ", {"SYMOSC_PROGRESS_DELAY": delay, "TERM": "xterm", "COLUMNS": "80"}
                ),
            ):
                with progress.working("some work"):
                    said.append("working")
                said.append(
                    f"shown: {'some work' in shown.getvalue()}, waiting: {progress._waiting}"
                )
    progress._show_spinner("nobody waits")
    return said


def warned(kind: type[Warning]) -> str:
    """Return what a warning says."""
    shown = io.StringIO()
    with patch.object(sys, "stderr", shown):
        app._warn(kind("a warning"), kind, "file.py", 3)
    return shown.getvalue()


def failed(error: BaseException) -> str:
    """Return what the program says of an error in a command."""

    @click.command()
    def failing() -> None:
        raise error

    with patch.object(type(app.main), "get_command", lambda *_: failing):
        return told("simulate")


PROGRAM: dict[str, Case] = {
    "options": lambda: "\n".join(options()),
    "a table on a terminal": lambda: on_a_terminal(NO_COLOR=""),
    "a table without colours": lambda: on_a_terminal(NO_COLOR="1"),
    "bars": bars,
    "delays": delays,
    "a spinner": spinner,
    "a warning of the cache": lambda: warned(CodeCacheWarning),
    "an overflow": lambda: failed(OverflowError("too large")),
    "a full disk": lambda: failed(OSError(28, "No space left on device", "it.csv")),
    "a broken stdout": lambda: failed(OSError("broken")),
    "an abort": lambda: failed(click.Abort()),
    "two verbosities": lambda: told("simulate fig7 --t-end 3 -q --verbose"),
    "no command": lambda: told(""),
    "an unknown command": lambda: told("simulat fig5"),
}


LINES: dict[str, Case] = {
    name: partial(told, line) for name, line in (MOTIONS | ORBITS | GRAZING | CODE).items()
}
LINES["new where one is"] = partial(told, "new mine.toml", mine_toml="mine")
LINES["new where one is, forced"] = partial(told, "new mine.toml --force", mine_toml="mine")
LINES["codegen over another"] = partial(told, "codegen P32 -o .", p32_py="mine")
LINES["codegen over another, forced"] = partial(told, "codegen P32 -o . --force", p32_py="mine")
LINES |= {name: lambda line=line: told(line, it_csv=measured()) for name, line in FITS.items()}  # type: ignore[misc]
LINES |= {
    f"fit of {name}": partial(told, FITS["fit"], it_csv=text) for name, text in BAD_FITS.items()
}
LINES |= models()
LINES |= {name: partial(checked, line) for name, line in CHECKS.items()}
LINES["check a solver"] = partial(
    told, "check fig9 --t-end 3 --solver mine.py:solve", mine_py=SOLVER
)
LINES |= {name: needing("xarray", partial(told, line)) for name, line in SWEEPS.items()}
LINES |= {name: needing("flint", partial(told, line)) for name, line in CERTIFIED.items()}
CASES: dict[str, Case] = LINES | OTHERS | PROGRAM
