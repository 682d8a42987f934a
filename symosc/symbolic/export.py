"""Export of a word's residual and Jacobian as standalone source, for programs without symosc.

The library's scalar kernels are read as syntax trees, what the word does not need is left out, and
the rest is printed in another language: assignments (also of tuples), if, for over a range, break,
return, arithmetic, comparisons, calls. All values are real numbers, except for flags and loop
counters.

A word of n mappings has n + 1 switching points z = (x_0, theta_0, ..., x_n, theta_n), phases
unwrapped, in order of time. `residual` returns f1, f2 of each mapping, 2 n numbers; `jacobian` for
each mapping the derivatives of its f1 and f2 with respect to its (x_i, theta_i, x_j, theta_j), n x
2 x 4 numbers.
"""

from __future__ import annotations

import ast
import inspect
import keyword
import re
import sys
import textwrap
from collections.abc import Iterable, Iterator
from copy import deepcopy
from os.path import isdir, isfile
from pathlib import Path
from typing import Any, NamedTuple

from symosc.base.errors import OutputError, ParameterError
from symosc.base.files import make_folder, read_path, write_text
from symosc.friction import NEIGHBOURS, Map
from symosc.model import PARAMETER_NAMES, by_name
from symosc.scenes import load_scene
from symosc.words import Word, WordLike, read_word

#: Languages that a mapping structure can be written in.
LANGUAGES = ("python", "numpy", "c")
EXPORT_WIDTH = 112
#: By how much a line of C may be longer.
TOLERATED = 8
MATH = ("cos", "exp", "expm1", "sin", "sqrt")
#: Names that a program may use without a definition of its own.
LIBRARY = (*MATH, "abs", "complex", "float", "np", "range")
#: What is appended to the name of a mapping's function for that of its Jacobian, which returns two
#: rows.
MATRIX = "_jacobian"
#: The scene that gives the parameters of the example calls.
EXAMPLE = "fig9"

_C_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long register
restrict return short signed sizeof static struct switch typedef union unsigned void volatile while assert complex ctype
errno fenv inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef stdint stdio stdlib string tgmath time
wchar wctype
"""
_PYTHON = {*keyword.kwlist, *keyword.softkwlist, *sys.stdlib_module_names, "numpy"}
#: Names that a file cannot have: keywords of the language, and names that the source or the
#: compiler uses.
RESERVED = {
    "python": _PYTHON,
    "numpy": _PYTHON,
    "c": {*_C_WORDS.split()},
}


def export(word: WordLike, language: str = "python", name: str | None = None) -> dict[str, str]:
    """Return source text by file name for a word's residual and Jacobian."""
    # `language` is "python" (math, floats), "numpy" (arrays) or "c" (C99, with a header); the
    # functions take what `constants` computes from the parameters; the word need not close. `name`
    # begins file names and, in C, names (None: the word in small letters). WordError or
    # ParameterError for arguments that make no program.
    if not isinstance(language, str) or language not in LANGUAGES:
        raise ParameterError("language", language, f"must be one of {', '.join(LANGUAGES)}")
    read = read_word(word, closed=False)
    if name is None:
        name = str(read).lower()
    if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name):
        raise ParameterError(
            "name", name, "must be letters (a to z), digits and underscores, a letter first"
        )
    if name in RESERVED[language]:
        raise ParameterError(
            "name", name, f"is a reserved word or a library name in {language}; choose another"
        )
    program = _program(read, language == "numpy")
    if language == "c":
        return _c(program, name)
    return {f"{name}.py": _python(program)}


def write_export(
    folder: str | Path, *arguments: Any, force: bool = False, **options: Any
) -> list[Path]:
    """Write the files of `export(*arguments, **options)` to a folder.

    Replace other files there only if `force`.
    """
    # OutputError if a file cannot be written, or, without `force`, already exists with different
    # content.
    folder = Path(read_path(folder))
    texts = {folder / name: text for name, text in export(*arguments, **options).items()}
    for path, text in texts.items():  # before the first of them is written
        if isdir(path):
            raise OutputError(str(path), "is a folder")
        try:
            replaces = not force and isfile(path) and path.read_bytes() != text.encode()
        except OSError as error:
            raise OutputError(str(path), error.strerror or str(error)) from None
        if replaces:
            raise OutputError(
                str(path),
                "already exists with different content; choose another name or use --force",
            )
    make_folder(folder)
    return [write_text(path, text) for path, text in texts.items()]


