"""Check and print the chapter: published results that the model contains.

Run: python derivations/literature.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("literature")
