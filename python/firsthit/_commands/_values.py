"""Values of options, as the Rust program reads them."""

from __future__ import annotations

import argparse
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def whole(least: int) -> Callable[[str], int]:
    """Return a reader of whole numbers that are not below ``least``."""

    def read(text: str) -> int:
        found = int(text) if re.fullmatch(r"\s*[+-]?\d{1,30}\s*", text, re.ASCII) else None
        if found is None or found < least:
            raise argparse.ArgumentTypeError(f"must be a whole number from {least} on, got {text}")
        return found

    return read