# --- what a word needs of the kernels ---

SETTINGS = ("EPS", "SERIES_BELOW", "APART_ABOVE", "TERMS")
FLAGS = ("under", "apart")

#: `symosc.engine.flow.constants` in double precision, in the syntax that can be printed; APART is
#: that of `flow`.
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
pull = Omega if B0 != 0.0 else 0.0
beat = rate0 if B0 == 0.0 and rate0 > 0.0 else Omega
rate = rate0 if rate0 > beat else beat
p = w0sq - pull * pull
q = 2.0 * h * pull
larger = w0sq if w0sq > pull * pull else pull * pull
apart = under and p * p + q * q >= APART * larger * larger
detuning = (square - Omega * Omega) / (omega_d + Omega) if under else -Omega
cm = 2.0 * h
f0 = B0 / m
Om = Omega
A1 = (A0 + (mu1 + mu2) * FN) / m
A2 = (A0 + (mu2 - mu1) * FN) / m
A3 = (A0 - (mu1 + mu2) * FN) / m
"""

#: What the residuals of a flight and of a stick (true) are, for the comment at the top of the
#: source.
RESIDUALS = {
    False: """\
  flight: f1 = x(tau) - x_j, > 0 if the mass comes out beyond x_j; f2 = v(tau) - v_j of the belt reached.
""",
    True: """\
  stick:  f1 = x_i + v tau - x_j on the belt of speed v; f2 = force per mass at (x_j, theta_j) in the domain
          into which the mass slips: < 0 is down from the belt, > 0 up.
""",
}

#: What the functions for arrays need besides.
FLAT = '''
def flat(*arguments):
    """Return numbers or arrays as flat arrays of one length, and the shape that they have together."""
    columns = np.broadcast_arrays(*(np.asarray(values, dtype=float) for values in arguments))
    return [column.ravel() for column in columns], columns[0].shape
'''


class _Program(NamedTuple):
    """The functions and constants of a word as syntax trees, to be printed in Python or C."""

    word: Word
    functions: dict[str, ast.FunctionDef]  # each after those that it calls
    maps: list[str]  # functions of the word's mappings in order of time: "P2", "P4_above"
    setup: list[ast.Assign]  # what computes the fields from the parameters
    fields: list[str]  # names of the constants that are used
    numbers: dict[str, float]  # the named numbers at the beginning of the source
    arrays: bool  # whether it is for numpy arrays

    def calls(self) -> list[tuple[str, str, str]]:
        """Return each map's function name, its arguments, and those of its Jacobian."""
        calls = []
        for n, label in enumerate(self.maps):
            # Map n leads from point n to point n + 1 of z, two numbers each.
            names = ("x_i", "theta_i", "x_j", "theta_j")
            z = {name: f"z[{2 * n + i}]" for i, name in enumerate(names)}
            arguments = ", ".join([*z.values(), "K"])
            # A Jacobian takes only those of the four numbers that its formula has.
            parameters = self.functions[label + MATRIX].args.args
            used = [z[parameter.arg] for parameter in parameters if parameter.arg != "K"]
            calls.append((label, arguments, ", ".join([*used, "K"])))
        return calls

    def about(self, mark: str, run: str) -> str:
        """Return the comment at the top of the source.

        `mark` begins its lines, `run` says how to run the example.
        """
        maps = self.word.maps
        kinds = [
            text for sticks, text in RESIDUALS.items() if any(row.sticks == sticks for row in maps)
        ]
        title = f"Mapping {self.word}"
        if len(self.word.labels) > 1:
            title = f"Mapping structure {self.word}: {', then '.join(self.word.labels)}"
        text = f"""\
{title}. Generated by symosc; do not edit.

z holds {len(self.maps) + 1} switching points in order of time: x_0, theta_0, x_1, theta_1, ...
x is the displacement, where the mass has the speed of a belt; that speed is no argument.
The phase theta = Omega t is not reduced modulo 2 pi: a map takes the time (theta_j - theta_i)/Omega >= 0.
residual gives f1, f2 of each map, both 0 where it leads from (x_i, theta_i) to (x_j, theta_j):
{"".join(kinds)}jacobian gives the 2 x 4 derivatives of f1, f2 of each map by its x_i, theta_i, x_j, theta_j.
{run}"""
        return "\n".join(f"{mark}{line}".rstrip() for line in text.split("\n"))

    def example(self) -> tuple[list[float], dict[str, float]]:
        """Return switching points (not an orbit) and parameters for the example call at the end of
        the source.
        """
        p = load_scene(EXAMPLE).parameters
        # Some numbers: positions that fall, and phases that grow.
        z = [
            coordinate
            for n in range(len(self.maps) + 1)
            for coordinate in (round(0.5 - 0.3 * n, 1), round(0.4 + 0.7 * n, 1))
        ]
        return z, by_name(p, float)


