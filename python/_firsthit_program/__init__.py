"""The ``firsthit`` program, reached without the package ``firsthit`` and so without NumPy.

NumPy takes a tenth of a second and more memory than the program; the native module, which holds the
whole program, needs neither it nor the package.
"""

import os
import sys
from importlib.machinery import PathFinder

# `typing` and `signal` would take some milliseconds each, at a start that takes as few.
TYPE_CHECKING = False
if TYPE_CHECKING:
    import signal
    from typing import Any
else:
    import _signal as signal

_NATIVE = "firsthit._firsthit"


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


def main() -> int:
    """Run the program with the process's arguments; return its exit code."""
    # The program's own handler of Ctrl-C gives way to one that is there already, such as Python's.
    # Where Ctrl-C is ignored (`nohup`, a script's background job) it stays so.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    code: int = _native().run_program(["firsthit", *sys.argv[1:]])
    return code
