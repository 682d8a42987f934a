"""The command `symosc codegen`."""

from __future__ import annotations

import json
from pathlib import Path

import click

LANGUAGES = ("python", "numpy", "c", "julia")


@click.command()
@click.argument("word", required=False)
@click.option("--check", is_flag=True, help="Without WORD: only compare; print a difference, exit code 1.")
@click.option(
    "--language", "-l", type=click.Choice(LANGUAGES), default="python", show_default=True, help="What to write."
)
@click.option("--fix", metavar="SCENE", help="Fold the parameters of a scene in and drop what that leaves unused.")
@click.option("--name", help="Base of the file names, and of the names in C. Default: the word in small letters.")
@click.option("-o", "--output", metavar="FOLDER", default=".", help="Where to write. Default: here. '-': print.")
@click.option("--json", "as_json", is_flag=True, help="Print the paths as JSON.")
def codegen(
    word: str | None, check: bool, language: str, fix: str | None, name: str | None, output: str, as_json: bool
) -> int:
    """Write a mapping structure's residual and Jacobian for your own program, or print symosc's own kernels anew.

    WORD is read right to left, like P32. The file needs nothing of symosc: Python with math, Python with NumPy, C99
    with a header, or Julia. It has the maps of the word only. Without WORD, symosc/kernels/_generated.py is printed
    from the formulas that sympy derives.

    \b
    Examples:
      symosc codegen P32 --language c --fix fig9
      symosc codegen P4645 --language julia -o - > p4645.jl
      symosc codegen --check
    """
    if word is None:
        return _own_kernels(check)
    if check:
        raise click.UsageError("--check is about symosc's own kernels; leave WORD out")
    from symosc.scenes import load_scene
    from symosc.symbolic.export import export, write_export

    parameters = load_scene(fix).parameters if fix else None
    if output == "-":
        click.echo("\n".join(export(word, language, parameters, name).values()), nl=False)
        return 0
    paths = [str(path) for path in write_export(output, word, language, parameters, name)]
    click.echo(json.dumps(paths, indent=1) if as_json else "\n".join(f"wrote {path}" for path in paths))
    return 0


def _own_kernels(check: bool) -> int:
    from symosc.symbolic import codegen as generator

    if not check:
        click.echo(f"wrote {generator.write()}")
        return 0
    difference = generator.check()
    if difference:
        click.echo(difference)
        click.echo("symosc: the committed kernels differ from the generated ones; accept: symosc codegen", err=True)
        return 1
    click.echo(f"{Path(generator.PATH).name} is what the formulas print")
    return 0
