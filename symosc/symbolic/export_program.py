"""What a mapping structure needs of the kernels, as Python syntax trees: cut, folded and in order.

The library's own source is read, so that nothing is written twice. With fixed parameters their constants become names
of numbers, the branches that these decide are cut, and so is what nothing calls any more.
"""

from __future__ import annotations

import ast
import inspect
import re
from dataclasses import dataclass
from typing import Any

from symosc.aliases import Record
from symosc.engine.flow import constants
from symosc.kernels import _generated, entire, entire_array, mapping
from symosc.model import NEIGHBOURS, Parameters
from symosc.words import Map, Word

SETTINGS = ("EPS", "SERIES_BELOW", "APART_ABOVE", "TERMS")
FLAGS = ("under", "apart")

#: `symosc.engine.flow.constants` in double precision, in the syntax that can be printed.
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
apart = under and p * p + q * q >= 0.04 * larger * larger
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
class Program:
    """What is to be printed.

    Attributes
    ----------
    word : Word
    functions : dict
        Syntax trees by name, each after those that it calls.
    maps : list of str
        The functions of the word's mappings, in order of time: "P2", "P4_above", ...; their Jacobians end in _jacobian.
    fields : list of str
        Names of the constants that are used.
    values : dict or None
        Their values, if the parameters are fixed.
    settings : dict
        Thresholds that the kernels use.
    parameters : Parameters or None
        The fixed parameters.
    """

    word: Word
    functions: dict[str, ast.FunctionDef]
    maps: list[str]
    fields: list[str]
    values: Record | None
    settings: dict[str, float]
    parameters: Parameters | None

    def returns(self) -> dict[str, int]:
        """Return how many numbers each function returns."""
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

    def setup(self) -> list[ast.Assign]:
        """Return the assignments that compute the fields from the parameters."""
        needed, kept = set(self.fields), []
        for name, node in reversed(_setup_steps().items()):
            if name in needed:
                kept.append(node)
                needed |= {leaf.id for leaf in ast.walk(node.value) if isinstance(leaf, ast.Name)}
        return kept[::-1]


def _setup_steps() -> dict[str, ast.Assign]:
    """Return the assignments of SETUP by the name that each defines."""
    return {ast.unparse(node.targets[0]): node for node in ast.parse(SETUP).body if isinstance(node, ast.Assign)}


def program(word: Word, arrays: bool, fix: Parameters | None) -> Program:
    """Collect the functions that a word needs; for numpy arrays or for numbers, with or without fixed parameters."""
    K = constants(fix) if fix else None
    known = {} if K is None else {f"K.{flag}": getattr(K, flag) for flag in FLAGS}
    if K is not None and K.rate0 == K.rate:
        known["K.rate0 * tau < SERIES_BELOW"] = False  # where it is asked, rate * tau is not
        known["slow.any()"] = False
    if K is not None and K.apart and K.w0 == K.rate:
        known["K.w0 * tau >= APART_ABOVE"], known["rest.any()"] = True, False
    modules = [_generated, entire_array if arrays else entire, mapping]
    fold = Fold(known, fixed=K is not None)
    trees = [_functions(inspect.getsource(module)) for module in modules]
    library = {name: fold.function(node) for tree in trees for name, node in tree.items()}
    maps: list[str] = []
    wanted: dict[str, str] = {}
    for row, exit in zip(word.maps, word.exits(), strict=True):
        for each in [exit] if exit or not row.sticks else ["below", "above"]:
            label, source = _map_source(row, each, arrays)
            wanted[label] = wanted[f"{label}_jacobian"] = source
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
    values = None if K is None else {name: _value(K, name) for name in fields}
    return Program(word, functions, maps, fields, values, settings, fix)


def _value(K: Any, name: str) -> Any:
    return getattr(K, f"belt{name[1]}").v if name in ("v1", "v2") else getattr(K, name)


def _is_K(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id == "K"


def _functions(source: str) -> dict[str, ast.FunctionDef]:
    return {node.name: node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)}


def _add(name: str, library: dict[str, ast.FunctionDef], functions: dict[str, ast.FunctionDef]) -> None:
    """Add a function after those that it calls."""
    if name in functions or name not in library:
        return
    for leaf in ast.walk(library[name]):
        if isinstance(leaf, ast.Call) and isinstance(leaf.func, ast.Name):
            _add(leaf.func.id, library, functions)
    functions[name] = library[name]


def _map_source(row: Map, exit: str | None, arrays: bool) -> tuple[str, str]:
    """Return the name of a mapping's function, and the source of it and of its Jacobian.

    For arrays, the arguments are made flat and of one length, and all results get their shape.
    """
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

def {label}_jacobian({arguments}, K):
    """Return the derivatives of f1, then of f2, by x_i, theta_i, x_j, theta_j."""
    {flattened.format(arguments)}{lines}
    return {entries}
'''
    return label, source


class Fold(ast.NodeTransformer):
    """Replaces what is known: flags, comparisons, and constants by the names of numbers.

    Parameters
    ----------
    known : dict
        Truth of conditions, by their source.
    fixed : bool
        Whether the constants are names of their own (K_cm) and no argument K is passed.
    """

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
        """Replace a condition that is known."""
        if isinstance(node, ast.expr) and ast.unparse(node) in self.known:
            return ast.Constant(self.known[ast.unparse(node)])
        return super().generic_visit(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        """Write K.name as K_name, or leave it where the constants stay a tuple."""
        if not _is_K(node.value) or ast.unparse(node) in self.known:
            return self.generic_visit(node)
        return ast.Name(f"K_{node.attr}") if self.fixed else node

    def visit_Subscript(self, node: ast.Subscript) -> ast.AST:
        """Write INVERSES[n] as 1.0/n."""
        if isinstance(node.value, ast.Name) and node.value.id == "INVERSES":
            return ast.BinOp(ast.Constant(1.0), ast.Div(), node.slice)
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        """Leave out the argument K where the constants are names of their own."""
        node_ = self.generic_visit(node)
        if self.fixed and isinstance(node_, ast.Call):
            node_.args = [argument for argument in node_.args if not _is_K(argument)]
        return node_

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.AST:
        """Leave out what is known in an `and` or `or`, or all of it if that decides."""
        values = [self.visit(value) for value in node.values]
        decides = isinstance(node.op, ast.Or)
        if any(isinstance(value, ast.Constant) and value.value is decides for value in values):
            return ast.Constant(decides)
        values = [value for value in values if not isinstance(value, ast.Constant)]
        if not values:
            return ast.Constant(not decides)
        return values[0] if len(values) == 1 else ast.BoolOp(node.op, values)

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        """Keep the branch that is taken, if that is known."""
        test = self.visit(node.test)
        if isinstance(test, ast.Constant):
            return self.visit(node.body if test.value else node.orelse)
        return ast.IfExp(test, self.visit(node.body), self.visit(node.orelse))

    def visit_If(self, node: ast.If) -> Any:
        """Keep the block that is run, if that is known."""
        test = self.visit(node.test)
        if isinstance(test, ast.Constant):
            return self._block(node.body if test.value else node.orelse)
        return ast.If(test, self._block(node.body), self._block(node.orelse))

    def _block(self, body: list[ast.stmt]) -> list[ast.stmt]:
        folded = map(self.visit, body)
        return [node for part in folded for node in (part if isinstance(part, list) else [part])]
