"""Motions as users see them: `simulate` (one), `ensemble` (many), and what they return (`trajectory`).

`run` follows a motion in one arithmetic and records it; `closer_look` says how many digits a doubtful contact takes;
`ladder` takes many motions from doubles to double-double numbers and on, `batch_loop` chooses the loop for doubles.
Of many motions, `columns` and `problems` read the numbers, `chunks` and `workers` share the work among threads, and
`event_table` and `summary` are what comes out.
May import: kernels, engine, and the modules beside the packages.
"""
