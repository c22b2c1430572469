"""BOP's models: the meshes of classes in millimetres, what is known of them, and the camera."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import number
from firsthit._base.errors import warn
from firsthit._files.whole import write
from firsthit._objects.mesh import Mesh
from firsthit._objects.shapes import Box, Cone, Cylinder, Disc, Sphere
from firsthit._scene.scene import Scene
from firsthit._sensors.camera import Camera
from firsthit._sensors.project import intrinsic_matrix

from ._classes import grouped
from ._files import as_json, is_uniform, meters, rotation_and_scale

if TYPE_CHECKING:
    import os
    from collections.abc import Container, Iterable, Mapping, Sequence

    import numpy.typing as npt

    from firsthit._objects.object import Object
    from firsthit._objects.shapes import Shape

    from ._classes import By, Classes

    Floats = npt.NDArray[np.float64]

#: Into so many sides a circle is cut; half of a sphere's meridian into a quarter as many.
SIDES = 64

#: The sides of a box between its corners, which are counted by bits: x, y and z.
_BOX = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]


def tessellated(shape: Shape) -> Mesh | None:
    """Return a shape as a mesh, whose corners are on it; ``None`` where it has no end."""
    if isinstance(shape, Mesh):
        return shape
    if isinstance(shape, Box):
        ends = (np.arange(8)[:, None] >> np.arange(3)) & 1
        return Mesh(np.where(ends == 1, shape.high, shape.low), _BOX)
    if isinstance(shape, Sphere):
        angles = np.linspace(0.0, np.pi, SIDES // 2 + 1)
        rims = [(shape.radius * np.sin(a), -shape.radius * np.cos(a)) for a in angles[1:-1]]
        poles = -shape.radius, shape.radius
        return _turned(shape.center, (0.0, 0.0, 1.0), rims, poles)
    if isinstance(shape, Disc):
        return _turned(shape.center, shape.normal, [(shape.radius, 0.0)], (None, 0.0))
    if isinstance(shape, Cylinder | Cone):
        axis = np.subtract(shape.top, shape.bottom)
        far = float(np.linalg.norm(axis))
        radii = shape.radius, (shape.radius if isinstance(shape, Cylinder) else shape.top_radius)
        rims = [(r, z) for r, z in zip(radii, (0.0, far), strict=True) if r > 0.0]
        return _turned(shape.bottom, axis, rims, (0.0, far))
    return None


def _turned(
    center: npt.ArrayLike,
    axis: npt.ArrayLike,
    rims: list[tuple[float, float]],
    ends: tuple[float | None, float],
) -> Mesh:
    """Return the mesh of rims, each a radius and a height, and of the ends of the axis."""
    w = np.asarray(axis, np.float64)
    w = w / np.linalg.norm(w)
    u = np.cross(w, np.eye(3)[np.abs(w).argmin()])
    u = u / np.linalg.norm(u)
    if np.array_equal(w, (0.0, 0.0, 1.0)):
        # Then the corners include the ends of all axes.
        u = np.array([1.0, 0.0, 0.0])
    v = np.cross(w, u)
    turn = 2.0 * np.pi * np.arange(SIDES) / SIDES
    around = np.cos(turn)[:, None] * u + np.sin(turn)[:, None] * v
    points = [radius * around + height * w for radius, height in rims]
    here = np.arange(SIDES)
    there = (here + 1) % SIDES
    polygons = []
    for k in range(len(rims) - 1):
        a, b = SIDES * k, SIDES * (k + 1)
        polygons += np.stack([a + here, a + there, b + there, b + here], axis=1).tolist()
    count, last = SIDES * len(rims), SIDES * (len(rims) - 1)
    low, high = ends
    if low is not None:
        points.append(low * w[None])
        polygons += [[count, k, j] for j, k in zip(here.tolist(), there.tolist(), strict=True)]
        count += 1
    points.append(high * w[None])
    polygons += [[count, last + j, last + k] for j, k in zip(here, there, strict=True)]
    return Mesh(np.asarray(center, np.float64) + np.concatenate(points), polygons)


#: Of so many points all pairs are compared.
_FEW = 2048

#: How many directions stand for all, and an angle within which each direction has one of them.
_DIRECTIONS, _NEAR = 4096, 0.06


def save_bop_models(
    folder: str | os.PathLike[str],
    scene: Scene | Sequence[Scene],
    *,
    unit: float | str,
    classes: Classes | None = None,
    by: By = "object",
    object_ids: Mapping[str, int] | None = None,
    camera: Camera | None = None,
    depth_scale: float = 1.0,
) -> None:
    """Write the models of a BOP dataset, and its camera.

    Into the folder, which is that of the dataset, go ``models/obj_000001.ply`` and so on, their
    ``models/models_info.json`` and, with a camera, ``camera.json``. A model is the first instance
    of its class, in millimetres, in the frame that the poses of `save_bop` are of; it has normals,
    and the colours of vertices where the mesh has some. Round shapes become polygons of 64 sides,
    with their corners on the shape.

    Parameters
    ----------
    folder : path-like
        The dataset's folder, which is made.
    scene : Scene or sequence of Scene
        Where the objects are.
    unit, object_ids, depth_scale
        As for `save_bop`.
    classes, by
        As for `annotate`.
    camera : Camera, optional
        The camera of the pictures: perspective, for ``camera.json``.

    Raises
    ------
    ValueError
        For a camera without a matrix K; for a class without a number; and for a transform that
        shears, mirrors or scales differently along the axes.
    TypeError
        For another scene or camera.
    FileWriteError
        If the system refuses to write a file; also an `OSError`. Others may be there then.

    Warns
    -----
    FirsthitWarning
        For a class whose model is left out, since a plane of it has no end.

    Notes
    -----
    ``diameter`` is the largest distance between two vertices, ``min_x`` and ``size_x`` and so on
    are of the box along the axes.
    """
    scenes = [scene] if isinstance(scene, Scene) else list(scene)
    for one in scenes:
        if not isinstance(one, Scene):
            raise TypeError(f"scene must be a Scene or several, got {one!r}")
    scale = number("depth_scale", depth_scale)
    found = models(((one, classes, by) for one in scenes), 1e3 * meters(unit))
    numbers = dict(zip(found, range(1, len(found) + 1), strict=True))
    target = Path(folder)
    about = None if camera is None else camera_record(camera, scale)
    write_models(target, found, numbers if object_ids is None else object_ids)
    if about is not None:
        write(target / "camera.json", as_json(about))


def models(
    scenes: Iterable[tuple[Scene, Classes | None, By]],
    millimeters: float,
    only: Container[str] | None = None,
) -> dict[str, Mesh | None]:
    """Return the model of each class, ``None`` where it is none; classes as `annotate` has them."""
    found: dict[str, Mesh | None] = {}
    for scene, classes, by in scenes:
        groups, names = grouped(list(enumerate(scene.objects)), classes, by)
        for name in names:
            group = next((one for one in groups if one.class_name == name), None)
            is_wanted = name not in found and (only is None or name in only)
            if is_wanted and group is not None:
                objects = [scene.objects[k] for k in group.objects]
                found[name] = _model(name, objects, millimeters)
    return found


def write_models(
    target: Path, found: Mapping[str, Mesh | None], numbers: Mapping[str, int]
) -> None:
    """Write the models into a dataset's folder, by the numbers of their classes."""
    for name in found:
        if name not in numbers:
            raise ValueError(f"object_ids must have all classes, not only {', '.join(numbers)}")
    info = {}
    folder = target / "models"
    folder.mkdir(parents=True, exist_ok=True)
    for name, mesh in found.items():
        if mesh is None:
            continue
        info[str(numbers[name])] = _info(mesh.vertices)
        mesh.save(folder / f"obj_{numbers[name]:06d}.ply")
    write(folder / "models_info.json", as_json(info))


