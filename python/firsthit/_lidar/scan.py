"""Scans of a laser scanner."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import count, flag, number, numbers, text, threads_or_all
from firsthit._base.errors import warn
from firsthit._base.progress import following
from firsthit._objects.object import chosen
from firsthit._objects.traceable import Traceable

from .lidar_scan import LidarScan, ScanOrigin, shaped

if TYPE_CHECKING:
    import numpy.typing as npt

    from firsthit._objects.object_list import ObjectList
    from firsthit._scene.scene import Scene
    from firsthit.typing import ObjectKey, Progress, Returns, Rings

    from .lidar import Lidar

#: The largest class of LAS 1.4.
_MOST = 255


def classes_of(objects: ObjectList, classes: Mapping[ObjectKey, int]) -> npt.NDArray[np.int32]:
    """Return the class of each object, 0 for those that are given none."""
    if not isinstance(classes, Mapping):
        raise TypeError(f"classes must be a dict of numbers by object, got {classes!r}")
    made = np.zeros(len(objects), np.int32)
    for key, label in classes.items():
        made[list(chosen(objects, key))] = count(f"classes[{key!r}]", label, 0, _MOST)
    return made


def settings_of(
    *,
    returns: Returns = "first",
    divergence: float | None = None,
    subrays: int = 16,
    range_gate: float = 0.0,
    max_returns: int | None = None,
    min_range: float = 0.0,
    max_range: float = float("inf"),
    intensity: bool = False,
    noise: float | tuple[float, float] | None = None,
    dropout: float | None = None,
    seed: int | None = None,
    rings: Rings = "maker",
) -> _firsthit.ScanSettings:
    """Return the checked settings of what a user gave; see `Lidar.scan`."""
    spread = None
    if noise is not None:
        given = numbers("noise", noise)
        if given.shape not in ((), (2,)):
            raise ValueError(f"noise must be one number or two, got shape {given.shape}")
        spread = float(given.flat[0]), float(given[1]) if given.ndim else 0.0
    return _firsthit.ScanSettings(
        text("returns", returns),
        None if divergence is None else number("divergence", divergence),
        count("subrays", subrays),
        number("range_gate", range_gate),
        None if max_returns is None else count("max_returns", max_returns, 1),
        (number("min_range", min_range), number("max_range", max_range)),
        flag("intensity", intensity),
        spread,
        None if dropout is None else number("dropout", dropout),
        None if seed is None else count("seed", seed),
        text("rings", rings),
    )


def scanned(
    lidar: Lidar,
    scene: Scene,
    settings: _firsthit.ScanSettings,
    classes: Mapping[ObjectKey, int] | None,
    threads: int | None,
    progress: Progress | None,
) -> LidarScan:
    """Scan a scene."""
    if not isinstance(scene, Traceable):
        raise TypeError(f"scan takes a Scene, got {scene!r}")
    if classes is not None:
        # Before the work, so that a wrong name is said at once.
        classes_of(scene._objects[:], classes)
    if (warning := settings.warning()) is not None:
        warn(warning)
    native = scene._ready(progress).native
    with following(progress, lidar.rows * lidar.columns * settings.lines()) as report:
        columns = _firsthit.scan_columns(
            native, lidar._native, settings, threads_or_all(threads), report
        )
    arrays = shaped(columns)
    if classes is not None:
        # Objects may have been added meanwhile, which were met.
        arrays["classification"] = classes_of(scene._objects[:], classes)[arrays["object"]]
    origin = ScanOrigin(native, lidar._native, json.loads(settings.record()))
    return LidarScan._of(arrays, lidar.shape, origin)
