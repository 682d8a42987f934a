"""Prints the scalar kernels, as Python syntax trees, in other languages.

The kernels use little of Python: assignments (also of tuples), if, for over a range, break, return, arithmetic,
comparisons and calls. All values are real numbers, except for flags and loop counters.
"""

from __future__ import annotations

import ast
import keyword
import re
import sys
import textwrap
from collections.abc import Iterator

#: Languages that a mapping structure can be written in.
LANGUAGES = ("python", "numpy", "c", "julia")
OPERATOR_TEXTS: dict[type[ast.AST], tuple[str, int]] = {
    ast.Add: ("+", 6),
    ast.Sub: ("-", 6),
    ast.Mult: ("*", 7),
    ast.Div: ("/", 7),
    ast.Lt: ("<", 5),
    ast.LtE: ("<=", 5),
    ast.Gt: (">", 5),
    ast.GtE: (">=", 5),
    ast.Eq: ("==", 5),
    ast.NotEq: ("!=", 5),
    ast.And: ("&&", 3),
    ast.Or: ("||", 2),
}
TERNARY, SIGN, ATOM = 1, 8, 9
EXPORT_WIDTH = 112
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


class Language:
    """Expressions and blocks; C and Julia differ in the rest.

    Parameters
    ----------
    returns : dict
        How many numbers each function returns.
    """

    member = "."
    names: dict[str, str] = {}  # noqa: RUF012 (a table, never changed)

    def __init__(self, returns: dict[str, int]) -> None:
        self.returns = returns

    def expression(self, node: ast.expr, outer: int = 0) -> str:
        """Return the source of an expression, in parentheses if it binds less than `outer`."""
        text, binds = self._expression(node)
        return f"({text})" if binds < outer else text

    def _expression(self, node: ast.expr) -> tuple[str, int]:
        match node:
            case ast.BinOp(left, operator, right):
                sign, binds = OPERATOR_TEXTS[type(operator)]
                return f"{self.expression(left, binds)} {sign} {self.expression(right, binds + 1)}", binds
            case ast.UnaryOp(ast.USub(), operand):
                return f"-{self.expression(operand, SIGN)}", SIGN - 1
            case ast.UnaryOp(ast.Not(), operand):
                return f"!{self.expression(operand, SIGN)}", SIGN
            case ast.BoolOp(operator, values):
                sign, binds = OPERATOR_TEXTS[type(operator)]
                return f" {sign} ".join(self.expression(value, binds + 1) for value in values), binds
            case ast.Compare(left, [operator], [right]):
                sign, binds = OPERATOR_TEXTS[type(operator)]
                return f"{self.expression(left, binds + 1)} {sign} {self.expression(right, binds + 1)}", binds
            case ast.IfExp(test, body, other):
                parts = (self.expression(part, TERNARY + 1) for part in (test, body, other))
                return "{} ? {} : {}".format(*parts), TERNARY
            case ast.Call(ast.Name(name), arguments):
                return f"{self.names.get(name, name)}({', '.join(map(self.expression, arguments))})", ATOM
            case ast.Attribute(ast.Name(owner), field):
                return f"{owner}{self.member}{field}", ATOM
            case ast.Name(name):
                return name, ATOM
            case ast.Constant(bool() | int() | float() as value):
                return self.constant(value), ATOM
        raise ValueError(f"cannot be printed: {ast.unparse(node)}")

    def constant(self, value: bool | float) -> str:
        """Return the source of a number or a flag."""
        return str(value).lower() if isinstance(value, bool) else repr(value)


class Julia(Language):
    """Julia 1.x."""

    def function(self, node: ast.FunctionDef) -> str:
        """Return the source of a function."""
        arguments = ", ".join(argument.arg for argument in node.args.args)
        doc = ast.get_docstring(node)
        lines = [*comment(doc, "# "), f"function {node.name}({arguments})", *indented(self.block(node.body)), "end"]
        return "\n".join(lines)

    def block(self, body: list[ast.stmt]) -> Iterator[str]:
        """Yield the lines of a block."""
        for node in body:
            match node:
                case ast.Expr(ast.Constant()):
                    continue
                case ast.Assign([ast.Tuple(targets)], ast.Tuple(values)):
                    yield f"{', '.join(map(self.expression, targets))} = {', '.join(map(self.expression, values))}"
                case ast.Assign([ast.Tuple(targets)], value):
                    yield f"{', '.join(map(self.expression, targets))} = {self.expression(value)}"
                case ast.Assign([target], value):
                    yield f"{self.expression(target)} = {self.expression(value)}"
                case ast.AugAssign(target, operator, value):
                    yield f"{self.expression(target)} {OPERATOR_TEXTS[type(operator)][0]}= {self.expression(value)}"
                case ast.If(test, then, other):
                    yield f"if {self.expression(test)}"
                    yield from indented(self.block(then))
                    if other:
                        yield "else"
                        yield from indented(self.block(other))
                    yield "end"
                case ast.For(ast.Name(name), ast.Call(_, [first, ast.Constant(int(stop))]), loop):
                    yield f"for {name} in {self.expression(first)}:{stop - 1}"
                    yield from indented(self.block(loop))
                    yield "end"
                case ast.Break():
                    yield "break"
                case ast.Return(ast.Tuple(values)):
                    yield f"return {', '.join(map(self.expression, values))}"
                case ast.Return(ast.expr() as value):
                    yield f"return {self.expression(value)}"
                case _:
                    raise ValueError(f"cannot be printed: {ast.unparse(node)}")


