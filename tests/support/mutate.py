"""Mutation runs: small random faults are put into the source, one at a time, and the tests must find each.

    python tests/support/mutate.py --seed 1 --count 100 --packages engine mappings orbits grazing
    crosschecks

The faults go into a copy of the tree. For each, the tests run until the first failure, in three
rounds: the quick ones of its package, those of the packages that use it, and the slow ones of its
package. The seed numbers the mutants: `--numbers 3 17` runs these again, `--list` only shows them.
A survivor is equivalent, or shows a missing test. `--rounds 1` is fast; `--rounds 2 3 --numbers
...` is for its survivors.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import importlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import traceback
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
COPIED = (
    "symosc",
    "tests",
    "docs",
    "derivations",
    "pyproject.toml",
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
)
COPIED += ("CITATION.cff", "LICENSE", "noxfile.py", ".ci", ".pre-commit-config.yaml")
#: What takes long to import is imported once: each run of tests is a fork of this process.
LARGE = (
    "matplotlib.figure",
    "scipy.integrate",
    "scipy.optimize",
    "sympy",
    "mpmath",
    "numba",
    "pandas",
    "xarray",
)
LARGE += ("tabulate", "gmpy2", "flint")
COMPARED = {ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt)}
COMPARED |= {ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt)}
COMPARED |= {ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,)}
COMPARED |= {ast.In: (ast.NotIn,), ast.NotIn: (ast.In,)}
COMPUTED = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
}
COMPUTED |= {ast.FloorDiv: ast.Div, ast.Mod: ast.Mult}
SWAPPED = {"min": "max", "max": "min", "sin": "cos", "cos": "sin", "any": "all", "all": "any"}
#: Bytes that a run of tests may have.
MEMORY = 6 * 2**30


class Mutant(NamedTuple):
    """One fault: where it is, and what stands there instead."""

    path: str
    line: int
    kind: str
    before: str
    after: str
    span: tuple[int, int]


def changes(node: ast.AST, parents: list[ast.AST]) -> Iterator[tuple[str, str]]:
    """Yield (kind, new text) of the faults that a node can have."""
    match node:
        case ast.Compare(left, operators, others):
            for i, operator in enumerate(operators):
                for other in COMPARED[type(operator)]:
                    changed = [*operators[:i], other(), *operators[i + 1 :]]
                    yield "comparison", ast.unparse(ast.Compare(left, changed, others))
        case ast.BinOp(left, operator, right):
            if type(operator) in COMPUTED and not isinstance(left, (ast.JoinedStr, ast.List)):
                yield (
                    "arithmetic",
                    f"({ast.unparse(ast.BinOp(left, COMPUTED[type(operator)](), right))})",
                )
        case ast.UnaryOp(ast.USub() | ast.Not() as operator, operand):
            yield (
                "arithmetic" if isinstance(operator, ast.USub) else "negation",
                f"({ast.unparse(operand)})",
            )
        case ast.BoolOp(operator, values):
            if isinstance(operator, ast.And):
                other = ast.Or()
            else:
                other = ast.And()
            yield "negation", f"({ast.unparse(ast.BoolOp(other, values))})"
        case ast.Constant(bool(value)):
            yield "constant", str(not value)
        case ast.Constant(int(value) | float(value)):
            if any(isinstance(parent, ast.Subscript) for parent in parents[-2:]):
                kind = "index"
            else:
                kind = "constant"
            yield kind, repr(value + 1 if isinstance(value, int) else 2 * value or 1.0)
        case ast.Call(ast.Name(name), arguments, keywords) if name in SWAPPED:
            yield "call", ast.unparse(ast.Call(ast.Name(SWAPPED[name]), arguments, keywords))
    condition = isinstance(parents[-1], (ast.If, ast.While, ast.IfExp)) and parents[-1].test is node
    if condition and not isinstance(node, ast.Compare):
        yield "negation", f"(not ({ast.unparse(node)}))"
    match node:  # statements that can be left out so that the rest still has all its names
        case ast.Assign(targets) if all(
            isinstance(each, (ast.Attribute, ast.Subscript)) for each in targets
        ):
            yield "removed", "pass"
        case ast.Expr(value) if not isinstance(value, ast.Constant):
            yield "removed", "pass"
        case ast.Return(
            ast.Constant(value)
        ):  # what returns more than a constant would be missed by any caller
            yield "removed", "pass" if value is None else "return None"
        case ast.Return(None) | ast.AugAssign() | ast.Raise() | ast.Continue() | ast.Break():
            yield "removed", "pass"


def in_code(node: ast.AST, parents: list[ast.AST]) -> Iterator[tuple[ast.AST, list[ast.AST]]]:
    """Yield the nodes that do something, with those around them.

    No annotations, texts, imports, generic names.
    """
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.JoinedStr)):
        return
    if isinstance(node, ast.AnnAssign) and node.value is None:
        return
    if isinstance(node, ast.Call) and parents and isinstance(parents[-1], ast.Raise):
        return  # what an error says
    yield node, parents
    for name, value in ast.iter_fields(node):
        if name not in ("annotation", "returns", "decorator_list", "type_params", "bases"):
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from in_code(child, [*parents, node])


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Yield all faults of one file."""
    source = path.read_bytes()
    starts = [0, *accumulate(map(len, source.splitlines(keepends=True)))]
    for node, parents in in_code(ast.parse(source), []):
        if hasattr(node, "lineno") and parents:
            span = (
                starts[node.lineno - 1] + node.col_offset,
                starts[node.end_lineno - 1] + node.end_col_offset,
            )
            for kind, after in changes(node, parents):
                before = source[slice(*span)].decode()
                yield Mutant(str(path.relative_to(ROOT)), node.lineno, kind, before, after, span)


