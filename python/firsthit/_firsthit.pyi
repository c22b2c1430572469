from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypedDict, TypeVar, final

import numpy as np
import numpy.typing as npt

from .typing import (
    AlphaMode,
    ColorMapName,
    EdgeKind,
    Extrapolation,
    Far,
    Interpolation,
    LightName,
    MaterialKind,
    Projection,
    RayStart,
    ShaderName,
    Side,
    ToneMapName,
)

_Vector = tuple[float, float, float]
_Doubles = npt.NDArray[np.float64]
_Integers = npt.NDArray[np.int32]
_Hits = tuple[_Doubles, _Integers, _Integers, _Doubles]
_Surfaces = tuple[_Integers, _Integers]
# With the two weights of places on surfaces, and the side that a ray starts on: 1 the front, -1 the
# back, 0 none, so that it goes through.
_Places = tuple[_Integers, _Integers, _Doubles, npt.NDArray[np.int8]]
_Filters = tuple[
    npt.NDArray[np.uint32] | None,
    Side | None,
    _Surfaces | None,
    _Places | None,
    _Integers | None,
]
_Rays = tuple[_Doubles, _Doubles, _Doubles, _Doubles, _Filters | None]
_Ends = tuple[_Doubles, _Surfaces | None]
_Label = tuple[int, str]
_Labels = tuple[_Label | None, _Label | None]
_Seen = tuple[bool, bool]
_Object = tuple[Shape, str, _Doubles | None, list[_Material], int, _Seen, _Labels]
#: A property: its owner, name, components, whether it is a label, numbers.
_Property = tuple[str, str, int, bool, npt.NDArray[Any]]
_Copies = tuple[_Doubles | None, _Doubles | None]
_Value = bool | float | _Vector
_Settings = list[tuple[str, _Value]]
_Light = tuple[str, _Settings]
_Environment = tuple[
    str, Sequence[_Vector], Sequence[float], EnvironmentMap | None, float, bool, _Vector | None
]
# Width, angle, kinds, dash and gap of what is hidden, and colour.
_Edges = tuple[float, float, Sequence[EdgeKind], tuple[float, float] | None, _Vector]
_Colors = tuple[
    str | None,
    list[float],
    ColorMapName,
    tuple[float, float] | None,
    tuple[_Vector | None, _Vector | None, _Vector | None],
]
_Shading = tuple[
    ShaderName | None,
    _Settings,
    LightName | None,
    bool | None,
    int | None,
    _Colors | None,
]

@final
class Texels:
    def __new__(cls, texels: npt.NDArray[np.uint8]) -> Texels: ...
    def array(self) -> npt.NDArray[np.uint8]: ...

#: The texels of a map, or their number among those of a file.
_Texels = TypeVar("_Texels", Texels, int)
_MapOf = tuple[_Texels, tuple[str, str], str, tuple[_Vector, _Vector], bool]
_Map = _MapOf[Texels]
_MapOut = _MapOf[int]
# Its emission, how steep its normal map is, how much its occlusion map counts.
_Strengths = tuple[_Vector, float, float]
_MaterialOf = tuple[
    _Vector,
    float,
    _MapOf[_Texels] | None,
    _MapOf[_Texels] | None,
    AlphaMode,
    float,
    bool,
    bool,
    str,
    tuple[MaterialKind, _Settings],
    _Strengths,
    list[tuple[str, _MapOf[_Texels]]],
]
_Material = _MaterialOf[Texels]
_MaterialOut = _MaterialOf[int]
# Position, aim and up; rows and columns; projection and where rays start; the lens' parameters.
_View = tuple[
    tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike],
    tuple[int, int],
    tuple[Projection, RayStart],
    list[tuple[str, float]],
]
_Matrix3 = list[list[float]]
_Matrix4 = list[list[float]]
_CameraOut = tuple[str, _View, bool]
_PolylineOut = tuple[int, bool, _Doubles, _Doubles, _Integers, float | None, float]
#: Takes how much is done; of work in steps also the step's total, its name and its unit.
_Report = Callable[..., object]

#: Shape, or the number of a mesh; name, transform, number of the look, mask, seen, labels.
_ObjectOut = tuple[int | tuple[str, list[float]], str, _Doubles | None, int, int, _Seen, _Labels]

