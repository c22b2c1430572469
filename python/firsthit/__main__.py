"""``python -m firsthit`` is the ``firsthit`` program: the same one as the Rust binary."""

import sys

from _firsthit_program import main

if __name__ == "__main__":
    sys.exit(main())
