"""Reference cases: motions whose events are known for certain, for anybody's solver, and the score of a solver.

sets names all cases; hard_cases, grazes, rests, coulomb and long_runs have them. case is what one is, with its
certificate and condition. folder writes them as files that any language reads; score judges results. May import: up to
certificates.

One more case: a `Case` in one of these modules, and one more in VERSION of sets.
"""