def _program(word: Word, arrays: bool) -> _Program:
    """Collect the functions that a word's residual needs, for numpy arrays or for numbers."""
    # Late: `symosc codegen --help` needs none of these.
    from symosc.engine.flow import APART
    from symosc.kernels import _generated, entire, entire_array, mapping

    basis_functions = entire_array if arrays else entire
    sources = [inspect.getsource(module) for module in (_generated, basis_functions, mapping)]
    maps: list[str] = []
    roots: list[str] = []  # functions that the program has in any case
    for row, exit in zip(word.maps, word.exits(), strict=True):
        if row.sticks and exit is None:  # the word does not say: both
            exits: list[str | None] = ["below", "above"]
        else:
            exits = [exit]
        for side in exits:
            label, source = _map_source(row, side, arrays)
            roots += [label, label + MATRIX]
            sources.append(source)
            maps.append(label)
    if word.maps[-1].sticks and word.exits()[-1] is None:
        # The word's own functions take the exit below; the other one, which is the last, is there
        # to be called.
        maps.pop()
    nodes = [node for source in sources for node in ast.parse(source).body]
    library = {node.name: _bare(node) for node in nodes if isinstance(node, ast.FunctionDef)}
    if arrays:
        library["flat"] = next(
            node for node in ast.parse(FLAT).body if isinstance(node, ast.FunctionDef)
        )
    functions = _functions_needed(library, roots)
    names = set().union(*map(_names, functions.values()))
    constants = _constants_used(functions.values())
    thresholds = vars(entire) | vars(entire_array)
    numbers = {name: thresholds[name] for name in SETTINGS if name in names}
    steps = ast.parse(SETUP.replace("APART", repr(float(APART**2)))).body
    setup = {ast.unparse(node.targets[0]): node for node in steps if isinstance(node, ast.Assign)}
    fields = [name for name in (*setup, "v1", "v2") if name in constants]
    _check_complete(functions, {*numbers, *LIBRARY}, constants - set(fields))
    return _Program(
        word,
        functions,
        maps,
        setup=_steps_needed(setup, fields),
        fields=fields,
        numbers=numbers,
        arrays=arrays,
    )


def _functions_needed(
    library: dict[str, ast.FunctionDef], roots: list[str]
) -> dict[str, ast.FunctionDef]:
    """Return the functions `roots` of the library with all that they call, each after those that it
    calls.
    """
    functions: dict[str, ast.FunctionDef] = {}

    def add(name: str) -> None:
        if name in library and name not in functions:
            for leaf in ast.walk(library[name]):
                if isinstance(leaf, ast.Call) and isinstance(leaf.func, ast.Name):
                    add(leaf.func.id)
            functions[name] = library[name]

    for name in roots:
        add(name)
    return functions


def _steps_needed(setup: dict[str, ast.Assign], fields: list[str]) -> list[ast.Assign]:
    """Return the steps of the setup that compute the fields, with those that these steps use."""
    needed = set(fields)
    steps = list[ast.Assign]()
    # Backwards: a step is needed by those after it.
    for name, step in reversed(setup.items()):
        if name in needed:
            steps.insert(0, step)
            needed |= _names(step.value)
    return steps


def _constants_used(functions: Iterable[ast.FunctionDef]) -> set[str]:
    """Return the names of the constants that functions read as attributes of K."""
    leaves = [leaf for node in functions for leaf in ast.walk(node)]
    attributes = [leaf for leaf in leaves if isinstance(leaf, ast.Attribute)]
    return {leaf.attr for leaf in attributes if ast.unparse(leaf.value) == "K"}


