"""Derivations that check each of their steps before they print it (LaTeX, Markdown, text).

steps are the checks, latex prints formulas in the paper's notation, document makes files. May import: up to plot.

One more chapter: a module in chapters with a TITLE and ``items(scope)``, and its key in ``CHAPTERS``.
"""
