"""Somebody else's solution against the exact motion: step by step (`steps`), event by event (`events`, `matching`).

samples, files and rounding read what is given; faults says what probably went wrong; compare is the whole check.
May import: kernels to simulation.

One more kind of file or object: a reader in files.
"""
