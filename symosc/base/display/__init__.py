"""Display of results: their plots and notebook pages, and progress bars.

`drawable` is their base class, `progress` shows bars, `frames` imports pandas and xarray.
"""
