"""Functions shared by the commands: reading scenes, parameters and file names; printing text, JSON and tables."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import click
from click.shell_completion import CompletionItem

from symosc.display.progress import QUIET, level, pause_working
from symosc.display.tables import plain_table, print_table
from symosc.exact import read_start_error
from symosc.files import STDOUT, drop_stdout
from symosc.model import PARAMETER_NAMES
from symosc.quantities import read_number
from symosc.scenes import START_NAMES, Scene, load_scene, scene_names

if TYPE_CHECKING:
    from symosc.simulation.trajectory import Trajectory

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
FLOAT_FORMAT = "{:.14g}"  # one digit less than every double has; CSV and JSON have them all
#: Columns whose numbers are aligned at their points.
NUMBER_HEADS = ("t", "x", "v", "theta")
Completion = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


# -- printing


def write(text: str, end: str = "\n") -> None:
    """Print to stdout. A reader that closes the pipe is no error."""
    pause_working()
    try:
        click.echo(text + end, nl=False)
    except BrokenPipeError:
        drop_stdout()


def complain(text: str) -> None:
    """Print an error on stderr."""
    pause_working()
    click.echo(f"symosc: {text}", err=True)


def note(text: str) -> None:
    """Print a note on stderr, unless --quiet is given."""
    if level() > QUIET:
        complain(text)


def write_json(data: object) -> None:
    """Print plain data as JSON."""
    write(json.dumps(data, indent=1))


def write_table(rows: list[list[str]], heads: list[str]) -> None:
    """Print a table; numbers are aligned at their points."""
    pause_working()
    if not print_table(heads, rows, NUMBER_HEADS):
        write(plain_table(heads, rows, NUMBER_HEADS))


def wrote(path: Any) -> str:
    """Return the line that names a written file."""
    return f"wrote {click.format_filename(path)}"


def undecidable(trajectory: Trajectory) -> bool:
    """Report a trajectory that ended because its precision did not suffice."""
    if trajectory.status != "undecidable":
        return False
    complain(f"undecidable: {trajectory.message}")
    return True


def count_events(events: Sequence[object]) -> str:
    """Return the number of events with its noun."""
    return f"{len(events)} event{'' if len(events) == 1 else 's'}"


# -- options


def complete(names: Iterable[str], end: str = "") -> Completion:
    """Return a completion of the last name in a list with commas."""

    def matching(context: click.Context, argument: click.Parameter, text: str) -> list[CompletionItem]:
        before, comma, word = text.rpartition(",")
        return [CompletionItem(f"{before}{comma}{name}{end}") for name in names if name.startswith(word)]

    return matching


def complete_scene(context: click.Context, argument: click.Parameter, text: str) -> list[CompletionItem]:
    """Return the scenes whose names begin with a text; without any, the shell completes files."""
    return complete(scene_names())(context, argument, text) or [CompletionItem(text, type="file")]


class WholeNumber(click.IntRange):
    """A whole number in ASCII digits; Python itself also accepts 1_000 and full-width digits."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number."""
        if isinstance(value, str) and not re.fullmatch(r"\s*[+-]?\d{1,1000}\s*", value, re.ASCII):
            self.fail(f"{value!r} is not a valid integer.", param, ctx)
        return super().convert(value, param, ctx)

    def _describe_range(self) -> str:
        """Return the range that --help shows: nothing, not x<=None, where there is none."""
        return "" if self.min is None and self.max is None else super()._describe_range()


scene_argument = click.argument("scene", shell_complete=complete_scene)
optional_scene = click.argument("scene", required=False, shell_complete=complete_scene)
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON in place of the table.")
set_option = click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    shell_complete=complete(PARAMETER_NAMES, "="),
    help="Change a parameter, such as k=3 or Omega=2*pi. Repeatable.",
)
start_error_option = click.option(
    "--start-error", metavar="E", help="How far t0, x0, v0 may be off: a number, or three with commas."
)


def goes_to_stdout(output: str | None, option: str, as_json: bool = False) -> bool:
    """Return whether a file goes to standard output; then the command prints nothing else there."""
    # BadParameter if the name is empty, or if JSON is to be printed as well.
    if output == "":
        raise click.BadParameter("give the name of a file; '-' is standard output", param_hint=option)
    if output == STDOUT and as_json:
        reason = "'-' is standard output, and something else prints there already; name a file"
        raise click.BadParameter(reason, param_hint=option)
    return output == STDOUT


