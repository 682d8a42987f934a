"""G. Csernak and G. Licsko, Asymmetric and chaotic responses of dry friction oscillators with different
static and kinetic coefficients of friction, Meccanica (2021), doi:10.1007/s11012-021-01382-8.

x'' + x = cos(Omega t) - S sgn(x'), with static friction S_0 > S. Only the introduction could be read,
and no parameters or numbers of the paper were at hand. Both chaotic motions were found by a search
in this model. Their exponents were first computed by another program from two motions 1e-20 apart,
over 600 slips; a mean over so many scatters by some 10 %, so both agree if they differ by less than
20 %.
"""

from __future__ import annotations

from collections.abc import Iterator

from wall import Row, show

from symosc import Belt, Oscillator, sensitivities

#: S, S_0, Omega, and the exponent per slip by the other program.
CHAOTIC = (("0.1", "0.829", "0.58", 0.256), ("0.21", "0.7393", "0.43", 0.159))
SPAN = 3000
TOLERANCE = 0.2


def oscillator(S: str, S_0: str, Omega: str) -> Oscillator:
    """Return the oscillator of the paper."""
    return Oscillator(m=1, c=0, k=1, B0=1, Omega=Omega, belts=[Belt(0, mu=S, mu_s=S_0)])


def exponents() -> Iterator[Row]:
    """Largest Lyapunov exponents per slip; formula: another program, run: sensitivities."""
    for S, S_0, Omega, known in CHAOTIC:
        answer = sensitivities(oscillator(S, S_0, Omega), "x0", t_end=SPAN)
        slips = sum(event.kind == "slip" for event in answer.trajectory.events)
        span = SPAN / slips
        exponent = float(answer.lyapunov[0]) * span
        error = answer.lyapunov_error * span
        assert exponent > 4 * error > 0, f"{exponent} is not certainly positive"
        case = f"S = {S}, S_0 = {S_0}, Omega = {Omega}"
        note = f"+- {error:.3f}, {slips} slips"
        yield Row("exponent", case, known, exponent, 3, TOLERANCE, note)


if __name__ == "__main__":
    show(exponents)
