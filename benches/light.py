"""Measure finished pictures beside Mitsuba 3 and Blender's Cycles: whole processes, in turns.

    make bench-light [ONLY=shaded,path] [ROUNDS=3] [ISA=avx2] [LIGHT="--size 640x360"]

``shaded``   the bunny on a ground, in the light of a white sky and of a sun with a soft shadow:
             direct light, 1280 x 720, 64 samples a pixel
``preview``  the same with one sample; and ``firsthit render bunny.ply``, with one sample
``default``  ``firsthit render bunny.ply -o x.png``: peers show nothing by themselves
``path``     light by up to eight surfaces, in a closed room of 1.8 million triangles, under a panel
``noise``    the picture of ``shaded``, smaller: its error, and how many samples, and so how much
             time, Mitsuba needs for firsthit's error

Contestants, all with the same camera, matte surfaces, lights, box filter and number of threads:

``firsthit``         the ground is a large square of two triangles, as for the peers
``firsthit ground``  the ground is that of ``--ground``, which is no object; its colour is that of a
                     background. The sky lights from above alone, as the square would leave it
``mitsuba llvm``     the variant ``llvm_ad_rgb``; ``mitsuba scalar`` is ``scalar_rgb``. The
                     integrator is ``path``, the sampler ``independent``. The sun is a far sphere
``cycles``           no denoiser, no clamps, no adaptive stop, no least light

A time is that of a whole process, from its start to a PNG, files and trees included, by the clock
and by processor time of all threads. ``picture s`` is what a program says itself, by the clock:
from the loaded scene to the written PNG. firsthit and Cycles build their trees in that time,
Mitsuba before. A round has everyone once; one goes before, which is not counted: it fills caches,
Dr.Jit's of compiled kernels too, and writes linear pictures, which are compared. One that differs
ends the bench with an error. Ratios are a peer's smallest time divided by that of ``firsthit``:
above 1 firsthit is faster. PNGs to look at are in target/light.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

SCENES, FOLDER = Path("target/scenes"), Path("target/light")
SECTIONS = ("shaded", "preview", "default", "path", "noise")
CONTESTANTS = ("firsthit", "firsthit ground", "mitsuba llvm", "mitsuba scalar", "cycles")
#: Mitsuba's samplers for noise: that of all other comparisons, and a better one.
SAMPLERS = ("independent", "multijitter")
#: By how much pictures may differ, as shares of the mean: the mean itself, and the blocks of
#: 16 x 16 pixels (root mean square), which have noise besides, here of one sample.
MEAN_APART, BLOCKS_APART, BLOCKS_NOISE = 0.02, 0.01, 0.1
#: Mitsuba takes no more samples than this for firsthit's error.
MOST = 16_384
#: The sun's distance as a sphere, in sizes of the scene.
FAR = 1000.0

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """A pinhole; ``fov`` is vertical, in degrees."""

    eye: Vector
    at: Vector
    fov: float


@dataclass(frozen=True)
class Sun:
    """Parallel light of a round sun. ``light`` is what a white surface that faces it takes."""

    towards: Vector
    degrees: float
    light: float


@dataclass(frozen=True)
class Panel:
    """A rectangle parallel to the ground that shines downwards; only surfaces see it."""

    center: Vector
    width: float
    depth: float
    radiance: float


@dataclass(frozen=True)
class Scene:
    """The scene that all contestants make a picture of. World space has z up; all is matte."""

    name: str
    mesh: str
    color: Vector
    camera: Camera
    size: float
    #: How many times light is scattered at most.
    depth: int
    sky: float = 0.0
    sun: Sun | None = None
    panel: Panel | None = None
    #: The ground's height and colour.
    ground: float | None = None
    ground_color: float = 0.5


@dataclass(frozen=True)
class Job:
    """A picture to be made by a peer."""

    scene: Scene
    columns: int
    rows: int
    samples: int
    threads: int
    png: str
    #: Where the linear picture goes, or empty.
    linear: str = ""
    sampler: str = "independent"
    seed: int = 0

    @staticmethod
    def read(text: str) -> Job:
        """Read what `json.dumps(asdict(job))` wrote."""
        fields = json.loads(text)
        scene = fields["scene"]
        scene["camera"] = Camera(**scene["camera"])
        scene["sun"] = scene["sun"] and Sun(**scene["sun"])
        scene["panel"] = scene["panel"] and Panel(**scene["panel"])
        return Job(**(fields | {"scene": Scene(**scene)}))


def bunny() -> Scene:
    """Stand the bunny on a ground, seen from above, so that the ground fills the picture."""
    with np.load(SCENES / "bunny.npz") as arrays:
        low, high = (end(arrays["v"].astype(np.float64), axis=0) for end in (np.min, np.max))
    size = float(np.linalg.norm(high - low))
    middle = (low + high) / 2
    at = middle - (0.0, 0.0, 0.08 * size)
    towards = np.array([0.45, -1.0, 0.62])
    eye = at + 1.75 * size * towards / np.linalg.norm(towards)
    return Scene(
        name="bunny",
        mesh="bunny.ply",
        color=(0.75, 0.55, 0.4),
        camera=Camera(tuple(eye.tolist()), tuple(at.tolist()), 32.0),
        size=size,
        depth=1,
        sky=0.45,
        sun=Sun(towards=(-0.6, -0.45, 1.0), degrees=8.0, light=0.65),
        ground=float(low[2]),
    )


def room(depth: int) -> Scene:
    """Light the closed room of ``benches/scenes.py`` by a panel at its ceiling."""
    with np.load(SCENES / "interior.npz") as arrays:
        eye, at = (tuple(arrays[key].tolist()) for key in ("eye", "at"))
        fov = float(arrays["fov"])
    return Scene(
        name="room",
        mesh="interior.ply",
        color=(0.7, 0.65, 0.6),
        camera=Camera(eye, at, fov),
        size=16.0,
        depth=depth,
        # Above the camera: where it sees a hidden light, Mitsuba shows nothing in its place.
        panel=Panel(center=(6.0, 2.6, 3.999), width=3.0, depth=2.0, radiance=6.0),
    )


# firsthit


def scene_file(scene: Scene, *, catcher: bool) -> str:
    """Write the scene file. A ``catcher`` is the ground that is no object."""

    def numbers(*values: float) -> str:
        return "[" + ", ".join(f"{value:.9g}" for value in values) + "]"

    camera = scene.camera
    lines = [
        "up = [0, 0, 1]",
        "[camera]",
        f"position = {numbers(*camera.eye)}",
        f"look_at = {numbers(*camera.at)}",
        f"fov = {camera.fov:.9g}",
        "[[objects]]",
        f'file = "{scene.mesh}"',
        f"color = {numbers(*scene.color)}",
    ]
    gray = [scene.ground_color] * 3
    if scene.ground is not None and not catcher:
        corners = ", ".join(numbers(*corner) for corner in square(scene))
        lines += [
            "[[objects]]",
            'shape = "mesh"',
            f"vertices = [{corners}]",
            "triangles = [[0, 1, 2], [0, 2, 3]]",
            f"color = {numbers(*gray)}",
        ]
    if scene.sun:
        lines += [
            "[[lights]]",
            'kind = "directional"',
            f"direction = {numbers(*(-x for x in scene.sun.towards))}",
            f"color = {numbers(*[scene.sun.light] * 3)}",
            f"angle_degrees = {scene.sun.degrees:.9g}",
        ]
    if scene.panel:
        panel = scene.panel
        lines += [
            "[[lights]]",
            'kind = "rectangle"',
            f"center = {numbers(*panel.center)}",
            # The side that shines is that of their cross product.
            f"edge_u = {numbers(0.0, panel.depth, 0.0)}",
            f"edge_v = {numbers(panel.width, 0.0, 0.0)}",
            f"emission = {numbers(*[panel.radiance] * 3)}",
        ]
    if scene.sky:
        lines += ["[environment]"]
        sky = numbers(*[scene.sky] * 3)
        lines += [f"above = {sky}", "below = [0, 0, 0]"] if catcher else [f"color = {sky}"]
        lines += ["seen = false"]
    shown = [0.0] * 3
    if catcher and scene.sun:
        cosine = scene.sun.towards[2] / np.linalg.norm(scene.sun.towards)
        shown = [color * (scene.sky + scene.sun.light * cosine) for color in gray]
    lines += ["[background]", f"color = {numbers(*shown)}", "[shading]"]
    if scene.depth == 1:
        lines += ['shader = "direct"']
    else:
        lines += ['shader = "path"', f"depth = {scene.depth}", "roulette = 3"]
    lines += [f"ground = {str(catcher).lower()}"]
    return "\n".join(lines) + "\n"


def square(scene: Scene) -> np.ndarray:
    """Return the corners of the ground, counter-clockwise from above, to far out of the picture."""
    x, y, _ = scene.camera.at
    sides = 60.0 * scene.size * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    return sides + np.array([x, y, scene.ground])


# The peers. Each makes one picture in a process of its own, and says how long it took.


class Report(NamedTuple):
    """A peer's own report: seconds by the clock for the picture, and the samples of a pixel."""

    seconds: float
    samples: int