def _check_complete(
    functions: dict[str, ast.FunctionDef], predefined: set[str], constants: set[str]
) -> None:
    """Raise ValueError if functions use names or constants that the program does not define."""
    # A name that a kernel module renames would else be missing in the exported program only.
    missing = {f"K.{name}" for name in constants}
    for node in functions.values():
        variables = [leaf for leaf in ast.walk(node) if isinstance(leaf, ast.Name)]
        local = {leaf.id for leaf in variables if isinstance(leaf.ctx, ast.Store)}
        local |= {leaf.arg for leaf in ast.walk(node) if isinstance(leaf, ast.arg)}
        missing |= {leaf.id for leaf in variables} - local - predefined - set(functions)
    if missing:
        names = ", ".join(sorted(missing))
        raise ValueError(f"The exported program would not define {names}, which the kernels use.")


def _map_source(row: Map, exit: str | None, arrays: bool) -> tuple[str, str]:
    """Return a mapping's function name, and source of it and its Jacobian.

    `exit` of a stick: "below" or "above".
    """
    # For arrays, the arguments are flattened and broadcast to one length, and results get the
    # arguments' shape back: "{0}" in `flattened` is their list.
    start_speed = f"K.v{row.start.boundary}"
    end_speed = f"K.v{row.end.boundary}"
    if row.sticks:
        below, above = NEIGHBOURS[row.start.boundary]
        if exit == "above":
            domain = above
        else:
            domain = below
        label = f"{row.label}_{exit}"
        description = f"stick on belt {row.start.boundary}, slips into domain {domain}"
        residual = f"stick(x_i, theta_i, x_j, theta_j, {start_speed}, K.A{domain}, K)"
        slope_line = f"x_th0, x_th1, v_x1, v_th1 = stick_slopes(theta_j, {start_speed}, K)"
        entries = "1.0, x_th0, -1.0, x_th1, 0.0, 0.0, v_x1, v_th1"
        arguments = "theta_j"
    else:
        label = row.label
        description = f"domain {row.domain}, from v{row.start.boundary} to v{row.end.boundary}"
        residual = (
            f"flight(x_i, theta_i, x_j, theta_j, {start_speed}, {end_speed}, K.A{row.domain}, K)"
        )
        slopes = f"flight_slopes(x_i, theta_i, theta_j, {start_speed}, K.A{row.domain}, K)"
        slope_line = f"x_x0, x_th0, x_th1, v_x0, v_th0, v_th1 = {slopes}"
        entries = "x_x0, x_th0, -1.0, x_th1, v_x0, v_th0, 0.0, v_th1"
        arguments = "x_i, theta_i, theta_j"
    flattened = ""
    if arrays:
        residual = f"[part.reshape(shape) for part in np.broadcast_arrays(*{residual})]"
        entries = f"[part.reshape(shape) for part in np.broadcast_arrays({entries})]"
        flattened = "[{0}], shape = flat({0})\n    "
    source = f'''
def {label}(x_i, theta_i, x_j, theta_j, K):
    """Return f1, f2 of {row.label}: {description}."""
    {flattened.format("x_i, theta_i, x_j, theta_j")}return {residual}

def {label}{MATRIX}({arguments}, K):
    """Return the derivatives of f1, then of f2, by x_i, theta_i, x_j, theta_j."""
    {flattened.format(arguments)}{slope_line}
    return {entries}
'''
    return label, source


def _names(node: ast.AST) -> set[str]:
    """Return all variable and function names that occur in a syntax tree."""
    return {leaf.id for leaf in ast.walk(node) if isinstance(leaf, ast.Name)}


def _bare(node: ast.FunctionDef) -> ast.FunctionDef:
    """Remove a function's annotations and later docstring paragraphs, and write INVERSES[n] as 1/n."""
    node = _Inverses().visit(node)
    for argument in node.args.args:
        argument.annotation = None
    node.returns = None
    node.decorator_list = []
    summary = re.sub(r"[;,] see `[^`]*`| \(`[^`]*`\)|`", "", _first_paragraph(node))
    node.body[0] = ast.Expr(ast.Constant(summary))
    return ast.fix_missing_locations(node)


