"""The mappings P1 to P8: their residuals, derivatives and next switching points (`equations`),
compiled (`compiled`).

`theorem7_cases` lists where each mapping can graze, `numbers` reads points and exact phases and
prints them as LaTeX.
"""
