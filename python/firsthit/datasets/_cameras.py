"""Cameras as plans have them, in the rig's coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import numpy as np

from firsthit import _firsthit
from firsthit._base.types import Convention, Projection, RayStart
from firsthit._sensors.camera import Camera

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._table import Table

_FISHEYES = ("equidistant", "equisolid", "stereographic", "orthographic_fisheye")
_FLAT = ("perspective", "orthographic")
_LENGTHS = ("focal_length", "width", "height")
_MATRIX = ("fx", "fy", "cx", "cy")
#: The numbers of lenses that are told apart; the others are parameters.
_APART = (*_LENGTHS, *_MATRIX, "skew", "fov", "aperture", "focus")

#: The rig's forwards and up: its axes are forwards, left, up.
FORWARDS, UP = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def camera(table: Table, *, one_row: bool = False) -> Camera:
    """Return the camera of a table, in the rig's coordinates."""
    projection = table.text("projection", "perspective", get_args(Projection))
    columns = table.whole("columns", least=1)
    rows = 1 if one_row else table.whole("rows", least=1)
    names = [name for name in _firsthit.Camera.settings(projection) if name not in _APART]
    given = {name: table.number(name) for name in names if name in table}
    convention = table.text("convention", None, get_args(Convention))
    start = table.text("ray_start", "eye", get_args(RayStart))
    has_matrix = any(name in table for name in (*_MATRIX, "skew"))
    placed = _placed(table, convention)
    if has_matrix and start != "eye":
        raise table.refused("ray_start", "`ray_start` must be eye with an intrinsic matrix")
    if convention is not None and not has_matrix and "pose" not in table:
        raise table.refused("convention", "`convention` is for `pose` and for `fx` to `cy`")
    with table.blaming():
        if has_matrix:
            lens = _by_matrix(table, projection, convention, (rows, columns), given)
        else:
            lens = _by_angle(table, projection, start, (rows, columns), given)
        if "aperture" in table:
            lens = lens.thin_lens(table.number("aperture"), table.number("focus"))
        # The axes of a convention are a permutation: these products do not round.
        return lens.moved(placed @ _inverse(lens.world_from_camera))


def _by_matrix(
    table: Table,
    projection: Any,
    convention: Any,
    shape: tuple[int, int],
    given: dict[str, float],
) -> Camera:
    for name in _LENGTHS:
        if name in table:
            raise table.refused(name, f"`{name}` is given by `fx` to `cy` already")
    if convention is None:
        raise table.refused(None, "missing key `convention`: what does the first pixel count as?")
    fx, fy, cx, cy = (table.number(name) for name in _MATRIX)
    skew = table.number("skew", 0.0)
    if "fov" in table:
        given = {**given, "fov": table.number("fov")}
    return Camera.from_intrinsics(
        [[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]],
        rows=shape[0],
        columns=shape[1],
        convention=convention,
        projection=projection,
        parameters=given,
    )


def _by_angle(
    table: Table, projection: Any, start: Any, shape: tuple[int, int], given: dict[str, float]
) -> Camera:
    ahead = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)
    rows, columns = shape
    if projection in _FISHEYES:
        if start != "eye":
            raise ValueError("ray_start must be eye with a fisheye")
        made = Camera.fisheye(*ahead, table.number("fov", 180.0), rows, columns, projection)
        if not given:
            return made
        parameters = {**made.parameters, **given}
        return Camera(*ahead, None, None, None, rows, columns, projection, "eye", parameters)
    if projection not in _FLAT:
        return Camera(*ahead, None, None, None, rows, columns, projection, start, given)
    if not any(name in table for name in _LENGTHS):
        made = Camera.look_at(
            (0.0, 0.0, 0.0), ahead[1], ahead[2], table.number("fov", 45.0), rows, columns
        )
        lengths = made.focal_length, made.width, made.height
    else:
        if "fov" in table:
            raise table.refused("fov", "`fov` excludes `focal_length`, `width` and `height`")
        default = {"default": 1.0} if projection == "orthographic" else {}
        focal = table.number("focal_length", above=0.0, **default)
        lengths = focal, table.number("width", above=0.0), table.number("height", above=0.0)
    return Camera(*ahead, *lengths, rows, columns, projection, start, given)


def _placed(table: Table, convention: Any) -> npt.NDArray[np.float64]:
    """Return the matrix that takes the axes right, up, backwards of a camera to the rig."""
    if "pose" in table:
        if convention is None:
            raise table.refused("pose", "`pose` needs `convention`: what does the matrix take?")
        for name in ("position", "aim", "look_at", "up"):
            if name in table:
                raise table.refused(name, f"`{name}` and `pose` exclude each other")
        with table.blaming("pose"):
            pose = matrix(table, "pose")
            return Camera.from_intrinsics(
                [1, 1, 0, 0], rows=1, columns=1, convention=convention, pose=pose
            ).world_from_camera
    position = table.numbers("position", [0.0, 0.0, 0.0])
    up = table.numbers("up", list(UP))
    aim = table.numbers("aim", None)
    if "look_at" in table:
        if aim is not None:
            raise table.refused("look_at", "`aim` and `look_at` exclude each other")
        aim = np.subtract(table.numbers("look_at"), position)
    with table.blaming():
        aim = FORWARDS if aim is None else aim
        return Camera(position, aim, up, 1, 1, 1, 1, 1, "perspective", "eye").world_from_camera


def matrix(table: Table, key: str) -> list[list[float]]:
    """Return a matrix of four rows, of which the last may be missing."""
    try:
        rows: list[list[float]] = table.numbers(key, shape=(3, 4))
    except ValueError:
        return table.numbers(key, shape=(4, 4))  # type: ignore[no-any-return]
    return [*rows, [0.0, 0.0, 0.0, 1.0]]


def _inverse(pose: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the inverse of a turn about the origin."""
    made = np.eye(4)
    made[:3, :3] = pose[:3, :3].T
    return made
