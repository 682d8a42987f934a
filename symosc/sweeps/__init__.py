"""Sweeps: motions over grids and tables of parameters and starts, in chunks that outlive the program.

`plan` reads what is swept and makes the call of each chunk, `store` keeps finished chunks on disk, `output` makes the
xarray.Dataset and its files, and `sweep` sends the chunks to whoever computes. May import: simulation, the scenes, and
the modules beside the packages. xarray is loaded when a sweep begins.

One more column: `symosc.simulation.tables.SUMMARY_COLUMNS`. One more kind of file: a function in `output.WRITERS`, and
its reader in `output.READERS`.
"""