class _Model(TypedDict):
    meshes: list[Mesh]
    textures: list[Texels]
    looks: list[list[_MaterialOut]]
    objects: Objects
    cameras: list[_CameraOut]
    lights: list[_Light]
    environment: _Environment | None
    background: list[_Vector] | None
    shading: _Shading | None
    display: tuple[float, ToneMapName]
    edges: _Edges | None
    has_view: bool
    up: _Vector
    up_is_guessed: bool
    warnings: list[str]
    scene: Scene | None

def version() -> str: ...
def instruction_set() -> str: ...
def info(path: Path) -> str: ...
def all_threads() -> int: ...
def run_program(arguments: Sequence[str]) -> int: ...

@final
class Camera:
    def __new__(
        cls,
        position: _Vector,
        aim: _Vector,
        up: _Vector,
        pixels: tuple[int, int],
        projection: str,
        ray_start: str,
        parameters: Sequence[tuple[str, float]],
        is_exact: bool,
    ) -> Camera: ...
    @staticmethod
    def from_intrinsics(
        k: _Matrix3,
        pose: _Matrix4,
        convention: str,
        pixels: tuple[int, int],
        projection: str,
        parameters: Sequence[tuple[str, float]],
    ) -> Camera: ...
    def matrices(self, convention: str) -> tuple[_Matrix3 | None, _Matrix4]: ...
    def to_colmap(
        self,
    ) -> tuple[str, list[float], tuple[float, float, float, float], tuple[float, float, float]]: ...
    @staticmethod
    def of_colmap(
        cameras: Path, images: Path | None
    ) -> tuple[list[tuple[str, Camera]], list[tuple[str, str]], Path]: ...
    @staticmethod
    def no_thin_lens(projection: str) -> str | None: ...
    @staticmethod
    def settings(projection: str) -> list[str]: ...
    @staticmethod
    def of_record(json: str) -> Camera: ...
    @staticmethod
    def with_fov(
        projection: str, fov: float, pixels: tuple[int, int]
    ) -> list[tuple[str, float]]: ...
    def crop(self, region: tuple[int, int, int, int]) -> Camera: ...
    def resize(self, rows: int, columns: int) -> Camera: ...
    def thin_lens(self, aperture: float, focus: float) -> Camera: ...
    def depth(self, point: _Vector) -> float: ...
    def project(self, points: _Doubles) -> _Doubles: ...
    @staticmethod
    def framing(
        scene: Scene, up: _Vector, view: str, rows: int | None, columns: int | None
    ) -> Camera: ...
    def view(self) -> _View: ...
    @staticmethod
    def lens(fov: float, fov_axis: str, rows: int, columns: int) -> tuple[float, float, float]: ...
    def frame(self) -> tuple[_Vector, _Vector, _Vector, _Vector]: ...
    def moved(self, world_from_body: _Matrix4) -> Camera: ...

@final
class Sensor:
    @staticmethod
    def table(
        origins: _Doubles, directions: _Doubles, shape: tuple[int, int], aim: _Vector | None
    ) -> Sensor: ...
    @staticmethod
    def rolling_shutter(
        camera: Camera, body: Trajectory, start: float, readout: float, direction: str
    ) -> Sensor: ...
    @staticmethod
    def pushbroom(camera: Camera, body: Trajectory, times: _Doubles) -> Sensor: ...
    @staticmethod
    def lidar(pattern: Pattern, pose: _Matrix4, body: Trajectory | None) -> Sensor: ...
    def shape(self) -> tuple[int, int]: ...
    def has_aim(self) -> bool: ...
    def times(self, pixels: npt.NDArray[np.int64]) -> _Doubles | None: ...
    def places(self, pixels: npt.NDArray[np.int64]) -> _Doubles: ...
    def poses(self, pixels: npt.NDArray[np.int64]) -> _Doubles: ...

def rays_of_rows(
    sensor: Camera | Sensor, rows: tuple[int, int], sample: int
) -> tuple[_Doubles, _Doubles]: ...
def rays_of_pixels(
    sensor: Camera | Sensor, pixels: npt.NDArray[np.int64]
) -> tuple[_Doubles, _Doubles]: ...
def distances_of_pixels(
    sensor: Camera | Sensor, is_range: bool, pixels: npt.NDArray[np.int64], t: _Doubles
) -> _Doubles: ...

