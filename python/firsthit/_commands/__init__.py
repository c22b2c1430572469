"""The commands of the ``firsthit`` program that are written in Python.

A module per command, named like it, with ``main(argv) -> int``: it takes the arguments behind the
command's name and returns the exit code. ``_firsthit_program`` has the table of them; the program
in Rust lists them in its help. `_program` is what they share.
"""
