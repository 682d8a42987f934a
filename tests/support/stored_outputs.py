"""Stored outputs: what figures, commands and calls gave when somebody last looked at all of it.

    python tests/support/stored_outputs.py [plot ...]     stores them anew: read the difference before you commit it

`tests/outputs/plot.py` has the CASES of a package, by name a function without arguments;
`plot.json` beside it is what these gave, as lines of text. `tests/test_outputs.py` compares: words
exactly, numbers nearly.
"""

from __future__ import annotations

import importlib
import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction
from numbers import Complex, Integral
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import Collection
from matplotlib.colors import to_hex
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.spines import Spine
from matplotlib.text import Annotation, Text
from matplotlib.ticker import FixedLocator

FOLDER = Path(__file__).parents[1] / "outputs"
NAMES = sorted(path.stem for path in FOLDER.glob("*.py"))
#: Numbers are the same within this share of the larger one. What is smaller than NOTHING is an
#: error, and may differ. Of more digits than doubles have, all count but the last three.
SHARE = 1e-6
NOTHING = 1e-8
#: Where the largest error of an event's time is: if that is noise, anywhere.
PLACE = r"(largest error of an event's time: \S+) at t = \S+"
NUMBER = re.compile(r"(?<![\w.])[+-]?\d+(?:\.\d*)?(?:e[+-]?\d+)?(?![\w.]*\w)")


def cases(name: str) -> dict[str, Callable[[], object]]:
    """Return the cases of a package."""
    found: dict[str, Callable[[], object]] = importlib.import_module(f"outputs.{name}").CASES
    return found


def stored(name: str) -> dict[str, list[str]]:
    """Return what the cases of a package gave."""
    found: dict[str, list[str]] = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return found


def lines_of(value: object, name: str = "") -> Iterator[str]:
    """Yield what a value contains.

    Text as it is, figures artist by artist, all else by its parts.
    """
    if isinstance(value, str) and not name:
        yield from value.splitlines()
    elif isinstance(value, Figure):
        yield from lines_of_figure(value)
    elif isinstance(value, np.ndarray) and value.dtype.kind in "iufcb" and value.size > 12:
        yield f"{name} {value.dtype.kind}{list(value.shape)}: {sampled(value)}"
    elif isinstance(value, np.ndarray):
        yield from lines_of(value.tolist(), name)
    elif is_dataclass(value):
        for field in fields(value):
            yield from lines_of(getattr(value, field.name), f"{name}.{field.name}")
    elif isinstance(value, Mapping):
        for key, part in value.items():
            yield from lines_of(part, f"{name}[{key}]")
    elif isinstance(value, Iterable) and not isinstance(value, (str, bytes)):
        parts = list(value)
        if all(isinstance(part, (Complex, Fraction, str)) for part in parts):
            yield f"{name} {' '.join(map(shown, parts))}"
        else:
            for number, part in enumerate(parts):
                yield from lines_of(part, f"{name}[{number}]")
    else:
        yield f"{name} {shown(value)}"


def some_lines(text: str, first: int | None, last: int | None = None) -> str:
    """Return some lines of a text.

    A cut between characters would move with the digits before it.
    """
    return "\n".join(text.splitlines()[first:last])


def shown(value: object) -> str:
    """Return one value in short, numbers with ten digits."""
    if isinstance(value, (bool, Integral, Fraction, str)) or not isinstance(value, Complex):
        return str(value)
    return f"{value.real:.10g}" + (f" {value.imag:+.10g} i" if value.imag else "")


def sampled(values: np.ndarray) -> str:
    """Return sums of an array with weights that differ, so that each value counts, and its ends."""
    flat = values.ravel().astype(complex if values.dtype.kind == "c" else float)
    known = np.isfinite(flat)
    weights = np.cos(np.arange(flat.size)[known])
    found = [known.sum(), flat[known].sum(), weights @ flat[known], np.abs(flat[known]).sum()]
    return " ".join(map(shown, [*found, *flat[:2], *flat[-2:]]))


def lines_of_figure(figure: Figure) -> Iterator[str]:
    """Yield what a figure shows: of each axes its words, limits and artists."""
    yield f"figure {shown(figure.get_figwidth())} by {shown(figure.get_figheight())}"
    for text in figure.texts:
        yield f"  text {text.get_text()}"
    for legend in figure.legends:
        yield f"  legend {[text.get_text() for text in legend.get_texts()]}"
    for axes in figure.axes:
        yield from lines_of_axes(axes, "  ")


