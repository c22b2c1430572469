"""The types of arguments and results, for annotations.

>>> from firsthit.typing import ChannelName, ViewName
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, NewType, Protocol

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._pictures.draws import Draws
    from ._queries.hits import Hits

#: Three numbers, as attributes have them; arguments take anything array_like of three.
Vector = tuple[float, float, float]

#: How the trees over meshes are built, see `Scene`.
Build = Literal["auto", "fast", "best"]

#: The unit of a file's lengths, see `load`.
Unit = Literal["um", "mm", "cm", "m", "km", "in", "ft"]

#: Channels of distances, float64; of hits float32 where `Scene.shoot` was asked for it.
DistanceName = Literal["t", "range", "z"]
#: The channel of angles, float64.
AngleName = Literal["incidence"]
#: Channels of identifiers, int32.
IdentifierName = Literal["object", "primitive", "face", "node", "mesh", "material"]
#: Channels of identifiers that stand for something with a name.
NamedIdentifier = Literal["object", "node", "mesh", "material"]
#: Channels of several float64 for each ray.
VectorName = Literal["normal", "position", "barycentric", "uv", "base_color"]
#: All channels. ``color`` is float32 and ``front`` is bool; `firsthit.render` lists the rest.
ChannelName = Literal[
    "color",
    "t",
    "range",
    "z",
    "object",
    "primitive",
    "face",
    "node",
    "mesh",
    "material",
    "normal",
    "incidence",
    "position",
    "barycentric",
    "uv",
    "base_color",
    "front",
    "valid",
    "edge",
    "alpha",
    "ao",
    "samples",
    "crypto_object",
    "crypto_material",
]
#: Channels of mattes, float32.
MatteName = Literal["crypto_object", "crypto_material"]

#: The channel of an attribute, for type checkers: ``AttributeChannel("attribute:quality")``. At run
#: time it is the text itself, which will do.
AttributeChannel = NewType("AttributeChannel", str)
#: The channel of a Cryptomatte with another number of pairs than six, for type checkers:
#: ``MatteChannel("crypto_object:8")``. At run time it is the text itself, which will do. It serves
#: for ambient occlusion up to a distance too: ``MatteChannel("ao:0.5")``.
MatteChannel = NewType("MatteChannel", str)
#: A channel that pictures and files of hits can be asked for.
Asked = ChannelName | AttributeChannel | MatteChannel

#: The part of a mesh that has an attribute.
AttributeOf = Literal["vertices", "corners", "faces"]
#: The kind of a material, see `Material`.
MaterialKind = Literal["matte", "metal-rough", "glass"]
ShaderName = Literal[
    "direct",
    "path",
    "whitted",
    "lambert",
    "phong",
    "blinn-phong",
    "hemisphere",
    "matcap",
    "ao",
    "xray",
    "ghost",
    "unlit",
    "normal",
]
#: Colour maps.
ColorMapName = Literal[
    "viridis",
    "cividis",
    "plasma",
    "inferno",
    "magma",
    "turbo",
    "coolwarm",
    "spectral",
    "blues",
    "grey",
]
#: Lights that go with the camera.
LightName = Literal["auto", "studio", "overcast", "sun", "headlight", "shoulder"]
#: How PNGs show colours of any brightness, see `Display`.
#: The number of a PNG of distances in steps beyond its last step.
Far = Literal["saturate", "zero"]

ToneMapName = Literal["none", "neutral", "agx", "aces"]
#: The reason why an edge is a line, see `Edges`.
EdgeKind = Literal["silhouette", "crease", "boundary", "object", "material", "wireframe"]
#: A camera's projection; the docstring of `Camera` says what each is.
Projection = Literal[
    "perspective",
    "orthographic",
    "equirectangular",
    "cylindrical",
    "cube_map",
    "octahedral",
    "opencv",
    "opencv_fisheye",
    "kannala_brandt",
    "double_sphere",
    "eucm",
    "ucm",
    "mei",
    "fov",
    "thin_prism_fisheye",
    "rad_tan_thin_prism_fisheye",
    "equidistant",
    "equisolid",
    "stereographic",
    "orthographic_fisheye",
]
#: Fisheyes that a field of view is enough for.
FisheyeName = Literal[
    "equidistant", "equisolid", "stereographic", "orthographic_fisheye", "opencv_fisheye"
]
#: How the faces of a cube map lie, see `Camera.cube_map`.
CubeLayout = Literal["row", "column", "two rows", "cross"]
#: How other programs write cameras, see `Camera.from_intrinsics`.
Convention = Literal[
    "opencv", "opengl", "colmap", "blender", "ros", "pytorch3d", "nerfstudio", "gltf"
]
RayStart = Literal["viewplane", "eye"]
#: How a perspective camera's field of view is measured, see `Camera.look_at`.
FovAxis = Literal["vertical", "horizontal", "diagonal"]
#: Which ways the axes of a body point, see `Trajectory`.
BodyName = Literal["right-up-backwards", "right-down-forwards", "forwards-left-up"]
#: The poses between those of a `Trajectory`, and beyond them.
Interpolation = Literal["linear", "spline", "se3"]
Extrapolation = Literal["refuse", "hold"]
#: Texts that trajectories are read from.
TrajectoryFormat = Literal["csv", "tum", "kitti", "ros"]
#: Which line of a picture is read out first, and which way it goes on.
Readout = Literal["top_down", "bottom_up", "left_right", "right_left"]
#: Which way the head of a `Lidar` turns, seen from above.
Turn = Literal["clockwise", "counterclockwise"]
#: Which of a beam's returns are kept, see `Lidar.scan`.
Returns = Literal["first", "last", "strongest", "all"]
#: How a scan numbers lasers: as the maker does, or from the lowest on, as drivers of ROS do.
Rings = Literal["maker", "lowest-first"]
#: The sides from which `Camera.framing` looks.
ViewName = Literal["iso", "front", "back", "left", "right", "top", "bottom"]
#: Which points a closed mesh holds, by how many times it goes around them, see `Scene.inside`.
FillRule = Literal["nonzero", "parity"]
#: How it is known whether a point is inside an object, see `Scene.inside`.
Rule = Literal["nonzero", "parity", "winding", "none"]
#: The sides of a surface; its geometric normal points to the front.
Side = Literal["front", "back"]
Wrap = Literal["repeat", "mirror", "clamp"]
Filter = Literal["linear", "nearest"]
AlphaMode = Literal["opaque", "mask", "blend"]

#: ``True`` for a line with the time that is left, or a function that is called with (done, total)
#: about twenty times a second.
#: An exception that it raises ends the work.
Progress = bool | Callable[[int, int], object]


#: An object, by its identifier, of Python's or NumPy's, or by its name.
ObjectKey = int | np.integer[Any] | str
#: Some objects, by identifiers or names; a name means all objects that have it.
Selection = ObjectKey | Sequence[ObjectKey] | npt.NDArray[np.integer[Any]]


class MeshLike(Protocol):
    """A mesh of another package, such as ``trimesh.Trimesh``."""

    @property
    def vertices(self) -> Any:
        """The vertices, (n, 3) array_like."""

    @property
    def faces(self) -> Any:
        """The indices of each triangle's vertices, (m, 3) array_like of int."""