def chosen(packages: list[str], seed: int, count: int) -> list[Mutant]:
    """Return `count` mutants.

    A file at random, the longer the likelier, then a kind of fault, then one of it.
    """
    faults = list[dict[str, list[Mutant]]]()
    lengths = list[int]()
    for path in (
        path for package in packages for path in sorted((ROOT / "symosc" / package).rglob("*.py"))
    ):
        by_kind: dict[str, list[Mutant]] = {}
        for mutant in mutants_of(path):
            by_kind.setdefault(mutant.kind, []).append(mutant)
        if by_kind:
            faults += [by_kind]
        else:
            faults += []
        if by_kind:
            lengths += [len(path.read_text(encoding="utf-8").splitlines())]
        else:
            lengths += []
    rng = random.Random(seed)
    found = list[Mutant]()
    while len(found) < count:
        by_kind = rng.choices(faults, lengths)[0]
        mutant = rng.choice(by_kind[rng.choice(sorted(by_kind))])
        if mutant in found:
            found += []
        else:
            found += [mutant]
    return found


def test_files(path: str) -> list[list[str]]:
    """Return arguments of runs of pytest: quick tests of the package, of what uses it.

    Slow ones of the package.
    """
    package = Path(path).parts[1]
    own, above = (
        [f"tests/{each}" for each in names if (ROOT / "tests" / each).is_dir()]
        for names in ([package], users_of(package))
    )
    if own:
        own += ["tests/test_outputs.py"]
    else:
        own += []
    quick = "not slow and not compiled"
    slow = "(slow or compiled) and not campaign"
    # without files pytest would take all
    return [
        [*files, "-m", marked] if files else []
        for files, marked in ((own, quick), (above, quick), (own, slow))
    ]


def users_of(package: str) -> list[str]:
    """Return the packages that import one, directly or not, nearest first."""
    uses: dict[str, set[str]] = {}
    packages = [each.name for each in (ROOT / "symosc").iterdir() if each.is_dir()]
    for path in (ROOT / "symosc").rglob("*.py"):
        words = path.read_text(encoding="utf-8")
        here = path.relative_to(ROOT / "symosc").parts[0].removesuffix(".py")
        uses.setdefault(here, set()).update(
            name for name in packages if f"from symosc.{name}" in words
        )
    found = [package]
    for each in found:
        found += sorted(user for user in uses if each in uses[user] and user not in found)
    return found[1:]


