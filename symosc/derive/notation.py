"""The table of notation: symbols, what they mean, and where they are defined."""

from __future__ import annotations

HEADS = ("symbol", "meaning", "")
#: Rows of LaTeX, each up to its double backslash.
_ROWS = r"""
$m$, $c$, $k$ & mass, damping coefficient, stiffness of the spring & \eqref{eq:motion-newton} \\
$A_0$, $B_0$, $\Omega$ & constant part, amplitude and frequency of the drive & \eqref{eq:motion-newton} \\
$v_\lambda$, $\mu_\lambda$, $F_N$ & speed and friction coefficient of belt $\lambda$, normal force &
  Definition~\ref{thm:motion-coulomb} \\
$x$, $\dot{x}$, $\ddot{x}$ & position, velocity and acceleration of the mass & \eqref{eq:motion-newton} \\
$t$, $\theta$ & time, phase $\Omega t$ of the drive, modulo $2\pi$ & Definition~\ref{thm:maps-planes} \\
$\lambda$, $\lambda'$ & a belt, 1 or 2; the belt where a flight ends & Table~\ref{tab:maps-maps} \\
$\alpha$ & a domain, 1, 2 or 3 & \eqref{eq:motion-domain} \\
$T_\lambda$, $T$ & friction of belt $\lambda$ on the mass; of both & \eqref{eq:motion-newton} \\
$\Omega_\alpha$, $\partial\Omega_{12}$ & domains and boundaries of the phase plane & Table~\ref{tab:motion-constants} \\
$A_\alpha$ & constant part of all forces in a domain & Table~\ref{tab:motion-constants} \\
$F^{(\alpha)}$ & acceleration in a domain & \eqref{eq:motion-acceleration} \\
$F_{s\lambda}$ & all forces on a mass on belt $\lambda$ but that belt's friction & Proposition~\ref{thm:motion-held} \\
$x_i$, $\dot{x}_i$, $\ddot{x}_i$, $t_i$, $\theta_i$ & state at the start of a flight or stick, or at a switching point
  & Theorem~\ref{thm:domains-flow} \\
$\tau$ & time since the start of a flight or stick & Definition~\ref{thm:domains-basis} \\
$L$ & the operator $d^2/d\tau^2 + (c/m)\,d/d\tau + k/m$ & Definition~\ref{thm:domains-basis} \\
$E_0$, $E_1$, $E_2$, $R_2$, $I_2$ & basis functions of all motions & Definition~\ref{thm:domains-basis} \\
$\kappa$, $\Delta$ & $k/m - \Omega^2$, and $\kappa^2 + (c\Omega/m)^2$ & \eqref{eq:domains-kappa} \\
$h$, $\omega_d$, $\eta$, $\omega_0$ & decay rate, damped frequency, overdamped rate, undamped frequency &
  \eqref{eq:domains-h} \\
$C_1$, $C_2$, $D_1$, $D_2$ & constants of the form that papers print & \eqref{eq:domains-paper} \\
$G^{(j,\alpha)}$ & G-functions: derivatives of $F^{(\alpha)}$ along the flow & Definition~\ref{thm:switching-G} \\
$\mathbf{x}^{(\alpha)}$, $\mathbf{x}^{(0)}$, $\mathbf{n}$, $D$ & flows of a domain and in a boundary, its normal, a
  derivative along the latter & Definition~\ref{thm:switching-G} \\
$\Sigma^0_{(\lambda)}$, $\Sigma^1_{(\lambda)}$, $\Sigma^2_{(\lambda)}$ & switching planes &
  Definition~\ref{thm:maps-planes} \\
$P_1, \ldots, P_8$ & basic mappings & Table~\ref{tab:maps-maps} \\
$f_1$, $f_2$ & governing equations of a mapping & Theorem~\ref{thm:maps-flight} \\
$\Phi$, $\Psi_j$, $S$, $M$, $\rho_j$, $\mathcal{T}$ & matrices of a flight and a piece, saltation and monodromy matrix,
  multipliers, period & Theorem~\ref{thm:jacobians-monodromy} \\
$F^{-}$, $F^{+}$, $\delta$ & accelerations before and after a crossing, a small change &
  Theorem~\ref{thm:jacobians-saltation} \\
$\gamma$, $a$, $\Theta^{\mathrm{cr}}$ & $k v_\lambda/m$, $B_0\Omega/m$, critical phase &
  Lemma~\ref{thm:grazing-contact} \\
$t_m$, $x_m$, $\theta_m$, $\sigma$ & time, position, phase of a contact, and its side &
  Definition~\ref{thm:grazing-graze} \\
$g$ & gap $\dot{x} - v_\lambda$ & Lemma~\ref{thm:events-gap} \\
$\varphi$, $q$, $w$, $u$, $V$, $V_0$, $C_4$, $p$ & helpers of the event search, each defined in its theorem &
  Chapter~\ref{sec:events} \\
$y$, $W$, $d$, $H_\lambda$, $\ell$ & difference of two motions, its energy, a distance, a constant force, a length &
  Theorem~\ref{thm:orbits-unique} \\
$G^{(j)}$, $\Sigma^j$, $x^{(i)}$, $\partial\Omega_{ij}$, $\varphi_{ij}$ & in the list of errata, as in the paper: of
  one domain or belt; a boundary and its equation & Chapter~\ref{sec:errata} \\
$q$, $t_q$, $x_q$, $v_q$, $F_q$, $\delta x$, $\dot{F}$ & a parameter or part of the start; derivatives by it of an
  event, a belt's speed, a force; of $x$ at a fixed time; rate of a force & Theorem~\ref{thm:exponents-events} \\
$\Lambda_j$, $\Lambda_1$, $\Lambda_2$, $\chi_j$, $h_\epsilon$ & Lyapunov exponents, ratios of accelerations, entropy at
  a scale & Theorem~\ref{thm:exponents-lyapunov} \\
$A_n$, $B_n$ & points where borders meet & Proposition~\ref{thm:literature-points} \\
$P$, $F$, $x_f$, $r$ & amplitude of the drive, friction, $F/k$, $\Omega\sqrt{m/k}$ & Chapter~\ref{sec:literature} \\
$Q$, $G$, $H$, $p_0$, $q_0$, $T$, $D$, $U$, $S$, $B$, $\chi$, $T_h$, $D_h$, $\Delta x$, $L$, $\bar{x}$, $Y$, $s'$ &
  there only: parts of the symmetric motion and of its half period, Den Hartog's letters, a growth, a loss, a middle,
  motion of a base, a slope &
  Chapter~\ref{sec:literature} \\
$f$, $P$, $X$, $B$, $J$, $Y$, $D$, $E$, $R$, $C$, $q$, $a$, $b$, $N$ & in proofs by balls, each defined where it
  stands: maps, boxes and matrices, helpers, points, periods & Chapter~\ref{sec:certificates} \\
"""
NOTATION = [tuple(part.strip() for part in row.split("&")) for row in " ".join(_ROWS.split()).split(r" \\") if row]
