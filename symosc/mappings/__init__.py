"""The mappings P1 to P8: their residuals and derivatives (`equations`), and the way from point to point (`solve`).

`theorem7_cases` lists where each mapping can graze. May import: kernels, engine, and the modules beside the packages.

One more mapping: its name in `symosc.words`, its equations in symbolic.maps; then ``symosc codegen --regenerate``.
"""
