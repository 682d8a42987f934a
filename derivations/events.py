"""Check and print the chapter: why no event is missed.

Run: python derivations/events.py
"""

from symosc.derive.document import run

if __name__ == "__main__":
    run("events")