def tested(arguments: list[str], copy: Path, limit: int) -> tuple[str, str]:
    """Run pytest in a fork of this process, which has the large libraries, and return a verdict and what failed."""
    output = copy.parent / "output"
    child = os.fork()
    if child == 0:
        code = 70
        try:
            stream = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(stream, 1)
            os.dup2(stream, 2)
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
            resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))  # what appends for ever
            signal.alarm(20 * limit)  # what waits for ever
            os.chdir(copy)
            os.environ.update(PYTHONPATH=str(copy), PYTHONDONTWRITEBYTECODE="")
            sys.dont_write_bytecode = False
            sys.path[0] = str(copy)
            code = pytest.main(
                ["-x", "-n", "0", "-p", "no:cacheprovider", "--tb=no", "--no-header", *arguments]
            )
        finally:
            traceback.print_exc()
            os._exit(code)
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        return "timeout", f"signal {os.WTERMSIG(status)}"
    if os.WEXITSTATUS(status) in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
        return "survived", ""
    text = output.read_text(encoding="utf-8", errors="replace")
    failed = [line[:160] for line in text.splitlines() if line.startswith(("FAILED", "ERROR"))]
    assert failed, text  # else no test did, but the run itself
    return "killed", failed[0]


def tried(mutant: Mutant, copy: Path, limit: int, rounds: list[int]) -> tuple[str, str]:
    """Return "killed", "timeout" or "survived", and what killed it."""
    path = copy / mutant.path
    whole = path.read_bytes()
    times = path.stat()
    path.write_bytes(whole[: mutant.span[0]] + mutant.after.encode() + whole[mutant.span[1] :])
    try:
        for number in rounds:
            if arguments := test_files(mutant.path)[number - 1]:
                verdict, by = tested(arguments, copy, limit if number < 2 else 5 * limit)
                if verdict == "killed" or (
                    verdict == "timeout" and number < 2
                ):  # these are known to end
                    return verdict, by
    finally:
        path.write_bytes(whole)
        os.utime(
            path, ns=(times.st_atime_ns, times.st_mtime_ns)
        )  # numba keeps what it compiled from it
    return "survived", ""


def main() -> None:
    """Make mutants, try each, and say how many were found."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument(
        "--packages", nargs="+", default=["mappings", "orbits", "grazing", "crosschecks", "engine"]
    )
    parser.add_argument("--numbers", nargs="+", type=int, help="only these")
    rounds = "quick tests of 1 the package, 2 its users; 3 slow ones"
    parser.add_argument("--rounds", type=int, nargs="+", default=[1, 2, 3], help=rounds)
    parser.add_argument(
        "--limit",
        type=int,
        default=60,
        help="seconds of processor time for one of the first rounds",
    )
    parser.add_argument(
        "--sound", action="store_true", help="the tests are known to pass without a fault"
    )
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--log", type=Path, help="a file to which results are added, line by line")
    options = parser.parse_args()

    every = list(enumerate(chosen(options.packages, options.seed, options.count)))
    if options.numbers:
        mutants = [every[number] for number in options.numbers]
    else:
        mutants = every
    texts = [
        f"{n} {each.path}:{each.line} {each.kind}: {each.before!r} -> {each.after!r}"
        for n, each in mutants
    ]
    if options.list:
        print(*texts, sep="\n")
        return
    for name in LARGE:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    counts = {"killed": 0, "timeout": 0, "survived": 0}
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        copy.mkdir()
        for name in COPIED:
            (shutil.copytree if (ROOT / name).is_dir() else shutil.copy2)(ROOT / name, copy / name)
        for package in (
            () if options.sound else sorted({Path(mutant.path).parts[1] for _, mutant in mutants})
        ):
            found = tested(test_files(f"symosc/{package}/")[0], copy, options.limit)
            assert found == ("survived", ""), (
                f"the tests of {package} fail without a fault: {found}"
            )
        for (number, mutant), where in zip(mutants, texts, strict=True):
            verdict, by = tried(mutant, copy, options.limit, options.rounds)
            counts[verdict] += 1
            print(f"{verdict} {where}  {by}", flush=True)
            if options.log:
                with options.log.open("a", encoding="utf-8") as log:
                    log.write(json.dumps([number, verdict, by, *mutant[:5]]) + "\n")
    print(counts)


if __name__ == "__main__":
    main()
