"""Mutation runs: small random faults are put into the source, one at a time, and the tests must find each.

    python tests/support/mutate.py --seed 1 --count 100 --packages engine mappings orbits grazing crosschecks

The faults go into a copy of the tree. For each, the tests run until the first failure, in three rounds: the quick ones
of its package, those of the packages that use it, and the slow ones of its package. The seed numbers the mutants:
`--numbers 3 17` runs these again, `--list` only shows them. A survivor is equivalent, or shows a missing test.
`--rounds 1` is fast; `--rounds 2 3 --numbers ...` is for its survivors.
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
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
COPIED = ("symosc", "tests", "docs", "derivations", "pyproject.toml", "README.md", "CHANGELOG.md", "CONTRIBUTING.md")
COPIED += ("CITATION.cff", "LICENSE", "noxfile.py", ".ci", ".pre-commit-config.yaml")
#: What takes long to import is imported once: each run of tests is a fork of this process.
LARGE = ("matplotlib.figure", "scipy.integrate", "scipy.optimize", "sympy", "mpmath", "numba", "pandas", "xarray")
LARGE += ("tabulate", "gmpy2", "flint")
COMPARED = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
COMPUTED = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}
COMPUTED |= {ast.FloorDiv: ast.Div, ast.Mod: ast.Mult}
SWAPPED = {"min": "max", "max": "min", "sin": "cos", "cos": "sin", "any": "all", "all": "any"}


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
    if isinstance(node, ast.Compare):
        for i, operator in enumerate(node.ops):
            for other in COMPARED[type(operator)]:
                yield (
                    "comparison",
                    ast.unparse(ast.Compare(node.left, [*node.ops[:i], other(), *node.ops[i + 1 :]], node.comparators)),
                )
    elif (
        isinstance(node, ast.BinOp)
        and type(node.op) in COMPUTED
        and not isinstance(node.left, (ast.JoinedStr, ast.List))
    ):
        yield "arithmetic", f"({ast.unparse(ast.BinOp(node.left, COMPUTED[type(node.op)](), node.right))})"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not)):
        yield "arithmetic" if isinstance(node.op, ast.USub) else "negation", f"({ast.unparse(node.operand)})"
    elif isinstance(node, ast.BoolOp):
        other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        yield "negation", f"({ast.unparse(ast.BoolOp(other, node.values))})"
    elif isinstance(node, (ast.If, ast.While, ast.IfExp)):
        return
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield "constant", str(not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        kind = "index" if any(isinstance(parent, ast.Subscript) for parent in parents[-2:]) else "constant"
        yield kind, repr(node.value + 1 if isinstance(node.value, int) else 2 * node.value or 1.0)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in SWAPPED:
        yield "call", ast.unparse(ast.Call(ast.Name(SWAPPED[node.func.id]), node.args, node.keywords))


def is_condition(node: ast.AST, parent: ast.AST) -> bool:
    return isinstance(parent, (ast.If, ast.While, ast.IfExp)) and parent.test is node


def is_removable(node: ast.AST) -> bool:
    """Say whether a statement can be left out so that the rest still has all its names."""
    if isinstance(node, ast.Assign):
        return all(isinstance(target, (ast.Attribute, ast.Subscript)) for target in node.targets)
    if isinstance(node, ast.Expr):
        return not isinstance(node.value, ast.Constant)
    if isinstance(node, ast.Return):  # what returns more than a constant would be missed by any caller
        return node.value is None or isinstance(node.value, ast.Constant)
    return isinstance(node, (ast.AugAssign, ast.Raise, ast.Continue, ast.Break))


def in_code(node: ast.AST, parents: list[ast.AST], tree: ast.Module) -> Iterator[tuple[ast.AST, list[ast.AST]]]:
    """Yield the nodes that do something, with those around them: no annotations, texts, imports, generic names."""
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.JoinedStr, ast.AnnAssign)) and not getattr(
        node, "value", None
    ):
        return
    if isinstance(node, ast.Call) and isinstance(parents[-1] if parents else None, ast.Raise):
        return  # what an error says
    yield node, parents
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "type_params", "bases") or isinstance(
            node, ast.JoinedStr
        ):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from in_code(child, [*parents, node], tree)


def mutants_of(path: Path) -> Iterator[Mutant]:
    """Yield all faults of one file."""
    source = path.read_text(encoding="utf-8")
    starts = [0]
    for line in source.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tree = ast.parse(source)
    for node, parents in in_code(tree, [], tree):
        if not hasattr(node, "lineno") or not parents:
            continue
        span = starts[node.lineno - 1] + node.col_offset, starts[node.end_lineno - 1] + node.end_col_offset
        found = list(changes(node, parents))
        if is_condition(node, parents[-1]) and not isinstance(node, ast.Compare):
            found.append(("negation", f"(not ({ast.unparse(node)}))"))
        if is_removable(node):
            known = (
                isinstance(node, ast.Return) and isinstance(node.value, ast.Constant) and node.value.value is not None
            )
            found.append(("removed", "return None" if known else "pass"))
        before = source.encode()[span[0] : span[1]].decode()
        for kind, after in found:
            yield Mutant(str(path.relative_to(ROOT)), node.lineno, kind, before, after, span)


def chosen(packages: list[str], seed: int, count: int) -> list[Mutant]:
    """Return `count` mutants: a file at random, the longer the likelier, then a kind of fault, then one of it."""
    faults: list[dict[str, list[Mutant]]] = []
    lengths: list[int] = []
    for package in packages:
        for path in sorted((ROOT / "symosc" / package).rglob("*.py")):
            by_kind: dict[str, list[Mutant]] = {}
            for mutant in mutants_of(path):
                by_kind.setdefault(mutant.kind, []).append(mutant)
            if by_kind:
                faults.append(by_kind)
                lengths.append(len(path.read_text(encoding="utf-8").splitlines()))
    rng, found = random.Random(seed), []
    while len(found) < count:
        by_kind = rng.choices(faults, lengths)[0]
        mutant = rng.choice(by_kind[rng.choice(sorted(by_kind))])
        if mutant not in found:
            found.append(mutant)
    return found


def test_files(path: str) -> list[list[str]]:
    """Return arguments of runs of pytest: quick tests of the package, of what uses it; slow ones of the package."""
    package = Path(path).parts[1]
    own = [f"tests/{package}"] if (ROOT / "tests" / package).is_dir() else []
    above = [f"tests/{user}" for user in users_of(package) if (ROOT / "tests" / user).is_dir()]
    quick, slow = "not slow and not compiled", "(slow or compiled) and not campaign"
    rounds = [[*own, "-m", quick], [*above, "-m", quick], [*own, "-m", slow]]
    return [each if len(each) > 2 else [] for each in rounds]  # without files pytest would take all


def users_of(package: str) -> list[str]:
    """Return the packages that import one, directly or not, nearest first."""
    uses: dict[str, set[str]] = {}
    for path in (ROOT / "symosc").rglob("*.py"):
        words = path.read_text(encoding="utf-8")
        here = path.relative_to(ROOT / "symosc").parts[0].removesuffix(".py")
        packages = (each.name for each in (ROOT / "symosc").iterdir() if each.is_dir())
        uses.setdefault(here, set()).update(name for name in packages if f"from symosc.{name}" in words)
    found = [package]
    for each in found:
        found += sorted(user for user in uses if each in uses[user] and user not in found)
    return found[1:]


#: Bytes that a run of tests may have.
MEMORY = 6 * 2**30


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
            code = pytest.main(["-x", "-n", "0", "-p", "no:cacheprovider", "--tb=no", "--no-header", *arguments])
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
    whole, times = path.read_bytes(), path.stat()
    path.write_bytes(whole[: mutant.span[0]] + mutant.after.encode() + whole[mutant.span[1] :])
    try:
        for number in rounds:
            if arguments := test_files(mutant.path)[number - 1]:
                verdict, by = tested(arguments, copy, limit if number < 2 else 5 * limit)
                if verdict == "killed" or (verdict == "timeout" and number < 2):  # these are known to end
                    return verdict, by
    finally:
        path.write_bytes(whole)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))  # numba keeps what it compiled from it
    return "survived", ""


def main() -> None:
    """Make mutants, try each, and say how many were found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--packages", nargs="+", default=["mappings", "orbits", "grazing", "crosschecks", "engine"])
    parser.add_argument("--numbers", nargs="+", type=int, help="only these")
    parser.add_argument(
        "--rounds",
        type=int,
        nargs="+",
        default=[1, 2, 3],
        help="quick tests of 1 the package, 2 its users; 3 slow ones",
    )
    parser.add_argument("--limit", type=int, default=60, help="seconds of processor time for one of the first rounds")
    parser.add_argument("--sound", action="store_true", help="the tests are known to pass without a fault")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--log", type=Path, help="a file to which results are added, line by line")
    options = parser.parse_args()

    mutants = chosen(options.packages, options.seed, options.count)
    numbers = options.numbers or range(len(mutants))
    counts = {"killed": 0, "timeout": 0, "survived": 0}
    for name in LARGE if not options.list else ():
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        copy.mkdir()
        for name in COPIED if not options.list else ():
            source = ROOT / name
            (shutil.copytree if source.is_dir() else shutil.copy2)(source, copy / name)
        for package in (
            [] if options.list or options.sound else sorted({Path(mutants[number].path).parts[1] for number in numbers})
        ):
            found = tested(test_files(f"symosc/{package}/")[0], copy, options.limit)
            assert found == ("survived", ""), f"the tests of {package} fail without a fault: {found}"
        for number in numbers:
            mutant = mutants[number]
            where = f"{number} {mutant.path}:{mutant.line} {mutant.kind}: {mutant.before!r} -> {mutant.after!r}"
            if options.list:
                print(where)
                continue
            verdict, by = tried(mutant, copy, options.limit, options.rounds)
            counts[verdict] += 1
            print(f"{verdict} {where}  {by}", flush=True)
            if options.log:
                with options.log.open("a", encoding="utf-8") as log:
                    log.write(json.dumps([number, verdict, by, *mutant[:5]]) + "\n")
    if not options.list:
        print(counts)


if __name__ == "__main__":
    main()
