"""Packages that need not be installed, which some features take."""

from importlib import import_module
from typing import Any


def optional(module: str, what: str, package: str | None = None) -> Any:
    """Import a module of such a package, or say what takes it and how it is installed."""
    try:
        return import_module(module)
    except ImportError:
        name = package or module.partition(".")[0]
        raise ImportError(f"{what} takes the package {name}: pip install {name}") from None