class _Inverses(ast.NodeTransformer):
    """A visitor that divides where the kernels look up an inverse."""

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        """Return INVERSES[n] as 1.0 / n."""
        if ast.unparse(node.value) == "INVERSES":
            return ast.BinOp(ast.Constant(1.0), ast.Div(), node.slice)
        return node


# --- the languages: expressions as in Python, with the differing parts substituted ---


class _C(ast.NodeTransformer):
    """A printer of Python functions as C99.

    A function with several results writes them to an array `out`. `returns` says how many numbers
    each function returns.
    """

    def __init__(self, functions: dict[str, ast.FunctionDef], name: str) -> None:
        self.base = name
        self.current = ""
        self.count = 0
        # How many numbers each function returns. A function that returns a call returns as many as
        # the called one, which comes before it.
        self.returns: dict[str, int] = {}
        for name, node in functions.items():
            value = next(leaf.value for leaf in ast.walk(node) if isinstance(leaf, ast.Return))
            if isinstance(value, ast.Call):
                called = ast.unparse(value.func)
            else:
                called = ""
            if isinstance(value, ast.Tuple):
                self.returns[name] = len(value.elts)
            else:
                self.returns[name] = self.returns.get(called, 1)

    def expression(self, node: ast.expr) -> str:
        """Return the source of a Python expression in the target language."""
        text = ast.unparse(self.visit(deepcopy(node)))
        if isinstance(node, ast.IfExp):
            return text[1:-1]  # without the parentheses that `visit` writes
        return text

    def visit(self, node: ast.AST) -> Any:
        """Replace each part of a node that C writes unlike Python by C's text."""
        match node:
            case ast.BoolOp(op, values):
                texts = [
                    f"({self.expression(v)})" if isinstance(v, ast.BoolOp) else self.expression(v)
                    for v in values
                ]
                return ast.Name((" && " if isinstance(op, ast.And) else " || ").join(texts))
            case ast.IfExp(test, then, other):
                return ast.Name("({} ? {} : {})".format(*map(self.expression, (test, then, other))))
            case ast.Attribute(value, name):
                return ast.Name(f"{ast.unparse(value)}->{name}")
            case ast.Name("abs"):
                return ast.Name("fabs")
            case ast.Constant(bool() as flag):
                return ast.Name(str(int(flag)))
            case ast.Constant(int() | float() as value):
                return ast.Name(repr(float(value)))
        return self.generic_visit(node)

    def block(self, body: list[ast.stmt]) -> Iterator[str]:
        """Yield the source lines of a list of statements."""
        for node in body:
            match node:
                case ast.Expr(ast.Constant()):
                    continue
                case ast.Assign([ast.Tuple(targets)], value):
                    yield from self.unpack(targets, value)
                case ast.Assign([target], value):
                    yield f"{self.expression(target)} = {self.expression(value)};"
                case ast.AugAssign(ast.Name(name), ast.Add(), value):
                    yield f"{name} += {self.expression(value)};"
                case ast.If(test, then, other):
                    yield f"if ({self.expression(test)}) {{"
                    yield from _indented(self.block(then))
                    if other:
                        yield "} else {"
                        yield from _indented(self.block(other))
                    yield "}"
                case ast.For(
                    ast.Name(name),
                    ast.Call(_, [ast.Constant(int(first)), ast.Constant(int(stop))]),
                    loop,
                ):
                    yield f"for (int {name} = {first}; {name} < {stop}; {name}++) {{"
                    yield from _indented(self.block(loop))
                    yield "}"
                case ast.Break():
                    yield "break;"
                case ast.Return(ast.expr() as value):
                    yield from self.give_back(value)
                case _:
                    raise ValueError(f"cannot be printed: {ast.unparse(node)}")

    def head(self, node: ast.FunctionDef) -> str:
        """Return a C function's head, "type name(arguments)".

        A mapping's name gets the program's as prefix.
        """
        count = self.returns[node.name]
        names = [argument.arg for argument in node.args.args]
        arguments = [
            f"const {self.base}_constants *K" if name == "K" else f"double {name}" for name in names
        ]
        if count > 1:
            is_jacobian = re.fullmatch(rf"P\d\w*{MATRIX}", node.name)  # a row for each of f1, f2
            if is_jacobian:
                arguments.append(f"double out[2][{count // 2}]")
            else:
                arguments.append(f"double out[{count}]")
        if _is_map(node.name):
            prefix = f"{self.base}_"
        else:
            prefix = ""
        return f"{'void' if count > 1 else 'double'} {prefix}{node.name}({', '.join(arguments)})"

    def function(self, node: ast.FunctionDef) -> str:
        """Return the source of a function."""
        self.current = node.name
        self.count = 0
        body = list(self.block(node.body))
        if body[-1] == "return;":  # C needs none at the end
            body.pop()
        summary = _first_paragraph(node)
        lines = [f" * {line}" for line in textwrap.wrap(summary, EXPORT_WIDTH - 3)]
        if len(lines) == 1:
            lines = [f"/* {summary} */"]
        else:
            lines = ["/*", *lines, " */"]
        lines += [f"{'' if _is_map(node.name) else 'static '}{self.head(node)}", "{"]
        types: dict[str, str] = {}  # of the local variables: "int" for a flag
        assignments = [leaf for leaf in ast.walk(node) if isinstance(leaf, ast.Assign)]
        for assignment in assignments:
            (target,) = assignment.targets
            match assignment.value:
                case ast.Compare() | ast.BoolOp() | ast.Constant(bool()):
                    kind = "int"
                case _:
                    kind = "double"
            for name in target.elts if isinstance(target, ast.Tuple) else [target]:
                types.setdefault(ast.unparse(name), kind)
        names = [
            name
            for name in types
            if name not in {argument.arg for argument in node.args.args} | {"_"}
        ]
        for kind in ("double", "int"):
            declared = ", ".join(name for name in names if types[name] == kind)
            lines += [f"    {kind} {declared};"] * bool(declared)
        lines += [
            f"    (void){argument.arg};"
            for argument in node.args.args
            if argument.arg not in _names(node)
        ]
        return "\n".join([*lines, *_indented(body), "}"])

    def unpack(self, targets: list[ast.expr], value: ast.expr) -> Iterator[str]:
        """Yield C lines that assign several results one by one, through copies if a value uses an
        earlier target.
        """
        names = [self.expression(target) for target in targets]
        if isinstance(value, ast.Call):
            self.count += 1
            results = f"results{self.count}"
            yield f"double {results}[{len(targets)}];"
            yield self._call_into(value, results)
            yield from (f"{name} = {results}[{n}];" for n, name in enumerate(names) if name != "_")
            return
        assert isinstance(value, ast.Tuple)
        # Whether a value uses a name that would already have been assigned.
        uses_earlier = any(
            name in _names(later) for n, name in enumerate(names) for later in value.elts[n + 1 :]
        )
        if uses_earlier:
            yield "{"
            yield from (
                f"    const double next{n} = {self.expression(part)};"
                for n, part in enumerate(value.elts)
            )
            yield from (f"    {name} = next{n};" for n, name in enumerate(names))
            yield "}"
        else:
            yield from (
                f"{name} = {self.expression(part)};"
                for name, part in zip(names, value.elts, strict=True)
            )

    def give_back(self, value: ast.expr) -> Iterator[str]:
        """Yield the C lines that return one result, or write several results to the array `out`."""
        if isinstance(value, ast.Tuple):
            if self.current.endswith(MATRIX) and _is_map(self.current):
                columns = len(value.elts) // 2
            else:
                columns = 0
            for n, part in enumerate(value.elts):
                if columns:
                    place = f"[{n // columns}][{n % columns}]"
                else:
                    place = f"[{n}]"
                yield f"out{place} = {self.expression(part)};"
            yield "return;"
        elif isinstance(value, ast.Call) and self.returns.get(ast.unparse(value.func), 1) > 1:
            yield self._call_into(value, "out")
            yield "return;"
        else:
            yield f"return {self.expression(value)};"

    def _call_into(self, call: ast.Call, target: str) -> str:
        """Return a C call of a function with several results, which it writes to the array
        `target`.
        """
        call_without_end = self.expression(call).removesuffix(")")
        comma = ", " if call.args else ""
        return f"{call_without_end}{comma}{target});"


