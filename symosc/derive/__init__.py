"""Derivations that check each of their steps before they print it (LaTeX and HTML).

steps has the checks, chapters the derivations; document writes them to files, fragments serve users' papers. May
import: up to plot.

To add a chapter, write a module in chapters with a TITLE and ``items(scope)``, and add its key to ``CHAPTERS``.
"""
