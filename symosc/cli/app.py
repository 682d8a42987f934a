"""The command line. Each command loads what it needs when it runs, so that `simulate` starts fast.

Exit codes: 0 success, 1 a check failed, 2 bad input (one line on stderr).
"""

from __future__ import annotations

import sys
import warnings
from importlib import import_module
from platform import python_version
from time import monotonic
from typing import Any, NoReturn

import click

import symosc
from symosc.base.display import progress
from symosc.base.errors import CodeCacheWarning, SymoscError, brief, meant
from symosc.base.files import drop
from symosc.cli.options import flag
from symosc.cli.output import BAD_INPUT, INTERRUPTED, complain, note, write
from symosc.model import PARAMETER_NAMES

#: The longest word that an error shows whole, such as the path of a file.
LONGEST_WORD = 300
#: The commands, and the module of each, which is loaded when the command is used.
COMMANDS = {
    "simulate": "simulate",
    "figure": "simulate",
    "explore": "simulate",
    "scenes": "scenes",
    "new": "scenes",
    "orbit": "orbit",
    "fit": "fit",
    "grazing": "grazing",
    "check": "check",
    "cases": "check",
    "score": "check",
    "atlas": "atlas",
    "attractors": "attractors",
    "certify": "certify",
    "verify": "certify",
    "derive": "derive",
    "codegen": "derive",
    "sweep": "sweep",
    "bench": "bench",
    "warm": "bench",
    "reproduce": "reproduce",
}


# Characters of a command's summary, at most: all of it.
LONGEST_SUMMARY = 1000