#: Flat columns by their names, rows and columns of beams, and the JSON of an origin.
_ScanParts = tuple[Sequence[tuple[str, npt.NDArray[Any]]], Sequence[int], str]

@final
class ScanSettings:
    def __new__(
        cls,
        returns: str,
        divergence: float | None,
        subrays: int,
        range_gate: float,
        max_returns: int | None,
        limits: tuple[float, float],
        intensity: bool,
        noise: tuple[float, float] | None,
        dropout: float | None,
        seed: int | None,
        rings: str,
    ) -> ScanSettings: ...
    def record(self) -> str: ...
    def warning(self) -> str | None: ...
    def lines(self) -> int: ...

def scan_columns(
    scene: Scene,
    sensor: Sensor,
    settings: ScanSettings,
    threads: int,
    report: _Report | None,
) -> list[tuple[str, npt.NDArray[Any]]]: ...
def scan_metadata(names: Sequence[str], count: int, origin: str) -> str: ...
def join_scans(scans: Sequence[_ScanParts]) -> _ScanParts: ...
def write_scan(path: Path, scan: _ScanParts) -> None: ...
def read_scan(path: Path) -> _ScanParts: ...
def scan_extensions() -> list[str]: ...

@final
class Pattern:
    @staticmethod
    def spinning(
        elevations: Sequence[float],
        columns: int,
        azimuths: tuple[float, float],
        direction: str,
        time: tuple[float, float],
        offsets: tuple[Sequence[float], Sequence[float]],
    ) -> Pattern: ...
    @staticmethod
    def models() -> list[str]: ...
    @staticmethod
    def named(name: str, rate: float, columns: int | None, start: float) -> Pattern: ...
    @staticmethod
    def raster(
        fov: tuple[float, float],
        size: tuple[int, int],
        is_serpentine: bool,
        time: tuple[float, float],
    ) -> Pattern: ...
    @staticmethod
    def rosette(
        fov: float,
        frequencies: tuple[float, float],
        share: float,
        points: int,
        time: tuple[float, float],
    ) -> Pattern: ...
    @staticmethod
    def lissajous(
        fov: tuple[float, float],
        frequencies: tuple[float, float],
        phase: float,
        points: int,
        time: tuple[float, float],
    ) -> Pattern: ...
    @staticmethod
    def table(
        azimuths: _Doubles, elevations: _Doubles, times: _Doubles, rings: _Integers
    ) -> Pattern: ...
    @staticmethod
    def read_csv(path: Path) -> Pattern: ...
    def name(self) -> str: ...
    def shape(self) -> tuple[int, int]: ...
    def beams(self) -> tuple[_Doubles, _Doubles, _Doubles, _Doubles, _Integers]: ...

@final
class Trajectory:
    def __new__(
        cls,
        times: _Doubles,
        positions: _Doubles,
        rotations: _Doubles,
        interpolation: str,
        extrapolation: str,
    ) -> Trajectory: ...
    @staticmethod
    def rotations(matrices: _Doubles) -> _Doubles: ...
    @staticmethod
    def read(
        path: Path, kind: str, times: Path | None, interpolation: str, extrapolation: str
    ) -> Trajectory: ...
    def write(self, path: Path, kind: str) -> None: ...
    def parts(self) -> tuple[_Doubles, _Doubles, _Doubles, tuple[Interpolation, Extrapolation]]: ...
    def at(self, times: _Doubles) -> _Doubles: ...
    def in_axes(self, given: str, wanted: str) -> Trajectory: ...

@final
class Mesh:
    def __new__(
        cls,
        vertices: _Doubles,
        triangles: npt.NDArray[np.uint32],
        attributes: Sequence[npt.NDArray[np.float32] | None],
        labels: Sequence[npt.NDArray[np.uint32] | None],
        properties: Sequence[_Property],
    ) -> Mesh: ...
    def attributes(self) -> list[npt.NDArray[np.float32] | None]: ...
    def labels(self) -> list[npt.NDArray[np.uint32] | None]: ...
    def properties(self) -> list[_Property]: ...
    def counts(self) -> tuple[int, int]: ...
    def is_closed(self) -> bool: ...
    def area(self) -> float: ...
    def volume(self) -> float | None: ...
    def split(self) -> list[Mesh]: ...
    def moved(self, vertices: _Doubles) -> Mesh: ...
    def vertices(self) -> _Doubles: ...
    def triangles(self) -> npt.NDArray[np.uint32]: ...