def lines_of_axes(axes: Axes, indent: str) -> Iterator[str]:
    """Yield the words, limits and artists of one axes and of those inside."""
    title = [axes.get_title(loc=where) for where in ("left", "center", "right")]  # type: ignore[arg-type]
    yield f"{indent}axes {title} {axes.get_xlabel()!r} {axes.get_ylabel()!r}"
    limits = " ".join(map(shown, (*axes.get_xlim(), *axes.get_ylim())))
    yield f"{indent}  limits {limits} {axes.get_xscale()} {axes.get_yscale()} {axes.axison}"
    for axis in (axes.xaxis, axes.yaxis):
        if isinstance(axis.get_major_locator(), FixedLocator):
            yield f"{indent}  ticks {[label.get_text() for label in axis.get_ticklabels()]}"
    if legend := axes.get_legend():
        yield f"{indent}  legend {[text.get_text() for text in legend.get_texts()]}"
    contours = [artist for artist in axes.collections if isinstance(artist, ContourSet)]
    labels = {id(text) for contour in contours for text in getattr(contour, "labelTexts", ())}
    for artist in axes.get_children():
        if artist is not axes.patch and id(artist) not in labels and (text := artist_line(artist)):
            yield f"{indent}  {text}"
    for child in axes.child_axes:
        yield from lines_of_axes(child, indent + "  ")


def artist_line(artist: object) -> str:
    """Return one line about an artist, "" for what is in every axes."""
    label = str(getattr(artist, "get_label", str)())
    # matplotlib's own: a number
    if label.startswith("_"):
        label = ""
    match artist:
        case Spine() | Axis():
            return ""
        case Line2D():
            look = (
                artist.get_linestyle(),
                artist.get_marker(),
                artist.get_linewidth(),
                artist.get_markersize(),
            )
            places = sampled(np.asarray(artist.get_xydata(), float))
            return (
                f"line {label} {to_hex(artist.get_color())} {look} {artist.get_zorder()}: {places}"
            )
        case ContourSet():
            return f"contours at {' '.join(map(shown, artist.levels))} {sampled_mask(artist.get_array())}"
        case Collection():
            paths = [path.vertices for path in artist.get_paths()]
            if paths:
                outline = sampled(np.concatenate(paths).ravel())
            else:
                outline = ""
            offsets = sampled(np.ma.filled(np.ma.asarray(artist.get_offsets(), float), np.nan))
            values = artist.get_array()
            if values is None:
                colours = sampled(np.asarray(artist.get_facecolor(), float))
            else:
                colours = sampled_mask(values)
            where = f"{artist.get_zorder()}: {len(paths)} {outline} at {offsets} in {colours}"
            return f"{type(artist).__name__} {label} {where}"
        case AxesImage():
            extent = " ".join(map(shown, artist.get_extent()))
            return f"image {extent} {artist.get_cmap().name} {artist.get_clim()}: {sampled_mask(artist.get_array())}"
        case Patch():
            outline = sampled(np.asarray(artist.get_path().vertices))
            across = sampled(artist.get_patch_transform().get_matrix())
            return f"patch {label} {to_hex(artist.get_facecolor())} {artist.get_zorder()}: {outline} by {across}"
        case Text() if artist.get_text():
            place = (
                artist.get_position()
            )  # of an annotation the offset in points, which a layout rounds
            if isinstance(artist, Annotation):
                texts = [f"{each:.2f}" for each in place]
            else:
                texts = map(shown, place)
            return f"text {artist.get_text()!r} at {' '.join(texts)}"
    return ""


def sampled_mask(values: object) -> str:
    """Return sums of an array whose masked places count as nothing."""
    return sampled(np.ma.filled(np.ma.asarray(values, float), np.nan))


def difference(old: str, new: str) -> str:
    """Return "" if two lines say the same, words exactly and numbers nearly, else both."""
    before = NUMBER.findall(old)
    after = NUMBER.findall(new)
    same = NUMBER.sub("#", old).split() == NUMBER.sub("#", new).split() and all(
        map(nearly, before, after)
    )
    if same:
        return ""
    return f"- {old}\n+ {new}"


def nearly(old: str, new: str) -> bool:
    """Tell whether two numbers are the same but for rounding."""
    a = float(old)
    b = float(new)
    digits = min(map(significant, (old, new)))
    if digits > 17 and max(abs(a), abs(b)) > NOTHING:
        p = Fraction(old)
        q = Fraction(new)
        return abs(p - q) <= max(abs(p), abs(q)) / 10 ** (digits - 3)
    return a == b or abs(a - b) <= max(SHARE * max(abs(a), abs(b)), NOTHING)


def significant(number: str) -> int:
    """Return how many significant digits a number is printed with."""
    return len(re.sub(r"e.*|\D", "", number).lstrip("0"))


def main() -> None:
    """Store the outputs of the packages that are named, or of all."""
    sys.path.insert(0, str(FOLDER.parent))
    for name in sys.argv[1:] or NAMES:
        try:
            found = {case: list(lines_of(make())) for case, make in cases(name).items()}
        except pytest.skip.Exception as skipped:
            sys.exit(f"{name} needs a package that is missing: {skipped}")
        text = json.dumps(found, indent=1, ensure_ascii=False)
        (FOLDER / f"{name}.json").write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
