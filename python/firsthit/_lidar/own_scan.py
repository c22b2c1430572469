"""Scans of rays of one's own."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from firsthit._base.arrays import cast, numbers
from firsthit._queries.all_hits import AllHits
from firsthit._queries.hits import Hits
from firsthit._sensors.conventions import rigid
from firsthit._sensors.ray_sensor import RaySensor

from .lidar_scan import ScanOrigin
from .patterns import PatternSensor, rings_of
from .scan import classes_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt

    from firsthit.typing import ObjectKey


def scan_of(
    given: Hits | AllHits,
    beams: Mapping[str, npt.ArrayLike | None],
    intensity: npt.ArrayLike | None,
    pose: npt.ArrayLike | None,
    classes: Mapping[ObjectKey, int] | None,
) -> tuple[dict[str, npt.NDArray[Any]], tuple[int, int], ScanOrigin]:
    """Return what a `LidarScan` is made of; ``beams`` has the times and the rings of the rays."""
    if not isinstance(given, Hits | AllHits):
        raise TypeError(f"hits must be Hits or AllHits, got {given!r}")
    if len(given.shape) > 2:
        raise ValueError(f"hits must have the shape (n,) or (rows, columns), got {given.shape}")
    rows, columns = given.shape if len(given.shape) == 2 else (1, math.prod(given.shape))
    lidar = _lidar_of(given)
    if lidar is not None:
        own: dict[str, npt.ArrayLike | None] = {"ring": lidar.ring, "time": lidar.time}
        beams = own | {name: values for name, values in beams.items() if values is not None}
        pose = lidar.poses() if pose is None else pose
    origins, ways = (
        np.broadcast_to(np.asarray(array, np.float64), (*given.shape, 3)).reshape(-1, 3)
        for array in (given.origin, given.direction)
    )
    if isinstance(given, AllHits):
        met, beam, counts = given.hits, given.ray, given.counts.reshape(-1)
        number = np.arange(len(beam)) - given.offsets[beam] + 1
        total = counts[beam]
    else:
        met = given[given.object >= 0]
        beam = np.flatnonzero(np.reshape(given.object, -1) >= 0)
        number = total = np.ones(len(beam), np.int32)
    x, y, z = ways[beam].T
    point = np.reshape(met.position, (-1, 3))
    row, column = np.divmod(beam, columns)
    arrays: dict[str, npt.NDArray[Any]] = {
        "point": point.copy(),
        "sensor_point": _own(point, origins[beam], pose, given.shape, beam),
        "range": np.reshape(met.t, -1).astype(np.float64) * np.sqrt(x * x + y * y + z * z),
        "object": np.reshape(met.object, -1).copy(),
        "primitive": np.reshape(met.primitive, -1).copy(),
        "incidence": np.reshape(met.incidence, -1).copy(),
        "ring": _of_beams("ring", beams["ring"], given.shape, row, beam).astype(np.int32),
        "row": row.astype(np.int32),
        "column": column.astype(np.int32),
        "time": _of_beams("time", beams["time"], given.shape, 0.0 * row, beam),
        "return_number": number.astype(np.int32),
        "number_of_returns": total.astype(np.int32),
    }
    if intensity is not None:
        of = np.shape(given.t) if isinstance(given, AllHits) else given.shape
        each = np.arange(len(beam)) if isinstance(given, AllHits) else beam
        arrays["intensity"] = _of_beams("intensity", intensity, of, 0.0 * row, each)
    if classes is not None:
        arrays["classification"] = classes_of(met._built.objects, classes)[arrays["object"]]
    sensor = RaySensor(origins, ways, (rows, columns)) if lidar is None else lidar
    how = {"returns": "all" if isinstance(given, AllHits) else "first"}
    return arrays, (rows, columns), ScanOrigin(met._built.native, sensor._native, how)


def _lidar_of(given: Hits | AllHits) -> PatternSensor | None:
    """Return the scanner whose beams met these, each in its place, if one did."""
    if isinstance(given, AllHits) or not given._source.is_whole:
        return None
    sensor = given._source.camera
    return sensor if isinstance(sensor, PatternSensor) else None


def _of_beams(
    name: str,
    given: npt.ArrayLike | None,
    shape: tuple[int, ...],
    default: npt.NDArray[Any],
    beam: npt.NDArray[np.int64],
) -> npt.NDArray[Any]:
    """Return the number of each return's beam."""
    if given is None:
        return default
    array = rings_of(name, given) if name == "ring" else numbers(name, given)
    try:
        each = np.broadcast_to(array, shape).reshape(-1)[beam]
    except ValueError:
        raise ValueError(f"{name} must broadcast to {shape}, got {array.shape}") from None
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite")
    return each.copy() if name == "ring" else cast(each, np.float64).copy()


def _own(
    point: npt.NDArray[np.float64],
    origin: npt.NDArray[np.float64],
    pose: npt.ArrayLike | None,
    shape: tuple[int, ...],
    beam: npt.NDArray[np.int64],
) -> npt.NDArray[np.float64]:
    """Return points in the scanner's frame; without a pose it has the world's axes."""
    if pose is None:
        return point - origin
    given = numbers("pose", pose)
    if given.ndim == 2:
        matrix = rigid(given)
        own: npt.NDArray[np.float64] = (point - matrix[:3, 3]) @ matrix[:3, :3]
        return own
    if given.shape[:-2] != shape or given.shape[-2:] not in ((4, 4), (3, 4)):
        wanted = f"(4, 4), (3, 4), {(*shape, 4, 4)} or {(*shape, 3, 4)}"
        raise ValueError(f"pose must have the shape {wanted}, got {given.shape}")
    each = given.reshape(math.prod(shape), *given.shape[-2:])
    used, which = np.unique(beam, return_inverse=True)
    matrices = np.array([rigid(one) for one in each[used]]).reshape(-1, 4, 4)[which.reshape(-1)]
    ahead = point - matrices[:, :3, 3]
    turned: npt.NDArray[np.float64] = np.einsum("nij,ni->nj", matrices[:, :3, :3], ahead)
    return turned
