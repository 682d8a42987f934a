"""The table of notation, and the symbols that LaTeX mathematics uses: none is left without a definition."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple


class Entry(NamedTuple):
    """A row of the table.

    Attributes
    ----------
    shown : str
        The symbols, as LaTeX between dollars.
    meaning : str
    where : str
        Reference to where it is defined.
    family : str
        Regular expression of further symbols that the row stands for, such as those with another index.
    """

    shown: str
    meaning: str
    where: str
    family: str = ""


HEADS = ("symbol", "meaning", "")

INDEX = r"(?:i|i\+1|j|m|\d|\d\d)"
NOTATION = (
    Entry(r"$m$, $c$, $k$", "mass, damping coefficient, stiffness of the spring", r"\eqref{eq:motion-newton}"),
    Entry(
        r"$A_0$, $B_0$, $\Omega$", "constant part, amplitude and frequency of the drive", r"\eqref{eq:motion-newton}"
    ),
    Entry(
        r"$v_\lambda$, $\mu_\lambda$, $F_N$",
        r"speed and friction coefficient of belt $\lambda$, normal force",
        r"Definition~\ref{thm:motion-coulomb}",
        r"v_(?:[12]|\\lambda'|\\lambda\^\{\\pm\})|\\mu_(?:[12]|3-\\lambda)",
    ),
    Entry(
        r"$x$, $\dot{x}$, $\ddot{x}$", "position, velocity and acceleration of the mass", r"\eqref{eq:motion-newton}"
    ),
    Entry(r"$t$, $\theta$", r"time, phase $\Omega t$ of the drive, modulo $2\pi$", r"Definition~\ref{thm:maps-planes}"),
    Entry(r"$\lambda$, $\lambda'$", r"a belt, 1 or 2; the belt where a flight ends", r"Table~\ref{tab:maps-maps}"),
    Entry(r"$\alpha$", "a domain, 1, 2 or 3", r"\eqref{eq:motion-domain}"),
    Entry(
        r"$T_\lambda$, $T$", r"friction of belt $\lambda$ on the mass; of both", r"\eqref{eq:motion-newton}", r"T_[12]"
    ),
    Entry(
        r"$\Omega_\alpha$, $\partial\Omega_{12}$",
        "domains and boundaries of the phase plane",
        r"Table~\ref{tab:motion-constants}",
        r"\\Omega_(?:[123]|\\lambda|\\lambda\+1|12|23)",
    ),
    Entry(r"$A_\alpha$", "constant part of all forces in a domain", r"Table~\ref{tab:motion-constants}", r"A_[123]"),
    Entry(
        r"$F^{(\alpha)}$",
        "acceleration in a domain",
        r"\eqref{eq:motion-acceleration}",
        r"(?:F|\\dot\{F\})\^\{\((?:[123]|\\alpha|\\lambda|\\lambda\+1)\)\}",
    ),
    Entry(
        r"$F_{s\lambda}$",
        r"all forces on a mass on belt $\lambda$ but that belt's friction",
        r"Proposition~\ref{thm:motion-held}",
        r"F_(?:s1|s2)",
    ),
    Entry(
        r"$x_i$, $\dot{x}_i$, $\ddot{x}_i$, $t_i$, $\theta_i$",
        "state at the start of a flight or stick, or at a switching point",
        r"Theorem~\ref{thm:domains-flow}",
        rf"(?:x|\\theta|t|\\dot\{{x\}}|\\ddot\{{x\}})_{INDEX}",
    ),
    Entry(
        r"$\tau$",
        "time since the start of a flight or stick",
        r"Definition~\ref{thm:domains-basis}",
        rf"\\tau_(?:{INDEX}|n)",
    ),
    Entry(r"$L$", r"the operator $d^2/d\tau^2 + (c/m)\,d/d\tau + k/m$", r"Definition~\ref{thm:domains-basis}"),
    Entry(
        r"$E_0$, $E_1$, $E_2$, $R_2$, $I_2$",
        "basis functions of all motions",
        r"Definition~\ref{thm:domains-basis}",
        r"\\dot\{[ERI]\}_[012]",
    ),
    Entry(r"$\kappa$, $\Delta$", r"$k/m - \Omega^2$, and $\kappa^2 + (c\Omega/m)^2$", r"\eqref{eq:domains-kappa}"),
    Entry(
        r"$h$, $\omega_d$, $\eta$, $\omega_0$",
        "decay rate, damped frequency, overdamped rate, undamped frequency",
        r"\eqref{eq:domains-h}",
    ),
    Entry(r"$C_1$, $C_2$, $D_1$, $D_2$", "constants of the form that papers print", r"\eqref{eq:domains-paper}"),
    Entry(
        r"$G^{(j,\alpha)}$",
        "G-functions: derivatives of $F^{(\\alpha)}$ along the flow",
        r"Definition~\ref{thm:switching-G}",
        r"G\^\{\((?:[0-3]|n|j),(?:[123]|\\alpha|\\lambda|\\lambda\+1)\)\}",
    ),
    Entry(
        r"$\mathbf{x}^{(\alpha)}$, $\mathbf{x}^{(0)}$, $\mathbf{n}$, $D$",
        "flows of a domain and in a boundary, its normal, a derivative along the latter",
        r"Definition~\ref{thm:switching-G}",
        r"(?:\\dot|\\ddot)?\{?\\mathbf\{x\}\}?(?:\^\{\((?:\\alpha|0)\)\})?|\\mathbf\{[xn]\}(?:\^T)?|D_\\mathbf\{x\}.*",
    ),
    Entry(
        r"$\Sigma^0_{(\lambda)}$, $\Sigma^1_{(\lambda)}$, $\Sigma^2_{(\lambda)}$",
        "switching planes",
        r"Definition~\ref{thm:maps-planes}",
        r"\\Sigma(?:\^[012])?_\((?:[12]|\\lambda)\)",
    ),
    Entry(r"$P_1, \ldots, P_8$", "basic mappings", r"Table~\ref{tab:maps-maps}", r"P_\d+|P_j"),
    Entry(r"$f_1$, $f_2$", "governing equations of a mapping", r"Theorem~\ref{thm:maps-flight}"),
    Entry(
        r"$\Phi$, $\Psi_j$, $S$, $M$, $\rho_j$, $\mathcal{T}$",
        "matrices of a flight and a piece, saltation and monodromy matrix, multipliers, period",
        r"Theorem~\ref{thm:jacobians-monodromy}",
        r"\\Phi_\d\d|\\Psi_(?:\d|n)|S_(?:\d|n|j)|\\rho(?:_(?:\d|1,2))?",
    ),
    Entry(
        r"$F^{-}$, $F^{+}$, $\delta$",
        "accelerations before and after a crossing, a small change",
        r"Theorem~\ref{thm:jacobians-saltation}",
        r"F\^\{[+-]\}_j|F\^\{\\pm\}|\\mathbf\{f\}\^\{?(?:[+-]|\\pm)\}?|\\dot\{x\}\^\{[+-]\}",
    ),
    Entry(
        r"$\gamma$, $a$, $\Theta^{\mathrm{cr}}$",
        r"$k v_\lambda/m$, $B_0\Omega/m$, critical phase",
        r"Lemma~\ref{thm:grazing-contact}",
    ),
    Entry(
        r"$t_m$, $x_m$, $\theta_m$, $\sigma$",
        "time, position, phase of a contact, and its side",
        r"Definition~\ref{thm:grazing-graze}",
        r"t_\{?m[+-]\}?",
    ),
    Entry(r"$g$", r"gap $\dot{x} - v_\lambda$", r"Lemma~\ref{thm:events-gap}", r"(?:\\dot|\\ddot)\{g\}|g\^\{\(\d\)\}"),
    Entry(
        r"$\varphi$, $q$, $w$, $u$, $V$, $V_0$, $C_4$, $p$",
        "helpers of the event search, each defined in its theorem",
        r"Chapter~\ref{sec:events}",
        r"(?:\\dot|\\ddot)\{(?:\\varphi|q|w)\}|u\^\{\(\d\)\}|V\^\{\(\d\)\}|\\varphi\^\{-1\}|K|\\delta|\\tau\^\*|s",
    ),
    Entry(
        r"$y$, $W$, $d$, $H_\lambda$, $\ell$",
        "difference of two motions, its energy, a distance, a constant force, a length",
        r"Theorem~\ref{thm:orbits-unique}",
        r"(?:\\dot|\\ddot)\{y\}|W_\\infty|H_1|\\tilde\{[Txw]\}|[xT]\^\*|\\dot\{x\}\^\*|\\dot\{W\}",
    ),
    Entry(
        r"$G^{(j)}$, $\Sigma^j$, $x^{(i)}$, $\partial\Omega_{ij}$, $\varphi_{ij}$",
        "in the list of errata, as in the paper: of one domain or belt; a boundary and its equation",
        r"Chapter~\ref{sec:errata}",
        r"G\^\{\([0-3]\)\}|\\Sigma(?:\^[012])?|(?:\\dot\{x\}|x)\^\{\([01i]\)\}|\\Omega_ij|\\varphi_ij|t_\\pm|"
        r"v_\\lambda\^\{[+-]\}|\\varepsilon",
    ),
    Entry(
        r"$P$, $F$, $x_f$, $r$",
        r"amplitude of the drive, friction, $F/k$, $\Omega\sqrt{m/k}$",
        r"Chapter~\ref{sec:literature}",
    ),
    Entry(
        r"$Q$, $G$, $H$, $p_0$, $q_0$, $T$, $D$, $U$, $S$, $B$, $\chi$, $T_h$, $D_h$, $\Delta x$, $L$, $\bar{x}$",
        "there only: parts of the symmetric motion and of its half period, Den Hartog's letters, a growth, a loss, a "
        "middle",
        r"Chapter~\ref{sec:literature}",
        r"(?:\\dot\{u\}|u)_0|\\d?dot\{u\}|[BSd]_\*|\\ddot\{x\}_[+-]|\\delta_[+]|\\mathrm\{d\}|x_(?:[+-]|\\max|\\min|f)",
    ),
    Entry(
        r"$f$, $P$, $X$, $B$, $J$, $Y$, $D$, $E$, $R$, $C$, $q$, $a$, $b$, $N$",
        "in proofs by balls, each defined where it stands: maps, boxes and matrices, helpers, points, periods",
        r"Chapter~\ref{sec:certificates}",
        r"[fg]'{1,3}|[CSq]'{1,2}|[abcey]_[ij]|D_ij|y\^\*|P\^n|\\\||\\sum_j|\\max_i",
    ),
)

#: What every reader knows: numbers, operations, functions, letters that only count, and signs.
KNOWN = re.compile(
    r"e|i|j|n|d|\\pi|s|z|\\epsilon|I|\\infty|\\mathbb\{R\}(?:\^\{?n\}?)?|T|w|\\ell"
    r"|\\(?:sin|cos|tan|sinh|cosh|arcsin|det|lim|operatorname\{\w+\}|mathrm\{mod\}|partial|nabla|int|prod|max|min|ldots|cdots)"
)
#: Commands that are no symbols: spaces, brackets, relations, layout.
SILENT = (
    r"\\(?:left|right|[bB]igg?[lr]?|frac|tfrac|dfrac|sqrt|quad|qquad|text|notag|label|markit|displaystyle|in|ne|le|ge|to|"
    r"pm|cdot|cup|circ|colon|mapsto|varnothing|subset|times|tilde|begin|end|mathrm|operatorname|limits|hspace|"
    r"[,;:!| {}\\])"
)
TOKEN = re.compile(r"\\[a-zA-Z]+|\\.|\d+(?:\.\d+)?|[a-zA-Z]|[{}^_']|.", re.DOTALL)
ACCENTS = (r"\dot", r"\ddot", r"\tilde", r"\bar", r"\mathbf", r"\mathbb", r"\mathcal")


def rows() -> list[tuple[str, str, str]]:
    """Return the table's rows as LaTeX texts."""
    return [(entry.shown, entry.meaning, entry.where) for entry in NOTATION]


