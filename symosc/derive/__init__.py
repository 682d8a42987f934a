"""Derivations that check each of their steps before they print it (LaTeX, Markdown, text)."""
