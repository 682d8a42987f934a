"""Benchmark results: measure, write the README section and the pages, and draw the figures."""

from __future__ import annotations

import os
import re
from pathlib import Path
from textwrap import fill

from symosc import plot
from symosc.base.aliases import Record
from symosc.base.errors import OutputError
from symosc.base.files import make_folder, write_text
from symosc.bench import cases, sentence, speed, work
from symosc.bench.solvers import OURS, REFERENCE_DIGITS
from symosc.simulation.simulate import ACCURACY

#: Where pictures and full tables go, relative to the README.
RESULTS_FOLDER = Path("docs/results")


def check(readme: str | Path) -> str:
    """Return a README's text.

    Raise OutputError if the file cannot be written or lacks the marks around the results.
    """
    try:
        text = Path(readme).read_text(encoding="utf-8")
    except OSError as error:
        raise OutputError(str(readme), error.strerror or str(error)) from None
    except UnicodeDecodeError:
        raise OutputError(str(readme), "is not UTF-8 text") from None
    if not os.access(readme, os.W_OK):
        raise OutputError(str(readme), "Permission denied")
    return _replaced(text, "", readme)


def _replaced(text: str, content: str, readme: str | Path) -> str:
    """Return a README's text with other content between the marks of the results.

    OutputError if it lacks them.
    """
    # The first mark may say more before it closes.
    begin = "<!-- results: begin"
    end = "<!-- results: end -->"
    pattern = re.compile(rf"({re.escape(begin)}[^>]*-->\n).*?({re.escape(end)})", re.DOTALL)
    if text.count(begin) != 1 or text.count(end) != 1 or not pattern.search(text):
        raise OutputError(
            str(readme), f"needs the lines '{begin} -->' and '{end}', once each, around the results"
        )
    return pattern.sub(lambda match: f"{match[1]}{content}{match[2]}", text)


def write(readme: str | Path, result: Record) -> list[Path]:
    """Write the results of the parts ("speed", "work_precision", ...) into README and separate
    files; return these.
    """
    text = check(readme)
    folder = Path(readme).parent / RESULTS_FOLDER
    measured = result["work_precision"]
    command = _command_text(result)
    make_folder(folder)
    about = f"Written by `{command}` ({sentence(measured['machine'])})."
    page = f"# Work and precision\n\n{about}\n\n{work.table(measured, markdown=True)}\n"
    files = [
        plot.save(work.figure(measured), folder / "work_precision.svg"),
        write_text(folder / "work_precision.md", page),
        *cases.write(folder / "scores.md", result["scores"], command),
        write_text(folder / "README.md", overview(result)),
    ]
    parts = [
        speed.brief(result["speed"]),
        _heyoka_sentence(measured["rows"]),
        f"[All calls, solvers, cases, and pictures]({RESULTS_FOLDER}/README.md).",
    ]
    brief = f"{_filled(' '.join(parts))}\n"
    return [write_text(readme, _replaced(text, brief, readme)), *files]


def comparison(result: Record) -> str:
    """Return the paragraph that compares symosc with heyoka, with looser accuracies and with its
    own error bound.
    """
    rows = result["work_precision"]["rows"]
    verdict = cases.our_verdict(result["scores"])
    return _filled(" ".join([_heyoka_sentence(rows), *_loose_sentences(rows), verdict]))


def overview(result: Record) -> str:
    """Return the first page of the results, an overview with links to all others, as Markdown."""
    measured = result["work_precision"]
    parts = [
        "# Results",
        f"Written by one run of `{_command_text(result)}`.",
        "## Speed and error",
        speed.measurement_note(result["speed"]),
        speed.table(result["speed"], "github"),
        comparison(result),
        "## Work and precision",
        _filled(
            f"Every solver follows the same scenes ({sentence(measured['machine'])}). Time is per "
            f"event, calls repeated, the first one apart; errors are {work.ERRORS}, against "
            f"{REFERENCE_DIGITS} digits."
        ),
        "![Error against time per event, one panel per scene, one curve per solver; symosc is the "
        "black star.](work_precision.svg)",
        _filled(
            "Each solver at the tolerance that served it best: its time as a multiple of ours, its "
            "error, and the events that it missed or invented. [All tolerances, and what "
            "precautions the solvers need](work_precision.md)."
        ),
        work.summary(measured),
        "## Hard cases",
        _filled(
            "In how many cases of a group a solver is right, and its largest error in those, in "
            "units of condition * 1e-16, which is what rounding the problem's numbers to doubles "
            "does. [What counts as right, and all cases](scores.md)."
        ),
        cases.hard_summary(result["scores"]),
    ]
    return "\n\n".join(parts) + "\n"


def _filled(text: str) -> str:
    """Return a paragraph in lines of at most 120 columns."""
    return fill(" ".join(text.split()), 120, break_long_words=False, break_on_hyphens=False)


def _heyoka_sentence(rows: list[Record]) -> str:
    """Return a sentence about heyoka at its finest tolerance; "" if it did not run."""
    finest: dict[str, str] = {}
    for row in rows:
        if row["solver"] == "heyoka" and row["over_ours"]:  # tolerances run from coarse to fine
            if row["over_ours"] < 1 and row["error"] is not None:
                error = f", error {row['error']:.0e}"
            else:
                error = ""
            finest[row["scene"]] = f"{work.rounded(row['over_ours'], 2)} ({row['scene']}{error})"
    ratios = ", ".join(finest.values())
    if finest:
        return f"heyoka at its finest tolerance takes {ratios} times as long as symosc."
    return ""


def _loose_sentences(rows: list[Record]) -> list[str]:
    """Return sentences about scenes on which a looser accuracy more than halves symosc's time."""
    ours: dict[str, list[Record]] = {}
    for row in rows:
        if row["solver"] == OURS[0].name and row["us_per_event"]:
            ours.setdefault(row["scene"], []).append(row)
    sentences = []
    for scene, by_accuracy in ours.items():
        loose = by_accuracy[0]
        fine = by_accuracy[-1]
        if loose["us_per_event"] < 0.5 * fine["us_per_event"]:
            less = work.rounded(loose["us_per_event"], 2)
            more = work.rounded(fine["us_per_event"], 2)
            sentences.append(
                f"{scene} takes {more} µs per event with an error of {fine['error']:.0e}, and with "
                f"`accuracy={loose['tolerance']:g}` {less} µs with {loose['error']:.0e}."
            )
    if not sentences:
        return []
    about = (
        f"When double precision cannot keep the error below {ACCURACY:g}, symosc switches to "
        "higher precision, which is slower:"
    )
    return [about, *sentences]


def _command_text(result: Record) -> str:
    """Return the command that writes the results."""
    if result["quick"]:
        return "symosc bench --quick --results README.md"
    return "symosc bench --results README.md"
