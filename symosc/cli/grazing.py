"""`symosc grazing`: Theorem 7's windows of a scene, exactly, and for which parameters they have a
property.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import click

import symosc
from symosc.base.aliases import Order, Record
from symosc.base.display.progress import late_bar
from symosc.base.exact import show
from symosc.cli import options, output
from symosc.cli.options import Settings, Text, flag, option
from symosc.kernels.theorem7_cases import ORDERS, PLACES, place
from symosc.model import PARAMETER_NAMES, Parameters
from symosc.scenes import load_scene


@click.command()
@options.optional_scene
@options.set_option
@option("--map MAP", "P2, P3, P5 or P6. Repeatable. Default: all.", "mappings", multiple=True)
@option(
    "--order",
    "paper: as printed, by the sign of G1. full: by the first G-function that is not 0 (default).",
    type=click.Choice(ORDERS),
    default="full",
)
@flag("--latex", "Print LaTeX, one window a line.", callback=output.claim_stdout)
@options.json_option
@option(
    "--check N", "Check the windows at N phases each.", "phases", type=options.WholeNumber(min=1)
)
@option("--plot FIGURE", "Draw windows, contact curves and grazing curves: .pdf, .svg or .png.")
@option(
    "--solve NAME[,NAME]", "For which values of Omega, B0, k, v1 or v2, or of two, see --phase."
)
@option(
    "--phase PHASE[:PHASE]", "With --solve: where it grazes at this phase, or at all in between."
)
@option(
    "--against NAME[=LOW:HIGH]",
    "With --plot and one --map: the window against Omega, B0, k, v1 or v2.",
)
def grazing(
    scene: Text,
    settings: Settings,
    mappings: tuple[str, ...],
    order: Order,
    latex: bool,
    plot: Text,
    **more_options: Any,
) -> int:
    """Print the grazing windows of a scene: at which phases Omega t mod 2 pi a touching flow turns
    back (Theorem 7).

    Columns: the map; the case; gamma = k v/m; B0 Omega/m; Theta_cr; the window. Case (55.1) is the
    first of the paper's (55); cases with a letter a, b or c, or shifted by pi, are missing in the
    paper. A window is exact: asin(1/12) + pi is not rounded.

    With --check each window is compared with three independent decisions, at random phases and
    close to its ends: by the signs of the G-functions, by the exact flow around the contact, and by
    scipy's DOP853. A mismatch gives exit code 1.

    --solve asks the other way round: for which values of a parameter a phase, or every phase
    between two, is in the window, exactly; without --phase, for which values the window is empty
    and for which it is everything. Two parameters give a region, which --plot draws. Without SCENE
    and --set the answer is in letters.

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
    phases, solve, phase, against = (
        more_options[name] for name in ("phases", "solve", "phase", "against")
    )
    options.refuse(
        (
            latex and output.prints_json(),
            "give --latex or --json, not both; the JSON has the LaTeX",
        ),
        (
            phase is not None and solve is None,
            "--phase needs --solve, which says what is asked for",
        ),
        (
            solve is not None and (phases, against) != (None, None),
            "--solve goes without --check and --against",
        ),
        (
            against is not None and (plot is None or len(mappings) != 1),
            "--against needs --plot FIGURE and one --map",
        ),
    )
    in_letters = solve is not None and scene is None and not settings
    if in_letters:
        name = None
        p = None
        boundaries = range(1, 3)
    else:
        name, p, boundaries = _parameters(scene, settings)
    chosen = list(dict.fromkeys(mappings))
    for mapping in chosen:
        boundary = place(mapping).boundary  # ParameterError for a map that cannot graze
        options.refuse(
            (
                boundary not in boundaries,
                f"{mapping} is at belt {boundary}, and the scene has one belt",
            )
        )
    at_belts = [mapping for mapping in PLACES if place(mapping).boundary in boundaries]
    if solve is not None:
        answers = _solve(p, chosen, at_belts, solve, phase, order, plot)
        if p is None:
            parameters = None
        else:
            parameters = p.as_dict()
        data: Record = {
            "parameters": parameters,
            "order": order,
            "answers": list(map(_answer_data, answers)),
        }
        texts = [answer.latex() if latex else answer.text() for answer in answers]
        output.report(lambda: data, lambda: output.write("\n".join(texts)))
        return 0
    assert p is not None
    windows = [symosc.grazing_window(p, mapping, order) for mapping in chosen or at_belts]
    reports = []
    if phases is not None:
        reports = [
            symosc.check_grazing(p, mapping, n=phases, progress=True)
            for mapping in chosen or at_belts
        ]
    output.draw(plot, _draw_windows, windows, against)
    data = {"scene": name, "parameters": p.as_dict(), "order": order}
    if reports:
        data |= {"checks": [report.to_dict() for report in reports]}
    printed = partial(_print_windows, windows, reports, latex)
    output.report(
        lambda: data | {"windows": list(map(_window_data, windows))}, printed
    )  # LaTeX needs sympy
    return int(any(not report.ok for report in reports))


