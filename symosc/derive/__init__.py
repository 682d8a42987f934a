"""Derivations that check each of their steps before they print it (LaTeX and HTML).

steps has the checks, chapters the derivations; document writes them to files, fragments serve
users' papers.
"""
