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

from ._camera import Camera
from ._errors import FileError, FileFormatError, FileReadError, FileWriteError, FirsthitWarning
from ._frame import Frame, render
from ._hits import Hits
from ._info import info
from ._scene import DirectionalLight, Object, PointLight, Scene, load
from ._shapes import Box, Cone, Cylinder, Disc, Mesh, Plane, Sphere

__version__ = info()["version"]

__all__ = [
    "Box",
    "Camera",
    "Cone",
    "Cylinder",
    "DirectionalLight",
    "Disc",
    "FileError",
    "FileFormatError",
    "FileReadError",
    "FileWriteError",
    "FirsthitWarning",
    "Frame",
    "Hits",
    "Mesh",
    "Object",
    "Plane",
    "PointLight",
    "Scene",
    "Sphere",
    "info",
    "load",
    "render",
]
