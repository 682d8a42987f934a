"""``python -m symosc`` is the command line."""

from symosc.cli.app import main

main(prog_name="symosc")
