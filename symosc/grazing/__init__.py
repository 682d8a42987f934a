"""Grazing: Theorem 7's windows (`window`), and the motions that lead to a graze (`start`, `curve`, `solve`).

sweep and window_ends compute many windows in doubles. deciders and check compare Theorem 7 with numerics.
backward_flow, flight, origin, tracer, phase_runs and newton go back in time from a tangency, for a curve of them.
May import: kernels to crosschecks.

One more way to decide a graze: a function in deciders, and its name in check.
"""
