"""Export of a word's residual and Jacobian as standalone source, for programs without symosc.

The library's scalar kernels are read as syntax trees, what the word does not need is left out, and the rest is printed
in another language: assignments (also of tuples), if, for over a range, break, return, arithmetic, comparisons, calls.
With fixed parameters their constants become numbers, and the branches that these decide are cut. All values are real
numbers, except for flags and loop counters.

A word of n mappings has n + 1 switching points z = (x_0, theta_0, ..., x_n, theta_n), phases unwrapped, in order of
time. `residual` returns f1, f2 of each mapping, 2 n numbers; `jacobian` for each mapping the derivatives of its f1 and
f2 with respect to its (x_i, theta_i, x_j, theta_j), n x 2 x 4 numbers.
"""

from __future__ import annotations

import ast
import inspect
import keyword
import re
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from os.path import isdir, isfile
from pathlib import Path
from typing import Any

from symosc.aliases import Record
from symosc.errors import OutputError, ParameterError
from symosc.files import read_path, write_text
from symosc.model import NEIGHBOURS, PARAMETER_NAMES, Parameters
from symosc.scenes import load_scene
from symosc.words import Map, Word, WordLike, read_word

#: Languages that a mapping structure can be written in.
LANGUAGES = ("python", "numpy", "c", "julia")
EXPORT_WIDTH = 112
MATH = ("cos", "exp", "expm1", "sin", "sqrt")
#: What the Jacobian of a mapping's function adds to its name. It returns two rows.
MATRIX = "_jacobian"

_PYTHON = frozenset(keyword.kwlist) | frozenset(keyword.softkwlist) | sys.stdlib_module_names | {"numpy"}
_C_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long register
restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
"""
_C_HEADERS = """
assert complex ctype errno fenv inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef stdint stdio
stdlib string tgmath time wchar wctype
"""
_JULIA = """
abstract baremodule begin break catch const continue do else elseif end export false finally for function global if
import in isa let local macro module mutable outer primitive public quote return struct true try type using where while
Base Core Main
"""
#: Names that a file cannot have: words of the language, and what the source or the compiler would find in its place.
RESERVED = {
    "python": _PYTHON,
    "numpy": _PYTHON,
    "c": frozenset((_C_WORDS + _C_HEADERS).split()),
    "julia": frozenset(_JULIA.split()),
}


def export(
    word: WordLike, language: str = "python", fix: Parameters | None = None, name: str | None = None
) -> dict[str, str]:
    """Return the source files of a word's residual and Jacobian, text by file name."""
    # `language` is "python" (math, floats), "numpy" (arrays), "c" (C99, with a header) or "julia"; `fix` folds
    # parameters in, else the functions take what `constants` computes; the word need not close. `name` begins file
    # names and, in C and Julia, names (None: the word in small letters); a Julia module has it with a capital, and
    # "Map" behind if the source has a function of that name: P2Map. WordError or ParameterError for arguments that make
    # no program.
    if not isinstance(language, str) or language not in LANGUAGES:
        raise ParameterError("language", language, f"must be one of {', '.join(LANGUAGES)}")
    if fix is not None and not isinstance(fix, Parameters):
        raise ParameterError("fix", fix, "must be Parameters or None; a scene has them as scene.parameters")
    read = read_word(word, closed=False)
    name = str(read).lower() if name is None else name
    if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise ParameterError("name", name, "must be letters (a to z), digits and underscores, a letter first")
    if name in RESERVED[language]:
        raise ParameterError("name", name, f"is a word or a library of the language {language}; choose another")
    made = program(read, language == "numpy", fix)
    if language == "c":
        return _c(made, name)
    if language == "julia":
        return {f"{name}.jl": _julia(made, name)}
    return {f"{name}.py": _python(made, language == "numpy")}


def write_export(folder: str | Path, *arguments: Any, force: bool = False, **options: Any) -> list[Path]:
    """Write the files of `export` to a folder, which is made if needed, and return their paths."""
    # OutputError if a file cannot be written, or, without `force`, is there with another content.
    folder = read_path(folder)
    texts = {Path(folder) / name: text for name, text in export(*arguments, **options).items()}
    for path, text in texts.items():  # before the first of them is written
        if isdir(path):
            raise OutputError(str(path), "is a folder")
        if not force and isfile(path) and not _holds(path, text):
            raise OutputError(str(path), "is there with another content; give another name, or force it")
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(str(folder), error.strerror or str(error)) from None
    return [write_text(path, text) for path, text in texts.items()]


def _holds(path: Path, text: str) -> bool:
    """Return whether a file has this text."""
    try:
        return path.read_bytes() == text.encode()
    except OSError as error:
        raise OutputError(str(path), error.strerror or str(error)) from None


# --- what a word needs of the kernels ---

SETTINGS = ("EPS", "SERIES_BELOW", "APART_ABOVE", "TERMS")
FLAGS = ("under", "apart")

