"""Compare an external solution with the exact motion: step by step, event by event, and globally.

`compare` has `crosscheck`. `reading` makes samples of files, tables, results of solvers and
functions; `velocities` completes positions, `rounding` finds their digits, and `frames` moves
those of other models to the coordinates of the oscillator. `verdict` judges samples: `steps`
follows the exact motion over each step, `events` reads events off the samples, `match` pairs them
with the exact ones, `event_verdicts` says which are missed or invented, `faults` guesses why a step
is wrong. `diagnosis` tries causes (`columns`, `models`, `methods`, `friction`) on the wrong steps
and judges changed samples again; `report` shows the result.

To add a cause, write its text in causes, a function that yields a Diagnosis, its line in STAGES of
diagnosis, and a kind of fault in tests/support/fault_kinds.py. To read another format of files, see
`reading`.
"""
