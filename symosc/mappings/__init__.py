"""The mappings P1 to P8: their residuals, derivatives and next switching points (`equations`), compiled (`compiled`).

`theorem7_cases` lists where each mapping can graze, `numbers` reads points and exact phases and prints them as LaTeX.
May import: kernels, engine, and the top-level modules.

To add a mapping, put its name in `symosc.words` and its equations in symbolic.maps, and run
``symosc codegen --regenerate``.
"""
