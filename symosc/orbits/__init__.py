"""Periodic orbits of any mapping structure: found, verified by the engine, followed in a parameter.

closing_equations, guesses and newton find roots; admissibility and verification say which of them are orbits; floquet
has their multipliers; curve, between, behind and continuation make branches. May import: kernels to simulation.

One more reason for a branch to end: a margin in admissibility; its mark in plot.figures.
"""
