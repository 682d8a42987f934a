"""What stands before the chapters: preamble, title, abstract, and how to cite."""

from __future__ import annotations

import symosc
from symosc.derive.citation import SYMOSC, paper_reference
from symosc.derive.scope import Scope

TITLE = "The double-belt friction oscillator: theory, proofs and errata"
ABSTRACT = (
    r"A mass on a spring and a damper is driven periodically and pressed between two belts that run at different "
    r"speeds. This supplement derives its motion from the balance of forces and the set-valued law of friction: the "
    r"closed form in every regime of damping, what happens at a belt's speed, sticks and their two ends, the mappings "
    r"between the switching planes and their derivatives, grazing with all of its cases, an event search that misses "
    r"nothing, the one periodic motion that attracts, why there is no chaos, and where the word of a motion changes. "
    r"It restates, proves and where needed corrects what is in the paper \cite{chen2016}: "
    + paper_reference(r"\emph{{{}}}", "~", "--")
    + "."
)
LEGEND = (
    "Each displayed formula was checked by machine before it was printed, and the letter behind its number says how: "
    r"\textsc{e}, exactly, by computer algebra; \textsc{s}, an inequality decided from the signs of its letters "
    r"or from exact numbers; \textsc{n}, numerically with 50 digits, at the root that is meant or to the last printed "
    r"decimal. The same letters, raised, stand behind sentences and captions whose facts were checked. "
    r"Where the text says \emph{the paper}, it is \cite{chen2016}, and equation numbers with \emph{the paper's} are "
    r"its numbers."
)
#: Only packages that LaTeX's smallest installations have. \markit before the end of a row sets the letter that stands
#: behind its number. Tables and figures stay in their chapter: those that still wait stand above the title of the next
#: one, and none of that one does.
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
\makeatletter
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
\theoremstyle{definition}\newtheorem{definition}{Definition}[section]
\theoremstyle{plain}\newtheorem{lemma}[definition]{Lemma}
\theoremstyle{plain}\newtheorem{proposition}[definition]{Proposition}
\theoremstyle{plain}\newtheorem{theorem}[definition]{Theorem}
\theoremstyle{plain}\newtheorem{corollary}[definition]{Corollary}
\theoremstyle{definition}\newtheorem{remark}[definition]{Remark}
\theoremstyle{definition}\newtheorem{example}[definition]{Example}
"""
NOTATION_TABLE = r"""\section*{Notation}\label{sec:notation}
{\small\noindent\begin{tabular}{@{}p{42mm}p{80mm}l@{}}
\hline
ROWS
\hline\end{tabular}}"""


def how_to_cite() -> str:
    """Return the LaTeX text that says how to cite symosc and this document."""
    return (
        rf"symosc {symosc.__version__}, {SYMOSC['year']}. Cite as: {SYMOSC['author'].strip('{}')}, "
        rf"\emph{{{SYMOSC['title']}}}, version {symosc.__version__}, {SYMOSC['year']} \cite{{symosc}}; the supplement "
        rf"as \emph{{{TITLE}}}, supplement to symosc {symosc.__version__}. "
        r"\texttt{symosc -{}-cite} prints BibTeX of symosc and the paper; \texttt{references.bib} has all references."
    )


def title_page() -> str:
    """Return the LaTeX of the document's title with author, version and how to cite."""
    author, title = SYMOSC["author"].strip("{}"), TITLE.replace(": ", r":\\ ")
    return rf"""\title{{{title}}}
\author{{{author}}}
\date{{Version {symosc.__version__}, {SYMOSC["year"]}}}
\hypersetup{{pdftitle={{{TITLE}}},pdfauthor={{{author}}}}}
\begin{{document}}
\maketitle
\begin{{abstract}}\noindent {ABSTRACT}\end{{abstract}}
{LEGEND}

{how_to_cite()}"""


def scene_numbers(scope: Scope) -> str:
    """Return a sentence that lists the parameters of the scope's scene, or "" without a scene."""
    if scope.scene is None:
        return ""
    numbers = ", ".join(f"${name} = {value}$" for name, value in scope.table())
    return rf"Scene \texttt{{{scope.scene.name}}}, its numbers put in exactly: {numbers}."
