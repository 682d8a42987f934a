"""Grazing: Theorem 7's windows (`window`), and the motions that lead to a graze (`start`, `curve`, `solve`).

backward goes back in time from a tangency to where the flow came from. check compares Theorem 7 with numerics.
May import: kernels to crosschecks.

To add a way of deciding a graze, write a method of `Ways` in check, and its name in `WHY_UNDECIDED`.
"""
