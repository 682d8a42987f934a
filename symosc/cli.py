"""The command line. Each command loads what it needs when it runs, so that `simulate` starts fast.

Exit codes: 0 success, 1 a check failed, 2 bad input (one line on stderr).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import replace
from importlib import import_module
from itertools import takewhile
from typing import Any, NoReturn

import click

import symosc
from symosc.cli_settings import WholeNumber, goes_to_stdout, read_settings
from symosc.errors import SymoscError
from symosc.exact import read_start_error, show
from symosc.files import drop_stdout
from symosc.model import PARAMETER_NAMES
from symosc.scenes import START_NAMES, Scene, load_scene, scene_names

BAD_INPUT, INTERRUPTED = 2, 130
FLOAT_FORMAT = "{:.14g}"  # one digit less than every double has; CSV and JSON have them all


#: Commands with a module of their own, symosc.cli_<...>, which is loaded when the command is used.
MODULES = {"orbit": "orbit", "grazing": "grazing", "codegen": "export", "check": "check", "derive": "derive"}
MODULES |= {"bench": "bench", "reproduce": "reproduce"}


class CommandLine(click.Group):
    """A group of commands whose errors are one line each, click's own usage errors included."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return sorted([*super().list_commands(ctx), *MODULES])

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command, from its module if it has one."""
        if cmd_name in MODULES:
            command: click.Command = getattr(import_module(f"symosc.cli_{MODULES[cmd_name]}"), cmd_name)
            return command
        return super().get_command(ctx, cmd_name)

    def main(self, *args: Any, standalone_mode: bool = True, **extra: Any) -> Any:
        """Run a command; in standalone mode report errors and exit."""
        run: Any = super().main
        if not standalone_mode:
            return run(*args, standalone_mode=False, **extra)
        try:
            code = run(*args, standalone_mode=False, **extra)
        except click.ClickException as error:
            context = getattr(error, "ctx", None)
            hint = f" (see {context.command_path} --help)" if context else ""
            _fail(error.format_message().rstrip(".") + hint)
        except SymoscError as error:
            _fail(str(error))
        except OverflowError as error:
            _fail(f"a number is beyond the range of double precision ({error})")
        except OSError as error:
            drop_stdout()
            _fail(f"{error.filename or 'cannot write standard output'}: {error.strerror or error}")
        except click.Abort:
            sys.exit(INTERRUPTED)
        sys.exit(code if isinstance(code, int) else 0)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an interrupt ends it quietly."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            ctx.exit(INTERRUPTED)


def _fail(message: str) -> NoReturn:
    click.echo(f"symosc: error: {' '.join(message.split())}", err=True)
    sys.exit(BAD_INPUT)


def _print(text: str) -> None:
    """Print to stdout. A reader that closed the pipe has had enough."""
    try:
        click.echo(text)
    except BrokenPipeError:
        drop_stdout()


def _print_json(data: Any) -> None:
    _print(json.dumps(data, indent=1))


def _print_table(rows: list[list[str]], heads: list[str]) -> None:
    from tabulate import tabulate

    align = ["decimal" if head in ("t", "x", "v", "theta") else "left" for head in heads]
    _print(tabulate(rows, heads, tablefmt="simple", disable_numparse=True, colalign=align))


def _scene_with(name_or_path: str, settings: tuple[str, ...], start: dict[str, str | None]) -> Scene:
    """Return a scene with ``--set`` parameters and a start from the command line."""
    scene = load_scene(name_or_path)
    changed = replace(scene, parameters=scene.parameters.replace(**read_settings(settings)))
    return changed.started({name: value for name, value in start.items() if value is not None})


def _undecidable(trajectory: symosc.Trajectory) -> bool:
    """Report a trajectory that ended because its precision did not suffice."""
    if trajectory.status != "undecidable":
        return False
    click.echo(f"symosc: undecidable: {trajectory.message}", err=True)
    return True


scene_argument = click.argument("scene")
set_option = click.option(
    "--set", "settings", multiple=True, metavar="NAME=VALUE", help="Change a parameter, such as k=3. Repeatable."
)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON in place of the table.")


def _cite(context: click.Context, option: click.Parameter, wanted: bool) -> None:
    if not wanted:
        return
    from symosc.citation import bibtex

    _print(bibtex())
    context.exit()


@click.group(cls=CommandLine, no_args_is_help=False, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(symosc.__version__, prog_name="symosc")
@click.option(
    "--cite",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_cite,
    help="Print BibTeX of symosc and the paper.",
)
def main() -> None:
    """Exact solutions of the double-belt friction oscillator.

    SCENE is the name of a shipped scene (see symosc scenes) or the path of a TOML file of the same form. Numbers are
    read exactly: 0.8 and 4/5 are the same.

    Exit codes: 0 success, 1 a check failed, 2 bad input.

    \b
    Example:
      symosc simulate fig5
    """


@main.command()
@scene_argument
@click.option("--t-end", metavar="T", help="End time in place of the scene's.")
@click.option("--t0", metavar="T", help="Start time in place of the scene's.")
@click.option("--x0", metavar="X", help="Start position in place of the scene's.")
@click.option("--v0", metavar="V", help="Start velocity in place of the scene's.")
@click.option("--start-error", metavar="E", help="How far t0, x0, v0 may be off: a number, or three with commas.")
@set_option
@click.option("--max-events", type=WholeNumber(), metavar="N", help="Stop after N events.")
@click.option(
    "--digits", type=WholeNumber(), metavar="N", help="N digits, relative to max(1, |value|); default: doubles."
)
@click.option("--csv", "csv_path", metavar="FILE", help="Write the events, all digits, as CSV as well. -: only that.")
@json_option
def simulate(
    scene: str,
    start_error: str | None,
    settings: tuple[str, ...],
    max_events: int | None,
    digits: int | None,
    csv_path: str | None,
    as_json: bool,
    **start: str | None,
) -> int:
    """Follow a scene and print its events.

    Columns: time, position, velocity and phase (Omega t mod 2 pi) of each event; what it is (cross a belt's speed,
    stick: onset, slip: end of a stick, graze); on which belt; the motion before and after it; estimated errors of t
    and x. A trajectory that this precision cannot decide ends there, with exit code 1.

    A start that is known to so much only says so by --start-error; a contact within its reach is then a graze. Without
    it the start is exact, or known as well as the scene says.

    With --digits the numbers of the motion are strings in JSON: a reader would round numbers to doubles.

    \b
    Examples:
      symosc simulate fig5
      symosc simulate fig8 --set c=3.9 --t-end 20 --digits 30 --csv events.csv
    """
    piped = goes_to_stdout(csv_path, "--csv", as_json)
    problem = _scene_with(scene, settings, start)
    known: dict[str, Any] = {}
    if start_error is not None:
        parts = start_error.split(",")
        known["start_error"] = read_start_error(parts if len(parts) > 1 else start_error)
    trajectory = symosc.simulate(problem, max_events=max_events, digits=digits, **known)
    if csv_path is not None:
        trajectory.to_csv(csv_path)
    if piped:
        pass
    elif as_json:
        _print_json({"scene": problem.name, **trajectory.as_dict()})
    else:
        _print_events(trajectory)
    return int(_undecidable(trajectory))


def _print_events(trajectory: symosc.Trajectory) -> None:
    rows = []
    for row in trajectory.table():
        numbers = [_number(row[name]) for name in ("t", "x", "v", "theta")]
        moves = f"{row['source']} -> {row['target']}"
        errors = [f"{row[name]:.0e}" for name in ("t_error", "x_error")]
        rows.append([*numbers, row["kind"], str(row["boundary"]), moves, *errors])
    if rows:
        _print_table(rows, ["t", "x", "v", "theta", "kind", "belt", "from -> to", "t error", "x error"])
        _print("")
    _print(f"word, in order of time: {' '.join(trajectory.word) or 'none'}")
    if trajectory.status != "undecidable":
        _print(f"{trajectory.status}: {trajectory.message}; {_counted(rows)}")


def _counted(events: Sequence[Any]) -> str:
    return f"{len(events)} event{'' if len(events) == 1 else 's'}"


def _number(value: float | str) -> str:
    return value if isinstance(value, str) else FLOAT_FORMAT.format(value)


@main.command()
@scene_argument
@click.option("-o", "--output", required=True, metavar="FILE", help="The file: .pdf, .svg or .png. -: SVG to stdout.")
@click.option("--t-end", metavar="T", help="End of the time axis; default: what the paper shows, else the scene's end.")
@set_option
@click.option("--panels", metavar="LETTERS", help="a x(t), b v(t), c phase plane, forces: d (t), e (x), f (v).")
@click.option("--columns", type=WholeNumber(1, 2), default=2, help="2: as wide as a page. 1: as a column of it.")
def figure(
    scene: str, output: str, settings: tuple[str, ...], t_end: str | None, panels: str | None, columns: int
) -> int:
    """Draw a scene in panels like those of the paper's figures 5 to 10.

    \b
    Examples:
      symosc figure fig5 -o fig5.pdf
      symosc figure fig8 -o phase.svg --panels c --t-end 22
    """
    piped = goes_to_stdout(output, "--output")
    problem = _scene_with(scene, settings, {})
    from symosc import plot

    plot.check_suffix(output)
    panels = plot.default_panels(problem) if panels is None else panels
    plot.check_panels(panels)
    trajectory = plot.simulated(problem, t_end)
    plot.save(plot.figure(trajectory, panels=panels, columns=columns), output)
    if piped:
        return int(_undecidable(trajectory))
    span = f"t = {float(trajectory.t_start):.6g} to {float(trajectory.t_end):.6g}"
    _print(f"{click.format_filename(output)}: {span}, {_counted(trajectory.events)}")
    return int(_undecidable(trajectory))


@main.command()
@click.argument("scene", required=False)
@json_option
def scenes(scene: str | None, as_json: bool) -> None:
    """List the shipped scenes, or print one as a TOML file.

    \b
    Examples:
      symosc scenes
      symosc scenes fig9 > mine.toml
    """
    if scene is not None:
        chosen = load_scene(scene)
        if as_json:
            _print_json(_scene_data(chosen))
        else:
            _print(_as_toml(chosen))
        return
    listed = [load_scene(name) for name in scene_names()]
    if as_json:
        _print_json([_scene_data(each) for each in listed])
        return
    # Every source begins with the paper; once is enough.
    sources = [each.source for each in listed]
    same = takewhile(lambda pair: pair[0] == pair[1], zip(min(sources), max(sources), strict=False))
    common = "".join(letter for letter, _ in same).rpartition(", ")[0]
    rows = []
    for each in listed:
        since, until = (f"{float(time):.6g}" for time in (each.t0, each.t_end))
        rows.append([each.name, since, until, each.structure or "", each.source.removeprefix(f"{common}, ")])
    _print_table(rows, ["scene", "from t", "to t", "structure", "what it is"])
    _print(f"\nsource: {common}")


def _scene_data(scene: Scene) -> dict[str, Any]:
    start = {name: show(getattr(scene, name)) for name in START_NAMES}
    about = {"name": scene.name, "source": scene.source, "structure": scene.structure}
    error = None if scene.start_error is None else [show(each) for each in scene.start_error]
    return {**about, **start, "start_error": error, "parameters": scene.parameters.as_dict()}


def _as_toml(scene: Scene) -> str:
    def number(text: str) -> str:
        return json.dumps(text) if "/" in text else text  # TOML has no fractions; as text they are read exactly

    data = _scene_data(scene)
    # A JSON string is a TOML string too.
    lines = [f"{key} = {json.dumps(data[key])}" for key in ("name", "source", "structure") if data[key]]
    lines += [f"t_end = {number(data['t_end'])}", "", "[parameters]"]
    lines += [f"{name} = {number(data['parameters'][name])}" for name in PARAMETER_NAMES]
    lines += ["", "[start]", *(f"{name} = {number(data[name])}" for name in START_NAMES[:3])]
    if data["start_error"] is not None:
        lines.append(f"start_error = [{', '.join(map(number, data['start_error']))}]")
    return "\n".join(lines)
