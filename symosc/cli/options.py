"""Arguments and options of the commands, and what is read from them: scenes, parameters, numbers,
names of files.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeAlias

import click
from click.shell_completion import CompletionItem

from symosc.base.exact import read_start_error
from symosc.base.files import STDOUT
from symosc.base.quantities import read_number
from symosc.cli.output import claim_stdout, note
from symosc.kernels.theorem7_cases import PLACES
from symosc.model import PARAMETER_NAMES
from symosc.scenes import START_NAMES, Scene, load_scene, scene_names, scene_of

#: The text of an option; None if it is not given.
Text: TypeAlias = str | None
#: The texts of --set.
Settings: TypeAlias = tuple[str, ...]
Completion: TypeAlias = Callable[[click.Context, click.Parameter, str], list[CompletionItem]]


def complete(names: Callable[[], Iterable[str]], end: str = "") -> Completion:
    """Return a shell completion of the last of comma-separated names by those of `names()`, with
    `end` appended.
    """

    def matching(
        context: click.Context, argument: click.Parameter, text: str
    ) -> list[CompletionItem]:
        before, comma, word = text.rpartition(",")
        return [
            CompletionItem(f"{before}{comma}{name}{end}")
            for name in names()
            if name.startswith(word)
        ]

    return matching


def complete_scene(
    context: click.Context, argument: click.Parameter, text: str
) -> list[CompletionItem]:
    """Return the shipped scenes whose names begin with `text`; if there are none, the shell
    completes file names.
    """
    return complete(scene_names)(context, argument, text) or [CompletionItem(text, type="file")]


def checked_file(context: click.Context, parameter: click.Parameter, path: Text) -> Text:
    """Return the file name `path`.

    BadParameter if it is empty, or if it is "-" and other output goes there too.
    """
    if path == "":
        if isinstance(parameter, click.Option):
            hint = max(parameter.opts, key=len)
        else:
            hint = parameter.make_metavar(context)
        raise click.BadParameter("give the name of a file; '-' is standard output", param_hint=hint)
    return claim_stdout(context, parameter, path)


def checked_picture(context: click.Context, parameter: click.Parameter, path: Text) -> Text:
    """Return the name of a figure's file, checked as any file name.

    It must end in .pdf, .svg or .png.
    """
    if checked_file(context, parameter, path) is not None:
        from symosc.plot.drawing import check_suffix

        check_suffix(path or "")
    return path


class WholeNumber(click.IntRange):
    """The option type of whole numbers in ASCII digits.

    Python itself also accepts 1_000 and full-width digits.
    """

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Convert a text of ASCII digits to the whole number; fail for any other text."""
        if isinstance(value, str) and not re.fullmatch(r"\s*[+-]?\d{1,1000}\s*", value, re.ASCII):
            self.fail(f"{value!r} is not a valid integer.", param, ctx)
        return super().convert(value, param, ctx)

    def _describe_range(self) -> str:
        """Return the range of allowed numbers as --help shows it, or an empty text if there is no
        limit.
        """
        if self.min is None and self.max is None:
            return ""
        return super()._describe_range()


#: How options are read and completed whose values have these names in --help; a name and = complete
#: a parameter.
KINDS: dict[str, dict[str, Any]] = {
    "N": {"type": WholeNumber()},
    "SCENE": {"shell_complete": complete_scene},
    "MAP": {"shell_complete": complete(lambda: PLACES)},
    "NAMES": {"shell_complete": complete(lambda: PARAMETER_NAMES, ",")},
    "NAME=": {"shell_complete": complete(lambda: PARAMETER_NAMES, "=")},
    **{name: {"callback": checked_file} for name in ("FILE", "FOLDER", "PATH")},
    "FIGURE": {"callback": checked_picture},
}


def option(form: str, about: str, *names: str, **settings: Any) -> Callable[[Any], Any]:
    """Return a click option from its `form`, such as "-o, --output FILE", and its help text
    `about`.

    The last word of the form (FILE) says how values are read and completed (`KINDS`); the rest is
    for click.option.
    """
    *short, long = form.split(", ")
    long, _, metavar = long.partition(" ")
    value, equals, _ = metavar.partition("=")
    kind_settings = KINDS.get(value + equals, {})
    return click.option(
        *short, long, *names, metavar=metavar or None, help=about, **kind_settings | settings
    )


def flag(form: str, about: str, *names: str, **settings: Any) -> Callable[[Any], Any]:
    """Return a click option that takes no value, from the arguments of `option`."""
    return option(form, about, *names, is_flag=True, **settings)


scene_argument = click.argument("scene", shell_complete=complete_scene)
optional_scene = click.argument("scene", required=False, shell_complete=complete_scene)
json_option = flag(
    "--json", "Print JSON in place of the table.", expose_value=False, callback=claim_stdout
)
set_option = option(
    "--set NAME=VALUE",
    "Change a parameter, such as k=3 or Omega=2*pi. Repeatable.",
    "settings",
    multiple=True,
)
plot_option = option("--plot FIGURE", "Draw it: .pdf, .svg or .png. -: SVG to stdout.")
start_error_option = option(
    "--start-error E",
    "How far t0, x0, v0 may be off: a number, or three with commas.",
    callback=lambda context, given, text: read_start_error(
        text.split(",") if text and "," in text else text
    ),
)


