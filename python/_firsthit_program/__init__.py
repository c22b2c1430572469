"""The ``firsthit`` program, reached without the package ``firsthit`` and so without NumPy.

NumPy takes a tenth of a second and more memory than the program; the native module, which holds all
commands but a few, needs neither it nor the package. Those few are written in Python, over the
package: `_IN_PYTHON` names them.
"""

import os
import sys
from importlib.machinery import PathFinder
from itertools import takewhile

# `typing` and `signal` would take some milliseconds each, at a start that takes as few.
TYPE_CHECKING = False
if TYPE_CHECKING:
    import signal
    from typing import Any
else:
    import _signal as signal

_NATIVE = "firsthit._firsthit"

#: The commands that are written in Python: `main` of the module of that name in `_COMMANDS` takes
#: the arguments and returns the exit code. All others are in the native module.
_IN_PYTHON = ("dataset", "pack", "parts")
_COMMANDS = "firsthit._commands"
#: The options that may stand before a command.
_VERBOSITY = ("-q", "--quiet", "-v", "--verbose")


def _native() -> "Any":
    """Return the native module: the one in use, or that of the package beside this one."""
    if _NATIVE in sys.modules:
        return sys.modules[_NATIVE]
    # Not by `pathlib`, which takes longer than all the rest.
    packages = os.path.dirname(os.path.dirname(__file__))  # noqa: PTH120
    spec = PathFinder.find_spec(_NATIVE, [os.path.join(packages, "firsthit")])  # noqa: PTH118
    if spec is None or spec.loader is None:
        message = f"no native module {_NATIVE} in {packages}: firsthit is not installed whole"
        raise ImportError(message)
    native = spec.loader.create_module(spec)
    assert native is not None  # an extension module is made by its loader
    spec.loader.exec_module(native)
    return native


def _in_python(arguments: "list[str]") -> "tuple[str, list[str]] | None":
    """Return the command in Python that is meant, and its arguments; ``None`` if none is."""
    if len(arguments) > 1 and arguments[0] == "help" and arguments[1] in _IN_PYTHON:
        return arguments[1], ["--help"]
    before = [*takewhile(_VERBOSITY.__contains__, arguments)]
    command, rest = arguments[len(before) :][:1], arguments[len(before) + 1 :]
    if command and command[0] in _IN_PYTHON:
        return command[0], before + rest
    return None


def _imported(name: str) -> "Any":
    """Import a command. Ctrl-C ends the program at once: nothing has begun."""
    from importlib import import_module

    is_pythons = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if is_pythons:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    module = import_module(name)
    if is_pythons:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    return module


def main() -> int:
    """Run the program with the process's arguments; return its exit code."""
    named = _in_python(sys.argv[1:])
    if named is not None:
        code: int = _imported(f"{_COMMANDS}.{named[0]}").main(named[1])
        return code
    # The program's own handler of Ctrl-C gives way to one that is there already, such as Python's.
    # Where Ctrl-C is ignored (`nohup`, a script's background job) it stays so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    ended: int = _native().run_program(["firsthit", *sys.argv[1:]])
    return ended
