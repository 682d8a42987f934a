"""Somebody else's solution against the exact motion: step by step (`steps`), event by event (`events`), as a whole.

`files` and `objects` read solutions as `samples`, `velocities` completes positions; `compare` is the whole check,
`report` its result. `diagnosis` tries causes (columns, models, methods, friction) on the wrong steps.
May import: kernels to simulation.

One more kind of file or object: a reader in files or objects. One more cause: its words in causes, a function that
yields a Diagnosis, its line in STAGES of diagnosis, and a kind of fault in tests/support/fault_kinds.py.
"""
