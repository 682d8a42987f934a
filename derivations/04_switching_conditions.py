"""Check and print the derivation: G-functions and Theorems 4 to 6.

Run: python derivations/04_switching_conditions.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("switching")
