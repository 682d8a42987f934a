"""Check and print the derivation: why no event is missed.

Run: python derivations/08_no_event_missed.py
"""

from symosc.derivation.document import run

if __name__ == "__main__":
    run("events")
