"""Compare pictures with Mitsuba 3: ten scenes, sixteen runs of each renderer, and a z-test.

    make test-light

Each scene is written twice, as a firsthit scene file and as a Mitsuba dictionary. A run has random
numbers of its own: Mitsuba by its seed, firsthit by the number of columns, since its numbers depend
on the pixel's number in the picture; columns beyond the first 48 are cut off. For each pixel and
colour, z is the difference of the two means over its standard error (Welch's t-statistic). Where
both renderers compute the same picture, z follows Student's distribution.

A scene passes where the mean of |z| and the mean of z over all pixels are as of chance, and where
the mean colours differ by less than four standard errors. Neighbouring pixels are independent of
each other, so the bounds follow from the number of pixels.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import firsthit as fh
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

SIDE, RUNS = 48, 16
#: Where Mitsuba reads meshes from.
MESHES = tempfile.TemporaryDirectory()
#: What differs by less than this share of the scene's mean colour differs by rounding to float32:
#: Mitsuba's pictures and geometry are that. Pixels without noise have no other error.
ROUNDING = 2e-4

Vector = tuple[float, float, float]
WHITE, GRAY, BLACK = (0.8,) * 3, (0.5,) * 3, (0.0,) * 3
RED, GREEN = (0.7, 0.2, 0.15), (0.2, 0.6, 0.2)


@dataclass
class Both:
    """A scene for both renderers. z is up."""

    name: str
    depth: int = 1
    eye: Vector = (0.0, -6.0, 3.0)
    at: Vector = (0.0, 0.0, 0.8)
    fov: float = 40.0
    samples: int = 64
    toml: list[str] = field(default_factory=list)
    mitsuba: dict = field(default_factory=dict)

    def add(self, lines: str, peer: dict) -> None:
        """Add a thing: its lines in the scene file, and its entry in Mitsuba's dictionary."""
        self.toml.append(lines)
        self.mitsuba[f"thing{len(self.mitsuba)}"] = peer

    # Surfaces. A material is its lines in the scene file and what Mitsuba calls it.

    def sphere(self, center: Vector, radius: float, material: tuple[str, dict]) -> None:
        """Add a sphere, which neither renderer cuts into triangles."""
        lines = f'[[objects]]\nshape = "sphere"\ncenter = {list(center)}\nradius = {radius}\n'
        peer = {"type": "sphere", "center": list(center), "radius": radius}
        self.add(lines + material[0], peer | material[1])

    def mesh(self, vertices: np.ndarray, triangles: np.ndarray, material: tuple[str, dict]) -> None:
        """Add a triangle mesh with flat faces."""
        vertices = np.asarray(vertices, np.float64)
        lines = f'[[objects]]\nshape = "mesh"\nvertices = {vertices.tolist()}\n'
        lines += f"triangles = {np.asarray(triangles).tolist()}\n"
        path = Path(MESHES.name) / f"{self.name}-{len(self.mitsuba)}.ply"
        write_ply(path, vertices, np.asarray(triangles))
        peer = {"type": "ply", "filename": str(path), "face_normals": True}
        self.add(lines + material[0], peer | material[1])

    def quad(self, corner: Vector, u: Vector, v: Vector, material: tuple[str, dict]) -> None:
        """Add a parallelogram."""
        corner, u, v = (np.array(vector, np.float64) for vector in (corner, u, v))
        corners = [corner, corner + u, corner + u + v, corner + v]
        self.mesh(corners, [[0, 1, 2], [0, 2, 3]], material)

    def box(self, low: Vector, high: Vector, material: tuple[str, dict]) -> None:
        """Add a box as a mesh whose faces look outwards."""
        low, high = np.array(low), np.array(high)
        corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
        faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        triangles = [t for a, b, c, d in faces for t in ([a, b, c], [a, c, d])]
        self.mesh(low + corners * (high - low), triangles, material)

    # Lights.

    def sky(self, radiance: Vector) -> None:
        """Surround everything with a uniform sky, which the camera sees too."""
        self.toml.append(f"[environment]\ncolor = {list(radiance)}\n")
        self.mitsuba["sky"] = {"type": "constant", "radiance": rgb(radiance)}

    def sun(self, towards: Vector, color: Vector) -> None:
        """Add parallel light. A white surface that faces it shows its colour."""
        direction = [-x for x in towards]
        lines = f'[[lights]]\nkind = "directional"\ndirection = {direction}\n'
        lines += f"color = {list(color)}\n"
        irradiance = rgb(tuple(math.pi * x for x in color))
        self.add(lines, {"type": "directional", "direction": direction, "irradiance": irradiance})

    def point(self, position: Vector, intensity: Vector) -> None:
        """Add a point light. A white surface that faces it at distance 1 shows its intensity."""
        lines = f'[[lights]]\nkind = "point"\nposition = {list(position)}\n'
        lines += f"intensity = {list(intensity)}\n"
        power = rgb(tuple(math.pi * x for x in intensity))
        self.add(lines, {"type": "point", "position": list(position), "intensity": power})

    def light(self, lines: str, shape: dict, radiance: float) -> None:
        """Add a light with a size. Mitsuba's is a surface too: nothing may be behind it."""
        lines = f"[[lights]]\n{lines}emission = {[radiance] * 3}\n"
        self.add(lines, shape | matte(BLACK)[1] | {"emitter": shining((radiance,) * 3)})


