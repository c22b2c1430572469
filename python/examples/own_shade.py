"""An own shader: NumPy over all hits at once, misses included. Normals as colours."""

import firsthit as fh
import numpy as np

scene = fh.Scene()
for x in range(-4, 5, 2):
    scene.add(fh.Sphere(center=(x, x, 0), radius=1))
camera = fh.Camera.look_at((2, -9, 4), (0, 0, 0), (0, 0, 1), 40, rows=480, columns=640)
# A miss has no normal, but NaN: here it becomes black.
frame = fh.render(scene, camera, samples=16, shade=lambda h: np.nan_to_num(h.normal / 2 + 0.5))
frame.save("own_shade.png")