def _is_map(name: str) -> bool:
    """Return whether a name is that of a mapping's function or of its Jacobian."""
    return re.match(r"P[1-8]", name) is not None


def _first_paragraph(node: ast.FunctionDef) -> str:
    """Return the first paragraph of a docstring in one line."""
    return " ".join((ast.get_docstring(node) or "").split("\n\n")[0].split())


def _indented(lines: Iterator[str] | list[str]) -> list[str]:
    """Return lines indented by one level."""
    return [f"    {line}" for line in lines if line]


# --- layout ---


def _python(program: _Program) -> str:
    """Return the Python source of a program, for numbers or for arrays."""
    head = _python_head(program)
    z, p = program.example()
    steps = _indented(
        [*map(ast.unparse, program.setup), f"return Constants({', '.join(program.fields)})"]
    )
    parts = [
        f"Constants = namedtuple('Constants', {program.fields!r})",
        f"def constants(*, {', '.join(PARAMETER_NAMES)}):\n"
        + "\n".join(['    """Return what the functions below need."""', *steps]),
    ]
    K = f"    K = constants({', '.join(f'{name}={value!r}' for name, value in p.items())})\n"
    parts += [
        *map(ast.unparse, program.functions.values()),
        *_python_equations(program),
        f"""\
if __name__ == "__main__":
    z = {z}
{K}    points = {"np.array(z)[:, None] + [0.0, 0.1]  # two columns of points" if program.arrays else "z"}
    print(residual(points, K))
    print(jacobian(points, K))
""",
    ]
    return "\n\n".join(head) + "\n\n\n" + "\n\n\n".join(parts)


