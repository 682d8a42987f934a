"""Check and print the derivation: equation of motion and friction law.

Run: python derivations/01_equation_of_motion.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("motion")
