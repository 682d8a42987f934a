"""The command `symosc codegen`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from symosc.cli.settings import complete_scene, goes_to_stdout
from symosc.symbolic.export import LANGUAGES


@click.command()
@click.argument("word", required=False)
@click.option("--check", is_flag=True, help="Without WORD: compare symosc's own kernels; exit code 1 if they differ.")
@click.option("--regenerate", is_flag=True, help="Without WORD: write symosc's own kernels anew.")
@click.option(
    "--language", "-l", type=click.Choice(LANGUAGES), default="python", show_default=True, help="What to write."
)
@click.option(
    "--fix",
    metavar="SCENE",
    shell_complete=complete_scene,
    help="Fold the parameters of a scene in and drop what that leaves unused.",
)
@click.option("--name", help="Base of the file names, and of the names in C and Julia. Default: from the word.")
@click.option(
    "-o", "--output", metavar="FOLDER", default=".", help="Where to write; made if needed. Default: here. '-': print."
)
@click.option("--force", is_flag=True, help="Replace files that have another content.")
@click.option("--json", "as_json", is_flag=True, help="Print the paths as JSON.")
@click.pass_context
def codegen(ctx: click.Context, /, word: str | None, check: bool, regenerate: bool, **options: Any) -> int:
    """Write a mapping structure's residual and Jacobian for your own program.

    WORD is read right to left, like P32. The file needs nothing of symosc: Python with math, Python with NumPy, C99
    with a header, or Julia. It has the maps of the word only. A file that is there with another content stays, unless
    --force is given.

    Without WORD it is about the kernels that symosc itself runs, symosc/kernels/_generated.py, which are printed from
    the formulas that sympy derives: --check compares them, --regenerate writes them.

    \b
    Examples:
      symosc codegen P32 --language c --fix fig9
      symosc codegen P4645 --language julia -o - > p4645.jl
      symosc codegen --check
    """
    if word is not None:
        if check or regenerate:
            flag = "--check" if check else "--regenerate"
            raise click.UsageError(f"{flag} is about symosc's own kernels; leave WORD out")
        return _export(word, **options)
    given = [name for name in options if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE]
    if given:
        names = {parameter.name: max(parameter.opts, key=len) for parameter in ctx.command.params}
        raise click.UsageError(f"{', '.join(names[name] for name in given)} needs a WORD, such as P32")
    if check == regenerate:
        either = "not both" if check else "or a WORD, such as P32"
        raise click.UsageError(f"give --check or --regenerate, {either}")
    return _compare() if check else _regenerate()


def _export(
    word: str, language: str, fix: str | None, name: str | None, output: str, force: bool, as_json: bool
) -> int:
    from symosc.scenes import load_scene
    from symosc.symbolic.export import export, write_export

    printed = goes_to_stdout(output, "--output", as_json)
    if printed and force:
        raise click.UsageError("--force is about files; leave it out with -o -")
    parameters = None if fix is None else load_scene(fix).parameters
    if printed:
        click.echo("\n".join(export(word, language, parameters, name).values()), nl=False)
        return 0
    paths = [str(path) for path in write_export(output, word, language, parameters, name, force=force)]
    click.echo(json.dumps(paths, indent=1) if as_json else "\n".join(f"wrote {path}" for path in paths))
    return 0


def _regenerate() -> int:
    from symosc.symbolic import codegen as generator

    click.echo(f"wrote {generator.write()}")
    return 0


def _compare() -> int:
    from symosc.symbolic import codegen as generator

    difference = generator.check()
    if difference:
        click.echo(difference)
        accept = "accept: symosc codegen --regenerate"
        click.echo(f"symosc: the committed kernels differ from the generated ones; {accept}", err=True)
        return 1
    click.echo(f"{Path(generator.PATH).name} is what the formulas print")
    return 0
