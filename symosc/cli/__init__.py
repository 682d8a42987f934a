"""The command line: `app` is the group, each command a module of its name; output and settings are what they share.

May import everything. One more command: a module with a function of its name, and that name in `app.COMMANDS`.
"""
