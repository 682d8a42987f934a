"""Check and print the chapter: errors and gaps of the paper.

Run: python derivations/errata.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("errata")
