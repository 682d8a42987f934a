"""Check and print the chapter: derivatives of the mappings, saltation and monodromy.

Run: python derivations/jacobians.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("jacobians")
