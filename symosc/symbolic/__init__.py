"""Derivations by sympy (motion in a domain, mappings, Theorem 7), and the code printed from them.

Derive proves them.

solution, maps and coulomb are the formulas; codegen prints the kernels, export prints programs;
theorem7 and inverse answer exactly. Nothing else loads sympy at its top but derive.
"""