def _print_windows(windows: list[symosc.GrazingWindow], reports: list[Any], latex: bool) -> None:
    """Print windows as a table with notes, or as LaTeX, and the reports of `--check`."""
    from symosc.grazing.window import critical_text, phases_text

    if latex:
        output.write("\n".join(window.latex() for window in windows))
        return
    rows = []
    for window in windows:
        numbers = [show(window.gamma), show(window.amplitude)]
        rows.append(
            [window.mapping, window.case, *numbers, critical_text(window), phases_text(window)]
        )
    output.write_table(rows, ["map", "case", "gamma", "B0 Omega/m", "Theta_cr", "window"])
    for window in windows:
        if window.not_as_printed:
            output.write(f"{window.mapping}: {window.not_as_printed}")
        if window.parameters.k == 0 and window.kind:
            fixed = ", ".join(map(str, window.contact_phases)) or "at no phase of it"
            output.write(
                f"{window.mapping}: k = 0, so x_m is free and F = 0 fixes the phase: {fixed}"
            )
    for report in reports:
        output.write("\n" + report.summary())


def _parameters(scene: Text, settings: Settings) -> tuple[Text, Parameters, range]:
    """Return the scene's name and parameters, or None and the parameters that were all given by
    --set; and the numbers of the belts.
    """
    changes = options.read_parameters(settings)
    given = load_scene(scene or "fig5").changed(**changes)
    problem = options.reduced_scene(given)
    missing = [name for name in PARAMETER_NAMES if name not in changes and scene is None]
    if missing:
        raise click.UsageError(
            f"give a SCENE, or every parameter by --set; missing: {', '.join(missing)}"
        )
    return (
        None if scene is None else problem.name,
        problem.parameters,
        given.parameters.law.boundaries,
    )


def _window_data(window: symosc.GrazingWindow) -> Record:
    """Return a grazing window as the data that --json prints."""
    from symosc.grazing.window import critical_text, phases_text

    exact = critical_text(window)
    names = ("low", "high", "low_closed", "high_closed")
    data: Record = {
        "map": window.mapping,
        "domain": window.place.domain,
        "boundary": window.place.boundary,
    }
    data |= {"case": window.case, "gamma": show(window.gamma), "amplitude": show(window.amplitude)}
    if exact == "none":
        data["theta_cr"] = None
    else:
        data["theta_cr"] = {"exact": exact, "value": float(window.critical_phase())}
    data["phases"] = phases_text(window)
    data["intervals"] = [dict(zip(names, interval, strict=True)) for interval in window.intervals]
    return data | {"latex": window.latex()}


