"""Derivations that check each of their steps before they print it (LaTeX and HTML).

steps are the checks, chapters what is derived; document makes files of them, fragments are for users' papers. May
import: up to plot.

One more chapter: a module in chapters with a TITLE and ``items(scope)``, and its key in ``CHAPTERS``.
"""
