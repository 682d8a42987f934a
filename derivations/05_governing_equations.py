"""Check and print the derivation: governing equations of P1 to P8.

Run: python derivations/05_governing_equations.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("maps")
