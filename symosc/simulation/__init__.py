"""Simulation of one motion (`simulate`) and of many (`ensemble`), with their results (`trajectory`,
`tables`).

`motion` follows one motion in more precise numbers where doubles do not suffice; `problems` reads
columns of many and begins them; `batch` runs them in threads, and `loops` chooses which loop runs.
What derivatives are computed from is in `differentiated`: `plain` for laws with one row of constants,
`banded` with `law_gradients` for the others.
"""
