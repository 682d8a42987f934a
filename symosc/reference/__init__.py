"""Reference cases: problems with known, mostly proven events for tests of any solver, and the score
of a solver.

`cases` has them all, `case` is one with its certificate and conditions. `folder` writes and reads
them as files, `results` reads a solver's events, `score` judges them.
"""
