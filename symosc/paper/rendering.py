"""Templates of the report and the letter, filled in: HTML, and Markdown or plain text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from textwrap import fill
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from symosc.derive.mathml import font_style
from symosc.paper.typeset import typeset


def render(template: str, context: Mapping[str, Any]) -> str:
    """Return a template of the folder templates, filled in."""
    environment = Environment(
        loader=PackageLoader("symosc.paper"),
        autoescape=lambda name: name is not None and ".html" in name,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"typeset": _typeset, "md": _markdown, "wrapped": _wrapped}
    environment.globals["font_style"] = lambda: Markup(font_style())
    return environment.get_template(template).render(context)


def _typeset(text: str) -> Markup:
    return Markup(typeset(text))


def _markdown(text: str) -> str:
    """Return a text for Markdown, in a table as well: its formulas are set, its other characters mean themselves."""
    return re.sub(r"([\\`*_|\[\]~])", r"\\\1", typeset(" ".join(text.split())))


def _wrapped(text: str, indent: int = 4) -> str:
    """Return a text in lines of a mail, indented."""
    return fill(text, 78, initial_indent=" " * indent, subsequent_indent=" " * indent)
