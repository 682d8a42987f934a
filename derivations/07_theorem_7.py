"""Check and print the derivation: Theorem 7, all cases.

Run: python derivations/07_theorem_7.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("grazing")
