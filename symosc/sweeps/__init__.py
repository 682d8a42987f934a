"""Sweeps over grids and tables of parameters and starts, in chunks saved on disk, so that a sweep can be resumed.

`plan` reads the swept parameters and makes the call of each chunk, `store` keeps finished chunks on disk, `output`
makes the xarray.Dataset and its files, and `sweep` distributes the chunks to processes. May import: simulation, the
scenes, and the top-level modules. xarray is loaded when a sweep begins.

To add a column, extend `symosc.simulation.tables.SUMMARY_COLUMNS`. To add a kind of file, add a function to
`output.WRITERS` and its reader to `output.READERS`.
"""
