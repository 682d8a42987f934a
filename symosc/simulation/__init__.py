"""Motions as users see them: `simulate` (one), `ensemble` (many), and what they return (`trajectory`).

`run` follows a motion in one arithmetic and records it; `closer_look` says how many digits a doubtful contact takes.
May import: kernels, engine, and the modules beside the packages.
"""
