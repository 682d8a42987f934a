"""What answers look like: drawn, as a page of a notebook, as a table or a bar on a terminal.

May import: what stands beside it in the foundation. `drawable` is what answers derive from, `html` what pages are made
of, `frames` tables of pandas and xarray, `terminal` and `progress` what a terminal shows.
"""
