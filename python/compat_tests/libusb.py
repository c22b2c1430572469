"""The library without which Open3D's wheel cannot be imported, where the system has none."""

import ctypes
import ctypes.util
import sys


def load() -> None:
    """Load the libusb of the package ``libusb-package``, so that Open3D finds it by its name."""
    if sys.platform != "linux" or ctypes.util.find_library("usb-1.0"):
        return
    try:
        import libusb_package
    except ImportError:
        return
    ctypes.CDLL(str(libusb_package.get_library_path()), ctypes.RTLD_GLOBAL)
