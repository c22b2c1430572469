"""Pictures that are to be made: what `render` was asked for, checked."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from firsthit import _firsthit
from firsthit._base.arrays import number, threads_or_all
from firsthit._base.progress import check, following, later
from firsthit._base.region import Region
from firsthit._base.rounding import is_single, singles
from firsthit._files.channels import distinct, matte_of
from firsthit._files.frame import Frame
from firsthit._looks.colors import colors_of
from firsthit._looks.edges import Edges
from firsthit._looks.environment import Environment
from firsthit._looks.lights import background_native
from firsthit._looks.shading import SAMPLES, Shader, Shading, shader_of
from firsthit._objects.filters import Filters
from firsthit._objects.traceable import Traceable
from firsthit._sensors.camera import Camera, warn_before_viewplane
from firsthit._sensors.sensor import Sensor

from .own_shading import OwnShading

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import numpy.typing as npt

    from firsthit._base.progress import Report
    from firsthit._looks.display import Display
    from firsthit._objects.traceable import Built
    from firsthit._scene.scene import Scene
    from firsthit.typing import OwnShade, Progress, ShaderName, Vector

#: The samples of a pixel at most, where a noise ends them and nothing else says how many.
_SAMPLES_WITH_NOISE = 256

#: The arguments of `render` that are about the library's shaders alone.
_OF_SHADERS = ("background", "environment", "light", "ground", "ambient", "shadows")
_OF_COLORS = ("color_by", "color_map", "color_range")


class Picture(NamedTuple):
    """A picture that can be made."""

    built: Built
    #: The native scene, in the light of the picture's own environment if it has one.
    native: _firsthit.Scene
    camera: Sensor
    part: Region
    #: The channels that were asked for, and those that the native half makes.
    names: list[str]
    asked: list[str]
    look: Shading
    background: list[Vector] | None
    up: Vector
    samples: int
    noise: float | None
    #: Where the state is kept, and goes on from.
    resume: Path | None
    filters: Filters | None
    lines: Edges | None
    own: OwnShade | None
    threads: int
    display: Display
    #: Whether float64 numbers become float32.
    single: bool

    @classmethod
    def of(
        cls,
        scene: Scene,
        camera: Sensor | None,
        channels: str | Sequence[str],
        **given: Any,
    ) -> Picture:
        """Check what a user gave: the arguments of `render`, of which ``None`` are left out."""
        if not isinstance(scene, Traceable) or not isinstance(camera, Sensor | None):
            raise TypeError("render takes a Scene and a Camera or another sensor")
        known = [name for name, _ in _firsthit.channel_names()]
        names = distinct(channels, known)
        own = _own(given)
        look = _look(scene.shading, given)
        noise = _noise(given.get("noise"), own)
        resume = _resume(given.get("resume"), own)
        if noise is not None and look.samples is None:
            look = look._but(samples=_SAMPLES_WITH_NOISE)
        usual = scene.edges if camera is None or isinstance(camera, Camera) else None
        lines = Edges._of(usual if given["edges"] is None else given["edges"])
        threads, single = threads_or_all(given["threads"]), is_single(given.get("dtype"))
        background = scene.background if given["background"] is None else given["background"]
        back = None if background is None else background_native(background)
        if own is not None:
            look = Shading("unlit", samples=look.samples or SAMPLES, ground=False)
        asked = [name for name in names if own is None or name != "color"]
        # The library draws over its own colours alone.
        if own is not None and lines is not None and "color" in names and "edge" not in asked:
            asked.append("edge")
        ready = scene._ready(given.get("progress"))
        camera = scene._view() if camera is None else camera
        built = ready.seen(None, given["objects"], given["blend_below"])
        filters, native = Filters.of(None, given["cull"], None), built.native
        if given["environment"] is not None:
            native = built.lit_by(given["environment"], scene.up)
        samples = _firsthit.resolve(native, camera._native, look._native(), scene.up)
        if own is not None and "color" in names:
            _firsthit.check_samples(camera._native, samples)
        part = Region.of(given["region"], (camera.rows, camera.columns))
        seen = built, native, camera, part, names, asked, look, back, scene.up, samples
        return cls(*seen, noise, resume, filters, lines, own, threads, scene.display, single)

    def frame(self, progress: Progress | None) -> Frame:
        """Make it."""
        warn_before_viewplane(self.native, self.camera)
        pixels = math.prod(self.part.shape)
        work = _firsthit.render_work(pixels, self.asked, self.samples)
        owned = pixels * self.samples if self._has_own_colors else 0
        with following(progress, work + owned, name="shooting") as report:
            made, origin = self._rendered(self.asked, self.samples, report)
            if self._has_own_colors:
                told, job = later(report, work), self._own_shading()
                colors = job.centres(told) if self.samples == 1 else job.means(self.samples, told)
                made["color"] = self._with_lines(colors, made)
        return self._framed(made, origin)

    def frames(self, progress: Progress | None) -> Iterator[Frame]:
        """Make it with 1, 2, 4, ... samples, up to as many as it has.

        Settings that make no picture are refused at once: a pixel is made. All else is made when it
        is asked for.
        """
        check(progress)
        warn_before_viewplane(self.native, self.camera)
        least = 1
        try:
            _firsthit.check_samples(self.camera._native, 1)
        except ValueError:
            least = 2  # it has a lens
        corner = self._settings(min(least, self.samples), self.part.corner())
        camera = self.camera._native
        _, origin = _firsthit.render(self.native, camera, self.asked, corner, None, (1, None))
        return self._frames(_Steps.of(self, least), origin, progress)

    def _frames(self, steps: _Steps, origin: str, progress: Progress | None) -> Iterator[Frame]:
        said, pixels = json.loads(origin), math.prod(self.part.shape)
        kept: dict[str, npt.NDArray[Any]] = {}
        known: _firsthit.Accumulated | None = None
        sums = np.zeros((*self.part.shape, 3)) if self._has_own_colors else np.zeros(0)
        before = done = 0
        with following(progress, steps.work(pixels), name="shooting") as report:
            for samples in steps.samples:
                if steps.centred and not before:
                    kept, _ = self._rendered(steps.centred, samples, later(report, done))
                    done += _firsthit.render_work(pixels, steps.centred, samples)
                made = {name: array.copy() for name, array in kept.items()}
                if steps.accumulated:
                    more, known = self._more(steps.accumulated, samples, known, later(report, done))
                    made |= more
                    done += _firsthit.render_work(pixels, steps.accumulated, samples - before)
                if steps.whole:
                    whole, _ = self._rendered(steps.whole, samples, later(report, done))
                    made |= whole
                    done += _firsthit.render_work(pixels, steps.whole, samples)
                if self._has_own_colors:
                    told, job = later(report, done), self._own_shading()
                    is_all = self.samples == 1
                    added = range(before, samples)
                    colors = job.centres(told) if is_all else job.add(sums, added, told)
                    made["color"] = self._with_lines(colors, made)
                    done += pixels * len(added)
                before = samples
                yield self._framed(made, json.dumps({**said, "samples": samples}))

    @property
    def _has_own_colors(self) -> bool:
        return self.own is not None and "color" in self.names

    def _settings(self, samples: int, part: Region) -> _firsthit._Picture:
        side = None if self.filters is None else self.filters.cull
        drawn = None if self.lines is None else self.lines._native()
        look = self.look._native()
        return look, self.background, self.up, samples, part, side, drawn, self.noise

    def _rendered(
        self, channels: list[str], samples: int, report: Report | None
    ) -> tuple[dict[str, npt.NDArray[Any]], str]:
        """Return channels, and the JSON of where they come from."""
        picture, how = self._settings(samples, self.part), (self.threads, report)
        native, camera = self.native, self.camera._native
        arrays, origin = _firsthit.render(native, camera, channels, picture, self.resume, how)
        return self._shaped(channels, arrays), origin

    def _more(
        self,
        channels: list[str],
        samples: int,
        known: _firsthit.Accumulated | None,
        report: Report | None,
    ) -> tuple[dict[str, npt.NDArray[Any]], _firsthit.Accumulated]:
        """Return channels with more samples, and what is to be known for even more."""
        picture, how = self._settings(samples, self.part), (self.threads, report)
        native, camera = self.native, self.camera._native
        arrays, known = _firsthit.render_more(native, camera, channels, picture, known, how)
        return self._shaped(channels, arrays), known

    def _shaped(
        self, channels: list[str], arrays: Sequence[npt.NDArray[Any]]
    ) -> dict[str, npt.NDArray[Any]]:
        shape = self.part.shape

        def shaped(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
            components = array.size // max(math.prod(shape), 1)
            return array.reshape(shape if components == 1 else (*shape, components))

        return {name: shaped(array) for name, array in zip(channels, arrays, strict=True)}

    def _own_shading(self) -> OwnShading:
        assert self.own is not None
        seen = self.built, self.filters, self.camera, self.part
        return OwnShading(*seen, self.own, self.threads)

    def _with_lines(
        self, colors: npt.NDArray[np.float32], made: dict[str, npt.NDArray[Any]]
    ) -> npt.NDArray[np.float32]:
        """Return colours with the lines over them."""
        if self.lines is None:
            return colors
        share = made["edge"][..., np.newaxis].astype(np.float64)
        mixed: npt.NDArray[np.float64]
        mixed = (1 - share) * colors + share * np.asarray(self.lines.color)
        return mixed.astype(np.float32)

    def _framed(self, made: dict[str, npt.NDArray[Any]], origin: str) -> Frame:
        held = {matte_of(name) or name: made[name] for name in self.names}
        if self.single:
            doubles = (name for name, array in held.items() if array.dtype == np.float64)
            held |= {name: singles(held[name]) for name in doubles}
        return Frame._of(self.part.shape, held, origin, display=self.display)


class _Steps(NamedTuple):
    """The steps of a picture: channels by how they are made, and the samples of each step."""

    #: Channels whose samples are added to those before.
    accumulated: list[str]
    #: Channels that are made anew of all samples.
    whole: list[str]
    #: Channels of the pixels' centres.
    centred: list[str]
    samples: list[int]
    has_own_colors: bool

    @classmethod
    def of(cls, picture: Picture, least: int) -> _Steps:
        """Return the steps of a picture, the first with ``least`` samples."""
        kinds = dict(zip(picture.asked, _firsthit.sampling(picture.asked), strict=True))
        groups = [
            [name for name, kind in kinds.items() if kind == wanted]
            for wanted in ("accumulated", "all", "centre")
        ]
        has_samples = picture._has_own_colors or bool(groups[0] or groups[1])
        steps = [picture.samples]
        if has_samples:
            powers = range(least - 1, (picture.samples - 1).bit_length())
            steps = [*(1 << power for power in powers), picture.samples]
        return cls(groups[0], groups[1], groups[2], steps, picture._has_own_colors)

    def work(self, pixels: int) -> int:
        """Return how many rays all steps report."""
        last = self.samples[-1]
        work = pixels * last if self.has_own_colors else 0
        if self.centred:
            work += _firsthit.render_work(pixels, self.centred, last)
        if self.accumulated:
            work += _firsthit.render_work(pixels, self.accumulated, last)
        if self.whole:
            steps = self.samples
            work += sum(_firsthit.render_work(pixels, self.whole, samples) for samples in steps)
        return work


def _own(given: dict[str, Any]) -> OwnShade | None:
    """Return the shader of one's own, if there is one."""
    shade = given["shade"]
    if shade is None or isinstance(shade, str | Shader):
        return None
    if not callable(shade):
        raise TypeError(f"shade must be the name of a shader or a function, got {shade!r}")
    for name in (*_OF_SHADERS, *_OF_COLORS):
        if given[name] is not None:
            raise ValueError(f"{name} does nothing with a shade of one's own; leave it out")
    own: OwnShade = shade
    return own


