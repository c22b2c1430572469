"""firsthit, the general raycaster: it tells what a ray meets first.

A camera or arrays of rays go in; distances, identifiers, normals and pictures come out, as NumPy
arrays. Colours are linear, row 0 is the top row, a miss is ``inf`` in distances, ``-1`` in
identifiers and ``nan`` elsewhere.

Examples take ``import firsthit as fh`` and ``import numpy as np`` for granted, as NumPy's own do.

>>> import firsthit as fh
>>> scene = fh.Scene()
>>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
0
>>> t, o = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
>>> t, o
(array([ 4., inf]), array([ 0, -1], dtype=int32))
"""

from importlib import import_module as _import_module
from typing import TYPE_CHECKING

from . import _firsthit, annotations, many
from ._base.errors import FileError, FileFormatError, FileReadError, FileWriteError, FirsthitWarning
from ._base.info import info
from ._files.frame import Frame
from ._files.frame_file import read_metadata
from ._files.points import Points, read_points
from ._lidar.lidar import Lidar
from ._lidar.lidar_scan import LidarScan
from ._looks.colors import Colors
from ._looks.display import Display
from ._looks.edges import Edges
from ._looks.environment import Environment
from ._looks.lights import (
    DirectionalLight,
    DiscLight,
    PointLight,
    RectangleLight,
    Sky,
    SphereLight,
    SpotLight,
)
from ._looks.material import Material, Texture
from ._looks.shading import Shader, Shading
from ._objects.mesh import Mesh
from ._objects.object import Object
from ._objects.shapes import Box, Cone, Cylinder, Disc, Plane, Sphere
from ._pictures.draws import Draws
from ._pictures.flow import Disparity, Flow, disparity, optical_flow
from ._pictures.render import render, render_progressively
from ._pictures.rig import Rig
from ._queries.all_hits import AllHits
from ._queries.explain import Candidate, Crossing, Explanation
from ._queries.hits import Hits
from ._queries.leaving import LeavingRays
from ._queries.lint import Finding, LintReport, Place
from ._queries.of_points import ClosestPoints
from ._queries.section import Polyline, Section
from ._scene.load import lint, load
from ._scene.load import open as open  # noqa: A004 - fh.open
from ._scene.scene import Scene
from ._sensors.camera import Camera
from ._sensors.moving import Pushbroom, RollingShutter
from ._sensors.named_camera import NamedCamera
from ._sensors.ray_sensor import RaySensor
from ._sensors.sensor import Sensor
from ._sensors.trajectory import Trajectory
from ._view.notebook import NotebookView
from ._view.view import View, view
from .annotations import annotate
from .many import parts, render_many, shoot_many, visible_many

if TYPE_CHECKING:
    from . import datasets
    from .datasets import Plan, dataset
else:  # A checker would believe that there is any name.

    def __getattr__(name):
        """Import data sets when they are first asked for: they take a tenth of the time."""
        if name not in ("Plan", "dataset", "datasets"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        module = _import_module(".datasets", __name__)
        return module if name == "datasets" else getattr(module, name)

    def __dir__():
        """Return the names that are there, and those that are imported when they are asked for."""
        return sorted({*globals(), *__all__})


# Not `info()`: an import succeeds whatever `FIRSTHIT_ISA` says.
__version__ = _firsthit.version()

# Not `open`: a star import must leave Python's own in place.
__all__ = [
    "AllHits",
    "Box",
    "Camera",
    "Candidate",
    "ClosestPoints",
    "Colors",
    "Cone",
    "Crossing",
    "Cylinder",
    "DirectionalLight",
    "Disc",
    "DiscLight",
    "Disparity",
    "Display",
    "Draws",
    "Edges",
    "Environment",
    "Explanation",
    "FileError",
    "FileFormatError",
    "FileReadError",
    "FileWriteError",
    "Finding",
    "FirsthitWarning",
    "Flow",
    "Frame",
    "Hits",
    "LeavingRays",
    "Lidar",
    "LidarScan",
    "LintReport",
    "Material",
    "Mesh",
    "NamedCamera",
    "NotebookView",
    "Object",
    "Place",
    "Plan",
    "Plane",
    "PointLight",
    "Points",
    "Polyline",
    "Pushbroom",
    "RaySensor",
    "RectangleLight",
    "Rig",
    "RollingShutter",
    "Scene",
    "Section",
    "Sensor",
    "Shader",
    "Shading",
    "Sky",
    "Sphere",
    "SphereLight",
    "SpotLight",
    "Texture",
    "Trajectory",
    "View",
    "annotate",
    "annotations",
    "dataset",
    "datasets",
    "disparity",
    "info",
    "lint",
    "load",
    "many",
    "optical_flow",
    "parts",
    "read_metadata",
    "read_points",
    "render",
    "render_many",
    "render_progressively",
    "shoot_many",
    "view",
    "visible_many",
]
