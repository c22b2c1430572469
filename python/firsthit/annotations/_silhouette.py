"""Silhouettes: the view of an instance if nothing else were there."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import CHUNK, chunks, threads_or_all
from firsthit._objects.filters import Filters
from firsthit._queries.rays import Rays
from firsthit._sensors.lines import Lines
from firsthit._sensors.project import Plane, Reach, picture, plane, rays_at, reach, sees_everything

from ._mask import Mask

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

    from firsthit._objects.traceable import Built
    from firsthit._sensors.camera import Camera
    from firsthit._sensors.moving import Pushbroom, RollingShutter
    from firsthit._sensors.sensor import Sensor

    from ._box import Box3D

    Floats = npt.NDArray[np.float64]
    Bools = npt.NDArray[np.bool_]
    #: Tells which of some rays meet the instance.
    _Alone = Callable[[tuple[Floats, Floats]], Bools]

#: How many pixels beyond the border are asked for at most, for each instance.
_MOST_BEYOND = 1 << 20


class Silhouette(NamedTuple):
    """The view of an instance alone."""

    #: In the picture.
    mask: Mask
    #: The pixels of the picture as it goes on beyond its border; ``None`` where not all were asked.
    whole_pixels: int | None
    #: The least box around these, which may be beyond the picture.
    whole_box: tuple[int, int, int, int] | None
    #: The share of these that are beyond the border.
    truncated: float


def silhouette(
    built: Built, camera: Camera, objects: Sequence[int], box: Floats, threads: int | None
) -> Silhouette:
    """Return the silhouette of an instance: a ray for each pixel that its box could be in.

    Nothing else is there. The box is in OpenCV's axes of the camera, (2, 3), and may be infinite.
    """
    whole, flat = picture(camera), plane(camera)
    span = None if flat is None else reach(camera, flat, box)
    inside = whole if span is None else span.within(whole)

    alone = partial(_met, built, objects, threads)
    mask = _of_picture(camera, inside, alone)
    if sees_everything(camera):
        return Silhouette(mask, mask.pixels, mask.box, 0.0 if mask.pixels else math.nan)
    if flat is None:
        return Silhouette(mask, None, None, math.nan)
    if span is None:
        return Silhouette(mask, None, None, 1.0)
    return _beyond(camera, flat, mask, span, alone)


def silhouette_by_lines(
    built: Built,
    camera: RollingShutter | Pushbroom,
    objects: Sequence[int],
    box: Box3D | None,
    threads: int | None,
) -> Silhouette:
    """Return the silhouette of an instance in the picture of a moving camera.

    A ray is asked for each pixel in which a line could see the instance's box. Beyond the border
    there are no lines, and so no pixels.
    """
    part = picture(camera) if box is None else Lines(camera).part(box.corners_in_world)
    mask = _of_picture(camera, part, partial(_met, built, objects, threads))
    return Silhouette(mask, None, None, math.nan)


def _of_picture(camera: Sensor, part: Reach, alone: _Alone) -> Mask:
    """Return the mask of what the camera's own rays of a part of the picture meet."""
    shape = camera.rows, camera.columns
    if part.size == 0:
        return Mask.of(np.zeros((0, 0), np.bool_), shape=shape)
    found = np.zeros((part.height, part.width), np.bool_)
    # Some rows at a time, lest there be too many rays.
    step = max(1, CHUNK // part.width)
    columns = np.arange(part.left, part.right)
    for row in range(part.top, part.bottom, step):
        rows = np.arange(row, min(row + step, part.bottom))
        pixels = (rows[:, None] * camera.columns + columns).reshape(-1)
        origins, directions = _firsthit.rays_of_pixels(camera._native, pixels)
        grids = origins.reshape(-1, 3), directions.reshape(-1, 3)
        found[rows - part.top] = alone(grids).reshape(len(rows), -1)
    return Mask.of(found, shape=shape, row=part.top, column=part.left)


def _beyond(camera: Camera, flat: Plane, mask: Mask, span: Reach, alone: _Alone) -> Silhouette:
    """Return the silhouette of which the mask is the part in the picture."""
    whole, inner = picture(camera), span.within(picture(camera))
    # Above and below the picture, and to the left and right of it between these.
    top, bottom = min(span.bottom, whole.top), max(span.top, whole.bottom)
    strips = (
        Reach(span.left, span.top, span.right, top),
        Reach(span.left, bottom, span.right, span.bottom),
        Reach(span.left, inner.top, min(span.right, whole.left), inner.bottom),
        Reach(max(span.left, whole.right), inner.top, span.right, inner.bottom),
    )
    # One of so many pixels in rows and in columns is asked for.
    step = max(1, math.ceil(math.sqrt(sum(strip.size for strip in strips) / _MOST_BEYOND)))
    beyond, corners = 0, []
    if mask.box is not None:
        left, top, width, height = mask.box
        corners += [(left, top), (left + width, top + height)]
    for strip in (each for each in strips if each.size):
        columns = np.arange(strip.left + step // 2, strip.right, step)
        rows = np.arange(strip.top + step // 2, strip.bottom, step)
        grid = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
        if len(grid) == 0:
            continue
        met = grid[alone(rays_at(camera, flat, grid.astype(np.float64) + 0.5))]
        beyond += len(met) * step**2
        if len(met):
            corners += [tuple(met.min(axis=0).tolist()), tuple((met.max(axis=0) + 1).tolist())]
    total = beyond + mask.pixels
    truncated = beyond / total if total else math.nan
    if step > 1:
        return Silhouette(mask, None, None, truncated)
    if not corners:
        return Silhouette(mask, 0, None, truncated)
    lefts, tops = zip(*corners, strict=True)
    left, top = min(lefts), min(tops)
    box = left, top, max(lefts) - left, max(tops) - top
    return Silhouette(mask, total, box, truncated)


def _met(
    built: Built,
    objects: Sequence[int],
    threads: int | None,
    rays: tuple[Floats, Floats],
) -> Bools:
    """Tell which rays meet any of some objects, if no others are there."""
    origins, directions = rays
    use, found = threads_or_all(threads), np.zeros(len(origins), np.bool_)
    for identifier in objects:
        left = np.flatnonzero(~found)
        only = Filters(only=np.array(identifier, np.int32))
        some = Rays.of(origins[left], directions[left], filters=only, are_own=True)
        for part in chunks(len(left)):
            answers = np.empty(part.stop - part.start, np.bool_)
            _firsthit.occluded(built.native, some.part(part), use, answers, None)
            found[left[part]] = answers
    return found
