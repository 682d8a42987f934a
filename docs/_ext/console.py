"""The directive `{console}`: shell commands that are run at the build, shown with what they print.

Each line that begins with a dollar is a command. The commands of one page run in one folder of
their own, in order, so that one can use the file that another one wrote.

    ```{console}
    :exit: 1
    $ symosc simulate fig8
    ```
"""

from __future__ import annotations

import atexit
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

LONGEST = 3600.0  # seconds that a command may take


class Console(SphinxDirective):
    """Run commands, and show them with their output."""

    has_content = True
    option_spec: ClassVar[dict[str, Any]] = {
        "exit": directives.nonnegative_int,  # the exit code of the last command
        "lines": directives.positive_int,  # show so many lines of each output
        "wrap": directives.flag,  # break long lines
        "files": directives.unchanged,  # files below docs that the commands need
    }

    def run(self) -> list[nodes.Node]:
        """Return a block with commands and output; a command that fails is an error of the page."""
        folder = Path(self.env.config.console_folder) / self.env.docname
        folder.mkdir(parents=True, exist_ok=True)
        for name in self.options.get("files", "").split():
            source = Path(self.env.srcdir) / name
            self.env.note_dependency(str(source))
            shutil.copy(source, folder)
        commands = [line.removeprefix("$ ") for line in self.content if line.startswith("$ ")]
        if len(commands) != len(self.content) or not commands:
            raise self.error("every line of a console block must begin with '$ '")
        shown = []
        for command in commands:
            if command == commands[-1]:
                wanted = self.options.get("exit", 0)
            else:
                wanted = 0
            shown.append(f"$ {command}\n{self._output(command, folder, wanted)}".rstrip("\n"))
        text = "\n".join(shown)
        block = nodes.literal_block(text, text, language="console")
        return [nodes.container("", block, classes=["wrap"]) if "wrap" in self.options else block]

    def _output(self, command: str, folder: Path, wanted: int) -> str:
        done = subprocess.run(
            command, shell=True, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            timeout=LONGEST, check=False,
        )  # fmt: skip
        if done.returncode != wanted:
            raise self.error(
                f"{command!r} ended with {done.returncode}, not {wanted}: {done.stdout}"
            )
        lines = done.stdout.splitlines()
        most = self.options.get("lines", len(lines))
        return "\n".join(lines[:most] + (["..."] if len(lines) > most else []))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive; the folder of the commands goes when the build ends."""
    folder = tempfile.mkdtemp(prefix="symosc-docs-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    app.add_config_value("console_folder", folder, "", str)
    app.add_directive("console", Console)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
