"""Check and print the chapter: Theorem 7, all cases.

Run: python derivations/grazing.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("grazing")
