"""What sympy derives and proves, once: the motion in a domain, the mappings, Theorem 7; and what is printed from it.

solution and maps are the formulas; codegen prints the kernels, export and languages print programs; theorem7 and
grazing_queries answer exactly. May import: kernels to simulation. Nothing else loads sympy at its top but derive.

One more formula for the engine: derive it here, print it in codegen, then ``symosc codegen --regenerate``.
"""
