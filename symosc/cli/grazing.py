"""`symosc grazing`: Theorem 7's windows of a scene, exactly, and for which parameters they have a property."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from symosc.aliases import Order, Record
from symosc.cli.common import (
    WholeNumber,
    check_picture,
    complete,
    goes_to_stdout,
    json_option,
    optional_scene,
    read_parameters,
    read_span,
    reduced_scene,
    set_option,
    write,
    write_json,
    write_table,
)
from symosc.display.progress import late_bar
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
@optional_scene
@set_option
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

    All eleven parameters by --set stand for a SCENE.

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
    if phase is not None and solve is None:
        raise click.UsageError("--phase needs --solve, which says what is asked for")
    if solve is not None and (phases is not None or against is not None):
        raise click.UsageError("--solve goes without --check and --against")
    if against is not None and (output is None or len(mappings) != 1):
        raise click.UsageError("--against needs --plot FILE and one --map")
    check_picture(output)
    letters = solve is not None and scene is None and not settings
    name, p = (None, None) if letters else _parameters(scene, settings)
    chosen = list(dict.fromkeys(mappings))
    for mapping in chosen:
        place(mapping)  # ParameterError for a map that cannot graze
    if solve is not None:
        answers = _solve(p, chosen, solve, phase, order, output)
        if as_json:
            given = None if p is None else p.as_dict()
            write_json({"parameters": given, "order": order, "answers": list(map(_answer_data, answers))})
        elif not piped:
            for answer in answers:
                write(answer.latex() if as_latex else answer.text())
        return 0
    assert p is not None
    from symosc.grazing.window import grazing_window

    windows = [grazing_window(p, mapping, order) for mapping in chosen or PLACES]
    reports = []
    if phases is not None:
        from symosc.grazing.check import check_grazing

        reports = [check_grazing(p, mapping, n=phases, progress=True) for mapping in chosen or PLACES]
    if output is not None:
        _draw_windows(windows, against, output)
    if as_json:
        data: Record = {"scene": name, "parameters": windows[0].parameters.as_dict(), "order": windows[0].order}
        data |= {"checks": [report.to_dict() for report in reports]} if reports else {}
        write_json(data | {"windows": [_window_data(window) for window in windows]})
    elif as_latex and not piped:
        for window in windows:
            write(window.latex())
    elif not piped:
        _print_windows(windows, reports)
    return int(any(not report.ok for report in reports))


def _print_windows(windows: list[GrazingWindow], reports: list[GrazingReport]) -> None:
    write_table([_cells(window) for window in windows], ["map", "case", "gamma", "B0 Omega/m", "Theta_cr", "window"])
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
        problem = reduced_scene(load_scene(scene).changed(**changes))
        return problem.name, problem.parameters
    for name in changes:
        if name not in PARAMETER_NAMES:
            raise ParameterError(
                name, changes[name], f"is not a parameter; the parameters are {', '.join(PARAMETER_NAMES)}"
            )
    missing = [name for name in PARAMETER_NAMES if name not in changes]
    if missing:
        raise click.UsageError(f"give a SCENE, or every parameter by --set; missing: {', '.join(missing)}")
    return None, Parameters(**changes)


def _cells(window: GrazingWindow) -> list[str]:
    from symosc.grazing.window import critical_text, phases_text

    numbers = [show(window.gamma), show(window.amplitude)]
    return [window.mapping, window.case, *numbers, critical_text(window), phases_text(window)]


def _window_data(window: GrazingWindow) -> Record:
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


def _draw_plane(axes: Axes, window: GrazingWindow) -> None:
    from symosc.grazing.curve import grazing_curve
    from symosc.plot.windows import draw_plane

    draw_plane(axes, grazing_curve(window.parameters, window.mapping, progress=True))


def _draw_windows(windows: list[GrazingWindow], against: str | None, output: str) -> None:
    from symosc.plot.drawing import save
    from symosc.plot.windows import sweep_figure, window_figure

    window = windows[0]
    if against is None:
        drawing = window_figure(windows, _draw_plane if window.parameters.k else None)
    else:
        name, low, high = against, None, None
        if "=" in against:
            name, (low, high) = read_span(against, "--against")
        drawing = sweep_figure(window.parameters, window.mapping, name, low, high, window.order)
    save(drawing, output)


def _solve(
    p: Parameters | None, mappings: list[str], names: str, phases: str | None, order: Order, output: str | None
) -> list[Any]:
    """Return the answers for all maps, and draw the only one if it is a region; p = None asks with letters."""
    asked = [name.strip() for name in names.split(",")]
    if not all(asked) or len(asked) > 2:
        raise click.BadParameter(f"{names!r} is not NAME or NAME,NAME, such as Omega", param_hint="--solve")
    if p is None and len(asked) > 1:
        raise click.UsageError("--solve NAME,NAME needs numbers: give a SCENE, or every parameter by --set")
    if output is not None and (p is None or len(asked) == 1 or phases is None or len(mappings) != 1):
        raise click.UsageError("--solve --plot draws one region: give numbers, NAME,NAME, one --map and --phase")
    if not mappings:  # those that depend on what is asked
        belts = {name for name in asked if name in ("v1", "v2")}
        mappings = [mapping for mapping in PLACES if belts <= {f"v{place(mapping).boundary}"}] or list(PLACES)
    answers: list[Any] = []
    with late_bar(True, "solve", "maps") as advance:
        for count, mapping in enumerate(mappings, start=1):
            answers += _answers(p, mapping, asked[0] if len(asked) == 1 else tuple(asked), phases, order)
            if advance:
                advance(count / len(mappings), count)
    if output is not None:
        from symosc.plot.drawing import save

        save(answers[0].plot(), output)
    return answers


def _answers(p: Parameters | None, mapping: str, asked: Any, phases: str | None, order: Order) -> list[Any]:
    """Ask which parameter values give an empty window, all phases, or the given phases."""
    from symosc.symbolic.inverse import values_containing, values_empty, values_everything

    if phases is None:
        return [values_empty(p, mapping, asked), values_everything(p, mapping, asked, order)]
    low, colon, high = phases.partition(":")
    if colon and not (low.strip() and high.strip()):
        raise click.BadParameter(f"{phases!r} is not PHASE or LOW:HIGH, such as pi:3*pi/2", param_hint="--phase")
    return [values_containing(p, mapping, asked, (low, high) if colon else phases, order)]


def _answer_data(answer: Any) -> Record:
    from symosc.symbolic.inverse import Answers, ParameterRegion, condition_text, interval_text

    question = answer.question
    data: dict[str, Any] = {"map": question.mapping, "names": list(question.names), "question": question.text()}
    if isinstance(answer, Answers):
        data["answers"] = [
            {"condition": condition_text(each.condition), "values": interval_text(each.values)} for each in answer
        ]
    elif isinstance(answer, ParameterRegion):
        data |= {"condition": condition_text(answer.condition), "allowed": condition_text(answer.allowed)}
    else:
        data["values"] = interval_text(answer.values)
    return data | {"latex": answer.latex()}