def _python_head(program: _Program) -> list[str]:
    """Return the parts of the source before its functions: docstring, imports and numbers."""
    used = set().union(*map(_names, program.functions.values())) | {"sqrt"}
    if program.arrays:
        library = "numpy"
    else:
        library = "math"
    imports = "from collections import namedtuple\n\n" + "import numpy as np\n" * program.arrays
    imports += f"from {library} import {', '.join(name for name in MATH if name in used)}"
    head = [f'"""{program.about("", "Run this file for an example.")}\n"""', imports]
    if program.numbers:
        head.append("\n".join(f"{name} = {value!r}" for name, value in program.numbers.items()))
    return head


def _python_equations(program: _Program) -> tuple[str, str]:
    """Return the source of the functions `residual` and `jacobian` of all maps."""
    calls = program.calls()
    count = len(program.maps)
    rows = "\n".join(f"        *{label}({z})," for label, z, _ in calls)
    blocks = "\n".join(f"        {label}{MATRIX}({z})," for label, _, z in calls)
    residual_doc = "Return f1, f2 of each map, in order of time"
    if program.arrays:

        def body(results: str, shape: str) -> str:
            return (
                f"    z, shape = flat(*z)\n    rows = [\n{results}\n    ]\n    return "
                f"np.array(rows).reshape(({shape}, *shape))"
            )

        residual_shape = f"{2 * count}"
        jacobian_shape = f"{count}, 2, 4"
        residual_doc += f": shape ({residual_shape}) and that of the numbers in z."
        jacobian_doc = (
            "Return the derivatives of f1, f2 of each map, in order of time: shape "
            f"({jacobian_shape}) and that of the numbers in z."
        )
        residual_body = body(rows, residual_shape)
        jacobian_body = body(blocks, jacobian_shape)
    else:
        residual_doc += "."
        jacobian_doc = "Return the 2 x 4 derivatives of f1, f2 of each map, in order of time."
        residual_body = f"    return [\n{rows}\n    ]"
        # A map's function gives eight numbers in a row.
        last = "    return [[list(block[:4]), list(block[4:])] for block in blocks]"
        jacobian_body = f"    blocks = [\n{blocks}\n    ]\n{last}"
    return (
        f'def residual(z, K):\n    """{residual_doc}"""\n{residual_body}',
        f'def jacobian(z, K):\n    """{jacobian_doc}"""\n{jacobian_body}',
    )