def rgb(values: Vector) -> dict:
    """Describe a colour to Mitsuba."""
    return {"type": "rgb", "value": list(values)}


def shining(radiance: Vector) -> dict:
    """Describe light of a surface to Mitsuba."""
    return {"type": "area", "radiance": rgb(radiance)}


def matte(color: Vector) -> tuple[str, dict]:
    """Return a matte material, on both sides."""
    surface = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(color)}}
    return f"color = {list(color)}\n", {"bsdf": surface}


def emitting(radiance: Vector) -> tuple[str, dict]:
    """Return a black material that shines. Mitsuba's shines in front, so only for closed meshes."""
    lines = 'color = [0, 0, 0]\n[objects.material]\nkind = "matte"\n'
    lines += f"emission = {list(radiance)}\n"
    return lines, matte(BLACK)[1] | {"emitter": shining(radiance)}


def mirror() -> tuple[str, dict]:
    """Return a perfect mirror: a metal of colour white, for which Schlick's Fresnel is 1."""
    lines = 'color = [1, 1, 1]\n[objects.material]\nkind = "metal-rough"\n'
    lines += "metallic = 1\nroughness = 0\n"
    return lines, {"bsdf": {"type": "conductor", "material": "none"}}


def glass(ior: float) -> tuple[str, dict]:
    """Return clear matter."""
    lines = f'[objects.material]\nkind = "glass"\nior = {ior}\n'
    return lines, {"bsdf": {"type": "dielectric", "int_ior": ior, "ext_ior": 1.0}}


