"""What stands before the chapters: preamble, title, abstract, how to cite, and the table of
notation.
"""

from __future__ import annotations

from collections.abc import Sequence

import symosc
from symosc.base.display.latex import latex_text
from symosc.derive.citation import SYMOSC, paper_reference
from symosc.derive.scope import Scope

TITLE = "The double-belt friction oscillator: theory, proofs and errata"
ABSTRACT = (
    r"A mass on a spring and a damper is driven periodically and pressed between two belts that "
    r"run at different speeds. This supplement derives its motion from the balance of forces and "
    r"the set-valued law of friction: the closed form in every regime of damping, what happens at "
    r"a belt's speed, sticks and their two ends, the mappings between the switching planes and "
    r"their derivatives, grazing with all of its cases, an event search that misses nothing, the "
    r"one periodic motion that attracts, why there is no chaos, what motions do without a damper, "
    r"where the word of a motion changes: the maps, the multipliers and all points of "
    r"codimension two, what changes with static friction above kinetic friction and with "
    r"friction that depends on speed, and what these open: onsets, stick-slip cycles, return "
    r"maps, chaos. It restates, proves and where needed corrects what is in "
    r"the paper \cite{chen2016}: " + paper_reference(r"\emph{{{}}}", "~", "--") + "."
)
LEGEND = (
    "Each displayed formula was checked by machine before it was printed, and the letter behind "
    "its number says how: "
    r"\textsc{e}, exactly, by computer algebra; \textsc{s}, an inequality decided from the signs "
    r"of its letters or from exact numbers; \textsc{n}, numerically with 50 digits, at the root "
    r"that is meant or to the last printed decimal. The same letters, raised, stand behind "
    r"sentences and captions whose facts were checked. Where the text says \emph{the paper}, it is "
    r"\cite{chen2016}, and equation numbers with \emph{the paper's} are its numbers."
)
#: What a chapter that is printed alone says.
ALONE = (
    r"References to other chapters have their numbers in the whole supplement, \texttt{symosc "
    r"derive all}."
)
#: Only packages that LaTeX's smallest installations have. \markit before the end of a row sets the
#: letter that stands behind its number. Tables and figures stay in their chapter: those that still
#: wait stand above the title of the next one, and none of that one does.
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
\newcommand{\letter}[2]{\symbol{92}#2}
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
#: The table of notation: heads, and rows of a symbol, its meaning, and where it is defined, in
#: LaTeX.
HEADS = ("symbol", "meaning", "")
_ROWS = r"""
$m$, $c$, $k$ & mass, damping coefficient, stiffness of the spring & \eqref{eq:motion-newton} \\
$A_0$, $B_0$, $\Omega$ & constant part, amplitude and frequency of the drive &
  \eqref{eq:motion-newton} \\
$v_\lambda$, $\mu_\lambda$, $F_N$ & speed and friction coefficient of belt $\lambda$, normal force &
  Definition~\ref{thm:motion-coulomb} \\
$x$, $\dot{x}$, $\ddot{x}$ & position, velocity and acceleration of the mass &
  \eqref{eq:motion-newton} \\
$t$, $\theta$ & time, phase $\Omega t$ of the drive, modulo $2\pi$ &
  Definition~\ref{thm:maps-planes} \\
$\lambda$, $\lambda'$ & a belt, 1 or 2; the belt where a flight ends & Table~\ref{tab:maps-maps} \\
$\alpha$ & a domain, 1, 2 or 3 & \eqref{eq:motion-domain} \\
$T_\lambda$, $T$ & friction of belt $\lambda$ on the mass; of both & \eqref{eq:motion-newton} \\
$\Omega_\alpha$, $\partial\Omega_{12}$ & domains and boundaries of the phase plane &
  Table~\ref{tab:motion-constants} \\
$A_\alpha$ & constant part of all forces in a domain & Table~\ref{tab:motion-constants} \\
$F^{(\alpha)}$ & acceleration in a domain & \eqref{eq:motion-acceleration} \\
$F_{s\lambda}$ & all forces on a mass on belt $\lambda$ but that belt's friction &
  Proposition~\ref{thm:motion-held} \\
$x_i$, $\dot{x}_i$, $\ddot{x}_i$, $t_i$, $\theta_i$ & state at the start of a flight or stick, or
  at a switching point
  & Theorem~\ref{thm:domains-flow} \\
$\tau$ & time since the start of a flight or stick & Definition~\ref{thm:domains-basis} \\
$L$ & the operator $d^2/d\tau^2 + (c/m)\,d/d\tau + k/m$ & Definition~\ref{thm:domains-basis} \\
$E_0$, $E_1$, $E_2$, $R_2$, $I_2$ & basis functions of all motions &
  Definition~\ref{thm:domains-basis} \\
$\kappa$, $\Delta$ & $k/m - \Omega^2$, and $\kappa^2 + (c\Omega/m)^2$ & \eqref{eq:domains-kappa} \\
$h$, $\omega_d$, $\eta$, $\omega_0$ & decay rate, damped frequency, overdamped rate, undamped
  frequency &
  \eqref{eq:domains-h} \\
$C_1$, $C_2$, $D_1$, $D_2$ & constants of the form that papers print & \eqref{eq:domains-paper} \\
$G^{(j,\alpha)}$ & G-functions: derivatives of $F^{(\alpha)}$ along the flow &
  Definition~\ref{thm:switching-G} \\
$\mathbf{x}^{(\alpha)}$, $\mathbf{x}^{(0)}$, $\mathbf{n}$, $D$ & flows of a domain and in a
  boundary, its normal, a
  derivative along the latter & Definition~\ref{thm:switching-G} \\
$\Sigma^0_{(\lambda)}$, $\Sigma^1_{(\lambda)}$, $\Sigma^2_{(\lambda)}$ & switching planes &
  Definition~\ref{thm:maps-planes} \\
$P_1, \ldots, P_8$ & basic mappings & Table~\ref{tab:maps-maps} \\
$f_1$, $f_2$ & governing equations of a mapping & Theorem~\ref{thm:maps-flight} \\
$\Phi$, $\Psi_j$, $S$, $M$, $\rho_j$, $\mathcal{T}$ & matrices of a flight and a piece, saltation
  and monodromy matrix,
  multipliers, period & Theorem~\ref{thm:jacobians-monodromy} \\
$F^{-}$, $F^{+}$, $\delta$ & accelerations before and after a crossing, a small change &
  Theorem~\ref{thm:jacobians-saltation} \\
$\gamma$, $a$, $\Theta^{\mathrm{cr}}$ & $k v_\lambda/m$, $B_0\Omega/m$, critical phase &
  Lemma~\ref{thm:grazing-contact} \\
$t_m$, $x_m$, $\theta_m$, $\sigma$ & time, position, phase of a contact, and its side &
  Definition~\ref{thm:grazing-graze} \\
$g$ & gap $\dot{x} - v_\lambda$ & Lemma~\ref{thm:events-gap} \\
$\varphi$, $q$, $w$, $u$, $V$, $V_0$, $C_4$, $p$ & helpers of the event search, each defined in its
  theorem &
  Chapter~\ref{sec:events} \\
$F_*$, $N_E$ & largest sum of all forces but the spring's and the damper's; integral of $|E_1|$ &
  Proposition~\ref{thm:orbits-bound} \\
$y$, $W$, $d$, $H_\lambda$, $\ell$ & difference of two motions, its energy, a distance, a constant
  force, a length &
  Theorem~\ref{thm:orbits-unique} \\
$G^{(j)}$, $\Sigma^j$, $x^{(i)}$, $\partial\Omega_{ij}$, $\varphi_{ij}$ & in the list of errata, as
  in the paper: of
  one domain or belt; a boundary and its equation & Chapter~\ref{sec:errata} \\
$q$, $t_q$, $x_q$, $v_q$, $F_q$, $\delta x$, $\dot{F}$ & a parameter or part of the start;
  derivatives by it of an
  event, a belt's speed, a force; of $x$ at a fixed time; rate of a force &
  Theorem~\ref{thm:exponents-events} \\
$\Lambda_j$, $\Lambda_1$, $\Lambda_2$, $\chi_j$, $h_\epsilon$ & Lyapunov exponents, ratios of
  accelerations, entropy at
  a scale & Theorem~\ref{thm:exponents-lyapunov} \\
$A_n$, $B_n$ & points where borders meet & Proposition~\ref{thm:undamped-points} \\
$F$, $x_f$, $x_0$, $p_0$, $q_0$, $d$ & with one belt at rest: friction, $F/k$, highest point, parts
  of
  the motion, a free oscillation & Proposition~\ref{thm:undamped-continuum} \\
$\bar{x}$, $H$ & limit of a sequence of motions; a gap over one without zeros &
  Chapters~\ref{sec:codimension} and~\ref{sec:certificates} \\
$r$, $U$, $J$, $N$, $F_*$ & rate of the force on a belt, force from below, jump of the force;
  changes of belt, a bound
  & Lemma~\ref{thm:accumulation-forces} \\
$S$, $f$, $f^*$, $z$, $R$, $\psi$, $X_0$, $R_*$, $v_\pm$, $\mathcal{K}$, $P$, $E$, $Y$ & without a
  damper:
  largest friction, friction, a free oscillation with its amplitude and phase, the response, bounds, all recurrent
  motions &
  Chapter~\ref{sec:undamped} \\
$\epsilon$, $b$, $D$, $D_{11}$, $D_{12}$, $M_{11}$, $M_{21}$ & how far beyond a border, a rate
  there; matrix of a
  discontinuity map, entries & Theorem~\ref{thm:corrections-maps} \\
$u$, $q$, $h$, $d$, $e$, $t_2$, $p$, $\epsilon_1$, $\epsilon_2$ & at points of codimension two:
  coordinates and rates
  & Chapter~\ref{sec:codimension} \\
$f$, $P$, $X$, $B$, $J$, $Y$, $D$, $E$, $R$, $C$, $q$, $a$, $b$, $N$ & in proofs by balls, each
  defined where it
  stands: maps, boxes and matrices, helpers, points, periods & Chapter~\ref{sec:certificates} \\
$\mu_{s\lambda}$, $E$, $\dot{F}_{s\lambda}$, $\tau_e$, $\tau_f$, $\tau_s$, $g_*$ & with static friction:
  coefficient, excess, rate, times & Chapter~\ref{sec:static_friction} \\
$j$, $c_j$, $A_j$, $F^{(j)}$, $G^{(n,j)}$, $c_*$, $c_\infty$ & a band of velocities, its damping,
  constant force, acceleration and G-functions; least and outermost damping &
  Chapter~\ref{sec:friction_curves} \\
$f_\lambda$, $p_\lambda$, $q_\lambda$, $\sigma_\lambda$, $s_\lambda$, $u$ & curve of belt
  $\lambda$, one of its pieces, the side of the belt; static limit; speed of an edge &
  Definition~\ref{thm:friction_curves-law} \\
$h_{-}$, $Q$, $S$, $\ell_1$, $\ell_2$, $\hat{T}$, $d$, $N$ & in bands: growth, a measure of
  transients, a time, roots, the bounded part of friction, the distance of a corner, a number of
  mappings & Chapter~\ref{sec:friction_curves} \\
$v$, $c_V$, $V_H$, $V_1$, $f_\infty$, $f_1$, $w_0$, $q_1$, $q_3$, $\bar{P}$, $P$ & at an onset: a
  velocity, the damping of a smooth law, speeds, numbers of curves, a power, the map from turn to turn &
  Chapter~\ref{sec:equilibria} \\
$V^{*}$, $x_s$, $x_p$, $x_r$, $\ddot{x}_f$, $\psi$, $X$ & on stick-slip cycles: the speed at which they
  end, places on the belt, acceleration on arrival, a ratio, the place of a pulled block &
  Chapter~\ref{sec:stick_slip} \\
$\xi$, $\theta'$, $b$, $t_e$, $P$, $a$, $a_0$ & the line of a stick, the phase of the next slip, a rate, the
  time of a slip; turns and their map & Chapter~\ref{sec:return_maps} \\
$\Lambda$, $\theta^{*}$, $N_n$, $\lambda$, $Q$, $I$, $J$, $K$, $L$, $A$ & exponent per slip, a repeated phase,
  a number of words and its growth, intervals of phases & Chapter~\ref{sec:chaos} \\
"""
NOTATION = [
    tuple(part.strip() for part in row.split("&"))
    for row in " ".join(_ROWS.split()).split(r" \\")
    if row
]


def notation_table() -> str:
    """Return the LaTeX of the table of notation, in two parts between which a page may end."""
    half = (len(NOTATION) + 1) // 2
    tables = "\n\n".join(map(_notation_rows, (NOTATION[:half], NOTATION[half:])))
    return rf"""\section*{{Notation}}\label{{sec:notation}}
{{\footnotesize{tables}}}"""


def _notation_rows(letters: Sequence[tuple[str, ...]]) -> str:
    """Return the LaTeX of a part of the table of notation."""
    rows = "\n".join(" & ".join(row) + r" \\" for row in letters)
    return rf"""\noindent\begin{{tabular}}{{@{{}}p{{42mm}}p{{80mm}}l@{{}}}}
\hline
{rows}
\hline\end{{tabular}}"""


def how_to_cite() -> str:
    """Return the LaTeX text that says how to cite symosc and this document."""
    return (
        rf"symosc {symosc.__version__}, {SYMOSC['year']}. Cite as: {SYMOSC['author'].strip('{}')}, "
        rf"\emph{{{SYMOSC['title']}}}, version {symosc.__version__}, {SYMOSC['year']} "
        rf"\cite{{symosc}}; the supplement as \emph{{{TITLE}}}, supplement to symosc "
        rf"{symosc.__version__}. "
        r"\texttt{symosc -{}-cite} prints BibTeX of symosc and the paper; \texttt{references.bib} "
        r"has all references."
    )


def title_page() -> str:
    """Return the LaTeX of the document's title with author, version and how to cite."""
    author = SYMOSC["author"].strip("{}")
    title = TITLE.replace(": ", r":\\ ")
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
    return (
        rf"Scene \texttt{{{latex_text(scope.scene.name)}}}, its numbers put in exactly: "
        rf"{', '.join(scope.given())}."
    )
