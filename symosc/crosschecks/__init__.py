"""Somebody else's solution against the exact motion: step by step (`steps`), event by event (`events`, `matching`).

samples, files and rounding read what is given; faults says what is odd about a step; compare is the whole check.
diagnosis says what is wrong as a whole: the modules *_clues and other_models try causes on the wrong steps.
May import: kernels to simulation.

One more kind of file or object: a reader in files. One more cause: its words in causes, a function that yields a
Diagnosis in a module of clues, called in diagnosis, and a kind of fault in tests/support/fault_kinds.py.
"""
