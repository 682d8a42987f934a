"""HTML pages from templates: the one jinja environment of all pages, reports and notebooks.

A template is named by its path in the package, such as "plot/templates/crosscheck.html.j2".
Everything that is filled in is escaped, unless it is Markup.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment

Filters = Mapping[str, Callable[..., Any]]


def render(template: str, content: Mapping[str, Any], filters: Filters | None = None) -> str:
    """Return the text of a template, filled in with the values in `content`.

    `filters` are functions of this page alone, by the names that the template calls them.
    """
    environment = _environment()
    if filters:
        environment = environment.overlay()
        environment.filters = environment.filters | dict(filters)
    return environment.get_template(template).render(content)


def macros(template: str) -> Any:
    """Return the macros of a template as functions, which return Markup."""
    return _environment().get_template(template).module


@cache
def _environment() -> Environment:
    """Return the environment.

    Values that are missing are errors, and lines of statements leave no blank lines.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("symosc", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
