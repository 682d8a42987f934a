"""Check and print the chapter: governing equations of P1 to P8.

Run: python derivations/maps.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("maps")
