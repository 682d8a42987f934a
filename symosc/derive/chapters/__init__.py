"""The chapters, in reading order.

Each module has a TITLE and items(scope), which returns what `symosc.derive.steps` defines: LaTeX
text, steps, tables and figures. A chapter's key is its name everywhere: of its module, its file,
and in the paper's claims.
"""

#: What each chapter is about.
CHAPTERS = {
    "motion": "equation of motion and friction law",
    "domains": "solution in one domain, damping regimes and their limits",
    "sticks": "stick motion and both exits",
    "switching": "G-functions and Theorems 4 to 6",
    "maps": "governing equations of P1 to P8",
    "jacobians": "derivatives of the mappings, saltation and monodromy",
    "grazing": "Theorem 7, all cases",
    "events": "why no event is missed",
    "accumulation": "why events do not accumulate",
    "orbits": "uniqueness, and fixed points of P32 and P4645",
    "exponents": "derivatives of events, Lyapunov exponents, no chaos",
    "undamped": "motions without a damper, tori",
    "borders": "borders between words, and why an atlas is complete",
    "corrections": "discontinuity maps of the four borders",
    "codimension": "points of codimension two",
    "errata": "errors and gaps of the paper",
    "certificates": "why each kind of certificate proves what it says",
    "static_friction": "static friction above kinetic friction, and which theorems remain",
    "friction_curves": "friction that depends on speed, and which theorems remain",
    "equilibria": "rests and their stability, and where oscillations begin",
    "stick_slip": "stick-slip cycles in closed form",
    "return_maps": "maps from slip to slip and from turn to turn",
    "chaos": "when chaos is possible and when not",
}
