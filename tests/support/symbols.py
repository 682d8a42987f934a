"""The symbols that LaTeX mathematics uses.

The tests leave none without a definition in the table of notation.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from symosc.derive.front import NOTATION

#: Symbols that rows of the table stand for besides those that are listed, such as others with an
#: index.
INDEXED = re.compile(
    r"\\mu_s[12]|v_(?:[12]|\\lambda'|\\lambda\^\{\\pm\})|\\mu_(?:[12]|3-\\lambda)|"
    r"T_[12]|"
    r"\\Omega_(?:[123]|\\lambda|\\lambda\+1|12|23)|"
    r"A_[123]|"
    r"(?:F|\\dot\{F\})\^\{\((?:[123]|j|j\+1|\\alpha|\\lambda|\\lambda\+1)\)\}|"
    r"F_(?:s1|s2)|"
    r"(?:x|\\theta|t|\\dot\{x\}|\\ddot\{x\})_(?:i|i\+1|j|m|\d|\d\d)|"
    r"\\tau_(?:(?:i|i\+1|j|m|\d|\d\d)|n)|"
    r"\\dot\{[ERI]\}_[012]|"
    r"G\^\{\((?:-1|[0-3]|n|n-[12]|j),(?:[123]|j|\\alpha|\\lambda|\\lambda\+1)\)\}|"
    r"[Ac]_j\+1|[ac]_[12]|v_n|\\dot\{(?:Q|\\rho)\}|\\dot\{y\}_\\max|\\sum_\\lambda|"
    r"(?:\\dot|\\ddot)?\{?\\mathbf\{x\}\}?(?:\^\{\((?:\\alpha|0)\)\})?|\\mathbf\{[xn]\}(?:\^T)?|"
    r"D_\\mathbf\{x\}.*|"
    r"\\Sigma(?:\^[012])?_\((?:[12]|\\lambda)\)|"
    r"P_\d+|P_j|"
    r"\\Phi_\d\d|\\Psi_(?:\d|n)|S_(?:\d|n|j)|\\rho(?:_(?:\d|1,2))?|"
    r"F\^\{[+-]\}_j|F\^\{\\pm\}|\\mathbf\{f\}\^\{?(?:[+-]|\\pm)\}?|\\dot\{x\}\^\{[+-]\}|"
    r"t_\{?m[+-]\}?|"
    r"(?:\\dot|\\ddot)\{g\}|g\^\{\(\d\)\}|"
    r"(?:\\dot|\\ddot)\{(?:\\varphi|q|w)\}|u\^\{\(\d\)\}|V\^\{\(\d\)\}|\\varphi\^\{-1\}|K|\\delta|"
    r"\\tau\^\*|s|"
    r"(?:\\dot|\\ddot)\{y\}|W_\\infty|H_1|\\tilde\{[Txwy]\}|[xT]\^\*|\\dot\{x\}\^\*|\\dot\{W\}|"
    r"G\^\{\([0-3]\)\}|\\Sigma(?:\^[012])?|(?:\\dot\{x\}|x)\^\{\([01i]\)\}|\\Omega_ij|\\varphi_ij|"
    r"t_\\pm|v_\\lambda\^\{[+-]\}|\\varepsilon|"
    r"(?:\\dot\{u\}|u)_0|\\d?dot\{u\}|[BSd]_\*|\\ddot\{x\}_[+-]|\\delta_[+]|\\mathrm\{d\}|x_(?:[+-]|\\max|\\min|f)|"
    r"x\^\{\+\}|[px]_n|B_1|\\ddot\{z\}|"
    r"(?:\\dot|\\ddot)\{r\}|\\dot\{[Uz]\}|\\tilde\{f\}|t\^\*|t_[2c]|v_[+-]|z_(?:1|2|\\infty)|"
    r"\\ddot\{F\}\^\{\(\\alpha\)\}|M_\d\d|\\epsilon_[+-]|"
    r"[hv]_(?:0|1|2)|\\omega_[12]|\\d?dot\{(?:X|\\psi)\}|x_p'|N_n-[13]|a_N|"
    r"(?:\\xi|\\theta|a|b)'{1,2}|\\xi_0|a_0(?:\^\{[+]\})?|t_0|S_n-1|"
    r"[fg]'{1,3}|[CSq]'{1,2}|[abcey]_[ij]|D_ij|y\^\*|P\^n|\\\||\\sum_j|\\max_i"
)
#: What every reader knows: numbers, operations, functions, letters that only count, and signs.
KNOWN = re.compile(
    r"e|i|j|n|d|\\pi|s|z|\\epsilon|I|\\infty|\\mathbb\{R\}(?:\^\{?n\}?)?|T|w|\\ell"
    r"|\\(?:sin|cos|tan|sinh|cosh|coth|arcsin|arctan|ln|det|lim|limsup|operatorname\{\w+\}|mathrm\{mod\}|partial|nabla|int|prod|supset|max|min|ldots|cdots)"
)
#: Commands that are no symbols: spaces, brackets, relations, layout.
SILENT = (
    r"\\(?:left|right|[lr]floor|[bB]igg?[lr]?|frac|tfrac|dfrac|sqrt|quad|qquad|text|notag|label|markit|displaystyle|in|ne|le|ge|to|"
    r"pm|cdot|cup|circ|colon|mapsto|varnothing|subset|times|tilde|begin|end|mathrm|operatorname|limits|hspace|"
    r"[,;:!| {}\\])"
)
TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|\d+(?:\.\d+)?|[a-zA-Z]|[{}^_']|.", re.DOTALL)
ACCENTS = (r"\dot", r"\ddot", r"\tilde", r"\bar", r"\mathbf", r"\mathbb", r"\mathcal")


def defined(symbol: str) -> bool:
    """Tell whether the table (or common knowledge) defines a symbol as `symbols` returns it."""
    return bool(KNOWN.fullmatch(symbol) or INDEXED.fullmatch(symbol)) or symbol in listed()


def listed() -> set[str]:
    """Return the symbols in the first column of the table."""
    return {
        symbol
        for row in NOTATION
        for math in re.findall(r"\$(.*?)\$", row[0])
        for symbol in symbols(math)
    }


def symbols(math: str) -> Iterator[str]:
    """Yield the symbols of LaTeX mathematics, with accents and indices; powers are left out."""
    math = re.sub(
        r"\\(?:text|label|markit|texttt|emph)\{(?:[^{}$]|\$[^$]*\$|\{[^{}]*\})*\}", " ", math
    )
    tokens = [token for token in TOKEN.findall(math) if not token.isspace()]
    place = 0
    while place < len(tokens):
        symbol, place = _symbol(tokens, place)
        if symbol:
            yield symbol


def _symbol(tokens: list[str], place: int) -> tuple[str, int]:
    token = tokens[place]
    if token in (r"\operatorname", r"\mathrm") or token in ACCENTS:
        inner, place = _group(tokens, place + 1)
        symbol = f"{token}{{{inner}}}"
    elif re.fullmatch(SILENT, token) or not re.match(r"[a-zA-Z\\]", token):
        return "", place + 1
    else:
        symbol = token
        place = place + 1
    while place < len(tokens) and tokens[place] in "^_'":
        if tokens[place] == "'":
            symbol = symbol + "'"
            place = place + 1
            continue
        script, after = _group(tokens, place + 1)
        if (
            tokens[place] == "_"
            and symbol != r"\int"
            and not symbol.startswith((r"\lim", r"\prod", r"\max"))
        ):
            symbol += f"_{script}"
        elif tokens[place] == "^" and re.fullmatch(
            r"\(.*\)|\\mathrm\{.*\}|[+-]|\\pm|\*|[01T](?=$)", script
        ):
            if script in "01T*":
                symbol += f"^{script}"
            else:
                symbol += f"^{{{script}}}"
        elif not re.fullmatch(r"[\d\w+\-/\\]*", script):
            pass  # a power; its symbols are read where they stand
        if _is_script(script):
            place = after
        else:
            place = place + 1
    return symbol, place


def _is_script(script: str) -> bool:
    """Tell whether a script was taken as a whole.

    The symbols of longer powers are read one by one.
    """
    return len(script) <= 12 or script.startswith("(")


def _group(tokens: list[str], place: int) -> tuple[str, int]:
    if tokens[place] != "{":
        if tokens[place] in (r"\mathbf", r"\mathrm"):
            inner, after = _group(tokens, place + 1)
            return f"{tokens[place]}{{{inner}}}", after
        return tokens[place], place + 1
    depth = 1
    text = ""
    place += 1
    while depth:
        depth += {"{": 1, "}": -1}.get(tokens[place], 0)
        if depth:
            text += tokens[place]
        else:
            text += ""
        place += 1
    return text, place
