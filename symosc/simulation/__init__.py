"""Simulation of one motion (`simulate`) and of many (`ensemble`), with their results (`trajectory`,
`tables`).

`motion` follows one motion in more precise numbers where doubles do not suffice; `problems` reads
columns of many and begins them; `batch` runs them in threads, and `loops` chooses which loop runs.
"""