#: `symosc.engine.flow.constants` in double precision, in the syntax that can be printed; APART is that of `flow`.
SETUP = """
h = c / (2.0 * m)
w0sq = k / m
square = w0sq - h * h
under = square > 0.0
omega_d = sqrt(abs(square))
w0 = sqrt(w0sq)
l2 = -(h + omega_d)
l1 = w0sq / l2 if l2 != 0.0 else 0.0
rate0 = w0 if under else -l2
rate = rate0 if rate0 > Omega else Omega
p = w0sq - Omega * Omega
q = 2.0 * h * Omega
larger = w0sq if w0sq > Omega * Omega else Omega * Omega
apart = under and p * p + q * q >= APART * larger * larger
detuning = (square - Omega * Omega) / (omega_d + Omega) if under else -Omega
cm = 2.0 * h
f0 = B0 / m
Om = Omega
A1 = (A0 + (mu1 + mu2) * FN) / m
A2 = (A0 + (mu2 - mu1) * FN) / m
A3 = (A0 - (mu1 + mu2) * FN) / m
"""

#: What the functions for arrays need besides.
FLAT = '''
def flat(*given):
    """Return numbers or arrays as flat arrays of one length, and the shape that they have together."""
    columns = np.broadcast_arrays(*(np.asarray(column, dtype=float) for column in given))
    return [column.ravel() for column in columns], columns[0].shape
'''


@dataclass(frozen=True)
class _Program:
    """The functions and constants to be printed."""

    word: Word
    functions: dict[str, ast.FunctionDef]  # each after those that it calls
    maps: list[
        str
    ]  # functions of the word's mappings in order of time: "P2", "P4_above"; their Jacobians end in MATRIX
    fields: list[str]  # names of the constants that are used
    values: Record | None  # their values, if the parameters are fixed
    settings: dict[str, float]  # thresholds that the kernels use
    parameters: Parameters | None  # the fixed ones

    def returns(self) -> dict[str, int]:
        """Return the number of results of each function."""
        found: dict[str, int] = {}
        for name, node in self.functions.items():
            value = next(leaf.value for leaf in ast.walk(node) if isinstance(leaf, ast.Return))
            if isinstance(value, ast.Tuple):
                found[name] = len(value.elts)
            elif isinstance(value, ast.Call) and isinstance(value.func, ast.Name):
                found[name] = found.get(value.func.id, 1)
            else:
                found[name] = 1
        return found

    @property
    def passed(self) -> list[str]:
        """The argument with the constants, unless they are fixed."""
        return ["K"] if self.values is None else []

    def numbers(self) -> dict[str, float]:
        """Return the named numbers at the beginning of the source."""
        return self.settings | {f"K_{name}": value for name, value in (self.values or {}).items()}

    def calls(self, first: int) -> list[tuple[str, str, str]]:
        """Return for each mapping of the word its function, and its arguments in z, also for the Jacobian."""
        found = []
        for n, label in enumerate(self.maps):
            z = {name: f"z[{2 * n + i + first}]" for i, name in enumerate(("x_i", "theta_i", "x_j", "theta_j"))}
            needs = [argument.arg for argument in self.functions[label + MATRIX].args.args]
            few = [z[need] for need in needs if need != "K"]
            found.append((label, ", ".join([*z.values(), *self.passed]), ", ".join([*few, *self.passed])))
        return found

    def setup(self) -> list[ast.Assign]:
        """Return the assignments that compute the fields from the parameters."""
        needed, kept = set(self.fields), []
        for name, node in reversed(_setup_steps().items()):
            if name in needed:
                kept.append(node)
                needed |= _names(node.value)
        return kept[::-1]


def _setup_steps() -> dict[str, ast.Assign]:
    """Return the assignments of SETUP by the name that each defines."""
    from symosc.engine.flow import APART

    source = SETUP.replace("APART", repr(float(APART**2)))
    return {ast.unparse(node.targets[0]): node for node in ast.parse(source).body if isinstance(node, ast.Assign)}


