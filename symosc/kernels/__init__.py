"""Arithmetic only: the formulas that sympy printed (`_generated`), and the entire functions that they take.

entire is for doubles and numba, entire_array for numpy, elementary for SIMD, multiprecision for any number of digits,
in mpmath's numbers or in MPFR's (mpfr); mapping evaluates the equations of maps; pairs are double-double numbers for
CPython and numba; double_double computes with pairs of doubles in plain Python. May import: the modules beside the
packages.
"""
