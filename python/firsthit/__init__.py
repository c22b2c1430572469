"""firsthit, the general raycaster: it tells what a ray meets first.

A camera or arrays of rays go in; distances, identifiers, normals and pictures come out, as NumPy
arrays. Colours are linear, row 0 is the top row, a miss is ``inf`` in distances, ``-1`` in
identifiers and ``nan`` elsewhere.

>>> import firsthit as fh
>>> scene = fh.Scene()
>>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1), name="ball")
0
>>> t, o = scene.shoot([[0, 0, 5], [0, 3, 5]], [0, 0, -1])
>>> t, o
(array([ 4., inf]), array([ 0, -1], dtype=int32))
"""

from . import _firsthit, annotations, datasets, many
from ._all_hits import AllHits
from ._camera import Camera
from ._cameras import NamedCamera
from ._colors import Colors
from ._display import Display
from ._draws import Draws
from ._edges import Edges
from ._environment import Environment
from ._errors import FileError, FileFormatError, FileReadError, FileWriteError, FirsthitWarning
from ._explain import Candidate, Crossing, Explanation
from ._flow import Disparity, Flow, disparity, optical_flow
from ._frame import Frame, read_metadata
from ._hits import Hits
from ._info import info
from ._leaving import LeavingRays
from ._lidar import Lidar
from ._lidar_scan import LidarScan
from ._lights import (
    DirectionalLight,
    DiscLight,
    PointLight,
    RectangleLight,
    Sky,
    SphereLight,
    SpotLight,
)
from ._lint import Finding, LintReport, Place
from ._load import lint, load
from ._load import open as open  # noqa: A004 - fh.open
from ._material import Material, Texture
from ._moving import Pushbroom, RollingShutter
from ._nearest import ClosestPoints
from ._notebook import NotebookView
from ._object import Object
from ._points import Points, read_points
from ._ray_sensor import RaySensor
from ._render import render, render_progressively
from ._rig import Rig
from ._scene import Scene
from ._section import Polyline, Section
from ._sensor import Sensor
from ._shading import Shader, Shading
from ._shapes import Box, Cone, Cylinder, Disc, Mesh, Plane, Sphere
from ._trajectory import Trajectory
from ._view import View, view
from .annotations import annotate
from .datasets import Plan, dataset
from .many import parts, render_many, shoot_many, visible_many

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
