"""Display of results: plots, notebook pages, terminal tables and progress bars.

`drawable` is their base class, `html` has the parts of pages, `tables` prints tables, `progress` shows bars, `frames`
imports pandas and xarray.
"""