@final
class EnvironmentMap:
    def __new__(cls, texels: npt.NDArray[np.float32]) -> EnvironmentMap: ...
    @staticmethod
    def read(path: Path, max_memory: int, max_texture: int) -> tuple[EnvironmentMap, list[str]]: ...
    def array(self) -> npt.NDArray[np.float32]: ...

@final
class Shape:
    @staticmethod
    def mesh(mesh: Mesh) -> Shape: ...
    @staticmethod
    def sphere(center: _Vector, radius: float) -> Shape: ...
    @staticmethod
    def plane(point: _Vector, normal: _Vector) -> Shape: ...
    @staticmethod
    def disc(center: _Vector, normal: _Vector, radius: float) -> Shape: ...
    @staticmethod
    def box(low: _Vector, high: _Vector) -> Shape: ...
    @staticmethod
    def cylinder(bottom: _Vector, top: _Vector, radius: float) -> Shape: ...
    @staticmethod
    def cone(bottom: _Vector, top: _Vector, bottom_radius: float, top_radius: float) -> Shape: ...

@final
class Objects:
    def __len__(self) -> int: ...
    def get(self, number: int) -> _ObjectOut: ...
    def triangles(self, number: int) -> int: ...

@final
class Scene:
    def __new__(
        cls,
        objects: tuple[Sequence[int | _Object], Objects | None],
        lights: Sequence[_Light],
        environment: _Environment | None,
        up: tuple[_Vector, bool],
        previous: Scene | None,
        build: str,
        report: _Report | None,
    ) -> Scene: ...
    def bounds(self) -> list[list[float]] | None: ...
    def names(self, channel: str) -> list[str]: ...
    def likely_up(self, convention: _Vector) -> _Vector: ...
    def changed(
        self,
        replaced: list[tuple[int, _Object]],
        places: tuple[npt.NDArray[np.int64], _Doubles],
        hidden: list[tuple[int, bool]],
        report: _Report | None,
    ) -> Scene: ...
    def seen_by(self, mask: int, only: list[int] | None, blend_below: float | None) -> Scene: ...
    def lit_by(self, environment: _Environment, up: _Vector) -> Scene: ...

@final
class Section:
    def __new__(
        cls,
        scene: Scene,
        origin: _Vector,
        normal: _Vector,
        rule: str,
        threads: int,
        report: _Report | None,
    ) -> Section: ...
    def frame(self) -> tuple[_Vector, _Vector, _Vector, _Vector]: ...
    def totals(self) -> tuple[float, float]: ...
    def polylines(self) -> list[_PolylineOut]: ...
    def left_out(self) -> list[int]: ...
    def warnings(self) -> list[str]: ...
    def save(self, path: Path) -> None: ...

@final
class Lint:
    def __new__(
        cls,
        scene: Scene,
        ignore: list[str],
        places: int,
        threads: int,
        report: _Report | None,
    ) -> Lint: ...
    def findings(
        self,
    ) -> list[tuple[str, int, str, list[tuple[int | None, int | None, _Vector]]]]: ...
    def checked(self) -> list[str]: ...
    def marked(self, identifier: int) -> npt.NDArray[np.bool_] | None: ...
    def save(self, scene: Scene, path: Path) -> None: ...

