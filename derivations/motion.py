"""Check and print the chapter: equation of motion and friction law.

Run: python derivations/motion.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("motion")