class CommandLine(click.Group):
    """The command `symosc` with its subcommands.

    Any error, also one of usage, is printed as one line.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands of the program."""
        return sorted(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import the module of a command and return the command, with the options --quiet and
        --verbose.
        """
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = getattr(
            import_module(f"symosc.cli.{COMMANDS[cmd_name]}"), cmd_name
        )
        option_names = {option for parameter in command.params for option in parameter.opts}
        command.params += [
            option for option in _verbosity_options() if not option_names & set(option.opts)
        ]
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write all commands with their whole summaries: click cuts them off to fit one line."""
        commands = {name: self.get_command(ctx, name) for name in self.list_commands(ctx)}
        rows = [
            (name, command.get_short_help_str(limit=LONGEST_SUMMARY))
            for name, command in commands.items()
            if command is not None
        ]
        with formatter.section("Commands"):
            formatter.write_dl(rows)

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Return the name, the command and the other arguments from `args`; for a wrong name
        suggest a right one.
        """
        name, *_ = args
        is_option = name.startswith("-")
        # Parsing is resilient for shell completion, where names are unfinished.
        if not ctx.resilient_parsing and not is_option and self.get_command(ctx, name) is None:
            ctx.fail(f"No such command {name!r}; {_commands_like(name)}")
        return super().resolve_command(ctx, args)

    def main(self, *args: Any, standalone_mode: bool = True, **extra: Any) -> Any:
        """Run a command; in standalone mode report errors and exit."""
        run: Any = super().main
        if not standalone_mode:
            return run(*args, standalone_mode=False, **extra)
        warnings.showwarning = _warn
        if sys.stdout is None:
            _fail("standard output is closed")
        try:
            code = run(*args, standalone_mode=False, **extra)
        except click.ClickException as error:
            context = getattr(error, "ctx", None)
            option = getattr(error, "option_name", "").lstrip("-")
            if option in PARAMETER_NAMES:
                set_it = f"; a parameter is set by --set {option}=VALUE"
            else:
                set_it = ""
            if context:
                hint = f" (see {context.command_path} --help)"
            else:
                hint = ""
            _fail(error.format_message().rstrip(".") + set_it + hint)
        except SymoscError as error:
            _fail(str(error))
        except OverflowError as error:
            _fail(f"a number is beyond the range of double precision ({error})")
        except (MemoryError, SystemError):  # the second where memory ends within an extension
            _fail("there is not enough memory for this")
        except OSError as error:
            drop(sys.stdout)
            _fail(f"{error.filename or 'cannot write standard output'}: {error.strerror or error}")
        except ImportError as error:  # a broken installation, or no memory for a library
            _fail(f"a module cannot be loaded: {error}")
        except ValueError as error:
            from symosc.plot.backend import backend_error

            unknown = backend_error(error)
            if unknown is None:
                raise
            _fail(str(unknown))
        except click.Abort:
            sys.exit(INTERRUPTED)
        sys.exit(code if isinstance(code, int) else 0)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an interrupt ends it quietly."""
        begin = monotonic()
        try:
            with progress.working("working"):
                code = super().invoke(ctx)
            about = f"symosc {symosc.__version__}, Python {python_version()}"
            note(
                f"{ctx.invoked_subcommand}: {monotonic() - begin:.2f} s; {about}", progress.VERBOSE
            )
            return code
        except (KeyboardInterrupt, RuntimeError) as error:
            if not _is_interrupt(error):
                raise
            ctx.exit(INTERRUPTED)
        finally:
            # A program that runs commands itself goes on as it was.
            progress.level = progress.NORMAL


def _commands_like(name: str) -> str:
    """Return which commands may be meant by an unknown name; all of them if none is like it."""
    begun = [command for command in sorted(COMMANDS) if command.startswith(name)]
    if begun:
        return f"did you mean {' or '.join(begun)}?"
    hint = meant(name, COMMANDS).removeprefix("; ")
    return hint or f"choose from {', '.join(sorted(COMMANDS))}"


def _verbosity_options() -> list[click.Option]:
    """Return --quiet and --verbose, which every command has."""

    def set_verbosity(context: click.Context, option: click.Parameter, wanted: bool) -> None:
        if wanted:
            if option.name == "quiet":
                progress.level = progress.QUIET
            else:
                progress.level = progress.VERBOSE

    about = {
        "quiet": "Print results and errors only: no bars, no notes.",
        "verbose": "Print more on stderr.",
    }
    options: dict[str, Any] = {"is_flag": True, "expose_value": False, "callback": set_verbosity}
    return [
        click.Option([f"--{name}", f"-{name[0]}"], help=text, **options)
        for name, text in about.items()
    ]


def _is_interrupt(error: BaseException | None) -> bool:
    """Return whether an error is a KeyboardInterrupt, or was raised because of one."""
    return isinstance(error, KeyboardInterrupt) or (
        error is not None and _is_interrupt(error.__cause__)
    )


_as_python_does = warnings.showwarning


def _warn(message: Any, category: type[Warning], *where: Any, **more: Any) -> None:
    """Print a warning about the cache of compiled code as a one-line note, and any other as Python
    does.
    """
    if issubclass(category, CodeCacheWarning):
        note(str(message))
    else:
        _as_python_does(message, category, *where, **more)


def _fail(message: str) -> NoReturn:
    """Print why the input is bad, in one line, and end with the exit code for that."""
    words = [brief(word) if len(word) > LONGEST_WORD else word for word in message.split()]
    complain(f"error: {' '.join(words)}")
    sys.exit(BAD_INPUT)


def _print_citation(context: click.Context, option: click.Parameter, wanted: bool) -> None:
    """Print the BibTeX entry of the program if the option is given, and end."""
    if wanted:
        from symosc.derive.citation import bibtex

        write(bibtex())
        context.exit()


@click.group(
    cls=CommandLine, no_args_is_help=False, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(symosc.__version__, prog_name="symosc")
@flag(
    "--cite",
    "Print BibTeX of symosc and the paper.",
    is_eager=True,
    expose_value=False,
    callback=_print_citation,
)
def main() -> None:
    """Exact solutions of the double-belt friction oscillator.

    SCENE is the name of a shipped scene (see symosc scenes) or the path of a TOML file of the same
    form. Numbers are read exactly: 0.8 and 4/5 are the same.

    Exit codes: 0 success, 1 a check failed, 2 bad input.

    \b
    Example:
      symosc simulate fig5
    """
