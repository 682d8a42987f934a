"""Reference cases: motions whose events are known for certain, for anybody's solver, and the score of a solver.

`cases` has them all, `case` is one with its certificate and conditions. `folder` writes and reads them as files,
`results` reads somebody's events, `score` judges them. May import: up to certificates.

One more case: a `ReferenceCase` in one of the functions of `cases`, and SET_VERSION there.
"""
