"""Derivations that check each of their steps before they print it (LaTeX, HTML, Markdown, text).

steps are the checks, blocks the theorems, tables and figures around them, chapters what is derived; document makes
files, fragments are for papers of one's own. May import: up to plot.

One more chapter: a module in chapters with a TITLE and ``items(scope)``, and its key in ``CHAPTERS``.
"""
