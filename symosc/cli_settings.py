"""Parameters on the command line: ``--set NAME=VALUE``, read alike by every command."""

from __future__ import annotations

import click

from symosc.scenes import START_NAMES


def read_settings(settings: tuple[str, ...]) -> dict[str, str]:
    """Return names and values of ``--set`` options.

    Raises
    ------
    click.BadParameter
        For one that is not NAME=VALUE, is given twice or belongs to the start.
    """
    changes: dict[str, str] = {}
    for setting in settings:
        name, equals, value = setting.partition("=")
        if not equals:
            raise click.BadParameter(f"{setting!r} is not NAME=VALUE, such as k=3", param_hint="--set")
        if name in START_NAMES:
            raise click.BadParameter(f"{name} is no parameter; use --{name.replace('_', '-')}", param_hint="--set")
        if name in changes:
            raise click.BadParameter(f"{name} is set twice", param_hint="--set")
        changes[name] = value
    return changes