def refuse(*rules: tuple[object, str]) -> None:
    """Raise UsageError with the first text in these pairs (condition, text) whose condition is
    true.
    """
    for broken, text in rules:
        if broken:
            raise click.UsageError(text)


def folder_name(output: str, hint: str = "--output") -> str:
    """Return the folder name `output`.

    BadParameter for the option `hint` if it is empty or standard output.
    """
    if output in ("", STDOUT):
        raise click.BadParameter(
            f"{output!r} is not a folder; './-' is one named -", param_hint=hint
        )
    return output


def split_setting(text: str, hint: str, form: str, taken: Iterable[str] = ()) -> tuple[str, str]:
    """Return name and value of NAME=VALUE.

    BadParameter for option `hint` if not of that `form`, or name in `known`.
    """
    name, _, value = (part.strip() for part in text.partition("="))
    if not (name and value):
        raise click.BadParameter(f"{text!r} is not {form}", param_hint=hint)
    if name in taken:
        raise click.BadParameter(f"{name} is given twice", param_hint=hint)
    return name, value


def split_columns(text: Text, known: Sequence[str]) -> dict[str, str]:
    """Return the names of columns by what they hold, which is one of `known`."""
    form = ", ".join(f"{name}=NAME" for name in known[:-1]) + f" or {known[-1]}=NAME"
    names: dict[str, str] = {}
    # A comma may stand in a name: only one before t=, x=, ... divides.
    divider = rf",(?=\s*(?:{'|'.join(known)})\s*=)"
    for part in () if text is None else re.split(divider, text):
        name, column = split_setting(part, "--columns", form, names)
        if name not in known:
            raise click.BadParameter(f"{part!r} is not {form}", param_hint="--columns")
        names[name] = column
    return names


def read_span(text: str, hint: str) -> tuple[str, tuple[str, str]]:
    """Return the name and the limits of `text`, NAME=LOW:HIGH.

    BadParameter for the option `hint` otherwise.
    """
    form = "NAME=LOW:HIGH, such as Omega=3:5"
    name, limits = split_setting(text, hint, form)
    low, colon, high = limits.partition(":")
    if not colon:
        raise click.BadParameter(f"{text!r} is not {form}", param_hint=hint)
    return name, (low, high)


def read_settings(settings: Settings) -> dict[str, str]:
    """Return names and values of --set options as texts.

    BadParameter if not NAME=VALUE, or for t0, x0, v0, t_end.
    """
    changes: dict[str, str] = {}
    for setting in settings:
        name, value = split_setting(setting, "--set", "NAME=VALUE, such as k=3", changes)
        if name in START_NAMES:
            raise click.BadParameter(
                f"{name} is not a parameter; use --{name.replace('_', '-')}", param_hint="--set"
            )
        changes[name] = value
    return changes


def read_parameters(settings: Settings) -> dict[str, Any]:
    """Return the numbers of --set options; expressions such as 2*pi are read as in scene files."""
    return {name: read_typed(name, text) for name, text in read_settings(settings).items()}


def scene_with(scene: str | Scene, settings: Settings, **start: Text) -> Scene:
    """Return a scene with parameters changed by --set, and its start by `start`.

    Print its notes on stderr.
    """
    if isinstance(scene, str):
        scene = load_scene(scene)
    for line in scene.notes:
        note(f"{scene.name}: {line}")
    scene = scene.changed(**read_parameters(settings))
    changes = dict[str, Any]()
    for name, text in start.items():
        if text is not None:
            number = read_duration(name, text)
            # `started` reads an expression itself, as it tells how well the start is known.
            if name == "t_end":
                changes[name] = number
            else:
                changes[name] = text
    return scene.started(changes)


def reduced_scene(scene: Scene, any_law: bool = False) -> Scene:
    """Return a scene with `Parameters`, in the coordinates of symosc's model; for one of another
    model, print a note.

    With `any_law` it keeps its belts, and may have an `Oscillator`.
    """
    if scene.original is not None:
        drive = scene.parameters.as_dict()["B0"]
        note(
            f"{scene.name}: of another model; this is about the oscillator that it is, with B0 = "
            f"{drive}"
        )
    return scene_of(scene, "scene", any_law).reduced()  # type: ignore[union-attr]


def read_duration(name: str, text: str) -> Any:
    """Return a time in periods, such as 10T, as it is, and any other as `read_typed` does.

    Errors call it `name`.
    """
    if text.strip().endswith("T"):
        return text.strip()
    return read_typed(name, text)


def read_typed(name: str, text: str) -> Any:
    """Return the text of a number unchanged, and the value of an expression such as 2*pi.

    Messages call it `name`.
    """
    if not re.search(r"pi|π|[*^()]", text):
        return text
    number, exact = read_number(name, text)
    if not exact:
        note(f"{name} = {text}: read to 40 digits")
    return number
