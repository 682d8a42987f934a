"""Sweeps, their plans, files and chunks; scenes with their files and what is wrong with these."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from paper_orbits import FIG9
from said import empty_folder, error_of, errors_of

from symosc import OtherModel, Scene, load_scene, scene_names
from symosc.scenes import as_toml, end_time, from_rest, read_scene
from symosc.scenes.files import line_of
from symosc.sweeps.output import dataset_of, output_path, plan_of, read_columns, write_output
from symosc.sweeps.plan import SweepPlan, compute, kernels_hash, read_duration, read_plan
from symosc.sweeps.store import Store, missing
from symosc.sweeps.sweep import _fill, _next_chunk, read_executor, sweep, sweep_status

OVER = {"Omega": "3:5:3", "FN": [5, "12.5"]}
EVERY = ("word", "events", "x", "t", "stuck", "mode", "multiplicity", "section:2", "v_max")
PLANS: dict[str, dict[str, Any]] = {
    "grid": {"over": OVER, "record": EVERY, "t_end": "6T", "skip": "4T"},
    "table": {
        "over": [{"Omega": 3, "k": "1/3"}, {"Omega": "3.5", "k": 2}],
        "record": "word",
        "t_end": 9,
        "skip": 1,
    },
    "starts": {"over": {"x0": [1, 2, 3]}, "record": ("x", "section"), "t_end": "3T", "skip": 0},
    "rows": {
        "over": {"FN": [1, 2]},
        "record": ["events"],
        "t_end": 5,
        "skip": 0,
        "starts": [(0, 1, 2), ("1/2", 3, 25)],
    },
    "one": {
        "over": {"B0": "-1:1:3"},
        "record": "word",
        "t_end": 5,
        "skip": 2,
        "starts": {"t0": 0, "x0": 1, "v0": 2},
    },
}


@cache
def planned(name: str) -> SweepPlan:
    given = {"starts": None} | PLANS[name]
    return read_plan(
        "fig9", *(given[each] for each in ("over", "record", "t_end", "skip", "starts"))
    )


def plans() -> Iterator[Any]:
    """Yield plans, the calls of their chunks, and their cells."""
    for name in PLANS:
        plan = planned(name)
        content = plan.content | {"symosc": "", "kernels": ""}
        yield content | {"swept": [swept[:3] for swept in content["swept"]]}
        yield [len(plan), *map(str, plan.sizes.items()), *plan.column_names]
        yield {name: each.values for name, each in plan.coordinates.items()}
        yield {name: column.tolist() for name, column in plan.cells(1, len(plan)).items()}
        arguments = plan.arguments(0, len(plan))
        yield {each: arguments[each] for each in ("t_end", "skip", "sections", "start_error")}
        yield [
            *map(str, (name for name, value in arguments["parameters"].items() if np.ndim(value)))
        ]
    rest = read_plan(FIG9, {"c": [0, 1]}, "word", "5T", 0)
    yield [str(read_duration("t_end", each)) for each in (9, "9T", " 1.5 T ", "1/3*T", "1e1")]
    yield [str(rest.t_end), rest.scene.name, str(rest.t_end.times(2.0)), len(rest.key)]


def without_versions(text: str) -> str:
    """Return text without versions and checksums."""
    return re.sub(r"symosc [\d.]+, kernels \w+|[0-9a-f]{64}", "…", text)


def same_numbers(one: np.ndarray, other: np.ndarray) -> bool:
    return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")


@cache
def columns(name: str) -> dict[str, np.ndarray]:
    plan = planned(name)
    found, _ = compute(plan.arguments(0, len(plan)), kernels_hash())
    return found


def datasets() -> Iterator[Any]:
    """Yield results with their attributes, and the CSV file of each."""
    for name in PLANS:
        dataset = dataset_of(planned(name), columns(name))
        for each in (*dataset.data_vars, *dataset.coords):
            variable = dataset[each]
            yield [each, *map(str, (variable.dims, variable.shape, sorted(variable.attrs.items())))]
            yield (
                variable.values.ravel().tolist() if variable.dtype.kind == "U" else variable.values
            )
        yield [without_versions(f"{key}: {value}") for key, value in dataset.attrs.items()]
        with empty_folder() as folder:
            path = folder / "map.csv"
            write_output(dataset, path, folder)
            yield from without_versions(path.read_text(encoding="utf-8")).splitlines()[:4]
            same = {
                each: same_numbers(column, columns(name)[each])
                for each, column in read_columns(path).items()
            }
            yield [plan_of(path) == planned(name).key, *map(str, same.items())]


def swept() -> Iterator[Any]:
    """Yield sweeps with files of each kind, continued and begun anew, and their status."""
    options: dict[str, Any] = {"record": ("word", "section:2"), "t_end": "6T", "skip": "4T"}
    with empty_folder() as folder:
        for suffix in (".nc", ".zarr", ".csv"):
            path = folder / f"map{suffix}"
            yield list(sweep_status("fig9", OVER, **options, path=path)[1:])
            whole = sweep("fig9", OVER, **options, path=path)
            plan = read_plan("fig9", OVER, *options.values())
            with closing(
                Store(path)
            ) as left:  # as if it was stopped before it could remove its chunks
                left.open(plan.key, plan.content)
            again = sweep("fig9", OVER, **options, path=path)
            yield [
                suffix,
                *whole.word.values.ravel().tolist(),
                whole.identical(again),
                whole.section.values.sum(),
            ]
            yield list(sweep_status("fig9", OVER, **options, path=path)[1:])
        store = Store(folder / "part.nc")
        yield sorted(each.name for each in folder.iterdir())
        store.open(plan.key, plan.content)
        store.write(1, 3, {name: column[1:3] for name, column in columns_of(plan).items()})
        yield list(sweep_status("fig9", OVER, **options, path=store.output)[1:])
        yield [
            *map(str, store.ranges()),
            str(store.key() == plan.key),
            *sorted(each.name for each in store.folder.iterdir()),
        ]
        yield [
            (begin, end, *chunk["word"]) for begin, end, chunk in store.chunks(plan.column_names)
        ]
        errors = [
            lambda: Store(store.output).open(plan.key, {}),
            lambda: sweep_status("fig9", {"k": [3]}, path=store.output),
            lambda: sweep("fig9", {"k": [3]}, path=folder / "map.nc"),
            lambda: output_path(folder / "map.txt"),
            lambda: output_path("-"),
            lambda: output_path(folder / "no" / "map.nc"),
            lambda: read_executor(3, None),
            lambda: read_executor(None, 0),
        ]
        yield errors_of(errors)
        store.close()
        calls = list[str]()
        whole = sweep(
            "fig9",
            OVER,
            **options,
            path=store.output,
            progress=lambda *done: calls.append(str(done)),
        )
        yield [
            *whole.word.values.ravel().tolist(),
            *calls,
            *sorted(each.name for each in folder.iterdir()),
        ]
    yield missing([(2, 4), (3, 6), (8, 9)], 12)
    filled: dict[str, np.ndarray] = {}
    for begin, words in ((0, ["P32", ""]), (3, ["P3121"]), (2, ["P1"])):
        _fill(filled, 4, begin, begin + len(words), {"word": np.array(words)})
    yield filled["word"].tolist()
    todo = [(20, 30), (0, 10)]
    yield [*map(str, (_next_chunk(todo, 4, 2) for _ in range(5))), *map(str, todo)]


def columns_of(plan: SweepPlan) -> dict[str, np.ndarray]:
    return compute(plan.arguments(0, len(plan)), kernels_hash())[0]


SHIFTED = OtherModel(
    m=2, k="8.5", c="0.4", Omega="3/2", FN="1.5", Y="0.7", joined=True, B0=1, phase="pi/2"
)


def scenes() -> Iterator[str]:
    """Yield the files of scenes, with and without comments, also of another model, and what changes give."""
    for name in scene_names():
        yield as_toml(load_scene(name))
    yield as_toml(load_scene("fig9"), explained=True, file="first.toml")
    mine = Scene(
        "mine",
        SHIFTED,
        t0="1/3",
        x0="pi/4",
        v0=1,
        t_end=9,
        structure="P32",
        source="a book",
        start_error=1e-9,
    )
    yield as_toml(mine, explained=True)
    yield as_toml(mine.reduced())
    plain = Scene("plain", FIG9, t0=0, x0="sqrt(2)", v0=25, t_end="5.5")
    for scene in (mine, plain):
        for given in ({"x0": 2}, {"t_end": "4T"}, {"t0": "1/7", "t_end": "1.5 T"}, {}):
            moved = scene.started(given)
            yield as_toml(moved)
            yield f"{moved.original is None} {moved.notes}"
        yield as_toml(scene.changed(k=2))
    for other in (replace(mine, name="other"), replace(mine, x0=5), replace(mine, parameters=FIG9)):
        yield f"{other.name} {other.original == mine.original} {other.original is None}"
    for start in ({"t0": 0}, {"t0": "1/2"}):
        scene = Scene("base", SHIFTED.replace(B0=0), x0=1, v0=2, t_end=9, **start)
        yield f"{scene.start_error} {scene.original.start_error} {scene.reduced().start_error}"
    yield f"{from_rest(FIG9, '2T')!r} {end_time('2T', FIG9, '1/2')} {end_time(3, FIG9, 0)}"
    text = as_toml(mine, explained=True)
    read = read_scene(text, "mine.toml")
    yield f"{read == mine} {read.original == mine.original} {line_of(text, ('start', 'x0'))} {line_of(text, ('none',))}"
    found = read_scene(as_toml(plain).replace("25", '"3*pi/2"'), "noted.toml")
    yield f"{found.notes} {found.start_error}"


def wrong_scenes() -> Iterator[str]:
    """Yield what is said of files with a fault in each place."""
    text = as_toml(load_scene("fig9"), explained=True)
    faults = {
        "m = 0.1": [
            "m = -1",
            "m = true",
            'm = "x"',
            "m = 1e99",
            "mm = 1",
            "# m = 1",
            "m = [1]",
            "m = nan",
        ],
        "v1 = 1": ["v1 = 30", 'v1 = "1/0"'],
        "t_end = 1": [
            "t_end = -1",
            "t_end = []",
            "t_end = 1e5000",
            "t_end = 1e9999999999999999999999",
            "reference = 3\nt_end = 1",
        ],
        'name = "fig9"': [
            "name = 5",
            'name = " "',
            'nam = "x"',
            'structure = "P99"',
            "structure = 7",
            "source = []",
        ],
        "[start]": [
            "[starts]",
            "",
            "[start]\nx0 = 1",
            "[model]\nY = 1\n[start]",
            "[start]\nstart_error = [1, 2]",
        ],
        "[parameters]": [
            "[parameters]\nY = 1",
            "[[parameters]]",
            "parameters = 3\n[other]",
            "[model]\nZ = 1\n[parameters]",
        ],
    }
    yield from of_faults(text, faults)
    text = as_toml(Scene("wall", SHIFTED, 0, 1, 0, 9))
    faults = {
        "Y = 0.7": ["Z = 1", 'Y = "one"'],
        "joined = true": ["joined = 1"],
        "m = 2": ["m = -1", ""],
        "FN = 1.5": ["", "FN = 0.5\nmu2 = 1"],
        "[model]": ["[modell]"],
        "[model]\njoined = true\nphase = 1.570796326794896619231321691639751442099\nY = 0.7\n": [
            ""
        ],
    }
    yield from of_faults(text, faults)
    for whole in (
        "",
        "x",
        "a." * 300,
        "# " * 60_000,
        "[model]\nY = 1\n[parameters]\nm = 1",
        "t_end = 1",
    ):
        yield errors_of([lambda whole=whole: read_scene(whole, "mine.toml")])


WRONG_OVER: tuple[Any, ...] = (
    {}, {"omega": [1]}, {"k": "1:2"}, {"k": "2:1:3"}, {"k": "2:2:3"}, {"k": [1, 1]}, {"k": [[1]]}, {"k": [1, -1]},
    {"v1": [1, 26]}, {"k": "1:2:2000000000"}, {name: [1, 2] for name in ("m", "c", "k", "FN")}, {"m": [1, 0]},
    [{"k": 1}, {"c": 1}],
    {"Omega": "-1:1:5"}, {"FN": [3, -1, 2]}, {"v2": [0.5, 30]}, {"v1": [0, 3], "v2": [2, 5]}, [{"k": 1}, {"k": -1}],
    [{"v1": 0, "v2": 1}, {"v1": 3, "v2": 3}], {"k": []}, [{}], 3, [{"k": 1}, 3], "k", {"k": 3}, {"k": {}},
)  # fmt: skip
WRONG_RECORDS: tuple[Any, ...] = (
    (), "words", ("x", "x"), ("section:2", "section:3"), "word:3", "section:0", "section:", "section:x",
)  # fmt: skip
#: Ends and what is skipped; Omega = 3 has not ended its fourth period at t = 8.
WRONG_TIMES: tuple[tuple[Any, Any], ...] = (
    ("0T", 0), (0, 0), ("0.1324", 0), (5, -1), ("9T", "9T"), ("9T", 100), (5, 6), (8, "4T"), ("T", 0), ("-1T", 0),
    ("1e12T", 0), (" 1.5 T ", 2),
)  # fmt: skip


def of_faults(text: str, faults: dict[str, list[str]]) -> Iterator[str]:
    """Yield what is said of a scene's text with each of its lines replaced."""
    for old, others in faults.items():
        assert old in text
        for new in others:
            changed = text.replace(old, new)
            yield f"{new!r}: {error_of(lambda changed=changed: read_scene(changed, 'mine.toml'))}"  # type: ignore[misc]


