"""Literal blocks with lines too long for the column of a page: smaller letters or, if these do not do, broken lines.

What is wide gets a class, by its longest line; `symosc.css` has the sizes of the letters.
"""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx

#: Characters of a line that the column holds in letters of usual and of small size; lists and
#: descriptions of functions are narrower.
USUAL = 100
SMALL = 122
INDENT = 5


def mark_wide_blocks(app: Sphinx, tree: nodes.document, name: str) -> None:
    """Give each literal block that is too wide the class `small-print` or `broken-lines`."""
    for block in tree.findall(nodes.literal_block):
        longest = max(map(len, block.astext().expandtabs().splitlines()), default=0)
        parent = block.parent
        while parent is not None:
            if parent.tagname in ("list_item", "desc_content", "details", "admonition"):
                longest += INDENT
            parent = parent.parent
        if longest > SMALL:
            block["classes"].append("broken-lines")
        elif longest > USUAL:
            block["classes"].append("small-print")


def setup(app: Sphinx) -> dict[str, bool]:
    """Look at each page when it is complete."""
    app.connect("doctree-resolved", mark_wide_blocks)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
