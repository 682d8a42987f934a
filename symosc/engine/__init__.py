"""One motion, event by event: exact flights and sticks, the search for their ends, and what happens there.

Everything on the inner loop is plain scalar Python on numbers (flow, gap_bounds, touches, march, first_exit,
stick_exit, switching, rests, next_event, compiled_loop). `state` has its codes and the tuples that are passed on.
`arithmetic` binds it to doubles, to mpmath and to numba, `mpfr_arithmetic` to MPFR, `pairs` to double-double numbers;
`rounding` says what becomes of many digits in doubles, `start` how a motion begins, on a belt too.
For many motions, `constant_table` and `first_rows` make constants and starts, `tally` and `extremes` summaries.
May import: kernels, and the modules beside the packages.

One more formula: derive it in symbolic, print it into kernels (``symosc codegen --regenerate``), and call it here.
"""
