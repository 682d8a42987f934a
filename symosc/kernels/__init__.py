"""Arithmetic: the kernels that sympy printed, and the entire functions that they take as arguments."""
