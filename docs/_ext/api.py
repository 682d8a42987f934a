"""The text of the API pages: the public names of each package, as directives of autodoc."""

from __future__ import annotations

import inspect
import re
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import symosc
from symosc import plot

if TYPE_CHECKING:
    from sphinx.application import Sphinx


PAGES = {path.stem for path in (Path(__file__).parents[1] / "reference" / "api").glob("*.md")} - {
    "index"
}


#: Where the arguments of `plot` are described.
EXPLAINED = "symosc.Trajectory.plot"


def public() -> dict[str, object]:
    """Return all public names with what they are."""
    found = {
        f"symosc.{name}": getattr(symosc, name)
        for name in symosc.__all__
        if name not in ("plot", "__version__")
    }
    return found | {f"symosc.plot.{name}": getattr(plot, name) for name in plot.__all__}


def package_of(name: str, subject: object) -> str:
    """Return the package that a public name comes from, if it has a page.

    Else `model`, which is for all modules.
    """
    if name.startswith("symosc.plot."):
        return "plot"
    rooms = getattr(subject, "__module__", "").split(".")[1:]
    return next((room for room in rooms if room in PAGES), "model")


def pages() -> dict[str, str]:
    """Return for each page what stands on it.

    A table of names, then all of them, functions first.
    """
    grouped: dict[str, list[str]] = defaultdict(list)
    for name, subject in public().items():
        grouped[package_of(name, subject)].append(name)
    return {f"api_{package}": _page(names) for package, names in grouped.items()}


def _page(names: list[str]) -> str:
    subjects = public()
    names = sorted(names, key=lambda name: (inspect.isclass(subjects[name]), name.lower()))
    table = "".join(f"   ~{name}\n" for name in names)
    entries = "".join(f".. auto{_kind(subjects[name])}:: {name}\n\n" for name in names)
    return f"```{{eval-rst}}\n.. autosummary::\n   :nosignatures:\n\n{table}\n{entries}```"


def _kind(subject: object) -> str:
    if inspect.isclass(subject):
        if issubclass(subject, Exception):
            return "exception"
        return "class"
    if callable(subject):
        return "function"
    return "data"


def keep_bars(*about: Any) -> None:
    """Let bars in docstrings, as in |x|, be bars: for Sphinx they would be substitutions."""
    lines: list[str] = about[-1]
    lines[:] = [
        line if ">>>" in line else re.sub(r"(?<![\\`])\|(?!`)", r"\\|", line) for line in lines
    ]


def shorten_plots(
    app: Sphinx, kind: str, name: str, subject: object, options: object, lines: list[str]
) -> None:
    """Describe the method `plot`, which all answers share, once."""
    if name.endswith(".plot") and kind == "method" and name != EXPLAINED:
        lines[:] = [f"Draw the result, with the arguments of `{EXPLAINED}`.", ""]


def show_examples(app: Sphinx, context: Any, lines: list[str]) -> None:
    """Make a block of the examples in the help of a command; what is above it may have bars."""
    at = next((n for n, line in enumerate(lines) if line.startswith("| Example")), len(lines))
    about = lines[:at]
    examples = [line.removeprefix("| ").strip() for line in lines[at + 1 :]]
    keep_bars(about)
    block = [".. code-block:: console", "", *(f"   $ {line}" for line in examples if line), ""]
    lines[:] = about + (block if examples else [])


def skip_fields(
    app: Sphinx, kind: str, name: str, subject: object, skip: bool, options: object
) -> bool | None:
    """Leave out the fields of a named tuple: its docstring has them, in words."""
    if (inspect.getdoc(subject) or "").startswith("Alias for field number"):
        return True
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    """Let texts be changed after numpydoc and sphinx-click have read them."""
    app.connect("autodoc-process-docstring", keep_bars, priority=900)
    app.connect("autodoc-process-docstring", shorten_plots, priority=900)
    app.connect("autodoc-skip-member", skip_fields)
    app.connect("sphinx-click-process-description", show_examples)
    app.connect("sphinx-click-process-options", keep_bars)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
