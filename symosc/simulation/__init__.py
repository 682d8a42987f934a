"""Motions as users see them: `simulate` (one), `ensemble` (many), and what they return (`trajectory`, `tables`).

`motion` follows one motion in one arithmetic and records it; `problems` reads columns of many and begins them; `batch`
chooses loops and threads. May import: kernels, engine, and the modules beside the packages.
"""