def program(word: Word, arrays: bool, fix: Parameters | None) -> _Program:
    """Collect the functions that a word needs; for numpy arrays or for numbers, with or without fixed parameters."""
    from symosc.engine.flow import constants  # late: `symosc codegen --help` needs none of these
    from symosc.kernels import _generated, entire, entire_array, mapping

    K = constants(fix) if fix else None
    known = {} if K is None else {f"K.{flag}": getattr(K, flag) for flag in FLAGS}
    if K is not None and K.rate0 == K.rate:
        known["K.rate0 * tau < SERIES_BELOW"] = False  # where it is asked, rate * tau is not
        known["slow.any()"] = False
    if K is not None and K.apart and K.w0 == K.rate:
        known["K.w0 * tau >= APART_ABOVE"], known["rest.any()"] = True, False
    modules = [_generated, entire_array if arrays else entire, mapping]
    fold = _Fold(known, fixed=K is not None)
    trees = [_functions(inspect.getsource(module)) for module in modules]
    library = {name: fold.function(node) for tree in trees for name, node in tree.items()}
    maps: list[str] = []
    wanted: dict[str, str] = {}
    for row, exit in zip(word.maps, word.exits(), strict=True):
        for each in [exit] if exit or not row.sticks else ["below", "above"]:
            label, source = _map_source(row, each, arrays)
            wanted[label] = wanted[label + MATRIX] = source
            maps.append(label)
    if word.maps[-1].sticks and word.exits()[-1] is None:
        maps.pop()  # the word's own functions take the exit below; the other one is there to be called
    for source in wanted.values():
        library |= {name: fold.function(node) for name, node in _functions(source).items()}
    if arrays:
        library |= _functions(FLAT)
    functions: dict[str, ast.FunctionDef] = {}
    for label in wanted:
        _add(label, library, functions)
    leaves = [leaf for node in functions.values() for leaf in ast.walk(node)]
    used = {leaf.attr for leaf in leaves if isinstance(leaf, ast.Attribute) and _is_K(leaf.value)}
    used |= {leaf.id[2:] for leaf in leaves if isinstance(leaf, ast.Name) and leaf.id.startswith("K_")}
    named = {leaf.id for leaf in leaves if isinstance(leaf, ast.Name)}
    thresholds = vars(entire) | vars(entire_array)
    settings = {name: thresholds[name] for name in SETTINGS if name in named}
    fields = [name for name in (*_setup_steps(), "v1", "v2") if name in used]
    values = None
    if K is not None:
        of_belts = {"v1": K.belt1.v, "v2": K.belt2.v}
        values = {name: of_belts[name] if name in of_belts else getattr(K, name) for name in fields}
    return _Program(word, functions, maps, fields, values, settings, fix)


def _is_K(node: ast.expr) -> bool:
    """Return whether a node is the name K."""
    return isinstance(node, ast.Name) and node.id == "K"


def _functions(source: str) -> dict[str, ast.FunctionDef]:
    """Return the functions of a source text by name."""
    return {node.name: node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}


def _add(name: str, library: dict[str, ast.FunctionDef], functions: dict[str, ast.FunctionDef]) -> None:
    """Add a function after the functions that it calls."""
    if name in functions or name not in library:
        return
    for leaf in ast.walk(library[name]):
        if isinstance(leaf, ast.Call) and isinstance(leaf.func, ast.Name):
            _add(leaf.func.id, library, functions)
    functions[name] = library[name]


def _map_source(row: Map, exit: str | None, arrays: bool) -> tuple[str, str]:
    """Return the name of a mapping's function, and the source of it and of its Jacobian."""
    # For arrays, the arguments are made flat and of one length, and all results get their shape.
    begin, end = f"K.v{row.start.boundary}", f"K.v{row.end.boundary}"
    if row.sticks:
        domain = NEIGHBOURS[row.start.boundary][exit == "above"]
        label, what = f"{row.label}_{exit}", f"stick on belt {row.start.boundary}, slips into domain {domain}"
        residual = f"stick(x_i, theta_i, x_j, theta_j, {begin}, K.A{domain}, K)"
        lines = f"x_th0, x_th1, v_x1, v_th1 = stick_slopes(theta_j, {begin}, K)"
        entries = "1.0, x_th0, -1.0, x_th1, 0.0, 0.0, v_x1, v_th1"
        arguments = "theta_j"
    else:
        label, what = row.label, f"domain {row.domain}, from v{row.start.boundary} to v{row.end.boundary}"
        residual = f"flight(x_i, theta_i, x_j, theta_j, {begin}, {end}, K.A{row.domain}, K)"
        slopes = f"flight_slopes(x_i, theta_i, theta_j, {begin}, K.A{row.domain}, K)"
        lines = f"x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = {slopes}"
        entries = "x_x0, x_th0, -1.0, x_th1, v_x0, v_th0, 0.0, v_th1"
        arguments = "x_i, theta_i, theta_j"
    flattened = ""
    if arrays:
        residual = f"[part.reshape(shape) for part in np.broadcast_arrays(*{residual})]"
        entries = f"[part.reshape(shape) for part in np.broadcast_arrays({entries})]"
        flattened = "[{0}], shape = flat({0})\n    "
    source = f'''
def {label}(x_i, theta_i, x_j, theta_j, K):
    """Return f1, f2 of {row.label}: {what}."""
    {flattened.format("x_i, theta_i, x_j, theta_j")}return {residual}

def {label}{MATRIX}({arguments}, K):
    """Return the derivatives of f1, then of f2, by x_i, theta_i, x_j, theta_j."""
    {flattened.format(arguments)}{lines}
    return {entries}
'''
    return label, source


