"""The directive `{picture}`: Python code that is run at the build, shown under the figure that it makes.

The last line of the code is the figure. Each block runs in a process of its own.

    ```{picture} The velocity over the displacement, with one stick on belt 1.
    simulate("fig5").plot(panels="c")
    ```
"""

from __future__ import annotations

import subprocess
import sys
from hashlib import sha256
from html import escape
from pathlib import Path
from typing import ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

LONGEST = 600.0  # seconds that a figure may take
#: Saves the figure that the last line of the code is.
RUN = """
import ast, sys
from symosc import *
from symosc import plot
code, path = sys.argv[1:]
tree = ast.parse(code)
last = tree.body.pop()
exec(compile(tree, "picture", "exec"))
plot.save(eval(compile(ast.Expression(last.value), "picture", "eval")), path)
"""


class Picture(SphinxDirective):
    """Run code, and show the figure with the code below it."""

    has_content = True
    required_arguments = 1  # what the figure shows, for those who do not see it
    final_argument_whitespace = True
    option_spec: ClassVar[dict[str, object]] = {}

    def run(self) -> list[nodes.Node]:
        """Return the figure and the code; code that fails is an error of the page."""
        code = "\n".join(self.content)
        folder = Path(self.env.app.outdir) / "_images"
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / f"picture-{sha256(code.encode()).hexdigest()[:12]}.svg"
        done = subprocess.run(
            [sys.executable, "-c", RUN, code, str(path)],
            capture_output=True, text=True, timeout=LONGEST, check=False,
        )  # fmt: skip
        if done.returncode != 0:
            raise self.error(f"{code!r} failed: {done.stderr}")
        up = "../" * self.env.docname.count("/")
        html = f'<img src="{up}_images/{path.name}" alt="{escape(self.arguments[0])}">'
        return [
            nodes.raw("", f'<p class="picture">{html}</p>', format="html"),
            nodes.literal_block(code, code, language="python"),
        ]


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("picture", Picture)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