def check_picture(output: str | None) -> None:
    """Check the suffix of a figure's file before the work."""
    if output is not None:
        from symosc.plot.drawing import check_suffix

        check_suffix(output)


def folder_name(output: str, option: str = "--output") -> str:
    """Return the name of a folder; BadParameter if it is empty or standard output."""
    if output in ("", STDOUT):
        raise click.BadParameter(f"{output!r} is not a folder; './-' is one named -", param_hint=option)
    return output


# -- numbers and scenes


def split_setting(text: str, option: str, form: str, known: Iterable[str] = ()) -> tuple[str, str]:
    """Return the two sides of NAME=VALUE; BadParameter if one is empty or the name is in `known`."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (equals and name and value):
        raise click.BadParameter(f"{text!r} is not {form}", param_hint=option)
    if name in known:
        raise click.BadParameter(f"{name} is given twice", param_hint=option)
    return name, value


def read_span(text: str, option: str) -> tuple[str, tuple[str, str]]:
    """Return a parameter's name and two values of it."""
    form = "NAME=LOW:HIGH, such as Omega=3:5"
    name, limits = split_setting(text, option, form)
    low, colon, high = limits.partition(":")
    if not colon:
        raise click.BadParameter(f"{text!r} is not {form}", param_hint=option)
    return name, (low, high)


def read_settings(settings: tuple[str, ...]) -> dict[str, str]:
    """Return names and values of --set options; BadParameter for anything else and for names of the start."""
    changes: dict[str, str] = {}
    for setting in settings:
        name, equals, value = (part.strip() for part in setting.partition("="))
        if not equals:
            raise click.BadParameter(f"{setting!r} is not NAME=VALUE, such as k=3", param_hint="--set")
        if name in START_NAMES:
            raise click.BadParameter(f"{name} is not a parameter; use --{name.replace('_', '-')}", param_hint="--set")
        if name in changes:
            raise click.BadParameter(f"{name} is set twice", param_hint="--set")
        changes[name] = value
    return changes


def read_parameters(settings: tuple[str, ...]) -> dict[str, Any]:
    """Return the numbers of --set options; expressions such as 2*pi are read as in scene files."""
    return {name: read_typed(name, text)[0] for name, text in read_settings(settings).items()}


def read_error(text: str | None) -> Any:
    """Return the start error that --start-error gives, or None."""
    if text is None:
        return None
    parts = text.split(",")
    return read_start_error(parts if len(parts) > 1 else text)


def scene_with(scene: str | Scene, settings: tuple[str, ...], start: dict[str, str | None]) -> Scene:
    """Return a scene with --set parameters and a start from the command line; its notes go to stderr."""
    scene = load_scene(scene) if isinstance(scene, str) else scene
    for line in scene.notes:
        note(f"{scene.name}: {line}")
    scene = scene.changed(**read_parameters(settings))
    for name, text in start.items():
        if text is not None and name != "t_end":
            read_typed(name, text)
    end = start.get("t_end")
    known: dict[str, Any] = {name: text for name, text in start.items() if text is not None}
    return scene.started(known if end is None else known | {"t_end": read_duration("t_end", end)})


def reduced_scene(scene: Scene) -> Scene:
    """Return the scene in the coordinates of symosc's model; a note says so of one of another model."""
    if scene.original is not None:
        changed = scene.parameters.as_dict()
        note(f"{scene.name}: of another model; this is about the oscillator that it is, with B0 = {changed['B0']}")
    return scene.reduced()


def read_duration(name: str, text: str) -> Any:
    """Return periods such as 10T as they are, and any other time as a number."""
    return text.strip() if text.strip().endswith("T") else read_typed(name, text)[0]


def read_typed(name: str, text: str) -> tuple[Any, bool]:
    """Return a number or an expression such as 2*pi, and whether it is exact; a note says if it is not."""
    if not re.search(r"pi|π|[*^()]", text):
        return text, True  # a number; the function that takes it reports a fault
    number, exact = read_number(name, text)
    if not exact:
        note(f"{name} = {text}: read to 40 digits")
    return number, exact
