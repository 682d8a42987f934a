"""Check and print the derivation: published results that the model contains.

Run: python derivations/11_literature.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("literature")