def write_ply(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Write a mesh as text."""
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
    lines += ["end_header"]
    lines += [" ".join(f"{x:.9g}" for x in vertex) for vertex in vertices]
    lines += [" ".join(str(n) for n in (3, *triangle)) for triangle in triangles]
    path.write_text("\n".join(lines) + "\n")


def floor(scene: Both, color: Vector = GRAY) -> None:
    """Lay a floor of 20 by 20 under everything."""
    scene.quad((-10, -10, 0), (20, 0, 0), (0, 20, 0), matte(color))


def blocks(scene: Both) -> None:
    """Stand a ball and a box on a floor."""
    floor(scene)
    scene.sphere((-0.9, 0.2, 0.8), 0.8, matte(RED))
    scene.box((0.3, -0.4, 0.0), (1.3, 0.6, 1.6), matte(WHITE))


def cornell(scene: Both) -> None:
    """Close a room of 4 by 4 by 4 around the camera, with a lamp that is a flat box."""
    scene.quad((-2, -6, 0), (4, 0, 0), (0, 8, 0), matte(WHITE))
    scene.quad((-2, -6, 4), (4, 0, 0), (0, 8, 0), matte(WHITE))
    scene.quad((-2, 2, 0), (4, 0, 0), (0, 0, 4), matte(WHITE))
    scene.quad((-2, -6, 0), (4, 0, 0), (0, 0, 4), matte(WHITE))
    scene.quad((-2, -6, 0), (0, 8, 0), (0, 0, 4), matte(RED))
    scene.quad((2, -6, 0), (0, 8, 0), (0, 0, 4), matte(GREEN))
    scene.box((-0.7, -0.7, 3.8), (0.7, 0.7, 3.9), emitting((6.0, 5.5, 5.0)))


def scenes() -> list[Both]:
    """Return the ten scenes."""
    made = []

    def new(name: str, **settings: object) -> Both:
        made.append(Both(name, **settings))
        return made[-1]

    blocks(scene := new("sky"))
    scene.sky((0.6, 0.7, 0.9))

    blocks(scene := new("sun and point"))
    scene.sun((-0.5, -0.6, 1.0), (0.5, 0.45, 0.4))
    scene.point((1.5, -2.0, 3.0), (3.0, 3.0, 3.5))

    blocks(scene := new("sphere light"))
    shape = {"type": "sphere", "center": [2.0, -2.0, 5.0], "radius": 0.7}
    scene.light('kind = "sphere"\ncenter = [2.0, -2.0, 5.0]\nradius = 0.7\n', shape, 12.0)

    blocks(scene := new("rectangle light"))
    place = mi.ScalarTransform4f().look_at([-2, -1, 5], [0, 0, 0], [0, 1, 0])
    matrix = np.array(place.matrix)
    lines = 'kind = "rectangle"\ncenter = [-2, -1, 5]\n'
    lines += f"edge_u = {(2 * matrix[:3, 0]).tolist()}\nedge_v = {(2 * matrix[:3, 1]).tolist()}\n"
    scene.light(lines, {"type": "rectangle", "to_world": place}, 4.0)

    blocks(scene := new("disc light"))
    place = mi.ScalarTransform4f().look_at([1, 2, 5], [0, 0, 0], [0, 1, 0])
    normal = np.array(place.matrix)[:3, 2].tolist()
    lines = f'kind = "disc"\ncenter = [1, 2, 5]\nnormal = {normal}\nradius = 1.0\n'
    scene.light(lines, {"type": "disk", "to_world": place}, 5.0)

    blocks(scene := new("surfaces that shine"))
    scene.box((-2.2, -1.2, 0.2), (-1.8, -0.8, 0.6), emitting((8.0, 5.0, 3.0)))
    scene.sphere((1.9, -1.0, 0.4), 0.3, emitting((2.0, 4.0, 8.0)))

    inside = {"eye": (0.0, -5.6, 2.0), "at": (0.0, 0.0, 1.7), "fov": 42.0}
    cornell(scene := new("room", depth=6, **inside))
    scene.box((-1.4, 0.0, 0.0), (-0.4, 1.0, 2.4), matte(WHITE))
    scene.box((0.3, -0.9, 0.0), (1.3, 0.1, 1.1), matte(WHITE))

    cornell(scene := new("mirror in a room", depth=6, **inside))
    scene.sphere((-0.8, 0.4, 1.0), 1.0, mirror())
    scene.box((0.4, -0.9, 0.0), (1.3, 0.1, 1.1), matte(WHITE))

    floor(scene := new("glass under a sky", depth=8))
    scene.sphere((-0.9, 0.2, 0.9), 0.8, glass(1.5))
    scene.box((0.4, -0.4, 0.1), (1.4, 0.6, 1.6), glass(1.3))
    scene.sphere((0.2, 2.0, 1.0), 0.8, matte(GREEN))
    scene.sky((0.6, 0.7, 0.9))

    floor(scene := new("light between walls", depth=4))
    scene.quad((-1.5, 1.2, 0), (3, 0, 0), (0, 0, 2.5), matte(WHITE))
    scene.quad((-1.5, -0.8, 0), (0, 2, 0), (0, 0, 2.5), matte(RED))
    scene.sphere((0.1, 0.3, 0.6), 0.6, matte(WHITE))
    scene.point((1.6, -0.6, 1.8), (2.0, 2.0, 2.0))
    scene.sun((0.7, -0.5, 0.6), (0.3, 0.3, 0.3))
    return made


def ours(scene: Both) -> np.ndarray:
    """Make the pictures of all runs with firsthit: (run, row, column, colour)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        path.write_text("up = [0, 0, 1]\n" + "\n".join(scene.toml))
        loaded = fh.load(path)
    shader = "direct" if scene.depth == 1 else fh.Shader("path", depth=scene.depth)
    pictures = []
    up = (0, 0, 1)
    pose = fh.Camera.look_at(scene.eye, scene.at, up, scene.fov, rows=SIDE, columns=SIDE)
    focal = SIDE / 2 / math.tan(math.radians(scene.fov) / 2)
    matrix = [[focal, 0, SIDE / 2], [0, focal, SIDE / 2], [0, 0, 1]]
    for run in range(RUNS):
        camera = fh.Camera.from_intrinsics(
            matrix, rows=SIDE, columns=SIDE + run, convention="opengl", pose=pose.world_from_camera
        )
        frame = fh.render(
            loaded, camera, shade=shader, ground=False, samples=scene.samples, background=(0, 0, 0)
        )
        pictures.append(frame["color"][:, :SIDE])
    return np.array(pictures, np.float64)


def theirs(scene: Both) -> np.ndarray:
    """Make the pictures of all runs with Mitsuba."""
    described = {
        "type": "scene",
        # It counts what the camera sees of lights as the first.
        "integrator": {"type": "path", "max_depth": scene.depth + 1, "rr_depth": 100},
        "sensor": {
            "type": "perspective",
            "fov": scene.fov,
            "to_world": mi.ScalarTransform4f().look_at(scene.eye, scene.at, [0, 0, 1]),
            "film": {
                "type": "hdrfilm",
                "width": SIDE,
                "height": SIDE,
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
                "component_format": "float32",
            },
            "sampler": {"type": "independent", "sample_count": scene.samples},
        },
    }
    loaded = mi.load_dict(described | scene.mitsuba)
    return np.array([np.array(mi.render(loaded, seed=run)) for run in range(RUNS)], np.float64)


def mean_of_student(freedom: float) -> tuple[float, float]:
    """Return the mean and the standard deviation of |t| by Student's distribution."""
    half = math.exp(math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2))
    mean = 2 * math.sqrt(freedom / math.pi) * half / (freedom - 1)
    return mean, math.sqrt(freedom / (freedom - 2) - mean * mean)


