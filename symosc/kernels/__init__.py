"""Arithmetic only: the formulas that sympy printed (`_generated`), and the entire functions that they take.

entire is for doubles and numba, entire_array for numpy, entire_mp and multiprecision for any number of digits;
double_double computes with pairs of doubles. May import: the modules beside the packages.
"""
