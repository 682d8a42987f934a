"""Tests mirror the source: each module is tested by a file of its name, or stands below with what tests it and why."""

from __future__ import annotations

import re
from pathlib import Path

import symosc

TESTS, ROOT = Path(__file__).parent, Path(symosc.__file__).parent

CHAPTERS = "a chapter is steps, each with a check of its own; one test runs the checks and breaks the signs of all"
FRAGMENTS = "a fragment is made of all of them; what is printed is checked and compiled"
CHECKS = "a check is what a claim names; its verdict is compared for all claims, and turned by other motions"
SOLVERS = "the adapters of other people's solvers have to pass the same tests"
ENGINE = "its numbers are those that the event search returns, at every event"
SAME = "one formula in another arithmetic: it must give the same numbers, which one test compares"
QUERIES = "a step of solve_grazing, whose answers are judged by the flow"
PICTURES = "it draws; what is drawn is looked up in the finished pictures"
COMMAND = "the command has options of its own subject, and is tested with it"
ONE_FOR_ALL = "the pages of all answers have to pass the same tests"
CASES = "its cases are part of the set, and their closed forms are evaluated there"
PAPER = "what it makes is a part of the report, and is looked at there"

#: Modules without a test file of their name: where their tests are, and why there.
ELSEWHERE: dict[str, tuple[str, str]] = {
    "bench.formulas": ("bench/test_speed.py", "it only measures; what is printed of it is tested"),
    "bench.digits": ("cli/test_bench.py", "it only measures; what is printed of it is tested"),
    "bench.ensembles": ("cli/test_bench.py", "it only measures; what is printed of it is tested"),
    "bench.peers_heyoka_batch": ("cli/test_bench.py", "it only counts; the count is beside ours in what is printed"),
    "bench.hard_table": ("bench/test_hard.py", "the table is that of the run"),
    "bench.ours": ("bench/test_hard.py", "our own solver, whose errors are tested there"),
    "bench.peers_cvode": ("bench/test_peers_scipy.py", SOLVERS),
    "bench.peers_numba": ("bench/test_peers_heyoka.py", SOLVERS),
    "bench.peers_scan": ("bench/test_peers_heyoka.py", SOLVERS),
    "bench.plot_error_map": ("bench/test_error_map.py", PICTURES),
    "bench.plot_work": ("bench/test_work_precision.py", PICTURES),
    "bench.scalar_logic": ("bench/test_peers_heyoka.py", SOLVERS),
    "bench.solvers": ("bench/test_peers_scipy.py", SOLVERS),
    "reference.grazes": ("reference/test_sets.py", CASES),
    "reference.rests": ("reference/test_sets.py", CASES),
    "reference.coulomb": ("reference/test_sets.py", CASES),
    "reference.score_table": ("reference/test_score.py", "the tables are those of the scores"),
    "reference.stored": ("reference/test_folder.py", "it reads what is written there"),
    "bench.work_table": ("bench/test_work_precision.py", "the table is that of the run"),
    "engine.first_rows": ("simulation/test_problems.py", "its rows are compared with starts that are made one by one"),
    "engine.settled": ("simulation/test_summary.py", "what repeats there does so in the sampled trajectory"),
    "engine.tally": ("simulation/test_summary.py", "what it counts is compared with trajectories there"),
    "simulation.chunks": ("simulation/test_summary.py", "a chunk is what summaries and tables are made of"),
    "simulation.event_table": ("simulation/test_ensemble.py", "the table is what simulate_many returns"),
    "certificates.closing": ("certificates/test_orbit.py", "its root is the orbit whose digits are compared there"),
    "certificates.collect": ("certificates/test_orbit_list.py", "it makes the list, which is compared"),
    "certificates.ends": ("certificates/test_branch.py", "an end is part of a branch"),
    "certificates.family": ("certificates/test_branch.py", "what it proves are the boxes of a branch"),
    "certificates.certificate": ("certificates/test_certify.py", "it is what certify hands over"),
    "crosschecks.causes": ("crosschecks/test_diagnosis.py", "it is the list of names that diagnoses have"),
    "crosschecks.clues": ("crosschecks/test_other_models.py", "what it fits and follows are those models"),
    "cli.app": ("cli/test_errors.py", "what all commands share is how they end"),
    "cli.derive": ("derive/test_document.py", COMMAND),
    "cli.orbit": ("orbits/test_continuation.py", COMMAND),
    "cli.reproduce": ("paper/test_run.py", COMMAND),
    "cli.verify": ("cli/test_certify.py", "it proves what symosc certify writes"),
    "display.drawable": ("plot/test_drawing.py", "it is what .plot() of every answer calls"),
    "display.terminal": ("cli/test_terminal.py", "its tables are looked at on a real terminal"),
    "plot.notebooks.judged": ("plot/notebooks/test_pages.py", ONE_FOR_ALL),
    "plot.notebooks.motions": ("plot/notebooks/test_pages.py", ONE_FOR_ALL),
    "plot.notebooks.structures": ("plot/notebooks/test_pages.py", ONE_FOR_ALL),
    "scenes.quantities": ("scenes/test_units.py", "each quantity is converted there"),
    "scenes.writing": ("scenes/test_reading.py", "what it writes is read back there"),
    "plot": ("plot/notebooks/test_pages.py", "its names for completion are looked at with those of all answers"),
    "derive.chapters.*": ("derive/test_document.py", CHAPTERS),
    "derive.blocks": ("derive/test_document.py", "theorems and tables are seen in the finished chapters"),
    "derive.displays": ("derive/test_document.py", "its rows are measured and read back there"),
    "derive.figures": ("derive/test_html.py", "it draws; the pages have its pictures"),
    "derive.fragment_pages": ("derive/test_fragments.py", FRAGMENTS),
    "derive.fragment_parts": ("derive/test_fragments.py", FRAGMENTS),
    "derive.fragment_scope": ("derive/test_fragments.py", FRAGMENTS),
    "derive.front": ("derive/test_document.py", "the document that it begins is compared and compiled"),
    "derive.latex_pages": ("derive/test_document.py", "each chapter is compared with the committed one"),
    "derive.literature_motions": ("derive/test_document.py", CHAPTERS),
    "derive.literature_pieces": ("derive/test_document.py", "its tables are steps, each with a check"),
    "derive.mathml": ("derive/test_html.py", "no rest of LaTeX is in the pages"),
    "derive.mutations": ("derive/test_document.py", "it breaks the signs there"),
    "derive.orbit_pieces": ("derive/test_document.py", "what it finds are steps, each with a check"),
    "derive.settled_pieces": ("derive/test_document.py", CHAPTERS),
    "derive.paper_form": ("derive/test_fragments.py", "it is compared with the motion in each regime"),
    "derive.pdf": ("derive/test_document.py", "the document is compiled there"),
    "derive.text_pages": ("derive/test_html.py", "text and Markdown are read beside the HTML"),
    "derive.window_check": ("derive/test_document.py", "broken windows of the chapter on grazing have to fail"),
    "derive.comparisons": ("derive/test_published.py", "its values are those that are compared there"),
    "derive.latex": ("derive/test_document.py", "what is printed is read back there, formula by formula"),
    "derive.line_breaks": ("derive/test_document.py", "lines are measured in the finished chapters"),
    "derive.scope": ("derive/test_document.py", "what a scene leaves out is seen in the finished chapters"),
    "derive.steps": ("derive/test_document.py", CHAPTERS),
    "engine.arithmetic": ("engine/test_binding.py", ENGINE),
    "engine.mpfr_arithmetic": ("engine/test_mpfr.py", SAME),
    "engine.pair_loop": ("simulation/test_ladder.py", SAME),
    "engine.pairs": ("simulation/test_ladder.py", SAME),
    "engine.paths": ("engine/test_mpfr.py", SAME),
    "engine.rounding": ("simulation/test_ladder.py", "a step of the ladder, whose events are compared there"),
    "kernels._generated": ("symbolic/test_codegen.py", "generated; compared with what generates it"),
    "kernels.entire_array": ("kernels/test_entire.py", SAME),
    "kernels.entire_branchless": ("mappings/test_compiled.py", SAME),
    "kernels.entire_mp": ("kernels/test_entire.py", SAME),
    "kernels.mapping": ("mappings/test_equations.py", SAME),
    "kernels.mapping_loops": ("mappings/test_compiled.py", SAME),
    "kernels.mpfr": ("engine/test_mpfr.py", SAME),
    "kernels.pair_type": ("kernels/test_pair_functions.py", "its operators are those of the functions tested there"),
    "kernels.repeated": ("mappings/test_equations.py", SAME),
    "paper.checks.*": ("paper/test_theory.py", CHECKS),
    "paper.captions": ("paper/test_pictures.py", PICTURES),
    "paper.drawings": ("paper/test_theory.py", PICTURES),
    "paper.oscillator": ("paper/test_theory.py", PICTURES),
    "paper.paper_figures": ("paper/test_pictures.py", PICTURES),
    "paper.views": ("paper/test_pictures.py", PICTURES),
    "paper.window_figures": ("paper/test_theory.py", PICTURES),
    "paper.evidence": ("paper/test_figures_claims.py", "a record that the checks return"),
    "paper.report": ("paper/test_run.py", PAPER),
    "plot.explorer.pictures": ("plot/explorer/test_page.py", "it draws; what is drawn is looked up in the browser"),
    "plot.columns": ("plot/test_maps.py", "labels and axes are looked up in the finished maps"),
    "plot.insets": ("plot/test_figures.py", PICTURES),
    "plot.sweep": ("plot/test_windows.py", PICTURES),
    "plot.curve": ("grazing/test_curve.py", PICTURES),
    "symbolic.arithmetic_printer": ("symbolic/test_codegen.py", "the kernels are printed with it, and compared there"),
    "symbolic.export_program": ("symbolic/test_export.py", "a part of each exported program, which is run"),
    "symbolic.grazing_regions": ("symbolic/test_grazing_answers.py", "a region is an answer like the others"),
    "symbolic.phase_interval": ("symbolic/test_grazing_answers.py", "intervals are asked about there"),
    "symbolic.languages": ("symbolic/test_export.py", "every language is run, or read, there"),
    "crosschecks.given": ("crosschecks/test_objects.py", "what is given there goes through it"),
    "crosschecks.tables": ("crosschecks/test_objects.py", "tables are objects of other packages, made there"),
    "simulation.run": ("simulation/test_simulate.py", "the inner loop of simulate"),
    "simulation.warm": ("cli/test_warm.py", COMMAND),
}


