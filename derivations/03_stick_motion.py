"""Check and print the derivation: stick motion and both exits.

Run: python derivations/03_stick_motion.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("sticks")
