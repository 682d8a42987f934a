"""Sweeps: motions over grids and tables of parameters and starts, in chunks that outlive the program.

`grid` reads what is swept, `plan` names a sweep by its content, `motions` computes a chunk, `store` keeps the finished
ones on disk, `run` sends them to whoever computes, `dataset` makes the xarray.Dataset, `output` its files, and `sweep`
is what users call. May import: simulation, the scenes, and the modules beside the packages. xarray is loaded when a
sweep begins.

One more column: let `simulate_many` record it, and describe it in `dataset.VARIABLES`. One more kind of file: a
function in `output.WRITERS`, and its reader in `output.READERS`.
"""