def axes_from(wanted: str, given: str) -> _Matrix4: ...
def lint_kinds() -> list[tuple[str, str]]: ...
def polygons(
    points: _Doubles, corners: npt.NDArray[np.uint32], sizes: npt.NDArray[np.uint32]
) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.uint32]]: ...
def check_transforms(rows: _Doubles) -> tuple[int, str] | None: ...
def check_environment(candidate: _Environment) -> None: ...
def sun_of(environment: _Environment, up: _Vector) -> _Light | None: ...
def environment_radiance(
    environment: _Environment, up: _Vector, directions: list[list[float]]
) -> _Doubles: ...
def check_material(candidate: _Material) -> _Settings: ...
def srgb_levels() -> list[float]: ...
def check_pose(pose: _Matrix4) -> None: ...
def orthonormalised(pose: _Matrix4) -> tuple[_Matrix4, float] | None: ...
def rotation(vector: _Vector) -> _Matrix3: ...
def named_color(text: str, others: Sequence[str]) -> tuple[list[float] | None, str | None]: ...
def meant_as_levels(color: Sequence[float]) -> str | None: ...
def load(
    path: Path,
    strict: bool,
    max_memory: int,
    max_texture: int,
    scale: float,
    resources: Sequence[Path],
    variant: str | None,
    report: _Report | None,
) -> _Model: ...
def units() -> Sequence[tuple[str, float]]: ...
def escaped(text: str) -> str: ...
def open(  # noqa: A001 - as the package calls it
    path: Path, verify: bool, report: _Report | None
) -> _Model: ...
def save(
    path: Path,
    scene: Scene,
    cameras: Sequence[tuple[str, Camera, bool]],
    background: Sequence[_Vector] | None,
    shading: _Shading,
    display: tuple[float, str],
    edges: _Edges | None,
    has_view: bool,
    up: _Vector,
    up_is_guessed: bool,
    report: _Report | None,
) -> None: ...
def shoot(
    scene: Scene, rays: _Rays, copies: _Copies, threads: int, out: _Hits, report: _Report | None
) -> None: ...
def shoot_all(
    scene: Scene, rays: _Rays, count: int, nearest: int | None, threads: int, report: _Report | None
) -> tuple[npt.NDArray[np.uintp], _Doubles, _Integers, _Integers, _Doubles]: ...
def shoot_camera(
    scene: Scene, camera: Camera | Sensor, threads: int, out: _Hits, report: _Report | None
) -> None: ...
def occluded(
    scene: Scene, rays: _Rays, threads: int, out: npt.NDArray[np.bool_], report: _Report | None
) -> None: ...
def visible(
    scene: Scene,
    ends: tuple[_Ends, _Ends],
    how: tuple[int, float],
    threads: int,
    report: _Report | None,
) -> npt.NDArray[np.bool_]: ...

#: A pixel's camera, column and row, its ray's ends, and what that does not meet.
_PixelRay = tuple[Camera, tuple[int, int], tuple[float, float], _Filters | None]

def before_viewplane(scene: Scene, camera: Camera) -> int: ...
def explain(
    scene: Scene, explained: _Rays | _PixelRay, among: Sequence[int] | None, behind: int
) -> tuple[str, str]: ...
def count(
    scene: Scene, rays: _Rays, threads: int, out: npt.NDArray[np.uint32], report: _Report | None
) -> None: ...
def closest_points(
    scene: Scene, points: _Doubles, wanted: tuple[int, float], threads: int, report: _Report | None
) -> tuple[_Doubles, _Integers, _Integers, _Doubles, _Doubles]: ...
def signed_distances(
    scene: Scene, points: _Doubles, how: tuple[str, bool], threads: int, report: _Report | None
) -> _Doubles: ...
def inside(
    scene: Scene, points: _Doubles, how: tuple[bool, str], threads: int, report: _Report | None
) -> npt.NDArray[np.bool_]: ...
def path_lengths(
    scene: Scene,
    rays: _Rays,
    count: int,
    how: tuple[bool, str],
    threads: int,
    report: _Report | None,
) -> _Doubles: ...
def thickness(
    scene: Scene,
    rays: _Rays,
    count: int,
    how: tuple[bool, str],
    threads: int,
    report: _Report | None,
) -> _Doubles: ...
def rules(scene: Scene, rule: str) -> list[str]: ...
def attribute(
    scene: Scene, named: tuple[str, str | None], hits: Any, threads: int, report: _Report | None
) -> tuple[int, _Doubles]: ...
def attribute_names(scene: Scene) -> list[tuple[str, str, int]]: ...
def channel(
    scene: Scene,
    name: str,
    rays: _Rays | None,
    camera: Camera | Sensor | None,
    hits: Any,
    threads: int,
    report: _Report | None,
) -> npt.NDArray[Any]: ...
def channel_names() -> list[tuple[str, str]]: ...
def render(
    scene: Scene,
    camera: Camera | Sensor,
    channels: Sequence[str],
    picture: _Picture,
    resume: Path | None,
    how: tuple[int, _Report | None],
) -> tuple[list[npt.NDArray[Any]], str]: ...