def modules() -> list[str]:
    """Return the modules that say more than what they import."""
    found = []
    for path in sorted(ROOT.rglob("*.py")):
        if re.search("^(def|class) ", path.read_text(encoding="utf-8"), re.MULTILINE) and path.stem != "__main__":
            found.append(".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"))
    return found


def own_file(module: str) -> Path:
    *packages, name = module.split(".")
    return TESTS.joinpath(*packages, f"test_{name}.py")


def elsewhere(module: str) -> str | None:
    """Return the line of ELSEWHERE that speaks of a module."""
    parent = module.rpartition(".")[0]
    return module if module in ELSEWHERE else f"{parent}.*" if f"{parent}.*" in ELSEWHERE else None


def test_a_module_is_tested_by_a_file_of_its_name() -> None:
    wrong = []
    for module in modules():
        has_file, line = own_file(module).is_file(), elsewhere(module)
        if not (has_file or line):
            wrong.append(f"write {own_file(module).relative_to(TESTS.parent)}")
        if has_file and line:
            wrong.append(f"{module} has a file of its own now: take it from ELSEWHERE")
    assert wrong == []


def test_files_that_stand_in_are_there() -> None:
    lines = {elsewhere(module) for module in modules()}
    assert set(ELSEWHERE) == lines - {None}, "ELSEWHERE names what is no module"
    for file, reason in ELSEWHERE.values():
        assert (TESTS / file).is_file(), file
        assert len(reason) > 10
