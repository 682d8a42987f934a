"""Check and print the chapter: solution in one domain, damping regimes and their limits.

Run: python derivations/domains.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("domains")
