"""``python -m symosc`` and the program `symosc`.

An interrupt ends it quietly, while it loads too.
"""

import sys
from signal import SIGINT


def run() -> None:
    """Run the program `symosc` with the arguments given on the command line."""
    try:
        from symosc.cli.app import main

        main(prog_name="symosc")
    except KeyboardInterrupt:
        sys.exit(128 + SIGINT)


if __name__ == "__main__":
    run()
