"""Compare an external solution with the exact motion.

Step by step (`steps`), event by event (`events`), globally.

`files` and `objects` read solutions as `samples`, `velocities` completes positions; `compare` is
the whole check, `report` its result. `diagnosis` tries causes (columns, models, methods, friction)
on the wrong steps.

To add a cause, write its text in causes, a function that yields a Diagnosis, its line in STAGES of
diagnosis, and a kind of fault in tests/support/fault_kinds.py.
"""