class C(Language):
    """C99. A function with several results writes them to the array `out`."""

    member = "->"
    names = {"abs": "fabs"}  # noqa: RUF012

    def __init__(self, returns: dict[str, int], struct: str) -> None:
        super().__init__(returns)
        self.struct, self.name, self.calls = struct, "", 0

    def constant(self, value: bool | float) -> str:
        """Return a flag as 0 or 1, and every number as a double."""
        return str(int(value)) if isinstance(value, bool) else repr(float(value))

    def head(self, node: ast.FunctionDef, prefix: str = "") -> str:
        """Return the declaration of a function without the semicolon."""
        count = self.returns[node.name]
        names = [argument.arg for argument in node.args.args]
        arguments = [f"const {self.struct} *K" if name == "K" else f"double {name}" for name in names]
        if count > 1:
            arguments.append(f"double out{''.join(f'[{size}]' for size in self.shape(node.name))}")
        return f"{'void' if count > 1 else 'double'} {prefix}{node.name}({', '.join(arguments)})"

    def function(self, node: ast.FunctionDef, static: bool = True, prefix: str = "") -> str:
        """Return the source of a function."""
        self.name, self.calls = node.name, 0
        body = list(self.block(node.body))
        if body[-1] == "return;":
            body.pop()
        kinds = _kinds(node)
        lines = comment(ast.get_docstring(node), " * ", "/*", " */")
        lines += [f"{'static ' * static}{self.head(node, prefix)}", "{"]
        for kind in ("double", "int"):
            declared = ", ".join(name for name, of in kinds.items() if of == kind)
            lines += [f"    {kind} {declared};"] * bool(declared)
        read = {leaf.id for leaf in ast.walk(node) if isinstance(leaf, ast.Name)}
        lines += [f"    (void){argument.arg};" for argument in node.args.args if argument.arg not in read]
        return "\n".join([*lines, *indented(iter(body)), "}"])

    def shape(self, name: str) -> list[int]:
        """Return the shape of the array that a function fills: two rows for a mapping's Jacobian."""
        count = self.returns[name]
        return [2, count // 2] if re.fullmatch(rf"P\d\w*{MATRIX}", name) else [count]

    def block(self, body: list[ast.stmt]) -> Iterator[str]:
        """Yield the lines of a block."""
        for node in body:
            match node:
                case ast.Expr(ast.Constant()):
                    continue
                case ast.Assign([ast.Tuple(targets)], ast.Tuple(values)):
                    yield from self._parallel(targets, values)
                case ast.Assign([ast.Tuple(targets)], ast.Call() as call):
                    self.calls += 1
                    results = f"results{self.calls}"
                    yield f"double {results}[{len(targets)}];"
                    yield f"{self._call(call, results)};"
                    names = (self.expression(target) for target in targets)
                    yield from (f"{name} = {results}[{n}];" for n, name in enumerate(names) if name != "_")
                case ast.Assign([target], value):
                    yield f"{self.expression(target)} = {self.expression(value)};"
                case ast.AugAssign(target, operator, value):
                    yield f"{self.expression(target)} {OPERATOR_TEXTS[type(operator)][0]}= {self.expression(value)};"
                case ast.If(test, then, other):
                    yield f"if ({self.expression(test)}) {{"
                    yield from indented(self.block(then))
                    if other:
                        yield "} else {"
                        yield from indented(self.block(other))
                    yield "}"
                case ast.For(ast.Name(name), ast.Call(_, [ast.Constant(int(first)), ast.Constant(int(stop))]), loop):
                    yield f"for (int {name} = {first}; {name} < {stop}; {name}++) {{"
                    yield from indented(self.block(loop))
                    yield "}"
                case ast.Break():
                    yield "break;"
                case ast.Return(ast.Tuple(values)):
                    columns = self.shape(self.name)[-1]
                    for n, value in enumerate(values):
                        place = f"[{n // columns}][{n % columns}]" if columns < len(values) else f"[{n}]"
                        yield f"out{place} = {self.expression(value)};"
                    yield "return;"
                case ast.Return(ast.Call(ast.Name(name)) as call) if self.returns.get(name, 1) > 1:
                    yield f"{self._call(call, 'out')};"
                    yield "return;"
                case ast.Return(ast.expr() as value):
                    yield f"return {self.expression(value)};"
                case _:
                    raise ValueError(f"cannot be printed: {ast.unparse(node)}")

    def _call(self, call: ast.Call, target: str) -> str:
        return f"{self.expression(call)[:-1]}{', ' if call.args else ''}{target})"

    def _parallel(self, targets: list[ast.expr], values: list[ast.expr]) -> Iterator[str]:
        """Assign one by one, through copies if a value uses an earlier target."""
        names = [self.expression(target) for target in targets]
        used = [{leaf.id for leaf in ast.walk(value) if isinstance(leaf, ast.Name)} for value in values]
        if any(name in later for n, name in enumerate(names) for later in used[n + 1 :]):
            yield "{"
            for n, value in enumerate(values):
                yield f"    const double next{n} = {self.expression(value)};"
            yield from (f"    {name} = next{n};" for n, name in enumerate(names))
            yield "}"
        else:
            yield from (f"{name} = {self.expression(value)};" for name, value in zip(names, values, strict=True))


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
    """Return C source with long lines folded at spaces; C does not care where."""
    lines = []
    for line in text.splitlines():
        indent = line[: len(line) - len(line.lstrip())]
        long = len(line) > EXPORT_WIDTH + 8 and not line.lstrip().startswith("*")
        folded = textwrap.wrap(line, EXPORT_WIDTH, subsequent_indent=f"{indent}    ", break_long_words=False)
        lines += folded if long else [line]
    return "\n".join(lines) + "\n"


def indented(lines: Iterator[str]) -> Iterator[str]:
    """Yield lines one level deeper."""
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