def camera_record(camera: Camera, depth_scale: float) -> dict[str, Any]:
    """Return what ``camera.json`` says."""
    if not isinstance(camera, Camera):
        raise TypeError(f"camera must be a Camera, got {camera!r}")
    matrix = intrinsic_matrix(camera)
    if matrix is None:
        raise ValueError(f"a {camera.projection} camera has no matrix K for BOP")
    return {
        "cx": matrix[0, 2] - 0.5,
        "cy": matrix[1, 2] - 0.5,
        "depth_scale": depth_scale,
        "fx": matrix[0, 0],
        "fy": matrix[1, 1],
        "height": camera.rows,
        "width": camera.columns,
    }


def _model(name: str, objects: Sequence[Object], millimeters: float) -> Mesh | None:
    """Return the objects of an instance as one mesh, in the frame of the first."""
    apart = rotation_and_scale(objects[0].transform)
    if isinstance(apart, str) or not is_uniform(apart[1]):
        why = apart if isinstance(apart, str) else f"its transform scales by {apart[1].tolist()}"
        raise ValueError(f"the model of {name!r} cannot be written: {why}, and BOP's are rigid")
    size = millimeters * float(apart[1].mean())
    back = np.linalg.inv(objects[0].transform)
    vertices, triangles, colors, count = [], [], [], 0
    for made in objects:
        mesh = tessellated(made.shape)
        if mesh is None:
            kind = type(made.shape).__name__
            warn(f"the model of {name!r} is left out: a {kind} has no end")
            return None
        points = mesh.vertices
        if made is not objects[0]:
            own = back @ made.transform
            points = points @ own[:3, :3].T + own[:3, 3]
        vertices.append(size * points)
        triangles.append(mesh.triangles.astype(np.int64) + count)
        colors.append(mesh.colors)
        count += len(points)
    points, corners = np.concatenate(vertices), np.concatenate(triangles)
    painted = [one for one in colors if one is not None and one.ndim == 2]
    looks = np.concatenate(painted) if len(painted) == len(colors) else None
    return Mesh(points, corners, normals=_normals(points, corners), colors=looks)


