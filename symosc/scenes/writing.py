"""Scenes as TOML files: short ones, and ones with comments to begin with."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from symosc.exact import show
from symosc.model import PARAMETER_NAMES
from symosc.scenes.quantities import ALLOWED, QUANTITIES, unit_of

if TYPE_CHECKING:
    from symosc.scenes import Scene

#: What stands at the top of a file with comments.
INTRODUCTION = """\
# A scene of symosc. Try it:  symosc simulate {file}
#
# Numbers are exact: 0.8, "4/5" and 8e-1 are the same. Any consistent system of units will do; in brackets are those of
# the SI. A number may have a unit, such as "2.5 cm" or "60 rpm" (extra units); plain numbers are then in these too.
# Where a number need not be exact it may be an expression, such as "3*pi/2": it is read to 40 digits, and symosc says
# so. With pi, sqrt, sin, cos and exp a value is no fraction, and a start is then known to these digits only.
"""
START_COMMENT = "# The mass at the start. start_error = 1e-9 would say that these three may be off by so much."


def as_toml(scene: Scene, explained: bool = False, file: str = "mine.toml") -> str:
    """Return a scene as the text of a TOML file, which reads back as the same scene.

    Parameters
    ----------
    scene : Scene
    explained : bool
        With comments: what each number is, its unit, and what is allowed.
    file : str
        The name of the file in the comments.
    """

    def line(name: str, text: str) -> str:
        written = f"{name} = {_number(text)}"
        if not explained:
            return written
        allowed = f", {ALLOWED[name]}" if name in ALLOWED else ""
        unit = unit_of(name)
        return f"{written:<16}# {QUANTITIES[name][0]}{allowed}{'' if unit == '1' else f' [{unit}]'}"

    lines = [INTRODUCTION.format(file=file)] if explained else []
    # A JSON string is a TOML string too.
    about = {"name": scene.name, "source": scene.source, "structure": scene.structure}
    lines += [f"{key} = {json.dumps(value)}" for key, value in about.items() if value]
    if explained and not scene.structure:
        lines.append('# structure = "P32"   # the periodic orbit that the scene is about, if there is one')
    lines += [line("t_end", show(scene.t_end)), "", "[parameters]"]
    lines += [line(name, text) for name, text in scene.parameters.as_dict().items() if name in PARAMETER_NAMES]
    lines += ["", "[start]", *([START_COMMENT] if explained else [])]
    lines += [line(name, show(getattr(scene, name))) for name in ("t0", "x0", "v0")]
    if scene.start_error is not None:
        lines.append(f"start_error = [{', '.join(_number(show(each)) for each in scene.start_error)}]")
    return "\n".join(lines)


def _number(text: str) -> str:
    return json.dumps(text) if "/" in text else text  # TOML has no fractions; as text they are read exactly