def _c(program: _Program, name: str) -> dict[str, str]:
    """Return the C source and header of a program."""
    c = _C(program.functions, name)
    count = len(program.maps)
    constants = f"const {name}_constants *K, "
    residual = (
        f"void {name}_residual(const double z[{2 * count + 2}], {constants}double f[{2 * count}])"
    )
    jacobian = (
        f"void {name}_jacobian(const double z[{2 * count + 2}], {constants}double J[{count}][2][4])"
    )
    setup = (
        f"void {name}_setup({name}_constants *K, "
        f"{', '.join(f'double {parameter}' for parameter in PARAMETER_NAMES)})"
    )
    guard = f"{name.upper()}_H"
    example = f"{name.upper()}_EXAMPLE"
    public = "\n".join(
        f"{c.head(node)};" for label, node in program.functions.items() if _is_map(label)
    )
    steps = {ast.unparse(node.targets[0]): node.value for node in program.setup}
    kind = {**dict.fromkeys((*steps, *program.fields), "double"), **dict.fromkeys(FLAGS, "int")}
    fields = "\n".join(f"    {kind[field]} {field};" for field in program.fields)
    struct = f"typedef struct {{\n{fields}\n}} {name}_constants;\n\n{setup};\n"
    lines = [f"const {kind[step]} {step} = {c.expression(value)};" for step, value in steps.items()]
    lines += [f"K->{field} = {field};" for field in program.fields]
    used = set(program.fields).union(*map(_names, steps.values()))
    lines += [f"(void){unused};" for unused in PARAMETER_NAMES if unused not in used]
    filled = "\n".join([setup, "{", *_indented(lines), "}"])
    header = f"""\
/*
{program.about(" * ", f"Try it: cc -D{example} {name}.c -lm && ./a.out")}
 */
#ifndef {guard}
#define {guard}

#ifdef __cplusplus
extern "C" {{
#endif

{struct}{residual};
{jacobian};
{public}

#ifdef __cplusplus
}}
#endif

#endif /* {guard} */"""
    calls = list(enumerate(program.calls()))
    rows = [f"    {name}_{label}({arguments}, f + {2 * n});" for n, (label, arguments, _) in calls]
    blocks = [
        f"    {name}_{label}{MATRIX}({arguments}, J[{n}]);" for n, (label, _, arguments) in calls
    ]
    parts = [
        f'#include "{name}.h"\n\n#include <math.h>',
        "\n".join(
            f"static const double {key} = {float(value)!r};"
            for key, value in program.numbers.items()
        ),
        *map(c.function, program.functions.values()),
        filled,
        "\n".join([residual, "{", *rows, "}"]),
        "\n".join([jacobian, "{", *blocks, "}"]),
        _c_main(program, name, example),
    ]
    return {f"{name}.h": _wrapped(header), f"{name}.c": _wrapped("\n\n".join(filter(None, parts)))}


def _c_main(program: _Program, name: str, example: str) -> str:
    """Return the C source of a `main` that evaluates an example, if the macro `example` is defined."""
    z, p = program.example()
    count = len(program.maps)
    prepared = (
        f"    {name}_constants K;\n    {name}_setup(&K, {', '.join(map(repr, p.values()))});\n"
    )
    return f"""\
#ifdef {example}
#include <stdio.h>

int main(void)
{{
    const double z[{len(z)}] = {{{", ".join(map(repr, z))}}};
    double f[{2 * count}], J[{count}][2][4];
{prepared}    {name}_residual(z, &K, f);
    {name}_jacobian(z, &K, J);
    for (int n = 0; n < {2 * count}; n++)
        printf("f[%d] = %.17g\\n", n, f[n]);
    for (int n = 0; n < {8 * count}; n++)
        printf("J[%d][%d][%d] = %.17g\\n", n / 8, n / 4 % 2, n % 4, J[n / 8][n / 4 % 2][n % 4]);
    return 0;
}}
#endif"""


def _wrapped(text: str) -> str:
    """Return C source with its long lines broken at blanks."""
    lines = []
    for line in text.splitlines():
        indent = line[: len(line) - len(line.lstrip())]
        # A little too long is let pass, and lines of comments stay as they are.
        too_long = len(line) > EXPORT_WIDTH + TOLERATED and not line.lstrip().startswith("*")
        if too_long:
            lines += textwrap.wrap(
                line, EXPORT_WIDTH, subsequent_indent=f"{indent}    ", break_long_words=False
            )
        else:
            lines += [line]
    return "\n".join(lines) + "\n"