class _Fold(ast.NodeTransformer):
    """A transformer that replaces known conditions by their truth and, if `fixed`, constants by names (K_cm)."""

    def __init__(self, known: dict[str, bool], fixed: bool) -> None:
        self.known, self.fixed = known, fixed

    def function(self, node: ast.FunctionDef) -> ast.FunctionDef:
        """Return a folded copy of a function without annotations; its docstring is cut to the first paragraph."""
        node = self.visit(ast.parse(ast.unparse(node)).body[0])
        for argument in node.args.args:
            argument.annotation = None
        node.returns = None
        if self.fixed:
            node.args.args = [argument for argument in node.args.args if argument.arg != "K"]
        doc = ast.get_docstring(node)
        if doc:
            first = " ".join(doc.split("\n\n")[0].split())
            node.body[0] = ast.Expr(ast.Constant(re.sub(r"[;,] see `[^`]*`| \(`[^`]*`\)|`", "", first)))
        return ast.fix_missing_locations(node)

    def generic_visit(self, node: ast.AST) -> ast.AST:
        """Replace a condition with known truth."""
        if isinstance(node, ast.expr) and ast.unparse(node) in self.known:
            return ast.Constant(self.known[ast.unparse(node)])
        return super().generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Replace K.name by K_name, unless the constants remain a tuple."""
        if not _is_K(node.value) or ast.unparse(node) in self.known:
            return self.generic_visit(node)
        return ast.Name(f"K_{node.attr}") if self.fixed else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        """Replace INVERSES[n] by 1.0/n."""
        if isinstance(node.value, ast.Name) and node.value.id == "INVERSES":
            return ast.BinOp(ast.Constant(1.0), ast.Div(), node.slice)
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Omit the argument K if the constants are separate names."""
        node_ = self.generic_visit(node)
        if self.fixed and isinstance(node_, ast.Call):
            node_.args = [argument for argument in node_.args if not _is_K(argument)]
        return node_

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        """Omit known operands of an `and` or `or`, or all of it if one decides."""
        values = [self.visit(value) for value in node.values]
        decides = isinstance(node.op, ast.Or)
        if any(isinstance(value, ast.Constant) and value.value is decides for value in values):
            return ast.Constant(decides)
        values = [value for value in values if not isinstance(value, ast.Constant)]
        if not values:
            return ast.Constant(not decides)
        return values[0] if len(values) == 1 else ast.BoolOp(node.op, values)

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        """Keep only the branch that is taken, if known."""
        test = self.visit(node.test)
        if isinstance(test, ast.Constant):
            return self.visit(node.body if test.value else node.orelse)
        return ast.IfExp(test, self.visit(node.body), self.visit(node.orelse))

    def visit_If(self, node: ast.If) -> Any:
        """Keep only the block that is executed, if known."""
        test = self.visit(node.test)
        if isinstance(test, ast.Constant):
            return self._block(node.body if test.value else node.orelse)
        return ast.If(test, self._block(node.body), self._block(node.orelse))

    def _block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        """Return the folded statements of a block."""
        folded = map(self.visit, body)
        return [node for part in folded for node in (part if isinstance(part, list) else [part])]


# --- the languages ---


class _Language(ast.NodeTransformer):
    """A printer of functions: expressions as in Python, with the differing parts substituted."""

    # `returns` says how many numbers each function returns. C and Julia differ in the texts and methods below.

    member, end, condition, otherwise, close = ".", "", "if {}", "else", "end"
    renamed: dict[str, str] = {}  # noqa: RUF012 (a table, never changed)
    loop: Callable[[str, int, int], str]
    unpack: Callable[[list[ast.expr], ast.expr], Iterator[str]]
    give_back: Callable[[ast.expr], Iterator[str]]

    def __init__(self, returns: dict[str, int]) -> None:
        self.returns = returns

    def expression(self, node: ast.expr) -> str:
        """Return the source of an expression."""
        choice = isinstance(node, ast.IfExp)
        text = ast.unparse(self.visit(ast.parse(ast.unparse(node), mode="eval").body))
        return text[1:-1] if choice else text

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        texts = [
            f"({self.expression(each)})" if isinstance(each, ast.BoolOp) else self.expression(each)
            for each in node.values
        ]
        return ast.Name((" && " if isinstance(node.op, ast.And) else " || ").join(texts))

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        return ast.Name(
            f"({self.expression(node.test)} ? {self.expression(node.body)} : {self.expression(node.orelse)})"
        )

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return ast.Name(f"{ast.unparse(node.value)}{self.member}{node.attr}")

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return ast.Name(self.renamed.get(node.id, node.id))

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        return ast.Name(str(node.value).lower()) if isinstance(node.value, bool) else node

    def block(self, body: list[ast.stmt]) -> Iterator[str]:
        """Return the lines of a block."""
        for node in body:
            match node:
                case ast.Expr(ast.Constant()):
                    continue
                case ast.Assign([ast.Tuple(targets)], value):
                    yield from self.unpack(targets, value)
                case ast.Assign([target], value):
                    yield f"{self.expression(target)} = {self.expression(value)}{self.end}"
                case ast.AugAssign(ast.Name(name), ast.Add(), value):
                    yield f"{name} += {self.expression(value)}{self.end}"
                case ast.If(test, then, other):
                    yield self.condition.format(self.expression(test))
                    yield from indented(self.block(then))
                    if other:
                        yield self.otherwise
                        yield from indented(self.block(other))
                    yield self.close
                case ast.For(ast.Name(name), ast.Call(_, [ast.Constant(int(first)), ast.Constant(int(stop))]), loop):
                    yield self.loop(name, first, stop)
                    yield from indented(self.block(loop))
                    yield self.close
                case ast.Break():
                    yield f"break{self.end}"
                case ast.Return(ast.expr() as value):
                    yield from self.give_back(value)
                case _:
                    raise ValueError(f"cannot be printed: {ast.unparse(node)}")


