"""How answers are shown: drawn, as a page of a notebook, as a table or a bar on a terminal.

`drawable` is their base class, `html` has the parts of pages, `tables` prints tables, `progress` shows bars, `frames`
imports pandas and xarray. May import: the modules beside the package.
"""
