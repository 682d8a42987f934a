"""Check and print the derivation: errors and gaps of the paper.

Run: python derivations/10_errata.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("errata")
