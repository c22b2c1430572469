"""Cameras as plans have them, in the rig's coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import vector
from firsthit._sensors.camera import Camera

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._document import Table

_FISHEYES = ("equidistant", "equisolid", "stereographic", "orthographic_fisheye")
_FLAT = ("perspective", "orthographic")
_MATRIX = ("fx", "fy", "cx", "cy")
#: The numbers of lenses that are told apart; the others are parameters.
_APART = (*_MATRIX, "skew", "focal_length", "width", "height", "fov", "aperture", "focus")

#: The rig's forwards and up: its axes are forwards, left, up.
FORWARDS, UP = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
_AHEAD = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0)


def camera(table: Table) -> Camera:
    """Return the camera of a table, in the rig's coordinates."""
    has_matrix = any(name in table for name in (*_MATRIX, "skew"))
    if "convention" in table and not has_matrix and "pose" not in table:
        raise table.refused("convention", "`convention` is for `pose` and for `fx` to `cy`")
    if has_matrix:
        for name in (*_MATRIX, "convention"):
            table.need(name, "it is a part of the intrinsic matrix")
    with table.blaming():
        lens = _by_matrix(table) if has_matrix else _by_angle(table)
        # The axes of a convention are a permutation: these products do not round.
        placed = lens.moved(_placed(table) @ _inverse(lens.world_from_camera))
        if "aperture" not in table:
            return placed
        focus = table["focus"]
        depth = placed._native.depth(vector("focus", focus)) if isinstance(focus, list) else focus
        return placed.thin_lens(table.number("aperture"), float(depth))


def _given(table: Table) -> dict[str, float]:
    """Return the numbers of a lens that are its alone."""
    names = _firsthit.Camera.settings(table.get("projection", "perspective"))
    return {name: table.number(name) for name in names if name in table and name not in _APART}


def _by_matrix(table: Table) -> Camera:
    if table.get("ray_start", "eye") != "eye":
        raise table.refused("ray_start", "`ray_start` must be eye with an intrinsic matrix")
    fx, fy, cx, cy, skew = (table.number(name, 0.0) for name in (*_MATRIX, "skew"))
    fov = {"fov": table.number("fov")} if "fov" in table else {}
    return Camera.from_intrinsics(
        [[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]],
        rows=table.get("rows", 1),
        columns=table["columns"],
        convention=table["convention"],
        projection=table.get("projection", "perspective"),
        parameters=_given(table) | fov,
    )


def _by_angle(table: Table) -> Camera:
    projection, start = table.get("projection", "perspective"), table.get("ray_start", "eye")
    rows, columns, given = table.get("rows", 1), table["columns"], _given(table)
    if projection in _FISHEYES:
        made = Camera.fisheye(*_AHEAD, table.number("fov", 180.0), rows, columns, projection)
        given = {**made.parameters, **given}
    if projection not in _FLAT:
        return Camera(*_AHEAD, None, None, None, rows, columns, projection, start, given)
    if "width" in table:
        lengths = table.number("focal_length", 1.0), table.number("width"), table.number("height")
    else:
        axis = table.get("fov_axis", "vertical")
        lengths = _firsthit.Camera.lens(table.number("fov", 45.0), axis, rows, columns)
    return Camera(*_AHEAD, *lengths, rows, columns, projection, start, given)


def _placed(table: Table) -> npt.NDArray[np.float64]:
    """Return the matrix that takes the axes right, up, backwards of a camera to the rig."""
    if "pose" in table:
        with table.blaming("pose"):
            convention, pose = table["convention"], matrix(table)
            return Camera.from_intrinsics(
                [1, 1, 0, 0], rows=1, columns=1, convention=convention, pose=pose
            ).world_from_camera
    position = table.numbers("position", [0.0, 0.0, 0.0])
    aim: Any = table.numbers("aim", FORWARDS)
    if "look_at" in table:
        aim = np.subtract(table.numbers("look_at"), position)
    up = table.numbers("up", UP)
    return Camera(position, aim, up, 1, 1, 1, 1, 1, "perspective", "eye").world_from_camera


def matrix(table: Table) -> list[list[float]]:
    """Return the pose of a table, with a fourth row."""
    rows: list[list[float]] = table.numbers("pose")
    return rows if len(rows) == 4 else [*rows, [0.0, 0.0, 0.0, 1.0]]


def _inverse(pose: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the inverse of a turn about the origin."""
    made = np.eye(4)
    made[:3, :3] = pose[:3, :3].T
    return made