def _noise(noise: object, own: OwnShade | None) -> float | None:
    """Return the noise that a user gave, a standard error."""
    if noise is None:
        return None
    if own is not None:
        raise ValueError("noise does nothing with a shade of one's own; leave it out")
    wanted = number("noise", cast("npt.ArrayLike", noise))
    if not 0 < wanted < math.inf:
        raise ValueError(f"noise must be a positive, finite number, got {wanted}")
    return wanted


def _resume(path: object, own: OwnShade | None) -> Path | None:
    """Return the file of a state that a user gave."""
    if path is None:
        return None
    if own is not None:
        raise ValueError("resume does nothing with a shade of one's own; leave it out")
    return Path(cast("str", path))


def _look(said: Shading, given: dict[str, Any]) -> Shading:
    """Return the shading: as is given, and else as the scene says."""
    environment = given["environment"]
    if environment is not None:
        if not isinstance(environment, Environment):
            raise TypeError(f"environment must be an Environment or None, got {environment!r}")
        if given["light"] is not None:
            raise ValueError("environment and light exclude each other")
        # A scene's word on lights that go with the camera is about its own light.
        said = said._without_light()
    shade, ambient = given["shade"], given["ambient"]
    shader: ShaderName | Shader | None = said.shade
    if isinstance(shade, str | Shader):
        shader = cast("ShaderName | Shader", shade)
    if ambient is not None and said.shade is None and shade is None:
        shader = "lambert"
    settings = {"ambient": ambient, "shadows": given["shadows"]}
    numbers = {name: given[f"color_{name}"] for name in ("map", "range")}
    look = {name: given[name] for name in ("samples", "light", "ground")}
    look |= {"colors": colors_of(said.colors, given["color_by"], **numbers)}
    return said._but(shade=shader_of(shader, settings), **look)
