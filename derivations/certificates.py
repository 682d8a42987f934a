"""Check and print the chapter: why each kind of certificate proves what it says.

Run: python derivations/certificates.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("certificates")
