"""The command line: `app` is the group, each command is in a module of its name.

Output and settings are shared.

May import everything. To add a command, write a module with a function of its name, and add it to
`app.COMMANDS`.
"""