#: The look of a picture: the shading, the background, which way is up, samples, the region, the
#: side that is passed through, lines, and the noise.
_Picture = tuple[
    _Shading,
    list[_Vector] | None,
    _Vector,
    int,
    tuple[int, int, int, int],
    Side | None,
    _Edges | None,
    float | None,
]

@final
class Accumulated: ...

def render_more(
    scene: Scene,
    camera: Camera | Sensor,
    channels: Sequence[str],
    picture: _Picture,
    known: Accumulated | None,
    how: tuple[int, _Report | None],
) -> tuple[list[npt.NDArray[Any]], Accumulated]: ...
def sampling(channels: Sequence[str]) -> list[str]: ...
def read_plan(text: bytes, path: Path | None) -> str: ...
def plan_file(folder: Path, name: str) -> Path: ...
def place_in_plan(text: bytes, way: Sequence[str]) -> tuple[int, int] | None: ...
def idle(settings: Sequence[str], channels: Sequence[str]) -> list[tuple[str, str]]: ...
def idle_in_files(
    settings: Sequence[str], files: Sequence[tuple[str, str]]
) -> list[tuple[str, str]]: ...

@final
class Viewer:
    def __new__(
        cls,
        seen: tuple[Scene, Camera],
        shading: _Shading,
        background: Sequence[_Vector] | None,
        up: _Vector,
        shown: tuple[tuple[float, str], _Edges | None],
        title: str,
    ) -> Viewer: ...
    def report(self) -> bytes: ...
    def embedded_page(self) -> str: ...
    def still(self) -> bytes: ...
    def answer(self, question: str, about: str) -> tuple[str, bytes]: ...

@final
class PageServer:
    def __new__(cls, viewer: Viewer, port: int) -> PageServer: ...
    @property
    def address(self) -> str: ...
    @property
    def is_over(self) -> bool: ...
    def stop(self) -> None: ...

def resolve(scene: Scene, camera: Camera | Sensor, shading: _Shading, up: _Vector) -> int: ...
def draws(pixels: npt.NDArray[np.int64], sample: int, number: int, count: int) -> _Doubles: ...
def color_names() -> tuple[list[str], list[str]]: ...
def shader_settings(name: str) -> list[tuple[str, str]]: ...
def check_shader(name: str, settings: _Settings) -> _Settings: ...
def edge_defaults() -> tuple[list[EdgeKind], _Edges]: ...
def check_light(light: _Light) -> None: ...
def check_edges(edges: _Edges) -> None: ...
def defaults() -> tuple[int, list[_Vector]]: ...
def render_work(pixels: int, channels: Sequence[str], samples: int) -> int: ...
def metadata(
    shape: Sequence[int], channels: Sequence[tuple[str, npt.NDArray[Any]]], origin: str
) -> str: ...
def matte_id(name: str) -> int: ...
def check_samples(camera: Camera | Sensor, samples: int) -> None: ...
def origin(scene: Scene, camera: Camera | Sensor | None, channels: Sequence[str]) -> str: ...

#: The step of distances, what becomes of far ones, labels, packed.
_Stored = tuple[float | None, Far | None, bool, bool]

def write(
    path: Path,
    shape: Sequence[int],
    channels: Sequence[tuple[str, npt.NDArray[Any]]],
    origin: str,
    stored: _Stored,
    display: tuple[float, str] | None,
) -> str | None: ...
def read(
    path: Path,
) -> tuple[list[tuple[str | None, list[int], npt.NDArray[Any], str]], str | None, list[str]]: ...
def png(
    shape: Sequence[int], name: str, values: npt.NDArray[Any], display: tuple[float, str]
) -> bytes: ...
def write_bytes(path: Path, content: bytes) -> None: ...
def begin_run() -> None: ...
def note_input(path: Path) -> None: ...
def is_input(path: Path) -> bool: ...
def read_points(
    path: Path,
) -> tuple[_Doubles, list[tuple[str | None, list[int], npt.NDArray[Any], str]], list[str]]: ...
