"""``python -m symosc`` is the command line."""

from symosc.cli import main

main(prog_name="symosc")
