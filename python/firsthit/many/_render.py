"""Pictures of many cameras."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import color_of, count, number, one_of
from firsthit._files.channels import DISTANCES, distinct, files, in_path, stored
from firsthit._looks.colors import Colors
from firsthit._looks.display import Display
from firsthit._looks.edges import Edges
from firsthit._looks.lights import background_native
from firsthit._looks.shading import Shader
from firsthit._parts.digest import finite, of_arrays, of_json
from firsthit._parts.drive import RunSettings
from firsthit._parts.part import name_of
from firsthit._pictures.render import render

from ._jobs import Job, listed, lit, settled, shared
from ._names import file_name, identity
from ._rays import digest_of

if TYPE_CHECKING:
    import os
    from pathlib import Path

    import numpy.typing as npt

    from firsthit._files.frame import Frame
    from firsthit._looks.environment import Environment
    from firsthit._looks.lights import Sky
    from firsthit._parts.engine import On, Task
    from firsthit._parts.scene_store import SharedScene
    from firsthit._scene.scene import Scene
    from firsthit._sensors.sensor import Sensor
    from firsthit.typing import (
        Asked,
        ColorMapName,
        Far,
        LightName,
        OwnShade,
        Progress,
        Selection,
        ShaderName,
        Side,
        ToneMapName,
    )

    from ._jobs import JobResult

#: The files of pictures.
EXTENSIONS = (".npz", ".exr", ".png", ".npy", ".ply", ".pcd")

#: The arguments of the look of pictures, and those that a job names only where they are given.
_LOOK = ("background", "samples", "cull", "objects", "shade", "ambient", "shadows")
_MORE = (
    *("edges", "light", "ground", "color_by", "blend_below", "dtype", "color_map", "color_range"),
)


def render_many(
    scene: Scene | str | os.PathLike[str],
    cameras: Sequence[Sensor] | Mapping[str, Sensor],
    out: str | os.PathLike[str],
    *,
    channels: Asked | Sequence[Asked] = ("color",),
    save: str | Sequence[str] = ".npz",
    png_scale: float | None = None,
    far: Far | None = None,
    part_size: int = 1,
    background: Sky | npt.ArrayLike | None = None,
    environment: Environment | None = None,
    samples: int | None = None,
    cull: Side | None = None,
    edges: Edges | float | None = None,
    objects: Selection | None = None,
    blend_below: float | None = None,
    shade: ShaderName | Shader | OwnShade | None = None,
    light: LightName | None = None,
    ground: bool | None = None,
    ambient: npt.ArrayLike | None = None,
    shadows: bool | None = None,
    color_by: str | npt.ArrayLike | Colors | None = None,
    color_map: ColorMapName | None = None,
    color_range: tuple[float, float] | None = None,
    exposure: float | None = None,
    tone_map: ToneMapName | None = None,
    dtype: npt.DTypeLike | None = None,
    on: On = None,
    part: tuple[int, int] | None = None,
    threads: int | None = None,
    verify: bool = False,
    progress: Progress | None = None,
) -> JobResult:
    """Make pictures of many cameras, on one machine or on many, and resume after any kill.

    A part is a range of cameras. Each has a folder in ``out/parts``, which is there when it is
    whole; a run makes those that are missing. The bytes are those of `render`, whoever makes them.
    ``docs/cluster.md`` has the same job on processes, Dask, Ray and SLURM.

    Parameters
    ----------
    scene : Scene or path-like
        The scene, or its file. Workers in other processes open the file if one is given, and else
        ``out/scene.fhs``, which is written for them: a built scene, which they share.
    cameras : sequence of Camera or other sensors, or mapping of them by name
        The cameras. A picture's file has its name or, from a sequence, its number. A sequence of
        your own may make each camera when it is asked for: only those of a few parts are held.
    out : path-like
        The folder; it is made. A folder of another job is refused.
    channels : str or sequence of str
        As for `render`.
    save : str or sequence of str
        The extensions of the files of each picture: ``.npz`` and ``.exr`` hold all channels,
        ``.png`` and ``.npy`` have a file for each, ``.ply`` and ``.pcd`` are point clouds.
    png_scale : float, optional
        The length of a step of PNGs of ``t``, ``range`` and ``z``, in scene units: they have 16
        bits, and 65535 steps must reach the farthest hit. If left out, they are false colours.
    far : {"saturate", "zero"}, optional
        As for `Frame.save`: what such PNGs have in place of what is farther.
    part_size : int
        How many cameras are a part. A part should take a second or more.
    background, environment, samples, cull, edges, objects, blend_below : optional
        As for `render`.
    shade, light, ground, ambient, shadows : optional
        As for `render`. A shader of one's own must be a function of a module that workers can
        import. With an environment, workers in other processes open a scene that has it, of
        ``out/scene.fhs``.
    color_by, color_map, color_range
        As for `render`.
    exposure, tone_map : optional
        How ``.png`` shows ``color``, as for `Frame.save`.
    dtype : {float64, float32}, optional
        As for `render`.
    on : executor, or function that makes one, optional
        The maker of the parts: anything with ``submit`` as `concurrent.futures.Executor` has it,
        such as ``dask_client.get_executor()`` or `firsthit.ray.executor`. With a function that
        makes it, such as `many.processes`, a pool that breaks is made anew. This process if left
        out.
    part : pair of int, optional
        ``(k, n)``, k from 1 to n: make the k-th of n ranges of parts only, as a task of a SLURM
        array does. They may be made at the same time, and in any order.
    threads : int, optional
        The number of threads of each worker; all cores if left out.
    verify : bool
        Whether to compare the bytes of parts that are there with their sha256, not only the sizes
        of their files.
    progress : bool or callable, optional
        ``True`` for a line on standard error with the time left, or a function that is called with
        the parts that are done and those of this run. An exception that it raises ends the run.

    Returns
    -------
    JobResult
        How many parts were made and kept, and the digest.

    Raises
    ------
    ValueError, TypeError, IndexError
        As `render`; also for extensions that are none, names that are none of files, and an
        exposure or a tone map without colours in ``.png``.
    FileReadError, FileFormatError
        If the scene's file cannot be read, or is not what it was when the job began.
    FileWriteError
        If the system refuses to write, and if the folder is another job's.
    RuntimeError
        If a part was lost three times with its worker, or a pool broke that was not made here.

    Examples
    --------
    >>> scene = fh.Scene()
    >>> scene.add(fh.Sphere(center=(0, 0, 0), radius=1))
    0
    >>> cameras = [
    ...     fh.Camera.look_at((x, 0, 5), (0, 0, 0), (0, 1, 0), 45, rows=3, columns=3)
    ...     for x in range(4)
    ... ]
    >>> made = fh.render_many(scene, cameras, "pictures", channels=["z", "object"])
    >>> (made.parts, made.made, made.kept)
    (4, 4, 0)
    >>> fh.render_many(scene, cameras, "pictures", channels=["z", "object"]).kept
    4
    """
    given = locals()
    how = RunSettings.of(on, part, threads, verify, progress)
    if not isinstance(cameras, Mapping | Sequence) or isinstance(cameras, str | bytes):
        raise TypeError(f"cameras must be a sequence or a mapping of cameras, got {cameras!r}")
    names = [file_name(name) for name in cameras] if isinstance(cameras, Mapping) else None
    views = list(cameras.values()) if isinstance(cameras, Mapping) else cameras
    known: list[str] = [name for name, _ in _firsthit.channel_names()]
    wanted: list[Any] = list(distinct(channels, known))
    extensions = _extensions(save, wanted)
    size = count("part_size", part_size, 1)
    scale = None if png_scale is None else number("png_scale", png_scale)
    if scale is not None and not 0.0 < scale < math.inf:
        raise ValueError(f"png_scale must be positive and finite, got {scale}")
    stored(scale, far)
    shown = _shown(exposure, tone_map, extensions, wanted)
    numbers = color_by if color_by is None or isinstance(color_by, Colors) else Colors(color_by)
    given |= {"objects": settled(objects), "edges": Edges._of(edges), "color_by": numbers}
    given["dtype"] = None if dtype is None else np.dtype(dtype).name
    look = {name: given[name] for name in _LOOK}
    look |= {name: given[name] for name in _MORE if given[name] is not None}
    said = {
        "kind": "render",
        "cameras": digest_of(views),
        "names": None if names is None else of_json(names),
        "channels": wanted,
        "save": extensions,
        "png_scale": scale,
        "part_size": size,
        "look": finite({**look, **_as_json(look), "objects": listed(look["objects"])}),
        **({} if far is None else {"far": far}),
        **shown,
    }
    share = shared(scene)
    if len(views):
        # Settings that make no picture are refused before a folder is made.
        corner = slice(0, 1), slice(0, 1)
        tried = {**look, "environment": environment}
        render(share.get(), views[0], channels=wanted, region=corner, threads=1, **tried)
    if environment is not None:
        share = lit(share, environment)
    job = Job(out, share, said, math.ceil(len(views) / size))
    job.claim()
    maker = _Pictures(
        job.scene, job.digest, wanted, extensions, (scale, far), look, shown, how.threads
    )

    def of_part(part_number: int) -> list[tuple[str, Sensor]]:
        """Return the names and the cameras of a part."""
        first = part_number * size
        return [
            (name_of(k, len(views)) if names is None else names[k], views[k])
            for k in range(first, min(first + size, len(views)))
        ]

    return job.made(job.do(maker, how, "parts", of_part))


class _Pictures(NamedTuple):
    """Makes the pictures of a part."""

    scene: SharedScene
    job: str
    channels: list[Any]
    extensions: list[str]
    #: The length of a step in PNGs of distances, and their numbers for what is farther.
    steps: tuple[float | None, Far | None]
    look: dict[str, Any]
    shown: dict[str, Any]
    threads: int | None

    def make(self, folder: Path, task: Task) -> dict[str, Any]:
        scene = self.scene.get()
        arrays: dict[str, npt.NDArray[Any]] = {}
        for name, camera in task.given:
            frame = render(scene, camera, channels=self.channels, threads=self.threads, **self.look)
            frame.display = frame.display._but(
                self.shown.get("exposure"), self.shown.get("tone_map")
            )
            for extension in self.extensions:
                self._save(frame, folder / name, extension)
            arrays |= {f"{name}/{channel}": array for channel, array in frame.items()}
        return {
            "job": self.job,
            "part": task.number,
            "pictures": [name for name, _ in task.given],
            "digest": of_arrays(arrays),
        }

    def _save(self, frame: Frame, path: Path, extension: str) -> None:
        """Write a picture to a file, or to one for each channel."""
        several = len(self.channels) > 1
        if extension not in _OF_ONE:
            frame.save(path.with_name(f"{path.name}{extension}"))
            return
        for channel in frame.keys():  # noqa: SIM118 - a frame is no dict
            end = f".{in_path(channel)}{extension}" if several else extension
            has_scale = extension == ".png" and channel in DISTANCES
            scale, far = self.steps if has_scale else (None, None)
            frame._write(path.with_name(f"{path.name}{end}"), [channel], stored(scale, far))


#: The extensions of files that hold one channel.
_OF_ONE = (".png", ".npy")


def _extensions(save: str | Sequence[str], channels: list[str]) -> list[str]:
    given = [save] if isinstance(save, str) else list(save)
    for extension in given:
        one_of("save", extension, EXTENSIONS)
        if extension in _OF_ONE:
            files(f"{{channel}}{extension}", channels)
    if not given:
        raise ValueError("save must be one extension or more, got none")
    return [*dict.fromkeys(given)]


def _shown(
    exposure: float | None,
    tone_map: ToneMapName | None,
    extensions: list[str],
    channels: list[str],
) -> dict[str, Any]:
    """Return how colours are shown, as far as it is given."""
    shown = Display()._but(exposure, tone_map)
    given = {"exposure": exposure, "tone_map": tone_map}
    made = {name: getattr(shown, name) for name, value in given.items() if value is not None}
    saved = [(extension[1:], name) for extension in extensions for name in channels]
    for name, needed in _firsthit.idle_in_files([*made], saved):
        raise ValueError(f"{name} does nothing without {needed}; leave it out")
    return made


def _as_json(look: dict[str, Any]) -> dict[str, Any]:
    """Return colours, lines and functions as the file of a job has them."""
    background, ambient, shade = look["background"], look["ambient"], look["shade"]
    named = None if background is None else background_native(background)
    light = None if ambient is None else list(color_of("ambient", ambient))
    if isinstance(shade, Shader):
        shade = [shade.name, [list(setting) for setting in shade.settings]]
    elif shade is not None and not isinstance(shade, str):
        shade = identity("shade", shade)
    made: dict[str, Any] = {"background": named, "ambient": light, "shade": shade}
    return made | {name: look[name]._native() for name in ("edges", "color_by") if name in look}
