"""Derivations by sympy (motion in a domain, mappings, Theorem 7), and the code printed from them.

solution and maps contain the formulas; codegen prints the kernels, export prints programs; theorem7
and inverse answer exactly. symosc.derive proves the formulas. Besides these two packages no module
imports sympy at its top.
"""
