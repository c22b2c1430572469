"""An own shader: NumPy over all hits at once, misses included."""

import firsthit as fh
import numpy as np


def shade(hits: fh.Hits) -> np.ndarray:
    """Normals as colours that fade with the distance; a dark blue behind."""
    fade = np.exp(-0.12 * np.where(hits.object < 0, 0, hits.t))[..., None]
    return np.where((hits.object < 0)[..., None], (0, 0, 0.05), fade * (0.5 + 0.5 * hits.normal))


scene = fh.Scene()
for x in range(-4, 5, 2):
    scene.add(fh.Sphere(center=(x, x, 0), radius=1))
camera = fh.Camera.look_at((2, -9, 4), (0, 0, 0), (0, 0, 1), 40, rows=480, columns=640)
fh.render(scene, camera, shade=shade, samples=16).save("own_shade.png")