def compare(scene: Both, folder: Path | None) -> bool:
    """Compare a scene, and print a line of what was found."""
    a, b = ours(scene), theirs(scene)
    if folder:
        stacked = np.concatenate([a.mean(0), b.mean(0)], axis=1)
        mi.util.write_bitmap(str(folder / f"{scene.name.replace(' ', '-')}.png"), stacked)
    # The colours of a pixel are not independent of each other: their sum is judged.
    a, b = a.sum(-1), b.sum(-1)
    parts = [x.var(0, ddof=1) / RUNS for x in (a, b)]
    error = np.sqrt(sum(parts))
    is_noisy = error > ROUNDING * b.mean()
    difference = a.mean(0) - b.mean(0)
    z = difference[is_noisy] / error[is_noisy]
    # Welch's degrees of freedom, pixel by pixel.
    freedom = error**4 / np.maximum(sum(part**2 for part in parts) / (RUNS - 1), 1e-300)
    expected, spread = mean_of_student(float(np.median(freedom[is_noisy])))
    chance = spread / math.sqrt(max(len(z), 1))
    # The mean colour, by the spread of the runs' means.
    means = [x.mean((1, 2)) for x in (a, b)]
    apart = means[0].mean() - means[1].mean()
    apart_error = math.sqrt(sum(x.var(ddof=1) / RUNS for x in means)) + ROUNDING * b.mean()
    exact = np.abs(difference[~is_noisy]).max(initial=0.0) / b.mean()
    checks = {
        "mean |z|": abs(np.abs(z).mean() - expected) < 5 * chance + 0.01,
        "mean z": abs(z.mean()) < 5 / math.sqrt(max(len(z), 1)) + 0.05,
        "mean colour": abs(apart) < 4 * apart_error,
        "pixels without noise": exact < 10 * ROUNDING,
    }
    wrong = ", ".join(name for name, is_right in checks.items() if not is_right)
    print(
        f"{scene.name:20} |z| {np.abs(z).mean():.3f} (by chance {expected:.3f} +- {chance:.3f})  "
        f"z {z.mean():+.3f}  largest {np.abs(z).max(initial=0):.1f}  mean colours apart "
        f"{apart / apart_error:+.1f} errors, {100 * apart / b.mean():+.3f} %  "
        f"{is_noisy.mean():4.0%} noisy, the rest within {exact:.0e}  {wrong or 'as it should be'}",
        flush=True,
    )
    return not wrong


def main() -> int:
    """Compare all scenes, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="scenes whose names contain this")
    parser.add_argument("--pictures", type=Path, help="a folder for both pictures of each scene")
    arguments = parser.parse_args()
    chosen = [scene for scene in scenes() if arguments.only in scene.name]
    if not chosen:
        parser.error(f"no scene is named {arguments.only}")
    results = [compare(scene, arguments.pictures) for scene in chosen]
    print(f"{sum(results)} of {len(results)} scenes as they should be")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
