"""Find periodic orbits of any word, verify them with the engine, and continue them in a parameter.

closing_equations finds roots; admissibility says which of them are orbits; floquet has their
multipliers; find finds orbits and branch follows them. border follows the ends of branches in a
second parameter; its equations are in border_system. A reason for a branch to end has a margin in
admissibility, a mark in plot.figures.
"""
