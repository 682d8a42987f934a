"""`symosc bench` and `symosc warm`: measure speed and error, and compile the loops ahead."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import click

import symosc
from symosc.base.aliases import Record
from symosc.base.display.progress import bar
from symosc.base.errors import MissingExtraError
from symosc.cli import options, output
from symosc.cli.options import Text, flag, option


@click.command()
@flag("--quick", "Fewer scenes, tolerances, cases and repeats: half a minute.")
@flag("--hard", "The hard cases in place of speed, work and precision.")
@options.json_option
@option(
    "-o, --output FIGURE",
    "Draw error against time per event: .pdf, .svg or .png. -: SVG to stdout.",
    "picture",
)
@option("--results README", "Run everything, and write it between the README's marks.", "readme")
@option("--scores FILE", "Score all solvers on the reference cases: a Markdown page.")
@option("--gradients FILE", "Score ways to differentiate the events: a Markdown page.")
def bench(
    quick: bool, hard: bool, picture: Text, readme: Text, scores: Text, gradients: Text
) -> int:
    """Measure the speed and the error of symosc and of other solvers.

    Prints the time per event of symosc, and time and error of other solvers, on the shipped scenes;
    times are given as multiples of symosc's and of one closed-form evaluation. Solvers that are not
    installed are skipped, and named (extra bench); one that hangs or fails is shown as such. With
    --hard all solvers get the hard ones of the reference cases. The exit code is 1 if symosc itself
    misses or invents an event, or has an error above 1e-12 (in ill-conditioned cases above 100 *
    condition * 1e-16). Then -o draws the error of symosc's kernels over damping ratio and drive.

    --scores lets all solvers follow all reference cases (`symosc cases`), which takes some minutes,
    and writes what `symosc score` says of them, with a picture beside it.

    --gradients lets other tools (extra gradients) differentiate the events of these cases.

    --results writes into a README that has the lines '<!-- results: begin -->' and '<!-- results:
    end -->'. Pictures and full tables go to docs/results beside it.

    \b
    Examples:
      symosc bench --quick
      symosc bench -o work.svg --json > bench.json
      symosc bench --hard
      symosc bench --results README.md
      symosc bench --scores docs/results/scores.md
      symosc bench --gradients docs/results/gradients.md
    """
    from symosc.bench import cases, error_map, results, speed, work

    alone = [
        (name, path)
        for name, path in (("--scores", scores), ("--gradients", gradients))
        if path is not None
    ]
    if alone:
        others = (
            quick
            or hard
            or output.prints_json()
            or picture is not None
            or readme is not None
            or len(alone) > 1
        )
        options.refuse((others, f"{alone[0][0]} is a run of its own: leave out the other options"))
        return _score(*alone[0])
    if readme is not None:
        rest = "leave out --hard and -o"
        options.refuse(
            (
                hard or picture is not None,
                f"--results runs everything and draws its own pictures: {rest}",
            )
        )
        results.check(readme)
    result: Record = {"quick": quick}
    if not hard:
        if find_spec("numba") is None:
            raise MissingExtraError("symosc bench", "bench")
        result["speed"] = speed.run(quick=quick, progress=partial(_bar, "calls"))
        result["work_precision"] = work.run(quick=quick, progress=partial(_bar, "solvers"))
    if readme is not None:
        result["scores"] = cases.run(progress=partial(_bar, "reference cases"))
    elif hard:
        result["hard"] = cases.run(partial(_bar, "hard cases"), cases=cases.hard_ones(quick))
    if readme is not None or (hard and picture is not None):
        result["error_map"] = error_map.run(quick=quick, progress=partial(_bar, "error map"))
    if readme is None:
        written = []
    else:
        written = results.write(readme, result)
    if picture is not None:
        if hard:
            drawing = error_map.figure(result["error_map"])
        else:
            drawing = work.figure(result["work_precision"])
        written.append(symosc.plot.save(drawing, picture))

    def show() -> None:
        if readme is None and hard:
            output.write(cases.table(result["hard"]))
        elif readme is None:
            output.write(
                f"{speed.table(result['speed'])}\n\n{work.table(result['work_precision'])}"
            )
        output.name_files(*written)

    judged = result.keys() & {"hard", "scores"}
    plain = result | {key: cases.as_json(result[key]) for key in judged if output.prints_json()}
    output.report(lambda: plain, show)
    if all(result[key]["ok"] for key in judged):
        return 0
    return output.FAILED


def _score(hint: str, page: str) -> int:
    """Carry out --scores or --gradients, as `hint` says, and write the Markdown file `page`.

    Return exit code 0.
    """
    from symosc.base.files import check_folder_of
    from symosc.bench import cases, gradients

    if not page.endswith(".md"):
        raise click.BadParameter(f"{page!r} must end in .md", param_hint=hint)
    check_folder_of(page)  # before the work
    if hint == "--scores":
        runs: Any = cases
    else:
        runs = gradients
    result = runs.run(partial(_bar, "reference cases"))
    output.name_files(*runs.write(page, result, f"symosc bench {hint} {Path(page).as_posix()}"))
    return 0


def _bar(label: str, steps: Sequence[Any]) -> Iterator[Any]:
    """Yield the steps one by one, and show a progress bar on stderr if that is a terminal."""
    with bar(label, len(steps)) as report:
        for done, step in enumerate(steps, 1):
            yield step
            report(done, len(steps))


@click.command()
@options.json_option
def warm() -> None:
    """Compile ahead what simulate_many needs, so that no later program waits for a compiler.

    Needs numba (extra fast), and takes a minute. What is compiled is kept on disk; it is made anew
    when symosc or numba changes. Without this command it is compiled when there is enough work for
    it, and smaller work is interpreted.

    \b
    Examples:
      symosc warm
    """
    from symosc.simulation.batch import warm as compile_all

    rows = compile_all()
    table = [
        [row.what, "loaded" if row.was_there else "compiled", f"{row.seconds:.1f}"] for row in rows
    ]
    heads = ["what", "how", "seconds"]
    output.report(lambda: [row._asdict() for row in rows], lambda: output.write_table(table, heads))
