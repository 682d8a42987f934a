"""Check and print the derivation: derivatives of the mappings and saltation.

Run: python derivations/06_jacobians_and_saltation.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("jacobians")
