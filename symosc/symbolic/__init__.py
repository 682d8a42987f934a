"""The only package that imports sympy: it derives and proves what the numeric modules compute."""
