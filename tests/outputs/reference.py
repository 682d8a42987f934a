"""Reference cases: the definition of each, known events, files of a set, and scores of right and wrong results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from types import SimpleNamespace
from typing import Any

from said import empty_folder, outcome

from symosc import ReferenceCase, SymoscError, reference_cases
from symosc.reference import cases, folder, score
from symosc.reference.case import KnownChange, shifted, with_known
from symosc.reference.results import CaseResult, GivenEvent, read_results
from symosc.reference.score import Score

PEAK = "peak-beyond-a-belt-by-1e-7-P2-fig7-corrected"
SMALL = ("paper-fig6", "rest-1", "graze-overdamped-P3", "free-decay-2", "continuum-1-2", PEAK)


def defined() -> str:
    """Return the definition of each case, a line for each."""
    lines = []
    for case in reference_cases():
        numbers = [
            *case.parameters.as_dict().values(),
            *map(str, (case.t0, case.x0, case.v0, case.t_end)),
        ]
        numbers += [str(case.scene.start_error)]
        about = (
            case.group,
            case.hard[-60:],
            case.source[:12],
            *case.closed_form[-2:],
            case.open[:20],
        )
        lines.append(
            f"{case.name} {' '.join(n[:30] for n in numbers)} {case.periods} {case.quick} {' | '.join(about)}"
        )
    return "\n".join(lines)


@cache
def computed(name: str) -> ReferenceCase:
    """Return a case whose events are computed and taken for unproven, with some derivatives."""
    case = replace(cases.reference_case(name), open="for a test")
    changes = [
        {"mu1": KnownChange((f"{i}.5", f"{i}.5"), ("-0.25", "-0.25"), False)}
        if event.kind != "graze"
        else {}
        for i, event in enumerate(case.events)
    ]
    return with_known(case, derivatives=tuple(changes))


def known(name: str) -> str:
    """Return the known events of a case and their conditions."""
    case = computed(name)
    lines = [f"{case!r} {case.count} {case.status} {case.condition:.6g}"]
    for event, condition in zip(case.events, case.conditions, strict=True):
        t, x = (float(value) for value in event.middle)
        lines.append(
            f"{t:.12g} {x:.12g} {event[2:]} {condition:.6g} {[len(each) for each in (*event.t, *event.x)]}"
        )
    return "\n".join(lines)


# -- results of solvers, and their scores ------------------------------------------------------------------------------


def right(name: str) -> list[GivenEvent]:
    """Return what a perfect solver finds, with a derivative of each regular event."""
    found = [
        GivenEvent(*event.middle, event.kind, event.boundary) for event in computed(name).events
    ]
    rows = computed(name).derivatives
    return [
        e._replace(changes={"dt_mu1": i + 0.5, "dx_mu1": -0.25}) if rows[i] else e
        for i, e in enumerate(found)
    ]


def off(event: GivenEvent, t: float = 0.0, x: float = 0.0, **changes: Any) -> GivenEvent:
    """Return an event at another time and place, or of another kind."""
    if event.x is None:
        moved = None
    else:
        moved = event.x + Fraction(x)
    return event._replace(**{"t": event.t + Fraction(t), "x": moved, **changes})


def faulty() -> dict[str, CaseResult]:
    """Return results with every kind of fault."""
    slip, stick, last = right("paper-fig6")
    touch, *others = right("graze-overdamped-P3")
    decay = right("free-decay-2")
    orbit = right("continuum-1-2")
    start = GivenEvent(Fraction(0), None, "stick", 2)
    contacts = [off(touch, -1e-6, kind="stick"), off(touch, 1e-6, kind="slip")]
    late = off(decay[2], 3e-7, 1e-8, changes={"dt_mu1": 2.6})
    return {
        "paper-fig6": CaseResult(
            [start, slip, off(stick, boundary=2), off(last._replace(x=None), 1e-12)], seconds=0.25
        ),
        "rest-1": CaseResult([GivenEvent(Fraction(3), Fraction(1), "cross", 1)], end=Fraction(50)),
        "graze-overdamped-P3": CaseResult([*contacts, *others], seconds=1.5, end=Fraction(20)),
        "free-decay-2": CaseResult([*decay[:2], late, *decay[4:], off(decay[-1], 1)]),
        "continuum-1-2": CaseResult(
            [off(event, 2e-10, boundary=0) for event in orbit], end=Fraction(54)
        ),
        PEAK: CaseResult(note="chatters"),
    }


@cache
def scores() -> list[Score]:
    """Return the scores of a right solver and of a faulty one."""
    chosen = [computed(name) for name in SMALL]
    perfect = {name: CaseResult(right(name), end=Fraction(10**6)) for name in SMALL[:-1]}
    return [score.score("right|one", chosen, perfect), score.score("<wrong>", chosen, faulty())]


def judged(tolerance: float) -> str:
    """Return the faults of the faulty solver by another tolerance, and the numbers of each case."""
    found = score.score("wrong", [computed(name) for name in SMALL], faulty(), tolerance)
    rows = [
        ", ".join(f"{key} {value}" for key, value in each.as_dict().items() if key != "wrong")
        for each in found.cases
    ]
    return "\n".join(
        [*rows, *score.faults(found), score.verdict(found), str(list(found.as_dict().values())[:6])]
    )


def long_run() -> str:
    """Return the faults of results of a case of which only the last period is compared."""
    case = computed("continuum-1-2")
    part = {name: getattr(case, name)[-2:] for name in ("events", "conditions", "derivatives")}
    long = with_known(replace(case, periods=4), **part)
    events = right("continuum-1-2")
    lines = [""]
    extra = off(events[0], 1.0)
    for given in (
        events,
        events[-2:],
        events[1:],
        [extra, *events],
        [extra, extra, *events],
        events[:-1],
        events[2:7],
    ):
        found = score.judge_case(long, CaseResult(given), 1e-9)
        lines.append(
            f"{found.missed} {found.invented} {found.right} {[str(wrong) for wrong in found.wrong]}"
        )
    return "\n".join(lines)


NAMES = ("paper-fig6", "rest-1")
#: Files of results by their names: what is in them.
RESULTS = {
    "a.csv": (
        "case,t,x,kind,boundary,seconds\npaper-fig6,2,1,Stick,1,0.5\n"
        "paper-fig6,1,1,slip,2.0,0.7\nrest-1,9,,end,,\n"
    ),
    "b.csv": "case;t;x;kind;boundary\npaper-fig6;1,5;2d-1;cross;2\n",
    "c.csv": "case,t_low,t_high,x_low,x_high,kind,dt_mu1\npaper-fig6,1,2,3,5,cross,0.5\n",
    "d.json": (
        '{"paper-fig6": {"seconds": 2, "events": [{"t": 3, "x": 2, "kind": "graze", "dx_m": 3}]},'
        ' "rest-1": {"events": []}}'
    ),
    "e.json": '{"rest-1": {"events": [{"t": 2, "kind": "end"}, {"t": 1, "kind": "end"}]}}',
    "half.csv": "case,t,t_low,x_high,kind\nrest-1,3,2,9,cross\n",
    "paper-fig6.csv": "t,kind\n1,cross\n",
    "rest-1.csv": "t,kind\n",
    "other.csv": "t,kind\n1,cross\n",
    "wrong kind.csv": "case,t,kind\nrest-1,1,stop\n",
    "no t.csv": "case,t,kind\nrest-1,,cross\n",
    "no column.csv": "case,x,kind\nrest-1,1,cross\n",
    "belt 3.csv": "case,t,kind,boundary\nrest-1,1,cross,3\n",
    "belt x.csv": "case,t,kind,boundary\nrest-1,1,cross,x\n",
    "no number.csv": "case,t,kind\nrest-1,one,cross\n",
    "negative.csv": "case,t,kind,seconds\nrest-1,1,cross,-1\n",
    "twice.csv": "case,t,kind,kind\nrest-1,1,cross,cross\n",
    "short.csv": "case,t,kind\nrest-1,1\n",
    "another.csv": "case,t,kind\nrest-2,1,cross\n",
    "list.json": '[1, 2]',
    "text.json": '"rest-1"',
    "no events.json": '{"rest-1": {"seconds": 1}}',
    "no object.json": '{"rest-1": {"events": [1]}}',
    "any.mat": "case,t,kind\n",
}  # fmt: skip


def read(*names: str) -> str:
    """Return the results in files, each alone or, if there are several, in one folder."""
    with empty_folder() as top:
        for each in names:
            (top / each).write_text(RESULTS[each], encoding="utf-8")
        found = outcome(
            lambda: read_results(top if len(names) > 1 else top / names[0], NAMES), SymoscError
        )
    if isinstance(found, str):
        return found
    return "\n".join(f"{key}: {r.events} {r.seconds} {r.note} {r.end}" for key, r in found.items())


# -- files of a set ----------------------------------------------------------------------------------------------------


def written() -> str:
    """Return the files of a set, without what depends on the version, and what is read of them, whole and damaged."""
    proof = SimpleNamespace(as_dict=lambda: {"made": "up"})
    chosen = [with_known(computed(name), certificate=proof) for name in SMALL[:4]]
    with empty_folder() as name:
        top = folder.write_cases(name / "set", chosen)
        paths = [path for path in sorted(top.rglob("*")) if path.is_file()]
        texts = {str(path.relative_to(top)): path.read_text(encoding="utf-8") for path in paths}
        version, found = folder.read_set(top)
        shown = [
            f"{c.name} {c.group} {c.scene.parameters.m} {c.t_end} {c.condition} {c.count}"
            for c in found
        ]
        shown += [str(list(each.items())[:1]) for c in found for each in c.derivatives]
        shown += [str(event)[:60] for c in found for event in c.events]
        (top / SMALL[0] / "events.csv").write_text("t,x\n", encoding="utf-8")
        shown.append(said(lambda: folder.read_set(top)))
        (top / SMALL[0] / "events.csv").unlink()
        shown.append(said(lambda: folder.read_set(top)))
        for text in ("{", "[]", '{"format": "other"}', f'{{"format": "{folder.SET_FORMAT}"}}'):
            (top / "manifest.json").write_text(text, encoding="utf-8")
            shown.append(said(lambda: folder.read_set(top)))
        shown.append(said(lambda: folder.read_set(top / "nowhere")))
    for each, text in texts.items():
        rows = text.splitlines()
        if each.endswith("trajectory.csv"):
            lines = rows[::60]
        elif each == "manifest.json":
            lines = []
        else:
            lines = rows
        shown += [each, *(line[:200] for line in lines)]
    return "\n".join([str(version), *shown])


def said(call: Callable[[], object]) -> str:
    return str(outcome(call, SymoscError))


def conditioned() -> str:
    """Return condition numbers, and what scenes become when a number is changed."""
    scene = replace(cases.reference_case("paper-fig6").scene, t_end=Fraction(4))
    others = [shifted(scene, name, Fraction(1, 8)) for name in ("v2", "v1", "v0", "x0", "m")]
    lines = [f"{s.parameters.as_dict()} {s.t0} {s.x0} {s.v0} {s.t_end}" for s in others]
    return "\n".join(lines)


def refused() -> str:
    """Return what is said of cases and groups that do not exist, and the numbers of those that do."""
    lines = [str(len(cases.chosen(group))) for group in (None, "easy", "long run")]
    lines += [said(lambda name=name: cases.reference_case(name)) for name in ("paper-fig4", "?")]  # type: ignore[misc]
    return "\n".join([*lines, said(lambda: cases.chosen("hard"))])


CASES: dict[str, Callable[[], object]] = {
    "definitions": defined,
    **{f"known events of {name}": partial(known, name) for name in SMALL},
    "no case": refused,
    "changed scenes": conditioned,
    "score as text": lambda: score.as_text(scores()),
    "score of one": lambda: score.as_text(scores()[1:]),
    "scores in Markdown": lambda: score.group_table(scores(), "github"),
    "score by 1e-6": lambda: judged(1e-6),
    "score by 1e-12": lambda: judged(1e-12),
    "score of a long run": long_run,
    "results in one file": lambda: "\n".join(read(name) for name in RESULTS),
    "results in folders": lambda: "\n".join(
        [read("paper-fig6.csv", "other.csv"), read("paper-fig6.csv", "rest-1.csv")]
    ),
    "files": written,
}