def _draw_windows(windows: list[symosc.GrazingWindow], against: Text) -> Any:
    """Return the figure of all windows or, if `against` names a parameter, of the first one as that
    changes.
    """
    from symosc.plot.windows import draw_plane, sweep_figure, window_figure

    def plane(axes: Any, window: symosc.GrazingWindow) -> None:
        draw_plane(axes, symosc.grazing_curve(window.parameters, window.mapping, progress=True))

    window = windows[0]
    if against is None:
        return window_figure(windows, plane if window.parameters.k else None)
    if "=" in against:
        name, (low, high) = options.read_span(against, "--against")
    else:
        name = against
        low = None
        high = None
    return sweep_figure(window.parameters, window.mapping, name, low, high, window.order)


def _solve(
    p: Parameters | None,
    mappings: list[str],
    at_belts: list[str],
    names: str,
    phases: Text,
    order: Order,
    plot: Text,
) -> list[Any]:
    """Return for which values of the parameters `names` each mapping's window contains a phase, or
    all in an interval.

    `names` is NAME or NAME,NAME, and `phases` is PHASE or LOW:HIGH; without `phases` two questions
    are answered: for which values is the window empty, and for which is it all phases? The answers
    are formulas if `p` is None. If `plot` names a file, the region of two parameters is drawn.
    `order` is that of `symosc.grazing_window`. Without `mappings` they are those `at_belts`.
    """
    parameter_names = tuple(name.strip() for name in names.split(","))
    if not all(parameter_names) or len(parameter_names) > 2:
        raise click.BadParameter(
            f"{names!r} is not NAME or NAME,NAME, such as Omega", param_hint="--solve"
        )
    # Without phases there are two answers for each map, and only one region can be drawn.
    one_region = len(parameter_names) == 2 and phases is not None and len(mappings) == 1
    needs_numbers = "--solve NAME,NAME needs numbers: give a SCENE, or every parameter by --set"
    draws_one = "--solve --plot draws one region: give numbers, NAME,NAME, one --map and --phase"
    options.refuse(
        (p is None and len(parameter_names) > 1, needs_numbers),
        (plot is not None and not one_region, draws_one),
    )
    low, colon, high = (phases or "").partition(":")
    if colon and not (low.strip() and high.strip()):
        raise click.BadParameter(
            f"{phases!r} is not PHASE or LOW:HIGH, such as pi:3*pi/2", param_hint="--phase"
        )
    if not mappings:
        # Those whose belt's speed is asked for; if both speeds are, the answers say what is wrong.
        speeds = {name for name in parameter_names if name in ("v1", "v2")}
        mappings = [
            mapping for mapping in at_belts if speeds <= {f"v{place(mapping).boundary}"}
        ] or at_belts
    if len(parameter_names) == 2:
        question: Any = parameter_names
    else:
        (question,) = parameter_names
    answers: list[Any] = []
    with late_bar(progress=True, label="solve", unit="maps") as advance:
        for count, mapping in enumerate(mappings, start=1):
            if phases is None:
                answers.append(symosc.values_empty(p, mapping, question))
                answers.append(symosc.values_everything(p, mapping, question, order))
            else:
                answers.append(
                    symosc.values_containing(
                        p, mapping, question, (low, high) if colon else phases, order
                    )
                )
            if advance:
                advance(count / len(mappings), count)
    output.draw(plot, lambda: answers[0].plot())
    return answers


def _answer_data(answer: Any) -> Record:
    """Return an answer of --solve as the data that --json prints."""
    from symosc.symbolic.inverse import condition_text, interval_text

    question = answer.question
    data: Record = {
        "map": question.mapping,
        "names": list(question.names),
        "question": question.text(),
    }
    if isinstance(answer, symosc.Answers):
        texts = ((condition_text(case.condition), interval_text(case.values)) for case in answer)
        data["answers"] = [
            {"condition": condition, "values": values} for condition, values in texts
        ]
    elif isinstance(answer, symosc.ParameterRegion):
        data |= {
            "condition": condition_text(answer.condition),
            "allowed": condition_text(answer.allowed),
        }
    else:
        data["values"] = interval_text(answer.values)
    return data | {"latex": answer.latex()}
