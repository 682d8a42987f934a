"""Sweeps over grids and tables of parameters and starts, in chunks saved on disk, so that a sweep
can be resumed.

`plan` reads the swept parameters and makes the call of each chunk, `store` keeps finished chunks on
disk, `output` makes the xarray.Dataset and its files (WRITERS, ENGINES), `sweep` distributes the
chunks. xarray is loaded when a sweep begins.
"""
