"""The ``firsthit`` program: the same one as the Rust binary."""

import sys

from . import _firsthit


def main() -> int:
    """Run the program with the process's arguments; return its exit code."""
    return _firsthit.run_program(["firsthit", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