def _normals(points: Floats, corners: npt.NDArray[np.int64]) -> Floats:
    """Return normals of vertices: those of their triangles, by their areas."""
    a, b, c = points[corners.T]
    across = np.cross(b - a, c - a)
    normals = np.zeros_like(points)
    for side in corners.T:
        np.add.at(normals, side, across)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    unit: Floats = np.where(length > 0.0, normals / np.where(length > 0.0, length, 1.0), (0, 0, 1))
    return unit


def _info(points: Floats) -> dict[str, float]:
    low, high = points.min(axis=0), points.max(axis=0)
    made = {"diameter": diameter(points)}
    made |= {f"min_{axis}": float(x) for axis, x in zip("xyz", low, strict=True)}
    return made | {f"size_{axis}": float(x) for axis, x in zip("xyz", high - low, strict=True)}


def diameter(points: Floats) -> float:
    """Return the largest distance between two of some points, (n, 3)."""
    points = np.unique(points - points.mean(axis=0), axis=0)
    if len(points) <= _FEW:
        return _farthest(points, points)
    radius = np.linalg.norm(points, axis=1)
    # From one that is far out there and back.
    start = points[radius.argmax()]
    for _ in range(3):
        away = np.linalg.norm(points - start, axis=1)
        best, start = float(away.max()), points[away.argmax()]
    # A point nearer to the middle is in no pair that is farther apart.
    points = points[radius >= best - radius.max()]
    # The two ends of such a pair are at the ends along the direction that is nearest to theirs.
    for way in _spread(_DIRECTIONS):
        along = points @ way
        least = best * np.cos(_NEAR)
        ends = points[along >= least + along.min()], points[along <= along.max() - least]
        if len(ends[0]) and len(ends[1]):
            best = max(best, _farthest(*ends))
    return best


def _farthest(first: Floats, second: Floats) -> float:
    best = 0.0
    for k in range(0, len(first), 512):
        apart = first[k : k + 512, None] - second[None]
        best = max(best, float(np.einsum("ijk,ijk->ij", apart, apart).max()))
    return float(np.sqrt(best))


def _spread(count: int) -> Floats:
    """Return half of the directions of a Fibonacci lattice: of two opposite ones, one will do."""
    k = np.arange(count)
    z = 1.0 - (2 * k + 1) / count
    turn = np.pi * (1.0 + 5.0**0.5) * k
    flat = np.sqrt(1.0 - z * z)
    ways = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)
    # A little more than half, for directions along the rim.
    some: Floats = ways[z >= -2.0 * _NEAR]
    return some
