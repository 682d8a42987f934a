"""The command `symosc grazing`: Theorem 7's windows of a scene, exactly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from symosc.aliases import Order, Record
from symosc.cli import inverse
from symosc.cli.output import json_option, write, write_json, write_table
from symosc.cli.settings import WholeNumber, complete, complete_scene, goes_to_stdout, read_parameters
from symosc.errors import ParameterError
from symosc.exact import show
from symosc.mappings.theorem7_cases import ORDERS, PLACES, place
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import load_scene

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from symosc.grazing.check import GrazingReport
    from symosc.grazing.window import GrazingWindow


@click.command()
@click.argument("scene", required=False, shell_complete=complete_scene)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    shell_complete=complete(PARAMETER_NAMES, "="),
    help="Change a parameter, such as k=3. Repeatable; all of them in place of SCENE.",
)
@click.option(
    "--map",
    "mappings",
    multiple=True,
    metavar="MAP",
    shell_complete=complete(PLACES),
    help="P2, P3, P5 or P6. Repeatable. Default: all.",
)
@click.option(
    "--order",
    type=click.Choice(ORDERS),
    default="full",
    help="paper: as printed, by the sign of G1. full: by the first G-function that is not 0 (default).",
)
@click.option("--latex", "as_latex", is_flag=True, help="Print LaTeX, one window a line.")
@json_option
@click.option("--check", "phases", metavar="N", type=WholeNumber(min=1), help="Check the windows at N phases each.")
@click.option(
    "--plot", "output", metavar="FILE", help="Draw windows, contact curves and grazing curves: .pdf, .svg or .png."
)
@click.option(
    "--solve", metavar="NAME[,NAME]", help="For which values of Omega, B0, k, v1 or v2, or of two, see --phase."
)
@click.option(
    "--phase", metavar="PHASE[:PHASE]", help="With --solve: where it grazes at this phase, or at all in between."
)
@click.option(
    "--against", metavar="NAME[=LOW:HIGH]", help="With --plot and one --map: the window against Omega, B0, k, v1 or v2."
)
def grazing(
    *,
    scene: str | None,
    settings: tuple[str, ...],
    mappings: tuple[str, ...],
    order: Order,
    as_latex: bool,
    as_json: bool,
    phases: int | None,
    output: str | None,
    solve: str | None,
    phase: str | None,
    against: str | None,
) -> int:
    """Print the grazing windows of a scene: at which phases Omega t mod 2 pi a touching flow turns back (Theorem 7).

    Columns: the map; the paper's case, (55.1) is the first of (55), letters and shifts are cases that it lacks; gamma =
    k v/m; B0 Omega/m; Theta_cr; the window. A window is exact: asin(1/12) + pi is not rounded to a decimal.

    With --check each window is compared with three independent decisions, at random phases and close to its ends: by
    the signs of the G-functions, by the exact flow around the contact, and by scipy's DOP853. A mismatch gives exit
    code 1.

    --solve asks the other way round: for which values of a parameter a phase, or every phase between two, is in the
    window, exactly; without --phase, for which values the window is empty and for which it is everything. Two
    parameters give a region, which --plot draws. Without SCENE and --set the answer is in letters.

    \b
    Examples:
      symosc grazing fig9
      symosc grazing fig9 --check 10000
      symosc grazing fig8 --map P3 --order paper --latex
      symosc grazing fig9 --set k=4 --map P2 --plot window.pdf
      symosc grazing fig9 --map P2 --against Omega=0.1:4 --plot sweep.pdf
      symosc grazing fig9 --map P2 --solve Omega --phase 7*pi/6
      symosc grazing fig9 --map P2 --solve Omega,k --phase pi:3*pi/2 --latex
      symosc grazing fig9 --map P2 --solve Omega,k --phase 7*pi/6 --plot region.pdf
      symosc grazing --map P3 --solve Omega --phase pi
    """
    piped = goes_to_stdout(output, "--plot", as_json or as_latex)
    if as_latex and as_json:
        raise click.UsageError("give --latex or --json, not both; the JSON has the LaTeX")
    _check_questions(solve, phase, compared=phases is not None or against is not None)
    if against is not None and (output is None or len(mappings) != 1):
        raise click.UsageError("--against needs --plot FILE and one --map")
    letters = solve is not None and scene is None and not settings
    name, p = (None, None) if letters else _parameters(scene, settings)
    chosen = _chosen(mappings)
    if solve is not None:
        forms: dict[str, Any] = {"as_latex": as_latex, "as_json": as_json, "output": output, "piped": piped}
        inverse.solve(p, chosen, solve, phase, order, **forms)
        return 0
    assert p is not None
    windows, reports = _decided(p, chosen or list(PLACES), order, phases)
    if output is not None:
        _draw(windows, against, output)
    if not piped:
        _show(name, windows, reports, as_latex, as_json)
    return int(any(not report.ok for report in reports))


def _check_questions(solve: str | None, phase: str | None, compared: bool) -> None:
    """Refuse a phase that nothing is asked about, and checks of an answer about parameters."""
    if phase is not None and solve is None:
        raise click.UsageError("--phase needs --solve, which says what is asked for")
    if solve is not None and compared:
        raise click.UsageError("--solve goes without --check and --against")


def _chosen(mappings: tuple[str, ...]) -> list[str]:
    """Return each map once; ParameterError for one without grazing."""
    for mapping in mappings:
        place(mapping)
    return list(dict.fromkeys(mappings))


def _decided(
    p: Parameters, mappings: list[str], order: Order, phases: int | None
) -> tuple[list[GrazingWindow], list[GrazingReport]]:
    """Return the windows, and reports that check each at so many phases, if any."""
    from symosc.grazing.window import grazing_window

    windows = [grazing_window(p, mapping, order) for mapping in mappings]
    if phases is None:
        return windows, []
    from symosc.grazing.check import check_grazing

    return windows, [check_grazing(p, mapping, n=phases, progress=True) for mapping in mappings]


def _show(
    name: str | None, windows: list[GrazingWindow], reports: list[GrazingReport], as_latex: bool, as_json: bool
) -> None:
    """Print windows and reports as JSON, the windows as LaTeX, or both as tables."""
    if as_json:
        data: Record = {"scene": name, "parameters": windows[0].parameters.as_dict(), "order": windows[0].order}
        data |= {"checks": [report.to_dict() for report in reports]} if reports else {}
        write_json(data | {"windows": [_data(window) for window in windows]})
    elif as_latex:
        for window in windows:
            write(window.latex())
    else:
        _print(windows, reports)


def _print(windows: list[GrazingWindow], reports: list[GrazingReport]) -> None:
    write_table([_row(window) for window in windows], ["map", "case", "gamma", "B0 Omega/m", "Theta_cr", "window"])
    for window in windows:
        if window.parameters.k == 0 and window.kind:
            fixed = ", ".join(map(str, window.contact_phases)) or "at no phase of it"
            write(f"{window.mapping}: k = 0, so x_m is free and F = 0 fixes the phase: {fixed}")
    for report in reports:
        write("\n" + report.summary())


def _parameters(scene: str | None, settings: tuple[str, ...]) -> tuple[str | None, Parameters]:
    """Return the scene's name and parameters, or None and the parameters that were all given by --set."""
    changes = read_parameters(settings)
    if scene is not None:
        problem = load_scene(scene)
        return problem.name, problem.parameters.replace(**changes)
    for name in changes:
        if name not in PARAMETER_NAMES:
            raise ParameterError(
                name, changes[name], f"is not a parameter; the parameters are {', '.join(PARAMETER_NAMES)}"
            )
    missing = [name for name in PARAMETER_NAMES if name not in changes]
    if missing:
        raise click.UsageError(f"give a SCENE, or every parameter by --set; missing: {', '.join(missing)}")
    return None, Parameters(**changes)