class PolyDataLike(Protocol):
    """A mesh such as ``pyvista.PolyData``."""

    @property
    def points(self) -> Any:
        """The vertices, (n, 3) array_like."""

    @property
    def faces(self) -> Any:
        """The polygons in a row: of each how many corners it has, and their indices."""


class TriangleMeshLike(Protocol):
    """A mesh such as ``open3d.geometry.TriangleMesh``."""

    @property
    def vertices(self) -> Any:
        """The vertices, (n, 3) array_like."""

    @property
    def triangles(self) -> Any:
        """The indices of each triangle's vertices, (m, 3) array_like of int."""


class TensorMeshLike(Protocol):
    """A mesh such as ``open3d.t.geometry.TriangleMesh``."""

    @property
    def vertex(self) -> Any:
        """Arrays of the vertices: ``positions``."""

    @property
    def triangle(self) -> Any:
        """Arrays of the triangles: ``indices``."""


class CellMeshLike(Protocol):
    """A mesh such as ``meshio.Mesh``."""

    @property
    def points(self) -> Any:
        """The vertices, (n, 3) or (n, 2) array_like."""

    @property
    def cells(self) -> Any:
        """Blocks of cells, each with its ``type`` and ``data``."""


#: A mesh of another package, or a pair of vertices and faces, see `Mesh.of`.
ForeignMesh = (
    MeshLike
    | PolyDataLike
    | TriangleMeshLike
    | TensorMeshLike
    | CellMeshLike
    | tuple[npt.ArrayLike, npt.ArrayLike | Sequence[npt.ArrayLike]]
)


class SceneLike(Protocol):
    """A scene of another package, such as ``trimesh.Scene``."""

    @property
    def geometry(self) -> Mapping[str, Any]:
        """The meshes by name."""

    @property
    def graph(self) -> Any:
        """The nodes: ``nodes_geometry``, and ``get(node)`` with its matrix and its mesh's name."""


#: A shader of one's own: from hits, misses included, to linear colours of shape (..., 3).
OwnShade = Callable[["Hits"], "npt.ArrayLike"] | Callable[["Hits", "Draws"], "npt.ArrayLike"]
