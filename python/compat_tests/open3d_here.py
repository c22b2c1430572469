"""A plugin of pytest after which Open3D can be imported: the tests beside it are not skipped."""

import libusb

libusb.load()

import open3d  # noqa: E402, F401