CASES: dict[str, Callable[[], object]] = {
    "plans": plans,
    "datasets": datasets,
    "swept": swept,
    "scenes": lambda: "\n".join(scenes()),
    "wrong scenes": lambda: "\n".join(wrong_scenes()),
    "errors": lambda: errors_of(
        [
            lambda: read_plan(FIG9, OVER, "word", None, 0),
            *(lambda over=over: read_plan("fig9", over, "word", 5, 0) for over in WRONG_OVER),
            *(
                lambda record=record: read_plan("fig9", {"k": [1]}, record, 5, 0)
                for record in WRONG_RECORDS
            ),
            *(
                lambda end=end, skip=skip: read_plan("fig9", OVER, "word", end, skip)
                for end, skip in WRONG_TIMES
            ),
            lambda: read_plan("fig9", {"t0": [1, 7]}, "word", 5, 0),
            lambda: read_plan("fig9", {"x0": [1]}, "word", 5, 0, [(0, 1, 2)] * 2),
            lambda: read_plan("fig9", {"k": [1]}, "word", 5, 0, [(0, 1)]),
            lambda: read_plan(Scene("m", SHIFTED, 0, 0, 0, 9), {"k": [1]}, "word", 5, 0),
            lambda: compute({}, "other"),
            lambda: Scene("", FIG9, 0, 0, 0, 1),
            lambda: Scene("x", FIG9, 0, 0, 0, 0),
            lambda: Scene("x", FIG9, 0, 0, 0, 1, structure="P5"),
            lambda: Scene("x", 3, 0, 0, 0, 1),  # type: ignore[arg-type]
            lambda: Scene("x", FIG9, 0, 0, 0, 1, notes=["a"]),  # type: ignore[arg-type]
            lambda: Scene("x", FIG9, 0, 0, 0, 1, start_error=-1),  # type: ignore[arg-type]
            lambda: load_scene("fig9").started({"x": 1}),
            lambda: load_scene("fig9").started({"t_end": "xT"}),
            lambda: load_scene("no.toml"),
        ]
    ),
}
