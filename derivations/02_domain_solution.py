"""Check and print the derivation: solution in one domain, damping regimes and their limits.

Run: python derivations/02_domain_solution.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("domains")
