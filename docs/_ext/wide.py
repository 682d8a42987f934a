"""What is too wide: literal blocks in smaller letters or broken lines, and numbers that no line breaks.

What is wide gets a class, by its longest line; `symosc.css` has the sizes of the letters. A table keeps its
columns, and scrolls; if only the lines around it are long, these are broken.
"""

from __future__ import annotations

import re

from docutils import nodes
from sphinx.application import Sphinx

#: Characters of a line that the column holds in letters of usual and of small size; lists and
#: descriptions of functions are narrower.
USUAL = 100
SMALL = 122
INDENT = 5
#: The line below the heads of a table.
RULE = re.compile(r"^ *-+(?: +-+)+ *$", re.MULTILINE)


def widest_row(text: str) -> int:
    """Return the length of the longest row of the tables in a text; 0 if there are none."""
    tables = [part for part in text.split("\n\n") if RULE.search(part)]
    return max((len(row) for table in tables for row in table.splitlines()), default=0)


def mark_wide_blocks(app: Sphinx, tree: nodes.document, name: str) -> None:
    """Give each literal block that is too wide the class `small-print`, `broken-lines` or, if its
    tables fit, `broken-prose`.
    """
    for block in (*tree.findall(nodes.literal_block), *tree.findall(nodes.doctest_block)):
        text = block.astext().expandtabs()
        longest = max(map(len, text.splitlines()), default=0)
        parent = block.parent
        while parent is not None:
            if parent.tagname in ("list_item", "desc_content", "details", "admonition"):
                longest += INDENT
            parent = parent.parent
        if longest > SMALL and not RULE.search(text):
            block["classes"].append("broken-lines")
        elif longest > SMALL and widest_row(text) <= SMALL:
            block["classes"].append("broken-prose")
        elif longest > USUAL:
            block["classes"].append("small-print")


#: A number that a line could be broken in: behind the hyphen of its exponent, or before its sign of
#: multiplication.
NUMBER = re.compile(r"(\d[\d.]*e-\d+|\d[\d.]* ×)")


def keep_numbers_whole(app: Sphinx, tree: nodes.document, name: str) -> None:
    """Give each number that could be broken the class `number`, in tables and in text."""
    for paragraph in tree.findall(nodes.paragraph):
        for text in list(paragraph.findall(nodes.Text)):
            parts = NUMBER.split(text.astext())
            if len(parts) == 1 or isinstance(text.parent, nodes.literal | nodes.math | nodes.raw):
                continue
            pieces = list[nodes.Node]()
            for n, part in enumerate(parts):
                if n % 2:
                    pieces.append(nodes.inline(part, part, classes=["number"]))
                elif part:
                    pieces.append(nodes.Text(part))
            text.parent.replace(text, pieces)


def setup(app: Sphinx) -> dict[str, bool]:
    """Look at each page when it is complete."""
    app.connect("doctree-resolved", mark_wide_blocks)
    app.connect("doctree-resolved", keep_numbers_whole)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