def _row(window: GrazingWindow) -> list[str]:
    from symosc.grazing.window import critical_text, phases_text

    numbers = [show(window.gamma), show(window.amplitude)]
    return [window.mapping, window.case, *numbers, critical_text(window), phases_text(window)]


def _data(window: GrazingWindow) -> Record:
    from symosc.grazing.window import critical_text, phases_text

    theta_cr, exact = None, critical_text(window)
    if exact != "none":
        theta_cr = {"exact": exact, "value": float(window.critical_phase())}
    names = ("low", "high", "low_closed", "high_closed")
    return {
        "map": window.mapping,
        "domain": window.place.domain,
        "boundary": window.place.boundary,
        "case": window.case,
        "gamma": show(window.gamma),
        "amplitude": show(window.amplitude),
        "theta_cr": theta_cr,
        "phases": phases_text(window),
        "intervals": [dict(zip(names, interval, strict=True)) for interval in window.intervals],
        "latex": window.latex(),
    }


def _plane(axes: Axes, window: GrazingWindow) -> None:
    from symosc.grazing.curve import grazing_curve
    from symosc.plot.curve import draw_plane

    draw_plane(axes, grazing_curve(window.parameters, window.mapping, progress=True))


def _draw(windows: list[GrazingWindow], against: str | None, output: str) -> None:
    from symosc.plot.drawing import check_suffix, save

    check_suffix(output)
    from symosc.plot.sweep import sweep_figure
    from symosc.plot.windows import window_figure

    if against is None:
        save(window_figure(windows, _plane if windows[0].parameters.k else None), output)
        return
    name, equals, span = against.partition("=")
    low, colon, high = span.partition(":")
    if equals and not (colon and low and high):
        form = "is not NAME or NAME=LOW:HIGH, such as Omega=0.1:4"
        raise click.BadParameter(f"{against!r} {form}", param_hint="--against")
    window = windows[0]
    drawing = sweep_figure(window.parameters, window.mapping, name, low or None, high or None, window.order)
    save(drawing, output)
