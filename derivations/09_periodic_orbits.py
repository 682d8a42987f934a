"""Check and print the derivation: fixed points of P32 and P4645.

Run: python derivations/09_periodic_orbits.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("orbits")