class _Julia(_Language):
    """The printer of functions for Julia 1.x."""

    def function(self, node: ast.FunctionDef) -> str:
        """Return the lines of a function."""
        arguments = ", ".join(argument.arg for argument in node.args.args)
        head = [*comment(ast.get_docstring(node), "# "), f"function {node.name}({arguments})"]
        return "\n".join([*head, *indented(self.block(node.body)), "end"])

    def loop(self, name: str, first: int, stop: int) -> str:
        """Return the first line of a loop."""
        return f"for {name} in {first}:{stop - 1}"

    def unpack(self, targets: list[ast.expr], value: ast.expr) -> Iterator[str]:
        """Return the assignment of several results."""
        yield f"{', '.join(map(self.expression, targets))} = {self.listed(value)}"

    def give_back(self, value: ast.expr) -> Iterator[str]:
        """Return the return statement."""
        yield f"return {self.listed(value)}"

    def listed(self, value: ast.expr) -> str:
        """Return an expression, or the elements of a tuple without parentheses."""
        return ", ".join(map(self.expression, value.elts if isinstance(value, ast.Tuple) else [value]))


class _C(_Language):
    """The printer of functions for C99; one with several results writes them to the array `out`."""

    member, end, condition, otherwise, close = "->", ";", "if ({}) {{", "} else {", "}"
    renamed = {"abs": "fabs"}  # noqa: RUF012

    def __init__(self, returns: dict[str, int], struct: str) -> None:
        super().__init__(returns)
        self.struct, self.name, self.count = struct, "", 0

    def visit_Constant(self, node: ast.Constant) -> ast.expr:
        """Return a flag as 0 or 1, and every other number as a double."""
        return ast.Name(str(int(node.value)) if isinstance(node.value, bool) else repr(float(node.value)))  # type: ignore[arg-type]

    def head(self, node: ast.FunctionDef, prefix: str = "") -> str:
        """Return the declaration of a function without the semicolon."""
        count = self.returns[node.name]
        names = [argument.arg for argument in node.args.args]
        arguments = [f"const {self.struct} *K" if name == "K" else f"double {name}" for name in names]
        if count > 1:
            arguments.append(f"double out{''.join(f'[{size}]' for size in self.shape(node.name))}")
        return f"{'void' if count > 1 else 'double'} {prefix}{node.name}({', '.join(arguments)})"

    def function(self, node: ast.FunctionDef, static: bool = True, prefix: str = "") -> str:
        """Return the lines of a function."""
        self.name, self.count = node.name, 0
        body = list(self.block(node.body))
        if body[-1] == "return;":
            body.pop()
        kinds = _kinds(node)
        lines = comment(ast.get_docstring(node), " * ", "/*", " */")
        lines += [f"{'static ' * static}{self.head(node, prefix)}", "{"]
        for kind in ("double", "int"):
            declared = ", ".join(name for name, of in kinds.items() if of == kind)
            lines += [f"    {kind} {declared};"] * bool(declared)
        lines += [f"    (void){argument.arg};" for argument in node.args.args if argument.arg not in _names(node)]
        return "\n".join([*lines, *indented(body), "}"])

    def shape(self, name: str) -> list[int]:
        """Return the shape of the array that a function fills: two rows for a mapping's Jacobian."""
        count = self.returns[name]
        return [2, count // 2] if re.fullmatch(rf"P\d\w*{MATRIX}", name) else [count]

    def loop(self, name: str, first: int, stop: int) -> str:
        """Return the first line of a loop."""
        return f"for (int {name} = {first}; {name} < {stop}; {name}++) {{"

    def unpack(self, targets: list[ast.expr], value: ast.expr) -> Iterator[str]:
        """Assign results one by one, through copies if a value uses an earlier target."""
        names = [self.expression(target) for target in targets]
        if isinstance(value, ast.Call):
            self.count += 1
            results = f"results{self.count}"
            yield f"double {results}[{len(targets)}];"
            yield f"{self.call_into(value, results)};"
            yield from (f"{name} = {results}[{n}];" for n, name in enumerate(names) if name != "_")
            return
        assert isinstance(value, ast.Tuple)
        values = value.elts
        if any(name in _names(later) for n, name in enumerate(names) for later in values[n + 1 :]):
            yield "{"
            yield from (f"    const double next{n} = {self.expression(each)};" for n, each in enumerate(values))
            yield from (f"    {name} = next{n};" for n, name in enumerate(names))
            yield "}"
        else:
            yield from (f"{name} = {self.expression(each)};" for name, each in zip(names, values, strict=True))

    def give_back(self, value: ast.expr) -> Iterator[str]:
        """Return one value, or write several to the array `out`."""
        if isinstance(value, ast.Tuple):
            columns = self.shape(self.name)[-1]
            for n, each in enumerate(value.elts):
                place = f"[{n // columns}][{n % columns}]" if columns < len(value.elts) else f"[{n}]"
                yield f"out{place} = {self.expression(each)};"
            yield "return;"
        elif isinstance(value, ast.Call) and self.returns.get(ast.unparse(value.func), 1) > 1:
            yield f"{self.call_into(value, 'out')};"
            yield "return;"
        else:
            yield f"return {self.expression(value)};"

    def call_into(self, call: ast.Call, target: str) -> str:
        """Return a call that writes its results to an array."""
        return f"{self.expression(call)[:-1]}{', ' if call.args else ''}{target})"


def _names(node: ast.AST) -> set[str]:
    """Return the names in a syntax tree."""
    return {leaf.id for leaf in ast.walk(node) if isinstance(leaf, ast.Name)}


def _kinds(node: ast.FunctionDef) -> dict[str, str]:
    """Return "double" or "int" (a flag) for each local variable of a function."""
    kinds: dict[str, str] = {}
    given = {argument.arg for argument in node.args.args} | {"_"}
    for leaf in (each for each in ast.walk(node) if isinstance(each, ast.Assign)):
        target, value = leaf.targets[0], leaf.value
        flag = isinstance(value, ast.Compare | ast.BoolOp)
        flag = flag or (isinstance(value, ast.Constant) and isinstance(value.value, bool))
        for name in target.elts if isinstance(target, ast.Tuple) else [target]:
            if isinstance(name, ast.Name) and name.id not in given:
                kinds.setdefault(name.id, "int" if flag else "double")
    return kinds


def wrapped(text: str) -> str:
    """Return C source with long lines wrapped at blanks."""
    lines = []
    for line in text.splitlines():
        indent = line[: len(line) - len(line.lstrip())]
        long = len(line) > EXPORT_WIDTH + 8 and not line.lstrip().startswith("*")
        folded = textwrap.wrap(line, EXPORT_WIDTH, subsequent_indent=f"{indent}    ", break_long_words=False)
        lines += folded if long else [line]
    return "\n".join(lines) + "\n"


def indented(lines: Iterable[str]) -> Iterator[str]:
    """Yield lines indented by one level."""
    return (f"    {line}" for line in lines if line)


def comment(text: str | None, mark: str, opening: str = "", closing: str = "") -> list[str]:
    """Return the first sentence of a docstring as comment lines."""
    if not text:
        return []
    first = " ".join(text.split("\n\n")[0].split())
    lines = [mark + line for line in textwrap.wrap(first, EXPORT_WIDTH - len(mark))]
    if not opening:
        return lines
    if len(lines) == 1:
        return [f"{opening} {first} */"]
    return [opening, *lines, closing]


# --- layout ---


#: What f1 and f2 of a flight and of a stick are, and their signs.
SIGNS = {
    False: [
        "  flight: f1 = x(tau) - x_j, > 0 if the mass comes out beyond x_j; f2 = v(tau) - v_j of the belt reached."
    ],
    True: [
        "  stick:  f1 = x_i + v tau - x_j on the belt of speed v; f2 = force per mass at (x_j, theta_j) in the domain",
        "          into which the mass slips: < 0 is down from the belt, > 0 up.",
    ],
}
#: A scene whose parameters the callers take where none are fixed.
EXAMPLE = "fig9"


def _example(program: _Program) -> tuple[list[float], dict[str, float]]:
    """Return switching points, no root, and parameters with which the source's own caller calls it."""
    p = program.parameters or load_scene(EXAMPLE).parameters
    z = [value for n in range(len(program.maps) + 1) for value in (round(0.5 - 0.3 * n, 1), round(0.4 + 0.7 * n, 1))]
    return z, {name: float(value) for name, value in p.as_dict().items()}


def _about(program: _Program, mark: str, run: str) -> list[str]:
    """Return the comment at the top of the source; `run` says how to run its caller."""
    labels, maps = ", then ".join(program.word.labels), program.word.maps
    lines = [
        f"The mapping structure {program.word}: {labels}. Generated by symosc; do not edit.",
        "",
        f"z holds {len(program.maps) + 1} switching points in order of time: x_0, theta_0, x_1, theta_1, ...",
        "x is the displacement, where the mass has the speed of a belt; that speed is no argument.",
        "The phase theta = Omega t is not reduced modulo 2 pi: a map takes the time (theta_j - theta_i)/Omega >= 0.",
        "residual gives f1, f2 of each map, both 0 where it leads from (x_i, theta_i) to (x_j, theta_j):",
        *(line for sticks, lines in SIGNS.items() for line in lines if sticks in {row.sticks for row in maps}),
        "jacobian gives the 2 x 4 derivatives of f1, f2 of each map by its x_i, theta_i, x_j, theta_j.",
        run,
    ]
    if program.parameters is not None:
        lines += ["", "Parameters:"]
        text = ", ".join(f"{name} = {value}" for name, value in program.parameters.as_dict().items())
        lines.append(text)
    return [f"{mark}{line}".rstrip() for line in lines]


def _python(program: _Program, arrays: bool) -> str:
    """Return the Python source of a program."""
    functions = [ast.unparse(node) for node in program.functions.values()]
    used = set().union(*map(_names, program.functions.values())) | ({"sqrt"} if program.passed else set())
    imports = ["from collections import namedtuple", ""] * bool(program.passed) + ["import numpy as np"] * arrays
    imports.append(f"from {'numpy' if arrays else 'math'} import {', '.join(name for name in MATH if name in used)}")
    run = "Run this file for an example."
    head = ['"""' + "\n".join(_about(program, "", run)) + '\n"""', "\n".join(imports)]
    if program.numbers():
        head.append("\n".join(f"{name} = {value!r}" for name, value in program.numbers().items()))
    setup = [_python_setup(program)] if program.passed else []
    z, p = _example(program)
    points = "np.array(z)[:, None] + [0.0, 0.1]  # two columns of points" if arrays else "z"
    main = ['if __name__ == "__main__":', f"    z = {z}"]
    if program.passed:
        main.append(f"    K = constants({', '.join(f'{name}={value!r}' for name, value in p.items())})")
    arguments = ", ".join(["points", *program.passed])
    main += [f"    points = {points}", f"    print(residual({arguments}))", f"    print(jacobian({arguments}))"]
    parts = [*setup, *functions, *_python_whole(program, arrays), "\n".join(main)]
    return "\n\n".join(head) + "\n\n\n" + "\n\n\n".join(parts) + "\n"


def _python_whole(program: _Program, arrays: bool) -> list[str]:
    """Return the functions of the whole word, for numbers or for broadcasting arrays."""
    calls, arguments = program.calls(0), ", ".join(["z", *program.passed])
    rows = "\n".join(f"        *{label}({z})," for label, z, _ in calls)
    blocks = "\n".join(f"        {label}{MATRIX}({z})," for label, _, z in calls)
    if arrays:
        shapes = str(2 * len(calls)), f"{len(calls)}, 2, 4"
        ends = [f": shape ({shape}) and that of the numbers in z" for shape in shapes]
        what = "f1, f2", "the derivatives of f1, f2"
        frame = "    z, shape = flat(*z)\n    rows = [\n{}\n    ]\n    return np.array(rows).reshape(({}, *shape))"
        bodies = [frame.format(each, shape) for each, shape in zip((rows, blocks), shapes, strict=True)]
    else:
        ends, what = ["", ""], ("f1, f2", "the 2 x 4 derivatives of f1, f2")
        last = "    return [[list(block[:4]), list(block[4:])] for block in blocks]"
        bodies = [f"    return [\n{rows}\n    ]", f"    blocks = [\n{blocks}\n    ]\n{last}"]
    return [
        f'def {name}({arguments}):\n    """Return {of} of each map, in order of time{end}."""\n{body}'
        for name, of, end, body in zip(("residual", "jacobian"), what, ends, bodies, strict=True)
    ]


def _python_setup(program: _Program) -> str:
    """Return the Python function that computes the constants."""
    lines = [*map(ast.unparse, program.setup()), f"return Constants({', '.join(program.fields)})"]
    head = [f"Constants = namedtuple('Constants', {program.fields!r})", "", ""]
    head += [f"def constants(*, {', '.join(PARAMETER_NAMES)}):", '    """Return what the functions below need."""']
    return "\n".join([*head, *(f"    {line}" for line in lines)])


def _c(program: _Program, name: str) -> dict[str, str]:
    """Return the C source and header of a program."""
    c, count, fixed = _C(program.returns(), f"{name}_constants"), len(program.maps), program.values is not None
    constants = "" if fixed else f"const {name}_constants *K, "
    public = [label for label in program.functions if re.match(r"P[1-8]", label)]
    residual = f"void {name}_residual(const double z[{2 * count + 2}], {constants}double f[{2 * count}])"
    jacobian = f"void {name}_jacobian(const double z[{2 * count + 2}], {constants}double J[{count}][2][4])"
    arguments = ", ".join(f"double {parameter}" for parameter in PARAMETER_NAMES)
    setup = f"void {name}_setup({name}_constants *K, {arguments})"
    guard = f"{name.upper()}_H"
    example = f"{name.upper()}_EXAMPLE"
    run = f"Try it: cc -D{example} {name}.c -lm && ./a.out"
    header = ["/*", *_about(program, " * ", run), " */", f"#ifndef {guard}", f"#define {guard}", ""]
    header += ["#ifdef __cplusplus", 'extern "C" {', "#endif", ""]
    if not fixed:
        fields = [f"    {'int' if field in FLAGS else 'double'} {field};" for field in program.fields]
        header += ["typedef struct {", *fields, f"}} {name}_constants;", "", f"{setup};"]
    header += [f"{residual};", f"{jacobian};"]
    header += [f"{c.head(program.functions[label], f'{name}_')};" for label in public]
    header += ["", "#ifdef __cplusplus", "}", "#endif", "", f"#endif /* {guard} */"]
    source = [f'#include "{name}.h"\n\n#include <math.h>']
    numbers = program.numbers().items()
    source.append("\n".join(f"static const double {key} = {float(value)!r};" for key, value in numbers))
    for label, node in program.functions.items():
        source.append(c.function(node, label not in public, f"{name}_" if label in public else ""))
    if not fixed:
        source.append(_c_setup(program, c, setup))
    calls = list(enumerate(program.calls(0)))
    lines = [f"    {name}_{label}({z}, f + {2 * n});" for n, (label, z, _) in calls]
    source.append("\n".join([residual, "{", *lines, "}"]))
    lines = [f"    {name}_{label}{MATRIX}({z}, J[{n}]);" for n, (label, _, z) in calls]
    source.append("\n".join([jacobian, "{", *lines, "}"]))
    source.append(_c_example(program, name, example))
    parts = (part for part in source if part)
    return {f"{name}.h": wrapped("\n".join(header)), f"{name}.c": wrapped("\n\n".join(parts))}


def _c_example(program: _Program, name: str, macro: str) -> str:
    """Return a program that calls the functions of the C source, compiled if a macro is defined."""
    z, p = _example(program)
    count, K = len(program.maps), "&K, " if program.passed else ""
    numbers = ", ".join(map(repr, p.values()))
    setup = [f"{name}_constants K;", f"{name}_setup(&K, {numbers});"] if program.passed else []
    lines = [
        f"const double z[{len(z)}] = {{{', '.join(map(repr, z))}}};",
        f"double f[{2 * count}], J[{count}][2][4];",
        *setup,
        f"{name}_residual(z, {K}f);",
        f"{name}_jacobian(z, {K}J);",
        f"for (int n = 0; n < {2 * count}; n++)",
        '    printf("f[%d] = %.17g\\n", n, f[n]);',
        f"for (int n = 0; n < {8 * count}; n++)",
        '    printf("J[%d][%d][%d] = %.17g\\n", n / 8, n / 4 % 2, n % 4, J[n / 8][n / 4 % 2][n % 4]);',
        "return 0;",
    ]
    body = "\n".join(f"    {line}" for line in lines)
    return f"#ifdef {macro}\n#include <stdio.h>\n\nint main(void)\n{{\n{body}\n}}\n#endif"


def _c_setup(program: _Program, c: _C, signature: str) -> str:
    """Return the function that fills the struct; unused parameters are silenced."""
    lines, used = [], set(program.fields)
    for node in program.setup():
        name = ast.unparse(node.targets[0])
        lines.append(f"    const {'int' if name in FLAGS else 'double'} {name} = {c.expression(node.value)};")
        used |= _names(node.value)
    lines += [f"    K->{field} = {field};" for field in program.fields]
    lines += [f"    (void){name};" for name in PARAMETER_NAMES if name not in used]
    return "\n".join([signature, "{", *lines, "}"])


def _julia(program: _Program, name: str) -> str:
    """Return the Julia source of a program."""
    julia, passed = _Julia(program.returns()), program.passed
    exports = ["residual", "jacobian", *["constants"] * bool(passed)]
    numbers = program.numbers()
    head = [f"module {_module(name, {*exports, *program.functions, *numbers, 'Constants'})}"]
    head.append(f"export {', '.join(exports)}")
    run = f"Try it: julia {name}.jl"
    parts = ["\n".join(_about(program, "# ", run)), *head]
    parts.append("\n".join(f"const {key} = {float(value)!r}" for key, value in numbers.items()))
    if passed:
        fields = [f"    {field}::{'Bool' if field in FLAGS else 'Float64'}" for field in program.fields]
        parts.append("\n".join(["struct Constants", *fields, "end"]))
        lines = list(julia.block(list(program.setup())))
        lines.append(f"return Constants({', '.join(program.fields)})")
        arguments = ", ".join(PARAMETER_NAMES)
        parts.append("\n".join([f"function constants(; {arguments})", *(f"    {line}" for line in lines), "end"]))
    parts += [julia.function(node) for node in program.functions.values()]
    calls, arguments = program.calls(1), ", ".join(["z", *passed])
    rows = "\n".join(f"        {label}({z})...," for label, z, _ in calls)
    blocks = "\n".join(f"        {label}{MATRIX}({z})," for label, _, z in calls)
    parts.append(f"""\
# Return f1, f2 of each map, in order of time.
function residual({arguments})
    return [
{rows}
    ]
end

# Return the 2 x 4 derivatives of f1, f2 of each map, in order of time.
function jacobian({arguments})
    blocks = (
{blocks}
    )
    return [permutedims(reshape(collect(block), 4, 2)) for block in blocks]
end""")
    z, p = _example(program)
    module, rest = head[0].split()[1], ", K" if passed else ""
    given = ", ".join(f"{each} = {value!r}" for each, value in p.items())
    main = ["if abspath(PROGRAM_FILE) == @__FILE__", f"    z = {z}"]
    main += [f"    K = {module}.constants(; {given})"] if passed else []
    main += [f"    println({module}.{each}(z{rest}))" for each in ("residual", "jacobian")]
    return "\n\n".join([*(part for part in parts if part), "end", "\n".join([*main, "end"])]) + "\n"


def _module(name: str, inside: set[str]) -> str:
    """Return the name of a Julia module, distinct from all names inside it."""
    module = name[0].upper() + name[1:]
    while module in inside or module in RESERVED["julia"]:
        module += "Map"
    return module