def mitsuba_scene(mi: object, job: Job) -> dict:
    """Describe a scene to Mitsuba."""
    scene, camera = job.scene, job.scene.camera

    def matte(*color: float) -> dict:
        surface = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(color)}}
        # In the room, some models show their backs.
        return {"type": "twosided", "bsdf": surface} if scene.depth > 1 else surface

    def shining(radiance: float) -> dict:
        return {"type": "area", "radiance": {"type": "rgb", "value": [radiance] * 3}}

    described = {
        "type": "scene",
        "integrator": {
            "type": "path",
            # It counts what the camera sees of lights as the first.
            "max_depth": scene.depth + 1,
            "rr_depth": 3,
        },
        "sensor": {
            "type": "perspective",
            "fov": camera.fov,
            "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(camera.eye, camera.at, [0, 0, 1]),
            "near_clip": 1e-3 * scene.size,
            "far_clip": 1e3 * scene.size,
            "film": {
                "type": "hdrfilm",
                "width": job.columns,
                "height": job.rows,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
            "sampler": {"type": job.sampler, "sample_count": job.samples},
        },
        "mesh": {
            "type": "ply",
            "filename": str(FOLDER / scene.mesh),
            "face_normals": True,
            "bsdf": matte(*scene.color),
        },
    }
    place = mi.ScalarTransform4f()
    if scene.ground is not None:
        x, y, _ = camera.at
        there = place.translate([x, y, scene.ground]).scale([60.0 * scene.size] * 2 + [1.0])
        described["ground"] = {
            "type": "rectangle",
            "to_world": there,
            "bsdf": matte(*[scene.ground_color] * 3),
        }
    if scene.sky:
        described["sky"] = {
            "type": "constant",
            "radiance": {"type": "rgb", "value": [scene.sky] * 3},
        }
    if scene.sun:
        towards = np.array(scene.sun.towards) / np.linalg.norm(scene.sun.towards)
        sine = np.sin(np.radians(scene.sun.degrees) / 2)
        described["sun"] = {
            "type": "sphere",
            "center": (np.array(camera.at) + FAR * scene.size * towards).tolist(),
            "radius": FAR * scene.size * sine,
            "emitter": shining(scene.sun.light / sine**2),
        }
    if scene.panel:
        panel = scene.panel
        # A rectangle has sides of two and looks along +z.
        there = place.translate(list(panel.center)).rotate([1, 0, 0], 180)
        described["panel"] = {
            "type": "rectangle",
            "to_world": there.scale([panel.width / 2, panel.depth / 2, 1.0]),
            "bsdf": matte(*scene.color),
            "emitter": shining(panel.radiance),
        }
    return described


def by_mitsuba(job: Job, variant: str) -> Report:
    """Make a picture with Mitsuba."""
    import drjit
    import mitsuba as mi

    mi.set_variant(variant)
    drjit.set_thread_count(job.threads)
    mi.set_log_level(mi.LogLevel.Warn)
    scene = mi.load_dict(mitsuba_scene(mi, job))
    began = time.perf_counter()
    image = np.array(mi.render(scene, seed=job.seed), np.float32)
    mi.util.write_bitmap(job.png, image, write_async=False)
    seconds = time.perf_counter() - began
    if job.linear:
        np.save(job.linear, image)
    # Some samplers round the number up.
    return Report(seconds, scene.sensors()[0].sampler().sample_count())


def by_cycles(job: Job) -> Report:
    """Make a picture with Cycles."""
    import bpy
    from mathutils import Matrix, Vector

    bpy.ops.wm.read_factory_settings(use_empty=True)
    stage, scene, camera = bpy.context.scene, job.scene, job.scene.camera

    def add(name: str, data: object, place: Matrix | None = None) -> object:
        thing = bpy.data.objects.new(name, data)
        thing.matrix_world = place or Matrix()
        stage.collection.objects.link(thing)
        return thing

    def matte(*color: float) -> object:
        material = bpy.data.materials.new("matte")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        surface = tree.nodes.new("ShaderNodeBsdfDiffuse")
        surface.inputs["Color"].default_value = (*color, 1.0)
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(surface.outputs["BSDF"], output.inputs["Surface"])
        return material

    def aimed(at: Vector, towards: Vector) -> Matrix:
        """Return the place of a camera or a light, which look along -z with y up."""
        turn = Vector(towards).to_track_quat("-Z", "Y").to_matrix().to_4x4()
        return Matrix.Translation(Vector(at)) @ turn

    bpy.ops.wm.ply_import(filepath=str(FOLDER / scene.mesh), forward_axis="Y", up_axis="Z")
    mesh = next(thing for thing in stage.objects if thing.type == "MESH").data
    mesh.materials.clear()
    mesh.materials.append(matte(*scene.color))
    if scene.ground is not None:
        ground = bpy.data.meshes.new("ground")
        ground.from_pydata(square(scene).tolist(), [], [(0, 1, 2), (0, 2, 3)])
        ground.materials.append(matte(*[scene.ground_color] * 3))
        add("ground", ground)
    stage.world = world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    sky = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    sky.inputs["Color"].default_value = (*[scene.sky] * 3, 1.0)
    if scene.sun:
        sun = bpy.data.lights.new("sun", "SUN")
        # An irradiance.
        sun.energy = np.pi * scene.sun.light
        sun.angle = np.radians(scene.sun.degrees)
        add("sun", sun, aimed((0.0, 0.0, 0.0), -Vector(scene.sun.towards)))
    if scene.panel:
        panel = bpy.data.lights.new("panel", "AREA")
        panel.shape, panel.size, panel.size_y = "RECTANGLE", scene.panel.width, scene.panel.depth
        # A power, of which a radiance sends pi for each unit of area.
        panel.energy = np.pi * scene.panel.radiance * scene.panel.width * scene.panel.depth
        add("panel", panel, Matrix.Translation(Vector(scene.panel.center)))
    pinhole = bpy.data.cameras.new("camera")
    pinhole.sensor_fit = "VERTICAL"
    pinhole.angle_y = np.radians(camera.fov)
    pinhole.clip_start, pinhole.clip_end = 1e-3 * scene.size, 1e3 * scene.size
    towards = Vector(camera.at) - Vector(camera.eye)
    stage.camera = add("camera", pinhole, aimed(camera.eye, towards))

    render, cycles = stage.render, stage.cycles
    render.engine, cycles.device = "CYCLES", "CPU"
    render.resolution_x, render.resolution_y = job.columns, job.rows
    render.resolution_percentage = 100
    render.threads_mode, render.threads = "FIXED", job.threads
    cycles.samples, cycles.seed = job.samples, job.seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.max_bounces = cycles.diffuse_bounces = scene.depth - 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.light_sampling_threshold = 0.0
    stage.view_settings.view_transform = "Standard"
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGB"
    render.filepath = str(Path(job.png).resolve())
    began = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - began
    if job.linear:
        file = Path(job.linear).resolve().with_suffix(".exr")
        render.image_settings.file_format = "OPEN_EXR"
        render.image_settings.color_depth = "32"
        bpy.data.images["Render Result"].save_render(str(file), scene=stage)
        pixels = np.empty(job.rows * job.columns * 4, np.float32)
        bpy.data.images.load(str(file)).pixels.foreach_get(pixels)
        file.unlink()
        np.save(job.linear, pixels.reshape(job.rows, job.columns, 4)[::-1, :, :3])
    return Report(seconds, job.samples)


def contest(name: str, text: str) -> None:
    """Make the picture of a peer, in this process."""
    job = Job.read(text)
    # Cycles writes to standard output what it does.
    told, _ = os.dup(1), os.dup2(2, 1)
    variants = {"mitsuba llvm": "llvm_ad_rgb", "mitsuba scalar": "scalar_rgb"}
    report = by_cycles(job) if name == "cycles" else by_mitsuba(job, variants[name])
    os.write(told, json.dumps(report._asdict()).encode())


# The bench


class Used(NamedTuple):
    """The cost of a process: seconds by the clock, of processors, of the picture; MiB; samples."""

    wall: float
    cpu: float
    picture: float
    peak: float
    samples: int


class Failed(Exception):
    """A contestant has made no picture; the message says why."""


@dataclass
class Bench:
    """Who takes part, and with what."""

    firsthit: str
    threads: int
    rounds: int
    isa: str | None
    contestants: list[str]
    environment: dict[str, str] = field(default_factory=dict)
    #: Lines about what is missing or wrong.
    remarks: list[str] = field(default_factory=list)
    #: The measurements, as lines of Markdown.
    lines: list[str] = field(default_factory=list)
    is_wrong: bool = False

    def say(self, *lines: str) -> None:
        """Print lines of the report, and keep them."""
        print(*lines, sep="\n", flush=True)
        self.lines += lines

    def remark(self, line: str) -> None:
        """Say aloud that something is missing or wrong."""
        print(f"bench: {line}", file=sys.stderr, flush=True)
        self.remarks.append(line)

    def run(self, command: list[str]) -> Used:
        """Run a process; it reports itself as JSON on standard output."""
        environment = os.environ | self.environment
        with tempfile.TemporaryFile() as blamed:
            begin = time.perf_counter()
            child = subprocess.Popen(
                command, stdout=subprocess.PIPE, stderr=blamed, env=environment
            )
            told = child.stdout.read()
            _, status, used = os.wait4(child.pid, 0)
            wall = time.perf_counter() - begin
            child.returncode = os.waitstatus_to_exitcode(status)
            if child.returncode != 0:
                blamed.seek(0)
                last = blamed.read().decode(errors="replace").strip().splitlines()[-1:]
                raise Failed(f"ended with {child.returncode}: {' '.join(last)}")
        report = json.loads(told)
        cpu, peak = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0
        return Used(wall, cpu, report["seconds"], peak, report["samples"])

    def make(self, name: str, job: Job) -> Used:
        """Make a picture."""
        if not name.startswith("firsthit"):
            return self.run([sys.executable, __file__, "--contest", name, json.dumps(asdict(job))])
        file = FOLDER / f"{job.scene.name}-{name.replace(' ', '-')}.toml"
        file.write_text(scene_file(job.scene, catcher=name == "firsthit ground"))
        outputs = ["--output", job.png, *(["--output", job.linear] if job.linear else [])]
        size = f"{job.columns}x{job.rows}"
        return self.render([str(file), "--size", size, "--samples", str(job.samples), *outputs])

    def render(self, arguments: list[str]) -> Used:
        """Run ``firsthit render``."""
        threads = ["--threads", str(self.threads)]
        return self.run([self.firsthit, "render", *arguments, "--json", *threads])

    def leave_out(self, name: str, failure: Failed) -> None:
        """Go on without a peer; without firsthit there is nothing to go on with."""
        if name.startswith("firsthit"):
            raise SystemExit(f"bench: {name} {failure}")
        self.remark(f"{name} is not measured: it {failure}")
        self.contestants.remove(name)


def took(all_used: list[Used]) -> list[str]:
    """Return cells: smallest and median by the clock and of processors, the picture, the peak."""
    cells = []
    for times in ([used.wall for used in all_used], [used.cpu for used in all_used]):
        cells += [f"{min(times):.2f}", f"{statistics.median(times):.2f}"]
    smallest = min(used.picture for used in all_used)
    return [*cells, f"{smallest:.2f}", f"{max(used.peak for used in all_used):.0f}"]


def least(all_used: list[Used]) -> Used:
    """Return the smallest of each number."""
    return Used(*(min(column) for column in zip(*all_used, strict=True)))


def row(*cells: str) -> str:
    """Return a line of a table."""
    return f"| {' | '.join(cells)} |"


HEAD = ("wall s: min", "median", "CPU s: min", "median", "picture s", "peak MiB")
RATIOS = ("wall ratio", "CPU ratio", "picture ratio")


def measure(bench: Bench, title: str, job: Job) -> None:
    """Measure a picture by everyone who can make it, in turns, and compare the pictures."""
    names = [
        name
        for name in bench.contestants
        if name != "firsthit ground" or job.scene.ground is not None
    ]
    stem = title.split()[0]
    linear, used = {}, {name: [] for name in names}
    for number in range(bench.rounds + 1):
        for name in names[:]:
            file = FOLDER / f"{stem}-{name.replace(' ', '-')}"
            mine = replace(job, png=f"{file}.png", linear="" if number else f"{file}.npy")
            try:
                spent = bench.make(name, mine)
            except Failed as failure:
                bench.leave_out(name, failure)
                names.remove(name)
                continue
            if number:
                used[name].append(spent)
            else:
                linear[name] = np.load(mine.linear)
    camera_samples = job.columns * job.rows * job.samples
    bench.say(
        "",
        f"### {title}",
        "",
        f"{job.columns} x {job.rows}, {job.samples} samples a pixel.",
        "",
        row("", *HEAD, "CPU ns a sample", *RATIOS),
        "|---" * (len(HEAD) + 2 + len(RATIOS)) + "|",
    )
    ours = least(used["firsthit"])
    for name in names:
        mine = least(used[name])
        told = [f"{1e9 * mine.cpu / camera_samples:.0f}"]
        told += [
            "" if name == "firsthit" else f"{a / b:.2f}"
            for a, b in zip(mine[:3], ours[:3], strict=True)
        ]
        bench.say(row(name, *took(used[name]), *told))
    compare(bench, linear, job.samples)


def blocks(image: np.ndarray) -> np.ndarray:
    """Return the means of blocks of 16 x 16 pixels."""
    rows, columns = (side // 16 * 16 for side in image.shape[:2])
    return image[:rows, :columns].reshape(rows // 16, 16, columns // 16, 16, 3).mean((1, 3))


def compare(bench: Bench, linear: dict[str, np.ndarray], samples: int) -> None:
    """Compare everyone's picture with firsthit's."""
    ours = linear.pop("firsthit").astype(np.float64)
    bench.say("")
    for name, image in linear.items():
        mean = image.mean(dtype=np.float64) / ours.mean() - 1.0
        apart = np.sqrt(np.mean((blocks(image) - blocks(ours)) ** 2)) / ours.mean()
        line = (
            f"the picture of {name}: mean {mean:+.2%}, blocks of 16 x 16 pixels {apart:.2%} apart"
        )
        bench.say(f"- {line}")
        allowed = BLOCKS_APART + BLOCKS_NOISE / np.sqrt(samples)
        # Written so that a NaN fails.
        if not (abs(mean) < MEAN_APART and apart < allowed):
            bench.is_wrong = True
            bench.remark(f"{line}: NOT THE SAME PICTURE")


def alone(bench: Bench, title: str, samples: list[str]) -> None:
    """Measure ``firsthit render bunny.ply`` as people type it."""
    png = str(FOLDER / f"{title.split()[0]}-alone.png")
    command = [str(SCENES / "bunny.ply"), "--output", png, *samples]
    try:
        used = [bench.render(command) for _ in range(bench.rounds + 1)][1:]
    except Failed as failure:
        raise SystemExit(f"bench: firsthit {failure}") from None
    shown = " ".join(["firsthit render bunny.ply -o x.png", *samples])
    bench.say("", f"### {title}", "", row("", *HEAD), "|---" * (len(HEAD) + 1) + "|")
    bench.say(row(f"`{shown}`", *took(used)))


def error(image: np.ndarray, truth: np.ndarray) -> float:
    """Return the root of the mean square of the difference."""
    return float(np.sqrt(np.mean((image.astype(np.float64) - truth) ** 2)))


def needed(measured: list[tuple[int, float]], target: float) -> int:
    """Return how many samples give an error, by a power law through the last measurements."""
    samples, rmse = measured[-1]
    # Of random samples the error's square goes with one over their number.
    power = 0.5
    if len(measured) > 1:
        before, worse = measured[-2]
        power = float(np.clip(np.log(worse / rmse) / np.log(samples / before), 0.4, 1.5))
    return min(max(1, round(samples * (rmse / target) ** (1.0 / power))), MOST)


def equal_noise(bench: Bench, job: Job, truth_samples: int) -> None:
    """Measure errors for numbers of samples, and Mitsuba's time for firsthit's error.

    Everyone is compared with a picture of its own of many samples: so what differs between programs
    is no noise. For Mitsuba that is one with its better sampler and another seed.
    """
    bench.say("", "### noise", "", f"{job.columns} x {job.rows}, the picture of `shaded`.", "")
    names = [name for name in bench.contestants if name in ("firsthit", "mitsuba llvm")]
    truths = {}

    def made(name: str, sampler: str, samples: int, seed: int) -> tuple[np.ndarray, Used]:
        file = FOLDER / f"noise-{name.replace(' ', '-')}-{sampler}-{samples}"
        mine = replace(job, samples=samples, sampler=sampler, seed=seed)
        used = bench.make(name, replace(mine, png=f"{file}.png", linear=f"{file}.npy"))
        return np.load(f"{file}.npy"), used

    for name in names[:]:
        try:
            truths[name], _ = made(name, SAMPLERS[-1], truth_samples, seed=1000)
        except Failed as failure:
            bench.leave_out(name, failure)
            names.remove(name)

    def rmse(name: str, sampler: str, samples: int) -> tuple[int, float]:
        image, used = made(name, sampler, samples, seed=0)
        return used.samples, error(image, truths[name])

    # How many samples are needed: for each sampler the errors that are known, the last one right.
    _, target = rmse("firsthit", "sobol", job.samples)
    errors = {"firsthit": [rmse("firsthit", "sobol", max(1, job.samples // 4))]}
    errors["firsthit"].append((job.samples, target))
    rows = [("firsthit", "sobol", samples) for samples, _ in errors["firsthit"]]
    for sampler in SAMPLERS if "mitsuba llvm" in names else ():
        known = errors[sampler] = [rmse("mitsuba llvm", sampler, job.samples)]
        while len(known) < 5 and abs(known[-1][1] / target - 1.0) > 0.03:
            samples = needed(known, target)
            if samples in [before for before, _ in known]:
                break
            known.append(rmse("mitsuba llvm", sampler, samples))
        rows += [
            ("mitsuba llvm", sampler, samples)
            for samples in dict.fromkeys((known[0][0], known[-1][0]))
        ]

    used = {one: [] for one in rows}
    for seed in range(bench.rounds):
        for one in rows:
            used[one].append(made(*one, seed=seed)[1])
    ratios = ("samples ratio", "RMSE ratio", *RATIOS)
    cells = ("", "samples", "RMSE", *HEAD, *ratios)
    bench.say(row(*cells), "|---" * len(cells) + "|")
    ours = least(used["firsthit", "sobol", job.samples])
    for one in rows:
        name, sampler, samples = one
        its_error = dict(errors.get(sampler, errors["firsthit"]))[samples]
        mine = least(used[one])
        both = ((samples, job.samples), (its_error, target), *zip(mine[:3], ours[:3], strict=True))
        shares = ["" if name == "firsthit" else f"{a / b:.2f}" for a, b in both]
        told = (f"{name}, {sampler}", str(samples), f"{its_error:.5f}")
        bench.say(row(*told, *took(used[one]), *shares))
    if "mitsuba llvm" in truths:
        apart = error(truths["mitsuba llvm"], truths["firsthit"])
        bench.say("", f"- the two pictures of {truth_samples} samples are {apart:.5f} apart (RMS)")


def llvm() -> str | None:
    """Return LLVM's library. Debian's 14 and 15 crash: "Cannot select ... constant pool"."""
    if given := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return given
    found = {}
    for folder in ("/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64"):
        for file in Path(folder).glob("libLLVM*.so*"):
            version = re.match(r"libLLVM(?:-|\.so\.)(\d+)", file.name)
            if version and int(version[1]) >= 16:
                found[int(version[1])] = str(file)
    return found[max(found)] if found else None


def version(package: str) -> str:
    """Return the version of a package, or that it is not there."""
    from importlib import metadata

    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "not installed"


def machine() -> str:
    """Name the processor."""
    info = Path("/proc/cpuinfo")
    named = info.is_file() and re.search(r"model name\s*: (.*)", info.read_text())
    return named[1] if named else platform.processor() or platform.machine()


def present(bench: Bench) -> None:
    """Leave out whom there is not, and say so."""
    library = llvm()
    if library:
        bench.environment["DRJIT_LIBLLVM_PATH"] = library
    why = {
        "mitsuba scalar": version("mitsuba") == "not installed" and "pip has no mitsuba here",
        "cycles": version("bpy") == "not installed" and "pip has no bpy for this Python here",
    }
    why["mitsuba llvm"] = why["mitsuba scalar"] or (
        not library and "no LLVM from 16 on (apt-get install libllvm22, or set DRJIT_LIBLLVM_PATH)"
    )
    for name, reason in why.items():
        if reason and name in bench.contestants:
            bench.contestants.remove(name)
            bench.remark(f"{name} is not measured: {reason}")


def head(bench: Bench) -> None:
    """Say where, when and what is measured."""
    git = ["git", "describe", "--always", "--dirty"]
    commit = subprocess.run(git, capture_output=True, text=True, check=False).stdout.strip()
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg())
    library = bench.environment.get("DRJIT_LIBLLVM_PATH", "none")
    bench.say(
        "# Pictures beside Mitsuba and Cycles",
        "",
        f"- {machine()}, {bench.threads} threads, {datetime.date.today()}, load {load}",
        f"- firsthit {commit}, instructions: {bench.isa or 'the fastest'}; peers choose theirs",
        f"- Mitsuba {version('mitsuba')}, LLVM {Path(library).name}; Blender {version('bpy')}",
        f"- `python {' '.join(sys.argv)}`",
        f"- min and median of {bench.rounds} rounds; ratio: a peer's smallest time divided by that "
        "of `firsthit`, above 1 firsthit is faster",
    )


def arguments() -> argparse.Namespace:
    """Read the command line."""

    def size(text: str) -> tuple[int, int]:
        columns, rows = map(int, text.split("x"))
        return columns, rows

    def listed(known: tuple[str, ...]) -> object:
        def parse(text: str) -> list[str]:
            names = text.split(",")
            if unknown := [name for name in names if name not in known]:
                raise argparse.ArgumentTypeError(f"{unknown[0]!r}: not one of {', '.join(known)}")
            return names

        return parse

    program = Path(sys.executable).with_name("firsthit")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", type=listed(SECTIONS), default=[*SECTIONS], help="sections")
    parser.add_argument("--who", type=listed(CONTESTANTS), default=[*CONTESTANTS])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--samples", type=int, default=64, help="for each pixel")
    parser.add_argument("--size", type=size, default=(1280, 720))
    parser.add_argument("--path-size", type=size, default=(640, 360))
    parser.add_argument("--noise-size", type=size, default=(320, 180))
    parser.add_argument("--depth", type=int, default=8, help="scatterings at most in the room")
    parser.add_argument("--truth", type=int, default=2048, help="samples of what noise is against")
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--isa", help="what FIRSTHIT_ISA is set to, such as avx2")
    parser.add_argument("--firsthit", default=str(program), help="the program that is measured")
    parser.add_argument("--record", type=Path, help="a file for the tables, in Markdown")
    parser.add_argument("--contest", nargs=2, help=argparse.SUPPRESS)
    return parser.parse_args()


def measure_section(bench: Bench, section: str, given: argparse.Namespace) -> None:
    """Measure what one of `SECTIONS` is."""
    mesh = "interior.ply" if section == "path" else "bunny.ply"
    if not (SCENES / mesh).is_file():
        bench.remark(f"{section} is not measured: no {SCENES / mesh}, see benches/scenes.py")
        return
    shutil.copyfile(SCENES / mesh, FOLDER / mesh)
    if section == "path":
        scene, (columns, rows) = room(given.depth), given.path_size
    else:
        scene, (columns, rows) = bunny(), given.noise_size if section == "noise" else given.size
    job = Job(scene, columns, rows, given.samples, given.cores, png="")
    if section == "shaded":
        measure(bench, "shaded", job)
    elif section == "path":
        measure(bench, f"path to depth {given.depth}", job)
    elif section == "preview":
        measure(bench, "preview", replace(job, samples=1))
        alone(bench, "preview of a file", ["--samples", "1"])
    elif section == "default":
        alone(bench, "default", [])
    else:
        equal_noise(bench, job, given.truth)


def main() -> int:
    """Measure, and print tables; return 1 if pictures differ."""
    given = arguments()
    if given.contest:
        contest(*given.contest)
        return 0
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: given.cores])
    bench = Bench(given.firsthit, given.cores, given.rounds, given.isa, given.who)
    if "firsthit" not in bench.contestants:
        bench.contestants.insert(0, "firsthit")
    if given.isa:
        bench.environment["FIRSTHIT_ISA"] = given.isa
    if not shutil.which(given.firsthit):
        raise SystemExit(f"bench: no program {given.firsthit}: make bench-light builds it")
    FOLDER.mkdir(parents=True, exist_ok=True)
    present(bench)
    head(bench)
    for section in given.only:
        try:
            measure_section(bench, section, given)
        except Failed as failure:
            bench.remark(f"{section} is not measured to its end: a peer {failure}")
    if bench.remarks:
        bench.say("", *(f"- {line}" for line in bench.remarks))
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg())
    bench.say("", f"Load at the end: {load}")
    if given.record:
        given.record.write_text("\n".join(bench.lines) + "\n")
    return int(bench.is_wrong)


if __name__ == "__main__":
    sys.exit(main())
