"""The main document: preamble, title page, notation, contents, the chapters and the references."""

from __future__ import annotations

import symosc
from symosc.derive.citation import SYMOSC, cited, paper_reference, reference_list
from symosc.derive.notation import NOTATION
from symosc.derive.scope import Scope
from symosc.derive.steps import KINDS

TITLE = "The double-belt friction oscillator: theory, proofs and errata"
ABSTRACT = (
    r"A mass on a spring and a damper is driven periodically and pressed between two belts that run at different "
    r"speeds. This supplement derives its motion from the balance of forces and the set-valued law of friction: the "
    r"closed form in every regime of damping, what happens at a belt's speed, sticks and their two ends, the mappings "
    r"between the switching planes and their derivatives, grazing with all of its cases, uniqueness and stability of "
    r"periodic motions, and an event search that misses nothing. It restates, proves and where needed corrects what is "
    r"in the paper \cite{chen2016}: " + paper_reference(r"\emph{{{}}}", "~", "--") + "."
)
LEGEND = (
    "Each displayed formula was checked by machine before it was printed, and the letter behind its number says how: "
    r"\textsc{e}, exactly, by computer algebra; \textsc{s}, an inequality decided from the signs of its letters "
    r"or from exact numbers; \textsc{n}, numerically with 50 digits, at the root that is meant or to the last printed "
    r"decimal. The same letters, raised, stand behind sentences and captions whose facts were checked. "
    r"Where the text says \emph{the paper}, it is \cite{chen2016}, and equation numbers with \emph{the paper's} are "
    r"its numbers."
)
#: Only packages that LaTeX's smallest installations have.
PREAMBLE = r"""\documentclass[11pt,a4paper]{article}
\IfFileExists{lmodern.sty}{\usepackage[T1]{fontenc}\usepackage{lmodern}}{}
\usepackage{amsmath,amssymb,amsthm}
\usepackage{graphicx}
\usepackage[margin=25mm]{geometry}
\usepackage[hidelinks,bookmarks=false]{hyperref}
\allowdisplaybreaks
\numberwithin{equation}{section}
\numberwithin{table}{section}
\numberwithin{figure}{section}
\setlength{\emergencystretch}{3em}
\setlength{\parindent}{0pt}
\setlength{\parskip}{5pt plus 2pt}
\raggedbottom
\setlength{\belowcaptionskip}{3pt}
\renewcommand{\topfraction}{0.9}
\setcounter{topnumber}{4}
\renewcommand{\floatpagefraction}{0.8}
\setcounter{tocdepth}{1}
"""
#: Marks: \markit before the end of a row sets the letter that stands behind its number. Tables and figures stay in
#: their chapter: those that still wait stand above the title of the next one, and none of that one does.
MACROS = r"""\makeatletter
\newcommand{\ifwaiting}[1]{%
  \begingroup\let\@elt\relax\edef\waiting{\@deferlist}\expandafter\endgroup\ifx\waiting\@empty\else#1\fi}
\newcommand{\newchapter}[1]{\par\ifwaiting{\newpage\ifwaiting{\clearpage}}\suppressfloats[t]\setcounter{section}{#1}}
\newcommand{\symoscmark}{}
\newcommand{\markit}[1]{\gdef\symoscmark{\,\normalfont\textsc{#1}}}
\def\tagform@#1{\maketag@@@{(\ignorespaces#1\unskip\symoscmark\@@italiccorr)}}
\makeatother
\renewcommand{\eqref}[1]{\textup{(\ref{#1})}}
\newcommand{\checkedby}[1]{\textsuperscript{\normalfont\textsc{\,#1}}}
\newcommand{\drawing}[2]{\IfFileExists{#2}{\includegraphics[width=#1\linewidth]{#2}}%
  {\fbox{\texttt{symosc derive all -{}-pdf} draws this figure}}}
"""


def theorems() -> str:
    """Return the definitions of the numbered environments."""
    lines = []
    for kind in KINDS[:-1]:
        style = "plain" if kind in ("theorem", "lemma", "proposition", "corollary") else "definition"
        count = f"{{{kind.title()}}}[section]" if kind == "definition" else f"[definition]{{{kind.title()}}}"
        lines.append(rf"\theoremstyle{{{style}}}\newtheorem{{{kind}}}{count}")
    return "\n".join(lines) + "\n"


def how_to_cite() -> str:
    """Return how to cite symosc and this document."""
    return (
        rf"symosc {symosc.__version__}, {SYMOSC['year']}. Cite as: {SYMOSC['author'].strip('{}')}, "
        rf"\emph{{{SYMOSC['title']}}}, version {symosc.__version__}, {SYMOSC['year']} \cite{{symosc}}; the supplement "
        rf"as \emph{{{TITLE}}}, supplement to symosc {symosc.__version__}. "
        r"\texttt{symosc -{}-cite} prints BibTeX of symosc and the paper; \texttt{references.bib} has all references."
    )


def title_page() -> str:
    """Return the title with author, version and how to cite."""
    author = SYMOSC["author"].strip("{}")
    return "\n".join(
        [
            rf"\title{{{TITLE.replace(': ', ':' + chr(92) * 2 + ' ')}}}",
            rf"\author{{{author}}}",
            rf"\date{{Version {symosc.__version__}, {SYMOSC['year']}}}",
            rf"\hypersetup{{pdftitle={{{TITLE}}},pdfauthor={{{author}}}}}",
            r"\begin{document}",
            r"\maketitle",
            rf"\begin{{abstract}}\noindent {ABSTRACT}\end{{abstract}}",
            LEGEND,
            "",
            how_to_cite(),
        ]
    )


def scene_numbers(scope: Scope) -> str:
    """Return a sentence with the numbers of the scope's scene, or nothing."""
    if scope.scene is None:
        return ""
    numbers = ", ".join(f"${name} = {value}$" for name, value in scope.table())
    return rf"Scene \texttt{{{scope.scene.name}}}, its numbers put in exactly: {numbers}."


def notation_latex() -> str:
    """Return the table of notation as LaTeX."""
    lines = [" & ".join(row) + r" \\" for row in NOTATION]
    head = r"\section*{Notation}\label{sec:notation}", r"{\small\noindent\begin{tabular}{@{}p{42mm}p{80mm}l@{}}"
    return "\n".join([*head, r"\hline", *lines, r"\hline\end{tabular}}"])


def document(inputs: list[tuple[int, str]], scope: Scope, notation: str, texts: str) -> str:
    """Return the document that reads in some files, each a chapter with its number; `texts` is what cites references.

    The chapters keep the numbers that they have in the whole book.
    """
    head = title_page()
    out = [PREAMBLE + MACROS + theorems() + head, *([scene_numbers(scope)] if scope.scene else [])]
    if notation:
        out += [r"{\setlength{\parskip}{0pt}\tableofcontents}", notation]
    out += [rf"\newchapter{{{number - 1}}}" + f"\n\\input{{{path}}}" for number, path in inputs]
    references = reference_list(cited(head + notation + texts))
    return "\n\n".join([*out, rf"\newchapter{{{inputs[-1][0]}}}", references, r"\end{document}"]) + "\n"
