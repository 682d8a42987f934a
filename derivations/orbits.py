"""Check and print the chapter: uniqueness, and fixed points of P32 and P4645.

Run: python derivations/orbits.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("orbits")
