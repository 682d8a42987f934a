"""Certificates of each kind with their files, what the checkers say of right and wrong ones, and atlases."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any
from unittest.mock import patch

from paper_orbits import FIG9
from parameter_sets import AT_REST
from said import empty_folder, errors_of

import symosc
from symosc import Parameters, Scene, load_scene
from symosc.base.files import write_text
from symosc.certificates.certificate import common_complex, common_digits, provable

#: A plane across which a stick is born, and one with a region of rest.
PLANE = {"Omega": ("3.25", "3.33"), "FN": ("9.9", "10.1")}
RESTING = {"Omega": ("0.99", "1.01"), "FN": ("0.95", "1.02")}
#: Planes that are proven at once: with sticks on belt 2, with crossings of both belts, and of belts
#: that mirror.
CROSSING = Parameters(
    m=1, c="0.2", k=1, A0=0, B0=1, Omega=1, v1=-3, v2="2.9", mu1=1, mu2=1, FN="0.25"
)
PROVEN: tuple[tuple[Any, dict[str, Any]], ...] = (
    ("fig10", {"v2": ("0.999", "1.001"), "Omega": ("1.749", "1.751")}),
    (CROSSING, {"Omega": ("0.999", "1.001"), "FN": ("0.249", "0.251")}),
    (CROSSING.replace(v2=3), {"B0": ("0.999", "1.001"), "c": ("0.199", "0.201")}),
)
MADE = (
    "motion fig5 7",
    "motion fig6",
    "motion fig7-exact",
    "motion fig8 9",
    "motion fig10 4",
    "circle",
    "swing",
    "derivatives fig5 7",
    "settled fig10-orbit 4000",
    "orbit fig9",
    "orbit fig10",
    "orbit 3",
    "orbit 500",
    "window fig9 P2",
    "window fig8 P5 paper",
    "window fig10 P6",
    "window fig5 P3",
    "branch short",
)


def document(name: str) -> Any:
    from certificate_files import document

    return document(name)


def motions() -> Iterator[Any]:
    """Yield files of certificates, all of their numbers, and what the checker says."""
    from certificate_files import judged, text_of

    for name in MADE:
        found = json.loads(text_of(name))
        intervals = name.startswith("branch")  # how many it takes depends on how balls are rounded
        if intervals:
            kept = ("parameters", "word", "parameter", "ends")
        else:
            kept = found.keys() - {"made_by"}
        yield {key: value for key, value in found.items() if key in kept}
        code, line = judged(found)
        yield f"{name}: {code} {line.partition(', by')[0]}"


def objects() -> Iterator[Any]:
    """Yield what certificates have beside their files, and proofs with other options."""
    made = [
        symosc.certify("fig5", t_end=3, digits=40),
        symosc.certify("fig9", t_end=1, start_error="1e-6"),
        symosc.certify("fig9", t_end="1T", start_error=["1e-3", "0.5", 0]),
        symosc.certify("fig10", t_end=2, wrt=("Omega", "v1")),
        symosc.certify(FIG9, t_end=1),
        symosc.certify("fig9", t_end=1, wrt="v0"),
        symosc.certify("fig7", t_end=3, wrt=("k", "x0")),
        symosc.certify("fig8", t_end=4, start_error="1e-2"),
        symosc.certify(symosc.find_orbit("fig9")),
    ]
    for each in made:
        yield [repr(each), each.message, str(each.stable)]
        yield [each.events, each.points, each.multipliers, each.derivatives]
    undriven = Scene("still", AT_REST.replace(B0=0, c=0), 0, "0.3", 0, 5)
    yield symosc.certify(undriven).message
    yield symosc.certify(Scene("start", AT_REST, 0, "0.5", 0, 5)).message
    for p in (FIG9, FIG9.replace(k=0), FIG9.replace(k=0, c=0), AT_REST.replace(c=0)):
        yield " ".join(provable(p, p.v1)) + "; " + " ".join(provable(p, Fraction(3)))
    yield [
        common_digits("1.2345", "1.2349"),
        common_digits("-1", "1"),
        common_complex(("1", "1.1"), ("-2", "-2")),
    ]
    yield common_complex(("0.5", "0.5"), ("0", "0"))


def changed() -> Iterator[str]:
    """Yield what the checker says of files with one number or word changed."""
    from certificate_files import FORGED, forged, judged, moved, put

    motion, orbit, window, settled = (
        document(name) for name in ("motion fig5 7", "orbit fig9", "window fig9 P2", MADE[8])
    )
    wrong: list[Any] = [forged(path.stem) for path in sorted(FORGED.glob("*.json"))]
    for i in (0, 2, -1):
        wrong += [put(motion, "events", i, "t", lambda ends: moved(ends, "1e-9"))]
        wrong += [put(motion, "events", i, "x", lambda ends: moved(ends, "-1e-9"))]
        wrong += [
            put(motion, "events", i, "kind", "cross"),
            put(motion, "events", i, "target", "Omega2"),
        ]
    wrong += [
        motion | {"events": motion["events"][:-1]},
        motion | {"t_end": "3"},
        motion | {"events": []},
    ]
    wrong += [
        motion | {"mode": "Omega3"},
        motion | {"starts": "some"},
        motion | {"start_error": ["0", "1", "0"]},
    ]
    wrong += [
        put(motion, "parameters", "FN", "9"),
        put(motion, "start", "x0", "0.1"),
        motion | {"format": "x"},
    ]
    wrong += [
        put(orbit, "parameters", "Omega", "4.01"),
        orbit | {"stable": False},
        orbit | {"word": "P23"},
        orbit | {"periods": 2},
    ]
    wrong += [put(orbit, "multipliers", 0, "re", lambda ends: moved(ends, "1e-3"))]
    wrong += [
        window | {"grazes": "nowhere"},
        window | {"map": "P3"},
        window | {"ends": window["ends"][::-1]},
    ]
    wrong += [
        put(window, "ends", 0, "phase", lambda ends: moved(ends, "1e-6")),
        window | {"order": "paper"},
    ]
    wrong += [
        settled | {"count": settled["count"] + 1},
        settled | {"periods": 2},
        settled | {"last": settled["last"][1:]},
    ]
    wrong += [put(settled, "cycle", 1, "t", lambda ends: moved(ends, "1e-9"))]
    wrong += [{"kind": kind} for kind in ("trajectory", "x")] + [3, [], {}]
    for each in wrong:
        if isinstance(each, dict):
            content = each
        else:
            content = {"kind": each}
        code, line = judged(content)
        yield f"{code} {line.splitlines()[0]}"
    yield " ".join(sorted(key for key in orbit)) + "; " + " ".join(sorted(key for key in window))


def drawn() -> Iterator[Any]:
    """Yield atlases: their regions, boxes and what was found without proof, their words, and a file."""
    from symosc.certificates import atlas as atlases

    with patch.object(atlases, "GRID", 2):
        yield from of_atlas(symosc.atlas(AT_REST, RESTING, workers=1))
        for p, over in PROVEN:
            plane = symosc.atlas(p, over, prove="0.3", workers=1)
            yield from of_atlas(plane)
            yield symosc.certify(plane).message
        plane = symosc.atlas(FIG9, PLANE, prove="0.1", workers=1)
        yield from of_atlas(plane)
        yield from file_of_atlas(plane)


def of_atlas(plane: symosc.Atlas) -> Iterator[Any]:
    yield repr(plane)
    yield [list(region) for region in plane.regions]
    statement = plane.statement()
    yield {key: value for key, value in statement.items() if key not in ("found", "boxes")}
    yield [
        (box["word"], *map(str, box["range"]), *box["phases"], *box["x"])
        for box in statement["boxes"]
    ]
    yield statement["found"]["grid"]
    yield [
        (*map(str, border["words"]), border["kind"], border["sliding"])
        for border in statement["found"]["borders"]
    ]
    (a, b), (c, d) = plane.range
    for x, y in ((a, c), ((a + b) / 2, (c + 2 * d) / 3), (b, d)):
        yield plane.word_at(**dict(zip(plane.over, (x, y), strict=True)))


def file_of_atlas(plane: symosc.Atlas) -> Iterator[Any]:
    from symosc.certificates.verify_orbits import judge

    with empty_folder() as folder:
        path = folder / "plane.json"
        plane.to_json(path)
        data = json.loads(path.read_text(encoding="utf-8"))
        again = symosc.atlas(FIG9, PLANE, path=path, workers=1)
        yield [again.proven == plane.proven, again.grid == plane.grid, len(again.borders)]
        write_text(path, "{}")
        errors = [
            lambda: symosc.atlas(FIG9, PLANE, path=path),
            lambda: symosc.atlas(AT_REST, PLANE | {"k": (1, 2)}),
            lambda: symosc.atlas(AT_REST, {"Omega": (1, 2), "FN": (2, 1)}),
            lambda: symosc.atlas(AT_REST, {"Omega": (1, 2), "FN": 1}),  # type: ignore[dict-item]
            lambda: symosc.atlas(AT_REST, {"Omega": (1, 2), "c": (0, 1)}),
            lambda: symosc.atlas(AT_REST, PLANE, prove=2),
            lambda: symosc.atlas(AT_REST, PLANE, seconds=0),
            lambda: plane.word_at(Omega=1),
            lambda: plane.word_at(Omega=1, FN=10),
        ]
        yield errors_of(errors)
    yield symosc.certify(plane).message
    for changes in ({"share": "1/3"}, {"boxes": data["boxes"][1:], "share": "1/4"}, {"open": []}):
        code, line = judge(data | changes)
        yield f"{code} {line.splitlines()[0]}"


CASES: dict[str, Callable[[], object]] = {
    "files": motions,
    "objects": objects,
    "changed": lambda: "\n".join(changed()),
    "atlas": drawn,
    "errors": lambda: errors_of(
        [
            lambda: symosc.certify(FIG9),
            lambda: symosc.certify("fig9", wrt="m", start_error=1),
            lambda: symosc.certify(symosc.find_orbit("fig9"), digits=20),
            lambda: symosc.certify("fig9", digits=501),
            lambda: symosc.certify(load_scene("fig9"), t_end=0),
            lambda: symosc.certify("fig9", t_end="nan"),
            lambda: symosc.certify("fig9", start_error=-1),
            lambda: symosc.certify("fig55"),
            lambda: symosc.certify(None),  # type: ignore[arg-type]
            lambda: symosc.certify(["fig5"]),  # type: ignore[arg-type]
        ]
    ),
}
