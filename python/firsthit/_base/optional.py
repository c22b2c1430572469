"""Packages that need not be installed, which some features take."""

from importlib import import_module
from typing import Any


def optional(module: str, what: str, package: str | None = None) -> Any:
    """Import a module of such a package, or say what takes it and how it is installed."""
    try:
        return import_module(module)
    except ModuleNotFoundError as error:
        # One that is there and misses another says so itself.
        if error.name not in (module, module.partition(".")[0]):
            raise
        name = package or module.partition(".")[0]
        raise ImportError(f"{what} takes the package {name}: pip install {name}") from None
