"""Arithmetic only: the formulas that sympy printed (`_generated`), and the entire functions that they take.

entire is for doubles and numba, entire_array for numpy, entire_mp for any number of digits, in mpmath's numbers
(multiprecision) or in MPFR's (mpfr); pair_type and pair_functions are double-double numbers for CPython and numba;
double_double computes with pairs of doubles in plain Python. May import: the modules beside the packages.
"""
