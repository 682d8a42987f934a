"""Speed beside error: this package's own, and other people's solvers on the same scenes.

speed, work_precision, hard and error_map measure; results writes README and docs/results. May import: up to plot.

One more solver: a module with a tuple ``SOLVERS`` like peers_scipy, and its name in peers.
"""
