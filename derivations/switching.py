"""Check and print the chapter: G-functions and Theorems 4 to 6.

Run: python derivations/switching.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("switching")