def latex_table() -> str:
    """Return the table as LaTeX."""
    lines = [" & ".join(row) + r" \\" for row in rows()]
    return "\n".join(
        [
            r"\section*{Notation}\label{sec:notation}",
            r"{\small\noindent\begin{tabular}{@{}p{42mm}p{80mm}l@{}}",
            r"\hline",
            *lines,
            r"\hline\end{tabular}}",
        ]
    )


def defined(symbol: str) -> bool:
    """Tell whether the table (or common knowledge) defines a symbol as `symbols` returns it."""
    if KNOWN.fullmatch(symbol) or symbol in _listed():
        return True
    return any(entry.family and re.fullmatch(entry.family, symbol) for entry in NOTATION)


def _listed() -> set[str]:
    return {symbol for entry in NOTATION for math in re.findall(r"\$(.*?)\$", entry.shown) for symbol in symbols(math)}


def symbols(math: str) -> Iterator[str]:
    """Yield the symbols of LaTeX mathematics, with accents and indices; powers are left out."""
    math = re.sub(r"\\(?:text|label|markit|texttt|emph)\{(?:[^{}$]|\$[^$]*\$|\{[^{}]*\})*\}", " ", math)
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
        symbol, place = token, place + 1
    while place < len(tokens) and tokens[place] in "^_'":
        if tokens[place] == "'":
            symbol, place = symbol + "'", place + 1
            continue
        script, after = _group(tokens, place + 1)
        if tokens[place] == "_" and symbol != r"\int" and not symbol.startswith((r"\lim", r"\prod", r"\max")):
            symbol += f"_{script}"
        elif tokens[place] == "^" and re.fullmatch(r"\(.*\)|\\mathrm\{.*\}|[+-]|\\pm|\*|[01T](?=$)", script):
            symbol += f"^{script}" if script in "01T*" else f"^{{{script}}}"
        elif not re.fullmatch(r"[\d\w+\-/\\]*", script):
            pass  # a power; its symbols are read where they stand
        place = after if _is_script(script) else place + 1
    return symbol, place


def _is_script(script: str) -> bool:
    """Tell whether a script was taken as a whole; the symbols of longer powers are read one by one."""
    return len(script) <= 12 or script.startswith("(")


def _group(tokens: list[str], place: int) -> tuple[str, int]:
    if tokens[place] != "{":
        if tokens[place] in (r"\mathbf", r"\mathrm"):
            inner, after = _group(tokens, place + 1)
            return f"{tokens[place]}{{{inner}}}", after
        return tokens[place], place + 1
    depth, text = 1, ""
    place += 1
    while depth:
        depth += {"{": 1, "}": -1}.get(tokens[place], 0)
        text += tokens[place] if depth else ""
        place += 1
    return text, place
