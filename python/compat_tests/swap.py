"""A plugin of pytest that puts firsthit in the place of the peers' classes, for their own tests.

It is loaded before the tests are, with ``-p swap``, so that what they import is ours already.
"""

import importlib
import os

import libusb
import pytest
from firsthit.compat import open3d as our_open3d
from firsthit.compat import trimesh as our_trimesh

#: How often each of our classes was made.
MADE = {}


def counted(kind):
    """Return a class that is ours, and counts how many of it are made."""
    MADE[kind.__name__] = 0
    plain = kind.__init__

    def init(self, *arguments, **named):
        MADE[kind.__name__] += 1
        plain(self, *arguments, **named)

    kind.__init__ = init
    return kind


def swap_trimesh():
    """Put ours in the place of trimesh's two intersectors and its proximity queries."""
    import trimesh
    import trimesh.registration

    intersector = counted(our_trimesh.RayMeshIntersector)
    for name in ("ray_triangle", "ray_pyembree"):
        try:
            module = importlib.import_module(f"trimesh.ray.{name}")
        except ImportError:
            continue
        module.RayMeshIntersector = intersector
    trimesh.proximity.ProximityQuery = counted(our_trimesh.ProximityQuery)
    trimesh.proximity.closest_point = our_trimesh.closest_point
    trimesh.proximity.signed_distance = our_trimesh.signed_distance
    # It has imported the function by name.
    trimesh.registration.closest_point = our_trimesh.closest_point


def swap_open3d():
    """Put ours in the place of Open3D's scene for rays."""
    libusb.load()
    import open3d

    open3d.t.geometry.RaycastingScene = counted(our_open3d.RaycastingScene)


if os.environ["FIRSTHIT_SWAP"] == "trimesh":
    swap_trimesh()
else:
    swap_open3d()


def pytest_terminal_summary(terminalreporter):
    """Say how many of ours were made, and fail if none was: then nothing was swapped."""
    for name, times in MADE.items():
        terminalreporter.write_line(f"firsthit's {name} was made {times} times")


def pytest_sessionfinish(session):
    """Fail where nothing was swapped."""
    if not any(MADE.values()):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
