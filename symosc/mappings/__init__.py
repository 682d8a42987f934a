"""The mappings P1 to P8: their residuals, derivatives and next switching points (`equations`),
compiled (`compiled`).

`points` reads switching points.
"""
