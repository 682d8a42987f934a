"""What sympy derives and proves, once: the motion in a domain, the mappings, Theorem 7; and what is printed from it.

solution, maps and coulomb are the formulas; codegen prints the kernels, export prints programs; theorem7 and inverse
answer exactly. May import: kernels to simulation. Nothing else loads sympy at its top but derive.

One more formula for the engine: derive it here, print it in codegen, then ``symosc codegen --regenerate``.
"""
