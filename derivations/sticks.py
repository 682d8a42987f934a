"""Check and print the chapter: stick motion and both exits.

Run: python derivations/sticks.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("sticks")
