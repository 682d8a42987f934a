"""Periodic orbits of any mapping structure: found, verified by the engine, followed in a parameter.

closing_equations finds roots; admissibility says which of them are orbits; floquet has their multipliers; find and
branch find orbits and follow them, the latter along a curve. May import: kernels to simulation.

One more reason for a branch to end: a margin in admissibility; its mark in plot.figures.
"""
