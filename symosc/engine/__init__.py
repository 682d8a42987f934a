"""One motion, event by event: exact flights and sticks, the search for their ends, and what happens
there.

The inner loop is plain scalar Python on numbers: `flow` (constants and closed form), `first_exit`
(where a flight or a stick ends), `next_event` (what happens there), `events` (what is recorded of
it), `batch` (many motions, events into columns), `lanes` (several of them side by side in
registers) and `summary`; `state` has its codes and the tuples that it passes on. `arithmetic` binds
it to doubles, to numba, to double-double numbers and to any number of digits. `start` decides how a
motion begins, on a belt too.
"""
